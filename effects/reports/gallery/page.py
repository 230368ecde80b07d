"""The gallery's page: what its script knows from the beginning. The plain page for browsers without scripts
is a separate file, so that other browsers do not load it.
"""

import json
import re
from html import escape
from pathlib import Path

from fixedpipe.effects.acceptance.must_see import sentences
from fixedpipe.effects.bibliography import plain
from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.reports.figure_failures import failures_of, in_words
from fixedpipe.effects.reports.gallery.catalogue import FOLDER, catalogue_pages, technique_names
from fixedpipe.effects.reports.gallery.plain import plain_page
from fixedpipe.effects.reports.style import PALETTE
from fixedpipe.effects.reports.viewing import script, style
from fixedpipe.effects.technique import PAPERS

# In the order in which they use each other.
SCRIPTS = ("data", "search", "views", "state", "grid", "below", "figure", "gallery")
INDEX, PLAIN = "index.html", "plain.html"


def pages(folder, figures):
    """The files of the page, text by name, of the figures whose JSON files lie in ``folder``
    (``figure_record`` writes them), each with its variants after it.

    ``figures``: the ids in the page's order. Raises Refusal for a JSON file that is not a figure's.
    """
    records, summaries, plain_pages, documents = [], [], [], catalogue_pages()
    for figure_id in figures:
        own = folder / f"{figure_id}.json"
        for path in filter(Path.is_file, (own, *sorted(folder.glob(f"{figure_id}+*.json")))):
            try:
                record = json.loads(path.read_text())
                summaries.append(_summary(record))
                plain_pages.append(plain_page(record, folder, _page_of(record, documents)))
                records.append(record)
            except (ValueError, KeyError, TypeError, AttributeError) as error:
                raise Refusal(f"{path} is not what fixedpipe wrote; delete it and render again.") from error
    says = f"{len(records)} figure{'s' * (len(records) != 1)}, drawn bit for bit{_version_of(records)}"
    if failed := sum(bool(failures_of(record)) for record in records):
        says += f", {failed} not whole"
    known = technique_names()
    index = {
        "says": says,
        "machines": {m["profile"]: m["name"] for record in records for m in record["machines"]},
        "papers": {record["source"]: _paper(record) for record in records},
        "techniques": {
            name: {"name": known.get(name, ""), "page": _place(name, documents)}
            for name in sorted({name for record in records for name in record["techniques"]})
        },
        "pages": {r["id"]: place for r in records if (place := _page_of(r, documents))},
        "figures": summaries,
    }
    links = "".join(
        f'<li><a href="#{escape(r["id"])}">{escape(r["id"])} {escape(r["title"])}</a></li>' for r in records
    )
    plain = (
        f'<header class="top"><b class="home">fixedpipe</b><span class="quiet">{escape(says)}. '
        f'<a href="{INDEX}">The gallery</a> finds, compares and magnifies, with a script.</span></header>'
        f'<main class="plain-page"><ul class="index">{links}</ul>{"".join(plain_pages)}</main>'
    )
    # Who has no script is led to the plain page; a browser that does not follow shows the link.
    away = f'<noscript><meta http-equiv="refresh" content="0; url={PLAIN}"></noscript>'
    page = (
        f'<noscript><p class="plain-page"><a href="{PLAIN}">All figures, without script</a></p></noscript>\n'
        f'<script type="application/json" id="index">{json_in_html(index)}</script>\n'
        f"<script>{script(__package__, SCRIPTS)}</script>"
    )
    title = "fixedpipe: figures"
    texts = {INDEX: _whole(title, page, away), PLAIN: _whole(title, plain)}
    return texts | {name: _whole(heading, text) for name, (heading, text) in documents.items()}


def _whole(title, body, head=""):
    """A page with the gallery's style; ``head``: what its head has besides."""
    return (
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>{escape(title)}</title>'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"{head}<style>{PALETTE}{style(__package__, 'gallery.css')}</style></head>\n"
        f"<body>{body}</body></html>\n"
    )


def _place(identifier, documents):
    """Where an id of the catalogue is said to be what it is, seen from the page; None: nowhere."""
    number = identifier[1:4] if "-" in identifier else PAPERS.get(identifier[0], ("",))[0]
    name = f"{FOLDER}/{number}.html"
    return f"{name}#{identifier.lower()}" if name in documents else None


def _page_of(record, documents):
    """Where the project's documents have a figure, seen from the page; None: nowhere."""
    return _place(record["id"], documents) if record["page"] else None


def json_in_html(value):
    """A value as JSON for a script element and for JavaScript: it has no "<" to end the element, and no
    character that ends a line.
    """
    text = json.dumps(value, ensure_ascii=False, separators=(",", ":"))
    return re.sub("[<>&\u2028\u2029]", lambda found: f"\\u{ord(found[0]):04x}", text)


def _version_of(records):
    versions = {m["provenance"]["fixedpipe"] for record in records for m in record["machines"]}
    return f", version {versions.pop()}" if len(versions) == 1 else ""


def _summary(record):
    """What the grid shows of a figure, and its search and chips ask."""
    machines = record["machines"]
    return {
        "id": record["id"],
        "title": record["title"],
        "caption": record["caption"],
        "must_see": sentences(record.get("must_see", "")),
        "labels": [panel["label"] for panel in record["panels"] if panel["label"]],
        "paper": record["source"],
        **({"figure": record["figure"]} if "set" in record else {}),
        **({"animation": True} if "animation" in record else {}),
        "techniques": record["techniques"],
        "panels": len(record["panels"]),
        "width": record["width"],
        "height": record["height"],
        "machines": [m["profile"] for m in machines],
        "methods": list(dict.fromkeys(m["method"] for m in machines)),
        "machines_differ": sum(m["same_bits_as"] is None for m in machines) > 1,
        "failed": sum(not check["passed"] for m in machines for check in m["checks"]),
        "failures": in_words(record),
        # None where no machine drew it.
        "thumbnail": machines[0]["pictures"]["machine"]["digest"] if machines else None,
    }


def _paper(record):
    """How a figure's source is cited: its title, who and where in a line, and that in two words."""
    citation = record["citation"]
    authors = [name.split()[-1] for name in re.split(r",? and |, ", citation["authors"]) if name.strip()]
    names = " and ".join(authors) if len(authors) < 3 else f"{authors[0]} and others"
    parts = [citation["authors"], place_of(citation["bibtex"]), str(citation["year"])]
    return {
        "title": citation["title"] or citation["key"],
        "authors": citation["authors"],
        "cited": "".join(f"{part}. " for part in parts if part).rstrip(),
        "short": f"{names or citation['key']} {citation['year']}".rstrip(),
    }


def place_of(bibtex):
    """Where a BibTeX entry appeared, in a line: the proceedings, volume and pages."""
    fields = dict(re.findall(r"^\s*(\w+)\s*=\s*\{(.*)\},?\s*$", bibtex, re.MULTILINE))
    places = ("booktitle", "journal", "institution", "organization", "howpublished")
    found = [fields[place] for place in places if place in fields][:1]
    if "volume" in fields:
        found.append(f"{fields['volume']}({fields['number']})" if "number" in fields else fields["volume"])
    if "pages" in fields:
        found.append(f"pages {fields['pages']}")
    return plain(", ".join(found))
