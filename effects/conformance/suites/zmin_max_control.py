"""ZMinMaxControl: blocks of small quads whose z and w grow beyond the depth clip, which is 10 to 100.

The part outside is culled or clamped, by fragment and (NEARFAR) by primitive.

Ctrl: through a vertex program; CtrlFixed: through the fixed-function stage. WBuf: depth is w. IgnW: ignores
w; no capture differs in this. Source: src/tests/z_min_max_control_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace
from functools import partial
from itertools import product as combinations

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.effects.conformance.host_matrices import View, times, viewport
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.enums import PrimitiveType
from fixedpipe.pipeline.state import DepthClamp
from fixedpipe.pipeline.vertices.chip_floats import TRANSFORM_BITS, total, transform_dot, transform_reciprocal
from fixedpipe.pipeline.vertices.chip_floats import product as multiplied

SUITE = "ZMinMaxControl"
single = np.float32

NEAR, FAR = single(10.0), single(100.0)  # of the depth clip, z or w
BEFORE, BEYOND = NEAR * single(0.8), FAR * single(1.2)  # outside of it
FARTHEST = FAR * single(1.5)  # what z and w grow to
SIZE, STEP = 16.0, 20.0  # pixels: a quad's edge, and from one to the next
ROWS, COLUMNS = 8, 5
WIDTH, HEIGHT, LEFT, TOP = single(384.0 * 0.33), 192.0, 90.0, 60.0  # of a block's region; the first block
TRIANGLES = ((0, 1, 2), (0, 2, 3))


def _ends(mode, z, w, rise):
    """(z, w, colour) of a quad's left and right side; z, w: what they have grown to."""
    right = z + rise, w + rise
    grey = [single(0.25) + value / FARTHEST * single(0.75) for value in (z, right[0])]
    by_w = [single(0.25) + value / FARTHEST * single(0.75) for value in (w, right[1])]
    if mode == "z, w 1":
        return (z, 1.0, (grey[0],) * 3), (right[0], 1.0, (grey[1],) * 3)
    if mode == "z, w":
        return (z, w, (grey[0], 0.25, by_w[0])), (*right, (grey[1], 0.25, by_w[1]))
    if mode == "w":
        return (BEFORE, w, (0.33, 0.25, by_w[0])), (BEYOND, right[1], (0.33, 0.25, by_w[1]))
    if mode == "constant":
        return (BEFORE, BEFORE, (0.33, 0.75, 0.25)), (BEYOND, BEYOND, (0.33, 0.75, 0.8))
    if mode == "z, w 10":
        return (z, 10.0, (grey[0], grey[0], 0.25)), (right[0], 10.0, (grey[1], grey[1], 0.8))
    return (z, 0.01, (0.75, grey[0], grey[0])), (right[0], 0.0001, (grey[1], grey[1], 0.8))


BLOCKS = (("z, w 1", "w"), ("z, w small", "constant"), ("z, w", "z, w 10"))  # by column


def _quads():
    """Corners (x, y, z, w) and their colours of every quad."""
    step = FARTHEST / (single(ROWS * COLUMNS) + single(1))
    for column, modes in enumerate(BLOCKS):
        left = single(LEFT)
        for _ in range(column):
            left = left + (WIDTH + single(90.0))
        for row, mode in enumerate(modes):
            z = w = single(0.0)
            for place in range(ROWS * COLUMNS):
                x = left + single(STEP) * single(place % COLUMNS)
                y = TOP + HEIGHT * row + STEP * (place // COLUMNS)
                near, far = _ends(mode, z, w, step * single(0.75))
                sides = near, far, far, near
                corners = [
                    (*at[:2], *side[:2])
                    for at, side in zip(scenes.rectangle(x, y, x + SIZE, y + SIZE), sides, strict=True)
                ]
                yield corners, [side[2] for side in sides]
                z, w = (single(near[0]) if mode in ("w", "constant") else z) + step, w + step
                if mode == "constant":
                    w = single(near[1]) + step


def _triangles(by_primitive):
    """Corners and colours of the quads' triangles. ``by_primitive``: without those all of whose corners
    have a z beyond one limit, which the chip culls whatever depth is. Measured: Ctrl_WBuf_NEARFAR_ZCLAMP,
    301363 pixels.
    """
    points, colors = [], []
    for corners, given in _quads():
        for triangle in TRIANGLES:
            depths = [corners[k][2] for k in triangle]
            if by_primitive and (max(depths) < NEAR or min(depths) > FAR):
                continue
            points += [corners[k] for k in triangle]
            colors += [given[k] for k in triangle]
    return points, scenes.single(colors)


def _view():
    """An orthographic view of the depth clip's range, three units behind the eye."""
    moved, flat = np.eye(4, dtype=single), np.eye(4, dtype=single)
    moved[3, 2] = -3.0
    flat[0, 0], flat[1, 1] = single(2.0) / single(640.0), single(2.0) / single(480.0)
    flat[2, 2], flat[3, 2] = single(1.0) / (FAR - NEAR), NEAR / (NEAR - FAR)
    return View(moved, times(flat, viewport(65535.0)))


def _fixed_function(points):
    """Where the fixed-function stage puts the points: the program puts them where the view shows them
    there, and multiplies all four coordinates by w, which the chip divides by again. Of a w of 0 nothing is
    left: the reciprocal is infinite, and zero times infinity is 0. Measured: CtrlFixed captures, from whose
    upper left corner the two quads that begin with a w of 0 reach.
    """
    view = _view()
    world = [np.array([*view.unprojected(*point[:3]), 1], single) * single(point[3]) for point in points]
    columns = np.array(world, np.float64).T
    clip = [
        transform_dot([np.full(len(points), c) for c in row], columns)
        for row in view.composite.T.astype(np.float64)
    ]
    reciprocal = transform_reciprocal(clip[3])
    offset = np.full(len(points), scenes.XDK_OFFSET)
    with np.errstate(invalid="ignore"):  # the product that the chip takes for 0
        x, y, z = (multiplied(column, reciprocal, TRANSFORM_BITS) for column in clip[:3])
    x, y = (total((column, offset), TRANSFORM_BITS) for column in (x, y))
    return np.stack([x, y, z, clip[3]], axis=1)


def _case(fixed_function, w_buffering, near_far, culls):
    state = replace(
        scenes.DEFAULT,
        polygon=scenes.FRONT_FACES,
        depth_clamp=DepthClamp(float(NEAR), float(FAR), cull=culls),
        w_buffering=w_buffering,
    )
    points, colors = _triangles(near_far)
    if fixed_function:
        points = _fixed_function(points)
    mesh = scenes.window_mesh(points, PrimitiveType.TRIANGLES, colors=colors)
    return Case(
        commands=(scenes.clear(0xFF222228), Draw(label="blocks", mesh=mesh, state=state)), depth_bits=16
    )


CASES = {
    f"{stage}{w}{near_far}{limits}{ignored}": (
        partial(_case, stage == "CtrlFixed", bool(w), bool(near_far), limits == "_ZCULL")
    )
    for stage, w, near_far, limits, ignored in combinations(
        ("Ctrl", "CtrlFixed"), ("", "_WBuf"), ("", "_NEARFAR"), ("_ZCULL", "_ZCLAMP"), ("", "_IgnW")
    )
}
