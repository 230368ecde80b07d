"""A Check: one number of a picture or of a study's table, the bound that it must keep, and why."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Check:
    """One acceptance check: ``value relation bound``.

    ``relation``: "<=" or ">=". ``on``: "ideal" (the algorithm itself) or "machine" (with its arithmetic).
    ``reason``: why this bound.
    """

    name: str
    value: float
    relation: str
    bound: float
    on: str
    reason: str

    @property
    def passed(self):
        """Whether the value keeps the bound; a NaN does not."""
        return self.value <= self.bound if self.relation == "<=" else self.value >= self.bound
