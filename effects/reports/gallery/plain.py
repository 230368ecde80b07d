"""A figure on the plain page, without script: previews, numbers, checks, what must be seen, passes."""

import json
from html import escape
from urllib.parse import quote

from fixedpipe.effects.reports.figure_failures import in_words

# In the order in which they stand.
VIEWS = ("machine", "ideal", "reference", "difference", "reference_difference")


def plain_page(record, folder, page):
    """The section of a figure's record as HTML; pictures are those of its previews that ``folder`` has.

    ``page``: where the project's documents have the figure, seen from the page; None: nowhere.
    """
    figure_id = escape(record["id"])
    place = f' · <a href="{escape(page)}">what the paper shows</a>' if page else ""
    citation = record["citation"]
    said = ". ".join(escape(str(citation[key])) for key in ("authors", "title", "year") if citation[key])
    return (
        f'<section id="{figure_id}"><h2><span>{figure_id}</span> {escape(record["title"])}</h2>'
        f"<p>{escape(record['caption'])}</p>{_said(record)}{_failures(record)}"
        f"{''.join(_method(record, group, folder) for group in _methods(record))}"
        f"<p><code>{escape(record['command'])}</code></p>"
        f'<p class="quiet">{said} ({escape(", ".join(record["techniques"]))}){place} · '
        f'<a href="{quote(record["id"])}.json">all numbers (JSON)</a></p></section>'
    )


def _said(record):
    """What must be seen of a figure; of a variant, what was changed."""
    if "set" not in record:
        return f"<p><b>Must be seen:</b> {escape(record['must_see'])}</p>"
    changed = ", ".join(f"{name} = {json.dumps(value)}" for name, value in record["set"].items())
    return (
        f"<p><b>A variant of {escape(record['figure'])}:</b> {escape(changed)}. What must be seen, and what "
        "is checked, is of the figure's own values.</p>"
    )


def _failures(record):
    """What could not be drawn, a paragraph each."""
    return "".join(f'<p class="failed">{escape(sentence)}</p>' for sentence in in_words(record))


def _methods(record):
    """The machines that draw in the same way, the first of them in front."""
    groups = {}
    for drawn in record["machines"]:
        groups.setdefault(drawn["method"], []).append(drawn)
    return groups.values()


def _method(record, group, folder):
    drawn, names = group[0], {m["profile"]: m["name"] for m in record["machines"]}
    pictures = "".join(_picture(record, drawn, view, folder) for view in VIEWS)
    return (
        f"<h3>{escape(drawn['name'])} <span>{escape(drawn['method'])}</span></h3>"
        f'<div class="pictures">{pictures}</div>{"".join(_numbers(one, names) for one in group)}'
        f"{_passes(record, drawn)}{_checks(drawn['checks'] + _failed_on(group[1:]))}"
    )


def _picture(record, drawn, view, folder):
    picture = drawn["pictures"].get(view, {})
    preview = f"pictures/{picture.get('digest')}.webp"
    if not picture or not (folder / preview).is_file():
        return ""
    width, height = record["width"], record["height"]
    name = view.replace("_", " ")
    alt = f"{record['id']} on {drawn['name']}: {name}"
    return (
        f'<figure><img src="{escape(preview)}" loading="lazy" width="{width}" height="{height}" '
        f'alt="{escape(alt)}"><figcaption><b>{name}</b>: {escape(picture["caption"])}'
        "</figcaption></figure>"
    )


def _numbers(drawn, names):
    """How far a machine is from the ideal, in a line. ``names``: of machines, by key."""
    name = f"{escape(drawn['name'])} ({escape(drawn['profile'])})"
    if drawn["same_bits_as"]:
        return f'<p class="quiet">{name}: the same bits as {escape(names[drawn["same_bits_as"]])}.</p>'
    difference = drawn.get("difference")
    if not difference:
        return ""
    numbers = (
        f"RMS difference from the ideal {difference['rms']:.4g}, largest {difference['max']:.3g} (1 = full)"
    )
    where = (
        "; identical to the ideal rounded to its bits"
        if difference["identical"]
        else f" at x {difference['at'][0]}, y {difference['at'][1]}; {difference['pixels']} pixels differ"
    )
    return f'<p class="quiet">{name}: {numbers}{where}.</p>'


def _passes(record, drawn):
    if not drawn.get("passes"):
        return ""
    pictures = "".join(
        f'<figure><img src="pictures/{escape(p["preview"])}.webp" loading="lazy" width="{record["width"]}" '
        f'height="{record["height"]}" alt=""><figcaption>{p["number"]} {escape(p["label"])}</figcaption>'
        "</figure>"
        for p in drawn["passes"]
    )
    return f'<details><summary>Passes</summary><div class="pictures few">{pictures}</div></details>'


def _failed_on(others):
    """What failed on the machines that have no table of their own."""
    return [c | {"on": drawn["name"]} for drawn in others for c in drawn["checks"] if not c["passed"]]


def _checks(checks):
    if not checks:
        return ""
    word = {True: "ok", False: "failed"}
    rows = "".join(
        f'<tr><td class="{word[c["passed"]]}">{word[c["passed"]]}</td>'
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
        f'<div class="scroll"><table><tr>{head}</tr>{rows}</table></div></details>'
    )
