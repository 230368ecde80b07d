"""A capture of a real NV2A, redrawn through the ordinary pipeline: coverage, weights, colours, 16-bit depth.

The GeForce 256 infers these rules from that chip. The capture (folder ``shared/silicon`` beside the
checkout) comes from the public golden results of nxdk_pgraph_tests; the geometry below is that program's.
"""

import numpy as np
import pytest
from PIL import Image

from pipeline.commands import Clear, Draw, Mesh
from pipeline.enums import ComparisonFunction, PrimitiveType
from pipeline.execute import execute
from pipeline.profiles import GEFORCE_256
from pipeline.state import DepthTest, PassState

WIDTH, HEIGHT = 640, 480
LEFT, TOP, RIGHT, BOTTOM = 128.0, 40.0, 512.0, 440.0
FARTHEST = 0xFFFF
single = np.float32


def depth_scene():
    """Quads as (left, top, right, bottom, depths, colours), both in the order upper left, upper right, lower
    right, lower left: a grid of small slopes, two bars, and one quad across the whole region.
    """
    rows = int(RIGHT - LEFT - 8) // 12
    columns = int(BOTTOM - TOP - 8) // 12
    x0 = LEFT + 4 + (RIGHT - LEFT - (8 + rows * 12)) / 2
    y0 = TOP + 4 + (BOTTOM - TOP - (8 + columns * 12)) / 2
    largest = single(FARTHEST)
    step = single(largest / (single(3 + rows * columns) + single(1)))
    near, rise = single(0), single(step * single(0.75))
    for row in range(columns):
        for column in range(rows):
            far = single(near + rise)
            dark, light = (single(0.25) + single(z / largest) * single(0.75) for z in (near, far))
            z = [float(int(near)), float(int(max(single(0), far)))]
            greys = [(float(g),) * 3 for g in (dark, light)]
            x, y = x0 + 12 * column, y0 + 12 * row
            yield x, y, x + 8, y + 8, (z[0], z[1], z[1], z[0]), (greys[0], greys[1], greys[1], greys[0])
            near, rise = single(near + step), single(-rise)
    behind = FARTHEST - 1
    high, most = float(behind * 3 // 4), float(FARTHEST)
    start, end = (high / most, 0.75, high / most), (0.75, 0.0, 0.0)
    yield LEFT + 4, BOTTOM - 10, RIGHT - 20, BOTTOM - 5, (high, 0.0, 0.0, high), (start, end, end, start)
    low, middle = 1.0, float(FARTHEST // 2)
    start, end = (low / most, 0.5, low / most), (0.5, middle / most, middle / most)
    yield RIGHT - 10, TOP + 5, RIGHT - 2, BOTTOM - 5, (low, low, middle, middle), (start, start, end, end)
    top, bottom = float(behind * 2 // 3), float(behind)
    corners = ((0.0, 1.0, 0.0), (1.0, 0.0, 0.0), (0.4, 0.3, 0.0), (0.0, 0.0, 1.0))
    yield LEFT, TOP, RIGHT, BOTTOM, (top, top, bottom, bottom), corners


def quad_mesh():
    """The scene as one mesh in clip coordinates."""
    positions, colors = [], []
    # The chip's vertices come in window coordinates. On the way through the viewport they may lose a last
    # bit, and snapping truncates: a millionth of a pixel keeps every half pixel on its own side.
    nudge = 2.0**-20
    for left, top, right, bottom, depths, corners in depth_scene():
        for x, y, z in zip((left, right, right, left), (top, top, bottom, bottom), depths, strict=True):
            positions.append(
                ((x + nudge) / (WIDTH / 2) - 1, 1 - (y + nudge) / (HEIGHT / 2), 2 * z / FARTHEST - 1)
            )
        colors += [tuple(float(single(c)) for c in corner) for corner in corners]
    return Mesh(np.array(positions), PrimitiveType.QUADS, colors=np.array(colors))


@pytest.mark.needs_shared
def test_every_pixel_of_a_depth_capture_is_the_chip_s(captures):
    path = captures / "Depth_buffer" / "DepthFmt_z16_Cn_FZn_M00ffff.png"
    if not path.exists():
        pytest.skip(f"the folder of captures has no {path.relative_to(captures)}")
    capture = np.array(Image.open(path).convert("RGBA"))
    state = PassState(depth_test=DepthTest(ComparisonFunction.LESS))
    commands = (
        Clear(label="farthest depth", color=(0.0, 0.0, 0.0, 1.0), depth=1.0),
        Draw(label="slopes", mesh=quad_mesh(), state=state),
    )
    ours = execute(commands, GEFORCE_256, WIDTH, HEIGHT, depth_bits=16).framebuffer.color
    region = np.zeros((HEIGHT, WIDTH), bool)
    region[int(TOP) : int(BOTTOM), int(LEFT) : int(RIGHT)] = True
    region &= ~((capture == (255, 255, 255, 0)).all(-1))  # text, which the processor drew
    equal = (ours[..., :3] == capture[..., :3]).all(-1)
    assert region.sum() == 384 * 400  # the text lies outside
    assert equal[region].sum() == region.sum()
