"""Counts the samples of an occlusion query: the fragments that pass every per-fragment test.

The machine records the fragments of each draw, and whether each passed (``Fragments.passed``). This takes
time and memory, so it is done draw by draw, and only if the count is compared with a recorded one.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from fixedpipe.pipeline.commands import Bitmap, Command, CopyPixels, Draw, DrawPixels, kind_of
from fixedpipe.pipeline.enums import PixelCopyType
from fixedpipe.pipeline.framebuffers.result import Fragments

_DRAWING = (Draw, DrawPixels, CopyPixels, Bitmap)


@dataclass(eq=False)
class SampleCounter:
    """Counts samples. ``samples``: how many have passed since the query began."""

    samples: int = 0

    def add(self, records: Iterable[Fragments]) -> None:
        """Add the fragments of draws."""
        self.samples += sum([int(record.passed.sum()) for record in records])


def by_draws(commands: Sequence[Command]) -> Iterator[tuple[Command, ...]]:
    """The commands in parts of one draw each, which is the last command of its part."""
    part: list[Command] = []
    for command in commands:
        part.append(command)
        if isinstance(command, _DRAWING):
            yield tuple(part)
            part = []
    if part:
        yield tuple(part)


def gives_fragments(commands: Sequence[Command]) -> bool:
    """Whether drawing such a part makes fragments. Rectangles of stencil values make none."""
    last = commands[-1]
    return not isinstance(last, DrawPixels | CopyPixels) or kind_of(last) is not PixelCopyType.STENCIL
