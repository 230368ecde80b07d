"""Equal commands of two frames as one object, so that what is known of the one holds for the other.

A scene is often made once for a machine and once for the ideal, and most of its commands are equal. Equal
means what it does for states (``fixedpipe.pipeline.interned_states``): the same bits and the same types.
"""

from collections.abc import Sequence
from dataclasses import fields, is_dataclass
from math import copysign
from operator import attrgetter
from typing import Any

import numpy as np

from fixedpipe.pipeline.commands import Command
from fixedpipe.pipeline.interned_states import interned
from fixedpipe.pipeline.state import PassState

_PLAIN = frozenset({str, bytes, int, bool})
_getters: dict[type, Any] = {}  # class of dataclasses: the function that gives all fields of an object


def in_common(commands: Sequence[Command], others: Sequence[Command]) -> tuple[Command, ...]:
    """``commands``; each that equals the one of ``others`` at its place is that object."""
    equal = _Equal()
    shared = [other if equal(one, other) else one for one, other in zip(commands, others, strict=False)]
    return (*shared, *commands[len(shared) :])


class _Equal:
    """Whether two values are equal; parts that many commands share are compared once."""

    def __init__(self):
        self._known = {}  # ids of two objects, which their commands keep: whether they are equal

    def __call__(self, one, other):
        if one is other:
            return True
        kind = type(one)
        if kind is not type(other):
            return False
        if kind in _PLAIN:
            return one == other
        if kind is float:  # A NaN equals nothing.
            return one == other and copysign(1.0, one) == copysign(1.0, other)
        if kind is tuple:
            return len(one) == len(other) and all(map(self, one, other))
        if kind is np.ndarray:
            same = one.dtype == other.dtype and one.shape == other.shape
            return same and one.dtype != object and one.tobytes() == other.tobytes()
        if kind is PassState and interned(one) is interned(other):
            return True
        return is_dataclass(kind) and self._have_equal_fields(kind, one, other)

    def _have_equal_fields(self, kind, one, other):
        key = id(one), id(other)
        found = self._known.get(key)
        if found is None:
            if (get := _getters.get(kind)) is None:
                get = _getters[kind] = attrgetter(*(field.name for field in fields(kind)))
            found = self._known[key] = self(get(one), get(other))
        return found
