"""A user's environment as maps of directions: a panorama, a light probe or the faces of a cube.

Its components are bytes, or of high dynamic range.

Layouts, all with their top row first:

    latlong  twice as wide as high: columns are the angles around the y axis, the middle is -z and the right
             half is towards +x; rows are the angles from straight up to straight down
    ball     square, a light probe of Debevec's kind: the angle from -z grows with the distance from the
             middle, to a half turn at the circle
    mirror   square, the photograph of a mirroring ball from +z, far away
    cross    a cube's faces as seen from inside, 4:3 with -x, -z, +x, +z in a row and +y and -y above and
             below -z, or 3:4 with -x, -z, +x in a row and +y, -z, -y and +z in a column, +z upside down
    strip    a cube's faces +x, -x, +y, -y, +z, -z side by side (6:1) or one below the other (1:6), each with
             its row of the smallest t first, as textures are loaded

This module reads Radiance (.hdr) files, and the extra ``probes`` OpenEXR files. Any other file is a picture,
whose components are taken unchanged; one is full.

Source: Debevec 1998, Light Probe Image Gallery (the angular map); EXT_texture_cube_map, table 3.8 (faces).
"""

import math
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.environment_maps import prefilter
from fixedpipe.effects.geometry import cube_maps, parabolic_maps
from fixedpipe.effects.refusal import Refusal, choose
from fixedpipe.effects.user_pictures import probe_files
from fixedpipe.effects.user_pictures.inputs import read_picture
from fixedpipe.effects.user_pictures.reading import understood

# Texels along a face's edge at which a picture is looked up, before they are averaged; it is halved itself
# while it has more than two columns for each, of maps of so many texels four.
_MOST_FINE = 1024
# Rows that become floats at a time.
_ROWS = 64
KINDS = ("cube", "parabolic", "prefilter")
LATLONG, BALL, MIRROR, CROSS, STRIP = LAYOUTS = ("latlong", "ball", "mirror", "cross", "strip")
_TITLES = {LATLONG: "panorama", BALL: "light probe", MIRROR: "mirroring ball", CROSS: "cross", STRIP: "strip"}
# Columns and rows of faces, and of each face where it stands and how it is turned there.
_UPRIGHT, _MIRRORED, _FLIPPED, _TURNED = (1, 1), (1, -1), (-1, 1), (-1, -1)
_AROUND = ((1, 2, _MIRRORED), (1, 0, _MIRRORED), (0, 1, _FLIPPED), (2, 1, _FLIPPED))
_CELLS = {
    (4, 3): (CROSS, (*_AROUND, (1, 3, _MIRRORED), (1, 1, _MIRRORED))),
    (3, 4): (CROSS, (*_AROUND, (3, 1, _FLIPPED), (1, 1, _MIRRORED))),
    (6, 1): (STRIP, tuple((0, k, _UPRIGHT) for k in range(6))),
    (1, 6): (STRIP, tuple((k, 0, _UPRIGHT) for k in range(6))),
}


@dataclass(frozen=True, eq=False)
class Probe:
    """An environment: radiance from zero on, of any type, grey or RGB first, top row first.

    values   [rows, columns, 1 to 4 components]; of the faces of a cube [6 n, n, components], face after face
    called   where it comes from, in words
    full     what is one
    layout   None: LATLONG if it is twice as wide as high, else BALL; a cube's faces are STRIP
    notes    how the file was read, in words
    """

    values: NDArray = field(repr=False)
    called: str
    full: float = 1.0
    layout: str | None = None
    notes: tuple[str, ...] = ()

    def __post_init__(self):
        square = self.values.shape[0] == self.values.shape[1]
        object.__setattr__(self, "layout", self.layout or (BALL if square else LATLONG))

    def _floats(self, values):
        """Some of the values as RGB, float64 [..., 3]."""
        colors = np.maximum(values[..., :3].astype(np.float64) / self.full, 0.0)
        return np.repeat(colors[..., :1], 3, axis=-1) if values.shape[-1] < 3 else colors

    @property
    def panorama(self) -> bool:
        """Whether it is a panorama, all around from left to right."""
        return self.layout == LATLONG

    @property
    def colors(self) -> NDArray[np.float64]:
        """All values as RGB, float64 [rows, columns, 3]."""
        return self._floats(self.values)

    @cached_property
    def _faces(self):
        n = self.values.shape[1]
        return self.colors.reshape(6, n, n, 3)

    @property
    def brightest(self):
        """The largest of all numbers."""
        return max(float(self.values[..., :3].max()) / self.full, 0.0)

    def halved(self):
        """The Probe of half as many rows and columns; each is even."""
        rows, columns = self.values.shape[:2]
        out = np.empty((rows // 2, columns // 2, 3))
        for first in range(0, rows, _ROWS):
            some = self._floats(self.values[first : first + _ROWS])
            some = some[0::2] + some[1::2]
            out[first // 2 : (first + _ROWS) // 2] = (some[:, 0::2] + some[:, 1::2]) / 4.0
        return Probe(out, self.called, layout=self.layout)

    def radiance(self, toward):
        """RGB float64 [..., 3] of directions [..., 3], not zero, of any length; linear between pixels."""
        toward = np.asarray(toward, np.float64)
        if self.layout == STRIP:
            return cube_maps.look_up(self._faces, toward)
        x, y, z = (toward[..., k] for k in range(3))
        rows, columns = self.values.shape[:2]
        if self.layout == LATLONG:
            s = np.arctan2(x, -z) / (2.0 * np.pi) + 0.5
            t = 0.5 - np.arctan2(y, np.hypot(x, z)) / np.pi
        else:
            across = np.hypot(x, y)
            if self.layout == BALL:
                share = 0.5 * np.arctan2(across, -z) / np.pi
            else:  # half the sine of the normal's angle from +z, which is half the direction's
                share = 0.5 * np.sin(0.5 * np.arctan2(across, z))
            share = share / np.where(across > 0.0, across, 1.0)
            s, t = 0.5 + x * share, 0.5 - y * share
        column, row = s * columns - 0.5, np.clip(t * rows - 0.5, 0.0, rows - 1.0)
        if self.layout != LATLONG:
            column = np.clip(column, 0.0, columns - 1.0)
        i, j = np.floor(column).astype(np.int64), np.floor(row).astype(np.int64)
        u, v = (column - i)[..., None], (row - j)[..., None]
        low, high = (
            self._floats(self.values[k, i % columns]) * (1.0 - u)
            + self._floats(self.values[k, (i + 1) % columns]) * u
            for k in (j, np.minimum(j + 1, rows - 1))
        )
        return low * (1.0 - v) + high * v

    def __str__(self):
        rows, columns = self.values.shape[:2]
        size = f"6 faces of {columns}x{columns}" if self.layout == STRIP else f"{columns}x{rows}"
        title = "cube" if self.layout == STRIP else _TITLES[self.layout]
        said = "".join(f", {note}" for note in self.notes)
        return f"{title} of {size} pixels, brightest {self.brightest:.4g}{said}"


def _kind_of(path):
    try:
        with path.open("rb") as file:
            begin = file.read(16)
    except OSError as error:
        raise Refusal(f"{path} cannot be read: {error.strerror}.") from error
    return next((kind for first, kind in probe_files.BEGINNINGS.items() if begin.startswith(first)), None)


_READERS = {"Radiance": probe_files.radiance, "OpenEXR": probe_files.openexr}


def probe(name, layout=None):
    """The Probe of a file's name: Radiance, OpenEXR, PNG, TIFF, JPEG, NPY, or ``sample:`` and a name.

    layout  one of LAYOUTS; None: LATLONG of a picture that is twice as wide as high, BALL of a square

    Values below zero, which a lens's correction may leave, become zero. Raises Refusal for a file that cannot
    be read, for NaN and infinity, and for a shape that is not the layout's.
    """
    if layout is not None:
        choose("layout", layout, dict.fromkeys(LAYOUTS))
    path = Path(name)
    sample = name.startswith("sample:")
    if not sample and not path.is_file():
        problem = f"{name} is no file" if name and path.exists() else f"There is no file {name!r}"
        raise Refusal(f"{problem}. Give a Radiance, OpenEXR, PNG, TIFF, JPEG or NPY file.")
    kind = None if sample else _kind_of(path)
    if kind is None:
        values, notes = read_picture(name, fills=False), ()
    else:
        values, notes = _READERS[kind](path)
        understood(name, values, notes)
    full = {"b": 1.0, "u": float(np.iinfo(values.dtype).max) if values.dtype.kind == "u" else 1.0}
    full = full.get(values.dtype.kind, 1.0)
    given = values.shape
    values = values[..., None] if values.ndim == 2 else values
    if values.ndim != 3 or not 1 <= values.shape[2] <= 4:
        raise Refusal(f"{name} has shape {given}; give [rows, columns] of one to four components.")
    layout = _layout_of(name, *values.shape[1::-1], layout)
    values = values[..., : 3 if values.shape[2] > 2 else 1]
    if values.dtype.kind == "f" and not np.isfinite(values).all():
        raise Refusal(f"{name} holds NaN or infinity; repair it, an environment is finite everywhere.")
    if layout in (CROSS, STRIP):
        return Probe(_faces_of(values), name, full, STRIP, (f"of a {_TITLES[layout]}", *notes))
    return Probe(values, name, full, layout, tuple(notes))


_WANTED = {
    None: "a panorama twice as wide as high, or a square light probe",
    LATLONG: "a panorama of two rows and columns or more",
    BALL: "a square light probe",
    MIRROR: "a square photograph of a mirroring ball",
    CROSS: "a cross of 4:3 or 3:4, whose faces are square",
    STRIP: "a strip of 6:1 or 1:6, whose faces are square",
}


def _layout_of(name, columns, rows, layout):
    """The layout of a picture, as it is named or as its shape says. Raises Refusal where it has another."""
    cells = next((c for c in _CELLS if columns * c[1] == rows * c[0] and columns % c[0] == 0), None)
    if cells:
        shaped = (_CELLS[cells][0],)
    else:
        shaped = (BALL, MIRROR) if columns == rows else (LATLONG,) if columns == 2 * rows else ()
    large = min(columns, rows) > 1 or cells
    if layout is None and shaped and large and not cells:
        return shaped[0]
    # Whatever its shape, what is said to be all directions is.
    if layout and large and (layout in shaped or (layout == LATLONG and min(columns, rows) > 1)):
        return layout
    has = f"{name} has {columns}x{rows} pixels"
    if layout is None and cells:
        raise Refusal(
            f"{has}, {cells[0]}:{cells[1]} as a cube's faces in a {shaped[0]}; say so with --as {shaped[0]}, "
            f"or give {_WANTED[None]}."
        )
    raise Refusal(f"{has}; give {_WANTED[layout]}.")


def _faces_of(values):
    """The faces of a cross or a strip, face after face: [6 n, n, components]."""
    rows, columns = values.shape[:2]
    (wide, _), (_, cells) = next(
        (shape, found) for shape, found in _CELLS.items() if columns * shape[1] == rows * shape[0]
    )
    n = columns // wide
    return np.concatenate(
        [
            values[row * n : (row + 1) * n, column * n : (column + 1) * n][::down, ::right]
            for row, column, (down, right) in cells
        ]
    )


def _cube(found, size):
    """A cube map whose texels are means of all that they cover."""
    most = (4 if size > _MOST_FINE // 2 else 2) * _MOST_FINE
    while found.values.shape[1] > most and not any(n % 2 for n in found.values.shape[:2]):
        found = found.halved()
    fine = size
    while 2 * fine < found.values.shape[1] and 2 * fine <= _MOST_FINE:
        fine *= 2
    # Face by face: the directions of all are many.
    return prefilter.reduced(np.stack([found.radiance(face) for face in cube_maps.directions(fine)]), size)


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
    """The factor of maps of floats for a picture: one if bytes hold all numbers, else less, so that 99.5 % of
    the numbers are below one.
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
    for face, (row, column, (down, right)) in zip(stored, _CELLS[4, 3][1], strict=True):
        out[row * size : (row + 1) * size, column * size : (column + 1) * size] = face[::down, ::right]
    return out
