"""Texts read a second time, by grammars that are data: the same ones are programs, and mean the same."""

import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fixedpipe.pipeline.notations.register_combiner_format import format_program
from fixedpipe.pipeline.notations.tokens import ProgramTextError
from tests.support.combiner_strategies import register_combiners
from tests.support.corpus import INDEX, text_of
from tests.support.grammar import Grammar, RejectedError, part
from tests.support.program_strategies import pixel_shaders, texture_shaders
from tests.support.second_reading import READINGS


def attempt(read, text, refusal):
    """What ``read`` makes of a text, or None, and the sentence where it refuses it."""
    try:
        return read(text), ""
    except refusal as error:
        return None, str(error)


def agree(text, notation):
    """Whether both readings take the text, which then means the same to both."""
    parse, again = READINGS[notation]
    found, sentence = attempt(parse, text, ProgramTextError)
    expected, reason = attempt(again, text, RejectedError)
    assert (found is None) == (expected is None), f"{sentence or 'accepted'} / {reason or 'accepted'}\n{text}"
    assert found == expected, text
    return found is not None


# ------------------------------------------------------------------------------------ texts spoiled at random

_WORDS = re.compile(r"\s+|[A-Za-z0-9_.!]+|.", re.DOTALL)
# What takes another word's place: words of the notation, right where they are and wrong elsewhere.
VOCABULARY = {
    "!!RC1.0": (
        "rgb alpha spare0 spare1 tex0 tex3.a col0.b col1 fog fog.a zero one one.a const0 const1 discard "
        "final_product color_sum out.rgb out.a expand half_bias unsigned unsigned_invert sum mux lerp "
        "scale_by_two scale_by_four scale_by_one_half bias_by_negative_one_half clamp_color_sum { } ( ) ; , "
        ". * + = - 1 0.5 -.5 1. 9e9 tex4 !!RC1.0 # // /* */"
    ),
    "!!TS1.0": (
        "tex0 tex1 tex2 tex3 expand nop texture_2d texture_cube_map pass_through cull_fragment offset_2d "
        "offset_rectangle_scale dependent_ar dot_product_2d_1of2 dot_product_2d_2of2 dot_product_3d_1of3 "
        "dot_product_cube_map_and_reflect_cube_map_eye_from_qs_2of3 GEQUAL_TO_ZERO LESS_THAN_ZERO "
        "dot_product_reflect_cube_map_const_eye_1of3 dot_product_depth_replace_2of2 "
        "( ) ; , 1 -0.5 .25 1. 1e5 !!TS1.0 # // /* */"
    ),
    "ps": (
        "def tex texcoord texkill texbem texm3x2pad texm3x3spec texdp3 nop mov add_x2 sub_sat mul_d2_sat "
        "mad_sat_x4 dp3 dp4 lrp cnd cmp mov_x8 def_sat nop_x2 t0 t3 t4 r0 r1 r2 v0 v2 c0 c7 c8 r0.a r0.b "
        "t0.rgb r1.xyzw v1_bx2 t1_bias.a c0.aaaa r0.bbb t0.g r1.rg c0.aa v0.ba -r0 1-r0 "
        "1.0-t1 2-t1 1-t0_bx2 , + - 0.5 1e-3 1e f 1f .5 ps.1.1 ps_1_3 ps.1.4 ; // /* */ # X MOV"
    ),
}


@st.composite
def spoiled(draw, texts, notation):
    """A text with one to three of its words dropped, doubled, exchanged, or another in their place."""
    words = _WORDS.findall(draw(texts))
    others = VOCABULARY[notation].split()
    for _ in range(draw(st.integers(1, 3))):
        places = [k for k, word in enumerate(words) if not word.isspace()]
        if not places:
            break
        at, other = draw(st.sampled_from(places)), draw(st.sampled_from(places))
        change = draw(st.sampled_from(("drop", "double", "exchange", "replace", "insert", "newline")))
        if change == "drop":
            words[at] = ""
        elif change == "double":
            words[at] += f" {words[at]}"
        elif change == "exchange":
            words[at], words[other] = words[other], words[at]
        elif change == "replace":
            words[at] = draw(st.sampled_from(others))
        elif change == "insert":
            words[at] += draw(st.sampled_from(("", " "))) + draw(st.sampled_from(others))
        else:
            words[at] += "\n"
    return "".join(words)


COMBINERS = register_combiners(max_stages=3, units=4, per_stage_constants=True).map(format_program)
TEXTS = {"!!RC1.0": COMBINERS, "!!TS1.0": texture_shaders(), "ps": pixel_shaders(most=3)}


@pytest.mark.parametrize("notation", TEXTS)
def test_random_programs_mean_the_same(notation):
    @settings(max_examples=25)
    @given(TEXTS[notation])
    def check(text):
        assert agree(text, notation)

    check()


def spoil(notation, count):
    taken = []

    @settings(max_examples=count)
    @given(spoiled(TEXTS[notation], notation))
    def check(text):
        taken.append(agree(text, notation))

    check()
    return taken


@pytest.mark.parametrize("notation", TEXTS)
def test_spoiled_programs_are_refused_by_both_or_mean_the_same(notation):
    taken = spoil(notation, 100)
    assert any(taken) and not all(taken)


@pytest.mark.slow
@pytest.mark.parametrize("notation", TEXTS)
def test_many_spoiled_programs_are_refused_by_both_or_mean_the_same(notation):
    spoil(notation, 6000)


# ------------------------------------------------------------------------------------ programs of the corpus

ENDINGS = {".rc": "!!RC1.0", ".ts": "!!TS1.0", ".psh": "ps"}
WRITTEN = [name for name in INDEX if "." + name.partition(".")[2] in ENDINGS]


def pieces(name):
    """(text, notation) of a program's file; a text of two notations has two."""
    text, notation = text_of(name), ENDINGS["." + name.partition(".")[2]]
    if notation == "!!TS1.0" and "!!RC1.0" in text:
        at = text.index("!!RC1.0")
        return [(text[:at], notation), (text[at:], "!!RC1.0")]
    return [(text, notation)]


@pytest.mark.parametrize("name", WRITTEN)
def test_a_program_of_the_corpus_means_the_same(name):
    """What a parser refuses for the state's sake, a pixel shader's combiners, is no matter of reading."""
    taken = all([agree(text, notation) for text, notation in pieces(name)])
    assert taken or "refused" in INDEX[name]


def spoiled_once(text, notation, step):
    """A text with each of its words dropped, doubled, exchanged with the next, and every ``step``-th word of
    the vocabulary in its place and behind it.
    """
    words, others = _WORDS.findall(text), VOCABULARY[notation].split()
    places = [k for k, word in enumerate(words) if not word.isspace()]
    for n, at in enumerate(places):
        word, following = words[at], places[min(n + 1, len(places) - 1)]
        changes = [{at: ""}, {at: f"{word} {word}"}, {at: words[following], following: word}]
        changes += [{at: other} for other in others[n % step :: step]]
        changes += [{at: f"{word} {other}"} for other in others[n % step :: step]]
        for change in changes:
            yield "".join(change.get(k, word) for k, word in enumerate(words))


def spoil_every_word(name, step):
    return [agree(t, notation) for text, notation in pieces(name) for t in spoiled_once(text, notation, step)]


ALL_CONSTRUCTS = ("final_product.rc", "scales.rc", "lerp_and_more.rc", "reflect_far_eye.ts", "ripple.ts",
                  "written_loosely.psh", "toon_by_cmp.psh", "reflection_far_eye.psh")  # fmt: skip


@pytest.mark.parametrize("name", ALL_CONSTRUCTS)
def test_every_word_of_a_program_spoiled_is_refused_by_both_or_means_the_same(name):
    taken = spoil_every_word(name, 11)
    assert any(taken) and not all(taken)


@pytest.mark.slow
@pytest.mark.parametrize("name", WRITTEN)
def test_every_word_spoiled_by_every_other_is_refused_by_both_or_means_the_same(name):
    spoil_every_word(name, 2)


SPOILED_THEN = {
    "a definition with a modifier": ("ps", "ps.1.1\ndef_sat c0, 1, 0, 0, 1\nmov r0, c0\n", False),
    "a definition with a mask": ("ps", "ps.1.1\ndef.rgb c0, 1, 0, 0, 1\nmov r0, c0\n", False),
    "nop as the second of a pair": ("ps", "ps.1.1\nmov r0.rgb, v0\n+ nop\n", False),
    "nop as the first": ("ps", "ps.1.1\nmov r0, v0\nnop\n+ mov r0.a, v1\n", False),
    "a sign that becomes a k in lower case": ("ps", "ps.1.1\ntex\u212aill t0\nmov r0, v0\n", False),
    "a hash in a comment": ("ps", "ps.1.1\n/*\n# not for the preprocessor\n*/\nmov r0, v0\n", True),
}


@pytest.mark.parametrize(("notation", "text", "taken"), SPOILED_THEN.values(), ids=SPOILED_THEN)
def test_what_the_two_once_read_otherwise(notation, text, taken):
    assert agree(text, notation) == taken


# ------------------------------------------------------------------------------------ the recogniser itself


def test_a_grammar_gives_the_tree_of_a_text():
    sums = Grammar(
        'sum = term { "+" term } . term = [ "-" ] /[0-9]+/ | "(" sum ")" .', r"\s+|(?P<word>[0-9]+|.)"
    )
    assert sums.tree("1 +-2") == ("sum", ("term", "1"), "+", ("term", "-", "2"))
    inner = part(part(sums.tree("(3+4)"), "term"), "sum")
    assert inner == ("sum", ("term", "3"), "+", ("term", "4"))


@pytest.mark.parametrize("text", ["", "1 +", "1 2", "(1", "1)", "--1", "x"])
def test_what_a_grammar_does_not_make_is_rejected(text):
    sums = Grammar(
        'sum = term { "+" term } . term = [ "-" ] /[0-9]+/ | "(" sum ")" .', r"\s+|(?P<word>[0-9]+|.)"
    )
    with pytest.raises(RejectedError):
        sums.tree(text)
