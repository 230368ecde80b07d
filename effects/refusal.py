"""Refusals: each is one sentence that says why something cannot be done, and what to do instead."""

import difflib
from collections.abc import Iterable
from contextlib import contextmanager


class Refusal(ValueError):  # noqa: N818 (it names what happens)
    """What was asked for cannot be done; the message is one sentence that says why and what to do."""


@contextmanager
def refusals():
    """Turn a ValueError, which carries a sentence, into a Refusal."""
    try:
        yield
    except ValueError as error:
        raise Refusal(str(error)) from error


def nearest(name: str, known: Iterable[str]) -> str:
    """A question for the name that was probably meant, with a blank before it; empty where none is near."""
    as_written = {key.casefold(): key for key in known}
    close = difflib.get_close_matches(name.casefold(), as_written, 1, 0.6)
    return f" Did you mean {as_written[close[0]]}?" if close else ""


def choose(what, name, known):
    """``known[name]``, or a Refusal that names what there is and what was probably meant."""
    if name in known:
        return known[name]
    raise Refusal(f"There is no {what} {name!r}.{nearest(name, known)} There are: {', '.join(known)}.")
