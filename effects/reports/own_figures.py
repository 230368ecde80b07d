"""Figures that users keep in files of their own, outside the package."""

import hashlib
import re
import sys
from functools import cache
from pathlib import Path
from types import ModuleType

from fixedpipe.effects import figures
from fixedpipe.effects.figures import Figure
from fixedpipe.effects.refusal import Refusal, choose, line_of

KIND = ".py"
# Names of files are made of ids; a + there begins what was changed of a variant.
_ID = re.compile(r"\w[\w-]{0,59}")


def figure_of(word):
    """The Figure of an id, or of a user's file: what commands take as ID|FILE.py. Raises Refusal."""
    return own_figure(word) if word.endswith(KIND) else choose("figure", word, figures.FIGURES)


@cache
def own_figure(path):
    """The Figure that a file holds under the name ``FIGURE``; the file is run once in a process.

    path  as a str; the file may import modules beside it

    Raises Refusal, with the file and if possible the line, for a file that cannot be read or run, or that
    holds no ``FIGURE``; also for an id that the package already has or that cannot name a file.
    """
    try:
        source = Path(path).read_bytes()
    except OSError as error:
        raise Refusal(f"{path} cannot be read: {error.strerror}.") from None
    where = Path(path).resolve()
    module = ModuleType(f"own_figure_{hashlib.sha256(str(where).encode()).hexdigest()[:16]}")
    module.__file__ = str(where)
    sys.modules[module.__name__] = module  # dataclasses look there for the names of their fields' types
    if str(where.parent) not in sys.path:
        sys.path.append(str(where.parent))  # last, so that it hides no package
    try:
        exec(compile(source, path, "exec"), module.__dict__)
    except (Exception, SystemExit) as error:
        raise Refusal(f"{path}{line_of(path, error)} raised {type(error).__name__}: {error}") from error
    figure = getattr(module, "FIGURE", None)
    if not isinstance(figure, Figure):
        held = "no FIGURE" if figure is None else f"FIGURE = {figure!r}, which is no Figure"
        raise Refusal(f"{path} holds {held}. End it with FIGURE = Figure(id=..., ...).")
    if not (isinstance(figure.id, str) and _ID.fullmatch(figure.id)):
        raise Refusal(
            f"{path}: the id {figure.id!r} names no file. Give up to 60 letters, digits, _ and -, as X01."
        )
    if figure.id.casefold() in {known.casefold() for known in figures.FIGURES}:
        raise Refusal(f"{path}: the package has a figure {figure.id} already. Give FIGURE another id.")
    return figure
