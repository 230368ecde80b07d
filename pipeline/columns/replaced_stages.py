"""A pass with some of its stages computed otherwise than its machine does: in real numbers, or not clamped.

Real numbers count in the machine's units, so that every code is a whole number of them. A stage that rounds
as the machine does makes codes of whatever it is given. Where no stage is named the bits are the machine's.
"""

from dataclasses import dataclass, replace

from fixedpipe.raster.columns import combine


@dataclass(frozen=True)
class ReplacedStages:
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
        """The Arithmetic of a stage, from the machine's own."""
        found = combine.in_reals(a) if stage in self.exact else a
        return combine.unclamped(found) if stage in self.unclamped else found

    def samplers(self, samplers):
        """Texture units' samplers, those that are exact in real numbers, where they can."""
        return [
            (sampler and sampler.exactly()) or sampler if f"texture unit {number}" in self.exact else sampler
            for number, sampler in enumerate(samplers)
        ]

    def with_colors(self, fragments, exactly):
        """Fragments with those colours that are exact; ``exactly``: the same fragments in real numbers."""
        given = {"primary": "primary color", "secondary": "secondary color"}
        named = {name: getattr(exactly, name) for name, stage in given.items() if stage in self.exact}
        return replace(fragments, **named)
