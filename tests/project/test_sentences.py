"""Pages are in plain English: short sentences, and none of the phrases that a newcomer stumbles over."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
# The changelog is a record: what was written in it stays.
PAGES = sorted({*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")} - {ROOT / "CHANGELOG.md"})
# Words of the longest sentence, and of the mean one of a page; columns of the longest line of prose.
LONGEST, MEAN, COLUMNS = 35, 18, 130
# None of these says what is meant in any sentence of a page.
BANNED = (
    r"\bcame to be\b",
    r"\b(?:is|are|was|were|be|been|being) told\b",
    r"\b(?:who|nobody|somebody) asks?\b",
    r"\bthe same of\b",
    r"\bmissing of\b",
    r"\bof which there\b",
    r"\bstands? beside\b",
    r"\bwhat is (?:asked|said) of\b",
    r"\bat (?:every|each|the|their) doors?\b",
)
# What is no prose, in the order in which it goes: lines, then what is in a line.
_NO_LINES = (
    (r"<!--[\s\S]*?-->", ""),
    (r"^ *```[\s\S]*?^ *```", "\n\n"),  # programs
    (r"(?<=\n\n)(?:(?: {4}.*)?\n)+", "\n\n"),  # and commands
    (r"^#+ .*$", "\n\n"),
    (r"^(?: *\||<img ).*$", "\n\n"),  # tables and pictures
)
_NO_WORDS = (
    (r"^ *(?:[-*+]|\d+\.) ", "\n\n"),  # an item of a list is a paragraph
    (r"<[^>\n]*>", ""),
    (r"`[^`]*`", "CODE"),  # one word
    (r"!?\[([^\]]*)\]\((?:[^()]|\([^()]*\))*\)", r"\1"),
    (r"https?://\S+", "ADDRESS"),
    (r"\*", ""),  # emphasis
)
# A full stop, what may stand behind it, a space, and how a sentence begins. Initials end none.
_END = re.compile(r"(?<!\b[A-Z])[.!?][\"')\]]*\s+(?=[\"'(\[…]*[A-Z0-9…])")


def without(text, rules):
    """A text after the substitutions of ``rules``, one after the other."""
    for pattern, instead in rules:
        text = re.sub(pattern, instead, text, flags=re.MULTILINE)
    return text


def sentences(text):
    """The sentences of a Markdown page, without code, tables, headings, comments and targets of links."""
    text = without(text, (*_NO_LINES, *_NO_WORDS))
    paragraphs = (" ".join(p.split()) for p in re.split(r"\n\s*\n", text))
    return [s.strip() for p in paragraphs for s in _END.split(p) if words(s)]


def words(sentence):
    """How many words a sentence has: what has a letter or a digit, between spaces."""
    return sum(bool(re.search(r"\w", each)) for each in sentence.split())


def faults(text):
    """What is wrong with a page, as lines."""
    found = sentences(text)
    lengths = [words(each) for each in found]
    wrong = [f"{n} words: {each}" for n, each in zip(lengths, found, strict=True) if n > LONGEST]
    if found and sum(lengths) > MEAN * len(found):
        wrong.append(f"{sum(lengths) / len(found):.1f} words in the mean sentence")
    lines = without(text, _NO_LINES).splitlines()
    wrong += [f"{len(line)} columns: {line}" for line in lines if len(line) > COLUMNS]
    for each in found:
        wrong += [f"{m[0]!r}: {each}" for phrase in BANNED if (m := re.search(phrase, each, re.IGNORECASE))]
    return wrong


@pytest.mark.parametrize("page", PAGES, ids=lambda path: str(path.relative_to(ROOT)))
def test_a_page_is_in_plain_english(page):
    assert faults(page.read_text()) == []


def begins_for_its_reader(page):
    """Whether a page's first paragraph says what its reader can do after it."""
    return (
        re.search(r"\b(?:After|With) (?:this page|these pages|it) you\b", " ".join(sentences(page)[:2]))
        is not None
    )


@pytest.mark.parametrize("page", PAGES, ids=lambda path: str(path.relative_to(ROOT)))
def test_a_page_begins_with_what_its_reader_can_do_after_it(page):
    text = page.read_text()
    if page == ROOT / "README.md":
        return
    if re.match(r"\d{4}-", page.name):  # a decision: what was decided, or what decides now
        assert re.match(r"# \S.*\n\n\*\*(?:Decided|What was to be decided|Superseded)\b", text)
    else:
        assert begins_for_its_reader(text)


def test_a_page_that_begins_with_its_making_is_found():
    assert begins_for_its_reader("# A\n\nAfter this page you know A.\n")
    assert begins_for_its_reader("# A\n\nIt is for all. After it you know A.\n")
    assert not begins_for_its_reader("# A\n\n`make a` makes this page. It has all. After it you know all.\n")


SENTENCE = "It is " + "so " * 32 + "big."  # 35 words


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("It has more " + SENTENCE + "\n\n" + "Short. " * 4, "38 words: It has more It is so"),
        ("- A first item\n- It has more " + SENTENCE + "\n\n" + "Short. " * 4, "38 words"),
        ("> It has [more](there.md)\n> " + SENTENCE + "\n\n" + "Short. " * 4, "38 words"),
        (SENTENCE + "\n\nA second one.", "19.0 words in the mean sentence"),
        ("So it came\nto be here.", "'came to be'"),
        ("The rule **is told** to them.", "'is told'"),
        ("Who asks, learns.", "'Who asks'"),
        ("It is the same of two.", "'the same of'"),
        ("[A link](" + "so/many/" * 20 + "x.md) is long.", "183 columns"),
    ],
)
def test_a_fault_is_seen(text, fault):
    assert [each for each in faults(text) if fault in each]


@pytest.mark.parametrize(
    "text",
    [
        SENTENCE + " Short. " * 3,
        '<img src="' + "so/many/" * 20 + '"> <img src="">\n',
        "```text\n" + SENTENCE * 2 + "\n```\n",
        "So:\n\n    " + SENTENCE * 2 + "\n\n        " + SENTENCE + "\n\nDone.",
        "| " + SENTENCE * 2 + " |\n|---|\n",
        "# " + SENTENCE * 2 + "\n",
        "<!-- " + SENTENCE * 2 + "-->\n",
        "It has 7<!--so many, " + "so many, " * 5 + "\n" + "so many, " * 9 + "so many--> pixels.\n",
        "See [a page](" + "so/many/" * 10 + "x.md),\n`" + "so many " * 15 + "`.\n",
        "It came. To be is a verb.",
    ],
)
def test_what_is_right_or_no_prose_is_no_fault(text):
    assert faults(text) == []


@pytest.mark.parametrize(
    ("text", "found"),
    [
        (
            "One. Two (three). *Four.* `five` is code. Six!",
            ["One", "Two (three)", "Four", "CODE is code", "Six!"],
        ),
        ("J. Kautz wrote it, n.l is 0.5. It ends.", ["J. Kautz wrote it, n.l is 0.5", "It ends."]),
        ("- one\n- two\n  and three\n\n1. four\n", ["one", "two and three", "four"]),
        ("Above a command:\n\n    fixedpipe figures\n\nbelow it.\n", ["Above a command:", "below it."]),
    ],
)
def test_a_page_is_cut_into_sentences(text, found):
    assert sentences(text) == found
