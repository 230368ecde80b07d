"""A pixel's history as an HTML page: one file, no script, nothing fetched."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

from fixedpipe.pipeline.inspection.words import HEADINGS, causes, cells, held, marks_of, meant

if TYPE_CHECKING:  # For annotations alone: a history shows itself in a notebook as this page.
    from fixedpipe.pipeline.inspection.history import Fragment, PixelHistory, Stage, Touched

_STYLE = """
body { font: 15px/1.45 system-ui, sans-serif; margin: 2rem auto; max-width: 68rem; padding: 0 1rem;
  color: #1a1a1a; background: #fff; }
h1 { font-size: 1.4rem; } h2 { font-size: 1.1rem; margin: 1.6rem 0 .3rem; }
table { border-collapse: collapse; margin: .3rem 0 .9rem; }
td, th { padding: .1rem .8rem .1rem 0; text-align: left; vertical-align: top; }
td.n { text-align: right; white-space: nowrap;
  font-variant-numeric: tabular-nums; font-family: ui-monospace, monospace; }
tr.stage td { font-weight: 600; padding-top: .6rem; } tr.made td:first-child::before { content: "= "; }

tr.clamped td, .mark { color: #a34700; } tr.cause td { color: #666; }
tr.cause td:first-child { padding-left: 2rem; }
 .says { font-weight: 400; font-style: italic; color: #444; }
.failed { color: #b00020; } .passed { color: #0b6b2f; } summary { cursor: pointer; }
.chip { display: inline-block; width: 1em; height: 1em; border: 1px solid #777; vertical-align: -.15em; }
@media (prefers-color-scheme: dark) { body { color: #e8e8e8; background: #161616; } .says { color: #bbb; }
  tr.clamped td, .mark { color: #ffb070; } tr.cause td { color: #999; }
  .failed { color: #ff8a8a; } .passed { color: #7fd69a; } }
"""


def history_page(history: PixelHistory, title: str) -> str:
    """A whole HTML document with the history."""
    return (
        "<!doctype html><html lang=en><head><meta charset=utf-8>"
        '<meta name=viewport content="width=device-width">'
        f"<title>{escape(title)}</title><style>{_STYLE}</style></head><body>"
        f"<h1>{escape(title)}</h1>{history_html(history)}</body></html>\n"
    )


def history_html(history: PixelHistory) -> str:
    """The history without a page around it, as a notebook shows it."""
    surface = "" if history.surface is None else f", pbuffer {history.surface}"
    where = (
        f"Pixel ({history.x}, {history.y}) of {history.width}x{history.height}{surface}, counted from "
        f"the top left; window y is {history.window_y}. {history.profile}."
    )
    final = (
        f"{len(history.touched)} of {history.commands} commands touched it; in the end {held(history.final)}."
    )
    lines = [escape(where), f"{_chip(history.final.color, history.one)} {escape(final)}"]
    if ideal := meant(history):
        lines.append(f"{_chip(history.ideal, 1)} {escape(ideal)}.")
    parts = "".join(_touched(touched, history.one, history.surface) for touched in history.touched)
    return f"<p>{'<br>'.join(lines)}</p>{parts}"


def _chip(color, one):
    """A square in a colour; an ideal's may lie outside 0 to 1, or be no number."""
    red, green, blue = (round(255 * min(1.0, max(0.0, code / one))) for code in color[:3])
    return f'<span class=chip style="background:rgb({red},{green},{blue})"></span>'


def _touched(touched: Touched, one: int, surface: str | None) -> str:
    change = "unchanged"
    if touched.before != touched.after:
        pair = (touched.before, touched.after)
        change = "<br>".join(f"{_chip(value.color, one)} {escape(held(value))}" for value in pair)
    parts = "".join(
        _fragment(number, len(touched.fragments), fragment)
        for number, fragment in enumerate(touched.fragments)
    )
    return f"<h2>{escape(touched.heading(surface))}</h2><p>{change}</p>{parts}"


def _fragment(number: int, count: int, fragment: Fragment) -> str:
    name = f"fragment {number + 1} of {count}" if count > 1 else "fragment"
    rows = "".join(_stage(stage, marks_of(fragment, place)) for place, stage in enumerate(fragment.stages))
    head = "<tr>" + "".join(f"<th>{heading}</th>" for heading in HEADINGS) + "</tr>"
    opened = " open" if fragment.fate == "written" else ""
    summary = f"<summary>{name}: {escape(fragment.fate)}</summary>"
    return f"<details{opened}>{summary}<table>{head}{rows}</table></details>"


def _stage(stage: Stage, marks: str) -> str:
    says = f" <span class=says>{escape(stage.says)}</span>" if stage.says else ""
    if stage.verdict is not None:
        word = "passed" if stage.verdict else "failed"
        says += f" <span class={word}>{word}</span>"
    if marks:
        says += f" <span class=mark>{escape(marks)}</span>"
    rows = [f"<tr class=stage><td colspan={len(HEADINGS)}>{escape(stage.title)}{says}</td></tr>"]
    for quantities, kind in ((stage.read, "read"), (stage.made, "made")):
        for quantity in quantities:
            numbers = "".join(f"<td class=n>{escape(cell)}</td>" for cell in cells(quantity))
            rows.append(f"<tr class={kind}><td>{escape(quantity.name)}</td>{numbers}</tr>")
            for cause, error in causes(quantity):
                rows.append(f"<tr class=cause><td>{cause}</td><td colspan=4 class=n>{error}</td></tr>")
    for clamped in stage.clamped:
        change = f"{clamped.before:.4g} to {clamped.after:.4g}"
        rows.append(
            f"<tr class=clamped><td>clamped: {escape(clamped.name)}</td><td></td>"
            f"<td class=n>{change}</td><td></td><td></td></tr>"
        )
    return "".join(rows)
