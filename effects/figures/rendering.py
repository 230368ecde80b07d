"""A figure drawn on a machine: its picture, the ideal's of the same fragments, and their difference."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fixedpipe.pipeline.framebuffers.pictures import Pictured
from fixedpipe.pipeline.framebuffers.result import Result
from fixedpipe.pipeline.ideal.result import IdealResult
from fixedpipe.pipeline.profiles import IDEAL
from fixedpipe.pipeline.profiles.profile import Profile

if TYPE_CHECKING:
    from fixedpipe.effects.figures.figure import Figure, Method

# A difference shows (machine - ideal) so many times as large.
DIFFERENCE_GAIN = 8.0


def difference(
    machine: NDArray[np.uint8], ideal: NDArray[np.float64], gain: float = DIFFERENCE_GAIN
) -> NDArray[np.uint8]:
    """(machine - ideal) made visible: uint8 RGBA, middle grey where equal, lighter where the machine is
    lighter.

    ``machine``: uint8 [h, w, 4]; ``ideal``: float64 [h, w, 4], 1.0 = full, rows in the same order. A
    difference of one byte is ``gain`` bytes.
    """
    delta = np.asarray(machine[..., :3], np.float64) - 255.0 * np.clip(ideal[..., :3], 0.0, 1.0)
    out = np.full(machine.shape, 255, np.uint8)
    out[..., :3] = np.clip(np.floor(128.0 + gain * delta + 0.5), 0, 255)
    return out


@dataclass(frozen=True, eq=False, repr=False)
class Difference(Pictured):
    """(machine - ideal) made visible, by ``difference``. A notebook shows it, ``save`` writes it."""

    pixels: NDArray[np.uint8]

    def image(self) -> NDArray[np.uint8]:
        """Uint8 [h, w, 4], top row first."""
        return self.pixels

    def __repr__(self) -> str:
        height, width = self.pixels.shape[:2]
        return f"<a difference of {width}x{height} pixels>"


@dataclass(frozen=True, eq=False, repr=False)
class Rendering(Pictured):
    """A figure as a machine draws it (``Figure.render``). A notebook shows the machine's picture, ``save``
    writes it. All arrays have their top row first.

    figure    the Figure
    profile   the machine
    method    how it drew: one of the figure's methods
    size      a panel's edge, pixels
    changes   the parameters that have other values than the figure's, by name
    result    what the machine left behind: its Result; the IdealResult where the machine is the ideal
    threads   as of ``execute``, for the ideal too
    """

    figure: "Figure"
    profile: Profile
    method: "Method"
    size: int
    changes: Mapping[str, Any]
    result: Result | IdealResult
    threads: int | None = None

    def image(self) -> NDArray[np.uint8]:
        """The machine's picture, uint8 [h, w, 4]."""
        return self.result.image()

    @cached_property
    def ideal(self) -> IdealResult:
        """The ideal's answer for the same fragments, float64, computed when it is first asked for."""
        if isinstance(self.result, IdealResult):
            return self.result
        from fixedpipe.pipeline.ideal.evaluate import execute_ideal

        commands = self.figure.commands(IDEAL, self.size, self.method, **self.changes)
        dimensions = self.figure.dimensions(self.size)
        return execute_ideal(commands, *dimensions, guide=self.result, threads=self.threads)

    @property
    def difference(self) -> Difference:
        """(machine - ideal) made visible: middle grey where they are equal, each byte ``DIFFERENCE_GAIN``
        bytes.
        """
        return Difference(difference(self.image(), self.ideal.color))

    @cached_property
    def error(self) -> NDArray[np.float64]:
        """machine - ideal, RGB, both clamped to [0, 1]: float64 [h, w, 3], 1.0 = full."""
        ideal = np.clip(self.ideal.color[..., :3], 0.0, 1.0)
        if isinstance(self.result, IdealResult):
            return np.zeros_like(ideal)
        framebuffer = self.result.framebuffer
        exact = framebuffer.color[..., :3] / (2.0**framebuffer.color_bits - 1.0)
        return np.asarray(np.clip(exact, 0.0, 1.0) - ideal)

    def __repr__(self) -> str:
        width, height = self.figure.dimensions(self.size)
        changed = "".join(f", {name}={value!r}" for name, value in self.changes.items())
        return f"<{self.figure.id} on {self.profile.name}, {width}x{height} pixels{changed}>"
