"""``fixedpipe print``: the files that it writes, and what it refuses before anything is drawn."""

import sys

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

from fixedpipe.effects.bibliography import citation
from fixedpipe.effects.cli import main
from fixedpipe.effects.figures import FIGURES
from tests.effects.cli.test_cli import HALVES

pytest.importorskip("matplotlib")


def run(*arguments):
    return CliRunner().invoke(main, ["print", *map(str, arguments)], env={"COLUMNS": "200"})


def refusal_of(*arguments):
    result = run(*arguments)
    assert result.exit_code == 2 and result.stdout == "", result.output
    return result.stderr.strip().splitlines()[-1]


def test_it_writes_a_sheet_and_its_citation_under_a_name_of_its_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = run("K14", "--size", 32, "--width", 90)
    assert result.exit_code == 0, result.output
    assert {path.name for path in tmp_path.iterdir()} == {
        "K14-GEFORCE_256-paper.png",
        "K14-GEFORCE_256-paper.bib",
    }
    assert result.stdout.startswith("K14-GEFORCE_256-paper.png: 90 x ")
    with Image.open(tmp_path / "K14-GEFORCE_256-paper.png") as page:
        assert page.info["Title"] == f"K14. {FIGURES['K14'].title}"
    beside = (tmp_path / "K14-GEFORCE_256-paper.bib").read_text()
    assert beside.endswith(citation(FIGURES["K14"].source).bibtex)


@pytest.mark.parametrize("kind", ["pdf", "svg"])
def test_the_name_says_which_file_it_is(tmp_path, kind):
    out = tmp_path / f"sheet.{kind}"
    result = run(
        "K14", "--profile", "IDEAL", "--size", 32, "--style", "slide", "--set", "light=1,1,1", "--out", out
    )
    assert result.exit_code == 0, result.output
    assert "every panel with its own pixels" in result.stdout
    assert out.read_bytes().startswith(b"%PDF" if kind == "pdf" else b"<?xml")
    assert "--set light=1,1,1" in (tmp_path / "sheet.bib").read_text()


@pytest.mark.parametrize("kind", ["png", "pdf", "svg"])
def test_a_script_s_frame_is_printed_without_a_paper(tmp_path, monkeypatch, kind):
    monkeypatch.chdir(tmp_path)
    script = tmp_path / "halves.py"
    script.write_text(HALVES)
    result = run("halves.py", "--width", 90, "--out", f"sheet.{kind}")
    assert result.exit_code == 0, result.output
    beside = (tmp_path / "sheet.bib").read_text()
    assert beside == (
        "% halves.py. A script's frame\n% The frame that halves.py makes.\n"
        "% halves.py on the GeForce 256 (the script's commands), bit for bit; ideal: the same fragments in "
        "float64. Panels of 4 pixels.\n"
        "% Drawn by: fixedpipe print halves.py --profile GEFORCE_256 --style paper --width 90\n"
    )
    assert result.stdout.endswith("sheet.bib: its caption and its command\n")
    if kind == "png":
        with Image.open(tmp_path / "sheet.png") as page:
            assert (128, 64, 32) in {color for _, color in page.getcolors(1 << 24)}


def test_a_script_s_sheet_is_named_by_it_and_what_is_a_figure_s_is_refused(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "halves.py").write_text(HALVES)
    assert run("halves.py", "--profile", "IDEAL", "--style", "slide").exit_code == 0
    assert (tmp_path / "halves-IDEAL-slide.png").is_file()
    assert "a script says its own width" in refusal_of("halves.py", "--size", "8")
    assert "has no picture 'reference'" in refusal_of("halves.py", "--pictures", "reference")
    (tmp_path / "none.py").write_text("commands, width, height, profile = (), 0, 8, 'NV2A'")
    assert "0" in refusal_of("none.py")


@pytest.mark.parametrize("machine", ["OPENGL_1_2", "IDEAL"])
def test_a_diagram_is_printed_on_white_and_its_command_says_so(tmp_path, machine):
    name = tmp_path / "angles.png"
    asked = "--profile", machine, "--palette", "paper", "--size", "128", "--out", name
    assert run("F000-1", *asked).exit_code == 0
    assert "--palette paper" in name.with_suffix(".bib").read_text()
    with Image.open(name) as image:
        assert (np.asarray(image.convert("RGB")) == 255).all(axis=-1).mean() > 0.5


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("torus",), "There is no figure 'torus'"),
        (("K14", "--profile", "OCTANE"), "K14 cannot be drawn on OCTANE"),
        (("K14", "--out", "sheet.gif"), "must end with one of .png, .pdf, .svg"),
        (("K14", "--out", "sheet.pdf", "--dpi", "300"), "--dpi would be ignored"),
        (("K14", "--style", "postre"), "There is no style 'postre'"),
        (("K14", "--width", "1"), "The width is 1 mm"),
        (("K14", "--palette", "paper"), "K14 is no diagram"),
        (("K14", "--pictures", "machine,refrence"), "Did you mean reference"),
        (("K14", "--size", "4096"), "draws up to 2048x2048"),
        (("K14", "--set", "light=0,0,0"), "not all zero"),
        (("K14", "--size", "512", "--width", "50", "--dpi", "72"), "pixels are never merged"),
    ],
)
def test_what_cannot_be_printed_is_refused_and_nothing_is_written(tmp_path, monkeypatch, arguments, words):
    monkeypatch.chdir(tmp_path)
    assert words in refusal_of(*arguments)
    assert not list(tmp_path.iterdir())


def test_without_matplotlib_it_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    assert refusal_of("K14").endswith("which is not installed: pip install 'fixedpipe[plots]'.")
    assert not list(tmp_path.iterdir())
