"""Depth_buffer: slopes from the nearest to the farthest depth, in every depth format, below every cut-off.

The cut-off is the depth buffer's clear value. Compression (C) is a way in which the chip stores depth, and
changes no value. Source: src/tests/depth_format_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import SHOWS, Case
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.enums import ComparisonFunction, DepthFormat
from fixedpipe.pipeline.state import DepthClamp, DepthTest

SUITE = "Depth_buffer"
single = np.float32

FORMATS = {  # the name's parts: format, the farthest word
    ("z16", "n"): (DepthFormat.FIXED_16, 0xFFFF),
    ("z24", "n"): (DepthFormat.FIXED_24, 0xFFFFFF),
    ("z16", "y"): (DepthFormat.FLOAT_16, 0xFFFF),
    ("z24", "y"): (DepthFormat.FLOAT_24, 0xFEFFFF),
}
FARTHEST_FLOAT = float(single(1e30))  # the library's limit for 24-bit floats; nearer than the farthest word
CUT_OFFS = 48
LEFT, TOP, RIGHT, BOTTOM = 128, 40, 512, 440
SQUARE, STEP = 8, 12  # pixels: a small quad's edge, and from one to the next
COLUMNS, ROWS = (RIGHT - LEFT - SQUARE) // STEP, (BOTTOM - TOP - SQUARE) // STEP


def _cases():
    for (width, is_float), (depth_format, farthest) in FORMATS.items():
        for compressed in "ny":
            for k in range(CUT_OFFS + 1):
                cut_off = farthest - k * (farthest // CUT_OFFS)
                name = f"DepthFmt_{width}_C{compressed}_FZ{is_float}_M{cut_off:06x}"
                for zeta, shows in SHOWS.items():
                    yield name + zeta, partial(_case, depth_format, farthest, cut_off, shows)


def _decoded(bits):
    """The single of that bit pattern."""
    return float(np.array([bits], np.uint32).view(single)[0])


DEPTH_OF = {  # depth units of a word
    DepthFormat.FIXED_16: float,
    DepthFormat.FIXED_24: float,
    DepthFormat.FLOAT_16: lambda word: _decoded((word << 11) + 0x3C000000) if word else 0.0,
    DepthFormat.FLOAT_24: lambda word: _decoded(word << 7),
}


def _squares(farthest):
    """The grid of small quads: (left, top, words on the left and right, greys on the left and right)."""
    largest = single(farthest)
    step = single(largest / (single(3 + COLUMNS * ROWS) + single(1)))
    near, rise = single(0), single(step * single(0.75))
    x0 = LEFT + 4 + (RIGHT - LEFT - (SQUARE + COLUMNS * STEP)) / 2
    y0 = TOP + 4 + (BOTTOM - TOP - (SQUARE + ROWS * STEP)) / 2
    for row in range(ROWS):
        for column in range(COLUMNS):
            far = single(near + rise)
            greys = [single(0.25) + single(z / largest) * single(0.75) for z in (near, far)]
            words = (int(near), int(max(single(0), far)))
            yield x0 + STEP * column, y0 + STEP * row, words, greys
            near, rise = single(near + step), single(-rise)


def _mesh(farthest, depth_of):
    """The scene, front to back. ``depth_of`` turns a word of the depth buffer into depth units."""
    positions, colors = [], []

    def quad(left, top, right, bottom, depths, corners):
        for (x, y, _), z in zip(scenes.rectangle(left, top, right, bottom), depths, strict=True):
            positions.append((x, y, z))
        colors.extend(corners)

    for x, y, (a, b), (dark, light) in _squares(farthest):
        a, b, dark, light = depth_of(a), depth_of(b), (dark,) * 3, (light,) * 3
        quad(x, y, x + SQUARE, y + SQUARE, (a, b, b, a), (dark, light, light, dark))
    behind, most = farthest - 1, single(farthest)
    a, b = depth_of(behind * 3 // 4), depth_of(0)
    start, end = (single(a) / most, 0.75, single(a) / most), (0.75, single(b) / most, single(b) / most)
    quad(LEFT + 4, BOTTOM - 10, RIGHT - 20, BOTTOM - 5, (a, b, b, a), (start, end, end, start))
    a, b = depth_of(1), depth_of(farthest // 2)
    start, end = (single(a) / most, 0.5, single(a) / most), (0.5, single(b) / most, single(b) / most)
    quad(RIGHT - 10, TOP + 5, RIGHT - 2, BOTTOM - 5, (a, a, b, b), (start, start, end, end))
    a, b = depth_of(behind * 2 // 3), depth_of(behind)
    corners = ((0.0, 1.0, 0.0), (1.0, 0.0, 0.0), (0.4, 0.3, 0.0), (0.0, 0.0, 1.0))
    quad(LEFT, TOP, RIGHT, BOTTOM, (a, a, b, b), corners)
    return scenes.window_mesh(positions, colors=scenes.single(colors))


def _case(depth_format, farthest, cut_off, shows):
    limits = DepthClamp(maximum=FARTHEST_FLOAT, cull=True) if depth_format == DepthFormat.FLOAT_24 else None
    state = replace(scenes.DEFAULT, depth_test=DepthTest(ComparisonFunction.LESS), depth_clamp=limits)
    return Case(
        commands=(
            scenes.clear(0xFF000000, depth=cut_off / (2 ** abs(depth_format) - 1)),
            Draw(label="slopes", mesh=_mesh(farthest, DEPTH_OF[depth_format]), state=state),
        ),
        depth_bits=depth_format,
        shows=shows,
    )


CASES = dict(_cases())
