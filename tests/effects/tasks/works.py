"""What tests let workers do: functions at the top of a module, so that a worker finds them by name."""

import os
import signal
from pathlib import Path

from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.tasks.task import Task
from fixedpipe.pipeline.native.threads import default_threads


def squared(number):
    return {"square": number * number}


def counted(number, folder):
    """A square, and a line more in a file for each time that it is computed."""
    with open(Path(folder) / f"{number}.txt", "a") as file:
        file.write("computed\n")
    return {"square": number * number}


def counted_with_file(number, folder):
    """As ``counted``, and a file."""
    return counted(number, folder), {"n": str(number).encode()}


def dies(number, folder, times, of):
    """A square; the number ``of`` ends its process, the first ``times`` times."""
    mark = Path(folder) / "deaths.txt"
    before = mark.read_text() if mark.exists() else ""
    if number == of and len(before) < times:
        mark.write_text(before + "+")
        os.kill(os.getpid(), signal.SIGKILL)
    return {"square": number * number}


def refuses(number):
    if number == 2:
        raise Refusal("There is no square of 2.")
    return {"square": number * number}


def fails(number):
    if number == 2:
        raise MemoryError("no room")
    return {"square": number * number}


def no_number(number):
    return {"square": float("nan")}


def with_file(number):
    return {"square": number * number}, {f"{number}.txt": str(number).encode()}


def process_number():
    return os.getpid()


def threads():
    return default_threads()


def kills_itself():
    os.kill(os.getpid(), signal.SIGKILL)


def is_told_to_end():
    os.kill(os.getpid(), signal.SIGTERM)


def holds(size):
    return len(bytes(size)), os.getpid()


def tasks_of(work, count=6, **more):
    return [Task(work, {"number": n, **more}, f"the square of {n}") for n in range(count)]
