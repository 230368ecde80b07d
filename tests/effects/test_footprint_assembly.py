"""Footprint assembly (S02): directions, counts and edges of probes, and where they lie."""

import math

import numpy as np
import pytest

from fixedpipe.effects.texture_filtering.footprint_assembly import isotropic, probes
from fixedpipe.raster.columns.interpolate import probes_along


def one(across, up, most=8, **settings):
    found = probes(np.array(across, float), np.array(up, float), most, **settings)
    return tuple(found.direction), int(found.count), float(found.edge)


def test_probes_lie_along_the_longer_edge_and_cover_it():
    assert one((8.0, 0.0), (0.0, 2.0)) == ((8.0, 0.0), 4, 2.0)
    assert one((0.0, 2.0), (8.0, 0.0)) == ((8.0, 0.0), 4, 2.0)
    found = probes(np.array((8.0, 0.0)), np.array((0.0, 2.0)))
    assert [found.offsets(k)[0] for k in range(4)] == [-3.0, -1.0, 1.0, 3.0]


@pytest.mark.parametrize("most", [1, 2, 4, 8, 16])
def test_a_power_of_two_is_the_nearest_one_by_logarithm(most):
    for quotient in np.linspace(1.0, 40.0, 1171):
        expected = min(most, 2 ** math.floor(math.log2(quotient) + 0.5))
        _, count, edge = one((3.0 * quotient, 0.0), (0.0, 3.0), most)
        assert count == expected
        assert edge == pytest.approx(max(3.0, 3.0 * quotient / count if quotient > most else 3.0), rel=1e-12)


def test_an_exact_number_covers_the_edge_and_one_fewer_would_not():
    for quotient in np.linspace(1.01, 7.9, 200):
        _, count, edge = one((5.0 * quotient, 0.0), (0.0, 5.0), exact=True)
        assert (count - 1) * edge < 5.0 * quotient <= count * edge + 1e-12
    assert one((8.0 * 5.0, 0.0), (0.0, 5.0), 7, exact=True)[1:] == (7, 40.0 / 7.0)


@pytest.mark.parametrize("exact", [False, True])
def test_a_machine_s_unit_takes_as_many_probes(exact):
    random = np.random.default_rng(5)
    for most in (2, 4, 8) if not exact else (2, 3, 7, 8):
        across, up = random.uniform(-1.0, 1.0, (2, 4000, 2)) * 2.0 ** random.uniform(-3.0, 6.0, (2, 4000, 1))
        expected = probes(across, up, most, exact=exact, diagonals=False)
        squares = np.stack([(v * v).sum(axis=1) for v in (across, up)])
        count, square = probes_along(squares.max(axis=0), squares.min(axis=0), most, exact)
        np.testing.assert_array_equal(count, expected.count)
        assert set(count) == set(range(1, most + 1)) if exact else {1, most} <= set(count)
        if exact:  # a power of two is kept by the machine up to where it would be doubled
            np.testing.assert_allclose(np.maximum(np.sqrt(square), 1.0), expected.edge, rtol=1e-12)


def test_a_footprint_across_both_edges_is_narrow_by_its_diagonal():
    edge = np.array((8.0, 1.0)), np.array((-8.0, 1.0))
    assert one(*edge, diagonals=False)[1] == 1
    direction, count, width = one(*edge)
    assert (direction, count, width) == ((8.0, 1.0), 4, 2.0)


def test_a_magnified_texture_has_one_probe_of_a_texel():
    assert one((0.1, 0.0), (0.0, 0.05)) == ((0.1, 0.0), 1, 1.0)
    assert one((0.0, 0.0), (0.0, 0.0)) == ((0.0, 0.0), 1, 1.0)


def test_mip_mapping_takes_one_probe_as_wide_as_the_longer_edge():
    found = isotropic(np.array((3.0, 4.0)), np.array((1.0, 0.0)))
    assert (int(found.count), float(found.edge)) == (1, 5.0)
    assert not found.offsets(0).any()


@pytest.mark.parametrize(
    ("across", "up", "most", "words"),
    [
        ((1.0, math.nan), (0.0, 1.0), 8, "not finite"),
        ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), 8, "two vectors"),
        ((1.0, 0.0), ((0.0, 1.0), (1.0, 1.0)), 8, "two vectors"),
        ((1.0, 0.0), (0.0, 1.0), 0, "At most 0 probes"),
        ((1.0, 0.0), (0.0, 1.0), 6, "At most 6 probes"),
    ],
)
def test_what_is_no_footprint_is_refused(across, up, most, words):
    with pytest.raises(ValueError, match=words):
        probes(np.array(across), np.array(up), most)
