"""Pixel transfer: whole images equal the specification, one group at a time, to the bit."""

from dataclasses import replace
from fractions import Fraction
from functools import partial
from math import floor

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.enums import BaseFormat, ConvolutionBorderMode, InternalFormat, TextureTarget
from fixedpipe.pipeline.framebuffers import transfer_steps
from fixedpipe.pipeline.framebuffers.scaled_words import Words, scaled_words
from fixedpipe.pipeline.framebuffers.texture_copies import defined_texture
from fixedpipe.pipeline.framebuffers.transfer import (
    PixelStatistics,
    image_groups,
    looked_up,
    packed_colors,
    transfer_color_indices,
    transfer_colors,
    transfer_depths,
    transfer_stencil,
)
from fixedpipe.pipeline.framebuffers.transfer_steps import ENTRY_COMPONENTS, table_entries
from fixedpipe.pipeline.pixel_transfer import (
    INITIAL_TRANSFER,
    ConvolutionFilter,
    Histogram,
    Minmax,
    PixelImage,
    PixelMaps,
    PixelTransfer,
    SeparableFilter,
    transferred_size,
)
from fixedpipe.pipeline.profiles import IDEAL, OCTANE, OPENGL_1_2_IMAGING
from fixedpipe.pipeline.state import IDENTITY, ColorTable
from fixedpipe.pipeline.textures.pixel_formats import (
    COMPONENT_TYPES,
    IMAGE_FORMATS,
    PACKED_TYPES,
    READ_TYPES,
    packed_formats,
)
from fixedpipe.raster.pixel_groups import RUN
from fixedpipe.raster.pixels import transfer as arithmetic
from tests.reference import pixel_transfer as reference
from tests.reference import texel_formats

_REAL = st.floats(-4.0, 4.0, width=32)
_UNIT = st.one_of(st.sampled_from([0.0, 0.5, 1.0, -0.25, 1.5]), st.floats(-1.0, 2.0))
_COLOR = st.tuples(_UNIT, _UNIT, _UNIT, _UNIT)
_FACTORS = st.tuples(_REAL, _REAL, _REAL, _REAL)
_COUNTED_FORMATS = sorted(reference.COUNTED)


def _tables():
    entries = st.integers(0, 3).flatmap(lambda n: st.lists(_COLOR, min_size=2**n, max_size=2**n).map(tuple))
    return st.builds(ColorTable, entries, st.sampled_from(BaseFormat), st.sampled_from([None, 1, 4, 8, 12]))


def _maps(values, n=(1, 5)):
    return st.lists(values, min_size=n[0], max_size=n[1]).map(tuple)


def _index_maps(values):
    return st.integers(0, 3).flatmap(lambda n: _maps(values, (2**n, 2**n)))


def _filters(high=3):
    shape = st.tuples(st.integers(1, high), st.integers(1, 3))
    rows = shape.flatmap(
        lambda s: st.lists(
            st.lists(_FACTORS, min_size=s[1], max_size=s[1]).map(tuple), min_size=s[0], max_size=s[0]
        ).map(tuple)
    )
    rest = st.sampled_from(BaseFormat), st.sampled_from(ConvolutionBorderMode), _COLOR
    return st.builds(ConvolutionFilter, rows, *rest)


def _separable_filters():
    line = st.lists(_FACTORS, min_size=1, max_size=3).map(tuple)
    rest = st.sampled_from(BaseFormat), st.sampled_from(ConvolutionBorderMode), _COLOR
    return st.builds(SeparableFilter, line, line, *rest)


def _optional(strategy):
    return st.one_of(st.none(), strategy)


_TRANSFERS = st.builds(
    PixelTransfer,
    scale=_FACTORS,
    bias=_FACTORS,
    index_shift=st.integers(-3, 3),
    index_offset=st.integers(-9, 9),
    map_color=st.booleans(),
    maps=st.builds(
        PixelMaps,
        *[_index_maps(_UNIT)] * 4,
        *[_maps(_UNIT)] * 4,
    ),
    color_table=_optional(_tables()),
    convolution_1d=_optional(_filters(high=1)),
    convolution_2d=_optional(_filters()),
    separable_2d=_optional(_separable_filters()),
    post_convolution_scale=_FACTORS,
    post_convolution_bias=_FACTORS,
    post_convolution_color_table=_optional(_tables()),
    color_matrix=st.one_of(st.just(IDENTITY), st.tuples(_FACTORS, _FACTORS, _FACTORS, _FACTORS)),
    post_color_matrix_scale=st.one_of(st.just((1.0,) * 4), _FACTORS),
    post_color_matrix_bias=st.one_of(st.just((0.0,) * 4), _FACTORS),
    post_color_matrix_color_table=_optional(_tables()),
    histogram=_optional(
        st.builds(
            Histogram,
            st.just("h"),
            st.sampled_from([1, 4, 256]),
            st.sampled_from(_COUNTED_FORMATS),
            st.booleans(),
        )
    ),
    minmax=_optional(st.builds(Minmax, st.just("m"), st.sampled_from(_COUNTED_FORMATS), st.booleans())),
)


def _image(width, height, seed):
    """Groups with values at, between and beyond [0, 1]."""
    random = np.random.default_rng(seed)
    image = random.uniform(-0.5, 1.5, (height, width, 4))
    image[random.random(image.shape) < 0.3] = random.choice([0.0, 0.5, 1.0])
    return image


def _same_as_reference(image, transfer, profile, dimensions, indices=False):
    """Both, from tables that have seen something before; the groups or None."""
    statistics = PixelStatistics()
    counts = extremes = None
    if transfer.histogram is not None:
        counts = reference.new_counts(transfer.histogram)
    if transfer.minmax is not None:
        extremes = reference.new_extremes(transfer.minmax)
    for _ in range(2):
        expected = reference.transfer(
            image.tolist(),
            transfer,
            dimensions,
            profile.arithmetic.clamps_color_matrix,
            counts,
            extremes,
            indices,
        )
        convert = transfer_color_indices if indices else transfer_colors
        groups = convert(image, transfer, profile, statistics, dimensions)
    assert (groups is None) == (expected is None)
    if groups is not None:
        width, height = transferred_size(*image.shape[1::-1], transfer, dimensions)
        assert groups.shape == (height, width, 4)
        assert groups.tolist() == (expected if width else [[]] * height)
    if counts is not None:
        assert statistics.histograms["h"].counts.dtype == np.uint32
        assert statistics.histograms["h"].counts.tolist() == counts
    if extremes is not None and "m" in statistics.minmaxes:
        assert statistics.minmaxes["m"].extremes.tolist() == extremes
    return groups


@settings(max_examples=250)
@given(
    _TRANSFERS,
    st.sampled_from([OPENGL_1_2_IMAGING, OCTANE]),
    st.integers(1, 5),
    st.integers(1, 4),
    st.integers(1, 3),
    st.integers(0, 2**32 - 1),
)
def test_colors_equal_the_specification(transfer, profile, width, height, dimensions, seed):
    height = 1 if dimensions == 1 else height
    _same_as_reference(_image(width, height, seed), transfer, profile, dimensions)


@settings(max_examples=150)
@given(_TRANSFERS, st.sampled_from([1, 15, 255, 4095, 65535, 2**32 - 1]), st.integers(0, 2**32 - 1))
def test_words_equal_the_specification(transfer, one, seed):
    """Groups in fixed point, of every width; some lie outside what it holds."""
    words = np.random.default_rng(seed).integers(-(one // 8), one + one // 8 + 1, (3, 4, 4))
    fractions = [[[Fraction(c, one) for c in group] for group in row] for row in words.tolist()]
    transfer = replace(transfer, histogram=None, minmax=None)
    expected = reference.transfer(fractions, transfer, 2, False, None, None)
    found = transfer_colors(Words(words, (one,) * 4), transfer, OPENGL_1_2_IMAGING, PixelStatistics())
    assert found.tolist() == (expected if found.shape[1] else [[]] * found.shape[0])


@settings(max_examples=400)
@given(
    st.integers(1, 255),
    st.integers(2, 4096),
    st.integers(0, 2**32),
    st.integers(-(2**31), 2**31),
    st.sampled_from([-1, 0, 1]),
)
def test_beside_a_half_a_byte_is_rounded_as_in_real_numbers(word, size, entry, bias, beside):
    """The scale, of 31 fraction bits, leads closest to a half: below it, to it perhaps, above it."""
    half, bias = Fraction(2 * (entry % (size - 1)) + 1, 2 * (size - 1)), Fraction(bias, 2**31)
    scale = Fraction(floor((half - bias) * 255 / word * 2**31) + beside, 2**31)
    found = scaled_words(Words(np.full((1, 4), word), (255,) * 4), (float(scale),) * 4, (float(bias),) * 4)
    exact = min(max(scale * word / 255 + bias, 0), 1)
    assert arithmetic.nearest(found.clip(0, 1) * (size - 1))[0, 0] == floor(
        exact * (size - 1) + Fraction(1, 2)
    )


@settings(max_examples=60)
@given(_TRANSFERS, st.integers(0, 2**32 - 1))
def test_color_indices_equal_the_specification(transfer, seed):
    indices = np.random.default_rng(seed).integers(0, 256, (3, 4))
    _same_as_reference(indices, transfer, OPENGL_1_2_IMAGING, 2, indices=True)


@pytest.mark.parametrize("base_format", BaseFormat)
@pytest.mark.parametrize("border_mode", ConvolutionBorderMode)
def test_every_filter_of_every_size_equals_the_specification(base_format, border_mode):
    """Sizes from 1x1 to beyond the image, of which REDUCE leaves nothing."""
    image, random = _image(3, 2, 7), np.random.default_rng(1)
    for wide in range(1, 5):
        for high in range(1, 4):
            weights = random.uniform(-1, 1, (high, wide, 4))
            rows = tuple(tuple(map(tuple, row)) for row in weights.tolist())
            border = base_format, border_mode, (0.25, -1.0, 2.0, 0.5)
            full = PixelTransfer(convolution_2d=ConvolutionFilter(rows, *border))
            column = tuple(row[0] for row in rows)
            separable = PixelTransfer(separable_2d=SeparableFilter(rows[0], column, *border))
            for transfer in (full, separable):
                _same_as_reference(image, transfer, OPENGL_1_2_IMAGING, 2)


@pytest.mark.parametrize("size", [1, 2, 4, 256])
def test_every_byte_finds_the_table_entry_of_the_specification(size):
    """All bytes, and every float beside a boundary between two entries."""
    entries = tuple((k / size, 1 - k / size, k / (2 * size), 0.5) for k in range(size))
    edges = (np.arange(size) + 0.5) / max(size - 1, 1)
    values = np.concatenate([np.arange(256) / 255, edges, np.nextafter(edges, 0), np.nextafter(edges, 2)])
    image = np.repeat(values[None, :, None], 4, 2)
    for base_format in BaseFormat:
        transfer = PixelTransfer(color_table=ColorTable(entries, base_format, 8))
        _same_as_reference(image, transfer, OPENGL_1_2_IMAGING, 2)


@given(st.integers(-31, 31), st.integers(-300, 300), _index_maps(st.integers(-5, 300)), st.booleans())
def test_stencil_indices_equal_the_specification(shift, offset, table, mapped):
    transfer = PixelTransfer(
        index_shift=shift, index_offset=offset, map_stencil=mapped, maps=PixelMaps(s_to_s=table)
    )
    found = transfer_stencil(np.arange(256)[None], transfer)
    assert found[0].tolist() == [reference.stencil_index(value, transfer) for value in range(256)]


@given(_REAL, _REAL, st.lists(st.floats(0, 1), min_size=1))
def test_depths_equal_the_specification(scale, bias, depths):
    transfer = PixelTransfer(depth_scale=scale, depth_bias=bias)
    found = transfer_depths(np.array([depths]), transfer)
    assert found[0].tolist() == [reference.transfer_depth(value, transfer) for value in depths]


@pytest.mark.parametrize("pixel_type", READ_TYPES)
@pytest.mark.parametrize("pixel_format", IMAGE_FORMATS)
def test_packed_colors_equal_the_specification(pixel_format, pixel_type):
    if pixel_type in PACKED_TYPES and pixel_format not in packed_formats(pixel_type):
        return
    image = _image(16, 8, 3)
    found = packed_colors(image, pixel_format, pixel_type)
    assert found.dtype == (
        PACKED_TYPES[pixel_type].word if pixel_type in PACKED_TYPES else COMPONENT_TYPES[pixel_type]
    )
    expected = [
        [reference.component_read(group, pixel_format, pixel_type) for group in row] for row in image.tolist()
    ]
    assert found.reshape(np.shape(expected)).tolist() == expected


_INTEGERS = [np.uint8, np.uint16, np.uint32, np.int8, np.int16, np.int32]


def _as_fractions(words):
    ones = words.ones
    return [
        [[Fraction(c, one) for c, one in zip(group, ones, strict=True)] for group in row]
        for row in words.values.tolist()
    ]


@pytest.mark.parametrize("dtype", [*_INTEGERS, np.float32, np.float64])
@pytest.mark.parametrize("pixel_format", IMAGE_FORMATS)
def test_image_data_become_the_groups_of_the_specification(pixel_format, dtype):
    elements = len(IMAGE_FORMATS[pixel_format])
    random, kind = np.random.default_rng(2), np.dtype(dtype)
    if kind.kind == "f":
        values = random.uniform(-1, 2, (4, 5, elements)).astype(dtype)
        component = float
    else:
        limits = np.iinfo(dtype)
        values = random.integers(limits.min, limits.max, (4, 5, elements), dtype, endpoint=True)
        values[0, 0], values[0, 1] = limits.min, limits.max
        component = partial(reference.component, bits=8 * kind.itemsize, signed=kind.kind == "i")
    expected = [
        [reference.pixel_of([component(v) for v in group], pixel_format) for group in row]
        for row in values.tolist()
    ]
    for image in (values, values[..., 0]) if elements == 1 else (values,):
        found = image_groups(PixelImage(image, pixel_format))
        assert (found.tolist() if kind.kind == "f" else _as_fractions(found)) == expected


@pytest.mark.parametrize("packed", PACKED_TYPES)
def test_packed_words_become_the_groups_of_the_specification_and_are_read_back(packed):
    """All words, or as many of 32 bits: with every bit alone."""
    word = np.dtype(PACKED_TYPES[packed].word)
    if word.itemsize < 4:
        words = np.arange(1 << 8 * word.itemsize)
    else:
        random = np.random.default_rng(6).integers(0, 2**32, 5000)
        words = np.concatenate([random, 1 << np.arange(32), [0, 2**32 - 1]])
    words = words.astype(word)[None]
    for pixel_format in packed_formats(packed):
        found = image_groups(PixelImage(words, pixel_format, packed))
        expected = [
            [reference.pixel_of(reference.unpacked(value, packed), pixel_format) for value in row]
            for row in words.tolist()
        ]
        assert _as_fractions(found) == expected
    pixel_format = packed_formats(packed)[0]
    groups = transfer_colors(
        image_groups(PixelImage(words, pixel_format, packed)), INITIAL_TRANSFER, IDEAL, PixelStatistics()
    )
    assert (packed_colors(groups, pixel_format, packed) == words).all()


@pytest.mark.parametrize(("dtype", "pixel_type"), [(np.int8, "BYTE"), (np.int16, "SHORT"), (np.int32, "INT")])
def test_what_a_signed_type_holds_of_zero_to_one_is_read_back(dtype, pixel_type):
    values = np.unique(np.linspace(0, np.iinfo(dtype).max, 3000).astype(dtype))[None]
    groups = transfer_colors(
        image_groups(PixelImage(values, "RED")), INITIAL_TRANSFER, IDEAL, PixelStatistics()
    )
    assert (packed_colors(groups, "RED", pixel_type) == values).all()


# The base format and the bits of the formats of twelve bits. Source: OpenGL 1.2.1 table 3.16.
_TWELVE_BITS = {
    "ALPHA12": (BaseFormat.ALPHA, 12),
    "LUMINANCE12": (BaseFormat.LUMINANCE, 12),
    "LUMINANCE12_ALPHA4": (BaseFormat.LUMINANCE_ALPHA, 12, 4),
    "LUMINANCE12_ALPHA12": (BaseFormat.LUMINANCE_ALPHA, 12, 12),
    "INTENSITY12": (BaseFormat.INTENSITY, 12),
    "RGB12": (BaseFormat.RGB, 12, 12, 12),
    "RGBA12": (BaseFormat.RGBA, 12, 12, 12, 12),
}
_STORED = texel_formats.FORMATS | _TWELVE_BITS


def _texels(group, internal_format):
    """The real texel and the stored one that a group becomes."""
    base, *bits = _STORED[internal_format]
    width = 12 if internal_format in _TWELVE_BITS else 8
    kept = texel_formats.kept_components(group, base)
    words = [format(texel_formats.quantise_float(c, b), f"0{b}b") for c, b in zip(kept, bits, strict=True)]
    codes = [int((word * width)[:width], 2) for word in words]
    registers = texel_formats.register_components
    return registers(kept, base, 1), registers(codes, base, 2**width - 1)


@settings(max_examples=150)
@given(
    _TRANSFERS,
    st.sampled_from(sorted(IMAGE_FORMATS)),
    st.sampled_from(["float16", "float32", "float64"]),
    st.sampled_from(sorted(_STORED)),
    # A run, one more and one less, and several.
    st.sampled_from([(1, 1), (2, 3), (1, RUN), (1, RUN + 1), (RUN - 1, 1), (3, RUN)]),
    st.integers(1, 2),
    st.integers(0, 2**32 - 1),
)
def test_a_tex_image_has_the_texels_of_the_specification(
    transfer, pixel_format, dtype, internal_format, size, layers, seed
):
    transfer = replace(
        transfer, convolution_2d=None, separable_2d=None, histogram=None, minmax=None, convolution_1d=None
    )
    elements = len(IMAGE_FORMATS[pixel_format])
    random = np.random.default_rng(seed)
    values = random.uniform(-0.5, 1.5, (layers, *size, elements))
    values[random.random(values.shape) < 0.3] = random.choice([0.0, 0.5, 1.0])
    values = values.astype(dtype)
    command = TexImage(
        label="load",
        texture="t",
        target=TextureTarget.TEXTURE_3D if layers > 1 else TextureTarget.TEXTURE_2D,
        pixels=PixelImage(values if layers > 1 else values[0], pixel_format),
        internal_format=InternalFormat[internal_format],
        transfer=transfer,
    )
    clamps = OCTANE.arithmetic.clamps_color_matrix
    expected = []
    for layer in values.tolist():
        groups = [[reference.pixel_of(group, pixel_format) for group in row] for row in layer]
        groups = reference.transfer(groups, transfer, 2, clamps, None, None)
        expected.append([[_texels(group, internal_format) for group in row] for row in groups])
    texture = defined_texture(command, OCTANE, PixelStatistics(), None)
    assert not texture.levels[0].flags.writeable
    assert not texture.ideal[0].flags.writeable
    real, stored = ([[[t[k] for t in row] for row in layer] for layer in expected] for k in (0, 1))
    assert texture.ideal[0].tolist() == real
    assert texture.levels[0].tolist() == stored


def test_what_is_no_number_finds_an_entry():
    """No kernel reads beside a table, whatever the ideal's colours are."""
    table = ColorTable(tuple((e, e, e, e) for e in (0.25, 0.5, 0.75, 1.0)))
    groups = np.array([[np.nan, -np.inf, np.inf, 1e300]])
    assert looked_up(groups, table, IDEAL).tolist() == [[0.25, 0.25, 1.0, 1.0]]


def test_so_many_steps_are_kept_and_no_more():
    """More tables than are kept, each of which lives for one image: none is taken for another."""
    for k in range(300):
        table = ColorTable(((k / 300, 0.0, 0.0, 1.0),))
        assert looked_up(np.zeros((1, 4)), table, IDEAL).tolist() == [[k / 300, 0.0, 0.0, 1.0]]
    kept = transfer_steps._kept_steps.values()
    assert len(kept) <= transfer_steps._MOST_STEPS
    assert sum(len(steps.entries) for steps in kept) <= transfer_steps._MOST_ENTRIES


@settings(max_examples=60)
@given(_tables(), st.sampled_from([15, 255, 4095]))
def test_texture_color_tables_equal_the_specification(table, one):
    values = np.unique(np.linspace(-2, one + 2, 300).astype(np.int64))
    texels = np.stack([values, values[::-1], np.roll(values, 7), np.roll(values, 31)], -1)
    entries, components = table_entries(table, OCTANE), ENTRY_COMPONENTS[table.base_format]
    found = arithmetic.texture_color_table(texels, one, entries, components)
    assert found.tolist() == [reference.texture_color(texel, one, table) for texel in texels.tolist()]


def test_a_table_is_stored_as_each_machine_stores_it():
    """Entries are remembered by the table, and an exact machine stores the same table unrounded."""
    table = ColorTable(((0.3, 0.3, 0.3, 0.3),) * 4, bits=8)
    assert table_entries(table, OCTANE)[0, 0] == 77 / 255
    assert table_entries(table, IDEAL)[0, 0] == 0.3
    assert table_entries(table, OCTANE)[0, 0] == 77 / 255


@pytest.mark.parametrize("border_mode", ConvolutionBorderMode)
@pytest.mark.parametrize(("width", "height"), [(0, 3), (4, 0), (0, 0)])
def test_an_image_without_pixels_stays_without(width, height, border_mode):
    kernel = ConvolutionFilter((((1.0,) * 4,) * 3,) * 2, border_mode=border_mode)
    transfer = PixelTransfer(convolution_2d=kernel, histogram=Histogram("h", 4), minmax=Minmax("m"))
    _same_as_reference(np.zeros((height, width, 4)), transfer, OPENGL_1_2_IMAGING, 2)


def test_the_initial_state_changes_no_group():
    image = _image(9, 7, 5)
    assert (transfer_colors(image, INITIAL_TRANSFER, OPENGL_1_2_IMAGING, PixelStatistics()) == image).all()


def test_a_histogram_stops_at_its_largest_count():
    counts = np.full((2, 4), arithmetic.MOST - 3, np.uint32)
    after = arithmetic.counted(np.ones((2, 3, 4)), counts, (0, 1, 2, 3))
    assert after.dtype == np.uint32
    assert after.tolist() == [[arithmetic.MOST - 3] * 4, [arithmetic.MOST] * 4]


def test_a_histogram_of_another_width_or_format_begins_anew():
    statistics, image = PixelStatistics(), _image(4, 4, 1)
    for width, base_format in ((4, BaseFormat.RGB), (8, BaseFormat.RGB), (8, BaseFormat.LUMINANCE)):
        transfer = PixelTransfer(histogram=Histogram("h", width, base_format))
        transfer_colors(image, transfer, OPENGL_1_2_IMAGING, statistics)
        assert (statistics.histograms["h"].counts.sum(0) == 16).all()
    transfer_colors(image, transfer, OPENGL_1_2_IMAGING, statistics)
    assert (statistics.histograms["h"].counts.sum(0) == 32).all()
    statistics.reset_histogram("h")
    assert not statistics.histograms["h"].counts.any()


def test_a_histograms_sink_leaves_nothing_to_a_minmax():
    statistics = PixelStatistics()
    transfer = PixelTransfer(histogram=Histogram("h", sink=True), minmax=Minmax("m"))
    assert transfer_colors(_image(2, 2, 1), transfer, OPENGL_1_2_IMAGING, statistics) is None
    assert not statistics.minmaxes
    transfer = replace(transfer, histogram=None)
    transfer_colors(_image(2, 2, 1), transfer, OPENGL_1_2_IMAGING, statistics)
    assert np.isfinite(statistics.minmaxes["m"].extremes).all()
    statistics.reset_minmax("m")
    assert statistics.minmaxes["m"].extremes.tolist() == [[np.inf] * 4, [-np.inf] * 4]
