"""``python -m bench viewer [ID:SIZE ...]``: from a gesture to pixels, by parts.

A light that is turned, or another parameter that moves, asks for picture after picture. Measured are the
parts of each: Python that makes the commands, the machine with its kernels, encoding, and the wire with a
WebSocket client in the same process. Processor time is of all threads together, so other programs hardly
disturb it. ``--browser`` also measures in Chromium, by the clock, from the pointer's event to the painted
canvas.

Ways to encode are compared too: raw codes, the rectangle that differs, deflate, PNG, WebP.
"""

import argparse
import io
import json
import shutil
import statistics
import threading
import time
import zlib
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from PIL import Image

from bench import processor
from fixedpipe.effects.figures import FIGURES
from fixedpipe.effects.figures.parameters import DIRECTION_KIND
from fixedpipe.effects.viewer.encoding import Sent, decoded, encoded
from fixedpipe.effects.viewer.studio import Picture, Studio
from fixedpipe.effects.viewer.subjects import FigureSubject, Subjects
from fixedpipe.effects.viewer.views import View, to_object
from fixedpipe.pipeline.framebuffers.pictures import png

# The goals' figures, and the parameter that moves where there is no light: (name, text of a step).
USUAL = ("F004-4:512", "F003-21:200", "F002-12:200")
MOVES = {"F003-21": ("ratio", lambda n: f"{1 + 0.01 * (n % 50):.4g}")}
STEPS = 40
_TOKEN = "bench-of-the-viewer-0"
_WINDOW = (1400, 900)
_HANGS = 600_000.0  # milliseconds: what takes longer is taken to hang


@dataclass(frozen=True)
class Part:
    """Processor milliseconds of a part: their median, 95th percentile and least."""

    median: float
    late: float
    least: float


def part(seconds):
    """The Part of some seconds."""
    ordered = sorted(1e3 * each for each in seconds)
    late = ordered[min(len(ordered) - 1, int(0.95 * len(ordered)))]
    return Part(statistics.median(ordered), late, ordered[0])


def moved(figure, step):
    """The values that a step of the hand sets, by name: the light on a circle, or what MOVES says."""
    if figure.id in MOVES:
        name, text = MOVES[figure.id]
        return {name: text(step)}
    parameter = figure.parameters.get("light")
    if parameter is None or parameter.kind != DIRECTION_KIND:
        raise SystemExit(f"{figure.id} has no light to turn; name a figure that has one, as F004-4:512.")
    x, y, z = parameter.default
    turn = 0.02 * (step + 1)
    light = (x * np.cos(turn) + z * np.sin(turn), y, z * np.cos(turn) - x * np.sin(turn))
    return {"light": ",".join(f"{c:.4f}" for c in light)}


def views(figure_id, size, steps=STEPS):
    """The Views of so many steps."""
    figure = FIGURES[figure_id]
    at = View(figure_id, figure.machines[0], size)
    return [replace(at, values=tuple(moved(figure, step).items())) for step in range(steps)]


def by_parts(studio, asked):
    """{part: seconds of each picture}, and the pictures: of the processor, drawn one after the other."""
    found, pictures = {"python": [], "machine": [], "encoding": []}, []
    studio.machine(asked[0])
    sent = None
    for number, view in enumerate(asked[1:]):
        begin = time.process_time()
        studio.commands(view)
        made = time.process_time()
        picture = studio.machine(view)
        drawn = time.process_time()
        encoded(picture, sent, {"number": number}, deflated=False)
        done = time.process_time()
        sent = Sent(number, picture)
        pictures.append(picture)
        for name, seconds in zip(found, (made - begin, drawn - made, done - drawn), strict=True):
            found[name].append(seconds)
    return found, pictures


def _webp(picture):
    buffer = io.BytesIO()
    Image.fromarray(picture.codes[..., :3]).save(buffer, "WEBP", lossless=True, quality=0, method=0)
    return buffer.getvalue()


def _raw(picture, base):
    return encoded(picture, None, {}, deflated=False)


ENCODINGS = {
    "raw": _raw,
    "what differs": lambda picture, base: encoded(picture, base, {}, deflated=False),
    "what differs, deflated": lambda picture, base: encoded(picture, base, {}, deflated=True),
    "deflated": lambda picture, base: zlib.compress(picture.codes.tobytes(), 1),
    "PNG": lambda picture, base: png(picture.codes),
    "WebP, lossless": lambda picture, base: _webp(picture),
}


def encodings(pictures):
    """{way: (Part, bytes of a picture)} of pictures of 8 bits, each after the one before it."""
    found = {}
    for name, encode in ENCODINGS.items():
        seconds, sizes = [], []
        for before, picture in pairwise(pictures):
            begin = time.process_time()
            data = encode(picture, Sent(0, before))
            seconds.append(time.process_time() - begin)
            sizes.append(len(data))
        found[name] = part(seconds), statistics.mean(sizes)
    return found


def by_wire(studio, asked):
    """Seconds from a request to its picture, decoded, by a client in this process: (processor, clock)."""
    from websockets.sync.client import connect

    from fixedpipe.effects.viewer.server import Server

    server = Server(studio, asked[0], token=_TOKEN)
    thread = threading.Thread(target=server.run)
    thread.start()
    spent, waited = [], []
    try:
        address = f"ws://127.0.0.1:{server.port}/{_TOKEN}/live"
        origin = f"http://127.0.0.1:{server.port}"
        with connect(address, origin=origin, max_size=None, compression=None, open_timeout=60) as live:
            live.recv()
            base: Picture | None = None
            for serial, view in enumerate(asked):
                begin, clock = time.process_time(), time.perf_counter()
                live.send(json.dumps({"do": "draw", "number": serial, "view": to_object(view)}))
                header = {"serial": -1}
                while header["serial"] != serial:
                    header, base = decoded(live.recv(), base)
                    live.send(json.dumps({"do": "shown", "number": header["number"]}))
                spent.append(time.process_time() - begin)
                waited.append(time.perf_counter() - clock)
    finally:
        server.end()
        thread.join()
    return spent[1:], waited[1:]


def by_browser(studio, start, seconds=8.0):
    """The times that the page keeps of each picture of the machine while a hand drags in Chromium, and
    milliseconds of encoding each picture: two lists.
    """
    from playwright.sync_api import sync_playwright

    from fixedpipe.effects.viewer import conversation
    from fixedpipe.effects.viewer.server import Server

    encode, encoding = conversation.encoded, []

    def timed(*given):
        begin = time.perf_counter()
        data = encode(*given)
        encoding.append(1e3 * (time.perf_counter() - begin))
        return data

    server = Server(studio, start, token=_TOKEN)
    thread = threading.Thread(target=server.run)
    thread.start()
    conversation.encoded = timed
    try:
        with sync_playwright() as running:
            path = shutil.which("chromium") or running.chromium.executable_path
            browser = running.chromium.launch(
                executable_path=path, args=["--no-sandbox", "--disable-gpu"], timeout=_HANGS
            )
            page = browser.new_page(viewport=dict(zip(("width", "height"), _WINDOW, strict=True)))
            page.set_default_timeout(_HANGS)
            page.goto(server.address)
            page.wait_for_selector(".viewer[data-ideal=true]")
            encoding.clear()
            _drag(page, start.id, seconds)
            times = page.evaluate("document.querySelector('.viewer').fixedpipe.times")[2:]
            browser.close()
    finally:
        conversation.encoded = encode
        server.end()
        thread.join()
    return times, encoding


def _drag(page, figure_id, seconds):
    """A hand drags for so long: the light on the picture, or the slider of what MOVES says."""
    if figure_id in MOVES:
        place, reach = page.locator(f"input[type=range][aria-label='{MOVES[figure_id][0]}']"), (0.4, 0.0)
        place.scroll_into_view_if_needed()
    else:
        page.click("[data-tool=light]")
        place, reach = page.locator(".stage"), (0.1, 0.1)
    box = place.bounding_box()
    # Left of the middle: between two panels there is a gap, and a press on it drags nothing.
    across = 0.5 if figure_id in MOVES else 0.3
    x, y = box["x"] + across * box["width"], box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    end, step = time.monotonic() + seconds, 0
    while time.monotonic() < end:
        step += 1
        right, down = reach[0] * box["width"], reach[1] * box["height"]
        page.mouse.move(x + right * np.sin(step / 9), y + down * np.cos(step / 7))
    page.mouse.up()


def seen_in_browser(times, encoding):
    """What ``by_browser`` found, as JSON values: pictures a second, milliseconds from hand to picture, and
    the median of each part. What remains is the wire, the page, and waiting for a processor. Of fewer than
    two pictures, their number alone.
    """
    if len(times) < 2:
        return {"pictures": len(times)}
    found = part([each["latency"] / 1e3 for each in times]).__dict__
    parts = {
        "python": statistics.median(each["commands"] for each in times),
        "machine": statistics.median(each["machine"] for each in times),
        "encoding": statistics.median(encoding),
    }
    parts["wire, page and waiting"] = max(0.0, found["median"] - sum(parts.values()))
    rate = 1e3 * (len(times) - 1) / (times[-1]["at"] - times[0]["at"])
    return {"pictures": len(times), "pictures a second": rate, **found, "parts": parts}


def measure(figure_id, size, steps=STEPS, browser=False, seconds=8.0):
    """All numbers of a figure, as a dict of JSON values. ``seconds``: how long a hand drags in Chromium."""
    figure = FIGURES[figure_id]
    studio = Studio(Subjects([FigureSubject(figure)], figures=False))
    asked = views(figure_id, size, steps)
    parts, pictures = by_parts(studio, asked)
    spent, waited = by_wire(studio, views(figure_id, size, 2 * steps)[steps:])
    whole = [sum(each) for each in zip(*parts.values(), strict=True)]
    found = {
        "figure": figure_id,
        "pixels": list(figure.dimensions(size)),
        "parts": {name: part(seconds).__dict__ for name, seconds in parts.items()},
        "picture": part(whole).__dict__,
        "with the wire": part(spent).__dict__,
        "by the clock": part(waited).__dict__,
        "encodings": {
            name: {**each.__dict__, "bytes": size_of} for name, (each, size_of) in encodings(pictures).items()
        },
    }
    if browser:
        found["browser"] = seen_in_browser(*by_browser(studio, asked[0], seconds))
    return found


def told(found):
    """The numbers as lines of text."""
    width, height = found["pixels"]
    whole = found["picture"]["median"]
    yield f"\n{found['figure']}, {width}x{height} pixels; milliseconds of the processor a picture"
    yield f"{'':28}{'median':>9}{'95 %':>9}{'least':>9}{'share':>9}"
    rows = {**found["parts"], "picture": found["picture"], "with the wire": found["with the wire"]}
    for name, each in rows.items():
        share = f"{each['median'] / whole:9.0%}"
        yield f"{name:28}{each['median']:9.2f}{each['late']:9.2f}{each['least']:9.2f}{share}"
    yield f"at most {1e3 / whole:.0f} pictures a second on one processor that does nothing else"
    clock = found["by the clock"]
    yield (
        f"by the clock of this computer, as busy as it is: median {clock['median']:.1f} ms, 95 % "
        f"{clock['late']:.1f} ms"
    )
    if "median" not in found.get("browser", {"median": 0.0}):
        yield "in Chromium: fewer than two pictures while a hand dragged; --seconds gives it longer"
    elif "browser" in found:
        seen = found["browser"]
        yield (
            f"in Chromium, from hand to picture: median {seen['median']:.1f} ms, 95 % {seen['late']:.1f} ms, "
            f"{seen['pictures a second']:.1f} pictures a second, {seen['pictures']} pictures"
        )
        for name, median in seen["parts"].items():
            yield f"{'  ' + name:28}{median:9.2f}{'':18}{median / seen['median']:9.0%}"
    yield f"{'encoding':28}{'median':>9}{'95 %':>9}{'least':>9}{'kB':>9}"
    for name, each in found["encodings"].items():
        times = f"{each['median']:9.2f}{each['late']:9.2f}{each['least']:9.2f}"
        yield f"{name:28}{times}{each['bytes'] / 1e3:9.0f}"


def main(arguments):
    """Measure figures, given as ID:SIZE."""
    parser = argparse.ArgumentParser(prog="python -m bench viewer", description=__doc__.partition("\n")[0])
    parser.add_argument("figures", nargs="*", default=USUAL, metavar="ID:SIZE")
    parser.add_argument("--steps", type=int, default=STEPS, metavar="N", help="pictures of each figure")
    parser.add_argument("--browser", action="store_true", help="measure in Chromium too")
    parser.add_argument(
        "--seconds", type=float, default=8.0, metavar="S", help="how long a hand drags in Chromium"
    )
    parser.add_argument("--json", metavar="FILE", help="write the numbers")
    asked = parser.parse_args(arguments)
    print(processor.read().name, flush=True)
    rows = []
    for word in asked.figures:
        figure_id, _, size = word.partition(":")
        if figure_id not in FIGURES or not size.isdigit() or not int(size):
            parser.error(f"{word!r} is no figure with a size; give ID:SIZE, as F004-4:512.")
        rows.append(measure(figure_id, int(size), max(4, asked.steps), asked.browser, asked.seconds))
        print("\n".join(told(rows[-1])), flush=True)
    if asked.json:
        with open(asked.json, "w", encoding="utf-8") as file:
            json.dump(rows, file, indent=1)
