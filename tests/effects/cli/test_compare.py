"""``fixedpipe compare``: machines and scripts, what it says, its exit status, and what it refuses."""

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
    assert (status, "Every command leaves the same." in text) == (0, True), text


def test_machines_that_part_end_with_status_1(script, tmp_path):
    pytest.importorskip("matplotlib")
    picture = tmp_path / "difference.png"
    status, text = said(script, "--machines", "GEFORCE_256", "OPENGL_1_2", "--out", picture)
    assert status == 1
    assert "They part at command 0: all of it" in text
    assert "on GeForce 256: fragment" in text and "pixels differ, by at most" in text
    with Image.open(picture) as image:
        assert image.format == "PNG"


def test_two_scripts_are_compared(script, tmp_path):
    other = tmp_path / "other.py"
    other.write_text(SCRIPT.replace("0.7]]", "0.9]]"))
    status, text = said(script, other)
    assert (status, "They part at command 0: all of it" in text) == (1, True), text


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
