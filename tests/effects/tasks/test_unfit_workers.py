"""Workers of Dask in processes of their own, of which one has another Numba and one draws other bits."""

import os
import re
import subprocess
import sys

import pytest

from fixedpipe.effects.tasks.environment import UnfitWorker, environment
from fixedpipe.effects.tasks.executors import opened
from fixedpipe.effects.tasks.run import run
from tests.effects.tasks import works
from tests.effects.tasks.works import tasks_of
from tests.layers import ROOT
from tests.support.waiting import HANGS

# What Python imports as it starts, where PYTHONPATH has it.
OTHERS = {
    "another Numba": """
from importlib import metadata

version = metadata.version
metadata.version = lambda name: "0.1" if name == "numba" else version(name)
""",
    "other bits": """
from fixedpipe.pipeline.selftest import quick

quick.failures = lambda: ("Frame 'lines' differs.",)
""",
}


def worker(address, folder, other=""):
    folder.mkdir()
    (folder / "sitecustomize.py").write_text(other)
    command = sys.executable, "-m", "distributed.cli.dask_worker", address
    options = "--nthreads", "1", "--no-nanny", "--no-dashboard", "--death-timeout", "600"
    changed = {"PYTHONPATH": os.pathsep.join(map(str, (folder, ROOT)))}
    return subprocess.Popen(
        (*command, *options), cwd=folder, env=os.environ | changed, stderr=subprocess.DEVNULL
    )


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize("sound", [1, 0])
def test_unfit_workers_are_named_and_the_others_compute(tmp_path, sound):
    distributed = pytest.importorskip("distributed")
    quiet = {"dashboard_address": None, "scheduler_kwargs": {"dashboard_address": "127.0.0.1:0"}}
    said, workers = [], {}
    with distributed.LocalCluster(n_workers=0, processes=True, **quiet) as cluster:
        try:
            for name, other in {**OTHERS, **dict.fromkeys(["sound"][:sound], "")}.items():
                workers[name] = worker(cluster.scheduler_address, tmp_path / name, other)
            with distributed.Client(cluster, set_as_default=False) as client:
                client.wait_for_workers(len(workers), timeout=HANGS)
            address = f"dask:{cluster.scheduler_address}"
            if sound:
                with opened(address, say=said.append) as found:
                    assert found.workers() == 1
                    outcomes = [o for _, o in run(tasks_of(works.squared), found, workers=found.workers)]
                assert sorted(o.value["square"] for o in outcomes) == [n * n for n in range(6)]
                assert {int(o.worker.split(":")[1]) for o in outcomes} == {workers["sound"].pid}
            else:
                with (
                    pytest.raises(UnfitWorker, match="No worker is left: each has"),
                    opened(address, say=said.append),
                ):
                    pass
        finally:
            for process in workers.values():
                process.terminate()
                process.wait()
    numba, bits = (rf".+:{workers[name].pid}" for name in OTHERS)
    own = re.escape(environment()["numba"])
    expected = (
        rf"tcp://\S+ is left out\. The worker {numba} has numba 0\.1, and this client {own}; .*",
        rf"tcp://\S+ is left out\. The worker {bits} draws other bits .* Frame 'lines' differs\.",
    )
    assert len(said) == 2
    assert all(any(re.fullmatch(pattern, sentence) for sentence in said) for pattern in expected), said
