"""No stale kernel is loaded: the cache's name changes with every source that a kernel may be made of. And no
kernel takes a long list of arguments.
"""

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

from fixedpipe.raster import kernel


@pytest.fixture
def sources(tmp_path):
    """A folder of sources with a folder in it."""
    (tmp_path / "portable").mkdir()
    (tmp_path / "rows.py").write_text("A = 1\n")
    (tmp_path / "portable" / "sample.py").write_text("B = 1\n")
    return tmp_path


@pytest.mark.parametrize("name", ["rows.py", "portable/sample.py"])
def test_a_changed_source_changes_the_digest(sources, name):
    before = kernel.source_digest(sources)
    (sources / name).write_text("C = 2\n")
    assert kernel.source_digest(sources) != before


@pytest.mark.parametrize("name", ["codes.py", "vector/sample.py", "portable/deep/down.py"])
def test_a_new_source_changes_the_digest(sources, name):
    before = kernel.source_digest(sources)
    (sources / name).parent.mkdir(parents=True, exist_ok=True)
    (sources / name).write_text("")
    assert kernel.source_digest(sources) != before


def test_a_source_moved_to_another_folder_changes_the_digest(sources):
    before = kernel.source_digest(sources)
    (sources / "vector").mkdir()
    (sources / "portable" / "sample.py").rename(sources / "vector" / "sample.py")
    assert kernel.source_digest(sources) != before


def test_what_is_no_source_leaves_the_digest(sources):
    before = kernel.source_digest(sources)
    (sources / "portable" / "notes.txt").write_text("")
    assert kernel.source_digest(sources) == before


RASTER, MOST_ARGUMENTS = Path(kernel.__file__).parent, 8


@pytest.mark.parametrize("path", kernel.kernel_sources(RASTER), ids=str)
def test_what_belongs_together_is_one_argument(path):
    functions = [
        n for n in ast.walk(ast.parse((RASTER / path).read_text())) if isinstance(n, ast.FunctionDef)
    ]
    long = [f.name for f in functions if len(f.args.args) + len(f.args.kwonlyargs) > MOST_ARGUMENTS]
    assert not long, f"{path}: {', '.join(long)}: take named tuples (raster/arrays.py)"


KERNELS = """
from fixedpipe.raster.kernel import kernel

@kernel(inlined=True)
def copied(x):
    if x > 2.0:
        return 2.0
    return x

@kernel
def called(x):
    return copied(x + 1.0) * x

@kernel("f8(f8)")
def calling(x):
    return called(x) + 1.0
"""
CALLS = """
import sys
import kernels
from numba.core import event

class Listener(event.Listener):
    def on_start(self, event):
        print(event.data["dispatcher"].py_func.__name__)

    def on_end(self, event):
        pass

event.register("numba:compile", Listener())
print("ready", flush=True)
sys.stdin.readline()
print(kernels.calling(3.0))
"""


def test_two_processes_do_not_compile_the_same_kernel(tmp_path):
    """Both call it at once: one of them compiles each kernel, and the other one reads it. An inlined kernel
    is compiled with the kernel that calls it, never alone.
    """
    (tmp_path / "kernels.py").write_text(KERNELS)
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "cache"), "PYTHONPATH": str(tmp_path)}
    piped = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True, "env": environment}
    both = [subprocess.Popen([sys.executable, "-c", CALLS], **piped) for _ in range(2)]
    assert [process.stdout.readline() for process in both] == ["ready\n", "ready\n"]
    for process in both:
        process.stdin.write("\n")
        process.stdin.flush()
    said = [process.communicate()[0].split() for process in both]
    assert [lines[-1] for lines in said] == ["7.0", "7.0"]
    assert sorted(said[0][:-1] + said[1][:-1]) == ["called", "calling"]
