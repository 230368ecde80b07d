"""Pictures finished for print: squares averaged, panels parted, a rectangle enlarged."""

import numpy as np
import pytest

from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.reports.plates import Inset, Plates


def noise(height, width, dtype=np.uint8):
    return np.random.default_rng(5).integers(0, np.iinfo(dtype).max + 1, (height, width, 3), dtype)


def test_a_picture_is_as_drawn_where_nothing_is_asked_for(tmp_path):
    picture = noise(8, 24)
    assert Plates(tmp_path).finished(picture, 3) is picture


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_squares_become_their_mean_halves_up(tmp_path, dtype):
    picture = noise(8, 12, dtype)
    found = Plates(tmp_path, supersample=4).finished(picture, 1)
    wanted = [
        [picture[4 * y : 4 * y + 4, 4 * x : 4 * x + 4].mean((0, 1)) for x in range(3)] for y in range(2)
    ]
    assert found.dtype == dtype
    np.testing.assert_array_equal(found, np.floor(np.array(wanted) + 0.5).astype(dtype))


def test_gutters_are_white_and_panels_keep_their_pixels(tmp_path):
    picture = noise(4, 30)
    found = Plates(tmp_path, gutter=5).finished(picture, 3)
    assert found.shape == (4, 40, 3) and (found[:, 10:15] == 255).all() and (found[:, 25:30] == 255).all()
    np.testing.assert_array_equal(found[:, 15:25], picture[:, 10:20])


def test_an_inset_stands_in_the_far_corner_of_its_own_panel(tmp_path):
    picture = noise(60, 120)
    inset = Inset.parse("65, 4, 8, 6, 4")
    inset.check("F", 120, 60, 2)
    found = Plates(tmp_path, inset=inset).finished(picture, 2)
    large = picture[4:10, 65:73].repeat(4, 0).repeat(4, 1)
    np.testing.assert_array_equal(found[60 - 24 - 4 : 56, 120 - 32 - 4 : 116], large)
    np.testing.assert_array_equal(found[4:10, 65:73], picture[4:10, 65:73])  # framed, and still there
    np.testing.assert_array_equal(found[:, :60], picture[:, :60])
    assert (found[2:4, 63:75] == 255).all()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("1,2,3", "x,y,w,h,zoom"),
        ("-1,2,3,4,5", "x,y,w,h,zoom"),
        ("1,2,0,4,5", "a width and a height"),
        ("1,2,3,4,99", "a zoom of 2 to 32"),
    ],
)
def test_words_that_are_no_inset_are_refused(words, said):
    with pytest.raises(Refusal, match=said):
        Inset.parse(words)


@pytest.mark.parametrize(
    ("inset", "said"),
    [
        ((55, 5, 10, 5, 2), "not in one panel"),
        ((5, 58, 4, 4, 2), "not in one panel"),
        ((200, 5, 4, 4, 2), "not in one panel"),
        ((5, 5, 20, 10, 4), "smaller rectangle or zoom"),
    ],
)
def test_an_inset_without_room_is_refused(inset, said):
    with pytest.raises(Refusal, match=said):
        Inset(*inset).check("F004-4", 120, 60, 2)
