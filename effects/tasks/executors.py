"""The executors that a command line names. Their workers are checked before they compute."""

import logging
import re
from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from contextlib import ExitStack, contextmanager
from pathlib import Path

from fixedpipe.effects.refusal import Refusal, no_such
from fixedpipe.effects.tasks.cluster import Cluster, closed
from fixedpipe.effects.tasks.environment import UnfitWorker, environment
from fixedpipe.effects.tasks.processes import Processes
from fixedpipe.effects.tasks.run import SECONDS_BETWEEN_LOOKS
from fixedpipe.effects.tasks.worker import at_worker, process, unfit
from fixedpipe.pipeline.native.threads import default_threads

# What a command line may name, in words.
WRITTEN = "processes[:N], dask:local[:N], dask:tcp://HOST:PORT, dask:FILE.json, mpi or loky[:N]"
# Assumed: a larger number of processes on one computer is a typing error.
_MOST_PROCESSES = 1024
_SECONDS_TO_ANSWER = 15  # of a scheduler, and of its first worker's arrival


class Workers(Executor):
    """An executor whose workers are prepared and checked before their first call (``worker.at_worker``).

    inner    the executor
    workers  a function that returns how many workers it has now
    threads  how many threads each call may use
    """

    def __init__(self, inner: Executor, workers: Callable[[], int], threads: int = 1):
        self.inner, self.workers, self.threads = inner, workers, threads
        self._client, self._environment = process(), environment()

    def submit(self, function, /, *arguments, **keywords):
        """As ``Executor.submit``."""
        checked = self._client, self._environment, self.threads
        return self.inner.submit(at_worker, *checked, function, arguments, keywords)

    def shutdown(self, wait=True, *, cancel_futures=False):
        """As ``Executor.shutdown``."""
        # Dask's executor does not take ``cancel_futures``.
        self.inner.shutdown(wait=wait, **({"cancel_futures": True} if cancel_futures else {}))


def of_user(executor: Executor, workers: int | None = None) -> Workers:
    """A user's own executor with checked workers.

    workers  how many workers it has; None: the threads of Dask's cluster; or ``_max_workers``, an attribute
             of the executors of Python's library, loky and mpi4py; or one for each processor
    """
    if isinstance(executor, Workers):
        return executor
    if type(executor).__module__.partition(".")[0] == "distributed" and not workers:
        # A user's cluster may have its workers in a queue for hours.
        own = executor._client, executor._kwargs.get("workers"), 1
        return _of_dask(*own, waits_for_workers=True)
    count = workers or getattr(executor, "_max_workers", None) or default_threads()
    return Workers(executor, lambda: count)


@contextmanager
def opened(text: str | None, threads: int | None = None, say=print) -> Iterator[Workers | None]:
    """The executor that ``text`` names, while the block runs; None if ``text`` is None.

    text     one of WRITTEN
    threads  how many threads each call may use; None: as many as together give each processor of this
             computer one. With mpi or a given scheduler of Dask, whose workers are elsewhere, it means one.
    say      called with a sentence, for instance about a worker that is left out

    Raises Refusal for another text, for a library that is not installed, and for a scheduler that cannot be
    reached.
    """
    if text is None:
        yield None
        return
    kind, _, rest = text.partition(":")
    if kind not in _KINDS:
        raise Refusal(f"{no_such('executor', text, _KINDS)} Give {WRITTEN}.")
    with ExitStack() as held:
        yield _KINDS[kind](held, rest, threads, say)


def _count(kind, text):
    """The N in the text of a kind of executor, or None if the text is empty. Raises Refusal."""
    if not text:
        return None
    if not (text.isdecimal() and 1 <= int(text) <= _MOST_PROCESSES):
        raise Refusal(
            f"{kind}:{text} does not say how many; give {kind}:N with N from 1 to {_MOST_PROCESSES}."
        )
    return int(text)


def _share(count, threads):
    """How many threads each of ``count`` processes of this computer has."""
    return threads or max(1, default_threads() // count)


def _missing(library, extra):
    return Refusal(
        f"This executor needs {library}, which is not installed: pip install 'fixedpipe[{extra}]' brings it."
    )


def _processes(held, text, threads, say):
    count = _count("processes", text) or default_threads()
    pool = Processes(count, _share(count, threads))
    held.callback(pool.shutdown, cancel_futures=True)
    return Workers(pool, lambda: count, _share(count, threads))


def _loky(held, text, threads, say):
    try:
        from loky import ProcessPoolExecutor
    except ImportError as error:
        raise Refusal(
            "This executor needs loky, which is not installed: pip install loky brings it."
        ) from error
    count = _count("loky", text) or default_threads()
    pool = ProcessPoolExecutor(count)
    held.callback(pool.shutdown, kill_workers=True)
    return Workers(pool, lambda: count, _share(count, threads))


def _mpi(held, text, threads, say):
    try:
        from mpi4py import MPI
        from mpi4py.futures import MPIPoolExecutor
    except (ImportError, RuntimeError) as error:  # there is no MPI library
        raise _missing("mpi4py and an MPI library", "mpi") from error
    if text:
        raise Refusal(
            f"mpi:{text} is no executor; give --executor mpi, and the number of processes to mpiexec."
        )
    ranks = MPI.COMM_WORLD.Get_size()
    if ranks < 2:
        raise Refusal(
            "--executor mpi needs ranks that work; begin the command by "
            "mpiexec -n 3 python -m mpi4py.futures -m fixedpipe.effects.cli, for two."
        )
    pool = held.enter_context(MPIPoolExecutor())
    return Workers(pool, lambda: ranks - 1, threads or 1)


def _dask(held, text, threads, say):
    try:
        import dask
        import distributed
    except ImportError as error:
        raise _missing("distributed", "dask") from error
    # If the end of a worker matters, fixedpipe prints a sentence of its own about it.
    for name in ("distributed", "distributed.nanny", "distributed.scheduler", "distributed.core"):
        logging.getLogger(name).setLevel(logging.CRITICAL)
    # Workers often join or leave while calls run. Every call may be repeated.
    held.enter_context(dask.config.set({"distributed.scheduler.allowed-failures": _LOST_WORKERS}))
    kind, _, rest = text.partition(":")
    if kind == "local":
        count = _count("dask:local", rest) or default_threads()
        address = held.enter_context(
            distributed.LocalCluster(
                n_workers=count,
                threads_per_worker=1,
                processes=True,
                dashboard_address=None,
                # Its web server takes any free port, because another cluster may use the usual one.
                scheduler_kwargs={"dashboard_address": "127.0.0.1:0"},
            )
        )
        threads = _share(count, threads)
    elif Path(text).suffix == ".json" and not Path(text).is_file():
        raise Refusal(f"There is no scheduler file {text}; dask scheduler --scheduler-file {text} writes it.")
    elif Path(text).suffix != ".json" and not _ADDRESS.fullmatch(text):
        raise Refusal(
            f"dask:{text} is no scheduler; give dask:local, dask:tcp://HOST:PORT or dask:FILE.json."
        )
    else:
        address = text
    asked = {"scheduler_file": text} if Path(text).suffix == ".json" else {"address": address}
    try:
        client = distributed.Client(**asked, timeout=_SECONDS_TO_ANSWER, set_as_default=False)
        held.callback(closed, client)
        client.wait_for_workers(1, timeout=_SECONDS_TO_ANSWER)
    except TimeoutError as error:
        raise Refusal(f"The scheduler at {text} has no worker; begin some by dask worker {text}.") from error
    except (OSError, ValueError, KeyError) as error:
        raise Refusal(
            f"No scheduler of dask answers at {text} ({type(error).__name__}: {error}); begin one by "
            "dask scheduler, and give the address that it prints."
        ) from error
    threads = threads or 1
    fit = _fit(client, threads, say)
    found = _of_dask(client, fit, threads, waits_for_workers=False)
    held.callback(found.shutdown, wait=False)
    return found


def _of_dask(client, among, threads, *, waits_for_workers):
    """A Dask client's Workers. ``among``: the addresses of the workers that may compute; None: all."""
    # With pure=False, Dask computes a lost call again when it is sent again, and reuses no earlier result.
    pool = client.get_executor(pure=False, **({} if among is None else {"workers": among}))
    return Workers(pool, Cluster(client, among, waits_for_workers=waits_for_workers), threads)


_LOST_WORKERS = 3  # how many workers may end during one call before Dask gives up the call
_ADDRESS = re.compile(r"(tcp|tls|ws|wss)://[^/]+:\d{1,5}")


def _fit(client, threads, say):
    """The addresses of the workers that compute as this client does; None: all. ``say`` gets a sentence about
    each of the others, which are left out. Raises UnfitWorker if no worker is left.
    """
    cluster = Cluster(client)
    there = cluster.known()
    # The check runs in a thread of each worker. It may compile kernels there, and the worker still answers.
    asked = {
        address: client.submit(unfit, environment(), threads, workers=[address], pure=False)
        for address in there
    }
    left_out = {address: said for address, call in asked.items() if (said := _said(cluster, address, call))}
    for address, said in left_out.items():
        say(f"{address} is left out. {said}")
    if len(left_out) == len(there):
        raise UnfitWorker("No worker is left: each has other versions or other bits than this client.")
    return [address for address in there if address not in left_out] if left_out else None


def _said(cluster, address, call):
    while True:
        try:
            error = call.exception(timeout=SECONDS_BETWEEN_LOOKS)
        except TimeoutError:  # the worker compiles, or it has ended and the call would wait for ever
            if address not in cluster.known():
                call.cancel()
                return ""  # another worker may replace it
        else:  # an error means that the worker has no fixedpipe, or another Python
            return call.result() if error is None else f"{type(error).__name__}: {error}"


_KINDS = {"processes": _processes, "dask": _dask, "mpi": _mpi, "loky": _loky}
