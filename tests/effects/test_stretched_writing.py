"""F001-1 and F001-2: the page, its footprints and its pictures by second ways."""

import numpy as np
import pytest

from fixedpipe.effects.geometry.views import Panel
from fixedpipe.effects.texture_filtering import stretched_writing as written


@pytest.mark.parametrize("stretch", [1, 5, 8])
def test_the_stretch_is_found_again(stretch):
    assert written.found_stretch(written.writing(512, stretch=stretch)) == stretch


def test_footprints_are_what_neighbouring_pixels_differ_by():
    view = written.flat_view(Panel(0, 0, 60, 12), 30.0)
    right, up = written.footprints(view, 256)
    # The page's middle is an 8 : 1, here a 2 : 1 strip: 1.18 half widths of 30 pixels are half a page.
    texel = 1.18 * 256 / 60
    middle = len(right) // 2
    assert abs(right[middle, 0] / texel - 1.0) <= 0.05 and abs(right[middle, 1]) <= 1e-9
    assert abs(up[middle, 1] / (2.0 * texel) - 1.0) <= 0.12


def test_the_truth_of_a_wedge_is_the_wedge():
    """A page whose colour is s, t: every pixel's mean is that of its middle, but for perspective in it."""
    at = (np.arange(64) + 0.5) / 64
    s, t = np.meshgrid(at, at)
    wedge = np.stack([s, t, np.full((64, 64), 0.25)], axis=-1)
    view = written.flat_view(Panel(0, 0, 40, 20), 30.0)
    found = written.supersampled(view, wedge, (9.0, 9.0, 9.0), side=4)
    full = found[..., 2] == 0.25
    right, up = written.footprints(view, 1)
    assert 0.2 < full.mean() < 1.0
    inside = full[:, 1:] & full[:, :-1]
    step = (found[:, 1:, 0] - found[:, :-1, 0])[inside]
    assert right[:, 0].min() * 0.7 <= step.mean() <= right[:, 0].max() * 1.3
    assert (np.diff(found[..., 1], axis=0)[full[1:] & full[:-1]] > 0.0).all() and (up[:, 1] > 0.0).all()


def test_correlation_of_a_picture_with_itself_and_its_opposite():
    picture = np.random.default_rng(1).random((5, 7, 3))
    assert abs(written.correlation(picture, 0.3 * picture + 0.1) - 1.0) <= 1e-12
    assert abs(written.correlation(picture, 1.0 - picture) + 1.0) <= 1e-12


def test_what_is_within_letters_has_lost_what_is_wider():
    wide = np.broadcast_to(np.repeat([0.0, 1.0], 128)[None, :, None], (3, 256, 3))
    narrow = np.broadcast_to((np.arange(256) % 2)[None, :, None] * 1.0, (3, 256, 3))
    assert np.abs(written.within_letters(wide)[:, 20:100]).max() <= 1e-12
    assert abs(written.within_letters(narrow)[:, 20:-20].std() - 0.5) <= 1e-12


def test_lines_that_do_not_fit_are_refused():
    with pytest.raises(ValueError, match="write less"):
        written.writing(256, ("X" * 60,))
