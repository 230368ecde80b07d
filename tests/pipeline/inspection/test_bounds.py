"""Bounds of combiner programs: no input leaves them, and where all inputs are tried they are reached."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fixedpipe.pipeline.columns.combiners import Registers, arithmetic_of, combine, filled
from fixedpipe.pipeline.enums import CombinerBias, CombinerScale, Mapping, MuxSelect, Register
from fixedpipe.pipeline.inspection.bounds import combiner_bounds
from fixedpipe.pipeline.profiles import FUTURE, GEFORCE_256, NV2A
from fixedpipe.pipeline.state import (
    AlphaPortion,
    CombinerInput,
    CombinerLookup,
    FinalCombiner,
    GeneralCombiner,
    RegisterCombiners,
    RGBPortion,
)
from tests.support.combiner_strategies import register_combiners

BROUGHT = (
    Register.PRIMARY_COLOR,
    Register.SECONDARY_COLOR,
    Register.FOG,
    Register.TEXTURE0,
    Register.TEXTURE1,
    Register.TEXTURE2,
    Register.TEXTURE3,
)


def run(program, profile, codes):
    """{(stage, register): int64 [4, k]} of what fragments with these codes hold after every stage."""
    a, held = arithmetic_of(profile, 8), {}
    count = next(iter(codes.values())).shape[1]
    registers = Registers([None] * 4, None, 8)
    registers |= {register: np.array(codes[register], np.int64) for register in BROUGHT}
    registers[Register.SPARE1] = filled((0, 0, 0, 0), count)
    registers[Register.SPARE0] = np.concatenate(
        [np.zeros((3, count), np.int64), codes[Register.TEXTURE0][3:]]
    )

    def observe(what, **told):
        if what == "combined":
            held[f"general combiner {told['number']}"] = dict(told["registers"])

    color = combine(program, registers, count, a, observe)
    return held, color


def assert_within(program, profile, codes, ranges=None):
    bounds = combiner_bounds(program, profile, ranges)
    held, color = run(program, profile, codes)
    a = arithmetic_of(profile, 8)
    for bound in bounds:
        name, component = bound.register.rsplit(".", 1)
        at = "rgba".index(component)
        if bound.stage == "final combiner":
            values = color[at]
        else:
            (register,) = [r for r in held[bound.stage] if r.name.lower() == LONG.get(name, name)]
            values = held[bound.stage][register][at]
        assert bound.least * 255 <= values.min() and values.max() <= bound.greatest * 255, bound
        low, high = (0, 1) if bound.stage == "final combiner" else (a.low / a.one, a.high / a.one)
        assert bound.least == min(max(bound.below, low), high)
        assert bound.greatest == min(max(bound.above, low), high)
    return {(bound.stage, bound.register): bound for bound in bounds}, held, color


LONG = {
    "col0": "primary_color",
    "col1": "secondary_color",
    **{f"tex{k}": f"texture{k}" for k in range(4)},
}


@given(register_combiners(4, 4, per_stage_constants=True, flags=True), st.integers(0, 2**32 - 1))
@settings(max_examples=300)
def test_no_fragment_leaves_the_bounds(program, seed):
    random = np.random.default_rng(seed)
    codes = {
        register: random.choice([random.integers(0, 256, (4, 64)), random.choice([0, 255], (4, 64))])
        for register in BROUGHT
    }
    assert_within(program, NV2A, codes)


PRIMARY, SECONDARY = CombinerInput(Register.PRIMARY_COLOR), CombinerInput(Register.SECONDARY_COLOR)
FINAL = FinalCombiner(a=CombinerInput(Register.ZERO), d=CombinerInput(Register.SPARE0))


def every_pair():
    """All codes of the primary colour's beside all of the secondary's."""
    one, other = np.meshgrid(np.arange(256), np.arange(256))
    codes = {register: np.zeros((4, one.size), np.int64) for register in BROUGHT}
    codes[Register.PRIMARY_COLOR][:], codes[Register.SECONDARY_COLOR][:] = one.ravel(), other.ravel()
    return codes


@pytest.mark.parametrize("scale", CombinerScale)
@pytest.mark.parametrize("bias", CombinerBias)
@pytest.mark.parametrize("mapping", Mapping)
@pytest.mark.parametrize("square", [False, True])
def test_one_product_reaches_its_bounds(scale, bias, mapping, square):
    """All inputs are tried, so bounds are what is reached, and a clamp bites where one is told."""
    if bias and scale in (CombinerScale.SCALE_BY_FOUR, CombinerScale.SCALE_BY_ONE_HALF):
        pytest.skip("no machine has this bias with this scale")
    mapped = replace(PRIMARY, mapping=mapping)
    other = mapped if square else replace(SECONDARY, mapping=Mapping.EXPAND_NORMAL)
    portion = RGBPortion(
        a=mapped, b=other, ab_output=Register.SPARE0, sum_output=Register.DISCARD, scale=scale, bias=bias
    )
    program = RegisterCombiners(general=(GeneralCombiner(rgb=portion),), final=FINAL)
    bounds, held, _ = assert_within(program, GEFORCE_256, every_pair())
    bound = bounds["general combiner 0", "spare0.r"]
    values = held["general combiner 0"][Register.SPARE0][0]
    assert (round(255 * bound.least), round(255 * bound.greatest)) == (values.min(), values.max())
    if bound.clamps:
        assert values.min() == -256 or values.max() == 255


def test_a_dot_product_of_unit_vectors_may_be_clamped_and_a_modulation_is_not():
    expanded = replace(PRIMARY, mapping=Mapping.EXPAND_NORMAL)
    dot = RGBPortion(
        a=expanded,
        b=replace(SECONDARY, mapping=Mapping.EXPAND_NORMAL),
        ab_output=Register.SPARE0,
        ab_dot_product=True,
        sum_output=Register.DISCARD,
    )
    product = RGBPortion(a=PRIMARY, b=SECONDARY, ab_output=Register.SPARE1, sum_output=Register.DISCARD)
    program = RegisterCombiners(general=(GeneralCombiner(rgb=dot), GeneralCombiner(rgb=product)), final=FINAL)
    bounds = {b.register: b for b in combiner_bounds(program, GEFORCE_256)}
    assert bounds["spare0.r"].clamps and bounds["spare0.r"].above > 2.9
    assert not bounds["spare1.r"].clamps
    assert (bounds["spare1.r"].least, bounds["spare1.r"].greatest) == (0.0, 1.0)


def test_ranges_narrow_what_follows():
    twice = RGBPortion(
        a=PRIMARY, ab_output=Register.SPARE0, sum_output=Register.DISCARD, scale=CombinerScale.SCALE_BY_TWO
    )
    program = RegisterCombiners(general=(GeneralCombiner(rgb=twice),), final=FINAL)
    (wide, *_), (narrow, *_) = (
        combiner_bounds(program, GEFORCE_256, ranges)
        for ranges in (None, {Register.PRIMARY_COLOR: (0.2, 0.4)})
    )
    assert wide.clamps and not narrow.clamps
    assert (narrow.least, narrow.greatest) == (2 * 51 / 255, 2 * 102 / 255)


@pytest.mark.parametrize("select", MuxSelect)
def test_a_mux_whose_alpha_is_known_takes_one(select):
    mux = RGBPortion(
        a=CombinerInput(Register.CONSTANT_COLOR0),
        b=replace(PRIMARY, register=Register.ZERO, mapping=Mapping.UNSIGNED_INVERT),
        c=CombinerInput(Register.CONSTANT_COLOR1),
        d=replace(PRIMARY, register=Register.ZERO, mapping=Mapping.UNSIGNED_INVERT),
        mux_sum=True,
    )
    program = RegisterCombiners(
        general=(GeneralCombiner(rgb=mux),),
        final=FINAL,
        constant_color0=(0.2,) * 4,
        constant_color1=(0.6,) * 4,
        mux_select=select,
    )
    for alpha, least, greatest in (((0.0, 0.0), 51, 51), ((1.0, 1.0), 153, 153), ((0.0, 1.0), 51, 153)):
        (bound, *_) = combiner_bounds(program, NV2A, {Register.TEXTURE0: alpha})
        assert (round(255 * bound.least), round(255 * bound.greatest)) == (least, greatest)


@pytest.mark.parametrize(
    ("program", "ranges", "sentence"),
    [
        (RegisterCombiners(), {Register.TEXTURE0: (0.5, 0.2)}, "TEXTURE0 is 0.5 to 0.2; give two numbers"),
        (RegisterCombiners(), {Register.TEXTURE0: (0.0, float("nan"))}, "TEXTURE0 is 0.0 to nan"),
        (RegisterCombiners(), {Register.SPARE0: (0.0, 1.0)}, "SPARE0 gets no value before the combiners"),
        (
            RegisterCombiners(general=(GeneralCombiner(lookup=CombinerLookup(0)),)),
            None,
            "general combiner 0 has a function or a lookup",
        ),
    ],
)
def test_what_has_no_bounds_is_said(program, ranges, sentence):
    with pytest.raises(ValueError, match=sentence):
        combiner_bounds(program, FUTURE, ranges)


def test_an_alpha_portion_and_blue_to_alpha_are_bounded():
    alpha = AlphaPortion(sum_output=Register.SPARE1)
    rgb = RGBPortion(a=PRIMARY, ab_output=Register.SPARE1, sum_output=Register.DISCARD, ab_blue_to_alpha=True)
    program = RegisterCombiners(general=(GeneralCombiner(rgb=rgb, alpha=alpha),), final=FINAL)
    assert_within(program, NV2A, every_pair())
