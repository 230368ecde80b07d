"""P13: blocks that appear if the first hit takes the indirect light of its nearest texel.

Points lie along lines across a height field, several in each texel. They get indirect light by random paths
(G03), from the nearest texel or from four texels (G04). The spectrum along the lines shows blocks. Steps at
texels' borders repeat the lower spectrum around the texels' frequency and its multiples. The lower spectrum
is the part below half of that frequency.

Source: Heidrich, Daubert, Kautz, Seidel 2000, section 3 (artefact P13 of the catalogue).
"""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.scattering import directions as sphere
from fixedpipe.effects.scattering import height_field, path_tracer, visibility
from fixedpipe.effects.scattering.path_tracer import Reconstruction
from fixedpipe.effects.studies.study import BLUE, ORANGE, Column, Study, Table

DATA = study_data(__file__, "P13")

TEXELS, POINTS_A_TEXEL, LINES = 32, 8, 24
DIRECTIONS, SAMPLES = 100, 400
LIGHT = (0.6, 0.0, 0.8)
FIELDS = {
    "domes": lambda: height_field.domes(TEXELS, TEXELS, 2),
    "bumps": lambda: height_field.bumps(TEXELS, TEXELS),
    "ridges": lambda: height_field.ridges(TEXELS, TEXELS),
}
# Source: the catalogue's.
EXPECTED_RATIO = 5.0


def lines(field, reconstruction, seed):
    """Indirect light along lines across a field, its green component, float64 [LINES, points]."""
    count = TEXELS * POINTS_A_TEXEL
    s, t = np.meshgrid((np.arange(count) + 0.5) / count, (np.arange(LINES) + 0.31) / LINES)
    found = path_tracer.indirect(
        field,
        visibility.precompute(field, sphere.spiral(DIRECTIONS)),
        s.ravel(),
        t.ravel(),
        np.array(LIGHT),
        samples=SAMPLES,
        lookups=1,
        reconstruction=reconstruction,
        seed=seed,
    )
    return found[:, 1].reshape(LINES, count)


def spectrum(field, reconstruction):
    """Energy by frequency along the lines, divided by the square of the mean: float64 [points / 2 + 1].

    The spectra of two pictures by independent random paths are multiplied. Their noise is uncorrelated, so it
    does not count.
    """
    first, second = (lines(field, reconstruction, seed) for seed in (1, 2))
    product = np.fft.rfft(first, axis=1) * np.conj(np.fft.rfft(second, axis=1))
    return product.real.mean(axis=0) / (first.mean() * second.mean()) / first.shape[1] ** 2


def at_texels(energy):
    """The energy around the texels' frequency, from half of it to one and a half of it."""
    return float(energy[TEXELS // 2 + 1 : TEXELS + TEXELS // 2].sum())


def measure(profile):
    """The table, with a row for each height field."""
    rows, curves = [], {}
    for name, made in FIELDS.items():
        field = made()
        curves |= {f"{name} {how.value}": spectrum(field, how) for how in Reconstruction}
        blocks, between = (at_texels(curves[f"{name} {how.value}"]) for how in Reconstruction)
        coarse = float(curves[f"{name} {Reconstruction.BILINEAR.value}"][1 : TEXELS // 2].sum())
        rows.append((name, 1e6 * coarse, 1e6 * blocks, 1e6 * between, blocks / between))
    columns = (
        Column("height field"),
        Column("below half the texels' frequency", "1e-6", ".0f"),
        Column("around it, nearest", "1e-6", ".1f"),
        Column("around it, bilinear", "1e-6", ".2f"),
        Column("ratio", form=".1f"),
    )
    return Table(columns, tuple(rows), curves)


def findings(table):
    """How much of the blocks remains with interpolation."""
    ratios = {r["height field"]: r["ratio"] for r in table.records()}
    least = min(ratios, key=ratios.get)
    listed = ", ".join(f"{ratio:.1f} times on {name}" for name, ratio in ratios.items())
    return (
        "Light from the nearest texel shows the texels' squares. Around their frequency it has more energy "
        f"than light between four texels: {listed}.",
        f"Interpolation leaves most on {least}, a ratio of {ratios[least]:.1f}.",
    )


def checks(table):
    """The catalogue's ratio."""
    least = min(table.column("ratio"))
    return (
        DATA.check(
            "energy around the texels' frequency, nearest over bilinear, least",
            least,
            Answer.IDEAL,
            at_least=EXPECTED_RATIO,
        ),
    )


def plot(axes, table):
    """The spectra on the domes, and all ratios."""
    by_frequency, by_field = axes
    for how, color in zip(Reconstruction, (ORANGE, BLUE), strict=True):
        energy = table.curves[f"domes {how.value}"]
        at = np.flatnonzero(energy > 0.0)
        by_frequency.semilogy(at, energy[at], color=color, marker=".", linestyle="none", label=how.value)
    by_frequency.axvline(TEXELS, color="0.5", linestyle=":", label="the texels' frequency")
    by_frequency.set_xlabel("periods along a line, domes")
    by_frequency.set_ylabel("energy over the mean's square")
    by_frequency.legend()
    by_field.bar(table.column("height field"), table.column("ratio"), color=BLUE)
    by_field.axhline(EXPECTED_RATIO, color="black", linestyle="--", label="catalogue: at least")
    by_field.set_ylabel("nearest over bilinear")
    by_field.legend()


STUDY = Study(
    **DATA.words,
    method=(
        f"Indirect light of {SAMPLES} random paths at {POINTS_A_TEXEL} points a texel, on {LINES} lines "
        f"across height fields of {TEXELS} texels; energy by frequency from two pictures of other paths, "
        "so that noise does not count."
    ),
    panels=2,
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
