"""Row entries without combiners and texture units: culling, lines, coverage, fog, tests, blending."""

import numpy as np

from fixedpipe.pipeline.enums import (
    BlendEquation,
    BlendFactor,
    ColorFormat,
    ComparisonFunction,
    Face,
    FogArithmetic,
    FogMode,
    FrontFace,
    LineRasterization,
    LogicOperation,
    Register,
    StencilOperation,
)
from fixedpipe.pipeline.framebuffers.bounds import device_edges
from fixedpipe.pipeline.framebuffers.framebuffer import SURFACE_WORDS, color_codes, to_code
from fixedpipe.pipeline.programs.fog import fog_thresholds
from fixedpipe.pipeline.textures.depth_words import DEPTH_WORDS
from fixedpipe.pipeline.vertices.fog import folds, table
from fixedpipe.pipeline.vertices.strokes import whole_size
from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.columns.numbers import convert, one_of

_NO_FOG = np.zeros(255, np.float64)


def pack_fog(state, profile, used, draw):
    """Write fog's entries; returns its thresholds or table, or zeros."""
    if Register.FOG not in used or state.fog is None:
        return _NO_FOG
    one = one_of(int(draw[R.BITS]))
    draw[R.FOG_RED : R.FOG_BLUE + 1] = color_codes(state.fog.color, one)[:3]
    if profile.arithmetic.fog_arithmetic == FogArithmetic.TABLE:
        draw[R.FOG_ENABLED] = C.FOG_BY_TABLE
        factors = table(state.fog.mode, folds(state.fog))
        if one == 255:
            return factors.copy()  # kernels take only writable arrays
        return convert(factors.astype(np.int64), 255, one).astype(np.float64)
    draw[R.FOG_ENABLED] = C.FOG_BY_THRESHOLDS
    draw[R.FOG_RISING] = state.fog.mode == FogMode.LINEAR and state.fog.start > state.fog.end
    return fog_thresholds(state.fog, one).copy()


def _pack_stencil_operation(operation, reference):
    return {
        StencilOperation.KEEP: (255, 0, 0, 0, 255),
        StencilOperation.ZERO: (0, 0, 0, 0, 255),
        StencilOperation.REPLACE: (0, reference, 0, 0, 255),
        StencilOperation.INCR: (255, 0, 1, 0, 255),
        StencilOperation.DECR: (255, 0, -1, 0, 255),
        StencilOperation.INVERT: (255, 255, 0, 0, 255),
        StencilOperation.INCR_WRAP: (255, 0, 1, -1, 256),
        StencilOperation.DECR_WRAP: (255, 0, -1, -1, 256),
    }[operation]


def _tests_depth(test):
    return test is not None and (test.function != ComparisonFunction.ALWAYS or test.write)


def asks_for_depth(state):
    """Whether a state's fragments need depths."""
    limits = state.depth_clamp
    return _tests_depth(state.depth_test) or (limits is not None and bool(limits.cull))


def _pack_depth(state, profile, framebuffer, draw, draw_float):
    words, test, polygon = DEPTH_WORDS[framebuffer.depth_format], state.depth_test, state.polygon
    draw[R.DEPTH_FORMAT], draw[R.DEPTH_MAX] = words.code, words.largest
    draw_float[R.DEPTH_HIGH] = words.farthest
    limits = state.depth_clamp
    if limits is not None:
        draw_float[R.DEPTH_LOW] = limits.minimum
        if limits.maximum is not None:
            draw_float[R.DEPTH_HIGH] = limits.maximum
        draw[R.DEPTH_CULL] = limits.cull
    if not asks_for_depth(state):
        return
    tests = _tests_depth(test)
    draw[R.NEEDS_DEPTH] = 1
    draw[R.DEPTH_FUNCTION] = test.function if tests else ComparisonFunction.ALWAYS
    draw[R.DEPTH_WRITE] = tests and test.write
    draw[R.W_BUFFERING] = state.w_buffering
    if polygon.offset_factor or polygon.offset_units:
        draw[R.POLYGON_OFFSET] = polygon.offset_fill
        draw[R.OFFSET_FRACTION] = profile.arithmetic.offset_fraction
        draw[R.OFFSET_LINE], draw[R.OFFSET_POINT] = polygon.offset_line, polygon.offset_point
        draw_float[R.OFFSET_FACTOR] = polygon.offset_factor
        draw_float[R.OFFSET_UNITS] = polygon.offset_units


def pack_tests(state, profile, framebuffer, draw, draw_float):
    """Write the entries of alpha, stencil and depth test."""
    if state.alpha_test is not None and state.alpha_test.function != ComparisonFunction.ALWAYS:
        draw[R.ALPHA_TEST] = 1
        draw[R.ALPHA_FUNCTION] = state.alpha_test.function
        draw[R.ALPHA_REFERENCE] = to_code(state.alpha_test.reference, one_of(framebuffer.color_bits))
    stencil = state.stencil_test
    if stencil is not None:
        reference = min(max(stencil.reference, 0), 255)
        draw[R.STENCIL_TEST] = 1
        draw[R.STENCIL_FUNCTION] = stencil.function
        draw[R.STENCIL_REFERENCE] = reference
        draw[R.STENCIL_MASK] = int(stencil.mask)
        draw[R.STENCIL_WRITE_MASK] = int(stencil.write_mask)
        for at, operation in (
            (R.STENCIL_FAIL, stencil.fail),
            (R.STENCIL_DEPTH_FAIL, stencil.depth_fail),
            (R.STENCIL_DEPTH_PASS, stencil.depth_pass),
        ):
            draw[at : at + R.STENCIL_OPERATION_SIZE] = _pack_stencil_operation(operation, reference)
    _pack_depth(state, profile, framebuffer, draw, draw_float)


# A blend factor in bytes: masks of S, D, As, Ad and the saturate term, the constant that it takes, and 255
# for one minus it.
_FACTOR_TERMS = {
    BlendFactor.ZERO: ((0, 0, 0, 0, 0), None, 0),
    BlendFactor.ONE: ((0, 0, 0, 0, 0), None, 255),
    BlendFactor.SRC_COLOR: ((255, 0, 0, 0, 0), None, 0),
    BlendFactor.ONE_MINUS_SRC_COLOR: ((255, 0, 0, 0, 0), None, 255),
    BlendFactor.DST_COLOR: ((0, 255, 0, 0, 0), None, 0),
    BlendFactor.ONE_MINUS_DST_COLOR: ((0, 255, 0, 0, 0), None, 255),
    BlendFactor.SRC_ALPHA: ((0, 0, 255, 0, 0), None, 0),
    BlendFactor.ONE_MINUS_SRC_ALPHA: ((0, 0, 255, 0, 0), None, 255),
    BlendFactor.DST_ALPHA: ((0, 0, 0, 255, 0), None, 0),
    BlendFactor.ONE_MINUS_DST_ALPHA: ((0, 0, 0, 255, 0), None, 255),
    BlendFactor.SRC_ALPHA_SATURATE: ((0, 0, 0, 0, 255), None, 0),
    BlendFactor.CONSTANT_COLOR: ((0, 0, 0, 0, 0), "color", 0),
    BlendFactor.ONE_MINUS_CONSTANT_COLOR: ((0, 0, 0, 0, 0), "color", 255),
    BlendFactor.CONSTANT_ALPHA: ((0, 0, 0, 0, 0), "alpha", 0),
    BlendFactor.ONE_MINUS_CONSTANT_ALPHA: ((0, 0, 0, 0, 0), "alpha", 255),
}


def _pack_factor(factor, color, one):
    masks, constant, xor = _FACTOR_TERMS[factor]
    masks, row = [one if mask else 0 for mask in masks], []
    for channel in range(4):
        term = 0 if constant is None else color[channel if constant == "color" else 3]
        row += [*masks, term, one if xor else 0]
    return row


def pack_writing(state, framebuffer, draw):
    """Write the entries of color mask, surface, logic operation or blending; returns the blend factors."""
    factors = np.zeros((2, 4 * R.FACTOR_SIZE), np.int32)
    mask = state.color_mask
    for channel, on in enumerate((mask.red, mask.green, mask.blue, mask.alpha)):
        draw[R.COLOR_MASK] |= (0xFF if on else 0) << (8 * channel)
    draw[R.SURFACE] = framebuffer.color_format != ColorFormat.A8R8G8B8
    draw[R.SURFACE_KEEP], draw[R.SURFACE_PAD], draw[R.SURFACE_ALPHA] = SURFACE_WORDS[framebuffer.color_format]
    if state.logic_op is not None:
        if state.logic_op != LogicOperation.COPY:
            draw[R.BLEND], draw[R.LOGIC_OPERATION] = C.BLEND_LOGIC, state.logic_op
        return factors
    blending = state.blending
    if blending is None:
        return factors
    source, destination, equation = blending.source, blending.destination, blending.equation
    if equation == BlendEquation.FUNC_ADD and source == BlendFactor.ONE:
        if destination == BlendFactor.ZERO:
            return factors
        if destination == BlendFactor.ONE and not draw[R.SURFACE]:
            draw[R.BLEND] = C.BLEND_ADD
            return factors
    draw[R.BLEND], draw[R.BLEND_EQUATION] = C.BLEND_GENERAL, equation
    if equation in (BlendEquation.FUNC_ADD_SIGNED, BlendEquation.FUNC_REVERSE_SUBTRACT_SIGNED):
        draw[R.SURFACE] = 1
    one = one_of(framebuffer.color_bits)
    color = color_codes(blending.color, one)
    factors[0], factors[1] = _pack_factor(source, color, one), _pack_factor(destination, color, one)
    return factors


def pack_facing(state, draw):
    """Write the entries of culling; returns the sign of a back-facing polygon's area."""
    polygon = state.polygon
    # With y down, a positive area is clockwise as seen with y up.
    front = -1 if polygon.front_face == FrontFace.CCW else 1
    culled = polygon.cull_face
    draw[R.CULL_POSITIVE] = culled == Face.FRONT_AND_BACK or culled == (
        Face.FRONT if front > 0 else Face.BACK
    )
    draw[R.CULL_NEGATIVE] = culled == Face.FRONT_AND_BACK or culled == (
        Face.FRONT if front < 0 else Face.BACK
    )
    return -front


def eighths(size):
    """A line's width or a point's size in 1/8 pixel, the chip's unit. Assumed: truncated."""
    return int(8.0 * size)


def pack_lines(line, profile, draw):
    """Write lines' entries."""
    steps = line.rasterization == LineRasterization.STEPS
    draw[R.LINE_STEPS] = C.LINE_IN_STEPS if steps else C.LINE_AS_RECTANGLE
    draw[R.LINE_WIDTH] = eighths(line.width)
    if profile.arithmetic.diamond_exit_lines and not line.smooth:
        draw[R.LINE_STEPS] = C.LINE_IN_DIAMONDS
        draw[R.LINE_WIDTH] = R.PIXEL_WIDE * whole_size(line.width)
    if line.stipple is not None:
        draw[R.LINE_FACTOR], draw[R.LINE_PATTERN] = line.stipple


def pack_coverage(state, profile, sample, draw):
    """Write the entries of coverage by samples instead of pixels' middles.

    Smooth primitives use the machine's samples. In a multisampled window all primitives except points and
    lines in steps use ``sample``, (x, y) in 1/16 pixel with y up. None: the window is not multisampled.
    """
    places, kinds = (), 0
    if sample is not None:
        if sample != (0, 0):
            places, kinds = (sample,), 1 << C.PRIMITIVE_TRIANGLE
            kinds |= (draw[R.LINE_STEPS] == C.LINE_AS_RECTANGLE) << C.PRIMITIVE_LINE
    elif state.polygon.smooth or state.line.smooth:
        places = profile.primitives.smoothing_samples
        kinds = state.polygon.smooth << C.PRIMITIVE_TRIANGLE | state.line.smooth << C.PRIMITIVE_LINE
    draw[R.COVERAGE], draw[R.COVER_SAMPLES] = kinds, len(places)
    for k, (right, up) in enumerate(places):
        draw[R.COVER_SAMPLE + 2 * k], draw[R.COVER_SAMPLE + 2 * k + 1] = right, -up


def pack_holes(state, framebuffer, draw):
    """Write the entries of polygon stipple and window clip, in device pixels."""
    height = framebuffer.height
    if state.polygon.stipple is not None:
        draw[R.STIPPLE] = 1
        words = np.frombuffer(state.polygon.stipple, ">u4")
        draw[R.STIPPLE_WORD : R.STIPPLE_WORD + 32] = words[(height - 1 - np.arange(32)) % 32]
    clip = state.window_clip
    if clip is not None:
        draw[R.WINDOW_CLIP] = C.WINDOW_CLIP_OUTSIDE if clip.exclusive else C.WINDOW_CLIP_INSIDE
        draw[R.CLIP_RECTANGLES] = len(clip.rectangles)
        for k, box in enumerate(clip.rectangles):
            draw[R.CLIP_RECTANGLE + 4 * k :][:4] = device_edges(box, height)
