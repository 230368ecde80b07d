"""H13: tables of the halfway vector on a torus, brushed in either direction; H14, another model's tables."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.measures import pixel_grid, root_mean_square
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.heidrich_2001.shared.torus_by_rays import torus_at_pixels
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.geometry.views import (
    BACKGROUND,
    Light,
    orthographic_view,
    perspective_view,
    row_of_panels,
)
from fixedpipe.effects.passes.draws import EDGE, FIRST_PASS, REPLACE, draw, unit
from fixedpipe.effects.reflectance import anisotropic_tables as tables
from fixedpipe.effects.reflectance.brdfs import BRDFS, Frame

DATA = figure_data(__file__, "H13")

RADIUS, TUBE = 0.68, 0.3
EYE, FIELD = (0.0, 0.0, 4.2), 27.0
# How much of its panel the picture of a table fills.
SHOWN = 0.86


def _torus(size, tilt, around):
    """The torus, coarser where panels are small."""
    count = min(around, max(16, around * size // 256))
    return surfaces.torus(count, max(8, count // 2), RADIUS, TUBE).rotated(rotation("x", tilt))


def make_scene(units):
    """The scene, drawn with the given number of texture units."""

    def scene(
        profile, size, *, light, alpha_along, alpha_across, exponent_along, exponent_across, specular,
        diffuse, tilt, around, background,
    ):  # fmt: skip
        """D as a picture, then three tori: brushed round the axis, round the tube, and H14's model."""
        panels = row_of_panels(4, size)
        near, torus = Light(light, point=True), _torus(size, tilt, around)
        square = surfaces.plane(half_width=SHOWN, half_height=SHOWN)
        picture = orthographic_view(panels[0])
        out = [panel.clear(background) for panel in panels]
        given = (alpha_along, alpha_across)
        exponents = (exponent_along, exponent_across)
        out += [
            tables.load_distribution("D along", tables.ward, given, profile),
            tables.load_distribution("D across", tables.ward, given[::-1], profile),
            tables.load_distribution("D of exponents", tables.ashikhmin, exponents, profile),
            tables.load_obstruction("G", tables.ward_obstruction, profile),
            tables.load_obstruction("G of exponents", tables.ashikhmin_obstruction, profile),
            draw(
                "D",
                square.mesh(),
                picture,
                None,
                (unit("D along", EDGE, environment=REPLACE),),
                depth_test=FIRST_PASS,
            ),
        ]
        for panel, d, g in zip(
            panels[1:], ("D along", "D across", "D of exponents"), ("G", "G", "G of exponents"), strict=True
        ):
            view = perspective_view(panel, EYE, field_of_view=FIELD)
            colors = specular
            if panel is panels[3]:
                # The reflectance of l.h = 1 is the colour; more of it at grazing light, up to white.
                fresnel = tables.ashikhmin_fresnel(tables.light_half(torus, view, near), specular)
                colors = np.minimum(1.0, fresnel)
            out += tables.specular_passes(torus, view, near, d, g, colors, units=units)
            out.append(tables.diffuse_pass(torus, view, near, diffuse))
        return tuple(out)

    return scene


def _panel(size, light, tilt, model, specular, diffuse, background):
    """A model at every pixel of a panel, RGB float64 [size, size, 3], bottom row first; and where the torus
    is. ``model``: (light, view, frame, specular) -> RGB.
    """
    (panel,) = row_of_panels(1, size)
    view = perspective_view(panel, EYE, field_of_view=FIELD)
    covered, points, (t, b, n) = torus_at_pixels(view, rotation("x", tilt), RADIUS, TUBE)
    toward_light = normalize(np.array(light) - points)
    toward_viewer = view.view_vectors(points)
    shining = model(toward_light, toward_viewer, Frame(n, t, b), np.array(specular))
    lambert = np.maximum(0.0, dot(n, toward_light))[:, None] * np.array(diffuse)
    out = np.broadcast_to(np.array(background, np.float64), (size, size, 3)).copy()
    out[covered] = np.clip(np.clip(shining, 0.0, 1.0) + lambert, 0.0, 1.0)
    return out, covered


def ward_model(alpha_x, alpha_y):
    """Ward's model under a light that makes k_s / (4 pi alpha_x alpha_y) the colour, with G limited to 2."""

    def model(light, view, frame, specular):
        # The row's radiance at k_s = 4 pi alpha_x alpha_y; above it only where G is clamped.
        value = BRDFS["ward_exact"].radiance(light, view, frame, alpha_x=alpha_x, alpha_y=alpha_y)
        value = value * (4.0 * np.pi * alpha_x * alpha_y)
        n_l, n_v = dot(frame.normal, light), dot(frame.normal, view)
        front = (n_l > 0.0) & (n_v > 0.0)
        g = np.sqrt(np.where(front, n_l, 1.0) / np.where(front, n_v, 1.0))
        return (value * np.minimum(1.0, tables.LARGEST / g))[:, None] * specular

    return model


def ashikhmin_model(exponent_x, exponent_y):
    """Ashikhmin and Shirley's specular term by angles, as in their equation, without its constant."""

    def model(light, view, frame, specular):
        half = normalize(light + view)
        n_l, n_v, l_h = dot(frame.normal, light), dot(frame.normal, view), dot(light, half)
        phi = np.arctan2(dot(half, frame.binormal), dot(half, frame.tangent))
        power = exponent_x * np.cos(phi) ** 2 + exponent_y * np.sin(phi) ** 2
        front = (n_l > 0.0) & (n_v > 0.0)
        facets = np.where(front, dot(half, frame.normal), 0.0).clip(0.0) ** power
        colors = (specular + (1.0 - specular) * (1.0 - l_h[:, None]) ** 5) / l_h[:, None]
        shape = np.where(front, facets * n_l / np.maximum(np.maximum(n_l, n_v), 1e-9), 0.0)
        return shape[:, None] * np.minimum(1.0, colors)

    return model


def _models(values):
    along, across = values["alpha_along"], values["alpha_across"]
    return (
        ward_model(along, across),
        ward_model(across, along),
        ashikhmin_model(values["exponent_along"], values["exponent_across"]),
    )


def reference(size, **values):
    """The distribution and the three models at every pixel: RGBA float64, top row first."""
    x, y = pixel_grid(size, SHOWN)
    inside = np.maximum(np.abs(x), np.abs(y)) < 1.0
    table = np.where(inside, tables.ward(x, y, values["alpha_along"], values["alpha_across"]), 0.0)
    background = np.array(values["background"])
    rows = [np.where(inside[..., None], table[..., None], background)]
    scene = {name: values[name] for name in ("light", "tilt", "specular", "diffuse", "background")}
    rows += [_panel(size, model=model, **scene)[0] for model in _models(values)]
    row = np.concatenate(rows, axis=1)[::-1]
    return np.concatenate([row, np.ones((*row.shape[:2], 1))], axis=-1)


_SIZE = 256
_MEASURED = {"specular": (1.0, 1.0, 1.0), "diffuse": (0.0, 0.0, 0.0), "background": (0.0, 0.0, 0.0)}


def _eroded(covered, by=2):
    """Pixels that have none of another kind near them: polygons and rays disagree about an outline."""
    out = covered.copy()
    for _ in range(by):
        out = out & np.roll(out, 1, 0) & np.roll(out, -1, 0) & np.roll(out, 1, 1) & np.roll(out, -1, 1)
    return out


def _widths(table):
    """The table's half widths at half height along x and y, in tangents of the angle from the normal."""
    out = []
    for axis in (0, 1):
        line = table[table.shape[0] // 2] if axis == 0 else table[:, table.shape[1] // 2]
        place = ((np.arange(len(line)) + 0.5) / len(line) * 2.0 - 1.0) / SHOWN
        above = place[line >= 0.5 * line.max()]
        half_tangent = (above.max() - above.min() + (place[1] - place[0])) / 2.0
        out.append(2.0 * half_tangent / (1.0 - half_tangent * half_tangent))
    return out


def checks(figure, renderer):
    """The tori against the models at every pixel, and the table's widths."""
    values = {**figure.values, **_MEASURED}
    scene = {name: values[name] for name in ("light", "tilt", "specular", "diffuse", "background")}
    truths = [_panel(_SIZE, model=model, **scene) for model in _models(values)]
    for on, bound, reason in (
        (
            Answer.IDEAL,
            0.01,
            "linear filtering of 256 x 256 texels and coordinates between 160 x 80 vertices",
        ),
        (Answer.MACHINE, 0.012, "bytes of D and of G, G's over two; F000-2's bound for tables of that size"),
    ):
        image = renderer.window(on, figure, _SIZE, **_MEASURED)
        panels = [image[:, k * _SIZE : (k + 1) * _SIZE, 0] for k in range(4)]
        for name, panel, (truth, covered) in zip(figure.panels[1:], panels[1:], truths, strict=True):
            error = (panel - truth[..., 0])[_eroded(covered)]
            yield Check(
                f"{name}: RMS from the model at every pixel",
                root_mean_square(error),
                at_most=bound,
                on=on,
                reason=reason,
            )
        for width, alpha, name in zip(
            _widths(panels[0]),
            (values["alpha_along"], values["alpha_across"]),
            ("along", "across"),
            strict=True,
        ):
            yield DATA.check(
                "D's half width at half height {name} the brushing over alpha sqrt(ln 2), off one",
                abs(width / (alpha * np.sqrt(np.log(2.0))) - 1.0),
                on,
                name=name,
            )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "light": word.POSITION((-1.4, 2.2, 3.2), "Where the light is; the torus's middle is the origin."),
        "alpha_along": word.of(word.ALPHA_KIND, 0.06, "Ward's roughness along the brushing."),
        "alpha_across": word.of(word.ALPHA_KIND, 0.8, "Ward's roughness across the brushing."),
        "exponent_along": word.NUMBER(
            500.0, "Ashikhmin and Shirley's exponent of facets leaning round the axis.", low=1.0, high=1000.0
        ),
        "exponent_across": word.NUMBER(
            3.0, "Ashikhmin and Shirley's exponent of facets leaning round the tube.", low=1.0, high=1000.0
        ),
        "specular": word.SPECULAR((0.80, 0.84, 0.88)),
        "diffuse": word.DIFFUSE((0.27, 0.28, 0.31)),
        "tilt": word.DEGREES(52.0, "How far the torus's axis leans towards the viewer."),
        "around": word.of(word.Whole(24, 400), 160, "Segments round the axis; half as many round the tube."),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(
        Method(
            "two tables in one pass",
            make_scene(2),
            ("GEFORCE_256", "MULTITEXTURE", "GEFORCE_3", "NV2A", "G400", "FUTURE"),
        ),
        Method(
            "two tables in two passes",
            make_scene(1),
            ("OPENGL_1_2", "OPENGL_1_2_IMAGING", "OCTANE", "INFINITE_REALITY", "TEXRAM"),
        ),
    ),
    acceptance=checks,
    reference=reference,
)
