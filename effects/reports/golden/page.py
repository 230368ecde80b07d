"""The page on which golden pictures are looked at: one file that needs no other, and no network.

A browser's canvas multiplies colours by alpha and keeps 8 bits, so pictures travel as their pixels,
deflated, and the script makes opaque colours of them; the bytes under the pointer are the picture's own.
"""

import base64
import json
import shlex
import zlib
from html import escape
from importlib.resources import files
from pathlib import Path
from typing import Any

from fixedpipe.effects.reports.golden.results import CHANGED, NEW, STATUSES
from fixedpipe.effects.reports.style import PALETTE
from fixedpipe.pipeline.golden.candidates import candidate_pixels, golden_pixels, read_candidates
from fixedpipe.pipeline.golden.store import StoreError

_WORDS = {
    "changed": "differ from what is golden",
    "new": "have no golden picture yet",
    "missing": "were not drawn, since their tests did not come so far",
    "orphan": "are golden, and no test asks for them",
    "recorded": "were recorded in this run",
    "excused": "are excused: their tests were skipped, or failed as they were expected to",
    "passed": "are golden",
}


def golden_page(root: Path, found: list[dict[str, Any]]) -> str:
    """The page, as text, of ``results``. Raises StoreError for candidates that cannot be read."""
    candidates, entries = read_candidates(root), []
    for result in found:
        entry = dict(result)
        candidate = candidates.get(entry["name"])
        if candidate is not None and entry["status"] in (CHANGED, NEW):
            entry["command"] = f"fixedpipe golden accept {shlex.quote(entry['name'])}"
            entry["now"] = _picture(candidate_pixels(root, candidate))
            try:
                golden = golden_pixels(root, candidate)
            except StoreError as error:
                golden, entry["told"] = None, f"{entry['told']}\n{error}"
            entry["golden"] = None if golden is None else _picture(golden)
        entries.append(entry)
    counts = {status: sum(e["status"] == status for e in entries) for status in STATUSES}
    says = (
        "; ".join(f"{count} {_WORDS[status]}" for status, count in counts.items() if count) or "no pictures"
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


def _picture(pixels):
    height, width, components = pixels.shape
    little = pixels.astype(pixels.dtype.newbyteorder("<"), copy=False)
    return {
        "width": width,
        "height": height,
        "components": components,
        "bits": 8 * pixels.dtype.itemsize,
        "data": base64.b64encode(zlib.compress(little.tobytes())).decode(),
    }


def _text(name):
    return (files(__package__) / name).read_text(encoding="utf-8")
