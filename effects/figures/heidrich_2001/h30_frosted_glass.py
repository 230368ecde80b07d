"""H30: a room through clear and through frosted glass."""

from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.material_reference import least_share
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.environment_maps import (
    bumped_reflections,
    environments,
    fresnel_passes,
    prefilter,
    refracted_light,
)
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.heidrich_2001.shared import glass, reflecting
from fixedpipe.effects.geometry import cube_maps
from fixedpipe.effects.geometry.vectors import dot
from fixedpipe.effects.geometry.vertex_vectors import reflected
from fixedpipe.effects.geometry.views import BACKGROUND, panel_of, perspective_view, row_of_panels
from fixedpipe.effects.reflectance.fresnel import fresnel

DATA = figure_data(__file__, "H30")

EYE, FIELD_OF_VIEW = (-0.35, 0.3, -3.1), 46.0


def white(toward):
    """An environment that is one everywhere."""
    return np.ones(toward.shape)


ENVIRONMENTS = {"room": environments.room, "white": white}
_CLEAR = "environment map"


def camera(panel):
    """The view of a panel."""
    return perspective_view(panel, EYE, field_of_view=FIELD_OF_VIEW, radius=1.2)


def map_names(roughnesses):
    """Names of the textures, from the clear map on."""
    return [_CLEAR, *(f"map filtered with roughness {roughness:g}" for roughness in roughnesses)]


def segments(size):
    """Segments of round things on a panel of ``size`` pixels: few for the plain-Python specification."""
    return 16 if size < 64 else 64 if size < 200 else 160


@lru_cache(maxsize=8)
def maps(seen, edge, roughnesses):
    """An environment, directions to colours, as cube maps of floats: unfiltered, and filtered by Phong's lobe
    for each roughness.
    """
    cube = environments.faces(edge, seen)
    filtered = (np.clip(prefilter.phong(cube, 1.0 / roughness), 0.0, 1.0) for roughness in roughnesses)
    return [cube, *filtered]


def make_scene(way, cubes):
    """The figure's scene by a ``glass.Refraction``; ``cubes``: whether the board has cube maps."""

    def scene(profile, size, *, index, roughnesses, environment, photograph, objects, detail, background):
        edge = glass.texels(size)
        seen = photograph.panorama if photograph else ENVIRONMENTS[environment]
        surface = glass.OBJECTS[objects](segments(size) if detail is None else detail)
        named = dict(zip(map_names(roughnesses), maps(seen, edge, tuple(roughnesses)), strict=True))
        panels = row_of_panels(3, size)
        views = [camera(panel) for panel in panels]
        out = [
            *way.loading(profile, views[0], named),
            fresnel_passes.load_table("F(n.v)", index, profile),
        ]
        if cubes:
            out.append(bumped_reflections.load_environment(edge, profile, seen))
        for number, (panel, view, name) in enumerate(zip(panels, views, named, strict=True)):
            out.append(panel.clear(background))
            if cubes:
                out += bumped_reflections.backdrop(view)
            else:
                load, show = bumped_reflections.picture_backdrop(view, edge, profile, seen)
                out += (load, show) if number == 0 else (show,)
            mesh = refracted_light.refracted_mesh(surface, view, index)
            read = way.through(name, view, edge)
            out += way.passes(surface, view, "F(n.v)", way.mirror(name, view))
            out.append(fresnel_passes.under_coat_pass(mesh, view, read))
        return tuple(out)

    return scene


def bent(eye, normals, index):
    """Refracted directions by Snell's law for the angles' sines: float64 [n, 3]."""
    cosine = dot(eye, normals)
    across = eye - cosine[:, None] * normals
    inside = across / index
    return -inside - np.sqrt(1.0 - dot(inside, inside))[:, None] * normals


def reference(size, *, index, roughnesses, environment, photograph, objects, detail, **_):
    """The equation at each pixel that a ray finds on the glass; other pixels have no reference."""
    surface = glass.OBJECTS[objects](segments(size) if detail is None else detail)
    panels = row_of_panels(3, size)
    normals, eye, there = glass.surface_by_rays(surface, camera(panels[0]))
    normals, eye = normals[there], eye[there]
    factor = fresnel(dot(normals, eye), index)[:, None]
    out = np.zeros((size, 3 * size, 4))
    seen = photograph.panorama if photograph else ENVIRONMENTS[environment]
    for panel, cube in zip(panels, maps(seen, glass.texels(size), tuple(roughnesses)), strict=True):
        through = cube_maps.look_up(cube, bent(eye, normals, index))
        cell = out[:, panel.x : panel.x + size]
        cell[there, :3] = factor * cube_maps.look_up(cube, reflected(eye, normals)) + (1.0 - factor) * through
        cell[there, 3] = 1.0
    return out[::-1]


# How many pixels of a panel's glass are compared.
_SOME = 96


@lru_cache(maxsize=1)
def _by_rays(size, index, objects):
    """Some pixels of the glass, by their numbers, and the light there that is mirrored, and that goes through
    where the glass is clear; some of the room behind, and its colours. By the room itself.
    """
    view, surface = camera(row_of_panels(3, size)[0]), glass.OBJECTS[objects](segments(size))
    normals, eye, there = glass.surface_by_rays(surface, view)
    cosines = (normals * eye).sum(axis=-1)
    some = reflecting.some_of(there & (cosines > 0.2), 16 * _SOME)
    back, behind = reflecting.backdrop_by_rays(surface, view)
    places = reflecting.some_of(behind, 16 * _SOME)
    normals, eye, cosines = normals.reshape(-1, 3)[some], eye.reshape(-1, 3)[some], cosines.ravel()[some]
    factor = glass.by_polarizations(cosines, index)[:, None]
    mirror = factor * environments.room(2.0 * cosines[:, None] * normals - eye)
    through = (1.0 - factor) * environments.room(bent(eye, normals, index))
    return some, mirror, through, places, environments.room(back.reshape(-1, 3)[places])


def _displayed_checks(figure, renderer):
    """The clear glass, and the room behind all three, as displayed."""
    of = _by_rays(figure.size, figure.values["index"], figure.values["objects"])
    some, mirror, through, places, room = of
    whole = mirror + through
    flat_glass, flat_room = (np.broadcast_to(c.mean(axis=0), c.shape) for c in (whole, room))
    for on in (Answer.MACHINE, Answer.IDEAL):
        window = np.clip(renderer.window(on, figure, figure.size), 0.0, 1.0)
        panels = [panel_of(window, k).reshape(-1, 3) for k in range(3)]
        shares = [least_share(panels[0][some], whole, flat_glass, mirror, through)]
        shares += [least_share(panel[places], room, flat_room) for panel in panels]
        yield DATA.check(
            "of what the clear glass and the room behind change, the least share that is seen",
            min(shares),
            on,
        )


def checks(figure, renderer):
    """A ball of glass against the maps looked up at each pixel."""
    yield from _displayed_checks(figure, renderer)
    size, values = 160, figure.values
    view = camera(row_of_panels(1, size)[0])
    normals, eye, seen = glass.ball_by_rays(view)
    inside = seen & (dot(normals, eye) > 0.2)
    normals, eye = normals[inside], eye[inside]
    factor = glass.by_polarizations(dot(normals, eye), values["index"])[:, None]
    edge = glass.texels(size)
    known = maps(environments.room, edge, tuple(values["roughnesses"]))
    changes = {"objects": "ball", "detail": 192}
    sharpness = []
    for on in Answer:
        room = renderer.window(on, figure, size, **changes)
        blank = renderer.window(on, figure, size, environment="white", **changes)
        for number, cube in enumerate(known):
            panel = room[:, number * size : (number + 1) * size]
            expected = factor * cube_maps.look_up(cube, reflected(eye, normals)) + (
                1.0 - factor
            ) * cube_maps.look_up(cube, bent(eye, normals, values["index"]))
            yield DATA.check(
                "panel {n}: RMS from the map looked up at each pixel",
                root_mean_square(panel[inside] - expected),
                on,
                at_most=0.04 if number == 0 else 0.006,
                n=number + 1,
            )
            shown = np.where(inside[..., None], panel, 0.0)
            both = (inside[:, 1:] & inside[:, :-1])[..., None]
            sharpness.append(root_mean_square((shown[:, 1:] - shown[:, :-1]) * both))
        yield DATA.check(
            "a white room through the glass, largest deviation from one",
            np.abs(np.clip(blank, 0.0, 1.0) - 1.0).max(),
            on,
            at_most=1.0 / 255.0,
        )
    yield DATA.check(
        ("steps between neighbouring pixels, first panel over second and second over third, the lesser"),
        min(sharpness[0] / sharpness[1], sharpness[1] / sharpness[2]),
        Answer.IDEAL,
    )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "index": word.NUMBER(1.5, "The index of refraction, inside over outside.", low=1.0, high=1000.0),
        "roughnesses": word.of(
            word.Several((word.Number(0.001, 1.0),) * 2),
            (0.002, 0.01),
            "The reciprocals of Phong's exponents in the middle and at the right.",
        ),
        "environment": word.of(
            word.Choice({name: name for name in ENVIRONMENTS}),
            "room",
            "What is seen: a room, or white everywhere.",
        ),
        "photograph": own_maps.PANORAMA,
        "objects": word.of(
            word.Choice({name: name for name in glass.OBJECTS}), "ball in a ring", "What is of glass."
        ),
        "detail": word.of(
            word.Maybe(word.Whole(6, 256, even=True), "as many as fit the panel"),
            None,
            "Segments of round things.",
        ),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(
        Method("three passes, a cube map", make_scene(glass.CUBE_MAPS, True), ("GEFORCE_256",)),
        Method(
            "two units and two passes, a cube map",
            make_scene(glass.CUBE_MAPS_FOLDED, True),
            ("GEFORCE_3", "NV2A", "FUTURE"),
        ),
        Method(
            "three passes, a sphere map and a disc",
            make_scene(glass.SPHERE_MAPS, False),
            ("OPENGL_1_2", "OCTANE", "INFINITE_REALITY"),
        ),
        Method(
            "two units and two passes, a sphere map and a disc",
            make_scene(glass.SPHERE_MAPS_FOLDED, False),
            ("MULTITEXTURE", "G400"),
        ),
    ),
    acceptance=checks,
    reference=reference,
)
