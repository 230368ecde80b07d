"""The containers of traces: what is unpacked, from which files, and what is said without a library."""

import io
import os
import sys
import zlib
from types import SimpleNamespace

import brotli
import cramjam
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fixedpipe.pipeline.traces.calls import Trace, TraceError
from fixedpipe.pipeline.traces.containers import LARGEST_CHUNK, beginning_of_snappy, pieces
from fixedpipe.pipeline.traces.writer import TraceWriter, varint
from tests.pipeline.traces.examples import (
    CONTAINERS,
    EVERY_KIND,
    FIRST_CALL,
    HEADER,
    chunks,
    every_kind,
    packed,
    read,
    unpacked,
    written,
)

DATA = unpacked(EVERY_KIND)
FILES = {container: written(every_kind, container=container) for container in CONTAINERS}


class Trickle(io.RawIOBase):
    """A file that gives a byte at a time, and cannot do anything else."""

    def __init__(self, data):
        self._data = io.BytesIO(data)

    def read(self, size=-1):
        assert size > 0
        return self._data.read(1)


@pytest.mark.parametrize("container", CONTAINERS)
def test_a_file_may_give_a_byte_at_a_time(container):
    trace = Trace(Trickle(FILES[container]))
    assert len(list(trace)) == len(read(EVERY_KIND)[1]) and trace.damage is None


@pytest.mark.parametrize("container", CONTAINERS)
def test_standard_input_is_read_and_stays_open(container, monkeypatch):
    file = io.BytesIO(FILES[container])
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=file))
    with Trace("-") as trace:
        assert len(list(trace)) == len(read(EVERY_KIND)[1])
    assert not file.closed


def test_a_call_is_given_before_the_next_is_written():
    reading, writing = os.pipe()
    with open(reading, "rb") as file, open(writing, "wb", buffering=0) as program:
        program.write(chunks(HEADER + FIRST_CALL))
        trace = Trace(file)
        assert next(trace).number == 0
        program.write(chunks(b"\x00\x00\x00\x00\x01\x01\x00")[2:])
        assert next(trace).number == 1
        program.close()
        assert list(trace) == [] and trace.damage is None


def test_a_missing_file_is_an_error_of_the_system(tmp_path):
    with pytest.raises(FileNotFoundError):
        Trace(tmp_path / "none.trace")


def test_a_closed_trace_gives_no_more_calls():
    with Trace(io.BytesIO(EVERY_KIND)) as trace:
        for call in trace:
            if call.number == 3:
                trace.close()
        assert call.number == 3


# ------------------------------------------------------------------------------------------- libraries


@pytest.mark.parametrize(("container", "library"), [("snappy", "cramjam"), ("brotli", "brotli")])
def test_a_missing_library_is_named_with_its_extra(container, library, monkeypatch):
    monkeypatch.setitem(sys.modules, library, None)
    says = rf"needs {library}.*: pip install 'fixedpipe\[replay\]'\.$"
    with pytest.raises(TraceError, match=says):
        read(FILES[container])
    with pytest.raises(TraceError, match=says):
        TraceWriter(io.BytesIO(), container=container)
    assert len(read(FILES["gzip"])[1]) == len(read(packed(DATA))[1])


def test_an_old_brotli_is_none(monkeypatch):
    monkeypatch.setitem(sys.modules, "brotli", SimpleNamespace(Decompressor=object))
    with pytest.raises(TraceError, match=r"needs brotli 1\.2 or newer"):
        read(FILES["brotli"])


def test_a_path_is_closed_where_its_file_is_no_trace(tmp_path):
    path = tmp_path / "no.trace"
    path.write_bytes(b"hello")
    with pytest.raises(TraceError, match="no trace, at byte 0"):
        Trace(path)  # a file left open would warn


# ------------------------------------------------------------------------------------------- what is no trace


@pytest.mark.parametrize(
    ("file", "says"),
    [
        (b"", "The file is empty, at byte 0"),
        (b"a", "is no trace, at byte 0"),
        (b"at", "ends before its first call"),
        (b"\x28\xb5\x2f\xfd1234", "Zstandard, at byte 0 .*`apitrace repack`"),
        (b"hello, world", "is no trace, at byte 0"),
        (b"at\x05\x00", "last chunk is cut, at byte 2"),
        (b"at\x05\x00\x00\x00\x04", "last chunk is cut, at byte 2"),
        (b"at\xff\xff\xff\xff1234", "4,294,967,295 bytes, at byte 2"),
        (b"at\x06\x00\x00\x00" + varint(LARGEST_CHUNK + 1) + b"12", "67,108,865 bytes, at byte 2"),
        (b"at\x06\x00\x00\x00\xff\xff\xff\xff\xff\xff", "Snappy data are damaged, at byte 2"),
        (b"\x1f\x8b\x00\x00", "gzip data are damaged .*, at byte 0"),
        (b"\x1f\x8b", "gzip data are cut, at byte 2"),
    ],
)
def test_what_is_no_trace_is_an_error(file, says):
    with pytest.raises(TraceError, match=says):
        read(file)


@pytest.mark.parametrize(
    ("behind", "says"),
    [
        (b"\x00\x00\x00\x00", None),
        (b"\x00\x00\x00\x00more", "A chunk of no bytes ends the trace before the file does, at byte"),
        (b"\x05", "last chunk is cut"),
        (b"\x03\x00\x00\x00\x04\x0cabc", "Snappy data are damaged"),
    ],
)
def test_what_follows_the_last_chunk(behind, says):
    trace, calls = read(EVERY_KIND + behind)
    assert len(calls) == len(read(EVERY_KIND)[1])
    assert trace.damage is None if says is None else says in trace.damage


def test_what_follows_a_stream_of_brotli_is_said():
    block = b"".join(written(every_kind, container="brotli") for _ in range(1))
    trace, _ = read(block + bytes(600 - len(block) % 512))
    assert "Brotli data" in trace.damage


# ------------------------------------------------------------------------------------------- gzip


def test_streams_of_gzip_follow_each_other():
    parts = [DATA[:5], b"", DATA[5:300], DATA[300:]]
    trace, calls = read(b"".join(map(packed, parts)))
    assert trace.damage is None and len(calls) == len(read(EVERY_KIND)[1])


def test_what_follows_streams_of_gzip_is_said():
    trace, calls = read(packed(DATA) + b"more")
    assert "gzip data end before the file does" in trace.damage
    assert len(calls) == len(read(EVERY_KIND)[1])


def test_what_precedes_damage_of_gzip_is_read():
    packer = zlib.compressobj(0, wbits=31)
    call, count = b"\x00\x00\x00\x00\x01", 9000
    data = HEADER + FIRST_CALL + b"".join(call + varint(k) + b"\x00" for k in range(1, count))
    file = bytearray(packer.compress(data) + packer.flush())
    file[-8] ^= 1
    trace, calls = read(bytes(file))
    assert "gzip data are damaged" in trace.damage and count - 100 < len(calls) < count


# ------------------------------------------------------------------------------------------- Snappy

repeats = st.lists(st.tuples(st.binary(min_size=1, max_size=70), st.integers(1, 90)), max_size=6)


@given(repeats)
def test_the_beginning_of_snappy_is_that_of_its_data(parts):
    data = b"".join(part * times for part, times in parts)
    chunk = bytes(cramjam.snappy.compress_raw(data))
    assert beginning_of_snappy(chunk) == data
    lengths = []
    for at in range(len(chunk)):
        begin = beginning_of_snappy(chunk[:at])
        assert data.startswith(begin)
        lengths.append(len(begin))
    assert lengths == sorted(lengths)


@pytest.mark.parametrize("length", [1, 59, 60, 61, 255, 256, 257, 70_000])
def test_literals_of_every_length(length):
    data = os.urandom(length) if length == 0 else bytes((k * k * 7 + k // 3) % 251 for k in range(length))
    assert beginning_of_snappy(bytes(cramjam.snappy.compress_raw(data))) == data


@pytest.mark.parametrize(
    ("chunk", "data"),
    [
        (b"\x0e\x0cabcd\x19\x04", b"abcd" + b"abcdabcdab"),  # 4 to 11 bytes, 11 bits back
        (b"\x0a\x0cabcd\x16\x02\x00", b"abcd" + b"cdcdcd"),  # 1 to 64 bytes, 16 bits back
        (b"\x07\x0cabcd\x0b\x04\x00\x00\x00", b"abcd" + b"abc"),  # 32 bits back
        (b"\x05\x0cabcd\x16\x02\x00", b"abcd" + b"c"),  # more than the chunk says
        (b"\x0a\x0cabcd\x16\x05\x00", b"abcd"),  # from before the beginning
        (b"\x0a\x0cabcd\x16\x00\x00", b"abcd"),
        (b"\x0a\x0cabcd\x16\x02", b"abcd"),
        (b"\x0a\xf4", b""),
        (b"\xff\xff\xff\xff\xff\x01a", b""),
        (b"", b""),
    ],
)
def test_elements_of_snappy(chunk, data):
    assert beginning_of_snappy(chunk) == data


def test_pieces_say_where_they_begin():
    places = [place for place, _ in pieces(io.BytesIO(chunks(HEADER, FIRST_CALL, b"")))]
    assert places == [2, 2 + 4 + 2 + len(HEADER)]
    file = written(lambda w: w._put(bytes(3 << 20)), container="gzip")
    places = [place for place, _ in pieces(io.BytesIO(file))]
    assert places[0] == 0 and places == sorted(places) and len(file) > places[-1] > 0


def test_a_bound_of_brotli_is_kept():
    file = brotli.compress(bytes(16 << 20))
    assert max(len(data) for _, data in pieces(io.BytesIO(file))) <= 4 << 20
