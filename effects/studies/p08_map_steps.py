"""P8: shadow maps store a shadow's edge to a texel, and its depth to a step.

Source: Heidrich 2001, section 2 (artefact P8 of the catalogue).
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.acceptance import agreement, ray_caster
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.geometry.vectors import dot
from fixedpipe.effects.geometry.views import Panel
from fixedpipe.effects.scenes.objects_and_lamps import Scene, lamp_around
from fixedpipe.effects.scenes.still_life import LAMP_POSITIONS, still_life, still_life_view
from fixedpipe.effects.shadows import shadow_maps
from fixedpipe.effects.shadows.lit_scene import SceneShading, depth_pass
from fixedpipe.effects.studies.shared.strips import drawn
from fixedpipe.effects.studies.study import BLUE, EXPECTED, GREEN, ORANGE, Column, Study, Table
from fixedpipe.pipeline.commands import Clear, CopyTexImage, ReadPixels, TexImage
from fixedpipe.pipeline.enums import InternalFormat
from fixedpipe.pipeline.execution.machine import execute

DATA = study_data(__file__, "P8")

EDGES = (64, 128, 256, 512, 1024, 2048)
# Pixels along the window's edge; segments of round things.
_SIZE, _DETAIL = 384, 24
# Maps of 16 bits are as right as those of 24 at every size; these rows show it, and what a lamp's near plane
# does to them.
_SHORT, _LONG = 16, 24
_NEARER = 1.0 / 20.0
_COMPARED_EDGE = 512
_OFFSETS = {"factor": 2.0, "units": 4.0}
_FORMATS = {_SHORT: InternalFormat.DEPTH_COMPONENT16, _LONG: InternalFormat.DEPTH_COMPONENT24}


def _in_format(commands, bits):
    """The commands with their depth textures of ``bits``."""
    return tuple(
        replace(c, internal_format=_FORMATS[bits]) if isinstance(c, (TexImage, CopyTexImage)) else c
        for c in commands
    )


def mask(scene, view, lamp, edge, bits, profile):
    """The pixels that the machine lights with a map of ``edge`` texels and ``bits``: bool [h, w], bottom row
    first.
    """
    stored = shadow_maps.store_map(scene, lamp, "map", edge, (_SIZE, _SIZE), **_OFFSETS)
    drawing = shadow_maps.modulated_passes(scene, view, lamp, "map", profile, SceneShading.MASK)
    commands = (*_in_format(stored, bits), view.panel.clear((0.0, 0.0, 0.0)), *drawing)
    return agreement.lit_mask(drawn(commands, profile, _SIZE, _SIZE, depth_bits=bits))


def depth_error(scene, lamp, bits, profile):
    """RMS difference of stored depths to rays, inside triangles: in steps of the depth buffer, and in
    millimetres if a world unit is a metre.
    """
    panel = Panel(0, 0, _SIZE, _SIZE)
    view = lamp.view(panel)
    commands = (
        Clear(label="clear depth", depth=1.0, scissor=panel.scissor),
        *depth_pass(scene, view),
        ReadPixels(label="the map's depths", name="depth", format="DEPTH_COMPONENT"),
    )
    steps = 2.0**bits - 1.0
    read = execute(commands, profile, _SIZE, _SIZE, depth_bits=bits).pixels["depth"]
    # The map holds what throws shadows, and not the ground far about.
    shown = ray_caster.visible(ray_caster.scene_caster(Scene(scene.throwing)), view)
    inside = shown.something.copy()
    for axis in (0, 1):
        for shift in (-1, 1):
            inside &= np.roll(shown.triangle, shift, axis) == shown.triangle
    error = read[inside] - steps * shown.depth[inside]
    distance = -(shown.points[inside] @ np.array(lamp.modelview)[2, :3] + lamp.modelview[2][3])
    # d(depth)/d(distance) = far near / ((far - near) distance^2).
    length = distance * distance * (lamp.far - lamp.near) / (lamp.far * lamp.near) / steps
    return float(np.sqrt((error * error).mean())), float(1e3 * np.sqrt(((error * length) ** 2).mean()))


def measure(profile):
    """The table, with a row for each map."""
    scene, view = still_life(_DETAIL), still_life_view(Panel(0, 0, _SIZE, _SIZE))
    fitted = lamp_around(scene, LAMP_POSITIONS[0])
    nearer = replace(fitted, near=fitted.near * _NEARER)
    truth = agreement.truth_of(scene, view, fitted)
    facing = dot(truth.shown.normals, np.array(fitted.position) - truth.shown.points) > 0.0
    rows = []
    errors = {
        (bits, lamp.near): depth_error(scene, lamp, bits, profile)
        for lamp in (fitted, nearer)
        for bits in (_LONG, _SHORT)
    }
    asked = [(edge, _LONG, fitted) for edge in EDGES]
    asked += [
        (_COMPARED_EDGE, bits, lamp) for bits, lamp in ((_SHORT, fitted), (_LONG, nearer), (_SHORT, nearer))
    ]
    for edge, bits, lamp in asked:
        found = agreement.compare(
            mask(scene, view, lamp, edge, bits, profile),
            replace(truth, lamp=lamp),
            map_edge=edge,
            where=facing,
        )
        at_edges = (found.silhouette + found.shadow_edge) / found.compared
        rows.append(
            (
                edge,
                bits,
                lamp.near,
                100.0 * (1.0 - found.agreeing),
                100.0 * at_edges,
                100.0 * (found.contact + found.other) / found.compared,
                *errors[bits, lamp.near],
            )
        )
    columns = (
        Column("map", "texels", "d"),
        Column("depth", "bits", "d"),
        Column("near plane", "", ".2f"),
        Column("wrong", "%", ".2f"),
        Column("at edges", "%", ".3f"),
        Column("without a reason", "%", ".3f"),
        Column("depth error", "steps", ".2f"),
        Column("depth error", "mm", ".4f"),
    )
    return Table(columns, tuple(rows))


def _sweep(table):
    """The edges (in texels) of the maps of 24 bits, and their wrong pixels at shadows' edges, %."""
    rows = table.rows[: len(EDGES)]
    return np.array([row[0] for row in rows], float), np.array([row[4] for row in rows])


def _law(table):
    """a and c of the law a / M + c for wrong pixels at edges (%), by least squares of relative deviations."""
    edges, wrong = _sweep(table)
    left = np.stack([1.0 / edges, np.ones_like(edges)], axis=1) / wrong[:, None]
    return np.linalg.lstsq(left, np.ones_like(wrong), rcond=None)[0]


def findings(table):
    """The law, and the effect of the number of bits."""
    a, c = _law(table)
    (_, _, _, wrong, _, _, steps, size), (_, _, _, wrong_short, _, _, steps_short, size_short) = (
        table.rows[EDGES.index(_COMPARED_EDGE)],
        table.rows[len(EDGES)],
    )
    *_, far_long, far_short = table.rows
    return (
        f"Wrong pixels at edges are {a:.0f} / M + {c:.2f} %, with M texels along the map's edge. The first "
        "term is a band as wide as a texel. The second remains because of the pixels' own size.",
        f"With {_COMPARED_EDGE} texels, {wrong:.2f} % of the pixels are wrong at 24 bits and "
        f"{wrong_short:.2f} % at 16. Stored depths are {size:.3f} mm off at 24 bits, {steps:.0f} steps, "
        f"because vertices are snapped to fractions of a texel. At 16 bits they are {size_short:.3f} mm "
        f"off, {steps_short:.2f} steps.",
        f"With the near plane at {far_short[2]:.2f} instead of {table.rows[0][2]:.2f}, depths are "
        f"{far_long[7]:.3f} mm off at 24 bits, and {far_short[7]:.2f} mm at 16, {far_short[6]:.2f} steps. "
        "There the cut to 16 bits dominates. An offset of the texels' slopes covers all of it.",
    )


def checks(table):
    """The catalogue's law, and the law of rounding."""
    edges, wrong = _sweep(table)
    a, c = _law(table)
    worst = float(np.abs((a / edges + c) / wrong - 1.0).max())
    exponent = float(np.log(wrong[3] / wrong[0]) / np.log(edges[3] / edges[0]))
    short, nearer_short = table.rows[len(EDGES)], table.rows[-1]
    return (
        DATA.check(
            "exponent of wrong pixels at edges by M, 64 to 512 texels, + 1: absolute",
            abs(exponent + 1.0),
            Answer.MACHINE,
        ),
        DATA.check("wrong pixels at edges over a / M + c, - 1: largest absolute", worst, Answer.MACHINE),
        DATA.check(
            "wrong pixels without a reason, %, largest", max(row[5] for row in table.rows), Answer.MACHINE
        ),
        DATA.check(
            "depth error, 16 bits, near plane close to the lamp, steps, - 0.58: absolute",
            abs(nearer_short[6] - 0.58),
            Answer.MACHINE,
        ),
        DATA.check(
            "wrong pixels of 16 bits - those of 24, %", abs(short[3] - table.rows[3][3]), Answer.MACHINE
        ),
    )


def plot(axes, table):
    """Wrong pixels by M, and depth errors by bits."""
    by_edge, by_bits = axes
    edges, wrong = _sweep(table)
    a, c = _law(table)
    by_edge.loglog(edges, wrong, color=BLUE, marker="o", label="machine, at edges of shadows")
    by_edge.loglog(edges, a / edges + c, color=ORANGE, linestyle="--", label="a / M + c")
    by_edge.loglog(edges, wrong[0] * edges[0] / edges, label="catalogue: 1 / M", **EXPECTED)
    by_edge.set_xlabel("texels along the map's edge, M")
    by_edge.set_ylabel("wrong pixels, %")
    by_edge.legend()
    rows = [table.rows[3], *table.rows[len(EDGES) :]]
    names = [f"{row[1]} bits\nnear {row[2]:.2f}" for row in rows]
    by_bits.bar(names, [row[7] for row in rows], color=GREEN)
    by_bits.set_ylabel("RMS error of stored depths, mm")


STUDY = Study(
    **DATA.words,
    method=(
        f"The still life in {_SIZE} pixels, its machine's mask against rays at surfaces that face the lamp; "
        "stored depths against rays inside triangles, a world unit being a metre."
    ),
    machines=("GEFORCE_3", "NV2A"),
    panels=2,
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
