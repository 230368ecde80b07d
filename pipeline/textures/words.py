"""Textures from words of memory: packed and signed pixels, palettes, YCbCr pairs, S3TC blocks.

``images`` makes textures from components. Arrays of words are [rows, columns], or [faces or layers, rows,
columns]; the first row is t = 0.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.pipeline.enums import InternalFormat, TexelWord, TextureTarget
from fixedpipe.pipeline.textures.images import Texture, at_machine_width, widen_to_byte
from fixedpipe.pipeline.textures.pixels import whole_numbers

ONE = None  # a component of full intensity

# How each word is stored: the format, and its red, green, blue and alpha as (lowest bit, bits). Measured:
# every pixel of the formats' captures (Texture_format; Volume_texture, Y16's low byte too). Source:
# NV_texture_shader (HILO16). From V8U8 on, Source: Direct3D 8's D3DFORMAT, U in the lowest bits; the Xbox's
# Direct3D, where V8U8, L6V5U5, X8L8V8U8 and Q8W8V8U8 are other names of G8B8, R6G5B5, X8R8G8B8 and A8B8G8R8;
# wined3d, which hands V8U8, Q8W8V8U8 and V16U16 to NV_texture_shader as DSDT8, SIGNED_RGBA8 and
# SIGNED_HILO16, where U is HI. Measured: five signed bits are widened by replication, 606476 pixels of 606476
# (BumpEnvLum_R6G5B5_B, _B_R90; wined3d's widening misses 25,000).
_FIELDS = {
    TexelWord.A8R8G8B8: (InternalFormat.RGBA8, (16, 8), (8, 8), (0, 8), (24, 8)),
    TexelWord.X8R8G8B8: (InternalFormat.RGB8, (16, 8), (8, 8), (0, 8), ONE),
    TexelWord.A8B8G8R8: (InternalFormat.RGBA8, (0, 8), (8, 8), (16, 8), (24, 8)),
    TexelWord.B8G8R8A8: (InternalFormat.RGBA8, (8, 8), (16, 8), (24, 8), (0, 8)),
    TexelWord.R8G8B8A8: (InternalFormat.RGBA8, (24, 8), (16, 8), (8, 8), (0, 8)),
    TexelWord.A1R5G5B5: (InternalFormat.RGB5_A1, (10, 5), (5, 5), (0, 5), (15, 1)),
    TexelWord.X1R5G5B5: (InternalFormat.RGB5, (10, 5), (5, 5), (0, 5), ONE),
    TexelWord.A4R4G4B4: (InternalFormat.RGBA4, (8, 4), (4, 4), (0, 4), (12, 4)),
    TexelWord.R5G6B5: (InternalFormat.R5_G6_B5, (11, 5), (5, 6), (0, 5), ONE),
    TexelWord.R6G5B5: (InternalFormat.R6_G5_B5, (10, 6), (5, 5), (0, 5), ONE),
    TexelWord.G8B8: (InternalFormat.GREEN8_BLUE8, (0, 8), (8, 8), (0, 8), (8, 8)),
    TexelWord.R8B8: (InternalFormat.RED8_BLUE8, (8, 8), (0, 8), (0, 8), (8, 8)),
    TexelWord.A8Y8: (InternalFormat.LUMINANCE8_ALPHA8, (0, 8), (0, 8), (0, 8), (8, 8)),
    TexelWord.Y8: (InternalFormat.LUMINANCE8, (0, 8), (0, 8), (0, 8), ONE),
    TexelWord.AY8: (InternalFormat.INTENSITY8, (0, 8), (0, 8), (0, 8), (0, 8)),
    TexelWord.A8: (InternalFormat.WHITE_ALPHA8, ONE, ONE, ONE, (0, 8)),
    TexelWord.Y16: (InternalFormat.LUMINANCE16, ONE, (8, 8), (0, 8), ONE),
    TexelWord.R16B16: (InternalFormat.HILO16, (16, 8), (8, 8), (0, 8), (24, 8)),
    TexelWord.V8U8: (InternalFormat.DSDT8, (0, 8), (8, 8), (0, 8), (8, 8)),
    TexelWord.L6V5U5: (InternalFormat.DSDT8_MAG8, (10, 6), (5, 5), (0, 5), ONE),
    TexelWord.X8L8V8U8: (InternalFormat.DSDT8_MAG8, (16, 8), (8, 8), (0, 8), ONE),
    TexelWord.Q8W8V8U8: (InternalFormat.SIGNED_RGBA8, (0, 8), (8, 8), (16, 8), (24, 8)),
    TexelWord.V16U16: (InternalFormat.SIGNED_HILO16, (0, 8), (24, 8), (16, 8), (8, 8)),
}
# How depth words are stored: the format, and the lowest bit of the depth.
_DEPTHS = {
    TexelWord.X8_Y24_FIXED: (InternalFormat.DEPTH_COMPONENT24, 8),
    TexelWord.X8_Y24_FLOAT: (InternalFormat.DEPTH_COMPONENT24_FLOAT, 8),
    TexelWord.Y16_FIXED: (InternalFormat.DEPTH_COMPONENT16, 0),
    TexelWord.Y16_FLOAT: (InternalFormat.DEPTH_COMPONENT16_FLOAT, 0),
}


def ycbcr_to_rgb(y, u, v):
    """R, G, B of a texel, integer arrays 0..255, from its Y and its pair's U (Cb) and V (Cr).

    ``L = (298 Y - 4864) >> 8``, c = U - 128, d = V - 128: R is ``L + 2 ((409 d + 128) >> 9)``, G
    ``L + 1 - 2 ((100 c) >> 9) - 2 ((208 d) >> 9)``, B ``L + ((516 c) >> 8)``, clamped.
    Measured: 123904 of 123904 pixels (Texture_format UYVY_L), Y 41 to 209, U and V 18 to 239.
    """
    light, c, d = (298 * y - 4864) >> 8, u - 128, v - 128
    red = light + 2 * ((409 * d + 128) >> 9)
    green = light + 1 - 2 * ((100 * c) >> 9) - 2 * ((208 * d) >> 9)
    blue = light + ((516 * c) >> 8)
    return tuple(np.clip(channel, 0, 255) for channel in (red, green, blue))


def ycbcr_of_words(words, kind):
    """Y, Cb, Cr and 255, uint8 [..., 4], of words of 16 bits, in pairs along the rows.

    Units read these where a pass converts their results (``PassState.ycbcr_conversion``). ``kind`` is
    TexelWord.YUY2 or UYVY. Raises ValueError for another kind, and where rows are not pairs.
    """
    words = whole_numbers(words, "The array of words")
    if kind not in (TexelWord.YUY2, TexelWord.UYVY):
        raise ValueError(
            f"{kind!r} has no Y, Cb and Cr; give TexelWord.YUY2 or UYVY, or use texels_of_words."
        )
    if words.ndim == 0:
        raise ValueError("The array of words is a single number; give rows of pairs of texels.")
    low, high = words & 255, (words >> 8) & 255
    y, chroma = (low, high) if kind is TexelWord.YUY2 else (high, low)
    if words.shape[-1] % 2:
        raise ValueError(f"YCbCr rows come in pairs of texels; {words.shape[-1]} columns are not even.")
    u, v = (np.repeat(chroma[..., k::2], 2, -1) for k in (0, 1))
    return np.stack([y, u, v, np.full_like(y, 255)], -1).astype(np.uint8)


def texels_of_words(words, kind):
    """Register bytes uint8 [..., 4] of an array of words; ``Texture`` says what depths and HILO are."""
    words = whole_numbers(words, "The array of words")
    if kind in (TexelWord.YUY2, TexelWord.UYVY):
        texels = ycbcr_of_words(words, kind)
        texels[..., :3] = np.stack(ycbcr_to_rgb(*np.moveaxis(texels[..., :3].astype(np.int64), -1, 0)), -1)
        return texels
    if kind in _DEPTHS:
        depth = words >> _DEPTHS[kind][1]
        return np.stack([(depth >> shift) & 255 for shift in (0, 8, 16, 24)], -1).astype(np.uint8)
    out = np.full((*words.shape, 4), 255, np.uint8)
    for channel, field in enumerate(_FIELDS[kind][1:]):
        if field is not ONE:
            low, bits = field
            out[..., channel] = widen_to_byte((words >> low) & (2**bits - 1), bits)
    return out


def internal_format_of(kind):
    """The InternalFormat in which words of this kind are stored."""
    if kind in (TexelWord.YUY2, TexelWord.UYVY):
        return InternalFormat.YCBCR
    return _DEPTHS[kind][0] if kind in _DEPTHS else _FIELDS[kind][0]


def _levels(images):
    return tuple(level if level.ndim == 4 else level[None] for level in images)


def texture_of_words(images, kind, target=TextureTarget.TEXTURE_2D):
    """A texture from words: an array for each level, level 0 first, in a tuple or list; or level 0 alone.

    An array for a cube map or a 3D texture is [faces or layers, rows, columns].
    """
    images = images if isinstance(images, (tuple, list)) else (images,)
    levels = _levels([texels_of_words(image, kind) for image in images])
    return Texture(target, internal_format_of(kind), levels)


def paletted_texture(indices, palette, target=TextureTarget.TEXTURE_2D):
    """EXT_paletted_texture with its color table: ``indices`` into ``palette``, words A8R8G8B8.

    A table of n colours, n a power of two, takes the index modulo n (Source: EXT_paletted_texture: the high
    bits of an index are ignored). Raises ValueError for a palette of another size.
    """
    colors = texels_of_words(palette, TexelWord.A8R8G8B8)
    if len(colors) & (len(colors) - 1) or not len(colors):
        raise ValueError(f"The palette has {len(colors)} colours; give a power of two.")
    texels = colors[whole_numbers(indices, "The array of indices") & (len(colors) - 1)]
    return Texture(target, InternalFormat.COLOR_INDEX8, _levels([texels]))


# ------------------------------------------------------------------------- EXT_texture_compression_s3tc

S3TC_BLOCK_BYTES = {
    InternalFormat.COMPRESSED_RGBA_S3TC_DXT1: 8,
    InternalFormat.COMPRESSED_RGBA_S3TC_DXT3: 16,
    InternalFormat.COMPRESSED_RGBA_S3TC_DXT5: 16,
}


def _unpacked(block_bytes, bits):
    """Little-endian fields of ``bits`` bits, int64 [..., 16], from the bytes of a block's texel codes."""
    word = np.zeros(block_bytes.shape[:-1], np.uint64)
    for k in range(block_bytes.shape[-1]):
        word |= block_bytes[..., k].astype(np.uint64) << np.uint64(8 * k)
    shifts = np.arange(16, dtype=np.uint64) * np.uint64(bits)
    return ((word[..., None] >> shifts) & np.uint64(2**bits - 1)).astype(np.int64)


def _s3tc_colors(blocks, punch_through):
    """RGBA bytes int64 [..., 16, 4] of color blocks uint8 [..., 8]; thirds are ``(2a + b + 1) // 3``.

    Measured: 1024 of 1024 texels (DXT3_plasma). Assumed: a half is ``(a + b + 1) // 2``.
    """
    blocks = blocks.astype(np.int64)
    ends = [blocks[..., k] | (blocks[..., k + 1] << 8) for k in (0, 2)]
    a, b = (texels_of_words(end, TexelWord.R5G6B5).astype(np.int64) for end in ends)
    palette = np.stack([a, b, (2 * a + b + 1) // 3, (a + 2 * b + 1) // 3], -2)
    if punch_through:
        three = np.stack([a, b, (a + b + 1) // 2, np.zeros_like(a)], -2)
        palette = np.where((ends[0] > ends[1])[..., None, None], palette, three)
    codes = _unpacked(blocks[..., 4:8], 2)
    return np.take_along_axis(palette, codes[..., None], -2)


def _s3tc_alphas(blocks):
    """Alpha bytes int64 [..., 16] of DXT5's alpha blocks uint8 [..., 8], with rounded sevenths and fifths.

    Measured: all pixels of DXT5_plasma_alpha and MIPDXT5_plasma_alpha.
    """
    ends = blocks[..., :2].astype(np.int64)
    a, b = ends[..., 0], ends[..., 1]
    seven = np.stack([a, b, *(((7 - k) * a + k * b + 3) // 7 for k in range(1, 7))], -1)
    five = np.stack(
        [
            a,
            b,
            *(((5 - k) * a + k * b + 2) // 5 for k in range(1, 5)),
            np.zeros_like(a),
            np.full_like(a, 255),
        ],
        -1,
    )
    palette = np.where((a > b)[..., None], seven, five)
    return np.take_along_axis(palette, _unpacked(blocks[..., 2:], 3), -1)


def texels_of_blocks(blocks, internal_format, width, height):
    """Register bytes uint8 [height, width, 4] of S3TC blocks uint8 [rows, columns, bytes of a block].

    The first row is t = 0. DXT3's four bits of alpha become a byte by replication.
    """
    if internal_format is InternalFormat.COMPRESSED_RGBA_S3TC_DXT1:
        texels = _s3tc_colors(blocks, True)
    else:
        texels = _s3tc_colors(blocks[..., 8:], False)
        if internal_format is InternalFormat.COMPRESSED_RGBA_S3TC_DXT3:
            texels[..., 3] = 17 * _unpacked(blocks[..., :8], 4)
        else:
            texels[..., 3] = _s3tc_alphas(blocks[..., :8])
    rows, columns = blocks.shape[:2]
    squares = texels.reshape(rows, columns, 4, 4, 4).transpose(0, 2, 1, 3, 4)
    return squares.reshape(rows * 4, columns * 4, 4)[:height, :width].astype(np.uint8)


# Ordered dithering of decoded DXT1 colours: the amount subtracted from a texel, by its place in a square of
# 4x4, and the step. Measured: 2048 of 2048 texels (Texture_DXT captures).
_DITHER_RED = np.array([[0, 4, 1, 5], [2, 6, 3, 7], [5, 1, 4, 0], [7, 3, 6, 2]])
_DITHER_GREEN = np.array([[3, 1, 2, 0], [2, 0, 1, 3], [1, 3, 0, 2], [0, 2, 3, 1]])
_DITHER = ((_DITHER_RED, 8), (_DITHER_GREEN, 4), (_DITHER_RED[::-1], 8))


def dithered_level(level):
    """A level uint8 [layers, height, width, 4] with red, green and blue dithered to 5, 6 and 5 bits.

    A texel v with the amount d of its place and the step s has m, which is v - d cut to the kept bits. Its
    byte is 0 for m = 0, 255 for the largest m, and ``s*m + d + s/2 - 1`` for the others. Measured: every byte
    that the texels of Texture_DXT and of the volume's four layers have (Volume_texture DXT1, 305890 of 305890
    pixels).
    """
    y, x = np.ogrid[: level.shape[1], : level.shape[2]]
    out = level.copy()
    for channel, (square, step) in enumerate(_DITHER):
        d = square[y & 3, x & 3]
        m = np.maximum(level[..., channel].astype(np.int64) - d, 0) // step
        given_back = step * m + d + (step // 2 - 1)
        out[..., channel] = np.where(m == 0, 0, np.where(m == 256 // step - 1, 255, given_back))
    return out


def stored_texture(texture, profile):
    """The texture as a machine holds it: with components of its width, and DXT1 dithered if it does so."""
    dxt1 = texture.internal_format is InternalFormat.COMPRESSED_RGBA_S3TC_DXT1
    if not (dxt1 and profile.arithmetic.dithered_s3tc_dxt1):
        return at_machine_width(texture, profile)
    return replace(texture, levels=tuple(dithered_level(level) for level in texture.levels))


def _bytes_of(data):
    """The bytes of a bytes object or an array of uint8. Raises ValueError for another array."""
    if isinstance(data, np.ndarray) and data.dtype != np.uint8:
        raise ValueError(f"The compressed data is an array of {data.dtype}; give bytes: .astype(np.uint8).")
    return np.frombuffer(data, np.uint8)


def compressed_texture(data, internal_format, width, height, levels=1):
    """CompressedTexImage2D: a 2D texture from the bytes of its levels, one after the other, level 0 first.

    Raises ValueError where the bytes do not hold all levels.
    """
    size, images, at = S3TC_BLOCK_BYTES[internal_format], [], 0
    data = _bytes_of(data)
    for level in range(levels):
        w, h = max(1, width >> level), max(1, height >> level)
        shape = (-(-h // 4), -(-w // 4), size)
        end = at + shape[0] * shape[1] * size
        if end > len(data):
            raise ValueError(
                f"{len(data)} bytes do not hold {levels} levels of a {width}x{height} "
                f"{internal_format.name} texture; level {level} ends at byte {end}."
            )
        images.append(texels_of_blocks(data[at:end].reshape(shape), internal_format, w, h))
        at = end
    return Texture(TextureTarget.TEXTURE_2D, internal_format, _levels(images))


def compressed_volume(data, internal_format, width, height, depth):
    """CompressedTexImage3D: a 3D texture of one level from its bytes.

    The four layers of a block follow one another, then comes the next block of the row. A last brick with
    fewer layers is shorter by the missing ones. Raises ValueError where the bytes are too few. Source:
    NV_texture_compression_vtc; Assumed: the NV2A follows it.
    """
    size, rows, columns = S3TC_BLOCK_BYTES[internal_format], -(-height // 4), -(-width // 4)
    data, layers = _bytes_of(data), []
    needed = depth * rows * columns * size
    if len(data) < needed:
        raise ValueError(
            f"{len(data)} bytes do not hold a {width}x{height}x{depth} {internal_format.name} texture, which "
            f"needs {needed}."
        )
    for first in range(0, depth, 4):
        together = min(4, depth - first)
        start, end = (at * rows * columns * size for at in (first, first + together))
        blocks = data[start:end].reshape(rows, columns, together, size)
        layers += [texels_of_blocks(blocks[:, :, k], internal_format, width, height) for k in range(together)]
    return Texture(TextureTarget.TEXTURE_3D, internal_format, (np.stack(layers),))
