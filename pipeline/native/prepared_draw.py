"""A Draw before its fragments: primitives sorted into bands of rows, and the arrays that kernels take.

The portable engine (``fixedpipe.raster.portable.draw``) draws what the vector engine
(``fixedpipe.raster.vector.frame``) does not cover.
"""

from dataclasses import dataclass

import numpy as np

from fixedpipe.pipeline.native import pack
from fixedpipe.pipeline.native.texels import NO_LEVELS, NO_TEXELS, texels_of
from fixedpipe.pipeline.textures.sampled import sampled_texture
from fixedpipe.pipeline.vertices.colors import fragment_colors
from fixedpipe.pipeline.vertices.primitives import WindowPrimitives
from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.primitives.bins import BAND_HEIGHT, CHUNK, count_bins, fill_bins, sort_triangles
from fixedpipe.raster.vector.arrays import JOB_SIZE
from fixedpipe.raster.vector.frame import fill_draw

NO_RECORD = np.zeros((0, 5), np.int32)
_NO_COLORS = np.zeros((0, 2, 8), np.uint8)
_NO_PAIRS = [NO_TEXELS] * 4


def sort_into_bands(primitives, draw, height):
    """(triangle numbers, band after band; each band's end among them; the number of dropped triangles)."""
    bands = -(-height // BAND_HEIGHT)
    p, count = primitives, len(primitives.triangles)
    if p.orderly and not len(p.strokes) and not draw[R.COVER_SAMPLES]:
        order, needed = np.empty(0, np.int32), 2 * count + 4 * bands
        while needed > len(order):
            order, ends = np.empty(needed, np.int32), np.empty(bands, np.int32)
            scratch = np.empty(len(p.x), np.int64), np.empty((4, CHUNK), np.int64), np.empty(count, np.int64)
            needed = sort_triangles(p.triangles, p.x, p.y, draw, scratch, ends, order)
        return order[:needed], ends, 0
    counts, spans = np.empty(bands, np.int32), np.empty((count, 2), np.int32)
    dropped = count_bins(p.triangles, p.strokes, p.x, p.y, p.inverse_w, draw, counts, spans)
    ends = np.zeros(bands, np.int32)
    ends[1:] = np.cumsum(counts)[:-1]
    order = np.empty(int(counts.sum()), np.int32)
    fill_bins(spans, ends, order)
    return order, ends, int(dropped)


@dataclass(eq=False, slots=True)
class Prepared:
    """A Draw before its fragments.

    - ``dropped``: the number of dropped primitives.
    - ``bound``: (name, Texture) of each texture that it reads.
    - ``area``: pixels of the scissor box. 0: nothing is left to draw, and the later fields are unset.
    - ``size``: bytes of vertices.
    - ``colors``: int16 [n, 2, 8], the vertices' colours in units of the fragments' width; None: not made yet.
    - ``texels``: the Texels of four units, or None.
    - ``levels``: int32 [units, MAX_LEVELS, 3].
    - ``order``: primitives sorted into bands (``fixedpipe.raster.primitives.bins``).
    - ``ends``: the end of each band's primitives in ``order``.
    - ``job``: a row of the vector engine's table; False: the portable engine draws it; None: not made yet.
    - ``beside``: arrays that only this row names.
    """

    dropped: int
    bound: tuple
    area: int = 0
    size: int = 0
    primitives: WindowPrimitives | None = None
    packed: pack.PackedState | None = None
    colors: np.ndarray | None = None
    texels: list | None = None
    levels: np.ndarray | None = None
    order: np.ndarray | None = None
    ends: np.ndarray | None = None
    job: object = None
    beside: object = None

    @classmethod
    def of(cls, primitives, state, profile, framebuffer, textures, sample=None):
        """A Draw of window primitives, sorted into bands, with the arrays that kernels take.

        Colours are rounded where fragments are bytes. ``framebuffer`` is any one of the targets' size and
        formats. ``sample`` is the place in a pixel that decides coverage, see ``pack_coverage``.
        """
        p, colors = primitives, None
        packed = pack.pack(state, profile, framebuffer, textures, primitives, sample)
        if p.colors.dtype == np.float64:
            bits, sides = int(packed.draw[R.BITS]), 2 if p.two_side else 1  # the other: same, or unread
            colors = np.empty(p.colors.shape, np.int16)
            colors[:] = fragment_colors(p.colors[:, :sides], state, profile, bits)
        bound = tuple([(name, textures[name]) for _, name, _ in packed.reads])
        if len(p.triangles) == 0 or packed.area == 0:
            return cls(p.dropped, bound)
        order, ends, dropped = sort_into_bands(p, packed.draw, framebuffer.height)
        if len(order) == 0:
            return cls(dropped + p.dropped, bound)
        texels, levels = texels_and_levels(packed.reads, state, textures, len(packed.units))
        size = p.colors.nbytes + p.coordinates.nbytes + 40 * len(p.x) + 16 * len(p.triangles) + 4 * len(order)
        return cls(
            dropped + p.dropped,
            bound,
            packed.area,
            size,
            p,
            packed,
            colors,
            texels,
            levels,
            order,
            ends,
        )

    def bands(self, first, step, batch, buffers, record=NO_RECORD):
        """Draw bands ``first``, ``first + step``, ... with the portable engine.

        Returns the number of fragments.
        """
        from fixedpipe.raster.portable.draw import draw_bands

        p, packed = self.primitives, self.packed
        if self.colors is None:
            self.colors = p.colors.astype(np.int16)
        texels = tuple([NO_TEXELS if texels is None else texels.packed for texels in self.texels])
        arrays = (
            self._state(),
            (packed.program, packed.final, packed.constants, packed.arithmetic),
            p.triangles,
            p.strokes,
            self._vertices(),
            self.colors,
            (p.fog, packed.fog_thresholds),
            (texels, self.levels, packed.units),
        )
        bands = self.order, self.ends
        count = draw_bands(arrays, bands, first, step, batch, tuple(buffers), record)
        if count < 0:
            raise ValueError(
                "A pass's rows would lead outside an array; take them from "
                "fixedpipe.pipeline.native.pack.pack."
            )
        return count

    def fill_job(self):
        """Make ``job``."""
        packed = self.packed
        self.job = False
        if packed.wide or packed.draw[R.COVER_SAMPLES]:
            return
        plan = packed.rows.filled_plan(packed.draw, packed.units, packed.derived)
        given = self._state(), plan, self.primitives.triangles, self._vertices(), packed.units
        made = make_job(given, (self.order, self.ends), self.texels, self.levels)
        if made is not None:
            # The job names the plan by its address. Another thread's equal plan may replace it in the rows.
            self.job, self.beside = made[0], (plan, made[1])

    # The arrays that both engines' kernels take; ``raster/arrays.py`` names the members.

    def _state(self):
        return self.packed.draw, self.packed.draw_float, self.packed.factors

    def _vertices(self):
        p = self.primitives
        colors = p.colors if p.colors.dtype == np.uint8 else _NO_COLORS
        return p.x, p.y, self.packed.depths, p.inverse_w, colors, p.coordinates


def make_job(given, bands, texels, levels):
    """(a row of the vector engine's table, the arrays that only this row names), or None: it does not cover
    the Draw.

    - ``given``: the arrays of a Pass, but units' rows alone in place of its textures.
    - ``bands``: the arrays of Bands.
    - ``texels``: the Texels of four units, or None.
    - ``levels``: int32 [units, MAX_LEVELS, 3].
    """
    *arrays, units = given
    job, beside = np.zeros((1, JOB_SIZE), np.int64), (_NO_PAIRS, levels)
    if not fill_draw(job, 0, (*arrays, (tuple(_NO_PAIRS), levels, units)), bands):
        return None
    # Now the sampling path of each unit is known, and so the textures that are needed as row pairs.
    paths = job[0, R.JOB_UNIT_PATH : R.JOB_UNIT_PATH + 4].tolist()
    if paths != [C.PATH_DISABLED] * 4:
        pairs, of_pairs = [NO_TEXELS] * 4, [NO_LEVELS] * len(levels)
        for i, (path, read) in enumerate(zip(paths, texels, strict=True)):
            if path != C.PATH_DISABLED:
                pairs[i], of_pairs[i] = read.pairs
        beside = pairs, stacked(of_pairs)
        fill_draw(job, 0, (*arrays, (tuple(pairs), beside[1], units)), bands)
    return job[0], beside


def texels_and_levels(reads, state, textures, units):
    """The Texels of four units, or None; and their levels, int32 [units, MAX_LEVELS, 3].

    ``reads`` is as in PackedState, and ``units`` the number of units' rows.
    """
    texels, levels = [None] * 4, [NO_LEVELS] * units
    for i, _, signed in reads:
        texels[i] = texels_of(sampled_texture(state.texture_units[i], textures), signed)
        levels[i] = texels[i].levels
    return texels, stacked(levels)


def stacked(levels):
    """Levels int32 [1, MAX_LEVELS, 3] of each unit as one array."""
    return levels[0] if len(levels) == 1 else np.concatenate(levels)
