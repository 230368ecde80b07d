"""The page of golden pictures in a browser: what is shown and said are the pictures' own bytes."""

import base64
import io

import numpy as np
import pytest
from PIL import Image

from fixedpipe.effects.reports.golden.page import golden_page
from fixedpipe.effects.reports.golden.results import results
from fixedpipe.pipeline.framebuffers.pictures import whole_png
from fixedpipe.pipeline.golden.candidates import CHANGED, EXCUSED, NEW, Candidate, write_candidate, write_run
from fixedpipe.pipeline.golden.store import change_store, golden_of, picture_path, write_whole
from tests.browser.conftest import HANGS

HOSTILE = "</script><b>&\"' é"
RANDOM = np.random.default_rng(3)
RGBA = RANDOM.integers(0, 256, (9, 12, 4), np.uint8)
DEEP = RANDOM.integers(0, 65536, (7, 5, 3), np.uint16)
GREY = RANDOM.integers(0, 256, (40, 150, 1), np.uint8)  # wider than what was drawn, and than 16 times fits
SMOOTH = np.tile(np.arange(16, dtype=np.uint8)[:, None, None] * 9, (1, 10, 2))


def changed(picture, *changes):
    """The picture with bits of some components changed: (row, column, component, bits)."""
    picture = picture.copy()
    for y, x, component, by in changes:
        picture[y, x, component] ^= picture.dtype.type(by)
    return picture


# {name: (golden or None, now)}
PICTURES = {
    "rgba": (RGBA, changed(RGBA, (2, 3, 0, 7), (2, 4, 1, 250), (8, 11, 3, 3))),
    "deep": (DEEP, changed(DEEP, (6, 4, 1, 1))),
    "alpha": (SMOOTH, changed(SMOOTH, (1, 2, 1, 2))),
    "size": (GREY, RGBA[:3, :5]),
    HOSTILE: (None, RGBA),
}


@pytest.fixture(scope="module")
def page_file(tmp_path_factory):
    root = tmp_path_factory.mktemp("golden-page")
    run = {}
    for key, (golden, now) in PICTURES.items():
        store, name = root / "golden" / "test_a.json", f"test_a.py::{key}"
        if golden is not None:
            change_store(store, {key: golden_of(golden)})
            write_whole(picture_path(store, key), whole_png(golden))
        status = NEW if golden is None else CHANGED
        expected = None if golden is None else golden_of(golden).sha256
        waiting = Candidate(
            name, "golden/test_a.json", key, status, golden_of(now), expected, f"<i>{key}</i>"
        )
        write_candidate(root, waiting, now)
        run[name] = {"status": status, "store": "golden/test_a.json", "key": key, "test": name}
    run["test_a.py::skipped"] = {"status": EXCUSED, "store": "golden/test_a.json", "key": "s", "test": "s"}
    write_run(root, run)
    path = root / "page.html"
    path.write_text(golden_page(root, results(root)), encoding="utf-8")
    return path


@pytest.fixture
def page(browser, page_file):
    """The page, opened from its file; errors and requests of any other file or host fail the test."""
    context = browser.new_context(viewport={"width": 1400, "height": 900})
    context.set_default_timeout(HANGS)
    opened, wrong = context.new_page(), []
    opened.on("pageerror", lambda error: wrong.append(str(error)))
    opened.on("request", lambda r: r.url == page_file.as_uri() or wrong.append(r.url))
    opened.goto(page_file.as_uri())
    yield opened
    context.close()
    assert wrong == []


def show(page, name, view=None):
    """Choose a picture, and a view by its key."""
    page.locator("nav button").filter(has_text=f"test_a.py::{name}").click()
    page.wait_for_selector(".stage canvas")
    if view is not None:
        page.keyboard.press(view)
    page.wait_for_selector(".stage canvas")


def canvases(page):
    """What the canvases hold, in order: [height, width, 3] each."""
    found = page.eval_on_selector_all(".stage canvas", "all => all.map(c => c.toDataURL('image/png'))")
    images = [Image.open(io.BytesIO(base64.b64decode(url.split(",")[1]))) for url in found]
    assert all((np.asarray(image.convert("RGBA"))[..., 3] == 255).all() for image in images)
    return [np.asarray(image.convert("RGB")) for image in images]


def colors(picture, alpha=False):
    """A picture's opaque bytes as the page shows them."""
    small = (picture >> 8).astype(np.uint8) if picture.dtype == np.uint16 else picture
    if alpha:
        return np.repeat(small[..., -1:], 3, axis=2)
    return np.repeat(small[..., :1], 3, axis=2) if small.shape[2] < 3 else small[..., :3]


def test_the_largest_difference_comes_first_and_what_needs_nobody_last(page):
    names = [text.split("\n")[0] for text in page.locator("nav button").all_inner_texts()]
    order = ["rgba", "alpha", "deep", "size", HOSTILE, "skipped"]
    assert names == [f"test_a.py::{name}" for name in order]
    heads = page.locator("nav h2").all_inner_texts()
    assert heads == [
        "4 differ from what is golden",
        "1 has no golden picture yet",
        "1 is excused: its test was skipped, or failed as it was expected to",
    ]
    assert page.inner_text("article h2") == "test_a.py::rgba"


@pytest.mark.parametrize("name", ["rgba", "deep", "alpha"])
def test_every_view_shows_the_bytes(page, name):
    golden, now = PICTURES[name]
    apart = np.abs(golden.astype(int) - now)
    most = 65535 if golden.dtype == np.uint16 else 255
    gained = np.minimum(most, apart * (most // apart.max())).astype(golden.dtype)
    has_alpha = golden.shape[2] % 2 == 0
    lone = (
        (apart[..., -1] > 0) & ~apart[..., :-1].any(axis=2) if has_alpha else np.zeros(apart.shape[:2], bool)
    )
    orange = np.array([255, 170, 40])
    shown = colors(gained).copy()
    shown[lone] = np.rint(orange * colors(gained, True)[lone] / 255 - 1e-9)
    mask = np.where(apart.any(axis=2)[..., None], 255, np.array([24, 26, 30]))
    mask[lone] = orange

    show(page, name, "1")
    beside = canvases(page)
    assert len(beside) == 3
    for found, wanted in zip(beside, (colors(golden), colors(now), shown), strict=True):
        np.testing.assert_allclose(found, wanted, atol=0 if wanted is not shown else 1)
    for key, wanted in (("2", colors(golden)), ("3", colors(now)), ("5", mask)):
        show(page, name, key)
        (found,) = canvases(page)
        np.testing.assert_array_equal(found, wanted)
    show(page, name, "4")
    np.testing.assert_allclose(canvases(page)[0], shown, atol=1)
    for key in ("6", "7"):
        show(page, name, key)
        found = canvases(page)
        np.testing.assert_array_equal(found[0], colors(golden))
        np.testing.assert_array_equal(found[1], colors(now))
    if has_alpha:
        show(page, name, "2")
        page.keyboard.press("a")
        page.wait_for_function("document.querySelector('.stage').dataset.view === 'golden'")
        np.testing.assert_array_equal(canvases(page)[0], colors(golden, True))


@pytest.mark.parametrize(("name", "letters"), [("rgba", "RGBA"), ("deep", "RGB"), ("alpha", "LA")])
def test_the_bytes_under_the_pointer_are_the_pictures(page, name, letters):
    golden, now = PICTURES[name]
    show(page, name, "3")
    box = page.locator(".stage canvas").bounding_box()
    height, width = now.shape[:2]
    for y, x in [(0, 0), (height - 1, width - 1), *np.argwhere((golden != now).any(axis=2)).tolist()]:
        page.mouse.move(
            box["x"] + (x + 0.5) * box["width"] / width, box["y"] + (y + 0.5) * box["height"] / height
        )
        first, *rows = page.inner_text(".under").split("\n")
        assert first == f"x {x}, y {y}"
        for row, picture in zip(rows, (golden, now), strict=True):
            said = dict(zip(row.split()[1::2], map(int, row.split()[2::2]), strict=True))
            assert said == dict(zip(letters, picture[y, x].tolist(), strict=True))


def test_pictures_of_two_kinds_are_shown_beside_each_other_at_one_scale(page):
    show(page, "size", "1")
    golden, now = PICTURES["size"]
    found = canvases(page)
    assert len(found) == 2
    np.testing.assert_array_equal(found[0], colors(golden))
    np.testing.assert_array_equal(found[1], colors(now))
    boxes = [page.locator(".stage canvas").nth(k).bounding_box() for k in (0, 1)]
    assert boxes[0]["width"] / golden.shape[1] == boxes[1]["width"] / now.shape[1]
    assert boxes[0]["y"] == boxes[1]["y"]
    stage = page.locator(".stage").bounding_box()
    assert boxes[1]["x"] + boxes[1]["width"] <= stage["x"] + stage["width"]
    disabled = page.locator("article button:disabled").all_inner_texts()
    assert disabled == ["difference", "mask", "flip", "slide"]


def test_flip_and_slide(page):
    show(page, "rgba", "6")
    visible = "getComputedStyle(document.querySelectorAll('.stage canvas')[1]).visibility"
    assert page.evaluate(visible) == "hidden"
    page.keyboard.press(" ")
    assert (page.evaluate(visible), page.inner_text(".stage figcaption")) == ("visible", "now")
    page.locator(".stage .over").click()
    assert (page.evaluate(visible), page.inner_text(".stage figcaption")) == ("hidden", "golden")
    page.keyboard.press("7")
    page.wait_for_selector(".stage input[type=range]")
    page.locator(".stage input[type=range]").fill("250")
    cut = page.evaluate("document.querySelectorAll('.stage canvas')[1].style.clipPath")
    assert "25%" in cut


def test_all_is_reached_by_keys_and_the_command_is_copied(page):
    assert page.inner_text("article h2").endswith("rgba")
    page.keyboard.press("ArrowDown")
    page.keyboard.press("j")
    assert page.inner_text("article h2").endswith("deep")
    page.keyboard.press("k")
    page.keyboard.press("ArrowUp")
    page.keyboard.press("ArrowUp")
    assert page.inner_text("article h2").endswith("rgba")
    names = set()
    for _ in range(40):
        page.keyboard.press("Tab")
        names.add(page.evaluate("document.activeElement.textContent"))
    assert {"copy", "side by side", "slide", "16", "alpha"} <= names
    page.locator("button.copy").click()
    assert page.inner_text("article [role=status]") == "copied"
    page.evaluate("document.body.append(document.createElement('textarea'))")
    page.locator("body > textarea").focus()
    page.keyboard.press("Control+v")
    assert page.input_value("body > textarea") == "fixedpipe golden accept test_a.py::rgba"


def test_names_and_sentences_are_text_with_script_and_without(page, browser, page_file):
    show(page, "</script>")
    assert page.inner_text("article h2") == f"test_a.py::{HOSTILE}"
    assert page.inner_text("article pre") == f"<i>{HOSTILE}</i>"
    assert page.locator("article b, article i").count() == 0
    np.testing.assert_array_equal(canvases(page)[0], colors(RGBA))
    plain = browser.new_context(java_script_enabled=False).new_page()
    plain.goto(page_file.as_uri())
    text = plain.inner_text("noscript")
    assert f"<i>{HOSTILE}</i>" in text
    assert "fixedpipe golden accept test_a.py::rgba" in text
    plain.context.close()
