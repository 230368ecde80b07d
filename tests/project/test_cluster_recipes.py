"""The jobs of docs/examples/cluster, with programs named as those of Slurm, Dask and MPI in their place."""

import os
import re
import subprocess
import tomllib

import pytest

from fixedpipe.effects.cli import _COMMANDS
from tests.layers import ROOT
from tests.support.waiting import HANGS

FOLDER = ROOT / "docs" / "examples" / "cluster"
# Each notes how it was called. A scheduler writes its file, and what serves goes on until it is ended.
PROGRAMS = {
    "fixedpipe": """[ "$1" = sweep ] || exit 0; [ -z "$FAILS" ] || exit 3
until grep -q worker "$NOTES"; do sleep 0.1; done""",
    "dask": '[ "$1" != scheduler ] || echo "{}" > "$3"; exec sleep 600',
    "srun": 'while [ "$1" != dask ]; do shift; done; exec "$@"',
    "mpiexec": "",
}
SWEEP = "K12", "--vary", "bits=4:6", "--out", "a file.csv"


def job(folder, name, **more):
    """(exit status, calls) of a job in an empty folder, which is as empty when it has ended."""
    for program, does in PROGRAMS.items():
        path = folder / "bin" / program
        path.parent.mkdir(exist_ok=True)
        path.write_text(
            # A line is written at once: several programs write at the same time.
            f"""#!/bin/bash\nnote=$(printf '%s|' {program} "$@"); echo "$note" >> "$NOTES"\n{does}\n"""
        )
        path.chmod(0o755)
    (folder / "job").mkdir()
    own = {"PATH": f"{folder / 'bin'}{os.pathsep}{os.environ['PATH']}", "NOTES": str(folder / "notes")}
    own |= {"SLURM_NTASKS": "2", "SLURM_JOB_ID": "7", "SLURM_SUBMIT_DIR": str(folder / "job"), **more}
    command = "bash", FOLDER / name, *SWEEP
    # Its output ends with the last process that it began.
    done = subprocess.run(
        command, cwd=folder / "job", env=os.environ | own, capture_output=True, timeout=HANGS
    )
    assert not list((folder / "job").iterdir())
    return done.returncode, [line.split("|")[:-1] for line in (folder / "notes").read_text().splitlines()]


@pytest.mark.parametrize("fails", ["", "yes"])
def test_a_sweep_by_dask_in_a_job_of_slurm(tmp_path, fails):
    status, calls = job(tmp_path, "sweep-dask.sbatch", FAILS=fails)
    file = str(tmp_path / "job" / "scheduler-7.json")
    assert status == (3 if fails else 0)
    assert calls[0] == ["fixedpipe", "warmup"]
    assert ["fixedpipe", "sweep", *SWEEP, "--executor", f"dask:{file}"] in calls
    if not fails:  # otherwise the job may end before its workers have begun
        worker = ["srun", "--ntasks=2", "dask", "worker", "--scheduler-file", file]
        assert worker in [call[:6] for call in calls]


def test_a_sweep_by_mpi_in_a_job_of_slurm(tmp_path):
    status, calls = job(tmp_path, "sweep-mpi.sbatch")
    ours = "mpiexec", "python", "-m", "mpi4py.futures", "-m", "fixedpipe.effects.cli"
    assert status == 0
    assert calls == [["fixedpipe", "warmup"], [*ours, "sweep", *SWEEP, "--executor", "mpi"]]


def test_the_container_installs_extras_and_runs_commands_that_there_are():
    text = (FOLDER / "Dockerfile").read_text()
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]
    (asked,) = re.findall(r"/src/fixedpipe\[(.*?)\]", text)
    assert set(asked.split(",")) <= extras.keys()
    commands = re.findall(r"fixedpipe (\w+)(?: &&|$)", text, re.MULTILINE)
    assert commands == ["warmup", "selftest"] and set(commands) <= set(_COMMANDS)
