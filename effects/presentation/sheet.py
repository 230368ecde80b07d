"""A figure on a sheet: its pictures with their labels, its title or caption and its source, in millimetres.

``sheet`` composes; ``fixedpipe.effects.presentation.sheet_files`` writes it as PNG, PDF or SVG.
"""

import math
import shlex
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.bibliography import citation
from fixedpipe.effects.presentation.layout import SMALL, Area, arrange, height_of, place
from fixedpipe.effects.presentation.pictures import names_of, pictures_of
from fixedpipe.effects.presentation.styles import LEAST_POINTS, MILLIMETRES, POINTS, STYLES, Style
from fixedpipe.effects.presentation.typesetting import Font, broken
from fixedpipe.effects.refusal import Refusal, choose
from fixedpipe.pipeline.profiles import PROFILES

# Of a line's height in its size.
LEADING = 1.25
# Where a line's letters stand in it, from its top.
BASELINE = 0.93
# Points of letters over a picture, at least, and of a line's height in the picture; an index in the size of
# its letter, and how far below the line it stands.
LETTERS, LETTERS_IN_LINE, INDEX, LOWERED = 7.0, 0.82, 0.72, 0.2


@dataclass(frozen=True, eq=False)
class Panel:
    """A panel on a sheet: its left top corner, its width and height in mm, the picture and the label that it
    has, and its ``pixels``, uint8 [h, w, 3], top row first.
    """

    x: float
    y: float
    width: float
    height: float
    picture: str
    label: str
    pixels: NDArray[np.uint8]


@dataclass(frozen=True)
class Line:
    """A line of text on a sheet: where its baseline begins, mm; ``upright``: it runs upwards; ``over``: it
    stands over a panel; ``halo``: the colour around its letters, or none.
    """

    x: float
    y: float
    text: str
    font: Font
    color: str
    upright: bool = False
    over: bool = False
    halo: str = ""


@dataclass(frozen=True, eq=False)
class Sheet:
    """A figure on a sheet.

    width, height                            mm
    style                                    its Style
    panels, lines                            its contents
    dpi, scale                               of a PNG file: pixels an inch, and the edge of the square that
                                             shows one of the figure's pixels; None: pixels are not enlarged
    title, caption, source, bibtex, command  for the file's own fields, and for the file beside it; source and
                                             bibtex are empty without a paper
    """

    width: float
    height: float
    style: Style
    panels: tuple[Panel, ...]
    lines: tuple[Line, ...]
    dpi: float | None
    scale: int | None
    title: str
    caption: str
    source: str
    bibtex: str
    command: str

    @property
    def said(self):
        """Its size in words, and how large the figure's pixels are."""
        size = f"{self.width:g} x {self.height:.1f} mm"
        if self.scale is None:
            return f"{size}, every panel with its own pixels"
        each = (
            f"each pixel of the figure is {self.scale}x{self.scale}" if self.scale > 1 else "pixel for pixel"
        )
        return f"{size} at {self.dpi:.4g} dpi, {each}"

    @property
    def bib(self):
        """The text of the file beside it: caption and command as comments, and the paper's entry."""
        said = (self.title, *self.caption.splitlines(), f"Drawn by: {self.command}")
        return "".join(f"% {line}\n" for line in said) + (f"\n{self.bibtex}" if self.bibtex else "")


def sheet(
    drawn, kind="png", *, style="paper", width=None, dpi=None, pictures=None, palette="screen", letters=()
):
    """Compose a figure's pictures on a sheet.

    Parameters
    ----------
    drawn : fixedpipe.effects.figures.Rendering
        A figure as a machine drew it: ``FIGURES["F003-21"].render("GEFORCE_3")``.
    kind : str
        Of ``fixedpipe.effects.presentation.sheet_files.KINDS``: png, pdf, svg. In a PNG file every pixel of
        the figure is a square of whole pixels; the others hold the figure's own pixels.
    style : str
        Of ``fixedpipe.effects.presentation.styles.STYLES``.
    width : float, optional
        Of the sheet in mm; None: the style's.
    dpi : float, optional
        Pixels an inch of a PNG file; None: the least, from the style's, with which panels are as large as
        they can be.
    pictures : sequence of str, optional
        Of ``fixedpipe.effects.presentation.pictures.PICTURES``; None: as ``names_of`` there chooses.
    palette : str, optional
        That of the figure's method, screen or paper, for the command that the sheet names.
    letters : sequence of dict, optional
        Labels that stand over the machine's picture and its ideal, drawn without them: {runs, x, y, size,
        color, align}, as ``fixedpipe.effects.reports.letters.labels_of`` gives them.

    Returns
    -------
    Sheet

    Raises Refusal for a name that is none, a width or a dpi out of range, where panels would have no room,
    and where matplotlib is not installed.
    """
    look, width = asked_of(style, width, dpi)
    shown = pictures_of(drawn, names_of(drawn.figure, drawn.profile, pictures, look.fixed))
    return _Composition(drawn, kind, _scaled(look, width), width, shown, letters).sheet(style, dpi, palette)


def asked_of(style, width=None, dpi=None):
    """The Style of that name and the width in mm, as ``sheet`` takes them. Raises Refusal likewise."""
    look = choose("style", style, STYLES)
    width = look.width if width is None else width
    if not look.least <= width <= look.most:
        raise Refusal(f"The width is {width:g} mm; give {look.least:g} to {look.most:g} for {style}.")
    if dpi is not None and not 36 <= dpi <= 4800:
        raise Refusal(f"The resolution is {dpi:g} pixels an inch; give 36 to 4800.")
    return look, width


def _scaled(style, width):
    """The style for a sheet of that width."""
    if not style.scales:
        return style
    factor = width / style.width
    lengths = ("title", "text", "label", "note", "margin", "gutter", "gap")
    changed = {name: factor * getattr(style, name) for name in lengths}
    sizes = {name: max(LEAST_POINTS, changed[name]) for name in lengths[:4]}
    return replace(style, **changed | sizes)


def _line_height(points):
    return LEADING * points * MILLIMETRES / POINTS


def _rows_of(runs):
    """The lines of [text, level] parts, which end at a newline."""
    rows = [[]]
    for text, level in runs:
        for n, part in enumerate(text.split("\n")):
            if n:
                rows.append([])
            if part:
                rows[-1].append((part, level))
    return rows


class _Composition:
    """What a sheet is composed of, and where: one attempt after another at how many lines the labels take."""

    def __init__(self, drawn, kind, style, width, shown, letters=()):
        self.drawn, self.kind, self.style, self.width = drawn, kind, style, width
        self.letters = letters
        figure, self.shown = drawn.figure, shown
        self.pictures = tuple(picture for picture in shown if picture.panels)
        self.said = tuple(picture for picture in shown if not picture.panels)
        self.columns = figure.columns
        self.ratio = figure.panel_width(drawn.size) / drawn.size
        self.labels = figure.panels
        self.inner = width - 2 * style.margin
        face, label, note = style.face, style.label, style.note
        self.fonts = {
            "title": Font(face, style.title, bold=True),
            "text": Font(face, style.text),
            "label": Font(face, label),
            "heading": Font(face, label, bold=True),
            "note": Font(face, note),
        }
        self.paper = citation(figure.source) if figure.source else None
        self.title = f"{figure.id}. {figure.title}"

    # ------------------------------------------------------------------------------------------- words

    def _texts(self):
        """What is written above the pictures, of differences that are none, and below: (text, font's name,
        color) each.
        """
        style = self.style
        said = [(picture.note, "label", style.ink) for picture in self.said]
        source = [(self.made, "note", style.quiet)]
        if self.paper:
            source.append((f"After {self.paper.words}.", "note", style.quiet))
        if style.caption:
            return [], said, [(self.title, "title", style.ink), (self.caption, "text", style.ink), *source]
        return [(self.drawn.figure.title, "title", style.ink)], said, source

    @property
    def caption(self):
        """What was changed, and the figure's caption."""
        drawn = self.drawn
        changed = drawn.figure.said(drawn.method, drawn.changes)
        said = f"A variant, drawn with {changed}. " if changed else ""
        return said + drawn.figure.caption_with(bool(changed))

    @property
    def made(self):
        """Who drew the pictures and how, in a sentence."""
        drawn = self.drawn
        names = {picture.name for picture in (*self.pictures, *self.said)}
        said = [f"{drawn.figure.id} on the {drawn.profile.name} ({drawn.method.name}), bit for bit"]
        if drawn.profile.arithmetic.exact:
            said = [f"{drawn.figure.id} by the ideal ({drawn.method.name}), in float64"]
        elif "ideal" in names:
            said.append("ideal: the same fragments in float64")
        if "reference" in names:
            said.append("reference: what the algorithm approximates, computed without it")
        if drawn.bits > 8 and names != {"ideal"}:
            said.append(f"{drawn.bits} bits a component are shown as the nearest bytes")
        return f"{'; '.join(said)}. Panels of {drawn.size} pixels."

    def _set(self, texts):
        """Lines of texts in the whole width: (text, font, color) each."""
        return [
            (line, self.fonts[name], color)
            for text, name, color in texts
            for line in broken(text, self.fonts[name], self.inner)
        ]

    # ----------------------------------------------------------------------------------------- layout

    def _area(self, height, lines_of_label, lines_of_heading, lines_of_notes):
        style = self.style
        label = lines_of_label * _line_height(style.label)
        return Area(
            self.inner,
            height,
            style.gutter,
            style.gap,
            label,
            lines_of_heading * _line_height(style.label),
            tuple(n * _line_height(style.note) for n in lines_of_notes),
            self.ratio,
        )

    def _arranged(self, height):
        """The Area and the Arrangement in it, with as many lines as labels, headings and notes then take."""
        labels, heading, notes = int(any(self.labels)), 1, [int(bool(p.note)) for p in self.pictures]
        for _ in range(6):
            area = self._area(height, labels, heading, notes)
            # A slide has a page to fill: rows are broken wherever that makes panels larger.
            arrangement = arrange(area, self.columns, math.inf if self.style.fixed else SMALL)
            if arrangement.height <= 0:
                break
            room = arrangement.panels * arrangement.width + (arrangement.panels - 1) * area.gutter
            rows = math.ceil(self.columns / arrangement.panels)
            long = rows * arrangement.height if arrangement.pictures == 1 else room
            needed = (
                max(len(broken(text, self.fonts["label"], arrangement.width)) for text in self.labels)
                if any(self.labels)
                else 0,
                max(len(broken(p.heading, self.fonts["heading"], long)) for p in self.pictures),
                [len(broken(p.note, self.fonts["note"], room)) if p.note else 0 for p in self.pictures],
            )
            if needed == (labels, heading, notes):
                return area, arrangement
            # What once needed more lines keeps them: so the search ends.
            labels, heading = max(labels, needed[0]), max(heading, needed[1])
            notes = [max(pair) for pair in zip(notes, needed[2], strict=True)]
        return area, arrangement

    def _whole(self, area, arrangement, dpi):
        """(arrangement, dpi, scale) of a PNG file: panels whose pixels are squares of ``scale`` pixels."""
        size = self.drawn.size
        inches = arrangement.height / MILLIMETRES
        if dpi is None:
            scale = max(1, math.ceil(self.style.dpi * inches / size))
            return arrangement, scale * size / inches, scale
        scale = int(dpi * inches / size + 1e-6)
        if scale == 0:
            there, needed = int(dpi * inches), math.ceil(size / inches)
            raise Refusal(
                f"Panels of {size} pixels have {there} here at {dpi:g} dpi, and pixels are never merged. "
                f"Give --dpi {needed} or more, --size {there} or less, more --width, or a PDF or SVG file."
            )
        return replace(arrangement, height=scale * size / dpi * MILLIMETRES), dpi, scale

    # ------------------------------------------------------------------------------------------ sheet

    def sheet(self, style_name, asked_dpi, palette):
        """The Sheet."""
        dpi = asked_dpi
        style, gap = self.style, self.style.gap
        above, said, below = (self._set(texts) for texts in self._texts())
        tall = style.height(self.width)
        over, beside, under = (
            sum(_line_height(font.points) for _, font, _ in texts) + gap * bool(texts)
            for texts in (above, said, below)
        )
        room = tall - 2 * style.margin - over - beside - under
        if not self.pictures:
            raise Refusal(
                f"Nothing is left to be drawn: {self.said[0].note} Ask for the machine's picture as well."
            )
        area, arrangement = self._arranged(room)
        if arrangement.height < 4:
            raise Refusal(
                f"On {self.width:g} mm panels would be {max(0.0, arrangement.height):.1f} mm; give a larger "
                "--width or fewer --pictures."
            )
        scale = None
        if self.kind == "png":
            arrangement, dpi, scale = self._whole(area, arrangement, dpi)
        pictured = height_of(area, self.columns, arrangement)
        lines: list[Line] = []
        self._write(lines, above, style.margin)
        y = style.margin + over
        height = tall
        if style.fixed:
            y += (room - pictured) / 2
            self._write(lines, below, tall - style.margin - under + gap)
        else:
            height = y + pictured + beside + under + style.margin
            self._write(lines, below, y + pictured + beside + gap)
        self._write(lines, said, y + pictured + gap)
        panels = self._place(lines, area, arrangement, y)
        return Sheet(
            width=self.width,
            height=height,
            style=style,
            panels=tuple(panels),
            lines=tuple(lines),
            dpi=dpi,
            scale=scale,
            title=self.title,
            caption="\n".join((self.caption, self.made, *(p.note for p in self.pictures if p.note))),
            source=self.paper.words if self.paper else "",
            bibtex=self.paper.bibtex if self.paper else "",
            command=self._command(style_name, asked_dpi, palette),
        )

    def _write(self, lines, texts, y):
        """Set lines of text from ``y`` down."""
        for text, font, color in texts:
            height = _line_height(font.points)
            lines.append(Line(self.style.margin, y + BASELINE * height / LEADING, text, font, color))
            y += height

    def _place(self, lines, area, arrangement, top):
        """The panels; their labels, headings and notes go to ``lines``."""
        style = self.style
        for number, (picture, spot) in enumerate(
            zip(self.pictures, place(area, self.columns, arrangement), strict=True)
        ):
            corners = [(style.margin + x, top + y) for x, y in spot.panels]
            left = style.margin + spot.left
            self._head(lines, area, arrangement, picture, left, top + spot.top, corners)
            labelled = number == 0 or arrangement.pictures > 1 or arrangement.panels < self.columns
            for column, ((x, y), label, pixels) in enumerate(
                zip(corners, self.labels, picture.panels, strict=True)
            ):
                if pixels is not None and picture.name in ("machine", "ideal"):
                    self._letters(lines, column, x, y, arrangement.height / pixels.shape[0])
                if labelled and (pixels is not None or number == 0):
                    self._above(lines, label, "label", style.ink, x, y, arrangement.width)
                if pixels is not None:
                    yield Panel(x, y, arrangement.width, arrangement.height, picture.name, label, pixels)
            height = _line_height(style.note)
            for n, text in enumerate(broken(picture.note, self.fonts["note"], spot.width)):
                y = top + spot.bottom + n * height + BASELINE * height / LEADING
                lines.append(Line(left, y, text, self.fonts["note"], style.quiet))

    def _letters(self, lines, column, left, top, pixel):
        """The letters over a panel whose corner is at ``left``, ``top`` and whose pixels are ``pixel`` mm."""
        across = self.drawn.figure.panel_width(self.drawn.size)
        for label in self.letters:
            if not column * across <= label["x"] < (column + 1) * across:
                continue
            points = max(LETTERS, LETTERS_IN_LINE * label["size"] * pixel * POINTS / MILLIMETRES)
            rows = _rows_of(label["runs"])
            height = _line_height(points)
            middle = top + label["y"] * pixel
            for n, row in enumerate(rows):
                fonts = [Font(self.style.face, points * (INDEX if level < 0 else 1.0)) for _, level in row]
                widths = [font.width(text) for font, (text, _) in zip(fonts, row, strict=True)]
                x = left + (label["x"] - column * across) * pixel - sum(widths) * (label["align"][0] + 1) / 2
                y = middle + (n - len(rows) / 2) * height + BASELINE * height / LEADING
                for font, wide, (text, level) in zip(fonts, widths, row, strict=True):
                    low = LOWERED * points * MILLIMETRES / POINTS if level < 0 else 0.0
                    lines.append(
                        Line(x, y + low, text, font, label["color"], over=True, halo=label.get("halo", ""))
                    )
                    x += wide

    def _head(self, lines, area, arrangement, picture, left, top, corners):
        """A picture's name: above it, or upright at its left."""
        font, height = self.fonts["heading"], _line_height(self.style.label)
        if arrangement.pictures > 1:
            room = arrangement.panels * arrangement.width + (arrangement.panels - 1) * area.gutter
            for n, text in enumerate(broken(picture.heading, font, room)):
                y = top + n * height + BASELINE * height / LEADING
                lines.append(Line(left, y, text, font, self.style.ink))
            return
        bottom = max(y for _, y in corners) + arrangement.height
        middle = (min(y for _, y in corners) + bottom) / 2
        texts = broken(picture.heading, font, bottom - min(y for _, y in corners))
        for n, text in enumerate(texts):
            x = left - area.heading + n * height + 0.75 * height
            lines.append(Line(x, middle + font.width(text) / 2, text, font, self.style.ink, upright=True))

    def _above(self, lines, text, name, color, x, y, width):
        """A text of one or more lines above a panel, in its middle."""
        font = self.fonts[name]
        height = _line_height(font.points)
        texts = broken(text, font, width)
        for n, line in enumerate(texts):
            baseline = y - (len(texts) - n) * height + BASELINE * height / LEADING
            lines.append(Line(x + (width - font.width(line)) / 2, baseline, line, font, color))

    def _command(self, style_name, dpi, palette):
        """What draws the sheet again; the machine by its name where it is none of PROFILES."""
        drawn = self.drawn
        keys = [key for key, profile in PROFILES.items() if profile == drawn.profile]
        words = ["fixedpipe", "print", drawn.figure.id]
        if self.paper or keys:  # a script says its own machine
            words += ["--profile", keys[0] if keys else drawn.profile.name]
        words += ["--size", str(drawn.size)] if self.paper else []
        words += ["--style", style_name, "--width", f"{self.width:g}"]
        words += [] if dpi is None else ["--dpi", f"{dpi:g}"]
        words += [] if palette == "screen" else ["--palette", palette]
        names = tuple(picture.name for picture in self.shown)
        usual = names_of(drawn.figure, drawn.profile, alone=self.style.fixed)
        words += ["--pictures", ",".join(names)] if names != usual else []
        known = drawn.figure.parameters_of(drawn.method)
        for name, value in drawn.changes.items():
            words += ["--set", f"{name}={known[name].kind.show(value)}"]
        return shlex.join(words)
