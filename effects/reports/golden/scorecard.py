"""How another program did on the rules: as a JSON object, and as a page without files from elsewhere."""

from html import escape
from itertools import groupby

from fixedpipe.effects.emulators.judge import totals
from fixedpipe.effects.reports.style import STYLE
from fixedpipe.pipeline.golden.provenance import package_version

FORMAT = 1
_MORE = """
td { vertical-align: top; overflow-wrap: anywhere; padding: .15rem .8rem .15rem 0; }
td.number { white-space: nowrap; } td code { font-size: .8rem; } .wrong td:nth-child(2) { color: var(--bad); }
table { table-layout: fixed; width: 100%; min-width: 48rem; } th:nth-child(1) { width: 14rem; }
th:nth-child(2) { width: 7rem; } th:nth-child(5) { width: 22%; }
.right td:nth-child(2) { color: var(--good); } .table { overflow-x: auto; }
"""


def scorecard_record(program, scores, cases, seed):
    """The scorecard as plain data: the command, versions, totals, and an object for each rule."""
    return {
        "format": FORMAT,
        "program": list(program),
        "fixedpipe": package_version(),
        "cases": cases,
        "seed": seed,
        "totals": totals(scores),
        "rules": [score.record() for score in scores],
    }


def _shown(value):
    return "[" + ", ".join(map(str, value)) + "]" if type(value) is list else str(value)


def _difference(record):
    if record["absent"]:
        return "not answered"
    if record["failure"]:
        return escape(record["failure"])
    first = record["first"]
    if first is None:
        return ""
    inputs = ", ".join(f"{name} {_shown(value)}" for name, value in first["inputs"].items())
    expected, answered = _shown(first["expected"]), _shown(first["answered"])[:200]
    return (
        f"case {first['case']}: <code>{escape(inputs)}</code> is <code>{escape(expected)}</code>, not "
        f"<code>{escape(answered)}</code>"
    )


def _row(record):
    whole = record["right"] == record["vectors"] and not record["failure"]
    captures = ", ".join(map(escape, record["captures"])) or "none"
    return (
        f'<tr class="{"right" if whole else "wrong"}"><td><code>{escape(record["rule"])}</code></td>'
        f'<td class="number">{record["right"]} of {record["vectors"]}</td><td>{_difference(record)}</td>'
        f"<td>{escape(record['evidence'])}</td><td>{captures}</td></tr>"
    )


def _stage(name, records):
    head = "".join(
        f"<th>{title}</th>" for title in ("rule", "right", "first difference", "evidence", "captures")
    )
    rows = "".join(map(_row, records))
    table = f'<div class="table"><table><tr>{head}</tr>{rows}</table></div>'
    return f"<section><h2>{escape(name)}</h2>{table}</section>"


def scorecard_page(record):
    """The page, as text, of ``scorecard_record``."""
    found = record["totals"]
    by_tag = ", ".join(f"{tag} {of['whole']} of {of['rules']}" for tag, of in found["by_evidence"].items())
    stages = groupby(record["rules"], lambda rule: rule["stage"])
    command = escape(" ".join(record["program"]))
    return (
        '<!doctype html><html lang="en"><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width">'
        f"<title>{command} and the NV2A's arithmetic</title><style>{STYLE}{_MORE}</style>"
        f"<h1><code>{command}</code> and the NV2A's arithmetic</h1>"
        f"<p>{found['whole']} of {found['rules']} rules are whole, {found['right']} of {found['vectors']} "
        f"vectors right. {found['absent']} rules are not answered, {found['failed']} failed.</p>"
        f'<p class="quiet">Whole by evidence: {by_tag}. Of fixedpipe {escape(record["fixedpipe"])}, '
        f"{record['cases']} random cases of each rule behind its edges, seed {record['seed']}.</p>"
        + "".join(_stage(name, list(records)) for name, records in stages)
    )
