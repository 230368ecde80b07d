"""The gallery in a browser, from files: what a reader finds, sees and reads is what was drawn."""

import base64
import io
import json
import struct
import zlib

import numpy as np
import pytest
from PIL import Image

from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.reports.figure_failures import failure
from fixedpipe.effects.reports.figure_files import write_page
from tests.browser.made_gallery import EDGE, FIGURES, HOSTILE, VARIANT, Made, codes_of, drawn, figure

FIGURE = "#F003-21/GEFORCE_3/machine"
READY, FAILURE = ".stage[aria-busy=false]", ".figure > [role=alert]:not([hidden])"


def stage(page):
    """Waits until the figure's pictures are there."""
    page.wait_for_selector(f"{READY}, {FAILURE}")
    assert page.locator(FAILURE).all_inner_texts() == []
    return page


def pixels(page):
    """What the stage's canvas holds: [height, width, 4]."""
    address = page.evaluate("document.querySelector('.stage canvas').toDataURL('image/png')")
    return np.asarray(Image.open(io.BytesIO(base64.b64decode(address.split(",")[1]))).convert("RGBA"))


def seen(page):
    """The pictures on the stage without what is around them: [height, width, 3]."""
    found = pixels(page)
    drawn = found[..., 3] > 0
    rows, columns = np.flatnonzero(drawn.any(1)), np.flatnonzero(drawn.any(0))
    return found[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1, :3]


def magnified(codes, by):
    return np.kron(codes[..., :3].astype(np.uint8), np.ones((by, by, 1), np.uint8))


def scale(page):
    return int(page.get_attribute(".stage", "data-scale"))


def loupe(page):
    """The loupe's place and rows, by name."""
    place = page.inner_text(".loupe p b")
    x, y = (int(part.split()[1]) for part in place.split(", "))
    rows = {
        row.get_attribute("data-row"): [
            float(cell.replace("\u2212", "-")) for cell in row.locator("td").all_inner_texts() if cell
        ]
        for row in page.locator(".loupe tbody tr").all()
    }
    return (x, y), rows


def ids(page):
    return page.eval_on_selector_all(".card a", "cards => cards.map(card => card.dataset.id)")


def press(page, *keys):
    for key in keys:
        page.keyboard.press(key)


def address_has(page, part):
    """Waits until the address has that part: it follows a little later where much changes."""
    page.wait_for_function("part => location.href.includes(part)", arg=part)
    return True


def is_pressed(page, text):
    return page.locator(f".bar button:has-text('{text}')").first.get_attribute("aria-pressed") == "true"


# --------------------------------------------------------------------------------------------------- grid


def test_the_grid_has_every_figure_by_paper_with_its_citation(visit, made):
    page = visit()
    page.wait_for_selector(".card")
    assert ids(page) == list(made.records)
    first, second = page.locator(".papers section").all_inner_texts()
    assert "Bump Mapping and Shadows" in first and "Matthias Zwicker. 2016" in first
    assert "Jan Kautz and Hans-Peter Seidel. 2000" in second and "1 failed" in second
    assert page.inner_text(".count") == "4 figures"
    page.wait_for_function("[...document.images].every((image) => image.naturalWidth > 0)")


@pytest.mark.parametrize(
    ("words", "found"),
    [
        ("brushed", ["F004-4", VARIANT]),
        ("f003-21", ["F003-21"]),
        ("infinitereality", ["F003-21"]),
        ("z10 octane", ["F003-21", "K12"]),
        ("what shows kautz", ["F004-4", VARIANT]),
        ("nothing of this", []),
    ],
)
def test_search_asks_ids_titles_captions_techniques_and_machines(visit, words, found):
    page = visit()
    page.fill("#search", words)
    assert ids(page) == found
    assert page.inner_text(".count") == f"{len(found)} of 4 figures"
    assert address_has(page, "q=")
    page.reload()
    page.wait_for_selector("#search")
    assert ids(page) == found
    page.click("text=Show all")
    assert len(ids(page)) == 4 and page.input_value("#search") == ""


def test_chips_narrow_by_paper_machine_method_and_verdict(visit):
    page = visit()
    chip = lambda text: page.locator(f".chip:has-text('{text}')").first  # noqa: E731
    chip("SGI Octane").click()
    assert ids(page) == ["F003-21", "K12"]
    assert chip("SGI Octane").get_attribute("aria-pressed") == "true"
    chip("machines differ").click()
    assert ids(page) == ["F003-21"]
    page.click("text=Show all")
    chip("failed").click()
    assert ids(page) == ["F004-4"]
    page.click("text=Show all")
    chip("Zwicker 2016").click()
    assert ids(page) == ["F003-21", "K12"]
    page.click("text=Methods")
    chip("depth texture").click()
    assert ids(page) == ["F003-21"]
    chip("depth texture").click()
    chip("Zwicker 2016").click()
    assert len(ids(page)) == 4


# -------------------------------------------------------------------------------------------------- stage


def test_keys_flip_what_was_drawn_bit_for_bit_in_place(visit, made):
    page = stage(visit(FIGURE + "?labels=no"))
    for key, view in (("1", "machine"), ("2", "ideal"), ("1", "machine")):
        press(page, key)
        np.testing.assert_array_equal(
            seen(page), magnified(made.codes["F003-21", "GEFORCE_3", view], scale(page))
        )
    press(page, "3")
    np.testing.assert_array_equal(
        seen(page), magnified(made.codes["F003-21", "GEFORCE_3", "reference"][:, : 2 * EDGE], scale(page))
    )
    assert "no reference" in page.inner_text(".overlay")
    page.click(".bar button:has-text('ideal')")
    assert is_pressed(page, "ideal") and address_has(page, "/ideal")


def test_a_difference_is_computed_from_the_bytes_with_the_records_gain_and_others(visit, made):
    page = stage(visit("#F003-21/GEFORCE_3/difference?labels=no"))
    machine, ideal = (made.codes["F003-21", "GEFORCE_3", view] for view in ("machine", "ideal"))
    shown = lambda gain: np.clip(128 + gain * (machine - ideal), 0, 255)  # noqa: E731
    np.testing.assert_array_equal(seen(page), magnified(shown(16), scale(page)))
    press(page, "]")
    np.testing.assert_array_equal(seen(page), magnified(shown(32), scale(page)))
    slider = page.locator("input[aria-label='Gain of the difference']")
    slider.focus()
    press(page, "Home")
    assert slider.get_attribute("aria-valuetext") == "times 1"
    np.testing.assert_array_equal(seen(page), magnified(shown(1), scale(page)))
    assert address_has(page, "gain=1")
    page.locator(".figure h1").focus()
    press(page, "c")
    np.testing.assert_array_equal(seen(page), magnified(np.abs(machine - ideal), scale(page)))
    press(page, "c")
    assert address_has(page, "color") and len(np.unique(seen(page).reshape(-1, 3), axis=0)) <= 256


def test_what_is_identical_is_written_and_not_drawn(visit):
    page = stage(visit("#K12/OCTANE/difference"))
    assert "Identical" in page.inner_text(".overlay")
    assert not pixels(page).any()
    press(page, "1")
    assert pixels(page).any()


def test_a_wipe_has_both_pictures_and_its_divider_is_dragged_or_moved_by_keys(visit, made):
    page = stage(visit(FIGURE + "?labels=no"))
    press(page, "w")
    machine, ideal = (
        magnified(made.codes["F003-21", "GEFORCE_3", view], scale(page)) for view in ("machine", "ideal")
    )
    middle = machine.shape[1] // 2

    def is_cut_at(column):
        found = seen(page)
        return (found[:, :column] == machine[:, :column]).all() and (
            found[:, column:] == ideal[:, column:]
        ).all()

    assert is_cut_at(middle)
    divider, box = page.locator(".divider"), page.locator(".stage").bounding_box()
    divider.focus()
    press(page, "ArrowLeft", "ArrowLeft")
    assert divider.get_attribute("aria-valuenow") == "46"
    assert is_cut_at(middle - pixels(page).shape[1] // 2 + round(pixels(page).shape[1] * 0.46))
    place = divider.bounding_box()
    page.mouse.move(place["x"] + place["width"] / 2, place["y"] + 20)
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] * 0.75, box["y"] + 30)
    page.mouse.up()
    assert divider.get_attribute("aria-valuenow") == "75" and address_has(page, "split=0.75")
    press(page, "w")
    assert not divider.is_visible()


def test_two_machines_are_flipped_and_subtracted(visit, made):
    page = stage(visit(FIGURE + "?labels=no"))
    page.select_option("select[aria-label='Machine B']", "OCTANE")
    page.wait_for_selector("button[data-view=other]")
    stage(page)
    press(page, "b")
    octane, machine = (made.codes["F003-21", key, "machine"] for key in ("OCTANE", "GEFORCE_3"))
    np.testing.assert_array_equal(seen(page), magnified(octane, scale(page)))
    press(page, "b")
    np.testing.assert_array_equal(seen(page), magnified(machine, scale(page)))
    press(page, "6", "d")
    assert loupe(page)[0] == (4, 3)
    assert address_has(page, "other=OCTANE")


def test_zoom_goes_from_fit_to_sixty_four_by_keys_buttons_and_wheel(visit, made):
    page = stage(visit(FIGURE + "?labels=no&zoom=1"))
    machine = made.codes["F003-21", "GEFORCE_3", "machine"]
    np.testing.assert_array_equal(seen(page), machine)
    for wanted in (2, 4, 8, 16, 32, 64, 64):
        press(page, "+")
        assert scale(page) == wanted
    page.click("button[aria-label=smaller]")
    assert scale(page) == 32
    press(page, "-", "-")
    assert scale(page) == 8
    box = page.locator(".stage").bounding_box()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.mouse.wheel(0, -100)
    page.wait_for_function("document.querySelector('.stage').dataset.scale === '16'")
    press(page, "-", "-", "-")
    for _ in range(4):  # a trackpad's small moves count together, a step for each hundred pixels
        page.mouse.wheel(0, -30)
    page.wait_for_function("document.querySelector('.stage').dataset.scale === '4'")
    assert scale(page) == 4
    press(page, "0")
    page.wait_for_function("!location.href.includes('zoom')")
    page.click("button:text-is('1:1')")
    assert scale(page) == 1


def test_all_views_show_the_same_place_however_it_was_moved(visit):
    page = stage(visit(FIGURE + "?zoom=16&labels=no", height=700))
    box = page.locator(".stage").bounding_box()
    spot = box["x"] + box["width"] * 0.4, box["y"] + box["height"] * 0.3
    press(page, "l")
    page.mouse.move(*spot)
    before, _ = loupe(page)
    page.mouse.down()
    page.mouse.move(spot[0] - 32, spot[1] - 16)
    page.mouse.move(spot[0] - 80, spot[1] - 48)
    page.mouse.up()
    page.mouse.move(*spot)
    after, _ = loupe(page)
    assert after == (before[0] + 5, before[1] + 3)
    for key in ("2", "3", "4", "1"):
        press(page, key)
        page.mouse.move(spot[0] + 1, spot[1] + 1)
        assert loupe(page)[0] == after
    press(page, "p")
    half = box["height"] / 2 + 14  # a pair of wide pictures lies one below the other
    page.mouse.move(spot[0], box["y"] + half / 2)
    above, _ = loupe(page)
    page.mouse.move(spot[0], box["y"] + half / 2 + half)
    assert loupe(page)[0] == above
    assert address_has(page, "centre=")


def test_the_loupes_bytes_are_the_pictures(visit, made):
    page = stage(visit(FIGURE + "?at=0|0&zoom=4"))
    codes = {view: made.codes["F003-21", "GEFORCE_3", view] for view in ("machine", "ideal", "reference")}
    random = np.random.default_rng(2)
    for _ in range(24):
        keys = random.choice(
            ["ArrowRight", "ArrowDown", "Shift+ArrowRight", "Shift+ArrowDown", "ArrowLeft", "ArrowUp"], 3
        )
        press(page, *keys)
        (x, y), rows = loupe(page)
        for view, picture in codes.items():
            wanted = list(picture[y, x, :3]) if picture[y, x, -1] or view != "reference" else []
            assert rows[view] == wanted, (x, y, view)
        assert rows["difference"] == list(codes["machine"][y, x] - codes["ideal"][y, x])


def test_the_loupe_follows_the_cursor_across_panels_and_gutters(visit, made):
    page = stage(visit(FIGURE))
    press(page, "l")
    codes, box, found = (
        made.codes["F003-21", "GEFORCE_3", "machine"],
        page.locator(".stage").bounding_box(),
        set(),
    )
    drawn = pixels(page)
    for along in np.linspace(0.1, 0.9, 17):
        page.mouse.move(
            box["x"] + round(box["width"] * along), box["y"] + round(box["height"] * (0.3 + along / 2))
        )
        if page.locator(".loupe").is_visible():
            (x, y), rows = loupe(page)
            under = drawn[round(box["height"] * (0.3 + along / 2)), round(box["width"] * along)]
            assert rows["machine"] == list(codes[y, x]) == list(under[:3])
            found.add(x // EDGE)
    assert found == {0, 1, 2}


def test_a_machine_of_twelve_bits_has_codes_of_twelve_bits(visit, made):
    page = stage(visit("#F003-21/INFINITE_REALITY/difference?labels=no&at=5|5&gain=1"))
    machine, ideal = (made.codes["F003-21", "INFINITE_REALITY", view] for view in ("machine", "ideal"))
    for _ in range(12):
        press(page, "Shift+ArrowRight" if _ % 3 else "ArrowDown")
        (x, y), rows = loupe(page)
        assert rows["machine"] == list(machine[y, x]) and rows["ideal"] == list(ideal[y, x])
        assert rows["difference"] == list(machine[y, x] - ideal[y, x])
    press(page, *["]"] * 7)
    shown = np.clip(np.floor(128 + 128 * (machine - ideal) * 255 / 4095 + 0.5), 0, 255)
    press(page, "Escape")
    np.testing.assert_array_equal(seen(page), magnified(shown, scale(page)))


def test_the_largest_difference_is_gone_to(visit):
    page = stage(visit(FIGURE))
    press(page, "d")  # the reference is preferred, where there is one
    assert loupe(page)[0] == (50, 7) and is_pressed(page, "\u2212 reference")
    press(page, "4", "d")
    (x, y), rows = loupe(page)
    assert (x, y) == (101, 30) and rows["difference"][1] == -50
    assert scale(page) == 8
    assert "101, y 30" in page.inner_text("[role=status].away")
    cross, box = page.locator(".cross").bounding_box(), page.locator(".stage").bounding_box()
    assert (
        box["x"] <= cross["x"] <= box["x"] + box["width"]
        and box["y"] <= cross["y"] <= box["y"] + box["height"]
    )
    press(page, "5", "d")
    assert loupe(page)[0] == (50, 7)


def test_labels_are_text_beside_the_bits(visit, made):
    page = stage(visit(FIGURE))
    labels = page.locator(".overlay .label")
    assert labels.all_inner_texts() == ["too little", "correct", "too much"]
    step, machine = scale(page), made.codes["F003-21", "GEFORCE_3", "machine"]
    found = seen(page)
    gutter = (found.shape[1] - 3 * EDGE * step) // 2
    assert gutter > 0
    for panel in range(3):
        begin = panel * (EDGE * step + gutter)
        part = machine[:, panel * EDGE : (panel + 1) * EDGE]
        np.testing.assert_array_equal(found[:, begin : begin + EDGE * step], magnified(part, step))
    press(page, "t")
    assert labels.count() == 0 and seen(page).shape[1] == 3 * EDGE * scale(page)


def saved_by(page, key):
    """(name, pixels) of the file that a key saves."""
    with page.expect_download() as download:
        press(page, key)
    return download.value.suggested_filename, np.asarray(Image.open(download.value.path()))


def test_the_picture_is_saved_with_the_machine_s_own_pixels(visit, made):
    page = stage(visit("#F003-21/GEFORCE_3/difference?zoom=2"))
    name, saved = saved_by(page, "s")
    assert name == "F003-21-GEFORCE_3.png"
    np.testing.assert_array_equal(saved, made.codes["F003-21", "GEFORCE_3", "machine"])
    press(page, "2", "Shift+Digit2")
    name, saved = saved_by(page, "s")
    assert name == "F003-21-GEFORCE_3-ideal-panel-2.png"
    np.testing.assert_array_equal(saved, made.codes["F003-21", "GEFORCE_3", "ideal"][:, EDGE : 2 * EDGE])


def test_the_picture_of_twelve_bits_is_saved_with_sixteen(visit, made):
    page = stage(visit("#F003-21/INFINITE_REALITY"))
    with page.expect_download() as download:
        press(page, "s")
    header, rows = read_png(download.value.path().read_bytes())
    assert header == (3 * EDGE, EDGE, 16, 2)
    codes = made.codes["F003-21", "INFINITE_REALITY", "machine"].astype(np.int64)
    np.testing.assert_array_equal(rows, (2 * codes * 65535 + 4095) // (2 * 4095))


def read_png(data):
    """(width, height, bits, colors) and the pixels of a PNG file without filters, 16 bits a component."""
    width, height, bits, colors = struct.unpack(">IIBB", data[16:26])
    place, packed = 8, b""
    while place < len(data):
        (length,) = struct.unpack_from(">I", data, place)
        if data[place + 4 : place + 8] == b"IDAT":
            packed += data[place + 8 : place + 8 + length]
        place += 12 + length
    rows = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(height, -1)
    assert not rows[:, 0].any()
    return (width, height, bits, colors), rows[:, 1:].copy().view(">u2").reshape(height, width, 3)


def test_the_view_is_saved_with_labels_that_can_be_read(visit, made):
    page = stage(visit(FIGURE + "?zoom=2", color_scheme="light"))
    name, saved = saved_by(page, "S")
    assert name == "F003-21-GEFORCE_3-view.png"
    machine = magnified(made.codes["F003-21", "GEFORCE_3", "machine"], 2)[:, : 2 * EDGE]
    top = next(y for y in range(saved.shape[0]) if (saved[y, :, :3] == machine[0, 0]).all(-1).any())
    strip = saved[top - 24 : top, :, :3].astype(int)
    # The labels' strip is nearly white with letters that are nearly black.
    assert strip.max() > 220 and (strip.max(-1) < 90).sum() > 60


def test_what_is_shown_is_saved_as_a_png(visit, made):
    page = stage(visit("#F003-21/GEFORCE_3/ideal?labels=no&zoom=2"))
    with page.expect_download() as download:
        press(page, "S")
    assert download.value.suggested_filename == "F003-21-GEFORCE_3-ideal-view.png"
    saved = np.asarray(Image.open(download.value.path()).convert("RGB"))
    ideal = magnified(made.codes["F003-21", "GEFORCE_3", "ideal"], 2)
    top, left = (np.array(saved.shape[:2]) - ideal.shape[:2]) // 2
    np.testing.assert_array_equal(saved[top : top + ideal.shape[0], left : left + ideal.shape[1]], ideal)


# ----------------------------------------------------------------------------------- address, keys, words


def test_an_address_is_shown_as_it_was_left(visit):
    page = stage(visit("#F003-21/OCTANE/difference?zoom=4&gain=64&mode=absolute&at=20|11&centre=20|11"))
    assert is_pressed(page, "difference") and scale(page) == 4
    assert page.get_attribute("[data-machine=OCTANE]", "aria-pressed") == "true"
    assert loupe(page)[0] == (20, 11)
    assert page.inner_text(".gain output") == "\u00d7 64"
    address = page.url
    page.reload()
    stage(page)
    assert page.url == address and loupe(page)[0] == (20, 11)


def test_a_view_is_kept_where_no_machine_was_chosen(visit):
    page = stage(visit("#F003-21"))
    press(page, "4")
    assert address_has(page, "#F003-21/difference")
    page.reload()
    stage(page)
    assert is_pressed(page, "difference")
    press(page, "ArrowRight")
    page.wait_for_function("document.querySelector('h1').textContent.includes('K12')")
    assert page.url.endswith("#K12/difference")


def test_the_pixel_of_an_address_is_in_the_middle_of_what_is_seen(visit):
    page = stage(visit(FIGURE + "?zoom=16&at=101|30", width=700))
    cross, box = page.locator(".cross").bounding_box(), page.locator(".stage").bounding_box()
    assert box["x"] <= cross["x"] <= box["x"] + box["width"] - cross["width"]


@pytest.mark.parametrize(("asked", "shown"), [("Infinity", 64), ("-5", None), ("1e99", 64), ("word", None)])
def test_numbers_of_an_address_are_kept_within_bounds(visit, asked, shown):
    page = stage(visit(f"{FIGURE}?zoom={asked}&gain={asked}&split={asked}&how=foreign"))
    assert shown is None or scale(page) == shown
    assert page.locator(READY).count() == 1


def test_a_figure_that_the_gallery_has_not_is_said_until_something_is_sought(visit):
    page = visit("#F004-8/GEFORCE_3/difference")
    assert "no figure F004-8 in this gallery" in page.inner_text(".nothing") and len(ids(page)) > 1
    page.fill("#search", "zwicker")
    assert page.locator(".nothing").count() == 0


def test_a_figure_is_opened_left_and_come_back_to(visit):
    page = visit("#?q=zwicker")
    page.click(".card a >> nth=0")
    stage(page)
    assert "F003-21" in page.inner_text("h1")
    press(page, "ArrowRight")
    page.wait_for_function("document.querySelector('h1').textContent.includes('K12')")
    press(page, "ArrowRight")
    page.go_back()
    page.wait_for_function("document.querySelector('h1').textContent.includes('F003')")
    page.go_back()
    page.wait_for_selector(".card")
    assert ids(page) == ["F003-21", "K12"]
    assert page.evaluate("document.activeElement.dataset.id") == "F003-21"
    page.go_forward()
    stage(page)
    press(page, "Escape")
    page.wait_for_selector(".card")
    assert page.input_value("#search") == "zwicker"


def test_all_is_reached_by_the_keyboard_and_seen_to_be(visit):
    page = visit()
    page.wait_for_selector(".card")
    press(page, "Tab")
    assert page.evaluate("document.activeElement.className") == "skip"
    press(page, "/")
    page.keyboard.type("bias")
    press(page, "Escape")
    for _ in range(80):
        press(page, "Tab")
        if page.evaluate("document.activeElement.dataset.id") == "F003-21":
            break
    assert page.evaluate("getComputedStyle(document.activeElement).outlineStyle") == "solid"
    press(page, "Enter")
    stage(page)
    assert page.evaluate("document.activeElement.tagName") == "H1"
    names = set()
    for _ in range(60):
        press(page, "Tab")
        names.add(
            page.evaluate(
                "document.activeElement.getAttribute('aria-label') || document.activeElement.textContent"
            )
        )
    assert {"GeForce 3", "Machine B", "largest differenced", "loupel", "save the pictures"} <= names
    press(page, "Escape", "/")
    page.wait_for_selector("#search")


def test_controls_have_names_and_the_loupe_is_said_on_request(visit):
    page = stage(visit("#F003-21/GEFORCE_3/difference"))
    unnamed = page.evaluate(
        """() => [...document.querySelectorAll("button, select, input, [role=slider], [role=application]")]
        .filter((e) => !(e.ariaLabel || e.textContent.trim() || e.labels?.length)).map((e) => e.outerHTML)"""
    )
    assert unnamed == []
    said = page.locator("[role=status].away")
    press(page, "l")
    assert said.inner_text() == ""
    press(page, "ArrowLeft", "v")
    (x, y), rows = loupe(page)
    assert said.inner_text().startswith(f"x {x}, y {y}, correct. machine: ")
    assert ", ".join(f"{value:.0f}" for value in rows["machine"]) in said.inner_text()


def test_what_must_be_seen_stands_beside_what_was_measured(visit, made):
    page = stage(visit("#F003-21/NV2A/machine"))
    assert page.locator(".checklist li").all_inner_texts() == [
        "Stripes at the left.",
        "None, cf. Eq. 2 and n.l, in the middle!",
        "Right a gap.",
    ]
    row = page.inner_text(".measured tbody tr")
    assert "gap" in row and "ok 0.5" in row and "\u2264 1" in row
    below = page.inner_text(".below")
    for said in ("the same bits as GeForce 3", "fixedpipe figures F003-21 --check", "clear <all>", "ratio"):
        assert said in below, said
    href = page.get_attribute(".source a >> nth=0", "href")
    assert href == "catalogue/003.html#z10" and (made.folder / "catalogue" / "003.html").is_file()
    assert 'id="z10"' in (made.folder / "catalogue" / "003.html").read_text()
    assert page.get_attribute(".source p a >> nth=0", "href") == "catalogue/003.html#f003-21"
    page.goto(page.url.split("#")[0] + "#F004-4")
    page.wait_for_selector(".measured .failed")
    assert "failed 2.5" in page.inner_text(".measured")


def test_a_variant_says_what_was_changed_and_has_what_there_is(visit, made):
    page = stage(visit(f"#{VARIANT}?labels=no&zoom=8"))
    np.testing.assert_array_equal(seen(page), magnified(made.codes[VARIANT, "IDEAL", "machine"], scale(page)))
    assert page.locator("button[data-view]").count() == 1
    press(page, "4", "d", "b", "]", "l")
    assert list(loupe(page)[1]) == ["machine"]
    below = page.inner_text(".below")
    assert (
        "A variant of F004-4" in below and "alpha_x = 0.15" in below and "A variant is not checked." in below
    )


def test_commands_and_bibtex_are_copied(visit):
    page = stage(visit(FIGURE, permissions=["clipboard-read", "clipboard-write"]))
    page.click("button[aria-label='Copy the command']")
    page.wait_for_selector("button:text-is('Copied')")
    assert page.evaluate("navigator.clipboard.readText()") == "fixedpipe figures F003-21 --check"


def test_titles_and_captions_are_text(visit):
    page = visit()
    page.wait_for_selector(".card")
    assert HOSTILE.split("<")[0] in page.inner_text(".card >> nth=1")
    plainly = " ".join(HOSTILE.split())
    page = stage(visit("#K12"))
    for place in ("h1", ".caption", ".command pre"):
        assert " ".join(page.inner_text(place).split()).endswith(plainly), place
    assert page.evaluate("window.ran") is None
    page = visit("", java_script_enabled=False)
    assert " ".join(page.inner_text("#K12 h2").split()) == f"K12 {plainly}"


def test_light_and_dark_by_the_system_and_by_the_switch(visit):
    ground = "getComputedStyle(document.body).backgroundColor"
    dark, light = visit("", color_scheme="dark"), visit("", color_scheme="light")
    grounds = dark.evaluate(ground), light.evaluate(ground)
    assert grounds[0] != grounds[1]
    light.click("button:text-is('Dark')")
    assert light.evaluate(ground) == grounds[0]
    light.reload()
    assert light.evaluate(ground) == grounds[0]
    light.click("button:text-is('Light')")
    assert light.evaluate(ground) == grounds[1]


@pytest.mark.parametrize("address", ["", FIGURE, FIGURE + "?how=pair&against=ideal&at=5|5", "#K12", "plain"])
def test_a_phone_s_width_needs_no_sideways_scroll(visit, address):
    page = visit("", 420, java_script_enabled=False) if address == "plain" else visit(address, 420)
    if address == "plain":
        page.wait_for_url("**/plain.html")
    if address.startswith("#"):
        stage(page)
    assert page.evaluate("document.documentElement.scrollWidth") <= 420


def test_a_phone_has_the_panels_one_below_the_other(visit, made):
    page = stage(visit(FIGURE, 420))
    step, machine = scale(page), made.codes["F003-21", "GEFORCE_3", "machine"]
    found = pixels(page)
    drawn = np.flatnonzero((found[..., 3] > 0).any(1))
    assert len(drawn) == 3 * EDGE * step
    columns = np.flatnonzero((found[..., 3] > 0).any(0))
    for panel in range(3):
        rows = drawn[panel * EDGE * step : (panel + 1) * EDGE * step]
        part = machine[:, panel * EDGE : (panel + 1) * EDGE]
        np.testing.assert_array_equal(found[rows][:, columns, :3], magnified(part, step))


@pytest.fixture
def failing(tmp_path):
    """A folder with a figure that no machine drew, one that one of two did not, and a whole one."""
    made = Made(tmp_path)
    for name in ("pictures", "records"):
        (tmp_path / name).mkdir()
    codes = codes_of(np.random.default_rng(3), panels=1)
    machine = drawn(made, "K12", "GEFORCE_3", "combiners", 8, {"machine": codes, "ideal": codes})
    refused = failure(Refusal("no room for <b>three</b> units."), "NV2A")
    broken = [failure(ZeroDivisionError("division by zero"), name) for name in ("GEFORCE_3", "NV2A")]
    figure(made, "F003-21", "Nobody drew it", [], ("",), failures=broken)
    figure(made, "K12", "One did not", [machine], ("",), failures=[refused])
    figure(made, "F004-4", "Whole", [machine], ("",))
    write_page(tmp_path, FIGURES)
    return tmp_path


NOBODY = "Not drawn on the GeForce 3, NV2A: ZeroDivisionError: division by zero"
ONE = "Not drawn on the NV2A: no room for <b>three</b> units."


def test_a_card_says_what_failed(visit_folder, failing):
    page = visit_folder(failing)
    assert page.locator(".card:has([data-id='F003-21']) .failure").all_inner_texts() == [NOBODY]
    assert page.locator(".card:has([data-id='K12']) .failure").all_inner_texts() == [ONE]
    assert page.locator(".card:has([data-id='F004-4']) .failure").count() == 0
    assert "3 figures" in page.inner_text("header.top") and "2 not whole" in page.inner_text("header.top")
    page.locator(".chip:has-text('failed')").click()
    assert ids(page) == ["F003-21", "K12"]


def test_a_figure_s_page_says_what_failed_and_shows_what_was_drawn(visit_folder, failing):
    page = stage(visit_folder(failing, "#K12"))
    assert page.locator(".failures p").all_inner_texts() == [ONE]
    assert page.locator(".failures details").count() == 0  # a sentence says all
    assert seen(page).size
    page.evaluate("location.hash = '#F003-21'")
    page.wait_for_selector(".undrawn")
    assert page.locator(".failures p").all_inner_texts() == [NOBODY]
    page.click(".failures summary")
    assert "ZeroDivisionError: division by zero" in page.inner_text(".failures pre")
    assert not page.is_visible(".stage") and "What F003-21 shows." in page.inner_text(".below")
    page.evaluate("location.hash = '#F004-4'")
    page.wait_for_selector(".figure:not(.undrawn)")
    assert page.locator(".failures p").count() == 0 and seen(stage(page)).size


def test_without_script_the_plain_page_says_what_failed(visit_folder, failing):
    page = visit_folder(failing, java_script_enabled=False)
    page.wait_for_url("**/plain.html")
    assert page.locator("#F003-21 .failed").all_inner_texts() == [NOBODY]
    assert page.locator("#K12 .failed").all_inner_texts() == [ONE]


def test_without_script_the_plain_page_has_all_figures(visit, made):
    page = visit("", java_script_enabled=False)
    page.wait_for_url("**/plain.html")
    assert page.locator(".plain-page section h2").count() == len(made.records)
    text = page.inner_text(".plain-page")
    for said in (
        "Must be seen:",
        "What F003-21 shows.",
        "acceptance checks failed",
        "identical to the ideal",
        "fixedpipe figures F004-4 --check",
    ):
        assert said in text, said
    previews = page.locator("#F003-21 .pictures img").count()
    assert previews >= 3


def test_with_script_nothing_of_the_plain_page_is_loaded_and_the_first_view_is_small(visit, made):
    sizes = []
    page = visit()
    page.on("response", lambda response: sizes.append(response.url))
    page.reload(wait_until="networkidle")
    assert not page.locator(".plain-page").count()
    assert {url.rsplit("-", 1)[-1] for url in sizes if "/pictures/" in url} == {"480.webp"}
    index = json.loads(page.inner_text("#index"))
    assert [figure["id"] for figure in index["figures"]] == list(made.records)
