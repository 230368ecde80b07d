"""Processes as an executor. One that ends by itself fails its own call alone; none outlives the client."""

import signal
import subprocess
import sys
from concurrent.futures import wait
from concurrent.futures.process import BrokenProcessPool

import numpy as np
import pytest

from fixedpipe.effects.tasks.processes import Processes, most_held
from tests.effects.tasks import works
from tests.layers import ROOT


@pytest.fixture(params=[1, 2])
def pool(request):
    pool = Processes(request.param, threads=3)
    yield pool
    pool.shutdown(cancel_futures=True)


@pytest.mark.parametrize("end", [works.kills_itself, works.is_told_to_end])
def test_a_process_that_ends_fails_its_own_call_alone(pool, end):
    before = [pool.submit(works.squared, n) for n in range(3)]
    ended = pool.submit(end)
    after = [pool.submit(works.squared, n) for n in range(3)]
    assert [future.result()["square"] for future in before + after] == [0, 1, 4] * 2
    with pytest.raises(BrokenProcessPool):
        ended.result()


def test_errors_come_as_they_are_and_threads_are_limited(pool):
    with pytest.raises(MemoryError, match="no room"):
        pool.submit(works.fails, 2).result()
    assert pool.submit(works.threads).result() == 3


def test_a_process_that_has_held_much_gives_its_place_to_another():
    for most, processes in ((0, 3), (1 << 40, 1)):
        pool = Processes(1, most_held=most)
        pids = {pool.submit(works.holds, 1 << 20).result()[1] for _ in range(3)}
        pool.shutdown(cancel_futures=True)
        assert len(pids) == processes


def test_the_most_that_a_process_held_is_told_in_bytes():
    before = most_held()
    kept = np.ones(1 << 25)
    assert most_held() >= max(before, kept.nbytes) > 0


def test_every_process_begins_as_asked(tmp_path):
    pool = Processes(1, begin=(works.counted, 7, tmp_path))
    with pytest.raises(BrokenProcessPool):
        pool.submit(works.kills_itself).result()
    assert pool.submit(works.squared, 3).result() == {"square": 9}
    pool.shutdown(cancel_futures=True)
    assert (tmp_path / "7.txt").read_text() == "computed\n" * 2


def test_after_the_end_nothing_is_taken(pool):
    running = [pool.submit(works.squared, n) for n in range(20)]
    pool.shutdown(cancel_futures=True)
    assert not wait(running).not_done
    with pytest.raises(RuntimeError, match="have been shut down"):
        pool.submit(works.squared, 1)


CLIENT = """
import sys
from fixedpipe.effects.tasks.processes import Processes
from tests.effects.tasks import works

if __name__ == "__main__":
    pool = Processes(2)
    for future in [pool.submit(works.process_number) for _ in range(2)]:
        future.result()
    print("ready", flush=True)
    sys.stdin.read()
"""


def test_no_process_outlives_a_client_that_is_killed(tmp_path):
    script = tmp_path / "client.py"
    script.write_text(CLIENT)
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    environment = {"PYTHONPATH": str(ROOT), "PATH": ""}
    with subprocess.Popen([sys.executable, script], text=True, env=environment, **pipes) as client:
        assert client.stdout.readline() == "ready\n"
        client.send_signal(signal.SIGKILL)
        assert client.stdout.read() == ""  # the pipe ends with the last process that has it
