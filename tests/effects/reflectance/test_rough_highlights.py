"""Highlights changed by roughness: the three forms, the isotropic one, the table, energy."""

import numpy as np
import pytest

from fixedpipe.effects.bump_mapping import roughness_pyramids as rough
from fixedpipe.effects.reflectance import rough_highlights as shine
from fixedpipe.effects.reflectance.rough_highlights import Form

ROUND = np.array([1.0, 0.9, 1.0])
FRAME = np.eye(3)


def _directions(count=64, length=0.6):
    angle = 2.0 * np.pi * np.arange(count) / count
    return length * np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def _unit(*d):
    return np.array(d, float) / np.hypot(*d)


def _ellipse(long, short, degrees):
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    a, b = long * long, short * short
    return np.array([a * c * c + b * s * s, (a - b) * c * s, a * s * s + b * c * c])


def _variance(d, form):
    """What a form takes for the variance along a unit vector: |d|^4 over q."""
    return 1.0 / shine.quotient(d, ROUND, form)


@pytest.mark.parametrize(
    ("direction", "right", "printed"),
    [((1, 1), 1.9, 1.39), ((1, -1), 0.1, 0.61), ((1, 0), 1.0, 0.19), ((0, 1), 1.0, 1.81)],
)
def test_the_erratum_s_variances(direction, right, printed):
    """E001.6, with K = [1 0.9; 0.9 1]."""
    d = _unit(*direction)
    assert _variance(d, Form.CORRECTED) == pytest.approx(right, abs=1e-12)
    assert _variance(d, Form.PRINTED) == pytest.approx(printed, abs=0.005)


def test_forms_agree_on_the_axes_of_a_diagonal_covariance():
    k = np.array([0.09, 0.0, 0.01])
    for d in ([0.3, 0.0], [0.0, 0.2]):
        found = [shine.squared_cosine(np.array(d), k, form) for form in Form]
        np.testing.assert_allclose(found, found[0], rtol=1e-13)


def test_corrected_forms_agree_on_the_principal_axes():
    k = _ellipse(0.4, 0.1, 25.0)
    for degrees in (25.0, 115.0):
        d = 0.3 * np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])
        found = [shine.squared_cosine(d, k, form) for form in (Form.CORRECTED, Form.INVERSE)]
        np.testing.assert_allclose(found[0], found[1], rtol=1e-12)


def test_the_printed_axis_turns_by_up_to_55_degrees():
    """E001.6: deviations 10 to 1, over all angles that they can have."""
    k = np.array([_ellipse(1.0, 0.1, degrees) for degrees in np.arange(0.0, 180.0, 0.25)])
    *_, right = rough.principal(k)
    *_, printed = rough.principal(shine.printed_covariance(k))
    turned = np.degrees(np.arccos(np.minimum(np.abs((right * printed).sum(axis=-1)), 1.0)))
    assert turned.max() == pytest.approx(55.0, abs=0.5)


def test_inverse_by_another_way():
    rng = np.random.default_rng(1)
    for _ in range(20):
        half = rng.normal(size=(2, 2))
        matrix, d = half @ half.T, rng.uniform(-0.6, 0.6, 2)
        k = np.array([matrix[0, 0], matrix[0, 1], matrix[1, 1]])
        assert shine.quotient(d, k) == pytest.approx(d @ np.linalg.inv(matrix) @ d, rel=1e-7)


@pytest.mark.parametrize("deviation", [0.05, 0.5, 1.0, 3.0])
def test_isotropic_tangent(deviation):
    """S22: tan a' = tan a / I_1, and every form is that of a round K."""
    angle = np.radians(np.arange(0.0, 90.0, 1.0))
    d = np.stack([np.sin(angle), np.zeros(len(angle))], axis=-1)
    squared = shine.squared_cosine_isotropic(d, deviation)
    tangent = np.sqrt((1.0 - squared) / squared)
    np.testing.assert_allclose(tangent, np.tan(angle) / deviation, rtol=1e-9, atol=1e-7)
    k = np.array([deviation * deviation, 0.0, deviation * deviation])
    for form in Form:
        np.testing.assert_allclose(shine.squared_cosine(d, k, form), squared, rtol=1e-12, atol=1e-15)


def test_the_angle_shrinks_where_the_deviation_exceeds_one_and_only_there():
    """E001.11."""
    d = _directions()
    for deviation, smaller in ((1.5, True), (0.7, False)):
        squared = shine.squared_cosine_isotropic(d, deviation)
        assert ((squared > 1.0 - 0.36) == smaller).all()


def test_trowbridge_and_reitz_hold_their_energy():
    """E001.12: the integral over all slopes is one, whatever the roughness."""
    radius = np.tan(np.radians((np.arange(4000) + 0.5) * 90.0 / 4000))
    for long, short in ((0.3, 0.3), (0.5, 0.1)):
        k, total, count = _ellipse(long, short, 30.0), 0.0, 256
        for angle in 2.0 * np.pi * np.arange(count) / count:
            slopes = radius[:, None] * np.array([np.cos(angle), np.sin(angle)])
            d = slopes / np.sqrt(1.0 + radius * radius)[:, None]
            value = shine.brightness(shine.squared_cosine(d, k)) * shine.energy(k)
            total += (value * radius * (1.0 + radius**2)).sum() * np.radians(90.0 / 4000) * 2 * np.pi / count
        assert total == pytest.approx(1.0, abs=2e-3)


def test_d_of_halfway_vectors():
    half = np.array([0.3, -0.2, 0.9])
    unit = half / np.sqrt((half * half).sum())
    np.testing.assert_allclose(shine.apart(half, FRAME), unit[:2], atol=1e-15)
    np.testing.assert_allclose(shine.apart(half, FRAME, (0.3 / 0.9, -0.2 / 0.9)), 0.0, atol=1e-15)
    assert shine.squared_cosine(shine.apart([0.1, 0.0, -1.0], FRAME), [1.0, 0.0, 1.0]) == 0.0


def test_no_roughness_is_a_mirror():
    nothing = np.zeros(3)
    for form in Form:
        assert shine.squared_cosine(np.zeros(2), nothing, form) == 1.0
        assert shine.squared_cosine(np.array([0.1, 0.0]), nothing, form) == 0.0
    assert shine.squared_cosine_isotropic(np.array([[0.0, 0.0], [0.1, 0.0]]), 0.0).tolist() == [1.0, 0.0]
    # Corrugated iron: along its ridges nothing leans.
    iron = np.array([0.25, 0.0, 0.0])
    assert shine.squared_cosine(np.array([0.0, 0.1]), iron) == 0.0
    assert shine.squared_cosine(np.array([0.1, 0.0]), iron) > 0.9


def test_table_and_power():
    squared = np.linspace(0.0, 1.0, 100)
    entries = shine.table(lambda x: x * x)
    np.testing.assert_allclose(shine.looked_up(entries, squared), shine.brightness(squared, 4), atol=1e-5)
    np.testing.assert_allclose(shine.brightness(squared, 3), squared**1.5, atol=1e-15)


def test_bad_input():
    with pytest.raises(ValueError, match="no covariance"):
        shine.squared_cosine(np.zeros(2), [1.0, 2.0, 1.0])
    with pytest.raises(ValueError, match="longer than one"):
        shine.squared_cosine(np.array([2.0, 0.0]), ROUND)
    with pytest.raises(ValueError, match="below zero"):
        shine.squared_cosine_isotropic(np.zeros(2), -1.0)
    with pytest.raises(ValueError, match="no finite energy"):
        shine.energy(ROUND, 2)
    with pytest.raises(ValueError, match="entries"):
        shine.table(np.sqrt, 1)
