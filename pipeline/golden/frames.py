"""A frame drawn with a digest after every command, to find the first command where two versions differ."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from fixedpipe.pipeline.commands import Command
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.framebuffers.result import Result
from fixedpipe.pipeline.golden.provenance import provenance
from fixedpipe.pipeline.golden.store import Passed
from fixedpipe.pipeline.inspection.stage_digests import SHORT, stage_digests
from fixedpipe.pipeline.multi_draw import MultiDraw
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.validation.frames import frame_of

PLANES = ("colors", "depths", "stencil values")


def drawn_with_digests(
    commands: Iterable[Command | MultiDraw], profile: Profile, width: int, height: int, **machine: Any
) -> tuple[Result, tuple[Passed, ...]]:
    """Run ``commands`` as ``execute`` does; returns the Result and the digests after each command.

    The commands of a HostStep count where it issues them. Raises what ``execute`` raises.
    """
    on, passes = Machine(profile, width, height, **machine), []

    def watch(command, snapshot):
        framebuffer = on.drawn()
        planes = framebuffer.color.astype("<u2"), framebuffer.depth.astype("<u4"), framebuffer.stencil
        digests = [hashlib.sha256(np.ascontiguousarray(plane).tobytes()).hexdigest() for plane in planes]
        color, depth, stencil = (text[:SHORT] for text in digests)
        passes.append(Passed(command.label, type(command).__name__, (color, depth, stencil)))

    result = on.run(frame_of(commands), trace=watch)
    return result, tuple(passes)


def with_stages(
    passes: Sequence[Passed],
    commands: Iterable[Command | MultiDraw],
    profile: Profile,
    width: int,
    height: int,
    **machine: Any,
) -> tuple[Passed, ...]:
    """The same with a digest of each stage's results; the column engine draws the frame again for them."""
    machine.pop("engine", None)
    stages = stage_digests(commands, profile, width, height, **machine)
    return tuple(
        Passed(passed.label, passed.kind, passed.planes, tuple(stages.get(number, {}).items()))
        for number, passed in enumerate(passes)
    )


def made_by(profile: Profile) -> dict[str, str]:
    """What draws a frame: the profile, fixedpipe's version, and the digest of its kernels' sources."""
    known = provenance(profile)
    return {name: known[name] for name in ("profile", "fixedpipe", "kernels")}


def parted(expected: Sequence[Passed], actual: Sequence[Passed]) -> str:
    """Where two frames first differ, as a sentence without its end; empty where they do not.

    It names the first command after which planes differ, and the first of its stages with other results.
    """
    for number, (before, now) in enumerate(zip(expected, actual, strict=False)):
        if (before.label, before.kind) != (now.label, now.kind):
            return f"command {number} was {before.kind} {before.label!r} and is {now.kind} {now.label!r}"
        if before.planes != now.planes:
            names = [name for name, a, b in zip(PLANES, before.planes, now.planes, strict=True) if a != b]
            return (
                f"the first command that leaves something else is {number}, {now.kind} {now.label!r}: "
                f"{' and '.join(names)}{_stage(before, now)}"
            )
    if len(expected) != len(actual):
        return f"the frame had {len(expected)} commands and has {len(actual)}"
    return ""


def _stage(before, now):
    if not (before.stages and now.stages):
        return ""
    made = dict(before.stages)
    for stage, digest in now.stages:
        if stage not in made:
            return f", with a stage that was not there, {stage}"
        if made.pop(stage) != digest:
            return f"; the first stage with another result is {stage}"
    return (
        f", without {next(iter(made))}"
        if made
        else ", though every stage made the same: tests or writes differ"
    )
