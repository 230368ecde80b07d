"""What states have in common that differ in their vertices' part and in constant colours alone: a program
that moves things, or colours them, draws each in a state of its own, and all of them are of a kind.
"""

from dataclasses import fields
from operator import attrgetter

from fixedpipe.pipeline.interned_states import all_interned
from fixedpipe.pipeline.state import PassState

_MOST = 1024
_SECTIONS = attrgetter(
    *(field.name for field in fields(PassState) if field.name not in ("vertex", "register_combiners"))
)
_PROGRAM = attrgetter(
    "general", "final", "color_sum_clamp", "mux_select", "invert_spare0", "invert_secondary_color"
)
_of_state: dict = {}  # id of a state: the state, and its Kind
_kinds: dict = {}  # what a Kind is made of, by identity: the Kind


class Kind:
    """All of a PassState but its vertices' part and constant colours; equal ones are one object.

    held     what is told apart by identity, which lives as long
    """

    __slots__ = ("held",)

    def __init__(self, held):
        self.held = held


def kind_of(state: PassState) -> Kind:
    """The Kind of a state."""
    found = _of_state.get(id(state))
    if found is None:
        if len(_of_state) >= _MOST:
            _of_state.clear()
        found = _of_state[id(state)] = state, _kind(state)
    return found[1]


def _kind(state):
    vertex, program = state.vertex, state.register_combiners
    lighting = vertex.lighting
    held = (
        vertex.stage,
        lighting is not None and lighting.separate_specular_color,
        *all_interned(_SECTIONS(state)),
        *(() if program is None else all_interned(_PROGRAM(program))),
    )
    key = tuple(map(id, held))
    kind = _kinds.get(key)
    if kind is None:
        if len(_kinds) >= _MOST:
            _kinds.clear()
        kind = _kinds[key] = Kind(held)
    return kind
