"""Textures read by vectors give the texels of the portable kernels and of the executable specification."""

from itertools import product

import numpy as np
import pytest

from fixedpipe.pipeline.enums import InternalFormat, TextureFilter, TextureTarget, WrapMode
from fixedpipe.pipeline.profiles import NV2A
from fixedpipe.pipeline.state import Sampler
from fixedpipe.pipeline.textures.images import Texture
from fixedpipe.raster import codes, rows
from fixedpipe.raster.portable import sample, shadow
from fixedpipe.raster.vector import coordinates as vc
from fixedpipe.raster.vector import sample as vt
from tests.reference import sample as reference
from tests.reference.render import plain_texture

SLACK = 32
COUNT = 300  # neither whole vectors nor whole pairs of them
PLANE = 8
REPEAT, CLAMP, CLAMP_TO_EDGE = 0, 1, 2
NEAREST, LINEAR = 0, 1
SIZES = [(1, 1), (2, 1), (1, 4), (16, 8), (64, 128), (512, 512)]


def random_texture(rng, width, height, count=1, faces=1):
    """(texels, levels) as the portable kernels take them."""
    levels = np.zeros((rows.MAX_LEVELS, 3), np.int32)
    offset = 0
    for k in range(count):
        levels[k] = offset, max(width >> k, 1), max(height >> k, 1)
        offset += faces * int(levels[k, 1]) * int(levels[k, 2])
    return rng.integers(0, 2**32, offset, dtype=np.uint32), levels


def unit_row(**entries):
    unit = np.zeros(rows.UNIT_SIZE, np.int64)
    values = {
        "ENABLED": 1,
        "TARGET": 1,
        "LEVELS": 1,
        "TEXEL_BITS": 8,
        "MIN_LOD": -(1 << 18),
        "MAX_LOD": 1 << 18,
    }
    for name, value in {**values, **entries}.items():
        unit[getattr(rows, name)] = value
    return unit


def scratch(count=COUNT):
    """(floats, ints, packed, registers) of a batch, filled with what must not matter."""
    width = count + SLACK
    return (
        np.full((rows.FLOAT_COLUMNS, width), 7.25),
        np.full((rows.INT_COLUMNS, width), 3, np.int32),
        np.full((rows.PACKED_COLUMNS, width), 0x12345678, np.uint32),
        np.full((4 * rows.REGISTERS, width), -77, np.int16),
    )


def fixed(texel_coordinates, repeat):
    """F of texel coordinates, in a column with slack."""
    scaled = np.floor(np.nan_to_num(texel_coordinates, nan=-1e30) * 256.0)
    if repeat:
        found = np.mod(scaled, 2.0**32).astype(np.uint32).astype(np.int32)
    else:
        found = np.clip(scaled, -(2.0**31), 2.0**31 - 1).astype(np.int32)
    return np.concatenate([found, np.zeros(SLACK, np.int32)])


def random_coordinates(rng, size, count=COUNT):
    """Multiples of 2**-20 around the texture, many of them on or beside texels' borders and centres."""
    anywhere = rng.integers(-3 << 20, 4 << 20, count) / 2.0**20
    ties = rng.integers(-3 * size * 512, 3 * size * 512, count) / (512.0 * size)
    return np.where(rng.random(count) < 0.5, anywhere, ties)


def portable(texels, levels, unit, s, t, count=COUNT, **columns):
    """The four planes that the portable kernels make; ``columns``: of ints, by name."""
    floats, ints, packed, registers = scratch(count)
    floats[rows.S, :count], floats[rows.T, :count] = s, t
    for name, column in columns.items():
        ints[getattr(rows, name)] = column
    sample.filter_unit(texels, levels, unit, count, floats, ints, packed)
    sample.unpack_unit(unit, count, packed, registers, PLANE, 8)
    return registers[PLANE : PLANE + 4, :count]


def filtered(pairs, levels, unit, f_s, f_t, count=COUNT):
    """The four planes of ``locate`` and ``filter_located``; nothing but those planes changes."""
    registers = scratch(count)[-1]
    located = np.zeros((vt.LOCATED, count + SLACK), np.int32)
    vt.locate(levels, unit, f_s, f_t, count, located)
    vt.filter_located(pairs, unit, located, count, registers, PLANE)
    others = np.delete(registers, range(PLANE, PLANE + 4), axis=0)
    assert (others == -77).all()
    return registers[PLANE : PLANE + 4, :count]


def test_row_pairs_hold_every_texel_its_upper_and_its_right_neighbour():
    rng = np.random.default_rng(1)
    texels, levels = random_texture(rng, 8, 4, count=4, faces=6)
    pairs, pair_levels = vt.row_pairs(texels, levels, 4, faces=6)
    assert (pair_levels[:, 1:] == levels[:, 1:]).all()
    end = 0
    for (offset, width, height), start in zip(levels[:4], pair_levels[:4, 0], strict=True):
        assert start == end
        end += 6 * 2 * (width + 1) * height
        faces = texels[offset : offset + 6 * width * height].reshape(6, height, width)
        found = pairs[start:end].reshape(6, height, width + 1, 2)
        assert (found[:, :, :width, 0] == faces).all()
        assert (found[:, :, :width, 1] == np.roll(faces, -1, axis=1)).all()
        assert (found[:, :, width] == found[:, :, 0]).all()
    assert end == pairs.size


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("linear", [NEAREST, LINEAR])
def test_one_level_is_filtered_as_the_portable_kernels_do(size, linear):
    rng = np.random.default_rng(2)
    texels, levels = random_texture(rng, *size)
    pairs, pair_levels = vt.row_pairs(texels, levels, 1)
    modes = [REPEAT, CLAMP_TO_EDGE] if linear else [REPEAT, CLAMP, CLAMP_TO_EDGE]
    for wrap_s, wrap_t, signed in product(modes, modes, (0, 0x80008080)):
        unit = unit_row(WRAP_S=wrap_s, WRAP_T=wrap_t, MAG_LINEAR=linear, MIN_LINEAR=linear, SIGNED=signed)
        s, t = random_coordinates(rng, size[0]), random_coordinates(rng, size[1])
        s[:3], t[:3] = (1e30, -1e30, np.nan), (-1e30, np.nan, 1e30)  # saturated if clamped
        s[:3] = 0.25 if wrap_s == REPEAT else s[:3]
        t[:3] = 0.25 if wrap_t == REPEAT else t[:3]
        found = filtered(
            pairs,
            pair_levels,
            unit,
            fixed(s * size[0], wrap_s == REPEAT),
            fixed(t * size[1], wrap_t == REPEAT),
        )
        assert (found == portable(texels, levels, unit, s, t)).all()


@pytest.mark.parametrize("linear", [NEAREST, LINEAR])
def test_a_1d_texture_has_one_row_whatever_t_is(linear):
    rng = np.random.default_rng(3)
    texels, levels = random_texture(rng, 32, 1)
    pairs, pair_levels = vt.row_pairs(texels, levels, 1)
    for wrap_t in (REPEAT, CLAMP_TO_EDGE):
        unit = unit_row(TARGET=0, WRAP_T=wrap_t, MAG_LINEAR=linear, MIN_LINEAR=linear)
        s = random_coordinates(rng, 32)
        f_t = rng.integers(-(2**31), 2**31, COUNT + SLACK).astype(np.int32)
        found = filtered(pairs, pair_levels, unit, fixed(s * 32, repeat=True), f_t)
        assert (found == portable(texels, levels, unit, s, np.zeros(COUNT))).all()


def model(texels, level, unit, f_s, f_t):
    """``filtered`` in plain integers, for any F."""
    offset, width, height = (int(v) for v in level)
    image = texels[offset : offset + width * height].reshape(height, width)
    half = 128 if unit[rows.MAG_LINEAR] else 0
    found = []
    for f, size, mode in ((f_s, width, unit[rows.WRAP_S]), (f_t, height, unit[rows.WRAP_T])):
        g = f.astype(np.int64)
        g = (g if mode == REPEAT else np.clip(g, half, 256 * size - 128)) - half
        found.append(((g >> 8) % size, ((g >> 8) + 1) % size, (g & 255) * (half != 0)))
    (x0, x1, a), (y0, y1, b) = found
    planes = []
    for c in range(4):
        component = ((image >> np.uint32(8 * c)) & np.uint32(255)).astype(np.int64)
        lower, upper = ((component[y, x0] * (256 - a) + component[y, x1] * a + 128) >> 8 for y in (y0, y1))
        planes.append((lower * (256 - b) + upper * b + 128) >> 8)
    return np.array(planes)


@pytest.mark.parametrize("linear", [NEAREST, LINEAR])
@pytest.mark.parametrize("size", [(1, 1), (4, 1), (64, 16), (512, 512)])
def test_any_coordinate_reads_texels_of_the_level(linear, size):
    rng = np.random.default_rng(4)
    texels, levels = random_texture(rng, *size)
    pairs, pair_levels = vt.row_pairs(texels, levels, 1)
    edges = [-(2**31), -(2**31) + 1, 2**31 - 1, 2**31 - 128, -1, 0, 127, 128, 129]
    for wrap in (REPEAT, CLAMP_TO_EDGE):
        unit = unit_row(WRAP_S=wrap, WRAP_T=wrap, MAG_LINEAR=linear, MIN_LINEAR=linear)
        f = rng.integers(-(2**31), 2**31, (2, COUNT + SLACK)).astype(np.int32)
        f[0, : len(edges)], f[1, len(edges) : 2 * len(edges)] = edges, edges
        found = filtered(pairs, pair_levels, unit, f[0].copy(), f[1].copy())
        assert (found == model(texels, levels[0], unit, *f)[:, :COUNT]).all()


def test_every_byte_pair_and_fraction_is_interpolated_as_by_lerp_packed():
    p, q = np.repeat(np.arange(256), 256), np.tile(np.arange(256), 256)
    texels = np.stack([p, q], axis=1).astype(np.uint32).reshape(-1) * np.uint32(0x01010101)
    levels = np.zeros((rows.MAX_LEVELS, 3), np.int32)
    levels[0] = 0, 2, 65536
    pairs, pair_levels = vt.row_pairs(texels, levels, 1)
    unit = unit_row(MAG_LINEAR=LINEAR, MIN_LINEAR=LINEAR)
    f_t = np.concatenate([256 * np.arange(65536) + 128, np.zeros(SLACK)]).astype(np.int32)
    for fraction in range(256):
        f_s = np.full(f_t.size, fraction + 128, np.int32)
        found = filtered(pairs, pair_levels, unit, f_s, f_t, count=65536)
        assert (found == (p * (256 - fraction) + q * fraction + 128) >> 8).all()


@pytest.mark.parametrize("filter_mode", [TextureFilter.NEAREST, TextureFilter.LINEAR])
@pytest.mark.parametrize("wrap", [WrapMode.REPEAT, WrapMode.CLAMP_TO_EDGE])
def test_one_level_is_filtered_as_the_specification_says(filter_mode, wrap):
    rng = np.random.default_rng(5)
    texels, levels = random_texture(rng, 16, 8)
    image = texels.view(np.uint8).reshape(1, 8, 16, 4)
    texture = plain_texture(Texture(TextureTarget.TEXTURE_2D, InternalFormat.RGBA8, (image,)))
    sampler = Sampler(min_filter=filter_mode, mag_filter=filter_mode, wrap_s=wrap, wrap_t=wrap)
    s, t = random_coordinates(rng, 16, 60), random_coordinates(rng, 8, 60)
    expected = [
        reference.sample_level(
            None, (s[i], t[i], 0.0, 1.0), texture, sampler, NV2A, 0, filter_mode, offset=True
        )
        for i in range(60)
    ]
    pairs, pair_levels = vt.row_pairs(texels, levels, 1)
    linear = int(filter_mode == TextureFilter.LINEAR)
    unit = unit_row(WRAP_S=int(wrap), WRAP_T=int(wrap), MAG_LINEAR=linear, MIN_LINEAR=linear)
    f_s, f_t = fixed(s * 16, wrap == WrapMode.REPEAT), fixed(t * 8, wrap == WrapMode.REPEAT)
    assert (np.array(expected) == filtered(pairs, pair_levels, unit, f_s, f_t, count=60).T).all()


@pytest.mark.parametrize("size", [(1, 1), (16, 4), (2, 64), (256, 256)])
@pytest.mark.parametrize("mipmap", [0, 1, 2])
def test_levels_are_chosen_and_blended_as_the_portable_kernels_do(size, mipmap):
    rng = np.random.default_rng(6)
    count = max(size).bit_length()
    texels, levels = random_texture(rng, *size, count)
    pairs, pair_levels = vt.row_pairs(texels, levels, count)
    modes = (REPEAT, CLAMP_TO_EDGE)
    for wrap_s, wrap_t, mag, minify, threshold in product(modes, modes, (0, 1), (0, 1), (0, 128)):
        for used in {1, count}:
            unit = unit_row(
                WRAP_S=wrap_s,
                WRAP_T=wrap_t,
                MAG_LINEAR=mag,
                MIN_LINEAR=minify,
                MIPMAP=mipmap,
                THRESHOLD=threshold,
                LEVELS=used,
            )
            s, t = random_coordinates(rng, size[0]), random_coordinates(rng, size[1])
            lod = rng.integers(-300, 256 * count + 600, COUNT + SLACK).astype(np.int32)
            near = rng.integers(-2, 3, COUNT + SLACK) + rng.choice([0, 127, 128, 256, 384], COUNT + SLACK)
            lod = np.where(rng.random(lod.size) < 0.3, near, lod).astype(np.int32)
            lod[:2] = -(1 << 20), 1 << 20
            lod = lod if rng.random() < 0.8 else np.full_like(lod, -5)
            f_s, f_t = fixed(s * size[0], wrap_s == REPEAT), fixed(t * size[1], wrap_t == REPEAT)
            registers = scratch()[-1]
            located = np.zeros((vt.LOCATED, COUNT + SLACK), np.int32)
            of = f_s, f_t, lod
            vt.filter_mipmapped(pairs, pair_levels, unit, of, COUNT, located, registers, PLANE)
            found = registers[PLANE : PLANE + 4, :COUNT]
            assert (found == portable(texels, levels, unit, s, t, LOD=lod)).all()


def test_any_coordinate_and_any_lambda_read_texels_of_the_texture():
    rng = np.random.default_rng(7)
    texels, levels = random_texture(rng, 64, 16, count=7)
    pairs, pair_levels = vt.row_pairs(texels, levels, 7)
    pairs_before, guard = pairs.copy(), np.full(COUNT + SLACK, 2**31 - 1, np.int32)
    for mipmap, wrap in product((0, 1, 2), (REPEAT, CLAMP_TO_EDGE)):
        unit = unit_row(WRAP_S=wrap, WRAP_T=wrap, MAG_LINEAR=0, MIN_LINEAR=1, MIPMAP=mipmap, LEVELS=7)
        for f in (guard, -guard - 1, rng.integers(-(2**31), 2**31, guard.size).astype(np.int32)):
            for lod in (guard, -guard - 1, rng.integers(-(2**31), 2**31, guard.size).astype(np.int32)):
                located = np.full((vt.LOCATED, COUNT + SLACK), -1, np.int32)
                of = f, f, lod
                vt.filter_mipmapped(pairs, pair_levels, unit, of, COUNT, located, scratch()[-1], PLANE)
                for row in (vt.FIRST, vt.UPPER_FIRST):
                    first = located[row, :COUNT]
                    assert (first[first != -1] >= 0).all() and (first <= pairs.size - 4).all()
    assert (pairs == pairs_before).all()


STRANGE = [np.nan, np.inf, -np.inf, 1e300, -1e300, 1e-320, -1e-320, 0.0, -0.0, -1e-17, 2.0**40 + 0.5]


def random_floats(rng, size, count=COUNT):
    """Coordinates of all kinds: anywhere, beside texels' borders and centres less TAU, and strange ones."""
    anywhere = rng.uniform(-4, 5, count)
    ties = (rng.integers(-3 * size * 512, 3 * size * 512, count) / 512.0 - sample.TAU) / size
    found = np.where(rng.random(count) < 0.5, anywhere, np.nextafter(ties, rng.choice([-9, 0, 9], count)))
    found = np.where(rng.random(count) < 0.1, rng.choice(STRANGE, count), found)
    return np.concatenate([found, np.zeros(SLACK)])


def located_floats(pair_levels, unit, s, t, scale):
    """Where ``fixed_from_floats`` and ``locate`` find the fragments of computed coordinates."""
    bias = sample.TAU if unit[rows.TARGET] == 2 else 0.0
    fixed = np.zeros((2, s.size), np.int32)
    for k, column, wrap in ((0, s, rows.WRAP_S), (1, t, rows.WRAP_T)):
        mode = CLAMP_TO_EDGE if unit[rows.TARGET] == 2 else unit[wrap]
        size = float(pair_levels[0, 1 + k])
        vc.fixed_from_floats(column, fixed[k], size, bias, scale, mode, unit[rows.MAG_LINEAR], COUNT)
    located = np.zeros((vt.LOCATED, s.size), np.int32)
    vt.locate(pair_levels, unit, fixed[0], fixed[1], COUNT, located)
    return located


@pytest.mark.parametrize("size", [(1, 1), (4, 1), (16, 64), (512, 512), (5, 3), (640, 479)])
@pytest.mark.parametrize("linear", [NEAREST, LINEAR])
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_computed_coordinates_read_what_the_portable_kernels_read(size, linear):
    rng = np.random.default_rng(8)
    texels, levels = random_texture(rng, *size)
    pairs, pair_levels = vt.row_pairs(texels, levels, 1)
    modes = [REPEAT, CLAMP_TO_EDGE] if linear else [REPEAT, CLAMP, CLAMP_TO_EDGE]
    for wrap_s, wrap_t, target in product(modes, modes, (1, 4)):
        unit = unit_row(
            TARGET=target, PROJECTIVE=1, WRAP_S=wrap_s, WRAP_T=wrap_t, MAG_LINEAR=linear, MIN_LINEAR=linear
        )
        scales = np.array(size) if target == 4 else np.ones(2)
        s, t = (random_floats(rng, n) * scale for n, scale in zip(size, scales, strict=True))
        located = located_floats(pair_levels, unit, s, t, 0.0 if target == 4 else 1.0)
        registers = scratch()[-1]
        vt.filter_located(pairs, unit, located, COUNT, registers, PLANE)
        expected = portable(texels, levels, unit, s[:COUNT], t[:COUNT])
        assert (registers[PLANE : PLANE + 4, :COUNT] == expected).all()


def random_directions(rng):
    """Three columns, many of them with ties, zeros and what is not a number."""
    columns = rng.uniform(-1, 1, (3, COUNT + SLACK))
    columns = np.where(
        rng.random(columns.shape) < 0.3, rng.choice([-1.0, 0.0, -0.0, 1.0], columns.shape), columns
    )
    return np.where(rng.random(columns.shape) < 0.05, rng.choice(STRANGE, columns.shape), columns)


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_directions_have_the_bits_of_the_portable_kernels():
    rng = np.random.default_rng(9)
    for _ in range(8):
        s, t, r = random_directions(rng)
        floats, ints, _, _ = scratch()
        floats[rows.S], floats[rows.T], floats[rows.EXTRA] = s, t, r
        sample.cube_faces(floats, COUNT, ints)
        face = np.zeros(COUNT + SLACK, np.int32)
        vc.cube_faces(s, t, r, face, COUNT)
        assert (face == ints[rows.FACE])[:COUNT].all()
        assert np.array_equal(s[:COUNT], floats[rows.S, :COUNT], equal_nan=True)
        assert np.array_equal(t[:COUNT], floats[rows.T, :COUNT], equal_nan=True)
        assert set(face[:COUNT]) == set(range(6))


@pytest.mark.parametrize("linear", [NEAREST, LINEAR])
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_cube_maps_are_filtered_within_the_face_that_the_direction_meets(linear):
    rng = np.random.default_rng(10)
    for n in (1, 16, 12):
        texels, levels = random_texture(rng, n, n, faces=6)
        pairs, pair_levels = vt.row_pairs(texels, levels, 1, faces=6)
        unit = unit_row(TARGET=2, WRAP_S=REPEAT, WRAP_T=REPEAT, MAG_LINEAR=linear, MIN_LINEAR=linear)
        s, t, r = random_directions(rng)
        face = np.zeros(COUNT + SLACK, np.int32)
        vc.cube_faces(s, t, r, face, COUNT)
        located = located_floats(pair_levels, unit, s, t, 0.5)
        vt.move_to_faces(pair_levels, face, COUNT, located)
        registers = scratch()[-1]
        vt.filter_located(pairs, unit, located, COUNT, registers, PLANE)
        expected = portable(texels, levels, unit, s[:COUNT], t[:COUNT], FACE=face)
        assert (registers[PLANE : PLANE + 4, :COUNT] == expected).all()


def test_a_face_that_a_cube_map_has_not_is_limited():
    rng = np.random.default_rng(11)
    texels, levels = random_texture(rng, 4, 4, faces=6)
    pairs, pair_levels = vt.row_pairs(texels, levels, 1, faces=6)
    for face in (-(2**31), -1, 6, 2**31 - 1):
        located = np.zeros((vt.LOCATED, COUNT + SLACK), np.int32)
        column = np.full(COUNT + SLACK, face, np.int32)
        vt.move_to_faces(pair_levels, column, COUNT, located)
        assert (located[vt.FIRST, :COUNT] == (0 if face < 0 else 5) * pairs.size // 6).all()


@pytest.mark.parametrize(
    ("number_format", "largest"),
    [
        (codes.DEPTH_FIXED, 2**16 - 1),
        (codes.DEPTH_FIXED, 2**24 - 1),
        (codes.DEPTH_FLOAT_16, 2**16 - 1),
        (codes.DEPTH_FLOAT_24, 2**24 - 1),
    ],
)
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_depth_words_are_those_of_the_portable_kernel(number_format, largest):
    rng = np.random.default_rng(12)
    values = rng.uniform(-0.2, 1.3, COUNT + SLACK)
    values = np.where(rng.random(values.size) < 0.3, np.exp2(rng.uniform(-140, 140, values.size)), values)
    values = np.where(rng.random(values.size) < 0.2, rng.choice(STRANGE, values.size), values)
    for scale in (1.0, float(largest), 2.0**20):
        floats, ints, _, _ = scratch()
        floats[rows.P] = values
        shadow.shadow_reference(floats, rows.P, 0, COUNT, scale, number_format, largest, ints)
        words = np.zeros(COUNT + SLACK, np.int32)
        vc.depth_words(values, words, scale, number_format, largest, COUNT)
        assert (words[:COUNT] == ints[rows.REFERENCE, :COUNT]).all()


@pytest.mark.parametrize("linear", [NEAREST, LINEAR])
@pytest.mark.parametrize("function", range(8))
def test_texels_are_compared_before_they_are_filtered(linear, function):
    rng = np.random.default_rng(13)
    texels, levels = random_texture(rng, 16, 8)
    texels = texels & np.uint32(3)  # often equal
    pairs, pair_levels = vt.row_pairs(texels, levels, 1)
    unit = unit_row(
        MAG_LINEAR=linear, MIN_LINEAR=linear, COMPARE=1, COMPARE_FUNCTION=function, COMPARE_HELD=0xFFFFFFFF
    )
    s, t = random_coordinates(rng, 16), random_coordinates(rng, 8)
    words = rng.integers(-1, 5, COUNT + SLACK).astype(np.int32)
    located = np.zeros((vt.LOCATED, COUNT + SLACK), np.int32)
    vt.locate(pair_levels, unit, fixed(s * 16, repeat=True), fixed(t * 8, repeat=True), COUNT, located)
    registers = scratch()[-1]
    vt.fetch_compared(pairs, located, words, function, COUNT, registers, PLANE)
    found = registers[PLANE : PLANE + 4, :COUNT]
    assert (found == portable(texels, levels, unit, s, t, REFERENCE=words)).all()
