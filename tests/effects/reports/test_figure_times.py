"""How long figures took here: what is said of those to come."""

import json
from types import SimpleNamespace

import pytest

from fixedpipe.effects.figures import costs
from fixedpipe.effects.reports import figure_times
from fixedpipe.effects.reports.figure_times import OwnTimes, read_times

FIGURES = [SimpleNamespace(id=name, machines=("A", "B")) for name in ("one", "two")]
MACHINES = {"one": ("A", "B"), "two": ("A", "B")}


@pytest.fixture(autouse=True)
def elsewhere(monkeypatch):
    """Each figure took 10 and 30 seconds on another computer."""
    seconds = {"one": 10.0, "two": 30.0}
    monkeypatch.setattr(costs, "SECONDS", seconds)


def test_what_was_measured_here_counts_and_gives_the_others_its_speed():
    assert OwnTimes().of_whole(FIGURES, MACHINES) == 40.0
    assert OwnTimes(whole={"one": 5.0}).of_whole(FIGURES, MACHINES) == 5.0 + 15.0
    assert OwnTimes(whole={"one": 5.0, "two": 7.0}).of_whole(FIGURES, MACHINES) == 12.0
    assert OwnTimes(whole={"one": 5.0}).of_whole(FIGURES, {**MACHINES, "one": ("A",)}) == 2.5 + 15.0


def test_where_nothing_was_measured_the_first_rounds_speed_counts():
    assert OwnTimes().of_whole(FIGURES, MACHINES, 0.5) == 20.0
    assert OwnTimes(first={"one": 1.0}).of_first(FIGURES) == pytest.approx(1.0 + 3.0)


def test_times_are_kept_with_those_of_other_figures(tmp_path):
    assert not read_times(None).whole and not read_times(tmp_path / "none").whole
    OwnTimes({"one": 1.0}, {"one": 5.0}).write(tmp_path / "results")
    OwnTimes({}, {"one": 6.0, "two": 7.0}).write(tmp_path / "results")
    found = read_times(tmp_path / "results")
    assert (found.first, found.whole) == ({"one": 1.0}, {"one": 6.0, "two": 7.0})
    assert found.knows(FIGURES) and not OwnTimes(whole={"one": 1.0}).knows(FIGURES)


@pytest.mark.parametrize(
    "text",
    ["", "[]", '{"whole": 3}', '{"whole": {"one": "x"}}', json.dumps({"whole": {"one": -1.0, "two": 1e9}})],
)
def test_a_file_of_other_content_is_no_time(tmp_path, text):
    (tmp_path / figure_times._FILE).write_text(text)
    assert read_times(tmp_path).whole == {}
