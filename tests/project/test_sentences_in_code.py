"""Plain English beyond the pages: captions, reasons, docstrings, --help and refusals, by the same bounds."""

import ast
import inspect
import re
import tomllib
from pathlib import Path

import pytest

import fixedpipe.pipeline as pipeline
from docs.site.api_pages import commands
from tests.project.test_sentences import BANNED, LONGEST, MEAN, words

ROOT = Path(__file__).parents[2]
# As on pages, but a sentence may begin with a variable in parentheses.
_END = re.compile(r"(?<!\b[A-Z])[.!?][\"')\]]*\s+(?=[\"'(\[…]*[A-Z0-9…]|\()")
DATA = sorted((ROOT / "effects").rglob("*.toml"))


def cut(text):
    """The sentences of plain text, with an empty line between paragraphs; code or an option is one word."""
    text = re.sub(r"``?[^`]*``?|(?<!\S)--[a-z]\S*", "CODE", text)
    paragraphs = (" ".join(each.split()) for each in re.split(r"\n\s*\n", text))
    return [s for paragraph in paragraphs for s in _END.split(paragraph) if words(s)]


def prose(docstring):
    """A docstring without its examples, columns and headings of sections."""
    kept = []
    for block in re.split(r"\n\s*\n", inspect.cleandoc(docstring)):
        lines = block.splitlines()
        no_prose = (
            block.lstrip().startswith(">>>")
            or all(line.startswith("    ") for line in lines)
            or any(re.search(r"\S {2,}\S", line) or re.fullmatch(r"\s*-{3,}", line) for line in lines)
        )
        if not no_prose:
            kept.append(re.sub(r"^\s*- ", "\n\n", block, flags=re.MULTILINE))
    return "\n\n".join(kept)


def faults(texts):
    """What is wrong with texts, as lines; ``texts``: {where: text}."""
    found = [(where, sentence) for where, text in texts.items() for sentence in cut(text)]
    lengths = [words(sentence) for _, sentence in found]
    pairs = list(zip(lengths, found, strict=True))
    wrong = [f"{where}: {n} words: {sentence}" for n, (where, sentence) in pairs if n > LONGEST]
    if found and sum(lengths) > MEAN * len(found):
        wrong.append(f"{sum(lengths) / len(found):.1f} words in the mean sentence")
    for where, sentence in found:
        banned = (re.search(phrase, sentence, re.IGNORECASE) for phrase in BANNED)
        wrong += [f"{where}: {match[0]!r}: {sentence}" for match in banned if match]
    return wrong


def strings(table, where=""):
    """Every text of a TOML file by where it stands, but keys of the bibliography."""
    found = {}
    for key, value in table.items():
        if isinstance(value, dict):
            found |= strings(value, f"{where}.{key}")
        elif isinstance(value, str) and key != "source":
            found[f"{where}.{key}"] = value
    return found


def docstrings():
    """The docstrings of all that ``fixedpipe.pipeline`` has, and of its classes' public members."""
    found = {"fixedpipe.pipeline": pipeline.__doc__}
    for name in pipeline.__all__:
        value = getattr(pipeline, name)
        if isinstance(value, type) or inspect.isroutine(value):
            found[name] = value.__doc__
        if isinstance(value, type):
            members = {key: member for key, member in vars(value).items() if not key.startswith("_")}
            public = {k: m for k, m in members.items() if inspect.isroutine(m) or isinstance(m, property)}
            found |= {f"{name}.{key}": member.__doc__ for key, member in public.items()}
    return {name: prose(text) for name, text in found.items() if text}


def helps():
    """What every command does, in the words of its --help; options have no sentences of such a length."""
    found = {}
    for path, said in commands():
        _usage, _, rest = said.partition("\n\n")
        words_of = re.split(r"^(?:Options|Commands):$", rest, flags=re.MULTILINE)[0]
        blocks = re.split(r"\n\s*\n", words_of)
        found[path] = "\n\n".join(b for b in blocks if not re.search(r"\S {2,}\S", b.strip()))
    return found


def _written(node):
    """The text of an expression, each value in it one word; none where it is no text."""
    if isinstance(node, ast.Constant):
        return node.value if isinstance(node.value, str) else ""
    if isinstance(node, ast.JoinedStr):
        return "".join(part.value if isinstance(part, ast.Constant) else "CODE" for part in node.values)
    if isinstance(node, ast.BinOp):
        return _written(node.left) + _written(node.right)
    return ""


def refusals(source, where):
    """What the exceptions that a module raises say, by module and line."""
    found = {}
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call):
            texts = [_written(argument) for argument in node.exc.args]
            found[f"{where}:{node.lineno}"] = "\n\n".join(text for text in texts if " " in text)
    return {line: text for line, text in found.items() if text}


@pytest.mark.parametrize("path", DATA, ids=lambda path: f"{path.parent.name}-{path.stem}")
def test_captions_and_reasons_are_in_plain_english(path):
    assert faults(strings(tomllib.loads(path.read_text()))) == []


def test_the_pipeline_s_docstrings_are_in_plain_english():
    assert len(docstrings()) > 80
    assert faults(docstrings()) == []


def test_what_commands_say_of_themselves_is_in_plain_english():
    assert len(helps()) > 25
    assert faults(helps()) == []


@pytest.mark.parametrize("layer", ["raster", "pipeline", "effects"])
def test_what_exceptions_say_is_in_plain_english(layer):
    found = {}
    for path in sorted((ROOT / layer).rglob("*.py")):
        found |= refusals(path.read_text(), path.relative_to(ROOT))
    assert len(found) >= {"raster": 15, "pipeline": 500, "effects": 700}[layer]
    assert faults(found) == []


LONG = "This sentence has " + "so " * 32 + "words."  # 36 words


@pytest.mark.parametrize(
    "texts",
    [
        strings({"F": {"caption": LONG, "title": "A. B. C."}}),
        {"a docstring": prose(f"One.\n\n{LONG}\n\nA. B. C. D.")},
        {"a command": "It is told to you."},
        refusals(f"raise ValueError(f'{{x}}: {LONG} One. Two.')", "m.py"),
        refusals("raise Refusal('It ' + f'is told {x}.')", "m.py"),
    ],
)
def test_a_fault_is_seen(texts):
    assert len(faults(texts)) >= 1


def test_examples_and_columns_are_no_prose():
    text = f"One.\n\n>>> {LONG}\n\nname  {LONG}\n\n    {LONG}\n\n- two\n- three"
    assert cut(prose(text)) == ["One.", "two", "three"]
