"""G08 on the Octane: the passes are the paths in float64, with 8 and with 12 bits."""

import pytest

from fixedpipe.effects.scattering.dependent_tests import UP, Accumulation, Into
from fixedpipe.effects.scattering.pixel_texture_passes import WAY
from fixedpipe.pipeline.commands import CopyPixels, DrawPixels
from fixedpipe.pipeline.profiles import IDEAL, OCTANE
from tests.effects.scattering.passes import domes, error_of, setup_of


@pytest.mark.parametrize("accumulation", Accumulation)
@pytest.mark.parametrize("lookups", [1, 2, 4])
def test_unrounded_passes_are_the_paths(lookups, accumulation):
    assert error_of(WAY, IDEAL, lookups, accumulation=accumulation) < 1e-12


def test_a_path_of_one_lookup_keeps_its_bytes_and_one_of_four_does_not():
    short, long = (error_of(WAY, OCTANE, lookups) for lookups in (1, 4))
    assert short < 0.005  # two steps: factors, terms and their sum are bytes
    assert short < long < 0.08  # direct light in steps of 1/64


@pytest.mark.parametrize("lookups", [1, 2])
def test_unrounded_passes_are_the_paths_with_highlights(lookups):
    # The table of powers has 2^14 entries.
    assert error_of(WAY, IDEAL, lookups, specular=0.2) < 5e-5


def test_coordinates_of_twelve_bits_lead_to_the_same_texels():
    assert error_of(WAY, IDEAL, 2, bits=12) < 1e-12
    assert error_of(WAY, OCTANE, 2, bits=12) == error_of(WAY, OCTANE, 2)


@pytest.mark.parametrize("lookups", [1, 2])
def test_twelve_bits_of_colour_are_finer(lookups):
    eight, twelve = (error_of(WAY, OCTANE, lookups, bits=bits, color_bits=bits) for bits in (8, 12))
    assert twelve < eight / 4.0


def test_a_lookup_is_a_rectangle_of_pixels_with_a_pixel_texture():
    setup = setup_of(domes(), OCTANE)
    *_, lookup, copy = WAY.gathered(setup, 5, UP, "L_d", Into(setup.total, 0.1, add=True))
    assert isinstance(lookup, DrawPixels) and lookup.pixel_texture is not None
    assert isinstance(copy, CopyPixels) and copy.transfer.scale[0] == 0.1
