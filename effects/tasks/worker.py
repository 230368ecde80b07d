"""The functions that run in a worker. Its first call prepares the process; every call computes tasks."""

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
    """The host and the number of this process. By them a worker knows whether it is the client itself."""
    return socket.gethostname(), getpid()


def at_worker(client, environment, threads, function, arguments, keywords):
    """Prepare this worker if it is not the client itself, and call a function in it.

    client       ``process()`` of the client, whose own process needs no preparation
    environment  ``environment()`` of the client
    threads      how many threads each call may use

    Raises UnfitWorker if the worker has other versions or other bits, and the function's own exceptions.
    """
    if process() != client:
        _prepare(environment, threads)
    return function(*arguments, **keywords)


def _prepare(environment, threads):
    """Compare versions. The first call in a process also compiles missing kernels and draws the self-test.

    All workers of a host may begin at once. A kernel's lock lets one of them compile it; the others then read
    it from the cache (``fixedpipe.raster.kernel``).
    """
    global _prepared
    check_environment(environment)  # every time: a worker may run longer than its first client
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
    """Prepare this worker. Returns why it does not compute as the client does, in a sentence, or ""."""
    try:
        _prepare(environment, threads)
    except UnfitWorker as error:
        return str(error)
    return ""


def batch(tasks):
    """An Outcome for each of (function, parameters), in their order. A task's exception becomes part of its
    Outcome.
    """
    return [_outcome(function, parameters) for function, parameters in tasks]


def _outcome(function, parameters):
    begun = time.perf_counter()

    def after(**what):
        return Outcome(seconds=time.perf_counter() - begun, worker=name_of_worker(), **what)

    try:
        found = function(**parameters)
        value, files = found if isinstance(found, tuple) else (found, {})
        canonical(value)  # a value that JSON cannot hold is an error of the function
    except Refusal as refusal:
        return after(refused=str(refusal))
    except Exception as error:
        last = traceback.extract_tb(error.__traceback__)[-1]
        where = f"{last.filename.rpartition('/')[2]}, line {last.lineno}"
        return after(failed=f"{type(error).__name__}: {error} ({where})")
    return after(value=value, files=files)
