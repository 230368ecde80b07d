"""One pixel of a recorded frame, drawn once more by the column engine while an observer watches."""

from collections.abc import Callable, Iterator
from copy import deepcopy
from dataclasses import dataclass, replace
from numbers import Integral
from typing import Any

import numpy as np
from numpy.lib.stride_tricks import as_strided
from numpy.typing import NDArray

from fixedpipe.pipeline.columns.engine import column_draw
from fixedpipe.pipeline.columns.rectangles import draw_rectangle
from fixedpipe.pipeline.commands import (
    Accum,
    Bitmap,
    Clear,
    CopyPixels,
    Draw,
    DrawPixels,
    Saturate,
)
from fixedpipe.pipeline.enums import AccumOperation, ColorBuffer
from fixedpipe.pipeline.framebuffers.accumulation import accumulate, clear_accumulation
from fixedpipe.pipeline.framebuffers.bounds import scissored
from fixedpipe.pipeline.framebuffers.framebuffer import Framebuffer
from fixedpipe.pipeline.framebuffers.multisample import SAMPLE_POSITIONS, mean, sampled
from fixedpipe.pipeline.inspection.recording import RecordedFrame, Step
from fixedpipe.pipeline.native.coverage import Covered, covered_pixels, covered_triangles
from fixedpipe.pipeline.profiles.profile import NATIVE_SUBPIXEL_BITS
from fixedpipe.pipeline.state import PassState, Scissor
from fixedpipe.pipeline.textures.depths_as_colors import depths_as_colors
from fixedpipe.pipeline.vertices import stage
from fixedpipe.pipeline.vertices.view_volume import within_viewport

Observer = Callable[..., None]


@dataclass(frozen=True)
class PixelValue:
    """What a pixel holds: ``color``, RGBA codes in units of 2**bits - 1, its depth word, and its stencil
    value.
    """

    color: tuple[int, int, int, int]
    depth: int
    stencil: int


class PixelBuffers:
    """A window, a pbuffer, or one of the window's samples, of which only one pixel exists. It begins empty.

    ``one``         a framebuffer of 1 x 1 pixels
    ``everywhere``  the same memory as a framebuffer of full size: each of its pixels is this one
    """

    def __init__(
        self, like: Framebuffer, accumulation: NDArray[np.int32], sharing: "PixelBuffers | None" = None
    ):
        """``sharing``: other buffers, whose depth and stencil value these share."""
        new = np.zeros((1, 1, 4), like.color.dtype)
        depth, stencil = np.full((1, 1), 2**like.depth_bits - 1, np.uint32), np.zeros((1, 1), np.uint8)
        if sharing is not None:
            depth, stencil = sharing.one.depth, sharing.one.stencil
        colors = {which: new.copy() for which in ColorBuffer}

        def seen(plane):
            return as_strided(plane, (like.height, like.width, *plane.shape[2:]), (0, 0, *plane.strides[2:]))

        self.one = self._framebuffer(like, colors, depth, stencil, accumulation)
        wide = {which: seen(color) for which, color in colors.items()}
        self.everywhere = self._framebuffer(like, wide, seen(depth), seen(stencil), accumulation)

    @staticmethod
    def _framebuffer(like, colors, depth, stencil, accumulation):
        planes = {"depth": depth, "stencil": stencil, "accumulation": accumulation}
        auxiliary = {
            which: replace(like, color=color, _auxiliary={}, **planes) for which, color in colors.items()
        }
        back = colors[ColorBuffer.BACK]
        return replace(like, color=back, _auxiliary=auxiliary, **planes)

    def value(self, which: ColorBuffer = ColorBuffer.BACK) -> PixelValue:
        """What the pixel holds."""
        held = self.one.buffer(which)
        color = held.color[0, 0].tolist()
        return PixelValue(tuple(color), int(held.depth[0, 0]), int(held.stencil[0, 0]))


@dataclass(frozen=True, eq=False)
class Touch:
    """A command that touched the pixel.

    step           the Step
    sample         the number of the window's sample; 0 if there is one
    before, after  PixelValues of the buffer that it draws to
    fragments      an observer for each fragment (``ReplayedPixel.run``)
    triangles      for a Draw, the primitive of each fragment
    covered        for a Draw, how many samples each fragment covers; empty if no primitive is smooth
    passed         whether each fragment passed all tests
    alone          its state, with this pixel alone in the scissor box; None: it has no state
    """

    step: Step
    sample: int
    before: PixelValue
    after: PixelValue
    fragments: tuple[Any, ...]
    triangles: tuple[int, ...] = ()
    passed: tuple[bool, ...] = ()
    alone: PassState | None = None
    covered: tuple[int, ...] = ()

    @property
    def changes_depths(self) -> bool:
        """Whether the command changed the depth or the stencil value."""
        before, after = self.before, self.after
        return (before.depth, before.stencil) != (after.depth, after.stencil)


class ReplayedPixel:
    """Pixel (x, y) of a RecordedFrame's window or pbuffer, x to the right and y downwards from the top left.

    Framebuffers that share their depths share this pixel's depth too, so commands that draw to them count.

    Raises ValueError for a pixel outside, and for a pbuffer that does not exist.
    """

    def __init__(
        self,
        frame: RecordedFrame,
        x: int,
        y: int,
        surface: str | None = None,
        _first: "ReplayedPixel | None" = None,
    ):
        shown = frame.shown(surface)
        for name, value in (("x", x), ("y", y)):
            if not isinstance(value, Integral):
                raise ValueError(f"The pixel's {name} is {value!r}; give a whole number.")
        if not (0 <= x < shown.width and 0 <= y < shown.height):
            raise ValueError(
                f"Pixel ({x}, {y}) lies outside: this framebuffer is {shown.width}x{shown.height} pixels, "
                f"(0, 0) to ({shown.width - 1}, {shown.height - 1}), counted from the top left."
            )
        self.frame, self.x, self.y, self.surface, self._shown = frame, x, y, surface, shown
        positions = SAMPLE_POSITIONS[frame.samples if surface is None else shown.samples]
        accumulation = np.zeros((1, 1, 4), np.int32)
        shared = [None] * len(positions) if _first is None else [buffers for buffers, _ in _first._targets]
        self._targets = [
            (PixelBuffers(shown, accumulation, sharing), position)
            for sharing, position in zip(shared, positions, strict=True)
        ]
        one = len(positions) == 1
        self._window = self._targets[0][0] if one else PixelBuffers(shown, accumulation)
        self._sharing = {surface: self}
        for other in () if _first else frame.sharing(surface):
            there = frame.shown(other)
            if other != surface and x < there.width and y < there.height:
                self._sharing[other] = ReplayedPixel(frame, x, y, other, self)

    def run(self, observer: Callable[[], Observer]) -> Iterator[Touch]:
        """Yield a Touch for every command, and sample, that touched the pixel, in order.

        A command that drew to another framebuffer counts if it changed the shared depth or stencil value.

        ``observer`` makes a fragment's observer before the fragment is drawn; the Touch holds it.
        """
        for step in self.frame.steps:
            draw, pixel = _DRAWING.get(type(step.command)), self._sharing.get(step.surface)
            if draw is None or pixel is None:
                continue
            for touch in draw(pixel, step, step.command, observer):
                if pixel is self or touch.changes_depths:
                    yield touch

    def check(self) -> None:
        """Raise AssertionError if the pixel differs from what the frame left in it."""
        where, first = (self.y, self.x), self._targets[0][0].one
        for which in ColorBuffer:
            self._agrees(
                which.name, self._window.one.buffer(which).color, self._shown.buffer(which).color[where]
            )
        self._agrees("depth", first.depth, self._shown.depth[where])
        self._agrees("stencil", first.stencil, self._shown.stencil[where])

    def _agrees(self, plane, drawn, shown):
        if (drawn[0, 0] != shown).any():  # no assert statement: -O would remove it
            raise AssertionError(
                f"Pixel ({self.x}, {self.y}), {plane}: {drawn[0, 0]} when drawn again, {shown} in the frame."
            )

    def value(self) -> PixelValue:
        """What the pixel holds now. With several samples: the mean of their colours, and the first one's
        depth.
        """
        first = self._targets[0][0].value()
        return replace(first, color=self._window.value().color)

    # Each of the following takes the Step, its command and ``run``'s observer.

    def _inside(self, box):
        x0, y0, x1, y1 = scissored(box, self._shown.width, self._shown.height)
        return x0 <= self.x < x1 and y0 <= self.y < y1

    def _alone(self, state):
        """The state, with this pixel alone inside the scissor box."""
        return replace(state, scissor=Scissor(self.x, self._shown.height - 1 - self.y, 1, 1))

    def _resolve(self, which):
        """Set the window's colours from its samples."""
        if len(self._targets) > 1:
            colors = [buffers.one.buffer(which).color for buffers, _ in self._targets]
            self._window.one.buffer(which).color[...] = mean(colors)

    def _on_each(self, step, which, change, alone=None):
        """Yield a Touch of each sample that ``change(buffers, position)`` changes.

        ``change`` returns the fragments' observers, their primitives, whether they passed, and optionally how
        many samples they cover. It returns None if there is no fragment.
        """
        for sample, (buffers, position) in enumerate(self._targets):
            before = buffers.value(which)
            made = change(buffers, position)
            if made is not None:
                fragments, triangles, passed, *covered = map(tuple, made)
                after = buffers.value(which)
                yield Touch(step, sample, before, after, fragments, triangles, passed, alone, *covered)
        self._resolve(which)

    def _clear(self, step, command, observer):
        if not self._inside(command.scissor):
            return
        whole = replace(command, scissor=None)

        def change(buffers, position):
            buffers.one.buffer(command.draw_buffer).clear(whole)
            return (), (), ()

        if command.accumulation is not None:
            clear_accumulation(self._window.one, whole, self.frame.profile)
        yield from self._on_each(step, command.draw_buffer, change)

    def _draw(self, step, command, observer):
        profile, size = self.frame.profile, (self._shown.width, self._shown.height)
        state = within_viewport(command.mesh, command.state, *size)
        if not self._inside(state.scissor):
            return
        state, textures = depths_as_colors(state, step.textures, profile)
        alone = self._alone(state)

        def change(buffers, position):
            several = len(self._targets) > 1
            shift, sample = sampled(position if several else None, profile)
            primitives = stage.process(command.mesh, state, profile, *size, shift, rounded=False)
            target = buffers.everywhere.buffer(state.draw_buffer)
            if profile.arithmetic.subpixel_bits == NATIVE_SUBPIXEL_BITS:
                covered, _ = covered_pixels(primitives, alone, profile, *size, sample)
            else:
                covered = covered_triangles(primitives, alone, profile, target)
            if not len(covered.triangle):
                return None
            seen, passed = [], []

            def observe(name, /, **columns):
                seen[-1](name, **columns)

            for k in range(len(covered.triangle)):
                seen.append(observer())
                observe("primitives", primitives=primitives)
                row = int(covered.triangle[k])
                observe("vertices", mesh=command.mesh, state=state, primitives=primitives, triangle=row)
                columns = covered.triangle, covered.x, covered.y, covered.covered
                one = Covered(*(c if c is None else c[k : k + 1] for c in columns))
                passed += column_draw(primitives, one, state, profile, target, textures, observe).tolist()
            shares = () if covered.covered is None else covered.covered.tolist()
            return seen, covered.triangle.tolist(), passed, shares

        yield from self._on_each(step, state.draw_buffer, change, alone)

    def _rectangle(self, step, command, observer):
        state = command.state
        if not self._inside(state.scissor):
            return
        alone = replace(command, state=self._alone(state))
        read = self._shown if step.source is None else step.source

        def change(buffers, position):
            observe, statistics = observer(), deepcopy(step.statistics)
            given = step.textures, statistics, observe
            drawn = draw_rectangle(alone, self.frame.profile, read, [buffers.everywhere], *given)
            passed = [bool(each) for some in drawn for each in some.passed]
            return ([observe], (), passed) if passed else None

        yield from self._on_each(step, state.draw_buffer, change, alone.state)

    def _saturate(self, step, command, observer):
        if not self._inside(command.scissor):
            return
        whole = replace(command, scissor=None)

        def change(buffers, position):
            target = buffers.one.buffer(command.draw_buffer)
            if target.is_bytes:
                return None
            target.saturate(whole)
            return (), (), ()

        yield from self._on_each(step, command.draw_buffer, change)

    def _accum(self, step, command, observer):
        if not self._inside(command.scissor):
            return
        whole, profile = replace(command, scissor=None), self.frame.profile
        if command.operation != AccumOperation.RETURN:
            value = self._window.value(command.read_buffer)
            accumulate(self._window.one, whole, profile)
            yield Touch(step, 0, value, value, ())
            return

        def change(buffers, position):
            accumulate(buffers.one, whole, profile)
            return (), (), ()

        yield from self._on_each(step, command.draw_buffer, change)


_DRAWING = {
    Clear: ReplayedPixel._clear,
    Draw: ReplayedPixel._draw,
    DrawPixels: ReplayedPixel._rectangle,
    CopyPixels: ReplayedPixel._rectangle,
    Bitmap: ReplayedPixel._rectangle,
    Saturate: ReplayedPixel._saturate,
    Accum: ReplayedPixel._accum,
}
