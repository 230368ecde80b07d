"""Occlusion queries: ARB_occlusion_query, NV_occlusion_query and HP_occlusion_test.

This module has their state and OpenGL's errors. Only a machine knows how many samples passed. A Context with
a machine behind it reads the number from it (``read_back``). A recorded program acted on its driver's answer.
"""

from typing import Any

from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.capabilities import capability
from fixedpipe.pipeline.opengl.entry_points import entry
from fixedpipe.pipeline.opengl.outcomes import GLError, Refused
from fixedpipe.pipeline.opengl.values import declare

# Source: the Khronos registry: HP_occlusion_test (the capability, the token for Get); ARB_occlusion_query.
_OCCLUSION_TEST_HP, OCCLUSION_TEST_RESULT_HP = 0x8165, 0x8166
_SAMPLES_PASSED = 0x8914


def _begin_or_end(gl, begun):
    """Begin to count samples, or end it. Returns the count, or None."""
    return None if gl.behind is None else gl.behind.count_samples(begun)


def _test(gl, enabled):
    """Begin or end HP's test."""
    _begin_or_end(gl, enabled)


def test_result(gl: Any) -> bool:
    """Whether a sample passed since HP's test was enabled, or since the last such query. Raises Refused."""
    samples = _begin_or_end(gl, False)
    if samples is None:
        raise Refused("samples are not counted here")
    if gl.values["enabled", _OCCLUSION_TEST_HP]:
        _begin_or_end(gl, True)
    return samples > 0


capability(_OCCLUSION_TEST_HP, notify=_test)
declare("queries", frozenset())  # the names of queries that were begun at least once
declare("current query", 0)


@entry("GenQueries", "GenOcclusionQueries", compiled=False)
def gen_queries(gl, count, names=None):
    """Check the number of names. In a trace the driver has chosen the names; they are not stored."""
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
    """Whether a query was begun at least once."""
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
    """End the query."""
    _samples(target)
    _end(gl)


@entry("BeginOcclusionQuery")
def begin_occlusion_query(gl, name):
    """Begin a query of NVIDIA's extension, which only counts samples."""
    _begin(gl, name)


@entry("EndOcclusionQuery")
def end_occlusion_query(gl):
    """End the query."""
    _end(gl)


@entry("GetQueryiv", compiled=False)
def get_query(gl, target, name, *_recorded):
    """The name of the active query, or 0. The number of bits of a counter depends on the recorded driver."""
    _samples(target)
    if name == tokens.QUERY_COUNTER_BITS:
        raise Refused("samples are not counted here")
    if name != tokens.CURRENT_QUERY:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(name)} is nothing that a query tells")
    return gl.values["current query"]


@entry("GetQueryObjectiv", "GetQueryObjectuiv", "GetOcclusionQueryiv", "GetOcclusionQueryuiv", compiled=False)
def get_query_object(gl, name, parameter, *_recorded):
    """How many samples passed, or whether the number is available (always True). Raises Refused if samples
    are not counted.
    """
    if name not in gl.values["queries"] or name == gl.values["current query"]:
        raise GLError(tokens.INVALID_OPERATION, f"{name} is no query that has ended")
    if parameter == tokens.QUERY_RESULT_AVAILABLE:
        return True
    if parameter != tokens.QUERY_RESULT:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(parameter)} is nothing that a query tells")
    if name not in gl.samples_passed:
        raise Refused("samples are not counted here")
    return gl.samples_passed[name]
