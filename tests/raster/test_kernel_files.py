"""A kernel's files, damaged in every way: it is compiled again, never another one or a half one."""

import os
import signal
import subprocess
import sys

import pytest
from numba.core.caching import IndexDataCacheFile

from fixedpipe.raster.kernel_files import CheckedFiles

STAMP = (1.5, 200)


def files_of(folder, name="kernel", stamp=STAMP, kind=CheckedFiles):
    return kind(cache_path=str(folder), filename_base=name, source_stamp=stamp)


@pytest.fixture
def saved(tmp_path):
    """Files with two keys: files, index, data of "key"."""
    files = files_of(tmp_path)
    files.save("key", ("code", 1))
    files.save("other", ("code", 2))
    assert files.load("key") == ("code", 1)
    return files, tmp_path / "kernel.nbi", tmp_path / "kernel.1.nbc"


def is_mended(files):
    """Whether saving again makes it whole."""
    files.save("key", ("code", 3))
    return files.load("key") == ("code", 3)


@pytest.mark.parametrize("which", [1, 2], ids=["index", "data"])
def test_a_file_cut_anywhere_counts_as_none(saved, which):
    files, whole = saved[0], saved[which].read_bytes()
    for length in range(len(whole)):
        saved[which].write_bytes(whole[:length])
        assert files.load("key") is None, length
    assert is_mended(files)


@pytest.mark.parametrize("which", [1, 2], ids=["index", "data"])
def test_a_file_with_any_bit_turned_counts_as_none(saved, which):
    files, whole = saved[0], saved[which].read_bytes()
    for bit in range(8 * len(whole)):
        turned = bytearray(whole)
        turned[bit // 8] ^= 1 << bit % 8
        saved[which].write_bytes(turned)
        assert files.load("key") is None, bit
    assert is_mended(files)


@pytest.mark.parametrize("which", [1, 2], ids=["index", "data"])
@pytest.mark.parametrize("damage", ["garbage", "longer", "missing", "folder"])
def test_a_file_that_is_none_counts_as_none(saved, which, damage):
    files, path = saved[0], saved[which]
    whole = path.read_bytes()
    path.unlink()
    if damage == "folder":
        path.mkdir()
    elif damage != "missing":
        path.write_bytes(bytes(range(256)) * 9 if damage == "garbage" else whole + b"\0")
    assert files.load("key") is None
    if damage == "folder":
        path.rmdir()
    assert is_mended(files)


def test_another_keys_data_counts_as_none(saved, tmp_path):
    files, _, data = saved
    data.write_bytes((tmp_path / "kernel.2.nbc").read_bytes())
    assert files.load("key") is None
    assert files.load("other") == ("code", 2)
    assert is_mended(files)


def test_another_kernels_files_count_as_none(saved, tmp_path):
    files, index, data = saved
    files_of(tmp_path, "twin").save("key", ("code", 9))
    index.write_bytes((tmp_path / "twin.nbi").read_bytes())
    data.write_bytes((tmp_path / "twin.1.nbc").read_bytes())
    assert files.load("key") is None
    assert is_mended(files)


def test_files_of_another_source_or_another_numba_count_as_none(saved, tmp_path):
    assert files_of(tmp_path, stamp=(1.5, 201)).load("key") is None
    older = files_of(tmp_path)
    older._version = "0.1"
    assert older.load("key") is None
    assert is_mended(older)
    assert saved[0].load("key") is None, "the older one's index is read by the newer"
    assert is_mended(saved[0])


def test_an_index_of_numbas_own_counts_as_none(tmp_path):
    files_of(tmp_path, kind=IndexDataCacheFile).save("key", ("code", 1))
    files = files_of(tmp_path)
    assert files.load("key") is None
    assert is_mended(files)


# ------------------------------------------------------------- kernels, in processes of their own

KERNELS = """
from fixedpipe.raster.kernel import kernel

@kernel
def called(x):
    return 2.0 * x

@kernel("f8(f8)")
def calling(x):
    return called(x) + {more}
"""
# Prints which kernels it compiles, then the result; ``sys.argv[1]``: before which rename of a file it says so
# and waits.
CALLS = """
import os, sys
from numba.core import caching, event

class Listener(event.Listener):
    def on_start(self, event):
        print(event.data["dispatcher"].py_func.__name__)

    def on_end(self, event):
        pass

left = int(sys.argv[1])
replace = os.replace

def replaced(*paths):
    global left
    left -= 1
    if left == 0:
        print("waits", flush=True)
        sys.stdin.readline()
    replace(*paths)

event.register("numba:compile", Listener())
caching.os.replace = replaced
import kernels
print(kernels.calling(3.0))
"""


@pytest.fixture
def environment(tmp_path):
    (tmp_path / "kernels.py").write_text(KERNELS.format(more="1.0"))
    return {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "cache"), "PYTHONPATH": str(tmp_path)}


def called(environment, program=CALLS, *arguments, **options):
    """(what a process printed, word by word, what it said): it has to end well."""
    command = [sys.executable, "-c", program, *(arguments or ("0",))]
    run = subprocess.run(command, env=environment, capture_output=True, text=True, check=False, **options)
    assert run.returncode == 0, run.stderr
    return run.stdout.split(), run.stderr


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="this system kills processes in another way")
@pytest.mark.parametrize("rename", [1, 2, 3, 4])
def test_a_process_killed_while_it_writes_leaves_nothing_stale(environment, tmp_path, rename):
    """Kernels of an older source lie there; they are compiled anew, up to the rename-th file: of each the
    data comes first, then the index.
    """
    assert called(environment)[0][-1] == "7.0"
    (tmp_path / "kernels.py").write_text(KERNELS.format(more="1.25"))
    piped = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True, "env": environment}
    killed = subprocess.Popen([sys.executable, "-c", CALLS, str(rename)], **piped)
    while killed.stdout.readline() != "waits\n":
        assert killed.poll() is None
    killed.kill()
    killed.communicate()
    written = ["called"] if rename > 2 else []
    assert called(environment)[0] == [n for n in ("calling", "called") if n not in written] + ["7.25"]
    assert called(environment)[0] == ["7.25"]


DAMAGED = """
import importlib, itertools, pathlib, sys
from numba.core import event

compiled = []

class Listener(event.Listener):
    def on_start(self, event):
        compiled.append(event.data["dispatcher"].py_func.__name__)

    def on_end(self, event):
        pass

event.register("numba:compile", Listener())
import kernels
assert kernels.calling(3.0) == 7.0
folder = pathlib.Path(sys.argv[1])
damages = {
    "empty": lambda whole: b"",
    "one byte": lambda whole: whole[:1],
    "half": lambda whole: whole[: len(whole) // 2],
    "all but one": lambda whole: whole[:-1],
    "garbage": lambda whole: bytes(reversed(whole)),
    "a bit": lambda whole: whole[:-99] + bytes([whole[-99] ^ 4]) + whole[-98:],
    "another's": None,
}
for suffix, (name, damage) in itertools.product((".nbi", ".nbc"), damages.items()):
    paths = sorted(folder.rglob("*" + suffix))
    assert len(paths) == 2
    wholes = [path.read_bytes() for path in paths]
    damaged = map(damage, wholes) if damage else reversed(wholes)
    for path, data in zip(paths, damaged):
        path.write_bytes(data)
    for expected in (["calling", "called"], []):
        compiled.clear()
        importlib.reload(kernels)
        assert kernels.calling(3.0) == 7.0, (suffix, name)
        assert compiled == expected, (suffix, name, compiled)
print("mended")
"""


def test_kernels_with_damaged_files_are_compiled_again_and_kept(environment, tmp_path):
    assert called(environment, DAMAGED, str(tmp_path / "cache"))[0] == ["mended"]


# Python itself leaves bytecode cut at the limit, which the next process cannot read. So this one writes none.
FULL = """
import resource, sys
sys.dont_write_bytecode = True
resource.setrlimit(resource.RLIMIT_FSIZE, (512, 512))
"""


@pytest.mark.skipif(sys.platform == "win32", reason="this system does not limit the size of files")
def test_kernels_are_drawn_with_where_no_file_can_be_written_and_a_sentence_says_so(environment, tmp_path):
    """Files cannot become longer than 512 bytes: writing ends as on a full disk."""
    for _ in range(2):
        words, said = called(environment, FULL + CALLS)
        assert words == ["calling", "called", "7.0"]
        assert said.count("Compiled kernels cannot be kept in") == 1
        assert "make room there, or name another folder in NUMBA_CACHE_DIR." in said
        assert [path for path in (tmp_path / "cache").rglob("*.tmp*")] == []
    assert called(environment)[0] == ["calling", "called", "7.0"]
    assert called(environment)[0] == ["7.0"]


def test_a_folder_that_cannot_be_made_keeps_nothing_and_stops_nothing(environment, tmp_path):
    assert called(environment)[0] == ["calling", "called", "7.0"]
    (folder,) = {path.parent for path in (tmp_path / "cache").rglob("*.nbi")}
    for path in folder.iterdir():
        path.unlink()
    folder.rmdir()
    folder.write_text("a file where the folder was")
    words, said = called(environment)
    assert words == ["calling", "called", "7.0"]
    assert "Compiled kernels cannot be kept in" in said
