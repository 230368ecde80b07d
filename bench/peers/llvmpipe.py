"""Mesa's llvmpipe, in a process of its own that draws when it is its turn."""

import contextlib
import ctypes
import importlib.util
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

_ROOT = Path(__file__).resolve().parents[2]


class PeerError(Exception):
    """The peer cannot run here; the message says what is missing and how to get it."""


def missing():
    """What llvmpipe needs and this machine lacks, a sentence each; empty when it can be tried."""
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

    ``driver``: llvmpipe, or softpipe, which draws on one core.

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


class Llvmpipe:
    """The peer as a party to a measurement; close it, or use it in a ``with`` statement.

    Raises PeerError when it cannot be had, and when it stops answering.
    """

    name = "llvmpipe"

    def __init__(self, threads):
        lacking = missing()
        if lacking:
            raise PeerError(" ".join(lacking))
        paths = [str(_ROOT), *filter(None, [os.environ.get("PYTHONPATH")])]
        self._process = subprocess.Popen(
            [sys.executable, "-m", "bench.peers.opengl_worker"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env=os.environ | environment(threads) | {"PYTHONPATH": os.pathsep.join(paths)},
        )
        try:
            hello = self._answer()
            if "llvmpipe" not in hello["renderer"]:
                raise PeerError(
                    f"Mesa drew with {hello['renderer']}; on Debian, libgl1-mesa-dri has llvmpipe."
                )
        except PeerError:
            self.close()
            raise
        self.description = f"{hello['renderer']}, {hello['version']}"

    def __enter__(self):
        """Return the peer itself."""
        return self

    def __exit__(self, *_):
        """End the process."""
        self.close()

    def close(self):
        """End the process."""
        with contextlib.suppress(BrokenPipeError):  # it may have ended by itself
            self._process.stdin.close()
        self._process.wait()
        self._process.stdout.close()

    def _answer(self):
        line = self._process.stdout.readline()
        if not line:
            raise PeerError("Mesa's process ended without an answer; what it printed says why.")
        answer = json.loads(line)
        if "error" in answer:
            raise PeerError(f"Mesa's process says: {answer['error']}")
        return answer

    def _ask(self, **request):
        try:
            print(json.dumps(request), file=self._process.stdin, flush=True)
        except BrokenPipeError:
            raise PeerError("Mesa's process has ended.") from None
        return self._answer()

    def prepare(self, scene, size):
        """Make ``scene`` at ``size`` x ``size`` pixels the one that is drawn, with its textures in place."""
        self._ask(do="prepare", scene=scene.name, size=size)

    def turn(self, frames):
        """Seconds that ``frames`` measured frames took."""
        return self._ask(do="turn", frames=frames)["seconds"]

    def picture(self):
        """{"color": uint8 [h, w, 4], "depth": uint32 [h, w], "stencil": uint8 [h, w]}, top row first."""
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "picture.npz")
            self._ask(do="picture", file=file)
            with np.load(file) as arrays:
                return dict(arrays)
