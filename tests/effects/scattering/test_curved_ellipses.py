"""Five ellipses, linear in the curvature, beside rays among bent triangles."""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.effects.acceptance.bent_caster import BentCaster
from fixedpipe.effects.scattering import curved_ellipses, ellipses, height_field, visibility
from fixedpipe.effects.scattering import directions as sphere
from fixedpipe.effects.scattering.curved_base import Base
from fixedpipe.effects.scattering.visibility import BACK, FREE

LIGHTS = sphere.spiral(300)
LIGHTS = LIGHTS[LIGHTS[:, 2] > 0.15]


def groove():
    """One ridge a period with flanks of 45 degrees, its heights from their middle."""
    field = height_field.ridges(32, 2, 45.0, 1)
    return replace(field, heights=field.heights - 0.25)


def lit(forms):
    """What the ellipses say of LIGHTS: bool [n, rows, columns]."""
    x, y = (LIGHTS[:, k][:, None, None] for k in range(2))
    return ellipses.tested(*forms, x, y) >= 0.0


def test_no_curvature_is_the_flat_ellipse():
    field = height_field.domes(12, 12, 2)
    seen = visibility.precompute(field, sphere.spiral(100))
    five = curved_ellipses.five_ellipses(field, seen)
    flat = ellipses.of_visibility(seen)
    assert (five.flat.center == flat.center).all() and (five.flat.radii == flat.radii).all()
    for found, expected in zip(five.packed(0.0, 0.0), ellipses.rooted(flat), strict=True):
        assert (found == expected).all()
    assert five.stored_bytes == 5 * 6 * 144


def test_at_the_steps_the_pair_of_fits_is_met_on_average():
    field = groove()
    seen = visibility.precompute(field, sphere.spiral(100))
    five = curved_ellipses.five_ellipses(field, seen)
    ends = [five.packed(k, 0.0)[0] for k in (-curved_ellipses.STEP, curved_ellipses.STEP)]
    fits = [ellipses.rooted(e)[0] for e in five.along_u]
    assert np.allclose(ends[1] - ends[0], fits[0] - fits[1], atol=1e-12)
    # Another curvature at every texel.
    field_of = np.linspace(-0.2, 0.2, 64).reshape(2, 32)
    assert np.allclose(five.packed(field_of, 0.0)[0][1, 5], five.packed(field_of[1, 5], 0.0)[0][1, 5])


def test_more_is_lit_where_valleys_widen_as_rays_say():
    """Measured, 200 directions: the ellipses' lit share goes from 0.903 to 0.920 over curvatures of -0.2 to
    0.2, that of rays from 0.876 to 0.940: the sign, and a quarter of the change.
    """
    field = groove()
    seen = visibility.precompute(field, sphere.spiral(200))
    five = curved_ellipses.five_ellipses(field, seen)
    shares = []
    for k in (-0.2, 0.0, 0.2):
        truly = BentCaster(field, Base((k, 0.0)), (1, 3)).seen(LIGHTS)
        facing, told = truly != BACK, lit(five.packed(k, 0.0))
        assert (told == (truly == FREE))[facing].mean() > 0.92
        shares.append((told[facing].mean(), (truly == FREE)[facing].mean()))
    (low, low_truth), _, (high, high_truth) = shares
    assert 0.15 < (high - low) / (high_truth - low_truth) < 1.2


def test_both_axes_are_alike():
    field = height_field.bumps(12, 12)
    directions = sphere.spiral(100)
    five = curved_ellipses.five_ellipses(field, visibility.precompute(field, directions))
    turned = replace(
        field,
        heights=np.ascontiguousarray(field.heights.T),
        normals=np.ascontiguousarray(np.swapaxes(field.normals, 0, 1)[..., [1, 0, 2]]),
    )
    other = curved_ellipses.five_ellipses(turned, visibility.precompute(turned, directions[:, [1, 0, 2]]))
    x, y = (LIGHTS[:, k][:, None, None] for k in range(2))
    one = ellipses.tested(*five.packed(0.1, 0.0), x, y) >= 0.0
    two = ellipses.tested(*other.packed(0.0, 0.1), y, x) >= 0.0
    assert (one == np.swapaxes(two, 1, 2)).mean() > 0.99


def test_steps_and_heights_that_are_none_are_refused():
    field = groove()
    seen = visibility.precompute(field, sphere.spiral(40))
    with pytest.raises(ValueError, match="step of curvature is 0; give a positive number"):
        curved_ellipses.five_ellipses(field, seen, 0)
    with pytest.raises(ValueError, match="heights reach its centre"):
        curved_ellipses.five_ellipses(field, seen, 5.0)
