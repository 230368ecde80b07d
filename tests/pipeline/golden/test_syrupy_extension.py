"""syrupy's snapshots of pictures: PNG files that are compared by their pixels."""

import subprocess
import sys

import numpy as np
import pytest
from PIL import Image

from fixedpipe.pipeline.golden import syrupy_extension
from fixedpipe.pipeline.golden.pixels import pixels_of

MODULE = """
import os

import numpy as np
import pytest

from fixedpipe.pipeline.golden.syrupy_extension import GoldenSnapshotExtension

P = np.arange(24, dtype=np.uint8).reshape(2, 3, 4)
if os.environ.get("BUG"):
    P[1, 2, 3] ^= 1

@pytest.fixture
def pictures(snapshot):
    return snapshot.use_extension(GoldenSnapshotExtension)

@pytest.mark.parametrize("n", [1])
def test_picture(pictures, n):
    assert pictures == P
    assert pictures(name="deep") == P.astype(np.uint16) * 257
"""


@pytest.fixture
def run(tmp_path):
    """Runs pytest with syrupy alone in a folder with the module: (status, what was printed)."""
    (tmp_path / "test_a.py").write_text(MODULE)
    (tmp_path / "pytest.ini").write_text("[pytest]\naddopts = -q -p no:cacheprovider\n")

    def run(*arguments):
        command = [sys.executable, "-B", "-m", "pytest", *arguments]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        return done.returncode, done.stdout + done.stderr

    return run


def test_snapshots_are_pictures_and_differ_by_their_pixels(run, tmp_path, monkeypatch):
    pytest.importorskip("syrupy", reason="syrupy is not installed")
    assert run()[0] == 1
    assert run("--snapshot-update")[0] == 0
    folder = tmp_path / "__snapshots__" / "test_a"
    assert sorted(path.name for path in folder.iterdir()) == [
        "test_picture[1].png",
        "test_picture[1][deep].png",
    ]
    picture = np.arange(24, dtype=np.uint8).reshape(2, 3, 4)
    np.testing.assert_array_equal(pixels_of(folder / "test_picture[1].png"), picture)
    deep = pixels_of(folder / "test_picture[1][deep].png")
    np.testing.assert_array_equal(deep, picture.astype(np.uint16) * 257)
    # Another program's file of the same pixels.
    Image.fromarray(picture).save(folder / "test_picture[1].png", compress_level=0, dpi=(72, 72))
    assert run()[0] == 0
    monkeypatch.setenv("BUG", "1")
    status, said = run()
    assert status == 1
    assert "1 pixel differs by at most 1, in alpha alone, at (2, 1): (20, 21, 22, 23), now" in said


def test_what_is_no_picture_is_the_test_s_error(run, tmp_path):
    pytest.importorskip("syrupy", reason="syrupy is not installed")
    (tmp_path / "test_a.py").write_text(MODULE.replace("pictures == P", "pictures == P / 255"))
    status, said = run("--snapshot-update")
    assert (status, "np.rint(255 * np.clip(picture, 0, 1))" in said) == (1, True), said


def test_without_syrupy_a_sentence_says_so(monkeypatch):
    for name in ("syrupy", "syrupy.extensions", "syrupy.extensions.single_file"):
        monkeypatch.setitem(sys.modules, name, None)
    syrupy_extension._extension.cache_clear()
    with pytest.raises(ImportError, match="an extension of syrupy, which is not installed here"):
        syrupy_extension.GoldenSnapshotExtension  # noqa: B018
    with pytest.raises(AttributeError, match="has no attribute 'Golden'"):
        syrupy_extension.Golden  # noqa: B018
