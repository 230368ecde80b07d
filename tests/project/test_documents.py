"""Pages print what is measured: numbers that a command gives are compared, and others have a reason."""

import re
from pathlib import Path

import pytest

from fixedpipe.effects.figures import FIGURES
from fixedpipe.effects.studies import STUDIES
from tests import documents
from tests.support.sample import sampled, sampled_figures, slow_unless

ROOT = Path(__file__).parents[2]
TEXTS = {page: page.read_text() for page in documents.PAGES}
# What figures and studies give stays while their bits do, so it is measured again in turn.
SAMPLE = sampled_figures() | sampled(STUDIES) | {"costs"}
SOURCES = [
    pytest.param(
        page,
        source,
        id=f"{page.relative_to(ROOT)}-{source}",
        marks=slow_unless(source.partition("@")[0] in SAMPLE and documents.is_quick(source)),
    )
    for page, text in TEXTS.items()
    for source in documents.sources(text)
]
# What has a decimal point and is no number that a command gives.
_NO_NUMBERS = (
    r"^```[\s\S]*?^```",  # programs
    r"^    .*$",  # and commands
    r"`[^`]*`",
    r"<img [^>]*>",
    r"\]\([^)]*\)",
    r"(?:^.+\n)*^.*llvmpipe.*\n(?:.+\n)*",  # speed, which `make bench` measures on its own computer
    r"^\*Expected:\*[\s\S]*?\n\n",  # the catalogue's, of before anything was drawn
    r"\bE\d+\.\d+\b",  # an erratum
    r"\b[Ss]ections? [\d.]+\d(?: (?:and|to) [\d.]+\d)?",
    r"\bOpenGL 1\.\d(?:\.\d)?|\bPython 3\.\d+|ps\.1\.\d",
)
# Numbers that nothing measures: what the papers and the figures' scenes give, and bounds that checks have.
GIVEN = {
    "README.md": {},
    "docs/precision.md": {},
    "docs/machine-beside-ideal.md": {},
    "docs/studies.md": {},
    "docs/papers/000.md": {
        "0.65": "Fresnel's factor at an index of 200 and 89 degrees, which test_fresnel.py computes",
        "98.5": "the catalogue's proposal for F000-7",
        "0.29": "a uniform error of one step: the root of 1/12",
        "0.15": "F000-2's roughnesses, as is the next one",
        "0.35": "",
        "0.012": "the catalogue's bound for F000-2",
        "1.5": "an index of refraction, as in F000-5",
        "0.002": "H30's roughnesses, as is the next one, which is F000-5's too",
        "0.01": "",
        "6.74": "half of Phong's lobe of exponent 100 at half height",
        "0.05": "sigma and m of studies P1 and P3, as are the next two",
        "0.1": "",
        "0.4": "",
        "1.2": "a section of the paper",
        "71.5": "degrees of study P1, which docs/studies.md has",
        "15.7": "percents of study P2, as is the next one",
        "1.1": "",
        "0.3": "texels of study P3, as are the next two",
        "1.3": "",
        "3.2": "",
        "3.82": "degrees of study P34, as is the next one",
        "2.18": "",
    },
    "docs/papers/001.md": {
        "0.03": "the catalogue's bound of F001-10",
        "0.04": "the catalogue's bound of F001-12",
        "2.5": "how bright F001-10's moon is",
        "0.5": "deviations of study P25, which docs/studies.md has, as is the next one",
        "1.5": "",
        "0.0626": "study P26's, as is the next one",
        "0.0039": "",
        "3.6": "study P27's",
        "53.4": "study P28's, as is the next one",
        "0.002": "",
        "39.35": "1 - exp(-1/2), percent (E001.2)",
    },
    "docs/papers/002.md": {
        "1.234": "a groove's gain, as its form factor says; the next two too",
        "1.306": "",
        "1.111": "",
        "0.81": "areas of fans, which tests/effects/scattering/test_directions.py bounds; the next three too",
        "1.23": "",
        "0.94": "",
        "1.05": "",
        "1.4": "milliseconds, which `python -m bench scattering` measures",
        "0.0025": "study P14's, which docs/studies.md has, as the next one",
        "0.0057": "",
        "0.24": "the bumps' height, in edges of their field",
        "12.5": "study P38's misses in percent, as the next two",
        "5.3": "",
        "2.6": "",
    },
    "docs/papers/003.md": {
        "0.5": "F003-20's PolygonOffset",
        "1.1": "the catalogue's PolygonOffset",
        "1.5": "F003-21's PolygonOffset",
        "2.2": "F003-18's PolygonOffset",
        "0.1": "an example that can be computed by hand, as are the next four",
        "0.15": "",
        "0.2": "",
        "0.3": "",
        "9.9": "",
        "0.4": "a board's thickness",
    },
    "docs/papers/004.md": {
        "0.02": "study P16's alpha",
        "0.044": "R at the centre of the last texel of 256: the root of 1/512",
        "0.1": "alphas of study P10 and of Ward's albedo",
        "0.12": "Ward's albedo: tests/effects/reflectance/test_brdfs.py, as the next two",
        "0.50": "",
        "0.98": "",
        "0.2": "F004-8's alpha",
        "0.3": "F004-6's alpha",
        "0.5": "F004-8's alpha",
        "0.625": "F004-8's alpha on a GeForce 256",
        "0.64": "0.2 times 0.5 over 0.25 times 0.625",
        "0.25": "the combiners' smallest alpha",
        "1.5": "texels of the rim that ring_energy looks at; an angle of study P20",
        "127.5": "half of a byte's range",
        "0.945": "n.l where the highlights of K24 with N = 32 are",
        "0.0074": "2/255 times 0.945",
        "2.9": "K24 with bytes; 12 bits everywhere, and all but one place, are the next two",
        "0.4": "",
        "2.8": "",
    },
}


@pytest.mark.parametrize(("page", "source"), SOURCES)
def test_a_page_says_what_is_measured(page, source):
    assert [str(each) for each in documents.stale(page, TEXTS[page], source)] == []


@pytest.mark.parametrize("page", documents.PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_a_number_with_decimals_is_measured_or_has_a_reason(page):
    text = documents.without_measured(TEXTS[page])
    for pattern in _NO_NUMBERS:
        text = re.sub(pattern, "", text, flags=re.MULTILINE)
    printed = set(re.findall(r"(?<![\w.])[\d,]*\.\d+", text))
    assert sorted(printed) == sorted(GIVEN[str(page.relative_to(ROOT))])


@pytest.mark.parametrize("page", documents.PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_comments_of_a_page_are_marks_that_are_understood(page):
    assert "<!--" not in documents.without_measured(TEXTS[page])
    for source in documents.sources(TEXTS[page]):
        name, _, machine = source.partition("@")
        assert name in {*FIGURES, *STUDIES, *documents.BLOCKS, *documents.NUMBERS}, source
        assert not machine or machine in FIGURES[name].machines, source


def test_a_number_keeps_the_decimals_that_it_is_printed_with():
    assert documents.written(0.12345, "0.50") == "0.12"
    assert documents.written(115500.2, "1,000") == "115,500"
    assert documents.written(99.6, "98") == "100"
    assert documents.written(-0.001, "0.00") == "0.00"
    assert documents.written(-0.5, "0.25") == "-0.50"


@pytest.fixture
def measured(monkeypatch):
    """Sources of a test's own: F gives 0.125 and 3 of two checks, T a table."""
    monkeypatch.setattr(documents, "values", {"F": {"a b": 0.125, "c b": 3.0, "ideal: a b": 0.5}}.get)
    monkeypatch.setattr(documents, "BLOCKS", {"T": lambda: "| 1 |\n| 2 |\n"})
    documents.block.cache_clear()
    yield
    documents.block.cache_clear()


PAGE = (
    "One\n12.0<!--F: a * 100--> % and 3<!--F: c-->,\n<!-- T: begin -->\n\n| 1 |\n| 3 |\n\n<!-- T: end -->\n"
)


def test_what_is_stale_is_said_with_page_line_and_both_numbers(measured):
    page = ROOT / "docs" / "page.md"
    assert [str(each) for source in ("F", "T") for each in documents.stale(page, PAGE, source)] == [
        "docs/page.md:2: F: a: the page says '12.0', measured is '12.5'",
        "docs/page.md:6: T: the page says '| 3 |', measured is '| 2 |'",
    ]


def test_a_page_that_is_written_again_is_not_stale(measured):
    text = PAGE
    for source in documents.sources(PAGE):
        text = documents.measured_again(text, source)
    assert text == PAGE.replace("12.0", "12.5").replace("| 3 |", "| 2 |")
    assert not [each for source in ("F", "T") for each in documents.stale(ROOT / "page.md", text, source)]


def test_words_that_name_no_number_or_several_are_an_error(measured):
    assert documents.value("F", "ideal: a") == 0.5
    with pytest.raises(LookupError, match="F has 0 numbers named 'd'; there are: a b; c b"):
        documents.value("F", "d")
    with pytest.raises(LookupError, match="F has 2 numbers named 'b'"):
        documents.value("F", "b")
