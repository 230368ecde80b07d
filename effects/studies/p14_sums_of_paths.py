"""P14: sums of many weighted paths in the framebuffer, in the accumulation buffer, and by the host.

Source: Heidrich, Daubert, Kautz, Seidel 2000, section 3.2: 40 to 100 paths (artefact P14 of the catalogue).
"""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.geometry.vectors import dot
from fixedpipe.effects.scattering import light_transport
from fixedpipe.effects.scattering.dependent_tests import Accumulation
from fixedpipe.effects.studies.shared import path_sums
from fixedpipe.effects.studies.study import BLUE, EXPECTED, GREEN, ORANGE, RED, Column, Study, Table

DATA = study_data(__file__, "P14")

# (bits, lookups along a path, paths).
CASES = ((8, 1, 40), (8, 1, 100), (8, 2, 40), (8, 2, 100), (8, 4, 100), (12, 1, 100), (12, 4, 100))
# Half a step of a byte, as an RMS: of numbers that are anywhere between two codes.
HALF_STEP = 0.5 / 255.0 / np.sqrt(3.0)


def terms(setup, paths):
    """How many of a texel's paths bring light: the mean of all texels."""
    field, visibility, total = setup.field, setup.visibility, 0.0
    for first in paths[:, 0].tolist():
        facing = dot(field.normals, visibility.directions[first]) > 0.0
        total += float((facing & (visibility.seen[first] >= 0)).mean())
    return total


def measure(profile):
    """The table, with a row for each case and kind of sum; with 12 bits if the framebuffer can have them."""
    field, rows = path_sums.domes(), []
    for bits, lookups, count in CASES:
        if bits not in profile.framebuffers.color_bits:
            continue
        setup = path_sums.setup_of(profile, field, count, bits)
        paths = light_transport.sequences(count, lookups, count)
        found = {a: path_sums.sums(setup, paths, a, bits) for a in Accumulation}
        lit = terms(setup, paths)
        law = HALF_STEP * 255.0 / (2.0**bits - 1.0) * np.sqrt(lit) / path_sums.EXPOSURE
        by_host = found[Accumulation.HOST][0]
        for accumulation, (picture, expected) in found.items():
            rows.append(
                (
                    accumulation.value,
                    bits,
                    lookups,
                    count,
                    root_mean_square(picture - expected),
                    float((picture - expected).mean()),
                    root_mean_square(picture - by_host),
                    lit,
                    float(law),
                )
            )
    columns = (
        Column("sum in"),
        Column("bits", form="d"),
        Column("K", form="d"),
        Column("paths", form="d"),
        Column("RMS", form=".5f"),
        Column("bias", form="+.5f"),
        Column("beside host", form=".5f"),
        Column("terms", form=".1f"),
        Column("law", form=".5f"),
    )
    return Table(columns, tuple(rows))


def _row(table, accumulation, bits, lookups, paths):
    wanted = accumulation.value, bits, lookups, paths
    (row,) = [r for r in table.records() if (r["sum in"], r["bits"], r["K"], r["paths"]) == wanted]
    return row


def findings(table):
    """The loss of each kind of sum, and the loss with longer paths in all of them."""
    blended, buffer, host = (_row(table, a, 8, 1, 100) for a in Accumulation)
    few = _row(table, Accumulation.FRAMEBUFFER, 8, 1, 40)
    long = _row(table, Accumulation.HOST, 8, 4, 100)
    out = [
        f"100 paths of one lookup, blended in bytes, are {blended['beside host']:.4f} (RMS) from the host's "
        f"sum of these terms. 40 paths are {few['beside host']:.4f} from it. Of 100 terms, "
        f"{blended['terms']:.0f} bring light to a texel. Half a step for each makes {blended['law']:.4f}.",
        f"The accumulation buffer is {buffer['beside host']:.5f} from the host's sum. Its sixteen bits lose "
        f"little that a byte shows. Both are {host['RMS']:.4f} from the paths in float64, because the terms "
        "are bytes.",
        f"A path of four lookups stores its light as bytes of a 64th. It is {long['RMS']:.4f} from float64 "
        f"although the host sums it; the mean is {long['bias']:+.4f} off.",
    ]
    if any(r["bits"] == 12 for r in table.records()):
        wide, wide_long = (_row(table, Accumulation.FRAMEBUFFER, 12, k, 100) for k in (1, 4))
        out.append(
            f"Blended in twelve bits, 100 paths are {wide['RMS']:.5f} from float64, "
            f"{blended['RMS'] / wide['RMS']:.0f} times nearer. Those of four lookups are "
            f"{wide_long['RMS']:.4f} from it."
        )
    return tuple(out)


def checks(table):
    """The catalogue's law for blended sums, and that the other sums lose nothing more."""
    for paths in (40, 100):
        row = _row(table, Accumulation.FRAMEBUFFER, 8, 1, paths)
        yield DATA.check(
            "RMS of {paths} blended paths to the host's sum, over half a step for each term",
            row["beside host"] / row["law"],
            Answer.MACHINE,
            paths=paths,
        )
        yield DATA.check(
            ("RMS of {paths} blended paths to the host's sum, over half a step for each term, at most"),
            row["beside host"] / row["law"],
            Answer.MACHINE,
            paths=paths,
        )
    hundred = _row(table, Accumulation.FRAMEBUFFER, 8, 1, 100)
    yield DATA.check("RMS of 100 blended paths to the host's sum", hundred["beside host"], Answer.MACHINE)
    for lookups in (1, 2, 4):
        row = _row(table, Accumulation.ACCUMULATION_BUFFER, 8, lookups, 100)
        yield DATA.check(
            "RMS of the accumulation buffer's sum of {lookups} lookups to the host's",
            row["beside host"],
            Answer.MACHINE,
            at_most=0.5 / 255.0,
            lookups=lookups,
        )
    if any(r["bits"] == 12 for r in table.records()):
        ratio = hundred["RMS"] / _row(table, Accumulation.FRAMEBUFFER, 12, 1, 100)["RMS"]
        yield DATA.check("RMS of 100 blended paths in 8 bits over that in 12", ratio, Answer.MACHINE)


def plot(axes, table):
    """The RMS of every sum, by case."""
    (ax,) = axes
    cases = list(dict.fromkeys((r["bits"], r["K"], r["paths"]) for r in table.records()))
    styles = zip(Accumulation, ((RED, "o"), (BLUE, "s"), (GREEN, "^")), strict=True)
    for accumulation, (color, marker) in styles:
        found = [_row(table, accumulation, *case)["RMS"] for case in cases]
        ax.plot(_at(cases), found, linestyle="none", color=color, marker=marker, label=accumulation.value)
    law = [_row(table, Accumulation.FRAMEBUFFER, *case)["law"] for case in cases]
    ax.plot(_at(cases), law, label="half a step for each term", **EXPECTED)
    ax.set_xticks(_at(cases), [f"{b} bits\nK = {k}\n{n} paths" for b, k, n in cases])
    ax.set_ylabel("RMS from the paths in float64")
    ax.set_yscale("log")
    ax.axhline(0.5 / 255.0, color=ORANGE, linewidth=1.0, label="half a byte's step")
    ax.legend()


def _at(cases):
    return range(len(cases))


STUDY = Study(
    **DATA.words,
    method=(
        f"Domes of {path_sums.TEXELS} x {path_sums.TEXELS} texels, paths of K lookups along as "
        "many directions as paths, by the machine's own passes, beside the same paths in float64."
    ),
    machines=path_sums.MACHINES,
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
