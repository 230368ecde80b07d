"""``fixedpipe volume``: raw and NRRD volumes become pictures, and what is none ends with one sentence."""

import bz2
import gzip
import sys

import numpy as np
import pytest
from PIL import Image

from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.user_pictures.volume_files import read_nrrd
from tests.effects.cli.test_cli import refusal_of, run

nrrd = pytest.importorskip("nrrd")

DIMS = (12, 10, 9)  # x, y, z
HEADER = b"NRRD0004\ntype: float\ndimension: 3\nencoding: raw\n"


def values():
    """A ball's distances, floats [z, y, x], below 1 inside."""
    axes = [(np.arange(n) + 0.5) / n * 2.4 - 1.2 for n in reversed(DIMS)]
    z, y, x = np.meshgrid(*axes, indexing="ij")
    return 2.0 - np.sqrt(x * x + y * y + z * z)


@pytest.fixture
def raw(tmp_path):
    """The ball as raw big-endian uint16, from 0 to 2000, behind a header of 5 bytes."""
    path = tmp_path / "ball.raw"
    path.write_bytes(b"magic" + (1000 * values()).astype(">u2").tobytes())
    return path


RAW = ("--dims", "12,10,9", "--type", "uint16", "--endian", "big", "--skip", 5)


def volume(file, out, *more):
    return ("volume", file, "--out", out, "--size", 24, "--slices", 32, *more)


@pytest.mark.parametrize("profile", ["OCTANE", "GEFORCE_3"])
def test_a_raw_volume_becomes_a_picture_and_what_was_changed_is_said(raw, tmp_path, profile):
    out = tmp_path / "ball.png"
    result = run(*volume(raw, out, *RAW, "--iso", 1000, "--profile", profile))
    assert result.exit_code == 0, result.output
    assert "16x16x16 voxels resampled from 12x10x9" in result.stdout
    assert "surface at 1000" in result.stdout
    picture = np.asarray(Image.open(out)).astype(int)
    assert picture.shape == (24, 24, 3)
    seen = (picture != picture[0, 0]).any(axis=-1)
    # One brick holds the whole volume, and all of it would fit.
    assert 0.15 < seen.mean() < 0.9
    assert seen[12, 12]
    assert not seen[[0, -1]].any()


def test_an_nrrd_file_gives_the_same_picture_as_its_raw_values(raw, tmp_path):
    file, a, b = tmp_path / "ball.nrrd", tmp_path / "a.png", tmp_path / "b.png"
    data = (1000 * values()).astype(np.uint16)
    turned = np.array([[0.0, 3.0, 4.0], [5.0, 0.0, 0.0], [0.0, 6.0, 8.0]])
    assert run(*volume(raw, b, *RAW, "--iso", 1000, "--spacing", "1,1,2")).exit_code == 0
    for header in (
        {"spacings": [1.0, -1.0, 2.0]},
        {"space": "right-anterior-superior", "space directions": turned},
    ):
        nrrd.write(str(file), data, header, index_order="C")
        assert run(*volume(file, a, "--iso", 1000)).exit_code == 0
        assert a.read_bytes() == b.read_bytes()
    nrrd.write(str(file), data, {"spacings": [1.0, np.nan, 2.0]}, index_order="C")
    assert "spacing" in refusal_of(*volume(file, a))
    assert run(*volume(raw, b, *RAW, "--iso", 1000)).exit_code == 0
    assert a.read_bytes() != b.read_bytes()


def test_shadows_darken_and_can_be_left_out(tmp_path):
    pictures = []
    for option in ("--shadows", "--no-shadows"):
        out = tmp_path / "engine.png"
        assert run(*volume("sample:engine", out, option, "--light=-2,1,0")).exit_code == 0
        pictures.append(np.asarray(Image.open(out)).astype(int))
    assert (pictures[0] <= pictures[1]).all()
    assert (pictures[0] < pictures[1] - 20).any()


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ((), ["--dims X,Y,Z"]),
        (("--dims", "12,10"), ["dimensions", "256,256,110"]),
        (("--dims", "12,10,1"), ["dimensions"]),
        (("--dims", "a,b,c"), ["dimensions"]),
        (
            ("--dims", "99999,99999,99999"),
            ["99999 x 99999 x 99999 voxels", "up to 135 million", "--limit 999970001"],
        ),
        (("--dims", "12,10,9"), ["2165 bytes", "uint8 are 1080"]),
        ((*RAW, "--skip", 9999), ["2165 bytes, and --skip 9999 leaves none"]),
        ((*RAW, "--skip", 9), ["2156 bytes after the 9 skipped"]),
        (("--dims", "12,10,9", "--type", "uint61"), ["uint61", "Did you mean uint16?"]),
        (("--dims", "12,10,9", "--endian", "middle"), ["middle", "little, big"]),
        ((*RAW, "--iso", 5000), ["5000", "give one between"]),
        ((*RAW, "--iso", "nan"), ["give one between"]),
        ((*RAW, "--spacing", "1,0,1"), ["spacing", "positive"]),
        ((*RAW, "--light", "0,0,0"), ["direction to the light"]),
        ((*RAW, "--view", "1,2"), ["direction to the eye"]),
        ((*RAW, "--view", "0,3,0"), ["looks along"]),
        ((*RAW, "--profile", "GEFORCE_256"), ["GeForce 256", "OCTANE", "GEFORCE_3", "FUTURE, IDEAL."]),
        ((*RAW, "--profile", "OCTAN"), ["Did you mean OCTANE?"]),
        ((*RAW, "--size", 4096), ["2048x2048"]),
    ],
)
def test_a_volume_that_cannot_be_drawn_is_refused(raw, tmp_path, more, words):
    out = tmp_path / "none.png"
    sentence = refusal_of(*volume(raw, out, *more))
    for word in words:
        assert word in sentence
    assert not out.exists()


@pytest.mark.parametrize(
    ("name", "data", "word"),
    [
        ("a.nrrd", b"nothing of the kind", "NRRD"),
        ("a.nrrd", b"", "NRRD"),
        ("a.nrrd", HEADER + b"sizes: 9 9 9\nendian: little\n\n12", "2 bytes of values"),
        ("a.nrrd", HEADER + b"sizes: 99999 99999 99999\n\n", "up to 135 million are read"),
        ("a.nhdr", HEADER + b"sizes: 9 9 9\nendian: little\ndata file: none.raw\n", "none.raw"),
    ],
)
def test_a_file_that_is_no_nrrd_is_refused(tmp_path, name, data, word):
    file = tmp_path / name
    file.write_bytes(data)
    assert word in refusal_of(*volume(file, tmp_path / "none.png"))


@pytest.mark.parametrize("file", ["sample:engine", "a.nrrd", "a.NHDR"])
def test_options_of_a_raw_file_are_refused_of_another(tmp_path, file):
    for option in (("--dims", "8,8,8"), ("--type", "uint8"), ("--endian", "little"), ("--skip", 0)):
        sentence = refusal_of(*volume(file, tmp_path / "none.png", *option))
        assert f"{option[0]} would be ignored" in sentence


def test_an_nrrd_picture_is_no_volume(tmp_path):
    file = tmp_path / "flat.nrrd"
    nrrd.write(str(file), np.eye(4))
    assert "three edges" in refusal_of(*volume(file, tmp_path / "none.png"))


def test_missing_files_samples_and_packages_are_refused(tmp_path, monkeypatch):
    assert "There is no file" in refusal_of(*volume(tmp_path / "none.raw", tmp_path / "none.png"))
    assert "is no file" in refusal_of(*volume(tmp_path, tmp_path / "none.png"))
    assert "There are: engine" in refusal_of(*volume("sample:motor", tmp_path / "none.png"))
    assert "none.png instead" in refusal_of(*volume("sample:engine", tmp_path / "none.jpg"))
    file = tmp_path / "a.nrrd"
    nrrd.write(str(file), np.eye(4))
    monkeypatch.setitem(sys.modules, "nrrd", None)
    assert "fixedpipe[volumes]" in refusal_of(*volume(file, tmp_path / "none.png"))


def _written(folder, head, data, name="a.nrrd"):
    path = folder / name
    path.write_bytes(b"NRRD0004\n" + head + b"\n" + data)
    return path


def _packed(values):
    """The same bytes at any second: two processes of one run must give a case of them the same name."""
    return gzip.compress(values, mtime=0)


def test_ends_of_lines_letters_and_streams_after_each_other_change_nothing(tmp_path):
    data = np.arange(24, dtype="<u2")
    raw, half = data.tobytes(), len(data.tobytes()) // 2
    head = b"type: ushort\ndimension: 3\nsizes: 4 3 2\nencoding: %s\nendian: little\n"
    packed = _packed(raw)
    for encoding, values, more in (
        (b"raw", raw, b""),
        (b"raw", raw + b"\n", b""),
        (b"raw", raw + b"\r\n\r\n", b""),
        (b"raw", b"12345" + raw, b"byte skip: 5\n"),
        (b"raw", b"of any length" + raw, b"byte skip: -1\n"),
        (b"raw", b"a line\nanother\n" + raw, b"line skip: 2\n"),
        (b"gzip", packed, b""),
        (b"gz", packed + b"\n and what is no stream", b""),
        (b"gzip", _packed(raw + b"\n"), b""),
        (b"gzip", _packed(raw[:half]) + _packed(raw[half:]), b""),
        (b"gzip", _packed(b"123" + raw), b"byteskip: 3\n"),
        (b"bzip2", bz2.compress(raw[:7]) + bz2.compress(raw[7:]), b""),
        (b"ascii", b" ".join(b"%d" % n for n in data) + b"\n\n", b""),
    ):
        fields = head % encoding + more
        shouted = b"".join(
            line.partition(b":")[0].title() + b":" + line.partition(b":")[2].upper() + b"\n"
            for line in fields.splitlines()
        )
        for written in (fields, shouted):
            path = _written(tmp_path, written, values)
            found, _ = read_nrrd(path)
            np.testing.assert_array_equal(found.ravel(), data)
            assert found.shape == (2, 3, 4)


@pytest.mark.parametrize(
    ("head", "data", "words"),
    [
        (b"encoding: raw\n", bytes(24) + b"more", "has 28 bytes of values; 4x3x2"),
        (b"encoding: raw\n", bytes(24) + b"\n" * 40, "has 64 bytes of values"),
        (b"encoding: gzip\n", _packed(bytes(24) + b"more"), "has more values than it names"),
        (b"encoding: gzip\n", _packed(bytes(23)), "too few of them: 23 bytes of values"),
        (b"encoding: gzip\n", _packed(bytes(24))[:12], "has damaged data, or too few"),
        (b"encoding: gzip\n", b"no stream at all", "has damaged data, or too few"),
        (b"encoding: gzip\nbyte skip: -1\n", _packed(bytes(24)), "before its values, and has fewer"),
        (b"encoding: ascii\n", b"1 " * 25, "has more than the 24 values"),
        (b"encoding: raw\ndata file: LIST\na.raw\nb.raw\n", b"", r"several files \(LIST\)"),
        (b"encoding: raw\ndata file: LIST 2\na.raw\n", b"", r"several files \(LIST 2\)"),
        (b"encoding: raw\nDATAFILE: s%02d.raw 0 23 1 2\n", b"", r"several files \(s%02d.raw 0 23 1 2\)"),
    ],
)
def test_more_and_fewer_values_and_several_files_are_said(tmp_path, head, data, words):
    path = _written(tmp_path, b"type: uchar\ndimension: 3\nsizes: 4 3 2\n" + head, data)
    with pytest.raises(Refusal, match=words):
        read_nrrd(path)
