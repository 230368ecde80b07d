"""Vertex programs: every instruction equals its specification, and what is read, written and refused."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fixedpipe.pipeline.vertices.transform_tables import exponential, lit_power, logarithm
from fixedpipe.pipeline.vertices.vertex_programs import vertex_program
from tests.reference import vertex_programs as reference

ARITY = {
    **{"MOV": 1, "MUL": 2, "ADD": 2, "MAD": 3, "DP3": 2, "DP4": 2, "DPH": 2, "DST": 2, "MIN": 2, "MAX": 2},
    **{"SLT": 2, "SGE": 2, "RCP": 1, "RCC": 1, "RSQ": 1, "EXP": 1, "LOG": 1, "LIT": 1},
}
ordinary = st.floats(-8, 8, width=32).filter(lambda x: abs(x) > 1e-30)
numbers = ordinary | st.sampled_from([1.0, -1.0, 2.0**100, -(2.0**-100), 3.4e38])


def run(text, constants=None, **inputs):
    return vertex_program(text).run(inputs, constants)


def exact(value):
    return reference.Fraction(value) if math.isfinite(value) else value


@pytest.mark.parametrize("name", ARITY)
@settings(max_examples=60)
@given(values=st.lists(numbers, min_size=12, max_size=12))
def test_every_instruction_computes_what_is_specified(name, values):
    count = ARITY[name]
    operands = np.array(values, np.float32).astype(np.float64).reshape(3, 4)[:count]
    scalar = name in ("RCP", "RCC", "RSQ", "EXP", "LOG")
    read = ", ".join(f"v[{i}]" + (".x" if scalar else "") for i in range(count))
    inputs = {i: operands[i] for i in range(count)}
    got = vertex_program(f"{name} o[COL0], {read};").run(inputs)["COL0"][0]
    wanted = reference.execute(name, *([exact(v) for v in row] for row in operands.tolist()))
    assert got.tolist() == [float(v) for v in wanted]


def test_infinities_zeros_and_no_numbers():
    inf, nan = math.inf, math.nan
    product = run("MUL o[COL0], v[COL0], v[COL1];", COL0=(0.0, -1.0, nan, inf), COL1=(inf, inf, 1.0, 2.0))
    assert np.array_equal(product["COL0"][0], [0.0, -inf, nan, inf], equal_nan=True)
    added = run("ADD o[COL0], v[COL0], v[COL1];", COL0=(-inf, inf, 1.0, nan), COL1=(1.0, -inf, 2.0, 1.0))
    assert np.array_equal(added["COL0"][0], [-inf, nan, 3.0, nan], equal_nan=True)
    for given_, reciprocal, clamped in ((0.0, inf, 2.0**64), (-0.0, -inf, -(2.0**64)), (inf, 0.0, 2.0**-64)):
        found = run("RCP o[COL0], v[COL0].x; RCC o[COL1], v[COL0].x;", COL0=(given_,))
        assert found["COL0"][0, 0] == reciprocal
        assert found["COL1"][0, 0] == clamped
    denormal = run("RCP o[COL0], v[COL0].x; MUL o[COL1], v[COL0], v[COL1];", COL0=(1e-40,), COL1=(inf,))
    assert denormal["COL0"][0, 0] == inf
    assert denormal["COL1"][0, 0] == 0.0
    assert run("SLT o[COL0], v[COL0], v[COL1];", COL0=(-0.0,), COL1=(0.0,))["COL0"][0, 0] == 1.0


def test_powers_and_logarithms_are_near():
    x = np.linspace(-20, 20, 401)
    assert np.max(np.abs(exponential(x) / 2.0**x - 1)) < 2e-4
    y = 2.0**x
    assert np.max(np.abs(logarithm(y) - x)) < 2e-4
    assert np.max(np.abs(lit_power(y, np.full_like(y, 3.0)) / y**3 - 1)) < 1e-3
    found = run("EXP o[COL0], v[COL0].x; LOG o[COL1], v[COL0].y;", COL0=(2.5, 10.0))
    assert found["COL0"][0, :2].tolist() == [4.0, 0.5]
    assert found["COL1"][0, :2].tolist() == [3.0, 1.25]
    lit = run("LIT o[COL0], v[COL0];", COL0=np.array([(0.5, 0.5, 0, 2), (-1, 1, 0, 1), (1, -1, 0, 2.0)]))
    assert lit["COL0"][:, :2].tolist() == [[1.0, 0.5], [1.0, 0.0], [1.0, 1.0]]
    assert lit["COL0"][:, 2] == pytest.approx([0.25, 0.0, 0.0], abs=1e-4)


def test_swizzles_masks_negation_and_relative_addresses():
    found = run("MOV o[COL0].yw, -v[COL0].wzy;", COL0=(1.0, 2.0, 3.0, 4.0))
    assert found["COL0"].tolist() == [[0.0, -3.0, 0.0, -2.0]]
    constants = {12: (5.0, 6.0, 7.0, 8.0)}
    found = run("ARL A0.x, v[COL0].x; MOV o[TEX0], c[A0.x + 10];", constants, COL0=[[2.9], [-20.0]])
    assert found["TEX0"].tolist() == [[5.0, 6.0, 7.0, 8.0], [0.0] * 4]
    assert run("MOV o[FOGC].zw, v[COL0];", COL0=(1.0, 2.0, 3.0, 4.0))["FOGC"].tolist() == [3.0]


def test_pairs_read_before_they_write_and_r12_is_the_position():
    found = run(
        "MOV R0, v[COL0]; ADD R0.x, R0, R0 + RCP R1.x, R0.x; MOV o[COL0], R0; MOV o[COL1], R1.x;", COL0=(4.0,)
    )
    assert found["COL0"][0, 0] == 8.0
    assert found["COL1"][0, 0] == 0.25
    assert run("MOV o[HPOS], v[OPOS]; MOV o[COL0], R12;", OPOS=(1.0, 2.0))["COL0"].tolist() == [[1, 2, 0, 1]]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("FOO o[COL0], v[0];", "'FOO' in 'FOO o[COL0], v[0]' is no instruction; give one of ADD"),
        ("MOV o[COL9], v[0];", "cannot be written; write R0 to R11, or o[...]"),
        ("MOV R12, v[0];", "has number 12; give 0 to 11"),
        ("MOV o[COL0], v[16];", "has number 16; give 0 to 15"),
        ("MOV o[COL0], c[192];", "has number 192; give 0 to 191"),
        ("MOV o[COL0], o[COL1];", "cannot be read; read R0 to R12"),
        ("MOV o[COL0], v[0].xyq;", "is no register; give R0 to R12"),
        ("ADD o[COL0], v[0];", "has 1 operands; ADD takes 2"),
        ("MOV A0.x, v[0].x;", "ARL writes A0.x, and nothing else does"),
    ],
)
def test_what_is_no_program_is_refused_in_its_words(text, words):
    with pytest.raises(ValueError) as found:
        vertex_program(text)
    assert words in str(found.value)


def test_inputs_and_constants_that_there_are_not():
    with pytest.raises(ValueError, match="no input 'COL2'; give 0 to 15"):
        run("MOV o[COL0], v[COL0];", COL2=(1.0,))
    with pytest.raises(ValueError, match="no constant 192; give 0 to 191"):
        run("MOV o[COL0], c[0];", {192: (0.0,) * 4})
