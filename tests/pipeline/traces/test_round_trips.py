"""What a trace's writer writes, its reader reads: every value, container and version."""

import io

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fixedpipe.pipeline.traces.calls import FAKE, Call, Trace, TraceError
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
from tests.pipeline.traces.examples import (
    CONTAINERS,
    EVERY_KIND,
    VERSIONS,
    every_kind,
    read,
    read_data,
    written,
)

LARGEST = (1 << 64) - 1
unsigned = st.one_of(st.integers(0, 300), st.integers(0, LARGEST))
signed = st.one_of(st.integers(-300, 300), st.integers(-LARGEST, LARGEST))
floats = st.one_of(st.floats(width=32), st.floats())
names = st.text(max_size=5)
groups = st.lists(st.tuples(names, signed), max_size=3).map(tuple)
enums = st.one_of(st.builds(Enum, names, signed, groups), st.tuples(names, signed))
bitmasks = st.builds(Bitmask, unsigned, st.lists(st.tuples(names, unsigned), max_size=3).map(tuple))
leaves = st.one_of(
    st.none(),
    st.booleans(),
    signed,
    floats,
    st.text(),
    st.binary(),
    enums,
    bitmasks,
    st.builds(Pointer, unsigned),
    st.builds(WideString, st.text()),
)
values = st.recursive(
    leaves,
    lambda inner: st.one_of(
        st.lists(inner, max_size=4),
        st.lists(floats, max_size=70),
        st.dictionaries(names, inner, max_size=3),
        st.builds(Struct, names, st.dictionaries(names, inner, max_size=3)),
        st.builds(Repr, inner, inner),
    ),
    max_leaves=6,
)

# What is read where a value of the writer's own classes was written.
READ = {
    tuple: lambda value: value[1],
    Enum: lambda value: value.value,
    Bitmask: lambda value: value.value,
    Pointer: lambda value: value.address or None,
    WideString: lambda value: value.text,
    Repr: lambda value: as_read(value.machine),
    Struct: lambda value: as_read(value.members),
    list: lambda value: [as_read(each) for each in value],
    dict: lambda value: {name: as_read(each) for name, each in value.items()},
}


def as_read(value):
    return READ.get(type(value), lambda same: same)(value)


def same(calls, expected):
    """Whether calls are equal, types of their values and signs of zero included; NaN is NaN."""
    return [repr(call) for call in calls] == [repr(call) for call in expected]


@given(values, st.sampled_from(VERSIONS))
def test_a_value_is_read_as_it_was_written(value, version):
    trace, (call,) = read(written(lambda w: w.call("f", ["x"], [value], value), version=version))
    assert trace.damage is None and trace.version == version
    assert same([call], [Call(0, "f", [as_read(value)], as_read(value), 0, 0)])


@st.composite
def programs(draw):
    """Steps of a program whose threads call a few functions with a few arguments: ("enter", what) and
    ("leave", the how many-th of those that are entered, what).
    """
    pool = [
        (
            draw(st.sampled_from(["f", "g", "glVertex3f"])),
            draw(st.one_of(st.lists(values, max_size=3), st.lists(floats, max_size=4))),
        )
        for _ in range(draw(st.integers(1, 4)))
    ]
    steps, entered = [], 0
    for _ in range(draw(st.integers(0, 30))):
        if entered and draw(st.booleans()):
            outputs = draw(st.one_of(st.just({}), st.dictionaries(st.integers(0, 9), values, max_size=2)))
            result = draw(st.one_of(st.none(), values))
            steps.append(("leave", draw(st.integers(0, entered - 1)), result, outputs))
            entered -= 1
        else:
            name, arguments = draw(st.sampled_from(pool))
            flags, thread = draw(st.sampled_from([(0, 0), (0, 0), (FAKE, 1), (0, 200)]))
            steps.append(("enter", name, arguments, flags, thread))
            entered += 1
    return steps


@given(programs(), st.sampled_from(VERSIONS), st.sampled_from(CONTAINERS), st.sampled_from([1, 7, 1 << 20]))
def test_calls_of_several_threads_are_read_as_they_were_written(steps, version, container, chunk):
    entered, expected, file = [], [], io.BytesIO()
    with TraceWriter(file, version=version, container=container, chunk=chunk) as writer:
        for what, *step in steps:
            if what == "enter":
                name, arguments, flags, thread = step
                names_of = ["x"] * len(arguments)
                number = writer.enter(name, names_of, arguments, flags=flags, thread=thread)
                entered.append(Call(number, name, as_read(arguments), None, flags, thread))
                continue
            position, result, outputs = step
            call = entered.pop(position)
            writer.leave(call.number, result, outputs=outputs)
            for index, value in outputs.items():
                call.arguments.extend([None] * (index + 1 - len(call.arguments)))
                call.arguments[index] = as_read(value)
            expected.append(call._replace(result=as_read(result)))
    trace, calls = read(file.getvalue())
    assert trace.damage is None and trace.unfinished == len(entered)
    assert same(calls, expected)


@pytest.mark.parametrize("container", CONTAINERS)
@pytest.mark.parametrize("version", VERSIONS)
def test_every_container_holds_every_version(container, version):
    trace, calls = read(written(every_kind, container=container, version=version))
    assert trace.damage is None and not trace.unfinished
    assert same(calls, read(EVERY_KIND)[1])
    assert [call.name for call in calls if call.thread == 200] == ["wait", "wait"]


def test_properties_are_read():
    properties = {"process.name": "/usr/bin/glxgears", "os": ""}
    trace, _ = read(written(every_kind, properties=properties))
    assert trace.properties == properties


@pytest.mark.parametrize("version", VERSIONS)
def test_the_first_name_of_a_value_is_kept(version):
    def fill(writer):
        writer.call("f", ["x"], [Enum("GL_POINTS", 0)])
        writer.call("f", ["x"], [Enum("GL_ZERO", 0, (("GL_ZERO", 0), ("GL_ONE", 1)))])
        writer.call("f", ["x"], [Bitmask(2, (("BIT", 2),))])

    trace, _ = read(written(fill, version=version))
    assert trace.enum_names == ({0: "GL_POINTS", 1: "GL_ONE"} if version > 2 else {0: "GL_POINTS"})


def test_many_signatures_have_their_numbers():
    def fill(writer):
        for k in (*range(300), *range(300)):
            writer.call(f"f{k}", ["x", "y"], [Enum(f"E{k}", 1000 + k), {f"m{k}": Bitmask(k, (("b", k),))}])

    for version in VERSIONS:
        trace, calls = read(written(fill, version=version))
        assert trace.damage is None and len(calls) == 600
        for call in calls:
            k = call.number % 300
            assert call[1:3] == (f"f{k}", [1000 + k, {f"m{k}": k}])


def test_a_caller_s_changes_of_arguments_are_nobody_else_s():
    def fill(writer):
        for _ in range(4):
            writer.call("f", ["x", "y"], [1, ""])
            writer.call("g", ["x"], [1.0])
            writer.call("h", ["x", "y"], [[1], {"a": 2}])

    trace, calls = Trace(io.BytesIO(written(fill))), []
    for call in trace:
        calls.append(repr(call.arguments))
        if call.name == "h":
            call.arguments[0].append(3)
            call.arguments[1].clear()
        call.arguments.clear()
    assert calls == ["[1, '']", "[1.0]", "[[1], {'a': 2}]"] * 4


def test_arguments_that_are_not_given_are_none():
    _, (call,) = read(written(lambda w: w.call("f", ["x", "y", "z"], [1])))
    assert call.arguments == [1, None, None]


def test_floats_in_another_order_are_at_their_positions():
    event = b"\x00\x00\x00\x01f\x02\x01x\x01y" + b"\x01\x01\x05\x00\x00\x80?\x01\x00\x05\x00\x00\x00@\x00"
    again = b"\x00\x00\x00" + event[10:]
    trace, calls = read_data(event + b"\x01\x00\x00" + again + b"\x01\x01\x00" + again + b"\x01\x02\x00")
    assert trace.damage is None
    assert [call.arguments for call in calls] == [[2.0, 1.0]] * 3


def test_details_behind_floats_are_read():
    floats, signature = b"\x01\x00\x05\x00\x00\x80?", b"\x01f\x01\x01x"
    events = b""
    for k in range(5):
        events += b"\x00\x00\x00" + (b"" if k else signature) + floats + bytes([5, k, 0, 1, k, 0])
    trace, calls = read_data(events)
    assert trace.damage is None and calls == [Call(k, "f", [1.0], None, k, 0) for k in range(5)]


def test_a_short_event_at_the_end_is_not_taken_for_floats():
    # Both functions' numbers begin with the byte 85.
    floats = b"\x00\x00\x85\x01" + b"".join(bytes([1, k, 5, 0, 0, 0, 0]) for k in range(3)) + b"\x00"
    learned = floats[:4] + b"\x01f\x03\x01x\x01y\x01z" + floats[4:]
    other = b"\x00\x00\x85\x02\x01g\x00\x00\x01\x00\x00"
    trace, calls = read_data(
        other + learned + b"\x01\x01\x00" + floats + b"\x01\x02\x00" + b"\x00\x00\x85\x02\x00"
    )
    assert [call.name for call in calls] == ["g", "f", "f"]
    assert trace.damage is None and trace.unfinished == 1


def test_a_call_may_be_left_128_calls_later():
    file = io.BytesIO()
    with TraceWriter(file) as writer:
        writer.enter("f", ["x"], [0])
        for _ in range(126):
            writer.call("f", ["x"], [1])
        writer.enter("f", ["x"], [127])
        writer.enter("f", ["x"], [128])
        for number in (0, 127, 128):
            writer.leave(number)
    trace, calls = read(file.getvalue())
    assert trace.damage is None
    assert [(c.number, c.arguments[0]) for c in calls[-3:]] == [(0, 0), (127, 127), (128, 128)]


def test_halves_of_utf_16_are_one_character_and_what_is_none_is_marked():
    halves = varint(0xD834) + varint(0xDD1E)
    event = b"\x00\x00\x00\x01f\x01\x01x\x01\x00\x0f\x04" + halves + varint(0xD834) + varint(1 << 40)
    trace, (call,) = read_data(event + b"\x00\x01\x00\x00")
    assert trace.damage is None and call.arguments == ["\U0001d11e\ufffd\ufffd"]


def test_text_that_is_no_utf_8_is_marked():
    _, (call,) = read_data(b"\x00\x00\x00\x01f\x01\x01x\x01\x00\x07\x02a\xff\x00\x01\x00\x00")
    assert call.arguments == ["a\ufffd"]


@pytest.mark.parametrize("number", [0, 127, 128, (1 << 14) - 1, 1 << 14, LARGEST])
def test_numbers_at_the_ends_of_their_lengths(number):
    _, (call,) = read(written(lambda w: w.call("f", ["x"], [number], Pointer(number))))
    assert call.arguments == [number] and call.result == (number or None)


def test_many_calls_have_their_numbers():
    def fill(writer):
        for k in range(40_000):
            writer.call("f", ["x"], [k % 9])

    _, calls = read(written(fill))
    assert [call.number for call in calls] == list(range(40_000))
    assert [call.arguments for call in calls] == [[k % 9] for k in range(40_000)]


def test_a_path_is_opened_and_closed(tmp_path):
    path = tmp_path / "own.trace"
    with TraceWriter(path, container="gzip") as writer:
        writer.call("f", [], [])
        writer.call("g", [], [])
    with Trace(path) as trace, Trace(str(path)) as other:
        assert next(trace).name == "f" and [call.name for call in other] == ["f", "g"]
    assert list(trace) == []


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"version": 0}, "versions 1 to 6; 0 is none"),
        ({"version": 7}, "7 is none"),
        ({"version": 5, "properties": {"a": "b"}}, "are of version 6"),
        ({"properties": {"": "b"}}, "have names"),
        ({"container": "zip"}, "snappy, gzip, brotli; 'zip' is none"),
        ({"chunk": 0}, "0 is none"),
    ],
)
def test_a_writer_says_what_no_trace_has(options, says):
    with pytest.raises(ValueError, match=says):
        TraceWriter(io.BytesIO(), **options)


@pytest.mark.parametrize("value", [1 << 64, -(1 << 64), Pointer(-1), Bitmask(1 << 64)])
def test_a_writer_refuses_numbers_of_more_than_64_bits(value):
    with pytest.raises(ValueError, match="at most 64 bits"), TraceWriter(io.BytesIO()) as writer:
        writer.call("f", ["x"], [value])


def test_a_writer_refuses_values_that_no_trace_has():
    with pytest.raises(TypeError, match="no values such as 1j, which is a complex"):
        written(lambda w: w.call("f", ["x"], [1j]))


@pytest.mark.parametrize("frames", [[Frame()], [Frame("m", "f", "c", 1, 2)] * 2, [Frame("m"), Frame(line=3)]])
def test_backtraces_are_passed(frames):
    def fill(writer):
        for _ in range(2):
            writer.leave(writer.enter("f", ["x"], [1], backtrace=frames))

    trace, calls = read(written(fill))
    assert trace.damage is None and [call.arguments for call in calls] == [[1], [1]]


def test_a_trace_error_is_a_value_error():
    assert issubclass(TraceError, ValueError)
