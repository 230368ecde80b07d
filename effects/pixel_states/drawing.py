"""A machine draws a small state: the requested pixel, and its history."""

from dataclasses import dataclass
from typing import Any

from fixedpipe.effects.pixel_states.states import FORMAT, PixelState
from fixedpipe.effects.refusal import refusals
from fixedpipe.pipeline.inspection.history import PixelHistory, to_json
from fixedpipe.pipeline.inspection.ideal import record_ideal
from fixedpipe.pipeline.inspection.inspect import history
from fixedpipe.pipeline.inspection.recording import record
from fixedpipe.pipeline.profiles import IDEAL
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.validation.validate import validate
from fixedpipe.pipeline.validation.walk import UnsupportedState


@dataclass(frozen=True, eq=False)
class ExpectedPixel:
    """The pixel of a small state on a machine: its colour, depth and stencil value, and how they came about.

    ``history.final`` has the codes of the framebuffer: RGBA, depth units, stencil.
    """

    history: PixelHistory

    def sentence(self) -> str:
        """The pixel in one line."""
        final = self.history.final
        color = " ".join(map(str, final.color))
        return f"color {color}, depth {final.depth}, stencil {final.stencil}"

    def as_json(self, profile: Profile) -> dict[str, Any]:
        """The pixel as JSON's values: ``color``, ``depth``, ``stencil``, ``ideal``, and its ``history`` as
        docs/pixel-history.schema.json has it.
        """
        final = to_json(self.history.final)
        return {
            "format": FORMAT,
            "machine": profile.name,
            "pixel": [self.history.x, self.history.y],
            "color": final["color"],
            "depth": final["depth"],
            "stencil": final["stencil"],
            "ideal": [self.history.one * component for component in self.history.ideal],
            "history": to_json(self.history),
        }


def expected_pixel(state: PixelState, profile: Profile) -> ExpectedPixel:
    """Draw a small state on a machine, and the ideal beside it. Raises Refusal if the machine lacks
    something.
    """
    with refusals():
        commands = state.commands(profile)
        frame = record(commands, profile, state.width, state.height, **state.window)
        ideal = state.commands(IDEAL)
        try:
            validate(ideal, IDEAL, state.width, state.height)
        except UnsupportedState:  # what only machines draw
            beside = None
        else:
            beside = record_ideal(ideal, frame, commands)
        return ExpectedPixel(history(frame, state.pixel, None, beside))
