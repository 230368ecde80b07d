"""A bumped mirror in passes: the tents, what cube maps hold, and a plane against the same in floats."""

import numpy as np
import pytest

from fixedpipe.effects.bump_mapping import roughness_pyramids as rough
from fixedpipe.effects.environment_maps import bumped_reflections, rough_mirrors
from fixedpipe.effects.environment_maps import rough_mirror_passes as passes
from fixedpipe.effects.geometry import cube_maps, surfaces
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.views import Panel, perspective_view
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import IDEAL, PROFILES

FRAME = rough_mirrors.Mirror().frame
SIZE = 24
ROUGHNESS = 0.2
DEVIATIONS = passes.deviations(ROUGHNESS)


def colored(toward):
    """An environment without edges."""
    along = toward / np.sqrt((toward * toward).sum(axis=-1, keepdims=True))
    return 0.5 + 0.4 * along


def drawn(profile, levels, cubes, *, plain=False):
    view = perspective_view(Panel(0, 0, SIZE, SIZE), (0.0, 2.0, 0.01), (0.0, 0.0, 0.0), 30.0)
    stored = passes.Stored("bumps", tuple(f"cube {k}" for k in range(len(cubes))), 0.25, ROUGHNESS)
    surface = surfaces.plane().rotated(rotation("x", -90.0))
    draws = (
        (passes.plain_pass(surface, stored, view),) if plain else passes.rough_passes(surface, stored, view)
    )
    commands = (
        *passes.load_cubes(cubes, stored, profile),
        passes.load_bumps(levels, stored, profile),
        view.panel.clear((0.0, 0.0, 0.0)),
        *draws,
    )
    if profile is IDEAL:
        return execute_ideal(commands, SIZE, SIZE).color[..., :3]
    return execute(commands, profile, SIZE, SIZE).framebuffer.color[..., :3] / 255.0


def of_one_roughness(deviation):
    """A bump map without bumps: a pyramid whose roughness is the same everywhere."""
    return rough.pyramid(np.zeros((4, 4, 2)), (deviation * deviation, 0.0, deviation * deviation))


@pytest.mark.parametrize("name", ["IDEAL", "GEFORCE_3", "NV2A"])
@pytest.mark.parametrize("share", [0.0, 0.2, 0.5, 0.66, 0.875, 1.0])
def test_the_roughness_picks_its_cube_map(name, share):
    profile = IDEAL if name == "IDEAL" else PROFILES[name]
    gray = [np.full((6, 4, 4, 3), level) for level in (0.1, 0.9, 0.3, 0.7, 0.5)]
    seen = drawn(profile, of_one_roughness(share * ROUGHNESS), gray)
    expected = np.interp(share * ROUGHNESS, DEVIATIONS, [0.1, 0.9, 0.3, 0.7, 0.5])
    # A step of alpha is 4 of a weight's 255; weights of bytes miss one by as much.
    assert np.abs(seen - expected).max() <= (1e-9 if profile is IDEAL else 0.022)


def test_a_constant_environment_stays_it_through_any_roughness():
    levels = rough_mirrors.cube_pyramid(np.full((6, 16, 16, 3), 0.25))
    for isotropic in (False, True):
        cube = passes.rough_cube(levels, FRAME, 0.2, 8, isotropic=isotropic)
        assert np.abs(cube - 0.25).max() <= 1e-12


def test_roughness_spreads_less_across_the_plane_of_incidence():
    """A point low over the plane: an upright streak, round where the spread is asked to be."""
    edge = 64
    cube = np.zeros((6, edge, edge, 3))
    toward = cube_maps.directions(edge)
    point = np.array([0.0, np.sin(0.2), -np.cos(0.2)])
    cube[(toward @ point) > np.cos(0.05)] = 1.0
    levels = rough_mirrors.cube_pyramid(cube)
    ratio = []
    for isotropic in (False, True):
        seen = passes.rough_cube(levels, FRAME, 0.08, edge, isotropic=isotropic, most=32)[5, ..., 0]
        s, t = np.meshgrid(np.arange(edge), np.arange(edge))
        weight = seen / seen.sum()
        spread = [np.sqrt((weight * (x - (weight * x).sum()) ** 2).sum()) for x in (s, t)]
        ratio.append(spread[1] / spread[0])
    # Texels of the level that is as wide as the spread are an eighth of a face: they show.
    assert 0.6 <= ratio[1] <= 1.4
    assert ratio[0] >= 2.5 * ratio[1]


@pytest.mark.parametrize("name", ["IDEAL", "NV2A"])
def test_a_smooth_plane_mirrors_as_the_floats_do(name):
    profile = IDEAL if name == "IDEAL" else PROFILES[name]
    cube = bumped_reflections.environments.faces(64, colored)
    bumps = 0.02 * np.cos(2.0 * np.pi * np.arange(16) / 16.0)
    offsets = np.stack(np.broadcast_arrays(bumps[None, :], 0.5 * bumps[:, None]), axis=-1)
    levels = rough.pyramid(offsets)
    view = perspective_view(Panel(0, 0, SIZE, SIZE), (0.0, 2.0, 0.01), (0.0, 0.0, 0.0), 30.0)
    mirror = rough_mirrors.Mirror(origin=(-1.0, 0.0, 1.0), period=2.0)
    expected = rough_mirrors.picture(view, mirror, levels, (cube,), "none")[::-1]
    seen = drawn(profile, levels, [cube] * passes.ROUGHNESSES, plain=True)
    inside = np.s_[4:-4, 4:-4]
    assert np.abs(seen - expected)[inside].max() <= (2e-3 if profile is IDEAL else 0.012)


def test_the_largest_numbers_are_found_and_never_zero():
    levels = rough.pyramid(np.zeros((4, 4, 2)))
    assert passes.largest(levels) == (2.0**-10, 2.0**-10)
    bumps = np.zeros((4, 4, 2))
    bumps[0, 0, 1] = -0.5
    offset, roughness = passes.largest(rough.pyramid(bumps))
    assert offset == 0.5
    assert roughness == pytest.approx(0.5 * np.sqrt(3.0) / 4.0)


def test_curvature_is_what_half_a_texel_differs_by():
    slope = np.arange(8) / 8.0
    offsets = np.stack([np.broadcast_to(slope, (8, 8)), np.zeros((8, 8))], axis=-1)
    levels = rough.pyramid(offsets)
    added = passes.with_curvature(levels)[1].covariance - levels[1].covariance
    # Texels of level 1 are a quarter apart; half of one is an eighth.
    assert added[0, 1].tolist() == [1.0 / 64.0, 0.0, 0.0]
    assert passes.with_curvature(levels)[0] is levels[0]


def test_bad_input_is_refused_with_a_sentence():
    names = tuple("abcde")
    with pytest.raises(ValueError, match="2 cube maps are named; give 5"):
        passes.Stored("bumps", ("a", "b"), 0.25, 0.2)
    for offset, roughness in ((0.0, 0.2), (0.25, np.nan)):
        with pytest.raises(ValueError, match="stored as one"):
            passes.Stored("bumps", names, offset, roughness)
    with pytest.raises(ValueError, match="3 cube maps and 5 names"):
        passes.load_cubes([np.zeros((6, 2, 2, 3))] * 3, passes.Stored("bumps", names, 0.25, 0.2), IDEAL)
    levels = rough_mirrors.cube_pyramid(np.zeros((6, 4, 4, 3)))
    for deviation in (-0.1, np.inf):
        with pytest.raises(ValueError, match="give a number from zero on"):
            passes.rough_cube(levels, FRAME, deviation, 4)
