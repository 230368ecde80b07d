"""F000-12: the pass of a dependent lookup as a diagram of the state that draws it: p to S_i, q to L_d."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance import seen_places
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing, pass_graph
from fixedpipe.effects.diagrams.checks import missing_texts
from fixedpipe.effects.diagrams.drawing import BLUE, GREEN, INK, YELLOW
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.scattering_ways import MACHINES, WAYS, largest_power, seen_picture, setup_of
from fixedpipe.effects.geometry.views import BACKGROUND, row_of_panels
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.scattering import combiner_bumps, dependent_tests
from fixedpipe.effects.scattering.dependent_tests import DIRECT, UP, Into
from fixedpipe.effects.scattering.height_field import check_light
from fixedpipe.effects.scattering.light_transport import bump
from fixedpipe.effects.scattering.made_fields import honeycomb
from fixedpipe.effects.scattering.visibility import free_view, precompute
from fixedpipe.pipeline.commands import Draw, DrawPixels, TexImage
from fixedpipe.pipeline.textures.images import texture_2d

DATA = figure_data(__file__, "F000-12")

ASPECT = (2, 1)
# Pictures of what a pass reads and leaves.
SEEN, NORMALS, ALBEDO, LIGHT, RESULT = (
    f"picture of {what}" for what in ("S_i", "n", "the albedo", "L_d", "the result")
)
# Places in the sheet, which is two high and four wide: columns of what is read by the vertices' coordinates,
# of what is read by these texels, of what combines them, and of the result; rows of the first.
_COLUMNS = (-1.05, -0.02, 0.82, 1.56)
_ROWS = (0.61, -0.04, -0.69)
_HALF, _RESULT_HALF = 0.25, 0.36
_VERTICES_X = -1.78


@dataclass(frozen=True)
class Box:
    """A box of the diagram: its place, the picture in it, its words, and the box whose texels are its
    coordinates, None: the vertices.
    """

    x: float
    y: float
    picture: str
    words: str
    addressed_by: int | None
    combined: bool


@lru_cache(2)
def _comb(texels, cells, depth, direction):
    field = honeycomb(texels, texels, cells, cells, depth)
    return field, precompute(field, np.array([direction]))


def _setup(profile, size, p):
    field, visibility = _comb(largest_power(size // 4, p["texels"]), p["cells"], p["depth"], p["direction"])
    return setup_of(profile, field, visibility)


def frame(way, setup, light):
    """The passes, and those of the dependent lookup among them.

    They draw and keep direct light, then bumps with light along d_i times the direct light at S_i.
    """
    lit = free_view(setup.field, light)
    gathered = way.gathered(setup, 0, UP, DIRECT, Into(setup.work))
    commands = (
        *way.load(setup, lit, (0,)),
        dependent_tests.black(setup, DIRECT),
        *way.bumps(setup, light, UP, lit),
        *way.keep(setup, DIRECT),
        dependent_tests.copy_of(setup, setup.work, LIGHT),
        *gathered,
        dependent_tests.copy_of(setup, setup.work, RESULT),
    )
    return commands, gathered


def _pictures(setup):
    """What the boxes show of images and textures that are no colours."""
    field = setup.field
    shown = ((NORMALS, 0.5 + 0.5 * field.normals), (ALBEDO, field.albedo))
    return (
        seen_picture(SEEN, setup, 0),
        *(
            TexImage(
                label=f"load the {name}", texture=name, image=texture_2d(factor_texels(v, setup.profile))
            )
            for name, v in shown
        ),
    )


_BY_NAME = {"S_0": SEEN, combiner_bumps.NORMALS: NORMALS, combiner_bumps.ALBEDO: ALBEDO, DIRECT: LIGHT}


def boxes_of_units(command):
    """The Boxes of a Draw's texture units, in their order."""
    state, rows, out = command.state, iter(_ROWS), []
    versions = pass_graph.lookups_of(command, lambda name: pass_graph.Picture(name, 0))
    combined = pass_graph.textures_combined(state.register_combiners)
    for number, lookup in enumerate(versions):
        address = None
        if lookup.dependent:
            address = [each.picture for each in versions].index(lookup.coordinates)
        x = _COLUMNS[0] if address is None else _COLUMNS[1]
        y = next(rows) if address is None else out[address].y
        picture = _BY_NAME[lookup.picture.name]
        words = f"unit {number}: {picture.removeprefix('picture of ')}"
        out.append(Box(x, y, picture, words, address, number in combined))
    return out


def boxes_of_images(commands):
    """The Boxes of images that are drawn one over the other, the last by way of a pixel texture."""
    drawn = [command for command in commands if isinstance(command, DrawPixels)]
    plain = [command for command in drawn if command.pixel_texture is None]
    out = []
    for command, picture, y in zip(plain, (NORMALS, ALBEDO), _ROWS[1:], strict=True):
        words = command.label.split(":")[0].split(" with l")[0]
        out.append(Box(_COLUMNS[0], y, picture, words, None, True))
    (last,) = (command for command in drawn if command.pixel_texture is not None)
    (looked_up,) = pass_graph.lookups_of(last, lambda name: pass_graph.Picture(name, 0))
    out.append(Box(_COLUMNS[0], _ROWS[0], SEEN, "S_i, an image", None, False))
    picture = _BY_NAME[looked_up.picture.name]
    out.append(Box(_COLUMNS[1], _ROWS[0], picture, "pixel texture: L_d", len(out) - 1, True))
    return out


def boxes(commands):
    """The Boxes of the passes of a dependent lookup, and how their results are combined."""
    draws = [command for command in commands if isinstance(command, Draw)]
    if draws:
        (command,) = draws
        return boxes_of_units(command), f"{len(command.state.register_combiners.general)} general\ncombiners"
    return boxes_of_images(commands), "blending"


def _boxed(view, box, half, color):
    corners = [(box.x + i * half, box.y + j * half) for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    return (
        drawing.picture(box.words, view, corners, box.picture),
        drawing.stroke(f"{box.words}: its box", view, [*corners, corners[0]], color, width=1.6),
        drawing.text(box.words, view, corners[3], color, align=(-1, -1), offset=(0.0, 3.0)),
    )


def diagram(panel, found, combining):
    """The boxes, arrows of coordinates, yellow, and of colours, green."""
    view, out = drawing.sheet(panel), [drawing.load_font()]
    plain = [box for box in found if box.addressed_by is None]
    middle = sum(box.y for box in plain) / len(plain)
    for box in plain:
        line = [(_VERTICES_X + 0.17, middle), (box.x - _HALF, box.y)]
        out.append(drawing.arrow("the place of p", view, line, YELLOW, width=2.2))
    out.append(drawing.text("p\n(s, t)", view, (_VERTICES_X, middle), YELLOW))
    x, low, high = _COLUMNS[2], _ROWS[-1] - 0.2, _ROWS[0] + 0.2
    for box in found:
        if box.addressed_by is not None:
            source = found[box.addressed_by]
            line = [(source.x + _HALF, source.y), (box.x - _HALF, box.y)]
            out.append(drawing.arrow("its texels are the place of q", view, line, YELLOW, width=2.6))
            at = 0.5 * (np.array(line[0]) + np.array(line[1]))
            out.append(drawing.text("q", view, at, YELLOW, align=(0, -1), offset=(0.0, 5.0)))
        if box.combined:
            line = [(box.x + _HALF, box.y), (x - 0.17, box.y)]
            out.append(drawing.arrow("colours", view, line, GREEN, width=2.6))
        out += _boxed(view, box, _HALF, YELLOW if not box.combined else INK)
    block = [(x - 0.17, low), (x + 0.17, low), (x + 0.17, high), (x - 0.17, high)]
    out += (
        drawing.stroke("what combines the colours", view, [*block, block[0]], BLUE, width=1.6),
        drawing.text(combining, view, (x, high), BLUE, align=(0, -1), offset=(0.0, 3.0)),
        drawing.text("x", view, (x, 0.5 * (low + high)), BLUE),
    )
    result = Box(_COLUMNS[3], 0.5 * (low + high), RESULT, "framebuffer", None, True)
    line = [(x + 0.17, result.y), (result.x - _RESULT_HALF, result.y)]
    out.append(drawing.arrow("the product", view, line, GREEN, width=2.6))
    return (*out, *_boxed(view, result, _RESULT_HALF, INK))


def scene_by(way):
    """The scene by a machine's PathPasses: the frame, and its last pass as a diagram over it."""

    def scene(profile, size, *, background, light, **p):
        setup = _setup(profile, size, p)
        commands, gathered = frame(way, setup, tuple(check_light(light).tolist()))
        (panel,) = row_of_panels(1, size, ASPECT)
        return (
            *_pictures(setup),
            *commands,
            panel.clear(background),
            *diagram(panel, *boxes(gathered)),
        )

    return scene


# ---------------------------------------------------------------------------------------------- checks


def _in_its_box(window, view, box, half, edge):
    """The pixel in the middle of each texel of a box, but for those at the edge, where the box is drawn."""
    low, high = (drawing.project(view, (box.x + s * half, box.y + s * half))[:2] for s in (-1.0, 1.0))
    place = (np.arange(edge)[3:-3] + 0.5) / edge
    columns, rows = (np.floor(a + place * (b - a)).astype(int) for a, b in zip(low, high, strict=True))
    return window[np.ix_(rows, columns)]


def _side_apart(window, view, box):
    """How far a box's four sides are from their line's colour, away from corners and arrows: the largest."""
    color, apart = np.array(INK if box.combined else YELLOW), 0.0
    for along, across in ((0.5, 1.0), (0.5, -1.0), (1.0, 0.5), (-1.0, 0.5)):
        x, y = drawing.project(view, (box.x + along * _HALF, box.y + across * _HALF))[:2]
        apart = max(apart, float(np.abs(window[int(y), int(x)] - color).max()))
    return apart


def checks(figure, renderer):
    """What addresses what, and the pictures in the boxes against float64."""
    values, size = dict(figure.values_of(renderer.method)), figure.size
    light = tuple(check_light(values["light"]).tolist())
    setup = _setup(renderer.profile, size, values)
    _, gathered = frame(WAYS[renderer.method.name], setup, light)
    found, combining = boxes(gathered)
    addressed = [
        (found[box.addressed_by].picture, box.picture) for box in found if box.addressed_by is not None
    ]
    yield DATA.check(
        "lookups whose place is a texel, other than L_d at S_i",
        len(addressed) - addressed.count((SEEN, LIGHT)) + abs(addressed.count((SEEN, LIGHT)) - 1),
        Answer.MACHINE,
    )
    combined = {box.picture for box in found if box.combined}
    yield DATA.check(
        "pictures that are combined, or are not, otherwise than in bump(d_i) L_d[S_i]",
        len(combined ^ {NORMALS, ALBEDO, LIGHT}),
        Answer.MACHINE,
    )
    field, (seen,) = setup.field, setup.visibility.seen
    direct = bump(field, light, UP) * free_view(field, light)[..., None]
    there = direct.reshape(-1, 3)[np.maximum(seen, 0)] * (seen >= 0)[..., None]
    product = bump(field, setup.visibility.directions[0], UP) * there
    (looked_up,) = (box for box in found if box.picture == LIGHT)
    middle = 0.5 * (_ROWS[-1] + _ROWS[0])
    view, edge = drawing.sheet(row_of_panels(1, size, ASPECT)[0]), field.columns
    for on in Answer:
        window = renderer.window(on, figure, size)
        for name, box, half, expected in (
            ("L_d", looked_up, _HALF, direct),
            ("the result", Box(_COLUMNS[3], middle, RESULT, "", None, True), _RESULT_HALF, product),
        ):
            yield DATA.check(
                "RMS of {name} in its box - float64",
                root_mean_square(_in_its_box(window, view, box, half, edge) - expected[3:-3, 3:-3]),
                on,
                name=name,
            )
        shown = {
            SEEN: seen_places.named_texels(seen),
            NORMALS: 0.5 + 0.5 * field.normals,
            ALBEDO: field.albedo,
        }
        shares = [
            seen_places.alike(
                _in_its_box(window, view, box, _HALF, edge),
                shown[box.picture][3:-3, 3:-3],
                seen_places.WITHIN,
            )
            for box in found
            if box.picture in shown
        ]
        yield DATA.check(
            "texels of S_i, n and the albedo in their boxes within 8/255, the least", min(shares), on
        )
        yield DATA.check(
            "sides of boxes in the colour of coordinates or of what is combined, largest difference",
            max(_side_apart(window, view, box) for box in found),
            on,
        )
    texts = ["p (s, t)", "x", "framebuffer", combining.replace("\n", " "), *(box.words for box in found)]
    yield DATA.check(
        "texts of the diagram that are not written", missing_texts(figure, renderer, texts), Answer.MACHINE
    )
    yield DATA.check("share of texels that see another along d_i", float((seen >= 0).mean()), Answer.IDEAL)


_NAMES = ("texture shaders", "color matrix and pixel textures")

FIGURE = Figure(
    **DATA.words,
    aspect=ASPECT,
    parameters={
        "texels": word.of(word.Whole(4, 128, power=True), 128, "The bump map's edge, at most.", "texels"),
        "cells": word.of(word.Whole(2, 8, even=True), 2, "Cells along an edge."),
        "depth": word.NUMBER(0.5, "How deep the cells are, of a cell's width.", low=0.0, high=1.5),
        "light": word.LIGHT((-0.62, 0.4, 1.0)),
        "direction": word.of(
            word.DIRECTION_KIND, (0.75, -0.5, 0.25), "The direction d_i along which texels are seen."
        ),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=tuple(Method(name, scene_by(WAYS[name]), MACHINES[name]) for name in _NAMES),
    acceptance=checks,
)
