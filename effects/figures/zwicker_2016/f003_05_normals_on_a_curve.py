"""F003-5: the normals of a bump map are relative to a curved surface's tangents and normals."""

import math

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import POWER_8, arithmetic_check, root_mean_square
from fixedpipe.effects.bump_mapping import diffuse_bump, tangent_space
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.diagrams.checks import drawn_check
from fixedpipe.effects.diagrams.drawing import BLUE, FAINT, GREEN, INK, RED, VIOLET, YELLOW
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.zwicker_2016.shared.bumps import load_normals, slices, texels
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.vectors import cosine, dot, from_frame, normalize, sine
from fixedpipe.effects.geometry.views import BACKGROUND, Light, panel_of, perspective_view, row_of_panels

DATA = figure_data(__file__, "F003-5")

NORMALS = "normal map of studs"
# Studs round the half cylinder and along it, and the samples of one row of them that are drawn.
REPEATS, SAMPLES = (3, 2), 15
RADIUS, HEIGHT = 1.0, 2.2
RIM = 0.62
# How long a normal is drawn, in units of the row and of the cylinder's radius.
ARROW, LONGER = 0.13, 0.30


def half_cylinder(columns):
    """The front half of a cylinder about the y axis; tangents from its texture coordinates (Z03, Z04)."""
    flat = surfaces.plane(columns, 4)
    s, t = flat.texture_coordinates.T
    angle = math.pi * (s - 0.5)
    normals = np.stack([sine(angle), 0.0 * s, cosine(angle)], axis=-1)
    positions = RADIUS * normals + np.stack([0.0 * s, HEIGHT * (t - 0.5), 0.0 * s], axis=-1)
    surface = surfaces.Surface(
        positions, normals, flat.tangents, flat.binormals, flat.texture_coordinates, flat.triangles
    )
    return tangent_space.with_tangents(surface.with_repeats(*REPEATS))


def _row():
    """The drawn samples: (s in [0, 1], normals in tangent space, heights in the map's unit)."""
    s = (np.arange(SAMPLES) + 0.5) / SAMPLES
    u = REPEATS[0] * s
    normals = height_fields.frames(*height_fields.dome_slopes(u, np.full(SAMPLES, 0.5), RIM))[0]
    return s, normals, _cap(u)


def _cap(u):
    """The studs' height over u along the row's middle, in units of the map's edge."""
    x = (u - np.floor(u)) * 2.0 - 1.0
    square = np.maximum(RIM * RIM - x * x, 0.0)
    # The cap's sphere has radius sqrt(2) RIM and its middle lies RIM below the plane.
    return 0.5 * np.where(square > 0.0, np.sqrt(RIM * RIM + square) - RIM, 0.0)


def _frames(s):
    """(position on the cylinder, t, b, n) at s along the row: float64 [k, 3] each."""
    angle = math.pi * (s - 0.5)
    zero = 0.0 * s
    n = np.stack([sine(angle), zero, cosine(angle)], axis=-1)
    t = np.stack([cosine(angle), zero, -sine(angle)], axis=-1)
    b = np.stack([zero, zero + 1.0, zero], axis=-1)
    middle = HEIGHT * (0.5 / REPEATS[1] - 0.5)
    return RADIUS * n + np.array([0.0, middle, 0.0]), t, b, n


def _views(size):
    first, second, third = row_of_panels(3, size)
    solid = [
        perspective_view(panel, (0.5, 2.7, 4.3), center=(0.0, -0.12, 0.25), field_of_view=33.0, radius=2.2)
        for panel in (second, third)
    ]
    return drawing.sheet(first, half_height=0.56, center=(0.5, -0.03)), *solid


def _tangent_space(view):
    s, normals, _ = _row()
    u = np.arange(193) / 192.0
    edge = 1.0 / REPEATS[0]  # of the map, in units of the drawn row
    profile = np.stack([u, edge * _cap(REPEATS[0] * u)], axis=-1)
    feet = np.stack([s, 0.0 * s], axis=-1)
    tips = feet + ARROW * normals[:, [0, 2]]
    return [
        drawing.stroke("the displaced surface", view, profile, BLUE, dash=drawing.DASH),
        drawing.stroke("the surface", view, ((0.0, 0.0), (1.0, 0.0)), INK),
        *(
            drawing.arrow("a normal of the map", view, ends, YELLOW, head=5.0)
            for ends in np.stack([feet, tips], axis=1)
        ),
        drawing.arrow("t", view, ((0.0, -0.25), (0.25, -0.25)), RED, width=2.0),
        drawing.arrow("n", view, ((0.0, -0.25), (0.0, 0.0)), VIOLET, width=2.0),
        drawing.text("t", view, (0.25, -0.25), RED, align=(-1, 0), offset=(5.0, 0.0)),
        drawing.text("n", view, (0.0, -0.02), VIOLET, align=(-1, 1), offset=(6.0, 0.0)),
        drawing.text("tangent space", drawing.sheet(view.panel), (0.0, 0.92), INK),
    ]


def _object_space(view):
    s, normals, _ = _row()
    feet, t, b, n = _frames(s)
    tips = feet + LONGER * from_frame(normals, t, b, n)
    u = np.arange(193) / 192.0
    base, _, _, outward = _frames(u)
    edge = math.pi * RADIUS / REPEATS[0]
    profile = base + (edge * _cap(REPEATS[0] * u))[:, None] * outward
    rims = [base + np.array([0.0, y - base[0, 1], 0.0]) for y in (-0.5 * HEIGHT, 0.5 * HEIGHT)]
    sides = [np.array([rims[0][k], rims[1][k]]) for k in (0, -1)]
    body = [np.array([rims[0][k], rims[0][k + 8], rims[1][k + 8], rims[1][k]]) for k in range(0, 192, 8)]
    drawn = [drawing.polygons("the cylinder", view, body, (0.13, 0.15, 0.20))]
    drawn.append(drawing.strokes("its outline", view, [*rims, *sides], FAINT))
    drawn += [
        drawing.stroke("the surface", view, base, INK),
        drawing.stroke("the displaced surface", view, profile, BLUE, dash=drawing.DASH),
    ]
    drawn += [
        drawing.arrow("the same normal", view, ends, YELLOW, head=5.0)
        for ends in np.stack([feet, tips], axis=1)
    ]
    for place in (0.32, 0.72):
        foot, *axes = (axis[0] for axis in _frames(np.array([place])))
        foot = foot + np.array([0.0, 0.95, 0.0])
        for name, axis, color in zip("tbn", axes, (RED, GREEN, VIOLET), strict=True):
            drawn.append(drawing.arrow(name, view, (foot, foot + 0.42 * axis), color, width=2.0))
            drawn.append(drawing.text(name, view, foot + 0.53 * axis, color, outline=BACKGROUND))
    return [*drawn, drawing.text("on a cylinder", drawing.sheet(view.panel), (0.0, 0.92), INK)]


def scene(profile, size, *, light, diffuse, ambient, background):
    """F003-5: a row of the map's normals in tangent space, on a cylinder, and the map lit on it."""
    edge = texels(size, 128)
    s, t = height_fields.texel_centers(edge, edge)
    normals = height_fields.frames(*height_fields.dome_slopes(s, t, RIM))[0]
    flat, drawn, lit = _views(size)
    surface = half_cylinder(slices(size))
    return (
        drawing.load_font(),
        load_normals(normals, NORMALS, profile),
        flat.panel.clear(background),
        *_tangent_space(flat),
        drawn.panel.clear(background),
        *_object_space(drawn),
        lit.panel.clear(background),
        *diffuse_bump.commands(surface, NORMALS, lit, Light(light), profile, color=diffuse, ambient=ambient),
        drawing.text("lit", drawing.sheet(lit.panel), (0.0, 0.92), INK),
    )


def _expected(figure, view):
    """(points on the cylinder [k, 3], what is seen there [k, 3]) by the equations: the studs' slopes carried
    to the curved surface, (n.l)+ and (n.h)^8.
    """
    u, v = (a.ravel() for a in np.meshgrid(np.linspace(0.35, 2.65, 24), np.linspace(0.1, 1.9, 19)))
    slopes = height_fields.dome_slopes(u, v, RIM)
    x, y = 2.0 * (u - np.floor(u)) - 1.0, 2.0 * (v - np.floor(v)) - 1.0
    # Beside the rims, across which the slope jumps.
    kept = np.abs(np.hypot(x, y) - RIM) > 0.08
    angle, slope_u, slope_v = math.pi * (u / REPEATS[0] - 0.5), *slopes
    outward = np.stack([np.sin(angle), 0.0 * u, np.cos(angle)], axis=-1)
    around = np.stack([np.cos(angle), 0.0 * u, -np.sin(angle)], axis=-1)
    normals = normalize(outward - slope_u[:, None] * around - slope_v[:, None] * np.array([0.0, 1.0, 0.0]))
    points = RADIUS * outward + np.stack([0.0 * u, HEIGHT * (v / REPEATS[1] - 0.5), 0.0 * u], axis=-1)
    light = normalize(np.array(figure.values["light"]))
    to_eye = normalize(np.array(view.eye) - points)
    lit = np.maximum(dot(normals, light), 0.0)
    shine = np.minimum(4.0 * lit, 1.0) * np.maximum(dot(normals, normalize(light + to_eye)), 0.0) ** 8
    colors = lit[:, None] * np.array(figure.values["diffuse"]) + np.array(figure.values["ambient"])
    kept &= dot(outward, to_eye) > 0.2
    return points[kept], np.clip(colors + shine[:, None], 0.0, 1.0)[kept]


def checks(figure, renderer):
    """That normals keep their place in the local frame and not in the world, and the marks."""
    s, normals, _ = _row()
    feet, t, b, n = _frames(s)
    world = from_frame(normals, t, b, n)
    lean = np.abs(dot(world, n) - normals[:, 2]).max()
    # Samples that lie one stud apart have the same normal in the map.
    apart = SAMPLES // REPEATS[0]
    cosines = dot(world[apart:], world[:-apart])
    turned = np.abs(np.degrees(np.arccos(np.clip(cosines, -1.0, 1.0))) - 180.0 / REPEATS[0]).max()
    surface = half_cylinder(96)
    angle = math.pi * (surface.texture_coordinates[:, 0] / REPEATS[0] - 0.5)
    around = np.stack([np.cos(angle), 0.0 * angle, -np.sin(angle)], axis=-1)
    flat, solid, _ = _views(figure.size // 2)
    ends = [(feet[k] + 0.5 * LONGER * world[k], k) for k in (5, 9)]
    marks = [(1, solid, point, YELLOW) for point, _ in ends]
    marks += [
        (0, flat, (s[k] + 0.5 * ARROW * normals[k, 0], 0.5 * ARROW * normals[k, 2]), YELLOW) for _, k in ends
    ]
    ahead, behind = (_frames(s + step)[0] for step in (2.0**-8, -(2.0**-8)))
    along = normalize(ahead - behind)
    size = 192
    lit = _views(size)[2]
    points, wanted = _expected(figure, lit)
    x, y = np.floor(drawing.project(lit, points)[:, :2]).astype(int).T
    seen = panel_of(renderer.machine_window(figure, size), 2)[y, x]
    return (
        DATA.check(
            "cosine to the surface's normal - that of the map's normal, largest", float(lean), Answer.IDEAL
        ),
        DATA.check("turn from one stud to the next - 60 degrees, largest", float(turned), Answer.IDEAL),
        DATA.check(
            "tangents from the texture coordinates . the circle's, smallest",
            float(dot(surface.tangents, around).min()),
            Answer.IDEAL,
        ),
        *drawn_check(figure, renderer, marks),
        DATA.check(
            "t - differences of the row's places, largest", float(np.abs(along - t).max()), Answer.IDEAL
        ),
        DATA.check("b - n x t, largest", float(np.abs(np.cross(n, t) - b).max()), Answer.IDEAL),
        DATA.check(
            "{n} places of the lit studs - the equations, RMS",
            root_mean_square(seen - wanted),
            Answer.MACHINE,
            n=len(wanted),
        ),
        arithmetic_check(figure, renderer, 0.003, POWER_8),
    )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "light": word.LIGHT((-0.5, 0.62, 0.6)),
        "diffuse": word.DIFFUSE((0.34, 0.42, 0.55)),
        "ambient": word.AMBIENT((0.05, 0.06, 0.08)),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("diagram, and register combiners", scene, ("GEFORCE_256", "GEFORCE_3")),),
    acceptance=checks,
)
