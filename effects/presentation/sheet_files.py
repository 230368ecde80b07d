"""A sheet as the bytes of a PNG, PDF or SVG file. The same sheet gives the same bytes."""

import io

import numpy as np

from fixedpipe.effects.presentation.styles import MILLIMETRES
from fixedpipe.effects.presentation.typesetting import drawing_library

HALO = 0.25  # of letters' size, the width of what surrounds them


def _canvas(matplotlib, sheet, lines=None, ground=None):
    """A matplotlib figure with the sheet's text, or some of its ``lines``, on its ground or another."""
    from matplotlib.figure import Figure
    from matplotlib.patheffects import withStroke

    size = sheet.width / MILLIMETRES, sheet.height / MILLIMETRES
    figure = Figure(figsize=size, dpi=sheet.dpi or 72.0, facecolor=ground or sheet.style.paper)
    for line in sheet.lines if lines is None else lines:
        text = figure.text(
            line.x / sheet.width,
            1.0 - line.y / sheet.height,
            line.text,
            fontproperties=line.font.properties(),
            color=line.color,
            rotation=90.0 if line.upright else 0.0,
            rotation_mode="anchor",
            ha="left",
            va="baseline",
            parse_math=False,
        )
        if line.halo:
            width = HALO * line.font.points
            text.set_path_effects([withStroke(linewidth=width, foreground=line.halo)])
    return figure


def _png(matplotlib, sheet):
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from PIL import Image
    from PIL.PngImagePlugin import PngInfo

    canvas = FigureCanvasAgg(_canvas(matplotlib, sheet))
    canvas.draw()
    page = np.array(canvas.buffer_rgba())[..., :3]
    pixels = sheet.dpi / MILLIMETRES
    for panel in sheet.panels:
        large = panel.pixels.repeat(sheet.scale, 0).repeat(sheet.scale, 1)
        x, y = (round(v * pixels) for v in (panel.x, panel.y))
        page[y : y + large.shape[0], x : x + large.shape[1]] = large
    page = _with_letters(matplotlib, sheet, page)
    info = PngInfo()
    for key, text in _fields(sheet).items():
        info.add_itxt(key, text)
    buffer = io.BytesIO()
    Image.fromarray(page).save(buffer, "PNG", dpi=(sheet.dpi, sheet.dpi), pnginfo=info)
    return buffer.getvalue()


def _with_letters(matplotlib, sheet, page):
    """A page, uint8 [h, w, 3], with the lines that stand over panels."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    over = [line for line in sheet.lines if line.over]
    if not over:
        return page
    canvas = FigureCanvasAgg(_canvas(matplotlib, sheet, over, "none"))
    canvas.draw()
    ink = np.array(canvas.buffer_rgba()).astype(np.float64)
    share = ink[..., 3:] / 255.0
    return np.floor(ink[..., :3] * share + page * (1.0 - share) + 0.5).astype(np.uint8)


def _fields(sheet):
    """What the file says of itself, by the names of PNG's text chunks."""
    return {
        "Title": sheet.title,
        "Description": sheet.caption,
        "Source": sheet.source,
        "BibTeX": sheet.bibtex,
        "Comment": sheet.command,
        "Software": "fixedpipe",
    }


def _with_panels(matplotlib, sheet):
    """``_canvas`` with the panels as images that keep their own pixels."""
    figure = _canvas(matplotlib, sheet)
    for panel in sheet.panels:
        left, bottom = panel.x / sheet.width, 1.0 - (panel.y + panel.height) / sheet.height
        axes = figure.add_axes((left, bottom, panel.width / sheet.width, panel.height / sheet.height))
        axes.set_axis_off()
        axes.imshow(panel.pixels, interpolation="none", aspect="auto")
    return figure


def _pdf(matplotlib, sheet):
    from matplotlib.backends.backend_pdf import FigureCanvasPdf

    metadata = {
        "Title": sheet.title,
        "Subject": sheet.caption,
        "Keywords": "; ".join(filter(None, (sheet.source, sheet.bibtex))),
        "Creator": sheet.command,
        "Producer": None,
        "CreationDate": None,
    }
    buffer = io.BytesIO()
    FigureCanvasPdf(_with_panels(matplotlib, sheet)).print_pdf(buffer, metadata=metadata)
    return buffer.getvalue()


def _svg(matplotlib, sheet):
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    metadata = {
        "Title": sheet.title,
        "Description": sheet.caption,
        "Source": "\n".join(filter(None, (sheet.source, sheet.bibtex))),
        "Creator": sheet.command,
        "Date": None,
    }
    buffer = io.BytesIO()
    FigureCanvasSVG(_with_panels(matplotlib, sheet)).print_svg(buffer, metadata=metadata)
    return buffer.getvalue()


# By the ending of a file's name.
KINDS = {"png": _png, "pdf": _pdf, "svg": _svg}
# Text stays text, which can be searched and set in another face; fonts are in the PDF file; no name or order
# depends on chance.
_SETTINGS = {
    "pdf.fonttype": 42,
    "svg.fonttype": "none",
    "svg.hashsalt": "fixedpipe",
    "svg.image_inline": True,
}


def file_of(sheet, kind):
    """The bytes of a file of that kind, from a sheet composed for it."""
    matplotlib = drawing_library()
    # Without what a user's settings change.
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(_SETTINGS)
        return KINDS[kind](matplotlib, sheet)
