"""S21 to S23 on machines: highlights by tables of two numbers.

One roughness for all, any machine with textures:

    d = (h.e_1, h.e_2) is a texture coordinate of the vertices, and the highlight a table over it. The table
    holds the whole formula, with its divide and its power, for that one K.

Source: Schilling 1997, appendix A; pass sequences A-S21 to A-S23 of the catalogue, which proposes a lookup of
two parameters in place of the divide. Assumed: the table's layout.
"""

import numpy as np

from fixedpipe.effects.geometry.vertex_vectors import half_vectors
from fixedpipe.effects.passes.draws import EDGE, FIRST_PASS, REPLACE, draw, unit
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.technique import Variant
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.enums import InternalFormat
from fixedpipe.pipeline.textures.images import texture_2d

TECHNIQUES = (Variant(("S21", "S22", "S23"), "on machines, by tables of two numbers"),)


def table_places(texels):
    """d at a table's texels, from -1 to 1 along both edges: float64 [texels, texels, 2].

    Vectors in the corners belong to no direction: the rim's values continue there.
    """
    edge = (np.arange(texels) + 0.5) / texels * 2.0 - 1.0
    d = np.stack(np.meshgrid(edge, edge), axis=-1)
    length = np.sqrt(d[..., 0] * d[..., 0] + d[..., 1] * d[..., 1])
    return d / np.maximum(length, 1.0)[..., None] * (1.0 - 1e-12)


def load_table(colors, name, profile):
    """The command that loads a highlight over d: RGB, float64 [n, n, 3] at ``table_places``."""
    image = texture_2d(factor_texels(np.clip(colors, 0.0, 1.0), profile), InternalFormat.RGB8)
    return TexImage(label=f"load {name} over (h.e_1, h.e_2)", texture=name, image=image)


def table_pass(surface, name, view, light):
    """A highlight of one roughness in one draw: d at the vertices, the table at every fragment."""
    d = half_vectors(surface, view, light)[:, :2]
    units = (unit(name, EDGE, environment=REPLACE),)
    return (
        draw(f"highlight: {name}", surface.mesh(0.5 + 0.5 * d), view, None, units, depth_test=FIRST_PASS),
    )
