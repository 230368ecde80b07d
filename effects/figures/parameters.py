"""The parameters of a figure that a user may change, each with its default, unit, range and effect.

A figure's table has a line for each, such as ``"alpha_x": ALPHA_X(0.25)``. The word ALPHA_X stands for a
meaning that many figures share, and takes the figure's own number. A meaning of the figure's own is a
sentence. A word knows the ``Kind`` of the value, which takes, refuses, reads and writes values.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from numbers import Integral, Real
from typing import Any, Protocol

import numpy as np

from fixedpipe.effects.shadows.lit_scene import SceneShading


class Unfit(ValueError):  # noqa: N818 (it says what the value is)
    """A value does not fit a parameter; the message is a sentence with the reason and what to do."""


class Kind(Protocol):
    """What values a parameter may have.

    ``allowed`` says it after "give": "a number from 0 to 1".
    """

    @property
    def allowed(self) -> str:
        """What may be given, in words."""

    def accept(self, value: Any) -> Any:
        """The value in the form that scenes take.

        Raises ValueError for a wrong value, and Unfit if its message has a reason in place of the allowed
        values.
        """

    def parse(self, text: str) -> Any:
        """The value that the text of an option says. Raises likewise."""

    def show(self, value: Any) -> str:
        """The text that ``parse`` reads as this value."""


def _number(value: float) -> str:
    return f"{value:g}" if isinstance(value, float) and float(f"{value:g}") == value else str(value)


def _plain(value: Real) -> int | float:
    """A number of whatever library as Python's own."""
    return int(value) if isinstance(value, Integral) else float(value)


@dataclass(frozen=True)
class Number:
    """A finite number from ``low`` to ``high``; ``above``: more than ``low``."""

    low: float = -math.inf
    high: float = math.inf
    above: bool = False

    @property
    def allowed(self) -> str:
        """What may be given."""
        return f"a number{self._range}"

    @property
    def _range(self) -> str:
        low, high = _number(self.low), _number(self.high)
        if self.above:
            return f" above {low}" if self.high == math.inf else f" above {low}, up to {high}"
        if self.low == -math.inf:
            return "" if self.high == math.inf else f" up to {high}"
        return f" from {low}" if self.high == math.inf else f" from {low} to {high}"

    def accept(self, value: Any) -> Any:
        """A float, or the whole number that was given."""
        if isinstance(value, bool | np.bool_) or not isinstance(value, Real):
            raise ValueError
        number = _plain(value)
        if not math.isfinite(number) or not self.low <= number <= self.high:
            raise ValueError
        if self.above and number == self.low:
            raise ValueError
        return number

    def parse(self, text: str) -> Any:
        """A number in decimals."""
        return self.accept(float(text))

    def show(self, value: Any) -> str:
        """In decimals."""
        return _number(value)


@dataclass(frozen=True)
class Whole(Number):
    """A whole number from ``low`` to ``high``; ``power``: a power of two; ``even``: an even one."""

    power: bool = False
    even: bool = False

    @property
    def allowed(self) -> str:
        """What may be given."""
        what = "a power of two" if self.power else "an even number" if self.even else "a whole number"
        return f"{what}{self._range}"

    def accept(self, value: Any) -> int:
        """An int."""
        if not isinstance(value, Integral):
            raise ValueError
        number = int(super().accept(value))
        if (self.power and number & (number - 1)) or (self.even and number % 2):
            raise ValueError
        return number

    def parse(self, text: str) -> int:
        """A whole number in decimals."""
        return self.accept(int(text))


@dataclass(frozen=True)
class Flag:
    """True or False; on the command line also yes or no, on or off, 1 or 0."""

    @property
    def allowed(self) -> str:
        """What may be given."""
        return "True or False"

    def accept(self, value: Any) -> bool:
        """A bool."""
        if not isinstance(value, bool | np.bool_):
            raise ValueError
        return bool(value)

    def parse(self, text: str) -> bool:
        """One of the words, in any case."""
        words = {"true": True, "yes": True, "on": True, "1": True}
        words |= {"false": False, "no": False, "off": False, "0": False}
        if text.casefold() not in words:
            raise ValueError
        return words[text.casefold()]

    def show(self, value: Any) -> str:
        """True or False."""
        return str(value)


@dataclass(frozen=True)
class Choice:
    """One of ``members``, by name; a member itself is taken as well as its name."""

    members: Mapping[str, Any]

    @property
    def allowed(self) -> str:
        """What may be given."""
        names = list(self.members)
        return f"{', '.join(names[:-1])} or {names[-1]}" if len(names) > 1 else names[0]

    def accept(self, value: Any) -> Any:
        """The member."""
        for member in self.members.values():
            if type(value) is type(member) and value == member:
                return member
        if isinstance(value, str):
            return self.parse(value)
        raise ValueError

    def parse(self, text: str) -> Any:
        """The member of that name, in any case."""
        for name, member in self.members.items():
            if text.casefold() == name.casefold():
                return member
        raise ValueError

    def show(self, value: Any) -> str:
        """The member's name."""
        return next(name for name, member in self.members.items() if value is member or value == member)


def of_enum(*members: Enum) -> Choice:
    """A Choice among an enum's members; ``of_enum(*Kind)``: among all."""
    return Choice({member.name: member for member in members})


# What stands between the parts of a value on the command line, by how many levels of parts are in them.
_SEPARATORS = ",/;"


@dataclass(frozen=True)
class Several:
    """A tuple of values: one of each kind in ``parts``, or ``least`` to ``most`` of the one kind that it is.

    what      their common name: "three numbers from 0 to 1"; empty: the kinds' own words
    not_zero  numbers that are not all zero
    """

    parts: Kind | tuple[Kind, ...]
    least: int = 0
    most: int = 0
    what: str = ""
    not_zero: bool = False

    @property
    def allowed(self) -> str:
        """What may be given."""
        if self.what:
            return self.what
        if not isinstance(self.parts, tuple):
            return f"{self.least} to {self.most} times {self.parts.allowed}"
        if all(part == self.parts[0] for part in self.parts):
            return f"{len(self.parts)} times {self.parts[0].allowed}"
        return "(" + "; ".join(part.allowed for part in self.parts) + ")"

    def _kinds(self, count: int) -> Sequence[Kind]:
        if isinstance(self.parts, tuple):
            kinds, least, most = self.parts, len(self.parts), len(self.parts)
        else:
            kinds, least, most = (self.parts,) * count, self.least, self.most
        if not least <= count <= most:
            raise ValueError
        return kinds

    def accept(self, value: Any) -> tuple[Any, ...]:
        """A tuple; a list or an array of the same length is accepted too."""
        if not isinstance(value, tuple | list | np.ndarray) or not np.iterable(value):
            raise ValueError
        found = tuple(k.accept(v) for k, v in zip(self._kinds(len(value)), value, strict=True))
        if self.not_zero and not any(found):
            raise ValueError
        return found

    @property
    def depth(self) -> int:
        """How many levels of parts its parts have."""
        kinds = self.parts if isinstance(self.parts, tuple) else (self.parts,)
        return max(1 + kind.depth if isinstance(kind, Several) else 0 for kind in kinds)

    def parse(self, text: str) -> tuple[Any, ...]:
        """Parts between commas; parts with parts of their own between slashes, then semicolons."""
        texts = [part.strip() for part in text.split(_SEPARATORS[self.depth])]
        found = tuple(k.parse(t) for k, t in zip(self._kinds(len(texts)), texts, strict=True))
        return self.accept(found)

    def show(self, value: Any) -> str:
        """Parts between commas, slashes, semicolons."""
        kinds = self._kinds(len(value))
        return _SEPARATORS[self.depth].join(k.show(v) for k, v in zip(kinds, value, strict=True))


@dataclass(frozen=True)
class Maybe:
    """A value of ``kind``, or None, which means what ``none`` says."""

    kind: Kind
    none: str

    @property
    def allowed(self) -> str:
        """What may be given."""
        return f"{self.kind.allowed}, or None: {self.none}"

    def accept(self, value: Any) -> Any:
        """None, or as the kind does."""
        return None if value is None else self.kind.accept(value)

    def parse(self, text: str) -> Any:
        """None, in any case, or as the kind does."""
        return None if text.casefold() == "none" else self.kind.parse(text)

    def show(self, value: Any) -> str:
        """None, or as the kind does."""
        return "None" if value is None else self.kind.show(value)


@dataclass(frozen=True)
class Internal:
    """Anything: what checks alone change, with the reason why no user is offered it."""

    @property
    def allowed(self) -> str:
        """What may be given."""
        return "nothing: checks alone change it"

    def accept(self, value: Any) -> Any:
        """As it is."""
        return value

    def parse(self, text: str) -> Any:
        """Nothing: it cannot be set."""
        raise ValueError

    def show(self, value: Any) -> str:
        """As Python writes it."""
        return repr(value)


def _nothing(value: Any) -> Mapping[str, Any]:
    return {}


@dataclass(frozen=True, eq=False)
class Parameter:
    """What may be changed of a figure.

    default  the figure's own value
    kind     which values there may be
    does     what it does, a sentence
    unit     of the numbers; "" where they have none
    brings   value -> values for other parameters that are not given, by name
    of       the parameter without which this one takes no part; "" where there is none
    """

    default: Any
    kind: Kind
    does: str
    unit: str = ""
    brings: Callable[[Any], Mapping[str, Any]] = _nothing
    of: str = ""

    @property
    def offered(self) -> bool:
        """Whether users may set it; else checks alone do."""
        return not isinstance(self.kind, Internal)

    def accept(self, value: Any, what: str) -> Any:
        """The value as scenes take it.

        Raises ValueError, a sentence that begins with its name ``what``, and says what was given and what is
        possible.
        """
        return self._or_refuse(self.kind.accept, value, what)

    def parse(self, text: str, what: str) -> Any:
        """The value that an option's text says. Raises ValueError likewise."""
        return self._or_refuse(self.kind.parse, text, what, text=True)

    def _or_refuse(self, read: Callable[[Any], Any], value: Any, what: str, text: bool = False) -> Any:
        try:
            return read(value)
        except Unfit as error:
            raise ValueError(f"{what}: {error}") from error
        except (ValueError, OverflowError):
            example = self.kind.show(self.default) if text else repr(self.default)
            example = f", as {example}" if len(example) <= _LONGEST else ""
            raise ValueError(f"{what} is {_shown(value)}; give {self.kind.allowed}{example}.") from None


# Of a value's text in a sentence.
_LONGEST = 80


def _shown(value: Any) -> str:
    """A value as an error shows it: arrays by their shape and type, long texts cut."""
    if isinstance(value, np.ndarray) and value.size > 4:
        return f"an array of shape {value.shape}, {value.dtype}"
    text = repr(value)
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 1]}\N{HORIZONTAL ELLIPSIS}"


@dataclass(frozen=True)
class Word:
    """Makes Parameters of one kind, so that a meaning that many figures share is described once."""

    kind: Kind
    does: str = ""
    unit: str = ""
    of: str = ""

    def __call__(
        self,
        default: Any,
        does: str = "",
        unit: str = "",
        *,
        low: float | None = None,
        high: float | None = None,
    ) -> Parameter:
        """A Parameter with the figure's ``default``; sentence, unit and range where they are its own."""
        bounds = {name: v for name, v in (("low", low), ("high", high)) if v is not None}
        kind = replace(self.kind, **bounds) if bounds else self.kind  # type: ignore[type-var]
        return Parameter(default, kind, does or self.does, unit or self.unit, of=self.of)


def of(kind: Kind, default: Any, does: str, unit: str = "") -> Parameter:
    """A Parameter of a kind that is the figure's own."""
    return Parameter(default, kind, does, unit)


def internal(default: Any, reason: str) -> Parameter:
    """A Parameter that checks alone change; ``reason``: why no user is offered it."""
    return Parameter(default, Internal(), reason)


FULL = "1 = full"
SHARE_KIND = Number(0.0, 1.0)
COLOR_KIND = Several((SHARE_KIND,) * 3, what="three numbers from 0 to 1, red, green, blue")
_COORDINATE = Number(-1000.0, 1000.0)
POSITION_KIND = Several((_COORDINATE,) * 3, what="three numbers from -1000 to 1000")
DIRECTION_KIND = Several(
    (_COORDINATE,) * 3, what="three numbers from -1000 to 1000, not all zero", not_zero=True
)
ALPHA_KIND = Number(0.05, 1.0)
RANGE_KIND = Several((SHARE_KIND,) * 2, what="two numbers from 0 to 1, the least and the greatest")

# Source: OpenGL's lighting (GL_SHININESS) ends at 128, and material textures store N / 128.
EXPONENT_KIND = Number(1.0, 128.0)

# Kinds of numbers, whose sentence is each figure's own.
FLAG = Word(Flag())
SHARE = Word(SHARE_KIND)
COLOR = Word(COLOR_KIND, unit=FULL)
POSITION = Word(POSITION_KIND, unit="world coordinates")
DEGREES = Word(Number(-360.0, 360.0), unit="degrees")
COUNT = Word(Whole(1, 64))
EVEN = Word(Whole(2, 64, even=True))
SEED = Word(Whole(0, 2**31 - 1))
NUMBER = Word(Number())
SLOPE = Word(Number(0.0, 8.0))

# What means the same in many figures.
LIGHT = Word(
    DIRECTION_KIND,
    "The direction towards the light, of any length: x to the right, y up, z towards the viewer.",
)
DIFFUSE = Word(COLOR_KIND, "The colour of the light that the surface scatters evenly.", FULL)
AMBIENT = Word(COLOR_KIND, "The colour that the surface has without the light.", FULL)
SPECULAR = Word(COLOR_KIND, "The colour of the highlights.", FULL)
BACKDROP = Word(COLOR_KIND, "The colour of the panels where nothing is drawn.", FULL)
ALPHA_X = Word(
    ALPHA_KIND,
    "The highlight's width along the tangents: the smaller, the narrower. Two textures and register "
    "combiners hold 0.25 and more; less is drawn as 0.25 there.",
)
ALPHA_Y = Word(
    ALPHA_KIND,
    "The highlight's width along the binormals: the smaller, the narrower. Two textures and register "
    "combiners hold 0.25 and more; less is drawn as 0.25 there.",
)
K_S = Word(RANGE_KIND, "The strength of the highlights, from the dullest stroke to the brightest.", FULL)
SPREAD = Word(Number(0.0, 45.0), "The strokes' directions vary by so much to either side.", "degrees")
TEXELS = Word(Whole(4, 1024, power=True), "The edge of the material's textures.", "texels")
STROKE_DEPTH = Word(Number(0.0, 2.0), "The largest slope across the strokes.")
REPEATS = Word(
    Several((Whole(1, 16),) * 2, what="two whole numbers from 1 to 16"),
    "How often the texture comes around the sphere, and from pole to pole.",
)
LEAN = Word(Number(-180.0, 180.0), "How far the sphere's axis leans to the left.", "degrees")
SLICES = Word(Whole(3, 256), "Segments of the sphere around its axis.")
STACKS = Word(Whole(2, 128), "Segments of the sphere from pole to pole.")
RADIUS = Word(Number(0.1, 1.0), "The radius of the sphere.", "half edges of a panel")
EXTENT = Word(Number(0.1, 1.0), "The half edge of the square.", "half edges of a panel")
RATIO = Word(Number(0.125, 8.0), "Texels of the shadow map for each of the panel's pixels, along an edge.")
FACTOR = Word(Number(0.0, 64.0), "The factor of the polygon offset, which multiplies the depth's slope.")
UNITS = Word(Number(0.0, 65536.0), "The units of the polygon offset, steps of the depth buffer.")
OFFSET_KIND = Several(
    (Number(0.0, 64.0), Number(0.0, 65536.0)), what="a factor and units, two numbers from 0"
)
RELIEF = Word(Number(0.0, 8.0), "How high the bumps stand: 0 is a flat surface.")
FITTED_TEXELS = Word(Maybe(Whole(4, 1024, power=True), "as large as fits the panel"), unit="texels")
SHADING = Word(
    of_enum(*SceneShading),
    "Whether the scene is shown lit, or white where the light reaches it and black elsewhere.",
)
