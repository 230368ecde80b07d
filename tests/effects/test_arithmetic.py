"""The rules' vectors, read from their files, are what the specification and the formulas say; all of them."""

import json
import math
import re
import shutil
import subprocess
from fractions import Fraction
from functools import partial
from types import SimpleNamespace

import pytest

from fixedpipe.effects.arithmetic.rules import RULES
from fixedpipe.effects.conformance import rules as questions
from fixedpipe.effects.conformance.redraw import known_suites
from fixedpipe.effects.reports.golden.vectors import write_rules
from fixedpipe.pipeline.enums import (
    BlendEquation,
    BlendFactor,
    ColorFormat,
    CombinerBias,
    CombinerScale,
    ComparisonFunction,
    CullMode,
    DepthFormat,
    DotProductMapping,
    FogMode,
    LogicOperation,
    Mapping,
    MuxSelect,
    Register,
    StencilOperation,
    WrapMode,
)
from fixedpipe.pipeline.profiles import NV2A
from fixedpipe.pipeline.profiles.known import EVIDENCE_TAGS
from fixedpipe.pipeline.state import (
    CombinerInput,
    FinalCombiner,
    Fog,
    FogRegisters,
    Sampler,
    SignedComponents,
)
from tests.layers import ROOT
from tests.reference import (
    combine,
    coverage,
    depth,
    fixed,
    fog,
    interpolate,
    lighting_unit,
    per_fragment,
    sample,
    surface,
    texel_words,
    texture_shader,
    vertex,
    vertex_programs,
    w_slope,
)
from tests.support.arithmetic import decoded, same, words

CHIP = combine.machine_of(NV2A)
READER = ROOT / "docs" / "examples" / "read_rules.c"

_LINES = (ROOT / "tests" / "conformance" / "accepted.txt").read_text().splitlines()
_COUNTED = [re.fullmatch(r"(.+): (\d+) / (\d+)", line) for line in _LINES]
ACCEPTED = {m[1] for m in _COUNTED if m}
INEXACT = {m[1] for m in _COUNTED if m and m[2] != m[3]}


# -------------------------------------------------------------------------------- the specification's answers


def output(*products, scale="NONE", bias="NONE"):
    return combine.combiner_output(products, CombinerScale[scale], CombinerBias[bias], CHIP)


def final(a, b, c, d):
    """The final combiner's red; an input above 255 is a sum of two registers."""
    registers = {
        register: [value] * 4
        for register, value in zip(
            (Register.TEXTURE0, Register.TEXTURE1, Register.TEXTURE2, Register.TEXTURE3),
            (a, b, c, d),
            strict=True,
        )
    }
    registers |= {Register.SPARE0: [0] * 4, Register.SECONDARY_COLOR: [0] * 4, Register.ZERO: [0] * 4}
    zero = CombinerInput(Register.ZERO)
    inputs = [CombinerInput(register) for register in registers][:4]
    return combine.final_combiner(registers, FinalCombiner(*inputs, zero, zero, zero), False, machine=CHIP)[0]


def fog_value(mode, bias, multiplier, c):
    state = Fog(FogMode[mode], registers=FogRegisters(bias=bias, multiplier=multiplier))
    return float(fog.vertex_value(state, c))


def stored(color_format, color):
    return int.from_bytes(bytes(surface.to_surface(color, color_format)), "little")


def weights(n, inverse_w):
    return interpolate.weights(n, inverse_w)


def nearest(t, size, wrap):
    found = sample.wrap_index(
        math.floor(sample.wrap_coordinate(t, WrapMode[wrap], size)), WrapMode[wrap], size, linear=False
    )
    return -1 if found is None else found


def linear(t, size, wrap):
    i, f = sample.linear_position(sample.wrap_coordinate(t, WrapMode[wrap], size))
    found = [sample.wrap_index(k, WrapMode[wrap], size, linear=True) for k in (i, i + 1)]
    return [*(-1 if k is None else k for k in found), f]


def bilinear(p00, p10, p01, p11, a, b):
    rows = [[[p00] * 4, [p10] * 4], [[p01] * 4, [p11] * 4]]
    texture = SimpleNamespace(levels=[[rows]], target=None, internal_format=None)
    sampler = SimpleNamespace(signed_components=SignedComponents())
    modes = (WrapMode.CLAMP_TO_EDGE,) * 2
    t = (0.5 + a / 256, 0.5 + b / 256)
    return sample.sample_linear(texture, 0, 0, t, modes, None, sampler)[0]


def signed_texel(byte):
    sampler = Sampler(signed_components=SignedComponents(red=True))
    return sample.to_register(sample.as_signed([byte, 0, 0, 0], sampler), sampler)[0]


def block(name, data):
    texels = texel_words.texels_of_block(data, name)
    if name == "DXT1":
        texels = [texel_words.dithered(texel, i % 4, i // 4) for i, texel in enumerate(texels)]
    return bytes(component for texel in texels for component in texel)


def cube_texel(s, t, r):
    face = sample.cube_map_face((s, t, r, 1.0))
    return [v + sample.TAU for v in sample.face_coordinates((s, t, r, 1.0), face, 64)]


def slope(x, y, v, factor):
    corners = tuple(zip(x, y, strict=True))
    area = coverage.edge_function(*corners)
    return depth.polygon_offset(corners, area, v, factor)


def slope_of_w(x, y, w, box):
    triangle = coverage.make_triangle(*zip(x, y, strict=True))
    return w_slope.slope(triangle, w, [1.0 / v for v in w], range(box[0], box[2]), range(box[1], box[3]))


def replaced(a, b):
    state = SimpleNamespace(texture_shader=(), texture_units=())
    stages = texture_shader.Stages(state, (), None, None, 0xFFFFFF, NV2A)
    products = iter((a, b))
    stages.dot_product = lambda i: next(products)
    stages.replace_depth(1)
    return stages.depth if stages.alive else -1


def exact(value):
    """A float as the units' specification takes it, which has no sign of zero."""
    return Fraction(value) if math.isfinite(value) else value


def flushed(value):
    """What a program reads of an input. Source: docs/numbers.md, N2.23."""
    return math.copysign(0.0, value) if abs(value) < 2.0**-126 else value


def program(name, *operands):
    operands = [
        [flushed(v) for v in (operand if isinstance(operand, list) else [operand] * 4)]
        for operand in operands
    ]
    if name in ("MIN", "MAX", "SLT", "SGE"):  # zeros have a sign here, and -0 is the lesser
        return [
            {"MIN": min, "MAX": max, "SLT": lambda p, q: p < q, "SGE": lambda p, q: p >= q}[name](
                (a, math.copysign(1.0, a)), (b, math.copysign(1.0, b))
            )
            for a, b in zip(*operands, strict=True)
        ]
    if name in ("RCP", "RCC") and operands[0][0] == 0.0:
        limit = math.inf if name == "RCP" else 2.0**64
        return [math.copysign(limit, operands[0][0])] * 4
    found = vertex_programs.execute(name, *([exact(v) for v in operand] for operand in operands))
    found = [float(v) for v in found]
    if name in ("RCP", "RCC"):
        return [math.copysign(v, operands[0][0]) for v in found]
    if name == "DST":  # hands two components on
        return [*found[:2], operands[0][2], operands[1][3]]
    return found


def instruction(name, *operands):
    found = program(name, *operands)
    if name in ("MIN", "MAX"):
        return [value for value, _ in found]
    return [float(value) for value in found]


def of_unit(function):
    return lambda *values: float(function(*map(exact, values)))


def window(x, w, offset):
    v = SimpleNamespace(clip=(x, x, x, w))
    return vertex.composite_to_window(v, SimpleNamespace(offset=(offset,) * 3), 0.0)[0]


def _name(id_, begin):
    return id_.removeprefix(begin).upper().replace("-", "_")


# By id, or by what ids begin with: the specification's function of the inputs.
ONE_BY_ONE = {
    "rn": fixed.divide,
    "product": lambda a, b: output(a * b),
    "sum-of-products": lambda a, b, c, d: output(a * b, c * d),
    "dot-product": lambda a, b: output(*(x * y for x, y in zip(a, b, strict=True))),
    "scale-and-bias": lambda x, scale, bias: output(255 * x, scale=scale, bias=bias),
    "general-clamp": lambda x: output(255 * x),
    "mux-takes-cd": lambda alpha, select: int(combine.mux_takes_cd(alpha, MuxSelect[select], CHIP)),
    "final-mapping": lambda x, mapping: combine.map_input(x, Mapping[mapping], CHIP),
    "final-product": lambda e, f: fixed.divide(e * f),
    "final-lerp": final,
    "fog-factor-linear": lambda n: fog.table_factor(n / 4096, FogMode.LINEAR),
    "fog-factor-exp": lambda n: fog.table_factor(n / 4096, FogMode.EXP),
    "fog-factor-exp-abs": lambda n: fog.table_factor(n / 4096, FogMode.EXP, True),
    "fog-factor-exp2": lambda n: fog.table_factor(n / 4096, FogMode.EXP2, True),
    "fog-line": fog_value,
    "fog-blend": lambda f, color, of: fog.blend_with_fog([color] * 4, [of] * 3, f)[0],
    "alpha-test": lambda a, function, b: int(per_fragment.compare(ComparisonFunction[function], a, b)),
    "stencil-operation": lambda name, s, r: per_fragment.stencil_result(StencilOperation[name], s, r),
    "logic-operation": lambda name, s, d: per_fragment.logic_operation(LogicOperation[name], s, d),
    "coverage": lambda x, y, px, py: int(
        coverage.covers(coverage.make_triangle(*zip(x, y, strict=True)), px, py)
    ),
    "weight-reciprocal": interpolate.reciprocal,
    "iteration-weights": lambda n, w: [weights(n, w).q0, weights(n, w).q2],
    "iterated-color": lambda n, w, c: interpolate.iterate_color_channel(
        interpolate.color_weights(weights(n, w)), c
    ),
    "iterated-coordinate": lambda n, w, v: interpolate.iterate_coordinate(v, weights(n, w)),
    "divided-coordinate": lambda c, q: sample.projected((c, 0.0, 0.0, q), True)[0],
    "depth": lambda n, z: depth.kept(depth.iterate(n, z)),
    "depth-of-w": lambda n, w: depth.kept(depth.iterate_w(weights(n, [1.0 / v for v in w]), w)),
    "polygon-offset-slope": slope,
    "slope-of-w": slope_of_w,
    "signed-texel": signed_texel,
    "ycbcr": lambda y, cb, cr: texel_words.texel_of_ycbcr(y, cb, cr)[:3],
    "nearest-texel": nearest,
    "linear-texels": linear,
    "filter-step": fixed.lerp,
    "bilinear": bilinear,
    "lambda": sample.lambda_of,
    "cube-face": lambda s, t, r: sample.cube_map_face((s, t, r, 1.0)),
    "cube-texel": cube_texel,
    "shader-result-byte": texture_shader.real_texel,
    "offset-texture": lambda st, texel, matrix: list(texture_shader.offset(st, texel, matrix)),
    "offset-luminance": lambda texel, m, scale, bias: texture_shader.scaled(
        texel, m, SimpleNamespace(offset_texture_scale=scale, offset_texture_bias=bias)
    ),
    "reflection": lambda normal, eye: list(texture_shader.reflected(normal, eye)),
    "depth-replace": replaced,
    "cull-fragment": lambda strq, modes: int(texture_shader.kept(strq, [CullMode[m] for m in modes])),
    "vertex-arl": math.floor,
    "reciprocal": of_unit(lighting_unit.transform_reciprocal),
    "inverse-square-root": of_unit(lighting_unit.transform_inverse_root),
    "enter-lighting": of_unit(lighting_unit.to_lighting),
    "lighting-product": of_unit(lighting_unit.times),
    "lighting-sum": of_unit(lighting_unit.plus),
    "lighting-multiply-add": of_unit(lambda a, b, c: lighting_unit.multiply_add(a, b, c, 14)),
    "lighting-add-product": of_unit(lambda a, b, c: lighting_unit.add_product(a, b, c, 14)),
    "lighting-reciprocal": of_unit(lighting_unit.lighting_reciprocal),
    "lighting-inverse-square-root": of_unit(lighting_unit.lighting_inverse_root),
    "window-coordinate": window,
    "snapped-coordinate": lambda x, extent: vertex.snap(x, extent, NV2A),
    "color-to-byte": lambda v: vertex.color_codes([v], False, NV2A)[0],
}
FAMILIES = {
    "mapping-": lambda name: lambda x: combine.map_input(x, Mapping[name], CHIP),
    "blend-factor-": lambda name: (
        lambda s, d, constant: [
            per_fragment.blend_factor(BlendFactor[name], k, s, d, constant) for k in range(4)
        ]
    ),
    "blend-": lambda name: (
        lambda s, fs, d, fd: per_fragment.blend_component(BlendEquation[name], s, d, fs, fd)
    ),
    "surface-": lambda name: partial(stored, ColorFormat[name]),
    "depth-word-": lambda name: lambda z: depth.word(z, DepthFormat[name], None),
    "texel-": lambda name: lambda w: texel_words.texel_of_word(w, name),
    "dxt": lambda name: partial(block, f"DXT{name}"),
    "dot-mapping-": lambda name: lambda texel: list(texture_shader.mapped(texel, DotProductMapping[name])),
    "vertex-": lambda name: partial(instruction, name),
}


def specification(id_):
    """The specification's function of a rule."""
    if id_ in ONE_BY_ONE:
        return ONE_BY_ONE[id_]
    begin = next(begin for begin in FAMILIES if id_.startswith(begin))
    return FAMILIES[begin](_name(id_, begin))


# -------------------------------------------------------------------------------------------------- the tests


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """The files of all rules, by id, as JSON."""
    folder = tmp_path_factory.mktemp("vectors")
    written = write_rules(folder, 128, 0)
    assert sorted(written) == sorted([*(f"rules/{id_}.json" for id_ in RULES), "index.json"])
    return {id_: json.loads((folder / "rules" / f"{id_}.json").read_text()) for id_ in RULES}


def disagreeing(file, function):
    """The cases of a file whose result is another than the function's."""
    given = [[decoded(kind, case[name]) for name, kind in file["inputs"].items()] for case in file["cases"]]
    return [
        case
        for case, values in zip(file["cases"], given, strict=True)
        if not same(decoded(file["output"], case["expected"]), function(*values))
    ]


@pytest.mark.parametrize("id_", RULES)
def test_every_vector_is_what_the_specification_says(id_, files):
    assert len(files[id_]["cases"]) >= 100
    assert disagreeing(files[id_], specification(id_)) == []


@pytest.mark.parametrize("id_", [rule.id for rule in RULES.values() if not rule.in_words])
def test_every_vector_is_what_the_formula_says(id_, files):
    file = files[id_]
    formula = eval(f"lambda {', '.join(file['inputs'])}: {file['formula']}", words())
    assert disagreeing(file, formula) == []


def with_one_bit_more(kind, value):
    """A result that is wrong in its last bit."""
    base, bracket, _ = kind.partition("[")
    if bracket:
        return [with_one_bit_more(base, value[0]), *value[1:]]
    if base == "int":
        return value ^ 1
    if base == "bytes":
        return value[:-1] + format(int(value[-1], 16) ^ 1, "x")
    return "0x00000001" if value == "NaN" else f"0x{int(value, 16) ^ 1:0{len(value) - 2}x}"


@pytest.mark.parametrize("id_", RULES)
def test_a_vector_that_is_wrong_by_one_bit_is_seen(id_, files):
    file = files[id_]
    number = len(id_) % len(file["cases"])
    case = file["cases"][number]
    wrong = {**case, "expected": with_one_bit_more(file["output"], case["expected"])}
    assert disagreeing({**file, "cases": [wrong]}, specification(id_)) == [wrong]


def test_a_reader_in_c_agrees_and_sees_what_does_not(tmp_path):
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None:
        pytest.skip("no C compiler here")
    write_rules(tmp_path, 60, 0)
    program = tmp_path / "read_rules"
    options = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-o"]
    subprocess.run([compiler, *options, program, READER], check=True)

    def run():
        return subprocess.run([program, tmp_path], capture_output=True, text=True, check=False)

    found = run()
    assert found.returncode == 0, found.stdout
    assert len(READER.read_text().splitlines()) <= 100
    path = tmp_path / "rules" / "reciprocal.json"
    text = path.read_text()
    path.write_text(text.replace('"expected": "0x3eaaaaaa"', '"expected": "0x3eaaaaab"', 1))
    assert path.read_text() != text
    assert run().returncode == 1


def test_a_seed_makes_the_same_vectors_and_another_makes_others():
    rule = RULES["blend-func-add"]
    assert list(rule.cases(8, 3)) == list(rule.cases(8, 3))
    assert list(rule.cases(8, 3))[-8:] != list(rule.cases(8, 4))[-8:]
    assert list(rule.cases(8, 3))[-1] == list(rule.cases(7, 4))[-1]


@pytest.mark.parametrize("rule", RULES.values(), ids=list(RULES))
def test_a_rule_has_its_evidence(rule):
    assert any(rule.evidence.startswith(f"{tag}") for tag in EVIDENCE_TAGS), rule.evidence
    assert f'<a id="{rule.numbers}">' in (ROOT / "docs" / "numbers.md").read_text()
    assert bool(rule.captures) == ("Measured" in rule.evidence), "captures, or none"
    for capture in rule.captures:
        assert capture.partition("/")[0] in known_suites(), capture
        assert any(name == capture or name.startswith(f"{capture}/") for name in ACCEPTED), capture
        if "every pixel" in rule.evidence:
            assert not INEXACT & {n for n in ACCEPTED if n == capture or n.startswith(f"{capture}/")}, capture
    assert not rule.open or rule.open in questions.RULES


def test_numbers_of_the_evidence_stand_on_the_pages():
    """A count is measured once, and said of the rule where it is written down."""
    pages = " ".join((ROOT / "docs" / name).read_text() for name in ("numbers.md", "silicon.md"))
    pages = " ".join(pages.split())
    for rule in RULES.values():
        for count in re.findall(r"\d[\d,]* of \d[\d,]*\d", rule.evidence):
            assert count in pages, f"{rule.id}: {count}"


# It asks what a state draws. No formula differs: both words are 0, so every input of the formula is 0.
_OF_A_STATE = {"final-words-zero"}


def test_every_question_that_captures_leave_open_is_some_rule_s():
    assert {rule.open for rule in RULES.values()} - {""} == questions.RULES.keys() - _OF_A_STATE
