"""What combiners may read, write and scale by, for whoever draws programs at random."""

from fixedpipe.pipeline.enums import CombinerBias, CombinerScale, Register

TEXTURE_REGISTERS = (Register.TEXTURE0, Register.TEXTURE1, Register.TEXTURE2, Register.TEXTURE3)
WRITABLE = (Register.PRIMARY_COLOR, Register.SECONDARY_COLOR, Register.SPARE0, Register.SPARE1)
READ_ONLY = (Register.ZERO, Register.CONSTANT_COLOR0, Register.CONSTANT_COLOR1, Register.FOG)
SCALES_AND_BIASES = (
    *((scale, CombinerBias.NONE) for scale in CombinerScale),
    (CombinerScale.NONE, CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF),
    (CombinerScale.SCALE_BY_TWO, CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF),
)
