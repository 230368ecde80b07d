"""K17: three reflectance models on the future board, and vectors that turn steadily over a coarse sphere."""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.acceptance import seen_places
from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.material_reference import least_share
from fixedpipe.effects.acceptance.measures import pixel_grid, root_mean_square
from fixedpipe.effects.acceptance.ray_caster import RayCaster, primary_rays
from fixedpipe.effects.bump_mapping import diffuse_bump
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import DARK, Figure, Method
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.matrices import rotate, rotation
from fixedpipe.effects.geometry.vectors import normalize
from fixedpipe.effects.geometry.views import BACKGROUND, Light, orthographic_view, panel_of, row_of_panels
from fixedpipe.effects.reflectance import brdfs, future_board, material_textures
from fixedpipe.effects.reflectance.material_textures import Brushing

DATA = figure_data(__file__, "K17")

MODELS = {
    "banks": future_board.banks,
    "blinn_phong": future_board.blinn_phong,
    "ward": future_board.ward,
}
TILT = 20.0
VIEWER = np.array([0.0, 0.0, 1.0])


def materials(
    map_size, depth, spread, k_s, alphas, exponents, squares, *, height_field=None, height_scale=0.0
):
    """The materials of the models' spheres, by the models' names in ``future_board``.

    ``alphas``: (alpha_x, alpha_y) of the Blinn-Phong model, then of Ward's. ``exponents``: the two exponents
    of the Blinn-Phong sphere's squares, ``squares`` of them along an edge. ``height_field``: replaces that
    sphere's pebbles.
    """
    s, t = height_fields.texel_centers(map_size, map_size)
    polished = (np.floor(s * squares) + np.floor(t * squares)) % 2.0 == 0.0
    if height_field is None:
        slopes = height_fields.pebble_slopes(map_size, 8, depth)
    else:
        slopes = height_field.slopes(map_size, height_scale, repeated=True)
    pebbles = material_textures.from_slopes(*slopes, *alphas[0], k_s[1])
    brushing = {"spread": spread, "depth": 0.5 * depth, "k_s": k_s}
    size = map_size, map_size, Brushing.ALONG_S
    return {
        "banks": material_textures.brushed(*size, alpha_x=1.0, alpha_y=1.0, **brushing),
        "blinn_phong": replace(pebbles, exponent=np.where(polished, exponents[1], exponents[0])),
        "ward": material_textures.brushed(*size, alpha_x=alphas[1][0], alpha_y=alphas[1][1], **brushing),
    }


def scene(
    profile, size, *, slices, stacks, coarse, turn, radius, light, repeats, map_size, depth, spread, k_s,
    alphas, exponents, squares, diffuse, ambient, specular, background, height_field, height_scale,
):  # fmt: skip
    """K17: a finely divided sphere in each model, then a coarse one twice: straight and steady vectors."""
    *model_panels, straight, steady = row_of_panels(len(MODELS) + 2, size)
    toward, surface = Light(light), surfaces.sphere(slices, stacks).with_repeats(*repeats)
    surface = surface.rotated(rotation("x", TILT))
    own = {"height_field": height_field, "height_scale": height_scale}
    made = materials(map_size, depth, spread, k_s, alphas, exponents, squares, **own)
    out = []
    for panel, (name, passes), color, bright in zip(
        model_panels, MODELS.items(), diffuse[:3], specular, strict=True
    ):
        view = orthographic_view(panel, half_height=1.0 / radius)
        loading, names = future_board.load(made[name], name, profile)
        lit = diffuse_bump.diffuse_pass(
            surface, names.normal, view, toward, profile, color=color, ambient=ambient
        )
        out += (
            panel.clear(background),
            *loading,
            *future_board.turned_steadily(lit),
            *passes(surface, names, view, toward, profile, specular=bright),
        )
    few = surfaces.sphere(*coarse).rotated(rotation("y", turn)).rotated(rotation("x", TILT))
    loading, names = material_textures.load(material_textures.isotropic(1, 1, 1.0), "smooth", profile)
    out += loading
    for panel, turns in ((straight, False), (steady, True)):
        view = orthographic_view(panel, half_height=1.0 / radius)
        passes = diffuse_bump.commands(
            few, names.normal, view, toward, profile, color=diffuse[-1], ambient=ambient
        )
        out += (panel.clear(background), *(future_board.turned_steadily(passes) if turns else passes))
    return tuple(out)


def _pixel_points(size, radius):
    """Points of the unit sphere under pixel centres, float64 [size, size, 3], and the square of their third
    coordinate, below zero beside the sphere.
    """
    x, y = pixel_grid(size, radius)
    z2 = 1.0 - x * x - y * y
    return np.stack([x, y, np.sqrt(np.maximum(z2, 0.0))], axis=-1), z2


def expected(name, size, parameters):
    """A model on the finely divided sphere of one material, per pixel, and the pixels that count. Those at
    the edge do not count, nor those within 25 degrees of a pole, where the frames turn within a triangle.

    Returns float64 and bool [size, size], bottom row first.
    """
    points, z2 = _pixel_points(size, parameters["radius"])
    back = rotation("x", -TILT)
    points, light, view = (
        rotate(back, v) for v in (points, normalize(np.array(parameters["light"])), VIEWER)
    )
    normals, tangents, binormals = surfaces.sphere_frames(
        np.arctan2(points[..., 0], points[..., 2]) / (2.0 * np.pi) + 0.5,
        np.arcsin(np.clip(points[..., 1], -1.0, 1.0)) / np.pi + 0.5,
    )
    blinn_phong, ward = parameters["alphas"]
    if name == "banks":
        value = brdfs.banks(light, view, normals, tangents)
    elif name == "ward":
        value = brdfs.ward(light, view, normals, tangents, binormals, *ward)
    else:
        half = brdfs.half_vector(light, view)
        value = brdfs.anisotropic_blinn_phong(
            half, tangents, binormals, *blinn_phong, 1.0, parameters["exponents"][0]
        )
        # The gate that the diffuse pass leaves.
        value = value * np.minimum(1.0, 4.0 * brdfs.lambert(normals, light))
    return np.minimum(value, 1.0), (z2 > 0.1) & (np.abs(points[..., 1]) < np.cos(np.radians(25.0)))


def _model(name, fields, seen, toward):
    """Of a model on a material's ``fields`` at the pixels: (n.l)+ and its highlight, float64 [n, 1] each.

    Source: Kautz, Seidel 2000, sections 3.1 to 3.3: Banks's model, the Blinn-Phong model and Ward's.
    """
    light, viewer = (seen.frames @ seen_places.unit(np.array(v, np.float64)) for v in (toward, VIEWER))
    n, t, b, k_s, alpha_x, alpha_y, exponent = (seen_places.looked_up(field, seen) for field in fields)

    def dot(a, c):
        return (a * c).sum(axis=-1)

    n_l, n_v = np.maximum(dot(n, light), 0.0), np.maximum(dot(n, viewer), 0.0)
    both = light + viewer
    if name == "banks":
        v_t, l_t = dot(t, viewer), dot(t, light)
        shine = n_l * np.maximum(np.sqrt((1.0 - v_t**2) * (1.0 - l_t**2)) - v_t * l_t, 0.0)
    elif name == "blinn_phong":
        half = seen_places.unit(both)
        lost = (dot(half, t) / alpha_x) ** 2 + (dot(half, b) / alpha_y) ** 2
        shine = np.sqrt(np.maximum(1.0 - lost, 0.0)) ** exponent * np.minimum(4.0 * n_l, 1.0)
    else:
        square = dot(both, both)
        lost = (dot(both, t) / alpha_x) ** 2 + (dot(both, b) / alpha_y) ** 2
        shine = np.exp(-2.0 * lost / (square + np.sqrt(square) * dot(both, n)))
        shine *= np.sqrt(n_l / np.maximum(n_v, 1.0e-9)) * (n_v > 0.0) / (4.0 * np.pi * alpha_x * alpha_y)
    return n_l[:, None], np.minimum(k_s * shine, 1.0)[:, None]


# Which of a material's fields a model reads, by their places in what ``_model`` takes: n, t, b, k_s, N.
_READ = {"banks": (0, 1, 3), "blinn_phong": (0, 1, 2, 6), "ward": (0, 1, 2, 3)}


def _fine_pictures(values, seen):
    """Of each model the displayed colours, then those with a field's mean in its place each: float64
    [1 + fields, n, 3].
    """
    own = {"height_field": values["height_field"], "height_scale": values["height_scale"]}
    names = "map_size", "depth", "spread", "k_s", "alphas", "exponents", "squares"
    made = materials(*(values[name] for name in names), **own)
    for name, color, bright in zip(MODELS, values["diffuse"], values["specular"], strict=False):
        m = made[name]
        fields = m.normals, m.tangents, m.binormals, m.k_s, m.alpha_x, m.alpha_y, m.exponent
        pictures = []
        for flat in (None, *_READ[name]):
            of = [
                np.broadcast_to(field.mean(axis=(0, 1)), field.shape) if k == flat else field
                for k, field in enumerate(fields)
            ]
            lit, shine = _model(name, of, seen, values["light"])
            colors = lit * np.array(color) + np.array(values["ambient"]) + shine * np.array(bright)
            pictures.append(np.clip(colors, 0.0, 1.0))
        yield np.stack(pictures)


def _coarse_pictures(values, size):
    """Where both coarse spheres are, bool [size, size], and their colours [n, 3]: of vectors that run
    straight between vertices, so that they are short there, and of vectors that stay as long.
    """
    few = (
        surfaces.sphere(*values["coarse"]).rotated(rotation("y", values["turn"])).rotated(rotation("x", TILT))
    )
    view = orthographic_view(row_of_panels(1, size)[0], half_height=1.0 / values["radius"])
    hits = RayCaster(few.positions[few.triangles]).nearest(*primary_rays(view), 1.0)
    found = hits.triangle >= 0
    corners, weights = few.triangles[hits.triangle[found]], hits.barycentrics[found][..., None]
    straight = (few.normals[corners] * weights).sum(axis=1)
    toward = seen_places.unit(np.array(values["light"]))
    half = seen_places.unit(toward + VIEWER)
    out = []
    for normals in (straight, seen_places.unit(straight)):
        lit, shine = (np.maximum(normals @ v, 0.0)[:, None] for v in (toward, half))
        colors = lit * np.array(values["diffuse"][-1]) + np.array(values["ambient"])
        out.append(np.clip(colors + shine**8 * np.minimum(4.0 * lit, 1.0), 0.0, 1.0))
    return found.reshape(size, size), np.stack(out)


def _displayed_checks(figure, renderer):
    """The displayed spheres by their models in float64, beside those with one field's mean in its place."""
    size, values = figure.size, figure.values
    seen = seen_places.sphere(size, values["radius"], (("x", TILT),), 65.0, values["repeats"])
    fine = list(_fine_pictures(values, seen))
    round_, coarse = _coarse_pictures(values, size)
    for on in Answer:
        window = np.clip(renderer.window(on, figure, size), 0.0, 1.0)
        shares = [
            least_share(
                panel_of(window, k)[seen.where], *of, *(other[0] for other in fine if other is not of)
            )
            for k, of in enumerate(fine)
        ]
        shares += [
            least_share(panel_of(window, 3 + k)[round_], coarse[k], coarse[1 - k], 0.0 * coarse[k])
            for k in (0, 1)
        ]
        yield DATA.check(
            "of what a material's fields and turning vectors change, the least share that is seen",
            min(shares),
            on,
        )


def checks(figure, renderer):
    """Each model against its equation, and the coarse spheres' highlights against a round sphere's."""
    yield from _displayed_checks(figure, renderer)
    size = 128
    plain = {"depth": 0.0, "spread": 0.0, "k_s": (1.0, 1.0), "exponents": (30.0, 30.0)}
    parameters = {**figure.values, **plain}
    half = brdfs.half_vector(normalize(np.array(parameters["light"])), VIEWER)
    points, z2 = _pixel_points(size, parameters["radius"])
    round_one, inside = brdfs.blinn_phong(points, half, 8.0), z2 > 0.5
    bounds = {
        Answer.IDEAL: (
            {"banks": 0.004, "blinn_phong": 0.004, "ward": 0.004},
            "frames turn by 7 degrees from vertex to vertex; measured, with a third of slack",
        ),
        Answer.MACHINE: (
            {"banks": 0.004, "blinn_phong": 0.019, "ward": 0.009},
            "that, and bytes in the textures, whose errors the exponent of 30 multiplies; measured, with a "
            "third of slack",
        ),
    }
    for on in Answer:
        peaks, errors = ([], []), ([], [])
        for turn in (0.0, 22.5):
            image = renderer.window(on, figure, size, **_WHITE, **plain, turn=turn)[..., 0]
            panels = [np.clip(image[:, k * size : (k + 1) * size], 0.0, 1.0) for k in range(5)]
            for panel, peak, error in zip(panels[3:], peaks, errors, strict=True):
                peak.append(float(panel.max()))
                error.append(root_mean_square((panel - round_one)[inside]))
        for name, panel in zip(MODELS, panels[:3], strict=True):
            true, counts = expected(name, size, parameters)
            error = root_mean_square((panel - true)[counts])
            of, why = bounds[on]
            yield Check(f"RMS of the pass - the model, {name}", error, at_most=of[name], on=on, reason=why)
        yield DATA.check(
            "faintest peak of a highlight of one as the coarse sphere turns, straight vectors",
            min(peaks[0]),
            on,
        )
        yield DATA.check(
            "faintest peak of a highlight of one as the coarse sphere turns, steady vectors",
            min(peaks[1]),
            on,
        )
        yield DATA.check(
            "RMS against a round sphere's highlight, steady vectors / straight vectors",
            max(errors[1]) / min(errors[0]),
            on,
        )


# A light alone, for each sphere.
_WHITE = {**DARK, "diffuse": ((0.0, 0.0, 0.0),) * 4, "specular": ((1.0, 1.0, 1.0),) * 3}

FIGURE = Figure(
    **DATA.words,
    size=384,
    parameters={
        "slices": word.SLICES(50),
        "stacks": word.STACKS(26),
        "coarse": word.of(
            word.Several((word.Whole(3, 256), word.Whole(2, 128))),
            (8, 6),
            "Segments of the coarse spheres around their axis, and from pole to pole.",
        ),
        "turn": word.DEGREES(12.0, "How far the coarse spheres are turned about their axis."),
        "radius": word.RADIUS(0.92),
        "light": word.LIGHT((0.45, 0.5, 0.74)),
        "repeats": word.REPEATS((4, 2)),
        "map_size": word.TEXELS(128),
        "depth": word.SLOPE(
            0.2,
            "The height of the second sphere's pebbles over half balls; the strokes' slope is half as large.",
        ),
        "spread": word.SPREAD(6.0),
        "k_s": word.K_S((0.6, 1.0)),
        "alphas": word.of(
            word.Several((word.Several((word.Number(0.125, 1.0),) * 2),) * 2),
            ((0.8, 1.0), (0.2, 0.5)),
            "The highlight's widths along t and b of Blinn and Phong's sphere, then of Ward's.",
        ),
        "exponents": word.of(
            word.Several((word.EXPONENT_KIND,) * 2),
            (6.0, 100.0),
            "The exponents of the two kinds of squares of Blinn and Phong's sphere.",
        ),
        "squares": word.COUNT(4, "Squares of either exponent along an edge of the texture."),
        "diffuse": word.of(
            word.Several((word.COLOR_KIND,) * 4),
            ((0.08, 0.16, 0.30), (0.30, 0.10, 0.08), (0.34, 0.22, 0.07), (0.12, 0.28, 0.16)),
            "The colours of the scattered light, of each model's sphere, then of the coarse ones.",
            word.FULL,
        ),
        "ambient": word.AMBIENT((0.03, 0.03, 0.035)),
        "specular": word.of(
            word.Several((word.COLOR_KIND,) * 3),
            ((0.62, 0.72, 0.85), (0.9, 0.85, 0.8), (0.9, 0.7, 0.4)),
            "The colours of the highlights, of Banks's, Blinn and Phong's and Ward's sphere.",
            word.FULL,
        ),
        "background": word.BACKDROP(BACKGROUND),
        "height_field": own_maps.height_field("the second sphere's pebbles"),
        "height_scale": own_maps.HEIGHT_SCALE(0.03),
    },
    methods=(Method("functions in the combiners", scene, ("FUTURE",)),),
    acceptance=checks,
)
