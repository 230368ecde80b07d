"""Sweeps by Dask whose worker or scheduler is stopped: it says nothing any more, as a host that vanishes."""

import os
import signal
import subprocess
import sys
from contextlib import ExitStack, contextmanager

import pytest

from tests.effects.sweeps.test_ends import contents, files, number_found
from tests.layers import ROOT
from tests.support.waiting import until

POINTS = 12
# Its later points wait for a file, and say so by another: what is stopped then has unfinished points.
SCRIPT = """
import os
import time
from pathlib import Path

from fixedpipe.pipeline import Draw, Mesh, PassState, parse_program

profile, width, height = "GEFORCE_256", 4, 4
program = "!!RC1.0 { rgb { spare0 = col0 * col0; } } out.rgb = spare0; out.a = unsigned_invert(zero);"
squared = PassState(register_combiners=parse_program(program).combiners)
folder = Path(__file__).parent


def commands(red):
    if red > 0.2:
        (folder / f"waits-{os.getpid()}").touch()
        while not (folder / "go").exists():
            time.sleep(0.01)
    triangle = Mesh([[-1, -1], [3, -1], [-1, 3]], colors=[[red, 0.5, 0.5]] * 3)
    return [Draw(label="the colour, squared", mesh=triangle, state=squared)]
"""
# A stopped worker is lost after the first, in which a sound one has time to say that it is there; a stopped
# scheduler after the second.
TTL, UNTIL_LOST = "20s", 60.0
CLIENT = f"""
from fixedpipe.effects.cli import main
from fixedpipe.effects.tasks import cluster

if __name__ == "__main__":
    cluster.SECONDS_UNTIL_LOST = {UNTIL_LOST}
    main()
"""
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not hasattr(signal, "SIGSTOP"), reason="no process can be stopped here"),
]


@contextmanager
def begun(folder, *command):
    """A program of Dask with the processes that it begins, as a session of its own, which is killed."""
    own = {"PYTHONPATH": str(ROOT), "DASK_DISTRIBUTED__SCHEDULER__WORKER_TTL": TTL}
    process = subprocess.Popen(
        [sys.executable, "-m", *command],
        cwd=folder,
        env=os.environ | own,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    try:
        yield process
    finally:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()


@contextmanager
def cluster(folder, workers):
    """The programs of a scheduler and of so many workers, each with a nanny."""
    file = str(folder / "scheduler.json")
    with ExitStack() as held:
        options = "--scheduler-file", file, "--no-dashboard"
        bound = "--host", "127.0.0.1", "--port", "0"
        scheduler = begun(folder, "distributed.cli.dask_scheduler", *bound, *options)
        programs = [held.enter_context(scheduler)]
        until(lambda: os.path.exists(file), "a scheduler")
        for _ in range(workers):
            worker = begun(folder, "distributed.cli.dask_worker", "--nthreads", "1", *options)
            programs.append(held.enter_context(worker))
        yield programs


def sweep(folder, out, *more):
    """The command of a client."""
    (folder / "client.py").write_text(CLIENT)
    (folder / "script.py").write_text(SCRIPT)
    grid = "sweep", str(folder / "script.py"), "--vary", f"red=0:1:{POINTS}", "--no-times"
    return [sys.executable, str(folder / "client.py"), *grid, *files(out), *more]


@contextmanager
def client_at_work(folder, workers):
    """(the client's process, the programs of its cluster), when the first pictures are there, and each worker
    has a point that it does not finish.
    """
    out = folder / "by dask"
    out.mkdir()
    by = "--executor", f"dask:{folder / 'scheduler.json'}"
    with (
        cluster(folder, workers) as programs,
        subprocess.Popen(sweep(folder, out, *by), stderr=subprocess.PIPE, text=True, cwd=ROOT) as client,
    ):

        def at_work():
            assert client.poll() is None, client.stderr.read()
            return len(list(folder.glob("waits-*"))) == workers and list(out.glob("pictures/*.png"))

        try:
            until(at_work, "points at which each worker waits")
            yield client, programs
        finally:
            client.kill()


def by_one_process(folder, out):
    """What one process says that computes the same, all of it or what is missing."""
    (folder / "go").touch()
    out.mkdir(exist_ok=True)
    done = subprocess.run(sweep(folder, out), capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    return done.stderr


def test_a_worker_that_vanishes_in_the_middle_is_done_without(tmp_path):
    pytest.importorskip("distributed")
    with client_at_work(tmp_path, 2) as (client, (_, lost, _)):
        os.killpg(lost.pid, signal.SIGSTOP)
        (tmp_path / "go").touch()
        said = client.stderr.read()
    assert client.returncode == 0, said
    by_one_process(tmp_path, tmp_path / "whole")
    assert contents(tmp_path / "by dask") == contents(tmp_path / "whole")


@pytest.mark.parametrize(
    ("stopped", "said"),
    [
        (0, "has not answered for 60 s; look after its host, or begin another by dask scheduler"),
        (1, "has had no worker for 60 s; begin some by dask worker tcp://127.0.0.1:"),
    ],
    ids=["scheduler", "only worker"],
)
def test_a_client_that_is_left_alone_says_so_and_what_is_done_stays(tmp_path, stopped, said):
    pytest.importorskip("distributed")
    with client_at_work(tmp_path, 1) as (client, programs):
        os.killpg(programs[stopped].pid, signal.SIGSTOP)
        told = client.stderr.read()
    assert client.returncode == 2 and said in told, told
    assert "Traceback" not in told and "give the same command to go on from there" in told
    assert 1 <= number_found(by_one_process(tmp_path, tmp_path / "by dask")) < POINTS
    by_one_process(tmp_path, tmp_path / "whole")
    assert contents(tmp_path / "by dask") == contents(tmp_path / "whole")
