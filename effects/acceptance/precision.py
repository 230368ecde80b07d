"""Was it the clamp or the bits? A figure on the same machine with other widths, and with its clamps off.

Each picture is compared with the ideal evaluation of the same fragments, so that only arithmetic differs.
"""

from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from fixedpipe.pipeline.enums import Clamp
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal

WIDTHS = (4, 5, 6, 7, 8, 9, 10, 12, 14, 16)
# What a width is of: arguments of ``Profile.with_precision``.
PARTS = ("combiner_bits", "texture_bits", "framebuffer_bits", "filter_fraction_bits")
# Clamps that only machines have. The others the ideal evaluation has too: the lower clamp of the mappings,
# which passes rely on, and the fragment's at the end (docs/decisions, page 0001).
MACHINE_CLAMPS = frozenset(Clamp) - {Clamp.MAPPING, Clamp.FINAL_COMBINER}


@dataclass(frozen=True)
class Measured:
    """Root mean squares of (machine - ideal) over red, green and blue, 1.0 = full intensity.

    shown      of the pictures as they are seen: the ideal's colours clamped to [0, 1] as well
    computed   of the colours that were computed: the ideal's are not clamped, so a clamp's part shows
    """

    shown: float
    computed: float


def measure(figure, profile, size, method=None, changes=MappingProxyType({})):
    """A figure on a machine beside the ideal evaluation of its fragments: a Measured.

    ``method``: one of the figure's; None: the machine's. ``changes``: other values of its parameters, by
    name.

    Raises ValueError where the machine cannot hold the figure.
    """
    commands = figure.commands(profile, size, method, **changes)
    width, height = figure.dimensions(size)
    result = execute(commands, profile, width, height, record=True)
    ideal = execute_ideal(commands, width, height, guide=result).color[..., :3]
    color = result.framebuffer.color[..., :3] / (2.0**result.framebuffer.color_bits - 1.0)

    def root_mean_square(difference):
        return float(np.sqrt(np.mean(difference * difference)))

    seen = np.clip(color, 0.0, 1.0) - np.clip(ideal, 0.0, 1.0)
    return Measured(root_mean_square(seen), root_mean_square(color - ideal))


def at_width(profile, bits, parts=PARTS):
    """The machine with ``parts``, arguments of ``with_precision``, of ``bits`` bits."""
    return profile.with_precision(**dict.fromkeys(parts, bits))


def table(figure, profile, size, widths=WIDTHS, parts=PARTS, method=None, changes=MappingProxyType({})):
    """(bits, Measured with every clamp, Measured without those that only machines have) for each width."""
    rows = []
    for bits in widths:
        machine = at_width(profile, bits, parts)
        free = machine.without_clamps(*MACHINE_CLAMPS)
        rows.append((bits, *(measure(figure, m, size, method, changes) for m in (machine, free))))
    return rows


def clamps(figure, profile, size, method=None, changes=MappingProxyType({})):
    """(Clamp, Measured) of the machine at its own widths without each of its clamps, one at a time."""
    return [
        (c, measure(figure, profile.without_clamps(c), size, method, changes))
        for c in Clamp
        if c in profile.arithmetic.clamps
    ]
