"""Figures drawn in processes of their own, each of them whole in one: the longest begin early, and what they
write is what one process alone writes.
"""

import multiprocessing
import os
import signal
import sys
import threading
import time
from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from pathlib import Path

import fixedpipe.effects.figures as figures
from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.reports import figure_record
from fixedpipe.effects.reports.figure_files import write_figure
from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.golden.provenance import kernels_are_cold
from fixedpipe.pipeline.native.compiling import watch_compiling
from fixedpipe.pipeline.native.threads import limit_threads
from fixedpipe.pipeline.profiles import GEFORCE_256
from fixedpipe.pipeline.state import PassState

_SECONDS = 0.1  # between two looks at what the processes say
_SECONDS_TO_CLEAN = 2  # Assumed: a file is removed in less, also where others take the processor


@dataclass(frozen=True)
class Order:
    """One figure to be drawn: its ``id``, ``machines``, ``size`` (None: its own), ``threads`` (None: one for
    each processor that no other process has), whether it is checked (``with_checks``), the ``folder`` of its
    files, and ``named``, a folder of its pictures under readable names, or None; ``inputs``: the digest of
    what it is made from.
    """

    id: str
    machines: tuple[str, ...]
    size: int | None
    threads: int | None
    with_checks: bool
    folder: Path
    named: Path | None
    inputs: str | None

    def draw(self, step, changes=None):
        """Draw it and write its files; returns its record."""
        how = self.machines, self.size, self.threads, self.with_checks, step, changes
        rendered = figure_record.render(figures.FIGURES[self.id], *how)
        step(f"{rendered.record['id']}: writing")
        return write_figure(self.folder, rendered, self.inputs, self.named, self.threads)


def draw_all(orders, jobs, threads, step, compiling):
    """Draw Orders, one or more, as they come, in ``jobs`` processes: yields (Order, its record) as each is
    done.

    threads    that each process has
    step       called with a line of text at the beginning of each step
    compiling  called with the name of each kernel that one of them compiles

    However it ends, no process is left behind, and no file that is half written. Raises what drawing raised;
    Refusal where a process ended by itself.
    """
    context, others = multiprocessing.get_context("spawn"), set(multiprocessing.active_children())
    said = context.SimpleQueue()
    pool = ProcessPoolExecutor(jobs, context, _begin, (said, threads))
    try:
        first, *rest = orders
        waiting = {pool.submit(_draw, first): first}
        if first.with_checks and kernels_are_cold():
            waiting |= {pool.submit(compile_vectors): None for _ in range(jobs - 1)}
        waiting |= {pool.submit(_draw, order): order for order in rest}
        while waiting:
            done, _ = wait(waiting, _SECONDS, FIRST_COMPLETED)
            _tell(said, step, compiling)
            for future in done:
                order = waiting.pop(future)
                try:
                    record = future.result()
                except BrokenProcessPool:
                    left = ", ".join([one.id for one in (order, *waiting.values()) if one][:jobs])
                    raise Refusal(
                        f"A process ended by itself, with {left} to be drawn: is there memory for {jobs} at "
                        "once? Give --jobs 1."
                    ) from None
                if order:
                    yield order, record
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
        ours = [process for process in multiprocessing.active_children() if process not in others]
        for process in ours:
            process.terminate()
        for process in ours:
            process.join(_SECONDS_TO_CLEAN)
            while process.is_alive():  # ``_end_after`` says why once is not enough
                process.terminate()
                process.join(_SECONDS_TO_CLEAN)


def _tell(said, step, compiling):
    while not said.empty():
        what, text = said.get()
        (step if what == "step" else compiling)(text)


# ------------------------------------------------------------------------------ in the processes that draw

_SAID = None


def _begin(said, threads):
    """A process's first call: it has so many threads, ends when it is told to or who began it has ended, and
    leaves Ctrl-C to that.
    """
    global _SAID
    _SAID = said
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # files that are being written go
    began = multiprocessing.parent_process()
    threading.Thread(target=_end_after, args=(began,), daemon=True).start()
    limit_threads(threads)
    watch_compiling(lambda kernel, *_: said.put(("compiling", kernel)), lambda: None)


def _end_after(process):
    """End this process when another has ended, however it did.

    The first signal ends what is drawn, and its half-written files go; the pool takes that for a result, and
    waits for another order that nobody gives. The second ends the waiting.
    """
    process.join()
    while True:
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(_SECONDS_TO_CLEAN)


def compile_vectors():
    """Compile the vector engine, where the cache has it not, by drawing a triangle.

    A figure is drawn by the portable engine first, which tells its ideal which fragments there are, and
    checked by the vector engine. While one process compiles the first for the first figure, another compiles
    the second for it.
    """
    triangle = Mesh([[-1, -1], [3, -1], [-1, 3]], colors=[[1, 1, 1]] * 3)
    execute((Draw(label="a triangle", mesh=triangle, state=PassState()),), GEFORCE_256, 16, 16, threads=1)


def _draw(order):
    try:
        return order.draw(lambda text: _SAID.put(("step", text)))
    except Refusal as refusal:
        raise Refusal(f"{order.id}: {refusal}") from refusal
    except Exception as error:
        error.add_note(f"It happened while {order.id} was drawn.")
        raise
