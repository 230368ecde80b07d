"""P27: one level of an environment map for both directions of a cylinder.

The study draws pipes like S07's, without shading: with every level set by hand, with the machine's own level,
and with filters of several probes. The reference has 256 rays for each pixel. The table has the error, and
the ratio of the changes from pixel to pixel: along the axis (below one: blur) and around the pipe (above one:
noise).

Source: Schilling 1997, section 2 (artefact P27 of the catalogue).
"""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.environment_maps.cylinder_mirrors import (
    EYE,
    FIELD,
    PIPES,
    changes,
    load,
    pipe_passes,
    sampler,
    shelves,
    supersampled,
)
from fixedpipe.effects.geometry.views import Panel, perspective_view
from fixedpipe.effects.studies.study import BLUE, GREEN, ORANGE, Column, Study, Table
from fixedpipe.pipeline.execution.machine import execute

DATA = study_data(__file__, "P27")

SIZE = 256
LEVELS = tuple(np.arange(13) / 2.0)


def _ways(profile):
    """(name, sampler) of each way; those with several probes come last."""
    for level in LEVELS:
        yield f"level {level:g}", sampler(lod=float(level))
    yield "the machine's", sampler()
    for most in (2, 4, 8):
        if profile.textures.max_probes >= most:
            yield f"{most} probes", sampler(max_probes=most)
        if profile.textures.max_anisotropy >= most:
            yield f"up to {most} : 1", sampler(max_anisotropy=float(most))


def measure(profile):
    """The table, with a row for each way."""
    view = perspective_view(Panel(0, 0, SIZE, SIZE), EYE, field_of_view=FIELD)
    picture, rows = shelves(SIZE // 2), []
    found = supersampled(view, PIPES, picture)
    truth, full = found[..., :3], found[..., 3] == 1.0
    along, round_ = changes(truth, full)
    loaded, clear = load(picture, profile), view.panel.clear((0.0, 0.0, 0.0))
    for name, read in _ways(profile):
        commands = (loaded, clear, *pipe_passes(PIPES, view, read, 64, 8))
        image = execute(commands, profile, SIZE, SIZE).image()[::-1, :, :3] / 255.0
        seen = changes(image, full)
        rows.append((name, root_mean_square((image - truth)[full]), seen[0] / along, seen[1] / round_))
    columns = (
        Column("filter"),
        Column("RMS", "of full", ".3f"),
        Column("changes along the axis", "of the truth's", ".2f"),
        Column("changes round it", "of the truth's", ".2f"),
    )
    return Table(columns, tuple(rows))


def _by_filter(table):
    return {r["filter"]: r for r in table.records()}


def _best(table):
    """The level set by hand with the smallest error."""
    return min((r for r in table.records() if r["filter"].startswith("level")), key=lambda r: r["RMS"])


def _worse(row):
    return max(abs(1.0 - row[name]) for name in ("changes along the axis", "changes round it"))


def findings(table):
    """The error of a single level, and the gain from several probes."""
    rows, best, last = _by_filter(table), _best(table), table.records()[-1]
    own, sharp = rows["the machine's"], rows["level 0"]
    return (
        f"The best level set by hand, {best['filter'].removeprefix('level ')}, is off by {best['RMS']:.3f} "
        f"(RMS). The machine's own is that of the pixel's long side, and is off by {own['RMS']:.3f}. With "
        f"probes {last['filter']}, the RMS is {last['RMS']:.3f}, {last['RMS'] / best['RMS']:.2f} of the "
        "best level's.",
        f"Level 0 preserves the changes along the axis ({sharp['changes along the axis']:.2f}). Round the "
        f"axis it has {sharp['changes round it']:.2f} times as many as there are, which is noise. The "
        f"machine's level leaves {own['changes along the axis']:.2f} of those along the axis.",
    )


def checks(table):
    """The catalogue's number, one third, and the two errors of a single level."""
    best, last = _best(table), table.records()[-1]
    yield DATA.check(
        "RMS of the most probes over the best single level's",
        last["RMS"] / best["RMS"],
        Answer.MACHINE,
        at_most=1.0 / 3.0,
    )
    least = min(_worse(r) for r in table.records() if r["filter"].startswith("level"))
    yield DATA.check(
        "each level: changes off the truth's, the worse direction, at least", least, Answer.MACHINE
    )
    yield DATA.check(
        "the most probes: changes off the truth's, the worse direction", _worse(last), Answer.MACHINE
    )


def plot(axes, table):
    """RMS and changes by level."""
    off, kept = axes
    levels = [r for r in table.records() if r["filter"].startswith("level")]
    off.plot(LEVELS, [r["RMS"] for r in levels], color=BLUE, marker="o", label="by hand")
    off.axhline(table.records()[-1]["RMS"], color=GREEN, label=table.records()[-1]["filter"])
    off.set_xlabel("level")
    off.set_ylabel("RMS from 256 rays a pixel")
    off.legend()
    kept.plot(
        LEVELS, [r["changes along the axis"] for r in levels], color=BLUE, marker="o", label="along the axis"
    )
    kept.plot(LEVELS, [r["changes round it"] for r in levels], color=ORANGE, marker="o", label="round it")
    kept.axhline(1.0, color="0.5")
    kept.set_xlabel("level")
    kept.set_ylabel("changes over the truth's")
    kept.legend()


STUDY = Study(
    **DATA.words,
    method=(
        f"Four pipes in a panorama of books at {SIZE} pixels, with levels from 0 to 6 by hand, the machine's "
        "own, and filters of several probes; beside 256 rays a pixel."
    ),
    machines=("GEFORCE_3", "NV2A", "TEXRAM"),
    panels=2,
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
