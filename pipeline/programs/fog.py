"""Fog on machines with ROUNDED fog arithmetic: the coordinates at which its factor, a byte, changes."""

from decimal import Decimal, localcontext
from functools import lru_cache

import numpy as np

from fixedpipe.pipeline.enums import FogMode


@lru_cache(maxsize=64)
def fog_thresholds(fog):
    """float64 [255]: the coordinates at which 255 f crosses k - 1/2, k = 1..255 (docs/numbers.md, section 9).

    Correctly rounded from 40 decimal digits, so they are the same bits on every machine.
    """
    out = np.empty(255, np.float64)
    with localcontext() as context:
        context.prec = 40
        for k in range(1, 256):
            if fog.mode == FogMode.LINEAR:
                out[k - 1] = fog.end - ((k - 0.5) / 255.0) * (fog.end - fog.start)
                continue
            exponent = -((Decimal(2 * k - 1) / Decimal(510)).ln())
            if fog.mode == FogMode.EXP2:
                exponent = exponent.sqrt()
            out[k - 1] = float(exponent / Decimal(fog.density)) if fog.density else np.inf
    out.setflags(write=False)
    return out
