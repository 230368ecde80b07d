"""Processes of this computer as an executor. If one of them ends by itself, only its own call fails."""

import multiprocessing
import signal
import sys
import threading
from collections import deque
from collections.abc import Callable
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from functools import partial

from fixedpipe.pipeline.native import background_compiling
from fixedpipe.pipeline.native.threads import limit_threads

try:
    import resource
except ImportError:  # the system does not have this module
    resource = None

# Most bytes that a process may have used at once. Beyond it a new process replaces it, because a process
# does not return freed memory to the system.
# Measured: the figure F000-5 needs 2.0 GB and leaves 1.5; after a dozen figures a process had 4.5.
MOST_HELD = 1 << 30


class Processes(Executor):
    """``count`` processes, each in a pool of its own. So the call that a process ended with is known.

    threads    how many threads each call may use
    most_held  most bytes that a process may have used at once; beyond that a new process replaces it
    begin      a function and its arguments: what each process calls before its first call

    A call whose process ended raises BrokenProcessPool, and a new process replaces the old one. The processes
    ignore Ctrl-C; the client handles it. They end when the client ends, for whatever reason.
    """

    def __init__(
        self,
        count: int,
        threads: int = 1,
        most_held: int = MOST_HELD,
        begin: tuple[Callable[..., object], *tuple[object, ...]] | None = None,
    ):
        self.count, self._most_held = count, most_held
        self._begun_by = threads, begin
        self._context = multiprocessing.get_context("spawn")  # a forked process would lack our threads
        self._others = set(multiprocessing.active_children())
        self._lock = threading.RLock()
        self._waiting: deque = deque()
        self._ended = False
        self._free = [self._new() for _ in range(count)]

    def submit(self, function, /, *arguments, **keywords):
        """As ``Executor.submit``: calls begin in the order in which they are submitted."""
        future: Future = Future()
        with self._lock:
            if self._ended:
                raise RuntimeError("These processes have been shut down.")
            self._waiting.append((future, (function, arguments, keywords)))
            self._hand_out()
        return future

    def shutdown(self, wait=True, *, cancel_futures=False):
        """As ``Executor.shutdown``; with ``cancel_futures`` running computations are stopped, too."""
        with self._lock:
            self._ended = True
            if cancel_futures:
                for future, _ in self._waiting:
                    future.cancel()
                    future.set_running_or_notify_cancel()  # ends a ``wait`` for this future
                self._waiting.clear()
            free = list(self._free)
        for pool in free:
            pool.shutdown(wait=False)
        if cancel_futures:
            self._stop()

    def _stop(self):
        ours = [process for process in multiprocessing.active_children() if process not in self._others]
        for process in ours:
            process.terminate()
        for process in ours:
            process.join(background_compiling.SECONDS_TO_CLEAN)
            while process.is_alive():  # ``background_compiling.end_with_parent`` says why once is not enough
                process.terminate()
                process.join(background_compiling.SECONDS_TO_CLEAN)

    def _new(self):
        return ProcessPoolExecutor(1, self._context, _begin, self._begun_by)

    def _hand_out(self):
        while self._free and self._waiting:
            future, call = self._waiting.popleft()
            if not future.set_running_or_notify_cancel():
                continue
            pool = self._free.pop()
            with background_compiling.interrupts_kept():  # a pool's first call begins its process
                try:
                    inner = pool.submit(_call, *call)
                except BrokenProcessPool:  # the process ended while it had nothing to do
                    pool = self._new()
                    inner = pool.submit(_call, *call)
            inner.add_done_callback(partial(self._came, pool, future))

    def _came(self, pool, future, inner):
        """Handle the end of a call. A thread of the call's pool runs this."""
        error = inner.exception()
        value, held = (None, 0) if error else inner.result()
        if isinstance(error, BrokenProcessPool | SystemExit):  # killed, or ended by a signal
            error = BrokenProcessPool("The process that computed it ended by itself.")
            held = self._most_held + 1
        with self._lock:
            if held > self._most_held:
                pool.shutdown(wait=False)
                pool = self._new()
            self._free.append(pool)
            if self._ended and not self._waiting:
                pool.shutdown(wait=False)
            self._hand_out()
        if error:
            future.set_exception(error)
        else:
            future.set_result(value)


# ------------------------------------------------------------------------------------------ in the processes


def _begin(threads, begin):
    """Prepare a process before its first call. The process ends at a SIGTERM, or after its parent's end."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # so half-written files are removed
    # Inside a compiler's callback SystemExit is ignored and printed; the next signal ends the process.
    sys.unraisablehook = _print_but_ends
    background_compiling.end_with_parent()
    limit_threads(threads)
    if begin:
        function, *arguments = begin
        function(*arguments)


def _print_but_ends(unraisable):
    if not issubclass(unraisable.exc_type, SystemExit):
        sys.__unraisablehook__(unraisable)


def _call(function, arguments, keywords):
    """A function's result, and the most bytes that this process has used."""
    return function(*arguments, **keywords), most_held()


def most_held():
    """The most bytes that this process has used; 0 if the system does not say."""
    if resource is None:
        return 0
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)
