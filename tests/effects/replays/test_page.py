"""``replay --page``: frames on several machines, the ideal, Mesa's picture and the calls, in one file."""

import re

import pytest
from click.testing import CliRunner

from fixedpipe.effects.cli import main
from fixedpipe.effects.replays import glretrace, page
from fixedpipe.effects.replays.asked import FramesAsked
from fixedpipe.effects.replays.beside import Beside
from fixedpipe.pipeline.opengl import tokens as T
from tests.effects.replays.programs import BLUE, GREEN, replayed, started


def program():
    """A frame whose second rectangle needs two texture units, and one of a smooth blend."""
    made = started().clear(BLUE).rectangle(GREEN, 0.0).swap()
    made.call("glEnable", T.BLEND).call("glBlendFunc", T.SRC_ALPHA, T.ONE_MINUS_SRC_ALPHA)
    made.clear(BLUE).rectangle((0.3, 0.6, 0.1, 0.35)).swap()
    made.call("glActiveTexture", T.TEXTURE1).call("glEnable", T.TEXTURE_2D)
    made.call("glTexParameteri", T.TEXTURE_2D, T.TEXTURE_MIN_FILTER, T.NEAREST)
    made.call("glTexImage2D", T.TEXTURE_2D, 0, T.RGBA, 1, 1, 0, T.RGBA, T.UNSIGNED_BYTE, b"abcd")
    return made.rectangle(GREEN).swap()


def said(*arguments):
    result = CliRunner().invoke(main, ["replay", *map(str, arguments)])
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exc_info
    return result.exit_code, " ".join(result.output.split())


def test_a_page_has_frames_machines_the_ideal_and_calls(tmp_path, monkeypatch):
    monkeypatch.setattr(glretrace, "missing", lambda: "glretrace is not installed.")
    path, file = program().write(tmp_path / "<game>.trace"), tmp_path / "game.html"
    status, text = said(path, "--frames", "0-1", "--page", file)
    assert status == 0 and "Without Mesa's pictures: glretrace is not installed." in text
    html = file.read_text()
    captions = re.findall(r"<figcaption>(.*?)</figcaption>", html)
    assert captions[:4] == [
        "GeForce 256",
        *[
            f"{name}<br>100 % equal, 100 % within 1, 100 % within 8, largest difference 0"
            for name in ("OpenGL 1.2", "GeForce 3", "The ideal, which rounds nothing")
        ],
    ]
    assert "Frame 0 <span>1 draw, calls 0 to" in html and "Frame 1 <span>" in html
    assert "<title>&lt;game&gt;.trace</title>" in html and "<script" not in html and "http" not in html
    calls = html[html.index("What became of the calls") :]
    assert "<li>drawn: 2 (glEnd 2)</li>" in calls and "<h3>OpenGL 1.2</h3>" in calls


def test_a_machine_that_refuses_a_draw_is_seen(tmp_path):
    path = str(program().write(tmp_path / "game.trace"))
    html = page.trace_page(path, "GEFORCE_256", FramesAsked.of("2"), mesa=False)
    assert "refused: 1" in html and "texture unit 1 is enabled, and OpenGL 1.2 has 1" in html
    assert "Difference: OpenGL 1.2" in html and "Difference: GeForce 3" not in html


def test_mesas_picture_is_compared_only_where_it_is_trusted(tmp_path, monkeypatch):
    path = str(program().write(tmp_path / "game.trace"))
    image = replayed(program())[1][0].image[..., :3]
    for mesa, words in (
        (Beside(image), "Mesa's llvmpipe".replace("'", "&#x27;") + "<br>100 % equal"),
        (Beside(image, "not to be trusted"), "<br>not to be trusted"),
        (Beside(None, "glretrace wrote nothing"), "Mesa: glretrace wrote nothing"),
    ):
        monkeypatch.setattr(page, "mesas_pictures", lambda path, calls, mesa=mesa: [mesa])
        html = page.trace_page(path, "GEFORCE_256", FramesAsked.of("0"), mesa=True)
        assert words in html


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["-", "--page", "a.html"], "give a file"),
        (["a.trace", "--page", "a.txt"], "must end with .html"),
        (["a.trace", "--page", "a.html", "--json", "b.json"], "writes nothing but the page"),
        (["a.trace", "--page", "a.html", "--frames", "all"], "up to 24 frames"),
        (["a.trace", "--page", "a.html", "--frames", "7"], "has no frame 7"),
        (["a.trace", "--page", "a.html", "--profile", "VOODOO"], "VOODOO"),
        (["absent.trace", "--page", "a.html"], "cannot be read"),
    ],
)
def test_what_a_page_cannot_be_is_refused(arguments, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(glretrace, "missing", lambda: "glretrace is not installed.")
    program().write(tmp_path / "a.trace")
    status, text = said(*arguments)
    assert status == 2 and words in text
    assert not (tmp_path / "a.html").exists()
