"""G09: the lookups are the host's; the passes are the paths in float64."""

from dataclasses import replace

import pytest

from fixedpipe.effects.scattering.dependent_tests import UP, Accumulation, Into
from fixedpipe.effects.scattering.host_lookup_passes import WAY
from fixedpipe.effects.scattering.texture_shader_passes import WAY as SHADERS
from fixedpipe.pipeline.commands import Draw, HostStep
from fixedpipe.pipeline.profiles import GEFORCE_3, GEFORCE_256, IDEAL
from tests.effects.scattering.passes import domes, error_of, setup_of


@pytest.mark.parametrize("accumulation", Accumulation)
@pytest.mark.parametrize("lookups", [1, 2, 4])
def test_unrounded_passes_are_the_paths(lookups, accumulation):
    assert error_of(WAY, IDEAL, lookups, accumulation=accumulation) < 1e-12


def test_a_path_of_one_lookup_keeps_its_bytes_and_one_of_four_does_not():
    short, long = (error_of(WAY, GEFORCE_256, lookups) for lookups in (1, 4))
    assert short < 0.005  # two steps: factors, terms and their sum are bytes
    assert short < long < 0.08  # direct light in steps of 1/64


@pytest.mark.parametrize("lookups", [1, 2])
def test_unrounded_passes_are_the_paths_with_highlights(lookups):
    assert error_of(WAY, IDEAL, lookups, specular=0.2) < 1e-12


def test_a_boards_picture_is_the_texture_shaders_to_the_bit():
    """The host looks up what a texture shader does, and the combiners are the same."""
    errors = [error_of(way, machine, 2) for way, machine in ((WAY, GEFORCE_256), (SHADERS, GEFORCE_3))]
    assert errors[0] == errors[1]


def test_a_direction_is_a_pass_a_step_of_the_host_and_a_sum():
    setup = setup_of(domes(), GEFORCE_256)
    drawn = WAY.gathered(setup, 5, UP, "L_d", Into(setup.work))
    assert [type(command) for command in drawn] == [Draw, HostStep]


def test_a_highlight_of_another_exponent_is_refused():
    field = replace(domes(0.2), exponent=16.0)
    with pytest.raises(ValueError, match="exponent is 16, and squaring three times makes 8"):
        WAY.bumps(setup_of(field, GEFORCE_256), UP, UP, None)


def test_coordinates_of_twelve_bits_are_refused():
    with pytest.raises(ValueError, match="12 bits; the host's pixels are bytes"):
        WAY.load(setup_of(domes(), GEFORCE_256, bits=12), None, (0,))
