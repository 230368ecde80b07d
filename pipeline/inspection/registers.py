"""Registers over a whole frame: after every stage, their values, what was clamped, and unused range.

This answers "where should I scale?". A register that never leaves a quarter of its range wastes two bits. One
that is clamped has none to spare.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fixedpipe.pipeline.commands import Command
from fixedpipe.pipeline.enums import Clamp
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.inspection.exact import unclamped
from fixedpipe.pipeline.multi_draw import MultiDraw
from fixedpipe.pipeline.notations.register_combiner_words import REGISTER_NAMES
from fixedpipe.pipeline.profiles.profile import Profile

_RGB, _ALPHA, _RGBA = "rgb", "a", "rgba"


@dataclass(frozen=True)
class RegisterUse:
    """A component of a register after a stage of a command, over all its fragments.

    command, label, stage, register  where the register was written, and its name: "spare0.r"
    fragments                        how many fragments
    least, greatest, mean            of its values, 1.0 is full intensity
    clamped_low, clamped_high        shares of the fragments whose value a clamp changed; 0.0 without a clamp
    codes, of                        how many different codes it held, and how many it can hold
    headroom                         whole bits by which the values could grow before a clamp; None: all are
                                     zero
    """

    command: int
    label: str
    stage: str
    register: str
    fragments: int
    least: float
    greatest: float
    mean: float
    clamped_low: float
    clamped_high: float
    codes: int
    of: int
    headroom: int | None


@dataclass
class _Seen:
    """A component's counts: how often each code occurred, and how often a clamp changed the value."""

    low: int
    high: int
    one: int
    counts: np.ndarray = field(init=False)
    below: int = 0
    above: int = 0

    def __post_init__(self):
        self.counts = np.zeros(self.high - self.low + 1, np.int64)

    def add(self, codes, free):
        """Count codes [k]. ``free``: their values before a clamp, or None."""
        self.counts += np.bincount(np.clip(codes, self.low, self.high) - self.low, minlength=len(self.counts))
        if free is not None:
            self.below += int((free < codes).sum())
            self.above += int((free > codes).sum())

    def use(self, *names):
        """The RegisterUse."""
        held, total = np.flatnonzero(self.counts), int(self.counts.sum())
        codes = held + self.low
        used = max(int(codes[-1]) / self.high, int(codes[0]) / self.low if self.low else 0.0)
        return RegisterUse(
            *names,
            total,
            int(codes[0]) / self.one,
            int(codes[-1]) / self.one,
            float((self.counts[held] * codes).sum() / total / self.one),
            self.below / total,
            self.above / total,
            len(codes),
            len(self.counts),
            math.floor(-math.log2(used)) if used else None,
        )


class RegisterWitness:
    """An observer of whole frames that counts register values. Each stage's registers go to ``add``."""

    def __init__(self):
        self.seen, self.number, self.label, self.general, self.one = {}, -1, "", 0, 1

    def __call__(self, stage, /, **columns):
        """Receive a stage's inputs and outputs."""
        tell = _TOLD.get(stage)
        if tell is not None:
            tell(self, **columns)

    def uses(self):
        """Every RegisterUse, in the order of the frame."""
        return tuple(seen.use(*names) for names, seen in self.seen.items())

    def add(self, stage, register, components, codes, bounds, free=None):
        """Count a stage's register. ``codes``: [components, k], fragment by fragment; ``free``: before its
        clamp.
        """
        low, high, one = bounds
        if not codes.shape[-1]:  # tests discarded every fragment
            return
        for c, name in enumerate(components):
            key = self.number, self.label, stage, f"{register}.{name}"
            if key not in self.seen:
                self.seen[key] = _Seen(low, high, one)
            self.seen[key].add(codes[c], None if free is None else free[c])

    def _command(self, command):
        self.number, self.label = self.number + 1, command.label

    def _shaded(self, part, fragments, bits):
        self.one = 2**bits - 1
        for name in ("primary", "secondary"):
            codes = getattr(fragments, name).T
            self.add("fragment", f"{name} color", _RGBA, codes, (0, self.one, self.one))

    def _texture(self, unit, texel, one, register):
        low = -self.one - 1 if register.min(initial=0) else 0
        self.add(f"texture unit {unit}", f"tex{unit}", _RGBA, register, (low, self.one, self.one))

    def _general(self, number, stage, registers):
        self.general = number

    def _portion(self, **columns):
        self.begun = columns

    def _outputs(self, alpha, values):
        stage, a = f"general combiner {self.general}", self.begun["arithmetic"]
        for register, codes in values:
            free = unclamped(register, **self.begun)
            components, name = _ALPHA if alpha else _RGB, REGISTER_NAMES[register]
            self.add(stage, name, components, codes, (a.low, a.high, a.one), free)

    def _final(self, color, arithmetic, **columns):
        self.add("final combiner", "color", _RGBA, color, (0, arithmetic.one, arithmetic.one))

    def _blending(self, colors, result):
        codes = np.clip(result, 0, self.one)
        self.add("blending", "blended", _RGBA, codes.T, (0, self.one, self.one), result.T)


_TOLD = {
    "command": RegisterWitness._command,
    "shaded": RegisterWitness._shaded,
    "texture": RegisterWitness._texture,
    "general combiner": RegisterWitness._general,
    "portion": RegisterWitness._portion,
    "outputs": RegisterWitness._outputs,
    "final combiner": RegisterWitness._final,
    "blending": RegisterWitness._blending,
}


def register_uses(
    commands: Iterable[Command | MultiDraw], profile: Profile, width: int, height: int, **machine: Any
) -> tuple[RegisterUse, ...]:
    """Run ``commands`` on the column engine, and report every register's values after every stage.

    ``machine``: as ``execute`` takes it, without ``engine``. Raises what ``execute`` raises, and ValueError
    for a machine whose combiners do not clamp: its registers have no range.
    """
    if Clamp.GENERAL_COMBINER not in profile.arithmetic.clamps:
        raise ValueError(
            f"{profile.name}'s general combiners do not clamp, so their registers have no range; give a "
            "machine with that clamp."
        )
    seen = RegisterWitness()
    Machine(profile, width, height, engine="columns", observer=seen, **machine).run(commands)
    return seen.uses()
