"""P29: bytes for an environment of high dynamic range, clamped before or after the filter.

A sun of radius r and radiance L is in a grey g. Phong's lobe of exponent e at the sun's middle has the share
1 - cos^(e + 1) r of its weight in the sun. So its brightest value is g + (L - g) share. If the sun is clamped
at one, it is g + (1 - g) share, so (L - 1) share is lost.

Source: Heidrich 2001, section 1.6 (H33; artefact P29 of the catalogue).
"""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.environment_maps import prefilter, reflections
from fixedpipe.effects.geometry import cube_maps
from fixedpipe.effects.geometry.surfaces import plane
from fixedpipe.effects.geometry.vectors import normalize
from fixedpipe.effects.geometry.views import Panel, orthographic_view
from fixedpipe.effects.passes.draws import EDGE, FIRST_PASS, REPLACE, draw, unit
from fixedpipe.effects.studies.study import BLUE, EXPECTED, GREEN, ORANGE, Column, Study, Table
from fixedpipe.pipeline.execution.machine import execute

DATA = study_data(__file__, "P29")

EXPONENTS, SUNS = (1.0, 10.0, 100.0, 1000.0), (10.0, 100.0, 1000.0)
# Texels along a face, the grey, the sun's middle and the cosine of its radius, 4 degrees.
_EDGE, _GREY = 128, 0.25
_SUN, _COSINE = normalize(np.array([0.3, 0.4, 1.0])), 0.99756405
_PIXELS = 4


def probe(sun):
    """A grey with a sun: float64 [6, 128, 128, 3], with 4x4 samples for each texel."""
    fine = cube_maps.directions(4 * _EDGE)
    inside = (fine @ _SUN > _COSINE).astype(np.float64)
    covered = inside.reshape(6, _EDGE, 4, _EDGE, 4).mean(axis=(2, 4))
    return np.repeat((_GREY + (sun - _GREY) * covered)[..., None], 3, axis=-1)


def _read(cube, profile):
    """The value that a machine reads from a cube map towards the sun, 1.0 = full."""
    view, square = orthographic_view(Panel(0, 0, _PIXELS, _PIXELS)), plane()
    mesh = square.mesh(np.broadcast_to(_SUN, square.positions.shape))
    read = unit("filtered probe", EDGE, environment=REPLACE)
    commands = (
        reflections.load_cube("filtered probe", cube, profile),
        draw("the sun's image", mesh, view, None, (read,), depth_test=FIRST_PASS),
    )
    framebuffer = execute(commands, profile, _PIXELS, _PIXELS).framebuffer
    return float(framebuffer.color[_PIXELS // 2, _PIXELS // 2, 0]) / (2.0**framebuffer.color_bits - 1.0)


def measure(profile):
    """The table, with a row for each sun and exponent; every map is scaled by the brightest float."""
    rows = []
    for sun in SUNS:
        floats = probe(sun)
        for exponent in EXPONENTS:
            share = 1.0 - _COSINE ** (exponent + 1.0)
            before, after = (
                prefilter.phong(cube, exponent, 64) for cube in (np.minimum(floats, 1.0), floats)
            )
            scale = 1.0 / after.max()
            kept = _read(scale * before, profile) / _read(scale * after, profile)
            true = (_GREY + (1.0 - _GREY) * share) / (_GREY + (sun - _GREY) * share)
            bright = float(cube_maps.look_up(after, _SUN)[0])
            rows.append((sun, exponent, _GREY + (sun - _GREY) * share, bright, 100.0 * true, 100.0 * kept))
    columns = (
        Column("sun", form="g"),
        Column("exponent", form="g"),
        Column("brightest, formula", form=".3f"),
        Column("brightest, filtered", form=".3f"),
        Column("kept, formula", "%", ".1f"),
        Column("kept, machine", "%", ".1f"),
    )
    return Table(columns, tuple(rows))


def findings(table):
    """The share of the sun's image that remains with a clamped probe."""
    row = {(r["sun"], r["exponent"]): r["kept, machine"] for r in table.records()}
    return (
        "A probe has a sun a hundred times as bright as full, and is made bytes before the filter. A lobe "
        f"of exponent 100 then preserves {row[100.0, 100.0]:.1f} % of the sun's image, and a matt surface "
        f"gets {row[100.0, 1.0]:.0f} % of its light.",
        f"If the sun is ten times as bright as full, {row[10.0, 100.0]:.0f} and {row[10.0, 1.0]:.0f} % is "
        "preserved. The narrower the lobe and the brighter the sun, the more is lost.",
    )


def checks(table):
    """The formula's numbers."""
    for r in table.records():
        name = f"sun of {r['sun']:g}, exponent {r['exponent']:g}"
        yield DATA.check(
            "{name}: brightest of floats over the formula's, deviation from one",
            abs(r["brightest, filtered"] / r["brightest, formula"] - 1.0),
            Answer.IDEAL,
            name=name,
        )
        yield DATA.check(
            "{name}: what is kept, off the formula's, %",
            abs(r["kept, machine"] - r["kept, formula"]),
            Answer.MACHINE,
            name=name,
        )


def plot(axes, table):
    """The remaining share by exponent, for each sun."""
    (kept,) = axes
    for sun, color in zip(SUNS, (BLUE, GREEN, ORANGE), strict=True):
        rows = [r for r in table.records() if r["sun"] == sun]
        exponents, machine, formula = (
            [r[name] for r in rows] for name in ("exponent", "kept, machine", "kept, formula")
        )
        kept.semilogx(exponents, machine, color=color, marker="o", label=f"sun of {sun:g}")
        kept.semilogx(exponents, formula, **EXPECTED)
    kept.set_xlabel("exponent of the lobe")
    kept.set_ylabel("% of the sun's image that bytes keep")
    kept.legend()


STUDY = Study(
    **DATA.words,
    machines=("GEFORCE_256", "GEFORCE_3", "NV2A"),
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
