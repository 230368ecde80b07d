"""Checks whether a worker computes the client's bits: versions, sources, and the self-test."""

import hashlib
import os
import platform
import socket
from functools import cache
from importlib import metadata
from pathlib import Path

from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.tasks.task import canonical

# Packages whose version could change a result.
_PACKAGES = ("numpy", "scipy", "numba", "llvmlite", "pillow")
_ROOT = Path(__file__).parents[2]
_LAYERS = ("raster", "pipeline", "effects")


class UnfitWorker(Refusal):
    """A worker has other versions or other bits than the client; the message names it."""


@cache
def environment():
    """A dict of str, by name: the versions of Python and of packages in this process, and a digest of the
    sources of fixedpipe. Results may depend on each of these.
    """
    found = {"Python": ".".join(platform.python_version_tuple()[:2])}
    for name in _PACKAGES:
        found[name] = metadata.version(name)
    sources = hashlib.sha256()
    for layer in _LAYERS:
        for path in sorted((_ROOT / layer).rglob("*"), key=Path.as_posix):
            if path.is_file() and path.suffix != ".pyc":
                sources.update(path.relative_to(_ROOT).as_posix().encode())
                sources.update(hashlib.sha256(path.read_bytes()).digest())
    found["the sources of fixedpipe"] = sources.hexdigest()[:16]
    return found


def whole_inputs(*more):
    """The ``Task.inputs`` of work that may import any module of fixedpipe: the environment, and ``more``,
    values that JSON can hold.
    """
    return canonical([environment(), *more]).decode()


_LONGEST_NAME = 4096  # bytes. Source: PATH_MAX of Linux, limits.h


def file_digests(texts):
    """The digests of the files that some of the texts name. Results depend on them. Raises OSError."""
    return [file_digest(text) for text in texts if len(text) < _LONGEST_NAME and Path(text).is_file()]


def file_digest(path):
    """SHA-256 of a file's bytes. Raises OSError."""
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()


def name_of_worker():
    """The name of this process in errors and rows: "HOST:PROCESS"."""
    return f"{socket.gethostname()}:{os.getpid()}"


def check_environment(client, own=None):
    """Compare the client's environment with this worker's (``own``; None: this process's). Raises
    UnfitWorker, which names the worker and the first thing that differs.
    """
    own = environment() if own is None else own
    for name, version in client.items():
        if own.get(name) != version:
            raise UnfitWorker(
                f"The worker {name_of_worker()} has {name} {own.get(name, 'none')}, and this client "
                f"{version}; results could differ. Install the same there, or leave the worker out."
            )


def check_bits():
    """Draw the quick self-test. Raises UnfitWorker, which names the worker, where a frame has other bits."""
    from fixedpipe.pipeline.selftest.quick import failures

    found = failures()
    if found:
        raise UnfitWorker(
            f"The worker {name_of_worker()} draws other bits than those accepted; leave it out. "
            f"`fixedpipe selftest` there says more. {found[0]}"
        )
