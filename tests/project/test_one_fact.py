"""One fact, one room: codes are compared with their names, last branches name their case, and what is a fact
of a format stands in one module.
"""

import ast
import gc
import re

import pytest

from fixedpipe.pipeline import enums
from fixedpipe.raster import codes
from tests.project.test_layers import ROOT, SOURCES


@pytest.fixture(scope="module")
def trees():
    """Every module of the product, parsed once for these tests; a million nodes, so for them alone."""
    gc.disable()  # or looking for garbage takes three times as long as parsing
    try:
        return {path.relative_to(ROOT).as_posix(): ast.parse(path.read_text()) for path in SOURCES}
    finally:
        gc.enable()


@pytest.fixture(scope="module")
def below(trees):
    """Those of the lower layers: techniques decide on no codes."""
    return {path: tree for path, tree in trees.items() if not path.startswith("effects/")}


ENUMERATIONS = {name for name, value in vars(enums).items() if isinstance(value, type)} | {"Operation"}
TYPES = {"int", "bool", "int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64"}
ARITHMETIC = ast.Mod | ast.FloorDiv | ast.BitAnd | ast.RShift


def is_code(node):
    """Whether an expression is a code or a token, ``C.FACTOR_ONE`` or ``BlendFactor.ONE``, or holds some."""
    if isinstance(node, ast.Tuple | ast.Set | ast.List):
        return any(is_code(element) for element in node.elts)
    return (
        isinstance(node, ast.Attribute)
        and node.attr.isupper()
        and isinstance(node.value, ast.Name)
        and node.value.id in ENUMERATIONS | {"C"}
    )


def stripped(node):
    """An expression without conversions to a type of integers."""
    while isinstance(node, ast.Call) and ast.unparse(node.func).split(".")[-1] in TYPES and node.args:
        node = node.args[0]
    return node


def called(node):
    """What an expression is called: a variable, an attribute, or an entry of a row."""
    node = stripped(node)
    if isinstance(node, ast.Subscript):
        node = next((n for n in ast.walk(node.slice) if isinstance(n, ast.Attribute)), node)
    return getattr(node, "id", getattr(node, "attr", None))


def is_number(node):
    """Whether an expression is an integer without a name, or holds some."""
    node = stripped(node)
    if isinstance(node, ast.Tuple | ast.Set | ast.List):
        return any(is_number(element) for element in node.elts)
    if isinstance(node, ast.UnaryOp):
        node = node.operand
    return isinstance(node, ast.Constant) and type(node.value) is int


def sides(node):
    """The expressions that a comparison compares, or that arithmetic on codes takes; of all else none."""
    if isinstance(node, ast.Compare):
        return [node.left, *node.comparators]
    calculates = isinstance(node, ast.BinOp) and isinstance(node.op, ARITHMETIC)
    return [node.left, node.right] if calculates else []


def names_of_codes(trees):
    """What everything is called that is compared with a code somewhere, or of which a code is a bit."""
    return {
        called(side)
        for tree in trees
        for node in ast.walk(tree)
        if any(map(is_code, sides(node)))
        for side in sides(node)
        if not is_code(side)
    } - {None}


def bare(tree, names):
    """Comparisons of what is called as codes are with a number, and arithmetic on it."""
    for node in ast.walk(tree):
        if any(map(is_number, sides(node))) and any(called(side) in names for side in sides(node)):
            yield ast.unparse(node)


# Numbers that are called as some codes are, and codes whose bits are their meaning.
NUMBERS = {
    "pipeline/description/equations.py": {"half.scale == 1", "alpha.scale == 1"},  # factors
    "pipeline/enums.py": {"self < 0"},  # DepthFormat.is_float
    "pipeline/native/combiner_plan.py": {"operand.factor == 1", "bias == 0", "output < 2"},
    "pipeline/validation/draws.py": {"1 <= factor <= 256"},  # of a line's stipple
    "pipeline/validation/textures.py": {"0 <= command.face < faces"},  # as given
    "pipeline/vertices/transform_tables.py": {"base > 0"},  # of a power
    "raster/columns/interpolate.py": {"base == 0", "base == 2"},  # a vertex of three
    "raster/pixels/rectangles.py": {"alpha <= 0"},
    "raster/portable/combine.py": {"alpha >= 0", "output < 2"},  # planes
    # Table 4.3.
    "raster/portable/per_fragment.py": {"operation & 1", *(f"operation >> {bit}" for bit in (1, 2, 3))},
}


def test_no_code_is_compared_with_a_bare_number(below):
    names = names_of_codes(below.values())
    assert {"kind", "mode", "equation", "face", "number_format", "buffers", "WINDOW_CLIP"} <= names
    found = {path: set(bare(tree, names)) for path, tree in below.items()}
    assert {path: expressions for path, expressions in found.items() if expressions} == NUMBERS


@pytest.mark.parametrize(
    "text",
    ["kind == 2", "operation >= 5", "int32(mode) != 1", "row[R.TARGET] in (1, 3)", "face % 2", "kind & 4"],
)
def test_a_bare_number_is_seen(text):
    assert list(bare(ast.parse(text), {"kind", "operation", "mode", "TARGET", "face"})) == [text]


# --------------------------------------------------------------------------------------------- last branches

NAMES = {name for name in vars(codes) if name.isupper()} | {
    member for value in vars(enums).values() for member in getattr(value, "__members__", ())
}


def subject(test):
    """What a test compares with codes, or with a list of them, if it does."""
    compares = isinstance(test, ast.Compare) and isinstance(test.ops[0], ast.Eq | ast.Is | ast.In)
    return ast.unparse(test.left) if compares and any(map(is_code, test.comparators)) else None


def ends_of_chains(tree):
    """(tests, line, statements) of what is left to the last branch of an ``if`` with two tests or more, or to
    the statement behind two or more that return.
    """
    inner = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.If) and node not in inner:
            tests, last = [subject(node.test)], node
            while len(last.orelse) == 1 and isinstance(last.orelse[0], ast.If):
                (last,) = last.orelse
                inner.add(last)
                tests.append(subject(last.test))
            if len(tests) > 1 and last.orelse:
                yield tests, last.body[-1].end_lineno + 1, last.orelse
        elif isinstance(node, ast.IfExp) and isinstance(node.orelse, ast.IfExp):
            yield [subject(node.test), subject(node.orelse.test)], node.lineno, [node.orelse.orelse]
        elif isinstance(node, ast.FunctionDef):
            tests = []
            for statement in node.body:
                if isinstance(statement, ast.If) and isinstance(statement.body[-1], ast.Return):
                    tests.append(subject(statement.test))
                    continue
                if isinstance(statement, ast.Return) and len(tests) > 1:
                    yield tests[-2:], statement.lineno, [statement]
                tests = []


def unnamed(text):
    """Lines of a module where what is left of two or more tests of one thing for codes begins, and it neither
    raises nor has a comment that names a case.
    """
    lines = text.splitlines()
    for tests, number, left in ends_of_chains(ast.parse(text)):
        if tests[0] is not None and len(set(tests)) == 1 and not isinstance(left[-1], ast.Raise):
            _, _, comment = lines[number - 1].partition("#")
            if not set(re.findall(r"\w+", comment)) & NAMES:
                yield number, lines[number - 1].strip()


def test_a_last_branch_names_its_case_or_raises(below):
    found = {path: list(unnamed((ROOT / path).read_text())) for path in below}
    assert not {path: lines for path, lines in found.items() if lines}, "raise, or say which codes are left"


TWO = "if m == C.MIPMAP_NONE:\n    a()\nelif m == C.MIPMAP_LINEAR:\n    b()\n"
RETURNS = "def f(m):\n  if m == C.FOG_MODE_EXP:\n    return 1\n  if m is FogMode.EXP2:\n    return 2\n"


@pytest.mark.parametrize(
    ("text", "seen"),
    [
        (TWO + "else:\n    c()", True),
        (TWO + "else:  # what is left\n    c()", True),
        (TWO + "else:  # MIPMAP_NEAREST\n    c()", False),
        (TWO + "else:\n    raise ValueError(m)", False),
        (TWO.replace("elif m", "elif n") + "else:\n    c()", False),
        (RETURNS + "  return 3", True),
        (RETURNS + "  return 3  # LINEAR", False),
        (RETURNS + "  raise ValueError(m)", False),
        ("x = 1 if m == C.MIPMAP_NONE else (2 if m == C.MIPMAP_LINEAR else 3)", True),
    ],
)
def test_a_last_branch_without_a_name_is_seen(text, seen):
    assert bool(list(unnamed(text))) == seen


# ------------------------------------------------------------------------------------------------- one room

# The modules of the product that write a number.
HOMES = {0xFEFFFF: {"raster/float_depths.py"}, 511.9375: set(), 1023: {"raster/floats.py"}}
CAPTURES = "effects/conformance/"  # has what the programs wrote that drew the captures


@pytest.mark.parametrize("number", HOMES)
def test_a_number_of_a_format_has_one_home(number, trees):
    written = {
        path
        for path, tree in trees.items()
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant) and type(node.value) is type(number) and node.value == number
    }
    assert {path for path in written if not path.startswith(CAPTURES)} == HOMES[number]


# What stood in several modules once, by what it was called there.
ROOMS = {
    r"_?keep_significant_bits|_?cut(_24)?": "raster/floats.py",
    r"_?TAU|_?SMALLEST_SINGLE|LEAST_SINGLE": "raster/floats.py",
    r"_?DEPTH_WORDS|DepthWords": "pipeline/textures/depth_words.py",
    r"_?IMAGE_FORMATS|_?READ_FORMATS|_?READ_TYPES": "pipeline/textures/pixel_formats.py",
    r"_?fog_thresholds": "pipeline/programs/fog.py",
    r"_(SC|TC|MA)(_\w+)?": "raster/columns/interpolate.py",
    r"_?(listed|count|shown|quoted|nearest_power_of_two)": "pipeline/messages.py",
}


def defined(tree):
    """Names that a module defines at its top."""
    for node in tree.body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            yield node.name
        elif isinstance(node, ast.Assign):
            yield from (n.id for target in node.targets for n in ast.walk(target) if isinstance(n, ast.Name))


@pytest.mark.parametrize("names", ROOMS)
def test_a_fact_has_one_room(names, below):
    rooms = {path for path, tree in below.items() if any(re.fullmatch(names, name) for name in defined(tree))}
    assert rooms == {ROOMS[names]}
