"""Tangent space of triangles and of vertices, two perturbed normals, what is found in bad coordinates."""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.effects.bump_mapping import tangent_space
from fixedpipe.effects.bump_mapping.tangent_space import Mirrored, ZeroArea
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.vectors import cross, dot, normalize


def triangles(count=200, seed=1):
    """Random triangles and texture coordinates, none nearly without area."""
    random = np.random.default_rng(seed)
    points, coordinates = random.normal(size=(count, 3, 3)), random.normal(size=(count, 3, 2))
    kept = np.abs(tangent_space.texture_areas(coordinates)) > 0.1
    return points[kept], coordinates[kept]


def angle(a, b):
    return float(np.degrees(np.arccos(np.clip(dot(a, b), -1.0, 1.0))))


def test_the_map_takes_texture_coordinates_to_the_corners():
    points, coordinates = triangles()
    maps = tangent_space.affine_maps(points, coordinates)
    assert np.abs(tangent_space.mapped(maps, coordinates) - points).max() <= 1e-12
    # As the document writes it: the corners times the inverse of the coordinates.
    corners = np.concatenate([coordinates, np.ones((*coordinates.shape[:2], 1))], axis=-1)
    inverse = np.linalg.inv(np.swapaxes(corners, 1, 2))
    np.testing.assert_allclose(maps, np.swapaxes(points, 1, 2) @ inverse, atol=1e-10)


def test_far_texture_coordinates_keep_their_digits():
    points, coordinates = triangles(20)
    near, far = (tangent_space.affine_maps(points, coordinates + d) for d in (0.0, 1024.0))
    np.testing.assert_allclose(near[..., :2], far[..., :2], atol=1e-9)


def test_the_maps_columns_are_its_finite_differences():
    maps = tangent_space.affine_maps(*triangles(20))
    t, b, n = tangent_space.frames(maps)
    place, step = np.array([[[0.3, 0.7]]]), 2.0**-10
    for vector, axis in ((t, 0), (b, 1)):
        ahead, back = (
            tangent_space.mapped(maps, np.broadcast_to(place + s * step * np.eye(2)[axis], (len(maps), 1, 2)))
            for s in (1.0, -1.0)
        )
        np.testing.assert_allclose((ahead - back)[:, 0] / (2.0 * step), vector, atol=1e-10)
    np.testing.assert_allclose(n, np.cross(t, b))


def test_triangles_without_area_in_texture_space_have_no_map():
    points, coordinates = triangles(3)
    coordinates[1, 2] = 0.5 * (coordinates[1, 0] + coordinates[1, 1])
    with pytest.raises(ValueError, match=r"1 triangle has no area in texture space \(number 1\)"):
        tangent_space.affine_maps(points, coordinates)


@pytest.mark.parametrize(
    ("t", "b", "degrees"),
    [
        ((2.0, 0.0, 0.0), (0.0, 2.0, 0.0), 0.0),
        ((0.0, 0.5, 0.0), (0.0, 0.0, 0.5), 0.0),
        ((2.0, 0.0, 0.0), (0.0, 1.0, 0.0), 9.897),
        ((1.0, 0.0, 0.0), (0.5, 1.0, 0.0), 9.078),
    ],
)
def test_the_documents_normal_is_the_displaced_surfaces_without_stretch_alone(t, b, degrees):
    t, b = np.array(t), np.array(b)
    printed = tangent_space.printed_normals(t, b, 0.3, -0.2)
    displaced = tangent_space.displaced_normals(t, b, 0.3, -0.2)
    assert abs(angle(printed, displaced) - degrees) < 1e-3
    # What is printed is [t b n] (-d_u, -d_v, 1).
    matrix = np.stack([t, b, cross(t, b)], axis=-1)
    np.testing.assert_allclose(printed, normalize(matrix @ np.array([-0.3, 0.2, 1.0])), atol=1e-15)


def test_a_stretch_of_two_to_one_has_the_catalogues_numbers():
    t, b = np.array([2.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
    printed = tangent_space.printed_normals(t, b, 0.3, -0.2)
    displaced = tangent_space.displaced_normals(t, b, 0.3, -0.2)
    np.testing.assert_allclose(printed / printed[2], [-0.3, 0.1, 1.0], atol=1e-15)
    np.testing.assert_allclose(displaced / displaced[2], [-0.15, 0.2, 1.0], atol=1e-15)


def test_displaced_normals_are_those_of_a_displaced_plane():
    """A sheared plane p(u, v), moved by a bilinear d along its normal: its normal by finite differences."""
    t, b, d_u, d_v = np.array([1.3, 0.2, 0.1]), np.array([0.4, 0.9, -0.3]), 0.25, -0.4
    normal = normalize(cross(t, b))

    def surface(u, v):
        return u * t + v * b + (d_u * u + d_v * v) * normal

    step = 1e-6
    along_u = surface(step, 0.0) - surface(-step, 0.0)
    along_v = surface(0.0, step) - surface(0.0, -step)
    np.testing.assert_allclose(
        tangent_space.displaced_normals(t, b, d_u, d_v), normalize(cross(along_u, along_v)), atol=1e-9
    )


@pytest.mark.parametrize(
    "surface",
    [surfaces.plane(4, 3), surfaces.sphere(48, 24).rotated(rotation("x", 20.0)), surfaces.torus(48, 24)],
    ids=["plane", "sphere", "torus"],
)
def test_vertex_tangents_follow_the_surfaces_own(surface):
    own = tangent_space.with_tangents(surface)
    # At the seam triangles lie on one side: half a slice of 7.5 degrees.
    cosine = 0.9975
    inner = np.abs(surface.texture_coordinates[:, 1] - 0.5) < 0.45
    assert dot(own.tangents, surface.tangents)[inner].min() > cosine
    assert dot(own.binormals, surface.binormals)[inner].min() > cosine
    for axis in (own.tangents, own.binormals):
        np.testing.assert_allclose(dot(axis, axis), 1.0, atol=1e-5)
        np.testing.assert_allclose(dot(axis, own.normals), 0.0, atol=1e-5)


def test_at_a_vertex_tangents_are_averaged():
    """Two squares at a right angle that share an edge along v: the tangent there is half way."""
    positions = np.array([(-1, 0, 0), (0, 0, 0), (0, 0, -1), (-1, 1, 0), (0, 1, 0), (0, 1, -1)], np.float64)
    coordinates = np.array([(0, 0), (1, 0), (2, 0), (0, 1), (1, 1), (2, 1)], np.float64)
    faces = np.array([(0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4)])
    half = np.sqrt(0.5)
    normals = np.array([(0, 0, 1), (half, 0, half), (1, 0, 0)] * 2, np.float64)
    nothing = np.zeros((6, 3))
    surface = surfaces.Surface(positions, normals, nothing, nothing, coordinates, faces)
    own = tangent_space.with_tangents(surface)
    np.testing.assert_allclose(own.tangents[0], (1, 0, 0), atol=1e-15)
    np.testing.assert_allclose(own.tangents[2], (0, 0, -1), atol=1e-15)
    # Three triangles meet at vertex 1, one of the first square, two of the second, and still it is no zero.
    np.testing.assert_allclose(dot(own.tangents[1], normals[1]), 0.0, atol=1e-15)
    np.testing.assert_allclose(own.binormals, [(0, 1, 0)] * 6, atol=1e-15)


def bad_plane():
    """A strip of four squares: good, mirrored, without area, and stretched five times."""
    surface = surfaces.plane(4, 1)
    u = surface.texture_coordinates[:, 0]
    split = [replace(surface, triangles=surface.triangles[2 * k : 2 * k + 2]) for k in range(4)]
    quads = []
    for k, part in enumerate(split):
        corners = np.unique(part.triangles)
        coordinates = part.texture_coordinates[corners].copy()
        across = (u[corners] - u[corners].min()) * 4.0
        coordinates[:, 0] = (across, 1.0 - across, 0.5 + 0.0 * across, 0.1 * across)[k]
        coordinates[:, 1] *= 2.0
        quads.append((part, corners, coordinates))
    names = ("positions", "normals", "tangents", "binormals")
    arrays = {name: np.concatenate([getattr(p, name)[c] for p, c, _ in quads]) for name in names}
    faces = np.concatenate([np.searchsorted(c, p.triangles) + 4 * k for k, (p, c, _) in enumerate(quads)])
    return surfaces.Surface(
        **arrays, texture_coordinates=np.concatenate([c for *_, c in quads]), triangles=faces
    )


def test_what_is_wrong_with_a_mesh_is_found_with_how_much():
    report = tangent_space.examine_surface(bad_plane())
    assert report.zero_area.tolist() == [4, 5]
    assert report.mirrored.tolist() == [2, 3]
    assert report.stretched.tolist() == [6, 7]
    np.testing.assert_allclose(report.stretch[[0, 2, 6]], [2.0, 2.0, 5.0], rtol=1e-12)
    assert np.isinf(report.stretch[4])
    np.testing.assert_allclose(report.areas, [2, 2, -2, -2, 0, 0, 0.2, 0.2], atol=1e-12)
    text = report.text()
    assert "2 triangles have no area in texture space and no tangent space (numbers 4, 5)" in text
    assert "2 triangles have mirrored texture coordinates (numbers 2, 3)" in text
    assert "at most 5 times" in text
    assert not report.clean
    assert tangent_space.examine_surface(surfaces.plane(2, 2)).clean


def test_a_stretch_is_the_ratio_of_singular_values():
    random = np.random.default_rng(3)
    t, b = random.normal(size=(2, 50, 3))
    values = np.linalg.svd(np.stack([t, b], axis=-1), compute_uv=False)
    np.testing.assert_allclose(tangent_space.stretches(t, b), values[:, 0] / values[:, 1], rtol=1e-8)
    assert np.isinf(tangent_space.stretches(t, 2.0 * t)).all()


def test_bad_triangles_are_refused_dropped_or_handled_as_asked():
    surface = bad_plane()
    with pytest.raises(ValueError, match=r"2 triangles have no area .* ZeroArea.DROP"):
        tangent_space.with_tangents(surface)
    with pytest.raises(ValueError, match="mirrored"):
        tangent_space.with_tangents(surface, ZeroArea.DROP, Mirrored.REFUSE)
    with pytest.raises(ValueError, match=r"give one of ZeroArea.REFUSE, ZeroArea.DROP, ZeroArea.KEEP"):
        tangent_space.with_tangents(surface, "ignore")
    kept = tangent_space.with_tangents(surface, ZeroArea.DROP)
    assert len(kept.triangles) == 6
    x = np.array([1.0, 0.0, 0.0])
    good, mirrored = (kept.triangles[k] for k in (0, 2))
    np.testing.assert_allclose(kept.tangents[good], [x] * 3)
    np.testing.assert_allclose(kept.tangents[mirrored], [-x] * 3)
    # n x t turns round with t; the sign turns b back, along which v grows.
    np.testing.assert_allclose(kept.binormals[np.concatenate([good, mirrored])], [(0.0, 1.0, 0.0)] * 6)
    assert len(tangent_space.with_tangents(surface, ZeroArea.DROP, Mirrored.DROP).triangles) == 4
    assert len(tangent_space.with_tangents(surface, ZeroArea.KEEP).triangles) == 8
    turned = tangent_space.with_tangents(surface, ZeroArea.DROP, Mirrored.MIRROR)
    assert tangent_space.examine_surface(turned).mirrored.size == 0
    np.testing.assert_allclose(turned.tangents[turned.triangles[2]], [x] * 3)
    np.testing.assert_allclose(cross(turned.tangents, turned.binormals), turned.normals, atol=1e-12)


def test_vertices_that_a_mirrored_triangle_shares_become_two():
    """A fold: two squares that share an edge, the texture running towards it from both sides."""
    surface = surfaces.plane(2, 1)
    s = surface.texture_coordinates.copy()
    s[:, 0] = 1.0 - np.abs(2.0 * s[:, 0] - 1.0)
    folded = tangent_space.with_tangents(replace(surface, texture_coordinates=s))
    assert len(folded.positions) == 8
    left, right = (folded.triangles[k] for k in (0, 2))
    np.testing.assert_allclose(folded.tangents[left], [(1.0, 0.0, 0.0)] * 3)
    np.testing.assert_allclose(folded.tangents[right], [(-1.0, 0.0, 0.0)] * 3)
