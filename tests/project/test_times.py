"""What tests take: a history of runs, in which a package that became slower is named."""

import json

import pytest

from tests.support import times


@pytest.fixture
def history(tmp_path, monkeypatch):
    """The file of a history with three runs."""
    monkeypatch.setattr(times, "_processor", lambda: "this one")
    path = tmp_path / "kept" / "times.jsonl"
    for seconds in (20.0, 30.0, 22.0):
        assert times.remember(path, {"tests/raster": seconds, "tests/foreign": 5.0}) == []
    return path


def test_each_run_is_a_line(history):
    runs = [json.loads(line) for line in history.read_text().splitlines()]
    assert [run["packages"]["tests/raster"] for run in runs] == [20.0, 30.0, 22.0]
    assert {run["processor"] for run in runs} == {"this one"}


def test_a_package_that_became_slower_is_named(history):
    said = times.remember(history, {"tests/raster": 34.0, "tests/foreign": 20.0, "tests/new": 99.0})
    assert said == ["tests/raster took 34 s; 22 s is usual of 3 runs before."]
    assert times.remember(history, {"tests/raster": 32.0}) == []


def test_runs_on_another_processor_are_not_compared(history, monkeypatch):
    monkeypatch.setattr(times, "_processor", lambda: "another")
    assert times.remember(history, {"tests/raster": 99.0}) == []


def test_what_is_no_line_of_a_history_is_left_alone(history):
    history.write_text("no line\n[]\n{}\n" + history.read_text())
    assert times.remember(history, {"tests/raster": 99.0}) != []
    assert history.read_text().startswith("no line\n[]\n{}\n")
