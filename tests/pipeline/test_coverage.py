"""What a recorded Draw gives: every fragment once, however many there are, and the picture that is drawn."""

import numpy as np
import pytest

from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.enums import BlendFactor, PolygonMode
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.native import coverage
from fixedpipe.pipeline.native.prepared_draw import Prepared
from fixedpipe.pipeline.profiles import NV2A
from fixedpipe.pipeline.state import Blending, PassState, PolygonState, Scissor

ADDED = Blending(BlendFactor.ONE, BlendFactor.ONE)


@pytest.fixture
def passes(monkeypatch):
    """How often bands were drawn."""
    bands, drawn = Prepared.bands, []

    def counted(*given):
        drawn.append(given)
        return bands(*given)

    monkeypatch.setattr(Prepared, "bands", counted)
    return drawn


def recorded(mesh, size, **state):
    command = Draw(label="d", mesh=mesh, state=PassState(blending=ADDED, **state))
    shown = execute((command,), NV2A, size, size).framebuffer.color
    result = execute((command,), NV2A, size, size, record=True)
    np.testing.assert_array_equal(result.framebuffer.color, shown)
    (fragments,) = result.records
    columns = (column for column in vars(fragments).values() if isinstance(column, np.ndarray))
    assert all(column.dtype == np.int32 and column.flags.c_contiguous for column in columns)
    assert fragments.places is not None
    assert len(fragments.x) == result.fragments
    return fragments


def huge(layers):
    """Triangles over all pixels, far beyond the framebuffer."""
    colors = [[0.01, 0, 0]] * 6 * layers
    return Mesh([[-9, -9], [9, -9], [-9, 9], [9, 9], [9, -9], [-9, 9]] * layers, colors=colors)


def test_triangles_are_recorded_in_one_drawing(passes):
    fragments = recorded(huge(3), 320)
    assert len(passes) == 1 and len(fragments.x) == 3 * 320 * 320 > coverage._USUAL
    counts = np.zeros((320, 320), int)
    np.add.at(counts, (fragments.y, fragments.x), 1)
    assert (counts == 3).all() and fragments.passed.all()


def test_what_may_be_more_than_a_recording_holds_is_drawn_again(passes, monkeypatch):
    monkeypatch.setattr(coverage, "_MOST", 5000)
    monkeypatch.setattr(coverage, "_USUAL", 1000)
    assert len(recorded(huge(2), 64, scissor=Scissor(0, 0, 16, 16)).x) == 512 and len(passes) == 1
    assert len(recorded(huge(2), 64).x) == 2 * 64 * 64 and len(passes) == 3


def test_outlines_have_no_bound_and_are_whole(passes, monkeypatch):
    monkeypatch.setattr(coverage, "_USUAL", 100)
    lines = PolygonState(front_mode=PolygonMode.LINE, back_mode=PolygonMode.LINE)
    corners = np.random.default_rng(3).uniform(-1, 1, (60, 2))
    fragments = recorded(Mesh(corners, colors=[[0.01, 0, 0]] * 60), 64, polygon=lines)
    assert len(fragments.x) > 100 and len(passes) == 1 + 2  # drawn, and recorded twice


@pytest.mark.parametrize("size", [1, 16, 33])
def test_the_bound_is_never_less_than_what_is_drawn(size):
    random = np.random.default_rng(size)
    for scale in (0.02, 0.3, 3.0):
        corners = random.uniform(-1, 1, (40, 1, 2)) + scale * random.normal(0, 1, (40, 3, 2))
        mesh, bounds = Mesh(corners.reshape(-1, 2)), []

        def bound(*given, inner=coverage._most_fragments, bounds=bounds):
            bounds.append(inner(*given))
            return bounds[-1]

        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(coverage, "_most_fragments", bound)
            result = execute((Draw(label="d", mesh=mesh, state=PassState()),), NV2A, size, size, record=True)
        assert len(result.records[0].x) <= sum(bounds) <= 40 * size * size
        assert bounds or not len(result.records[0].x)
