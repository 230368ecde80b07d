"""The meaning of techniques' ids, and the project's catalogue as HTML pages of the gallery."""

import ast
import re
from functools import cache
from html import escape
from pathlib import Path

from fixedpipe.effects.technique import INDEX

# Of the catalogue's pages, in the gallery's folder.
FOLDER = "catalogue"
_EFFECTS = Path(__file__).resolve().parents[2]
_ROOT = _EFFECTS.parent
_CATALOGUE = _ROOT.joinpath(INDEX).with_name("catalogue")


@cache
def technique_names():
    """What each technique is, in a line, by its id: as the modules of ``effects`` declare it."""
    found = {}
    for path in _EFFECTS.rglob("*.py"):
        source = path.read_text(encoding="utf-8")
        if "\nTECHNIQUES = " not in source:
            continue
        for call in ast.walk(ast.parse(source)):
            is_one = isinstance(call, ast.Call) and getattr(call.func, "id", "") == "Technique"
            if is_one and len(call.args) == 3:
                identifier, what, _ = map(ast.literal_eval, call.args)
                found[identifier] = what
    return found


@cache
def catalogue_pages():
    """The catalogue's pages as HTML, (title, body) by the name of the file; none if only a wheel is
    installed, which has no documents, or if the renderer of Markdown is missing.
    """
    try:
        from markdown_it import MarkdownIt  # rich needs it, so it is there
    except ImportError:
        return {}
    renderer = MarkdownIt("commonmark", {"html": True}).enable("table")
    return {
        f"{FOLDER}/{path.stem}.html": _page(renderer, path)
        for path in sorted(_CATALOGUE.glob("*.md"))
        if path.is_file()
    }


def _page(renderer, path):
    text = path.read_text(encoding="utf-8")
    title = text.splitlines()[0].lstrip("# ")
    body = renderer.render(text)
    # Headings get the anchors that links of the Markdown pages use.
    body = re.sub(r"<h([1-6])>(.*?)</h\1>", _heading, body)
    body = re.sub(r'<a href="([^"]*)">(.*?)</a>', _link, body)
    home = '<header class="top"><a class="home" href="../index.html">fixedpipe</a></header>'
    return title, f'{home}<main class="document">{body}</main>'


def _heading(found):
    level, text = found.groups()
    name = re.sub(r"[^\w -]", "", re.sub("<[^>]*>", "", text).lower()).replace(" ", "-")
    return f'<h{level} id="{escape(name)}">{text}</h{level}>'


def _link(found):
    """A link to a page of the catalogue leads to its HTML page; one to another file is its words."""
    target, words = found.groups()
    page, hash_, place = target.partition("#")
    if target.startswith(("http://", "https://", "#")):
        return found[0]
    name = Path(page).name.removesuffix(".md")
    if page.endswith(".md") and "/" not in page and (_CATALOGUE / Path(page).name).is_file():
        return f'<a href="{name}.html{hash_}{place}">{words}</a>'
    return words
