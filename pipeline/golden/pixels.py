"""The pixels that are compared of a picture from any source, unconverted, without a file's metadata.

Nothing is converted. Some pictures have no bytes before a choice: real numbers, a palette, a rotation that
only a file's metadata states, 16 bits that a reader cuts. They are refused with a sentence on how to choose.
"""

import os
import struct
import zlib
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
# Pillow's modes whose arrays hold the pixels' own values: components of 8 bits, and grey of 16.
_MODES = {"L": np.uint8, "LA": np.uint8, "RGB": np.uint8, "RGBA": np.uint8, "I;16": np.uint16}
_ORIENTATION = 0x0112  # of EXIF.  Source: EXIF 2.3, table 4
# Components of PNG's color types.  Source: PNG specification, second edition, table 11.1
_COMPONENTS = {0: 1, 2: 3, 4: 2, 6: 4}
# Filters of a row.  Source: PNG specification, second edition, section 9.2
_NONE, _SUB, _UP, _AVERAGE, _PAETH = range(5)
_MOST_BYTES = 1 << 31  # for a picture's pixels. Assumed: enough for any test


def pixels_of(picture: Any) -> NDArray[np.uint8 | np.uint16]:
    """A picture's pixels, uint8 or uint16 [h, w, 1 to 4], top row first.

    The components are grey, grey and alpha, colour, or colour and alpha. ``picture`` is one of:

    - what fixedpipe draws (a Result, a figure's Rendering).
    - an array [h, w] or [h, w, 1 to 4] of uint8 or uint16.
    - a Pillow image.
    - the path of a PNG file.

    Raises ValueError with a sentence for anything else: real numbers, other types, no pixels, palettes,
    pictures whose metadata asks for a rotation.
    """
    if hasattr(picture, "deep_image"):
        picture = picture.deep_image()
    elif isinstance(picture, str | os.PathLike):
        return _of_file(Path(picture))
    elif hasattr(picture, "getbands") and hasattr(picture, "mode"):
        picture = _of_pillow(picture)
    elif not hasattr(picture, "__array__"):
        raise ValueError(
            f"A picture cannot be a {type(picture).__name__}; give an array [h, w] or [h, w, 1 to 4] of "
            "uint8 or uint16, a Pillow image, the path of a PNG file, or what fixedpipe drew."
        )
    return _of_array(np.asarray(picture))


def _of_array(array):
    if array.dtype.kind == "f":
        nans = int(np.isnan(array).sum())
        what = f"{array.dtype}{f', {nans} of them NaN' if nans else ''}"
        raise ValueError(
            f"The picture holds real numbers ({what}), whose last bits differ from machine to machine. Round "
            "them yourself: np.rint(255 * np.clip(picture, 0, 1)).astype(np.uint8)."
        )
    if array.dtype.newbyteorder("=") not in (np.uint8, np.uint16):
        raise ValueError(
            f"The picture holds {array.dtype}; golden pictures hold uint8 or uint16. Convert it with astype, "
            "once its values fit."
        )
    if array.ndim not in (2, 3) or (array.ndim == 3 and not 1 <= array.shape[2] <= 4):
        raise ValueError(
            f"The picture has the shape {array.shape}; give [h, w], or [h, w, components] with 1 to 4 of "
            f"them."
        )
    if 0 in array.shape:
        raise ValueError(f"The picture has the shape {array.shape}: no pixel. Give one that has some.")
    native = array.astype(array.dtype.newbyteorder("="), copy=False)
    return np.ascontiguousarray(native.reshape(*array.shape[:2], -1))


def _of_pillow(image):
    # This comes first, because the next queries read the file and drop how it is packed.
    tiles = getattr(image, "tile", None) or ()
    if any(";16" in str(tile[-1]) for tile in tiles) and image.mode != "I;16":
        raise ValueError(
            "The file has 16 bits a component, and Pillow cuts them to 8; give the file's path, which is "
            "read "
            "with all of them."
        )
    if image.getexif().get(_ORIENTATION, 1) != 1:
        raise ValueError(
            "The picture's EXIF data tell viewers to turn or mirror it, and its array is not turned; give "
            "PIL.ImageOps.exif_transpose(image)."
        )
    if image.mode == "P":
        raise ValueError(
            "The picture has a palette (mode P): what it stores are indices, no colours; give "
            'image.convert("RGB"), or "RGBA" where its palette has alpha.'
        )
    if image.mode not in _MODES:
        raise ValueError(
            f"The picture has Pillow's mode {image.mode}; golden pictures are L, LA, RGB, RGBA or I;16. "
            "Convert it to the one that you mean."
        )
    if 0 in image.size:
        raise ValueError(f"The picture has {image.width}x{image.height} pixels; give one that has some.")
    return np.asarray(image)


def _of_file(path):
    try:
        data = path.read_bytes()
    except OSError as error:
        raise ValueError(f"The picture {path} cannot be read: {error.strerror}.") from error
    if not data.startswith(_SIGNATURE):
        raise ValueError(f"{path} is no PNG file; open it yourself, and give its pixels as an array.")
    return pixels_of_png(data, str(path))


def pixels_of_png(data: bytes, name: str = "the PNG file") -> NDArray[np.uint8 | np.uint16]:
    """The pixels of a PNG file with all their bits, in the form of ``pixels_of``.

    ``name`` names the file in messages. Raises ValueError for a file that is broken, or whose pixels
    ``pixels_of`` would refuse.
    """
    from PIL import Image, UnidentifiedImageError

    if not data.startswith(_SIGNATURE):
        raise ValueError(f"{name} is no whole PNG file: it begins otherwise. Write it anew.")
    try:
        depth, color_type, interlaced = data[24], data[25], data[28]
        if depth == 16 and color_type in _COMPONENTS:
            if interlaced:
                raise ValueError(f"{name} has 16 bits and is interlaced; write it without interlacing.")
            return _of_array(_sixteen_bits(data, _COMPONENTS[color_type]))
        with Image.open(BytesIO(data)) as image:
            return _of_array(_of_pillow(image))
    except UnidentifiedImageError as error:  # Pillow's message names a Python object.
        raise ValueError(f"{name} is no whole PNG file: its header is damaged. Write it anew.") from error
    except (
        OSError,
        SyntaxError,
        IndexError,
        struct.error,
        zlib.error,
        Image.DecompressionBombError,
    ) as error:
        raise ValueError(f"{name} is no whole PNG file: {error}. Write it anew.") from error


def _sixteen_bits(data, components):
    """The pixels of a PNG file of 16 bits that is not interlaced; Pillow cuts its colours to 8 bits.

    Source: PNG specification, second edition, sections 5.3, 9.2 (filters), 9.4 (Paeth).
    """
    width, height = struct.unpack(">II", data[16:24])
    row, bytes_of = 2 * components * width, 2 * components
    if not 0 < (row + 1) * height <= _MOST_BYTES:
        raise ValueError(f"The PNG file says that it has {width}x{height} pixels; at most 2 GiB are read.")
    compressed, at = b"", len(_SIGNATURE)
    while at + 12 <= len(data):
        (length,), kind = struct.unpack(">I", data[at : at + 4]), data[at + 4 : at + 8]
        chunk = data[at + 8 : at + 8 + length]
        if data[at + 8 + length : at + 12 + length] != struct.pack(">I", zlib.crc32(kind + chunk)):
            raise OSError(f"its chunk {kind.decode('latin-1')} is damaged")
        compressed += chunk if kind == b"IDAT" else b""
        at += 12 + length
    filtered = zlib.decompressobj().decompress(compressed, (row + 1) * height)
    if len(filtered) != (row + 1) * height:
        raise OSError("rows are missing")
    lines = np.frombuffer(filtered, np.uint8).reshape(height, row + 1)
    out, above = np.empty((height, row), np.uint8), np.zeros(row, np.uint8)
    for y, line in enumerate(lines):
        above = out[y] = _unfiltered(int(line[0]), line[1:], above, bytes_of)
    return out.view(">u2").reshape(height, width, components)


def _unfiltered(filtered_by, line, above, bytes_of):
    if filtered_by == _NONE:
        return line
    if filtered_by == _UP:
        return line + above  # modulo 256
    if filtered_by == _SUB:
        return np.cumsum(line.reshape(-1, bytes_of), axis=0, dtype=np.uint8).reshape(-1)
    if filtered_by not in (_AVERAGE, _PAETH):
        raise OSError(f"a row has the filter {filtered_by}")
    out, up = [0] * bytes_of + line.tolist(), [0] * bytes_of + above.tolist()
    for k in range(bytes_of, len(out)):
        left, over, corner = out[k - bytes_of], up[k], up[k - bytes_of]
        if filtered_by == _AVERAGE:
            out[k] = out[k] + (left + over) // 2 & 255
        else:
            near = min((left, over, corner), key=lambda value: abs(left + over - corner - value))
            out[k] = out[k] + near & 255
    return np.array(out[bytes_of:], np.uint8)
