"""A window's commands run on a machine of its own, or are only validated.

**Refusals.** A machine validates a list of commands, and refuses the whole list for one wrong command. Only
in this case are the commands validated one after the other. Each refused one is counted with its sentence,
and the others run.

**Front and back.** A machine has one colour buffer. It holds the contents of the buffer that commands draw
into. The contents of the others are stored separately, and are exchanged when the program draws into another
buffer. So all buffers share depths and stencil values, as in OpenGL. A swap copies the back buffer's contents
to the front buffer.

**Framebuffer objects** are pbuffers. On a machine without pbuffers each framebuffer object is a window of its
own. CopyTexImage then defines the texture from this window, as programs of the time did.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import groupby
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.replays.postponed import Postponed
from fixedpipe.effects.replays.recording import Recording
from fixedpipe.effects.replays.samples import SampleCounter, by_draws, gives_fragments
from fixedpipe.pipeline.commands import (
    Accum,
    BindTexImage,
    Bitmap,
    Clear,
    Command,
    CopyPixels,
    CopyTexImage,
    CopyTexSubImage,
    Draw,
    DrawPixels,
    GetTexImage,
    HostStep,
    MakeCurrent,
    ReadPixels,
    TexImage,
    box_read,
)
from fixedpipe.pipeline.enums import AccumOperation, PixelCopyType
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.framebuffers.framebuffer import Framebuffer
from fixedpipe.pipeline.opengl.outcomes import Tally
from fixedpipe.pipeline.pixel_transfer import PixelImage
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.textures.images import Texture
from fixedpipe.pipeline.validation.validate import begun, walked
from fixedpipe.pipeline.validation.walk import Walk

DRAWING = (Draw, DrawPixels, CopyPixels, Bitmap)
_WRITING = (*DRAWING, Accum, Clear)
_OF_THE_HOST = (HostStep, GetTexImage, ReadPixels)  # a recording holds their results instead
# The most pixels of stored windows, and of stored pbuffers: some 600 MB. Assumed: no program has more.
MOST_PIXELS = 1 << 26
BACK, FRONT = "back", "front"
# The end of a command's label: the call, and its number.
_LABEL = re.compile(r"(\w+) \(call (\d+)\)$")
# The beginning of a refusal's sentence: the command's place and label.
_PLACE = re.compile(r'^Command \d+(?:, ".*?")?: ', re.DOTALL)


@dataclass(eq=False)
class Target:
    """The place where the commands of a window run.

    - ``textures``: the textures of the contexts' group, by name.
    - ``threads``: how many threads draw; None: one per processor.
    - ``draws``: draws since the last frame ended, with refused ones; ``refused``: only the refused ones.
    - ``fragments``: how many fragments all frames had.
    - ``last``: the last destination of draws: a buffer, a pbuffer's name, or a framebuffer object's Target.
    - ``drawn_into``: the buffers and pbuffers with draws since the last frame ended.
    - ``recording``: the present frame's Recording, if it is requested.
    - ``postponing``: whether draws may wait until something reads their result.
    - ``counter``: the SampleCounter of an active occlusion query, or None.
    - ``bound``: the name of the pbuffer that the last commands left current, or None.
    """

    profile: Profile
    width: int
    height: int
    textures: dict[str, Texture]
    tally: Tally
    threads: int | None = None
    draws: int = 0
    refused: int = 0
    fragments: int = 0
    last: "str | Target" = BACK
    drawn_into: set[str] = field(default_factory=set)
    recording: Recording | None = None
    postponing: bool = False
    counter: SampleCounter | None = None
    bound: str | None = None

    def __post_init__(self) -> None:
        self._others: dict[str, Target] = {}  # framebuffer objects, if the machine has no pbuffers
        self._current: Target = self  # the current one of these, or this Target
        self._surface: MakeCurrent | None = None  # the pbuffer that commands draw into
        self._pixels: dict[str, NDArray[Any]] = {}  # the pixels that the last run read, by name
        self._counts = False  # whether samples are counted now
        self._start()

    # ----------------------------------------------------------------------------- what the two kinds do

    def _start(self) -> None:
        """Make the machine, or the validation, that commands run on."""
        raise NotImplementedError

    def _execute(self, commands: tuple[Command, ...]) -> tuple[Command, ...]:
        """Run commands; count the refused ones, and return the others."""
        raise NotImplementedError

    def _hold(self, buffer: str) -> None:
        """Let commands draw into a buffer, and read from it."""

    def settle(self) -> None:
        """Draw the waiting commands."""

    def use_textures(self, textures: dict[str, Texture]) -> None:
        """Take the textures of another group of contexts."""
        self.textures = textures

    def resize(self, width: int, height: int) -> None:
        """Give the window another size. Its contents stay at its lower left."""
        self.width, self.height = width, height

    def swap(self) -> None:
        """The front buffer shows the back buffer's contents."""

    def picture(self, buffer: str) -> NDArray[np.uint8] | None:
        """The colours of a buffer or pbuffer, uint8 [h, w, 4], top row first; None: nothing is drawn here."""
        return None

    def save(self) -> dict[str, Framebuffer]:
        """Copies of the present contents of the window's buffers and of the pbuffers, by name."""
        return {}

    def depth_bits(self) -> int:
        """How many bits the depths of ``read`` have: the depths of the window, or of the current pbuffer."""
        if self._current is not self:
            return self._current.depth_bits()
        return int(self.profile.widest_depth) if self._surface is None else int(self._surface.depth_bits)

    # ------------------------------------------------------------------------------------------- running

    def run(self, commands: Sequence[Command], draws: tuple[str, ...] = (BACK,), reads: str = BACK) -> None:
        """Run commands that draw into the buffers ``draws`` and read from ``reads``."""
        if self.counter is None:
            self._run(commands, draws, reads)
            return
        for part in by_draws(commands):
            self._run(part, draws, reads)

    def read(self, command: ReadPixels, draws: tuple[str, ...], reads: str) -> NDArray[Any]:
        """The pixels that a ReadPixels returns now; zeros if nothing is drawn, or if it is refused."""
        self._run((command,), draws, reads)
        read = self._current._pixels.pop(command.name, None)
        return blank(command) if read is None else read

    def _run(self, commands, draws, reads):
        if draws == (reads,):
            self._run_on(draws, commands)
            return
        for reading, group in groupby(commands, _only_reads):
            if reading:
                self._run_on((reads,), tuple(group))
                continue
            into, drawing = draws[0] if draws else reads, list(group)
            # If what is read is drawn into as well, each command reads what those before it drew.
            parts = [[command] for command in drawing] if reads in draws[1:] else [drawing]
            for part in parts:
                self._run_on(draws, [self._of_other(c, reads) if reads != into else c for c in part])

    def end_frame(self) -> None:
        """Begin to count draws again from 0."""
        self.draws = self.refused = 0
        self.drawn_into.clear()

    def record(self) -> None:
        """From now on record all draws, here and into framebuffer objects."""
        self.recording = Recording(dict(self.textures), self.save())
        for other in self._others.values():
            other.record()

    def shown(self) -> "tuple[Target, str]":
        """(Target, buffer) that commands drew into last."""
        return self.last.shown() if isinstance(self.last, Target) else (self, self.last)

    def _run_on(self, buffers, commands):
        if self.profile.framebuffers.surface_formats:
            self._run_here(buffers, tuple(commands))
            return
        for redirects, group in groupby(commands, _concerns_surfaces):
            if redirects:
                for command in group:
                    self._redirect(command)
            elif self._current is not self:
                group = tuple(group)
                self._current.counter = self.counter
                self._current._run_on(buffers and (BACK,), group)
                if any(isinstance(command, _WRITING) for command in group):
                    self.last = self._current
                self._take_counts(self._current)
            else:
                self._run_here(buffers, tuple(group))

    def _run_here(self, named, commands):
        # After DrawBuffer(NONE) the front end's commands write no colours, so any buffer will do.
        buffers, surface = named or (BACK,), self._surface
        for command in commands:
            kind = type(command)
            if kind is MakeCurrent:
                surface = None if command.surface is None else command
            elif kind in _WRITING:
                if surface is not None or named:
                    self.last = named[-1] if surface is None else surface.surface
                self.draws += kind in DRAWING
                if kind is not Clear:
                    self.drawn_into.update(named if surface is None else (self.last,))
        continued = self._continued(commands)
        depths = self._depths() if len(buffers) > 1 else None
        for number, buffer in enumerate(buffers):
            self._hold(buffer)
            if number:  # depths and stencil values are those from before the first buffer
                self._restore(depths)
            self._counts = self.counter is not None and not number and gives_fragments(commands)
            continued = self._execute(continued)
            if self.recording is not None:
                self.recording.add(buffer, continued)
        self._surface = surface

    def _continued(self, commands):
        """The commands after the current MakeCurrent, because every run begins with the window."""
        return commands if self._surface is None else (self._surface, *commands)

    def _depths(self):
        return None

    def _restore(self, depths):
        pass

    def _redirect(self, command):
        """Carry out a MakeCurrent or BindTexImage on a machine without pbuffers."""
        self.settle()  # the other window has the same textures
        self.postponing = False
        if isinstance(command, BindTexImage):
            self._copy_to_texture(command)
        elif command.surface is None:
            self._current = self
        else:
            other = self._others.get(command.surface)
            if other is None:
                other = self._others[command.surface] = type(self)(
                    self.profile, command.width, command.height, self.textures, self.tally, self.threads
                )
                if self.recording is not None:
                    other.record()
                self._forget_others(other)
            self._current = other

    def _forget_others(self, kept):
        """If framebuffer objects have too many pixels, forget those that were made first. ``kept`` stays."""
        pixels = sum(other.width * other.height for other in self._others.values())
        for name, other in list(self._others.items()):
            if pixels <= MOST_PIXELS or other is kept:
                break
            del self._others[name]
            pixels -= other.width * other.height

    def _copy_to_texture(self, command):
        other = self._others.get(command.surface)
        if other is None:  # it was forgotten
            return
        copy = CopyTexImage(
            label=command.label,
            texture=command.texture,
            target=command.target,
            internal_format=command.internal_format,
            width=other.width,
            height=other.height,
        )
        other._run_on((BACK,), (copy,))
        if self.recording is not None and command.texture in self.textures:
            image = self.textures[command.texture]
            self.recording.add(None, (TexImage(label=command.label, texture=command.texture, image=image),))

    def _take_counts(self, other):
        self.draws, self.refused = self.draws + other.draws, self.refused + other.refused
        self.drawn_into |= other.drawn_into
        other.end_frame()

    def _of_other(self, command, reads):
        """A CopyPixels whose source is another buffer than its destination, as a DrawPixels."""
        if not isinstance(command, CopyPixels) or command.type is not PixelCopyType.COLOR:
            return command
        picture = self.picture(reads)
        if picture is None:
            return command
        x, y, across, up = box_read(command, self.width, self.height)
        box = picture[::-1][max(y, 0) : y + up, max(x, 0) : x + across]
        given = {name: getattr(command, name) for name in ("label", "state", "position", "zoom", "transfer")}
        return DrawPixels(image=PixelImage(box, "RGBA"), pixel_texture=command.pixel_texture, **given)

    # ------------------------------------------------------------------------------------------ refusals

    def _accepted(self, walk: Walk, commands: tuple[Command, ...]) -> list[Command]:
        """The commands that validation does not refuse; the others are counted."""
        accepted: list[Command] = []
        lost = False  # whether the pbuffer that commands would draw into was refused
        rest = commands
        while rest:
            try:
                walked(walk, rest)
                count, refusal = len(rest), None
            except ValueError as error:
                # "Command N": the place that the Walk has reached.
                count, refusal = int(re.findall(r"\d+", walk.where)[0]), error
            for command in rest[:count]:
                lost = lost and not isinstance(command, MakeCurrent)
                if not lost:
                    accepted.append(command)
                else:
                    self.refuse(command, "its pbuffer was refused")
            if refusal is None:
                break
            self.refuse(rest[count], str(refusal))
            lost = lost or isinstance(rest[count], MakeCurrent)
            rest = rest[count + 1 :]
        return accepted

    def refuse(self, command: Command, sentence: str) -> None:
        """Count a refused command by the call that made it."""
        name, number = call_of(command)
        now, self.tally.call = self.tally.call, number if number is not None else self.tally.call
        if isinstance(command, DRAWING):
            self.refused += 1
            if name:
                self.tally.add("drawn", name, -1)
        sentence = _PLACE.sub("", sentence)
        self.tally.add("refused", f"{name}: {sentence}" if name else sentence)
        self.tally.call = now


def call_of(command: Command) -> tuple[str, int | None]:
    """(name, number) of the call that made a command; ("", None) if its label does not name the call."""
    found = _LABEL.search(command.label)
    return (found[1], int(found[2])) if found else ("", None)


def blank(command: ReadPixels) -> NDArray[Any]:
    """The result of a ReadPixels of known size if nothing is drawn: zeros."""
    shape = command.height, command.width
    return np.zeros((*shape, 4)) if command.format == "RGBA" else np.zeros(shape, np.uint32)


def _concerns_surfaces(command):
    return isinstance(command, MakeCurrent | BindTexImage)


def _only_reads(command):
    """Whether a command reads colours and writes none."""
    if isinstance(command, Accum):
        return command.operation in (AccumOperation.LOAD, AccumOperation.ACCUM)
    return isinstance(command, CopyTexImage | CopyTexSubImage | ReadPixels)


class Drawn(Target):
    """A Target that draws, on a Machine."""

    def _start(self):
        self._postponed = Postponed()
        self._held = BACK
        self._kept: dict[str, NDArray[Any]] = {}  # the colours of the other buffers, by name
        self.machine = self._new_machine()

    def _new_machine(self, **kept):
        size = self.width, self.height
        return Machine(self.profile, *size, threads=self.threads, textures=self.textures, **kept)

    def use_textures(self, textures):
        """As Target says."""
        self.settle()
        super().use_textures(textures)
        self.machine.textures = textures

    def resize(self, width, height):
        """As Target says."""
        self.settle()
        was, old = self.machine, self.machine.framebuffer
        super().resize(width, height)
        self.machine = self._new_machine(surfaces=was.surfaces, statistics=was.statistics)
        new = self.machine.framebuffer
        for name in ("color", "depth", "stencil"):
            _keep_lower_left(getattr(old, name), getattr(new, name))
        for buffer, colors in self._kept.items():
            self._kept[buffer] = _keep_lower_left(colors, np.zeros_like(new.color))
        if self.recording is not None:
            self.record()

    def swap(self):
        """As Target says."""
        if self._postponed:
            self._postponed.swap()
        else:
            self._swap()

    def _swap(self):
        if self._held == BACK:
            self._kept[FRONT] = self.machine.framebuffer.color.copy()
        elif BACK in self._kept and self._held == FRONT:
            self.machine.framebuffer.color[...] = self._kept[BACK]
        elif BACK in self._kept:
            self._kept[FRONT] = self._kept[BACK].copy()

    def picture(self, buffer):
        """As Target says."""
        self.settle()
        framebuffer = self.machine.surfaces.get(buffer, self.machine.framebuffer)
        if buffer == self._held or framebuffer is not self.machine.framebuffer:
            return framebuffer.image()
        colors = self._kept.get(buffer)
        return framebuffer.as_bytes(np.zeros_like(framebuffer.color) if colors is None else colors).copy()

    def save(self):
        """As Target says."""
        self.settle()
        window = self.machine.framebuffer.copy()
        others = {buffer: replace(window, color=colors.copy()) for buffer, colors in self._kept.items()}
        surfaces = {name: made.copy() for name, made in self.machine.surfaces.items()}
        return {self._held: window, **others, **surfaces}

    def _hold(self, buffer):
        if buffer == self._held:
            return
        self.settle()
        color = self.machine.framebuffer.color
        other = self._kept.pop(buffer, None)
        self._kept[self._held] = color.copy()
        color[...] = 0 if other is None else other
        self._held = buffer

    def _depths(self):
        self.settle()
        framebuffer = self.machine.framebuffer
        return framebuffer.depth.copy(), framebuffer.stencil.copy()

    def _restore(self, depths):
        self.machine.framebuffer.depth[...], self.machine.framebuffer.stencil[...] = depths

    def settle(self):
        """As Target says."""
        if not self._postponed:
            return
        for number, commands in enumerate(self._postponed.take_parts()):
            if number:
                self._swap()
            if commands:
                self._run_now(commands)

    def _execute(self, commands):
        waits = self.postponing and self._held == BACK and not self._counts
        if waits and self._postponed.take(commands):
            return commands
        self.settle()
        return self._run_now(commands)

    def _run_now(self, commands):
        """Run commands, and return those that ran. In a recording, the commands of a HostStep replace it."""
        ran = []
        watch = (lambda command, _: ran.append(command)) if self.recording is not None else False
        machine = self.machine
        try:
            self._run_machine(commands, watch)
        except ValueError:
            ran.clear()
            held = machine.width, machine.height, machine.depth_bits
            walk = begun(
                self.profile,
                *held,
                machine.textures,
                machine.surfaces,
                machine.statistics,
                (),
                samples=machine.samples or 1,
            )
            commands = tuple(self._accepted(walk, commands))
            self._run_accepted(commands, watch)
        self._forget_surfaces()
        if self.recording is None:
            return commands
        return tuple([command for command in ran if not isinstance(command, _OF_THE_HOST)])

    def _run_machine(self, commands, watch):
        counts = self._counts and self.machine.samples == 1
        result = self.machine.run(commands, trace=watch, record=counts)
        self.fragments += result.fragments
        self._pixels = result.pixels
        if counts:
            self.counter.add(result.records)

    def _run_accepted(self, commands, watch):
        try:
            self._run_machine(commands, watch)
        except ValueError as error:  # an error that validation does not find
            for command in commands:
                if isinstance(command, DRAWING):
                    self.refuse(command, str(error))

    def _forget_surfaces(self):
        """If pbuffers have too many pixels, forget those that were made first."""
        surfaces = self.machine.surfaces
        pixels = sum(surface.color[..., 0].size for surface in surfaces.values())
        for name in list(surfaces):
            if pixels <= MOST_PIXELS or (self._surface is not None and name == self._surface.surface):
                break
            pixels -= surfaces.pop(name).color[..., 0].size


def _keep_lower_left(old, new):
    """Copy the part that both arrays have at their lower left. Their first row is the top one."""
    up, across = min(old.shape[0], new.shape[0]), min(old.shape[1], new.shape[1])
    new[new.shape[0] - up :, :across] = old[old.shape[0] - up :, :across]
    return new


class Judged(Target):
    """A Target that validates and draws nothing. It counts the commands that the machine would refuse.

    ``textures`` holds a KnownTexture for each texture.
    """

    def _start(self):
        self._walk = begun(self.profile, self.width, self.height, None, None, None, None, ())
        self._walk.textures = self.textures

    def use_textures(self, textures):
        """As Target says."""
        super().use_textures(textures)
        self._walk.textures = textures

    def resize(self, width, height):
        """As Target says."""
        super().resize(width, height)
        surfaces = self._walk.surfaces
        self._start()
        self._walk.surfaces = surfaces

    def _execute(self, commands):
        return tuple(self._accepted(self._walk, commands))
