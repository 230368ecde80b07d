"""What users bring, read whole or refused: texts, photographs, elevation models and meshes, and the samples
that need no file.

What decoders say of arbitrary bytes is no sentence for a user; each refusal here is one.
"""

import importlib.util
import io
import logging
import math
import re
import sys
import warnings
from pathlib import Path

import numpy as np

from fixedpipe.effects.refusal import Refusal

# Pictures inside the wheels of the extra `samples`; nothing is downloaded. Package, path, array of an NPZ.
SAMPLES = {
    "gravel": ("skimage", "data/gravel.png", None),
    "brick": ("skimage", "data/brick.png", None),
    "grass": ("skimage", "data/grass.png", None),
    "coins": ("skimage", "data/coins.png", None),
    "moon": ("skimage", "data/moon.png", None),
    "jacksboro": ("matplotlib", "mpl-data/sample_data/jacksboro_fault_dem.npz", "elevation"),
}

# Modes of files whose components are not red, green, blue or grey.
_OTHER_COLORS = ("CMYK", "YCbCr", "LAB", "HSV")


def _sample_path(name):
    from fixedpipe.effects.refusal import choose

    package, path, array = choose("sample", name, SAMPLES)
    found = importlib.util.find_spec(package)
    whole = Path(found.origin).parent / path if found else None
    if whole is None or not whole.is_file():
        raise Refusal(f"The sample {name!r} needs the extra `samples`: pip install 'fixedpipe[samples]'.")
    return whole, array


def read_picture(name):
    """A photograph or an elevation array, top row first: [rows, columns] or [rows, columns, components].

    ``name``: a PNG, TIFF (its first page; kinds that Pillow does not read by tifffile, where it is) or JPEG
    file, told apart by how they begin, a NumPy array (.npy), or ``sample:`` and a name of ``SAMPLES``. Raises
    Refusal for anything that cannot be read whole.
    """
    if name.startswith("sample:"):
        path, array = _sample_path(name.removeprefix("sample:"))
        if array:
            with np.load(path, allow_pickle=False) as arrays:
                return arrays[array]
    else:
        path = Path(name)
    if not path.is_file():
        problem = f"{name} is no file" if name and path.exists() else f"There is no file {name!r}"
        raise Refusal(f"{problem}. {_PICTURES}")
    try:
        picture = _read_array(path) if path.suffix.lower() == ".npy" else _read_image(path)
    except OSError as error:
        raise Refusal(f"{name} cannot be read: {error.strerror}.") from error
    if picture.dtype.kind not in "biuf":
        raise Refusal(f"{name} holds values of type {picture.dtype}; give an array of numbers.")
    return picture


_PICTURES = "Give a PNG, TIFF, JPEG or NPY file, or sample:gravel."
# How files begin. Source: their specifications.
_BEGINNINGS = {
    b"\x89PNG\r\n\x1a\n": "PNG",
    b"II*\0": "TIFF",
    b"MM\0*": "TIFF",
    b"II+\0": "BigTIFF",
    b"MM\0+": "BigTIFF",
    b"\xff\xd8\xff": "JPEG",
}


def _read_image(path):
    """The values of a PNG, TIFF or JPEG file. Raises Refusal and OSError."""
    with path.open("rb") as file:
        begin = file.read(8)
    kind = next((kind for first, kind in _BEGINNINGS.items() if begin.startswith(first)), None)
    if kind is None:
        raise Refusal(f"{path} {'is empty' if not begin else 'is no picture that is read here'}. {_PICTURES}")
    try:
        picture = _by_pillow(path)
    # A decoder fed arbitrary bytes raises whatever it stumbles over: struct.error, SyntaxError, EOFError.
    except Exception as error:
        if kind.endswith("TIFF") and (picture := _by_tifffile(path)) is not None:
            return _without_missing(path, picture)
        more = " Other kinds need the extra `elevations`: pip install 'fixedpipe[elevations]'."
        raise Refusal(
            f"{path} begins as a {kind} file and cannot be read to its end: it is cut off, damaged, of a "
            "kind that is not read here, or has too many pixels. Save it again."
            f"{more if kind.endswith('TIFF') and not importlib.util.find_spec('tifffile') else ''}"
        ) from error
    return _without_missing(path, picture) if kind.endswith("TIFF") else picture


def _by_pillow(path):
    import imageio.v3 as imageio

    with warnings.catch_warnings(), imageio.imopen(path, "r", plugin="pillow") as file:
        warnings.simplefilter("ignore")
        mode = file.metadata(index=0)["mode"]
        return np.asarray(file.read(index=0, mode="RGB" if mode in _OTHER_COLORS else None))


def _pages(path):
    """A TIFF file by tifffile, which knows more kinds than Pillow does. Raises ImportError without it."""
    import tifffile

    logging.getLogger("tifffile").setLevel(logging.CRITICAL)
    return tifffile.TiffFile(path)


# Of a TIFF file's first page.  Source: Pillow refuses pictures of more pixels.
_MOST_VALUES = 178_956_970


def _by_tifffile(path):
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with _pages(path) as file:
                page = file.pages[0]
                return np.asarray(page.asarray()) if page.size <= _MOST_VALUES else None
    except Exception:  # no tifffile, or whatever a decoder stumbles over, as above
        return None


# GDAL_NODATA, the number that stands for what was not measured.  Source: GDAL's GeoTIFF driver.
_NODATA = 42113


def _without_missing(path, picture):
    """A picture of a TIFF file. Raises Refusal where the file says that some of its values stand for none."""
    try:
        with _pages(path) as file:
            tag = file.pages[0].tags.get(_NODATA)
            nothing = float(str(tag.value).strip("\0 "))
    except Exception:  # no tifffile, no such tag, or no number in it
        return picture
    missing = int((picture == nothing).sum())
    if missing:
        raise Refusal(
            f"{path} has {missing} values of {nothing:g}, which stand for what was not measured; fill them "
            "before."
        )
    return picture


def _read_array(path):
    """The values of an NPY file. Raises Refusal and OSError."""
    formats, again = np.lib.format, "Write it with numpy.save, as an array of numbers."
    with path.open("rb") as file, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        begin = file.read(len(formats.MAGIC_PREFIX))
        if begin != formats.MAGIC_PREFIX:
            raise Refusal(f"{path} {'is no NPY file' if begin else 'is empty'}. {again}")
        try:
            file.seek(0)
            read_header = {1: formats.read_array_header_1_0, 2: formats.read_array_header_2_0}
            shape, _, dtype = read_header[formats.read_magic(file)[0]](file)
        except Exception as error:
            raise Refusal(f"{path} has a damaged NPY header. {again}") from error
        if dtype.hasobject:
            raise Refusal(f"{path} holds Python's objects. {again}")
        there, needed = path.stat().st_size - file.tell(), math.prod(shape) * dtype.itemsize
        if min(shape, default=0) < 0 or there < needed:
            raise Refusal(
                f"{path} is cut off: an array of shape {shape} and type {dtype} has {needed} bytes, and "
                f"{there} are there. {again}"
            )
        file.seek(0)
        try:
            return np.load(file, allow_pickle=False)
        except Exception as error:
            raise Refusal(f"{path} holds no array that can be read. {again}") from error


_UTF16 = (b"\xff\xfe", b"\xfe\xff")
_LINE_END = re.compile("\r\n?")


def text_of(data, otherwise=None):
    """The text of bytes, in UTF-8 or, where its mark begins them, in UTF-16; its lines ended by newlines.

    ``otherwise``: the encoding of what is neither. Raises UnicodeDecodeError where it is None.
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
    """The text of a file, or of standard input for ``-``, its lines ended by newlines.

    ``otherwise``: the encoding of what is not UTF-8. Raises Refusal when there is no such file, or no text.
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


def read_mesh(name):
    """A surface from an OBJ or a PLY file, with the file's normals or, at edges, creases. PLY files need the
    extra ``meshes``.

    Raises Refusal for anything else, and ValueError with a sentence where the mesh has no faces, vertices
    that are no finite numbers, or no area.
    """
    from fixedpipe.effects.geometry.triangle_meshes import read_obj, triangle_mesh, with_creases

    path, kind = Path(name), Path(name).suffix.lower()
    if kind not in (".obj", ".ply"):
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
    text = read_text(name) if kind == ".obj" else None
    surface = read_obj(text, name) if kind == ".obj" else triangle_mesh(*_read_ply(path), name)
    if len(surface.triangles) > _MOST_TRIANGLES:
        raise Refusal(
            f"{name} has {len(surface.triangles)} triangles; up to {_MOST_TRIANGLES} are drawn. Make it "
            "coarser."
        )
    return surface if text and "\nvn " in text else with_creases(surface)


def _read_ply(path):
    """Vertices and triangles of a PLY file. Raises Refusal."""
    try:
        import trimesh
    except ImportError as error:
        raise Refusal(
            f"{path} needs the extra `meshes`: pip install 'fixedpipe[meshes]'. OBJ files need nothing."
        ) from error
    try:
        data = path.read_bytes()
    except OSError as error:
        raise Refusal(f"{path} cannot be read: {error.strerror}.") from error
    header, end, _ = data.partition(b"end_header")
    if not header.startswith(b"ply"):
        raise Refusal(f"{path} does not begin with ply and is no PLY file. Give a whole PLY or OBJ file.")
    words = [line.split() for line in header.splitlines()]
    vertices = [line[-1] for line in words if line[:1] == [b"property"]]
    if not end or not {b"x", b"y", b"z"} <= set(vertices):
        lacking = "x, y and z of its vertices" if end else "its end, end_header"
        raise Refusal(f"{path} has a PLY header without {lacking}. Give a whole PLY or OBJ file.")
    try:
        # Vertices and faces as they are: nothing merged, nothing left out, and no texture's file opened.
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            mesh = trimesh.load_mesh(io.BytesIO(data), file_type="ply", process=False, skip_materials=True)
            return np.array(mesh.vertices), np.array(getattr(mesh, "faces", np.zeros((0, 3))))
    # A reader fed arbitrary bytes raises whatever it stumbles over.
    except Exception as error:
        raise Refusal(
            f"{path} has a damaged header, or fewer vertices and faces than it names. Give a whole PLY or "
            "OBJ file."
        ) from error
