"""A figure on a sheet: its pixels as they are, its labels, its size in mm, the same bytes each time."""

import base64
import io
import math
import re
import zlib
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from fixedpipe.effects.bibliography import citation
from fixedpipe.effects.figures import FIGURES, Figure, Method
from fixedpipe.effects.geometry.views import row_of_panels
from fixedpipe.effects.presentation.layout import SMALL, Area, arrange, height_of, place
from fixedpipe.effects.presentation.pictures import names_of
from fixedpipe.effects.presentation.sheet import sheet
from fixedpipe.effects.presentation.sheet_files import KINDS, file_of
from fixedpipe.effects.presentation.styles import LEAST_POINTS, STYLES
from fixedpipe.effects.refusal import Refusal
from fixedpipe.pipeline.profiles import PROFILES

pytest.importorskip("matplotlib")

SIZE = 32


def half_grey(size, **parameters):
    """A reference of two panels: grey, and none."""
    picture = np.full((size, 2 * size, 4), 0.5)
    picture[:, size:] = 0.0
    return picture


@pytest.fixture(scope="module")
def spheres():
    """Two panels, in which pixels differ from the ideal's."""
    return FIGURES["F004-4"].render("GEFORCE_256", SIZE, slices=8, stacks=6)


@pytest.fixture(scope="module")
def with_reference():
    figure = replace(FIGURES["F004-4"], reference=half_grey)
    return figure.render("GEFORCE_256", SIZE, slices=8, stacks=6)


def panels_of(picture):
    """A picture's square panels, RGB."""
    edge = picture.shape[0]
    return [picture[:, x : x + edge, :3] for x in range(0, picture.shape[1], edge)]


def all_panels(drawn):
    """Those of machine, ideal and difference, in the order of a sheet."""
    pictures = (drawn.image(), drawn.ideal.image(), drawn.difference.image())
    return [panel for picture in pictures for panel in panels_of(picture)]


def spots(page, panel, scale):
    """Left top corners at which a panel stands on a page, each pixel a square of ``scale``."""
    large = panel.repeat(scale, 0).repeat(scale, 1)
    high, wide = large.shape[:2]
    found = np.ones((page.shape[0] - high + 1, page.shape[1] - wide + 1), bool)
    for n in range(0, high, scale):  # along its diagonal first
        spot = page[n : n + found.shape[0], n : n + found.shape[1]]
        found &= (spot == large[n, n]).all(-1)
    return [
        (x, y)
        for y, x in zip(*np.nonzero(found), strict=True)
        if np.array_equal(page[y : y + high, x : x + wide], large)
    ]


def embedded_in_svg(text):
    return [
        np.asarray(Image.open(io.BytesIO(base64.b64decode(data))).convert("RGB"))
        for data in re.findall(r"data:image/png;base64,([^\"]+)", text)
    ]


# In a PDF file's strings, behind a backslash.
ESCAPED = {b"n": b"\n", b"r": b"\r"}


def embedded_in_pdf(data):
    """The images of a PDF file by matplotlib: rows with PNG's filters, compressed, of RGB or of a palette.
    Their bottom row is first, and they are drawn upside down.
    """
    found = []
    for head, body in re.findall(rb"obj\n(<< /Type /XObject.*?)\nstream\r?\n(.*?)\r?\nendstream", data, re.S):
        width, height, bits = (
            int(re.search(rf"/{key} (\d+)".encode(), head)[1])
            for key in ("Width", "Height", "BitsPerComponent")
        )
        palette = re.search(rb"/Indexed /DeviceRGB (\d+)\s*\((.*)\)\s*\]", head, re.DOTALL)
        kind = bytes((bits, 3 if palette else 2, 0, 0, 0))
        chunks = [(b"IHDR", width.to_bytes(4, "big") + height.to_bytes(4, "big") + kind)]
        if palette:
            text = re.sub(rb"\\(.)", lambda m: ESCAPED.get(m[1], m[1]), palette[2], flags=re.DOTALL)
            chunks.append((b"PLTE", text))
        chunks += [(b"IDAT", body), (b"IEND", b"")]
        png = b"\x89PNG\r\n\x1a\n" + b"".join(
            len(held).to_bytes(4, "big") + name + held + zlib.crc32(name + held).to_bytes(4, "big")
            for name, held in chunks
        )
        found.append(np.asarray(Image.open(io.BytesIO(png)).convert("RGB"))[::-1])
    return found


@pytest.mark.parametrize(("style", "width"), [("paper", 60.0), ("slide", 160.0), ("light-slide", 160.0)])
def test_every_panel_stands_in_the_png_with_its_own_pixels(spheres, style, width):
    pictures = ("machine", "ideal", "difference")
    composed = sheet(spheres, "png", style=style, width=width, pictures=pictures)
    page = np.asarray(Image.open(io.BytesIO(file_of(composed, "png"))))
    corners = [spots(page, panel, composed.scale) for panel in all_panels(spheres)]
    assert composed.scale > 1 and all(len(found) == 1 for found in corners), corners
    per_mm = composed.dpi / 25.4
    for panel, [(x, y)] in zip(composed.panels, corners, strict=True):
        assert abs(panel.x * per_mm - x) <= 1 and abs(panel.y * per_mm - y) <= 1
    edge = composed.scale * SIZE
    for number, [(x, y)] in enumerate(corners):
        for [(u, v)] in corners[number + 1 :]:
            assert abs(x - u) >= edge or abs(y - v) >= edge


def test_the_svg_holds_every_panel_and_its_words_as_text(spheres):
    text = file_of(sheet(spheres, "svg"), "svg").decode()
    np.testing.assert_array_equal(embedded_in_svg(text), all_panels(spheres))
    assert text.count("image-rendering:pixelated") == 6
    words = re.findall(r"<text[^>]*>([^<]*)</text>", text)
    gain = spheres.difference.gain
    assert {"along meridians", "along parallels", "GeForce 256", "ideal"} <= set(words)
    assert f"difference \N{MULTIPLICATION SIGN}\N{NO-BREAK SPACE}{gain}" in words
    (note,) = (line for line in words if "about middle grey" in line)
    assert note.startswith(f"(GeForce 256 \N{MINUS SIGN} ideal) \N{MULTIPLICATION SIGN} {gain} about")
    assert "F004-4. Two spheres brushed in different directions" in words
    assert citation("KautzSeidel2000").words in " ".join(words)
    assert citation("KautzSeidel2000").bibtex.strip() in text


def test_the_pdf_holds_every_panel_and_its_fonts(spheres):
    data = file_of(sheet(spheres, "pdf"), "pdf")
    found = embedded_in_pdf(data)
    assert len(found) == 6
    for panel in all_panels(spheres):
        assert any(np.array_equal(panel, image) for image in found)
    assert b"/FontFile2" in data and b"/Type3" not in data and b"/CIDFontType2" in data
    assert b"CreationDate" not in data


@pytest.mark.parametrize("kind", KINDS)
def test_the_same_sheet_has_the_same_bytes(spheres, kind):
    first, second = (file_of(sheet(spheres, kind), kind) for _ in range(2))
    assert first == second
    assert first != file_of(sheet(spheres, kind, style="slide"), kind)


@pytest.mark.parametrize("width", [85.0, 170.0])
def test_a_file_is_as_wide_as_was_asked_for(spheres, width):
    page = Image.open(io.BytesIO(file_of(sheet(spheres, "png", width=width), "png")))
    assert page.width / page.info["dpi"][0] * 25.4 == pytest.approx(width, abs=0.1)
    assert page.info["BibTeX"] == citation("KautzSeidel2000").bibtex
    pdf = file_of(sheet(spheres, "pdf", width=width), "pdf")
    box = re.search(rb"/MediaBox \[ 0 0 ([\d.]+) ", pdf)
    assert float(box[1]) / 72 * 25.4 == pytest.approx(width, abs=0.01)
    svg = file_of(sheet(spheres, "svg", width=width), "svg").decode()
    found = re.search(r'<svg[^>]* width="([\d.]+)pt"', svg)
    assert float(found[1]) / 72 * 25.4 == pytest.approx(width, abs=0.01)


@pytest.mark.parametrize("style", STYLES)
@pytest.mark.parametrize("figure", ["K14", "F004-4", "F003-21", "F003-11", "F004-1"])
@pytest.mark.parametrize("share", [0.5, 1.0])
def test_nothing_leaves_the_sheet_no_text_is_small_and_none_is_on_a_panel(figure, style, share):
    drawn = FIGURES[figure].render(FIGURES[figure].machines[0], SIZE)
    composed = sheet(drawn, "pdf", style=style, width=share * STYLES[style].width)
    assert composed.height <= STYLES[style].height(composed.width) + 1e-6
    if style != "paper":
        assert composed.height / composed.width == pytest.approx(9 / 16)
    for panel in composed.panels:
        assert min(panel.x, panel.y) >= 0 and panel.x + panel.width <= composed.width + 1e-6
        assert panel.y + panel.height < composed.height
    for line in composed.lines:
        length = line.font.width(line.text)
        assert line.font.points >= LEAST_POINTS
        assert line.x >= 0 and 0 < line.y < composed.height
        if line.upright:
            assert line.y - length >= 0
            continue
        assert line.x + length <= composed.width, line.text
        for panel in composed.panels:
            inside = panel.y < line.y < panel.y + panel.height
            beside = line.x + length <= panel.x or line.x >= panel.x + panel.width
            assert not inside or beside, line.text


def area(width, height, notes=(0.0, 0.0, 3.0), ratio=1.0):
    return Area(width, height, 1.0, 2.5, 3.5, 3.5, notes, ratio)


def test_rows_of_small_panels_are_broken_where_that_makes_them_larger():
    narrow = area(85.0, 200.0, (0.0,))
    arrangement = arrange(narrow, 4)
    assert arrangement.panels == 2 and arrangement.height > 1.5 * (85 - 7) / 4
    assert len({x for x, _ in place(narrow, 4, arrangement)[0].panels}) == 2
    assert arrange(narrow, 5).panels == 3
    # Not where they are large enough, nor where the page is too low for two rows, nor three panels.
    assert arrange(area(200.0, 400.0, (0.0,)), 4).panels == 4
    assert arrange(area(85.0, 30.0, (0.0,)), 4).panels == 4
    assert arrange(narrow, 3).panels == 3


def test_pictures_of_one_panel_stand_side_by_side_and_rows_one_above_the_other():
    assert arrange(area(170.0, 240.0), 1).pictures == 3
    assert arrange(area(170.0, 240.0), 3).pictures == 1
    assert arrange(area(310.0, 150.0, (0.0, 0.0)), 3).pictures == 1
    four = area(170.0, 240.0, (0.0,) * 4)
    assert arrange(four, 1).pictures == 2
    for columns in range(1, 6):
        for room in (area(170.0, 200.0), area(310.0, 140.0), four, area(170.0, 200.0, ratio=1.6)):
            arrangement = arrange(room, columns)
            corners = [corner for p in place(room, columns, arrangement) for corner in p.panels]
            assert height_of(room, columns, arrangement) <= room.height + 1e-9
            assert max(x for x, _ in corners) + arrangement.width <= room.width + 1e-9
            assert max(y for _, y in corners) + arrangement.height <= room.height + 1e-9
            assert arrangement.width == pytest.approx(room.ratio * arrangement.height)
            if arrangement.panels < columns:
                assert replace(arrangement, panels=columns) != arrangement and arrangement.height < 2 * SMALL


def wide_scene(profile, size):
    (panel,) = row_of_panels(1, size, (8, 5))
    return (panel.clear((0.2, 0.4, 0.6)),)


def test_a_panel_that_is_wider_than_high_stays_so():
    method = Method("a clear", wide_scene, ("GEFORCE_256",))
    figure = Figure(
        id="X90", title="Wide", caption="", must_see="", source="KautzSeidel2000", techniques=(), size=40,
        aspect=(8, 5), methods=(method,), acceptance=lambda figure, renderer: (),
    )  # fmt: skip
    assert figure.dimensions() == (64, 40) and figure.dimensions(33) == (53, 33)
    drawn = figure.render("GEFORCE_256")
    assert drawn.image().shape == (40, 64, 4)
    composed = sheet(drawn, "png")
    for panel in composed.panels:
        assert panel.pixels.shape == (40, 64, 3)
        assert panel.width == pytest.approx(1.6 * panel.height)
    page = np.asarray(Image.open(io.BytesIO(file_of(composed, "png"))).convert("RGB"))
    assert spots(page, drawn.image()[..., :3], composed.scale)
    with pytest.raises(ValueError, match="give width and height, whole numbers"):
        replace(figure, aspect=(1.6, 1))


def test_a_difference_that_is_none_is_written(spheres):
    black = dict.fromkeys(("diffuse", "ambient", "specular", "background"), (0.0,) * 3)
    drawn = FIGURES["F004-4"].render("GEFORCE_256", SIZE, slices=8, stacks=6, **black)
    assert drawn.difference.identical
    composed = sheet(drawn, "pdf")
    assert {panel.picture for panel in composed.panels} == {"machine", "ideal"}
    (line,) = (line for line in composed.lines if "identical" in line.text)
    assert line.text.startswith("GeForce 256 and ideal are identical")
    assert not [line for line in sheet(spheres, "pdf").lines if "identical" in line.text]
    with pytest.raises(Refusal, match="Nothing is left to be drawn"):
        sheet(drawn, "pdf", pictures=("difference",))


def test_a_reference_is_shown_where_there_is_one(with_reference):
    usual = names_of(with_reference.figure, with_reference.profile)
    assert usual == ("machine", "reference", "reference-difference")
    composed = sheet(with_reference, "pdf", pictures=("machine", "reference", "reference-difference"))
    shown = [panel.picture for panel in composed.panels]
    assert shown == ["machine", "machine", "reference", "reference-difference"]
    assert (composed.panels[2].pixels == 128).all()
    expected = with_reference.reference_difference.image()[:, :SIZE, :3]
    np.testing.assert_array_equal(composed.panels[3].pixels, expected)
    texts = [line.text for line in composed.lines]
    assert [text for text in texts if text.startswith("(GeForce 256 \N{MINUS SIGN} reference)")]
    assert [text for text in texts if text.startswith("difference from")]


def test_a_diagram_is_shown_alone_and_so_is_any_figure_on_a_slide(spheres, with_reference):
    diagram = FIGURES["F000-6"]
    assert names_of(diagram, PROFILES[diagram.machines[0]]) == ("machine",)
    assert names_of(spheres.figure, spheres.profile) == ("machine", "ideal", "difference")
    assert names_of(spheres.figure, PROFILES["IDEAL"]) == ("ideal",)
    for drawn in (spheres, with_reference):
        composed = sheet(drawn, "pdf", style="slide")
        assert {panel.picture for panel in composed.panels} == {"machine"}
        # The row of two panels is as wide as the slide's margins and its text allow.
        room = composed.height - 2 * composed.style.margin
        assert composed.panels[0].height > 0.6 * room


def test_five_panels_on_a_slide_stand_in_two_rows_where_that_makes_them_larger():
    area = Area(320.0, 150.0, 2.0, 4.0, 6.0, 6.0, (0.0,))
    whole, broken = arrange(area, 5), arrange(area, 5, math.inf)
    assert (whole.panels, broken.panels) == (5, 3) and broken.height > 1.1 * whole.height


LETTERS = (
    {"runs": [["\u03b1", 0]], "x": 8.0, "y": 10.0, "size": 1.0, "color": "#ff0000", "align": [0, 0]},
    {"runs": [["s", 0], ["u", -1]], "x": 40.0, "y": 20.0, "size": 6.0, "color": "#00ff00", "align": [0, 0]},
)


def test_letters_stand_over_their_panels_in_seven_points_or_more(spheres):
    composed = sheet(spheres, "pdf", pictures=("machine", "difference"), letters=LETTERS)
    over = [line for line in composed.lines if line.over]
    assert [line.text for line in over] == ["\u03b1", "s", "u"]
    alpha, letter, index = over
    assert alpha.font.points == 7.0 and letter.font.points > 7.0
    assert index.font.points < letter.font.points and index.y > letter.y
    first, second = composed.panels[:2]
    pixel = first.height / SIZE
    assert abs(alpha.x + alpha.font.width(alpha.text) / 2 - (first.x + 8 * pixel)) < 1e-6
    assert second.x < letter.x < second.x + second.width
    assert not [line for line in sheet(spheres, "pdf").lines if line.over]


def test_letters_are_in_the_png_over_the_pixels(spheres):
    red = sheet(spheres, "png", pictures=("machine",), letters=LETTERS[:1])
    plain = sheet(spheres, "png", pictures=("machine",))
    with_letters, without = (
        np.asarray(Image.open(io.BytesIO(file_of(one, "png")))).astype(int) for one in (red, plain)
    )
    changed = np.nonzero((with_letters != without).any(-1))
    assert len(changed[0]) > 20
    panel, each = red.panels[0], red.dpi / 25.4
    middle = np.median(changed[1]) / each, np.median(changed[0]) / each
    pixel = panel.height / SIZE
    assert abs(middle[0] - (panel.x + 8 * pixel)) < 1.0 and abs(middle[1] - (panel.y + 10 * pixel)) < 1.0
    assert (with_letters[changed] == [255, 0, 0]).all(-1).any()


def test_a_sheet_says_that_twelve_bits_are_shown_as_bytes(spheres):
    drawn = FIGURES["F003-21"].render("INFINITE_REALITY", SIZE)
    assert "12 bits a component are shown as the nearest bytes" in sheet(drawn, "pdf").caption
    assert "nearest bytes" not in sheet(spheres, "pdf").caption


def test_the_ideal_has_one_picture():
    drawn = FIGURES["K14"].render("IDEAL", SIZE)
    composed = sheet(drawn, "png")
    assert [panel.picture for panel in composed.panels] == ["ideal"]
    with pytest.raises(Refusal, match="the ideal draws one picture"):
        sheet(drawn, "png", pictures=("machine",))


def test_pixels_are_never_merged(spheres):
    composed = sheet(spheres, "png", dpi=100.0)
    assert composed.panels[0].height / 25.4 * 100.0 == pytest.approx(composed.scale * SIZE)
    with pytest.raises(Refusal, match=r"Panels of 32 pixels have \d+ here at 36 dpi"):
        sheet(spheres, "png", width=50.0, dpi=36.0, pictures=("machine", "ideal"))


@pytest.mark.parametrize(
    ("asked", "sentence"),
    [
        ({"style": "poster"}, "There is no style 'poster'"),
        ({"width": 20.0}, "give 50 to 1000 for paper"),
        ({"dpi": 5.0}, "give 36 to 4800"),
        ({"pictures": ("machines",)}, "Did you mean machine"),
        ({"pictures": ("reference",)}, "the figure has no reference"),
        ({"pictures": ("ideal", "ideal")}, "name each once"),
        ({"pictures": ()}, "name each once"),
    ],
)
def test_what_cannot_be_composed_is_refused(spheres, asked, sentence):
    with pytest.raises(Refusal, match=sentence):
        sheet(spheres, "png", **asked)


def test_the_file_beside_it_says_what_was_drawn_and_cites(spheres):
    composed = sheet(spheres, "png")
    assert composed.bib.endswith("\n" + citation("KautzSeidel2000").bibtex)
    comments = [line for line in composed.bib.splitlines() if line.startswith("% ")]
    own = f"The figure with its own values: {FIGURES['F004-4'].caption}"
    assert comments[1] == f"% A variant, drawn with slices=8 stacks=6. {own}"
    command = "fixedpipe print F004-4 --profile GEFORCE_256 --size 32 --style paper --width 170"
    assert comments[-1] == f"% Drawn by: {command} --set slices=8 --set stacks=6"
    again = sheet(spheres, "png", dpi=400.0, pictures=("ideal", "machine")).command
    assert " --dpi 400 --pictures ideal,machine " in again
    assert not [line for line in comments if "@" in line]  # at which BibTeX would begin to read


@pytest.mark.parametrize("figure", FIGURES)
def test_every_figure_s_paper_is_cited_in_plain_words(figure):
    paper = citation(FIGURES[figure].source)
    assert paper.bibtex.startswith("@") and f"{{{paper.key},\n" in paper.bibtex
    assert paper.authors and paper.title and paper.year.isdigit()
    assert not re.search(r'[{}\\"]', paper.words)
