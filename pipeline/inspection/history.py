"""What is known of a pixel: its commands, their fragments, every stage of each, and every number of a stage.

Everything is plain data, in the order of the computation: ``to_json`` writes it as it stands.
"""

from dataclasses import dataclass, fields, is_dataclass
from enum import Enum
from typing import Any

from fixedpipe.pipeline.inspection.pixel import PixelValue


@dataclass(frozen=True)
class Quantity:
    """A number, or the components of a register, at a stage.

    name    what it is, in the words of the specification and of the notations
    values  what it is worth: of a colour 1.0 is full intensity
    codes   the whole numbers that the machine holds; empty where it holds a float
    one     the code of 1.0; None: codes are what they are, an address, a word of the depth buffer
    ideal   what the ideal has here; empty where it has nothing of the kind
    """

    name: str
    values: tuple[float, ...]
    codes: tuple[int, ...] = ()
    one: int | None = None
    ideal: tuple[float, ...] = ()


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
    """

    kind: str
    title: str
    says: str = ""
    read: tuple[Quantity, ...] = ()
    made: tuple[Quantity, ...] = ()
    clamped: tuple[Clamped, ...] = ()
    verdict: bool | None = None


@dataclass(frozen=True)
class Fragment:
    """A fragment: its stages in order, and what became of it, "written" or what ended it."""

    stages: tuple[Stage, ...]
    fate: str


@dataclass(frozen=True)
class Touched:
    """A command that touched the pixel: its number among those that ran, label and type, the sample of the
    pixel, what the pixel held before and after, the fragments that it made there.
    """

    number: int
    label: str
    kind: str
    sample: int
    before: PixelValue
    after: PixelValue
    fragments: tuple[Fragment, ...]
    note: str = ""


@dataclass(frozen=True)
class PixelHistory:
    """Everything that happened to a pixel.

    profile        the machine's name
    width, height  of the framebuffer, pixels
    x, y           the pixel, counted from the top left, y downwards; ``window_y`` counts upwards
    surface        the pbuffer; None: the window
    one            the code of 1.0 in the framebuffer
    commands       how many ran in all
    touched        those that touched the pixel
    final          what the pixel holds in the end, as the framebuffer has it
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

    def _repr_html_(self) -> str:
        """As a notebook shows it."""
        from fixedpipe.pipeline.inspection.page import history_html

        return history_html(self)


def to_json(value: Any) -> Any:
    """A history, or a part of it, as JSON's dictionaries, lists, strings and numbers.

    A number that JSON has no word for, an infinity or no number, becomes a string.
    """
    if is_dataclass(value) and not isinstance(value, type):
        return {field.name: to_json(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, (tuple, list)):
        return [to_json(item) for item in value]
    if isinstance(value, Enum):
        return value.name
    if isinstance(value, float) and not -1.8e308 < value < 1.8e308:
        return repr(value)
    return value
