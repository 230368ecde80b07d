"""F004-4: two spheres brushed in different directions."""

import numpy as np

from fixedpipe.effects.acceptance import material_reference, seen_places
from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.measures import half_maximum_aspect, principal_axis
from fixedpipe.effects.bump_mapping import diffuse_bump
from fixedpipe.effects.computed_once import computed_once
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import COMBINER_MACHINES, DARK, IMAGING_MACHINES_8, Figure, Method
from fixedpipe.effects.figures.kautz_seidel_2000.shared.brushed_sphere import BRUSHED_SPHERE, COMPARED
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import rotate, rotation
from fixedpipe.effects.geometry.vectors import cross, normalize
from fixedpipe.effects.geometry.views import (
    BACKGROUND,
    Light,
    orthographic_view,
    row_of_panels,
)
from fixedpipe.effects.reflectance import anisotropic_blinn_phong, imaging_subset, material_textures
from fixedpipe.effects.reflectance.material_textures import Brushing

DATA = figure_data(__file__, "F004-4")

# The method that draws flat triangles.
FLAT = "imaging subset"


def _spheres(size, slices, stacks, map_columns, map_rows, tilt, radius, **strokes):
    """(name, panel, view, surface, material) of the sphere brushed along its meridians, then of the other."""
    surface = surfaces.sphere(slices, stacks).rotated(rotation("x", tilt))
    for panel, brushing, name in zip(
        row_of_panels(2, size),
        (Brushing.ALONG_T, Brushing.ALONG_S),
        ("longitudinal", "latitudinal"),
        strict=True,
    ):
        material = material_textures.brushed(map_columns, map_rows, brushing, **strokes)
        view = orthographic_view(panel, half_height=1.0 / radius)
        yield f"{name} brushing", panel, view, surface, material


def scene(profile, size, *, light, diffuse, ambient, specular, background, **spheres):
    """F004-4: a sphere brushed along its meridians (left) and one brushed along its parallels (right)."""
    toward, out = Light(light), []
    for name, panel, view, surface, material in _spheres(size, **spheres):
        loading, names = material_textures.load(material, name, profile)
        out += (
            panel.clear(background),
            *loading,
            *diffuse_bump.diffuse_pass(
                surface, names.normal, view, toward, profile, color=diffuse, ambient=ambient
            ),
            *anisotropic_blinn_phong.specular_pass(surface, names, view, toward, profile, specular=specular),
        )
    return tuple(out)


def imaging_scene(profile, size, *, light, diffuse, ambient, specular, background, **spheres):
    """The same with the imaging subset (K08): every triangle that faces the viewer is flat and is loaded by
    itself.
    """
    out = []
    for name, panel, view, surface, material in _spheres(size, **spheres):
        out += (
            panel.clear(background),
            *imaging_subset.commands(
                surface,
                material,
                view,
                Light(light),
                profile,
                color=diffuse,
                ambient=ambient,
                specular=specular,
                name=name,
            ),
        )
    return tuple(out)


def _seen(values, size, flat):
    facets = (values["slices"], values["stacks"]) if flat else None
    return seen_places.sphere(size, values["radius"], (("x", values["tilt"]),), COMPARED, facets=facets)


@computed_once
def _by_pixels(values, size, flat, brushing):
    """One sphere's ``material_reference.pictures``."""
    strokes = {name: values[name] for name in ("alpha_x", "alpha_y", "spread", "depth", "k_s")}
    material = material_textures.brushed(values["map_columns"], values["map_rows"], brushing, **strokes)
    seen = _seen(values, size, flat)
    return material_reference.pictures(material_reference.fields(material), seen, values, squared_first=flat)


def _checks_by_pixels(figure, renderer):
    """The displayed spheres against Eq. 1 at every pixel, and the strokes of each field."""
    size, flat, values = figure.size, renderer.method.name == FLAT, dict(figure.values)
    where = _seen(values, size, flat).where
    brushings = Brushing.ALONG_T, Brushing.ALONG_S
    found = {k: _by_pixels(values, size, flat, brushing) for k, brushing in enumerate(brushings)}
    return material_reference.checks(DATA, figure, renderer, where, found)


def checks(figure, renderer):
    """The spheres pixel by pixel; orientation, elongation and aspect of their highlights."""
    yield from _checks_by_pixels(figure, renderer)
    size = 512
    parameters, changes = figure.values, {**DARK, "specular": (1.0, 1.0, 1.0)}
    for on in Answer:
        image = renderer.window(on, figure, size, **changes)[..., 0]
        (left, long_left), (right, long_right) = (
            principal_axis(image[:, k * size : (k + 1) * size]) for k in (0, 1)
        )
        turn = abs(left - right) % 180.0
        yield DATA.check("highlight orientations differ by 90 degrees, deviation", abs(turn - 90.0), on)
        yield DATA.check(
            "angle of the highlight to the horizontal, longitudinal brushing, degrees", abs(left), on
        )
        yield DATA.check(
            "angle of the highlight to the vertical, latitudinal brushing, degrees", 90.0 - abs(right), on
        )
        yield DATA.check("elongation of the highlight, longitudinal brushing", long_left, on)
        yield DATA.check("elongation of the highlight, latitudinal brushing", long_right, on)
    smooth = renderer.method.name != FLAT
    changes |= {"spread": 0.0, "depth": 0.0, "k_s": (1.0, 1.0)}
    changes |= {"slices": 200, "stacks": 101} if smooth else {}
    image = renderer.ideal_window(figure, size, **changes)[:, size:, 0]
    half = normalize(normalize(np.array(parameters["light"])) + np.array([0.0, 0.0, 1.0]))
    axis = rotate(rotation("x", parameters["tilt"]), np.array([0.0, 1.0, 0.0]))
    east = normalize(cross(axis, half))
    aspect = half_maximum_aspect(image, (east, cross(half, east), half), parameters["radius"])
    expected = parameters["alpha_y"] / parameters["alpha_x"]
    yield Check(
        "aspect at half maximum over alpha_y / alpha_x, relative deviation",
        abs(aspect / expected - 1.0),
        at_most=0.1,
        on=Answer.IDEAL,
        reason="the catalogue's acceptance; smooth brushing and 200 slices, so that only Eq. 1 is measured"
        if smooth
        else "the catalogue's acceptance, for smooth brushing; on the figure's own flat triangles, as "
        "40000 take minutes to load",
    )


FIGURE = Figure(
    **DATA.words,
    parameters={
        **BRUSHED_SPHERE,
        "alpha_x": word.ALPHA_X(0.25),
        "alpha_y": word.ALPHA_Y(1.0),
        "tilt": word.DEGREES(6.0, "How far the spheres' upper poles lean towards the viewer."),
        "light": word.LIGHT((0.40, 0.30, 0.87)),
        "radius": word.RADIUS(0.92),
        "diffuse": word.DIFFUSE((0.30, 0.33, 0.40)),
        "ambient": word.AMBIENT((0.03, 0.03, 0.04)),
        "specular": word.SPECULAR((0.85, 0.85, 0.82)),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(
        Method("register combiners", scene, COMBINER_MACHINES),
        Method(FLAT, imaging_scene, IMAGING_MACHINES_8),
    ),
    acceptance=checks,
)
