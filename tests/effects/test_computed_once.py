"""Arrays that are computed once."""

import numpy as np
import pytest

from fixedpipe.effects import computed_once as module
from fixedpipe.effects.computed_once import computed_once


@pytest.fixture
def ramps(monkeypatch):
    """A function of an array and a number that is computed once, and the arguments of its computations."""
    monkeypatch.setattr(module, "_found", type(module._found)())
    calls = []

    @computed_once
    def ramp(array, number=1):
        calls.append((array.copy(), number))
        return array * number

    return ramp, calls


def test_the_same_arguments_are_computed_once_and_every_caller_has_an_array_of_its_own(ramps):
    ramp, calls = ramps
    first, again = ramp(np.arange(4.0), number=3), ramp(np.arange(4.0), number=3)
    assert len(calls) == 1 and (first == [0, 3, 6, 9]).all() and (again == first).all()
    again[0] = 7.0
    assert ramp(np.arange(4.0), number=3)[0] == 0.0


@pytest.mark.parametrize(
    "other",
    [
        lambda ramp: ramp(np.arange(4.0)),
        lambda ramp: ramp(np.arange(4.0), number=4),
        lambda ramp: ramp(np.arange(4.0), number=3.0),
        lambda ramp: ramp(np.arange(4), number=3),
        lambda ramp: ramp(np.array([0.0, 1.0, 2.0, np.nextafter(3.0, 4.0)]), number=3),
        lambda ramp: ramp(np.arange(4.0).reshape(2, 2), number=3),
        lambda ramp: ramp(np.array([-0.0, 1.0, 2.0, 3.0]), number=3),
    ],
)
def test_other_arguments_are_computed_anew(ramps, other):
    ramp, calls = ramps
    ramp(np.arange(4.0), number=3)
    other(ramp)
    assert len(calls) == 2


def test_what_was_used_longest_ago_goes_first(ramps, monkeypatch):
    ramp, calls = ramps
    monkeypatch.setattr(module, "_MOST", 2 * 8 * 100)
    one, two, three = (np.full(100, float(k)) for k in range(3))
    for given in (one, two, one, three, one):
        ramp(given)
    assert len(calls) == 3
    ramp(two)
    assert len(calls) == 4 and sum(array.nbytes for array in module._found.values()) <= 1600


def test_a_result_above_the_limit_is_still_returned(ramps, monkeypatch):
    ramp, _ = ramps
    monkeypatch.setattr(module, "_MOST", 8)
    assert (ramp(np.arange(100.0)) == np.arange(100.0)).all()
    assert (ramp(np.arange(50.0)) == np.arange(50.0)).all()
    assert len(module._found) == 1
