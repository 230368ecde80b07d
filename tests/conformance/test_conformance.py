"""Captures of a real chip: every suite's cases are sound, the command says what is so, nothing got worse."""

import contextlib
import hashlib
import json
import os
import re
import subprocess
import sys
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

from fixedpipe.effects.cli import main
from fixedpipe.effects.conformance import redraw, run, tasks
from fixedpipe.effects.conformance.captures import find_captures
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case, Exclusion, Inputs, MissingInput, Suite
from fixedpipe.effects.conformance.run import compare_all
from fixedpipe.effects.reports.conformance import difference_picture
from fixedpipe.effects.tasks.executors import opened
from fixedpipe.effects.tasks.manifest import Manifest
from fixedpipe.pipeline.commands import Clear
from fixedpipe.pipeline.profiles import NV2A
from fixedpipe.pipeline.validation.validate import validate
from tests.accept_conformance import (
    ACCEPTED,
    DOCUMENTS,
    INPUTS,
    changes,
    count,
    from_text,
    table,
    to_text,
    totals,
    with_results,
)
from tests.support.sample import sampled, slow_unless

SUITES = redraw.known_suites()
MOST = 100  # cases of a suite that are built here; some have more than a thousand

# Resources of cases without a capture here, which the folder of inputs therefore lacks.
NOT_AMONG_THE_INPUTS = ("_dxt5.dds", "64x256_bands_dxt1.dds")

RED, BLUE, TEXT = (255, 0, 0, 255), (0, 0, 255, 255), (255, 255, 255, 0)


# ------------------------------------------------------------------------------------- suites, as they are


def some_names(known):
    """Up to MOST names of a suite, evenly spread, the first and the last among them."""
    names = known.names()
    return [names[i] for i in np.unique(np.linspace(0, len(names) - 1, MOST).astype(int))]


@pytest.mark.parametrize("suite", SUITES)
def test_a_suite_s_names_are_its_own_and_no_other_is_a_case(suite):
    known = SUITES[suite]
    names = known.names()
    assert names
    assert all(re.fullmatch(r"[^\s/]+", name) for name in names)
    for unknown in ("", "no such case", names[0] + "_", names[0][:-1] + "?"):
        assert known.case(unknown, INPUTS) is None


# Those that are redrawn below are validated there, a quarter of all; of these a share in turn.
SAMPLE = sampled(SUITES)
IN_TURN = [pytest.param(suite, marks=slow_unless(suite in SAMPLE)) for suite in SUITES]


@pytest.mark.parametrize("suite", IN_TURN)
def test_a_suite_s_cases_are_frames_that_the_machine_can_hold(suite):
    known = SUITES[suite]
    for name in some_names(known):
        try:
            case = known.case(name, INPUTS)
        except MissingInput as missing:
            absent = INPUTS.folder is None or any(file in str(missing) for file in NOT_AMONG_THE_INPUTS)
            assert absent, f"{name} needs a file that nobody has"
            continue
        assert case is not None, name
        assert case.compared().any(), name
        assert all(e.reason and e.pixels.shape == (HEIGHT, WIDTH) for e in case.exclusions), name
        validate(case.commands, NV2A, WIDTH, HEIGHT, case.depth_bits)


@pytest.mark.parametrize("suite", IN_TURN)
def test_a_suite_is_drawn_the_same_way_twice(suite):
    """A case is data: building it once more gives the same picture."""
    known = SUITES[suite]
    name = known.names()[-1]
    blank = np.zeros((HEIGHT, WIDTH, 4), np.uint8)
    try:
        first, second = (redraw.compare(suite, known, name, blank, INPUTS, threads=n) for n in (1, 2))
    except MissingInput:
        pytest.skip("needs a file of the inputs")
    if first.covered:
        np.testing.assert_array_equal(first.ours, second.ours)


# -------------------------------------------------------------------------------------- what a case may be


def excluding(pixels):
    mask = np.zeros((HEIGHT, WIDTH), bool)
    mask.ravel()[:pixels] = True
    return (Exclusion(pixels=mask, reason="a tie"),)


def test_exclusions_of_more_than_a_thousandth_of_the_region_are_an_error():
    region = ((0, 0, 500, 2),)
    assert Case(commands=(), region=region, exclusions=excluding(1)).compared().sum() == 999
    with pytest.raises(ValueError, match="2 of the region's 1000 pixels are excluded"):
        Case(commands=(), region=region, exclusions=excluding(2))


def test_exclusions_outside_the_region_cost_nothing():
    assert Case(commands=(), region=((0, 9, 10, 19),), exclusions=excluding(WIDTH)).compared().sum() == 100


@pytest.mark.parametrize("box", [(0, 0, 641, 9), (0, -1, 9, 9), (9, 0, 9, 9), (0, 9, 9, 8)])
def test_a_region_lies_in_the_picture(box):
    with pytest.raises(ValueError, match="no part of a 640x480 picture"):
        Case(commands=(), region=(box,))


def test_an_explanation_is_one_line():
    with pytest.raises(ValueError, match="one line"):
        Case(commands=(), explanation="one\ntwo")


# ---------------------------------------------------------------------------------------- the command line


def plain(color):
    """A case that fills the window with one colour."""
    return Case(commands=(Clear(label="all", color=tuple(c / 255 for c in color)),))


def broken_case():
    raise RuntimeError("the case's own\nmistake")


def needy_case(inputs):
    return inputs.path("nowhere.dds")


@pytest.fixture
def suites(monkeypatch):
    """Known suites: Plain draws red and blue windows; Broken and Needy cannot be drawn."""
    known = {
        "Plain": Suite(name="Plain", cases={"Red": partial(plain, RED), "Blue": partial(plain, BLUE)}),
        "Broken": Suite(name="Broken", cases={"Red": broken_case}),
        "Needy": Suite(name="Needy", cases={"Red": needy_case}),
    }
    monkeypatch.setattr(redraw, "known_suites", lambda: known)
    return known


def save(folder, suite, name, *pixels, color=RED):
    """A capture of one colour but for ``pixels``: ((x, y), colour)."""
    image = np.full((HEIGHT, WIDTH, 4), color, np.uint8)
    for (x, y), other in pixels:
        image[y, x] = other
    (folder / suite).mkdir(parents=True, exist_ok=True)
    Image.fromarray(image).save(folder / suite / f"{name}.png")


def conformance(*arguments, **environment):
    clean = {"FIXEDPIPE_CAPTURES": None, "FIXEDPIPE_INPUTS": None, "COLUMNS": "200"}
    return CliRunner().invoke(main, ["conformance", *map(str, arguments)], env=clean | environment)


def refusal(*arguments, **environment):
    result = conformance(*arguments, **environment)
    assert result.exit_code == 2, result.output
    assert result.stdout == ""
    (sentence,) = result.stderr.strip().splitlines()
    return sentence


def test_equal_pixels_are_counted_and_the_last_line_sums_up(suites, tmp_path):
    save(tmp_path, "Plain", "Red", ((5, 6), TEXT), ((7, 8), TEXT))
    save(tmp_path, "Plain", "Blue", ((1, 2), (0, 0, 255, 254)), color=BLUE)
    save(tmp_path, "Plain", "Green")
    save(tmp_path, "Unheard_of", "Red")
    json_file, html_file = tmp_path / "out.json", tmp_path / "out.html"
    result = conformance(tmp_path, "--json", json_file, "--html", html_file)
    assert result.exit_code == 0, result.output
    whole = WIDTH * HEIGHT
    assert result.stdout.splitlines() == [
        f"Plain/Blue: {whole - 1} / {whole}",
        "Plain/Green: not covered: the suite has no such case",
        f"Plain/Red: {whole - 2} / {whole - 2}",
        f"Plain: exact: 1 of 2 cases; pixels: {2 * whole - 3} of {2 * whole - 2}; not covered: 1",
        "",
        "Unheard_of: the suite is not covered",
        "",
        f"exact: 1 of 2 cases; pixels: {2 * whole - 3} of {2 * whole - 2}; not covered: 2",
    ]
    blue, green, red, unheard_of = json.loads(json_file.read_text())
    assert blue == {
        "suite": "Plain",
        "case": "Blue",
        "covered": True,
        "pixels_equal": whole - 1,
        "pixels_compared": whole,
        "exact": False,
        "note": "",
    }
    assert red["exact"] and red["pixels_compared"] == whole - 2
    assert not green["covered"] and green["note"]
    assert (unheard_of["suite"], unheard_of["covered"]) == ("Unheard_of", False)
    page = html_file.read_text()
    assert result.stdout.splitlines()[-1] in page
    assert page.count("<img") == 6  # Blue: ours, theirs and the difference, whole and closer
    assert "(1, 2) ours 0 0 255 255, theirs 0 0 255 254" in page
    assert not re.search(r'(src|href)="(?!data:|#)', page)


def test_a_real_case_agrees_with_itself_and_one_changed_pixel_is_caught(tmp_path):
    name, known = "AlphaFuncNotEqual_Enabled", SUITES["Alpha_func"]
    blank = np.zeros((HEIGHT, WIDTH, 4), np.uint8)
    ours = redraw.compare("Alpha_func", known, name, blank, INPUTS).ours
    changed = ours.copy()
    changed[300, 200, 2] ^= 1
    (tmp_path / "Alpha_func").mkdir()
    path, whole = tmp_path / "Alpha_func" / f"{name}.png", WIDTH * HEIGHT
    for image, equal, exact in ((ours, whole, 1), (changed, whole - 1, 0)):
        Image.fromarray(image).save(path)
        result = conformance(tmp_path)
        last = f"exact: {exact} of 1 cases; pixels: {equal} of {whole}; not covered: 0"
        assert result.stdout.splitlines()[-1] == last


def test_an_explanation_is_said_only_of_a_case_that_is_not_exact(suites, tmp_path):
    explained = replace(plain(RED), explanation="a tie")
    suites["Plain"] = Suite(name="Plain", cases=dict.fromkeys(("Exact", "Off"), lambda: explained))
    save(tmp_path, "Plain", "Exact")
    save(tmp_path, "Plain", "Off", ((0, 0), BLUE))
    said = conformance(tmp_path).stdout.splitlines()
    assert said[:2] == ["Plain/Exact: 307200 / 307200", "Plain/Off: 307199 / 307200  a tie"]


def test_an_error_of_one_case_is_its_note_and_the_exit_status(suites, tmp_path):
    save(tmp_path, "Broken", "Red")
    save(tmp_path, "Plain", "Red")
    json_file = tmp_path / "out.json"
    result = conformance(tmp_path, "--json", json_file, "--html", tmp_path / "out.html")
    assert result.exit_code == 1
    assert "Broken/Red: error: RuntimeError: the case's own mistake" in result.stdout
    assert "1 case ended with an error." in result.stderr
    assert result.stdout.splitlines()[-1] == ("exact: 1 of 1 cases; pixels: 307200 of 307200; not covered: 1")
    assert [record["covered"] for record in json.loads(json_file.read_text())] == [False, True]


def test_a_missing_input_is_a_reason_and_no_error(suites, tmp_path):
    save(tmp_path, "Needy", "Red")
    result = conformance(tmp_path)
    assert result.exit_code == 0
    assert "Needy/Red: not covered: needs the file nowhere.dds" in result.stdout


@pytest.mark.parametrize("file", ["pixel_shader/water_bump_map.png", "water_bump_map.png", "water.png"])
def test_an_input_may_lie_in_a_folder_of_the_resources_or_under_its_other_name(tmp_path, file):
    path = tmp_path / file
    path.parent.mkdir(exist_ok=True)
    Image.new("RGB", (3, 2), (1, 2, 3)).save(path)
    assert Inputs(tmp_path).path("water_bump_map.png") == path
    assert Inputs(tmp_path).picture("water_bump_map.png").tolist() == [[[1, 2, 3, 255]] * 3] * 2
    with pytest.raises(MissingInput, match=r"needs the file other.png"):
        Inputs(tmp_path).path("other.png")


@pytest.mark.parametrize("how", ["option", "environment", "beside"])
def test_inputs_are_found(suites, tmp_path, how):
    results = tmp_path / "golden" / "results"
    save(results, "Needy", "Red")
    folder = tmp_path / ("inputs" if how == "beside" else "elsewhere")
    folder.mkdir()
    (folder / "nowhere.dds").touch()
    found = {"Red": lambda inputs: plain(RED) if inputs.path("nowhere.dds") else None}
    suites["Needy"] = Suite(name="Needy", cases=found)
    environment = {"FIXEDPIPE_INPUTS": str(folder)} if how == "environment" else {}
    result = conformance(results, *(("--inputs", folder) if how == "option" else ()), **environment)
    assert "Needy/Red: 307200 / 307200" in result.stdout


def test_the_captures_may_come_from_the_environment(suites, tmp_path):
    save(tmp_path, "Plain", "Red")
    assert "exact: 1 of 1 cases" in conformance(FIXEDPIPE_CAPTURES=str(tmp_path)).stdout


def test_suites_and_cases_can_be_chosen(suites, tmp_path):
    for suite, name in (("Plain", "Red"), ("Plain", "Blue"), ("Other", "Red")):
        save(tmp_path, suite, name)
    (tmp_path / "README.md").touch()
    (tmp_path / "Plain" / "notes.txt").touch()
    result = conformance(tmp_path, "--suite", "Plain", "--case", "Re")
    assert result.stdout.splitlines()[0] == "Plain/Red: 307200 / 307200"
    assert len(result.stdout.splitlines()) == 4
    assert "Did you mean Plain?" in refusal(tmp_path, "--suite", "Plian")
    assert "'teapot'" in refusal(tmp_path, "--case", "teapot")


def test_the_suites_can_be_listed_without_captures():
    lines = conformance("--list").stdout.splitlines()
    assert len(lines) == len(SUITES)
    assert any(re.match(r"Alpha_func +16 cases", line) for line in lines)


def truncated(path):
    path.write_bytes(path.read_bytes()[:-60])


def one_bit_flipped(path):
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 4
    path.write_bytes(data)


def no_picture(path):
    path.write_bytes(b"no picture")


def empty(path):
    path.write_bytes(b"")


def a_jpeg(path):
    Image.new("RGB", (WIDTH, HEIGHT)).save(path, "JPEG")


def too_small(path):
    Image.new("RGBA", (WIDTH, HEIGHT - 1)).save(path)


def a_folder(path):
    path.unlink()
    path.mkdir()


@pytest.mark.parametrize(
    "spoil", [truncated, one_bit_flipped, no_picture, empty, a_jpeg, too_small, a_folder]
)
def test_a_spoilt_capture_is_refused_before_anything_is_drawn(suites, tmp_path, spoil):
    for name in ("Blue", "Red"):
        save(tmp_path, "Plain", name)
    spoil(tmp_path / "Plain" / "Red.png")
    json_file = tmp_path / "out.json"
    sentence = refusal(tmp_path, "--json", json_file, "--html", tmp_path / "out.html")
    assert str(tmp_path / "Plain" / "Red.png") in sentence
    assert sorted(p.name for p in tmp_path.iterdir()) == ["Plain"]


def test_one_file_for_two_results_is_refused(suites, tmp_path):
    save(tmp_path, "Plain", "Blue")
    both = tmp_path / "out"
    assert "a file of its own" in refusal(tmp_path, "--json", both, "--html", both)
    assert not both.exists()


def test_what_is_no_folder_of_captures_is_refused(tmp_path, monkeypatch):
    assert "FIXEDPIPE_CAPTURES" in refusal()
    assert "There is no folder" in refusal(tmp_path / "nowhere")
    assert "There is no folder" in refusal("\0")
    assert "There is no folder" in refusal(FIXEDPIPE_CAPTURES=str(tmp_path / "nowhere"))
    assert "holds no captures" in refusal(tmp_path)
    assert "There is no folder" in refusal(tmp_path, "--inputs", tmp_path / "nowhere")
    (tmp_path / "Plain").mkdir()
    assert "holds no captures" in refusal(tmp_path)

    def denied(self):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "iterdir", denied)
    assert "cannot be read: Permission denied" in refusal(tmp_path)


@pytest.mark.parametrize("option", ["--json", "--html"])
def test_a_result_that_cannot_be_written_is_refused_first(suites, tmp_path, option):
    save(tmp_path, "Plain", "Red")
    assert "is a folder" in refusal(tmp_path, option, tmp_path / "Plain")


def read_to_the_end(terminal):
    """What a terminal was sent until nobody holds its other end: a terminal keeps a few thousand bytes, and a
    bar that is drawn ten times a second sends any number.
    """
    sent = b""
    with contextlib.suppress(OSError):  # as Linux says that the other end is closed
        while more := os.read(terminal, 1 << 16):
            sent += more
    return sent.decode()


@pytest.mark.parametrize("piped", [True, False])
def test_the_progress_bar_keeps_out_of_the_lines(tmp_path, piped):
    pty = pytest.importorskip("pty", reason="no terminals here")
    save(tmp_path, "Unheard_of", "Red")
    mine, its = pty.openpty()
    done = subprocess.Popen(
        [sys.executable, "-m", "fixedpipe.effects.cli", "conformance", str(tmp_path)],
        stdout=subprocess.PIPE if piped else its,
        stderr=its,
        cwd=ACCEPTED.parents[2],
        env=os.environ | {"TERM": "xterm", "COLUMNS": "100"},
    )
    os.close(its)
    on_terminal = read_to_the_end(mine)
    os.close(mine)
    printed, _ = done.communicate()
    assert done.returncode == 0, on_terminal
    lines = printed.decode().splitlines() if piped else re.split(r"\r\n|\r|\x1b\[2K", on_terminal)
    assert "Unheard_of: the suite is not covered" in lines
    assert [line for line in lines if line][-1] == "exact: 0 of 0 cases; pixels: 0 of 0; not covered: 1"
    assert "1/1" in on_terminal


@pytest.mark.parametrize("threads", [1, 2, 7])
def test_any_number_of_threads_gives_the_cases_in_their_order(suites, tmp_path, threads):
    names = [f"{i:02d}" for i in range(20)]
    cases = {name: partial(plain, (i, 0, 0, 255)) for i, name in enumerate(names)}
    suites["Plain"] = Suite(name="Plain", cases=cases)
    for i, name in enumerate(names):
        save(tmp_path, "Plain", name, color=(i, 0, 0, 255))
    found = list(compare_all(find_captures(tmp_path), suites, Inputs(None), threads))
    assert [c.name for c in found] == names
    assert all(c.exact for c in found)


def same(a, b):
    pictures = ("theirs", "ours", "compared", "equal")
    return (a.suite, a.name, a.note, a.failed) == (b.suite, b.name, b.note, b.failed) and all(
        np.array_equal(getattr(a, name), getattr(b, name)) for name in pictures
    )


def test_a_manifest_gives_the_comparisons_again(suites, tmp_path, monkeypatch):
    tasks._suites.cache_clear()
    monkeypatch.setattr(tasks, "known_suites", lambda: suites)
    save(tmp_path / "all", "Plain", "Red", ((1, 2), BLUE))
    save(tmp_path / "all", "Broken", "Red")
    save(tmp_path / "all", "Unheard_of", "Red")
    captures, inputs = find_captures(tmp_path / "all"), Inputs(None)
    expected = list(compare_all(captures, suites, inputs, 1))
    drawn, compared = [], tasks.compared

    def counted(suite, *given):
        drawn.append(suite)
        return compared(suite, *given)

    monkeypatch.setattr(tasks, "compared", counted)
    for number in (2, 3, 3):
        with Manifest(tmp_path / "m", "captures", with_files=True) as manifest:
            found = list(tasks.compare_by(None, manifest, captures[:number], inputs))
        assert all(map(same, found, expected[:number])) and len(found) == number
    assert drawn == ["Broken", "Plain", "Unheard_of"]
    # Another picture under the same name is another task.
    save(tmp_path / "all", "Plain", "Red")
    with Manifest(tmp_path / "m", "captures", with_files=True) as manifest:
        *_, again, _ = tasks.compare_by(None, manifest, captures, inputs)
    assert again.exact and drawn[3:] == ["Plain"]
    tasks._suites.cache_clear()


def test_processes_find_the_suites_themselves(tmp_path):
    for suite, known in sorted(SUITES.items())[:2]:
        save(tmp_path, suite, known.names()[0])
    save(tmp_path, "Unheard_of", "Red")
    captures, inputs = find_captures(tmp_path), Inputs(None)
    with opened("processes:1") as workers:
        found = list(tasks.compare_by(workers, None, captures, inputs))
    assert all(map(same, found, compare_all(captures, SUITES, inputs, 1))) and len(found) == 3


def test_a_difference_is_seen_and_what_is_not_compared_is_told_apart():
    theirs = np.full((HEIGHT, WIDTH, 4), RED, np.uint8)
    theirs[10, 20] = (254, 0, 0, 255)
    theirs[12, 20] = TEXT
    case = replace(plain(RED), region=((0, 0, WIDTH, 100),))
    known = Suite(name="Plain", cases={"Red": lambda: case})
    found = difference_picture(redraw.compare("Plain", known, "Red", theirs, Inputs(None)))
    colors = {tuple(found[y, x].tolist()) for x, y in ((20, 10), (20, 12), (0, 0), (0, 200))}
    assert len(colors) == 4
    assert tuple(found[0, 0].tolist()) == (51, 0, 0)


# ------------------------------------------------------------------------------------ the chip's own pictures


def in_sample(name):
    """Whether `make test` redraws a case: a quarter of them, the same ones always."""
    return hashlib.sha256(name.encode()).digest()[0] < 64


@pytest.mark.needs_shared
@pytest.mark.parametrize(
    "sampled", [True, pytest.param(False, marks=pytest.mark.slow)], ids=["a quarter", "the rest"]
)
def test_no_case_agrees_with_fewer_pixels_than_accepted(captures, capfd, sampled):
    accepted = from_text(ACCEPTED.read_text())
    accepted = {name: counts for name, counts in accepted.items() if in_sample(name) == sampled}
    chosen = [c for c in find_captures(captures) if f"{c.suite}/{c.name}" in accepted]
    found, errors, unexplained = count(chosen, INPUTS)
    assert not errors
    assert not unexplained, "what differs must say why"
    worse, better = changes(accepted, found)
    if better:
        with capfd.disabled():
            print(f"\n{len(better)} cases agree better than accepted: make accept-conformance keeps them so.")
    assert not worse, "\n".join(worse)


EXACT, OFF, NONE = {"S/a": (9, 9)}, {"S/a": (8, 9)}, {"S/a": None}


@pytest.mark.parametrize(
    ("accepted", "found", "verdict"),
    [
        (EXACT, EXACT, (0, 0)),
        (EXACT, OFF, (1, 0)),
        (EXACT, NONE, (1, 0)),
        (EXACT, {}, (1, 0)),
        (EXACT, {"S/a": (10, 11)}, (1, 0)),
        (EXACT, {"S/a": (8, 8)}, (1, 0)),
        (EXACT, {"S/a": (11, 11)}, (0, 1)),
        (OFF, EXACT, (0, 1)),
        (OFF, {"S/a": (7, 9)}, (1, 0)),
        (OFF, {"S/a": (8, 8)}, (1, 0)),
        (OFF, OFF, (0, 0)),
        (NONE, OFF, (0, 1)),
        (NONE, NONE, (0, 0)),
        ({}, EXACT, (0, 0)),
    ],
)
def test_fewer_equal_or_compared_pixels_are_worse(accepted, found, verdict):
    assert tuple(map(len, changes(accepted, found))) == verdict


def test_accepted_counts_can_be_written_and_read():
    counts = {"S/b": None, "S/a": (8, 9)}
    assert to_text(counts) == "S/a: 8 / 9\nS/b: not covered\n"
    assert from_text(to_text(counts)) == counts
    assert to_text(from_text(ACCEPTED.read_text())) == ACCEPTED.read_text()


@pytest.mark.parametrize("page", DOCUMENTS, ids=lambda p: p.name)
def test_the_documents_say_what_was_accepted(page):
    accepted = from_text(ACCEPTED.read_text())
    assert str(totals(accepted)[1]) in page.read_text() or table(accepted) in page.read_text()
    assert with_results(page.read_text(), accepted) == page.read_text()


def test_a_suite_s_totals_are_its_cases_sums():
    counts = {"S/a": (9, 9), "S/b": (8, 9), "S/c": None, "T/a": (1, 1)}
    of_suite, whole = totals(counts)
    assert str(of_suite["S"]) == "exact: 1 of 2 cases; pixels: 17 of 18; not covered: 1"
    assert str(whole) == "exact: 2 of 3 cases; pixels: 18 of 19; not covered: 1"
    text = f"<!-- begin table -->\nold\n<!-- end table -->\n{run.Totals()}\n"
    assert with_results(text, counts) == (
        f"<!-- begin table -->\n{table(counts)}<!-- end table -->\n{whole}\n"
    )


def test_a_second_module_that_claims_a_suite_is_refused(monkeypatch):
    from fixedpipe.effects.conformance.suites import alpha_func

    monkeypatch.setattr(alpha_func, "SUITE", "2D_Lines")
    with pytest.raises(ValueError, match=r"alpha_func.py says that it is 2D_Lines; call it lines_2d.py"):
        redraw.known_suites()


def test_a_module_without_a_suite_is_refused(monkeypatch):
    from fixedpipe.effects.conformance.suites import alpha_func

    monkeypatch.delattr(alpha_func, "SUITE")
    with pytest.raises(
        ValueError, match=r"alpha_func.py lies among the suites and has no SUITE; give it the"
    ):
        redraw.known_suites()


@pytest.mark.parametrize(
    ("suite", "name"),
    [("2D_Lines", "lines_2d"), ("TextureWrapMode", "texture_wrap_mode"), ("Fog_vsh", "fog_vsh")],
)
def test_a_suites_module_has_its_words(suite, name):
    assert redraw.module_name(suite) == name
