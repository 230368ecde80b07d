"""K02, the gloss map: k_s varies per texel, the exponent stays constant.

What hardware bump mapping could vary before the paper: the alpha of the normal map is k_s, and the blender
multiplies the highlight by it.

Source: Kautz, Seidel 2000, section 1 (K02 of the catalogue).
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.bump_mapping.diffuse_bump import blinn_phong_combiners, diffuse_pass
from fixedpipe.effects.geometry.vertex_vectors import half_vectors, light_vectors
from fixedpipe.effects.passes.combiners import alpha_of
from fixedpipe.effects.passes.draws import LATER_PASS, draw, unit
from fixedpipe.effects.passes.encoding import encode_factor, encode_vertex_color
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.enums import BlendFactor, Register
from fixedpipe.pipeline.state import AlphaPortion, Blending

TECHNIQUES = (
    Technique("K02", "a gloss map: the highlight's strength per texel, its width for a polygon", "1"),
)

MODULATED_BY_ALPHA = Blending(BlendFactor.SRC_ALPHA, BlendFactor.ONE)


def gloss_combiners():
    """K14's highlight; alpha = k_s of the normal map's alpha times the gate of the vertices' alpha."""
    combiners = blinn_phong_combiners()
    gloss = AlphaPortion(
        a=alpha_of(Register.TEXTURE0),
        b=alpha_of(Register.PRIMARY_COLOR),
        ab_output=Register.SPARE0,
        sum_output=Register.DISCARD,
    )
    first, second = combiners.general
    final = replace(combiners.final, g=alpha_of(Register.SPARE0))
    return replace(combiners, general=(replace(first, alpha=gloss), second), final=final)


def specular_pass(surface, normal_map, view, light, profile):
    """k_s (h.n)^8, added: one draw. The vertices' alpha is min(1, 8 (n.l)+) of the smooth surface."""
    vectors = encode_vertex_color(half_vectors(surface, view, light), profile)
    gate = np.clip(8.0 * light_vectors(surface, light)[:, 2:], 0.0, 1.0)
    stored = encode_factor(gate, profile)
    colors = np.concatenate([vectors, stored if profile.exact else stored / 255.0], axis=-1)
    label = "specular pass: k_s (h.n)^8, k_s from the gloss map"
    mesh = surface.mesh(colors=colors)
    units = (unit(normal_map),)
    return (
        draw(label, mesh, view, gloss_combiners(), units, depth_test=LATER_PASS, blending=MODULATED_BY_ALPHA),
    )


def commands(surface, normal_map, view, light, profile, *, color, ambient=(0.0, 0.0, 0.0)):
    """The diffuse pass, then the highlight under the gloss map."""
    return (
        *diffuse_pass(surface, normal_map, view, light, profile, color=color, ambient=ambient),
        *specular_pass(surface, normal_map, view, light, profile),
    )
