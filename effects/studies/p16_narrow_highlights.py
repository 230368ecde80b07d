"""P16: the colour matrix computes in floats, so alphas have no smallest value.

Source: Kautz, Seidel 2000, section 4.2 (artefact P16 of the catalogue).
"""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.studies.shared.paraboloid import (
    by_imaging_subset,
    by_register_combiners,
    material,
    true,
)
from fixedpipe.effects.studies.study import BLUE, ORANGE, RED, Column, Study, Table
from fixedpipe.pipeline.profiles import GEFORCE_256

DATA = study_data(__file__, "P16")

ALPHAS = (1.0, 0.5, 0.25, 0.1, 0.05, 0.02, 0.005)
# The slope at the bump's edges over alpha: highlights cover the same part of it.
_REACH = 1.2


def measure(profile):
    """The table, with a row for each alpha."""
    rows, curves = [], {}
    for alpha in ALPHAS:
        bump = material(alpha, _REACH * alpha)
        exact, _, _ = true(bump, alpha)
        matrix, combiners = by_imaging_subset(bump, profile), by_register_combiners(bump, GEFORCE_256)
        rows.append(
            (
                alpha,
                float((exact > 0.0).mean()),
                root_mean_square(matrix - exact),
                float(np.abs(matrix - exact).max()),
                root_mean_square(combiners - exact),
                float(np.abs(combiners - exact).max()),
            )
        )
        if alpha == 0.02:
            middle = len(exact) // 2
            for name, image in (("true", exact), ("K08", matrix), ("K07", combiners)):
                curves[name] = image[middle]
    columns = (
        Column("alpha", form=".3f"),
        Column("share in highlight", form=".3f"),
        Column("K08, RMS", form=".4f"),
        Column("K08, largest", form=".4f"),
        Column("K07, RMS", form=".4f"),
        Column("K07, largest", form=".4f"),
    )
    return Table(columns, tuple(rows), curves)


def findings(table):
    """The errors of both ways for the narrowest highlights."""
    rows = {r["alpha"]: r for r in table.records()}
    matrix = table.column("K08, RMS")
    narrow = rows[0.02]
    return (
        f"The colour matrix gives Eq. 1 to an RMS of {min(matrix):.4f} to {max(matrix):.4f}, at alphas from "
        f"{max(rows):g} to {min(rows):g}. At 0.02 it is {narrow['K08, RMS']:.4f}.",
        "Register combiners read stored vectors, which hold no alpha below 1/4. They are off by an RMS of "
        f"{rows[0.25]['K07, RMS']:.4f} at 0.25 and of {narrow['K07, RMS']:.3f} at 0.02.",
    )


def checks(table):
    """The catalogue's bound."""
    rows = {r["alpha"]: r for r in table.records()}
    matrix = table.column("K08, RMS")
    return (
        DATA.check("RMS of K08, largest of all alphas", max(matrix), Answer.MACHINE),
        DATA.check("RMS of K08, largest over smallest", max(matrix) / min(matrix), Answer.MACHINE),
        DATA.check("RMS of K07 at alpha 0.02", rows[0.02]["K07, RMS"], Answer.MACHINE),
        DATA.check("RMS of K07 at alpha 0.25", rows[0.25]["K07, RMS"], Answer.MACHINE),
    )


def plot(axes, table):
    """The errors by alpha, and the values across the narrow highlight."""
    errors, across = axes
    alphas = table.column("alpha")
    errors.loglog(alphas, table.column("K07, RMS"), color=RED, marker="s", label="K07, register combiners")
    errors.loglog(alphas, table.column("K08, RMS"), color=BLUE, marker="o", label="K08, colour matrix")
    errors.axhline(0.004, color="black", linestyle=":", label="catalogue: K08 at most .004")
    errors.axvline(0.25, color="black", linewidth=0.8, linestyle="--", label="smallest alpha K07 stores")
    errors.set_xlabel("alpha")
    errors.set_ylabel("RMS of machine - float64 (1 = full intensity)")
    errors.set_ylim(5e-4, 20.0)
    errors.legend(loc="upper left")
    x = (np.arange(len(table.curves["true"])) + 0.5) / len(table.curves["true"]) * 2.0 - 1.0
    slope = x * _REACH * 0.02
    across.plot(slope, table.curves["true"], color=ORANGE, lw=4, alpha=0.5, label="Eq. 1, alpha = 0.02")
    across.plot(slope, table.curves["K08"], color=BLUE, label="K08")
    across.plot(slope, table.curves["K07"], color=RED, label="K07")
    across.set_xlabel("slope of the bump")
    across.set_ylabel("intensity")
    across.set_ylim(0.0, 1.25)
    across.legend(loc="lower center")


STUDY = Study(
    **DATA.words,
    machines=("OCTANE", "INFINITE_REALITY"),
    panels=2,
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
