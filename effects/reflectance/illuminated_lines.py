"""H16, illuminated lines: Banks's table on the machine's own line primitives.

A line has a tangent and no normal: all directions across it are normals of a thin thread, and H15's table
takes the one that the light likes best. So the table is the whole of the light, without n.l: the tangent is
the texture coordinate, the texture matrix makes l.t and v.t of it, and the table modulates the line's colour.
One texture unit and one pass.

A machine draws line strips. The ideal draws filled polygons alone: it gets each piece as the parallelogram
that has the line's pixels, as wide as the line along the axis on which it advances less. Its triangles are in
such an order that a machine's fragment of piece k is one of triangle k.

Source: Heidrich 2001, section 1.1.1 (pass sequence A-H16 of the catalogue); Zöckler, Stalling, Hege 1996;
OpenGL 1.2.1, section 3.4.2 (wide lines).
"""

import numpy as np

from fixedpipe.effects.passes.draws import FIRST_PASS
from fixedpipe.effects.reflectance.banks_texture_matrix import tangent_unit
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.enums import PrimitiveType
from fixedpipe.pipeline.state import LineState, PassState

TECHNIQUES = (Technique("H16", "illuminated field lines: Banks's table on line primitives", "1.1.1"),)


def _strips(curves, colors):
    return Mesh(
        curves.positions,
        PrimitiveType.LINE_STRIP,
        counts=curves.counts,
        colors=colors,
        texture_coordinates=(curves.tangents,),
    )


def _parallelograms(curves, colors, view, width):
    """The pixels of the strips as triangles: first one of each piece, then the other of each."""
    pixel = 2.0 / (view.panel.height * view.projection[1][1])
    ends = curves.segments
    along = np.abs(curves.positions[ends[:, 1]] - curves.positions[ends[:, 0]])
    level = (along[:, 0] >= along[:, 1])[:, None]
    aside = np.where(level, np.array([0.0, 1.0, 0.0]), np.array([1.0, 0.0, 0.0])) * (0.5 * width * pixel)
    a, b = curves.positions[ends[:, 0]], curves.positions[ends[:, 1]]
    corners = np.stack([a - aside, b - aside, b + aside, a + aside], axis=1)
    vertex = np.stack([ends[:, 0], ends[:, 1], ends[:, 1], ends[:, 0]], axis=1).ravel()
    first = 4 * np.arange(len(ends))[:, None]
    triangles = np.concatenate([first + np.array([0, 1, 2]), first + np.array([0, 2, 3])])
    return Mesh(
        corners.reshape(-1, 3),
        indices=triangles.ravel(),
        colors=colors[vertex],
        texture_coordinates=(curves.tangents[vertex],),
    )


def line_pass(curves, view, profile, *, light=None, texture=None, color=(1.0, 1.0, 1.0), width=1.0):
    """Lines of their colour, times the table where there is a light.

    curves   ``Curves`` within the view, for clipping would number their pieces otherwise
    view     of ``orthographic_view``
    light    directional; None: the lines have their colour alone
    texture  of ``banks_texture_matrix.load_threads``, where there is a light
    color    RGB of all lines, or float64 [n, 3] of each vertex
    width    pixels

    Raises ValueError where the light or the viewer is near, or the width is not positive.
    """
    if not width > 0.0:
        raise ValueError(f"The lines' width is {width!r}; give a positive number of pixels.")
    colors = np.broadcast_to(np.asarray(color, np.float64), (len(curves.positions), 3))
    mesh = (
        _parallelograms(curves, colors, view, width) if profile.arithmetic.exact else _strips(curves, colors)
    )
    units = () if light is None else (tangent_unit(texture, view, light),)
    label = "lines" if light is None else "lines, times the table of l.t and v.t"
    state = PassState(
        vertex=view.vertex,
        texture_units=units,
        scissor=view.panel.scissor,
        depth_test=FIRST_PASS,
        line=LineState(width=width),
    )
    return Draw(label=label, mesh=mesh, state=state)
