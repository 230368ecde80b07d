"""Colours of fragments before the per-fragment operations: values, texels, combiners, color sum and fog."""

from dataclasses import replace

import numpy as np

from fixedpipe.pipeline.enums import FogMode, Register, ShadeModel, TextureCompareMode, TextureFilter
from fixedpipe.pipeline.ideal.combine import combine, constant_color
from fixedpipe.pipeline.ideal.coordinates import made_place, place, reference_of, spherical, turned_place
from fixedpipe.pipeline.ideal.sample import as_register, sample
from fixedpipe.pipeline.ideal.texture_shader import run_stages
from fixedpipe.pipeline.ideal.weights import fixed
from fixedpipe.pipeline.profiles import IDEAL
from fixedpipe.pipeline.programs.combiner_rules import has_color_sum
from fixedpipe.pipeline.programs.future import units_along
from fixedpipe.pipeline.programs.texture_environment import environment_program


def shade(state, textures, primitives, weights):
    """Colours of fragments before the per-fragment operations, float64 [k, 4] in [0, 1], and the Outcome of a
    texture shader, or None.

    ``textures``: name to Texture with ideal levels. ``primitives``: as the vertex stage makes them;
    ``weights``: those of ``weigh``.
    """
    rows = fixed(primitives.colors).reshape(-1, 16)
    back = 8 if primitives.two_side else 0
    if state.polygon.shade_model is ShadeModel.FLAT:
        colors = [weights.provoking(rows, first, back) for first in (0, 4)]
    else:
        colors = [weights.iterate(rows, first, back) for first in (0, 4)]
        turned = state.spherical_primary_color, state.spherical_secondary_color
        for first, color, asked in zip((0, 4), colors, turned, strict=True):
            if asked:  # as EXPAND_NORMAL reads them
                color[:, :3] = _turned(primitives, weights, first)
    distances = None
    if state.fog is not None:
        distances = weights.iterate_one(fixed(primitives.fog))
    coordinates = fixed(primitives.coordinates)
    rows = coordinates.reshape(len(coordinates), -1)

    def own(i):
        strq = weights.iterate(rows, 4 * i)
        if state.texture_units[i].spherical_coordinates:
            strq[:, :3] = spherical(weights.perspective.T, weights.corners(coordinates[:, i, :3]))
        return strq

    def change(i):
        return weights.changes_of(rows, 4 * i)

    def texel(i, unit, texture, tap=None):
        filters = unit.sampler.min_filter, unit.sampler.mag_filter
        where = place(
            texture.target,
            weights,
            rows,
            4 * i,
            nearest=filters != (TextureFilter.LINEAR, TextureFilter.LINEAR),
            changing=filters[0] is not filters[1]
            or max(unit.sampler.max_probes, unit.sampler.max_anisotropy) > 1,
        )
        if unit.spherical_coordinates:
            corners = weights.corners(coordinates[:, i, :3])
            where = replace(where, **turned_place(texture.target, weights, corners))
        reference = None
        if unit.sampler.compare_mode is not TextureCompareMode.NONE:
            reference = reference_of(weights.iterate(rows, 4 * i))
        return sample(texture, unit, where, reference, tap)

    given = state, textures, *colors, distances
    if state.texture_shader is not None:
        outcome = run_stages(state, textures, len(weights), own, texel, _sample_made, as_register, change)
        return shade_colors(*given, lambda i, unit, texture: outcome.registers[i]), outcome
    if state.evaluate_before_filtering:
        return _before_filtering(*given, texel), None
    return shade_colors(*given, texel), None


def _turned(primitives, weights, first):
    """Red, green and blue of unit vectors that turn steadily from vertex to vertex, float64 [k, 3]."""
    side = ((weights.front == 0) & primitives.two_side).astype(np.int64)
    corners = weights.corners(primitives.colors)[np.arange(len(side)), :, side]
    turned = spherical(weights.perspective.T, 2.0 * corners[:, :, first : first + 3] - 1.0)
    return (turned + 1.0) / 2.0


def _before_filtering(state, textures, primary, secondary, distances, texel):
    """Colours at each texel of unit 0's filter, filtered: docs/numbers.md, section 20."""
    along, fractions = units_along(state, textures), []

    def color(*tap):
        def one(i, unit, texture):
            if i not in along:
                return texel(i, unit, texture)
            found = texel(i, unit, texture, tap)
            if i == 0:
                fractions[:] = found[:, 4:].T
            return found[:, :4]

        return shade_colors(state, textures, primary, secondary, distances, one)

    planes = []
    for k in (0, 1):
        rows = []
        for j in (0, 1):
            first, second = color(k, j, 0), color(k, j, 1)
            rows.append(first + (second - first) * fractions[0][:, None])
        planes.append(rows[0] + (rows[1] - rows[0]) * fractions[1][:, None])
    return planes[0] + (planes[1] - planes[0]) * fractions[2][:, None]


def shade_colors(state, textures, primary, secondary, distances, texel):
    """``shade`` from iterated values: colours float64 [k, 4], fog coordinates [k] (None: no fog), and
    ``texel(number, unit, texture)``, an enabled texture unit's texel: with a texture shader, its register.
    """
    count = len(primary)
    fog = np.zeros((count, 4))
    fog[:, 3] = 1.0
    if state.fog is not None:
        fog[:, :3] = state.fog.color[:3]
        fog[:, 3] = fog_factor(state.fog, distances)
    program = state.register_combiners
    if program is None:
        program = environment_program(state, textures, IDEAL, has_color_sum(state))
    if program is None:
        return _without_combiners(state, primary, secondary, fog)
    registers = {
        Register.FOG: fog,
        Register.PRIMARY_COLOR: primary,
        Register.SECONDARY_COLOR: secondary,
        Register.SPARE1: np.zeros((count, 4)),
    }
    # A disabled unit's register is opaque black.  Source: docs/numbers.md, section 7.
    for i in range(4):
        unit = state.texture_units[i] if i < len(state.texture_units) else None
        if unit is None:
            registers[Register.TEXTURE0 + i] = constant_color((0.0, 0.0, 0.0, 1.0), count)
            continue
        found = texel(i, unit, textures.get(unit.texture))
        if state.texture_shader is None:
            found = as_register(found, unit)
        registers[Register.TEXTURE0 + i] = found
    registers[Register.SPARE0] = np.zeros((count, 4))
    registers[Register.SPARE0][:, 3] = registers[Register.TEXTURE0][:, 3]

    def look_up(lookup, registers):
        unit, rgb = state.texture_units[lookup.unit], registers[lookup.register][:, :3]
        level_0 = replace(unit.sampler, min_filter=unit.sampler.mag_filter)
        compared = unit.sampler.compare_mode is not TextureCompareMode.NONE
        made = sample(
            textures[unit.texture],
            replace(unit, sampler=level_0),
            made_place(textures[unit.texture], rgb),
            rgb[:, 2] if compared else None,
        )
        return as_register(made, unit)

    return combine(program, registers, look_up)


def _sample_made(i, unit, texture, str_, r, lifted, axes):
    """Unit i's texel at coordinates [k, 3] that its texture shader stage made; ``r``: what is compared;
    ``axes``: of what the lookup covers, float64 [2, k, 2], or None.
    """
    compares = unit.sampler.compare_mode is not TextureCompareMode.NONE
    where = made_place(texture, str_, lifted)
    if axes is not None:
        where = replace(where, dx=axes[0], dy=axes[1])
    return sample(texture, unit, where, r if compares else None)


def fog_factor(fog, coordinate):
    """f of section 3.10, float64, in [0, 1] by its definition; the machine has 256 steps of it."""
    if fog.mode is FogMode.EXP:
        factor = np.exp(-fog.density * coordinate)
    elif fog.mode is FogMode.EXP2:
        factor = np.exp(-((fog.density * coordinate) ** 2))
    elif fog.mode is FogMode.LINEAR:
        factor = (fog.end - coordinate) / (fog.end - fog.start)
    else:
        raise ValueError(f"The ideal machine has no fog mode {fog.mode.name}.")
    return np.clip(factor, 0.0, 1.0)


def _without_combiners(state, primary, secondary, fog):
    """Color sum (section 3.9) and fog (section 3.10): float64 [k, 4], clamped to [0, 1] at the end only."""
    rgb = primary[:, :3]
    if has_color_sum(state):
        rgb = rgb + secondary[:, :3]
    if state.fog is not None:
        rgb = fog[:, 3:] * rgb + (1.0 - fog[:, 3:]) * fog[:, :3]
    return np.clip(np.concatenate([rgb, primary[:, 3:]], axis=1), 0.0, 1.0)
