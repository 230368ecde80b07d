"""JSON read as values of annotated types: enumerations by name, numbers, tuples, dataclasses.

A number may also be a string, where JSON's decimals would be long or inexact: a fraction, "200/255", or the
bits of a single-precision number, "0x3f800000".
"""

import json
import re
import struct
from dataclasses import MISSING, fields, is_dataclass
from enum import Enum
from functools import cache
from types import NoneType, UnionType
from typing import Any, NoReturn, Union, get_args, get_origin, get_type_hints

from fixedpipe.effects.refusal import Refusal, nearest
from fixedpipe.pipeline.messages import shown

FRACTION, SINGLE = r"-?[0-9]{1,15}/[1-9][0-9]{0,14}", r"0x[0-9a-fA-F]{8}"
_FRACTION, _SINGLE = re.compile(FRACTION), re.compile(SINGLE)
_MOST_SHOWN = 12  # names that a sentence lists
_NUMBER = 'give a number, a fraction as "200/255", or a single\'s bits as "0x3f800000"'


def wrong(path: str, given: Any, wanted: str) -> NoReturn:
    """Raise Refusal for a value: ``path`` names it, ``wanted`` says what to do."""
    raise Refusal(f"{path} is {shown(given)}; {wanted}.")


def read_json(text: str, name: str) -> Any:
    """The value of a JSON text. ``name``: of the text, for sentences.

    Raises Refusal for invalid JSON, for a key that an object has twice, for NaN and infinities (which JSON
    lacks), and for brackets or numbers too long to be read.
    """

    def once(pairs):
        found = dict(pairs)
        if len(found) != len(pairs):
            keys = [key for key, _ in pairs]
            twice = next(key for key in keys if keys.count(key) > 1)
            raise Refusal(f"{name} gives {shown(twice)} twice in one object; give it once.")
        return found

    def no_number(word):
        raise Refusal(
            f'{name} has the number {word}, which JSON lacks; write a single\'s bits, "0x7f800000".'
        )

    try:
        return json.loads(text, object_pairs_hook=once, parse_constant=no_number)
    except Refusal:
        raise
    except json.JSONDecodeError as error:
        raise Refusal(f"{name}, line {error.lineno}, is no JSON: {error.msg}. Correct it there.") from error
    except RecursionError:
        raise Refusal(f"{name} nests its brackets too deeply; a state has about eight levels.") from None
    except ValueError:
        raise Refusal(f"{name} has a number of thousands of digits; give at most 17.") from None


def read_object(given: Any, path: str, known: Any, required: Any = ()) -> dict[str, Any]:
    """``given`` where it is an object with no other keys than ``known`` and all ``required`` ones. Raises
    Refusal.
    """
    if not isinstance(given, dict):
        wrong(path, given, "give an object, as {}")
    for key in given:
        if key not in known:
            names = ", ".join(list(known)[:_MOST_SHOWN]) + " ..." * (len(known) > _MOST_SHOWN)
            raise Refusal(f"{path} has no {shown(key)}.{nearest(key, known)} It takes: {names}.")
    for key in required:
        if key not in given:
            raise Refusal(f"{path} lacks {key!r}; give it.")
    return given


def read_list(given: Any, path: str, most: int) -> list[Any]:
    """``given`` where it is a list of at most ``most`` elements. Raises Refusal."""
    if not isinstance(given, list):
        wrong(path, given, "give a list, as []")
    if len(given) > most:
        raise Refusal(f"{path} has {len(given)} elements; a small state has at most {most}. Give fewer.")
    return given


def read_value(kind: Any, given: Any, path: str) -> Any:
    """A value of an annotated type. ``path`` names it in sentences. Raises Refusal."""
    return _reader(kind)(given, path)


@cache
def _reader(kind):
    if kind in _PLAIN:
        return _PLAIN[kind]
    if get_origin(kind) in (UnionType, Union):
        return _union(get_args(kind))
    if get_origin(kind) is tuple:
        return _tuple(get_args(kind))
    if is_dataclass(kind):
        return _fields(kind)
    assert issubclass(kind, Enum), f"states have no values of type {kind}"
    return _member(kind)


def _number(given, path):
    if type(given) in (int, float):
        try:
            return float(given)
        except OverflowError:
            pass
    text = given if isinstance(given, str) else ""
    if _FRACTION.fullmatch(text):
        above, below = text.split("/")
        return int(above) / int(below)
    if _SINGLE.fullmatch(text):
        return struct.unpack("<f", struct.pack("<I", int(text, 16)))[0]
    wrong(path, given, _NUMBER)


def _whole(given, path):
    if type(given) is not int or abs(given) >= 2**31:
        wrong(path, given, "give a whole number of at most 31 bits")
    return given


def _switch(given, path):
    if not isinstance(given, bool):
        wrong(path, given, "it is a switch: give true or false")
    return given


def _text(given, path):
    if not (isinstance(given, str) and given.strip()):
        wrong(path, given, "give a text in quotation marks")
    return given


def _bytes(given, path):
    if not (isinstance(given, str) and re.fullmatch(r"(?:[0-9a-fA-F]{2})+", given)):
        wrong(path, given, 'give two hexadecimal digits a byte, as "00ff"')
    return bytes.fromhex(given)


def _nothing(given, path):
    if given is not None:
        wrong(path, given, "give null")


_PLAIN = {
    float: _number,
    int: _whole,
    bool: _switch,
    str: _text,
    bytes: _bytes,
    NoneType: _nothing,
}


def _member(kind):
    def read(given, path):
        name = given if isinstance(given, str) else ""
        if name in kind.__members__:
            return kind[name]
        names = list(kind.__members__)
        listed = ", ".join(names[:_MOST_SHOWN]) + " ..." * (len(names) > _MOST_SHOWN)
        meant = nearest(name, names)
        raise Refusal(
            f"{path} is {shown(given)}, which names no {kind.__name__}.{meant} There are: {listed}."
        )

    return read


def _union(kinds):
    """A value of one type, or null."""
    (kind,) = (kind for kind in kinds if kind is not NoneType)

    def read(given, path):
        return None if given is None else read_value(kind, given, path)

    return read


def _tuple(kinds):
    count = None if kinds[-1] is Ellipsis else len(kinds)

    def read(given, path):
        if not isinstance(given, list):
            wrong(path, given, f"give a list{'' if count is None else f' of {count}'}")
        if count is not None and len(given) != count:
            raise Refusal(f"{path} has {len(given)} elements; give {count}.")
        of = kinds if count is not None else kinds[:1] * len(given)
        return tuple(read_value(k, v, f"{path}[{n}]") for n, (k, v) in enumerate(zip(of, given, strict=True)))

    return read


def _fields(kind):
    def read(given, path):
        types = get_type_hints(kind)
        needed = [f.name for f in fields(kind) if f.default is MISSING and f.default_factory is MISSING]
        given = read_object(given, path, [f.name for f in fields(kind)], needed)
        return kind(
            **{name: read_value(types[name], value, f"{path}.{name}") for name, value in given.items()}
        )

    return read
