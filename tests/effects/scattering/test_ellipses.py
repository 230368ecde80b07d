"""Ellipses of free directions: the kernel beside a search in plain Python, what is analytic, curvature."""

import math
from itertools import pairwise

import numpy as np
import pytest

from fixedpipe.effects.acceptance import bump_shadows
from fixedpipe.effects.scattering import directions as sphere
from fixedpipe.effects.scattering import ellipses, height_field, visibility
from fixedpipe.effects.scattering.ellipses import LARGEST_RADIUS, LEAST_RADIUS
from fixedpipe.effects.scattering.visibility import BACK, FREE


def count_inside(points, center, axis, radii):
    """Free points less shadowed ones in an ellipse. ``points``: (x, y, a free one's weight or -1)."""
    total = 0
    for x, y, sign in points:
        u, v = x - center[0], y - center[1]
        along, across = axis[0] * u + axis[1] * v, axis[0] * v - axis[1] * u
        total += sign * ((along / radii[0]) ** 2 + (across / radii[1]) ** 2 <= 1.0)
    return total


def fitted_slowly(free, xy, weight=1):
    """Centre, axis, radii of one texel: moments by numpy's eigh, and every interval of radii asked for its
    middle.
    """
    points = [(x, y, weight if f else -1) for (x, y), f in zip(xy, free, strict=True)]
    inside = xy[free]
    center = inside.mean(axis=0)
    covariance = (inside - center).T @ (inside - center) / len(inside)
    values, vectors = np.linalg.eigh(covariance)
    axis = vectors[:, 1]
    axis = -axis if axis[0] < 0.0 else axis
    radii = [min(max(2.0 * math.sqrt(max(v, 0.0)), LEAST_RADIUS), LARGEST_RADIUS) for v in values[::-1]]
    for _ in range(4):
        for which in (0, 1):
            ends = {LEAST_RADIUS, LARGEST_RADIUS}
            for x, y, _ in points:
                u, v = x - center[0], y - center[1]
                frame = axis[0] * u + axis[1] * v, axis[0] * v - axis[1] * u
                left = 1.0 - (frame[1 - which] / radii[1 - which]) ** 2
                if left > 0.0 and LEAST_RADIUS < abs(frame[which]) / math.sqrt(left) < LARGEST_RADIUS:
                    ends.add(abs(frame[which]) / math.sqrt(left))
            ends, best = sorted(ends), (-1e9, 0.0, 0.0)
            for a, b in pairwise(ends):
                radii[which] = 0.5 * (a + b)
                count = count_inside(points, center, axis, radii)
                if b - a > 1e-12 and (count, round(b - a, 12)) > best[:2]:
                    best = count, round(b - a, 12), radii[which]
            radii[which] = best[2]
    return center, axis, radii


def upper(count):
    directions = sphere.spiral(count)
    return directions[directions[:, 2] > 0.0]


def random_texels(seed, xy, texels=40):
    """What is free of directions over which a random ridge or two stand: bool [n, 1, texels]."""
    random = np.random.default_rng(seed)
    out = []
    for _ in range(texels):
        free = np.ones(len(xy), bool)
        for _ in range(random.integers(1, 3)):
            angle = random.uniform(0.0, 2.0 * math.pi)
            free &= xy @ (math.cos(angle), math.sin(angle)) < random.uniform(-0.4, 0.9)
        free ^= random.random(len(xy)) < 0.04
        out.append(free)
    return np.array(out).T[:, None]


@pytest.mark.parametrize("weight", [1, 4])
def test_the_kernel_finds_what_a_slow_search_finds(weight):
    xy = upper(100)[:, :2]
    free = random_texels(3, xy)
    found = ellipses.fit(free, xy, free_weight=weight)
    worse = 0
    for k in range(free.shape[2]):
        if not free[:, 0, k].any():
            continue
        center, axis, radii = fitted_slowly(free[:, 0, k], xy, weight)
        np.testing.assert_allclose(found.center[0, k], center, atol=1e-12)
        np.testing.assert_allclose(found.axis[0, k], axis, atol=1e-9)
        points = [(x, y, weight if f else -1) for (x, y), f in zip(xy, free[:, 0, k], strict=True)]
        count = count_inside(points, found.center[0, k], found.axis[0, k], found.radii[0, k])
        slow = count_inside(points, center, axis, radii)
        assert count >= slow - weight
        worse += not np.allclose(found.radii[0, k], radii)
    # Ranges of the same width may be told apart by rounding.
    assert worse <= 2


def test_the_search_never_ends_below_where_it_begins():
    xy = upper(200)[:, :2]
    free = random_texels(8, xy)
    found = ellipses.fit(free, xy)
    for k in range(free.shape[2]):
        points = [(x, y, 1 if f else -1) for (x, y), f in zip(xy, free[:, 0, k], strict=True)]
        inside = xy[free[:, 0, k]]
        center, axis = found.center[0, k], found.axis[0, k]
        across = np.array((-axis[1], axis[0]))
        begin = [2.0 * math.sqrt(((inside - center) @ a).var()) for a in (axis, across)]
        begin = np.clip(begin, LEAST_RADIUS, LARGEST_RADIUS)
        assert count_inside(points, center, axis, found.radii[0, k]) >= count_inside(
            points, center, axis, begin
        )


def shut_out(free, xy, weight):
    """Of the directions that the second radius of every texel shuts out, how many are free, and all."""
    found = ellipses.fit(free, xy, free_weight=weight)
    wider = np.stack([found.radii[..., 0], np.full(found.radii.shape[:2], LARGEST_RADIUS)], axis=-1)
    wider = ellipses.Ellipses(found.center, found.axis, wider)
    lost, lost_free = (np.zeros(free.shape[1:]) for _ in range(2))
    for k, (x, y) in enumerate(xy):
        out = (found.test(x, y) < 0.0) & (wider.test(x, y) >= 0.0)
        lost += out
        lost_free += out & free[k]
    return lost_free, lost


@pytest.mark.parametrize("weight", [1, 3, 4, 16])
def test_of_what_a_radius_shuts_out_few_directions_are_free_by_their_weight(weight):
    xy = upper(200)[:, :2]
    lost_free, lost = shut_out(random_texels(8, xy), xy, weight)
    assert lost.sum() > 0
    # The radius searched last is the best there is, so shutting these out pays: w of them for each free one.
    assert (lost_free * (1 + weight) <= lost).all()


def test_a_larger_weight_shuts_out_less_in_vain():
    xy = upper(200)[:, :2]
    free = random_texels(8, xy)
    plain, weighted = (np.divide(*(n.sum() for n in shut_out(free, xy, weight))) for weight in (1, 4))
    assert weighted < 0.5 * plain


def test_the_paper_s_fit_is_the_plain_one():
    xy = upper(100)[:, :2]
    free = random_texels(5, xy)
    plain, one, four = ellipses.fit(free, xy), *(ellipses.fit(free, xy, free_weight=w) for w in (1.0, 4.0))
    np.testing.assert_array_equal(one.radii, plain.radii)
    assert (four.radii != plain.radii).any()
    # The weight moves the radii alone.
    np.testing.assert_array_equal(four.center, plain.center)
    np.testing.assert_array_equal(four.axis, plain.axis)


@pytest.mark.parametrize("weight", [0.5, 17.0, math.nan, math.inf])
def test_a_weight_beyond_its_range_is_refused(weight):
    xy = upper(100)[:, :2]
    with pytest.raises(ValueError, match=r"shadowed ones; give a number from 1 to 16"):
        ellipses.fit(random_texels(5, xy), xy, free_weight=weight)


def test_a_free_texel_s_ellipse_holds_the_disc():
    xy = upper(100)[:, :2]
    found = ellipses.fit(np.ones((len(xy), 2, 2), bool), xy)
    rim = np.linspace(0.0, 2.0 * math.pi, 64)
    for radius in (0.0, 0.5, 1.0):
        for angle in rim:
            assert (found.test(radius * math.cos(angle), radius * math.sin(angle)) > 0.0).all()


def test_a_texel_without_a_free_direction_is_lit_from_nowhere():
    xy = upper(100)[:, :2]
    found = ellipses.fit(np.zeros((len(xy), 1, 1), bool), xy)
    grid = np.linspace(-1.0, 1.0, 41)
    x, y = np.meshgrid(grid, grid)
    for pair in (ellipses.packed(found), ellipses.rooted(found)):
        values = ellipses.tested(*pair, x, y)
        # Outside by more than a byte's rounding of half of each number.
        assert values[x * x + y * y <= 1.0].max() < -1.0
        assert max(np.abs(form).max() for form in pair) <= 2.0


def test_all_numbers_can_be_stored_as_quarters():
    field = height_field.bumps(32, 32, height=0.5)
    found = ellipses.of_visibility(visibility.precompute(field, sphere.spiral(100)))
    for pair in (ellipses.packed(found), ellipses.rooted(found)):
        assert max(np.abs(form).max() for form in pair) <= 4.0
    assert found.stored_bytes == 6144


def test_no_radius_is_below_the_least():
    field = height_field.bumps(32, 32, height=0.5)
    seen = visibility.precompute(field, sphere.spiral(100))
    assert ellipses.of_visibility(seen).radii.min() < 0.5
    found = ellipses.of_visibility(seen, least_radius=0.5)
    assert found.radii.min() >= 0.5
    assert max(np.abs(form).max() for form in ellipses.rooted(found)) <= 2.0
    with pytest.raises(ValueError, match=r"least radius is 0\.1; give a number from 0\.25 to 1"):
        ellipses.of_visibility(seen, least_radius=0.1)


def test_both_ways_to_pack_are_one_test():
    field = height_field.domes(16, 16)
    found = ellipses.of_visibility(visibility.precompute(field, sphere.spiral(100)))
    for x, y in ((0.0, 0.0), (0.6, -0.3), (-0.1, 0.9)):
        a, b = (ellipses.tested(*pair, x, y) for pair in (ellipses.packed(found), ellipses.rooted(found)))
        np.testing.assert_allclose(a, b, atol=1e-9)
        c, s = found.axis[..., 0], found.axis[..., 1]
        u, v = x - found.center[..., 0], y - found.center[..., 1]
        along, across = (c * u + s * v) / found.radii[..., 0], (c * v - s * u) / found.radii[..., 1]
        np.testing.assert_allclose(a, 1.0 - along**2 - across**2, atol=1e-9)


def test_the_root_changes_smoothly_where_the_axis_turns_back():
    """An axis that turns through the vertical changes its sign; the mean of its forms lets all light in."""
    turns = np.linspace(80.0, 100.0, 9)
    axis = np.array([[(math.cos(math.radians(t)), math.sin(math.radians(t))) for t in turns]])
    axis = np.where(axis[..., :1] < 0.0, -axis, axis)
    center = np.tile((0.3, 0.0), (1, len(turns), 1))
    found = ellipses.Ellipses(center, axis, np.tile((1.2, 0.4), (1, len(turns), 1)))
    steps = [
        max(np.abs(np.diff(form, axis=1)).max() for form in pair)
        for pair in (ellipses.packed(found), ellipses.rooted(found))
    ]
    assert steps[0] > 1.5
    assert steps[1] < 0.1
    # Between the neighbours a direction that both ellipses refuse.
    for pair, leaks in ((ellipses.packed(found), True), (ellipses.rooted(found), False)):
        between = [0.5 * (form[:, 4] + form[:, 5]) for form in pair]
        assert bool((ellipses.tested(*between, -0.6, 0.0) > 0.0).all()) is leaks


@pytest.mark.parametrize(("angle", "count"), [(30.0, 100), (45.0, 100), (60.0, 200)])
def test_v_grooves_have_nine_of_ten_directions_on_their_side(angle, count):
    """F002-6's acceptance, over all texels."""
    field = height_field.ridges(32, 32, angle)
    seen = visibility.precompute(field, sphere.spiral(count))
    found = ellipses.of_visibility(seen)
    right, asked = 0, 0
    for i, (x, y, z) in enumerate(seen.directions):
        if z <= 0.0:
            continue
        counts = seen.seen[i] != BACK
        right += int(((found.test(x, y) >= 0.0) == (seen.seen[i] == FREE))[counts].sum())
        asked += int(counts.sum())
    assert right / asked >= 0.9


def test_axes_are_brought_in_line():
    random = np.random.default_rng(1)
    angle = random.uniform(0.0, 2.0 * math.pi, (4, 4))
    axis = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    one = ellipses.Ellipses(random.uniform(-0.3, 0.3, (4, 4, 2)), axis, random.uniform(0.3, 1.5, (4, 4, 2)))
    quarter = np.stack([-axis[..., 1], axis[..., 0]], axis=-1)
    for same in (
        ellipses.Ellipses(one.center, -one.axis, one.radii),
        ellipses.Ellipses(one.center, quarter, one.radii[..., ::-1]),
        ellipses.Ellipses(one.center, -quarter, one.radii[..., ::-1]),
    ):
        line = ellipses.aligned(same, one)
        np.testing.assert_allclose(line.axis, one.axis, atol=1e-12)
        np.testing.assert_allclose(line.radii, one.radii)
        np.testing.assert_allclose(line.test(0.3, 0.2), one.test(0.3, 0.2))


@pytest.mark.parametrize("pack", [ellipses.packed, ellipses.rooted])
def test_curvature_is_linear_and_none_is_the_flat_ellipse(pack):
    xy = upper(100)[:, :2]
    free = random_texels(2, xy, texels=6)
    flat = ellipses.fit(free, xy)
    moved = [ellipses.fit(free, xy * s) for s in (0.95, 1.05, 0.98, 1.02)]
    pairs = (moved[0], moved[1]), (moved[2], moved[3])
    none = ellipses.curved(flat, *pairs, 0.1, 0.0, 0.0, pack)
    for got, form in zip(none, pack(flat), strict=True):
        np.testing.assert_array_equal(got, form)
    one, two = (ellipses.curved(flat, *pairs, 0.1, k, -0.5 * k, pack) for k in (0.05, 0.1))
    for k, (a, b) in enumerate(zip(one, two, strict=True)):
        np.testing.assert_allclose(b - pack(flat)[k], 2.0 * (a - pack(flat)[k]), atol=1e-12)
    with pytest.raises(ValueError, match="step of curvature is 0"):
        ellipses.curved(flat, *pairs, 0.0, 0.1, 0.0)


def test_directions_of_every_texel_s_own():
    xy = upper(100)[:, :2]
    free = random_texels(5, xy, texels=3)
    everywhere = np.broadcast_to(xy[:, None, None], (*free.shape, 2))
    one, other = ellipses.fit(free, xy), ellipses.fit(free, everywhere)
    for name in ("center", "axis", "radii"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


def test_what_does_not_count_takes_no_part():
    xy = upper(100)[:, :2]
    free = random_texels(6, xy, texels=4)
    counted = xy[:, 0] > -0.3
    some = ellipses.fit(free[counted], xy[counted])
    same = ellipses.fit(
        free & counted[:, None, None], xy, np.broadcast_to(counted[:, None, None], free.shape)
    )
    np.testing.assert_array_equal(some.radii, same.radii)
    np.testing.assert_array_equal(some.center, same.center)


def test_bad_input_is_said():
    down = sphere.spiral(20)
    field = height_field.domes(8, 8, 1)
    seen = visibility.precompute(field, down[down[:, 2] < 0.0])
    with pytest.raises(ValueError, match="0 of the directions lie above the horizon"):
        ellipses.of_visibility(seen)
    xy = upper(20)[:, :2]
    free = np.ones((len(xy), 2, 2), bool)
    for arguments, match in (
        ((free[0], xy), r"shape \(2, 2\); give \[n, rows, columns\]"),
        ((free, xy[1:]), "as many as there are"),
        ((free[:, :0], xy), "What is free has shape"),
        ((free, np.where(xy > 0.5, np.nan, xy)), "NaN or infinity"),
        ((free[:2], xy[:2]), "2 of the directions"),
    ):
        with pytest.raises(ValueError, match=match):
            ellipses.fit(*arguments)


def test_smoothed_forms_are_means_of_neighbours_and_agree_better():
    field = height_field.bumps(32, 32, height=0.24)
    forms = ellipses.rooted(ellipses.of_visibility(visibility.precompute(field, sphere.spiral(100))))
    for form, same in zip(forms, ellipses.smoothed(forms, 0), strict=True):
        np.testing.assert_array_equal(form, same)
    weights = np.array((1.0, 2.0, 1.0)) / 4.0
    wrapped = np.pad(forms[0], ((1, 1), (1, 1), (0, 0)), mode="wrap")
    expected = sum(
        weights[j] * weights[i] * wrapped[j : j + 32, i : i + 32] for j in range(3) for i in range(3)
    )
    smooth = ellipses.smoothed(forms)
    np.testing.assert_allclose(smooth[0], expected, atol=1e-12)
    assert max(np.abs(form).max() for form in smooth) <= max(np.abs(form).max() for form in forms)
    ways = {
        name: lambda light, pair=pair: ellipses.tested(*pair, light[0], light[1]) >= 0.0
        for name, pair in (("as fitted", forms), ("smooth", smooth))
    }
    found = bump_shadows.agreement(field, ways)
    assert found["smooth"] > found["as fitted"]


def test_a_direction_from_which_a_texel_is_turned_away_counts_where_it_is_asked_to():
    field = height_field.ridges(16, 4, 60.0, 1)
    seen = visibility.precompute(field, sphere.spiral(100))
    up = seen.directions[:, 2] > 0.0
    free, xy = seen.seen[up] == FREE, seen.directions[up, :2]
    for counts, counted in ((True, None), (False, seen.seen[up] != BACK)):
        found, expected = ellipses.of_visibility(seen, counts), ellipses.fit(free, xy, counted)
        np.testing.assert_array_equal(found.radii, expected.radii)
    assert (ellipses.of_visibility(seen, True).radii != ellipses.of_visibility(seen).radii).any()
