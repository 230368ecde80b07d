"""Pixel shaders on machines whose general combiners share two constants, as the GeForce 256's do."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given, reject, settings

from fixedpipe.pipeline.commands import Clear, Draw, Mesh
from fixedpipe.pipeline.enums import Register
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.notations.pixel_shader_format import format_pixel_shader
from fixedpipe.pipeline.notations.pixel_shader_textures import ConstantPlace
from fixedpipe.pipeline.notations.programs import parse_program
from fixedpipe.pipeline.notations.tokens import ProgramTextError
from fixedpipe.pipeline.profiles import GEFORCE_3, GEFORCE_256
from fixedpipe.pipeline.state import PassState
from fixedpipe.pipeline.validation.validate import validate_program
from tests.reference import combine
from tests.support.pixel_shaders import NO_FOG, fragments
from tests.support.program_strategies import pixel_shaders

CONST0, CONST1 = Register.CONSTANT_COLOR0, Register.CONSTANT_COLOR1
COLORS = (
    "def c0, 0.2, 0.9, 0.4, 0.7\ndef c1, -0.6, -0.1, -0.8, 0.3\ndef c2, 0.5, 0.35, 1, -0.9\n"
    "def c3, 0.11, 0.22, 0.33, 0.44\n"
)
SOURCES = ("v0", "c0", "c1", "c2", "c0.a", "c1.a", "c2.a")
FRAGMENTS = list(fragments(4))


def computed(program):
    """What combiners compute of a few fragments, by their specification."""
    return [
        combine.combine(
            program.combiners,
            combine.initial_registers(v0, v1, [t0, t1, t2, t3], NO_FOG),
            combine.machine_of(GEFORCE_3),
        )
        for t0, t1, t2, t3, v0, v1 in FRAGMENTS
    ]


def drawn(program, profile):
    """What a machine draws of three colours."""
    mesh = Mesh(
        np.array([[-1.0, -1.0, 0.0], [3.0, -1.0, 0.0], [-1.0, 3.0, 0.0]]),
        colors=np.array([[0.9, 0.1, 0.6, 1.0], [0.2, 0.8, 0.4, 0.3], [0.5, 1.0, 0.0, 0.7]]),
    )
    state = PassState(register_combiners=program.combiners)
    frame = Clear(label="clear", color=(0.0,) * 4), Draw(label="all", mesh=mesh, state=state)
    return execute(frame, profile, 8, 8).framebuffer.color


def reads(text):
    """The constants whose colors, and whose alphas, a text reads. Source: masks and selectors."""
    colors, alphas = set(), set()
    for line in text.splitlines():
        if line.startswith(("mul", "mad", "mov")):
            destination, *sources = line.partition(" ")[2].split(", ")
            for source in sources:
                if source.startswith("c"):
                    if source.endswith(".a") or not destination.endswith(".rgb"):
                        alphas.add(source[:2])
                    if not source.endswith(".a") and not destination.endswith(".a"):
                        colors.add(source[:2])
    return colors, alphas


@pytest.mark.parametrize("mask", ["", ".rgb", ".a"])
@pytest.mark.parametrize("first", SOURCES)
def test_two_instructions_share_two_colors_and_two_alphas_exactly_where_they_read_no_more(first, mask):
    for second, third in product(SOURCES, repeat=2):
        text = f"ps.1.1\n{COLORS}mul r1{mask}, {first}, {second}\nmad r0, r1, {third}, v1\n"
        own = parse_program(text)
        colors, alphas = reads(text)
        if max(len(colors), len(alphas)) <= 2:
            shared = parse_program(text, per_stage_constants=False)
            validate_program(None, shared.combiners, GEFORCE_256)
            assert computed(shared) == computed(own), text
            assert {place.constant for place in shared.constants} == colors_and_alphas(colors, alphas)
            assert all(place.stage is None for place in shared.constants)
        else:
            with pytest.raises(
                ProgramTextError, match=r"is the third of 3 constants that .* \(c\d, c\d, c\d\), and"
            ):
                parse_program(text, per_stage_constants=False)


def colors_and_alphas(colors, alphas):
    return {int(name[1:]) for name in colors | alphas}


@pytest.mark.parametrize(
    "lines",
    [
        "mul r0, v0, c0\nmad r0, r0, c1, c0",
        "mul r0.rgb, v0, c0\n+ mul r0.a, v0, c1\nmad r0.rgb, r0, c1, c0\n+ mad r0.a, r0, c2, c1",
        "mov r0.rgb, c4\n+ mov r0.a, c0\nmul r0, r0, v0",
        "mul r1, v0, c0\nadd r0, r1, c5",
    ],
)
def test_a_machine_draws_the_same_with_constants_of_its_own(lines):
    """c4 and c5 are of both signs: in two words, and in one."""
    both = "def c4, 1, -0.5, -1, 0.5\ndef c5, 0.3, -0.4, 0.1, 0.5\n"
    text = f"ps.1.1\n{COLORS}{both}{lines}\n"
    shared, own = parse_program(text, per_stage_constants=False), parse_program(text)
    with_own = GEFORCE_256.changed(per_stage_constants=True)
    assert np.array_equal(drawn(shared, GEFORCE_256), drawn(own, with_own))
    assert np.array_equal(drawn(shared, GEFORCE_256), drawn(own, GEFORCE_3))
    assert len(np.unique(drawn(own, GEFORCE_3))) > 8


@settings(deadline=None, max_examples=60)
@given(pixel_shaders())
def test_random_programs_compute_the_same_and_are_written_and_read_back(text):
    try:
        own = parse_program(text)
    except ProgramTextError:
        reject()
    try:
        shared = parse_program(text, per_stage_constants=False)
    except ProgramTextError as error:
        assert "share two" in str(error) and "negative" in str(error)  # two constants alone would fit
        return
    assert computed(shared) == computed(own)
    assert (shared.notes, shared.colors, shared.defined) == (own.notes, own.colors, own.defined)
    try:
        written = format_pixel_shader(shared)
    except ValueError:
        with pytest.raises(ValueError, match=r"would change if it were|refused|cannot say"):
            format_pixel_shader(own)
        return
    read = parse_program(written, per_stage_constants=False)
    assert (read.combiners, read.constants) == (shared.combiners, shared.constants)


def test_a_constant_of_both_signs_in_two_words_counts_twice():
    text = f"ps.1.1\n{COLORS}def c4, 1, -1, 0, 1\nmul r0, v0, c4\nmad r0, r0, c0, c3\n"
    parse_program(text)
    with pytest.raises(ProgramTextError) as caught:
        parse_program(text, per_stage_constants=False)
    assert (caught.value.line, str(caught.value).partition(": ")[2]) == (
        8,
        "the color of c0 is the third of 4 constants that the program reads (c4 where it is positive, c4 "
        "where it is negative, c0, c3), and the machine's general combiners share two. Read fewer, or choose "
        "a machine with per-stage constants.",
    )


def test_a_color_and_an_alpha_may_be_of_two_constants():
    text = f"ps.1.1\n{COLORS}mul r0.rgb, v0, c0\n+ mul r0.a, v0, c1\nmul r0.rgb, r0, c2\n+ mov r0.a, r0\n"
    program = parse_program(text, per_stage_constants=False)
    assert program.constants == (
        ConstantPlace(0, None, CONST0, "rgb"),
        ConstantPlace(1, None, CONST0, "a"),
        ConstantPlace(2, None, CONST1),
    )
    assert program.combiners.constant_color0 == (0.2, 0.9, 0.4, 0.3)


XBOX = "xps.1.1\ndef c7, 0.2, 0.9, 0.4, 0.7\ndef c3, 0.6, 0.1, 0.8, 0.3\n"


@pytest.mark.parametrize("final", ["", "xfc c3, r0, zero, zero, zero, zero, c7.a\n"])
def test_an_xbox_program_shares_two_constants(final):
    text = f"{XBOX}mul r0, v0, c3\nmad r0, r0, c7, c3\n{final}"
    own, shared = parse_program(text), parse_program(text, per_stage_constants=False)
    validate_program(None, shared.combiners, GEFORCE_256.changed(combiner_flags=True))
    assert shared.constants == (ConstantPlace(3, None, CONST0), ConstantPlace(7, None, CONST1))
    assert computed(shared) == computed(own)


def test_an_xbox_program_s_third_constant_is_refused():
    text = f"{XBOX}mul r0, v0, c3\nmul r0, r0, c7\nxfc c5, r0, zero, zero, zero, zero, r0.a\n"
    parse_program(text)
    with pytest.raises(
        ProgramTextError, match=r"c5 is the third of 3 constants that the program reads \(c3, c7, c5\)"
    ):
        parse_program(text, per_stage_constants=False)
