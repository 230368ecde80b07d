"""Base levels: engines and the specification, and the rule itself by levels that tell their number."""

from dataclasses import replace
from math import ceil, floor

import numpy as np
import pytest

from fixedpipe.pipeline.commands import Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import (
    InternalFormat,
    MagnificationThreshold,
    PrimitiveType,
    TextureFilter,
    TextureTarget,
    WrapMode,
)
from fixedpipe.pipeline.execution.machine import Machine, execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import GEFORCE_256, NV2A
from fixedpipe.pipeline.state import PassState, Sampler, TextureUnit
from fixedpipe.pipeline.textures.images import Texture, texture_2d
from tests import fuzz
from tests.support.random_frames import Frame
from tests.support.strategies import SHOW_TEXTURE

SIZE, LEVELS = 16, 5
MIPMAPPED = [f for f in TextureFilter if f not in (TextureFilter.NEAREST, TextureFilter.LINEAR)]
BETWEEN = (TextureFilter.NEAREST_MIPMAP_LINEAR, TextureFilter.LINEAR_MIPMAP_LINEAR)


def levels_of(target=TextureTarget.TEXTURE_2D, faces=1):
    """A texture of 16x16 texels whose level k is 50 k everywhere."""
    layered = target is TextureTarget.TEXTURE_3D
    shapes = [(max(1, faces >> k) if layered else faces, SIZE >> k, SIZE >> k, 4) for k in range(LEVELS)]
    return Texture(
        target, InternalFormat.RGBA8, tuple(np.full(s, 50 * k, np.uint8) for k, s in enumerate(shapes))
    )


def shown(image, sampler, texels, bias=0.0):
    """A frame that steps by ``texels`` of level 0 from pixel to pixel."""
    edge = 8
    corners = np.array([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)])
    mesh = Mesh(
        2.0 * corners - 1.0,
        PrimitiveType.TRIANGLE_STRIP,
        texture_coordinates=(corners * (edge * texels / SIZE),),
    )
    unit = TextureUnit("levels", sampler, lod_bias=bias)
    state = PassState(texture_units=(unit,), register_combiners=SHOW_TEXTURE)
    return (
        TexImage(label="levels", texture="levels", image=image),
        Draw(label="levels", mesh=mesh, state=state),
    )


def chosen(sampler, lod):
    """What equations 3.21 to 3.23 choose for lambda, of levels that are 50 k."""
    b, q = sampler.base_level, min(LEVELS - 1, sampler.max_level)
    late = sampler.mag_filter is TextureFilter.LINEAR and sampler.min_filter in (
        TextureFilter.NEAREST_MIPMAP_NEAREST,
        TextureFilter.NEAREST_MIPMAP_LINEAR,
    )
    if lod <= (0.5 if late else 0.0) or sampler.min_filter not in MIPMAPPED:
        return 50.0 * b
    if sampler.min_filter not in BETWEEN:
        d = b if lod <= 0.5 else q if b + lod > q + 0.5 else b + ceil(lod + 0.5) - 1
        return 50.0 * d
    if b + lod >= q:
        return 50.0 * q
    lower = b + floor(lod)
    return 50.0 * (lower + (lod - floor(lod)))


@pytest.mark.parametrize("base", range(LEVELS))
@pytest.mark.parametrize("min_filter", TextureFilter)
@pytest.mark.parametrize("mag_filter", [TextureFilter.NEAREST, TextureFilter.LINEAR])
def test_the_equations_choose_levels_from_the_base_level_on(base, min_filter, mag_filter):
    machine = GEFORCE_256.changed(magnification_threshold=MagnificationThreshold.OPENGL_C)
    for texels in (0.5, 1.0, 2.0, 4.0, 16.0):
        for last in (base, base + 1, 1000):
            sampler = Sampler(min_filter, mag_filter, base_level=base, max_level=last)
            # Texels of level b are 2^b times as large; the logarithm is whole, and the bias a quarter.
            for bias in (0.0, 0.25, 0.75):
                lod = np.log2(texels) - base + bias
                commands = shown(levels_of(), sampler, texels, bias)
                drawn = execute(commands, machine, 8, 8).framebuffer.color
                # A blend of levels rounds by half a step, and lambda has 8 bits.
                assert abs(drawn.astype(int) - chosen(sampler, lod)).max() <= 1, (texels, last, bias)


def test_the_scale_factor_is_of_the_base_levels_texels():
    """Two texels of level 0 in a pixel are one of level 1: lambda is 0, and level 1 magnified."""
    sampler = Sampler(TextureFilter.NEAREST_MIPMAP_NEAREST, TextureFilter.NEAREST, base_level=1)
    for texels, level in ((2.0, 1), (8.0, 3)):
        drawn = execute(shown(levels_of(), sampler, texels), NV2A, 8, 8).framebuffer.color
        assert (drawn == 50 * level).all()


def random_texture(rng, target, faces):
    layered = target is TextureTarget.TEXTURE_3D
    levels, shape = [], [faces, 8, 8]
    for _ in range(4):
        levels.append(rng.integers(0, 256, (*shape, 4), np.uint8))
        shape = [max(1, n >> 1) if layered or k else n for k, n in enumerate(shape)]
    return Texture(target, InternalFormat.RGBA8, tuple(levels))


KINDS = ((TextureTarget.TEXTURE_2D, 1), (TextureTarget.TEXTURE_CUBE_MAP, 6), (TextureTarget.TEXTURE_3D, 4))


@pytest.mark.parametrize("seed", range(24))
def test_engines_equal_the_specification(seed):
    rng = np.random.default_rng(seed)
    target, faces = KINDS[seed % 3]
    base = int(rng.integers(0, 4))
    sampler = Sampler(
        list(TextureFilter)[rng.integers(len(TextureFilter))],
        list(TextureFilter)[rng.integers(2)],
        *[list(WrapMode)[rng.integers(len(WrapMode))] for _ in range(2)],
        border_color=tuple(rng.random(4).tolist()),
        min_lod=float(rng.uniform(-1.0, 1.0)),
        max_lod=float(rng.uniform(1.0, 3.0)),
        max_level=int(rng.integers(base, 5)),
        base_level=base,
        max_anisotropy=2.0 if target is TextureTarget.TEXTURE_2D and seed % 2 else 1.0,
    )
    coordinates = rng.uniform(-1.5, 2.5, (6, 4))
    coordinates[:, 3] = 1.0 if seed % 4 else coordinates[:, 3]
    w = np.exp(rng.uniform(-1.0, 1.0, (6, 1)))
    positions = np.concatenate([rng.uniform(-1.2, 1.2, (6, 2)) * w, np.zeros((6, 1)), w], -1)
    mesh = Mesh(positions, PrimitiveType.TRIANGLE_STRIP, texture_coordinates=(coordinates, coordinates))
    # The second unit reads the same texture from level 0 on.
    units = TextureUnit("levels", sampler), TextureUnit("levels", replace(sampler, base_level=0))
    state = PassState(texture_units=units)
    commands = (
        TexImage(label="levels", texture="levels", image=random_texture(rng, target, faces)),
        Draw(label="levels", mesh=mesh, state=state),
    )
    frame = Frame(seed, NV2A, 12, 10, 24, commands, small=True)
    ways = fuzz.Way(), fuzz.Way("portable"), fuzz.Way("columns"), fuzz.Way(reference=True)
    fuzz.compare(frame, ways)


@pytest.mark.parametrize("min_filter", TextureFilter)
def test_the_ideal_reads_from_the_base_level_on(min_filter):
    """Real levels, from level 1 on, are those of a texture that begins there."""
    rng = np.random.default_rng(5)
    image = texture_2d(rng.random((16, 16, 4)), mipmaps=True)
    begun = Texture(image.target, image.internal_format, image.levels[1:], image.ideal[1:])
    for texels in (0.5, 1.0, 2.5, 7.0):
        sampler = Sampler(min_filter, TextureFilter.LINEAR, base_level=1)
        of_level_0 = replace(sampler, base_level=0)
        frames = (
            shown(image, sampler, texels),
            shown(begun, of_level_0, texels),
            shown(image, of_level_0, texels),
        )
        own, expected, other = (execute_ideal(frame, 8, 8).color for frame in frames)
        assert np.array_equal(own, expected)
        if texels < 1.0:  # level 0 is magnified
            assert not np.array_equal(own, other)


def test_completeness_is_asked_from_the_base_level_to_the_last():
    """Three levels of five are complete from level 2 to level 2."""
    whole = levels_of()
    short = replace(whole, levels=whole.levels[:3])
    sampler = Sampler(TextureFilter.LINEAR_MIPMAP_LINEAR, base_level=2, max_level=2)
    drawn = execute(shown(short, sampler, 1.0), GEFORCE_256, 8, 8).framebuffer.color
    assert (drawn == 100).all()


def test_what_is_kept_follows_the_base_level():
    """A Draw that is kept is not taken for one of the same texture at another base level."""
    machine = Machine(GEFORCE_256, 8, 8)
    for base in (0, 2, 1, 2, 0):
        sampler = Sampler(TextureFilter.NEAREST, TextureFilter.NEAREST, base_level=base)
        drawn = machine.run(shown(levels_of(), sampler, 1.0)).framebuffer.color
        assert (drawn == 50 * base).all()
