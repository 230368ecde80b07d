"""K04, the Banks model with R*(s) = 1 - s, by register combiners and without a dependent texture lookup.

    L = k_s (n.l)+ ((1 - (v.t)^2) (1 - (l.t)^2) - (v.t)(l.t))+

The bracket is of degree four in the dot products, two general combiners reach two: the framebuffer multiplies
and adds. It holds bytes without a sign, so the product (v.t)(l.t) comes in two halves, where it is negative
and where it is positive. Nothing saturates on the way: (1 - a^2)(1 - b^2) + |a b| <= 1 for |a|, |b| <= 1.

    1  1 - (v.t)^2                          primary colour: v
    2  times 1 - (l.t)^2                    primary colour: l
    3  plus (-(v.t)(l.t))+                  primary colour: v, secondary colour: l
    4  one minus that
    5  plus ((v.t)(l.t))+
    6  one minus that
    7  times k_s (n.l)+                     primary colour: l

A board whose blending subtracts (EXT_blend_subtract) has one pass for 4 to 6, which takes ((v.t)(l.t))+ away.
A board with five general combiners needs no other pass: ``specular_pass``.

The tangent map holds t for EXPAND_NORMAL and k_s in alpha; (n.l)+ needs the normal map besides, for n changes
from texel to texel as t does (erratum E004.3).

Source: Kautz, Seidel 2000, section 3.1 (K04 of the catalogue; pass sequence A-K04; erratum E004.2: the
exponent of the bracket, printed without, is one).
"""

from dataclasses import dataclass

from fixedpipe.effects.geometry.vertex_vectors import light_vectors, view_vectors
from fixedpipe.effects.passes.combiners import (
    NO_ALPHA,
    ONE,
    OPAQUE,
    ZERO,
    alpha_of,
    constant_product,
    expand,
    opaque,
)
from fixedpipe.effects.passes.draws import (
    ADD,
    FIRST_PASS,
    INVERT_DESTINATION,
    LATER_PASS,
    MULTIPLY_DESTINATION,
    REPEATED,
    SUBTRACT,
    draw,
    unit,
)
from fixedpipe.effects.passes.encoding import encode_rgba, encode_vertex_color
from fixedpipe.effects.reflectance import brdfs
from fixedpipe.effects.reflectance.evaluate_then_interpolate import at_texels
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.commands import Saturate, TexImage
from fixedpipe.pipeline.enums import BlendEquation, Mapping, Register
from fixedpipe.pipeline.state import (
    CombinerInput,
    FinalCombiner,
    GeneralCombiner,
    RegisterCombiners,
    RGBPortion,
)
from fixedpipe.pipeline.textures.images import texture_2d

TECHNIQUES = (
    Technique("K04", "the Banks model with 1 - s in place of sqrt(1 - s): no dependent lookup", "3.1"),
)


@dataclass(frozen=True)
class BanksNames:
    """The names of the two texture objects: the normal map, and the tangent map with k_s in alpha."""

    normal: str
    tangent: str


def load(material, name, profile):
    """Commands that load a material's normal map and tangent map, and their names."""
    names = BanksNames(f"{name} n", f"{name} t")
    tangents = texture_2d(encode_rgba(material.tangents, material.k_s, profile))
    return (
        TexImage(
            label=f"load normal map of {name}", texture=names.normal, image=material.normal_texture(profile)
        ),
        TexImage(label=f"load tangent map of {name}: t, k_s", texture=names.tangent, image=tangents),
    ), names


def _signed(register, negated=False):
    return CombinerInput(register, Mapping.SIGNED_NEGATE if negated else Mapping.SIGNED_IDENTITY)


def _final(a, b=ONE, **variables):
    """A final combiner that gives ``a`` times ``b``, clamped to [0, 1]."""
    return FinalCombiner(a=a, b=b, c=ZERO, d=ZERO, g=OPAQUE, **variables)


def _one_minus_square():
    """1 - (t.c)^2 with c the primary colour."""
    product = RGBPortion(
        a=expand(Register.TEXTURE0),
        b=expand(Register.PRIMARY_COLOR),
        ab_dot_product=True,
        ab_output=Register.SPARE0,
        sum_output=Register.DISCARD,
    )
    spare0 = _signed(Register.SPARE0)
    square = RGBPortion(a=spare0, b=spare0, ab_output=Register.SPARE0, sum_output=Register.DISCARD)
    return RegisterCombiners(
        general=(GeneralCombiner(product, NO_ALPHA), GeneralCombiner(square, NO_ALPHA)),
        final=_final(CombinerInput(Register.SPARE0, Mapping.UNSIGNED_INVERT)),
    )


def _dot_products():
    """v.t in spare 0 and l.t in spare 1: v is the primary, l the secondary colour."""
    return RGBPortion(
        a=expand(Register.TEXTURE0),
        b=expand(Register.PRIMARY_COLOR),
        c=expand(Register.TEXTURE0),
        d=expand(Register.SECONDARY_COLOR),
        ab_dot_product=True,
        cd_dot_product=True,
        ab_output=Register.SPARE0,
        cd_output=Register.SPARE1,
        sum_output=Register.DISCARD,
    )


def _product(negated):
    """((v.t)(l.t))+, or with ``negated`` (-(v.t)(l.t))+."""
    product = RGBPortion(
        a=_signed(Register.SPARE0),
        b=_signed(Register.SPARE1, negated),
        ab_output=Register.SPARE0,
        sum_output=Register.DISCARD,
    )
    return RegisterCombiners(
        general=(GeneralCombiner(_dot_products(), NO_ALPHA), GeneralCombiner(product, NO_ALPHA)),
        final=_final(CombinerInput(Register.SPARE0)),
    )


def _irradiance(specular):
    """k_s (n.l)+: unit 0 has the normal map, unit 1 the tangent map, whose alpha is k_s."""
    product = RGBPortion(
        a=expand(Register.TEXTURE0),
        b=expand(Register.PRIMARY_COLOR),
        ab_dot_product=True,
        ab_output=Register.SPARE0,
        sum_output=Register.DISCARD,
    )
    return RegisterCombiners(
        general=(GeneralCombiner(product, NO_ALPHA),),
        final=_final(
            CombinerInput(Register.SPARE0),
            CombinerInput(Register.E_TIMES_F),
            e=CombinerInput(Register.CONSTANT_COLOR0),
            f=alpha_of(Register.TEXTURE1),
        ),
        constant_color0=opaque(specular),
    )


def specular_passes(
    surface,
    names,
    view,
    light,
    profile,
    *,
    specular=(1.0, 1.0, 1.0),
    subtract=None,
    sampler=REPEATED,
):
    """The model in passes of two units and two general combiners; they replace what the framebuffer holds.

    Parameters
    ----------
    surface, view, light
        The surface, the view and the light.
    names
        The material's texture objects (``BanksNames``).
    specular
        RGB in [0, 1], by which k_s is multiplied.
    subtract
        Whether a blend equation takes ((v.t)(l.t))+ away (five passes) or two inversions of the framebuffer
        do (seven); None: as the machine's blend equations allow.
    """
    if subtract is None:
        subtract = BlendEquation.FUNC_REVERSE_SUBTRACT in profile.blend_equations
    toward_viewer = encode_vertex_color(view_vectors(surface, view), profile)
    toward_light = encode_vertex_color(light_vectors(surface, light), profile)
    seen, lit = surface.mesh(colors=toward_viewer), surface.mesh(colors=toward_light)
    both = surface.mesh(colors=toward_viewer, secondary_colors=toward_light)
    tangent, normal = unit(names.tangent, sampler), unit(names.normal, sampler)

    def later(label, mesh, combiners, units, blending):
        return draw(label, mesh, view, combiners, units, depth_test=LATER_PASS, blending=blending)

    def one_minus():
        white = constant_product(ONE, (1.0, 1.0, 1.0))
        return later("one minus that", seen, white, (), INVERT_DESTINATION)

    positive, negative = _product(negated=False), _product(negated=True)
    if subtract:
        take_away = (later("minus ((v.t)(l.t))+", both, positive, (tangent,), SUBTRACT),)
    else:
        take_away = (
            one_minus(),
            later("plus ((v.t)(l.t))+", both, positive, (tangent,), ADD),
            one_minus(),
        )
    return (
        draw("1 - (v.t)^2", seen, view, _one_minus_square(), (tangent,), depth_test=FIRST_PASS),
        later("times 1 - (l.t)^2", lit, _one_minus_square(), (tangent,), MULTIPLY_DESTINATION),
        later("plus (-(v.t)(l.t))+", both, negative, (tangent,), ADD),
        *take_away,
        Saturate(label="(.)+: the framebuffer does not fall below zero", scissor=view.panel.scissor),
        later("times k_s (n.l)+", lit, _irradiance(specular), (normal, tangent), MULTIPLY_DESTINATION),
    )


def combiners(specular=(1.0, 1.0, 1.0)):
    """The whole model as five general combiners and the final combiner.

    Unit 0 has the tangent map, unit 1 the normal map; v is the primary, l the secondary colour.
    """
    vt, lt = _signed(Register.SPARE0), _signed(Register.SPARE1)
    with_n_l = RGBPortion(
        a=vt,
        b=lt,
        c=expand(Register.TEXTURE1),
        d=expand(Register.SECONDARY_COLOR),
        cd_dot_product=True,
        ab_output=Register.TEXTURE0,
        cd_output=Register.TEXTURE1,
        sum_output=Register.DISCARD,
    )
    squares = RGBPortion(
        a=vt,
        b=vt,
        c=lt,
        d=lt,
        ab_output=Register.SPARE0,
        cd_output=Register.SPARE1,
        sum_output=Register.DISCARD,
    )
    bracket = RGBPortion(
        a=CombinerInput(Register.SPARE0, Mapping.UNSIGNED_INVERT),
        b=CombinerInput(Register.SPARE1, Mapping.UNSIGNED_INVERT),
        c=_signed(Register.TEXTURE0, negated=True),
        d=ONE,
        sum_output=Register.SPARE0,
    )
    irradiance = RGBPortion(
        a=CombinerInput(Register.TEXTURE1),
        b=CombinerInput(Register.CONSTANT_COLOR0),
        ab_output=Register.SPARE1,
        sum_output=Register.DISCARD,
    )
    portions = (_dot_products(), with_n_l, squares, bracket, irradiance)
    return RegisterCombiners(
        general=tuple(GeneralCombiner(rgb, NO_ALPHA) for rgb in portions),
        final=_final(
            CombinerInput(Register.SPARE0),
            CombinerInput(Register.E_TIMES_F),
            e=CombinerInput(Register.SPARE1),
            f=alpha_of(Register.TEXTURE0),
        ),
        constant_color0=opaque(specular),
    )


def specular_pass(surface, names, view, light, profile, *, specular=(1.0, 1.0, 1.0), sampler=REPEATED):
    """The model in one draw that replaces, for boards with five general combiners (GeForce 3).

    Parameters as of ``specular_passes``.
    """
    mesh = surface.mesh(
        colors=encode_vertex_color(view_vectors(surface, view), profile),
        secondary_colors=encode_vertex_color(light_vectors(surface, light), profile),
    )
    units = (unit(names.tangent, sampler), unit(names.normal, sampler))
    label = "k_s (n.l)+ ((1 - (v.t)^2)(1 - (l.t)^2) - (v.t)(l.t))+"
    return (draw(label, mesh, view, combiners(specular), units, depth_test=FIRST_PASS),)


def evaluated_first(material, light, view, s, t, model=brdfs.banks):
    """K16's order: a Banks model evaluated at the texels and interpolated, float64 of the shape of s and t.

    ``light``, ``view``: [3] or [..., 3], unit vectors in the material's frame. ``model``: ``brdfs.banks`` or
    ``brdfs.banks_approximate``.
    """

    def at(row, column):
        normals, tangents = material.normals[row, column], material.tangents[row, column]
        return model(light, view, normals, tangents, material.k_s[row, column])

    return at_texels(at, *material.k_s.shape, s, t)
