"""``fixedpipe view``: what it refuses, in a sentence, and how it ends."""

import importlib.util
import os
import re
import signal
import socket
import subprocess
import sys
import urllib.request

import pytest
from click.testing import CliRunner

from fixedpipe.effects.cli import main
from fixedpipe.effects.viewer.server import Server
from tests.support.waiting import HANGS

SCRIPT = """
from fixedpipe.effects.figures import FIGURES
from fixedpipe.pipeline.profiles import PROFILES

profile, (width, height) = "GEFORCE_256", FIGURES["F004-4"].dimensions(32)
commands = FIGURES["F004-4"].commands(PROFILES[profile], 32)
"""
FIGURE = """
from dataclasses import replace

from fixedpipe.effects.figures import FIGURES

FIGURE = replace(FIGURES["F004-4"], id="X01-mine")
"""


@pytest.fixture
def served(monkeypatch):
    """The Servers that commands would have run."""
    found = []
    monkeypatch.setattr(Server, "run", lambda self, ready: (found.append(self), self._socket.close()))
    return found


def run(*arguments):
    return CliRunner().invoke(main, ["view", "--no-browser", *map(str, arguments)])


def refusal_of(*arguments):
    result = run(*arguments)
    assert result.exit_code == 2, result.output
    assert result.stdout == ""
    return result.stderr.strip().splitlines()[-1]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["F004-44"], "Did you mean F004-4?"),
        (["nothing.trace"], "nothing.trace cannot be read"),
        (["nothing.py"], "nothing.py cannot be read"),
        (["nothing.obj"], "nothing.obj"),
        (["teapot", "--material", "wood"], "There is no reflectance 'wood'"),
        (["teapot", "--set", "light=1,1,1"], "--set would be ignored"),
        (["F004-4", "--material", "ward"], "--material would be ignored"),
        (["F004-4", "--profile", "IDEAL"], "IDEAL"),
        (["F004-4", "--profile", "OPENGL_1_2"], "cannot be drawn on OPENGL_1_2"),
        (["F004-4", "--set", "light=0,0,0"], "light is"),
        (["F004-4", "--set", "light"], "give NAME=VALUE"),
        (["F004-4", "--size", "4000"], "more than a window shows"),
        (["F004-4", "--token", "short"], "is no secret"),
        (["F004-4", "--token", "x" * 20 + "/../"], "is no secret"),
        (["F004-4", "--port", "1"], "Port 1 of 127.0.0.1 cannot be used"),
        (["F004-4", "--port", "0"], "--port"),
    ],
)
def test_what_cannot_be_shown_is_refused_in_a_sentence(arguments, said, served):
    if arguments[-2:] == ["--port", "1"] and getattr(os, "geteuid", lambda: 0)() == 0:
        pytest.skip("root may listen at any port")
    assert said in refusal_of(*arguments)
    assert not served


def test_without_its_libraries_it_says_how_to_get_them(monkeypatch):
    found = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda name, *more: None if name == "uvicorn" else found(name, *more)
    )
    assert refusal_of("F004-4") == "fixedpipe: The viewer needs uvicorn; install fixedpipe[view]."


def test_a_taken_port_is_refused(served):
    first = run("F004-4", "--size", 32)
    assert first.exit_code == 0 and re.search(r"http://127\.0\.0\.1:\d+/[\w-]{16,}/\n", first.stdout)
    with socket.create_server(("127.0.0.1", 0)) as taken:
        assert "cannot be used" in refusal_of("F004-4", "--port", taken.getsockname()[1])


@pytest.mark.parametrize("name", ["scenes", "scene.py", "mesh.obj"])
def test_a_directory_is_refused(name, tmp_path, served):
    (tmp_path / name).mkdir()
    assert f"{name} is a directory" in refusal_of(tmp_path / name)


def test_figures_and_meshes_are_shown_beside_directories_of_their_names(tmp_path, served, monkeypatch):
    (tmp_path / "F004-4").mkdir()
    monkeypatch.chdir(tmp_path)
    assert run("F004-4", "--size", 32).exit_code == 0
    (tmp_path / "teapot").mkdir()
    assert run("teapot", "--size", 32).exit_code == 0


@pytest.mark.parametrize("source", [SCRIPT, FIGURE])
def test_a_file_of_ones_own_is_shown(source, tmp_path, served):
    path = tmp_path / "mine.py"
    path.write_text(source)
    result = run(path)
    assert result.exit_code == 0, result.output
    (server,) = served
    picture = server.studio.machine(server.start)
    assert picture.codes.any()
    assert not server.studio.subjects.figures, "a file's window shows nothing but the file"


def test_a_mesh_is_shown_with_its_material(served):
    assert run("sphere", "--material", "blinn_phong", "--size", 32).exit_code == 0
    (server,) = served
    about = server.studio.about(server.start)
    assert {c["name"]: c["gesture"] for c in about["controls"]}.items() >= {
        "view": "orbit",
        "light": "light",
        "color": "",
    }.items()
    assert server.studio.machine(server.start).codes.shape == (32, 32, 4)


@pytest.mark.skipif(sys.platform == "win32", reason="Ctrl-C is another signal there")
def test_ctrl_c_ends_it_and_the_address_is_gone():
    command = [
        sys.executable,
        "-m",
        "fixedpipe.effects.cli",
        "view",
        "F004-4",
        "--size",
        "32",
        "--no-browser",
    ]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as running:
        assert running.stdout is not None and running.stderr is not None
        lines = [running.stdout.readline() for _ in range(2)]
        address = lines[1].strip()
        assert urllib.request.urlopen(address, timeout=HANGS).status == 200
        running.send_signal(signal.SIGINT)
        _, said = running.communicate(timeout=HANGS)
    assert running.returncode == 0 and "The viewer has ended." in said and "Traceback" not in said
    with pytest.raises(OSError, match="refused"):
        urllib.request.urlopen(address, timeout=HANGS)
