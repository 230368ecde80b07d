"""Figures drawn in processes of their own, each of them whole in one: the longest begin early, and what they
write is what one process alone writes.
"""

import multiprocessing
import signal
import sys
from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from pathlib import Path

import fixedpipe.effects.figures as figures
from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.reports import figure_record
from fixedpipe.effects.reports.figure_files import write_figure
from fixedpipe.pipeline.native import readiness
from fixedpipe.pipeline.native.compiling import watch_compiling
from fixedpipe.pipeline.native.threads import limit_threads

_SECONDS = 0.1  # between two looks at what the processes say


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
        # One process draws the first figure without waiting for a compiler, which is another's, and has some
        # tens of seconds to do. The portable engine tells a figure's ideal which fragments there are; the
        # vector engine draws what a figure is checked by.
        engines = ["portable", "vector"] if first.with_checks else ["portable"]
        missing = [engine for engine in engines if jobs > 1 and not readiness.is_ready(engine)]
        waiting = {pool.submit(_draw_at_once if missing else _draw, first): first}
        waiting |= {pool.submit(readiness.make_ready, engine): None for engine in missing}
        waiting |= {pool.submit(_draw, order): order for order in rest}
        while any(waiting.values()):  # not for a compiler that no figure waits for
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
            process.join(readiness.SECONDS_TO_CLEAN)
            while process.is_alive():  # ``readiness.end_with_parent`` says why once is not enough
                process.terminate()
                process.join(readiness.SECONDS_TO_CLEAN)


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
    readiness.end_with_parent()
    limit_threads(threads)
    watch_compiling(lambda kernel, *_: said.put(("compiling", kernel)), lambda: None)


def _draw_at_once(order):
    with readiness.without_waiting():
        return _draw(order)


def _draw(order):
    try:
        return order.draw(lambda text: _SAID.put(("step", text)))
    except Refusal as refusal:
        raise Refusal(f"{order.id}: {refusal}") from refusal
    except Exception as error:
        error.add_note(f"It happened while {order.id} was drawn.")
        raise
