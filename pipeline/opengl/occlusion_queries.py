"""Occlusion queries: ARB_occlusion_query, NV_occlusion_query and HP_occlusion_test.

Their state is kept, and errors are OpenGL's. How many samples passed only a machine knows: a Context with one
behind it asks it (``read_back``). A recorded program has acted on its own driver's answer.
"""

from typing import Any

from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.capabilities import capability
from fixedpipe.pipeline.opengl.entry_points import entry
from fixedpipe.pipeline.opengl.outcomes import GLError, Refused
from fixedpipe.pipeline.opengl.values import declare

# Source: the Khronos registry: HP_occlusion_test, the capability and what Get gives; ARB_occlusion_query.
_OCCLUSION_TEST_HP, OCCLUSION_TEST_RESULT_HP = 0x8165, 0x8166
_SAMPLES_PASSED = 0x8914


def _begin_or_end(gl, begun):
    """Begin to count, or end it: the count, or None."""
    return None if gl.behind is None else gl.behind.count_samples(begun)


def _test(gl, enabled):
    """HP's test begins or ends."""
    _begin_or_end(gl, enabled)


def test_result(gl: Any) -> bool:
    """Whether a sample passed since HP's test was enabled, or since this was asked. Raises Refused."""
    samples = _begin_or_end(gl, False)
    if samples is None:
        raise Refused("samples are not counted here")
    if gl.values["enabled", _OCCLUSION_TEST_HP]:
        _begin_or_end(gl, True)
    return samples > 0


capability(_OCCLUSION_TEST_HP, notify=_test)
declare("queries", frozenset())  # those that were begun once, by name
declare("current query", 0)


@entry("GenQueries", "GenOcclusionQueries", compiled=False)
def gen_queries(gl, count, names=None):
    """Names of queries; in a trace those that the driver gave. They need not be entered."""
    if count < 0:
        raise GLError(tokens.INVALID_VALUE, f"{count} queries")


@entry("DeleteQueries", "DeleteOcclusionQueries", compiled=False)
def delete_queries(gl, count, names):
    """Forget queries."""
    if count < 0:
        raise GLError(tokens.INVALID_VALUE, f"{count} queries")
    gl.values.set("queries", gl.values["queries"] - set(names[:count]))
    for name in names[:count]:
        gl.samples_passed.pop(name, None)


@entry("IsQuery", "IsOcclusionQuery", compiled=False)
def is_query(gl, name):
    """Whether a query was begun once."""
    return name in gl.values["queries"]


def _begin(gl, name):
    if gl.values["current query"] or not name:
        raise GLError(tokens.INVALID_OPERATION, "a query is begun already" if name else "0 is no query")
    gl.values.set("current query", int(name))
    gl.values.set("queries", gl.values["queries"] | {int(name)})
    gl.samples_passed.pop(int(name), None)
    _begin_or_end(gl, True)
    gl.tally.add("no effect", gl.called)


def _end(gl):
    if not gl.values["current query"]:
        raise GLError(tokens.INVALID_OPERATION, "no query is begun")
    samples = _begin_or_end(gl, False)
    if samples is not None:
        gl.samples_passed[gl.values["current query"]] = samples
    gl.values.set("current query", 0)
    gl.tally.add("no effect", gl.called)


def _samples(target):
    if target != _SAMPLES_PASSED:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(target)} is nothing that queries count here")


@entry("BeginQuery")
def begin_query(gl, target, name):
    """Begin to count samples."""
    _samples(target)
    _begin(gl, name)


@entry("EndQuery")
def end_query(gl, target):
    """End it."""
    _samples(target)
    _end(gl)


@entry("BeginOcclusionQuery")
def begin_occlusion_query(gl, name):
    """NVIDIA's, which count samples alone."""
    _begin(gl, name)


@entry("EndOcclusionQuery")
def end_occlusion_query(gl):
    """End it."""
    _end(gl)


@entry("GetQueryiv", compiled=False)
def get_query(gl, target, name, *_recorded):
    """The query that is begun; 0: none is. How many bits a counter has is the recorded driver's."""
    _samples(target)
    if name == tokens.QUERY_COUNTER_BITS:
        raise Refused("samples are not counted here")
    if name != tokens.CURRENT_QUERY:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(name)} is nothing that a query tells")
    return gl.values["current query"]


@entry("GetQueryObjectiv", "GetQueryObjectuiv", "GetOcclusionQueryiv", "GetOcclusionQueryuiv", compiled=False)
def get_query_object(gl, name, parameter, *_recorded):
    """How many samples passed, or whether that is known: it is. Raises Refused where nothing is counted."""
    if name not in gl.values["queries"] or name == gl.values["current query"]:
        raise GLError(tokens.INVALID_OPERATION, f"{name} is no query that has ended")
    if parameter == tokens.QUERY_RESULT_AVAILABLE:
        return True
    if parameter != tokens.QUERY_RESULT:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(parameter)} is nothing that a query tells")
    if name not in gl.samples_passed:
        raise Refused("samples are not counted here")
    return gl.samples_passed[name]
