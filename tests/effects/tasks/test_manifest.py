"""Manifests: one client at a time, and what was committed stays whatever ends it."""

import os
import signal
import sqlite3
import subprocess
import sys

import pytest

from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.tasks import manifest as manifests
from fixedpipe.effects.tasks.manifest import Manifest
from fixedpipe.effects.tasks.task import Outcome
from tests.layers import ROOT

DONE = Outcome(value={"b": 1.5, "a": [1, None, "x"]}, seconds=0.25, worker="host:7", files={"p.png": b"png"})


def test_an_outcome_comes_back_as_it_was(tmp_path):
    with Manifest(tmp_path / "m", "squares") as kept:
        kept.keep("d", DONE)
    with Manifest(tmp_path / "m", "squares") as kept:
        found = kept.find("d")
        assert found == Outcome(DONE.value, "", "", 0.25, "host:7", {"p.png": b""})
        assert list(found.value) == ["b", "a"] and kept.find("e") is None and len(kept) == 1
        kept.forget()
        assert kept.find("d") is None
    assert [path.name for path in tmp_path.iterdir()] == ["m"]


def test_a_second_client_is_refused_by_the_first_ones_name(tmp_path):
    with Manifest(tmp_path / "m", "squares") as first:
        first.keep("d", DONE)
        with pytest.raises(Refusal, match=rf"is in use by the process .+:{os.getpid()}; wait for it"):
            Manifest(tmp_path / "m", "squares")
        first.keep("e", DONE)
    with Manifest(tmp_path / "m", "squares") as second:
        assert len(second) == 2


def test_the_manifest_of_other_work_is_refused(tmp_path):
    Manifest(tmp_path / "m", "a sweep of K12").__exit__()
    with pytest.raises(Refusal, match="the manifest of a sweep of K12, and this is a sweep of K02; give"):
        Manifest(tmp_path / "m", "a sweep of K02")


def of_another_program(path):
    file = sqlite3.connect(path)
    file.execute("CREATE TABLE birds (name TEXT)")
    file.close()


def of_another_format(path):
    Manifest(path, "squares").__exit__()
    file = sqlite3.connect(path)
    file.execute("UPDATE about SET said = 'fixedpipe tasks, 99' WHERE name = 'format'")
    file.commit()
    file.close()


@pytest.mark.parametrize(
    "make", [lambda path: path.write_text("no database " * 99), of_another_program, of_another_format]
)
def test_what_is_no_manifest_is_refused_and_left_alone(tmp_path, make):
    make(tmp_path / "m")
    before = (tmp_path / "m").read_bytes()
    with pytest.raises(Refusal, match=r"/m is no manifest.*; give --manifest another name"):
        Manifest(tmp_path / "m", "squares")
    assert (tmp_path / "m").read_bytes() == before


def test_a_folder_is_no_manifest(tmp_path):
    with pytest.raises(Refusal, match="cannot be written: unable to open database file"):
        Manifest(tmp_path, "squares")


def test_on_a_full_disc_what_was_committed_stays(tmp_path, monkeypatch):
    monkeypatch.setattr(manifests, "_SECONDS_BETWEEN_COMMITS", 0.0)
    kept, large = 0, Outcome(value="x" * 5000)
    with Manifest(tmp_path / "m", "squares") as full:
        full._file.execute("PRAGMA max_page_count = 40")  # as SQLite sees a disc of 160 KiB
        with pytest.raises(
            Refusal, match=r"cannot be written: database or disk is full\. What was done before"
        ):
            while kept < 1000:
                full.keep(str(kept), large)
                kept += 1
    with Manifest(tmp_path / "m", "squares") as again:
        assert 10 < kept == len(again) < 1000
        again.keep("more", DONE)


CLIENT = """
import sys
from fixedpipe.effects.tasks import manifest
from fixedpipe.effects.tasks.task import Outcome

kept = manifest.Manifest(sys.argv[1], "squares")
for n in range(20):
    kept.keep(str(n), Outcome(value=n))
kept.commit()
for n in range(20, 10000):  # more than SQLite has in memory, so that some is written and not committed
    kept.keep(str(n), Outcome(value="x" * 1000))
    manifest._SECONDS_BETWEEN_COMMITS = 1e9
print("ready", flush=True)
sys.stdin.read()
"""


def test_a_client_that_is_killed_leaves_what_it_committed(tmp_path):
    command = [sys.executable, "-c", CLIENT, str(tmp_path / "m")]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    with subprocess.Popen(command, text=True, cwd=ROOT, **pipes) as client:
        assert client.stdout.readline() == "ready\n"
        with pytest.raises(Refusal, match=f"in use by the process .+:{client.pid}"):
            Manifest(tmp_path / "m", "squares")
        client.send_signal(signal.SIGKILL)
    with Manifest(tmp_path / "m", "squares") as again:
        assert [again.find(str(n)).value for n in range(20)] == list(range(20))
        assert again.find("20") is None and len(again) == 20
