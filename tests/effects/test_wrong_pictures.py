"""Wrong pictures are refused by the figures' own checks (tests/wrong_pictures.py).

``wrong_pictures.toml`` names, for each figure, the wrong pictures that pass today, and what is missing. A new
one fails here; so does one that is refused by now and is still listed. Figures that were never measured are
named there as well.
"""

import tomllib
from dataclasses import replace
from pathlib import Path

import pytest

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.figures import FIGURES
from tests import wrong_pictures
from tests.support.sample import sampled, slow_unless
from tests.wrong_pictures import LEAST, NAMED, Mutation, first_failed, named_failed, results_of

_FILE = tomllib.loads(Path(__file__).with_name("wrong_pictures.toml").read_text())
NOT_MEASURED, SURVIVORS = set(_FILE["not_measured"]), _FILE["survivors"]
# Those whose wrong pictures take seconds.
CHEAP = ("F001-14", "F003-4")


IN_TURN = sampled(NAMED)


@pytest.mark.parametrize(
    ("figure_id", "name"), [pytest.param(*each, marks=slow_unless(each in IN_TURN)) for each in NAMED]
)
def test_a_wrong_picture_that_once_passed_is_refused(figure_id, name):
    failed = named_failed(figure_id, name)
    assert failed is not None and not failed.startswith("the checks stop"), failed


@pytest.mark.parametrize(
    "figure_id", [pytest.param(i, marks=[pytest.mark.slow] * (i not in CHEAP)) for i in SURVIVORS]
)
def test_the_wrong_pictures_that_pass_are_those_that_are_listed(figure_id):
    survived = {name for name, failed in results_of(figure_id) if failed is None}
    assert survived == set(SURVIVORS[figure_id])


def test_each_figure_was_measured_or_is_named_as_one_that_was_not():
    assert set(CHEAP) <= set(SURVIVORS)
    assert not NOT_MEASURED & set(SURVIVORS)
    assert set(SURVIVORS) | NOT_MEASURED == set(FIGURES)
    assert all(missing for figure in SURVIVORS.values() for missing in figure.values())


def test_the_right_picture_is_not_refused():
    figure = FIGURES["F001-14"]
    assert first_failed(figure, figure.machines[0]) is None


def test_a_change_that_is_not_seen_is_no_wrong_picture(monkeypatch):
    darker = Mutation("darker", window=lambda window: window - LEAST)
    dark = Mutation("dark", window=lambda window: 0.5 * window)
    monkeypatch.setattr(wrong_pictures, "mutations_of", lambda figure, machine: [darker, dark])
    assert [name for name, _ in results_of("F001-14")] == ["dark"]


def test_checks_that_stop_have_refused():
    def stops(figure, renderer):
        yield Check("first", 1.0, at_most=1.0, on=Answer.IDEAL, reason="")
        raise ZeroDivisionError("nothing is lit")

    figure = replace(FIGURES["F001-14"], acceptance=stops)
    assert first_failed(figure, figure.machines[0]) == "the checks stop: ZeroDivisionError: nothing is lit"


def test_figures_that_a_manifest_has_are_not_measured_again(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(wrong_pictures, "results_of", lambda figure_id: [("dark", None), ("flat", "a check")])
    monkeypatch.setattr("sys.argv", ["", "F001-14", "--manifest", str(tmp_path / "m")])
    assert wrong_pictures.main()
    monkeypatch.setattr(wrong_pictures, "results_of", lambda figure_id: pytest.fail("it was measured again"))
    assert wrong_pictures.main()
    expected = [
        "F001-14: dark: SURVIVED",
        "F001-14: flat: a check",
        "F001-14: 1 of 2 wrong pictures are refused",
    ]
    assert capsys.readouterr().out.splitlines() == expected * 2
