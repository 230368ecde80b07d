"""The words of the ``!!RC1.0`` notation, for its reader and its writer.

The reader is ``register_combiners``, the writer ``register_combiner_format``.
"""

from fixedpipe.pipeline.enums import CombinerBias, CombinerScale, ComponentUsage, Mapping, Register
from fixedpipe.pipeline.state import AlphaPortion, CombinerInput, GeneralCombiner, RGBPortion

# Source: nvparse's rc1.0_register.h.
MAX_GENERAL_COMBINERS = 8

REGISTER_NAMES = {
    Register.ZERO: "zero",
    Register.CONSTANT_COLOR0: "const0",
    Register.CONSTANT_COLOR1: "const1",
    Register.FOG: "fog",
    Register.PRIMARY_COLOR: "col0",
    Register.SECONDARY_COLOR: "col1",
    Register.SPARE0: "spare0",
    Register.SPARE1: "spare1",
    Register.TEXTURE0: "tex0",
    Register.TEXTURE1: "tex1",
    Register.TEXTURE2: "tex2",
    Register.TEXTURE3: "tex3",
    Register.E_TIMES_F: "final_product",
    Register.SPARE0_PLUS_SECONDARY_COLOR: "color_sum",
    Register.DISCARD: "discard",
}

USAGE_SUFFIXES = {ComponentUsage.RGB: ".rgb", ComponentUsage.ALPHA: ".a", ComponentUsage.BLUE: ".b"}

# (sign, function) of each mapping in a general combiner.
MAPPING_WORDS = {
    Mapping.UNSIGNED_IDENTITY: ("", "unsigned"),
    Mapping.UNSIGNED_INVERT: ("", "unsigned_invert"),
    Mapping.EXPAND_NORMAL: ("", "expand"),
    Mapping.EXPAND_NEGATE: ("-", "expand"),
    Mapping.HALF_BIAS_NORMAL: ("", "half_bias"),
    Mapping.HALF_BIAS_NEGATE: ("-", "half_bias"),
    Mapping.SIGNED_IDENTITY: ("", ""),
    Mapping.SIGNED_NEGATE: ("-", ""),
}

SCALES = {
    "bias_by_negative_one_half_scale_by_two": (
        CombinerScale.SCALE_BY_TWO,
        CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF,
    ),
    "bias_by_negative_one_half": (CombinerScale.NONE, CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF),
    "scale_by_one_half": (CombinerScale.SCALE_BY_ONE_HALF, CombinerBias.NONE),
    "scale_by_two": (CombinerScale.SCALE_BY_TWO, CombinerBias.NONE),
    "scale_by_four": (CombinerScale.SCALE_BY_FOUR, CombinerBias.NONE),
}
SCALE_WORDS = {scale: word for word, scale in SCALES.items()}

ZERO_INPUTS = {usage: CombinerInput(Register.ZERO, usage=usage) for usage in ComponentUsage}
ONE_INPUTS = {usage: CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT, usage) for usage in ComponentUsage}
# The mapping of ZERO that replaces a mapping of ``one``.  Source: nvparse's rc1.0_register.h.
MAPPINGS_OF_ONE = {
    Mapping.UNSIGNED_IDENTITY: Mapping.UNSIGNED_INVERT,
    Mapping.UNSIGNED_INVERT: Mapping.UNSIGNED_IDENTITY,
    Mapping.EXPAND_NORMAL: Mapping.UNSIGNED_INVERT,
    Mapping.EXPAND_NEGATE: Mapping.EXPAND_NORMAL,
    Mapping.HALF_BIAS_NORMAL: Mapping.HALF_BIAS_NEGATE,
    Mapping.HALF_BIAS_NEGATE: Mapping.HALF_BIAS_NORMAL,
    Mapping.SIGNED_IDENTITY: Mapping.UNSIGNED_INVERT,
    Mapping.SIGNED_NEGATE: Mapping.EXPAND_NORMAL,
}

BLACK = (0.0, 0.0, 0.0, 0.0)


def constant_byte(component):
    """A constant's component, 1.0 = full intensity, as a combiner of eight bits holds it.

    Source: OpenGL 1.2.1 section 2.13.9.
    """
    return int(255 * min(max(component, 0.0), 1.0) + 0.5)


def _unused(kind, usage):
    zero = ZERO_INPUTS[usage]
    return kind(a=zero, b=zero, c=zero, d=zero, sum_output=Register.DISCARD)


UNUSED_RGB = _unused(RGBPortion, ComponentUsage.RGB)
UNUSED_ALPHA = _unused(AlphaPortion, ComponentUsage.ALPHA)
UNUSED_STAGE = GeneralCombiner(rgb=UNUSED_RGB, alpha=UNUSED_ALPHA)


def format_input(given, usage, plain):
    """A combiner variable as text; ``usage`` is its portion's, ``plain`` is the mapping without a word."""
    suffix = "" if given.usage is usage else USAGE_SUFFIXES[given.usage]
    name = REGISTER_NAMES[given.register] + suffix
    if given.mapping is plain:
        return name
    sign, function = MAPPING_WORDS[given.mapping]
    return f"{sign}{function}({name})" if function else sign + name
