"""--executor of everything long: the files and words of one process."""

import pytest
from click.testing import CliRunner

from fixedpipe.effects.cli import main
from fixedpipe.effects.presentation import variation
from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.reports import figure_tasks
from fixedpipe.effects.reports.figure_pool import Order
from fixedpipe.effects.tasks.executors import opened

BY_TWO = "--executor", "processes:2"


def run(*arguments, status=0):
    done = CliRunner().invoke(main, [str(a) for a in arguments])
    assert done.exit_code == status, done.output
    return done


def contents(folder):
    return {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_figures(tmp_path):
    small = "figures", "K02", "K12", "--profile", "GEFORCE_256", "--size", "8"
    run(*small, "--jobs", 1, "--out", tmp_path / "one", "--png", tmp_path / "png one")
    said = run(*small, *BY_TWO, "--out", tmp_path / "two", "--png", tmp_path / "png two")
    assert "2 drawings, by processes:2" in said.stderr
    assert contents(tmp_path / "one") == contents(tmp_path / "two")
    assert contents(tmp_path / "png one") == contents(tmp_path / "png two")
    # What did not change is not drawn again, by whomever it was drawn.
    again = run("figures", "K02", "K12", *small[3:], "--out", tmp_path / "two", *BY_TWO)
    assert "2 figures did not change and stay" in again.stderr


def test_a_figure_whose_files_cannot_be_written_says_so(tmp_path, monkeypatch):
    def no_room(path, data):
        raise Refusal(f"{path} cannot be written: No space left on device.")

    monkeypatch.setattr(figure_tasks, "write_whole", no_room)
    order = Order("K12", ("GEFORCE_256",), 8, None, False, tmp_path, None, None)
    with opened("processes:1") as workers:
        ((drawn, record, _),) = figure_tasks.draw_by(workers, [order], lambda text: None)
    (failed,) = record["failures"]
    assert drawn is order and failed["what"].endswith("cannot be written: No space left on device.")


def test_an_animation(tmp_path):
    moves = "animate", "K12", "--vary", "depth=0:0.4:3", "--size", "16"
    run(*moves, "--out", tmp_path / "one.png")
    run(*moves, "--out", tmp_path / "two.png", *BY_TWO)
    assert (tmp_path / "one.png").read_bytes() == (tmp_path / "two.png").read_bytes()


def test_studies(tmp_path):
    one = run("study", "P32", "P26", "--out", tmp_path / "one")
    two = run("study", "P32", "P26", "--out", tmp_path / "two", *BY_TWO)
    assert one.stdout.replace("/one", "/two") == two.stdout
    assert contents(tmp_path / "one") == contents(tmp_path / "two")


def test_what_is_finished_of_an_animation_is_not_drawn_again(tmp_path, monkeypatch):
    moves = "animate", "K12", "--vary", "depth=0:0.4:3", "--size", "16", "--out"
    run(*moves, tmp_path / "whole.png")
    kept, picture = ("--manifest", tmp_path / "m"), variation.picture_of
    drawn = []

    def ends(figure, profile, frame, *more):
        drawn.append(frame.changes["depth"])
        if len(drawn) == 2:
            raise MemoryError("no room")
        return picture(figure, profile, frame, *more)

    monkeypatch.setattr(variation, "picture_of", ends)
    failed = run(*moves, tmp_path / "a.png", *kept, status=2)
    assert "K12 depth=0.2 on GEFORCE_256 failed: MemoryError: no room (" in failed.stderr
    assert not (tmp_path / "a.png").exists()
    found = run(*moves, tmp_path / "a.png", *kept)
    assert "has 1 finished task." in found.stderr and drawn == [0.0, 0.2, 0.2, 0.4]
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "whole.png").read_bytes()
    other = run("animate", "K02", "--precision", "6:7", *moves[-3:], tmp_path / "b.png", *kept, status=2)
    assert "is the manifest of an animation of K12, and this is an animation of K02" in other.stderr


def test_what_is_finished_of_studies_is_not_measured_again(tmp_path, monkeypatch):
    studies, kept = ("study", "P32", "P26", "--out"), ("--manifest", tmp_path / "m")
    one = run(*studies, tmp_path / "one")
    run("study", "P32", "--out", tmp_path / "two", *kept)
    both = run(*studies, tmp_path / "two", *kept)
    monkeypatch.setattr(
        "fixedpipe.effects.cli.study.measured", lambda *_: pytest.fail("it was measured again")
    )
    again = run(*studies, tmp_path / "three", *kept)
    assert "has 1 finished task." in both.stderr and "has 2 finished tasks." in again.stderr
    assert one.stdout == again.stdout.replace("/three", "/one") == both.stdout.replace("/two", "/one")
    assert contents(tmp_path / "one") == contents(tmp_path / "two") == contents(tmp_path / "three")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("figures", "K12", "--jobs", "2"), "leave --set and --jobs out"),
        (("figures", "K12", "--set", "depth=0.1"), "leave --set and --jobs out"),
        (("animate", "K12", "--vary", "depth=0:1:3", "--fill"), "--fill would be ignored: workers read"),
        (("brdf", "sample:gravel", "--out", "a.npz", "--jobs", "2"), "--jobs and --executor both say"),
        (("study",), "--executor would be ignored"),
    ],
)
def test_what_an_executor_does_not_go_with(tmp_path, monkeypatch, arguments, said):
    monkeypatch.chdir(tmp_path)
    assert said in run(*arguments, *BY_TWO, status=2).stderr
