"""Readers of what users bring, fed files that are cut off and changed: values, or one sentence."""

import io
import os
import random
import warnings

import numpy as np
import pytest
from PIL import Image

from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.user_pictures.inputs import read_mesh, read_picture
from fixedpipe.effects.user_pictures.volume_files import data_file_of, read_nrrd
from tests.effects.cli.test_cli import refusal_of

# What only Python, NumPy or a decoder says.
LEAKS = (
    "StopIteration", "pickle", "buffer", "unpack", "Error", "Traceback", "object at", "None", "<class", "('",
    "dtype", "=-", "argument",
)  # fmt: skip
HEIGHTS = np.arange(48.0).reshape(6, 8) % 7
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]])
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0.5], [0, 1, 0.25]])
PLY = """ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
element face 2
property list uchar int vertex_indices
end_header
"""
OBJ = "v 0 0 0\nv 1 0 0\nv 1 1 0.5\nvt 0 1\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\n"
NRRD = b"NRRD0004\ntype: short\ndimension: 3\nsizes: 4 3 2\nencoding: %s\nendian: little\nspacings: 1 1 2\n\n"


def of_picture(kind):
    data = io.BytesIO()
    Image.fromarray((HEIGHTS * 36).astype(np.uint8)).save(data, kind)
    return data.getvalue()


def of_array():
    data = io.BytesIO()
    np.save(data, HEIGHTS)
    return data.getvalue()


def of_ply(binary):
    if not binary:
        lines = [" ".join(map(str, c)) for c in CORNERS] + [f"3 {a} {b} {c}" for a, b, c in TRIANGLES]
        return (PLY + "\n".join(lines) + "\n").encode()
    faces = np.array([(3, t) for t in TRIANGLES], [("count", "u1"), ("corners", "<i4", 3)])
    data = CORNERS.astype("<f4").tobytes() + faces.tobytes()
    return PLY.replace("ascii", "binary_little_endian").encode() + data


def of_nrrd(encoding):
    values = np.arange(24, dtype="<i2")
    text = " ".join(map(str, values)).encode()
    return NRRD % encoding.encode() + (values.tobytes() if encoding == "raw" else text)


def _nrrd(name):
    pytest.importorskip("nrrd")
    from pathlib import Path

    return read_nrrd(Path(name))


def _ply(name):
    pytest.importorskip("plyfile")
    return read_mesh(name)


FILES = {
    "a.png": (of_picture("PNG"), read_picture),
    "a.tiff": (of_picture("TIFF"), read_picture),
    "a.jpg": (of_picture("JPEG"), read_picture),
    "a.npy": (of_array(), read_picture),
    "text.ply": (of_ply(False), _ply),
    "binary.ply": (of_ply(True), _ply),
    "a.obj": (OBJ.encode(), read_mesh),
    "raw.nrrd": (of_nrrd("raw"), _nrrd),
    "text.nrrd": (of_nrrd("ascii"), _nrrd),
}


def changed(data, seed):
    """One to four bytes changed, taken out, or put twice."""
    chance, out = random.Random(seed), bytearray(data)
    for _ in range(chance.randint(1, 4)):
        at = chance.randrange(len(out))
        how = chance.randrange(4)
        if how < 2:
            out[at] = chance.randrange(256) if how else chance.choice(b"0123456789-. \n")
        elif how == 2:
            del out[at : at + chance.randint(1, 8)]
        else:
            out[at:at] = out[at : at + chance.randint(1, 8)]
    return bytes(out)


def outcome(path, data, read):
    """The sentence of a refusal, or None where the file is read. Anything else is raised."""
    path.write_bytes(data)
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # the terminal of a user is no place for a library's warnings
        try:
            read(str(path))
        except ValueError as refused:  # Refusal is one, and what the meshes' own module raises
            return str(refused)
    return None


def check_sentence(sentence, path):
    assert path.name in sentence and sentence.endswith(".") and "\n" not in sentence
    words = sentence.replace(str(path), "")
    assert not [leak for leak in LEAKS if leak in words], sentence


@pytest.mark.parametrize("name", FILES)
def test_a_file_cut_off_anywhere_is_read_or_refused_in_one_sentence(tmp_path, name, capfd):
    data, read = FILES[name]
    path = tmp_path / name
    assert outcome(path, data, read) is None
    # Pixels of a whole picture are many; its header and its end are where decoders stumble.
    lengths = range(len(data)) if len(data) < 800 else (*range(400), *range(len(data) - 400, len(data)))
    sentences = [s for n in lengths if (s := outcome(path, data[:n], read)) is not None]
    assert len(sentences) > len(lengths) / 2
    for sentence in set(sentences):
        check_sentence(sentence, path)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("name", FILES)
def test_a_changed_file_is_read_or_refused_in_one_sentence(tmp_path, name, capfd):
    data, read = FILES[name]
    path = tmp_path / name
    sentences = {outcome(path, changed(data, seed), read) for seed in range(250)}
    assert len(sentences) > 1
    for sentence in sentences - {None}:
        check_sentence(sentence, path)
    assert capfd.readouterr() == ("", "")


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
        (b"type: uchar\ndimension: 3\nsizes: 9999 9999 99\nencoding: raw\n", "up to 1073741824"),
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
