"""P20: vectors that are interpolated along the chord, or along the arc, as the paper proposes.

Source: Kautz, Seidel 2000, section 5.1 (K17, artefact P20 of the catalogue).
"""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.geometry.vectors import cosine, sine
from fixedpipe.effects.studies.shared.strips import drawn
from fixedpipe.effects.studies.study import BLUE, EXPECTED, GREEN, Column, Study, Table
from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.enums import PrimitiveType
from fixedpipe.pipeline.state import PassState

DATA = study_data(__file__, "P20")

# Angles between the vectors of neighbouring vertices, radians; a sphere of n slices has 2 pi / n.
DELTAS = (0.125, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5)
_ACROSS = 256


def strip_between(delta):
    """A strip whose ends have unit vectors ``delta`` apart, as colours in EXPAND_NORMAL's encoding."""
    corners = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    angle = corners[:, 0] * delta / 2.0
    vectors = np.stack([sine(angle), 0.0 * angle, cosine(angle)], axis=1)
    return Mesh(
        corners, PrimitiveType.QUADS, colors=np.concatenate([(vectors + 1.0) / 2.0, np.ones((4, 1))], 1)
    )


def directions(delta, spherical, profile):
    """Angles in radians of the vectors that the machine interpolates across the strip, from its middle:
    float64 [256].

    The buffer's components have 16 bits, so the rounding of bytes does not hide the angle.
    """
    state = PassState(spherical_primary_color=spherical)
    command = Draw(label="the primary colour", mesh=strip_between(delta), state=state)
    color = drawn((command,), profile.with_precision(framebuffer_bits=16), _ACROSS, 8)[4]
    return np.arctan2(2.0 * color[:, 0] - 1.0, 2.0 * color[:, 2] - 1.0)


def lag(delta, spherical, profile):
    """The largest angle between the interpolated vector and one that turns steadily, radians."""
    steady = ((np.arange(_ACROSS) + 0.5) / _ACROSS - 0.5) * delta
    return float(np.abs(directions(delta, spherical, profile) - steady).max())


def measure(profile):
    """The table, with a row for each angle between neighbouring vertices."""
    rows, curves = [], {}
    for delta in DELTAS:
        linear, arc = lag(delta, False, profile), lag(delta, True, profile)
        rows.append((delta, 2.0 * np.pi / delta, linear, arc, 0.5 * delta * delta / 8.0))
    steady = ((np.arange(_ACROSS) + 0.5) / _ACROSS - 0.5) * DELTAS[-1]
    curves["steady"] = steady
    curves["chord"] = directions(DELTAS[-1], False, profile) - steady
    curves["arc"] = directions(DELTAS[-1], True, profile) - steady
    columns = (
        Column("angle between vertices", "radians", ".3f"),
        Column("slices of a sphere", form=".1f"),
        Column("off along the chord", "radians", ".6f"),
        Column("off along the arc", "radians", ".6f"),
        Column("angle squared / 16", "radians", ".6f"),
    )
    return Table(columns, tuple(rows), curves)


def _power(table):
    """The power of the angle with which the chord's error grows, from the last rows."""
    angle = np.log(table.column("angle between vertices"))
    off = np.log(table.column("off along the chord"))
    return float((off[-1] - off[2]) / (angle[-1] - angle[2]))


def findings(table):
    """How far highlights move on a triangle."""
    last = table.records()[-1]
    largest = max(table.column("off along the arc"))
    share = max(r["off along the chord"] / r["angle squared / 16"] for r in table.records())
    return (
        f"Interpolated along the chord, a vector lags behind by up to {last['off along the chord']:.4f} "
        f"radians where the vertices' vectors are {last['angle between vertices']:g} apart. The error grows "
        f"with the power {_power(table):.2f} of the angle. It is at most {100 * share:.0f} % of the angle's "
        "square / 16.",
        f"Interpolated along the arc, it is off by at most {largest:.6f}, the resolution of colours of 16 "
        "bits.",
    )


def checks(table):
    """The catalogue's bound for the chord, and no error on the arc."""
    for r in table.records():
        at = f"at {r['angle between vertices']:g}"
        yield DATA.check(
            "radians off along the chord {at}",
            r["off along the chord"],
            Answer.MACHINE,
            at_most=r["angle squared / 16"],
            at=at,
        )
    yield DATA.check(
        "radians off along the arc", max(table.column("off along the arc")), Answer.MACHINE, at_most=2.0**-14
    )
    yield DATA.check(
        "arc / chord at the largest angle",
        table.column("off along the arc")[-1] / table.column("off along the chord")[-1],
        Answer.MACHINE,
    )


def plot(axes, table):
    """The errors by angle, and the error across a triangle."""
    by_angle, across = axes
    angle = table.column("angle between vertices")
    by_angle.loglog(angle, table.column("off along the chord"), color=BLUE, marker="o", label="chord")
    by_angle.loglog(angle, table.column("off along the arc"), color=GREEN, marker="s", label="arc")
    bound = table.column("angle squared / 16")
    by_angle.loglog(angle, bound, label="catalogue: at most angle squared / 16", **EXPECTED)
    by_angle.set_xticks([0.125, 0.25, 0.5, 1.0], ["0.125", "0.25", "0.5", "1"])
    by_angle.minorticks_off()
    by_angle.set_xlabel("angle between the vertices' vectors, radians")
    by_angle.set_ylabel("largest angle off, radians")
    by_angle.set_ylim(1e-5, 2.0)
    by_angle.legend(loc="upper left")
    across.plot(table.curves["steady"], table.curves["chord"], color=BLUE, label="chord")
    across.plot(table.curves["steady"], table.curves["arc"], color=GREEN, label="arc")
    across.set_xlabel(f"steadily turning angle between vertices {DELTAS[-1]:g} apart, radians")
    across.set_ylabel("interpolated angle minus it, radians")
    across.legend()


STUDY = Study(
    **DATA.words,
    machines=("FUTURE",),
    panels=2,
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
