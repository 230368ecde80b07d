"""The column engine in real numbers is the ideal to the last bit: combiners, functions and blending."""

import random
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fixedpipe.pipeline.columns import combiners as columns
from fixedpipe.pipeline.enums import (
    BlendFactor,
    CombinerFunction,
    Meaning,
    MuxSelect,
    Register,
)
from fixedpipe.pipeline.ideal import per_fragment as ideal
from fixedpipe.pipeline.ideal.buffers import IdealBuffers
from fixedpipe.pipeline.ideal.combine import combine, plan_of
from fixedpipe.pipeline.state import (
    AlphaPortion,
    Blending,
    ColorMask,
    GeneralCombiner,
    PassState,
    RegisterCombiners,
    RGBPortion,
)
from fixedpipe.raster.columns import per_fragment
from fixedpipe.raster.columns.combine import EXACT
from fixedpipe.raster.columns.numbers import REALS
from tests.pipeline.ideal.test_evaluate import WRITABLE, random_final, random_portion

FRAGMENTS = 17


def random_program(rng):
    def portion(kind):
        made = random_portion(rng, kind)
        if rng.random() < 0.3:
            function = rng.choice(list(CombinerFunction))
            made = replace(made, function=function, mux_sum=made.mux_sum and not function)
        meanings = {v: rng.choice(list(Meaning)) for v in "abcd"}
        return replace(made, **{v: replace(getattr(made, v), meaning=m) for v, m in meanings.items()})

    return RegisterCombiners(
        general=tuple(
            GeneralCombiner(portion(RGBPortion), portion(AlphaPortion)) for _ in range(rng.randint(1, 3))
        ),
        final=random_final(rng),
        constant_color0=tuple(rng.random() for _ in range(4)),
        constant_color1=tuple(rng.random() for _ in range(4)),
        color_sum_clamp=rng.random() < 0.5,
        mux_select=rng.choice(list(MuxSelect)),
    )


@given(st.integers(0, 2**32 - 1))
def test_combiners_in_reals_are_the_ideal_s(seed):
    rng, program = random.Random(seed), random_program(random.Random(seed))
    given = {
        r: np.array([[rng.uniform(-1.5, 1.5) for _ in range(4)] for _ in range(FRAGMENTS)])
        for r in [*WRITABLE, Register.FOG]
    }
    with np.errstate(all="ignore"):  # an exponential's product may leave float64
        meant = combine(plan_of(program), given)
        registers = {r: np.ascontiguousarray(v.T) for r, v in given.items()}
        found = columns.combine(program, registers, FRAGMENTS, EXACT).T
    assert found.dtype == np.float64
    np.testing.assert_array_equal(found, meant)


@pytest.mark.parametrize("equation", sorted(ideal.EQUATIONS))
def test_blending_in_reals_is_the_ideal_s(equation):
    rng = np.random.default_rng(int(equation))
    for source, destination in product(BlendFactor, BlendFactor):
        s, d = rng.uniform(-0.3, 1.6, (2, FRAGMENTS, 4))
        color = tuple(rng.random(4).tolist())
        blending = Blending(source, destination, equation=equation, color=color)
        buffers = IdealBuffers(FRAGMENTS, 1)
        buffers.color[0] = d
        state = PassState(blending=blending, color_mask=ColorMask(True, True, True, True))
        ideal.write(state, buffers, np.arange(FRAGMENTS), s, np.zeros(FRAGMENTS))
        found = per_fragment.blend(equation, (source, destination), s, d, np.array(color), 1, REALS)
        np.testing.assert_array_equal(found, buffers.color[0])
