"""Compares the answers that a trace recorded with the Context's own: an oracle for its state.

Compared is what depends on the calls alone: Get, IsEnabled and its like, GenLists, RenderMode. Answers that
depend on a driver are left out: limits, strings, and pixels that are read.

Occlusion queries are counted apart: two drivers place the edges of triangles differently, so that counts that
differ a little are both right.
"""

from dataclasses import dataclass, field
from typing import Any

from fixedpipe.effects.replays.windows import only
from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.context import Context
from fixedpipe.pipeline.opengl.queries import agrees, answer
from fixedpipe.pipeline.traces.calls import Call

# Calls beside queries that return an answer.
ANSWERING = {"glGenLists", "glRenderMode"}
# Queries of how many samples passed, and what of them is no number of samples but a matter of time.
_OF_SAMPLES = ("glGetQueryObject", "glGetOcclusionQuery")
# Different answers that are told apart; the rest are counted.
_MOST_TOLD = 100


@dataclass(frozen=True)
class Difference:
    """An answer that differs: the call, its question, the Context's answer and the trace's."""

    call: int
    asked: str
    ours: Any
    recorded: Any

    def __str__(self):
        return f"call {self.call}: {self.asked} is {self.ours}, recorded {self.recorded}"


@dataclass
class Check:
    """Counts answers: ``compared``, of which ``differing`` differ; ``differences`` has the first of these.

    - ``counts``: how many counts of samples there were, of which ``equal_counts`` are the machine's.
    - ``widest_count``: the largest difference of these, as a fraction of the larger count.
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
        self._count(call, answered, recorded)

    def _count_samples(self, call, ours):
        """Compare a count; whether one is there yet is a matter of time."""
        recorded = only(call.arguments[-1])
        if call.arguments[1] != tokens.QUERY_RESULT or not isinstance(recorded, int):
            return
        self.counts += 1
        self.equal_counts += ours == recorded
        self.widest_count = max(self.widest_count, abs(ours - recorded) / max(ours, recorded, 1))

    def returned(self, call: Call, ours: Any) -> None:
        """Compare what a call returned."""
        if call.result is not None and ours is not None:
            self._count(call, (ours,), call.result)

    def _count(self, call, answered, recorded):
        self.compared += 1
        try:
            same = agrees(answered, recorded)
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
