"""Work in pieces: stopped anywhere it goes on, and its bytes are the same however it was done."""

import json
import os
import signal
import subprocess
import sys
from concurrent.futures import BrokenExecutor, Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context

import numpy as np
import pytest

from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.scattering import long_work

PARAMETERS = {"seed": 7, "size": [4, 3]}
TASKS = list(range(6))


def squares(task):
    return np.full((4, 3), float(task * task) / 3.0)


def files(folder):
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


def done_in(folder, **more):
    return long_work.run(TASKS, squares, folder=folder, parameters=PARAMETERS, **more)


@pytest.fixture
def whole(tmp_path):
    done_in(tmp_path / "whole")
    return files(tmp_path / "whole")


class Breaks(Executor):
    """Does so many tasks, then raises: in the task, or when it is asked for one."""

    def __init__(self, count, *, on_submit=False):
        self.left, self.on_submit = count, on_submit

    def submit(self, work, *arguments):
        future = Future()
        if self.left == 0 and self.on_submit:
            raise RuntimeError("no more workers")
        if self.left == 0:
            future.set_exception(RuntimeError("the worker died"))
        else:
            self.left -= 1
            future.set_result(work(*arguments))
        return future


def test_pieces_come_in_the_tasks_order_and_nothing_is_written_without_a_folder(tmp_path):
    found = long_work.run(TASKS, squares)
    assert [piece[0, 0] for piece in found] == [task * task / 3.0 for task in TASKS]
    assert list(tmp_path.iterdir()) == []


def test_threads_and_processes_write_the_same_bytes(tmp_path, whole):
    with ThreadPoolExecutor(3) as threads:
        done_in(tmp_path / "threads", executor=threads)
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as processes:
        found = done_in(tmp_path / "processes", executor=processes)
    assert files(tmp_path / "threads") == files(tmp_path / "processes") == whole
    assert np.array_equal(found, long_work.run(TASKS, squares))


@pytest.mark.parametrize("on_submit", [False, True], ids=["in a task", "for a task"])
@pytest.mark.parametrize("count", [0, 1, 4])
def test_what_was_stopped_goes_on_where_it_was(tmp_path, whole, count, on_submit):
    with pytest.raises(RuntimeError):
        done_in(tmp_path / "f", executor=Breaks(count, on_submit=on_submit))
    # What an executor finished before it refused another task was never handed over.
    assert len(list((tmp_path / "f").glob("piece-*"))) == (0 if on_submit else count)
    asked, done = [], []

    def counted(task):
        asked.append(task)
        return squares(task)

    long_work.run(TASKS, counted, folder=tmp_path / "f", parameters=PARAMETERS, progress=done.append)
    assert files(tmp_path / "f") == whole
    first = 0 if on_submit else count
    assert asked == TASKS[first:]
    assert done == list(range(first, len(TASKS) + 1))


class Loses(Executor):
    """Loses each of the first ``count`` calls for the third task, as a pool does whose process ends."""

    def __init__(self, count):
        self.left = count

    def submit(self, work, task):
        future = Future()
        if task == 2 and self.left:
            self.left -= 1
            future.set_exception(BrokenExecutor("a process ended"))
        else:
            future.set_result(work(task))
        return future


def test_a_piece_whose_worker_ends_is_computed_again(tmp_path, whole):
    done_in(tmp_path / "f", executor=Loses(2))
    assert files(tmp_path / "f") == whole
    with pytest.raises(
        Refusal, match=r"The worker that computed piece 2 ended, 3 times; what is done is kept"
    ):
        done_in(tmp_path / "g", executor=Loses(3))
    assert len(list((tmp_path / "g").glob("piece-*"))) == 5


@pytest.mark.skipif(os.name != "posix", reason="folders are not locked")
def test_a_second_run_in_a_folder_is_refused_and_the_first_goes_on(tmp_path, whole):
    def meanwhile(done):
        if done == 3:
            with pytest.raises(Refusal, match="is in use by another process; wait for it, or give another"):
                done_in(tmp_path / "f")

    done_in(tmp_path / "f", progress=meanwhile)
    assert files(tmp_path / "f") == whole
    done_in(tmp_path / "f")


KILLED = """
import sys
import numpy as np
from fixedpipe.effects.scattering import long_work

def work(task):
    if task == 3:
        print("three are done", flush=True)
        sys.stdin.read()  # until the end of the process
    return np.full((4, 3), float(task * task) / 3.0)

long_work.run(range(6), work, folder=sys.argv[1], parameters={"seed": 7, "size": [4, 3]})
"""


@pytest.mark.skipif(os.name != "posix", reason="signals are POSIX's")
def test_a_process_that_is_killed_loses_nothing_that_was_done(tmp_path, whole):
    folder = tmp_path / "f"
    process = subprocess.Popen(
        [sys.executable, "-c", KILLED, str(folder)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert process.stdout.readline() == "three are done\n"
    process.send_signal(signal.SIGKILL)
    process.wait()
    process.stdin.close()
    process.stdout.close()
    assert sorted(path.name for path in folder.glob("piece-*")) == [f"piece-0000{k}.npy" for k in range(3)]
    done_in(folder)
    assert files(folder) == whole


@pytest.mark.parametrize("written", ["piece", "manifest"])
def test_half_a_file_is_no_file(tmp_path, whole, written, monkeypatch):
    """The process ends between a file's bytes and its name, for each file of the third piece."""
    real, left = long_work.Path.replace, {"piece": 5, "manifest": 6}[written]
    # Names are given to the manifest once, then to a piece and the manifest in turn.
    count = 0

    def replace(path, target):
        nonlocal count
        count += 1
        if count > left:
            raise KeyboardInterrupt
        return real(path, target)

    monkeypatch.setattr(long_work.Path, "replace", replace)
    with pytest.raises(KeyboardInterrupt):
        done_in(tmp_path / "f")
    monkeypatch.undo()
    assert any(name.startswith(".partial-") for name in files(tmp_path / "f"))
    done_in(tmp_path / "f")
    assert files(tmp_path / "f") == whole


def test_other_parameters_are_refused_by_name_and_nothing_is_lost(tmp_path, whole):
    done_in(tmp_path / "f")
    with pytest.raises(Refusal, match=r"other parameters \(seed\)"):
        long_work.run(TASKS, squares, folder=tmp_path / "f", parameters={**PARAMETERS, "seed": 8})
    with pytest.raises(Refusal, match=r"other parameters \(pieces\)"):
        long_work.run(TASKS[:3], squares, folder=tmp_path / "f", parameters=PARAMETERS)
    assert files(tmp_path / "f") == whole


@pytest.mark.parametrize("text", [b"", b"{", b"[]", b"null", b"{}", b"\xff\xfe"])
def test_a_damaged_manifest_is_refused(tmp_path, text):
    done_in(tmp_path)
    (tmp_path / "manifest.json").write_bytes(text)
    before = files(tmp_path)
    with pytest.raises(Refusal, match="is damaged"):
        done_in(tmp_path)
    assert files(tmp_path) == before


@pytest.mark.parametrize(
    "change",
    [
        {"format": 2},
        {"digest": "0"},
        {"done": {"9": "0"}},
        {"done": {"x": "0"}},
        {"done": [1]},
        {"pieces": "6"},
        {"parameters": {"seed": 8}},
    ],
    ids=str,
)
def test_a_manifest_that_was_changed_is_refused(tmp_path, change):
    done_in(tmp_path)
    manifest = json.loads((tmp_path / "manifest.json").read_text())
    (tmp_path / "manifest.json").write_text(json.dumps({**manifest, **change}))
    with pytest.raises(Refusal, match="is damaged"):
        done_in(tmp_path)


def test_a_manifest_that_is_gone_is_not_guessed(tmp_path):
    done_in(tmp_path)
    (tmp_path / "manifest.json").unlink()
    with pytest.raises(Refusal, match=r"no manifest\.json"):
        done_in(tmp_path)


def test_a_damaged_piece_is_refused_and_one_that_is_removed_computed_again(tmp_path, whole):
    folder = tmp_path / "f"
    done_in(folder)
    piece = folder / "piece-00002.npy"
    piece.write_bytes(piece.read_bytes()[:-1])
    with pytest.raises(Refusal, match=r"piece-00002\.npy is damaged; remove it"):
        done_in(folder)
    piece.unlink()
    done_in(folder)
    assert files(folder) == whole


def test_a_folder_that_cannot_be_made_is_refused(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(Refusal, match="cannot be made"):
        done_in(tmp_path / "file" / "f")
    with pytest.raises(Refusal, match="cannot be made"):
        done_in("nul\0byte")


def test_parameters_that_are_no_numbers_have_no_digest():
    with pytest.raises(ValueError, match="Out of range float"):
        long_work.digest({"angle": float("nan")})
    assert long_work.digest({"a": 1, "b": 2}) == long_work.digest({"b": 2, "a": 1})
    one, two = np.zeros(4), np.zeros((2, 2))
    assert len({long_work.array_digest(a) for a in (one, two, one.astype(np.float32))}) == 3


def test_a_piece_that_cannot_be_written_is_said_and_the_others_stay(tmp_path):
    (tmp_path / "piece-00002.npy").mkdir()
    (tmp_path / "manifest.json").write_bytes(_empty_manifest())
    with pytest.raises(Refusal, match=r"piece-00002\.npy cannot be written"):
        done_in(tmp_path)
    assert sorted(json.loads((tmp_path / "manifest.json").read_text())["done"]) == ["0", "1"]


def _empty_manifest():
    known = {"format": 1, "digest": long_work.digest(PARAMETERS), "parameters": PARAMETERS}
    return json.dumps({**known, "pieces": len(TASKS), "done": {}}).encode()


def test_what_was_half_written_is_gone_when_the_work_is_done(tmp_path, whole):
    folder = tmp_path / "f"
    folder.mkdir()
    for name in (".partial-piece-00099.npy", ".partial-manifest.json"):
        (folder / name).write_bytes(b"half")
    done_in(folder)
    assert files(folder) == whole


class AtOnce(Executor):
    """The first task fails, the others are done at once, the last are never begun."""

    def __init__(self, pending):
        self.pending, self.futures = pending, []

    def submit(self, work, *arguments):
        future = Future()
        if not self.futures:
            future.set_exception(RuntimeError("the worker died"))
        elif len(self.futures) < len(TASKS) - self.pending:
            future.set_result(work(*arguments))
        self.futures.append(future)
        return future


def test_what_came_with_a_piece_that_failed_is_kept_and_what_waits_is_left_out(tmp_path):
    executor = AtOnce(2)
    with pytest.raises(RuntimeError, match="the worker died"):
        done_in(tmp_path, executor=executor)
    assert [path.name for path in sorted(tmp_path.glob("piece-*"))] == [
        f"piece-0000{k}.npy" for k in (1, 2, 3)
    ]
    assert [future.cancelled() for future in executor.futures] == [False] * 4 + [True] * 2
