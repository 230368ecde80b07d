"""Images in client memory, read as OpenGL 1.2.1 section 3.6.4 says: beside a plain reader, byte by byte."""

import struct
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fixedpipe.pipeline.framebuffers.transfer import image_groups, transfer_image
from fixedpipe.pipeline.opengl import tokens as GL
from fixedpipe.pipeline.opengl.outcomes import GLError, Refused
from fixedpipe.pipeline.opengl.pixels import Store, check_format, read_bits, read_image
from fixedpipe.pipeline.pixel_transfer import INITIAL_TRANSFER, PixelImage
from tests.pipeline.opengl.drawn import context, counted, refusals

# A format's elements, by their letters. L is luminance, I an index, D a depth.
_FORMATS = {
    GL.RGBA: "RGBA",
    GL.RGB: "RGB",
    GL.BGRA: "BGRA",
    GL.BGR: "BGR",
    GL.ABGR_EXT: "ABGR",
    GL.RED: "R",
    GL.GREEN: "G",
    GL.BLUE: "B",
    GL.ALPHA: "A",
    GL.LUMINANCE: "L",
    GL.LUMINANCE_ALPHA: "LA",
    GL.COLOR_INDEX: "I",
    GL.STENCIL_INDEX: "I",
    GL.DEPTH_COMPONENT: "D",
}
_TYPES = {
    GL.UNSIGNED_BYTE: "B",
    GL.BYTE: "b",
    GL.UNSIGNED_SHORT: "H",
    GL.SHORT: "h",
    GL.UNSIGNED_INT: "I",
    GL.INT: "i",
    GL.FLOAT: "f",
    GL.HALF_FLOAT_ARB: "e",
}
# Packed types: the word, and the bits of the components from the first on; whether the first is the lowest.
_PACKED = {
    GL.UNSIGNED_BYTE_3_3_2: ("B", (3, 3, 2), False),
    GL.UNSIGNED_BYTE_2_3_3_REV: ("B", (3, 3, 2), True),
    GL.UNSIGNED_SHORT_5_6_5: ("H", (5, 6, 5), False),
    GL.UNSIGNED_SHORT_5_6_5_REV: ("H", (5, 6, 5), True),
    GL.UNSIGNED_SHORT_4_4_4_4: ("H", (4, 4, 4, 4), False),
    GL.UNSIGNED_SHORT_4_4_4_4_REV: ("H", (4, 4, 4, 4), True),
    GL.UNSIGNED_SHORT_5_5_5_1: ("H", (5, 5, 5, 1), False),
    GL.UNSIGNED_SHORT_1_5_5_5_REV: ("H", (5, 5, 5, 1), True),
    GL.UNSIGNED_INT_8_8_8_8: ("I", (8, 8, 8, 8), False),
    GL.UNSIGNED_INT_8_8_8_8_REV: ("I", (8, 8, 8, 8), True),
    GL.UNSIGNED_INT_10_10_10_2: ("I", (10, 10, 10, 2), False),
    GL.UNSIGNED_INT_2_10_10_10_REV: ("I", (10, 10, 10, 2), True),
}
_PAIRS = [(f, t) for f in _FORMATS for t in _TYPES]
_PAIRS += [
    (f, t) for f in (GL.RGBA, GL.BGRA, GL.RGB) for t, p in _PACKED.items() if len(p[1]) == len(_FORMATS[f])
]
_PAIRS += [(GL.ABGR_EXT, t) for t in (GL.UNSIGNED_INT_8_8_8_8, GL.UNSIGNED_INT_8_8_8_8_REV)]

_STORES = st.builds(
    Store,
    alignment=st.sampled_from((1, 2, 4, 8)),
    row_length=st.sampled_from((0, 0, 5, 7)),
    image_height=st.sampled_from((0, 0, 4, 5)),
    skip_images=st.integers(0, 2),
    skip_rows=st.integers(0, 2),
    skip_pixels=st.integers(0, 3),
    swap_bytes=st.booleans(),
    lsb_first=st.booleans(),
)


def _places(store, size, group, element, layered):
    """The byte at which each group begins, [layer][row][column], by the formulas of section 3.6.4."""
    width, height, depth = size
    length = (store.row_length or width) * group
    row = length if element >= store.alignment else -(-length // store.alignment) * store.alignment
    image = row * ((store.image_height or height) if layered else height)
    first = store.skip_images * image if layered else 0
    return [
        [
            [
                first + z * image + (y + store.skip_rows) * row + (x + store.skip_pixels) * group
                for x in range(width)
            ]
            for y in range(height)
        ]
        for z in range(depth)
    ]


def _component(value, code):
    """Table 2.6, exactly."""
    if code in "fe":
        return Fraction(value)
    bits = 8 * struct.calcsize(code)
    if code.isupper():
        return Fraction(value, 2**bits - 1)
    return Fraction(2 * value + 1, 2**bits - 1)


def _group(memory, at, image_format, image_type, store):
    """The elements of a group, exactly: fractions, and indices as whole numbers."""
    order = ">" if store.swap_bytes else "<"
    letters = _FORMATS[image_format]
    if image_type in _PACKED:
        code, widths, lowest_first = _PACKED[image_type]
        (word,) = struct.unpack_from(order + code, memory, at)
        low, elements = 0 if lowest_first else 8 * struct.calcsize(code), []
        for bits in widths:
            low -= 0 if lowest_first else bits
            elements.append(Fraction(word >> low & (1 << bits) - 1, (1 << bits) - 1))
            low += bits if lowest_first else 0
        return dict(zip(letters, elements, strict=True))
    code = _TYPES[image_type]
    values = struct.unpack_from(f"{order}{len(letters)}{code}", memory, at)
    if letters == "I":
        return {"I": int(values[0])}
    return dict(zip(letters, [_component(v, code) for v in values], strict=True))


def _rgba(elements):
    light = elements.get("L", Fraction(0))
    return [*[elements.get(c, light) for c in "RGB"], elements.get("A", Fraction(1))]


def _random_memory(seed, length, code, swapped):
    """Bytes; floats are numbers of a sensible size."""
    random = np.random.default_rng(seed)
    if code not in "fe":
        return random.integers(0, 256, length, np.uint8).tobytes()
    values = random.normal(0, 2, -(-length // struct.calcsize(code))).astype(
        "<" + {"f": "f4", "e": "f2"}[code]
    )
    return (values.byteswap() if swapped else values).tobytes()[:length]


@given(
    st.sampled_from(_PAIRS),
    _STORES,
    st.tuples(st.integers(1, 4), st.integers(1, 3), st.integers(1, 3)),
    st.booleans(),
    st.integers(0, 2**32 - 1),
)
@settings(max_examples=300)
def test_an_image_is_what_a_plain_reader_finds(pair, store, size, layered, seed):
    image_format, image_type = pair
    size = size if layered else (*size[:2], 1)
    code = _PACKED[image_type][0] if image_type in _PACKED else _TYPES[image_type]
    element = struct.calcsize(code)
    group = element if image_type in _PACKED else element * len(_FORMATS[image_format])
    places = _places(store, size, group, element, layered)
    memory = _random_memory(seed, places[-1][-1][-1] + group, code, store.swap_bytes)
    expected = [[[_group(memory, at, *pair, store) for at in row] for row in layer] for layer in places]

    gl = context()
    gl.values.set("unpack", store)
    found = read_image(gl, size, image_format, image_type, memory, whole_images=layered)
    letters, pixels = _FORMATS[image_format], found.pixel_image(layers=True)
    for values, layer in zip(pixels.values, expected, strict=True):
        image = PixelImage(values, pixels.format, pixels.packed)
        if letters == "I":
            assert image_groups(image).tolist() == [[g["I"] for g in row] for row in layer]
        elif letters == "D":
            depths = [[float(g["D"]) for g in row] for row in layer]
            np.testing.assert_allclose(image_groups(image), depths, rtol=1e-15)
        else:
            groups = [[list(map(float, _rgba(g))) for g in row] for row in layer]
            ours = transfer_image(image, INITIAL_TRANSFER, gl.profile, None)
            np.testing.assert_allclose(ours, groups, rtol=1e-15)
    assert not found.values.flags.writeable
    with pytest.raises(Refused, match="bytes of memory are known"):
        read_image(gl, size, image_format, image_type, memory[:-1], whole_images=layered)


@given(_STORES, st.integers(1, 20), st.integers(1, 4), st.integers(0, 2**32 - 1))
def test_a_bitmap_is_what_a_plain_reader_finds(store, width, height, seed):
    row = -(-(store.row_length or width) // (8 * store.alignment)) * store.alignment
    last = (store.skip_rows + height - 1) * row + (store.skip_pixels + width - 1) // 8
    memory = np.random.default_rng(seed).integers(0, 256, last + 1, np.uint8).tobytes()
    expected = []
    for y in range(height):
        bits = []
        for x in range(store.skip_pixels, store.skip_pixels + width):
            byte = memory[(store.skip_rows + y) * row + x // 8]
            bits.append(bool(byte >> (x % 8 if store.lsb_first else 7 - x % 8) & 1))
        expected.append(bits)
    gl = context()
    gl.values.set("unpack", store)
    assert read_bits(gl, width, height, memory).tolist() == expected
    indices = read_image(gl, (width, height, 1), GL.COLOR_INDEX, GL.BITMAP, memory)
    assert image_groups(indices.pixel_image()).tolist() == np.array(expected, int).tolist()
    with pytest.raises(Refused):
        read_bits(gl, width, height, memory[:-1])


def test_depths_beside_stencil_values_are_depths():
    gl = context()
    memory = struct.pack("<2I", 0xFFFFFF12, 0x80000034)
    found = read_image(gl, (2, 1, 1), GL.DEPTH_STENCIL_EXT, GL.UNSIGNED_INT_24_8_EXT, memory)
    assert image_groups(found.pixel_image()).tolist() == [[1.0, 0x800000 / 0xFFFFFF]]


@pytest.mark.parametrize(
    ("image_format", "image_type", "kind"),
    [
        (GL.RGBA, GL.DOUBLE, GL.INVALID_ENUM),
        (GL.RGBA, 77, GL.INVALID_ENUM),
        (77, GL.UNSIGNED_BYTE, GL.INVALID_ENUM),
        (GL.RGBA, GL.BITMAP, GL.INVALID_ENUM),
        (GL.RGBA, GL.UNSIGNED_SHORT_5_6_5, GL.INVALID_OPERATION),
        (GL.RGB, GL.UNSIGNED_SHORT_4_4_4_4, GL.INVALID_OPERATION),
        (GL.ABGR_EXT, GL.UNSIGNED_SHORT_4_4_4_4, GL.INVALID_OPERATION),
        (GL.LUMINANCE, GL.UNSIGNED_INT_8_8_8_8, GL.INVALID_OPERATION),
        (GL.RGBA, GL.UNSIGNED_INT_24_8_EXT, GL.INVALID_OPERATION),
    ],
)
def test_formats_and_types_that_do_not_go_together(image_format, image_type, kind):
    with pytest.raises(GLError) as error:
        check_format(image_format, image_type)
    assert error.value.kind == kind


@pytest.mark.parametrize(
    ("name", "value", "kind"),
    [
        (GL.UNPACK_ALIGNMENT, 3, GL.INVALID_VALUE),
        (GL.UNPACK_ROW_LENGTH, -1, GL.INVALID_VALUE),
        (GL.ALPHA_SCALE, 1, GL.INVALID_ENUM),
    ],
)
def test_pixel_store_refuses_what_opengl_refuses(name, value, kind):
    gl = context()
    before = gl.values["unpack"]
    gl.PixelStorei(name, value)
    assert gl.error == kind
    assert gl.values["unpack"] == before


def test_pixel_store_takes_the_nearest_integer_of_a_float():
    gl = context()
    gl.PixelStoref(GL.UNPACK_ALIGNMENT, 1.75)
    gl.PixelStoref(GL.UNPACK_ROW_LENGTH, 4.25)
    assert gl.values["unpack"] == Store(alignment=2, row_length=4)


def test_pixel_store_keeps_both_sides():
    gl = context()
    for name, value in ((GL.UNPACK_ROW_LENGTH, 5), (GL.PACK_ALIGNMENT, 8), (GL.UNPACK_LSB_FIRST, 3)):
        gl.PixelStorei(name, value)
    assert gl.values["unpack"] == Store(row_length=5, lsb_first=True)
    assert gl.values["pack"] == Store(alignment=8)
    assert not refusals(gl)


def _texels(gl, number=1):
    """Texels of level 0 of a texture object."""
    texture = gl.shared.textures[number]
    texture.settle()
    return texture.images[0, 0].texels.texels[0]


def _define(gl, image, width=2, height=2):
    gl.BindTexture(GL.TEXTURE_2D, 1)
    gl.TexImage2D(GL.TEXTURE_2D, 0, GL.RGBA, width, height, 0, GL.RGBA, GL.UNSIGNED_BYTE, image)


_IMAGE = np.arange(16, dtype=np.uint8).reshape(2, 2, 4)


@pytest.mark.parametrize(
    "image",
    [_IMAGE, _IMAGE.tobytes(), bytearray(_IMAGE), memoryview(_IMAGE.tobytes()), _IMAGE.ravel().tolist()],
    ids=["array", "bytes", "bytearray", "memoryview", "list"],
)
def test_client_memory_may_be_anything_with_bytes(image):
    gl = context()
    _define(gl, image)
    assert not refusals(gl)
    np.testing.assert_array_equal(_texels(gl), _IMAGE)


def test_an_image_of_which_only_the_address_is_known_is_refused_and_the_texture_defined():
    gl = context()
    _define(gl, 0x7FFF1234)
    assert counted(gl, "refused") == [("glTexImage2D: its image is not known, only where it lay", 1)]
    assert _texels(gl).shape == (2, 2, 4)
    _define(gl, None)
    assert gl.tally.count("refused") == 1  # a null pointer is none


def test_images_come_from_a_pixel_buffer_object():
    gl = context()
    gl.BindBuffer(GL.PIXEL_UNPACK_BUFFER_ARB, 3)
    gl.BufferData(GL.PIXEL_UNPACK_BUFFER_ARB, 20, b"....".ljust(4) + _IMAGE.tobytes(), GL.STATIC_DRAW)
    _define(gl, 4)
    assert not refusals(gl)
    np.testing.assert_array_equal(_texels(gl), _IMAGE)
    gl.BufferSubData(GL.PIXEL_UNPACK_BUFFER_ARB, 0, 20, bytes(20))  # OpenGL has copied the image
    np.testing.assert_array_equal(_texels(gl), _IMAGE)
    _define(gl, 5)
    assert gl.tally.count("refused") == 1  # the buffer is one byte short
    _define(gl, 21)
    assert gl.error == GL.INVALID_OPERATION


def test_a_list_holds_the_image_and_the_pixel_store_of_its_compilation():
    gl = context()
    image = np.zeros((2, 4, 4), np.uint8)
    image[:, 1:3] = _IMAGE
    gl.PixelStorei(GL.UNPACK_ROW_LENGTH, 4)
    gl.PixelStorei(GL.UNPACK_SKIP_PIXELS, 1)
    gl.NewList(1, GL.COMPILE)
    _define(gl, image)
    gl.EndList()
    assert 1 not in gl.shared.textures
    image[:] = 99
    gl.PixelStorei(GL.UNPACK_ROW_LENGTH, 0)
    gl.PixelStorei(GL.UNPACK_SKIP_PIXELS, 0)
    gl.CallList(1)
    assert not refusals(gl)
    np.testing.assert_array_equal(_texels(gl), _IMAGE)


def test_an_error_of_a_compiled_call_comes_when_the_list_is_called():
    gl = context()
    gl.NewList(1, GL.COMPILE)
    _define(gl, b"short")
    gl.EndList()
    assert not refusals(gl)
    gl.CallList(1)
    assert counted(gl, "refused") == [
        ("glTexImage2D: 5 bytes of memory are known, and its image takes 16", 1)
    ]


@pytest.mark.parametrize("edge", [-1, 0, 2**20, 2**31])
def test_sizes_without_images_read_nothing(edge):
    gl = context()
    _define(gl, _IMAGE, edge, 2**31 - 1)
    assert gl.tally.count("refused") == 0
    assert not gl.shared.textures[1].images
