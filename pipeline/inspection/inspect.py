"""Everything that happened to a pixel of a frame."""

from typing import Any

from fixedpipe.pipeline.inspection.history import PixelHistory, Touched
from fixedpipe.pipeline.inspection.pixel import ReplayedPixel
from fixedpipe.pipeline.inspection.recording import RecordedFrame, record
from fixedpipe.pipeline.inspection.stages import FragmentWitness, fragment_of
from fixedpipe.pipeline.profiles.profile import Profile


def inspect(
    commands: Any,
    profile: Profile,
    width: int,
    height: int,
    pixel: tuple[int, int],
    *,
    surface: str | None = None,
    **machine: Any,
) -> PixelHistory:
    """Run ``commands`` and tell everything that happened to a pixel. Returns a PixelHistory.

    Parameters
    ----------
    commands, profile, width, height, **machine
        As ``execute`` takes them.
    pixel : tuple of int
        (x, y), counted from the top left as in a picture, y downwards.
    surface : str or None
        A pbuffer; None: the window.

    Raises
    ------
    UnsupportedState, ValueError
        As ``execute`` does; ValueError for a pixel outside.
    AssertionError
        If the pixel, drawn again, were another than the frame's: a fault of this project.

    To ask for several pixels of a frame: ``record`` it once, then ``history``.
    """
    return history(record(commands, profile, width, height, **machine), pixel, surface)


def history(frame: RecordedFrame, pixel: tuple[int, int], surface: str | None = None) -> PixelHistory:
    """The PixelHistory of a pixel of a frame that has run. See ``inspect``."""
    x, y = pixel
    replayed, touched = ReplayedPixel(frame, x, y, surface), []
    shown = frame.shown(surface)
    for touch in replayed.run(FragmentWitness):
        command = touch.step.command
        fragments = tuple(fragment_of(seen, command.state, shown.color_bits) for seen in touch.fragments)
        touched.append(
            Touched(
                touch.step.number,
                command.label,
                type(command).__name__,
                touch.sample,
                touch.before,
                touch.after,
                fragments,
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
    )
