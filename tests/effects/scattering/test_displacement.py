"""The mesh of a height field: its vertices are the texels, its diagonals those of S_i, and it repeats."""

import numpy as np
import pytest

from fixedpipe.effects.acceptance.ray_caster import RayCaster
from fixedpipe.effects.geometry.vectors import dot, unit_vector
from fixedpipe.effects.scattering import height_field, visibility
from fixedpipe.effects.scattering.displacement import relief


@pytest.fixture(scope="module")
def field():
    return height_field.bumps(16, 12, height=0.15)


def test_every_vertex_is_a_texel_and_the_last_ones_repeat_the_first():
    # No two rows or columns of it are alike.
    field = height_field.height_field(np.random.default_rng(3).uniform(0.0, 0.2, (12, 16)))
    surface = relief(field)
    grid = surface.positions.reshape(field.rows + 1, field.columns + 1, 3)
    np.testing.assert_array_equal(grid[:-1, :-1, 2], 2.0 * field.heights)
    np.testing.assert_array_equal(grid[-1, :, 2], grid[0, :, 2])
    np.testing.assert_array_equal(grid[:, -1, 2], grid[:, 0, 2])
    assert (grid[0, 0, :2] == -1.0).all() and (grid[-1, -1, :2] == 1.0).all()
    texel = surface.texture_coordinates * (field.columns, field.rows) - 0.5
    np.testing.assert_allclose(texel, np.rint(texel), atol=1e-12)


def test_a_level_border_is_as_low_as_the_lowest_texel_and_nothing_else_moves(field):
    plain, level = (
        relief(field, level_border).positions.reshape(field.rows + 1, field.columns + 1, 3)
        for level_border in (False, True)
    )
    np.testing.assert_array_equal(level[1:-1, 1:-1], plain[1:-1, 1:-1])
    np.testing.assert_array_equal(level[..., :2], plain[..., :2])
    border = np.ones(plain.shape[:2], bool)
    border[1:-1, 1:-1] = False
    assert (level[border][:, 2] == 2.0 * field.heights.min()).all()
    assert plain[border][:, 2].max() > 2.0 * field.heights.min()


def test_the_diagonals_run_from_lower_left_to_upper_right(field):
    surface = relief(field)
    corners = surface.texture_coordinates[surface.triangles] * (field.columns, field.rows)
    edges = np.rint(corners - np.roll(corners, 1, axis=1)).astype(int)
    slanted = edges[(edges != 0).all(axis=-1)]
    assert len(slanted) == len(surface.triangles)
    assert (slanted[:, 0] == slanted[:, 1]).all()


@pytest.mark.parametrize("light", [(0.8, 0.3, 0.5), (-0.2, 0.9, 0.35), (0.5, -0.5, 0.25)])
def test_rays_among_the_triangles_find_the_shadows_of_the_visibility(field, light):
    light = unit_vector(light, "The light")
    surface = relief(field)
    corners = surface.positions[surface.triangles]
    tiles = [corners + np.array((2.0 * x, 2.0 * y, 0.0)) for x in range(-2, 3) for y in range(-2, 3)]
    grid = surface.positions.reshape(field.rows + 1, field.columns + 1, 3)[:-1, :-1].reshape(-1, 3)
    facing = (dot(field.normals, light) > 0.0).ravel()
    start = grid[facing] + (0.0, 0.0, 1e-9)
    hidden = RayCaster(np.concatenate(tiles)).occluded(start, np.broadcast_to(light, start.shape))
    free = visibility.free_view(field, light).ravel()[facing]
    assert hidden.any() and free.any()
    assert (hidden == free).mean() <= 0.01
