"""Arrays that are computed once."""

import os

import numpy as np
import pytest

from fixedpipe.effects import computed_once as module
from fixedpipe.effects.computed_once import computed_once
from fixedpipe.pipeline.enums import WrapMode


@pytest.fixture
def ramps(monkeypatch):
    """A function of an array and a number that is computed once, and the arguments of its computations."""
    monkeypatch.setattr(module, "_found", type(module._found)())
    monkeypatch.setattr(module, "_folder", None)
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


# -------------------------------------------------------------------------------------------- in a folder


@pytest.fixture
def kept(ramps, tmp_path):
    """The same, kept in a folder; a function that forgets what this process has; the folder."""
    with module.kept_in(tmp_path / "arrays"):
        yield *ramps, module._found.clear, tmp_path / "arrays"


def test_another_process_finds_what_was_kept(kept):
    ramp, calls, forget, folder = kept
    first = ramp(np.arange(4.0), number=3)
    forget()
    again = ramp(np.arange(4.0), number=3)
    assert len(calls) == 1 and again.dtype == first.dtype and (again == first).all()
    forget()
    ramp(np.arange(4.0), number=4)
    assert len(calls) == 2 and len(list(folder.iterdir())) == 2


def test_what_is_damaged_is_computed_again_and_kept(kept):
    ramp, calls, forget, folder = kept
    whole = ramp(np.arange(4.0))
    (path,) = folder.iterdir()
    data = path.read_bytes()
    for damaged in (b"", data[:-1], data[:40] + bytes([data[40] ^ 1]) + data[41:]):
        path.write_bytes(damaged)
        before = len(calls)
        for _ in range(2):
            forget()
            assert (ramp(np.arange(4.0)) == whole).all()
        assert len(calls) == before + 1


def test_an_edit_of_a_source_that_it_follows_from_computes_it_again(kept, monkeypatch):
    ramp, calls, forget, _ = kept
    ramp(np.arange(4.0))
    monkeypatch.setattr(module, "digest_of", lambda modules: "edited")
    forget()
    ramp(np.arange(4.0))
    assert len(calls) == 2


def test_the_sources_of_the_classes_of_arguments_count_too(kept, monkeypatch):
    """Their methods compute, though the function's module need not import them."""
    ramp, *_ = kept
    asked = []
    monkeypatch.setattr(module, "digest_of", lambda modules: asked.append(tuple(modules)) or "")
    ramp(np.arange(4.0), number=WrapMode.REPEAT)
    assert "fixedpipe.pipeline.enums" in asked[0]


def test_a_folder_that_cannot_be_written_stops_nothing(kept, monkeypatch):
    ramp, calls, _, folder = kept
    folder.parent.joinpath("arrays").write_text("a file where the folder should be")
    assert (ramp(np.arange(4.0), number=3) == [0, 3, 6, 9]).all()
    assert len(calls) == 1


def test_in_a_full_folder_what_was_used_longest_ago_goes(kept, monkeypatch):
    ramp, calls, forget, folder = kept
    one, two, three = (np.full(100, float(k)) for k in range(3))
    ramp(one)
    (path,) = folder.iterdir()
    monkeypatch.setattr(module, "_MOST_IN_FOLDER", 2 * path.stat().st_size)
    ramp(two)
    for path, age in zip(sorted(folder.iterdir(), key=lambda p: p.stat().st_mtime_ns), (2, 1), strict=True):
        os.utime(path, ns=(age, age))
    forget()
    ramp(one)  # its file is the newest now
    ramp(three)
    assert len(list(folder.iterdir())) == 2 and len(calls) == 3
    forget()
    ramp(one)
    assert len(calls) == 3
