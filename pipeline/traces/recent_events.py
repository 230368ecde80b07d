"""Events that a trace has again and again, found by their bytes without being decoded.

A program calls its functions with few different arguments. And events of a function that takes floats alone,
such as glVertex3f, differ in their floats alone. Measured: of OpenArena's 289,250 calls 80 % are found here.

Why that is right: an event's own bytes, and the signatures that they name, decide how it is decoded and where
it ends. Signatures stay as they are. So bytes that were an event once, and spelled out no signature, are the
same event wherever an event begins.
"""

import struct
from typing import Any, NamedTuple

from fixedpipe.pipeline.traces.decoding import varint
from fixedpipe.pipeline.traces.tags import ARGUMENT, FLOAT, THREADS

# Events that are kept, and bytes of each. Measured: 13 MB at most; longer events hardly come again.
_KEPT, _LONGEST = 1 << 15, 100
# Lengths of a function's events that are tried. Measured: the third is not worth it.
_LENGTHS = 2
# Values that cannot be changed by whoever gets them.
_SCALARS = {type(None), bool, int, float, str, bytes}


class Floats(NamedTuple):
    """The events of a function whose arguments are floats: what is the same in each, and what is not."""

    size: int
    unpack: Any
    constants: tuple[bytes, ...]
    name: str
    flags: int
    thread: int


class RecentEvents:
    """Events of one trace that enter calls.

    ``kept``     {bytes: (name, arguments, flags, thread, how many bytes)}; copy the arguments
    ``lengths``  by the first byte of an event's signature: lengths that such events have
    ``floats``   by the same: None, or Floats
    ``place``    where in an event this byte is, if the thread's number has one byte
    """

    def __init__(self, version: int):
        self.kept: dict[bytes, tuple[str, list, int, int, int]] = {}
        self.lengths: list[list[int]] = [[] for _ in range(256)]
        self.floats: list[Floats | None] = [None] * 256
        self.place = 2 if version >= THREADS else 1
        self._version = version

    def keep(self, event: bytes, name: str, arguments: list, flags: int, thread: int) -> None:
        """Keep an event without result that spelled out no signature, if it is short and of scalars."""
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
        """Unpacks constants and floats by turns. None for an event that is not a head, floats, and an end."""
        at = 1
        for _ in range(2 if self._version >= THREADS else 1):
            _, at = varint(event, at)
        if len(event) != at + 7 * count + 1:
            return None
        for k in range(count):
            if event[at + 7 * k : at + 7 * k + 3] != bytes((ARGUMENT, k, FLOAT)):
                return None
        return struct.Struct(f"<{at + 3}sf" + "3sf" * (count - 1) + "s")
