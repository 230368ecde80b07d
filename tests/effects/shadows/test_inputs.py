"""What the techniques of shadows are given wrongly is refused in a sentence, not drawn."""

import math
from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.effects.acceptance import agreement, ray_caster
from fixedpipe.effects.figures import FIGURES
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.views import Panel
from fixedpipe.effects.scenes import objects_and_lamps, still_life
from fixedpipe.effects.shadows import (
    area_lights,
    frustum_slices,
    light_space,
    parted_shadow_maps,
    shadow_maps,
    shadow_volumes,
)
from fixedpipe.effects.shadows.alpha_coded_shadows import Coding
from fixedpipe.effects.shadows.parted_shadow_maps import MapFit
from fixedpipe.pipeline.profiles import GEFORCE_3, INFINITE_REALITY, OCTANE, PROFILES
from fixedpipe.pipeline.validation.validate import validate

NAN, INF = math.nan, math.inf
SCENE, EMPTY = still_life.still_life(12), objects_and_lamps.Scene(())
VIEW = still_life.still_life_view(Panel(0, 0, 16, 16))
LAMP = objects_and_lamps.lamp_around(SCENE, still_life.LAMP_POSITIONS[0])
FLOOR = objects_and_lamps.Scene(SCENE.objects[:1])
SUN = (1.0, 1.0, 0.0)


def lamp(**given):
    return objects_and_lamps.Lamp(
        **{"position": (0.0, 3.0, 0.0), "target": (0.0, 0.0, 0.0), "near": 1.0, "far": 4.0, **given}
    )


def accumulated(kernel, units=None, edge=8):
    return shadow_maps.accumulated_passes(SCENE, VIEW, LAMP, "map", edge, GEFORCE_3, kernel, units=units)


def compared(**given):
    truth = agreement.truth_of(SCENE, VIEW, LAMP)
    return agreement.compare(truth.lit, truth, **given)


def parts():
    return parted_shadow_maps.parts_of_view(MapFit.SLICES, SCENE, SUN, VIEW, 8)


def passes(**given):
    return parted_shadow_maps.parted_passes(parts(), SCENE, VIEW, LAMP, GEFORCE_3, **given)


FLAT = np.ones((8, 3))
REFUSED = {
    "field of view 0": (lambda: lamp(field_of_view=0.0), "between 0 and 180"),
    "field of view 180": (lambda: lamp(field_of_view=180.0), "between 0 and 180"),
    "field of view NaN": (lambda: lamp(field_of_view=NAN), "between 0 and 180"),
    "half width 0": (lambda: lamp(infinite=True, half_width=0.0), "give a positive number"),
    "near at infinity": (lambda: lamp(infinite=True, near=-INF), "the second is the farther"),
    "margin below one": (lambda: objects_and_lamps.lamp_around(SCENE, (9, 9, 9), margin=0.5), "above 1"),
    "margin NaN": (lambda: objects_and_lamps.lamp_around(SCENE, (9, 9, 9), margin=NAN), "above 1"),
    "a flat scene from above": (lambda: objects_and_lamps.lamp_around(FLOOR, (0, 5, 0)), "move it aside"),
    "highlight": (
        lambda: objects_and_lamps.Object("a", surfaces.box(), (1, 1, 1), 2.0),
        "highlight of a is 2.0",
    ),
    "highlight NaN": (lambda: objects_and_lamps.Object("a", surfaces.box(), (1, 1, 1), NAN), "from 0 to 1"),
    "a lamp round nothing": (lambda: objects_and_lamps.lamp_around(EMPTY, (1, 2, 3)), "no object"),
    "rays at nothing": (lambda: ray_caster.scene_caster(EMPTY), "no object"),
    "a map round nothing": (lambda: light_space.whole_scene_camera(EMPTY, SUN, VIEW), "no object"),
    "floor 0": (lambda: objects_and_lamps.floor(0.0, 4), "floor's width"),
    "map 0": (lambda: shadow_maps.store_map(SCENE, LAMP, "map", 0, (16, 16)), "one or more"),
    "window 0": (lambda: shadow_maps.store_map(SCENE, LAMP, "map", 8, (0, 16)), "one or more"),
    "kernel 0": (lambda: accumulated(0), "whole numbers from 1"),
    "kernel 2.5": (lambda: accumulated(2.5), "whole numbers from 1"),
    "kernel of map 0": (lambda: accumulated(2, edge=0), "whole numbers from 1"),
    "two in a pass": (lambda: accumulated(2, 2), "give 1, or 4"),
    "four in a pass of nine": (lambda: accumulated(3, 4), "give 1, or 4"),
    "share 2": (
        lambda: shadow_maps.ambient_form_pass(SCENE, VIEW, LAMP, "map", INFINITE_REALITY, 2.0),
        "share from 0 to 1",
    ),
    "bits 8.5": (lambda: Coding(8.5), "4 to 16"),
    "bias NaN": (lambda: Coding(bias=NAN), "finite number"),
    "ramp of 1": (lambda: Coding(texels=1), "power of two"),
    "ramp of 3": (lambda: Coding(texels=3), "power of two"),
    "one and a half points": (lambda: area_lights.lamps_of(LAMP, 1.0, 1.5), "power of two"),
    "no point": (lambda: area_lights.accumulated_lights(SCENE, VIEW, (), GEFORCE_3), "one lamp or more"),
    "no light": (lambda: ray_caster.seen_fraction(None, None, ()), "one or more"),
    "map_edge 0": (lambda: compared(map_edge=0), "map_edge is 0"),
    "edge_pixels -1": (lambda: compared(edge_pixels=-1), "edge_pixels is -1"),
    "contact NaN": (lambda: compared(contact=NAN), "contact is nan"),
    "a flat body": (lambda: light_space.uniform_camera(FLAT, SCENE, SUN, VIEW), "no extent"),
    "a flat body in perspective": (
        lambda: light_space.perspective_camera(FLAT, SCENE, SUN, VIEW),
        "no extent",
    ),
    "a body along the light": (
        lambda: light_space.perspective_camera(FLAT + np.arange(8)[:, None] * SUN, SCENE, SUN, VIEW, n=1.0),
        "no extent",
    ),
    "slices too thin": (lambda: frustum_slices.split_distances(1.0, 1.0 + 1e-6, 4), "give fewer"),
    "slices NaN": (lambda: frustum_slices.split_distances(1.0, 2.0, NAN), "whole number"),
    "slices without end": (lambda: frustum_slices.split_distances(1.0, 2.0, INF), "whole number"),
    "part of a map of 0": (
        lambda: parted_shadow_maps.parts_of_view(MapFit.BASIC, SCENE, SUN, VIEW, 0),
        "positive number",
    ),
    "cube of maps of 0": (
        lambda: parted_shadow_maps.parts_of_cube(SCENE, (0, 1, 0), VIEW, 0),
        "positive number",
    ),
    "too few tints": (lambda: passes(tints=((1.0, 1.0, 1.0),)), "one for each"),
    "light for another part": (lambda: passes(lit=("moon",)), "part that gets light is 'moon'"),
    "sides that cover twice": (
        lambda: shadow_volumes.show_volumes("sides", (), VIEW, (1, 1, 1), 2.0),
        "from 0 to 1",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_drawn_is_refused_in_a_sentence(case):
    call, words = REFUSED[case]
    with pytest.raises(ValueError, match=words) as refused:
        call()
    assert str(refused.value).endswith(".")


@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_tiny_and_huge_worlds_have_the_same_shadows(scale):
    """Rays, and the cameras of a lamp: nothing has a length of its own."""
    world = objects_and_lamps.Scene(tuple(replace(o, surface=o.surface.scaled(scale)) for o in SCENE.objects))
    position = tuple(scale * v for v in still_life.LAMP_POSITIONS[0])
    fitted = objects_and_lamps.lamp_around(world, position)
    assert fitted.near == pytest.approx(scale * LAMP.near)
    assert fitted.field_of_view == pytest.approx(LAMP.field_of_view, abs=0.011)
    shown = ray_caster.visible(ray_caster.scene_caster(SCENE), VIEW)
    normals, points = shown.normals[shown.something], shown.points[shown.something]
    masks = [
        ray_caster.lit_points(
            ray_caster.scene_caster(s),
            k * points,
            normals,
            light,
            triangles=shown.triangle[shown.something],
        )
        for s, k, light in ((SCENE, 1.0, LAMP), (world, scale, fitted))
    ]
    assert 0.2 < masks[0].mean() < 0.9
    assert (masks[0] != masks[1]).mean() <= 0.01


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_slices_of_tiny_and_huge_frusta_are_in_order(scale):
    distances = np.array(frustum_slices.split_distances(scale, 81.0 * scale, 4))
    np.testing.assert_allclose(distances / scale, (1.0, 12.0, 25.0, 44.0, 81.0), rtol=1e-4)


def test_a_volume_s_panels_must_hold_its_map():
    figure = FIGURES["F000-7"]
    with pytest.raises(ValueError, match="give panels of 8 pixels or more"):
        figure.commands(OCTANE, 7)
    assert figure.commands(OCTANE, 8)


# Those with the most panels and maps of each kind; the others were tried by hand.
@pytest.mark.parametrize("name", ["F003-24", "F003-26", "H36", "H38", "H40", "Z14"])
@pytest.mark.parametrize("size", [1, 7])
def test_figures_of_any_size_are_valid(name, size):
    """One pixel, and sizes that are no powers of two: maps come in pieces."""
    figure = FIGURES[name]
    for method in figure.methods:
        profile = PROFILES[method.machines[0]]
        validate(figure.commands(profile, size, method), profile, *figure.dimensions(size))
