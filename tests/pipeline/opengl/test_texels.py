"""Texels that a client's image becomes, by every format that a machine has."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fixedpipe.pipeline.enums import BaseFormat, InternalFormat
from fixedpipe.pipeline.framebuffers.transfer import image_texels
from fixedpipe.pipeline.opengl import tokens as GL
from fixedpipe.pipeline.opengl.internal_formats import chosen_format, compressed_format
from fixedpipe.pipeline.opengl.outcomes import GLError, Refused
from fixedpipe.pipeline.opengl.pixels import FORMATS, INDEX_FORMATS, TYPES, ClientImage
from fixedpipe.pipeline.opengl.texels import check_image_format, texels_of, zero_texels
from fixedpipe.pipeline.pixel_transfer import INITIAL_TRANSFER
from fixedpipe.pipeline.profiles import PROFILES
from fixedpipe.pipeline.textures.images import COMPONENT_BITS
from fixedpipe.pipeline.textures.words import texels_of_words

GEFORCE_3, OCTANE = PROFILES["GEFORCE_3"], PROFILES["OCTANE"]
_COLORS = [f for f in FORMATS if f not in INDEX_FORMATS and FORMATS[f][0] != "DEPTH_COMPONENT"]
_INTERNAL = [
    *(1, 2, 3, 4, GL.ALPHA, GL.LUMINANCE, GL.LUMINANCE_ALPHA, GL.INTENSITY, GL.RGB, GL.RGBA),
    *(GL.R3_G3_B2, GL.RGB4, GL.RGB5, GL.RGB5_A1, GL.RGBA2, GL.RGBA4, GL.RGBA8, GL.RGB10_A2, GL.RGBA16),
    *(GL.ALPHA4, GL.LUMINANCE4_ALPHA4, GL.LUMINANCE6_ALPHA2, GL.INTENSITY4, GL.COMPRESSED_RGB),
]


@given(
    st.sampled_from(_COLORS),
    st.sampled_from([t for t in TYPES if t != GL.HALF_FLOAT_ARB]),
    st.sampled_from(_INTERNAL),
    st.sampled_from((GEFORCE_3, OCTANE)),
    st.integers(1, 2),
    st.integers(0, 2**32 - 1),
)
@settings(max_examples=150)
def test_every_way_gives_what_the_machine_makes_of_pixels(
    image_format, image_type, internal_format, profile, layers, seed
):
    """``image_texels`` is what a TexImage with pixels calls."""
    random, dtype = np.random.default_rng(seed), np.dtype(TYPES[image_type])
    shape = layers, 2, 3, FORMATS[image_format][1]
    if dtype.kind == "f":
        values = random.normal(0.5, 0.5, shape).astype(dtype)
    else:
        values = random.integers(np.iinfo(dtype).min, np.iinfo(dtype).max, shape, dtype, endpoint=True)
    image, chosen = ClientImage(values, image_format), chosen_format(profile, internal_format)
    found = texels_of(profile, image, INITIAL_TRANSFER, chosen, 2)
    pixels = image.pixel_image(layers=True)
    real, texels = image_texels(pixels, True, INITIAL_TRANSFER, profile, None, 2, chosen.format)
    np.testing.assert_array_equal(found.texels, texels)
    one = 255.0 if texels.dtype == np.uint8 else 4095.0
    np.testing.assert_array_equal(texels / one if found.real is None else found.real, real)


def test_every_sized_format_of_table_3_16_keeps_its_bits():
    for internal in COMPONENT_BITS:
        token = getattr(GL, internal.name, None)
        if token is not None:
            assert chosen_format(GEFORCE_3, token).format is internal


@pytest.mark.parametrize(
    ("token", "profile", "expected"),
    [
        (4, GEFORCE_3, InternalFormat.RGBA8),
        (GL.RGBA16, GEFORCE_3, InternalFormat.RGBA8),
        (GL.RGBA16, OCTANE, InternalFormat.RGBA12),
        (GL.LUMINANCE12_ALPHA4, OCTANE, InternalFormat.LUMINANCE12_ALPHA4),
        (GL.LUMINANCE16, GEFORCE_3, InternalFormat.LUMINANCE8),
        (GL.DEPTH_COMPONENT, GEFORCE_3, InternalFormat.DEPTH_COMPONENT24),
        (GL.DEPTH_COMPONENT32, GEFORCE_3, InternalFormat.DEPTH_COMPONENT24),
        (GL.COLOR_INDEX8_EXT, GEFORCE_3, InternalFormat.COLOR_INDEX8),
        (GL.SIGNED_RGB_NV, GEFORCE_3, InternalFormat.SIGNED_RGBA8),
        (GL.COMPRESSED_RGBA_S3TC_DXT5_EXT, GEFORCE_3, InternalFormat.RGBA8),
    ],
)
def test_what_the_driver_chose(token, profile, expected):
    assert chosen_format(profile, token).format is expected


@pytest.mark.parametrize("token", [GL.RED, 0x8229, 0x881A, 0x8C41, GL.DEPTH_STENCIL_EXT, 0x8D7C])
def test_formats_of_later_versions_are_refused_by_name(token):
    with pytest.raises(Refused, match="no machine here has the format"):
        chosen_format(GEFORCE_3, token)


@pytest.mark.parametrize("token", [0, 5, 0x1234, GL.TEXTURE_2D, GL.BGRA])
def test_what_is_no_internal_format_is_an_error(token):
    with pytest.raises(GLError) as error:
        chosen_format(GEFORCE_3, token)
    assert error.value.kind == GL.INVALID_VALUE


@pytest.mark.parametrize("token", [GL.DEPTH_COMPONENT, GL.COLOR_INDEX8_EXT, GL.HILO_NV, GL.SIGNED_RGBA_NV])
def test_a_machine_without_a_format_refuses_it_by_its_name(token):
    with pytest.raises(Refused, match="GeForce 256 has none"):
        chosen_format(PROFILES["GEFORCE_256"], token)
    with pytest.raises(Refused, match="GeForce 256 has none"):
        compressed_format(PROFILES["GEFORCE_256"], GL.COMPRESSED_RGBA_S3TC_DXT1_EXT)


def _image(values, image_format):
    return ClientImage(np.asarray(values)[None, None], image_format)


def _texel(values, image_format, internal_format):
    chosen = chosen_format(GEFORCE_3, internal_format)
    return texels_of(GEFORCE_3, _image(values, image_format), INITIAL_TRANSFER, chosen, 2).texels[0, 0]


def test_bumps_lie_where_direct3ds_words_have_them():
    """The tables of ``textures.words`` were measured."""
    high, low = np.int16([-3, 1000]), np.int16([32767, -32768])
    words = [(int(v) & 0xFFFF) << 16 | int(u) & 0xFFFF for u, v in zip(high, low, strict=True)]
    np.testing.assert_array_equal(
        _texel(np.stack([high, low], -1), GL.HILO_NV, GL.SIGNED_HILO_NV),
        texels_of_words(np.array(words), _word("V16U16")),
    )
    ds, dt = np.int8([-128, 5]), np.int8([127, -1])
    words = [(int(v) & 255) << 8 | int(u) & 255 for u, v in zip(ds, dt, strict=True)]
    np.testing.assert_array_equal(
        _texel(np.stack([ds, dt], -1), GL.DSDT_NV, GL.DSDT_NV),
        texels_of_words(np.array(words), _word("V8U8")),
    )
    unsigned = np.uint16([[0x1234, 0xABCD]])
    np.testing.assert_array_equal(
        _texel(unsigned, GL.HILO_NV, GL.HILO_NV), texels_of_words(np.array([0x1234ABCD]), _word("R16B16"))
    )
    both = np.array([[-64 / 127, 1.0, 0.5]], np.float32)
    np.testing.assert_array_equal(
        _texel(both, GL.DSDT_MAG_NV, GL.DSDT_MAG_NV),
        texels_of_words(np.array([0x80 << 16 | 127 << 8 | 0xC0]), _word("X8L8V8U8")),
    )


def _word(name):
    from fixedpipe.pipeline.enums import TexelWord

    return TexelWord[name]


def test_signed_colours_are_twos_complement_in_the_registers_places():
    bytes_ = np.int8([[-128, -1, 127, 64]])
    assert _texel(bytes_, GL.RGBA, GL.SIGNED_RGBA_NV).tolist() == [[128, 255, 127, 64]]
    assert _texel(bytes_[:, :3], GL.RGB, GL.SIGNED_RGB_NV).tolist() == [[128, 255, 127, 127]]
    assert _texel(bytes_[:, 1:2], GL.LUMINANCE, GL.SIGNED_LUMINANCE_NV).tolist() == [[255, 255, 255, 127]]
    assert _texel(bytes_[:, 3:], GL.ALPHA, GL.SIGNED_ALPHA_NV).tolist() == [[0, 0, 0, 64]]
    assert _texel(np.float32([[-1, 1, 0.5, 9]]), GL.RGBA, GL.SIGNED_RGBA_NV).tolist() == [[129, 127, 64, 127]]


def test_depths_are_words():
    found = _texel(np.float32([[0.5], [2.0], [-1.0]]), GL.DEPTH_COMPONENT, GL.DEPTH_COMPONENT16)
    assert found.view("<u4")[:, 0].tolist() == [32768, 65535, 0]
    exact = _texel(np.uint32([[0x80000000]]), GL.DEPTH_COMPONENT, GL.DEPTH_COMPONENT24)
    assert exact.view("<u4")[:, 0].tolist() == [0x800000]


@pytest.mark.parametrize("size", [(1, 1, 1), (1, 3, 1), (2, 1, 3)])
def test_depths_of_narrow_images_keep_their_shape(size):
    image = ClientImage(np.zeros((*size, 1), np.float32), GL.DEPTH_COMPONENT)
    chosen = chosen_format(GEFORCE_3, GL.DEPTH_COMPONENT16)
    assert texels_of(GEFORCE_3, image, INITIAL_TRANSFER, chosen, 2).texels.shape == (*size, 4)


@pytest.mark.parametrize(
    ("internal_format", "image_format", "kind"),
    [
        (GL.RGBA, GL.DEPTH_COMPONENT, GL.INVALID_OPERATION),
        (GL.DEPTH_COMPONENT, GL.RGBA, GL.INVALID_OPERATION),
        (GL.COLOR_INDEX8_EXT, GL.RGBA, GL.INVALID_OPERATION),
        (GL.HILO_NV, GL.RGBA, GL.INVALID_OPERATION),
        (GL.HILO_NV, GL.DSDT_NV, GL.INVALID_OPERATION),
        (GL.RGBA, GL.HILO_NV, GL.INVALID_OPERATION),
        (GL.RGBA, GL.STENCIL_INDEX, GL.INVALID_ENUM),
        (GL.RGBA, GL.COLOR_INDEX, None),
        (GL.COLOR_INDEX8_EXT, GL.COLOR_INDEX, None),
        (GL.DEPTH_COMPONENT, GL.DEPTH_COMPONENT, None),
        (GL.DEPTH_COMPONENT, GL.DEPTH_STENCIL_EXT, None),
        (GL.SIGNED_HILO_NV, GL.HILO_NV, None),
    ],
)
def test_groups_that_an_internal_format_can_hold(internal_format, image_format, kind):
    chosen = chosen_format(GEFORCE_3, internal_format)
    if kind is None:
        check_image_format(chosen, image_format)
        return
    with pytest.raises(GLError) as error:
        check_image_format(chosen, image_format)
    assert error.value.kind == kind


@pytest.mark.parametrize("base", list(BaseFormat))
def test_undefined_texels_are_black_of_their_base_format(base):
    token = {BaseFormat.LUMINANCE_ALPHA: GL.LUMINANCE_ALPHA}.get(base) or getattr(GL, base.name)
    found = zero_texels(chosen_format(GEFORCE_3, token), 1, 2, 3).texels
    opaque = base in (BaseFormat.RGB, BaseFormat.LUMINANCE)
    np.testing.assert_array_equal(found, np.broadcast_to([0, 0, 0, 255 if opaque else 0], (1, 2, 3, 4)))


def test_numbers_that_are_none_become_numbers():
    found = _texel(np.float32([[np.nan, np.inf, -np.inf, 1e38]]), GL.RGBA, GL.RGBA)
    assert found.tolist() == [[0, 255, 0, 255]]
