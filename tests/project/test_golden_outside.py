"""A stranger's project takes golden pictures up: it installs the wheel, records, breaks, looks, accepts."""

import json
import os
import shutil
import subprocess
from pathlib import Path

import pytest

STRANGER = Path(__file__).parents[1] / "stranger"
PICTURES, FRAME = "checks/test_pictures.py", "checks/test_frames.py::test_combiners"


class Stranger:
    """The project in a folder of its own, and what is run there."""

    def __init__(self, python, home, *left_out):
        self.python, self.home = python, home
        shutil.copytree(STRANGER, home, ignore=shutil.ignore_patterns("__pycache__", ".*", *left_out))

    def run(self, *arguments, **environment):
        """(exit status, what was printed) of a module of Python's."""
        kept = {k: v for k, v in os.environ.items() if not k.startswith(("PYTHON", "COV_", "PYTEST"))}
        done = subprocess.run(
            [self.python, "-m", *arguments],
            cwd=self.home,
            env=kept | environment,
            capture_output=True,
            text=True,
            check=False,
        )
        return done.returncode, done.stdout + done.stderr

    def golden(self, *arguments, **environment):
        return self.run("fixedpipe.effects.cli", "golden", *arguments, **environment)


@pytest.mark.slow  # tests/pipeline/golden proves each of these commands, and test_installed.py the wheel
def test_a_strangers_pictures_are_recorded_broken_reviewed_and_accepted(installed, tmp_path):
    project = Stranger(installed[0], tmp_path / "project", "test_frames.py")
    status, said = project.run("pytest", "-n", "2")
    assert (status, "5 have no golden picture yet" in said) == (1, True), said
    status, said = project.golden("record")
    assert (status, "5 recorded" in said) == (0, True), said
    store = project.home / "checks" / "golden" / "test_pictures.json"
    before = store.read_text()
    assert before.count("\n") == 5 + 2
    assert project.run("pytest", "-n", "2")[0] == 0

    written = "--junit", "golden.xml", "--json", "golden.json"
    status, said = project.golden("check", *written, "--", "-n", "2", STRANGER_BUG="1")
    assert status == 1
    assert f"{PICTURES}::test_gradient: 1 pixel differs by at most 1, at (19, 9)" in said
    found = json.loads((project.home / "golden.json").read_text())["pictures"]
    assert [p["status"] for p in found] == ["changed"] * 5

    status, said = project.golden("review", "--html", "golden.html")
    assert status == 0, said
    page = (project.home / "golden.html").read_text()
    assert "http://" not in page and "https://" not in page
    assert f"fixedpipe golden accept {PICTURES}::test_gradient" in page

    status, said = project.golden("accept", f"{PICTURES}::test_gradient")
    assert (status, "1 pixel differs by at most 1" in said) == (0, True), said
    assert len(set(store.read_text().splitlines()) ^ set(before.splitlines())) == 2
    status, said = project.run("pytest", STRANGER_BUG="1")
    assert (status, "4 differ" in said, "test_gradient" in said) == (1, True, False)


@pytest.mark.slow  # the new environment compiles its kernels
def test_a_strangers_frame_says_which_command_and_stage_broke(installed, tmp_path):
    project = Stranger(installed[0], tmp_path / "project")
    status, said = project.golden("record")
    assert (status, "6 recorded" in said) == (0, True), said
    status, said = project.golden("check", "--", FRAME, STRANGER_BUG="1")
    assert status == 1
    assert "the first command that leaves something else is 1, Draw 'the colour, squared'" in said
    assert "the first stage with another result is general combiner 0" in said
    status, said = project.golden("accept", FRAME)
    assert (status, "the first command that leaves something else is 1" in said) == (0, True), said
    assert project.run("pytest", FRAME, STRANGER_BUG="1")[0] == 0
