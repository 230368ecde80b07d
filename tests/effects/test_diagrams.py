"""What diagrams are drawn with: where strokes, dots, polygons and letters are, to the pixel."""

import hashlib

import numpy as np
import pytest

from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.diagrams.drawing import INK, LINES, RED
from fixedpipe.effects.diagrams.flatland import Shape, crossings, first_hit, is_visible, pieces, shadow_volume
from fixedpipe.effects.geometry.views import Panel, perspective_view
from fixedpipe.effects.passes.draws import FIRST_PASS
from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import OPENGL_1_2
from fixedpipe.pipeline.state import PassState

SIZE = 64
PANEL = Panel(0, 0, SIZE, SIZE)
SHEET = drawing.sheet(PANEL)


def covered(*commands, size=SIZE, name="machine"):
    """Where something was drawn on black: bool [size, size], bottom row first."""
    commands = (Panel(0, 0, size, size).clear((0.0, 0.0, 0.0)), *commands)
    if name == "ideal":
        return execute_ideal(commands, size, size).color[::-1, :, :3].any(axis=-1)
    return execute(commands, OPENGL_1_2, size, size).framebuffer.color[::-1, :, :3].any(axis=-1)


def test_the_font_has_the_same_bits_everywhere():
    # Digests of figures rest on these bits; a pillow that has others must be seen here first.
    digest = hashlib.sha256(drawing.font_image().tobytes()).hexdigest()
    assert digest == "04d69db4efa7e32c773e3050b336d4481e99ffdafb0dff2d723a783998f1d4a8"


@pytest.mark.parametrize("scale", [1, 2])
def test_letters_are_the_fonts_pixels_magnified(scale):
    size = int(LINES * drawing.GLYPH_HEIGHT) * scale
    view = drawing.sheet(Panel(0, 0, size, size))
    assert drawing.magnification(view) == scale
    image = covered(drawing.load_font(), drawing.text("g", view, (0.0, 0.0), INK, align=(-1, -1)), size=size)
    k = ord("g") - 32
    glyph = drawing.font_image()[k // 16 * 16 :, k % 16 * 8 :, 1][:11, :6] > 0
    rows, columns = np.flatnonzero(image.any(axis=1)), np.flatnonzero(image.any(axis=0))
    # The panel's edge is odd, so that its middle is rounded up to a whole pixel.
    left = bottom = int(np.floor(size / 2 + 0.5))
    expected = glyph.repeat(scale, axis=0).repeat(scale, axis=1)
    assert np.array_equal(image[bottom : bottom + 11 * scale, left : left + 6 * scale], expected)
    assert image.sum() == expected.sum() and len(rows) and len(columns)


def test_a_label_is_aligned_and_its_lines_are_below_each_other():
    size = int(LINES * drawing.GLYPH_HEIGHT)
    view = drawing.sheet(Panel(0, 0, size, size))

    def box(**settings):
        drawn = covered(
            drawing.load_font(), drawing.text("HH\nH", view, (0.0, 0.0), INK, **settings), size=size
        )
        y, x = np.nonzero(drawn)
        return x.min() - size // 2, x.max() - size // 2, y.min() - size // 2, y.max() - size // 2

    left, right, lower, upper = box(align=(-1, 1))
    assert left >= 0 and right < 13 and upper <= 1 and lower >= -22
    left, right, lower, upper = box(align=(1, -1))
    assert left > -13 and right <= 1 and lower >= 0 and upper <= 23
    unit = size / drawing.UNIT
    moved = box(align=(1, -1), offset=(10.0 / unit, 20.0 / unit))
    assert np.array_equal(np.subtract(moved, (left, right, lower, upper)), (10, 10, 20, 20))


def test_an_outline_surrounds_the_letters_and_leaves_them_alone():
    size = int(LINES * drawing.GLYPH_HEIGHT)
    view = drawing.sheet(Panel(0, 0, size, size))
    plain = covered(drawing.load_font(), drawing.text("o", view, (0, 0), INK), size=size)
    commands = (
        Panel(0, 0, size, size).clear((0.0, 0.0, 0.0)),
        drawing.load_font(),
        drawing.text("o", view, (0, 0), INK, outline=RED),
    )
    image = execute(commands, OPENGL_1_2, size, size).framebuffer.color[::-1, :, :3]
    letters = image[..., 2] > 150
    assert np.array_equal(letters, plain)
    grown = plain.copy()
    for move, axis in ((-1, 0), (1, 0), (-1, 1), (1, 1)):
        grown |= np.roll(plain, move, axis)
    assert np.array_equal(image.any(axis=-1), grown)


@pytest.mark.parametrize("name", ["machine", "ideal"])
@pytest.mark.parametrize("width", [4.0, 12.0, 20.0])
def test_a_stroke_is_as_wide_as_asked_and_no_longer(width, name):
    drawn = covered(drawing.stroke("s", SHEET, [(-0.5, 0.0), (0.5, 0.0)], INK, width=width), name=name)
    pixels = width * SIZE / drawing.UNIT
    assert drawn.any(axis=0).sum() == SIZE // 2
    assert abs(drawn.any(axis=1).sum() - pixels) <= 1 and drawn.all(axis=1).sum() == 0


def test_no_stroke_is_thinner_than_a_pixel():
    drawn = covered(drawing.stroke("s", SHEET, [(-0.5, 0.013), (0.5, 0.013)], INK, width=0.01))
    assert np.array_equal(drawn.any(axis=1).sum(), 1) and drawn.any(axis=0).sum() == SIZE // 2


def test_a_closed_stroke_has_whole_corners():
    square = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5)]
    drawn = covered(drawing.stroke("s", SHEET, square, INK, width=16.0))
    y, x = np.nonzero(drawn)
    assert drawn[y.min() : y.max() + 1, x.min()].all() and drawn[y.min(), x.min() : x.max() + 1].all()
    assert drawn[y.max(), x.min() : x.max() + 1].all() and drawn[y.min() : y.max() + 1, x.max()].all()
    assert not drawn[SIZE // 2, SIZE // 2]


def test_dashes_are_as_long_as_asked():
    dash = (16.0, 8.0)
    drawn = covered(drawing.stroke("s", SHEET, [(-0.75, 0.0), (0.75, 0.0)], INK, dash=dash, width=8.0))
    row = drawn.any(axis=0)[SIZE // 8 : -SIZE // 8]
    expected = (np.arange(len(row)) % 6) < 4
    assert np.array_equal(row, expected)


def test_dashes_go_round_corners():
    whole = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5)]
    pieces = drawing._dashed(drawing.project(SHEET, whole), 10.0, 3.0)
    lengths = [np.sqrt((np.diff(p[:, :2], axis=0) ** 2).sum(axis=1)).sum() for p in pieces]
    assert np.allclose(lengths, 10.0) and len(lengths) == 5
    assert any(len(p) == 3 for p in pieces)


def test_an_arrow_ends_in_its_tip():
    drawn = covered(drawing.arrow("a", SHEET, [(-0.5, 0.0), (0.5, 0.0)], INK, head=40.0, width=8.0))
    columns, tip = drawn.sum(axis=0), SIZE * 3 // 4
    # The tip itself is too thin for the centre of the last pixel.
    assert tip - 3 <= drawn.any(axis=0).nonzero()[0].max() < tip
    assert columns[tip - 3] <= 2 and columns.argmax() == tip - 10 and columns[tip - 11] == 2
    with pytest.raises(ValueError, match="no length"):
        drawing.arrow("a", SHEET, [(0.5, 0.0), (0.5, 0.0)], INK)


def test_an_arc_lies_on_its_circle():
    points = drawing.arc((0.1, 0.2), 30.0, 120.0, (0.5, 0.0), (0.0, 0.5))
    assert np.abs(np.hypot(*(points - (0.1, 0.2)).T) - 0.5).max() < 1e-6
    assert np.degrees(np.arctan2(*(points[[0, -1]] - (0.1, 0.2)).T[::-1])) == pytest.approx([30.0, 120.0])


def test_things_are_where_the_scenes_vertices_are():
    view = perspective_view(PANEL, (3.0, 2.0, 4.0), (0.2, 0.1, -0.3))
    points = np.array([(0.0, 0.0, 0.0), (1.0, 0.3, 0.2), (-0.4, 0.8, -1.0)])
    drawn = covered(drawing.polygon("by pixels", view, points, INK))
    state = PassState(vertex=view.vertex)
    assert np.array_equal(drawn, covered(Draw(label="by the machine", mesh=Mesh(points), state=state)))
    assert drawn.sum() > 100


def test_what_lies_behind_is_hidden_and_what_lies_on_a_surface_is_seen():
    view = perspective_view(PANEL, (0.0, 3.0, 3.0))
    floor = [(-1, 0, -1), (1, 0, -1), (1, 0, 1), (-1, 0, 1)]
    drawn = drawing.polygon("floor", view, floor, (0.2, 0.2, 0.2), depth_test=FIRST_PASS)

    def red(height, *hiding):
        line = [(-0.5, height, 0.5), (0.5, height, -0.5)]
        commands = (
            PANEL.clear((0.0, 0.0, 0.0)),
            *hiding,
            drawing.stroke("line", view, line, RED, depth_test=drawing.VISIBLE),
        )
        return (execute(commands, OPENGL_1_2, SIZE, SIZE).framebuffer.color[..., 0] > 128).sum()

    assert red(-0.3, drawn) == 0 < red(-0.3)
    assert red(0.0, drawn) == red(0.0) > 0 and red(0.3, drawn) == red(0.3) > 0


def test_a_translucent_polygon_lets_half_through():
    whole = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    commands = (PANEL.clear((0.0, 0.0, 1.0)), drawing.polygon("p", SHEET, whole, (1.0, 0.0, 0.0), alpha=0.5))
    color = execute(commands, OPENGL_1_2, SIZE, SIZE).framebuffer.color[..., :3]
    assert np.abs(color.astype(int) - (128, 0, 127)).max() <= 1


def test_what_cannot_be_drawn_is_refused():
    view = perspective_view(PANEL, (0.0, 0.0, 4.0))
    with pytest.raises(ValueError, match="behind the eye"):
        drawing.stroke("s", view, [(0, 0, 0), (0, 0, 5)], INK)
    with pytest.raises(ValueError, match="no length"):
        drawing.stroke("s", SHEET, [(0, 0), (0, 0)], INK)
    with pytest.raises(ValueError, match="Greek"):
        drawing.text("\u03b1", SHEET, (0, 0), INK)
    with pytest.raises(ValueError, match="finite"):
        drawing.dots("d", SHEET, (0.0, float("nan")), INK)


SQUARE = Shape("square", ((1.0, -1.0), (3.0, -1.0), (3.0, 1.0), (1.0, 1.0)))


def test_a_ray_enters_a_shape_and_leaves_it():
    entering, leaving = crossings((0.0, 0.0), (2.0, 0.5), (SQUARE,))
    assert entering.enters and entering.point == (1.0, 0.25) and entering.parameter == 0.5
    assert not leaving.enters and leaving.point == (3.0, 0.75) and leaving.shape is SQUARE
    assert first_hit((0.0, 0.0), (2.0, 0.5), (SQUARE,)) == entering
    assert first_hit((0.0, 0.0), (-2.0, 0.5), (SQUARE,)) is None
    # From inside it is only left; through a corner it is entered once.
    assert [c.enters for c in crossings((2.0, 0.0), (3.0, 0.5), (SQUARE,))] == [False]
    assert [c.enters for c in crossings((0.0, -2.0), (1.0, -1.0), (SQUARE,))] == [True, False]


def test_a_shadow_volume_holds_what_its_shape_hides():
    source = (0.0, 0.25)
    volume = shadow_volume(SQUARE, source, 20.0)
    places = [(x / 4.0, y / 4.0) for x in range(1, 40, 3) for y in range(-9, 10, 2)]
    behind = [point for point in places if not is_visible(point, source, (SQUARE,))]
    assert behind and [point for point in places if volume.contains(point)] == behind


def test_an_outline_is_divided_into_parts_of_its_length():
    parts = pieces(SQUARE, 4)
    assert len(parts) == 32 and np.array_equal(parts[1:, 0], parts[:-1, 1])
    assert np.array_equal(parts[-1, 1], parts[0, 0])
