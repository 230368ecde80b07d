"""The check that a picture shows all its parts."""

import re

import numpy as np

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.pipeline.commands import Draw

# The fewest pixels of a part that is seen, at the figure's own size.
# Inferred: a dot of radius 1 on a panel of 256 rows covers three; nothing that is drawn to be seen is less.
LEAST_PIXELS = 3
# A part with how many Draws have its label.
_PART = re.compile(r"(.*?)( × (\d+))?")  # noqa: RUF001


def parts_check(figure, renderer):
    """The Check that the displayed picture changes where any of ``figure.parts`` is left out.

    A part is a Draw's label: "tick", or "tick × 5" where five Draws have it. The measured number is that of
    the part whose absence changes the fewest pixels. Where a part has another number of Draws, it is 0.
    """  # noqa: RUF002
    commands = figure.commands(renderer.profile, figure.size, renderer.method)

    def picture(commands):
        return renderer.execute(commands, renderer.profile, *figure.dimensions(figure.size)).framebuffer.color

    whole, fewest = picture(commands), np.inf
    for part in figure.parts:
        label, _, times = _PART.fullmatch(part).groups()
        others = tuple([c for c in commands if not isinstance(c, Draw) or c.label != label])
        if len(commands) - len(others) != int(times or 1):
            fewest = 0
            break
        fewest = min(fewest, int(np.count_nonzero((picture(others) != whole).any(axis=-1))))
    return Check(
        f"pixels that the least of the picture's {len(figure.parts)} parts changes",
        fewest if figure.parts else 0,
        at_least=LEAST_PIXELS,
        on=Answer.MACHINE,
        reason="what the must-see names is seen: without it the picture is another",
    )
