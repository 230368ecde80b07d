"""A history's words and numbers, the same in a terminal and on a page."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:  # For annotations alone: a history's page is made of these words.
    from fixedpipe.pipeline.inspection.history import Fragment, PixelHistory, Quantity
    from fixedpipe.pipeline.inspection.pixel import PixelValue

HEADINGS = "", "code", "value", "ideal", "error, 1/255"


def held(value: PixelValue) -> str:
    """What a pixel holds, in words."""
    color = " ".join(str(code) for code in value.color)
    return f"color {color}, depth {value.depth}, stencil {value.stencil}"


def meant(history: PixelHistory) -> str:
    """The guided ideal's colour in the end, in words and in the framebuffer's codes; "" without an ideal."""
    color = " ".join(f"{history.one * value:.2f}" for value in history.ideal)
    return f"The guided ideal's color in the end, not rounded: {color}" if color else ""


def marks_of(fragment: Fragment, place: int) -> str:
    """The marks beside a stage's title: that it adds most to the error, or clamps first."""
    marks = ["adds most to the error"] * (place == fragment.worst)
    marks += ["the first clamp"] * (place == fragment.first_clamped)
    return ", ".join(marks)


def causes(quantity: Quantity) -> list[tuple[str, str]]:
    """The parts of a quantity's error as text: each cause that contributes, and how much."""
    if quantity.error is None or not any(quantity.error.total):
        return []
    named = [("brought", quantity.error.brought)]
    named += [(f"added by {cause}", numbers) for cause, numbers in quantity.error.added.items()]
    return [(cause, _errors(numbers)) for cause, numbers in named if any(abs(n) >= 0.005 for n in numbers)]


def _errors(numbers):
    return " ".join(f"{number:+.2f}" for number in numbers)


def cells(quantity: Quantity) -> tuple[str, str, str, str]:
    """A quantity's codes, values, ideal values and errors as text. A value that equals its code
    appears once.
    """
    codes = " ".join(str(code) for code in quantity.codes)
    plain = quantity.codes and quantity.one is None
    values = "" if plain else " ".join(_number(value) for value in quantity.values)
    ideal, error = " ".join(_number(value) for value in quantity.ideal), ""
    if quantity.codes and quantity.ideal:
        error = _errors([255.0 * (v - i) for v, i in zip(quantity.values, quantity.ideal, strict=True)])
    return codes, values, ideal, error


def _number(value: float) -> str:
    return f"{value:.5g}"
