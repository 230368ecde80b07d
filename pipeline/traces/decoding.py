"""Decodes a trace, one event after another: bytes to names, arguments and results.

    event = 00 thread signature details     a call is entered; with the thread from version 4 on
          | 01 number details               a call is left; its number names it
    details: pairs of a tag and its data, up to the tag 00

The text of a signature (of a function, an enumeration, a bitmask, a structure) follows its number where the
number occurs first. Later the number occurs alone. Numbers are groups of 7 bits, the lowest first.

Source: apitrace's docs/FORMAT.markdown. apitrace's reader, lib/trace/trace_parser.cpp, differs from it in two
points; the files agree with the reader. A structure's signature has a name. Before version 3 an enumeration's
signature has one name and one value, and no value follows it.
"""

import struct
import sys

from fixedpipe.pipeline.traces.containers import TraceError
from fixedpipe.pipeline.traces.tags import (
    ARGUMENT,
    ARRAY,
    BACKTRACE,
    BITMASK,
    BLOB,
    DOUBLE,
    END,
    ENUM,
    FALSE,
    FLAGS,
    FLOAT,
    FRAME_NUMBERS,
    FRAME_STRINGS,
    NAMED_ENUMS,
    NEGATIVE,
    NULL,
    OPAQUE,
    REPR,
    RESULT,
    STRING,
    STRUCT,
    THREAD,
    THREADS,
    TRUE,
    UNSIGNED,
    WIDE_STRING,
)

_UNSIGNED = (UNSIGNED, OPAQUE)
# The most bytes of an event. Assumed: no machine here has more than 64 MB of memory, and no call passes more
# than twice as many bytes.
LARGEST_EVENT = 128 << 20
# The most values in the arrays and structures of an event; each takes up to 64 bytes in memory.
# Measured: at most 398. Assumed: images and vertices are always blobs.
MOST_VALUES = 1 << 20
# The deepest nesting of arrays. Assumed: programs have two or three levels.
DEEPEST = 32
# The most arguments of a function, and the most names in another signature. Measured: at most 10, and 3,514
# for an enumeration.
MOST_ARGUMENTS, MOST_NAMES = 255, 1 << 16
# The most bytes of all signatures, and signatures of one kind. Measured: 104,043 bytes in the traces of
# `shared`.
MOST_SIGNATURE_BYTES, MOST_SIGNATURES = 4 << 20, 1 << 19

_float, _double = struct.Struct("<f").unpack_from, struct.Struct("<d").unpack_from
# For arrays of up to 64 floats; a tag precedes each float.
_FLOAT_TAGS = [bytes([FLOAT]) * count for count in range(65)]
_FLOATS = [struct.Struct("<" + "xf" * count).unpack_from for count in range(65)]


class CutError(Exception):
    """An event does not end within the data. ``args[0]``: how many bytes it has at least."""


class DamageError(TraceError):
    """Data that make no sense. ``args``: the beginning of a sentence, and the place in the data."""


def varint(data: bytes, at: int) -> tuple[int, int]:
    """(a number of at most 64 bits, where it ends).

    Raises IndexError if the data end before the number does, and DamageError for more bits.
    """
    value = data[at]
    if value < 0x80:
        return value, at + 1
    value &= 0x7F
    for shift in range(7, 70, 7):
        byte = data[at + shift // 7]
        value |= (byte & 0x7F) << shift
        if byte < 0x80:
            if value >> 64:
                break
            return value, at + shift // 7 + 1
    raise DamageError("A number has more than 64 bits", at)


class Decoder:
    """Decodes the events of one trace, and stores the signatures so far.

    Its methods take the data and a place where to begin, and return where they ended. If the data end too
    early they raise CutError, IndexError or struct.error. Then call ``forget``, which removes the signatures
    in ``learned``, and decode the event again with more data. Empty ``learned`` after each event. Wrong data
    raise DamageError.

    version     the version of the format, 1 to 6
    enum_names  {value: the first name that an enumeration gave it}
    values      how many values the arrays and structures of the last event had
    """

    def __init__(self, version: int):
        self.version = version
        self.enum_names: dict[int, str] = {}
        self.functions: dict[int, tuple[str, list[None]]] = {}
        self.enums: dict[int, int | None] = {}
        # The enumerations whose number is followed by a value.
        self._named = self.enums if version >= NAMED_ENUMS else {}
        self.bitmasks: dict[int, None] = {}
        self.structs: dict[int, list[str]] = {}
        self.frames: dict[int, None] = {}
        # (table, number, bytes) of each signature whose text is in this event.
        self.learned: list[tuple[dict, int, int]] = []
        # The number of values in this event's arrays and structures.
        self.values = 0
        self._signature_bytes = 0
        self._begin = 0
        self._readers = {
            NULL: lambda data, at, depth: (None, at),
            FALSE: lambda data, at, depth: (False, at),
            TRUE: lambda data, at, depth: (True, at),
            NEGATIVE: self._negative,
            UNSIGNED: lambda data, at, depth: varint(data, at),
            FLOAT: lambda data, at, depth: (_float(data, at)[0], at + 4),
            DOUBLE: lambda data, at, depth: (_double(data, at)[0], at + 8),
            STRING: lambda data, at, depth: self.string(data, at),
            BLOB: lambda data, at, depth: self.blob(data, at),
            ENUM: self._enum if version >= NAMED_ENUMS else self._old_enum,
            BITMASK: self._bitmask,
            ARRAY: self._array,
            STRUCT: self._struct,
            OPAQUE: lambda data, at, depth: varint(data, at),
            REPR: self._repr,
            WIDE_STRING: self._wide_string,
        }

    # ------------------------------------------------------------------------------------------- events

    def enter(self, data: bytes, at: int) -> tuple:
        """(name, arguments, result, flags, thread, end) of the event at ``at``, which begins with ENTER."""
        self._begin, self.values, thread = at, 0, 0
        at += 1
        if self.version >= THREADS:
            thread, at = varint(data, at)
        number, at = varint(data, at)
        name, blank = self.functions.get(number) or (None, None)
        if blank is None:
            begin = at
            name, at = self.string(data, at)
            names, at = self._names(data, at, MOST_ARGUMENTS)
            blank = [None] * len(names)
            self._learn(self.functions, number, (name, blank), begin, at)
        arguments = blank.copy()
        result, flags, said, at = self._details(data, at, arguments)
        return name, arguments, result, flags, thread if said is None else said, at

    def leave(self, data: bytes, begin: int, at: int, arguments: list) -> tuple:
        """(result, flags, thread or None, end) of the event at ``begin``. Its details begin at ``at``; they
        set elements of ``arguments``.
        """
        self._begin, self.values = begin, 0
        return self._details(data, at, arguments)

    def _details(self, data, at, arguments):
        """(result, flags, thread or None, end) of details. They set elements of ``arguments``."""
        result, flags, thread, count = None, 0, None, len(arguments)
        named = self._named
        while True:
            tag = data[at]
            if tag == ARGUMENT:
                index = data[at + 1]
                if index < 0x80:
                    at += 2
                else:
                    index, at = varint(data, at + 1)
                # The most frequent kinds of values are read here, without a function call.
                tag = data[at]
                if tag == FLOAT:
                    (value,) = _float(data, at + 1)
                    at += 5
                elif tag in _UNSIGNED:
                    value = data[at + 1]
                    if value < 0x80:
                        at += 2
                    else:
                        value, at = varint(data, at + 1)
                elif (
                    tag == ENUM and data[at + 1] < 0x80 and data[at + 1] in named and data[at + 2] == UNSIGNED
                ):
                    value, at = varint(data, at + 3)
                else:
                    value, at = self.value(data, at)
                if index >= count:
                    if index >= MOST_ARGUMENTS:
                        raise DamageError(
                            f"An argument has the number {index:,}, beyond {MOST_ARGUMENTS}", at
                        )
                    arguments += [None] * (index + 1 - count)
                    count = index + 1
                arguments[index] = value
            elif tag == END:
                return result, flags, thread, at + 1
            elif tag == RESULT:
                result, at = self.value(data, at + 1)
            elif tag == FLAGS:
                more, at = varint(data, at + 1)
                flags |= more
            elif tag == BACKTRACE:
                at = self._backtrace(data, at + 1)
            elif tag == THREAD and self.version < THREADS:
                thread, at = varint(data, at + 1)
            else:
                raise DamageError(f"The detail {tag} of a call is unknown", at)

    def forget(self) -> None:
        """Remove the signatures that this event has added so far."""
        for table, number, size in self.learned:
            del table[number]
            self._signature_bytes -= size
        self.learned.clear()

    def _learn(self, table, number, what, begin, end):
        """Store a signature, whose text is from ``begin`` to ``end``."""
        table[number] = what
        self.learned.append((table, number, end - begin))
        self._signature_bytes += end - begin
        if self._signature_bytes > MOST_SIGNATURE_BYTES or len(table) > MOST_SIGNATURES:
            raise DamageError("The trace has more names of functions and values than any program", begin)

    # ------------------------------------------------------------------------------------------- values

    def value(self, data: bytes, at: int, depth: int = 0) -> tuple:
        """(value, end) of the value whose tag is at ``at``."""
        reader = self._readers.get(data[at])
        if reader is None:
            raise DamageError(f"The type {data[at]} of a value is unknown", at)
        return reader(data, at + 1, depth)

    def blob(self, data: bytes, at: int) -> tuple[bytes, int]:
        """(bytes, end) of a blob: a number at ``at`` says how many bytes follow it."""
        begin = at
        size, at = varint(data, at)
        end = at + size
        if end > len(data):
            taken = end - self._begin
            if taken > LARGEST_EVENT:
                raise DamageError(f"A text or a blob has {size:,} bytes, which no call gives", begin)
            raise CutError(taken)
        return data[at:end], end

    def string(self, data: bytes, at: int) -> tuple[str, int]:
        """(text, end) of a string in UTF-8. Bytes that are no UTF-8 become U+FFFD."""
        text, at = self.blob(data, at)
        return text.decode("utf-8", "replace"), at

    def _count(self, data, at):
        """(how many values follow, where they begin). Each value has at least one byte."""
        begin = at
        count, at = varint(data, at)
        self.values += count
        if self.values > MOST_VALUES:
            raise DamageError(f"Arrays of a call have {self.values:,} values, which no program gives", begin)
        if at + count > len(data):
            raise CutError(at + count - self._begin)
        return count, at

    def _count_of_names(self, data, at, most=MOST_NAMES):
        """(how many names a signature has, where they begin)."""
        count, end = varint(data, at)
        if count > most:
            raise DamageError(f"A signature has {count:,} names; {most:,} are the most", at)
        return count, end

    def _negative(self, data, at, depth):
        value, at = varint(data, at)
        return -value, at

    def _signed(self, data, at):
        """(an integer, end). Its tag is at ``at``."""
        tag = data[at]
        if tag == UNSIGNED:
            return varint(data, at + 1)
        if tag == NEGATIVE:
            return self._negative(data, at + 1, 0)
        raise DamageError(f"An enumeration's value has the type {tag}, which is no integer's", at)

    def _enum(self, data, at, depth):
        number, at = varint(data, at)
        if number not in self.enums:
            begin = at
            count, at = self._count_of_names(data, at)
            for _ in range(count):
                name, at = self.string(data, at)
                value, at = self._signed(data, at)
                self.enum_names.setdefault(value, name)
            self._learn(self.enums, number, None, begin, at)
        return self._signed(data, at)

    def _old_enum(self, data, at, depth):
        number, at = varint(data, at)
        if number not in self.enums:
            begin = at
            name, at = self.string(data, at)
            value, at = self._signed(data, at)
            self.enum_names.setdefault(value, name)
            self._learn(self.enums, number, value, begin, at)
        return self.enums[number], at

    def _bitmask(self, data, at, depth):
        number, at = varint(data, at)
        if number not in self.bitmasks:
            begin = at
            count, at = self._count_of_names(data, at)
            for _ in range(count):
                _, at = self.blob(data, at)
                _, at = varint(data, at)
            self._learn(self.bitmasks, number, None, begin, at)
        return varint(data, at)

    def _array(self, data, at, depth):
        count, at = self._count(data, at)
        if depth == DEEPEST:
            raise DamageError(f"Arrays are in more than {DEEPEST} others", at)
        if count < len(_FLOATS) and data[at : at + 5 * count : 5] == _FLOAT_TAGS[count]:
            return list(_FLOATS[count](data, at)), at + 5 * count
        value, values = self.value, []
        for _ in range(count):
            element, at = value(data, at, depth + 1)
            values.append(element)
        return values, at

    def _struct(self, data, at, depth):
        number, at = varint(data, at)
        names = self.structs.get(number)
        if names is None:
            begin = at
            _, at = self.blob(data, at)
            names, at = self._names(data, at)
            self._learn(self.structs, number, names, begin, at)
        self.values += 1 + len(names)
        if depth == DEEPEST or self.values > MOST_VALUES:
            raise DamageError("Structures of a call are in too many others, or have too many values", at)
        members = {}
        for name in names:
            members[name], at = self.value(data, at, depth + 1)
        return members, at

    def _names(self, data, at, most=MOST_NAMES):
        """(names, end) of a function's arguments or a structure's members."""
        count, at = self._count_of_names(data, at, most)
        names = []
        for _ in range(count):
            name, at = self.string(data, at)
            names.append(name)
        return names, at

    def _repr(self, data, at, depth):
        """(value, end) of a value in two forms: the form for people is skipped, the one for machines is
        returned.
        """
        if depth == DEEPEST:
            raise DamageError(f"Values are in more than {DEEPEST} others", at)
        _, at = self.value(data, at, depth + 1)
        return self.value(data, at, depth + 1)

    def _wide_string(self, data, at, depth):
        """(text, end) of characters as numbers. Windows writes UTF-16: some characters are two numbers."""
        count, at = self._count(data, at)
        characters = []
        for _ in range(count):
            character, at = varint(data, at)
            characters.append(chr(character) if character <= sys.maxunicode else "\ufffd")
        text = "".join(characters)
        return text.encode("utf-16-le", "surrogatepass").decode("utf-16-le", "replace"), at

    def _backtrace(self, data, at):
        """Where a backtrace ends. Its frames are not stored."""
        count, at = self._count(data, at)
        for _ in range(count):
            number, at = varint(data, at)
            if number in self.frames:
                continue
            while data[at] != END:
                tag = data[at]
                if tag in FRAME_STRINGS:
                    _, at = self.blob(data, at + 1)
                elif tag in FRAME_NUMBERS:
                    _, at = varint(data, at + 1)
                else:
                    raise DamageError(f"The detail {tag} of a backtrace is unknown", at)
            at += 1
            self._learn(self.frames, number, None, at, at)
        return at
