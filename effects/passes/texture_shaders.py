"""Parts of texture shaders, for techniques: a unit's plain stage, and a dot product of a normal's texel."""

from fixedpipe.pipeline.enums import DotProductMapping
from fixedpipe.pipeline.enums import TextureShaderOperation as Operation
from fixedpipe.pipeline.state import TextureShaderStage

NO_TEXTURE = None
TEXTURE_STAGE = TextureShaderStage(Operation.TEXTURE_2D)


def dot_product_stage(operation, previous):
    """A stage whose dot product reads ``previous``'s texel as EXPAND_NORMAL does."""
    return TextureShaderStage(
        operation, previous_texture_input=previous, dot_product_mapping=DotProductMapping.EXPAND_NORMAL
    )
