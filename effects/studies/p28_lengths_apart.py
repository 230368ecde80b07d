"""P28: the interpolated direction between two vectors of different length, with their lengths and without.

Source: Schilling 1997, section 7.1 (S13, artefact P28 of the catalogue).
"""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.bump_mapping.offset_vectors import middle_error
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.geometry.vectors import cosine, normalize, sine
from fixedpipe.effects.studies.shared.strips import drawn
from fixedpipe.effects.studies.study import BLUE, EXPECTED, GREEN, RED, SKY, Column, Study, Table
from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.enums import PrimitiveType
from fixedpipe.pipeline.state import PassState

DATA = study_data(__file__, "P28")

# Angles between the vectors of two vertices, degrees, and how many times as long the first is.
ANGLES = (15, 30, 60, 90, 120)
RATIOS = (1.5, 2.0, 4.0, 8.0)
# The angle and the ratio whose directions are drawn all the way.
_SHOWN = 90, 4.0
# Odd, so that a pixel's middle is the strip's.
_ACROSS = 257
# A colour of 16 bits has a step of 2/65535, half of which is lost where it is stored and where it is
# interpolated, in two components; and the shorter of two vectors is drawn out to the sum's half.
_STEP = 2.0 / 65535.0


def strip_between(angle, ratio):
    """A strip from a vector of length one to a vector ``ratio`` times shorter, ``angle`` degrees apart. They
    are colours for EXPAND_NORMAL.
    """
    corners = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    turned = -corners[:, 0] * np.radians(angle) / 2.0
    length = np.where(corners[:, 0] < 0.0, 1.0, 1.0 / ratio)
    vectors = length[:, None] * np.stack([cosine(turned), sine(turned), 0.0 * turned], axis=1)
    return Mesh(corners, PrimitiveType.QUADS, colors=0.5 + 0.5 * vectors), vectors


def directions(angle, ratio, profile):
    """Angles in degrees of the vectors that the machine interpolates across the strip: float64 [_ACROSS].

    The buffer's components have 16 bits, so the rounding of bytes does not hide the angle.
    """
    mesh, _ = strip_between(angle, ratio)
    command = Draw(label="the primary colour", mesh=mesh, state=PassState())
    color = drawn((command,), profile.with_precision(framebuffer_bits=16), _ACROSS, 8)[4]
    return np.degrees(np.arctan2(2.0 * color[:, 1] - 1.0, 2.0 * color[:, 0] - 1.0))


def measure(profile):
    """The table, with a row for each angle and ratio."""
    rows = []
    for angle in ANGLES:
        # Directions of length one, as they are interpolated apart from their lengths.
        apart = directions(angle, 1.0, profile)[_ACROSS // 2]
        for ratio in RATIOS:
            straight = directions(angle, ratio, profile)[_ACROSS // 2]
            expected = np.degrees(middle_error(ratio, 1.0, np.radians(angle)))
            rows.append((angle, ratio, float(straight), float(expected), float(apart)))
    angle, ratio = _SHOWN
    columns = (
        Column("angle between vertices", "degrees", "d"),
        Column("one is longer", "times", ".1f"),
        Column("off as they are", "degrees", ".3f"),
        Column("computed", "degrees", ".3f"),
        Column("off, lengths apart", "degrees", ".3f"),
    )
    curves = {
        "place": (np.arange(_ACROSS) + 0.5) / _ACROSS,
        "as they are": directions(angle, ratio, profile),
        "lengths apart": directions(angle, 1.0, profile),
    }
    return Table(columns, tuple(rows), curves)


def findings(table):
    """The error of directions in the middle, and how fast they turn near the shorter vector."""
    worst = max(table.records(), key=lambda r: r["off as they are"])
    largest = max(abs(a) for a in table.column("off, lengths apart"))
    turning = {
        name: np.abs(np.diff(table.curves[name])) * _ACROSS for name in ("as they are", "lengths apart")
    }
    angle, ratio = _SHOWN
    return (
        f"Two vectors are {worst['angle between vertices']} degrees apart, one {worst['one is longer']:g} "
        "times as long. Interpolated unchanged, their direction in the middle is "
        f"{worst['off as they are']:.1f} degrees off, towards the longer. With separate lengths it is "
        f"{largest:.3f} off, the resolution of colours of 16 bits.",
        f"Take vectors {angle} degrees apart and {ratio:g} to 1 in length. Their direction turns by "
        f"{turning['as they are'][:16].mean():.0f} degrees a strip near the longer, and by "
        f"{turning['as they are'][-16:].mean():.0f} near the shorter. With separate lengths it turns by "
        f"{turning['lengths apart'][:16].mean():.0f} and {turning['lengths apart'][-16:].mean():.0f}.",
    )


def checks(table):
    """The catalogue's formula, and no error if lengths are interpolated separately."""
    off = max(abs(r["off as they are"] - r["computed"]) for r in table.records())
    yield DATA.check(
        "degrees off in the middle - atan((L1 - L2)/(L1 + L2) tan(phi/2)), largest",
        off,
        Answer.MACHINE,
        at_most=float(np.degrees(4.0 * _STEP)),
    )
    yield DATA.check(
        "degrees off in the middle, lengths apart, largest",
        max(abs(a) for a in table.column("off, lengths apart")),
        Answer.MACHINE,
        at_most=float(np.degrees(4.0 * _STEP)),
    )
    exact = 0.0
    for angle in ANGLES:
        for ratio in RATIOS:
            _, vectors = strip_between(angle, ratio)
            x, y, _ = normalize(vectors[0] + vectors[1])
            lag = abs(float(np.arctan2(y, x)) - middle_error(ratio, 1.0, np.radians(angle)))
            exact = max(exact, float(np.degrees(lag)))
    yield DATA.check("the formula against the vectors' own sum, degrees, largest", exact, Answer.IDEAL)


def plot(axes, table):
    """The error in the middle by angle, and the directions from one vector to the other."""
    by_angle, across = axes
    for ratio, color in zip(RATIOS, (SKY, BLUE, GREEN, RED), strict=True):
        rows = [r for r in table.records() if r["one is longer"] == ratio]
        angle = [r["angle between vertices"] for r in rows]
        by_angle.plot(angle, [r["off as they are"] for r in rows], color=color, label=f"{ratio:g} : 1")
        computed = [r["computed"] for r in rows]
        by_angle.plot(angle, computed, label="catalogue" if ratio == RATIOS[-1] else None, **EXPECTED)
    by_angle.set_xlabel("angle between the vertices' vectors, degrees")
    by_angle.set_ylabel("direction in the middle is off, degrees")
    by_angle.legend(loc="upper left")
    angle, ratio = _SHOWN
    across.plot(
        table.curves["place"], table.curves["as they are"], color=BLUE, label=f"as they are, {ratio:g} : 1"
    )
    across.plot(table.curves["place"], table.curves["lengths apart"], color=GREEN, label="lengths apart")
    across.set_xlabel("place, from the longer vector to the shorter")
    across.set_ylabel(f"direction, degrees, of vectors {angle} apart")
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
