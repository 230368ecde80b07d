"""The 64 bits of a float64, how its significant bits are cut, and what is small beside a number.

A sign, eleven bits of exponent and 52 of fraction (IEEE 754).
"""

import numpy as np

FRACTION_BITS = 52
SIGNIFICANT_BITS = FRACTION_BITS + 1  # with the one before the fraction
EXPONENT_BIAS = 1023
EXPONENT = 0x7FF << FRACTION_BITS
FRACTION = (1 << FRACTION_BITS) - 1  # 0 in a power of two

SINGLE_BITS = 24  # significant bits of single precision
LEAST_SINGLE = 2.0**-126  # its smallest normal number
LARGEST_SINGLE = (2.0 - 2.0**-23) * 2.0**127

# docs/numbers.md, section 4.
REST_STEP, REST_STEPS = 2.0**-25, 2.0**25  # where the weight that takes the rest loses the others' bits

# docs/numbers.md, section 6.
SMALLEST = 2.0**-100  # of the largest term of a sum: below it nothing is told from zero
TAU = 2.0**-24  # texels: lifts computed coordinates over the noise of float64
# By what coordinates are divided where q is 0. Measured: they come to the texture's end (Texture_Matrix
# Arbitrary); Inferred: the power, from the largest reciprocal of RCC.
LEAST_Q = 2.0**-64


def kept(bits):
    """The mask that leaves so many significant bits."""
    return -1 << (SIGNIFICANT_BITS - bits)


def keep_significant_bits(values, bits):
    """Float64 truncated toward zero to so many significant bits: the others become zero."""
    patterns = np.asarray(values, np.float64).view(np.int64)
    return (patterns & np.int64(kept(bits))).view(np.float64)
