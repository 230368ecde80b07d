"""Reads users' files whole or refuses them: texts, photographs, elevation models and meshes; also samples
without files.

A decoder's message on arbitrary bytes does not help a user; each refusal here is a sentence.
"""

import importlib.util
import re
import sys
from pathlib import Path

import numpy as np

from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.user_pictures import picture_files
from fixedpipe.effects.user_pictures.reading import understood, without_missing

# How files of meshes are named.
MESH_KINDS = (".obj", ".ply")

# Pictures inside the wheels of the extra `samples`; nothing is downloaded. Package, path, array of an NPZ.
SAMPLES = {
    "gravel": ("skimage", "data/gravel.png", None),
    "brick": ("skimage", "data/brick.png", None),
    "grass": ("skimage", "data/grass.png", None),
    "coins": ("skimage", "data/coins.png", None),
    "moon": ("skimage", "data/moon.png", None),
    "jacksboro": ("matplotlib", "mpl-data/sample_data/jacksboro_fault_dem.npz", "elevation"),
}


def _sample_path(name):
    from fixedpipe.effects.refusal import choose

    package, path, array = choose("sample", name, SAMPLES)
    found = importlib.util.find_spec(package)
    whole = Path(found.origin).parent / path if found else None
    if whole is None or not whole.is_file():
        raise Refusal(f"The sample {name!r} needs the extra `samples`: pip install 'fixedpipe[samples]'.")
    return whole, array


def read_picture(name, *, fills=True):
    """A photograph or an elevation array, top row first: [rows, columns] or [rows, columns, components].

    ``name``: a PNG, TIFF (its first page), JPEG, ASC, HGT or PGM file, a NumPy array (.npy), or ``sample:``
    and a name of ``SAMPLES``. The picture is turned as the file says. ``reading.limit`` bounds how much is
    read. ``fills``: a number that means "no value", as NaN does. Such values are filled inside
    ``reading.filling``, and otherwise refused.

    Raises Refusal for anything that cannot be read whole.
    """
    notes = ()
    if name.startswith("sample:"):
        path, array = _sample_path(name.removeprefix("sample:"))
        if array:
            with np.load(path, allow_pickle=False) as arrays:
                picture = arrays[array]
            understood(name, picture)
            return picture
    else:
        path = Path(name)
    if not path.is_file():
        problem = f"{name} is no file" if name and path.exists() else f"There is no file {name!r}"
        raise Refusal(f"{problem}. {picture_files.ALLOWED}")
    try:
        picture, notes = picture_files.read(path)
    except OSError as error:
        raise Refusal(f"{name} cannot be read: {error.strerror}.") from error
    if picture.dtype.kind not in "biuf":
        raise Refusal(f"{name} holds values of type {picture.dtype}; give an array of numbers.")
    if fills and picture.dtype.kind == "f" and picture.ndim > 1:
        picture, filled = without_missing(name, picture, np.isnan(picture), "NaN")
        notes = (*notes, *filled)
    understood(name, picture, notes)
    return picture


_UTF16 = (b"\xff\xfe", b"\xfe\xff")
_LINE_END = re.compile("\r\n?")


def text_of(data, otherwise=None):
    """The text of bytes in UTF-8, or in UTF-16 with a byte order mark; its lines end with newlines.

    ``otherwise``: the encoding of other bytes. Raises UnicodeDecodeError if it is None.
    """
    if data.startswith(_UTF16):
        return _LINE_END.sub("\n", data.decode("utf-16"))
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        if otherwise is None:
            raise
        text = data.decode(otherwise)
    return _LINE_END.sub("\n", text)


def read_text(name, otherwise=None):
    """The text of a file, or of standard input for ``-``; its lines end with newlines.

    ``otherwise``: the encoding of bytes that are not UTF-8. Raises Refusal if there is no such file, or if it
    is not text.
    """
    try:
        return text_of(sys.stdin.buffer.read() if name == "-" else Path(name).read_bytes(), otherwise)
    except UnicodeDecodeError as error:
        raise Refusal(f"{name} is not a text file ({error.reason} at byte {error.start}).") from error
    except OSError as error:
        raise Refusal(f"{name} cannot be read: {error.strerror}.") from error
    except ValueError as error:
        raise Refusal(f"{name!r} cannot be read: {error}.") from error


# Assumed: no mesh of so many bytes or triangles is drawn within a minute.
_LARGEST_MESH, _MOST_TRIANGLES = 256 << 20, 500_000


def read_mesh(name, smooth=False, tell=None):
    """A surface from an OBJ or a PLY file, with the file's normals or, at edges, creases; ``smooth``: with
    normals averaged at vertices where it has none. PLY files need the extra ``meshes``.

    ``tell`` is called with a line that says how the file was understood. Raises Refusal for anything else,
    and ValueError with a sentence if the mesh has no faces, vertices that are not finite, or no area.
    """
    corners = read_corners(name)
    surface = corners.surface(name, smooth)
    if tell is not None:
        tell(f"{name}: {corners.text(smooth)}")
    return surface


def read_corners(name):
    """The Corners of an OBJ or a PLY file, of which ``read_mesh`` makes a surface. Raises as it does."""
    from fixedpipe.effects.geometry.triangle_meshes import obj_corners
    from fixedpipe.effects.user_pictures.ply_files import read_ply

    path, kind = Path(name), Path(name).suffix.lower()
    if kind not in MESH_KINDS:
        raise Refusal(f"{name!r} is no mesh; give an OBJ or a PLY file.")
    try:
        size = path.stat().st_size
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise Refusal(f"{name} cannot be read: {reason}.") from error
    if not path.is_file():
        raise Refusal(f"{name} is no file; give an OBJ or a PLY file.")
    if size > _LARGEST_MESH:
        raise Refusal(
            f"{name} has {size >> 20} MiB; meshes of up to {_LARGEST_MESH >> 20} MiB are read. Make it "
            "coarser."
        )
    # Names and comments may be in any encoding; what is read is ASCII.
    corners = obj_corners(read_text(name, otherwise="latin-1"), name) if kind == ".obj" else read_ply(path)
    if len(corners.points) > _MOST_TRIANGLES:
        raise Refusal(
            f"{name} has {len(corners.points)} triangles; up to {_MOST_TRIANGLES} are drawn. Make it coarser."
        )
    return corners
