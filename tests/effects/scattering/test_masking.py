"""Coarse meshes and redistributed texels."""

import numpy as np
import pytest

from fixedpipe.effects.scattering import height_field, masking

LOW = (0.0, -0.9, 0.3)


def test_a_coarse_field_has_the_means():
    field = height_field.domes(24, 16, 2)
    found = masking.coarse(field, 8)
    assert found.heights.shape == (8, 8)
    assert found.heights[3, 5] == pytest.approx(field.heights[6:8, 15:18].mean())
    assert found.heights.mean() == pytest.approx(field.heights.mean())
    assert (
        masking.coarse(height_field.domes(8, 8, 2), 8).heights == height_field.domes(8, 8, 2).heights
    ).all()


@pytest.mark.parametrize("cells", [0, 1, 5])
def test_cells_that_do_not_part_the_texels_are_refused(cells):
    with pytest.raises(ValueError, match=f"{cells} cells along an edge do not part 24 x 16 texels"):
        masking.coarse(height_field.domes(24, 16, 2), cells)


def test_what_is_seen_covers_the_mean_plane():
    """A texel's share of the picture is V (n.v)+ / (n_z v_z), whatever the angle."""
    for view in (LOW, (0.7, 0.0, 0.7), (0.0, 0.0, 1.0)):
        for field in (height_field.ridges(64, 64, 40.0, 2), height_field.bumps(64, 64, height=0.15)):
            assert masking.seen_share(field, view).mean() == pytest.approx(1.0, abs=0.06)


def test_a_flat_field_and_an_eye_above_leave_texels_where_they_are():
    stay = np.arange(64).reshape(8, 8)
    assert (masking.redistributed(height_field.height_field(np.zeros((8, 8))), LOW) == stay).all()
    assert (masking.redistributed(height_field.bumps(8, 8, height=0.05), (0.0, 0.0, 1.0)) == stay).all()


def test_texels_are_shown_as_often_as_they_are_seen_and_keep_their_order():
    field = height_field.bumps(32, 32, height=0.15)
    share, shown = masking.seen_share(field, LOW), masking.redistributed(field, LOW)
    assert (np.diff(shown // 32, axis=0) >= 0).all()
    assert (shown % 32 == np.arange(32)).all()
    often = np.bincount(shown.ravel(), minlength=1024).reshape(32, 32)
    assert (np.abs(often - share * 32 / share.sum(axis=0)) <= 1.0).all()
    assert (share.ravel()[np.unique(shown)] > 0.0).all()


def test_both_axes_are_alike():
    field = height_field.bumps(16, 16, height=0.15)
    along = masking.redistributed(field, (0.0, -0.9, 0.3))
    across = masking.redistributed(field, (-0.9, 0.0, 0.3))
    assert (along == (across % 16 * 16 + across // 16).T).all()


def test_eyes_aslant_or_below_are_refused():
    field = height_field.bumps(8, 8)
    with pytest.raises(ValueError, match="whose x or y is 0"):
        masking.redistributed(field, (0.5, 0.5, 0.7))
    with pytest.raises(ValueError, match="not above the horizon"):
        masking.seen_share(field, (0.0, 1.0, -0.1))


def test_a_coarse_field_has_the_colour_of_the_first_texel():
    found = masking.coarse(height_field.domes(8, 8, 2, albedo=(0.9, 0.5, 0.1)), 4)
    assert (found.albedo == (0.9, 0.5, 0.1)).all()
