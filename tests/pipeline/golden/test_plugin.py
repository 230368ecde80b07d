"""The fixture ``golden`` in a project's tests: what fails, what is kept, and what a whole run says."""

import json
import os
import stat
import subprocess
import sys
from xml.etree import ElementTree

import pytest

from fixedpipe.pipeline.golden.store import picture_path, read_store

HEAD = "import numpy as np\nimport pytest\nP = np.arange(24, dtype=np.uint8).reshape(2, 3, 4)\n"


@pytest.fixture
def project(tmp_path):
    """A project's folder, and what runs there: project(*arguments) is (status, what was printed)."""
    (tmp_path / "pytest.ini").write_text(
        "[pytest]\naddopts = -q -p no:cacheprovider -p no:hypothesispytest\n"
    )
    kept = {k: v for k, v in os.environ.items() if not k.startswith(("PYTEST", "COV_"))}

    class Project:
        folder = tmp_path
        store = tmp_path / "tests" / "golden" / "test_a.json"

        def write(self, text, name="test_a"):
            path = tmp_path / "tests" / f"{name}.py"
            path.parent.mkdir(exist_ok=True)
            path.write_text(HEAD + text)

        def __call__(self, *arguments, module="pytest"):
            done = subprocess.run(
                [sys.executable, "-B", "-m", module, *arguments],
                cwd=tmp_path,
                env=kept,
                capture_output=True,
                text=True,
                check=False,
            )
            return done.returncode, done.stdout + done.stderr

        def golden(self, *arguments):
            return self("golden", *arguments, module="fixedpipe.effects.cli")

        def candidates(self):
            return sorted(path.name for path in (tmp_path / ".golden" / "candidates").glob("*.png"))

    return Project()


MANY = """
def test_plain(golden):
    golden(P)

@pytest.mark.parametrize("n", [1, 2])
def test_many(golden, n):
    assert golden(P + np.uint8(n), name="first") in (True, False)
    golden(P + np.uint8(3 * n), name="second")

class TestShapes:
    def test_grey(self, golden):
        golden(P[..., 0])
"""
NAMES = [
    "TestShapes::test_grey",
    "test_many[1]::first",
    "test_many[1]::second",
    "test_many[2]::first",
    "test_many[2]::second",
    "test_plain",
]


def test_missing_pictures_fail_are_kept_for_a_look_and_recorded(project):
    project.write(MANY)
    status, said = project()
    assert status == 1
    assert "tests/test_a.py::test_many[2]::second has no golden picture: 3x2 pixels of colour" in said
    assert "6 have no golden picture yet" in said
    assert not project.store.exists()
    assert len(project.candidates()) == 6

    status, said = project.golden("record")
    assert (status, "6 recorded" in said) == (0, True), said
    assert sorted(read_store(project.store)) == NAMES
    assert all(picture_path(project.store, name).exists() for name in NAMES)
    assert project.candidates() == []
    assert project()[0] == 0
    # In processes, in parts, and of one module: never more, never less.
    for arguments in (("-n", "2"), ("-k", "plain"), ("tests/test_a.py::test_many",), ("tests/test_a.py",)):
        status, said = project(*arguments)
        assert status == 0, said
        assert "no test asks" not in said


def test_all_failures_of_a_test_are_told_with_the_test_s_own(project):
    project.write(MANY)
    project.golden("record")
    broken = MANY.replace("P + np.uint8(n)", "P + np.uint8(n + 1)")
    broken = broken.replace("uint8(3 * n)", "uint8(3 * n + 2)")
    own = "def test_own(golden):\n    golden(P, name='x')\n    assert False, 'my own'\n"
    project.write(f"{broken}\n\n{own}")
    for arguments in ((), ("-n", "2")):
        status, said = project(*arguments)
        assert status == 1
        assert "tests/test_a.py::test_many[1]::first: 6 pixels differ by at most 1" in said
        assert "tests/test_a.py::test_many[1]::second: 6 pixels differ by at most 2" in said
        assert "my own" in said
        assert "tests/test_a.py::test_own::x has no golden picture" in said
        assert "4 differ" in said
        assert len(project.candidates()) == 5
    before = project.store.read_text()

    status, said = project.golden("check", "--no-run", "--junit", "out.xml", "--json", "out.json")
    assert status == 1
    found = json.loads((project.folder / "out.json").read_text())
    assert [p["status"] for p in found["pictures"]] == ["changed"] * 4 + ["new"] + ["passed"] * 2
    assert [p["difference"]["largest"] for p in found["pictures"][:4]] == [2, 2, 1, 1]
    assert {"out.xml", "out.json", ".golden/run.json"} <= set(found["written"])
    assert all((project.folder / path).exists() for path in found["written"])
    suite = ElementTree.parse(project.folder / "out.xml").getroot()[0]
    assert (suite.attrib["tests"], suite.attrib["failures"]) == ("7", "5")

    name = "tests/test_a.py::test_many[1]::first"
    assert project.golden("accept", "tests/test_a.py::test_man[1]::first")[0] == 2
    assert project.store.read_text() == before
    status, said = project.golden("accept", name)
    assert (status, f"{name}: 6 pixels differ by at most 1" in said) == (0, True), said
    assert project("-k", "test_many")[1].count(name) == 0
    changed = set(project.store.read_text().splitlines()) ^ set(before.splitlines())
    assert len(changed) == 2


def test_orphans_fail_a_whole_run_alone(project):
    project.write(MANY)
    project.write("def test_b(golden):\n    golden(P)\n", "test_b")
    project.golden("record")
    renamed = MANY.replace("test_plain", "test_renamed").replace("[1, 2]", "[2]")
    project.write(renamed)
    (project.folder / "tests" / "test_b.py").unlink()
    other = project.folder / "tests" / "golden" / "another.json"
    other.write_text("not ours")
    status, said = project("-k", "grey")
    assert (status, "no test asks" in said) == (0, False)
    status, said = project()
    assert status == 1
    assert "test_plain has the same pixels; was the test renamed?" in said
    assert "4 are golden, and no test asks for them" in said
    orphans = [
        "tests/golden/test_b::test_b",
        "tests/test_a.py::test_many[1]::first",
        "tests/test_a.py::test_many[1]::second",
        "tests/test_a.py::test_plain",
    ]
    status, said = project.golden("orphans")
    assert (status, said.splitlines()) == (1, [*orphans, "4 orphans"])
    assert project("-n", "2", "--deselect", "tests/test_a.py::test_renamed")[0] == 0
    project()
    assert project.golden("orphans", "--remove")[0] == 0
    assert project.golden("accept", "tests/test_a.py::test_renamed")[0] == 0
    assert project()[0] == 0
    assert other.read_text() == "not ours"


def test_a_test_that_did_not_come_so_far_makes_no_orphans(project):
    project.write(MANY)
    project.golden("record")
    skipped = MANY.replace("    golden(P)\n", "    pytest.skip('today')\n")
    project.write(skipped.replace("assert golden", "assert 0 and golden"))
    status, said = project()
    assert status == 1
    assert "no test asks" not in said
    _, said = project.golden("check", "--no-run")
    assert "pictures: 5 missing, 1 passed" in said


def test_pictures_that_must_differ_and_relations(project):
    project.write(
        """
OTHER = P.copy()
OTHER[0, 0, 0] ^= 1
BUG = P

@pytest.mark.golden_differs
def test_bug_is_gone(golden):
    golden(BUG)

def test_relations(golden):
    assert golden.equal(P, P.copy()) and golden.differs(P, OTHER) and golden.differs(P, P[:1])
    assert golden.at_most(P, OTHER, max_diff=1, pixels=1) and golden.at_most(P, P, 0, 0)
    assert golden.at_most(P, OTHER, max_diff=(1, 1), pixels=(1, 4))

def test_relations_that_fail(golden):
    assert not golden.equal(P, OTHER) and not golden.differs(P, P.copy())
    assert not golden.at_most(P, OTHER, max_diff=0, pixels=1)
    assert not golden.at_most(P, OTHER, max_diff=1, pixels=0)
    assert not golden.at_most(P, P, max_diff=(1, 2), pixels=4)
    assert not golden.at_most(P, P[:1], max_diff=255, pixels=99)
"""
    )
    status, said = project("--golden-record")
    assert status == 1
    assert "1 failed, 2 passed" in said
    for sentence in (
        "two pictures must be equal: 1 pixel differs by at most 1, at (0, 0)",
        "two pictures must differ, and all their pixels are equal",
        "two pictures may differ by 0 to 0 in 0 to 1 pixels: 1 pixel differs",
        "two pictures may differ by 0 to 1 in 0 to 0 pixels: 1 pixel differs",
        "two pictures may differ by 1 to 2 in 0 to 4 pixels: all their pixels are equal",
        "one picture is 3x2 pixels of colour and alpha, uint8, the other 3x1",
    ):
        assert sentence in said
    status, said = project("-k", "bug")
    assert status == 1
    assert "must differ from its golden picture, and is equal to it" in said
    text = (project.folder / "tests" / "test_a.py").read_text()
    (project.folder / "tests" / "test_a.py").write_text(text.replace("BUG = P", "BUG = OTHER"))
    assert project("-k", "bug")[0] == 0


def test_what_is_no_picture_or_name_is_the_test_s_error(project):
    project.write(
        """
@pytest.mark.parametrize("name", ["a/b", "a\\\\b", "a:b", "", " a", "x" * 81, 3, "a\\n"])
def test_names(golden, name):
    with pytest.raises(ValueError, match="a name has 1 to 80 characters"):
        golden(P, name=name)

def test_twice(golden):
    golden(P)
    with pytest.raises(ValueError, match="second picture without a name"):
        golden(P)
    golden(P, name="a")
    with pytest.raises(ValueError, match="two pictures named 'a'"):
        golden(P, name="a")

def test_real_numbers(golden):
    golden(P / 255)
"""
    )
    status, said = project("--golden-record")
    assert status == 1
    assert "9 passed" in said and "1 failed" in said
    assert "np.rint(255 * np.clip(picture, 0, 1))" in said
    assert sorted(read_store(project.store)) == ["test_twice", "test_twice::a"]


def test_a_store_with_markers_of_a_merge_fails_in_a_sentence(project):
    project.write("def test_a(golden):\n    golden(P)\n")
    project.golden("record")
    text = project.store.read_text()
    project.store.write_text(f"<<<<<<< ours\n{text}=======\n{text}>>>>>>> theirs\n")
    status, said = project()
    assert status == 1
    assert "line 1: a merge left its conflict markers" in said
    assert "INTERNALERROR" not in said
    status, said = project.golden("record")
    assert status == 1
    assert project.store.read_text().startswith("<<<<<<< ours")


def test_settings_and_no_png_files(project):
    ini = project.folder / "pytest.ini"
    ini.write_text(ini.read_text() + "golden_folder = pictures/accepted\ngolden_png = false\n")
    project.write("def test_a(golden):\n    golden(P)\n")
    assert project.golden("record")[0] == 0
    folder = project.folder / "tests" / "pictures" / "accepted"
    assert [path.name for path in folder.rglob("*")] == ["test_a.json"]
    project.write("def test_a(golden):\n    golden(P + np.uint8(1))\n")
    status, said = project()
    assert (status, "its pixels differ (no PNG file of the golden picture is kept)" in said) == (1, True)
    for setting, sentence in (
        ("golden_orphans=maybe", "it is fail, warn or ignore"),
        ("golden_folder=../x", "name a folder beside the test modules"),
    ):
        status, said = project("-o", setting)
        assert (status, sentence in said) == (4, True)


@pytest.mark.skipif(os.name == "nt" or os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_that_cannot_be_written_does_not_fail_what_is_golden(project):
    project.write("def test_a(golden):\n    golden(P)\n")
    project.golden("record")
    folder = project.folder / ".golden"
    folder.chmod(stat.S_IRUSR | stat.S_IXUSR)
    try:
        status, said = project()
    finally:
        folder.chmod(stat.S_IRWXU)
    assert (status, "is not kept for a review" in said) == (0, True)


def test_a_workplace_that_is_a_file_does_not_fail_what_is_golden(project):
    project.write("def test_a(golden):\n    golden(P)\n")
    project.golden("record")
    for path in sorted((project.folder / ".golden").rglob("*"), reverse=True):
        path.rmdir() if path.is_dir() else path.unlink()
    (project.folder / ".golden").rmdir()
    (project.folder / ".golden").write_text("")
    status, said = project()
    assert (status, "is not kept for a review" in said) == (0, True), said
    project.write("def test_a(golden):\n    golden(P + np.uint8(1))\n")
    status, said = project()
    assert status == 1
    assert "what was drawn cannot be kept for a look" in said
    assert "INTERNALERROR" not in said
