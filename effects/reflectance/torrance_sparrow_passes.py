"""H02 to H06, H09 and H10: Torrance-Sparrow's model as two tables, multiplied by units or by blending.

    F(cos theta) D(cos delta)                    over l.h and n.h
    G(cos alpha, cos beta) / (c pi cos beta)     over n.l and n.v

The vertices' colour is light times k_s. With two units the product takes one pass (H02). With one it takes
two, and blending multiplies the second (H03). Diffuse light takes another pass, or a third unit (H04). The
host or a vertex program computes the tables' coordinates at the vertices (H05). If light and viewer are far
away, two texture matrices can make them from the normal (H06). Schlick's approximations may replace all three
functions (H09).

At grazing views G / (pi cos beta) exceeds one, the more the smoother the surface is, and a table of bytes
clamps it (artefact P1). Divided by c it does not exceed one, and the picture is multiplied back (H10). A
combiner's scale does that, or the accumulation buffer, or drawing white with DST_COLOR, ONE, which doubles
the framebuffer.

The centres of a table's first and last texels are the cosines zero and one (``placed``), and zero gives zero.
A surface that faces away from the light or the viewer reads the first column or row, which is black (erratum
E000.2).

Source: Heidrich 2001, section 1.1, Eq. 1 to 3; Schlick 1994 (pass sequences A-H02 to A-H06, A-H10 of the
catalogue; errata E000.1, E000.2).
"""

import math
from enum import Enum

import numpy as np

from fixedpipe.effects.geometry.vectors import dot, unit_vector
from fixedpipe.effects.passes.arguments import member_of, one_of
from fixedpipe.effects.passes.combiners import (
    PRIMARY,
    SPARE0,
    TEXTURE0,
    TEXTURE1,
    product,
    program,
    scaled,
    shown,
    stage,
)
from fixedpipe.effects.passes.draws import (
    EDGE,
    FIRST_PASS,
    LATER_PASS,
    MODULATE,
    MULTIPLY_DESTINATION,
    REPLACE,
    draw,
    unit,
)
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.reflectance import brdfs, microfacets
from fixedpipe.effects.reflectance.brdfs import half_vector
from fixedpipe.effects.reflectance.fresnel import fresnel
from fixedpipe.effects.reflectance.phong_tables import placed, placing
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.commands import Accum, TexImage
from fixedpipe.pipeline.enums import AccumOperation, BlendFactor, InternalFormat, TextureEnvironmentMode
from fixedpipe.pipeline.state import Blending, TextureEnvironment
from fixedpipe.pipeline.textures.images import texture_2d

TECHNIQUES = (
    Technique("H02", "Torrance-Sparrow as two tables, multiplied by two texture units", "1.1"),
    Technique("H03", "Torrance-Sparrow's two tables, multiplied by blending, with one texture unit", "1.1"),
    Technique("H04", "the diffuse term as a pass of hardware lighting, or on a third unit", "1.1"),
    Technique("H05", "the tables' coordinates computed at the vertices", "1.1"),
    Technique("H06", "the tables' coordinates made by texture matrices of the normal", "1.1"),
    Technique("H09", "Schlick's approximations as the tables' factors", "1.1"),
    Technique("H10", "a table divided by c, so that it is not clamped, and a picture multiplied by c", "1.1"),
)

# Texels along either axis. Source: A-H02.
TEXELS = 256
FACETS, OBSTRUCTION, DIFFUSE = "F D", "G / (c pi cos beta)", "k_d (n.l)+"
# DST_COLOR, ONE with white: what the framebuffer holds, added to itself.
DOUBLE = Blending(BlendFactor.DST_COLOR, BlendFactor.ONE)


class Coordinates(Enum):
    """Who makes a table's coordinates."""

    VERTICES = "vertices"
    TEXTURE_MATRIX = "texture matrix"


class Remedy(Enum):
    """What multiplies a picture of a divided table by c."""

    NONE = "none"
    COMBINER = "combiner scale"
    DOUBLING = "doubling"
    ACCUMULATION = "accumulation buffer"


class Factors(Enum):
    """Whose functions the tables hold."""

    TORRANCE_SPARROW = "Torrance, Sparrow and Smith"
    SCHLICK = "Schlick"


def facets(light_half, normal_half, roughness, index, distribution="gaussian heights"):
    """F D of l.h and n.h: float64, 0 to 1; ``distribution``: of ``microfacets.DISTRIBUTIONS``."""
    facet = one_of(tuple(microfacets.DISTRIBUTIONS), distribution, "The distribution of facets")
    return fresnel(light_half, index) * microfacets.DISTRIBUTIONS[facet](normal_half, roughness)


def schlick_facets(light_half, normal_half, roughness, index):
    """Schlick's approximations of both: F by the fifth power, and Z over its largest value. float64, 0 to 1.

    Assumed: his r is m^2, with which Z falls about as fast near its middle.
    """
    r = roughness * roughness
    normal = fresnel(1.0, index)
    return brdfs.schlick_fresnel(light_half, normal) * (r * brdfs.schlick_z(normal_half, r))


def _over_view(value, view_cosine):
    seen = np.asarray(view_cosine, np.float64)
    return np.where(seen > 0.0, value / (np.pi * np.where(seen > 0.0, seen, 1.0)), 0.0)


def obstruction(light_cosine, view_cosine, sigma):
    """G / (pi cos beta) of n.l and n.v: float64, from 0, above one where the view grazes; zero at zero."""
    return _over_view(microfacets.smith(light_cosine, view_cosine, sigma), view_cosine)


def schlick_obstruction(light_cosine, view_cosine, roughness):
    """The same by Schlick's approximation of G, with r = m^2."""
    r = roughness * roughness
    lit, seen = (np.maximum(0.0, np.asarray(c, np.float64)) for c in (light_cosine, view_cosine))
    return _over_view(brdfs.schlick_g(lit, r) * brdfs.schlick_g(seen, r), seen)


def _table(label, texture, function, texels, profile):
    at = np.arange(texels) / (texels - 1.0)
    values = np.broadcast_to(function(at[None, :], at[:, None]), (texels, texels))
    if not profile.arithmetic.exact:
        # Rounded at once: exponentials differ between computers in their last bit.
        values = np.floor(255.0 * np.clip(values, 0.0, 1.0) + 0.5) / 255.0
    return TexImage(
        label=label, texture=texture, image=texture_2d(values[..., None], InternalFormat.LUMINANCE8)
    )


def load(
    profile,
    roughness,
    index,
    *,
    divisor=1.0,
    distribution="gaussian heights",
    factors=Factors.TORRANCE_SPARROW,
    texels=TEXELS,
    name="",
):
    """The two commands that load the tables ``name`` + FACETS and ``name`` + OBSTRUCTION.

    roughness  m of the distribution; Smith's sigma is m / sqrt(2)
    index      of refraction
    divisor    c of the second table, from 1; results above one are clamped, except on an exact profile
    factors    SCHLICK: his approximations of all three, with his own distribution
    texels     of either axis, a power of two

    Raises ValueError for a roughness or a divisor that is none.
    """
    for value, what, least in ((roughness, "The roughness m", 0.0), (divisor, "The divisor c", 1.0)):
        if not (math.isfinite(value) and value >= least and value > 0.0):
            raise ValueError(
                f"{what} is {value!r}; give a finite number {'above 0' if least == 0 else 'from 1 on'}."
            )
    sigma = roughness / math.sqrt(2.0)
    first, second = {
        Factors.TORRANCE_SPARROW: (
            lambda s, t: facets(s, t, roughness, index, distribution),
            lambda s, t: obstruction(s, t, sigma),
        ),
        Factors.SCHLICK: (
            lambda s, t: schlick_facets(s, t, roughness, index),
            lambda s, t: schlick_obstruction(s, t, roughness),
        ),
    }[member_of(Factors, factors, "The factors")]
    return (
        _table(f"load {name}{FACETS}", name + FACETS, first, texels, profile),
        _table(f"load {name}G / ({divisor:g} pi cos beta)", name + OBSTRUCTION,
               lambda s, t: second(s, t) / divisor, texels, profile),
    )  # fmt: skip


def load_diffuse(profile, color, *, texels=TEXELS, name=""):
    """The command that loads ``name`` + DIFFUSE, k_d (n.l)+ over the second table's coordinates."""
    at = np.arange(texels) / (texels - 1.0)
    values = np.broadcast_to(at[None, :, None] * np.asarray(color, np.float64), (texels, texels, 3))
    texture = name + DIFFUSE
    return TexImage(
        label=f"load {texture}", texture=texture, image=texture_2d(factor_texels(values, profile))
    )


def vertex_coordinates(surface, view, light, texels=TEXELS):
    """Coordinates of both tables at the vertices, two float64 [n, 2]: (l.h, n.h) and (n.l, n.v)."""
    lights, views = light.light_vectors(surface.positions), view.view_vectors(surface.positions)
    half, normals = half_vector(lights, views), surface.normals
    first = np.stack([dot(lights, half), dot(normals, half)], axis=-1)
    second = np.stack([dot(normals, lights), dot(normals, views)], axis=-1)
    return placed(first, texels), placed(second, texels)


def matrices(view, light, texels=TEXELS):
    """The texture matrices of Eq. 2 and 3, which make both tables' coordinates of the normal.

    Raises ValueError where the light or the viewer is near: their directions then differ by vertex.
    """
    if light.point or not view.infinite_viewer:
        near = "light" if light.point else "viewer"
        raise ValueError(
            f"The {near} is near, and one texture matrix serves all of a mesh; give a directional light and "
            "an orthographic view, or Coordinates.VERTICES."
        )
    toward_light = unit_vector(light.vector, "The light's direction")
    toward_viewer = unit_vector(view.eye, "The direction to the viewer")
    half = half_vector(toward_light, toward_viewer)
    none, last = (0.0,) * 4, (0.0, 0.0, 0.0, 1.0)
    cosine = (0.0, 0.0, 0.0, float(placed(dot(toward_light, half), texels)))
    return (
        (cosine, placing(half, texels), none, last),
        (placing(toward_light, texels), placing(toward_viewer, texels), none, last),
    )


def _sources(surface, view, light, coordinates, texels):
    """Coordinates and matrices of both tables."""
    if member_of(Coordinates, coordinates, "The coordinates' maker") is Coordinates.VERTICES:
        return vertex_coordinates(surface, view, light, texels), ({}, {})
    return (surface.normals,) * 2, tuple({"matrix": m} for m in matrices(view, light, texels))


def passes(
    surface,
    view,
    light,
    color,
    *,
    units=2,
    coordinates=Coordinates.VERTICES,
    texels=TEXELS,
    name="",
    scale=1,
):
    """The product of both tables times a colour: one pass on two units, or two passes on one.

    color  RGB in [0, 1], k_s times the light
    units  2 or 1; or 3, where the third adds ``load_diffuse``'s table in the same pass
    scale  by register combiners, 1, 2 or 4: with it both units are read by a program (H10)
    name   as the tables were loaded

    Raises ValueError for other numbers.
    """
    count = one_of((1, 2, 3), units, "The number of texture units")
    (first, second), (turn_first, turn_second) = _sources(surface, view, light, coordinates, texels)
    colors = np.broadcast_to(np.asarray(color, np.float64), (len(surface.positions), 3))
    if scale != 1:
        mesh = surface.mesh(first, second, colors=colors)
        both = (
            unit(name + FACETS, EDGE, **turn_first),
            unit(name + OBSTRUCTION, EDGE, coordinates=1, **turn_second),
        )
        combiners = program(
            stage(product(TEXTURE0, PRIMARY, to=SPARE0)),
            stage(scaled(scale, product(SPARE0, TEXTURE1, to=SPARE0))),
            shown(SPARE0),
        )
        return (draw(f"F D times G, times {scale}", mesh, view, combiners, both, depth_test=FIRST_PASS),)
    facet_unit = unit(name + FACETS, EDGE, environment=MODULATE, **turn_first)
    if count > 1:
        mesh = surface.mesh(first, second, colors=colors)
        more = [unit(name + OBSTRUCTION, EDGE, coordinates=1, environment=MODULATE, **turn_second)]
        if count == 3:
            add = TextureEnvironment(TextureEnvironmentMode.ADD)
            more.append(unit(name + DIFFUSE, EDGE, coordinates=1, environment=add, **turn_second))
        label = "F D times G / (pi cos beta)" + ", plus k_d (n.l)+" * (count == 3)
        return (draw(label, mesh, view, None, (facet_unit, *more), depth_test=FIRST_PASS),)
    other = unit(name + OBSTRUCTION, EDGE, environment=REPLACE, **turn_second)
    return (
        draw("F D", surface.mesh(first, colors=colors), view, None, (facet_unit,), depth_test=FIRST_PASS),
        draw(
            "times G / (pi cos beta)",
            surface.mesh(second),
            view,
            None,
            (other,),
            blending=MULTIPLY_DESTINATION,
        ),
    )


def multiplied(surface, view, divisor, remedy):
    """Commands that multiply the framebuffer by c, where the surface is drawn, or on its panel.

    DOUBLING draws the surface, white, log2(c) times; ACCUMULATION returns the panel c times. Raises
    ValueError if doubling cannot reach c, and for NONE and COMBINER, which need no commands.
    """
    if member_of(Remedy, remedy, "The remedy") is Remedy.ACCUMULATION:
        scissor = view.panel.scissor
        return (
            Accum(label="accumulation buffer: load", operation=AccumOperation.LOAD, scissor=scissor),
            Accum(
                label=f"return {divisor:g} times",
                operation=AccumOperation.RETURN,
                value=float(divisor),
                scissor=scissor,
            ),
        )
    if remedy is not Remedy.DOUBLING:
        raise ValueError(f"{remedy.value!r} is no command; give Remedy.DOUBLING or Remedy.ACCUMULATION.")
    times = round(math.log2(divisor))
    if 2.0**times != divisor:
        raise ValueError(f"Doubling multiplies by powers of two, and c is {divisor!r}; give 1, 2, 4 or 8.")
    white = surface.mesh(colors=np.ones((len(surface.positions), 3)))
    return tuple(
        draw(f"doubled, {k + 1}", white, view, None, depth_test=LATER_PASS, blending=DOUBLE)
        for k in range(times)
    )
