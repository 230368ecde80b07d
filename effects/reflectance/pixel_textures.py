"""K15, dependent lookups by pixel textures on the Octane; every copy is a command.

It has the Banks model (K03), the anisotropic Blinn-Phong model (K05, K06) and Ward's model (K09).

The parameter stage loads a material texture through the color matrix, which holds a light, viewing or halfway
vector, and draws the polygon. Color masks put each parameter into a channel of the framebuffer; blending
multiplies and adds parameters. A lookup copies the framebuffer onto itself (CopyPixels). Its pixel transfer
moves the parameters' channels to red and green, which become s and t. It sets alpha, which becomes q, to one.
The texel replaces a channel, or blending multiplies the channel by it. So every channel, even alpha, can hold
a parameter.

The paper reads pixels to host memory and draws them again (section 5), as DrawPixels needs. With the
extension copies do the same, and no pixel leaves the board. ``through_host`` turns the copies into the
paper's commands: the same picture bit for bit, for four bytes a pixel each way.

The color matrix holds one vector. So the light is directional, the viewer infinite and the surface flat, as
the paper says. The stencil buffer marks the polygon's pixels, so copies of the panel leave the others alone.
The result replaces the polygon's pixels; a diffuse pass is added afterwards.

``bits``: the textures' width, 8, or 12 on the Octane. The framebuffer's width is ``execute``'s
``color_bits``.

Source: Kautz, Seidel 2000, sections 3.1 to 3.3, 4.2 and 5; SGIX_pixel_texture; pass sequences A-K03, A-K05,
A-K06, A-K08 and A-K09 of the catalogue (K15: its cost).
"""

from enum import Enum

import numpy as np

from fixedpipe.effects.geometry.vertex_vectors import half_vectors, light_vectors, view_vectors
from fixedpipe.effects.passes.arguments import checked_rgb, member_of, positive
from fixedpipe.effects.passes.draws import ADD, MULTIPLY_DESTINATION, REPEATED, SUBTRACT_FROM_SOURCE
from fixedpipe.effects.passes.pixel_texture_copies import (
    ALPHA,
    BLUE,
    FROM_ALPHA,
    FROM_BLUE,
    FROM_GREEN,
    FROM_RED,
    GREEN_BLUE,
    NOTHING,
    RED,
    RGB,
    RGBA,
    begin,
    color_table_size,
    copied,
    dot_with,
    flat_vector,
    float_image,
    load_products,
    load_squares,
    looked_up,
    polygon,
    tabulated,
    texture_format,
    unchanged,
)
from fixedpipe.effects.reflectance import brdfs
from fixedpipe.effects.reflectance.sampled_functions import (
    LARGEST_M,
    LARGEST_S_NL,
    power,
    sampled,
    stored_exponent,
)
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.pixel_transfer import PixelTransfer
from fixedpipe.pipeline.state import ColorTable

TECHNIQUES = (
    Technique("K03", "the Banks model, exact: sqrt(1 - s) by a dependent lookup", "3.1"),
    Technique("K05", "the anisotropic Blinn-Phong model with an exponent per texel", "3.2"),
    Technique("K06", "the anisotropic Blinn-Phong model without an exponent", "3.2"),
    Technique("K09", "Ward's model by two dependent lookups", "3.3"),
    Technique("K15", "pixel textures as the dependent lookups, and what they cost", "5"),
)

# R(s) = sqrt(1 - s) falls with infinite slope at s = 1: 2048 texels, the Octane's most, leave an error of
# sqrt(1/2 / 2048) = 0.016 between the last two, which codes of eight bits never meet (erratum E004.16).
ROOT_TEXELS = 2048
# F(N, e): Source: pass sequence A-K05.
EXPONENT_TEXELS, BASE_TEXELS = 64, 256
# E(m, d), steep in m: within half a texel of m = 0, the highlight's middle, it is E(0, d), off by less than
# 8 / 2048. Assumed: so many fit; the catalogue names no size.
M_TEXELS, D_TEXELS = 1024, 128
# Ward's S(p) is stored over its largest value, 8, and clamped beyond: p < 1/64. Source: A-K09, P18.
LARGEST_S = 8.0


def _colored(color):
    """Rows that make a colour of one value: times the colour's components."""
    return [(c, 0.0, 0.0, 0.0) for c in checked_rgb(color)]


def banks(
    surface,
    material,
    view,
    light,
    profile,
    *,
    specular=(1.0, 1.0, 1.0),
    bits=8,
    sampler=REPEATED,
    exponent=1.0,
):
    """K03: k_s (n.l)+ (R((v.t)^2) R((l.t)^2) - (v.t)(l.t))+ with R(s) = sqrt(1 - s) looked up twice.

    The product (v.t)(l.t) has a sign and framebuffers have none: its halves (v.t l.t)+ and (-v.t l.t)+ come
    from the halves of both factors: four products in the four channels. The last copy's color matrix
    subtracts the first and adds the second. Four copies, two of them lookups.

    Parameters ---------- surface, view, light A flat surface, an infinite viewer and a directional light.
    material A ``material_textures.Material``; its alphas are not used. specular RGB in [0, 1], by which k_s
    is multiplied. bits 8 or 12: of the textures. exponent Exponent of the bracket, positive: 1 as the paper
    prints, or Banks's own (erratum E004.2), which takes a lookup and so one more copy.

    Raises ValueError where the vectors change over the surface.
    """
    toward_light = flat_vector(light_vectors(surface, light), "light vector")
    toward_eye = flat_vector(view_vectors(surface, view), "viewing vector")

    def halves(vector, order):
        return [dot_with(vector, sign) for sign in order]

    drawn = {"surface": surface, "view": view, "sampler": sampler}
    raised, exponent = (), positive(exponent, "The bracket's exponent")
    if exponent != 1.0:
        table = sampled(lambda b: b**exponent, ROOT_TEXELS, profile=profile, bits=bits)
        raised = (
            TexImage(label=f"load b^{exponent:g}", texture="power", image=table),
            looked_up(f"look up the bracket's power {exponent:g}", view, "power", FROM_RED),
        )
    return (
        TexImage(
            label="load R(s) = sqrt(1 - s)",
            texture="R",
            image=sampled(brdfs.banks_r, ROOT_TEXELS, profile=profile, bits=bits),
        ),
        begin(view),
        load_products(
            "load t through v: halves of v.t",
            "v.t",
            material.tangents,
            halves(toward_eye, (1, -1, 1, -1)),
            profile,
            bits,
        ),
        polygon("(v.t)+, (-v.t)+, (v.t)+, (-v.t)+", texture="v.t", first=True, **drawn),
        load_products(
            "load t through l: halves of l.t",
            "l.t",
            material.tangents,
            halves(toward_light, (1, -1, -1, 1)),
            profile,
            bits,
        ),
        polygon(
            "times (l.t)+, (-l.t)+, (-l.t)+, (l.t)+", texture="l.t", blending=MULTIPLY_DESTINATION, **drawn
        ),
        copied(
            "(v.t l.t)+ to green, (-v.t l.t)+ to blue",
            view,
            (NOTHING, (1.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 1.0)),
            profile,
            mask=GREEN_BLUE,
        ),
        load_squares("load t through v: (v.t)^2", "(v.t)^2", material.tangents, toward_eye, profile, bits),
        polygon("(v.t)^2 to alpha", texture="(v.t)^2", mask=ALPHA, **drawn),
        looked_up("look up R((v.t)^2), to red", view, "R", FROM_ALPHA, mask=RED),
        load_squares("load t through l: (l.t)^2", "(l.t)^2", material.tangents, toward_light, profile, bits),
        polygon("(l.t)^2 to alpha", texture="(l.t)^2", mask=ALPHA, **drawn),
        looked_up(
            "look up R((l.t)^2), times red", view, "R", FROM_ALPHA, mask=RED, blending=MULTIPLY_DESTINATION
        ),
        copied("R R - (v.t l.t)+ + (-v.t l.t)+", view, ((1.0, -1.0, 1.0, 0.0),) * 3, profile, mask=RGBA),
        *raised,
        *_times_normal_light(material, toward_light, profile, bits, **drawn),
        *_times_gloss(material.k_s, specular, profile, bits, **drawn),
    )


def _times_normal_light(material, toward_light, profile, bits, *, gain=1.0, mask=RGB, **drawn):
    what = "(n.l)+" if gain == 1.0 else f"min(1, {gain:g} (n.l)+)"
    return (
        load_products(
            f"load n through l: {what}",
            "n.l",
            material.normals,
            [dot_with(toward_light, gain)] * 4,
            profile,
            bits,
        ),
        polygon(f"times {what}", texture="n.l", mask=mask, blending=MULTIPLY_DESTINATION, **drawn),
    )


def _times_gloss(k_s, specular, profile, bits, *, what="k_s", **drawn):
    rows = [*_colored(specular), FROM_RED]
    return (
        load_products(f"load {what}", "k_s", k_s, rows, profile, bits),
        polygon(f"times {what}", texture="k_s", mask=RGB, blending=MULTIPLY_DESTINATION, **drawn),
    )


def power_table(profile, bits=8):
    """F's texture: log2(N) / 7 along its columns, e along its rows."""
    return sampled(power, EXPONENT_TEXELS, BASE_TEXELS, profile=profile, bits=bits)


def root_table(profile, bits=8):
    """The texture of sqrt(e), F(N, e) at N = 1 (K06)."""
    return sampled(np.sqrt, ROOT_TEXELS, profile=profile, bits=bits)


class UpTo(Enum):
    """How far K05 is drawn."""

    COORDINATES = "coordinates"  # the pixels (s, t) that are looked up
    LOOKUP = "lookup"  # F(N, e)
    GLOSS = "gloss"  # k_s F(N, e)


def blinn_phong(
    surface,
    material,
    view,
    light,
    profile,
    *,
    specular=(1.0, 1.0, 1.0),
    bits=8,
    sampler=REPEATED,
    with_exponent=True,
    gated=False,
    up_to=UpTo.GLOSS,
):
    """K05: k_s F(N, e) with F(N, e) = (sqrt e)^N looked up, e = 1 - (h.t/ax)^2 - (h.b/ay)^2 and N per texel.

    K06, without ``with_exponent``: k_s sqrt(e), a one-dimensional lookup.

    Three passes compute e, as ``imaging_subset`` computes Eq. 1 (K08). A color mask puts the image of N,
    coded as log2(N) / 7, into red; the lookup reads s from red and t from green. This takes one copy. Alphas
    below 1/4 are allowed.

    ``gated``: times min(1, 4 (n.l)+), as ``diffuse_bump`` gates the register combiners' pass. ``up_to``: the
    pass at which it ends. The other parameters are those of ``banks``.
    """
    member_of(UpTo, up_to, "How far it is drawn")
    half = flat_vector(half_vectors(surface, view, light), "halfway vector")
    scaled_t = material.tangents / material.alpha_x[..., None]
    scaled_b = material.binormals / material.alpha_y[..., None]
    drawn = {"surface": surface, "view": view, "sampler": sampler}
    if with_exponent:
        table = TexImage(label="load F(N, e) = (sqrt e)^N", texture="F", image=power_table(profile, bits))
        lookup = (
            load_products(
                "load log2(N) / 7",
                "N",
                stored_exponent(material.exponent),
                [FROM_RED] * 4,
                profile,
                bits,
            ),
            polygon("N to red", texture="N", mask=RED, **drawn),
            looked_up("look up F(N, e)", view, "F", FROM_RED, FROM_GREEN),
        )
    else:
        table = TexImage(label="load sqrt(e)", texture="F", image=root_table(profile, bits))
        lookup = (looked_up("look up sqrt(e)", view, "F", FROM_GREEN),)
    gate = ()
    if gated:
        toward_light = flat_vector(light_vectors(surface, light), "light vector")
        gate = _times_normal_light(material, toward_light, profile, bits, gain=4.0, **drawn)
    shaded = (*_times_gloss(material.k_s, specular, profile, bits, **drawn), *gate)
    if up_to is not UpTo.GLOSS:
        lookup, shaded = lookup if up_to is UpTo.LOOKUP else lookup[:-1], ()
    return (
        table,
        begin(view),
        load_squares("load t/ax through h: (h.t/ax)^2", "(h.t)^2", scaled_t, half, profile, bits),
        polygon("(h.t/ax)^2", texture="(h.t)^2", first=True, **drawn),
        load_squares("load b/ay through h: (h.b/ay)^2", "(h.b)^2", scaled_b, half, profile, bits),
        polygon("plus (h.b/ay)^2", texture="(h.b)^2", mask=RGB, blending=ADD, **drawn),
        polygon("e: one minus it", mask=RGB, blending=SUBTRACT_FROM_SOURCE, **drawn),
        *lookup,
        *shaded,
    )


def diffuse(
    surface, material, view, light, profile, *, color, ambient=(0.0, 0.0, 0.0), bits=8, sampler=REPEATED
):
    """K10 by the color matrix: (n.l)+ color + ambient, RGB in [0, 1] each, added to the pixels that the
    polygon covers.

    The table after the color matrix multiplies by the colour and adds the ambient term.
    """
    toward_light = flat_vector(light_vectors(surface, light), "light vector")
    index = np.arange(color_table_size(profile)) / (color_table_size(profile) - 1.0)
    color, ambient = checked_rgb(color), checked_rgb(ambient, "The ambient light's colour")
    columns = [c * index + a for c, a in zip((*color, 1.0), (*ambient, 0.0), strict=True)]
    transfer = PixelTransfer(
        color_matrix=(dot_with(toward_light),) * 4,
        post_color_matrix_color_table=ColorTable(tuple(map(tuple, np.stack(columns, axis=-1).tolist()))),
    )
    loading = TexImage(
        label="load n through l: (n.l)+ color + ambient",
        texture="diffuse",
        pixels=float_image(material.normals),
        internal_format=texture_format(bits),
        transfer=transfer,
    )
    added = polygon("plus diffuse", surface, view, "diffuse", mask=RGB, blending=ADD, sampler=sampler)
    return (loading, added)


def ward(
    surface,
    material,
    view,
    light,
    profile,
    *,
    specular=(1.0, 1.0, 1.0),
    bits=8,
    sampler=REPEATED,
    largest_s=LARGEST_S,
    largest_m=LARGEST_M,
):
    """K09: k_s / (4 pi ax ay) S(p) E(m, d) (n.l)+ with S(p) = 1/sqrt(p) and E(m, d) = exp(-2 m / (1 + d))
    looked up.

    Here p = (l.n)(v.n), m = (h.t/ax)^2 + (h.b/ay)^2, d = h.n.

    p is spaced by its root. That is the product of the factors' roots, which tables after the color matrix
    can give. S is stored over ``largest_s``, m over ``largest_m``; larger values are clamped. The third copy
    multiplies by ``largest_s``, except for a factor of 2, which leaves room for S(p) (n.l)+. The next texture
    has that factor. If it exceeds one, it is divided by its largest value, and a fourth copy multiplies that
    back. Two copies are lookups.

    A smaller ``largest_s`` gives S more codes: 2 is enough for p >= 1/4. A bump that faces away from the eye
    is invisible, and counts as p = 0. The other parameters are those of ``banks``. Raises ValueError
    likewise.
    """
    toward_light = flat_vector(light_vectors(surface, light), "light vector")
    toward_eye = flat_vector(view_vectors(surface, view), "viewing vector")
    half = flat_vector(half_vectors(surface, view, light), "halfway vector")
    scaled_t = material.tangents / material.alpha_x[..., None]
    scaled_b = material.binormals / material.alpha_y[..., None]
    largest_s, largest_m = positive(largest_s, "The largest S"), positive(largest_m, "The largest m")
    gloss = brdfs.ward_scale(material.alpha_x, material.alpha_y, material.k_s)
    most = max(1.0, LARGEST_S_NL * float(gloss.max()))
    drawn = {"surface": surface, "view": view, "sampler": sampler}
    roots = tabulated(profile, np.sqrt, unchanged, unchanged, unchanged)

    def factor(name, vector, other):
        """sqrt(n.vector) in red, beside it ``other``."""
        transfer = PixelTransfer(
            color_matrix=(dot_with(vector), other, NOTHING, NOTHING), post_color_matrix_color_table=roots
        )
        return TexImage(
            label=f"load n through {name}",
            texture=name,
            pixels=float_image(material.normals),
            internal_format=texture_format(bits),
            transfer=transfer,
        )

    restored = ()
    if most > 1.0:
        restored = (
            copied(
                f"times {most:.3g}",
                view,
                [_scaled(row, most) for row in (FROM_RED, FROM_GREEN, FROM_BLUE)],
                profile,
            ),
        )
    return (
        TexImage(
            label=f"load S(p) / {largest_s:g} over sqrt(p)",
            texture="S",
            image=sampled(
                lambda u: np.minimum(brdfs.ward_s(u * u) / largest_s, 1.0),
                ROOT_TEXELS,
                profile=profile,
                bits=bits,
            ),
        ),
        TexImage(
            label=f"load E(m / {largest_m:g}, d)",
            texture="E",
            image=sampled(
                lambda m, d: brdfs.ward_e(largest_m * m, d), M_TEXELS, D_TEXELS, profile=profile, bits=bits
            ),
        ),
        begin(view),
        factor("l", toward_light, dot_with(half)),
        polygon("sqrt((l.n)+) to red, d = h.n to green", texture="l", first=True, **drawn),
        factor("v", toward_eye, NOTHING),
        polygon("times sqrt((v.n)+): sqrt(p)", texture="v", mask=RED, blending=MULTIPLY_DESTINATION, **drawn),
        looked_up("look up S(p), to blue", view, "S", FROM_RED, mask=BLUE),
        load_squares(
            "load t/ax through h: (h.t/ax)^2", "(h.t)^2", scaled_t, half, profile, bits, scale=1.0 / largest_m
        ),
        polygon("(h.t/ax)^2 to red", texture="(h.t)^2", mask=RED, **drawn),
        load_squares(
            "load b/ay through h: (h.b/ay)^2", "(h.b)^2", scaled_b, half, profile, bits, scale=1.0 / largest_m
        ),
        polygon("plus (h.b/ay)^2: m", texture="(h.b)^2", mask=RED, blending=ADD, **drawn),
        looked_up(
            "look up E(m, d), times blue",
            view,
            "E",
            FROM_RED,
            FROM_GREEN,
            mask=BLUE,
            blending=MULTIPLY_DESTINATION,
        ),
        *_times_normal_light(material, toward_light, profile, bits, mask=BLUE, **drawn),
        copied(
            f"S(p) E(m, d) (n.l)+ / {LARGEST_S_NL:g}: times {largest_s / LARGEST_S_NL:g}",
            view,
            [_scaled(FROM_BLUE, largest_s / LARGEST_S_NL)] * 3,
            profile,
        ),
        *_times_gloss(
            gloss * (LARGEST_S_NL / most), specular, profile, bits, what="k_s / (4 pi ax ay)", **drawn
        ),
        *restored,
    )


def _scaled(row, factor):
    return tuple(factor * c for c in row)
