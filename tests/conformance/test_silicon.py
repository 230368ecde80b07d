"""Captures of a real NV2A, redrawn on the GeForce 256: coverage, weights, colours and fixed-point depths.

The GeForce 256 infers these rules from that chip.
"""

import numpy as np
import pytest
from PIL import Image

from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Shows
from fixedpipe.effects.conformance.redraw import TEXT, zeta_colors
from fixedpipe.effects.conformance.suites import depth_buffer
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.profiles import GEFORCE_256


@pytest.mark.needs_shared
@pytest.mark.parametrize(
    "name",
    [
        "DepthFmt_z16_Cn_FZn_M00ffff",
        "DepthFmt_z16_Cn_FZn_M00ffff_ZB",
        "DepthFmt_z24_Cn_FZn_Mffffff",
        "DepthFmt_z24_Cn_FZn_Mffffff_ZB",
    ],
)
def test_every_pixel_of_a_depth_capture_is_the_chip_s(captures, name):
    path = captures / depth_buffer.SUITE / f"{name}.png"
    if not path.exists():
        pytest.skip(f"the folder of captures has no {path.relative_to(captures)}")
    capture = np.array(Image.open(path).convert("RGBA"))
    case = depth_buffer.CASES[name]()
    framebuffer = execute(case.commands, GEFORCE_256, WIDTH, HEIGHT, depth_bits=case.depth_bits).framebuffer
    ours = framebuffer.image() if case.shows == Shows.COLOR else zeta_colors(framebuffer)
    drawn = (capture != TEXT).any(-1)
    assert drawn.sum() > 0.99 * WIDTH * HEIGHT
    np.testing.assert_array_equal(ours[drawn], capture[drawn])
