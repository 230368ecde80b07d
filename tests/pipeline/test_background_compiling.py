"""What draws while engines are compiled: the same bits, nothing compiled, and a process that ends."""

import multiprocessing

import numpy as np
import pytest

from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.enums import Face
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.native import background_compiling, queue
from fixedpipe.pipeline.native.prepared_draw import Prepared
from fixedpipe.pipeline.profiles import GEFORCE_256
from fixedpipe.pipeline.state import PassState, PolygonState, Scissor
from tests import fuzz
from tests.support.random_frames import random_frame


@pytest.fixture
def waiting(monkeypatch):
    """As where neither engine is compiled, and nobody waits; what their kernels drew is counted."""
    monkeypatch.setattr(background_compiling, "is_ready", lambda engine: False)
    monkeypatch.setattr(background_compiling, "_never_waits", True)
    drawn = []

    def counted(draw):
        def first(*given):
            drawn.append(given)
            return draw(*given)

        return first

    monkeypatch.setattr(Prepared, "bands", counted(Prepared.bands))
    monkeypatch.setattr(queue, "draw_frame", counted(queue.draw_frame))
    return drawn


@pytest.mark.parametrize("first", range(0, 120, 40))
def test_random_frames_are_the_same_bits(waiting, first):
    for seed in range(700_000 + first, 700_000 + first + 40):
        frame = random_frame(seed)
        without = fuzz.outcome(frame, fuzz.Way())
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(background_compiling, "_never_waits", False)
            assert not fuzz.differing(without, fuzz.outcome(frame, fuzz.Way())), seed


def meshes():
    """Draws of many triangles of all sizes and windings, culled and scissored."""
    random = np.random.default_rng(5)
    for cull, scissor in ((None, None), (Face.BACK, Scissor(3, 5, 20, 9)), (Face.FRONT, None)):
        positions = random.uniform(-1.5, 1.5, (60, 1, 2)) + random.normal(0, 1, (60, 3, 2)) * random.random(
            (60, 1, 1)
        )
        colors = random.random((180, 3))
        state = PassState(polygon=PolygonState(cull_face=cull), scissor=scissor)
        yield Draw(label="triangles", mesh=Mesh(positions.reshape(-1, 2), colors=colors), state=state)


def sorted_rows(fragments):
    """Fragments in the order of their pixels; each pixel's as they were drawn."""
    order = np.lexsort((fragments.x, fragments.y))
    return np.stack([getattr(fragments, name) for name in ("triangle", "x", "y", "passed")])[:, order]


def test_triangles_are_recorded_and_covered_without_kernels(waiting, monkeypatch):
    frame = tuple(meshes())
    without = execute(frame, GEFORCE_256, 32, 24, record=True)
    ideal = execute_ideal(frame, 32, 24)
    assert not waiting
    monkeypatch.setattr(background_compiling, "_never_waits", False)
    withal = execute(frame, GEFORCE_256, 32, 24, record=True)
    assert waiting
    np.testing.assert_array_equal(without.framebuffer.color, withal.framebuffer.color)
    assert len(withal.records) == 3 and all(len(r.x) > 200 for r in withal.records)
    for one, other in zip(without.records, withal.records, strict=True):
        np.testing.assert_array_equal(sorted_rows(one), sorted_rows(other))
    np.testing.assert_array_equal(ideal.color, execute_ideal(frame, 32, 24).color)


@pytest.mark.parametrize("asked", [None, "portable", "columns"])
@pytest.mark.parametrize("ready", [(), ("portable",), ("vector",), ("portable", "vector")])
def test_an_engine_that_is_ready_is_chosen(monkeypatch, asked, ready):
    monkeypatch.setattr(background_compiling, "is_ready", ready.__contains__)
    assert background_compiling.chosen_engine(asked) == asked
    with background_compiling.without_waiting():
        chosen = background_compiling.chosen_engine(asked)
    assert background_compiling.chosen_engine(asked) == asked
    if asked == "columns":
        assert chosen == "columns"
    elif asked is None and "vector" in ready:
        assert chosen is None
    else:
        assert chosen == ("portable" if "portable" in ready else "columns")


def test_a_kernel_that_was_called_is_ready():
    execute(tuple(meshes()), GEFORCE_256, 8, 8)
    assert background_compiling.is_ready("vector")


@pytest.mark.parametrize("asked", ["vector", "portable"])
def test_another_process_compiles_what_was_asked_for_first(monkeypatch, asked):
    ready = background_compiling.is_ready
    monkeypatch.setattr(background_compiling, "_never_waits", False)
    monkeypatch.setattr(background_compiling, "default_threads", lambda: 2)
    monkeypatch.setattr(background_compiling, "is_ready", lambda engine: False)
    before, said = multiprocessing.active_children(), []
    compiling = background_compiling.compile_beside(asked)
    (process,) = set(multiprocessing.active_children()) - set(before)
    assert background_compiling._never_waits and process.daemon
    compiling.wait(lambda *line: said.append(line))
    assert ready(asked)
    process.terminate()
    process.join()
    compiling.wait(print)  # for what has ended nobody waits


@pytest.mark.parametrize(("processors", "ready"), [(1, False), (2, True)])
def test_nothing_is_begun_for_one_processor_or_for_what_is_there(monkeypatch, processors, ready):
    monkeypatch.setattr(background_compiling, "default_threads", lambda: processors)
    monkeypatch.setattr(background_compiling, "is_ready", lambda engine: ready)
    assert background_compiling.compile_beside("vector") is None
    assert not background_compiling._never_waits


def test_where_no_process_can_be_begun_this_one_compiles(monkeypatch):
    def refuse(method):
        raise OSError("no locks between processes")

    monkeypatch.setattr(background_compiling, "default_threads", lambda: 2)
    monkeypatch.setattr(background_compiling, "is_ready", lambda engine: False)
    context = multiprocessing.get_context("spawn")
    monkeypatch.setattr(type(context), "SimpleQueue", refuse)
    assert background_compiling.compile_beside("vector") is None
    assert not background_compiling._never_waits
