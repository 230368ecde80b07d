"""What the ideal's observer received for a fragment, by the machine's names for the same numbers."""

from typing import Any

import numpy as np

from fixedpipe.pipeline.enums import Register
from fixedpipe.raster import codes as C

# Places in the results of a stage of the ideal's combiners: A, B, C, D, AB, CD and their sum, for each
# portion.
_NAMES = ("A", "B", "C", "D", "AB", "CD")
_PORTION = 7


def ideal_numbers(told: list[tuple[str, dict[str, Any]]]) -> dict[Any, tuple[Any, ...]]:
    """The ideal's numbers by key.

    Most keys are names. ("register", Register) is a register before the combiners. ("levels", unit) are the
    real texels of a unit's texture. A general combiner's keys are (number, whether alpha, name of a variable
    or Register of an output).
    """
    found, general = {}, 0
    for stage, columns in told:
        if stage == "fragment":
            found.update(_fragment(**columns))
        elif stage == "registers":
            found.update({("register", r): _numbers(c) for r, c in columns["registers"].items()})
        elif stage == "textures":
            found.update({("levels", unit): levels for unit, levels in columns["levels"].items()})
        elif stage == "combined":
            found.update(_combined(general, columns["file"], columns["computed"]))
            general += 1
        elif stage == "final combiner":
            found["color"] = _numbers(columns["color"])
        elif stage == "source":
            found["source"], found["stored"] = _numbers(columns["color"]), _numbers(columns["stored"])
            found.setdefault("color", found["source"])
        elif stage == "written":
            found["written"] = found["blended"] = _numbers(columns["color"])
    return found


def _numbers(column):
    return tuple(np.ravel(column).tolist())


def _fragment(weights, colors, fog, own):
    found = {"weights": _numbers(weights), "primary color": _numbers(colors[0])}
    if colors[1] is not None:
        found["secondary color"] = _numbers(colors[1])
    for unit, strq in own.items():
        found[f"texture coordinates {unit}"] = _numbers(strq)
    return found


def _combined(general, file, computed):
    """A general combiner's variables, products and registers."""
    found = {}
    for alpha, part in ((False, slice(3)), (True, slice(3, 4))):
        for place, name in enumerate(_NAMES):
            found[general, alpha, name] = _numbers(computed[alpha * _PORTION + place, part, 0])
        for register in range(C.REGISTER_DISCARD):
            found[general, alpha, Register(register)] = _numbers(file[register, part, 0])
    return found
