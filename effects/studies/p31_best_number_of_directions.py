"""P31: how many directions are best where each one's light is bytes, with a weight of 4 pi / N.

Source: Heidrich, Daubert, Kautz, Seidel 2000, sections 3.3 and 6: 100 directions (artefact P31 of the
catalogue).
"""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.scattering import light_transport
from fixedpipe.effects.scattering.dependent_tests import Accumulation
from fixedpipe.effects.scattering.directions import spiral
from fixedpipe.effects.scattering.visibility import precompute
from fixedpipe.effects.studies.shared import path_sums
from fixedpipe.effects.studies.study import BLUE, GREEN, ORANGE, RED, Column, Study, Table

NUMBERS = (10, 15, 20, 30, 40, 60, 80, 100, 120, 150, 200, 300, 400)
# What stands for all directions. Assumed: noise falls with N, and these are seven times the most above.
ALL = 3000


def measure(profile):
    """A row for each number of directions."""
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
    """Where the best N is, and what happens beyond."""
    first, found, last = table.records()[0], best(table), table.records()[-1]
    buffer = last["in the accumulation buffer"]
    return (
        f"Noise falls from {first['noise']:.4f} with {first['N']} directions to {last['noise']:.4f} with "
        f"{last['N']}; what blending rounds grows from {first['rounding']:.4f} to {last['rounding']:.4f}.",
        f"The blended sum is best with {found['N']} directions, {found['both']:.4f} from the limit: noise "
        f"{found['noise']:.4f}, rounding {found['rounding']:.4f}. The paper took 100.",
        f"With {last['N']} the weight is {last['weight']:.1f} steps of a byte, so that most terms are below "
        f"half a step and lost: a mean of {last['bias']:+.4f}. The accumulation buffer goes on to "
        f"{buffer:.4f}.",
    )


def checks(table):
    """Noise falls, rounding grows, and between is a best N."""
    rows = table.records()
    noise, both = (np.array(table.column(name)) for name in ("noise", "both"))
    yield Check(
        "largest growth of the noise from one N to the next, over the noise",
        float((noise[1:] / noise[:-1]).max() - 1.0),
        at_most=0.1,
        on=Answer.MACHINE,
        reason="it falls with sqrt(N); two spirals near each other may differ a little the other way",
    )
    hundred, ten = (next(r for r in rows if r["N"] == n) for n in (100, 10))
    yield Check(
        "noise of 10 directions over that of 100, over sqrt(10)",
        ten["noise"] / hundred["noise"] / np.sqrt(10.0),
        at_least=0.8,
        on=Answer.MACHINE,
        reason="the catalogue's: noise falls with sqrt(N); even directions do better",
    )
    yield Check(
        "rounding of 100 directions over that of 10",
        hundred["rounding"] / ten["rounding"],
        at_least=1.3,
        on=Answer.MACHINE,
        reason="the catalogue's: it grows with N; terms of ten directions are bytes as well",
    )
    for name, row in (("first", rows[0]), ("last", rows[-1])):
        yield Check(
            f"RMS of the {name} N over the best's",
            row["both"] / float(both.min()),
            at_least=2.0,
            on=Answer.MACHINE,
            reason="the catalogue's: there is a best N between",
        )
    yield Check(
        "the RMS of 100 directions over the best's",
        hundred["both"] / float(both.min()),
        at_most=1.1,
        on=Answer.MACHINE,
        reason="the paper's number is as good as the best",
    )


def plot(axes, table):
    """Noise, rounding and both, by N."""
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
    id="P31",
    title="The best number of directions",
    question="With how many directions is the blended sum of scattered light nearest to that of all?",
    method=(
        f"Domes of {path_sums.TEXELS} x {path_sums.TEXELS} texels, one further reflection gathered from N "
        f"directions by the machine's own passes, the weights' sum constant, beside {ALL} in float64."
    ),
    source="HeidrichDaubertKautzSeidel2000",
    techniques=("G06", "G08", "G09", "G10"),
    machines=path_sums.MACHINES,
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
