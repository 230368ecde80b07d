"""What the pages need of Sphinx: anchors written in HTML, ids as links with names, docstrings as they are."""

import re
from functools import cache

from docutils import nodes

from docs.site import code_pages
from docs.site.figure_pages import ROOT

# Ids of figures, techniques, studies, errata and rules.
ID = re.compile(r"\b(?:[HSGZK]\d\d|[FT]00\d-\d+|E00\d\.\d+|P(?:[4-9]|[1-9]\d)|N\d+\.\d+)\b")
_ANCHOR = re.compile(r'<a id="([^"]+)">')
# Text in these is no prose; a heading's links would be in the table of contents too.
_NO_PROSE = (nodes.reference, nodes.literal, nodes.literal_block, nodes.title, nodes.raw, nodes.doctest_block)
_UNDERLINED = re.compile(r"^\s*-{3,}$", re.MULTILINE)
# What reStructuredText would read as a reference: a word that ends with _, and bars; not within ``code``.
_MARKS = re.compile(r"((?<![`\w])\w+(?=_(?:[^\w`]|$))|(?=\|))(_|\|)(?=(?:[^`]|``[^`]*``)*$)")
_CATALOGUE = "docs/papers/catalogue/"


@cache
def names():
    """What every id is, in words: {id: words}."""
    from fixedpipe.effects.figures import FIGURES
    from fixedpipe.effects.studies import STUDIES
    from tests.techniques import NAMED, claims

    found = {each.id: each.what for _, each in claims()} | {key: what for key, (what, _) in NAMED.items()}
    found |= {each: FIGURES[each].title for each in FIGURES if each not in found}
    return found | {each: STUDIES[each].title for each in STUDIES}


def target(identifier, anchors):
    """Where an id leads: (page, anchor), or None. ``anchors``: {page: its anchors}."""
    if identifier.startswith("N"):
        place = "docs/numbers", identifier
        return place if identifier in anchors.get(place[0], ()) else None
    if f"figures/{identifier}" in anchors and re.match(r"[FT]", identifier):
        return f"figures/{identifier}", ""
    anchor = identifier.lower().replace(".", "-")
    pages = (page for page in anchors if page.startswith(_CATALOGUE) and anchor in anchors[page])
    page = next(pages, None)
    return None if page is None else (page, anchor)


def find_anchors(app, doctree):
    """Anchors that a page writes in HTML are places that links may name."""
    metadata = app.env.metadata[app.env.docname]
    found = [a for raw in doctree.findall(nodes.raw) for a in _ANCHOR.findall(raw.astext())]
    metadata["written_anchors"] = found
    slugs = metadata.setdefault("myst_slugs", {})
    for each in found:
        slugs.setdefault(each, (0, each, each))


def _linked(app, page, text, anchors):
    """A text's nodes, its ids as links; None where it has no id that leads anywhere."""
    parts, end = [], 0
    for match in ID.finditer(text):
        place = target(match[0], anchors)
        if place is None or place[0] == page:
            continue
        uri = app.builder.get_relative_uri(page, place[0]) + (f"#{place[1]}" if place[1] else "")
        link = nodes.reference("", match[0], refuri=uri, internal=True, classes=["id"])
        if match[0] in names():
            link["reftitle"] = names()[match[0]]
        parts += [nodes.Text(text[end : match.start()]), link]
        end = match.end()
    return [*parts, nodes.Text(text[end:])] if parts else None


def link_ids(app, doctree, page):
    """Ids in prose lead to what they are; every link that is an id has its name as a title."""
    metadata = app.env.metadata
    anchors = {each: set(metadata[each].get("written_anchors", ())) for each in app.env.found_docs}
    for link in doctree.findall(nodes.reference):
        if link.get("refuri", "").startswith("code:"):
            link["refuri"] = code_pages.relative(page, link["refuri"].removeprefix("code:"))
        if link.astext() in names():
            link.setdefault("reftitle", names()[link.astext()])
    for text in list(doctree.findall(nodes.Text)):
        above = text.parent
        while above is not None and not isinstance(above, _NO_PROSE):
            above = above.parent
        parts = None if above is not None else _linked(app, page, text.astext(), anchors)
        if parts:
            text.parent.replace(text, parts)
    for literal in list(doctree.findall(nodes.literal)):
        named = code_pages.NAMED.fullmatch(literal.astext())
        if named and (ROOT / named[0]).is_file() and not isinstance(literal.parent, nodes.reference):
            link = nodes.reference("", "", refuri=code_pages.relative(page, named[0]), internal=True)
            literal.replace_self(link)
            link += literal


def as_written(app, what, name, value, options, lines):
    """A docstring's columns and examples as they stand, its other words without marks of another notation."""
    blocks = re.split(r"(\n\s*\n)", "\n".join(lines))
    numpydoc = any(_UNDERLINED.search(block) for block in blocks)
    for number, block in enumerate(blocks):
        rows = block.splitlines()
        if not block.strip() or block.lstrip().startswith(">>>"):
            continue
        columns = any(re.search(r"\S {2,}\S", row) for row in rows)
        indented = not numpydoc and all(row.startswith("    ") for row in rows)
        if columns or indented:
            blocks[number] = "::\n\n" + "\n".join(f"   {row}" for row in rows)
        else:
            blocks[number] = _MARKS.sub(r"\1\\\2", block)
    lines[:] = "".join(blocks).splitlines()


def setup(app):
    """What Sphinx calls."""
    app.connect("doctree-read", find_anchors)
    app.connect("doctree-resolved", link_ids)
    app.connect("autodoc-process-docstring", as_written, priority=400)  # napoleon: 500
    return {"version": str(ROOT.name), "parallel_read_safe": True, "parallel_write_safe": True}
