"""Parts of register combiners, for techniques: inputs, portions that do nothing, constants."""

from fixedpipe.effects.passes.arguments import checked_rgb
from fixedpipe.pipeline.enums import ComponentUsage, Mapping, Register
from fixedpipe.pipeline.state import (
    AlphaPortion,
    CombinerInput,
    FinalCombiner,
    GeneralCombiner,
    RegisterCombiners,
    RGBPortion,
)

NO_RGB = RGBPortion(a=CombinerInput(), sum_output=Register.DISCARD)
NO_ALPHA = AlphaPortion(a=CombinerInput(usage=ComponentUsage.ALPHA), sum_output=Register.DISCARD)
ZERO = CombinerInput()
ONE = CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT)
OPAQUE = CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT, ComponentUsage.ALPHA)


def expand(register):
    """A register as a vector: EXPAND_NORMAL of its RGB."""
    return CombinerInput(register, Mapping.EXPAND_NORMAL)


def alpha_of(register):
    """A register's alpha, replicated where RGB is asked for."""
    return CombinerInput(register, usage=ComponentUsage.ALPHA)


def opaque(color):
    """RGB in [0, 1] as a combiner constant with alpha one."""
    return (*checked_rgb(color), 1.0)


def constant_product(factor, constant):
    """Combiners that give ``factor``, a final combiner's input, times RGB ``constant`` in [0, 1]."""
    final = FinalCombiner(a=factor, b=CombinerInput(Register.CONSTANT_COLOR0), c=ZERO, d=ZERO, g=OPAQUE)
    return RegisterCombiners(
        general=(GeneralCombiner(NO_RGB, NO_ALPHA),), final=final, constant_color0=opaque(constant)
    )
