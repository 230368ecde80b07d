"""The passes of a figure as pictures: the framebuffer after some of its commands, from the run
that draws it.
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from fixedpipe.effects.reports.pictures import THUMBNAIL, reduced
from fixedpipe.effects.reports.trace import DRAWING
from fixedpipe.pipeline.commands import Command
from fixedpipe.pipeline.framebuffers.snapshot import Snapshot

# Pictures of a method at most, the finished one among them, and how many are looked at to choose them.
MOST, _LOOKED_AT = 12, 48
# Lines of the commands before a picture.
_LINES = 24


@dataclass(frozen=True)
class Pass:
    """The result of a command: its ``number`` in the frame, from 0, its ``label``, and the ``picture``.

    The picture is uint8 [h, w, 4], reduced, except the last. ``commands``: the commands since the picture
    before, in a few lines.
    """

    number: int
    label: str
    commands: tuple[str, ...]
    picture: np.ndarray


class Passes:
    """A Watch of the run of a frame: it looks at only some of the commands that draw, so that thousands of
    polygons cost as little as a few passes.
    """

    def __init__(self, commands, shape):
        """``commands``: of the frame. ``shape``: height and width of the window; pbuffers are not shown."""
        drawing = sum(isinstance(command, DRAWING) for command in commands)
        self.every, self.shape = -(-drawing // _LOOKED_AT), shape
        self.drawn, self.lines, self.seen = 0, [], []

    def __call__(self, command: Command, take: Callable[[], Snapshot]) -> None:
        """Look at what the command left, if it is its turn."""
        self.lines.append(f"{type(command).__name__}: {command.label}")
        if not isinstance(command, DRAWING):
            return
        self.drawn += 1
        if self.every and self.drawn % self.every == 0:
            color = take().color
            if color.shape[:2] == self.shape:
                picture = reduced(np.ascontiguousarray(color[..., :3]), THUMBNAIL)
                self.seen.append((len(self.lines) - 1, picture))

    def passes(self, finished):
        """The Passes that change most, ``MOST`` at most, in their order; commands that change nothing visible
        join the pass before them, and the last pass has all that remain.

        ``finished``: the picture of the whole frame, uint8 [h, w, 4].
        """
        last = len(self.lines) - 1
        small = reduced(np.ascontiguousarray(finished[..., :3]), THUMBNAIL)
        chosen = _most_different([*self.seen, (last, small)], MOST)
        out, begin = [], 0
        for number, picture in chosen:
            is_last = number == chosen[-1][0]
            end = last if is_last else number
            label = self.lines[number].partition(": ")[2]
            lines = _folded(self.lines[begin : end + 1])
            out.append(Pass(number, label, lines, finished if is_last else picture))
            begin = end + 1
        return out


def _most_different(seen, most):
    """So many of the (number, picture), in their order. Those go that look like the one before, the first
    like a new framebuffer; then that one, again and again, from which the next differs least.
    """
    empty = -1, np.zeros_like(seen[0][1])
    kept = [b for a, b in pairwise([empty, *seen]) if _change(a[1], b[1]) > 0.0] or seen[-1:]
    changes = [_change(a[1], b[1]) for a, b in pairwise(kept)]
    while len(kept) > most:
        place = int(np.argmin(changes))
        del kept[place], changes[place]
        if place:
            changes[place - 1] = _change(kept[place - 1][1], kept[place][1])
    return kept


def _change(one, other):
    return float(np.abs(one.astype(np.int16) - other).mean())


def _folded(lines):
    """Lines in which equal neighbours become one. If many remain, only the first and the last."""
    out = []
    for line in lines:
        if out and out[-1][0] == line:
            out[-1][1] += 1
        else:
            out.append([line, 1])
    texts = [line if times == 1 else f"{line} ({times} times)" for line, times in out]
    if len(texts) > _LINES:
        half = _LINES // 2
        texts = [*texts[:half], f"… {len(texts) - 2 * half} more …", *texts[-half:]]
    return tuple(texts)
