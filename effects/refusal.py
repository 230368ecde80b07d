"""Refusals: each is one sentence that says why something cannot be done, and what to do instead."""

import difflib
import traceback
from collections.abc import Iterable
from contextlib import contextmanager


class Refusal(ValueError):  # noqa: N818 (it names what happens)
    """A request cannot be carried out; the message is one sentence that says why and what to do."""


def line_of(path: str, error: BaseException) -> str:
    """A script's line that raised an error or its cause, with the words that introduce it in a sentence;
    empty if no line of the script did.
    """
    lines: list[int] = []
    cause: BaseException | None = error
    while cause is not None:
        walked = traceback.walk_tb(cause.__traceback__)
        lines += [line for frame, line in walked if frame.f_code.co_filename == path]
        if isinstance(cause, SyntaxError) and cause.filename == path and cause.lineno:
            lines.append(cause.lineno)
        cause = cause.__cause__
    return f", line {lines[-1]}," if lines else ""


@contextmanager
def refusals():
    """Turn a ValueError, which carries a sentence, into a Refusal."""
    try:
        yield
    except ValueError as error:
        raise Refusal(str(error)) from error


def nearest(name: str, known: Iterable[str]) -> str:
    """A question for the name that was probably meant, with a blank before it; empty if no name is near."""
    as_written = {key.casefold(): key for key in known}
    close = difflib.get_close_matches(name.casefold(), as_written, 1, 0.6)
    return f" Did you mean {as_written[close[0]]}?" if close else ""


# Names that a refusal lists. Of more it says which one was probably meant, or how many there are.
_LISTED = 30


def no_such(what: str, name: object, known: Iterable[str]) -> str:
    """A sentence that there is no such name, with the probable name or else all names."""
    known = list(known)
    meant, listed = nearest(str(name), known), ", ".join(known)
    if len(known) > _LISTED:
        listed = f"{', '.join(known[:3])} and {len(known) - 3} more"
    there = "" if meant and len(known) > _LISTED else f" There are: {listed}."
    return f"There is no {what} {name!r}.{meant}{there}"


def choose(what, name, known):
    """``known[name]``, or a Refusal with the probable name or else all names."""
    if name in known:
        return known[name]
    raise Refusal(no_such(what, name, known))


class NoSuchName(KeyError):  # noqa: N818 (it names what happens)
    """A mapping lacks a name; the message is a sentence."""

    def __str__(self):
        return str(self.args[0])
