"""Axes of a grid, from the texts of --vary."""

import pytest

from fixedpipe.effects.figures.parameters import DIRECTION_KIND, Choice, Flag, Number, Whole
from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.sweeps.grid import MOST_POINTS, Axis, axis, bits_axis, kind_of_texts, named, points

SHARE = Number(0.0, 1.0)


@pytest.mark.parametrize(
    ("text", "kind", "values"),
    [
        ("0:1:5", SHARE, (0.0, 0.25, 0.5, 0.75, 1.0)),
        ("1:0:2", SHARE, (1.0, 0.0)),
        ("0:0.4:5", SHARE, (0.0, 0.1, 0.2, 0.3, 0.4)),
        ("0.1,0.3", SHARE, (0.1, 0.3)),
        ("0.5", SHARE, (0.5,)),
        ("4:7", Whole(1, 9), (4, 5, 6, 7)),
        ("7:5", Whole(1, 9), (7, 6, 5)),
        ("4:12:3", Whole(1, 64), (4, 8, 12)),
        ("2:8", Whole(2, 64, even=True), (2, 4, 6, 8)),
        ("4:32", Whole(4, 64, power=True), (4, 8, 16, 32)),
        ("a, b", Choice({"A": 1, "B": 2}), ("A", "B")),
        ("yes,no", Flag(), ("True", "False")),
        ("1,0,0:0,1,0", DIRECTION_KIND, ("1,0,0", "0,1,0")),
        ("1,0,1:-1,0,1:3", DIRECTION_KIND, None),
    ],
)
def test_values_of_a_text(text, kind, values):
    found = axis("x", text, kind, "F's x")
    assert found.name == "x" and len(found.values) == len(found.texts)
    if values is None:  # along the arc
        assert found.texts[0] == "1,0,1" and found.texts[2] == "-1,0,1"
        x, y, z = kind.parse(found.texts[1])
        assert abs(x) < 1e-9 and y == 0.0 and z == pytest.approx(2**0.5)
    else:
        assert found.values == values


def test_every_text_reads_as_its_value():
    found = axis("x", "0.1:0.7:13", SHARE, "F's x")
    assert tuple(SHARE.parse(text) for text in found.texts) == found.values


@pytest.mark.parametrize(
    ("text", "kind", "said"),
    [
        ("0:1", SHARE, r"in how many steps; give 0:1:N"),
        ("0:2:3", SHARE, r"F's x is '2'; give a number from 0 to 1"),
        ("0:nan:3", SHARE, r"F's x is 'nan'; give a number from 0 to 1"),
        ("0:1:1", SHARE, r"has '1' steps; give a whole number from 2 to"),
        (f"0:1:{MOST_POINTS + 1}", SHARE, r"steps; give a whole number from 2 to 10,000,000"),
        ("0:1:1e6", SHARE, r"has '1e6' steps"),
        ("0:0.5:1:4", SHARE, r"give NAME=FROM:TO:N"),
        ("4:6:9", Whole(1, 9), r"9 values and only 3 that differ"),
        ("4,4", Whole(1, 9), r"2 values and only 1 that differ"),
        (f"0:{10**15}", Whole(0, 10**18), r"more than 10,000,000 numbers"),
        ("x", SHARE, r"F's x is 'x'; give a number"),
        ("1,0,1:-1,0,-1:3", DIRECTION_KIND, r"no one arc between opposite directions"),
        ("C", Choice({"A": 1, "B": 2}), r"F's x is 'C'"),
    ],
)
def test_what_is_no_axis_is_refused(text, kind, said):
    with pytest.raises(Refusal, match=said):
        axis("x", text, kind, "F's x")


@pytest.mark.parametrize("text", ["3:8", "4:17", "8.5"])
def test_widths_that_there_are_not(text):
    with pytest.raises(Refusal, match=r"width of every number is .*; give a whole number from 4 to 16"):
        bits_axis(text)


def test_names_are_given_once():
    assert named(["a=1:2:3", "b = 4:5"]) == {"a": "1:2:3", "b": "4:5"}
    with pytest.raises(Refusal, match="--vary names a twice; give it once"):
        named(["a=1:2:3", "a=5"])
    for wrong in ("a", "=3", "a="):
        with pytest.raises(Refusal, match=r"--vary is '.*'; give NAME=FROM:TO:N"):
            named([wrong])


def test_a_grid_that_is_too_large_is_refused_before_it_is_made():
    many = Axis("a", tuple(range(10_000)), ())
    assert points([many, Axis("b", (1, 2), ())]) == 20_000
    with pytest.raises(Refusal, match=r"The grid has 1,000,000,000,000 points; give fewer values of a or b"):
        points([many, Axis("b", many.values, ()), Axis("c", many.values, ())])


def test_values_of_scripts_are_what_they_look_like():
    assert kind_of_texts("1:4") == kind_of_texts("1,2,4") == kind_of_texts("0:10:3") == Whole()
    assert kind_of_texts("0:1:3") == kind_of_texts("0.5,2") == Number()
    assert kind_of_texts("near,far").parse("near") == "near"
