"""K17, the board that the paper asks for: whole models in one pass of combiners, by functions or by lookups.

The future board's general combiners take square roots, quotients and exponentials of their sums. They may
look a texture up after a stage, and turn iterated vectors along arcs (docs/numbers.md, section 20). So each
model needs one pass. Boards of the time need several passes, or tables before the combiners:

K03, Banks:        5 stages. vt = v.t, lt = l.t; their squares; sqrt((1 - vt^2)(1 - lt^2)); minus vt lt; n.l.
K05, Blinn-Phong:  8 stages. The exponent N is per texel, and the board has no logarithm: the fourth root s
                   of e = 1 - (h.t/ax)^2 - (h.b/ay)^2 (two square roots), y = (1 - s)/(1 + s) (a division),
                   then ln s = -2 artanh y by a polynomial of y, and (sqrt e)^N = s^(2N) = exp(2 N ln s).
K09, Ward:         8 stages. The halfway vector is l + v, never normalised: with H = l + v and q = H.H the
                   exponent is -2 ((H.t/ax)^2 + (H.b/ay)^2) / (q + sqrt(q) H.n). The alpha portions meanwhile
                   make sqrt((n.l)(n.v)) / (n.v) and multiply it by k_s/(4 pi ax ay), which may exceed one.

The paper weighs functions against a dependent lookup inside the combiners. ``blinn_phong_by_lookup`` and
``banks_by_lookup`` are that alternative, with three stages each.

``evaluated_first`` is the order of section 5.1 (K16): combiners before the filter.

Source: Kautz, Seidel 2000, sections 3.1 to 3.3 and 5.1 (K03, K05, K09, K16, K17 of the catalogue). The
project chose the division into stages and the polynomial; docs/numbers.md, section 20, fixes the board's
arithmetic.
"""

from dataclasses import dataclass, replace

import numpy as np

from fixedpipe.effects.geometry.vertex_vectors import half_vectors, light_vectors, view_vectors
from fixedpipe.effects.passes.arguments import checked_rgb
from fixedpipe.effects.passes.combiners import (
    CONSTANT0,
    CONSTANT1,
    NOTHING,
    PRIMARY,
    SECONDARY,
    SPARE0,
    SPARE1,
    TEXTURE0,
    TEXTURE1,
    TEXTURE2,
    alpha_of,
    blue_of,
    both,
    dot,
    expand,
    exponential,
    final,
    negated,
    one_minus,
    product,
    program,
    quotient,
    scaled,
    signed,
    square,
    square_root,
    stage,
    total,
)
from fixedpipe.effects.passes.draws import ADD, ADD_GATED, EDGE, FIRST_PASS, LATER_PASS, REPEATED, draw, unit
from fixedpipe.effects.passes.encoding import factor_texels, vector_and_factor_texels, vector_colors
from fixedpipe.effects.reflectance import brdfs
from fixedpipe.effects.reflectance.material_textures import LARGEST_EXPONENT
from fixedpipe.effects.technique import Technique, Variant
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.textures.images import texture_2d

TECHNIQUES = (
    Technique("K17", "the board that the paper proposes: roots, quotients and lookups in combiners", "5.1"),
    Variant(("K03", "K05", "K09", "K16"), "on the board that the paper asks for"),
)

# ln s = -2 y (1 + LOG_3 y^2 + LOG_5 y^4) with y = (1 - s)/(1 + s); Taylor's are 1/3 and 1/5.
# Measured: by search on a grid of 0.0025 and 0.005; the error of (sqrt e)^N is at most 0.00124 for e in
# [0, 1] and N >= 1.
LOG_3, LOG_5 = 0.27, 0.5
# y leaves the division scaled so that the square of its square, with the scale of 4, is LOG_5 y^4.
_Y = float(np.sqrt(np.sqrt(LOG_5 / 16.0)))
# Vectors are stored divided by alpha and by this, whichever alphas the material has.
MULTIPLIERS = (4.0, 8.0)


def evaluated_first(commands):
    """K16: the same commands, with the combiners of every Draw that filters before the filter."""
    return tuple(
        replace(c, state=replace(c.state, evaluate_before_filtering=True))
        if isinstance(c, Draw) and any(c.state.texture_units)
        else c
        for c in commands
    )


def turned_steadily(commands):
    """K17: the same commands, with the vectors of every Draw's primary colour turned along arcs."""
    return tuple(
        replace(c, state=replace(c.state, spherical_primary_color=True)) if isinstance(c, Draw) else c
        for c in commands
    )


# ----------------------------------------------------------------------------------------- material textures


@dataclass(frozen=True)
class Names:
    """A material's texture objects on the future board.

    normal      n, and k_s multiplier^-2 / (ax ay)
    tangent     t / (multiplier ax), and k_s
    binormal    b / (multiplier ay), and N / 128
    fibre       t, and k_s
    multiplier  4 where every alpha is 0.25 or more, else 8
    """

    normal: str
    tangent: str
    binormal: str
    fibre: str
    multiplier: float


def load(material, name, profile):
    """Commands that load a material's four textures, and their ``Names``.

    The combiners multiply by 8 as readily as by 4, so alphas from 0.125 on are possible.
    Raises ValueError for smaller ones.
    """
    smallest = float(min(material.alpha_x.min(), material.alpha_y.min()))
    if smallest < 1.0 / MULTIPLIERS[-1]:
        raise ValueError(f"The material has an alpha of {smallest:g}; give 0.125 or more.")
    multiplier = MULTIPLIERS[0] if smallest >= 1.0 / MULTIPLIERS[0] else MULTIPLIERS[1]
    names = Names(*(f"{name} {part}" for part in ("n", "t/ax", "b/ay", "t")), multiplier)
    along, across = multiplier * material.alpha_x, multiplier * material.alpha_y
    images = (
        (names.normal, material.normals, material.k_s / (along * across)),
        (names.tangent, material.tangents / along[..., None], material.k_s),
        (names.binormal, material.binormals / across[..., None], material.exponent / LARGEST_EXPONENT),
        (names.fibre, material.tangents, material.k_s),
    )
    commands = tuple(
        TexImage(
            label=f"load material texture {texture}",
            texture=texture,
            image=texture_2d(vector_and_factor_texels(vectors, alpha, profile)),
        )
        for texture, vectors, alpha in images
    )
    return commands, names


# ------------------------------------------------------------------------------------------------ combiners


def _squared_lobe(multiplier):
    """Two portions: h.t/ax and h.b/ay, then the sum of their squares in SPARE0: 1 - e, not clamped."""
    h = expand(PRIMARY)
    dots = both(dot(expand(TEXTURE0), h, to=SPARE0), dot(expand(TEXTURE1), h, to=SPARE1))
    squares = total(square(signed(SPARE0)), square(signed(SPARE1)), to=SPARE0)
    return scaled(4, dots), scaled(4 if multiplier == 8.0 else 1, squares)


def blinn_phong_combiners(specular=(1.0, 1.0, 1.0), multiplier=4.0):
    """K05: k_s (sqrt e)^N with N per texel: eight stages, no lookup. Units: t/ax, b/ay; primary: h."""
    dots, squares = _squared_lobe(multiplier)
    # Meanwhile in SPARE1's alpha: N / (3 scale of y), 128 being 4 4 4 2; a dot product of three equal
    # components undoes the 3, which keeps 128 below the registers' 256.
    times_four = scaled(4, total(SPARE1, to=SPARE1))
    return program(
        stage(dots, scaled(4, total(TEXTURE1, to=SPARE1))),
        stage(squares, times_four),
        stage(square_root(one_minus(SPARE0), to=SPARE0), times_four),
        # RGB (s, s, 1), so that a dot product with a constant is any sum of s and one.
        stage(
            square_root(product(SPARE0, CONSTANT0), CONSTANT1, to=SPARE0),
            scaled(2, total(product(SPARE1, CONSTANT0), to=SPARE1)),
            constant0=(1.0, 1.0, 0.0, 1.0 / (3.0 * _Y)),
            constant1=(0.0, 0.0, 1.0, 0.0),
        ),
        stage(
            quotient(dot(one_minus(SPARE0), CONSTANT0), dot(SPARE0, CONSTANT1), to=SPARE0),
            constant0=(0.5 * _Y, 0.5 * _Y, 0.0, 0.0),
            constant1=(0.5, 0.5, 1.0, 0.0),
        ),
        # y^2, and 2 N y; then the polynomial of y^2, and the power.
        scaled(4, both(square(SPARE0, to=SPARE1), dot(SPARE0, alpha_of(SPARE1), to=SPARE0))),
        stage(
            total(product(SPARE1, CONSTANT0), square(SPARE1), to=SPARE1),
            constant0=(LOG_3 / (4.0 * _Y * _Y),) * 3 + (0.0,),
        ),
        exponential(negated(SPARE0), product(negated(SPARE0), SPARE1), to=SPARE0),
        final(SPARE0, product(alpha_of(TEXTURE0), CONSTANT0)),
        constant0=specular,
    )


def _lambert_and_color():
    """n.l to SPARE1, k_s times the light's colour to TEXTURE0."""
    return both(
        dot(expand(TEXTURE1), expand(PRIMARY), to=SPARE1),
        product(alpha_of(TEXTURE0), CONSTANT0, to=TEXTURE0),
    )


def _vt_and_lt():
    """v.t to SPARE0, l.t to SPARE1."""
    t = expand(TEXTURE0)
    return both(dot(t, expand(SECONDARY), to=SPARE0), dot(t, expand(PRIMARY), to=SPARE1))


def banks_combiners(specular=(1.0, 1.0, 1.0)):
    """K03: k_s (n.l)+ (sqrt((1 - vt^2)(1 - lt^2)) - vt lt)+, five stages. Texture units: t, n; primary: l,
    secondary: v.
    """
    vt, lt = signed(SPARE0), signed(SPARE1)
    return program(
        _vt_and_lt(),
        both(square(vt, to=SECONDARY), square(lt, to=TEXTURE0)),
        square_root(product(one_minus(SECONDARY), one_minus(TEXTURE0)), to=SECONDARY),
        total(SECONDARY, product(negated(vt), lt), to=SPARE0),
        _lambert_and_color(),
        final(SPARE0, product(SPARE1, TEXTURE0)),
        constant0=specular,
    )


def ward_combiners(specular=(1.0, 1.0, 1.0), multiplier=4.0):
    """K09: Ward's model times (n.l)+ as printed, eight stages. Texture units: t/ax, b/ay, n; primary: l,
    secondary: v. Zero where the light or the viewer is behind the surface.
    """
    twice = multiplier == 8.0
    t, b, n, light, viewer = map(expand, (TEXTURE0, TEXTURE1, TEXTURE2, PRIMARY, SECONDARY))
    half = signed(SPARE0)
    # Stored is k_s / (multiplier^2 ax ay); after the scales by four 1 / pi is left of multiplier^2 / (4 pi).
    color = tuple(component / np.pi for component in checked_rgb(specular))
    return program(
        # H = l + v; then n.l, n.v.
        total(light, viewer, to=SPARE0),
        both(dot(n, light, to=PRIMARY), dot(n, viewer, to=SECONDARY)),
        # H.t/ax, H.b/ay. In alpha sqrt((n.l)(n.v)) / (n.v), not sqrt((n.l) / (n.v)): 0 / 0 is 0, and the
        # viewer's side needs no gate.
        stage(
            scaled(4, both(dot(t, half, to=TEXTURE0), dot(b, half, to=TEXTURE1))),
            square_root(product(blue_of(PRIMARY), blue_of(SECONDARY)), to=PRIMARY),
        ),
        # q = H.H, and H.n.
        stage(
            both(dot(half, half, to=SPARE1), dot(n, half, to=SPARE0)),
            quotient(PRIMARY, blue_of(SECONDARY), to=PRIMARY),
        ),
        # (H.t/ax)^2 + (H.b/ay)^2, and in alpha sqrt(q).
        stage(
            scaled(4 if twice else 1, total(square(signed(TEXTURE0)), square(signed(TEXTURE1)), to=TEXTURE0)),
            square_root(blue_of(SPARE1), to=SPARE1),
        ),
        # q + sqrt(q) H.n, and in alpha k_s / (ax ay) as it is stored.
        stage(
            total(signed(SPARE1), product(signed(SPARE0), alpha_of(SPARE1)), to=SPARE1),
            scaled(4, total(product(PRIMARY, TEXTURE2), to=PRIMARY)),
        ),
        # One over the other, and exp of minus twice that.
        stage(
            quotient(TEXTURE0, SPARE1, to=SPARE0),
            scaled(4, total(PRIMARY, to=PRIMARY)) if twice else NOTHING,
        ),
        exponential(negated(SPARE0), negated(SPARE0), to=SPARE0),
        final(SPARE0, product(alpha_of(PRIMARY), CONSTANT0)),
        constant0=color,
    )


def _looked_up(s, t):
    """The stage that looks unit 2 up at two inputs: to SPARE0's red and green."""
    place = total(product(s, CONSTANT0), product(t, CONSTANT1), to=SPARE0)
    return stage(place, constant0=(1.0, 0.0, 0.0, 0.0), constant1=(0.0, 1.0, 0.0, 0.0), lookup=2)


def blinn_phong_lookup_combiners(specular=(1.0, 1.0, 1.0), multiplier=4.0):
    """K05 with F(N, e) looked up at N / 128 and e: three stages, unit 2 the table of ``exponent_table``."""
    return program(
        *_squared_lobe(multiplier),
        _looked_up(alpha_of(TEXTURE1), one_minus(SPARE0)),
        final(TEXTURE2, product(alpha_of(TEXTURE0), CONSTANT0)),
        constant0=specular,
    )


def banks_lookup_combiners(specular=(1.0, 1.0, 1.0)):
    """K03 with the bracket looked up at (vt/2, lt/2): three stages, unit 2 the table of ``bracket_table``."""
    return program(
        scaled(0.5, _vt_and_lt()),
        _looked_up(signed(SPARE0), signed(SPARE1)),
        _lambert_and_color(),
        final(TEXTURE2, product(SPARE1, TEXTURE0)),
        constant0=specular,
    )


# -------------------------------------------------------------------------------------------------- tables


def exponent_table(profile, size=256):
    """F(N, e) = (sqrt e)^N as a texture for ``blinn_phong_by_lookup``: N / 128 along s, e along t."""
    exponent, e = np.meshgrid(
        (np.arange(size) + 0.5) / size * LARGEST_EXPONENT, (np.arange(size) + 0.5) / size
    )
    table = factor_texels(brdfs.blinn_phong_f(exponent, e), profile)
    return TexImage(label="load table F(N, e)", texture="F(N, e)", image=texture_2d(table[..., None]))


def bracket_table(profile, size=256):
    """Banks's bracket as a texture for ``banks_by_lookup``: vt/2 along s, lt/2 along t, both from -1/2 to 1/2
    of a repeated texture.
    """
    at = (np.arange(size) + 0.5) / size
    products = 2.0 * np.where(at < 0.5, at, at - 1.0)
    table = factor_texels(brdfs.banks_bracket(products[None, :], products[:, None]), profile)
    return TexImage(label="load table of the bracket", texture="bracket", image=texture_2d(table[..., None]))


# -------------------------------------------------------------------------------------------------- passes


def _pass(label, surface, view, vectors, combiners, units, profile, *, gated, first, steady):
    """One Draw with one or two vectors per vertex, primary and secondary colour."""
    colors = [vector_colors(v, profile) for v in vectors]
    mesh = surface.mesh(colors=colors[0])
    if len(colors) > 1:
        mesh = replace(mesh, secondary_colors=colors[1])
    blending = None if first else ADD_GATED if gated else ADD
    depth_test = FIRST_PASS if first else LATER_PASS
    drawn = draw(label, mesh, view, combiners, units, depth_test=depth_test, blending=blending)
    turning = {"spherical_primary_color": steady, "spherical_secondary_color": steady and len(colors) > 1}
    return (replace(drawn, state=replace(drawn.state, **turning)),)


def blinn_phong(
    surface, names, view, light, profile, *,
    specular=(1.0, 1.0, 1.0), first=False, gated=True, steady=True, sampler=REPEATED,
):  # fmt: skip
    """K05 in one draw.

    Parameters as for ``anisotropic_blinn_phong.specular_pass``; ``names``: from ``load``; ``steady``: vectors
    between vertices turn along arcs, at unit length.
    """
    units = unit(names.tangent, sampler), unit(names.binormal, sampler)
    return _pass(
        "specular pass: k_s (sqrt e)^N by square roots, division, exponential", surface, view,
        (half_vectors(surface, view, light),), blinn_phong_combiners(specular, names.multiplier), units,
        profile, gated=gated, first=first, steady=steady,
    )  # fmt: skip


def blinn_phong_by_lookup(
    surface, names, table, view, light, profile, *,
    specular=(1.0, 1.0, 1.0), first=False, gated=True, steady=True, sampler=REPEATED,
):  # fmt: skip
    """K05 in one draw with a dependent lookup. ``table``: the texture object of ``exponent_table``; others as
    ``blinn_phong``'s.
    """
    units = unit(names.tangent, sampler), unit(names.binormal, sampler), unit(table, EDGE)
    return _pass(
        "specular pass: k_s F(N, e) by a lookup", surface, view,
        (half_vectors(surface, view, light),), blinn_phong_lookup_combiners(specular, names.multiplier),
        units, profile, gated=gated, first=first, steady=steady,
    )  # fmt: skip


def _light_and_view(surface, view, light):
    return light_vectors(surface, light), view_vectors(surface, view)


def banks(
    surface, names, view, light, profile, *,
    specular=(1.0, 1.0, 1.0), first=False, steady=True, sampler=REPEATED,
):  # fmt: skip
    """K03 in one draw; parameters as ``blinn_phong``'s. The model has its own (n.l)+ and needs no gate."""
    return _pass(
        "specular pass: k_s (n.l)+ (sqrt((1 - vt^2)(1 - lt^2)) - vt lt)+", surface, view,
        _light_and_view(surface, view, light), banks_combiners(specular),
        (unit(names.fibre, sampler), unit(names.normal, sampler)), profile,
        gated=False, first=first, steady=steady,
    )  # fmt: skip


def banks_by_lookup(
    surface, names, table, view, light, profile, *,
    specular=(1.0, 1.0, 1.0), first=False, steady=True, sampler=REPEATED,
):  # fmt: skip
    """K03 in one draw with a dependent lookup. ``table``: the texture object of ``bracket_table``; the others
    as ``banks``'s.
    """
    return _pass(
        "specular pass: k_s (n.l)+ times the bracket by a lookup", surface, view,
        _light_and_view(surface, view, light), banks_lookup_combiners(specular),
        (unit(names.fibre, sampler), unit(names.normal, sampler), unit(table)), profile,
        gated=False, first=first, steady=steady,
    )  # fmt: skip


def ward(
    surface, names, view, light, profile, *,
    specular=(1.0, 1.0, 1.0), first=False, steady=True, sampler=REPEATED,
):  # fmt: skip
    """K09 in one draw; parameters as ``blinn_phong``'s. The model has its own (n.l)+ and needs no gate."""
    return _pass(
        "specular pass: k_s/(4 pi ax ay) (n.l)+ S(p) E(m, d)", surface, view,
        _light_and_view(surface, view, light), ward_combiners(specular, names.multiplier),
        (unit(names.tangent, sampler), unit(names.binormal, sampler), unit(names.normal, sampler)), profile,
        gated=False, first=first, steady=steady,
    )  # fmt: skip
