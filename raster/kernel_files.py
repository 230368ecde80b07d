"""The files in which a compiled kernel is kept: Numba's, with digests, so that a damaged one counts as none.

Numba unpickles what it finds. Measured, of 83 ways to damage a file of two small kernels: what is cut raises
whatever pickle comes upon, a bit that is turned may end the process by a signal, another kernel's data is run
in the place of this one's. It also writes an index before the data, which names older code where a process is
killed between the two. Here an index begins with a digest of what follows and of whose it is, and holds a
digest of each data file; what does not fit is not there, and is compiled and written again.
"""

import hashlib
import pickle
import warnings
from functools import cache
from pathlib import Path

import numba
from numba.core.caching import CompileResultCacheImpl, FunctionCache, IndexDataCacheFile

_DIGEST = 32  # bytes of sha256


class KernelsNotKept(UserWarning):
    """Compiled kernels could not be written to the folder in which they are kept."""


class CheckedFiles(IndexDataCacheFile):
    """An index and its data files. Where Numba has a data file's name for a key, this has its digest too.

    Nothing that is wrong with a file raises: it is then as if it were not there. What is not there is looked
    for in ``shared``: the same kernel's files in another folder, or None.
    """

    shared = None

    def load(self, key):
        """What was saved for a key; None where that is not there, whole and its own."""
        found = self._load_own(key)
        return self.shared.load(key) if found is None and self.shared else found

    def _load_own(self, key):
        name, digest = self._load_index().get(key, (None, None))
        if name is None:
            return None
        data = self._read(name)
        return pickle.loads(data) if hashlib.sha256(data).digest() == digest else None

    def save(self, key, data):
        """Save for a key: first the data, then the index, which until then names none, or what is no longer
        there.
        """
        data, overloads = self._dump(data), self._load_index()
        taken = {name for name, _ in overloads.values()}
        free = (name for k in range(1, len(taken) + 2) if (name := self._data_name(k)) not in taken)
        name, _ = overloads.get(key) or (next(free), None)
        with self._open_for_write(self._data_path(name)) as file:
            file.write(data)
        self._save_index(overloads | {key: (name, hashlib.sha256(data).digest())})

    def _load_index(self):
        """By key, (a data file's name, its digest)."""
        data = self._read(self._index_name)
        if data[:_DIGEST] != self._digest(data[_DIGEST:]):
            return {}
        return pickle.loads(data[_DIGEST:])

    def _save_index(self, overloads):
        data = self._dump(overloads)
        with self._open_for_write(self._index_path) as file:
            file.write(self._digest(data) + data)

    def _digest(self, data):
        """Of an index: of this kernel, this source and this version of Numba alone."""
        whose = repr((self._index_name, self._source_stamp, self._version)).encode()
        return hashlib.sha256(whose + data).digest()

    def _read(self, name):
        """A file's bytes; none where it cannot be read."""
        try:
            with open(self._data_path(name), "rb") as file:
                return file.read()
        except OSError:
            return b""


class _Folder(CompileResultCacheImpl._locator_classes[0]):
    """Numba's own for NUMBA_CACHE_DIR, the first that it tries, and here the only one.

    Where that cannot be written Numba takes the sources' __pycache__, which is not named after all sources
    that a kernel is made of: a stale kernel would be read from it. It also tries to write for every kernel.
    """

    @classmethod
    def from_function(cls, function, path):
        """The folder of a function's kernels, whether or not it can be written."""
        return cls(function, path)


class _Compiled(CompileResultCacheImpl):
    _locator_classes = [_Folder]


class KernelCache(FunctionCache):
    """A kernel's cache in a folder; where that cannot be written, the kernel is compiled and not kept, and a
    warning says so, once. What the folder lacks is read from ``shared``, which is not written.
    """

    _impl_class = _Compiled

    def __init__(self, function, folder, shared):
        super().__init__(function)
        inside = Path(self._cache_path).relative_to(folder)
        stamp = self._cache_file._source_stamp
        self._cache_file, elsewhere = (
            CheckedFiles(str(base / inside), self._impl.filename_base, stamp) for base in (folder, shared)
        )
        if folder != shared:
            self._cache_file.shared = elsewhere

    def save_overload(self, signature, compiled):
        """Keep what was compiled, where that can be."""
        try:
            super().save_overload(signature, compiled)
        except OSError as error:
            _say_that_none_is_kept(numba.config.CACHE_DIR, error.strerror)


@cache  # once, though Numba resets what Python knows of warnings that were shown
def _say_that_none_is_kept(folder, why):
    warnings.warn(
        f"Compiled kernels cannot be kept in {folder} ({why}), so every process compiles them again; make "
        "room there, or name another folder in NUMBA_CACHE_DIR.",
        KernelsNotKept,
        stacklevel=3,
    )
