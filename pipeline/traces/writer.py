"""Writes trace files of apitrace, for tests and for small traces of your own.

    with TraceWriter("own.trace") as trace:
        trace.call("glClear", ["mask"], [Bitmask(0x4000)])
        trace.call("glGetError", [], [], Enum("GL_NO_ERROR", 0))

Source: apitrace's docs/FORMAT.markdown and lib/trace/trace_writer.cpp.
"""

import struct
import zlib
from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any, BinaryIO, Literal, NamedTuple

from fixedpipe.pipeline.traces import tags as T
from fixedpipe.pipeline.traces.containers import SNAPPY_MARK, USUAL_CHUNK, brotli_library, snappy_library

Container = Literal["snappy", "gzip", "brotli"]

_float, _double = struct.Struct("<f"), struct.Struct("<d")


class Enum(NamedTuple):
    """A value of an enumeration. ``TraceWriter`` also accepts a tuple of a name and an integer.

    ``group``: all (name, value) of the enumeration, from version 3 on; without it, only this value.
    """

    name: str
    value: int
    group: tuple[tuple[str, int], ...] = ()


class Bitmask(NamedTuple):
    """Bits, and (name, bits) for those that have names."""

    value: int
    group: tuple[tuple[str, int], ...] = ()


class Pointer(NamedTuple):
    """An address in the traced program. 0 is written in the same way as None."""

    address: int


class Struct(NamedTuple):
    """A structure and the name of its type. A dict is a structure whose type has no name."""

    name: str
    members: Mapping[str, Any]


class Repr(NamedTuple):
    """A value in two forms: for people, and for machines."""

    human: Any
    machine: Any


class WideString(NamedTuple):
    """A text that is written character by character, as in traces of Windows programs."""

    text: str


class Frame(NamedTuple):
    """A frame of a backtrace. Fields that are None are not written."""

    module: str | None = None
    function: str | None = None
    file: str | None = None
    line: int | None = None
    offset: int | None = None


def varint(value: int) -> bytes:
    """An integer of at most 64 bits, 7 bits a byte, the lowest first. Raises ValueError for others."""
    if not 0 <= value < 1 << 64:
        raise ValueError(f"A trace has integers of at most 64 bits; {value} is none.")
    groups = bytearray()
    while value >= 0x80:
        groups.append(0x80 | value & 0x7F)
        value >>= 7
    groups.append(value)
    return bytes(groups)


class TraceWriter:
    """Writes a trace file. It is a context manager, which closes the file.

    target      a path, or a binary file, which stays open
    version     the version of the format, 1 to 6. Before version 3 an enumeration has one value. Only version
                6 has properties
    container   how the data are packed: "snappy", "gzip" or "brotli"
    chunk       bytes of a chunk of Snappy before packing; a call may extend over several chunks
    properties  the trace's properties, for instance {"process.name": "/usr/bin/glxgears"}

    A value is None, bool, int, float (written with 32 bits if they suffice, otherwise with 64), str, bytes (a
    blob), list (an array), dict, or one of this module's classes.

    Raises ValueError for another version, for properties in a version without them, and for values that a
    trace cannot hold; TypeError for values of other classes; TraceError if a container's library is missing.
    """

    def __init__(
        self,
        target: str | PathLike[str] | BinaryIO,
        *,
        version: int = T.NEWEST,
        container: Container = "snappy",
        chunk: int = USUAL_CHUNK,
        properties: Mapping[str, str] | None = None,
    ):
        if not T.OLDEST <= version <= T.NEWEST:
            raise ValueError(f"Traces have the versions {T.OLDEST} to {T.NEWEST}; {version} is none.")
        if properties and (version < T.PROPERTIES or "" in properties):
            raise ValueError("Properties have names and are of version 6; this trace cannot have them.")
        if container not in _PACKERS:
            raise ValueError(f"A container is one of {', '.join(_PACKERS)}; {container!r} is none.")
        if chunk < 1:
            raise ValueError(f"A chunk has one byte at least; {chunk} is none.")
        self.version = version
        self._packer = _PACKERS[container](chunk)
        self._number = 0
        # A signature's number, by the signature's kind and text.
        self._signatures: dict[tuple, int] = {}
        self._counts: dict[str, int] = {}
        self._opened = open(target, "wb") if isinstance(target, str | PathLike) else None  # noqa: SIM115
        self._file: Any = self._opened or target
        header = varint(version)
        if version >= T.PROPERTIES:
            header += varint(version)
            for name, value in (properties or {}).items():
                header += self._string(name) + self._string(value)
            header += varint(0)
        self._put(header)

    def __enter__(self) -> "TraceWriter":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Write the remaining data. Close the file, if this object opened it."""
        if self._packer is not None:
            self._file.write(self._packer.end())
            self._packer = None
        if self._opened is not None:
            self._opened.close()

    def call(
        self,
        name: str,
        argument_names: Sequence[str],
        arguments: Sequence[Any],
        result: Any = None,
        *,
        outputs: Mapping[int, Any] | None = None,
        flags: int = 0,
        thread: int = 0,
    ) -> int:
        """Write a call that is entered and left, and return its number. See ``enter`` and ``leave``."""
        number = self.enter(name, argument_names, arguments, flags=flags, thread=thread)
        self.leave(number, result, outputs=outputs)
        return number

    def enter(
        self,
        name: str,
        argument_names: Sequence[str],
        arguments: Sequence[Any],
        *,
        flags: int = 0,
        thread: int = 0,
        backtrace: Sequence[Frame] = (),
    ) -> int:
        """Write that a call is entered, and return its number for ``leave``. ``arguments``: in their order,
        from the first on.
        """
        event = bytearray([T.ENTER])
        if self.version >= T.THREADS:
            event += varint(thread)
        event += self._signature("function", self._string(name) + self._strings(argument_names))
        if thread and self.version < T.THREADS:
            event += bytes([T.THREAD]) + varint(thread)
        if flags:
            event += bytes([T.FLAGS]) + varint(flags)
        if backtrace:
            event += bytes([T.BACKTRACE]) + varint(len(backtrace))
            event += b"".join(map(self._frame, backtrace))
        event += self._details(enumerate(arguments))
        self._put(bytes(event))
        self._number += 1
        return self._number - 1

    def leave(self, number: int, result: Any = None, *, outputs: Mapping[int, Any] | None = None) -> None:
        """Write that a call is left. ``outputs``: values that it wrote, {position of the argument: value}."""
        event = bytearray([T.LEAVE]) + varint(number)
        if result is not None:
            event += bytes([T.RESULT]) + self._value(result)
        self._put(bytes(event + self._details((outputs or {}).items())))

    def _put(self, data):
        self._file.write(self._packer.pack(data))

    def _details(self, arguments):
        details = bytearray()
        for index, value in arguments:
            details += bytes([T.ARGUMENT]) + varint(index) + self._value(value)
        return details + bytes([T.END])

    def _signature(self, kind, text):
        """The bytes of a signature: its number, and its text if it occurs for the first time."""
        number = self._signatures.get((kind, text))
        if number is not None:
            return varint(number)
        number = self._counts.get(kind, 0)
        self._counts[kind] = number + 1
        self._signatures[kind, text] = number
        return varint(number) + text

    def _frame(self, frame):
        text = b""
        for tag, value in zip(T.FRAME_STRINGS, frame[:3], strict=True):
            text += b"" if value is None else bytes([tag]) + self._string(value)
        for tag, value in zip(T.FRAME_NUMBERS, frame[3:], strict=True):
            text += b"" if value is None else bytes([tag]) + varint(value)
        return self._signature("frame", text + bytes([T.END]))

    def _string(self, text):
        data = text.encode()
        return varint(len(data)) + data

    def _strings(self, texts):
        return varint(len(texts)) + b"".join(map(self._string, texts))

    # ------------------------------------------------------------------------------------------- values

    def _value(self, value):
        writer = _VALUES.get(type(value))
        if writer is None:
            raise TypeError(
                f"A trace has no values such as {value!r:.60}, which is a {type(value).__name__}."
            )
        return writer(self, value)

    def _null(self, value):
        return bytes([T.NULL])

    def _bool(self, value):
        return bytes([T.TRUE if value else T.FALSE])

    def _integer(self, value):
        return bytes([T.NEGATIVE if value < 0 else T.UNSIGNED]) + varint(abs(value))

    def _real(self, value):
        try:
            single = _float.pack(value)
        except OverflowError:
            single = b""
        if single and (_float.unpack(single)[0] == value or value != value):
            return bytes([T.FLOAT]) + single
        return bytes([T.DOUBLE]) + _double.pack(value)

    def _text(self, value):
        return bytes([T.STRING]) + self._string(value)

    def _blob(self, value):
        return bytes([T.BLOB]) + varint(len(value)) + value

    def _array(self, values):
        return bytes([T.ARRAY]) + varint(len(values)) + b"".join(map(self._value, values))

    def _members(self, members):
        return self._struct(Struct("", members))

    def _struct(self, value):
        signature = self._signature("structure", self._string(value.name) + self._strings(value.members))
        return bytes([T.STRUCT]) + signature + b"".join(map(self._value, value.members.values()))

    def _pair(self, value):
        return self._enum(Enum(*value))

    def _enum(self, value):
        if self.version < T.NAMED_ENUMS:
            text = self._string(value.name) + self._integer(value.value)
            return bytes([T.ENUM]) + self._signature("enumeration", text)
        group = value.group or ((value.name, value.value),)
        text = varint(len(group)) + b"".join(self._string(name) + self._integer(each) for name, each in group)
        return bytes([T.ENUM]) + self._signature("enumeration", text) + self._integer(value.value)

    def _bitmask(self, value):
        text = varint(len(value.group))
        text += b"".join(self._string(name) + varint(bits) for name, bits in value.group)
        return bytes([T.BITMASK]) + self._signature("bitmask", text) + varint(value.value)

    def _pointer(self, value):
        return bytes([T.OPAQUE]) + varint(value.address) if value.address else bytes([T.NULL])

    def _repr(self, value):
        return bytes([T.REPR]) + self._value(value.human) + self._value(value.machine)

    def _wide_string(self, value):
        return bytes([T.WIDE_STRING]) + varint(len(value.text)) + b"".join(varint(ord(c)) for c in value.text)


_VALUES = {
    type(None): TraceWriter._null,
    bool: TraceWriter._bool,
    int: TraceWriter._integer,
    float: TraceWriter._real,
    str: TraceWriter._text,
    bytes: TraceWriter._blob,
    list: TraceWriter._array,
    dict: TraceWriter._members,
    tuple: TraceWriter._pair,
    Enum: TraceWriter._enum,
    Bitmask: TraceWriter._bitmask,
    Pointer: TraceWriter._pointer,
    Struct: TraceWriter._struct,
    Repr: TraceWriter._repr,
    WideString: TraceWriter._wide_string,
}


class _Snappy:
    """Packs data in chunks, as apitrace does."""

    def __init__(self, chunk):
        self._library, self._chunk = snappy_library(), chunk
        self._waiting, self._begun = bytearray(), False

    def pack(self, data):
        self._waiting += data
        packed = b"" if self._begun else SNAPPY_MARK
        self._begun = True
        while len(self._waiting) >= self._chunk:
            packed += self._packed_chunk()
        return packed

    def end(self):
        return self._packed_chunk() if self._waiting else b""

    def _packed_chunk(self):
        packed = bytes(self._library.snappy.compress_raw(bytes(self._waiting[: self._chunk])))
        del self._waiting[: self._chunk]
        return len(packed).to_bytes(4, "little") + packed


class _Gzip:
    def __init__(self, chunk):
        self._packer = zlib.compressobj(wbits=31)
        self.pack, self.end = self._packer.compress, self._packer.flush


class _Brotli:
    def __init__(self, chunk):
        self._packer = brotli_library().Compressor(quality=5)
        self.pack, self.end = self._packer.process, self._packer.finish


_PACKERS: dict[str, Any] = {"snappy": _Snappy, "gzip": _Gzip, "brotli": _Brotli}
