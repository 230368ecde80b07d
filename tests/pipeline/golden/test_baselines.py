"""PNG files of other plug-ins become golden pictures: whose a file is, and what is never overwritten."""

import json
import subprocess
import sys

import numpy as np
import pytest
from PIL import Image

from fixedpipe.pipeline.framebuffers.pictures import whole_png
from fixedpipe.pipeline.golden import baselines
from fixedpipe.pipeline.golden.baselines import find_baselines, take_baselines
from fixedpipe.pipeline.golden.store import StoreError, picture_path, read_store

PICTURE = np.arange(24, dtype=np.uint8).reshape(2, 3, 4)
OTHER = PICTURE ^ np.uint8(1)
TESTS = ["test_plain", "test_many[1-a b]", "test_many[x/y]", "TestShapes::test_grey", "test_many[ü:]"]
# What the plug-ins named these tests' files: pytest-mpl 0.19.0, pytest-regressions 2.11.0, syrupy 7.0.2.
NAMES = {
    "test_plain": ["test_plain", "test_a.test_plain", "pkg.test_a.test_plain"],
    "test_many[1-a b]": ["test_many_1-a b", "test_many_1_a_b_", "test_many[1-a b]", "test_a.test_many_1-a b"],
    "test_many[x/y]": ["test_many_x_y", "test_many_x_y_", "test_many[xy]"],
    "TestShapes::test_grey": [
        "test_grey",
        "TestShapes_test_grey",
        "TestShapes.test_grey",
        "pkg.test_a.TestShapes.test_grey",
    ],
    "test_many[ü:]": ["test_many_ü:", "test_many_ü__", "test_many[ü]"],
}


@pytest.mark.parametrize(("test", "stem"), [(test, stem) for test in NAMES for stem in NAMES[test]])
def test_a_file_is_the_test_s_whose_name_it_has(tmp_path, test, stem):
    (tmp_path / f"{stem}.png").write_bytes(whole_png(PICTURE))
    found = find_baselines(tmp_path, "test_a", TESTS)
    assert found.of_tests == {test: tmp_path / f"{stem}.png"}
    assert not (found.of_nobody or found.shared)


def test_named_snapshots_are_named_pictures(tmp_path):
    for stem in ("test_plain[lit]", "test_many[1-a b][lit]", "TestShapes.test_grey[lit]", "test_other[lit]"):
        (tmp_path / f"{stem}.png").write_bytes(whole_png(PICTURE))
    found = find_baselines(tmp_path, "test_a", TESTS)
    assert sorted(found.of_tests) == [
        "TestShapes::test_grey::lit",
        "test_many[1-a b]::lit",
        "test_plain::lit",
    ]
    assert [path.name for path in found.of_nobody] == ["test_other[lit].png"]


def test_names_of_several_tests_and_of_none_are_told(tmp_path):
    for stem in ("test_grey", "test_b.test_plain", "xtest_a.test_plain", "TestShapes.test_grey"):
        (tmp_path / f"{stem}.png").write_bytes(whole_png(PICTURE))
    (tmp_path / "test_plain.txt").write_text("no picture")
    found = find_baselines(tmp_path, "test_a", [*TESTS, "TestOther::test_grey"])
    assert found.shared == {tmp_path / "test_grey.png": ["TestShapes::test_grey", "TestOther::test_grey"]}
    assert [path.name for path in found.of_nobody] == ["test_b.test_plain.png", "xtest_a.test_plain.png"]
    # Two files of one test: the first, by name, is taken.
    found = find_baselines(tmp_path, "test_a", TESTS)
    assert found.of_tests == {"TestShapes::test_grey": tmp_path / "TestShapes.test_grey.png"}
    assert found.shared == {tmp_path / "test_grey.png": ["TestShapes::test_grey"]}


def test_what_is_golden_stays_and_the_rest_is_taken(tmp_path):
    store = tmp_path / "golden" / "test_a.json"
    files = {name: tmp_path / f"{name}.png" for name in ("a", "b", "palette", "half", "gone")}
    for name in ("a", "b"):
        files[name].write_bytes(whole_png(PICTURE))
    Image.fromarray(PICTURE[..., :3]).quantize(4).save(files["palette"])
    files["half"].write_bytes(whole_png(PICTURE)[:50])
    taken = take_baselines(store, files)
    assert (taken.new, taken.equal, sorted(taken.left)) == (["a", "b"], [], ["gone", "half", "palette"])
    assert "has a palette" in taken.left["palette"]
    assert "no whole PNG file" in taken.left["half"]
    assert "No such file" in taken.left["gone"]
    assert list(read_store(store)) == ["a", "b"]
    assert picture_path(store, "a").read_bytes() == whole_png(PICTURE)
    before = store.read_bytes()

    files["a"].write_bytes(whole_png(OTHER))
    Image.fromarray(PICTURE).save(files["b"], compress_level=0)  # other bytes, the same pixels
    taken = take_baselines(store, {name: files[name] for name in "ab"})
    assert (taken.new, taken.equal) == ([], ["b"])
    assert taken.left == {
        "a": "another picture is golden, and stays: 6 pixels differ by at most 1, from (0, 0) to (2, 1); "
        "most at (0, 0): (0, 1, 2, 3), now (1, 0, 3, 2)"
    }
    assert store.read_bytes() == before
    assert picture_path(store, "a").read_bytes() == whole_png(PICTURE)


@pytest.mark.parametrize("error", [StoreError("No space left."), KeyboardInterrupt()])
def test_what_cannot_be_written_whole_takes_nothing(tmp_path, monkeypatch, error):
    store, calls, write = tmp_path / "golden" / "test_a.json", [], baselines.write_whole
    take_baselines(store, {})
    files = {}
    for name in "abc":
        files[name] = tmp_path / f"{name}.png"
        files[name].write_bytes(whole_png(PICTURE))
    take_baselines(store, {"a": files["a"]})
    before = store.read_bytes()

    def second_fails(path, data):
        calls.append(path)
        if len(calls) == 2:
            raise error
        write(path, data)

    monkeypatch.setattr(baselines, "write_whole", second_fails)
    with pytest.raises(type(error)):
        take_baselines(store, files)
    assert store.read_bytes() == before
    assert [path.name for path in store.with_suffix("").iterdir()] == ["a.png"]


MODULE = """
import numpy as np
import pytest

P = np.arange(24, dtype=np.uint8).reshape(2, 3, 4)

@pytest.mark.parametrize("n", [1, 2])
def test_many(golden, n):
    golden(P + np.uint8(n))
"""


@pytest.fixture
def project(tmp_path):
    """Runs a module of Python's in a project's folder: project(*arguments) is (status, what was printed)."""
    (tmp_path / "tests" / "baseline").mkdir(parents=True)
    (tmp_path / "tests" / "test_a.py").write_text(MODULE)
    (tmp_path / "pytest.ini").write_text("[pytest]\naddopts = -q -p no:cacheprovider\n")

    def run(*arguments):
        done = subprocess.run(
            [sys.executable, "-B", "-m", *arguments],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            check=False,
        )
        return done.returncode, done.stdout + done.stderr

    return run


def test_a_project_s_baselines_are_imported_and_its_tests_pass(project, tmp_path):
    folder = tmp_path / "tests" / "baseline"
    command = "fixedpipe.effects.cli", "golden", "import", "tests/baseline", "--into", "tests/test_a.py"
    for number in (1, 2):
        (folder / f"test_many_{number}.png").write_bytes(whole_png(PICTURE + np.uint8(number)))
    (folder / "test_b.png").write_bytes(whole_png(PICTURE))
    status, said = project(*command)
    assert status == 0, said
    assert said.splitlines() == [
        "tests/test_a.py::test_many[1]: golden, tests/baseline/test_many_1.png",
        "tests/test_a.py::test_many[2]: golden, tests/baseline/test_many_2.png",
        "tests/baseline/test_b.png: of no test in tests/test_a.py",
        "2 taken; tests/golden/test_a.json keeps them.",
    ]
    assert not (tmp_path / ".golden").exists()
    assert project("pytest")[0] == 0
    (folder / "test_many_2.png").write_bytes(whole_png(PICTURE))
    status, said = project(*command)
    assert status == 1
    assert "test_many[1]: was golden, with the same pixels" in said
    assert "test_many[2]: not taken: another picture is golden, and stays: 6 pixels differ by at most" in said
    assert project("pytest")[0] == 0


def test_where_nothing_can_be_imported_a_sentence_says_why(project, tmp_path):
    golden = "fixedpipe.effects.cli", "golden", "import"
    hashes = tmp_path / "hashes.json"
    hashes.write_text(json.dumps({"test_a.test_many": "0" * 64}))
    (tmp_path / "tests" / "baseline" / "else.png").write_bytes(whole_png(PICTURE))
    (tmp_path / "tests" / "test_broken.py").write_text("import nothing_of_this_name\n")
    (tmp_path / "tests" / "test_empty.py").write_text("")
    for folder, module, sentence in (
        (
            "hashes.json",
            "test_a",
            "digests of such files, as pytest-mpl's hash library has them, say nothing",
        ),
        ("tests/baseline", "test_none", "test_none.py is no file"),
        ("tests/baseline", "test_a", "Its files are else.png."),
        ("tests", "test_a", "tests has no PNG file"),
        ("tests/baseline", "test_broken", "nothing_of_this_name"),
        ("tests/baseline", "test_empty", "pytest finds no test in tests/test_empty.py"),
    ):
        status, said = project(*golden, folder, "--into", f"tests/{module}.py")
        assert (status, sentence in said) == (2, True), said
    assert not (tmp_path / "tests" / "golden").exists()


# ------------------------------------------------------------------------------------ the packages themselves


THEIRS = """
import numpy as np
import pytest
from PIL import Image

P = np.arange(24, dtype=np.uint8).reshape(2, 3, 4)

@pytest.mark.mpl_image_compare
@pytest.mark.parametrize("n", [1, 2])
def test_figure(n):
    from matplotlib.figure import Figure

    figure = Figure()
    figure.add_subplot().plot([n, 2, 1])
    return figure

@pytest.mark.parametrize("n", [1, "a b"])
def test_picture(n, image_regression):
    image_regression.check(Image.fromarray(P + np.uint8(len(str(n)))))
"""
OURS = """
import io

import numpy as np
import pytest
from PIL import Image

P = np.arange(24, dtype=np.uint8).reshape(2, 3, 4)

@pytest.mark.parametrize("n", [1, 2])
def test_figure(n, golden):
    from matplotlib import pyplot
    from matplotlib.figure import Figure

    with pyplot.style.context("classic", after_reset=True):
        figure = Figure()
        figure.add_subplot().plot([n, 2, 1])
        file = io.BytesIO()
        figure.savefig(file)
    golden(Image.open(file))

@pytest.mark.parametrize("n", [1, "a b"])
def test_picture(n, golden):
    golden(Image.fromarray(P + np.uint8(len(str(n)))))
"""


@pytest.mark.slow  # Matplotlib is imported by five processes
def test_what_the_packages_wrote_is_what_tests_draw_afterwards(project, tmp_path):
    pytest.importorskip("pytest_mpl", reason="pytest-mpl is not installed")
    pytest.importorskip("pytest_regressions", reason="pytest-regressions is not installed")
    module = tmp_path / "tests" / "test_a.py"
    module.write_text(THEIRS)
    project("pytest", "--mpl-generate-path=tests/baseline", "-k", "figure")
    project("pytest", "-k", "picture")  # fails, and writes
    assert sorted(path.name for path in tmp_path.rglob("*.png")) == [
        "test_figure_1.png",
        "test_figure_2.png",
        "test_picture_1_.png",
        "test_picture_a_b_.png",
    ]
    module.write_text(OURS)
    for folder in ("tests/baseline", "tests/test_a"):
        status, said = project(
            "fixedpipe.effects.cli", "golden", "import", folder, "--into", "tests/test_a.py"
        )
        assert (status, "2 taken" in said) == (0, True), said
    status, said = project("pytest", "-p", "no:mpl")
    assert (status, "4 passed" in said) == (0, True), said
