"""P15: a colour matrix whose results have no sign.

Eq. 1 squares dot products of either sign, but the colour matrix cannot return negative numbers. With (1 + d)
/ 2 and a table of (2 i - 1)^2 nothing is lost (erratum E004.9). Without them, the squares of negative
products are zero, and one minus these stays bright. Then half of each square is missing, and the highlight's
edge.

Source: Kautz, Seidel 2000, sections 4.2 and 5 (artefact P15 of the catalogue).
"""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.studies.shared.paraboloid import by_imaging_subset, material, true
from fixedpipe.effects.studies.study import BLUE, ORANGE, Column, Study, Table

DATA = study_data(__file__, "P15")

ALPHA, _SLOPE = 0.25, 0.3


def measure(profile):
    """The table, with a row for each quadrant of signs, and one for all."""
    bump = material(ALPHA, _SLOPE)
    exact, x, y = true(bump, ALPHA)
    pictures = {
        "true": exact,
        "biased": by_imaging_subset(bump, profile),
        "unsigned": by_imaging_subset(bump, profile, biased=False),
    }
    quadrants = {
        "h.t > 0, h.b > 0": (x > 0.0) & (y > 0.0),
        "h.t < 0, h.b > 0": (x < 0.0) & (y > 0.0),
        "h.t > 0, h.b < 0": (x > 0.0) & (y < 0.0),
        "h.t < 0, h.b < 0": (x < 0.0) & (y < 0.0),
        "all": np.ones(x.shape, bool),
    }
    rows = []
    for name, where in quadrants.items():
        row = [name, float(exact[where].mean())]
        for way in ("biased", "unsigned"):
            row += [
                float(pictures[way][where].mean()),
                root_mean_square((pictures[way] - exact)[where]),
            ]
        rows.append(tuple(row))
    columns = (
        Column("where"),
        Column("mean", form=".3f"),
        Column("mean, (1 + d) / 2", form=".3f"),
        Column("RMS, (1 + d) / 2", form=".4f"),
        Column("mean, d itself", form=".3f"),
        Column("RMS, d itself", form=".4f"),
    )
    return Table(columns, tuple(rows), pictures)


def missing_squares(table):
    """The share of 1 - L, the sum of the squares, that is missing without the bias, inside the highlight."""
    inside = table.curves["true"] > 0.02
    full = 1.0 - table.curves["true"][inside]
    return float(1.0 - (1.0 - table.curves["unsigned"][inside]).sum() / full.sum())


def findings(table):
    """How much is lost, and where."""
    rows = {r["where"]: r for r in table.records()}
    right, wrong, whole = rows["h.t > 0, h.b > 0"], rows["h.t < 0, h.b < 0"], rows["all"]
    return (
        f"Delivered as (1 + d) / 2, the products give Eq. 1 to an RMS of {whole['RMS, (1 + d) / 2']:.4f}. "
        f"Delivered as d, {100 * missing_squares(table):.0f} % of the squares under the highlight are "
        "missing.",
        f"Where both products are positive the RMS is still {right['RMS, d itself']:.4f}. Where both are "
        f"negative the mean is {wrong['mean, d itself']:.2f} instead of {wrong['mean']:.2f}, and the "
        "highlight has no edge.",
    )


def checks(table):
    """The catalogue's number, one half, and the place of the loss."""
    rows = {r["where"]: r for r in table.records()}
    right, wrong = rows["h.t > 0, h.b > 0"], rows["h.t < 0, h.b < 0"]
    return (
        DATA.check(
            "share of the squares that is missing, of 1/2: deviation",
            abs(missing_squares(table) - 0.5),
            Answer.MACHINE,
        ),
        DATA.check("RMS with the bias", rows["all"]["RMS, (1 + d) / 2"], Answer.MACHINE),
        DATA.check("RMS without it where both products are positive", right["RMS, d itself"], Answer.MACHINE),
        DATA.check("least mean without it where both are negative", wrong["mean, d itself"], Answer.MACHINE),
        DATA.check(
            "pixels lit without it over those that should be, all quadrants",
            _lit(table, "unsigned") / _lit(table, "true"),
            Answer.MACHINE,
        ),
    )


def _lit(table, name):
    return float((table.curves[name] > 0.0).mean())


def plot(axes, table):
    """Three pictures of the highlight, and the values along its middle."""
    titles = {"true": "Eq. 1", "biased": "(1 + d) / 2, signed squares", "unsigned": "d itself, no sign"}
    for ax, (name, title) in zip(axes, titles.items(), strict=True):
        ax.imshow(table.curves[name], origin="lower", cmap="gray", vmin=0.0, vmax=1.0, extent=(-1, 1, -1, 1))
        ax.grid(False)
        ax.set_title(title, fontsize="medium")
        ax.axvline(0.0, color=BLUE, lw=0.8, ls=":")
        ax.axhline(0.0, color=ORANGE, lw=0.8, ls=":")
        ax.set_xlabel("h.t < 0         h.t > 0")
        ax.set_ylabel("h.b < 0         h.b > 0")
        ax.set_xticks([])
        ax.set_yticks([])


STUDY = Study(
    **DATA.words,
    machines=("OCTANE", "INFINITE_REALITY"),
    panels=3,
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
