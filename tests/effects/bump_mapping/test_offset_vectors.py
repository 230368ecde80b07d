"""S12 to S15: Blinn's normal in three frames, what lies between vertices, and bytes."""

import math

import numpy as np
import pytest

from fixedpipe.effects.bump_mapping import offset_vectors as frames
from fixedpipe.effects.bump_mapping.tangent_space import displaced_normals
from fixedpipe.effects.geometry.surfaces import sphere_frames
from fixedpipe.effects.geometry.vectors import cross, dot, normalize

RANDOM = np.random.default_rng(1)


def derivatives(count=200):
    """p_u, p_v of any lengths and angles, f_u and f_v."""
    p_u, p_v = RANDOM.normal(size=(2, count, 3)) * RANDOM.uniform(0.2, 5.0, (2, count, 1))
    return p_u, p_v, RANDOM.normal(size=(count, 2))


def test_the_natural_frame_gives_the_normal_of_the_displaced_surface():
    p_u, p_v, f = derivatives()
    bumped = normalize(frames.bumped(frames.natural(p_u, p_v), f))
    np.testing.assert_allclose(bumped, displaced_normals(p_u, p_v, f[:, 0], f[:, 1]), atol=1e-12)


def test_the_offset_is_the_cross_product_of_the_displaced_steps():
    p_u, p_v, f = derivatives()
    up = normalize(cross(p_u, p_v))
    steps = cross(p_u + f[:, :1] * up, p_v + f[:, 1:] * up)
    np.testing.assert_allclose(frames.bumped(frames.natural(p_u, p_v), f), steps, atol=1e-12)


def test_where_a_map_is_mirrored_bumps_stand_out_of_the_surface_too():
    p_u, p_v, f = derivatives()
    outward = normalize(cross(p_u, p_v))
    mirrored = frames.natural(p_v, p_u, outward)
    np.testing.assert_allclose(
        frames.bumped(mirrored, f[:, ::-1]), frames.bumped(frames.natural(p_u, p_v), f), atol=1e-12
    )
    np.testing.assert_array_equal(frames.natural(p_u, p_v, outward).first, frames.natural(p_u, p_v).first)


def displaced_sphere(u, v, height):
    """A point of the unit sphere, ``height(u, v)`` above it."""
    normal, _, _ = sphere_frames(np.asarray(u), np.asarray(v))
    return normal * (1.0 + height(u, v))[..., None]


def test_bumps_of_a_sphere_by_differences_of_its_displaced_points():
    def height(u, v):
        return 1e-3 * np.sin(2.0 * np.pi * 7.0 * u) * np.cos(2.0 * np.pi * 3.0 * v)

    u, v, step = RANDOM.uniform(0.1, 0.9, 50), RANDOM.uniform(0.2, 0.8, 50), 2.0**-8
    along = displaced_sphere(u + step, v, height) - displaced_sphere(u - step, v, height)
    up = displaced_sphere(u, v + step, height) - displaced_sphere(u, v - step, height)
    expected = normalize(cross(along, up))
    _, tangents, binormals = sphere_frames(u, v)
    p_u = tangents * (2.0 * np.pi * np.cos(np.pi * (v - 0.5)))[:, None]
    f = np.stack(
        [
            (height(u + step, v) - height(u - step, v)) / (2.0 * step),
            (height(u, v + step) - height(u, v - step)) / (2.0 * step),
        ],
        axis=-1,
    )
    found = normalize(frames.bumped(frames.natural(p_u, np.pi * binormals), f))
    assert np.abs(found - expected).max() < 3e-3


def slope(frame, offsets):
    """How steep bumps are: what is added over the normal's length."""
    added = frames.bumped(frame, offsets) - frame.normal
    return np.sqrt(dot(added, added) / dot(frame.normal, frame.normal))


def test_scaled_maps_keep_heights_in_the_natural_frame_and_slopes_in_unit_vectors():
    p_u, p_v, f = derivatives()
    f[:, 1] = 0.0
    thrice = p_u / 3.0, p_v / 3.0
    np.testing.assert_allclose(
        slope(frames.natural(*thrice), f), 3.0 * slope(frames.natural(p_u, p_v), f), rtol=1e-12
    )
    np.testing.assert_allclose(slope(frames.normalized(*thrice), f), np.abs(f[:, 0]), rtol=1e-12)


def test_a_globes_first_direction_points_east():
    s, t = RANDOM.uniform(0.0, 1.0, 100), RANDOM.uniform(0.05, 0.95, 100)
    normals, east, north = sphere_frames(s, t)
    frame = frames.of_main_direction(normals, (0.0, 1.0, 0.0))
    # The sphere's own sines are rounded to 2**-20.
    np.testing.assert_allclose(frame.first, east, atol=4e-6)
    np.testing.assert_allclose(frame.second, north, atol=4e-6)
    longitude = 2.0 * math.pi * (s - 0.5)
    exact = np.stack([np.sin(longitude), 0.0 * s, np.cos(longitude)], axis=-1)
    exact = frames.of_main_direction(exact + np.array([0.0, 0.7, 0.0]), (0.0, 2.0, 0.0)).first
    assert np.abs(exact[:, 0] - np.cos(longitude)).max() < 1e-12
    assert np.abs(exact[:, 1]).max() == 0.0


def test_the_frame_is_orthonormal_and_its_first_vector_perpendicular_to_m():
    normals, main = RANDOM.normal(size=(2, 100, 3))
    frame = frames.of_main_direction(normals, main)
    for a, b in ((frame.first, frame.normal), (frame.second, frame.normal), (frame.first, frame.second)):
        assert np.abs(dot(a, b)).max() < 1e-14
    assert np.abs(dot(frame.first, main)).max() < 1e-14
    for vectors in (frame.normal, frame.first, frame.second):
        np.testing.assert_allclose(dot(vectors, vectors), 1.0, rtol=1e-14)
    # e_2 lies in the plane of n and m: m has nothing along e_1, and something along e_2.
    assert (dot(frame.second, main) > 0.0).all()


def test_without_normalization_all_three_are_as_long_as_the_normal():
    normals, main = RANDOM.normal(size=(2, 100, 3))
    unit, long = (frames.of_main_direction(normals, main, unit=u) for u in (True, False))
    length = np.sqrt(dot(normals, normals))[:, None]
    for name in ("normal", "first", "second"):
        np.testing.assert_allclose(getattr(long, name), getattr(unit, name) * length, atol=1e-14)
    offsets = RANDOM.normal(size=(100, 2))
    np.testing.assert_allclose(
        normalize(frames.bumped(long, offsets)), normalize(frames.bumped(unit, offsets)), atol=1e-14
    )


def test_offsets_along_the_frame_are_slopes_with_their_signs_turned():
    # A square whose u and v are its axes: bumps, no dents.
    p_u, p_v = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
    f = np.array([0.3, -0.2])
    frame = frames.of_main_direction(np.array([0.0, 0.0, 1.0]), (0.0, 1.0, 0.0))
    np.testing.assert_array_equal(frame.first, p_u)
    np.testing.assert_array_equal(
        frames.bumped(frame, frames.along_frame(f)), frames.bumped(frames.natural(p_u, p_v), f)
    )
    assert frames.bumped(frame, frames.along_frame(f))[0] == -0.3


def test_where_m_lies_along_the_normal_bumps_vanish():
    frame = frames.of_main_direction(np.array([[0.0, 2.0, 0.0]]), (0.0, 1.0, 0.0))
    np.testing.assert_array_equal(frames.bumped(frame, [[0.5, 0.5]]), [[0.0, 1.0, 0.0]])


@pytest.mark.parametrize("main", [(0.0, 0.0, 0.0), (math.nan, 0.0, 1.0), (1.0, 2.0)])
def test_no_main_direction(main):
    with pytest.raises(ValueError, match=r"main direction .* give a direction"):
        frames.of_main_direction(np.array([[0.0, 0.0, 1.0]]), main)
    with pytest.raises(ValueError, match="main direction"):
        frames.main_direction(main)


def test_no_normal():
    with pytest.raises(ValueError, match="A normal is zero"):
        frames.of_main_direction(np.zeros((2, 3)), (0.0, 1.0, 0.0))


@pytest.mark.parametrize(("first", "second"), [(4.0, 1.0), (1.0, 3.0), (2.0, 2.0)])
def test_half_way_straight_vectors_lag_and_apart_they_do_not(first, second):
    for angle in (0.2, 1.0, 2.5):
        a = np.array([math.cos(angle / 2.0), math.sin(angle / 2.0), 0.0])
        vectors = np.stack([first * a, second * a * [1.0, -1.0, 1.0]])
        x, y, _ = frames.straight(vectors, [0.5, 0.5])
        assert math.atan2(y, x) == pytest.approx(frames.middle_error(first, second, angle), abs=1e-12)
        middle = frames.apart(vectors, [0.5, 0.5])
        assert middle[1] == pytest.approx(0.0, abs=1e-15)
        assert middle[0] == pytest.approx(0.5 * (first + second))


def test_directions_need_no_division_by_w():
    vectors, weights = RANDOM.normal(size=(50, 3, 3)), RANDOM.dirichlet((1.0, 1.0, 1.0), 50)
    depths = RANDOM.uniform(1.0, 5.0, (50, 3))
    right = weights / depths / (weights / depths).sum(axis=1, keepdims=True)
    np.testing.assert_allclose(
        frames.apart(vectors, weights, depths), frames.apart(vectors, right), atol=1e-12
    )


@pytest.mark.parametrize("given", [(0.0, 1.0, 0.1), (1.0, -1.0, 0.1), (1.0, 1.0, math.pi)])
def test_vectors_with_no_direction_between_them(given):
    with pytest.raises(ValueError, match="positive lengths"):
        frames.middle_error(*given)


def test_signed_bytes():
    offsets = RANDOM.uniform(-1.7, 1.7, (8, 8, 2))
    scale = frames.largest(offsets)
    codes = frames.signed_bytes(offsets, scale)
    assert codes.dtype == np.int8
    assert np.abs(codes).max() == 127
    assert np.abs(frames.of_bytes(codes, scale) - offsets).max() <= scale / 254.0 + 1e-15
    assert (frames.signed_bytes([[9.0, -9.0]], 1.0) == [[127, -127]]).all()
    assert frames.largest(np.zeros((2, 2, 2))) == 1.0
    for bad in (0.0, -1.0, math.nan, math.inf):
        with pytest.raises(ValueError, match="above zero"):
            frames.signed_bytes(offsets, bad)


def test_derivatives_of_heights():
    heights = np.zeros((4, 8))
    heights[:, 3] = 0.5
    f = frames.of_heights(heights)
    assert f.shape == (4, 8, 2)
    assert f[0, 2, 0] == 2.0
    assert f[0, 4, 0] == -2.0
    assert (f[..., 1] == 0.0).all()
