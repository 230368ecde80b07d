"""F000-2: a torus by Torrance and Sparrow's model, of two roughnesses."""

import math
from dataclasses import replace

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.heidrich_2001.shared.torus_by_rays import torus_at_pixels
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.vectors import dot, normalize, unit_vector
from fixedpipe.effects.geometry.views import BACKGROUND, Light, orthographic_view, row_of_panels
from fixedpipe.effects.passes.draws import LATER_PASS, draw
from fixedpipe.effects.reflectance import torrance_sparrow_passes as tables
from fixedpipe.effects.reflectance.anisotropic_tables import diffuse_pass
from fixedpipe.effects.reflectance.brdfs import BRDFS, Frame
from fixedpipe.effects.reflectance.fresnel import fresnel
from fixedpipe.effects.reflectance.microfacets import smith, torrance_sparrow
from fixedpipe.effects.reflectance.torrance_sparrow_passes import Coordinates, Factors
from fixedpipe.pipeline.enums import BlendFactor
from fixedpipe.pipeline.state import Blending

DATA = figure_data(__file__, "F000-2")

RADIUS, TUBE = 0.62, 0.3
_VIEWER = np.array([0.0, 0.0, 1.0])
# The picture twice: source times destination, and the destination.
_DOUBLE = Blending(BlendFactor.DST_COLOR, BlendFactor.ONE)
ONE_UNIT = ("OPENGL_1_2", "OPENGL_1_2_IMAGING", "OCTANE", "INFINITE_REALITY", "TEXRAM")
TWO_UNITS = ("MULTITEXTURE", "GEFORCE_256", "GEFORCE_3", "NV2A", "G400", "FUTURE")


def torus(size, tilt, quads):
    """The torus, ``quads`` round the axis and round the tube; coarser where panels are small."""
    count = min(quads, max(16, quads * size // 256))
    return surfaces.torus(count, count, RADIUS, TUBE).rotated(rotation("x", tilt))


def make_scene(units):
    """The scene, drawn with the given number of texture units."""

    def scene(
        profile, size, *,
        light, first_roughness, second_roughness, index, specular, diffuse, doublings,
        tilt, quads, coordinates, factors, background,
    ):  # fmt: skip
        """A torus of each roughness: the tables' product, exposed by doublings, and the diffuse light."""
        panels, lamp = row_of_panels(2, size), Light(light)
        body = torus(size, tilt, quads)
        out = [panel.clear(background) for panel in panels]
        for panel, roughness, name in zip(
            panels, (first_roughness, second_roughness), ("smooth ", "rough "), strict=True
        ):
            view = orthographic_view(panel)
            out += tables.load(profile, roughness, index, factors=factors, name=name)
            out += tables.passes(body, view, lamp, specular, units=units, coordinates=coordinates, name=name)
            double = draw(
                "the highlight twice", body.mesh(), view, None, depth_test=LATER_PASS, blending=_DOUBLE
            )
            out += (*[double] * doublings, diffuse_pass(body, view, lamp, diffuse))
        return tuple(out)

    return scene


def _at_pixels(size, light, tilt):
    """Where the torus is, its normals there, and n.l."""
    (panel,) = row_of_panels(1, size)
    covered, _, (_, _, normals) = torus_at_pixels(orthographic_view(panel), rotation("x", tilt), RADIUS, TUBE)
    return covered, normals, dot(normals, unit_vector(light, "The light's direction"))


def reference(
    size, *,
    light, first_roughness, second_roughness, index, specular, diffuse, doublings, tilt, background, **_,
):  # fmt: skip
    """Eq. 1 at every pixel, and the diffuse light: RGBA float64, top row first."""
    covered, normals, lit = _at_pixels(size, light, tilt)
    toward_light = np.broadcast_to(unit_vector(light, "The light's direction"), normals.shape)
    toward_viewer = np.broadcast_to(_VIEWER, normals.shape)
    panels = []
    for roughness in (first_roughness, second_roughness):
        value = 2.0**doublings * torrance_sparrow(toward_light, toward_viewer, normals, roughness, index)
        color = value[:, None] * np.array(specular) + np.maximum(0.0, lit)[:, None] * np.array(diffuse)
        out = np.broadcast_to(np.array([*background, 1.0]), (size, size, 4)).copy()
        out[covered, :3] = np.clip(color, 0.0, 1.0)
        panels.append(out)
    return np.concatenate(panels, axis=1)[::-1]


_SIZE = 256
# As the tables have it: what is compared with bounds in their own values is not exposed.
_EVEN = {"doublings": 0}
_BRIGHT = {"specular": (1.0, 1.0, 1.0), "diffuse": (0.0, 0.0, 0.0), **_EVEN}


def _interior(covered):
    inner = covered.copy()
    for axis in (0, 1):
        for step in (-2, -1, 1, 2):
            inner &= np.roll(covered, step, axis)
    return inner


def _width(values, normals, lit, light, index, roughness):
    """The slope of facets at which what is left of D, the rest of Eq. 1 being divided out, is one half."""
    toward_light = unit_vector(light, "The light's direction")
    half = normalize(toward_light + _VIEWER)
    seen, cosine = normals[:, 2], dot(normals, half)
    front = (lit > 0.15) & (seen > 0.3)
    rest = (
        fresnel(dot(toward_light, half), index)
        * smith(lit, seen, roughness / math.sqrt(2.0))
        / (np.pi * seen)
    )
    left = values[front] / rest[front]
    slopes = np.sqrt(1.0 - cosine[front] ** 2) / cosine[front]
    near = (left > 0.4) & (left < 0.6) & (slopes < 3.0 * roughness)
    # A line through log D over the square of the slope: -1 / m^2.
    x, y = slopes[near] ** 2, np.log(left[near])
    fall = -float((x * y).sum() / (x * x).sum())
    return math.sqrt(math.log(2.0) / fall)


def checks(figure, renderer):
    """Machine and ideal beside Eq. 1, the highlights' widths, and what tessellation and one unit change."""
    values = figure.values
    covered, normals, lit = _at_pixels(_SIZE, values["light"], values["tilt"])
    inner = _interior(covered)
    inside = inner[covered]
    roughnesses = values["first_roughness"], values["second_roughness"]
    expected = reference(_SIZE, **values)[::-1, :, :3]
    for on in (Answer.IDEAL, Answer.MACHINE):
        image = np.clip(renderer.window(on, figure, _SIZE)[..., :3], 0.0, 1.0)
        bright = renderer.window(on, figure, _SIZE, **_BRIGHT)[..., 0]
        widths = []
        for k, name in enumerate(figure.panels):
            columns = slice(k * _SIZE, (k + 1) * _SIZE)
            error = root_mean_square((image[:, columns] - expected[:, columns])[inner])
            yield DATA.check("{name}: RMS from Eq. 1 at every pixel", error, on, name=name)
            peak = image[:, columns][inner].max(axis=0)
            yield DATA.check("{name}: the highlight's peak, its mean component", peak.mean(), on, name=name)
            widths.append(_width(bright[:, columns][covered][inside], normals[inside], lit[inside],
                                 values["light"], values["index"], roughnesses[k]))  # fmt: skip
        ratio = widths[1] / widths[0] / (roughnesses[1] / roughnesses[0])
        yield DATA.check(
            "widths at half of D's maximum: their ratio over the roughnesses', less one", abs(ratio - 1.0), on
        )
    if renderer.method is figure.methods[0]:
        # The same machine with one unit at a time; the highlight alone, whose bytes are not added to.
        both = (replace(renderer, method=m).machine_window(figure, _SIZE, **_BRIGHT) for m in figure.methods)
        apart = 255.0 * float(np.abs(np.subtract(*both)).max())
        yield DATA.check("one pass beside two: most, in 1/255", apart, Answer.MACHINE)
    wanted = reference(_SIZE, **{**values, **_EVEN})[::-1, :, :3][inner_of_both(inner)]
    by_vertex = renderer.window(Answer.IDEAL, figure, _SIZE, **_EVEN)[..., :3]
    fine = root_mean_square(by_vertex[inner_of_both(inner)] - wanted)
    coarse = renderer.window(Answer.IDEAL, figure, _SIZE, quads=20, **_EVEN)[..., :3]
    coarse = coarse[inner_of_both(inner)] - wanted
    yield DATA.check("fast Phong: RMS from Phong", fine, Answer.IDEAL)
    yield DATA.check("20 x 20 polygons: RMS over that", root_mean_square(coarse) / fine, Answer.IDEAL)
    schlick = renderer.window(Answer.IDEAL, figure, _SIZE, **_BRIGHT, factors=Factors.SCHLICK)[:, :_SIZE, 0]
    r, toward_light = roughnesses[0] ** 2, unit_vector(values["light"], "The light's direction")
    # The model's row with k_s as F at the normal; tables keep Z over its largest value, 1/r, and pi for 4 pi.
    model = 4.0 * r * BRDFS["schlick"].radiance(
        np.broadcast_to(toward_light, normals.shape), np.broadcast_to(_VIEWER, normals.shape),
        Frame(normals, np.zeros(3), np.zeros(3)),
        roughness=r, isotropy=1.0, specular=float(fresnel(1.0, values["index"])),
    )  # fmt: skip
    error = root_mean_square(schlick[covered][inside] - model[inside])
    yield DATA.check("Schlick's factors: RMS from his model at every pixel", error, Answer.IDEAL)
    changed = {"coordinates": Coordinates.TEXTURE_MATRIX, **_EVEN}
    by_matrix = renderer.window(Answer.IDEAL, figure, _SIZE, **changed)[..., :3]
    yield DATA.check(
        "texture matrix beside vertices: most", float(np.abs(by_matrix - by_vertex).max()), Answer.IDEAL
    )


def inner_of_both(inner):
    """A panel's mask for both panels."""
    return np.concatenate([inner, inner], axis=1)


FIGURE = Figure(
    **DATA.words,
    size=512,
    parameters={
        "light": word.LIGHT((-0.45, 0.6, 0.75)),
        "first_roughness": word.of(
            word.Number(0.05, 1.0), 0.15, "The left torus's roughness m: the slope where D is 1/e."
        ),
        "second_roughness": word.of(word.Number(0.05, 1.0), 0.35, "The right torus's."),
        "index": word.of(
            word.Number(1.0, 200.0), 200.0, "The index of refraction: 1.5 is glass, 200 a metal."
        ),
        "specular": word.SPECULAR((1.0, 0.88, 0.62)),
        "diffuse": word.DIFFUSE((0.40, 0.25, 0.10)),
        "doublings": word.of(
            word.Whole(0, 4), 2, "How often the highlight is added to itself: the exposure."
        ),
        "tilt": word.DEGREES(55.0, "How far the torus leans towards the viewer."),
        "quads": word.of(word.Whole(16, 400), 200, "Polygons round the axis, and round the tube."),
        "coordinates": word.of(
            word.of_enum(*Coordinates), Coordinates.VERTICES, "Who makes the tables' coordinates."
        ),
        "factors": word.of(
            word.of_enum(*Factors), Factors.TORRANCE_SPARROW, "Whose functions the tables hold."
        ),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(
        Method("one pass on two units", make_scene(2), TWO_UNITS),
        Method("two passes on one unit", make_scene(1), ONE_UNIT),
    ),
    acceptance=checks,
    reference=reference,
)
