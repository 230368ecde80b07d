"""What a simulated BRDF is kept as: a dense grid, harmonics, a MERL table."""

import math
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.scattering import dense_brdf, goniometer, harmonics, merl
from fixedpipe.effects.scattering.directions import spiral
from fixedpipe.effects.scattering.height_field import bumps, height_field, ridges
from fixedpipe.effects.scattering.visibility import precompute

DIRECTIONS = spiral(100)
ALBEDO = (0.8, 0.5, 0.1)


def upper_pairs(count, least=0.1):
    towards, views = harmonics.random_pairs(4 * count, 3)
    kept = (towards[:, 2] > least) & (views[:, 2] > least)
    return towards[kept][:count], views[kept][:count]


def simulated(field, count=8, **more):
    return dense_brdf.simulated(field, precompute(field, DIRECTIONS), count, **more)


def test_a_flat_field_is_one_number_in_every_form():
    field = height_field(np.zeros((4, 4)), ALBEDO)
    expected = np.array(ALBEDO) / math.pi
    towards, views = upper_pairs(50)
    dense = simulated(field, 4)
    assert np.abs(dense.at(towards, views) - expected).max() < 1e-12
    assert np.abs(dense.isotropic().samples - expected).max() < 1e-12
    found = harmonics.fitted(*harmonics.sampled(field, precompute(field, DIRECTIONS), 300))
    assert np.abs(found.at(towards, views) / expected - 1.0).max() < 0.01
    numbers = merl.read(merl.data(merl.table(dense.isotropic())))
    assert np.abs(merl.looked_up(numbers, towards, views) - expected).max() < 1e-12


def test_the_grid_is_what_the_goniometer_says_and_linear_between():
    field = ridges(16, 2, 45.0, 1)
    dense = simulated(field, 4)
    directions, _ = goniometer.grid(4)
    exact = goniometer.brdf(field, precompute(field, DIRECTIONS), directions, directions)
    assert np.array_equal(dense.samples.reshape(16, 16, 3), exact)
    pairs = np.repeat(directions, 16, axis=0), np.tile(directions, (16, 1))
    assert np.abs(dense.at(*pairs) - exact.reshape(-1, 3)).max() < 1e-4
    ramp = np.zeros((4, 4, 4, 4, 3)) + (np.arange(4.0) + 0.5)[:, None, None, None, None] / 4.0
    towards, views = upper_pairs(40, 0.15)
    kept = towards[:, 2] < 0.85
    found = dense_brdf.DenseBRDF(ramp).at(towards[kept], views[kept])
    assert np.abs(found - towards[kept, 2:]).max() < 1e-9


def test_turned_at_random_it_depends_on_the_difference_of_angles_alone():
    found = simulated(ridges(16, 2, 45.0, 1), 6).isotropic()
    assert np.abs(np.roll(found.samples, (2, 2), (1, 3)) - found.samples).max() < 1e-12
    assert np.abs(found.samples - found.samples.transpose(2, 3, 0, 1, 4)).max() == 0.0


def test_pieces_are_kept_and_any_executor_gives_the_same(tmp_path):
    field = bumps(8, 8)
    whole = simulated(field, 4)
    steps = []
    with ThreadPoolExecutor(2) as threads:
        again = simulated(field, 4, folder=tmp_path, executor=threads, progress=steps.append)
    assert np.array_equal(whole.samples, again.samples)
    assert steps == [0, 1, 2, 3, 4]
    assert np.array_equal(simulated(field, 4, folder=tmp_path).samples, whole.samples)
    with pytest.raises(Refusal, match=r"other parameters \(albedo\)"):
        simulated(field.with_albedo(0.5), 4, folder=tmp_path)


def test_harmonics_are_orthonormal():
    directions, solid_angles = goniometer.grid(64)
    values = harmonics.basis(np.concatenate([directions, directions * [1.0, 1.0, -1.0]]))
    found = (values[:, :, None] * values[:, None, :]).sum(axis=0) * solid_angles[0]
    assert np.abs(found - np.eye(16)).max() < 2e-3


def test_a_sum_of_harmonics_is_found_again():
    towards, views = harmonics.random_pairs(2000)
    # Symmetric in light and view, and without the part that one hemisphere cannot tell.
    y_l, y_v = harmonics.basis(towards), harmonics.basis(views)
    samples = (0.3 + 0.1 * y_l[:, 1] * y_v[:, 1] + 0.05 * y_l[:, 7] * y_v[:, 7])[:, None] * np.ones(3)
    found = harmonics.fitted(towards, views, samples, 1e-9)
    assert np.abs(found.at(*upper_pairs(100)) - samples.mean()).max() < 0.5
    at = upper_pairs(100, 0.3)
    l_at, v_at = harmonics.basis(at[0]), harmonics.basis(at[1])
    expected = 0.3 + 0.1 * l_at[:, 1] * v_at[:, 1] + 0.05 * l_at[:, 7] * v_at[:, 7]
    assert np.abs(found.at(*at)[:, 0] - expected).max() < 1e-3


def test_some_hundred_samples_are_near_the_dense_grid():
    field = bumps(32, 32)
    seen = precompute(field, DIRECTIONS)
    found = harmonics.fitted(*harmonics.sampled(field, seen, 512))
    at = upper_pairs(400, 0.2)
    # Light that is sent back: f_r times both cosines.
    sent = at[0][:, 2:] * at[1][:, 2:]
    dense = sent * dense_brdf.simulated(field, seen, 16).at(*at)
    error = sent * found.at(*at) - dense
    # Measured: 0.047.
    assert np.sqrt((error * error).mean()) / dense.mean() < 0.07
    assert np.abs(found.at(*at) - found.at(*at[::-1])).max() < 1e-3


def test_what_cannot_be_fitted_is_refused():
    towards, views = harmonics.random_pairs(20)
    with pytest.raises(ValueError, match="one for each pair"):
        harmonics.fitted(towards, views, np.zeros((19, 3)))
    with pytest.raises(ValueError, match="finite ones"):
        harmonics.fitted(towards, views, np.full((20, 3), np.nan))
    with pytest.raises(ValueError, match="give a positive number"):
        harmonics.fitted(towards, views, np.zeros((20, 3)), 0.0)


def test_a_merl_table_s_directions_have_its_angles():
    towards, views = merl.directions()
    half = towards + views
    half /= np.sqrt((half * half).sum(axis=-1))[:, None]
    at = np.ravel_multi_index((30, 20, 45), (merl.HALF, merl.DIFFERENCE, merl.AZIMUTH))
    angle = math.degrees(math.acos(half[at, 2]))
    assert angle == pytest.approx(90.0 * (30.5 / 90.0) ** 2, abs=1e-3)
    assert math.degrees(math.acos((half[at] * towards[at]).sum())) == pytest.approx(20.5, abs=1e-3)
    assert np.abs((towards * towards).sum(axis=-1) - 1.0).max() < 1e-5


def test_a_merl_file_is_read_back_where_it_was_written():
    class Lobe:
        """Something that depends on every angle."""

        def at(self, towards, views):
            half = towards + views
            half = half / np.sqrt((half * half).sum(axis=-1))[:, None]
            found = half[:, 2] ** 4 * (half * towards).sum(axis=-1) + 0.1 * towards[:, 2] * views[:, 2]
            return found[:, None] * np.array([1.0, 0.5, 0.25])

    contents = merl.data(merl.table(Lobe()))
    numbers = merl.read(contents)
    at = upper_pairs(300)
    found = merl.looked_up(numbers, *at)
    # The nearest number of the table: its steps are a degree and more.
    assert np.abs(found - Lobe().at(*at)).max() < 0.05
    assert len(contents) == 3 * 4 + 3 * 8 * 90 * 90 * 180
    assert (numbers == merl.BELOW).any() and numbers.min() == merl.BELOW
    for wrong in (b"", contents[:-1], contents + b"0", b"\1" + contents[1:]):
        with pytest.raises(ValueError, match="no MERL file"):
            merl.read(wrong)


def test_light_and_view_of_a_random_pair_do_not_depend_on_each_other():
    towards, views = harmonics.random_pairs(4096)
    for found in (towards, views):
        # Even over the hemisphere: z from 0 to 1, of which the mean's deviation is 0.29 / 64.
        assert found.mean(axis=0) == pytest.approx([0.0, 0.0, 0.5], abs=0.03)
    centered = towards - towards.mean(axis=0), views - views.mean(axis=0)
    # A product's deviation is a third at most, of the mean of 4096 a hundred and ninetieth.
    assert np.abs(centered[0].T @ centered[1] / 4096.0).max() < 0.02


def test_random_samples_are_the_goniometer_s_highlights_too():
    field = height_field(ridges(16, 2, 30.0, 1).heights, 0.4, specular=0.7, exponent=8.0)
    seen = precompute(field, DIRECTIONS)
    towards, views, samples = harmonics.sampled(field, seen, 6)
    for k in range(6):
        expected = goniometer.brdf(field, seen, towards[k : k + 1], views[k : k + 1])[0, 0]
        assert samples[k] == pytest.approx(expected, rel=1e-9)
    diffuse = harmonics.sampled(height_field(field.heights, 0.4), seen, 6)[2]
    assert (samples > diffuse).any()


def test_near_the_horizon_samples_hardly_count():
    """There f_r is a quotient of two small numbers: what is fitted is light that is sent back."""
    towards, views = harmonics.random_pairs(1000)
    samples = np.full((1000, 3), 0.2)
    grazing = towards[:, 2] * views[:, 2] < 0.01
    assert 10 < grazing.sum() < 200
    samples[grazing] += 3.0
    found = harmonics.fitted(towards, views, samples)
    # Of light that is sent back the fault is 0.03 at most, over a twentieth of the samples.
    assert np.abs(found.at(*upper_pairs(100, 0.3)) - 0.2).max() < 0.03


def test_each_cell_of_a_merl_table_is_found_by_its_own_directions_in_either_order():
    towards, views = merl.directions()
    numbers = np.arange(90.0 * 90.0 * 180.0).reshape(1, 90, 90, 180) / np.array(merl.SCALES).reshape(
        3, 1, 1, 1
    )
    cells = [np.ravel_multi_index((30, 20, k), (90, 90, 180)) for k in range(5, 180, 10)]
    for pair in ((towards[cells], views[cells]), (views[cells], towards[cells])):
        assert np.rint(merl.looked_up(numbers, *pair)[:, 0]).astype(int).tolist() == cells


def test_what_falls_below_zero_is_none_in_a_merl_table():
    class Negative:
        def at(self, towards, views):
            return np.full((len(towards), 3), -0.5)

    assert set(np.unique(merl.table(Negative()))) == {merl.BELOW, 0.0}
