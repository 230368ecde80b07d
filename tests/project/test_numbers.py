"""docs/numbers.md can be cited: its rules are numbered, short, and where code and pages say that they are."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "numbers.md"
TEXT = PAGE.read_text()
SECTIONS = re.findall(r"^## ((\d+)\. .*)$", TEXT, re.MULTILINE)
RULES = re.findall(r'^- <a id="(N\d+\.\d+)"></a>\*\*(N\d+\.\d+)\*\* ', TEXT, re.MULTILINE)
CITING = [
    path
    for pattern in (
        "*.md",
        "docs/**/*.md",
        "raster/**/*.py",
        "pipeline/**/*.py*",
        "effects/**/*.py",
        "tests/**/*.py",
    )
    for path in sorted(ROOT.glob(pattern))
    if path.suffix in (".md", ".py", ".pyi") and path != Path(__file__)
]


def slug(heading):
    """The anchor that a heading gets."""
    return re.sub(r"[^\w\s-]", "", heading.lower()).replace(" ", "-")


def bullets(text):
    """Every item of a list, its lines joined."""
    for item in re.findall(r"^- .*(?:\n(?!-|\n|#|\|).*)*", text, re.MULTILINE):
        yield re.sub(r"\s+", " ", item)


def cited(text):
    """Rules that a text cites, N5.3, and sections that it cites of this page by name."""
    rules = re.findall(r"\bN\d+\.\d+\b", text)
    sections = re.findall(r"numbers\.md[`)]*,?\s+section\s+(\d+)", re.sub(r"\n\s*#?\s*", " ", text))
    return set(rules), set(sections)


def test_the_contents_are_the_headings():
    contents = re.search(r"^## Contents\n\n(.*?)\n\n", TEXT, re.MULTILINE | re.DOTALL)[1]
    assert contents.splitlines() == [f"- [{heading}](#{slug(heading)})" for heading, _ in SECTIONS]
    assert [int(number) for _, number in SECTIONS] == list(range(1, len(SECTIONS) + 1))


def test_the_rules_of_a_section_are_numbered_in_order():
    assert all(anchor == shown for anchor, shown in RULES)
    expected = []
    for section in re.split(r"^## ", TEXT, flags=re.MULTILINE)[1:]:
        if number := re.match(r"\d+", section):
            items = re.findall(r"^- ", section, re.MULTILINE)
            expected += [f"N{number[0]}.{k + 1}" for k in range(len(items))]
    assert [shown for _, shown in RULES] == expected
    assert len(expected) > 150


def test_every_paragraph_of_a_section_is_a_numbered_rule():
    for section in re.split(r"^## \d+\. .*\n", TEXT, flags=re.MULTILINE)[1:]:
        for block in re.split(r"\n\n+", section.strip()):
            assert block.startswith(("- ", "| ", "#")), block


def test_no_rule_is_longer_than_a_thousand_characters():
    assert {item[:40]: len(item) for item in bullets(TEXT) if len(item) > 1000} == {}


@pytest.mark.parametrize("kind", ["raster", "pipeline", "effects", "tests", "docs", "."])
def test_what_code_and_pages_cite_is_there(kind):
    known = {shown for _, shown in RULES}, {number for _, number in SECTIONS}
    found = [
        path
        for path in CITING
        if path.relative_to(ROOT).parts[0] == kind or (kind == "." == str(path.relative_to(ROOT).parent))
    ]
    assert found
    for path in found:
        rules, sections = cited(path.read_text())
        assert rules <= known[0], f"{path}: {rules - known[0]}"
        assert sections <= known[1], f"{path}: {sections - known[1]}"


def test_a_citation_of_what_is_not_there_is_noticed():
    text = "Source: docs/numbers.md,\n    # section 77, and N99.1; docs/numbers.md section 5."
    assert cited(text) == ({"N99.1"}, {"77", "5"})
    assert list(bullets("- one\n  two\n- three\n\nfour")) == ["- one two", "- three"]


# What looks like a capture's name in evidence and is none.
WORDS = {"GeForce", "OpenGL", "ReadPixels", "CopyPixels", "NaN", "YCbCr", "E_i"}
_EXTENSION = re.compile(r"(?:ARB|ATI|EXT|NV|SGI|SGIS|SGIX)_")
_NAME = re.compile(r"\b(?:\d?[A-Z][A-Za-z0-9]*(?:[_-][A-Za-z0-9]+)+|[A-Z]+[a-z0-9]+[A-Z][A-Za-z0-9]*)\b")


def captures_named(text):
    """What measurements of a text name: suites, captures, and parts of captures' names."""
    for item in bullets(text):
        for evidence in re.findall(r"(?:Measured|Inferred): (.*?)(?=Source:|Assumed:|$)", item):
            for name in _NAME.findall(re.sub(r"`[^`]*`", "", evidence)):
                if name not in WORDS and not _EXTENSION.match(name) and not name.isupper():
                    yield name


def test_every_capture_that_a_measurement_names_is_redrawn():
    accepted = [
        line.split(":")[0] for line in (ROOT / "tests/conformance/accepted.txt").read_text().splitlines()
    ]
    found = list(captures_named(TEXT))
    assert len(found) > 100
    missing = sorted({name for name in found if not any(name in capture for capture in accepted)})
    assert not missing, "no accepted capture is named so: redraw and accept it, or mend the name"


def test_names_of_captures_are_found():
    text = (
        "- one. Measured: Fog, W_param, 3 of 3 (DotZW, `code_x`) on a GeForce 3. Source: NV_fence, DotXX.\n"
    )
    assert list(captures_named(text)) == ["W_param", "DotZW"]


# The captures that are redrawn: their suites and their cases.
_ACCEPTED = re.findall(
    r"^(\w+)/(.+?): \d+ / \d+$", (ROOT / "tests" / "conformance" / "accepted.txt").read_text(), re.MULTILINE
)
REDRAWN = {name for pair in _ACCEPTED for name in pair}
TAGS = ("Measured", "Source", "Inferred", "Assumed")
_TAG = re.compile(rf"\b(?:{'|'.join(TAGS)}):")
# Every rule, whole: its lines and its table.
WHOLE = dict(
    re.findall(r'^- <a id="(N\d+\.\d+)"></a>(.*?)(?=^- <a id=|^## |\Z)', TEXT, re.MULTILINE | re.DOTALL)
)


def names_a_capture(text):
    """Whether a text has the name of a suite or case that is redrawn, or what several cases begin with."""
    words = set(re.findall(r"[\w-]+", text))
    long = tuple(word for word in words if "_" in word)
    return bool(words & REDRAWN) or any(name.startswith(long) for name in REDRAWN if long)


def measurements(text):
    """What each ``Measured:`` of a rule says, to the next tag or the item's end."""
    for item in re.split(r"\n  - ", text):
        joined = re.sub(r"\s+", " ", item)
        for found in re.finditer(r"\bMeasured\b", joined):
            rest = joined[found.end() :]
            after = _TAG.search(rest, 1)
            yield rest[: after.start() if after else None]


def is_shown(measured, whole):
    """Whether a measurement names what is redrawn, or a rule, another one, that does."""
    return names_a_capture(measured) or any(
        "Measured:" in whole[rule] and any(map(names_a_capture, measurements(whole[rule])))
        for rule in re.findall(r"N\d+\.\d+", measured)
    )


@pytest.mark.parametrize("rule", WHOLE)
def test_a_rule_says_how_it_is_known(rule):
    assert _TAG.search(WHOLE[rule]), "Measured:, Source:, Inferred:, or Assumed: and what would settle it"


def test_every_format_of_the_table_says_how_it_is_known():
    table = TEXT.split("## 1. Formats")[1].split("## 2.")[0]
    rows = [row.strip("|").rsplit("|", 1)[1] for row in re.findall(r"^\|.*\|$", table, re.MULTILINE)][2:]
    assert len(rows) > 10
    for row in rows:
        assert _TAG.match(row.strip()), row
        assert all(names_a_capture(measured) for measured in measurements(row)), row


@pytest.mark.parametrize("rule", [rule for rule, text in WHOLE.items() if "Measured" in text])
def test_each_measurement_names_a_capture_that_is_redrawn(rule):
    found = list(measurements(WHOLE[rule]))
    assert found
    assert [measured for measured in found if not is_shown(measured, WHOLE)] == []


def test_what_names_no_capture_is_seen():
    assert names_a_capture("all pixels (Texture_cubemap)") and names_a_capture("DepthFmt_z16's captures")
    assert not names_a_capture("Measured: all pixels of 3 captures. OpenGL 1.2.1")
    rules = {"N1.1": "A. Measured: 3 of 3 (Fog). Source: Clear.", "N1.2": "B. Measured: N1.1.", "N1.3": "C."}
    rules["N1.4"] = "D.\n  - Measured: 1 of 1.\n  - Fog. Measured: 2 of\n    2 (Clear; N1.3)."
    assert list(measurements(rules["N1.1"])) == [": 3 of 3 (Fog). "]
    assert list(measurements(rules["N1.4"])) == [": 1 of 1.", ": 2 of 2 (Clear; N1.3)."]
    assert [is_shown(m, rules) for m in measurements(rules["N1.4"])] == [False, True]
    assert [is_shown(m, rules) for m in measurements(rules["N1.2"])] == [True]
    assert not is_shown(": 1 of 1 (N1.3)", rules)
