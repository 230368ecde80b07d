"""The palette for white paper: hue and saturation as before, lightness reversed, pictures untouched."""

import colorsys

import numpy as np
import pytest

from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.figures import FIGURES, Method
from fixedpipe.effects.geometry.views import BACKGROUND, row_of_panels
from fixedpipe.effects.reports.paper_palette import on_paper, with_paper_palette
from fixedpipe.pipeline import OPENGL_1_2
from fixedpipe.pipeline.commands import Clear, Draw, Mesh
from fixedpipe.pipeline.state import PassState

INKS = ("INK", "FAINT", "RED", "YELLOW", "GREEN", "BLUE", "VIOLET")
GRID = np.stack(np.meshgrid(*[np.arange(0, 256, 15) / 255.0] * 3), axis=-1).reshape(-1, 3)


def test_the_background_is_white_and_white_is_black():
    assert on_paper(BACKGROUND).tolist() == [1.0, 1.0, 1.0]
    assert on_paper((1.0, 1.0, 1.0)).tolist() == [0.0, 0.0, 0.0]


def test_hue_and_saturation_stay_and_lighter_colors_become_darker():
    found = on_paper(GRID)
    assert found.min() >= 0.0 and found.max() <= 1.0
    darkest = colorsys.rgb_to_hls(*BACKGROUND)[1]
    for color, now in zip(GRID.tolist(), found.tolist(), strict=True):
        hue, lightness, saturation = colorsys.rgb_to_hls(*color)
        expected = colorsys.hls_to_rgb(hue, min((1.0 - lightness) / (1.0 - darkest), 1.0), saturation)
        assert now == pytest.approx(expected, abs=1e-9)  # float64 in another order


@pytest.mark.parametrize("name", INKS)
def test_each_ink_of_diagrams_is_dark_on_paper(name):
    assert on_paper(getattr(drawing, name)).min() < 0.6  # white has 1


def test_a_diagram_has_the_same_lines_on_white():
    figure = FIGURES["F000-1"]
    method = figure.method("OPENGL_1_2")
    before, after = (
        figure.render("OPENGL_1_2", 128, method=each).image()[..., :3]
        for each in (method, with_paper_palette(method))
    )
    background = np.floor(255.0 * np.array(BACKGROUND) + 0.5)
    empty = (before == background).all(axis=-1)
    assert 0.3 < empty.mean() < 0.98
    assert ((after == 255).all(axis=-1) == empty).all()


def test_only_what_has_one_color_and_no_texture_changes():
    (panel,) = row_of_panels(1, 16)
    corners = [[-1.0, -1.0], [1.0, -1.0], [0.0, 1.0]]
    plain = Draw(label="plain", mesh=Mesh(corners, colors=[[0.9, 0.8, 0.7]] * 3), state=PassState())
    shaded = Draw(label="shaded", mesh=Mesh(corners, colors=np.eye(3)), state=PassState())
    white = Draw(label="without colours", mesh=Mesh(corners), state=PassState())
    depth = Clear(label="depth", depth=1.0)
    commands = (panel.clear(BACKGROUND), depth, plain, shaded, white)
    changed = with_paper_palette(Method("all", lambda profile, size: commands, ("OPENGL_1_2",))).scene(
        OPENGL_1_2, 16
    )
    assert changed[0].color == (1.0, 1.0, 1.0, 0.0)
    assert changed[1] == depth and changed[3:] == commands[3:]
    assert np.asarray(changed[2].mesh.colors).tolist() == [on_paper([0.9, 0.8, 0.7]).tolist()] * 3
