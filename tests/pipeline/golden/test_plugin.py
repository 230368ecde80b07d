"""The fixture ``golden`` in a project's tests: what fails, what is kept, and what a whole run says."""

import json
import os
import stat
import subprocess
import sys
from xml.etree import ElementTree

import pytest

from fixedpipe.pipeline.golden.store import change_store, picture_path, read_store

HEAD = "import numpy as np\nimport pytest\nP = np.arange(24, dtype=np.uint8).reshape(2, 3, 4)\n"


@pytest.fixture
def project(tmp_path):
    """A project's folder, and what runs there: project(*arguments) is (status, what was printed)."""
    (tmp_path / "pytest.ini").write_text(
        "[pytest]\naddopts = -q -p no:cacheprovider -p no:hypothesispytest\n"
    )

    class Project:
        folder = tmp_path
        store = tmp_path / "tests" / "golden" / "test_a.json"

        def write(self, text, name="test_a"):
            path = tmp_path / "tests" / f"{name}.py"
            path.parent.mkdir(exist_ok=True)
            path.write_text(HEAD + text)

        def __call__(self, *arguments, module="pytest"):
            kept = {k: v for k, v in os.environ.items() if not k.startswith(("PYTEST", "COV_"))}
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
    assert f"{name}\n         was accepted since this run" in project.golden("check", "--no-run")[1]
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
    assert "pictures: 4 missing, 1 excused, 1 passed" in said


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
        "(0, 0): (0, 1, 2, 3), in the second (1, 1, 2, 3)",
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
    assert sorted(read_store(project.store)) == ["test_twice::a"]


def test_pictures_without_a_name_are_numbered_in_their_order(project):
    text = """
def test_sizes(golden):
    for n in (1, 2, 4):
        golden(P + n)
    golden(P + 3, name="2")  # who has this name already

def test_drivers(golden):
    golden(P, variant="a")
    golden(P, variant="b")
    golden(P + 1, variant="b")
"""
    project.write(text)
    status, said = project("--golden-record")
    assert status == 1 and "test_sizes has two pictures named '2'" in said
    project.write(text.replace('name="2"', 'name="three"'))
    assert project("--golden-record")[0] == 0 and project()[0] == 0
    keys = sorted(read_store(project.store))
    assert [key for key in keys if "sizes" in key] == [
        f"test_sizes{n}" for n in ("", "::2", "::3", "::three")
    ]
    assert len([key for key in keys if "drivers" in key]) == 3
    project.write(text.replace('name="2"', 'name="three"').replace("(1, 2, 4)", "(1, 4, 4)"))
    status, said = project()
    assert status == 1 and "test_sizes::2" in said and "test_sizes::3" not in said


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


STATES = """
import os
import unittest

BUG = np.uint8(1 if os.environ.get("BUG") else 0)

def test_one(golden):
    golden(P + BUG)

def test_two(golden):
    golden(P)
"""


def test_a_run_of_some_tests_alone_makes_no_orphans_however_they_were_chosen(project, monkeypatch):
    project.write(STATES)
    project.write("def test_b(golden):\n    golden(P)\n", "test_b")
    project.golden("record")
    monkeypatch.setenv("BUG", "1")
    ini = project.folder / "pytest.ini"
    ini.write_text(ini.read_text().replace("-p no:cacheprovider ", ""))
    project()
    # --lf leaves test_two out and says so to nobody.
    status, said = project("--lf")
    assert (status, "1 failed" in said, "no test asks" in said) == (1, True, False), said
    # Nor does this conftest.
    (project.folder / "conftest.py").write_text(
        "def pytest_collection_modifyitems(items):\n"
        "    items[:] = [item for item in items if 'one' not in item.name]\n"
    )
    status, said = project()
    assert (status, "2 passed" in said, "no test asks" in said) == (0, True, False), said
    (project.folder / "conftest.py").unlink()
    # Stopped at the first failure: nothing is missing from what did not run.
    for arguments in (("-x",), ("-x", "-n", "2"), ("--maxfail=1",)):
        project(*arguments)
        assert "pictures: 1 changed, 2 passed" in project.golden("check", "--no-run")[1], arguments
    project("--collect-only")
    assert "pictures: 1 changed, 2 passed" in project.golden("check", "--no-run")[1]
    # Of another module what is known stays known.
    project("tests/test_b.py")
    assert "pictures: 1 changed, 2 passed" in project.golden("check", "--no-run")[1]
    (project.folder / "tests" / "test_a.py").unlink()
    project("tests/test_b.py")
    assert "pictures: 1 passed" in project.golden("check", "--no-run")[1]


def test_tests_that_are_skipped_or_expected_to_fail_are_excused(project, monkeypatch):
    project.write(
        STATES
        + """
@pytest.mark.xfail(reason="a known bug")
def test_known(golden):
    golden(P + BUG)

@pytest.mark.xfail(reason="nobody knows what is right")
def test_unknown(golden):
    golden(P, name="a")

def test_skipped(golden):
    golden(P, name="first")
    if BUG:
        pytest.skip("not today")
    golden(P, name="second")
"""
    )
    project.golden("record")
    assert "test_unknown::a" not in read_store(project.store)
    change_store(project.store, {"test_known": read_store(project.store)["test_one"]})
    monkeypatch.setenv("BUG", "1")
    status, said = project("--deselect", "tests/test_a.py::test_one")
    assert status == 0, said
    assert "golden pictures" not in said
    status, said = project.golden("check", "--", "--deselect", "tests/test_a.py::test_one")
    assert (status, "pictures: 2 excused, 4 passed" in said) == (0, True), said
    status, said = project.golden("check")
    assert (status, "pictures: 1 changed, 3 excused, 2 passed" in said) == (1, True), said


def test_a_process_that_crashes_leaves_its_pictures_missing(project, monkeypatch):
    project.write(STATES + "\ndef test_crash(golden):\n    golden(P)\n    BUG and os._exit(9)\n")
    project.golden("record")
    monkeypatch.setenv("BUG", "1")
    status, said = project("-n", "2")
    assert (status, "no test asks" in said) == (1, False), said
    assert "missing  tests/test_a.py::test_crash" in project.golden("check", "--no-run")[1]


def test_a_picture_that_a_test_expects_to_be_refused_is_nobody_s_to_look_at(project):
    project.write(
        "def test_a(golden):\n    golden(P)\n    with pytest.raises(ValueError):\n"
        "        golden(P / 255, name='real')\n"
    )
    project.golden("record")
    assert project.golden("check")[0] == 0


def test_unittest_s_tests_classes_and_odd_names(project, monkeypatch):
    names = ["a/b", "é", "🎨", "x" * 300, "a::b", "a[b]", "", " ", "\x00", "CON", "..", "new\nline", "A/B"]
    project.write(
        STATES
        + f"""
@pytest.fixture
def shown(golden):
    return lambda picture: golden(picture, name="shown")

def test_by_a_fixture(shown):
    shown(P + BUG)

class TestUnit(unittest.TestCase):
    @pytest.fixture(autouse=True)
    def _golden(self, golden):
        self.golden = golden

    def test_a(self):
        self.golden(P + BUG)

class TestOuter:
    class TestInner:
        def test_a(self, golden):
            golden(P + BUG)

@pytest.mark.parametrize("name", {names!r})
def test_names(golden, name):
    golden(P + BUG)
"""
    )
    (project.folder / "tests" / "__init__.py").write_text("")
    for package in ("one", "two"):
        (project.folder / "tests" / package).mkdir()
        (project.folder / "tests" / package / "__init__.py").write_text("")
        (project.folder / "tests" / package / "test_a.py").write_text(HEAD + STATES)
    status, said = project.golden("record")
    assert (status, f"{9 + len(names)} recorded" in said) == (0, True), said
    assert project("-n", "2")[0] == 0
    stores = [project.folder / "tests" / part / "golden" / "test_a.json" for part in ("one", "two")]
    assert all(list(read_store(store)) == ["test_one", "test_two"] for store in stores)
    assert len(list(project.store.with_suffix("").iterdir())) == 5 + len(names)
    monkeypatch.setenv("BUG", "1")
    status, said = project("-n", "2")
    assert (status, f"{6 + len(names)} differ" in said) == (1, True), said
    assert len(project.candidates()) == 6 + len(names)
    # Line ends of another system are no change of a picture.
    monkeypatch.delenv("BUG")
    project.store.write_bytes(project.store.read_bytes().replace(b"\n", b"\r\n"))
    assert project()[0] == 0


def test_a_project_is_run_from_anywhere_and_through_links(project):
    project.write(STATES)
    project.golden("record")
    command = [sys.executable, "-B", "-m", "pytest", "-q", "-p", "no:cacheprovider"]
    elsewhere = project.folder.parent / f"{project.folder.name}-link"
    elsewhere.symlink_to(project.folder)
    for folder, arguments in (
        (project.folder / "tests", []),
        (project.folder.parent, [str(project.folder / "tests")]),
        (elsewhere, []),
    ):
        done = subprocess.run([*command, *arguments], cwd=folder, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout


def test_two_runs_that_record_at_once_record_all_and_both_say_so(project):
    project.write(
        "@pytest.mark.parametrize('n', range(40))\ndef test_a(golden, n):\n    golden(P + np.uint8(n))\n"
    )
    command = [sys.executable, "-B", "-m", "fixedpipe.effects.cli", "golden", "record"]
    runs = [
        subprocess.Popen(command, cwd=project.folder, stdout=subprocess.PIPE, text=True) for _ in range(2)
    ]
    said = [run.communicate()[0] for run in runs]
    assert [run.returncode for run in runs] == [0, 0], said
    assert len(read_store(project.store)) == 40
    assert project.candidates() == []
    assert project()[0] == 0


EXPECTED = """
@pytest.mark.xfail(reason="known", strict=True)
def test_strict(golden):
    golden(P)

@pytest.mark.xfail(reason="known")
def test_lenient(golden):
    golden(P)

def test_plain(golden):
    golden(P)
"""


def test_recording_makes_nothing_golden_that_a_test_must_fail_with(project):
    project.write(EXPECTED)
    for _ in range(2):  # a run after another changes nothing
        status, said = project.golden("record")
        assert status == 0, said
        assert list(read_store(project.store)) == ["test_plain"]
        status, said = project()
        assert (status, "1 passed, 2 xfailed" in said) == (0, True), said
    assert "pictures: 2 excused, 1 passed" in project.golden("check")[1]


@pytest.mark.parametrize("how", [("--pdb",), ("-n", "2")])
def test_a_recorded_test_passes_with_a_debugger_and_with_other_processes(project, how):
    project.write(MANY)
    status, said = project("--golden-record", "-x", *how)
    assert (status, "4 passed" in said) == (0, True), said
    assert sorted(read_store(project.store)) == NAMES


@pytest.mark.parametrize(
    "damage", [lambda text: text[:100], lambda text: "<<<<<<< ours\n" + text, lambda text: text[1:]]
)
def test_a_damaged_store_fails_in_a_sentence_and_every_command_says_so(project, damage):
    project.write(MANY)
    project.golden("record")
    project.store.write_text(damage(project.store.read_text()))
    status, said = project("-k", "plain")
    failure = said[said.index("test_plain _") : said.index("=== short test summary")]
    assert status == 1
    assert len(failure.splitlines()) < 12, failure
    assert "StoreError" in failure and "json" not in failure.replace("test_a.json", "")
    assert "site-packages" not in failure and "asking.py" not in failure
    status, said = project.golden("check", "--no-run")
    assert "test_a.json" in said and "did not draw it" not in said
    status, said = project.golden("orphans")
    assert (status, "No picture is an orphan" in said, "test_a.json" in said) == (2, False, True), said


@pytest.mark.parametrize(
    "call", ["golden(P / 255)", "golden(P, name='a/b')", "golden(P, name='a'); golden(P, name='a')"]
)
def test_what_a_test_does_wrong_is_said_beside_its_own_line_alone(project, call):
    project.write(f"\ndef test_a(golden):\n    {call}\n")
    said = project()[1]
    assert f">       {call.split('; ')[-1]}" in said.replace("    golden", "       golden") or call in said
    assert "asking.py" not in said and "pixels.py" not in said
    assert len(said.splitlines()) < 25, said


def test_an_error_of_the_test_s_own_keeps_what_it_came_from(project):
    project.write(
        "def test_a(golden):\n    golden(P)\n    try:\n        int('one')\n    except ValueError as error:\n"
        "        raise ValueError('no scene') from error\n"
    )
    said = project()[1]
    assert "no scene" in said and "invalid literal for int" in said and "direct cause" in said


def test_accept_takes_all_patterns_and_what_pytest_chooses(project):
    def waiting():
        return len(project.candidates())

    project.write(MANY)
    project()
    assert waiting() == 6
    assert project.golden("accept", "tests/test_a.py::test_many[1]::*")[0] == 0
    assert sorted(read_store(project.store)) == NAMES[1:3]
    status, said = project.golden("accept", "-k", "Shapes or 2")
    assert status == 0, said
    assert sorted(read_store(project.store)) == [NAMES[0], *NAMES[1:5]]
    assert project.golden("accept", "--all")[0] == 0
    assert sorted(read_store(project.store)) == NAMES
    assert waiting() == 0


def test_a_pattern_of_names_needs_no_module(project):
    project.write(MANY)
    project()
    assert project.golden("accept", "test_many[1]::*")[0] == 0
    assert sorted(read_store(project.store)) == NAMES[1:3]


STRICT = """
import pytest

@pytest.mark.xfail(reason="known", strict=True)
def test_strict(golden):
    golden(P)

def test_plain(golden):
    golden(P)
"""


@pytest.mark.parametrize("choice", [("--all",), ("*",), ("-k", "strict or plain")])
def test_what_is_expected_to_fail_is_accepted_by_its_name_alone(project, choice):
    """With a golden picture it would pass, and strictly that is a failure."""
    project.write(STRICT)
    project()
    assert project.golden("accept", *choice)[0] == 0
    assert list(read_store(project.store)) == ["test_plain"]
    assert project()[0] == 0
    status, said = project.golden("accept", "--all")
    assert (status, "All pictures that wait are of tests that are expected" in said) == (2, True), said
    assert project.golden("accept", "tests/test_a.py::test_strict")[0] == 0
    assert sorted(read_store(project.store)) == ["test_plain", "test_strict"]


def test_accept_refuses_what_chooses_nothing(project):
    project.write(MANY)
    project()
    for arguments, sentence in (
        (("tests/test_a.py::test_lots*",), "No picture 'tests/test_a.py::test_lots*' waits"),
        (("tests/test_a.py::test_plan",), "Did you mean tests/test_a.py::test_plain?"),
        (("test_plain",), "Did you mean tests/test_a.py::test_plain?"),
        (("-k", "nobody"), "chooses no test whose picture waits"),
        ((), "one of the three"),
        (("--all", "-k", "plain"), "one of the three"),
    ):
        status, said = project.golden("accept", *arguments)
        assert (status, sentence in said) == (2, True), said
    assert len(project.candidates()) == 6


ALLOWED = """
def draw(golden):
    golden(P, at_most=(2, 1), reason="lines are rounded otherwise")
    golden(P, name="clock", ignore=[(0, 0, 1, 2)], reason="it shows the time")
    golden(P, name="exact")

def test_it(golden):
    draw(golden)
"""


def test_what_differs_by_no_more_than_is_allowed_passes_and_is_told(project):
    project.write(ALLOWED)
    project.golden("record")
    before = project.store.read_text()
    assert "allow" not in project()[1]  # equal pictures are equal, whatever would be allowed
    changed = ALLOWED.replace("def draw", "Q = P.copy()\nQ[1, 0, 0] += 2\ndef draw")
    project.write(
        changed.replace("golden(P,", "golden(Q,").replace('golden(Q, name="exact"', 'golden(P, name="exact"')
    )
    for arguments in ((), ("-n", "2")):
        status, said = project(*arguments)
        assert status == 0, said
        assert "2 passed within what their tests allow:" in said
        assert "test_it: 1 pixel differs by at most 2, at (0, 1): " in said
        assert "; reason: lines are rounded otherwise" in said
        assert "test_it::clock: 1 pixel differs where they are ignored; reason: it shows the time" in said
    status, said = project.golden("check", "--no-run", "--junit", "out.xml", "--json", "out.json")
    assert (status, said.splitlines()[-1]) == (0, "pictures: 2 allowed, 1 passed")
    assert "allowed  tests/test_a.py::test_it::clock" in said
    found = json.loads((project.folder / "out.json").read_text())["pictures"]
    assert [(p["status"], "reason" in p["told"]) for p in found] == [("allowed", True)] * 2 + [
        ("passed", False)
    ]
    top = ElementTree.parse(project.folder / "out.xml").getroot()
    assert ["reason" in out.text for out in top.iter("system-out")] == [True] * 2
    assert [suite.attrib["failures"] for suite in top] == ["0"]
    assert project.golden("review", "--html", "out.html")[0] == 0
    assert "2 differ by no more than their tests allow" in (project.folder / "out.html").read_text()
    assert project.candidates() == []

    project.write(changed.replace("P,", "Q + np.uint8(1),"))
    status, said = project()
    assert status == 1
    assert "test_it: 6 pixels differ by at most 3" in said
    assert "; 1 may, by at most 2" in said
    assert "test_it::clock: 4 pixels differ by at most 1" in said
    assert "2 pixels differ where they are ignored" in said
    assert "3 differ:" in said
    assert "passed within" not in said
    assert project.store.read_text() == before

    # Without the golden picture's file nothing can be allowed.
    project.write(changed.replace("golden(P,", "golden(Q,"))
    for path in project.store.with_suffix("").glob("*.png"):
        path.unlink()
    status, said = project()
    assert (status, "which what is allowed is judged by" in said) == (1, True), said


def test_what_must_differ_is_allowed_nothing(project):
    project.write(
        "@pytest.mark.golden_differs\ndef test_it(golden):\n    golden(P, at_most=(1, 1), reason='x')\n"
    )
    status, said = project()
    assert (status, "takes no allowance" in said) == (1, True), said


VARIANTS = """
OFF = {off}

@pytest.mark.parametrize("n", [1, 2])
def test_it(golden, n):
    golden(P + np.uint8(n + (OFF if n == 2 else 0)), name="side")

def test_plain(golden):
    golden(P)
"""


def test_a_variant_is_kept_beside_the_plain_picture_where_it_differs(project):
    project.write(VARIANTS.format(off=0))
    project.golden("record")
    plain = project.store.read_text()
    mesa = "--golden-variant=mesa-22.3"
    assert project(mesa)[0] == 0  # what is equal needs no picture of its own
    project.write(VARIANTS.format(off=1))
    name = "tests/test_a.py::test_it[2]::side:mesa-22.3"
    for _ in range(2):
        status, said = project(mesa, "--golden-record")
        assert status == 1
        assert f"{name}: 6 pixels differ by at most 1" in said
        assert "compared with test_it[2]::side, since this variant has no golden picture yet" in said
    assert project.golden("review", "--html", "out.html")[0] == 0
    assert project.golden("accept", "-k", "it and 2")[1].startswith(f"{name}: 6 pixels differ by at most 1")
    assert project.candidates() == []
    kept = read_store(project.store)
    assert set(kept) - set(NAMES) == {"test_it[1]::side", "test_it[2]::side", "test_it[2]::side:mesa-22.3"}
    # A line more, and none other.
    assert [
        line for line in project.store.read_text().splitlines() if "mesa" not in line
    ] == plain.splitlines()
    assert picture_path(project.store, "test_it[2]::side:mesa-22.3").exists()
    assert project(mesa, "-n", "2")[0] == 0

    # Whole runs of others know nothing of it, and it is no orphan; nor is the plain picture one of its runs.
    project.write(VARIANTS.format(off=0))
    for arguments in ((), ("--golden-variant=nvidia",)):
        status, said = project(*arguments)
        assert (status, "no test asks" in said) == (0, False), said
    status, said = project(mesa)
    assert (status, "now" in said, "compared with" in said) == (1, True, False), said
    # Where the test is gone, all its pictures are orphans.
    project.write("def test_plain(golden):\n    golden(P)\n")
    status, said = project()
    assert (status, "3 are golden, and no test asks for them" in said) == (1, True), said
    assert project.golden("orphans", "--remove")[1].endswith("3 orphans\n")
    assert list(read_store(project.store)) == ["test_plain"]


def test_a_variant_by_a_test_s_own_words_and_names_that_are_none(project):
    project.write(
        "def test_it(golden):\n    golden(P, variant='b')\n    golden(P + np.uint8(1), variant='a')\n"
    )
    assert project("--golden-record", "--golden-variant=c")[0] == 0
    assert sorted(read_store(project.store)) == ["test_it:a", "test_it:b"]
    assert project()[0] == 0
    project.write("def test_it(golden):\n    golden(P, variant='a:b')\n")
    status, said = project()
    assert (status, "The variant cannot be named 'a:b'" in said) == (1, True), said
    status, said = project("--golden-variant=")
    assert (status, "--golden-variant: The variant cannot be named ''" in said) == (4, True), said


# What pytest-rerunfailures and pytest-repeat do, in few lines.
TRIED_AGAIN = """
from _pytest.runner import runtestprotocol

def pytest_runtest_protocol(item, nextitem):
    for last in (False, True):
        item.ihook.pytest_runtest_logstart(nodeid=item.nodeid, location=item.location)
        reports = runtestprotocol(item, nextitem=nextitem, log=False)
        failed = any(report.failed for report in reports)
        for report in reports:
            if report.failed and not last:
                report.outcome = "rerun"
            item.ihook.pytest_runtest_logreport(report=report)
        if not failed:
            break
    return True

def pytest_report_teststatus(report):
    return ("rerun", "R", "RERUN") if report.outcome == "rerun" else None
"""
REPEATED = """
import pytest

@pytest.fixture
def __pytest_repeat_step_number(request):
    return request.param

@pytest.hookimpl(trylast=True)
def pytest_generate_tests(metafunc):
    name = "__pytest_repeat_step_number"
    metafunc.fixturenames.append(name)
    metafunc.parametrize(name, range(2), indirect=True, ids=lambda i: f"{i + 1}-2")
"""
FLAKY = """
drawn = []

@pytest.mark.parametrize("n", [1, 2])
def test_it(golden, n):
    drawn.append(n)
    golden(P + np.uint8({wrong}))

def test_plain(golden):
    golden(P)
"""


def test_a_test_that_passes_when_it_is_tried_again_is_told(project):
    project.write(FLAKY.format(wrong="n"))
    project.golden("record")
    (project.folder / "conftest.py").write_text(TRIED_AGAIN)
    assert "again" not in project()[1]
    project.write(FLAKY.format(wrong="n + (drawn == [1])"))
    status, said = project()
    assert status == 0, said
    assert "1 passed when its test was tried again:\n  tests/test_a.py::test_it[1]\n" in said
    assert "differs" not in said
    assert project.candidates() == []
    status, said = project.golden("check", "--no-run")
    assert (status, said.splitlines()[-1]) == (0, "pictures: 3 passed")
    assert "differed at first, and held when its test was tried again" in said
    # One that is new is recorded at the first try; one that differs always fails.
    project.store.unlink()
    status, said = project("--golden-record")
    assert (status, "3 recorded" in said, "rerun" in said) == (0, True, False), said
    project.write(FLAKY.format(wrong="n + 5"))
    status, said = project()
    assert (status, "2 differ:" in said, "again" in said) == (1, True, False), said


def test_repetitions_of_a_test_have_one_picture(project):
    project.write(FLAKY.format(wrong="n"))
    project.golden("record")
    before = project.store.read_text()
    (project.folder / "conftest.py").write_text(REPEATED)
    status, said = project()
    assert (status, said.splitlines()[-1][:8]) == (0, "6 passed"), said
    for drawn in ("[1]", "[1, 1]"):  # the first alone, and the second
        project.write(FLAKY.format(wrong=f"n + (drawn == {drawn})"))
        status, said = project()
        assert status == 1
        assert "1 differs:\n  tests/test_a.py::test_it[1]\n" in said
        assert len(project.candidates()) == 1
    project.write(FLAKY.format(wrong="n"))
    assert project()[0] == 0
    assert project.candidates() == []
    project.store.unlink()
    assert project("--golden-record")[0] == 0
    assert project.store.read_text() == before
