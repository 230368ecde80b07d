"""What draws while engines are compiled: another process compiles them, and this one draws with NumPy.

Nothing of it happens unless ``compile_beside`` or ``without_waiting`` asks for it.
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

_SECONDS = 0.1  # between two looks at what a process tells
SECONDS_TO_CLEAN = 2  # Assumed: a file is removed in less, also where others take the processor
_never_waits = False


def _portable():
    from fixedpipe.raster.portable.draw import draw_bands

    return count_bins, fill_bins, sort_triangles, draw_bands


def _vector():
    from fixedpipe.raster.vector.frame import draw_frame, fill_clear, fill_draw

    return sort_triangles, fill_clear, fill_draw, draw_frame


# Each compiled engine's kernels that Python calls, the one that needs most last.
_KERNELS = {"portable": _portable, "vector": _vector}


def is_ready(engine):
    """Whether an engine, "portable" or "vector", draws without a compiler."""
    return _KERNELS[engine]()[-1].is_ready()


def make_ready(engine):
    """Compile an engine, where the cache has it not."""
    for kernel in _KERNELS[engine]():
        kernel.make_ready()


def chosen_engine(engine):
    """Which of ``fixedpipe.pipeline.execution.machine.ENGINES`` draws a frame for which ``engine`` was asked:
    another than that one only where this process does not wait for a compiler. The bits are the same.
    """
    if not _never_waits or engine == "columns":
        return engine
    if engine is None and is_ready("vector"):
        return None
    return "portable" if is_ready("portable") else "columns"


def covers_by_kernels():
    """Whether coverage is a kernel's."""
    return not _never_waits or is_ready("portable")


@contextmanager
def without_waiting():
    """Inside, what would wait for a compiler is drawn by the column engine, except what it cannot cover."""
    global _never_waits
    before, _never_waits = _never_waits, True
    try:
        yield
    finally:
        _never_waits = before


def compile_beside(engine):
    """Where ``engine`` is not ready, let a process of its own compile it and then the other, and draw without
    them meanwhile.

    Returns what to wait for, or None where nothing is compiled: with one processor it would only take this
    one's time. The process ends when this one does; which kernels it has compiled by then stay compiled.
    """
    global _never_waits
    if is_ready(engine) or default_threads() == 1:
        return None
    engines = sorted(_KERNELS, key=lambda name: name != engine)
    context = multiprocessing.get_context("spawn")
    try:
        told = context.SimpleQueue()
        process = context.Process(target=_compile, args=(engines, told), daemon=True)
        process.start()
    except OSError:  # no more processes, or no locks between them: this one compiles
        return None
    _never_waits = True
    return Compiling(process, told)


@dataclass(frozen=True)
class Compiling:
    """A process that compiles, and what it tells."""

    process: BaseProcess
    told: SimpleQueue

    def wait(self, say: Say):
        """Wait for the engine that was asked for; ``say``, as ``watch_compiling`` has it, is called as each
        kernel begins.
        """
        while self.process.is_alive() or not self.told.empty():
            if self.told.empty():
                time.sleep(_SECONDS)
            elif (line := self.told.get()) is None:
                return
            else:
                say(*line)


def _compile(engines, told):
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for who began it, and ends with that
    end_with_parent()
    watch_compiling(lambda *line: told.put(line), lambda: None)
    for engine in engines:
        make_ready(engine)
        told.put(None)


def end_with_parent():
    """From now on this process is told to end when the one that began it has ended, however that did.

    The first signal ends what a process of a pool draws, and its half-written files go; the pool takes that
    for a result, and waits for another order that nobody gives. The second ends the waiting.
    """
    began = multiprocessing.parent_process()
    threading.Thread(target=_end_after, args=(began,), daemon=True).start()


def _end_after(process):
    process.join()
    while True:
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(SECONDS_TO_CLEAN)
