"""Two's complement components as real numbers that may be negative."""

import numpy as np

from fixedpipe.raster.columns import numbers
from fixedpipe.raster.columns.real_texture_shader import signed

NOISE = numbers.NOISE


def signed_flags(sampler):
    """Which components, RGBA, a sampler reads as two's complement."""
    flags = sampler.signed_components
    return flags.red, flags.green, flags.blue, flags.alpha


def as_signed(components, sampler, bits):
    """Components [4] as a sampler reads them: signed ones as two's complement."""
    one = 2.0**bits - 1.0
    return np.where(signed_flags(sampler), signed(components * one, bits) / one, components)
