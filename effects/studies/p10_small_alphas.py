"""P10: alphas below 1/4 do not fit the stored vectors.

Source: Kautz, Seidel 2000, section 4.1 (artefact P10 of the catalogue).
"""

import warnings

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.passes.draws import NEAREST
from fixedpipe.effects.passes.encoding import vector_texels, vectors_of_texels
from fixedpipe.effects.reflectance import anisotropic_blinn_phong, brdfs, material_textures
from fixedpipe.effects.studies.shared.random_frames import random_directions
from fixedpipe.effects.studies.shared.strips import drawn, strip_of_vectors
from fixedpipe.effects.studies.study import BLUE, EXPECTED, GREEN, ORANGE, RED, Column, Study, Table
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.state import PassState, TextureUnit

DATA = study_data(__file__, "P10")

ALPHAS = (0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 0.75, 1.0)
# Halfway vectors across the highlight, and random tangents.
_STEPS, _TANGENTS = 256, 4096


def highlight(alpha, profile):
    """The machine's Eq. 1 along t: h.t of the halfway vectors in the vertex colours, and the values."""
    material = material_textures.isotropic(1, 1, alpha)
    with warnings.catch_warnings():
        # Alphas that are stored as larger ones are what is measured.
        warnings.simplefilter("ignore", material_textures.StoredAlpha)
        loading, names = material_textures.load(material, "flat", profile)
    sines = np.arange(_STEPS) / _STEPS
    half = np.stack([sines, 0.0 * sines, np.sqrt(1.0 - sines * sines)], axis=-1)
    units = tuple(TextureUnit(name, NEAREST) for name in (names.tangent, names.binormal))
    state = PassState(texture_units=units, register_combiners=anisotropic_blinn_phong.combiners())
    command = Draw(label="Eq. 1", mesh=strip_of_vectors(half, profile), state=state)
    values = drawn((*loading, command), profile, _STEPS, 8)[4, :, 0]
    return vectors_of_texels(vector_texels(half, profile), profile)[:, 0], values


def half_width(sines, values):
    """h.t where a highlight falls to one half: between the last sample above it and the first below it."""
    last = int(np.nonzero(values >= 0.5)[0][-1])
    return float(0.5 * (sines[last] + sines[last + 1]))


def direction_errors(alpha, profile):
    """Angles in degrees between random tangents and those read back from t / (4 alpha); and which of them
    were clamped.

    t / (4 alpha) is stored without limiting alpha to 1/4 or more, so a component may be clamped.
    """
    tangents = random_directions(_TANGENTS, 13)
    wanted = material_textures.STORAGE_SCALE * tangents / alpha
    read = normalize(vectors_of_texels(vector_texels(wanted, profile), profile))
    angles = np.degrees(np.arccos(np.clip(dot(read, tangents), -1.0, 1.0)))
    return angles, np.abs(wanted).max(axis=-1) > 1.0


def measure(profile):
    """The table, with a row for each requested alpha."""
    rows, curves = [], {}
    for alpha in ALPHAS:
        sines, values = highlight(alpha, profile)
        angles, cut = direction_errors(alpha, profile)
        rows.append(
            (
                alpha,
                half_width(sines, values),
                float(brdfs.half_width(max(alpha, material_textures.SMALLEST_ALPHA))),
                float(brdfs.half_width(alpha)),
                float(angles.mean()),
                float(angles.max()),
                100.0 * float(cut.mean()),
            )
        )
        curves[f"{alpha:g}"] = np.stack([sines, values])
    columns = (
        Column("alpha", form=".2f"),
        Column("half width, machine", "h.t", ".4f"),
        Column("alpha held at 1/4", "h.t", ".4f"),
        Column("Eq. 1 wants", "h.t", ".4f"),
        Column("direction, mean", "degrees", ".2f"),
        Column("direction, largest", "degrees", ".2f"),
        Column("vectors cut", "%", ".1f"),
    )
    return Table(columns, tuple(rows), curves)


def findings(table):
    """The alpha where the highlight stops shrinking, and the cost of an alpha without the limit."""
    row = {r["alpha"]: r for r in table.records()}
    narrow, held = row[0.1], row[0.25]
    return (
        f"For alphas of 0.1 and 0.25, Eq. 1 requires half widths of {narrow['Eq. 1 wants']:.4f} and "
        f"{held['Eq. 1 wants']:.4f}. The machine draws {narrow['half width, machine']:.4f} and "
        f"{held['half width, machine']:.4f}.",
        f"If an alpha of 0.1 is stored all the same, {narrow['vectors cut']:.1f} % of random vectors lose "
        f"part of a component. They point {narrow['direction, mean']:.1f} degrees aside in the mean, "
        f"{narrow['direction, largest']:.1f} at most. With 0.25 it is {held['direction, largest']:.1f} at "
        "most.",
    )


def checks(table):
    """The catalogue's numbers."""
    worst = max(abs(r["half width, machine"] / r["alpha held at 1/4"] - 1.0) for r in table.records())
    (narrow,) = [r for r in table.records() if r["alpha"] == 0.1]
    return (
        DATA.check(
            "half width against max(alpha, 1/4) sqrt(1/2): largest relative deviation", worst, Answer.MACHINE
        ),
        DATA.check(
            "degrees aside in the mean at alpha 0.1, of 14.4: deviation",
            abs(narrow["direction, mean"] - 14.4),
            Answer.MACHINE,
        ),
        DATA.check(
            "degrees aside at most at alpha 0.1, of 21.6: deviation",
            abs(narrow["direction, largest"] - 21.6),
            Answer.MACHINE,
        ),
        DATA.check("vectors cut at alpha 0.1, %", narrow["vectors cut"], Answer.MACHINE),
    )


def plot(axes, table):
    """The half width by alpha, and the directions of clamped vectors."""
    width, aside = axes
    alphas = table.column("alpha")
    width.plot(alphas, table.column("Eq. 1 wants"), color=ORANGE, linestyle="--", label="Eq. 1")
    width.plot(alphas, table.column("half width, machine"), color=BLUE, marker="o", label="machine")
    width.plot(alphas, table.column("alpha held at 1/4"), label="catalogue: alpha held at 1/4", **EXPECTED)
    width.set_xlabel("alpha asked for")
    width.set_ylabel("half width of the highlight, h.t at half the peak")
    width.set_xlim(0.0, 1.05)
    width.set_ylim(bottom=0.0)
    width.legend()
    aside.plot(alphas, table.column("direction, largest"), color=RED, marker="o", label="largest")
    aside.plot(alphas, table.column("direction, mean"), color=GREEN, marker="s", label="mean")
    aside.plot([0.1, 0.1], [14.4, 21.6], label="catalogue", **EXPECTED)
    aside.set_xlabel("alpha of vectors stored as t / (4 alpha)")
    aside.set_ylabel("angle to the tangent they stand for, degrees")
    aside.set_xlim(0.0, 1.05)
    aside.set_ylim(bottom=0.0)
    aside.legend()


STUDY = Study(
    **DATA.words,
    method=(
        f"Eq. 1 on the machine under {_STEPS} halfway vectors across the highlight of a flat material; and "
        f"what is read back of {_TANGENTS} random tangents stored with their own alpha."
    ),
    machines=("GEFORCE_256", "GEFORCE_3", "NV2A"),
    panels=2,
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
