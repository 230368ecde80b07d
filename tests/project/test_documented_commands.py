"""Every ``fixedpipe …`` of the pages and notebooks is a command line that the real command takes.

The subcommand and its options exist, and take these values. A file need not be there.
"""

import re
import shlex
from pathlib import Path

import click
import nbformat
import pytest

from fixedpipe.effects.cli import main
from tests.notebooks import NOTEBOOKS

ROOT = Path(__file__).parents[2]
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")])
_COMMENT = re.compile(r"<!--[\s\S]*?-->")
_CONTINUED = re.compile(r" *\\\n\s*")
# A line of a block: indented, behind a prompt, in a notebook or a workflow; and code in a sentence.
_LINE = re.compile(
    r"^(?: {4,}|\$ |!| *- run: | *RUN )(?:\S+=\S+ )?(?:\.venv/bin/)?fixedpipe(?= |$)(?P<words>.*)$", re.M
)
# What stands at the right of a command in a column of its own, and says what it does.
_COLUMN = re.compile(r" {2,}.*")
_CODE = re.compile(r"`(?:\.venv/bin/)?fixedpipe(?P<words>\s[^`]*)`")
# Values that stand for one: a word in capitals, an ellipsis, a notebook's {variable}.
_STANDS_FOR = re.compile(r"[A-Z_]+|.*…|\.\.\.|\{.*\}")


def command_lines(text):
    """The words behind every ``fixedpipe`` of a page, as a shell cuts them."""
    text = _CONTINUED.sub(" ", _COMMENT.sub("", text))
    blocks = [_cut(m["words"]) for m in _LINE.finditer(text)]
    # A sentence may name an option without its value: `fixedpipe passes --trace`.
    named = [_cut(m["words"]) for m in _CODE.finditer(text)]
    return [*blocks, *([*words, "VALUE"] if words[-1].startswith("--") else words for words in named)]


def _cut(words):
    """The words up to what ends a command in a shell: a pipe, a redirection, a comment."""
    cut = shlex.shlex(_COLUMN.sub("", words), posix=True, punctuation_chars="|&;<>")
    cut.whitespace_split, cut.commenters = True, "#"
    found = []
    for word in cut:
        if set(word) <= set("|&;<>"):
            if word == ">" and found[-1:] == ["2"]:  # 2> redirects what is said of progress
                found.pop()
            break
        found.append(word)
    return found


def fault(words):
    """What the command would refuse of these words, as a sentence; None if it takes them."""
    command, context = main, click.Context(main, info_name="fixedpipe")
    while isinstance(command, click.Group):
        if words and _STANDS_FOR.fullmatch(words[0]):
            return None
        if not words or words[0].startswith("-"):
            break
        name, *words = words
        command = command.get_command(context, name)
        if command is None:
            return f"there is no {name}"
        context = click.Context(command, context, name)
    try:
        values, others, order = command.make_parser(context).parse_args(list(words))
        for parameter in dict.fromkeys(order):
            _convert(parameter, values[parameter.name], context)
        if more := [each for each in others if not _STANDS_FOR.fullmatch(each)]:
            return f"{more[0]} is one argument too many"
    except click.UsageError as error:
        return error.format_message()
    return None


def _convert(parameter, value, context):
    """Raise UsageError where a parameter does not take a value; what stands for a value, and files, pass."""
    if isinstance(parameter.type, click.Path | click.File):
        return
    for each in value if isinstance(value, list | tuple) else [value]:
        if isinstance(each, str) and not _STANDS_FOR.fullmatch(each):
            parameter.type(each, parameter, context)


@pytest.mark.parametrize("page", PAGES, ids=lambda path: str(path.relative_to(ROOT)))
def test_every_command_line_of_a_page_is_taken(page):
    found = [(words, fault(words)) for words in command_lines(page.read_text())]
    assert [f"fixedpipe {shlex.join(words)}: {wrong}" for words, wrong in found if wrong] == []


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_every_command_line_of_a_notebook_is_taken(path):
    cells = nbformat.read(path, as_version=4).cells
    found = [(words, fault(words)) for cell in cells for words in command_lines(cell.source)]
    assert [f"fixedpipe {shlex.join(words)}: {wrong}" for words, wrong in found if wrong] == []


def test_the_pages_have_hundreds_of_command_lines():
    # Of 400 and more; fewer would mean that they are no longer found.
    assert sum(len(command_lines(page.read_text())) for page in PAGES) > 300


@pytest.mark.parametrize(
    ("text", "wrong"),
    [
        ("    fixedpipe figurs F004-4", "there is no figurs"),
        ("    fixedpipe figures F004-4 --chek", "No such option"),
        ("So `fixedpipe bump photo.jpg --size big` draws.", "not a valid integer"),
        ("$ fixedpipe bump photo.jpg --size 0", "not in the range"),
        ("    fixedpipe bump photo.jpg --out", "requires an argument"),
        ("!fixedpipe golden acept a", "there is no acept"),
        ("    fixedpipe parameters F004-4 F004-5", "F004-5 is one argument too many"),
        ("    fixedpipe bump \\\n        photo.jpg --szie 4", "No such option"),
    ],
)
def test_a_wrong_line_is_seen(text, wrong):
    (words,) = command_lines(text)
    assert wrong in fault(words)


@pytest.mark.parametrize(
    "text",
    [
        "    fixedpipe bump photo.jpg --size 64 --out a.png  # a comment --of=this",
        "    fixedpipe bump photo.jpg --size N | less --odd",
        "`fixedpipe figures --profile NAME --profile paper`",
    ],
)
def test_a_right_line_is_taken(text):
    (words,) = command_lines(text)
    assert fault(words) is None
