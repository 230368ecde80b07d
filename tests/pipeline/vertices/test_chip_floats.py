"""The floats of the vertex hardware equal their specification in exact fractions, specials included."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fixedpipe.pipeline.vertices import chip_floats
from tests.reference import lighting_unit as reference

special = st.sampled_from([0.0, -0.0, 1.0, -1.0, 2.0, math.inf, -math.inf, math.nan, 2.0**-126, -(2.0**127)])
singles = special | st.floats(width=32) | st.floats(-4, 4, width=32)


def exact(value):
    """A column's number as the specification takes it."""
    return value if not math.isfinite(value) else reference.Fraction(value)


def same(column, expected):
    got, wanted = float(column), float(expected)
    return got == wanted or (math.isnan(got) and math.isnan(wanted))


@settings(max_examples=300)
@given(singles)
def test_numbers_enter_the_units_as_specified(value):
    with np.errstate(all="ignore"):
        assert same(chip_floats.single(value), reference.single(value))
        entered = chip_floats.single(value)
        assert same(chip_floats.to_lighting(entered), reference.to_lighting(reference.single(value)))


@settings(max_examples=300)
@given(singles, singles, singles, st.sampled_from([14, 24]), st.sampled_from([0, 5]))
def test_sums_and_products_are_cut_as_specified(a, b, c, bits, guard):
    with np.errstate(all="ignore"):
        a, b, c = (chip_floats.truncated(chip_floats.single(v), bits)[()] for v in (a, b, c))
        x, y, z = (exact(float(v)) for v in (a, b, c))
        assert same(chip_floats.product(a, b, bits), reference.product(x, y, bits))
        assert same(chip_floats.total((a, b, c), bits, guard), reference.total((x, y, z), bits, guard))


@settings(max_examples=300)
@given(singles, singles, singles)
def test_a_product_and_a_sum_at_once_are_cut_as_specified(a, b, c):
    with np.errstate(all="ignore"):
        a, b, c = (chip_floats.to_lighting(chip_floats.single(v))[()] for v in (a, b, c))
        x, y, z = (exact(float(v)) for v in (a, b, c))
        for name in ("multiply_add", "add_product"):
            got, wanted = (getattr(module, name) for module in (chip_floats, reference))
            assert same(got(a, b, c, 14), wanted(x, y, z, 14))


def test_a_product_beside_a_sum_loses_what_its_first_factor_is_shifted_by():
    """Source: docs/numbers.md, N2.25. 3 lies a bit above the place of (1 - 2^-14) 2.5, whose first factor
    loses its last bit. Cut before the sum the product would be 2.5 - 2^-12.
    """
    odd, even, b, c = 1 - 2.0**-14, 1 - 2.0**-13, -2.5, 3.0
    assert float(chip_floats.multiply_add(odd, b, c, 14)) == 0.5 + 2.5 * 2.0**-13
    assert float(chip_floats.multiply_add(even, b, c, 14)) == 0.5 + 2.5 * 2.0**-13
    assert float(chip_floats.multiply_add(b, odd, c, 14)) == 0.5 + 2.0**-13
    assert float(chip_floats.add_product(odd, b, c, 14)) == 0.5 + 2.0**-12
    assert float(chip_floats.total((chip_floats.product(odd, b, 14), c), 14, 0)) == 0.5 + 2.0**-12


@settings(max_examples=300)
@given(singles)
def test_reciprocals_follow_their_tables(value):
    with np.errstate(all="ignore"):
        value = chip_floats.single(value)[()]
        short = chip_floats.to_lighting(value)[()]
        assert same(
            chip_floats.lighting_reciprocal(short), reference.lighting_reciprocal(exact(float(short)))
        )
        assert same(
            chip_floats.lighting_inverse_root(short), reference.lighting_inverse_root(exact(float(short)))
        )
        assert same(
            chip_floats.transform_reciprocal(value), reference.transform_reciprocal(exact(float(value)))
        )
        assert same(
            chip_floats.transform_inverse_root(value), reference.transform_inverse_root(exact(float(value)))
        )


@pytest.mark.parametrize(
    ("table", "first", "last"),
    [
        ("LIGHTING_RECIPROCALS", "7f7d7b7977757472706f6d6c6b69", "454443434242414140 40"),
        ("TRANSFORM_RECIPROCALS", "7f7d7b7978767473716f6e6d6b6a", "45454443434242414140"),
        ("TRANSFORM_ROOTS", "7f7f7e7d7c7b7a79787777767574", "4443434343424242414141414040"),
    ],
)
def test_tables_are_the_chip_s(table, first, last):
    """Source: envytools (xf_rcp_lut_v1, xf_rcp_lut_v2, xf_rsq_lut_v2)."""
    values = getattr(chip_floats, table).tolist()
    first, last = list(bytes.fromhex(first)), list(bytes.fromhex(last))
    assert values[: len(first)] == first
    assert values[-len(last) :] == last


def test_one_has_an_exact_reciprocal_in_the_transform_unit_alone():
    """Source: envytools (xf_rcp, pgraph_celsius_lt_rcp)."""
    assert float(chip_floats.transform_reciprocal(np.float64(1.0))) == 1.0
    assert float(chip_floats.lighting_reciprocal(np.float64(1.0))) == 8191 / 8192


def test_a_matrix_s_sum_keeps_five_bits_below_its_largest_term():
    """Measured: Lighting_spotlight's w, 7 less 3.5e-9; a sum cut to 24 bits alone would be 7 - 2^-21."""
    row = (0.0, 0.0, 1.0, 7.0)
    (w,) = chip_floats.transform_matrix([row], [np.float64(c) for c in (0.0, 0.0, -3.5e-9, 1.0)])
    assert float(w) == 7.0
    (w,) = chip_floats.transform_matrix([row], [np.float64(c) for c in (0.0, 0.0, -(2.0**-26), 1.0)])
    assert float(w) == 7.0 - 2.0**-21
