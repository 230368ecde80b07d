"""Fog on machines with ROUNDED fog arithmetic: the coordinates at which its rounded factor changes."""

from decimal import Decimal, localcontext
from functools import lru_cache

import numpy as np

from fixedpipe.pipeline.enums import FogMode


@lru_cache(maxsize=64)
def fog_thresholds(fog, one=255):
    """float64 [one]: the coordinates at which ``one f`` crosses k - 1/2, k = 1..one (docs/numbers.md, 9).

    They come from 40 decimal digits, so that every machine has the same bits. Never write to the array.
    """
    if fog.mode == FogMode.LINEAR:
        out = fog.end - ((np.arange(1, one + 1) - 0.5) / float(one)) * (fog.end - fog.start)
    elif fog.mode not in (FogMode.EXP, FogMode.EXP2):
        raise ValueError(f"{fog.mode!r} is no fog mode.")
    elif fog.density == 0.0:
        out = np.full(one, np.inf)
    else:
        with localcontext() as context:
            context.prec = 40
            distances = [-(Decimal(2 * k - 1) / Decimal(2 * one)).ln() for k in range(1, one + 1)]
            if fog.mode == FogMode.EXP2:
                distances = [d.sqrt() for d in distances]
            out = np.array([float(d / Decimal(fog.density)) for d in distances])
    out.setflags(write=False)
    return out
