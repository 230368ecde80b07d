"""A frame that has run, with all that is needed to draw one of its pixels again, alone.

It keeps what fragments read outside their own pixel: the textures before each command, and what each
CopyPixels copied. So no command has to run again for another pixel.
"""

from copy import deepcopy
from dataclasses import dataclass
from typing import Any

from fixedpipe.pipeline.commands import (
    BindTexImage,
    Command,
    CopyPixels,
    CopyTexImage,
    CopyTexSubImage,
    HostStep,
    MakeCurrent,
    TexImage,
)
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.framebuffers.framebuffer import Framebuffer
from fixedpipe.pipeline.framebuffers.result import Result
from fixedpipe.pipeline.framebuffers.transfer import PixelStatistics
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.textures.images import Texture
from fixedpipe.pipeline.validation.frames import frame_of

_DEFINE_TEXTURES = (TexImage, CopyTexImage, CopyTexSubImage, BindTexImage)


@dataclass(frozen=True, eq=False)
class Step:
    """A command that ran.

    number      its place among those that ran, from 0. Commands of a HostStep count where they ran
    command     the command
    surface     the current pbuffer after it ran; None: the window
    textures    name to Texture, before it
    source      for a CopyPixels, a copy of the framebuffer before it; otherwise None
    statistics  histograms and minmaxes before it
    """

    number: int
    command: Command
    surface: str | None
    textures: dict[str, Texture]
    source: Framebuffer | None
    statistics: PixelStatistics


@dataclass(frozen=True, eq=False)
class RecordedFrame:
    """A frame that ran on a machine: its Steps, and the Result.

    ``depth_bits``, ``samples``: the machine's, as in ``execute``.
    """

    profile: Profile
    width: int
    height: int
    depth_bits: int
    samples: int
    color_bits: int
    steps: tuple[Step, ...]
    result: Result

    def shown(self, surface: str | None) -> Framebuffer:
        """The window (None) or a pbuffer as the frame left it. Raises ValueError for an unknown name."""
        if surface is None:
            return self.result.framebuffer
        if surface not in self.result.surfaces:
            there = ", ".join(self.result.surfaces) or "none"
            raise ValueError(f"This frame has no pbuffer {surface!r}; there are: {there}.")
        return self.result.surfaces[surface]

    def sharing(self, surface: str | None) -> tuple[str | None, ...]:
        """The framebuffers that share their depths with ``surface``, itself among them; None: the window."""
        made = self.result.surfaces
        owner = {name: it.depth_of if it.shares_depth else name for name, it in made.items()}
        return tuple(name for name in (None, *made) if owner.get(name) == owner.get(surface))


def record(commands: Any, profile: Profile, width: int, height: int, **machine: Any) -> RecordedFrame:
    """Run ``commands`` as ``execute`` does, and keep what any pixel needs. Returns a RecordedFrame.

    ``machine``: ``depth_bits``, ``threads``, ``batch``, ``engine``, ``samples`` and ``color_bits`` as
    ``execute`` takes them. Raises what ``execute`` raises.

    A machine keeps the textures that it defines anyway. The record adds a framebuffer for each CopyPixels.
    """
    commands = frame_of(commands)
    on = Machine(profile, width, height, **machine)
    copies = any(isinstance(command, (CopyPixels, HostStep)) for command in commands)
    steps: list[Step] = []
    before: dict[str, Any] = {
        "surface": None,
        "textures": dict(on.textures),
        "source": on.drawn().copy() if copies else None,
        "statistics": deepcopy(on.statistics),
    }

    def watch(command, snapshot):
        kind = type(command)
        if kind is MakeCurrent:
            before["surface"] = command.surface
        source = before["source"] if kind is CopyPixels else None
        steps.append(
            Step(
                len(steps),
                command,
                before["surface"],
                before["textures"],
                source,
                before["statistics"],
            )
        )
        if kind in _DEFINE_TEXTURES:
            before["textures"] = dict(on.textures)
        if copies:
            before["source"] = on.drawn().copy()
        if on.statistics.histograms or on.statistics.minmaxes:
            before["statistics"] = deepcopy(on.statistics)

    result = on.run(commands, trace=watch)
    held = on.depth_bits, on.samples, on.color_bits
    return RecordedFrame(profile, width, height, *held, tuple(steps), result)
