"""P40: how many passes a model needs, by the numbers of a board's texture units and general combiners.

The study builds every effect in every way, for a machine with changed numbers of units and combiners.
``fixedpipe.pipeline.validation`` decides whether this machine can run it. The fewest passes count.

Source: Kautz, Seidel 2000, section 5 (artefact P40 of the catalogue).
"""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.bump_mapping import diffuse_bump, emboss, normalization_cube_map
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.vertex_vectors import half_vectors, light_vectors
from fixedpipe.effects.geometry.views import Light, Panel, orthographic_view
from fixedpipe.effects.reflectance import (
    anisotropic_blinn_phong,
    banks_without_lookup,
    dependent_lookups,
    dot_product_lookups,
    material_textures,
)
from fixedpipe.effects.studies.study import Column, Study, Table
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.validation.validate import validate
from fixedpipe.pipeline.validation.walk import UnsupportedState

DATA = study_data(__file__, "P40")

# Texture units and general combiners; the GeForce 256 has 2 and 2, the GeForce 3 has 4 and 8.
BOARDS = ((1, 1), (1, 2), (2, 1), (2, 2), (2, 5), (4, 2), (4, 5), (4, 8))
_SIZE = 32
_PANEL = Panel(0, 0, _SIZE, _SIZE)
_VIEW, _LIGHT = orthographic_view(_PANEL), Light((0.5, 0.4, 0.77))
_SURFACE = surfaces.plane()
_WHITE = (1.0, 1.0, 1.0)


def _material():
    heights = height_fields.smooth(height_fields.pebbles(_SIZE, _SIZE, 4, 5)) * 0.1
    return material_textures.from_slopes(*height_fields.slopes(heights), 0.3, 0.5)


def _common(profile):
    loading, names = material_textures.load(_material(), "pebbles", profile)
    return loading, names, (_SURFACE, names, _VIEW, _LIGHT, profile)


def _diffuse(names, profile):
    return diffuse_bump.diffuse_pass(_SURFACE, names.normal, _VIEW, _LIGHT, profile, color=_WHITE)


def _eq_1(profile):
    loading, _, given = _common(profile)
    return (*loading, *anisotropic_blinn_phong.specular_pass(*given, first=True))


def _eq_1_in_parts(profile):
    loading, _, given = _common(profile)
    return (*loading, *anisotropic_blinn_phong.specular_passes(*given))


def _bumps_and_eq_1(profile):
    loading, names, given = _common(profile)
    return (*loading, *_diffuse(names, profile), *anisotropic_blinn_phong.specular_pass(*given))


def _blinn(profile):
    loading, names, _ = _common(profile)
    return (
        *loading,
        *diffuse_bump.commands(_SURFACE, names.normal, _VIEW, _LIGHT, profile, color=_WHITE),
    )


def _normalized(profile):
    loading, names, _ = _common(profile)
    half, toward = half_vectors(_SURFACE, _VIEW, _LIGHT), light_vectors(_SURFACE, _LIGHT)
    passes = normalization_cube_map.commands(_SURFACE, toward, half, names, _VIEW, color=_WHITE)
    return (*loading, normalization_cube_map.load(8, profile), *passes)


def _embossed(passes):
    def commands(profile):
        heights = height_fields.smooth(height_fields.pebbles(_SIZE, _SIZE, 4, 5))
        loading, height_map = emboss.load(heights, "pebbles", profile)
        return (*loading, *passes(_SURFACE, height_map, _VIEW, _LIGHT, profile, color=_WHITE, specular=0.5))

    return commands


def _banks(passes):
    def commands(profile):
        loading, names = banks_without_lookup.load(_material(), "pebbles", profile)
        return (*loading, *passes(_SURFACE, names, _VIEW, _LIGHT, profile))

    return commands


def _looked_up(load, passes):
    def commands(profile):
        loading, names = load(_material(), "pebbles", profile)
        return (*loading, *passes(_SURFACE, names, _VIEW, _LIGHT, profile, first=True))

    return commands


def _from_screen(tables, passes):
    def commands(profile):
        loading, names = dependent_lookups.load(_material(), "pebbles", profile)
        made = tables(profile)
        made = made if isinstance(made, tuple) else (made,)
        return (
            *loading,
            dependent_lookups.load_screen(_PANEL),
            *made,
            *passes(_SURFACE, names, _VIEW, _LIGHT, profile),
        )

    return commands


# Each effect with every way of building it.
EFFECTS = {
    "K07 Eq. 1": (_eq_1, _eq_1_in_parts),
    "K10, K07 bumps": (_bumps_and_eq_1,),
    "K14 Blinn-Phong^8": (_blinn,),
    "K12 with cube map": (_normalized,),
    "K13 embossing": (
        _embossed(emboss.one_unit_passes),
        _embossed(emboss.two_unit_passes),
        _embossed(emboss.combiner_passes),
    ),
    "K04 Banks, R*": (
        _banks(banks_without_lookup.specular_passes),
        _banks(banks_without_lookup.specular_pass),
    ),
    "K03 Banks": (_looked_up(dot_product_lookups.load_banks, dot_product_lookups.banks_pass),),
    "K05 one N": (_looked_up(dot_product_lookups.load_blinn_phong, dot_product_lookups.blinn_phong_pass),),
    "K05 N per texel": (_from_screen(dependent_lookups.load_power, dependent_lookups.blinn_phong_passes),),
    "K09 Ward": (_from_screen(dependent_lookups.load_ward_functions, dependent_lookups.ward_passes),),
}


def fewest_passes(ways, profile):
    """The fewest Draws of the ways that the machine can run; None if it can run none."""
    found = []
    for way in ways:
        commands = way(profile)
        try:
            validate(commands, profile, _SIZE, _SIZE)
        except UnsupportedState:
            continue
        found.append(sum(isinstance(command, Draw) for command in commands))
    return min(found, default=None)


def measure(profile):
    """The table, with a row for each effect, a column for each board."""
    boards = [profile.changed(max_texture_units=u, max_general_combiners=c) for u, c in BOARDS]
    rows = tuple((name, *(fewest_passes(ways, board) for board in boards)) for name, ways in EFFECTS.items())
    return Table((Column("effect"), *(Column(f"{u}/{c}", form="d") for u, c in BOARDS)), rows)


def findings(table):
    """The passes of a GeForce 256 and a GeForce 3, only by the numbers of units and combiners."""
    rows = {r["effect"]: r for r in table.records()}
    small, large = [[r[board] for r in rows.values()] for board in ("2/2", "4/8")]
    eq_1, banks_ = rows["K07 Eq. 1"], rows["K04 Banks, R*"]
    return (
        f"Of {len(rows)} effects as built here, {sum(p is not None for p in small)} fit 2 units and 2 "
        f"combiners, in {_range(small)} passes. {sum(p is not None for p in large)} fit 4 units and 8 "
        f"combiners, in {_range(large)} passes.",
        f"Eq. 1 takes {_written(eq_1['1/1'])} passes with one unit and one combiner, and "
        f"{_written(eq_1['2/2'])} with two of each. Banks' model with R* takes {_written(banks_['2/2'])} "
        f"with two of each, and {_written(banks_['2/5'])} with 5 combiners.",
    )


def _written(passes):
    return "-" if passes is None else str(passes)


def _range(passes):
    there = [p for p in passes if p is not None]
    return f"{min(there)} to {max(there)}"


def _number(passes):
    """The number of passes for a check. NaN, for an effect that the machine cannot run, passes no check."""
    return float("nan") if passes is None else float(passes)


def checks(table):
    """The paper's passes, and that more units or combiners never need more passes."""
    rows = {r["effect"]: r for r in table.records()}
    worse = 0
    for row in rows.values():
        for k, (units, combiners) in enumerate(BOARDS):
            for more_units, more_combiners in BOARDS[k + 1 :]:
                few, many = row[f"{units}/{combiners}"], row[f"{more_units}/{more_combiners}"]
                larger = more_units >= units and more_combiners >= combiners
                worse += larger and few is not None and (many is None or many > few)
    one = rows["K07 Eq. 1"]
    ward = rows["K09 Ward"]
    lacking = sum(rows[name]["2/2"] is None for name in ("K03 Banks", "K05 one N", "K09 Ward"))
    return (
        DATA.check("passes of Eq. 1 with 2 units and 2 combiners", _number(one["2/2"]), Answer.MACHINE),
        DATA.check(
            "passes of bumps with both terms, 2 and 2", _number(rows["K10, K07 bumps"]["2/2"]), Answer.MACHINE
        ),
        DATA.check("passes of Eq. 1 with 1 unit and 1 combiner", _number(one["1/1"]), Answer.MACHINE),
        DATA.check(
            "models with dependent lookups that 2 and 2 cannot draw, of 3", float(lacking), Answer.MACHINE
        ),
        DATA.check("passes of Ward's model with 4 and 8", _number(ward["4/8"]), Answer.MACHINE),
        DATA.check("boards with more of either that need more passes", float(worse), Answer.MACHINE),
    )


def plot(axes, table):
    """The table as a picture."""
    (ax,) = axes
    passes = np.array(
        [[np.nan if p is None else float(p) for p in row[1:]] for row in table.rows], np.float64
    )
    ax.imshow(np.log2(passes), cmap="viridis_r", aspect="auto", vmin=0.0, vmax=3.0)
    for i, row in enumerate(passes):
        for j, value in enumerate(row):
            text = "-" if np.isnan(value) else f"{value:.0f}"
            ax.text(j, i, text, ha="center", va="center", color="white" if value > 2.0 else "black")
    ax.grid(False)
    ax.set_xticks(np.arange(len(BOARDS)), [f"{u} / {c}" for u, c in BOARDS])
    ax.set_yticks(np.arange(len(table.rows)), table.column("effect"))
    ax.set_xlabel("texture units / general combiners")
    ax.set_title("fewest passes of the ways there are here; -: none fits", fontsize="medium")


STUDY = Study(
    **DATA.words,
    machines=("GEFORCE_3", "NV2A", "GEFORCE_256"),
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
