"""Two renderers compared with a chip: as text, as a part of a page, and as JSON objects."""

from dataclasses import asdict
from html import escape
from itertools import groupby

from fixedpipe.effects.conformance.scoreboard import Row

_COLUMNS = ("exact cases", "equal pixels", "within 1", "largest")


def by_suite(rows):
    """{suite: Row} of {(suite, case): Row}, and of all."""
    found = {
        suite: sum((row for _, row in cases), Row())
        for suite, cases in groupby(rows.items(), lambda item: item[0][0])
    }
    return found | {"all": sum(rows.values(), Row())}


def _cells(score):
    if not score.cases:
        return ("none", "", "", "")
    share = f"{score.equal / score.pixels:.4%}" if score.pixels else ""
    near = f"{score.within_one / score.pixels:.4%}" if score.pixels else ""
    return (f"{score.exact} of {score.cases}", share, near, str(score.largest))


def scoreboard_text(rows):
    """A line for each suite: ours, then the other's, of the captures that both were compared with."""
    lines = [f"{'':34}{'ours':>46}{'the other':>48}"]
    lines.append(f"{'suite':34}" + "".join(f"{name:>14}"[-14:] for name in (*_COLUMNS, *_COLUMNS)))
    for suite, row in by_suite(rows).items():
        cells = (*_cells(row.ours), *_cells(row.other))
        missing = f"   {row.other.missing} without a picture" if row.other.missing else ""
        lines.append(f"{suite:34}" + "".join(f"{cell:>14}" for cell in cells) + missing)
    return "\n".join(lines)


def scoreboard_html(rows, folder):
    """The same as a section of a page."""
    head = "".join(f"<th>{name}</th>" for name in ("suite", *_COLUMNS, *_COLUMNS, "no picture"))
    body = "".join(
        f"<tr><td>{escape(suite)}</td>"
        + "".join(f'<td class="number">{cell}</td>' for cell in (*_cells(row.ours), *_cells(row.other)))
        + f'<td class="number">{row.other.missing or ""}</td></tr>'
        for suite, row in by_suite(rows).items()
    )
    return (
        f'<section><h2>Beside another renderer</h2><p class="quiet">Ours, then the pictures of '
        f"{escape(folder.name)}, in the same regions of the captures. Equal: all four components are; within "
        "1: none is off by more; largest: the largest difference of a component.</p>"
        f'<div class="table"><table><tr>{head}</tr>{body}</table></div></section>'
    )


def score_record(row):
    """The other renderer's part of a case's JSON object."""
    other = asdict(row.other)
    return {"other": {name: other[name] for name in ("equal", "within_one", "largest", "missing")}}
