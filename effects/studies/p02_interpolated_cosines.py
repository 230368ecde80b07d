"""P2: cosines that are computed at the vertices and interpolated: "fast Phong".

One light shines on a cylinder of few or many slices. The cosine of normal and halfway vector is the
texture coordinate (H05). Interpolation runs along the chord between two normals, so the cosine is never
larger than at a vertex.

Let f(c) be the light, and c a cosine around the cylinder, with vertices an angle D apart. Half way between
vertices, interpolation of c loses f'(c) c D^2 / 8 of the light. Gouraud's interpolation of f(c) loses (f'(c)
c - f''(c) (1 - c^2)) D^2 / 8. For a narrow highlight exp(-x^2 / 2) these are exp(-x^2 / 2) and (1 - x^2)
exp(-x^2 / 2), times the same factor. The integrals of their squares have the ratio 1 to 3/4, and only the
first has a mean. If f has an edge, the order is reversed.

Source: Heidrich 2001, section 1.1 (artefact P2 of the catalogue). Inferred: the comparison with Gouraud.
"""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.geometry.vectors import cosine, sine
from fixedpipe.effects.geometry.vertex_vectors import dot_products
from fixedpipe.effects.geometry.views import Panel, orthographic_view
from fixedpipe.effects.passes.draws import EDGE, FIRST_PASS, REPLACE, draw, unit
from fixedpipe.effects.reflectance.sampled_functions import sampled
from fixedpipe.effects.studies.shared.cylinders import cylinder
from fixedpipe.effects.studies.shared.strips import drawn
from fixedpipe.effects.studies.study import (
    BLACK,
    BLUE,
    EXPECTED,
    GREEN,
    ORANGE,
    RED,
    Column,
    Study,
    Table,
)
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import IDEAL

DATA = study_data(__file__, "P2")

SLICES = (8, 12, 16, 25, 50, 100, 200)
EXPONENT = 32.0
# The cosine at which a table has an edge.
EDGE_AT = 0.9
# The largest table of the plain board: its own steps are to be small beside what is measured.
_TEXELS = 2048
_WIDTH, _HEIGHT = 2048, 8
_PANEL = Panel(0, 0, _WIDTH, _HEIGHT)
_VIEW = orthographic_view(_PANEL, half_height=_HEIGHT / _WIDTH)
# Where the halfway vector points, radians from the viewer about the cylinder's axis.
_HALFWAY = 0.4
_PHASES = (0.0, 0.25, 0.5, 0.75)


def _halfway():
    return np.array([float(sine(_HALFWAY)), 0.0, float(cosine(_HALFWAY))])


def _shown(profile, commands):
    black = _PANEL.clear((0.0, 0.0, 0.0))
    if profile.arithmetic.exact:
        return execute_ideal((black, *commands), _WIDTH, _HEIGHT).color[_HEIGHT // 2, :, 0]
    return drawn((black, *commands), profile, _WIDTH, _HEIGHT)[_HEIGHT // 2, :, 0]


def _turned(slices, phase):
    """The cylinder, turned so that the highlight is ``phase`` slices past a vertex."""
    step = 2.0 * np.pi / slices
    turn = _HALFWAY - phase * step
    return cylinder(slices, turn - round(turn / step) * step)


def fast_phong(profile, slices, phase, function):
    """A function of n.h, looked up in a table at the interpolated n.h: float64 [_WIDTH]."""
    surface = _turned(slices, phase)
    products = dot_products((surface.normals, _halfway()), (surface.normals, _halfway()))
    image = sampled(function, _TEXELS, profile=profile)
    mesh = surface.mesh(products[:, :1])
    loading = TexImage(label="load the table", texture="table", image=image, target=image.target)
    one = unit("table", EDGE, environment=REPLACE)
    return _shown(profile, (loading, draw("table", mesh, _VIEW, None, (one,), depth_test=FIRST_PASS)))


def gouraud(slices, phase, function):
    """The same function evaluated at the vertices. Its values are interpolated without rounding."""
    surface = _turned(slices, phase)
    values = function(dot_products((surface.normals, _halfway()))[:, 0].clip(0.0))
    mesh = surface.mesh(colors=np.repeat(values[:, None], 3, axis=1))
    return _shown(IDEAL, (draw("colour", mesh, _VIEW, None, depth_test=FIRST_PASS),))


def _power(c):
    return np.asarray(c, np.float64) ** EXPONENT


def _ramp(c):
    return np.asarray(c, np.float64)


def _edge(c):
    return np.where(np.asarray(c, np.float64) > EDGE_AT, 1.0, 0.0)


def _true():
    x = (np.arange(_WIDTH) + 0.5) * (2.0 / _WIDTH) - 1.0
    return x, np.maximum(0.0, np.cos(np.arcsin(x) - _HALFWAY))


def measure(profile):
    """The table, with a row for each number of slices."""
    x, c = _true()
    near = np.abs(np.arcsin(x) - _HALFWAY) < 0.75
    true, sharp = _power(c)[near], _edge(c)[near]
    rows, curves, kept = [], {"x": x[near], "true": true}, []
    for slices in SLICES:
        step = 2.0 * np.pi / slices

        def of(draw_one, *arguments, slices=slices):
            return np.stack([draw_one(*arguments, slices, phase) for phase in _PHASES])[:, near]

        lit = of(lambda s, f: fast_phong(profile, s, f, _power))
        exact = of(lambda s, f: fast_phong(IDEAL, s, f, _power))
        plain = of(lambda s, f: gouraud(s, f, _power))
        edges = of(lambda s, f: fast_phong(IDEAL, s, f, _edge)), of(lambda s, f: gouraud(s, f, _edge))
        # Half way between two vertices, where the highlight is to be.
        middle = np.abs(np.arcsin(x) - _HALFWAY) < 0.1 * step
        rows.append(
            (
                slices,
                float(1.0 - gouraud(slices, 0.5, _ramp)[middle].max()),
                float(1.0 - fast_phong(profile, slices, 0.5, _ramp)[middle].max()),
                root_mean_square(exact - true),
                root_mean_square(lit - true),
                root_mean_square(plain - true),
                100.0 * float(1.0 - exact.mean() / true.mean()),
                root_mean_square(edges[0] - sharp),
                root_mean_square(edges[1] - sharp),
            )
        )
        kept.append(plain.mean() / true.mean())
        if slices in (12, 25):
            curves[f"fast {slices}"], curves[f"plain {slices}"] = exact[2], plain[2]
    columns = (
        Column("slices", form="d"),
        Column("deficit of n.h", form=".5f"),
        Column("deficit, machine", form=".5f"),
        Column("RMS", form=".4f"),
        Column("RMS, machine", form=".4f"),
        Column("RMS, Gouraud", form=".4f"),
        Column("light lost", "%", ".1f"),
        Column("edge", form=".3f"),
        Column("edge, Gouraud", form=".3f"),
    )
    return Table(columns, tuple(rows), {**curves, "light kept by Gouraud": np.array(kept)})


def expected(row):
    """1 - cos(D / 2), where D is the angle between the vertices of a row."""
    return float(1.0 - np.cos(np.pi / row["slices"]))


def _angles(table):
    return np.array([360.0 / slices for slices in table.column("slices")])


def _peak_lost(row):
    return 100.0 * (1.0 - (1.0 - row["deficit of n.h"]) ** EXPONENT)


def slope(table, name):
    """The power of the angle with which a column grows: the slope of a line through the logarithms."""
    angles, values = np.log(_angles(table)), np.log(table.column(name))
    return float(np.polyfit(angles, values, 1)[0])


def findings(table):
    """How much of a highlight's light interpolation loses, compared with Gouraud's interpolation."""
    rows = {r["slices"]: r for r in table.records()}
    few, some, many = rows[8], rows[25], rows[200]
    lost = 100.0 * (1.0 - float(table.curves["light kept by Gouraud"][SLICES.index(25)]))
    return (
        f"Half way between two vertices {360.0 / few['slices']:g} degrees apart, n.h is "
        f"{few['deficit of n.h']:.4f} short of one. There a highlight of exponent {EXPONENT:g} loses "
        f"{_peak_lost(few):.0f} % of its peak; with 25 slices {_peak_lost(some):.0f} %, with 50 slices "
        f"{_peak_lost(rows[50]):.0f} %. The deficit grows with the power "
        f"{slope(table, 'deficit of n.h'):.2f} of the angle.",
        f"With 25 slices the highlight is off by an RMS of {some['RMS']:.4f}, with 200 by {many['RMS']:.4f} "
        f"({many['RMS, machine']:.4f} with the machine's bytes). Gouraud shading does better: its error is "
        f"{some['RMS, Gouraud'] / some['RMS']:.2f} (25 slices) and {many['RMS, Gouraud'] / many['RMS']:.2f} "
        "(200) of that. It also preserves the highlight's light. With 25 slices interpolated cosines lose "
        f"{some['light lost']:.1f} % of it, interpolated colours {lost:.1f} %.",
        "Interpolated cosines are better where the table is not smooth. With 25 slices an edge at n.h = "
        f"{EDGE_AT:g} is off by an RMS of {some['edge']:.3f}, and by {some['edge, Gouraud']:.3f} with "
        "Gouraud shading.",
    )


def checks(table):
    """The catalogue's law, and interpolation of the cosine compared with Gouraud's interpolation."""
    for r in table.records():
        yield DATA.check(
            "deficit of n.h, {which} slices, off 1 - cos(angle / 2)",
            abs(r["deficit of n.h"] - expected(r)),
            Answer.IDEAL,
            at_most=0.02 * expected(r) + 2e-6,
            which=r["slices"],
        )
        yield DATA.check(
            "deficit of n.h on the machine, {which} slices, off 1 - cos(angle / 2)",
            abs(r["deficit, machine"] - expected(r)),
            Answer.MACHINE,
            at_most=1.0 / 255.0,
            which=r["slices"],
        )
    fine = Table(table.columns, tuple(r for r in table.rows if r[0] >= 25))
    for name in ("deficit of n.h", "RMS"):
        yield DATA.check(
            "power of the angle with which the {name} grows from 25 slices on, of 2: deviation",
            abs(slope(fine, name) - 2.0),
            Answer.IDEAL,
            name=name,
        )
    for r in fine.records():
        yield DATA.check(
            "Gouraud's RMS over that of interpolated cosines, {which} slices, off sqrt(3/4)",
            abs(r["RMS, Gouraud"] / r["RMS"] - np.sqrt(0.75)),
            Answer.IDEAL,
            which=r["slices"],
        )
        yield DATA.check(
            "RMS of an edge by Gouraud over that by interpolated cosines, {which} slices",
            r["edge, Gouraud"] / r["edge"],
            Answer.IDEAL,
            which=r["slices"],
        )


def plot(axes, table):
    """The light across the highlight with few slices, and the errors by angle."""
    across, errors = axes
    x = table.curves["x"]
    across.plot(x, table.curves["true"], color=BLACK, lw=1, ls="--", label="Phong, every pixel")
    for slices, color in ((12, ORANGE), (25, BLUE)):
        across.plot(
            x, table.curves[f"fast {slices}"], color=color, label=f"{slices} slices, n.h interpolated"
        )
        across.plot(
            x, table.curves[f"plain {slices}"], color=color, ls=":", label=f"{slices} slices, Gouraud"
        )
    across.set_xlabel("x on a cylinder of radius 1")
    across.set_ylabel("(n.h)^32")
    across.set_ylim(0.0, 1.5)
    across.legend(loc="upper left")
    angle = _angles(table)
    for name, color, marker in (
        ("RMS, Gouraud", RED, "s"),
        ("RMS, machine", BLUE, "o"),
        ("RMS", GREEN, "^"),
        ("deficit of n.h", ORANGE, "v"),
    ):
        errors.loglog(angle, table.column(name), color=color, marker=marker, label=name)
    law = [expected(row) for row in table.records()]
    errors.loglog(angle, law, label="catalogue: 1 - cos(angle / 2)", **EXPECTED)
    errors.set_xticks([2, 5, 10, 20, 45], ["2", "5", "10", "20", "45"])
    errors.minorticks_off()
    errors.set_xlabel("angle between the vertices' normals, degrees")
    errors.set_ylabel("deficit; error in the highlight")
    errors.legend(loc="lower right")


STUDY = Study(
    **DATA.words,
    method=(
        f"(n.h)^{EXPONENT:g} by a table of {_TEXELS} texels on a cylinder of {SLICES[0]} to {SLICES[-1]} "
        "slices in four turns, 2048 pixels across, beside the same at every pixel and beside colours at the "
        "vertices; and a table that is one where n.h > 0.9, else zero. The deficit is that of n.h half way "
        "between two vertices."
    ),
    machines=("OPENGL_1_2", "OCTANE", "GEFORCE_256", "GEFORCE_3", "NV2A"),
    panels=2,
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
