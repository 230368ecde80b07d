"""Digests of every stage's results in every command. They show which stage first differs between two
versions.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from typing import Any

import numpy as np

from fixedpipe.pipeline.commands import Command
from fixedpipe.pipeline.enums import Clamp
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.inspection.registers import RegisterWitness
from fixedpipe.pipeline.multi_draw import MultiDraw
from fixedpipe.pipeline.profiles.profile import Profile

SHORT = 8  # hexadecimal digits that are kept: they name a stage, and decide nothing


class _Digests(RegisterWitness):
    """An observer that digests each stage's results instead of counting them."""

    def __init__(self):
        super().__init__()
        self.found: dict[int, dict[str, Any]] = {}

    def __call__(self, stage, /, **columns):
        if stage == "shaded":
            fragments = columns["fragments"]
            self.add("coverage", "pixel", "xy", np.stack([fragments.x, fragments.y]), None)
            if fragments.depth is not None:
                self.add("coverage", "depth", "z", np.asarray(fragments.depth)[None], None)
        super().__call__(stage, **columns)

    def add(self, stage, register, components, codes, bounds, free=None):
        hashes = self.found.setdefault(self.number, {})
        made = hashes.setdefault(stage, {}).setdefault(register, hashlib.sha256())
        # Fragment by fragment, so that the digest does not depend on how many are shaded together.
        made.update(np.ascontiguousarray(codes.T, "<i8").tobytes())


def stage_digests(
    commands: Iterable[Command | MultiDraw], profile: Profile, width: int, height: int, **machine: Any
) -> dict[int, dict[str, str]]:
    """Run ``commands`` on the column engine: {number of the command: {stage: digest of its results}}.

    The stages are those of ``register_uses``, after the coverage: which fragments there are, and their
    depths. ``machine``: as ``execute`` takes it, without ``engine``. A machine whose combiners do not clamp
    gives none, because its registers have no range. Raises what ``execute`` raises.
    """
    if Clamp.GENERAL_COMBINER not in profile.arithmetic.clamps:
        return {}
    seen = _Digests()
    Machine(profile, width, height, engine="columns", observer=seen, **machine).run(commands)
    return {
        number: {stage: _short(registers) for stage, registers in stages.items()}
        for number, stages in seen.found.items()
    }


def _short(registers):
    whole = b"".join(made.digest() for _, made in sorted(registers.items()))
    return hashlib.sha256(whole).hexdigest()[:SHORT]
