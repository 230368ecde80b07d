"""Arrays that take long to compute: computed once for the same arguments.

A figure's machines, its reference and its checks often need the same numbers: a picture by rays, a filtered
environment, the light that reaches a surface. A process keeps what it has computed. Where a folder is named
(``kept_in``), other processes find it too, until a source is edited that it depends on.
"""

import hashlib
import io
import os
import pickle
import tempfile
from collections import OrderedDict
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from functools import wraps
from pathlib import Path
from typing import Any, ParamSpec

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.source_digests import digest_of

P = ParamSpec("P")

_MOST = 1 << 27  # bytes of all results together; the one that was used longest ago goes first
# Bytes of all results in a folder. Assumed: as many as all figures need, twice.
_MOST_IN_FOLDER = 1 << 29
_ENDING, _DIGEST = ".array", 32  # bytes of sha256 before the array
_found: OrderedDict[bytes, NDArray[Any]] = OrderedDict()
_folder: Path | None = None


@contextmanager
def kept_in(folder: Path | None) -> Iterator[None]:
    """Inside, arrays are also stored in a folder, and looked up there. None: in this process alone."""
    global _folder
    before, _folder = _folder, folder
    try:
        yield
    finally:
        _folder = before


def computed_once(function: Callable[P, NDArray[Any]]) -> Callable[P, NDArray[Any]]:
    """A function that computes its array once for the same arguments; every call returns a copy.

    The array must follow from the arguments' values alone. The arguments must be of classes that pickle
    takes: arguments are the same if their pickles are.
    """

    @wraps(function)
    def once(*args: P.args, **kwargs: P.kwargs) -> NDArray[Any]:
        given = function.__module__, function.__qualname__, args, sorted(kwargs.items())
        key, modules = _digest(given)
        if key not in _found:
            _found[key] = kept_array(
                (key, *modules), (function.__module__, *modules), function, *args, **kwargs
            )
            while sum(array.nbytes for array in _found.values()) > _MOST and len(_found) > 1:
                _found.popitem(last=False)
        _found.move_to_end(key)
        return _found[key].copy()

    return once


def kept_array(
    key: object, modules: Iterable[str], function: Callable[..., NDArray[Any]], *args: Any, **kwargs: Any
) -> NDArray[Any]:
    """``function``'s array, from the folder if it is there; otherwise computed and stored there.

    key      the inputs of the array besides the sources; its ``repr`` counts
    modules  dotted names of the modules whose sources it follows from, with all that they import
    """
    if _folder is None:
        return function(*args, **kwargs)
    name = hashlib.sha256(f"{key!r} {digest_of(modules)}".encode()).hexdigest()[:32]
    path = _folder / f"{name}{_ENDING}"
    if (found := _read(path)) is None:
        found = function(*args, **kwargs)
        _write(path, found)
    return found


def _read(path):
    """The array in a file; None where there is none, or another than was written."""
    try:
        data = path.read_bytes()
        if hashlib.sha256(data[_DIGEST:]).digest() != data[:_DIGEST]:
            return None
        os.utime(path)  # it was used
        return np.load(io.BytesIO(data[_DIGEST:]), allow_pickle=False)
    except (OSError, ValueError):
        return None


def _write(path, array):
    """Keep an array, if there is room; those that were used longest ago go."""
    file = io.BytesIO()
    np.save(file, array, allow_pickle=False)
    data = file.getvalue()
    with suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, unfinished = tempfile.mkstemp(dir=path.parent)
        try:
            with open(handle, "wb") as out:
                out.write(hashlib.sha256(data).digest() + data)
            os.replace(unfinished, path)
        except OSError:
            os.unlink(unfinished)
            raise
        _make_room(path.parent)


def _make_room(folder):
    found = [(path.stat().st_mtime_ns, path.stat().st_size, path) for path in folder.glob(f"*{_ENDING}")]
    total = sum(size for _, size, _ in found)
    for _, size, path in sorted(found):
        if total <= _MOST_IN_FOLDER:
            return
        path.unlink(missing_ok=True)
        total -= size


def _digest(value):
    """Of a value's pickle; the contents of arrays are not copied for it. Second, the modules of fixedpipe
    whose classes and functions are in it, in order.
    """
    beside: list[pickle.PickleBuffer] = []
    file = io.BytesIO()
    pickler = _Pickler(file, protocol=5, buffer_callback=beside.append)
    pickler.dump(value)
    found = hashlib.blake2b(file.getvalue())
    for buffer in beside:
        found.update(buffer.raw())
    return found.digest(), tuple(sorted(pickler.modules))


class _Pickler(pickle.Pickler):
    """Notes the modules of what is pickled by its name: classes, enumerations, functions."""

    def __init__(self, *args, **kwargs):
        super().__init__(*args, **kwargs)
        self.modules = set()

    def reducer_override(self, value):
        module = getattr(value, "__module__", None) or ""
        if module.startswith("fixedpipe."):
            self.modules.add(module)
        return NotImplemented
