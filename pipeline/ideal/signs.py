"""Two's complement components as real numbers that may be negative."""

from fixedpipe.raster.columns import numbers

NOISE = numbers.NOISE


def signed_flags(sampler):
    """Which components, RGBA, a sampler reads as two's complement."""
    flags = sampler.signed_components
    return flags.red, flags.green, flags.blue, flags.alpha
