"""A pass with some of its stages computed otherwise than its machine does: not rounded, or not clamped.

Colours are held in units finer than the machine's: of twice as many bits, since 2**2c - 1 is 2**c + 1 times
2**c - 1. So every code of the machine is a whole number of them, a stage that rounds as the machine does
makes such numbers, and one that does not keeps twice the bits. Where no stage is named the bits are the
machine's.
"""

from dataclasses import dataclass, replace

import numpy as np

from fixedpipe.raster.columns import numbers

MOST_BITS = 12  # of the machine: products of numbers of twice as many are int64
_FRACTION_BITS = 16  # of an exact filter's fractions
# How far a register reaches whose clamp is off: mapped by EXPAND_NORMAL it doubles; of products of two such
# six in a sum, times four and doubled once more to be rounded, are int64.
_FAR = 1 << 27


@dataclass(frozen=True)
class Otherwise:
    """What is computed otherwise, by names: "primary color", "secondary color", "constant colors", "texture
    unit 0", "general combiner 0" and so on, "final combiner", which is color sum and fog where there are no
    combiners.

    exact      these do not round, and their half is one half; of a texture unit: its filter and its fractions
    unclamped  of general combiners and the final one: these do not clamp what they make
    """

    exact: frozenset[str] = frozenset()
    unclamped: frozenset[str] = frozenset()

    @property
    def has_exact_colors(self):
        """Whether iterated colours are among what is exact."""
        return not self.exact.isdisjoint(("primary color", "secondary color"))

    def arithmetic(self, a, stage):
        """The Arithmetic of a stage in finer units, from the machine's own."""
        grid, exact, unclamped = a.one + 2, stage in self.exact, stage in self.unclamped
        one = a.one * grid

        def reached(limit):
            return max(-_FAR, min(_FAR, limit))

        return replace(
            a,
            one=one,
            half=(one + 1) // 2 if exact else a.half * grid,
            expanded=one if exact else a.expanded * grid,
            low=-_FAR if unclamped else reached(a.low * grid),
            high=_FAR if unclamped else reached(a.high * grid),
            holds=(a.holds[0] * grid, a.holds[1] * grid),
            clamps_final=a.clamps_final and not unclamped,
            grid=1 if exact else grid,
        )

    def samplers(self, samplers):
        """Texture units' samplers, those that are exact with finer texels and fractions, where they can."""
        return [
            (sampler and sampler.exactly(_FRACTION_BITS)) or sampler
            if f"texture unit {number}" in self.exact
            else sampler
            for number, sampler in enumerate(samplers)
        ]

    def width_of(self, unit, bits):
        """(bits that a texture unit's register is made of, how many finer units make one of its own)."""
        if f"texture unit {unit}" in self.exact:
            return 2 * bits, 1
        return bits, numbers.one_of(bits) + 2

    def finer(self, fragments, exactly, bits):
        """Fragments with colours in finer units: those of ``exactly``, the same fragments computed in them,
        where they are exact; None: none is.
        """
        grid = numbers.one_of(bits) + 2
        primary, secondary = fragments.primary * grid, fragments.secondary * grid
        if "primary color" in self.exact:
            primary = exactly.primary
        if "secondary color" in self.exact:
            secondary = exactly.secondary
        primary, secondary = (np.clip(color, -_FAR, _FAR) for color in (primary, secondary))
        return replace(fragments, primary=primary, secondary=secondary)
