"""Pixel_shader: one quad, or a table of quads, for each texture shader operation.

Source: src/tests/pixel_shader_tests.cpp of nxdk_pgraph_tests. Four cases read two pictures of its resources.
"""

from dataclasses import replace
from functools import partial
from itertools import product

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import Case, Shows
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.enums import ComparisonFunction, CullMode, Register, TextureTarget
from fixedpipe.pipeline.enums import TextureShaderOperation as Operation
from fixedpipe.pipeline.state import DepthTest, TextureShaderStage, TextureUnit
from fixedpipe.pipeline.textures.images import texture_2d

SUITE = "Pixel_shader"

BUMPS, IMAGE = "water_bump_map.png", "bump_map_test_image.png"
# BumpEnvMap: matrices as SET_TEXTURE_SET_BUMP_ENV_MAT takes them: s by ds, t by ds, t by dt, s by dt.
MATRICES = (
    (-1.0, 0.0, 1.0, 0.0),
    (1.0, 1.0, 1.0, 1.0),
    (0.0, 0.2, 0.0, 0.75),
    (0.5, -0.5, 0.5, -0.5),
    (0.3, 0.5, 0.7, 1.0),
    (0.0, 1.0, -1.0, 0.0),
    (0.0, 0.0, 1.0, 1.0),
    (0.5, 0.8, 0.0, 0.0),
)
JITTERS, SCALES, BIASES = (0.0, 0.5), (0.0, 1.0, 2.0), (0.0, 0.25, 0.75, 1.0)  # BumpEnvMapLuminance
POINTS = ((-1, 1, 4), (1, 1, 7), (1, -2, 6), (-1, -2, 4))  # DotST: what the eye and the light look at
EYE, LIGHT = (0.0, 0.0, -7.0), (-1.5, 5.0, 0.0)
# DotZW: two rows of a matrix at each corner.
NUMERATORS = ((1000, 1000, 1000), (100, 100, 40000), (10, 100, 1000), (100, 100, 100))
DENOMINATORS = ((0.1, 0.1, 0.1), (1, 1, 0), (1, 0, 0), (0, 0, 1))
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
        left, top = 32.0 + 80 * (number % 7), 208.0 + 96 * (number // 7)
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


def _rectangle(name, inputs):
    image = replace(texture_2d(inputs.picture(name)), target=TextureTarget.TEXTURE_RECTANGLE)
    return TexImage(label=name, texture=name, image=image)


def _texels(width=128.0, height=128.0):
    return scenes.UNIT_SQUARE * (width, height)


def _bump_env(inputs, luminance):
    size, background = (64.0 if luminance else 128.0), scenes.clear(0xFF222222)
    commands = [background, _rectangle(BUMPS, inputs), _rectangle(IMAGE, inputs)]
    plain = (TextureShaderStage(Operation.TEXTURE_RECTANGLE),)
    for top, name in ((64.0, IMAGE), (64.0 + size + 16.0, BUMPS)):
        frame = screen_quad(6.0, top - 2.0, size + 4.0, (), colors=np.ones((4, 4)))
        commands.append(Draw(label="a white frame", mesh=frame, state=scenes.DEFAULT))
        mesh = screen_quad(8.0, top, size, (_texels(),))
        state = _state(Register.TEXTURE0, (_unit(name),), plain)
        commands.append(Draw(label=name, mesh=mesh, state=state))
    for left, top, operation, fields in _jittered() if luminance else _turned():
        (s_ds, t_ds, t_dt, s_dt), scale, bias = fields
        offset = TextureShaderStage(
            operation,
            offset_texture_matrix=(s_ds, t_ds, s_dt, t_dt),
            offset_texture_scale=scale,
            offset_texture_bias=bias,
        )
        state = _state(Register.TEXTURE1, (_unit(BUMPS), _unit(IMAGE, 1)), (*plain, offset))
        mesh = screen_quad(left, top, size, (_texels(), _texels()))
        commands.append(Draw(label="offset", mesh=mesh, state=state))
    return Case(commands=tuple(commands))


def _turned():
    """BumpEnvMap's quads: three to a row."""
    for number, matrix in enumerate(MATRICES):
        left, top = 152.0 + 144 * (number % 3), 64.0 + 144 * (number // 3)
        yield left, top, Operation.OFFSET_TEXTURE_RECTANGLE, (matrix, 1.0, 0.0)


def _jittered():
    """BumpEnvMapLuminance's quads: a column for each scale, a row for each bias, twice."""
    for group, jitter in enumerate(JITTERS):
        for (column, scale), (row, bias) in product(enumerate(SCALES), enumerate(BIASES)):
            left, top = 88.0 + 280 * group + 80 * column, 96.0 + 80 * row
            yield left, top, Operation.OFFSET_TEXTURE_RECTANGLE_SCALE, ((jitter,) * 4, scale, bias)


def _directions(points):
    """float64 [4, 3] each: from the eye to the points, and from them to the light, normalised."""
    away, towards = np.subtract(points, EYE), np.subtract(LIGHT, points)
    return [v / np.linalg.norm(v, axis=1)[:, None] for v in (away, towards)]


def _dots(last, register, coordinates, units, images, **state):
    """A quad in the middle whose stages 1 and 2 multiply the bump map's texels by ``coordinates``."""
    stages = tuple(map(TextureShaderStage, (Operation.TEXTURE_RECTANGLE, Operation.DOT_PRODUCT, last)))
    mesh = screen_quad(LEFT, TOP, SIZE, (_texels(), *coordinates))
    state = replace(_state(register, units, stages), **state)
    return (scenes.clear(0xFF222222), *images, Draw(label=last.name, mesh=mesh, state=state))


def _dot_st(inputs):
    image = TexImage(label=IMAGE, texture=IMAGE, image=texture_2d(inputs.picture(IMAGE)))
    units, images = (_unit(BUMPS), _unit(None, 1), _unit(IMAGE, 2)), (_rectangle(BUMPS, inputs), image)
    last = Operation.DOT_PRODUCT_TEXTURE_2D
    return Case(commands=_dots(last, Register.TEXTURE2, _directions(POINTS), units, images))


def _dot_zw(inputs):
    """The program shows the depths as colours, in the quad."""
    units = (_unit(BUMPS), _unit(None, 1), _unit(None, 2))
    commands = _dots(
        Operation.DOT_PRODUCT_DEPTH_REPLACE,
        Register.TEXTURE0,
        (NUMERATORS, DENOMINATORS),
        units,
        (_rectangle(BUMPS, inputs),),
        depth_test=DepthTest(ComparisonFunction.ALWAYS),
    )
    box = tuple(int(edge) for edge in (LEFT, TOP, LEFT + SIZE, TOP + SIZE))
    return Case(
        commands=commands,
        region=(box,),
        shows=Shows.ZETA_TEXTURE,
        depth_bits=16,
    )


CASES = {
    "Passthru": partial(Case.of, _passthru),
    "ClipPlane": partial(Case.of, _clip_plane),
    "BumpEnvMap": partial(_bump_env, luminance=False),
    "BumpEnvMapLuminance": partial(_bump_env, luminance=True),
    "DotST": _dot_st,
    "DotZW": _dot_zw,
    "StageDependentAlphaRed": partial(Case.of, _dependent, Operation.DEPENDENT_AR_TEXTURE_2D),
    "StageDependentGreenBlue": partial(Case.of, _dependent, Operation.DEPENDENT_GB_TEXTURE_2D),
}
