"""What the tests of traces share: small traces, packed and not."""

import io
import zlib

from fixedpipe.pipeline.traces.calls import Trace
from fixedpipe.pipeline.traces.containers import pieces
from fixedpipe.pipeline.traces.writer import (
    Bitmask,
    Enum,
    Frame,
    Pointer,
    Repr,
    Struct,
    TraceWriter,
    WideString,
    varint,
)

CONTAINERS = ("snappy", "gzip", "brotli")
VERSIONS = range(1, 7)
# What stands before the first event of version 6: the version, that of what calls mean, no properties.
HEADER = b"\x06\x06\x00"
# A call without arguments, entered and left: number 0, and of function 0.
CLEAR = b"\x00\x00\x00\x05clear\x00\x00"
FIRST_CALL = CLEAR + b"\x01\x00\x00"


def packed(data):
    """Data of a trace as a file: gzip, which takes no time."""
    packer = zlib.compressobj(1, wbits=31)
    return packer.compress(data) + packer.flush()


def read(file):
    """(the trace, its calls) of the bytes of a file."""
    trace = Trace(io.BytesIO(file))
    return trace, list(trace)


def read_data(events):
    """(the trace, its calls) of unpacked events of version 6."""
    return read(packed(HEADER + events))


def written(fill, **options):
    """The bytes of a file that ``fill`` has written by a TraceWriter."""
    file = io.BytesIO()
    with TraceWriter(file, **options) as writer:
        fill(writer)
    return file.getvalue()


COLORS = (("GL_FRONT", 0x404), ("GL_BACK", 0x405))


def every_kind(writer):
    """Calls of every kind, and each twice, in two threads."""
    for _ in range(2):
        writer.call("glVertex3f", ["x", "y", "z"], [0.5, 1.0, -2.0])
        writer.call("glVertex3f", ["x", "y", "z"], [0.25, 3.0, -2.0])
        writer.call("glCullFace", ["mode"], [Enum("GL_BACK", 0x405, COLORS)])
        writer.call("glEnable", ["cap"], [("GL_FOG", 0xB60)])
        writer.call("glClear", ["mask"], [Bitmask(0x4100, (("GL_COLOR_BUFFER_BIT", 0x4000),))])
        outer = writer.enter(
            "wait", ["p", "n"], [Pointer(1 << 40), -300], thread=200, backtrace=[Frame("a.so", line=7)]
        )
        writer.call("glMultMatrixd", ["m"], [[1 / 3] * 4 + [2.0]], flags=1)
        writer.call("glMaterialfv", ["face", "name", "v"], [1028, 4608, [0.5, 0.25, 0.0, 1.0]], thread=1)
        writer.call("glTexImage2D", ["size", "pixels"], [300, bytes(range(200))])
        writer.leave(outer, True, outputs={1: [7, None, "ü", WideString("ü𝄞")]})
        writer.call("visual", [], [{"depth": 24}, Struct("V", {"a": False, "b": []})], Pointer(4660))
        writer.call("shown", [], [Repr("people", 16)], ("GL_NO_ERROR", 0))


EVERY_KIND = written(every_kind)


def chunks(*parts):
    """A file of Snappy whose chunks unpack to these parts, each one literal of up to 64 KB."""
    file = b"at"
    for part in parts:
        last = len(part) - 1
        if last < 60:
            begin = bytes([last << 2]) if part else b""
        else:
            begin = bytes([60 << 2, last]) if last < 256 else b"\xf4" + last.to_bytes(2, "little")
        chunk = varint(len(part)) + begin + part
        file += len(chunk).to_bytes(4, "little") + chunk
    return file


def unpacked(file):
    """The data of a file's bytes."""
    return b"".join(data for _, data in pieces(io.BytesIO(file)))


# A call whose one argument follows: a value and what else belongs to the event.
ARGUMENT = b"\x00\x00\x01\x01f\x01\x01x\x01\x00"
