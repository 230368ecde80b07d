"""Small words of sentences: at their edges, where a sentence would read oddly."""

import pytest

from fixedpipe.pipeline.enums import BlendEquation, DepthFormat
from fixedpipe.pipeline.messages import count, depth_words, listed, nearest_power_of_two, quoted, shown


def test_a_long_value_is_shown_by_its_beginning():
    assert shown("x" * 78) == repr("x" * 78)
    assert shown("x" * 79) == "'" + "x" * 76 + "..."


def test_names_are_in_the_enum_s_order_and_none_is_said():
    assert listed((BlendEquation.MAX, BlendEquation.FUNC_ADD)) == "FUNC_ADD, MAX"
    assert quoted(["b", "a"]) == "'b', 'a'"
    assert listed(()) == quoted(()) == "none"


def test_a_noun_agrees_with_its_number():
    assert [count(n, "level") for n in (0, 1, 2)] == ["0 levels", "1 level", "2 levels"]
    assert [count(n, "vertex", "vertices") for n in (1, 3)] == ["1 vertex", "3 vertices"]


@pytest.mark.parametrize(
    ("edge", "power"), [(1, 1), (2, 2), (3, 4), (5, 4), (6, 8), (47, 32), (48, 64), (64, 64)]
)
def test_the_nearest_power_of_two_is_the_upper_of_two_as_near(edge, power):
    assert nearest_power_of_two(edge) == power


def test_float_depths_are_called_by_their_format():
    assert {form: depth_words(form) for form in DepthFormat} == {
        DepthFormat.FIXED_16: "16 bits of depth",
        DepthFormat.FIXED_23: "23 bits of depth",
        DepthFormat.FIXED_24: "24 bits of depth",
        DepthFormat.FLOAT_16: "FLOAT_16 depths",
        DepthFormat.FLOAT_24: "FLOAT_24 depths",
    }
    assert depth_words(24) == "24 bits of depth" and depth_words(-16) == "FLOAT_16 depths"
