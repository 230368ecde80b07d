"""K17, the board that the paper asks for: whole models in one pass of combiners, by functions or by lookups.

The future board's general combiners take square roots, quotients and exponentials of their sums, may look a
texture up after a stage, and turn iterated vectors along arcs (docs/numbers.md, section 20). So each model
needs one pass, where boards of the time need several, or tables before the combiners:

K03, Banks:        5 stages. vt = v.t, lt = l.t; their squares; sqrt((1 - vt^2)(1 - lt^2)); minus vt lt; n.l.
K05, Blinn-Phong:  8 stages. The exponent N is per texel, and the board has no logarithm: the fourth root s
                   of e = 1 - (h.t/ax)^2 - (h.b/ay)^2 (two square roots), y = (1 - s)/(1 + s) (a division),
                   then ln s = -2 artanh y by a polynomial of y, and (sqrt e)^N = s^(2N) = exp(2 N ln s).
K09, Ward:         8 stages. The halfway vector is l + v, never normalised: with H = l + v and q = H.H the
                   exponent is -2 ((H.t/ax)^2 + (H.b/ay)^2) / (q + sqrt(q) H.n). The alpha portions meanwhile
                   make sqrt((n.l)(n.v)) / (n.v) and multiply it by k_s/(4 pi ax ay), which may exceed one.

``blinn_phong_by_lookup`` and ``banks_by_lookup`` are the alternative that the paper weighs against functions:
a dependent lookup inside the combiners, three stages each.

``evaluated_first`` is the order of section 5.1 (K16): combiners before the filter.

Source: Kautz, Seidel 2000, sections 3.1 to 3.3 and 5.1 (K03, K05, K09, K16, K17 of the catalogue). The
division into stages is ours, and so is the polynomial; docs/numbers.md, section 20, fixes the board's
arithmetic.
"""

from dataclasses import dataclass, replace

import numpy as np

from fixedpipe.effects.geometry.vertex_vectors import half_vectors, light_vectors, view_vectors
from fixedpipe.effects.passes.arguments import checked_rgb
from fixedpipe.effects.passes.combiners import NO_ALPHA, ONE, OPAQUE, ZERO, alpha_of, expand, opaque
from fixedpipe.effects.passes.draws import ADD, ADD_GATED, EDGE, FIRST_PASS, LATER_PASS, REPEATED, draw, unit
from fixedpipe.effects.passes.encoding import encode_factor, encode_rgba, encode_vertex_color
from fixedpipe.effects.reflectance import brdfs
from fixedpipe.effects.reflectance.material_textures import LARGEST_EXPONENT
from fixedpipe.effects.technique import AnotherWay, Technique
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.enums import CombinerFunction, CombinerScale, ComponentUsage, Mapping, Register
from fixedpipe.pipeline.state import (
    AlphaPortion,
    CombinerInput,
    CombinerLookup,
    FinalCombiner,
    GeneralCombiner,
    RegisterCombiners,
    RGBPortion,
)
from fixedpipe.pipeline.textures.images import texture_2d

TECHNIQUES = (
    Technique("K17", "the board asked for: roots, quotients, exponentials, lookups in combiners", "5.1"),
    AnotherWay(("K03", "K05", "K09", "K16"), "on the board that the paper asks for"),
)

P, S = Register.PRIMARY_COLOR, Register.SECONDARY_COLOR
SPARE0, SPARE1, DISCARD = Register.SPARE0, Register.SPARE1, Register.DISCARD
T0, T1, T2 = Register.TEXTURE0, Register.TEXTURE1, Register.TEXTURE2
C0, C1 = Register.CONSTANT_COLOR0, Register.CONSTANT_COLOR1
FOUR = CombinerScale.SCALE_BY_FOUR

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
            image=texture_2d(encode_rgba(vectors, alpha, profile)),
        )
        for texture, vectors, alpha in images
    )
    return commands, names


# ------------------------------------------------------------------------------------------------- inputs


def _signed(register):
    return CombinerInput(register, Mapping.SIGNED_IDENTITY)


def _negated(register):
    return CombinerInput(register, Mapping.SIGNED_NEGATE)


def _one_minus(register):
    return CombinerInput(register, Mapping.UNSIGNED_INVERT)


def _blue(register):
    return CombinerInput(register, usage=ComponentUsage.BLUE)


def _dots(a, b, c, d, to, scale=CombinerScale.NONE):
    """Both dot products of a stage, to two registers."""
    return RGBPortion(
        a=a, b=b, c=c, d=d, ab_dot_product=True, cd_dot_product=True,
        ab_output=to[0], cd_output=to[1], sum_output=DISCARD, scale=scale,
    )  # fmt: skip


def _scalar(a, b, to, scale=CombinerScale.NONE, **others):
    """An alpha portion's sum, to one register."""
    return AlphaPortion(a=a, b=b, sum_output=to, scale=scale, **others)


def _product(factor, value=SPARE0, color=C0):
    """The final combiner: a register's value in [0, 1] times a factor times a colour, clamped at the end."""
    return FinalCombiner(
        a=CombinerInput(value), b=CombinerInput(Register.E_TIMES_F), c=ZERO, d=ZERO,
        e=factor, f=CombinerInput(color), g=OPAQUE,
    )  # fmt: skip


def _lambert_and_color():
    """The last stage of the Banks model: n.l to SPARE1, k_s times the light's colour to TEXTURE0."""
    return RGBPortion(
        a=expand(T1), b=expand(P), ab_dot_product=True, ab_output=SPARE1,
        c=alpha_of(T0), d=CombinerInput(C0), cd_output=T0, sum_output=DISCARD,
    )  # fmt: skip


# ------------------------------------------------------------------------------------------------ combiners


def _squared_lobe(multiplier):
    """Two stages: h.t/ax and h.b/ay, then the sum of their squares in SPARE0: 1 - e, not clamped."""
    dots = _dots(expand(T0), expand(P), expand(T1), expand(P), (SPARE0, SPARE1), FOUR)
    x, y = _signed(SPARE0), _signed(SPARE1)
    scale = FOUR if multiplier == 8.0 else CombinerScale.NONE
    return dots, RGBPortion(a=x, b=x, c=y, d=y, sum_output=SPARE0, scale=scale)


def blinn_phong_combiners(specular=(1.0, 1.0, 1.0), multiplier=4.0):
    """K05: k_s (sqrt e)^N with N per texel: eight stages, no lookup. Units: t/ax, b/ay; primary: h."""
    dots, squares = _squared_lobe(multiplier)
    one = CombinerInput(C1)
    # RGB (s, s, 1), so that a dot product with a constant is any sum of s and one.
    root = RGBPortion(a=_one_minus(SPARE0), b=ONE, sum_output=SPARE0, function=CombinerFunction.SQUARE_ROOT)
    fourth_root = RGBPortion(
        a=CombinerInput(SPARE0), b=CombinerInput(C0), c=one, d=ONE,
        sum_output=SPARE0, function=CombinerFunction.SQUARE_ROOT,
    )  # fmt: skip
    y = RGBPortion(
        a=_one_minus(SPARE0), b=CombinerInput(C0), c=CombinerInput(SPARE0), d=one, ab_dot_product=True,
        cd_dot_product=True, sum_output=SPARE0, function=CombinerFunction.DIVIDE,
    )  # fmt: skip
    scaled_y, square = CombinerInput(SPARE0), CombinerInput(SPARE1)
    products = RGBPortion(
        a=scaled_y, b=scaled_y, c=scaled_y, d=alpha_of(SPARE1), cd_dot_product=True,
        ab_output=SPARE1, cd_output=SPARE0, sum_output=DISCARD, scale=FOUR,
    )  # fmt: skip
    polynomial = RGBPortion(a=square, b=CombinerInput(C0), c=square, d=square, sum_output=SPARE1)
    power = RGBPortion(
        a=_negated(SPARE0), b=ONE, c=_negated(SPARE0), d=square,
        sum_output=SPARE0, function=CombinerFunction.EXPONENTIAL,
    )  # fmt: skip
    # Meanwhile in SPARE1's alpha: N / (3 scale of y), 128 being 4 4 4 2; a dot product of three equal
    # components undoes the 3, which keeps 128 below the registers' 256.
    four_n = _scalar(alpha_of(T1), OPAQUE, SPARE1, FOUR)
    times_four = _scalar(alpha_of(SPARE1), OPAQUE, SPARE1, FOUR)
    share = _scalar(alpha_of(SPARE1), alpha_of(C0), SPARE1, CombinerScale.SCALE_BY_TWO)
    general = (
        GeneralCombiner(dots, four_n),
        GeneralCombiner(squares, times_four),
        GeneralCombiner(root, times_four),
        GeneralCombiner(fourth_root, share, (1.0, 1.0, 0.0, 1.0 / (3.0 * _Y)), (0.0, 0.0, 1.0, 0.0)),
        GeneralCombiner(y, NO_ALPHA, (0.5 * _Y, 0.5 * _Y, 0.0, 0.0), (0.5, 0.5, 1.0, 0.0)),
        GeneralCombiner(products, NO_ALPHA),
        GeneralCombiner(polynomial, NO_ALPHA, (LOG_3 / (4.0 * _Y * _Y),) * 3 + (0.0,)),
        GeneralCombiner(power, NO_ALPHA),
    )
    return RegisterCombiners(general, _product(alpha_of(T0)), opaque(specular))


def banks_combiners(specular=(1.0, 1.0, 1.0)):
    """K03: k_s (n.l)+ (sqrt((1 - vt^2)(1 - lt^2)) - vt lt)+, five stages. Texture units: t, n; primary: l,
    secondary: v.
    """
    vt, lt = _signed(SPARE0), _signed(SPARE1)
    squares = RGBPortion(a=vt, b=vt, c=lt, d=lt, ab_output=S, cd_output=T0, sum_output=DISCARD)
    root = RGBPortion(a=_one_minus(S), b=_one_minus(T0), sum_output=S, function=CombinerFunction.SQUARE_ROOT)
    bracket = RGBPortion(a=CombinerInput(S), b=ONE, c=_negated(SPARE0), d=lt, sum_output=SPARE0)
    dots = _dots(expand(T0), expand(S), expand(T0), expand(P), (SPARE0, SPARE1))
    general = tuple(
        GeneralCombiner(rgb, NO_ALPHA) for rgb in (dots, squares, root, bracket, _lambert_and_color())
    )
    return RegisterCombiners(general, _product(CombinerInput(SPARE1), SPARE0, T0), opaque(specular))


def ward_combiners(specular=(1.0, 1.0, 1.0), multiplier=4.0):
    """K09: Ward's model times (n.l)+ as printed, eight stages. Texture units: t/ax, b/ay, n; primary: l,
    secondary: v. Zero where the light or the viewer is behind the surface.
    """
    twice = multiplier == 8.0
    half = RGBPortion(a=expand(P), b=ONE, c=expand(S), d=ONE, sum_output=SPARE0)
    cosines = _dots(expand(T2), expand(P), expand(T2), expand(S), (P, S))
    lengths = _dots(expand(T0), _signed(SPARE0), expand(T1), _signed(SPARE0), (T0, T1), FOUR)
    q_and_d = _dots(_signed(SPARE0), _signed(SPARE0), expand(T2), _signed(SPARE0), (SPARE1, SPARE0))
    x, y = _signed(T0), _signed(T1)
    m = RGBPortion(a=x, b=x, c=y, d=y, sum_output=T0, scale=FOUR if twice else CombinerScale.NONE)
    divisor = RGBPortion(a=_signed(SPARE1), b=ONE, c=_signed(SPARE0), d=alpha_of(SPARE1), sum_output=SPARE1)
    quotient = RGBPortion(
        a=CombinerInput(T0), b=ONE, c=CombinerInput(SPARE1), d=ONE,
        sum_output=SPARE0, function=CombinerFunction.DIVIDE,
    )  # fmt: skip
    lobe = RGBPortion(
        a=_negated(SPARE0), b=ONE, c=_negated(SPARE0), d=ONE,
        sum_output=SPARE0, function=CombinerFunction.EXPONENTIAL,
    )  # fmt: skip
    # sqrt((n.l)(n.v)) / (n.v), not sqrt((n.l) / (n.v)): 0 / 0 is 0, and the viewer's side needs no gate.
    root_of_p = _scalar(_blue(P), _blue(S), P, function=CombinerFunction.SQUARE_ROOT)
    over_nv = _scalar(alpha_of(P), OPAQUE, P, c=_blue(S), d=OPAQUE, function=CombinerFunction.DIVIDE)
    root_of_q = _scalar(_blue(SPARE1), OPAQUE, SPARE1, function=CombinerFunction.SQUARE_ROOT)
    scaled = _scalar(alpha_of(P), alpha_of(T2), P, FOUR)
    again = _scalar(alpha_of(P), OPAQUE, P, FOUR) if twice else NO_ALPHA
    rgb = (half, cosines, lengths, q_and_d, m, divisor, quotient, lobe)
    alpha = (NO_ALPHA, NO_ALPHA, root_of_p, over_nv, root_of_q, scaled, again, NO_ALPHA)
    general = tuple(map(GeneralCombiner, rgb, alpha))
    # Stored is k_s / (multiplier^2 ax ay); after the scales by four 1 / pi is left of multiplier^2 / (4 pi).
    color = tuple(component / np.pi for component in checked_rgb(specular))
    return RegisterCombiners(general, _product(alpha_of(P)), opaque(color))


def blinn_phong_lookup_combiners(specular=(1.0, 1.0, 1.0), multiplier=4.0):
    """K05 with F(N, e) looked up: three stages, unit 2 the table of ``exponent_table``."""
    dots, squares = _squared_lobe(multiplier)
    # Red N / 128, green e.
    where = RGBPortion(
        a=alpha_of(T1), b=CombinerInput(C0), c=_one_minus(SPARE0), d=CombinerInput(C1), sum_output=SPARE0
    )
    general = (
        GeneralCombiner(dots, NO_ALPHA),
        GeneralCombiner(squares, NO_ALPHA),
        GeneralCombiner(where, NO_ALPHA, (1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), CombinerLookup(2)),
    )
    return RegisterCombiners(general, _product(alpha_of(T0), T2), opaque(specular))


def banks_lookup_combiners(specular=(1.0, 1.0, 1.0)):
    """K03 with the bracket looked up at (vt/2, lt/2): three stages, unit 2 the table of ``bracket_table``."""
    dots = _dots(
        expand(T0), expand(S), expand(T0), expand(P), (SPARE0, SPARE1), CombinerScale.SCALE_BY_ONE_HALF
    )
    where = RGBPortion(
        a=_signed(SPARE0), b=CombinerInput(C0), c=_signed(SPARE1), d=CombinerInput(C1), sum_output=SPARE0
    )
    general = (
        GeneralCombiner(dots, NO_ALPHA),
        GeneralCombiner(where, NO_ALPHA, (1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), CombinerLookup(2)),
        GeneralCombiner(_lambert_and_color(), NO_ALPHA),
    )
    return RegisterCombiners(general, _product(CombinerInput(SPARE1), T2, T0), opaque(specular))


# -------------------------------------------------------------------------------------------------- tables


def exponent_table(profile, size=256):
    """F(N, e) = (sqrt e)^N as a texture for ``blinn_phong_by_lookup``: N / 128 along s, e along t."""
    exponent, e = np.meshgrid(
        (np.arange(size) + 0.5) / size * LARGEST_EXPONENT, (np.arange(size) + 0.5) / size
    )
    table = encode_factor(brdfs.blinn_phong_f(exponent, e), profile)
    return TexImage(label="load table F(N, e)", texture="F(N, e)", image=texture_2d(table[..., None]))


def bracket_table(profile, size=256):
    """Banks's bracket as a texture for ``banks_by_lookup``: vt/2 along s, lt/2 along t, both from -1/2 to 1/2
    of a repeated texture.
    """
    at = (np.arange(size) + 0.5) / size
    products = 2.0 * np.where(at < 0.5, at, at - 1.0)
    table = encode_factor(brdfs.banks_bracket(products[None, :], products[:, None]), profile)
    return TexImage(label="load table of the bracket", texture="bracket", image=texture_2d(table[..., None]))


# -------------------------------------------------------------------------------------------------- passes


def _pass(label, surface, view, vectors, combiners, units, profile, *, gated, first, steady):
    """One Draw with one or two vectors per vertex, primary and secondary colour."""
    colors = [encode_vertex_color(v, profile) for v in vectors]
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

    Parameters
    ----------
    surface, view, light
        The surface, the view and the light.
    names
        The material's texture objects (``load``).
    specular
        RGB in [0, 1].
    first
        The only pass over the surface: tests and writes depth, and replaces. Otherwise it is added to the
        diffuse pass where depths are equal, and if ``gated`` multiplied by the gate in destination alpha.
    steady
        The vertices' vectors turn along arcs, at unit length.
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
