"""The pages as Sphinx reads them: a copy of README and docs/, and pages that are generated.

A copy keeps every page where it is, so that links between pages hold as they are. What changes on the way: a
link to a file of code leads to a page that shows it, the README is the index, and comments are left out.
"""

import json
import os
import re
from pathlib import Path, PurePosixPath

from docs.site import api_pages, code_pages, figure_pages

ROOT = Path(__file__).parents[2]
INDEX = "index.md"
# Pages beside docs/, by where they stand in the site.
OUTSIDE = {"README.md": INDEX, "CHANGELOG.md": "CHANGELOG.md", "CONTRIBUTING.md": "CONTRIBUTING.md"}
# Their own folder, and what a site needs no copy of.
LEFT_OUT = ("docs/site/", "docs/bibliography.bib", "docs/pixel-history.schema.json")
GUIDE = "docs/reading-guide.md"
# Pages that are in the table of contents below another, by the folder that they are in.
BELOW = {
    "docs/decisions": "docs/decisions/README.md",
    "docs/papers/catalogue": "docs/papers/catalogue/README.md",
    "docs/examples": "docs/examples/README.md",
    "figures": "figures/index.md",
    "api": "api/index.md",
}
# Those with a page for each figure and module, which would fill the table of contents of every page.
APART = ("figures", "api")
_ORPHAN = "---\norphan: true\n---\n"
_LINK = re.compile(r"\]\((?P<target>[^)#\s:]*)(?P<anchor>#[^)\s]*)?\)")
_COMMENT = re.compile(r"<!--[\s\S]*?-->")
_NAMED = re.compile(rf"`({code_pages.NAMED.pattern})`")


def _folder(name):
    """The folder of a page of the site."""
    return str(PurePosixPath(name).parent)


def pages():
    """Every file of the pages, by its path in the site: a dict of paths in the repository."""
    found = {"/".join(path.relative_to(ROOT).parts): path for path in sorted((ROOT / "docs").rglob("*"))}
    kept = {
        name: path
        for name, path in found.items()
        if path.is_file() and not name.startswith(LEFT_OUT) and path.suffix in (".md", ".ipynb", ".png")
    }
    return kept | {there: ROOT / name for name, there in OUTSIDE.items()}


class Links:
    """Makes a page's links those of the site, and collects the ``code`` that they lead to."""

    def __init__(self, names):
        self.names, self.code = set(names), set()

    def of(self, name, text):
        """``text`` of the page that stands at ``name``, with the links of the site."""
        home = PurePosixPath("README.md" if name == INDEX else name).parent

        def led(match):
            target = match["target"] or PurePosixPath("README.md" if name == INDEX else name).name
            anchor = match["anchor"] or ""
            there = os.path.normpath(home / target).replace(os.sep, "/")
            there = OUTSIDE.get(there, there)
            if (ROOT / there).is_dir():
                there = f"{there}/README.md"
            if there not in self.names:
                if not (ROOT / there).is_file():
                    return match[0]  # Sphinx says that it leads nowhere
                self.code.add(there)
                return f"](code:{there})"
            return f"]({os.path.relpath(there, PurePosixPath(name).parent)}{anchor})"

        self.code.update(path for path in _NAMED.findall(text) if (ROOT / path).is_file())
        return _LINK.sub(led, text)


def sections(guide):
    """The guide's headings with the pages that each section links to: [(heading, [target, ...]), ...]."""
    parts = re.split(r"^## (.*)$", guide, flags=re.MULTILINE)[1:]
    home = PurePosixPath(GUIDE).parent
    return [
        (heading, [os.path.normpath(home / m["target"]).replace(os.sep, "/") for m in _LINK.finditer(body)])
        for heading, body in zip(parts[::2], parts[1::2], strict=True)
    ]


def contents(names, guide):
    """The table of contents: [(heading, [page, ...]), ...], each page once, in the reading guide's order.

    What the guide does not lead to comes last; pages of a folder in ``BELOW`` are under that folder's own.
    """
    below = {
        name for name in names if str(PurePosixPath(name).parent) in BELOW and name not in BELOW.values()
    }
    left = {name for name in names if name.endswith((".md", ".ipynb"))} - below - {INDEX}
    found = [("Begin here", [GUIDE])]
    found += [
        (heading, list(dict.fromkeys(t for t in targets if t in left)))
        for heading, targets in sections(guide)
    ]
    seen, table = set(), []
    for heading, entries in found:
        table.append((heading, [each for each in entries if each not in seen]))
        seen.update(entries)
    rest = sorted(left - seen)
    return [(heading, entries) for heading, entries in [*table, ("More pages", rest)] if entries]


def toctree(entries, home, caption=None):
    """A table of contents that is seen beside pages alone. ``entries``: pages; ``home``: its folder."""
    lines = [os.path.relpath(each, home or ".") for each in entries]
    said = [":hidden:", *([f":caption: {caption}"] if caption else [])]
    return "\n\n```{toctree}\n" + "\n".join([*said, "", *lines]) + "\n```\n"


def examples(names):
    """The index of the notebooks."""
    lines = [f"- [{name}]({PurePosixPath(name).name})" for name in names]
    return (
        "# Notebooks\n\nEach runs in the tests, and shows here what it shows now.\n\n"
        + "\n".join(lines)
        + "\n"
    )


def stage(source, describe, gallery=None, out=None):
    """Write everything that Sphinx reads into the folder ``source``; the files of code that pages name.

    ``describe``: (figure's id, machine) -> the words of its passes. ``gallery``: the gallery's page, if there
    is one; ``out``: where the site will stand.
    """
    found = pages()
    link = os.path.relpath(gallery, out / "figures") if gallery else None
    figures = figure_pages.Pages(describe, gallery and gallery.parent, link)
    made = figures.written() | api_pages.written()
    notebooks = sorted(name for name in found if name.endswith(".ipynb"))
    if "docs/examples/README.md" not in found:
        made["docs/examples/README.md"] = examples([PurePosixPath(n).name for n in notebooks])
    links = Links([*found, *made])
    texts = {name: path.read_text() for name, path in found.items() if path.suffix == ".md"}
    for name, text in texts.items():
        texts[name] = links.of(name, figure_pages.beside(name, _COMMENT.sub("", text), describe))
    texts |= {name: links.of(name, text) for name, text in made.items()}
    for name in made:
        if _folder(name) in APART and name not in BELOW.values():
            texts[name] = _ORPHAN + texts[name]
    for heading, entries in contents([*found, *made], texts[GUIDE]):
        texts[INDEX] += toctree(entries, "", heading)
    for folder, page in BELOW.items():
        if folder in APART:
            continue
        inside = [n for n in [*found, *made] if _folder(n) == folder and n != page]
        texts[page] += toctree(sorted(n for n in inside if n.endswith((".md", ".ipynb"))), folder)
    contents_of = {name: text.encode() for name, text in texts.items()}
    for name, path in [*found.items(), *figures.files.items()]:
        if path.suffix in (".png", ".webp"):
            contents_of[name] = path.read_bytes()
        elif path.suffix == ".ipynb":
            contents_of[name] = _notebook(links.of(name, path.read_text())).encode()
    _write(source, contents_of)
    return links.code


def _write(folder, contents_of):
    """Make a folder hold these files alone. Those that are right stay: Sphinx reads what is newer."""
    for path in [path for path in folder.rglob("*") if path.is_file()]:
        if path.relative_to(folder).as_posix() not in contents_of:
            path.unlink()
    for name, content in contents_of.items():
        path = folder / name
        if not path.exists() or path.read_bytes() != content:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)


def _notebook(text):
    """A notebook whose cells are coloured as IPython's: they have commands of the shell."""
    notebook = json.loads(text)
    notebook["metadata"]["language_info"]["pygments_lexer"] = "ipython3"
    return json.dumps(notebook)
