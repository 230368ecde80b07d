"""Form factors against closed forms, and radiosity in rooms whose answer is known."""

import math

import numpy as np
import pytest

from fixedpipe.effects.radiosity import form_factors, light_maps
from fixedpipe.effects.radiosity.progressive_refinement import Rectangle, solve
from fixedpipe.effects.radiosity.small_room import small_room


def square(count):
    """Middles of a unit square's parts at z = 0, and its normals."""
    edge = (np.arange(count) + 0.5) / count
    places = np.stack([*np.meshgrid(edge, edge), np.zeros((count, count))], axis=-1).reshape(-1, 3)
    return places, np.broadcast_to((0.0, 0.0, 1.0), places.shape)


def cube(reflectance, emission, elements=8):
    """A unit cube's six walls that face inward, all alike."""
    corners = (
        ((0, 0, 0), (1, 0, 0), (0, 1, 0)),
        ((0, 0, 1), (0, 1, 0), (1, 0, 0)),
        ((0, 0, 0), (0, 1, 0), (0, 0, 1)),
        ((1, 0, 0), (0, 0, 1), (0, 1, 0)),
        ((0, 0, 0), (0, 0, 1), (1, 0, 0)),
        ((0, 1, 0), (1, 0, 0), (0, 0, 1)),
    )
    return tuple(
        Rectangle(
            f"wall {k}",
            *(np.array(v, np.float64) for v in wall),
            (reflectance,) * 3,
            (elements, elements),
            (4, 4),
            emission,
        )
        for k, wall in enumerate(corners)
    )


def test_angles_are_the_arc_cosines():
    """To 1e-12 from none to a half turn."""
    expected = np.linspace(0.0, math.pi, 997)
    assert np.abs(form_factors.angles(np.cos(expected), np.sin(expected)) - expected).max() < 1e-12


def test_factors_of_parallel_and_of_adjacent_squares_are_the_closed_forms():
    """Unit squares: opposite at distance one 0.19982, with an edge in common 0.20004 (Siegel, Howell)."""
    places, normals = square(32)
    opposite = (0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0)
    adjacent = (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)
    assert form_factors.from_rectangle(places, normals, opposite).mean() == pytest.approx(0.19982, abs=1e-4)
    assert form_factors.from_rectangle(places, normals, adjacent).mean() == pytest.approx(0.20004, abs=1e-4)
    parted = form_factors.from_rectangle(places, normals, opposite, 4)
    np.testing.assert_allclose(parted, form_factors.from_rectangle(places, normals, opposite), rtol=1e-9)


def test_a_disc_s_worth_of_rectangle_is_pi_over_pi():
    """A rectangle so large that it fills the hemisphere has a factor of one; from behind none."""
    places, normals = np.zeros((1, 3)), np.array([[0.0, 0.0, 1.0]])
    large = (-1e4, -1e4, 1.0), (0.0, 2e4, 0.0), (2e4, 0.0, 0.0)
    assert form_factors.from_rectangle(places, normals, large)[0] == pytest.approx(1.0, abs=1e-6)
    turned = (large[0], large[2], large[1])
    assert form_factors.from_rectangle(places, normals, turned)[0] == 0.0


def test_what_hides_a_rectangle_takes_its_share():
    """A box over half of it and a ball before all of it."""
    places, normals = np.array([[0.5, 0.5, 0.0]]), np.array([[0.0, 0.0, 1.0]])
    rectangle = (0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0)
    free = form_factors.from_rectangle(places, normals, rectangle, 16)[0]
    box = form_factors.Box((0.25, 0.5, 0.5), (0.25, 1.0, 0.01), 0.0)
    half = form_factors.from_rectangle(places, normals, rectangle, 16, (box,))[0]
    assert half == pytest.approx(free / 2.0, rel=1e-9)
    ball = form_factors.Ball((0.5, 0.5, 0.3), 0.25)
    assert form_factors.from_rectangle(places, normals, rectangle, 16, (ball,))[0] == 0.0
    assert box.holds(np.array([0.25, 0.5, 0.5]))
    assert not ball.holds(np.array([0.5, 0.5, 0.0]))


def test_a_furnace_glows_as_its_sum_says():
    """Walls that emit one and reflect rho have a radiosity of 1/(1 - rho)."""
    solution = solve(cube(0.5, 1.0), rest=1e-4)
    for values in solution.radiosity.values():
        np.testing.assert_allclose(values, 2.0, rtol=0.02)
    assert np.abs(solution.sums - 1.0).max() < 0.02


def test_black_walls_send_nothing_on():
    """Each patch sends once, and all of it is absorbed."""
    solution = solve(cube(0.0, 1.0), rest=1e-6)
    assert solution.steps == 96
    absorbed = sum(values.sum(axis=(0, 1)) / 64.0 for values in solution.received.values())
    np.testing.assert_allclose(absorbed, solution.emitted, rtol=1e-12)


def test_light_maps_are_seen_where_they_are():
    """A ray meets its wall, and elements under a thing take their neighbours'."""
    room = small_room(8)
    values = {rectangle.name: np.zeros((*rectangle.elements[::-1], 3)) for rectangle in room}
    values["floor"] += 1.0
    colors = light_maps.seen(room, values, (0.0, 1.5, 0.5), np.array([[0.0, -1.0, 0.0], [0.0, 1.0, 0.0]]))
    np.testing.assert_array_equal(colors[:, 0], (1.0, 0.0))
    stood_on = form_factors.Box((0.0, 0.3, 0.0), (0.3, 0.3, 0.3), 0.0)
    values["floor"][3:5, 3:5] = 0.0
    filled = light_maps.light_maps(room, values, (stood_on,), 2.0)["floor"]
    np.testing.assert_array_equal(filled, 2.0)


@pytest.mark.parametrize(
    ("build", "said"),
    [
        (lambda: solve(cube(0.5, 0.0)), "Nothing in the room shines"),
        (lambda: solve(cube(0.5, 1.0), rest=0.0), "a number between 0 and 1"),
        (lambda: solve(cube(0.5, 1.0), parts=0), "a whole number from 1 on"),
        (lambda: solve(cube(0.5, 1.0), most=0), "a whole number from 1 on"),
        (lambda: solve(cube(0.5, 1.0) * 2), "names of their own"),
        (lambda: cube(1.0, 1.0), "from 0 to below 1"),
        (lambda: cube(0.5, math.nan), "NaN"),
        (lambda: cube(0.5, 1.0, 6), "divide the elements"),
        (lambda: small_room(12), "a multiple of 8"),
        (lambda: light_maps.light_maps((), {}, exposure=0.0), "a positive number"),
    ],
)
def test_rooms_that_are_none_are_refused(build, said):
    """A sentence each."""
    with pytest.raises(ValueError, match=said):
        build()
