"""Frames that are not requested: their commands wait, and are dropped if a clear comes before a read.

A game clears its window at the beginning of each frame. So of the frames before the requested one only the
last is drawn, because the front buffer shows its contents; textures are stored.
"""

from collections.abc import Iterator, Sequence

from fixedpipe.effects.replays.recording import cleared_by, touched_by
from fixedpipe.pipeline.commands import Bitmap, Clear, Command, Draw, DrawPixels, TexImage

# Commands that read colours, depths and stencil values only at their own pixels.
_WAITING = (Clear, Draw, DrawPixels, Bitmap, TexImage)
# The limits for a program that clears nothing. An image's texels are bytes or floats.
_MOST_WAITING, _MOST_BYTES = 20_000, 1 << 27


def bytes_of(command: Command) -> int:
    """How many bytes the images of a command have."""
    image = getattr(command, "image", None)
    if image is None:
        image = getattr(command, "pixels", None)
    arrays = getattr(image, "levels", None) or (getattr(image, "values", None),)
    return sum(array.nbytes for array in arrays if array is not None)


class Postponed:
    """Commands that wait, in parts. Between two parts there is a swap of the buffers."""

    def __init__(self):
        self._parts: list[list[Command]] = [[]]
        self._count = self._bytes = 0
        self._touched: set[str] = {"color"}  # the kinds of values that any command read or wrote

    def take(self, commands: Sequence[Command]) -> bool:
        """Let commands wait. Returns False if they read what others draw, or if too many wait."""
        if self._count > _MOST_WAITING or self._bytes > _MOST_BYTES:
            return False
        if not all(type(command) in _WAITING for command in commands):
            return False
        for command in commands:
            self._touched |= touched_by(command)
        self._parts[-1] += commands
        self._count += len(commands)
        self._bytes += sum(map(bytes_of, commands))
        return True

    def swap(self) -> None:
        """Handle a swap: the front buffer shows the back buffer's contents. Commands before the last clear
        are dropped, because their result cannot be seen any more.
        """
        for number in reversed(range(len(self._parts))):
            part = self._parts[number]
            for place in reversed(range(len(part))):
                command = part[place]
                if isinstance(command, Clear) and cleared_by(command) >= self._touched:
                    before = [*self._parts[:number], part[:place]]
                    self._parts = [[*_stored(before), *part[place:]], *self._parts[number + 1 :]]
                    self._count = sum(map(len, self._parts))
                    self._bytes = sum(bytes_of(command) for part in self._parts for command in part)
                    self._parts.append([])
                    return
        self._parts.append([])

    def take_parts(self) -> Iterator[tuple[Command, ...]]:
        """The waiting commands, part by part. Afterwards no command waits."""
        parts, self._parts = self._parts, [[]]
        self._count = self._bytes = 0
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
