"""One event of a trace after another: bytes to names, arguments and results.

    event = 00 thread signature details     a call is entered; the thread stands there from version 4 on
          | 01 number details               a call is left, by its number
    details: pairs of a tag and what belongs to it, up to the tag 00

A signature (of a function, an enumeration, a bitmask, a structure) is spelled out where its number occurs
first; after that the number stands alone. Numbers are groups of 7 bits, the lowest first.

Source: apitrace's docs/FORMAT.markdown. Its reader, lib/trace/trace_parser.cpp, differs in two things and is
right about the files. A structure's signature has a name. Below version 3 an enumeration's signature has one
name and one value, and no value follows it.
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
# Bytes of an event. Assumed: no machine here has more than 64 MB of memory, and no call gives it more than
# twice as many.
LARGEST_EVENT = 128 << 20
# Values in the arrays and structures of an event; here each takes up to 64 bytes. Measured: at most 398.
# Assumed: images and vertices are always blobs.
MOST_VALUES = 1 << 20
# Arrays in arrays. Assumed: programs have two or three.
DEEPEST = 32
# Arguments of a function, and names in another signature. Measured: at most 10, and 3,514 of an enumeration.
MOST_ARGUMENTS, MOST_NAMES = 255, 1 << 16
# Bytes of all signatures, and signatures of one kind. Measured: 104,043 bytes in the traces of `shared`.
MOST_SIGNATURE_BYTES, MOST_SIGNATURES = 4 << 20, 1 << 19

_float, _double = struct.Struct("<f").unpack_from, struct.Struct("<d").unpack_from
# Arrays of up to 64 floats, each behind its tag.
_FLOAT_TAGS = [bytes([FLOAT]) * count for count in range(65)]
_FLOATS = [struct.Struct("<" + "xf" * count).unpack_from for count in range(65)]


class CutError(Exception):
    """An event goes on behind the data; ``args[0]``: how many bytes it takes at least."""


class DamageError(TraceError):
    """What makes no sense; ``args``: the sentence's beginning, and where in the data it is."""


def varint(data: bytes, at: int) -> tuple[int, int]:
    """(a number of at most 64 bits, where it ends).

    Raises IndexError where the data end before it does, DamageError for more bits.
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
    """Decodes the events of one trace, and knows the signatures so far.

    Its methods take the data and where to begin, and say where they ended. Where the data end too early they
    raise CutError, IndexError or struct.error. ``forget`` then takes back what was ``learned``, and the event
    can be begun again with more data; ``learned`` is to be emptied behind each event. Nonsense raises
    DamageError.

    version     of the format, 1 to 6
    enum_names  {value: the first name that an enumeration gave it}
    values      how many values the arrays and structures of the last event had
    """

    def __init__(self, version: int):
        self.version = version
        self.enum_names: dict[int, str] = {}
        self.functions: dict[int, tuple[str, list[None]]] = {}
        self.enums: dict[int, int | None] = {}
        # Those behind whose numbers a value stands.
        self._named = self.enums if version >= NAMED_ENUMS else {}
        self.bitmasks: dict[int, None] = {}
        self.structs: dict[int, list[str]] = {}
        self.frames: dict[int, None] = {}
        # (table, number, bytes) of what this event spelled out.
        self.learned: list[tuple[dict, int, int]] = []
        # Values in this event's arrays and structures.
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
        """(result, flags, thread or None, end) of the event at ``begin``, whose details at ``at`` fill in
        ``arguments``.
        """
        self._begin, self.values = begin, 0
        return self._details(data, at, arguments)

    def _details(self, data, at, arguments):
        """(result, flags, thread or None, end) of details, which fill in ``arguments``."""
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
                # The most frequent values, without a call.
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
        """Take back what this event has taught so far."""
        for table, number, size in self.learned:
            del table[number]
            self._signature_bytes -= size
        self.learned.clear()

    def _learn(self, table, number, what, begin, end):
        """Keep a signature, whose text lies from ``begin`` to ``end``."""
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
        """(bytes, end) of as many bytes as a number says."""
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
        """(text, end) of UTF-8, in which what is none becomes U+FFFD."""
        text, at = self.blob(data, at)
        return text.decode("utf-8", "replace"), at

    def _count(self, data, at):
        """(how many values follow, where they begin); each has a byte at least."""
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
        """(an integer behind its tag, end)."""
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
        """What a value is for people, then what it is for machines, which is taken."""
        if depth == DEEPEST:
            raise DamageError(f"Values are in more than {DEEPEST} others", at)
        _, at = self.value(data, at, depth + 1)
        return self.value(data, at, depth + 1)

    def _wide_string(self, data, at, depth):
        """Characters as numbers; or, as Windows has them, the two halves of UTF-16."""
        count, at = self._count(data, at)
        characters = []
        for _ in range(count):
            character, at = varint(data, at)
            characters.append(chr(character) if character <= sys.maxunicode else "\ufffd")
        text = "".join(characters)
        return text.encode("utf-16-le", "surrogatepass").decode("utf-16-le", "replace"), at

    def _backtrace(self, data, at):
        """Where a backtrace ends, whose frames are not kept."""
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
