"""S21 and S22 on machines: mip-maps of bumps and roughness, by dot products and a table, or by a divide.

GeForce 3, NV2A. None of their combiners and texture shaders divides. D^-1 and f are two mip-maps of rows;
each level is computed by itself. Two dot products with h / h_3 are D^-1 (slopes of h - f) = x, and a table
over two numbers is

    (1 + |x|^2)^-2 = cos^4 a'

Alpha has the energy. The vertices divide by h_3, the map holds 1 / D, and the table has the sum's quotient
and its power. The method has two errors: it filters D^-1 in place of K, and h / h_3 is linear over a
triangle.

Future board. Its combiners divide: f and K are mip-maps, and the formula is eight stages.

Source: Schilling 1997, appendix A; pass sequences A-S21 and A-S22 of the catalogue, which proposes a lookup
of two parameters in place of the divide. Assumed: rows of D^-1.
"""

from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from fixedpipe.effects.bump_mapping import roughness_pyramids as rough
from fixedpipe.effects.passes.combiners import (
    CONSTANT0,
    CONSTANT1,
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
    negated,
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
from fixedpipe.effects.passes.draws import FIRST_PASS, REPEATED, draw, unit
from fixedpipe.effects.passes.encoding import dot_product_texels, vector_colors, vector_texels
from fixedpipe.effects.passes.texture_shaders import NO_TEXTURE, TEXTURE_STAGE, dot_product_stages
from fixedpipe.effects.reflectance import rough_highlights as shine
from fixedpipe.effects.reflectance.dot_product_lookups import centered_table
from fixedpipe.effects.technique import Variant
from fixedpipe.effects.texture_filtering.mipmapped_materials import texture_of_levels
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.enums import TextureFilter

TECHNIQUES = (Variant(("S21", "S22"), "by mip-maps of D^-1, dot products and a table, or of K and a divide"),)


class Roughness(StrEnum):
    """How a pixel's roughness changes its highlight.

    NONE         what level 0 has: bumps are a mip-map and no more
    ISOTROPIC    I_1 (S22)
    ANISOTROPIC  D (S21)
    """

    NONE = "mip-mapped bumps"
    ISOTROPIC = "with I_1"
    ANISOTROPIC = "with D"


@dataclass(frozen=True)
class Names:
    """Three texture objects, and the numbers that are one in them: rows times ``row``, the table's
    ``period``.
    """

    first: str
    second: str
    table: str
    row: float
    period: float


# Trowbridge and Reitz's peak is 1 / (pi s^2), that of normally distributed slopes 1 / (2 pi sigma^2): a lobe
# of s^2 = 2 sigma^2 is as bright in its middle. Measured (figure S22): 1.04 times the light of 256 samples a
# pixel, with 1 it is 1.22 times.
SPREAD = 2.0


def covariances(levels, roughness, spread=SPREAD):
    """K of each level for a kind of roughness: a list of float64 [rows, columns, 3].

    ``spread``: the factor of the bumps' covariance against the lobe beneath level 0.
    """
    roughness, lobe, out = Roughness(roughness), levels[0].covariance[:1, :1], []
    for level in levels:
        k = np.broadcast_to(lobe, level.covariance.shape)
        if roughness is not Roughness.NONE:
            k = lobe + spread * (level.covariance - lobe)
        if roughness is Roughness.ISOTROPIC:
            deviation = rough.largest_deviation(k)
            k = np.stack([deviation * deviation, 0.0 * deviation, deviation * deviation], axis=-1)
        out.append(k)
    return out


def inverse_rows(offsets, covariance):
    """Two rows that times (h_1, h_2, h_3) / h_3 give D^-1 (slopes of h - f): float64 [..., 3] each."""
    d_1, d_2, d_3 = np.moveaxis(rough.deviations(covariance), -1, 0)
    f_1, f_2 = np.moveaxis(offsets, -1, 0)
    one, other, below = 1.0 / d_1, -d_2 / (d_1 * d_3), 1.0 / d_3
    zero = np.zeros(one.shape)
    return (
        np.stack([one, other, -(one * f_1 + other * f_2)], axis=-1),
        np.stack([zero, below, -below * f_2], axis=-1),
    )


def load_rows(levels, roughness, slopes, profile, *, spread=SPREAD, texels=512):
    """Commands that load D^-1 and f as two mip-maps, and the highlight over D^-1 d; and their Names.

    The first mip-map's alpha is the energy, s^2 / (s_1 s_2); one is the energy of level 0 without bumps.

    levels  both pyramids, with a lobe beneath level 0
    slopes  the largest expected (h_1, h_2) / h_3
    spread  as for ``covariances``
    """
    ks = covariances(levels, roughness, spread)
    rows = [inverse_rows(level.offsets, k) for level, k in zip(levels, ks, strict=True)]
    row = max(float(np.abs(r).max()) for both in rows for r in both)
    reach = max(
        float((slopes * (np.abs(r[..., 0]) + np.abs(r[..., 1])) + np.abs(r[..., 2])).max())
        for both in rows
        for r in both
    )
    least = shine.energy(levels[0].covariance).max()
    share = [np.clip(shine.energy(k) / least, 0.0, 1.0) for k in ks]
    names = Names(
        *(f"{part}, {Roughness(roughness).value}" for part in ("D^-1 1", "D^-1 2", "table")), row, 2.0 * reach
    )
    pictures = []
    for number, name in enumerate((names.first, names.second)):
        images = [
            dot_product_texels(both[number] / row, alpha, profile)
            for both, alpha in zip(rows, share, strict=True)
        ]
        pictures.append(TexImage(label=f"load {name}", texture=name, image=texture_of_levels(images)))
    table = centered_table(lambda x, y: 1.0 / np.square(1.0 + (x * x + y * y)), texels, names.period, profile)
    return (*pictures, TexImage(label=f"load {names.table}", texture=names.table, image=table)), names


_TRILINEAR = replace(REPEATED, min_filter=TextureFilter.LINEAR_MIPMAP_LINEAR)


def rows_pass(surface, slopes, names, view, colors, gain=1):
    """A highlight by roughness in one draw on a GeForce 3 or NV2A: D^-1 times h by two dot products, and the
    table at both.

    slopes  float64 [n, 2]: (h_1, h_2) / h_3 at the vertices
    colors  RGB of the highlight, and RGB that is there without it
    gain    1, 2 or 4, times which it is drawn
    """
    scale = names.row / names.period
    half = scale * np.concatenate([slopes, np.ones((len(slopes), 1))], axis=-1)
    mesh = surface.mesh(surface.texture_coordinates, half)
    units = (
        unit(names.first, _TRILINEAR),
        unit(names.second, _TRILINEAR),
        unit(NO_TEXTURE, coordinates=1),
        unit(names.table, REPEATED, coordinates=1),
    )
    combiners = program(
        scaled(gain, product(TEXTURE3, alpha_of(TEXTURE0), to=SPARE0)),
        final(SPARE0, CONSTANT0, plus=CONSTANT1),
        constant0=colors[0],
        constant1=colors[1],
    )
    shader = (TEXTURE_STAGE, TEXTURE_STAGE, *dot_product_stages(0, 1))
    tests = {"depth_test": FIRST_PASS, "texture_shader": shader}
    return (draw("highlight by D^-1 and a table", mesh, view, combiners, units, **tests),)


# ------------------------------------------------------------------------------ the divide at every fragment


@dataclass(frozen=True)
class QuotientNames:
    """Four texture objects of f and K, each with its numbers in another order, and the numbers that they
    store as one: slopes of ``slope``, covariances of ``square``; and K's determinant without bumps.
    """

    offsets: tuple[str, str]
    adjugate: str
    covariance: str
    slope: float
    square: float
    least: float


def load_quotient(levels, roughness, slopes, profile, *, spread=SPREAD):
    """Commands that load f and K as mip-maps for ``quotient_pass``, and their QuotientNames.

    Arguments as for ``load_rows``.
    """
    ks = covariances(levels, roughness, spread)
    most = max(float(np.abs(k).max()) for k in ks)
    largest = max(slopes, max(float(np.abs(level.offsets).max()) for level in levels))
    # K's determinant is weighed by square / slope^2 below, by a constant, one at most.
    slope = max(largest, float(np.sqrt(most)))
    # x_1, x_1, x_2 times x_1, x_2, x_2 are the squares and the product; rows of K lie so that dot products
    # give half of the adjugate's form and half of the determinant.
    parts = {
        "f_1, f_1, f_2": [level.offsets[..., [0, 0, 1]] / slope for level in levels],
        "f_1, f_2, f_2": [level.offsets[..., [0, 1, 1]] / slope for level in levels],
        "c/2, -b, a/2": [k[..., [2, 1, 0]] * np.array([0.5, -1.0, 0.5]) / most for k in ks],
        "a, b/2": [k * np.array([1.0, 0.5, 0.0]) / most for k in ks],
    }
    names = [f"{part}, {Roughness(roughness).value}" for part in parts]
    loads = [
        TexImage(
            label=f"load {name}",
            texture=name,
            image=texture_of_levels([vector_texels(level, profile) for level in images]),
        )
        for name, images in zip(names, parts.values(), strict=True)
    ]
    a, b, c = np.moveaxis(levels[0].covariance[:1, :1] / most, -1, 0)
    least = float((a * c - b * b).min())
    return loads, QuotientNames((names[0], names[1]), names[2], names[3], slope, most, least)


def quotient_pass(surface, slopes, names, view, profile, colors, gain=1):
    """A highlight by roughness in one draw on the future board: appendix A's divide at every fragment.

        cos^2 a' = det K / (det K + x^T adj(K) x),   x = slopes of h - f

    and its square, times the energy s^2 / sqrt(det K): eight stages. K is filtered as K.

    slopes, colors, gain  as for ``rows_pass``
    """
    x = slopes / names.slope
    mesh = replace(
        surface.mesh(colors=vector_colors(x[:, [0, 0, 1]], profile)),
        secondary_colors=vector_colors(x[:, [0, 1, 1]], profile),
    )
    weight = names.square / (names.slope * names.slope)
    base = float(np.sqrt(2.0 * weight * names.least))
    squares, determinant = expand(TEXTURE1), expand(TEXTURE3)
    combiners = program(
        total(expand(PRIMARY), negated(expand(TEXTURE0)), to=SPARE0),
        total(expand(SECONDARY), negated(expand(TEXTURE2)), to=SPARE1),
        both(product(signed(SPARE0), signed(SPARE1), to=SPARE0), dot(squares, determinant, to=SPARE1)),
        stage(
            scaled(4, both(dot(signed(SPARE0), squares, to=SPARE0), product(SPARE1, CONSTANT0, to=SPARE1))),
            constant0=(weight, weight, weight, 0.0),
        ),
        stage(total(SPARE0, SPARE1, to=SPARE0), square_root(blue_of(SPARE1), to=SPARE1)),
        stage(
            quotient(SPARE1, SPARE0, to=SPARE0),
            quotient(CONSTANT0, SPARE1, to=SPARE1),
            constant0=(0.0, 0.0, 0.0, base),
        ),
        square(SPARE0, to=SPARE0),
        scaled(gain, product(SPARE0, alpha_of(SPARE1), to=SPARE0)),
        final(SPARE0, CONSTANT0, plus=CONSTANT1),
        constant0=colors[0],
        constant1=colors[1],
    )
    order = (names.offsets[0], names.adjugate, names.offsets[1], names.covariance)
    units = tuple(unit(name, _TRILINEAR) for name in order)
    return (draw("highlight by K and a divide", mesh, view, combiners, units, depth_test=FIRST_PASS),)
