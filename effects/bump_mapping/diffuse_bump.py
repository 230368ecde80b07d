"""K10, the diffuse bump-mapping pass, and K14, dot-product bump mapping with a Blinn-Phong highlight.

K10: (n.l)+ per fragment from a normal map and a light vector per vertex, times a colour. It is the first of
the paper's two passes; destination alpha keeps the gate min(1, 4 (n.l)+), by which a later specular pass can
be multiplied so that it stays on the lit side (Eq. 1 itself is even in h and has no such term: erratum
E004.1).
With a colour map the surface's colour is a texture in unit 1 instead: the second general combiner, whose RGB
portion was free, multiplies it by the light's colour, and E times F by the ambient light.
K14: K10, then k (n.h)^8 by squaring three times. Two combiners have no multiplication left for k, so its
eighth root is the halfway vector's length.

Source: Kautz, Seidel 2000, sections 2, 3 and 6 (K10, K14 of the catalogue; pass sequences A-K07 and A-H43);
Kilgard 2000, section 4.
"""

import math

from fixedpipe.effects.geometry.vertex_vectors import half_vectors, light_vectors
from fixedpipe.effects.passes.combiners import NO_ALPHA, NO_RGB, OPAQUE, ZERO, alpha_of, expand, opaque
from fixedpipe.effects.passes.draws import ADD_GATED, FIRST_PASS, LATER_PASS, REPEATED, draw, unit
from fixedpipe.effects.passes.encoding import encode_vertex_color
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.enums import CombinerScale, ComponentUsage, Register
from fixedpipe.pipeline.state import (
    AlphaPortion,
    CombinerInput,
    FinalCombiner,
    GeneralCombiner,
    RegisterCombiners,
    RGBPortion,
)

TECHNIQUES = (
    Technique("K10", "diffuse bump mapping: (n.l)+ at every fragment, times a colour", "3, 6"),
    Technique("K14", "dot-product bump mapping: a map of normals, (n.l)+ and a highlight", "2"),
    Technique("H43", "Kilgard's bump mapping: l and h turned at vertices, (n.h)^8 by squaring", "3"),
)


def diffuse_combiners(
    color, ambient=(0.0, 0.0, 0.0), light_register=Register.PRIMARY_COLOR, *, color_map=False
):
    """General combiners: dot product, gate; final combiner: (n.l)+ color + ambient, alpha = the gate.

    ``color_map``: both colours are multiplied by texture 1.
    """
    dot_product = RGBPortion(
        a=expand(Register.TEXTURE0),
        b=expand(light_register),
        ab_dot_product=True,
        ab_output=Register.SPARE0,
        sum_output=Register.DISCARD,
    )
    gate = AlphaPortion(
        a=CombinerInput(Register.SPARE0, usage=ComponentUsage.BLUE),
        b=OPAQUE,
        ab_output=Register.SPARE0,
        sum_output=Register.DISCARD,
        scale=CombinerScale.SCALE_BY_FOUR,
    )
    lit, surface_color, always = NO_RGB, Register.CONSTANT_COLOR0, Register.CONSTANT_COLOR1
    texels = CombinerInput(Register.TEXTURE1)
    if color_map:
        lit = RGBPortion(
            a=texels,
            b=CombinerInput(Register.CONSTANT_COLOR0),
            ab_output=Register.SPARE1,
            sum_output=Register.DISCARD,
        )
        surface_color, always = Register.SPARE1, Register.E_TIMES_F
    final = FinalCombiner(
        a=CombinerInput(Register.SPARE0),
        b=CombinerInput(surface_color),
        c=ZERO,
        d=CombinerInput(always),
        e=CombinerInput(Register.CONSTANT_COLOR1) if color_map else ZERO,
        f=texels if color_map else ZERO,
        g=alpha_of(Register.SPARE0),
    )
    return RegisterCombiners(
        general=(GeneralCombiner(dot_product, NO_ALPHA), GeneralCombiner(lit, gate)),
        final=final,
        constant_color0=opaque(color),
        constant_color1=opaque(ambient),
    )


def diffuse_pass(
    surface,
    normal_map,
    view,
    light,
    profile,
    *,
    color,
    ambient=(0.0, 0.0, 0.0),
    color_map=None,
    depth_test=FIRST_PASS,
    blending=None,
    sampler=REPEATED,
):
    """K10: one draw. ``normal_map``: the name of a texture with normals for EXPAND_NORMAL; colours RGB in
    [0, 1]. ``color_map``: the name of a texture by whose colours both are multiplied. ``depth_test``,
    ``blending``: where it is added to passes before it.
    """
    vectors = encode_vertex_color(light_vectors(surface, light), profile)
    combiners = diffuse_combiners(color, ambient, color_map=color_map is not None)
    mesh = surface.mesh(colors=vectors)
    units, label = (unit(normal_map, sampler),), "diffuse pass: (n.l)+"
    if color_map is not None:
        units, label = (*units, unit(color_map, sampler)), f"{label} times the colour map"
    return (draw(label, mesh, view, combiners, units, depth_test=depth_test, blending=blending),)


def blinn_phong_combiners():
    """General combiners: n.h, then its square; final combiner: squared twice more by E times F."""
    dot_product = RGBPortion(
        a=expand(Register.TEXTURE0),
        b=expand(Register.PRIMARY_COLOR),
        ab_dot_product=True,
        ab_output=Register.SPARE0,
        sum_output=Register.DISCARD,
    )
    spare0 = CombinerInput(Register.SPARE0)
    square = RGBPortion(a=spare0, b=spare0, ab_output=Register.SPARE0, sum_output=Register.DISCARD)
    power4 = CombinerInput(Register.E_TIMES_F)
    final = FinalCombiner(a=power4, b=power4, c=ZERO, d=ZERO, e=spare0, f=spare0, g=OPAQUE)
    return RegisterCombiners(
        general=(GeneralCombiner(dot_product, NO_ALPHA), GeneralCombiner(square, NO_ALPHA)), final=final
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
    vectors = encode_vertex_color(eighth_root(specular) * half_vectors(surface, view, light), profile)
    mesh = surface.mesh(colors=vectors)
    label = "specular pass: (h.n)^8"
    units = (unit(normal_map),)
    return (
        draw(label, mesh, view, blinn_phong_combiners(), units, depth_test=LATER_PASS, blending=ADD_GATED),
    )


def commands(surface, normal_map, view, light, profile, *, color, ambient=(0.0, 0.0, 0.0), specular=1.0):
    """K14: the diffuse and the specular pass; ``specular``: the highlight's strength, in [0, 1]."""
    return (
        *diffuse_pass(surface, normal_map, view, light, profile, color=color, ambient=ambient),
        *blinn_phong_pass(surface, normal_map, view, light, profile, specular=specular),
    )
