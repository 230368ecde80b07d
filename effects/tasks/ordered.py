"""Outcomes of tasks in the tasks' order, on any workers or in this process."""

from collections import deque
from collections.abc import Iterable, Iterator
from concurrent.futures import BrokenExecutor, CancelledError

from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.tasks.executors import Workers
from fixedpipe.effects.tasks.manifest import Manifest
from fixedpipe.effects.tasks.run import finished
from fixedpipe.effects.tasks.task import Outcome, Task
from fixedpipe.effects.tasks.worker import batch

# Calls for each worker that are sent, computed, or wait for earlier ones. Each holds its result in memory.
_CALLS_OF_A_WORKER = 3
# How often a task is sent if its worker ends. Assumed: lack of memory may end a worker because of another
# process, but not three times.
_TRIES = 3


def in_order(
    tasks: Iterable[Task], workers: Workers | None = None, manifest: Manifest | None = None
) -> Iterator[Outcome]:
    """The Outcomes of tasks, in their order; each has a value.

    tasks     an iterable; a few tasks are read before their Outcomes are needed
    workers   None: this process computes the tasks, one after the other
    manifest  where finished tasks are found and stored, with their files; None: nowhere

    Raises Refusal, which names the task, if a task is refused or fails, or its worker ends three times.
    """
    pending: deque = deque()
    most = 1 if workers is None else _CALLS_OF_A_WORKER * max(workers.workers(), 1)
    try:
        for task in tasks:
            known = None if manifest is None else manifest.find(task.digest)
            pending.append((task, known, None if known or workers is None else _sent(workers, task)))
            if len(pending) >= most:
                yield _outcome(workers, manifest, *pending.popleft())
        while pending:
            yield _outcome(workers, manifest, *pending.popleft())
    finally:
        for _, _, future in pending:
            if future is not None:
                future.cancel()
        if manifest is not None:
            manifest.commit()


def _sent(workers, task):
    try:
        return workers.submit(batch, [(task.work, dict(task.parameters))])
    except RuntimeError as error:  # the executor itself has ended; BrokenExecutor is a RuntimeError
        raise Refusal(f"The executor ended before {task.said}: {error}") from error


def _outcome(workers, manifest, task, known, future):
    if known is None:
        known = batch([(task.work, task.parameters)])[0] if future is None else _came(workers, task, future)
        if manifest is not None and not known.failed:
            manifest.keep(task.digest, known)
    if known.refused:
        raise Refusal(known.refused)
    if known.failed:
        raise Refusal(f"{task.said} failed: {known.failed}")
    return known


def _came(workers, task, future):
    """The Outcome of a call. The call is sent again if its worker ends."""
    for tries in range(1, _TRIES + 1):
        try:
            (done,) = finished([future], workers.workers)
            return done.result()[0]
        except (BrokenExecutor, CancelledError) as error:
            if tries == _TRIES:
                raise Refusal(f"The worker that computed {task.said} ended, {_TRIES} times.") from error
            future = _sent(workers, task)
    return None
