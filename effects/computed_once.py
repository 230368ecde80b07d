"""Arrays that take long to compute: computed once for the same arguments.

A figure's machines, its reference and its checks often need the same numbers: a picture by rays, a filtered
environment, the light that reaches a surface.
"""

import hashlib
import pickle
from collections import OrderedDict
from collections.abc import Callable
from functools import wraps
from typing import Any, ParamSpec

from numpy.typing import NDArray

P = ParamSpec("P")

_MOST = 1 << 27  # bytes of all results together; the one that was used longest ago goes first
_found: OrderedDict[bytes, NDArray[Any]] = OrderedDict()


def computed_once(function: Callable[P, NDArray[Any]]) -> Callable[P, NDArray[Any]]:
    """A function that computes its array once for the same arguments; every call returns a copy.

    The array must follow from the arguments' values alone. The arguments must be of classes that pickle
    takes: arguments are the same if their pickles are.
    """

    @wraps(function)
    def once(*args: P.args, **kwargs: P.kwargs) -> NDArray[Any]:
        key = _digest((function.__module__, function.__qualname__, args, sorted(kwargs.items())))
        if key not in _found:
            _found[key] = function(*args, **kwargs)
            while sum(array.nbytes for array in _found.values()) > _MOST and len(_found) > 1:
                _found.popitem(last=False)
        _found.move_to_end(key)
        return _found[key].copy()

    return once


def _digest(value):
    """Of a value's pickle; the contents of arrays are not copied for it."""
    beside: list[pickle.PickleBuffer] = []
    found = hashlib.blake2b(pickle.dumps(value, protocol=5, buffer_callback=beside.append))
    for buffer in beside:
        found.update(buffer.raw())
    return found.digest()
