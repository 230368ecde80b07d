"""K04, the Banks model with R*(s) = 1 - s, by register combiners and without a dependent texture lookup.

    L = k_s (n.l)+ ((1 - (v.t)^2) (1 - (l.t)^2) - (v.t)(l.t))+

The bracket is of degree four in the dot products. Two general combiners reach degree two, so the framebuffer
multiplies and adds. It holds bytes without a sign, so the product (v.t)(l.t) comes in a negative and a
positive half. Nothing saturates on the way: (1 - a^2)(1 - b^2) + |a b| <= 1 for |a|, |b| <= 1.

    1  1 - (v.t)^2                          primary colour: v
    2  times 1 - (l.t)^2                    primary colour: l
    3  plus (-(v.t)(l.t))+                  primary colour: v, secondary colour: l
    4  one minus that
    5  plus ((v.t)(l.t))+
    6  one minus that
    7  times k_s (n.l)+                     primary colour: l

A board whose blending subtracts (EXT_blend_subtract) subtracts ((v.t)(l.t))+ in one pass, in place of 4 to 6.
A board with five general combiners needs one pass for all: ``specular_pass``.

The tangent map holds t for EXPAND_NORMAL and k_s in alpha. (n.l)+ also needs the normal map, because n
changes from texel to texel as t does (erratum E004.3).

Source: Kautz, Seidel 2000, section 3.1 (K04 of the catalogue; pass sequence A-K04; erratum E004.2: the
exponent of the bracket, printed without, is one).
"""

from dataclasses import dataclass

from fixedpipe.effects.geometry.vertex_vectors import light_vectors, view_vectors
from fixedpipe.effects.passes.combiners import (
    CONSTANT0,
    ONE,
    PRIMARY,
    SECONDARY,
    SPARE0,
    SPARE1,
    TEXTURE0,
    TEXTURE1,
    alpha_of,
    both,
    constant_product,
    dot,
    expand,
    final,
    negated,
    one_minus,
    product,
    program,
    signed,
    square,
    total,
)
from fixedpipe.effects.passes.draws import (
    ADD,
    FIRST_PASS,
    INVERT_DESTINATION,
    MULTIPLY_DESTINATION,
    REPEATED,
    SUBTRACT,
    draw,
    unit,
)
from fixedpipe.effects.passes.encoding import vector_and_factor_texels, vector_colors
from fixedpipe.effects.reflectance import brdfs
from fixedpipe.effects.reflectance.evaluate_then_interpolate import at_texels
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.commands import Saturate, TexImage
from fixedpipe.pipeline.enums import BlendEquation
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
    tangents = texture_2d(vector_and_factor_texels(material.tangents, material.k_s, profile))
    return (
        TexImage(
            label=f"load normal map of {name}", texture=names.normal, image=material.normal_texture(profile)
        ),
        TexImage(label=f"load tangent map of {name}: t, k_s", texture=names.tangent, image=tangents),
    ), names


# v.t in spare 0 and l.t in spare 1: t in texture 0, v the primary, l the secondary colour.
_DOT_PRODUCTS = both(
    dot(expand(TEXTURE0), expand(PRIMARY), to=SPARE0), dot(expand(TEXTURE0), expand(SECONDARY), to=SPARE1)
)


def _one_minus_square():
    """1 - (t.c)^2 with c the primary colour."""
    return program(
        dot(expand(TEXTURE0), expand(PRIMARY), to=SPARE0),
        square(signed(SPARE0), to=SPARE0),
        final(one_minus(SPARE0)),
    )


def _product(lt):
    """((v.t)(l.t))+, or with ``lt`` negated (-(v.t)(l.t))+."""
    return program(_DOT_PRODUCTS, product(signed(SPARE0), lt, to=SPARE0), final(SPARE0))


def _irradiance(specular):
    """k_s (n.l)+: unit 0 has the normal map, unit 1 the tangent map, whose alpha is k_s."""
    return program(
        dot(expand(TEXTURE0), expand(PRIMARY), to=SPARE0),
        final(SPARE0, product(CONSTANT0, alpha_of(TEXTURE1))),
        constant0=specular,
    )


def specular_passes(
    surface, names, view, light, profile, *, specular=(1.0, 1.0, 1.0), subtract=None, sampler=REPEATED
):
    """The model in passes of two units and two general combiners; they replace the framebuffer's contents.

    Parameters as for ``anisotropic_blinn_phong.specular_pass``; ``names``: from ``load``. ``subtract``: True:
    a blend equation subtracts ((v.t)(l.t))+ (five passes); False: two inversions of the framebuffer do it
    (seven passes); None: as the machine's blend equations allow.
    """
    if subtract is None:
        subtract = BlendEquation.FUNC_REVERSE_SUBTRACT in profile.fragments.blend_equations
    toward_viewer = vector_colors(view_vectors(surface, view), profile)
    toward_light = vector_colors(light_vectors(surface, light), profile)
    seen, lit = surface.mesh(colors=toward_viewer), surface.mesh(colors=toward_light)
    both = surface.mesh(colors=toward_viewer, secondary_colors=toward_light)
    tangent, normal = unit(names.tangent, sampler), unit(names.normal, sampler)

    white = constant_product(ONE, (1.0, 1.0, 1.0))
    inverted = draw("one minus that", seen, view, white, blending=INVERT_DESTINATION)
    positive, negative = _product(signed(SPARE1)), _product(negated(SPARE1))
    if subtract:
        take_away = (draw("minus ((v.t)(l.t))+", both, view, positive, (tangent,), blending=SUBTRACT),)
    else:
        take_away = (
            inverted,
            draw("plus ((v.t)(l.t))+", both, view, positive, (tangent,), blending=ADD),
            inverted,
        )
    return (
        draw("1 - (v.t)^2", seen, view, _one_minus_square(), (tangent,), depth_test=FIRST_PASS),
        draw("times 1 - (l.t)^2", lit, view, _one_minus_square(), (tangent,), blending=MULTIPLY_DESTINATION),
        draw("plus (-(v.t)(l.t))+", both, view, negative, (tangent,), blending=ADD),
        *take_away,
        Saturate(label="(.)+: the framebuffer does not fall below zero", scissor=view.panel.scissor),
        draw(
            "times k_s (n.l)+",
            lit,
            view,
            _irradiance(specular),
            (normal, tangent),
            blending=MULTIPLY_DESTINATION,
        ),
    )


def combiners(specular=(1.0, 1.0, 1.0)):
    """The whole model as five general combiners and the final combiner.

    Unit 0 has the tangent map, unit 1 the normal map; v is the primary, l the secondary colour.
    """
    vt, lt = signed(SPARE0), signed(SPARE1)
    return program(
        _DOT_PRODUCTS,
        both(product(vt, lt, to=TEXTURE0), dot(expand(TEXTURE1), expand(SECONDARY), to=TEXTURE1)),
        both(square(vt, to=SPARE0), square(lt, to=SPARE1)),
        total(product(one_minus(SPARE0), one_minus(SPARE1)), negated(TEXTURE0), to=SPARE0),
        product(TEXTURE1, CONSTANT0, to=SPARE1),
        final(SPARE0, product(SPARE1, alpha_of(TEXTURE0))),
        constant0=specular,
    )


def specular_pass(surface, names, view, light, profile, *, specular=(1.0, 1.0, 1.0), sampler=REPEATED):
    """The model in one draw that replaces, for boards with five general combiners (GeForce 3).

    Parameters as for ``specular_passes``.
    """
    mesh = surface.mesh(
        colors=vector_colors(view_vectors(surface, view), profile),
        secondary_colors=vector_colors(light_vectors(surface, light), profile),
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
