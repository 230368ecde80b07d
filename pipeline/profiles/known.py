"""Values with their evidence, and the sections of a profile that are made of them."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from numbers import Integral, Real
from types import UnionType
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar, get_args, get_origin

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
    if not isinstance(evidence, str) or not evidence.startswith(EVIDENCE_TAGS):
        raise ValueError(f"The evidence is {evidence!r}; begin it with one of {', '.join(EVIDENCE_TAGS)}")
    return Known(value, evidence)  # type: ignore[return-value]


def _is(value, kind):
    """Whether a value is what an annotation says: a class, a frozenset or tuple of one, or one of several."""
    if get_origin(kind) is UnionType:
        return any(_is(value, one) for one in get_args(kind))
    if get_origin(kind) is not None:  # frozenset[X] or tuple[X, ...]
        element = get_args(kind)[0]
        return isinstance(value, get_origin(kind)) and all(_is(each, element) for each in value)
    numbers = {int: Integral, float: Real}
    return isinstance(value, numbers.get(kind, kind)) and (kind is bool or not isinstance(value, bool))


def _words(kind):
    """An annotation in words."""
    if get_origin(kind) is UnionType:
        return " or ".join(map(_words, get_args(kind)))
    if get_origin(kind) is not None:
        return f"{get_origin(kind).__name__} of {_words(get_args(kind)[0])}"
    return kind.__name__


@dataclass(frozen=True, kw_only=True)
class Section:
    """Fields of a profile on one subject. Each is given as ``known(value, evidence)`` and read as the value.

    ``evidence``: how each field is known, by its name.

    Raises ValueError for a field that is given without evidence, TypeError for a value that is not what its
    annotation says.
    """

    evidence: Mapping[str, str] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        evidence = {}
        kinds = {f.name: f.type for f in fields(self)}
        for name in self.names():
            given = getattr(self, name)
            if not isinstance(given, Known):
                raise ValueError(
                    f"{type(self).__name__}.{name} is {given!r}, without evidence; give "
                    "known(value, evidence), or change a whole machine: Profile.changed."
                )
            if not _is(given.value, kinds[name]):
                raise TypeError(
                    f"{type(self).__name__}.{name} is {given.value!r}; its type is {_words(kinds[name])}."
                )
            object.__setattr__(self, name, given.value)
            evidence[name] = given.evidence
        object.__setattr__(self, "evidence", evidence)

    if not TYPE_CHECKING:  # to which any name would be there

        def __getattr__(self, name):
            raise AttributeError(
                f"{type(self).__name__} has no {name}; its fields are {', '.join(self.names())}."
            )

    @classmethod
    def names(cls) -> tuple[str, ...]:
        """The names of the fields that have evidence, in order."""
        return tuple(f.name for f in fields(cls) if f.name != "evidence")
