"""Files are written whole, or not at all. Missing folders are made.

``writable_file`` says before a long computation whether a file can be written.
"""

import os
import shutil
import stat
import tempfile
from contextlib import contextmanager, suppress
from pathlib import Path

from fixedpipe.effects.refusal import Refusal

# Characters of a file's name that a temporary one beside it has, and of its ending.
_NAMED, _LONGEST_ENDING = 30, 10


def writable_folder(folder):
    """The folder as a path, made if need be. Raises Refusal when nothing can be written there."""
    folder = Path(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return folder
    except FileExistsError as error:
        raise Refusal(
            f"The folder {folder} cannot be written to: {folder} is a file, and no folder."
        ) from error
    except OSError as error:
        raise Refusal(f"The folder {folder} cannot be written to: {error.strerror}.") from error
    except ValueError as error:
        raise Refusal(f"{str(folder)!r} is no name of a folder: {error}.") from error


def writable_file(name):
    """The file as a path, its folder made if need be. Raises Refusal when it cannot be written."""
    path = Path(name)
    if _is_stream(path):
        return path
    writable_folder(path.parent)
    try:
        if path.is_dir():
            raise Refusal(f"{path} is a folder; name a file in it.")
        handle, probe = _temporary_beside(path)
        os.close(handle)
        probe.unlink()
    except Refusal:
        raise
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise Refusal(f"{str(path)!r} cannot be written: {reason}.") from error
    return path


def _is_stream(path):
    """Whether a name is of a device, a pipe or what a process has open, and of no file that is replaced."""
    try:
        there = os.stat(path).st_mode
    except (OSError, ValueError):
        return False
    return not (stat.S_ISREG(there) or stat.S_ISDIR(there)) or path.is_relative_to("/dev")


def _are_one(path, other):
    """Whether two names are of one file: equal, or by links of either kind."""
    try:
        return os.path.samefile(path, other)
    except (OSError, ValueError):  # a file that is not there is no other
        return False


def writable_picture(name, inputs=()):
    """``writable_file`` of a PNG file. Raises Refusal for another ending, before any folder is made, and for
    one of the ``inputs``, files by whatever names, from which the picture is made.
    """
    path = Path(name)
    if path.name and not os.path.isdir(path) and path.suffix.lower() != ".png":
        raise Refusal(f"The picture is written as PNG; name it {path.with_suffix('.png')} instead of {path}.")
    for read in inputs:
        if _are_one(path, read):
            raise Refusal(f"{path} is {read}, of which the picture is made; give --out another name.")
    return writable_file(name)


def _temporary_beside(path):
    """An open handle of a new file in the folder of ``path``, hidden and named after it, and its path; its
    name is no longer than that of ``path`` may be. What goes into a stream is in the temporary folder first.
    """
    folder = tempfile.gettempdir() if _is_stream(path) else path.parent
    with suppress(FileNotFoundError):
        os.lstat(path)  # raises where the file system takes no such name
    ending = path.suffix if len(path.suffix) <= _LONGEST_ENDING else ""
    handle, temporary = tempfile.mkstemp(dir=folder, prefix=f".{path.stem[:_NAMED]}.", suffix=ending)
    return handle, Path(temporary)


@contextmanager
def written_whole(path):
    """The path of a temporary file to be written, renamed to ``path`` at the end: at no moment is there half
    a file under that name.

    Raises Refusal when it cannot be written. After any interruption the temporary file is deleted.
    """
    temporary = None
    try:
        handle, temporary = _temporary_beside(path)
        os.close(handle)
        yield temporary
        if _is_stream(path):
            with temporary.open("rb") as whole, path.open("ab") as stream:
                shutil.copyfileobj(whole, stream)
            temporary.unlink()
            return
        # mkstemp makes a file for its owner alone; give it what an ordinary new file gets.
        mask = os.umask(0)
        os.umask(mask)
        temporary.chmod(0o666 & ~mask)
        temporary.replace(path)
    except BaseException as error:
        if temporary:
            with suppress(OSError):
                temporary.unlink()
        if isinstance(error, OSError):
            raise Refusal(f"{path} cannot be written: {error.strerror}.") from error
        raise


def write_whole(path, data):
    """Write bytes, whole or not at all: as ``written_whole``."""
    with written_whole(path) as temporary:
        temporary.write_bytes(data)
