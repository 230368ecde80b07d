"""The answers that a trace recorded, beside those that the Context gives: an oracle for its state.

Compared is what depends on the calls alone: Get, IsEnabled and its like, GenLists, RenderMode. Left out is
what depends on a driver: limits, strings, and what is read from pixels.
"""

from dataclasses import dataclass, field
from typing import Any

from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.context import Context
from fixedpipe.pipeline.opengl.queries import agrees, answer
from fixedpipe.pipeline.traces.calls import Call

# Calls beside queries that return an answer.
ANSWERING = {"glGenLists", "glRenderMode"}
# Different answers that are told apart; the rest are counted.
_MOST_TOLD = 100


@dataclass(frozen=True)
class Difference:
    """An answer that differs: the call, what it asked, what the Context says and what the trace has."""

    call: int
    asked: str
    ours: Any
    recorded: Any

    def __str__(self):
        return f"call {self.call}: {self.asked} is {self.ours}, recorded {self.recorded}"


@dataclass
class Check:
    """Counts answers: ``compared``, of which ``differing`` differ; ``differences`` has the first of these."""

    compared: int = 0
    differing: int = 0
    differences: list[Difference] = field(default_factory=list)

    def query(self, gl: Context, call: Call) -> None:
        """Compare the answer of a query, before the call that follows it."""
        answered = answer(gl, call.name, call.arguments)
        if answered is None:
            return
        recorded = call.arguments[-1] if call.result is None and call.arguments else call.result
        if recorded is None or isinstance(recorded, str | bytes):
            return
        self._count(call, answered, recorded)

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
        return f"{agreed} of {self.compared} recorded answers agree"
