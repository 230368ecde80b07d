"""The enumerations' values are the plain integers that kernels decide on."""

import numpy as np
import pytest

from pipeline.enums import (
    BlendEquation,
    CombinerScale,
    ComparisonFunction,
    ComponentUsage,
    LogicOperation,
    Register,
    TextureTarget,
    WrapMode,
)
from raster import rows
from raster.combine import plane_of, scaled
from raster.per_fragment import any_equation, logic, passes
from raster.sample import wrap_axis


@pytest.mark.parametrize(
    ("row", "register"),
    [
        (rows.ZERO, Register.ZERO),
        (rows.CONSTANT0, Register.CONSTANT_COLOR0),
        (rows.CONSTANT1, Register.CONSTANT_COLOR1),
        (rows.FOG, Register.FOG),
        (rows.PRIMARY, Register.PRIMARY_COLOR),
        (rows.SECONDARY, Register.SECONDARY_COLOR),
        (rows.SPARE0, Register.SPARE0),
        (rows.SPARE1, Register.SPARE1),
        (rows.E_TIMES_F, Register.E_TIMES_F),
        (rows.SPARE0_PLUS_SECONDARY, Register.SPARE0_PLUS_SECONDARY_COLOR),
        *((rows.TEXTURE0 + unit, Register[f"TEXTURE{unit}"]) for unit in range(4)),
    ],
)
def test_registers_are_their_planes(row, register):
    assert row == register


def test_every_register_that_can_be_read_has_planes():
    assert {r for r in Register if r < rows.REGISTERS} == set(Register) - {Register.DISCARD}


@pytest.mark.parametrize(
    ("function", "less", "equal", "greater"),
    [
        (ComparisonFunction.NEVER, False, False, False),
        (ComparisonFunction.LESS, True, False, False),
        (ComparisonFunction.EQUAL, False, True, False),
        (ComparisonFunction.LEQUAL, True, True, False),
        (ComparisonFunction.GREATER, False, False, True),
        (ComparisonFunction.NOTEQUAL, True, False, True),
        (ComparisonFunction.GEQUAL, False, True, True),
        (ComparisonFunction.ALWAYS, True, True, True),
    ],
)
def test_comparison_functions(function, less, equal, greater):
    one, two = np.int32(1), np.int32(2)
    code = np.int32(function)
    assert (passes(code, one, two), passes(code, one, one), passes(code, two, one)) == (less, equal, greater)


# Source: OpenGL 1.2.1 table 4.3, for s = 1100 and d = 1010.
@pytest.mark.parametrize(
    ("operation", "result"),
    [
        (LogicOperation.CLEAR, 0b0000),
        (LogicOperation.AND, 0b1000),
        (LogicOperation.AND_REVERSE, 0b0100),
        (LogicOperation.COPY, 0b1100),
        (LogicOperation.AND_INVERTED, 0b0010),
        (LogicOperation.NOOP, 0b1010),
        (LogicOperation.XOR, 0b0110),
        (LogicOperation.OR, 0b1110),
        (LogicOperation.NOR, 0b0001),
        (LogicOperation.EQUIV, 0b1001),
        (LogicOperation.INVERT, 0b0101),
        (LogicOperation.OR_REVERSE, 0b1101),
        (LogicOperation.COPY_INVERTED, 0b0011),
        (LogicOperation.OR_INVERTED, 0b1011),
        (LogicOperation.NAND, 0b0111),
        (LogicOperation.SET, 0b1111),
    ],
)
def test_logic_operations(operation, result):
    assert logic(int(operation), np.uint32(0b1100), np.uint32(0b1010)) & 0b1111 == result


@pytest.mark.parametrize(
    ("equation", "result"),
    [
        (BlendEquation.FUNC_ADD, 150),
        (BlendEquation.FUNC_SUBTRACT, 50),
        (BlendEquation.FUNC_REVERSE_SUBTRACT, 0),
        (BlendEquation.MIN, 50),
        (BlendEquation.MAX, 100),
        (BlendEquation.FUNC_ADD_SIGNED, 150),
        (BlendEquation.FUNC_REVERSE_SUBTRACT_SIGNED, 0),
    ],
)
def test_blend_equations(equation, result):
    one = np.int32(255)
    assert any_equation(int(equation), np.int32(100), one, np.int32(50), one) == result


@pytest.mark.parametrize(
    ("usage", "component"), [(ComponentUsage.RGB, 1), (ComponentUsage.ALPHA, 3), (ComponentUsage.BLUE, 2)]
)
def test_component_usages_choose_the_plane(usage, component):
    row = np.array([Register.SPARE1, usage], np.int32)
    assert plane_of(row, 0, 1) == 4 * Register.SPARE1 + component  # for green


@pytest.mark.parametrize(
    ("scale", "result"),
    [
        (CombinerScale.NONE, 7),
        (CombinerScale.SCALE_BY_TWO, 14),
        (CombinerScale.SCALE_BY_FOUR, 28),
        (CombinerScale.SCALE_BY_ONE_HALF, 4),
    ],
)
def test_combiner_scales(scale, result):
    assert scaled(np.int32(7), np.int32(scale)) == result


# Texel coordinates -0.25 and 5.75 of a texture of four texels, nearest filter; -1 is the border.
@pytest.mark.parametrize(
    ("mode", "texels"),
    [
        (WrapMode.REPEAT, [3, 1]),
        (WrapMode.CLAMP, [0, 3]),
        (WrapMode.CLAMP_TO_EDGE, [0, 3]),
        (WrapMode.CLAMP_TO_BORDER, [-1, -1]),
        (WrapMode.MIRRORED_REPEAT, [0, 2]),
    ],
)
def test_wrap_modes(mode, texels):
    floats, ints = np.zeros((rows.FLOAT_COLUMNS, 2)), np.zeros((rows.INT_COLUMNS, 2), np.int32)
    floats[rows.S_SIZE] = 4.0
    floats[rows.TEXEL] = -0.25, 5.75
    wrap_axis(int(mode), floats, rows.S_SIZE, 2, 0, ints, rows.I0)
    assert ints[rows.I0].tolist() == texels


def test_only_the_linear_filter_tells_clamp_from_clamp_to_edge():
    first = {}
    for mode in (WrapMode.CLAMP, WrapMode.CLAMP_TO_EDGE):
        floats, ints = np.zeros((rows.FLOAT_COLUMNS, 1)), np.zeros((rows.INT_COLUMNS, 1), np.int32)
        floats[rows.S_SIZE] = 4.0
        wrap_axis(int(mode), floats, rows.S_SIZE, 1, 1, ints, rows.I0)
        first[mode] = int(ints[rows.I0, 0])
    assert first == {WrapMode.CLAMP: -1, WrapMode.CLAMP_TO_EDGE: 0}


def test_texture_targets():
    # raster.sample and raster.level_of_detail know these three numbers by heart.
    assert [TextureTarget(code).name for code in range(3)] == ["TEXTURE_1D", "TEXTURE_2D", "TEXTURE_CUBE_MAP"]
