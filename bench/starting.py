"""What a user waits for: commands in processes of their own, until their files are there or they end."""

import contextlib
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

_ROOT = Path(__file__).resolve().parents[1]
_COMMAND = "fixedpipe.effects.cli"
_EVERY_FIGURE = ("figures", "--check", "--out")
_POLL_SECONDS = 0.01


def environment(**more):
    """The variables of this process with the checkout on Python's path, and ``more`` of them."""
    paths = [str(_ROOT), *filter(None, [os.environ.get("PYTHONPATH")])]
    said = os.environ | {"PYTHONPATH": os.pathsep.join(paths)} | more
    # As Python comes: a module is compiled once, not whenever it is imported.
    said.pop("PYTHONDONTWRITEBYTECODE", None)
    return said


def run_module(*arguments, **variables):
    """(seconds, standard output) of ``python -m`` with arguments; OSError if it ends with an error."""
    start = time.perf_counter()
    ended = subprocess.run(
        [sys.executable, "-m", *arguments], env=environment(**variables), capture_output=True, text=True
    )
    seconds = time.perf_counter() - start
    if ended.returncode:
        raise OSError(f"python -m {' '.join(arguments)} ended with {ended.returncode}: {ended.stderr}")
    return seconds, ended.stdout


def _figures(figure):
    return "figures", figure, "--profile", "GEFORCE_256", "--out"


def cold(figure):
    """Seconds of ``fixedpipe figures FIGURE`` until its files are there, where no kernel was compiled."""
    return first((_COMMAND, *_figures(figure)))


def cached(figure, times=5):
    """Seconds of the same command with its kernels in the cache, a list, each into an empty folder.

    Empty, as a folder that has the figure need not have it drawn again.
    """
    with tempfile.TemporaryDirectory() as folder:
        outs = [os.path.join(folder, str(number)) for number in range(times + 1)]
        return [run_module(_COMMAND, *_figures(figure), out)[0] for out in outs][1:]


def is_there(folder):
    """Whether a figure's files are in a gallery's folder: its record, which comes last, and the page."""
    return (folder / "index.html").is_file() and any(folder.glob("*.json"))


def _end(process):
    """End a process that leads a session, and all that it started: by a request, then without one."""
    for how in (signal.SIGTERM, signal.SIGKILL):
        with contextlib.suppress(ProcessLookupError):  # all have ended
            os.killpg(process.pid, how)
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(5)


def first(command=(_COMMAND, *_EVERY_FIGURE)):
    """Seconds of ``fixedpipe figures --check``, or of another command whose last word is the folder, with an
    empty kernel cache, until the first figure's files are there; then it is ended. Raises OSError if it ends
    before.
    """
    # What is just being ended may write yet.
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        out, cache, said = Path(folder, "out"), Path(folder, "cache"), Path(folder, "said")
        with said.open("w") as errors:
            start = time.perf_counter()
            process = subprocess.Popen(
                [sys.executable, "-m", *command, str(out)],
                env=environment(NUMBA_CACHE_DIR=str(cache)),
                stdout=errors,
                stderr=errors,
                start_new_session=True,
            )
            try:
                while not is_there(out):
                    if process.poll() is not None:
                        raise OSError(f"the command ended without a picture: {said.read_text()[-500:]}")
                    time.sleep(_POLL_SECONDS)
                return time.perf_counter() - start
            finally:
                _end(process)


def _processor_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def asking_for_help(times=9):
    """{"wall", "processor", "Python alone": list of seconds} of ``fixedpipe --help``, one uncounted."""
    wall, processor, alone = [], [], []
    for _ in range(times + 1):
        before = _processor_seconds()
        wall.append(run_module(_COMMAND, "--help")[0])
        processor.append(_processor_seconds() - before)
        # The shortest module that the interpreter has: it prints the zen of Python.
        alone.append(run_module("this")[0])
    return {"wall": wall[1:], "processor": processor[1:], "Python alone": alone[1:]}


def every_figure():
    """(seconds of ``fixedpipe figures --check`` with its kernels in the cache, seconds of the same again)."""
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "out")
        return tuple(run_module(_COMMAND, *_EVERY_FIGURE, out)[0] for _ in range(2))


def every_figure_cold():
    """Seconds of ``fixedpipe figures --check`` with an empty kernel cache."""
    with tempfile.TemporaryDirectory() as folder:
        cache = os.path.join(folder, "cache")
        return run_module(_COMMAND, *_EVERY_FIGURE, os.path.join(folder, "out"), NUMBA_CACHE_DIR=cache)[0]
