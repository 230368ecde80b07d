"""Mesa's software drivers, each in a process of its own that draws on request."""

import contextlib
import ctypes
import importlib.util
import os
import subprocess
import sys
from pathlib import Path

_ROOT = Path(__file__).resolve().parents[2]


class PeerError(Exception):
    """The peer cannot run here; the message says what is missing and how to get it."""


def missing():
    """What Mesa needs and this machine lacks, a sentence each; empty when it can be tried."""
    sentences = []
    if importlib.util.find_spec("OpenGL") is None:
        sentences.append("PyOpenGL is not installed: pip install PyOpenGL.")
    try:
        ctypes.CDLL("libEGL.so.1")
    except OSError:
        sentences.append("libEGL.so.1 is missing: on Debian, apt install libegl1 libegl-mesa0 libopengl0.")
    return sentences


def environment(threads, driver="llvmpipe"):
    """The variables that make Mesa draw on ``threads`` processor cores, without a display.

    ``driver``: llvmpipe; softpipe, which draws on one core; or zink, which draws by Vulkan.

    LP_NUM_THREADS counts the threads that llvmpipe starts beside the caller's: with 0 the caller draws, with
    more it only sets up.
    """
    return {
        "PYOPENGL_PLATFORM": "egl",
        "EGL_PLATFORM": "surfaceless",
        "LIBGL_ALWAYS_SOFTWARE": "1",
        "GALLIUM_DRIVER": driver,
        "LP_NUM_THREADS": str(threads if threads > 1 else 0),
        "MESA_SHADER_CACHE_DISABLE": "true",
    }


def own_threads():
    """On how many threads the driver draws in a process that has these variables."""
    return max(1, int(os.environ["LP_NUM_THREADS"]))


class MesaProcess:
    """A module that runs with Mesa's environment, answers once when it begins and then every request.

    A subclass names the ``module`` and says what requests and answers are: ``_send(request)`` writes one to
    ``_process.stdin``, ``_receive()`` returns the next answer, or raises EOFError where there is none, and
    ``_greet(answer)`` takes the first. It starts in ``folder``. Close it when done.

    Raises PeerError when it cannot be had, and when it stops answering.
    """

    module = None

    def __init__(self, variables, *, text, folder=None):
        lacking = missing()
        if lacking:
            raise PeerError(" ".join(lacking))
        paths = [str(_ROOT), *filter(None, [os.environ.get("PYTHONPATH")])]
        self._process = subprocess.Popen(
            [sys.executable, "-m", self.module],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=text,
            cwd=folder,
            env=os.environ | variables | {"PYTHONPATH": os.pathsep.join(paths)},
        )
        try:
            self._greet(self._answer())
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
            return self._receive()
        except EOFError:
            raise PeerError("Mesa's process ended without an answer; what it printed says why.") from None

    def _ask(self, request):
        try:
            self._send(request)
            self._process.stdin.flush()
        except BrokenPipeError:
            raise PeerError("Mesa's process has ended.") from None
        return self._answer()
