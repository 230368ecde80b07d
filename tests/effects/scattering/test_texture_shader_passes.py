"""G10 by texture shaders: the passes are the paths in float64, and a machine's bytes are near."""

import pytest

from fixedpipe.effects.scattering.dependent_tests import UP, Accumulation, Into
from fixedpipe.effects.scattering.texture_shader_passes import WAY
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.profiles import GEFORCE_3, IDEAL
from tests.effects.scattering.passes import domes, error_of, setup_of


@pytest.mark.parametrize("accumulation", Accumulation)
@pytest.mark.parametrize("lookups", [1, 2, 4])
def test_unrounded_passes_are_the_paths(lookups, accumulation):
    assert error_of(WAY, IDEAL, lookups, accumulation=accumulation) < 1e-12


@pytest.mark.parametrize("lookups", [1, 2])
def test_unrounded_passes_are_the_paths_with_highlights(lookups):
    assert error_of(WAY, IDEAL, lookups, specular=0.2) < 1e-12


def test_a_path_of_one_lookup_keeps_its_bytes_and_one_of_four_does_not():
    short, long = (error_of(WAY, GEFORCE_3, lookups) for lookups in (1, 4))
    assert short < 0.005  # two steps: factors, terms and their sum are bytes
    assert short < long < 0.08  # direct light in steps of 1/64


def test_a_direction_is_one_draw():
    setup = setup_of(domes(), GEFORCE_3)

    (drawn,) = WAY.gathered(setup, 5, UP, "L_d", Into(setup.total, 0.1, add=True))
    assert isinstance(drawn, Draw)
    assert [unit.texture for unit in drawn.state.texture_units][:2] == ["S_5", "L_d"]


def test_coordinates_of_twelve_bits_are_refused():
    with pytest.raises(ValueError, match="12 bits; a texture shader reads bytes"):
        WAY.load(setup_of(domes(), GEFORCE_3, bits=12), True, (0,))
