"""What is drawn of a View: the machine's picture, the ideal's, the reference, and what stands beside them.

Nothing here knows a network or a page. Every picture is codes of its machine, unchanged.
"""

import json
import time
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.figures.rendering import Difference, delta_of
from fixedpipe.effects.refusal import Refusal, refusals
from fixedpipe.effects.reports.rows import register_rows
from fixedpipe.effects.viewer.subjects import Commands, Subject, Subjects, check_size
from fixedpipe.effects.viewer.views import View
from fixedpipe.pipeline.commands import Command
from fixedpipe.pipeline.description.describe import describe
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.framebuffers.framebuffer import Framebuffer
from fixedpipe.pipeline.framebuffers.pictures import to_codes
from fixedpipe.pipeline.framebuffers.result import Result
from fixedpipe.pipeline.golden.digests import digest
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.inspection.history import to_json
from fixedpipe.pipeline.inspection.ideal import record_ideal
from fixedpipe.pipeline.inspection.inspect import history
from fixedpipe.pipeline.inspection.page import history_html
from fixedpipe.pipeline.inspection.recording import record
from fixedpipe.pipeline.inspection.registers import register_uses
from fixedpipe.pipeline.profiles import IDEAL
from fixedpipe.pipeline.profiles.profile import Profile

_KEPT = 6  # frames' commands: of two machines and the ideal, before and after a gesture
# Commands of frames that are kept beside the newest two. F004-4 on the OCTANE has 145,427, of 3 kB each.
_MOST_COMMANDS = 1 << 15


class Superseded(Exception):  # noqa: N818 (it says what happened)
    """Something newer is asked for; what was being drawn is not wanted any more."""


def _never() -> bool:
    return False


@dataclass(frozen=True, eq=False)
class Picture:
    """A picture as codes.

    codes  uint8, or uint16 of more than 8 bits, [h, w, 4], top row first; alpha 255, or 0 where there is none
    bits   of a component: full is 2**bits - 1
    sha256 digest of the codes' RGB, uint8 or uint16 [h, w, 3], as ``fixedpipe golden`` has it
    facts  what else is known: the command that was drawn last, seconds of processor time
    """

    codes: NDArray[np.uint8 | np.uint16]
    bits: int
    facts: dict[str, Any] = field(default_factory=dict)

    @property
    def sha256(self) -> str:
        """Computed when it is asked for."""
        return digest(self.codes[..., :3])


def picture_of(codes: NDArray[Any], bits: int, facts: dict[str, Any], alpha: Any = 255) -> Picture:
    """The Picture of codes [h, w, 3 or 4]. ``alpha``: 255, or an array [h, w] of what there is."""
    out = np.empty((*codes.shape[:2], 4), np.uint8 if bits <= 8 else np.uint16)
    out[..., :3] = codes[..., :3]
    out[..., 3] = alpha
    return Picture(out, bits, facts)


def _codes_of(framebuffer: Framebuffer) -> tuple[NDArray[Any], int]:
    """The colours of a framebuffer as they are, top row first, and their bits."""
    bits = framebuffer.color_bits
    if bits == 8:
        return framebuffer.image(), 8
    return np.clip(framebuffer.color, 0, 2**bits - 1), bits


class Studio:
    """Draws the Views of some Subjects. Several threads may use it."""

    def __init__(self, subjects: Subjects, threads: int | None = None):
        self.subjects, self.threads = subjects, threads
        self._made: OrderedDict[tuple[View, bool], Commands] = OrderedDict()
        self._recorded: tuple[View, Any] | None = None

    def subject(self, view: View) -> Subject:
        """Raises Refusal for a view of nothing, or of more pixels than there may be."""
        found = self.subjects[view.id]
        check_size(*self._dimensions(found, view), view.profile())
        return found

    def _dimensions(self, subject: Subject, view: View) -> tuple[int, int]:
        with refusals():
            return subject.dimensions(view)

    def dimensions(self, view: View) -> tuple[int, int]:
        """Width and height of the frame."""
        return self._dimensions(self.subject(view), view)

    def commands(self, view: View, exact: bool = False) -> Commands:
        """The commands of a View, up to its last; ``exact``: the ideal's. Raises Refusal."""
        key = (view.whole(), exact)
        made = self._made.get(key)
        if made is None:
            subject = self.subject(view)
            with refusals():
                made = tuple(subject.commands(view.whole(), IDEAL if exact else view.profile()))
            self._made[key] = made
            while len(self._made) > _KEPT or (len(self._made) > 2 and self._held() > _MOST_COMMANDS):
                self._made.popitem(last=False)
        if view.upto is None:
            return made
        if view.upto >= len(made):
            raise Refusal(f"There is no command {view.upto}; the last is {len(made) - 1}.")
        return made[: view.upto + 1]

    def _held(self) -> int:
        """The number of commands that are kept beside the newest two frames'."""
        return sum([len(made) for made in list(self._made.values())[:-2]])

    def machine(self, view: View, stop: Callable[[], bool] = _never) -> Picture:
        """What the machine drew: the window, or with ``upto`` the buffer that the last command drew to.

        stop  asked after every command: whether to give up, with Superseded

        Raises Refusal for what the machine cannot hold.
        """
        begin = time.perf_counter()
        commands = self.commands(view)
        made = time.perf_counter()
        with refusals():
            machine = Machine(view.profile(), *self.dimensions(view), threads=self.threads)
            result = machine.run(commands, trace=_watching(stop))
        shown = machine.drawn() if view.upto is not None else result.framebuffer
        drawn = time.perf_counter()
        facts = {
            "commands": self._count(view),
            "pbuffer": next((name for name, made in result.surfaces.items() if made is shown), ""),
            "milliseconds": {"commands": 1e3 * (made - begin), "machine": 1e3 * (drawn - made)},
        }
        if view.upto is not None:
            facts["command"] = self.said(view.upto, commands[-1])
        return picture_of(*_codes_of(shown), facts)

    def _count(self, view: View) -> int:
        return len(self.commands(view.whole()))

    def said(self, number: int, command: Command) -> dict[str, Any]:
        """A command in words, as ``fixedpipe passes`` prints it."""
        first, *lines = describe((command,)).splitlines()
        title = f"{number}.{first.partition('.')[2]}"
        return {
            "number": number,
            "label": command.label,
            "kind": type(command).__name__,
            "words": [title, *lines],
        }

    def guided(
        self, view: View, stop: Callable[[], bool] = _never
    ) -> tuple[Picture, Picture, dict[str, Any]]:
        """(the machine's picture, the ideal's of the same fragments, numbers of their difference).

        The ideal is rounded to the machine's codes; the numbers are of it without rounding. Raises Refusal
        for what the ideal cannot be guided through.
        """
        size, profile = self.dimensions(view), view.profile()
        commands, ideal_commands = self.commands(view), self.commands(view, exact=True)
        if [type(command) for command in commands] != [type(command) for command in ideal_commands]:
            raise Refusal("The ideal draws this frame by other commands, so it has no picture of this step.")
        with refusals():
            machine = Machine(profile, *size, threads=self.threads)
            result = machine.run(commands, trace=_watching(stop), record=True)
        if view.upto is not None and machine.drawn() is not result.framebuffer:
            raise Refusal("This command draws to a pbuffer, of which the ideal keeps no picture.")
        exact = self._ideal(ideal_commands, size, result, stop)
        drawn = picture_of(*_codes_of(result.framebuffer), {"sha256": digest(result.image())})
        ideal = picture_of(to_codes(exact, drawn.bits), drawn.bits, {})
        return drawn, ideal, numbers_of(drawn, exact, "ideal")

    def _ideal(self, commands: Commands, size: tuple[int, int], guide: Result, stop: Callable[[], bool]):
        with refusals():
            found = execute_ideal(commands, *size, guide=guide, threads=self.threads, trace=_watching(stop))
        return found.color[..., :3]

    def reference(self, view: View) -> tuple[Picture, NDArray[np.float64]] | None:
        """(picture in the machine's codes, float64 [h, w, 4]) of what the frame approximates; None where
        there is nothing, or only a part of the frame is drawn. Raises Refusal.
        """
        if view.upto is not None:
            return None
        with refusals():
            found = self.subject(view).reference(view)
        if found is None:
            return None
        bits = view.profile().framebuffers.color_bits[0]
        alpha = np.where(found[..., 3] > 0.0, 255, 0)
        return picture_of(to_codes(found[..., :3], bits), bits, {}, alpha), found

    def history(self, view: View, at: tuple[int, int]) -> dict[str, Any]:
        """Everything that happened to a pixel of the window: {"json", "html"}, as ``fixedpipe inspect`` has
        it. Raises Refusal for a pixel outside.
        """
        frame, ideal = self._record(view)
        with refusals():
            found = history(frame, at, None, ideal)
        return {"json": to_json(found), "html": history_html(found)}

    def _record(self, view: View):
        """(RecordedFrame, RecordedIdeal or None); the last is kept, as one asks for pixel after pixel."""
        if self._recorded is not None and self._recorded[0] == view:
            return self._recorded[1]
        commands, size = self.commands(view), self.dimensions(view)
        with refusals():
            frame = record(commands, view.profile(), *size)
            try:
                ideal = record_ideal(self.commands(view, exact=True), frame, commands)
            except ValueError:  # what only machines draw
                ideal = None
        self._recorded = (view, (frame, ideal))
        return frame, ideal

    def registers(self, view: View) -> list[dict[str, Any]]:
        """Of every register after every stage what it held, as ``fixedpipe inspect --registers`` has it."""
        with refusals():
            uses = register_uses(self.commands(view), view.profile(), *self.dimensions(view))
        return json.loads(json.dumps(register_rows(uses)))

    def about(self, view: View) -> dict[str, Any]:
        """What a page shows beside a picture of a subject on a machine."""
        subject, profile = self.subject(view), view.profile()
        arithmetic = view.on(view.machine).profile().arithmetic
        with refusals():
            found = subject.about(view.machine)
        return found | {
            "id": subject.id,
            "title": subject.title,
            "machine": view.machine,
            "name": profile.name,
            "machines": list(subject.machines),
            "panels": list(subject.panels),
            "spoken": self._spoken(subject, view),
            "clamps": sorted(clamp.name for clamp in arithmetic.clamps),
            "widths": widths_of(view.on(view.machine).profile()),
        }

    def _spoken(self, subject: Subject, view: View) -> str:
        with refusals():
            return subject.spoken(view)


def widths_of(profile: Profile) -> dict[str, int]:
    """The bits of a machine's parts, by the names that ``what_if.with_bits`` takes; those that it has."""
    arithmetic = profile.arithmetic
    found = {
        "texture": arithmetic.texture_bits,
        "framebuffer": profile.framebuffers.color_bits[0],
        "filter_fraction": arithmetic.filter_fraction_bits,
    }
    if profile.combiners.max_general_combiners > 0:
        found["combiner"] = arithmetic.combiner_bits
    return found


def numbers_of(drawn: Picture, exact: NDArray[np.float64], of: str) -> dict[str, Any]:
    """Numbers of a Difference: root mean square and largest, in units of full intensity, and what differs.

    ``exact``: RGB, or RGBA whose alpha is 0 where nothing is compared.
    """
    where = exact[..., 3] > 0.0 if exact.shape[2] == 4 else None
    delta = delta_of(drawn.codes, exact, drawn.bits)
    error = drawn.codes[..., :3] / (2.0**drawn.bits - 1.0) - np.clip(exact[..., :3], 0.0, 1.0)
    if where is not None:
        delta[~where], error[~where] = 0, 0.0
    found = Difference(delta, error, drawn.bits, of, where)
    return {
        "rms": found.rms,
        "largest": found.largest,
        "pixels": found.pixels,
        "gain": found.gain,
        "at": found.at,
        "identical": found.identical,
    }


def _watching(stop: Callable[[], bool]):
    """A Watch that raises Superseded after the command during which something newer was asked for."""

    def watch(command: Command, take: Any) -> None:
        if stop():
            raise Superseded

    return watch


def changed(view: View, **values: str) -> View:
    """A View with other values of parameters, as texts."""
    return replace(view, values=tuple(sorted({**dict(view.values), **values}.items())))
