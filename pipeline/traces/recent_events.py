"""Finds events that occur again and again in a trace by their bytes, without decoding them.

A program calls its functions with few different arguments. Some functions take only floats, such as
glVertex3f; their events differ only in the floats. Measured: of OpenArena's 289,250 calls 80 % are found.

This is right for the following reason. The bytes of an event, and the signatures that they name, decide how
it is decoded and where it ends. Signatures do not change. So bytes that were an event once, and contained no
text of a signature, are the same event wherever an event begins.
"""

import struct
from typing import Any, NamedTuple

from fixedpipe.pipeline.traces.decoding import varint
from fixedpipe.pipeline.traces.tags import ARGUMENT, FLOAT, THREADS

# The most events that are stored, and the most bytes of each. Measured: 13 MB at most; longer events seldom
# occur again.
_KEPT, _LONGEST = 1 << 15, 100
# How many lengths of a function's events are tried. Measured: a third one saves no time.
_LENGTHS = 2
# Types of values that a caller cannot change.
_SCALARS = {type(None), bool, int, float, str, bytes}


class Floats(NamedTuple):
    """The events of a function whose arguments are all floats: constant parts, and how to unpack them."""

    size: int
    unpack: Any
    constants: tuple[bytes, ...]
    name: str
    flags: int
    thread: int


class RecentEvents:
    """Events of one trace that enter calls.

    ``kept``     {bytes: (name, arguments, flags, thread, how many bytes)}; copy the arguments before use
    ``lengths``  by the first byte of an event's signature: lengths of such events
    ``floats``   by the same byte: None, or Floats
    ``place``    the index of this byte in an event, if the thread's number has one byte
    """

    def __init__(self, version: int):
        self.kept: dict[bytes, tuple[str, list, int, int, int]] = {}
        self.lengths: list[list[int]] = [[] for _ in range(256)]
        self.floats: list[Floats | None] = [None] * 256
        self.place = 2 if version >= THREADS else 1
        self._version = version

    def keep(self, event: bytes, name: str, arguments: list, flags: int, thread: int) -> None:
        """Store an event without result and text of a signature, if it is short and has only scalars."""
        size, first = len(event), event[self.place]
        if size > _LONGEST or not _SCALARS.issuperset(map(type, arguments)):
            return
        if arguments and (shape := self._shape(event, len(arguments))):
            unpack = shape.unpack_from
            self.floats[first] = Floats(size, unpack, unpack(event)[::2], name, flags, thread)
            return
        if len(self.kept) == _KEPT:
            self.kept.clear()
        self.kept[event] = name, arguments.copy(), flags, thread, size
        lengths = self.lengths[first]
        if size in lengths:
            lengths.remove(size)
        lengths.insert(0, size)
        del lengths[_LENGTHS:]

    def _shape(self, event, count):
        """A Struct that unpacks constants and floats in turn; None if the event is not a head, floats and an
        end.
        """
        at = 1
        for _ in range(2 if self._version >= THREADS else 1):
            _, at = varint(event, at)
        if len(event) != at + 7 * count + 1:
            return None
        for k in range(count):
            if event[at + 7 * k : at + 7 * k + 3] != bytes((ARGUMENT, k, FLOAT)):
                return None
        return struct.Struct(f"<{at + 3}sf" + "3sf" * (count - 1) + "s")
