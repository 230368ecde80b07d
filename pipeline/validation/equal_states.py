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
# By identity, which stays a value's own since it is held: the value, and its first equal.
_seen: dict[int, tuple[Any, Any]] = {}
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
        return _first(state)


def _first(value):
    """The first equal of a dataclass or tuple."""
    parts = _PARTS_OF[value.__class__](value)
    key, firsts, own = [value.__class__], [], True
    # A key begins a part with its class, and so no two sequences of parts have one; but a float is its own.
    for part in parts:
        kind = part.__class__
        if kind is float:
            key.append(part or (0.0, math.copysign(1.0, part)))
        elif kind in _LEAVES:
            key += kind, part
        elif kind in _PARTS_OF:
            found = _seen.get(id(part))
            first = _first(part) if found is None else found[1]
            own = own and first is part
            key += kind, id(first)  # its own for as long as it is held
            firsts.append(first)
            continue
        elif is_dataclass(kind):
            _PARTS_OF[kind] = _fields_of(kind)
            return _first(value)
        else:  # an enum's member, which is one, and what no state has
            key += kind, id(part)
        firsts.append(part)
    key = tuple(key)
    first = _firsts.get(key)
    if first is None:
        made = tuple if value.__class__ is tuple else lambda parts: value.__class__(*parts)
        first = _firsts[key] = value if own else made(firsts)
        _seen[id(first)] = first, first
    _seen[id(value)] = value, first
    return first


def _fields_of(kind):
    """A function of such a dataclass that gives its fields' values."""
    names = [field.name for field in fields(kind)]
    if len(names) == 1:
        return lambda value: (getattr(value, names[0]),)
    return operator.attrgetter(*names) if names else lambda value: ()


_LEAVES = frozenset({int, bool, str, bytes, type(None)})
# By class, what a value of it is made of.
_PARTS_OF = {tuple: lambda value: value, PassState: _fields_of(PassState)}
