"""The axes of a grid, read from texts such as ``alpha_x=0.1:1.0:19`` and ``bits=4:16``."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from fixedpipe.effects.acceptance.precision import WIDTHS
from fixedpipe.effects.figures.parameters import Kind, Number, Several, Whole
from fixedpipe.effects.presentation.variation import along, movable
from fixedpipe.effects.refusal import Refusal, refusals

# The axis of the width of every number, beside a figure's parameters.
BITS = "bits"
# Assumed: a manifest of them has 5 GB, and their rows are one file that a laptop still reads.
MOST_POINTS = 10_000_000
_FORM = "give NAME=FROM:TO:N, NAME=A,B,C or bits=4:16"
_WIDTH = Whole(min(WIDTHS), max(WIDTHS))


@dataclass(frozen=True)
class Axis:
    """What one column of a grid's rows passes through.

    name    the column's: a parameter's, "bits" or "machine"
    values  numbers, or texts
    texts   the same as --set takes them
    """

    name: str
    values: tuple[Any, ...]
    texts: tuple[str, ...]


def named(varied: Sequence[str]) -> dict[str, str]:
    """The texts of --vary by name. Raises Refusal for one that has no name or no values, and for a name that
    is given twice.
    """
    found: dict[str, str] = {}
    for given in varied:
        name, equals, text = (part.strip() for part in given.partition("="))
        if not (name and equals and text):
            raise Refusal(f"--vary is {given!r}; {_FORM}.")
        if name in found:
            raise Refusal(f"--vary names {name} twice; give it once.")
        found[name] = text
    return found


def axis(name: str, text: str, kind: Kind, what: str) -> Axis:
    """The Axis of a text's values.

    name  of the column
    text  FROM:TO:N, evenly from one to the other; FROM:TO of whole numbers, each of them; A,B,C; of values
          with commas A:B:C, or A:B:N along the arc or the line between them
    kind  the type of the values: a ``Kind`` of figures' parameters
    what  the values are called in a Refusal

    Raises Refusal for a text of another form, a value that is none, and values that are not all different.
    """
    with refusals():
        values = _values(text, kind, what)
        texts = tuple(kind.show(value) for value in values)
    if len(set(texts)) < len(texts):
        raise Refusal(
            f"{what} is to be {text}, which has {len(texts)} values and only {len(set(texts))} that differ; "
            "give fewer."
        )
    plain = isinstance(kind, Number)
    return Axis(name, tuple(values) if plain else texts, texts)


def bits_axis(text: str) -> Axis:
    """The Axis of the width of every number: FROM:TO, each from 4 to 16, or A,B,C."""
    return axis(BITS, text, _WIDTH, "The width of every number")


def _values(text, kind, what):
    parse = _parser(kind, what)
    if not movable(kind):
        return [parse(part) for part in text.split(",")]
    parts = [part.strip() for part in text.split(":")]
    steps = parts.pop() if len(parts) > 2 and "," not in parts[-1] else None
    if isinstance(kind, Several):
        values = [parse(part) for part in parts]
    elif len(parts) == 1:
        return [parse(part) for part in text.split(",")]
    else:
        values = [parse(part) for part in parts]
        if len(values) != 2:
            raise Refusal(f"{what} is to be {text!r}; {_FORM}.")
        if steps is None:
            return _each(kind, *values, what, text)
    if steps is None:
        return values
    if not (steps.isdecimal() and 2 <= int(steps) <= MOST_POINTS):
        raise Refusal(f"{what} has {steps!r} steps; give a whole number from 2 to {MOST_POINTS:,}.")
    found = along(kind, values, int(steps))
    # 0.3 rather than 0.30000000000000004: who asks for ten steps means the decimals.
    return [float(f"{v:.12g}") if isinstance(v, float) else v for v in found]


def _parser(kind, what):
    def parse(text):
        try:
            return kind.parse(text.strip())
        except (ValueError, OverflowError) as error:
            raise Refusal(f"{what} is {text.strip()[:80]!r}; give {kind.allowed}.") from error

    return parse


def _each(kind, first, last, what, text):
    """Every whole number of a kind from the first to the last."""
    if not isinstance(kind, Whole):
        raise Refusal(f"{what} is to be {text}, and nothing says in how many steps; give {text}:N.")
    low, high = min(first, last), max(first, last)
    if (high - low) // (2 if kind.even else 1) >= MOST_POINTS and not kind.power:
        raise Refusal(f"{what} is to be {text}, more than {MOST_POINTS:,} numbers; give {text}:N.")
    if kind.power:
        found = [2**n for n in range(low.bit_length() - 1, high.bit_length())]
    else:
        found = list(range(low, high + 1, 2 if kind.even else 1))
    return found if first <= last else found[::-1]


def kind_of_texts(text: str) -> Kind:
    """The kind of a script's values, which have no declaration: whole numbers, numbers, or else words."""
    numbers = [part for part in text.replace(",", ":").split(":") if part.strip()]
    for read, kind in ((int, Whole()), (float, Number())):
        try:
            for number in numbers:
                read(number)
        except ValueError:
            continue
        return kind if ":" not in text or read is float or len(numbers) == 2 else _spaced(numbers)
    return Words()


def _spaced(numbers):
    """Of whole numbers FROM:TO:N: whole where the steps between them are."""
    first, last, steps = (int(number) for number in numbers[:3])
    even = steps > 1 and (last - first) % (steps - 1) == 0
    return Whole() if even else Number()


@dataclass(frozen=True)
class Words:
    """Any text."""

    allowed: str = "a word"

    def accept(self, value: Any) -> str:
        """The text."""
        return str(value)

    def parse(self, text: str) -> str:
        """The text."""
        return text

    def show(self, value: Any) -> str:
        """The text."""
        return str(value)


def points(axes: Sequence[Axis]) -> int:
    """How many points a grid has. Raises Refusal for more than MOST_POINTS."""
    number = math.prod(len(one.values) for one in axes)
    if number > MOST_POINTS:
        raise Refusal(
            f"The grid has {number:,} points; give fewer values of {' or '.join(one.name for one in axes)}: "
            f"{MOST_POINTS:,} points at most."
        )
    return number


def at(axes: Sequence[Axis], place: Sequence[int]) -> tuple[Mapping[str, Any], Mapping[str, str]]:
    """The values of a point's columns, and the same as texts, by the axes' names."""
    chosen = list(zip(axes, place, strict=True))
    return {a.name: a.values[n] for a, n in chosen}, {a.name: a.texts[n] for a, n in chosen}
