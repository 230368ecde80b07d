"""K03, K05 and K06 on a GeForce 3: two dot products of texture shaders address a dependent lookup.

A texture shader's dot product multiplies a texture coordinate, a float vector from the vertices, with an
earlier unit's texel. Two of them are s and t of a table, so a function of two dot products takes one pass:

    Banks         unit 0: t, unit 1: l.t, unit 2: v.t and the whole bracket from a table, unit 3: n;
                  combiners: (n.l)+ k_s
    Blinn-Phong   units 0 and 1: t/ax and b/ay, unit 2: h.t/ax, unit 3: h.b/ay and F(N, e) from a table;
                  combiners: k_s. N is one number, the table's; with N = 1 it is K06

The tables' arguments have signs. Zero lies on the corner of texel (0, 0), and wrapping puts negative
arguments at the other end (REPEAT). Arguments beyond the function's domain must not wrap into it. So the
period is larger than the domain by the farthest argument (A-K05 leaves this open).

On every machine that has dot products, they read the byte n as (n - 128)/127; combiners read 2n - 256.
Textures that dot products alone read are stored for them, as 128 + 127 v.

Source: Kautz, Seidel 2000, sections 3.1 and 3.2; NV_texture_shader, sections 3.8.13.1.14 and 3.8.13.1.15;
pass sequences A-K03, A-K05 and A-K06 of the catalogue.
"""

from dataclasses import dataclass

import numpy as np

from fixedpipe.effects.geometry.vertex_vectors import half_vectors, light_vectors, view_vectors
from fixedpipe.effects.passes.combiners import (
    CONSTANT0,
    PRIMARY,
    SPARE0,
    TEXTURE0,
    TEXTURE2,
    TEXTURE3,
    alpha_of,
    dot,
    expand,
    final,
    product,
    program,
)
from fixedpipe.effects.passes.draws import ADD, ADD_GATED, FIRST_PASS, LATER_PASS, REPEATED, draw, unit
from fixedpipe.effects.passes.encoding import dot_product_texels, factor_texels, vector_colors
from fixedpipe.effects.passes.texture_shaders import NO_TEXTURE, TEXTURE_STAGE, dot_product_stages
from fixedpipe.effects.reflectance import brdfs
from fixedpipe.effects.technique import Variant
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.enums import InternalFormat
from fixedpipe.pipeline.textures.images import texture_2d

TECHNIQUES = (Variant(("K03", "K05", "K06"), "on a GeForce 3, by a texture shader's dot products"),)

# Two fifths of them are the lobe's where the smallest alpha is 1/4: 205 across. Assumed: a quarter of a
# megabyte is small enough for a GeForce 3.
BLINN_PHONG_TEXELS = 512
BANKS_TEXELS = 256
# Texels of the Banks table outside [-1, 1] on either side, which hold the function at the ends: a texel's
# byte may leave a dot product beyond one, and the filter reads a neighbour.
_GUARD = 2


def centered_table(function, texels, period, profile):
    """A table of a function of two numbers from -period/2 to period/2, zero on the corner of texel (0, 0).

    Bytes are rounded at once, so that they do not depend on a library's powers.
    """
    place = (np.arange(texels) + 0.5) / texels
    argument = period * np.where(place < 0.5, place, place - 1.0)
    values = np.clip(function(argument[None, :], argument[:, None]), 0.0, 1.0)
    return texture_2d(factor_texels(values, profile)[..., None], InternalFormat.LUMINANCE8)


# ------------------------------------------------------------------------------------------------ Banks


@dataclass(frozen=True)
class BanksNames:
    """The names of three texture objects: the normal map, the tangent map with k_s in alpha, the table."""

    normal: str
    tangent: str
    table: str


def banks_period():
    """How far the Banks table's arguments reach, its guard texels included."""
    return 2.0 * BANKS_TEXELS / (BANKS_TEXELS - 2.0 * _GUARD)


def banks_table(profile, exponent=1.0):
    """The bracket (R((v.t)^2) R((l.t)^2) - (v.t)(l.t))+ to the power ``exponent`` over (l.t, v.t)."""

    def bracket(light_tangent, view_tangent):
        limited = (np.clip(x, -1.0, 1.0) for x in (view_tangent, light_tangent))
        return brdfs.banks_bracket(*limited) ** exponent

    return centered_table(bracket, BANKS_TEXELS, banks_period(), profile)


def load_banks(material, name, profile, *, exponent=1.0):
    """Commands that load what ``banks_pass`` reads, and its names."""
    names = BanksNames(f"{name} n", f"{name} t", f"bracket^{exponent:g}")
    tangents = texture_2d(dot_product_texels(material.tangents, material.k_s, profile))
    return (
        TexImage(
            label=f"load normal map of {name}", texture=names.normal, image=material.normal_texture(profile)
        ),
        TexImage(label=f"load tangent map of {name}: t, k_s", texture=names.tangent, image=tangents),
        TexImage(
            label="load (R((v.t)^2) R((l.t)^2) - (v.t)(l.t))+ over (l.t, v.t)",
            texture=names.table,
            image=banks_table(profile, exponent),
        ),
    ), names


def _banks_combiners(specular):
    """(n.l)+ times the bracket of unit 2 times k_s."""
    return program(
        dot(expand(TEXTURE3), expand(PRIMARY), to=SPARE0),
        product(SPARE0, TEXTURE2, to=SPARE0),
        _times_gloss(SPARE0),
        constant0=specular,
    )


def _times_gloss(register):
    """A register times constant color 0 and unit 0's alpha, k_s."""
    return final(register, product(CONSTANT0, alpha_of(TEXTURE0)))


def banks_pass(
    surface, names, view, light, profile, *, specular=(1.0, 1.0, 1.0), first=False, sampler=REPEATED
):
    """K03, k_s (n.l)+ times the bracket, in one draw.

    Parameters as for ``anisotropic_blinn_phong.specular_pass``; ``names``: from ``load_banks``.
    """
    scale = 1.0 / banks_period()
    to_light, to_viewer = light_vectors(surface, light), view_vectors(surface, view)
    mesh = surface.mesh(
        surface.texture_coordinates,
        scale * to_light,
        scale * to_viewer,
        colors=vector_colors(to_light, profile),
    )
    units = (
        unit(names.tangent, sampler),
        unit(NO_TEXTURE, coordinates=1),
        unit(names.table, REPEATED, coordinates=2),
        unit(names.normal, sampler),
    )
    return (
        draw(
            "specular pass: k_s (n.l)+ (R((v.t)^2) R((l.t)^2) - (v.t)(l.t))+",
            mesh,
            view,
            _banks_combiners(specular),
            units,
            depth_test=FIRST_PASS if first else LATER_PASS,
            blending=None if first else ADD,
            texture_shader=(TEXTURE_STAGE, *dot_product_stages(0, 0), TEXTURE_STAGE),
        ),
    )


# ------------------------------------------------------------------------------- anisotropic Blinn-Phong


@dataclass(frozen=True)
class BlinnPhongNames:
    """The names of three texture objects: t/ax with k_s in alpha, b/ay, and the table; and the smallest
    alpha, which multiplies both stored vectors.
    """

    tangent: str
    binormal: str
    table: str
    smallest_alpha: float


def blinn_phong_period(smallest_alpha):
    """How far the table's arguments reach: h.t/ax and h.b/ay are at most 1/``smallest_alpha``, and that comes
    round to -1, where F is zero.
    """
    return 1.0 / smallest_alpha + 1.0


def blinn_phong_table(exponent, smallest_alpha, profile):
    """F(N, e) = (sqrt e)^N of one N over (h.t/ax, h.b/ay)."""

    def power(x, y):
        return brdfs.blinn_phong_f(exponent, np.maximum(0.0, 1.0 - x * x - y * y))

    return centered_table(power, BLINN_PHONG_TEXELS, blinn_phong_period(smallest_alpha), profile)


def load_blinn_phong(material, name, profile, *, exponent=2.0):
    """Commands that load what ``blinn_phong_pass`` reads, and its names. ``exponent``: N, 1 for K06.

    Vectors divided by alpha are stored times the material's smallest alpha, so that none exceeds one. If that
    is 1/4, this is the paper's scale. The material's own exponents are not read.
    """
    smallest = float(min(material.alpha_x.min(), material.alpha_y.min()))
    names = BlinnPhongNames(
        f"{name} t/ax for dot products",
        f"{name} b/ay for dot products",
        f"F({exponent:g}, e) from alpha {smallest:g}",
        smallest,
    )

    def scaled(vectors, alpha, factor):
        return texture_2d(dot_product_texels(smallest * vectors / alpha[..., None], factor, profile))

    return (
        TexImage(
            label=f"load material texture of {name}: {smallest:g} tangent / alpha_x, k_s",
            texture=names.tangent,
            image=scaled(material.tangents, material.alpha_x, material.k_s),
        ),
        TexImage(
            label=f"load material texture of {name}: {smallest:g} binormal / alpha_y",
            texture=names.binormal,
            image=scaled(material.binormals, material.alpha_y, 1.0),
        ),
        TexImage(
            label=f"load F(N, e) = (sqrt e)^N, N = {exponent:g}, over (h.t/ax, h.b/ay)",
            texture=names.table,
            image=blinn_phong_table(exponent, smallest, profile),
        ),
    ), names


def blinn_phong_pass(
    surface,
    names,
    view,
    light,
    profile,
    *,
    specular=(1.0, 1.0, 1.0),
    first=False,
    gated=True,
    sampler=REPEATED,
):
    """K05 with one N for the surface, or K06: k_s (sqrt e)^N in one draw.

    Parameters as for ``anisotropic_blinn_phong.specular_pass``; ``names``: from ``load_blinn_phong``.
    """
    scale = 1.0 / names.smallest_alpha / blinn_phong_period(names.smallest_alpha)
    mesh = surface.mesh(surface.texture_coordinates, scale * half_vectors(surface, view, light))
    units = (
        unit(names.tangent, sampler),
        unit(names.binormal, sampler),
        unit(NO_TEXTURE, coordinates=1),
        unit(names.table, REPEATED, coordinates=1),
    )
    combiners = program(_times_gloss(TEXTURE3), constant0=specular)
    return (
        draw(
            "specular pass: k_s F(N, e), e = 1 - (h.t/ax)^2 - (h.b/ay)^2",
            mesh,
            view,
            combiners,
            units,
            depth_test=FIRST_PASS if first else LATER_PASS,
            blending=None if first else ADD_GATED if gated else ADD,
            texture_shader=(TEXTURE_STAGE, TEXTURE_STAGE, *dot_product_stages(0, 1)),
        ),
    )
