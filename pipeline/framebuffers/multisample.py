"""Multisampling (SGIS_multisample's and later ARB_multisample's effect): several samples in each pixel.

Every sample is a framebuffer of its own, colour, depth and stencil: a Draw is drawn into each. On a machine
that shades samples it is shifted so that the sample's place lies where pixels have their middle, and
everything of a fragment is computed there; on another the sample's place says which pixels are drawn, and no
more. What reads colours reads the mean of a pixel's samples; what reads depths and stencil values reads the
first sample's (docs/numbers.md has the rule).
"""

from dataclasses import replace

import numpy as np

from fixedpipe.pipeline.framebuffers.accumulation import accumulation_of

# Places in a pixel, 1/16 pixel from its middle, x to the right and y up. Of four and eight no two in a row or
# column, their mean the middle. Assumed; InfiniteReality's manual would settle it. Of two, the NV2A's: its
# middle and its upper left corner. Measured: Swath_width captures.
SAMPLE_POSITIONS = {
    1: ((0, 0),),
    2: ((-8, 8), (0, 0)),
    4: ((-6, -2), (-2, 6), (2, -6), (6, 2)),
    8: ((-7, -1), (-5, 5), (-3, -5), (-1, 3), (1, -3), (3, 7), (5, 1), (7, -7)),
}


def sampled(place, profile):
    """(what a Draw is shifted by, the sample that draws its pixels) for a sample's place, each in 1/16 pixel
    with y up; None: the window has one sample, in its pixels' middle.
    """
    if place is None or profile.framebuffers.shades_samples:
        return place or SAMPLE_POSITIONS[1][0], None
    return SAMPLE_POSITIONS[1][0], place


def mean(colors):
    """The mean of integer arrays, rounded to nearest, a half up: of their type."""
    total = sum(color.astype(np.int64) for color in colors)
    return ((2 * total + len(colors)) // (2 * len(colors))).astype(colors[0].dtype)


class Samples:
    """A window's samples. ``targets``: (framebuffer, position) of each.

    ``window``: the Framebuffer whose colours are the samples' means as soon as ``resolve`` has been called,
    and whose depths and stencil values are the first sample's.
    """

    def __init__(self, window, count):
        self._window = window
        self.targets = tuple(
            (
                replace(
                    window,
                    color=np.zeros_like(window.color),
                    depth=window.depth.copy() if k else window.depth,
                    stencil=window.stencil.copy() if k else window.stencil,
                    _auxiliary={},
                ),
                position,
            )
            for k, position in enumerate(SAMPLE_POSITIONS[count])
        )
        self._written = set()

    def write(self, which):
        """Colours of the buffer ``which``, a ColorBuffer, are about to change in every sample."""
        self._written.add(which)

    def side_by_side(self):
        """Colours of the back buffer as the chip's memory has them: [h, samples w, 4], each pixel's in a row.

        Measured: of two (Swath_width captures).
        """
        colors = np.stack([sample.color for sample, _ in self.targets], axis=2)
        return colors.reshape(self._window.height, -1, 4)

    def resolve(self):
        """Make the window's colours the means of what was written."""
        for which in self._written:
            colors = [sample.buffer(which).color for sample, _ in self.targets]
            self._window.buffer(which).color[...] = mean(colors)
        self._written.clear()

    def share_accumulation(self):
        """Every sample's framebuffer names the window's accumulation buffer."""
        for sample, _ in self.targets:
            sample.accumulation = accumulation_of(self._window)
