"""Hand tasks to an executor, and take what comes. Finished tasks are found again, lost ones sent again."""

from collections import Counter, deque
from collections.abc import Callable, Collection, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, CancelledError, Executor, Future, wait

from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.tasks.environment import UnfitWorker
from fixedpipe.effects.tasks.manifest import Manifest
from fixedpipe.effects.tasks.task import Outcome, Task
from fixedpipe.effects.tasks.worker import batch

# A call to a worker has as many tasks as take this long, so that what a call costs does not count
# (docs/scale.md has what it costs).
SECONDS_OF_A_CALL = 0.5
# And as long as this for each worker, so that one client keeps many of them at work. Assumed: a call costs
# the client 2 ms where a scheduler is between (0.25 ms without, Measured); then it works half of the time.
SECONDS_FOR_A_WORKER = 0.004
MOST_IN_A_CALL = 256
# Calls for each worker, one that it computes and one that waits, so that it never has nothing to do.
_CALLS_OF_A_WORKER = 2
# How often a task is sent whose worker ends, and how many are lost, none having come, until the executor is
# given up. Assumed: memory may end a worker because of a neighbour, but not three times.
_TRIES, _LOST_AT_FIRST = 3, 10
SECONDS_BETWEEN_LOOKS = 2.0  # at workers, while none of them answers


def finished(calls: Collection[Future], workers: Callable[[], int]) -> set[Future]:
    """Wait until some of these calls are finished, and return those; none if there are no calls.

    workers  is called now and then: it raises where nobody is left who could finish them
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
    """Compute tasks; yields (task, Outcome) of each as it comes.

    tasks      asked for one after the other, a few more than are being computed
    executor   any ``concurrent.futures.Executor``; None: here, one after the other
    manifest   where finished tasks are found and kept; None: nowhere
    workers    says how many the executor has now; raises Refusal where it has lost them for good
    has_files  whether the files that a found Outcome names are still there; else the task is computed again

    A task that fails has an Outcome that says why, and is not kept. A task whose worker ended is sent again.
    Raises Refusal where the executor ends, or the manifest cannot be written, and UnfitWorker for a worker
    with other versions or bits. What was finished stays in the manifest.
    """
    found = deque[tuple[Task, Outcome]]()

    def missing():
        for task in tasks:
            known = None if manifest is None else manifest.find(task.digest)
            if known is not None and has_files(known):
                found.append((task, known))
                yield None  # so that what is found is told before others are waited for
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
    """The calls that an executor has been given, and has not answered."""

    def __init__(self, executor, workers):
        self.executor, self.workers = executor, workers
        self.calls = {}  # future -> its tasks
        self.again = deque()  # tasks whose call was lost
        self.lost = Counter()  # by digest
        self.came, self.seconds = 0, 0.0
        self.broken = None  # what the executor raised when it took no call any more

    def outcomes(self, tasks):
        """(task, Outcome) as they come, and None wherever ``tasks`` has it."""
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
                if self.broken and not self.calls:  # all that it still answered is told
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
        except RuntimeError as error:  # a BrokenExecutor, too
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
        """What is done with tasks whose call gave no answer."""
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
