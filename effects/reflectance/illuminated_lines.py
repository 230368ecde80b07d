"""H16, illuminated lines: Banks's table on the machine's own line primitives.

A line has a tangent and no normal: all directions across it are normals of a thin thread. H15's table uses
the normal nearest to the light. So the table holds all of the light, without n.l. The tangent is the texture
coordinate, the texture matrix makes l.t and v.t of it, and the table modulates the line's colour. This takes
one texture unit and one pass.

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


def line_pass(curves, view, *, light=None, texture=None, color=(1.0, 1.0, 1.0), width=1.0):
    """Lines of their colour, times the table where there is a light.

    curves   ``Curves``
    view     of ``orthographic_view``
    light    directional; None: the lines have their colour alone
    texture  of ``banks_texture_matrix.load_threads``, where there is a light
    color    RGB of all lines, or float64 [n, 3] of each vertex
    width    pixels

    Raises ValueError if the light or the viewer is near, or the width is not positive.
    """
    if not width > 0.0:
        raise ValueError(f"The lines' width is {width!r}; give a positive number of pixels.")
    colors = np.broadcast_to(np.asarray(color, np.float64), (len(curves.positions), 3))
    mesh = Mesh(
        curves.positions,
        PrimitiveType.LINE_STRIP,
        counts=curves.counts,
        colors=colors,
        texture_coordinates=(curves.tangents,),
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
