"""The page on which golden pictures are looked at: one file that needs no other, and no network.

A browser's canvas multiplies colours by alpha and keeps 8 bits, so pictures travel as their pixels,
deflated, and the script makes opaque colours of them; the bytes under the pointer are the picture's own.
"""

import base64
import json
import shlex
import zlib
from contextlib import suppress
from html import escape
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from fixedpipe.effects.reports.golden.results import CHANGED, NEW, STATUSES
from fixedpipe.effects.reports.style import PALETTE
from fixedpipe.pipeline.golden.candidates import candidate_pixels, golden_pixels, read_candidates
from fixedpipe.pipeline.golden.differences import kinds_differ
from fixedpipe.pipeline.golden.store import StoreError

# Of one picture and of several.
_WORDS = {
    "changed": ("differs from what is golden", "differ from what is golden"),
    "new": ("has no golden picture yet", "have no golden picture yet"),
    "missing": (
        "was not drawn, since its test did not come so far",
        "were not drawn, since their tests did not come so far",
    ),
    "orphan": ("is golden, and no test asks for it", "are golden, and no test asks for them"),
    "allowed": (
        "differs by no more than its test allows",
        "differ by no more than their tests allow",
    ),
    "recorded": ("was recorded in this run", "were recorded in this run"),
    "excused": (
        "is excused: its test was skipped, or failed as it was expected to",
        "are excused: their tests were skipped, or failed as they were expected to",
    ),
    "passed": ("is golden", "are golden"),
}


def golden_page(root: Path, found: list[dict[str, Any]]) -> str:
    """The page, as text, of ``results``. Raises StoreError for candidates that cannot be read."""
    candidates, entries = read_candidates(root), []
    for result in found:
        entry = dict(result)
        candidate = candidates.get(entry["name"])
        if candidate is not None and entry["status"] in (CHANGED, NEW):
            entry["command"] = f"fixedpipe golden accept {shlex.quote(entry['name'])}"
            golden = None
            with suppress(StoreError):  # ``told`` says it
                golden = golden_pixels(root, candidate)
            entry["golden"] = None if golden is None else _picture(golden)
            entry["now"] = _picture(candidate_pixels(root, candidate), golden)
        entries.append(entry)
    counts = {status: sum(e["status"] == status for e in entries) for status in STATUSES}
    says = (
        "; ".join(f"{count} {_WORDS[status][count > 1]}" for status, count in counts.items() if count)
        or "no pictures"
    )
    plain = "".join(
        f"<li><b>{escape(e['status'])}</b> {escape(e['name'])}<pre>{escape(e['told'])}\n"
        f"{escape(e.get('command', ''))}</pre></li>"
        for e in entries
    )
    data = json.dumps({"says": says, "words": _WORDS, "pictures": entries}, ensure_ascii=False).replace(
        "<", "\\u003c"
    )
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        "<title>fixedpipe: golden pictures</title>"
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<style>{PALETTE}{_text('page.css')}</style></head>\n<body><header><h1>Golden pictures</h1>"
        f'<p class="quiet">{escape(says)}</p></header><noscript><ul>{plain}</ul></noscript>'
        '<main id="main"></main>\n'
        f'<script type="application/json" id="data">{data}</script>\n'
        f'<script>(() => {{\n"use strict";\n{_text("page.js")}}})();</script></body></html>\n'
    )


def _picture(pixels, golden=None):
    """A picture for the script. Bytes are written as differences, which are smaller once they are deflated:
    from a ``golden`` picture of the same kind, from the pixel to the left, or from the one above.
    """
    height, width, components = pixels.shape
    given = _bytes(pixels)
    of_golden = golden is not None and not kinds_differ(golden, pixels)
    if of_golden:
        backs = {0: given - _bytes(golden)}
    else:
        backs = {back: given.copy() for back in (0, len(given) // (width * height), len(given) // height)}
        for back, data in backs.items():
            data[back:] -= given[: len(given) - back] if back else np.uint8(0)
    deflated = {back: zlib.compress(data.tobytes()) for back, data in backs.items()}
    back = min(deflated, key=lambda back: len(deflated[back]))
    return {
        "width": width,
        "height": height,
        "components": components,
        "bits": 8 * pixels.dtype.itemsize,
        "of_golden": of_golden,
        "back": back,
        "data": base64.b64encode(deflated[back]).decode(),
    }


def _bytes(pixels):
    return np.frombuffer(pixels.astype(pixels.dtype.newbyteorder("<"), copy=False).tobytes(), np.uint8)


def _text(name):
    return (files(__package__) / name).read_text(encoding="utf-8")
