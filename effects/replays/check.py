"""Compares the answers that a trace recorded with the Context's answers. This tests the Context's state.

It compares answers that depend only on the calls: Get, IsEnabled and similar ones, GenLists, RenderMode. It
leaves out answers that depend on a driver: limits, strings, and pixels that are read.

It counts occlusion queries separately. Two drivers place the edges of triangles differently, so two counts
that differ a little may both be right.
"""

from dataclasses import dataclass, field
from typing import Any

from fixedpipe.effects.replays.windows import only
from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.context import Context
from fixedpipe.pipeline.opengl.queries import agrees, answer, is_computed
from fixedpipe.pipeline.traces.calls import Call

# Calls that return an answer and are not queries.
ANSWERING = {"glGenLists", "glRenderMode"}
# Queries of how many samples passed, and whether the number is available yet.
_OF_SAMPLES = ("glGetQueryObject", "glGetOcclusionQuery")
# Queries of several values, of which apitrace records the first alone. Measured: apitrace 11.1.
_OF_ONE_VALUE = ("glGetMap", "glGetPixelMap")
# A mask's bits beyond the stencil buffer's 8 change nothing. Some drivers return them, others do not.
# Source: OpenGL 1.2.1 sections 4.1.5 and 4.2.2, "the least significant s bits".
_STENCIL_MASKS = (tokens.STENCIL_VALUE_MASK, tokens.STENCIL_WRITEMASK)
_STENCIL = 0xFF
# The most different answers that are stored; the rest are only counted.
_MOST_TOLD = 100


@dataclass(frozen=True)
class Difference:
    """An answer that differs: the call's number, its question, the Context's answer and the trace's."""

    call: int
    asked: str
    ours: Any
    recorded: Any

    def __str__(self):
        return f"call {self.call}: {self.asked} is {self.ours}, recorded {self.recorded}"


def _stencil_bits(mask):
    """The bits of a recorded mask that the stencil buffer has; what is no mask stays as it is."""
    return mask & _STENCIL if isinstance(mask, int) else mask


@dataclass
class Check:
    """Counts answers: ``compared`` ones, and ``differing`` ones among them. ``differences`` has the first of
    the latter.

    - ``counts``: how many counts of samples were compared; ``equal_counts``: how many of them are equal.
    - ``widest_count``: the largest difference of two counts, as a fraction of the larger one.
    """

    compared: int = 0
    differing: int = 0
    differences: list[Difference] = field(default_factory=list)
    counts: int = 0
    equal_counts: int = 0
    widest_count: float = 0.0

    def query(self, gl: Context, call: Call) -> None:
        """Compare the answer of a query, before the call that follows it."""
        answered = answer(gl, call.name, call.arguments)
        if answered is None:
            return
        if call.name.startswith(_OF_SAMPLES):
            self._count_samples(call, *answered)
            return
        recorded = call.arguments[-1] if call.result is None and call.arguments else call.result
        if recorded is None or isinstance(recorded, str | bytes):
            return
        if call.name.startswith(_OF_ONE_VALUE):
            answered = answered[:1]
        if call.arguments and call.arguments[0] in _STENCIL_MASKS:
            answered, recorded = (_stencil_bits(answered[0]),), _stencil_bits(only(recorded))
        self._count(call, answered, recorded)

    def _count_samples(self, call, ours):
        """Compare a count of samples. Whether it is available yet depends on time, and is not compared."""
        recorded = only(call.arguments[-1])
        if call.arguments[1] != tokens.QUERY_RESULT or not isinstance(recorded, int):
            return
        self.counts += 1
        self.equal_counts += ours == recorded
        self.widest_count = max(self.widest_count, abs(ours - recorded) / max(ours, recorded, 1))

    def returned(self, call: Call, ours: Any) -> None:
        """Compare the value that a call returned."""
        if call.result is not None and ours is not None:
            self._count(call, (ours,), call.result)

    def _count(self, call, answered, recorded):
        self.compared += 1
        try:
            same = agrees(answered, recorded, is_computed(call.name, call.arguments))
        except (TypeError, ValueError):
            same = False
        if same:
            return
        self.differing += 1
        if len(self.differences) < _MOST_TOLD:
            given = [a for a in call.arguments if isinstance(a, int)]
            asked = f"{call.name}({', '.join(map(tokens.name_of, given))})"
            told = answered[0] if len(answered) == 1 else list(answered)
            self.differences.append(Difference(call.number, asked, told, recorded))

    def __str__(self):
        agreed = self.compared - self.differing
        said = f"{agreed} of {self.compared} recorded answers agree"
        if not self.counts:
            return said
        said += f"; {self.equal_counts} of {self.counts} counts of samples are the recorded ones"
        if self.equal_counts == self.counts:
            return said
        return f"{said}, and the others differ by {100 * self.widest_count:.3g} % at most"
