"""Pages on the names that users import, by topic, and on every command: what their own docstrings say."""

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[2]
# A row of the table in the docstring of fixedpipe.pipeline: a topic, and names with words between them.
_ROW = re.compile(r"^  (?P<topic>\S.*?|  \S.*?)  +(?P<words>\S.*)$")


def topics(docstring, names):
    """The names by topic, as a docstring's table has them: {topic: [name, ...]}, each name once."""
    left, found, topic = set(names), {}, None
    for line in docstring.split("\n\n")[2].splitlines():
        row = _ROW.match(line)
        topic = row["topic"].strip() if row and not line.startswith("     ") else topic
        for name in re.findall(r"\w+", line):
            if name in left:
                left.remove(name)
                found.setdefault(topic, []).append(name)
    return found, left


def _directive(module, name):
    """How Sphinx documents a name of a module."""
    value = getattr(module, name)
    full = f"{module.__name__}.{name}"
    if isinstance(value, type):
        kind = "autoexception" if issubclass(value, BaseException) else "autoclass"
        return f".. {kind}:: {full}\n   :members:\n"
    if callable(value):
        return f".. autofunction:: {full}\n"
    said = getattr(value, "name", "") or "See the module's words above."
    return f".. py:data:: {full}\n\n   {said}\n"


def _reference(words):
    """reStructuredText in a Markdown page."""
    return f"````````{{eval-rst}}\n{words}````````\n"


def _pipeline():
    """The page of fixedpipe.pipeline."""
    import fixedpipe.pipeline as pipeline

    found, left = topics(pipeline.__doc__, pipeline.__all__)
    if left:
        raise ValueError(f"The table in fixedpipe.pipeline's docstring lacks {', '.join(sorted(left))}.")
    example = pipeline.__doc__.split("\n\n", 3)[3]
    parts = [
        "# fixedpipe.pipeline\n\nAfter this page you know every name that `fixedpipe.pipeline` has, and what "
        "each takes, gives and raises.\n\n## By example\n\n",
        _reference(example.strip() + "\n\n"),
    ]
    for topic, names in found.items():
        words = "".join(_directive(pipeline, name) + "\n" for name in names)
        parts.append(f"\n## {topic[0].upper()}{topic[1:]}\n\n{_reference(words)}")
    return "".join(parts)


def modules():
    """The other modules that users call: those whose types `make check` looks at."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["mypy"]
    return [each for each in settings["modules"] if each != "fixedpipe.pipeline"]


def _of_the_pipeline(module):
    """The names of a module that the page of fixedpipe.pipeline documents."""
    import fixedpipe.pipeline as pipeline

    homes = {each: getattr(getattr(pipeline, each), "__module__", "") for each in pipeline.__all__}
    return [each for each, home in homes.items() if home == module]


def _module(name):
    """The page of a module."""
    words = f".. automodule:: {name}\n   :members:\n"
    if elsewhere := _of_the_pipeline(name):
        words += f"   :exclude-members: {', '.join(elsewhere)}\n"
    return f"# {name}\n\n{_reference(words)}"


def commands():
    """Every command's --help: [(words of the command line, help), ...]."""
    import click

    from fixedpipe.effects.cli import main

    found = []

    def walk(command, context):
        found.append((context.command_path, command.get_help(context)))
        if isinstance(command, click.Group):
            for name in command.list_commands(context):
                under = command.get_command(context, name)
                walk(under, click.Context(under, context, name))

    walk(main, click.Context(main, info_name="fixedpipe", terminal_width=90, max_content_width=90))
    return found


_COMMANDS = """\
# Commands

After this page you know every command of `fixedpipe`, as its `--help` says it.

"""
_INDEX = """\
# Names and commands

After this page you can find the module, the function or the command that you need.

- [fixedpipe.pipeline](fixedpipe.pipeline.md): frames, states, machines
- [commands](commands.md): every `--help`

The other modules that users and writers of effects call:

"""


def written():
    """The pages, by their path in the site."""
    made = {"api/fixedpipe.pipeline.md": _pipeline()} | {
        f"api/{each}.md": _module(each) for each in modules()
    }
    helps = [f"## {path}\n\n```text\n{said}\n```\n" for path, said in commands()]
    made["api/commands.md"] = _COMMANDS + "\n".join(helps)
    made["api/index.md"] = _INDEX + "".join(f"- [{each}]({each}.md)\n" for each in modules())
    return made
