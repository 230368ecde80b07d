"""What is known of a pixel: its commands, their fragments, every stage of each, and every number of a stage.

Everything is plain data, in the order of the computation: ``to_json`` writes it as it stands.
"""

import math
from dataclasses import dataclass, fields, is_dataclass
from types import UnionType
from typing import Any, Union, get_args, get_origin, get_type_hints

from fixedpipe.pipeline.inspection.page import history_html
from fixedpipe.pipeline.inspection.pixel import PixelValue
from fixedpipe.pipeline.messages import surface_words


@dataclass(frozen=True)
class Quantity:
    """A number, or the components of a register, at a stage.

    name    what it is, in the words of the specification and of the notations
    values  what it is worth: of a colour 1.0 is full intensity
    codes   the whole numbers that the machine holds; empty where it holds a float
    one     the code of 1.0; None: codes are what they are, an address, a word of the depth buffer
    ideal   what the ideal has here; empty where it has nothing of the kind
    error   where it departs from the ideal, and since when; None where that is not known
    """

    name: str
    values: tuple[float, ...]
    codes: tuple[int, ...] = ()
    one: int | None = None
    ideal: tuple[float, ...] = ()
    error: "Error | None" = None


@dataclass(frozen=True)
class Error:
    """Machine minus ideal of each component, in units of 1/255, and what it is the sum of.

    total    machine - ideal
    brought  what exact arithmetic, without a clamp, makes of the machine's inputs, minus ideal: errors of
             earlier stages, and of a texture's coordinates
    added    what this stage adds, by cause: "mapping", the machine's constants, EXPAND_NORMAL's 128/255 for
             1/2; "coordinates", those that a texture shader stage makes; "texels", the machine's for those
             that the ideal reads, and a depth comparison's reference; "filter fraction"; "rounding", to the
             machine's numbers, of weights as well; "clamp"
    """

    total: tuple[float, ...]
    brought: tuple[float, ...]
    added: dict[str, tuple[float, ...]]


@dataclass(frozen=True)
class Clamped:
    """A component that a clamp changed: ``register`` and component, the value before it and after it."""

    name: str
    before: float
    after: float


@dataclass(frozen=True)
class Stage:
    """A stage of a fragment.

    kind     one of a few words, by which stages are told apart: "combiner", "texture", "blending" ...
    title    its name: "general combiner 0, RGB portion"
    says     what it computes, as an equation or a sentence; may be empty
    read     what it read
    made     what it made
    clamped  what its clamps changed
    verdict  of a test: whether the fragment passed; None: it is no test
    number   of the texture unit or general combiner
    """

    kind: str
    title: str
    says: str = ""
    read: tuple[Quantity, ...] = ()
    made: tuple[Quantity, ...] = ()
    clamped: tuple[Clamped, ...] = ()
    verdict: bool | None = None
    number: int | None = None


@dataclass(frozen=True)
class Fragment:
    """A fragment: its stages in order, and what became of it, "written" or what ended it.

    ``worst``: the place among the stages of the one that adds most to the error; ``first_clamped``: of the
    first whose clamp changed something. None: there is none.
    """

    stages: tuple[Stage, ...]
    fate: str
    worst: int | None = None
    first_clamped: int | None = None


@dataclass(frozen=True)
class Touched:
    """A command that touched the pixel: its number among those that ran, label and type, the sample of the
    pixel, what the pixel held before and after, the fragments that it made there, the ideal's colour after.

    surface  the pbuffer that it drew to; None: the window. It may be another than the history's, which has
             its depths in common; then the colours are that one's
    """

    number: int
    label: str
    kind: str
    sample: int
    before: PixelValue
    after: PixelValue
    fragments: tuple[Fragment, ...]
    ideal: tuple[float, ...] = ()
    surface: str | None = None

    def heading(self, surface: str | None) -> str:
        """What it is, in words, in the history of a pixel of ``surface``."""
        sample = f", sample {self.sample}" if self.sample else ""
        elsewhere = "" if self.surface == surface else f" to {surface_words(self.surface)}"
        return f"command {self.number}, {self.kind}{elsewhere}{sample}: {self.label}"


@dataclass(frozen=True, repr=False)
class PixelHistory:
    """Everything that happened to a pixel. A notebook shows it as a page.

    profile        the machine's name
    width, height  of the framebuffer, pixels
    x, y           the pixel, counted from the top left, y downwards; ``window_y`` counts upwards
    surface        the pbuffer; None: the window
    one            the code of 1.0 in the framebuffer
    commands       how many ran in all
    touched        those that touched the pixel
    final          what the pixel holds in the end, as the framebuffer has it
    ideal          the colour that the guided ideal has there; empty where there is no ideal
    """

    profile: str
    width: int
    height: int
    x: int
    y: int
    window_y: int
    surface: str | None
    one: int
    commands: int
    touched: tuple[Touched, ...]
    final: PixelValue
    ideal: tuple[float, ...] = ()

    def __repr__(self) -> str:
        """Which pixel, and what it holds: all fields are thousands of characters."""
        surface = f" of pbuffer {self.surface}" if self.surface is not None else ""
        return (
            f"<history of pixel ({self.x}, {self.y}){surface} on {self.profile}: {len(self.touched)} of "
            f"{self.commands} commands touched it, color {self.final.color} in the end>"
        )

    def _repr_html_(self) -> str:
        """As a notebook shows it."""
        return history_html(self)


def to_json(value: Any) -> Any:
    """A history, or a part of it, as JSON's dictionaries, lists, strings and numbers.

    A number that JSON has no word for, an infinity or no number, becomes a string.
    """
    for kind, written in _WRITTEN:
        if isinstance(value, kind):
            return written(value)
    if is_dataclass(value):
        return {field.name: to_json(getattr(value, field.name)) for field in fields(value)}
    return value


_WRITTEN = (
    (dict, lambda value: {name: to_json(item) for name, item in value.items()}),
    ((tuple, list), lambda value: [to_json(item) for item in value]),
    (float, lambda value: value if math.isfinite(value) else repr(value)),
)


def json_schema() -> dict[str, Any]:
    """The JSON Schema (draft 2020-12) of what ``to_json`` makes of a PixelHistory:
    docs/pixel-history.schema.json.
    """
    described: dict[str, Any] = {}
    top = _described(PixelHistory, described)
    title = "A pixel's history: fixedpipe inspect --json"
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": title,
        **top,
        "$defs": described,
    }


# A number that JSON has no word for is a string.
_NUMBER = {"anyOf": [{"type": "number"}, {"enum": ["inf", "-inf", "nan"]}]}
_PLAIN: dict[Any, dict[str, Any]] = {
    str: {"type": "string"},
    int: {"type": "integer"},
    bool: {"type": "boolean"},
    float: _NUMBER,
    type(None): {"type": "null"},
}


def _described(kind: Any, described: dict[str, Any]) -> dict[str, Any]:
    """The schema of a type's values; those of dataclasses are put into ``described``, by name."""
    if kind in _PLAIN:
        return _PLAIN[kind]
    if get_origin(kind) in (UnionType, Union):
        return {"anyOf": [_described(one, described) for one in get_args(kind)]}
    if get_origin(kind) is tuple:
        of, *more = get_args(kind)
        length = {} if more == [...] else {"minItems": 1 + len(more), "maxItems": 1 + len(more)}
        return {"type": "array", "items": _described(of, described), **length}
    if get_origin(kind) is dict:
        return {"type": "object", "additionalProperties": _described(get_args(kind)[1], described)}
    if kind.__name__ not in described:
        described[kind.__name__] = {}  # one that holds its own kind would look for it here
        types = get_type_hints(kind)
        described[kind.__name__] = {
            "type": "object",
            "description": (kind.__doc__ or "").split("\n")[0],
            "properties": {field.name: _described(types[field.name], described) for field in fields(kind)},
            "required": [field.name for field in fields(kind)],
            "additionalProperties": False,
        }
    return {"$ref": f"#/$defs/{kind.__name__}"}
