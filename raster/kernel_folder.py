"""Where compiled kernels are kept: in ``kernels`` below the first base folder that can be written. Each state
of the sources has a folder of its own there.

No base is inside an installed package. pip does not remove what it did not install, and a folder that stays
in ``site-packages`` could still be imported.
"""

import atexit
import os
import re
import shutil
import stat
import sys
import tempfile
from contextlib import suppress
from pathlib import Path

CHOSEN = "NUMBA_CACHE_DIR"
_RESULTS = "results"
_PACKAGE = Path(__file__).parent.parent
_MOST_STATES = 6  # Assumed: as many as a developer goes back and forth between; each takes 40 MB
_STATE = re.compile("[0-9a-f]{16}")  # the digest that a folder of kernels is named after


def of_installation():
    """The base that belongs to the Python in which the package is installed, or to the checkout. All its
    users read it; those fill it who may write there.
    """
    if (_PACKAGE / "pyproject.toml").is_file():
        return _PACKAGE / ".cache"
    return Path(sys.prefix) / "var" / "cache" / "fixedpipe"


def bases():
    """Every base, the preferred one first: the user's choice, the installation's, the user's own, one in the
    temporary folder. A user without a home has none of his own.
    """
    found = []
    if chosen := os.environ.get(CHOSEN):
        found.append(Path(chosen))
    found.append(of_installation())
    if (own := _of_user()) is not None:
        found.append(own)
    return [*found, _in_temporary()]


def _of_user():
    """The base in the user's own cache; None for a user without a home."""
    try:
        return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "fixedpipe"
    except RuntimeError:
        return None


def _in_temporary():
    """One for each user, so that all his processes share it."""
    user = os.getuid() if hasattr(os, "getuid") else "kernels"
    return Path(tempfile.gettempdir()) / f"fixedpipe-{user}"


def kernel_folder(state):
    """The folder in which this process keeps kernels of a state of the sources (16 hexadecimal digits). It
    exists.

    Kernels are code, and anybody can make a folder in the temporary one. So the base there is taken only
    where it is this user's alone. Otherwise the folder is this process's, which removes it at its end.
    """
    for base in bases():
        if base == _in_temporary() and not _is_own(base):
            break
        if _can_be_written(base / "kernels" / state):
            return base / "kernels" / state
    folder = tempfile.mkdtemp(prefix="fixedpipe-kernels-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return Path(folder)


def other_folders(state):
    """The folders in which kernels of a state of the sources are looked for as well: the installation's and
    the user's own.

    There is none where the user chose a folder: then no other is read, so an empty one is empty.
    """
    if os.environ.get(CHOSEN):
        return ()
    return tuple(base / "kernels" / state for base in bases() if base != _in_temporary())


def mirror_folder(state, first):
    """The folder in which kernels are kept a second time: the user's own, from which his other checkouts and
    environments of the same sources read. None where there is none, or it is the first.

    It has the kernels of few states: of those that were made earlier, the ones that were used last.
    """
    if os.environ.get(CHOSEN) or (own := _of_user()) is None:
        return None
    folder = own / "kernels" / state
    if first == folder or not _can_be_written(folder):
        return None
    with suppress(OSError):
        os.utime(folder)
        for older in sorted(_states(own / "kernels"), key=lambda f: f.stat().st_mtime)[:-_MOST_STATES]:
            shutil.rmtree(older, ignore_errors=True)
    return folder


def results_folder():
    """The folder of what commands compute once and find again (``fixedpipe.effects.computed_once``): below
    the user's choice, else his own, else the installation's. None where it cannot be written.
    """
    base = Path(chosen) if (chosen := os.environ.get(CHOSEN)) else _of_user() or of_installation()
    return base / _RESULTS if _can_be_written(base / _RESULTS) else None


def _can_be_written(folder):
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False


def _is_own(base):
    """Whether a folder of the temporary one is this user's alone; it is made where it is not there."""
    try:
        base.mkdir(mode=0o700, exist_ok=True)
        found = base.lstat()
    except OSError:
        return False
    if not hasattr(os, "getuid"):  # where each user has a temporary folder of his own
        return stat.S_ISDIR(found.st_mode)
    return stat.S_ISDIR(found.st_mode) and found.st_uid == os.getuid() and not found.st_mode & 0o077


def kept():
    """[(folder, its size in bytes)] of all that is kept: in each base the kernels of each state of sources,
    and results.
    """
    folders = []
    for base in dict.fromkeys(bases()):
        folders += _states(base / "kernels")
        folders += [base / _RESULTS] * (base / _RESULTS).is_dir()
    return [
        (folder, sum(path.stat().st_size for path in folder.rglob("*") if path.is_file()))
        for folder in folders
    ]


def _states(folder):
    try:
        return sorted(
            path for path in folder.iterdir() if _STATE.fullmatch(path.name) and not path.is_symlink()
        )
    except OSError:  # not there, or another user's
        return []


def clear():
    """Remove all that is kept, and our own folders that are empty then.

    Returns [(folder, what the system says)] of those that could not be removed.
    """
    left = []
    for folder, _ in kept():
        try:
            shutil.rmtree(folder)
        except OSError as error:
            left.append((folder, error.strerror))
    for base in bases():
        with suppress(OSError):  # not there, or something else lies in it
            (base / "kernels").rmdir()
            if base.name.startswith("fixedpipe"):
                base.rmdir()
    return left
