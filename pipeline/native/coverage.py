"""Fragments of primitives that nothing is drawn of: the pixels that they cover."""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from fixedpipe.pipeline.enums import ComparisonFunction, Face, FrontFace
from fixedpipe.pipeline.framebuffers.bounds import scissor_box, scissored
from fixedpipe.pipeline.framebuffers.framebuffer import Framebuffer
from fixedpipe.pipeline.framebuffers.result import Fragments
from fixedpipe.pipeline.native.background_compiling import covers_by_kernels
from fixedpipe.pipeline.native.pack_fragments import asks_for_depth
from fixedpipe.pipeline.native.prepared_draw import Prepared
from fixedpipe.pipeline.native.queue import BATCH, buffers_of
from fixedpipe.pipeline.native.recording import recorded_fragments
from fixedpipe.pipeline.state import ColorMask, DepthTest, LineState, PassState
from fixedpipe.raster.columns import interpolate
from fixedpipe.raster.primitives.vertices import W_LARGEST, W_SMALLEST


@dataclass(frozen=True, eq=False)
class Covered:
    """Pixels of primitives, int64 [k] each, in draw order per pixel; ``covered`` is that of Fragments."""

    triangle: np.ndarray
    x: np.ndarray
    y: np.ndarray
    covered: np.ndarray | None = None


def covered_triangles(primitives, state, profile, framebuffer):
    """Coverage of triangles with any number of subpixel bits: a Covered, culled and scissored (section 3)."""
    return _covered(primitives, state.polygon, scissor_box(state, framebuffer), profile)


def _covered(primitives, polygon, box, profile):
    p, parts = primitives, []
    for number, row in enumerate(p.triangles[:, :3]):
        x, y, w = (column[row].tolist() for column in (p.x, p.y, p.inverse_w))
        area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0])
        turned = sum(w_i < 0.0 for w_i in w) & 1
        front = ((area < 0) != turned) == (polygon.front_face == FrontFace.CCW)
        culled = polygon.cull_face in (Face.FRONT_AND_BACK, Face.FRONT if front else Face.BACK)
        usual = all(W_SMALLEST <= abs(w_i) <= W_LARGEST for w_i in w)
        if area == 0 or culled or not usual:
            continue
        px, py = interpolate.covered_pixels(x, y, w, box, profile.arithmetic.subpixel_bits)
        parts.append((np.full(len(px), number), px, py))
    if not parts:
        return Covered(*(np.zeros(0, np.int64) for _ in range(3)))
    return Covered(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def covered_pixels(primitives, state, profile, width, height, sample=None):
    """The pixels that a state's primitives cover, whatever they write: (Fragments, primitives dropped).

    ``primitives`` may have any colours, because coverage reads none. ``sample`` is that of ``pack_coverage``.
    """
    by_middles = sample in (None, (0, 0)) and not (state.polygon.smooth or state.line.smooth)
    if state.window_clip is None and by_middles and _without_kernels(primitives, state.polygon):
        box = scissored(state.scissor, width, height)
        return _covered(primitives, state.polygon, box, profile), primitives.dropped
    uncolored = replace(primitives, colors=np.zeros((len(primitives.x), 2, 8), np.uint8))
    polygon = replace(state.polygon, offset_fill=False, offset_line=False, offset_point=False)
    # With w as depth, pixels outside their triangle also need w's weights, so a depth test that never passes
    # is enabled to compute them.
    tests = state.w_buffering and not by_middles and asks_for_depth(state)
    plain = PassState(
        polygon=polygon,
        line=state.line,
        point=state.point,
        scissor=state.scissor,
        window_clip=state.window_clip,
        depth_test=DepthTest(ComparisonFunction.NEVER, write=False) if tests else None,
        w_buffering=tests,
        color_mask=ColorMask(False, False, False, False),
    )
    framebuffer = _unwritten(width, height)
    prepared = Prepared.of(uncolored, plain, profile, framebuffer, {}, sample)
    drawn, smooth = (
        recorded_fragments(prepared, buffers_of(framebuffer), BATCH),
        state.polygon.smooth or state.line.smooth,
    )
    return (drawn if smooth and sample is None else replace(drawn, covered=None)), prepared.dropped


_THIN = LineState()


def rasterize(primitives, profile, polygon, scissor, width, height, *, line=_THIN):
    """Coverage alone: the Fragments of window primitives, culled and scissored, in draw order for each pixel.

    - ``primitives``: from ``fixedpipe.pipeline.vertices.stage.process``: contiguous columns of one length.
      They are not checked again.
    - ``profile``: the machine.
    - ``polygon``: a PolygonState.
    - ``scissor``: a Scissor or None.
    - ``width``, ``height``: of the framebuffer, in pixels.
    - ``line``: the LineState of lines.
    """
    if _without_kernels(primitives, polygon) and not polygon.smooth:
        drawn = _covered(primitives, polygon, scissored(scissor, width, height), profile)
        columns = drawn.triangle, drawn.x, drawn.y, np.ones(len(drawn.x))
        return Fragments(*(column.astype(np.int32) for column in columns))
    state, framebuffer = _coverage_state(polygon, scissor, line), _unwritten(width, height)
    prepared = Prepared.of(primitives, state, profile, framebuffer, {})
    return recorded_fragments(prepared, buffers_of(framebuffer), BATCH)


def _without_kernels(primitives, polygon):
    """Whether coverage uses no compiled kernel, and the triangles are whole and none is dropped."""
    whole = not len(primitives.strokes) and polygon.stipple is None
    return whole and primitives.orderly and not covers_by_kernels()


@lru_cache(maxsize=64)
def _coverage_state(polygon, scissor, line):
    """A state that draws nothing; a cached object, so that its rows are packed once."""
    nothing = ColorMask(False, False, False, False)
    polygon = replace(polygon, offset_fill=False, offset_line=False, offset_point=False)
    return PassState(polygon=polygon, line=line, scissor=scissor, color_mask=nothing)


@lru_cache(maxsize=2)
def _unwritten(width, height):
    """A framebuffer for states that write nothing."""
    return Framebuffer.new(width, height)
