"""How far every stage's results are from the guided ideal's, over whole frames: a map for each stage."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.enums import Register
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.ideal.primitives import primitives_of
from fixedpipe.pipeline.ideal.shade import plan_for, shade
from fixedpipe.pipeline.ideal.weights import mesh_of, weigh
from fixedpipe.pipeline.inspection.ideal import RecordedIdeal, record_ideal
from fixedpipe.pipeline.inspection.recording import record
from fixedpipe.pipeline.profiles import IDEAL
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.textures.depths_as_colors import depths_as_colors
from fixedpipe.pipeline.validation.frames import frame_of
from fixedpipe.raster.columns import numbers


@dataclass
class _Chunk:
    """Fragments that are shaded together.

    where  the triangle and the pixel of each, int32 [k]
    one    the value of one in the stages' results
    made   by a stage's name: its registers, int64 [4, k], and which of their components it wrote
    """

    where: tuple[NDArray[np.int32], ...]
    one: float
    made: dict[str, tuple[NDArray[Any], list[tuple[int, slice]]]] = field(default_factory=dict)


class _Beside:
    """An observer of a machine's frame that also shades every Draw's fragments with the ideal.

    ``errors``: by the command's number, its label and the stage, in order, float64 [h, w].
    """

    def __init__(self, ideal: RecordedIdeal):
        self.ideal, self.errors = ideal, {}
        self.number, self.chunk, self.plans, self.draw = -1, None, {}, None

    def __call__(self, stage, /, **columns):
        tell = _TOLD.get(stage)
        if tell is not None:
            tell(self, **columns)

    def _command(self, command):
        self.number, self.label = self.number + 1, command.label
        self.chunk = self.draw = self.triangle = None
        if type(command) is Draw:
            frame, meant = self.ideal.frame, self.ideal.commands[self.number]
            primitives = primitives_of(meant, frame.profile, frame.width, frame.height)
            mesh = mesh_of(primitives, meant.state.line, frame.profile)
            state, textures = depths_as_colors(meant.state, self.ideal.textures[self.number], IDEAL)
            self.draw = state, textures, primitives, mesh

    def _iteration(self, triangle, **columns):
        self.triangle = triangle

    def _shaded(self, part, fragments, bits):
        self.chunk = None
        if self.draw is not None and self.triangle is not None:
            where = tuple(np.array(c, np.int32) for c in (self.triangle, fragments.x, fragments.y))
            self.chunk = _Chunk(where, float(numbers.one_of(bits)))

    def _texture(self, unit, register, **columns):
        if self.chunk is not None:
            whole = [(Register.TEXTURE0 + unit, slice(4))]
            self.chunk.made[f"texture unit {unit}"] = {Register.TEXTURE0 + unit: register}, whole

    def _stage(self, stage, **columns):
        self.stage = stage

    def _combined(self, number, registers):
        if self.chunk is None:
            return
        written = []
        for portion, components in ((self.stage.rgb, slice(3)), (self.stage.alpha, slice(3, 4))):
            outputs = portion.ab_output, portion.cd_output, portion.sum_output
            written += [(register, components) for register in outputs if register != Register.DISCARD]
        kept = {register: registers[register].copy() for register, _ in written}
        self.chunk.made[f"general combiner {number}"] = kept, written

    def _final(self, color, **columns):
        if self.chunk is None:
            return
        self.chunk.made["final combiner"] = {_COLOR: color}, [(_COLOR, slice(4))]
        exact = self._by_the_ideal()
        for name, (made, written) in self.chunk.made.items():
            if name not in exact or not written:
                continue
            worst = np.zeros(len(self.chunk.where[0]))
            for register, components in written:
                own, meant = made[register][components] / self.chunk.one, exact[name][register][components]
                worst = np.maximum(worst, 255.0 * np.abs(own - meant).max(axis=0))
            _, x, y = self.chunk.where
            self._map(name)[y, x] = worst

    def _by_the_ideal(self):
        """The chunk's registers by stage, as the ideal computes them: float64 [4, k]."""
        state, textures, primitives, mesh = self.draw
        exact, stages = {}, []

        def observe(stage, /, **columns):
            if stage == "registers":
                for unit in range(4):
                    register = Register(Register.TEXTURE0 + unit)
                    if register in columns["registers"]:
                        exact[f"texture unit {unit}"] = {register: columns["registers"][register].T}
            elif stage == "combined":
                exact[f"general combiner {len(stages)}"] = columns["file"].copy()
                stages.append(stage)
            elif stage == "final combiner":
                exact["final combiner"] = {_COLOR: columns["color"].T}

        with np.errstate(all="ignore"):
            weights = weigh(mesh, state.polygon.front_face, *self.chunk.where)
            shade(state, textures, primitives, plan_for(state, textures, self.plans), weights, observe)
        return exact

    def _map(self, name):
        size = self.ideal.frame.height, self.ideal.frame.width
        key = self.number, self.label, name
        if key not in self.errors:
            self.errors[key] = np.full(size, np.nan)
        return self.errors[key]


_COLOR = "color"
_TOLD = {
    "command": _Beside._command,
    "iteration": _Beside._iteration,
    "shaded": _Beside._shaded,
    "texture": _Beside._texture,
    "general combiner": _Beside._stage,
    "combined": _Beside._combined,
    "final combiner": _Beside._final,
}


def stage_errors(
    commands: Any, profile: Profile, width: int, height: int, *, ideal: Any = None, **machine: Any
) -> dict[tuple[int, str, str], NDArray[np.float64]]:
    """How far each stage's results are from the guided ideal's, by the command's number, its label and the
    stage.

    The commands count as they run. A map is float64 [h, w], top row first, in 1/255. It holds the last
    fragment's largest difference of a component, and NaN where there is no fragment. The ideal's registers
    hold any number, so a clamp is an error.

    ``ideal``: the commands that the ideal evaluates; None: the same. ``machine``: as ``execute`` takes it.
    Passes without combiners or environments, and rectangles of pixels, have no stages. Raises what
    ``execute`` raises, and ValueError if the ideal has no such frame.
    """
    commands = frame_of(commands)
    frame = record(commands, profile, width, height, **machine)
    recorded = record_ideal(commands if ideal is None else ideal, frame, commands)
    if recorded is None:
        raise ValueError(
            "A stage has no error in a frame with pbuffers or several samples, or where the ideal draws "
            "other commands than the machine; give samples=1, or the machine's own commands."
        )
    seen = _Beside(recorded)
    Machine(profile, width, height, engine="columns", observer=seen, **machine).run(commands)
    return seen.errors
