"""G10 on a G400: offsets lead where coordinates do."""

import numpy as np
import pytest

from fixedpipe.effects.scattering.dependent_tests import UP, Accumulation, Into
from fixedpipe.effects.scattering.offset_texture_passes import WAY, offset_texels
from fixedpipe.effects.scattering.visibility import BACK, FREE
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.profiles import G400, IDEAL
from tests.effects.scattering.passes import domes, error_of, setup_of


@pytest.mark.parametrize("accumulation", Accumulation)
@pytest.mark.parametrize("lookups", [1, 2, 4])
def test_unrounded_passes_are_the_paths(lookups, accumulation):
    assert error_of(WAY, IDEAL, lookups, accumulation=accumulation) < 1e-12


def test_a_path_of_one_lookup_keeps_its_bytes_and_one_of_four_does_not():
    short, long = (error_of(WAY, G400, lookups) for lookups in (1, 4))
    assert short < 0.005  # two steps: factors, terms and their sum are bytes
    assert short < long < 0.08  # direct light in steps of 1/64


@pytest.mark.parametrize("lookups", [1, 2])
def test_unrounded_passes_are_the_paths_with_highlights(lookups):
    assert error_of(WAY, IDEAL, lookups, specular=0.2) < 1e-12


def test_offsets_lead_to_the_texels_that_are_seen():
    seen = np.array([[5, FREE, 3], [0, BACK, 2]])
    texels = offset_texels(seen).astype(np.int8)
    assert texels[..., 2].tolist() == [[2, 127, -2], [0, 127, 0]]
    assert texels[..., 1].tolist() == [[1, 127, 1], [-1, 127, -1]]


def test_more_texels_than_a_signed_byte_reaches_are_refused():
    with pytest.raises(ValueError, match="128x2 texels, and an offset is a signed byte, which reaches 127"):
        offset_texels(np.zeros((2, 128), np.int64))


def test_a_direction_is_a_draw_of_squares():
    setup = setup_of(domes(), G400)
    _, drawn = WAY.gathered(setup, 5, UP, "L_d", Into(setup.work))
    assert isinstance(drawn, Draw) and len(drawn.mesh.positions) == 4 * setup.field.heights.size
