"""P7: the ramp's half texel.

A texel has the value of its centre. So W filtered texels i / (W - 1) give (s W - 1/2) / (W - 1) between the
centres of the first and the last texel. Beyond these they give zero and one. The largest error is 1 / (2 W),
at the first and the last centre. The coordinate s' = s (W - 1) / W + 1 / (2 W) runs from the first centre to
the last, and is exact.

Source: Heidrich 2001, section 2.1 (artefact P7 of the catalogue).
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.geometry.surfaces import plane
from fixedpipe.effects.geometry.views import Panel
from fixedpipe.effects.passes.draws import REPEATED
from fixedpipe.effects.scenes.objects_and_lamps import Lamp, Object, Scene
from fixedpipe.effects.shadows import alpha_coded_shadows as alpha
from fixedpipe.effects.shadows.lit_scene import SceneShading
from fixedpipe.effects.studies.study import BLUE, EXPECTED, GREEN, ORANGE, Column, Study, Table
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import IDEAL

DATA = study_data(__file__, "P7")

WIDTHS = (16, 32, 64, 128, 256)
_PIXELS = 1024
# Parallel light on a plane that falls away from its near plane, at the right, to its far one.
_LAMP = Lamp((0.0, 0.0, 1.0), (0.0, 0.0, 0.0), 0.5, 1.5, infinite=True)


def _falling():
    flat = plane()
    return replace(flat, positions=flat.positions + flat.positions[:, :1] * np.array([0.0, 0.0, 0.5]))


def _row(draw, repeated):
    """A Draw, limited to one row of pixels, which is enough. ``repeated``: whether its texture repeats."""
    state = draw.state
    if repeated:
        (unit,) = state.texture_units
        state = replace(state, texture_units=(replace(unit, sampler=REPEATED),))
    row = replace(state.scissor, y=_PIXELS // 2, height=1)
    return replace(draw, state=replace(state, scissor=row))


def errors(texels, profile, bits, *, corrected, repeated=False):
    """Alpha minus depth in a row of pixels from the near plane to the far one: float64 [1024].

    ``repeated``: with OpenGL's initial wrap mode, REPEAT.
    """
    coding = alpha.Coding(bits, texels=texels, bias=0.0, corrected=corrected)
    scene = Scene((Object("plane", _falling(), (1.0, 1.0, 1.0)),))
    panel = Panel(0, 0, _PIXELS, _PIXELS)
    picture = alpha.picture_from_light(scene, _LAMP, panel, coding, bias=0.0, shading=SceneShading.MASK)
    drawn = (_row(c, repeated) if isinstance(c, Draw) else c for c in picture)
    out = (coding.ramp(profile), *drawn)
    if profile.arithmetic.exact:
        read = execute_ideal(out, _PIXELS, _PIXELS).color[:, :, 3]
    else:
        framebuffer = execute(out, profile, _PIXELS, _PIXELS).framebuffer
        read = framebuffer.color[..., 3] / (2.0**framebuffer.color_bits - 1.0)
    depth = 1.0 - (np.arange(_PIXELS) + 0.5) / _PIXELS
    return read[::-1][_PIXELS // 2] - depth


def measure(profile):
    """The table, with a row for each ramp."""
    bits, rows, curves = profile.framebuffers.color_bits[0], [], {}
    for texels in WIDTHS:
        half, exact, wrapped = (
            errors(texels, profile, bits, corrected=c, repeated=r)
            for c, r in ((False, False), (True, False), (False, True))
        )
        free = errors(texels, IDEAL, bits, corrected=False), errors(texels, IDEAL, bits, corrected=True)
        largest = (float(np.abs(e).max()) for e in (half, free[0], exact, free[1], wrapped))
        rows.append((texels, 0.5 / texels, *largest))
        curves[f"{texels}"], curves[f"{texels}, s'"] = half, exact
    columns = (
        Column("texels", form="d"),
        Column("1 / (2 W)", form=".5f"),
        Column("plain, machine", form=".5f"),
        Column("plain, ideal", form=".5f"),
        Column("corrected, machine", form=".5f"),
        Column("corrected, ideal", form=".5f"),
        Column("plain, repeated", form=".5f"),
    )
    step = np.array([1.0 / (2.0**bits - 1.0)])
    return Table(columns, tuple(rows), {**curves, "step": step})


def findings(table):
    """The gain of s' in steps of alpha, and the error of a ramp that repeats."""
    row = {r["texels"]: r for r in table.records()}
    few, many, step = row[WIDTHS[0]], row[WIDTHS[-1]], float(table.curves["step"][0])
    plain, corrected = (tuple(r[f"{n}, machine"] for r in (few, many)) for n in ("plain", "corrected"))
    return (
        f"Read at s, {WIDTHS[0]} texels are off by {plain[0]:.4f}, where 1 / (2 W) is "
        f"{few['1 / (2 W)']:.4f}. {WIDTHS[-1]} texels are off by {plain[1]:.5f}, {plain[1] / step:.1f} "
        "steps of this machine's alpha.",
        f"Read at s', they are off by {corrected[0]:.5f} and {corrected[1]:.5f}. These "
        f"{corrected[0] / step:.2f} and {corrected[1] / step:.2f} steps are the cost of rounding.",
        f"A ramp that repeats mixes near and far at its ends, and is off by {few['plain, repeated']:.2f}.",
    )


def checks(table):
    """The catalogue's numbers."""
    step = float(table.curves["step"][0])
    for r in table.records():
        w = r["texels"]
        yield DATA.check(
            "{w} texels, s: largest error over 1 / (2 W), deviation from one",
            abs(r["plain, ideal"] * 2.0 * w - 1.0),
            Answer.IDEAL,
            at_most=w / _PIXELS,
            w=w,
        )
        yield DATA.check(
            "{w} texels, s: the machine's largest error off the ideal's, in steps",
            abs(r["plain, machine"] - r["plain, ideal"]) / step,
            Answer.MACHINE,
            w=w,
        )
        yield DATA.check("{w} texels, s': largest error", r["corrected, ideal"], Answer.IDEAL, w=w)
        yield DATA.check(
            "{w} texels, s': largest error in steps",
            r["corrected, machine"] / step,
            Answer.MACHINE,
            at_most=1.0 + 1.0 / 256.0 / (w - 1.0) / step,
            w=w,
        )


def plot(axes, table):
    """The largest error by texels, and the error along the shortest ramp."""
    largest, along = axes
    widths = table.column("texels")
    largest.loglog(widths, table.column("plain, machine"), color=ORANGE, marker="o", label="s")
    largest.loglog(widths, table.column("corrected, machine"), color=BLUE, marker="s", label="s'")
    largest.loglog(widths, table.column("1 / (2 W)"), label="catalogue: 1 / (2 W)", **EXPECTED)
    largest.minorticks_off()
    largest.set_xticks(widths, [str(w) for w in widths])
    largest.set_xlabel("texels of the ramp")
    largest.set_ylabel("largest error of alpha as depth")
    largest.legend()
    depth = 1.0 - (np.arange(_PIXELS) + 0.5) / _PIXELS
    for texels, color in ((16, ORANGE), (64, GREEN)):
        along.plot(depth, table.curves[f"{texels}"], color=color, label=f"s, {texels} texels")
    along.plot(depth, table.curves["16, s'"], color=BLUE, label="s', 16 texels")
    along.set_xlabel("depth")
    along.set_ylabel("alpha - depth")
    along.legend()


STUDY = Study(
    **DATA.words,
    method=(
        f"A plane that falls from the light's near plane to its far one along {_PIXELS} pixels: alpha, as "
        "H36 draws it, against the depth."
    ),
    machines=("INFINITE_REALITY", "OCTANE", "GEFORCE_256", "MULTITEXTURE"),
    panels=2,
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
