"""The files in which a compiled kernel is kept: Numba's, with digests, so that a damaged one counts as none.

Numba unpickles what it finds. Measured, of 83 ways to damage a file of two small kernels: what is cut raises
whatever pickle comes upon, a bit that is turned may end the process by a signal, another kernel's data is run
in the place of this one's. It also writes an index before the data, which names older code where a process is
killed between the two. Here an index begins with a digest of what follows and of whose it is, and holds a
digest of each data file; what does not fit is not there, and is compiled and written again.
"""

import hashlib
import os
import pickle
import re
import warnings
from contextlib import suppress
from functools import cache, partial
from pathlib import Path

from numba.core.caching import CompileResultCacheImpl, FunctionCache, IndexDataCacheFile

_DIGEST = 32  # bytes of sha256
_FORMAT = 2  # of index and data files
_PACKAGE = Path(__file__).parents[1]
_IMPORTED = re.compile(rb"^from fixedpipe\.([\w.]+) import", re.MULTILINE)
_KERNELS = b"fixedpipe.raster.kernel import"  # in a file that has some


class KernelsNotKept(UserWarning):
    """Compiled kernels could not be written to the folder in which they are kept."""


class CheckedFiles(IndexDataCacheFile):
    """An index and its data files. Where Numba has a data file's name for a key, this has its digest too.

    Nothing that is wrong with a file raises: it is then as if it were not there.
    """

    def load(self, key):
        """What was saved for a key; None where that is not there, whole and its own."""
        data = self.bytes_of(key)
        return None if data is None else pickle.loads(data)

    def bytes_of(self, key):
        """The same, pickled."""
        name, digest = self._load_index().get(key, (None, None))
        if name is None:
            return None
        data = self._read(name)
        return data if hashlib.sha256(data).digest() == digest else None

    def saved(self):
        """The keys for which something was saved."""
        return list(self._load_index())

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
        whose = repr((_FORMAT, self._index_name, self._source_stamp, self._version)).encode()
        return hashlib.sha256(whose + data).digest()

    def _read(self, name):
        """A file's bytes; none where it cannot be read."""
        try:
            with open(self._data_path(name), "rb") as file:
                return file.read()
        except OSError:
            return b""


@cache
def _digest_of_sources(path):
    """A digest of a source file, as it was when this process first asked, and of the files with kernels that
    it imports: their kernels and constants become part of its own. Those of ``raster/`` name the folder.
    """
    text = Path(path).read_bytes()
    digest = hashlib.sha256(text)
    for name in sorted({name.decode() for name in _IMPORTED.findall(text)}):
        file = _PACKAGE.joinpath(*name.split(".")).with_suffix(".py")
        if _PACKAGE / "raster" not in file.parents and file.is_file() and _KERNELS in file.read_bytes():
            digest.update(_digest_of_sources(file).encode())
    return digest.hexdigest()


class _Place(CompileResultCacheImpl._locator_classes[0]):
    """Where a kernel's files lie in a folder of kernels, and what they are of.

    Numba's own names folders after the sources' absolute paths, and some versions of it compare times of
    change. Here a folder has the module's name, and files carry a digest of the source. So another checkout
    of the same sources has the same kernels.
    """

    def __init__(self, function, path):
        self._py_file, self._lineno = path, function.__code__.co_firstlineno
        self._cache_path = os.path.join(*function.__module__.split("."))

    @classmethod
    def from_function(cls, function, path, folder):
        """The place of a function's kernels, whether or not it can be written."""
        found = cls(function, path)
        found._cache_path = os.path.join(folder, found._cache_path)
        return found

    def get_source_stamp(self):
        """A digest of the sources that the function may be made of."""
        return _digest_of_sources(self._py_file)


class _Compiled(CompileResultCacheImpl):
    def __init__(self, function, folder):
        self._locator_classes = [_In(folder)]
        super().__init__(function)


class _In:
    """Numba asks a class for a place; this one knows the folder."""

    def __init__(self, folder):
        self.from_function = partial(_Place.from_function, folder=folder)


class KernelCache(FunctionCache):
    """A kernel's files in a folder; where that cannot be written, the kernel is compiled and not kept, and a
    warning says so, once.

    What the folder lacks is read from ``others``, which are folders too, and then from ``packs()``. What is
    compiled is kept in ``mirror`` as well, one of the others, where that can be written.

    name  that it has in packs: its place, and a digest of its source
    """

    def __init__(self, function, folder, others=(), mirror=None, packs=tuple):
        self._impl_class = partial(_Compiled, folder=folder)
        super().__init__(function)
        self._folder, self._packs = folder, packs
        inside = Path(self._cache_path).relative_to(folder)
        stamp, base = self._cache_file._source_stamp, self._impl.filename_base
        self.name = f"{(inside / base).as_posix()} {stamp}"
        self._cache_file = CheckedFiles(str(folder / inside), base, stamp)
        self._others = [CheckedFiles(str(other / inside), base, stamp) for other in others]
        self._mirror = CheckedFiles(str(mirror / inside), base, stamp) if mirror else None

    def _load_overload(self, signature, target_context):
        key = self._index_key(signature, target_context.codegen())
        found = None
        for files in (self._cache_file, *self._others):
            found = files.load(key) if found is None else found
        for pack in self._packs() if found is None else ():
            found = pack.load(self.name, key) if found is None else found
        return None if found is None else self._impl.rebuild(target_context, found)

    def save_overload(self, signature, compiled):
        """Keep what was compiled, where that can be."""
        try:
            super().save_overload(signature, compiled)
        except OSError as error:
            _say_that_none_is_kept(self._folder, error.strerror)

    def _save_overload(self, signature, compiled):
        super()._save_overload(signature, compiled)
        if self._mirror:
            key = self._index_key(signature, compiled.codegen)
            with suppress(OSError):  # the user's folder is full, or another user's
                Path(self._mirror._cache_path).mkdir(parents=True, exist_ok=True)
                self._mirror.save(key, self._impl.reduce(compiled))

    def kept_for(self, processor, features):
        """(key, pickled bytes) of what the folders have for a processor that Numba compiles for."""
        found = {}
        for files in (self._cache_file, *self._others):
            for key in files.saved():
                if key[1][1:] == (processor, features) and key not in found:
                    found[key] = files.bytes_of(key)
        return [(key, data) for key, data in found.items() if data is not None]


@cache  # once, though Numba resets what Python knows of warnings that were shown
def _say_that_none_is_kept(folder, why):
    warnings.warn(
        f"Compiled kernels cannot be kept in {folder} ({why}), so every process compiles them again; make "
        "room there, or name another folder in NUMBA_CACHE_DIR.",
        KernelsNotKept,
        stacklevel=3,
    )
