"""Data files: what they say is what figures, studies and checks have; what is wrong in them is a sentence."""

import ast
import tomllib
from pathlib import Path

import pytest

from fixedpipe.effects import data_files
from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.data_files import Data, sections_of

EFFECTS = Path(data_files.__file__).parent
FILES = sorted(path for name in data_files.WORDS for path in EFFECTS.rglob(name))

FILE = """\
# A comment before the first table.
[F004-1]
title = "A title"
caption = \"\"\"
A caption that
goes on.\"\"\"
must_see = "What must be seen."
source = "Somebody2000"
techniques = ["K01", "K15"]
panels = ["left", "right"]

[F004-1.checks."RMS of {name}"]
at_most.ideal = 1e-9
at_most.machine = 0.01
reason.ideal = "the same sums"
reason.machine = \"\"\"
bytes, of
{bits} bits\"\"\"

[F004-1.checks."pixels"]
at_least = 3
reason = "measured {{4}}"

[F004-1.checks."computed"]
reason = "the bound is another's"

[F004-2]
title = "Another"
caption = "."
must_see = "."
source = ""
techniques = []
"""


@pytest.fixture
def data(tmp_path):
    """data(identifier, a text of FILE, what is there instead) -> Data."""

    def read(identifier="F004-1", old="", new=""):
        assert old in FILE
        path = tmp_path / "figures.toml"
        path.write_text(FILE.replace(old, new, 1) if old else FILE)
        sections_of.cache_clear()
        return Data(path, identifier)

    return read


def test_words_are_a_figures_fields(data):
    assert data().words == {
        "id": "F004-1",
        "title": "A title",
        "caption": "A caption that goes on.",
        "must_see": "What must be seen.",
        "source": "Somebody2000",
        "techniques": ("K01", "K15"),
        "panels": ("left", "right"),
    }
    assert "panels" not in data("F004-2").words


def test_a_check_has_the_bound_and_the_reason_of_its_answer(data):
    found = [data().check("RMS of {name}", 0.5, on, name="light", bits=8) for on in Answer]
    assert found == [
        Check("RMS of light", 0.5, at_most=1e-9, on=Answer.IDEAL, reason="the same sums"),
        Check("RMS of light", 0.5, at_most=0.01, on=Answer.MACHINE, reason="bytes, of 8 bits"),
    ]
    pixels = data().check("pixels", 4, Answer.IDEAL)
    assert pixels == Check("pixels", 4, at_least=3, on=Answer.IDEAL, reason="measured {4}")
    assert type(pixels.bound) is int


def test_what_is_computed_is_given(data):
    found = data().check("computed", 1.0, Answer.IDEAL, at_most=2.0)
    assert found == Check("computed", 1.0, at_most=2.0, on=Answer.IDEAL, reason="the bound is another's")


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("must_see", "must_sea", r"\[F004-1\] has 'must_sea', which nothing reads. Did you mean must_see\?"),
        ('source = "Somebody2000"\n', "", r"\[F004-1\] has no source; give it one"),
        ('title = "A title"', "title = 1", r"title of \[F004-1\] is 1; give a text"),
        ('["K01", "K15"]', '"K01"', r"techniques of \[F004-1\] is 'K01'; give a list of texts"),
        ('["K01", "K15"]', "[1]", r"techniques of \[F004-1\] is \[1\]; give a list of texts"),
        ("panels =", 'compared = "left"\npanels =', "compared of .* is 'left'; give a list"),
        (
            "panels =",
            "compared = [1.5]\npanels =",
            r"compared of .* is \[1.5\]; give a list",
        ),
        (
            "panels =",
            'shown_by = ["a"]\npanels =',
            r"shown_by of .* is \['a'\]; give a list of lists of texts",
        ),
        ("panels =", "shown_by = [[1]]\npanels =", r"shown_by of .* is \[\[1\]\]; give a list of lists"),
        ("[F004-1]\n", "[F004-3]\n", "line 12 is of F004-1, whose tables end before; move it there"),
        ("[F004-2]\n", "[F004-1]\n", "line 27 is of F004-1, whose"),
        ('title = "A title"', "title = A", r"Invalid value \(at line 3, column 9\)"),
    ],
)
def test_wrong_words_are_refused(data, old, new, said):
    with pytest.raises(ValueError, match=f"figures.toml.*{said}"):
        data(old=old, new=new)


def test_a_figure_that_the_file_lacks_is_refused(data, tmp_path):
    with pytest.raises(ValueError, match=r"figures.toml has no \[F004-9\]. Did you mean F004-"):
        data("F004-9")
    with pytest.raises(ValueError, match=r"studies\.toml cannot be read: No such file"):
        data_files.study_data(str(tmp_path / "p01_a.py"), "P1")


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("at_least = 3", "at_leest = 3", "'pixels' of F004-1 has 'at_leest', which nothing reads. Did you"),
        ("at_least = 3", 'at_least = "3"', "at_least of the check 'pixels' of F004-1 is '3'; give a number"),
        ("at_least = 3", "at_least = true", "is True; give a number"),
        ("at_least = 3", "at_least.ideal = 3", "give a number, or one with at_least.ideal and one with"),
        ('reason = "measured {{4}}"', "", "the check 'pixels' of F004-1 has no reason"),
        (
            'reason = "measured {{4}}"',
            "reason = 4",
            "reason of the check 'pixels' of F004-1 is 4; give a text",
        ),
        ("measured {{4}}", "measured {four}", "'pixels' of F004-1 has four; Python gives none"),
        ('checks."pixels"', 'checks."pixel"', "F004-1 has no check 'pixels'. Did you mean pixel"),
        ('checks."pixels"', 'chekcs."pixels"', r"\[F004-1\] has 'chekcs', which nothing reads"),
        ("at_least = 3", "at_least = ", r"Invalid value \(at line 21, column 12\)"),
        ("at_least = 3", "at_least = 3\nat_most = 4", "give one, at_most or at_least"),
        ("at_least = 3", "", "has no bound; give one"),
    ],
)
def test_wrong_checks_are_refused(data, old, new, said):
    with pytest.raises(ValueError, match=said):
        data(old=old, new=new).check("pixels", 1.0, Answer.IDEAL)


def test_a_check_is_on_an_answer(data):
    with pytest.raises(ValueError, match=r"'pixels' of F004-1 is on 'machine'; give an Answer: Answer.IDEAL"):
        data().check("pixels", 1.0, "machine")


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"at_least": 3}, "'pixels' of F004-1 has at_least, and Python gives it too; leave one out"),
        ({"at_most": 3}, "give one, at_most or at_least"),
        ({"four": 4}, "'pixels' of F004-1 has no fields; Python gives four"),
    ],
)
def test_what_does_not_belong_to_the_file_is_refused(data, given, said):
    with pytest.raises(ValueError, match=said):
        data().check("pixels", 1.0, Answer.IDEAL, **given)


# ------------------------------------------------------------------------------------ the package's own files


def modules(path):
    """The modules that read a data file: (syntax tree, id) of each."""
    for module in sorted(path.parent.glob("*.py")):
        tree = ast.parse(module.read_text())
        for node in ast.walk(tree):
            if isinstance(node, ast.Call) and ast.unparse(node.func) in ("figure_data", "study_data"):
                yield tree, ast.literal_eval(node.args[1])


def texts(tree):
    """The texts of a module: a set."""
    return {node.value for node in ast.walk(tree) if isinstance(node, ast.Constant)}


def test_there_are_data_files():
    assert [path.parent.name for path in FILES] == [
        "heidrich_2000",
        "heidrich_2001",
        "kautz_seidel_2000",
        "schilling_1997",
        "zwicker_2016",
        "studies",
    ]


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.parent.name)
def test_a_file_in_pieces_says_what_the_whole_file_says(path):
    whole = tomllib.loads(path.read_text())
    assert list(whole) == list(sections_of(path))
    for identifier, table in whole.items():
        data, checks = Data(path, identifier), table.pop("checks", {})
        assert data.words.keys() == {"id", *table}
        assert data.checks == checks


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.parent.name)
def test_each_table_and_each_check_is_read_by_a_module(path):
    # A check that figures of several folders have is measured in effects/acceptance.
    shared = set().union(*(texts(ast.parse(p.read_text())) for p in (EFFECTS / "acceptance").glob("*.py")))
    readers = {identifier: texts(tree) | shared for tree, identifier in modules(path)}
    assert list(sections_of(path)) == sorted(readers, key=list(sections_of(path)).index)
    for identifier, known in readers.items():
        assert [name for name in Data(path, identifier).checks if name not in known] == []
