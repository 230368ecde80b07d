"""The machine that Schilling's paper of 1997 proposes: TEXRAM with bumps that keep their roughness.

The paper has the offset vectors' interpolation, the second pyramid and an environment read by it; what the
stages between them are is as NV_texture_shader has them, which others have built since.
"""

from fixedpipe.pipeline.enums import DotProductMapping, TextureShaderOperation
from fixedpipe.pipeline.profiles.known import known
from fixedpipe.pipeline.profiles.texram import TEXRAM

_PROPOSED = "Source: Schilling 1997, section 8 (proposed)"
_WORDS = frozenset({DotProductMapping.UNSIGNED_HILO, DotProductMapping.SIGNED_HILO_HEMISPHERE})

SCHILLING = TEXRAM.descendant(
    name="Schilling board",
    description="what the paper of 1997 proposes: environments read through the roughness of bumps",
    inherited="Assumed: as on TEXRAM",
    max_texture_units=known(
        4, f"{_PROPOSED}; the number Inferred: bumps, roughness and the two coordinates of a lookup"
    ),
    texture_shader_operations=known(
        TEXRAM.texture_shaders.texture_shader_operations
        | {TextureShaderOperation.DOT_PRODUCT, TextureShaderOperation.DOT_PRODUCT_TEXTURE_2D},
        f"{_PROPOSED}; dot products Assumed: the derivative by the bumps, a pair of numbers for each "
        "coordinate, is iterated",
    ),
    dot_product_mappings=known(
        frozenset(DotProductMapping) - _WORDS, f"{_PROPOSED}; of bytes, with and without signs"
    ),
    roughness_lookups=known(True, _PROPOSED),
    exact_probes=known(
        True, "Assumed: a board that divides for its axes divides a sum of probes too; no paper has one"
    ),
)
