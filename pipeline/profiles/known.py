"""Values that are known from somewhere: what a profile's sections are made of."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any, NamedTuple, TypeVar

EVIDENCE_TAGS = ("Source:", "Measured:", "Inferred:", "Assumed:")

_Value = TypeVar("_Value")


class Known(NamedTuple):
    """A value and how it is known."""

    value: Any
    evidence: str


def known(value: _Value, evidence: str) -> _Value:
    """A field's value with its evidence, as a ``Section`` takes it. To a type checker it is the value.

    ``evidence`` begins with one of EVIDENCE_TAGS: ``Source:`` (a specification or paper), ``Measured:`` (on
    this machine's silicon), ``Inferred:`` (from those), ``Assumed:`` (and what would settle it).

    Raises ValueError for evidence without a tag.
    """
    if not evidence.startswith(EVIDENCE_TAGS):
        raise ValueError(f"The evidence is {evidence!r}; begin it with one of {', '.join(EVIDENCE_TAGS)}")
    return Known(value, evidence)  # type: ignore[return-value]


@dataclass(frozen=True, kw_only=True)
class Section:
    """Fields of a profile on one subject. Each is given as ``known(value, evidence)`` and read as the value.

    ``evidence``: how each field is known, by its name.

    Raises ValueError for a field that is given without evidence.
    """

    evidence: Mapping[str, str] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        evidence = {}
        for name in self.names():
            given = getattr(self, name)
            if not isinstance(given, Known):
                raise ValueError(
                    f"{type(self).__name__}.{name} is {given!r}, without evidence; give "
                    "known(value, evidence)."
                )
            object.__setattr__(self, name, given.value)
            evidence[name] = given.evidence
        object.__setattr__(self, "evidence", evidence)

    @classmethod
    def names(cls) -> tuple[str, ...]:
        """The names of the fields that have evidence, in order."""
        return tuple(f.name for f in fields(cls) if f.name != "evidence")
