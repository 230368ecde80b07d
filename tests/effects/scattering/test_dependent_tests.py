"""Paths and rounds of dependent tests, made of any machine's passes."""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.geometry.views import Panel
from fixedpipe.effects.scattering import dependent_tests, height_field, light_transport
from fixedpipe.effects.scattering.dependent_tests import Accumulation, Setup
from fixedpipe.effects.scattering.texture_shader_passes import WAY
from fixedpipe.pipeline.profiles import GEFORCE_3, IDEAL
from tests.effects.scattering.passes import DIRECTIONS, EXPOSURE, LIGHT, TEXELS, domes, setup_of, shown

PATHS = light_transport.sequences(DIRECTIONS, 1, DIRECTIONS)


@pytest.mark.parametrize("accumulation", Accumulation)
@pytest.mark.parametrize("count", [1, 3])
def test_rounds_are_the_bounces_in_float64(count, accumulation):
    setup = setup_of(domes(), IDEAL)
    drawn = dependent_tests.rounds_drawn(
        WAY, setup, LIGHT, count, accumulation=accumulation, exposure=EXPOSURE
    )
    expected = EXPOSURE * light_transport.bounces(setup.field, setup.visibility, LIGHT, count)[-1]
    assert root_mean_square(shown(setup, drawn) - expected) < 1e-12


def test_one_round_is_a_path_along_each_direction():
    setup = setup_of(domes(), GEFORCE_3)
    path = shown(setup, dependent_tests.paths_drawn(WAY, setup, PATHS, LIGHT, exposure=EXPOSURE))
    whole = shown(setup, dependent_tests.rounds_drawn(WAY, setup, LIGHT, 1, exposure=EXPOSURE))
    # In the spiral's order both.
    assert np.array_equal(path, whole)


@pytest.mark.parametrize("accumulation", Accumulation)
def test_a_flat_field_has_direct_light_alone(accumulation):
    field = height_field.height_field(np.zeros((TEXELS, TEXELS)), 0.5)
    setup = setup_of(field, IDEAL)
    drawn = dependent_tests.paths_drawn(WAY, setup, PATHS, LIGHT, accumulation=accumulation)
    assert np.abs(shown(setup, drawn) - 0.5 * LIGHT[2]).max() < 1e-12


def test_a_mask_takes_the_place_of_rays():
    setup = setup_of(domes(), IDEAL)
    lit = np.arange(TEXELS) % 2 == 0
    drawn = dependent_tests.paths_drawn(WAY, setup, PATHS, LIGHT, lit=lit, exposure=EXPOSURE)
    mask = np.broadcast_to(lit, (TEXELS, TEXELS))
    expected = light_transport.scattered(setup.field, setup.visibility, PATHS, LIGHT, lit=mask)
    assert root_mean_square(shown(setup, drawn) - EXPOSURE * expected) < 1e-12


@pytest.mark.parametrize(
    ("sentence", "changes"),
    [
        (r"The paths have shape \(0, 1\)", {"paths": np.zeros((0, 1), np.int64)}),
        (r"The paths have shape \(3,\)", {"paths": [1, 2, 3]}),
        ("exposure is 0.0; give a number above 0", {"exposure": 0.0}),
        ("The accumulation is", {"accumulation": "framebuffer"}),
        ("not above the horizon", {"light": (1.0, 0.0, -0.1)}),
    ],
)
def test_what_is_no_picture_is_refused(sentence, changes):
    setup = setup_of(domes(), GEFORCE_3)
    given = {"paths": PATHS, "light": LIGHT} | changes
    with pytest.raises(ValueError, match=sentence):
        dependent_tests.paths_drawn(WAY, setup, **given)


def test_rounds_of_highlights_and_of_nothing_are_refused():
    setup = setup_of(domes(0.2), GEFORCE_3)
    with pytest.raises(ValueError, match="has highlights; draw paths of it"):
        dependent_tests.rounds_drawn(WAY, setup, LIGHT, 1)
    with pytest.raises(ValueError, match="0 further reflections are to be drawn"):
        dependent_tests.rounds_drawn(WAY, setup_of(domes(), GEFORCE_3), LIGHT, 0)


def test_a_panel_has_a_pixel_for_each_texel():
    setup = setup_of(domes(), GEFORCE_3)
    with pytest.raises(ValueError, match="has 16x16 texels and a panel 8x16 pixels"):
        replace(setup, work=Panel(0, 0, 8, 16))


def test_more_texels_than_bits_tell_apart_are_refused():
    field = height_field.domes(256, 256, 2)
    visibility = setup_of(domes(), GEFORCE_3).visibility
    panel = Panel(0, 0, 256, 256)
    with pytest.raises(ValueError, match="Coordinates of 8 bits tell 256 texels apart"):
        Setup(field, visibility, GEFORCE_3, panel, panel)
