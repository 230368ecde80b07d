"""Pixel shaders drawn by the machine: pixels are what Direct3D defines of texels, colors and coordinates."""

import numpy as np
import pytest

from fixedpipe.pipeline.commands import Clear, Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import PrimitiveType, TextureFilter, VertexStage, WrapMode
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.notations.pixel_shader_translation import parse
from fixedpipe.pipeline.profiles import NV2A
from fixedpipe.pipeline.state import PassState, Sampler, TextureUnit, VertexState
from fixedpipe.pipeline.textures.images import texture_2d
from fixedpipe.pipeline.validation.validate import validate_program
from tests.reference import pixel_shader

COUNT, SIDE = 64, 8
CHIP = pixel_shader.Arithmetic(half=NV2A.arithmetic.expand_half, lowest=NV2A.arithmetic.clamp_low)
NEAREST = Sampler(
    TextureFilter.NEAREST, TextureFilter.NEAREST, WrapMode.CLAMP_TO_EDGE, WrapMode.CLAMP_TO_EDGE
)


def draw(text, images, colors, secondary, coordinates):
    """One point for each pixel of a row, with colors and texture coordinates of its own; their pixels."""
    shader = parse(text)
    validate_program(shader.texture_shader, shader.combiners, NV2A)
    names = [f"image {unit}" for unit in range(len(images))]
    commands = [Clear(label="clear", color=(0.0, 0.0, 0.0, 0.0))]
    commands += [
        TexImage(label=name, texture=name, image=texture_2d(image))
        for name, image in zip(names, images, strict=True)
    ]
    positions = np.column_stack(
        [np.arange(COUNT) + 0.5, np.full(COUNT, 0.5), np.zeros(COUNT), np.ones(COUNT)]
    )
    mesh = Mesh(
        positions,
        PrimitiveType.POINTS,
        colors=colors / 255,
        secondary_colors=secondary / 255,
        texture_coordinates=tuple(coordinates),
    )
    state = PassState(
        vertex=VertexState(stage=VertexStage.PROGRAM_RESULTS),
        texture_units=tuple(TextureUnit(name, NEAREST, coordinates=k) for k, name in enumerate(names)),
        texture_shader=shader.texture_shader,
        register_combiners=shader.combiners,
    )
    commands.append(Draw(label="points", mesh=mesh, state=state))
    result = execute(tuple(commands), NV2A, COUNT, 1)
    assert result.fragments == COUNT
    return result.framebuffer.color.reshape(COUNT, 4).tolist()


ARITHMETIC = {
    "lit normals": "dp3_sat r0.rgb, t0_bx2, v0_bx2\n+mul r0.a, t0.a, v0.a\nmad r0.rgb, r0, t1, v1\n",
    "signed and scaled": "sub_x2 r0, t0, t1\nmad_sat r0, -r0, v0, c1\nadd_d2 r0, r0, c0\n",
    "mixed": "lrp r1, v0.a, t0, 1-t1\nmul_x4 r0, r1_bias, c1\nadd_sat r0, r0, v1.a\n",
    "chosen": "mov r0, t0\ncnd r0, r0.a, t1, 1-v0\n",
    "compared": "sub r1.a, t0, v0\ncmp r0, r1.a, t0, t1\n",
}


@pytest.mark.parametrize("name", ARITHMETIC)
def test_arithmetic_on_texels_and_vertex_colors(name):
    text = (
        "ps.1.3\ndef c0, 0.2, 0.4, 0.6, 0.8\ndef c1, -0.5, -0.25, -1, 0.75\ntex t0\ntex t1\n"
        + ARITHMETIC[name]
    )
    random = np.random.default_rng(len(name))
    images = random.integers(0, 256, (2, SIDE, SIDE, 4), np.uint8)
    colors, secondary = random.integers(0, 256, (2, COUNT, 4))
    places = random.integers(0, SIDE, (2, COUNT, 2))
    sets = [np.column_stack([(p + 0.5) / SIDE, np.zeros(COUNT), np.ones(COUNT)]) for p in places]
    drawn = draw(text, images, colors, secondary, sets)
    for k in range(COUNT):
        texels = [image[p[k][1], p[k][0]].tolist() for image, p in zip(images, places, strict=True)]
        texels += [[0] * 4] * 2
        v0, v1 = colors[k].tolist(), secondary[k].tolist()
        expected = pixel_shader.evaluate(text, texels, v0, v1, CHIP)
        assert drawn[k] == expected, (k, texels, v0, v1)


def texel_at(image, s, t):
    """The nearest texel, edges repeated; none where another lies within 1/100 of a texel."""
    places = []
    for coordinate in (s, t):
        place = min(max(coordinate * SIDE, 0), SIDE - 0.5)
        if abs(place - round(place)) < 0.01 and 0 < round(place) < SIDE:
            return None
        places.append(int(place))
    return image[places[1], places[0]].tolist()


# The instruction, and where it looks: from the texel of t0, in [0, 1], and the coordinates of units 1 and 2.
ADDRESSED = {
    "texreg2ar t1, t0": (1, lambda t, u, v: (t[3], t[0])),
    "texreg2gb t1, t0": (1, lambda t, u, v: (t[1], t[2])),
    "texm3x2pad t1, t0\ntexm3x2tex t2, t0": (2, lambda t, u, v: (t[:3] @ u[:3], t[:3] @ v[:3])),
    "texm3x2pad t1, t0_bx2\ntexm3x2tex t2, t0_bx2": (
        2,
        lambda t, u, v: ((2 * t[:3] - 1) @ u[:3], (2 * t[:3] - 1) @ v[:3]),
    ),
}


@pytest.mark.parametrize("lines", ADDRESSED)
def test_texture_instructions_look_where_they_say(lines):
    unit, place = ADDRESSED[lines]
    random = np.random.default_rng(len(lines))
    images = random.integers(0, 256, (3, SIDE, SIDE, 4), np.uint8)
    zeros = np.zeros((COUNT, 4))
    where = random.integers(0, SIDE, (COUNT, 2))
    first = np.column_stack([(where + 0.5) / SIDE, np.zeros(COUNT), np.ones(COUNT)])
    sets = [first, *random.uniform(0, 0.6, (2, COUNT, 4))]
    drawn = draw(f"ps.1.3\ntex t0\n{lines}\nmov r0, t{unit}\n", images, zeros, zeros, sets)
    checked = 0
    for k in range(COUNT):
        texel = images[0][where[k][1], where[k][0]] / 255
        expected = texel_at(images[unit], *place(texel, sets[1][k], sets[2][k]))
        checked += expected is not None
        assert expected in (None, drawn[k]), k
    assert checked > COUNT // 2


def test_texcoord_is_a_color_and_texkill_drops_what_is_below_zero():
    random = np.random.default_rng(1)
    images = random.integers(0, 256, (2, SIDE, SIDE, 4), np.uint8)
    zeros = np.zeros((COUNT, 4))
    kept = random.integers(0, 2, COUNT)
    coordinates = random.integers(-64, 320, (COUNT, 4))
    sets = [coordinates / 255, np.column_stack([1.0 - 2 * (1 - kept), np.ones((COUNT, 3))])]
    shader = "ps.1.1\ntexcoord t0\ntexkill t1\nmov r0, t0\n"
    drawn = np.array(draw(shader, images, zeros, zeros, sets))
    expected = np.clip(coordinates, 0, 255) * kept[:, None]
    expected[:, 3] = 255 * kept  # by definition, whatever the fourth coordinate
    assert (drawn == expected).all()
