"""Pixel_shader: one quad, or a table of quads, for each texture shader operation.

Source: src/tests/pixel_shader_tests.cpp of nxdk_pgraph_tests. Most cases read two pictures of its resources.
"""

from dataclasses import replace
from itertools import product

import numpy as np

from effects.conformance import scenes
from effects.conformance.case import Case, MissingInput
from pipeline.commands import Draw, TexImage
from pipeline.enums import CullMode, Register
from pipeline.enums import TextureShaderOperation as Operation
from pipeline.state import TextureShaderStage, TextureUnit
from pipeline.textures import texture_2d

SUITE = "Pixel_shader"

DEPENDENT = {
    "StageDependentAlphaRed": Operation.DEPENDENT_AR_TEXTURE_2D,
    "StageDependentGreenBlue": Operation.DEPENDENT_GB_TEXTURE_2D,
}
WITH_PICTURES = ("BumpEnvMap", "BumpEnvMapLuminance", "DotST", "DotZW")
LEFT, TOP, SIZE = 192.0, 112.0, 256.0  # a quad in the middle
PASSED = [(0.0, 0.0, 1.0, 0.25), (0.0, 1.0, 0.0, 0.5), (1.0, 0.0, 0.0, 0.75), (1.0, 1.0, 0.4, 0.33)]
# ClipPlane: each quad's colour (0xAABBGGRR) and its corners' coordinates; the first quad is not discarded.
PLANES = (
    (0xFF7F44DD, [(0, 0.1, -0.02, -0.25), (1, -0.3, 1, 0), (-1, -0.1, -0.1, 0.5), (-0.1, 2, 3, 0.25)]),
    (
        0xFF6EDD44,
        [(-0.1, -0.1, 0.02, 0.25), (0.1, 0.3, -0.2, -0.01), (1, 0.1, 0.1, -0.25), (0.1, -0.6, 1.1, -0.35)],
    ),
    (
        0xFFEE6655,
        [(-0.1, -0.1, -0.1, 0.1), (0.1, -0.1, -0.1, -0.1), (-0.1, 0.1, -0.1, -0.1), (-0.1, -0.1, 0.1, -0.1)],
    ),
)


def names():
    """Every case of the suite."""
    return ["Passthru", "ClipPlane", *WITH_PICTURES, *DEPENDENT]


def screen_quad(left, top, size, coordinates, **arrays):
    """A quad between pixels: its corners' coordinates belong to the centres of the pixels right and below.

    Measured: SetScreenVertex lands half a pixel right and down (BumpEnvMap, ClipPlane captures).
    """
    corners = scenes.rectangle(left + 0.5, top + 0.5, left + size + 0.5, top + size + 0.5)
    given = tuple(scenes.single(c) for c in coordinates)
    return scenes.window_mesh(corners, texture_coordinates=given, **arrays)


def _unit(texture=None, coordinates=0):
    return TextureUnit(texture, scenes.NEAREST, coordinates=coordinates)


def _state(register, units, stages):
    combiners = scenes.shows(register)
    return replace(scenes.DEFAULT, register_combiners=combiners, texture_units=units, texture_shader=stages)


def _passthru():
    state = _state(Register.TEXTURE0, (_unit(),), (TextureShaderStage(Operation.PASS_THROUGH),))
    return (
        scenes.clear(0xFF222222),
        Draw(label="coordinates", mesh=screen_quad(LEFT, TOP, SIZE, (PASSED,)), state=state),
    )


def _clip_plane():
    commands, combiners = [scenes.clear(0xFF000000)], scenes.SHOWS_PRIMARY
    for number, modes in enumerate(product((CullMode.GEQUAL, CullMode.LESS), repeat=4)):
        left, top = 32.0 + 80 * (number % 8), 208.0 + 96 * (number // 8)
        for unit, (color, _) in enumerate(((0xFF333333, None), *PLANES)):
            stages = [TextureShaderStage()] * 3
            if unit:
                stages[unit - 1] = TextureShaderStage(Operation.CULL_FRAGMENT, cull_modes=modes)
            state = replace(
                scenes.DEFAULT,
                register_combiners=combiners,
                texture_units=tuple(_unit(coordinates=k) for k in range(3)),
                texture_shader=tuple(stages),
            )
            mesh = screen_quad(
                left, top, 64.0, [plane for _, plane in PLANES], colors=[scenes.abgr(color)] * 4
            )
            commands.append(Draw(label=f"quad {number}, plane {unit}", mesh=mesh, state=state))
    return tuple(commands)


def _ramps(size):
    return (np.arange(size, dtype=np.float32) * np.float32(255) / np.float32(size)).astype(np.int64)


def gradients(size):
    """uint8 [size, size, 4]: red grows downwards, green to the right, blue upwards, alpha with both."""
    y, x = np.meshgrid(_ramps(size), _ramps(size), indexing="ij")
    return np.stack([y, x, 255 - y, (x + y) & 255], -1).astype(np.uint8)


def radial_gradients(size):
    """uint8 [size, size, 4]: four small gradients, and an alpha that falls with the squared distance."""
    quarter, half = gradients(size // 2), np.float32(size // 2)
    out = np.tile(quarter, (2, 2, 1))
    offset = np.arange(size, dtype=np.float32) - half
    distance = offset[None] * offset[None] + offset[:, None] * offset[:, None]
    out[..., 3] = (np.float32(255) * (np.float32(1) - distance / (half * half + half * half))).astype(
        np.uint8
    )
    return out


def _dependent(operation):
    stages = (TextureShaderStage(Operation.TEXTURE_2D), TextureShaderStage(operation))
    mesh = screen_quad(LEFT, TOP, SIZE, (scenes.UNIT_SQUARE, np.zeros((4, 2))))
    return (
        scenes.clear(0xFF282828),
        TexImage(label="radial", texture="radial", image=texture_2d(radial_gradients(256))),
        TexImage(label="gradients", texture="gradients", image=texture_2d(gradients(256))),
        Draw(
            label="dependent",
            mesh=mesh,
            state=_state(Register.TEXTURE1, (_unit("radial"), _unit("gradients", 1)), stages),
        ),
    )


def case(name, inputs):
    """The case of that name, or None."""
    if name in WITH_PICTURES:
        for picture in ("water_bump_map.png", "bump_map_test_image.png"):
            inputs.path(f"pixel_shader/{picture}")
        raise MissingInput("its two pictures were not at hand when this suite was written")
    if name in DEPENDENT:
        return Case(commands=_dependent(DEPENDENT[name]))
    commands = {"Passthru": _passthru, "ClipPlane": _clip_plane}.get(name)
    return Case(commands=commands()) if commands else None
