"""A page's controls for a figure's parameters: sliders, choices and fields, and gestures that move them."""

import math
from collections.abc import Mapping
from typing import Any

from fixedpipe.effects.figures.own_maps import Own
from fixedpipe.effects.figures.parameters import (
    COLOR_KIND,
    DIRECTION_KIND,
    POSITION_KIND,
    Choice,
    Flag,
    Maybe,
    Number,
    Parameter,
    Several,
    Whole,
)

# A value of at most so many numbers has a slider for each; longer values are edited as text.
_MOST_SLIDERS = 4
# The slider of a number without bounds ends at so many times the figure's own value. Chosen.
_REACH = 4.0
# Names of angles that turn the scene about the upright axis, and of those that lean it towards the viewer.
_TURNING = ("turn", "longitude", "azimuth")
_LEANING = ("tilt", "pitch", "elevation", "latitude", "lean")
_EYES = ("eye", "view", "front")


def control(name: str, parameter: Parameter, text: str) -> dict[str, Any]:
    """The data of a parameter for a page: a dict of JSON values.

    ``text``: the value of the parameter if nothing is set, in the form of ``--set``.
    """
    return {
        "name": name,
        "text": text,
        "does": parameter.does,
        "unit": parameter.unit,
        "of": parameter.of,
        "allowed": parameter.kind.allowed,
        **_form(parameter.kind, parameter.default),
        "gesture": gesture(name, parameter.kind),
    }


def is_file(parameter: Parameter) -> bool:
    """Whether the values of a parameter are names of files. No page may choose these."""
    return isinstance(_plain(parameter.kind), Own)


def gesture(name: str, kind: Any) -> str:
    """The gesture in a picture that moves the parameter: "light", "lamp", "light angle", "eye", "orbit",
    "turn", "lean"; empty if none does.
    """
    kind = _plain(kind)
    if kind == DIRECTION_KIND:
        return "light" if name == "light" else "orbit" if name in _EYES else ""
    if kind == POSITION_KIND:
        return "lamp" if name == "light" else "eye" if name in _EYES else ""
    angles = {"light": "light angle"} | dict.fromkeys(_TURNING, "turn") | dict.fromkeys(_LEANING, "lean")
    return angles.get(name, "") if type(kind) is Number else ""


def _plain(kind):
    return kind.kind if isinstance(kind, Maybe) else kind


def _form(kind: Any, default: Any) -> Mapping[str, Any]:
    """How a page edits the value: "form", and the data that this form needs."""
    if isinstance(kind, Maybe | Own):
        return {"form": "text"}
    return next(
        (make(kind, default) for of, make in _FORMS.items() if isinstance(kind, of)), {"form": "text"}
    )


def _several(kind, default):
    parts = kind.parts if isinstance(kind.parts, tuple) else ()
    if not 1 <= len(parts) <= _MOST_SLIDERS or not all(isinstance(part, Number) for part in parts):
        return {"form": "text"}
    colors = ("red", "green", "blue") if kind == COLOR_KIND else None
    axes = ("x", "y", "z") if kind in (DIRECTION_KIND, POSITION_KIND) else None
    names = colors or axes or ("",) * len(parts)
    return {
        "form": "numbers",
        "parts": [
            {"label": label, **_range(part, default, kind == DIRECTION_KIND)}
            for label, part in zip(names, parts, strict=True)
        ],
    }


def _range(kind, values, is_direction=False):
    """A slider's ends and step. The slider covers a part of a wide range; its text field takes all of it."""
    largest = max(abs(float(each)) for each in values) or 1.0
    reach = largest if is_direction else _REACH * largest
    low, high = max(kind.low, -reach), min(kind.high, reach)
    bounds = {"least": _finite(kind.low), "most": _finite(kind.high)}
    if isinstance(kind, Whole):
        step = 2 if kind.even else 1
        return {"low": int(low), "high": int(high), "step": step, "power": kind.power, **bounds}
    return {"low": low, "high": high, "step": 0, "power": False, **bounds}


def _finite(number):
    """The number, or None for an infinity, which JSON does not have."""
    return number if math.isfinite(number) else None


_FORMS = {
    Flag: lambda kind, default: {"form": "flag"},
    Choice: lambda kind, default: {"form": "choice", "choices": list(kind.members)},
    Several: _several,
    Number: lambda kind, default: {"form": "numbers", "parts": [{"label": "", **_range(kind, (default,))}]},
}
