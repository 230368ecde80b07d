"""The IDEAL evaluator: the same passes in float64, without rounding and without clamps but the algorithm's
own.

docs/decisions/0001-ideal-evaluator.md says which steps stay, which go, and why. Coverage alone is the
machine's: the fragments are those of the snapped vertices.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

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
    ResetHistogram,
    ResetMinmax,
    Saturate,
    TexImage,
)
from fixedpipe.pipeline.framebuffers.result import Result
from fixedpipe.pipeline.framebuffers.texture_copies import defined_texture
from fixedpipe.pipeline.framebuffers.transfer import PixelStatistics
from fixedpipe.pipeline.ideal.buffers import IdealBuffers, accumulate, clear, read_pixels, saturate
from fixedpipe.pipeline.ideal.per_fragment import write, write_tested, writes_color, writes_depth
from fixedpipe.pipeline.ideal.primitives import check_primitives, primitives_of
from fixedpipe.pipeline.ideal.rectangles import draw_rectangle
from fixedpipe.pipeline.ideal.result import IdealResult
from fixedpipe.pipeline.ideal.shade import plan_for, shade
from fixedpipe.pipeline.ideal.textures import copied_texture, replaced_texture, texture_pixels, with_ideal
from fixedpipe.pipeline.ideal.weights import fragments_of, mesh_of, pixels_of, share_covered, weigh
from fixedpipe.pipeline.multi_draw import MultiDraw
from fixedpipe.pipeline.native.coverage import rasterize
from fixedpipe.pipeline.native.threads import Threads, default_threads
from fixedpipe.pipeline.profiles import IDEAL
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.programs.texture_shader_rules import killing_units
from fixedpipe.pipeline.textures.depths_as_colors import depths_as_colors
from fixedpipe.pipeline.validation.frames import frame_of
from fixedpipe.pipeline.validation.validate import ValidFrame, begun, validate
from fixedpipe.pipeline.vertices.view_volume import within_viewport

# How many fragments are shaded together, and how many such chunks a thread shades before they are written.
# The numbers keep results in the cache, and change no value.
_CHUNK, _AT_ONCE = 1 << 13, 2

_DRAWING = (Draw, DrawPixels, CopyPixels, Bitmap)


def _draw(command, written, textures, plans, size, depth_bits, guide, threads):
    """Shade a Draw's fragments with all threads, and write them in order.

    ``guide``: a machine and its Fragments. Then the fragments are those that passed there; without a guide
    they are the ideal's own coverage.
    """
    guided = guide is not None
    state, textures = depths_as_colors(command.state, textures, IDEAL)
    machine: Profile = IDEAL
    record: Any = None
    if guided:
        machine, record = guide
    primitives = primitives_of(command, machine, size[0], size[1], record)
    if guided:
        check_primitives(command, record, primitives, machine)
        if not (writes_color(state) or writes_depth(state)) or not record.passed.any():
            return
    else:
        # Coverage reads no colours, and its kernels take bytes.
        uncolored = replace(primitives, colors=np.zeros(primitives.colors.shape, np.uint8))
        scissor = within_viewport(command.mesh, state, *size).scissor
        record = rasterize(uncolored, IDEAL, state.polygon, scissor, *size, line=state.line)
    tests_alpha = state.alpha_test is not None and not guided
    ends = state.texture_shader is not None or bool(killing_units(state))
    colored = writes_color(state) or tests_alpha or ends
    deep = writes_depth(state) if guided else state.depth_test is not None
    mesh, width = mesh_of(primitives, state.line, machine), size[0]
    plan = plan_for(state, textures, plans)

    def shaded(part):
        """Pixels, colours and depths of the fragments that live, in a slice of the record."""
        where = fragments_of(record, part, guided)
        weights = weigh(mesh, state.polygon.front_face, *where)
        color, z, outcome = np.zeros((0, 4)), np.zeros(0), None
        if colored:
            color, outcome = shade(state, textures, primitives, plan, weights)
            share = share_covered(record, part, guided, len(machine.primitives.smoothing_samples))
            if share is not None:
                color[:, 3] *= share
        if deep:
            z = weights.depths(primitives.z, state.polygon, depth_bits)
        pixel = pixels_of(where, width)
        if outcome is None:
            return pixel, color, z
        if outcome.depth is not None:
            z = outcome.depth
        if guided or outcome.alive.all():
            return pixel, color, z
        return pixel[outcome.alive], color[outcome.alive], z[outcome.alive] if deep else z

    def share(number):
        # Derivatives of projections may overflow; later steps treat them as not finite.
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            for k in range(number, len(parts), threads.count):
                done[k] = shaded(parts[k])
        return 0

    chunks = [slice(k, k + _CHUNK) for k in range(0, len(record.triangle), _CHUNK)]
    for first in range(0, len(chunks), _AT_ONCE * threads.count):
        parts = chunks[first : first + _AT_ONCE * threads.count]
        done: list[Any] = [None] * len(parts)
        if len(parts) < threads.count:
            for number in range(len(parts)):  # waking threads costs more than a few hundred fragments
                share(number)
        else:
            threads.run(share)
        for fragments in done:
            (write if guided else write_tested)(state, written, *fragments)


def _drew_otherwise(guide, draws):
    return ValueError(
        f"The guide drew {len(guide.records)} times and these commands draw {draws} times; guide a frame by "
        "the machine's run of the same passes."
    )


def _check_guide(guide, commands, width, height):
    if not isinstance(guide, Result):
        raise ValueError(
            f"The guide is of type {type(guide).__name__}; give the Result of execute(..., record=True)."
        )
    draws = sum(type(c) in _DRAWING for c in commands)
    if draws and not guide.records:
        raise ValueError("The guide holds no fragments; run it as execute(..., record=True).")
    # Only while it runs does a HostStep show how often it draws.
    if len(guide.records) != draws and not any(isinstance(c, HostStep) for c in commands):
        raise _drew_otherwise(guide, draws)
    shape = guide.framebuffer.depth.shape
    if shape != (height, width):
        raise ValueError(
            f"The guide's framebuffer is {shape[1]}x{shape[0]} pixels and this one {width}x{height}; give "
            "both runs the same size."
        )


class _Evaluation:
    """A frame in progress: buffers, textures, pixels read so far, and the commands still to come."""

    def __init__(self, commands, width, height, guide, depth_bits, threads, watch):
        self.watch = watch
        self.width, self.height, self.depth_bits = width, height, depth_bits
        self.guide, self.drawn, self.threads = guide, 0, threads
        self.buffers, self.pixels = IdealBuffers(width, height), {}
        self.textures: dict[str, Any] = {}  # each Texture holds its real texels
        self.patched = {}  # images of levels that were copied before their first partial replacement
        self.plans = {}  # by the program's id; the plan keeps the program alive
        self.statistics = PixelStatistics()
        held = width, height, depth_bits, self.textures, None, self.statistics
        self.valid = ValidFrame(commands, lambda read: begun(IDEAL, *held, read))

    def run(self):
        """Run all commands, and return the IdealResult."""
        waiting = self.valid.waiting
        while waiting:
            command = waiting.popleft()
            OPERATIONS[type(command)](self, command)
            if self.watch is not None:
                self.watch(command, self.buffers.drawn_to(command).color)
        guide, buffers, statistics = self.guide, self.buffers, self.statistics
        depth, stencil = buffers.depth, buffers.stencil
        if guide is not None:
            if self.drawn != len(guide.records):
                raise _drew_otherwise(guide, self.drawn)
            depth = guide.framebuffer.depth / (2.0**guide.framebuffer.depth_bits - 1.0)
            stencil = guide.framebuffer.stencil.copy()
        return IdealResult(
            buffers.color,
            depth,
            stencil,
            self.textures,
            self.pixels,
            statistics.histograms,
            statistics.minmaxes,
        )

    def next_record(self):
        """The guide's Fragments of the next command that draws; None: there is no guide."""
        self.drawn += 1
        if self.guide is None:
            return None
        if self.drawn > len(self.guide.records):
            raise _drew_otherwise(self.guide, self.drawn)
        return self.guide.records[self.drawn - 1]

    def clear(self, command):
        clear(command, self.buffers.buffer(command.draw_buffer))

    def draw(self, command):
        written = self.buffers.buffer(command.state.draw_buffer)
        size, record = (self.width, self.height), self.next_record()
        guide = None if record is None else (self.guide.profile, record)
        given = self.textures, self.plans, size, self.depth_bits, guide, self.threads
        _draw(command, written, *given)

    def rectangle(self, command):
        given = self.textures, self.plans, self.statistics, self.next_record()
        draw_rectangle(command, self.buffers, *given)

    def tex_image(self, command):
        if command.pixels is None:
            self.textures[command.texture] = with_ideal(command.image)
        else:
            before = self.textures.get(command.texture)
            made = defined_texture(command, IDEAL, self.statistics, before)
            self.textures[command.texture] = with_ideal(made)

    def copy_tex_image(self, command):
        source = self.buffers.buffer(command.read_buffer)
        before = self.textures.get(command.texture)
        made = copied_texture(command, source, self.statistics, before)
        self.textures[command.texture] = with_ideal(made)

    def copy_tex_sub_image(self, command):
        source, texture = self.buffers.buffer(command.read_buffer), self.textures[command.texture]
        level, patched = texture.ideal[command.level], self.patched.get((command.texture, command.level))
        replaced = replaced_texture(command, texture, source, self.statistics, own=level is patched)
        if replaced is None:
            return
        self.textures[command.texture] = replaced = with_ideal(replaced)
        if not command.generate_mipmap:
            self.patched[command.texture, command.level] = replaced.ideal[command.level]

    def read_pixels(self, command):
        source = self.buffers.buffer(command.read_buffer)
        read = read_pixels(command, source, self.guide, self.statistics)
        if read is not None:
            self.pixels[command.name] = read

    def get_tex_image(self, command):
        read = texture_pixels(self.textures[command.texture], command, self.statistics)
        if read is not None:
            self.pixels[command.name] = read

    def host_step(self, command):
        self.valid.issue(command, self.pixels)

    def saturate(self, command):
        saturate(command, self.buffers.buffer(command.draw_buffer))

    def accum(self, command):
        accumulate(command, self.buffers)

    def only_the_window(self, command):
        """MakeCurrent may only name the window, which is already current: validation refuses all pbuffers."""

    def reset_histogram(self, command):
        self.statistics.reset_histogram(command.name)

    def reset_minmax(self, command):
        self.statistics.reset_minmax(command.name)


OPERATIONS = {
    Clear: _Evaluation.clear,
    Draw: _Evaluation.draw,
    TexImage: _Evaluation.tex_image,
    CopyTexImage: _Evaluation.copy_tex_image,
    CopyTexSubImage: _Evaluation.copy_tex_sub_image,
    ReadPixels: _Evaluation.read_pixels,
    GetTexImage: _Evaluation.get_tex_image,
    HostStep: _Evaluation.host_step,
    Saturate: _Evaluation.saturate,
    Accum: _Evaluation.accum,
    DrawPixels: _Evaluation.rectangle,
    CopyPixels: _Evaluation.rectangle,
    Bitmap: _Evaluation.rectangle,
    MakeCurrent: _Evaluation.only_the_window,
    BindTexImage: _Evaluation.only_the_window,
    ResetHistogram: _Evaluation.reset_histogram,
    ResetMinmax: _Evaluation.reset_minmax,
}


def execute_ideal(
    commands: Iterable[Command | MultiDraw],
    width: int,
    height: int,
    *,
    guide: Result | None = None,
    depth_bits: int | None = None,
    threads: int | None = None,
    trace: Callable[[Command, NDArray[np.float64]], None] | None = None,
) -> IdealResult:
    """Run ``commands`` in float64 on a framebuffer of width x height pixels, and return an IdealResult.

    guide       None (free mode): the ideal makes its own alpha, stencil and depth tests. Otherwise (guided
                mode) a Result of ``execute(..., record=True)`` for the corresponding commands. Then the ideal
                evaluates colours for exactly the fragments that the machine wrote. Depth and stencil are the
                machine's, so the difference of the two pictures is arithmetic alone. Depths that are copied
                to textures are these fragments' exact ones
    depth_bits  the depth buffer whose smallest step is the unit of polygon offset (free mode); None: 24
    threads     how many threads shade fragments; None: one per processor
    trace       a function that is called after every command, with the command and the colours that it draws
                to: float64 [h, w, 4], top row first, as in an IdealResult. They are valid until the next
                command runs

    Raises UnsupportedState or ValueError as ``validate`` does, and ValueError if the guide does not fit.
    """
    commands = frame_of(commands)
    depth_bits = IDEAL.widest_depth if depth_bits is None else depth_bits
    validate((), IDEAL, width, height, depth_bits)
    shared = Threads(threads or default_threads())
    evaluation = _Evaluation(commands, width, height, guide, depth_bits, shared, trace)
    if guide is not None:
        _check_guide(guide, commands, width, height)
    return evaluation.run()


def evaluate_watched(commands, width, height, guide, depth_bits, watch):
    """Run ``commands`` guided, as ``execute_ideal`` does, and call ``watch`` after every command.

    ``watch(command, textures, buffers)`` receives the textures by name and the IdealBuffers. Each texture
    stays as it is; the buffers do not.
    """
    commands = frame_of(commands)
    _check_guide(guide, commands, width, height)

    def seen(command, colors):
        evaluation.patched.clear()  # the next CopyTexSubImage copies the level that it changes
        watch(command, evaluation.textures, evaluation.buffers)

    shared = Threads(default_threads())
    evaluation = _Evaluation(commands, width, height, guide, depth_bits, shared, seen)
    return evaluation.run()
