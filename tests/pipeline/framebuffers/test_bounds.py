"""Rectangles of the window become device pixels, and what lies outside the window is nothing."""

import pytest

from fixedpipe.pipeline.commands import Clear
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.framebuffers.bounds import device_edges, scissored, scissored_part
from fixedpipe.pipeline.profiles import NV2A
from fixedpipe.pipeline.state import Scissor

WIDTH, HEIGHT = 16, 12
OUTSIDE = [Scissor(-9, 2, 4, 4), Scissor(20, 2, 4, 4), Scissor(2, -9, 4, 4), Scissor(2, 20, 4, 4)]


@pytest.mark.parametrize(
    ("box", "edges"),
    [
        (None, (0, 0, 16, 12)),
        (Scissor(2, 3, 4, 5), (2, 4, 6, 9)),
        (Scissor(-2, -3, 4, 5), (0, 10, 2, 12)),
        (Scissor(14, 10, 4, 5), (14, 0, 16, 2)),
    ],
)
def test_a_box_is_counted_from_the_bottom_and_cut_by_the_window(box, edges):
    assert scissored(box, WIDTH, HEIGHT) == edges
    left, top, right, bottom = edges
    assert scissored_part(box, WIDTH, HEIGHT) == (slice(top, bottom), slice(left, right))


def test_edges_are_not_cut():
    assert device_edges(Scissor(-2, 10, 4, 5), HEIGHT) == (-2, -3, 2, 2)


@pytest.mark.parametrize("box", OUTSIDE)
def test_a_box_beside_the_window_holds_nothing(box):
    x0, y0, x1, y1 = scissored(box, WIDTH, HEIGHT)
    assert x1 - x0 == 0 or y1 - y0 == 0
    assert x0 <= x1 and y0 <= y1
    cleared = execute((Clear(label="beside", color=(1.0,) * 4, scissor=box),), NV2A, WIDTH, HEIGHT, threads=1)
    assert not cleared.framebuffer.color.any()
