"""P3: tables over a cosine are coarse near one, where highlights are.

Facets are distributed as exp(-(delta/m)^2), where delta is the angle between halfway vector and normal. The
study compares tables of 256 texels over cos delta, as in H02, and over H13's coordinate tan(delta/2).

Source: Heidrich 2001, section 1.1 (artefact P3 of the catalogue).
"""

from itertools import pairwise

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.geometry.views import Panel, orthographic_view
from fixedpipe.effects.passes.draws import EDGE, FIRST_PASS, REPLACE, draw, unit
from fixedpipe.effects.reflectance.sampled_functions import sampled
from fixedpipe.effects.studies.shared.strips import drawn, strip
from fixedpipe.effects.studies.study import (
    BLACK,
    BLUE,
    EXPECTED,
    GREEN,
    ORANGE,
    RED,
    Column,
    Study,
    Table,
)
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import IDEAL

DATA = study_data(__file__, "P3")

ROUGHNESSES = (0.05, 0.07, 0.1, 0.15, 0.2, 0.3, 0.5)
# The catalogue's texels within one width.
_COMPUTED = {0.05: 0.3, 0.1: 1.3, 0.2: 5.1, 0.5: 31.0}
_TEXELS, _COUNT = 256, 512
_PANEL = Panel(0, 0, _COUNT, 2)
_VIEW = orthographic_view(_PANEL, half_height=2.0 / _COUNT)
# Beyond so many widths a highlight is dark.
_REACH = 3.0


def facets(delta, roughness):
    """exp(-(delta/m)^2), whose maximum is one: float64."""
    return np.exp(-np.square(np.asarray(delta, np.float64) / roughness))


def _over_cosine(roughness):
    return lambda s: facets(np.arccos(np.clip(s, -1.0, 1.0)), roughness)


def _over_half_tangent(roughness):
    # The table's s is (1 + x) / 2, x = tan(delta / 2) of either side.
    return lambda s: facets(2.0 * np.arctan(np.abs(2.0 * s - 1.0)), roughness)


# By what the table is over: the table's function, and the coordinate of an angle.
TABLES = {
    "cosine": (_over_cosine, np.cos),
    "half tangent": (_over_half_tangent, lambda delta: 0.5 + 0.5 * np.tan(delta / 2.0)),
}


def looked_up(profile, name, roughness, delta):
    """The table's values at angles ``delta`` [n]: float64 [n]; one pixel each."""
    function, coordinate = TABLES[name]
    image = sampled(function(roughness), _TEXELS, profile=profile)
    # Coarse enough that the bits are the same everywhere, fine beside a texel.
    step = 2.0**-18
    s = np.floor(coordinate(delta) / step + 0.5) * step
    mesh = strip(len(delta), coordinates=np.stack([s, 0.0 * s], axis=-1))
    commands = (
        _PANEL.clear((0.0, 0.0, 0.0)),
        TexImage(label="load D", texture="D", image=image, target=image.target),
        draw("D", mesh, _VIEW, None, (unit("D", EDGE, environment=REPLACE),), depth_test=FIRST_PASS),
    )
    if profile.arithmetic.exact:
        return execute_ideal(commands, _COUNT, 2).color[0, :, 0]
    return drawn(commands, profile, _COUNT, 2)[0, :, 0]


def half_width(delta, values):
    """The angle where values, which fall from ``delta`` = 0 on, reach a half, by linear interpolation."""
    below = int(np.argmax(values < 0.5))
    share = (values[below - 1] - 0.5) / (values[below - 1] - values[below])
    return float(delta[below - 1] + share * (delta[below] - delta[below - 1]))


def measure(profile):
    """The table, with a row for each roughness."""
    rows, curves = [], {}
    for m in ROUGHNESSES:
        delta = (np.arange(_COUNT) + 0.5) * (_REACH * m / _COUNT)
        true = facets(delta, m)
        found = {
            (name, on): looked_up(p, name, m, delta)
            for name in TABLES
            for on, p in (("ideal", IDEAL), ("machine", profile))
        }
        rows.append(
            (
                m,
                float((1.0 - np.cos(m)) * _TEXELS),
                root_mean_square(found["cosine", "ideal"] - true),
                root_mean_square(found["cosine", "machine"] - true),
                100.0 * (half_width(delta, found["cosine", "ideal"]) / (m * np.sqrt(np.log(2.0))) - 1.0),
                float(np.tan(m / 2.0) * _TEXELS / 2.0),
                root_mean_square(found["half tangent", "ideal"] - true),
                root_mean_square(found["half tangent", "machine"] - true),
            )
        )
        if m in (0.05, 0.1):
            curves[f"true {m}"] = true
            for name in TABLES:
                curves[f"{name} {m}"] = found[name, "machine"]
    curves["delta"] = (np.arange(_COUNT) + 0.5) * (_REACH / _COUNT)
    columns = (
        Column("m", form=".2f"),
        Column("texels a width, cosine", form=".1f"),
        Column("RMS, cosine", form=".4f"),
        Column("RMS, cosine, machine", form=".4f"),
        Column("too wide", "%", ".1f"),
        Column("texels a width, half tangent", form=".1f"),
        Column("RMS, half tangent", form=".4f"),
        Column("RMS, half tangent, machine", form=".4f"),
    )
    return Table(columns, tuple(rows), curves)


def findings(table):
    """Where a table over the cosine is too coarse, and the effect of another coordinate."""
    rows = {r["m"]: r for r in table.records()}
    sharp, known, broad = rows[0.05], rows[0.1], rows[0.5]
    return (
        f"The width of a highlight is m. A table of {_TEXELS} texels over the cosine has "
        f"{sharp['texels a width, cosine']:.1f} of them within m = 0.05, "
        f"{known['texels a width, cosine']:.1f} within m = 0.1 and {broad['texels a width, cosine']:.0f} "
        f"within m = 0.5. These highlights are off by an RMS of {sharp['RMS, cosine']:.3f}, "
        f"{known['RMS, cosine']:.3f} and {broad['RMS, cosine']:.5f}. Those of m = 0.05 and 0.1 are "
        f"{sharp['too wide']:.0f} and {known['too wide']:.0f} % too wide.",
        f"Over tan(delta/2), texels are as dense near the normal as elsewhere. {_TEXELS} texels have "
        f"{sharp['texels a width, half tangent']:.1f} within m = 0.05, and the RMS is "
        f"{sharp['RMS, half tangent']:.4f}. On the machine it is {sharp['RMS, half tangent, machine']:.4f}, "
        f"compared with {sharp['RMS, cosine, machine']:.3f} over the cosine.",
    )


def checks(table):
    """The catalogue's numbers, and that the error grows with sharpness."""
    rows = {r["m"]: r for r in table.records()}
    for m, expected in _COMPUTED.items():
        yield DATA.check(
            "texels within one width of m = {m}, of {expected}: deviation",
            abs(rows[m]["texels a width, cosine"] - expected),
            Answer.IDEAL,
            at_most=0.05 if expected < 10.0 else 0.5,
            m=m,
            expected=expected,
        )
    errors = table.column("RMS, cosine")
    yield DATA.check(
        "RMS over the cosine of a roughness over that of the next sharper one, largest",
        max(b / a for a, b in pairwise(errors)),
        Answer.IDEAL,
    )
    yield DATA.check("RMS over the cosine, m = 0.05", rows[0.05]["RMS, cosine"], Answer.IDEAL)
    yield DATA.check("RMS over the cosine, m = 0.2", rows[0.2]["RMS, cosine"], Answer.IDEAL)
    for r in table.records():
        yield DATA.check(
            "RMS over the half tangent on the machine, m = {which}",
            r["RMS, half tangent, machine"],
            Answer.MACHINE,
            which=r["m"],
        )


def plot(axes, table):
    """Sharp highlights by both tables, and the errors by roughness."""
    across, errors = axes
    delta = table.curves["delta"]
    across.plot(delta, table.curves["true 0.1"], color=BLACK, lw=1, ls="--", label="exp(-(delta/m)^2)")
    for m, color in ((0.05, RED), (0.1, ORANGE)):
        across.plot(delta, table.curves[f"cosine {m}"], color=color, label=f"over the cosine, m = {m}")
    across.plot(
        delta, table.curves["half tangent 0.05"], color=BLUE, ls=":", label="over tan(delta/2), m = 0.05"
    )
    across.set_xlabel("delta over m")
    across.set_ylabel("D by 256 texels, on the machine")
    across.legend(loc="upper right")
    m = table.column("m")
    for name, color, marker in (
        ("RMS, cosine", RED, "s"),
        ("RMS, cosine, machine", ORANGE, "o"),
        ("RMS, half tangent", GREEN, "^"),
        ("RMS, half tangent, machine", BLUE, "v"),
    ):
        errors.loglog(m, table.column(name), color=color, marker=marker, label=name)
    errors.loglog([], [], label="catalogue: texels a width", **EXPECTED)
    for roughness, expected in _COMPUTED.items():
        row = table.records()[ROUGHNESSES.index(roughness)]
        errors.plot(roughness, row["RMS, cosine"], **EXPECTED)
        errors.annotate(f"{expected:g}", (roughness, row["RMS, cosine"]), (5, 5), textcoords="offset points")
    errors.set_xticks([0.05, 0.1, 0.2, 0.5], ["0.05", "0.1", "0.2", "0.5"])
    errors.minorticks_off()
    errors.set_xlabel("roughness m")
    errors.set_ylabel("error in the highlight")
    errors.legend(loc="lower left")


STUDY = Study(
    **DATA.words,
    method=(
        f"exp(-(delta/m)^2) by tables of {_TEXELS} texels over cos delta and over tan(delta/2), at {_COUNT} "
        "angles up to three widths, beside the function."
    ),
    machines=("OPENGL_1_2", "OCTANE", "GEFORCE_256", "GEFORCE_3", "NV2A"),
    panels=2,
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
