"""Stages of a pass that do not compute as their machine does: in real numbers, or without a clamp.

Real numbers count in the machine's units: each code is a whole number of them. A stage that is not replaced
rounds real inputs to codes. A pass without replaced stages has the machine's bits.
"""

from dataclasses import dataclass, replace

from fixedpipe.raster.columns import combine


@dataclass(frozen=True)
class ReplacedStages:
    """The replaced stages of a pass, by their names.

    The names are "primary color", "secondary color", "constant colors", "texture unit 0", "general combiner
    0" and so on, and "final combiner". Without combiners the last means color sum and fog.

    exact      stages that do not round, and whose half is exactly 1/2. A texture unit's filter and its
               fractions are exact
    unclamped  general combiners, or the final one, that do not clamp their outputs
    """

    exact: frozenset[str] = frozenset()
    unclamped: frozenset[str] = frozenset()

    @property
    def has_exact_colors(self):
        """Whether an iterated colour is exact."""
        return not self.exact.isdisjoint(("primary color", "secondary color"))

    def arithmetic(self, a, stage):
        """A stage's Arithmetic, made from the machine's own."""
        found = combine.in_reals(a) if stage in self.exact else a
        return combine.unclamped(found) if stage in self.unclamped else found

    def samplers(self, samplers):
        """The texture units' samplers; an exact unit's computes in real numbers, if it can."""
        return [
            (sampler and sampler.exactly()) or sampler if f"texture unit {number}" in self.exact else sampler
            for number, sampler in enumerate(samplers)
        ]

    def with_colors(self, fragments, exactly):
        """Fragments with the exact colours in place. ``exactly``: the same fragments in real numbers."""
        given = {"primary": "primary color", "secondary": "secondary color"}
        named = {name: getattr(exactly, name) for name, stage in given.items() if stage in self.exact}
        return replace(fragments, **named)
