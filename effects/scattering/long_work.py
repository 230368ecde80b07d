"""Work that takes hours, in pieces that are stored: a folder, its manifest, and a file for each finished
piece.

The manifest holds the work's parameters, the number of pieces, and the finished ones, each with the digest of
its bytes. A piece's file is written under another name and then renamed; then the manifest is written in the
same way. So half of a file never appears. After an error, a signal or a power cut, the work continues after
the last piece in the manifest. In the end the bytes are the same, however often the work was stopped and
however many processors it ran on.

Only one run at a time works in a folder; if the system can lock folders, a second run is refused.
"""

import hashlib
import io
import json
import os
from collections import Counter
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, wait
from contextlib import ExitStack
from pathlib import Path

import numpy as np

from fixedpipe.effects.refusal import Refusal

try:
    import fcntl
except ImportError:  # where folders are not locked
    fcntl = None

MANIFEST = "manifest.json"
_FORMAT = 1
# What files are called while they are written.
_PARTIAL = ".partial-"
# How often a piece is computed whose worker ends. Assumed: memory may end a worker because of a neighbour,
# but not three times.
_TRIES = 3


def digest(parameters):
    """Of parameters that JSON can hold: 64 hexadecimal digits, the same for the same values."""
    return hashlib.sha256(_canonical(parameters)).hexdigest()


def array_digest(*arrays):
    """Of arrays' types, shapes and numbers: 64 hexadecimal digits."""
    found = hashlib.sha256()
    for array in arrays:
        array = np.ascontiguousarray(array)
        found.update(f"{array.dtype.str}{array.shape}".encode())
        found.update(array.tobytes())
    return found.hexdigest()


def _canonical(value):
    return json.dumps(value, sort_keys=True, separators=(",", ":"), allow_nan=False).encode()


def _write(path, data):
    partial = path.with_name(_PARTIAL + path.name)
    try:
        with partial.open("wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        partial.replace(path)
    except OSError as error:
        raise Refusal(f"{path} cannot be written: {error.strerror}; what is done is kept.") from error


def _array_bytes(array):
    stream = io.BytesIO()
    np.save(stream, np.ascontiguousarray(array), allow_pickle=False)
    return stream.getvalue()


def _locked(folder):
    """Lock a folder against other runs: its descriptor, None where folders are not locked. Raises Refusal."""
    if fcntl is None:
        return None
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as error:
        os.close(descriptor)
        raise Refusal(
            f"{folder} is in use by another process; wait for it, or give another folder."
        ) from error
    except OSError:  # a file system without locks
        pass
    return descriptor


class Folder:
    """The finished pieces of one work, for one run at a time: a context.

    path        the folder; it is made if it is missing
    parameters  the work's parameters, a dict that JSON can hold
    pieces      how many pieces there are

    Raises Refusal for a folder that cannot be written or that another run has, a manifest or a piece that is
    damaged, a manifest with other parameters, and pieces without a manifest. The folder's contents then stay
    unchanged.
    """

    def __init__(self, path, parameters, pieces):
        self.path = Path(path)
        self.pieces = int(pieces)
        # As JSON gives them back: tuples become lists.
        self.parameters = json.loads(_canonical(parameters))
        self.done = {}
        try:
            self.path.mkdir(parents=True, exist_ok=True)
        except (OSError, ValueError) as error:
            reason = getattr(error, "strerror", None) or error
            raise Refusal(f"The folder {self.path} cannot be made: {reason}.") from error
        self._lock = _locked(self.path)
        try:
            self._begin()
        except BaseException:
            self.__exit__()
            raise

    def __enter__(self):
        return self

    def __exit__(self, *_):
        """Let another run have the folder."""
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None

    def _begin(self):
        if self._manifest.exists():
            self.done = self._read()
        elif any(self.path.glob("piece-*.npy")):
            raise Refusal(
                f"{self.path} has pieces of some work and no {MANIFEST} that says of which; give another "
                "folder."
            )
        for partial in self.path.glob(_PARTIAL + "*"):
            partial.unlink(missing_ok=True)
        self._save()

    @property
    def _manifest(self):
        return self.path / MANIFEST

    def file_of(self, piece):
        """The file of a piece, by its number."""
        return self.path / f"piece-{piece:05d}.npy"

    def _save(self):
        manifest = {
            "format": _FORMAT,
            "digest": digest(self.parameters),
            "parameters": self.parameters,
            "pieces": self.pieces,
            "done": {str(piece): self.done[piece] for piece in sorted(self.done)},
        }
        _write(self._manifest, json.dumps(manifest, indent=1).encode() + b"\n")

    def _read(self):
        """The digests of the pieces that are done, by their numbers."""
        there = self._manifest_there()
        if there["digest"] != digest(self.parameters) or there["pieces"] != self.pieces:
            theirs = there["parameters"]
            names = sorted(
                name
                for name in theirs.keys() | self.parameters.keys()
                if theirs.get(name) != self.parameters.get(name)
            )
            raise Refusal(
                f"{self.path} holds work of other parameters ({', '.join(names) or 'pieces'}); give another "
                "folder, or the parameters that it was begun with."
            )
        found = {}
        for name, expected in there["done"].items():
            path = self.file_of(int(name))
            if not path.exists():  # it is computed again
                continue
            try:
                data = path.read_bytes()
            except OSError as error:
                raise Refusal(f"{path} cannot be read: {error.strerror}.") from error
            if hashlib.sha256(data).hexdigest() != expected:
                raise Refusal(f"{path} is damaged; remove it, and it is computed again.")
            found[int(name)] = expected
        return found

    def _manifest_there(self):
        try:
            there = json.loads(self._manifest.read_bytes())
            parameters, done = there["parameters"], there["done"]
            whole = (
                there["format"] == _FORMAT
                and isinstance(parameters, dict)
                and digest(parameters) == there["digest"]
                and isinstance(there["pieces"], int)
                and all(
                    name.isdigit() and int(name) < there["pieces"] and isinstance(known, str)
                    for name, known in done.items()
                )
            )
        except OSError as error:
            raise Refusal(f"{self._manifest} cannot be read: {error.strerror}.") from error
        except (ValueError, KeyError, TypeError, AttributeError):
            whole = False
        if not whole:
            raise Refusal(
                f"{self._manifest} is damaged, so it is not known which work its pieces are of; give another "
                "folder."
            )
        return there

    def keep(self, piece, array):
        """Write a piece, then the manifest that names it. Raises Refusal where they cannot be written."""
        data = _array_bytes(array)
        _write(self.file_of(piece), data)
        self.done[piece] = hashlib.sha256(data).hexdigest()
        self._save()

    def piece(self, number):
        """A piece that is done, as an array."""
        return np.load(self.file_of(number), allow_pickle=False)


def run(tasks, work, *, folder=None, parameters=None, executor: Executor | None = None, progress=None):
    """``work`` done on every one of ``tasks``: a list of arrays, in the tasks' order.

    tasks       what ``work`` takes; for a pool of processes it can be pickled, as ``work`` can
    work        makes an array of a task, the same whenever it is called
    folder      where pieces are stored, and found when the work continues; None: nowhere
    parameters  all that the arrays depend on, a dict that JSON can hold
    executor    a concurrent.futures.Executor; None: one after the other, here
    progress    None, or a function that is called with how many are done, first those that were there

    A piece whose worker ends is computed again. Raises Refusal as ``Folder`` does and for a piece whose
    worker ended three times, and the exceptions of ``work`` and of the executor. Pieces that are finished by
    then stay.
    """
    tasks = list(tasks)
    with ExitStack() as held:
        kept = None
        if folder is not None:
            kept = held.enter_context(Folder(folder, parameters or {}, len(tasks)))
        return _run(tasks, work, kept, executor, progress)


def _run(tasks, work, kept, executor, progress):
    found = {} if kept is None else {piece: kept.piece(piece) for piece in kept.done}

    def came(piece, array):
        found[piece] = array
        if kept is not None:
            kept.keep(piece, array)
        if progress is not None:
            progress(len(found))

    if progress is not None:
        progress(len(found))
    missing = [piece for piece in range(len(tasks)) if piece not in found]
    if executor is None:
        for piece in missing:
            came(piece, work(tasks[piece]))
    else:
        _share(missing, tasks, work, executor, came)
    return [found[piece] for piece in range(len(tasks))]


def _share(missing, tasks, work, executor, came):
    waiting, lost = {}, Counter()
    try:
        for piece in missing:
            waiting[executor.submit(work, tasks[piece])] = piece
        while waiting:
            done, _ = wait(waiting, return_when=FIRST_COMPLETED)
            failed, again = None, []
            # Those that came with one that failed are kept before it is said.
            for future in sorted(done, key=waiting.get):
                piece = waiting.pop(future)
                error = future.exception()
                if error is None:
                    came(piece, future.result())
                    continue
                if isinstance(error, BrokenExecutor):
                    lost[piece] += 1
                    if lost[piece] < _TRIES:
                        again.append(piece)
                        continue
                    error = _ended(piece, error)
                failed = failed or error
            if failed is not None:
                raise failed
            for piece in again:
                waiting[executor.submit(work, tasks[piece])] = piece
    finally:
        for future in waiting:
            future.cancel()


def _ended(piece, error):
    refusal = Refusal(f"The worker that computed piece {piece} ended, {_TRIES} times; what is done is kept.")
    refusal.__cause__ = error
    return refusal
