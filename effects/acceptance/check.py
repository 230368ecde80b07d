"""A Check: one number of a picture or of a study's table, the bound that it must keep, and why."""

from dataclasses import KW_ONLY, dataclass
from enum import Enum


class Answer(Enum):
    """The answer to a pass that a picture shows or a check measures. Its value is the printed word."""

    IDEAL = "ideal"  # the algorithm itself, in float64
    MACHINE = "machine"  # with the hardware's arithmetic


@dataclass(frozen=True)
class Check:
    """One acceptance check: a value and its bound.

    name      what is measured, in words
    value     the number
    at_most   its upper bound, or None
    at_least  its lower bound, or None; a Check has one bound
    on        the Answer that it is of
    reason    why this bound

    Raises ValueError where it has no bound, or two, or where ``on`` is no Answer.
    """

    name: str
    value: float
    _: KW_ONLY
    at_most: float | None = None
    at_least: float | None = None
    on: Answer
    reason: str

    def __post_init__(self) -> None:
        if len(self._bounds) != 1:
            given = f"the bounds {self.at_most!r} and {self.at_least!r}" if self._bounds else "no bound"
            raise ValueError(f"The check {self.name!r} has {given}; give one, at_most or at_least.")
        if not isinstance(self.on, Answer):
            raise ValueError(
                f"The check {self.name!r} is on {self.on!r}; give an Answer: {', '.join(map(str, Answer))}."
            )

    @property
    def _bounds(self) -> tuple[float, ...]:
        return tuple(bound for bound in (self.at_most, self.at_least) if bound is not None)

    @property
    def relation(self) -> str:
        """How the value and its bound are written with each other: "<=" or ">="."""
        return ">=" if self.at_most is None else "<="

    @property
    def bound(self) -> float:
        """The one bound."""
        return self._bounds[0]

    @property
    def passed(self) -> bool:
        """Whether the value is within the bound; a NaN is not."""
        return bool(self.value >= self.bound if self.at_most is None else self.value <= self.bound)

    def record(self) -> dict[str, str | float | bool]:
        """The check in the words and numbers of a JSON file."""
        return {
            "name": self.name,
            "value": float(self.value),
            "relation": self.relation,
            "bound": self.bound,
            "on": self.on.value,
            "reason": self.reason,
            "passed": self.passed,
        }
