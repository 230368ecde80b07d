"""Every program that the tests hold as text, written in other notations and read back."""

from collections import Counter
from functools import cache

from fixedpipe.pipeline.notations.pixel_shader_format import format_pixel_shader
from fixedpipe.pipeline.notations.programs import parse_program
from fixedpipe.pipeline.notations.register_combiner_format import format_program
from fixedpipe.pipeline.notations.texture_shaders import format_stages
from tests.pipeline.notations.test_pixel_shaders import without_meanings
from tests.support.programs_in_tests import programs_in_tests


@cache
def programs():
    return programs_in_tests()


def test_the_tests_have_programs_of_every_notation():
    found = Counter(notation for program in programs().values() for notation in program.notations)
    assert min(found[name] for name in ("ps.1.1", "ps.1.3", "!!RC1.0", "!!TS1.0", "NV2A registers")) >= 5


def test_combiners_written_as_rc_read_back_as_the_same_state():
    written = 0
    for text, program in programs().items():
        if program.combiners is None:
            continue
        try:
            found = format_program(program.combiners)
        except ValueError as error:
            assert "The notation has no word for" in str(error), text
            continue
        assert parse_program(found).combiners == without_meanings(program.combiners), text
        written += 1
    assert written >= 60


def test_texture_shaders_written_as_ts_read_back_as_the_same_state():
    of = {text: program for text, program in programs().items() if program.texture_shader}
    for text, program in of.items():
        assert (
            parse_program(format_stages(program.texture_shader)).texture_shader == program.texture_shader
        ), text
    assert len(of) >= 40


def test_every_pixel_shader_is_written_as_one():
    """``format_pixel_shader`` itself refuses what does not read back as the very same state."""
    of = [p for p in programs().values() if p.notations[0].startswith("ps.")]
    for program in of:
        assert format_pixel_shader(program)
    assert len(of) >= 40


def test_other_programs_are_written_as_pixel_shaders_or_refused_in_a_sentence():
    outcomes = Counter()
    for text, program in programs().items():
        if program.notations[0].startswith("ps."):
            continue
        try:
            written = format_pixel_shader(program)
        except ValueError as error:
            assert str(error).endswith(".") and str(error)[0].isupper(), text
            outcomes[str(error)[:20]] += 1
        else:
            assert parse_program(written).combiners is not None
            outcomes["written"] += 1
    assert outcomes["written"] >= 7 and outcomes["The program has text"] >= 5, outcomes
