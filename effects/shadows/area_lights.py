"""Area lights as many point lights: soft shadows in the accumulation buffer (Z26).

    1  the scene without the light; the accumulation buffer loads it
    2  for each of n points of the light: its shadow volumes, counted in the stencil buffer (Z23), and its
       light where the count is zero; the accumulation buffer adds 1/n of it
    3  the sum is returned

The penumbra lies between umbra and light. It is s d2 / d1 wide for a light of width s at the distance d1 from
an edge, whose shadow falls d2 farther on.

Source: document 003, "Terminology", "Hard and soft shadows"; the accumulation of shadows: Haeberli, Akeley,
"The Accumulation Buffer", SIGGRAPH 1990.
"""

from dataclasses import replace

from fixedpipe.effects.passes.arguments import positive
from fixedpipe.effects.shadows.lit_scene import SceneShading, lit_pass, unlit_pass
from fixedpipe.effects.shadows.shadow_volumes import (
    NOT_SHADOWED,
    counting_operations,
    shadow_volumes,
    z_pass_counts,
)
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.commands import Accum, Clear
from fixedpipe.pipeline.enums import AccumOperation

TECHNIQUES = (Technique("Z26", "soft shadows: an area light as many point lights", "Hard and soft shadows"),)

# Source: the catalogue's choice (A-Z26).
POINTS = 64


def lamps_of(lamp, width, count=POINTS):
    """``count`` points of a square light that is level, its edge ``width`` world units, its centre the
    lamp's position: a tuple of Lamps.

    Each row and each column of the light has one point of its own, so that a shadow of an edge along them
    has ``count`` steps: the columns are in order, the rows in the order of their reversed bits. ``count``: a
    power of two, else ValueError.
    """
    if count != int(count) or count < 1 or int(count) & (int(count) - 1):
        raise ValueError(f"An area light of {count} points; give a power of two.")
    count, (x, y, z) = int(count), lamp.position
    width, bits = positive(width, "The light's width"), count.bit_length() - 1
    out = []
    for i in range(count):
        reversed_i = int(f"{i:0{bits}b}"[::-1], 2) if bits else 0
        s, t = ((k + 0.5) / count - 0.5 for k in (i, reversed_i))
        out.append(replace(lamp, position=(x + s * width, y, z + t * width)))
    return tuple(out)


def accumulated_lights(scene, view, lamps, profile, shading=SceneShading.LIT):
    """The scene under the mean light of ``lamps``. The panel's colours and depths have been cleared.

    Raises ValueError where there is no lamp.
    """
    if not lamps:
        raise ValueError("An area light without a point lights nothing; give one lamp or more.")
    scissor = view.panel.scissor

    def accumulate(label, operation, value=1.0):
        return Accum(label=label, operation=operation, value=value, scissor=scissor)

    out = [
        *unlit_pass(scene, view, shading),
        accumulate("accumulate the scene without the light", AccumOperation.LOAD),
    ]
    for lamp in lamps:
        volumes = shadow_volumes(scene, lamp.homogeneous)
        out += (
            Clear(label="black, stencil to zero", color=(0.0, 0.0, 0.0, 0.0), stencil=0, scissor=scissor),
            *z_pass_counts(volumes, view, counting_operations(profile)),
            *lit_pass(
                scene,
                view,
                lamp,
                shading,
                label="light of one point where the count is zero",
                stencil_test=NOT_SHADOWED,
                blending=None,
            ),
            accumulate("accumulate the point's share", AccumOperation.ACCUM, 1.0 / len(lamps)),
        )
    return (*out, accumulate("return the sum", AccumOperation.RETURN))
