"""P21: zero in a byte: half of 255 is not an integer.

Source: Kautz, Seidel 2000, section 4.1 (artefact P21 of the catalogue).
"""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.passes.combiners import (
    ONE,
    SPARE0,
    negated,
    product,
    program,
    shown,
    signed,
)
from fixedpipe.effects.passes.draws import NEAREST
from fixedpipe.effects.passes.encoding import vector_texels
from fixedpipe.effects.reflectance import anisotropic_blinn_phong, material_textures
from fixedpipe.effects.studies.shared.random_frames import eq_1
from fixedpipe.effects.studies.shared.strips import drawn, strip_of_vectors
from fixedpipe.effects.studies.study import BLUE, EXPECTED, ORANGE, Column, Study, Table
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.state import PassState, TextureUnit

DATA = study_data(__file__, "P21")

# What is taken as one half where vectors are stored, and where EXPAND_NORMAL reads them.
_CONVENTIONS = ((128.0, 128.0), (127.5, 127.5), (127.5, 128.0), (128.0, 127.5))


def _dot_product(sign):
    """Combiners that show the magnitude of 4 (h.t) if it has this sign."""
    first = anisotropic_blinn_phong.combiners().general[0]
    positive = signed(SPARE0) if sign > 0 else negated(SPARE0)
    return program(first, product(positive, ONE, to=SPARE0), shown(SPARE0))


def flat_dot_product(stored_half, read_half, profile):
    """The machine's 4 (h.t) for a flat material, whose t is +x, with h = +z. If zero is exact, it is zero."""
    storing = profile.changed(expand_half=stored_half)
    reading = profile.changed(expand_half=read_half)
    material = material_textures.isotropic(1, 1, 1.0)
    loading, names = material_textures.load(material, "flat", storing)
    units = tuple(TextureUnit(name, NEAREST) for name in (names.tangent, names.binormal))
    mesh = strip_of_vectors(np.array([[0.0, 0.0, 1.0]]), storing)
    parts = []
    for sign in (1.0, -1.0):
        state = PassState(texture_units=units, register_combiners=_dot_product(sign))
        draw = Draw(label="4 (h.t)", mesh=mesh, state=state)
        parts.append(sign * drawn((*loading, draw), reading, 8, 8)[4, 4, 0])
    return float(sum(parts))


def measure(profile):
    """The table, with a row for each pair of conventions."""
    rows = []
    for stored_half, read_half in _CONVENTIONS:
        storing = profile.changed(expand_half=stored_half)
        reading = profile.changed(expand_half=read_half)
        zero = int(vector_texels(np.array(0.0), storing))
        machine, true = eq_1(0.25, 0.25, reading, storing=storing)
        lit = true > 0.0
        rows.append(
            (
                stored_half,
                read_half,
                zero,
                (2.0 * zero - 2.0 * read_half) / 255.0,
                flat_dot_product(stored_half, read_half, profile),
                root_mean_square((machine - true)[lit]),
            )
        )
    columns = (
        Column("half stored", "bytes", ".1f"),
        Column("half read", "bytes", ".1f"),
        Column("byte of zero", form="d"),
        Column("zero read", form=".4f"),
        Column("h.t that should be 0", form=".4f"),
        Column("RMS in highlight", form=".4f"),
    )
    return Table(columns, tuple(rows))


def findings(table):
    """The error because zero is not stored exactly."""
    kept, real, mixed, _ = table.records()
    return (
        f"With the half at 127.5 a stored zero reads as {real['zero read']:.4f}. The dot product of a flat "
        f"map with the vertical is then {real['h.t that should be 0']:.4f} after the factor 4, instead of "
        f"0. With the half at 128 it is {kept['h.t that should be 0']:.4f}.",
        f"Over random frames, the RMS in the highlight is {kept['RMS in highlight']:.4f} and "
        f"{real['RMS in highlight']:.4f} where storing and reading agree. Where they do not, it is "
        f"{mixed['RMS in highlight']:.4f}.",
    )


def checks(table):
    """The catalogue's numbers."""
    kept, real, mixed, other = table.records()
    return (
        DATA.check(
            "zero read with the half at 127.5, of 1/255: deviation",
            abs(real["zero read"] - 1.0 / 255.0),
            Answer.MACHINE,
        ),
        DATA.check(
            "h.t of a flat map with the half at 127.5, of .016: deviation",
            abs(real["h.t that should be 0"] - 0.016),
            Answer.MACHINE,
        ),
        DATA.check(
            "h.t of a flat map with the half at 128", abs(kept["h.t that should be 0"]), Answer.MACHINE
        ),
        DATA.check(
            "RMS in the highlight, conventions mixed / the same",
            min(mixed["RMS in highlight"], other["RMS in highlight"]) / kept["RMS in highlight"],
            Answer.MACHINE,
        ),
    )


def plot(axes, table):
    """The errors by convention."""
    flat, frames = axes
    at = np.arange(len(table.rows))
    names = [f"{r['half stored']:g}\n{r['half read']:g}" for r in table.records()]
    flat.bar(at, table.column("h.t that should be 0"), 0.6, color=BLUE, label="machine")
    flat.plot([0, 1], [0.0, 0.016], label="catalogue", **EXPECTED)
    flat.set_ylabel("4 (h.t) of a flat map, which should be 0")
    flat.set_ylim(0.0, 0.021)
    flat.legend(loc="upper left")
    frames.bar(at, table.column("RMS in highlight"), 0.6, color=ORANGE)
    frames.set_ylabel("RMS of Eq. 1 in the highlight, random frames")
    for ax in axes:
        ax.set_xticks(at, names)
        ax.set_xlabel("half of a byte where it is stored (above) and read (below)")


STUDY = Study(
    **DATA.words,
    machines=("GEFORCE_256", "GEFORCE_3", "NV2A"),
    panels=2,
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
