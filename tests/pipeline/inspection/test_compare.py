"""Two frames are compared command by command, and part where they do."""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.pipeline.commands import Clear, Draw, MakeCurrent, Mesh
from fixedpipe.pipeline.enums import ComparisonFunction
from fixedpipe.pipeline.inspection.compare import Run, compare
from fixedpipe.pipeline.profiles import GEFORCE_256, NV2A, OPENGL_1_2
from fixedpipe.pipeline.state import DepthTest, PassState, Scissor

SIZE = 16
CLEAR = Clear(label="clear", color=(0.0, 0.0, 0.0, 0.0), depth=1.0)


def triangle(label="draw", colors=((0.9, 0.1, 0.2), (0.1, 0.8, 0.3), (0.2, 0.3, 0.7)), **state):
    """A Draw of a Gouraud triangle."""
    corners = np.array([[-0.9, -0.9, 0.0], [0.9, -0.8, 0.1], [-0.7, 0.9, 0.2]])
    return Draw(label=label, mesh=Mesh(corners, colors=np.array(colors)), state=PassState(**state))


def parted(first, second, profiles=(GEFORCE_256, GEFORCE_256), size=SIZE):
    """Where two frames part."""
    runs = [Run(commands, profile) for commands, profile in zip((first, second), profiles, strict=True)]
    return compare(runs, size, size)


def test_the_same_frames_do_not_part():
    commands = CLEAR, triangle()
    assert parted(commands, commands) is None
    assert parted((), ()) is None


def test_machines_part_where_their_colours_are_iterated():
    commands = CLEAR, triangle()
    found = parted(commands, commands, (GEFORCE_256, OPENGL_1_2))
    assert (found.command, found.label, found.plane) == (1, "draw", "color")
    assert [stage.title for stage in found.stages] == ["fragment", "fragment"]
    differs = np.abs(found.first - found.second).max(axis=2)
    x, y = found.pixel
    assert differs[y, x] == differs.max() == found.largest
    assert found.count == (differs > 0).sum()
    x0, y0, x1, y1 = found.box
    assert (differs[y0:y1, x0:x1] > 0).sum() == found.count
    assert 1 / 255 <= found.largest < 4 / 255  # weights of 8 bits, of colours that differ by 0.8


def test_one_pixel_that_differs_is_found():
    inside = Scissor(5, 6, 1, 1)
    first = CLEAR, triangle(), triangle("dot", ((1.0, 1.0, 1.0),) * 3, scissor=inside)
    second = *first[:2], triangle("dot", ((1.0, 1.0, 254 / 255),) * 3, scissor=inside)
    found = parted(first, second)
    assert (found.command, found.count, found.pixel) == (2, 1, (5, SIZE - 1 - 6))
    assert found.box == (5, 9, 6, 10)
    assert found.largest == pytest.approx(1 / 255)


def test_depths_part_where_colours_do_not():
    test = DepthTest(ComparisonFunction.LESS)
    first = CLEAR, triangle(depth_test=test)
    second = CLEAR, triangle(depth_test=replace(test, write=False))
    found = parted(first, second)
    assert (found.command, found.plane) == (1, "depth")


def test_a_pbuffers_pixels_are_compared_too():
    current = MakeCurrent(label="pbuffer", surface="p", width=32, height=32)
    first, second = ((current, CLEAR, triangle(colors=((c, c, c),) * 3)) for c in (0.2, 0.4))
    found = parted(first, second, (NV2A, NV2A))
    assert (found.command, found.first.shape) == (2, (32, 32, 4))
    assert found.stages[0].title == "vertices"


def test_other_commands_are_refused():
    with pytest.raises(ValueError, match="have 2 and 1 commands, and one has more"):
        parted((CLEAR, triangle()), (CLEAR,))
    with pytest.raises(ValueError, match="number 0 differs"):
        parted((CLEAR,), (triangle(),))
