"""Where two frames diverge: the first command after which they differ, by how much, at which
pixel and stage.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fixedpipe.pipeline.commands import Command
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.framebuffers.framebuffer import Framebuffer
from fixedpipe.pipeline.inspection.history import PixelHistory, Stage
from fixedpipe.pipeline.inspection.inspect import history
from fixedpipe.pipeline.inspection.recording import record
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.validation.frames import frame_of

PLANES = ("color", "depth", "stencil")


@dataclass(frozen=True, eq=False)
class Difference:
    """Two frames after the first command that leaves them different.

    command, label  the command's number among those that ran, and its label
    plane           the first of PLANES that differs
    count, largest  how many pixels differ, and the largest difference of their values; for colours 1.0 is
                    full intensity
    box             (x0, y0, x1, y1) around them, device pixels, half open
    pixel           (x, y), the pixel that differs most
    stages          the first stages at that pixel whose results differ, one of each frame; None: the frame
                    has no such stage
    first, second   the plane of each frame, float64 [h, w, ...], top row first
    """

    command: int
    label: str
    plane: str
    count: int
    largest: float
    box: tuple[int, int, int, int]
    pixel: tuple[int, int]
    stages: tuple[Stage | None, Stage | None]
    first: NDArray[np.float64]
    second: NDArray[np.float64]


@dataclass(frozen=True)
class Run:
    """A frame to compare: commands and a machine. ``settings``: as ``execute`` takes them."""

    commands: tuple[Command, ...]
    profile: Profile
    settings: tuple[tuple[str, Any], ...] = ()


def compare(runs: Sequence[Run], width: int, height: int) -> Difference | None:
    """Run two frames of the same size and find where they diverge: a Difference, or None if they never do.

    Raises what ``execute`` raises, and ValueError if the frames' commands are of different types: they cannot
    be compared one by one.
    """
    first, second = (tuple(_digests(run, width, height)) for run in runs)
    kinds = [[kind for kind, _, _ in each] for each in (first, second)]
    if kinds[0] != kinds[1]:
        place = next((n for n, pair in enumerate(zip(*kinds, strict=False)) if len(set(pair)) > 1), None)
        lengths = " and ".join(str(len(each)) for each in kinds)
        where = f"number {place} differs" if place is not None else "one has more"
        raise ValueError(
            f"The frames have {lengths} commands, and {where}; compare frames of the same commands."
        )
    for number, (a, b) in enumerate(zip(first, second, strict=True)):
        if a[2] != b[2]:
            return _difference(runs, width, height, number, a[1])
    return None


def _values(framebuffer: Framebuffer):
    """A framebuffer's planes as values that do not depend on the number of bits."""
    return {
        "color": framebuffer.color / float(2**framebuffer.color_bits - 1),
        "depth": framebuffer.depth / float(2**framebuffer.depth_bits - 1),
        "stencil": framebuffer.stencil.astype(np.float64),
    }


def _watched(run: Run, width: int, height: int, watch):
    """Run a frame, and call ``watch(number, command, framebuffer)`` after each command."""
    machine, number = Machine(run.profile, width, height, **dict(run.settings)), 0

    def seen(command, snapshot):
        nonlocal number
        watch(number, command, machine.drawn())
        number += 1

    machine.run(run.commands, trace=seen)


def _digests(run, width, height) -> Iterable[tuple[str, str, tuple[str, ...]]]:
    """(type, label, digest of each plane) after every command."""
    found = []

    def watch(number, command, framebuffer):
        planes = tuple(
            hashlib.sha256(np.ascontiguousarray(plane).tobytes()).hexdigest()
            for plane in _values(framebuffer).values()
        )
        found.append((type(command).__name__, command.label, planes))

    _watched(run, width, height, watch)
    return found


def _difference(runs, width, height, number, label):
    kept: list[dict[str, NDArray[np.float64]]] = []

    def watch(at, command, framebuffer):
        if at == number:
            kept.append(_values(framebuffer))

    for run in runs:
        _watched(run, width, height, watch)
    plane = next(name for name in PLANES if not np.array_equal(kept[0][name], kept[1][name]))
    first, second = (each[plane] for each in kept)
    size = np.abs(first - second)
    size = size.max(axis=2) if size.ndim == 3 else size
    rows, columns = np.nonzero(size)
    y, x = (int(n) for n in np.unravel_index(int(size.argmax()), size.shape))
    box = int(columns.min()), int(rows.min()), int(columns.max()) + 1, int(rows.max()) + 1
    stages = _parted([_history(run, width, height, (x, y), number) for run in runs], number)
    return Difference(number, label, plane, len(rows), float(size.max()), box, (x, y), stages, first, second)


def _history(run, width, height, pixel, number) -> PixelHistory:
    frame = record(frame_of(run.commands), run.profile, width, height, **dict(run.settings))
    return history(frame, pixel, frame.steps[number].surface)


def _parted(histories, number) -> tuple[Stage | None, Stage | None]:
    """The first two stages of a command's fragments at a pixel whose results differ."""
    touched = [[t for t in found.touched if t.number == number] for found in histories]
    stages = [[s for t in each for f in t.fragments for s in f.stages] for each in touched]
    for a, b in zip(*stages, strict=False):
        if a.title != b.title or [q.values for q in a.made] != [q.values for q in b.made]:
            return a, b
    rest = [each[min(map(len, stages)) :] for each in stages]
    return tuple(each[0] if each else None for each in rest)
