"""Pictures and grids of heights as files: their values unchanged, in their own type.

A picture is turned as its file says.

A file's header is read first: the number of pixels decides whether more is read.

Source: PNG specification, second edition; TIFF 6.0; Exif 2.3 (orientation); GDAL's GeoTIFF driver
(GDAL_NODATA); Esri's ASCII raster format; the SRTM's .hgt files; Netpbm's PGM.
"""

import logging
import math
import re
import struct
import sys
import warnings
import zlib

import numpy as np

from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.user_pictures import arrays
from fixedpipe.effects.user_pictures.reading import PIXELS, check_count, silent, whole, without_missing

ALLOWED = "Give a PNG, TIFF, JPEG or NPY file, a grid (.asc, .hgt, .pgm), or sample:gravel."
# Modes of Pillow's whose components are not red, green, blue or grey.
_OTHER_COLORS = ("CMYK", "YCbCr", "LAB", "HSV")
_SAVE_AGAIN = "Save it again"


def read(path):
    """(values, notes) of a file: [rows, columns] or [rows, columns, components], top row first, and what else
    was made of it, in words. Raises Refusal and OSError.
    """
    ending = path.suffix.lower()
    if ending == ".npy":
        return _array(path), ()
    if ending == ".hgt":
        return _hgt(path)
    with path.open("rb") as file:
        begin = file.read(16)
    for first, found in _READERS:
        if re.match(first, begin, re.DOTALL | re.IGNORECASE):
            return found(path)
    raise Refusal(f"{path} {'is empty' if not begin else 'is no picture that is read here'}. {ALLOWED}")


# -------------------------------------------------------------------------------------------- orientation

ORIENTATION = 274  # the tag of Exif and TIFF
# How rows and columns are turned to be seen, by the number in the file.  Source: Exif 2.3.
_TURNS = {
    2: lambda a: a[:, ::-1],
    3: lambda a: a[::-1, ::-1],
    4: lambda a: a[::-1],
    5: lambda a: a.swapaxes(0, 1),
    6: lambda a: a.swapaxes(0, 1)[:, ::-1],
    7: lambda a: a.swapaxes(0, 1)[::-1, ::-1],
    8: lambda a: a.swapaxes(0, 1)[::-1],
}


def turned(values, orientation):
    """Values [rows, columns, ...], turned as an Exif or TIFF orientation says."""
    return _TURNS.get(orientation, lambda a: a)(values)


def _turned_with_note(values, orientation):
    notes = (f"turned as its orientation {orientation} says",) if orientation in _TURNS else ()
    return turned(values, orientation), notes


# ------------------------------------------------------------------------------------- PNG and JPEG


def _png(path):
    damaged = "begins as a PNG file and cannot be read to its end: it is cut off or damaged"
    with whole(path, damaged, f"{_SAVE_AGAIN}."):
        with path.open("rb") as file:
            columns, rows, bits, color = struct.unpack(">16xIIBB", file.read(26))
        check_count(path, (columns, rows), "pixels", PIXELS)
        if bits == 16 and color != 0:  # Pillow cuts colours and grey with alpha to 8 bits
            return through_openimageio(path, "PNG"), ()
        return _by_pillow(path, "PNG")


def _jpeg(path):
    damaged = "begins as a JPEG file and cannot be read to its end: it is cut off or damaged"
    with whole(path, damaged, f"{_SAVE_AGAIN}."):
        return _by_pillow(path, "JPEG")


def _by_pillow(path, kind):
    """(values, notes) by Pillow, which is right where there are 8 bits a component, or one component."""
    from PIL import Image

    with warnings.catch_warnings(), silent(), _any_size(Image):
        warnings.simplefilter("ignore")
        with Image.open(path, formats=(kind,)) as image:
            check_count(path, image.size, "pixels", PIXELS)
            orientation = _orientation_of(image)
            if image.mode == "P":
                image = image.convert(image.palette.mode)
            elif image.mode in _OTHER_COLORS:
                image = image.convert("RGB")
            elif kind == "PNG" and image.mode == "I":
                image = image.convert("I;16" if sys.byteorder == "little" else "I;16B")
            return _turned_with_note(np.asarray(image), orientation)


def _orientation_of(image):
    try:
        return image.getexif().get(ORIENTATION, 1)
    except Exception:  # what the camera left is damaged; the pixels need not be
        return 1


class _any_size:  # noqa: N801 (a context)
    """Pillow warns of many pixels and refuses more; what is read here was counted."""

    def __init__(self, module):
        self.module, self.before = module, module.MAX_IMAGE_PIXELS

    def __enter__(self):
        self.module.MAX_IMAGE_PIXELS = None

    def __exit__(self, *raised):
        self.module.MAX_IMAGE_PIXELS = self.before


def through_openimageio(path, kind):
    """The values of a file's first picture by OpenImageIO, in the file's own type: [rows, columns(, c)].

    Raises Refusal without the library, with its own words where it cannot read the file, and for more than
    four components.
    """
    try:
        import OpenImageIO as oiio  # noqa: N813
    except ImportError:
        raise Refusal(
            f"{path} is a {kind} file of a kind that needs the extra `probes`: pip install "
            "'fixedpipe[probes]'."
        ) from None
    with silent():
        return _opened(path, kind, oiio)


def _opened(path, kind, oiio):
    asked = oiio.ImageSpec()
    asked.attribute("oiio:UnassociatedAlpha", 1)  # colours are not multiplied by alpha
    file = oiio.ImageInput.open(str(path), asked)
    if file is None:
        raise _unread(path, kind, oiio.geterror())
    try:
        spec = file.spec()
        check_count(path, (spec.width, spec.height), "pixels", PIXELS)
        if spec.nchannels > 4:
            raise Refusal(f"{path} has {spec.nchannels} components; give a picture of one to four.")
        values = file.read_image(0, 0, 0, spec.nchannels, oiio.UNKNOWN)
        if values is None:
            raise _unread(path, kind, file.geterror())
    finally:
        file.close()
    values = np.asarray(values).reshape(spec.height, spec.width, -1)
    return values[..., 0] if spec.nchannels == 1 else values


def _unread(path, kind, error):
    return Refusal(
        f"{path} begins as a {kind} file and cannot be read to its end: {one_line(error, path)}. "
        f"{_SAVE_AGAIN}."
    )


def one_line(error, path):
    """A library's words as the middle of a sentence, without the file's name and the names of its codes."""
    text = re.sub(r"\b[A-Z]+_ERR_\w+|\b\w+ Error \(\)|\(\)|\"\"", "", str(error or "").replace(str(path), ""))
    lines = [line.strip(" .:,") for line in text.splitlines() if line.strip(" .:,")]
    return re.sub(r"\bError\b", "error", lines[0]) if lines else "it is cut off or damaged"


# ---------------------------------------------------------------------------------------------- TIFF

_WIDTH, _HEIGHT, _BITS, _COMPRESSION, _COMPONENTS, _TILE = 256, 257, 258, 259, 277, (322, 323)
_SAMPLE_FORMAT = 339
# The number that stands for what was not measured.
_NODATA = 42113
_UNSIGNED, _SIGNED, _FLOAT = 1, 2, 3
# (bits, format) that Pillow reads right where there is one component.
_OF_PILLOW = ((16, _UNSIGNED), (16, _SIGNED), (32, _SIGNED), (32, _FLOAT))
# What tifffile unpacks is bounded: none, PackBits, and what _check_deflate has looked at.
_NONE, _PACKED, _DEFLATED = 1, 32773, (8, 32946)


def _tiff(path):
    damaged = (
        "begins as a TIFF file and cannot be read to its end: it is cut off, damaged, or of a kind that is "
        "not read here"
    )
    with whole(path, damaged, f"{_SAVE_AGAIN}."):
        tags = _tags(path)
        size = tags[_WIDTH], tags[_HEIGHT]
        check_count(path, size, "pixels", PIXELS)
        check_count(f"A tile of {path}", [tags.get(tag, 1) for tag in _TILE], "pixels", PIXELS)
        values, notes = _tiff_values(path, tags)
        if values.dtype.kind in "biuf":
            values, more = measured(path, values, _number(tags.get(_NODATA)))
            notes = (*notes, *more)
        return values, notes


def _tags(path):
    """The tags of a TIFF file's first picture, by number; of several equal numbers the first."""
    from PIL.TiffImagePlugin import ImageFileDirectory_v2

    with path.open("rb") as file, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        begin = file.read(16)
        big, small_first = b"+" in begin[2:4], begin.startswith(b"II")
        # Pillow 13 sees that a file is a BigTIFF where the smaller byte is first alone; so it is told.
        tags = ImageFileDirectory_v2(b"II*\0\0\0\0\0" if small_first else b"MM\0*\0\0\0\0")
        tags._bigtiff = big
        file.seek(int.from_bytes(begin[8:] if big else begin[4:8], "little" if small_first else "big"))
        tags.load(file)
        values = {tag: tags[tag] for tag in tags}
    return {tag: value[0] if type(value) is tuple and value else value for tag, value in values.items()}


def _tiff_values(path, tags):
    """(values, notes) by the first library that is right about the file's kind and reads it."""
    bits, form = tags.get(_BITS, 1), tags.get(_SAMPLE_FORMAT, _UNSIGNED)
    few = bits <= 8 and form == _UNSIGNED
    # Pillow turns TIFF files itself, and takes columns for rows where there are not as many.
    upright = tags.get(ORIENTATION, 1) not in _TURNS
    right = upright and (few or (tags.get(_COMPONENTS, 1) == 1 and (bits, form) in _OF_PILLOW))

    def by_pillow():
        return _by_pillow(path, "TIFF")

    def by_openimageio():
        return _turned_with_note(through_openimageio(path, "TIFF"), tags.get(ORIENTATION, 1))

    def by_tifffile():
        return _turned_with_note(_by_tifffile(path, tags), tags.get(ORIENTATION, 1))

    if bits == 64:
        # OpenImageIO reads no whole numbers of 64 bits, and of tiles of doubles what was in memory before.
        readers = [by_tifffile, *([by_openimageio] if form == _FLOAT and _TILE[0] not in tags else [])]
    else:
        readers = [*([by_pillow] if right else []), by_openimageio][:: 1 if few else -1]
    refused = None
    for reader in readers:
        try:
            return reader()
        except MemoryError:
            raise
        except Exception as error:  # a decoder fed arbitrary bytes raises whatever it stumbles over
            refused = refused or error
    raise refused


def _by_tifffile(path, tags):
    """Of numbers of 64 bits."""
    try:
        import tifffile
    except ImportError:
        raise Refusal(
            f"{path} is a TIFF file of a kind that needs the extra `elevations`: pip install "
            "'fixedpipe[elevations]'."
        ) from None
    logging.getLogger("tifffile").setLevel(logging.CRITICAL)
    with warnings.catch_warnings(), tifffile.TiffFile(path) as file:
        warnings.simplefilter("ignore")
        page = file.pages[0]
        compression = int(page.compression)
        if compression not in (_NONE, _PACKED, *_DEFLATED):
            raise Refusal(f"{path} has the compression {page.compression.name}. {_SAVE_AGAIN} without it.")
        if page.samplesperpixel > 4 or page.size > 4 * tags[_WIDTH] * tags[_HEIGHT]:
            raise Refusal(f"{path} has {page.samplesperpixel} components; give a picture of one to four.")
        # What has none would be zeros.
        if len(page.dataoffsets) != math.prod(page.chunked) or not all(page.databytecounts):
            raise Refusal(f"{path} has not all of the strips or tiles that it names. {_SAVE_AGAIN}.")
        if compression in _DEFLATED:
            _check_deflate(path, page)
        return np.asarray(page.asarray())


def _check_deflate(path, page):
    """Raises Refusal where a strip or tile unpacks to more than it may have: tifffile would hold it all."""
    most = math.prod(page.chunks) * page.dtype.itemsize
    with path.open("rb") as file:
        for offset, count in zip(page.dataoffsets, page.databytecounts, strict=True):
            file.seek(offset)
            if len(zlib.decompressobj().decompress(file.read(count), most + 1)) > most:
                raise Refusal(f"{path} has more values than it names. {_SAVE_AGAIN}.")


def _number(text):
    try:
        return float(str(text).strip("\0 "))
    except ValueError:  # no such tag, or no number in it
        return None


# How far apart a number and its text may be, of values that are stored as float32: as many of its steps as
# six digits leave.  Source: GDAL writes the least float32 as -3.40282e+38 where six digits are asked for.
_ROUNDED = 2.0**-19


def measured(path, values, nothing):
    """(values, notes) of ``without_missing``, where the number ``nothing`` marks a missing measurement; None:
    no number does.
    """
    if nothing is None:
        return values, ()
    if np.isnan(nothing):
        missing = np.isnan(values)
    elif values.dtype.kind == "f":
        most = float(np.finfo(values.dtype).max)
        near = abs(nothing) * (_ROUNDED if values.dtype.itemsize <= 4 else 0.0)
        low, high = (min(max(end, -most), most) for end in (nothing - near, nothing + near))
        missing = (values >= low) & (values <= high)
    elif nothing == int(nothing):
        missing = values == int(nothing)
    else:
        return values, ()
    return without_missing(path, values, missing, f"{nothing:g}")


# --------------------------------------------------------------------------------------- grids of heights


def _asc(path):
    """An Esri ASCII grid: lines of a name and a number each, then the values, the first row in the north."""
    cure = "Give a whole ASCII grid: ncols, nrows, then as many numbers."
    with whole(path, "has no header of an ASCII grid, or values that are no numbers", cure):
        said = {}
        with path.open("rb") as file:
            while (begins := file.tell()) < 4096:
                words = file.readline(256).split()
                if len(words) != 2 or not words[0][:1].isalpha():
                    break
                said[words[0].decode("ascii").lower()] = float(words[1])
            size = int(said["ncols"]), int(said["nrows"])
            if min(size) < 1:
                raise ValueError("no size")
            check_count(path, size, "heights", PIXELS)
            file.seek(begins)
            values = text_values(file, np.float64, size[0] * size[1], path)
    values = values.reshape(size[1], size[0])
    # Source: Esri's format, where the default is -9999.
    return measured(path, values, said.get("nodata_value", -9999.0))


def text_values(file, dtype, count, name):
    """So many numbers of a text, from the file's present place on. Raises Refusal if there are fewer or more,
    and the exceptions of NumPy's reader.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # of words that are no numbers
        values = np.fromfile(file, dtype, count + 1, sep=" ")
    if len(values) != count:
        few = "more than" if len(values) > count else f"{len(values)} of"
        raise Refusal(f"{name} has {few} the {count} values that it names. Write it again.")
    return values


def _hgt(path):
    """(values, notes) of the SRTM's heights: whole metres, two bytes each, the larger first, north first."""
    size = path.stat().st_size
    edges = {2 * rows * columns: (rows, columns) for rows, columns in _HGT}
    if size not in edges:
        known = ", ".join(f"{rows} x {columns}" for rows, columns in _HGT)
        raise Refusal(f"{path} has {size} bytes, and .hgt files have {known} heights of two bytes. {ALLOWED}")
    values = np.fromfile(path, ">i2").reshape(edges[size])
    return measured(path, values.astype(np.int16), -32768.0)


# Rows and columns: three, one and half an arc second, and those with fewer columns from 50 degrees on.
_HGT = ((1201, 1201), (3601, 3601), (3601, 1801), (7201, 7201))


def _pgm(path):
    """Grey of 8 or 16 bits, the larger byte first, or of numbers in a text (P2)."""
    cure = "Give a PGM file: P5 or P2, columns, rows, the largest value, then as many values."
    with whole(path, "has a damaged PGM header, or values that are none", cure), path.open("rb") as file:
        kind = file.read(2)
        columns, rows, most = (_word(file) for _ in range(3))
        if min(columns, rows) < 1 or not 1 <= most <= 65535:
            raise ValueError("no size")
        count = columns * rows
        check_count(path, (columns, rows), "pixels", PIXELS)
        dtype = np.dtype(np.uint8 if most < 256 else np.uint16)
        if kind == b"P2":
            values = text_values(file, np.float64, count, path)
        else:
            values = np.fromfile(file, dtype.newbyteorder(">"), count)
        if len(values) < count:
            raise Refusal(f"{path} has {len(values)} of the {count} values that it names. {cure}")
        if values.min() < 0 or values.max() > most:
            raise Refusal(f"{path} has values above {most}, the largest that it names. {cure}")
        values = values.astype(dtype)
    return values.reshape(rows, columns), ()


def _word(file):
    """A number of a PGM header, after blanks and comments, and the one blank behind it."""
    word = b""
    while True:
        byte = file.read(1)
        if byte == b"#":
            file.readline(4096)
        elif byte.isdigit() and len(word) < 9:
            word += byte
        elif not byte.isspace() or not byte:
            raise ValueError("no number")
        elif word:
            return int(word)


# ----------------------------------------------------------------------------------------------- NPY


def _array(path):
    """The values of an NPY file."""
    again = "Write it with numpy.save, as an array of numbers."
    with path.open("rb") as file, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        begin = file.read(len(np.lib.format.MAGIC_PREFIX))
        if begin != np.lib.format.MAGIC_PREFIX:
            raise Refusal(f"{path} {'is no NPY file' if begin else 'is empty'}. {again}")
        file.seek(0)
        with whole(path, "has a damaged NPY header", again):
            found = arrays.header(file)
        if found.dtype.hasobject:
            raise Refusal(f"{path} holds Python's objects. {again}")
        if found.dtype.kind not in "biuf":
            raise Refusal(f"{path} holds values of type {found.dtype}; give an array of numbers.")
        check_count(path, found.shape[:2], "pixels", PIXELS)
        if len(found.shape) not in (2, 3) or (len(found.shape) == 3 and found.shape[2] > 4):
            check_count(path, found.shape, "values", PIXELS)  # refused by whoever takes it, with its shape
        there = path.stat().st_size - file.tell()
        if there < found.bytes:
            raise arrays.cut_off(path, found, there)
        with whole(path, "holds no array that can be read", again):
            return arrays.values(file, found, path)


# How files begin, and who reads them.
_READERS = (
    (rb"\x89PNG\r\n\x1a\n", _png),
    (rb"\xff\xd8\xff", _jpeg),
    (rb"II[*+]\0|MM\0[*+]", _tiff),
    (rb"P[25]\s", _pgm),
    (rb"\s*(ncols|nrows)\s", _asc),
)
