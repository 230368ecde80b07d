"""Z27: what bump mapping makes of triangles without area in texture space, mirrored and stretched ones."""

from dataclasses import replace
from itertools import pairwise

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import POWER_8, arithmetic_check
from fixedpipe.effects.bump_mapping import diffuse_bump, tangent_space
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.diagrams.drawing import INK, RED, VIOLET, YELLOW
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.zwicker_2016.shared.bumps import load_normals, texels
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.vectors import dot
from fixedpipe.effects.geometry.views import BACKGROUND, Light, orthographic_view, panel_of, row_of_panels

DATA = figure_data(__file__, "Z27")

NORMALS = "normal map of studs"
# Rows of the mesh from the highest down: what is wrong with each one's right half.
ROWS = ("good", "mirrored", "without area", "stretched")
COLORS = {"good": (0.30, 0.34, 0.40), "mirrored": VIOLET, "without area": RED, "stretched": YELLOW}
# Halves are three studs long: 0.9 over the rows' height of 0.3.
HALF, GAP, CELLS = 0.9, 0.075, 4


def strip(kind, low, high):
    """A row of the mesh, from y = ``low`` to ``high``: its left half good, its right half as ``kind`` says.

    Studs are as wide as high where nothing is wrong.
    """
    flat = surfaces.plane(2 * CELLS, 1, HALF, (high - low) / 2.0)
    x, y = flat.positions[:, 0], flat.positions[:, 1]
    wide = high - low
    u, v = (x + HALF) / wide, (y + (high - low) / 2.0) / wide
    middle = HALF / wide
    right = {
        "good": u,
        "mirrored": 2.0 * middle - u,
        "without area": middle + 0.0 * u,
        "stretched": middle + (u - middle) / 4.0,
    }[kind]
    coordinates = np.stack([np.where(u > middle, right, u), v], axis=-1)
    moved = flat.positions + np.array([0.0, (low + high) / 2.0, 0.0])
    if kind == "without area":
        # Half a stud on, so that what is smeared is the middle of one.
        coordinates = coordinates + np.array([0.5, 0.0])
    return replace(flat, positions=moved, texture_coordinates=coordinates)


def heights():
    """The rows' (lowest, highest) y."""
    edges = np.linspace(-HALF, HALF, len(ROWS) + 1)
    return [(low + GAP, high - GAP) for low, high in pairwise(edges)][::-1]


def the_mesh():
    """All rows, with the tangents that a mesh without any trouble would have: along x."""
    return surfaces.joined(*(strip(kind, *ends) for kind, ends in zip(ROWS, heights(), strict=True)))


def flagged(surface, report):
    """The triangles' colours, float64 [k, 3], by the class that was found."""
    colors = np.tile(np.array(COLORS["good"]), (len(surface.triangles), 1))
    for kind, found in (
        ("stretched", report.stretched),
        ("mirrored", report.mirrored),
        ("without area", report.zero_area),
    ):
        colors[found] = COLORS[kind]
    return colors


def scene(profile, size, *, light, diffuse, ambient, background, handled):
    """Z27: tangents along x everywhere; the problems found; tangents from the texture coordinates.

    ``handled``: how to handle triangles without area and mirrored ones (``tangent_space.with_tangents``).
    """
    edge = texels(size, 128)
    s, t = height_fields.texel_centers(edge, edge)
    normals = height_fields.frames(*height_fields.dome_slopes(s, t))[0]
    surface = the_mesh()
    report = tangent_space.examine_surface(surface)
    naive, shown, right = row_of_panels(3, size)
    lit = {"color": diffuse, "ambient": ambient}
    sheet = drawing.sheet(shown)
    titles = zip((naive, shown, right), ("one tangent for all", "found", "from the coordinates"), strict=True)
    labels = [
        drawing.text(kind, sheet, (-0.5 * HALF, sum(ends) / 2.0), INK)
        for kind, ends in zip(("good", "mirrored", "no area", "stretched 4x"), heights(), strict=True)
    ]
    return (
        drawing.load_font(),
        load_normals(normals, NORMALS, profile),
        naive.clear(background),
        *diffuse_bump.commands(surface, NORMALS, orthographic_view(naive), Light(light), profile, **lit),
        shown.clear(background),
        *(
            drawing.polygons(f"triangles in the colour {k}", sheet, corners, color)
            for k, (corners, color) in enumerate(_by_color(surface, flagged(surface, report)))
        ),
        drawing.strokes(
            "edges",
            sheet,
            [surface.positions[f][[0, 1, 2, 0]] for f in surface.triangles],
            BACKGROUND,
            width=0.6,
        ),
        *labels,
        right.clear(background),
        *diffuse_bump.commands(
            tangent_space.with_tangents(surface, *handled),
            NORMALS,
            orthographic_view(right),
            Light(light),
            profile,
            **lit,
        ),
        *(drawing.text(words, drawing.sheet(panel), (0.0, 0.95), INK) for panel, words in titles),
    )


def _by_color(surface, colors):
    """(corners [k, 3, 3], colour) for each colour that triangles have."""
    points = surface.positions[surface.triangles]
    for color in np.unique(colors, axis=0):
        yield points[(colors == color).all(axis=1)], tuple(color.tolist())


def _half(image, row, side):
    """The pixels of a row's left (-1) or right (1) half, its edges left out."""
    size = image.shape[0]
    low, high = ((y + s * 0.02 + 1.0) / 2.0 * size for y, s in zip(heights()[row], (1, -1), strict=True))
    left, right = ((-HALF + 0.02, -0.02), (0.02, HALF - 0.02))[(side + 1) // 2]
    columns = [int((x + 1.0) / 2.0 * size) for x in (left, right)]
    return image[int(low) : int(high), columns[0] : columns[1]]


def _leaning(image, axis):
    """From where studs seem lit, in [-1, 1]: whether brightness grows (1) or falls (-1) along rows of pixels
    (``axis`` 1) or columns (0) where it changes much. ``image``: a half row.
    """
    change = np.diff(image.mean(axis=-1), axis=axis)
    cubes = (change * change * change)[np.abs(change) > 0.02]
    return float(cubes.sum() / np.abs(cubes).sum())


def _alike(image, row):
    """How alike the two halves of a row are lit: the smaller product of both directions' leaning, positive
    where light comes from one side in both.
    """
    halves = [_half(image, row, side) for side in (-1, 1)]
    return min(_leaning(halves[0], axis) * _leaning(halves[1], axis) for axis in (0, 1))


def checks(figure, renderer):
    """Checks that exactly the wrong triangles are found, and of each tangent's effect on the mirrored row."""
    surface = the_mesh()
    report = tangent_space.examine_surface(surface)
    middle = surface.positions[surface.triangles].mean(axis=1)
    wanted = {
        kind: np.flatnonzero((middle[:, 0] > 0.0) & (middle[:, 1] > ends[0]) & (middle[:, 1] < ends[1]))
        for kind, ends in zip(ROWS, heights(), strict=True)
    }
    found = {
        "mirrored": report.mirrored,
        "without area": report.zero_area,
        "stretched": report.stretched,
    }
    wrong = sum(len(np.setxor1d(wanted[kind], found[kind])) for kind in found)
    stretch = report.stretch[wanted["stretched"]]
    ends = tangent_space.with_tangents(surface, *figure.values["handled"])
    frame = dot(np.cross(ends.tangents, ends.binormals), ends.normals)
    size = 192
    image = renderer.machine_window(figure, size)
    naive, shown, right = (panel_of(image, k) for k in range(3))
    plain = figure.values["background"]
    hole = np.abs(_half(right, 2, 1) - np.array(plain)).max()
    colors = [
        np.median(_half(shown, row, 1).reshape(-1, 3), axis=0) - np.array(COLORS[kind])
        for row, kind in enumerate(ROWS)
    ]
    return (
        DATA.check("triangles found wrongly or not found", float(wrong), Answer.IDEAL),
        DATA.check(
            "stretch of the stretched ones - 4, largest", float(np.abs(stretch - 4.0).max()), Answer.IDEAL
        ),
        DATA.check(
            "triangles whose binormal turns round",
            float((frame[ends.triangles[:, 0]] < 0.0).sum()),
            Answer.IDEAL,
            at_least=float(len(report.mirrored)),
        ),
        DATA.check(
            "light of the good half against the mirrored, one tangent for all",
            _alike(naive, 1),
            Answer.MACHINE,
        ),
        DATA.check("the same with the binormal's sign", _alike(right, 1), Answer.MACHINE),
        DATA.check(
            "what is left of triangles without area", float(hole), Answer.MACHINE, at_most=1.0 / 255.0
        ),
        DATA.check(
            "colours of the found triangles, largest difference",
            float(np.abs(colors).max()),
            Answer.MACHINE,
            at_most=1.0 / 255.0,
        ),
        arithmetic_check(figure, renderer, 0.0125, POWER_8),
    )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "light": word.LIGHT((-0.72, 0.48, 0.5)),
        "diffuse": word.DIFFUSE((0.50, 0.42, 0.32)),
        "ambient": word.AMBIENT((0.05, 0.05, 0.05)),
        "background": word.BACKDROP(BACKGROUND),
        "handled": word.of(
            word.Several(
                (
                    word.of_enum(tangent_space.ZeroArea.DROP, tangent_space.ZeroArea.KEEP),
                    word.of_enum(
                        *(way for way in tangent_space.Mirrored if way is not tangent_space.Mirrored.REFUSE)
                    ),
                )
            ),
            (tangent_space.ZeroArea.DROP, tangent_space.Mirrored.SIGN),
            "What becomes of triangles without area in the map, and of mirrored ones.",
        ),
    },
    methods=(Method("register combiners", scene, ("GEFORCE_256", "GEFORCE_3")),),
    acceptance=checks,
)
