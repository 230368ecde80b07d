"""Where compiled kernels are kept: which folder is taken, who reads whose, and what clearing removes."""

import os
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from fixedpipe.raster import kernel_folder

STATE, OLDER = "0123456789abcdef", "fedcba9876543210"


@pytest.fixture
def bases(tmp_path, monkeypatch):
    """The user's choice, the installation's, the user's own, the temporary one: all below a folder."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "chosen"))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(kernel_folder, "of_installation", lambda: tmp_path / "installed")
    monkeypatch.setattr(kernel_folder.tempfile, "gettempdir", lambda: str(tmp_path))
    monkeypatch.setattr(kernel_folder.tempfile, "tempdir", str(tmp_path))
    return kernel_folder.bases()


def cannot_be_written(monkeypatch, *folders):
    """As for a user without the right to: root may write everywhere."""
    can = kernel_folder._can_be_written
    monkeypatch.setattr(
        kernel_folder, "_can_be_written", lambda f: not any(f.is_relative_to(g) for g in folders) and can(f)
    )


def test_the_first_base_that_can_be_written_is_taken(bases, monkeypatch):
    assert [base.name.split("-")[0] for base in bases] == ["chosen", "installed", "fixedpipe", "fixedpipe"]
    for k, base in enumerate(bases):
        cannot_be_written(monkeypatch, *bases[:k])
        assert kernel_folder.kernel_folder(STATE) == base / "kernels" / STATE


def test_a_user_without_a_home_has_none_of_his_own(bases, monkeypatch):
    def no_home():
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.delenv("XDG_CACHE_HOME")
    monkeypatch.setattr(kernel_folder.Path, "home", no_home)
    assert kernel_folder.bases() == [bases[0], bases[1], bases[3]]


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="the temporary folder is the user's alone here")
def test_processes_of_a_user_share_a_folder_in_the_temporary_one_that_is_his_alone(bases, monkeypatch):
    cannot_be_written(monkeypatch, *bases[:3])
    folder = kernel_folder.kernel_folder(STATE)
    assert folder == kernel_folder.kernel_folder(STATE)
    assert stat.S_IMODE(bases[3].stat().st_mode) == 0o700


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="the temporary folder is the user's alone here")
@pytest.mark.parametrize("how", ["others may write", "another user's", "a link"])
def test_a_folder_that_anybody_may_have_made_is_not_taken(bases, monkeypatch, tmp_path, how):
    cannot_be_written(monkeypatch, *bases[:3])
    if how == "a link":
        (tmp_path / "elsewhere").mkdir(mode=0o700)
        bases[3].symlink_to(tmp_path / "elsewhere")
    else:
        bases[3].mkdir(mode=0o700)
    if how == "others may write":
        bases[3].chmod(0o777)
    if how == "another user's":
        monkeypatch.setattr(kernel_folder.os, "getuid", lambda: os.stat(tmp_path).st_uid + 1)
        monkeypatch.setattr(kernel_folder, "_in_temporary", lambda: bases[3])
    removed = []
    monkeypatch.setattr(kernel_folder.atexit, "register", lambda *call, **how: removed.append(call[1]))
    folder = kernel_folder.kernel_folder(STATE)
    assert folder.parent == tmp_path and folder.name.startswith("fixedpipe-kernels-")
    assert removed == [str(folder)]


def test_clearing_removes_kernels_of_every_state_and_nothing_else(bases):
    (bases[1] / "kernels" / STATE / "deep").mkdir(parents=True)
    (bases[1] / "kernels" / STATE / "deep" / "kernel.nbc").write_bytes(bytes(1000))
    (bases[2] / "kernels" / OLDER).mkdir(parents=True)
    (bases[2] / "kernels" / OLDER / "kernel.nbi").write_bytes(bytes(10))
    (bases[0] / "kernels" / "of-another-program").mkdir(parents=True)
    kept = [(bases[1] / "kernels" / STATE, 1000), (bases[2] / "kernels" / OLDER, 10)]
    assert kernel_folder.kept() == kept
    assert kernel_folder.clear() == []
    assert kernel_folder.kept() == []
    assert (bases[0] / "kernels" / "of-another-program").is_dir()
    assert not bases[2].exists() and bases[1].is_dir()  # ours alone by its name


def test_what_cannot_be_removed_is_told(bases, monkeypatch):
    def refused(folder):
        raise PermissionError(13, "Permission denied")

    (bases[1] / "kernels" / STATE).mkdir(parents=True)
    monkeypatch.setattr(kernel_folder.shutil, "rmtree", refused)
    assert kernel_folder.clear() == [(bases[1] / "kernels" / STATE, "Permission denied")]


KERNELS = """
from fixedpipe.raster.kernel import kernel

@kernel("f8(f8)")
def added(x):
    return x + 1.0
"""
CALLS = """
import sys
from pathlib import Path
from fixedpipe.raster import kernel_folder
kernel_folder.of_installation = lambda: Path(sys.argv[1])
own, writes = Path(sys.argv[2]), kernel_folder._can_be_written
kernel_folder._can_be_written = lambda folder: folder.is_relative_to(own) and writes(folder)
import kernels
from numba.core import event

class Listener(event.Listener):
    def on_start(self, event):
        print("compiled")

    def on_end(self, event):
        pass

event.register("numba:compile", Listener())
print(kernels.added(3.0))
"""


def run_kernel(folder, installation, own, **chosen):
    """What a process says that calls a kernel and may write below ``own`` alone."""
    (folder / "kernels.py").write_text(KERNELS)
    environment = {name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"}
    environment |= {"XDG_CACHE_HOME": str(own), "PYTHONPATH": str(folder), **chosen}
    command = [sys.executable, "-c", CALLS, installation, own]
    return subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout.split()


def test_kernels_of_the_installation_are_read_by_who_cannot_write_there(tmp_path):
    """Its owner compiles; another user, whose own folder is empty, does not."""
    owner, user = tmp_path / "owner", tmp_path / "user"
    assert run_kernel(tmp_path, owner, owner) == ["compiled", "4.0"]
    assert run_kernel(tmp_path, owner, user) == ["4.0"]
    assert not list(user.rglob("*.nbc"))
    for path in owner.rglob("*.nbc"):
        path.write_bytes(path.read_bytes()[:-1])
    assert run_kernel(tmp_path, owner, user) == ["compiled", "4.0"]  # a damaged one counts as none
    assert list(user.rglob("*.nbc"))


def test_in_a_folder_that_the_user_chose_only_its_own_kernels_are_read(tmp_path):
    owner, chosen = tmp_path / "owner", tmp_path / "chosen"
    assert run_kernel(tmp_path, owner, owner) == ["compiled", "4.0"]
    assert run_kernel(tmp_path, owner, chosen, NUMBA_CACHE_DIR=str(chosen)) == ["compiled", "4.0"]
    assert run_kernel(tmp_path, owner, chosen, NUMBA_CACHE_DIR=str(chosen)) == ["4.0"]


def test_an_import_needs_no_home(tmp_path):
    """A user who is in no table of users and has no HOME: some containers and services."""
    code = (
        "from pathlib import Path\n"
        "def no_home(): raise RuntimeError('Could not determine home directory.')\n"
        "Path.home = no_home\n"
        "import fixedpipe.raster.kernel"
    )
    environment = {k: v for k, v in os.environ.items() if k not in ("HOME", "XDG_CACHE_HOME")}
    subprocess.run([sys.executable, "-c", code], env=environment, check=True, cwd=Path(tmp_path))
