"""docs/papers/catalogue has an entry for every id that the repository cites, and pages lead to it."""

import re
import tomllib
from collections import Counter
from functools import cache
from pathlib import Path

import pytest

from fixedpipe.effects.figures import FIGURES
from tests import techniques

ROOT = Path(__file__).parents[2]
CATALOGUE = ROOT / "docs" / "papers" / "catalogue"
ENTRIES = sorted(CATALOGUE.glob("*.md"))
PAGES = [
    page for page in sorted([*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")]) if page.parent != CATALOGUE
]
TEXTS = [
    *PAGES,
    *ENTRIES,
    *(
        path
        for folder in ("raster", "pipeline", "effects", "tests", "bench")
        for suffix in ("py", "pyi", "toml")
        for path in sorted((ROOT / folder).rglob(f"*.{suffix}"))
    ),
]
# P0 to P3 are passes.
ID = re.compile(r"\b(?:[HSGZK]\d\d|[FT]00\d-\d+|E00\d\.\d+|P(?:[4-9]|[1-9]\d))\b")
# Sequences of several techniques have one name: A-Z14/Z15/Z16.
SEQUENCE = re.compile(r"\bA-([HSGZK]\d\d(?:/[HSGZK]\d\d)*)")
# What tests ask for to be refused.
NOWHERE = {"F004-9", "F004-33", "F004-44", "F004-99", "P99"}
# Figures that a paper describes and does not number.
UNNUMBERED = {("001.md", "f001-cylinder")}
ANCHOR = re.compile(r'<a id="([^"]*)"></a>')
LINK = re.compile(r"\]\(([^)\s]*)#([^)\s]+)\)")
NUMBER = r"\d+(?:\.\d+)?(?:e-?\d+)?"
# Bounds that an entry has in words, by figure and check.
IN_WORDS = {
    ("F000-2", "20 x 20 polygons: RMS over that"): "at least five times that with 20 x 20",
    ("F003-23", "levels of 2x2 filtered comparisons"): "more than 8 for 2x2 filtered",
    ("F004-5", "colour of the highlights over red, largest deviation from gold's"): "(1, 0.77, 0.34)",
}


def cited(text):
    """The ids of all kinds in a text: a set."""
    sequences = {f"A-{each}" for found in SEQUENCE.findall(text) for each in found.split("/")}
    return {*ID.findall(text), *sequences}


@cache
def anchors():
    """Where every anchor stands: [(page's name, anchor), ...]."""
    return [(page.name, anchor) for page in ENTRIES for anchor in ANCHOR.findall(page.read_text())]


@cache
def entries():
    """The anchors that are ids', [(page's name, anchor), ...]."""
    return [each for each in anchors() if each not in UNNUMBERED]


def row_of(identifier):
    """An entry's cells, of a table's row."""
    name, anchor = techniques.entry_of(identifier).split("#")
    (row,) = re.findall(rf'^\| <a id="{anchor}"></a>.*$', (CATALOGUE / name).read_text(), re.MULTILINE)
    return re.split(r"(?<!\\)\|", row.strip("| "))


def words(text):
    """The words of a text, without their endings: a set."""
    return {word[:5] for word in re.findall(r"[a-z]{4,}", text.lower())}


def test_no_anchor_is_there_twice():
    names = [anchor for _, anchor in anchors()]
    assert [anchor for anchor, count in Counter(names).items() if count > 1] == []


def test_every_anchor_is_an_id_and_stands_on_its_page():
    for name, anchor in entries():
        identifier = re.sub(r"^(E\d{3})-", r"\1.", anchor.upper())
        assert identifier in {*cited(identifier), "P1", "P2", "P3"}, f"{name}: {anchor}"
        assert f"{name}#{anchor}" == techniques.entry_of(identifier)


def test_every_id_that_is_cited_has_an_entry():
    there = {f"{name}#{anchor}" for name, anchor in anchors()}
    missing = {
        identifier: str(path.relative_to(ROOT))
        for path in TEXTS
        for identifier in cited(path.read_text()) - NOWHERE
        if techniques.entry_of(identifier) not in there
    }
    assert missing == {}


def test_entries_are_counted_without_gaps():
    numbers = {}
    for _, anchor in entries():
        kind, number = re.fullmatch(r"(a-[hsgzk]|[hsgzkp]|[eft]\d{3}-)(\d+)", anchor).groups()
        numbers.setdefault(kind, set()).add(int(number))
    for kind, found in numbers.items():
        if not kind.startswith("a-"):
            assert found == set(range(1, len(found) + 1)), kind
    assert len(numbers["p"]) == 40
    documents = {f"{kind}{number}-" for kind in "ef" for number, _ in techniques.PAPERS.values()}
    assert numbers.keys() >= {*"hsgzkp", *documents}


@pytest.mark.parametrize("identifier", [each for each in FIGURES if each.startswith("F")])
def test_a_figure_s_entry_has_what_must_be_seen_in_it(identifier):
    figure = FIGURES[identifier]
    shown, seen, acceptance = row_of(identifier)[1:4]
    assert shown.strip() and seen.strip() and acceptance.strip()
    said = words(" ".join((figure.title, figure.caption, figure.must_see)))
    assert len(words(shown + seen) & said) >= 3, f"{shown}{seen}"


def numbers(text):
    """The numbers of a text, and what shares in percent, quotients and powers of ten are: a set."""
    shares = {
        float(n) / 100.0
        for found in re.findall(rf"({NUMBER})(?: to ({NUMBER}))? ?%", text)
        for n in found
        if n
    }
    quotients = {float(a) / float(b) for a, b in re.findall(rf"({NUMBER}) ?/ ?({NUMBER})", text) if float(b)}
    powers = {10.0 ** -int(n) for n in re.findall(r"10\^-(\d+)", text)}
    return {*map(float, re.findall(NUMBER, text)), *shares, *(1.0 - n for n in shares), *quotients, *powers}


def of_the_catalogue():
    """Bounds of the figures' data that are the catalogue's: (figure, check, bound, reason), but zeros."""
    for path in sorted((ROOT / "effects" / "figures").glob("*/figures.toml")):
        for identifier, table in tomllib.loads(path.read_text()).items():
            for name, check in table.get("checks", {}).items() if identifier.startswith("F") else ():
                bound, reason = check.get("at_most", check.get("at_least")), check["reason"]
                for answer in ("ideal", "machine"):
                    one, why = (x[answer] if isinstance(x, dict) else x for x in (bound, reason))
                    if one and why.startswith("the catalogue's"):
                        yield identifier, name, one, why


def test_bounds_that_are_the_catalogue_s_stand_in_its_entries():
    asked = set(of_the_catalogue())
    assert len(asked) > 70
    assert {(identifier, name) for identifier, name, *_ in asked} >= IN_WORDS.keys()
    for identifier, name, bound, why in sorted(asked):
        entry = " ".join(" ".join(row_of(each)) for each in (identifier, *re.findall(r"\bF00\d-\d+", why)))
        if (identifier, name) in IN_WORDS:
            assert IN_WORDS[identifier, name] in entry
        else:
            assert min(abs(bound - n) for n in numbers(entry)) < 1e-12, f"{identifier}, {name}: {bound}"


@pytest.mark.parametrize("page", [*PAGES, *ENTRIES], ids=lambda p: str(p.relative_to(ROOT)))
def test_every_link_to_an_entry_finds_it(page):
    headings = re.compile(r"^#+ (.*)$", re.MULTILINE)
    for target, anchor in LINK.findall(page.read_text()):
        path = (page.parent / target).resolve() if target else page
        if path.parent == CATALOGUE:
            sections = {found.lower().replace(" ", "-") for found in headings.findall(path.read_text())}
            assert (path.name, anchor) in anchors() or anchor in sections, f"{target}#{anchor}"


@pytest.mark.parametrize("page", PAGES, ids=lambda p: str(p.relative_to(ROOT)))
def test_a_page_leads_to_the_catalogue_no_later_than_it_cites_an_id(page):
    # Commands, examples, pictures and what readers do not see cite nothing.
    unread = r"(?ms:^```.*?^```$|<!--.*?-->|<img[^>]*>)|(?m:^    .*$)|`[^`\n]*`"
    text = re.sub(unread, "", page.read_text())
    paragraphs = re.split(r"\n\s*\n", text)
    citing = [number for number, paragraph in enumerate(paragraphs) if cited(paragraph)]
    if citing:
        targets = re.findall(r"\]\(([^)#\s]+)", "\n".join(paragraphs[: citing[0] + 1]))
        assert any(CATALOGUE in (page.parent / each).resolve().parents for each in targets), (
            f"{paragraphs[citing[0]]} cites an id; link it to docs/papers/catalogue there or before."
        )


def test_nothing_points_at_what_a_user_has_not_got():
    beside = "/".join(("shared", "papers"))
    for path in TEXTS:
        assert beside not in path.read_text(), path
