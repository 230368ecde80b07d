"""Fresnel's mirrors (H26 to H28) and refracted light (H30): tables, and one draw for two."""

import numpy as np
import pytest

from fixedpipe.effects.environment_maps import fresnel_passes, reflections, refracted_light
from fixedpipe.effects.figures import FIGURES
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.views import Panel, perspective_view
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.profiles import GEFORCE_256, IDEAL

SIZE = 48


def test_a_table_holds_the_catalogues_numbers():
    """Indices 1.5, 5 and 200 at the angles that the catalogue computed."""
    given = {
        1.5: ((0.0, 0.0400), (82.8, 0.5)),
        5.0: ((0.0, 0.4444), (73.0, 0.4132)),
        200.0: ((0.0, 0.9802), (60.0, 0.9754), (85.0, 0.8965)),
    }
    for index, values in given.items():
        table = fresnel_passes.load_table("F", index, GEFORCE_256).image.levels[0].ravel().reshape(-1, 4)
        assert (table == table[:, :1]).all()
        for degrees, expected in values:
            at = np.cos(np.radians(degrees)) * len(table) - 0.5
            found = np.interp(at, np.arange(len(table)), table[:, 3] / 255.0)
            assert abs(found - expected) < 1.0 / 255.0, (index, degrees)


def test_two_units_draw_in_one_pass_what_one_unit_draws_in_two():
    """Colours and destination alpha within a byte's step."""
    view = perspective_view(Panel(0, 0, SIZE, SIZE), (0.0, 0.0, 4.0))
    ball = surfaces.sphere(24, 12)
    place = (np.arange(8) + 0.5) / 8
    cube = np.broadcast_to(np.stack(np.broadcast_arrays(place, place[:, None], 0.5), axis=-1), (6, 8, 8, 3))
    loading = (
        view.panel.clear((0.1, 0.1, 0.1)),
        reflections.load_cube("map", cube, GEFORCE_256),
        fresnel_passes.load_table("F", 5.0, GEFORCE_256),
    )
    mirror = fresnel_passes.cube_unit("map", view)
    drawn = [
        execute((*loading, *passes(ball, view, "F", mirror)), GEFORCE_256, SIZE, SIZE).image().astype(int)
        for passes in (fresnel_passes.mirror_passes, fresnel_passes.folded_mirror_pass)
    ]
    assert np.abs(drawn[0] - drawn[1]).max() <= 1
    assert drawn[0][SIZE // 2, SIZE // 2, 3] == round(255 * 4.0 / 9.0)


def test_a_disc_reads_refracted_directions_as_a_cube_map_does():
    """The disc's texture matrix finds the direction that a vertex was given."""
    view = perspective_view(Panel(0, 0, SIZE, SIZE), (1.0, 0.5, 3.0))
    mesh = refracted_light.refracted_mesh(surfaces.sphere(24, 12), view, 1.5)
    directions = np.asarray(mesh.texture_coordinates[0], np.float64)[:, :3]
    matrix = np.array(refracted_light.disc_unit("disc", view, 64).matrix)
    s, t, _, q = matrix @ np.concatenate([directions, np.ones((len(directions), 1))], axis=1).T
    facing = ((view.view_vectors(mesh.positions) * mesh.normals).sum(axis=1)) > 0.0
    assert ((s / q)[facing] > 0.0).all()
    assert ((s / q)[facing] < 1.0).all()
    assert ((t / q)[facing] > 0.0).all()
    # The middle of the disc is where the eye looks.
    ahead = np.array(view.modelview)[:3, :3].T @ np.array([0.0, 0.0, -1.0])
    s, t, _, q = matrix @ np.array([*ahead, 1.0])
    np.testing.assert_allclose((s / q, t / q), 0.5, atol=1e-12)


@pytest.mark.parametrize("index", [0.0, -1.5, float("nan"), float("inf")])
def test_indices_that_are_none_are_refused(index):
    """A sentence that says what to give."""
    view = perspective_view(Panel(0, 0, SIZE, SIZE), (0.0, 0.0, 4.0))
    with pytest.raises(ValueError, match="give a number above 0"):
        refracted_light.refracted_mesh(surfaces.sphere(8, 4), view, index)
    if index != float("inf"):
        with pytest.raises(ValueError, match="give numbers above 0"):
            fresnel_passes.load_table("F", index, GEFORCE_256)


@pytest.mark.parametrize(("figure", "size", "bound"), [("F000-5", 192, 0.04), ("H30", 64, 0.04)])
def test_references_are_what_the_ideal_draws(figure, size, bound):
    """Rays and equations at each pixel, the same way up and the same way round as the passes' picture."""
    drawn = FIGURES[figure].render(IDEAL, size, detail=96, environment="white", objects="ball")
    ours = drawn.reference
    there = ours[..., 3] > 0.0
    assert there.mean() > 0.1
    assert np.abs(np.clip(drawn.ideal.color, 0.0, 1.0) - np.clip(ours, 0.0, 1.0))[there][:, :3].mean() < 0.01
    room = FIGURES[figure].render(IDEAL, size, detail=96, objects="ball")
    error = np.clip(room.ideal.color, 0.0, 1.0) - np.clip(room.reference, 0.0, 1.0)
    assert np.sqrt((error[there][:, :3] ** 2).mean()) < bound
