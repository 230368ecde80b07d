"""Mesa in a process of its own, which draws frames of commands on request."""

import contextlib
import os
import pickle
import subprocess
import sys
from pathlib import Path

from bench.peers.llvmpipe import PeerError, environment, missing

_ROOT = Path(__file__).resolve().parents[2]

# llvmpipe's filters then compute in single precision, not in bytes. Source: Mesa's docs/envvars.
_EXACT = {"GALLIVM_PERF": "no_filter_hacks"}


class Mesa:
    """One of Mesa's software drivers, ``softpipe`` or ``llvmpipe``; close it when done.

    Raises PeerError when it cannot be had, and when it stops answering.
    """

    def __init__(self, driver):
        lacking = missing()
        if lacking:
            raise PeerError(" ".join(lacking))
        paths = [str(_ROOT), *filter(None, [os.environ.get("PYTHONPATH")])]
        self._process = subprocess.Popen(
            [sys.executable, "-m", "tests.opengl.worker"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=os.environ | environment(1, driver) | _EXACT | {"PYTHONPATH": os.pathsep.join(paths)},
        )
        try:
            self.renderer, self.version = self._answer()
            if driver not in self.renderer:
                raise PeerError(f"Mesa draws with {self.renderer}; on Debian, libgl1-mesa-dri has {driver}.")
        except PeerError:
            self.close()
            raise

    def close(self):
        """End the process."""
        with contextlib.suppress(BrokenPipeError):  # it may have ended by itself
            self._process.stdin.close()
        self._process.wait()
        self._process.stdout.close()

    def _answer(self):
        try:
            answer = pickle.load(self._process.stdout)
        except EOFError:
            raise PeerError("Mesa's process ended without an answer; what it printed says why.") from None
        if isinstance(answer, str):
            raise PeerError(f"Mesa's process says: {answer}")
        return answer

    def draw(self, commands, width, height):
        """{"color": uint8 [h, w, 4], "depth": uint32 [h, w], "stencil": uint8 [h, w]}, top row first."""
        try:
            pickle.dump([(width, height, commands)], self._process.stdin)
            self._process.stdin.flush()
        except BrokenPipeError:
            raise PeerError("Mesa's process has ended.") from None
        return self._answer()[0]
