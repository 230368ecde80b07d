"""Figures in files of users: drawn, checked and kept in the gallery as the package's are; errors are told."""

import json

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image, ImageSequence

from fixedpipe.effects.cli import main
from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.reports.own_figures import own_figure

HELPER = "RED = (1.0, 0.5, 0.2)\n"
FIGURE = """
from dataclasses import dataclass
from own_colors import RED

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry.views import row_of_panels


@dataclass
class Setting:
    edge: "int"


def scene(profile, size, *, color):
    (panel,) = row_of_panels(1, Setting(size).edge)
    return (panel.clear(color),)


def checks(figure, renderer):
    for on in Answer:
        window = renderer.window(on, figure, figure.size)
        yield Check("red", float(window[..., 0].min()), at_least=LEAST, on=on, reason="1.0 is a code")


LEAST = 1.0
FIGURE = Figure(
    id="MY-1",
    title="Red",
    caption="A red square.",
    must_see="Red.",
    source="Nobody2001",
    techniques=(),
    size=16,
    parameters={"color": word.COLOR(RED, "The square's.")},
    methods=(Method("a clear", scene, ("GEFORCE_256", "OPENGL_1_2")),),
    acceptance=checks,
)
"""


@pytest.fixture
def file(tmp_path, monkeypatch):
    """Writes my_figure.py, with words replaced, beside what it imports; returns its path as a str."""
    (tmp_path / "own_colors.py").write_text(HELPER)
    monkeypatch.chdir(tmp_path)

    def write(*replaced, name="my_figure.py"):
        text = FIGURE
        for before, after in replaced:
            assert before in text
            text = text.replace(before, after)
        (tmp_path / name).write_text(text)
        return str(tmp_path / name)

    return write


def run(*arguments, status=0):
    done = CliRunner().invoke(main, ["figures", *map(str, arguments), "--out", "out"])
    assert done.exit_code == status, done.output
    return done


def line_with(text):
    return next(n for n, line in enumerate(FIGURE.splitlines(), 1) if text in line)


def test_a_figure_of_a_file_is_checked_and_has_a_record_and_a_card(file, tmp_path):
    path = file()
    said = run(path, "--check").stdout
    assert "MY-1     ok     red, GEFORCE_256: 1 >= 1" in said
    assert "3 acceptance checks passed." in said  # of two machines, and of the ideal of their one way
    record = json.loads((tmp_path / "out" / "MY-1.json").read_text())
    assert record["command"] == f"fixedpipe figures {path} --check"
    assert [m["profile"] for m in record["machines"]] == ["GEFORCE_256", "OPENGL_1_2"]
    assert record["page"] is None and record["file"] == path
    assert 'href="#MY-1"' in (tmp_path / "out" / "plain.html").read_text()
    # Another run for the folder keeps the card.
    run("K12", "--size", 8, "--profile", "GEFORCE_256")
    page = (tmp_path / "out" / "plain.html").read_text()
    assert 'href="#MY-1"' in page and 'href="#K12"' in page
    run("my_figure.py", "--profile", "GEFORCE_256", "--set", "color=0,0,1")
    assert (tmp_path / "out" / "MY-1+color=0,0,1.json").exists()


def test_processes_draw_what_one_alone_draws(file, tmp_path):
    path, other = file(), file(("MY-1", "MY-2"), ("RED,", "(0, 0, 1),"), name="other.py")
    run(path, other, "--jobs", 1)
    alone = {p.name: p.read_bytes() for p in (tmp_path / "out").rglob("*") if p.is_file()}
    assert "2 processes" in run(path, other, "--jobs", 2).stderr
    assert {p.name: p.read_bytes() for p in (tmp_path / "out").rglob("*") if p.is_file()} == alone


def test_a_check_that_fails_is_the_status(file):
    assert "1 >= 1.5" in run(file(("LEAST = 1.0", "LEAST = 1.5")), "--check", status=1).stdout


@pytest.mark.parametrize(
    ("before", "after", "sentence"),
    [
        (
            "panel.clear(color)",
            "panel.clear(1 / 0)",
            "Not drawn on the {all}: {file}, line {line}, raised Zero",
        ),
        ("panel.clear(color)", "int('red')", "Not drawn on the {all}: {file}, line {line}: invalid literal"),
        (
            "window[..., 0]",
            "window[..., 7]",
            "Not checked on the {all}: {file}, line {line}, raised IndexErr",
        ),
    ],
)
def test_what_fails_in_a_scene_or_a_check_is_told_with_file_and_line(file, before, after, sentence):
    path = file((before, after))
    said = run(path, "--check", status=1).stderr
    names = "GeForce 256, OpenGL 1.2"
    assert sentence.format(all=names, file=path, line=line_with(before)) in said


@pytest.mark.parametrize(
    ("before", "after", "sentence"),
    [
        ("LEAST = 1.0", "LEAST = 1 / 0", "{file}, line {line}, raised ZeroDivisionError: division by zero"),
        ("LEAST = 1.0", "LEAST = = 1", "{file}, line {line}, raised SyntaxError"),
        ("LEAST = 1.0", "raise SystemExit(3)", "{file}, line {line}, raised SystemExit: 3"),
        ("techniques=(),", "techniques=(), size=8,", "SyntaxError: keyword argument repeated"),
        ("FIGURE = Figure(", "OTHER = Figure(", "{file} holds no FIGURE. End it with FIGURE = Figure("),
        ("FIGURE = Figure(", "FIGURE = dict(", "which is no Figure. End it with"),
        ('"MY-1"', '"../MY"', "the id '../MY' names no file. Give up to 60 letters"),
        ('"MY-1"', '"k12"', "the package has a figure k12 already. Give FIGURE another id."),
        ('"GEFORCE_256"', '"VOODOO"', "MY-1 names a machine twice, or one that is not known"),
    ],
)
def test_a_file_that_holds_no_figure_is_refused_before_anything_is_written(
    file, tmp_path, before, after, sentence
):
    path = file((before, after))
    done = run(path, "--check", status=2)
    assert sentence.format(file=path, line=line_with(before)) in done.stderr
    assert not (tmp_path / "out").exists()


def test_two_files_with_one_id_and_a_file_that_is_not_there_are_refused(file):
    path, other = file(), file(name="other.py")
    assert f"{path} and {other} both hold MY-1." in run(path, other, status=2).stderr
    with pytest.raises(Refusal, match=r"nowhere\.py cannot be read: No such file"):
        own_figure("nowhere.py")


def other(*arguments):
    """What another command than ``figures`` says."""
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


def test_its_parameters_are_named(file):
    path = file()
    told = other("parameters", path, "--json", "parameters.json")
    assert told.exit_code == 0, told.output
    assert told.stdout.startswith("MY-1: Red\n\ncolor=1,0.5,0.2")
    assert told.stdout.endswith(f"For example: fixedpipe figures {path} --set color=1,0.5,0.2\n")
    with open("parameters.json") as written:
        assert [row["name"] for row in json.load(written)] == ["color"]


def test_it_moves(file):
    moved = other("animate", file(), "--vary", "color=0,0,0:1,1,1:3", "--size", 4, "--out", "red.png")
    assert moved.exit_code == 0, moved.output
    with Image.open("red.png") as picture:
        frames = [np.asarray(frame.convert("RGB")) for frame in ImageSequence.Iterator(picture)]
    assert [int(frame[0, 0, 0]) for frame in frames] == [0, 128, 255]


def test_what_takes_scripts_says_who_takes_a_figure(file):
    for command in ("precision", "passes"):
        refused = other(command, file())
        assert refused.exit_code == 2
        assert "Its FIGURE is for figures, animate and parameters." in refused.stderr


@pytest.mark.parametrize("command", ["animate", "parameters"])
def test_a_file_without_a_figure_is_refused_by_each_command(file, command):
    refused = other(command, file(("FIGURE = Figure(", "figure = Figure(")))
    assert refused.exit_code == 2
    assert "holds no FIGURE" in refused.stderr
