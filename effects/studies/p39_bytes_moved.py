"""P39: the bytes that the Octane moves for a model that a GeForce 256 draws in one pass, or cannot draw.

Source: Kautz, Seidel 2000, sections 4.2 and 5 (artefact P39 of the catalogue).
"""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.views import Light, Panel, orthographic_view
from fixedpipe.effects.reflectance import (
    anisotropic_blinn_phong,
    blinn_phong_by_host,
    imaging_subset,
    material_textures,
    pixel_textures,
)
from fixedpipe.effects.studies.shared.traffic import counted
from fixedpipe.effects.studies.study import BLUE, GREEN, ORANGE, Column, Study, Table
from fixedpipe.pipeline.profiles import GEFORCE_256, OCTANE

DATA = study_data(__file__, "P39")

SIZE = 256
_LIGHTS = (Light((0.5, 0.4, 0.77)), Light((0.4, 0.5, 0.77)))
_PANEL = Panel(0, 0, SIZE, SIZE)
_VIEW = orthographic_view(_PANEL)
# Source: Kautz, Seidel 2000, section 6: 15 to 25 frames a second.
_HERTZ = 20


def _material():
    heights = height_fields.smooth(height_fields.pebbles(SIZE, SIZE, 12, 5), 2) * 0.2
    return material_textures.from_slopes(*height_fields.slopes(heights), 0.25, 0.5)


def _combiners(material, light):
    """K07 on the GeForce 256: the material textures, then one pass."""
    loading, names = material_textures.load(material, "pebbles", GEFORCE_256)
    passes = anisotropic_blinn_phong.specular_pass(
        surfaces.plane(), names, _VIEW, light, GEFORCE_256, first=True
    )
    return (*loading[1:], *passes)  # the normal map is the diffuse pass's


def _imaging_subset(material, light):
    """K08 on the Octane, one polygon."""
    square = imaging_subset.prepare(surfaces.plane(), material, _VIEW, OCTANE, triangles_per_polygon=2)
    return imaging_subset.specular_passes(square, material, light)


def _through_the_host(material, light):
    """K05 on the GeForce 256: the host reads pixels back and looks up their values."""
    loading, names = material_textures.load(material, "pebbles", GEFORCE_256)
    passes = blinn_phong_by_host.blinn_phong(surfaces.plane(), names, _VIEW, light, GEFORCE_256)
    return (*loading[1:], *passes)


def _on_octane(model, **arguments):
    def commands(material, light):
        return model(surfaces.plane(), material, _VIEW, light, OCTANE, **arguments)

    return commands


EFFECTS = {
    "K07 GeForce 256": _combiners,
    "K08 Octane": _imaging_subset,
    "K05 Octane": _on_octane(pixel_textures.blinn_phong),
    "K05 GeForce 256": _through_the_host,
    "K03 Octane": _on_octane(pixel_textures.banks),
    "K09 Octane": _on_octane(pixel_textures.ward),
}


def measure(_):
    """The table, with a row for each effect."""
    material, rows = _material(), []
    for name, commands in EFFECTS.items():
        count = counted(*(commands(material, light) for light in _LIGHTS))
        loaded, read = count["loaded"] + count["vertices"] + count["drawn"], count["read"]
        total = loaded + read + count["copied"]
        rows.append(
            (
                name,
                count["passes"],
                count["loads"],
                count["copies"],
                loaded / 1024.0,
                read / 1024.0,
                count["copied"] / 1024.0,
                total / 1024.0,
                total * _HERTZ / 1e6,
            )
        )
    columns = (
        Column("effect"),
        Column("passes", form="d"),
        Column("loads", form="d"),
        Column("copies", form="d"),
        Column("from host", "KB", ",.1f"),
        Column("to host", "KB", ",.0f"),
        Column("copied", "KB", ",.0f"),
        Column("all", "KB", ",.0f"),
        Column("20 Hz", "MB/s", ".1f"),
    )
    return Table(columns, tuple(rows))


def findings(table):
    """The bytes that a frame moves."""
    rows = {r["effect"]: r for r in table.records()}
    one, matrix, ward = rows["K07 GeForce 256"], rows["K08 Octane"], rows["K09 Octane"]
    return (
        f"A light moves over one square of {SIZE} x {SIZE} pixels. In a frame, register combiners move "
        f"{1024 * one['all']:.0f} bytes, K08 {matrix['all']:,.0f} KB, and Ward's model {ward['all']:,.0f} "
        f"KB, {ward['all'] / matrix['all']:.1f} times as many as K08. "
        f"{ward['from host'] / ward['all'] * 100:.0f} % of Ward's bytes are images from the host, in "
        f"addition to {ward['copies']} copies of the framebuffer.",
        f"At {_HERTZ} frames a second K08 moves {matrix['20 Hz']:.0f} MB/s and Ward's model "
        f"{ward['20 Hz']:.0f} MB/s.",
    )


def checks(table):
    """The order of the three ways, and that the moved bytes limit them."""
    rows = {r["effect"]: r for r in table.records()}
    one, matrix, ward = (rows[name]["all"] for name in ("K07 GeForce 256", "K08 Octane", "K09 Octane"))
    return (
        DATA.check(
            "KB of K07, with those of K08 / 1000 as bound", one, Answer.MACHINE, at_most=matrix / 1000.0
        ),
        DATA.check(
            "KB of K09, with twice those of K08 as bound", ward, Answer.MACHINE, at_least=2.0 * matrix
        ),
        DATA.check(
            "copies of K09 that are lookups, and two more",
            float(rows["K09 Octane"]["copies"]),
            Answer.MACHINE,
        ),
        DATA.check(
            "bytes loaded a pixel by K08", 1024 * rows["K08 Octane"]["from host"] / SIZE**2, Answer.MACHINE
        ),
    )


def plot(axes, table):
    """Bars of the bytes that come from the host, and of the bytes that are copied."""
    (ax,) = axes
    names, at = table.column("effect"), np.arange(len(table.rows))
    below = np.zeros(len(at))
    for name, color, label in (
        ("from host", BLUE, "from the host"),
        ("to host", GREEN, "to the host"),
        ("copied", ORANGE, "copied in the framebuffer"),
    ):
        values = np.array(table.column(name))
        ax.bar(at, values, 0.6, bottom=below, color=color, label=label)
        below = below + values
    for k, r in enumerate(table.records()):
        amount = f"{r['all']:,.0f} KB" if r["all"] >= 1.0 else f"{1024 * r['all']:.0f} bytes"
        said = f"{amount}\npasses {r['passes']}, loads {r['loads']},\ncopies {r['copies']}"
        above = {"xytext": (0, 4), "textcoords": "offset points", "ha": "center"}
        ax.annotate(said, (k, r["all"]), **above, fontsize="small")
    ax.set_xticks(at, [name.replace(" ", "\n", 1) for name in names])
    ax.set_ylabel(f"KB in each frame, one square of {SIZE} x {SIZE} pixels")
    ax.set_ylim(0.0, 1.25 * max(table.column("all")))
    ax.legend(loc="upper left")


STUDY = Study(
    **DATA.words,
    method=(
        f"Counted from the commands of two frames between which the light moves: one square of {SIZE} x "
        f"{SIZE} pixels with as many texels; what both frames have stays on the board."
    ),
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
