"""Tools of studies: rows of pixels with one vector each, and pictures as numbers."""

import numpy as np

from fixedpipe.effects.passes.encoding import vector_colors
from fixedpipe.pipeline.commands import Mesh
from fixedpipe.pipeline.enums import PrimitiveType
from fixedpipe.pipeline.execution.machine import execute


def strip(count, colors=None, coordinates=None):
    """A mesh of ``count`` quads side by side that fill the view, each with one colour [count, 3] and one pair
    of texture coordinates [count, 2].
    """
    cell = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    across = np.arange(count)[:, None, None] * np.array([1.0, 0.0])
    corners = (cell + across).reshape(-1, 2) * np.array([2.0 / count, 2.0]) - 1.0
    return Mesh(
        corners,
        PrimitiveType.QUADS,
        colors=None if colors is None else np.repeat(colors, 4, axis=0),
        texture_coordinates=() if coordinates is None else (np.repeat(coordinates, 4, axis=0),),
    )


def strip_of_vectors(vectors, profile):
    """``strip`` of the vectors [n, 3] as primary colours for EXPAND_NORMAL; its texture coordinates are the
    middle of a texture of one texel.
    """
    return strip(len(vectors), vector_colors(vectors, profile), np.full((len(vectors), 2), 0.5))


def drawn(commands, profile, width, height, **arguments):
    """The machine's RGB as float64 [height, width, 3], bottom row first, 1.0 = full."""
    framebuffer = execute(commands, profile, width, height, **arguments).framebuffer
    return framebuffer.color[::-1, :, :3] / (2.0**framebuffer.color_bits - 1.0)
