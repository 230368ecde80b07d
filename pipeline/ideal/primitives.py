"""The primitives that the ideal evaluates: those that a machine drew, with real colours and coordinates."""

from functools import lru_cache

from fixedpipe.pipeline.profiles import IDEAL
from fixedpipe.pipeline.profiles.sections import SECTION_OF
from fixedpipe.pipeline.vertices.stage import process, unrounded


def primitives_of(command, machine, width, height, record=None):
    """WindowPrimitives of a Draw with real colours and coordinates, at the places of the Profile ``machine``.

    The machine decides the guard band's edge, the origin of its rows, how lines are drawn, and the largest
    point. The subpixel grid is the ideal's own, because its kernels have it built in.

    ``record`` is the machine's Fragments of a Draw, or None. If it is of this Draw, its primitives are taken
    and only their colours are computed anew.
    """
    profile, made = _ideal_with(*_placed(machine)), None
    if record is not None and record.command is command and _has_own_grid(machine):
        made = unrounded(record.primitives, command.mesh, command.state, profile)
    return process(command.mesh, command.state, profile, width, height) if made is None else made


def _has_own_grid(machine):
    return machine.arithmetic.subpixel_bits == IDEAL.arithmetic.subpixel_bits


_PLACE = "guard_band", "device_origin", "diamond_exit_lines", "max_point_size"


def _placed(machine):
    """The properties of a machine that decide where its vertices lie (``_PLACE``)."""
    return tuple(getattr(getattr(machine, SECTION_OF[name]), name) for name in _PLACE)


@lru_cache(maxsize=64)
def _ideal_with(*values):
    """The ideal with a machine's ``_PLACE``.

    Equal values give the same object, and values equal to the ideal's give the ideal itself, because vertex
    plans are cached by the profile's identity.
    """
    if values == _placed(IDEAL):
        return IDEAL
    evidence = "Inferred: the machine's that the ideal is compared with"
    return IDEAL.changed(evidence=evidence, **dict(zip(_PLACE, values, strict=True)))


def check_primitives(command, record, primitives, machine):
    """Raise ValueError if a guide's ``record`` of a Draw has other primitives than ``primitives``."""
    if record.command is command:
        return
    drawn = record.triangle.max(initial=-1, where=record.passed != 0)
    if drawn >= len(primitives.triangles):
        raise ValueError(
            f"{command.label}: the guide drew primitive {drawn}, but this mesh gives "
            f"{len(primitives.triangles)} of them; guide a frame by the same meshes in the same views."
        )
    if record.places is None:  # the Draw had no primitive left to draw
        return
    compared = slice(2 if _has_own_grid(machine) else 1)
    if record.places[compared] != primitives.places()[compared]:
        raise ValueError(
            f"{command.label}: the guide's primitives are at other places than this mesh's; guide a frame by "
            "the same meshes in the same views."
        )
