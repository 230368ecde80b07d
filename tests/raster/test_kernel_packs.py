"""Packs of kernels: a process reads one in the place of compiling; what is damaged, stale or foreign is not
read, and a sentence names what is wrong.
"""

import os
import subprocess
import sys

import numba
import pytest

from fixedpipe.raster import kernel, kernel_packs
from fixedpipe.raster.kernel_levels import LEVELS, levels_here
from fixedpipe.raster.kernel_packs import Pack, PackError, packs_in, write_pack

STATE, OTHER = "0123456789abcdef", "fedcba9876543210"
LEVEL = LEVELS[-1]  # which every x86-64 has
KEY = ((numba.int64,), ("x86_64-unknown-linux-gnu", "generic", ""), ("code", "closure"))
HERE = pytest.mark.skipif(not levels_here(), reason="levels are x86-64's, and no processor may be named")


@pytest.fixture
def packed(tmp_path):
    """A pack of two kernels."""
    path = tmp_path / "x86-64.pack"
    other = ((numba.float64,), *KEY[1:])
    kernels = [("a/one", KEY, b"\x80\x04K\x01."), ("a/one", other, b"\x80\x04K\x02.")]
    write_pack(path, STATE, LEVEL.name, kernels)
    return path


def test_what_was_packed_is_read_again(packed):
    pack = Pack(packed)
    assert len(pack) == 2
    assert pack.load("a/one", KEY) == 1
    assert pack.load("a/one", ((numba.int32,), *KEY[1:])) is None
    assert pack.load("a/other", KEY) is None
    assert [path.name for path in packed.parent.iterdir()] == [packed.name]
    pack.check_fits(STATE)
    pack.check_whole()


def test_a_pack_cut_anywhere_is_refused_or_lacks_what_was_cut(packed):
    whole = packed.read_bytes()
    for length in range(len(whole)):
        packed.write_bytes(whole[:length])
        with pytest.raises(PackError, match=r"is no pack|is damaged"):
            Pack(packed).check_whole()


def test_a_pack_with_any_bit_turned_is_refused(packed):
    whole = packed.read_bytes()
    for bit in range(8 * len(whole)):
        turned = bytearray(whole)
        turned[bit // 8] ^= 1 << bit % 8
        packed.write_bytes(turned)
        with pytest.raises(PackError, match=r"is no pack|is damaged"):
            Pack(packed).check_whole()


def test_a_damaged_kernel_is_not_unpickled(packed):
    whole = packed.read_bytes()
    packed.write_bytes(whole[:-1] + bytes([whole[-1] ^ 1]))
    pack = Pack(packed)
    assert pack.load("a/one", ((numba.float64,), *KEY[1:])) is None
    assert pack.load("a/one", KEY) == 1


@pytest.mark.parametrize("name", ["python", "numba", "llvmlite", "system"])
def test_a_pack_of_another_python_or_package_is_refused_by_name(packed, monkeypatch, name):
    words, here = kernel_packs._FACTS[name]
    monkeypatch.setitem(kernel_packs._FACTS, name, (words, "another"))
    with pytest.raises(PackError, match=f"has kernels for {words} {here}, and here is another"):
        Pack(packed).check_fits(STATE)


def test_a_pack_of_other_sources_is_refused_by_name(packed):
    with pytest.raises(PackError, match=f"kernels of other sources, {STATE}; these are {OTHER}"):
        Pack(packed).check_fits(OTHER)


@pytest.mark.parametrize("data", [b"", b"PK\x03\x04", None], ids=["empty", "a zip file", "missing"])
def test_what_is_no_pack_is_refused_by_name(tmp_path, data):
    path = tmp_path / "kernels.pack"
    if data is not None:
        path.write_bytes(data)
    with pytest.raises(PackError, match=r"kernels\.pack (is no pack|cannot be read)"):
        Pack(path)


@HERE
def test_a_folders_packs_are_found_and_those_that_do_not_fit_are_told(packed):
    packs, refused = packs_in.__wrapped__((packed.parent,), STATE)
    assert [pack.path for pack in packs] == [packed] and refused == ()
    packs, (sentence,) = packs_in.__wrapped__((packed.parent,), OTHER)
    assert packs == () and "other sources" in sentence


@HERE
def test_the_highest_level_that_the_processor_has_comes_first(tmp_path, monkeypatch):
    for level in LEVELS:
        write_pack(tmp_path / f"{level.name}.pack", STATE, level.name, [])
    for lacks, first in (((), "x86-64-v4"), (("avx512f",), "x86-64-v3"), (("avx512f", "fma"), "x86-64")):
        has = {name: name not in lacks for level in LEVELS for name in level.needs}
        monkeypatch.setattr("fixedpipe.raster.kernel_levels._features", lambda has=has: has)
        levels_here.cache_clear()
        assert packs_in.__wrapped__((tmp_path,), STATE)[0][0].level.name == first
    monkeypatch.undo()
    levels_here.cache_clear()


# ------------------------------------------------------------------------- kernels, in processes of their own

KERNELS = """
from fixedpipe.raster.kernel import kernel

@kernel
def called(x):
    return 2.0 * x

@kernel("f8(f8)")
def calling(x):
    return called(x) + {more}
"""
PACKS = """
import sys, kernels
from fixedpipe.raster import kernel
from fixedpipe.raster.kernel_levels import LEVELS
from fixedpipe.raster.kernel_packs import write_pack
kernels.calling(3.0)
level = LEVELS[-1]
write_pack(sys.argv[1], kernel.STATE, level.name, kernel.compiled_for(level))
"""
CALLS = """
from numba.core import event

class Listener(event.Listener):
    def on_start(self, event):
        print(event.data["dispatcher"].py_func.__name__)

    def on_end(self, event):
        pass

event.register("numba:compile", Listener())
import kernels
print(kernels.calling(3.0))
"""


def called(folder, program, *arguments, **more):
    environment = {name: value for name, value in os.environ.items() if not name.startswith("NUMBA_CPU")}
    environment |= {"NUMBA_CACHE_DIR": str(folder / "cache"), "PYTHONPATH": str(folder), **more}
    command = [sys.executable, "-c", program, *map(str, arguments)]
    return subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout.split()


@HERE
def test_a_process_with_a_pack_compiles_nothing(tmp_path):
    """Kernels of any processor's level, of another folder, without the sources' times and paths; a change of
    the source is compiled all the same.
    """
    (tmp_path / "made").mkdir()
    (tmp_path / "made" / "kernels.py").write_text(KERNELS.format(more="1.0"))
    pack = tmp_path / "cache" / "kernels" / kernel.STATE / "x86-64.pack"
    called(tmp_path / "made", PACKS, tmp_path / "x86-64.pack", **LEVEL.environment())
    (tmp_path / "kernels.py").write_text(KERNELS.format(more="1.0"))
    pack.parent.mkdir(parents=True)
    pack.write_bytes((tmp_path / "x86-64.pack").read_bytes())
    assert called(tmp_path, CALLS) == ["7.0"]
    (tmp_path / "kernels.py").write_text(KERNELS.format(more="1.25"))
    assert called(tmp_path, CALLS) == ["calling", "called", "7.25"]
    (tmp_path / "kernels.py").write_text(KERNELS.format(more="1.0"))
    pack.write_bytes(pack.read_bytes()[:-1])
    compiled = called(tmp_path, CALLS)
    assert compiled[-1] == "7.0" and len(compiled) == 2  # the damaged one of the two


def test_a_process_that_names_its_processor_reads_no_pack():
    program = "from fixedpipe.raster.kernel_levels import levels_here; print(levels_here())"
    run = subprocess.run(
        [sys.executable, "-c", program],
        env=os.environ | LEVELS[-1].environment(),
        capture_output=True,
        text=True,
        check=True,
    )
    assert run.stdout == "()\n"
