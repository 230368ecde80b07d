"""Surfaces: their frames, their closedness, and OBJ files good and bad."""

import math
from collections import Counter

import numpy as np
import pytest

from fixedpipe.effects.geometry import surfaces, triangle_meshes
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.vectors import TRIGONOMETRY_STEP, cross, dot

SURFACES = {
    "plane": surfaces.plane(3, 2),
    "sphere": surfaces.sphere(),
    "torus": surfaces.torus(24, 12),
    "torus seen from a point": surfaces.torus(48, 12, seen_from=(2.0, 3.0, -1.0)),
    "turned sphere": surfaces.sphere(12, 6).rotated(rotation("x", 33.0)),
}

CUBE = """
# a cube with texture coordinates and quads
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1
v 1 0 1
v 1 1 1
v 0 1 1
vt 0 0
vt 1 0
vt 1 1
vt 0 1
f 5/1 6/2 7/3 8/4
f 2/1 1/2 4/3 3/4
f 6/1 2/2 3/3 7/4
f 1/1 5/2 8/3 4/4
f 8/1 7/2 3/3 4/4
f 1/1 2/2 6/3 5/4
"""


def faces(surface):
    corners = surface.positions[surface.triangles]
    return corners, cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


@pytest.mark.parametrize("name", SURFACES)
def test_frames_are_orthonormal_and_right_handed(name):
    s = SURFACES[name]
    tolerance = 4 * TRIGONOMETRY_STEP  # sines and cosines are rounded to this step
    for a in (s.normals, s.tangents, s.binormals):
        assert np.allclose(dot(a, a), 1.0, atol=tolerance)
    assert np.abs(dot(s.normals, s.tangents)).max() < tolerance
    assert np.allclose(cross(s.tangents, s.binormals), s.normals, atol=tolerance)


@pytest.mark.parametrize("name", SURFACES)
def test_triangles_have_an_area_and_face_outwards(name):
    surface = SURFACES[name]
    _, face = faces(surface)
    assert (dot(face, surface.normals[surface.triangles].mean(axis=1)) > 0).all()


@pytest.mark.parametrize("name", SURFACES)
def test_tangents_and_binormals_follow_the_texture_coordinates(name):
    surface = SURFACES[name]
    corners, _ = faces(surface)
    st = surface.texture_coordinates[surface.triangles]
    frame = [getattr(surface, n)[surface.triangles].mean(axis=1) for n in ("tangents", "binormals")]
    for k in (1, 2):
        step, moved = corners[:, k] - corners[:, 0], st[:, k] - st[:, 0]
        for axis in (0, 1):
            alone = (np.abs(moved[:, axis]) > 1e-9) & (np.abs(moved[:, 1 - axis]) < 1e-9)
            along = dot(step, frame[axis])[alone] * np.sign(moved[alone, axis])
            assert (along > 0).all()


def edge_uses(surface):
    """How often each directed edge between positions is used."""
    _, place = np.unique(np.round(surface.positions / TRIGONOMETRY_STEP), axis=0, return_inverse=True)
    at = place.ravel()[surface.triangles]
    return Counter((int(a), int(b)) for t in at for a, b in zip(t, np.roll(t, -1), strict=True))


@pytest.mark.parametrize("surface", [surfaces.sphere(10, 6), surfaces.torus(8, 6)], ids=["sphere", "torus"])
def test_a_closed_surface_uses_every_edge_once_in_each_direction(surface):
    uses = edge_uses(surface)
    assert set(uses.values()) == {1}
    assert all((b, a) in uses for a, b in uses)


def test_the_sphere_of_figure_4_has_2500_triangles():
    assert len(surfaces.sphere(50, 26).triangles) == 2500


@pytest.mark.parametrize(("slices", "stacks"), [(3, 2), (5, 2), (8, 5)])
def test_a_sphere_has_two_triangles_per_cell_and_one_at_the_poles(slices, stacks):
    assert len(surfaces.sphere(slices, stacks).triangles) == 2 * slices * (stacks - 1)


def test_sphere_frames_agree_with_the_spheres_vertices():
    sphere = surfaces.sphere(12, 7)
    normals, tangents, binormals = surfaces.sphere_frames(*sphere.texture_coordinates.T)
    for a, b in ((normals, sphere.normals), (tangents, sphere.tangents), (binormals, sphere.binormals)):
        assert np.array_equal(a, b)


def test_the_sphere_faces_the_viewer_with_the_middle_of_its_texture():
    normal, tangent, binormal = surfaces.sphere_frames(np.array(0.5), np.array(0.5))
    assert np.array_equal(np.stack([tangent, binormal, normal]), np.eye(3))


@pytest.mark.parametrize("point", [(2.0, 3.0, -1.0), (-3.0, -4.0, 0.5), (0.0, 5.0, 0.0)])
def test_the_silhouette_of_a_torus_lies_along_edges_of_the_mesh_that_is_made_for_it(point):
    around, across = 96, 16
    made, plain = (surfaces.torus(around, across, 0.62, 0.2, seen) for seen in (point, None))
    rows = np.arange(len(made.triangles)).reshape(across, around, 2)
    faced = []
    for surface in (made, plain):
        corners, face = faces(surface)
        faced.append((dot(face, np.array(point) - corners[:, 0]) > 0.0)[rows])
    # Half of the strips face the point, each of them as a whole.
    assert faced[0][: across // 2].all() and not faced[0][across // 2 :].any()
    if point[0]:
        assert any(0 < strip.sum() < strip.size for strip in faced[1])


def test_vertex_coordinates_are_multiples_of_the_trigonometry_step_squared():
    scaled = surfaces.sphere(17, 9).positions / TRIGONOMETRY_STEP**2
    assert np.array_equal(scaled, np.round(scaled))


@pytest.mark.parametrize(
    ("make", "what"),
    [
        (lambda: surfaces.plane(0, 1), "columns is 0; give at least 1"),
        (lambda: surfaces.sphere(2, 4), "slices is 2; give at least 3"),
        (lambda: surfaces.sphere(8, 1), "stacks is 1; give at least 2"),
        (lambda: surfaces.torus(8, 8, 0.3, 0.5), "give one between 0 and the torus's radius"),
        (lambda: surfaces.torus(8, 9, seen_from=(0.0, 2.0, 0.0)), "9 segments across the tube; give an even"),
    ],
)
def test_a_surface_that_cannot_be_is_refused_in_a_sentence(make, what):
    with pytest.raises(ValueError, match=what):
        make()


def test_a_cube_is_read_from_obj_with_its_texture_coordinates():
    cube = triangle_meshes.read_obj(CUBE)
    assert len(cube.triangles) == 12
    _, face = faces(cube)
    assert dot(face, face) == pytest.approx(np.ones(12))
    assert set(map(tuple, cube.texture_coordinates.tolist())) == {(0, 0), (1, 0), (1, 1), (0, 1)}
    assert set(edge_uses(cube).values()) == {1}
    assert np.allclose(cross(cube.tangents, cube.binormals), cube.normals)


def test_joined_surfaces_keep_their_triangles_in_order():
    parts = surfaces.box(), surfaces.sphere(8, 4).moved(3.0, 0.0, 0.0), surfaces.plane()
    whole = surfaces.joined(*parts)
    for name in ("positions", "normals", "tangents", "binormals", "texture_coordinates"):
        separate = [getattr(part, name)[part.triangles] for part in parts]
        assert np.array_equal(getattr(whole, name)[whole.triangles], np.concatenate(separate))
    with pytest.raises(ValueError, match="number of surfaces to join is 0"):
        surfaces.joined()


def test_normals_are_averaged_over_the_triangles_that_share_a_position():
    cube = triangle_meshes.read_obj(CUBE)
    at = np.flatnonzero((cube.positions == 1.0).all(axis=1))
    # In the corner (1, 1, 1) meet two triangles of the front face, one of the right and one of the upper
    # face.
    assert np.allclose(cube.normals[at], np.array([1.0, 1.0, 2.0]) / np.sqrt(6.0))


def test_given_normals_and_negative_indices_are_used():
    text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0.6 0.8\nf -3//-1 -2//-1 -1//-1\n"
    surface = triangle_meshes.read_obj(text)
    assert np.allclose(surface.normals, [0.0, 0.6, 0.8])
    assert np.abs(dot(surface.tangents, surface.normals)).max() < 1e-15


def test_mirrored_texture_coordinates_turn_the_binormal_round():
    points = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]])
    plain = triangle_meshes.from_triangles(points, np.array([[[0.0, 0], [1, 0], [0, 1]]]))
    mirrored = triangle_meshes.from_triangles(points, np.array([[[0.0, 0], [-1, 0], [0, 1]]]))
    assert np.allclose(plain.tangents, [1, 0, 0])
    assert np.allclose(plain.binormals, [0, 1, 0])
    assert np.allclose(mirrored.tangents, [-1, 0, 0])
    assert np.allclose(mirrored.binormals, [0, 1, 0])


def test_texture_coordinates_are_made_where_they_are_missing_and_keep_triangles_together():
    bare = surfaces.sphere(16, 9)
    surface = triangle_meshes.from_triangles(bare.positions[bare.triangles])
    spread = np.ptp(surface.texture_coordinates[surface.triangles][..., 0], axis=1)
    middle = np.abs(surface.positions[surface.triangles][..., 1]).max(axis=1) < 0.9
    assert spread[middle].max() < 0.2
    assert np.allclose(dot(surface.tangents, surface.tangents), 1.0)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "has no faces"),
        ("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "no triangle with an area"),
        ("v 0 0\n", r"line 1: a vertex needs at least 3 numbers, found 2"),
        ("v 0 0 0\nv a b c\n", "line 2: a vertex must be numbers, found 'a b c'"),
        ("v 0 0 nan\n", "line 1: a vertex must be finite numbers"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "line 4: vertex index 4 does not exist; there are 3"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n", "line 4: vertex index 0 does not exist"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -4\n", "line 4: vertex index before the first does not exist"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n", "line 4: a face has 2 corners"),
        (
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 x\n",
            "line 4: a face corner is 'x'; its indices must be whole numbers",
        ),
        ("v 0 0 0\nf 1/1/1/1 1 1\n", "line 2: a face corner is '1/1/1/1'; write it v, v/vt"),
    ],
)
def test_a_bad_obj_file_is_refused_with_the_line_and_what_is_wrong(text, sentence):
    with pytest.raises(ValueError, match=sentence):
        triangle_meshes.read_obj(text, "bad.obj")


def test_a_concave_face_is_cut_into_triangles_within_it():
    """A star of ten corners in a slanted plane, from each corner on and both ways round: its own area."""
    angles = np.arange(10) * (math.pi / 5.0)
    radii = np.where(np.arange(10) % 2, 1.0, 0.4)
    x, y = radii * np.cos(angles), radii * np.sin(angles)
    flat_area = 0.5 * abs(float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum()))
    text = "".join(f"v {a!r} {b!r} {0.5 * a!r}\n" for a, b in np.stack([x, y], axis=-1).tolist())
    for order in [np.roll(np.arange(10), k) + 1 for k in range(10)] + [np.arange(10, 0, -1)]:
        surface = triangle_meshes.read_obj(text + "f " + " ".join(map(str, order)) + "\n")
        points = surface.positions[surface.triangles]
        face = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
        assert len(face) == 8
        assert (face @ face[0] > 0.0).all()
        assert 0.5 * np.sqrt((face * face).sum(axis=-1)).sum() == pytest.approx(flat_area * math.sqrt(1.25))


def test_a_face_that_crosses_itself_or_has_too_many_corners_is_refused():
    bow = "v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 1 0\nf 1 2 3 4\n"
    with pytest.raises(ValueError, match="line 5: a face crosses itself"):
        triangle_meshes.read_obj(bow)
    comb = "".join(f"v {k} {k % 2} 0\n" for k in range(300)) + "v 299 -1 0\nv 0 -1 0\n"
    face = " ".join(map(str, range(1, 303)))
    with pytest.raises(ValueError, match="302 corners; cut it into triangles"):
        triangle_meshes.read_obj(f"{comb}f {face}\n")
    # Corners in one line, and one twice, are no crossing.
    hook = "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 2 0\nv 1 3 0\nv 0 4 0\nv 0 2 0\n"
    surface = triangle_meshes.read_obj(hook + "f 4 5 6 7 1 1 2 3\n")
    points = surface.positions[surface.triangles]
    face = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    assert 0.5 * np.abs(face[:, 2]).sum() == pytest.approx(12.0)
