"""Figures drawn in several processes, each figure whole in one. The longest begin early.

The files are those that one process alone would write.
"""

import multiprocessing
import time
from collections import deque
from concurrent.futures import FIRST_COMPLETED, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

import fixedpipe.effects.figures as figures
from fixedpipe.effects.computed_once import kept_in
from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.reports import figure_record
from fixedpipe.effects.reports.figure_failures import failure, failures_of
from fixedpipe.effects.reports.figure_files import write_figure, write_record
from fixedpipe.effects.reports.figure_inputs import inputs_of
from fixedpipe.effects.reports.own_figures import own_figure
from fixedpipe.effects.reports.plates import Plates
from fixedpipe.effects.tasks.processes import Processes
from fixedpipe.pipeline.native import background_compiling
from fixedpipe.pipeline.native.compiling import watch_compiling

_SECONDS = 0.1  # between two looks at what the processes say


@dataclass(frozen=True)
class Order:
    """One figure to be drawn.

    id, machines  the figure, and the machines that draw it
    size          a panel's height; None: the figure's own
    threads       None: one for each processor that no other process has
    with_checks   whether it is checked
    folder        the folder of its files
    named         Plates for its pictures under readable names, or None
    inputs        the digest of its inputs
    file          the user's file with the figure; None: the package's
    is_first      whether it is of the first round: a picture on one machine, without references and checks
    results       the folder of results that several runs share, or None
    """

    id: str
    machines: tuple[str, ...]
    size: int | None
    threads: int | None
    with_checks: bool
    folder: Path
    named: Plates | None
    inputs: str | None
    file: str | None = None
    is_first: bool = False
    results: Path | None = None

    def first(self):
        """The Order of the first round: the picture on the first machine alone.

        None if the order needs nothing else, or if the figure is a user's.
        """
        figure = self.figure
        if self.file or not (self.with_checks or len(self.machines) > 1 or figure.reference):
            return None
        machines = self.machines[:1]
        inputs = inputs_of(figures.FIGURES.module_of(self.id), (self.id, machines, self.size, "first"))
        return replace(self, machines=machines, with_checks=False, named=None, inputs=inputs, is_first=True)

    @property
    def figure(self):
        """The Figure, of the package or of a user's file; raises Refusal if that cannot be read."""
        return figures.FIGURES[self.id] if self.file is None else own_figure(self.file)

    def draw(self, step, changes=None):
        """Draw it and write its files; returns its record. What goes wrong is among the record's failures."""
        how = self.machines, self.size, self.threads, self.with_checks, step, changes, self.file
        try:
            asked = {"with_references": not self.is_first, "with_names": self.named is not None}
            with kept_in(self.results):
                rendered = figure_record.render(self.figure, *how, **asked)
            step(f"{rendered.record['id']}: writing")
            return write_figure(self.folder, rendered, self.inputs, self.named, self.threads)
        except Exception as error:
            return self.failed(error, changes)

    def failed(self, error, changes=None):
        """The record of a figure for which nothing was drawn because of ``error``. It is written
        if possible.
        """
        figure = self.figure
        how = self.machines, self.size or figure.size, changes or {}, self.with_checks
        record = figure_record.record_of(figure, *how, [], [failure(error, file=self.file)], self.file)
        with suppress(Refusal):
            write_record(self.folder, record)
        return record


def draw_here(orders, step, changes):
    """Draw Orders in this process, as ``draw_all`` does in others. ``changes``: of ``Order.draw``, by id."""
    for order in orders:
        record, seconds = _timed(order, step, changes[order.id])
        yield order, record, seconds
        if _is_disc_full(record):
            return


def draw_all(orders, jobs, threads, step, compiling):
    """Draw one or more Orders, as they come, in ``jobs`` processes. Yields (Order, its record, its seconds of
    processor time) as each is finished.

    threads    that each process has
    step       called with a line of text at the beginning of each step
    compiling  called with the name of each kernel that one of them compiles

    A figure of two Orders is drawn by one process at a time, since both write the same files.

    What goes wrong with a figure is in its record: an error, or a process that ended by itself, which another
    replaces. Once the disc is full no other figure is begun. However it ends, no process is left behind, and
    no file that is half written.
    """
    said = multiprocessing.get_context("spawn").SimpleQueue()
    pool = Processes(jobs, threads, begin=(_begin, said))
    waiting, working = _tasks(orders, jobs), {}  # of each call the Order; None: a compiler's
    try:
        while waiting or any(working.values()):  # not for a compiler alone
            # No call waits in the pool: which is next depends on the figures that are being drawn.
            while len(working) < jobs and (task := _next(waiting, _drawn_now(working))):
                function, argument, order = task
                working[pool.submit(function, argument)] = order
            done, _ = wait(working, _SECONDS, FIRST_COMPLETED)
            _tell(said, step, compiling)
            for future in done:
                order = working.pop(future)
                try:
                    drawn = future.result()
                except BrokenProcessPool:  # killed, or told to end
                    drawn = order and (order.failed(_ended(order, jobs)), 0.0)
                except Exception as error:  # a compiler's: who needs its kernel fails in its own name
                    drawn = order and (order.failed(error), 0.0)
                if order:
                    yield order, *drawn
                    if _is_disc_full(drawn[0]):
                        waiting.clear()
    finally:
        pool.shutdown(cancel_futures=True)


def _drawn_now(working):
    return {order.id for order in working.values() if order}


def _tasks(orders, jobs):
    """What processes are to do, in order: (function, its argument, the Order or None)."""
    first, *rest = orders
    # One process draws the first figure without waiting for a compiler, which is another's, and has some
    # tens of seconds to do. The vector engine draws most, the portable engine what that does not cover.
    engines = ("vector", "portable")
    missing = [engine for engine in engines if jobs > 1 and not background_compiling.is_ready(engine)]
    tasks = deque([(_draw_at_once if missing else _draw, first, first)])
    tasks.extend((background_compiling.make_ready, engine, None) for engine in missing)
    tasks.extend((_draw, order, order) for order in rest)
    return tasks


def _next(waiting, busy):
    """Take the first of the waiting tasks whose figure, if it has one, is not among ``busy``; None: there is
    none.
    """
    for place, task in enumerate(waiting):
        if task[2] is None or task[2].id not in busy:
            del waiting[place]
            return task
    return None


def _timed(order, step, changes=None):
    """An Order's record, and the seconds of a processor that it took."""
    begun = time.process_time()
    record = order.draw(step, changes)
    return record, time.process_time() - begun


def _is_disc_full(record):
    return any(one["full_disc"] for one in failures_of(record))


def _ended(order, jobs):
    return Refusal(
        f"The process that drew it ended by itself, as one does that the system ends because memory is short "
        f"(there were {jobs}). Draw it alone: fixedpipe figures {order.id} --jobs 1."
    )


def _tell(said, step, compiling):
    while not said.empty():
        what, text = said.get()
        (step if what == "step" else compiling)(text)


# ------------------------------------------------------------------------------ in the processes that draw

_SAID = None


def _begin(said):
    """The first call in a process: what it says goes to the client."""
    global _SAID
    _SAID = said
    watch_compiling(lambda kernel, *_: said.put(("compiling", kernel)), lambda: None)


def _draw_at_once(order):
    with background_compiling.without_waiting():
        return _draw(order)


def _draw(order):
    """An Order's record, and the seconds of a processor that it took."""
    return _timed(order, lambda text: _SAID.put(("step", text)))
