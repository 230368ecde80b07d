"""Equal states are one object, and what draws by that draws what each of them says."""

import pickle
import re
from copy import deepcopy
from dataclasses import fields, is_dataclass, replace
from enum import Enum

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fixedpipe.pipeline import interned_states as interned_module
from fixedpipe.pipeline import state_kinds
from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.enums import BlendFactor, ComparisonFunction, Register, StencilOperation, VertexStage
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.interned_states import interned
from fixedpipe.pipeline.native import state_rows
from fixedpipe.pipeline.profiles import NV2A
from fixedpipe.pipeline.state import (
    AlphaTest,
    Blending,
    CombinerInput,
    DepthTest,
    Fog,
    Lighting,
    PassState,
    PolygonState,
    RegisterCombiners,
    StencilTest,
    TextureUnit,
    VertexState,
)
from fixedpipe.pipeline.state_kinds import kind_of
from fixedpipe.pipeline.validation import walk
from fixedpipe.pipeline.validation.validate import _CHECKS
from fixedpipe.pipeline.validation.walk import UnsupportedState
from fixedpipe.pipeline.vertices import plan
from tests import fuzz
from tests.support.random_frames import random_frame


def forget():
    """As in a process that has drawn nothing."""
    interned_module._by_value.clear()
    interned_module._forget()
    state_kinds._of_state.clear()
    state_kinds._kinds.clear()
    state_rows._rows.clear()
    state_rows._first_rows.clear()
    plan._formulas.clear()
    walk._taken.clear()


def states(seed):
    """The states of a random frame's Draws."""
    return [command.state for command in random_frame(seed).commands if isinstance(command, Draw)]


def others(value):
    """Values that differ from a state, or a part of one, in one number, member or text."""
    if is_dataclass(value):
        for field in fields(value):
            for other in others(getattr(value, field.name)):
                yield replace(value, **{field.name: other})
    elif isinstance(value, tuple):
        for k, element in enumerate(value):
            for other in others(element):
                yield (*value[:k], other, *value[k + 1 :])
    elif isinstance(value, Enum):
        yield next(member for member in (*type(value), *StencilOperation) if member is not value)
        yield value.value
    elif isinstance(value, bool):
        yield not value
        yield int(value)
    elif isinstance(value, int | float):
        yield value + 1
        yield -value if value else -float(value)  # of a zero, either one
        yield float(value) if isinstance(value, int) else np.float64(value)
    elif value is None:
        yield 0
    else:
        yield value + value[:1]


@pytest.mark.parametrize("seed", range(30))
def test_a_copy_is_found_and_nothing_else(seed):
    forget()
    for state in states(800_000 + seed):
        first = interned(pickle.loads(pickle.dumps(state)))
        assert first == state
        assert interned(pickle.loads(pickle.dumps(state))) is first
        assert interned(deepcopy(state)) is first
        different = list(others(first))
        assert len(different) > 50
        for other in different[seed % 7 :: 7]:
            assert interned(other) is not first
            if _CHECKS[PassState](other) is None:  # of what is refused nobody asks the kind
                assert kind_of(first) is not kind_of(other) or _moves_or_colors(first, other)


def _moves_or_colors(one, other):
    """Whether states differ in the vertices' part and the two constant colours alone."""
    program = other.register_combiners
    if isinstance(program, RegisterCombiners):
        colors = {f"constant_color{k}": getattr(program, f"constant_color{k}") for k in (0, 1)}
        one = replace(one, register_combiners=replace(one.register_combiners, **colors))
    return repr(replace(one, vertex=other.vertex)) == repr(other)


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (AlphaTest(reference=0.0), AlphaTest(reference=-0.0)),
        (AlphaTest(reference=1.0), AlphaTest(reference=1)),
        (AlphaTest(reference=1.0), AlphaTest(reference=True)),
        (AlphaTest(reference=1.0), AlphaTest(reference=np.float64(1.0))),
        (AlphaTest(reference=np.float32(1.0)), AlphaTest(reference=np.int32(0x3F800000))),
        (PassState(color_sum=False), PassState(color_sum=0)),
        (DepthTest(ComparisonFunction.LESS), DepthTest(int(ComparisonFunction.LESS))),
        (Blending(color=(0.0,) * 4), Blending(color=[0.0] * 4)),
        (PolygonState(stipple=bytes(128)), PolygonState(stipple=np.zeros(128, np.uint8))),
        (Blending(BlendFactor.ONE), Blending(Register(int(BlendFactor.ONE)))),
    ],
)
def test_what_equals_but_is_something_else_is_not_found(one, other):
    for first, second in ((one, other), (other, one)):
        forget()
        found = interned(first)
        assert interned(second) is not found


@pytest.mark.parametrize("value", [None, 3, "a", [1], object(), PassState, {"a": 1}])
def test_what_is_no_state_is_itself(value):
    assert interned(value) is value


def test_what_is_remembered_is_bounded():
    for k in range(3 * interned_module._MOST):
        interned(PassState(alpha_test=AlphaTest(reference=k / 8)))
        kind_of(PassState(alpha_test=AlphaTest(reference=k / 8)))
    assert len(interned_module._known) <= interned_module._MOST + 4
    assert len(interned_module._by_value) <= interned_module._MOST + 4
    assert len(state_kinds._kinds) <= state_kinds._MOST and len(state_kinds._of_state) <= state_kinds._MOST


def test_states_that_move_and_color_are_of_a_kind():
    kind, shown = kind_of(COMBINED), replace(COMBINED, vertex=VertexState(clip_planes=((1.0,) * 4,)))
    colored = replace(COMBINED, register_combiners=RegisterCombiners(constant_color1=(1.0,) * 4))
    assert kind_of(shown) is kind_of(colored) is kind_of(deepcopy(colored)) is kind


@pytest.mark.parametrize(
    "vertex",
    [
        VertexState(stage=VertexStage.PROGRAM_RESULTS),
        VertexState(lighting=Lighting(separate_specular_color=True)),
    ],
)
def test_what_the_rest_of_a_state_goes_by_makes_another_kind(vertex):
    assert kind_of(replace(COMBINED, vertex=vertex)) is not kind_of(COMBINED)


def changed(state, random):
    """A state of the same kind: moved, and in other constant colours."""
    matrix = [list(row) for row in state.vertex.modelview]
    for _ in range(int(random.integers(0, 3))):
        matrix[random.integers(4)][random.integers(4)] = float(random.choice([0.0, -0.0, 1.0, 0.75, -1.0]))
    vertex = replace(state.vertex, modelview=tuple(map(tuple, matrix)))
    program = state.register_combiners
    if program is not None and random.random() < 0.7:
        program = replace(program, constant_color0=tuple(random.random(4).tolist()))
    return replace(state, vertex=vertex, register_combiners=program)


@pytest.mark.parametrize("first", range(0, 60, 20))
def test_a_state_of_a_known_kind_draws_as_where_nothing_is_known(first):
    drawn = 0
    for seed in range(810_000 + first, 810_000 + first + 20):
        frame, random = random_frame(seed), np.random.default_rng(seed)
        commands = [
            replace(c, state=changed(c.state, random)) if isinstance(c, Draw) else c for c in frame.commands
        ]
        other = replace(frame, commands=tuple(commands))
        fuzz.outcome(frame, fuzz.Way())
        try:
            known = fuzz.outcome(other, fuzz.Way())
        except UnsupportedState as error:
            forget()
            with pytest.raises(UnsupportedState, match=f"^{re.escape(str(error))}$"):
                fuzz.outcome(other, fuzz.Way())
            continue
        forget()
        assert not fuzz.differing(known, fuzz.outcome(other, fuzz.Way())), seed
        drawn += 1
    assert drawn > 10


TRIANGLE = Mesh([[-1, -1], [3, -1], [-1, 3]], colors=[[1, 1, 1]] * 3)
COMBINED = PassState(register_combiners=RegisterCombiners(constant_color0=(0.5, 0.5, 0.5, 0.5)))


@pytest.mark.parametrize(
    ("state", "sentence"),
    [
        (
            replace(COMBINED, vertex=VertexState(modelview=((1.0,) * 4,) * 3)),
            "vertex.modelview has 3 elements",
        ),
        (replace(COMBINED, vertex=VertexState(normalize=1)), "vertex.normalize is 1; it is a switch"),
        (replace(COMBINED, vertex=None), "vertex is None"),
        (
            replace(COMBINED, register_combiners=RegisterCombiners(constant_color0=(0.5, 0.5, 0.5))),
            "constant_color0 has 3 elements",
        ),
        (
            replace(COMBINED, register_combiners=RegisterCombiners(constant_color1=(0.5, 0.5, 0.5, "1"))),
            r"constant_color1\[3\] is '1'",
        ),
        (replace(COMBINED, vertex=VertexState(clip_planes=((1.0, 0.0, 0.0, 0.0),) * 9)), "9"),
        (replace(COMBINED, fog=Fog(density="thick")), "fog.density is 'thick'"),
        (replace(COMBINED, register_combiners=TextureUnit(None)), "register_combiners is"),
        (replace(COMBINED, stencil_test=StencilTest(reference=True)), "stencil_test.reference is True"),
    ],
)
def test_what_is_wrong_with_a_state_of_a_known_kind_is_said(state, sentence):
    machine = Machine(NV2A, 4, 4)
    machine.run([Draw(label="right", mesh=TRIANGLE, state=COMBINED)])
    for _ in range(2):
        with pytest.raises(UnsupportedState, match=sentence) as found:
            machine.run([Draw(label="wrong", mesh=TRIANGLE, state=state)])
        assert str(found.value).startswith('Command 0, "wrong": ')


def test_a_mesh_and_a_label_that_are_wrong_are_said_beside_a_known_kind():
    machine = Machine(NV2A, 4, 4)
    machine.run([Draw(label="right", mesh=TRIANGLE, state=COMBINED)])
    moved = replace(
        COMBINED, vertex=VertexState(modelview=((2.0, 0.0, 0.0, 0.0), *VertexState().modelview[1:]))
    )
    with pytest.raises(UnsupportedState, match="positions of vertex 0 holds nan"):
        machine.run([Draw(label="wrong", mesh=Mesh([[np.nan, 0], [0, 1], [1, 0]]), state=moved)])
    with pytest.raises(UnsupportedState, match="label is empty"):
        machine.run([Draw(label=" ", mesh=TRIANGLE, state=moved)])


@given(
    st.lists(st.sampled_from([0.0, -0.0, 1.0, -1.0, 2.0, 0.5]), min_size=32, max_size=32), st.integers(2, 4)
)
@settings(max_examples=200)
def test_matrices_of_a_pattern_share_their_sums(entries, components):
    modelview, projection = (
        tuple(tuple(entries[at : at + 4]) for at in range(first, first + 16, 4)) for first in (0, 16)
    )
    sums = plan._Sums(components)
    eye = sums.transform(modelview, plan._vector(plan.V.FIRST_GIVEN, components))
    results = sums.transform(projection, eye)
    expected = plan._laid_out(sums, results, eye)
    for one, other in zip(plan._transforms(modelview, projection, components, True), expected, strict=True):
        np.testing.assert_array_equal(one, other)


def test_an_input_of_a_known_program_is_told_apart():
    one = RegisterCombiners().final
    assert interned(replace(one, a=CombinerInput(Register.SPARE1))) is not interned(one)
