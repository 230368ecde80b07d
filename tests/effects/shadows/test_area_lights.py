"""Area lights: where their points are, and that their shares make the whole light."""

import numpy as np
import pytest

from fixedpipe.effects.figures.zwicker_2016.f003_15_hard_and_soft import things
from fixedpipe.effects.geometry.views import Panel, perspective_view
from fixedpipe.effects.scenes import objects_and_lamps
from fixedpipe.effects.shadows import area_lights
from fixedpipe.effects.shadows.shadow_volumes import z_pass
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.profiles import OPENGL_1_2

LAMP = objects_and_lamps.Lamp((1.0, 5.0, 2.0), (0.0, 0.0, 0.0), 1.0, 20.0)


@pytest.mark.parametrize("count", [1, 2, 64])
def test_every_row_and_column_of_the_light_has_one_point(count):
    places = np.array([lamp.position for lamp in area_lights.lamps_of(LAMP, 0.5, count)])
    steps = (np.arange(count) + 0.5) / count - 0.5
    assert (np.sort(places[:, 0]) == 1.0 + 0.5 * steps).all()
    assert (np.sort(places[:, 2]) == 2.0 + 0.5 * steps).all()
    assert (places[:, 1] == 5.0).all()


def test_the_points_fill_the_square():
    places = np.array([lamp.position for lamp in area_lights.lamps_of(LAMP, 1.0, 64)])
    cells = {(int(x * 8), int(z * 8)) for x, z in places[:, ::2] - [0.5, 1.5]}
    assert len(cells) == 64


def test_what_is_no_area_light_is_refused():
    with pytest.raises(ValueError, match="48 points; give a power of two"):
        area_lights.lamps_of(LAMP, 1.0, 48)
    with pytest.raises(ValueError, match="width"):
        area_lights.lamps_of(LAMP, 0.0)


def test_an_area_light_of_one_point_is_that_point():
    """The accumulation buffer keeps 16 bits: half a byte at most is lost."""
    panel = Panel(0, 0, 48, 48)
    view, scene = perspective_view(panel, (0.4, 4.3, 7.4), radius=4.5), things(12)
    clear = panel.clear((0.1, 0.2, 0.3))
    (lamp,) = area_lights.lamps_of(LAMP, 1.0, 1)
    hard = execute((clear, *z_pass(scene, view, lamp, OPENGL_1_2)), OPENGL_1_2, 48, 48).image()
    soft = (clear, *area_lights.accumulated_lights(scene, view, (lamp,), OPENGL_1_2))
    difference = execute(soft, OPENGL_1_2, 48, 48).image()[..., :3].astype(int) - hard[..., :3]
    assert np.abs(difference).max() <= 1
