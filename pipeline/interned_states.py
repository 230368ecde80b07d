"""Equal states as one object, so that what is kept by identity is found for a state that was made anew.

Equal means the same bits and the same types: 0.0 and -0.0 may draw differently, and 1 is refused where True
is not. A state that a program makes for every Draw is looked at here before anything else is done for it, so
a microsecond counts.
"""

import marshal
from dataclasses import fields, is_dataclass
from enum import Enum
from operator import attrgetter, is_
from types import NoneType, UnionType
from typing import TypeVar, get_args, get_origin

from fixedpipe.pipeline.state import FinalCombiner, PassState

T = TypeVar("T")

_MOST = 4096  # objects that are remembered; then all are forgotten
_PLAIN = 2  # of marshal's versions: does not write whether two values are one object
# Parts that many states share, because dataclasses.replace keeps them.
_SHARED = (FinalCombiner,)
_CONSTANTS = {id(one): (one, one) for one in (None, False, True)}
_known: dict = dict(
    _CONSTANTS
)  # id of an object: the object itself, which keeps its id, and the first equal one
_by_value: dict = {}  # what an object is made of: the first that is
_layouts: dict = {}  # class: the _Layout of its objects


class _NoStateError(Exception):
    """A value that no annotation of ``fixedpipe.pipeline.state`` means."""


def interned(value: T) -> T:
    """The first object that equals a state, or a part of one, and has equal parts in common with others.

    What is no state, or holds what it must not, is returned as it is. So is a PassState that
    ``dataclasses.replace`` made of another: it differs from that, and costs more to look for than its parts.
    """
    found = _known.get(id(value))
    if found is not None:
        return found[1]
    if type(value) is PassState and _is_changed(value):
        return value
    try:
        return _first(value)
    except (_NoStateError, AttributeError, TypeError, ValueError):
        return value


def all_interned(values):
    """``interned`` of each value, in a list."""
    known = _known.get
    return [found[1] if (found := known(id(value))) else interned(value) for value in values]


def _is_changed(state):
    """Whether a state has its texture units, or its program's stages, in common with one that is known."""
    stages = getattr(state.register_combiners, "general", ())
    return any([shared and id(shared) in _known for shared in (state.texture_units, stages)])


def _first(value):
    """As ``interned`` for what is not known; raises what taking apart something else raises."""
    kind = type(value)
    if (layout := _layouts.get(kind)) is None:
        layout = _layouts[kind] = (
            _Row() if kind is tuple else _Member() if issubclass(kind, Enum) else _Layout(kind)
        )
    key, made = layout.apart(value)
    first = _by_value.get(key)
    if first is None:
        first = layout.checked(value, made)
        if len(_by_value) >= _MOST:
            _by_value.clear()
            _forget()
        _by_value[key] = first
        _known[id(first)] = first, first
    elif len(_known) >= _MOST:
        _forget()
    _known[id(value)] = value, first
    return first


def _forget():
    _known.clear()
    _known.update(_CONSTANTS)


def _firsts(parts):
    known = _known.get
    return tuple([found[1] if (found := known(id(part))) else _first(part) for part in parts])


class _Member:
    """A member of an enum is its own first."""

    def apart(self, value):
        return (Enum, id(value)), None

    def checked(self, value, made):
        return value


class _Row:
    """How tuples of states, or of members, are taken apart."""

    def apart(self, value):
        firsts = _firsts(value)
        return tuple(map(id, firsts)), firsts

    def checked(self, value, firsts):
        return value if all(map(is_, value, firsts)) else firsts


def _inner(annotation):
    """(the class that an annotation is of, or is tuples of; whether of tuples; whether it may be None)."""
    optional, several = get_origin(annotation) is UnionType, False
    while get_origin(annotation) in (UnionType, tuple):
        several |= get_origin(annotation) is tuple
        annotation = next(a for a in get_args(annotation) if a is not NoneType)
    return annotation, several, optional


class _Layout:
    """How objects of a class are taken apart: into numbers (and tuples of them, and None), strings, enum
    members, and parts: states that may be missing or that many have in common, and tuples. What else it holds
    is looked through: the values of that are among the others.
    """

    def __init__(self, kind):
        if not is_dataclass(kind):
            raise _NoStateError
        numbers, texts, members, through, parts, types = [], [], [], [], [], []

        def collect(owner, before):
            for field in fields(owner):
                (inner, several, optional), path = _inner(field.type), before + field.name
                if several and (is_dataclass(inner) or issubclass(inner, Enum)):
                    parts.append(path)
                elif is_dataclass(inner):
                    if optional or kind is PassState or inner in _SHARED:
                        parts.append(path)
                        continue
                    through.append(path)
                    types.append(inner)
                    collect(inner, f"{path}.")
                elif issubclass(inner, Enum):
                    members.append(path)
                else:
                    (texts if inner in (str, bytes) else numbers).append(path)

        collect(kind, "")
        paths = *numbers, *texts, *members, *through, *parts
        get = attrgetter(*paths)
        self._values = get if len(paths) > 1 else lambda value: (get(value),)
        self._kind, self._paths, self._types = kind, tuple(parts), tuple(types)
        self._numbers = len(numbers)
        self._texts = self._numbers + len(texts)
        self._members = self._texts + len(members)
        self._through = self._members + len(through)

    def apart(self, value):
        """What an object is made of, hashable; and its values, with the first of each of its parts."""
        values = self._values(value)
        if tuple(map(type, values[self._members : self._through])) != self._types:
            raise _NoStateError
        numbers = marshal.dumps(values[: self._numbers], _PLAIN)
        firsts = _firsts(values[self._through :])
        ids = tuple(map(id, values[self._texts : self._members] + firsts))
        return (self._kind, numbers, values[self._numbers : self._texts], ids), (values, numbers, firsts)

    def checked(self, value, made):
        """The object with the first of each of its parts. Its key is of no other then: ``marshal`` writes
        what it does not know as bytes, and the id of what is no member may be another's later.
        """
        values, numbers, firsts = made
        for member in values[self._texts : self._members]:
            if member is not None and not isinstance(member, Enum):
                raise _NoStateError
        for text in values[self._numbers : self._texts]:
            if text is not None and type(text) not in (str, bytes):
                raise _NoStateError
        if marshal.loads(numbers) != values[: self._numbers]:
            raise _NoStateError
        if all(map(is_, values[self._through :], firsts)):
            return value
        return _with_parts(value, dict(zip(self._paths, firsts, strict=True)))


def _with_parts(value, firsts):
    """The object with other parts, by their dotted paths."""
    inner = {}
    for path, first in firsts.items():
        name, _, rest = path.partition(".")
        if rest:
            inner.setdefault(name, {})[rest] = first
        else:
            inner[name] = first
    # As ``dataclasses.replace``, in a third of its time: nothing is computed from a state's fields.
    made = object.__new__(type(value))
    for name in type(value).__slots__:
        part = inner.get(name, inner)
        if part is inner:
            part = getattr(value, name)
        elif type(part) is dict:
            part = _with_parts(getattr(value, name), part)
        object.__setattr__(made, name, part)
    return made
