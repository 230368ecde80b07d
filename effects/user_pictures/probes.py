"""A user's environment, a panorama or a light probe, of bytes or of high dynamic range, as maps of
directions.

Panoramas are twice as wide as high: columns are the angles around the y axis, the middle is -z and the right
half is towards +x; rows are the angles from straight up to straight down. A square picture is a light probe
of Debevec's kind: the angle from -z grows with the distance from the middle, to a half turn at the circle.

Radiance (.hdr) and OpenEXR files are read by OpenImageIO, the extra ``probes``; all else is a picture whose
components are taken as they stand, one is full.

Source: Debevec 1998, Light Probe Image Gallery (the angular map); Radiance's and OpenEXR's file formats.
"""

import math
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.environment_maps import prefilter
from fixedpipe.effects.geometry import cube_maps, parabolic_maps
from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.user_pictures.inputs import read_picture

# How files of high dynamic range begin.  Source: their specifications.
_BEGINNINGS = {b"#?RADIANCE": "Radiance", b"#?RGBE": "Radiance", b"\x76\x2f\x31\x01": "OpenEXR"}
# Numbers of a file that are read.  Assumed: 16384 x 8192 texels, which most hosts hold as floats.
_MOST_TEXELS = 1 << 27
# Texels along a face's edge at which a picture is looked up, before they are averaged; it is halved itself
# while it has more than two columns for each, of maps of so many texels four.
_MOST_FINE = 1024
KINDS = ("cube", "parabolic", "prefilter")


@dataclass(frozen=True, eq=False)
class Probe:
    """An environment: float64 [rows, columns, 3], radiance from zero on, top row first.

    ``called``: where it comes from, in words.
    """

    colors: NDArray[np.float64] = field(repr=False)
    called: str

    @property
    def panorama(self) -> bool:
        """Whether it is twice as wide as high; else it is square, a light probe."""
        return self.colors.shape[1] != self.colors.shape[0]

    def radiance(self, toward):
        """RGB float64 [..., 3] of directions [..., 3], not zero, of any length; linear between pixels."""
        toward = np.asarray(toward, np.float64)
        x, y, z = (toward[..., k] for k in range(3))
        rows, columns = self.colors.shape[:2]
        if self.panorama:
            s = np.arctan2(x, -z) / (2.0 * np.pi) + 0.5
            t = 0.5 - np.arctan2(y, np.hypot(x, z)) / np.pi
        else:
            across = np.hypot(x, y)
            share = 0.5 * np.arctan2(across, -z) / np.pi / np.where(across > 0.0, across, 1.0)
            s, t = 0.5 + x * share, 0.5 - y * share
        column, row = s * columns - 0.5, np.clip(t * rows - 0.5, 0.0, rows - 1.0)
        if not self.panorama:
            column = np.clip(column, 0.0, columns - 1.0)
        i, j = np.floor(column).astype(np.int64), np.floor(row).astype(np.int64)
        u, v = (column - i)[..., None], (row - j)[..., None]
        low, high = (
            self.colors[k, i % columns] * (1.0 - u) + self.colors[k, (i + 1) % columns] * u
            for k in (j, np.minimum(j + 1, rows - 1))
        )
        return low * (1.0 - v) + high * v


def _kind_of(path):
    try:
        with path.open("rb") as file:
            begin = file.read(16)
    except OSError as error:
        raise Refusal(f"{path} cannot be read: {error.strerror}.") from error
    return next((kind for first, kind in _BEGINNINGS.items() if begin.startswith(first)), None)


def _read_floats(path, kind):
    """The values of a Radiance or OpenEXR file: float32 [rows, columns, components]."""
    try:
        import OpenImageIO
    except ImportError:
        raise Refusal(
            f"{path} is a {kind} file, which needs the extra `probes`: pip install 'fixedpipe[probes]'."
        ) from None
    damaged = f"{path} begins as a {kind} file and cannot be read to its end; save it again."
    file = OpenImageIO.ImageInput.open(str(path))
    if file is None:
        OpenImageIO.geterror()
        raise Refusal(damaged)
    spec = file.spec()
    if spec.width * spec.height > _MOST_TEXELS:
        raise Refusal(
            f"{path} has {spec.width}x{spec.height} pixels, more than the {_MOST_TEXELS} that are read; make "
            "it smaller."
        )
    values = file.read_image("float")
    file.close()
    if values is None:
        raise Refusal(damaged)
    return np.asarray(values).reshape(spec.height, spec.width, -1)


def probe(name):
    """The Probe of a file's name: Radiance, OpenEXR, PNG, TIFF, JPEG, NPY, or ``sample:`` and a name.

    Values below zero, which a lens's correction may leave, become zero. Raises Refusal for a file that cannot
    be read, for NaN and infinity, and for another shape than 2:1 or a square.
    """
    path = Path(name)
    sample = name.startswith("sample:")
    if not sample and not path.is_file():
        problem = f"{name} is no file" if name and path.exists() else f"There is no file {name!r}"
        raise Refusal(f"{problem}. Give a Radiance, OpenEXR, PNG, TIFF, JPEG or NPY file.")
    kind = None if sample else _kind_of(path)
    values = read_picture(name) if kind is None else _read_floats(path, kind)
    full = {"b": 1.0, "u": float(np.iinfo(values.dtype).max) if values.dtype.kind == "u" else 1.0}
    colors = np.asarray(values, np.float64) / full.get(values.dtype.kind, 1.0)
    colors = colors[..., None] if colors.ndim == 2 else colors
    if colors.ndim != 3 or not 1 <= colors.shape[2] <= 4:
        raise Refusal(f"{name} has shape {values.shape}; give [rows, columns] of one to four components.")
    colors = np.repeat(colors[..., :1], 3, axis=-1) if colors.shape[2] < 3 else colors[..., :3]
    rows, columns = colors.shape[:2]
    if rows < 2 or columns not in (rows, 2 * rows):
        raise Refusal(
            f"{name} has {columns}x{rows} pixels; give a panorama twice as wide as high, or a square light "
            "probe."
        )
    if not np.isfinite(colors).all():
        raise Refusal(f"{name} holds NaN or infinity; repair it, an environment is finite everywhere.")
    return Probe(np.maximum(colors, 0.0), name)


def _halved(colors):
    rows = colors[0::2] + colors[1::2]
    return (rows[:, 0::2] + rows[:, 1::2]) / 4.0


def _cube(found, size):
    """A cube map whose texels are means of all that they cover."""
    colors = found.colors
    most = (4 if size > _MOST_FINE // 2 else 2) * _MOST_FINE
    while colors.shape[1] > most and colors.shape[0] % 2 == 0 and colors.shape[1] % 2 == 0:
        colors = _halved(colors)
    fine = size
    while 2 * fine < colors.shape[1] and 2 * fine <= _MOST_FINE:
        fine *= 2
    whole = Probe(colors, found.called)
    return prefilter.reduced(whole.radiance(cube_maps.directions(fine)), size)


def maps(found, kind, size, exponent=None, threads=None):
    """A Probe as maps of floats: [6, size, size, 3] of ``cube`` and ``prefilter``, [2, size, size, 3] of
    ``parabolic``, in the layouts of ``geometry``'s modules, the discs touching their maps' edges.

    exponent  of ``prefilter``'s lobe; 1 is the cosine of diffuse light
    threads   of the filter; None: one a processor

    Raises ValueError for another kind, and for a size or an exponent that is none.
    """
    size = cube_maps.size_of(size, "The map's size")
    if kind == "cube":
        return _cube(found, size)
    if kind == "parabolic":
        cube = _cube(found, 1 << max(size - 1, 1).bit_length())
        return cube_maps.look_up(cube, parabolic_maps.directions(size))
    if kind == "prefilter":
        return prefilter.phong(_cube(found, max(size, 256)), exponent, size, threads)
    raise ValueError(f"There is no kind of map {kind!r}. There are: {', '.join(KINDS)}.")


def checked_exponent(exponent):
    """``prefilter.exponent_of``: the exponent that a lobe has. Raises ValueError for what is none."""
    return prefilter.exponent_of(exponent)


def exposure_of(faces):
    """What maps of floats are multiplied by as a picture: one where bytes hold all, else less, so that 99.5 %
    of the numbers are below one.
    """
    return 1.0 if faces.max() <= 1.0 else min(1.0, prefilter.exposure(faces))


def picture(faces, exposure):
    """Maps of floats as a picture: uint8 [h, w, 3], top row first.

    A cube map as a cross four faces wide and three high, as seen from inside and black beside it; discs side
    by side. ``exposure``: what values are multiplied by; above one they are cut.
    """
    if not math.isfinite(exposure) or exposure <= 0.0:
        raise ValueError(f"The exposure is {exposure!r}; give a positive number.")
    stored = np.floor(255.0 * np.clip(exposure * faces, 0.0, 1.0) + 0.5).astype(np.uint8)
    if len(faces) == 2:
        return np.concatenate([stored[0, ::-1], stored[1, ::-1]], axis=1)
    size = faces.shape[1]
    out = np.zeros((3 * size, 4 * size, 3), np.uint8)
    # From the left -x, -z, +x and +z, whose s runs to the left as seen from inside; +y and -y beside -z.
    for face, (row, column) in enumerate(((1, 2), (1, 0), (0, 1), (2, 1), (1, 3), (1, 1))):
        turned = stored[face, ::-1] if face in (2, 3) else stored[face, :, ::-1]
        out[row * size : (row + 1) * size, column * size : (column + 1) * size] = turned
    return out
