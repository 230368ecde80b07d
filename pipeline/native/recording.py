"""The fragments of recorded Draws, for who asks which pixels each triangle drew."""

import math
from dataclasses import dataclass

import numpy as np

from fixedpipe.pipeline.framebuffers.result import Fragments
from fixedpipe.pipeline.native.prepared_draw import Prepared
from fixedpipe.raster.primitives.bins import most_fragments
from fixedpipe.raster.vector.record import in_columns, record_job

# Rows of a recording by the portable engine: a first guess, and the most where there is a bound. Unwritten
# rows take no memory.
_USUAL, _MOST = 1 << 20, 1 << 24


def no_fragments():
    """The Fragments of a Draw that has none."""
    return Fragments(*np.empty((4, 0), np.int32))


def recorded_fragments(draw, buffers, batch):
    """Draw a prepared Draw with the portable engine into Buffers, and return its Fragments."""
    if draw.area == 0:
        return no_fragments()
    most, rows = math.inf, _USUAL
    if draw.primitives.orderly and not len(draw.primitives.strokes):
        most = _bound(draw)[0]
        rows = min(most, _MOST)
    fits = most <= rows
    recording = np.empty((rows, 5), np.int32)
    saved = () if fits else [buffer.copy() for buffer in buffers]
    count = draw.bands(0, 1, batch, buffers, recording)
    if not fits and count > len(recording):  # too small: draw again
        for buffer, before in zip(buffers, saved, strict=True):
            buffer[:] = before
        recording = np.empty((count, 5), np.int32)
        draw.bands(0, 1, batch, buffers, recording)
    smooth = recording[:count, 4].any()
    columns = np.empty((5 if smooth else 4, count), np.int32)
    in_columns(np.zeros(1, np.int64), np.array([count]), recording, columns)
    return Fragments(*columns)


def _bound(draw):
    """(the most fragments that a prepared Draw of triangles has, of which the bands before each have how
    many, int64 [bands]).
    """
    p, firsts = draw.primitives, np.empty(len(draw.ends), np.int64)
    most = most_fragments(draw.order, draw.ends, p.triangles, p.x, p.y, draw.packed.draw, firsts)
    return most, firsts


@dataclass(eq=False, slots=True)
class Recording:
    """The arrays that the vector engine records a Draw in (``fixedpipe.raster.vector.arrays.Record``)."""

    firsts: np.ndarray
    counts: np.ndarray
    rows: np.ndarray

    @classmethod
    def of(cls, draw: Prepared):
        """The Recording of a prepared Draw with a ``job``; None where it might take too much memory."""
        most, firsts = _bound(draw)
        if most > _MOST:
            return None
        return cls(firsts, np.empty(len(firsts), np.int64), np.empty((most, 4), np.int32))

    def of_row(self, jobs, k):
        """Record row ``k`` of the table of jobs."""
        record_job(jobs, k, (self.firsts, self.counts, self.rows))

    def fragments(self):
        """The Fragments, when the row has been drawn."""
        columns = np.empty((4, int(self.counts.sum())), np.int32)
        in_columns(self.firsts, self.counts, self.rows, columns)
        return Fragments(*columns)
