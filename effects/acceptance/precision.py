"""Was it the clamp or the bits? A frame on the same machine with other widths, and with its clamps off.

Each picture is compared with the ideal evaluation of the same fragments, so that only arithmetic differs.
"""

from types import MappingProxyType

from fixedpipe.pipeline.enums import Clamp
from fixedpipe.pipeline.inspection.what_if import PARTS as _PARTS
from fixedpipe.pipeline.inspection.what_if import frame_error

WIDTHS = (4, 5, 6, 7, 8, 9, 10, 12, 14, 16)
# What a width is of: arguments of ``Profile.with_precision``.
PARTS = tuple(_PARTS.values())
# Clamps that only machines have. The others the ideal evaluation has too: the lower clamp of the mappings,
# which passes rely on, and the fragment's at the end (docs/decisions, page 0001).
MACHINE_CLAMPS = frozenset(Clamp) - {Clamp.MAPPING, Clamp.FINAL_COMBINER}


def measure(figure, profile, size, method=None, changes=MappingProxyType({})):
    """How a figure on a machine differs from the ideal evaluation of its fragments: an Error.

    ``method``: one of the figure's; None: the machine's. ``changes``: other values of its parameters, by
    name.

    Raises ValueError where the machine cannot hold the figure.
    """
    return frame_error(figure.commands(profile, size, method, **changes), profile, *figure.dimensions(size))


def at_width(profile, bits, parts=PARTS):
    """The machine with ``parts``, arguments of ``with_precision``, of ``bits`` bits."""
    return profile.with_precision(**dict.fromkeys(parts, bits))


def _quietly(text):
    """Of whoever does not tell what is being done."""


def table(commands_of, profile, width, height, widths=WIDTHS, parts=PARTS, step=_quietly):
    """(bits, Error with every clamp, Error without those that only machines have) for each width.

    ``commands_of``: a function of a machine that gives the frame's commands for it. ``step``: called with a
    line of text before each of the two. Raises ValueError where the machine cannot hold the frame.
    """
    rows = []
    for bits in widths:
        machine = at_width(profile, bits, parts)
        step(f"{bits} bits")
        clamped = frame_error(commands_of(machine), machine, width, height)
        step(f"{bits} bits, without its own clamps")
        free = machine.without_clamps(*MACHINE_CLAMPS)
        rows.append((bits, clamped, frame_error(commands_of(free), free, width, height)))
    return rows


def clamps(commands_of, profile, width, height, step=_quietly):
    """(None, the machine's own Error), then (Clamp, the Error without this clamp) for each of its clamps.

    Takes and raises what ``table`` does.
    """
    found = []
    for clamp in (None, *clamps_of(profile)):
        step("its own widths" if clamp is None else f"without {clamp.name}")
        machine = profile if clamp is None else profile.without_clamps(clamp)
        found.append((clamp, frame_error(commands_of(machine), machine, width, height)))
    return found


def clamps_of(profile):
    """The clamps of a machine: a list."""
    return [clamp for clamp in Clamp if clamp in profile.arithmetic.clamps]
