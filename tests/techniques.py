"""docs/papers/index.md, of what techniques, figures and studies declare: ``python -m tests.techniques``."""

import importlib
import re
from functools import cache
from pathlib import Path

from fixedpipe.effects.figures import FIGURES
from fixedpipe.effects.reflectance.brdfs import BRDFS
from fixedpipe.effects.studies import STUDIES
from fixedpipe.effects.technique import INDEX, OWN, PAPERS, Technique, Variant

ROOT = Path(__file__).parents[1]
PAGE = ROOT / INDEX
# The page that goes through a document, by its number.
PAGES = {"000": "000.md", "001": "001.md", "002": "002.md", "003": "003.md", "004": "004.md"}
# What comments and pages name of the papers and no module here is, by id: what it is, and where.
NAMED = {
    "G07": ("hierarchical dependent tests", "3.1, 7"),
    "G37": ("other simulated BRDFs, and other methods that are dependent tests, as related work", "2, 3.1"),
    "G38": ("other geometry, media that scatter, whole scenes, as future work", "7"),
    "G39": ("what is assumed: a height field, nothing else inside its hull, small bumps", "1, 3"),
    "K19": ("other hardware for bump mapping and shading, as related work", "2"),
    "K23": ("materials that are measured or painted, as future work", "7"),
    "S03": ("image-based rendering, which changes texture hardware a little", "2"),
    "S04": ("impostors, pictures that stand for things for some frames", "2"),
    "S05": ("simplified meshes and culling", "2"),
    "S06": ("memory on the chip", "2"),
    "S27": ("a correction for rectangular distributions, announced and not given", "8"),
    "S30": ("shadows, left out", "10"),
    "Z28": ("trapezoidal shadow maps, smoothies, robust shadow volumes: links", "Resources"),
}

_HEAD = """\
# What the ids mean

With this page you can find the module, the figures and the studies that belong to an id, and its entry in the
catalogue.

A technique's id, such as K07, is a letter for the paper and a number. The papers do not number techniques;
these numbers are this project's. Each id leads to its entry in the [catalogue](catalogue/README.md). The
entry says what the paper has there, which passes draw it, what a picture must show, and by which numbers it
is accepted.

`make techniques` makes this page from what the modules of `effects/` declare, and a test fails if it is
stale. A technique's module declares its ids. Figures and studies declare the ids that they use.

"""
_OTHER_IDS = """
The other ids:

- **F004-2** is figure 2 of document 004; `fixedpipe figures F004-2` draws it. Document 003 does not number
  its pictures, so they are counted here. A [figure](#figures) with a technique's id, such as K14, shows what
  the paper has no picture of.
- **P11** is an artefact of the hardware, which a [study](#studies) measures.
- **E004.9** is an erratum of document 004, or a point that it leaves open, with what this project does.
- **A-K07** is the sequence of passes of K07.
"""
_FIGURES = """
## Figures

`fixedpipe figures F004-2` draws a figure, and `--check` compares it with its acceptance.

"""
_STUDIES = """
## Studies

`fixedpipe study P11` measures one; [studies.md](../studies.md) has the numbers.

"""
_NAMED = """
## Named, not drawn

Comments and pages name these techniques of the papers; no module here draws them.

"""


@cache
def declared():
    """What every module of effects/ declares: ((path in the repository, Technique or Variant), ...)."""
    found = []
    for path in sorted((ROOT / "effects").rglob("*.py")):
        if re.search(r"^TECHNIQUES = ", path.read_text(), re.MULTILINE):
            name = ".".join(path.relative_to(ROOT).with_suffix("").parts)
            module = importlib.import_module(f"fixedpipe.{name}")
            found += [(str(path.relative_to(ROOT)), each) for each in module.TECHNIQUES]
    return tuple(found)


def claims():
    """(path, Technique) of all techniques, by id."""
    found = [(path, each) for path, each in declared() if isinstance(each, Technique)]
    return sorted(found, key=lambda pair: pair[1].id)


def other_ways(identifier):
    """(path, how) of the modules that draw another module's technique by other means."""
    return [
        (path, each.how) for path, each in declared() if isinstance(each, Variant) and identifier in each.ids
    ]


def users(identifier, collection):
    """The ids of the figures or studies that name a technique."""
    return [each for each in collection if identifier in collection[each].techniques]


def _entry(key):
    """The bibliography's fields of a paper, by name, without its marks of TeX."""
    bibliography = (ROOT / "docs" / "bibliography.bib").read_text()
    entry = re.search(rf"^@\w+\{{{key},\n(.*?)^\}}", bibliography, re.MULTILINE | re.DOTALL)[1]
    fields = dict(re.findall(r"^  (\w+) = \{(.*)\},?$", entry, re.MULTILINE))
    return {name: re.sub(r"[{}]", "", value) for name, value in fields.items()}


def _paper(key):
    entry = _entry(key)
    return f"{entry['author'].replace(' and ', ', ')}, *{entry['title']}*, {entry['year']}"


def _link(path, words=None):
    return f"[{words or Path(path).stem}](../../{path})"


def _module_link(collection, identifier):
    path = collection.module_of(identifier).removeprefix("fixedpipe.").replace(".", "/")
    return _link(f"{path}.py", identifier)


def entry_of(identifier):
    """Where an id stands in the catalogue, of whatever kind: "004.md#a-k07"."""
    if identifier[0] == "P":
        page = "artefacts"
    elif identifier[0] in "EFT":
        page = identifier[1:4]
    else:
        page = PAPERS[identifier.removeprefix("A-")[0]][0]
    return f"{page}.md#{identifier.lower().replace('.', '-')}"


def _entry_link(identifier):
    if identifier[0] == OWN:
        return identifier
    return f"[{identifier}](catalogue/{entry_of(identifier)})"


def _row(cells):
    return "| " + " | ".join(cells) + " |"


def _table(head, rows):
    return "\n".join([_row(head), _row(["---"] * len(head)), *map(_row, rows)]) + "\n"


def _where(path, technique):
    """The module, those that draw the same otherwise, and the equation's rows."""
    ways = "".join(f"; {_link(other)}: {how}" for other, how in other_ways(technique.id))
    models = ", ".join(f"`{name}`" for name, row in BRDFS.items() if row.technique == technique.id)
    equations = f"; {_link('effects/reflectance/brdfs.py')}: {models}" if models else ""
    return _link(path) + ways + equations


def _papers():
    rows = [
        (
            letter,
            number,
            _paper(key),
            f"`{key}`",
            f"[{number}](catalogue/{number}.md)",
            f"[{PAGES[number]}]({PAGES[number]})" if number in PAGES else "",
        )
        for letter, (number, key) in PAPERS.items()
    ]
    bibliography = "[bibliography](../bibliography.bib)"
    head = ("letter", "document", "paper", bibliography, "catalogue", "what is drawn")
    return _table(head, rows)


def _techniques(letter):
    rows = [
        (
            _entry_link(technique.id),
            technique.what,
            technique.section,
            _where(path, technique),
            ", ".join(_module_link(FIGURES, each) for each in users(technique.id, FIGURES)),
            ", ".join(_module_link(STUDIES, each) for each in users(technique.id, STUDIES)),
        )
        for path, technique in claims()
        if technique.id[0] == letter
    ]
    place = "slide" if letter == "Z" else "section"
    return _table(("id", "what it is", place, "modules", "figures", "studies"), rows)


def _figures():
    rows = [
        (_entry_link(each), figure.title, _module_link(FIGURES, each), ", ".join(figure.techniques))
        for each, figure in FIGURES.items()
    ]
    return _table(("id", "what is drawn", "module", "techniques"), rows)


def _studies():
    rows = [
        (
            _entry_link(each),
            study.title,
            _module_link(STUDIES, each),
            ", ".join(study.techniques),
            f"`{study.source}`",
        )
        for each, study in STUDIES.items()
    ]
    return _table(("id", "what is measured", "module", "techniques", "paper"), rows)


def page():
    """The whole page as text."""
    parts = [_HEAD, _papers(), _OTHER_IDS]
    heads = {letter: f"{letter}: document {number}, {key}" for letter, (number, key) in PAPERS.items()}
    for letter, head in {**heads, OWN: f"{OWN}: of none of these papers"}.items():
        if any(technique.id[0] == letter for _, technique in claims()):
            parts += [f"\n## {head}\n\n", _techniques(letter)]
    named = [(_entry_link(identifier), what, where) for identifier, (what, where) in NAMED.items()]
    parts += [_FIGURES, _figures(), _STUDIES, _studies()]
    parts += [_NAMED, _table(("id", "what it is", "section or slide"), named)]
    return "".join(parts)


if __name__ == "__main__":
    PAGE.write_text(page())
