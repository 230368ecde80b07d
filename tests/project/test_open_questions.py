"""docs/open-questions.md is what the rules, the captures' accepted counts and the machine's functions say."""

import ctypes
import random
import re
import subprocess
from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest

from fixedpipe.effects.arithmetic.rule import single_of
from fixedpipe.effects.arithmetic.rules import RULES
from fixedpipe.effects.conformance.redraw import known_suites
from fixedpipe.effects.emulators.sources import FOLDER
from tests import open_questions
from tests.emulators.c99 import OPTIONS, compiler
from tests.open_questions import ANSWERS_C, MADE, ROWS
from tests.reference import lighting_unit

COUNTS = open_questions.accepted()


def test_the_page_is_up_to_date():
    assert open_questions.PAGE.read_text() == open_questions.page(), "python -m tests.open_questions"


def test_the_shader_is_the_translation_of_the_c():
    assert open_questions.ANSWERS_GLSL.read_text() == open_questions.answers_glsl()


def test_there_are_twelve_rows_and_each_is_whole():
    assert len(ROWS) == 12 == len({row.title for row in ROWS})
    for row in ROWS:
        assert row.confirmed and row.answer and row.formula and row.numbers and row.captures
        assert row.rules or row.made
        assert row.asked is None or re.search(r"github\.com/xq?emu.*/\d+$", row.asked[1])
    assert set(MADE) == {name for row in ROWS for name in row.made}


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.title)
def test_a_row_names_captures_that_are_redrawn_exactly(row):
    suites = known_suites()
    for capture in row.captures:
        cases = open_questions.cases_of(capture, COUNTS)
        assert cases, capture
        for name in cases:
            suite, _, case = name.partition("/")
            assert case in suites[suite].cases
            equal, compared = COUNTS[name]
            assert equal == compared > 0, name


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.title)
def test_a_row_s_rules_are_measured_or_have_a_source(row):
    for id_ in row.rules:
        rule = RULES[id_]
        assert "Measured" in rule.evidence or "Source" in rule.evidence, id_
        assert rule.captures, id_


def functions_of(text):
    """(name, number of parameters) of a header's functions that its page names."""
    found = re.findall(r"static inline \w+ (nv2a_\w+)\(([^)]*)\)", text)
    return {name: parameters.count(",") + 1 for name, parameters in found if name in MADE}


@pytest.fixture(scope="module")
def answers(tmp_path_factory):
    """The functions of nv2a_answers.h, compiled."""
    if compiler() is None:
        pytest.skip("there is no C compiler")
    folder = tmp_path_factory.mktemp("answers")
    found = functions_of(ANSWERS_C.read_text())
    wrappers = "".join(
        f"uint32_t call_{name}({', '.join(f'uint32_t p{k}' for k in range(count))}) "
        f"{{ return (uint32_t){name}({', '.join(f'p{k}' for k in range(count))}); }}\n"
        for name, count in found.items()
    )
    (folder / "calls.c").write_text(f'#include "nv2a_answers.h"\n{wrappers}')
    includes = [f"-I{FOLDER}", f"-I{ANSWERS_C.parent}"]
    options = [*OPTIONS, "-Wno-sign-conversion", "-shared", "-fPIC", *includes]
    subprocess.run([compiler(), *options, "-o", folder / "a.so", folder / "calls.c"], check=True)
    library = ctypes.CDLL(str(folder / "a.so"))
    assert set(found) == set(MADE)
    calls = SimpleNamespace(**{name: getattr(library, f"call_{name}") for name in found})
    for function in vars(calls).values():
        function.restype = ctypes.c_uint32
    return calls


def lighting_numbers(chance, count):
    """Singles of 14 bits as patterns: near one, zeros among them."""
    words = []
    for _ in range(count):
        exponent = chance.randrange(118, 134)
        words.append(0 if chance.random() < 0.05 else chance.getrandbits(1) << 31 | exponent << 23)
        words[-1] |= (chance.getrandbits(13) << 10) * (words[-1] != 0)
    return words


@pytest.mark.parametrize("name", [name for name, made in MADE.items() if made.kind == "single"])
def test_the_c_of_a_light_is_the_machine_s(answers, name):
    made, chance = MADE[name], random.Random(name)
    seen = set()
    for _ in range(3000):
        words = lighting_numbers(chance, len(made.inputs))
        found = getattr(answers, name)(*words)
        expected = made.compute(*(np.asarray(single_of(word)) for word in words))
        value = found if made.output == "int" else single_of(found)
        assert value == float(expected), [hex(word) for word in words]
        seen.add(value)
    assert len(seen) > 1


def test_a_light_reaches_its_range_and_not_a_bit_further(answers):
    for word in (0x3F800000, 0x40A00000, 0x447A0C00):
        assert [answers.nv2a_light_reaches(word, word + d) for d in (-0x400, 0, 0x400)] == [1, 1, 0]


def test_the_cone_is_the_specification_s():
    """Of the executable specification, which is in fractions."""
    chance = random.Random(5)
    for _ in range(300):
        words = lighting_numbers(chance, 5)
        s, x, a, b, c = (Fraction(single_of(word)) for word in words)
        above = lighting_unit.plus_scalar(x, a)
        below = lighting_unit.multiply_add(b, x, c, lighting_unit.LIGHTING)
        found = open_questions.cone(*(np.asarray(float(v)) for v in (s, x, a, b, c)))
        if x < 0 or above <= 0:
            assert float(found) == 0
        elif below != 0:
            reciprocal = lighting_unit.lighting_reciprocal(below)
            expected = lighting_unit.times(lighting_unit.times(s, above), reciprocal)
            assert float(found) == float(expected)


def test_the_c_of_points_and_flat_vertices_is_the_machine_s(answers):
    for size in (1, 2, 3, 8, 12, 26):
        for dx in range(-size - 2, size + 3):
            found = answers.nv2a_point_covers(dx & 0xFFFFFFFF, -size & 0xFFFFFFFF, size)
            assert found == int(open_questions.point_covers(dx, -size, size)), (dx, size)
    for kind in range(4, 10):
        for k in range(20):
            for first in (0, 1):
                expected = open_questions.flat_vertex(kind, k, first)
                assert answers.nv2a_flat_vertex(kind, k, first) == expected, (kind, k, first)
