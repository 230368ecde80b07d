"""A user's picture drawn as bytes: by a machine, bit for bit, or by the ideal."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Drawing:
    """What drawing gave.

    color      float64 [h, w, 4], 1.0 = full, top row first: the framebuffer's contents
    image      uint8 [h, w, 4], top row first: the same as bytes
    dropped    triangles that were left out because the camera is inside them; the ideal counts none
    summary    the way of drawing, in words
    """

    color: np.ndarray
    image: np.ndarray
    dropped: int
    summary: str


def drawn(commands, profile, width, height, threads=None, done=None):
    """The Drawing of a frame on a new machine, or of the ideal where the profile is exact.

    ``done``: None, or a function that is called with each command when it has been drawn.

    Raises ValueError if the profile's limits do not suffice.
    """
    watch = None if done is None else lambda command, _: done(command)
    # Whoever waits for kernels to be compiled is told before they are imported.
    if profile.arithmetic.exact:
        from fixedpipe.pipeline.ideal.evaluate import execute_ideal

        result = execute_ideal(commands, width, height, threads=threads, trace=watch)
        summary = "by the ideal, in float64; its colours are rounded to bytes at the end"
        return Drawing(result.color, result.image(), 0, summary)
    from fixedpipe.pipeline.execution.machine import execute

    result = execute(commands, profile, width, height, threads=threads, trace=watch or False)
    color = result.framebuffer.color / (2.0**result.framebuffer.color_bits - 1.0)
    summary = f"{result.fragments} fragments on the {profile.name}"
    return Drawing(color, result.image(), result.dropped, summary)
