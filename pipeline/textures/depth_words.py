"""Depth formats: the words of a buffer or a texture, and the depths that they hold."""

from typing import NamedTuple

from fixedpipe.pipeline.enums import DepthFormat
from fixedpipe.raster import codes as C
from fixedpipe.raster.float_depths import FLOAT_16, FLOAT_24, FloatDepth, farthest


class DepthWords(NamedTuple):
    """The words of a depth format.

    - ``code``: the format's kind, a code of ``raster/codes.py``.
    - ``largest``: the largest word.
    - ``farthest``: the depth of the largest word.
    - ``form``: how a floating-point word is made; None: the format is fixed.
    """

    code: int
    largest: int
    farthest: float
    form: FloatDepth | None = None


def _words(depth_format):
    form = {DepthFormat.FLOAT_16: FLOAT_16, DepthFormat.FLOAT_24: FLOAT_24}.get(depth_format)
    if form is not None:
        return DepthWords(form.code, form.largest, farthest(form), form)
    largest = 2**depth_format.bits - 1
    return DepthWords(C.DEPTH_FIXED, largest, float(largest))


DEPTH_WORDS = {depth_format: _words(depth_format) for depth_format in DepthFormat}
