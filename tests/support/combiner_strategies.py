"""Hypothesis strategies of register combiners that NV_register_combiners allows."""

from dataclasses import replace

from hypothesis import strategies as st

from fixedpipe.pipeline.enums import ComponentUsage, Mapping, MuxSelect, Register
from fixedpipe.pipeline.state import (
    AlphaPortion,
    CombinerInput,
    FinalCombiner,
    GeneralCombiner,
    RegisterCombiners,
    RGBPortion,
)
from tests.support.combiner_words import READ_ONLY, SCALES_AND_BIASES, TEXTURE_REGISTERS, WRITABLE

# Constants: the bytes' own values, their neighbourhoods, and any other number in [0, 1].
_components = st.one_of(st.integers(0, 255).map(lambda n: n / 255.0), st.floats(0.0, 1.0))
colors = st.tuples(_components, _components, _components, _components)


def _writable(units):
    return WRITABLE + TEXTURE_REGISTERS[:units]


@st.composite
def _general_inputs(draw, units, usages):
    register = draw(st.sampled_from(READ_ONLY + _writable(units)))
    # The fog factor is available in the final combiner only.
    allowed = [u for u in usages if (register, u) != (Register.FOG, ComponentUsage.ALPHA)]
    return CombinerInput(register, draw(st.sampled_from(Mapping)), draw(st.sampled_from(allowed)))


@st.composite
def _portions(draw, kind, units, flags=False):
    usages = (ComponentUsage.RGB if kind is RGBPortion else ComponentUsage.BLUE, ComponentUsage.ALPHA)
    inputs = _general_inputs(units, usages)
    outputs = draw(st.permutations(_writable(units)))[:3]
    kept = draw(st.tuples(st.booleans(), st.booleans(), st.booleans()))
    ab, cd, total = (o if k else Register.DISCARD for o, k in zip(outputs, kept, strict=True))
    scale, bias = draw(st.sampled_from(SCALES_AND_BIASES))
    dots = {}
    if kind is RGBPortion:
        dots = {"ab_dot_product": draw(st.booleans()), "cd_dot_product": draw(st.booleans())}
        if flags:
            dots |= {"ab_blue_to_alpha": draw(st.booleans()), "cd_blue_to_alpha": draw(st.booleans())}
    return kind(
        a=draw(inputs),
        b=draw(inputs),
        c=draw(inputs),
        d=draw(inputs),
        ab_output=ab,
        cd_output=cd,
        sum_output=total,
        scale=scale,
        bias=bias,
        mux_sum=draw(st.booleans()),
        **dots,
    )


def _without_two_alphas(stage):
    """The stage without a blue to alpha that its alpha portion would write as well."""
    written = {stage.alpha.ab_output, stage.alpha.cd_output, stage.alpha.sum_output}
    rgb = replace(
        stage.rgb,
        ab_blue_to_alpha=stage.rgb.ab_blue_to_alpha and stage.rgb.ab_output not in written,
        cd_blue_to_alpha=stage.rgb.cd_blue_to_alpha and stage.rgb.cd_output not in written,
    )
    return replace(stage, rgb=rgb)


def general_combiners(units=2, per_stage_constants=False, flags=False):
    """General combiner stages that read and write the texture registers of ``units`` texture units; with
    ``flags`` also blue to alpha.
    """
    own = st.none() | colors if per_stage_constants else st.none()
    return st.builds(
        GeneralCombiner,
        rgb=_portions(RGBPortion, units, flags),
        alpha=_portions(AlphaPortion, units),
        constant_color0=own,
        constant_color1=own,
    ).map(_without_two_alphas)


@st.composite
def _final_inputs(draw, units, variable):
    registers = READ_ONLY + _writable(units)
    if variable in "abcd":
        registers += (Register.E_TIMES_F,)
    if variable in "bcd":
        registers += (Register.SPARE0_PLUS_SECONDARY_COLOR,)
    register = draw(st.sampled_from(registers))
    if variable == "g":
        usages = (ComponentUsage.ALPHA, ComponentUsage.BLUE)
    elif register in (Register.E_TIMES_F, Register.SPARE0_PLUS_SECONDARY_COLOR):
        usages = (ComponentUsage.RGB,)
    else:
        usages = (ComponentUsage.RGB, ComponentUsage.ALPHA)
    mapping = draw(st.sampled_from((Mapping.UNSIGNED_IDENTITY, Mapping.UNSIGNED_INVERT)))
    return CombinerInput(register, mapping, draw(st.sampled_from(usages)))


def final_combiners(units=2):
    """Final combiners; zeros and ones are frequent, as in real programs."""
    zero, one = CombinerInput(), CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT)
    plain = st.sampled_from((zero, zero, one))
    rgb = {v: plain | _final_inputs(units, v) for v in "abcdef"}
    return st.builds(FinalCombiner, **rgb, g=_final_inputs(units, "g"))


def register_combiners(max_stages=2, units=2, per_stage_constants=False, flags=False):
    """Whole register combiners of one to ``max_stages`` stages on a machine with ``units`` texture units;
    ``flags``: with the NV2A's own.
    """
    stage = general_combiners(units, per_stage_constants, flags)
    own = {}
    if flags:
        own = {
            "mux_select": st.sampled_from(MuxSelect),
            "invert_spare0": st.booleans(),
            "invert_secondary_color": st.booleans(),
        }
    return st.builds(
        RegisterCombiners,
        general=st.lists(stage, min_size=1, max_size=max_stages).map(tuple),
        final=final_combiners(units),
        constant_color0=colors,
        constant_color1=colors,
        color_sum_clamp=st.booleans(),
        **own,
    )
