"""Maps: what happened where in a frame, one number for each pixel and command."""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fixedpipe.pipeline.commands import Bitmap, Command, CopyPixels, Draw, DrawPixels
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.inspection.exact import unclamped
from fixedpipe.pipeline.inspection.stage_errors import stage_errors
from fixedpipe.pipeline.multi_draw import MultiDraw
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.validation.frames import frame_of

# The number that a map has for a pixel, by the map's name.
KINDS = {
    "clamps": "how many components of general combiners a clamp changed",
    "overdraw": "how many fragments were shaded",
    "lambda": "lambda of the lowest texture unit that asks for it, of the last fragment",
    "primitive": "which primitive of its Draw the last fragment is of",
    "texels": "how often each texel was read: a map of each texture, unit and level, faces below one another",
    "error": "the largest difference of red, green and blue from the guided ideal, as seen, in 1/255",
    "bits": "how many bits of red, green and blue the guided ideal agrees with, of the worst of them",
    "stages": "the largest difference of what each stage wrote from the guided ideal's, in 1/255",
    "depth": "what the depth buffer holds, 1.0 = the farthest",
    "stencil": "what the stencil buffer holds",
}
SHARES = ("reached", "above zero")  # of the numbers of a map: from 0 to 1
# These maps show the result of a command; an observer draws the others while it runs.
_BESIDE_IDEAL = {"error", "bits"}
_LEFT = {*_BESIDE_IDEAL, "depth", "stencil"}
_DRAWING = (Draw, DrawPixels, CopyPixels, Bitmap)


@dataclass(frozen=True, eq=False)
class Map:
    """A map of a command: float64 [h, w], top row first. NaN where no fragment fell, or for texels where none
    was read.
    """

    command: int
    label: str
    values: NDArray[np.float64]

    def numbers(self) -> dict[str, float]:
        """A map's numbers, by name.

        They are the share of pixels (or texels) that have a value, the share with one above zero, and the
        least value, the median, the 95th percentile and the greatest.
        """
        known = self.values[~np.isnan(self.values)]
        reached, above = SHARES
        if not len(known):
            return {reached: 0.0}
        middle, high = np.percentile(known, (50, 95), method="nearest").tolist()
        return {
            reached: len(known) / self.values.size,
            above: float((known > 0).mean()),
            "least": float(known.min()),
            "median": middle,
            "95 %": high,
            "greatest": float(known.max()),
        }

    def greatest_at(self) -> tuple[int, int]:
        """(x, y) of the greatest value, counted from the top left; of several, the first by rows.

        Raises ValueError where no pixel has a value.
        """
        y, x = np.unravel_index(np.nanargmax(self.values), self.values.shape)
        return int(x), int(y)


class _Drawn:
    """An observer of whole frames that draws a map of each command."""

    def __init__(self, kind, width, height):
        self.kind, self.size, self.number, self.maps = kind, (height, width), -1, {}
        self.triangle = self.read = self.level = None

    def __call__(self, stage, /, **columns):
        tell = _TOLD.get(stage)
        if tell is not None:
            tell(self, **columns)

    def _command(self, command):
        self.number, self.command = self.number + 1, command

    def _iteration(self, triangle, **columns):
        self.triangle = triangle

    def _shaded(self, part, fragments, bits):
        if self.kind == "texels":
            return
        if fragments.x.max(initial=-1) >= self.size[1] or fragments.y.max(initial=-1) >= self.size[0]:
            self.at = None  # a pbuffer larger than the window
            return
        self.at, self.read = (fragments.y, fragments.x), None
        if self.number not in self.maps:
            self.maps[self.number] = Map(self.number, self.command.label, np.full(self.size, np.nan))
        values = self.maps[self.number].values
        values[self.at] = np.where(np.isnan(values[self.at]), 0.0, values[self.at])
        if self.kind == "overdraw":
            np.add.at(values, self.at, 1.0)
        elif self.kind == "primitive" and self.triangle is not None:
            values[self.at] = self.triangle

    def _lambda(self, unit, lod, limited):
        if self.kind == "lambda" and self.read in (None, unit) and self.at is not None:
            self.read = unit
            self.maps[self.number].values[self.at] = limited / 256.0

    def _level(self, unit, level, size, **columns):
        self.level = unit, level, size

    def _filter(self, columns, rows, layers, **fractions):
        if self.kind != "texels" or self.level is None:
            return
        unit, level, (width, height, depth) = self.level
        if (key := (self.number, unit, level)) not in self.maps:
            name = self.command.state.texture_units[unit].texture
            label = f"{self.command.label}: {name}, unit {unit}, level {level}"
            self.maps[key] = Map(self.number, label, np.full((depth * height, width), np.nan))
        values = self.maps[key].values.reshape(depth, height, width)[:, ::-1]  # texels' first row is below
        for taps in itertools.product(layers, rows, columns):
            places = np.broadcast_arrays(*[index for index, _ in taps])
            inside = np.ones(places[0].shape, bool)
            for _, outside in taps:
                inside &= True if outside is None else ~outside
            at = tuple(place[inside] for place in places)
            values[at] = np.nan_to_num(values[at])
            np.add.at(values, at, 1.0)

    def _portion(self, **columns):
        self.begun = columns

    def _outputs(self, alpha, values):
        if self.kind != "clamps" or self.at is None:
            return
        for register, codes in values:
            free = unclamped(register, **self.begun)
            np.add.at(self.maps[self.number].values, self.at, (free != codes).sum(axis=0))


_TOLD = {
    "command": _Drawn._command,
    "iteration": _Drawn._iteration,
    "shaded": _Drawn._shaded,
    "lambda": _Drawn._lambda,
    "level": _Drawn._level,
    "filter": _Drawn._filter,
    "portion": _Drawn._portion,
    "outputs": _Drawn._outputs,
}


def _left(commands, profile, width, height, kind, ideal, given):
    """Maps of the window's contents after each command that draws to it."""
    runner, maps, colors, number = Machine(profile, width, height, **given), [], [], -1

    def seen(command, _):
        nonlocal number
        number += 1
        if not isinstance(command, _DRAWING):
            return
        shown = runner.drawn()
        if shown is not runner.framebuffer:  # a pbuffer
            colors.append(None)
            return
        if kind == "stencil":
            values = shown.stencil.astype(np.float64)
        elif kind == "depth":
            if shown.depth_format.is_float:
                raise ValueError(
                    f"The depth buffer is {shown.depth_format.name}; a map shows fixed-point depths alone: "
                    "give depth_bits of a fixed format."
                )
            values = shown.depths(0, 0, width, height)[::-1]
        else:
            values = np.full((height, width), np.nan)
            colors.append((len(maps), shown.color[..., :3].copy(), 2.0**shown.color_bits - 1.0))
        maps.append(Map(number, command.label, values))

    result = runner.run(commands, trace=seen, record=kind in _BESIDE_IDEAL)
    if kind in _BESIDE_IDEAL:
        left = iter(colors)

        def compared(command, exact):
            if isinstance(command, _DRAWING) and (found := next(left)) is not None:
                place, codes, one = found
                difference = np.clip(codes / one, 0.0, 1.0) - np.clip(exact[..., :3], 0.0, 1.0)
                worst = np.abs(difference).max(axis=-1)
                right = -np.log2(np.maximum(worst, 1.0 / (one + 1.0)))
                maps[place].values[:] = 255.0 * worst if kind == "error" else right

        execute_ideal(commands if ideal is None else ideal, width, height, guide=result, trace=compared)
    return tuple(maps)


def frame_maps(
    commands: Iterable[Command | MultiDraw],
    profile: Profile,
    width: int,
    height: int,
    kind: str,
    *,
    ideal: Iterable[Command | MultiDraw] | None = None,
    **machine: Any,
) -> tuple[Map, ...]:
    """Run ``commands`` and return a Map for each command, in order.

    The commands are those that made a fragment. For "error", "bits", "depth" and "stencil" they are those
    that drew to the window.

    kind     one of KINDS
    ideal    for "error", "bits" and "stages": the commands that the ideal evaluates; None: the same
    machine  as ``execute`` takes it, without ``engine``

    Raises what ``execute`` raises, and ValueError for another kind. "error" and "bits" also raise what
    ``execute_ideal`` raises, "stages" what ``stage_errors`` raises.
    """
    if kind not in KINDS:
        raise ValueError(f"There is no map {kind!r}; there are: {', '.join(KINDS)}.")
    if kind in _LEFT:
        return _left(frame_of(commands), profile, width, height, kind, ideal, machine)
    if kind == "stages":
        errors = stage_errors(commands, profile, width, height, ideal=ideal, **machine)
        return tuple(
            Map(number, f"{label}: {stage}", values) for (number, label, stage), values in errors.items()
        )
    drawn = _Drawn(kind, width, height)
    Machine(profile, width, height, engine="columns", observer=drawn, **machine).run(commands)
    return tuple(drawn.maps[key] for key in sorted(drawn.maps))
