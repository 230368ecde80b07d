"""Z06: object-space bump mapping on machines without texture shaders."""

import numpy as np

from fixedpipe.effects.acceptance import seen_places
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import POWER_8, arithmetic_check, root_mean_square
from fixedpipe.effects.bump_mapping import lighting_spaces
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.zwicker_2016.shared.bumps import load_normals, slices, texels
from fixedpipe.effects.figures.zwicker_2016.shared.bumpy_sphere import (
    FOR_OBJECT,
    bump_normals,
    object_normals,
)
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.views import (
    BACKGROUND,
    Light,
    Panel,
    orthographic_view,
    panel_of,
    row_of_panels,
)
from fixedpipe.effects.reflectance import brdfs

DATA = figure_data(__file__, "Z06")

TURNS = (0.0, 55.0)


def _scene(profile, size, load, passes, *, light, diffuse, ambient, specular, background, **bumps):
    """Two panels: the sphere, and the sphere turned about its axis, with the same map."""
    n = slices(size)
    normals = object_normals(bump_normals(texels(size), **bumps))
    out = list(load(normals, profile))
    for panel, degrees in zip(row_of_panels(2, size), TURNS, strict=True):
        turn = rotation("y", degrees)
        surface = surfaces.sphere(n, n // 2).rotated(turn)
        view = orthographic_view(panel, half_height=1.1)
        out += (
            panel.clear(background),
            # The rows of the transposed rotation are where the object's axes went.
            *passes(surface, normals, view, Light(light), profile, color=diffuse, ambient=ambient,
                    specular=specular, axes=turn.T),
        )  # fmt: skip
    return tuple(out)


def combiner_scene(profile, size, **parameters):
    """Z06 by register combiners: the map is loaded once."""

    def load(normals, profile):
        return (load_normals(normals, FOR_OBJECT, profile),)

    def passes(surface, normals, *arguments, **settings):
        return lighting_spaces.object_space_passes(surface, FOR_OBJECT, *arguments, **settings)

    return _scene(profile, size, load, passes, **parameters)


def color_matrix_scene(profile, size, **parameters):
    """Z06 by the imaging subset: the map is loaded twice for each light and viewer."""

    def load(normals, profile):
        return ()

    return _scene(profile, size, load, lighting_spaces.color_matrix_passes, **parameters)


def _by_pixels(size, p):
    """Both spheres in float64, by rays: of each which pixels show it, and their colours."""
    n, view = slices(size), orthographic_view(Panel(0, 0, size, size), half_height=1.1)
    own = object_normals(bump_normals(texels(size), p["relief"]))
    toward = seen_places.unit(np.array(p["light"]))
    half = seen_places.unit(toward + np.array([0.0, 0.0, 1.0]))
    for degrees in TURNS:
        turn = rotation("y", degrees)
        seen = seen_places.surface(surfaces.sphere(n, n // 2).rotated(turn), view)
        normals = seen_places.looked_up(own, seen) @ turn.T
        cosine, power = normals @ toward, np.maximum(normals @ half, 0.0) ** 8
        highlight = p["specular"] * np.clip(4.0 * cosine, 0.0, 1.0) * power
        lit = np.maximum(cosine, 0.0)[:, None] * np.array(p["diffuse"]) + np.array(p["ambient"])
        yield seen.where, lit + highlight[:, None]


def checks(figure, renderer):
    """The picture pixel by pixel; its diffuse part against the equation, as it stands and turned."""
    true = dict(enumerate(_by_pixels(figure.size, figure.values)))
    for on, share in seen_places.shares_alike(figure, renderer, true):
        yield DATA.check(
            "pixels that show what a ray finds there within 8/255, the least of the panels", share, on
        )
    size = 128
    light = np.array(figure.values["light"])
    light = light / np.sqrt((light * light).sum())
    edge = ((np.arange(size) + 0.5) / size * 2.0 - 1.0) * 1.1
    x, y = np.meshgrid(edge, edge)
    inside = x * x + y * y < 0.8
    z = np.sqrt(np.where(inside, 1.0 - x * x - y * y, 0.0))
    shown = renderer.machine_window(
        figure, size, relief=0.0, diffuse=(1.0, 0.0, 0.0), ambient=(0.0, 0.0, 0.0)
    )
    for k, degrees in enumerate(TURNS):
        lit = brdfs.lambert(np.stack([x, y, z], axis=-1), light)
        # The highlight is white and the diffuse light red, so that their difference is the diffuse part.
        picture = panel_of(shown, k)
        unclamped = inside & (picture[..., 0] < 1.0)
        error = (picture[..., 0] - picture[..., 1] - lit)[unclamped]
        yield DATA.check(
            "the smooth sphere's diffuse light, turned by {degrees:g} degrees, RMS",
            root_mean_square(error),
            Answer.MACHINE,
            degrees=degrees,
        )
    yield arithmetic_check(figure, renderer, 0.0051, POWER_8)


FIGURE = Figure(
    **DATA.words,
    parameters={
        "relief": word.RELIEF(0.45),
        "light": word.LIGHT((-0.55, 0.6, 0.58)),
        "diffuse": word.DIFFUSE((0.3, 0.42, 0.5)),
        "ambient": word.AMBIENT((0.04, 0.05, 0.06)),
        "specular": word.SHARE(0.4, "The strength of the highlights, which are white.", word.FULL),
        "background": word.BACKDROP(BACKGROUND),
        "height_field": own_maps.height_field("the bumps"),
        "height_scale": own_maps.HEIGHT_SCALE(0.06),
    },
    methods=(
        Method("register combiners", combiner_scene, ("GEFORCE_256",)),
        Method("imaging subset", color_matrix_scene, ("OCTANE", "OPENGL_1_2_IMAGING")),
    ),
    acceptance=checks,
)
