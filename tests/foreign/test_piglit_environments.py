"""Texture environments. Source: piglit, tests/spec/gl-1.3/texture-env.c, which draws 81 colours through 81
others; tests/spec/ext_texture_env_combine/combine.c and tests/spec/nv_texture_env_combine4/combine.c, whose
states are sampled here: 49 of each function and number of units.

Tolerances are piglit's: 3 of 255, 5 of a dot product, each times the scales; the sampled environments follow
the tables of OpenGL 1.3 and of the extensions in float64.
"""

import random
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pytest

from fixedpipe.pipeline import (
    Blending,
    Mesh,
    TexImage,
    TextureEnvironment,
    TextureUnit,
    environment,
    texture_2d,
)
from fixedpipe.pipeline.enums import (
    BlendFactor,
    CombineFunction,
    CombineOperand,
    CombineSource,
    InternalFormat,
    PrimitiveType,
    TextureEnvironmentMode,
)
from fixedpipe.pipeline.state import Combine
from tests.foreign.comparison import Case, assert_drawn, assert_held, everywhere, on_machines, picture, pixels
from tests.foreign.opengl import NEAREST, clear, draw, rectangle, rgb

MODE, FUNCTION = TextureEnvironmentMode, CombineFunction
SOURCE, OPERAND = CombineSource, CombineOperand

# texture-env.c: every colour of 0, 1/2 and 1 as a texel, across, and as the primary colour, upwards.
COLORS = np.array([[(k // 3**i % 3) / 2 for i in range(4)] for k in range(81)])
SIDE = len(COLORS)
FORMATS = {
    "ALPHA": InternalFormat.ALPHA8,
    "LUMINANCE": InternalFormat.LUMINANCE8,
    "LUMINANCE_ALPHA": InternalFormat.LUMINANCE8_ALPHA8,
    "INTENSITY": InternalFormat.INTENSITY8,
    "RGB": InternalFormat.RGB8,
    "RGBA": InternalFormat.RGBA8,
}
TEXELS = np.zeros((1, 128, 4))
TEXELS[0, :SIDE] = COLORS
OVER_GREY = Blending(BlendFactor.SRC_ALPHA, BlendFactor.ONE_MINUS_SRC_ALPHA)


def _rows():
    """A quad for each primary colour, a pixel high, whose texture runs across."""
    edges = np.linspace(-1, 1, SIDE + 1)
    corners = [
        corner for low, high in pairwise(edges) for corner in ([-1, low], [1, low], [1, high], [-1, high])
    ]
    end = SIDE / 128
    across = [[0, 0], [end, 0], [end, 0], [0, 0]] * SIDE
    return Mesh(corners, PrimitiveType.QUADS, colors=np.repeat(COLORS, 4, 0), texture_coordinates=(across,))


ROWS = _rows()


def tabled(mode, base, texel, primary, constant):
    """Tables 3.18 and 3.19 of OpenGL 1.3, of arrays that broadcast."""
    texel, primary = np.broadcast_arrays(texel, primary)
    result = primary.copy()
    color, alpha = primary[..., :3], primary[..., 3]
    has_color, has_alpha = base != "ALPHA", base not in ("LUMINANCE", "RGB")
    # What the format makes of the texel: luminance and intensity in all of red, green and blue.
    given = texel[..., :3] if base in ("RGB", "RGBA") else texel[..., :1]
    given_alpha = texel[..., 0] if base == "INTENSITY" else texel[..., 3]
    if mode == MODE.DECAL:
        by = texel[..., 3:] if base == "RGBA" else 1.0
        result[..., :3] = color * (1 - by) + given * by
        return result
    if has_color:
        result[..., :3] = {
            MODE.REPLACE: given,
            MODE.MODULATE: color * given,
            MODE.BLEND: color * (1 - given) + constant[:3] * given,
            MODE.ADD: color + given,
        }[mode]
    if has_alpha:
        result[..., 3] = given_alpha if mode == MODE.REPLACE else alpha * given_alpha
    if base == "INTENSITY" and mode == MODE.BLEND:
        result[..., 3] = alpha * (1 - given_alpha) + constant[3] * given_alpha
    if base == "INTENSITY" and mode == MODE.ADD:
        result[..., 3] = alpha + given_alpha
    return np.minimum(result, 1)


def through(mode, base, number):
    """All colours through all, in one environment of the constant colour of that number."""
    constant = COLORS[number]
    result = tabled(mode, base, COLORS[None], COLORS[::-1, None], constant)
    alpha = result[..., 3:]
    env = TextureEnvironment(mode, tuple(constant))
    frame = (
        TexImage(label="81 colours", texture="colours", image=texture_2d(TEXELS, FORMATS[base])),
        clear(0.5, 0.5, 0.5, 0.5),
        draw(ROWS, texture_units=(TextureUnit("colours", NEAREST, environment=env),), blending=OVER_GREY),
    )
    name = f"{mode.name} of {base}" + (f", constant {number}" if mode == MODE.BLEND else "")
    return Case(name, frame, picture(result * alpha + 0.5 * (1 - alpha), 3), (SIDE, SIDE))


CONVENTIONAL = [
    through(mode, base, number)
    for base in FORMATS
    for mode in (MODE.REPLACE, MODE.MODULATE, MODE.DECAL, MODE.BLEND, MODE.ADD)
    if mode != MODE.DECAL or base in ("RGB", "RGBA")
    for number in ((0, 25, 55, 80) if mode == MODE.BLEND else (0,))
]


# combine.c: piglit's colours of the fragment, of each unit's constant and of each unit's texel.
# They become bytes before anything reads them.
def in_bytes(*color):
    return tuple(round(component * 255) / 255 for component in color)


FRAGMENT = in_bytes(0.0, 0.25, 0.5, 0.75)
CONSTANTS = (
    in_bytes(0.25, 0.5, 0.75, 1.0),
    in_bytes(0.5, 0.75, 1.0, 0.0),
    in_bytes(0.75, 1.0, 0.0, 0.25),
    in_bytes(1.0, 0.0, 0.25, 0.5),
)
TEXTURES = CONSTANTS[::-1]
DOT_PRODUCTS = FUNCTION.DOT3_RGB, FUNCTION.DOT3_RGBA
ARGUMENTS = {FUNCTION.REPLACE: 1, FUNCTION.INTERPOLATE: 3}
ACROSS = 7  # states in a row of a window
SQUARE = 2 / ACROSS


@dataclass(frozen=True)
class Sampled:
    """A function in ``units`` units; with ``crossbar`` they read each other's texels; ``four``: COMBINE4."""

    function: CombineFunction
    units: int
    crossbar: bool = False
    four: bool = False

    @property
    def name(self):
        units = {1: "one unit", 2: "two units", 4: "four units"}[self.units]
        combine4, crossbar = "COMBINE4 " * self.four, ", crossbar" * (self.crossbar and not self.four)
        return f"{combine4}{self.function.name}, {units}{crossbar}"

    def sources(self):
        known = [SOURCE.TEXTURE, SOURCE.CONSTANT, SOURCE.PRIMARY_COLOR, SOURCE.PREVIOUS]
        numbered = [SOURCE[f"TEXTURE{number}"] for number in range(self.units)]
        return known + [SOURCE.ZERO] * self.four + numbered * self.crossbar

    def half(self, chance, of_alpha):
        """A half of any sources, operands and scale."""
        function = FUNCTION.MODULATE if of_alpha and self.function in DOT_PRODUCTS else self.function
        count = 4 if self.four else ARGUMENTS.get(function, 2)
        operands = [o for o in OPERAND if not of_alpha or o.name.endswith("ALPHA")]
        taken = [chance.choice(operands) for _ in range(count)]
        if function == FUNCTION.INTERPOLATE and not self.crossbar:
            taken[2] = OPERAND.SRC_ALPHA  # EXT_texture_env_combine's only one
        # A scale of 4 after ADD_SIGNED is a case of its own.
        scales = (1.0, 2.0) if function == FUNCTION.ADD_SIGNED else (1.0, 2.0, 4.0)
        sources = [chance.choice(self.sources()) for _ in range(count)]
        return Combine(function, tuple(sources), tuple(taken), chance.choice(scales))

    def state(self, chance):
        """Primary colour, texels and environments, of the test's colours, or any where ``four``."""

        def anything():
            return in_bytes(*[chance.random() for _ in range(4)])

        primary = anything() if self.four else FRAGMENT
        colors = [anything() for _ in range(self.units)] if self.four else TEXTURES[: self.units]
        mode = MODE.COMBINE4 if self.four else MODE.COMBINE
        environments = [
            TextureEnvironment(
                mode,
                anything() if self.four else CONSTANTS[unit],
                self.half(chance, of_alpha=False),
                self.half(chance, of_alpha=True),
            )
            for unit in range(self.units)
        ]
        return primary, colors, environments


def argument(source, operand, known):
    """Red, green, blue of an argument, or its alpha three times."""
    color = known[source]
    value = np.full(3, color[3]) if operand.name.endswith("ALPHA") else color[:3]
    return 1 - value if operand.name.startswith("ONE_MINUS") else value


def combined(half, known, four, scale=None):
    """Red, green and blue of a half, by table 3.20 of OpenGL 1.3 and NV_texture_env_combine4's."""
    read = [argument(*each, known) for each in zip(half.sources, half.operands, strict=True)]
    a, b, c, d = (*read, None, None, None)[:4]
    if four:
        value = a * b + c * d - 0.5 * (half.function == FUNCTION.ADD_SIGNED)
    else:
        value = {
            FUNCTION.REPLACE: lambda: a,
            FUNCTION.MODULATE: lambda: a * b,
            FUNCTION.ADD: lambda: a + b,
            FUNCTION.ADD_SIGNED: lambda: a + b - 0.5,
            FUNCTION.INTERPOLATE: lambda: a * c + b * (1 - c),
            FUNCTION.SUBTRACT: lambda: a - b,
            FUNCTION.DOT3_RGB: lambda: np.full(3, 4 * ((a - 0.5) * (b - 0.5)).sum()),
            FUNCTION.DOT3_RGBA: lambda: np.full(3, 4 * ((a - 0.5) * (b - 0.5)).sum()),
        }[half.function]()
    return np.clip(value * (half.scale if scale is None else scale), 0, 1)


def evaluated(primary, colors, environments):
    """The colour behind the last unit, and by how much roundings before it grow."""
    previous, growth = np.array(primary), 1.0
    numbered = {SOURCE[f"TEXTURE{number}"]: np.array(color) for number, color in enumerate(colors)}
    for color, env in zip(colors, environments, strict=True):
        known = numbered | {
            SOURCE.TEXTURE: np.array(color),
            SOURCE.CONSTANT: np.array(env.color),
            SOURCE.PRIMARY_COLOR: np.array(primary),
            SOURCE.PREVIOUS: previous,
            SOURCE.ZERO: np.zeros(4),
        }
        four = env.mode == MODE.COMBINE4
        red_green_blue = combined(env.rgb, known, four)
        if env.rgb.function == FUNCTION.DOT3_RGBA:
            alpha = combined(env.rgb, known, four, env.alpha.scale)
        else:
            alpha = combined(env.alpha, known, four)
        previous = np.append(red_green_blue, alpha[0])
        growth *= max(env.rgb.scale, env.alpha.scale) * (5 / 3 if env.rgb.function in DOT_PRODUCTS else 1)
    return previous, growth


def sampled(kind):
    """States of a kind, each a square of two pixels."""
    chance = random.Random(kind.name)
    states = [kind.state(chance) for _ in range(ACROSS**2)]
    names = {}
    frame = [clear(0, 0, 0, 0)]
    wanted = np.zeros((2 * ACROSS, 2 * ACROSS, 4))
    tolerance = np.zeros((2 * ACROSS, 2 * ACROSS))
    for number, (primary, colors, environments) in enumerate(states):
        for color in colors:
            if color not in names:
                names[color] = f"texel {len(names)}"
                image = texture_2d(np.array([[color]]))
                frame.append(TexImage(label=names[color], texture=names[color], image=image))
        x, y = number % ACROSS, number // ACROSS
        units = [
            TextureUnit(names[c], NEAREST, environment=e) for c, e in zip(colors, environments, strict=True)
        ]
        square = rectangle(x * SQUARE - 1, 1 - (y + 1) * SQUARE, SQUARE, SQUARE, color=primary)
        frame.append(draw(square, texture_units=tuple(units)))
        here = np.s_[2 * y : 2 * y + 2, 2 * x : 2 * x + 2]
        wanted[here], growth = evaluated(primary, colors, environments)
        tolerance[here] = 3 * growth
    # Between units the ideal clamps nothing, and the tables do.
    machines = tuple(m for m in Case.machines if kind.units == 1 or m != "IDEAL")
    return Case(kind.name, tuple(frame), picture(wanted, tolerance), (2 * ACROSS, 2 * ACROSS), machines)


KINDS = (
    *[Sampled(function, units) for function in FUNCTION for units in (1, 2, 4)],
    *[Sampled(function, 2, crossbar=True) for function in FUNCTION],
    *[
        Sampled(function, units, crossbar=True, four=True)
        for function in (FUNCTION.ADD, FUNCTION.ADD_SIGNED)
        for units in (1, 2)
    ],
)

# ADD_SIGNED with a scale of 4, which NV_texture_env_combine4 says TNT to GeForce take for 2.
SIGNED_SUMS = ((0.5, 0.3), (0.6, 0.2), (0.4, 0.15))
WHITE = TexImage(label="white", texture="white", image=texture_2d(np.ones((1, 1, 4))))


def by_four(a, b, or_two):
    env = environment(
        ("ADD_SIGNED", "PRIMARY_COLOR", "CONSTANT"), ("REPLACE", "TEXTURE"), color=(b,) * 4, rgb_scale=4.0
    )
    unit = TextureUnit("white", NEAREST, environment=env)
    frame = clear(0, 0, 0, 0), WHITE, draw(rectangle(-1, -1, 2, 2, (a, a, a, 1)), texture_units=(unit,))
    colors = tuple(rgb([(a + b - 0.5) * scale] * 3) for scale in ((4, 2) if or_two else (4,)))
    name = f"{a} + {b}, ADD_SIGNED by four" + " or by two" * or_two
    return Case(name, frame, pixels([(2, 2, colors, 6)]), (4, 4))


BY_FOUR = [by_four(*each, or_two=False) for each in SIGNED_SUMS]
CASES = (
    *CONVENTIONAL,
    *map(sampled, KINDS),
    *BY_FOUR,
    *[by_four(*each, or_two=True) for each in SIGNED_SUMS],
)
DISAGREEMENTS = everywhere(
    "NV_texture_env_combine4, which these machines follow: TNT to GeForce scale by two",
    [case.name for case in BY_FOUR],
    ("MULTITEXTURE", "GEFORCE_256", "GEFORCE_3", "NV2A"),
)


@pytest.mark.parametrize(("case", "machine"), on_machines(CASES, DISAGREEMENTS))
def test_environments_are_what_piglit_expects(case, machine):
    assert_drawn(case, machine)


def test_every_case_is_drawn_somewhere():
    assert_held(CASES, refused=207)
