"""A Pillow image is a picture, top row first; a texture has row 0 at t = 0, at the bottom."""

import numpy as np
import pytest
from PIL import Image

from fixedpipe.pipeline import texture_2d

PICTURE = np.array([[[250, 0, 0], [0, 250, 0]], [[0, 0, 250], [9, 9, 9]], [[1, 2, 3], [4, 5, 6]]], np.uint8)


def test_a_pillow_image_is_turned_over_and_an_array_is_not():
    of_image = texture_2d(Image.fromarray(PICTURE))
    np.testing.assert_array_equal(of_image.levels[0][0, :, :, :3], PICTURE[::-1])
    np.testing.assert_array_equal(texture_2d(PICTURE).levels[0][0, :, :, :3], PICTURE)


@pytest.mark.parametrize("mode", ["L", "LA", "RGBA", "1", "P"])
def test_of_every_mode_of_bytes_pixels_are_what_pillow_shows(mode):
    image = Image.fromarray(PICTURE).convert(mode)
    shown = np.asarray(image.convert("RGBA"))[::-1]
    np.testing.assert_array_equal(texture_2d(image).levels[0][0], shown)


@pytest.mark.parametrize("mode", ["CMYK", "F", "I"])
def test_a_mode_of_no_bytes_is_refused_with_what_to_do(mode):
    with pytest.raises(ValueError, match=rf"is a Pillow image of mode {mode}; give .convert\('RGB'\)"):
        texture_2d(Image.new(mode, (2, 2)))
