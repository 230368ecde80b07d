"""P34: how much of the sphere the texels of a parabolic map cover, from the middle of a disc to its edge.

A direction at the angle a from the axis has the radius tan(a/2). So a step ds in the disc is an angle of
2 ds/(1 + tan^2(a/2)): 2 ds in the middle and ds at the edge. Texels in the middle cover four times the solid
angle of those at the edge. They lose stripes that the edge resolves.

Source: Heidrich 2001, section 1.3; Heidrich, Seidel 1998 (H21; artefact P34 of the catalogue).
"""

import math

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.geometry import parabolic_maps
from fixedpipe.effects.geometry.surfaces import plane
from fixedpipe.effects.geometry.vectors import cosine, sine
from fixedpipe.effects.geometry.views import Panel, orthographic_view
from fixedpipe.effects.passes.draws import EDGE, FIRST_PASS, NEAREST, REPLACE, draw, unit
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.studies.study import BLUE, EXPECTED, ORANGE, Column, Study, Table
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.textures.images import texture_2d

DATA = study_data(__file__, "P34")

TEXELS = 64
# Degrees of a stripe and its gap: two texels of the middle are 7.6 degrees, of the edge 3.8.
PERIOD = 7.0
# Where texels lie against stripes is chance: so many stripes, each moved by a share of the period.
_PHASES = 8
_PIXELS = 1024
_REACH = parabolic_maps.margin(TEXELS)
# Ranges of angles from the axis, degrees, over which a row of the table is taken.
RANGES = ((2.0, 14.0), (20.0, 32.0), (38.0, 50.0), (56.0, 68.0), (76.0, 88.0))


def _swept(texels, sampler, profile):
    """The values that a machine reads from the first disc, from the axis to the edge: float64 [1024, 3], with
    1.0 = full.
    """
    surface = plane(columns=_PIXELS // 4)
    angle = math.radians(90.0) * surface.texture_coordinates[:, 0]
    toward = np.stack([sine(angle), 0.0 * angle, -cosine(angle)], axis=-1)
    read = unit("disc", sampler, environment=REPLACE, matrix=parabolic_maps.matrix(0, _REACH))
    view = orthographic_view(Panel(0, 0, _PIXELS, 1), half_height=1.0 / _PIXELS)
    image = texture_2d(factor_texels(texels, profile))
    commands = (
        TexImage(label="load a disc", texture="disc", image=image),
        draw("from the axis to the edge", surface.mesh(toward), view, None, (read,), depth_test=FIRST_PASS),
    )
    framebuffer = execute(commands, profile, _PIXELS, 1).framebuffer
    return framebuffer.color[0, :, :3] / (2.0**framebuffer.color_bits - 1.0)


def _stripes(angle, phase=0):
    return 0.5 + 0.5 * np.cos(2.0 * np.pi * (angle / PERIOD + phase / _PHASES))


def measure(profile):
    """The table, with a row for each range of angles."""
    # Each column of texels has a colour of its own, 4 i of 255.
    columns = np.broadcast_to((4.0 * np.arange(TEXELS) / 255.0)[None, :, None], (TEXELS, TEXELS, 3))
    column = np.floor(_swept(columns, NEAREST, profile)[:, 0] * 255.0 / 4.0 + 0.5)
    angle = 90.0 * (np.arange(_PIXELS) + 0.5) / _PIXELS
    of_texels = np.degrees(
        np.arccos(np.clip(-parabolic_maps.directions(TEXELS, _REACH)[0, ..., 2], -1.0, 1.0))
    )
    found = np.stack(
        [
            _swept(np.repeat(_stripes(of_texels, k)[..., None], 3, axis=-1), EDGE, profile)[:, 0]
            for k in range(_PHASES)
        ]
    )
    true = np.stack([_stripes(angle, k) for k in range(_PHASES)])
    rows = []
    for low, high in RANGES:
        inside = (angle >= low) & (angle < high)
        starts = angle[1:][(column[1:] != column[:-1]) & inside[1:]]
        width = float((starts[-1] - starts[0]) / (len(starts) - 1))
        middle = math.radians(0.5 * (starts[0] + starts[-1]))
        expected = math.degrees(2.0 / TEXELS / _REACH * 2.0 / (1.0 + math.tan(middle / 2.0) ** 2))
        error = (found - true)[:, inside]
        rows.append((f"{low:.0f} to {high:.0f}", expected, width, float(np.sqrt((error * error).mean()))))
    return Table(
        (
            Column("from the axis", "degrees"),
            Column("texel, formula", "degrees", ".2f"),
            Column("texel, machine", "degrees", ".2f"),
            Column("stripes, RMS error", form=".3f"),
        ),
        tuple(rows),
    )


def findings(table):
    """The texels in the middle and at the edge, and their effect on stripes."""
    first, last = table.records()[0], table.records()[-1]
    ratio = first["texel, machine"] / last["texel, machine"]
    return (
        f"A texel in the middle is {first['texel, machine']:.2f} degrees wide, at the edge "
        f"{last['texel, machine']:.2f}. That is {ratio:.2f} times, {ratio * ratio:.1f} times in solid "
        "angle. Texels are sparse in the middle and not at the edge.",
        f"Stripes of {PERIOD:g} degrees are off by {first['stripes, RMS error']:.2f} in the middle and by "
        f"{last['stripes, RMS error']:.2f} at the edge. Plain grey would be off by 0.35.",
    )


def checks(table):
    """The paraboloid's widths, and the stripes."""
    rows = table.records()
    for r in rows:
        yield DATA.check(
            "{which} degrees: a texel's width over the formula's, deviation from one",
            abs(r["texel, machine"] / r["texel, formula"] - 1.0),
            Answer.MACHINE,
            which=r["from the axis"],
        )
    yield DATA.check(
        "a texel's width, first range over last",
        rows[0]["texel, machine"] / rows[-1]["texel, machine"],
        Answer.MACHINE,
    )
    yield DATA.check(
        "stripes in the middle, RMS error over that at the edge",
        rows[0]["stripes, RMS error"] / rows[-1]["stripes, RMS error"],
        Answer.MACHINE,
    )


def plot(axes, table):
    """A texel's width by angle, and the stripes."""
    width, stripes = axes
    middle = [0.5 * (low + high) for low, high in RANGES]
    width.plot(middle, table.column("texel, machine"), color=ORANGE, marker="o", label="machine")
    width.plot(middle, table.column("texel, formula"), label="formula", **EXPECTED)
    width.set_xlabel("degrees from the axis")
    width.set_ylabel("a texel's width, degrees")
    width.set_ylim(0.0)
    width.legend()
    stripes.plot(middle, table.column("stripes, RMS error"), color=BLUE, marker="o", label="map of 64 texels")
    stripes.axhline(math.sqrt(0.125), color="0.6", label="grey")
    stripes.set_xlabel("degrees from the axis")
    stripes.set_ylabel(f"RMS error of stripes of {PERIOD:g} degrees")
    stripes.set_ylim(0.0)
    stripes.legend()


STUDY = Study(
    **DATA.words,
    method=(
        f"A disc of {TEXELS} texels read along a great circle from its axis to its edge: where NEAREST goes "
        f"on to the next texel, and stripes of {PERIOD:g} degrees by LINEAR, moved "
        f"{_PHASES} times."
    ),
    machines=("INFINITE_REALITY", "OCTANE", "GEFORCE_256", "MULTITEXTURE"),
    panels=2,
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
