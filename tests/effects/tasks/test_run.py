"""Tasks on executors: the same results anywhere, found again, and sent again where a worker ends."""

from concurrent.futures import BrokenExecutor, Executor, Future, ThreadPoolExecutor

import pytest

from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.tasks.environment import UnfitWorker
from fixedpipe.effects.tasks.manifest import Manifest
from fixedpipe.effects.tasks.processes import Processes
from fixedpipe.effects.tasks.run import MOST_IN_A_CALL, SECONDS_OF_A_CALL, run
from fixedpipe.effects.tasks.task import Outcome, Task
from tests.effects.tasks import works
from tests.effects.tasks.works import tasks_of

SQUARES = [{"square": n * n} for n in range(6)]


@pytest.fixture
def processes():
    pool = Processes(2)
    yield pool
    pool.shutdown(cancel_futures=True)


def by_task(tasks, *how, **more):
    """Outcomes in the tasks' order."""
    found = {task.digest: outcome for task, outcome in run(tasks, *how, **more)}
    return [found[task.digest] for task in tasks]


def values(outcomes):
    return [outcome.value for outcome in outcomes]


def test_any_executor_gives_the_same(processes):
    tasks = tasks_of(works.squared)
    with ThreadPoolExecutor(2) as threads:
        for executor in (None, threads, processes):
            assert values(by_task(tasks, executor, workers=lambda: 2)) == SQUARES


def test_a_digest_is_of_function_parameters_and_inputs():
    task = Task(works.squared, {"number": 2}, "two")
    assert task.digest == Task(works.squared, {"number": 2}, "in other words").digest
    others = (
        Task(works.refuses, {"number": 2}, "two"),
        Task(works.squared, {"number": 3}, "two"),
        Task(works.squared, {"number": 2}, "two", inputs="other sources"),
    )
    assert len({task.digest, *(other.digest for other in others)}) == 1 + len(others)


def test_what_is_done_is_found_again(tmp_path):
    tasks = tasks_of(works.counted, folder=str(tmp_path))
    for done in (3, 6, 6):
        with Manifest(tmp_path / "m", "squares") as manifest:
            assert values(by_task(tasks[:done], None, manifest)) == SQUARES[:done]
    assert all((tmp_path / f"{n}.txt").read_text() == "computed\n" for n in range(6))


def test_what_lacks_its_files_is_computed_again(tmp_path):
    tasks, there = tasks_of(works.with_file, 3), {"0.txt", "2.txt"}
    with Manifest(None, "squares") as manifest:
        assert [o.files for o in by_task(tasks, None, manifest)][1] == {"1.txt": b"1"}
        again = by_task(tasks, None, manifest, has_files=lambda outcome: outcome.files.keys() <= there)
    assert [outcome.files for outcome in again] == [{"0.txt": b""}, {"1.txt": b"1"}, {"2.txt": b""}]


def test_a_refusal_is_kept_and_a_failure_is_not():
    with Manifest(None, "squares") as manifest:
        refused = by_task(tasks_of(works.refuses), None, manifest)
        assert refused[2].refused == "There is no square of 2." and len(manifest) == 6
    with Manifest(None, "squares") as manifest:
        failed = by_task(tasks_of(works.fails), None, manifest)
        assert failed[2].failed.startswith("MemoryError: no room (works.py, line ") and len(manifest) == 5
        assert values(failed[:2] + failed[3:]) == SQUARES[:2] + SQUARES[3:]
        (nan,) = by_task(tasks_of(works.no_number, 1), None, manifest)
        assert nan.failed.startswith("ValueError: Out of range float values are not JSON compliant")


@pytest.mark.parametrize(("times", "failed"), [(1, ""), (99, "its worker ended 3 times (BrokenProcessPool")])
def test_a_task_whose_worker_is_killed_is_sent_again(processes, tmp_path, times, failed):
    tasks = tasks_of(works.dies, folder=str(tmp_path), times=times, of=3)
    outcomes = by_task(tasks, processes, workers=lambda: 2)
    assert values(outcomes[:3] + outcomes[4:]) == SQUARES[:3] + SQUARES[4:]
    assert outcomes[3].failed.startswith(failed) and outcomes[3].value == (None if failed else SQUARES[3])


class Told(Executor):
    """An executor that computes at once, and keeps what it was given; ``ends``: after so many calls."""

    def __init__(self, seconds=0.0, ends=None, error=None):
        self.calls, self.seconds, self.ends, self.error = [], seconds, ends, error

    def submit(self, function, work, /):
        if len(self.calls) == self.ends:
            raise BrokenExecutor("gone")
        self.calls.append(len(work))
        future = Future()
        if self.error:
            future.set_exception(self.error)
        else:
            outcomes = [Outcome(value=made(**given), seconds=self.seconds) for made, given in work]
            future.set_result(outcomes)
        return future


@pytest.mark.parametrize(
    ("seconds", "size"),
    [(2 * SECONDS_OF_A_CALL, 1), (SECONDS_OF_A_CALL / 4, 4), (0.0, MOST_IN_A_CALL)],
)
def test_short_tasks_go_together(seconds, size):
    told = Told(seconds)
    assert len(list(run(tasks_of(works.squared, 1000), told))) == 1000
    # Until one has come, nobody knows how long they take.
    assert told.calls[:2] == [1, 1] and set(told.calls[2:-1]) == {size} and sum(told.calls) == 1000


def test_calls_are_longer_where_there_are_many_workers():
    told = Told(0.25)
    assert len(list(run(tasks_of(works.squared, 9000), told, workers=lambda: 1000))) == 9000
    # As many calls as 1000 workers have at once were sent before one had come.
    assert told.calls[:2000] == [1] * 2000 and set(told.calls[2000:-1]) == {16}


def test_tasks_are_asked_for_when_they_are_needed():
    asked = []

    def endless():
        for n in range(10**12):
            asked.append(n)
            yield Task(works.squared, {"number": n}, str(n))

    for _ in zip(range(10), run(endless(), Told(2 * SECONDS_OF_A_CALL), workers=lambda: 3), strict=False):
        pass
    assert len(asked) <= 10 + 3 * 3


def test_an_executor_that_ends_is_said_and_what_is_done_stays():
    with Manifest(None, "squares") as manifest:
        with pytest.raises(Refusal, match=r"The executor ended \(BrokenExecutor: gone\).*same command"):
            list(run(tasks_of(works.squared), Told(1.0, ends=3), manifest))
        assert len(manifest) == 3


def test_an_unfit_worker_ends_the_work_by_its_name():
    with pytest.raises(UnfitWorker, match="host:7 has numba"):
        list(run(tasks_of(works.squared), Told(error=UnfitWorker("The worker host:7 has numba 1."))))


def test_where_no_worker_computes_anything_it_is_said_once():
    with pytest.raises(Refusal, match="No worker computes anything: ModuleNotFoundError: No module"):
        list(run(tasks_of(works.squared, 100), Told(error=ModuleNotFoundError("No module named 'x'"))))
