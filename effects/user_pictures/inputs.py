"""What users bring, read whole or refused: texts, photographs, elevation models and meshes, and the samples
that need no file.

What decoders say of arbitrary bytes is no sentence for a user; each refusal here is one.
"""

import importlib.util
import logging
import math
import re
import sys
import warnings
from pathlib import Path

import numpy as np

from fixedpipe.effects.refusal import Refusal

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


def read_mesh(name, smooth=False, tell=None):
    """A surface from an OBJ or a PLY file, with the file's normals or, at edges, creases; ``smooth``: with
    normals averaged at vertices where it has none. PLY files need the extra ``meshes``.

    ``tell`` is called with a line that says what was understood of the file. Raises Refusal for anything
    else, and ValueError with a sentence where the mesh has no faces, vertices that are no finite numbers, or
    no area.
    """
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
    surface = corners.surface(name, smooth)
    if tell is not None:
        tell(f"{name}: {corners.text(smooth)}")
    return surface
