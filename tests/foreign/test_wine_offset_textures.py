"""Bump maps that move another texture's coordinates, and texkill. Source: WineHQ, wine,
dlls/d3d9/tests/visual.c, texbem_test, fixed_function_bumpmap_test (textures of generate_bumpmap_textures) and
texkill_test. Of no test suite: the last cases, read in NV_texture_shader, revision 30, section 3.8.13.1.9.
"""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.pipeline import Draw, TexImage, TextureShaderStage, TextureUnit, parse_program, texture_2d
from fixedpipe.pipeline.enums import TexelWord, TextureEnvironmentMode, TextureShaderOperation
from fixedpipe.pipeline.state import SignedComponents, TextureEnvironment
from fixedpipe.pipeline.textures.words import texture_of_words
from tests.foreign.comparison import (
    WITH_TEXTURE_SHADER,
    Case,
    assert_drawn,
    assert_held,
    everywhere,
    on_machines,
    pixels,
)
from tests.foreign.direct3d import POINT, POINT_CLAMPED, QUAD, clear, draw, strip, texels

FULL, SIZE = (640, 480), (64, 48)
NONE = TextureEnvironment(TextureEnvironmentMode.NONE)
REPLACE = TextureEnvironment(TextureEnvironmentMode.REPLACE)
SIGNED = SignedComponents(green=True, blue=True)
CORNERS = [[0, 0], [0, 1], [1, 0], [1, 1]]
OFFSET, SCALED = TextureShaderOperation.OFFSET_TEXTURE_2D, TextureShaderOperation.OFFSET_TEXTURE_2D_SCALE


def v8u8(u, v, luminance=255):
    """A texture of signed bytes u and v, in blue and green as texture shaders take them."""
    words = np.full((*np.shape(u), 4), 255, np.uint8)
    words[..., 0] = luminance
    words[..., 1], words[..., 2] = np.asarray(v) & 255, np.asarray(u) & 255
    return texture_2d(words)


def offset_by_unit_0(matrix, operation=OFFSET, **fields):
    """Texture shader stages of which the second is offset by the first's texel."""
    second = TextureShaderStage(operation, 0, offset_texture_matrix=matrix, **fields)
    return TextureShaderStage(TextureShaderOperation.TEXTURE_2D), second


def units(bump, base, replaced=True):
    """Units of a bump map and of what it moves, by environments, or by combiners where not ``replaced``."""
    environments = (NONE, REPLACE) if replaced else (TextureEnvironment(),) * 2
    return (
        TextureUnit(bump, replace(POINT_CLAMPED, signed_components=SIGNED), environment=environments[0]),
        TextureUnit(base, POINT_CLAMPED, coordinates=1, environment=environments[1]),
    )


# A bump map of four triangles that meet in the middle, and a ramp of red and green.
ACROSS, DOWN = np.meshgrid(np.arange(128) - 64, np.arange(128) - 64)
SIDEWAYS = abs(ACROSS) > abs(DOWN)
U = np.where(SIDEWAYS, 0, np.where(DOWN < 0, 0x40, 0xC0))
V = np.where(SIDEWAYS, np.where(ACROSS < 0, 0xC0, 0x40), 0)
RAMP = np.zeros((128, 128, 4), np.uint8)
RAMP[..., 0], RAMP[..., 1], RAMP[..., 3] = (ACROSS + 64) * 2, (DOWN + 64) * 2, 255
LOAD = (
    TexImage(label="bump map", texture="bump", image=v8u8(U, V)),
    TexImage(label="ramp", texture="ramp", image=texture_2d(RAMP)),
)
TURN = (0.0, 0.5, -0.5, 0.0)
TEXBEM = parse_program("ps.1.1\ntex t0\ntexbem t1, t0\nmov r0, t1")


def texbem(name, coordinates):
    mesh = strip(texture_coordinates=(CORNERS, coordinates))
    state = {
        "texture_units": units("bump", "ramp", replaced=False),
        "texture_shader": offset_by_unit_0(TURN),
        "register_combiners": TEXBEM.combiners,
    }
    wanted = [(x, y, 0x7E8000, 4) for x, y in ((160, 240), (480, 240), (320, 120), (320, 360))]
    return Case(name, (clear(0xFF0000FF), *LOAD, draw(mesh, FULL, **state)), pixels(wanted), FULL)


BY_STAGES = Case(
    "D3DTOP_BUMPENVMAP",
    (
        clear(0xFFFF00FF),
        *LOAD,
        draw(
            strip(texture_coordinates=(CORNERS, CORNERS)),
            FULL,
            texture_units=units("bump", "ramp"),
            texture_shader=offset_by_unit_0(TURN),
        ),
    ),
    pixels(
        [
            (240, 60, 0x5EA000, 4),
            (400, 60, 0x9EA000, 4),
            (80, 180, 0x5EA000, 4),
            (560, 180, 0x9EA000, 4),
            (80, 300, 0x5E6000, 4),
            (560, 300, 0x9E6000, 4),
            (240, 420, 0x5E6000, 4),
            (400, 420, 0x9E6000, 4),
        ]
    ),
    FULL,
)

# D3DTOP_BUMPENVMAPLUMINANCE: the L6V5U5 word 4000, whose luminance is 16/63, and a texel of ff80c0.
QUARTER = round(16 / 63 * 255)
LUMINANCE_LOAD = (
    TexImage(label="bump map", texture="bump", image=v8u8([[0]], [[0]], QUARTER)),
    TexImage(label="texel", texture="base", image=texture_2d(texels([[0xFFFF80C0]]))),
)
LUMINANCE = {
    "scale 2, offset 0.1": (2.0, 0.1, 0x994C72, 5),
    "scale 10, offset 10": (10.0, 10.0, 0xFF80C0, 1),
    "scale 1000, offset -1": (1000.0, -1.0, 0xFF80C0, 1),
}


def luminance(name):
    scale, bias, color, tolerance = LUMINANCE[name]
    stages = offset_by_unit_0((0.0,) * 4, SCALED, offset_texture_scale=scale, offset_texture_bias=bias)
    mesh = strip(texture_coordinates=(CORNERS, CORNERS))
    drawn = draw(mesh, SIZE, texture_units=units("bump", "base"), texture_shader=stages)
    wanted = pixels([(32, 24, color, tolerance)])
    return Case(f"luminance, {name}", (clear(0), *LUMINANCE_LOAD, drawn), wanted, SIZE)


def by_words(case, words):
    """The case with its bump map as Direct3D's words, whose format has the signs."""

    def of_words(command):
        if isinstance(command, TexImage) and command.texture == "bump":
            return replace(command, image=words)
        if not isinstance(command, Draw):
            return command
        bare = tuple(
            replace(unit, sampler=replace(unit.sampler, signed_components=SignedComponents()))
            for unit in command.state.texture_units
        )
        return replace(command, state=replace(command.state, texture_units=bare))

    frame = tuple(of_words(command) for command in case.frame)
    return replace(case, name=f"{case.name}, as words", frame=frame, machines=WITH_TEXTURE_SHADER)


BY_WORDS = (
    by_words(BY_STAGES, texture_of_words(U & 255 | (V & 255) << 8, TexelWord.V8U8)),
    *(
        by_words(luminance(name), texture_of_words(np.array([[0x4000]]), TexelWord.L6V5U5))
        for name in LUMINANCE
    ),
)

# Two texbem instructions of ps.1.3 look a texture up at two places, and their texels are added.
TARGETS = np.full((8, 8), 0x000000FF)
TARGETS[2, 1], TARGETS[4, 6] = 0x0000FF00, 0x00FF0000
BOTH_LOAD = (
    TexImage(label="first offset", texture="a", image=v8u8([[int(-127 / 8)]], [[int(127 / 8)]])),
    TexImage(label="second offset", texture="b", image=v8u8([[int(-254 / 8)]], [[int(-508 / 8)]])),
    TexImage(label="two targets", texture="targets", image=texture_2d(texels(TARGETS))),
)
BOTH = parse_program("ps.1.3\ntex t0\ntexbem t1, t0\ntex t2\ntexbem t3, t2\nadd r0, t1, t3")


def both():
    first, second = units("a", "targets", replaced=False)
    third, fourth = units("b", "targets", replaced=False)
    stages = list(BOTH.texture_shader)
    stages[1] = replace(stages[1], offset_texture_matrix=(-1.0, 0.0, 2.0, 0.0))
    stages[3] = replace(stages[3], offset_texture_matrix=(1.5, 0.0, 0.0, 0.5))
    corner, middle = [[0, 0]] * 4, [[0.5, 0.5]] * 4
    mesh = strip(
        [[x, y, 0] for x in (-1, 1) for y in (-1, 1)], texture_coordinates=(corner, middle, corner, middle)
    )
    state = {
        "texture_units": (first, second, replace(third, coordinates=2), replace(fourth, coordinates=3)),
        "texture_shader": tuple(stages),
        "register_combiners": BOTH.combiners,
    }
    wanted = pixels([(32, 24, 0xFFFF00, 1)])
    return Case("two texbem", (clear(0xFF0000FF), *BOTH_LOAD, draw(mesh, SIZE, **state)), wanted, SIZE)


# texkill_test: coordinates below zero beyond an edge each; every corner has pixels within and beyond.
KILLED = [[-0.1, 0.9, 0.9, -0.1], [-0.1, 0.9, -0.1, 0.9], [0.9, -0.1, 0.9, -0.1], [0.9, -0.1, -0.1, 0.9]]
SLOPE = [[-1, -1, 1], [-1, 1, 1], [1, -1, 0], [1, 1, 0]]
TEXKILL = parse_program("ps.1.1\ndef c0, 1.0, 0.0, 0.0, 1.0\ntexkill t0\nmov r0, c0")
KEPT = [(63, 46), (66, 46), (63, 49), (578, 46), (575, 46), (578, 49)]
KEPT += [(63, 430), (63, 433), (578, 430), (578, 433)]
PAINTED = [(66, 49), (575, 49), (66, 433), (66, 430), (575, 433), (575, 430)]


def texkill(name, coordinates):
    mesh = strip(SLOPE, texture_coordinates=(coordinates,))
    state = {
        "texture_units": (TextureUnit(None),),
        "texture_shader": TEXKILL.texture_shader,
        "register_combiners": TEXKILL.combiners,
    }
    wanted = [(x, y, 0x00FF00, 0) for x, y in KEPT] + [(x, y, 0xFF0000, 0) for x, y in PAINTED]
    return Case(name, (clear(0xFF00FF00, 1.0), draw(mesh, FULL, **state)), pixels(wanted), FULL)


# NV_texture_shader: the factor ends at 1, and stages behind read the texel before the factor.
def texel(name, *rgba):
    return TexImage(label=name, texture=name, image=texture_2d(np.array([[rgba]], np.uint8)))


WHOLE = strip(texture_coordinates=([[0.5, 0.5]] * len(QUAD),) * 3)


def ends_at_one(scale, bias):
    stages = offset_by_unit_0(
        (1.0, 0.0, 0.0, 1.0), SCALED, offset_texture_scale=scale, offset_texture_bias=bias
    )
    drawn = draw(WHOLE, SIZE, texture_units=units("bump", "base"), texture_shader=stages)
    frame = clear(0), texel("bump", 255, 0, 0, 255), texel("base", 100, 60, 20, 255), drawn
    wanted = pixels([(32, 24, 0x643C14, 1)])
    return Case(f"a factor of 1 times {scale}, plus {bias}, ends at 1", frame, wanted, SIZE)


def read_behind():
    bump, base = units("bump", "base")
    stages = offset_by_unit_0((1.0, 0.0, 0.0, 1.0), SCALED, offset_texture_scale=0.0, offset_texture_bias=0.5)
    dependent = TextureShaderStage(TextureShaderOperation.DEPENDENT_GB_TEXTURE_2D, 1)
    ramp = np.zeros((256, 256, 4), np.uint8)
    ramp[..., 0], ramp[..., 1], ramp[..., 3] = np.arange(256), np.arange(256)[:, None], 255
    drawn = draw(
        WHOLE,
        SIZE,
        texture_units=(
            bump,
            replace(base, environment=NONE),
            TextureUnit("ramp", POINT, coordinates=2, environment=REPLACE),
        ),
        texture_shader=(*stages, dependent),
    )
    load = TexImage(label="ramp", texture="ramp", image=texture_2d(ramp))
    frame = clear(0), texel("bump", 0, 0, 0, 255), texel("base", 0, 200, 80, 255), load, drawn
    wanted = pixels([(32, 24, 0xC85000, 1)])
    return Case("a stage behind reads the texel before the factor", frame, wanted, SIZE)


PROJECTED = "texbem, projected coordinates"
ENDS = [ends_at_one(2.0, 1.0), ends_at_one(1.0, 0.5)]
CASES = (
    texbem("texbem", CORNERS),
    texbem(PROJECTED, [[0, 0, 0, 128], [0, 128, 0, 128], [128, 0, 0, 128], [128, 128, 0, 128]]),
    BY_STAGES,
    *map(luminance, LUMINANCE),
    both(),
    texkill("texkill", KILLED),
    texkill("texkill, q made 1", [[*corner[:3], 1.0] for corner in KILLED]),
    *ENDS,
    read_behind(),
    *BY_WORDS,
)
_TEXTURE_SHADERS = ("GEFORCE_3", "NV2A", "IDEAL")
DISAGREEMENTS = {
    **everywhere(
        "captures of an NV2A show factors above 1, which Wine's GeForce 3 and NV_texture_shader have not",
        [
            *("luminance, scale 10, offset 10", "luminance, scale 1000, offset -1"),
            *("luminance, scale 10, offset 10, as words", "luminance, scale 1000, offset -1, as words"),
            *(case.name for case in ENDS),
        ],
        ["NV2A"],
    ),
    **everywhere(
        "Direct3D divides the offset coordinates by q; NV_texture_shader, which is kept, does not",
        [PROJECTED],
        _TEXTURE_SHADERS,
    ),
    **everywhere(
        "Direct3D tests three coordinates; NV_texture_shader's CULL_FRAGMENT, which is kept, four",
        ["texkill"],
        _TEXTURE_SHADERS,
    ),
}


@pytest.mark.parametrize(("case", "machine"), on_machines(CASES, DISAGREEMENTS))
def test_offsets_are_what_wine_and_the_specification_expect(case, machine):
    assert_drawn(case, machine)


def test_every_case_is_drawn_somewhere():
    assert_held(CASES, refused=66)
