"""What a frame's error would be if one thing were different: a width, a clamp, a stage, a constant, a
texture.

The machine's own arithmetic draws the frame again (``Profile.changed``, ``ReplacedStages``). The guided ideal
evaluates the same commands beside it (docs/decisions/0025). A function of the machine makes the frame's
commands, because a machine with wider textures rounds its texels later.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fixedpipe.pipeline.columns.replaced_stages import ReplacedStages
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.enums import Clamp, TextureTarget
from fixedpipe.pipeline.execution.machine import Machine, execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.textures.images import texture_2d
from fixedpipe.pipeline.validation.frames import frame_of
from fixedpipe.raster.observer import unobserved

Commands: TypeAlias = tuple[Any, ...]

# The parts of a machine that have a width, and their names in ``Profile.with_precision``.
PARTS = {
    "combiner": "combiner_bits",
    "texture": "texture_bits",
    "framebuffer": "framebuffer_bits",
    "filter_fraction": "filter_fraction_bits",
}
_WIDEST = 16  # bits, the most that ``Profile.with_precision`` takes


@dataclass(frozen=True)
class Error:
    """A machine's picture minus the ideal of its fragments, over red, green and blue; 1.0 = full intensity.

    shown     root mean square of the pictures as they are seen: both clamped to [0, 1]
    computed  root mean square without clamping the ideal's colours, so that a clamp's part shows
    channels  ``shown`` for each component
    largest   the largest absolute difference that is seen
    """

    shown: float
    computed: float
    channels: tuple[float, float, float]
    largest: float


def _root_mean_square(difference):
    return float(np.sqrt(np.mean(difference * difference)))


def frame_colors(
    commands: Any,
    profile: Profile,
    width: int,
    height: int,
    *,
    ideal: Any = None,
    replaced_stages: Callable[[Draw], ReplacedStages | None] | None = None,
    observer: Callable[..., None] = unobserved,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Run ``commands`` on a machine, and the ideal guided by it: red, green and blue of both.

    ideal                      the commands that the ideal evaluates; None: the same
    replaced_stages, observer  as a Machine takes them

    Returns (machine's, ideal's), float64 [h, w, 3], top row first, 1.0 = full intensity. The ideal's colours
    are not clamped. Raises what ``execute`` and ``execute_ideal`` raise, and ValueError for
    ``replaced_stages`` on a machine that is too wide for them.
    """
    if replaced_stages is None:
        result = execute(commands, profile, width, height, record=True)
    else:
        asked = {"engine": "columns", "replaced_stages": replaced_stages, "observer": observer}
        result = Machine(profile, width, height, **asked).run(commands, record=True)  # type: ignore[arg-type]
    exact = execute_ideal(commands if ideal is None else ideal, width, height, guide=result).color[..., :3]
    return result.framebuffer.color[..., :3] / (2.0**result.framebuffer.color_bits - 1.0), exact


def frame_error(commands: Any, profile: Profile, width: int, height: int, **given: Any) -> Error:
    """Run ``commands`` on a machine and on the ideal guided by it, and return their Error. As
    ``frame_colors``.
    """
    return _error_of(*frame_colors(commands, profile, width, height, **given))


def _error_of(color, exact):
    """The Error of a result of ``frame_colors``."""
    seen = np.clip(color, 0.0, 1.0) - np.clip(exact, 0.0, 1.0)
    channels = tuple(_root_mean_square(seen[..., k]) for k in range(3))
    largest = float(np.abs(seen).max())
    return Error(_root_mean_square(seen), _root_mean_square(color - exact), channels, largest)


def with_bits(profile: Profile, part: str, bits: int) -> Profile:
    """The machine with another width of a part (one of ``PARTS``). Raises ValueError."""
    if part not in PARTS:
        raise ValueError(f"There is no part {part!r} with a width; there are: {', '.join(PARTS)}.")
    return profile.with_precision(**{PARTS[part]: bits})


def without_clamp(profile: Profile, name: str) -> Profile:
    """The machine without the named clamp. Raises ValueError if it has no such clamp."""
    there = [clamp for clamp in Clamp if clamp in profile.arithmetic.clamps]
    for clamp in there:
        if clamp.name == name.upper():
            return profile.without_clamps(clamp)
    names = ", ".join(clamp.name for clamp in there) or "none"
    raise ValueError(f"The {profile.name} has no clamp {name!r} to leave out; it has: {names}.")


def with_constant(commands: Any, number: int, color: tuple[float, float, float, float]) -> Commands:
    """The commands with another constant colour 0 or 1 in every combiner program.

    Raises ValueError if no program has one.
    """
    if number not in (0, 1):
        raise ValueError(f"There is no constant colour {number}; combiners have 0 and 1.")
    changed, found = [], False
    for command in commands:
        program = command.state.register_combiners if type(command) is Draw else None
        if program is not None:
            found = True
            program = replace(program, **{f"constant_color{number}": color})
            command = replace(command, state=replace(command.state, register_combiners=program))
        changed.append(command)
    if not found:
        raise ValueError("No Draw of this frame has register combiners, and so none has their constants.")
    return tuple(changed)


def with_texture(commands: Any, name: str, image: ArrayLike) -> Commands:
    """The commands with another image wherever a TexImage stores the 2D texture ``name``.

    The format stays, and there are levels if there was more than one. ``image``: as ``texture_2d`` takes it.

    Raises ValueError for a name that no TexImage stores, and for another target.
    """
    names = [command.texture for command in commands if type(command) is TexImage]
    if name not in names:
        there = ", ".join(sorted(set(names))) or "none"
        raise ValueError(f"No TexImage of this frame stores {name!r}; there are: {there}.")
    changed = []
    for command in commands:
        if type(command) is TexImage and command.texture == name:
            target, kind, levels = command.target, command.internal_format, command.generate_mipmap
            if (given := command.image) is not None:
                target, kind, levels = given.target, given.internal_format, len(given.levels) > 1
            if target is not TextureTarget.TEXTURE_2D:
                raise ValueError(f"{name} is a {target.name}; only a TEXTURE_2D takes another picture.")
            command = replace(command, image=texture_2d(image, kind, mipmaps=levels), pixels=None)
        changed.append(command)
    return tuple(changed)


def _changes(profile: Profile) -> Iterator[tuple[str, Profile]]:
    """(part, machine) for each part of a machine: a machine in which it alone is as exact as possible.

    The last has all widths at their greatest.
    """
    arithmetic, combines = profile.arithmetic, profile.combiners.max_general_combiners > 0
    if combines and arithmetic.expand_half != 127.5:
        yield "half of EXPAND_NORMAL", profile.changed(expand_half=127.5)
    for part, name in PARTS.items():
        yield f"bits: {part}", profile.with_precision(**{name: _WIDEST})
    for clamp in Clamp:
        if clamp in arithmetic.clamps:
            yield f"clamp: {clamp.name}", profile.without_clamps(clamp)
    widest = profile.with_precision(**dict.fromkeys(PARTS.values(), _WIDEST))
    yield "all bits", widest
    if combines:
        yield "all bits and the half", widest.changed(expand_half=127.5)


def attribution(
    commands_of: Callable[[Profile], Any], profile: Profile, width: int, height: int, *, ideal: Any = None
) -> tuple[Error, list[tuple[str, Error]]]:
    """How much of a frame's error goes if one part of the machine is as exact as possible.

    commands_of  a function from a machine to the frame's commands
    ideal        the commands that the ideal evaluates; None: each machine's own

    Returns the machine's own Error, and (the exact part, the Error then) with the least error first. Errors
    of several causes may cancel or depend on each other, so the parts need not add up to the whole.
    """

    def error(machine):
        return frame_error(commands_of(machine), machine, width, height, ideal=ideal)

    found = [(what, error(machine)) for what, machine in _changes(profile)]
    return error(profile), sorted(found, key=lambda one: one[1].shown)


class _Stages:
    """An observer that follows which command runs and which stages its Draws have, and replaces stages.

    ``number``: the number of the command whose stages count, as they run; None: all commands. ``changed``:
    the ReplacedStages of these commands.
    """

    def __init__(self, number, changed=None):
        self.wanted, self.current, self.found = number, -1, set()
        self._changed, self._draws, self._shades = changed or ReplacedStages(), False, False

    def __call__(self, stage, /, **columns):
        if stage == "command":
            self.current, command = self.current + 1, columns["command"]
            self._draws = type(command) is Draw
            self._shades = self._draws and command.state.texture_shader is not None
        elif not self._draws or self.wanted not in (None, self.current):
            return
        elif stage == "shaded":
            self.found |= {(0, "primary color"), (1, "secondary color"), (9, "final combiner")}
        elif stage == "sampled" and not self._shades:
            self.found.add((3, f"texture unit {columns['sampler'].number}"))
        elif stage == "program" and columns["program"] is not None:
            self.found.add((2, "constant colors"))
            general = columns["program"].general
            self.found |= {(4, f"general combiner {number}") for number in range(len(general))}

    def replaced(self, draw: Draw) -> ReplacedStages:
        """The ReplacedStages of the Draw that runs; a Machine that this observes calls it."""
        return self._changed if self.wanted in (None, self.current) else ReplacedStages()

    def names(self):
        """The stages' names, in the order of a pass. Raises ValueError if there are none."""
        if self.wanted is not None and self.wanted > self.current:
            raise ValueError(
                f"There is no command {self.wanted}; the commands' numbers are 0 to {self.current}."
            )
        if not self.found:
            what = "No command" if self.wanted is None else f"Command {self.wanted} is no Draw that"
            raise ValueError(f"{what} makes fragments, so there is no stage to change.")
        return [name for _, name in sorted(self.found)]


def _stages_error(given, ideal, number, changed):
    """The Error of a frame with the ReplacedStages ``changed``, and the _Stages that observed it."""
    seen = _Stages(number, changed)
    return frame_error(*given, ideal=ideal, replaced_stages=seen.replaced, observer=seen), seen


def colors_with_stages(
    commands: Any,
    profile: Profile,
    width: int,
    height: int,
    *,
    exact: tuple[str, ...] = (),
    unclamped: tuple[str, ...] = (),
    ideal: Any = None,
    number: int | None = None,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The colours of a frame with exact or unclamped stages: the machine's and the ideal's, as of
    ``frame_colors``.

    exact, unclamped  names of stages, as in ``stage_attribution``
    number            the command, as they run, whose stages are replaced; None: all Draws
    ideal             the commands that the ideal evaluates; None: the same

    Raises ValueError for a stage that the frame lacks, and what ``frame_colors`` raises.
    """
    for name in unclamped:
        if not name.startswith(("general combiner", "final combiner")):
            raise ValueError(f"{name} has no clamp of its own; general combiners and the final one have.")
    given, seen = (frame_of(commands), profile, width, height), _Stages(number)
    Machine(*given[1:], engine="columns", observer=seen).run(given[0])
    there = seen.names()
    for name in (*exact, *unclamped):
        if name not in there:
            raise ValueError(f"No Draw of it has a stage {name!r}; there are: {', '.join(there)}.")
    seen = _Stages(number, ReplacedStages(frozenset(exact), frozenset(unclamped)))
    return frame_colors(*given, ideal=ideal, replaced_stages=seen.replaced, observer=seen)


def with_stages(commands: Any, profile: Profile, width: int, height: int, **given: Any) -> Error:
    """The Error of a frame whose named stages are exact, or do not clamp. As ``colors_with_stages``."""
    return _error_of(*colors_with_stages(commands, profile, width, height, **given))


def stage_attribution(
    commands: Any,
    profile: Profile,
    width: int,
    height: int,
    *,
    ideal: Any = None,
    number: int | None = None,
) -> tuple[Error, list[tuple[str, Error]]]:
    """How much of a frame's error goes if one stage of its passes is exact, or does not clamp.

    ideal   the commands that the ideal evaluates; None: the same
    number  the command, as they run, whose stages are examined; None: those of all Draws, each stage in all
            at once

    Returns the machine's own Error, and (the stage, the Error then) with the least error first, as
    ``attribution`` does. Rectangles of pixels, and units that a texture shader reads, stay the machine's.
    Raises what ``frame_error`` raises, and ValueError for a command without stages.
    """
    given = frame_of(commands), profile, width, height
    own, seen = _stages_error(given, ideal, number, None)
    names = seen.names()
    changes = [(name, ReplacedStages(exact=frozenset({name}))) for name in names]
    changes += [
        (f"clamp of {name}", ReplacedStages(unclamped=frozenset({name})))
        for name in names
        if name.startswith(("general combiner", "final combiner"))
    ]
    changes.append(("all of these stages", ReplacedStages(exact=frozenset(names))))
    found = [(what, _stages_error(given, ideal, number, changed)[0]) for what, changed in changes]
    return own, sorted(found, key=lambda one: one[1].shown)
