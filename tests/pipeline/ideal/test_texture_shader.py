"""The ideal's texture shaders: closed forms exactly, and random programs beside the machines' bytes."""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.pipeline.commands import Clear, Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import (
    ComparisonFunction,
    ComponentUsage,
    CullMode,
    DotProductMapping,
    InternalFormat,
    PrimitiveType,
    Register,
    TextureFilter,
    TextureTarget,
    WrapMode,
)
from fixedpipe.pipeline.enums import TextureShaderOperation as Operation
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import FUTURE, GEFORCE_3, IDEAL, NV2A
from fixedpipe.pipeline.state import (
    CombinerInput,
    DepthTest,
    FinalCombiner,
    PassState,
    RegisterCombiners,
    Sampler,
    SignedComponents,
    TextureShaderStage,
    TextureUnit,
)
from fixedpipe.pipeline.textures.images import Texture, texture_2d, texture_3d, texture_cube_map
from fixedpipe.pipeline.validation.validate import validate
from fixedpipe.pipeline.validation.walk import UnsupportedState

NOISE = 1e-12  # of some dozens of float64 operations
SIZE = 8
EDGE = Sampler(
    TextureFilter.LINEAR, TextureFilter.LINEAR, *(WrapMode.CLAMP_TO_EDGE,) * 2, wrap_r=WrapMode.CLAMP_TO_EDGE
)
NEAREST = replace(EDGE, min_filter=TextureFilter.NEAREST, mag_filter=TextureFilter.NEAREST)
SIGNED = replace(NEAREST, signed_components=SignedComponents(True, True, True, True))
DOT = Operation.DOT_PRODUCT
CENTRES = (np.arange(SIZE) + 0.5) / SIZE


def shows(register):
    """Combiners that show a register's RGB, and alpha of what is shown."""
    return RegisterCombiners(
        final=FinalCombiner(
            a=CombinerInput(),
            c=CombinerInput(),
            d=CombinerInput(register),
            g=CombinerInput(register, usage=ComponentUsage.ALPHA),
        ),
    )


def frame(textures, stages, coordinates, *, register=None, samplers=None, depth_test=None):
    """One square over the window. ``textures``: name to Texture; ``stages``: (operation, texture or None,
    changes) of each unit; ``coordinates``: of each unit [4, 4], s t r q of the corners.
    """
    names = [name for _, name, _ in stages]
    units = tuple(
        TextureUnit(name, (samplers or {}).get(i, NEAREST), coordinates=i) for i, name in enumerate(names)
    )
    square = np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]])
    state = PassState(
        register_combiners=shows(
            Register(Register.TEXTURE0 + (len(stages) - 1 if register is None else register))
        ),
        texture_units=units,
        texture_shader=tuple(TextureShaderStage(operation, **more) for operation, _, more in stages),
        depth_test=depth_test,
    )
    mesh = Mesh(
        square, PrimitiveType.QUADS, texture_coordinates=tuple(np.array(c, float) for c in coordinates)
    )
    return (
        Clear(label="clear", color=(0.0,) * 4, depth=1.0),
        *(TexImage(label=name, texture=name, image=image) for name, image in textures.items()),
        Draw(label="draw", mesh=mesh, state=state),
    )


def constant(s=0.0, t=0.0, r=0.0, q=1.0):
    """The same coordinates at four corners."""
    return [[s, t, r, q]] * 4


SQUARE = [[0, 0, 0, 1], [1, 0, 0, 1], [1, 1, 0, 1], [0, 1, 0, 1]]


def shown(commands, **more):
    """The ideal's picture, bottom row first."""
    return execute_ideal(commands, SIZE, SIZE, threads=1, **more).color[::-1]


def one_texel(*rgba):
    return texture_2d(np.array([[rgba]], float))


def ramp(size, function, channels=3):
    """A square table of floats: function(s, t) at the texels' centres."""
    centres = (np.arange(size) + 0.5) / size
    s, t = np.meshgrid(centres, centres)
    return texture_2d(np.stack([function(s, t)] * channels, axis=-1))


# ---------------------------------------------------------------------------------------- closed forms


def test_coordinates_pass_through_clamped():
    across = [[-1, 0.25, 2, 0.5], [1, 0.25, 2, 0.5], [1, 0.25, 2, 0.5], [-1, 0.25, 2, 0.5]]
    got = shown(frame({}, [(Operation.PASS_THROUGH, None, {})], [across]))
    row = np.clip(-1.0 + 2.0 * CENTRES, 0.0, 1.0)
    np.testing.assert_allclose(got[..., 0], np.tile(row, (SIZE, 1)), atol=NOISE)
    np.testing.assert_allclose(got[0, :, 1:], [[0.25, 1.0, 0.5]] * SIZE, atol=NOISE)


def test_a_projective_access_divides_by_q():
    table = ramp(64, lambda s, t: s)
    corners = np.array(SQUARE, float)
    corners[:, :2] *= 2.0
    corners[:, 3] = 2.0
    got = shown(frame({"t": table}, [(Operation.TEXTURE_2D, "t", {})], [corners], samplers={0: EDGE}))
    np.testing.assert_allclose(got[..., 0], np.tile(CENTRES, (SIZE, 1)), atol=NOISE)


def test_fragments_are_culled_by_the_signs_of_their_coordinates():
    across = [[-1, 1, 1, 1], [1, 1, 1, 1], [1, 1, 1, 1], [-1, 1, 1, 1]]
    for mode in CullMode:
        modes = (mode, *(CullMode.GEQUAL,) * 3)
        stages = [(Operation.PASS_THROUGH, None, {}), (Operation.CULL_FRAGMENT, None, {"cull_modes": modes})]
        got = shown(frame({}, stages, [constant(1, 1, 1, 1), across], register=0))
        drawn = (CENTRES < 0.5) if mode is CullMode.LESS else (CENTRES > 0.5)
        np.testing.assert_array_equal(got[..., 0], np.tile(drawn, (SIZE, 1)).astype(float))


@pytest.mark.parametrize(("operation", "pair"), [("AR", (0.25, 0.75)), ("GB", (0.5, 0.125))])
def test_dependent_lookups_read_at_the_components_themselves(operation, pair):
    # s is alpha and t red, or s green and t blue; LINEAR keeps a plane between the texels' centres.
    table = ramp(256, lambda s, t: (s + 2.0 * t) / 4.0)
    texel = one_texel(0.75, 0.5, 0.125, 0.25)
    stages = [(Operation.TEXTURE_2D, "p", {}), (Operation[f"DEPENDENT_{operation}_TEXTURE_2D"], "f", {})]
    got = shown(frame({"p": texel, "f": table}, stages, [constant(), constant()], samplers={1: EDGE}))
    np.testing.assert_allclose(got[..., 0], (pair[0] + 2.0 * pair[1]) / 4.0, atol=NOISE)


def test_offsets_are_signed_and_go_through_the_matrix():
    table = ramp(64, lambda s, t: (s + 2.0 * t) / 4.0)
    ds, dt, matrix = -0.25, 0.5, (0.5, 0.25, -0.125, 0.0625)
    # Two's complement: 128 v, or 256 more where that is negative.
    texel = one_texel(0.0, 128.0 * dt / 255.0, (256.0 + 128.0 * ds) / 255.0, 1.0)
    stages = [
        (Operation.TEXTURE_2D, "o", {}),
        (Operation.OFFSET_TEXTURE_2D, "f", {"offset_texture_matrix": matrix}),
    ]
    place = 0.5 + matrix[0] * ds + matrix[2] * dt, 0.375 + matrix[1] * ds + matrix[3] * dt
    for first in (NEAREST, SIGNED):
        samplers = {0: first, 1: EDGE}
        got = shown(
            frame({"o": texel, "f": table}, stages, [constant(), constant(0.5, 0.375)], samplers=samplers)
        )
        np.testing.assert_allclose(got[..., 0], (place[0] + 2.0 * place[1]) / 4.0, atol=NOISE)


def test_a_signed_filter_passes_through_zero():
    """Between -32/128 and 32/128 lies 0, not the middle of the bytes 224 and 32."""
    pair = texture_2d(np.array([[[0.0, 0.0, 224.0 / 255.0, 1.0], [0.0, 0.0, 32.0 / 255.0, 1.0]]]))
    samplers = {0: replace(EDGE, signed_components=SIGNED.signed_components), 1: EDGE}
    table = ramp(64, lambda s, t: s)
    stages = [(Operation.TEXTURE_2D, "o", {}), (Operation.OFFSET_TEXTURE_2D, "f", {})]
    got = shown(
        frame({"o": pair, "f": table}, stages, [constant(0.5, 0.5), constant(0.375, 0.5)], samplers=samplers)
    )
    np.testing.assert_allclose(got[..., 0], 0.375, atol=NOISE)


def test_a_scale_multiplies_colours_by_the_magnitude_and_clamps():
    texel, image = one_texel(0.5, 0.0, 0.0, 1.0), one_texel(0.5, 0.75, 1.0, 0.25)
    more = {"offset_texture_scale": 2.0, "offset_texture_bias": 0.2}
    stages = [(Operation.TEXTURE_2D, "o", {}), (Operation.OFFSET_TEXTURE_2D_SCALE, "f", more)]
    for bias, expected in ((0.2, [0.5, 0.75, 1.0]), (-0.5, [0.25, 0.375, 0.5]), (-2.0, [0.0] * 3)):
        more["offset_texture_bias"] = bias
        got = shown(frame({"o": texel, "f": image}, stages, [constant(), constant()]))
        np.testing.assert_allclose(got[0, 0], [*expected, 0.25], atol=NOISE)


def test_a_later_stage_reads_the_texel_before_it_is_scaled():
    """Source: NV_texture_shader section 3.8.13.1.9."""
    images = {"o": one_texel(0.0, 0.0, 0.0, 1.0), "f": one_texel(0.0, 0.5, 0.25, 1.0)}
    images["t"] = ramp(64, lambda s, t: (s + 2.0 * t) / 4.0)
    more = {"offset_texture_scale": 0.0, "offset_texture_bias": 0.5}
    stages = [
        (Operation.TEXTURE_2D, "o", {}),
        (Operation.OFFSET_TEXTURE_2D_SCALE, "f", more),
        (Operation.DEPENDENT_GB_TEXTURE_2D, "t", {"previous_texture_input": 1}),
    ]
    got = shown(frame(images, stages, [constant()] * 3, samplers={2: EDGE}))
    np.testing.assert_allclose(got[..., 0], (0.5 + 2.0 * 0.25) / 4.0, atol=NOISE)


NORMAL = np.array([0.25, -0.5, 0.75])


def expanded():
    return one_texel(*(NORMAL * 0.5 + 0.5), 1.0)


EXPAND = {"dot_product_mapping": DotProductMapping.EXPAND_NORMAL}


def test_two_dot_products_place_a_plane_s_texel():
    table = ramp(256, lambda s, t: (s + 2.0 * t) / 4.0)
    a, b = np.array([0.5, -0.25, 0.5]), np.array([1.0, 0.5, 0.25])
    stages = [
        (Operation.TEXTURE_2D, "n", {}),
        (DOT, None, EXPAND),
        (Operation.DOT_PRODUCT_TEXTURE_2D, "f", EXPAND),
    ]
    got = shown(
        frame(
            {"n": expanded(), "f": table},
            stages,
            [constant(), constant(*a), constant(*b)],
            samplers={2: EDGE},
        )
    )
    expected = (a @ NORMAL + 2.0 * (b @ NORMAL)) / 4.0
    np.testing.assert_allclose(got[..., 0], expected, atol=NOISE)


def directions_cube(size=4):
    """A cube map whose texels are the directions themselves on the face's plane, (d / |major| + 1) / 2: its
    filter reproduces them inside a face.
    """
    # sc and tc as (component, sign).  Source: EXT_texture_cube_map, section 3.8.6.
    across = ((2, -1), (2, 1), (0, 1), (0, 1), (0, 1), (0, -1))
    up = ((1, -1), (1, -1), (2, 1), (2, -1), (1, -1), (1, -1))
    centres = 2.0 * (np.arange(size) + 0.5) / size - 1.0
    faces = np.empty((6, size, size, 3))
    for face in range(6):
        tc, sc = np.meshgrid(centres, centres, indexing="ij")
        faces[face, :, :, face // 2] = 1.0 if face % 2 == 0 else -1.0
        for (component, sign), values in ((across[face], sc), (up[face], tc)):
            faces[face, :, :, component] = sign * values
    return texture_cube_map(faces * 0.5 + 0.5)


def turned_dot_products(q=(1.0, 1.0, 1.0)):
    """Coordinates of three dot products whose matrix is the identity, so that they give the normal."""
    return [constant(*row, e) for row, e in zip(np.eye(3), q, strict=True)]


@pytest.mark.parametrize("axis", range(3))
def test_reflections_place_a_cube_map_s_texel(axis):
    normal = np.roll(np.array([0.3, -0.4, 0.8]), axis)
    texel = one_texel(*(normal * 0.5 + 0.5), 1.0)
    eye = np.roll(np.array([0.1, 0.2, 1.0]), axis)
    reflection = 2.0 * normal * (normal @ eye) - eye * (normal @ normal)
    cases = {
        Operation.DOT_PRODUCT_TEXTURE_CUBE_MAP: (normal, {}, turned_dot_products()),
        Operation.DOT_PRODUCT_REFLECT_CUBE_MAP: (reflection, {}, turned_dot_products(eye)),
        Operation.DOT_PRODUCT_CONST_EYE_REFLECT_CUBE_MAP: (
            reflection,
            {"constant_eye": tuple(eye)},
            turned_dot_products(),
        ),
    }
    for operation, (direction, more, coordinates) in cases.items():
        stages = [(Operation.TEXTURE_2D, "n", {}), (DOT, None, EXPAND), (DOT, None, EXPAND)]
        stages.append((operation, "c", EXPAND | more))
        textures = {"n": texel, "c": directions_cube()}
        got = shown(frame(textures, stages, [constant(), *coordinates], samplers={3: EDGE}))
        expected = direction / np.abs(direction).max() * 0.5 + 0.5
        np.testing.assert_allclose(got[0, 0, :3], expected, atol=NOISE, err_msg=operation.name)


def test_the_diffuse_stage_reads_at_the_normal_and_the_next_at_its_reflection():
    eye = np.array([0.1, 0.2, 1.0])
    texel, textures = NORMAL * 0.5 + 0.5, {"c": directions_cube()}
    stages = [
        (Operation.TEXTURE_2D, "n", {}),
        (DOT, None, EXPAND),
        (Operation.DOT_PRODUCT_DIFFUSE_CUBE_MAP, "c", EXPAND),
        (Operation.DOT_PRODUCT_REFLECT_CUBE_MAP, "c", EXPAND),
    ]
    commands = lambda register: frame(  # noqa: E731
        {"n": one_texel(*texel, 1.0), **textures},
        stages,
        [constant(), *turned_dot_products(eye)],
        samplers={2: EDGE, 3: EDGE},
        register=register,
    )
    reflection = 2.0 * NORMAL * (NORMAL @ eye) - eye * (NORMAL @ NORMAL)
    for register, direction in ((2, NORMAL), (3, reflection)):
        expected = direction / np.abs(direction).max() * 0.5 + 0.5
        np.testing.assert_allclose(shown(commands(register))[0, 0, :3], expected, atol=NOISE)


def test_three_dot_products_place_a_volume_s_texel():
    centres = (np.arange(32) + 0.5) / 32
    r, t, s = np.meshgrid(centres, centres, centres, indexing="ij")
    volume = texture_3d(np.stack([s, t, r], axis=-1))
    vector = np.array([0.25, 0.5, 0.75])
    stages = [(Operation.TEXTURE_2D, "n", {}), (DOT, None, {}), (DOT, None, {})]
    stages.append((Operation.DOT_PRODUCT_TEXTURE_3D, "v", {}))
    got = shown(
        frame(
            {"n": one_texel(*vector, 1.0), "v": volume},
            stages,
            [constant(), *turned_dot_products()],
            samplers={3: EDGE},
        )
    )
    np.testing.assert_allclose(got[0, 0, :3], vector, atol=NOISE)


def test_a_quotient_replaces_the_depth_and_ends_what_lies_outside():
    stages = [
        (Operation.TEXTURE_2D, "n", {}),
        (DOT, None, {}),
        (Operation.DOT_PRODUCT_DEPTH_REPLACE, None, {}),
    ]
    across = [[-0.5, 0, 0, 1], [1.5, 0, 0, 1], [1.5, 0, 0, 1], [-0.5, 0, 0, 1]]
    commands = frame(
        {"n": one_texel(1.0, 1.0, 1.0, 1.0)},
        stages,
        [constant(), across, constant(2.0)],
        register=0,
        depth_test=DepthTest(ComparisonFunction.ALWAYS, write=True),
    )
    result = execute_ideal(commands, SIZE, SIZE, threads=1)
    quotient = (-0.5 + 2.0 * CENTRES) / 2.0
    drawn = quotient >= 0.0
    np.testing.assert_array_equal(result.color[..., 0], np.tile(drawn, (SIZE, 1)).astype(float))
    np.testing.assert_allclose(result.depth[0], np.where(drawn, quotient, 1.0), atol=NOISE)


def test_directions_of_two_textures_place_a_volume_s_texel():
    centres = (np.arange(16) + 0.5) / 16
    r, t, s = np.meshgrid(centres, centres, centres, indexing="ij")
    words = {"e": (20000, 10000), "k": (40000, 30000)}  # theta and phi of the eye, of the light
    textures = {
        name: one_texel(theta % 256 / 255, phi // 256 / 255, phi % 256 / 255, theta // 256 / 255)
        for name, (theta, phi) in words.items()
    }
    textures["v"] = texture_3d(np.stack([s, t, r], axis=-1))
    stages = [(Operation.TEXTURE_2D, "e", {}), (Operation.TEXTURE_2D, "k", {})]
    stages.append((Operation.BRDF_TEXTURE_3D, "v", {}))
    got = shown(frame(textures, stages, [constant()] * 3, samplers={2: EDGE}))
    np.testing.assert_allclose(got[0, 0, :3], [20000 / 65535, 40000 / 65535, 20000 / 65536], atol=1e-9)


@pytest.mark.parametrize(
    ("mapping", "vector"),
    [
        # Of the bytes R, G, B, A = 200, 100, 128, 64.  Source: docs/numbers.md, section 12.
        (DotProductMapping.UNSIGNED_IDENTITY, (200 / 255, 100 / 255, 128 / 255)),
        (DotProductMapping.EXPAND_NORMAL, (400 / 255 - 1, 200 / 255 - 1, 256 / 255 - 1)),
        (DotProductMapping.SIGNED_ODD, (-111 / 255, 201 / 255, -255 / 255)),
        (DotProductMapping.SIGNED_IDENTITY, (-56 / 127, 100 / 127, -128 / 127)),
        (DotProductMapping.UNSIGNED_HILO, ((64 * 256 + 200) / 65535, (100 * 256 + 128) / 65535, 1.0)),
        (
            DotProductMapping.SIGNED_HILO_HEMISPHERE,
            (
                16584 / 32767,
                25728 / 32767,
                (1.0 - (16584 / 32767) ** 2 - (25728 / 32767) ** 2) ** 0.5,
            ),
        ),
    ],
)
def test_dot_products_read_texels_by_their_mapping(mapping, vector):
    table = ramp(512, lambda s, t: s)
    texel = texture_2d(np.array([[[200, 100, 128, 64]]], np.uint8))
    for k, component in enumerate(vector):
        scaled = 0.5 * np.eye(3)[k]  # s = component / 2 + 1/2 in a repeating table
        stages = [
            (Operation.TEXTURE_2D, "n", {}),
            (DOT, None, {"dot_product_mapping": mapping}),
            (Operation.DOT_PRODUCT_TEXTURE_2D, "f", {}),
        ]
        samplers = {2: replace(EDGE, wrap_s=WrapMode.REPEAT)}
        coordinates = [constant(), constant(*scaled), constant()]
        got = shown(frame({"n": texel, "f": table}, stages, coordinates, samplers=samplers))[0, 0, 0]
        place = component / 2.0 % 1.0
        if 1 / 1024 < place < 1023 / 1024:
            assert abs(got - place) < 1e-9, (k, got, place)


def test_hilo_words_are_filtered_as_words():
    """Halfway between the words -1000 and 3000 lies 1000: their high bytes alone say otherwise."""
    words = np.array([-1000, 3000]) & 0xFFFF
    texels = np.zeros((1, 1, 2, 4), np.uint8)
    texels[0, 0, :, 0], texels[0, 0, :, 3] = words & 255, words >> 8
    pair = Texture(TextureTarget.TEXTURE_2D, InternalFormat.HILO16, (texels,))
    signed = SignedComponents(green=True, alpha=True)
    stages = [
        (Operation.TEXTURE_2D, "n", {}),
        (DOT, None, {"dot_product_mapping": DotProductMapping.SIGNED_HILO_HEMISPHERE}),
        (Operation.DOT_PRODUCT_TEXTURE_2D, "f", {}),
    ]
    samplers = {0: replace(EDGE, signed_components=signed), 2: EDGE}
    coordinates = [constant(0.5, 0.5), constant(16.0), constant()]
    table = ramp(64, lambda s, t: s)
    got = shown(frame({"n": pair, "f": table}, stages, coordinates, samplers=samplers))
    np.testing.assert_allclose(got[..., 0], 16.0 * 1000 / 32767, atol=1e-9)


def test_signed_components_reach_the_register_doubled():
    texel = texture_2d(np.array([[[200, 100, 0, 255]]], np.uint8))
    shader = frame({"n": texel}, [(Operation.TEXTURE_2D, "n", {})], [constant()], samplers={0: SIGNED})
    state = replace(shader[-1].state, texture_shader=None)
    for draw in (shader[-1], replace(shader[-1], state=state)):
        got = shown((*shader[:-1], draw))
        np.testing.assert_allclose(got[0, 0], [0.0, 200 / 255, 0.0, 0.0], atol=NOISE)


# ------------------------------------------------------------------------------------ beside the machines

# Units of a byte. What a stage reads of an earlier texel on a machine may be off by a byte's roundings, half
# of one for each axis of the filter, its fraction's (a 256th of texels that differ by at most 15, along two
# axes), and EXPAND_NORMAL's zero, up to 255/254: (n - 128)/127 is 2 x - 1 of x = (n - 1)/254.
TEXEL = 1.0 + 0.2 + 255.0 / 254.0
# The last access by itself: the table's bytes (1/2), three axes of its filter (1/2 each), their fractions.
ACCESS = 0.5 + 1.5 + 0.5


def smooth_image(size=64):
    """A picture whose value changes by at most one where a coordinate does, the same at opposite edges."""
    centres = (np.arange(size) + 0.5) / size
    wave = np.abs(2.0 * centres - 1.0)
    s, t = np.meshgrid(wave, wave)
    return np.stack([s / 2 + t / 4, t / 2, 0.5 + s / 4, (s + t) / 2], axis=-1)


def bytes_of(image):
    return np.floor(np.asarray(image) * 255.0 + 0.5).astype(np.uint8)


CHAINS = {
    # operations; units that read the random texture, the smooth image and the cube map
    "offset": ((Operation.TEXTURE_2D, Operation.OFFSET_TEXTURE_2D), "ri"),
    "scale": ((Operation.TEXTURE_2D, Operation.OFFSET_TEXTURE_2D_SCALE), "ri"),
    "alpha red": ((Operation.TEXTURE_2D, Operation.DEPENDENT_AR_TEXTURE_2D), "ri"),
    "green blue": ((Operation.PASS_THROUGH, Operation.DEPENDENT_GB_TEXTURE_2D), " i"),
    "plane": ((Operation.TEXTURE_2D, DOT, Operation.DOT_PRODUCT_TEXTURE_2D), "r i"),
    "two planes": (
        (Operation.TEXTURE_2D, Operation.TEXTURE_2D, DOT, Operation.DOT_PRODUCT_TEXTURE_2D),
        "rr i",
    ),
    "cube": ((Operation.TEXTURE_2D, DOT, DOT, Operation.DOT_PRODUCT_TEXTURE_CUBE_MAP), "r  c"),
    "reflect": ((Operation.TEXTURE_2D, DOT, DOT, Operation.DOT_PRODUCT_REFLECT_CUBE_MAP), "r  c"),
    "constant eye": (
        (Operation.TEXTURE_2D, DOT, DOT, Operation.DOT_PRODUCT_CONST_EYE_REFLECT_CUBE_MAP),
        "r  c",
    ),
    "volume": ((Operation.TEXTURE_2D, DOT, DOT, Operation.DOT_PRODUCT_TEXTURE_3D), "r  v"),
    "cull": ((Operation.TEXTURE_2D, Operation.CULL_FRAGMENT), "r"),
}


def random_commands(name, seed, moved=(0.0, 0.0, 0.0, 0.0)):
    """A program on one square, from bytes, whose tables are smooth; ``moved``: what is added to the texels
    that it reads first, in bytes.
    """
    random = np.random.default_rng([seed, *name.encode()])
    operations, kinds = CHAINS[name]
    centres = (np.arange(16) + 0.5) / 16
    wave = np.abs(2.0 * centres - 1.0)
    volume = np.stack(np.meshgrid(wave, wave, wave, indexing="ij"), axis=-1)
    flat = directions_cube(16).ideal[0][..., :3]
    first = texture_2d(random.integers(100, 116, (8, 8, 4), np.uint8))
    if any(moved):
        first = replace(first, ideal=(first.levels[0] / 255.0 + np.array(moved) / 255.0,))
    textures = {
        "r": first,
        "i": texture_2d(bytes_of(smooth_image())),
        "c": texture_cube_map(bytes_of(flat)),
        "v": texture_3d(bytes_of(volume)),
    }
    textures = {key: value for key, value in textures.items() if key in kinds}
    stages = []
    for i, operation in enumerate(operations):
        more = {
            "previous_texture_input": 1 if name == "two planes" and i == 3 else 0,
            "offset_texture_matrix": tuple(random.uniform(-1, 1, 4).tolist()),
            "offset_texture_scale": float(random.uniform(0, 1)),
            "offset_texture_bias": float(random.uniform(0, 0.5)),
            "constant_eye": (0.1, 0.2, 1.0),
            "dot_product_mapping": [DotProductMapping.UNSIGNED_IDENTITY, DotProductMapping.EXPAND_NORMAL][
                int(random.integers(2))
            ],
        }
        stages.append((operation, kinds[i].strip() or None if i < len(kinds) else None, more))
    coordinates = []
    for i in range(len(operations)):
        corners = random.uniform(-1.0, 1.0, (4, 4))
        if operations[i] is Operation.TEXTURE_2D:
            corners[:, 3] = 1.0
        elif operations[i] is Operation.CULL_FRAGMENT:
            corners[:, 1:] = 1.0  # s alone decides, and is negative at one corner
            corners[:, 0] = np.roll([-1.0, 1.0, 1.0, 1.0], seed)
        coordinates.append(corners)
    if name == "cube" or "REFLECT" in operations[-1].name:
        # Away from the cube's edges, where a byte's error would choose another face.
        for k in range(3):
            coordinates[1 + k] = np.array(constant(*(0.1 * random.uniform(-1, 1, 3) + 2.0 * (k == 2)), 1.0))
            coordinates[1 + k][:, 3] = (0.1, 0.2, 1.0)[k]
    if operations[0] is Operation.PASS_THROUGH:
        coordinates[0] = np.clip(coordinates[0], 0.05, 0.95) + np.array(moved) / 255.0
    repeating = replace(EDGE, wrap_s=WrapMode.REPEAT, wrap_t=WrapMode.REPEAT, wrap_r=WrapMode.REPEAT)
    shown_unit = 0 if name == "cull" else None
    samplers = dict.fromkeys(range(4), repeating)
    return frame(textures, stages, coordinates, samplers=samplers, register=shown_unit)


def assert_near_the_machines(name, seeds):
    """The first texels moved by what rounds them say how far the last access may lie."""
    corners = [[TEXEL * (1 - 2 * (k >> i & 1)) for i in range(4)] for k in range(16)]
    for seed in seeds:
        commands = random_commands(name, seed)
        guides = {
            profile.name: execute(commands, profile, SIZE, SIZE, threads=1, record=True)
            for profile in (GEFORCE_3, NV2A, FUTURE)
        }
        guide = guides[NV2A.name]
        ideal = execute_ideal(commands, SIZE, SIZE, guide=guide, threads=1).color
        moved = [
            execute_ideal(random_commands(name, seed, by), SIZE, SIZE, guide=guide, threads=1).color
            for by in corners
        ]
        bound = ACCESS / 255.0 + np.abs(np.array(moved) - ideal).max(axis=0)
        for machine, result in guides.items():
            color = result.framebuffer.color / (2.0**result.framebuffer.color_bits - 1.0)
            difference = np.abs(ideal - color)
            assert (difference <= bound).all(), (machine, seed, (difference - bound).max() * 255.0)
            assert difference.max() > 0.0, "bytes are no reals"
            assert np.median(bound) < 0.1, "the bound says nothing"


@pytest.mark.parametrize("name", CHAINS)
def test_random_programs_differ_from_the_machines_by_their_roundings(name):
    assert_near_the_machines(name, range(2))


@pytest.mark.slow
@pytest.mark.parametrize("name", CHAINS)
def test_many_random_programs_differ_from_the_machines_by_their_roundings(name):
    assert_near_the_machines(name, range(2, 40))


def test_the_free_mode_discards_what_the_machine_discards():
    commands = random_commands("cull", 0)
    machine = execute(commands, NV2A, SIZE, SIZE, threads=1)
    ideal = execute_ideal(commands, SIZE, SIZE, threads=1)
    drawn = machine.framebuffer.color.any(axis=2)
    assert 0 < drawn.sum() < drawn.size
    np.testing.assert_array_equal(ideal.color.any(axis=2), drawn)


def test_textures_whose_coordinates_count_texels_are_refused():
    commands = frame(
        {"r": texture_2d(np.zeros((4, 4, 4), np.uint8))},
        [(Operation.OFFSET_TEXTURE_RECTANGLE, "r", {})],
        [SQUARE],
    )
    with pytest.raises(UnsupportedState, match="has no OFFSET_TEXTURE_RECTANGLE"):
        validate(commands, IDEAL, SIZE, SIZE)
