"""Pixel shaders on the specification's register combiners, beside what Direct3D defines."""

import random

from hypothesis import strategies as st

from fixedpipe.pipeline.notations.pixel_shader_translation import parse
from fixedpipe.pipeline.profiles import NV2A
from fixedpipe.pipeline.validation.validate import validate_program
from tests.reference import combine, pixel_shader

NO_FOG = [0, 0, 0, 255]
CHIP = pixel_shader.Arithmetic(half=NV2A.arithmetic.expand_half, lowest=NV2A.arithmetic.clamp_low)
TEXELS = st.tuples(*[st.integers(0, 255)] * 4)


def on_combiners(shader, textures, primary, secondary, profile=NV2A):
    """The fragment's color of the specification of register combiners."""
    registers = combine.initial_registers(primary, secondary, textures, NO_FOG)
    return combine.combine(shader.combiners, registers, combine.machine_of(profile))


def fragments(count, seed=1):
    """Random texels and colors, then those at the ends of the range."""
    numbers = random.Random(seed)
    for k in range(count):
        values = (0, 127, 128, 255) if k % 2 else range(256)
        yield [[numbers.choice(values) for _ in range(4)] for _ in range(6)]


def check(text, count=40, profile=NV2A, arithmetic=CHIP):
    shader = parse(text)
    validate_program(shader.texture_shader, shader.combiners, profile)
    for t0, t1, t2, t3, v0, v1 in fragments(count):
        expected = pixel_shader.evaluate(text, (t0, t1, t2, t3), v0, v1, arithmetic)
        assert on_combiners(shader, (t0, t1, t2, t3), v0, v1, profile) == expected, (t0, t1, v0, v1)
    return shader
