"""P31: the best number of directions if each direction's light is stored in bytes, with a weight of 4 pi / N.

Source: Heidrich, Daubert, Kautz, Seidel 2000, sections 3.3 and 6: 100 directions (artefact P31 of the
catalogue).
"""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.scattering import light_transport
from fixedpipe.effects.scattering.dependent_tests import Accumulation
from fixedpipe.effects.scattering.directions import spiral
from fixedpipe.effects.scattering.visibility import precompute
from fixedpipe.effects.studies.shared import path_sums
from fixedpipe.effects.studies.study import BLUE, GREEN, ORANGE, RED, Column, Study, Table

DATA = study_data(__file__, "P31")

NUMBERS = (10, 15, 20, 30, 40, 60, 80, 100, 120, 150, 200, 300, 400)
# What stands for all directions. Assumed: noise falls with N, and these are seven times the most above.
ALL = 3000


def measure(profile):
    """The table, with a row for each number of directions."""
    field = path_sums.domes()
    light = np.array(path_sums.LIGHT)
    limit = light_transport.bounces(field, precompute(field, spiral(ALL)), light, 1)[-1]
    rows = []
    for number in NUMBERS:
        setup = path_sums.setup_of(profile, field, number)
        paths = light_transport.sequences(number, 1, number)
        picture, expected = path_sums.sums(setup, paths, Accumulation.FRAMEBUFFER)
        in_buffer, _ = path_sums.sums(setup, paths, Accumulation.ACCUMULATION_BUFFER)
        rows.append(
            (
                number,
                light_transport.WEIGHT / number * path_sums.EXPOSURE * 255.0,
                root_mean_square(expected - limit),
                root_mean_square(picture - expected),
                float((picture - expected).mean()),
                root_mean_square(picture - limit),
                root_mean_square(in_buffer - limit),
            )
        )
    columns = (
        Column("N", form="d"),
        Column("weight", "steps of a byte", ".1f"),
        Column("noise", form=".5f"),
        Column("rounding", form=".5f"),
        Column("bias", form="+.5f"),
        Column("both", form=".5f"),
        Column("in the accumulation buffer", form=".5f"),
    )
    return Table(columns, tuple(rows))


def best(table):
    """The row with the least RMS of the blended sum."""
    return min(table.records(), key=lambda row: row["both"])


def findings(table):
    """The best N, and what happens with more directions."""
    first, found, last = table.records()[0], best(table), table.records()[-1]
    buffer = last["in the accumulation buffer"]
    return (
        f"Noise falls from {first['noise']:.4f} with {first['N']} directions to {last['noise']:.4f} with "
        f"{last['N']}. The rounding of blending grows from {first['rounding']:.4f} to "
        f"{last['rounding']:.4f}.",
        f"The blended sum is best with {found['N']} directions. It is {found['both']:.4f} from the limit: "
        f"noise {found['noise']:.4f}, rounding {found['rounding']:.4f}. The paper took 100.",
        f"With {last['N']} directions the weight is {last['weight']:.1f} steps of a byte. So most terms are "
        f"below half a step and are lost, and the mean is {last['bias']:+.4f} off. The accumulation buffer "
        f"improves further, to {buffer:.4f}.",
    )


def checks(table):
    """Noise falls, rounding grows, and between them there is a best N."""
    rows = table.records()
    noise, both = (np.array(table.column(name)) for name in ("noise", "both"))
    yield DATA.check(
        "largest growth of the noise from one N to the next, over the noise",
        float((noise[1:] / noise[:-1]).max() - 1.0),
        Answer.MACHINE,
    )
    hundred, ten = (next(r for r in rows if r["N"] == n) for n in (100, 10))
    yield DATA.check(
        "noise of 10 directions over that of 100, over sqrt(10)",
        ten["noise"] / hundred["noise"] / np.sqrt(10.0),
        Answer.MACHINE,
    )
    yield DATA.check(
        "rounding of 100 directions over that of 10", hundred["rounding"] / ten["rounding"], Answer.MACHINE
    )
    for name, row in (("first", rows[0]), ("last", rows[-1])):
        yield DATA.check(
            "RMS of the {name} N over the best's", row["both"] / float(both.min()), Answer.MACHINE, name=name
        )
    yield DATA.check(
        "the RMS of 100 directions over the best's", hundred["both"] / float(both.min()), Answer.MACHINE
    )


def plot(axes, table):
    """Noise, rounding and both together, by N."""
    (ax,) = axes
    number = table.column("N")
    for name, color, marker in (
        ("noise", BLUE, "o"),
        ("rounding", ORANGE, "s"),
        ("both", RED, "^"),
        ("in the accumulation buffer", GREEN, "v"),
    ):
        ax.plot(number, table.column(name), color=color, marker=marker, label=name)
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_xlabel("directions N, the weight 4 pi / N each")
    ax.set_ylabel("RMS (1 = full intensity)")
    ax.legend()


STUDY = Study(
    **DATA.words,
    method=(
        f"Domes of {path_sums.TEXELS} x {path_sums.TEXELS} texels, one further reflection gathered from N "
        f"directions by the machine's own passes, the weights' sum constant, beside {ALL} in float64."
    ),
    machines=path_sums.MACHINES,
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
