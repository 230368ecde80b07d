"""F003-16: the main idea of shadow maps, two diagrams: what the light sees is lit; a camera in its place."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.diagrams.checks import drawn_check
from fixedpipe.effects.diagrams.drawing import FAINT, INK, RED, YELLOW
from fixedpipe.effects.diagrams.flatland import Shape, first_hit, is_visible, pieces
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import DIAGRAM_MACHINES, Figure, Method
from fixedpipe.effects.geometry.vectors import cosine, sine
from fixedpipe.effects.geometry.views import BACKGROUND, row_of_panels

DATA = figure_data(__file__, "F003-16")

LIGHT = (-0.6, 0.80)
LIT, UNLIT = (0.98, 0.86, 0.45), (0.26, 0.34, 0.62)
_FILL = (0.17, 0.18, 0.21)


def _ball(center, radius, corners=24):
    return tuple(
        (center[0] + radius * float(cosine(angle)), center[1] + radius * float(sine(angle)))
        for angle in 2.0 * np.pi * (np.arange(corners) + 0.5) / corners
    )


SHAPES = (
    Shape("floor", ((-0.97, -0.84), (0.97, -0.84), (0.97, -0.72), (-0.97, -0.72))),
    Shape("box", ((-0.42, -0.72), (-0.12, -0.72), (-0.12, -0.38), (-0.42, -0.38))),
    Shape("ball", _ball((0.2, -0.22), 0.14)),
)
# Parts of an outline of length one; whether each is lit is asked of its middle.
_PIECES = 24
# The camera in the light's place: its image plane is so far from it, this is between the lines of sight to
# the middle and to the edge, and the image has so many pixels.
_PLANE, _HALF_ANGLE, PIXELS = 0.34, 29.0, 15
# Left, bottom, width and height of the image as it is laid out beside the field of view.
_LAID_OUT = (0.14, 0.2, 0.81, 0.14)
# The depths that are black and white.
_NEAR, _FAR = 0.90, 1.62
# Of the picture's points: (shape, edge, part of the edge).
_POINTS = (
    *(("floor", 2, 0.887), ("floor", 2, 0.42), ("floor", 2, 0.185)),
    *(("box", 2, 0.45), ("box", 1, 0.5), ("ball", 8, 0.5)),
)


def points():
    """The points whose rays to the light are drawn, and whether each is lit."""
    by_name = {shape.name: shape for shape in SHAPES}
    out = []
    for name, edge, part in _POINTS:
        a, b = (end[edge] for end in by_name[name].edges)
        out.append(tuple(map(float, a + (b - a) * part)))
    return tuple((point, is_visible(point, LIGHT, SHAPES)) for point in out)


def outlines():
    """Every part of the shapes' outlines, float64 [n, 2 ends, 2], and whether its middle is lit, bool [n].

    Outlines on the floor or below it are left out, since they are not visible.
    """
    parts = np.concatenate([pieces(shape, _PIECES) for shape in SHAPES])
    middles = parts.mean(axis=1)
    parts = parts[
        (middles[:, 1] > -0.719) | ((middles[:, 1] > -0.721) & (np.abs(middles[:, 0] + 0.27) > 0.15))
    ]
    return parts, np.array([is_visible(tuple(m), LIGHT, SHAPES) for m in parts.mean(axis=1).tolist()])


def axes():
    """The camera's line of sight and the direction along its image, unit vectors."""
    toward = np.array([-0.267, -0.36]) - np.array(LIGHT)
    toward = toward / np.sqrt((toward * toward).sum())
    return toward, np.array([-toward[1], toward[0]])


def image_point(u):
    """The point of the image plane at ``u``, [-1, 1] over the image."""
    toward, along = axes()
    half = _PLANE * float(sine(np.radians(_HALF_ANGLE)) / cosine(np.radians(_HALF_ANGLE)))
    return tuple(map(float, np.array(LIGHT) + toward * _PLANE + along * (u * half)))


def image_of(point):
    """Where on the image a point is seen, u, and its depth along the line of sight."""
    toward, along = axes()
    x, y = point[0] - LIGHT[0], point[1] - LIGHT[1]
    depth, side = x * toward[0] + y * toward[1], x * along[0] + y * along[1]
    tangent = float(sine(np.radians(_HALF_ANGLE)) / cosine(np.radians(_HALF_ANGLE)))
    return side / (depth * tangent), depth


def pixel_centers():
    """The u of the middle of each pixel of the image."""
    return tuple((2.0 * k + 1.0) / PIXELS - 1.0 for k in range(PIXELS))


def hits():
    """What each pixel of the image sees: the first crossing on the ray through its middle."""
    return tuple(first_hit(LIGHT, image_point(u), SHAPES) for u in pixel_centers())


def shade(depth):
    """A depth as a grey, near dark."""
    return min(max((depth - _NEAR) / (_FAR - _NEAR), 0.0), 1.0)


def _shapes(view):
    return tuple(drawing.polygon(shape.name, view, shape.corners, _FILL) for shape in SHAPES)


def _visibility(view):
    out = list(_shapes(view))
    lit = [(point, is_lit) for point, is_lit in points() if is_lit]
    unlit = [point for point, is_lit in points() if not is_lit]
    blocking = []
    out.append(
        drawing.strokes("rays to points that see the light", view, [[LIGHT, p] for p, _ in lit], YELLOW)
    )
    for point in unlit:
        hit = first_hit(LIGHT, point, SHAPES).point
        blocking.append(hit)
        out += [
            drawing.stroke("ray to what blocks it", view, [LIGHT, hit], YELLOW),
            drawing.stroke("blocked", view, [hit, point], RED, dash=drawing.DASH),
        ]
    parts, lights = outlines()
    for name, color, chosen in (("not visible", UNLIT, ~lights), ("visible from the light", LIT, lights)):
        out.append(drawing.strokes(name, view, parts[chosen], color, width=2.6))
    out.append(drawing.dots("lit points", view, [*blocking, *(p for p, _ in lit)], YELLOW))
    out.append(drawing.dots("points in shadow", view, unlit, RED))
    out.append(drawing.dots("light", view, LIGHT, YELLOW, radius=6.0))
    out.append(drawing.text("light", view, LIGHT, YELLOW, align=(1, 0), offset=(-10.0, 0.0)))
    out.append(drawing.text("lit if visible from the light", view, (0.0, -0.86), INK, align=(0, 1)))
    return tuple(out)


def _camera(view):
    out = list(_shapes(view))
    seen = hits()
    out.append(
        drawing.strokes("lines of sight", view, [[LIGHT, hit.point] for hit in seen], FAINT, width=0.9)
    )
    edges = [[LIGHT, first_hit(LIGHT, image_point(u), SHAPES).point] for u in (-1.0, 1.0)]
    out.append(drawing.strokes("field of view", view, edges, INK))
    toward, _ = axes()
    thick = 0.08
    for u, hit in zip(pixel_centers(), seen, strict=True):
        grey = shade(image_of(hit.point)[1])
        corners = [np.array(image_point(u + side / PIXELS)) for side in (-0.94, 0.94)]
        corners += [corners[1] - toward * thick, corners[0] - toward * thick]
        out.append(drawing.polygon("pixel of the depth image", view, corners, (grey, grey, grey)))
    out.append(drawing.dots("nearest points", view, [hit.point for hit in seen], LIT, radius=2.6))
    out.append(drawing.dots("camera at the light", view, LIGHT, YELLOW, radius=6.0))
    # The image once more, laid out where its pixels can be told apart.
    left, low, wide, high = _LAID_OUT
    for k, hit in enumerate(seen):
        grey = shade(image_of(hit.point)[1])
        x, end = (left + wide * (k + part) / PIXELS for part in (0.04, 0.96))
        corners = ((x, low), (end, low), (end, low + high), (x, low + high))
        out.append(drawing.polygon("pixel of the image, laid out", view, corners, (grey, grey, grey)))
    above = (left + 0.5 * wide, low + high)
    out.append(drawing.text("camera at the light", view, LIGHT, YELLOW, align=(-1, 0), offset=(10.0, 0.0)))
    out.append(drawing.text("depth image", view, above, INK, align=(0, -1), offset=(0.0, 4.0)))
    out.append(drawing.text("its image: the nearest depths", view, (0.0, -0.86), INK, align=(0, 1)))
    return tuple(out)


def scene(profile, size, *, background):
    """Left: rays from the light to points. Right: the image of a camera in the light's place."""
    left, right = row_of_panels(2, size)
    return (
        drawing.load_font(),
        left.clear(background),
        *_visibility(drawing.sheet(left)),
        right.clear(background),
        *_camera(drawing.sheet(right)),
    )


def checks(figure, renderer):
    """Checks that both diagrams agree at every point in the camera's view, and that the pictures show it."""
    parts, lit = outlines()
    middles = [tuple(m) for m in parts.mean(axis=1).tolist()]
    images = [image_of(m) for m in middles]
    in_view = np.array([abs(u) < 1.0 for u, _ in images])
    nearest = np.array(
        [
            depth <= image_of(first_hit(LIGHT, image_point(u), SHAPES).point)[1] + 1e-6 if inside else False
            for (u, depth), inside in zip(images, in_view, strict=True)
        ]
    )
    yield DATA.check(
        "points in the camera's view where visible and nearest differ",
        float((lit != nearest)[in_view].sum()),
        Answer.IDEAL,
    )
    yield DATA.check(
        "share of those points that are lit, or in shadow, the smaller",
        float(min(lit[in_view].mean(), 1.0 - lit[in_view].mean())),
        Answer.IDEAL,
    )
    size = figure.size // 2
    # The parts whose middle no dot, ray or grazing edge of another part covers are most of them.
    for on in Answer:
        image = renderer.window(on, figure, size)

        def color_at(x, y, column, image=image):
            j, i = int((y + 1.0) * 0.5 * size), int((x + 1.0) * 0.5 * size) + column * size
            return image[j, i]

        right = [
            np.abs(color_at(*middle, 0) - np.array(LIT if is_lit else UNLIT)).max() < 0.01
            for middle, is_lit in zip(middles, lit, strict=True)
        ]
        yield DATA.check(
            "share of outline points with the colour of their visibility", float(np.mean(right)), on
        )
        toward, _ = axes()
        drawn = np.array(
            [color_at(*(np.array(image_point(u)) - toward * 0.04), 1)[0] for u in pixel_centers()]
        )
        depths = np.array([image_of(hit.point)[1] for hit in hits()])
        yield DATA.check(
            "grey of the depth image - depth of the nearest point, largest",
            float(np.abs(drawn - [shade(depth) for depth in depths]).max()),
            on,
        )
        yield DATA.check(
            "least rise of the grey from a pixel of the image to the next deeper one",
            float(np.diff(drawn[np.argsort(depths)]).min()),
            on,
        )
    sheets = [drawing.sheet(panel) for panel in row_of_panels(2, size)]
    marks = [(0, sheets[0], point, YELLOW if is_lit else RED) for point, is_lit in points()]
    marks += [(1, sheets[1], hit.point, LIT) for hit in hits()]
    yield from drawn_check(figure, renderer, marks)


FIGURE = Figure(
    **DATA.words,
    parameters={
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("diagram", scene, DIAGRAM_MACHINES),),
    acceptance=checks,
)
