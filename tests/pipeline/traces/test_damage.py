"""Traces that are cut, damaged, or made to do harm: what is whole is given, and a sentence says the rest."""

import io
import random
import re
import tracemalloc
import zlib

import pytest

from fixedpipe.pipeline.traces import calls as calls_module
from fixedpipe.pipeline.traces import decoding
from fixedpipe.pipeline.traces.calls import MOST_UNFINISHED, TraceError
from fixedpipe.pipeline.traces.decoding import DEEPEST, LARGEST_EVENT, MOST_NAMES, MOST_VALUES, Decoder
from fixedpipe.pipeline.traces.writer import varint
from tests.pipeline.traces.examples import (
    ARGUMENT,
    CLEAR,
    CONTAINERS,
    EVERY_KIND,
    FIRST_CALL,
    HEADER,
    VERSIONS,
    chunks,
    every_kind,
    packed,
    read,
    read_data,
    unpacked,
    written,
)

WHOLE = list(map(repr, read(EVERY_KIND)[1]))
DATA = unpacked(EVERY_KIND)
MB = 1 << 20


def is_a_beginning(calls):
    """Whether calls are the first of those that are whole."""
    return list(map(repr, calls)) == WHOLE[: len(calls)]


# ------------------------------------------------------------------------------------------- cuts


@pytest.mark.parametrize("version", VERSIONS)
def test_chunks_may_end_at_every_byte(version):
    data = unpacked(written(every_kind, version=version))
    for at in range(1, len(data)):
        trace, calls = read(chunks(data[:at], data[at:]))
        assert trace.damage is None and list(map(repr, calls)) == WHOLE, at


def test_chunks_may_have_a_byte_each():
    trace, calls = read(chunks(*(DATA[k : k + 1] for k in range(len(DATA)))))
    assert trace.damage is None and list(map(repr, calls)) == WHOLE


def test_a_cut_trace_has_the_calls_before_the_cut():
    counts = []
    for at in range(len(HEADER), len(DATA)):
        trace, calls = read(packed(DATA[:at]))
        assert is_a_beginning(calls)
        if trace.damage is not None:
            place = int(trace.damage.split("at byte ")[1].split(" of")[0].replace(",", ""))
            assert trace.damage.startswith("The trace ends within a call") and place < at
        counts.append(len(calls))
    assert counts == sorted(counts) and counts[0] == 0 and counts[-1] == len(WHOLE) - 1


@pytest.mark.parametrize("container", CONTAINERS)
def test_a_cut_file_has_the_calls_before_the_cut(container):
    file, counts = written(every_kind, container=container, chunk=50), []
    for at in range(len(file)):
        try:
            _, calls = read(file[:at])
        except TraceError as error:
            assert not counts and re.search("is no trace|cut|empty|ends", str(error))
            continue
        assert is_a_beginning(calls)
        counts.append(len(calls))
    assert counts == sorted(counts) and counts[-1] >= len(WHOLE) - 1
    if container == "snappy":  # cut chunks too are read as far as they go
        assert len(set(counts)) > 10


def test_what_is_entered_and_not_left_is_counted():
    trace, calls = read_data(FIRST_CALL + 2 * CLEAR[:3] + b"\x00\x01\x02\x00")
    assert calls == [(0, "clear", [], None, 0, 0)] and trace.damage is not None
    trace, _ = read_data(FIRST_CALL + 2 * b"\x00\x00\x00\x00")
    assert trace.damage is None and trace.unfinished == 2


@pytest.fixture
def begun(monkeypatch):
    """Counts how often an event is begun."""
    counted = []
    enter = Decoder.enter

    def counting(self, data, at):
        counted.append(at)
        return enter(self, data, at)

    monkeypatch.setattr(Decoder, "enter", counting)
    return counted


def test_a_long_blob_is_begun_few_times(begun):
    blob = bytes(range(256)) * (4 * MB >> 8)
    trace, (call,) = read(written(lambda w: w.call("f", ["x"], [blob]), chunk=2048))
    assert trace.damage is None and call.arguments == [blob]
    assert len(begun) <= 3


def test_many_blobs_of_a_call_are_begun_few_times(begun):
    blobs = [bytes([k]) * 8192 for k in range(256)]
    trace, (call,) = read(written(lambda w: w.call("f", ["x"], [blobs]), chunk=2048))
    assert trace.damage is None and call.arguments == [blobs]
    assert len(begun) <= 14


# ------------------------------------------------------------------------------------------- nonsense

NONSENSE = {
    "an event": (b"\x07", "The event 7 is unknown", 0),
    "a detail": (b"\x00\x00\x00\x06", "The detail 6 of a call is unknown", 3),
    "a thread where none is": (b"\x00\x00\x00\x03\x00", "The detail 3 of a call is unknown", 3),
    "a detail of leaving": (CLEAR[:3] + b"\x00\x01\x01\x09", "The detail 9 of a call is unknown", 6),
    "a value": (ARGUMENT + b"\x10", "The type 16 of a value is unknown", 10),
    "a value in an array": (ARGUMENT + b"\x0b\x01\xff", "The type 255 of a value is unknown", 12),
    "an enumeration": (
        ARGUMENT + b"\x09\x00\x01\x01a\x05",
        "value has the type 5, which is no integer's",
        15,
    ),
    "a backtrace": (b"\x00\x00\x00\x04\x01\x00\x06", "The detail 6 of a backtrace is unknown", 6),
    "a call never entered": (b"\x01\x05\x00", "Call 5 is left, which is not entered", 0),
    "a call left twice": (b"\x01\x00\x00", "Call 0 is left, which is not entered or was left before", 0),
    "a signature again": (CLEAR, "The detail 108 of a call is unknown", 5),
    "a number of 65 bits": (ARGUMENT + b"\x04" + b"\xff" * 9 + b"\x02", "more than 64 bits", 11),
    "a number without end": (ARGUMENT + b"\x04" + b"\x80" * 20, "more than 64 bits", 11),
    "a blob of 4 GB": (ARGUMENT + b"\x08" + varint(1 << 32), "blob has 4,294,967,296 bytes", 11),
    "a text of 2**64 bytes": (ARGUMENT + b"\x07" + varint((1 << 64) - 1), "18,446,744,073,709,551,615", 11),
    "a name of 4 GB": (b"\x00\x00\x07" + varint(1 << 32), "has 4,294,967,296 bytes", 3),
    "an array of 2**40": (ARGUMENT + b"\x0b" + varint(1 << 40), "have 1,099,511,627,776 values", 11),
    "many arrays": (
        ARGUMENT + b"\x0b\x02" + (b"\x0b" + varint(MOST_VALUES - 2)) + bytes(MOST_VALUES - 2) + b"\x0b\x01",
        "1,048,577 values",
        MOST_VALUES + 15,
    ),
    "a wide text of 2**40": (ARGUMENT + b"\x0f" + varint(1 << 40), "have 1,099,511,627,776 values", 11),
    "arrays in arrays": (ARGUMENT + b"\x0b\x01" * 99, f"in more than {DEEPEST} others", 12 + 2 * DEEPEST),
    "values in values": (ARGUMENT + b"\x0e" * 99, f"in more than {DEEPEST} others", 11 + DEEPEST),
    "structures in structures": (
        ARGUMENT + b"\x0c\x00\x00\x01\x01a" + b"\x0c\x00" * 99,
        "in too many others",
        16 + 2 * DEEPEST,
    ),
    "a structure of 2**40": (ARGUMENT + b"\x0c\x00\x00" + varint(1 << 40), "1,099,511,627,776 names", 13),
    "a bitmask of many": (ARGUMENT + b"\x0a\x00" + varint(MOST_NAMES + 1), "has 65,537 names", 12),
    "an enumeration of many": (ARGUMENT + b"\x09\x00" + varint(MOST_NAMES + 1), "has 65,537 names", 12),
    "a function of many": (b"\x00\x00\x01\x00" + varint(256), "has 256 names; 255 are the most", 4),
    "an argument's number": (b"\x00\x00\x00\x01" + varint(255) + b"\x00\x00", "number 255, beyond 255", 7),
    "calls without end": (
        b"\x00\x00\x00\x00" * (MOST_UNFINISHED + 9),
        "4,097 calls are entered and not left",
        4 * MOST_UNFINISHED,
    ),
}


@pytest.mark.parametrize("kind", NONSENSE)
def test_nonsense_ends_a_trace_behind_what_is_whole(kind):
    events, says, place = NONSENSE[kind]
    trace, calls = read_data(FIRST_CALL + events)
    assert [call.name for call in calls] == ["clear"]
    assert says in trace.damage
    place += len(HEADER + FIRST_CALL)
    assert f", at byte {place:,} of the unpacked data, from byte " in trace.damage


def test_arrays_in_as_many_arrays_as_are_read():
    trace, _ = read_data(ARGUMENT + b"\x0b\x01" * DEEPEST + b"\x00\x00\x01\x00\x00")
    assert trace.damage is None


def test_a_place_names_the_chunk():
    first = HEADER + FIRST_CALL
    trace, calls = read(chunks(first, b"", b"\x00\x00\x00\x00\x01\x01\x00", b"\x07"))
    assert len(calls) == 2
    chunk = len(chunks(first, b"", b"\x00\x00\x00\x00\x01\x01\x00"))
    assert f"at byte {len(first) + 7} of the unpacked data, from byte {chunk} of the file on" in trace.damage


def test_functions_without_end_are_refused():
    name = b"\x80\x80\x04" + bytes(1 << 16)
    events = b"".join(b"\x00\x00" + varint(k) + name + b"\x00\x00" for k in range(1, 99))
    trace, _ = read_data(FIRST_CALL + events)
    assert "more names of functions and values than any program" in trace.damage
    assert trace.unfinished == 63


def test_frames_without_end_are_refused(monkeypatch):
    monkeypatch.setattr(decoding, "MOST_SIGNATURES", 5)
    frames = b"".join(b"\x00\x00\x00\x04\x01" + varint(k) + b"\x00\x00" for k in range(9))
    trace, _ = read_data(FIRST_CALL + frames)
    assert "more names of functions and values than any program" in trace.damage and trace.unfinished == 5


def test_what_was_learned_again_is_counted_once(monkeypatch):
    monkeypatch.setattr(decoding, "MOST_SIGNATURE_BYTES", 100_000)
    monkeypatch.setattr(calls_module, "_GROWTH", 1)
    name = b"\x80\x80\x04" + b"n" * (1 << 16)
    data = HEADER + b"\x00\x00\x00" + name + b"\x01\x01x" + b"\x01\x00\x0b" + varint(600) + b"\x03\x01" * 600
    data += b"\x00\x01\x00\x00"
    trace, calls = read(chunks(*(data[k : k + 400] for k in range(0, len(data), 400))))
    assert trace.damage is None and calls[0].arguments == [[-1] * 600]


def test_heavy_calls_that_are_not_left_are_refused(monkeypatch):
    monkeypatch.setattr(calls_module, "_HEAVIEST_UNFINISHED", 3000)
    blob = ARGUMENT + b"\x08" + varint(2000) + bytes(2000) + b"\x00"
    trace, _ = read_data(FIRST_CALL + blob + b"\x00\x00\x00\x00")
    assert trace.damage is None and trace.unfinished == 2
    trace, _ = read_data(FIRST_CALL + blob + b"\x00\x00" + blob[2:3] + blob[8:])
    assert "2 calls are entered and not left" in trace.damage
    array = ARGUMENT + b"\x0b" + varint(50) + b"\x01" * 50 + b"\x00"
    trace, _ = read_data(FIRST_CALL + array)
    assert "1 calls are entered and not left" in trace.damage


def test_calls_that_were_left_weigh_nothing(monkeypatch):
    monkeypatch.setattr(calls_module, "_HEAVIEST_UNFINISHED", 3000)

    def fill(writer):
        for _ in range(20):
            numbers = [writer.enter("f", ["x"], [bytes(1000)], thread=k) for k in range(2)]
            for number in numbers:
                writer.leave(number)

    trace, calls = read(written(fill))
    assert trace.damage is None and len(calls) == 40


def test_an_event_without_end_is_refused(monkeypatch):
    monkeypatch.setattr(calls_module, "LARGEST_EVENT", 10_000)
    blob = b"\x01\x00\x08" + varint(2000) + bytes(2000)
    trace, calls = read(chunks(HEADER + FIRST_CALL, b"\x00\x00\x00", *[blob] * 50))
    assert len(calls) == 1 and "A call has more than 10,000 bytes" in trace.damage


def test_bounds_are_those_of_one_event(monkeypatch):
    monkeypatch.setattr(decoding, "MOST_VALUES", 20)
    monkeypatch.setattr(decoding, "LARGEST_EVENT", 700)

    def fill(writer):
        for _ in range(99):
            writer.call("f", ["x", "y"], [1, None], outputs={1: [1] * 16})
            writer.call("f", ["x", "y"], [1, bytes(500)], outputs={1: bytes(500)})

    trace, calls = read(written(fill, chunk=300))
    assert trace.damage is None and len(calls) == 198


def test_a_piece_s_place_is_known_or_one_before():
    blob = ARGUMENT + b"\x08" + varint(5000) + bytes(5000) + b"\x00\x01\x01\x00\x07"
    file = chunks(HEADER + FIRST_CALL, *(blob[k : k + 1] for k in range(len(blob))))
    trace, calls = read(file)
    assert len(calls) == 2 and len(trace._places) <= 1000
    place = int(trace.damage.split("from byte ")[1].split(" of")[0].replace(",", ""))
    assert 0 < place <= len(file) - 7


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (b"\x00", "version is 0, and 1 to 6 are read, at byte 0"),
        (b"\x07", "version is 7"),
        (b"\xff" * 20, "more than 64 bits"),
        (b"\x06", "ends before its first call, at byte 1"),
        (b"\x06\x06\x05ab", "ends before its first call, at byte 5"),
        (b"\x06\x06" + varint(1 << 40), "1,099,511,627,776 bytes"),
        (b"\x06\x06" + varint(2 * MB), "properties without end"),
        (b"\x06\x06" + b"\x01a\x00" * MB, "properties without end"),
    ],
)
def test_what_is_no_trace_is_an_error(data, says):
    with pytest.raises(TraceError, match=says):
        read(packed(data))


# ------------------------------------------------------------------------------------------- bombs


def without_end(block, times):
    """A stream of gzip that unpacks to a block again and again."""
    packer = zlib.compressobj(9, wbits=31)
    begin = packer.compress(HEADER + FIRST_CALL) + packer.flush(zlib.Z_FULL_FLUSH)
    again = packer.compress(block) + packer.flush(zlib.Z_FULL_FLUSH)
    return begin + again * times


def peak_of_reading(file):
    """(the trace, how many calls, bytes that reading held at most)."""
    tracemalloc.start()
    try:
        trace, calls = read(file)
        return trace, len(calls), tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def brotli_zeros(size):
    """A stream of Brotli of a trace's beginning and zeros, of which it has some bytes for each megabyte."""
    brotli = pytest.importorskip("brotli")
    packer = brotli.Compressor(quality=1)
    parts = [packer.process(HEADER + FIRST_CALL), *(packer.process(bytes(MB)) for _ in range(size // MB))]
    return b"".join(parts) + packer.finish()


BOMBS = {
    "gzip": lambda: without_end(bytes(MB), 2048),
    "brotli": lambda: brotli_zeros(256 * MB),
    "snappy": lambda: written(lambda w: w._put(FIRST_CALL + bytes(63 * MB)), chunk=64 * MB),
}


@pytest.mark.parametrize("kind", BOMBS)
def test_zeros_without_end_are_refused_in_little_memory(kind):
    file = BOMBS[kind]()
    trace, calls, peak = peak_of_reading(file)
    assert calls == 1 and "4,097 calls are entered and not left" in trace.damage
    assert peak < (8 * MB if kind != "snappy" else 200 * MB)


def test_zeros_without_end_in_a_blob_are_refused_in_little_memory():
    packer = zlib.compressobj(9, wbits=31)
    blob = ARGUMENT + b"\x08" + varint(LARGEST_EVENT)
    file = packer.compress(HEADER + FIRST_CALL + blob) + packer.flush(zlib.Z_FULL_FLUSH)
    file += (packer.compress(bytes(MB)) + packer.flush(zlib.Z_FULL_FLUSH)) * 2048
    trace, calls, peak = peak_of_reading(file)
    assert calls == 1 and "blob has 134,217,728 bytes" in trace.damage
    assert peak < 8 * MB


def test_a_trace_is_not_held_whole():
    blob = bytes(MB)

    def fill(writer):
        for _ in range(64):
            writer.call("f", ["x"], [blob])

    file = written(fill, container="gzip")
    tracemalloc.start()
    try:
        trace = calls_module.Trace(io.BytesIO(file))
        assert sum(1 for _ in trace) == 64 and trace.damage is None
        assert tracemalloc.get_traced_memory()[1] < 12 * MB
    finally:
        tracemalloc.stop()


# ------------------------------------------------------------------------------------------- random damage


def damaged(data, dice):
    """Bytes with a few of them changed, taken out, put in, repeated, or cut off."""
    data = bytearray(data)
    for _ in range(dice.randint(1, 3)):
        at = dice.randrange(len(data))
        size = dice.randint(1, 9)
        part = [
            bytes([data[at] ^ 1 << dice.randrange(8)]),
            dice.randbytes(1),
            b"",
            dice.randbytes(size) + data[at : at + 1],
            data[at : at + 1] * size,
            bytes([dice.choice([0, 0x7F, 0x80, 0xFF])]) * size,
        ][dice.randrange(6)]
        data[at : at + (1 if dice.random() < 0.8 else size)] = part
        if dice.random() < 0.1:
            del data[dice.randrange(len(data)) :]
        if not data:
            break
    return bytes(data)


def read_damaged(seed, times):
    """Read files that were damaged, or whose data were before they were packed; counts what came of it."""
    dice = random.Random(seed)
    files = [written(every_kind, container=container, chunk=100) for container in CONTAINERS]
    results = {"error": 0, "damage": 0, "none": 0}
    for k in range(times):
        file = (
            packed(HEADER + damaged(DATA[len(HEADER) :], dice))
            if k % 2
            else damaged(dice.choice(files), dice)
        )
        try:
            trace, calls = read(file)
        except TraceError as error:
            results["error"] += 1
            assert "at byte" in str(error)
            continue
        assert all(type(call.name) is str and type(call.arguments) is list for call in calls)
        results["none" if trace.damage is None else "damage"] += 1
        assert trace.damage is None or "at byte" in trace.damage
    return results


def test_random_damage_ends_in_calls_or_a_sentence():
    results = read_damaged(1, 600)
    assert min(results.values()) > 20


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2, 12))
def test_much_random_damage_ends_in_calls_or_a_sentence(seed):
    read_damaged(seed, 10_000)
