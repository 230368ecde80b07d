"""Frames of the ideal machine beside the specification in real numbers, a stage at a time.

The specification computes with fractions, the ideal with float64: they differ by float64's rounding alone.
"""

import random
from fractions import Fraction
from itertools import product

import numpy as np
import pytest

from fixedpipe.pipeline import execute_ideal
from fixedpipe.pipeline.commands import Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import (
    BlendEquation,
    BlendFactor,
    ComparisonFunction,
    DotProductMapping,
    PrimitiveType,
    TextureEnvironmentMode,
    TextureFilter,
)
from fixedpipe.pipeline.enums import TextureShaderOperation as Operation
from fixedpipe.pipeline.profiles import GEFORCE_256, IDEAL
from fixedpipe.pipeline.state import (
    AlphaTest,
    Blending,
    ColorMask,
    DepthTest,
    PassState,
    Sampler,
    TextureEnvironment,
    TextureShaderStage,
    TextureUnit,
)
from fixedpipe.pipeline.textures.images import texture_2d, texture_3d
from tests.pipeline.ideal.test_texture_shader import (
    DOT,
    EDGE,
    EXPAND,
    NOISE,
    constant,
    directions_cube,
    frame,
)
from tests.pipeline.notations.test_corpus import COUNT, GIVEN, REGISTERS, drawn
from tests.reference import combine, fixed, per_fragment, render, texture_shader
from tests.support.random_frames import _Maker

REAL = fixed.REAL


def real(color):
    """Bytes as fractions."""
    return [Fraction(int(byte), 255) for byte in color]


# -------------------------------------------------------------------------------------- register combiners

# Two general combiners without a clamp reach 4 (24^2 + 24^2) < 2^14, where float64 has steps of 2e-12.
OF_TWO_COMBINERS = 1e-10


@pytest.mark.parametrize("seed", range(60))
def test_random_programs_of_register_combiners(seed):
    maker = _Maker(seed)
    maker.profile, maker.small, maker.plain = GEFORCE_256, False, False
    program = maker.register_combiners(4)
    found = execute_ideal(drawn(program, GIVEN), COUNT, 1).color.reshape(COUNT, 4)
    for given, color in zip(GIVEN, found, strict=True):
        *texels, primary, secondary = (real(given[name]) for name in REGISTERS)
        registers = combine.initial_registers(primary, secondary, texels, (0, 0, 0, 1), REAL)
        expected = [float(c) for c in combine.combine(program, registers, combine.IDEAL)]
        np.testing.assert_allclose(color, expected, rtol=0, atol=OF_TWO_COMBINERS)


# ----------------------------------------------------------------------------------- per-fragment operations

EQUATIONS = [equation for equation in BlendEquation if equation in IDEAL.fragments.blend_equations]
FACTORS = list(product(BlendFactor, BlendFactor))
NEAREST = Sampler(TextureFilter.NEAREST, TextureFilter.NEAREST)


def row_of(y, height):
    """A quadrilateral over a row of the window, and over that row of a texture as large."""
    low, high = y / height, (y + 1) / height
    corners = np.array([[0, low], [1, low], [1, high], [0, high]])
    return Mesh(2.0 * corners - 1.0, PrimitiveType.QUADS, texture_coordinates=(corners,))


@pytest.mark.parametrize("equation", EQUATIONS, ids=lambda equation: equation.name)
def test_every_pair_of_blend_factors_and_the_alpha_test(equation):
    """A row of pixels for each pair. No byte is the reference, where float64's last bit would decide."""
    numbers, size = np.random.default_rng(equation), (len(FACTORS), 6, 4)
    source, stored = (numbers.choice([*range(256), 0, 255, 128], size).astype(np.uint8) for _ in "sd")
    shown = TextureEnvironment(TextureEnvironmentMode.REPLACE)
    states = [
        PassState(
            texture_units=(TextureUnit("source", NEAREST, environment=shown),),
            blending=Blending(*factors, equation, color=(0.25, 0.6, 0.1, 0.75)),
            alpha_test=AlphaTest(ComparisonFunction.GEQUAL, 0.3) if y % 3 == 0 else None,
            color_mask=ColorMask(red=y % 5 != 0),
        )
        for y, factors in enumerate(FACTORS)
    ]
    height, before = len(FACTORS), TextureUnit("stored", NEAREST, environment=shown)
    commands = [
        TexImage(label="source", texture="source", image=texture_2d(source)),
        TexImage(label="stored", texture="stored", image=texture_2d(stored)),
        Draw(label="stored", mesh=row_of(0, 1), state=PassState(texture_units=(before,))),
        *(Draw(label="row", mesh=row_of(y, height), state=state) for y, state in enumerate(states)),
    ]
    found = execute_ideal(commands, 6, height).color[::-1]
    target = render.Target(6, height, 24, one=REAL, clamped=False)
    target.color = [[real(color) for color in row] for row in stored]
    for (y, state), x in product(enumerate(states), range(6)):
        per_fragment.write_fragment(target, x, y, real(source[y, x]), 0, state)
    np.testing.assert_allclose(found, np.array(target.color, float), rtol=0, atol=NOISE)


# ------------------------------------------------------------------------------------------ texture shaders


def ramp():
    """A table of its own places; a linear filter gives the place itself between the outer texels' centres."""
    centres = (np.arange(64) + 0.5) / 64
    s, t = np.meshgrid(centres, centres)
    return texture_2d(np.stack([s, t, np.full_like(s, 0.25)], axis=-1))


def volume():
    centres = (np.arange(16) + 0.5) / 16
    r, t, s = np.meshgrid(centres, centres, centres, indexing="ij")
    return texture_3d(np.stack([s, t, r], axis=-1))


TABLES = {"ramp": ramp(), "volume": volume(), "directions": directions_cube()}
MARGIN = Fraction(1, 32)  # half a texel of the volume, beyond which a filter leaves the ramps
SIGNED_ODD = {"dot_product_mapping": DotProductMapping.SIGNED_ODD}
SIGNED = {"dot_product_mapping": DotProductMapping.SIGNED_IDENTITY}
MOVED = {"offset_texture_matrix": (0.25, -0.125, 0.0625, 0.1875)}
TWO = Operation.DOT_PRODUCT_TEXTURE_2D
PROGRAMS = {
    "pass through": [(Operation.PASS_THROUGH, None, {})],
    "dependent alpha red": [(Operation.DEPENDENT_AR_TEXTURE_2D, "ramp", {})],
    "dependent green blue": [(Operation.DEPENDENT_GB_TEXTURE_2D, "ramp", {})],
    "offset": [(Operation.OFFSET_TEXTURE_2D, "ramp", MOVED)],
    "offset and scale": [
        (
            Operation.OFFSET_TEXTURE_2D_SCALE,
            "ramp",
            MOVED | {"offset_texture_scale": 1.5, "offset_texture_bias": 0.125},
        )
    ],
    "two dot products": [(DOT, None, {}), (TWO, "ramp", {})],
    "two dot products, expanded": [(DOT, None, EXPAND), (TWO, "ramp", EXPAND)],
    "two dot products, odd": [(DOT, None, SIGNED_ODD), (TWO, "ramp", SIGNED_ODD)],
    "two dot products, signed": [(DOT, None, SIGNED), (TWO, "ramp", SIGNED)],
    "three dot products": [
        (DOT, None, {}),
        (DOT, None, {}),
        (Operation.DOT_PRODUCT_TEXTURE_3D, "volume", {}),
    ],
    "cube map": [
        (DOT, None, EXPAND),
        (DOT, None, EXPAND),
        (Operation.DOT_PRODUCT_TEXTURE_CUBE_MAP, "directions", EXPAND),
    ],
    "reflection": [
        (DOT, None, EXPAND),
        (DOT, None, EXPAND),
        (Operation.DOT_PRODUCT_REFLECT_CUBE_MAP, "directions", EXPAND),
    ],
    "constant eye": [
        (DOT, None, EXPAND),
        (DOT, None, EXPAND),
        (
            Operation.DOT_PRODUCT_CONST_EYE_REFLECT_CUBE_MAP,
            "directions",
            EXPAND | {"constant_eye": (0.25, -0.5, 1.0)},
        ),
    ],
    "depth": [(DOT, None, {}), (Operation.DOT_PRODUCT_DEPTH_REPLACE, None, {})],
    "culled": [(Operation.CULL_FRAGMENT, None, {})],
}


class OfReals(texture_shader.Stages):
    """The specification's stages at given coordinates. ``texel``: unit 0's; ``table``: the last unit's."""

    def __init__(self, state, coordinates, texel, table):
        units = [True] * len(coordinates)
        super().__init__(state, units, None, self.read, 1, IDEAL, REAL)
        self.given, self.texel, self.table = coordinates, texel, table
        self.inside = True

    def coordinates(self, i):
        return self.given[i]

    def read(self, i, made, operation, rough=None):
        if made is None:
            return self.texel
        made = list(map(Fraction, made))
        if self.table == "directions":
            longest = max(map(abs, made))
            self.inside = longest > 0 and sorted(map(abs, made))[1] <= longest * Fraction(3, 4)
            return [*((c / longest + 1) / 2 for c in made), 1] if self.inside else self.texel
        if self.table == "ramp":
            made[2] = Fraction(1, 4)
        self.inside = all(MARGIN <= c <= 1 - MARGIN for c in made)
        return [*made, 1]


def fragments(program):
    """(coordinates of each unit, unit 0's bytes) without end."""
    numbers = random.Random(program)
    while True:
        coordinates = [[Fraction(numbers.randrange(-32, 65), 64) for _ in range(4)] for _ in range(4)]
        yield coordinates, [numbers.randrange(256) for _ in range(4)]


@pytest.mark.parametrize("program", PROGRAMS)
def test_operations_of_texture_shaders(program):
    """24 fragments of their own texels, whose lookups lie where a linear filter gives the place itself."""
    stages = [(Operation.TEXTURE_2D, "texel", {}), *PROGRAMS[program]]
    table, seen, kept = stages[-1][1], 0, set()
    for coordinates, texel in fragments(program):
        given = coordinates[: len(stages)]
        state = PassState(
            texture_units=(TextureUnit("texel"),) * len(stages),
            texture_shader=tuple(TextureShaderStage(operation, **more) for operation, _, more in stages),
        )
        run = OfReals(state, given, real(texel), table)
        texels, alive, depth = run.run()
        if not run.inside:
            continue
        textures = {"texel": texture_2d(np.array([[texel]], np.uint8))}
        textures |= {table: TABLES[table]} if table else {}
        commands = frame(
            textures,
            stages,
            [constant(*map(float, c)) for c in given],
            samplers={len(stages) - 1: EDGE},
            register=None if table or program == "pass through" else 0,
            depth_test=DepthTest(ComparisonFunction.ALWAYS, write=True),
        )
        found = execute_ideal(commands, 1, 1)
        expected = texels[-1 if table or program == "pass through" else 0] if alive else [0] * 4
        np.testing.assert_allclose(found.color[0, 0], np.array(expected, float), rtol=0, atol=NOISE)
        if depth is not None and alive:
            np.testing.assert_allclose(found.depth[0, 0], float(depth), rtol=0, atol=NOISE)
        seen, kept = seen + 1, kept | {alive}
        if seen == 24:
            break
    assert kept == ({True, False} if program in ("depth", "culled") else {True})
