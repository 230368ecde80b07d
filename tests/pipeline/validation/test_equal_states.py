"""Equal states are one state, and only those whose every value has the same type and the same bits."""

from copy import deepcopy
from dataclasses import fields, is_dataclass, replace
from enum import Enum
from threading import Thread

import numpy as np
import pytest

from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.enums import BlendFactor, ComparisonFunction
from fixedpipe.pipeline.execution.machine import Machine, execute
from fixedpipe.pipeline.native import state_rows
from fixedpipe.pipeline.profiles import NV2A
from fixedpipe.pipeline.state import (
    AlphaTest,
    Blending,
    DepthTest,
    Fog,
    PassState,
    RegisterCombiners,
    TextureUnit,
    VertexState,
)
from fixedpipe.pipeline.validation import equal_states
from fixedpipe.pipeline.validation.equal_states import first_equal
from fixedpipe.pipeline.validation.walk import UnsupportedState

STATE = PassState(
    vertex=VertexState(modelview=((1.0, 0.0, 0.0, 0.5), *((0.0, 1.0, 0.0, 0.0),) * 3)),
    texture_units=(TextureUnit("t"), None, TextureUnit("u", lod_bias=0.5)),
    register_combiners=RegisterCombiners(constant_color0=(0.25, 0.0, 1.0, 1.0)),
    blending=Blending(BlendFactor.ONE, BlendFactor.ZERO),
    alpha_test=AlphaTest(ComparisonFunction.GREATER, 0.5),
    depth_test=DepthTest(),
    fog=Fog(),
)


def other(value):
    """Values that are not ``value``, some of them equal to it by Python's rules."""
    if isinstance(value, bool):
        return [not value, int(value), float(value)]
    if isinstance(value, Enum):
        return [next((member for member in type(value) if member is not value), None), str(value)]
    if isinstance(value, float):
        return [value + 0.25, int(value) if value.is_integer() else None, np.float64(value), -value]
    if isinstance(value, int):
        return [value + 1, float(value), bool(value)]
    if isinstance(value, str):
        return [value + "x", value.encode()]
    return [0]


def variants(value):
    """The value with one thing in it changed, everything in its turn."""
    if is_dataclass(value):
        for field in fields(value):
            for changed in variants(getattr(value, field.name)):
                yield replace(value, **{field.name: changed})
    elif isinstance(value, tuple) and value:
        yield value[:-1]
        yield list(value)
        for place, element in enumerate(value):
            for changed in variants(element):
                yield (*value[:place], changed, *value[place + 1 :])
    else:
        yield from other(value)


def test_a_state_made_anew_is_the_first_that_equals_it():
    first = first_equal(STATE)
    for _ in range(3):
        made = deepcopy(STATE)
        assert made is not first and first_equal(made) is first
    assert first == STATE


def test_a_state_that_differs_in_anything_is_another():
    same, seen = first_equal(STATE), set()
    number = 0
    for changed in variants(STATE):
        found = first_equal(changed)
        differs = repr(changed) != repr(STATE)  # which tells types, and signs of zeros
        assert (found is same) == (not differs), repr(changed)
        assert repr(found) == repr(changed)
        number += differs
        seen.add(id(found))
    assert len(seen) > number // 2 > 500


def test_another_state_of_equal_parts_has_the_first_of_each():
    first = first_equal(STATE)
    made = first_equal(deepcopy(replace(STATE, alpha_test=AlphaTest(ComparisonFunction.LESS, 0.75))))
    assert made is not first
    for field in fields(made):
        if field.name != "alpha_test":
            assert getattr(made, field.name) is getattr(first, field.name), field.name


def triangle(state):
    positions = np.array([(-1.0, -1.0), (1.0, -1.0), (0.0, 1.0)])
    return Draw(label="triangle", mesh=Mesh(positions, colors=np.array([(1.0, 0.5, 0.25)] * 3)), state=state)


def test_states_made_anew_are_packed_once_and_draw_the_same():
    machine = Machine(NV2A, 16, 16, threads=1)
    state = PassState(alpha_test=AlphaTest(ComparisonFunction.GREATER, 0.125))
    expected = machine.run((triangle(state),)).framebuffer.color.copy()
    kept = len(state_rows._rows)
    for _ in range(5):
        got = machine.run((triangle(deepcopy(state)),)).framebuffer.color
        np.testing.assert_array_equal(got, expected)
    assert len(state_rows._rows) == kept
    assert (expected != 0).any()


@pytest.mark.parametrize(
    ("wrong", "words"), [({"color_sum": 0}, "color_sum is 0; it is a switch"), ({"fog": 3}, "fog is 3")]
)
def test_what_equals_a_right_state_by_python_s_rules_is_refused(wrong, words):
    machine = Machine(NV2A, 8, 8)
    machine.run((triangle(PassState()),))
    for _ in range(2):
        with pytest.raises(UnsupportedState, match=words):
            machine.run((triangle(PassState(**wrong)),))


def test_negative_zero_is_not_zero():
    zero, negative = (PassState(alpha_test=AlphaTest(reference=sign)) for sign in (0.0, -0.0))
    assert zero == negative and first_equal(zero) is not first_equal(negative)


def test_all_is_forgotten_when_there_is_too_much(monkeypatch):
    monkeypatch.setattr(equal_states, "_MOST", 200)
    for number in range(300):
        state = PassState(alpha_test=AlphaTest(ComparisonFunction.LESS, number / 300))
        assert first_equal(state) == state == first_equal(deepcopy(state))
    assert len(equal_states._seen) < 400
    result = execute((triangle(state),), NV2A, 8, 8)
    assert result.fragments > 0


def test_threads_find_the_same_first():
    states = [replace(STATE, alpha_test=AlphaTest(ComparisonFunction.LESS, n / 64)) for n in range(64)]
    expected, found = [id(first_equal(state)) for state in states], {}

    def look(number):
        found[number] = [id(first_equal(deepcopy(state))) for state in states]

    threads = [Thread(target=look, args=(number,)) for number in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == dict.fromkeys(range(4), expected)
