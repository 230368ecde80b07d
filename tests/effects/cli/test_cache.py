"""``fixedpipe cache`` and ``fixedpipe warmup``: where kernels are, and what is said if none are kept."""

import importlib
import os
import subprocess
import sys
import weakref
from types import SimpleNamespace

import pytest
from click.testing import CliRunner

from fixedpipe.effects.cli import main
from fixedpipe.effects.cli import warmup as command
from fixedpipe.pipeline.native import background_compiling
from fixedpipe.raster import kernel, kernel_folder

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
