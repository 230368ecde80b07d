"""What the suites' vertex programs compute, as a mesh's positions for VertexStage.PROGRAM_RESULTS.

Measured: the chip's vertex arithmetic rounds toward zero (Shade_model Prog captures: with it all pixels, with
exact arithmetic up to 20 differ: a vertex in the middle of the screen lands just beside it).
"""

import numpy as np

from effects.conformance.case import HEIGHT, WIDTH
from effects.conformance.scenes import single

EYE_DISTANCE, NEAR, FAR = 7.0, 1.0, 200.0


def toward_zero(values):
    """Round float64 to single precision, toward zero."""
    values = np.asarray(values, np.float64)
    nearest = values.astype(np.float32)
    lower = np.nextafter(nearest, np.float32(0))
    return np.where(np.abs(nearest) > np.abs(values), lower, nearest).astype(np.float64)


def perspective(points, depth_maximum=16777215.0, eye=EYE_DISTANCE, far=FAR, offset=0.0):
    """Window positions [n, 4] (device x and y, depth units, w) of ``points`` [n, 3] in the default view.

    The default view: 45 degrees, 4:3, the eye at z = -7; ``eye`` and ``far`` say otherwise. Source:
    PerspectiveVertexShader: the view matrix, then projection and viewport as one matrix, then a division by
    w. ``offset``: the chip's viewport offset, pixels, which it adds to what a program computes too. Measured:
    609515 of 609518 pixels with the XDK's 17/32, 567298 without (Depth_Clamp VSH1 captures).
    """
    x, y, z = single(points).T
    y_scale = single(1.0 / np.tan(single(np.pi / 8)))
    x_scale = single(y_scale / single(WIDTH / HEIGHT))
    depth_scale = single(single(far / (far - NEAR)) * depth_maximum)
    w = toward_zero(z + eye)
    reciprocal = toward_zero(1.0 / w)
    window = (
        toward_zero(toward_zero(x * single(x_scale * WIDTH / 2)) + toward_zero(w * (WIDTH / 2))),
        toward_zero(toward_zero(y * -single(y_scale * HEIGHT / 2)) + toward_zero(w * (HEIGHT / 2))),
        toward_zero(toward_zero(w * depth_scale) - toward_zero(NEAR * depth_scale)),
    )
    x, y, z = (toward_zero(v * reciprocal) for v in window)
    return np.stack([toward_zero(x + offset), toward_zero(y + offset), z, w], axis=1)
