"""The gallery: one page that shows every figure of a folder, without scripts or anything from elsewhere."""

import json
from html import escape

from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.reports.style import STYLE
from fixedpipe.effects.technique import INDEX


def _checks_table(checks):
    if not checks:
        return ""
    rows = "".join(
        f'<tr><td class="{"ok" if c["passed"] else "failed"}">{"ok" if c["passed"] else "failed"}</td>'
        f"<td>{escape(c['name'])}</td><td>{escape(c['on'])}</td>"
        f'<td class="number">{c["value"]:.4g} {escape(c["relation"])} {c["bound"]:.4g}</td>'
        f"<td>{escape(c['reason'])}</td></tr>"
        for c in checks
    )
    head = "".join(f"<th>{h}</th>" for h in ("", "check", "on the", "value and bound", "why this bound"))
    failed = sum(not c["passed"] for c in checks)
    summary = (
        f'<span class="failed">{failed} of {len(checks)} acceptance checks failed</span>'
        if failed
        else f'<span class="ok">{len(checks)} acceptance checks passed</span>'
    )
    return (
        f"<details{' open' * bool(failed)}><summary>{summary}</summary>"
        f'<div class="table"><table><tr>{head}</tr>{rows}</table></div></details>'
    )


def _groups(machines):
    """Machines that drew the same bits in the same way, the first of them in front."""
    groups = {}
    for drawn in machines:
        groups.setdefault((drawn["method"], drawn["sha256"]), []).append(drawn)
    return groups.values()


def _machines(record, group, is_first):
    """The three pictures of a figure on machines that draw the same bits, their numbers and checks.

    The figure's own machine has its picture large.
    """
    drawn, *others = group
    figure_id, wide = escape(record["id"]), record["width"] > record["height"]
    way = ("row" if wide else "") if is_first else "small"
    pictures = "".join(
        f'<figure><a href="{escape(p["file"])}"><img src="{escape(p["file"])}" loading="lazy" '
        f'width="{record["width"]}" height="{record["height"]}" '
        f'alt="{figure_id} on {escape(drawn["profile"])}, {escape(view)}"></a>'
        f"<figcaption><b>{escape(view)}</b>: {escape(p['caption'])}</figcaption></figure>"
        for view, p in drawn["pictures"].items()
    )
    return (
        f"<h3>{escape(drawn['profile'])} <span>{escape(drawn['method'])}</span></h3>"
        f'<div class="pictures {way}">{pictures}</div>'
        f'<p class="quiet">RMS difference from the ideal {drawn["difference_rms"]:.4f}; '
        f"largest {drawn['difference_max']:.3f} (1 = full intensity). "
        f"{_same_bits(others)}</p>"
        f"{_checks_table(drawn['checks'] + _failed_on(others))}"
    )


def _failed_on(others):
    """What failed on the machines that have no table: their checks draw more than the pictures shown."""
    return [c | {"on": drawn["profile"]} for drawn in others for c in drawn["checks"] if not c["passed"]]


def _same_bits(others):
    if not others:
        return ""
    return f"The same bits on {escape(', '.join(drawn['profile'] for drawn in others))}."


def _said(record):
    """What must be seen of a figure; of a variant, what was changed."""
    if "set" not in record:
        return f"<p><b>Must be seen:</b> {escape(record['must_see'])}</p>"
    changed = ", ".join(f"{name} = {json.dumps(value)}" for name, value in record["set"].items())
    return (
        f"<p><b>A variant of {escape(record['figure'])}:</b> {escape(changed)}. What must be seen, and what "
        "is checked, is of the figure's own values.</p>"
    )


def _section(record):
    figure_id = escape(record["id"])
    groups = enumerate(_groups(record["machines"]))
    return (
        f'<section id="{figure_id}"><h2><span>{figure_id}</span> {escape(record["title"])}</h2>'
        f"<p>{escape(record['caption'])}</p>{_said(record)}"
        f"{''.join(_machines(record, group, index == 0) for index, group in groups)}"
        f'<p class="quiet">Source: {escape(record["source"])} ({escape(", ".join(record["techniques"]))}). '
        f'<a href="{figure_id}.json">All numbers (JSON)</a></p></section>'
    )


def gallery(folder, figures):
    """The page, as text, of the figures whose JSON files lie in ``folder`` (``figure_record`` writes them),
    each with its variants after it.

    ``figures``: the ids in the page's order. Raises Refusal for a JSON file that is not a figure's.
    """
    sections, links = [], []
    for figure_id in figures:
        own = folder / f"{figure_id}.json"
        for path in (*([own] if own.is_file() else ()), *sorted(folder.glob(f"{figure_id}+*.json"))):
            try:
                sections.append(_section(json.loads(path.read_text())))
                links.append(f'<a href="#{escape(path.stem)}">{escape(path.stem)}</a>')
            except (ValueError, KeyError, TypeError) as error:
                raise Refusal(f"{path} is not what fixedpipe wrote; delete it and render again.") from error
    return (
        '<!doctype html><html lang="en"><head><meta charset="utf-8"><title>fixedpipe: figures</title>'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<style>{STYLE}</style></head><body><h1>Figures</h1>"
        '<p class="quiet">Each three times on a machine: the machine, the ideal, and their difference. '
        f"{INDEX} says what the ids in brackets are.</p>"
        f'<p class="quiet">{" · ".join(links)}</p>'
        f"{''.join(sections)}</body></html>\n"
    )
