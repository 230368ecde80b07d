"""Maps: what happened where in a frame, a number for each pixel and command."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fixedpipe.pipeline.commands import Command
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.inspection.exact import unclamped
from fixedpipe.pipeline.profiles.profile import Profile

# What a map tells of a pixel, by its name.
KINDS = {
    "clamps": "how many components of general combiners a clamp changed",
    "overdraw": "how many fragments were shaded",
    "lambda": "lambda of the lowest texture unit that asks for it, of the last fragment",
    "primitive": "which primitive of its Draw the last fragment is of",
}


@dataclass(frozen=True, eq=False)
class Map:
    """A map of a command: float64 [h, w], top row first; no number where no fragment fell."""

    command: int
    label: str
    values: NDArray[np.float64]

    def numbers(self) -> dict[str, float]:
        """The share of the framebuffer's pixels that have a value, of those with one above zero, and of the
        values the median, the 95th percentile and the greatest.
        """
        known = self.values[~np.isnan(self.values)]
        if not len(known):
            return {"reached": 0.0}
        middle, high = np.percentile(known, (50, 95), method="nearest").tolist()
        return {
            "reached": len(known) / self.values.size,
            "above zero": float((known > 0).mean()),
            "median": middle,
            "95 %": high,
            "greatest": float(known.max()),
        }


class _Drawn:
    """A witness of whole frames that draws a map of each command."""

    def __init__(self, kind, width, height):
        self.kind, self.size, self.number, self.maps = kind, (height, width), -1, {}
        self.triangle = self.read = None

    def __call__(self, stage, /, **columns):
        tell = _TOLD.get(stage)
        if tell is not None:
            tell(self, **columns)

    def _command(self, command):
        self.number, self.label = self.number + 1, command.label

    def _iteration(self, triangle, **columns):
        self.triangle = triangle

    def _shaded(self, part, fragments, bits):
        if fragments.x.max(initial=-1) >= self.size[1] or fragments.y.max(initial=-1) >= self.size[0]:
            self.at = None  # of a pbuffer larger than the window
            return
        self.at, self.read = (fragments.y, fragments.x), None
        if self.number not in self.maps:
            self.maps[self.number] = Map(self.number, self.label, np.full(self.size, np.nan))
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

    def _portion(self, **columns):
        self.begun = columns

    def _outputs(self, alpha, values):
        if self.kind != "clamps" or self.at is None:
            return
        portion, ab, cd, a = (self.begun[name] for name in ("portion", "ab", "cd", "arithmetic"))
        for register, codes in values:
            free = unclamped(register, portion, ab, cd, a)
            if free is not None:
                np.add.at(self.maps[self.number].values, self.at, (free != codes).sum(axis=0))


_TOLD = {
    "command": _Drawn._command,
    "iteration": _Drawn._iteration,
    "shaded": _Drawn._shaded,
    "lambda": _Drawn._lambda,
    "portion": _Drawn._portion,
    "outputs": _Drawn._outputs,
}


def frame_maps(
    commands: Iterable[Command], profile: Profile, width: int, height: int, kind: str, **machine: Any
) -> tuple[Map, ...]:
    """Run ``commands`` on the column engine: a Map of each command that made a fragment, in order.

    ``kind``: of KINDS. ``machine``: as ``execute`` takes it, but ``engine``. Raises what ``execute`` raises,
    and ValueError for another kind.
    """
    if kind not in KINDS:
        raise ValueError(f"There is no map {kind!r}; there are: {', '.join(KINDS)}.")
    drawn = _Drawn(kind, width, height)
    Machine(profile, width, height, engine="columns", witness=drawn, **machine).run(commands)
    return tuple(drawn.maps.values())
