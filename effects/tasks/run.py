"""Send tasks to an executor, and yield their Outcomes. Stored tasks are found, lost ones are sent again."""

from collections import Counter, deque
from collections.abc import Callable, Collection, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, CancelledError, Executor, Future, wait

from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.tasks.environment import UnfitWorker
from fixedpipe.effects.tasks.manifest import Manifest
from fixedpipe.effects.tasks.task import Outcome, Task
from fixedpipe.effects.tasks.worker import batch

# The tasks of one call take about this long together. So the cost of the call itself is small beside them
# (docs/scale.md says what a call costs).
SECONDS_OF_A_CALL = 0.5
# They take at least this long for each worker, so that one client can feed many workers. Assumed: a call
# costs the client 2 ms with a scheduler (0.25 ms without, Measured); then the client is busy half the time.
SECONDS_FOR_A_WORKER = 0.004
MOST_IN_A_CALL = 256
# Calls for each worker: it computes one, and one waits, so the worker always has work.
_CALLS_OF_A_WORKER = 2
# How often a task is sent if its worker ends; and how many lost tasks, before any Outcome, end the run.
# Assumed: lack of memory may end a worker because of another process, but not three times.
_TRIES, _LOST_AT_FIRST = 3, 10
SECONDS_BETWEEN_LOOKS = 2.0  # at workers, while none of them answers


def finished(calls: Collection[Future], workers: Callable[[], int]) -> set[Future]:
    """Wait until some of these calls are finished, and return those. Without calls, return none.

    workers  is called now and then; it raises if no worker is left to finish them
    """
    while calls:
        done, _ = wait(calls, SECONDS_BETWEEN_LOOKS, FIRST_COMPLETED)
        if done:
            return done
        workers()
    return set()


def run(
    tasks: Iterable[Task],
    executor: Executor | None = None,
    manifest: Manifest | None = None,
    *,
    workers: Callable[[], int] = lambda: 1,
    has_files: Callable[[Outcome], bool] = lambda outcome: True,
) -> Iterator[tuple[Task, Outcome]]:
    """Compute tasks, and yield (task, Outcome) for each when it is finished.

    tasks      an iterable; it is read as tasks are needed, a few ahead
    executor   any ``concurrent.futures.Executor``; None: this process computes them, one after the other
    manifest   where finished tasks are found and stored; None: nowhere
    workers    returns how many workers the executor has now; raises Refusal if they are lost for good
    has_files  whether the files that a found Outcome names still exist; otherwise the task is computed again

    If a task fails, its Outcome says why, and is not stored. If a worker ends, its tasks are sent again.
    Raises Refusal if the executor ends or the manifest cannot be written, and UnfitWorker if a worker has
    other versions or bits. Finished tasks stay in the manifest.
    """
    found = deque[tuple[Task, Outcome]]()

    def missing():
        for task in tasks:
            known = None if manifest is None else manifest.find(task.digest)
            if known is not None and has_files(known):
                found.append((task, known))
                yield None  # so that found tasks are yielded before the wait for others
            else:
                yield task

    computed = _here(missing()) if executor is None else _Sent(executor, workers).outcomes(missing())
    for came in computed:
        while found:
            yield found.popleft()
        if came is not None:
            task, outcome = came
            if manifest is not None and not outcome.failed:
                manifest.keep(task.digest, outcome)
            yield task, outcome
    yield from found
    if manifest is not None:
        manifest.commit()


def _here(tasks):
    for task in tasks:
        yield task and (task, *batch([(task.work, task.parameters)]))


class _Sent:
    """The calls that an executor has got and not answered yet."""

    def __init__(self, executor, workers):
        self.executor, self.workers = executor, workers
        self.calls = {}  # future -> its tasks
        self.again = deque()  # tasks whose call was lost
        self.lost = Counter()  # by digest
        self.came, self.seconds = 0, 0.0
        self.broken = None  # the exception of an executor that takes no more calls

    def outcomes(self, tasks):
        """Yield (task, Outcome) when each task is finished, and None wherever ``tasks`` has None."""
        waiting, ended = [], False
        try:
            while waiting or self.again or self.calls or not ended:
                while not self.broken and len(self.calls) < _CALLS_OF_A_WORKER * max(self.workers(), 1):
                    if self.again:
                        self._send([self.again.popleft()])
                        continue
                    while not ended and len(waiting) < self._size():
                        try:
                            task = next(tasks)
                        except StopIteration:
                            ended = True
                            break
                        if task is None:
                            yield None
                        else:
                            waiting.append(task)
                    if not waiting:
                        break
                    self._send(waiting)
                    waiting = []
                if self.broken and not self.calls:  # all its answers have been yielded
                    raise _ended(self.broken) from self.broken
                for future in finished(self.calls, self.workers):
                    yield from self._answered(future, self.calls.pop(future))
            if self.broken:
                raise _ended(self.broken) from self.broken
        finally:
            for future in self.calls:
                future.cancel()

    def _size(self):
        """How many tasks the next call has."""
        if not self.came:
            return 1
        seconds = max(SECONDS_OF_A_CALL, SECONDS_FOR_A_WORKER * self.workers())
        return max(1, min(MOST_IN_A_CALL, int(seconds * self.came / max(self.seconds, 1e-9))))

    def _send(self, tasks):
        work = [(task.work, dict(task.parameters)) for task in tasks]
        try:
            future = self.executor.submit(batch, work)
        except RuntimeError as error:  # BrokenExecutor is one, too
            self.broken = error
            return
        self.calls[future] = tasks

    def _answered(self, future, tasks):
        try:
            outcomes = future.result()
        except UnfitWorker:
            raise
        except CancelledError as error:
            self.broken = self.broken or error
            return
        except Exception as error:
            yield from self._lost(tasks, error)
            return
        for task, outcome in zip(tasks, outcomes, strict=True):
            self.came, self.seconds = self.came + 1, self.seconds + outcome.seconds
            yield task, outcome

    def _lost(self, tasks, error):
        """Send the tasks of a call without an answer again, or yield that they failed."""
        said = f"{type(error).__name__}: {error}"
        if not self.came and self.lost.total() >= _LOST_AT_FIRST:
            raise Refusal(f"No worker computes anything: {said}") from error
        for task in tasks:
            self.lost[task.digest] += 1
            if self.lost[task.digest] < _TRIES:
                self.again.append(task)
            else:
                yield task, Outcome(failed=f"its worker ended {_TRIES} times ({said})")


def _ended(error):
    said = f"{type(error).__name__}: {error}".rstrip(": ")
    return Refusal(
        f"The executor ended ({said}). What was finished is kept; give the same command to go on from there."
    )
