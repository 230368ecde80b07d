"""H15, Banks's model by the texture matrix: the tangent is the texture coordinate, a pass a light.

    I_o = (n.l)+ (k_d n'.l + k_s (n'.h)^(1/r)) I_i

n' is the normal nearest to the light, among all normals of a thread with the tangent t. Both terms depend on
l.t and v.t alone:

    n'.l  is  sqrt(1 - (l.t)^2),    n'.h  is  sqrt(1 - (l.t)^2) sqrt(1 - (v.t)^2) - (l.t)(v.t)

A table over l.t and v.t holds both. The texture matrix makes its coordinates from the coordinate (t, 1). The
matrix has the rows l/2 and v/2 and a bias of one half, so a product of either sign falls into [0, 1]. So the
light is directional, the viewer far away, and t in the space of l and v. Hardware lighting computes (n.l)+
with a white or coloured diffuse material, and the texture environment multiplies. Further lights are added,
each with its own matrix.

K04 is the same model with vectors that change from texel to texel. A matrix for a whole mesh cannot turn
those, so K04 needs five passes or more, and does without the root.

``halfway_unit`` does the same for an isotropic model, with the normal in place of the tangent. Then the two
pictures differ only by the effect of the grooves.

Source: Heidrich 2001, section 1.1.1, Eq. 3 and 4 (pass sequence A-H15 of the catalogue; errata E000.3: the
scale and bias; E000.4: n' made of length one, and the term for lines in the place of n'.h; E000.5: 1/r is an
exponent).
"""

import math
from dataclasses import replace

import numpy as np

from fixedpipe.effects.geometry.vectors import normalize, unit_vector
from fixedpipe.effects.passes.draws import ADD, EDGE, FIRST_PASS, LATER_PASS, MODULATE, draw, unit
from fixedpipe.effects.reflectance import brdfs
from fixedpipe.effects.reflectance.sampled_functions import sampled
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.state import Light as LightState
from fixedpipe.pipeline.state import Lighting, Material

TECHNIQUES = (
    Technique(
        "H15",
        "Banks's model: the tangent is the texture coordinate, the texture matrix holds light and viewer",
        "1.1.1",
    ),
)

# Texels along either axis of a table. Source: A-H15.
TEXELS = 256
_BLACK = (0.0, 0.0, 0.0, 1.0)


def thread(light_tangent, view_tangent, diffuse, specular, exponent):
    """The table's values for l.t and v.t in [-1, 1]: Banks's light of a thread, without n.l. float64.

    k_d sqrt(1 - (l.t)^2) + k_s (sqrt(1 - (l.t)^2) sqrt(1 - (v.t)^2) - (l.t)(v.t))+^exponent
    """
    lit = brdfs.banks_r(np.square(light_tangent))
    return diffuse * lit + specular * brdfs.banks_bracket(view_tangent, light_tangent) ** exponent


def rough(half_normal, diffuse, specular, exponent):
    """The isotropic counterpart, of n.h in [-1, 1]: k_d + k_s (n.h)+^exponent, without n.l. float64."""
    return diffuse + specular * np.maximum(0.0, half_normal) ** exponent


def _table(texture, function, texels, profile):
    image = sampled(
        lambda s, t: function(2.0 * s - 1.0, 2.0 * t - 1.0), texels, texels, profile=profile, bits=8
    )
    return TexImage(label=f"load {texture}", texture=texture, image=image)


def load_threads(texture, profile, *, diffuse, specular, exponent, texels=TEXELS):
    """The command that loads ``thread`` over (l.t, v.t), columns and rows from -1 to 1.

    diffuse, specular  k_d and k_s; if their sum exceeds one, it is clamped where both terms are full
    exponent           1/r, positive
    texels             of either axis, a power of two

    Raises ValueError for numbers that are no model: negative, or not finite.
    """
    _check(diffuse, specular, exponent)
    return _table(texture, lambda lt, vt: thread(lt, vt, diffuse, specular, exponent), texels, profile)


def load_rough(texture, profile, *, diffuse, specular, exponent, texels=TEXELS):
    """The command that loads ``rough`` over (n.h, anything); parameters as for ``load_threads``."""
    _check(diffuse, specular, exponent)
    return _table(
        texture, lambda nh, other: rough(nh, diffuse, specular, exponent) + 0.0 * other, texels, profile
    )


def _check(diffuse, specular, exponent):
    for value, what in ((diffuse, "k_d"), (specular, "k_s"), (exponent, "The exponent")):
        if not (math.isfinite(value) and value >= 0.0):
            raise ValueError(f"{what} is {value!r}; give a finite number, not negative.")
    if exponent == 0.0:
        raise ValueError("The exponent is 0, with which every direction shines; give a positive one.")


def _directions(view, light):
    """l and v of length one, in the space of the mesh. Raises ValueError where they differ from point to
    point.
    """
    if light.point or not view.infinite_viewer:
        near = "light" if light.point else "viewer"
        raise ValueError(
            f"The {near} is near, so its direction differs from point to point, and one texture matrix "
            "serves all of a mesh. Give a directional light and a viewer who is far away (orthographic_view)."
        )
    return (
        unit_vector(light.vector, "The light's direction"),
        unit_vector(view.eye, "The direction to the viewer"),
    )


def _biased(direction):
    """A row of the texture matrix that makes (1 + direction.c) / 2 of the coordinate (c, 1)."""
    return (*(0.5 * float(c) for c in direction), 0.5)


def _matrix(first, second):
    return (_biased(first), _biased(second), (0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))


def tangent_unit(texture, view, light):
    """The texture unit that looks ``load_threads``' table up, tangents being texture coordinates [n, 3]."""
    toward_light, toward_viewer = _directions(view, light)
    return unit(texture, EDGE, matrix=_matrix(toward_light, toward_viewer), environment=MODULATE)


def halfway_unit(texture, view, light):
    """The texture unit that looks ``load_rough``'s table up, normals being texture coordinates [n, 3]."""
    toward_light, toward_viewer = _directions(view, light)
    halfway = normalize(toward_light + toward_viewer)
    return unit(texture, EDGE, matrix=_matrix(halfway, toward_viewer), environment=MODULATE)


def lambert(light, color, intensity=(1.0, 1.0, 1.0)):
    """Hardware lighting with a diffuse material alone: the primary colour is (n.l)+ color intensity.

    The light's direction is taken as eye coordinates, so the modelview matrix must not turn.
    """
    position = (*(float(c) for c in unit_vector(light.vector, "The light's direction")), 0.0)
    shining = LightState(diffuse=(*intensity, 1.0), ambient=_BLACK, specular=_BLACK, position=position)
    material = Material(ambient=_BLACK, diffuse=(*color, 1.0), specular=_BLACK)
    return Lighting(lights=(shining,), front=material, model_ambient=_BLACK)


def lit_passes(surface, coordinates, view, lights, unit_of, *, color=(1.0, 1.0, 1.0)):
    """A pass for each light, a table's texel times lighting's (n.l)+. The first replaces, others add.

    surface       the surface to draw; its normals are lit
    coordinates   float64 [n, 3]: tangents or normals, the unit's texture coordinates
    view, lights  a distant viewer; pairs (light, its RGB) of directional lights
    unit_of       (view, light) -> the texture unit with that light's matrix
    color         the surface's reflectance, RGB

    Raises ValueError without a light, and for a light or a viewer that is near.
    """
    if not lights:
        raise ValueError("There is no light, and a pass is drawn for each; give one or more.")
    mesh = surface.mesh(np.asarray(coordinates, np.float64))
    out = []
    for number, (light, intensity) in enumerate(lights):
        command = draw(
            f"light {number + 1}: (n.l)+ times the table",
            mesh,
            view,
            None,
            (unit_of(view, light),),
            depth_test=LATER_PASS if out else FIRST_PASS,
            blending=ADD if out else None,
        )
        vertex = view.vertex_with(lighting=lambert(light, color, intensity))
        out.append(replace(command, state=replace(command.state, vertex=vertex)))
    return tuple(out)


def banks_passes(surface, tangents, view, lights, texture, *, color=(1.0, 1.0, 1.0)):
    """Banks's model of a surface with these tangents [n, 3].

    ``texture``: from ``load_threads``; the rest as for ``lit_passes``.
    """
    return lit_passes(
        surface, tangents, view, lights, lambda v, light: tangent_unit(texture, v, light), color=color
    )


def isotropic_passes(surface, view, lights, texture, *, color=(1.0, 1.0, 1.0)):
    """The isotropic counterpart; ``texture``: from ``load_rough``, the rest as for ``lit_passes``."""
    return lit_passes(
        surface, surface.normals, view, lights, lambda v, light: halfway_unit(texture, v, light), color=color
    )
