"""Columns that threads draw in begin at a line of the cache, whatever the batch."""

import numpy as np
import pytest

from fixedpipe.raster import rows as R
from fixedpipe.raster.vector.arrays import scratch


@pytest.mark.parametrize("batch", [0, 1, 17, 64, 2048])
def test_columns_begin_at_a_line_and_share_nothing(batch):
    made = scratch(batch)
    for name, array in made._asdict().items():
        assert array.flags.c_contiguous and array.flags.writeable, name
        assert array.ctypes.data % 64 == 0, name
        assert not array.any(), name
        if name not in ("lanes", "lane_floats"):
            assert array.shape[-1] >= batch + R.SLACK, name
            # Each column of numbers, too; of bytes there is one.
            assert array.strides[-1] * array.shape[-1] % 64 == 0 or array.ndim == 1, name
    arrays = list(made)
    for k, one in enumerate(arrays):
        assert not any(np.shares_memory(one, other) for other in arrays[k + 1 :])
