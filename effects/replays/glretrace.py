"""Replays a trace with Mesa: glretrace, a program of apitrace, draws with llvmpipe on a display in memory.

glretrace is optional. Without it, ``missing`` returns a sentence that says how to get it.
"""

import json
import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

# Programs that are needed, and the packages of Debian that have them.
_NEEDED = {"glretrace": "apitrace", "Xvfb": "xvfb"}
# The display's pixels and bits. Assumed: no window of the time was larger.
_SCREEN = "2048x2048x24"
# Seconds after which a replay is ended. Assumed: no user waits for longer.
PATIENCE = 600.0
# The most calls that one command names; more calls take several commands.
_MOST_CALLS = 1000


class GlretraceError(Exception):
    """glretrace is missing or failed; the message says why, in a sentence."""


def missing() -> str | None:
    """A sentence that says which program is missing and how to get it; None: none is missing."""
    lacking = {name: package for name, package in _NEEDED.items() if shutil.which(name) is None}
    if not lacking:
        return None
    verb = "is" if len(lacking) == 1 else "are"
    return (
        f"{' and '.join(lacking)} {verb} not installed: on Debian, apt install {' '.join(lacking.values())}."
    )


@contextmanager
def display() -> Iterator[str]:
    """A display in memory, for instance ":7". Raises GlretraceError."""
    if (lacking := missing()) is not None:
        raise GlretraceError(lacking)
    reading, writing = os.pipe()
    command = ["Xvfb", "-displayfd", str(writing), "-screen", "0", _SCREEN, "-nolisten", "tcp"]
    server = subprocess.Popen(
        command, pass_fds=(writing,), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    os.close(writing)
    try:
        with os.fdopen(reading) as number:
            found = number.readline().strip()
        if not found:
            raise GlretraceError("Xvfb gave no display; run it alone to see why.")
        yield f":{found}"
    finally:
        server.terminate()
        server.wait()


def environment(shown: str, threads: int) -> dict[str, str]:
    """The environment variables of a program: the display ``shown``, llvmpipe, and its ``threads``."""
    return {
        **os.environ,
        "DISPLAY": shown,
        "LIBGL_ALWAYS_SOFTWARE": "1",
        "GALLIUM_DRIVER": "llvmpipe",
        "LP_NUM_THREADS": str(threads),
    }


def run(shown: str, arguments: Sequence[str], *, threads: int = 2) -> str:
    """Run glretrace on a display, and return what it printed. Raises GlretraceError."""
    command = ["glretrace", *arguments]
    try:
        ended = subprocess.run(
            command,
            env=environment(shown, threads),
            capture_output=True,
            timeout=PATIENCE,
            stdin=subprocess.DEVNULL,
        )
    except subprocess.TimeoutExpired:
        raise GlretraceError(f"glretrace did not end within {PATIENCE:.0f} seconds.") from None
    if ended.returncode:
        said = ended.stderr.decode(errors="replace").strip().splitlines()
        why = f": {said[-1]}" if said else ""
        raise GlretraceError(f"glretrace ended with status {ended.returncode}{why}.")
    return ended.stdout.decode(errors="replace")


def pictures(shown: str, path: str, calls: Iterable[int]) -> dict[int, NDArray[np.uint8]]:
    """Mesa's pictures at these calls of a trace, by the call: uint8 [h, w, 3], top row first.

    A call for which glretrace writes no picture is left out. If glretrace ends early, the pictures that it
    wrote before are returned. Raises GlretraceError if it then has none.
    """
    from PIL import Image

    asked, found, failed = sorted(set(calls)), {}, None
    with tempfile.TemporaryDirectory() as folder:
        for first in range(0, len(asked), _MOST_CALLS):
            numbers = ",".join(map(str, asked[first : first + _MOST_CALLS]))
            try:
                run(shown, ["-b", "-s", f"{folder}/", "-S", numbers, path])
            except GlretraceError as error:
                failed = error
                break
        for file in Path(folder).glob("*.png"):
            if file.stem.isdecimal():
                with suppress(OSError), Image.open(file) as picture:  # the last one may be cut off
                    found[int(file.stem)] = np.array(picture.convert("RGB"))
    if failed is not None and not found:
        raise failed
    return found


def state(shown: str, path: str, call: int) -> dict[str, Any]:
    """Mesa's whole state after a call of a trace, as ``glretrace -D`` prints it. Raises GlretraceError."""
    said = run(shown, ["-D", str(call), path])
    begin = said.find("{")
    if begin < 0:
        raise GlretraceError(f"glretrace has no state at call {call}; it may lie in a display list.")
    try:
        # A driver's strings may contain line feeds.
        return json.loads(said[begin:], strict=False)
    except ValueError as error:
        raise GlretraceError(f"The state at call {call} is no JSON: {error}.") from None
