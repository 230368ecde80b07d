"""H13 and H14: anisotropic reflection as a product of two tables.

One table has the facets, over the halfway vector; the other has the obstruction, over both cosines.

    I_o = c D(x, y) G(n.l, n.v) I_i,    x = h.t / (1 + h.n),  y = h.b / (1 + h.n)

The distribution D of an anisotropic model depends on two angles of the halfway vector h = l + v, normalized:
its distance from the normal and its azimuth. The azimuth jumps from one end of a table to the other. It has
no value at the normal, in the middle of every highlight. The coordinates x and y belong to a conformal map of
the hemisphere onto the unit disc. They are smooth at the normal, and even where the cosine h.n is coarse:
half a degree is a texel of 256 anywhere near the normal. They are not linear in h, so the host, or a vertex
program, computes them at the vertices. With h it may do so for a near light and a near viewer. It also
computes n.l and n.v.

Each table is one texture. Two units multiply them in one pass, one unit in two. Slowly changing parts of a
model, such as Fresnel's factor of l.h, go into the vertices' colour. A G greater than one is stored over
``LARGEST`` and multiplied back, by the second unit's scale or by a blending that doubles.

    Ward (H13)                D = exp(-tan^2 delta (cos^2 phi / alpha_x^2 + sin^2 phi / alpha_y^2))
                              G = sqrt(n.l / n.v)
    Ashikhmin, Shirley (H14)  D = (h.n)^(n_u cos^2 phi + n_v sin^2 phi)
                              G = n.l / max(n.l, n.v), and F(l.h) / (l.h) is the vertices' colour

Their constants, k_s / (4 pi alpha_x alpha_y) and sqrt((n_u + 1)(n_v + 1)) / (8 pi), are part of c. This
factor of the light is chosen so that the highlight is white.

Source: Heidrich 2001, section 1.1.1 (pass sequences A-H13 and A-H14 of the catalogue, which chose x and y);
Ward 1992; Ashikhmin, Shirley 2000.
"""

import math
from dataclasses import replace

import numpy as np

from fixedpipe.effects.geometry.matrices import transform
from fixedpipe.effects.geometry.vectors import dot, normalize, unit_vector
from fixedpipe.effects.geometry.vertex_vectors import dot_products, half_vectors
from fixedpipe.effects.passes.draws import (
    ADD,
    EDGE,
    FIRST_PASS,
    LATER_PASS,
    MODULATE,
    MULTIPLY_DESTINATION_TWICE,
    REPLACE,
    draw,
    unit,
)
from fixedpipe.effects.reflectance.sampled_functions import sampled
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.enums import CombineFunction, CombineOperand, CombineSource, TextureEnvironmentMode
from fixedpipe.pipeline.state import Combine, Lighting, Material, TextureEnvironment
from fixedpipe.pipeline.state import Light as LightState

TECHNIQUES = (
    Technique(
        "H13",
        "an elliptical Gaussian distribution of facets, its coordinates computed at the vertices",
        "1.1.1",
    ),
    Technique("H14", "other anisotropic models by tables of the halfway vector", "1.1.1"),
)

TEXELS = 256
# What a stored one of G is worth: Ward's is kept up to n.l = 4 n.v, as K09 keeps it.
LARGEST = 2.0
_BLACK = (0.0, 0.0, 0.0, 1.0)
_TIMES_TWO = TextureEnvironment(
    TextureEnvironmentMode.COMBINE,
    rgb=Combine(
        CombineFunction.MODULATE,
        (CombineSource.TEXTURE, CombineSource.PREVIOUS),
        (CombineOperand.SRC_COLOR, CombineOperand.SRC_COLOR),
        scale=LARGEST,
    ),
)


def halfway_of(x, y):
    """(h.t, h.b, h.n) of the coordinates x and y: float64 [..., 3]; h.n is negative outside the unit disc."""
    square = x * x + y * y
    return np.stack([2.0 * x, 2.0 * y, 1.0 - square], axis=-1) / (1.0 + square)[..., None]


def ward(x, y, alpha_x, alpha_y):
    """Ward's distribution with its maximum at one; zero for facets that face away from the normal."""
    h = halfway_of(*np.broadcast_arrays(x, y))
    above = h[..., 2] > 0.0
    slope = h[..., :2] / np.where(above, h[..., 2], 1.0)[..., None]
    u, v = slope[..., 0] / alpha_x, slope[..., 1] / alpha_y
    return np.where(above, np.exp(-(u * u + v * v)), 0.0)


def ashikhmin(x, y, exponent_x, exponent_y):
    """Ashikhmin and Shirley's distribution with its maximum at one; zero as ``ward``'s."""
    h = halfway_of(*np.broadcast_arrays(x, y))
    above = h[..., 2] > 0.0
    across = h[..., 0] * h[..., 0] + h[..., 1] * h[..., 1]
    away = across > 0.0
    weighted = exponent_x * h[..., 0] * h[..., 0] + exponent_y * h[..., 1] * h[..., 1]
    exponent = np.where(away, weighted, 0.0) / np.where(away, across, 1.0)
    return np.where(above, np.where(above, h[..., 2], 1.0) ** exponent, 0.0)


def _in_front(n_l, n_v):
    n_l, n_v = np.broadcast_arrays(np.asarray(n_l, np.float64), np.asarray(n_v, np.float64))
    return (n_l > 0.0) & (n_v > 0.0), n_l, n_v


def ward_obstruction(n_l, n_v):
    """sqrt(n.l / n.v), zero where either is behind the surface."""
    front, n_l, n_v = _in_front(n_l, n_v)
    return np.where(front, np.sqrt(np.where(front, n_l, 0.0) / np.where(front, n_v, 1.0)), 0.0)


def ashikhmin_obstruction(n_l, n_v):
    """n.l / max(n.l, n.v), zero where either is behind the surface."""
    front, n_l, n_v = _in_front(n_l, n_v)
    return np.where(front, n_l / np.where(front, np.maximum(n_l, n_v), 1.0), 0.0)


def ashikhmin_fresnel(light_half, reflectance):
    """F(l.h) / (l.h), F by Schlick's approximation: what the vertices' colour holds. float64 [..., k] of l.h
    [...] and of k reflectances at normal incidence.
    """
    u = np.maximum(np.asarray(light_half, np.float64), 1.0 / 64.0)[..., None]
    away = 1.0 - u
    base = np.asarray(reflectance, np.float64)
    return (base + (1.0 - base) * ((away * away) * (away * away) * away)) / u


def _checked(values, words):
    for value in values:
        if not (math.isfinite(value) and value > 0.0):
            raise ValueError(f"{words} are {values!r}; give positive, finite numbers.")


def load_distribution(texture, distribution, parameters, profile, *, texels=TEXELS):
    """The command that loads D(x, y), columns and rows from -1 to 1.

    distribution  ``ward`` or ``ashikhmin``, or another function of arrays x, y and two numbers
    parameters    the two: widths alpha_x and alpha_y, or exponents; positive, else ValueError
    """
    _checked(parameters, "A distribution's two numbers")
    image = sampled(
        lambda s, t: distribution(2.0 * s - 1.0, 2.0 * t - 1.0, *parameters), texels, texels, profile=profile
    )
    return TexImage(label=f"load D as {texture}", texture=texture, image=image)


def load_obstruction(texture, obstruction, profile, *, texels=TEXELS):
    """The command that loads G(n.l, n.v) / ``LARGEST`` over [0, 1]. Its first column and row are zero, so
    that surfaces that face away from the light or the viewer are black.

    obstruction  ``ward_obstruction`` or ``ashikhmin_obstruction``, or another function of two arrays
    """
    image = sampled(lambda s, t: obstruction(s, t) / LARGEST, texels, texels, profile=profile)
    return TexImage(label=f"load G / {LARGEST:g} as {texture}", texture=texture, image=image)


def halfway_coordinates(surface, view, light):
    """Texture coordinates of D at the vertices: float64 [n, 2], (1 + x) / 2 and (1 + y) / 2."""
    h = half_vectors(surface, view, light)
    # A halfway vector against the normal is of a vertex that neither light nor viewer sees.
    below = np.maximum(1.0 + h[:, 2], 1.0 / 64.0)
    return 0.5 + 0.5 * (h[:, :2] / below[:, None])


def cosine_coordinates(surface, view, light):
    """Texture coordinates of G at the vertices: float64 [n, 2], n.l and n.v."""
    lights, views = light.light_vectors(surface.positions), view.view_vectors(surface.positions)
    return dot_products((surface.normals, lights), (surface.normals, views))


def light_half(surface, view, light):
    """l.h at the vertices: float64 [n]."""
    lights = light.light_vectors(surface.positions)
    return dot(lights, normalize(lights + view.view_vectors(surface.positions)))


def specular_passes(surface, view, light, distribution, obstruction, colors, *, units):
    """c D G, which replaces the framebuffer's contents.

    surface, view, light       the light and the viewer may be near
    distribution, obstruction  names of the textures
    colors                     c: RGB at the vertices, float64 [n, 3], or one RGB for all
    units                      how many texture units take part. Two: one pass, in which the second unit
                               scales (EXT_texture_env_combine). One: two passes

    Raises ValueError for another number of units.
    """
    colors = np.broadcast_to(np.asarray(colors, np.float64), (len(surface.positions), 3))
    facets, cosines = (f(surface, view, light) for f in (halfway_coordinates, cosine_coordinates))
    if units == 2:
        mesh = surface.mesh(facets, cosines, colors=colors)
        both = (
            unit(distribution, EDGE, environment=MODULATE),
            unit(obstruction, EDGE, coordinates=1, environment=_TIMES_TWO),
        )
        return (draw("c D G", mesh, view, None, both, depth_test=FIRST_PASS),)
    if units == 1:
        first, second = surface.mesh(facets, colors=colors), surface.mesh(cosines)
        d = (unit(distribution, EDGE, environment=MODULATE),)
        g = (unit(obstruction, EDGE, environment=REPLACE),)
        return (
            draw("c D", first, view, None, d, depth_test=FIRST_PASS),
            draw("times G", second, view, None, g, blending=MULTIPLY_DESTINATION_TWICE),
        )
    raise ValueError(f"The tables are read by {units!r} texture units; give 1 or 2.")


def diffuse_pass(surface, view, light, color):
    """k_d (n.l)+ by hardware lighting, added (A-H04); the light may be near."""
    if light.point:
        place = transform(view.modelview, (*(float(c) for c in light.vector), 1.0))
    else:
        toward = unit_vector(light.vector, "The light's direction")
        place = transform(view.modelview, (*(float(c) for c in toward), 0.0))
    shining = LightState(ambient=_BLACK, specular=_BLACK, position=place)
    material = Material(ambient=_BLACK, diffuse=(*color, 1.0), specular=_BLACK)
    lighting = Lighting(lights=(shining,), front=material, model_ambient=_BLACK)
    command = draw("k_d (n.l)+", surface.mesh(), view, None, depth_test=LATER_PASS, blending=ADD)
    return replace(command, state=replace(command.state, vertex=view.vertex_with(lighting=lighting)))
