"""K10, the diffuse bump-mapping pass, and K14, dot-product bump mapping with a Blinn-Phong highlight.

K10 is (n.l)+ per fragment from a normal map and a light vector per vertex, times a colour. It is the first of
the paper's two passes. Destination alpha keeps the gate min(1, 4 (n.l)+). A later specular pass can be
multiplied by the gate, so that it stays on the lit side. Eq. 1 itself is even in h and has no such term
(erratum E004.1).

With a colour map, the surface's colour is a texture in unit 1 instead. The second general combiner, whose RGB
portion was free, multiplies it by the light's colour, and E times F multiplies it by the ambient light.

K14 is K10, then k (n.h)^8 by squaring three times. Two combiners have no multiplication left for k, so its
eighth root is the halfway vector's length.

Source: Kautz, Seidel 2000, sections 2, 3 and 6 (K10, K14 of the catalogue; pass sequences A-K07 and A-H43);
Kilgard 2000, section 4.
"""

import math

from fixedpipe.effects.geometry.vertex_vectors import half_vectors, light_vectors
from fixedpipe.effects.passes.combiners import (
    CONSTANT0,
    CONSTANT1,
    NOTHING,
    ONE,
    PRIMARY,
    SPARE0,
    SPARE1,
    TEXTURE0,
    TEXTURE1,
    alpha_of,
    blue_of,
    both,
    dot,
    expand,
    final,
    gate,
    one_minus,
    product,
    program,
    scaled,
    square,
    stage,
    total,
)
from fixedpipe.effects.passes.draws import ADD_GATED, FIRST_PASS, REPEATED, draw, unit
from fixedpipe.effects.passes.encoding import vector_colors
from fixedpipe.effects.technique import Technique

TECHNIQUES = (
    Technique("K10", "diffuse bump mapping: (n.l)+ at every fragment, times a colour", "3, 6"),
    Technique("K14", "dot-product bump mapping: a map of normals, (n.l)+ and a highlight", "2"),
)


def diffuse_combiners(color, ambient=(0.0, 0.0, 0.0), light_register=PRIMARY, *, color_map=False):
    """(n.l)+ color + ambient, alpha: the gate min(1, 4 (n.l)+).

    ``light_register``: the register that has l. ``color_map``: both colours are multiplied by texture 1.
    """
    surface_color, always, lit = CONSTANT0, CONSTANT1, NOTHING
    if color_map:
        lit = product(TEXTURE1, CONSTANT0, to=SPARE1)
        surface_color, always = SPARE1, product(CONSTANT1, TEXTURE1)
    return program(
        dot(expand(TEXTURE0), expand(light_register), to=SPARE0),
        stage(lit, alpha=gate(SPARE0)),
        final(SPARE0, surface_color, plus=always, alpha=SPARE0),
        constant0=color,
        constant1=ambient,
    )


def self_shadowed_combiners(color, ambient=(0.0, 0.0, 0.0)):
    """(n.l)+ min(1, 8 (l_z)+) color texture 1 + ambient texture 1: nothing is lit where the smooth surface
    faces away from the light, and the light fades within seven degrees of there.

    Source: A-H43 of the catalogue.
    """
    upward = blue_of(expand(PRIMARY))
    # 1 - (1 - 8 l_z)+ is min(1, 8 l_z) where registers have no upper end, too.
    shadowed = one_minus(SPARE0)
    return program(
        stage(
            dot(expand(TEXTURE0), expand(PRIMARY), to=SPARE0),
            alpha=scaled(4, total(product(upward, ONE), product(upward, ONE), to=SPARE0)),
        ),
        stage(
            both(product(SPARE0, CONSTANT0, to=SPARE1), product(CONSTANT1, TEXTURE1, to=TEXTURE0)),
            alpha=product(shadowed, ONE, to=SPARE0),
        ),
        final(product(alpha_of(shadowed), TEXTURE1), SPARE1, plus=TEXTURE0),
        constant0=color,
        constant1=ambient,
    )


def diffuse_pass(
    surface, normal_map, view, light, profile, *,
    color, ambient=(0.0, 0.0, 0.0), color_map=None, self_shadow=False, depth_test=FIRST_PASS, blending=None,
    sampler=REPEATED,
):  # fmt: skip
    """K10: one draw. ``normal_map``: the name of a texture with normals for EXPAND_NORMAL; colours RGB in [0,
    1]. ``color_map``: the name of a texture whose colours multiply both; ``self_shadow``: whether light ends
    at the surface's own terminator. ``depth_test``, ``blending``: where it is added to passes before it.
    Raises ValueError for ``self_shadow`` without ``color_map``.
    """
    if self_shadow and color_map is None:
        raise ValueError("self_shadow is for a surface with a color_map; give the colour map's name too.")
    vectors = vector_colors(light_vectors(surface, light), profile)
    if self_shadow:
        combiners = self_shadowed_combiners(color, ambient)
    else:
        combiners = diffuse_combiners(color, ambient, color_map=color_map is not None)
    mesh = surface.mesh(colors=vectors)
    units, label = (unit(normal_map, sampler),), "diffuse pass: (n.l)+"
    if color_map is not None:
        units, label = (*units, unit(color_map, sampler)), f"{label} times the colour map"
    return (draw(label, mesh, view, combiners, units, depth_test=depth_test, blending=blending),)


def blinn_phong_combiners():
    """(n.h)^8: squared by a general combiner, again by E times F, and that by A times B."""
    fourth_power = square(SPARE0)
    return program(
        dot(expand(TEXTURE0), expand(PRIMARY), to=SPARE0),
        square(SPARE0, to=SPARE0),
        final(fourth_power, fourth_power),
    )


def eighth_root(strength):
    """The length of a halfway vector whose eighth power is ``strength``, in [0, 1]."""
    if not 0.0 <= strength <= 1.0:
        raise ValueError(f"The highlight's strength is {strength!r}; give a number from 0 to 1.")
    return math.sqrt(math.sqrt(math.sqrt(strength)))


def blinn_phong_pass(surface, normal_map, view, light, profile, *, specular=1.0):
    """K14's specular pass: ``specular`` (n.h)^8 of a white light, multiplied by the gate in destination alpha
    and added.
    """
    vectors = vector_colors(eighth_root(specular) * half_vectors(surface, view, light), profile)
    mesh = surface.mesh(colors=vectors)
    label = "specular pass: (h.n)^8"
    units = (unit(normal_map),)
    return (draw(label, mesh, view, blinn_phong_combiners(), units, blending=ADD_GATED),)


def commands(surface, normal_map, view, light, profile, *, color, ambient=(0.0, 0.0, 0.0), specular=1.0):
    """K14: the diffuse and the specular pass; ``specular``: the highlight's strength, in [0, 1]."""
    return (
        *diffuse_pass(surface, normal_map, view, light, profile, color=color, ambient=ambient),
        *blinn_phong_pass(surface, normal_map, view, light, profile, specular=specular),
    )
