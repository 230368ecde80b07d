"""The vocabulary in which techniques write texture shaders: plain stages, dependent lookups, dot products."""

from fixedpipe.pipeline.enums import DotProductMapping
from fixedpipe.pipeline.enums import TextureShaderOperation as Operation
from fixedpipe.pipeline.state import TextureShaderStage

NO_TEXTURE = None
TEXTURE_STAGE = TextureShaderStage(Operation.TEXTURE_2D)
PASS_THROUGH_STAGE = TextureShaderStage(Operation.PASS_THROUGH)
# Lookups at unit 0's alpha and red, and at its green and blue.
ALPHA_RED_STAGE = TextureShaderStage(Operation.DEPENDENT_AR_TEXTURE_2D)
GREEN_BLUE_STAGE = TextureShaderStage(Operation.DEPENDENT_GB_TEXTURE_2D)


def dot_product_stages(
    *previous, lookup=Operation.DOT_PRODUCT_TEXTURE_2D, mapping=DotProductMapping.EXPAND_NORMAL
):
    """Stages that multiply their texture coordinates with earlier units' texels; the last one looks the
    products up.

    ``previous``: that unit's number for each stage. ``mapping``: how its texels are read.

    Raises ValueError for no stage.
    """
    if not previous:
        raise ValueError("There is no stage; give the unit whose texel each multiplies: (0, 0) for two.")
    operations = (*[Operation.DOT_PRODUCT] * (len(previous) - 1), lookup)
    return tuple(
        TextureShaderStage(operation, previous_texture_input=unit, dot_product_mapping=mapping)
        for operation, unit in zip(operations, previous, strict=True)
    )
