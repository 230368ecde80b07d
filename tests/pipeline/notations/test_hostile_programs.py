"""Malformed and hostile texts: a sentence that says where, in bounded memory, read no further than needed."""

import tracemalloc

import pytest

from fixedpipe.pipeline.notations import programs
from fixedpipe.pipeline.notations.programs import MOST_CHARACTERS, parse_program
from fixedpipe.pipeline.notations.tokens import ProgramTextError
from tests.support.hostile_texts import FAMILIES

DIGITS = "9" * 400
TAIL = "\n?? \x00 none of it is read\n"  # characters that no notation uses


def refused(text):
    """The error of a text that is no program."""
    with pytest.raises(ProgramTextError) as caught:
        parse_program(text)
    error = caught.value
    assert 1 <= error.line <= text.count("\n") + 1 and error.column >= 1
    sentence = str(error)
    assert sentence.endswith(".") and len(sentence) < 1000, sentence[:200]
    return error


CASES = {f"{family}: {name}": case for family, cases in FAMILIES.items() for name, case in cases.items()}


@pytest.mark.parametrize(("text", "word"), CASES.values(), ids=CASES)
def test_a_hostile_text_is_refused_by_name_or_a_program(text, word):
    if word is None:
        assert parse_program(text).combiners is not None
    else:
        assert word in str(refused(text))


def test_there_are_as_many_hostile_texts_as_public_programs_were_tried():
    assert len({text for text, _ in CASES.values()}) == len(CASES) >= 77


NUMBERS = {
    "a constant of a pixel shader": f"ps.1.1\ndef c0, {DIGITS}, 0, 0, 1\nmov r0, c0\n",
    "its exponent": "ps.1.1\ndef c0, 1e999, 0, 0, 1\nmov r0, c0\n",
    "a negative one": f"ps.1.1\ndef c0, 0, -{DIGITS}.5, 0, 1\nmov r0, c0\n",
    "one minus": f"ps.1.1\nmov r0, {DIGITS}-v0\n",
    "a constant of combiners": f"!!RC1.0\nconst0 = (0, {DIGITS}, 0, 1);\nout.rgb = const0;\n",
    "a matrix": f"!!TS1.0\ntexture_2d();\noffset_2d(tex0, 1, {DIGITS}, 0, 1);\n",
}


@pytest.mark.parametrize("text", NUMBERS.values(), ids=NUMBERS)
def test_a_number_beyond_a_float_is_a_sentence(text):
    assert "a number beyond 10 to the power of 308" in str(refused(text))


NAMES = {
    "a source": "ps.1.1\nmov r0, t{}\n",
    "a destination": "ps.1.1\nmov r{}, t0\n",
    "a texture's destination": "ps.1.1\ntex t{}\n",
    "a constant": "ps.1.1\ndef c{}, 0, 0, 0, 0\n",
    "an instruction": "ps.1.1\nmov_{} r0, t0\n",
    "a texture instruction": "ps.1.1\ntex_{} t0\n",
    "a version": "ps.1.{}\n",
    "a register": "!!RC1.0\n{{ rgb {{ spare0 = tex{}; }} }}\nout.rgb = zero;\n",
    "a number and a letter": "!!RC1.0\nconst0 = ({}e5, 0, 0, 0);\n",
    "a header": "!!RC{}\n",
    "a stage": "!!TS1.0\ntexture_{}();\n",
}


@pytest.mark.parametrize("text", NAMES.values(), ids=NAMES)
@pytest.mark.parametrize("digits", [5_000, 100_000])
def test_a_name_of_any_length_is_quoted_in_short(text, digits):
    assert "9" * 100 not in str(refused(text.format("9" * digits)))


ENDLESS = {
    "comparisons": ("ps.1.2\ntex t0\n" + "cmp r0, v0.a, t0, v1\n" * 3000, 7),
    "moves": ("ps.1.1\n" + "mov r0, v0\n" * 30_000, 10),
    "dot products of four": ("ps.1.2\ntex t0\n" + "dp4 r0, t0, v0\n" * 3000, 7),
    "general combiners": ("!!RC1.0\n" + "{ rgb { spare0 = tex0; } }\n" * 30_000, 10),
    "texture instructions": ("ps.1.1\n" + "tex t0\n" * 100_000, 3),
    "pairs": ("ps.1.1\nmov r0.rgb, v0\n" + "+ mov r0.a, v0\n" * 30_000, 4),
    "stages": ("!!TS1.0\n" + "nop();\n" * 100_000, 6),
}


@pytest.mark.parametrize(("text", "line"), ENDLESS.values(), ids=ENDLESS)
def test_an_endless_program_ends_at_what_is_too_much(text, line):
    """At the first combiner, unit or stage that no machine has."""
    assert refused(text).line == line


@pytest.mark.parametrize("name", ["moves", "general combiners", "texture instructions", "stages"])
def test_what_comes_after_it_is_not_read(name):
    text, line = ENDLESS[name]
    lines = text.splitlines()[: line + 1]
    assert refused("\n".join(lines) + TAIL).line == line


LONG = {
    "spaces": ("ps.1.1\n", " ", ""),
    "lines": ("!!RC1.0\n", "\n", ""),
    "nothing but spaces": ("", "\t", ""),
    "a comment": ("ps.1.1\n/*", "*", "*/\nmov r0, v0\n"),
    "a comment without an end": ("!!RC1.0\n/*", "/*", ""),
    "comments": ("", "# of the time\n", ""),
    "instructions that do nothing": ("ps.1.1\n", "nop\n", "mov r0, v0\n"),
    "pluses": ("ps.1.1\n", "+", ""),
    "a name": ("ps.1.1\n", "m", ""),
    "a number": ("!!TS1.0\noffset_2d(", "9", ""),
    "parentheses": ("!!RC1.0\n", "(", ""),
    "braces": ("!!RC1.0\n", "{", ""),
    "constants": ("ps.1.1\n", "def c0, 1, 0, 0, 1\n", "mov r0, c0\n"),
    "one line": ("ps.1.1 ", "nop ", "mov r0, v0"),
    "other characters": ("ps.1.1\n", "\u00e9", ""),
    "no header": ("", "x", ""),
    "headers": ("", "!!RC1.0\n", ""),
}


def check_long(name, size):
    """Read a text of ``size`` characters: a program or the notation's error, in a few times its memory."""
    before, repeated, after = LONG[name]
    text = before + repeated * (size // len(repeated)) + after
    tracemalloc.start()
    try:
        parse_program(text)
    except ProgramTextError as error:
        assert len(str(error)) < 1000
    finally:
        _, most = tracemalloc.get_traced_memory()
        tracemalloc.stop()
    assert most < 4 * len(text) + 2_000_000


@pytest.mark.parametrize("name", LONG)
def test_a_long_text_takes_no_more_memory_than_a_few_of_its_own(name):
    check_long(name, 50_000)


def test_a_text_of_ten_megabytes_is_refused_by_its_length():
    for before, repeated, _ in LONG.values():
        text = before + repeated * (10_000_000 // len(repeated))
        error = refused(text)
        assert f"the text has {len(text)} characters" in str(error) and (error.line, error.column) == (1, 1)


def test_of_a_text_of_ten_megabytes_nothing_is_read_and_nothing_is_kept(monkeypatch):
    """Its length is enough. Assumed: a sentence and what raises it take less than 64 KiB; the text itself is
    160 times that, so that a copy, or tokens, of a hundredth of it would show.
    """
    text = "ps.1.1\n" + "mov r0, v0\n" * (10_000_000 // 11)
    for name in ("_SKIPPED", "_DIRECTIVE", "_HEADER", "_SECOND_HEADER"):
        monkeypatch.setattr(programs, name, None)  # whoever reads finds no pattern
    tracemalloc.start()
    try:
        refused_by_length(text)
        _, most = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert most < 64 * 1024


def refused_by_length(text):
    """Without pytest.raises, whose own records would be counted."""
    try:
        parse_program(text)
    except ProgramTextError as error:
        assert (error.line, error.column) == (1, 1) and str(len(text)) in str(error)
    else:
        pytest.fail("ten megabytes were taken")


@pytest.mark.slow
@pytest.mark.parametrize("name", LONG)
def test_the_longest_text_that_is_read_takes_no_more_memory_than_a_few_of_its_own(name):
    check_long(name, MOST_CHARACTERS - 100)
