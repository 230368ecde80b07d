"""P18: Ward's model in colours of [0, 1]: its factor and its square root exceed this range.

Source: Kautz, Seidel 2000, section 3.3 (artefact P18, pass sequence A-K09 of the catalogue).
"""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.passes.draws import NEAREST
from fixedpipe.effects.reflectance import brdfs
from fixedpipe.effects.studies.shared.strips import drawn, strip
from fixedpipe.effects.studies.study import BLUE, EXPECTED, ORANGE, Column, Study, Table
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.enums import TextureEnvironmentMode
from fixedpipe.pipeline.pixel_transfer import PixelImage
from fixedpipe.pipeline.state import PassState, TextureEnvironment, TextureUnit

DATA = study_data(__file__, "P18")

ALPHAS = (0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 1.0)
# S(p) = 1/sqrt(p) is stored divided by this (A-K09 of the catalogue); its texels are evenly spaced in p.
LARGEST_S = 8.0
_TEXELS = 256


def stored(values, profile):
    """The values that a machine reads after loading float64 [n, k] as a luminance texture of n texels: [n, k]
    in [0, 1].
    """
    found = []
    for column in values.T:
        image = PixelImage(np.repeat(column[None, :, None], 3, axis=2), "RGB")
        environment = TextureEnvironment(TextureEnvironmentMode.REPLACE)
        coordinates = np.stack([(np.arange(len(column)) + 0.5) / len(column), 0.5 + 0.0 * column], axis=-1)
        commands = (
            TexImage(label="load the table", texture="table", pixels=image),
            Draw(
                label="the table, a texel for each pixel",
                mesh=strip(len(column), coordinates=coordinates),
                state=PassState(texture_units=(TextureUnit("table", NEAREST, environment=environment),)),
            ),
        )
        found.append(drawn(commands, profile, len(column), 8)[4, :, 0])
    return np.stack(found, axis=-1)


def measure(profile):
    """The table, with a row for each alpha, the same along both axes: the true factor, and the stored one."""
    wanted = np.array([brdfs.ward_scale(alpha, alpha) for alpha in ALPHAS])
    padded = np.concatenate([wanted, np.zeros(16 - len(wanted))])
    kept = stored(padded[:, None], profile)[: len(wanted), 0]
    rows = tuple(
        (alpha, alpha * alpha, float(w), float(k), 100.0 * float(max(0.0, 1.0 - k / w)))
        for alpha, w, k in zip(ALPHAS, wanted, kept, strict=True)
    )
    columns = (
        Column("alpha_x = alpha_y", form=".2f"),
        Column("product", form=".4f"),
        Column("1 / (4 pi ax ay)", form=".3f"),
        Column("stored", form=".3f"),
        Column("lost", "%", ".1f"),
    )
    p = (np.arange(_TEXELS) + 0.5) / _TEXELS
    s = brdfs.ward_s(p)
    table = LARGEST_S * stored((s / LARGEST_S)[:, None], profile)[:, 0]
    return Table(columns, rows, {"p": p, "S": s, "S stored": table})


def _clamped_below(table):
    """The p below which the table of S has its largest value: the middle between the last texel with this
    value and the first without it.
    """
    p, cut = table.curves["p"], table.curves["S"] > LARGEST_S
    full = table.curves["S stored"] >= LARGEST_S
    return float(p[full].max()), int(cut.sum())


def findings(table):
    """The alpha and the p at which the colours' range ends."""
    lost = [r for r in table.records() if r["1 / (4 pi ax ay)"] > 1.0]
    edge = max(r["product"] for r in lost)
    (narrow,) = (r for r in lost if r["alpha_x = alpha_y"] == 0.1)
    largest, _ = _clamped_below(table)
    error = np.abs(table.curves["S stored"] - table.curves["S"])
    kept = table.curves["S"] < LARGEST_S
    return (
        f"Up to a product of {edge:.4f} the factor is above 1 and is stored as "
        f"{max(r['stored'] for r in lost):.0f}. At alphas of 0.1 it should be "
        f"{narrow['1 / (4 pi ax ay)']:.2f}, and {narrow['lost']:.0f} % is lost.",
        f"A table of S(p) / 8 with {_TEXELS} texels is at its maximum up to p = {largest:.4f}. Elsewhere it "
        f"is within {error[kept].max():.3f} of S. Its first texel should be {table.curves['S'][0]:.1f}.",
    )


def checks(table):
    """The catalogue's numbers."""
    row = {r["alpha_x = alpha_y"]: r for r in table.records()}
    over = [r["product"] for r in table.records() if r["stored"] >= 1.0]
    under = [r["product"] for r in table.records() if r["stored"] < 1.0]
    largest, count = _clamped_below(table)
    return (
        DATA.check(
            "factor at 0.25, of 1.27: deviation", abs(row[0.25]["1 / (4 pi ax ay)"] - 1.27), Answer.IDEAL
        ),
        DATA.check(
            "factor at 0.1, of 7.96: deviation", abs(row[0.1]["1 / (4 pi ax ay)"] - 7.96), Answer.IDEAL
        ),
        DATA.check("largest factor that is stored", max(table.column("stored")), Answer.MACHINE),
        DATA.check("largest product that is stored as 1", max(over), Answer.MACHINE),
        DATA.check("smallest product that is stored as less", min(under), Answer.MACHINE),
        DATA.check("p up to which S is clamped", largest, Answer.MACHINE, at_most=1.0 / 64.0),
        DATA.check(
            "largest S that is stored",
            float(table.curves["S stored"].max()),
            Answer.MACHINE,
            at_most=LARGEST_S,
        ),
        DATA.check("texels of S that are clamped", float(count), Answer.MACHINE, at_least=_TEXELS / 64.0),
    )


def plot(axes, table):
    """The factor by alpha, and S by p."""
    factors, s = axes
    alphas = table.column("alpha_x = alpha_y")
    factors.loglog(alphas, table.column("1 / (4 pi ax ay)"), color=ORANGE, linestyle="--", label="float64")
    factors.loglog(alphas, table.column("stored"), color=BLUE, marker="o", label="stored on the machine")
    factors.loglog([0.25, 0.1], [1.27, 7.96], label="catalogue", **EXPECTED)
    factors.axvline(0.0796**0.5, color="black", linestyle=":", linewidth=1, label="catalogue: 1 at 0.282")
    factors.set_xlabel("alpha_x = alpha_y")
    factors.set_ylabel("1 / (4 pi alpha_x alpha_y)")
    factors.set_xticks([0.05, 0.1, 0.2, 0.5, 1.0], ["0.05", "0.1", "0.2", "0.5", "1"])
    factors.legend()
    s.plot(table.curves["p"], table.curves["S"], color=ORANGE, linestyle="--", label="S(p) = 1 / sqrt(p)")
    s.plot(table.curves["p"], table.curves["S stored"], color=BLUE, label="stored / 8, read on the machine")
    s.plot([1.0 / 64.0], [8.0], label="catalogue: clamped below 1/64", **EXPECTED)
    s.set_xlabel("p = (l.n)(v.n)")
    s.set_ylabel("S")
    s.set_xlim(0.0, 0.1)
    s.legend()


STUDY = Study(
    **DATA.words,
    method=(
        f"Both loaded as textures and drawn texel for pixel: the factor for k_s = 1, and {_TEXELS} values of "
        "S / 8."
    ),
    machines=("OCTANE", "INFINITE_REALITY", "OPENGL_1_2", "GEFORCE_256", "GEFORCE_3"),
    panels=2,
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
