"""S_i: rays against every triangle in exact arithmetic, any executor, and codes that are read back."""

from concurrent.futures import ProcessPoolExecutor
from fractions import Fraction
from math import floor

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fixedpipe.effects.scattering import directions as sphere
from fixedpipe.effects.scattering import height_field, visibility, visibility_textures
from fixedpipe.effects.scattering.visibility import BACK, FREE


def seen_by_triangles(heights, row, column, direction, tiles=3):
    """The texel that a ray from a vertex hits, by asking every triangle of the tiles around; exact.

    Returns also whether another answer is as good: a ray along a face or through an edge of a triangle that
    only touches it.
    """
    rows, columns = heights.shape
    dx, dy, dz = (Fraction(c) for c in (direction[0] * columns, direction[1] * rows, direction[2]))
    z0, best, doubtful = Fraction(heights[row, column]), None, False
    for j in range(-tiles * rows, tiles * rows):
        for i in range(-tiles * columns, tiles * columns):
            h = [
                Fraction(heights[(row + j + b) % rows, (column + i + a) % columns])
                for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))
            ]
            for upper in (False, True):
                slope_x, slope_y = (h[2] - h[3], h[3] - h[0]) if upper else (h[1] - h[0], h[2] - h[1])
                # Above the plane by z0 + t dz - h00 - slope (t d - (i, j)), which is 0 at t.
                rate = dz - slope_x * dx - slope_y * dy
                at_start = z0 - h[0] + slope_x * i + slope_y * j
                # The interval of t in which the ray is over the triangle.
                edges = [(dx, -i), (dy, -j), (-dx, i + 1), (-dy, j + 1)]
                edges.append((dy - dx, i - j) if upper else (dx - dy, j - i))
                first, last = Fraction(0), None
                for slope, offset in edges:
                    if slope == 0:
                        if offset < 0:
                            first, last = Fraction(1), Fraction(0)
                    elif slope > 0:
                        first = max(first, -offset / slope)
                    else:
                        bound = offset / -slope
                        last = bound if last is None else min(last, bound)
                if last is None or first >= last:
                    continue
                above_first, above_last = at_start + rate * first, at_start + rate * last
                if above_last < 0 <= above_first:
                    # Where it begins on the vertex and is below at once, the far edge is seen.
                    t = last if first == 0 and above_first == 0 else at_start / -rate
                    entry = first if t == last else t
                    if best is None or entry < best[0]:
                        best = entry, t
                elif above_first < 0 and first == 0:
                    doubtful = True
                elif above_first == 0 or above_last == 0:
                    doubtful = doubtful or first > 0
    if best is None:
        return FREE, doubtful
    t = best[1]
    x, y = column + t * dx, row + t * dy
    half = Fraction(1, 2)
    doubtful = doubtful or (x + half).denominator == 1 or (y + half).denominator == 1
    return floor(y + half) % rows * columns + floor(x + half) % columns, doubtful


@settings(max_examples=40)
@given(st.data())
def test_rays_see_what_every_triangle_says(data):
    rows, columns = data.draw(st.sampled_from([(2, 2), (3, 4), (4, 3)]))
    eighths = st.integers(0, 16).map(lambda n: n / 16)
    heights = np.array(
        data.draw(st.lists(eighths, min_size=rows * columns, max_size=rows * columns))
    ).reshape(rows, columns)
    part = st.integers(-7, 7)
    direction = data.draw(st.tuples(part, part, st.integers(-8, 8)).filter(lambda d: d[0] or d[1]))
    # Steep enough that three tiles around hold all that is seen.
    direction = (direction[0], direction[1], direction[2] + (4 if direction[2] >= 0 else -4))
    most = visibility.MOST_TILES * 3 * (rows + columns)
    for row in range(rows):
        for column in range(columns):
            expected, doubtful = seen_by_triangles(heights, row, column, direction)
            x, y, z = (float(c) for c in direction)
            found = visibility._seen(heights, column, row, x * columns, y * rows, z, heights.max(), most)
            if not doubtful:
                assert found == expected, (heights, row, column, direction)


def test_valleys_of_ridges_see_the_flank_across():
    field = height_field.ridges(32, 32)
    level = visibility.precompute(field, [(1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, -1.0)])
    columns = level.seen[0] % 32
    # The flank that faces -s looks away from +s; the other sees the flank across, as high as itself.
    facing = field.normals[0, :, 0] > 0
    assert (level.seen[0][:, ~facing] == BACK).all()
    below = facing & (field.heights[0] < field.heights.max())
    for column in np.flatnonzero(below):
        assert (np.abs(field.heights[0, columns[:, column]] - field.heights[0, column]) < 1e-12).all()
        assert (level.seen[0][:, column] // 32 == np.arange(32)).all()
    assert (level.seen[1] == FREE).all()
    assert (level.seen[2] == BACK).all()


def test_any_executor_gives_the_same():
    field, found = height_field.domes(16, 16, 2), sphere.spiral(11)
    expected = visibility.precompute(field, found)
    with ProcessPoolExecutor(2) as processes:
        told = []
        again = visibility.precompute(field, found, processes, told.append)
    assert (again.seen == expected.seen).all()
    assert told == [4, 8, 11]


def test_the_paper_counts_two_bytes_a_texel_and_direction():
    field = height_field.ridges(32, 32)
    assert visibility.precompute(field, sphere.spiral(100)).stored_bytes == 204_800


def test_level_rays_along_grooves_end():
    field = height_field.ridges(8, 8, count=1)
    assert (visibility.precompute(field, [(0.0, 1.0, 0.0)]).seen == BACK).all()
    flat = height_field.height_field(np.zeros((4, 4)))
    assert (visibility.precompute(flat, [(0.6, 0.7, 1e-9)]).seen == FREE).all()


@pytest.mark.parametrize("bits", [8, 12, 16])
def test_every_code_leads_back(bits):
    for edge in [1, 2, 3, 31, 32, 33, 64, 127, 128, 129, 200, 255, 1000, 4095, 65535]:
        if edge >= 1 << bits:
            with pytest.raises(ValueError, match=rf"at most {(1 << bits) - 1} texels along each edge"):
                visibility_textures.looked_up_size(edge, bits)
            continue
        size = visibility_textures.looked_up_size(edge, bits)
        texels = np.arange(edge)
        stored = visibility_textures.codes(texels, size, bits)
        assert stored.max() < 1 << bits
        assert (visibility_textures.decoded(stored, size, bits) == texels).all()
        assert visibility_textures.decoded((1 << bits) - 1, size, bits) >= edge


def test_a_textures_codes_say_what_is_seen():
    field = height_field.domes(24, 16, 2)
    for seen in visibility.precompute(field, sphere.spiral(12)).seen:
        stored = visibility_textures.coordinates(seen)
        back = visibility_textures.texels_seen(stored, 16, 24)
        assert (back == np.maximum(seen, -1)).all()


def test_light_beyond_the_field_is_nothing():
    light = np.full((3, 5, 3), 7, np.uint8)
    texture = visibility_textures.padded(light, 9)
    assert texture.shape == (4, 8, 3)
    assert (texture[:3, :5] == 7).all()
    assert (texture[3:] == 9).all() and (texture[:, 5:] == 9).all()
