"""The failures of a figure and their reasons, in the words of its record, its card and the command line."""

import errno
import traceback

from fixedpipe.effects.refusal import Refusal, line_of
from fixedpipe.pipeline.profiles import PROFILES

_FULL = (errno.ENOSPC, errno.EDQUOT)


def failure(error, machine=None, task="drawn", file=None):
    """An exception as a record stores it.

    profile, name  the machine's; None: all of the figure's machines
    task           the task that failed, "drawn" or "checked"
    what           the failure in a sentence
    trace          the failure in Python's words; None: the sentence says all
    file           the user's file with the figure, whose line the sentence names; None: a figure of the
                   package

    The record also says whether the disc is full.
    """
    is_said = isinstance(error, Refusal)
    what = str(error) if is_said else f"{type(error).__name__}: {error}".rstrip(": ")
    if file is not None and (line := line_of(file, error)):
        what = f"{file}{line.rstrip(',')}: {what}" if is_said else f"{file}{line} raised {what}"
    return {
        "profile": machine,
        "name": None if machine is None else PROFILES[machine].name,
        "task": task,
        "what": what,
        "trace": None if is_said else "".join(traceback.format_exception(error)),
        "full_disc": _is_of_a_full_disc(error),
    }


def _is_of_a_full_disc(error):
    while error is not None:
        if isinstance(error, OSError) and error.errno in _FULL:
            return True
        error = error.__cause__ or error.__context__
    return False


def failures_of(record):
    """A record's failures; one of an earlier version has none."""
    return record.get("failures", [])


def in_words(record):
    """A record's failures as its figure's card has them, one sentence for all machines with the same."""
    machines = {}
    for failed in failures_of(record):
        machines.setdefault((failed["task"], failed["what"]), []).append(failed["name"])
    found = []
    for (task, what), names in machines.items():
        where = f" on the {', '.join(names)}" if all(names) else ""
        found.append(f"Not {task}{where}: {what}")
    return found
