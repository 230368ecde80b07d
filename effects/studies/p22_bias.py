"""P22: the bias of a shadow map's depths, and the effect of a bias that is too small or too large.

Source: Zwicker 2016 (artefact P22 of the catalogue).
"""

from itertools import pairwise

from fixedpipe.effects.acceptance import agreement
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.map_bias import acne, gap, shadows_under_offsets
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.geometry.views import Panel
from fixedpipe.effects.scenes.board import board_view, ring_and_board
from fixedpipe.effects.shadows.lit_scene import SceneShading, map_edge
from fixedpipe.effects.shadows.shadow_maps import OFFSET_FACTOR, OFFSET_UNITS
from fixedpipe.effects.studies.shared.strips import drawn
from fixedpipe.effects.studies.study import BLUE, ORANGE, RED, Column, Study, Table

DATA = study_data(__file__, "P22")

_SIZE, _RATIO = 256, 1
# (factor, units): slopes with the catalogue's units, and units without any slope.
FACTORS = (0.0, 0.25, 0.5, 0.75, 1.0, OFFSET_FACTOR, 1.5, 2.0, 4.0, 8.0, 14.0)
UNITS = (0.0, 4.0, 1e3, 1e4, 3e4, 1e5, 2e5, 4e5, 1e6)


def measure(profile):
    """The table, with a row for each offset: speckle on the lit floor, and the gap behind a thin board."""
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
    """The first row of a sweep such that from there on at most 0.1 % of the lit floor is dark."""
    clean = [r["lit floor that is dark"] <= 0.1 for r in rows]
    return next(row for k, row in enumerate(rows) if all(clean[k:]))


def findings(table):
    """The bias that removes speckle, and the gap that it causes, with a slope and with a constant."""
    none = table.records()[0]
    slope, constant = (_first_clean(_sweep(table, by_slope)) for by_slope in (True, False))
    most = _sweep(table, True)[-1]
    return (
        f"With a factor of 0 and {none['units']:.0f} units, {none['lit floor that is dark']:.0f} % of the "
        "lit floor shades itself.",
        f"A factor of {slope['factor']:.2f} ends that, and leaves a gap of "
        f"{slope['gap behind the board']:.1f} texels. With units alone it takes {constant['units']:.0f} "
        f"units, and the gap is {constant['gap behind the board']:.1f} too. But that number holds only for "
        "this light, this map and this floor.",
        f"At a factor of {most['factor']:.0f} the board's shadow begins at least "
        f"{most['gap behind the board']:.1f} texels behind it. Rays then agree on "
        f"{most['floor that agrees with rays']:.1f} % of the floor instead of "
        f"{slope['floor that agrees with rays']:.1f}.",
    )


def checks(table):
    """The catalogue's numbers, and the place where the sweep must turn."""
    slopes = _sweep(table, True)
    none = _sweep(table, False)[0]
    (right,) = [r for r in slopes if r["factor"] == OFFSET_FACTOR]
    gaps = [r["gap behind the board"] for r in slopes]
    return (
        DATA.check("no offset: lit floor that is dark, %", none["lit floor that is dark"], Answer.MACHINE),
        DATA.check("1.1 and 4: lit floor that is dark, %", right["lit floor that is dark"], Answer.MACHINE),
        DATA.check("1.1 and 4: gap, texels", right["gap behind the board"], Answer.MACHINE),
        DATA.check("14 and 4: gap, texels", gaps[-1], Answer.MACHINE),
        DATA.check("factor that ends speckle", _first_clean(slopes)["factor"], Answer.MACHINE),
        DATA.check("factor that ends speckle, at most", _first_clean(slopes)["factor"], Answer.MACHINE),
        DATA.check(
            "the gap's largest fall as the factor grows, texels",
            max(a - b for a, b in pairwise(gaps)),
            Answer.MACHINE,
        ),
    )


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
    **DATA.words,
    method=(
        f"The scene of F003-21 with a map of {map_edge(_SIZE, _RATIO)} texels and 24 bits under "
        f"{len(FACTORS) + len(UNITS)} polygon offsets; the picture's mask beside rays."
    ),
    machines=("GEFORCE_3", "NV2A", "INFINITE_REALITY"),
    panels=2,
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
