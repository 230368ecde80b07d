"""The viewer in a browser: what the hand does, the machine draws, bit for bit; and nobody else may ask."""

import base64
import ctypes
import gc
import http.client
import io
import json
import re
import subprocess
import sys
import threading
import zipfile
from contextlib import ExitStack, closing, contextmanager
from urllib.parse import urlsplit

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

from fixedpipe.effects.cli import main
from fixedpipe.effects.figures import FIGURES
from fixedpipe.effects.viewer.page import module
from fixedpipe.effects.viewer.server import MOST_WINDOWS, Server
from fixedpipe.effects.viewer.studio import Studio
from fixedpipe.effects.viewer.subjects import FigureSubject, Subjects
from fixedpipe.effects.viewer.views import View, view_of
from fixedpipe.effects.viewer.widget import view_figure
from fixedpipe.pipeline.golden.digests import digest
from fixedpipe.pipeline.golden.pixels import pixels_of_png
from tests.support.waiting import HANGS, until

SIZE = 48
TOKEN = "a-token-of-the-tests-0123"
SETTLED = """() => {
  const at = document.querySelector(".viewer");
  return at && Number(at.dataset.serial) >= 0 && at.dataset.serial === at.dataset.asked
    && at.dataset.ideal === "true" && at.dataset.canvas && at.dataset.proved === at.dataset.serial;
}"""


@contextmanager
def serving(view=None, port=0, figures=True):
    studio = Studio(Subjects([FigureSubject(FIGURES["F004-4"], size=SIZE)], figures))
    server = Server(studio, view or View("F004-4", "GEFORCE_256"), port, TOKEN)
    thread = threading.Thread(target=server.run)
    thread.start()
    try:
        yield server
    finally:
        server.end()
        thread.join()


@pytest.fixture(scope="module")
def server():
    with serving() as running:
        yield running


@pytest.fixture
def visit(browser, server):
    """Opens a window: visit("#F004-4/NV2A", width=420) gives the page. Its errors, and requests that leave
    the viewer's address, fail the test.
    """
    contexts, wrong = [], []

    def opened(address="", width=1400, at=None, **options):
        context = browser.new_context(viewport={"width": width, "height": 900}, **options)
        context.set_default_timeout(1000 * HANGS)
        contexts.append(context)
        page = context.new_page()
        home = at or server.address
        inside = (home, home.replace("http:", "ws:"), "blob:", "data:")
        page.on("pageerror", lambda error: wrong.append(str(error)))
        page.on("request", lambda r: r.url.startswith(inside) or wrong.append(r.url))
        page.goto(home + address)
        return settled(page)

    yield opened
    for context in contexts:
        context.close()
    assert wrong == []


def settled(page):
    """Waits until the machine, the ideal and the canvas's digest are of what was asked for last."""
    page.wait_for_function(SETTLED)
    return page


def state(page):
    return page.evaluate("document.querySelector('.viewer').fixedpipe.state")


def seen(page):
    """The digest of the colours that the canvas holds."""
    return page.get_attribute(".viewer", "data-canvas")


def drawn(view, **changes):
    """The same of the figure as Python draws it."""
    values = {
        name: FIGURES[view["id"]].parameter(name, method(view)).parse(text, name)
        for name, text in view["values"].items()
    }
    machine = view_of(view).profile()
    picture = FIGURES[view["id"]].render(
        machine, view["size"] or SIZE, method=method(view), **values, **changes
    )
    return digest(picture.image()[..., :3])


def method(view):
    return FIGURES[view["id"]].method(view["machine"])


def drag(page, dx, dy, steps=4):
    box = page.locator(".stage").bounding_box()
    x, y = box["x"] + box["width"] * 0.4, box["y"] + box["height"] * 0.5
    page.mouse.move(x, y)
    page.mouse.down()
    for n in range(1, steps + 1):
        page.mouse.move(x + dx * n / steps, y + dy * n / steps)
    page.mouse.up()


# ----------------------------------------------------------------------------------------------- gestures


def test_the_canvas_holds_what_the_command_line_draws(visit, tmp_path):
    page = visit()
    out = tmp_path / "out"
    spoken = page.inner_text(".copyable code").split()
    assert spoken[:2] == ["fixedpipe", "figures"]
    run = CliRunner().invoke(main, [*spoken[1:], "--out", str(out)])
    assert run.exit_code == 0, run.output
    record = json.loads((out / "F004-4.json").read_text())
    assert page.get_attribute(".viewer", "data-sha256") == record["machines"][0]["sha256"]
    assert seen(page) == drawn(state(page)["view"])
    assert "the canvas holds the machine" in page.inner_text(".status")


def test_drags_turn_the_light_and_the_camera(visit):
    page = visit()
    before = seen(page)
    page.click("[data-tool=light]")
    drag(page, 40, -30)
    lit = state(settled(page))["view"]
    assert set(lit["values"]) == {"light"} and seen(page) == drawn(lit) != before
    page.click("[data-tool=camera]")
    drag(page, 0, 40)
    turned = state(settled(page))["view"]
    assert set(turned["values"]) == {"light", "tilt"} and seen(page) == drawn(turned)
    page.locator(".stage").focus()
    page.keyboard.press("ArrowDown")
    by_key = state(settled(page))["view"]
    step = float(by_key["values"]["tilt"]) - float(turned["values"]["tilt"])
    assert step == pytest.approx(5.0) and seen(page) == drawn(by_key)


def test_sliders_fields_and_machines_change_the_frame_and_undo_brings_it_back(visit):
    page = visit()
    first = seen(page)
    page.fill("input[aria-label='spread, number']", "30")
    page.keyboard.press("Tab")
    settled(page)
    assert state(page)["view"]["values"] == {"spread": "30"} and seen(page) == drawn(state(page)["view"])
    slider = page.locator("input[aria-label='map_rows']")
    slider.focus()
    page.keyboard.press("ArrowLeft")
    settled(page)
    assert state(page)["view"]["values"]["map_rows"] == "128"
    page.select_option("select[aria-label=Machine]", "NV2A")
    settled(page)
    assert state(page)["view"]["machine"] == "NV2A" and seen(page) == drawn(state(page)["view"])
    for _ in range(3):
        page.keyboard.press("Control+z")
    settled(page)
    assert state(page)["view"]["values"] == {} and seen(page) == first
    page.keyboard.press("Control+Shift+z")
    assert state(settled(page))["view"]["values"] == {"spread": "30"}
    page.fill("input[aria-label='spread, number']", "300")
    page.keyboard.press("Tab")
    page.wait_for_selector("[role=alert]:not([hidden])")
    assert "give a number from 0 to 45" in page.inner_text("[role=alert]:not([hidden])")


def test_widths_and_clamps_are_the_machines(visit):
    page = visit()
    page.click("text=Bits and clamps")
    page.select_option("select[aria-label='bits of combiner']", "5")
    page.uncheck("label.check:has-text('outputs of general combiners') input")
    view = state(settled(page))["view"]
    assert (view["bits"], view["without"]) == ({"combiner": 5}, ["GENERAL_COMBINER"])
    assert seen(page) == drawn(view)


def test_the_divider_stands_between_machine_and_ideal(visit):
    page = visit("#F004-4/GEFORCE_256/machine?labels=false&zoom=1")
    page.keyboard.press("w")
    settled(page)
    divider = page.locator(".divider")
    divider.focus()
    page.keyboard.press("ArrowRight")
    assert divider.get_attribute("aria-valuenow") == "52"
    rendering = FIGURES["F004-4"].render("GEFORCE_256", SIZE)
    machine = rendering.image()[..., :3]
    ideal = np.clip(rendering.ideal.color[..., :3], 0, 1) * 255 + 0.5
    shown, left = painted(page)
    cut = round(canvas(page).shape[1] * 0.52) - left
    np.testing.assert_array_equal(shown[:, :cut], machine[:, :cut])
    np.testing.assert_array_equal(shown[:, cut:], ideal.astype(np.uint8)[:, cut:])


def canvas(page):
    address = page.evaluate("document.querySelector('.stage canvas').toDataURL('image/png')")
    return np.asarray(Image.open(io.BytesIO(base64.b64decode(address.split(",")[1]))).convert("RGBA"))


def painted(page):
    """The colours that the stage shows where it is painted, and how many columns are not, to the left."""
    found = canvas(page)
    row, column = (np.flatnonzero(found[..., 3].any(axis)) for axis in (1, 0))
    return found[row[0] : row[-1] + 1, column[0] : column[-1] + 1, :3], column[0]


def test_the_slider_of_passes_shows_the_frame_after_each_command(visit):
    page = visit()
    slider = page.locator("input[aria-label='Commands that are drawn']")
    assert slider.get_attribute("max") == "12"
    slider.focus()
    page.keyboard.press("Home")
    for number in range(3):
        settled(page)
        words = page.inner_text(".words")
        run = CliRunner().invoke(main, ["passes", "F004-4", "--size", str(SIZE), "--all"])
        assert words.startswith(f"{number}. ") and words.strip() in run.output
        page.keyboard.press("ArrowRight")
    assert state(settled(page))["view"]["upto"] == 3
    page.keyboard.press("End")
    assert state(settled(page))["view"]["upto"] is None and seen(page) == drawn(state(page)["view"])


def test_a_second_machine_stands_beside(visit):
    page = visit("#F003-21/GEFORCE_3/machine?size=48")
    page.select_option("select[aria-label='Machine B']", "INFINITE_REALITY")
    page.wait_for_selector("button[data-view=other_difference]")
    settled(page)
    page.keyboard.press("6")
    assert "InfiniteReality" in page.get_attribute(".stage", "aria-label")
    page.keyboard.press("b")
    assert state(page)["shown"] == "other" and state(page)["how"] == "wipe"


def test_a_machine_with_fewer_bits_stands_beside_itself_as_built(visit):
    page = visit("#F004-4/GEFORCE_256/machine?labels=false&zoom=1")
    page.select_option("select[aria-label='Machine B']", "GEFORCE_256")
    page.click("text=Bits and clamps")
    page.select_option("select[aria-label='bits of combiner']", "5")
    page.uncheck("label.check:has-text('outputs of general combiners') input")
    page.wait_for_selector("button[data-view=other_difference]")
    settled(page)
    for key, name in (
        ("6", "GeForce 256, changed \u2212 GeForce 256, as built"),
        ("b", "B: GeForce 256, as built"),
    ):
        page.keyboard.press(key)  # as soon as a clamp was chosen
        assert name in page.get_attribute(".stage", "aria-label")
    page.keyboard.press("w")  # one alone
    as_built = FIGURES["F004-4"].render("GEFORCE_256", SIZE).image()[..., :3]
    np.testing.assert_array_equal(painted(page)[0], as_built)
    page.keyboard.press("1")
    changed = FIGURES["F004-4"].render(view_of(state(page)["view"]).profile(), SIZE).image()[..., :3]
    assert (changed != as_built).any()
    np.testing.assert_array_equal(painted(page)[0], changed)


def test_a_pixels_history_is_that_of_inspect(visit, tmp_path):
    page = visit("#F004-4/GEFORCE_256/machine?labels=false&zoom=4&at=20|30")
    page.locator(".stage").focus()
    page.keyboard.press("Enter")
    page.wait_for_function("() => document.querySelector('.history').textContent.includes('Pixel (20, 30)')")
    out = tmp_path / "history.html"
    arguments = ["inspect", "F004-4", "--pixel", "20,30", "--size", str(SIZE), "--html", str(out)]
    assert CliRunner().invoke(main, arguments).exit_code == 0
    body = re.search(r"</h1>(.*)</body>", out.read_text(), re.DOTALL)[1]
    same = page.evaluate(
        "html => { const made = document.createElement('div'); made.innerHTML = html;"
        " return made.textContent === document.querySelector('.history').textContent; }",
        body,
    )
    assert same
    box = page.locator(".stage").bounding_box()
    page.click("[data-tool=look]")
    page.mouse.click(box["x"] + box["width"] / 2 + 6, box["y"] + box["height"] / 2 + 2)
    page.wait_for_function("() => !document.querySelector('.history').textContent.includes('Pixel (20, 30)')")
    at = state(page)["at"]
    assert f"Pixel ({at[0]}, {at[1]})" in page.inner_text(".history")


def test_the_address_keeps_what_is_seen(visit):
    page = visit()
    page.click("[data-tool=light]")
    drag(page, 30, 10)
    page.keyboard.press("e")
    settled(page)
    page.wait_for_function(
        "() => location.hash.includes('set.light') && location.hash.includes('exposure=0.5')"
    )
    before, digest_before = state(page), seen(page)
    page.reload()
    settled(page)
    assert state(page)["view"] == before["view"] and state(page)["exposure"] == 0.5
    assert seen(page) == digest_before


# ------------------------------------------------------------------------------------------------- keeping


def test_the_saved_script_draws_the_same_bytes(visit, tmp_path):
    page = visit()
    page.click("[data-tool=light]")
    drag(page, 30, 10)
    settled(page)
    with page.expect_download() as download:
        page.keyboard.press("s")
    assert download.value.suggested_filename == "F004-4-GEFORCE_256.py"
    path = tmp_path / "kept.py"
    download.value.save_as(path)
    subprocess.run([sys.executable, str(path)], cwd=tmp_path, check=True)
    picture = next(tmp_path.glob("*.png")).read_bytes()
    assert digest(pixels_of_png(picture)) == seen(page)
    with page.expect_download() as download:
        page.click("button:text-is('picture')")
    download.value.save_as(tmp_path / "kept.png")
    assert digest(pixels_of_png((tmp_path / "kept.png").read_bytes())) == seen(page)
    with page.expect_download() as download:
        page.click("button:text-is('golden test')")
    download.value.save_as(tmp_path / "kept.zip")
    with zipfile.ZipFile(tmp_path / "kept.zip") as file:
        assert "tests/test_f004_4_geforce_256.py" in file.namelist()


# ------------------------------------------------------------------------------------------------- windows


def test_two_windows_see_different_things(visit):
    first, second = visit(), visit("#F004-4/NV2A/machine?set.light=0%2C0%2C1")
    first.click("[data-tool=light]")
    drag(first, 40, 0)
    settled(first)
    assert state(second)["view"]["values"] == {"light": "0,0,1"}
    assert seen(second) == drawn(state(second)["view"]) != seen(first) == drawn(state(first)["view"])


def test_a_window_waits_for_a_viewer_that_ended_and_goes_on(visit):
    with serving() as running:
        page, port = visit(at=running.address), running.port
        page.click("[data-tool=light]")
        drag(page, 30, 0)
        before = state(settled(page))
    page.wait_for_selector("[role=alert]:not([hidden]):has-text('The viewer has ended')")
    with serving(port=port):
        page.wait_for_selector("[role=alert]:has-text('The viewer has ended')", state="hidden")
        settled(page)
        assert state(page)["view"] == before["view"] and seen(page) == drawn(before["view"])


def test_an_address_of_anybody_does_no_harm(visit, server):
    page = visit()
    for hostile in (
        "#F004-4/GEFORCE_256/machine?set.light=%3Cscript%3Ealert(1)%3C/script%3E",
        "#..%2F..%2Fetc%2Fpasswd/NV2A",
        "#F004-4/GEFORCE_256/machine?upto=99999999&zoom=1e9&split=-4",
        "#%E0%A4%A/x?size=100000&bits.x=4",
    ):
        page.goto("about:blank")
        page.goto(server.address + hostile)
        page.wait_for_selector("[role=alert]:not([hidden])")
        assert page.locator("[role=alert]:not([hidden])").first.inner_text().strip()
    page.goto("about:blank")
    page.goto(server.address)
    settled(page)


def random_gestures(page, count, seed=1):
    random = np.random.default_rng(seed)
    keys = [*"123456bwpiolqvce[],.zy+-0l", "ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown", "Escape", "E"]
    for _ in range(count):
        kind = random.integers(7)
        if kind < 2:
            page.locator(".stage").focus()
            page.keyboard.press(str(random.choice(keys)))
        elif kind == 2:
            drag(page, int(random.integers(-60, 60)), int(random.integers(-60, 60)), 2)
        elif kind == 3:
            page.evaluate(
                """([n, share]) => {
                  const all = document.querySelectorAll(".controls input[type=range]");
                  const one = all[n % all.length];
                  one.value = Number(one.min) + share * (one.max - one.min);
                  one.dispatchEvent(new Event("input"));
                  one.dispatchEvent(new Event("change"));
                }""",
                [int(random.integers(100)), float(random.random())],
            )
        elif kind == 4:
            page.mouse.wheel(0, int(random.choice([-100, 100])))
        else:  # machines, what stands beside, bits and clamps; a larger picture only takes longer
            page.evaluate(
                """([kind, n, m]) => {
                  const all = [...document.querySelectorAll(`.viewer ${kind}`)].filter(
                    (one) => !one.disabled && !["Figure", "Size of a panel"].includes(one.ariaLabel));
                  const one = all[n % all.length];
                  if (kind === "select") one.selectedIndex = m % one.options.length;
                  else one.checked = !one.checked;
                  one.dispatchEvent(new Event("change"));
                }""",
                [
                    "select" if kind == 5 else "input[type=checkbox]",
                    int(random.integers(100)),
                    int(random.integers(100)),
                ],
            )


def complaints(page):
    """What the console says of errors from now on: a list that grows."""
    said: list[str] = []
    page.on("console", lambda message: message.type == "error" and said.append(message.text))
    return said


def resident_at_rest(page):
    """Bytes of this process's memory when the last frames that it keeps are small ones, always the same.

    Some frames that random gestures ask for have 100,000 commands, so what is kept of the last ones says
    nothing of a growing memory.
    """
    for number in range(8):
        alpha = f"0.{number + 1}"
        page.evaluate(
            "alpha => document.querySelector('.viewer').fixedpipe.set({ view: { id: 'F004-4', size: 64,"
            " machine: 'GEFORCE_256', values: { alpha_x: alpha }, bits: {}, without: [], upto: null },"
            " other: '' })",
            alpha,
        )
        settled(page)
    gc.collect()
    ctypes.CDLL(None).malloc_trim(0)  # free memory that the C library holds is nobody's
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * 4096


MEGABYTES = 1 << 20


def test_random_gestures_raise_no_error(visit, capfd):
    page = visit()
    said = complaints(page)
    random_gestures(page, 30)
    assert_it_goes_on(page, capfd)
    assert said == []


# Some gestures give a brush an alpha below what the GeForce 256 stores. The terminal says so; it is drawn.
@pytest.mark.filterwarnings("ignore::fixedpipe.effects.reflectance.material_textures.StoredAlpha")
@pytest.mark.slow  # memory shows after many frames
@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_a_thousand_random_gestures_keep_no_memory(visit, capfd):
    page = visit()
    said = complaints(page)
    heap = "performance.memory ? performance.memory.usedJSHeapSize : 0"
    # They fill caches: commands, textures, modules of figures.
    for seed in range(2, 6):
        random_gestures(page, 250, seed)
    server_before, page_before = resident_at_rest(page), page.evaluate(heap)
    random_gestures(page, 400, 6)
    # A picture of 512x256 that is kept after each gesture takes 200 MB.
    assert resident_at_rest(page) - server_before < 100 * MEGABYTES
    assert page.evaluate(heap) - page_before < 100 * MEGABYTES
    assert_it_goes_on(page, capfd)
    assert said == []


def assert_it_goes_on(page, capfd):
    """Whatever was done before, another figure is drawn as ever, and nothing was raised."""
    page.evaluate(
        "document.querySelector('.viewer').fixedpipe.set({ view: { id: 'F004-4', machine: 'GEFORCE_256',"
        " size: 0, values: {}, bits: {}, without: [], upto: null }, other: '' })"
    )
    settled(page)
    assert seen(page) == drawn(state(page)["view"])
    assert "Traceback" not in capfd.readouterr().err


# ------------------------------------------------------------------------------------------- who may ask


def answered(server, path, **headers):
    with closing(http.client.HTTPConnection("127.0.0.1", server.port, timeout=HANGS)) as connection:
        connection.request("GET", path, headers=headers)
        answer = connection.getresponse()
        return answer, answer.read()


def test_only_the_whole_address_of_this_computer_opens_the_page(server):
    path, host = urlsplit(server.address).path, f"127.0.0.1:{server.port}"
    good, text = answered(server, path)
    assert good.status == 200 and b"fixedpipeView" in text
    policy = good.headers["Content-Security-Policy"]
    assert "default-src 'none'" in policy and "frame-ancestors 'none'" in policy
    assert (
        good.headers["Referrer-Policy"] == "no-referrer" and "Access-Control-Allow-Origin" not in good.headers
    )
    for wrong, headers in (
        ("/", {}),
        ("/wrong-token-of-anybody/", {}),
        (path + "../", {}),
        (path + "%2e%2e/%2e%2e/etc/passwd", {}),
        (path, {"Host": f"evil.example:{server.port}"}),
        (path, {"Host": "127.0.0.1"}),
        (path, {"Host": host, "Origin": "http://evil.example"}),
        (path, {"Host": host, "Origin": "null"}),
    ):
        answer, text = answered(server, wrong, **headers)
        assert answer.status == 404 and TOKEN.encode() not in text, (wrong, headers)


def test_a_forged_origin_or_a_wrong_token_gets_no_connection(server):
    from websockets.exceptions import InvalidStatus
    from websockets.sync.client import connect

    live = f"ws://127.0.0.1:{server.port}/{TOKEN}/live"
    own = f"http://127.0.0.1:{server.port}"
    for address, origin in (
        (live, "http://evil.example"),
        (live, None),
        (live, "null"),
        (live, f"https://127.0.0.1:{server.port}"),
        (live, "http://127.0.0.1:1"),
        (live.replace(TOKEN, "x" * len(TOKEN)), own),
    ):
        with pytest.raises(InvalidStatus) as refused:
            connect(address, origin=origin, open_timeout=HANGS).__enter__()
        assert refused.value.response.status_code in (403, 404)
    with connect(live, origin=own, open_timeout=HANGS, ping_interval=None) as good:
        assert json.loads(good.recv())["say"] == "hello"
        good.send("no JSON {")
        assert json.loads(good.recv())["say"] == "refused"
        good.send('"' + "x" * (1 << 17) + '"')  # more than a message may be: the connection ends
        with pytest.raises(Exception, match=r"1009|too big"):
            for _ in range(3):
                good.recv(timeout=HANGS)


def emptied(server):
    """Waits until windows that were closed are forgotten."""
    until(lambda: not server.windows, "the end of all windows")


def test_there_are_no_more_windows_than_may_be(server):
    from websockets.exceptions import ConnectionClosed
    from websockets.sync.client import connect

    live, own = f"ws://127.0.0.1:{server.port}/{TOKEN}/live", f"http://127.0.0.1:{server.port}"
    emptied(server)
    with ExitStack() as opened:
        for _ in range(MOST_WINDOWS):
            window = opened.enter_context(connect(live, origin=own, open_timeout=HANGS, ping_interval=None))
            assert json.loads(window.recv())["say"] == "hello"
        late = opened.enter_context(connect(live, origin=own, open_timeout=HANGS, ping_interval=None))
        with pytest.raises(ConnectionClosed, match="windows already"):
            late.recv(timeout=HANGS)
    emptied(server)


# -------------------------------------------------------------------------------------------- for everyone


def test_all_controls_have_names_and_the_page_is_as_wide_as_a_phone(visit):
    page = visit(width=420, color_scheme="dark", has_touch=True)
    assert page.evaluate("document.documentElement.scrollWidth") == 420
    nameless = page.evaluate(
        """() => [...document.querySelectorAll("button, select, input, [role=slider], [role=application]")]
          .filter((one) => !(one.getAttribute("aria-label") || one.textContent.trim()
            || one.closest("label")?.textContent.trim()))
          .map((one) => one.outerHTML)"""
    )
    assert nameless == []
    assert page.get_attribute(".stage", "aria-label") == "F004-4, GeForce 256"
    page.locator(".stage").focus()
    page.keyboard.press("l")
    page.keyboard.press("v")
    assert re.fullmatch(r"x \d+, y \d+, .+machine: \d+, \d+, \d+.*", page.inner_text("p[role=status]"))


# -------------------------------------------------------------------------------------------------- widget


def test_a_notebooks_widget_is_the_same_page_and_its_state_goes_both_ways(visit, browser):
    widget = view_figure(FIGURES["F004-4"], size=SIZE)
    waiting = []
    widget.send = lambda message, buffers=None: waiting.append((message, buffers))
    context = browser.new_context(viewport={"width": 900, "height": 900})
    context.set_default_timeout(1000 * HANGS)
    page, heard = context.new_page(), []
    page.expose_function("toPython", lambda text: heard.append(json.loads(text)))
    page.set_content("<body></body>")
    page.evaluate(
        """async ([text, state]) => {
          const on = {};
          globalThis.held = { state };
          globalThis.model = {
            get: (name) => held[name], set: (name, value) => { held[name] = value; },
            save_changes: () => toPython(JSON.stringify({ state: held.state })),
            on: (name, act) => { on[name] = act; }, off: () => {},
            send: (message) => toPython(JSON.stringify(message)),
          };
          globalThis.deliver = (message, data) => {
            const bytes = data === null ? null : Uint8Array.from(atob(data), (c) => c.charCodeAt(0));
            on["msg:custom"](message, bytes ? [new DataView(bytes.buffer)] : []);
          };
          globalThis.assign = (state) => { held.state = state; on["change:state"](); };
          const url = URL.createObjectURL(new Blob([text], { type: "text/javascript" }));
          (await import(url)).default.render({ model, el: document.body });
        }""",
        [module(), widget.state],
    )
    inside = "document.querySelector('div').shadowRoot.querySelector('.viewer')"

    def pumped(ready):
        """Carries messages to and fro until the page says that it is so."""

        def is_so():
            while heard:
                message = heard.pop(0)
                if "state" in message:
                    widget.state = message["state"]
                else:
                    widget._heard(widget, message, [])
            while waiting:
                message, buffers = waiting.pop(0)
                page.evaluate(
                    "([message, data]) => deliver(message, data)",
                    [message, base64.b64encode(buffers[0]).decode() if buffers else None],
                )
            return page.evaluate(f"() => {{ const at = {inside}; return Boolean(at && ({ready})); }}")

        until(is_so, "the widget's answer")

    done = "at.dataset.serial === at.dataset.asked && at.dataset.ideal === 'true'"
    pumped(done)
    own = widget.picture().sha256
    assert own == drawn(widget.state)
    page.evaluate("([state]) => assign(state)", [widget.state | {"values": {"light": "1,1,1"}}])
    pumped(f"{done} && at.fixedpipe.state.view.values.light === '1,1,1'")
    page.evaluate(
        f"() => {{ const {{ fixedpipe: of }} = {inside};"
        " of.set({ view: { ...of.state.view, values: { light: '0,1,1' } } }); }"
    )
    pumped("held.state.values.light === '0,1,1'")
    pumped(done)
    assert (
        widget.state["values"] == {"light": "0,1,1"} and widget.picture().sha256 == drawn(widget.state) != own
    )
    widget.close()
    context.close()
