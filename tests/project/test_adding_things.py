"""docs/adding-things.md names every file that a new piece of state touches: those that know its neighbours.

A row of a table says what to follow: names, with ``*``, that stand for a kind of thing. The files that have
such a name in their code, or as a string, are the row's files, no more and no fewer.
"""

import ast
import io
import re
import tokenize
from enum import Enum
from fnmatch import fnmatchcase
from functools import cache
from pathlib import Path

import pytest

from fixedpipe.pipeline import enums
from fixedpipe.pipeline.commands import COMMANDS
from fixedpipe.pipeline.profiles import PROFILES

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "adding-things.md"

# What knows a piece of state, in the order in which one would write it: from words to bits to witnesses.
LAYERS = (
    "raster/codes.py",
    "raster/float_depths.py",
    "raster/fixed.py",
    "pipeline/enums.py",
    "pipeline/sentences.py",
    "pipeline/state.py",
    "pipeline/pixel_transfer.py",
    "pipeline/commands.py",
    "pipeline/profiles/",
    "pipeline/__init__.pyi",
    "pipeline/textures/",
    "pipeline/programs/",
    "pipeline/validation/",
    "pipeline/notations/",
    "pipeline/description/",
    "pipeline/vertices/",
    "pipeline/framebuffers/",
    "raster/rows.py",
    "pipeline/native/",
    "raster/primitives/",
    "raster/portable/",
    "raster/vector/",
    "raster/columns/",
    "pipeline/columns/",
    "raster/pixels/",
    "pipeline/execution/",
    "pipeline/ideal/",
    "pipeline/inspection/",
    "pipeline/golden/",
    "tests/reference/",
    "tests/support/",
)
OURS = ("fixedpipe", "tests", "bench")
OF_STATE = ("raster", "pipeline", "tests/reference", "tests/support")
# Frames to draw, of states that others know: a new one needs none there.
_DRAWN = ("pipeline/selftest/", "pipeline/golden/vectors.py")
PRODUCT = ("raster", "pipeline", "effects", "bench")


def names_of(source):
    """Names in a module's code, without those that it imports from elsewhere, and its strings as they are."""
    tokens = tokenize.generate_tokens(io.StringIO(source).readline)
    names = {token.string for token in tokens if token.type == tokenize.NAME}
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.ImportFrom) and node.module.split(".")[0] not in OURS:
            names -= {alias.asname or alias.name for alias in node.names}
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            names.add(node.value)
    return names


@cache
def known_names(folders):
    """The names of every module in the folders, its own among them, by its path."""
    paths = [path for folder in folders for path in sorted((ROOT / folder).rglob("*.py*"))]
    paths = [path for path in paths if path.suffix in (".py", ".pyi")]
    names = {path.relative_to(ROOT).as_posix(): {path.stem, *names_of(path.read_text())} for path in paths}
    return {path: found for path, found in names.items() if not path.startswith(_DRAWN)}


def files_that_know(patterns, sources):
    """The files that have a name which fits one of the patterns."""
    return {
        path
        for path, names in sources.items()
        if any(fnmatchcase(name, pattern) for name in names for pattern in patterns)
    }


def expanded(path):
    """``a/{b,c}.py`` is two files."""
    if (braces := re.search(r"\{(.*?)\}", path)) is None:
        return [path]
    return [path.replace(braces[0], part) for part in braces[1].split(",")]


def rows(heading):
    """(what, what to follow, its files) of the table below a heading."""
    section = re.search(rf"^## {heading}\n(.*?)(?=^## |\Z)", PAGE.read_text(), re.MULTILINE | re.DOTALL)
    for line in section[1].splitlines():
        cells = [cell.strip() for cell in line.strip("|").split(" | ")]
        if line.startswith("|") and len(cells) == 3 and "`" in cells[1]:
            what, follow, files = (cells[0], *(re.findall(r"`([^`]+)`", cell) for cell in cells[1:]))
            yield what, follow, [path for each in files for path in expanded(each)]


def place(path):
    """Where a file comes in the order of ``LAYERS``."""
    return next(i for i, layer in enumerate(LAYERS) if path.startswith(layer))


STATE = list(rows("A piece of state"))
THINGS = list(rows("What is found by its name"))


@pytest.mark.parametrize(("what", "follow", "files"), STATE, ids=[row[0] for row in STATE])
def test_a_piece_of_state_is_known_to_the_files_of_its_row(what, follow, files):
    known = files_that_know(follow, known_names(OF_STATE))
    assert set(files) == known, f"{what}: {', '.join(sorted(known, key=place))}"
    assert files == sorted(files, key=place), f"{what}: in the order of LAYERS"


@pytest.mark.parametrize(("what", "follow", "files"), THINGS, ids=[row[0] for row in THINGS])
def test_a_thing_that_is_found_by_its_name_is_known_to_the_files_of_its_row(what, follow, files):
    known = files_that_know(follow, known_names(PRODUCT))
    ours = {path for path in files if path.startswith(PRODUCT)}
    assert ours == known, f"{what}: {', '.join(sorted(known))}"


@pytest.mark.parametrize(("what", "follow", "files"), STATE + THINGS, ids=[row[0] for row in STATE + THINGS])
def test_what_a_row_follows_and_its_files_are_there(what, follow, files):
    names = set().union(*known_names(PRODUCT).values())
    for pattern in follow:
        assert any(fnmatchcase(name, pattern) for name in names), f"{what}: nothing is named {pattern}"
    for path in files:
        assert list(ROOT.glob(path)), f"{what}: {path} is not there"


def test_every_enumeration_and_command_s_kind_has_a_row():
    followed = {name for _, follow, _ in STATE for name in follow}
    kinds = {
        name
        for name, kind in vars(enums).items()
        if isinstance(kind, type) and issubclass(kind, Enum) and kind.__module__ == enums.__name__
    }
    assert len(kinds) > 50
    assert kinds - followed == set()
    assert followed & {command.__name__ for command in COMMANDS}
    assert followed & PROFILES.keys()
    assert len(THINGS) >= 4


def test_a_file_that_no_row_names_is_noticed():
    _, follow, files = next(row for row in STATE if "BlendEquation" in row[1])
    source = "from fixedpipe.raster.codes import EQUATION_FUNC_ADD\n"
    sources = {**known_names(OF_STATE), "raster/vector/new.py": names_of(source)}
    assert files_that_know(follow, sources) - set(files) == {"raster/vector/new.py"}


def test_words_of_comments_and_of_other_packages_are_no_names():
    source = '"""Of ``Mapping``."""\n\nfrom collections.abc import Mapping\n\nx: Mapping = "G400"  # Accum\n'
    assert not names_of(source) & {"Mapping", "Accum"}
    assert {"x", "G400"} <= names_of(source)
