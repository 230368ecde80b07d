"""Refusals: each is one sentence that says why something cannot be done, and what to do instead."""

import difflib
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


def choose(what, name, known):
    """``known[name]``, or a Refusal that names what there is and what was probably meant."""
    if name in known:
        return known[name]
    as_written = {key.casefold(): key for key in known}
    close = [as_written[key] for key in difflib.get_close_matches(name.casefold(), as_written, 1, 0.6)]
    meant = f" Did you mean {close[0]}?" if close else ""
    raise Refusal(f"There is no {what} {name!r}.{meant} There are: {', '.join(known)}.")
