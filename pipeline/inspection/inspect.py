"""Everything that happened to a pixel of a frame."""

from typing import Any

from fixedpipe.pipeline.enums import ColorBuffer
from fixedpipe.pipeline.inspection.history import PixelHistory, Touched
from fixedpipe.pipeline.inspection.ideal import IdealPixel, RecordedIdeal, record_ideal
from fixedpipe.pipeline.inspection.pixel import ReplayedPixel
from fixedpipe.pipeline.inspection.recording import RecordedFrame, record
from fixedpipe.pipeline.inspection.stages import FragmentWitness, fragment_of
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.validation.frames import frame_of


def inspect(
    commands: Any,
    profile: Profile,
    width: int,
    height: int,
    pixel: tuple[int, int],
    *,
    surface: str | None = None,
    ideal: Any = None,
    **machine: Any,
) -> PixelHistory:
    """Run ``commands`` and report everything that happened to a pixel. Returns a PixelHistory.

    Parameters
    ----------
    commands, profile, width, height, **machine
        The parameters of ``execute``.
    pixel : tuple of int
        (x, y), counted from the top left as in a picture, y downwards.
    surface : str or None
        A pbuffer; None: the window.
    ideal : tuple of commands or None
        The commands that the ideal evaluates for comparison; None: ``commands``.

    Raises
    ------
    UnsupportedState, ValueError
        As ``execute`` does; ValueError for a pixel outside.
    AssertionError
        If the pixel, drawn again, differs from the frame's. This is an error in this project.

    For several pixels of a frame, call ``record`` and ``record_ideal`` once, and ``history`` for each pixel.
    """
    commands = frame_of(commands)
    frame = record(commands, profile, width, height, **machine)
    beside = None
    if surface is None:
        beside = record_ideal(commands if ideal is None else ideal, frame, commands)
    return history(frame, pixel, surface, beside)


def history(
    frame: RecordedFrame,
    pixel: tuple[int, int],
    surface: str | None = None,
    ideal: RecordedIdeal | None = None,
) -> PixelHistory:
    """The PixelHistory of a pixel of a frame that has run, compared with its ``ideal``. See ``inspect``."""
    x, y = pixel
    replayed, touched = ReplayedPixel(frame, x, y, surface), []
    beside = None if ideal is None else IdealPixel(ideal, x, y)
    shown = frame.shown(surface)
    for touch in replayed.run(FragmentWitness):
        command, state = touch.step.command, touch.alone
        ideals: list[Any] = [None] * len(touch.fragments)
        if beside is not None:
            ideals = beside.follow(touch, touch.passed, FragmentWitness) or ideals
        fragments = tuple(
            fragment_of(seen, state, frame.shown(touch.step.surface).color_bits, found)
            for seen, found in zip(touch.fragments, ideals, strict=True)
        )
        buffer = getattr(command if state is None else state, "draw_buffer", ColorBuffer.BACK)
        touched.append(
            Touched(
                touch.step.number,
                command.label,
                type(command).__name__,
                touch.sample,
                touch.before,
                touch.after,
                fragments,
                () if beside is None else beside.color(buffer),
                touch.step.surface,
            )
        )
    replayed.check()
    return PixelHistory(
        frame.profile.name,
        shown.width,
        shown.height,
        x,
        y,
        shown.height - 1 - y,
        surface,
        2**shown.color_bits - 1,
        len(frame.steps),
        tuple(touched),
        replayed.value(),
        () if beside is None else beside.color(),
    )
