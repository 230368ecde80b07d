"""Anisotropic filtering on the NV2A: kernels equal the specification under any filter and wrap mode."""

from dataclasses import replace

import pytest

from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.enums import TextureTarget
from fixedpipe.pipeline.profiles import GEFORCE_256, IDEAL, NV2A
from fixedpipe.pipeline.validation.validate import validate
from fixedpipe.pipeline.validation.walk import UnsupportedState
from tests.pipeline.execution.test_random_states import assert_equal_to_reference
from tests.reference.sample import taps
from tests.support.strategies import textured_frame


def anisotropic(commands, maximum):
    """The frame with its one sampler's maximum changed."""
    texture, draw = commands
    unit = draw.state.texture_units[0]
    unit = replace(unit, sampler=replace(unit.sampler, max_anisotropy=maximum))
    return texture, replace(draw, state=replace(draw.state, texture_units=(unit,)))


def frames_2d(count):
    """The first seeds whose frame reads a 2D texture."""
    seeds = (s for s in range(10000) if _reads_2d(s))
    return [next(seeds) for _ in range(count)]


def _reads_2d(seed):
    image = textured_frame(seed, 16, 16)[0]
    return isinstance(image, TexImage) and image.image.target is TextureTarget.TEXTURE_2D


@pytest.mark.parametrize("maximum", [2.0, 4.0, 8.0, 3.25])
@pytest.mark.parametrize("seed", frames_2d(12))
def test_anisotropic_textures_equal_the_specification(seed, maximum):
    assert_equal_to_reference(anisotropic(textured_frame(seed, 24, 24), maximum), NV2A, 24, 64)


@pytest.mark.parametrize("ratio", [1.0, 1.2, 2.0, 2.01, 2.65, 3.63, 4.0, 5.0, 6.7, 8.0])
def test_weights_sum_to_one_and_positions_stay_in_the_footprint(ratio):
    positions, weights = zip(*taps(ratio), strict=True)
    assert sum(weights) == 256 and min(weights) >= 0
    assert sum(positions) == 0
    assert max(positions) < (0.5 if ratio <= 2 else 0.75)


def test_measured_weights():
    """Measured: inner and outer weights of footprints 2.65 and 3.63 texels long (Anisotropy-4)."""
    assert [weight for _, weight in taps(2.65)[::2]] == [97, 31]
    assert [weight for _, weight in taps(3.63)[::2]] == [71, 57]


@pytest.mark.parametrize(
    ("profile", "maximum", "said"),
    [
        (NV2A, 16.0, "NV2A takes 1 to 8"),
        (NV2A, 0.5, "NV2A takes 1 to 8"),
        (GEFORCE_256, 4.0, "GeForce 256 takes 1 to 2"),
        (IDEAL, 65.0, "ideal takes 1 to 64"),
    ],
)
def test_a_machine_refuses_more_than_it_has(profile, maximum, said):
    commands = anisotropic(textured_frame(frames_2d(1)[0], 24, 24), maximum)
    with pytest.raises(UnsupportedState, match=said):
        validate(commands, profile, 24, 24, 24)


def test_a_cube_map_is_not_filtered_anisotropically():
    cube = TextureTarget.TEXTURE_CUBE_MAP
    seed = next(s for s in range(1000) if textured_frame(s, 16, 16)[0].image.target is cube)
    with pytest.raises(UnsupportedState, match="2D and rectangle textures"):
        validate(anisotropic(textured_frame(seed, 16, 16), 2.0), NV2A, 16, 16, 24)
