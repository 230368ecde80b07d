"""The report on compared captures: the objects of the JSON list, and a page.

The page is one file, without scripts and without links to other files.
"""

from base64 import b64encode
from html import escape

import numpy as np

from fixedpipe.effects.conformance.redraw import TEXT
from fixedpipe.effects.conformance.run import Totals
from fixedpipe.effects.reports.style import STYLE
from fixedpipe.pipeline.framebuffers.pictures import png

# A difference's largest component, in bytes, from this one on; its colour and its words.
_STEPS = (
    (1, (255, 221, 87), "1"),
    (2, (255, 150, 40), "2 to 7"),
    (8, (240, 50, 40), "8 to 63"),
    (64, (255, 90, 220), "64 and more"),
)
_TEXT, _OUTSIDE = (58, 84, 130), (58, 60, 66)  # colours of what is not compared
# What the colours of a difference say.
LEGEND = (
    *((color, f"differs by {words}") for _, color, words in _STEPS),
    (_TEXT, "text, not compared"),
    (_OUTSIDE, "outside the compared region"),
)
_FEW = 400  # differing pixels up to which each is drawn three pixels wide
_LOOK = (120, 90)  # pixels of the closer look

_MORE_STYLE = """
.legend span { display: inline-block; margin-right: 1.2rem; white-space: nowrap; }
.legend i { display: inline-block; width: .9rem; height: .9rem; margin-right: .4rem; vertical-align: -.1rem; }
.three { display: grid; gap: .6rem; grid-template-columns: repeat(3, minmax(0, 1fr)); margin: .8rem 0 0; }
.three img { width: 100%; } .close img { image-rendering: pixelated; }
h3 { font: 1rem/1.4 system-ui, sans-serif; margin: 2rem 0 .2rem; }
.legend { margin-bottom: 1.6rem; } .total { font-size: 1.15rem; } table { min-width: 0; }
.case { margin-bottom: 2.5rem; }
"""


def inline_picture(image, alt):
    """An image of bytes [h, w, 3 or 4] as an element of a page, with its PNG file inside."""
    data = b64encode(png(image)).decode()
    height, width = image.shape[:2]
    return (
        f'<img src="data:image/png;base64,{data}" width="{width}" height="{height}" '
        f'alt="{escape(alt)}" loading="lazy">'
    )


def difference_picture(comparison, wide=False):
    """Where and how much a covered Comparison differs: uint8 [h, w, 3].

    Equal pixels show our picture, darkened. A differing pixel has the colour of its largest component's
    difference, and with ``wide`` so have its neighbours. Pixels that are not compared have one of two other
    colours.
    """
    c = comparison
    out = c.ours[..., :3] // 5
    out[~c.compared] = _OUTSIDE
    out[(c.theirs == TEXT).all(-1) & ~c.compared] = _TEXT
    apart = np.abs(c.ours.astype(np.int16) - c.theirs).max(-1) * c.compared
    for least, color, _ in _STEPS:
        at = apart >= least
        if wide:
            at = _widened(at)
        out[at] = color
    return out


def _widened(at):
    """Every true pixel and its eight neighbours."""
    rows = at.copy()
    rows[1:] |= at[:-1]
    rows[:-1] |= at[1:]
    out = rows.copy()
    out[:, 1:] |= rows[:, :-1]
    out[:, :-1] |= rows[:, 1:]
    return out


def _closer_look(wrong):
    """Slices of the window of _LOOK pixels with the most differing ones in it."""
    width, height = _LOOK
    sums = np.pad(wrong.astype(np.int32).cumsum(0).cumsum(1), ((1, 0), (1, 0)))
    inside = sums[height:, width:] - sums[:-height, width:] - sums[height:, :-width] + sums[:-height, :-width]
    best = np.argwhere(inside == inside.max())
    top, left = best[len(best) // 2]
    return slice(top, top + height), slice(left, left + width)


def _three(c, rows, columns, wide, more):
    pictures = {"ours": c.ours, "theirs": c.theirs, "difference": difference_picture(c, wide)}
    return "".join(
        f"<figure>{inline_picture(picture[rows, columns], f'{c.suite}/{c.name}, {what}{more}')}"
        f"<figcaption>{what}{more}</figcaption></figure>"
        for what, picture in pictures.items()
    )


def _pictures(c):
    wrong = c.compared & ~c.equal
    rows, columns = _closer_look(wrong)
    whole = _three(c, slice(None), slice(None), wrong.sum() <= _FEW, "")
    close = _three(c, rows, columns, False, ", closer")
    at = np.argwhere(wrong[rows, columns])
    told = "; ".join(
        f"({x}, {y}) ours {_components(c.ours[y, x])}, theirs {_components(c.theirs[y, x])}"
        for y, x in (at[[0, len(at) // 2, -1][: len(at)]] + (rows.start, columns.start)).tolist()
    )
    return (
        f'<div class="three">{whole}</div><div class="three close">{close}</div>'
        f'<p class="quiet">Closer: columns {columns.start} to {columns.stop - 1}, rows {rows.start} to '
        f"{rows.stop - 1}. For example {told}.</p>"
    )


def _components(pixel):
    return " ".join(map(str, pixel.tolist()))


def _row(c):
    if not c.covered:
        said, kind = ("error" if c.failed else "not covered"), ("failed" if c.failed else "quiet")
    else:
        said, kind = f"{c.pixels_equal} / {c.pixels_compared}", "ok" if c.exact else "failed"
    note = "" if c.exact else c.note
    return f'<tr><td>{escape(c.name)}</td><td class="number {kind}">{said}</td><td>{escape(note)}</td></tr>'


def _inexact(c):
    differ = f"{c.pixels_compared - c.pixels_equal} of {c.pixels_compared} pixels differ"
    why = f": {escape(c.note)}" if c.note else ""
    return (
        f'<div class="case"><h3>{escape(c.name)}</h3><p class="quiet">{differ}{why}.</p>{_pictures(c)}</div>'
    )


def _section(suite, rows, pictures, totals):
    return (
        f'<section id="{escape(suite)}"><h2>{escape(suite)}</h2>'
        f'<p class="quiet">{escape(str(totals))}</p>'
        f"<details{' open' * (totals.exact == totals.cases > 0)}><summary>all cases</summary>"
        '<div class="table"><table>'
        f"<tr><th>case</th><th>pixels equal / compared</th><th></th></tr>{''.join(rows)}</table></div>"
        f"</details>{''.join(pictures)}</section>"
    )


def _of(part, whole):
    return f"{part:,} of {whole:,}" if whole else ""


def _summary(totals):
    rows = "".join(
        f'<tr><td><a href="#{escape(suite)}">{escape(suite)}</a></td>'
        f'<td class="number {"ok" if t.exact == t.cases else "failed"}">{_of(t.exact, t.cases)}</td>'
        f'<td class="number">{_of(t.pixels_equal, t.pixels_compared)}</td>'
        f'<td class="number">{t.not_covered or ""}</td></tr>'
        for suite, t in totals.items()
    )
    head = "".join(f"<th>{h}</th>" for h in ("suite", "exact cases", "equal pixels", "not covered"))
    return f'<div class="table"><table><tr>{head}</tr>{rows}</table></div>'


class Page:
    """The page under construction: cases are added one by one, and only their pictures stay in memory."""

    def __init__(self):
        self._totals, self._rows, self._pictures = {}, {}, {}

    def add(self, comparison):
        """Add one Comparison; those of a suite come one after the other."""
        suite = comparison.suite
        self._totals[suite] = self._totals.get(suite, Totals()) + Totals.of(comparison)
        self._rows.setdefault(suite, []).append(_row(comparison))
        pictures = self._pictures.setdefault(suite, [])
        if comparison.covered and not comparison.exact:
            pictures.append(_inexact(comparison))

    def text(self, total, scoreboard=""):
        """The whole page. ``total``: the Totals of all cases; ``scoreboard``: another renderer's, as HTML."""
        legend = "".join(
            f'<span><i style="background: rgb{color}"></i>{escape(words)}</span>' for color, words in LEGEND
        )
        sections = "".join(
            _section(suite, self._rows[suite], self._pictures[suite], totals)
            for suite, totals in self._totals.items()
        )
        return (
            '<!doctype html><html lang="en"><head><meta charset="utf-8"><title>fixedpipe: conformance</title>'
            '<meta name="viewport" content="width=device-width, initial-scale=1">'
            f"<style>{STYLE}{_MORE_STYLE}</style></head><body><h1>Conformance with a real NV2A</h1>"
            f'<p class="total">{escape(str(total))}</p>'
            '<p class="quiet">Captures of the chip, redrawn and compared in all four components. Where '
            "pixels differ there are pictures. The difference is drawn over our picture, which is dark; its "
            "colour says by how many bytes the component that is farthest off differs. Where no more than "
            f"{_FEW} pixels differ, each is drawn three wide.</p>"
            f'<p class="quiet legend">{legend}</p>'
            f"{_summary(self._totals)}{scoreboard}{sections}</body></html>\n"
        )


def record_of(case):
    """A Comparison as an object of the JSON list."""
    return {
        "suite": case.suite,
        "case": case.name,
        "covered": case.covered,
        "pixels_equal": case.pixels_equal,
        "pixels_compared": case.pixels_compared,
        "exact": case.exact,
        "note": case.note,
    }
