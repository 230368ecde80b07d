"""``fixedpipe cache`` and ``fixedpipe warmup``: where kernels are, and what is said if none are kept."""

import importlib
import os
import pickle
import subprocess
import sys
import weakref
from dataclasses import replace
from types import SimpleNamespace

import numba
import pytest
from click.testing import CliRunner

from fixedpipe.effects.cli import kernel_packing, main
from fixedpipe.effects.cli import warmup as command
from fixedpipe.pipeline.native import background_compiling
from fixedpipe.pipeline.selftest.checks import Check
from fixedpipe.raster import kernel, kernel_folder
from fixedpipe.raster.kernel_levels import LEVELS, levels_here

STATE = "0123456789abcdef"


@pytest.fixture
def base(tmp_path, monkeypatch):
    """The only base there is: it holds a megabyte and a half of kernels."""
    folder = tmp_path / "kernels" / STATE
    folder.mkdir(parents=True)
    (folder / "kernel.nbc").write_bytes(bytes(1_500_000))
    monkeypatch.setattr(kernel_folder, "bases", lambda: [tmp_path])
    return tmp_path


def run(*arguments):
    return CliRunner().invoke(main, arguments)


def test_cache_says_where_kernels_are_and_clear_removes_them(base):
    assert run("cache").stdout == f"     1.5 MB  {base / 'kernels' / STATE}\n"
    assert run("cache", "clear").stdout == "Removed 1 of 1 folders, 2 MB.\n"
    assert "No compiled kernels are kept" in run("cache").stdout
    assert base.is_dir()


def test_what_stays_sets_exit_status_1(base, monkeypatch):
    def refused(folder):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(kernel_folder.shutil, "rmtree", refused)
    found = run("cache", "clear")
    assert found.exit_code == 1
    assert found.stderr == f"{base / 'kernels' / STATE} stays: Permission denied. Let its owner remove it.\n"


def test_clearing_loads_no_compiler():
    code = (
        "import sys\nfrom fixedpipe.effects.cli import main\nmain(['cache'], standalone_mode=False)\n"
        "print('numba' in sys.modules)"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert out.splitlines()[-1] == "False"


def test_warmup_leaves_nothing_to_compile(base, monkeypatch):
    """What it calls compiles every kernel of every module; that it does is seen by one of each package."""
    asked = []

    def import_module(name):
        asked.append(name)
        return importlib.import_module(name) if name.count(".") == 1 else None

    monkeypatch.setattr(background_compiling, "compile_beside", lambda engine: None)
    monkeypatch.setattr(kernel, "_of_one_signature", ready := [])
    monkeypatch.setattr(command, "importlib", SimpleNamespace(import_module=import_module))
    monkeypatch.setattr(kernel, "CACHE_FOLDER", base / "kernels" / STATE)

    class Kernel:
        def make_ready(self):
            asked.append(self)

    ready.append(Kernel())
    found = run("warmup")
    assert found.exit_code == 0, found.output
    assert found.stdout.endswith(f"They are kept in {base / 'kernels' / STATE} (2 MB).\n")
    assert asked[-1] is ready[0]
    assert {"fixedpipe.raster.vector.frame", "fixedpipe.effects.geometry.cube_maps"} <= set(asked[:-1])
    assert not [name for name in asked[:-1] if name.endswith("__main__")]  # it would run the command again


@pytest.mark.parametrize(("is_kept", "engines"), [(True, ["vector"]), (False, [])])
def test_warmup_lets_another_process_compile_the_engines_where_it_can_read_them(
    base, monkeypatch, is_kept, engines
):
    asked, alive = [], []

    class Beside:
        """What it waits for; if nobody holds it the process cannot tell anything, and fails."""

        def __init__(self, engine):
            asked.append(engine)
            alive.append(weakref.ref(self))

    class Kernel:
        def make_ready(self):
            assert all(process() is not None for process in alive)

    monkeypatch.setattr(background_compiling, "compile_beside", Beside)
    monkeypatch.setattr(kernel, "_of_one_signature", [Kernel()])
    monkeypatch.setattr(command, "pkgutil", SimpleNamespace(walk_packages=lambda *where: []))
    monkeypatch.setattr(kernel, "CACHE_FOLDER", base / "kernels" / STATE if is_kept else base / "alone")
    assert run("warmup").exit_code == (not is_kept)
    assert asked == engines


def test_warmup_fails_where_nothing_is_kept(base, monkeypatch):
    package = SimpleNamespace(__path__=[])
    monkeypatch.setattr(kernel, "_of_one_signature", [])
    monkeypatch.setattr(command, "importlib", SimpleNamespace(import_module=lambda name: package))
    monkeypatch.setattr(kernel, "CACHE_FOLDER", base / os.devnull)
    found = run("warmup")
    assert found.exit_code == 1
    assert "Name one in NUMBA_CACHE_DIR." in found.stderr


def test_warmup_lets_another_process_compile_the_engine_that_is_missing(base, monkeypatch):
    asked = []
    monkeypatch.setattr(background_compiling, "compile_beside", asked.append)  # which none of them needs
    monkeypatch.setattr(kernel, "_of_one_signature", [])
    monkeypatch.setattr(command, "pkgutil", SimpleNamespace(walk_packages=lambda *where: []))
    monkeypatch.setattr(kernel, "CACHE_FOLDER", base / "kernels" / STATE)
    assert run("warmup").exit_code == 0
    assert asked == ["vector", "portable"]


@pytest.mark.parametrize(("missing", "status"), [("uvicorn", 0), ("fixedpipe.raster.gone", 1)])
def test_warmup_leaves_out_modules_of_an_extra_that_is_not_installed(base, monkeypatch, missing, status):
    def import_module(name):
        if name.count(".") == 1:
            return importlib.import_module(name)
        raise ModuleNotFoundError(f"No module named {missing!r}", name=missing)

    monkeypatch.setattr(background_compiling, "compile_beside", lambda engine: None)
    monkeypatch.setattr(kernel, "_of_one_signature", [])
    monkeypatch.setattr(command, "importlib", SimpleNamespace(import_module=import_module))
    monkeypatch.setattr(kernel, "CACHE_FOLDER", base / "kernels" / STATE)
    assert run("warmup").exit_code == status


# ------------------------------------------------------------------------------------------------- packs


@pytest.fixture
def level(monkeypatch):
    """A level that this process compiles for, as it were; nothing is compiled."""
    found = replace(LEVELS[-1], features=numba.config.CPU_FEATURES, processor=numba.config.CPU_NAME)
    monkeypatch.setattr(kernel_packing, "LEVELS", (found,))
    monkeypatch.setattr(kernel_packing, "compile_all", lambda: None)
    monkeypatch.setattr(kernel_packing, "compiled_for", lambda level: [("a", KEY, pickle.dumps(3))])
    monkeypatch.setattr(kernel_packing, "checks_elsewhere", lambda *given: ())
    return found


KEY = (numba.int64,), ("system", "processor", "features"), ("code", "closure")
ON_X86 = pytest.mark.skipif(not levels_here(), reason="packs are for x86-64")


@ON_X86
def test_a_pack_is_written_and_kept(base, level, monkeypatch, tmp_path):
    monkeypatch.setattr(kernel_packing, "CACHE_FOLDER", base / "kernels" / STATE)
    file = tmp_path / "new" / "kernels.pack"
    said = run("cache", "pack", str(file), "--level", "x86-64")
    assert said.exit_code == 0 and f"{file} has 1 kernel for x86-64 (0.0 MB)." in said.stdout
    said = run("cache", "unpack", str(file))
    assert said.exit_code == 0, said.output
    kept = base / "kernels" / STATE / "x86-64.pack"
    assert said.stdout == f"1 kernel for x86-64 kept in {kept}.\n"
    assert kept.read_bytes() == file.read_bytes()


@ON_X86
@pytest.mark.parametrize("way", ["pack", "unpack"])
def test_a_pack_that_draws_other_bits_is_refused(base, level, monkeypatch, tmp_path, way):
    monkeypatch.setattr(kernel_packing, "CACHE_FOLDER", base / "kernels" / STATE)
    file = tmp_path / "kernels.pack"
    if way == "unpack":
        assert run("cache", "pack", str(file), "--level", "x86-64").exit_code == 0
    failed = Check("with it", "on one thread", 2, ("Frame 'a' differs.",))
    monkeypatch.setattr(kernel_packing, "checks_elsewhere", lambda *given: (failed,))
    said = run("cache", way, str(file), *(["--level", "x86-64"] if way == "pack" else []))
    assert said.exit_code == 2
    assert (
        f"1 drawing of the self-test went wrong, drawn with the kernels of {file}: Frame 'a' differs."
        in said.stderr
    )
    assert file.exists() is (way == "unpack")
    assert not list((base / "kernels" / STATE).glob("*.pack"))


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("unpack", "none.pack"), "none.pack cannot be read: No such file or directory."),
        (
            ("unpack", __file__),
            "test_cache.py is no pack of kernels; `fixedpipe cache pack FILE` writes one.",
        ),
        (("pack", "a.pack", "--level", "x86-64-v9"), "There is no level 'x86-64-v9'."),
    ],
)
def test_what_is_no_pack_or_level_is_refused_by_name(arguments, sentence):
    said = run("cache", *arguments)
    assert said.exit_code == 2 and sentence in said.stderr, said.output
