"""P23: a shadow map's edge is a stair of texels, and filters of comparisons turn the stairs into ramps.

Source: Zwicker 2016, "sampling problems" and "percentage closer filtering" (artefact P23 of the catalogue).

A straight edge is above a floor under a distant light, and the viewer is above both. So texels are rectangles
of one size on the screen. The machine's edge is compared with the true one in each row of pixels.
"""

import math

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.views import Panel, orthographic_view
from fixedpipe.effects.scenes.objects_and_lamps import Lamp, Object, Scene
from fixedpipe.effects.shadows import shadow_maps
from fixedpipe.effects.shadows.lit_scene import SceneShading
from fixedpipe.effects.studies.shared.strips import drawn
from fixedpipe.effects.studies.study import BLUE, EXPECTED, GREEN, ORANGE, PURPLE, RED, Column, Study, Table

DATA = study_data(__file__, "P23")

EDGES = (16, 32, 64, 128, 256)
# One comparison, the texture unit's linear filter of 2x2, and means of k x k.
FILTER = "2x2 filter"
KERNELS = ("1", FILTER, "2", "4", "8")
# The map's edge in texels for kernels; pixels along the window's edge, and to both sides of the true edge.
_KERNEL_EDGE, _SIZE, _REACH = 64, 256, 48
# Of the polygon offset, beside one for each texel that a comparison is away from its place: a floor that the
# light does not fall straight on would shade itself.
_FACTOR = 1.0
# The plate's edge is so many degrees off the map's rows; the plate's place, all in world units.
_TILT, _HEIGHT, _THICKNESS, _PLATE_X, _PLATE_WIDTH = 17.0, 0.5, 0.02, -1.9, 3.0
_LIGHT = (-0.8, 0.0, 1.0)
# Half of the map's width, in world units: the viewer sees 2.
_HALF_WIDTH = 2.0


def scene():
    """A floor in z = 0, and above its left half a plate with a tilted right edge."""
    plate = surfaces.box(_PLATE_WIDTH, 8.0, _THICKNESS).moved(_PLATE_X, 0.0, _HEIGHT)
    floor, white = surfaces.plane(1, 1, 3.0, 3.0), (1.0, 1.0, 1.0)
    return Scene(
        (
            Object("floor", floor, white, closed=False),
            Object("plate", plate.rotated(rotation("z", -_TILT)), white),
        )
    )


def lamp():
    """The distant light; the rows of its map are parallel to those of the screen."""
    return Lamp(_LIGHT, (0.0, 0.0, 0.0), -4.0, 6.0, infinite=True, half_width=_HALF_WIDTH)


def texel(edge):
    """Width and height of a texel on the floor, in pixels."""
    height = 2.0 * _HALF_WIDTH / edge * (_SIZE / 2.0)
    cosine = _LIGHT[2] / math.sqrt(_LIGHT[0] ** 2 + _LIGHT[2] ** 2)
    return height / cosine, height


def true_edge():
    """Where the shadow's edge crosses each row of pixels, in pixels from the left: float64 [_SIZE]."""
    y = (np.arange(_SIZE) + 0.5) / (_SIZE / 2.0) - 1.0
    tilt, right = math.radians(_TILT), _PLATE_X + _PLATE_WIDTH / 2.0
    # The turned plate's right edge, moved along the light onto the floor; its upper side's is farther out.
    x = (right + math.sin(tilt) * y) / math.cos(tilt) - (_HEIGHT + _THICKNESS / 2.0) * _LIGHT[0] / _LIGHT[2]
    return (x + 1.0) * (_SIZE / 2.0)


def picture(edge, kernel, profile):
    """The light on the floor that the machine draws, 0 to 1: float64 [_SIZE, _SIZE], bottom row first.

    ``kernel``: one of KERNELS.
    """
    view, things, light = orthographic_view(Panel(0, 0, _SIZE, _SIZE)), scene(), lamp()
    reach = 1.0 if kernel == FILTER else int(kernel) / 2.0
    stored = shadow_maps.store_map(
        things, light, "map", edge, (_SIZE, _SIZE), factor=_FACTOR + reach, units=4.0
    )
    given = things, view, light, "map"
    if kernel in ("1", FILTER):
        passes = shadow_maps.modulated_passes(*given, profile, SceneShading.MASK, filtered=kernel == FILTER)
    else:
        passes = shadow_maps.accumulated_passes(
            *given, edge, profile, int(kernel), SceneShading.MASK, units=1
        )
    return drawn((*stored, view.panel.clear((0.0, 0.0, 0.0)), *passes), profile, _SIZE, _SIZE)[..., 0]


def ramp(lit):
    """The mean brightness across the edge: distances from the true edge, in pixels along a row; the mean at
    each distance; and the standard deviation along the edge.
    """
    distance = np.arange(_SIZE) + 0.5 - true_edge()[:, None]
    at = np.floor(distance + _REACH).astype(int)
    kept = (at >= 0) & (at < 2 * _REACH)
    count = np.bincount(at[kept], minlength=2 * _REACH)
    mean = np.bincount(at[kept], lit[kept], 2 * _REACH) / count
    square = np.bincount(at[kept], lit[kept] ** 2, 2 * _REACH) / count
    return np.arange(2 * _REACH) + 0.5 - _REACH, mean, np.sqrt(np.maximum(square - mean * mean, 0.0))


def middle(distances, mean):
    """The mean place of the edge, in pixels along a row from the true edge."""
    weights = np.diff(mean)
    return float((weights * 0.5 * (distances[1:] + distances[:-1])).sum() / weights.sum())


def spread(distances, mean):
    """The standard deviation of the edge's place, in pixels perpendicular to it, from its mean ramp."""
    weights = np.diff(mean)
    at = 0.5 * (distances[1:] + distances[:-1])
    variance = (weights * (at - middle(distances, mean)) ** 2).sum() / weights.sum()
    return math.sqrt(variance) * math.cos(math.radians(_TILT))


def expected_spread(edge, kernel):
    """The standard deviation that texels explain.

    Inferred: the edge may be anywhere in a texel; k texels in a row have k times its extent; the ramp of a
    linear filter is two texels long, with a triangular weight. A pixel adds its own width.
    """
    width, height = texel(edge)
    stretch = 2.0 if kernel == FILTER else float(int(kernel) ** 2)
    slope = math.tan(math.radians(_TILT))
    variance = (stretch * (width**2 + (height * slope) ** 2) + 1.0) / 12.0
    return math.sqrt(variance) * math.cos(math.radians(_TILT))


def measure(profile):
    """The table, with a row for each map without a filter, then one for each kernel."""
    rows, curves = [], {}
    for edge, kernel in (*((e, "1") for e in EDGES), *((_KERNEL_EDGE, k) for k in KERNELS[1:])):
        distances, mean, deviation = ramp(picture(edge, kernel, profile))
        rows.append(
            (
                edge,
                kernel,
                texel(edge)[0],
                spread(distances, mean),
                expected_spread(edge, kernel),
                float(deviation[_REACH - 1 : _REACH + 1].mean()),
            )
        )
        curves[f"{edge} {kernel}"] = np.stack([distances, mean, deviation])
    columns = (
        Column("map", "texels", "d"),
        Column("comparisons"),
        Column("a texel", "pixels", ".2f"),
        Column("edge is off", "pixels, RMS", ".2f"),
        Column("texels explain", "pixels, RMS", ".2f"),
        Column("stairs", "of full light, RMS", ".3f"),
    )
    return Table(columns, tuple(rows), curves)


def _of_kernels(table):
    """The rows of one map, by kernel."""
    return [row for row in table.rows if row[0] == _KERNEL_EDGE]


def findings(table):
    """The errors of edges, and the effect of filters on them."""
    first, last = table.rows[0], table.rows[len(EDGES) - 1]
    plain, linear, *_, wide = _of_kernels(table)
    wider = wide[3] / plain[3]
    return (
        f"Where a texel is {first[2]:.1f} pixels wide, the edge is off by {first[3]:.1f} pixels; where it "
        f"is {last[2]:.1f} wide, by {last[3]:.2f}. These are {first[3] / first[2]:.2f} and "
        f"{last[3] / last[2]:.2f} texels.",
        f"The stairs have a height of {plain[5]:.2f} of full light. The linear filter of 2x2 comparisons "
        f"reduces it to {linear[5]:.2f}. {wide[1]} x {wide[1]} comparisons reduce it to {wide[5]:.3f}, over "
        f"a ramp {wider:.1f} times as wide.",
    )


def checks(table):
    """Jaggedness has the size of a texel, and stairs are lower with more comparisons."""
    worst = max(abs(row[3] / row[4] - 1.0) for row in table.rows)
    plain, linear, *rest = _of_kernels(table)
    beside = [middle(*table.curves[f"{row[0]} {row[1]}"][:2]) / row[2] for row in table.rows]
    products = [row[5] * int(row[1]) for row in rest]
    return (
        DATA.check(
            "how far the edge is off over what texels explain, - 1: largest absolute", worst, Answer.MACHINE
        ),
        DATA.check(
            "edge's middle beside the true edge, texels, largest absolute",
            max(map(abs, beside)),
            Answer.MACHINE,
        ),
        DATA.check("stairs without a filter, of full light, RMS", plain[5], Answer.MACHINE),
        DATA.check("stairs of k x k comparisons times k, largest", max(products), Answer.MACHINE),
        DATA.check("stairs of the linear filter over those without", linear[5] / plain[5], Answer.MACHINE),
    )


def plot(axes, table):
    """Jaggedness by texels on the screen, and ramps by kernels."""
    by_texel, across = axes
    rows = table.rows[: len(EDGES)]
    by_texel.loglog([r[2] for r in rows], [r[3] for r in rows], color=BLUE, marker="o", label="machine")
    by_texel.loglog([r[2] for r in rows], [r[4] for r in rows], label="texels explain", **EXPECTED)
    by_texel.set_xlabel("a texel's width on the screen, pixels")
    by_texel.set_ylabel("the edge is off by, pixels, RMS")
    by_texel.legend()
    for kernel, color in zip(KERNELS, (BLUE, ORANGE, GREEN, RED, PURPLE), strict=True):
        distances, mean, _ = table.curves[f"{_KERNEL_EDGE} {kernel}"]
        name = kernel if kernel == FILTER else f"{kernel} x {kernel}"
        across.plot(distances, mean, color=color, label=name)
    across.set_xlabel("distance from the true edge, pixels along a row")
    across.set_ylabel("mean light")
    across.legend()


STUDY = Study(
    **DATA.words,
    method=(
        f"A straight edge in {_SIZE} pixels, seen from above; where it is in each row of pixels against the "
        "true line, and how much pixels at the true line differ."
    ),
    machines=("GEFORCE_3", "NV2A"),
    panels=2,
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
