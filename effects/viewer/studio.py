"""Draws a View: the machine's picture, the ideal's, the reference, and the data that a page shows with them.

This module does not depend on a network or a page. Every picture has its machine's codes, unchanged.
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

_KEPT = 6  # frames whose commands are stored: two machines and the ideal, before and after a gesture
# The most commands in stored frames, without the newest two. F004-4 on the OCTANE has 145,427, of 3 kB each.
_MOST_COMMANDS = 1 << 15


class Superseded(Exception):  # noqa: N818 (it says what happened)
    """A newer request has arrived, and the result of this one is not needed any more."""


def _never() -> bool:
    return False


@dataclass(frozen=True, eq=False)
class Picture:
    """A picture as codes.

    codes  [h, w, 4], top row first: uint8, or uint16 for more than 8 bits. Alpha is 255, or 0 at pixels
           without a value
    bits   bits of a component: full intensity is 2**bits - 1
    sha256 digest of the codes' RGB, uint8 or uint16 [h, w, 3], the same as in ``fixedpipe golden``
    facts  other data about it: for example the last command, and the milliseconds that its steps took
    """

    codes: NDArray[np.uint8 | np.uint16]
    bits: int
    facts: dict[str, Any] = field(default_factory=dict)

    @property
    def sha256(self) -> str:
        """The digest of the codes' RGB. Each read computes it."""
        return digest(self.codes[..., :3])


def picture_of(codes: NDArray[Any], bits: int, facts: dict[str, Any], alpha: Any = 255) -> Picture:
    """The Picture of codes [h, w, 3 or 4]. ``alpha``: 255, or an array [h, w]: 0 at pixels without value."""
    out = np.empty((*codes.shape[:2], 4), np.uint8 if bits <= 8 else np.uint16)
    out[..., :3] = codes[..., :3]
    out[..., 3] = alpha
    return Picture(out, bits, facts)


def _codes_of(framebuffer: Framebuffer) -> tuple[NDArray[Any], int]:
    """(the colours of a framebuffer as codes, top row first; the bits of a component)."""
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
        """The Subject of a View. Raises Refusal if there is no such subject, or if it has too many pixels."""
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
        """The commands of a View, up to its last. ``exact``: whether they are the ideal's. Raises Refusal."""
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
        """How many commands are stored, without those of the newest two frames."""
        return sum([len(made) for made in list(self._made.values())[:-2]])

    def machine(self, view: View, stop: Callable[[], bool] = _never) -> Picture:
        """The machine's picture: the window, or with ``upto`` the buffer that the last command drew into.

        stop  called after every command; if it returns True, Superseded is raised

        Raises Refusal if the machine cannot draw the frame.
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

        The ideal's picture is rounded to the machine's codes; the numbers use it without rounding. Raises
        Refusal if the ideal cannot follow the machine's fragments.
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
        """The reference that the frame approximates: (picture in the machine's codes, float64 [h, w, 4]).
        None if there is no reference, or only a part of the frame is drawn. Raises Refusal.
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
        """The history of a pixel of the window, as ``fixedpipe inspect`` has it: {"json", "html"}. Raises
        Refusal for a pixel outside the window.
        """
        frame, ideal = self._record(view)
        with refusals():
            found = history(frame, at, None, ideal)
        return {"json": to_json(found), "html": history_html(found)}

    def _record(self, view: View):
        """(RecordedFrame, RecordedIdeal or None). The last result is stored, because users look at several
        pixels.
        """
        if self._recorded is not None and self._recorded[0] == view:
            return self._recorded[1]
        commands, size = self.commands(view), self.dimensions(view)
        with refusals():
            frame = record(commands, view.profile(), *size)
            try:
                ideal = record_ideal(self.commands(view, exact=True), frame, commands)
            except ValueError:  # only machines can draw this frame
                ideal = None
        self._recorded = (view, (frame, ideal))
        return frame, ideal

    def registers(self, view: View) -> list[dict[str, Any]]:
        """The values of every register after every stage, as ``fixedpipe inspect --registers`` has them."""
        with refusals():
            uses = register_uses(self.commands(view), view.profile(), *self.dimensions(view))
        return json.loads(json.dumps(register_rows(uses)))

    def about(self, view: View) -> dict[str, Any]:
        """The data that a page shows with a picture of a subject on a machine. Raises Refusal."""
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
    """The bits of the parts that a machine has, by the names that ``what_if.with_bits`` takes."""
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
    """Numbers of a Difference: root mean square and largest, in units of full intensity; and which pixels
    differ.

    ``exact``: RGB, or RGBA; pixels with alpha 0 are not compared.
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
    """A Watch that raises Superseded after a command, if ``stop`` returns True then."""

    def watch(command: Command, take: Any) -> None:
        if stop():
            raise Superseded

    return watch


def changed(view: View, **values: str) -> View:
    """A View with other values of parameters. ``values``: the new values as texts."""
    return replace(view, values=tuple(sorted({**dict(view.values), **values}.items())))
