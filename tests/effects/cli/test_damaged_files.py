"""Readers of what users bring, fed files that are cut off and changed: values, or one sentence."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.user_pictures.inputs import read_mesh
from fixedpipe.effects.user_pictures.volume_files import data_file_of, read_nrrd
from tests.effects.cli.test_cli import refusal_of
from tests.mutants import outcome, wrong_with
from tests.support import user_files
from tests.support.sample import turn
from tests.support.user_files import NRRD, OBJ, of_picture, of_ply

ROOT = Path(__file__).parents[3]


def _nrrd(name):
    pytest.importorskip("nrrd")
    return read_nrrd(Path(name))


KINDS = (
    *("a.png", "deep.png", "a.tiff", "deep.tiff", "whole.tiff", "a.jpg", "a.npy", "a.asc"),
    *("a.pgm", "text.ply", "binary.ply", "a.obj", "raw.nrrd", "text.nrrd", "gzip.nrrd", "bzip2.nrrd"),
    *("a.hdr", "old.hdr", "a.exr", "chroma.exr", "a.npz", "a.binary"),
)
LIBRARIES = ("nrrd", "plyfile", "OpenImageIO", "OpenEXR", "tifffile")


def check_sentence(sentence, path):
    assert not wrong_with(sentence, path)


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    for library in LIBRARIES:
        pytest.importorskip(library)
    found = user_files.files(tmp_path_factory.mktemp("made"))
    assert tuple(found) == KINDS
    return found


@pytest.mark.parametrize("share", [4, pytest.param(1, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", KINDS[:-1])
def test_a_file_cut_off_anywhere_is_read_or_refused_in_one_sentence(tmp_path, name, files, capfd, share):
    data, read = files[name]
    path = tmp_path / name
    assert outcome(path, data, read) is None
    # Pixels of a whole picture are many; its header and its end are where decoders stumble.
    lengths = range(len(data)) if len(data) < 800 else (*range(400), *range(len(data) - 400, len(data)))
    lengths = lengths[turn(share) :: share]
    sentences = [s for n in lengths if (s := outcome(path, data[:n], read)) is not None]
    assert len(sentences) > len(lengths) / 2
    for sentence in set(sentences):
        check_sentence(sentence, path)
    assert capfd.readouterr() == ("", "")


def mutants(tmp_path, names, count):
    """Try mutants in a process of their own, whose memory ends at 1.5 GB; what it printed."""
    only = [word for name in names for word in ("--only", name)]
    command = [sys.executable, "-m", "tests.mutants", *only, "--count", str(count)]
    done = subprocess.run(
        [*command, "--folder", str(tmp_path)], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr[-3000:]
    assert not done.stderr
    return done.stdout


# In one process, which takes longer to start than to read a hundred files; it says each kind before it reads.
@pytest.mark.parametrize(("names", "count"), [(KINDS[:-1], 100), (KINDS[-1:], 30)])
def test_a_changed_file_is_read_or_refused_in_one_sentence(tmp_path, names, count, files):
    said = mutants(tmp_path, names, count)
    assert all(f"{name}: {count} mutants" in said for name in names)


@pytest.mark.slow
@pytest.mark.parametrize("name", KINDS[:-1])
def test_ten_thousand_changed_files_are_read_or_refused_in_one_sentence(tmp_path, name, files):
    assert "10000 mutants" in mutants(tmp_path, [name], 10_000)


def test_a_gif_is_refused_whatever_its_name(tmp_path):
    path = tmp_path / "a.png"
    Image.fromarray(np.eye(8, dtype=np.uint8)).save(path, "GIF")
    assert "Give a PNG, TIFF, JPEG or NPY file" in refusal_of("bump", path, "--out", tmp_path / "out.png")


def test_an_empty_array_and_one_of_objects_get_their_reasons(tmp_path):
    for array, words in (
        (np.zeros((0, 5)), "is empty"),
        (np.array([{}], dtype=object), "holds Python's objects"),
    ):
        np.save(tmp_path / "a.npy", array, allow_pickle=True)
        assert words in refusal_of("bump", tmp_path / "a.npy", "--out", tmp_path / "out.png")


@pytest.mark.parametrize(
    ("header", "words"),
    [
        (b"type: quux\ndimension: 3\nsizes: 4 3 2\nencoding: raw\n", "type 'quux'"),
        (b"type: uchar\ndimension: 3\nsizes: -4 3 2\nencoding: raw\n", "sizes -4 3 2"),
        (b"type: uchar\ndimension: 3\nsizes: 4 3 2\nencoding: raw\n", "has 5 bytes of values; 4x3x2"),
        (b"type: uchar\ndimension: 3\nencoding: raw\n", "without 'sizes'"),
        (b"type: uchar\ndimension: 3\nsizes: 9999 9999 99\nencoding: raw\n", "up to 135 million are read"),
        (b"type: short\ndimension: 3\nsizes: 4 3 2\nencoding: raw\n", "order of its bytes"),
        (b"type: uchar\ndimension: 3\nsizes: 4 3 2\nencoding: hex\n", "encoding 'hex'"),
    ],
)
def test_what_is_wrong_with_an_nrrd_header_is_said(tmp_path, header, words):
    path = tmp_path / "a.nrrd"
    path.write_bytes(b"NRRD0004\n" + header + b"\n12345")
    with pytest.raises(Refusal, match=words):
        _nrrd(path)


def detached(folder, name):
    path = folder / "a.nhdr"
    path.write_bytes(NRRD.rstrip(b"\n") % b"raw" + f"\ndata file: {name}\n".encode())
    return path


def test_a_header_opens_files_in_and_below_its_own_folder_alone(tmp_path):
    folder = tmp_path / "volumes"
    (folder / "parts").mkdir(parents=True)
    values = np.arange(24, dtype="<i2")
    for place in (folder / "parts" / "a.raw", tmp_path / "secret.raw"):
        values.tofile(place)
    for name in ("parts/a.raw", str(folder / "parts" / "a.raw"), "parts/../parts/a.raw"):
        read, spacing = _nrrd(detached(folder, name))
        np.testing.assert_array_equal(read.ravel(), values)
        assert spacing == (1.0, 1.0, 2.0)
    os.symlink(tmp_path / "secret.raw", folder / "link.raw")
    for name in ("../secret.raw", str(tmp_path / "secret.raw"), "parts/../../secret.raw", "link.raw"):
        with pytest.raises(Refusal, match="only files in or below its own folder"):
            _nrrd(detached(folder, name))
    with pytest.raises(Refusal, match="no such file beside it"):
        _nrrd(detached(folder, "none.raw"))


def test_the_file_that_a_header_names_is_no_output(tmp_path):
    values = np.arange(24, dtype="<i2")
    values.tofile(tmp_path / "a.png")
    path = detached(tmp_path, "a.png")
    assert data_file_of(path) == tmp_path / "a.png"
    assert "of which the picture is made" in refusal_of("volume", path, "--out", tmp_path / "a.png")
    assert (tmp_path / "a.png").read_bytes() == values.tobytes()


def test_a_mesh_file_opens_no_texture(tmp_path):
    pytest.importorskip("plyfile")
    data = of_ply(False).replace(b"element vertex", b"comment TextureFile /etc/hostname\nelement vertex")
    (tmp_path / "a.ply").write_bytes(data)
    assert len(read_mesh(str(tmp_path / "a.ply")).triangles) == 2


@pytest.mark.parametrize("name", ["hills.png", "link.png", "hard.png", "sub/../hills.png"])
def test_a_picture_never_replaces_what_it_is_made_of(tmp_path, monkeypatch, name):
    photo, mesh = tmp_path / "hills.png", tmp_path / "mesh.obj"
    photo.write_bytes(of_picture("PNG"))
    mesh.write_text(OBJ)
    (tmp_path / "sub").mkdir()
    (tmp_path / "link.png").symlink_to(photo)
    os.link(photo, tmp_path / "hard.png")
    (tmp_path / "mesh.png").symlink_to(mesh)
    monkeypatch.chdir(tmp_path)
    for command in (("bump", photo), ("volume", photo, "--dims", "8,6,2")):
        assert "of which the picture is made" in refusal_of(*command, "--out", name)
    for command in (("shadows", mesh), ("bump", photo, "--mesh", mesh)):
        assert "of which the picture is made" in refusal_of(*command, "--out", "mesh.png")
    assert photo.read_bytes() == of_picture("PNG") and mesh.read_text() == OBJ


@pytest.mark.parametrize(
    ("words", "wrong"), [("the size is (3, 4)", False), ("found '1 0 ('", False), ("found ('a', 1)", True)]
)
def test_what_a_sentence_quotes_of_a_file_is_no_tuple(tmp_path, words, wrong):
    assert bool(wrong_with(f"a.obj: {words}.", tmp_path / "a.obj")) == wrong
