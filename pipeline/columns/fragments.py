"""Fragments as columns, and which words their depths are."""

from dataclasses import dataclass

import numpy as np

from fixedpipe.pipeline.textures.depth_words import DEPTH_WORDS
from fixedpipe.raster.columns import interpolate


@dataclass(frozen=True, eq=False)
class FragmentColumns:
    """Fragments as columns, in draw order; a column may be read only.

    x, y         int64 [k], device pixels, y down
    depth        int64 [k], words of the depth buffer; below 0: outside its limits, the fragment ends
    primary, secondary  int64 [k, 4], in units of the fragment's value of one
    fog          float64 [k], fog coordinates; None: fog is disabled
    coordinates  float64 [k, units, 4]: s, t, r, q of each texture unit, not divided
    lod          float64 [k, units], lambda without its bias, 1/256 at least apart; None: all is magnified
    divided      for each unit whether s, t and r are divided by q; None: where some fragment's q is not 1
    footprints   float64 [k, units, 3]: s and t along an anisotropic filter's footprint, and its ratio
    sides        float64 [k, units, 4]: of lookups filtered by roughness, the steps in texels to the right
                 (s, t) and downwards without bumps, not numbers where there are none; None: no such lookup
    covered      int64 [k], of how many of the machine's samples a smooth primitive covers; None: none is
    texel_alpha  int64 [k], bytes that replace the alpha of unit 0's texels; None: nothing does
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
        """Some of the fragments."""

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
    """Words of the depth buffer, int64 [k], of depths in its units; -1 where a fragment lies outside limits
    that end it (docs/numbers.md, section 5).
    """
    limits, words = state.depth_clamp, DEPTH_WORDS[framebuffer.depth_format]
    low, high = 0.0, words.farthest
    if limits is not None:
        low, high = limits.minimum, high if limits.maximum is None else limits.maximum
    found, inside = interpolate.depth_words(depths, low, high, words.farthest, words.form)
    return np.where(inside, found, -1) if limits is not None and limits.cull else found
