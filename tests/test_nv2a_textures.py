"""What the NV2A does to textures and the GeForce 256 does not: refusals, in sentences, and what is drawn."""

from dataclasses import replace

import numpy as np
import pytest

from pipeline.commands import CopyTexImage, CopyTexSubImage, Draw, Mesh, TexImage
from pipeline.enums import InternalFormat, TexelWord, TextureFilter, TextureTarget, WrapMode
from pipeline.profiles import GEFORCE_256, NV2A
from pipeline.state import PassState, RegisterCombiners, Sampler, SignedComponents, TextureUnit
from pipeline.texel_words import texture_of_words
from pipeline.validate import UnsupportedState, validate

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
        replace(NV2A, max_3d_texture_size=4),
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
    "a volume without coordinates": (
        NV2A,
        shown(volume(), unit={"coordinates": 1}),
        "generate s, t, r",
        shown(volume()),
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
    "a limit of lambda out of range": (
        GEFORCE_256,
        shown(flat(), replace(NEAREST, max_lod=1001.0)),
        "limits the level of detail to -1000.0 .. 1001.0",
        shown(flat(), replace(NEAREST, max_lod=999.0)),
    ),
    "a copy of what no framebuffer holds": (
        NV2A,
        copied(internal_format=InternalFormat.COMPRESSED_RGBA_S3TC_DXT1),
        "cannot be copied from a framebuffer",
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
