"""``make matrix``: what it asks for and what it says, without an environment made."""

import subprocess
import tomllib

import pytest

from tests import matrix
from tests.accept import golden_path


def test_every_python_that_is_asked_for_is_allowed_and_the_lowest_is_asked_for():
    project = tomllib.loads((matrix.ROOT / "pyproject.toml").read_text())["project"]
    assert project["requires-python"] == f">={matrix.PYTHONS[0]}"


@pytest.mark.parametrize("name", matrix.FIGURES)
def test_every_figure_has_an_accepted_digest(name):
    figure, machine = name.rsplit("-", 1)
    assert golden_path(figure, machine).is_file()


def test_a_python_that_is_not_here_is_said_and_is_no_failure(monkeypatch, capsys):
    run = matrix.Run("3.11", "newest", "python 3.11.7", "all 400 equal", "4 equal")
    monkeypatch.setattr(matrix, "found_python", lambda python, download: "here" if python == "3.11" else None)
    monkeypatch.setattr(matrix, "run_of", lambda *given: run)
    assert matrix.main([]) == 0
    said = capsys.readouterr().out
    assert "| 3.14 | newest |  | left out: no such Python here |  |" in said
    assert "| 3.11 | newest | python 3.11.7 | all 400 equal | 4 equal |" in said


def test_a_run_that_differs_and_no_run_at_all_are_failures(monkeypatch):
    run = matrix.Run("3.11", "newest", "python 3.11.7", "2 of 400 differ", "4 equal", failed=True)
    monkeypatch.setattr(matrix, "found_python", lambda *given: "here")
    monkeypatch.setattr(matrix, "run_of", lambda *given: run)
    assert matrix.main(["--python", "3.11"]) == 1
    monkeypatch.setattr(matrix, "found_python", lambda *given: None)
    assert matrix.main([]) == 1


def test_packages_that_cannot_be_installed_are_a_failure_in_words(monkeypatch):
    refused = subprocess.CompletedProcess([], 1, "", "no version of numba\nfits")
    monkeypatch.setattr(matrix, "call", lambda *given, **more: refused)
    run = matrix.run_of("3.11", "python3.11", "oldest", ())
    assert run.failed
    assert run.selftest == "not installed: no version of numba fits"
