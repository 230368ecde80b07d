"""The table of ways to tell the shadows of bumps: agreement with rays, and what bytes cost of it."""

import numpy as np
import pytest

from fixedpipe.effects.acceptance import bump_shadows
from fixedpipe.effects.scattering import height_field, visibility
from fixedpipe.pipeline.profiles import GEFORCE_3, GEFORCE_256, OCTANE, OPENGL_1_2_IMAGING

FIELDS = {
    "grooves": height_field.ridges(32, 32),
    "bumps": height_field.bumps(32, 32, height=0.24),
    "domes": height_field.domes(32, 32),
}


@pytest.mark.parametrize("field", FIELDS)
def test_every_way_agrees_with_rays(field):
    """The catalogue's bound for V-grooves; round bumps have horizons that are no ellipses'."""
    found = bump_shadows.agreement(FIELDS[field], bump_shadows.ways(FIELDS[field], 100))
    for name, share in found.items():
        assert share >= (0.9 if field == "grooves" else 0.88), name
    # Interpolation loses nothing against the nearest alone.
    assert found["three directions"] >= found["nearest direction"] - 0.01


@pytest.mark.parametrize(
    ("profile", "ways"),
    [
        (GEFORCE_256, bump_shadows.ways_of_combiners),
        (GEFORCE_3, bump_shadows.ways_of_combiners),
        (OCTANE, bump_shadows.ways_of_the_imaging_subset),
        (OPENGL_1_2_IMAGING, bump_shadows.ways_of_the_imaging_subset),
    ],
)
@pytest.mark.parametrize("field", FIELDS)
def test_bytes_cost_no_more_than_a_hundredth(profile, ways, field):
    exact = bump_shadows.agreement(FIELDS[field], bump_shadows.ways(FIELDS[field], 100))
    drawn = bump_shadows.agreement(FIELDS[field], ways(FIELDS[field], 100, profile))
    for name, share in drawn.items():
        assert abs(share - exact[name]) <= 0.01, name


def test_no_shadow_at_all_and_the_rays_themselves():
    field = FIELDS["bumps"]
    found = bump_shadows.agreement(
        field,
        {
            "rays": lambda light: visibility.free_view(field, light),
            "none": lambda light: np.ones(field.heights.shape, bool),
        },
    )
    assert found["rays"] == 1.0
    assert found["none"] < 0.88
