"""G15 and G16 on machines: marks beside Eq. 4 in float64, on one panel of two, and what a slope hides."""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.vectors import unit_vector
from fixedpipe.effects.geometry.views import Light, orthographic_view, row_of_panels
from fixedpipe.effects.passes.draws import LATER_PASS, MARKED, NEAREST, draw
from fixedpipe.effects.passes.encoding import vector_texels
from fixedpipe.effects.scattering import directions as sphere
from fixedpipe.effects.scattering import ellipse_passes, ellipses, height_field, visibility
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import GEFORCE_3, GEFORCE_256, IDEAL, NV2A, OCTANE, OPENGL_1_2_IMAGING
from fixedpipe.pipeline.textures.images import texture_2d

SIZE = 32
LIGHTS = ((0.6, 0.3, 0.5), (-0.2, 0.8, 0.3), (0.0, -0.3, 0.9))


def fitted():
    field = height_field.domes(SIZE, SIZE, 2)
    return ellipses.of_visibility(visibility.precompute(field, sphere.spiral(100)))


def pixels(commands, profile, panels=1):
    if profile.arithmetic.exact:
        return execute_ideal(commands, panels * SIZE, SIZE).color[::-1, :, :3]
    framebuffer = execute(commands, profile, panels * SIZE, SIZE).framebuffer
    return framebuffer.color[::-1, :, :3] / (2.0**framebuffer.color_bits - 1.0)


def shown_marks(view, surface):
    white = surface.mesh(colors=np.ones((len(surface.positions), 3)))
    return draw("show the marks", white, view, None, depth_test=LATER_PASS, stencil_test=MARKED)


def marks(forms, light, profile, imaging):
    """What is marked of a square with one texel in each pixel: bool [SIZE, SIZE], bottom row first."""
    (panel,) = row_of_panels(1, SIZE)
    view, surface = orthographic_view(panel), surfaces.plane()
    dark = draw("black", surface.mesh(colors=np.zeros((4, 3))), view, None, depth_test=LATER_PASS)
    if imaging:
        passes = ellipse_passes.imaging_marking_passes(
            surface, forms, view, Light(light), profile, sampler=NEAREST
        )
    else:
        first = replace(dark, state=replace(dark.state, depth_test=ellipse_passes.FIRST_PASS))
        mark = ellipse_passes.marking_pass(surface, forms, view, Light(light), profile, sampler=NEAREST)
        passes = (
            *ellipse_passes.load(forms, profile),
            first,
            ellipse_passes.clear_marks(view),
            mark,
        )
    commands = (panel.clear((0.0, 0.0, 0.0)), *passes, dark, shown_marks(view, surface))
    return pixels(commands, profile)[..., 0] > 0.5


@pytest.mark.parametrize("light", LIGHTS)
@pytest.mark.parametrize(
    ("profile", "imaging"),
    [
        (GEFORCE_256, False),
        (GEFORCE_3, False),
        (NV2A, False),
        (IDEAL, False),
        (OCTANE, True),
        (OPENGL_1_2_IMAGING, True),
        (IDEAL, True),
    ],
)
@pytest.mark.parametrize("pack", [ellipses.packed, ellipses.rooted])
def test_marks_are_the_float_test_s_away_from_the_edge(profile, imaging, pack, light):
    found = fitted()
    x, y, _ = unit_vector(light, "l")
    test = found.test(x, y)
    # Half a byte of a quarter is 0.016 of a number; d has three, and bytes of l; its square has twice that.
    edge = 1e-9 if profile is IDEAL else 0.02 if imaging else 0.2
    clear = np.abs(test) > edge
    assert clear.mean() > 0.75
    marked = marks(pack(found), light, profile, imaging)
    assert (marked == (test > 0.0))[clear].all()
    assert 0.1 < marked.mean() < 0.99


@pytest.mark.parametrize("profile", [GEFORCE_256, IDEAL])
def test_a_texel_without_a_free_direction_is_never_marked(profile):
    xy = sphere.spiral(40)[:20, :2]
    nothing = ellipses.fit(np.zeros((20, SIZE, SIZE), bool), xy)
    for light in (*LIGHTS, (-1.0, 0.0, 0.01)):
        assert not marks(ellipses.rooted(nothing), light, profile, imaging=False).any()


def test_light_is_added_where_there_is_a_mark_and_on_one_panel_alone():
    left, right = row_of_panels(2, SIZE)
    found, surface = fitted(), surfaces.plane()
    normals = np.tile((0.0, 0.0, 1.0), (SIZE, SIZE, 1))
    settings = {"color": (0.5, 0.5, 0.5), "ambient": (0.25, 0.0, 0.0)}
    commands = []
    for panel, light in ((left, (0.0, 0.0, 1.0)), (right, (0.6, 0.3, 0.5))):
        view = orthographic_view(panel)
        commands.append(panel.clear((0.0, 0.0, 0.0)))
        commands += ellipse_passes.imaging_passes(
            surface, ellipses.rooted(found), normals, view, Light(light), OCTANE, **settings
        )
    picture = pixels(commands, OCTANE, 2)
    # Above the steepest flanks nothing is shadowed from above; ambient light is red.
    assert (np.abs(picture[:, :SIZE, 0] - 0.75) < 0.01).mean() > 0.8
    dark = np.abs(picture[:, SIZE:] - (0.25, 0.0, 0.0)).max(axis=-1) < 0.01
    assert 0.2 < dark.mean() < 0.8


def test_passes_are_counted():
    (panel,) = row_of_panels(1, SIZE)
    view, surface = orthographic_view(panel), surfaces.plane()
    settings = {"normal_map": "n", "color": (1.0, 1.0, 1.0), "ambient": (0.0, 0.0, 0.0)}
    light = Light((0.0, 0.0, 1.0))
    counts = [
        sum(
            isinstance(c, Draw)
            for c in ellipse_passes.combiner_passes(
                surface, ellipses.rooted(fitted()), view, light, GEFORCE_256, shadows=shadows, **settings
            )
        )
        for shadows in (False, True)
    ]
    assert counts == [2, 3]


def test_a_slope_in_shadow_hides_a_lit_one():
    """Two squares, one behind the other: the near one is not marked, and no light shines through it."""
    (panel,) = row_of_panels(1, SIZE)
    view = orthographic_view(panel)
    square = surfaces.plane()
    both = surfaces.joined(square, square.moved(0.0, 0.0, 0.5))
    s = np.array([0.25] * 4 + [0.75] * 4)
    both = replace(both, texture_coordinates=np.stack([s, 0.0 * s + 0.5], axis=-1))
    # On the left of the map everything is free, on the right nothing is.
    free = np.zeros((20, 4, 4), bool)
    free[:, :, :2] = True
    forms = ellipses.rooted(ellipses.fit(free, sphere.spiral(40)[:20, :2]))
    up = texture_2d(vector_texels(np.tile((0.0, 0.0, 1.0), (4, 4, 1)), GEFORCE_256))
    for triangles in (both.triangles, both.triangles[::-1]):
        commands = (
            panel.clear((0.0, 0.0, 0.0)),
            *ellipse_passes.load(forms, GEFORCE_256),
            TexImage(label="load n", texture="n", image=up),
            *ellipse_passes.combiner_passes(
                replace(both, triangles=triangles),
                forms,
                view,
                Light((0.0, 0.0, 1.0)),
                GEFORCE_256,
                normal_map="n",
                color=(0.9, 0.9, 0.9),
                ambient=(0.1, 0.1, 0.1),
                sampler=NEAREST,
            ),
        )
        assert np.abs(pixels(commands, GEFORCE_256) - 0.1).max() < 0.01


def test_a_lamp_nearby_is_refused_by_the_imaging_subset():
    (panel,) = row_of_panels(1, SIZE)
    forms = ellipses.rooted(fitted())
    with pytest.raises(ValueError, match="another at each vertex"):
        ellipse_passes.imaging_marking_passes(
            surfaces.plane(), forms, orthographic_view(panel), Light((0.0, 0.0, 1.0), point=True), OCTANE
        )


def flat_and_free(normal=(0.0, 0.0, 1.0)):
    """Forms that let all light in, and a normal for each texel."""
    xy = sphere.spiral(40)[:20, :2]
    free = ellipses.rooted(ellipses.fit(np.ones((20, 4, 4), bool), xy))
    return free, np.tile(unit_vector(normal, "n"), (4, 4, 1))


def drawn_by(imaging, forms, normals, view, light, profile, **settings):
    """All commands of a picture of a square, its textures loaded."""
    surface = surfaces.plane()
    if imaging:
        return ellipse_passes.imaging_passes(surface, forms, normals, view, light, profile, **settings)
    return (
        *ellipse_passes.load(forms, profile),
        TexImage(label="load n", texture="n", image=texture_2d(vector_texels(normals, profile))),
        *ellipse_passes.combiner_passes(surface, forms, view, light, profile, normal_map="n", **settings),
    )


WAYS = pytest.mark.parametrize(("profile", "imaging"), [(GEFORCE_256, False), (OCTANE, True)])


@WAYS
@pytest.mark.parametrize("shadows", [False, True])
def test_the_colour_map_is_a_factor_of_ambient_light_and_of_the_lamp_s(profile, imaging, shadows):
    (panel,) = row_of_panels(1, SIZE)
    colors = np.tile(np.array([0.8, 0.4, 0.2]), (4, 4, 1))
    light = Light((0.0, 0.6, 0.8))
    settings = {"color": (0.5, 0.5, 0.5), "ambient": (0.3, 0.2, 0.1), "shadows": shadows, "color_map": "c"}
    commands = (
        panel.clear((0.0, 0.0, 0.0)),
        TexImage(label="load c", texture="c", image=texture_2d(colors)),
        *drawn_by(imaging, *flat_and_free(), orthographic_view(panel), light, profile, **settings),
    )
    expected = (np.array((0.3, 0.2, 0.1)) + 0.5 * 0.8) * (0.8, 0.4, 0.2)
    # Bytes of normals, of light and of every pass.
    assert np.abs(pixels(commands, profile) - expected).max() < 0.02


@WAYS
def test_a_slope_that_is_turned_away_has_ambient_light_alone(profile, imaging):
    (panel,) = row_of_panels(1, SIZE)
    light = Light((0.9, 0.0, 0.3))
    settings = {"color": (0.7, 0.7, 0.7), "ambient": (0.2, 0.2, 0.2)}
    commands = (
        panel.clear((0.0, 0.0, 0.0)),
        *drawn_by(
            imaging, *flat_and_free((-0.8, 0.0, 0.6)), orthographic_view(panel), light, profile, **settings
        ),
    )
    assert np.abs(pixels(commands, profile) - 0.2).max() < 0.01


@WAYS
def test_marks_of_a_frame_before_are_cleared(profile, imaging):
    (panel,) = row_of_panels(1, SIZE)
    view, normals = orthographic_view(panel), flat_and_free()[1]
    settings = {"color": (0.7, 0.7, 0.7), "ambient": (0.2, 0.2, 0.2)}
    nothing = ellipses.rooted(ellipses.fit(np.zeros((20, 4, 4), bool), sphere.spiral(40)[:20, :2]))
    light, commands = Light((0.0, 0.6, 0.8)), []
    for forms in (flat_and_free()[0], nothing):
        commands.append(panel.clear((0.0, 0.0, 0.0)))
        commands += drawn_by(imaging, forms, normals, view, light, profile, **settings)
    assert np.abs(pixels(commands, profile) - 0.2).max() < 0.01
