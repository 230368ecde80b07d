"""S13: a ribbed horn in its natural frame, vectors straight from corner to corner, and lengths apart."""

from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.bump_mapping import blinn, normalization_cube_map, offset_vector_passes, offset_vectors
from fixedpipe.effects.bump_mapping.offset_vector_passes import Lighting
from fixedpipe.effects.bump_mapping.offset_vectors import Frame
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry import height_fields
from fixedpipe.effects.geometry.vectors import cosine, dot, normalize
from fixedpipe.effects.geometry.views import BACKGROUND, orthographic_view, panel_of, row_of_panels
from fixedpipe.effects.scenes.bumped_patches import corners_of_grid, horn
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import IDEAL

DATA = figure_data(__file__, "S13")

_MAP, _CUBE = 64, 128
_MAP_NAME = "ribs"
_HALF_HEIGHT, _CENTER = 0.8, (0.2, -0.24, 0.0)


@lru_cache(4)
def derivatives(height, own, own_scale):
    """(f_u, f_v) of one rib, or of a user's heights: float64 [_MAP, _MAP, 2]."""
    if own is not None:
        return offset_vectors.of_heights(own.fitted(_MAP, _MAP, own_scale, repeated=True))
    s, t = height_fields.texel_centers(_MAP, _MAP)
    rib = 0.5 - 0.5 * cosine(2.0 * np.pi * s)
    return offset_vectors.of_heights(height * rib * rib * (0.8 - 0.2 * cosine(4.0 * np.pi * t)))


def _parts(size):
    """Into how many parts a cell's edge is divided, on panels of ``size`` pixels."""
    return max(2, min(16, size // 24))


def _winding(p):
    return {name: p[name] for name in ("turn", "taper", "width")}


def _placed(patch):
    return patch.surface.moved(*(-c for c in _CENTER))


def interpolated(size, p):
    """The fine surface; its frame with the corners' vectors interpolated straight; the frame with lengths
    apart; its directions alone; and the lengths of s_u and s_v over the normal's.
    """
    columns, rows = p["corners"]
    divided, repeats = _parts(size), (p["ribs"], 1)
    fine = horn(columns * divided, rows * divided, **_winding(p)).with_repeats(*repeats)
    coarse = horn(columns, rows, **_winding(p)).with_repeats(*repeats)
    own, at = offset_vectors.natural(coarse.p_u, coarse.p_v), corners_of_grid(columns, rows, divided)
    named = {name: getattr(own, name)[at.numbers] for name in ("normal", "first", "second")}
    straight = Frame(**{k: offset_vectors.straight(v, at.weights) for k, v in named.items()})
    apart = Frame(**{k: offset_vectors.apart(v, at.weights) for k, v in named.items()})
    toward = Frame(**{k: offset_vectors.straight(normalize(v), at.weights) for k, v in named.items()})
    normal, *lengths = (np.sqrt(dot(v, v)) for v in (apart.normal, apart.first, apart.second))
    sizes = np.stack([length / normal for length in lengths], axis=-1)
    return _placed(fine), straight, apart, toward, sizes


def in_float(size, p):
    """The light of the exact frame at texels over the whole horn: RGB [rows, columns, 3]."""
    edge = max(32, 1 << (size - 1).bit_length())
    columns, rows = 2 * edge, edge // 2
    # Vertices of a grid twice as fine: every second, from the first, is a texel's centre.
    patch = horn(2 * columns, 2 * rows, **_winding(p)).with_repeats(p["ribs"], 1)
    grid = (2 * rows + 1, 2 * columns + 1)
    p_u, p_v, st = (
        a.reshape(*grid, -1)[1::2, 1::2] for a in (patch.p_u, patch.p_v, patch.surface.texture_coordinates)
    )
    f = derivatives(p["height"], p["height_field"], p["height_scale"])
    f = np.stack([blinn.interpolated(f[..., k], st[..., 0], st[..., 1]) for k in range(2)], axis=-1)
    return _lighting(p).radiance(normalize(offset_vectors.bumped(offset_vectors.natural(p_u, p_v), f)))


def _lighting(p):
    return Lighting(**{name: p[name] for name in ("light", "color", "ambient", "specular", "exponent")})


def _float_panel(profile, size, view, p):
    columns, rows = (count * _parts(size) for count in p["corners"])
    surface = _placed(horn(columns, rows, **_winding(p)))
    return offset_vector_passes.shown_light(surface, in_float(size, p), profile, view, "light in float")


def scene_by(combiners):
    """The scene on machines whose combiners have roots and quotients, or on those without."""

    def scene(profile, size, *, background, **p):
        panels = row_of_panels(3, size)
        views = [orthographic_view(panel, _HALF_HEIGHT) for panel in panels]
        surface, straight, apart, toward, sizes = interpolated(size, p)
        f = derivatives(p["height"], p["height_field"], p["height_scale"])
        scale = offset_vectors.largest(f)
        out = [
            *(panel.clear(background) for panel in panels),
            offset_vector_passes.load_light(_CUBE, profile, _lighting(p)),
            offset_vector_passes.load_signed(f, scale, _MAP_NAME, profile),
            *offset_vector_passes.dot_product_pass(surface, straight, _MAP_NAME, scale, views[0]),
        ]
        if combiners:
            biased = f"{_MAP_NAME} for combiners"
            out += [
                normalization_cube_map.load(_CUBE, profile),
                offset_vector_passes.load_biased(f, scale, biased, profile),
                *offset_vector_passes.natural_pass(surface, toward, sizes, biased, scale, views[1], profile),
            ]
        else:
            out += offset_vector_passes.dot_product_pass(surface, apart, _MAP_NAME, scale, views[1])
        return (*out, *_float_panel(profile, size, views[2], p))

    return scene


def reference(size, *, background, **p):
    """The exact frame at every texel on a fine horn, which both ways between corners approximate."""
    (panel,) = row_of_panels(1, size)
    view = orthographic_view(panel, _HALF_HEIGHT)
    drawn = (panel.clear(background), *_float_panel(IDEAL, size, view, p))
    picture = execute_ideal(drawn, size, size).color[..., :3]
    out = np.ones((size, 3 * size, 4))
    out[..., :3] = np.tile(picture, (1, 3, 1))
    return out


# ---------------------------------------------------------------------------------------------- checks


def _displaced(p, u, v, step):
    """Normals of the horn's points, displaced by its ribs, by differences ``step`` apart: float64 [n, 3]."""

    def points(u, v):
        # Of a horn of one cell the corners are these points; its own sizes and sines, unrounded.
        radians = np.radians(p["turn"])
        size = np.exp(np.log(p["taper"]) * p["turn"] / 360.0 * u)
        tube, angle, across = 0.5 * p["width"], radians * u - 0.5 * np.pi, np.pi * v
        away, up = (1.0 - tube) + tube * np.cos(across), tube * np.sin(across)
        return size[:, None] * np.stack([away * np.cos(angle), away * np.sin(angle), up], axis=-1)

    def normals(du, dv):
        along = (points(u + du + step, v + dv) - points(u + du - step, v + dv)) / (2.0 * step)
        aside = (points(u + du, v + dv + step) - points(u + du, v + dv - step)) / (2.0 * step)
        return normalize(np.cross(along, aside))

    def raised(du, dv):
        s, t = (u + du) * p["ribs"], v + dv
        rib = 0.5 - 0.5 * np.cos(2.0 * np.pi * s)
        height = p["height"] * rib * rib * (0.8 - 0.2 * np.cos(4.0 * np.pi * t))
        return points(u + du, v + dv) + height[:, None] * normals(du, dv)

    return normalize(np.cross(raised(step, 0.0) - raised(-step, 0.0), raised(0.0, step) - raised(0.0, -step)))


def _exact(p, columns=240, rows=12):
    """Coordinates u and v of a grid's vertices, their bumped normals, and the Patch."""
    patch = horn(columns, rows, **_winding(p)).with_repeats(p["ribs"], 1)
    st = patch.surface.texture_coordinates
    s, t = 2.0 * np.pi * st[:, 0], 4.0 * np.pi * st[:, 1]
    rib, high = 0.5 - 0.5 * np.cos(s), 0.8 - 0.2 * np.cos(t)
    f = p["height"] * np.stack(
        [2.0 * np.pi * rib * np.sin(s) * high, 0.8 * np.pi * rib * rib * np.sin(t)], axis=-1
    )
    bumped = offset_vectors.bumped(offset_vectors.natural(patch.p_u, patch.p_v), f)
    return st / np.array([p["ribs"], 1.0]), bumped, patch


def _heights(p, per_rib=48):
    """How high each rib rises in the horn's middle, by adding its slopes up: float64 [ribs]."""
    at, bumped, patch = _exact(p, p["ribs"] * per_rib, 2)
    middle = at[:, 1] == 0.5
    normals, bumped, p_u = patch.surface.normals[middle], bumped[middle], patch.p_u[middle]
    # A step along u rises by what keeps it at right angles to the bumped normal.
    rise = -dot(bumped, p_u) / dot(bumped, normals)
    steps = 0.5 * (rise[1:] + rise[:-1]) / per_rib
    return np.cumsum(steps.reshape(p["ribs"], per_rib), axis=1).max(axis=1)


def checks(figure, renderer):
    """Blinn's surface by differences, heights that stay, and both ways between corners against the truth."""
    p = dict(figure.values)
    at, bumped, _ = _exact(p)
    inner = (at[:, 0] > 0.02) & (at[:, 0] < 0.98) & (at[:, 1] > 0.02) & (at[:, 1] < 0.98)
    truth = _displaced(p, at[inner, 0], at[inner, 1], 1e-4)
    lean = np.degrees(np.arccos(np.clip(dot(normalize(bumped[inner]), truth), -1.0, 1.0)))
    yield DATA.check(
        "angle of n' from the displaced horn's normal by differences, RMS in degrees",
        root_mean_square(lean),
        Answer.IDEAL,
    )
    heights = _heights(p)
    yield DATA.check(
        "height of the lowest rib over the highest's, by adding slopes up",
        float(heights.min() / heights.max()),
        Answer.IDEAL,
    )
    size, black = figure.size // 2, {"background": (0.0, 0.0, 0.0)}
    for on in Answer:
        window = np.clip(renderer.window(on, figure, size, **black), 0.0, 1.0)
        straight, apart, truth = (panel_of(window, k) for k in range(3))
        shown = truth.max(axis=-1) > 0.0
        errors = [root_mean_square((panel - truth)[shown]) for panel in (straight, apart)]
        yield DATA.check("RMS from the light in float, lengths apart", errors[1], on)
        yield DATA.check("RMS, lengths apart / vectors as they are", errors[1] / errors[0], on)


FIGURE = Figure(
    **DATA.words,
    parameters={
        "corners": word.of(
            word.Several((word.Whole(1, 64), word.Whole(1, 32))),
            (4, 3),
            "Cells of the grid whose corners have vectors, along the horn and across it.",
        ),
        "turn": word.DEGREES(
            330.0, "How far the horn winds, from its mouth to its tip.", low=30.0, high=720.0
        ),
        "taper": word.NUMBER(0.13, "How many times as large the horn is a turn later.", low=0.05, high=1.0),
        "width": word.NUMBER(0.74, "The mouth's diameter, of its reach from the axis.", low=0.05, high=0.95),
        "ribs": word.COUNT(20, "How often the bump map repeats along the horn."),
        "height": word.NUMBER(
            0.02, "How high the ribs stand, the same everywhere.", "world units", low=0.0, high=1.0
        ),
        "light": word.LIGHT((-0.3, 0.45, 0.84)),
        "color": word.DIFFUSE((0.80, 0.62, 0.42)),
        "ambient": word.AMBIENT((0.07, 0.06, 0.07)),
        "specular": word.NUMBER(0.45, "The highlight's strength, k_s.", low=0.0, high=1.0),
        "exponent": word.of(word.Whole(1, 128), 24, "The highlight's exponent."),
        "background": word.BACKDROP(BACKGROUND),
        "height_field": own_maps.height_field("a rib"),
        "height_scale": own_maps.HEIGHT_SCALE(0.03),
    },
    methods=(
        Method("dot products of texture shaders", scene_by(False), ("GEFORCE_3", "NV2A")),
        Method("roots and quotients in the combiners", scene_by(True), ("FUTURE",)),
    ),
    acceptance=checks,
    reference=reference,
)
