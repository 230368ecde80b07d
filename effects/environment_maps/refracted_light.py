"""H30: glossy transmission, a filtered environment map looked up along the refracted direction.

No coordinate generation gives refracted vectors, so the host writes them at the vertices, in the world's
axes. A board with cube maps looks them up in one. Other boards have one disc of a parabolic map, about the
viewing direction, and the texture matrix that divides. Glass refracts light away from the eye, so the other
disc is not needed.

Source: Heidrich 2001, section 1.6; pass sequence A-H30 of the catalogue; Heidrich, Seidel 1998 (the disc).
"""

import math

import numpy as np

from fixedpipe.effects.geometry import parabolic_maps
from fixedpipe.effects.geometry.matrices import product, rotate
from fixedpipe.effects.geometry.vertex_vectors import refraction_vectors
from fixedpipe.effects.passes.draws import EDGE, REPLACE, unit
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.textures.images import texture_2d

TECHNIQUES = (
    Technique("H30", "glossy transmission: a filtered environment map along the refracted direction", "1.6"),
)


def refracted_mesh(surface, view, index):
    """The surface with refracted directions as texture coordinates [n, 3], in the world's axes.

    ``index``: the index of refraction, inside over outside. Raises ValueError if it is not positive and
    finite.
    """
    if not (math.isfinite(index) and index > 0.0):
        raise ValueError(f"The index of refraction is {index}; give a number above 0, as 1.5 for glass.")
    directions, _ = refraction_vectors(surface, view, 1.0 / float(index))
    return surface.mesh(directions)


def cube_unit(texture):
    """A texture unit that reads a cube map along the mesh's own directions."""
    return unit(texture, EDGE, environment=REPLACE)


def _turn(view):
    """The view's rotation, world to eye: float64 [3, 3]."""
    return np.array(view.modelview)[:3, :3]


def load_disc(name, environment, view, size, profile):
    """The command that loads the directions ahead of the eye as a disc, ``size`` texels along an edge.

    ``environment``: world directions [..., 3] to RGB in [0, 1]. It must be smooth, because it is sampled at
    texel centres.
    """
    toward = parabolic_maps.directions(size, parabolic_maps.margin(size))[0]
    colors = environment(rotate(_turn(view).T, toward))
    return TexImage(label=f"load {name}", texture=name, image=texture_2d(factor_texels(colors, profile)))


def disc_unit(texture, view, size):
    """A texture unit that reads ``load_disc``'s texture of ``size`` along the mesh's own directions."""
    turn = _turn(view)
    rows = (*((*(float(v) for v in row), 0.0) for row in turn), (0.0, 0.0, 0.0, 1.0))
    matrix = product(parabolic_maps.matrix(0, parabolic_maps.margin(size)), rows)
    return unit(texture, EDGE, environment=REPLACE, matrix=matrix)
