"""Trace files of apitrace as calls. This module does not know what the calls mean in OpenGL.

    with Trace("game.trace") as trace:
        for call in trace:
            print(call.number, call.name, call.arguments)
    print(trace.damage or "whole", trace.unfinished)

A file of any size is read in bounded memory, once from its beginning to its end. It may be a pipe that a
program fills while it is recorded.

Source: apitrace's docs/FORMAT.markdown, versions 1 to 6.
"""

import struct
import sys
from collections.abc import Generator, Iterator
from os import PathLike
from typing import Any, BinaryIO, NamedTuple

from fixedpipe.pipeline.traces.containers import TraceError, pieces
from fixedpipe.pipeline.traces.decoding import LARGEST_EVENT, CutError, DamageError, Decoder, varint
from fixedpipe.pipeline.traces.recent_events import RecentEvents
from fixedpipe.pipeline.traces.tags import END, ENTER, FAKE, LEAVE, NEWEST, OLDEST, PROPERTIES

__all__ = ["FAKE", "Call", "Trace", "TraceError"]

# The most bytes before the first call. Assumed: properties are a path or two.
_LARGEST_HEADER = 1 << 20
# The most bytes by which the data grow when an event is decoded again; the event may have many blobs.
_GROWTH = 16 << 20
# The most pieces of the data whose places in the file are known. Damage is in one of them, or after it.
_MOST_PLACES = 1000
# Limits for calls that are entered and not left: their number, and their bytes, with 64 for each value of an
# array. Assumed: a program has fewer threads, and each is in one call.
MOST_UNFINISHED, _HEAVIEST_UNFINISHED, _VALUE = 4096, LARGEST_EVENT, 64
# How many leaving events are made at once: one for each number of 7 bits.
_NUMBERS = 128


class Call(NamedTuple):
    """A call that was entered and left.

    number     the call's number, from 0, in the order in which calls are entered
    name       the function's name, for instance "glVertex3f"
    arguments  by position, at least as many as the function's signature has; None for an absent one. If the
               call wrote through a pointer, the argument is the data at the end of the call
    result     None for a function without a result
    flags      bits: FAKE
    thread     the thread's number, from 0; 0 if the file does not name it

    Values are None, bool, int (also enumerations, bitmasks and pointers), float, str, bytes (blobs), list
    (arrays) and dict (structures, by their members' names). If the file has a value for people and one for
    machines, the call has the latter.
    """

    number: int
    name: str
    arguments: list[Any]
    result: Any
    flags: int
    thread: int


class Trace:
    """The calls of a trace: a context manager, and an iterator that runs once. It yields a call when the call
    is left.

    source      a path, "-" for standard input, or a binary file; only the file's ``read`` is called. A path
                is opened, and closed at the end or by ``close``. The caller closes a file of its own
    version     the version of the format, 1 to 6
    properties  the properties of a version 6, for instance {"process.name": "/usr/bin/glxgears"}
    damage      None, or a sentence that says what is cut or damaged, and where. It is set after the last call
                before that place
    enum_names  {value: the first name that an enumeration of the file gave it} so far

    Raises TraceError if a file is not a trace, or the library for it is not installed; and OSError if it
    cannot be read. Damage after the first call raises nothing.
    """

    def __init__(self, source: str | PathLike[str] | BinaryIO):
        self.damage: str | None = None
        self.properties: dict[str, str] = {}
        # Data that are not decoded yet begin at _at in _data. The first byte of _data is byte _before of all
        # data.
        self._data, self._at, self._before = b"", 0, 0
        # Where the pieces of _data begin: (in all data, in the file).
        self._places: list[tuple[int, int]] = []
        self._broken: TraceError | None = None
        # {number: (name, arguments, result, flags, thread, bytes)} of calls that are entered and not left.
        self._pending: dict[int, tuple[str, list, Any, int, int, int]] = {}
        self._pending_bytes = 0
        # The number of the call that is entered next.
        self._number = 0
        self._opened: BinaryIO | None = None
        self._calls: Generator[Call, None, None] | None = None
        if isinstance(source, str | PathLike):
            file = sys.stdin.buffer if source == "-" else open(source, "rb")  # noqa: SIM115, see close
            self._opened = None if source == "-" else file
        else:
            file = source
        try:
            self._pieces = pieces(file)
            self.version = self._header()
        except BaseException:
            self.close()
            raise
        self._decoder = Decoder(self.version)
        self.enum_names = self._decoder.enum_names
        self._calls = self._decoded()

    def __enter__(self) -> "Trace":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __iter__(self) -> Iterator[Call]:
        assert self._calls is not None
        return self._calls

    def __next__(self) -> Call:
        return next(iter(self))

    @property
    def unfinished(self) -> int:
        """How many calls are entered so far, and not left."""
        return len(self._pending)

    def close(self) -> None:
        """Yield no more calls. Close the file, if this object opened it."""
        if self._calls is not None:
            self._calls.close()
        self._close_file()

    def _close_file(self):
        if self._opened is not None:
            self._opened.close()

    # ------------------------------------------------------------------------------------------- data

    def _header(self):
        """Read everything before the first event, and return the version."""
        decoder = Decoder(NEWEST)
        while True:
            try:
                self._at = self._read_header(decoder)
                return self._version
            except DamageError as damage:
                raise TraceError(self._sentence(*damage.args)) from None
            except (CutError, IndexError) as cut:
                needed = cut.args[0] if isinstance(cut, CutError) else 1
            if max(needed, len(self._data)) > _LARGEST_HEADER:
                raise TraceError(self._sentence("The trace has no call, but properties without end", 0))
            if not self._more(needed):
                raise self._broken or TraceError(
                    self._sentence("The trace ends before its first call", len(self._data))
                )

    def _read_header(self, decoder):
        """Read the header, and return where it ends."""
        data = self._data
        self._version, at = varint(data, 0)
        if not OLDEST <= self._version <= NEWEST:
            raise DamageError(
                f"The trace's version is {self._version:,}, and {OLDEST} to {NEWEST} are read", 0
            )
        if self._version >= PROPERTIES:
            # This number is for apitrace: it says how apitrace must replay the calls. It is not needed here.
            _, at = varint(data, at)
            name, at = decoder.string(data, at)
            while name:
                self.properties[name], at = decoder.string(data, at)
                name, at = decoder.string(data, at)
        return at

    def _more(self, needed):
        """Read pieces until there are ``needed`` bytes and some more. Returns whether there was a piece.

        The data become twice as large, or _GROWTH larger. So an event is not decoded again for each piece.
        """
        rest = self._data[self._at :]
        self._before += self._at
        self._data, self._at = b"", 0
        while len(self._places) > 1 and self._places[1][0] <= self._before:
            del self._places[0]
        begun = size = len(rest)
        needed = max(needed, size + min(size, _GROWTH), 1)
        data = bytearray(rest)
        del rest
        while size < needed and self._broken is None:
            try:
                place, piece = next(self._pieces)
            except StopIteration:
                break
            except TraceError as error:
                self._broken = error
                break
            self._places.append((self._before + size, place))
            if len(self._places) > _MOST_PLACES:
                del self._places[1::2]
            data += piece
            size += len(piece)
        self._data = bytes(data)
        return size > begun

    def _sentence(self, problem, at):
        """A sentence that states a problem, and its place, ``at`` in the data."""
        at += self._before
        place = max((place for begin, place in self._places if begin <= at), default=0)
        return f"{problem}, at byte {at:,} of the unpacked data, from byte {place:,} of the file on."

    # ------------------------------------------------------------------------------------------- calls

    def _decoded(self):
        """Yield the calls, and at the end set the damage. If an event is cut, it is decoded again with more
        data.
        """
        recent = RecentEvents(self.version)
        try:
            while True:
                try:
                    yield from self._whole_events(recent)
                except (CutError, IndexError, struct.error) as cut:
                    self._decoder.forget()
                    needed = cut.args[0] if isinstance(cut, CutError) else 1
                begun = len(self._data) - self._at
                if begun > LARGEST_EVENT:
                    raise DamageError(f"A call has more than {LARGEST_EVENT:,} bytes", self._at)
                if not self._more(needed):
                    if self._broken is not None:
                        self.damage = str(self._broken)
                    elif begun:
                        raise DamageError("The trace ends within a call", self._at)
                    return
        except DamageError as damage:
            self.damage = self._sentence(*damage.args)
        finally:
            self._close_file()

    def _whole_events(self, recent):
        """Yield the calls that are left in the data. At the end of the data it raises CutError, IndexError or
        struct.error.
        """
        decoder, new = self._decoder, tuple.__new__
        kept, lengths, floats, place = recent.kept, recent.lengths, recent.floats, recent.place
        learned, data, at, number = decoder.learned, self._data, self._at, self._number
        leaving = _leaving_events(number)
        # Reading takes most of its time in this loop. It handles frequent cases without function calls.
        try:
            while True:
                if data[at] != ENTER:
                    left, at = self._left(data, at)
                    yield left
                    continue
                result, first = None, data[at + place]
                for size in lengths[first]:
                    found = kept.get(data[at : at + size])
                    if found is not None:
                        name, arguments, flags, thread, size = found
                        arguments = arguments.copy()
                        break
                else:
                    found = floats[first]
                    if found is not None:
                        size, unpack, constants, name, flags, thread = found
                        if at + size <= len(data) and (fields := unpack(data, at))[::2] == constants:
                            arguments = list(fields[1::2])
                        else:
                            found = None
                if found is None:
                    name, arguments, result, flags, thread, end = decoder.enter(data, at)
                    if learned:
                        learned.clear()
                    elif result is None:
                        recent.keep(data[at:end], name, arguments, flags, thread)
                else:
                    end = at + size
                leave = leaving[number % _NUMBERS]
                if data.startswith(leave, end):
                    at = end + len(leave)
                    number += 1
                    if not number % _NUMBERS:
                        leaving = _leaving_events(number)
                    yield new(Call, (number - 1, name, arguments, result, flags, thread))
                    continue
                taken = end - at + (_VALUE * decoder.values if found is None else 0)
                self._enter(number, (name, arguments, result, flags, thread, taken), at)
                at = end
                number += 1
                if not number % _NUMBERS:
                    leaving = _leaving_events(number)
        finally:
            self._at, self._number = at, number

    def _enter(self, number, call, at):
        """Store a call until it is left."""
        self._pending[number] = call
        self._pending_bytes += call[-1]
        if len(self._pending) > MOST_UNFINISHED or self._pending_bytes > _HEAVIEST_UNFINISHED:
            raise DamageError(
                f"{len(self._pending):,} calls are entered and not left, which no program does", at
            )

    def _left(self, data, at):
        """(a call that is left, where the event that leaves it ends)."""
        if data[at] != LEAVE:
            raise DamageError(f"The event {data[at]} is unknown", at)
        number, end = varint(data, at + 1)
        if number not in self._pending:
            raise DamageError(f"Call {number:,} is left, which is not entered or was left before", at)
        name, arguments, result, flags, thread, taken = self._pending[number]
        more, more_flags, said, end = self._decoder.leave(data, at, end, arguments)
        self._decoder.learned.clear()
        del self._pending[number]
        self._pending_bytes -= taken
        result = result if more is None else more
        return Call(
            number, name, arguments, result, flags | more_flags, thread if said is None else said
        ), end


def _leaving_events(number):
    """The events without details that leave calls, by the lowest 7 bits of a call's number. The higher bits
    are those of ``number``.
    """
    rest = number // _NUMBERS
    if not rest:
        return _SHORT_LEAVING
    tail = bytearray()
    while rest:
        tail.append(0x80 | rest & 0x7F)
        rest >>= 7
    tail[-1] &= 0x7F
    tail.append(END)
    return [head + tail for head in _LONG_LEAVING]


_SHORT_LEAVING = [bytes([LEAVE, low, END]) for low in range(_NUMBERS)]
_LONG_LEAVING = [bytes([LEAVE, 0x80 | low]) for low in range(_NUMBERS)]
