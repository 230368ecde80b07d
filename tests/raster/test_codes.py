"""Codes: one list of them, which the enumerations, the rows and the kernels share."""

import ast
from pathlib import Path

import numpy as np
import pytest

from fixedpipe.pipeline import enums
from fixedpipe.pipeline.enums import (
    BlendEquation,
    CombinerScale,
    ComparisonFunction,
    ComponentUsage,
    LogicOperation,
    Register,
    WrapMode,
)
from fixedpipe.raster import codes, rows
from fixedpipe.raster.portable.combine import plane_of, scaled
from fixedpipe.raster.portable.per_fragment import any_equation, logic, passes
from fixedpipe.raster.portable.sample import wrap_axis

# The enumerations whose values rows, kernels or the column engine see: what their codes begin with, and what
# of a member's name that beginning says already.
SHARED = {
    enums.BlendEquation: ("EQUATION_", ""),
    enums.BlendFactor: ("FACTOR_", ""),
    enums.CombinerFunction: ("COMBINER_FUNCTION_", ""),
    enums.CombinerScale: ("SCALE_", "SCALE_"),
    enums.ComparisonFunction: ("COMPARISON_", ""),
    enums.ComponentUsage: ("USAGE_", ""),
    enums.ConvolutionBorderMode: ("CONVOLUTION_", ""),
    enums.CullMode: ("CULL_MODE_", ""),
    enums.DotProductMapping: ("DOT_MAPPING_", ""),
    enums.FogMode: ("FOG_MODE_", ""),
    enums.LogicOperation: ("LOGIC_", ""),
    enums.Mapping: ("MAPPING_", ""),
    enums.PixelTexGenQ: ("TEX_GEN_Q_", ""),
    enums.Register: ("REGISTER_", ""),
    enums.StencilOperation: ("STENCIL_", ""),
    enums.TextureCompareMode: ("COMPARE_MODE_", "COMPARE_"),
    enums.TextureShaderOperation: ("OPERATION_", ""),
    enums.TextureTarget: ("TARGET_", "TEXTURE_"),
    enums.WrapMode: ("WRAP_", ""),
}
CODES = {name: value for name, value in vars(codes).items() if name.isupper()}
SOURCES = sorted(Path(codes.__file__).parent.rglob("*.py"))


def code_of(member):
    """The name of a member's code."""
    prefix, said = SHARED[type(member)]
    return prefix + member.name.removeprefix(said)


def test_every_code_is_an_integer_or_a_tuple_of_some():
    assert {type(value) for value in CODES.values()} == {int, tuple}
    assert {type(code) for value in CODES.values() if isinstance(value, tuple) for code in value} == {int}


@pytest.mark.parametrize("enumeration", SHARED, ids=lambda e: e.__name__)
def test_a_shared_enumeration_has_its_values_from_the_list_of_codes_and_all_of_its_kind(enumeration):
    (tree,) = (
        node
        for node in ast.parse(Path(enums.__file__).read_text()).body
        if isinstance(node, ast.ClassDef) and node.name == enumeration.__name__
    )
    written = {node.targets[0].id: node.value for node in tree.body if isinstance(node, ast.Assign)}
    assert {name: getattr(value, "attr", None) for name, value in written.items()} == {
        member.name: code_of(member) for member in enumeration
    }
    prefix, _ = SHARED[enumeration]
    assert {name for name in CODES if name.startswith(prefix)} == {code_of(member) for member in enumeration}


def test_every_register_that_can_be_read_has_planes():
    assert {r for r in Register if r < rows.REGISTERS} == set(Register) - {Register.DISCARD}


def declared(tree):
    """Names in capitals that a module assigns at its top."""
    for node in tree.body:
        if isinstance(node, ast.Assign):
            for target in node.targets:
                yield from (n.id for n in ast.walk(target) if isinstance(n, ast.Name) and n.id.isupper())


# What codes are called where the list's kinds are left out: CUBE_MAP was two codes once.
BARE_NAMES = {m.name.removeprefix("TEXTURE_") for e in SHARED for m in e} | {
    m.name for e in SHARED for m in e
}


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: path.stem)
def test_no_code_is_declared_twice(path):
    if path != Path(codes.__file__):
        again = set(declared(ast.parse(path.read_text()))) & (BARE_NAMES | CODES.keys())
        assert not again, f"{path.name}: {', '.join(sorted(again))}: take them from {codes.__name__}"


# ------------------------------------------------------------------ rows are compared with names of codes


def is_number(node):
    """Whether an expression is an integer above 1, or below -1, that has no name."""
    node = node.operand if isinstance(node, ast.UnaryOp) else node
    return isinstance(node, ast.Constant) and type(node.value) is int and node.value > 1


def is_entry(node):
    """Whether an expression is an entry of a row, ``row[R.BLEND]``, or made of one by a type alone."""
    while isinstance(node, ast.Call) and len(node.args) == 1:
        (node,) = node.args
    return isinstance(node, ast.Subscript) and any(
        isinstance(part, ast.Attribute)
        and isinstance(part.value, ast.Name)
        and part.value.id in ("R", "rows")
        for part in ast.walk(node.slice)
    )


def assigned(function):
    """(name, value) of a function's assignments; of tuples, one by one."""
    for node in ast.walk(function):
        if isinstance(node, ast.Assign):
            for target in node.targets:
                both = isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple)
                pairs = zip(target.elts, node.value.elts, strict=True) if both else [(target, node.value)]
                yield from ((name.id, value) for name, value in pairs if isinstance(name, ast.Name))


def bare_comparisons(tree):
    """Comparisons of a row's entry, or of a name that a function gave it, with a bare number above 1."""
    for function in (node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)):
        entries = {name for name, value in assigned(function) if is_entry(value)}
        for node in (node for node in ast.walk(function) if isinstance(node, ast.Compare)):
            sides = [node.left, *node.comparators]
            held = any(
                is_entry(side) or (isinstance(side, ast.Name) and side.id in entries) for side in sides
            )
            if held and any(is_number(side) for side in sides):
                yield ast.unparse(node)


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: path.stem)
def test_a_row_is_compared_with_names(path):
    assert not list(bare_comparisons(ast.parse(path.read_text())))


@pytest.mark.parametrize(
    "line",
    [
        "cube = row[R.TARGET] == 2",
        "high = units[u, R.OPERATION] >= 17",
        "bare = 8 <= unit[R.OPERATION] <= 11",
        "mode, mask = draw[R.BLEND], 7\n    logic = mode == 3",
        "function = int32(row[rows.COMPARE_FUNCTION])\n    hilo = function == -2",
    ],
)
def test_the_rule_catches_a_bare_number(line):
    assert len(list(bare_comparisons(ast.parse(f"def f(row):\n    {line}\n")))) == 1


@pytest.mark.parametrize(
    "line",
    [
        "cube = row[R.TARGET] == C.TARGET_CUBE_MAP",
        "tests = draw[R.ALPHA_TEST] != 0",
        "one = row[R.PROBES] > 1",
        "small = factors.shape[0] < 2",
        "third = u == 2",
    ],
)
def test_the_rule_lets_other_comparisons_be(line):
    assert not list(bare_comparisons(ast.parse(f"def f(row):\n    {line}\n")))


# -------------------------------------------------------------------------------- what kernels make of codes


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
    assert any_equation(int(equation), np.int32(100), one, np.int32(50), one, np.int32(8)) == result


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
