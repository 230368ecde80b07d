"""Results of calls in the calls' order, whoever computes them."""

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import BrokenExecutor, CancelledError
from typing import Any

from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.tasks.executors import Workers

# Calls for each worker that are sent, computed, or wait for those before them: each holds its result.
_CALLS_OF_A_WORKER = 3
# How often a call is sent whose worker ends. Assumed: memory may end a worker because of a neighbour, but
# not three times.
_TRIES = 3


def in_order(
    workers: Workers,
    function: Callable[..., Any],
    calls: Iterable[tuple[Any, ...]],
    said: Callable[..., str] = lambda *arguments: ", ".join(map(str, arguments)),
) -> Iterator[Any]:
    """The results of ``function(*arguments)`` for each of ``calls``, in their order.

    A function at the top of a module, and arguments, that can be pickled. ``calls`` are asked for a few ahead
    of the results that were taken. ``said``: what a call is called in a Refusal.

    Raises what the function raises, and Refusal for a call whose worker ended three times.
    """
    pending: deque = deque()
    try:
        for arguments in calls:
            pending.append((arguments, workers.submit(function, *arguments)))
            if len(pending) >= _CALLS_OF_A_WORKER * max(workers.workers(), 1):
                yield _result(workers, function, *pending.popleft(), said)
        while pending:
            yield _result(workers, function, *pending.popleft(), said)
    finally:
        for _, future in pending:
            future.cancel()


def _result(workers, function, arguments, future, said):
    for _ in range(_TRIES - 1):
        try:
            return future.result()
        except (BrokenExecutor, CancelledError):
            try:
                future = workers.submit(function, *arguments)
            except RuntimeError as error:  # the executor itself has ended
                raise Refusal(f"The executor ended while it computed {said(*arguments)}: {error}") from error
    try:
        return future.result()
    except (BrokenExecutor, CancelledError) as error:
        raise Refusal(f"The worker that computed {said(*arguments)} ended, {_TRIES} times.") from error
