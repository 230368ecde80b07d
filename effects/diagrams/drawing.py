"""The parts of diagrams, drawn on the machines themselves: strokes, arrows, dots, polygons, labels.

A diagram is a figure like any other: a tuple of commands on a panel of BACKGROUND. Points are given in the
coordinates of a ``View``: two components on a ``sheet``, three in a scene. They are projected here, so
strokes, dots and letters have their width on the screen. The result is triangles in pixels of the panel, with
the depth of a vertex at the same place. Lengths on the screen (``width``, ``radius``, ``head``, ``dash``,
``offset``) are in UNITs, 1/256 of the panel's height, so diagrams scale with the panel.

A diagram has no lines, points or bitmaps, because the ideal draws none (``fixedpipe.pipeline.ideal``). It has
no antialiasing: edges are the machine's. Every machine can draw all of it: vertex colours, one texture of
alpha and the alpha test for labels.

Later commands lie over earlier ones. With a ``depth_test``, nearer things hide farther ones. Strokes then
move towards the eye by ``NEARER``, so that those on a surface stay visible.
"""

import math
from functools import cache
from itertools import pairwise

import numpy as np
from PIL import ImageFont

from fixedpipe.effects.geometry.matrices import orthographic, transform
from fixedpipe.effects.geometry.vectors import cosine, sine
from fixedpipe.effects.geometry.views import View
from fixedpipe.effects.passes.arguments import checked_rgb
from fixedpipe.effects.passes.draws import MODULATE, NEAREST, REPLACE, unit
from fixedpipe.pipeline.commands import Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import BlendFactor, ComparisonFunction, InternalFormat
from fixedpipe.pipeline.state import (
    IDENTITY,
    AlphaTest,
    Blending,
    DepthTest,
    PassState,
    VertexState,
)
from fixedpipe.pipeline.textures.images import texture_2d

# Lengths on the screen are multiples of the panel's height over this.
UNIT = 256.0
LINE, HEAD, RADIUS = 1.3, 8.0, 3.0
DASH = (5.0, 4.0)
# By how much of the depth's [-1, 1] strokes with a depth test come forward. Assumed: enough for half a
# stroke's width on a floor that is seen at 45 degrees, and less than what is between things; a picture
# settles it.
NEARER = 2.0**-7

# Colours that can be told apart on the figures' BACKGROUND.
INK, FAINT = (0.86, 0.87, 0.89), (0.44, 0.46, 0.50)
RED, YELLOW, GREEN = (0.97, 0.38, 0.32), (0.99, 0.83, 0.30), (0.42, 0.86, 0.48)
BLUE, VIOLET = (0.42, 0.66, 1.0), (0.80, 0.58, 0.98)

VISIBLE = DepthTest(ComparisonFunction.LEQUAL, write=False)
TRANSLUCENT = Blending(BlendFactor.SRC_ALPHA, BlendFactor.ONE_MINUS_SRC_ALPHA)

FONT = "font"
# Pillow's bitmap font: every glyph is so many pixels wide and high.
# Measured: pillow 11 to 13, ImageFont.load_default_imagefont().
GLYPH_WIDTH, GLYPH_HEIGHT = 6, 11
# How many lines of text fill a panel: letters of 11 pixels in one of 256, of 22 in one of 512.
LINES = 23.0
_CELL_WIDTH, _CELL_HEIGHT, _CELLS = 8, 16, 16
_CHARACTERS = "".join(map(chr, range(32, 127))) + "\u00b0\u00b1\u00b2\u00b3\u00b5\u00b7\u00d7\u00f7"


def sheet(panel, half_height=1.0, center=(0.0, 0.0)):
    """A panel for drawings in the plane: x to the right and y up, ``half_height`` above and below the
    centre.
    """
    x, y = center
    half_width = half_height * panel.width / panel.height
    box = orthographic(x - half_width, x + half_width, y - half_height, y + half_height)
    return View(panel, IDENTITY, box, (0.0, 0.0, 1.0), True)


def project(view, points):
    """Where points are seen: float64 [..., 3], x and y in pixels from the panel's lower left corner, and the
    normalized device depth in [-1, 1].

    ``points``: [..., 2 or 3]. Raises ValueError for other numbers, and for a point behind the eye.
    """
    points = np.asarray(points, np.float64)
    if points.shape[-1] not in (2, 3) or not np.isfinite(points).all():
        raise ValueError(
            f"Points of shape {points.shape} are no diagram's; give finite [..., 2] or [..., 3]."
        )
    z = points[..., 2] if points.shape[-1] == 3 else 0.0 * points[..., 0]
    columns = (points[..., 0], points[..., 1], z, np.ones_like(z))
    x, y, z, w = transform(view.projection, transform(view.modelview, columns))
    if not (w > 0.0).all():
        raise ValueError("A point of the diagram is behind the eye; end the line before it.")
    half_width, half_height = 0.5 * view.panel.width, 0.5 * view.panel.height
    return np.stack([half_width + half_width * (x / w), half_height + half_height * (y / w), z / w], axis=-1)


def pixels(view, units):
    """A length on the screen in pixels; not less than one, so that no stroke vanishes on a small panel."""
    return max(units * view.panel.height / UNIT, 1.0)


def _draw(label, view, positions, color, triangles, *, alpha=None, depth_test=None, **settings):
    """Triangles in pixels of the view's panel. ``color``: one, or one for each position."""
    panel = view.panel
    positions = np.array(positions, np.float64).reshape(-1, 3)
    color = np.asarray(color, np.float64)
    if color.ndim == 1:
        color = np.broadcast_to(checked_rgb(color), (len(positions), 3))
    if alpha is not None:
        color = np.concatenate([color, np.full((len(color), 1), float(alpha))], axis=-1)
        settings["blending"] = TRANSLUCENT
    mesh = Mesh(
        positions=positions,
        indices=np.asarray(triangles, np.int64).ravel(),
        colors=color,
        texture_coordinates=settings.pop("texture_coordinates", ()),
    )
    vertex = VertexState(
        projection=orthographic(0.0, panel.width, 0.0, panel.height, 1.0, -1.0),
        viewport=panel.viewport,
    )
    state = PassState(vertex=vertex, depth_test=depth_test, **settings)
    return Draw(label=label, mesh=mesh, state=state)


def _nearer(points, depth_test):
    return points if depth_test is None else points - np.array([0.0, 0.0, NEARER])


def _without_repeats(points):
    keep = [0] + [k for k in range(1, len(points)) if (points[k, :2] != points[k - 1, :2]).any()]
    return points[keep]


def _band(points, half):
    """Triangles on both sides of a polyline in pixels: positions [n, 3], indices [k, 3]. Where it bends by
    more than 120 degrees the corner is cut off.
    """
    points = _without_repeats(points)
    if len(points) < 2:
        return np.empty((0, 3)), np.empty((0, 3), np.int64)
    along = points[1:, :2] - points[:-1, :2]
    length = np.sqrt(along[:, 0] * along[:, 0] + along[:, 1] * along[:, 1])
    across = np.stack([-along[:, 1] / length, along[:, 0] / length, 0.0 * length], axis=-1) * half
    closed = len(points) > 2 and (points[0] == points[-1]).all()

    def joint(k):
        """What is added to a point between segments k - 1 and k, for the one and for the other."""
        before, after = across[k - 1], across[k % len(across)]
        cosine_plus_one = 1.0 + (before[0] * after[0] + before[1] * after[1]) / (half * half)
        if cosine_plus_one < 0.5:
            return before, after
        return ((before + after) / cosine_plus_one,) * 2

    first = joint(0)[1] if closed else across[0]
    last = joint(len(across))[0] if closed else across[-1]
    joints = [joint(k) for k in range(1, len(across))]
    starts = [first, *(after for _, after in joints)]
    ends = [*(before for before, _ in joints), last]
    positions = [
        corner
        for a, b, start, end in zip(points[:-1], points[1:], starts, ends, strict=True)
        for corner in (a - start, b - end, b + end, a + start)
    ]
    base = 4 * np.arange(len(along))[:, None]
    return np.array(positions), (base + np.array([0, 1, 2, 0, 2, 3])).reshape(-1, 3)


def _dashed(points, on, off):
    """The pieces of a polyline in pixels that a dash pattern leaves, each a polyline."""
    points = _without_repeats(points)
    pieces, piece, left, drawing = [], [points[0]], on, True
    for start, end in pairwise(points):
        step = end - start
        length, done = float(np.sqrt(step[0] * step[0] + step[1] * step[1])), 0.0
        while length - done > left:
            done += left
            here = start + step * (done / length)
            if drawing:
                pieces.append(np.array([*piece, here]))
            piece, drawing = [here], not drawing
            left = on if drawing else off
        left -= length - done
        piece.append(end)
    return [*pieces, np.array(piece)] if drawing else pieces


def _joined(parts):
    """Several (positions, indices) as one."""
    positions, indices, count = [], [], 0
    for part, triangles in parts:
        positions.append(part)
        indices.append(triangles + count)
        count += len(part)
    return np.concatenate(positions), np.concatenate(indices)


def strokes(label, view, lines, color, *, width=LINE, dash=None, depth_test=None, alpha=None):
    """Polylines, each [k, 2 or 3] (its last point its first again: closed), as one command.

    ``dash``: (drawn, left out) in UNITs, or None. ``depth_test``: ``VISIBLE`` where things hide them.
    ``alpha``: how much they cover of what lies under them; None: all.
    """
    half, parts = 0.5 * pixels(view, width), []
    for line in lines:
        points = _nearer(project(view, line), depth_test)
        pieces = [points] if dash is None else _dashed(points, *(pixels(view, part) for part in dash))
        parts += [_band(piece, half) for piece in pieces]
    positions, indices = _joined(parts)
    if not len(indices):
        raise ValueError(f"The lines of {label!r} have no length; give different points.")
    return _draw(label, view, positions, color, indices, depth_test=depth_test, alpha=alpha)


def stroke(label, view, points, color, **settings):
    """One polyline [k, 2 or 3]; ``settings`` as in ``strokes``."""
    return strokes(label, view, (points,), color, **settings)


def arrow(label, view, points, color, *, width=LINE, head=HEAD, dash=None, depth_test=None):
    """A polyline [k, 2 or 3] with a head at its last point, ``head`` UNITs long or half of the last part."""
    points = _without_repeats(_nearer(project(view, points), depth_test))
    if len(points) < 2:
        raise ValueError(f"The arrow {label!r} has no length; give two different points.")
    tip, before = points[-1], points[-2]
    step = tip - before
    length = float(np.sqrt(step[0] * step[0] + step[1] * step[1]))
    size = min(pixels(view, head), 0.5 * length)
    base = tip - step * (size / length)
    side = np.array([-step[1], step[0], 0.0]) * (0.38 * size / length)
    shaft = np.concatenate([points[:-1], base[None]])
    pieces = [shaft] if dash is None else _dashed(shaft, *(pixels(view, part) for part in dash))
    parts = [_band(piece, 0.5 * pixels(view, width)) for piece in pieces]
    parts.append((np.array([base - side, tip, base + side]), np.array([[0, 1, 2]])))
    positions, indices = _joined(parts)
    return _draw(label, view, positions, color, indices, depth_test=depth_test)


def arc(center, start, stop, u=(1.0, 0.0), v=(0.0, 1.0), segments=32):
    """Points [segments + 1, 2 or 3] of ``center + u cos a + v sin a`` from a = ``start`` to ``stop`` degrees:
    a part of a circle or an ellipse.
    """
    angles = np.radians(start + (stop - start) * np.arange(segments + 1) / segments)
    c, s = cosine(angles)[:, None], sine(angles)[:, None]
    return np.asarray(center, np.float64) + (c * np.asarray(u) + s * np.asarray(v))


def dots(label, view, points, color, *, radius=RADIUS, depth_test=None, sides=16):
    """Points [n, 2 or 3], or one, as discs ``radius`` UNITs large."""
    centers = _nearer(project(view, np.atleast_2d(points)), depth_test)
    size = pixels(view, radius)
    ring = arc((0.0, 0.0, 0.0), 0.0, 360.0, (size, 0.0, 0.0), (0.0, size, 0.0), sides)[:-1]
    fan = np.array([(0, k, k + 1) for k in range(1, sides - 1)])
    positions, indices = _joined([(center + ring, fan) for center in centers])
    return _draw(label, view, positions, color, indices, depth_test=depth_test)


def polygons(label, view, outlines, color, *, alpha=None, depth_test=None):
    """Filled convex polygons, each [k, 2 or 3], as one command; seen from both sides.

    ``color``: one, or for a single polygon one for each corner (between them it varies linearly on the
    screen). ``alpha``: as in ``strokes``.
    """
    parts = []
    for outline in outlines:
        points = project(view, outline)
        parts.append((points, np.array([(0, k, k + 1) for k in range(1, len(points) - 1)])))
    positions, indices = _joined(parts)
    return _draw(label, view, positions, color, indices, alpha=alpha, depth_test=depth_test)


def polygon(label, view, outline, color, **settings):
    """One filled convex polygon [k, 2 or 3]; ``settings`` as in ``polygons``."""
    return polygons(label, view, (outline,), color, **settings)


def picture(label, view, corners, texture, *, depth_test=None):
    """A texture on a rectangle [4, 2 or 3] of the scene, in perspective, every texel a square. ``corners``:
    where (s, t) is (0, 0), (1, 0), (1, 1), (0, 1).
    """
    coordinates = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    mesh = Mesh(
        positions=np.array(corners, np.float64),
        indices=np.array([0, 1, 2, 0, 2, 3]),
        texture_coordinates=(coordinates,),
    )
    state = PassState(
        vertex=view.vertex,
        texture_units=(unit(texture, NEAREST, environment=REPLACE),),
        depth_test=depth_test,
    )
    return Draw(label=label, mesh=mesh, state=state)


@cache
def font_image():
    """The font's texture: uint8 [128, 128, 2], luminance 255 and the glyphs in alpha, bottom row first.

    It has a cell of 8 x 16 texels for each character of ``text``, sixteen in a row from the lower left; the
    glyph is in the cell's lower left corner. The glyphs are pillow's old built-in bitmaps. They need no font
    renderer, whose bits would differ between machines.
    """
    font = ImageFont.load_default_imagefont()
    size = _CELLS * _CELL_WIDTH
    out = np.zeros((size, size, 2), np.uint8)
    out[..., 0] = 255
    for k, character in enumerate(_CHARACTERS):
        mask = font.getmask(character)
        bits = np.array(mask, np.uint8).reshape(mask.size[1], mask.size[0])
        if bits.shape != (GLYPH_HEIGHT, GLYPH_WIDTH):
            raise ValueError(
                f"Pillow's glyph of {character!r} has {bits.shape[1]}x{bits.shape[0]} pixels, not "
                f"{GLYPH_WIDTH}x{GLYPH_HEIGHT}; use pillow 11 to 13."
            )
        x, y = k % _CELLS * _CELL_WIDTH, k // _CELLS * _CELL_HEIGHT
        out[y : y + GLYPH_HEIGHT, x : x + GLYPH_WIDTH, 1] = np.where(bits[::-1] > 0, 255, 0)
    return out


def load_font():
    """The command that labels need before them, once in a frame."""
    return TexImage(
        label="load the font", texture=FONT, image=texture_2d(font_image(), InternalFormat.ALPHA8)
    )


def magnification(view):
    """How many pixels a pixel of the font takes: whole ones, but on panels too small to read."""
    scale = view.panel.height / (LINES * GLYPH_HEIGHT)
    return math.floor(scale) if scale >= 1.0 else scale


def text(label, view, anchor, color, *, align=(0, 0), offset=(0.0, 0.0), outline=None, depth_test=None):
    """A label, in lines separated by newlines; its text in one line is also the command's label.

    ``anchor``: the point of the view where it stands. ``align``: which part of the text is there, -1, 0 or
    1: left, middle or right, and lower edge, middle or upper edge. ``offset``: moved by so many UNITs.
    ``outline``: a colour of the pixels round the letters, for labels over pictures. Raises ValueError for
    characters that the font lacks: spell Greek letters.
    """
    unknown = sorted(set(label) - set(_CHARACTERS) - {"\n"})
    if unknown or not label.strip():
        what = "characters that the font lacks" if unknown else "nothing to read"
        raise ValueError(f"The label {label!r} has {what}; spell Greek letters, and take of {_CHARACTERS}.")
    lines, scale = label.split("\n"), magnification(view)
    columns, height = max(map(len, lines)), len(lines) * GLYPH_HEIGHT * scale
    x, y, depth = _nearer(project(view, anchor), depth_test)
    x += offset[0] * view.panel.height / UNIT - 0.5 * (align[0] + 1) * columns * GLYPH_WIDTH * scale
    y += offset[1] * view.panel.height / UNIT - 0.5 * (align[1] + 1) * height
    # Whole pixels: every pixel of a glyph is then so many pixels of the panel, as on any other panel.
    x, y = math.floor(x + 0.5), math.floor(y + 0.5)
    corners, coordinates = [], []
    for row, line in enumerate(lines):
        left = x + 0.5 * (align[0] + 1) * (columns - len(line)) * GLYPH_WIDTH * scale
        left = math.floor(left + 0.5)
        bottom = y + (len(lines) - 1 - row) * GLYPH_HEIGHT * scale
        for column, character in enumerate(line):
            if character == " ":
                continue
            k = _CHARACTERS.index(character)
            s, t = k % _CELLS * _CELL_WIDTH, k // _CELLS * _CELL_HEIGHT
            for i, j in ((0, 0), (1, 0), (1, 1), (0, 1)):
                corners.append(
                    (left + (column + i) * GLYPH_WIDTH * scale, bottom + j * GLYPH_HEIGHT * scale, depth)
                )
                coordinates.append((s + i * GLYPH_WIDTH, t + j * GLYPH_HEIGHT))
    corners, coordinates = np.array(corners), np.array(coordinates) / (_CELLS * _CELL_WIDTH)
    colors = np.broadcast_to(checked_rgb(color), corners.shape)
    if outline is not None:
        moves = [(-scale, 0.0, 0.0), (scale, 0.0, 0.0), (0.0, -scale, 0.0), (0.0, scale, 0.0)]
        colors = np.concatenate(
            [np.broadcast_to(checked_rgb(outline), (len(moves) * len(corners), 3)), colors]
        )
        coordinates = np.tile(coordinates, (len(moves) + 1, 1))
        corners = np.concatenate([*(corners + np.array(move) for move in moves), corners])
    base = 4 * np.arange(len(corners) // 4)[:, None]
    return _draw(
        label.replace("\n", " "),
        view,
        corners,
        colors,
        base + np.array([0, 1, 2, 0, 2, 3]),
        depth_test=depth_test,
        texture_coordinates=(coordinates,),
        texture_units=(unit(FONT, NEAREST, environment=MODULATE),),
        alpha_test=AlphaTest(ComparisonFunction.GREATER, 0.5),
    )
