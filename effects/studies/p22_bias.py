"""P22: how far a shadow map's depths are moved, and what too little and too much of it does.

Source: Zwicker 2016 (artefact P22 of the catalogue).
"""

from itertools import pairwise

from fixedpipe.effects.acceptance import agreement
from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.map_bias import acne, gap, shadows_under_offsets
from fixedpipe.effects.geometry.views import Panel
from fixedpipe.effects.scenes.board import board_view, ring_and_board
from fixedpipe.effects.shadows.lit_scene import SceneShading, map_edge
from fixedpipe.effects.shadows.shadow_maps import OFFSET_FACTOR, OFFSET_UNITS
from fixedpipe.effects.studies.shared.strips import drawn
from fixedpipe.effects.studies.study import BLUE, ORANGE, RED, Column, Study, Table

_SIZE, _RATIO = 256, 1
# (factor, units): slopes with the catalogue's units, and units without any slope.
FACTORS = (0.0, 0.25, 0.5, 0.75, 1.0, OFFSET_FACTOR, 1.5, 2.0, 4.0, 8.0, 14.0)
UNITS = (0.0, 4.0, 1e3, 1e4, 3e4, 1e5, 2e5, 4e5, 1e6)


def measure(profile):
    """A row for each offset: speckle on the lit floor, and the gap behind a thin board."""
    offsets = (*((factor, OFFSET_UNITS) for factor in FACTORS), *((0.0, units) for units in UNITS))
    scene, lamp = ring_and_board(_SIZE)
    truth = agreement.truth_of(scene, board_view(Panel(0, 0, _SIZE, _SIZE)), lamp)
    edge = map_edge(_SIZE, _RATIO)
    rows = []
    for factor, units in offsets:
        commands = shadows_under_offsets(
            profile, _SIZE, ratio=_RATIO, offsets=((factor, units),), shading=SceneShading.MASK
        )
        mask = agreement.lit_mask(drawn(commands, profile, _SIZE, _SIZE))
        found = agreement.compare(mask, truth, where=truth.shown.object == 0)
        rows.append(
            (factor, units, 100.0 * acne(mask, truth), gap(mask, truth, edge), 100.0 * found.agreeing)
        )
    columns = (
        Column("factor", form=".2f"),
        Column("units", form=".0f"),
        Column("lit floor that is dark", "%", ".2f"),
        Column("gap behind the board", "texels", ".2f"),
        Column("floor that agrees with rays", "%", ".2f"),
    )
    return Table(columns, tuple(rows))


def _sweep(table, by_slope):
    """The rows of one sweep."""
    rows = table.records()
    return rows[: len(FACTORS)] if by_slope else rows[len(FACTORS) :]


def _first_clean(rows):
    """The first row of a sweep from which on at most 0.1 % of the lit floor is dark."""
    clean = [r["lit floor that is dark"] <= 0.1 for r in rows]
    return next(row for k, row in enumerate(rows) if all(clean[k:]))


def findings(table):
    """What it takes to be rid of speckle, and what that costs, by slope and by a constant."""
    none = table.records()[0]
    slope, constant = (_first_clean(_sweep(table, by_slope)) for by_slope in (True, False))
    most = _sweep(table, True)[-1]
    return (
        f"With a factor of 0 and {none['units']:.0f} units {none['lit floor that is dark']:.0f} % of the lit "
        "floor shades itself.",
        f"A factor of {slope['factor']:.2f} ends that, and leaves a gap of "
        f"{slope['gap behind the board']:.1f} texels; by units alone it takes {constant['units']:.0f}, "
        f"and the gap is {constant['gap behind the board']:.1f} too, but it is a number of this light, "
        "this map and this floor alone.",
        f"At a factor of {most['factor']:.0f} the board's shadow begins at least "
        f"{most['gap behind the board']:.1f} texels behind it, and rays agree on "
        f"{most['floor that agrees with rays']:.1f} % of the floor instead of "
        f"{slope['floor that agrees with rays']:.1f}.",
    )


def checks(table):
    """The catalogue's numbers, and where the sweep must turn."""
    slopes = _sweep(table, True)
    none = _sweep(table, False)[0]
    (right,) = [r for r in slopes if r["factor"] == OFFSET_FACTOR]
    said = "the catalogue's (figure F003-21)"
    gaps = [r["gap behind the board"] for r in slopes]
    return (
        Check("no offset: lit floor that is dark, %", none["lit floor that is dark"], at_least=20.0,
              on=Answer.MACHINE, reason=said),
        Check("1.1 and 4: lit floor that is dark, %", right["lit floor that is dark"], at_most=0.1,
              on=Answer.MACHINE, reason=said),
        Check("1.1 and 4: gap, texels", right["gap behind the board"], at_most=1.0, on=Answer.MACHINE,
              reason=said),
        Check("14 and 4: gap, texels", gaps[-1], at_least=3.0, on=Answer.MACHINE, reason=said),
        Check("factor that ends speckle", _first_clean(slopes)["factor"], at_least=0.75, on=Answer.MACHINE,
              reason="a pixel's place and its texel's centre are up to half "
              "a texel apart along both axes: up to one greatest slope"),
        Check("factor that ends speckle, at most", _first_clean(slopes)["factor"], at_most=1.1,
              on=Answer.MACHINE, reason="as before; factor 1 with a unit for each rounding"),
        Check("the gap's largest fall as the factor grows, texels", max(a - b for a, b in pairwise(gaps)),
              at_most=0.5, on=Answer.MACHINE, reason="more offset opens the gap; which texels the board's "
              "edge covers is chance within half of one"),
    )  # fmt: skip


def plot(axes, table):
    """Speckle and gap by slope and by units."""
    for ax, by_slope in zip(axes, (True, False), strict=True):
        rows = _sweep(table, by_slope)
        places = range(len(rows))
        name = "factor" if by_slope else "units"
        ax.plot(places, [r["lit floor that is dark"] for r in rows], color=BLUE, marker="o", label="dark, %")
        ax.axhline(0.1, color=BLUE, linestyle=":", label="0.1 %")
        ax.set_ylabel("lit floor that is dark, %", color=BLUE)
        ax.set_xticks(list(places), [f"{r[name]:g}" for r in rows], rotation=45)
        ax.set_xlabel("factor, with 4 units" if by_slope else "units, with factor 0")
        other = ax.twinx()
        other.plot(
            places, [r["gap behind the board"] for r in rows], color=ORANGE, marker="s", label="gap, texels"
        )
        other.axhline(1.0, color=RED, linestyle=":", label="1 texel")
        other.set_ylabel("gap behind the board, texels", color=ORANGE)
        other.set_ylim(bottom=0.0)


STUDY = Study(
    id="P22",
    title="A shadow map's bias",
    question="How far must a map's depths be moved so that nothing lit shades itself, and what does more do?",
    method=(
        f"The scene of F003-21 with a map of {map_edge(_SIZE, _RATIO)} texels and 24 bits under "
        f"{len(FACTORS) + len(UNITS)} polygon offsets; the picture's mask beside rays."
    ),
    source="Zwicker2016",
    techniques=("Z10", "Z12"),
    machines=("GEFORCE_3", "NV2A", "INFINITE_REALITY"),
    panels=2,
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
