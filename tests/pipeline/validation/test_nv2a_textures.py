"""What the NV2A does to textures and the GeForce 256 does not: refusals, in sentences, and what is drawn."""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.pipeline.commands import CopyTexImage, CopyTexSubImage, Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import (
    InternalFormat,
    PrimitiveType,
    TexelWord,
    TextureFilter,
    TextureTarget,
    WrapMode,
)
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.profiles import GEFORCE_256, NV2A
from fixedpipe.pipeline.state import PassState, RegisterCombiners, Sampler, SignedComponents, TextureUnit
from fixedpipe.pipeline.textures.images import texture_2d
from fixedpipe.pipeline.textures.words import texture_of_words
from fixedpipe.pipeline.validation.validate import validate
from fixedpipe.pipeline.validation.walk import UnsupportedState
from tests.support.run_reference import run_reference
from tests.support.strategies import SHOW_TEXTURE

NEAREST = Sampler(
    TextureFilter.NEAREST, TextureFilter.NEAREST, WrapMode.CLAMP_TO_EDGE, WrapMode.CLAMP_TO_EDGE
)
RANDOM = np.random.default_rng(7)


def volume(layers=4, height=2, width=2):
    words = RANDOM.integers(0, 2**32, (layers, height, width))
    return texture_of_words(words, TexelWord.A8R8G8B8, TextureTarget.TEXTURE_3D)


def flat(height=2, width=2, levels=1):
    sizes = [(max(1, height >> k), max(1, width >> k)) for k in range(levels)]
    return texture_of_words([RANDOM.integers(0, 2**32, size) for size in sizes], TexelWord.A8R8G8B8)


def rectangle(height=3, width=5):
    return replace(flat(height, width), target=TextureTarget.TEXTURE_RECTANGLE)


def shown(image, sampler=NEAREST, components=2, **state):
    mesh = Mesh(
        np.array([(-1.0, -1.0), (3.0, -1.0), (-1.0, 3.0)]),
        texture_coordinates=(np.zeros((3, components)),),
    )
    unit = TextureUnit("texture", sampler, **state.pop("unit", {}))
    passed = PassState(texture_units=(unit,), register_combiners=RegisterCombiners(), **state)
    return (
        TexImage(label="store", texture="texture", image=image),
        Draw(label="show", mesh=mesh, state=passed),
    )


def copied(**fields):
    return (CopyTexImage(label="copy", texture="texture", width=2, height=2, **fields),)


# Refused by the profile, words of its sentence, and a neighbour that the same profile accepts.
REFUSED = {
    "a volume": (GEFORCE_256, shown(volume(), components=3), "no TEXTURE_3D", shown(flat())),
    "a rectangle": (GEFORCE_256, shown(rectangle()), "no TEXTURE_RECTANGLE", shown(flat())),
    "a palette": (
        GEFORCE_256,
        shown(replace(flat(), internal_format=InternalFormat.COLOR_INDEX8)),
        "does not store COLOR_INDEX8",
        shown(flat()),
    ),
    "signed texels": (
        GEFORCE_256,
        shown(flat(), replace(NEAREST, signed_components=SignedComponents(alpha=True))),
        "no signed texels",
        shown(flat()),
    ),
    "cylinder wrapping": (
        GEFORCE_256,
        shown(flat(), unit={"cylinder_wrap": (True, False, False, False)}),
        "does not wrap texture coordinates",
        shown(flat()),
    ),
    "screen-linear colours": (
        GEFORCE_256,
        shown(flat(), perspective_correction=False),
        "always corrects for perspective",
        shown(flat()),
    ),
    "a volume that is too large": (
        NV2A.changed(max_3d_texture_size=4),
        shown(volume(8), components=3),
        "2x2x8.* up to 4 texels an edge",
        shown(volume(4), components=3),
    ),
    "three layers": (
        NV2A,
        shown(volume(3), components=3),
        "3 layers.*Give 4",
        shown(volume(4), components=3),
    ),
    "a repeating rectangle": (
        NV2A,
        shown(rectangle(), replace(NEAREST, wrap_t=WrapMode.REPEAT)),
        "wrap_t REPEAT of a TEXTURE_RECTANGLE",
        shown(rectangle()),
    ),
    "a mipmapped rectangle": (
        NV2A,
        shown(rectangle(), replace(NEAREST, min_filter=TextureFilter.LINEAR_MIPMAP_LINEAR)),
        "rectangles have no mipmaps",
        shown(rectangle(), replace(NEAREST, min_filter=TextureFilter.LINEAR)),
    ),
    "a rectangle with levels": (
        NV2A,
        shown(replace(flat(2, 2, 2), target=TextureTarget.TEXTURE_RECTANGLE)),
        "has 2 levels; it has level 0 alone",
        shown(rectangle()),
    ),
    "levels that are not there": (
        GEFORCE_256,
        shown(flat(8, 8, 2), replace(NEAREST, min_filter=TextureFilter.NEAREST_MIPMAP_LINEAR, max_level=2)),
        "max_level to 1",
        shown(flat(8, 8, 2), replace(NEAREST, min_filter=TextureFilter.NEAREST_MIPMAP_LINEAR, max_level=1)),
    ),
    "a negative last level": (
        GEFORCE_256,
        shown(flat(), replace(NEAREST, max_level=-1)),
        "levels count from 0",
        shown(flat(), replace(NEAREST, max_level=0)),
    ),
    "a base level that is not there": (
        GEFORCE_256,
        shown(flat(8, 8, 2), replace(NEAREST, base_level=2)),
        "has the base level 2, but 'texture' has 2 levels; give a base_level from 0 to 1",
        shown(flat(8, 8, 2), replace(NEAREST, base_level=1)),
    ),
    "a base level above the last": (
        GEFORCE_256,
        shown(flat(8, 8, 2), replace(NEAREST, base_level=1, max_level=0)),
        "the base level 1 above the maximum level 0",
        shown(flat(8, 8, 2), replace(NEAREST, base_level=1, max_level=1)),
    ),
    "a base level of a rectangle": (
        NV2A,
        shown(rectangle(), replace(NEAREST, base_level=1)),
        "give a base_level from 0 to 0",
        shown(rectangle()),
    ),
    "levels that are not there from the base level on": (
        GEFORCE_256,
        shown(
            flat(8, 8, 3),
            replace(NEAREST, min_filter=TextureFilter.NEAREST_MIPMAP_LINEAR, base_level=2, max_level=3),
        ),
        "has 3 levels of 4",
        shown(
            flat(8, 8, 3),
            replace(NEAREST, min_filter=TextureFilter.NEAREST_MIPMAP_LINEAR, base_level=2, max_level=2),
        ),
    ),
    "a limit of lambda out of range": (
        GEFORCE_256,
        shown(flat(), replace(NEAREST, max_lod=1001.0)),
        "limits the level of detail to -1000.0 .. 1001.0",
        shown(flat(), replace(NEAREST, max_lod=999.0)),
    ),
    "a copy of what no framebuffer holds": (
        NV2A,
        copied(internal_format=InternalFormat.COMPRESSED_RGBA_S3TC_DXT1),
        "is not made from pixels; define it with TexImage",
        copied(internal_format=InternalFormat.RGBA8),
    ),
    "a layer that is not there": (
        NV2A,
        (shown(volume(2))[0], CopyTexSubImage(label="copy", texture="texture", width=1, height=1, face=2)),
        "faces 0 to 1",
        (shown(volume(2))[0], CopyTexSubImage(label="copy", texture="texture", width=1, height=1, face=1)),
    ),
}


@pytest.mark.parametrize(("profile", "refused", "sentence", "accepted"), REFUSED.values(), ids=REFUSED)
def test_it_is_refused_in_a_sentence_and_its_neighbour_is_accepted(profile, refused, sentence, accepted):
    with pytest.raises(UnsupportedState, match=sentence):
        validate(refused, profile, 4, 4)
    validate(accepted, profile, 4, 4)


# ------------------------------------------------------------------------- kernels and the specification


def random_frame(seed, width, height):
    """A triangle strip with any texture that the NV2A has and the GeForce 256 has not, under any sampler."""
    random = np.random.default_rng(seed)
    target = (TextureTarget.TEXTURE_3D, TextureTarget.TEXTURE_RECTANGLE, TextureTarget.TEXTURE_2D)[seed % 3]
    edges = 1 << random.integers(0, 4, 3)
    levels = int(edges.max()).bit_length()
    if target is TextureTarget.TEXTURE_RECTANGLE:
        edges, levels = random.integers(1, 9, 3), 1
    if target is not TextureTarget.TEXTURE_3D:
        edges[0] = 1
    sizes = [np.maximum(1, edges >> k) for k in range(levels)]
    words = [random.integers(0, 2**32, size) for size in sizes]
    if target is TextureTarget.TEXTURE_2D:
        levels = int(edges.max()).bit_length()
        words = words[:levels]
    image = texture_of_words(words, TexelWord.A8R8G8B8, target)
    rectangular = target is TextureTarget.TEXTURE_RECTANGLE
    filters = list(TextureFilter)[:2] if rectangular else list(TextureFilter)
    modes = (
        [WrapMode.CLAMP, WrapMode.CLAMP_TO_EDGE, WrapMode.CLAMP_TO_BORDER] if rectangular else list(WrapMode)
    )
    wraps = [modes[random.integers(len(modes))] for _ in range(2)]
    low, high = np.sort(random.uniform(-1.0, 4.0, 2)).tolist()
    sampler = Sampler(
        filters[random.integers(len(filters))],
        filters[random.integers(2)],
        *wraps,
        wrap_r=list(WrapMode)[random.integers(len(WrapMode))],
        border_color=tuple(random.random(4).tolist()),
        min_lod=low if seed % 2 else -1000.0,
        max_lod=high if seed % 2 else 1000.0,
        max_level=int(random.integers(0, levels)) if seed % 5 == 0 else 1000,
        signed_components=SignedComponents(*(bool(b) for b in random.integers(0, 2, 4))),
    )
    coordinates = random.uniform(-1.5, 2.5, (6, 4)) * (10.0 if rectangular else 1.0)
    if seed % 4:
        coordinates[:, 3] = 1.0
    if seed % 7 == 0:
        coordinates = np.round(coordinates * 4.0) / 4.0
    w = np.exp(random.uniform(-1.0, 1.0, (6, 1)))
    positions = np.concatenate([random.uniform(-1.2, 1.2, (6, 2)) * w, np.zeros((6, 1)), w], -1)
    mesh = Mesh(positions, PrimitiveType.TRIANGLE_STRIP, texture_coordinates=(coordinates,))
    unit = TextureUnit(
        "texture",
        sampler,
        lod_bias=float(random.uniform(-2.0, 2.0)),
        cylinder_wrap=tuple(bool(b) for b in random.integers(0, 2, 4)),
    )
    state = PassState(
        texture_units=(unit,),
        register_combiners=SHOW_TEXTURE,
        perspective_correction=bool(random.integers(2)),
    )
    return (
        TexImage(label="store", texture="texture", image=image),
        Draw(label="show", mesh=mesh, state=state),
    )


@pytest.mark.parametrize("seed", range(60))
def test_kernels_equal_the_specification(seed):
    commands = random_frame(seed, 12, 10)
    machine = execute(commands, NV2A, 12, 10).framebuffer
    assert machine.color.tolist() == run_reference(commands, NV2A, 12, 10, 24).target.color


def test_a_signed_texel_is_twice_its_number_in_a_register():
    for byte, register in ((0x7F, 254), (0x40, 128), (0x01, 2), (0x00, 0), (0xFF, 0), (0x80, 0)):
        image = texture_2d(np.full((1, 1, 4), byte, np.uint8))
        sampler = replace(NEAREST, signed_components=SignedComponents(red=True, alpha=True))
        store, draw = shown(image, sampler)
        draw = replace(draw, state=replace(draw.state, register_combiners=SHOW_TEXTURE))
        color = execute((store, draw), NV2A, 1, 1).framebuffer.color[0, 0]
        assert color.tolist() == [register, byte, byte, register]


def test_cylinder_wrapping_takes_the_short_way_round_where_the_texture_repeats():
    row = np.zeros((1, 8, 4), np.uint8)
    row[0, :, 0] = np.arange(8)
    positions = np.array([(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)])
    coordinates = np.array([(0.9375, 0.0), (0.0625, 0.0)] * 2)
    mesh = Mesh(positions, PrimitiveType.TRIANGLE_STRIP, texture_coordinates=(coordinates,))
    drawn = {}
    for mode in (WrapMode.REPEAT, WrapMode.MIRRORED_REPEAT):
        unit = TextureUnit("row", replace(NEAREST, wrap_s=mode), cylinder_wrap=(True, False, False, False))
        state = PassState(texture_units=(unit,), register_combiners=SHOW_TEXTURE)
        commands = (
            TexImage(label="row", texture="row", image=texture_2d(row)),
            Draw(label="seam", mesh=mesh, state=state),
        )
        drawn[mode] = execute(commands, NV2A, 4, 2).framebuffer.color[0, :, 0].tolist()
    assert drawn == {WrapMode.REPEAT: [7, 7, 0, 0], WrapMode.MIRRORED_REPEAT: [6, 4, 3, 1]}
