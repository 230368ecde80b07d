"""Traces of real programs, which lie beside the checkout."""

from pathlib import Path

import pytest

from fixedpipe.pipeline.traces.calls import FAKE, Trace
from fixedpipe.pipeline.traces.recent_events import RecentEvents

FOLDER = Path(__file__).resolve().parents[4] / "shared" / "replay" / "traces"
FILES = sorted(path.relative_to(FOLDER).as_posix() for path in FOLDER.rglob("*.trace"))
# Calls, by file; glxgears was killed in a call.
CALLS = {
    "glxgears.trace": (99_776, 1),
    "gltron.trace": (130_553, 0),
    "openarena_3frames_brotli.trace": (289_250, 0),
    "bouncingcow.trace": (1_997, 0),
}


@pytest.mark.needs_shared
def test_there_are_traces(shared):
    assert len(FILES) >= 76 and shared / "replay" / "traces" == FOLDER


@pytest.mark.needs_shared
@pytest.mark.parametrize("name", FILES)
def test_a_trace_is_whole(name, shared):
    with Trace(shared / "replay" / "traces" / name) as trace:
        numbers = [call.number for call in trace]
        assert trace.damage is None and trace.version == 6 and "process.name" in trace.properties
    count, unfinished = CALLS.get(name, (len(numbers), 0))
    assert (len(numbers), trace.unfinished) == (count, unfinished)
    assert len(set(numbers)) == count and 0 < count <= 1 + max(numbers) <= count + unfinished


@pytest.mark.needs_shared
def test_values_of_a_trace(shared):
    trace = Trace(shared / "replay" / "traces" / "rc.trace")
    calls = list(trace)
    assert trace.enum_names[0x0DE1] == "GL_TEXTURE_2D"
    assert all(call.thread == 0 for call in calls) and {call.flags for call in calls} == {0, FAKE}
    begin = next(call for call in calls if call.name == "glBegin")
    assert begin.arguments[0] in range(10)


@pytest.mark.needs_shared
@pytest.mark.parametrize("name", ["glxgears.trace", "rc.trace", "gltron.trace"])
def test_calls_found_again_are_those_that_are_decoded(name, shared, monkeypatch):
    path = shared / "replay" / "traces" / name
    found = [repr(call) for call in Trace(path)]
    monkeypatch.setattr(RecentEvents, "keep", lambda *event: None)
    assert found == [repr(call) for call in Trace(path)]
