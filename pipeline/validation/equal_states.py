"""States that are equal are one: who makes the same state anew for every Draw, as real programs do, finds
what is known of it.

Equal here means of the same types and the same bits, throughout: 1, 1.0 and True are three values, 0.0 and
-0.0 are two. So what was found of a state holds for every equal one.
"""

import math
import operator
import threading
from dataclasses import fields, is_dataclass
from typing import Any

from fixedpipe.pipeline.state import PassState

_MOST = 1 << 14  # values that are held: then all are forgotten
_lock = threading.Lock()
# By identity, which stays a value's own since it is held: the value, its first equal, and the key of both.
_seen: dict[int, tuple[Any, Any, Any]] = {}
_firsts: dict[Any, Any] = {}  # by keys


def first_equal(state: PassState) -> PassState:
    """The first state that equals this one, made of parts that are the first that equal its own. What is no
    value of a state's, an array for instance, equals itself alone.
    """
    found = _seen.get(id(state))
    if found is not None:
        return found[1]
    with _lock:
        if len(_seen) >= _MOST:
            _seen.clear()
            _firsts.clear()
        return _first(state)[0]


def _first(value):
    """The first equal of a dataclass or tuple, and its key; of anything else itself."""
    kind = value.__class__
    if kind is float:
        return value, value or (0.0, math.copysign(1.0, value))
    if kind in _LEAVES:
        return value, (kind, value)
    found = _seen.get(id(value))
    if found is not None:
        return found[1:]
    return _PARTS[kind](value)


def _tuple(value):
    return _of_parts(value, value, tuple)


def _dataclass(kind):
    names = tuple([field.name for field in fields(kind)])

    def first(value):
        return _of_parts(value, [getattr(value, name) for name in names], lambda parts: kind(*parts))

    return first


def _of_parts(value, parts, made):
    """The first equal of a value with these parts, and its key; ``made``: of a list of parts, such a value.

    A part's key is a number that stands for its first equal, as long as that is held.
    """
    given = [_first(part) for part in parts]
    key = (value.__class__, *[key for _, key in given])
    first = _firsts.get(key)
    if first is None:
        firsts = [part for part, _ in given]
        own = all(map(operator.is_, parts, firsts))
        first = _firsts[key] = value if own else made(firsts)
        _seen[id(first)] = first, first, _held(first)
    _seen[id(value)] = value, first, _held(first)
    return first, _held(first)


def _held(value):
    return "held", id(value)


def _by_itself(value):
    """Of an enum's member, which is one, and of what no state has."""
    return value, _held(value)


class _Parts(dict):
    """For each class the function that finds the first equal of its values, made when it is asked for."""

    def __missing__(self, kind):
        found = self[kind] = _dataclass(kind) if is_dataclass(kind) else _by_itself
        return found


_LEAVES = frozenset({int, bool, str, bytes, type(None)})
_PARTS = _Parts({tuple: _tuple})
