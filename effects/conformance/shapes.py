"""The shapes that Line_width, Edge_flag, Stipple_tests and Smoothing_control draw: one of each primitive.

Source: the ``Draw`` functions of those suites' programs, in device pixels from an origin.
"""

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.pipeline.enums import PrimitiveType

PALETTE = (0xFFFF3333, 0xFF33FF33, 0xFF3333FF, 0xFFFFFF33, 0xFF33FFFF, 0xFFFF33FF, 0xFF808080, 0xFFFFFFFF)

POINTS = (
    PrimitiveType.POINTS,
    (
        *((19.0, 15.0), (56.0, 29.0), (74.0, 77.0), (45.694406, 101.330152), (36.0, 38.369815), (14.0, 23.0)),
        *((85.0, 98.0), (31.0, 40.0), (98.0, 38.0), (17.0, 104.0), (78.0, 65.0), (31.644774, 49.0)),
        *((105.0, 11.968842), (9.0, 40.0), (105.962647, 76.068491), (80.0, 87.0)),
    ),
)
LINE_LOOP = (
    PrimitiveType.LINE_LOOP,
    (
        *((196.0, 47.0), (194.0, 19.0), (182.0, 97.0), (106.18625, 80.0)),
        *((127.0, 94.58163), (133.597443, 13.763389), (205.0, 62.0), (115.54392, 16.0)),
        *((122.0, 3.0), (117.062706, 87.735558), (201.0, 28.664894), (146.114091, 10.0)),
        *((205.356591, 88.0), (125.0, 107.0), (190.828953, 35.510304), (163.0, 105.956814)),
    ),
)
TRIANGLES = (
    PrimitiveType.TRIANGLES,
    (
        *((265.185925, 35.0), (249.778838, 22.523717), (310.0, 19.0)),
        *((243.978231, 47.650185), (304.0, 37.0), (232.0, 102.522615)),
    ),
)
QUAD_STRIP = (
    PrimitiveType.QUAD_STRIP,
    ((0.0, 239.0), (0.0, 120.0), (52.5, 225.4), (54.75, 175.5), (105.0, 239.0), (105.0, 120.0)),
)
TRIANGLE_FAN = (
    PrimitiveType.TRIANGLE_FAN,
    (
        *((158.5, 205.0), (115.545455, 239.0), (120.318182, 120.0), (147.045455, 157.4)),
        *((158.5, 128.5), (166.136364, 145.5), (204.318182, 159.1), (209.75, 239.0)),
    ),
)
POLYGON = (
    PrimitiveType.POLYGON,
    ((218.0, 232.0), (237.772727, 142.1), (258.772727, 120.0), (302.681818, 169.3), (317.0, 230.5)),
)
QUADS = (PrimitiveType.QUADS, ((0.0, 350.0), (60.0, 340.0), (58.5, 425.4), (12.75, 407.5)))

SHAPES = (POINTS, LINE_LOOP, TRIANGLES, QUAD_STRIP, TRIANGLE_FAN, POLYGON, QUADS)


def colors(count):
    """The palette's colours, over and over."""
    return np.array([scenes.abgr(PALETTE[i % len(PALETTE)]) for i in range(count)])


def mesh(shape, left, top, **arrays):
    """A shape with its origin at (left, top), added in single precision as the program adds them."""
    primitive, vertices = shape
    origin = np.array([left, top], np.float32)
    positions = origin + np.array(vertices, np.float32)
    return scenes.window_mesh(positions, primitive, colors=colors(len(vertices)), **arrays)
