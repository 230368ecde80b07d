"""P33: the errors of footprint assembly, from its direction and its power of two of probes, as a footprint
turns.

A footprint turns under a pixel's square. In units of its short side, its sides are a and one. Its true long
axis is known, so the study compares the direction of probes with it. The effect of probes on a wave is also
known. A probe is a square of its edge, and N of them lie along d. A wave's contrast is the product of both
transforms. A wave across the short side should stay. A wave along the long side, of the footprint's length,
should vanish.

Source: Schilling 1997, section 2 (artefact P33 of the catalogue).
"""

import math

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.studies.study import BLUE, GREEN, ORANGE, Column, Study, Table
from fixedpipe.effects.texture_filtering.footprint_assembly import isotropic, probes

DATA = study_data(__file__, "P33")

SIDES = (2.0, 4.0, 8.0, 16.0)
STEPS = 361
MOST = 16
# Texels of the short side: levels below one texel are not what is studied.
SHORT = 4.0
# Periods of the wave that should stay, and of the one that should go.
STAYS, GOES = 4.0, 1.0
WAYS = ("exact", "power of two", "by edges", "mip-mapping")


def footprints(side):
    """Edges r_1 and r_2 of a footprint that turns from 0 to 90 degrees, with its long axis along u: float64
    [STEPS, 2] each; and the angles in degrees.
    """
    angles = np.linspace(0.0, 90.0, STEPS)
    c, s = np.cos(np.radians(angles)), np.sin(np.radians(angles))
    return SHORT * np.stack([side * c, s], axis=-1), SHORT * np.stack([-side * s, c], axis=-1), angles


def contrast(found, wave):
    """The contrast of a wave of (u, v) cycles for each texel after the filter by probes: float64 [...],
    negative if the wave is inverted.
    """
    total = np.zeros(found.count.shape)
    for k in range(int(found.count.max())):
        at = found.offsets(k)
        phase = np.cos(2.0 * np.pi * (at[..., 0] * wave[0] + at[..., 1] * wave[1]))
        total = total + np.where(k < found.count, phase, 0.0)
    return total / found.count * np.sinc(found.edge * wave[0]) * np.sinc(found.edge * wave[1])


def taken(way, first, second):
    """The Probes by one of WAYS."""
    if way == "mip-mapping":
        return isotropic(first, second)
    return probes(first, second, MOST, exact=way == "exact", diagonals=way != "by edges")


def measure(profile):
    """The table, with a row for each shape and way."""
    rows, curves = [], {}
    for side in SIDES:
        first, second, angles = footprints(side)
        curves["angles"] = angles
        for way in WAYS:
            found = taken(way, first, second)
            u, v = np.abs(found.direction[:, 0]), np.abs(found.direction[:, 1])
            stays = contrast(found, (0.0, 1.0 / (STAYS * SHORT)))
            goes = np.abs(contrast(found, (GOES / (side * SHORT), 0.0)))
            curves[f"{side:g} {way}"] = stays
            single = way == "mip-mapping"
            rows.append((
                f"{side:g} : 1", way, float(found.count.mean()),
                None if single else float(np.degrees(np.arctan2(v, u)).max()),
                float(stays.mean()), float(stays[STEPS // 2]),
                float(stays.min()), float(goes.max()),
            ))  # fmt: skip
    columns = (
        Column("footprint"),
        Column("way"),
        Column("probes, mean", form=".2f"),
        Column("off, at most", "degrees", ".1f"),
        Column("contrast across, mean", form=".2f"),
        Column("at 45 degrees", form=".2f"),
        Column("least", form=".2f"),
        Column("along, at most", form=".2f"),
    )
    return Table(columns, tuple(rows), curves)


def _row(table, side, way):
    (found,) = [r for r in table.records() if r["footprint"] == f"{side:g} : 1" and r["way"] == way]
    return found


def findings(table):
    """The error of the direction, the band of blur, and the cost of a power of two."""
    eight = {way: _row(table, 8.0, way) for way in WAYS}
    off = ", ".join(
        f"{_row(table, side, 'exact')['off, at most']:.1f} degrees at {side:g} : 1" for side in SIDES
    )
    middle = {way: row["at 45 degrees"] for way, row in eight.items()}
    worst = table.curves["angles"][np.argmin(table.curves["8 power of two"])]
    means = ", ".join(f"{row['contrast across, mean']:.2f} ({way})" for way, row in eight.items())
    two, exact = eight["power of two"], eight["exact"]
    return (
        f"Probes lie off the long axis by at most {off}. This is the angle whose tangent is the short side "
        "over the long one. It occurs where the footprint lies across both of a pixel's edges.",
        "There both edges are equally long. Without diagonals one probe is taken. At 8 : 1 it leaves "
        f"{middle['by edges']:.2f} of the contrast across, as mip-mapping does; with diagonals "
        f"{middle['power of two']:.2f} is left. The result is a band of blur.",
        f"The diagonals narrow the band but do not remove it. At {worst:.0f} degrees from an edge, no edge "
        f"of the pixel and no diagonal is as short as the footprint, and {two['least']:.2f} is left. The "
        f"means over all angles are {means}.",
        f"At 8 : 1 a power of two takes {two['probes, mean']:.1f} probes in the mean, the exact number "
        f"{exact['probes, mean']:.1f}. They leave {two['along, at most']:.2f} and "
        f"{exact['along, at most']:.2f} of the wave along the footprint. At 2 : 1, where one probe is half "
        f"of what is needed, they leave {_row(table, 2.0, 'power of two')['along, at most']:.2f} and "
        f"{_row(table, 2.0, 'exact')['along, at most']:.2f}.",
    )


def checks(table):
    """The catalogue's number, and the differences between the ways."""
    # The worst place is at 45 degrees, where the longer edge is (a, 1) / sqrt(2).
    worst = max(
        abs(_row(table, side, "exact")["off, at most"] - math.degrees(math.atan(1.0 / side)))
        for side in SIDES
    )
    blur = max(_row(table, side, "by edges")["at 45 degrees"] for side in (8.0, 16.0))
    sharp = min(
        _row(table, side, way)["at 45 degrees"] for side in (8.0, 16.0) for way in ("exact", "power of two")
    )
    means = [_row(table, 8.0, way)["contrast across, mean"] for way in ("mip-mapping", "power of two")]
    return (
        DATA.check("off the long axis, in degrees, beside atan(1/a)", worst, Answer.IDEAL),
        DATA.check("contrast across at 45 degrees, most that is left without diagonals", blur, Answer.IDEAL),
        DATA.check("contrast across at 45 degrees, least with them", sharp, Answer.IDEAL),
        DATA.check(
            "contrast across in the mean at 8 : 1, over mip-mapping's", means[1] - means[0], Answer.IDEAL
        ),
    )


def plot(axes, table):
    """The contrast and the number of probes as the footprint turns."""
    turning, counts = axes
    for way, color in zip(WAYS, (GREEN, BLUE, ORANGE, "0.5"), strict=True):
        turning.plot(table.curves["angles"], table.curves[f"8 {way}"], color=color, label=way)
        counts.plot(
            [r["footprint"] for r in table.records() if r["way"] == way],
            [r["probes, mean"] for r in table.records() if r["way"] == way],
            color=color,
            marker="o",
            label=way,
        )
    turning.set_xlabel("degrees that an 8 : 1 footprint is turned by")
    turning.set_ylabel("contrast of the wave across it")
    turning.legend()
    counts.set_ylabel("probes, mean")
    counts.legend()


STUDY = Study(
    **DATA.words,
    method=(
        f"Footprints of 2 : 1 to 16 : 1, {SHORT:g} texels wide, turned by 0 to 90 degrees; at most {MOST} "
        f"probes. The contrast that they leave of a wave of {STAYS:g} widths across, and of one as long as "
        "the footprint along it, is the product of a square's and N points' transforms."
    ),
    panels=2,
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
