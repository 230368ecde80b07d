"""H16, illuminated lines, and the curves that they are drawn of: lines of force against the flux that they
keep, a ring against its tangents, the ideal's lines beside the machine's.
"""

import math
from itertools import pairwise

import numpy as np
import pytest

from fixedpipe.effects.geometry.curves import Curves, directions, field, lines_of_force
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.vectors import dot
from fixedpipe.effects.geometry.views import Light, Panel, orthographic_view
from fixedpipe.effects.reflectance import banks_texture_matrix as banks
from fixedpipe.effects.reflectance import illuminated_lines
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import GEFORCE_256, IDEAL, OPENGL_1_2

PANEL = Panel(0, 0, 96, 96)
VIEW = orthographic_view(PANEL)
LIGHT = Light((0.6, -0.3, 0.8))
MODEL = {"diffuse": 0.3, "specular": 0.7, "exponent": 10.0}
TWO = ((-0.4, 0.0, 0.1, 1.0), (0.4, 0.0, 0.1, -1.0))


def ring(radius=0.8, count=64):
    """A closed ring that faces the viewer."""
    angle = 2.0 * math.pi * np.arange(count + 1) / count
    x, y, zero = np.cos(angle), np.sin(angle), 0.0 * angle
    return Curves(radius * np.stack([x, y, zero], -1), np.stack([-y, x, zero], -1), (count + 1,))


def test_lines_of_force_keep_the_flux_of_two_charges():
    curves = lines_of_force(TWO, 40, step=0.01)
    ends = np.cumsum((0, *curves.counts))
    cosines = 0.0
    for x, y, z, q in TWO:
        away = curves.positions - np.array([x, y, z])
        cosines = cosines + q * away[:, 0] / np.sqrt(dot(away, away))
    for first, last in pairwise(ends):
        assert np.ptp(cosines[first:last]) < 2e-3


def test_lines_begin_at_the_positive_charge_or_outside_and_point_along_the_field():
    curves = lines_of_force(TWO, 40)
    starts = np.cumsum((0, *curves.counts))[:-1]
    away = curves.positions[starts] - np.array(TWO[0][:3])
    near = np.abs(np.sqrt(dot(away, away)) - 0.05) < 1e-6
    outside = np.sqrt(dot(curves.positions[starts], curves.positions[starts])) > 0.95
    assert (near | outside).all()
    assert near.sum() == 40
    pieces = curves.positions[curves.segments[:, 1]] - curves.positions[curves.segments[:, 0]]
    assert (dot(pieces, curves.tangents[curves.segments[:, 0]]) > 0.0).all()


def test_directions_go_all_round_evenly():
    found = directions(500)
    np.testing.assert_allclose(dot(found, found), 1.0, atol=1e-5)
    np.testing.assert_allclose(found.mean(axis=0), 0.0, atol=0.005)
    np.testing.assert_allclose(
        (found[:, :, None] * found[:, None, :]).mean(axis=0), np.eye(3) / 3.0, atol=0.01
    )


def test_the_field_of_a_charge_falls_with_the_square_and_is_none_on_it():
    found = field(np.array([[0.0, 2.0, 0.0], [0.0, 0.0, 0.0]]), ((0.0, 0.0, 0.0, 3.0),))
    np.testing.assert_array_equal(found, [[0.0, 0.75, 0.0], [0.0, 0.0, 0.0]])


def frame(profile, curves, width=3.0):
    return (
        PANEL.clear((0.0, 0.0, 0.0)),
        banks.load_threads("threads", profile, **MODEL),
        illuminated_lines.line_pass(
            curves, VIEW, light=LIGHT, texture="threads", color=(1.0, 0.5, 0.25), width=width
        ),
    )


@pytest.mark.parametrize("profile", [OPENGL_1_2, GEFORCE_256], ids=lambda p: p.name)
def test_a_ring_is_banks_s_light_of_its_tangents(profile):
    curves = ring()
    machine = execute(frame(profile, curves), profile, 96, 96).framebuffer.color[::-1, :, :3] / 255.0
    ideal = execute_ideal(frame(IDEAL, curves), 96, 96).color[::-1, :, :3]
    light = LIGHT.light_vectors(np.zeros((1, 3)))[0]
    angle = np.radians(np.arange(2.5, 360.0, 5.0))
    column, row = (np.floor((0.8 * f(angle) + 1.0) * 48.0).astype(int) for f in (np.cos, np.sin))
    along = np.stack([-np.sin(angle), np.cos(angle), 0.0 * angle], axis=-1)
    # The viewer sees along the ring's axis: v.t is zero.
    expected = banks.thread(dot(along, light), 0.0, **MODEL)
    for picture, slack in ((ideal, 0.03), (machine, 0.035)):
        np.testing.assert_allclose(picture[row, column, 0], expected, atol=slack)
        np.testing.assert_allclose(picture[row, column, 1], 0.5 * expected, atol=slack)
    assert expected.max() > 2.0 * expected.min()


@pytest.mark.parametrize("width", [1.0, 2.0, 5.0])
@pytest.mark.parametrize("profile", [OPENGL_1_2, GEFORCE_256], ids=lambda p: p.name)
def test_the_ideal_draws_the_machine_s_lines(profile, width):
    curves = lines_of_force(TWO, 12).rotated(rotation("x", 30.0))
    machine = execute(frame(profile, curves, width), profile, 96, 96, record=True)
    guided = execute_ideal(frame(IDEAL, curves, width), 96, 96, guide=machine).color[..., :3]
    drawn = machine.framebuffer.color[..., :3].max(axis=-1) > 0
    np.testing.assert_array_equal(guided[~drawn], 0.0)
    # Bytes of colours, of the table and of their product.
    assert np.abs(guided - machine.framebuffer.color[..., :3] / 255.0).max() < 2.5 / 255.0
    if profile is OPENGL_1_2:  # whose rule is the free ideal's too
        ideal = execute_ideal(frame(IDEAL, curves, width), 96, 96)
        np.testing.assert_array_equal(ideal.color[..., :3].max(axis=-1) > 0.002, drawn)


def test_what_no_lines_can_be_drawn_of_is_refused():
    with pytest.raises(ValueError, match="width is 0"):
        illuminated_lines.line_pass(ring(), VIEW, width=0.0)
    near = Light((0.0, 0.0, 2.0), point=True)
    with pytest.raises(ValueError, match="light is near"):
        illuminated_lines.line_pass(ring(), VIEW, light=near, texture="threads")
    with pytest.raises(ValueError, match="polylines"):
        Curves(np.zeros((3, 3)), np.zeros((3, 3)), (1, 2))
    with pytest.raises(ValueError, match="No charge is positive"):
        lines_of_force(((0.0, 0.0, 0.0, -1.0),), 10)
    with pytest.raises(ValueError, match="rows"):
        lines_of_force(((0.0, 0.0, math.nan, 1.0),), 10)
    with pytest.raises(ValueError, match="step"):
        lines_of_force(TWO, 10, step=0.0)
    with pytest.raises(ValueError, match="as long as a step"):
        lines_of_force(TWO[:1], 10, step=3.0)
    with pytest.raises(ValueError, match="number of directions"):
        directions(0)
