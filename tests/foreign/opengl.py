"""What piglit's tests share, in the words of a frame: y is up, and a projection maps a window's pixels."""

import numpy as np

from fixedpipe.pipeline import Clear, Draw, Mesh, PassState, Sampler
from fixedpipe.pipeline.enums import PrimitiveType, TextureFilter

NEAREST = Sampler(TextureFilter.NEAREST, TextureFilter.NEAREST)
UNIT_SQUARE = [[0, 0], [1, 0], [0, 1], [1, 1]]


def ortho(left, right, bottom, top, near=-1.0, far=1.0):
    """glOrtho's matrix."""
    width, height, depth = right - left, top - bottom, far - near
    return (
        (2 / width, 0.0, 0.0, -(right + left) / width),
        (0.0, 2 / height, 0.0, -(top + bottom) / height),
        (0.0, 0.0, -2 / depth, -(far + near) / depth),
        (0.0, 0.0, 0.0, 1.0),
    )


def rectangle(x, y, width, height, color=None, **arrays):
    """piglit_draw_rect: a triangle strip; ``color``: of all vertices."""
    if color is not None:
        arrays["colors"] = [list(color)] * 4
    corners = [[x + width * s, y + height * t, 0.0] for s, t in UNIT_SQUARE]
    return Mesh(corners, PrimitiveType.TRIANGLE_STRIP, **arrays)


def clear(*color, depth=None, stencil=None):
    """glClear, of depth and stencil where given."""
    return Clear(label="clear", color=color, depth=depth, stencil=stencil)


def draw(mesh, **state):
    """A Draw in OpenGL's initial state but for what is given."""
    return Draw(label="draw", mesh=mesh, state=PassState(**state))


def rgb(components):
    """0xRRGGBB of components, 1.0 is one."""
    red, green, blue = (round(min(max(c, 0), 1) * 255) for c in components[:3])
    return red << 16 | green << 8 | blue


def upwards(wanted, height):
    """Expected pixels whose y is counted from the bottom, as ``pixels`` takes them."""
    return [(int(x), height - 1 - int(y), color, tolerance) for x, y, color, tolerance in wanted]


def matrix(rows):
    """A state's matrix of an array's rows."""
    return tuple(tuple(float(entry) for entry in row) for row in np.asarray(rows))
