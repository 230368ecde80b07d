"""Utah's teapot: a closed skin whose normals look out, at the poles too; and frames along an axis."""

import numpy as np
import pytest

from fixedpipe.effects.geometry.vectors import cross, dot, normalize
from fixedpipe.effects.scenes.teapot import HEIGHT, REACH, framed_along, teapot


@pytest.fixture(scope="module", params=(1, 4, 9))
def pot(request):
    return teapot(request.param)


def test_frames_are_orthonormal_everywhere(pot):
    axes = (pot.tangents, pot.binormals, pot.normals)
    for k, first in enumerate(axes):
        for m, second in enumerate(axes):
            assert np.abs(dot(first, second) - (k == m)).max() < 1e-12
    assert np.abs(cross(pot.tangents, pot.binormals) - pot.normals).max() < 1e-12


def test_no_triangle_is_degenerate_and_all_face_as_their_normals_do():
    pot = teapot(8)
    a, b, c = (pot.positions[pot.triangles[:, k]] for k in range(3))
    assert len(pot.triangles) == 64 * 64 - 8 * 8
    faces = normalize(cross(b - a, c - a))
    assert np.abs(dot(faces, faces) - 1.0).max() < 1e-9
    assert min(dot(faces, pot.normals[pot.triangles[:, k]]).min() for k in range(3)) > 0.3


def test_it_is_as_large_as_utahs_and_the_right_way_out():
    pot = teapot(12)
    assert pot.positions[:, 1].max() - pot.positions[:, 1].min() == pytest.approx(HEIGHT / REACH)
    assert np.hypot(pot.positions[:, 0], pot.positions[:, 2]).max() < 1.0
    # The belly's radius is just under its control points' two; the spout reaches to the right, not the left.
    assert pot.positions[:, 2].max() * REACH == pytest.approx(2.0, abs=0.02)
    assert pot.positions[:, 0].max() > -pot.positions[:, 0].min()
    a, b, c = (pot.positions[pot.triangles[:, k]] for k in range(3))
    # Signed tetrahedra from the origin: what a skin encloses that looks out is positive.
    assert dot(a, cross(b, c)).sum() / 6.0 > 0.5


def test_the_poles_normals_are_the_axis():
    pot = teapot(4)
    on_axis = np.hypot(pot.positions[:, 0], pot.positions[:, 2]) < 1e-12
    assert on_axis.sum() >= 8
    up = np.sign(pot.positions[on_axis, 1])
    assert np.abs(pot.normals[on_axis] - np.stack([0 * up, up, 0 * up], axis=-1)).max() < 1e-12


def test_patches_meet_without_a_crease():
    pot = teapot(6)
    keys, which = np.unique(np.round(pot.positions, 9), axis=0, return_inverse=True)
    which = which.ravel()
    for key in np.flatnonzero(np.bincount(which) > 1):
        met = pot.normals[which == key]
        # The handle's last control point is one of the belly's, on which it ends.
        if np.abs(keys[key] * REACH - (-2.0, 0.9 - 0.5 * HEIGHT, 0.0)).max() < 1e-6:
            continue
        assert dot(met, met[0]).min() > 0.9, keys[key]


def test_frames_along_an_axis_point_along_it():
    pot = framed_along(teapot(4), (1.0, 0.0, 0.0))
    assert (pot.tangents[:, 0] > -1e-12).all()
    assert np.abs(dot(pot.tangents, pot.normals)).max() < 1e-12
    assert np.abs(dot(pot.tangents, pot.tangents) - 1.0).max() < 1e-12


@pytest.mark.parametrize("pieces", (0, -1, 1.5, True))
def test_a_patch_has_a_whole_number_of_pieces(pieces):
    with pytest.raises(ValueError, match="pieces"):
        teapot(pieces)


@pytest.mark.parametrize("axis", ((0, 0, 0), (1, 2), (np.nan, 0, 1)))
def test_an_axis_is_a_direction(axis):
    with pytest.raises(ValueError, match="axis"):
        framed_along(teapot(1), axis)
