"""Attrib_float: vertex colours that are huge, tiny, infinite or no numbers, alone and times a constant.

Source: src/tests/attribute_float_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from fixedpipe.effects.conformance import scenes, vertex_programs
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.vertices.vertex_programs import vertex_program

SUITE = "Attrib_float"

COPIED = vertex_program("MOV o[HPOS], v[OPOS]; MOV o[COL0], v[COL0];")
MULTIPLIED = vertex_program("MOV o[HPOS], v[OPOS]; MUL o[COL0], v[COL0], c[120];")
# By name, the bit patterns of a gradient's ends.
ENDS = {
    **{"0_1": (0x00000000, 0x3F800000), "-1_1": (0xBF800000, 0x3F800000), "-8_1": (0xC1000000, 0x3F800000)},
    **{"0_8": (0x00000000, 0x41000000), "-NaNq_NaNq": (0xFFC00000, 0x7FC00000)},
    **{"-NaNs_NaNs": (0xFF800001, 0x7F800001), "-INF_INF": (0xFF800000, 0x7F800000)},
    **{"-Max_Max": (0xFF7FFFFF, 0x7F7FFFFF), "-MinN_MinN": (0x80800000, 0x00800000)},
    **{"-MaxSN_MaxSN": (0x807FFFFF, 0x007FFFFF), "-Min_Min": (0x80000001, 0x00000001)},
}
MULTIPLIERS = (1.0, 0.0, -np.inf, np.inf, np.copysign(np.nan, -1.0), np.nan)  # after a gradient as it is
INSET = 0.2


def _gradients(first, last):
    f = np.float32
    inset = f(INSET)
    column = f((f(1) - f(2) * inset) / f(len(MULTIPLIERS)))
    top, height = f((inset + f(0.1)) * f(HEIGHT)), f((f(1) - f(2) * inset) * f(HEIGHT))
    width = f(column * f(0.8)) * f(WIDTH)
    for number, multiplier in enumerate((None, *MULTIPLIERS)):
        left = f((inset + f(number) * column) * f(WIDTH))
        corners = np.array(scenes.rectangle(left, top, left + width, top + height, 1.0))
        colors = np.array([(*(value,) * 3, 1.0) for value in (first, first, last, last)])
        inputs = {"OPOS": corners, "COL0": colors}
        if multiplier is None:
            results = COPIED.run(inputs)
        else:
            results = MULTIPLIED.run(inputs, {120: (*(multiplier,) * 3, 1.0)})
        mesh = vertex_programs.results_mesh(results)
        yield Draw(label="gradient", mesh=mesh, state=scenes.DEFAULT)


def _colors():
    """Colours times NaN. The squares on the right show the secondary colour, which is off, and so black.

    The program's checkerboard is behind the eye: the last case's vertex program still runs and culls it.
    """
    size, top, spacing = 128.0, 64.0, 16.0
    left = (WIDTH - 2 * size) // 3
    for row in range(2):
        y = top + row * (size + spacing)
        corners = np.array(scenes.rectangle(left, y, left + size, y + size))
        inputs = {"OPOS": corners, "COL0": (1.0, 0.0, 0.5, 1.0)}
        results = MULTIPLIED.run(inputs, {120: (np.nan,) * 4})
        yield Draw(label="color", mesh=vertex_programs.results_mesh(results), state=scenes.DEFAULT)
        right = 2 * left + size
        yield scenes.quad(
            "black",
            scenes.rectangle(right, y, right + size, y + size),
            (0.0, 0.0, 0.0, 1.0),
            replace(scenes.DEFAULT, blending=None),
        )


def _gradient(patterns):
    first, last = scenes.from_patterns(patterns)
    return Case(commands=(scenes.clear(0xFF6495ED), *_gradients(first, last)))


def _colored():
    return Case(commands=(scenes.clear(0xFF333333), *_colors()))


CASES = {name: partial(_gradient, patterns) for name, patterns in ENDS.items()} | {"Colors": _colored}
