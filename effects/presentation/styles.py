"""The styles of sheets: for a printed page, white with small serifs, and for slides, 16:9 with
large letters.
"""

from dataclasses import dataclass

MILLIMETRES = 25.4  # in an inch
POINTS = 72.0  # in an inch
# Nothing is set smaller than this.
LEAST_POINTS = 6.0


@dataclass(frozen=True)
class Face:
    """A typeface: files of matplotlib's own fonts, and the font families that an SVG names."""

    regular: str
    bold: str
    families: tuple[str, ...]


SERIF = Face(
    "STIXGeneral.ttf", "STIXGeneralBol.ttf", ("STIXGeneral", "STIX Two Text", "Times New Roman", "serif")
)
SANS = Face("DejaVuSans.ttf", "DejaVuSans-Bold.ttf", ("DejaVu Sans", "Verdana", "sans-serif"))


@dataclass(frozen=True)
class Style:
    """How a sheet looks.

    does          what it is for
    width         of a sheet where none is given, mm
    least, most   the least and the greatest width, mm
    tall          the greatest height as a multiple of the width, or of the style's own width where that is
                  larger; ``fixed``: it is the height, as a multiple of the width
    dpi           of a PNG file at least, where none is given: pixels an inch
    caption       whether the figure's caption is set below, under the title; else the title stands on top
    paper, ink, quiet   colours of the ground, of text, of text that stands back
    title, text, label, note   sizes in points, of a sheet ``width`` wide; ``scales``: they grow with it
    margin, gutter, gap   around the sheet, between panels and between pictures, mm; they grow in the same way
    """

    does: str
    face: Face
    width: float
    least: float
    most: float
    tall: float
    fixed: bool
    dpi: float
    caption: bool
    paper: str
    ink: str
    quiet: str
    title: float
    text: float
    label: float
    note: float
    margin: float
    gutter: float
    gap: float
    scales: bool

    def height(self, width):
        """The greatest height of a sheet of that width, mm."""
        return self.tall * (width if self.fixed else max(width, self.width))


_SLIDE = {
    "face": SANS,
    "width": 338.67,  # Source: PowerPoint's and LibreOffice's page of 16:9, 13 1/3 by 7 1/2 inches
    "least": 160.0,
    "most": 1000.0,
    "tall": 9 / 16,
    "fixed": True,
    "dpi": 144.0,  # 1920 pixels of the width above
    "caption": False,
    "title": 24.0,
    "text": 13.0,
    "label": 12.5,
    "note": 10.5,
    "margin": 9.0,
    "gutter": 2.0,
    "gap": 4.0,
    "scales": True,
}
STYLES = {
    "paper": Style(
        does="a page of print: white, small serifs, the caption and the source below",
        face=SERIF,
        width=170.0,
        least=50.0,
        most=1000.0,
        tall=2**0.5,  # no taller than a page of A's proportions
        fixed=False,
        dpi=300.0,
        caption=True,
        paper="#ffffff",
        ink="#000000",
        quiet="#444444",
        title=9.0,
        text=8.5,
        label=8.0,
        note=7.0,
        margin=2.0,
        gutter=1.0,
        gap=2.5,
        scales=False,
    ),
    "slide": Style(
        does="a slide, 16:9: dark, large letters, the title on top",
        paper="#15171a",
        ink="#f2f1ee",
        quiet="#a9adb3",
        **_SLIDE,
    ),
    "light-slide": Style(
        does="a slide, 16:9: white, large letters, the title on top",
        paper="#ffffff",
        ink="#1a1c1f",
        quiet="#5c6168",
        **_SLIDE,
    ),
}
