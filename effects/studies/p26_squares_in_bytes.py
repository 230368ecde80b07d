"""P26: roughness stored as squares in bytes, and as deviations.

A byte of K over its largest has steps of 1/255 in sigma^2. So the smallest sigma above zero is 1/sqrt(255) of
the largest, and steps are coarse around it. A byte of D has steps of 1/255 in sigma. The signed d_2 has steps
of 1/127.

Source: Schilling 1997, section 8 (S16, S18, artefact P26 of the catalogue).
"""

import math

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.bump_mapping import roughness_pyramids as rough
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.geometry import height_fields
from fixedpipe.effects.passes.draws import NEAREST
from fixedpipe.effects.studies.shared.strips import drawn, strip
from fixedpipe.effects.studies.study import BLUE, EXPECTED, ORANGE, Column, Study, Table
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.enums import TextureEnvironmentMode
from fixedpipe.pipeline.state import PassState, TextureEnvironment, TextureUnit
from fixedpipe.pipeline.textures.images import texture_2d

DATA = study_data(__file__, "P26")

# Deviations over the largest; 0.05 is the catalogue's.
SIGMAS = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0)
# Deviations of the curves, so many from 0 to 0.2.
_STEPS, _FARTHEST = 256, 0.2
# Stones of a pyramid of so many texels, as high as a fiftieth of its edge is long.
_EDGE, _RELIEF = 256, 0.02


def squares(sigma):
    """K, the squares of deviations, in bytes: uint8."""
    return np.floor(255.0 * np.asarray(sigma, np.float64) ** 2 + 0.5).astype(np.uint8)


def deviations(sigma):
    """D in bytes: uint8."""
    return rough.deviation_bytes(np.stack([sigma, 0.0 * sigma, sigma], axis=-1), 1.0)[..., 0]


def read(sigma, profile):
    """Deviations that a machine reads from K and from D in bytes: float64 [n] each."""
    sigma = np.asarray(sigma, np.float64)
    codes = np.stack([squares(sigma), deviations(sigma), 0 * deviations(sigma)], axis=-1)
    count = len(sigma)
    replaced = TextureEnvironment(TextureEnvironmentMode.REPLACE)
    edge = 1 << (count - 1).bit_length()
    image = np.zeros((1, edge, 3), np.uint8)
    image[0, :count] = codes
    place = np.stack([(np.arange(count) + 0.5) / edge, np.full(count, 0.5)], axis=-1)
    commands = (
        TexImage(label="K and D", texture="bytes", image=texture_2d(image)),
        Draw(
            label="what is read of them",
            mesh=strip(count, None, place),
            state=PassState(texture_units=(TextureUnit("bytes", NEAREST, environment=replaced),)),
        ),
    )
    color = drawn(commands, profile, count, 4)[2]
    return np.sqrt(color[:, 0]), color[:, 1]


def _of_stones():
    """Rows for the levels of stones: the share of rough texels that are smooth in bytes of K and D, and the
    remaining errors of I_1, divided by the level's mean.

    For both K and D, 1.0 is the largest number of the whole pyramid.
    """
    stones = height_fields.pebbles(_EDGE, _EDGE, 24, 7)
    levels = rough.from_heights(_RELIEF * stones / stones.max())
    most_k = max(float(np.abs(level.covariance).max()) for level in levels)
    most_d = max(float(np.abs(level.deviations).max()) for level in levels)
    for number, level in enumerate(levels[1:6], 1):
        right = rough.largest_deviation(level.covariance)
        a, b, c = (level.covariance[..., k] / most_k for k in range(3))
        kept = [
            np.floor(255.0 * a + 0.5) / 255.0,
            np.round(127.0 * b) / 127.0,
            np.floor(255.0 * c + 0.5) / 255.0,
        ]
        by_k = rough.largest_deviation(most_k * np.stack(kept, axis=-1))
        codes = rough.deviation_bytes(level.deviations, most_d)
        d = rough.covariance_of(rough.deviations_of_bytes(codes, most_d))
        by_d = rough.largest_deviation(d)
        rows = []
        for found in (by_k, by_d):
            off = float(np.sqrt(((found - right) ** 2).mean())) / float(right.mean())
            rows += [100.0 * float((found == 0.0)[right > 0.0].mean()), 100.0 * off]
        yield number, *rows


def measure(profile):
    """The table, with a row for each deviation, and one for each level of stones."""
    found = zip(SIGMAS, *read(np.array(SIGMAS), profile), strict=True)
    rows = []
    for sigma, *stored in found:
        k, d = map(float, stored)
        off_k, off_d = (100.0 * (value / sigma - 1.0) for value in (k, d))
        rows.append((f"sigma {sigma:g}", k, off_k, d, off_d, None, None))
    for number, lost_k, off_k, lost_d, off_d in _of_stones():
        rows.append((f"stones, level {number}", None, off_k, None, off_d, lost_k, lost_d))
    columns = (
        Column("what"),
        Column("read of K", form=".4f"),
        Column("error of K", "%", ".1f"),
        Column("read of D", form=".4f"),
        Column("error of D", "%", ".1f"),
        Column("lost in K", "%", ".1f"),
        Column("lost in D", "%", ".1f"),
    )
    sigma = np.linspace(0.0, _FARTHEST, _STEPS)
    curves = dict(zip(("sigma", "K", "D"), (sigma, *read(sigma, profile)), strict=True))
    return Table(columns, tuple(rows), curves)


def _smallest(table, what):
    """The smallest deviation above zero in bytes of ``what``."""
    held = table.curves[what]
    return float(held[held > 0.0].min())


def findings(table):
    """The smallest roughness in K and in D, and the loss for stones."""
    row = {r["what"]: r for r in table.records()}
    least_k, least_d = _smallest(table, "K"), _smallest(table, "D")
    at = row["sigma 0.05"]
    small = row["sigma 0.02"]
    fine, coarse = row["stones, level 1"], row["stones, level 5"]
    return (
        f"The smallest sigma above zero that a byte of K holds is {least_k:.4f} of the largest; for D it is "
        f"{least_d:.4f}. K makes everything below {math.sqrt(0.5 / 255.0):.3f} smooth, for instance "
        f"{small['what']}.",
        f"A sigma of 0.05 is read as {at['read of K']:.4f} from K ({at['error of K']:+.0f} %) and as "
        f"{at['read of D']:.4f} from D ({at['error of D']:+.1f} %). D's steps are "
        f"{100.0 / 255.0 / 0.05:.1f} % of it there.",
        f"At level 1 of stones, K in bytes makes {fine['lost in K']:.0f} % of the rough texels smooth, D "
        f"{fine['lost in D']:.0f} %. I_1 is off by {fine['error of K']:.1f} and {fine['error of D']:.1f} % "
        f"of its mean (RMS). At level 5, whose texels are alike, it is off by {coarse['error of K']:.1f} "
        f"and {coarse['error of D']:.1f} %.",
    )


def checks(table):
    """The catalogue's numbers for the values that are read."""
    row = {r["what"]: r for r in table.records()}
    least = _smallest(table, "K")
    yield DATA.check(
        "smallest sigma in bytes of K, of 0.0626: deviation", abs(least - 0.0626), Answer.MACHINE
    )
    held = np.unique(table.curves["D"])
    step = float(np.diff(held).max()) / 0.05
    yield DATA.check("a step of D over 0.05, of 0.08: deviation", abs(step - 0.08), Answer.MACHINE)
    yield DATA.check("sigma 0.02 as K in bytes", row["sigma 0.02"]["read of K"], Answer.MACHINE)
    worst = max(abs(r["error of D"]) * float(r["what"].split()[1]) for r in table.records()[: len(SIGMAS)])
    yield DATA.check(
        "sigma read of D - sigma, largest, in steps",
        worst / 100.0 * 255.0,
        Answer.MACHINE,
        at_most=0.5 + 1e-9,
    )
    first = row["stones, level 1"]
    yield DATA.check(
        "error of I_1 of stones, level 1, K's over D's",
        first["error of K"] / first["error of D"],
        Answer.IDEAL,
    )


def plot(axes, table):
    """The values read from bytes by the stored values, and their error."""
    seen, off = axes
    sigma = table.curves["sigma"]
    for name, color in (("K", ORANGE), ("D", BLUE)):
        seen.plot(sigma, table.curves[name], color=color, label=f"{name} in bytes")
        off.plot(sigma[1:], 100.0 * (table.curves[name][1:] / sigma[1:] - 1.0), color=color, label=name)
    seen.plot(sigma[::16], sigma[::16], label="as it was", **EXPECTED)
    seen.set_ylabel("sigma as it is read")
    off.set_ylabel("error, %")
    off.set_ylim(-110.0, 110.0)
    for ax in axes:
        ax.set_xlabel("sigma, over the largest")
        ax.legend()


STUDY = Study(
    **DATA.words,
    method=(
        "Texels of K and of D in bytes, over the largest, read by the machine; and a pyramid of stones, "
        f"{_EDGE} texels wide, as bytes of either and back: how many rough texels become smooth, and how far "
        "I_1 is off, RMS over its mean."
    ),
    machines=("GEFORCE_3", "NV2A", "TEXRAM"),
    panels=2,
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
