"""A user's height fields, photographs and materials in the form that scenes take.

Pictures may come from files, arrays or Pillow. All have their top row first, and that row is at the top of
the picture. Scenes have the bottom row first, as textures do.
"""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from fixedpipe.effects.geometry import height_fields
from fixedpipe.effects.geometry.height_fields import resample, smooth, tileable
from fixedpipe.effects.geometry.vectors import dot
from fixedpipe.effects.reflectance.material_textures import Material
from fixedpipe.effects.user_pictures.bumped_mesh import MATERIALS, MaterialParameters
from fixedpipe.effects.user_pictures.inputs import read_picture
from fixedpipe.effects.user_pictures.picture_files import ORIENTATION, turned

# What the components of a file of whole numbers are at most.
_FULL = {"uint8": 255.0, "uint16": 65535.0, "bool": 1.0}
# Pillow's images whose components are red, green, blue, grey or heights as they stand.
_MODES = ("1", "L", "LA", "RGB", "RGBA", "I", "I;16", "F")


def _picture(value):
    """(values [rows, columns(, components)], top row first, and what they are called) of a file's name, an
    array or a Pillow image. Raises ValueError.
    """
    if isinstance(value, str | Path):
        return read_picture(str(value)), str(value)
    if hasattr(value, "convert") and hasattr(value, "mode"):
        return _of_pillow(value)
    if np.ma.is_masked(value):
        raise ValueError("The array has masked values; fill them before.")
    try:
        array = np.asarray(value)
    except ValueError:
        raise ValueError("The rows are not all of one length; give [rows, columns].") from None
    called = f"an array of shape {array.shape}, {array.dtype}"
    if array.dtype.kind not in "biuf":
        raise ValueError(f"This is {called}; give numbers.")
    return array, called


def _of_pillow(image):
    tiles = getattr(image, "tile", None) or ()  # asked first: what follows reads the file, and forgets them
    if any(";16" in str(tile[-1]) for tile in tiles) and image.mode != "I;16":
        raise ValueError(
            "The image's file has 16 bits a component, and Pillow cuts them to 8; give the file's name, of "
            "which all are read."
        )
    orientation = image.getexif().get(ORIENTATION, 1) if hasattr(image, "getexif") else 1
    array = np.asarray(image if image.mode in _MODES else image.convert("RGB"))
    return turned(array, orientation), f"an array of shape {array.shape}, {array.dtype}"


def _fitted(values, columns, rows, repeated):
    """Values [rows, columns] at another size; ``repeated``: its edges are faded into each other before."""
    return resample(tileable(values) if repeated else values, columns, rows)


@dataclass(frozen=True, eq=False)
class HeightField:
    """Heights of a user's own, float64 [rows, columns], bottom row first, the lowest 0 and the highest 1.

    ``called``: where they come from, in words.
    """

    heights: np.ndarray = field(repr=False)
    called: str

    def fitted(self, columns, rows, scale, *, repeated):
        """Heights at another size, float64 [rows, columns], in units of the map's edge.

        scale     of the highest point over the lowest
        repeated  whether the map repeats on the surface; its edges are then faded into each other
        """
        return scale * smooth(_fitted(self.heights, columns, rows, repeated), periodic=repeated)

    def slopes(self, size, scale, *, repeated):
        """Slopes (dh/ds, dh/dt) at ``size`` texels along both edges; the rest as for ``fitted``."""
        return height_fields.slopes(self.fitted(size, size, scale, repeated=repeated), periodic=repeated)


def height_field(value):
    """The HeightField of a file's name, of ``sample:`` and a name, of an array or of a Pillow image.

    ``value``: [rows, columns] or [rows, columns, 1 to 4 components], numbers of any type, top row first;
    colours become luminance, and the least and the greatest value 0 and 1 (``height_fields.from_image``).
    Raises ValueError for anything else, and for fewer than two rows or columns.
    """
    if isinstance(value, HeightField):
        return value
    picture, called = _picture(value)
    heights = height_fields.from_image(picture)
    if min(heights.shape) < 2:
        raise ValueError(
            f"The height field has {heights.shape[0]} x {heights.shape[1]} heights; give two rows and two "
            "columns or more."
        )
    return HeightField(heights, called)


@dataclass(frozen=True, eq=False)
class Photograph:
    """Colours of a user's own, [rows, columns, components], bottom row first.

    Grey or RGB come first. Values are the file's, of any type, from zero to ``full``. ``called``: where they
    come from, in words.
    """

    values: np.ndarray = field(repr=False)
    called: str
    full: float = field(repr=False)

    def _channel(self, values, k):
        """Component ``k`` of some of the values as floats from 0 to 1."""
        return values[..., k if self.values.shape[2] >= 3 else 0].astype(np.float64) / self.full

    @property
    def colors(self):
        """All of them as float64 [rows, columns, 3], RGB in [0, 1]."""
        return np.stack([self._channel(self.values, k) for k in range(3)], axis=-1)

    def fitted(self, columns, rows, *, repeated):
        """Colours at another size, float64 [rows, columns, 3]; ``repeated`` as for ``HeightField.fitted``."""
        channels = [_fitted(self._channel(self.values, k), columns, rows, repeated) for k in range(3)]
        return np.stack(channels, axis=-1)

    def brightness(self, columns, rows, *, repeated):
        """Its luminance at another size, float64 [rows, columns] in [0, 1]."""
        return dot(self.fitted(columns, rows, repeated=repeated), height_fields.LUMINANCE)

    def panorama(self, toward):
        """The photograph as an environment of all directions: RGB of directions [..., 3], not zero.

        Its columns are the angles around the y axis, its middle -z and its right half towards +x; its rows
        the angles from -y to +y. Between pixels it is linear.
        """
        toward = np.asarray(toward, np.float64)
        x, y, z = (toward[..., k] for k in range(3))
        rows, columns = self.values.shape[:2]
        column = (np.arctan2(x, -z) / (2.0 * np.pi) + 0.5) * columns - 0.5
        row = (np.arctan2(y, np.sqrt(x * x + z * z)) / np.pi + 0.5) * rows - 0.5
        row = np.clip(row, 0.0, rows - 1.0)
        i, j = np.floor(column).astype(np.int64), np.floor(row).astype(np.int64)
        f, g = (column - i)[..., None], (row - j)[..., None]

        def colors(row, column):
            there = self.values[row, column]
            return np.stack([self._channel(there, k) for k in range(3)], axis=-1)

        low, high = (
            colors(k, i % columns) * (1.0 - f) + colors(k, (i + 1) % columns) * f
            for k in (j, np.minimum(j + 1, rows - 1))
        )
        return low * (1.0 - g) + high * g


def photograph(value):
    """The Photograph of a file's name, of ``sample:`` and a name, of an array or of a Pillow image.

    ``value``: [rows, columns] or [rows, columns, 1 to 4 components], top row first: uint8, uint16, or numbers
    from 0 to 1; grey with fewer than three components; a fourth, or a second, is left out.
    Raises ValueError for anything else.
    """
    if isinstance(value, Photograph):
        return value
    array, called = _picture(value)
    if array.ndim not in (2, 3) or not array.size or (array.ndim == 3 and array.shape[2] > 4):
        raise ValueError(
            f"The photograph has shape {array.shape}; give [rows, columns] or [rows, columns, 1 to 4]."
        )
    if array.dtype.kind != "f" and array.dtype.name not in _FULL:
        raise ValueError(
            f"The photograph holds whole numbers of type {array.dtype}, whose full brightness is not known; "
            "give uint8, uint16, or numbers from 0 to 1."
        )
    full = _FULL.get(array.dtype.name, 1.0)
    low, high = float(array.min()) / full, float(array.max()) / full  # NaN where there is any
    if not 0.0 <= low <= high <= 1.0:
        raise ValueError(
            f"The photograph ranges over {low:g}..{high:g}; give uint8, uint16, or numbers from 0 to 1."
        )
    return Photograph((array[..., None] if array.ndim == 2 else array)[::-1], called, full)


_NAMES = f"{', '.join(list(MATERIALS)[:-1])} or {list(MATERIALS)[-1]}"


def _named(value):
    if value.casefold() not in MATERIALS:
        raise ValueError(f"There is no material {value!r}; give {_NAMES}.")
    return MATERIALS[value.casefold()]


def _loadable(value):
    rows, columns = value.k_s.shape
    if rows & (rows - 1) or columns & (columns - 1):
        raise ValueError(
            f"The material has {rows} rows and {columns} columns of texels; textures have powers of two."
        )
    return value


_MATERIALS = {str: _named, Material: _loadable, MaterialParameters: lambda value: value}


def material(value):
    """A ``material_textures.Material``, or the MaterialParameters of a name, unchanged.

    Raises ValueError for anything else, and for a Material whose edges are no powers of two.
    """
    for kind, read in _MATERIALS.items():
        if isinstance(value, kind):
            return read(value)
    raise ValueError(f"The material is of type {type(value).__name__}; give {_NAMES}, or a Material.")


def material_name(value):
    """Its name, as ``material`` takes it; if it has none, a description in words."""
    names = [name for name, known in MATERIALS.items() if known is value]
    if names:
        return names[0]
    if isinstance(value, Material):
        return "a Material of {} x {} texels".format(*value.k_s.shape)
    return repr(value)
