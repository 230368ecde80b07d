"""Every door that takes pixels: uint8 are bytes, floats are what they say, and nothing else is guessed at."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from fixedpipe.effects.bump_mapping import emboss, normal_maps
from fixedpipe.effects.environment_maps import bumped_reflections
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.views import Panel
from fixedpipe.effects.passes import draws, encoding, software_pixel_texture
from fixedpipe.effects.reflectance import material_textures
from fixedpipe.effects.user_pictures.volume import volume_of
from fixedpipe.effects.volumes.slices import Volume
from fixedpipe.pipeline import (
    GEFORCE_256,
    OPENGL_1_2_IMAGING,
    DrawPixels,
    PixelImage,
    TexImage,
    texture_2d,
    validate,
)
from fixedpipe.pipeline.commands import Bitmap
from fixedpipe.pipeline.enums import InternalFormat, TexelWord, TextureTarget
from fixedpipe.pipeline.framebuffers.pictures import png
from fixedpipe.pipeline.golden.digests import digest
from fixedpipe.pipeline.pixel_transfer import PixelMaps
from fixedpipe.pipeline.state import ColorTable
from fixedpipe.pipeline.textures import images, words

INTEGERS = tuple(np.dtype(c) for c in np.typecodes["AllInteger"])
FLOATS = tuple(np.dtype(c) for c in np.typecodes["Float"])
OTHERS = tuple(np.dtype(c) for c in ("D", "O", "U1"))
BYTES = {np.dtype(np.uint8)}
UNSIGNED = {np.dtype(t) for t in (np.uint8, np.uint16, np.uint32)}
# OpenGL's types of images: BYTE to UNSIGNED_INT.
IMAGE_TYPES = UNSIGNED | {np.dtype(t) for t in (np.int8, np.int16, np.int32)}
WORDS = {*INTEGERS}
FRAME = height_fields.frames(np.zeros((4, 4)), np.zeros((4, 4)))
PALETTE = np.zeros(256, np.uint32)


def checked(command, profile=OPENGL_1_2_IMAGING):
    validate((command,), profile, 8, 8)


@dataclass(frozen=True)
class Door:
    """``take(array)``; ``shape`` of the array; ``integers``: the types of integers that it takes, ``floats``:
    whether it takes these.
    """

    take: Any
    shape: tuple[int, ...]
    integers: Any = frozenset(BYTES)
    floats: bool = True


def material(**changes):
    normal, tangent, binormal = FRAME
    return material_textures.Material(
        **{"normals": normal, "tangents": tangent, "binormals": binormal}
        | {"alpha_x": 1.0, "alpha_y": 1.0, "k_s": 1.0, **changes}
    )


def panel_picture(a):
    return draws.show(a, Panel(0, 0, 4, 4), "picture", surfaces.plane())


DOORS = {
    "texture_1d": Door(images.texture_1d, (4, 3)),
    "texture_2d": Door(images.texture_2d, (4, 4, 3)),
    "texture_3d": Door(images.texture_3d, (2, 4, 4, 3)),
    "texture_cube_map": Door(images.texture_cube_map, (6, 4, 4, 3)),
    "a software renderer's picture": Door(panel_picture, (4, 4, 3)),
    "DrawPixels": Door(lambda a: checked(DrawPixels(label="d", image=PixelImage(a))), (4, 4, 4), IMAGE_TYPES),
    "TexImage": Door(
        lambda a: checked(
            TexImage(
                label="t",
                texture="t",
                pixels=PixelImage(a),
                target=TextureTarget.TEXTURE_2D,
                internal_format=InternalFormat.RGBA8,
            )
        ),
        (4, 4, 4),
        IMAGE_TYPES,
    ),
    "stencil indices": Door(
        lambda a: checked(DrawPixels(label="d", image=PixelImage(a, "STENCIL_INDEX"))),
        (4, 4),
        IMAGE_TYPES,
        floats=False,
    ),
    "Bitmap": Door(lambda a: checked(Bitmap(label="b", bits=a)), (4, 4), frozenset(), floats=False),
    "words": Door(lambda a: words.texture_of_words(a, TexelWord.A8R8G8B8), (4, 4), WORDS, floats=False),
    "palette": Door(lambda a: words.paletted_texture(np.zeros((2, 2), int), a), (4,), WORDS, floats=False),
    "indices into a palette": Door(lambda a: words.paletted_texture(a, PALETTE), (4, 4), WORDS, floats=False),
    "compressed data": Door(
        lambda a: words.compressed_texture(a, InternalFormat.COMPRESSED_RGBA_S3TC_DXT1, 4, 4),
        (8,),
        floats=False,
    ),
    "digest": Door(digest, (4, 4, 4), frozenset(map(np.dtype, (np.uint8, np.uint16))), floats=False),
    "png": Door(png, (4, 4, 4), integers=(np.uint8, np.uint16), floats=False),
    "densities": Door(lambda a: Volume("v", a, (1.0, 1.0, 1.0)), (4, 4, 4), floats=False),
    "vector_texels": Door(lambda a: encoding.vector_texels(a, GEFORCE_256), (4, 4, 3), frozenset()),
    "factor_texels": Door(lambda a: encoding.factor_texels(a, GEFORCE_256), (4, 4), frozenset()),
    "vector_colors": Door(lambda a: encoding.vector_colors(a, GEFORCE_256), (4, 3), frozenset()),
    "vector_and_factor_texels": Door(
        lambda a: encoding.vector_and_factor_texels(a, 1.0, GEFORCE_256), (4, 4, 3), frozenset()
    ),
    "a factor in alpha": Door(
        lambda a: encoding.vector_and_factor_texels(np.zeros((4, 4, 3)), a, GEFORCE_256), (4, 4), frozenset()
    ),
    "dot_product_texels": Door(
        lambda a: encoding.dot_product_texels(a, 1.0, GEFORCE_256), (4, 4, 3), frozenset()
    ),
    "normals as bytes": Door(normal_maps.encode, (4, 4, 3), frozenset()),
    "offset map": Door(lambda a: bumped_reflections.offset_texels(a, GEFORCE_256), (4, 4, 3), frozenset()),
    "dirt": Door(
        lambda a: bumped_reflections.load(np.zeros((4, 4, 3)), a, "n", GEFORCE_256), (4, 4), frozenset()
    ),
    "a material's normals": Door(lambda a: material(normals=a), (4, 4, 3), frozenset()),
    "a gloss map": Door(lambda a: material(k_s=a), (4, 4), frozenset()),
    "an alpha per texel": Door(lambda a: material(alpha_x=a), (4, 4), frozenset()),
    "a material's colours": Door(
        lambda a: material_textures.load_colors(a, "c", GEFORCE_256), (4, 4, 3), frozenset()
    ),
}
# Doors inside the project, to which results of machines come: these are finite.
INNER = {
    "store_texels": Door(lambda a: images.store_texels(a, InternalFormat.RGBA8), (4, 4, 4)),
    "what the host looks up": Door(
        lambda a: software_pixel_texture.look_up(a, texture_2d(np.zeros((4, 4, 4), np.uint8))), (2, 2, 4)
    ),
}
# Heights and densities are measured: whole numbers are what they say.
MEASURED = {
    "heights of a picture": Door(height_fields.from_image, (4, 4), WORDS),
    "slopes": Door(height_fields.slopes, (4, 4), WORDS),
    "resample": Door(lambda a: height_fields.resample(a, 8, 8), (4, 4), WORDS),
    "smooth": Door(height_fields.smooth, (4, 4), WORDS),
    "tileable": Door(height_fields.tileable, (8, 8), WORDS),
    "normals of heights": Door(normal_maps.normals, (4, 4), WORDS),
    "embossed heights": Door(lambda a: emboss.load(a, "h", GEFORCE_256), (4, 4), WORDS),
    "a user's volume": Door(lambda a: volume_of(a, "v", OPENGL_1_2_IMAGING), (4, 4, 4), WORDS),
}
ALL = DOORS | MEASURED
# What has a size, so that there may be nothing of it.
SIZED = [
    *(name for name in DOORS if name.startswith("texture_")),
    *("a software renderer's picture", "DrawPixels", "TexImage", "stencil indices", "Bitmap", "palette"),
    *("compressed data", "png", "densities", "a material's normals", *MEASURED),
]


def doors(some):
    return pytest.mark.parametrize("door", [pytest.param(ALL.get(n) or INNER[n], id=n) for n in some])


def values(door, dtype):
    """Values from 2 to 65, which no door may take for one of another size."""
    count = int(np.prod(door.shape))
    return (2 + np.arange(count) * 64 // count).reshape(door.shape).astype(dtype)


@doors(ALL | INNER)
def test_a_door_takes_the_integers_that_it_knows_and_refuses_the_others(door):
    for dtype in INTEGERS:
        if dtype in door.integers:
            door.take(values(door, dtype))
            continue
        with pytest.raises(ValueError, match=r"give ") as refused:
            door.take(values(door, dtype))
        assert str(refused.value).endswith(".")


@doors(ALL)
def test_a_door_that_takes_floats_takes_all_of_them_and_no_nan(door):
    for dtype in FLOATS:
        given = values(door, dtype) / 100
        if door.floats:
            door.take(given)
            given.flat[1] = np.nan
        with pytest.raises(ValueError):
            door.take(given)


@doors(ALL | INNER)
def test_what_is_no_number_is_refused(door):
    for dtype in OTHERS:
        with pytest.raises(ValueError):
            door.take(np.ones(door.shape, dtype))


@doors(SIZED)
def test_an_empty_array_is_refused_for_being_empty(door):
    dtype = next(iter(door.integers), np.float64)
    with pytest.raises(ValueError, match=r"empty|at least|x0 voxels|shape \(0|0 bytes|0 colours|needs 4x4"):
        door.take(np.zeros((0, *door.shape[1:]), dtype))


@pytest.mark.parametrize("name", ["texture_1d", "texture_2d", "texture_3d", "texture_cube_map"])
def test_a_texture_s_refusal_says_what_to_do(name):
    door = DOORS[name]
    for dtype, advice in (
        ("int64", r"\.astype\(np\.uint8\) if they are bytes, / 65535\.0 if they are 16-bit\."),
        ("uint16", r"bytes \(uint8, 255 is one\) or floats \(1\.0 is one\)"),
        ("bool", r"holds bool; .*\.astype\(float\) if true is one\."),
        ("complex128", r"holds complex128; give bytes \(uint8, 255 is one\) or floats \(1\.0 is one\)\."),
    ):
        with pytest.raises(ValueError, match=advice):
            door.take(np.ones(door.shape, dtype))
    with pytest.raises(ValueError, match=r"shape \(.*0.*\), so it is empty; a texture needs at least 1x1"):
        door.take(np.zeros((0, *door.shape[1:])))
    with pytest.raises(ValueError, match="rows of different lengths"):
        door.take([[0.0], [0.0, 1.0]])


def test_whole_numbers_that_are_no_bytes_are_the_same_factors_as_floats():
    for dtype in INTEGERS:
        np.testing.assert_array_equal(
            encoding.factor_texels(np.array([0, 1], dtype), GEFORCE_256), np.array([0, 255], np.uint8)
        )


def test_heights_do_not_depend_on_their_type():
    for door in MEASURED.values():
        if door.take in (height_fields.from_image, height_fields.slopes, height_fields.smooth):
            expected = door.take(values(door, np.float64))
            for dtype in INTEGERS:
                np.testing.assert_array_equal(door.take(values(door, dtype)), expected)


@pytest.mark.parametrize(
    "make", [lambda numbers: ColorTable((numbers,)), lambda numbers: PixelMaps(r_to_r=numbers)]
)
def test_tables_of_colours_take_no_bytes(make):
    for dtype in INTEGERS:
        for number in (dtype.type(64), 64):
            with pytest.raises(
                ValueError, match=r"hold 64, a whole number; 1\.0 is one: / 255\.0 if they are byt"
            ):
                make((0, 1, number, 1.0))
        make((0, 1, dtype.type(1), 1.0))
    make((0.0, 64.0, 1.0, 0.5))  # floats are what they say, and clamped
