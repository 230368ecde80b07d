"""What a shadow map's bias does to a thin board (``fixedpipe.effects.scenes.board``): its shadows under
several polygon offsets, the speckle that too little bias leaves on lit surfaces, and the gap that too much
opens behind the board.
"""

import numpy as np

from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.geometry.views import BACKGROUND, row_of_panels
from fixedpipe.effects.scenes.board import (
    BOARD_PLACE,
    BOARD_THICKNESS,
    BOARD_TURN,
    BOARD_WIDTH,
    board_view,
    ring_and_board,
)
from fixedpipe.effects.shadows.lit_scene import map_edge
from fixedpipe.effects.shadows.shadow_maps import modulated_passes, store_map


def shadows_under_offsets(profile, size, *, ratio, offsets, shading):
    """The same map once for each of the offsets (factor, units) by which it is moved away from the light."""
    count = len(offsets)
    panels, edge = row_of_panels(count, size), map_edge(size, ratio)
    scene, lamp = ring_and_board(size)
    out = []
    for panel, (factor, units) in zip(panels, offsets, strict=True):
        view = board_view(panel)
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

    It examines the places on the floor that the board shades and that the mask has lit. For each it takes the
    way from the foot along the shadow, while the map sees it. The result is the 95th percentile; 0: there is
    no such place. Only the first 0.9 world units count, so a wider gap appears as at least these.
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
