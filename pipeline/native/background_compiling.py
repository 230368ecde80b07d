"""Drawing while engines compile: another process compiles them, and this one draws with NumPy.

Only ``compile_beside`` and ``without_waiting`` begin this.
"""

import multiprocessing
import os
import signal
import threading
import time
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing.process import BaseProcess
from multiprocessing.queues import SimpleQueue

from fixedpipe.pipeline.native.compiling import Say, watch_compiling
from fixedpipe.pipeline.native.threads import default_threads
from fixedpipe.raster.primitives.bins import count_bins, fill_bins, sort_triangles

_SECONDS = 0.1  # between two looks for messages
SECONDS_TO_CLEAN = 2  # Assumed: removing a file takes less, also on busy processors
_never_waits = False


def _portable():
    from fixedpipe.raster.portable.draw import draw_bands

    return count_bins, fill_bins, sort_triangles, draw_bands


def _vector():
    from fixedpipe.raster.vector.frame import draw_frame, fill_clear, fill_draw

    return sort_triangles, fill_clear, fill_draw, draw_frame


# Each compiled engine's kernels that Python calls; the last one needs most.
_KERNELS = {"portable": _portable, "vector": _vector}


def is_ready(engine):
    """Whether an engine, "portable" or "vector", draws without a compiler."""
    return _KERNELS[engine]()[-1].is_ready()


def make_ready(engine):
    """Compile an engine that the cache lacks."""
    for kernel in _KERNELS[engine]():
        kernel.make_ready()


def chosen_engine(engine):
    """The engine that draws a frame for which ``engine`` was given.

    Both are in ``fixedpipe.pipeline.execution.machine.ENGINES``. They differ only if this process does not
    wait for a compiler. The bits are the same.
    """
    if not _never_waits or engine == "columns":
        return engine
    if engine is None and is_ready("vector"):
        return None
    return "portable" if is_ready("portable") else "columns"


def covers_by_kernels():
    """Whether a kernel computes coverage."""
    return not _never_waits or is_ready("portable")


@contextmanager
def without_waiting():
    """Inside, the column engine draws what would wait for a compiler, except what it cannot cover."""
    global _never_waits
    before, _never_waits = _never_waits, True
    try:
        yield
    finally:
        _never_waits = before


@contextmanager
def interrupts_kept():
    """Ctrl-C reaches no process that starts inside this context; its parent has to end it."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def compile_beside(engine):
    """Compile an engine that is not ready, and then the other, in another process; draw meanwhile.

    Returns the Compiling to wait for, or None where nothing is compiled: with one processor it would only
    take this process's time. The process ends when this one does. Kernels that it has compiled by then stay
    compiled.
    """
    global _never_waits
    if is_ready(engine) or default_threads() == 1:
        return None
    engines = sorted(_KERNELS, key=lambda name: name != engine)
    context = multiprocessing.get_context("spawn")
    try:
        told = context.SimpleQueue()
        process = context.Process(target=_compile, args=(engines, told), daemon=True)
        with interrupts_kept():
            process.start()
    except OSError:  # No more processes, or no locks between them, are available: this one compiles.
        return None
    _never_waits = True
    return Compiling(process, told)


@dataclass(frozen=True)
class Compiling:
    """A process that compiles, and the queue of its messages."""

    process: BaseProcess
    told: SimpleQueue

    def wait(self, say: Say):
        """Wait for the requested engine; ``say`` is called before each kernel, as in ``watch_compiling``."""
        while self.process.is_alive() or not self.told.empty():
            if self.told.empty():
                time.sleep(_SECONDS)
            elif (line := self.told.get()) is None:
                return
            else:
                say(*line)


def _compile(engines, told):
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the parent, which ends this
    end_with_parent()
    watch_compiling(lambda *line: told.put(line), lambda: None)
    for engine in engines:
        make_ready(engine)
        told.put(None)


def end_with_parent():
    """From now on, signal this process to end when its parent has ended, for any reason.

    The first signal stops a pool's process in its drawing, and removes its half-written files. The pool takes
    that for a result, and waits for an order that never comes. The second signal ends this wait.
    """
    began = multiprocessing.parent_process()
    threading.Thread(target=_end_after, args=(began,), daemon=True).start()


def _end_after(process):
    process.join()
    while True:
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(SECONDS_TO_CLEAN)
