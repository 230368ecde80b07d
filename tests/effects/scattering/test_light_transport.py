"""Scattered light against what grooves have in closed form, and paths against the gathering of all
directions.
"""

import numpy as np
import pytest

from fixedpipe.effects.scattering import directions as sphere
from fixedpipe.effects.scattering import height_field, light_transport, visibility

ABOVE = np.array([0.0, 0.0, 1.0])


def gains(field, count, bounces):
    seen = visibility.precompute(field, sphere.spiral(count))
    light = light_transport.bounces(field, seen, ABOVE, bounces)
    return [float(b.mean() / light[0].mean()) for b in light]


@pytest.mark.parametrize("angle", [30.0, 45.0, 60.0])
def test_grooves_gain_what_their_form_factor_says(angle):
    """One flank sends the share F = 1 - cos(angle) ... of its light to the other: 1 + rho F, then the
    series.
    """
    form_factor = 1.0 - np.sin(np.radians(90.0 - angle))
    found = gains(height_field.ridges(32, 32, angle), 400, 12)
    assert found[1] == pytest.approx(1.0 + 0.8 * form_factor, rel=0.02)
    assert found[12] == pytest.approx(1.0 / (1.0 - 0.8 * form_factor), rel=0.02)


def test_the_upper_hemisphere_alone_loses_half_of_the_exchange():
    """Erratum E002.2: with 2 pi / N over the upper half the gain is 1.111, and not 1.234."""
    field = height_field.ridges(32, 32)
    every = sphere.spiral(200)
    upper = every[every[:, 2] > 0]
    seen = visibility.precompute(field, upper)
    direct, once = light_transport.bounces(field, seen, ABOVE, 1)
    # Half the sphere has half the weight.
    wrong = 1.0 + (float(once.mean() / direct.mean()) - 1.0) * 0.5
    assert wrong == pytest.approx(1.111, abs=0.01)
    assert abs(wrong / 1.234 - 1.0) > 0.02


def test_red_flanks_get_light_from_white_ones_alone():
    field = height_field.ridges(32, 32, left=(0.8, 0.8, 0.8), right=(0.8, 0.1, 0.1))
    seen = visibility.precompute(field, sphere.spiral(200))
    light = field.normals[0, 0]
    direct, once = light_transport.bounces(field, seen, light, 1)
    red = field.normals[0, :, 0] > 0
    assert (direct[:, red] == 0.0).all()
    # rho_red F rho_white / pi, F = 1 - sin 45 degrees.
    for channel, expected in ((0, 0.0597), (1, 0.0075), (2, 0.0075)):
        assert once[:, red, channel].mean() / np.pi == pytest.approx(expected, rel=0.06)
    assert direct[:, ~red].mean() / np.pi == pytest.approx(0.8 / np.pi)


def test_paths_of_one_lookup_are_the_gathering_of_all_directions():
    field = height_field.domes(16, 16, 2)
    seen = visibility.precompute(field, sphere.spiral(50))
    light = np.array([0.6, 0.0, 0.8])
    paths = light_transport.sequences(50, 1, 50)
    found = light_transport.scattered(field, seen, paths, light)
    assert np.abs(found - light_transport.bounces(field, seen, light, 1)[1]).max() < 1e-12


def test_longer_paths_converge_to_the_series():
    field = height_field.ridges(16, 16)
    seen = visibility.precompute(field, sphere.spiral(100))
    expected = light_transport.bounces(field, seen, ABOVE, 3)[3].mean()
    found = light_transport.scattered(field, seen, light_transport.sequences(100, 3, 2000), ABOVE).mean()
    # Measured: 0.4 %; the paths of twenty blocks are drawn at random.
    assert found == pytest.approx(expected, rel=0.02)


def test_every_direction_stands_once_in_each_block():
    paths = light_transport.sequences(10, 3, 25)
    assert paths.shape == (25, 3)
    for first in (0, 10):
        for place in range(3):
            assert sorted(paths[first : first + 10, place]) == list(range(10))
    assert (paths == light_transport.sequences(10, 3, 25)).all()
    assert light_transport.sequences(10, 1, 10)[:, 0].tolist() == list(range(10))
    # Fewer paths than directions are spread over the sphere and are not its top.
    assert light_transport.sequences(10, 1, 4)[:, 0].tolist() == [1, 3, 6, 8]
    assert (paths != light_transport.sequences(10, 3, 25, seed=1)).any()
    with pytest.raises(ValueError, match="give one or more"):
        light_transport.sequences(0, 1, 1)


def test_a_white_surface_under_a_white_sky_is_white():
    """A furnace: albedo one, environment one. Every texel sees either the sky or what is as bright as the
    sky.
    """
    field = height_field.domes(24, 24, 2, albedo=1.0)
    seen = visibility.precompute(field, sphere.spiral(400))
    white = np.ones((24, 24, 3))
    total = np.zeros((24, 24, 3))
    for i, direction in enumerate(seen.directions):
        arriving = light_transport.looked_up(white, seen.seen[i], 1.0)
        total += light_transport.bump(field, direction, ABOVE) * arriving * (light_transport.WEIGHT / 400)
    # The cosine over 400 directions sums to one within 2 % (measured: 0.7 %).
    assert np.abs(total - 1.0).max() < 0.02


def test_albedos_heights_and_lights_that_are_none_are_refused():
    heights = np.zeros((4, 4))
    for albedo in (1.5, -0.1, float("nan")):
        with pytest.raises(ValueError, match="sends back from 0 to 1"):
            height_field.height_field(heights, albedo)
    with pytest.raises(ValueError, match="one for each of"):
        height_field.height_field(heights, np.ones((3, 3)))
    with pytest.raises(ValueError, match="NaN or infinity"):
        height_field.height_field(np.full((4, 4), np.nan))
    with pytest.raises(ValueError, match="1 x 1 texels; give at least 2 x 2"):
        height_field.height_field(np.zeros((1, 1)))
    with pytest.raises(ValueError, match="not above the horizon"):
        height_field.check_light((1.0, 0.0, -0.1))


def test_what_is_looked_up_is_a_texel_s_light_the_sky_s_or_nothing():
    light = np.arange(12.0).reshape(2, 2, 3)
    seen = np.array([[3, visibility.FREE], [visibility.BACK, 0]])
    found = light_transport.looked_up(light, seen, (7.0, 8.0, 9.0))
    assert found.tolist() == [[[9.0, 10.0, 11.0], [7.0, 8.0, 9.0]], [[0.0, 0.0, 0.0], [0.0, 1.0, 2.0]]]


def test_highlights_along_a_path_are_seen_from_where_it_came():
    """A path p, q: q shines towards p, which lies against the path's direction."""
    field = height_field.ridges(16, 2, 45.0, 1)
    field = height_field.height_field(field.heights, 0.3, normals=field.normals, specular=0.6, exponent=4.0)
    seen = visibility.precompute(field, sphere.spiral(60))
    light = height_field.check_light((0.3, 0.1, 0.9))
    number = int(np.argmax((seen.seen >= 0).sum(axis=(1, 2))))
    along = seen.directions[number]
    found = light_transport.chain(field, seen, [number], light, ABOVE)

    def sent(texel, towards, eye):
        n = field.normals.reshape(-1, 3)[texel]
        half = np.add(towards, eye) / np.linalg.norm(np.add(towards, eye))
        shine = 0.6 * max(float(n @ half), 0.0) ** 4
        return 0.3 * float(n @ towards) + shine if n @ towards > 0.0 else 0.0

    for texel, met in enumerate(seen.seen[number].ravel().tolist()):
        expected = sent(texel, light, ABOVE)
        if met >= 0:
            expected += 4.0 * sent(texel, along, ABOVE) * sent(met, light, -along)
        assert found.reshape(-1, 3)[texel] == pytest.approx([expected] * 3, abs=1e-12)
