"""``fixedpipe compare``: machines and scripts, what it says, its exit status, and what it refuses."""

import json

import pytest
from click.testing import CliRunner
from PIL import Image

from fixedpipe.effects.cli import main

SCRIPT = """
import numpy as np
from fixedpipe.pipeline import Draw, Mesh, PassState
corners = np.array([[-1.0, -1.0, 0.0], [3.0, -1.0, 0.0], [-1.0, 3.0, 0.0]])
colors = np.array([[0.9, 0.1, 0.2], [0.1, 0.8, 0.3], [0.2, 0.3, 0.7]])
commands = (Draw(label="all of it", mesh=Mesh(corners, colors=colors), state=PassState()),)
profile, width, height = "GEFORCE_256", 16, 16
"""


def said(*arguments):
    """(exit status, what it prints)."""
    result = CliRunner().invoke(main, ["compare", *map(str, arguments)])
    return result.exit_code, result.output


@pytest.fixture
def script(tmp_path):
    """A frame of one Gouraud triangle."""
    path = tmp_path / "frame.py"
    path.write_text(SCRIPT)
    return path


def test_machines_that_agree_end_with_status_0(script):
    status, text = said(script, "--machines", "GEFORCE_256", "NV2A")
    assert (status, "Every command leaves equal colours, depths and stencil values." in text) == (0, True), (
        text
    )


def test_machines_that_part_end_with_status_1(script, tmp_path):
    pytest.importorskip("matplotlib")
    picture = tmp_path / "difference.png"
    status, text = said(script, "--machines", "GEFORCE_256", "OPENGL_1_2", "--out", picture)
    assert status == 1
    assert "They first differ after command 0: all of it" in text
    assert "on GeForce 256: fragment" in text and "pixels differ, by at most" in text
    with Image.open(picture) as image:
        assert image.format == "PNG"


def test_two_scripts_are_compared(script, tmp_path):
    other = tmp_path / "other.py"
    other.write_text(SCRIPT.replace("0.7]]", "0.9]]"))
    status, text = said(script, other)
    assert (status, "They first differ after command 0: all of it" in text) == (1, True), text


def test_two_histories_are_compared(script, tmp_path):
    first, second = tmp_path / "first.json", tmp_path / "second.json"
    asked = CliRunner().invoke(main, ["inspect", str(script), "--pixel", "3,5", "--json", str(first)])
    assert asked.exit_code == 0, asked.output
    history = json.loads(first.read_text())
    second.write_text(json.dumps({**history, "profile": "another name"}))
    assert said(first, second) == (0, "The histories are the same.\n")
    stage = history["touched"][0]["fragments"][0]["stages"][-1]
    code, stage["made"][0]["codes"][1] = stage["made"][0]["codes"][1], -5
    second.write_text(json.dumps(history))
    status, text = said(first, second)
    assert status == 1
    assert "They first differ at all of it [0], fragments, [0], " in text
    assert f", {stage['title']} [" in text and f", made, {stage['made'][0]['name']} [0], codes, [1]\n" in text
    assert f"{first}: {code}\n" in text and f"{second}: -5\n" in text
    history["touched"][0]["fragments"][0]["stages"].pop()
    first.write_text(json.dumps(history))
    status, text = said(second, first)
    assert (status, f"{second}: {stage['kind']}\n  {first}: nothing\n" in text) == (1, True), text


def test_what_is_no_pair_of_histories_is_refused(script, tmp_path):
    history, other, none = tmp_path / "a.json", tmp_path / "b.json", tmp_path / "none.json"
    for path, pixel in ((history, "3,5"), (other, "4,5")):
        CliRunner().invoke(main, ["inspect", str(script), "--pixel", pixel, "--json", str(path)])
    (tmp_path / "list.json").write_text("[]")
    for arguments, sentence in (
        ((history,), "is one history; give another one"),
        ((history, other), "of pixels (3, 5) of 16x16 and (4, 5) of 16x16; give two of the same pixel"),
        ((history, none), "none.json"),
        ((history, tmp_path / "list.json"), "list.json is no history of a pixel"),
        ((history, script), "frame.py is no history of a pixel"),
        ((history, other, "--out", "x.png"), "--out"),
    ):
        status, text = said(*arguments)
        assert (status, sentence in text) == (2, True), text


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ((), "Give two machines, as --machines GEFORCE_256 GEFORCE_3, or two scripts."),
        (("--machines", "GEFORCE_256", "NONE"), "There is no profile 'NONE'"),
        (("--machines", "GEFORCE_256", "IDEAL"), "IDEAL is no machine"),
        (("small.py",), "The frames have 16x16 and 8x8 pixels; give both the same size."),
        (("none.py",), "none.py cannot be read"),
    ],
)
def test_what_cannot_be_compared_is_refused(script, monkeypatch, arguments, sentence):
    monkeypatch.chdir(script.parent)
    (script.parent / "small.py").write_text(SCRIPT.replace("16, 16", "8, 8"))
    status, text = said(script, *arguments)
    assert (status, sentence in text) == (2, True), text


def test_a_figure_drawn_by_two_methods_is_refused_with_both_named():
    status, text = said("F004-8", "--size", 16, "--machines", "GEFORCE_3", "OCTANE")
    assert status == 2
    first, second, refused = text.splitlines()
    assert first.endswith("on GeForce 3: texture shaders: dot products and dependent lookups")
    assert second.endswith("on SGI Octane: pixel textures")
    assert refused.endswith("compare frames of the same commands.")
