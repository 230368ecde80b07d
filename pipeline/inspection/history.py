"""The history of a pixel: its commands, their fragments, the stages of each, and every number of a stage.

Everything is plain data, in the order of the computation. ``to_json`` writes it unchanged.
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

    name    its name in the specification and in the notations
    values  its values; for a colour, 1.0 is full intensity
    codes   the machine's whole numbers; empty if the machine holds a float
    one     the code of 1.0; None: a code has no scale, as an address or a word of the depth buffer
    ideal   the ideal's values; empty if the ideal has no such number
    error   its error and the error's causes; None: they are not known
    """

    name: str
    values: tuple[float, ...]
    codes: tuple[int, ...] = ()
    one: int | None = None
    ideal: tuple[float, ...] = ()
    error: "Error | None" = None


@dataclass(frozen=True)
class Error:
    """Machine minus ideal of each component, in units of 1/255, and the parts that it is the sum of.

    total    machine - ideal
    brought  the result of exact arithmetic without a clamp on the machine's inputs, minus ideal: errors of
             earlier stages, and of a texture's coordinates
    added    this stage's own error, by cause: "mapping", the machine's constants, such as EXPAND_NORMAL's
             128/255 for 1/2; "coordinates", those that a texture shader stage makes; "texels", the machine's
             in place of the ideal's, and a depth comparison's reference; "filter fraction"; "rounding" to the
             machine's numbers, also of weights; "clamp"
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

    kind     one of a few words that tell stages apart: "combiner", "texture", "blending" ...
    title    its name: "general combiner 0, RGB portion"
    says     the stage's computation, as an equation or a sentence; may be empty
    read     its inputs
    made     its results
    clamped  the components that its clamps changed
    verdict  whether the fragment passed a test; None: the stage is no test
    number   the number of the texture unit or general combiner
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
    """A fragment: its stages in order, and its fate: "written", or what discarded it.

    ``worst``: the place of the stage that adds most to the error. ``first_clamped``: the place of the first
    stage whose clamp changed a value. None: there is no such stage.
    """

    stages: tuple[Stage, ...]
    fate: str
    worst: int | None = None
    first_clamped: int | None = None


@dataclass(frozen=True)
class Touched:
    """A command that touched the pixel, and the fragments that it made there.

    number, label, kind  its number among those that ran, its label and its type
    sample               the sample of the pixel
    before, after        what the pixel held before and after
    fragments            the fragments, in order
    ideal                the ideal's colour after the command; empty without an ideal
    surface              the pbuffer that it drew to; None: the window. It may be another framebuffer that
                         shares its depths with the history's; then the colours are the other's
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
        """A heading for the command, in the history of a pixel of ``surface``."""
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
    commands       how many commands ran in all
    touched        those that touched the pixel
    final          what the pixel holds in the end, as in the framebuffer
    ideal          the guided ideal's colour there; empty without an ideal
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
        """The pixel and its final value, because all fields are thousands of characters."""
        surface = f" of pbuffer {self.surface}" if self.surface is not None else ""
        return (
            f"<history of pixel ({self.x}, {self.y}){surface} on {self.profile}: {len(self.touched)} of "
            f"{self.commands} commands touched it, color {self.final.color} in the end>"
        )

    def _repr_html_(self) -> str:
        """The history as a notebook shows it."""
        return history_html(self)


def to_json(value: Any) -> Any:
    """A history, or a part of it, as JSON's dictionaries, lists, strings and numbers.

    JSON has no infinity and no NaN, so such a number becomes a string.
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
    """The JSON Schema (draft 2020-12) of ``to_json``'s result for a PixelHistory:
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


# An infinity or a NaN is a string.
_NUMBER = {"anyOf": [{"type": "number"}, {"enum": ["inf", "-inf", "nan"]}]}
_PLAIN: dict[Any, dict[str, Any]] = {
    str: {"type": "string"},
    int: {"type": "integer"},
    bool: {"type": "boolean"},
    float: _NUMBER,
    type(None): {"type": "null"},
}


def _described(kind: Any, described: dict[str, Any]) -> dict[str, Any]:
    """The schema of a type's values. Schemas of dataclasses go into ``described``, by name."""
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
        described[kind.__name__] = {}  # a type that holds its own kind finds this entry
        types = get_type_hints(kind)
        described[kind.__name__] = {
            "type": "object",
            "description": (kind.__doc__ or "").split("\n")[0],
            "properties": {field.name: _described(types[field.name], described) for field in fields(kind)},
            "required": [field.name for field in fields(kind)],
            "additionalProperties": False,
        }
    return {"$ref": f"#/$defs/{kind.__name__}"}
