"""Validation of frames, and of HostSteps and the commands that they issue."""

from collections.abc import Iterable, Mapping
from typing import Any

from numpy.typing import NDArray

from fixedpipe.pipeline.commands import COMMANDS, Command, HostStep
from fixedpipe.pipeline.messages import quoted, shown
from fixedpipe.pipeline.multi_draw import MultiDraw, with_draws
from fixedpipe.pipeline.validation.walk import UnsupportedState, Walk


def frame_of(commands: Iterable[Command | MultiDraw]) -> tuple[Command, ...]:
    """The commands as a tuple, with the Draws that a MultiDraw stands for in its place.

    Raises UnsupportedState for a single command, and for a value that is not iterable.
    """
    return with_draws(commands_of(commands))


def commands_of(commands: Iterable[Command | MultiDraw]) -> tuple[Command | MultiDraw, ...]:
    """As ``frame_of``, with MultiDraws as they are."""
    if type(commands) in (*COMMANDS, MultiDraw):
        raise UnsupportedState(
            f"A frame is a tuple of commands; this is one {type(commands).__name__}. Write (command,)."
        )
    try:
        return tuple(commands)
    except TypeError:
        raise UnsupportedState(
            f"A frame is a tuple of commands; this is {shown(commands)}. Give a tuple."
        ) from None


def _unwritable(array):
    """A read-only view of the array, so that a HostStep cannot change the pixels that were read."""
    view = array.view()
    view.setflags(write=False)
    return view


def issued_by(step: HostStep, pixels: Mapping[str, NDArray[Any]]) -> tuple[Command, ...]:
    """The commands that a HostStep issues for the pixels read so far, as a tuple.

    Raises UnsupportedState where the step's function returns no tuple of commands. Errors that the function
    raises pass through, with a note that names the HostStep.
    """
    try:
        issued = step.commands({name: _unwritable(pixels[name]) for name in step.reads})
    except Exception as error:
        error.add_note(f'in the function of HostStep "{step.label}"')
        raise
    try:
        return frame_of(issued)
    except UnsupportedState as error:
        raise UnsupportedState(f'HostStep "{step.label}": {error}') from None


def host_step(walk: Walk, command: HostStep) -> None:
    """Refuse a HostStep that reads pixels which no earlier command read, or while a pbuffer is current."""
    if not walk.in_window:
        walk.refuse("a pbuffer is current; make the window current first, which the host draws to.")
    if missing := [name for name in command.reads if name not in walk.given]:
        names = quoted(sorted(walk.given))
        walk.refuse(
            f"nothing has read {missing[0]!r} before (read so far: {names}); put a ReadPixels of this "
            "name before it."
        )
