"""P19: vectors as vertex colours (bytes, linearly interpolated, not normalized), or one for each polygon.

One light shines on a cylinder of few or many slices. In one way, the vertices at every slice's edges have
halfway vectors of their own (K07). In the other, every slice has one vector, as the imaging subset needs
(section 4.2: the facets).

Source: Kautz, Seidel 2000, sections 4.2 and 5 (artefact P19 of the catalogue).
"""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.geometry.vectors import cosine, sine
from fixedpipe.effects.geometry.vertex_vectors import half_vectors
from fixedpipe.effects.geometry.views import Light, Panel, orthographic_view
from fixedpipe.effects.passes.encoding import vector_colors, vectors_of_texels
from fixedpipe.effects.reflectance import anisotropic_blinn_phong, brdfs, material_textures
from fixedpipe.effects.studies.shared.cylinders import cylinder
from fixedpipe.effects.studies.shared.strips import drawn
from fixedpipe.effects.studies.study import (
    BLACK,
    BLUE,
    EXPECTED,
    GREEN,
    ORANGE,
    PURPLE,
    RED,
    Column,
    Study,
    Table,
)
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import IDEAL
from fixedpipe.pipeline.state import PassState

DATA = study_data(__file__, "P19")

SLICES = (8, 16, 25, 50, 100, 200)
ALPHA = 0.25
# Where the highlight is on the cylinder, radians from the viewer: the catalogue's halfway vector.
HIGHLIGHT = float(np.arctan(0.45))
_WIDTH, _HEIGHT = 2048, 8
_PANEL = Panel(0, 0, _WIDTH, _HEIGHT)
_VIEW = orthographic_view(_PANEL, half_height=_HEIGHT / _WIDTH)
_LIGHT = Light((float(sine(2.0 * HIGHLIGHT)), 0.0, float(cosine(2.0 * HIGHLIGHT))))
# Turns of the cylinder that are averaged, in slices.
_PHASES = (0.0, 0.25, 0.5, 0.75)


def highlight(surface, profile):
    """Eq. 1 for a smooth material on the cylinder, across the picture: float64 [_WIDTH]."""
    material = material_textures.isotropic(1, 1, ALPHA)
    loading, names = material_textures.load(material, "smooth", profile)
    passes = anisotropic_blinn_phong.specular_pass(surface, names, _VIEW, _LIGHT, profile, first=True)
    commands = (_PANEL.clear((0.0, 0.0, 0.0)), *loading, *passes)
    if profile.arithmetic.exact:
        return execute_ideal(commands, _WIDTH, _HEIGHT).color[_HEIGHT // 2, :, 0]
    return drawn(commands, profile, _WIDTH, _HEIGHT)[_HEIGHT // 2, :, 0]


def true_highlight():
    """The same highlight without polygons, and its places: float64 [_WIDTH] each."""
    x = (np.arange(_WIDTH) + 0.5) * (2.0 / _WIDTH) - 1.0
    angle = np.arcsin(x)
    half = np.stack([np.sin(HIGHLIGHT - angle), 0.0 * x, np.cos(HIGHLIGHT - angle)], axis=-1)
    value = brdfs.anisotropic_blinn_phong(half, np.eye(3)[0], np.eye(3)[1], ALPHA, ALPHA)
    return x, np.where(half[:, 2] > 0.0, value, 0.0)


def shortest(surface, profile):
    """The smallest length of the interpolated halfway vector between two vertices, from the machine's
    framebuffer.
    """
    colors = vector_colors(half_vectors(surface, _VIEW, _LIGHT), profile)
    state = PassState(vertex=_VIEW.vertex)
    picture = drawn(
        (Draw(label="h", mesh=surface.mesh(colors=colors), state=state),), profile, _WIDTH, _HEIGHT
    )
    read = vectors_of_texels(255.0 * picture[_HEIGHT // 2], profile)
    inner = slice(_WIDTH // 4, 3 * _WIDTH // 4)
    return float(np.sqrt((read * read).sum(axis=-1))[inner].min())


def slope_jump(slices):
    """The jump of the highlight's slope at a vertex half way down its flank, divided by the steepest slope
    2/alpha. The ideal draws it, so it shows interpolation without rounding.
    """
    vertex = HIGHLIGHT + np.arcsin(ALPHA / 2.0)
    step = 2.0 * np.pi / slices
    value = highlight(cylinder(slices, vertex - round(vertex / step) * step), IDEAL)
    x, _ = true_highlight()
    at = int(np.searchsorted(x, np.sin(vertex)))
    slopes = [
        np.polyfit(x[side] - np.sin(vertex), value[side], 2)[1]
        for side in (slice(at - 7, at - 1), slice(at + 1, at + 7))
    ]
    return float(abs(slopes[1] - slopes[0]) * ALPHA / 2.0)


def _half_width(x, value):
    above = x[value >= 0.5]
    return float(above.max() - above.min()) if len(above) else 0.0


def measure(profile):
    """The table, with a row for each number of slices."""
    x, true = true_highlight()
    lit, rows, curves = true > 0.0, [], {"x": x, "true": true}
    for slices in SLICES:
        step = 2.0 * np.pi / slices
        smooth, exact, facets, widths = [], [], [], []
        for phase in _PHASES:
            surface = cylinder(slices, phase * step)
            smooth.append(highlight(surface, profile))
            exact.append(highlight(surface, IDEAL))
            facets.append(highlight(cylinder(slices, phase * step, faceted=True), profile))
            widths.append(_half_width(x, smooth[-1]))
        rows.append(
            (
                slices,
                float(np.degrees(step)),
                shortest(cylinder(slices, 0.0), profile),
                float(np.cos(step / 2.0)),
                root_mean_square((np.stack(exact) - true)[:, lit]),
                root_mean_square((np.stack(smooth) - true)[:, lit]),
                100.0 * slope_jump(slices),
                100.0 * (max(widths) - min(widths)) / _half_width(x, true),
                root_mean_square((np.stack(facets) - true)[:, lit]),
            )
        )
        if slices in (16, 50):
            curves[f"vertex {slices}"], curves[f"polygon {slices}"] = smooth[0], facets[0]
    columns = (
        Column("slices", form="d"),
        Column("angle", "degrees", ".1f"),
        Column("shortest |h|", form=".4f"),
        Column("cos half angle", form=".4f"),
        Column("RMS, float64", form=".4f"),
        Column("RMS, machine", form=".4f"),
        Column("slope jump", "%", ".1f"),
        Column("width varies", "%", ".1f"),
        Column("RMS, a vector a polygon", form=".4f"),
    )
    return Table(columns, tuple(rows), curves)


def _power(table, name):
    """The power of the angle with which a column falls, between 16 slices and 50."""
    rows = {r["slices"]: r for r in table.records()}
    return float(np.log(rows[16][name] / rows[50][name]) / np.log(rows[16]["angle"] / rows[50]["angle"]))


def findings(table):
    """The errors of vertex colours and of polygons."""
    rows = {r["slices"]: r for r in table.records()}
    coarse, paper, fine = rows[8], rows[50], rows[200]
    power = _power(table, "RMS, float64")
    return (
        f"Between vertices {coarse['angle']:g} degrees apart |h| falls to {coarse['shortest |h|']:.3f}. "
        f"Without rounding, the highlight's RMS error falls with the power {power:.1f} of the angle: "
        f"{paper['RMS, float64']:.4f} with 50 slices and {fine['RMS, float64']:.4f} with 200. With the "
        f"machine's bytes it is {paper['RMS, machine']:.4f} and {fine['RMS, machine']:.4f}.",
        f"The highlight's slope jumps at a vertex, by {coarse['slope jump']:.0f} % of the steepest slope "
        f"with 8 slices and by {paper['slope jump']:.1f} % with 50. With 50 slices and one vector for a "
        f"whole polygon, the RMS is {paper['RMS, a vector a polygon']:.3f}, "
        f"{paper['RMS, a vector a polygon'] / paper['RMS, machine']:.0f} times that of vertex colours.",
    )


def checks(table):
    """The catalogue's length, and its claims in words."""
    rows = {r["slices"]: r for r in table.records()}
    jumps, polygons = table.column("slope jump"), table.column("RMS, a vector a polygon")
    for r in table.records():
        yield DATA.check(
            "|h| in the middle of an edge, {which} slices, off cos(angle / 2)",
            abs(r["shortest |h|"] - r["cos half angle"]),
            Answer.MACHINE,
            at_most=3.0 / 255.0,
            which=r["slices"],
        )
    yield DATA.check(
        "power of the angle with which the RMS falls, of 2: deviation",
        abs(_power(table, "RMS, float64") - 2.0),
        Answer.IDEAL,
    )
    yield DATA.check(
        "power of the angle with which the slope's jump falls, of 1: deviation",
        abs(_power(table, "slope jump") - 1.0),
        Answer.IDEAL,
    )
    yield DATA.check("slope's jump with 8 slices, %", jumps[0], Answer.IDEAL)
    yield DATA.check(
        "RMS with a vector a polygon over that with vertex colours, 50 slices",
        polygons[3] / rows[50]["RMS, machine"],
        Answer.MACHINE,
    )


def plot(axes, table):
    """The values across the highlight with few and many slices, and the errors by angle."""
    across, errors = axes
    x = table.curves["x"]
    shown = np.abs(x - np.sin(HIGHLIGHT)) < 0.36
    across.plot(x[shown], table.curves["true"][shown], color=BLACK, lw=1, ls="--", label="no polygons")
    for slices, color in ((16, ORANGE), (50, BLUE)):
        across.plot(
            x[shown], table.curves[f"vertex {slices}"][shown], color=color, lw=1.5, label=f"{slices} slices"
        )
        label = f"{slices} slices, a vector a polygon"
        across.plot(x[shown], table.curves[f"polygon {slices}"][shown], color=color, ls=":", label=label)
    across.set_xlabel("x on a cylinder of radius 1")
    across.set_ylabel("Eq. 1, alpha = 1/4, on the machine")
    across.set_ylim(0.0, 1.6)
    across.legend(loc="upper left")
    angle = table.column("angle")
    for name, color, marker in (
        ("RMS, a vector a polygon", RED, "s"),
        ("RMS, machine", BLUE, "o"),
        ("RMS, float64", GREEN, "^"),
    ):
        errors.loglog(angle, table.column(name), color=color, marker=marker, label=name)
    dip = [1.0 - length for length in table.column("shortest |h|")]
    errors.loglog(angle, dip, color=PURPLE, marker="v", label="1 - shortest |h|, machine")
    expected = [1.0 - c for c in table.column("cos half angle")]
    errors.loglog(angle, expected, label="catalogue: 1 - cos(angle / 2)", **EXPECTED)
    errors.set_xticks([2, 5, 10, 20, 45], ["2", "5", "10", "20", "45"])
    errors.minorticks_off()
    errors.set_ylim(1e-4, 20.0)
    errors.set_xlabel("angle between the vertices' vectors, degrees")
    errors.set_ylabel("error in the highlight; loss of length")
    errors.legend(loc="upper left")


STUDY = Study(
    **DATA.words,
    machines=("GEFORCE_256", "GEFORCE_3", "NV2A", "FUTURE"),
    panels=2,
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
