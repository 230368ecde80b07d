"""The usual shadow map, sampled by kernels of its own in the vector engine: the portable engine's bits."""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.pipeline.commands import Clear, Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import (
    ComparisonFunction,
    InternalFormat,
    TextureCompareMode,
    TextureFilter,
    TextureTarget,
    WrapMode,
)
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.profiles import GEFORCE_3
from fixedpipe.pipeline.state import DepthTest, PassState, PolygonState, Sampler, TextureUnit
from fixedpipe.pipeline.textures.images import Texture, depth_texels

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
