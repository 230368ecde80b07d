"""What runs in a worker: its first call prepares the process, and every call computes a batch of tasks."""

import socket
import threading
import time
import traceback
from os import getpid

from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.tasks.environment import (
    UnfitWorker,
    check_bits,
    check_environment,
    name_of_worker,
)
from fixedpipe.effects.tasks.task import Outcome, canonical

_prepared = False
_lock = threading.Lock()  # a worker may have several threads


def process():
    """The host and the number of this process, by which a worker knows that it is the client itself."""
    return socket.gethostname(), getpid()


def at_worker(client, environment, threads, function, arguments, keywords):
    """Call a function in a worker that was prepared.

    client       ``process()`` of the client, whose own process needs no preparation
    environment  ``environment()`` of the client
    threads      how many threads each call may use

    Raises UnfitWorker where the worker has other versions or other bits, and what the function raises.
    """
    if process() != client:
        _prepare(environment, threads)
    return function(*arguments, **keywords)


def _prepare(environment, threads):
    """Compare versions, and once in a process compile what the cache lacks, and draw the self-test.

    All workers of a host may begin at once: a kernel's lock lets one of them compile it, and the others read
    it then from the cache (``fixedpipe.raster.kernel``).
    """
    global _prepared
    check_environment(environment)  # of each client: a worker may outlive its first
    with _lock:
        if _prepared:
            return
        from fixedpipe.pipeline.native.background_compiling import make_ready
        from fixedpipe.pipeline.native.compiling import watch_compiling
        from fixedpipe.pipeline.native.threads import limit_threads

        limit_threads(threads)
        watch_compiling(lambda *_: None, lambda: None)
        for engine in ("vector", "portable"):
            make_ready(engine)
        check_bits()
        _prepared = True


def unfit(environment, threads):
    """Prepare this worker: the sentence that says why it does not compute as the client does, or ""."""
    try:
        _prepare(environment, threads)
    except UnfitWorker as error:
        return str(error)
    return ""


def batch(tasks):
    """An Outcome for each of (function, parameters), in their order. What a task raises is its Outcome's."""
    return [_outcome(function, parameters) for function, parameters in tasks]


def _outcome(function, parameters):
    begun = time.perf_counter()

    def after(**what):
        return Outcome(seconds=time.perf_counter() - begun, worker=name_of_worker(), **what)

    try:
        found = function(**parameters)
        value, files = found if isinstance(found, tuple) else (found, {})
        canonical(value)  # what JSON cannot hold is the function's fault
    except Refusal as refusal:
        return after(refused=str(refusal))
    except Exception as error:
        last = traceback.extract_tb(error.__traceback__)[-1]
        where = f"{last.filename.rpartition('/')[2]}, line {last.lineno}"
        return after(failed=f"{type(error).__name__}: {error} ({where})")
    return after(value=value, files=files)
