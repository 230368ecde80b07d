"""How figures' parameters become sliders and gestures."""

import json
import math

import pytest

from fixedpipe.effects.figures import FIGURES
from fixedpipe.effects.figures.parameters import Choice
from fixedpipe.effects.viewer.controls import control, gesture, is_file

FORMS = {"numbers", "flag", "choice", "text"}


@pytest.fixture(scope="module")
def controls():
    return [
        (figure, name, parameter, control(name, parameter, parameter.kind.show(parameter.default)))
        for figure in FIGURES.values()
        for name, parameter in figure.parameters.items()
        if parameter.offered
    ]


def test_every_parameter_of_every_figure_has_a_control_of_json_values(controls):
    for figure, name, parameter, made in controls:
        assert made["form"] in FORMS, (figure.id, name)
        assert json.loads(json.dumps(made, allow_nan=False)) == made
        assert made["does"] == parameter.does and made["allowed"] == parameter.kind.allowed


def test_sliders_hold_the_figures_own_value_and_only_values_that_there_are(controls):
    for figure, name, parameter, made in controls:
        if made["form"] != "numbers":
            continue
        numbers = [float(part) for part in made["text"].split(",")]
        for number, part in zip(numbers, made["parts"], strict=True):
            assert part["low"] <= number <= part["high"], (figure.id, name)
            assert math.isfinite(part["low"]) and math.isfinite(part["high"])
        for end in ("low", "high"):
            values = [part[end] for part in made["parts"]]
            if any(values) and not is_file(parameter):
                text = ",".join(str(v) for v in values)
                parameter.parse(text, name)


def test_choices_are_the_members_names(controls):
    found = 0
    for _, name, parameter, made in controls:
        if isinstance(parameter.kind, Choice):
            found += 1
            assert [parameter.parse(choice, name) for choice in made["choices"]] == list(
                parameter.kind.members.values()
            )
    assert found


@pytest.mark.parametrize(
    ("figure", "name", "moved"),
    [
        ("F004-4", "light", "light"),
        ("F004-4", "tilt", "lean"),
        ("F004-4", "alpha_x", ""),
        ("F003-1", "turn", "turn"),
        ("H25", "eye", "eye"),
        ("F002-13", "eye", "eye"),
        ("F002-13", "target", ""),
        ("F000-10", "eye", "orbit"),
        ("H13", "light", "lamp"),
        ("F002-11", "light", "light angle"),
    ],
)
def test_what_a_drag_turns(figure, name, moved):
    assert gesture(name, FIGURES[figure].parameters[name].kind) == moved
