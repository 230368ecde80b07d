"""Projective texture coordinates by vectors: the scalar rule's, the specification's, and float32's."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.fixed import projected
from fixedpipe.raster.floats import keep_significant_bits
from fixedpipe.raster.vector.coordinates import depth_words, fixed_from_floats
from fixedpipe.raster.vector.projective import (
    fixed_from_projected,
    fixed_toward_zero,
    multiply,
    reciprocals_of_q,
)
from tests.raster.vector.test_rounding import needs_cutting
from tests.reference import sample as reference

COUNT, SCALE = 96, 2.0**24 - 1


def columns(seed, size, far):
    """Columns s, t, r, q of 24 bits: near and on ties of texels and of depth words, beyond the limits, zeros;
    ``far``: some q are zero, or beyond what float32 takes.
    """
    random = np.random.default_rng(seed)
    sizes = [1.0, -1.0, 3.0, 0.37, 2.0**-59, 2.0**58, *([0.0, 2.0**-120, 2.0**90] if far else [])]
    q = random.choice(sizes, COUNT) * (1 + random.random(COUNT))
    q[::3] = random.random(len(q[::3])) + 0.25
    q = keep_significant_bits(q, 24)
    beside = 1 + random.integers(-3, 4, (3, COUNT)) * 2.0 ** -random.integers(18, 25, (3, COUNT))
    whole = random.integers(-300, 256 * size + 300, (2, COUNT)) / (256.0 * size)
    depths = random.integers(-2, 2**24 + 2, COUNT) / SCALE
    s, t, r = (np.concatenate([whole, depths[None]]) * np.where(q == 0.0, 1.0, q)) * beside
    s[::7], t[::11], r[::13] = 0.0, q[::11], q[::13]
    return *(keep_significant_bits(column, 24) for column in (s, t, r)), q


@settings(deadline=None, max_examples=100)
@given(st.integers(0, 2**32))
def test_a_coordinate_by_q_is_the_specifications(seed):
    s, t, r, q = columns(seed, 512, True)
    expected = [reference.projected(strq, True)[:3] for strq in zip(s, t, r, q, strict=True)]
    scalars = [tuple(projected(c, strq[3]) for c in strq[:3]) for strq in zip(s, t, r, q, strict=True)]
    assert scalars == expected
    reciprocals_of_q(q, COUNT)
    for column in (s, t, r):
        multiply(column, q, COUNT)
    assert list(zip(s, t, r, strict=True)) == expected


def singles_of(strq):
    """The float32 columns that have s, t, r and q."""
    singles = np.zeros((R.SINGLE_COLUMNS, COUNT), np.float32)
    with np.errstate(over="ignore"):
        singles[R.SINGLE_COORDINATE :] = strq
    return singles


def expected_fixed(strq, size):
    """What ``fixed_from_projected`` stands for, step by step."""
    s, t, r, q = (column.copy() for column in strq)
    reciprocals_of_q(q, COUNT)
    out = np.zeros((3, COUNT), np.int32)
    for column in (s, t, r):
        multiply(column, q, COUNT)
    fixed_from_floats(s, out[0], float(size), 0.0, 1.0, C.WRAP_CLAMP_TO_EDGE, 1, COUNT)
    fixed_from_floats(t, out[1], float(size), 0.0, 1.0, C.WRAP_CLAMP_TO_EDGE, 1, COUNT)
    depth_words(r, out[2], SCALE, C.DEPTH_FIXED, 2**24 - 1, COUNT)
    return out


@settings(deadline=None, max_examples=200)
@given(st.integers(0, 2**32), st.sampled_from([1, 3, 512, 1000, 4096]), st.booleans())
@example(0, 4096, True)
def test_places_in_a_shadow_map_are_those_of_its_steps(seed, size, far):
    strq, found = columns(seed, size, far), np.zeros((3, COUNT), np.int32)
    sizes = float(size), float(size), SCALE
    fixed_from_projected(strq, singles_of(strq), tuple(found), sizes, SCALE, COUNT)
    assert found.tolist() == expected_fixed(strq, size).tolist()


@needs_cutting
@settings(deadline=None, max_examples=100)
@given(st.integers(0, 2**32), st.sampled_from([1, 3, 512, 1000, 4096]))
def test_float32_takes_a_q_near_one(seed, size):
    strq, found = columns(seed, size, False), np.zeros((3, COUNT), np.int32)
    sizes = float(size), float(size), SCALE
    assert fixed_toward_zero(singles_of(strq), tuple(found), sizes, SCALE, COUNT)
    assert found.tolist() == expected_fixed(strq, size).tolist()


@needs_cutting
@pytest.mark.parametrize("q", [0.0, 2.0**-61, -(2.0**61), 2.0**-123, 2.0**100])
def test_float32_refuses_a_q_far_from_one(q):
    strq, found = columns(1, 512, False), np.zeros((3, COUNT), np.int32)
    strq[3][COUNT // 2] = q
    assert not fixed_toward_zero(singles_of(strq), tuple(found), (512.0, 512.0, SCALE), SCALE, COUNT)
