"""Kernels equal the executable specification, exhaustively where the domain allows it.

Arithmetic is tested kernel by kernel; per-fragment operations through a whole machine, whose every fragment
is given its own operands by a texture and by the contents of the framebuffer.
"""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numba import int32, int64

from fixedpipe.pipeline.commands import Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import (
    BlendEquation,
    BlendFactor,
    CombinerBias,
    CombinerScale,
    ComparisonFunction,
    ComponentUsage,
    DepthFormat,
    FogCoordinateSource,
    FogGeneration,
    FogMode,
    LogicOperation,
    MagnificationThreshold,
    Mapping,
    MuxSelect,
    PrimitiveType,
    ProductRounding,
    Register,
    StencilOperation,
    TextureFilter,
    WrapMode,
)
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.framebuffers.framebuffer import Framebuffer, to_code
from fixedpipe.pipeline.native import pack
from fixedpipe.pipeline.profiles import GEFORCE_256, NV2A
from fixedpipe.pipeline.programs.fog import fog_thresholds
from fixedpipe.pipeline.state import (
    AlphaTest,
    Blending,
    CombinerInput,
    DepthClamp,
    DepthTest,
    FinalCombiner,
    Fog,
    FogRegisters,
    GeneralCombiner,
    PassState,
    RegisterCombiners,
    RGBPortion,
    Sampler,
    StencilTest,
    TextureUnit,
)
from fixedpipe.pipeline.textures.images import (
    COMPONENT_BITS,
    halve,
    store_texels,
    texture_1d,
    texture_2d,
    widen_to_byte,
)
from fixedpipe.pipeline.vertices.fog import folds, table, vertex_value
from fixedpipe.pipeline.vertices.primitives import WindowPrimitives
from fixedpipe.raster import rows
from fixedpipe.raster.arrays import Segments
from fixedpipe.raster.columns import interpolate as columns_interpolate
from fixedpipe.raster.fixed import divide, reciprocal_24, reciprocal_29, signed_reciprocal, truncate_24
from fixedpipe.raster.kernel import kernel
from fixedpipe.raster.portable.arrays import Edges
from fixedpipe.raster.portable.combine import final_combiner, general_combiner
from fixedpipe.raster.portable.interpolate import (
    Channel,
    color_weights,
    depth_words,
    emit_depth,
    emit_iteration_weights,
    emit_w,
    iterate_exact_color,
    weight_factors,
)
from fixedpipe.raster.portable.sample import POWERS_OF_TWO, log2_q7, major_axis, on_face
from fixedpipe.raster.portable.texels import lerp_lanes, lerp_packed
from tests.reference import combine, depth, fixed, fog, interpolate, per_fragment, sample, texel_formats
from tests.support.combiner_strategies import final_combiners, general_combiners
from tests.support.run_reference import run_reference
from tests.support.strategies import SHOW_TEXTURE, seeds

MACHINES = [
    GEFORCE_256.changed(
        max_general_combiners=8,
        per_stage_constants=True,
        expand_half=half,
        product_rounding=rounding,
        round_before_scale=before,
        clamp_low=low,
    )
    for half, rounding, before, low in (
        (128, ProductRounding.JOINT, True, -256),
        (127.5, ProductRounding.JOINT, False, -255),
        (128, ProductRounding.PER_PRODUCT, True, -255),
        (127.5, ProductRounding.PER_PRODUCT, False, -256),
    )
]
SIGNED = range(-256, 256)
BYTES = range(256)


# -------------------------------------------------------------------------------------------- number formats


def test_division_by_255_is_exact_for_every_sum_of_scaled_products():
    # Two dot products of 256 * 256 each, times four, is the largest numerator that a combiner meets.
    limit, eight = 4 * 6 * 256 * 256, np.int32(8)
    assert all(divide(n, eight) == fixed.divide(n) for n in range(-limit, limit + 1))


@kernel("i8(i8,i8,i4)")
def wrong_steps(first, last, bits):
    """How many of the quotients first..last begin elsewhere than at the least n that rounds to them."""
    one, wrong = (1 << bits) - 1, 0
    for quotient in range(first, last + 1):
        least = int64(quotient * one - (one >> 1))  # the least n with 2 n + one >= 2 one quotient
        wrong += divide(int32(least), bits) != quotient
        wrong += divide(int32(least - 1), bits) != quotient - 1
    return wrong


@pytest.mark.parametrize("bits", range(rows.BITS_OF_BYTES, rows.MOST_BITS + 1))
def test_division_is_exact_at_every_width(bits):
    # It grows with n, being made of sums and shifts to the right: right where each quotient begins and just
    # before, it is right between. The largest numerator is as above, of 2**bits * 2**bits.
    last = 4 * 6 * 4**bits // (2**bits - 1)
    assert wrong_steps(-last, last, np.int32(bits)) == 0


@settings(max_examples=300)
@given(st.floats(min_value=1e-300, max_value=1e300))
def test_mantissas_are_cut_alike(value):
    assert truncate_24(value) == fixed.keep_significant_bits(value, 24)
    power = math.ldexp(1.0, math.frexp(value)[1])
    assert reciprocal_29(value) == depth.reciprocal(value)
    single = truncate_24(value)
    assert reciprocal_24(single) == interpolate.reciprocal(single)
    assert reciprocal_29(power) == depth.reciprocal(power) == 1.0 / power


def test_colors_become_bytes_alike():
    steps = [k / 510.0 for k in range(-20, 540)]
    for c in [*steps, *(math.nextafter(s, 9.0) for s in steps), *(math.nextafter(s, -9.0) for s in steps)]:
        assert to_code(c) == fixed.color_code(c)


def lerp_bytes(p, q, weight):
    """The kernel's lerp on one byte in each of the four places of a packed texel."""
    places = [lerp_packed(np.uint32(p << s), np.uint32(q << s), weight) for s in (0, 8, 16, 24)]
    assert len({int(v) >> s for v, s in zip(places, (0, 8, 16, 24), strict=True)}) == 1
    return int(places[0])


def test_lerps_of_texels_are_alike():
    for p in range(0, 256, 15):
        for q in range(0, 256, 17):
            for f in (*range(0, 256, 5), 1, 127, 128, 254):
                assert lerp_bytes(p, q, f) == fixed.lerp(p, q, f)


def test_lerps_of_wide_texels_are_alike():
    random = np.random.default_rng(7)
    for p, q, r, s in random.integers(0, 1 << rows.MOST_BITS, (300, 4)).tolist():
        for f in (0, 1, 127, 128, 254, 255):
            found = int(lerp_lanes(np.uint32(p | r << 16), np.uint32(q | s << 16), f))
            assert (found & 0xFFFF, found >> 16) == (fixed.lerp(p, q, f), fixed.lerp(r, s, f))


@pytest.mark.slow
def test_every_lerp_of_two_bytes_is_alike():
    for p in BYTES:
        for q in BYTES:
            both = np.uint32(p * 0x01010101), np.uint32(q * 0x01010101)
            for f in BYTES:
                assert lerp_packed(*both, f) == fixed.lerp(p, q, f) * 0x01010101


# ------------------------------------------------------------------------------------------ general combiners


def empty_primitives(units=0):
    return WindowPrimitives(
        x=np.zeros(0, np.int32),
        y=np.zeros(0, np.int32),
        z=np.zeros(0),
        inverse_w=np.zeros(0),
        colors=np.zeros((0, 2, 8), np.uint8),
        coordinates=np.zeros((0, units, 4)),
        fog=np.zeros(0),
        triangles=np.zeros((0, 4), np.int32),
        dropped=0,
        two_side=False,
    )


def packed_combiners(combiners, profile):
    state = PassState(register_combiners=combiners)
    return pack.pack(state, profile, Framebuffer.new(1, 1), {}, empty_primitives())


class Registers:
    """Planes of registers as the kernels have them, and single fragments as the specification has them."""

    def __init__(self, count):
        self.count = count
        self.planes = np.zeros((14 * 4, count), np.int16)

    def plane(self, register, component):
        return self.planes[4 * register + component]

    def fragment(self, i):
        values = self.planes[:, i].tolist()
        return {register: values[4 * register : 4 * register + 4] for register in Register if register < 14}

    def run(self, stage, profile, mux_select=MuxSelect.MSB):
        """One general combiner, in place."""
        packed = packed_combiners(RegisterCombiners((stage,), mux_select=mux_select), profile)
        general_combiner(
            self.planes,
            packed.program[0],
            self.count,
            packed.arithmetic,
            np.empty((8, self.count), np.int32),
            np.empty((1, self.count), np.int32),
            np.empty((12, self.count), np.int16),
            8,
        )

    def run_final(self, combiners):
        """The final combiner: int16 [4, count]."""
        packed = packed_combiners(combiners, GEFORCE_256)
        out = np.empty((12, self.count), np.int16)
        used = {getattr(combiners.final, v).register for v in "abcd"}
        final_combiner(
            self.planes,
            packed.final,
            self.count,
            Register.E_TIMES_F in used,
            Register.SPARE0_PLUS_SECONDARY_COLOR in used,
            packed.draw[rows.COLOR_SUM],
            out,
            8,
        )
        return out[:4]


def identity(register, usage=ComponentUsage.RGB):
    return CombinerInput(register, Mapping.SIGNED_IDENTITY, usage)


PRODUCT = RGBPortion(
    a=identity(Register.TEXTURE0),
    b=identity(Register.TEXTURE1),
    ab_output=Register.SPARE1,
    sum_output=Register.DISCARD,
)
SCALES_AND_BIASES = [(s, CombinerBias.NONE) for s in CombinerScale] + [
    (s, CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF) for s in (CombinerScale.NONE, CombinerScale.SCALE_BY_TWO)
]


def products_of_all_pairs(portion, profile):
    """{(a, b): the red output} over all pairs of signed 9-bit values."""
    file = Registers(512 * 512)
    a, b = (grid.ravel() for grid in np.meshgrid(SIGNED, SIGNED, indexing="ij"))
    file.plane(Register.TEXTURE0, 0)[:], file.plane(Register.TEXTURE1, 0)[:] = a, b
    file.run(GeneralCombiner(rgb=portion), profile)
    return dict(
        zip(zip(a.tolist(), b.tolist(), strict=True), file.plane(Register.SPARE1, 0).tolist(), strict=True)
    )


def test_all_512_by_512_products():
    got, machine = products_of_all_pairs(PRODUCT, GEFORCE_256), combine.machine_of(GEFORCE_256)
    for (a, b), value in got.items():
        assert value == combine.combiner_output([a * b], CombinerScale.NONE, CombinerBias.NONE, machine)


@pytest.mark.slow
@pytest.mark.parametrize(("scale", "bias"), SCALES_AND_BIASES)
@pytest.mark.parametrize("profile", MACHINES)
def test_all_512_by_512_products_with_every_scale_and_bias(profile, scale, bias):
    got = products_of_all_pairs(replace(PRODUCT, scale=scale, bias=bias), profile)
    machine = combine.machine_of(profile)
    for (a, b), value in got.items():
        assert value == combine.combiner_output([a * b], scale, bias, machine)


@pytest.mark.parametrize("half", [128, 127.5])
@pytest.mark.parametrize("mapping", Mapping)
def test_every_mapping_over_its_whole_domain(mapping, half):
    profile = GEFORCE_256.changed(expand_half=half)
    file = Registers(512)
    file.planes[:] = SIGNED
    file.planes[4 * Register.ZERO : 4 * Register.ZERO + 4] = 0
    one = CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT)
    rgb = RGBPortion(a=CombinerInput(Register.TEXTURE0, mapping), b=one, sum_output=Register.SPARE1)
    file.run(GeneralCombiner(rgb=rgb), profile)
    expected = [combine.map_input(x, mapping, combine.machine_of(profile)) for x in SIGNED]
    for component in range(3):
        assert file.plane(Register.SPARE1, component).tolist() == expected


@pytest.mark.parametrize("profile", MACHINES[:2])
@pytest.mark.parametrize(("scale", "bias"), SCALES_AND_BIASES)
def test_every_numerator_of_a_sum_of_two_products(scale, bias, profile):
    # n = 255 (2 h) + r with A B = h 255 and C D = 255 h + r split over a dot product's three components.
    numerators = np.arange(-2 * 65536, 2 * 65025 + 1)
    h, rest = np.divmod(numerators, 510)
    file = Registers(len(numerators))
    for register, component, value in (
        (Register.TEXTURE0, 0, h),
        (Register.TEXTURE1, 0, 255),
        (Register.PRIMARY_COLOR, 0, h),
        (Register.SECONDARY_COLOR, 0, 255),
        (Register.PRIMARY_COLOR, 1, rest // 2),
        (Register.SECONDARY_COLOR, 1, 1),
        (Register.PRIMARY_COLOR, 2, rest - rest // 2),
        (Register.SECONDARY_COLOR, 2, 1),
    ):
        file.plane(register, component)[:] = value
    rgb = RGBPortion(
        a=identity(Register.TEXTURE0),
        b=identity(Register.TEXTURE1),
        c=identity(Register.PRIMARY_COLOR),
        d=identity(Register.SECONDARY_COLOR),
        sum_output=Register.SPARE1,
        cd_dot_product=True,
        scale=scale,
        bias=bias,
    )
    reachable = (h >= -256) & (h <= 255)
    assert reachable[np.abs(numerators) <= 2 * 65025].all()
    file.run(GeneralCombiner(rgb=rgb), profile)
    got, machine = file.plane(Register.SPARE1, 0), combine.machine_of(profile)
    for n, value in zip(numerators[reachable].tolist(), got[reachable].tolist(), strict=True):
        assert value == combine.combiner_output([n], scale, bias, machine)


def random_registers(seed, count):
    random = np.random.default_rng(seed)
    file = Registers(count)
    extreme = random.random(file.planes.shape) < 0.3
    corners = random.choice([-256, -255, -1, 0, 1, 127, 128, 255], file.planes.shape)
    file.planes[:] = np.where(extreme, corners, random.integers(-256, 256, file.planes.shape))
    file.planes[4 * Register.ZERO : 4 * Register.ZERO + 4] = 0
    return file


def assert_general_combiner_equals(stage, profile, seed):
    file = random_registers(seed, 24)
    before = [file.fragment(i) for i in range(file.count)]
    file.run(stage, profile)
    machine = combine.machine_of(profile)
    for i, registers in enumerate(before):
        after, got = combine.general_combiner(registers, stage, machine), file.fragment(i)
        assert {r: got[r] for r in after} == after


@settings(max_examples=150)
@given(general_combiners(4, flags=True), st.sampled_from(MACHINES), st.integers(0, 2**32 - 1))
def test_random_general_combiners_on_random_registers(stage, profile, seed):
    assert_general_combiner_equals(stage, profile, seed)


@pytest.mark.slow
@settings(max_examples=10000)
@given(general_combiners(4, flags=True), st.sampled_from(MACHINES), st.integers(0, 2**32 - 1))
def test_many_random_general_combiners_on_random_registers(stage, profile, seed):
    assert_general_combiner_equals(stage, profile, seed)


@pytest.mark.parametrize("select", MuxSelect)
@pytest.mark.parametrize("selector", [-256, -255, -1, 0, 1, 126, 127, 128, 129, 254, 255])
def test_the_mux_selects_alike(selector, select):
    file = random_registers(7, 16)
    file.plane(Register.SPARE0, 3)[:] = selector
    rgb = RGBPortion(
        c=identity(Register.TEXTURE0),
        d=CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT),
        sum_output=Register.SPARE1,
        mux_sum=True,
    )
    before = [file.fragment(i) for i in range(file.count)]
    file.run(GeneralCombiner(rgb=rgb), NV2A, select)
    for i, registers in enumerate(before):
        expected = combine.general_combiner(
            registers, GeneralCombiner(rgb=rgb), combine.machine_of(NV2A), select
        )
        assert file.fragment(i)[Register.SPARE1] == expected[Register.SPARE1]


# -------------------------------------------------------------------------------------------- final combiner


def assert_final_combiner_equals(final, flags, seed):
    clamped, *inverted = flags
    file = random_registers(seed, 24)
    before = [file.fragment(i) for i in range(file.count)]
    got = file.run_final(
        RegisterCombiners(
            final=final,
            color_sum_clamp=clamped,
            invert_spare0=inverted[0],
            invert_secondary_color=inverted[1],
        )
    )
    for i, registers in enumerate(before):
        assert got[:, i].tolist() == combine.final_combiner(registers, final, clamped, inverted)


three_flags = st.tuples(st.booleans(), st.booleans(), st.booleans())


@settings(max_examples=150)
@given(final_combiners(4), three_flags, st.integers(0, 2**32 - 1))
def test_random_final_combiners_on_random_registers(final, flags, seed):
    assert_final_combiner_equals(final, flags, seed)


@pytest.mark.slow
@settings(max_examples=10000)
@given(final_combiners(4), three_flags, st.integers(0, 2**32 - 1))
def test_many_random_final_combiners_on_random_registers(final, flags, seed):
    assert_final_combiner_equals(final, flags, seed)


def test_every_factor_blends_every_color_sum():
    # B = SPARE0 + SECONDARY, 0..510 without the clamp, times every A.
    factor, total = (grid.ravel() for grid in np.meshgrid(BYTES, range(511), indexing="ij"))
    file = Registers(len(factor))
    file.plane(Register.PRIMARY_COLOR, 0)[:] = factor
    file.plane(Register.SPARE0, 0)[:] = total - total // 2
    file.plane(Register.SECONDARY_COLOR, 0)[:] = total // 2
    final = FinalCombiner(
        a=CombinerInput(Register.PRIMARY_COLOR), c=CombinerInput(Register.PRIMARY_COLOR), d=CombinerInput()
    )
    got = file.run_final(RegisterCombiners(final=final, color_sum_clamp=False))[0]
    for a, b, value in zip(factor.tolist(), total.tolist(), got.tolist(), strict=True):
        assert value == fixed.clamp(fixed.divide(a * b + (255 - a) * a), 0, 255)


# ----------------------------------------------------------------------------------- per-fragment operations

SCREEN = Mesh(
    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]],
    PrimitiveType.QUADS,
    texture_coordinates=(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]),),
)
NEAREST = Sampler(TextureFilter.NEAREST, TextureFilter.NEAREST)


REPLACE = StencilTest(reference=1, depth_pass=StencilOperation.REPLACE)


def drawn_over(source, destination, depth_buffer=None, stencil=None, profile=GEFORCE_256, **state):
    """The framebuffer after ``source`` uint8 [h, w, 4] is drawn over ``destination``, pixel over pixel."""
    height, width = source.shape[:2]
    machine = Machine(profile, width, height, threads=1)
    machine.framebuffer.color[:] = destination
    if depth_buffer is not None:
        machine.framebuffer.depth[:] = depth_buffer
    if stencil is not None:
        machine.framebuffer.stencil[:] = stencil
    pass_state = PassState(
        texture_units=(TextureUnit("source", NEAREST),), register_combiners=SHOW_TEXTURE, **state
    )
    machine.run(
        (
            TexImage(label="source", texture="source", image=texture_2d(source[::-1])),
            Draw(label="source over destination", mesh=SCREEN, state=pass_state),
        )
    )
    return machine.framebuffer


def byte_pairs():
    """Two uint8 [256, 256] arrays: all pairs of bytes."""
    return np.meshgrid(np.arange(256, dtype=np.uint8), np.arange(256, dtype=np.uint8), indexing="ij")


def colors_of_all_pairs():
    """Source and destination whose red, alpha pairs, and mixed ones, run through all pairs of bytes."""
    s, d = byte_pairs()
    return np.stack([s, d, s, s], -1), np.stack([d, s, d ^ 0x55, d], -1)


CONSTANT = (0.2, 0.6, 1.0, 0.35)
FACTORS = [("source", f) for f in sorted(GEFORCE_256.fragments.blend_factors_source)] + [
    ("destination", f) for f in sorted(GEFORCE_256.fragments.blend_factors_destination)
]


@pytest.mark.parametrize(("side", "factor"), FACTORS)
def test_every_blend_factor_over_all_pairs_of_bytes(side, factor):
    source, destination = colors_of_all_pairs()
    factors = {"source": BlendFactor.ZERO, "destination": BlendFactor.ZERO, side: factor}
    got = drawn_over(source, destination, blending=Blending(**factors, color=CONSTANT)).color
    constant = fixed.color_codes(CONSTANT)
    value = 0 if side == "source" else 1
    for k in (0, 3):
        for s, d, result in zip(
            source.reshape(-1, 4).tolist(),
            destination.reshape(-1, 4).tolist(),
            got[..., k].ravel().tolist(),
            strict=True,
        ):
            weight = per_fragment.blend_factor(factor, k, s, d, constant)
            assert result == fixed.divide((s, d)[value][k] * weight)


@pytest.mark.slow
@pytest.mark.parametrize("equation", sorted(GEFORCE_256.fragments.blend_equations))
@pytest.mark.parametrize("source_factor", sorted(GEFORCE_256.fragments.blend_factors_source))
def test_every_pair_of_blend_factors(source_factor, equation):
    some, more = np.linspace(0, 255, 32).astype(int), np.linspace(0, 255, 64).astype(int)
    source, destination = (image[np.ix_(some, more)] for image in colors_of_all_pairs())
    for destination_factor in sorted(GEFORCE_256.fragments.blend_factors_destination):
        blending = Blending(source_factor, destination_factor, equation, CONSTANT)
        got = drawn_over(source, destination, blending=blending).color
        for s, d, result in zip(
            source.reshape(-1, 4).tolist(),
            destination.reshape(-1, 4).tolist(),
            got.reshape(-1, 4).tolist(),
            strict=True,
        ):
            assert result == per_fragment.blend(s, d, blending)


def operands_of_every_numerator(sign):
    """s, fs, d, fd (bytes) for every integer s fs + sign d fd that four bytes can give."""
    products = np.unique(np.outer(np.arange(256), np.arange(256)))
    observer = np.zeros((65026, 2), np.int64)
    for a in range(1, 256):
        b = np.arange(1, 256)
        observer[a * b] = np.stack([np.full(255, a), b], -1)
    offset = 0 if sign > 0 else 65025
    first = np.full(130051, -1)
    second = np.zeros(130051, np.int64)
    for p in products.tolist():
        n = p + sign * products + offset
        new = n[first[n] < 0]
        first[new], second[new] = p, sign * (new - offset - p)
    reachable = first >= 0
    return np.hstack([observer[first[reachable]], observer[second[reachable]]])


@pytest.mark.parametrize(
    "equation", [BlendEquation.FUNC_ADD, BlendEquation.FUNC_SUBTRACT, BlendEquation.FUNC_REVERSE_SUBTRACT]
)
def test_every_blend_equation_over_every_numerator(equation):
    # The factors are the alphas, so four bytes are free in every pixel.
    operands = operands_of_every_numerator(1 if equation == BlendEquation.FUNC_ADD else -1)
    s, fs, d, fd = operands.T
    numerators = s * fs + (d * fd if equation == BlendEquation.FUNC_ADD else -d * fd)
    assert len(numerators) > 120000
    assert len(np.unique(numerators)) == len(numerators)
    padded = np.zeros((512 * 256, 4), np.int64)
    padded[: len(operands)] = operands
    s, fs, d, fd = padded.reshape(512, 256, 4).transpose(2, 0, 1).astype(np.uint8)
    blending = Blending(BlendFactor.SRC_ALPHA, BlendFactor.DST_ALPHA, equation)
    got = drawn_over(np.stack([s, s, s, fs], -1), np.stack([d, d, d, fd], -1), blending=blending).color
    for operand, result in zip(operands.tolist(), got.reshape(-1, 4)[: len(operands)].tolist(), strict=True):
        s, fs, d, fd = operand
        assert result[:3] == [per_fragment.blend_component(equation, s, d, fs, fd)] * 3


@pytest.mark.parametrize("equation", sorted(BlendEquation)[BlendEquation.MIN :])
def test_equations_without_factors_of_all_pairs_of_bytes(equation):
    source, destination = colors_of_all_pairs()
    got = drawn_over(source, destination, profile=NV2A, blending=Blending(equation=equation)).color
    for s, d, result in zip(
        source[..., 0].ravel().tolist(),
        destination[..., 0].ravel().tolist(),
        got[..., 0].ravel().tolist(),
        strict=True,
    ):
        assert result == per_fragment.blend_component(equation, s, d, 255, 255)


@pytest.mark.parametrize("operation", LogicOperation)
def test_every_logic_operation_over_all_pairs_of_bytes(operation):
    source, destination = colors_of_all_pairs()
    got = drawn_over(source, destination, logic_op=operation).color
    expected = [[per_fragment.logic_operation(operation, s, d) for d in BYTES] for s in BYTES]
    for k in range(4):
        np.testing.assert_array_equal(
            got[..., k], np.array(expected)[source[..., k].astype(int), destination[..., k].astype(int)]
        )


def gray_ramp():
    """uint8 [1, 256, 4]: pixel x has the value x in every component."""
    return np.repeat(np.arange(256, dtype=np.uint8)[None, :, None], 4, -1)


def assert_alpha_test_equals(function, references):
    ramp = gray_ramp()
    for reference in references:
        test = AlphaTest(function, reference / 255.0)
        got = drawn_over(ramp, 255 - ramp, alpha_test=test).color[0, :, 0].tolist()
        assert got == [a if per_fragment.alpha_test_passes(a, test) else 255 - a for a in BYTES]


@pytest.mark.parametrize("function", ComparisonFunction)
def test_alpha_functions_over_all_alphas(function):
    assert_alpha_test_equals(function, (0, 1, 100, 127, 128, 254, 255))


@pytest.mark.slow
@pytest.mark.parametrize("function", ComparisonFunction)
def test_alpha_functions_over_all_alphas_and_references(function):
    assert_alpha_test_equals(function, BYTES)


@pytest.mark.parametrize("function", ComparisonFunction)
def test_depth_functions_around_equality(function):
    # Depth 2^23 in the middle of a 24-bit buffer; the stored depths lie around it and at the ends.
    units = depth.word(depth.single(0.5 * 16777215.0), DepthFormat.FIXED_24, None)
    stored = [0, 1, units - 1, units, units + 1, 2**24 - 2, 2**24 - 1, units]
    source = np.full((1, 8, 4), 200, np.uint8)
    for write in (True, False):
        test = DepthTest(function, write)
        after = drawn_over(source, 0 * source, depth_buffer=[stored], depth_test=test)
        passed = [per_fragment.compare(function, units, z) for z in stored]
        assert after.color[0, :, 0].tolist() == [200 * p for p in passed]
        assert after.depth[0].tolist() == [
            units if p and write else z for p, z in zip(passed, stored, strict=True)
        ]


def assert_stencil_equals(test, depth_test=None, depth_passes=True):
    ramp = gray_ramp()
    after = drawn_over(
        ramp,
        0 * ramp,
        depth_buffer=np.full((1, 256), 0xFFFFFF if depth_passes else 0),
        stencil=np.arange(256)[None],
        stencil_test=test,
        depth_test=depth_test,
    )
    expected = []
    for stored in BYTES:
        operation = test.depth_pass if depth_passes else test.depth_fail
        if not per_fragment.stencil_test_passes(stored, test):
            operation = test.fail
        expected.append(per_fragment.update_stencil(stored, operation, test))
    assert after.stencil[0].tolist() == expected


@pytest.mark.parametrize("operation", StencilOperation)
def test_every_stencil_operation_over_all_stored_values(operation):
    less = DepthTest()
    for reference, write_mask in ((0, 255), (100, 255), (255, 0x5A), (300, 0x81), (-3, 255), (7, 0)):
        test = StencilTest(reference=reference, write_mask=write_mask, depth_pass=operation)
        assert_stencil_equals(test)
        assert_stencil_equals(
            replace(test, depth_pass=StencilOperation.KEEP, depth_fail=operation), less, False
        )
        never = replace(test, function=ComparisonFunction.NEVER, fail=operation)
        assert_stencil_equals(replace(never, depth_pass=StencilOperation.KEEP), less)


def assert_stencil_function_equals(function, references, masks):
    for reference in references:
        for mask in masks:
            test = StencilTest(
                function, reference, mask, fail=StencilOperation.ZERO, depth_pass=StencilOperation.INVERT
            )
            assert_stencil_equals(test)


@pytest.mark.parametrize("function", ComparisonFunction)
def test_stencil_functions_over_all_stored_values(function):
    assert_stencil_function_equals(function, (0, 1, 128, 200, 255), (255, 0, 0x0F, 0xA5))


@pytest.mark.slow
@pytest.mark.parametrize("function", ComparisonFunction)
def test_stencil_functions_over_all_references(function):
    assert_stencil_function_equals(function, BYTES, (255, 0x3C))


# ------------------------------------------------------------------------------------------- texture formats


@pytest.mark.parametrize("internal_format", COMPONENT_BITS)
def test_every_byte_is_stored_alike_in_every_format(internal_format):
    v = np.arange(256, dtype=np.uint8)
    image = np.stack([v, v[::-1], v ^ 0xAA, np.roll(v, 77)], -1)
    stored = store_texels(image, internal_format)
    assert stored.tolist() == [texel_formats.store_texel(texel, internal_format) for texel in image.tolist()]


@pytest.mark.parametrize("internal_format", COMPONENT_BITS)
def test_floats_are_stored_alike_in_every_format(internal_format):
    # Around every rounding boundary of every width: (k + 1/2) / (2^b - 1).
    edges = {(k + 0.5) / (2**b - 1) for b in range(1, 9) for k in range(-1, 2**b)}
    values = sorted(
        {f(e, d) for e in edges for f, d in ((max, e), (math.nextafter, 9.0), (math.nextafter, -9.0))}
    )
    values = np.array([*values, -2.0, 3.0, 0.0, 1.0])
    image = np.stack([values, values[::-1], np.roll(values, 5), np.roll(values, 50)], -1)
    stored = store_texels(image, internal_format)
    expected = [texel_formats.store_texel(t, internal_format, floats=True) for t in image.tolist()]
    assert stored.tolist() == expected


@pytest.mark.parametrize("bits", range(1, 9))
def test_every_component_is_widened_alike(bits):
    assert all(int(widen_to_byte(c, bits)) == texel_formats.replicate(c, bits) for c in range(2**bits))


def test_mipmaps_are_boxes_alike():
    random = np.random.default_rng(3)
    for height, width in ((4, 8), (1, 4), (8, 1), (2, 2)):
        level = random.integers(0, 256, (1, height, width, 4), np.uint8)
        assert halve(level)[0].tolist() == texel_formats.next_level(level[0].tolist())


# -------------------------------------------------------------------------------------------------- sampling


def test_the_table_of_powers_holds_the_nearest_floats():
    assert tuple(POWERS_OF_TWO.tolist()) == sample.octave_fractions()
    for k, power in enumerate(POWERS_OF_TWO.tolist()):
        # 128th powers, exactly: half a unit in the last place below and above enclose 2^k.
        half_unit = Fraction(math.ulp(power)) / 2
        assert (Fraction(power) - half_unit) ** 128 <= 2**k < (Fraction(power) + half_unit) ** 128


def test_logarithms_are_alike_at_every_step():
    for power in sample.octave_fractions():
        for exponent in (-200, -3, -1, 0, 1, 2, 20, 200):
            middle = math.ldexp(power, exponent)
            for x in (math.nextafter(middle, 0.0), middle, math.nextafter(middle, math.inf)):
                assert log2_q7(x) == sample.lambda_of(x)


def pixel_quads(count, **arrays):
    """A quad over each pixel of a row, so that every pixel can have vertices of its own."""
    x = np.repeat(np.linspace(-1.0, 1.0, count + 1), 2)
    corners = 2 * np.arange(count)[:, None] + [0, 2, 3, 1]
    positions = np.stack([x, np.tile([-1.0, 1.0], count + 1)], -1)[corners.ravel()]
    return Mesh(positions, PrimitiveType.QUADS, **arrays)


@pytest.mark.parametrize("texture_filter", [TextureFilter.NEAREST, TextureFilter.LINEAR])
@pytest.mark.parametrize("size", [1, 2, 8])
@pytest.mark.parametrize("mode", WrapMode)
def test_wrap_modes_are_alike_on_and_around_every_step(mode, size, texture_filter):
    # Texel coordinates from three textures to the left to three to the right: texel boundaries, and the
    # filter's steps at the texture's ends, each with its neighbours; and values beyond all precision.
    linear = texture_filter is TextureFilter.LINEAR
    steps = np.arange(-6 * size, 7 * size + 1) / 2.0
    if linear:
        fine = np.arange(-132, 140, 2) / 256.0
        steps = np.concatenate([steps, fine, size + fine])
    texel = np.concatenate(
        [steps, np.nextafter(steps, 99.0), np.nextafter(steps, -99.0), steps - sample.TAU, [1e9, -1e9, 1e300]]
    )
    image = texture_1d(np.random.default_rng(size).integers(0, 256, (size, 4), np.uint8))
    sampler = Sampler(texture_filter, texture_filter, mode, mode, border_color=CONSTANT)
    state = PassState(texture_units=(TextureUnit("row", sampler),), register_combiners=SHOW_TEXTURE)
    coordinates = np.repeat(texel / size, 4)[:, None]
    commands = (
        TexImage(label="row", texture="row", image=image),
        Draw(label="steps", mesh=pixel_quads(len(texel), texture_coordinates=(coordinates,)), state=state),
    )
    machine = Machine(GEFORCE_256, len(texel), 1, threads=1)
    machine.run(commands)
    expected = run_reference(commands, GEFORCE_256, len(texel), 1, 24)
    assert machine.framebuffer.color.tolist() == expected.target.color


@pytest.mark.parametrize("threshold", MagnificationThreshold)
@pytest.mark.parametrize("magnification", [TextureFilter.NEAREST, TextureFilter.LINEAR])
@pytest.mark.parametrize("minification", list(TextureFilter)[2:])
def test_every_lambda_reads_the_same_levels(minification, magnification, threshold):
    # One texel a pixel, so that lambda is the bias (or 1/256 less, where the iteration rounds down).
    profile = GEFORCE_256.changed(magnification_threshold=threshold)
    random = np.random.default_rng(5)
    image = texture_2d(random.integers(0, 256, (8, 8, 4), np.uint8), mipmaps=True)
    corners = np.array([[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]])
    mesh = Mesh(corners, texture_coordinates=((corners + 1.0) * (4 / 16, 2 / 16),))
    sampler = Sampler(minification, magnification)
    near_halves = {k + d for k in range(-256, 1024, 128) for d in (-2, -1, 0, 1, 2)}
    for step in sorted(near_halves | set(range(-1024, 1025, 41))):
        unit = TextureUnit("pyramid", sampler, lod_bias=step / 256)
        commands = (
            TexImage(label="pyramid", texture="pyramid", image=image),
            Draw(
                label="one texel a pixel",
                mesh=mesh,
                state=PassState(texture_units=(unit,), register_combiners=SHOW_TEXTURE),
            ),
        )
        machine = Machine(profile, 4, 2, threads=1)
        machine.run(commands)
        expected = run_reference(commands, profile, 4, 2, 24)
        assert machine.framebuffer.color.tolist() == expected.target.color, step


def test_cube_map_directions_select_the_same_faces():
    values = (-2.0, -1.0, -0.0, 0.0, 0.5, 1.0, 2.0)
    for direction in ((s, t, r) for s in values for t in values for r in values):
        face = sample.cube_map_face((*direction, 1.0))
        assert major_axis(*direction) == face
        for other in range(6):
            assert on_face(other, *direction) == sample.face_components((*direction, 1.0), other)


# --------------------------------------------------------------------------------------------- interpolation


def kernel_color_weights(n, inverse_w):
    """((w0, w1, w2), q0, q2) of each row of edge values."""
    count, factors = len(n), weight_factors(*inverse_w)
    floats = np.empty((rows.FLOAT_COLUMNS, count))
    ints = np.empty((rows.INT_COLUMNS, count), np.int32)
    for i, row in enumerate(np.array(n, np.float64).tolist()):
        emit_iteration_weights(floats, i, 1, tuple(row), (0.0, 0.0, 0.0), factors)
    color_weights(floats, count, ints, 8)
    columns = (ints[rows.W0], ints[rows.W2], floats[rows.Q0], floats[rows.Q2])
    return [((a, 256 - a - b, b), p, q) for a, b, p, q in zip(*(c.tolist() for c in columns), strict=True)]


# What the captures leave 2**47 / sum, of 24 bits: the sum, the least and the greatest (0: none is told). From
# texels of FloorQuad_V0, RoofQuad and WallQuad, quotients of DotZW and pictures of Fog_gen; a truncated
# reciprocal misses the first sixteen, one whose twelve bits are to nearest 0xC92544's and 0xD0ACDB's.
RECIPROCALS = (
    *(
        (0x890B02, 15670145, 0),
        (0x897AA4, 15620440, 15620440),
        (0x8F9586, 0, 14956279),
        (0x9074CA, 14865984, 0),
    ),
    *(
        (0xA4F39C, 0, 13018870),
        (0xA9BF97, 0, 12650979),
        (0xAE8B91, 12303311, 12303311),
        (0xC1D949, 0, 11078138),
    ),
    *(
        (0xDEA128, 9645997, 9645998),
        (0xEC9575, 0, 9077051),
        (0xF38F9B, 0, 8817026),
        (0xFF7E2C, 8405259, 8405259),
    ),
    *((0x86A121, 15951074, 0), (0x9E6666, 13557347, 0), (0xD5C761, 0, 10045351), (0xFD4544, 8479010, 0)),
    *((0x89EA47, 15571050, 15571052), (0x9C4000, 13743895, 13743895), (0xC92544, 10676266, 10676266)),
    *((0xCB8000, 10552745, 10552745), (0xD0ACDB, 10291033, 0), (0xED8000, 9042036, 9042036)),
    *((0xC68400, 0, 10817705), (0xB38F80, 11959663, 0)),  # halves: FogGen_FF-exp2-planar, 3F16f_10.00-20.00
)


@pytest.mark.parametrize(("total", "least", "greatest"), RECIPROCALS, ids=lambda v: f"{v:x}")
def test_reciprocals_lie_where_the_captures_leave_room(total, least, greatest):
    value = float(total)
    column = columns_interpolate.reciprocal_24(np.array([value]))[0]
    for found in (reciprocal_24(value), column, interpolate.reciprocal(value)):
        assert least <= found * 2.0**47 <= (greatest or 2**24)
        assert signed_reciprocal(-value) == -found


def specified_weights(n, inverse_w):
    weights = interpolate.weights(n, inverse_w)
    return interpolate.color_weights(weights), weights.q0, weights.q2


def test_color_weights_of_all_small_edge_values():
    n = [(a, b, c) for a in range(25) for b in range(25) for c in range(25) if a + b + c]
    expected = [specified_weights(row, (1.0, 1.0, 1.0)) for row in n]
    assert kernel_color_weights(n, (1.0, 1.0, 1.0)) == expected


@settings(max_examples=100)
@given(st.integers(0, 2**32 - 1), st.sampled_from((300, 2**20, 2**38)))
def test_color_weights_of_random_edge_values_in_perspective(seed, size):
    random = np.random.default_rng(seed)
    n = random.integers(0, size, (40, 3)) + (random.random((40, 1)) < 0.5)
    n[:, 0] += 1
    inverse_w = np.exp(random.uniform(-3.0, 3.0, 3))
    expected = [specified_weights(row, inverse_w.tolist()) for row in n.tolist()]
    assert kernel_color_weights(n, inverse_w.tolist()) == expected
    corners = np.broadcast_to(inverse_w, (len(n), 3))
    q0, q2 = columns_interpolate.iteration_weights(list(n.T), corners)
    assert list(zip(q0.tolist(), q2.tolist(), strict=True)) == [tuple(q) for _, *q in expected]


@settings(max_examples=100)
@given(st.integers(0, 2**32 - 1))
def test_weights_beyond_a_line_s_end_whose_sum_may_be_negative(seed):
    random = np.random.default_rng(seed)
    along, length = random.integers(-5000, 0, 40), random.integers(1, 10000, 40)
    n = np.stack([along, np.zeros_like(along), length - along], axis=1)
    near, far = np.exp(random.uniform(-5.0, 5.0, 2))
    inverse_w = np.array([near, far, far])
    sums = [
        interpolate.weight_sum(interpolate.weighed_edges(row, interpolate.weight_factors(inverse_w)))
        for row in n
    ]
    n = n[np.array(sums) != 0.0]
    expected = [specified_weights(row, inverse_w.tolist()) for row in n.tolist()]
    assert kernel_color_weights(n, inverse_w.tolist()) == expected
    q0, q2 = columns_interpolate.iteration_weights(list(n.T), np.broadcast_to(inverse_w, (len(n), 3)))
    assert list(zip(q0.tolist(), q2.tolist(), strict=True)) == [tuple(q) for _, *q in expected]


def kernel_exact_colors(n, inverse_w, colors):
    """The byte of each row of edge values, of a triangle whose vertices have ``colors``."""
    columns = [np.ascontiguousarray(c) for c in (np.array(n, np.float64) * inverse_w).T]
    stored = np.zeros((3, 2, 8), np.int16)
    stored[:, 0, 5] = colors
    starts, zero = np.array([0, len(n)], np.int32), np.zeros(1, np.int32)
    triangle, out = np.array([[0, 1, 2, 2]], np.int32), np.zeros((2, len(n)), np.int16)
    channel = Channel(triangle, stored, 5, 0, np.int32(8))
    iterate_exact_color(Segments(starts, zero, zero, 1), channel, Edges(*columns), out, 1)
    return out[1].tolist()


@pytest.mark.parametrize("colors", [(0, 255, 128), (255, 254, 0), (7, 8, 8), (3, 3, 3), (0, 1, 0)])
def test_exact_colors_of_all_small_edge_values(colors):
    n = [(a, b, c) for a in range(-2, 20) for b in range(20) for c in range(20) if a + b + c > 0]
    ones = (1.0, 1.0, 1.0)
    expected = [interpolate.exact_color_channel(row, ones, colors) for row in n]
    assert kernel_exact_colors(n, 1.0, colors) == expected
    nearest = [
        math.floor(Fraction(sum(map(int.__mul__, row, colors)), sum(row)) + Fraction(1, 2)) for row in n
    ]
    assert expected == [min(max(value, 0), 255) for value in nearest]


@settings(max_examples=100)
@given(st.integers(0, 2**32 - 1), st.sampled_from((300, 2**20, 2**37)), st.booleans())
def test_exact_colors_of_random_edge_values(seed, size, perspective):
    random = np.random.default_rng(seed)
    n, colors = random.integers(0, size, (40, 3)), random.integers(0, 256, 3)
    n[:, 0] += 1
    # Ties and what lies beside them: an even area, and twice the sum an odd multiple of it.
    n[:10, 2], n[:10, 1] = 0, n[:10, 0] + random.integers(-1, 2, 10).clip(-n[:10, 0] + 1)
    inverse_w = np.exp(random.uniform(-3.0, 3.0, 3)) if perspective else np.ones(3)
    expected = [interpolate.exact_color_channel(r, inverse_w.tolist(), colors.tolist()) for r in n.tolist()]
    assert kernel_exact_colors(n, inverse_w, colors) == expected


NO_PRIMITIVES = WindowPrimitives(
    x=np.zeros(0, np.int32),
    y=np.zeros(0, np.int32),
    z=np.zeros(0),
    inverse_w=np.zeros(0),
    colors=np.zeros((0, 2, 8), np.uint8),
    coordinates=np.zeros((0, 0, 4)),
    fog=np.zeros(0),
    triangles=np.zeros((0, 4), np.int32),
    dropped=0,
    two_side=False,
)


def kernel_depths(kernel, n, *given):
    """Depths that the kernel gives a row of one pixel for each row of edge values n."""
    floats = np.zeros((rows.FLOAT_COLUMNS, 4))
    values = []
    for edges in n.tolist():
        kernel(floats, 1, 1, tuple(map(float, edges)), (0.0, 0.0, 0.0), *given)
        values.append(floats[rows.DEPTH, 1])
    return values


@pytest.mark.parametrize("scale", [2.0**-130, 2.0**-120, 1.0, 2.0**24, 2.0**120])
@given(seed=seeds)
def test_depths_equal_the_specification(scale, seed):
    random = np.random.default_rng(seed)
    n = random.integers(0, 2 ** random.integers(1, 38), (40, 3))
    n[:, 0] += 1
    z = [depth.single(v) for v in (scale * random.choice([0.0, 0.5, 1.0, -1.0, random.random()], 3)).tolist()]
    expected = [depth.kept(depth.iterate(row, z)) for row in n.tolist()]
    assert kernel_depths(emit_depth, n, tuple(z), 0.0) == expected
    assert kernel_depths(emit_depth, n, tuple(z), 3.0) == [v + 3.0 for v in expected]


@pytest.mark.parametrize("scale", [2.0**-130, 2.0**-60, 1.0, 2.0**24, 2.0**120])
@given(seed=seeds)
def test_depths_of_w_buffering_equal_the_specification(scale, seed):
    random = np.random.default_rng(seed)
    n = random.integers(0, 2 ** random.integers(1, 38), (40, 3))
    n[:, 0] += 1
    given = (scale * np.exp(random.uniform(-3.0, 3.0, 3))).tolist()
    if seed % 3 == 0:
        given[2] = given[seed % 2]
    w = [depth.single(v) for v in given]
    weights = [interpolate.weights(row, [1.0 / v for v in given]) for row in n.tolist()]
    expected = [depth.kept(depth.iterate_w(of_one, w)) for of_one in weights]
    q0, q2 = (np.array([getattr(of_one, name) for of_one in weights]) for name in ("q0", "q2"))
    assert columns_interpolate.iterate_w(q0, q2, np.tile(w, (len(n), 1))).tolist() == expected
    floats = np.empty((rows.FLOAT_COLUMNS, len(n)))
    floats[rows.Q0], floats[rows.Q2] = q0, q2
    for offset in (0.0, 3.0):
        emit_w(floats, 0, len(n), tuple(w), offset)
        assert floats[rows.DEPTH].tolist() == [v + offset for v in expected]


@given(seed=seeds)
def test_depth_words_equal_the_specification(seed):
    random = np.random.default_rng(seed)
    exponents = random.uniform(-140.0, 130.0, 64) if seed % 2 else random.uniform(-10.0, 26.0, 64)
    values = 2.0**exponents * random.choice([1.0, -1.0, 0.0], 64, p=[0.8, 0.1, 0.1])
    low, high = np.sort(random.choice(values, 2)).tolist()
    for depth_format in DepthFormat:
        for limits in (None, DepthClamp(), DepthClamp(low, high), DepthClamp(low, high, True)):
            state = PassState(depth_test=DepthTest(), depth_clamp=limits)
            packed = pack.pack(state, NV2A, Framebuffer.new(4, 4, depth_format), {}, NO_PRIMITIVES)
            floats, words = np.zeros((rows.FLOAT_COLUMNS, 64)), np.zeros(64, np.int32)
            floats[rows.DEPTH] = values
            depth_words(floats, 64, packed.draw, packed.draw_float, words)
            expected = [depth.word(v, depth_format, limits) for v in values.tolist()]
            assert words.tolist() == [-1 if word is None else word for word in expected]


# ------------------------------------------------------------------------------------------------------- fog


@settings(max_examples=40)
@given(
    st.builds(
        Fog,
        mode=st.sampled_from(FogMode),
        density=st.floats(0.0, 100.0),
        start=st.floats(-50.0, 50.0),
        end=st.floats(-50.0, 50.0),
    )
)
def test_fog_thresholds_are_alike(state):
    assert tuple(fog_thresholds(state).tolist()) == fog.thresholds(
        state.mode, state.density, state.start, state.end
    )


def fog_columns(state, distances, profile=GEFORCE_256):
    """The fog factor of a row of pixels at each distance, drawn by the machine."""
    mesh = pixel_quads(len(distances), fog_coordinates=np.repeat(np.array(distances), 4))
    final = FinalCombiner(
        a=CombinerInput(),
        b=CombinerInput(),
        c=CombinerInput(Register.FOG, usage=ComponentUsage.ALPHA),
        d=CombinerInput(),
    )
    machine = Machine(profile, len(distances), 1, threads=1)
    fogged = PassState(fog=state, register_combiners=RegisterCombiners(final=final))
    machine.run((Draw(label="fog", mesh=mesh, state=fogged),))
    return machine.framebuffer.color[0, :, 0].tolist()


@pytest.mark.parametrize(
    "state",
    [
        Fog(FogMode.EXP, density=0.7, coordinate_source=FogCoordinateSource.FOG_COORDINATE),
        Fog(FogMode.EXP2, density=1.3, coordinate_source=FogCoordinateSource.FOG_COORDINATE),
        Fog(FogMode.EXP, density=0.0, coordinate_source=FogCoordinateSource.FOG_COORDINATE),
        Fog(FogMode.LINEAR, start=-1.0, end=3.0, coordinate_source=FogCoordinateSource.FOG_COORDINATE),
        Fog(FogMode.LINEAR, start=3.0, end=-1.0, coordinate_source=FogCoordinateSource.FOG_COORDINATE),
        Fog(FogMode.LINEAR, start=0.5, end=0.5, coordinate_source=FogCoordinateSource.FOG_COORDINATE),
    ],
    ids=["exp", "exp2", "no density", "linear", "rising", "step"],
)
def test_every_fog_factor_begins_at_its_threshold(state):
    limits = [
        t for t in fog.thresholds(state.mode, state.density, state.start, state.end) if math.isfinite(t)
    ]
    distances = [
        f(t, d) for t in limits for f, d in ((max, t), (math.nextafter, 99.0), (math.nextafter, -99.0))
    ]
    distances += [-1e30, 0.0, 1e30]
    assert fog_columns(state, distances) == [fog.fog_factor(c, state, GEFORCE_256) for c in distances]


@pytest.mark.parametrize("profile", [GEFORCE_256, NV2A], ids=lambda p: p.name)
@pytest.mark.parametrize("place", [0.5, -3.0, 1000.0])
def test_linear_fog_of_no_length_is_a_step(profile, place):
    """Source: WineHQ dlls/d3d9/tests/visual.c, fog_special_test."""
    state = Fog(FogMode.LINEAR, start=place, end=place, coordinate_source=FogCoordinateSource.FOG_COORDINATE)
    near = 2.0**-10 * abs(place)
    distances = [place - 10.0, place - near, place + near, place + 10.0]
    assert fog_columns(state, distances, profile) == [255, 255, 0, 0]
    values = distances if profile is GEFORCE_256 else [fog.vertex_value(state, c) for c in distances]
    assert [fog.fog_factor(v, state, profile) for v in values] == [255, 255, 0, 0]


@pytest.mark.parametrize("mode", FogMode)
def test_every_step_of_table_fog_is_the_specification_s(mode):
    own = FogRegisters(bias=1.0, multiplier=1.0, generation=FogGeneration.FOG_COORDINATE)
    state = Fog(mode, registers=own)
    steps = np.arange(-4, 4100)  # of 1/4096: the iterated value is 1 + the coordinate
    for distances in np.array_split(np.concatenate([steps, steps + 0.5]) / 4096.0, 5):
        values = [fog.vertex_value(state, c) for c in distances.tolist()]
        assert fog_columns(state, distances, NV2A) == [fog.fog_factor(v, state, NV2A) for v in values]
    assert fog_columns(state, [-3e38, 3e38], NV2A) == [0, 0 if mode == FogMode.EXP2 else 255]


@pytest.mark.parametrize("mode", FogMode)
@pytest.mark.parametrize("absolute", [False, True])
@pytest.mark.parametrize(("bias", "multiplier"), [(1.5, -0.25), (1.51, 0.0), (-1.0, -1000.0), (2.0, 0.3)])
def test_fog_coordinates_of_every_kind_are_the_specification_s(mode, absolute, bias, multiplier):
    registers = FogRegisters(bias, multiplier, FogGeneration.FOG_COORDINATE, absolute=absolute)
    state = Fog(mode, registers=registers)
    given = [math.inf, -math.inf, math.nan, 0.0, -0.0, 3.4e38, -3.4e38, 1e-40, 0.3, -0.7, 1.71, -1.71, 100.0]
    taken = [abs(c) if absolute and not fog.folds(state) else c for c in given]
    values = [fog.vertex_value(state, c) for c in taken]
    with np.errstate(invalid="ignore"):
        assert vertex_value(state, np.array(taken)).tolist() == values
    entries = table(mode, folds(state))[[math.floor(min(max(4096 * v, 0), 8192)) for v in values]]
    assert entries.tolist() == [fog.fog_factor(v, state, NV2A) for v in values]
