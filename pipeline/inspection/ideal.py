"""The guided ideal of a recorded frame, and of one of its pixels: each number without rounding."""

from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fixedpipe.pipeline.commands import (
    Accum,
    Clear,
    Command,
    CopyPixels,
    CopyTexImage,
    CopyTexSubImage,
    Draw,
    HostStep,
    Saturate,
    TexImage,
)
from fixedpipe.pipeline.enums import ColorBuffer
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.framebuffers.rectangles import without_footprints
from fixedpipe.pipeline.framebuffers.texture_copies import defined_texture
from fixedpipe.pipeline.framebuffers.transfer import PixelStatistics
from fixedpipe.pipeline.ideal.buffers import IdealBuffers, accumulate, clear, saturate
from fixedpipe.pipeline.ideal.evaluate import evaluate_watched
from fixedpipe.pipeline.ideal.per_fragment import write
from fixedpipe.pipeline.ideal.primitives import primitives_of
from fixedpipe.pipeline.ideal.rectangles import rectangle, shade_rectangle
from fixedpipe.pipeline.ideal.shade import plan_for, shade
from fixedpipe.pipeline.ideal.textures import with_ideal
from fixedpipe.pipeline.ideal.weights import mesh_of, weigh
from fixedpipe.pipeline.inspection.pixel import Observer, Touch
from fixedpipe.pipeline.inspection.recording import RecordedFrame
from fixedpipe.pipeline.profiles import IDEAL
from fixedpipe.pipeline.textures.depths_as_colors import depths_as_colors
from fixedpipe.pipeline.textures.sampled import sampled_texture
from fixedpipe.pipeline.validation.frames import frame_of

# Fragments of these commands read other pixels, or need more than one pixel. Then the whole ideal runs, once.
_READ_ELSEWHERE = (CopyTexImage, CopyTexSubImage, CopyPixels, HostStep)


@dataclass(frozen=True, eq=False)
class RecordedIdeal:
    """The guided ideal of a RecordedFrame.

    commands  its commands, as they ran
    textures  before each command, the textures by name
    sources   for each CopyPixels, the buffers that it reads; otherwise None
    """

    frame: RecordedFrame
    commands: tuple[Command, ...]
    textures: tuple[dict[str, Any], ...]
    sources: tuple[IdealBuffers | None, ...]


def record_ideal(commands: Any, frame: RecordedFrame, machine_commands: Any = None) -> RecordedIdeal | None:
    """The RecordedIdeal of a frame; None: the ideal has no such frame.

    It has none for pbuffers, for several samples, or if its commands differ in type from the machine's.

    ``commands``: the ideal's. ``machine_commands``: those that made the frame; None: the same.
    """
    commands = frame_of(commands)
    if frame.samples > 1 or frame.result.surfaces:
        return None
    if any(isinstance(command, _READ_ELSEWHERE) for command in commands):
        found = _whole(commands, frame, frame_of(commands if machine_commands is None else machine_commands))
    else:
        found = RecordedIdeal(frame, commands, tuple(_given_textures(commands)), (None,) * len(commands))
    alike = [type(command) for command in found.commands] == [type(step.command) for step in frame.steps]
    return found if alike else None


def _whole(commands, frame, machine_commands):
    """The RecordedIdeal of commands that read other pixels: it draws the whole frame, once."""
    guide = execute(
        machine_commands, frame.profile, frame.width, frame.height, depth_bits=frame.depth_bits, record=True,
        samples=frame.samples, color_bits=frame.color_bits,
    )  # fmt: skip
    ran, textures, sources = [], [], []
    held, buffers = {}, IdealBuffers(frame.width, frame.height)
    copies = any(isinstance(command, (CopyPixels, HostStep)) for command in commands)

    def watch(command, after, drawn):
        nonlocal held, buffers
        ran.append(command)
        textures.append(held)
        sources.append(buffers if isinstance(command, CopyPixels) else None)
        held = dict(after)
        if copies:
            buffers = drawn.copy()

    evaluate_watched(commands, frame.width, frame.height, guide, frame.depth_bits, watch)
    return RecordedIdeal(frame, tuple(ran), tuple(textures), tuple(sources))


def _given_textures(commands):
    """The textures before each command, from the earlier commands."""
    held: dict[str, Any] = {}
    for command in commands:
        yield held
        if isinstance(command, TexImage):
            image = command.image
            if command.pixels is not None:
                before = held.get(command.texture)
                image = defined_texture(command, IDEAL, PixelStatistics(), before)
            held = {**held, command.texture: with_ideal(image)}


class IdealPixel:
    """One pixel of a RecordedIdeal, drawn in step with the machine's."""

    def __init__(self, ideal: RecordedIdeal, x: int, y: int):
        self.ideal, self.x, self.y = ideal, x, y
        self.buffers, self._plans = IdealBuffers(1, 1), {}

    def follow(
        self, touch: Touch, passed: tuple[bool, ...], observer: Callable[[], Observer]
    ) -> list[Observer]:
        """Do what a command of the machine did. Returns an observer for each of its fragments.

        ``touch``: the machine's Touch; ``passed``: which of its fragments were written.
        """
        number = touch.step.number
        command = self.ideal.commands[number]
        if (at_once := _AT_ONCE.get(type(command))) is not None:
            at_once(replace(command, scissor=None), self.buffers)
            return []
        draw = self._draw if type(command) is Draw else self._rectangle
        return draw(command, self.ideal.textures[number], touch, passed, observer)

    def color(self, which: ColorBuffer = ColorBuffer.BACK) -> tuple[float, ...]:
        """The pixel's colour now."""
        return tuple(self.buffers.buffer(which).color[0, 0].tolist())

    def _draw(self, command, textures, touch, passed, observer):
        frame, seen = self.ideal.frame, []
        state, textures = depths_as_colors(command.state, textures, IDEAL)
        primitives = primitives_of(command, frame.profile, frame.width, frame.height)
        mesh = mesh_of(primitives, state.line, frame.profile)
        plan = plan_for(state, textures, self._plans)
        target = self.buffers.buffer(state.draw_buffer)
        shares = touch.covered or (0,) * len(passed)
        samples = len(frame.profile.primitives.smoothing_samples)
        for triangle, written, covered in zip(touch.triangles, passed, shares, strict=True):
            where = (triangle, self.x, self.y)
            where = tuple(np.array([value], np.int32) for value in where)
            seen.append(observe := observer())
            observe("textures", levels=_levels(state, textures))
            with np.errstate(all="ignore"):
                weights = weigh(mesh, state.polygon.front_face, *where)
                color, _ = shade(state, textures, primitives, plan, weights, observe)
            if covered:
                color[:, 3] *= covered / samples
            observe("source", color=color, stored=target.color[0, 0].copy())
            if written:
                write(state, target, np.zeros(1, np.int64), color, np.zeros(1))
            observe("written", color=target.color[0, 0].copy())
        return seen

    def _rectangle(self, command, textures, touch, passed, observer):
        number = touch.step.number
        state, textures = depths_as_colors(without_footprints(command.state), textures, IDEAL)
        source = self.ideal.sources[number]
        if source is None:
            source = _Size(self.ideal.frame.width, self.ideal.frame.height)
        alone = replace(command.state, scissor=touch.alone.scissor)
        found = rectangle(replace(command, state=alone), source, deepcopy(touch.step.statistics))
        if found is None or found.stencil is not None:
            return [observer() for _ in touch.fragments]
        target, observe = self.buffers.buffer(state.draw_buffer), observer()
        observe("textures", levels=_levels(state, textures))
        color = shade_rectangle(found, state, textures, self._plans, observe)
        observe("source", color=color, stored=target.color[0, 0].copy())
        if any(passed):
            write(state, target, np.zeros(1, np.int64), color, np.zeros(1))
        observe("written", color=target.color[0, 0].copy())
        return [observe]


def _levels(state, textures):
    """The real texels of each texture unit that reads a texture, one array a level."""
    return {
        number: sampled_texture(unit, textures).ideal
        for number, unit in enumerate(state.texture_units)
        if unit is not None and unit.texture is not None
    }


class _Size:
    """The size of buffers, for a command that reads nothing else from them."""

    def __init__(self, width, height):
        self.depth = np.empty((height, width), np.uint8)


_AT_ONCE = {Clear: clear, Saturate: saturate, Accum: accumulate}
