"""H11, Phong's, Blinn's and the cosine lobe's model as one table; and H12, the bounds below and above it.

A pass has ambient and diffuse light too.

A table has n.l along its columns and another cosine t along its rows:

    k_a + k_d (n.l)+ + k_s (t)+^N where n.l > 0

Its coordinates are interpolated from vertex to vertex, and then looked up: "fast Phong". The cosine t is one
of

    n.h      Blinn-Phong, by the host at the vertices. Or a texture matrix with the rows l and h makes the
             coordinates from the normal; then light and viewer are far away
    r_v.l    Phong, r_v the viewer's direction mirrored in the normal, at the vertices
    C_x (l_x v_x + l_y v_y) + C_z l_z v_z    one lobe of Lafortune's, in the vertex's frame; the last term
             also has the factor n.l, by which a reflectance is multiplied

The centres of the first and the last texel are zero and one, so a cosine is scaled by (W - 1)/W and moved by
half a texel. A highlight lies at the table's end, where half a texel matters. Cosines keep their sign. A
negative one reads the table's edge, its value at zero. Between a lit and an unlit vertex, the interpolated
cosine crosses zero in the right place.

The lower bound is Gouraud shading, OpenGL's lighting at the vertices (``lighting_pass``): the same model with
interpolated colours. The upper bound is the model at every pixel, which the host computes (``shade``).

Powers are products, so that texels have the same bits on every processor.

Source: Heidrich 2001, section 1.1 (H11, H12 of the catalogue; pass sequences A-H11, A-H12); OpenGL 1.2.1,
section 2.13.1.
"""

from dataclasses import replace
from enum import Enum

import numpy as np

from fixedpipe.effects.geometry.vectors import dot, unit_vector
from fixedpipe.effects.geometry.vertex_vectors import reflected
from fixedpipe.effects.passes.arguments import member_of
from fixedpipe.effects.passes.draws import EDGE, FIRST_PASS, REPLACE, draw, unit
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.reflectance.brdfs import half_vector
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.state import Light as LightState
from fixedpipe.pipeline.state import Lighting, Material
from fixedpipe.pipeline.textures.images import texture_2d

TECHNIQUES = (
    Technique("H11", "Phong's, Blinn's and the cosine lobe's model, each one table in one pass", "1.1"),
    Technique("H12", "fast Phong's bounds: lighting at the vertices, and the model at every pixel", "1.1"),
)

# Texels along either axis. Source: A-H02's.
TEXELS = 256
_LAST_ROW = (0.0, 0.0, 0.0, 1.0)


class Cosine(Enum):
    """What a table's rows are."""

    HALF = "Blinn-Phong"
    REFLECTED = "Phong"
    LOBE = "cosine lobe"


def power(base, exponent):
    """``base`` to a whole exponent from 0 on, by products."""
    out, factor = np.ones_like(base), base
    while exponent:
        if exponent & 1:
            out = out * factor
        factor, exponent = factor * factor, exponent >> 1
    return out


def shade(light_cosine, other_cosine, exponent, cosine, *, ambient, diffuse, specular):
    """The model's light: float64 [..., 3].

    light_cosine, other_cosine  float64 [...]: n.l and t, of any sign
    exponent                    N, a whole number from 1 on
    cosine                      a Cosine: LOBE has the factor n.l in its last term
    ambient, diffuse, specular  RGB k_a, k_d, k_s

    Raises ValueError for an exponent that is none.
    """
    member_of(Cosine, cosine, "What the rows are")
    if isinstance(exponent, bool) or int(exponent) != exponent or exponent < 1:
        raise ValueError(f"The exponent is {exponent!r}; give a whole number from 1 on.")
    lit = np.maximum(0.0, np.asarray(light_cosine, np.float64))
    peak = power(np.maximum(0.0, np.asarray(other_cosine, np.float64)), int(exponent))
    peak = peak * lit if cosine is Cosine.LOBE else np.where(lit > 0.0, peak, 0.0)
    k_a, k_d, k_s = (np.asarray(k, np.float64) for k in (ambient, diffuse, specular))
    return (k_a + k_d * lit[..., None]) + k_s * peak[..., None]


def load(texture, profile, exponent, cosine, *, ambient, diffuse, specular, texels=TEXELS):
    """The command that loads a table, RGB over n.l (columns) and t (rows), both from 0 to 1.

    ``texels``: along either axis, a power of two. Sums above one are stored as one, except for an exact
    profile.
    """
    at = np.arange(texels) / (texels - 1.0)
    s, t = at[None, :] + 0.0 * at[:, None], at[:, None] + 0.0 * at[None, :]
    values = shade(s, t, exponent, cosine, ambient=ambient, diffuse=diffuse, specular=specular)
    return TexImage(
        label=f"load {texture}", texture=texture, image=texture_2d(factor_texels(values, profile))
    )


def lobe_cosine(toward_light, toward_viewer, coefficients):
    """t of Lafortune's lobe, of vectors in the surface's frame [..., 3] and (C_x, C_z): float64 [...]."""
    along, up = (float(c) for c in coefficients)
    l, v = toward_light, toward_viewer  # noqa: E741 (the paper's letters)
    return along * (l[..., 0] * v[..., 0] + l[..., 1] * v[..., 1]) + up * (l[..., 2] * v[..., 2])


def placed(cosines, texels=TEXELS):
    """Cosines as coordinates of a table whose first and last texels' centres are zero and one."""
    return cosines * ((texels - 1.0) / texels) + 0.5 / texels


def placing(direction, texels=TEXELS):
    """A row of a texture matrix that makes ``placed`` of a normal's product with a direction [3]."""
    scale = (texels - 1.0) / texels
    return (*(scale * float(c) for c in direction), 0.5 / texels)


def coordinates(surface, view, light, cosine, coefficients=None, texels=TEXELS):
    """A table's coordinates, of (n.l, t) at a surface's vertices: float64 [n, 2].

    ``coefficients``: (C_x, C_z) of a LOBE; ``texels``: as the table was loaded. Raises ValueError where a
    lobe has no coefficients.
    """
    toward_light = light.light_vectors(surface.positions)
    toward_viewer = view.view_vectors(surface.positions)
    if member_of(Cosine, cosine, "What the rows are") is Cosine.HALF:
        other = dot(surface.normals, half_vector(toward_light, toward_viewer))
    elif cosine is Cosine.REFLECTED:
        other = dot(reflected(toward_viewer, surface.normals), toward_light)
    elif coefficients is None:
        raise ValueError("A cosine lobe needs its coefficients (C_x, C_z); (-1, 1) is Phong's.")
    else:
        local = surface.to_local(toward_light), surface.to_local(toward_viewer)
        other = lobe_cosine(*local, coefficients)
    return placed(np.stack([dot(surface.normals, toward_light), other], axis=-1), texels)


def table_pass(surface, view, light, texture, cosine, *, coefficients=None, texels=TEXELS):
    """The pass of a table, its coordinates computed at the vertices (A-H11)."""
    mesh = surface.mesh(coordinates(surface, view, light, cosine, coefficients, texels))
    units = (unit(texture, EDGE, environment=REPLACE),)
    return draw(f"{cosine.value} by a table", mesh, view, None, units, depth_test=FIRST_PASS)


def matrix_pass(surface, view, light, texture, *, texels=TEXELS):
    """The pass of Blinn-Phong's table, its coordinates made by the texture matrix of the normals.

    Raises ValueError where the light or the viewer is near: their directions then differ by vertex.
    """
    if light.point or not view.infinite_viewer:
        near = "light" if light.point else "viewer"
        raise ValueError(
            f"The {near} is near, and one texture matrix serves all of a mesh; give a directional light "
            "and an orthographic view, or compute the coordinates at the vertices (table_pass)."
        )
    toward_light = unit_vector(light.vector, "The light's direction")
    half = half_vector(toward_light, unit_vector(view.eye, "The direction to the viewer"))
    rows = placing(toward_light, texels), placing(half, texels), (0.0,) * 4, _LAST_ROW
    units = (unit(texture, EDGE, matrix=rows, environment=REPLACE),)
    label = "Blinn-Phong by a table, coordinates by the texture matrix"
    return draw(label, surface.mesh(surface.normals), view, None, units, depth_test=FIRST_PASS)


def lighting_pass(surface, view, light, exponent, *, ambient, diffuse, specular):
    """Gouraud shading by OpenGL's lighting: Blinn-Phong at the vertices, with interpolated colours.

    The light is directional and the viewer far away. Raises ValueError otherwise, and for an exponent above
    128.
    """
    if light.point or not view.infinite_viewer:
        raise ValueError("Lighting is compared under a directional light, the viewer far away; give both.")
    if not 1 <= exponent <= 128:
        raise ValueError(f"The exponent is {exponent!r}; OpenGL's shininess reaches from 0 to 128.")
    position = (*map(float, unit_vector(light.vector, "The light's direction")), 0.0)
    white, black = (1.0, 1.0, 1.0, 1.0), (0.0, 0.0, 0.0, 1.0)
    lamp = LightState(ambient=white, diffuse=white, specular=white, position=position)
    material = Material((*ambient, 1.0), (*diffuse, 1.0), (*specular, 1.0), shininess=float(exponent))
    state = Lighting(lights=(lamp,), front=material, model_ambient=black)
    command = draw("OpenGL's lighting", surface.mesh(), view, None, depth_test=FIRST_PASS)
    return replace(command, state=replace(command.state, vertex=view.vertex_with(lighting=state)))
