"""The meaning of pixels' numbers, in every function that takes pixels.

For uint8 bytes 255 is one, and for floats 1.0 is one. No other type says which value is one: int64 may hold
bytes, uint16 may have 16 bits or 12, and a boolean may be one or the byte 1. So other types are refused.
OpenGL's own images are the exception (``PixelImage``): their unsigned integers are fractions of their type's
largest value (OpenGL 1.2.1 table 2.6).
"""

from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray


class PillowImage(Protocol):
    """An image of the library Pillow."""

    @property
    def mode(self) -> str:
        """The kind of its pixels, for instance "RGB"."""

    def getbands(self) -> tuple[str, ...]:
        """The names of its components."""

    def convert(self, mode: str) -> Any:
        """The same picture with pixels of another mode."""


# Pillow's modes whose pixels are components in bytes, or indices or bits for these, and the mode to convert
# to.
_MODES = {"L": "L", "LA": "LA", "RGB": "RGB", "RGBA": "RGBA", "1": "L", "P": "RGBA", "PA": "RGBA"}

_ADVICE = {
    "b": ": .astype(float) if true is one",
    "i": ": .astype(np.uint8) if they are bytes, / 65535.0 if they are 16-bit",
    "u": ": .astype(np.uint8) if they are bytes, / 65535.0 if they are 16-bit",
}


def bottom_row_first(image: ArrayLike | PillowImage, what: str) -> Any:
    """A Pillow image, whose top row is first, as uint8 [height, width, 1..4] with its bottom row first.

    Other values are returned unchanged. Raises ValueError, about ``what``, for a mode whose components are no
    bytes.
    """
    if not hasattr(image, "getbands"):
        return image
    if image.mode not in _MODES:
        raise ValueError(
            f"{what} is a Pillow image of mode {image.mode}; give .convert('RGB'), or its numbers as floats "
            "(1.0 is one), bottom row first."
        )
    pixels = np.asarray(image.convert(_MODES[image.mode]))[::-1]
    return pixels[..., None] if pixels.ndim == 2 else pixels


def array_of(values: ArrayLike, what: str) -> NDArray[Any]:
    """The values as an array. Raises ValueError, about ``what``, for rows of different lengths."""
    try:
        return np.asarray(values)
    except ValueError as error:
        raise ValueError(f"{what} has rows of different lengths; give as many in each.") from error


def refused_type(values: NDArray[Any], what: str, allowed: str) -> ValueError:
    """The ValueError for an array whose type is not among the ``allowed``, with advice."""
    return ValueError(f"{what} holds {values.dtype}; give {allowed}{_ADVICE.get(values.dtype.kind, '')}.")


def bytes_or_floats(values: ArrayLike, what: str) -> NDArray[np.uint8] | NDArray[np.float64]:
    """Pixels as uint8 (255 is one) or float64 (1.0 is one).

    Raises ValueError, about ``what``, for other types, NaN and infinity.
    """
    array = array_of(values, what)
    if array.dtype == np.uint8:
        return array
    if array.dtype.kind != "f":
        raise refused_type(array, what, "bytes (uint8, 255 is one) or floats (1.0 is one)")
    array = array.astype(np.float64, copy=False)
    if not np.isfinite(array).all():
        raise ValueError(f"{what} holds NaN or infinity; give finite numbers, 1.0 is one, or bytes.")
    return array


def unit_numbers(values: ArrayLike, what: str) -> NDArray[np.float64]:
    """Factors or components of vectors as float64, where 1.0 is one.

    They may be floats of any size, booleans, and the whole numbers -1, 0 and 1. Raises ValueError, about
    ``what``, for other whole numbers, which are bytes or words of a picture, for other types, NaN and
    infinity.
    """
    array = array_of(values, what)
    if array.dtype.kind not in "biuf":
        raise refused_type(array, what, "floats (1.0 is one)")
    if array.dtype.kind in "iu" and array.size and (array.min() < -1 or array.max() > 1):
        raise ValueError(
            f"{what} holds {array.dtype} from {array.min()} to {array.max()}; give floats (1.0 is one): / "
            "255.0 if they are bytes, / 65535.0 if they are 16-bit."
        )
    array = array.astype(np.float64, copy=False)
    if not np.isfinite(array).all():
        raise ValueError(f"{what} holds NaN or infinity; give finite numbers, 1.0 is one.")
    return array


def whole_numbers(values: ArrayLike, what: str) -> NDArray[np.int64]:
    """Words of memory, or indices, as int64.

    Raises ValueError, about ``what``, for arrays of other types than integers.
    """
    array = array_of(values, what)
    if array.dtype.kind not in "iu":
        raise ValueError(f"{what} holds {array.dtype}; give whole numbers, as uint8, uint16 or uint32.")
    return array.astype(np.int64)
