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
from fixedpipe.effects.scenes.still_life import still_life_and_lamp, still_life_view
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


# A plain to the horizon with a light straight ahead is nearly its own mirror image. So are two zebras that
# face each other: F001-12 is asked both ways; F001-13, of the same view, has noise that hides the stripes.
MIRRORED = {"S10", "S22", "S24", "F001-13"}


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
    # What is the same along one axis, as ridges are, has one such way.
    ways = (reference[::-1],) if figure_id in MIRRORED else (reference[::-1], reference[:, ::-1])
    turned = [t for t in ways if np.abs(t - reference).mean() > 0.001]
    assert turned
    assert apart(reference) < 0.8 * min(map(apart, turned))


@pytest.mark.parametrize("two_sided", [False, True])
def test_highlights_and_backs_are_the_ideals(two_sided):
    size = 160
    scene, lamp = still_life_and_lamp(size)
    scene = Scene(tuple(replace(thing, two_sided=two_sided) for thing in scene.objects))
    camera = still_life_view(Panel(0, 0, size, size))
    commands = (
        camera.panel.clear((0.0, 0.0, 0.0)),
        *unlit_pass(scene, camera),
        *lit_pass(scene, camera, lamp),
    )
    ideal = np.minimum(execute_ideal(commands, size, size).color[..., :3], 1.0)
    cast = shadow_reference.rays(Shot(scene, camera, (lamp,), shadows=False), samples=1)[..., :3]
    # The ideal's vertices lie on a grid of fractions of a pixel: outlines, and light on what is small, move.
    off = np.abs(cast - ideal).max(axis=-1)
    assert np.median(off) < 1e-4
    assert (off < 1.0 / 255.0).mean() > 0.98
    assert cast.max() == pytest.approx(ideal.max(), abs=0.01)


def test_a_share_of_all_light_stays_where_one_pass_draws_both():
    scene, lamp = still_life_and_lamp(32)
    lit = Shot(scene, still_life_view(Panel(0, 0, 32, 32)), (lamp,))
    whole, kept = (
        shadow_reference.rays(replace(lit, **changes), samples=1)
        for changes in ({"shadows": False}, {"in_shadow": 0.4})
    )
    dark = shadow_reference.rays(replace(lit, shading=SceneShading.MASK), samples=1)[..., 0] == 0.0
    assert dark.any()
    np.testing.assert_allclose(kept[dark][:, :3], 0.4 * whole[dark][:, :3], atol=1e-12)


def test_an_objects_own_shadow_is_left_out_where_it_is_asked():
    # From the side of the plate, so that it shades a second plate of the same object, and the floor.
    both = surfaces.joined(PLATE.surface, PLATE.surface.moved(0.0, -1.0, 0.0))
    scene = Scene((GROUND, Object("plates", both, (0.5, 0.5, 0.5))))
    side = Lamp((2.0, 3.0, 0.0), (0.0, 1.0, 0.0), 0.5, 8.0, infinite=True, half_width=2.0)
    masks = [
        shadow_reference.rays(
            Shot(
                scene,
                side.view(Panel(0, 0, SIZE, SIZE)),
                (LAMP,),
                shading=SceneShading.MASK,
                self_shadows=own,
            )
        )[..., 0]
        for own in (True, False)
    ]
    assert (masks[1] >= masks[0]).all()
    assert (masks[1] > masks[0]).any()
    assert (masks[1] == 0.0).any()  # the floor's stays


@pytest.mark.parametrize("figure_id", ["F003-22", "Z16"])
def test_a_reference_moves_with_its_parameters(figure_id):
    figure, sun = FIGURES[figure_id], (-0.72, 0.5, 0.36)
    own, moved = figure.reference_picture(32), figure.reference_picture(32, sun=sun)
    drawn = figure.render(figure.machines[0], 32, sun=sun).ideal.color[..., :3]
    near, far = (np.sqrt(np.mean((drawn - r[..., :3]) ** 2)) for r in (moved, own))
    assert near < 0.9 * far


def test_the_points_of_a_picture_of_a_square_light_leave_its_reference_alone():
    figure = FIGURES["F003-15"]
    assert (figure.reference_picture(16, points=1) == figure.reference_picture(16)).all()
