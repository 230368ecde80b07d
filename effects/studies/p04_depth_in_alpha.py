"""P4: depths in alphas of few bits: the acne from comparing two rasterizations, and the effect of a bias.

A slanted plane with nothing between it and the light should have no shadow. A texel of the map holds the
depth of its centre. A fragment next to the centre is up to X = slope * texel / (2 step) steps farther. Both
depths are rounded to steps. So a difference of x steps exceeds b with the probability x - b, clamped to
[0, 1]. x is distributed evenly from -X to X. The fraction of acne is the mean of this probability: ``law``.

Source: Heidrich 2001, section 2.1 (artefact P4 of the catalogue; erratum E000.9).
"""

import math

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.surfaces import plane
from fixedpipe.effects.geometry.views import Panel, perspective_view
from fixedpipe.effects.scenes.objects_and_lamps import Lamp, Object, Scene
from fixedpipe.effects.shadows import alpha_coded_shadows as alpha
from fixedpipe.effects.shadows.lit_scene import SceneShading
from fixedpipe.effects.studies.study import BLUE, GREEN, ORANGE, PURPLE, RED, SKY, Column, Study, Table
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.profiles import GEFORCE_256

DATA = study_data(__file__, "P4")

# Tangents of the angle between the plane's normal and the light.
SLOPES = (0.0, 0.3, 0.7, 1.2, 2.1, 3.7)
# (bits, bias in steps); in the world 32 steps of 12 bits and 512 of 16 are as much as 2 of 8.
CODINGS = ((8, 0), (8, 1), (8, 2), (12, 0), (12, 2), (12, 32), (16, 0), (16, 2), (16, 512))
_SIZE, _EDGE = 128, 64
# Parallel light along -z; its box is 2 wide, and so deep that no slope climbs by whole steps from texel to
# texel: then every place in a step is as often met as another.
LAMP = Lamp((0.0, 0.0, 3.0), (0.0, 0.0, 0.0), 0.85, 5.15, infinite=True, half_width=1.0)


def step(bits):
    """The smallest difference of two depths in world units: (f - n) / (2^bits - 1)."""
    return (LAMP.far - LAMP.near) / (2.0**bits - 1.0)


def law(slope, bits, bias):
    """The fraction of pixels that a bias of ``bias`` steps leaves in shadow."""
    most = slope * (2.0 * LAMP.half_width / _EDGE) / (2.0 * step(bits))
    if most <= bias:
        return 0.0
    over = most - bias
    return (over * over / 2.0 if over <= 1.0 else over - 0.5) / (2.0 * most)


def acne(slope, bits, bias):
    """The fraction of a slanted plane's pixels that the machine leaves in shadow."""
    profile = GEFORCE_256.with_precision(combiner_bits=bits, texture_bits=bits, framebuffer_bits=bits)
    turn = rotation("y", math.degrees(math.atan(slope)))
    scene = Scene((Object("plane", plane(1, 1, 0.9, 0.9).rotated(turn), (1.0, 1.0, 1.0)),))
    coding, panel = alpha.Coding(bits, bias=float(bias)), Panel(0, 0, _SIZE, _SIZE)
    eye = tuple(float(v) for v in turn @ np.array([0.7, 0.9, 6.0]))
    view = perspective_view(panel, eye, field_of_view=14.0)
    black = (0.0, 0.0, 0.0)
    commands = (
        coding.ramp(profile),
        *alpha.store_map(scene, LAMP, panel, _EDGE, profile, coding, shading=SceneShading.MASK),
        *alpha.with_combiners(
            scene, view, LAMP, profile, coding, background=black, shading=SceneShading.MASK
        ),
    )
    framebuffer = execute(commands, profile, _SIZE, _SIZE).framebuffer
    seen = framebuffer.depth < 2**framebuffer.depth_bits - 1
    return float((framebuffer.color[..., 0][seen] == 0).mean())


def _name(bits, bias):
    return f"{bits} bits + {bias}"


def measure(profile):
    """The table, with a row for each slope and a column for each coding."""
    rows = [(slope, *(100.0 * acne(slope, *coding) for coding in CODINGS)) for slope in SLOPES]
    columns = (Column("slope", form=".2f"), *(Column(_name(*c), "%", ".1f") for c in CODINGS))
    slopes = np.arange(1, 401) / 100.0
    curves = {
        _name(*coding): np.array([slopes, [100.0 * law(s, *coding) for s in slopes]]) for coding in CODINGS
    }
    return Table(columns, tuple(rows), curves)


def findings(table):
    """The cost of an equal comparison, what two steps hide, and that more bits alone do not help."""
    row = {r["slope"]: r for r in table.records()}
    steep, one = row[3.7], row[1.2]
    return (
        f"Without a bias {one['8 bits + 0']:.0f} % of a plane of slope 1.2 is in its own shadow with 8 "
        f"bits, and {one['16 bits + 0']:.0f} % with 16. More bits make it worse, because fewer depths are "
        "equal.",
        f"Two steps of 8 bits are a bias of {2.0 * step(8):.4f} in a box of depth {LAMP.far - LAMP.near:g}. "
        f"They leave {row[2.1]['8 bits + 2']:.1f} % at slope 2.1 and {steep['8 bits + 2']:.1f} % at slope "
        f"3.7. Two steps of 16 bits leave {steep['16 bits + 2']:.1f} % at slope 3.7.",
        f"The same bias in world units leaves {steep['12 bits + 32']:.1f} % there with 12 bits and "
        f"{steep['16 bits + 512']:.1f} % with 16. It must cover the slope of the surface under a texel. 8 "
        "bits leave less, because their roundings add half a step to the bias.",
    )


def checks(table):
    """The law of slope, texel, step and bias."""
    worst = max(
        abs(r[_name(*coding)] - 100.0 * law(r["slope"], *coding))
        for r in table.records()
        for coding in CODINGS
    )
    row = {r["slope"]: r for r in table.records()}
    return (
        DATA.check(
            "acne against the law of slope, texel, step and bias, largest difference, %",
            worst,
            Answer.MACHINE,
        ),
        DATA.check("acne at slope 3.7 without a bias, 8 bits, %", row[3.7]["8 bits + 0"], Answer.MACHINE),
        DATA.check(
            "acne of a plane that faces the light, with a bias of two, %",
            max(row[0.0][_name(b, 2)] for b in (8, 12, 16)),
            Answer.MACHINE,
        ),
    )


def plot(axes, table):
    """Acne by slope, as measured and as the law predicts."""
    (axis,) = axes
    codings = ((8, 0), (8, 1), (8, 2), (12, 2), (16, 2), (16, 512))
    for coding, color in zip(codings, (BLUE, SKY, GREEN, ORANGE, RED, PURPLE), strict=True):
        name = _name(*coding)
        axis.plot(*table.curves[name], color=color)
        axis.plot(
            table.column("slope"), table.column(name), color=color, marker="o", linestyle="none", label=name
        )
    axis.plot([], [], color="black", label="law")
    axis.set_xlabel("slope of the plane towards the light")
    axis.set_ylabel("pixels in their own shadow, %")
    axis.set_ylim(-2.0, 75.0)
    axis.legend(loc="upper left", ncols=3)


STUDY = Study(
    **DATA.words,
    method=(
        f"A plane of {_SIZE} x {_SIZE} pixels under parallel light, nothing before it, with H37 on "
        "combiners, textures and framebuffer of 8, 12 and 16 bits; a map of "
        f"{_EDGE} x {_EDGE}. Columns: bits + steps of bias."
    ),
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
