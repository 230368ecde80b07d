"""Multisampling (SGIS_multisample, later ARB_multisample): several samples in each pixel.

Every sample is a framebuffer of its own, with colour, depth and stencil, and a Draw is drawn into each. A
machine that shades samples shifts the Draw so that the sample's place lies at the middle of pixels, and
computes everything of a fragment there. On another machine the sample's place only decides which pixels are
drawn. Commands that read colours get the mean of a pixel's samples. Commands that read depths and stencil
values get the first sample's. docs/numbers.md has the rule.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.pipeline.framebuffers.accumulation import accumulation_of

# Places in a pixel, in 1/16 pixel from its middle, x to the right and y up. Of four and eight samples, no two
# share a row or a column, and their mean is the middle. Assumed; InfiniteReality's manual would settle it.
# Two samples are the NV2A's: its middle and its upper left corner. Measured: Swath_width captures.
SAMPLE_POSITIONS = {
    1: ((0, 0),),
    2: ((-8, 8), (0, 0)),
    4: ((-6, -2), (-2, 6), (2, -6), (6, 2)),
    8: ((-7, -1), (-5, 5), (-3, -5), (-1, 3), (1, -3), (3, 7), (5, 1), (7, -7)),
}


def sampled(place, profile):
    """(shift of a Draw, sample that decides its pixels) for a sample's place, in 1/16 pixel with y up.

    A place of None means that the window has one sample, at its pixels' middle.
    """
    if place is None or profile.framebuffers.shades_samples:
        return place or SAMPLE_POSITIONS[1][0], None
    return SAMPLE_POSITIONS[1][0], place


def mean(colors):
    """The mean of integer arrays in their type, rounded to nearest, halves up."""
    total = sum(color.astype(np.int64) for color in colors)
    return ((2 * total + len(colors)) // (2 * len(colors))).astype(colors[0].dtype)


class Samples:
    """A window's samples. ``targets`` has (framebuffer, position) of each.

    ``resolve`` sets the colours of the Framebuffer ``window`` to the samples' means. The window's depths and
    stencil values are the first sample's.
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
        """Note that a command changes colours of the buffer ``which``, a ColorBuffer, in every sample."""
        self._written.add(which)

    def side_by_side(self):
        """Colours of the back buffer in the chip memory's layout: [h, samples w, 4], a pixel's in a row.

        Measured: with two samples (Swath_width captures).
        """
        colors = np.stack([sample.color for sample, _ in self.targets], axis=2)
        return colors.reshape(self._window.height, -1, 4)

    def resolve(self):
        """Set the window's colours to the means of the buffers that were written."""
        for which in self._written:
            colors = [sample.buffer(which).color for sample, _ in self.targets]
            self._window.buffer(which).color[...] = mean(colors)
        self._written.clear()

    def share_accumulation(self):
        """Give every sample's framebuffer the window's accumulation buffer."""
        for sample, _ in self.targets:
            sample.accumulation = accumulation_of(self._window)
