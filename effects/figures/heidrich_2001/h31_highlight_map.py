"""H31: highlights of lights from an environment map, next to those of lighting at vertices."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.material_reference import least_share
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.acceptance.ray_caster import RayCaster, primary_rays
from fixedpipe.effects.acceptance.seen_places import unit
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.environment_maps import (
    fresnel_passes,
    highlight_maps,
    mirror_passes,
    reflections,
)
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.heidrich_2001.shared.reflecting import camera, normals_by_rays
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import rotate, rotation
from fixedpipe.effects.geometry.vectors import dot, normalize, unit_vector
from fixedpipe.effects.geometry.vertex_vectors import reflected
from fixedpipe.effects.geometry.views import BACKGROUND, Panel, panel_of, row_of_panels
from fixedpipe.effects.passes.draws import FIRST_PASS
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.state import Light, Lighting, Material, PassState

DATA = figure_data(__file__, "H31")

EYE = (0.0, 0.47, 2.88)
MAP = "highlights"
_BLACK = (0.0, 0.0, 0.0, 1.0)
LIGHTS = (
    ((-0.75, 0.55, 0.7), (1.0, 0.86, 0.62)),
    ((0.8, 0.6, 0.55), (0.5, 0.7, 1.0)),
    ((0.1, 0.95, 0.15), (0.95, 0.95, 0.95)),
    ((0.35, -0.55, 0.9), (0.75, 0.3, 0.42)),
)


def ball_in_ring(segments):
    """A ball of radius 0.5 in a ring that leans."""
    ring = surfaces.torus(segments, segments // 2, 0.84, 0.15)
    ring = ring.rotated(rotation("x", 24.0)).rotated(rotation("z", 16.0))
    return surfaces.joined(ring, surfaces.sphere(segments, segments // 2).scaled(0.5))


def lights_of(values):
    """Directions and colours, in pairs."""
    return tuple(zip(values["directions"], values["colors"], strict=True))


def lit_pass(surface, view, lights, diffuse, k_s, shininess):
    """Lighting at the vertices, with a highlight where ``k_s`` is above 0, the viewer at the eye."""
    turn = np.array(view.modelview)[:3, :3]
    sources = tuple(
        Light(
            diffuse=(*color, 1.0),
            specular=(*color, 1.0),
            position=(*rotate(turn, unit_vector(direction, "The light's direction")).tolist(), 0.0),
        )
        for direction, color in lights
    )
    material = Material(_BLACK, (*diffuse, 1.0), (k_s, k_s, k_s, 1.0), _BLACK, float(shininess))
    lighting = Lighting(sources, material, material, _BLACK, local_viewer=True)
    state = PassState(
        vertex=view.vertex_with(lighting=lighting),
        depth_test=FIRST_PASS,
        polygon=mirror_passes.FRONT,
    )
    label = "diffuse light and highlights at the vertices" if k_s else "diffuse light at the vertices"
    return Draw(label=label, mesh=surface.mesh(), state=state)


def _cube_loading(profile, view, size, lights, exponent):
    edge = min(max(1 << (size - 1).bit_length(), 32), 256)
    cube = np.minimum(highlight_maps.cube(edge, lights, exponent), 1.0)
    return (reflections.load_cube(MAP, cube, profile),)


def _sphere_loading(profile, view, size, lights, exponent):
    # As large as the window lets it be.
    edge = min(1 << (size.bit_length() - 1), 512)
    return highlight_maps.draw_sphere_map(MAP, lights, exponent, view, edge, profile)


def make_scene(loading, read):
    """The figure's scene: how the map is made, and (texture, view) -> the unit that reads it."""

    def scene(profile, size, *, segments, exponent, diffuse, k_s, background, **values):
        lights = lights_of(values)
        surface = ball_in_ring(segments)
        panels = row_of_panels(2, size)
        views = [camera(panel, EYE) for panel in panels]
        # A half vector's cosine to four times the exponent is about as wide as Phong's.
        shininess = min(4 * exponent, 128)
        return (
            *loading(profile, views[0], size, lights, exponent),
            panels[0].clear(background),
            lit_pass(surface, views[0], lights, diffuse, k_s, shininess),
            panels[1].clear(background),
            lit_pass(surface, views[1], lights, diffuse, 0.0, 0.0),
            mirror_passes.mirror_pass(surface, views[1], read(MAP, views[1]), k_s, added=True),
        )

    return scene


def _lit(values, normals, eye):
    """Diffuse light and highlights where normals and vectors to the eye [..., 3] are: float64 [..., 3] each.

    Source: OpenGL 1.2.1, section 2.13.1, without ambient light.
    """
    diffuse, bright = np.zeros((2, *normals.shape))
    for direction, color in lights_of(values):
        toward = unit(np.array(direction))
        facing = np.maximum(normals @ toward, 0.0)[..., None]
        half = np.maximum((normals * unit(eye + toward)).sum(axis=-1), 0.0)[..., None]
        diffuse += facing * np.array(values["diffuse"]) * color
        bright += values["k_s"] * (half ** min(4 * values["exponent"], 128) * (facing > 0.0)) * color
    return diffuse, bright


def _displayed_checks(figure, renderer):
    """Light at vertices on the left, and on the right under the map's highlights, as displayed."""
    size, values = figure.size, figure.values_of(renderer.method)
    surface, view = ball_in_ring(values["segments"]), camera(Panel(0, 0, size, size), EYE)
    normals, eye, where = normals_by_rays(surface, view)
    where &= (normals * eye).sum(axis=-1) > 0.3
    hits = RayCaster(surface.positions[surface.triangles]).nearest(*primary_rays(view), 1.0)
    at = where.ravel()
    corners, weights = surface.triangles[hits.triangle[at]], hits.barycentrics[at][..., None]
    to_eye = unit(np.array(EYE) - surface.positions)
    diffuse, bright = (light[corners] for light in _lit(values, surface.normals, to_eye))
    at_vertices = (np.minimum(diffuse + bright, 1.0) * weights).sum(axis=1)
    diffuse = (diffuse * weights).sum(axis=1)
    normals, eye = normals[where], eye[where]
    smooth = np.minimum(sum(_lit(values, normals, eye)), 1.0)
    mirrored = 2.0 * (normals * eye).sum(axis=-1, keepdims=True) * normals - eye
    by_map = np.zeros(mirrored.shape)
    for direction, color in lights_of(values):
        lobe = np.maximum(mirrored @ unit(np.array(direction)), 0.0) ** values["exponent"]
        by_map += lobe[:, None] * np.array(color)
    by_map = values["k_s"] * np.minimum(by_map, 1.0)
    for on in Answer:
        left, right = (
            panel_of(np.clip(renderer.window(on, figure, size), 0.0, 1.0), k)[where] for k in (0, 1)
        )
        yield DATA.check(
            "at vertices: of the light and of its way along the mesh, the least share that is seen",
            least_share(left, at_vertices, smooth, 0.0 * smooth),
            on,
        )
        yield DATA.check(
            "in a map: of the diffuse light under the highlights, the share that is seen",
            least_share(right, np.minimum(diffuse + by_map, 1.0), by_map),
            on,
        )


def checks(figure, renderer):
    """Highlights alone against Phong's and Blinn's models at every pixel's normal."""
    size, values = 192, figure.values_of(renderer.method)
    surface = ball_in_ring(values["segments"])
    normals, eye, seen = normals_by_rays(surface, camera(Panel(0, 0, size, size), EYE))
    inside = seen & (dot(normals, eye) > 0.3)
    for step in (-1, 1):
        for axis in (0, 1):
            inside &= dot(normals, np.roll(normals, step, axis=axis)) > 0.8
    normals, eye = normals[inside], eye[inside]
    lights, exponent, k_s = lights_of(values), values["exponent"], values["k_s"]
    phong = np.minimum(highlight_maps.highlights(reflected(eye, normals), lights, exponent), 1.0) * k_s
    blinn = np.zeros(phong.shape)
    for direction, color in lights:
        toward = unit_vector(direction, "The light's direction")
        half = np.maximum(dot(normals, normalize(toward + eye)), 0.0)
        faces = dot(normals, np.broadcast_to(toward, normals.shape)) > 0.0
        blinn += k_s * (half ** min(4 * exponent, 128) * faces)[:, None] * np.array(color)
    blinn = np.minimum(blinn, 1.0)
    yield from _displayed_checks(figure, renderer)
    changes = {"diffuse": (0.0, 0.0, 0.0), "background": (0.0, 0.0, 0.0)}
    for on in Answer:
        image = np.clip(renderer.window(on, figure, size, **changes), 0.0, 1.0)
        at_vertices, by_map = (image[:, k * size : (k + 1) * size][inside] for k in (0, 1))
        error = root_mean_square(by_map - phong)
        yield DATA.check("the map's highlights against Phong's model at each pixel, RMS", error, on)
        yield DATA.check(
            "lighting's error from its own model at each pixel over the map's from its own",
            root_mean_square(at_vertices - blinn) / error,
            on,
        )


_SHARES = word.Several((word.COLOR_KIND,) * len(LIGHTS))
_DIRECTIONS = word.Several((word.DIRECTION_KIND,) * len(LIGHTS))

FIGURE = Figure(
    **DATA.words,
    parameters={
        "segments": word.of(word.Whole(8, 256, even=True), 24, "Segments of ball and ring."),
        "exponent": word.of(word.Whole(1, 128), 24, "The exponent of Phong's lobes."),
        "directions": word.of(
            _DIRECTIONS, tuple(direction for direction, _ in LIGHTS), "The directions to the lights."
        ),
        "colors": word.of(_SHARES, tuple(color for _, color in LIGHTS), "The lights' colours.", word.FULL),
        "diffuse": word.DIFFUSE((0.16, 0.19, 0.24)),
        "k_s": word.SHARE(0.7, "What highlights are multiplied by."),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(
        Method(
            "a cube map of the host's",
            make_scene(_cube_loading, fresnel_passes.cube_unit),
            ("GEFORCE_256", "GEFORCE_3", "NV2A", "FUTURE"),
        ),
        Method(
            "a sphere map drawn in the window",
            make_scene(_sphere_loading, lambda texture, view: fresnel_passes.sphere_unit(texture)),
            ("OPENGL_1_2", "OCTANE", "INFINITE_REALITY"),
        ),
    ),
    acceptance=checks,
)
