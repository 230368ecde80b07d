"""F003-21: not enough bias, the right one, too much (Z12)."""

import numpy as np

from fixedpipe.effects.acceptance import agreement
from fixedpipe.effects.figures.figure import BACKGROUND, Check, Figure, Method
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.geometry.views import Panel, perspective_view, row_of_panels
from fixedpipe.effects.scenes.objects_and_lamps import (
    FLOOR_HALF_WIDTH,
    Object,
    Scene,
    detail_of,
    floor,
    lamp_around,
    still_life,
)
from fixedpipe.effects.shadows.lit_scene import map_edge
from fixedpipe.effects.shadows.shadow_maps import OFFSET_UNITS, modulated_passes, store_map

LAMP_POSITION = (-6.2, 7.0, 3.2)
# The board: turned about y, so thin that its shadow begins at its foot on either side.
BOARD_TURN, BOARD_PLACE, BOARD_WIDTH, BOARD_HEIGHT, BOARD_THICKNESS = 62.0, (-0.2, -0.55), 1.9, 1.15, 0.03


def scene_of(size):
    """A ring and a thin board on the floor, and a lamp."""
    objects = {thing.name: thing for thing in still_life(detail_of(size)).objects}
    x, z = BOARD_PLACE
    board = surfaces.box(BOARD_WIDTH, BOARD_HEIGHT, BOARD_THICKNESS).rotated(rotation("y", BOARD_TURN))
    scene = Scene(
        (
            Object("floor", floor(FLOOR_HALF_WIDTH, 12), objects["floor"].color, closed=False),
            objects["ring"],
            Object("board", board.moved(x, 0.5 * BOARD_HEIGHT, z), (0.34, 0.52, 0.34), 0.1),
            Object("sphere", objects["sphere"].surface, objects["sphere"].color, 0.7),
        )
    )
    return scene, lamp_around(scene, LAMP_POSITION)


def view_of(panel):
    """The feet of what stands there, and their shadows."""
    return perspective_view(panel, (0.8, 3.9, 6.6), (-0.03, 0.3, 0.1), field_of_view=37.0, radius=4.5)


def make(profile, size, *, ratio, offsets, shading="lit"):
    """The same map once for each of the offsets (factor, units) by which it is moved away from the light."""
    count = len(offsets)
    panels, edge = row_of_panels(count, size), map_edge(size, ratio)
    scene, lamp = scene_of(size)
    out = []
    for panel, (factor, units) in zip(panels, offsets, strict=True):
        view = view_of(panel)
        out += (
            *store_map(scene, lamp, "shadow map", edge, (count * size, size), factor=factor, units=units),
            panel.clear(BACKGROUND),
            *modulated_passes(scene, view, lamp, "shadow map", profile, shading),
        )
    return tuple(out)


def acne(mask, truth):
    """The fraction of the floor that rays find lit, away from shadows' edges, and the mask dark."""
    ground = truth.shown.object == 0
    inside = ground & truth.lit
    for axis in (0, 1):
        for by in (-2, -1, 1, 2):
            inside &= np.roll(truth.lit | ~ground, by, axis)
            inside &= np.roll(ground, by, axis)
    return float((~mask[inside]).mean())


def gap(mask, truth, edge):
    """How far behind the board's foot its shadow begins, in texels of a map of ``edge``: float.

    For each place on the floor that the board shades and the mask has lit, the way from the foot to it along
    the shadow, as long as the map sees it; the greatest of the least 95 in 100, 0 where there is none. Only
    the first 0.9 world units are looked at: a wider gap is one of at least these.
    """
    shown, lamp = truth.shown, truth.lamp
    normal = np.array([np.sin(np.radians(BOARD_TURN)), 0.0, np.cos(np.radians(BOARD_TURN))])
    across = np.array([normal[2], 0.0, -normal[0]])
    points = shown.points - np.array([BOARD_PLACE[0], 0.0, BOARD_PLACE[1]])
    along = shown.points - np.array(lamp.position)
    along[..., 1] = 0.0
    along = normalize(along)
    way = (dot(points, normal) - 0.5 * BOARD_THICKNESS) / dot(along, normal)
    foot = points - way[..., None] * along
    # Behind the middle of the board, where nothing else throws a shadow.
    behind = (shown.object == 0) & (way > 0.0) & (np.abs(dot(foot, across)) < 0.35 * BOARD_WIDTH)
    behind &= ~truth.lit & (way < 0.9)
    leaks = behind & mask
    if not leaks.any():
        return 0.0
    matrix = np.array(lamp.texture_matrix)

    def place(p):
        s, t, _, q = (p @ row[:3] + row[3] for row in matrix)
        return np.stack([s / q, t / q], axis=-1)

    here = shown.points[leaks]
    length = np.linalg.norm(place(here) - place(here - way[leaks][:, None] * along[leaks]), axis=-1)
    return float(np.percentile(length * edge, 95.0))


_SIZE = 256


def checks(figure, renderer):
    """Speckle on the lit floor, and the gap between the board and its shadow."""
    scene, lamp = scene_of(_SIZE)
    truth = agreement.truth_of(scene, view_of(Panel(0, 0, _SIZE, _SIZE)), lamp)
    edge = map_edge(_SIZE, figure.parameters["ratio"])
    out = []
    for on in ("ideal", "machine"):
        picture = getattr(renderer, on)(figure, _SIZE, shading="mask")
        masks = [agreement.lit_mask(picture[:, k * _SIZE : (k + 1) * _SIZE]) for k in range(3)]
        said = "the catalogue's acceptance"
        little, right, much = (acne(mask, truth) for mask in masks)
        gaps = [gap(mask, truth, edge) for mask in masks]
        found = agreement.compare(masks[1], truth, map_edge=edge, where=truth.shown.object == 0)
        out += (
            Check("not enough: lit floor that is dark", little, ">=", 0.2, on, said),
            Check("correct: lit floor that is dark", right, "<=", 0.001, on, said),
            Check("too much: lit floor that is dark", much, "<=", 0.001, on, said),
            Check("correct: gap behind the board, texels", gaps[1], "<=", 1.0, on, said),
            Check("too much: gap behind the board, texels", gaps[2], ">=", 3.0, on, said),
            Check(
                "correct: floor that agrees with rays",
                found.agreeing,
                ">=",
                0.99,
                on,
                "shadows lie where rays have them; measured 0.995",
            ),
            Check(
                "correct: floor of no understood kind",
                found.other,
                "<=",
                0,
                on,
                "what differs lies at an edge or an outline",
            ),
        )
    return tuple(out)


FIGURE = Figure(
    id="F003-21",
    title="Bias: not enough, correct, too much",
    caption=(
        "One shadow map whose depths were moved away from the light by three polygon offsets: none (left), "
        "1.5 times the slope and 4 units (middle), 14 times the slope (right)."
    ),
    must_see=(
        "Left stripes and speckle on all that is lit: surfaces shade themselves. In the middle clean light "
        "and shadows that begin where things stand. Right clean light too, but the board, the ring and the "
        "sphere float: between their feet and their shadows there is light (and a thin line of shadow, of "
        "the board's narrow top, whose slope is less)."
    ),
    source="Zwicker2016",
    techniques=("Z10", "Z12"),
    columns=3,
    size=384,
    parameters={"ratio": 1, "offsets": ((0.0, 0.0), (1.5, OFFSET_UNITS), (14.0, OFFSET_UNITS))},
    methods=(Method("depth texture times the light", make, ("GEFORCE_3", "NV2A", "INFINITE_REALITY")),),
    acceptance=checks,
)
