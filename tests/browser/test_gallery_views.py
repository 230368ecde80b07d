"""The gallery in a browser: panels as layers, linked places, crops, exposure, numbers in pixels."""

import base64
import io

import numpy as np
import pytest
from PIL import Image

from tests.browser.made_gallery import EDGE
from tests.browser.test_gallery import (
    FIGURE,
    address_has,
    is_pressed,
    loupe,
    magnified,
    pixels,
    press,
    scale,
    seen,
    stage,
)


def panel_of(made, number, machine="GEFORCE_3", view="machine"):
    return made.codes["F003-21", machine, view][:, (number - 1) * EDGE : number * EDGE].astype(np.int64)


def test_a_panel_is_seen_alone_and_flipped_in_place(visit, made):
    page = stage(visit(FIGURE + "?labels=no&zoom=8"))
    for number in (1, 3, 2):
        press(page, f"Shift+Digit{number}")
        np.testing.assert_array_equal(seen(page), magnified(panel_of(made, number), 8))
    assert is_pressed(page, "correct") and address_has(page, "panel=2")
    press(page, ".")
    np.testing.assert_array_equal(seen(page), magnified(panel_of(made, 3), 8))
    assert address_has(page, "panel=3")
    page.reload()
    np.testing.assert_array_equal(seen(stage(page)), magnified(panel_of(made, 3), 8))
    press(page, "Shift+Digit0")
    assert page.get_attribute("[data-panel='0']", "aria-pressed") == "true"


def test_any_two_panels_are_subtracted_wiped_and_paired(visit, made):
    page = stage(visit(FIGURE + "?labels=no&zoom=8&panel=3"))
    press(page, "m")
    page.select_option("select[aria-label='Panel beside it']", "2")
    page.locator(".figure h1").focus()
    for _ in range(8):
        press(page, "[")
    delta = panel_of(made, 3) - panel_of(made, 2)
    np.testing.assert_array_equal(seen(page), magnified(np.clip(128 + delta, 0, 255), 8))
    largest = np.abs(delta).max()
    said = page.inner_text(".status")
    assert f"largest {largest / 255:.4g}".rstrip("0") in said and "too much" in said and "correct" in said
    press(page, "d", "l")
    press(page, "w")
    found = seen(page)
    middle = pixels(page).shape[1] // 2 - (pixels(page).shape[1] - found.shape[1]) // 2
    np.testing.assert_array_equal(found[:, :middle], magnified(panel_of(made, 3), 8)[:, :middle])
    np.testing.assert_array_equal(found[:, middle:], magnified(panel_of(made, 2), 8)[:, middle:])
    press(page, "p")
    assert page.locator(".overlay .side").all_inner_texts() == ["too much, GeForce 3", "correct, GeForce 3"]


def test_panels_of_different_views_are_subtracted(visit, made):
    page = stage(visit(FIGURE + "?labels=no&zoom=8&panel=1&how=minus&against=ideal&beside=2&gain=1"))
    delta = panel_of(made, 1) - panel_of(made, 2, view="ideal")
    np.testing.assert_array_equal(seen(page), magnified(np.clip(128 + delta, 0, 255), 8))


def test_all_panels_show_one_place(visit, made):
    page = stage(visit(FIGURE + "?labels=no&how=panels&zoom=16&centre=20|20", height=800))
    box = page.locator(".stage").bounding_box()
    press(page, "l")
    places = []
    for label in page.locator(".overlay .side").all():
        at = label.bounding_box()
        page.mouse.move(at["x"] + 150, at["y"] - 40)
        (x, y), rows = loupe(page)
        places.append((x // EDGE, x % EDGE, y))
        assert rows["machine"] == list(made.codes["F003-21", "GEFORCE_3", "machine"][y, x])
    assert [panel for panel, _, _ in places] == [0, 1, 2]
    assert len({x for _, x, _ in places}) == 1 and len({y for _, _, y in places}) == 1
    assert box["height"] > 0


def test_crops_show_one_place_of_all_machines_and_are_saved(visit, made):
    page = stage(visit(FIGURE + "?crop=44|5|24"))
    page.wait_for_function("document.querySelectorAll('.strip figure').length === 5")
    # NV2A has the GeForce 3's bits and is left out.
    names = page.locator(".strip figcaption").all_inner_texts()
    assert names == ["GeForce 3", "ideal", "reference", "SGI Octane", "SGI InfiniteReality"]
    for name, machine, view in (
        ("GeForce 3", "GEFORCE_3", "machine"),
        ("ideal", "GEFORCE_3", "ideal"),
        ("SGI Octane", "OCTANE", "machine"),
    ):
        address = page.evaluate(
            "name => document.querySelector(`[data-crop='${name}'] canvas`).toDataURL('image/png')", name
        )
        found = np.asarray(Image.open(io.BytesIO(base64.b64decode(address.split(",")[1]))).convert("RGB"))
        np.testing.assert_array_equal(found, magnified(made.codes["F003-21", machine, view][5:29, 44:68], 8))
    with page.expect_download() as download:
        page.click("button:text-is('save the strip')")
    strip = np.asarray(Image.open(download.value.path()).convert("RGB"))
    assert download.value.suggested_filename == "F003-21-GEFORCE_3-crops.png"
    np.testing.assert_array_equal(
        strip[: 24 * 8, : 24 * 8], magnified(made.codes["F003-21", "GEFORCE_3", "machine"][5:29, 44:68], 8)
    )
    below = strip[24 * 8 :]
    assert (below == 255).all(-1).mean() > 0.5 and (below < 80).all(-1).sum() > 50  # names in black on white


def test_the_frame_of_the_crops_is_dragged(visit):
    page = stage(visit(FIGURE + "?zoom=4&crop=44|5|24&labels=no"))
    frame = page.locator(".crop").bounding_box()
    page.mouse.move(frame["x"] + 20, frame["y"] + 20)
    page.mouse.down()
    page.mouse.move(frame["x"] + 30, frame["y"] + 30)
    page.mouse.move(frame["x"] + 40, frame["y"] + 40)
    page.mouse.up()
    assert address_has(page, "crop=49%7C10%7C24")


def test_exposure_and_false_color_are_of_the_codes(visit, made):
    page = stage(visit(FIGURE + "?labels=no&zoom=8&panel=1"))
    press(page, "e", "e")
    np.testing.assert_array_equal(seen(page), magnified(np.clip(4 * panel_of(made, 1), 0, 255), 8))
    assert "Shown \u00d7 4" in page.inner_text(".status")
    press(page, "E", "E", "f")
    light = panel_of(made, 1) @ [0.2126, 0.7152, 0.0722]
    found = seen(page)[::8, ::8]
    order = np.argsort(light.ravel())
    brightness = found.reshape(-1, 3).astype(int).sum(-1)[order]
    assert (np.diff(brightness) >= -1).all() and brightness[-1] > brightness[0] + 100


@pytest.mark.parametrize(("zoom", "written"), [(8, False), (16, True), (32, True)])
def test_pixels_show_their_numbers_from_sixteen_to_one(visit, made, zoom, written):
    page = stage(visit(FIGURE + f"?labels=no&panel=1&zoom={zoom}&centre=20|20"))
    found = seen(page)
    whole = magnified(panel_of(made, 1), zoom)
    if found.shape == whole.shape:
        assert (found != whole).any() == written
    else:
        pixel = found[:zoom, :zoom].reshape(-1, 3)
        assert (len(np.unique(pixel, axis=0)) > 1) == written


def test_keys_live_after_a_choice_of_machine_and_machines_follow_the_arrows(visit, made):
    page = stage(visit(FIGURE + "?labels=no"))
    page.click("[data-machine=OCTANE]")
    page.wait_for_selector("[data-machine=OCTANE][aria-pressed=true]")
    press(page, "2")
    assert is_pressed(page, "ideal")
    press(page, "1", "ArrowDown")
    page.wait_for_selector("[data-machine=INFINITE_REALITY][aria-pressed=true]")
    press(page, "ArrowDown")  # NV2A has the GeForce 3's bits and is passed over
    page.wait_for_selector("[data-machine=GEFORCE_3][aria-pressed=true]")
    np.testing.assert_array_equal(
        seen(stage(page)), magnified(made.codes["F003-21", "GEFORCE_3", "machine"], scale(page))
    )
    page.select_option("select[aria-label='Machine B']", "OCTANE")
    page.focus("select[aria-label='Machine B']")
    page.wait_for_selector("button[data-view=other]")
    press(page, "6")
    assert is_pressed(page, "\u2212 B") and "RMS" in page.inner_text(".status")


def test_what_is_not_there_is_said(visit):
    page = stage(visit("#K12"))
    press(page, "b")
    assert page.inner_text(".hint") == "Choose machine B first."
    press(page, "3")
    assert page.inner_text(".hint") == "This figure has no reference here."
    press(page, "a")
    assert page.inner_text(".hint") == "This figure has one panel."


def test_a_small_letter_in_an_address_is_as_good(visit):
    page = stage(visit("#f003-21/octane/ideal"))
    assert "F003-21" in page.inner_text("h1") and is_pressed(page, "ideal")
    assert page.get_attribute("[data-machine=OCTANE]", "aria-pressed") == "true"


@pytest.mark.parametrize(
    ("words", "found"),
    [
        ("pcf", False),
        ("figure 21", True),
        ("figure 2", False),
        ("F3-21", True),
        ("stripes", True),
        ("tripes", False),
        ("too much", True),
        ("cube maps", False),
        ("six shadow maps", False),
    ],
)
def test_search_asks_must_see_labels_and_numbers_at_word_starts(visit, words, found):
    page = visit()
    page.fill("#search", words)
    shown = page.eval_on_selector_all(".card a", "cards => cards.map(card => card.dataset.id)")
    assert ("F003-21" in shown) == found
