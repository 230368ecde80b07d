"""P11: rings if vectors are interpolated before they are used, and blocks if nothing is interpolated.

The study draws F004-2's dome with a crease at its rim in four ways. The machine draws it (K07), also with
NEAREST. Float64 evaluates it in the machine's order, and in the order that the paper proposes (K16).

Source: Kautz, Seidel 2000, sections 5 and 6, figure 2 (artefact P11 of the catalogue).
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.rings import RING_HALF, ring_energy
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.vectors import normalize
from fixedpipe.effects.geometry.views import Light, Panel, orthographic_view
from fixedpipe.effects.passes.draws import REPEATED
from fixedpipe.effects.reflectance import (
    anisotropic_blinn_phong,
    evaluate_then_interpolate,
    material_textures,
)
from fixedpipe.effects.studies.shared.strips import drawn
from fixedpipe.effects.studies.study import BLUE, EXPECTED, GREEN, ORANGE, RED, Column, Study, Table
from fixedpipe.pipeline.enums import TextureFilter

DATA = study_data(__file__, "P11")

MAP_SIZES = (32, 64, 128)
ALPHA = 0.25
_SIZE = 512
_NEAREST = replace(REPEATED, min_filter=TextureFilter.NEAREST, mag_filter=TextureFilter.NEAREST)
# The catalogue's ring energies: interpolated before use, and evaluated before interpolation at most.
_CATALOGUED = {32: (0.2574, 7e-4), 64: (0.115, 1e-4), 128: (0.058, 1e-4)}
_BEFORE, _BEFORE_FLOAT, _AFTER, _BLOCKS = (
    "then used, machine",
    "then used, float64",
    "after use, float64",
    "not at all, machine",
)


def dome(map_size):
    """The material of F004-2's dome, of ``map_size`` texels along an edge."""
    slopes = height_fields.dome_slopes(*height_fields.texel_centers(map_size, map_size))
    return material_textures.from_slopes(*slopes, ALPHA, ALPHA)


def picture(material, profile, sampler):
    """The machine's Eq. 1 on the dome: float64 [_SIZE, _SIZE], bottom row first."""
    panel = Panel(0, 0, _SIZE, _SIZE)
    view, surface = orthographic_view(panel), surfaces.plane()
    light = Light(tuple(normalize(2.0 * RING_HALF[2] * RING_HALF - np.array([0.0, 0.0, 1.0]))))
    loading, names = material_textures.load(material, "dome", profile)
    passes = anisotropic_blinn_phong.specular_pass(
        surface, names, view, light, profile, first=True, sampler=sampler
    )
    commands = (panel.clear((0.0, 0.0, 0.0)), *loading, *passes)
    return drawn(commands, profile, _SIZE, _SIZE)[..., 0]


def blockiness(image, map_size):
    """The share of the steps from pixel to pixel that is at the texels' borders, in percent.

    A picture of blocks has 100. A picture without blocks has the borders' share of all steps.
    """
    steps = np.abs(np.diff(image, axis=1)).sum(axis=0)
    borders = np.arange(1, len(steps) + 1) % (image.shape[1] // map_size) == 0
    return 100.0 * float(steps[borders].sum() / steps.sum())


def measure(profile):
    """The table, with a row for each map and order."""
    rows, curves = [], {}
    for map_size in MAP_SIZES:
        material = dome(map_size)
        at = height_fields.texel_centers(_SIZE, _SIZE)
        images = {
            _BEFORE: picture(material, profile, REPEATED),
            _BEFORE_FLOAT: evaluate_then_interpolate.interpolate_then_evaluate(material, RING_HALF, *at),
            _AFTER: evaluate_then_interpolate.specular(material, RING_HALF, *at),
            _BLOCKS: picture(material, profile, _NEAREST),
        }
        for name, image in images.items():
            energy, brightest = ring_energy(image, map_size, ALPHA, ALPHA)
            rows.append((map_size, name, energy, brightest, blockiness(image, map_size)))
            if map_size == 64:
                curves[name] = image
    columns = (
        Column("texels an edge", form="d"),
        Column("interpolated"),
        Column("ring energy", form=".5f"),
        Column("brightest where dark", form=".3f"),
        Column("steps at borders", "%", ".1f"),
    )
    return Table(columns, tuple(rows), curves)


def _rows(table):
    return {(r["texels an edge"], r["interpolated"]): r for r in table.records()}


def _arithmetic(rows):
    """The largest relative deviation of the machine's ring energy from that of float64 in the same order."""
    return max(
        abs(rows[m, _BEFORE]["ring energy"] / rows[m, _BEFORE_FLOAT]["ring energy"] - 1.0) for m in MAP_SIZES
    )


def findings(table):
    """The rings, their cause, and another way to avoid them."""
    rows = _rows(table)
    rings = [rows[m, _BEFORE]["ring energy"] for m in MAP_SIZES]
    bits = _arithmetic(rows)
    linear, blocks = rows[64, _BEFORE], rows[64, _BLOCKS]
    afterwards = max(rows[m, _AFTER]["ring energy"] for m in MAP_SIZES)
    return (
        f"Vectors interpolated before use put part of the highlight's energy into rings: {rings[0]:.3f}, "
        f"{rings[1]:.3f} and {rings[2]:.3f} with maps of 32, 64 and 128 texels. This is within "
        f"{100 * bits:.1f} % of what float64 gives in the same order. If the model is evaluated first, it "
        f"is at most {afterwards:.5f}.",
        f"With NEAREST and 64 texels the rings hold {blocks['ring energy']:.3f}. But "
        f"{blocks['steps at borders']:.0f} % of the picture's steps from pixel to pixel lie at the texels' "
        f"borders; interpolated, {linear['steps at borders']:.0f} % do.",
    )


def checks(table):
    """The catalogue's energies (F004-2), and that NEAREST causes blocks."""
    rows = _rows(table)
    for map_size, (rings, software) in _CATALOGUED.items():
        before, after = rows[map_size, _BEFORE], rows[map_size, _AFTER]
        yield DATA.check(
            "ring energy, {map_size} texels, of {rings:g}: relative deviation",
            abs(before["ring energy"] / rings - 1.0),
            Answer.MACHINE,
            map_size=map_size,
            rings=rings,
        )
        yield DATA.check(
            "ring energy evaluated first, {map_size} texels",
            after["ring energy"],
            Answer.IDEAL,
            at_most=1.1 * software,
            map_size=map_size,
        )
        yield DATA.check(
            "brightest where the highlight is dark, {map_size} texels",
            before["brightest where dark"],
            Answer.MACHINE,
            map_size=map_size,
        )
    yield DATA.check(
        "ring energy, machine against float64 in its order: largest relative deviation",
        _arithmetic(rows),
        Answer.MACHINE,
    )
    yield DATA.check(
        "steps at texels' borders with NEAREST, 64 texels, %",
        rows[64, _BLOCKS]["steps at borders"],
        Answer.MACHINE,
    )
    yield DATA.check("the same, interpolated", rows[64, _BEFORE]["steps at borders"], Answer.MACHINE)


def plot(axes, table):
    """The dome in three orders, and the energies."""
    titles = {_BEFORE: "interpolated, then used", _AFTER: "used, then interpolated", _BLOCKS: "NEAREST"}
    for ax, (name, title) in zip(axes, titles.items(), strict=False):
        ax.imshow(table.curves[name][96:416, 192:], origin="lower", cmap="gray", vmin=0.0, vmax=1.0)
        ax.set_title(f"{title}, 64 texels", fontsize="medium")
        ax.axis("off")
    energies, rows = axes[-1], _rows(table)
    marks = {_BEFORE: (BLUE, "o"), _BLOCKS: (RED, "s"), _AFTER: (GREEN, "^"), _BEFORE_FLOAT: (ORANGE, "x")}
    for name, (color, marker) in marks.items():
        values = [max(rows[m, name]["ring energy"], 1e-6) for m in MAP_SIZES]
        line = "none" if name == _BEFORE_FLOAT else "-"
        energies.loglog(MAP_SIZES, values, color=color, marker=marker, linestyle=line, label=name)
    expected = [_CATALOGUED[m][0] for m in MAP_SIZES]
    energies.loglog(MAP_SIZES, expected, label="catalogue", **{**EXPECTED, "markersize": 10, "zorder": 0})
    energies.set_xticks(MAP_SIZES, [str(m) for m in MAP_SIZES])
    energies.minorticks_off()
    energies.set_ylim(5e-7, 1e5)
    energies.set_xlabel("texels along an edge of the map")
    energies.set_ylabel("ring energy / highlight energy (1e-6: none)")
    energies.legend(title="interpolated", loc="upper right")


STUDY = Study(
    **DATA.words,
    method=(
        f"F004-2's dome with alphas of 1/4 at {_SIZE} x {_SIZE} pixels: the energy of the error within 1.5 "
        "texels of its rim over the highlight's, and where the picture's steps lie."
    ),
    machines=("GEFORCE_256", "GEFORCE_3", "NV2A"),
    panels=4,
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
