"""P35: points at a shadow map's farthest depth, compared with or without equality.

Source: artefact P35 of the catalogue, of document 003's two-pass algorithm (Z10).
"""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.views import Panel, orthographic_view
from fixedpipe.effects.scenes.objects_and_lamps import Lamp, Object, Scene
from fixedpipe.effects.shadows.lit_scene import draw_object
from fixedpipe.effects.shadows.shadow_maps import OFFSET_FACTOR, OFFSET_UNITS, map_unit, store_map
from fixedpipe.effects.studies.shared.strips import drawn
from fixedpipe.effects.studies.study import BLUE, ORANGE, Column, Study, Table
from fixedpipe.pipeline.enums import ComparisonFunction

DATA = study_data(__file__, "P35")

_SIZE, _EDGE = 64, 64
_WHITE = (1.0, 1.0, 1.0)
_NEAR, _FAR = 1.0, 5.0
# Where the receiver is, in the light's linear depth from its near plane (0) to its far plane (1).
PLACES = (("within", 0.75), ("at the far plane", 1.0), ("beyond", 1.25))
LIGHTS = (("parallel", True), ("spot", False))
FUNCTIONS = (ComparisonFunction.LEQUAL, ComparisonFunction.LESS)


def _lamp(infinite):
    """A light that looks straight down -z from z = 0."""
    return Lamp(
        (0.0, 0.0, 0.0), (0.0, 0.0, -1.0), _NEAR, _FAR, field_of_view=60.0, infinite=infinite, half_width=2.5
    )


def lit(profile, infinite, depth, function, cast):
    """The lit part of a square perpendicular to the light at a depth, [0, 1].

    ``cast``: the PolygonOffset (factor, units) with which the square is also drawn into the map; None: the
    map only has its clear value.
    """
    lamp = _lamp(infinite)
    z = -(_NEAR + depth * (_FAR - _NEAR))
    square = Object("square", surfaces.plane(3, 3, 1.9, 1.9).moved(0.0, 0.0, z), _WHITE, closed=False)
    casters = Scene(() if cast is None else (square,))
    factor, units = cast or (0.0, 0.0)
    panel = Panel(0, 0, _SIZE, _SIZE)
    view = orthographic_view(panel, 2.0, 16.0)
    unit = map_unit(lamp.texture_matrix, "map", profile, function=function)
    commands = (
        *store_map(casters, lamp, "map", _EDGE, (_SIZE, _SIZE), factor=factor, units=units),
        panel.clear((0.0, 0.0, 0.0)),
        draw_object("compare", square, view, texture_units=(unit,)),
    )
    picture = drawn(commands, profile, _SIZE, _SIZE)[..., 0]
    inside = picture[4:-4, 4:-4]
    return float((inside > 0.5).mean())


def measure(profile):
    """The table, with a row for each light, place and function that the machine has."""
    rows = []
    for light, infinite in LIGHTS:
        for place, depth in PLACES:
            for function in FUNCTIONS:
                if function in profile.textures.shadow_functions:
                    parts = (
                        100.0 * lit(profile, infinite, depth, function, cast)
                        for cast in (None, (OFFSET_FACTOR, OFFSET_UNITS), (0.0, 0.0))
                    )
                    rows.append((light, place, function.name, *parts))
    columns = (
        Column("light"),
        Column("square"),
        Column("function"),
        Column("lit, map empty", "%", ".1f"),
        Column("lit, square in the map", "%", ".1f"),
        Column("the same, no offset", "%", ".1f"),
    )
    return Table(columns, tuple(rows))


def _of(table, **wanted):
    return [r for r in table.records() if all(r[name] == value for name, value in wanted.items())]


def findings(table):
    """The effect of equality at the farthest depth."""
    less = [r for r in _of(table, function="LESS") if r["square"] != "within"]
    equal = [r for r in _of(table, function="LEQUAL") if r["square"] != "within"]
    lost = {r["light"]: r for r in less if r["square"] == "at the far plane"}
    bare = {r["function"]: r["the same, no offset"] for r in _of(table, light="parallel", square="within")}
    return (
        "With LEQUAL, everything at the far plane or beyond it is lit under an empty map: at least "
        f"{min(r['lit, map empty'] for r in equal):.0f} %. The reason is that r is clamped to the farthest "
        "depth, to which the map was cleared.",
        *(
            f"With LESS, {row['lit, map empty']:.0f} % is lit at the far plane under a {light} light."
            for light, row in lost.items()
        ),
        "A parallel light's r is not divided. A spot light's is r over q, cut to 24 bits, and may lie below "
        "the farthest depth.",
        "A square in the map without an offset is lit by equality alone. Within the planes, "
        f"{bare['LEQUAL']:.0f} % of it is lit with LEQUAL and {bare['LESS']:.0f} % with LESS.",
    )


def checks(table):
    """Far pixels are unlit with one function, and lit with the other."""
    for row in table.records():
        name = f"{row['light']} light, {row['square']}, {row['function']}: lit under an empty map, %"
        if row["square"] == "within" or row["function"] == "LEQUAL":
            yield Check(
                name,
                row["lit, map empty"],
                at_least=100.0,
                on=Answer.MACHINE,
                reason="nothing is in the light's way",
            )
        elif row["square"] == "beyond" or row["light"] == "parallel":
            reason = "the catalogue's unlit far pixels: r is held at the cleared map's depth"
            yield Check(name, row["lit, map empty"], at_most=0.0, on=Answer.MACHINE, reason=reason)


def plot(axes, table):
    """The lit part by place, for both functions."""
    (ax,) = np.atleast_1d(axes)
    places = [f"{light}\n{place}" for light, _ in LIGHTS for place, _ in PLACES]
    for k, (function, color) in enumerate((("LEQUAL", BLUE), ("LESS", ORANGE))):
        rows = _of(table, function=function)
        if rows:
            at = np.arange(len(rows)) + 0.4 * k - 0.2
            ax.bar(at, [r["lit, map empty"] for r in rows], 0.36, color=color, label=f"r {function} texel")
    ax.set_xticks(range(len(places)), places)
    ax.set_ylabel("lit under an empty map, %")
    ax.set_ylim(0.0, 125.0)
    ax.legend(loc="upper right", ncols=2)


STUDY = Study(
    **DATA.words,
    method=(
        f"A square across the light, {_SIZE} by {_SIZE} pixels, within the light's planes, at the far one "
        "and beyond it, compared with a map that is empty and with one that holds it."
    ),
    machines=("GEFORCE_3", "NV2A"),
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
