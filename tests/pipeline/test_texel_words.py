"""Textures made from memory's words are what the specification makes of each word alone."""

import numpy as np
import pytest

from fixedpipe.pipeline.enums import InternalFormat, TexelWord, TextureTarget
from fixedpipe.pipeline.profiles import IDEAL, NV2A
from fixedpipe.pipeline.textures.images import Texture
from fixedpipe.pipeline.textures.words import (
    compressed_texture,
    compressed_volume,
    paletted_texture,
    stored_texture,
    texels_of_words,
    texture_of_words,
    ycbcr_of_words,
)
from tests.reference import texel_words

RANDOM = np.random.default_rng(5)
S3TC = {name: InternalFormat[f"COMPRESSED_RGBA_S3TC_{name}"] for name in ("DXT1", "DXT3", "DXT5")}


@pytest.mark.parametrize("name", texel_words.LAYOUTS)
def test_every_component_of_a_word_reaches_its_register_component(name):
    words = np.append(RANDOM.integers(0, 2**32, 4000), [0, 2**32 - 1])
    expected = [texel_words.texel_of_word(word, name) for word in words.tolist()]
    assert texels_of_words(words, TexelWord[name]).tolist() == expected


@pytest.mark.parametrize("kind", [TexelWord.YUY2, TexelWord.UYVY])
def test_a_pair_of_ycbcr_words_shares_its_chroma(kind):
    y, u, v = (RANDOM.integers(0, 256, (30, 2)) for _ in range(3))
    chroma = np.stack([u[:, 0], v[:, 0]], -1)
    words = y | (chroma << 8) if kind is TexelWord.YUY2 else chroma | (y << 8)
    expected = [
        [texel_words.texel_of_ycbcr(y, *uv) for y in pair]
        for pair, uv in zip(y.tolist(), chroma.tolist(), strict=True)
    ]
    assert texels_of_words(words, kind).tolist() == expected
    with pytest.raises(ValueError, match="pairs"):
        texels_of_words(words[:, :1], kind)


def test_words_without_chroma_are_refused():
    for words, kind, said in (
        (np.zeros((2, 4), int), TexelWord.R5G6B5, "has no Y, Cb and Cr"),
        (np.zeros((2, 3), int), TexelWord.YUY2, "3 columns are not even"),
        (np.zeros((), int), TexelWord.UYVY, "a single number"),
    ):
        with pytest.raises(ValueError, match=said):
            ycbcr_of_words(words, kind)


def test_the_brightest_and_darkest_ycbcr_texels():
    words = np.array([[0x80EB, 0x80EB, 0x8010, 0x8010]])
    assert (
        texels_of_words(words, TexelWord.YUY2)[0, :, :3].tolist() == [[254, 255, 254]] * 2 + [[0, 0, 0]] * 2
    )


@pytest.mark.parametrize(
    ("kind", "word", "depth"),
    [
        (TexelWord.X8_Y24_FIXED, 0xABCDEF99, 0xABCDEF),
        (TexelWord.X8_Y24_FLOAT, 0xABCDEF99, 0xABCDEF),
        (TexelWord.Y16_FIXED, 0xBEEF, 0xBEEF),
        (TexelWord.Y16_FLOAT, 0xBEEF, 0xBEEF),
    ],
)
def test_a_depth_texel_is_its_depth_units_lowest_byte_first(kind, word, depth):
    assert int(texels_of_words(np.array([word]), kind).view(np.uint32)[0, 0]) == depth


def test_palettes_ignore_the_high_bits_of_an_index():
    palette = RANDOM.integers(0, 2**32, 32)
    texture = paletted_texture([[0, 31, 32, 255]], palette)
    expected = texels_of_words(palette[[0, 31, 0, 31]], TexelWord.A8R8G8B8)
    assert (texture.levels[0][0, 0] == expected).all()
    assert texture.internal_format is InternalFormat.COLOR_INDEX8
    with pytest.raises(ValueError, match="power of two"):
        paletted_texture([[0]], palette[:3])


def test_a_volume_keeps_its_layers():
    words = RANDOM.integers(0, 2**16, (4, 8, 2))
    texture = texture_of_words([words, words[:2, :4, :1]], TexelWord.R5G6B5, TextureTarget.TEXTURE_3D)
    assert (texture.width, texture.height, texture.depth) == (2, 8, 4)
    assert [level.shape for level in texture.levels] == [(4, 8, 2, 4), (2, 4, 1, 4)]


@pytest.mark.parametrize("name", S3TC)
def test_blocks_are_decoded_alike(name):
    size = 8 if name == "DXT1" else 16
    blocks = RANDOM.integers(0, 256, (3, 5, size), np.uint8)
    blocks[0, :, -8:-4] = 77  # equal ends
    texture = compressed_texture(blocks.tobytes(), S3TC[name], 20, 12)
    for row, column in np.ndindex(3, 5):
        square = texture.levels[0][0, 4 * row : 4 * row + 4, 4 * column : 4 * column + 4]
        expected = texel_words.texels_of_block(blocks[row, column].tolist(), name)
        assert square.reshape(16, 4).tolist() == expected


def test_small_levels_fill_a_block_and_missing_bytes_are_refused():
    data = RANDOM.integers(0, 256, 8 * (4 + 1 + 1 + 1), np.uint8).tobytes()
    texture = compressed_texture(data, S3TC["DXT1"], 8, 8, 4)
    assert [level.shape[1:3] for level in texture.levels] == [(8, 8), (4, 4), (2, 2), (1, 1)]
    with pytest.raises(ValueError, match="level 3"):
        compressed_texture(data[:-1], S3TC["DXT1"], 8, 8, 4)


@pytest.mark.parametrize("name", S3TC)
@pytest.mark.parametrize("depth", [1, 2, 4, 8, 6])
def test_a_volume_s_blocks_lie_together_by_four_layers(name, depth):
    size, rows, columns = 8 if name == "DXT1" else 16, 2, 3
    blocks = RANDOM.integers(0, 256, (depth * rows * columns, size), np.uint8)
    texture = compressed_volume(blocks.tobytes(), S3TC[name], 12, 8, depth)
    assert texture.levels[0].shape == (depth, 8, 12, 4)
    for layer, row, column in np.ndindex(depth, rows, columns):
        square = texture.levels[0][layer, 4 * row : 4 * row + 4, 4 * column : 4 * column + 4]
        block = blocks[texel_words.place_of_block(layer, row, column, rows, columns, depth)]
        assert square.reshape(16, 4).tolist() == texel_words.texels_of_block(block.tolist(), name)
    with pytest.raises(ValueError, match=f"12x8x{depth}"):
        compressed_volume(blocks.tobytes()[:-1], S3TC[name], 12, 8, depth)


def dithered(level):
    """Texels [layers, rows, columns, 4] through the specification."""
    return [
        [[texel_words.dithered(p, x, y) for x, p in enumerate(row)] for y, row in enumerate(face)]
        for face in level.tolist()
    ]


def test_every_colour_is_dithered_alike_at_every_place():
    """Layers of one value each, and a square that is repeated beyond its edge."""
    level = np.broadcast_to(np.arange(256, dtype=np.uint8)[:, None, None, None], (256, 5, 6, 4))
    texture = Texture(TextureTarget.TEXTURE_3D, S3TC["DXT1"], (level,))
    assert stored_texture(texture, NV2A).levels[0].tolist() == dithered(level)


@pytest.mark.parametrize("name", S3TC)
def test_random_blocks_are_dithered_alike_where_the_machine_does(name):
    data = RANDOM.integers(0, 256, (16 + 4 + 1 + 1 + 1) * (8 if name == "DXT1" else 16), np.uint8)
    texture = compressed_texture(data.tobytes(), S3TC[name], 16, 16, 5)
    assert stored_texture(texture, IDEAL) is texture
    for level, stored in zip(texture.levels, stored_texture(texture, NV2A).levels, strict=True):
        assert stored.tolist() == (dithered(level) if name == "DXT1" else level.tolist())
