"""K02, the gloss map: k_s varies per texel, the exponent stays constant.

This is what hardware bump mapping could vary before the paper. The alpha of the normal map is k_s, and the
blender multiplies the highlight by it.

Source: Kautz, Seidel 2000, section 1 (K02 of the catalogue).
"""

import numpy as np

from fixedpipe.effects.bump_mapping.diffuse_bump import diffuse_pass
from fixedpipe.effects.geometry.vertex_vectors import half_vectors, light_vectors
from fixedpipe.effects.passes.combiners import (
    PRIMARY,
    SPARE0,
    TEXTURE0,
    dot,
    expand,
    final,
    product,
    program,
    square,
    stage,
)
from fixedpipe.effects.passes.draws import draw, unit
from fixedpipe.effects.passes.encoding import colors_of, factor_texels, vector_colors
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.enums import BlendFactor
from fixedpipe.pipeline.state import Blending

TECHNIQUES = (
    Technique("K02", "a gloss map: the highlight's strength varies per texel, its width per polygon", "1"),
)

MODULATED_BY_ALPHA = Blending(BlendFactor.SRC_ALPHA, BlendFactor.ONE)


def gloss_combiners():
    """K14's (n.h)^8; alpha = k_s of the normal map's alpha times the gate of the vertices' alpha."""
    fourth_power = square(SPARE0)
    return program(
        stage(dot(expand(TEXTURE0), expand(PRIMARY), to=SPARE0), alpha=product(TEXTURE0, PRIMARY, to=SPARE0)),
        square(SPARE0, to=SPARE0),
        final(fourth_power, fourth_power, alpha=SPARE0),
    )


def specular_pass(surface, normal_map, view, light, profile):
    """k_s (h.n)^8, added: one draw. The vertices' alpha is min(1, 8 (n.l)+) of the smooth surface."""
    vectors = vector_colors(half_vectors(surface, view, light), profile)
    gate = np.clip(8.0 * light_vectors(surface, light)[:, 2:], 0.0, 1.0)
    colors = np.concatenate([vectors, colors_of(factor_texels(gate, profile))], axis=-1)
    label = "specular pass: k_s (h.n)^8, k_s from the gloss map"
    mesh = surface.mesh(colors=colors)
    units = (unit(normal_map),)
    return (draw(label, mesh, view, gloss_combiners(), units, blending=MODULATED_BY_ALPHA),)


def commands(surface, normal_map, view, light, profile, *, color, ambient=(0.0, 0.0, 0.0)):
    """The diffuse pass, then the highlight under the gloss map."""
    return (
        *diffuse_pass(surface, normal_map, view, light, profile, color=color, ambient=ambient),
        *specular_pass(surface, normal_map, view, light, profile),
    )
