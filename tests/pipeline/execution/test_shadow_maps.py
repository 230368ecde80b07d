"""Shadow maps: the usual one, for which the vector engine has kernels of its own, and those with a border."""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.pipeline.commands import Clear, Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import (
    ComparisonFunction,
    InternalFormat,
    PrimitiveType,
    TextureCompareMode,
    TextureFilter,
    TextureTarget,
    WrapMode,
)
from fixedpipe.pipeline.execution.machine import Machine, execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import GEFORCE_3, NV2A, PROFILES
from fixedpipe.pipeline.state import DepthTest, PassState, PolygonState, Sampler, TextureUnit
from fixedpipe.pipeline.textures.images import DEPTH_TEXELS, Texture, depth_texels
from tests import fuzz
from tests.reference.fixed import converted
from tests.support.random_frames import Frame
from tests.support.strategies import SHOW_TEXTURE

SIZE = 96
SHADOW = Sampler(
    TextureFilter.LINEAR,
    TextureFilter.LINEAR,
    wrap_s=WrapMode.CLAMP_TO_EDGE,
    wrap_t=WrapMode.CLAMP_TO_EDGE,
    compare_mode=TextureCompareMode.COMPARE_R_TO_TEXTURE,
)


def depth_texture(random):
    """A depth texture of few depths, so that many references equal a texel."""
    words = random.integers(0, 5, (16, 32)) * ((2**24 - 1) // 4)
    return Texture(
        TextureTarget.TEXTURE_2D,
        InternalFormat.DEPTH_COMPONENT24,
        (depth_texels(words.astype(np.uint32))[None],),
    )


def triangles(random, count, spread, scale):
    """A mesh of random triangles in perspective, each ``spread`` wide; s, t, r and q are times ``scale``."""
    middle = np.repeat(random.uniform(-0.9, 0.9, (count, 3)), 3, axis=0)
    places = middle + random.uniform(-spread, spread, (3 * count, 3))
    w = np.exp2(random.uniform(-2, 2, (3 * count, 1)))
    positions = np.concatenate([np.clip(places, -1, 1) * w, w], axis=1)
    depths = np.repeat(random.choice([0, 0.25, 0.5, 1], (count, 1)), 3, axis=0)
    strq = np.concatenate([random.uniform(-0.2, 1.2, (3 * count, 2)), depths], axis=1)
    q = random.uniform(0.5, 2, (3 * count, 1))
    q[: 3 * count // 2] = 1.0  # these triangles' depths are texels'
    coordinates = np.concatenate([strq * q, q], axis=1) * scale
    return Mesh(positions, texture_coordinates=(coordinates.astype(np.float32),))


@pytest.mark.parametrize("function", list(ComparisonFunction), ids=lambda function: function.name)
@pytest.mark.parametrize(("count", "spread"), [(3, 2.0), (400, 0.05)], ids=["large", "small"])
def test_both_engines_agree(function, count, spread):
    random = np.random.default_rng(count + list(ComparisonFunction).index(function))
    sampler = replace(SHADOW, compare_function=function)
    offset = PolygonState(offset_factor=2.0, offset_units=5.0, offset_fill=True)
    for scale in (1.0, 2.0**70):  # a q beyond 2**60 is not for float32
        draw = Draw(
            label="draw",
            mesh=triangles(random, count, spread, scale),
            state=PassState(
                texture_units=(TextureUnit("map", sampler),), depth_test=DepthTest(), polygon=offset
            ),
        )
        frame = (
            TexImage(label="map", texture="map", image=depth_texture(random)),
            Clear(label="clear"),
            draw,
        )
        drawn = [execute(frame, GEFORCE_3, SIZE, SIZE, engine=engine) for engine in (None, "portable")]
        one, other = (result.framebuffer for result in drawn)
        assert np.array_equal(one.color, other.color) and np.array_equal(one.depth, other.depth)
        always = function in (ComparisonFunction.NEVER, ComparisonFunction.ALWAYS)
        assert always or len(np.unique(one.color)) > 1


def beside(profile, sampler, r):
    """A frame of one row: a map of largest depths from s = 0 to 1, seen from s = -1 to 2 by the depth r."""
    internal_format = InternalFormat.DEPTH_COMPONENT24
    largest = DEPTH_TEXELS[internal_format].largest
    image = Texture(
        TextureTarget.TEXTURE_2D, internal_format, (depth_texels(np.full((1, 4, 4), largest, np.uint32)),)
    )
    units = largest if profile.textures.depth_units_in_coordinates else 1.0
    strq = [(s, t, r * units, 1.0) for t in (0.0, 1.0) for s in (-1.0, 2.0)]
    corners = np.array([(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)])
    mesh = Mesh(corners, PrimitiveType.TRIANGLE_STRIP, texture_coordinates=(np.array(strq),))
    state = PassState(texture_units=(TextureUnit("map", sampler),))  # white times the texel
    return TexImage(label="map", texture="map", image=image), Draw(label="draw", mesh=mesh, state=state)


COMPARED_BESIDE = [
    # (the function, r, what it gives in the border and in the map). The border's depth, 0.5, is the word
    # 8388608; a reference of 0.5 is cut to 8388607.
    (ComparisonFunction.LEQUAL, 0.25, 255, 255),
    (ComparisonFunction.LEQUAL, 0.75, 0, 255),
    (ComparisonFunction.GEQUAL, 0.75, 255, 0),
    (ComparisonFunction.GEQUAL, 0.5, 0, 0),
    (ComparisonFunction.LESS, 0.5, 255, 255),
    (ComparisonFunction.EQUAL, 0.5, 0, 0),
]


@pytest.mark.parametrize("engine", [None, "portable", "columns"])
@pytest.mark.parametrize(
    ("name", "function", "r", "outside", "inside"),
    [
        (name, *compared)
        for name, profile in PROFILES.items()
        for compared in COMPARED_BESIDE
        if TextureCompareMode.COMPARE_R_TO_TEXTURE in profile.textures.texture_compare_modes
        and compared[0] in profile.textures.shadow_functions
        and not profile.arithmetic.exact
    ],
)
def test_the_border_colour_s_red_is_a_depth_that_is_compared(name, function, r, outside, inside, engine):
    """Source: ARB_depth_texture, issue 2."""
    profile = PROFILES[name]
    sampler = replace(SHADOW, compare_function=function, border_color=(0.5, 1.0, 0.0, 1.0))
    # 12 pixels over three widths of a map of 4 texels: middles of texels.
    clamped = (outside + inside + 1) // 2  # on the edge, half way between two texels
    for wrap, left in ((WrapMode.CLAMP_TO_BORDER, outside), (WrapMode.CLAMP, clamped)):
        wrapped = replace(sampler, wrap_s=wrap)
        frame = beside(profile, wrapped, r)
        drawn = Machine(profile, 12, 1, engine=engine).run(frame).framebuffer.color[0, :, 0]
        most = 2 ** profile.framebuffers.color_bits[0] - 1
        # In widths beyond a byte, the mean of two texels is rounded as a byte, and then widened.
        expected = [converted(byte, 255, most) for byte in [left] * 4 + [inside] * 4 + [left] * 4]
        assert drawn.tolist() == expected


def test_the_ideal_compares_the_border_too():
    sampler = replace(SHADOW, wrap_s=WrapMode.CLAMP_TO_BORDER, border_color=(0.5, 0.0, 0.0, 0.0))
    for r, outside in ((0.25, 1.0), (0.75, 0.0)):
        drawn = execute_ideal(beside(GEFORCE_3, sampler, r), 12, 1).color[0, :, 0]
        assert drawn.tolist() == [outside] * 4 + [1.0] * 4 + [outside] * 4


@pytest.mark.parametrize("seed", range(36))
def test_every_engine_equals_the_specification_beside_a_map(seed):
    random = np.random.default_rng(seed)
    profile = (GEFORCE_3, NV2A)[seed % 2]
    formats = sorted(profile.textures.internal_formats & set(DEPTH_TEXELS))
    internal_format = formats[random.integers(len(formats))]
    largest, filters = DEPTH_TEXELS[internal_format].largest, list(TextureFilter)
    levels = tuple(
        depth_texels(random.integers(0, largest + 1, (1, edge, edge)).astype(np.uint32))
        for edge in (8, 4, 2, 1)
    )
    functions = sorted(profile.textures.shadow_functions)
    sampler = Sampler(
        filters[random.integers(len(filters))],
        filters[random.integers(2)],
        *[(WrapMode.CLAMP, WrapMode.CLAMP_TO_BORDER)[random.integers(2)] for _ in range(2)],
        border_color=tuple(random.uniform(0.0, 1.0, 4).tolist()),
        compare_mode=TextureCompareMode.COMPARE_R_TO_TEXTURE,
        compare_function=functions[random.integers(len(functions))],
    )
    mesh = triangles(random, 2, 1.0, 1.0)
    coordinates = np.array(mesh.texture_coordinates[0], np.float64)
    coordinates[:, :2] = coordinates[:, :2] * 3.0 - coordinates[:, 3:]
    if profile.textures.depth_units_in_coordinates:
        coordinates[:, 2] *= largest
    state = PassState(texture_units=(TextureUnit("map", sampler),), register_combiners=SHOW_TEXTURE)
    draw = Draw(label="draw", mesh=replace(mesh, texture_coordinates=(coordinates,)), state=state)
    image = Texture(TextureTarget.TEXTURE_2D, internal_format, levels)
    commands = TexImage(label="map", texture="map", image=image), draw
    frame = Frame(seed, profile, 12, 10, 24, commands, small=True)
    fuzz.compare(frame, (fuzz.Way(), fuzz.Way("columns"), fuzz.Way(record=True), fuzz.Way(reference=True)))
