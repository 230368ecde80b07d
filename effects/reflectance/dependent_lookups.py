"""K01's framework as the paper draws it, on a GeForce 3: parameters on the screen, then dependent lookups.

    1  the parameter stage: register combiners write up to four parameters to the framebuffer's channels
    2  CopyTexSubImage: the panel becomes a texture, padded to powers of two
    3  the surface again: unit 0 reads its own pixel of that texture (NEAREST), a unit after it looks a
       function up at alpha and red (DEPENDENT_AR_TEXTURE_2D), another at green and blue
       (DEPENDENT_GB_TEXTURE_2D); combiners multiply the results

Each function may have two parameters. They vary per pixel without restriction, unlike in
``dot_product_lookups``:

    Blinn-Phong (K05)   red e, alpha N/128; F(N, e) = (sqrt e)^N
    Ward (K09)          red d, green p, alpha m; E(m, d) = exp(-2 m / (1 + d)) and S(p) = 1/sqrt(p)
    the paper's Fig. 1  red t, green u, blue v, alpha s; F(s, t) = exp(s/t) and G(u, v) = sqrt(u^v)

The last pass replaces the framebuffer's contents on the surface; a diffuse pass is added afterwards.
Parameters have eight bits in the framebuffer, whatever the combiners have.

Source: Kautz, Seidel 2000, section 3, figure 1 and sections 3.2 and 3.3; NV_texture_shader, sections
3.8.13.1.12 and 3.8.13.1.13; pass sequences A-K05 and A-K09 of the catalogue.
"""

from dataclasses import dataclass

import numpy as np

from fixedpipe.effects.geometry import matrices
from fixedpipe.effects.geometry.vertex_vectors import half_vectors, light_vectors, view_vectors
from fixedpipe.effects.passes.arguments import checked_rgb, one_of
from fixedpipe.effects.passes.combiners import (
    CONSTANT0,
    CONSTANT1,
    ONE,
    PRIMARY,
    SECONDARY,
    SPARE0,
    SPARE1,
    TEXTURE0,
    TEXTURE1,
    TEXTURE2,
    TEXTURE3,
    alpha_of,
    blue_of,
    both,
    dot,
    expand,
    final,
    gate,
    one_minus,
    opaque,
    product,
    program,
    scaled,
    shown,
    signed,
    square,
    stage,
    total,
)
from fixedpipe.effects.passes.draws import EDGE, FIRST_PASS, NEAREST, REPEATED, draw, unit
from fixedpipe.effects.passes.encoding import vector_and_factor_texels, vector_colors
from fixedpipe.effects.passes.texture_shaders import (
    ALPHA_RED_STAGE,
    GREEN_BLUE_STAGE,
    PASS_THROUGH_STAGE,
    TEXTURE_STAGE,
)
from fixedpipe.effects.reflectance import brdfs
from fixedpipe.effects.reflectance.lookup_framework import RESULT, STAGES
from fixedpipe.effects.reflectance.material_textures import LARGEST_EXPONENT, SMALLEST_ALPHA
from fixedpipe.effects.reflectance.sampled_functions import LARGEST_M, LARGEST_S_NL, sampled
from fixedpipe.effects.technique import Variant
from fixedpipe.pipeline.commands import CopyTexSubImage, TexImage
from fixedpipe.pipeline.textures.images import texture_2d

TECHNIQUES = (Variant(("K01", "K05", "K09"), "on a GeForce 3, through a copy of the screen"),)

TABLE_TEXELS = 256
# F(N, e) is steep where e is near one: (sqrt e)^128 falls by half within 0.011.
BASE_TEXELS = 1024
SCREEN = "parameters on the screen"

RED, GREEN, BLUE = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


# ------------------------------------------------------------------------------------- the screen's texture


def _padded(panel):
    return tuple(1 << (edge - 1).bit_length() for edge in (panel.width, panel.height))


def load_screen(panel):
    """The command that makes room for a panel's parameters: once, as the textures are loaded."""
    columns, rows = _padded(panel)
    return TexImage(
        label="room for the parameters on the screen",
        texture=SCREEN,
        image=texture_2d(np.zeros((rows, columns, 4), np.uint8)),
    )


def copy_screen(view):
    """The command that makes the panel's parameters a texture."""
    panel = view.panel
    return CopyTexSubImage(
        label="the parameters become a texture",
        texture=SCREEN,
        x=panel.x,
        y=panel.y,
        width=panel.width,
        height=panel.height,
    )


def screen_unit(view, coordinates):
    """The unit that reads the parameters where its own pixel is; coordinate set: the vertices' positions.

    The texture matrix is the view's, and then takes the panel to its part of the padded texture.
    """
    panel, (columns, rows) = view.panel, _padded(view.panel)
    s, t = panel.width / columns / 2.0, panel.height / rows / 2.0
    to_texture = ((s, 0.0, 0.0, s), (0.0, t, 0.0, t), (0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))
    matrix = matrices.product(to_texture, view.projection, view.modelview)
    return unit(SCREEN, NEAREST, coordinates=coordinates, matrix=matrix)


# ------------------------------------------------------------------------------------- material textures


@dataclass(frozen=True)
class LookupNames:
    """The names of a material's texture objects, and the numbers by which they are stored.

    normal, tangent, binormal  n, t/ax and b/ay; their alphas hold Ward's factor, k_s and N/128
    scale                      the factor of t/ax and b/ay: 1/4, or 1/8 for alphas below 1/4
    largest_factor             largest k_s / (4 pi ax ay), by which the stored one is divided
    """

    normal: str
    tangent: str
    binormal: str
    scale: float
    largest_factor: float


def storage_scale(material):
    """The factor that makes vectors divided by alpha fit [-1, 1]: 1/4, as in the paper, for alphas from 1/4,
    else 1/8.

    Combiners undo it in powers of two. Raises ValueError for alphas below 1/8.
    """
    smallest = float(min(material.alpha_x.min(), material.alpha_y.min()))
    if smallest < SMALLEST_ALPHA / 2.0:
        raise ValueError(
            f"The smallest alpha is {smallest:g}; combiners take vectors of alphas of "
            f"{SMALLEST_ALPHA / 2.0:g} and more. Give larger alphas, or draw with "
            "fixedpipe.effects.reflectance.dot_product_lookups."
        )
    return SMALLEST_ALPHA if smallest >= SMALLEST_ALPHA else SMALLEST_ALPHA / 2.0


def load(material, name, profile):
    """Commands that load a material's three textures, and their LookupNames."""
    scale = storage_scale(material)
    factor = brdfs.ward_scale(material.alpha_x, material.alpha_y, material.k_s)
    # Rounded up to 24 bits, so that no library's last bit decides a byte.
    largest = float(np.ceil(factor.max() * 2.0**20)) / 2.0**20 or 1.0
    names = LookupNames(f"{name} n, Ward's factor", f"{name} t/ax", f"{name} b/ay", scale, largest)
    tangents = scale * material.tangents / material.alpha_x[..., None]
    binormals = scale * material.binormals / material.alpha_y[..., None]

    def image(vectors, alpha):
        return texture_2d(vector_and_factor_texels(vectors, alpha, profile))

    return (
        TexImage(
            label=f"load normal map of {name}; k_s / (4 pi ax ay) / {largest:.4g}",
            texture=names.normal,
            image=image(material.normals, factor / largest),
        ),
        TexImage(
            label=f"load material texture of {name}: {scale:g} tangent / alpha_x, k_s",
            texture=names.tangent,
            image=image(tangents, material.k_s),
        ),
        TexImage(
            label=f"load material texture of {name}: {scale:g} binormal / alpha_y, N / 128",
            texture=names.binormal,
            image=image(binormals, material.exponent / LARGEST_EXPONENT),
        ),
    ), names


# --------------------------------------------------------------------- the anisotropic Blinn-Phong model


def power(n, e):
    """F(N, e) = (sqrt e)^N of N/128 and e in [0, 1]."""
    return brdfs.blinn_phong_f(LARGEST_EXPONENT * np.asarray(n), e)


def load_power(profile):
    """The command that loads F as the texture "F(N, e)", N/128 along its columns."""
    return TexImage(
        label="load F(N, e) = (sqrt e)^N",
        texture="F(N, e)",
        image=sampled(power, TABLE_TEXELS, BASE_TEXELS, profile=profile),
    )


def _dots(h):
    """h.t/ax in spare 0 and h.b/ay in spare 1, as they are stored in units 0 and 1."""
    return both(dot(expand(TEXTURE0), h, to=SPARE0), dot(expand(TEXTURE1), h, to=SPARE1))


def _squares(to):
    return total(square(signed(SPARE0)), square(signed(SPARE1)), to=to)


def _e_and_n(scale):
    """RGB = 1 - (h.t/ax)^2 - (h.b/ay)^2, alpha = N/128."""
    # Dot products are four times the stored ones: h.t/ax where a quarter is stored, else half of it.
    ratio = round(SMALLEST_ALPHA / scale)
    return program(
        scaled(4, _dots(expand(PRIMARY))),
        scaled(ratio * ratio, _squares(to=SPARE0)),
        final(one_minus(SPARE0), alpha=TEXTURE1),
    )


def _gated_lookup(specular, gated):
    """F of unit 1, times k_s of unit 2's alpha, times min(1, 4 (n.l)+) of unit 3."""
    return program(
        dot(expand(TEXTURE3), expand(PRIMARY), to=SPARE0),
        stage(product(TEXTURE1, CONSTANT0, to=SPARE1), alpha=gate(SPARE0)),
        final(alpha_of(SPARE0) if gated else ONE, product(SPARE1, alpha_of(TEXTURE2))),
        constant0=specular,
    )


def blinn_phong_passes(
    surface, names, view, light, profile, *, specular=(1.0, 1.0, 1.0), gated=True, sampler=REPEATED
):
    """K05 with an exponent per texel: k_s F(N, e), F looked up in "F(N, e)" (``load_power``).

    Parameters as for ``anisotropic_blinn_phong.specular_pass``; ``names``: from ``load``; ``gated``: times
    min(1, 4 (n.l)+). ``load_screen`` has made room on this panel.
    """
    parameters = surface.mesh(colors=vector_colors(half_vectors(surface, view, light), profile))
    lit = surface.mesh(
        surface.texture_coordinates,
        surface.positions,
        colors=vector_colors(light_vectors(surface, light), profile),
    )
    tangent, binormal, normal = (unit(n, sampler) for n in (names.tangent, names.binormal, names.normal))
    return (
        draw(
            "parameter stage: e = 1 - (h.t/ax)^2 - (h.b/ay)^2 in red, N in alpha",
            parameters,
            view,
            _e_and_n(names.scale),
            (tangent, binormal),
            depth_test=FIRST_PASS,
        ),
        copy_screen(view),
        draw(
            "look up F(N, e), times k_s",
            lit,
            view,
            _gated_lookup(specular, gated),
            (screen_unit(view, 1), unit("F(N, e)", EDGE), tangent, normal),
            texture_shader=(TEXTURE_STAGE, ALPHA_RED_STAGE, TEXTURE_STAGE, TEXTURE_STAGE),
        ),
    )


# ------------------------------------------------------------------------------------------ Ward's model


def load_ward_functions(profile, largest_s=4.0):
    """The commands that load E(m, d) over m/8 and d as "E(m, d)", and S(p) over ``largest_s`` as "S(p)".

    S(p) is clamped beyond ``largest_s``, 2, 4 or 8, at p < 1/largest_s^2. A larger one keeps S right nearer
    to grazing angles, but leaves fewer codes elsewhere.
    """
    one_of((2.0, 4.0, 8.0), largest_s, "The largest S")

    def e(m, d):
        return brdfs.ward_e(LARGEST_M * m, d)

    def s(p, row):
        return np.minimum(brdfs.ward_s(p) / largest_s, 1.0) + 0.0 * row

    return (
        TexImage(
            label=f"load E(m, d) = exp(-2 m / (1 + d)) over m/{LARGEST_M:g}, d",
            texture="E(m, d)",
            image=sampled(e, TABLE_TEXELS, TABLE_TEXELS, profile=profile),
        ),
        TexImage(
            label=f"load S(p) / {largest_s:g} = 1 / ({largest_s:g} sqrt(p))",
            texture="S(p)",
            image=sampled(s, TABLE_TEXELS, 1, profile=profile),
        ),
    )


def _d_p_and_m(scale):
    """Red d = (h.n)+, green and blue p = (l.n)+ (v.n)+, alpha m/8 = ((h.t/ax)^2 + (h.b/ay)^2) / 8.

    Units 0 to 2 have t/ax, b/ay and n, unit 3 v; h is the primary, l the secondary colour.
    """
    n, h, light, viewer = expand(TEXTURE2), expand(PRIMARY), expand(SECONDARY), expand(TEXTURE3)
    return program(
        # A quarter of h.t/ax and h.b/ay, so their squares sum to m/16.
        scaled(round(SMALLEST_ALPHA / scale), _dots(h)),
        scaled(2, _squares(to=TEXTURE0)),
        both(dot(n, light, to=SPARE0), dot(n, viewer, to=SPARE1)),
        both(dot(n, h, to=TEXTURE1), product(SPARE0, SPARE1, to=SPARE1)),
        total(product(TEXTURE1, CONSTANT0), product(SPARE1, CONSTANT1), to=SPARE0),
        shown(SPARE0, alpha=blue_of(TEXTURE0)),
        constant0=RED,
        constant1=(0.0, 1.0, 1.0),
    )


def _ward_lookups(specular, largest_factor, largest_s):
    """E of unit 1 times S of unit 2 times (n.l)+ and the factor of unit 3."""
    one_of((2.0, 4.0, 8.0), largest_s, "The largest S")
    specular = checked_rgb(specular)
    # What is left of the factors by which S (n.l)+ and k_s / (4 pi ax ay) were divided.
    left = LARGEST_S_NL * largest_factor * max(specular)
    gain = next((g for g in (1, 2, 4) if left <= g), None)
    if gain is None:
        raise ValueError(
            f"The largest k_s / (4 pi ax ay) is {largest_factor:g}; combiners take up to "
            f"{4.0 / LARGEST_S_NL / max(specular):g}. Give larger alphas, or less k_s or specular colour."
        )
    color = [LARGEST_S_NL * largest_factor * float(c) / gain for c in specular]
    return program(
        dot(expand(TEXTURE3), expand(PRIMARY), to=SPARE0),
        scaled(round(largest_s / LARGEST_S_NL), product(SPARE0, TEXTURE2, to=SPARE0)),
        product(SPARE0, TEXTURE1, to=SPARE0),
        product(alpha_of(TEXTURE3), CONSTANT0, to=SPARE1),
        scaled(gain, product(SPARE0, SPARE1, to=SPARE0)),
        shown(SPARE0),
        constant0=color,
    )


def ward_passes(
    surface, names, view, light, profile, *, specular=(1.0, 1.0, 1.0), largest_s=4.0, sampler=REPEATED
):
    """K09: k_s / (4 pi ax ay) S(p) E(m, d) (n.l)+, looked up in what ``load_ward_functions`` loaded.

    The viewing vector is a texture coordinate that passes through unit 3. ``largest_s`` as the table's.
    Other parameters as for ``blinn_phong_passes``.
    """
    toward_light = vector_colors(light_vectors(surface, light), profile)
    parameters = surface.mesh(
        surface.texture_coordinates,
        _passed_through(view_vectors(surface, view), profile),
        colors=vector_colors(half_vectors(surface, view, light), profile),
        secondary_colors=toward_light,
    )
    lit = surface.mesh(surface.texture_coordinates, surface.positions, colors=toward_light)
    tangent, binormal, normal = (unit(n, sampler) for n in (names.tangent, names.binormal, names.normal))
    return (
        draw(
            "parameter stage: d in red, p in green, m/8 in alpha",
            parameters,
            view,
            _d_p_and_m(names.scale),
            (tangent, binormal, normal, unit(None, coordinates=1)),
            depth_test=FIRST_PASS,
            texture_shader=(TEXTURE_STAGE, TEXTURE_STAGE, TEXTURE_STAGE, PASS_THROUGH_STAGE),
        ),
        copy_screen(view),
        draw(
            "look up E(m, d) and S(p), times (n.l)+ k_s / (4 pi ax ay)",
            lit,
            view,
            _ward_lookups(specular, names.largest_factor, largest_s),
            (screen_unit(view, 1), unit("E(m, d)", EDGE), unit("S(p)", EDGE), normal),
            texture_shader=(TEXTURE_STAGE, ALPHA_RED_STAGE, GREEN_BLUE_STAGE, TEXTURE_STAGE),
        ),
    )


def _passed_through(vectors, profile):
    """Vectors [n, 3] as coordinates that PASS_THROUGH makes what EXPAND_NORMAL reads back.

    PASS_THROUGH cuts to bytes, so the half by which a vertex colour is rounded is added here.
    """
    if profile.arithmetic.exact:
        return 0.5 * vectors + 0.5
    return (vector_colors(np.zeros(3), profile)[0] * 255.0 + 0.5 + 127.5 * vectors) / 255.0


# ------------------------------------------------------------------------------------ the paper's figure 1

# Where the parameter stage leaves each parameter but s, which is in alpha.
_CHANNELS = {"t": RED, "u": GREEN, "v": BLUE}


def _figure_1_parameters():
    """Red t = (n.e)+, green u = (n.l)+, blue v/8, alpha -s = (a.l)+.

    Unit 0 has a, unit 1 n with v/8 in alpha; l is the primary, e the secondary colour.
    """
    a, n, light, eye = expand(TEXTURE0), expand(TEXTURE1), expand(PRIMARY), expand(SECONDARY)
    return program(
        both(dot(a, light, to=SPARE0), dot(n, eye, to=SPARE1)),
        dot(n, light, to=TEXTURE0),
        total(product(SPARE1, CONSTANT0), product(TEXTURE0, CONSTANT1), to=SPARE1),
        stage(product(alpha_of(TEXTURE1), CONSTANT0, to=TEXTURE0), constant0=opaque(BLUE)),
        final(ONE, SPARE1, plus=TEXTURE0, alpha=blue_of(SPARE0)),
        constant0=RED,
        constant1=GREEN,
    )


def _shown(what):
    """Combiners that show a stage of figure 1: unit 0 has the parameters, units 1 and 2 F and G."""
    if what == "s":
        return program(shown(alpha_of(TEXTURE0)))
    if what in _CHANNELS:
        return program(dot(TEXTURE0, CONSTANT0, to=SPARE0), shown(SPARE0), constant0=_CHANNELS[what])
    if what == RESULT:
        return program(product(TEXTURE1, TEXTURE2, to=SPARE0), shown(SPARE0))
    return program(shown(TEXTURE1 if what.startswith("F") else TEXTURE2))


def figure_1_passes(surface, view, light, profile, *, stage=RESULT, sampler=REPEATED):
    """The paper's figure 1, exp(s/t) sqrt(u^v), up to ``stage`` (``lookup_framework.STAGES``), that in grey.

    Textures "a", "n", "F" and "G" are ``lookup_framework``'s (``load_textures``, ``load_tables``).
    """
    one_of(STAGES, stage, "The stage")
    parameters = surface.mesh(
        colors=vector_colors(light_vectors(surface, light), profile),
        secondary_colors=vector_colors(view_vectors(surface, view), profile),
    )
    return (
        draw(
            "parameter stage: s in alpha, t in red, u in green, v in blue",
            parameters,
            view,
            _figure_1_parameters(),
            (unit("a", sampler), unit("n", sampler)),
            depth_test=FIRST_PASS,
        ),
        copy_screen(view),
        draw(
            f"look up F(s, t) and G(u, v): {stage}",
            surface.mesh(surface.positions),
            view,
            _shown(stage),
            (screen_unit(view, 0), unit("F", EDGE), unit("G", EDGE)),
            texture_shader=(TEXTURE_STAGE, ALPHA_RED_STAGE, GREEN_BLUE_STAGE),
        ),
    )
