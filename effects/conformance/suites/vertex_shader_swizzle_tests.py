"""Vertex_shader_swizzle_tests: squares whose colour a MOV writes, by every write mask and many swizzles.

Source: src/tests/vertex_shader_swizzle_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace
from functools import partial
from itertools import product

import numpy as np

from fixedpipe.effects.conformance import scenes, vertex_programs
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.vertices.vertex_programs import vertex_program

SUITE = "Vertex_shader_swizzle_tests"

# Masks, every one with every swizzle of its row, in pictures of nine. Those of NAMov are drawn opaque.
INSTRUCTIONS = {
    "Mov": (
        ("xw", "x", "yz", "xyzw", "yw", "zw", "xy", "z", "yzw", "w", "xzw", "xyw", "xz", "xyz", "y"),
        ("xw", "zy", "yw", "yzw", "yx", "wzy", "xzw", "zx", "zxy", "wz"),
    ),
    "NAMov": (
        ("y", "xz", "xy", "z", "yz", "x", "xyz"),
        ("wz", "xw", "zx", "xy", "yzw", "wzy", "zy", "yw", "xzw", "zxy", "yx", "wy"),
    ),
}
PER_PICTURE = 9
COLOR, UNSET = (0.6, 0.7, 0.8, 1.0), (0.33,) * 4
SIZE, LEFT, TOP = 96.0, (WIDTH - 3 * 96) / 4, (HEIGHT - 3 * 96) / 4 + 10


def _square(number, instruction, state):
    left = LEFT + number % 3 * (SIZE + LEFT)
    top = TOP + number // 3 * (SIZE + TOP)
    corners = [(*corner, 1.0) for corner in scenes.rectangle(left, top, left + SIZE, top + SIZE)]
    found = vertex_program(f"MOV o[HPOS], v[OPOS]; MOV o[COL0], c[96]; {instruction}")
    results = found.run({"OPOS": np.array(corners), "COL0": COLOR}, {96: UNSET})
    return Draw(label="square", mesh=vertex_programs.results_mesh(results), state=state)


def _case(instructions, opaque):
    combiners = scenes.SHOWS_PRIMARY_OPAQUE if opaque else scenes.SHOWS_PRIMARY
    state = replace(scenes.DEFAULT, register_combiners=combiners)
    screen = scenes.rectangle(0.0, 0.0, WIDTH, HEIGHT)
    background = scenes.background(0xFF202020, 0xFF000000, 24, corners=screen)
    squares = [_square(number, text, state) for number, text in enumerate(instructions or ("",))]
    return Case(commands=(scenes.clear(0xFE312F31), *background, *squares))


CASES = {"Control": partial(_case, (), False), "ControlNA": partial(_case, (), True)}
for _name, (_masks, _swizzles) in INSTRUCTIONS.items():
    _all = [f"MOV o[COL0].{mask}, v[COL0].{swizzle};" for mask, swizzle in product(_masks, _swizzles)]
    for _first in range(0, len(_all), PER_PICTURE):
        _picture = _all[_first : _first + PER_PICTURE]
        CASES[f"{_name}{_first // PER_PICTURE:02d}"] = partial(_case, _picture, _name != "Mov")
