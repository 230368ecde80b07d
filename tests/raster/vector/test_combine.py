"""The planned combiners on explicit vectors equal the portable kernels and the specification."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bench.scenes import BUMP, MODULATE
from fixedpipe.pipeline.enums import (
    CombinerBias,
    CombinerScale,
    ComponentUsage,
    Mapping,
    MuxSelect,
    ProductRounding,
    Register,
)
from fixedpipe.pipeline.native.combiner_plan import plan_combiners
from fixedpipe.pipeline.profiles import GEFORCE_256
from fixedpipe.pipeline.state import (
    AlphaPortion,
    CombinerInput,
    FinalCombiner,
    GeneralCombiner,
    RegisterCombiners,
    RGBPortion,
)
from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.portable.combine import copy_plane, fill_plane, final_combiner, general_combiner
from fixedpipe.raster.portable.per_fragment import pack_colors
from fixedpipe.raster.vector import combine as V
from tests.raster.test_kernels_match_reference import MACHINES, SCALES_AND_BIASES, packed_combiners
from tests.reference import combine as reference
from tests.support.combiner_strategies import register_combiners

SLACK = 32
SIGNED_UNIT, BYTES_UNIT, DISABLED = 2, 1, 0


def interpolated(seed, count, kinds):
    """Planes as the combiners get them: bytes, the fog factor, texels; rubbish elsewhere."""
    random = np.random.default_rng(seed)

    def numbers(low, shape):
        corners = random.choice([max(low, -256), max(low, -255), 0, 1, 127, 128, 254, 255], shape)
        return np.where(random.random(shape) < 0.4, corners, random.integers(low, 256, shape))

    planes = random.integers(-(2**15), 2**15, (V.PLANES, count + SLACK)).astype(np.int16)
    for register in (C.REGISTER_FOG, C.REGISTER_PRIMARY_COLOR, C.REGISTER_SECONDARY_COLOR):
        planes[register * 4 : register * 4 + 4] = numbers(0, (4, count + SLACK))
    for unit, kind in enumerate(kinds):
        at = (C.REGISTER_TEXTURE0 + unit) * 4
        if kind:
            planes[at : at + 4] = numbers(-256 if kind == SIGNED_UNIT else 0, (4, count + SLACK))
    return planes


def unit_rows(kinds):
    units = np.zeros((4, R.UNIT_SIZE), np.int64)
    for row, kind in zip(units, kinds, strict=True):
        row[R.ENABLED], row[R.SIGNED] = kind != DISABLED, 0x80808080 if kind == SIGNED_UNIT else 0
    return units


def portable_colors(planes, packed, kinds, count):
    """What the end of ``shade`` and ``pack_colors`` of the portable engine make of the same planes."""
    draw = packed.draw
    registers = np.zeros((R.REGISTERS * 4, count), np.int16)
    for register in (C.REGISTER_PRIMARY_COLOR, C.REGISTER_SECONDARY_COLOR):
        registers[register * 4 : register * 4 + 4] = planes[register * 4 : register * 4 + 4, :count]
    registers[C.REGISTER_FOG * 4 : C.REGISTER_FOG * 4 + 3] = draw[R.FOG_RED : R.FOG_BLUE + 1, None]
    registers[C.REGISTER_FOG * 4 + 3] = planes[C.REGISTER_FOG * 4 + 3, :count] if draw[R.FOG_ENABLED] else 255
    for unit, kind in enumerate(kinds):
        at = (C.REGISTER_TEXTURE0 + unit) * 4
        registers[at : at + 4] = planes[at : at + 4, :count] if kind else [[0], [0], [0], [255]]
    results, out = np.empty((12, count), np.int16), np.empty(count, np.uint32)
    if draw[R.DIRECT]:
        results[:4] = registers[C.REGISTER_PRIMARY_COLOR * 4 : C.REGISTER_PRIMARY_COLOR * 4 + 4]
    else:
        copy_plane(registers, C.REGISTER_TEXTURE0 * 4 + 3, registers, C.REGISTER_SPARE0 * 4 + 3, count)
        products, total = np.empty((8, count), np.int32), np.empty((1, count), np.int32)
        for stage in range(draw[R.STAGES] + 1):
            for c in range(8):
                fill_plane(
                    registers, C.REGISTER_CONSTANT_COLOR0 * 4 + c, count, int(packed.constants[stage, c])
                )
            if stage < draw[R.STAGES]:
                general_combiner(
                    registers, packed.program[stage], count, packed.arithmetic, products, total, results, 8
                )
        uses = draw[R.USES_E_TIMES_F], draw[R.USES_SPARE0_PLUS_SECONDARY]
        final_combiner(registers, packed.final, count, *uses, draw[R.COLOR_SUM], results, 8)
    pack_colors(results, count, out)
    return out


def vector_colors(planes, packed, kinds, count):
    plan = plan_combiners(packed.draw, packed.program, packed.final, packed.arithmetic, unit_rows(kinds))
    rows = plan.filled(packed.constants, packed.draw)
    out = np.zeros(count + SLACK, np.uint32)
    scratch = np.random.default_rng(1).integers(-(2**31), 2**31, (V.SCRATCH_PLANES, count + SLACK), np.int32)
    before = planes.copy()
    V.combine(planes, rows, count, scratch, out)
    inputs = [
        *range(C.REGISTER_FOG * 4 + 3, C.REGISTER_SPARE0 * 4),
        *range(C.REGISTER_TEXTURE0 * 4, C.REGISTER_E_TIMES_F * 4),
    ]
    assert (planes[inputs] == before[inputs]).all(), "an operation wrote to a plane that is an input"
    assert plan.planes <= set(inputs)
    return out[:count]


def assert_equal(combiners, profile=GEFORCE_256, kinds=(SIGNED_UNIT,) * 4, seed=0, count=70, fog=False):
    packed = packed_combiners(combiners, profile)
    packed.draw[R.FOG_ENABLED] = fog
    packed.draw[R.FOG_RED : R.FOG_BLUE + 1] = (3, 128, 254) if fog else 0
    planes = interpolated(seed, count, kinds)
    expected = portable_colors(planes, packed, kinds, count)
    got = vector_colors(planes, packed, kinds, count)
    assert [hex(c) for c in got] == [hex(c) for c in expected]


OTHERS = (  # than programs: machines, kinds of units, seeds and whether there is fog
    st.sampled_from(MACHINES),
    st.tuples(*[st.sampled_from((DISABLED, BYTES_UNIT, SIGNED_UNIT))] * 4),
    st.integers(0, 2**32 - 1),
    st.booleans(),
)


def programs(stages):
    return register_combiners(stages, units=4, per_stage_constants=True, flags=True)


@settings(max_examples=400)
@given(programs(4), *OTHERS)
def test_random_programs(combiners, profile, kinds, seed, fog):
    assert_equal(combiners, profile, kinds, seed, fog=fog)


@pytest.mark.slow
@settings(max_examples=5000)
@given(programs(8), *OTHERS)
def test_many_random_programs(combiners, profile, kinds, seed, fog):
    assert_equal(combiners, profile, kinds, seed, fog=fog)


@pytest.mark.parametrize("count", [1, 31, 32, 33, 64, 2048])
@pytest.mark.parametrize("combiners", [MODULATE, BUMP, None])
def test_programs_of_real_scenes_in_batches_of_any_size(combiners, count):
    assert_equal(combiners, kinds=(BYTES_UNIT,) * 4, count=count)


def read(register, mapping=Mapping.UNSIGNED_IDENTITY, usage=ComponentUsage.RGB):
    return CombinerInput(register, mapping, usage)


NOTHING = dict.fromkeys("abc", CombinerInput())
SPARE0 = FinalCombiner(
    **NOTHING, d=read(Register.SPARE0), g=read(Register.SPARE0, usage=ComponentUsage.ALPHA)
)
_OUT = {"ab_output": Register.SPARE0, "sum_output": Register.DISCARD}


def every_pair(portion):
    """The red byte of a general combiner's RGB portion, over every pair of bytes of TEXTURE0 and TEXTURE1."""
    packed = packed_combiners(RegisterCombiners((GeneralCombiner(rgb=portion),), SPARE0), GEFORCE_256)
    count = 256 * 256
    planes = interpolated(0, count, (BYTES_UNIT,) * 4)
    planes[C.REGISTER_TEXTURE0 * 4 : C.REGISTER_TEXTURE0 * 4 + 3, :count] = np.repeat(np.arange(256), 256)
    planes[C.REGISTER_TEXTURE0 * 4 + 4 : C.REGISTER_TEXTURE0 * 4 + 7, :count] = np.tile(np.arange(256), 256)
    return vector_colors(planes, packed, (BYTES_UNIT,) * 4, count) & 0xFF


def test_every_product_of_two_bytes_is_the_specifications():
    portion = RGBPortion(read(Register.TEXTURE0), read(Register.TEXTURE1), **_OUT)
    machine = reference.machine_of(GEFORCE_256)
    expected = [
        reference.combiner_output([a * b], CombinerScale.NONE, CombinerBias.NONE, machine)
        for a in range(256)
        for b in range(256)
    ]
    assert every_pair(portion).tolist() == expected


@pytest.mark.parametrize(("scale", "bias"), SCALES_AND_BIASES)
def test_every_sum_of_two_products_of_bytes_is_the_specifications(scale, bias):
    # A A + B B covers sums from zero to twice 255 * 255, odd and even, beyond sixteen bits.
    a, b = read(Register.TEXTURE0), read(Register.TEXTURE1)
    portion = RGBPortion(a, a, b, b, sum_output=Register.SPARE0, scale=scale, bias=bias)
    machine = reference.machine_of(GEFORCE_256)
    expected = [
        max(reference.combiner_output([a * a, b * b], scale, bias, machine), 0)
        for a in range(256)
        for b in range(256)
    ]
    assert every_pair(portion).tolist() == expected


@pytest.mark.parametrize("clamp", [False, True])
@pytest.mark.parametrize("mapping", [Mapping.UNSIGNED_IDENTITY, Mapping.UNSIGNED_INVERT])
@pytest.mark.parametrize("variable", ["b", "c", "d"])
def test_a_sum_of_colors_that_is_not_clamped_reaches_the_final_combiner_whole(variable, mapping, clamp):
    # Reads: the sum with every partner, also where it stands alone.
    sums = read(Register.SPARE0_PLUS_SECONDARY_COLOR, mapping)
    for a in (read(Register.FOG), read(Register.ZERO), read(Register.TEXTURE1)):
        for other in (CombinerInput(), read(Register.PRIMARY_COLOR)):
            inputs = {"a": a} | {v: other for v in "bcd"} | {variable: sums}
            keep = GeneralCombiner(
                RGBPortion(read(Register.TEXTURE0), read(Register.ZERO, Mapping.UNSIGNED_INVERT), **_OUT)
            )
            final = FinalCombiner(**inputs, g=read(Register.SPARE0, usage=ComponentUsage.ALPHA))
            program = RegisterCombiners((keep,), final, color_sum_clamp=clamp)
            assert_equal(program, kinds=(BYTES_UNIT,) * 4)
            assert_equal(replace(program, invert_spare0=True, invert_secondary_color=True))


@pytest.mark.parametrize("select", MuxSelect)
def test_selection_by_spare0s_alpha(select):
    # The first stage's alpha is texture 0's; later ones find what an alpha portion left.
    t0, t1 = read(Register.TEXTURE0, Mapping.SIGNED_IDENTITY), read(Register.TEXTURE1, Mapping.EXPAND_NORMAL)
    one = read(Register.ZERO, Mapping.UNSIGNED_INVERT)
    mux = RGBPortion(t0, t1, t1, one, sum_output=Register.SPARE0, mux_sum=True)
    alphas = [
        AlphaPortion(read(r, usage=ComponentUsage.ALPHA), one, **_OUT)
        for r in (Register.TEXTURE1, Register.CONSTANT_COLOR0, Register.ZERO)
    ]
    for alpha in alphas:
        for color in ((0, 0, 0, 0.5), (0, 0, 0, 1)):
            stages = (GeneralCombiner(mux, alpha), GeneralCombiner(mux, alpha))
            program = RegisterCombiners(stages, SPARE0, constant_color0=color, mux_select=select)
            assert_equal(program)


def test_one_portion_does_not_see_what_the_other_writes():
    # Red and green read blue, the alpha portion reads blue, RGB reads alpha: all of one register, in place.
    spare, one = Register.SPARE0, read(Register.ZERO, Mapping.UNSIGNED_INVERT)
    load = GeneralCombiner(
        RGBPortion(read(Register.TEXTURE0), read(Register.TEXTURE1), **_OUT),
        AlphaPortion(read(Register.PRIMARY_COLOR, usage=ComponentUsage.BLUE), one, **_OUT),
    )
    turn = GeneralCombiner(
        RGBPortion(read(spare), read(spare, Mapping.UNSIGNED_INVERT, ComponentUsage.ALPHA), **_OUT),
        AlphaPortion(read(spare, Mapping.UNSIGNED_INVERT, ComponentUsage.BLUE), one, **_OUT),
    )
    assert_equal(RegisterCombiners((load, turn, turn), SPARE0))


@pytest.mark.parametrize("machine", MACHINES)
def test_dot_products_on_every_machine(machine):
    t0, t1 = (read(Register.TEXTURE0 + k, Mapping.EXPAND_NORMAL) for k in range(2))
    for scale, bias in SCALES_AND_BIASES:
        portion = RGBPortion(t0, t1, t1, t0, **_OUT, ab_dot_product=True, scale=scale, bias=bias)
        assert_equal(RegisterCombiners((GeneralCombiner(rgb=portion),), SPARE0), machine)
        both = replace(portion, ab_output=Register.DISCARD, sum_output=Register.SPARE0)
        assert_equal(RegisterCombiners((GeneralCombiner(rgb=both),), SPARE0), machine)


def operations(combiners):
    packed = packed_combiners(combiners, GEFORCE_256.changed(product_rounding=ProductRounding.JOINT))
    plan = plan_combiners(
        packed.draw,
        packed.program,
        packed.final,
        packed.arithmetic,
        unit_rows((BYTES_UNIT,) * 4),
    )
    return plan.rows[:, V.OPERATION].tolist(), plan.planes


def test_a_plan_computes_what_is_read_once_and_moves_nothing():
    # A bump map: one dot product for three channels, an alpha that only moves, four products.
    assert operations(BUMP)[0] == [C.PLAN_DOT_PRODUCT, *[C.PLAN_MODULATE] * 4, C.PLAN_PACK]
    assert operations(MODULATE)[0] == [*[C.PLAN_MODULATE] * 4, C.PLAN_PACK]
    assert operations(None)[0] == [C.PLAN_PACK]


def test_a_plan_names_the_planes_that_its_result_depends_on():
    alpha = read(Register.TEXTURE0, usage=ComponentUsage.ALPHA)
    final = FinalCombiner(**NOTHING, d=read(Register.TEXTURE1), g=alpha)
    _, planes = operations(RegisterCombiners((GeneralCombiner(),), final))
    assert planes == {
        C.REGISTER_TEXTURE0 * 4 + 3,
        *range(C.REGISTER_TEXTURE0 * 4 + 4, C.REGISTER_TEXTURE0 * 4 + 7),
    }


def test_programs_that_differ_in_constants_share_a_plan_but_not_its_constants():
    one = read(Register.ZERO, Mapping.UNSIGNED_INVERT)
    stage = GeneralCombiner(RGBPortion(read(Register.CONSTANT_COLOR0, Mapping.EXPAND_NEGATE), one, **_OUT))
    for color in ((0, 0.25, 1, 1), (0.5, 0, 0.1, 1), (1, 1, 1, 1)):
        assert_equal(RegisterCombiners((stage,), SPARE0, constant_color0=color))
