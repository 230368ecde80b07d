"""P1: the table of G / (pi cos beta), clamped at one.

A plane tilts from 0 to 90 degrees. Its light comes from the front, which is the table's last column. The
table is stored in bytes, in bytes divided by c and multiplied back (H10), and in floats. The clamp's loss is
measured as a share of the integral over the cosine of the view's angle.

Source: Heidrich 2001, section 1.1 (artefact P1 of the catalogue).
"""

import math

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.reflectance import torrance_sparrow_passes as tables
from fixedpipe.effects.studies.study import BLUE, GREEN, ORANGE, PURPLE, RED, Column, Study, Table
from fixedpipe.pipeline.profiles import OPENGL_1_2
from fixedpipe.pipeline.textures.images import Texture

DATA = study_data(__file__, "P1")

SIGMAS = (0.05, 0.1, 0.2, 0.4)
DIVISORS = (1.0, 2.0, 4.0, 8.0)
# Computed in the catalogue: the table's largest value, and what the clamp takes, in percent.
LARGEST = {0.05: 7.97, 0.1: 3.99, 0.2: 1.99, 0.4: 0.997}
LOST = {0.05: 45.0, 0.1: 33.0, 0.2: 16.0, 0.4: 0.0}
BEGINS = 71.4


def column(sigma, divisor):
    """The stored table's values over n.v with light from the front, times c: float64 [256]."""
    _, command = tables.load(OPENGL_1_2, sigma * math.sqrt(2.0), 1.5, divisor=divisor)
    image: Texture = command.image
    return divisor * np.asarray(image.levels[0])[0][:, -1, 0].astype(np.float64) / 255.0


def measure(profile):
    """The table, with a row for each sigma and c."""
    rows, curves = [], {}
    cosines = np.arange(tables.TEXELS) / (tables.TEXELS - 1.0)
    curves["degrees"] = np.degrees(np.arccos(cosines))
    for sigma in SIGMAS:
        exact = tables.obstruction(1.0, cosines, sigma)
        curves[f"{sigma:g} exact"] = exact
        largest = float(tables.obstruction(1.0, np.linspace(1e-4, 1.0, 100001), sigma).max())
        for divisor in DIVISORS:
            kept = column(sigma, divisor)
            curves[f"{sigma:g} {divisor:g}"] = kept
            clamped = exact > divisor
            rows.append((
                sigma, int(divisor), largest, float(kept.max()),
                float(np.degrees(np.arccos(cosines[clamped].max()))) if clamped.any() else None,
                100.0 * float((exact - kept)[clamped].sum() / exact.sum()),
                float(np.abs(kept - exact)[~clamped].max()),
            ))  # fmt: skip
    columns = (
        Column("sigma", form=".2f"),
        Column("c", form="d"),
        Column("largest, exact", form=".3f"),
        Column("kept", form=".3f"),
        Column("clamped from", "degrees", ".1f"),
        Column("lost", "%", ".1f"),
        Column("error elsewhere", form=".4f"),
    )
    return Table(columns, tuple(rows), curves)


def _rows(table, divisor):
    return {r["sigma"]: r for r in table.records() if r["c"] == divisor}


def findings(table):
    """Where the clamp begins, how much light it removes, and the error that remains with divisors."""
    plain, eighth = _rows(table, 1), _rows(table, 8)
    lost = ", ".join(f"{r['lost']:.0f} % at sigma {sigma:g}" for sigma, r in plain.items() if r["lost"])
    return (
        f"A table of unscaled bytes clamps from {plain[0.1]['clamped from']:.1f} degrees on. Of its "
        f"integral over the cosine it loses {lost}. At sigma 0.4 the largest value is "
        f"{plain[0.4]['largest, exact']:.3f}, and nothing is lost.",
        "A table divided by eight clamps nothing, even at sigma 0.05. It is rounded by "
        f"{eighth[0.05]['error elsewhere']:.4f} at most, half of c/255, where the whole table has "
        f"{plain[0.05]['error elsewhere']:.4f}.",
    )


def checks(table):
    """The catalogue's numbers."""
    plain = _rows(table, 1)
    largest = max(abs(plain[s]["largest, exact"] / LARGEST[s] - 1.0) for s in SIGMAS)
    lost = max(abs(plain[s]["lost"] - LOST[s]) for s in SIGMAS)
    begins = max(abs(plain[sigma]["clamped from"] - BEGINS) for sigma in (0.05, 0.1))
    enough = [r for r in table.records() if r["c"] >= LARGEST[r["sigma"]]]
    return (
        DATA.check("the table's largest value, off the catalogue's, relative", largest, Answer.MACHINE),
        DATA.check("lost by the clamp, off the catalogue's, in percent", lost, Answer.MACHINE),
        DATA.check("clamped from, off 71.4 degrees", begins, Answer.MACHINE),
        DATA.check(
            "lost with c above the largest, in percent", max(r["lost"] for r in enough), Answer.MACHINE
        ),
        DATA.check(
            "errors over c/255, most",
            max(255.0 * r["error elsewhere"] / r["c"] for r in table.records()),
            Answer.MACHINE,
            at_most=0.5 + 1e-9,
        ),
    )


def plot(axes, table):
    """The table's column for the smoothest surface, and the lost light."""
    kept, lost = axes
    for divisor, color in zip(DIVISORS, (RED, ORANGE, GREEN, BLUE), strict=True):
        kept.plot(
            table.curves["degrees"], table.curves[f"0.05 {divisor:g}"], color=color, label=f"c = {divisor:g}"
        )
    kept.plot(
        table.curves["degrees"], table.curves["0.05 exact"], color="black", linestyle=":", label="exact"
    )
    kept.set_xlabel("degrees between normal and view, sigma 0.05")
    kept.set_ylabel("G / (pi cos beta)")
    kept.legend()
    for sigma, color in zip(SIGMAS, (RED, ORANGE, GREEN, PURPLE), strict=True):
        values = [r["lost"] for r in table.records() if r["sigma"] == sigma]
        lost.plot(DIVISORS, values, marker="o", color=color, label=f"sigma {sigma:g}")
    lost.set_xscale("log", base=2)
    lost.set_xlabel("c")
    lost.set_ylabel("lost, %")
    lost.legend()


STUDY = Study(
    **DATA.words,
    panels=2,
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
