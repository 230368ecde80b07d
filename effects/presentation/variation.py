"""How a parameter changes from frame to frame of an animation. Its values consist of numbers."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from types import MappingProxyType
from typing import Any

import numpy as np

from fixedpipe.effects.acceptance.precision import WIDTHS, at_width
from fixedpipe.effects.figures.parameters import Maybe, Number, Several, Whole
from fixedpipe.effects.geometry.vectors import cross, dot, of_40_bits
from fixedpipe.effects.refusal import Refusal

# How many frames there are where nothing says it, and at most.
USUAL, MOST = 24, 1000


@dataclass(frozen=True)
class Track:
    """How one thing changes: ``values`` that it passes through, evenly in time, the first and the last
    among them.
    """

    values: tuple[Any, ...]


@dataclass(frozen=True)
class Frame:
    """A frame: ``changes``, values of parameters by name; ``bits`` of every number, None: the machine's own;
    ``said``: both, described in words.
    """

    changes: Mapping[str, Any]
    bits: int | None
    said: str


def _of_numbers(kind):
    """The kind without the None that it may be."""
    return kind.kind if isinstance(kind, Maybe) else kind


def movable(kind):
    """Whether there are values between two of that kind: whether numbers make it up."""
    kind = _of_numbers(kind)
    parts = getattr(kind, "parts", ())
    if isinstance(kind, Several):
        return all(movable(part) for part in (parts if isinstance(parts, tuple) else (parts,)))
    return isinstance(kind, Number)


def _arc(first, last, share):
    """The direction so far along the arc from the first to the last, its length between theirs."""
    lengths = [math.sqrt(dot(v, v)) for v in (first, last)]
    a, b = (np.asarray(v, float) / length for v, length in zip((first, last), lengths, strict=True))
    across = cross(a, b)
    angle = of_40_bits(math.atan2(math.sqrt(dot(across, across)), float(dot(a, b))))
    if angle > math.pi - 1e-6:
        raise Refusal(
            "There is no one arc between opposite directions; give a third between them, as "
            "light=1,0,1:0,1,1:-1,0,1."
        )
    if angle < 1e-9:
        way = a
    else:
        before, after, whole = (of_40_bits(math.sin(s * angle)) for s in (1.0 - share, share, 1.0))
        way = (before * a + after * b) / whole
    return tuple((way * (lengths[0] + share * (lengths[1] - lengths[0]))).tolist())


def _between_parts(kind, first, last, share):
    if kind.not_zero:
        return _arc(first, last, share)
    kinds = kind.parts if isinstance(kind.parts, tuple) else (kind.parts,) * len(first)
    return tuple(_between(k, a, b, share) for k, a, b in zip(kinds, first, last, strict=True))


def _between_whole(kind, first, last, share):
    if kind.power:
        return 2 ** _between_whole(Whole(), math.log2(first), math.log2(last), share)
    unit = 2 if kind.even else 1
    return unit * round((first + share * (last - first)) / unit)


def _between_numbers(kind, first, last, share):
    return first + share * (last - first)


_BETWEEN = {Several: _between_parts, Whole: _between_whole, Number: _between_numbers}


def _between(kind, first, last, share):
    """A value of a kind, so far from the first to the last: 0 to 1."""
    kind = _of_numbers(kind)
    if first == last or share in (0.0, 1.0):
        return last if share == 1.0 else first
    return _BETWEEN[type(kind)](kind, first, last, share)


def along(kind, values, count):
    """``count`` values of a kind that pass through ``values``: directions along arcs, numbers evenly, whole
    numbers rounded to those that there are.

    Raises Refusal between opposite directions.
    """
    found = []
    for n in range(count):
        place = n * (len(values) - 1) / (count - 1)
        begin = min(int(place), len(values) - 2)
        found.append(_between(kind, values[begin], values[begin + 1], place - begin))
    return tuple(found)


def _own_count(kind, values):
    """How many frames a track has by itself: of whole numbers one each, where it passes through few."""
    kind = _of_numbers(kind)
    if not isinstance(kind, Whole):
        return USUAL
    if kind.power:
        values = [math.log2(value) for value in values]
    steps = int(sum(abs(b - a) for a, b in pairwise(values))) // (2 if kind.even else 1)
    return min(steps + 1, USUAL) if steps else USUAL


def moving(figure, name, method):
    """The parameter of this name; it must have values between any two others.

    Raises ValueError as ``Figure.offer`` does, and for a parameter of another kind.
    """
    parameter = figure.offer(name, method)
    if not movable(parameter.kind):
        raise Refusal(
            f"{figure.id}'s {name} has no values between two others: it is {parameter.kind.allowed}."
        )
    return parameter


def frames_of(figure, method, tracks, bits=None, count=None):
    """The frames of an animation.

    Parameters
    ----------
    figure : fixedpipe.effects.figures.Figure
    method : fixedpipe.effects.figures.Method
        How it is drawn.
    tracks : dict
        A Track each, by a parameter's name.
    bits : tuple of int, optional
        The first and the last width of every number, 4 to 16.
    count : int, optional
        How many frames; None: one for each width of ``bits`` or each whole number, otherwise 24.

    Returns
    -------
    tuple of Frame

    Raises Refusal for an unknown parameter, one that cannot be interpolated, an invalid value, a single
    value, and for widths and counts out of range.
    """
    kinds, taken = {}, {}
    for name, track in tracks.items():
        parameter, what = moving(figure, name, method), f"{figure.id}'s {name}"
        kinds[name] = parameter.kind
        taken[name] = tuple(parameter.accept(value, what) for value in track.values)
        if len(taken[name]) < 2 or None in taken[name] or len(set(map(_form, taken[name]))) > 1:
            said = " and ".join(map(_said, taken[name]))
            raise Refusal(f"{what} is to pass through {said}; give two values or more, of as many numbers.")
    if bits is not None and not all(min(WIDTHS) <= width <= max(WIDTHS) for width in bits):
        raise Refusal(f"The bits are {bits[0]} to {bits[1]}; give {min(WIDTHS)} to {max(WIDTHS)}.")
    if not taken and bits is None:
        raise Refusal(f"Nothing of {figure.id} is to move; say what, as in --precision 4:16.")
    if count is None:
        counts = [_own_count(kinds[name], values) for name, values in taken.items()]
        count = max(counts + ([] if bits is None else [abs(bits[1] - bits[0]) + 1]))
    if not 2 <= count <= MOST:
        raise Refusal(f"An animation has 2 to {MOST} frames; {count} would be none.")
    values = {name: along(kinds[name], through, count) for name, through in taken.items()}
    frames = []
    for n in range(count):
        changes = {name: through[n] for name, through in values.items()}
        width = None if bits is None else _between(Whole(), *bits, n / (count - 1))
        words = [f"{name}={_said(value)}" for name, value in changes.items()]
        words += [] if width is None else [f"{width} bits"]
        frames.append(Frame(figure.accepted(method, changes), width, " ".join(words)))
    return tuple(frames)


def _form(value):
    """Of how many numbers a value is made up, part by part."""
    return tuple(map(_form, value)) if isinstance(value, tuple) else ()


def _said(value):
    """A value in a line of progress."""
    return f"({', '.join(map(_said, value))})" if isinstance(value, tuple) else f"{value:.4g}"


def pictures_of(
    figure, profile, frames, size=None, *, method=None, threads=None, changes=MappingProxyType({})
):
    """The frames' pictures, drawn when they are needed: uint8 [h, w, 3], top row first.

    profile, size, method, threads  as for ``Figure.render``
    changes                         other values of parameters, for all frames

    Each is drawn by ``Figure.render`` with the frame's values.
    """
    for frame in frames:
        yield picture_of(figure, profile, frame, size, method, threads, changes)


def picture_of(figure, profile, frame, size, method, threads, changes):
    """A frame's picture, uint8 [h, w, 3]; arguments as for ``pictures_of``."""
    machine = profile if frame.bits is None else at_width(profile, frame.bits)
    drawn = figure.render(machine, size, method=method, threads=threads, **{**changes, **frame.changes})
    return drawn.image()[..., :3]
