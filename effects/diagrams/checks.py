"""The checks of diagrams: where marks are, and whether letters can be read."""

from collections import Counter

import numpy as np
from PIL import ImageFont

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.geometry.views import panel_of
from fixedpipe.pipeline.commands import Draw


def drawn_check(figure, renderer, places):
    """The Checks of a diagram: marks are at the places of the geometry, on the ideal and on the machine.

    ``places``: (panel's number, its view at half the figure's size, point, colour) for each mark. The
    measured number is the largest distance of a pixel there from its colour.
    """
    size = figure.size // 2
    for on in Answer:
        image, apart = renderer.window(on, figure, size), 0.0
        for number, view, point, color in places:
            x, y = (int(c) for c in np.floor(drawing.project(view, point)[:2]))
            apart = max(apart, float(np.abs(panel_of(image, number)[y, x] - np.array(color)).max()))
        yield Check(
            f"colours of {len(places)} marks at the computed places, largest difference",
            apart,
            at_most=0.5 / 255.0 + 1e-9 if on is Answer.IDEAL else 1.0 / 255.0,
            on=on,
            reason="a mark covers the pixel's middle",
        )


def letters_check(figure, renderer):
    """The Check that the displayed letters are the font's glyphs, upright, in their label's order.

    The glyphs are Pillow's own, not those of the texture that is drawn. The measured number is the least
    share of a label's glyph pixels that have its colour, minus the share of its other pixels that have it.
    For a label with an outline the other pixels are the outline's, because the background may be as light as
    the glyphs.
    """
    image = renderer.machine_window(figure, figure.size)
    font, least, labels = ImageFont.load_default_imagefont(), 1.0, 0
    for command in figure.commands(renderer.profile, figure.size, renderer.method):
        if not _is_text(command):
            continue
        labels += 1
        viewport = command.state.vertex.viewport
        panel = image[viewport.y : viewport.y + viewport.height, viewport.x : viewport.x + viewport.width]
        letters = command.label.replace(" ", "")
        # The last quads are the letters; those before them are their outline.
        corners = command.mesh.positions[-4 * len(letters) :].reshape(-1, 4, 3)
        color, shown = np.array(command.mesh.colors[-1][:3]), [[], []]
        outlined = len(command.mesh.positions) > 4 * len(letters)
        for letter, quad in zip(letters, corners, strict=True):
            (left, bottom), (right, top) = (np.floor(quad[k, :2] + 0.5).astype(int) for k in (0, 2))
            if left < 0 or bottom < 0 or right > panel.shape[1] or top > panel.shape[0]:
                shown[1].append(np.zeros(1, bool))
                continue
            mask = font.getmask(letter)
            glyph = np.array(mask).reshape(mask.size[::-1])[::-1] > 0
            rows = (np.arange(top - bottom) + 0.5) * glyph.shape[0] / (top - bottom)
            columns = (np.arange(right - left) + 0.5) * glyph.shape[1] / (right - left)
            inside, beside = (
                part[np.ix_(rows.astype(int), columns.astype(int))]
                for part in (glyph, _round(glyph) if outlined else ~glyph)
            )
            same = np.abs(panel[bottom:top, left:right] - color).max(axis=-1) <= 1.0 / 255.0
            shown[1].append(same[inside])
            shown[0].append(same[beside])
        beside, on = (np.concatenate(parts).mean() if parts else 0.0 for parts in shown)
        least = min(least, float(on - beside))
    if labels:
        yield Check(
            f"the least legible of {labels} labels: its glyphs' pixels in its colour, less those beside them",
            least,
            at_least=0.9,
            on=Answer.MACHINE,
            reason="what crosses a letter takes few of its pixels; a turned or filled one loses a third",
        )


def _round(glyph):
    """The pixels beside, above or below a glyph's own: bool [rows, columns]."""
    wide = np.pad(glyph, 1)
    return (wide[1:-1, :-2] | wide[1:-1, 2:] | wide[:-2, 1:-1] | wide[2:, 1:-1]) & ~glyph


def _is_text(command):
    units = command.state.texture_units if isinstance(command, Draw) else ()
    return any(unit is not None and unit.texture == drawing.FONT for unit in units)


def missing_texts(figure, renderer, texts):
    """How many of ``texts``, each as often as it is listed, a figure's commands do not write.

    ``letters_check`` tells whether those that are written can be read.
    """
    commands = figure.commands(renderer.profile, figure.size, renderer.method)
    return (Counter(texts) - Counter(c.label for c in commands if _is_text(c))).total()
