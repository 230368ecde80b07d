"""Validation of types: values agree with their annotations.

Annotations are bools, numbers, strings, bytes, enums, tuples, dataclasses, arrays and functions. The module's
only fact of graphics is that OpenGL's integers have 32 bits.
"""

import math
from dataclasses import fields, is_dataclass
from enum import Enum
from numbers import Integral, Real
from types import NoneType, UnionType
from typing import Literal, NamedTuple, Union, get_args, get_origin

import numpy as np

from fixedpipe.pipeline.messages import shown
from fixedpipe.pipeline.validation.remembered import Remembered


class Wrong(NamedTuple):
    """What is wrong with a value: the path of fields to it, and the predicate of the sentence."""

    path: str
    predicate: str

    def below(self, field):
        """The same finding, seen from the value that holds this one in ``field``."""
        return Wrong(field + self.path, self.predicate)


def enum_check(kind):
    """A check that a value is a member of the enum ``kind``."""
    example = f"{kind.__name__}.{next(iter(kind)).name}"

    def check(value):
        if isinstance(value, kind):
            return None
        if isinstance(value, str) and value.upper() in kind.__members__:
            return Wrong("", f"is the string {value!r}; give the member {kind.__name__}.{value.upper()}")
        return Wrong("", f"is {shown(value)}; it takes a member of {kind.__name__}, {example} for instance")

    return check


def _check_bool(value):
    if isinstance(value, bool | np.bool_):
        return None
    return Wrong("", f"is {shown(value)}; it is a switch: give True or False")


def check_int(value):
    """None for a 32-bit integer, as OpenGL's are; else what is wrong with the value."""
    if isinstance(value, Integral) and not isinstance(value, bool):
        if -(2**31) <= value < 2**31:
            return None
        return Wrong("", f"is {value}; OpenGL's integers have 32 bits: give one from -2**31 to 2**31 - 1")
    return Wrong("", f"is {shown(value)}; give an integer")


def _check_float(value):
    if type(value) is float and math.isfinite(value):
        return None
    if isinstance(value, Real) and not isinstance(value, bool):
        try:
            finite = math.isfinite(value)
        except OverflowError:  # The integer exceeds every float.
            finite = False
        return None if finite else Wrong("", f"is {shown(value)}; give a finite number")
    return Wrong("", f"is {shown(value)}; give a number")


def _check_str(value):
    if not isinstance(value, str):
        return Wrong("", f"is {shown(value)}; give a string")
    return None if value.strip() else Wrong("", "is empty; give it a name")


def _fixed_tuple_check(kinds, checks):
    checks = [checks[kind] for kind in kinds]
    n, floats = len(kinds), (float,) * len(kinds)
    all_floats = kinds == floats

    def check(value):
        plain = all_floats and type(value) is tuple and tuple(map(type, value)) == floats  # most are
        if plain and math.isfinite(sum(value)):
            return None
        if not isinstance(value, tuple):
            return Wrong("", f"is {shown(value)}; give a tuple of {n}")
        if len(value) != n:
            return Wrong("", f"has {len(value)} elements; give {n}")
        for i, v in enumerate(value):
            if wrong := checks[i](v):
                return wrong.below(f"[{i}]")
        return None

    return check


def _long_tuple_check(check_one):
    def check(value):
        if not isinstance(value, tuple):
            return Wrong("", f"is {shown(value)}; give a tuple")
        for i, v in enumerate(value):
            if wrong := check_one(v):
                return wrong.below(f"[{i}]")
        return None

    return check


def _dataclass_check(kind, checks):
    # Most fields hold their default, which needs no check.
    checks = [(f.name, f.default, checks[f.type]) for f in fields(kind)]

    def check(value):
        if not isinstance(value, kind):
            return Wrong("", f"is {shown(value)}; give a value of type {kind.__name__}")
        for name, default, check_field in checks:
            given = getattr(value, name)
            if given is not default and (wrong := check_field(given)):
                return wrong.below(f".{name}")
        return None

    return check


def _remembering(check):
    """The same check, which checks each object once."""
    right = Remembered()

    def check_once(value):
        if id(value) in right:
            return None
        if wrong := check(value):
            return wrong
        right.add(value)
        return None

    return check_once


def _optional_check(check_present):
    def check(value):
        return None if value is None else check_present(value)

    return check


def _check_bytes(value):
    return None if isinstance(value, bytes) else Wrong("", f"is {shown(value)}; give bytes")


def instance_check(kind):
    """A check that a value is of type ``kind``; it does not look inside."""

    def check(value):
        if isinstance(value, kind):
            return None
        return Wrong("", f"is {shown(value)}; give a value of type {kind.__name__}")

    return check


def _class_of(annotation):
    """The class of a generic annotation, also behind an alias, as NDArray is from NumPy 2.5 on."""
    origin = get_origin(annotation)
    return get_origin(getattr(origin, "__value__", None)) or origin


class TypeChecks(dict):
    """A check for each annotation, made at first use: a function from a value to None, or to a Wrong.

    - ``whole``: classes whose fields are not checked.
    - ``shared``: dataclasses that many values share; each object of these is checked once.
    """

    def __init__(self, whole=(), shared=()):
        super().__init__(
            {bool: _check_bool, int: check_int, float: _check_float, str: _check_str, bytes: _check_bytes}
        )
        self.whole, self.shared = whole, shared

    def __missing__(self, annotation):
        check = self[annotation] = self._made(annotation)
        return check

    def _made(self, annotation):
        if get_origin(annotation) in (UnionType, Union):  # Union: a Literal or None
            (present,) = (a for a in get_args(annotation) if a is not NoneType)
            return _optional_check(self[present])
        if get_origin(annotation) is tuple:
            inner = get_args(annotation)
            if inner[-1] is Ellipsis:
                return _long_tuple_check(self[inner[0]])
            return _fixed_tuple_check(inner, self)
        if get_origin(annotation) is Literal:  # The command's own validation knows which strings are allowed.
            return self[type(get_args(annotation)[0])]
        if get_origin(annotation) is not None:  # An array or a function: its contents are not checked.
            return instance_check(_class_of(annotation))
        if issubclass(annotation, Enum):
            return enum_check(annotation)
        if is_dataclass(annotation) and annotation not in self.whole:
            check = _dataclass_check(annotation, self)
            return _remembering(check) if annotation in self.shared else check
        return instance_check(annotation)
