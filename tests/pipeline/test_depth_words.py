"""Words of depth formats are the specification's: the largest, what it is worth, and those of any depth."""

import numpy as np
import pytest

from fixedpipe.pipeline.enums import DepthFormat
from fixedpipe.pipeline.textures.depth_words import DEPTH_WORDS
from fixedpipe.raster import float_depths
from tests.reference import depth as reference

FLOATS = [DepthFormat.FLOAT_16, DepthFormat.FLOAT_24]


@pytest.mark.parametrize("depth_format", DepthFormat)
def test_the_largest_word_is_the_specification_s(depth_format):
    words = DEPTH_WORDS[depth_format]
    assert words.farthest == reference.farthest(depth_format)
    assert words.largest == reference.word(words.farthest, depth_format, None)
    assert (words.form is not None) == (depth_format in FLOATS)


@pytest.mark.parametrize("depth_format", FLOATS)
def test_words_of_floats_are_the_specification_s(depth_format):
    form = DEPTH_WORDS[depth_format].form
    least = 2.0 ** (1 - form.bias)
    depths = np.geomspace(least, reference.farthest(depth_format), 999)
    depths = np.append(depths[:-1], [least, 1.0, 1.5, reference.farthest(depth_format)])
    expected = [reference.word(z, depth_format, None) for z in depths.tolist()]
    assert float_depths.words(depths, form).tolist() == expected
