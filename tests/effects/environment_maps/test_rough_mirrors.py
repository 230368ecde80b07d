"""A plane with bumps that mirrors an environment: rays, derivatives and probes against second ways."""

import numpy as np
import pytest

from fixedpipe.effects.bump_mapping import roughness_pyramids as rough
from fixedpipe.effects.environment_maps import rough_mirrors as mirrors
from fixedpipe.effects.geometry import cube_maps
from fixedpipe.effects.geometry.height_fields import hashed
from fixedpipe.effects.geometry.vectors import normalize
from fixedpipe.effects.geometry.views import Panel, perspective_view

MIRROR = mirrors.Mirror(origin=(0.0, -0.1, 0.0), period=3.0)


def a_view(width=24, height=16):
    return perspective_view(Panel(0, 0, width, height), (0.3, 1.0, 0.2), (0.0, 0.8, -1.0), 50.0)


def noise(*shape, seed=1):
    """Numbers from -1 to 1."""
    count = np.arange(int(np.prod(shape)))
    return (hashed(count, count // 7, seed) / 32768.0 - 1.0).reshape(shape)


@pytest.fixture(scope="module")
def levels():
    return rough.pyramid(0.1 * noise(16, 16, 2))


@pytest.fixture(scope="module")
def cube():
    return mirrors.cube_pyramid(0.5 + 0.5 * noise(6, 32, 32, 3, seed=5))


def test_one_sample_a_pixel_is_the_picture_without_antialiasing(levels, cube):
    truth = mirrors.supersampled(a_view(), MIRROR, levels[0].offsets, cube[0], side=1)
    picture = mirrors.picture(a_view(), MIRROR, levels, cube, mirrors.Antialiasing.NONE)
    assert np.abs(truth - picture).max() <= 1e-9


def test_the_truth_is_the_same_for_any_number_of_threads(levels, cube):
    first, other = (
        mirrors.supersampled(a_view(), MIRROR, levels[0].offsets, cube[0], side=3, threads=count)
        for count in (1, 5)
    )
    assert first.tobytes() == other.tobytes()


def test_the_truth_of_a_fine_picture_is_that_of_a_coarse_one(levels, cube):
    coarse = mirrors.supersampled(a_view(), MIRROR, levels[0].offsets, cube[0], side=32)
    fine = mirrors.supersampled(a_view(96, 64), MIRROR, levels[0].offsets, cube[0], side=8)
    fine = fine.reshape(16, 4, 24, 4, 3).mean(axis=(1, 3))
    # Two sets of 1024 samples of noise of deviation 0.3.
    assert np.abs(coarse - fine).mean() <= 0.02


@pytest.mark.parametrize("antialiasing", mirrors.Antialiasing)
@pytest.mark.parametrize("probes", [1, 4])
def test_an_environment_of_one_colour_stays_it(antialiasing, probes, levels):
    plain = mirrors.cube_pyramid(np.broadcast_to([0.25, 0.5, 0.75], (6, 8, 8, 3)))
    picture = mirrors.picture(a_view(), MIRROR, levels, plain, antialiasing, probes=probes)
    assert np.abs(picture - [0.25, 0.5, 0.75]).max() <= 1e-12


def test_the_mirrored_ray_and_what_it_changes_by():
    incoming, frame = normalize(np.array([0.3, -0.5, -0.7])), MIRROR.frame
    f = np.array([0.2, -0.1])
    toward, changes = mirrors.mirrored(incoming, f, frame)
    normal = normalize(frame[2] + f[0] * frame[0] + f[1] * frame[1])
    assert np.abs(toward - (incoming - 2.0 * (incoming @ normal) * normal)).max() <= 1e-15
    for k, step in enumerate(np.eye(2) * 1e-6):
        apart = (
            mirrors.mirrored(incoming, f + step, frame)[0] - mirrors.mirrored(incoming, f - step, frame)[0]
        )
        # Of second order: 1e-12 over 2e-6, and rounding.
        assert np.abs(apart / 2e-6 - changes[k]).max() <= 1e-8


def test_a_small_tilt_turns_the_ray_by_two_of_it_in_the_plane_and_by_the_cosine_across_it():
    incoming = normalize(np.array([0.0, -0.5, -1.0]))
    _, changes = mirrors.mirrored(incoming, np.zeros(2), MIRROR.frame)
    lengths = np.sqrt((changes * changes).sum(axis=-1))
    assert np.abs(lengths - [2.0 * 0.5 / np.sqrt(1.25), 2.0]).max() <= 1e-12


def test_changes_on_a_face_are_differences_of_places():
    toward = normalize(noise(40, 3, seed=3))
    changes = noise(40, 2, 3, seed=4) * 1e-6
    texels, steps = mirrors.face_changes(toward, changes, 64)
    face, s, t = cube_maps.places(toward)
    for k in range(2):
        other, s_k, t_k = cube_maps.places(toward + changes[:, k])
        assert np.array_equal(face, other)
        apart = np.stack([s_k - s, t_k - t], axis=-1) * 32.0
        assert np.abs(apart - texels[:, k]).max() <= 1e-8
    for k, step in enumerate(((1.0, 0.0), (0.0, 1.0))):
        _, s_k, t_k = cube_maps.places(toward + 0.001 * steps[:, k])
        apart = np.stack([s_k - s, t_k - t], axis=-1) * 32.0
        assert np.abs(apart - 0.001 * np.array(step)).max() <= 1e-12


def test_changes_by_pixel_are_differences_of_neighbours(levels, cube):
    view = a_view()
    beam = mirrors.beams(view, MIRROR, levels, mirrors.Antialiasing.MIP)
    inside = beam.hits[:-1, :-1] & beam.hits[1:, :-1] & beam.hits[:-1, 1:]
    for axis, shifted in enumerate((beam.toward[:-1, 1:], beam.toward[1:, :-1])):
        apart = shifted - beam.toward[:-1, :-1]
        wrong = np.abs(apart - beam.by_pixel[:-1, :-1, axis])[inside]
        # Of second order: the products of a pixel's turn, 0.04, and what slopes differ by, up to 0.1.
        assert wrong.mean() <= 0.005


def test_probes_together_have_the_covariance_asked_for():
    d = np.abs(noise(500, 3, seed=9)) * [20.0, 8.0, 3.0] + [0.0, 0.0, 0.6]
    sigma = rough.covariance_of(d)
    long, short, _ = rough.principal(sigma)
    for most in (4, 16):
        _, length, count, level = mirrors.environment_probes(sigma, most)
        each = 2.0**level / 2.0
        variance = each * each + length * length / 12.0 * np.where(count > 1, 1.0 - 1.0 / count**2, 1.0)
        # A level is a multiple of 1/256: the edge is within 0.14 %, twice that squared.
        assert np.abs(variance / (long * long) - 1.0).max() <= 0.003
        whole = count < most
        assert np.abs(each / np.maximum(short, 0.5) - 1.0)[whole].max() <= 0.002
        assert count.max() == most
    _, length, count, level = mirrors.environment_probes(sigma, 1)
    assert (length == 0.0).all() and (count == 1).all()
    assert np.abs(2.0**level / np.maximum(2.0 * long, 1.0) - 1.0).max() <= 0.002


def test_roughness_keeps_the_mean_where_mip_mapping_loses_it():
    """A lamp straight above a rough plane seen from above: bumps spread it over the plane's whole image."""
    toward = cube_maps.directions(64)
    lamp = np.where(toward[..., 1:2] > 0.995, [1.0, 1.0, 1.0], 0.0)
    view = perspective_view(Panel(0, 0, 32, 32), (0.0, 20.0, 0.0), (0.0, 0.0, -1e-3), 40.0)
    pyramid = rough.pyramid(0.15 * noise(32, 32, 2))
    mirror = mirrors.Mirror(period=0.5)
    truth = mirrors.supersampled(view, mirror, pyramid[0].offsets, lamp)
    answers = {
        how: mirrors.picture(view, mirror, pyramid, mirrors.cube_pyramid(lamp), how)
        for how in ("mip", "anisotropic")
    }
    rms = {how: np.sqrt(((one - truth) ** 2).mean()) for how, one in answers.items()}
    assert rms["anisotropic"] <= 0.35 * rms["mip"], rms


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda: mirrors.Mirror(e_2=(1.0, 0.0, 1.0)), "not perpendicular"),
        (lambda: mirrors.Mirror(period=0.0), "above zero"),
        (lambda: mirrors.Mirror(e_1=(0.0, 0.0, 0.0)), "not all zero"),
        (lambda: mirrors.cube_pyramid(np.zeros((6, 3, 3, 3))), "power of two"),
        (lambda: mirrors.supersampled(a_view(), MIRROR, np.zeros((2, 2)), np.zeros((6, 2, 2, 3))), "offsets"),
        (
            lambda: mirrors.supersampled(
                a_view(), MIRROR, np.zeros((2, 2, 2)), np.zeros((6, 2, 2, 3)), side=0
            ),
            "one or more",
        ),
        (
            lambda: mirrors.supersampled(a_view(), MIRROR, np.zeros((2, 2, 2)), np.zeros((2, 2, 3))),
            "cube map",
        ),
    ],
)
def test_what_is_no_mirror_is_refused(call, says):
    with pytest.raises(ValueError, match=says):
        call()
