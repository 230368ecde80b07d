"""The references of the shadow figures: what rays, sixteen a pixel, say without any shadow algorithm."""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.effects.acceptance import shadow_reference
from fixedpipe.effects.acceptance.shadow_reference import Shot
from fixedpipe.effects.figures import FIGURES
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.views import Panel
from fixedpipe.effects.scenes.objects_and_lamps import Lamp, Object, Scene, floor
from fixedpipe.effects.shadows.lit_scene import SceneShading, lit_pass, unlit_pass
from fixedpipe.pipeline import execute_ideal

SIZE = 48
LAMP = Lamp((0.0, 4.0, 0.0), (0.0, 0.0, 0.0), 1.0, 10.0)
# From straight above: the floor's x and z are the picture's x and y, -2 to 2.
ABOVE = Lamp((0.0, 5.0, 0.0), (0.0, 0.0, 0.0), 0.5, 8.0, infinite=True, half_width=2.0)
GROUND = Object("floor", floor(3.0, 12), (0.8, 0.7, 0.6), closed=False)
# Two units above the floor, its edge at x = 0.25: the lamp, 4 above, throws it to 0.25 * 4 / 2. The plate
# itself is lit, so that what is dark is between.
EDGE, HEIGHT = 0.25, 2.0
PLATE = Object("plate", surfaces.box(2.0, 0.02, 8.0).moved(EDGE - 1.0, HEIGHT - 0.01, 0.0), (0.5, 0.5, 0.5))
HIDDEN = EDGE * 4.0 / (4.0 - HEIGHT)


def view(size=SIZE):
    return ABOVE.view(Panel(0, 0, size, size))


def shot(**changes):
    return Shot(**{"scene": Scene((GROUND,)), "view": view(), "lamps": (LAMP,), **changes})


def test_a_scene_without_occluders_is_lit_as_the_ideal_lights_it():
    ideal = execute_ideal(
        (
            view().panel.clear((0.0, 0.0, 0.0)),
            *unlit_pass(Scene((GROUND,)), view()),
            *lit_pass(Scene((GROUND,)), view(), LAMP),
        ),
        SIZE,
        SIZE,
    ).color[..., :3]
    # The light bends within a pixel by less than this; the ideal has one sample in each pixel's middle.
    assert np.abs(shadow_reference.rays(shot())[..., :3] - ideal).max() < 1e-3


def test_a_shadow_ends_where_geometry_has_its_edge():
    picture = shadow_reference.rays(shot(scene=Scene((GROUND, PLATE)), shading=SceneShading.MASK))
    dark = 4.0 / SIZE * (1.0 - picture[SIZE // 2, SIZE // 2 :, 0]).sum()
    assert dark == pytest.approx(HIDDEN - EDGE, abs=4.0 / SIZE / 4)  # a sample's width


def test_it_is_found_to_a_sample_s_width():
    def error(samples):
        scene = Scene((GROUND, PLATE))
        picture = shadow_reference.rays(shot(scene=scene, shading=SceneShading.MASK), samples=samples)
        return abs(4.0 / SIZE * (1.0 - picture[SIZE // 2, SIZE // 2 :, 0]).sum() - (HIDDEN - EDGE))

    for samples in (1, 2, 8):
        assert error(samples) <= 4.0 / SIZE / samples


def test_of_an_area_light_a_place_has_the_share_that_it_sees():
    across = tuple(replace(LAMP, position=(x, 4.0, 0.0)) for x in np.linspace(-0.75, 0.75, 16).tolist())
    picture = shadow_reference.rays(
        shot(scene=Scene((GROUND, PLATE)), lamps=across, shading=SceneShading.MASK), samples=4
    )
    row = picture[SIZE // 2, :, 0]
    x = (np.arange(SIZE) + 0.5) * 4.0 / SIZE - 2.0
    # Each point of the lamp throws the plate's edge as far to one side as itself is to the other: from -0.25
    # to 1.25 the light rises evenly. Of sixteen points one is a sixteenth, and a pixel is as wide.
    beside = x > EDGE + 4.0 / SIZE
    wanted = np.clip((x[beside] + 0.25) / 1.5, 0.0, 1.0)
    assert np.abs(row[beside] - wanted).max() < 2.0 / 16.0


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_the_number_of_threads_changes_no_bit(threads):
    scene = Scene((GROUND, PLATE))
    one = shadow_reference.rays(shot(scene=scene), threads=1)
    assert np.array_equal(one, shadow_reference.rays(shot(scene=scene), threads=threads))


def test_a_panel_without_a_reference_is_transparent():
    row = shadow_reference.row(SIZE, [None, shot()])
    assert row.shape == (SIZE, 2 * SIZE, 4)
    assert not row[:, :SIZE].any() and (row[:, SIZE:, 3] == 1.0).all()


def test_what_cannot_be_cast_is_refused():
    with pytest.raises(ValueError, match="one lamp or more"):
        shadow_reference.rays(shot(lamps=()))
    for samples in (0, -1, 1.5):
        with pytest.raises(ValueError, match="whole number from 1"):
            shadow_reference.rays(shot(), samples=samples)


def with_references():
    return [key for key in FIGURES if FIGURES[key].reference is not None]


def test_the_shadow_figures_have_references():
    assert len(with_references()) >= 20


@pytest.mark.parametrize("figure_id", with_references())
def test_a_reference_shows_the_figures_scene(figure_id):
    figure = FIGURES[figure_id]
    size = 32
    reference = figure.reference_picture(size)
    ideal = figure.render("IDEAL", size).image()[..., :3] / 255.0
    assert set(np.unique(reference[..., 3])) <= {0.0, 1.0}
    there = reference[..., 3] == 1.0
    assert there.any()
    assert reference[there].min() >= 0.0 and reference[there].max() <= 1.0

    def apart(picture):
        return np.abs(picture[..., :3] - ideal)[there].mean()

    # Edges, shadows and what an algorithm gets wrong; upside down or mirrored all of the scene would differ.
    assert apart(reference) < 0.8 * min(apart(reference[::-1]), apart(reference[:, ::-1]))
