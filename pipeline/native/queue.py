"""Clears and Draws that wait until a command reads what they draw, and Draws that are kept for repetition.

Every thread takes bands of rows and runs all waiting work on each (``fixedpipe.raster.vector.frame``). Draws
that these kernels do not cover are drawn one after the other (``fixedpipe.raster.portable.draw``).
"""

from collections import Counter

import numpy as np

from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.native.recording import Recording, no_fragments, recorded_fragments
from fixedpipe.pipeline.native.threads import Threads
from fixedpipe.raster.arrays import Buffers
from fixedpipe.raster.vector.arrays import JOB_SIZE, scratch
from fixedpipe.raster.vector.frame import draw_frame, fill_clear

BATCH = 2048  # fragments shaded together; any size gives the same bits. Measured: docs/decisions, page 0002
# Pixels of the scissor boxes of all waiting work: with fewer, a second thread costs more than it saves
# (docs/decisions, page 0002).
_PARALLEL_FROM = 1 << 14
# Bytes of vertices that wait to be drawn, or are kept for a repetition: enough for any figure's frame.
_MOST_BYTES = 1 << 27


class KeptDraws:
    """Draws that the same run repeats; they are prepared once while their textures stay."""

    def __init__(self, commands, samples):
        self._left = Counter([id(command) for command in commands if type(command) is Draw] * samples)
        self._kept, self._size = {}, 0

    def get(self, command, surface, textures):
        """The prepared Draw, or None."""
        found = self._kept.get((id(command), id(surface)))
        if found is None or not all([textures.get(name) is texture for name, texture in found.bound]):
            return None
        self._left[id(command)] -= 1
        if not self._left[id(command)]:
            del self._kept[id(command), id(surface)]
            self._size -= found.size
        return found

    def keep(self, command, surface, draw):
        """Keep a prepared Draw if the run repeats it."""
        self._left[id(command)] -= 1
        key = id(command), id(surface)
        if (stale := self._kept.pop(key, None)) is not None:
            self._size -= stale.size
        if self._left[id(command)] > 0 and self._size + draw.size <= _MOST_BYTES:
            self._kept[key] = draw
            self._size += draw.size


class Queue:
    """Clears and Draws that wait to be drawn into one framebuffer, all by one engine."""

    def __init__(self, threads, batch):
        self.fragments = 0
        self._threads, self._batch = Threads(threads), batch
        self._jobs, self._counter = np.zeros((64, JOB_SIZE), np.int64), np.zeros(1, np.int64)
        self._scratch = {}
        self._empty()

    def _empty(self):
        self._target, self._count, self._draws, self._area, self._size = None, 0, [], 0, 0
        self._records = []

    def draw(self, draw, target, engine, keep=None):
        """Add a prepared Draw. ``keep``: takes its Fragments when they are drawn; or None."""
        if draw.area == 0:
            if keep is not None:
                keep(no_fragments())
            return
        self._into(target)
        if engine == "portable":
            draw.job = False
        elif draw.job is None:
            draw.fill_job()
        record = None if keep is None or draw.job is False else Recording.of(draw)
        if keep is not None and record is None:
            self.flush()
            drawn = recorded_fragments(draw, buffers_of(target), self._batch)
            self.fragments += len(drawn.x)
            keep(drawn)
            return
        if draw.job is False:
            if self._count:
                self.flush()
        else:
            if self._draws and not self._count:
                self.flush()
            self._job(target)[:] = draw.job
        if record is not None:
            record.of_row(self._jobs, self._count - 1)
            self._records.append((record, keep))
            self._size += record.rows.nbytes
        self._target = target
        self._draws.append(draw)
        self._area += draw.area
        self._size += draw.size
        if self._size > _MOST_BYTES:
            self.flush()

    def room(self, count, target):
        """The table's next ``count`` rows, for the vector engine's Draws into ``target``."""
        self._into(target)
        if self._draws and not self._count:
            self.flush()
        while len(self._jobs) < self._count + count:
            self._jobs = np.concatenate([self._jobs, np.zeros_like(self._jobs)])
        return self._jobs[self._count : self._count + count]

    def filled(self, count, draw, target):
        """Add the first ``count`` rows of ``room``, whose arrays ``draw`` keeps, a Prepared of their box."""
        self._target = target
        self._count += count
        self._draws.append(draw)
        self._area += count * draw.area
        self._size += draw.size
        if self._size > _MOST_BYTES:
            self.flush()

    def clear(self, command, target, engine):
        """Add a Clear."""
        self._into(target)
        if engine == "portable" or (self._draws and not self._count):
            self.flush()
            target.clear(command)
            return
        box, buffers, *words = target.clear_words(command)
        fill_clear(self._job(target)[None], 0, box, buffers, tuple(words))
        self._area += (box[2] - box[0]) * (box[3] - box[1])

    def outlive(self, texture):
        """Count the memory of a texture that is replaced while waiting Draws keep it.

        Draw them when it is too much.
        """
        if texture is None or not self._draws:
            return
        self._size += sum(level.nbytes for level in texture.levels)
        if self._size > _MOST_BYTES:
            self.flush()

    def _into(self, target):
        """Draw the waiting work if the next goes to another of the window's colour buffers."""
        if self._target is not None and self._target is not target:
            self.flush()

    def _job(self, target):
        """The table's next row."""
        if self._count == len(self._jobs):
            self._jobs = np.concatenate([self._jobs, np.zeros_like(self._jobs)])
        self._target = target
        self._count += 1
        return self._jobs[self._count - 1]

    def flush(self):
        """Draw the waiting work. Each thread draws its own bands of rows, of all of it."""
        if not (self._count or self._draws):
            return
        target, count, draws, area = self._target, self._count, self._draws, self._area
        records = self._records
        self._empty()
        threads = self._threads.count if area >= _PARALLEL_FROM else 1
        buffers = buffers_of(target)
        if count:
            self._counter[0] = 0

            def share(number, _kept=draws):  # keeps the arrays alive that the table names
                scratch = self._scratch_of(number)
                return draw_frame(self._jobs, count, self._counter, self._batch, buffers, scratch)

        else:

            def share(number):
                return sum([d.bands(number, threads, self._batch, buffers) for d in draws])

        self.fragments += share(0) if threads == 1 else self._threads.run(share)
        for record, keep in records:
            keep(record.fragments())

    def _scratch_of(self, number):
        if number not in self._scratch:
            self._scratch[number] = scratch(self._batch)
        return self._scratch[number]


def buffers_of(framebuffer):
    """A framebuffer's arrays for kernels: a pixel of bytes is one word, another is four."""
    color = framebuffer.color.reshape(framebuffer.height, -1).view(np.uint32)
    return Buffers(color, framebuffer.depth, framebuffer.stencil)
