"""H22 and H23: a mirror over diffuse global light, k_d L_d + k_s L_m, by blending or accumulation.

    H22  1. diffuse light times k_d: light maps, or a map filtered for every normal
         2. the mirror times k_s, added to the pixels of the first pass (ONE, ONE)

    H23  1. diffuse light, whole; the accumulation buffer loads it times k_d
         2. the colours cleared, the mirror drawn, whole; accumulated times k_s, and returned

H22 rounds each product. In H23 both pictures use the full range of bytes, and the accumulation buffer has
more than eight bits, so H23 loses less to rounding.

Source: Heidrich 2001, section 1.4; pass sequences A-H22 and A-H23 of the catalogue.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.passes.draws import ADD, LATER_PASS, MODULATE, draw
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.commands import Accum, Clear
from fixedpipe.pipeline.enums import AccumOperation, Face
from fixedpipe.pipeline.state import PolygonState

TECHNIQUES = (
    Technique("H22", "a mirror added to diffuse global light by blending", "1.4"),
    Technique("H23", "a mirror added to diffuse global light by the accumulation buffer", "1.4"),
)

# Faces turned away: where one meets the outline in the same pixel at the same depth, it would be added twice.
FRONT = PolygonState(cull_face=Face.BACK)


def weighted_mesh(mesh, weight):
    """The mesh with grey vertex colours of ``weight``, from 0 to 1, which multiply a pass."""
    if not 0.0 <= weight <= 1.0:
        raise ValueError(f"A pass is multiplied by {weight!r}; give a number from 0 to 1.")
    return replace(mesh, colors=np.full((len(mesh.positions), 3), float(weight)))


def mirror_pass(surface, view, mirror, weight=1.0, *, added=False):
    """The mirror on a surface that was drawn, times ``weight``.

    mirror  the texture unit that reads the environment map (``fresnel_passes.cube_unit``, ``sphere_unit``)
    added   to what is there; else in its place
    """
    label = f"{mirror.texture}, times {weight:g}{', added' if added else ''}"
    return draw(
        label,
        weighted_mesh(surface.mesh(), weight),
        view,
        None,
        (replace(mirror, environment=MODULATE),),
        depth_test=LATER_PASS,
        blending=ADD if added else None,
        polygon=FRONT,
    )


def accumulated(panel, diffuse, mirror, k_d, k_s):
    """H23's passes: ``diffuse`` and ``mirror`` are commands that draw each whole, the first with depths."""
    scissor = panel.scissor

    def accum(label, operation, value):
        return Accum(label=label, operation=operation, value=float(value), scissor=scissor)

    return (
        *diffuse,
        accum(f"load {k_d:g} times diffuse light", AccumOperation.LOAD, k_d),
        Clear(label="clear the colours, keep depths", color=(0.0, 0.0, 0.0, 0.0), scissor=scissor),
        *mirror,
        accum(f"accumulate {k_s:g} times the mirror", AccumOperation.ACCUM, k_s),
        accum("return the sum", AccumOperation.RETURN, 1.0),
    )
