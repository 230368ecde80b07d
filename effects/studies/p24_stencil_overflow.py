"""P24: shadow volumes that the stencil buffer cannot count.

Source: document 003, "Shadow volumes" (Z23, Z24; artefact P24 of the catalogue, erratum E003.7);
EXT_stencil_wrap, which names this as its use.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.views import Panel, orthographic_view
from fixedpipe.effects.shadows import shadow_volumes
from fixedpipe.effects.shadows.shadow_volumes import CLAMPED, WRAPPING
from fixedpipe.effects.studies.study import BLACK, BLUE, EXPECTED, GREEN, ORANGE, RED, Column, Study, Table
from fixedpipe.pipeline.commands import Clear, Draw
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.state import DepthTest, PassState

DATA = study_data(__file__, "P24")

# Numbers of volumes, one in the other.
_NUMBERS = (1, 64, 128, 255, 256, 257, 300, 384, 512, 640, 768)
_SHOWN = 300
_MOST = 255
_COLUMNS, _ROWS = 1024, 4
# How far the screen reaches before and behind the volumes, whose middle is at 0 and whose ends are at 1.
_REACH = 1.1


def nested(number):
    """``number`` volumes below plates, the light straight above. Volume i is |z| < (i - 1/2) / number."""
    plate = surfaces.box(4.0, 0.1, 2.0).moved(0.0, 1.0, 0.0)
    volume = shadow_volumes.shadow_volume(plate, (0.0, 1.0, 0.0, 0.0), 4.0)
    widths = (np.arange(number) + 0.5) / number
    return [replace(volume, positions=volume.positions * [1.0, 1.0, width, 1.0]) for width in widths.tolist()]


def _view():
    panel = Panel(0, 0, _COLUMNS, _ROWS)
    return orthographic_view(panel, half_height=_ROWS / _COLUMNS)


def depths():
    """The place of the slanted screen in each column of pixels: z, towards the eye, float64 [_COLUMNS]."""
    return _REACH * ((np.arange(_COLUMNS) + 0.5) / _COLUMNS * 2.0 - 1.0)


def true_counts(number):
    """In how many of the volumes each column of the screen is: int64 [_COLUMNS]."""
    widths = (np.arange(number) + 0.5) / number
    return (np.abs(depths())[:, None] < widths).sum(axis=1)


def counts(profile, number, algorithm, operations, swapped=False):
    """The stencil buffer's value in each column after ``algorithm``: int64 [_COLUMNS].

    ``algorithm``: z_pass_counts or z_fail_counts. ``swapped``: whether its two passes change their order.
    """
    view = _view()
    screen = surfaces.plane(1, 1, 1.0, 1.0)
    screen = replace(screen, positions=screen.positions + screen.positions[:, :1] * [0.0, 0.0, _REACH])
    state = PassState(vertex=view.vertex, depth_test=DepthTest())
    machine = Machine(profile, _COLUMNS, _ROWS)
    passes = algorithm(nested(number), view, operations)
    machine.run(
        (
            Clear(label="clear", color=(0.0, 0.0, 0.0, 0.0), depth=1.0, stencil=0),
            Draw(label="slanting screen", mesh=screen.mesh(), state=state),
            *(reversed(passes) if swapped else passes),
        )
    )
    return machine.framebuffer.stencil[_ROWS // 2].astype(np.int64)


# Each way to count: heading, algorithm, operations, whether the passes are swapped.
_WAYS = (
    ("z-pass INCR, DECR", shadow_volumes.z_pass_counts, CLAMPED, False),
    ("z-fail INCR, DECR", shadow_volumes.z_fail_counts, CLAMPED, False),
    ("z-pass DECR, INCR", shadow_volumes.z_pass_counts, CLAMPED, True),
    ("z-pass wrapping", shadow_volumes.z_pass_counts, WRAPPING, False),
    ("z-pass wrapping, DECR first", shadow_volumes.z_pass_counts, WRAPPING, True),
)


def lost(number):
    """The part of the shadow that clamped counts lose. There, entries into volumes beyond 255 were not
    counted, but all exits were.
    """
    return max(number - _MOST, 0) / (2.0 * number)


def wrapped(number):
    """The part of the shadow where the count is a multiple of 256."""
    return number // (_MOST + 1) / number


def measure(profile):
    """The table, with a row for each number of volumes."""
    has_wrap = shadow_volumes.counting_operations(profile) == WRAPPING
    z, inside = depths(), true_counts(_SHOWN)
    rows, curves = [], {"z": z, "volumes": inside, "entered": np.where(z < 0.0, _SHOWN, inside)}
    for number in _NUMBERS:
        truth, found = true_counts(number), []
        for name, algorithm, operations, swapped in _WAYS:
            if operations is WRAPPING and not has_wrap:
                found.append(None)
                continue
            stencil = counts(profile, number, algorithm, operations, swapped)
            wrong = (stencil == 0) != (truth == 0)
            # Of the shadow's pixels; with the wrong order, of those that are lit behind it.
            of = (truth == 0) & (depths() < 0.0) if name == "z-pass DECR, INCR" else truth > 0
            found.append(float(wrong[of].mean()))
            if number == _SHOWN:
                curves[name] = stencil
        rows.append((number, *found, lost(number), wrapped(number)))
    columns = (
        Column("volumes", form="d"),
        *(Column(name, form=".4f") for name, *_ in _WAYS),
        Column("(n - 255)/2n", form=".4f"),
        Column("[n/256]/n", form=".4f"),
    )
    return Table(columns, tuple(rows), curves)


def findings(table):
    """How much shadow is lost with each way to count."""
    rows = {row["volumes"]: row for row in table.records()}
    few, many, most = rows[_MOST], rows[_SHOWN], rows[_NUMBERS[-1]]
    out = (
        f"Clamped counts lose {few['z-pass INCR, DECR']:.4f} of the shadow of {few['volumes']} volumes. "
        f"Z-pass loses {many['z-pass INCR, DECR']:.3f} of that of {many['volumes']}, and "
        f"{most['z-pass INCR, DECR']:.3f} of that of {most['volumes']}. A volume that is entered beyond 255 "
        f"is not counted, but it is counted when it is left. Z-fail loses {many['z-fail INCR, DECR']:.3f} "
        f"and {most['z-fail INCR, DECR']:.3f}, in front of the volumes' middle instead of behind it.",
        f"With back faces first, {rows[1]['z-pass DECR, INCR']:.2f} of what is lit behind the shadow is "
        "dark, with one volume already. Nothing can be subtracted from zero.",
    )
    if many["z-pass wrapping"] is None:
        return out
    return (
        *out,
        f"Counts that wrap are wrong only at multiples of 256. That is {many['z-pass wrapping']:.4f} of the "
        f"shadow of {many['volumes']} volumes, and {most['z-pass wrapping']:.4f} of the shadow of "
        f"{most['volumes']} volumes. Back faces first do not change this "
        f"({many['z-pass wrapping, DECR first']:.4f}).",
    )


def checks(table):
    """No error up to 255 volumes, and beyond that the error that the arithmetic predicts."""
    rows = table.records()
    pixel = 3.0 * _REACH / _COLUMNS
    for heading in ("z-pass INCR, DECR", "z-fail INCR, DECR"):
        few = max(row[heading] for row in rows if row["volumes"] <= _MOST)
        yield DATA.check(
            "{heading}: part of the shadow lost, up to 255 volumes", few, Answer.MACHINE, heading=heading
        )
        off = max(abs(row[heading] - row["(n - 255)/2n"]) for row in rows)
        yield DATA.check(
            "{heading}: part lost - (n - 255)/2n, largest",
            off,
            Answer.MACHINE,
            at_most=pixel,
            heading=heading,
        )
    many = next(row for row in rows if row["volumes"] == _SHOWN)
    yield DATA.check(
        "z-pass INCR, DECR: part of the shadow of {shown} volumes lost",
        many["z-pass INCR, DECR"],
        Answer.MACHINE,
        shown=_SHOWN,
    )
    yield DATA.check(
        "z-pass DECR, INCR: part of what is lit behind the shadow that is dark, least",
        min(row["z-pass DECR, INCR"] for row in rows),
        Answer.MACHINE,
    )
    for heading in ("z-pass wrapping", "z-pass wrapping, DECR first"):
        off = max(abs(row[heading] - row["[n/256]/n"]) for row in rows)
        yield DATA.check(
            "{heading}: part lost - [n/256]/n, largest", off, Answer.MACHINE, at_most=pixel, heading=heading
        )
    entered, inside = table.curves["entered"], table.curves["volumes"]
    sums = {
        "z-pass INCR, DECR": np.maximum(np.minimum(entered, _MOST) - (entered - inside), 0),
        "z-pass DECR, INCR": np.minimum(entered, _MOST),
        "z-pass wrapping": inside % (_MOST + 1),
        "z-pass wrapping, DECR first": inside % (_MOST + 1),
    }
    for heading, expected in sums.items():
        off = np.abs(table.curves[heading] - expected).max()
        yield DATA.check(
            "{heading}: stencil of {shown} volumes - its sum, largest",
            off,
            Answer.MACHINE,
            heading=heading,
            shown=_SHOWN,
        )


def plot(axes, table):
    """The counts through the volumes, and the wrong share by number of volumes."""
    left, right = axes
    z, curves, n = table.curves["z"], table.curves, table.column("volumes")
    left.plot(-z, curves["volumes"], color=BLACK, linestyle=":", label="volumes that the point is in")
    styles = {
        "z-pass INCR, DECR": (BLUE, "-", "o"),
        "z-fail INCR, DECR": (ORANGE, "--", "s"),
        "z-pass wrapping": (GREEN, "-", "^"),
    }
    for name, (color, line, marker) in styles.items():
        if name in curves:
            left.plot(-z, curves[name], color=color, linestyle=line, label=f"stencil: {name}")
            right.plot(
                table.column("volumes"),
                table.column(name),
                color=color,
                linestyle=line,
                marker=marker,
                label=name,
            )
    left.set_xlabel(f"distance behind the middle of {_SHOWN} nested volumes")
    left.set_ylabel("count")
    left.set_ylim(-10, 420)
    left.legend(loc="upper left")
    right.plot(n, table.column("(n - 255)/2n"), label="(n - 255)/2n and [n/256]/n", **EXPECTED)
    right.plot(n, table.column("[n/256]/n"), **EXPECTED)
    right.axvline(_MOST, color=RED, linewidth=1.0, linestyle=":", label="255")
    right.set_xlabel("nested volumes n")
    right.set_ylabel("part of the shadow that is drawn lit")
    right.legend(loc="upper left")


STUDY = Study(
    **DATA.words,
    method=(
        f"1 to {_NUMBERS[-1]} nested volumes and a screen that slants through all of them; the stencil is "
        f"zero or not in {_COLUMNS} columns of pixels, beside how many volumes each is in."
    ),
    machines=("GEFORCE_256", "GEFORCE_3", "NV2A", "OPENGL_1_2", "OCTANE"),
    panels=2,
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
