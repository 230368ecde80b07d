"""Frames that are not requested: their commands wait, and are dropped if a clear comes before a read.

A game clears its window at the beginning of each frame. So of the frames before the requested one only the
last is drawn, because the front buffer shows its contents; textures are stored.
"""

from collections.abc import Iterator, Sequence

from fixedpipe.effects.replays.recording import cleared_by, touched_by
from fixedpipe.pipeline.commands import Bitmap, Clear, Command, Draw, DrawPixels, TexImage

# What reads no colours, depths or stencil values but those of its own pixels.
_WAITING = (Clear, Draw, DrawPixels, Bitmap, TexImage)
_MOST_WAITING = 20_000  # commands of a program that clears nothing


class Postponed:
    """Commands that wait, in parts; a swap of the buffers is between two of them."""

    def __init__(self):
        self._parts: list[list[Command]] = [[]]
        self._count = 0
        self._touched: set[str] = {"color"}  # what any command read or wrote

    def take(self, commands: Sequence[Command]) -> bool:
        """Let commands wait; False: they read what others draw, or are too many."""
        if self._count > _MOST_WAITING or not all(type(command) in _WAITING for command in commands):
            return False
        for command in commands:
            self._touched |= touched_by(command)
        self._parts[-1] += commands
        self._count += len(commands)
        return True

    def swap(self) -> None:
        """The front buffer shows the back buffer's contents. Commands before its last clear can no longer be
        seen.
        """
        for number in reversed(range(len(self._parts))):
            part = self._parts[number]
            for place in reversed(range(len(part))):
                command = part[place]
                if isinstance(command, Clear) and cleared_by(command) >= self._touched:
                    before = [*self._parts[:number], part[:place]]
                    self._parts = [[*_stored(before), *part[place:]], *self._parts[number + 1 :]]
                    self._count = sum(map(len, self._parts))
                    self._parts.append([])
                    return
        self._parts.append([])

    def take_parts(self) -> Iterator[tuple[Command, ...]]:
        """The waiting commands, part by part; afterwards none wait."""
        parts, self._parts, self._count = self._parts, [[]], 0
        return iter([tuple(part) for part in parts])

    def __bool__(self) -> bool:
        return self._count > 0 or len(self._parts) > 1


def _stored(parts):
    """The last TexImage of each texture."""
    last: dict[str, Command] = {}
    for part in parts:
        for command in part:
            if isinstance(command, TexImage):
                last.pop(command.texture, None)
                last[command.texture] = command
    return last.values()
