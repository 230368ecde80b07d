"""What a figure is: what it shows, where it comes from, how each machine draws it, and checks of it as code.

A figure's scene is one tuple of commands that draws a row of square panels, so that it can be printed,
validated, rendered on any machine and compared. Machines that have to draw it in different ways have a
``Method`` each.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, Concatenate, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.pipeline.commands import Command
from fixedpipe.pipeline.framebuffers.result import Result
from fixedpipe.pipeline.ideal.result import IdealResult
from fixedpipe.pipeline.profiles import IDEAL, PROFILES
from fixedpipe.pipeline.profiles.profile import Profile

# Parameters of a scene that leave the highlight alone.
DARK = {"diffuse": (0.0, 0.0, 0.0), "ambient": (0.0, 0.0, 0.0), "background": (0.0, 0.0, 0.0)}
# Machines with two or more general combiners; the first is the one that the paper used.
COMBINER_MACHINES = ("GEFORCE_256", "GEFORCE_3", "NV2A", "FUTURE")
# Machines with a colour matrix, colour tables and subtractive blending.
IMAGING_MACHINES = ("OCTANE", "INFINITE_REALITY", "OPENGL_1_2_IMAGING")
# Those of them with eight bits of colour, for figures that load thousands of polygons: with twelve F004-4
# takes 20 s (Measured).
IMAGING_MACHINES_8 = ("OCTANE", "OPENGL_1_2_IMAGING")
# Diagrams (fixedpipe.effects.diagrams.drawing) need nothing that a machine lacks; these stand for the others.
DIAGRAM_MACHINES = ("OPENGL_1_2", "GEFORCE_256")
# A figure's third picture shows (machine - ideal) so many times as large.
DIFFERENCE_GAIN = 8.0

# (profile, size, **parameters) -> commands for a framebuffer of the figure's dimensions.
Scene: TypeAlias = Callable[Concatenate[Profile, int, ...], tuple[Command, ...]]
# (figure, renderer) -> its Checks, in a tuple or one after the other.
Acceptance: TypeAlias = Callable[["Figure", "Renderer"], Iterable[Check]]
# As of ``execute`` and ``execute_ideal`` of ``fixedpipe.pipeline``.
Execute: TypeAlias = Callable[[tuple[Command, ...], Profile, int, int], Result]
ExecuteIdeal: TypeAlias = Callable[[tuple[Command, ...], int, int], IdealResult]


@dataclass(frozen=True, eq=False)
class Method:
    """One way to draw a figure.

    name        in the words of a caption: "register combiners"
    scene       draws it: a Scene
    machines    keys in ``fixedpipe.pipeline.profiles.PROFILES`` of the machines that draw it so
    parameters  those of the scene's numbers that differ from the figure's own
    """

    name: str
    scene: Scene
    machines: tuple[str, ...]
    parameters: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "parameters", MappingProxyType(dict(self.parameters)))


@dataclass(frozen=True, kw_only=True, eq=False)
class Figure:
    """A figure as data.

    id           the catalogue's: F<document>-<number>, or a technique's
    title        what it is, in a few words
    caption      what is shown
    must_see     what must be visible for the figure to be right
    source       key in docs/bibliography.bib
    techniques   the catalogue's ids of the techniques used
    columns      how many square panels side by side
    size         default edge of a panel, pixels
    parameters   the scene's numbers; any may be given to ``commands`` again
    methods      how it is drawn, a machine in one of them at most; first the one that the paper used
    acceptance   its checks: an Acceptance
    """

    id: str
    title: str
    caption: str
    must_see: str
    source: str
    techniques: tuple[str, ...]
    columns: int
    size: int = 512
    parameters: Mapping[str, Any] = field(default_factory=dict)
    methods: tuple[Method, ...]
    acceptance: Acceptance

    def __post_init__(self) -> None:
        object.__setattr__(self, "parameters", MappingProxyType(dict(self.parameters)))
        if len(set(self.machines)) < len(self.machines) or not set(self.machines) <= set(PROFILES):
            raise ValueError(f"{self.id} names a machine twice, or one that is not known: {self.machines}.")

    @property
    def machines(self) -> tuple[str, ...]:
        """Keys in ``fixedpipe.pipeline.profiles.PROFILES`` of machines that can draw it, its own first."""
        return tuple(key for method in self.methods for key in method.machines)

    def method(self, machine: str) -> Method:
        """How a machine draws it, by the machine's key.

        Raises ValueError where it cannot.
        """
        for method in self.methods:
            if machine in method.machines:
                return method
        raise ValueError(f"{self.id} cannot be drawn on {machine}; it can on {', '.join(self.machines)}.")

    def dimensions(self, size: int | None = None) -> tuple[int, int]:
        """Width and height of the framebuffer in pixels for panels of ``size``."""
        edge = self.size if size is None else size
        return self.columns * edge, edge

    def commands(
        self, profile: Profile, size: int | None = None, method: Method | None = None, **changes: Any
    ) -> tuple[Command, ...]:
        """The scene with the figure's own parameters, some replaced.

        ``method``: one of ``methods``; None: the first. ``profile``: one of the method's machines, or such a
        machine changed, or the ideal.
        """
        method = self.methods[0] if method is None else method
        edge = self.size if size is None else size
        return method.scene(profile, edge, **{**self.parameters, **method.parameters, **changes})

    def checks(self, renderer: "Renderer") -> tuple[Check, ...]:
        """The figure's acceptance checks, rendered by a ``Renderer``: a tuple of Check."""
        return tuple(self.acceptance(self, renderer))


@dataclass(frozen=True, eq=False)
class Renderer:
    """How checks get pictures: a machine, how it draws, and ``execute`` and ``execute_ideal`` of
    ``fixedpipe.pipeline``.

    ``kept``: pictures of the ideal, which machines that draw in the same way share.
    """

    profile: Profile
    method: Method
    execute: Execute
    execute_ideal: ExecuteIdeal
    kept: dict[object, NDArray[np.float64]] = field(default_factory=dict)

    def machine(self, figure: Figure, size: int, /, **changes: Any) -> NDArray[np.float64]:
        """RGB float64 [size, columns * size, 3] of the machine's picture, bottom row first, 1.0 = full."""
        commands = figure.commands(self.profile, size, self.method, **changes)
        framebuffer = self.execute(commands, self.profile, *figure.dimensions(size)).framebuffer
        return framebuffer.color[::-1, :, :3] / (2.0**framebuffer.color_bits - 1.0)

    def picture(self, answer: Answer, figure: Figure, size: int, /, **changes: Any) -> NDArray[np.float64]:
        """That answer's picture, ``machine`` or ``ideal``: RGB float64 [size, columns * size, 3]."""
        draw = {Answer.MACHINE: self.machine, Answer.IDEAL: self.ideal}[answer]
        return draw(figure, size, **changes)

    def ideal(self, figure: Figure, size: int, /, **changes: Any) -> NDArray[np.float64]:
        """RGB float64 [size, columns * size, 3] of the free ideal, bottom row first."""
        key = figure, self.method, size, repr(sorted(changes.items()))
        if key not in self.kept:
            commands = figure.commands(IDEAL, size, self.method, **changes)
            self.kept[key] = self.execute_ideal(commands, *figure.dimensions(size)).color[::-1, :, :3]
        return self.kept[key]


def difference(
    machine: NDArray[np.uint8], ideal: NDArray[np.float64], gain: float = DIFFERENCE_GAIN
) -> NDArray[np.uint8]:
    """(machine - ideal) made visible: uint8 RGBA, middle grey where equal, lighter where the machine is
    lighter.

    ``machine``: uint8 [h, w, 4]; ``ideal``: float64 [h, w, 4], 1.0 = full. A difference of one byte is
    ``gain`` bytes.
    """
    delta = np.asarray(machine[..., :3], np.float64) - 255.0 * np.clip(ideal[..., :3], 0.0, 1.0)
    out = np.full(machine.shape, 255, np.uint8)
    out[..., :3] = np.clip(np.floor(128.0 + gain * delta + 0.5), 0, 255)
    return out
