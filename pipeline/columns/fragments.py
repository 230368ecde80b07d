"""Fragments as columns, and their depths as words of the depth buffer."""

from dataclasses import dataclass

import numpy as np

from fixedpipe.pipeline.textures.depth_words import DEPTH_WORDS
from fixedpipe.raster.columns import interpolate


@dataclass(frozen=True, eq=False)
class FragmentColumns:
    """Fragments as columns, in draw order. A column may be read only.

    x, y                int64 [k], device pixels, y down
    depth               int64 [k], words of the depth buffer; below 0: a depth limit discards the fragment
    primary, secondary  int64 [k, 4], in units of the fragment's value of one
    fog                 float64 [k], fog coordinates; None: fog is disabled
    coordinates         float64 [k, units, 4]: each texture unit's s, t, r, q, before division by q
    lod                 float64 [k, units], lambda without bias, in steps of 1/256; None: every fragment is
                        magnified
    divided             for each unit, whether s, t and r are divided by q; None: they are if some fragment's
                        q is not 1
    footprints          float64 [k, units, 3]: an anisotropic filter's footprint along s and t, and its ratio
    sides               float64 [k, units, 4], for lookups filtered by roughness: the steps in texels to the
                        right (s, t) and downwards, without bumps. NaN where there are none; None: no such
                        lookup
    covered             int64 [k], the number of the machine's samples that a smooth primitive covers; None:
                        no primitive is smooth
    texel_alpha         int64 [k], bytes that replace the alpha of unit 0's texels; None: nothing replaces it
    """

    x: np.ndarray
    y: np.ndarray
    depth: np.ndarray
    primary: np.ndarray
    secondary: np.ndarray
    fog: np.ndarray | None
    coordinates: np.ndarray
    lod: np.ndarray | None = None
    divided: tuple[bool, ...] | None = None
    footprints: np.ndarray | None = None
    sides: np.ndarray | None = None
    texel_alpha: np.ndarray | None = None
    covered: np.ndarray | None = None

    def part(self, where):
        """The fragments that ``where`` selects."""

        def of(column):
            return None if column is None else column[where]

        return FragmentColumns(
            self.x[where],
            self.y[where],
            self.depth[where],
            self.primary[where],
            self.secondary[where],
            of(self.fog),
            self.coordinates[where],
            of(self.lod),
            self.divided,
            of(self.footprints),
            of(self.sides),
            of(self.texel_alpha),
            of(self.covered),
        )


def fragment_depths(depths, state, framebuffer):
    """Depths, in units of the depth buffer, as its words, int64 [k].

    The word is -1 where a depth limit discards the fragment (docs/numbers.md, section 5).
    """
    limits, words = state.depth_clamp, DEPTH_WORDS[framebuffer.depth_format]
    low, high = 0.0, words.farthest
    if limits is not None:
        low, high = limits.minimum, high if limits.maximum is None else limits.maximum
    found, inside = interpolate.depth_words(depths, low, high, words.farthest, words.form)
    return np.where(inside, found, -1) if limits is not None and limits.cull else found
