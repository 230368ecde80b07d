"""Opens a trace, reads it call by call, and yields the requested frames one by one."""

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from typing import BinaryIO

from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.replays.asked import FramesAsked
from fixedpipe.effects.replays.recording import frame_commands
from fixedpipe.effects.replays.replay import Frame, Replay
from fixedpipe.pipeline.commands import Command
from fixedpipe.pipeline.messages import count
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.traces.calls import Trace, TraceError


class _Counted:
    """A file that counts the bytes that were read from it."""

    def __init__(self, file: BinaryIO, path: str):
        self._file, self._path, self.place = file, path, 0

    def read(self, size: int) -> bytes:
        """As ``read`` of a file. Raises Refusal where that raises OSError."""
        try:
            data = self._file.read(size)
        except OSError as error:
            raise _unreadable(self._path, error) from error
        self.place += len(data)
        return data


def _unreadable(path, error):
    return Refusal(f"{path} cannot be read: {error.strerror}.")


@contextmanager
def opened(path: str) -> Iterator[tuple[Trace, Callable[[], float | None]]]:
    """(Trace, a function that returns which share of the file was read, or None for a pipe).

    ``-`` is standard input. Raises Refusal if the file is not a trace or cannot be read.
    """
    with _file(path) as file:
        counted = _Counted(file, path)
        size = 0 if path == "-" else os.fstat(file.fileno()).st_size
        try:
            with Trace(counted) as trace:
                yield trace, lambda: counted.place / size if size else None
        except TraceError as error:
            raise Refusal(f"{path}: {error}") from error


def _file(path):
    """The file of a path, for reading; standard input stays open. Raises Refusal."""
    if path == "-":
        if sys.stdin is None:
            raise Refusal("Standard input is closed; give a trace's file, or a pipe.")
        return nullcontext(sys.stdin.buffer)
    try:
        return open(path, "rb")
    except OSError as error:
        raise _unreadable(path, error) from error
    except ValueError as error:
        raise Refusal(f"{path!r} is no name of a file: {error}.") from error


def frames_of(
    trace: Trace, replay: Replay, asked: FramesAsked, *, to_the_end: bool = False
) -> Iterator[Frame]:
    """All frames of a trace, up to the last requested one. ``to_the_end``: whether to read the whole trace.

    Frames after the last requested one are neither drawn nor yielded.
    """
    over = False
    for call in trace:
        for frame in replay.take(call):
            if over:
                continue
            yield frame
            over = asked.is_over(frame.number, frame.draws)
            if over:
                replay.stop_drawing()
        if over and not to_the_end:
            return
    for frame in replay.finish():
        if not over:
            yield frame
            over = asked.is_over(frame.number, frame.draws)


def drawn_frames(
    path: str | os.PathLike[str], profile: Profile, frames: str | None = None, *, threads: int | None = None
) -> Iterator[Frame]:
    """The requested frames of a trace, each with its ``image``; for example for tests.

    ``frames``: such as ``3,10-20``, or ``all``; None: the first frame that draws something. Raises Refusal if
    the trace cannot be read, is damaged or lacks one of them, and ValueError if ``frames`` has another form.
    """
    asked, found, where = FramesAsked.of(frames), [], os.fspath(path)
    replay = Replay(profile, wanted=asked.wants, needed=asked.may_want, threads=threads)
    with opened(where) as (trace, _):
        for frame in frames_of(trace, replay, asked):
            if asked.wants(frame.number, frame.draws):
                found.append(frame.number)
                yield frame
        damage = trace.damage
    missing = asked.missing(found)
    if missing or not found or damage:
        lacks = no_such_frame(missing[0] if missing else None, replay.frames) if missing or not found else ""
        raise Refusal(" ".join(filter(None, (f"{where} {lacks}" if lacks else f"{where}:", damage))))


def frame_of_trace(
    path: str, number: int | None, profile: Profile
) -> tuple[tuple[Command, ...], int, int, int]:
    """(commands, width, height, number) of a frame of a trace; None: the first that draws something.

    Raises Refusal if there is no such frame.
    """
    asked = FramesAsked.of(None if number is None else str(number))
    replay = Replay(profile, wanted=lambda *_: False, needed=asked.may_want, recorded=asked.may_want)
    with opened(path) as (trace, _):
        for frame in frames_of(trace, replay, asked):
            if asked.wants(frame.number, frame.draws) and frame.recording is not None:
                commands = frame_commands(frame.recording, frame.shown)
                return commands, frame.width, frame.height, frame.number
        damage = trace.damage
    raise Refusal(f"{path} {no_such_frame(number, replay.frames)}{f' {damage}' if damage else ''}")


def no_such_frame(number: int | None, frames: int) -> str:
    """The end of a sentence which says that a trace lacks a frame. ``frames``: how many frames it has."""
    if not frames:
        return "has no frame: nothing is drawn."
    if number is None:
        return f"has {count(frames, 'frame')}, and none draws anything."
    there = "its frame is 0" if frames == 1 else f"its frames are 0 to {frames - 1}"
    return f"has no frame {number}; {there}."
