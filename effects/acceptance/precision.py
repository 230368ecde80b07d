"""Was it the clamp or the bits? A figure on the same machine with other widths, and with its clamps off.

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
    """A figure on a machine beside the ideal evaluation of its fragments: an Error.

    ``method``: one of the figure's; None: the machine's. ``changes``: other values of its parameters, by
    name.

    Raises ValueError where the machine cannot hold the figure.
    """
    return frame_error(figure.commands(profile, size, method, **changes), profile, *figure.dimensions(size))


def at_width(profile, bits, parts=PARTS):
    """The machine with ``parts``, arguments of ``with_precision``, of ``bits`` bits."""
    return profile.with_precision(**dict.fromkeys(parts, bits))


def table(figure, profile, size, widths=WIDTHS, parts=PARTS, method=None, changes=MappingProxyType({})):
    """(bits, Error with every clamp, Error without those that only machines have) for each width."""
    rows = []
    for bits in widths:
        machine = at_width(profile, bits, parts)
        free = machine.without_clamps(*MACHINE_CLAMPS)
        rows.append((bits, *(measure(figure, m, size, method, changes) for m in (machine, free))))
    return rows


def clamps(figure, profile, size, method=None, changes=MappingProxyType({})):
    """(Clamp, Error) of the machine at its own widths without each of its clamps, one at a time."""
    return [
        (c, measure(figure, profile.without_clamps(c), size, method, changes))
        for c in Clamp
        if c in profile.arithmetic.clamps
    ]
