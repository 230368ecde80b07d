"""Occlusion queries: ARB_occlusion_query, NV_occlusion_query and HP_occlusion_test.

Their state is kept, and errors are OpenGL's. How many samples passed is not counted: nothing is drawn here,
and a recorded program has acted on its own driver's answer.
"""

from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.capabilities import capability
from fixedpipe.pipeline.opengl.entry_points import entry
from fixedpipe.pipeline.opengl.outcomes import GLError, Refused
from fixedpipe.pipeline.opengl.values import declare

# HP_occlusion_test: the capability; its result is a Get.
_OCCLUSION_TEST_HP = 0x8165
_SAMPLES_PASSED = 0x8914

capability(_OCCLUSION_TEST_HP)
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


@entry("IsQuery", "IsOcclusionQuery", compiled=False)
def is_query(gl, name):
    """Whether a query was begun once."""
    return name in gl.values["queries"]


def _begin(gl, name):
    if gl.values["current query"] or not name:
        raise GLError(tokens.INVALID_OPERATION, "a query is begun already" if name else "0 is no query")
    gl.values.set("current query", int(name))
    gl.values.set("queries", gl.values["queries"] | {int(name)})
    gl.tally.add("no effect", gl.called)


def _end(gl):
    if not gl.values["current query"]:
        raise GLError(tokens.INVALID_OPERATION, "no query is begun")
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
