"""Images in client memory (OpenGL 1.2.1 sections 3.6.1 and 3.6.4): pixel store, formats, types.

``captured`` makes the capture of a call. It reads the image when the call is made, with the pixel store of
that time, and passes a ``ClientImage`` to the handler. If the image cannot be read, it passes the error, and
the handler raises it when the call is carried out. In a display list, this is when the list is called.

Client memory is bytes, a bytes-like object, a NumPy array, or a list of numbers. If a pixel buffer object is
bound, it is an offset. Words are little-endian. Assumed: programs ran on x86.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.buffers import memory_at
from fixedpipe.pipeline.opengl.entry_points import entry
from fixedpipe.pipeline.opengl.outcomes import GLError, Refused
from fixedpipe.pipeline.opengl.values import declare
from fixedpipe.pipeline.pixel_transfer import PixelImage
from fixedpipe.pipeline.textures.pixel_formats import PACKED_TYPES, packed_formats


class Store(NamedTuple):
    """The layout of images in client memory (table 3.1). PushClientAttrib saves both Stores."""

    alignment: int = 4
    row_length: int = 0
    image_height: int = 0
    skip_images: int = 0
    skip_rows: int = 0
    skip_pixels: int = 0
    swap_bytes: bool = False
    lsb_first: bool = False


declare("unpack", Store())
declare("pack", Store())

# Parameters of PixelStore: "pack" or "unpack", and the field.
STORE_PARAMETERS = {
    getattr(tokens, f"{side.upper()}_{field.upper()}"): (side, field)
    for side in ("unpack", "pack")
    for field in Store._fields
}


@entry("PixelStorei", "PixelStoref", compiled=False)
def pixel_store(gl, name, value):
    """Set a parameter of the layout of images in client memory."""
    if name not in STORE_PARAMETERS:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(name)} is no parameter of pixel store")
    side, field = STORE_PARAMETERS[name]
    # Section 3.6.1: a call for floats sets the nearest integer.
    value = bool(value) if field in ("swap_bytes", "lsb_first") else math.floor(value + 0.5)
    if value < 0 or (field == "alignment" and value not in (1, 2, 4, 8)):
        raise GLError(tokens.INVALID_VALUE, f"{tokens.name_of(name)} cannot be {value}")
    gl.values.set(side, gl.values[side]._replace(**{field: value}))


# ------------------------------------------------------------------------------------------ formats and types

# Formats of groups: the PixelImage's format, and the elements of a group (table 3.6; EXT_abgr).
FORMATS = {
    tokens.RGBA: ("RGBA", 4),
    tokens.RGB: ("RGB", 3),
    tokens.BGRA: ("BGRA", 4),
    tokens.BGR: ("BGR", 3),
    tokens.ABGR_EXT: ("RGBA", 4),
    tokens.RED: ("RED", 1),
    tokens.GREEN: ("GREEN", 1),
    tokens.BLUE: ("BLUE", 1),
    tokens.ALPHA: ("ALPHA", 1),
    tokens.LUMINANCE: ("LUMINANCE", 1),
    tokens.LUMINANCE_ALPHA: ("LUMINANCE_ALPHA", 2),
    tokens.DEPTH_COMPONENT: ("DEPTH_COMPONENT", 1),
    tokens.DEPTH_STENCIL_EXT: ("DEPTH_COMPONENT", 1),
    tokens.STENCIL_INDEX: ("STENCIL_INDEX", 1),
    tokens.COLOR_INDEX: ("COLOR_INDEX", 1),
}
# Groups of NV_texture_shader, which a PixelImage cannot hold: their number of elements.
BUMP_FORMATS = {
    tokens.HILO_NV: 2,
    tokens.DSDT_NV: 2,
    tokens.DSDT_MAG_NV: 3,
    tokens.DSDT_MAG_VIB_NV: 4,
}
INDEX_FORMATS = frozenset({tokens.COLOR_INDEX, tokens.STENCIL_INDEX})
# Types of elements (table 3.5; ARB_half_float_pixel).
TYPES = {
    tokens.UNSIGNED_BYTE: "<u1",
    tokens.BYTE: "<i1",
    tokens.UNSIGNED_SHORT: "<u2",
    tokens.SHORT: "<i2",
    tokens.UNSIGNED_INT: "<u4",
    tokens.INT: "<i4",
    tokens.FLOAT: "<f4",
    tokens.HALF_FLOAT_ARB: "<f2",
}
# Types that hold a whole group (table 3.8).
PACKED = {getattr(tokens, name): name for name in PACKED_TYPES}
_WORDS = {token: np.dtype(PACKED_TYPES[name].word).newbyteorder("<") for token, name in PACKED.items()}
_WORDS[tokens.UNSIGNED_INT_24_8_EXT] = np.dtype("<u4")
_IN_BYTES = (tokens.UNSIGNED_INT_8_8_8_8, tokens.UNSIGNED_INT_8_8_8_8_REV)
_LARGEST = 2.0**32  # Source: OpenGL 1.2.1 section 2.1.1: the range of floating-point numbers, at least


class ClientImage(NamedTuple):
    """An image as it was in client memory, bottom row first. It is read-only.

    - ``values``: [layers, height, width, elements]. For packed types they are words, with one element.
    - ``format``: the token of its format.
    - ``packed``: the name of its type if each word holds a whole group.
    """

    values: NDArray[Any]
    format: int
    packed: Any = None

    def image_format(self) -> str:
        """The format for a PixelImage."""
        return FORMATS[self.format][0]

    def pixel_image(self, layers: bool = False) -> PixelImage:
        """The image as a PixelImage. ``layers``: whether it has the axis for layers. Indices are integers."""
        values = self.values
        if self.format == tokens.ABGR_EXT:
            values = values[..., ::-1]
        elif self.format in INDEX_FORMATS and values.dtype.kind == "f":
            values = np.clip(finite(values), -_LARGEST / 2, _LARGEST / 2 - 1).astype(np.int32)
        elif values.dtype.kind == "f":
            values = finite(values)
        if values.shape[-1] == 1:
            values = values[..., 0]
        return PixelImage(values if layers else values[0], self.image_format(), self.packed)


def finite(values: NDArray[Any]) -> NDArray[Any]:
    """Floats with NaN and infinities, which are undefined in OpenGL, replaced by numbers within +-2**32."""
    if np.isfinite(values).all() and (values.dtype.itemsize <= 2 or (np.abs(values) <= _LARGEST).all()):
        return values
    return np.clip(np.nan_to_num(values), -_LARGEST, _LARGEST)


def check_format(image_format: int, image_type: int) -> None:
    """Raise GLError for an unknown format or type, or if the two do not fit together."""
    if image_format not in FORMATS and image_format not in BUMP_FORMATS:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(image_format)} is no format of images")
    indices = image_format in INDEX_FORMATS
    if image_type == tokens.BITMAP:
        if not indices:
            raise GLError(tokens.INVALID_ENUM, "GL_BITMAP holds indices alone")
        return
    if image_type == tokens.UNSIGNED_INT_24_8_EXT:
        if image_format != tokens.DEPTH_STENCIL_EXT:
            raise GLError(
                tokens.INVALID_OPERATION, "GL_UNSIGNED_INT_24_8 holds depth and stencil values alone"
            )
        return
    if image_type in PACKED:
        if _packed_name(image_format, image_type) is None and image_type not in _IN_BYTES:
            raise GLError(
                tokens.INVALID_OPERATION,
                f"{tokens.name_of(image_type)} does not hold groups of {tokens.name_of(image_format)}",
            )
        if image_format in BUMP_FORMATS or FORMATS[image_format][1] < 3:
            raise GLError(tokens.INVALID_OPERATION)
        return
    if image_type not in TYPES:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(image_type)} is no type of images")


def _packed_name(image_format, image_type):
    """A packed type's name; None if the type cannot hold groups of the format."""
    name = PACKED[image_type]
    if image_format not in FORMATS or image_format == tokens.ABGR_EXT:
        return None
    return name if FORMATS[image_format][0] in packed_formats(name) else None


# -------------------------------------------------------------------------------------------------- memory


def memory(gl: Any, given: Any, dtype: str) -> NDArray[np.uint8] | None:
    """The bytes from a pointer on; None for a null pointer. Raises Refused if they are not known, and GLError
    if they are outside a buffer object.

    ``dtype``: the type of the numbers in a list. Later writes by the program do not change the bytes.
    """
    found = memory_at(gl, tokens.PIXEL_UNPACK_BUFFER_ARB, given, dtype)
    if found is None:
        if gl.buffers[tokens.PIXEL_UNPACK_BUFFER_ARB] is not None:
            raise GLError(tokens.INVALID_OPERATION, "the image lies outside its buffer object")
        if given is None or given == 0:
            return None
        raise Refused("its image is not known, only where it lay")
    return found if isinstance(given, bytes) else found.copy()


def read_image(gl, size, image_format, image_type, given, *, whole_images=False) -> ClientImage | None:
    """The ClientImage of ``size`` (width, height, depth) at a pointer; None for a null pointer.

    ``whole_images``: whether IMAGE_HEIGHT and SKIP_IMAGES apply, as for 3D textures.
    Raises GLError for wrong formats and types, and Refused if the memory is smaller than the image.
    """
    check_format(image_format, image_type)
    if image_type == tokens.BITMAP:
        return _bitmap(gl, size, image_format, given)
    packed = image_type not in TYPES
    dtype = np.dtype(_WORDS[image_type] if packed else TYPES[image_type])
    data = memory(gl, given, dtype.str)
    if data is None:
        return None
    elements = 1 if packed else BUMP_FORMATS.get(image_format) or FORMATS[image_format][1]
    values = _elements(gl.values["unpack"], size, elements, dtype, data, whole_images)
    if image_type == tokens.UNSIGNED_INT_24_8_EXT:
        return ClientImage(_read_only((values >> 8) / 16777215.0), tokens.DEPTH_COMPONENT)
    if image_type in _IN_BYTES:
        values = np.ascontiguousarray(values).view(np.uint8)  # the lowest byte first
        return ClientImage(
            _read_only(values if "REV" in PACKED[image_type] else values[..., ::-1]), image_format
        )
    return ClientImage(_read_only(values), image_format, PACKED[image_type] if packed else None)


def _read_only(values):
    values.setflags(write=False)
    return values


def row_bytes(store: Store, width: int, group: int, element: int) -> int:
    """Bytes from a row to the next (section 3.6.4). ``group``, ``element``: bytes of a group, an element."""
    length = (store.row_length or width) * group
    return length if element >= store.alignment else -(-length // store.alignment) * store.alignment


def _elements(store, size, elements, dtype, data, whole_images):
    """Elements [depth, height, width, elements] of ``data``, whose layout a Store describes."""
    width, height, depth = size
    group = elements * dtype.itemsize
    row = row_bytes(store, width, group, dtype.itemsize)
    image = row * ((whole_images and store.image_height) or height)
    start = store.skip_pixels * group + store.skip_rows * row + whole_images * store.skip_images * image
    end = start + (depth - 1) * image + (height - 1) * row + width * group
    if end > len(data):
        raise Refused(f"{len(data)} bytes of memory are known, and its image takes {end}")
    strides = image, row, group, dtype.itemsize
    values = np.ndarray((depth, height, width, elements), dtype, data, start, strides)
    return values.byteswap() if store.swap_bytes else values


def read_bits(gl: Any, width: int, height: int, given: Any) -> NDArray[np.bool_] | None:
    """A bitmap [height, width] at a pointer (section 3.6.4, figure 3.9); None for a null pointer."""
    store: Store = gl.values["unpack"]
    data = memory(gl, given, "<u1")
    if data is None:
        return None
    row = -(-(store.row_length or width) // (8 * store.alignment)) * store.alignment
    used = -(-(store.skip_pixels + width) // 8)
    start = store.skip_rows * row
    end = start + (height - 1) * row + used
    if end > len(data):
        raise Refused(f"{len(data)} bytes of memory are known, and its bitmap takes {end}")
    rows = np.ndarray((height, used), np.uint8, data, start, (row, 1))
    bits = np.unpackbits(rows, axis=1, bitorder="little" if store.lsb_first else "big")
    return bits[:, store.skip_pixels : store.skip_pixels + width].astype(np.bool_)


def _bitmap(gl, size, image_format, given):
    width, height, depth = size
    bits = read_bits(gl, width, height * depth, given)
    if bits is None:
        return None
    return ClientImage(_read_only(bits.astype(np.uint8).reshape(depth, height, width, 1)), image_format)


Capture = Callable[..., tuple[Any, ...]]
# The longest edge of an image that is read. Larger sizes are errors in OpenGL. Assumed: no machine has more.
_MOST_EDGE = 1 << 16


def captured(*sizes: int, layers: bool = False) -> Capture:
    """The capture of a call whose last arguments are format, type and pointer.

    ``sizes``: the places of width, height and depth among its arguments. Instead of the pointer the handler
    gets a ClientImage, None, or the error of reading it. An image with an edge of 0 is None.
    """

    def capture(gl, *arguments):
        *others, image_format, image_type, given = arguments
        size = (*[int(arguments[at]) for at in sizes], 1, 1)[:3]
        image: Any = None
        try:
            if all(0 < edge <= _MOST_EDGE for edge in size):
                image = read_image(gl, size, image_format, image_type, given, whole_images=layers)
            else:
                check_format(image_format, image_type)
        except (GLError, Refused) as error:
            image = error
        return (*others, image_format, image_type, image)

    return capture


def given_image(image: Any) -> ClientImage | None:
    """The image that ``captured`` read, or None. Raises the error of reading it."""
    if isinstance(image, Exception):
        raise image
    return image
