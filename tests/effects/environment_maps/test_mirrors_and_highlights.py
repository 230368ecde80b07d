"""Mirrors over diffuse light (H22, H23) and highlights in maps (H31)."""

import numpy as np
import pytest

from fixedpipe.effects.environment_maps import highlight_maps, mirror_passes
from fixedpipe.effects.geometry import cube_maps, surfaces
from fixedpipe.effects.geometry.views import Panel, perspective_view
from fixedpipe.effects.passes.draws import EDGE, REPLACE, unit
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.profiles import OPENGL_1_2
from fixedpipe.pipeline.state import PassState, VertexState, Viewport

SIZE = 64
LIGHTS = (((1.0, 1.0, 1.0), (0.5, 0.25, 1.0)), ((-1.0, 0.2, 0.6), (0.25, 0.5, 0.0)))


def test_lobes_add_up_in_a_cube_map():
    """Each light's colour where the map looks at it, a power of the cosine beside."""
    cube = highlight_maps.cube(32, LIGHTS, 8)
    toward = cube_maps.directions(32)
    expected = sum(
        np.maximum(toward @ (np.array(light) / np.linalg.norm(light)), 0.0)[..., None] ** 8 * np.array(color)
        for light, color in LIGHTS
    )
    np.testing.assert_allclose(cube, expected, atol=1e-12)


@pytest.mark.parametrize("exponent", [0, -1, 2.5, True])
def test_exponents_that_are_no_whole_numbers_are_refused(exponent):
    """They would need a library's power, whose last bit differs between processors."""
    with pytest.raises(ValueError, match="a whole number from 1 on"):
        highlight_maps.powers(np.ones(1), exponent)


def test_a_sphere_map_is_drawn_as_its_directions_say():
    """The window's copy against the lobes at the directions that SPHERE_MAP has for its texels."""
    view = perspective_view(Panel(0, 0, SIZE, SIZE), (1.0, 0.5, 3.0))
    commands = highlight_maps.draw_sphere_map("map", LIGHTS, 4, view, SIZE, OPENGL_1_2)
    shown = Draw(
        label="show the map",
        mesh=surfaces.plane().mesh(),
        state=PassState(
            vertex=VertexState(viewport=Viewport(0, 0, SIZE, SIZE)),
            texture_units=(unit("map", EDGE, environment=REPLACE),),
        ),
    )
    image = execute((*commands, shown), OPENGL_1_2, SIZE, SIZE).image()[::-1, :, :3] / 255.0
    edge = 2.0 * (np.arange(SIZE) + 0.5) / SIZE - 1.0
    x, y = np.meshgrid(edge, edge)
    inside = x * x + y * y < 0.9
    z = np.sqrt(np.maximum(0.0, 1.0 - x * x - y * y))
    in_eye = np.stack([2.0 * z * x, 2.0 * z * y, 2.0 * z * z - 1.0], axis=-1)
    expected = highlight_maps.highlights(in_eye @ np.array(view.modelview)[:3, :3], LIGHTS, 4)
    assert np.abs(image - np.minimum(expected, 1.0))[inside].max() < 0.02


def test_weights_are_from_zero_to_one():
    """What a vertex colour can hold."""
    mesh = surfaces.plane().mesh()
    assert (np.asarray(mirror_passes.weighted_mesh(mesh, 0.25).colors)[:, :3] == 0.25).all()
    for weight in (-0.1, 1.5, float("nan")):
        with pytest.raises(ValueError, match="a number from 0 to 1"):
            mirror_passes.weighted_mesh(mesh, weight)
