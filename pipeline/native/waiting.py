"""Lines that tell the user why nothing happens while kernels are compiled. This module loads no compiler."""

import multiprocessing
import sys
import time

_FIRST, _NEXT = 2.0, 10.0  # seconds until the first line, and between two lines
_WHY = (
    "fixedpipe compiles its kernels for this machine. This happens once, and takes a minute or more. "
    "`fixedpipe warmup` does it ahead."
)


def _on_stderr(line):
    """Print a line, unless another process began this one: the user watches that process."""
    if multiprocessing.parent_process() is None:
        print(line, file=sys.stderr, flush=True)


# Writes a line. pytest captures the stderr of tests, so the plug-in sets a function of its own here.
write = _on_stderr


class Lines:
    """Lines that are written while kernels are compiled; none within the first two seconds of a wait."""

    def __init__(self, now=time.monotonic):
        self._now, self._next, self._ended, self._said = now, 0.0, -_FIRST, False

    def say(self, kernel, done, needed):
        """Note that a kernel's compilation begins; ``done`` of the ``needed`` kernels are compiled."""
        now = self._now()
        if self._ended is not None and now - self._ended >= _FIRST:  # a new wait
            self._next = now + _FIRST
        self._ended = None
        if now < self._next:
            return
        self._next = now + _NEXT
        if not self._said:
            write(_WHY)
            self._said = True
        write(f"compiling kernel {done + 1} of {needed}: {kernel}")

    def end(self):
        """Note that a kernel and all that it calls are compiled."""
        self._ended = self._now()
