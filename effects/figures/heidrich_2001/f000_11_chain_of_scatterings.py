"""F000-11: a chain of scatterings as the graph of its passes, which is found in the commands that draw it."""

from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance import seen_places
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing, pass_graph
from fixedpipe.effects.diagrams.checks import missing_texts
from fixedpipe.effects.diagrams.drawing import BLUE, FAINT, GREEN, INK, YELLOW
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.scattering_ways import MACHINES, WAYS, largest_power, seen_picture, setup_of
from fixedpipe.effects.geometry.views import BACKGROUND, row_of_panels
from fixedpipe.effects.passes.draws import ADD
from fixedpipe.effects.scattering import dependent_tests
from fixedpipe.effects.scattering.dependent_tests import DIRECT, LIGHT, UP, Into
from fixedpipe.effects.scattering.height_field import check_light
from fixedpipe.effects.scattering.light_transport import bump
from fixedpipe.effects.scattering.made_fields import honeycomb
from fixedpipe.effects.scattering.visibility import free_view, precompute
from fixedpipe.pipeline.commands import Clear

DATA = figure_data(__file__, "F000-11")

ASPECT = (3, 1)
LOOKUPS = 3
# Offsets are signed bytes.
VALUES = {"offset textures, bumps lit at vertices": {"texels": 64}}
_BLACK = (0.0, 0.0, 0.0)
# Of the wax: so that no sum exceeds one.
_BRIGHTEST = 0.66

# Places in the sheet, which is two high and six wide: a step's middle, half its edge, and that of its S_k.
_STEPS_X = (-2.2, -0.72, 0.76, 2.24)
_STEP_Y, _STEP_HALF, _SEEN_Y, _SEEN_HALF = 0.0, 0.37, 0.72, 0.24
_ROUND_Y, _TEXT_Y, _LINE, _LETTERS = -0.47, -0.57, 0.1, 27


@lru_cache(4)
def _comb(texels, cells, depth, directions):
    field = honeycomb(texels, texels, cells, cells, depth)
    return field.with_albedo(_BRIGHTEST * field.albedo), precompute(field, np.array(directions))


def _setup(profile, size, p):
    field, visibility = _comb(largest_power(size // 4, p["texels"]), p["cells"], p["depth"], p["directions"])
    return setup_of(profile, field, visibility)


def chain(way, setup, light):
    """The frame: direct light, then at S_3, S_2 and S_1 the light so far, bumps, and direct light again; each
    step's result is also stored as a texture, named "step" and its number.
    """
    lit = free_view(setup.field, light)
    share = dependent_tests.share_of(setup)
    name = DIRECT
    out = [
        *way.load(setup, lit, tuple(range(LOOKUPS))),
        *(dependent_tests.black(setup, texture) for texture in (DIRECT, LIGHT)),
        *way.bumps(setup, light, UP, lit),
        *way.keep(setup, DIRECT),
        dependent_tests.copy_of(setup, setup.work, "step 0"),
    ]
    for step, k in enumerate(reversed(range(LOOKUPS)), 1):
        out += (
            *way.gathered(setup, k, UP, name, Into(setup.work)),
            dependent_tests.textured("plus the direct light", setup.work, DIRECT, share, blending=ADD),
        )
        if k:
            name = f"{LIGHT} {k}" if way.by_host else LIGHT
            out += way.keep(setup, name)
        out.append(dependent_tests.copy_of(setup, setup.work, f"step {step}"))
    return tuple(out)


# ------------------------------------------------------------------------------------------- the diagram


def _seen_name(k):
    return f"picture of S_{k}"


def _corners(x, y, half):
    return [(x - half, y - half), (x + half, y - half), (x + half, y + half), (x - half, y + half)]


def _boxed(label, view, x, y, half, texture, color):
    corners = _corners(x, y, half)
    return (
        drawing.picture(label, view, corners, texture),
        drawing.stroke(f"{label}: its box", view, [*corners, corners[0]], color, width=1.6),
    )


def short(label):
    """The first words of a command's label, as many as a column has room for."""
    words = label.split(":")[0].split(",")[0].split(" with l")[0]
    return words if len(words) <= _LETTERS else f"{words[: _LETTERS - 2]}.."


def edges(steps):
    """(from, to, kind) of the graph's arrows between steps.

    A kind is "looked up" if a step's picture is read at places that do not come from vertices, and "added" if
    it is drawn unchanged.
    """
    made, out = {}, []
    for number, step in enumerate(steps):
        for lookup in step.lookups:
            if lookup.picture in made:
                out.append((made[lookup.picture], number, "looked up" if lookup.dependent else "added"))
        made |= dict.fromkeys(step.kept, number)
    return list(dict.fromkeys(out))


def _arrows(view, steps):
    """The arrows from step to step."""
    out = []
    for start, end, kind in edges(steps):
        x0, x1 = _STEPS_X[start], _STEPS_X[end]
        if kind == "looked up":
            line = [(x0 + _STEP_HALF, _STEP_Y), (x1 - _STEP_HALF, _STEP_Y)]
            out.append(drawing.arrow("L is looked up by the next step", view, line, GREEN, width=2.6))
            middle = (0.5 * (line[0][0] + line[1][0]), _STEP_Y)
            out.append(drawing.text("L", view, middle, GREEN, align=(0, -1), offset=(0.0, 4.0)))
        else:
            low = _STEP_Y - _STEP_HALF
            line = [(x0, low), (x0, _ROUND_Y), (x1, _ROUND_Y), (x1, low)]
            out.append(drawing.arrow("direct light is added", view, line, BLUE, width=2.0))
    return out


def _texts_of(number, step, count):
    """What is written beside a step: its S_k if it has one, in a list, and a line for each command."""
    named = []
    if step.dependent:
        coordinates = step.dependent[0].coordinates
        by = "a texture" if isinstance(coordinates, pass_graph.Picture) else coordinates.value
        named.append(f"S_{count - 1 - number}\n{by}")
    return named, [short(c.label) for c in step.commands if not isinstance(c, Clear)]


def _column(view, number, step, count):
    """A step: its S_k and what is in it above, its picture, its commands below."""
    x, out = _STEPS_X[number], []
    named, lines = _texts_of(number, step, count)
    if named:
        k = count - 1 - number
        down = [(x, _SEEN_Y - _SEEN_HALF), (x, _STEP_Y + _STEP_HALF)]
        right = (x + _SEEN_HALF, _SEEN_Y + _SEEN_HALF)
        out += (
            *_boxed(f"S_{k} as a picture", view, x, _SEEN_Y, _SEEN_HALF, _seen_name(k), YELLOW),
            drawing.arrow("its texels are coordinates", view, down, YELLOW, width=2.6),
            drawing.text(named[0], view, right, YELLOW, align=(-1, 1), offset=(5.0, -2.0)),
        )
    out += _boxed(f"what step {number} leaves", view, x, _STEP_Y, _STEP_HALF, f"step {number}", INK)
    for row, line in enumerate(lines):
        at = (x - 0.62, _TEXT_Y - _LINE * row)
        out.append(drawing.text(line, view, at, FAINT if row else INK, align=(-1, 0)))
    return out


def diagram(panel, steps):
    """The graph of steps as a drawing."""
    view = drawing.sheet(panel)
    out = [drawing.load_font(), *_arrows(view, steps)]
    for number, step in enumerate(steps):
        out += _column(view, number, step, len(steps))
    return tuple(out)


def scene_by(way):
    """The scene by a machine's PathPasses: the frame, and its graph over it."""

    def scene(profile, size, *, background, light, **p):
        setup = _setup(profile, size, p)
        commands = chain(way, setup, tuple(check_light(light).tolist()))
        (panel,) = row_of_panels(1, size, ASPECT)
        return (
            *(seen_picture(_seen_name(k), setup, k) for k in range(LOOKUPS)),
            *commands,
            panel.clear(background),
            *diagram(panel, pass_graph.steps_of(commands, setup.work)),
        )

    return scene


# ---------------------------------------------------------------------------------------------- checks


def _expected(field, visibility, light):
    """What every step leaves, in float64: the first step's first."""
    direct = bump(field, light, UP) * free_view(field, light)[..., None]
    out = [direct]
    for k in reversed(range(LOOKUPS)):
        seen = visibility.seen[k]
        found = out[-1].reshape(-1, 3)[np.maximum(seen, 0)] * (seen >= 0)[..., None]
        out.append(direct + bump(field, visibility.directions[k], UP) * found)
    return out


def checks(figure, renderer):
    """The graph against the equation's, its steps counted, and the pictures in the boxes."""
    values, size = dict(figure.values_of(renderer.method)), figure.size
    light = tuple(check_light(values["light"]).tolist())
    setup = _setup(renderer.profile, size, values)
    steps = pass_graph.steps_of(chain(WAYS[renderer.method.name], setup, light), setup.work)
    lookups = sum(bool(step.dependent) for step in steps)
    for what, found, expected in (
        ("dependent lookups", lookups, LOOKUPS),
        ("bump-mapping steps", len(steps), LOOKUPS + 1),
    ):
        yield DATA.check(
            "{what} in the commands, from {expected}",
            abs(found - expected),
            Answer.MACHINE,
            what=what,
            expected=expected,
        )
    wanted = {(k, k + 1, "looked up") for k in range(LOOKUPS)} | {(0, k + 1, "added") for k in range(LOOKUPS)}
    yield DATA.check(
        "arrows between steps that are in the commands or in the equation, but not in both",
        len(wanted ^ set(edges(steps))),
        Answer.MACHINE,
    )
    expected = _expected(setup.field, setup.visibility, light)
    view, edge = drawing.sheet(row_of_panels(1, size, ASPECT)[0]), setup.field.columns
    for on in Answer:
        window, errors, brighter = renderer.window(on, figure, size), [], []
        for number, light_sent in enumerate(expected):
            low, high = (
                drawing.project(view, (_STEPS_X[number] + s * _STEP_HALF, _STEP_Y + s * _STEP_HALF))[:2]
                for s in (-1.0, 1.0)
            )
            # The pixel in the middle of each texel, but for those at the edge, on which the box is drawn.
            place = (np.arange(edge)[2:-2] + 0.5) / edge
            x, y = (np.floor(a + place * (b - a)).astype(int) for a, b in zip(low, high, strict=True))
            shown = window[np.ix_(y, x)]
            errors.append(root_mean_square(shown - light_sent[2:-2, 2:-2]))
            brighter.append(float(shown.mean()))
        yield DATA.check("largest RMS of a step's box - the same step in float64", max(errors), on)
        yield DATA.check(
            "what the last step leaves, over what the first does, mean", brighter[-1] / brighter[0], on
        )
    yield from _graph_checks(figure, renderer, steps, setup)


def _in_its_box(window, view, number, edge):
    """The pixels of a step's S_k within its box's stroke, and which rows and columns of texels they show."""
    x, y, half = _STEPS_X[number], _SEEN_Y, _SEEN_HALF
    low, high = (drawing.project(view, (x + s * half, y + s * half))[:2] for s in (-1.0, 1.0))
    ends = list(zip(low, high, strict=True))
    at = [np.arange(int(np.ceil(a)) + 3, int(np.floor(b)) - 3) for a, b in ends]
    column, row = (
        np.floor((k + 0.5 - a) / (b - a) * edge).astype(int) for k, (a, b) in zip(at, ends, strict=True)
    )
    return window[np.ix_(at[1], at[0])], row, column


def _graph_checks(figure, renderer, steps, setup):
    """The texts of the graph, and each S_k's picture."""
    texts, size = ["L"] * LOOKUPS, figure.size
    for number, step in enumerate(steps):
        named, lines = _texts_of(number, step, len(steps))
        texts += [text.replace("\n", " ") for text in (*named, *lines)]
    yield DATA.check(
        "texts of the graph that are not written", missing_texts(figure, renderer, texts), Answer.MACHINE
    )
    view = drawing.sheet(row_of_panels(1, size, ASPECT)[0])
    for on in Answer:
        window, shares = renderer.window(on, figure, size), []
        for number in range(1, LOOKUPS + 1):
            shown, row, column = _in_its_box(window, view, number, setup.field.columns)
            named = seen_places.named_texels(setup.visibility.seen[LOOKUPS - number])
            shares.append(seen_places.alike(shown, named[np.ix_(row, column)], seen_places.WITHIN))
        yield DATA.check(
            "pixels of an S_k that name the texel that is seen within 8/255, the least", min(shares), on
        )


FIGURE = Figure(
    **DATA.words,
    aspect=ASPECT,
    parameters={
        "texels": word.of(word.Whole(4, 128, power=True), 128, "The bump map's edge, at most.", "texels"),
        "cells": word.of(word.Whole(2, 8, even=True), 2, "Cells along an edge."),
        "depth": word.NUMBER(0.5, "How deep the cells are, of a cell's width.", low=0.0, high=1.5),
        "light": word.LIGHT((-0.62, 0.4, 1.0)),
        "directions": word.of(
            word.Several((word.DIRECTION_KIND,) * LOOKUPS),
            ((0.75, -0.55, 0.2), (0.95, 0.15, 0.15), (0.3, -0.9, 0.2)),
            "The directions d_0 to d_2 along which texels are seen.",
        ),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=tuple(
        Method(name, scene_by(way), MACHINES[name], VALUES.get(name, {})) for name, way in WAYS.items()
    ),
    acceptance=checks,
)
