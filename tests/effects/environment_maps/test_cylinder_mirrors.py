"""S07: the panorama's coordinates on a cylinder, and its pictures, against rays."""

import numpy as np
import pytest

from fixedpipe.effects.environment_maps import cylinder_mirrors as cylinders
from fixedpipe.effects.geometry.vectors import normalize
from fixedpipe.effects.geometry.views import Panel, perspective_view
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.profiles import NV2A, TEXRAM

PIPE, EYE = cylinders.Pipe(0.3, -0.2, 0.4), (0.1, 0.15, 2.4)


def test_coordinates_at_the_vertices_are_the_mirrored_ray_s():
    mesh = cylinders.mesh(PIPE, EYE, 24, 6)
    positions = mesh.positions[:, :3]
    normals = normalize((positions - [PIPE.x, 0.0, PIPE.z]) * [1.0, 0.0, 1.0])
    ray = positions - EYE
    r = ray - 2.0 * (ray * normals).sum(axis=-1)[:, None] * normals
    s = np.arctan2(r[:, 0], -r[:, 2]) / (2.0 * np.pi)
    t = np.arctan2(r[:, 1], np.hypot(r[:, 0], r[:, 2])) / np.pi + 0.5
    found = np.asarray(mesh.texture_coordinates[0])
    apart = found[:, 0] - s
    # Angles have 20 bits of a turn, positions 20 bits of sine and cosine.
    assert np.abs(apart - np.round(apart)).max() <= 1e-5
    assert np.abs(found[:, 1] - t).max() <= 1e-5
    assert np.abs(np.diff(found[:25, 0])).max() <= 0.1, "coordinates jump between vertices"


def test_the_truth_of_one_sample_is_the_texel_under_the_ray():
    view = perspective_view(Panel(0, 0, 48, 48), EYE, field_of_view=40.0)
    picture = cylinders.shelves(32)
    found = cylinders.supersampled(view, (PIPE,), picture, side=1)
    commands = (
        cylinders.load(picture, NV2A),
        view.panel.clear((0.0, 0.0, 0.0)),
        *cylinders.pipe_passes((PIPE,), view, cylinders.sampler(lod=0.0), 96, 16),
    )
    drawn = execute(commands, NV2A, 48, 48).image()[::-1, :, :3] / 255.0
    full = found[..., 3] == 1.0
    apart = np.abs(drawn - found[..., :3]).max(axis=-1)[full]
    # Bytes, and coordinates of 8 fraction bits; next to the outlines a facet is not the round pipe.
    assert np.quantile(apart, 0.8) <= 0.02, np.quantile(apart, [0.5, 0.8, 0.9, 0.99])
    assert 0.05 < full.mean() < 0.9


def test_the_truth_is_the_same_for_any_number_of_threads():
    view = perspective_view(Panel(0, 0, 20, 16), EYE, field_of_view=40.0)
    first, other = (
        cylinders.supersampled(view, (PIPE,), cylinders.shelves(16), side=2, threads=count)
        for count in (1, 3)
    )
    assert first.tobytes() == other.tobytes()


@pytest.mark.parametrize(("profile", "way"), [(NV2A, {"max_anisotropy": 8.0}), (TEXRAM, {"max_probes": 8})])
def test_one_colour_stays_it(profile, way):
    view = perspective_view(Panel(0, 0, 16, 16), EYE, field_of_view=30.0)
    plain = np.full((16, 32, 3), 0.6)
    commands = (
        cylinders.load(plain, profile),
        view.panel.clear((0.6, 0.6, 0.6)),
        *cylinders.pipe_passes((PIPE,), view, cylinders.sampler(**way), 24, 4),
    )
    assert (execute(commands, profile, 16, 16).image()[..., :3] == 153).all()
