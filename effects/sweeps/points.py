"""The computations at one point of a sweep: pure functions at the top of a module, which tasks name."""

import math
from functools import cache
from pathlib import Path

from fixedpipe.effects.acceptance.precision import at_width
from fixedpipe.effects.figures import Renderer
from fixedpipe.effects.figures.rendering import Difference, delta_of
from fixedpipe.effects.refusal import refusals
from fixedpipe.effects.reports.figure_record import variant_name
from fixedpipe.effects.reports.own_figures import figure_of
from fixedpipe.effects.studies import STUDIES
from fixedpipe.effects.sweeps.scripts import script_of
from fixedpipe.effects.tasks.environment import file_digest
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.framebuffers.pictures import png
from fixedpipe.pipeline.golden.digests import digest
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import IDEAL, PROFILES

_FULL = 255.0  # errors are in 1/255 of full intensity


class OtherFile(RuntimeError):  # noqa: N818 (it names what is there)
    """A worker has another file under a name than the client."""


@cache  # a worker reads a file once
def _check_file(path, expected):
    if file_digest(path) != expected:
        raise OtherFile(f"{path} is another file here than where the sweep was begun; share one folder.")


def plain(row):
    """A row as JSON can hold it: numbers of arrays become Python's own, and those that are not finite become
    None.
    """
    found = {name: value.item() if hasattr(value, "item") else value for name, value in row.items()}
    return {
        name: None if isinstance(value, float) and not math.isfinite(value) else value
        for name, value in found.items()
    }


def _machine(machine, bits):
    profile = PROFILES[machine]
    return profile if bits is None else at_width(profile, bits)


def _errors(found, prefix=""):
    """The columns of a Difference."""
    return {
        f"{prefix}rms": _FULL * found.rms,
        f"{prefix}largest": _FULL * found.largest,
        f"{prefix}differing": found.pixels,
    }


def figure_point(figure, file, machine, size, bits, changes, *, checks=False, reference=False, picture=False):
    """A figure at a point: its size, digest and errors.

    figure     its id, or the file that holds it
    file       the file's ``file_digest``; None for an id
    machine    a key of PROFILES
    size       a panel's height in pixels; None: the figure's own
    bits       the width of every number; None: the machine's own
    changes    other values of parameters, by name, as --set takes them
    checks     whether its acceptance is measured
    reference  whether it is compared with its reference
    picture    whether the picture is made as well, a PNG file

    Returns (columns by name, Files). Raises Refusal for a point that cannot be drawn.
    """
    if file is not None:
        _check_file(figure, file)
    known, profile = figure_of(figure), _machine(machine, bits)
    with refusals():
        method = known.method(machine)
        values = {
            name: known.offer(name, method).parse(text, f"{known.id}'s {name}")
            for name, text in changes.items()
        }
        drawn = known.render(profile, size, method=method, **values)
        width, height = known.dimensions(size)
        row = {"width": width, "height": height, "sha256": digest(drawn.image())}
        if not profile.arithmetic.exact:
            row |= _errors(drawn.difference)
        if reference and drawn.reference is not None:
            row |= _errors(drawn.reference_difference, "reference_")
        if checks:
            row |= _checked(known.checks(Renderer(profile, method, execute, execute_ideal)))
        if not picture:
            return row, {}
        wide = "" if bits is None else f"-{bits}bits"
        name = f"{variant_name(known, values)}-{machine}{wide}.png"
        return row | {"picture": name}, {name: png(drawn.deep_image())}


def _checked(found):
    failed = [check.name for check in found if not check.passed]
    return {"checks": len(found), "failed_checks": len(failed), "failed_names": "; ".join(failed)}


def study_point(study, machine, bits, *, checks=False):
    """A study's table on a machine.

    study    its id
    machine  a key of PROFILES, or None where it is measured on no one machine
    bits     the width of every number; None: the machine's own
    checks   whether its expected numbers are compared, which apply to its own machine

    Returns columns by name, and under "rows" the table's. Raises Refusal if it cannot be measured.
    """
    known = STUDIES[study]
    with refusals():
        table = known.measure(None if machine is None else _machine(machine, bits))
        rows = [plain(row) for row in table.records()]
        return {"rows": rows} | (_checked(tuple(known.checks(table))) if checks else {})


def script_point(script, file, machine, bits, values, *, picture=False):
    """A script's frame at a point, as ``figure_point``.

    script  the path of the file, which ``scripts.script_of`` reads; file: its ``file_digest``
    values  by the names of what its function ``commands`` takes

    Returns (columns by name, Files), what its function ``measure`` returns among the columns. Raises Refusal.
    """
    _check_file(script, file)
    known, profile = script_of(script), _machine(machine, bits)
    with refusals():
        width, height = known.size
        result = execute(known.commands(profile, values), profile, width, height, record=True)
        ideal = execute_ideal(known.commands(IDEAL, values), width, height, guide=result)
        delta = delta_of(result.codes(), ideal.color, result.bits)
        exact = result.codes()[..., :3] / (2.0**result.bits - 1.0)
        found = Difference(delta, exact - ideal.color[..., :3].clip(0.0, 1.0), result.bits)
        row = {"width": width, "height": height, "sha256": digest(result.image())} | _errors(found)
    row |= plain(known.measured(result, ideal, values))
    if not picture:
        return row, {}
    of_values = "".join(f"+{name}={value}" for name, value in values.items()).replace("/", "_")
    wide = "" if bits is None else f"-{bits}bits"
    name = f"{Path(script).stem}{of_values[:120]}-{machine}{wide}.png"
    return row | {"picture": name}, {name: png(result.deep_image())}
