"""The executable specification on cases worked out by hand from docs/numbers.md."""

import itertools
import math
from dataclasses import replace
from itertools import pairwise
from types import SimpleNamespace

import pytest

from fixedpipe.pipeline.enums import (
    BlendEquation,
    BlendFactor,
    CombinerBias,
    CombinerScale,
    ComparisonFunction,
    ComponentUsage,
    DepthFormat,
    Face,
    FogMode,
    FrontFace,
    InternalFormat,
    LogicOperation,
    MagnificationThreshold,
    Mapping,
    ProductRounding,
    Register,
    ShadeModel,
    StencilOperation,
    TextureFilter,
    TextureTarget,
    WrapMode,
)
from fixedpipe.pipeline.pixel_transfer import INITIAL_TRANSFER
from fixedpipe.pipeline.profiles import GEFORCE_256
from fixedpipe.pipeline.state import (
    AlphaPortion,
    AlphaTest,
    Blending,
    ColorMask,
    CombinerInput,
    DepthClamp,
    DepthTest,
    FinalCombiner,
    Fog,
    FogRegisters,
    GeneralCombiner,
    PassState,
    PolygonState,
    RegisterCombiners,
    RGBPortion,
    Sampler,
    Scissor,
    StencilTest,
    TextureUnit,
)
from tests.reference import (
    combine,
    coverage,
    depth,
    fixed,
    fog,
    interpolate,
    per_fragment,
    render,
    sample,
    texel_formats,
    transfer,
)


def below(x):
    return math.nextafter(x, -math.inf)


# ------------------------------------------------------------------------------------------------------ fixed


def test_division_by_255_is_to_nearest_on_both_sides_of_zero():
    assert [fixed.divide(n) for n in (0, 127, 128, 382, 383, 65025)] == [0, 0, 1, 1, 2, 255]
    assert [fixed.divide(n) for n in (-127, -128, -65536, 65536)] == [0, -1, -257, 257]


def test_color_components_are_clamped_and_rounded_to_bytes():
    assert [fixed.color_code(c) for c in (-1.0, 0.0, 0.5, 0.7, 1.0, 3.0)] == [0, 0, 128, 179, 255, 255]


def test_a_lerp_of_two_bytes_rounds_to_nearest():
    assert [fixed.lerp(0, 255, f) for f in (0, 1, 128, 255)] == [0, 1, 128, 254]
    assert fixed.lerp(255, 255, 77) == 255


def test_mantissas_are_cut_never_rounded():
    assert fixed.keep_significant_bits(1.0 + 2.0**-23 + 2.0**-24, 24) == 1.0 + 2.0**-23
    assert fixed.keep_significant_bits(-(1.0 + 2.0**-24), 24) == -1.0
    assert fixed.keep_significant_bits(0.0, 24) == 0.0
    assert fixed.keep_significant_bits(0.25, 24) == 0.25
    assert fixed.keep_significant_bits(1.0 / 3.0, 24) == math.floor(2**25 / 3.0) / 2**25


# --------------------------------------------------------------------------------------------------- coverage


def drawn(triangle, size=8):
    return set(coverage.fragments(triangle, range(size), range(size)))


def test_pixels_on_a_shared_diagonal_belong_to_the_triangle_on_its_right():
    upper = coverage.make_triangle((0, 0), (64, 0), (0, 64))
    lower = coverage.make_triangle((64, 0), (64, 64), (0, 64))
    assert drawn(upper) == {(x, y) for x in range(4) for y in range(4) if x + y < 3}
    assert drawn(lower) == {(x, y) for x in range(4) for y in range(4) if x + y >= 3}


def test_samples_on_top_and_left_edges_are_inside_in_both_windings():
    square = [(8, 8), (40, 8), (40, 40), (8, 40)]
    for a, b, c, d in (square, square[::-1]):
        pixels = [*coverage.fragments(coverage.make_triangle(a, b, c), range(8), range(8))]
        pixels += coverage.fragments(coverage.make_triangle(a, c, d), range(8), range(8))
        assert sorted(pixels) == [(0, 0), (0, 1), (1, 0), (1, 1)]


def test_no_pixel_lies_outside_what_a_triangle_spans():
    corners = [(x, y) for x in (-24, 7, 8, 9, 40) for y in (-9, 8, 24, 63)]
    window = {(x, y) for x in range(4) for y in range(4)}
    for a, b, c in itertools.combinations(corners, 3):
        triangle = coverage.make_triangle(a, b, c)
        columns, rows = coverage.spanned(triangle, range(4), range(4))
        outside = window - set(itertools.product(columns, rows))
        assert not any(coverage.covers(triangle, *pixel) for pixel in outside)


def test_a_triangle_without_area_draws_nothing():
    assert drawn(coverage.make_triangle((0, 0), (64, 64), (128, 128))) == set()


def test_edge_values_sum_to_the_area():
    triangle = coverage.make_triangle((3, 7), (100, 20), (40, 119))
    assert triangle.area == 97 * 112 - 37 * 13
    assert sum(coverage.edge_values(triangle, 50, -9)) == triangle.area
    mirrored = coverage.make_triangle((3, 7), (40, 119), (100, 20))
    assert mirrored.area == -triangle.area
    n0, n1, n2 = coverage.edge_values(triangle, 2, 3)
    assert coverage.edge_values(mirrored, 2, 3) == (n0, n2, n1)


def test_facing_counts_with_y_up():
    counter_clockwise = coverage.make_triangle((0, 64), (64, 64), (64, 0))
    assert coverage.is_front_facing(counter_clockwise, FrontFace.CCW)
    assert not coverage.is_front_facing(counter_clockwise, FrontFace.CW)


def test_culling_drops_the_named_faces():
    culled = {f: [coverage.is_culled(front, f) for front in (True, False)] for f in (None, *Face)}
    assert culled == {
        None: [False, False],
        Face.FRONT: [True, False],
        Face.BACK: [False, True],
        Face.FRONT_AND_BACK: [True, True],
    }


def test_the_scissor_box_counts_from_below():
    columns, rows = coverage.scissor_rows_and_columns(Scissor(1, 2, 3, 4), 10, 10)
    assert (list(columns), list(rows)) == ([1, 2, 3], [4, 5, 6, 7])
    assert coverage.scissor_rows_and_columns(Scissor(-5, 8, 100, 100), 10, 10) == (range(10), range(2))
    assert not any(coverage.scissor_rows_and_columns(Scissor(20, 20, 1, 1), 10, 10))


# ------------------------------------------------------------------------------------------------ interpolate


def test_exact_ties_of_the_weights_follow_the_low_reciprocal():
    # 1/12 is cut, so q1 = q2 fall below 1/4 and q0 = 1 - q1 - q2 rises above 1/2: floor(256 q0) = 128,
    # floor(256 q2) = 63, the middle takes 65.
    w = interpolate.weights((6, 3, 3), (1.0, 1.0, 1.0))
    assert (interpolate.color_weights(w), w.b0, w.b2) == ((128, 65, 63), 0.5, 0.25)
    assert w.q0 > 0.5 and 0.25 - 2.0**-24 < w.q2 < 0.25


def test_exact_ties_in_an_area_that_is_a_power_of_two_are_exact():
    w = interpolate.weights((2, 1, 1), (1.0, 1.0, 1.0))
    assert (interpolate.color_weights(w), w.q0, w.q2, w.b0, w.b2) == ((128, 64, 64), 0.5, 0.25, 0.5, 0.25)


def test_the_residual_vertex_follows_the_classes():
    assert interpolate.residual_vertex((0.5, 0.25, 0.25)) == 0
    assert interpolate.residual_vertex((0.3, 0.3, 0.1)) == 0
    assert interpolate.residual_vertex((0.3, 0.1, 0.3)) == 2
    assert interpolate.residual_vertex((0.1, 0.3, 0.3)) == 1
    assert interpolate.residual_vertex((0.34, 0.33, 0.33)) == 2
    assert interpolate.residual_vertex((0.1, 0.2, 0.7)) == 2
    assert interpolate.residual_vertex((0.2, 0.7, 0.1)) == 1


def test_perspective_weights_count_vertices_by_their_inverse_w():
    w = interpolate.weights((1, 1, 2), (2.0, 1.0, 0.5))
    assert (w.b0, w.b2) == (0.5, 0.25)
    assert interpolate.weights((1, 1, 2), (0.5, 0.5, 0.5)).b0 == 0.25


def test_color_channels_are_rounded_sums():
    assert interpolate.iterate_color_channel((128, 65, 63), (200, 100, 0)) == 125
    assert interpolate.iterate_color_channel((128, 65, 63), (77, 77, 77)) == 77


def test_other_values_are_iterated_from_the_middle_vertex():
    assert interpolate.iterate((4.0, 1.0, -3.0), 0.5, 0.25) == 1.5


# ------------------------------------------------------------------------------------------------------ depth


ONES = (1.0, 1.0, 1.0)


def test_depth_is_iterated_from_the_vertex_of_the_largest_exponent():
    assert depth.iterate((2, 1, 1), (0.0, 32767.5, 65535.0)) == 24575.625
    assert depth.iterate((1, 1, 1), (7.0, 7.0, 7.0)) == 7.0
    # A third is low by less than 2^-24 of itself: the base vertex takes what the others lack.
    assert depth.iterate((1, 1, 1), (3.0, 0.0, 0.0)) < 1.0
    assert depth.iterate((1, 1, 1), (0.0, 3.0, 0.0)) > 1.0
    assert [depth.base_vertex(e) for e in ((1, 1, 1), (2, 3, 2), (3, 1, 2), (1.9, 1, 2), (0, 0, 1))] == [
        1,
        1,
        0,
        2,
        2,
    ]


def test_a_product_keeps_the_bits_that_a_sum_of_29_bits_has_room_for():
    # 2^23 + 1/4 * (2^-4 + 2^-6): of the product's 2^-6 + 2^-8 a sum of 2^23 keeps the bits down to 2^-5.
    near, far = 2.0**23, 2.0**23 + 1.0
    assert depth.iterate((3, 0, 1), (near, 0.0, far)) == 2.0**23 + 0.25
    assert depth.iterate((63, 0, 1), (near, 0.0, far)) == near  # 2^-6 is gone
    assert depth.iterate((31, 0, 1), (near, 0.0, far)) == near + 2.0**-5


def test_differences_below_the_smallest_normal_single_are_none():
    small, step = 2.0**-125, 2.0**-127
    assert depth.iterate((3, 0, 1), (small, 0.0, small + step)) == small
    assert depth.iterate((3, 0, 1), (small, 0.0, small + 2 * step)) == small + step / 2


def test_words_of_every_depth_format():
    assert [depth.word(z, DepthFormat.FIXED_16, None) for z in (-1.0, 0.99, 7.0, 1e9)] == [0, 0, 7, 65535]
    assert [depth.word(z, DepthFormat.FLOAT_16, None) for z in (0.0, 2.0**-7, 2.0**-6, 1.0, 1e9)] == [
        0, 0, 0x1000, 0x7000, 0xFFFF,
    ]  # fmt: skip
    assert [depth.word(z, DepthFormat.FLOAT_24, None) for z in (2.0**-127, 2.0**-126, 1.5, 1e39)] == [
        0, 0x10000, 0x7F8000, 0xFEFFFF,
    ]  # fmt: skip


def test_limits_clamp_or_end_a_fragment():
    clamp, cull = DepthClamp(9.5, 16.5), DepthClamp(9.5, 16.5, cull=True)
    assert [depth.word(z, DepthFormat.FIXED_24, clamp) for z in (9.4, 12.9, 20.0)] == [9, 12, 16]
    assert [depth.word(z, DepthFormat.FIXED_24, cull) for z in (9.4, 9.5, 16.5, 16.6)] == [None, 9, 16, None]


def test_polygon_offset_takes_the_steeper_axis_and_truncates_in_fixed_formats():
    triangle = coverage.make_triangle((0, 0), (160, 0), (0, 160))
    polygon = PolygonState(offset_fill=True, offset_factor=2.0, offset_units=3.5)

    def offset(z, depth_format=DepthFormat.FIXED_16, fraction=False, **changed):
        return depth.primitive_offset(triangle, z, replace(polygon, **changed), depth_format, fraction)

    assert offset((0.0, 32767.5, 0.0)) == 6557.0
    assert offset((0.0, 16383.75, -32767.5), offset_factor=1.0, offset_units=0.0) == 3276.0
    assert offset((0.0, 32767.5, 0.0), offset_factor=-1.0, offset_units=0.0) == -3276.0
    assert offset((0.0, 32767.5, 0.0), offset_factor=1e20) == 2.0**30
    assert offset((0.0, 32767.5, 0.0), fraction=True) == 6557.0
    assert offset((0.0, 1.0, 0.0), fraction=True) == 3.7
    assert offset((0.0, 1.0, 0.0), DepthFormat.FLOAT_16) == 3.7


def test_clear_depths_are_rounded_to_nearest():
    assert [depth.depth_to_units(d, 16) for d in (0.0, 0.5, 1.0)] == [0, 32768, 65535]


# ---------------------------------------------------------------------------------------------- texel formats


def test_components_are_widened_by_repeating_their_bits():
    wide = {(31, 5): 255, (1, 5): 8, (16, 5): 132, (1, 1): 255, (2, 2): 170, (4, 3): 146, (33, 6): 134}
    assert {narrow: texel_formats.replicate(*narrow) for narrow in wide} == wide


def test_texels_are_stored_at_the_formats_resolution():
    rgba = (128, 7, 255, 100)
    assert texel_formats.store_texel(rgba, InternalFormat.RGBA4) == [136, 0, 255, 102]
    assert texel_formats.store_texel(rgba, InternalFormat.R5_G6_B5) == [132, 8, 255, 255]
    assert texel_formats.store_texel(rgba, InternalFormat.ALPHA8) == [0, 0, 0, 100]
    assert texel_formats.store_texel(rgba, InternalFormat.LUMINANCE8) == [128, 128, 128, 255]
    assert texel_formats.store_texel(rgba, InternalFormat.LUMINANCE6_ALPHA2) == [130, 130, 130, 85]
    assert texel_formats.store_texel(rgba, InternalFormat.INTENSITY8) == [128] * 4
    assert texel_formats.store_texel((0.5, 0.0, 2.0, -1.0), InternalFormat.RGBA8, floats=True) == [
        128,
        0,
        255,
        0,
    ]


def test_the_border_color_keeps_eight_bits_and_takes_the_base_format():
    color = (0.5, 0.25, 1.0, 0.125)
    assert texel_formats.border_texel(color, InternalFormat.RGBA2) == [128, 64, 255, 32]
    assert texel_formats.border_texel(color, InternalFormat.RGB8) == [128, 64, 255, 255]
    assert texel_formats.border_texel(color, InternalFormat.ALPHA4) == [0, 0, 0, 32]


def test_mipmaps_are_rounded_boxes():
    rows = [[[0] * 4, [1] * 4], [[1] * 4, [0, 0, 255, 1]]]
    assert texel_formats.next_level(rows) == [[[1, 1, 64, 1]]]
    assert texel_formats.next_level([[[10] * 4, [13] * 4]]) == [[[12] * 4]]


# ----------------------------------------------------------------------------------------------------- sample


def texture(*rows, target=TextureTarget.TEXTURE_2D, faces=1):
    """Gray rows, bottom row first; every face adds ten."""
    level = [[[[v + 10 * f] * 4 for v in row] for row in rows] for f in range(faces)]
    return SimpleNamespace(target=target, internal_format=InternalFormat.RGBA8, levels=[level])


def test_q_divides_unless_it_is_one_everywhere():
    ones = [(0.0, 0.0, 0.0, 1.0)] * 3
    assert sample.has_unit_q(ones)
    assert not sample.has_unit_q([*ones[:2], (0.0, 0.0, 0.0, 2.0)])
    assert sample.divide_by_q((3.0, 5.0, 7.0, 2.0), False) == (3.0, 5.0, 7.0)
    assert sample.divide_by_q((3.0, 5.0, 7.0, 2.0), True) == (1.5, 2.5, 3.5)
    assert sample.divide_by_q((3.0, 0.0, -7.0, 0.0), True) == (3.0 * 2.0**64, 0.0, -7.0 * 2.0**64)


def test_a_textures_access_multiplies_by_the_reciprocal_of_q():
    strq = 1.5, -3.0, 0.75, 3.0
    assert sample.projected(strq, False) == strq
    third = 0xAAAAAA * 2.0**-25  # cut, so that its products with 3 are below the quotients
    assert sample.projected((1.0, -1.0, 0.0, 3.0), True) == (third, -third, 0.0, 1.0)
    assert sample.projected(strq, True) == (0.5 - 2.0**-25, -1.0 + 2.0**-24, 0.25 - 2.0**-26, 1.0)
    assert sample.projected((3.0, 5.0, 7.0, -2.0), True) == (-1.5, -2.5, -3.5, 1.0)
    assert sample.projected((3.0, 0.0, -7.0, 0.0), True) == (3.0 * 2.0**64, 0.0, -7.0 * 2.0**64, 1.0)


@pytest.mark.parametrize(
    ("direction", "face", "point"),
    [
        ((1.0, 0.5, 0.25), 0, (3.0, 2.0)),
        ((-1.0, 0.5, 0.25), 1, (5.0, 2.0)),
        ((0.5, 1.0, 0.25), 2, (6.0, 5.0)),
        ((0.5, -1.0, 0.25), 3, (6.0, 3.0)),
        ((0.5, 0.25, 1.0), 4, (6.0, 3.0)),
        ((0.5, 0.25, -1.0), 5, (2.0, 3.0)),
        ((1.0, 1.0, -1.0), 0, (8.0, 0.0)),
        ((0.0, 2.0, 2.0), 2, (4.0, 8.0)),
        ((0.0, 0.0, 0.0), 0, (0.0, 0.0)),  # the first texel of +x, not the middle
    ],
)
def test_cube_map_directions_select_faces_and_texels(direction, face, point):
    assert sample.cube_map_face((*direction, 9.0)) == face
    assert sample.face_coordinates((*direction, 9.0), face, 8) == point


def iterated(v, n):
    """The coordinate where the edge values are n, between vertices with the coordinate v."""
    return interpolate.iterate_coordinate(v, interpolate.weights(n, (1.0, 1.0, 1.0)))


def test_ties_of_texture_coordinates_fall_to_the_side_of_their_terms():
    # 1/3 and 1/12 are cut: what is added to v1 falls short of the tie, what is taken from it too.
    assert iterated((0.0, 0.0, 1.0), (2, 0, 1)) < 1 / 3 < iterated((1.0, 1.0, 0.0), (1, 0, 2))
    assert iterated((0.0, 1.0, 1.0), (3, 6, 3)) == 0.75 + 2.0**-23  # what is taken is cut to the 24 bits of 1
    assert iterated((1.0, 0.0, 0.0), (3, 6, 3)) == 0.25 - 2.0**-26  # what is added keeps its own
    assert iterated((0.0, 0.0, 1.0), (2, 1, 1)) == 0.25  # an area that is a power of two


def test_every_term_of_a_coordinate_is_cut_to_the_bits_of_the_largest():
    ulp = 2.0**-23
    weights = interpolate.Weights(0.0, 0.0, 0.5, 0.25)
    assert interpolate.iterate_coordinate((1.0 + ulp, 1.0, 1.0), weights) == 1.0
    assert interpolate.iterate_coordinate((1.0 + 3 * ulp, 1.0, 1.0 + 3 * ulp), weights) == 1.0 + ulp
    assert interpolate.iterate_coordinate((0.0, 0.0, 0.0), weights) == 0.0
    assert interpolate.iterate_coordinate((1e300, 1e300, 1e300), weights) == pytest.approx(1e300, rel=ulp)


def test_lambda_is_floored_at_eight_fraction_bits():
    exact = {1.0: 0, 2.0: 128, 4.0: 256, 0.25: -256, below(2.0): 127, below(1.0): -1}
    assert {rho2: sample.lambda_of(rho2) for rho2 in exact} == exact
    assert sample.lambda_of(0.0) == -(2**20)
    step = 2.0 ** (1 / 128)  # irrational: the nearest float lies one step at most from the power
    assert sample.lambda_of(step + 1e-15) == 1
    assert sample.lambda_of(step - 1e-15) == 0


def test_coordinates_wrap_in_texel_units():
    wrap = sample.wrap_coordinate
    assert [wrap(t, WrapMode.REPEAT, 4) for t in (-1.0, 5.5, 4.0)] == [3.0, 1.5, 0.0]
    assert [wrap(t, WrapMode.MIRRORED_REPEAT, 4) for t in (-1.0, 5.5, 4.0, 9.0)] == [7.0, 5.5, 4.0, 1.0]
    assert [wrap(t, WrapMode.CLAMP, 4) for t in (-1.0, 2.5, 9.0)] == [0.0, 2.5, 4.0]
    assert [wrap(t, WrapMode.CLAMP_TO_EDGE, 4) for t in (-1.0, 2.5, 9.0)] == [0.5, 2.5, 3.5]
    assert [wrap(t, WrapMode.CLAMP_TO_BORDER, 4) for t in (-1.0, 2.5, 9.0)] == [-0.5, 2.5, 4.5]


def test_indices_outside_are_wrapped_clamped_or_border():
    index = sample.wrap_index
    assert [index(i, WrapMode.REPEAT, 4, linear=True) for i in (-1, 3, 4)] == [3, 3, 0]
    assert [index(i, WrapMode.MIRRORED_REPEAT, 4, linear=True) for i in (-1, 3, 4, 7, 8)] == [0, 3, 3, 0, 0]
    assert [index(i, WrapMode.CLAMP_TO_EDGE, 4, linear=True) for i in (-1, 3, 4)] == [0, 3, 3]
    assert [index(i, WrapMode.CLAMP, 4, linear=True) for i in (-1, 3, 4)] == [None, 3, None]
    assert [index(i, WrapMode.CLAMP, 4, linear=False) for i in (-1, 3, 4)] == [0, 3, 3]
    assert [index(i, WrapMode.CLAMP_TO_BORDER, 4, linear=False) for i in (-1, 3, 4)] == [None, 3, None]


def test_linear_filters_round_rows_first():
    # In the middle of four texels: rows give 1 (1/2 up) and 2 (3/2 up), together 2 (3/2 up). Columns first
    # would give 1, 1 and 1.
    edge = (WrapMode.CLAMP_TO_EDGE,) * 2
    assert (
        sample.sample_linear(texture([0, 1], [2, 1]), 0, 0, (1.0, 1.0), edge, [9] * 4, Sampler()) == [2] * 4
    )


def test_linear_filters_blend_with_the_border():
    modes = (WrapMode.CLAMP, WrapMode.CLAMP_TO_EDGE)
    gray = texture([100, 200], [100, 200])
    assert sample.sample_linear(gray, 0, 0, (0.0, 0.5), modes, [0] * 4, Sampler()) == [50] * 4
    assert sample.sample_linear(gray, 0, 0, (2.0, 0.5), modes, [0] * 4, Sampler()) == [100] * 4


def test_one_dimensional_textures_read_their_row():
    row = texture([100, 200], target=TextureTarget.TEXTURE_1D)
    modes = (WrapMode.CLAMP_TO_EDGE, WrapMode.CLAMP_TO_BORDER)
    assert sample.sample_linear(row, 0, 0, (1.0, 77.0), modes, [0] * 4, Sampler()) == [150] * 4


def textured(corners, coordinates, inverse_w=(1.0, 1.0, 1.0)):
    divided = not sample.has_unit_q(coordinates)
    return sample.TexturedTriangle(coverage.make_triangle(*corners), inverse_w, tuple(coordinates), divided)


def screen_aligned(texels_per_pixel, size):
    """A big triangle whose s grows by so many texels per pixel to the right, and t downwards."""
    step = texels_per_pixel / size
    return textured(
        ((0, 0), (1024, 0), (0, 1024)),
        [(0.0, 0.0, 0.0, 1.0), (64 * step, 0.0, 0.0, 1.0), (0.0, 64 * step, 0.0, 1.0)],
    )


def sampled(triangle, px, py, image, sampler, bias=0.0, profile=GEFORCE_256):
    w = interpolate.weights(coverage.edge_values(triangle.edges, px, py), triangle.inverse_w)
    return sample.sample_texture(triangle, px, py, w, image, sampler, bias, profile)


def pyramid():
    """An 8x8 texture whose level l is 40 (l + 1) everywhere."""
    levels = [[[[[40 * (k + 1)] * 4] * (8 >> k)] * (8 >> k)] for k in range(4)]
    return SimpleNamespace(
        target=TextureTarget.TEXTURE_2D, internal_format=InternalFormat.RGBA8, levels=levels
    )


def test_lambda_is_the_logarithm_of_texels_per_pixel():
    image = pyramid()
    assert sample.level_of_detail(screen_aligned(1.0, 8), 3, 3, image, 0.0) == 0
    assert sample.level_of_detail(screen_aligned(4.0, 8), 3, 3, image, 0.0) == 512
    assert sample.level_of_detail(screen_aligned(4.0, 8), 3, 3, image, -0.999) == 512 - 255


def test_blocks_that_reach_behind_the_eye_take_the_largest_lambda():
    # D = n0 + n1 / 2^20 + n2: at pixel (5, 4), outside, n0 is negative and larger than the others together.
    triangle = textured(
        ((0, 0), (80, 0), (0, 80)),
        [(0.0, 0.0, 0.0, 1.0), (1.0, 0.0, 0.0, 1.0), (0.0, 1.0, 0.0, 1.0)],
        (1.0, 2.0**-20, 2.0**-20),
    )
    assert sample.level_of_detail(triangle, 5, 4, pyramid(), 0.0) == 2**20


@pytest.mark.parametrize(
    ("texels_per_pixel", "minification", "expected"),
    [
        (0.5, TextureFilter.LINEAR_MIPMAP_LINEAR, 40),
        (2.0, TextureFilter.NEAREST_MIPMAP_NEAREST, 80),
        (2.0, TextureFilter.NEAREST, 40),
        (4.0, TextureFilter.LINEAR_MIPMAP_NEAREST, 120),
        (64.0, TextureFilter.NEAREST_MIPMAP_LINEAR, 160),
        (math.sqrt(8.0) + 1e-9, TextureFilter.LINEAR_MIPMAP_LINEAR, 100),
        (math.sqrt(2.0) + 1e-9, TextureFilter.NEAREST_MIPMAP_NEAREST, 40),
        (math.sqrt(2.0) * 1.01, TextureFilter.NEAREST_MIPMAP_NEAREST, 80),
    ],
)
def test_mipmap_filters_choose_their_levels(texels_per_pixel, minification, expected):
    # At sqrt(8) texels a pixel lambda is 384 = 1.5 levels: (80*128 + 120*128 + 128) >> 8 = 100.
    # At sqrt(2) it is 128: (128 + 127) >> 8 = 0.
    sampler = Sampler(min_filter=minification, mag_filter=TextureFilter.LINEAR)
    assert sampled(screen_aligned(texels_per_pixel, 8), 2, 2, pyramid(), sampler) == [expected] * 4


def test_opengls_threshold_keeps_a_linear_magnifier_half_a_level_longer():
    opengl = GEFORCE_256.changed(magnification_threshold=MagnificationThreshold.OPENGL_C)
    sampler = Sampler(min_filter=TextureFilter.NEAREST_MIPMAP_LINEAR, mag_filter=TextureFilter.LINEAR)
    assert sample.magnification_threshold(sampler, opengl) == 128
    assert sample.magnification_threshold(sampler, GEFORCE_256) == 0
    assert sample.magnification_threshold(replace(sampler, mag_filter=TextureFilter.NEAREST), opengl) == 0
    linear = replace(sampler, min_filter=TextureFilter.LINEAR_MIPMAP_LINEAR)
    assert sample.magnification_threshold(linear, opengl) == 0


def test_nearest_texels_are_floored_and_exact_boundaries_follow_the_tie_rule():
    # One texel per pixel: T at pixel 2 is 2.5, texel 2. Shifted by half a texel T is 3 exactly; the weight of
    # vertex 0 is the largest at pixel (2, 2), so the sum for s is v1 - v2 = 12 >= 0: texel 3. With vertices 1
    # and 2 exchanged it is -12 < 0: texel 2; where the area is a power of two, texel 3 again.
    image = texture(*[[10 * i for i in range(8)]] * 8)
    nearest = Sampler(min_filter=TextureFilter.NEAREST, mag_filter=TextureFilter.NEAREST)
    assert sampled(screen_aligned(1.0, 8), 2, 2, image, nearest)[0] == 20
    half = 0.5 / 8

    def shifted(edge, order):
        corners = ((0, 0), (16 * edge, 0), (0, 16 * edge))
        st = [(half, 0.0, 0.0, 1.0), (edge / 8 + half, 0.0, 0.0, 1.0), (half, edge / 8, 0.0, 1.0)]
        return textured([corners[i] for i in order], [st[i] for i in order])

    assert sampled(shifted(96, (0, 1, 2)), 2, 2, image, nearest)[0] == 30
    assert sampled(shifted(96, (0, 2, 1)), 2, 2, image, nearest)[0] == 20
    assert sampled(shifted(64, (0, 2, 1)), 2, 2, image, nearest)[0] == 30


# ---------------------------------------------------------------------------------------------------- combine


@pytest.mark.parametrize(
    ("mapping", "values"),
    [
        (Mapping.UNSIGNED_IDENTITY, (0, 0, 0, 128, 255)),
        (Mapping.UNSIGNED_INVERT, (255, 255, 255, 127, 0)),
        (Mapping.EXPAND_NORMAL, (-256, -256, -256, 0, 254)),
        (Mapping.EXPAND_NEGATE, (255, 255, 255, 0, -254)),
        (Mapping.HALF_BIAS_NORMAL, (-128, -128, -128, 0, 127)),
        (Mapping.HALF_BIAS_NEGATE, (128, 128, 128, 0, -127)),
        (Mapping.SIGNED_IDENTITY, (-256, -1, 0, 128, 255)),
        (Mapping.SIGNED_NEGATE, (255, 1, 0, -128, -255)),
    ],
)
def test_input_mappings_of_the_chip(mapping, values):
    assert tuple(combine.map_input(x, mapping, CHIP) for x in (-256, -1, 0, 128, 255)) == values


def test_expansion_by_the_real_half():
    real = combine.machine_of(GEFORCE_256.changed(expand_half=127.5))
    assert [combine.map_input(x, Mapping.EXPAND_NORMAL, real) for x in (0, 128, 255)] == [-255, 1, 255]
    assert [combine.map_input(x, Mapping.EXPAND_NEGATE, real) for x in (0, 128, 255)] == [255, -1, -255]


CHIP = combine.machine_of(GEFORCE_256)
NO_SCALE, TWO, FOUR, HALF = CombinerScale
BIASED = CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF
UNBIASED = CombinerBias.NONE
PER_PRODUCT = GEFORCE_256.changed(product_rounding=ProductRounding.PER_PRODUCT)
SCALE_FIRST = GEFORCE_256.changed(round_before_scale=False)


@pytest.mark.parametrize(
    ("products", "scale", "bias", "profile", "expected"),
    [
        ([200 * 255], TWO, BIASED, GEFORCE_256, 144),
        ([200 * 255], NO_SCALE, BIASED, GEFORCE_256, 72),
        ([100 * 255], FOUR, UNBIASED, GEFORCE_256, 255),
        ([-100 * 255], FOUR, UNBIASED, GEFORCE_256, -256),
        ([-100 * 255], FOUR, UNBIASED, GEFORCE_256.changed(clamp_low=-255), -255),
        ([-1 * 255], HALF, UNBIASED, GEFORCE_256, 0),
        ([-3 * 255], HALF, UNBIASED, GEFORCE_256, -1),
        ([3 * 255], HALF, UNBIASED, GEFORCE_256, 2),
        ([110 * 110, 110 * 110], NO_SCALE, UNBIASED, GEFORCE_256, 95),
        ([110 * 110, 110 * 110], NO_SCALE, UNBIASED, PER_PRODUCT, 94),
        ([110 * 110], TWO, UNBIASED, GEFORCE_256, 94),
        ([110 * 110], TWO, UNBIASED, SCALE_FIRST, 95),
        ([9333], HALF, UNBIASED, GEFORCE_256, 19),
        ([9333], HALF, UNBIASED, SCALE_FIRST, 18),
        ([200 * 255], TWO, BIASED, SCALE_FIRST, 144),
        ([200 * 255], NO_SCALE, BIASED, SCALE_FIRST, 72),
        ([-256 * -256], NO_SCALE, UNBIASED, GEFORCE_256, 255),
    ],
)
def test_outputs_are_rounded_biased_scaled_and_clamped(products, scale, bias, profile, expected):
    assert combine.combiner_output(products, scale, bias, combine.machine_of(profile)) == expected


def test_the_mux_looks_at_the_most_significant_bit():
    assert [combine.mux_takes_cd(a, machine=CHIP) for a in (-256, -1, 0, 127, 128, 255)] == [False] * 4 + [
        True
    ] * 2


def registers(primary=(10, 20, 30, 40), secondary=(1, 2, 3), textures=(), fog_register=(0, 0, 0, 255)):
    return combine.initial_registers(
        list(primary), list(secondary), [list(t) for t in textures], fog_register
    )


def test_registers_start_as_the_extension_says():
    file = registers(textures=[(1, 2, 3, 4)])
    assert file[Register.SPARE0] == [0, 0, 0, 4]
    assert file[Register.TEXTURE1] == [0, 0, 0, 255]
    assert file[Register.SECONDARY_COLOR] == [1, 2, 3, 0]
    assert file[Register.SPARE1] == [0, 0, 0, 0]
    assert registers()[Register.SPARE0] == [0, 0, 0, 255]


def test_the_initial_program_is_primary_plus_secondary():
    assert combine.combine(RegisterCombiners(), registers(), CHIP) == [11, 22, 33, 40]
    bright = registers((200, 20, 30, 40), (100, 0, 0))
    assert combine.combine(RegisterCombiners(), bright, CHIP) == [255, 20, 30, 40]


def test_dot_products_sum_exactly_before_rounding():
    # Expanded: (254, 0, 0) . (254, 0, 0) = 64516, 253.004 after the division.
    expand = CombinerInput(Register.PRIMARY_COLOR, Mapping.EXPAND_NORMAL)
    rgb = RGBPortion(
        a=expand, b=expand, ab_output=Register.SPARE1, sum_output=Register.DISCARD, ab_dot_product=True
    )
    after = combine.general_combiner(registers((255, 128, 128, 7)), GeneralCombiner(rgb=rgb), CHIP)
    assert after[Register.SPARE1] == [253, 253, 253, 0]
    # (100, 100, 100) . (100, 100, 100) by squares 39.2 each: 117.6 together, 118 and not 3 * 39 = 117.
    gray = CombinerInput(Register.PRIMARY_COLOR)
    rgb = replace(rgb, a=gray, b=gray)
    before = registers((100, 100, 100, 7))
    for profile, expected in ((GEFORCE_256, 118), (PER_PRODUCT, 117)):
        after = combine.general_combiner(before, GeneralCombiner(rgb=rgb), combine.machine_of(profile))
        assert after[Register.SPARE1][:3] == [expected] * 3


def test_outputs_are_written_after_all_inputs_are_read():
    one = CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT)
    swap = RGBPortion(
        a=CombinerInput(Register.PRIMARY_COLOR),
        b=one,
        c=CombinerInput(Register.SECONDARY_COLOR),
        d=one,
        ab_output=Register.SECONDARY_COLOR,
        cd_output=Register.PRIMARY_COLOR,
        sum_output=Register.SPARE1,
    )
    alpha = AlphaPortion(
        a=CombinerInput(Register.PRIMARY_COLOR, usage=ComponentUsage.BLUE), sum_output=Register.PRIMARY_COLOR
    )
    after = combine.general_combiner(registers(), GeneralCombiner(swap, alpha), CHIP)
    assert after[Register.PRIMARY_COLOR] == [1, 2, 3, 30]
    assert after[Register.SECONDARY_COLOR] == [10, 20, 30, 0]
    assert after[Register.SPARE1] == [11, 22, 33, 0]


def test_alpha_usage_replicates_alpha():
    rgb = RGBPortion(a=CombinerInput(Register.PRIMARY_COLOR, usage=ComponentUsage.ALPHA))
    after = combine.general_combiner(registers(), GeneralCombiner(rgb), CHIP)
    assert after[Register.SPARE0] == [40, 40, 40, 40]


def test_stages_may_have_their_own_constants():
    take = RGBPortion(a=CombinerInput(Register.CONSTANT_COLOR0), sum_output=Register.SPARE1)
    add = RGBPortion(
        a=CombinerInput(Register.CONSTANT_COLOR0),
        c=CombinerInput(Register.SPARE1),
        d=CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT),
        sum_output=Register.SPARE1,
    )
    program = RegisterCombiners(
        general=(
            GeneralCombiner(take, constant_color0=(100 / 255, 0.0, 0.0, 0.0)),
            GeneralCombiner(add),
        ),
        final=FinalCombiner(
            a=CombinerInput(),
            b=CombinerInput(),
            c=CombinerInput(Register.SPARE1),
            d=CombinerInput(Register.CONSTANT_COLOR0),
        ),
        constant_color0=(7 / 255, 0.0, 0.0, 0.0),
    )
    assert combine.combine(program, registers(), CHIP)[0] == 100 + 7 + 7


FINAL_ONE = CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT)


@pytest.mark.parametrize(
    ("clamped", "mapping", "factor", "expected"),
    [
        (True, Mapping.UNSIGNED_IDENTITY, 128, 128),
        (False, Mapping.UNSIGNED_IDENTITY, 128, 151),
        (False, Mapping.UNSIGNED_IDENTITY, 255, 255),
        (False, Mapping.UNSIGNED_INVERT, 255, 0),
    ],
)
def test_the_color_sum_is_kept_above_one_without_its_clamp(clamped, mapping, factor, expected):
    # SPARE0 + SECONDARY = 300; 128 * 300 / 255 = 150.6, 128 * 255 / 255 = 128.
    file = registers((factor, factor, factor, 9), (100, 100, 100))
    file[Register.SPARE0] = [200, 200, 200, 9]
    final = FinalCombiner(
        a=CombinerInput(Register.PRIMARY_COLOR),
        b=CombinerInput(Register.SPARE0_PLUS_SECONDARY_COLOR, mapping),
        c=CombinerInput(),
    )
    assert combine.final_combiner(file, final, clamped, machine=CHIP) == [expected] * 3 + [9]


def test_the_final_combiner_multiplies_e_and_f_and_clamps_negatives():
    file = registers((100, 200, 255, 128), (50, 60, 70))
    file[Register.SPARE0] = [-100, 20, 255, -7]
    final = FinalCombiner(
        a=CombinerInput(),
        b=FINAL_ONE,
        c=CombinerInput(Register.SPARE0),
        d=CombinerInput(Register.E_TIMES_F),
        e=CombinerInput(Register.PRIMARY_COLOR),
        f=CombinerInput(Register.PRIMARY_COLOR, usage=ComponentUsage.ALPHA),
    )
    # E F: 12800/255 = 50.2, 25600/255 = 100.4, 128.
    assert combine.final_combiner(file, final, True, machine=CHIP) == [50, 120, 255, 0]


def test_the_final_blend_is_rounded_once():
    # A = 51, B = 2, C = 4: (102 + 816)/255 = 3.6, 4; rounded apart 0.4 and 3.2 would give 0 + 3.
    file = registers((51, 51, 51, 0), (4, 4, 4))
    file[Register.SPARE1] = [2, 2, 2, 0]
    final = FinalCombiner(
        a=CombinerInput(Register.PRIMARY_COLOR),
        b=CombinerInput(Register.SPARE1),
        c=CombinerInput(Register.SECONDARY_COLOR),
    )
    assert combine.final_combiner(file, final, True, machine=CHIP)[:3] == [4, 4, 4]


# -------------------------------------------------------------------------------------------------------- fog


def test_linear_fog_rounds_to_nearest_and_is_clamped():
    state = Fog(FogMode.LINEAR, start=0.0, end=1.0)
    distances = (-1.0, 0.0, 0.5, math.nextafter(0.5, 1.0), 1.0, 2.0)
    assert [fog.fog_factor(c, state, GEFORCE_256) for c in distances] == [255, 255, 128, 127, 0, 0]
    rising = Fog(FogMode.LINEAR, start=1.0, end=0.0)
    assert [fog.fog_factor(c, rising, GEFORCE_256) for c in (0.0, 0.5, below(0.5), 1.0)] == [0, 128, 127, 255]


def test_exponential_fog_rounds_to_nearest():
    # 255/e = 93.8, 255/e^2 = 34.51.
    assert [fog.fog_factor(c, Fog(FogMode.EXP), GEFORCE_256) for c in (0.0, 1.0, 2.0)] == [255, 94, 35]
    assert [fog.fog_factor(c, Fog(FogMode.EXP2), GEFORCE_256) for c in (0.0, 1.0, 2.0)] == [255, 94, 5]
    assert fog.fog_factor(1.0, Fog(FogMode.EXP, density=2.0), GEFORCE_256) == 35
    assert fog.fog_factor(1e300, Fog(FogMode.EXP, density=0.0), GEFORCE_256) == 255


def test_table_fog_s_registers_are_rounded_to_their_bits_and_no_result_tells_the_signs_of_zeros_apart():
    fourteen, zero = (
        fog.line(Fog(FogMode.EXP, registers=FogRegisters(bias=b, multiplier=-0.0)))
        for b in (1 + 3 * 2.0**-14, -0.0)
    )
    assert fourteen == (1 + 2.0**-12, 0.0)  # 1 + 1.5 * 2^-13: a tie, to the even side
    assert zero == (0, 0)  # fractions, which have one zero: 0 times infinity is 0, whatever the signs
    for bias, multiplier in ((-0.0, -0.0), (0.0, 0.0), (-0.0, 0.0)):
        state = Fog(FogMode.EXP, registers=FogRegisters(bias=bias, multiplier=multiplier))
        assert {fog.vertex_value(state, c) for c in (-0.0, 0.0, -1.0, 1.0, math.inf, -math.inf)} == {0.0}


def test_thresholds_of_exponential_fog_fall():
    limits = fog.thresholds(FogMode.EXP2, 0.37, 0.0, 1.0)
    assert all(a > b > 0 for a, b in pairwise(limits))


def test_fog_and_color_sum_leave_alpha_alone():
    assert fog.add_secondary([200, 10, 0, 77], [100, 1, 2]) == [255, 11, 2, 77]
    assert fog.blend_with_fog([200, 0, 255, 77], [0, 255, 0, 0], 128) == [100, 127, 128, 77]


# ----------------------------------------------------------------------------------------------- per fragment


def test_comparisons_put_the_incoming_value_first():
    outcomes = {f: [per_fragment.compare(f, a, 5) for a in (4, 5, 6)] for f in ComparisonFunction}
    assert outcomes[ComparisonFunction.LESS] == [True, False, False]
    assert outcomes[ComparisonFunction.LEQUAL] == [True, True, False]
    assert outcomes[ComparisonFunction.GREATER] == [False, False, True]
    assert outcomes[ComparisonFunction.GEQUAL] == [False, True, True]
    assert outcomes[ComparisonFunction.EQUAL] == [False, True, False]
    assert outcomes[ComparisonFunction.NOTEQUAL] == [True, False, True]
    assert outcomes[ComparisonFunction.NEVER] == [False] * 3
    assert outcomes[ComparisonFunction.ALWAYS] == [True] * 3


def test_stencil_operations_saturate_or_wrap():
    results = {op: [per_fragment.stencil_result(op, s, 77) for s in (0, 200, 255)] for op in StencilOperation}
    assert results == {
        StencilOperation.KEEP: [0, 200, 255],
        StencilOperation.ZERO: [0, 0, 0],
        StencilOperation.REPLACE: [77, 77, 77],
        StencilOperation.INCR: [1, 201, 255],
        StencilOperation.DECR: [0, 199, 254],
        StencilOperation.INVERT: [255, 55, 0],
        StencilOperation.INCR_WRAP: [1, 201, 0],
        StencilOperation.DECR_WRAP: [255, 199, 254],
    }


def test_the_stencil_mask_limits_the_test_and_the_write_mask_the_result():
    test = StencilTest(ComparisonFunction.EQUAL, reference=0x1F5, mask=0x0F, write_mask=0x3C)
    assert per_fragment.stencil_reference(test) == 255
    assert per_fragment.stencil_test_passes(0x2F, test)
    assert not per_fragment.stencil_test_passes(0x25, test)
    assert per_fragment.update_stencil(0x81, StencilOperation.REPLACE, test) == 0x81 | 0x3C


def test_blending_rounds_once_after_the_sum():
    add, subtract, reverse = list(BlendEquation)[:3]
    assert per_fragment.blend_component(add, 110, 110, 110, 110) == 95
    assert per_fragment.blend_component(add, 255, 255, 255, 255) == 255
    assert per_fragment.blend_component(subtract, 100, 200, 255, 255) == 0
    assert per_fragment.blend_component(reverse, 100, 200, 255, 128) == 0
    assert per_fragment.blend_component(reverse, 10, 200, 255, 255) == 190
    assert per_fragment.blend_component(BlendEquation.MIN, 10, 200, 0, 0) == 10
    assert per_fragment.blend_component(BlendEquation.MAX, 10, 200, 0, 0) == 200


def test_blend_factors_read_their_own_color():
    source, destination, constant = (1, 2, 3, 100), (5, 6, 7, 200), (9, 10, 11, 12)

    def rgba(factor):
        return [per_fragment.blend_factor(factor, k, source, destination, constant) for k in range(4)]

    assert rgba(BlendFactor.ONE_MINUS_SRC_COLOR) == [254, 253, 252, 155]
    assert rgba(BlendFactor.DST_COLOR) == [5, 6, 7, 200]
    assert rgba(BlendFactor.SRC_ALPHA) == [100] * 4
    assert rgba(BlendFactor.ONE_MINUS_DST_ALPHA) == [55] * 4
    assert rgba(BlendFactor.SRC_ALPHA_SATURATE) == [55, 55, 55, 255]
    assert rgba(BlendFactor.CONSTANT_COLOR) == [9, 10, 11, 12]
    assert rgba(BlendFactor.ONE_MINUS_CONSTANT_ALPHA) == [243] * 4
    assert rgba(BlendFactor.ONE) == [255] * 4


def test_a_logic_operations_number_is_its_truth_table():
    # Table 4.3 in its order: bit 0 is the result for s = d = 1, bit 1 for s = 1, d = 0, and so on.
    for operation in LogicOperation:
        for bit, (s, d) in enumerate(((1, 1), (1, 0), (0, 1), (0, 0))):
            result = per_fragment.logic_operation(operation, 255 * s, 255 * d)
            assert result == 255 * (operation >> bit & 1)


def one_pixel(color=(0, 0, 0, 0), stored_depth=100, stencil=5):
    return render.Target(1, 1, 16, [[list(color)]], [[stored_depth]], [[stencil]])


def test_a_fragment_that_fails_the_alpha_test_leaves_everything():
    target = one_pixel()
    state = PassState(
        alpha_test=AlphaTest(ComparisonFunction.GREATER, 0.5),
        stencil_test=StencilTest(fail=StencilOperation.ZERO, depth_pass=StencilOperation.ZERO),
    )
    assert not per_fragment.write_fragment(target, 0, 0, [9, 9, 9, 128], 0, state)
    assert target == one_pixel()
    assert per_fragment.write_fragment(target, 0, 0, [9, 9, 9, 129], 0, state)


@pytest.mark.parametrize(
    ("function", "z", "stencil", "expected_depth"),
    [
        (ComparisonFunction.NEVER, 50, 0, 100),
        (ComparisonFunction.ALWAYS, 150, 6, 100),
        (ComparisonFunction.ALWAYS, 50, 4, 50),
    ],
)
def test_the_stencil_takes_one_of_three_operations(function, z, stencil, expected_depth):
    target = one_pixel()
    state = PassState(
        stencil_test=StencilTest(
            function,
            fail=StencilOperation.ZERO,
            depth_fail=StencilOperation.INCR,
            depth_pass=StencilOperation.DECR,
        ),
        depth_test=DepthTest(),
    )
    per_fragment.write_fragment(target, 0, 0, [9, 9, 9, 9], z, state)
    assert (target.stencil, target.depth) == ([[stencil]], [[expected_depth]])


def test_without_a_depth_test_no_depth_is_written():
    target = one_pixel()
    state = PassState(stencil_test=StencilTest(depth_pass=StencilOperation.INVERT))
    per_fragment.write_fragment(target, 0, 0, [1, 2, 3, 4], 7, state)
    assert (target.color, target.depth, target.stencil) == ([[[1, 2, 3, 4]]], [[100]], [[250]])


def test_a_logic_operation_replaces_blending_and_the_mask_comes_last():
    target = one_pixel(color=(0b1100, 7, 7, 7))
    state = PassState(
        blending=Blending(BlendFactor.ONE, BlendFactor.ONE),
        logic_op=LogicOperation.XOR,
        color_mask=ColorMask(green=False, blue=False, alpha=False),
    )
    per_fragment.write_fragment(target, 0, 0, [0b1010, 1, 1, 1], 0, state)
    assert target.color == [[[0b0110, 7, 7, 7]]]


# --------------------------------------------------------------------------------------------------- transfer


def test_clear_goes_through_scissor_and_masks():
    target = render.Target(2, 2, 16)
    command = SimpleNamespace(
        color=(1.0, 0.5, 0.0, 1.0),
        depth=0.5,
        stencil=0xFF,
        scissor=Scissor(0, 0, 1, 1),
        color_mask=ColorMask(red=False),
        stencil_write_mask=0x0F,
    )
    transfer.clear(target, command)
    assert target.color == [[[0] * 4] * 2, [[0, 128, 0, 255], [0] * 4]]
    assert target.depth == [[65535, 65535], [32768, 65535]]
    assert target.stencil == [[0, 0], [0x0F, 0]]


def gradient_target():
    color = [[[100 + x, 10 * y, 200, 3] for x in range(3)] for y in range(2)]
    return render.Target(3, 2, 16, color, [[0, 1, 2], [3, 4, 5]], [[9, 8, 7], [6, 5, 4]])


def read(pixel_format, x, y, width, height):
    command = SimpleNamespace(format=pixel_format, type="UNSIGNED_BYTE", x=x, y=y, transfer=INITIAL_TRANSFER)
    return transfer.read_pixels(gradient_target(), command, GEFORCE_256, width, height)


def test_rectangles_are_read_bottom_row_first():
    assert read("RGB", 1, 0, 2, 1) == [[[101, 10, 200], [102, 10, 200]]]
    assert read("DEPTH_COMPONENT", 0, 0, 3, 2) == [[3, 4, 5], [0, 1, 2]]
    assert read("STENCIL_INDEX", 2, 1, 1, 1) == [[7]]
    assert read("LUMINANCE_ALPHA", 0, 0, 1, 2) == [[[255, 3]], [[255, 3]]]
    assert read("GREEN", 0, 0, 1, 2) in ([[10], [0]], [[[10]], [[0]]])


def test_copies_are_stored_at_the_textures_resolution():
    texture = SimpleNamespace(target=TextureTarget.TEXTURE_2D, internal_format=InternalFormat.LUMINANCE8)
    box = 2, 1, 1, 1
    copied = transfer.copy_texels(gradient_target(), texture, INITIAL_TRANSFER, GEFORCE_256, *box)
    assert copied == [[[102] * 3 + [255]]]


# -------------------------------------------------------------------------------------------- a draw, by hand


def quad(colors, z=0.5, **changes):
    """Two triangles over pixels (1, 1) to (3, 3) of the device, counter-clockwise with y up."""
    columns = {
        "x": [16, 64, 64, 16],
        "y": [64, 64, 16, 16],
        "z": [z] * 4,
        "inverse_w": [1.0] * 4,
        "colors": colors,
        "coordinates": [[[0.0, 0.0, 0.0, 1.0]]] * 4,
        "fog": [0.0] * 4,
        "triangles": [[0, 1, 2, 2], [0, 2, 3, 3]],
        "strokes": [],
        "two_side": False,
    }
    return SimpleNamespace(**{**columns, **changes})


FRONT, BACK = [10, 20, 30, 40, 1, 2, 3, 0], [50, 60, 70, 80, 0, 0, 0, 0]


def test_a_quad_draws_each_of_its_pixels_once_with_its_color():
    target = render.Target(5, 5, 16)
    state = PassState(
        stencil_test=StencilTest(depth_pass=StencilOperation.INCR),
        depth_test=DepthTest(ComparisonFunction.ALWAYS),
    )
    render.draw(target, quad([[FRONT, BACK]] * 4), state, {}, GEFORCE_256)
    inside = [[1 <= x <= 3 and 1 <= y <= 3 for x in range(5)] for y in range(5)]
    assert target.stencil == [[int(i) for i in row] for row in inside]
    assert target.color == [[[10, 20, 30, 40] if i else [0] * 4 for i in row] for row in inside]
    assert target.depth == [[32767 if i else 65535 for i in row] for row in inside]


def test_back_faces_take_the_back_color_when_lit_on_two_sides():
    target = render.Target(5, 5, 16)
    state = PassState(polygon=PolygonState(front_face=FrontFace.CW), color_sum=True)
    render.draw(target, quad([[FRONT, BACK]] * 4, two_side=True), state, {}, GEFORCE_256)
    assert target.color[2][2] == [50, 60, 70, 80]
    render.draw(target, quad([[FRONT, BACK]] * 4), state, {}, GEFORCE_256)
    assert target.color[2][2] == [11, 22, 33, 40]


def test_flat_shading_takes_the_provoking_vertex():
    target = render.Target(5, 5, 16)
    colors = [[[v] * 8, [v] * 8] for v in (10, 20, 30, 40)]
    state = PassState(polygon=PolygonState(shade_model=ShadeModel.FLAT))
    render.draw(target, quad(colors, triangles=[[0, 1, 2, 1], [0, 2, 3, 3]]), state, {}, GEFORCE_256)
    assert (target.color[3][3], target.color[1][1]) == ([20] * 4, [40] * 4)


def test_culled_and_scissored_triangles_draw_nothing():
    for state in (
        PassState(polygon=PolygonState(cull_face=Face.FRONT)),
        PassState(scissor=Scissor(0, 0, 1, 5)),
        PassState(depth_test=DepthTest(ComparisonFunction.GREATER)),
    ):
        target = render.Target(5, 5, 16)
        render.draw(target, quad([[FRONT, BACK]] * 4), state, {}, GEFORCE_256)
        assert target == render.Target(5, 5, 16)


def test_a_texture_reaches_the_combiners():
    image = texture([50])
    sampler = Sampler(min_filter=TextureFilter.NEAREST, mag_filter=TextureFilter.NEAREST)
    modulate = RGBPortion(
        a=CombinerInput(Register.TEXTURE0),
        b=CombinerInput(Register.PRIMARY_COLOR),
        sum_output=Register.SPARE0,
    )
    state = PassState(
        texture_units=(TextureUnit("gray", sampler),),
        register_combiners=RegisterCombiners(
            (GeneralCombiner(modulate),), constant_color0=(1.0, 1.0, 1.0, 1.0)
        ),
    )
    target = render.Target(5, 5, 16)
    render.draw(target, quad([[[255, 128, 0, 40, 0, 0, 0, 0]] * 2] * 4), state, {"gray": image}, GEFORCE_256)
    assert target.color[2][2] == [50, 25, 0, 40]


def test_fog_without_combiners_keeps_alpha():
    state = PassState(fog=Fog(FogMode.LINEAR, start=0.0, end=1.0, color=(1.0, 0.0, 0.0, 0.0)))
    target = render.Target(5, 5, 16)
    render.draw(target, quad([[FRONT, BACK]] * 4, fog=[0.5] * 4), state, {}, GEFORCE_256)
    # f = 128: (128*10 + 127*255)/255 = 132.02, 128*20/255 = 10.04, 128*30/255 = 15.06.
    assert target.color[2][2] == [132, 10, 15, 40]
