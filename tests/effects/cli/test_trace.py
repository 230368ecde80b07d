"""``fixedpipe passes --trace``: what is written, of which commands, and what is said before."""

import re
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from fixedpipe.effects.cli import passes as command
from fixedpipe.effects.figures import FIGURES, difference
from fixedpipe.effects.figures.rendering import delta_of, gain_for
from fixedpipe.effects.reports.trace import DRAWING
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import GEFORCE_256, IDEAL
from tests.effects.cli.test_cli import HALVES, refusal_of, run

BUFFERS = ("color", "alpha", "depth", "stencil")
FIGURE = FIGURES["F004-4"]
SIZE = 16


@pytest.fixture(scope="module")
def commands():
    return FIGURE.commands(GEFORCE_256, SIZE)


def trace(folder, *more):
    return ("passes", "F004-4", "--trace", folder, "--size", SIZE, *more)


def pictures(folder):
    return {path.name for path in folder.glob("*.png")}


def numbers(folder):
    """The numbers of the commands that the page shows."""
    return [int(n) for n in re.findall(r'<tr id="(\d+)">', (folder / "index.html").read_text())]


def cells(folder, number):
    """The files that the page names for a command, in the order of its columns."""
    row = re.search(rf'<tr id="{number}">.*?</tr>', (folder / "index.html").read_text()).group()
    return re.findall(r'<a href="([^"]+)"', row)


def cell_texts(folder, number):
    """What stands in words under a command's pictures, those without any left out."""
    row = re.search(rf'<tr id="{number}">.*?</tr>', (folder / "index.html").read_text()).group()
    return re.findall(r"</a><br>([^<]+)</td>", row)


def read(path):
    with Image.open(path) as picture:
        return np.asarray(picture)


def test_every_command_that_draws_has_its_pictures_and_equal_ones_are_written_once(tmp_path, commands):
    result = run(*trace(tmp_path))
    assert result.exit_code == 0, result.output
    drawing = [n for n, c in enumerate(commands) if isinstance(c, DRAWING)]
    assert numbers(tmp_path) == drawing and len(drawing) < len(commands)
    snapshots = execute(commands, GEFORCE_256, *FIGURE.dimensions(SIZE), trace=True).trace
    for number in drawing:
        shown = cells(tmp_path, number)
        assert len(shown) == len(BUFFERS)
        for buffer, name in zip(BUFFERS, shown, strict=True):
            np.testing.assert_array_equal(read(tmp_path / name), snapshots[number].pictures()[buffer])
    contents = [(p.shape, p.tobytes()) for n in drawing for p in snapshots[n].pictures().values()]
    assert len(pictures(tmp_path)) == len(set(contents)) < len(contents)
    assert len({read(path).tobytes() for path in tmp_path.glob("*-color.png")}) > 3


def test_what_will_be_written_is_said_first(tmp_path, commands):
    result = run(*trace(tmp_path))
    drawing = sum(isinstance(c, DRAWING) for c in commands)
    said = (
        f"F004-4 on the GeForce 256 has {len(commands)} commands; of {len(commands)} chosen {drawing} draw, "
        f"which is at most {4 * drawing + 1} files and 1 MB before compression."
    )
    lines = result.stderr.splitlines()
    assert said in lines and lines.index(said) < len(lines) - 1  # progress comes after it
    assert re.search(rf"\n{len(pictures(tmp_path))} pictures in", result.stdout)


@pytest.mark.parametrize(
    ("options", "chosen"),
    [
        (("--commands", "3:6"), range(3, 7)),
        (("--commands", "5"), range(5, 6)),
        (("--commands", ":4"), range(5)),
        (("--commands", "5:"), range(5, 99)),
        (("--every", "3"), range(0, 99, 3)),
        (("--commands", "2:9", "--every", "2"), range(2, 10, 2)),
    ],
)
def test_a_part_of_the_commands_is_traced(tmp_path, commands, options, chosen):
    assert run(*trace(tmp_path, *options)).exit_code == 0
    drawing = [n for n, c in enumerate(commands) if isinstance(c, DRAWING) and n in chosen]
    assert numbers(tmp_path) == drawing
    expected = execute(commands[: drawing[-1] + 1], GEFORCE_256, *FIGURE.dimensions(SIZE)).image()
    np.testing.assert_array_equal(read(tmp_path / cells(tmp_path, drawing[-1])[0]), expected[..., :3])


def test_machine_ideal_and_difference_stand_beside_each_other(tmp_path, commands, monkeypatch):
    guides = []

    def noted(*arguments, guide, **settings):
        guides.append(guide)
        return execute_ideal(*arguments, guide=guide, **settings)

    monkeypatch.setattr("fixedpipe.effects.reports.trace.execute_ideal", noted)
    assert run(*trace(tmp_path, "--ideal", "--commands", "4:")).exit_code == 0
    assert [len(guide.records) for guide in guides] == [4]
    last = numbers(tmp_path)[-1]
    sheet = read(tmp_path / cells(tmp_path, last)[-1]).astype(int)
    width, height = FIGURE.dimensions(SIZE)
    assert sheet.shape == (height, 3 * width + 8, 3)
    guide = execute(commands, GEFORCE_256, width, height, record=True)
    ideal = execute_ideal(FIGURE.commands(IDEAL, SIZE), width, height, guide=guide)
    parts = guide.image(), ideal.image(), difference(guide.image(), ideal.color)
    for k, part in enumerate(parts):
        np.testing.assert_array_equal(sheet[:, k * (width + 4) :][:, :width], part[..., :3])
    assert (parts[0] != parts[1]).any()
    shown = delta_of(guide.image(), ideal.color)
    assert cell_texts(tmp_path, last)[-1] == f"difference x {gain_for(shown)}"


def test_a_sheet_without_any_difference_says_so_and_draws_none(tmp_path):
    """The first command clears to a colour that a byte holds to its nearest."""
    assert run(*trace(tmp_path, "--ideal", "--commands", "0:6")).exit_code == 0
    first = numbers(tmp_path)[0]
    width, height = FIGURE.dimensions(SIZE)
    assert read(tmp_path / cells(tmp_path, first)[-1]).shape == (height, 2 * width + 4, 3)
    assert cell_texts(tmp_path, first)[-1] == "identical"


def test_the_ideal_is_traced_by_itself(tmp_path):
    assert run(*trace(tmp_path, "--profile", "IDEAL")).exit_code == 0
    ideal = execute_ideal(FIGURE.commands(IDEAL, SIZE), *FIGURE.dimensions(SIZE)).image()
    color, alpha = cells(tmp_path, numbers(tmp_path)[-1])
    np.testing.assert_array_equal(read(tmp_path / color), ideal[..., :3])
    np.testing.assert_array_equal(read(tmp_path / alpha), ideal[..., 3])


def test_a_trace_of_thousands_is_refused_until_it_is_asked_for(tmp_path):
    octane = ("--profile", "OCTANE")
    words = refusal_of(*trace(tmp_path / "a", *octane))
    assert re.search(
        r"has \d{5} commands; of \d{5} chosen \d+ draw, which is at most \d{5} files and \d+ MB before", words
    )
    assert all(way in words for way in ("--commands 10:60", "--every ", "--size", "--all"))
    assert not (tmp_path / "a").exists()
    result = run(*trace(tmp_path / "a", *octane, "--commands", "10:60"))
    assert result.exit_code == 0
    assert {*numbers(tmp_path / "a")} <= {*range(10, 61)}


def test_all_traces_however_many_there_are(tmp_path, monkeypatch):
    monkeypatch.setattr(command, "_MOST_FILES", 3)
    assert "--all" in refusal_of(*trace(tmp_path / "a"))
    assert run(*trace(tmp_path / "a", "--all")).exit_code == 0
    monkeypatch.setattr(command, "_MOST_FILES", 1000)
    monkeypatch.setattr(command, "_MOST_BYTES", 1000)
    assert "--size" in refusal_of(*trace(tmp_path / "b"))


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--commands", "9:3"), "give the first and the last command's number, as 10:60"),
        (("--commands", "a:b"), "as 10:60"),
        (("--commands", "-3:4"), "as 10:60"),
        (("--commands", "999:"), "the commands' numbers are 0 to"),
        (("--commands", "1:1"), "None of the 1 command chosen draws"),
        (("--ideal", "--profile", "IDEAL"), "a machine beside the ideal"),
    ],
)
def test_a_trace_that_cannot_be_is_refused_before_anything_is_written(tmp_path, options, words):
    assert words in refusal_of(*trace(tmp_path / "new", *options))
    assert not (tmp_path / "new").exists()


def test_options_of_a_trace_are_refused_without_one():
    for option in (("--commands", "1:2"), ("--every", "2"), ("--ideal",)):
        assert f"{option[0]} would be ignored" in refusal_of("passes", "F004-4", *option)


def test_a_frame_that_the_ideal_draws_otherwise_is_refused(tmp_path, monkeypatch):
    method = replace(
        FIGURE.methods[0],
        scene=lambda profile, size, **p: FIGURE.methods[0].scene(profile, size, **p)[profile is IDEAL :],
    )
    monkeypatch.setattr("fixedpipe.effects.figures.FIGURES", {"F004-4": replace(FIGURE, methods=(method,))})
    assert "the ideal draws other commands" in refusal_of(*trace(tmp_path / "new", "--ideal"))


def test_what_the_host_draws_is_traced_too(tmp_path):
    result = run("passes", "K15", "--profile", "GEFORCE_256", "--trace", tmp_path, "--size", SIZE)
    assert result.exit_code == 0, result.output
    assert any("DrawPixels" in name for name in pictures(tmp_path))


def test_a_script_s_passes_are_told_and_traced(tmp_path):
    script, folder = tmp_path / "halves.py", tmp_path / "trace"
    script.write_text(HALVES)
    result = run("passes", script, "--trace", folder, "--ideal")
    assert result.exit_code == 0, result.output
    assert f"{script}\non GeForce 256\n" in result.output and "all of it" in result.output
    assert numbers(folder) == [0]
    with Image.open(folder / cells(folder, 0)[0]) as picture:
        assert picture.size == (8, 4)
    assert f"{script}\non ideal" in run("passes", script, "--profile", "IDEAL").output
    assert "a script says its own width" in refusal_of("passes", script, "--size", 8)
    script.write_text("commands, width, height, profile = (1,), 8, 8, 'NV2A'")
    assert "is no command" in refusal_of("passes", script)
