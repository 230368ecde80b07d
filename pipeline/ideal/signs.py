"""Components that are two's complement, as real numbers of both signs."""

import numpy as np

# Numbers: what float64 may lose of a whole number n by n / 255 * 255.
NOISE = 1e-9


def signed_flags(sampler):
    """Which components, RGBA, a sampler takes as two's complement."""
    flags = sampler.signed_components
    return flags.red, flags.green, flags.blue, flags.alpha


def signed(numbers, bits):
    """Numbers of ``bits`` bits, float64, as two's complement."""
    return np.where(numbers >= 2.0 ** (bits - 1) - NOISE, numbers - 2.0**bits, numbers)


def as_signed(components, sampler, bits):
    """Components [4] of a sampler's, those that are signed as numbers of both signs."""
    one = 2.0**bits - 1.0
    return np.where(signed_flags(sampler), signed(components * one, bits) / one, components)
