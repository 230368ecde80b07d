"""P25: deviations filtered linearly, although only their squares add.

A machine filters the stored numbers. Between two texels or levels of D it computes the mean of D. The square
of this mean is less than the mean of K by w (1 - w) times the square of their difference. Where d_2 changes
its sign, the two cancel each other.

Source: Schilling 1997, section 8 (S18, artefact P25 of the catalogue).
"""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.bump_mapping import roughness_pyramids as rough
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.geometry import height_fields
from fixedpipe.effects.studies.shared.strips import drawn, strip
from fixedpipe.effects.studies.study import BLUE, EXPECTED, GREEN, ORANGE, Column, Study, Table
from fixedpipe.effects.texture_filtering.mipmapped_materials import texture_of_levels
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.enums import TextureEnvironmentMode, TextureFilter, WrapMode
from fixedpipe.pipeline.state import PassState, Sampler, TextureEnvironment, TextureUnit

DATA = study_data(__file__, "P25")

# Two covariances (a, b, c) of a finer and a coarser level; ridges are along both diagonals.
PAIRS = {
    "0.5 and 1.5": ((0.25, 0.0, 0.25), (2.25, 0.0, 2.25)),
    "0.5 and 1": ((0.25, 0.0, 0.25), (1.0, 0.0, 1.0)),
    "0 and 1": ((0.0, 0.0, 0.0), (1.0, 0.0, 1.0)),
    "1 and 1": ((1.0, 0.0, 1.0), (1.0, 0.0, 1.0)),
    "ridges / and \\": ((1.0, 0.9, 1.0), (1.0, -0.9, 1.0)),
}
# What one stands for in bytes.
_DEVIATION = 2.0
# Places between the levels: quarters of a level, and finer ones for a plot.
_STEPS = 32
# Stones of a pyramid of so many texels, as high as a fiftieth of its edge is long.
_EDGE, _RELIEF = 256, 0.02


def between_levels(pair, part, profile):
    """The machine's trilinear filter of D at the fraction ``part`` of the way between two levels that have D
    in bytes: float64 [3].

    The buffer's components have 16 bits, so the rounding of bytes does not hide the filter.
    """
    stored = [rough.deviation_bytes(rough.deviations(np.array(k)), _DEVIATION) for k in pair]
    images = [np.tile(codes, (edge, edge, 1)) for codes, edge in zip(stored, (2, 1), strict=True)]
    filters = TextureFilter.LINEAR_MIPMAP_LINEAR, TextureFilter.LINEAR
    read = Sampler(*filters, WrapMode.REPEAT, WrapMode.REPEAT, min_lod=part, max_lod=part)
    replaced = TextureEnvironment(TextureEnvironmentMode.REPLACE)
    commands = (
        TexImage(label="D of two levels", texture="D", image=texture_of_levels(images)),
        Draw(
            label="D between them",
            mesh=strip(1, None, np.full((1, 2), 0.5)),
            state=PassState(texture_units=(TextureUnit("D", read, environment=replaced),)),
        ),
    )
    color = drawn(commands, profile.with_precision(framebuffer_bits=16), 8, 8)[4, 4]
    return rough.deviations_of_bytes(255.0 * color, _DEVIATION)


def along_u(pair, part):
    """The variance along u by K and by D, at the fraction ``part`` between two levels, in floats."""
    first, second = (np.array(k) for k in pair)
    by_k = first * (1.0 - part) + second * part
    d = rough.deviations(first) * (1.0 - part) + rough.deviations(second) * part
    return float(by_k[0]), float(rough.covariance_of(d)[0])


def _low(found, right):
    return 100.0 * (1.0 - found / right)


def _of_stones():
    """Rows for a pyramid of stones: the loss of D midway between two levels, at the texels of the coarser
    level.
    """
    stones = height_fields.pebbles(_EDGE, _EDGE, 24, 7)
    levels = rough.from_heights(_RELIEF * stones / stones.max())
    for number in range(5):
        finer, coarser = levels[number], levels[number + 1]
        s, t = height_fields.texel_centers(*coarser.offsets.shape[:2])
        d = rough.trilinear([finer.deviations, coarser.deviations], s, t, 0.5)
        k = rough.trilinear([finer.covariance, coarser.covariance], s, t, 0.5)
        by_k, by_d = (float(x[..., 0].mean()) for x in (k, rough.covariance_of(d)))
        yield (f"stones, levels {number}, {number + 1}", by_k, by_d, _low(by_d, by_k), None)


def measure(profile):
    """The table, with a row for each pair, midway, and for each two levels of stones."""
    rows, curves = [], {"part": np.arange(_STEPS + 1) / _STEPS}
    for name, pair in PAIRS.items():
        by_k, by_d = along_u(pair, 0.5)
        seen = float(rough.covariance_of(between_levels(pair, 0.5, profile))[0])
        rows.append((name, by_k, by_d, _low(by_d, by_k), _low(seen, by_k)))
    for name in ("0.5 and 1.5", "ridges / and \\"):
        curves[f"{name}, K"] = np.array([along_u(PAIRS[name], p)[0] for p in curves["part"]])
        curves[name] = np.array(
            [rough.covariance_of(between_levels(PAIRS[name], float(p), profile))[0] for p in curves["part"]]
        )
    columns = (
        Column("between"),
        Column("variance by K", form=".3f"),
        Column("by D", form=".3f"),
        Column("low", "%", ".1f"),
        Column("low on the machine", "%", ".1f"),
    )
    return Table(columns, (*rows, *_of_stones()), curves)


def findings(table):
    """The variance that is lost midway, between different signs, and in a pyramid of stones."""
    row = {r["between"]: r for r in table.records()}
    plain, ridges = row["0.5 and 1.5"], row["ridges / and \\"]
    nothing = row["0 and 1"]
    stones = [r for name, r in row.items() if name.startswith("stones")]
    most = max(stones[1:], key=lambda r: r["low"])
    where = most["between"].removeprefix("stones, levels ").replace(", ", " and ")
    return (
        f"Midway between deviations of 0.5 and 1.5 the variance is {plain['variance by K']:.2f}. The square "
        f"of D's mean is {plain['by D']:.2f}, {plain['low']:.0f} % low. On the machine, whose D has bytes, "
        f"it is {plain['low on the machine']:.1f} % low.",
        f"Where a level has no roughness yet and the next one has, {nothing['low']:.0f} % is lost midway. "
        "The lost part is w (1 - w) times the square of the difference.",
        "Ridges along one diagonal next to ridges along the other have d_2 of opposite signs, which cancel. "
        f"The variance along u is {ridges['low on the machine']:.0f} % low, though it is 1 in both.",
        f"In a pyramid of stones, {stones[0]['low']:.0f} % is lost between levels 0 and 1, because level 0 "
        f"has no roughness. {most['low']:.0f} % is lost between {where}, and {stones[-1]['low']:.0f} % "
        "between 4 and 5, whose texels are alike.",
    )


def checks(table):
    """The catalogue's number, and the formula at every place."""
    row = {r["between"]: r for r in table.records()}
    yield DATA.check(
        "variance midway between deviations of 0.5 and 1.5, % low, of 20: deviation",
        abs(row["0.5 and 1.5"]["low"] - 20.0),
        Answer.IDEAL,
    )
    yield DATA.check(
        "the same on the machine", abs(row["0.5 and 1.5"]["low on the machine"] - 20.0), Answer.MACHINE
    )
    # A second way: the loss as a formula, the machine's at every place.
    part = table.curves["part"]
    lost = table.curves["0.5 and 1.5, K"] - table.curves["0.5 and 1.5"]
    yield DATA.check(
        "variance lost - w (1 - w) (1.5 - 0.5)^2, largest",
        np.abs(lost - part * (1.0 - part)).max(),
        Answer.MACHINE,
    )
    yield DATA.check(
        "variance along u between ridges, % low, of 81: deviation",
        abs(row["ridges / and \\"]["low on the machine"] - 81.0),
        Answer.MACHINE,
    )
    yield DATA.check("variance lost between equal levels, %", abs(row["1 and 1"]["low"]), Answer.IDEAL)


def plot(axes, table):
    """The variance along u from one level to the other, and the loss in a pyramid."""
    way, stones = axes
    part = table.curves["part"]
    for name, color in (("0.5 and 1.5", BLUE), ("ridges / and \\", ORANGE)):
        way.plot(part, table.curves[name], color=color, label=f"D, {name}")
        way.plot(part, table.curves[f"{name}, K"], label="K" if color == BLUE else None, **EXPECTED)
    way.set_xlabel("place between two levels")
    way.set_ylabel("variance along u")
    way.legend()
    rows = [r for r in table.records() if r["between"].startswith("stones")]
    stones.bar(range(len(rows)), [r["low"] for r in rows], color=GREEN)
    stones.set_xticks(range(len(rows)), [r["between"].removeprefix("stones, levels ") for r in rows])
    stones.set_xlabel("levels of a pyramid of stones, midway")
    stones.set_ylabel("variance is low by, %")


STUDY = Study(
    **DATA.words,
    method=(
        "D of two levels, in bytes over 2, filtered trilinearly by the machine midway between them; the "
        "variance along u that comes out, beside the mean of both K. And a pyramid of stones, "
        f"{_EDGE} texels wide, midway between its levels, in floats."
    ),
    machines=("GEFORCE_3", "NV2A", "TEXRAM"),
    panels=2,
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
