"""A result shows itself as a picture: its PNG is ``image()`` without alpha, the top row first."""

import io

import numpy as np
import pytest
from PIL import Image

from fixedpipe.pipeline import GEFORCE_256, Clear, Scissor, execute, execute_ideal

WIDTH, HEIGHT = 5, 3
TOP, BOTTOM = (200, 100, 50), (10, 20, 30)


def colored(label, bytes_, **others):
    return Clear(label=label, color=(*(b / 255 for b in bytes_), 0.0), **others)


# Alpha is zero: a viewer that took it for transparency would show nothing.
FRAME = (colored("below", BOTTOM), colored("above", TOP, scissor=Scissor(0, HEIGHT - 1, WIDTH, 1)))
RESULTS = {
    "machine": lambda: execute(FRAME, GEFORCE_256, WIDTH, HEIGHT),
    "ideal": lambda: execute_ideal(FRAME, WIDTH, HEIGHT),
}


@pytest.mark.parametrize("made", RESULTS.values(), ids=RESULTS)
def test_a_results_png_is_its_picture_top_row_first_and_opaque(made, tmp_path):
    result = made()
    result.save(tmp_path / "picture.PNG")
    for source in (io.BytesIO(result._repr_png_()), tmp_path / "picture.PNG"):
        with Image.open(source) as file:
            assert (file.format, file.mode) == ("PNG", "RGB")
            picture = np.asarray(file)
        np.testing.assert_array_equal(picture, result.image()[..., :3])
        assert (picture[0] == TOP).all()
        assert (picture[1:] == BOTTOM).all()


def test_a_picture_of_another_kind_is_refused_before_anything_is_written(tmp_path):
    result = RESULTS["ideal"]()
    with pytest.raises(ValueError, match=r"saved as PNG; name it .*picture\.png, not .*picture\.jpg"):
        result.save(tmp_path / "picture.jpg")
    assert not list(tmp_path.iterdir())
