"""Colours of fragments before the per-fragment operations: iteration, texels, combiners, color
sum and fog.
"""

from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numba import float64, types, void

from fixedpipe.pipeline.columns.texture_shader import StageRun
from fixedpipe.pipeline.enums import FogMode, Register, ShadeModel, TextureCompareMode, TextureFilter
from fixedpipe.pipeline.ideal.combine import combine, constant_color, plan_of
from fixedpipe.pipeline.ideal.coordinates import made_place, place, reference_of, spherical, turned_place
from fixedpipe.pipeline.ideal.sample import as_register, sample
from fixedpipe.pipeline.ideal.signs import signed_flags
from fixedpipe.pipeline.ideal.weights import fixed
from fixedpipe.pipeline.profiles import IDEAL
from fixedpipe.pipeline.programs.combiner_rules import has_color_sum
from fixedpipe.pipeline.programs.future import units_along
from fixedpipe.pipeline.programs.texture_environment import environment_program
from fixedpipe.pipeline.programs.texture_shader_rules import killing_units, reads_texture, shader_stages
from fixedpipe.pipeline.textures.images import with_signs
from fixedpipe.pipeline.textures.sampled import key_unit, sampled_texture
from fixedpipe.raster import codes as C
from fixedpipe.raster.columns import real_texture_shader
from fixedpipe.raster.kernel import kernel, separate_loop
from fixedpipe.raster.observer import unobserved

_COLORS = types.Array(float64, 2, "C", readonly=True)


@dataclass(frozen=True, eq=False)
class Outcome:
    """What a texture shader, or color keys that discard fragments, make of k fragments.

    registers  one for each texture unit, float64 [k, 4]
    alive      bool [k]: not discarded
    depth      float64 [k], in [0, 1]: the fragments' new depth; or None
    """

    registers: list[np.ndarray]
    alive: np.ndarray
    depth: np.ndarray | None


def shade(state, textures, primitives, plan, weights, observe=unobserved):
    """Shade fragments up to the per-fragment operations: their colours, float64 [k, 4] in [0, 1], and an
    Outcome.

    The Outcome is that of a texture shader, or of color keys that discard fragments; None: the state has
    neither.

    textures    name to Texture with ideal levels
    primitives  as the vertex stage makes them
    plan        from ``plan_for``
    weights     from ``weigh``
    observe     the observer
    """
    state = with_signs(state, textures)
    rows = fixed(primitives.colors).reshape(-1, 16)
    back = 8 if primitives.two_side else 0

    def color(first, turned):
        if state.polygon.shade_model is ShadeModel.FLAT:
            return weights.provoking(rows, first, back)
        color = weights.iterate(rows, first, back)
        if turned:  # in the encoding that EXPAND_NORMAL reads
            color[:, :3] = _turned(primitives, weights, first)
        return color

    colors = [color(0, state.spherical_primary_color), None]
    if _reads_secondary(state, plan):
        colors[1] = color(4, state.spherical_secondary_color)
    distances = None
    if state.fog is not None:
        distances = weights.iterate_one(fixed(primitives.fog))
    coordinates = fixed(primitives.coordinates)
    units = coordinates.reshape(len(coordinates), -1)

    def own(i):
        strq = weights.iterate(units, 4 * i)
        if state.texture_units[i].spherical_coordinates:
            strq[:, :3] = spherical(weights.perspective.T, weights.corners(coordinates[:, i, :3]))
        return strq

    def change(i):
        return weights.changes_of(units, 4 * i)

    def texel(i, unit, texture, tap=None):
        filters = unit.sampler.min_filter, unit.sampler.mag_filter
        where = place(
            texture.target,
            weights,
            units,
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
            reference = reference_of(weights.iterate(units, 4 * i))
        return sample(texture, unit, where, reference, tap)

    if observe is not unobserved:
        own_coordinates = {i: own(i) for i, unit in enumerate(state.texture_units) if unit is not None}
        observe("fragment", weights=weights.perspective, colors=colors, fog=distances, own=own_coordinates)
    given = state, textures, plan, *colors, distances
    alive = without_keys(state, textures, texel)
    if state.texture_shader is not None:
        outcome = _run_stages(state, textures, len(weights), own, texel, change)
        if alive is not None:
            outcome = replace(outcome, alive=outcome.alive & alive)
        return shade_colors(*given, lambda i, unit, texture: outcome.registers[i], observe), outcome
    outcome = None if alive is None else Outcome([], alive, None)
    if state.evaluate_before_filtering:
        return _before_filtering(*given, texel), outcome
    return shade_colors(*given, texel, observe), outcome


def without_keys(state, textures, texel):
    """Which fragments the color keys keep, bool [k]; None: there is no key. ``texel``: as for
    ``shade_colors``.
    """
    alive = None
    for i in killing_units(state):
        kept = texel(i, *key_unit(state.texture_units[i], textures))[:, 0] > 0.0
        alive = kept if alive is None else alive & kept
    return alive


def _turned(primitives, weights, first):
    """Red, green and blue of unit vectors that turn steadily from vertex to vertex, float64 [k, 3]."""
    side = ((weights.front == 0) & primitives.two_side).astype(np.int64)
    corners = weights.corners(primitives.colors)[np.arange(len(side)), :, side]
    turned = spherical(weights.perspective.T, 2.0 * corners[:, :, first : first + 3] - 1.0)
    return (turned + 1.0) / 2.0


def _before_filtering(state, textures, plan, primary, secondary, distances, texel):
    """Colours at each texel of unit 0's filter, then filtered (docs/numbers.md, section 20)."""
    along, fractions = units_along(state, textures), []

    def color(*tap):
        def one(i, unit, texture):
            if i not in along:
                return texel(i, unit, texture)
            found = texel(i, unit, texture, tap)
            if i == 0:
                fractions[:] = found[:, 4:].T
            return found[:, :4]

        return shade_colors(state, textures, plan, primary, secondary, distances, one)

    planes = []
    for k in (0, 1):
        rows = []
        for j in (0, 1):
            first, second = color(k, j, 0), color(k, j, 1)
            rows.append(first + (second - first) * fractions[0][:, None])
        planes.append(rows[0] + (rows[1] - rows[0]) * fractions[1][:, None])
    return planes[0] + (planes[1] - planes[0]) * fractions[2][:, None]


def plan_for(state, textures, plans):
    """The Plan of a state's combiner program, or of the program for its texture environments.

    None: the state has only color sum and fog. ``plans``: the Plans so far, by their programs' ids; a Plan
    keeps its program alive.
    """
    program = state.register_combiners
    if program is None:
        program = environment_program(state, textures, IDEAL, has_color_sum(state))
    if program is not None and id(program) not in plans:
        plans[id(program)] = plan_of(program)
    return None if program is None else plans[id(program)]


def _reads_secondary(state, plan):
    return has_color_sum(state) if plan is None else Register.SECONDARY_COLOR in plan.read


def shade_colors(state, textures, plan, primary, secondary, distances, texel, observe=unobserved):
    """``shade`` from iterated values: colours, float64 [k, 4].

    plan                from ``plan_for``
    primary, secondary  colours; ``secondary`` may be None if nothing reads it
    distances           fog coordinates [k]; None: no fog
    texel               ``texel(number, unit, texture)`` gives an enabled unit's texel, or its register with a
                        texture shader
    observe             the observer
    """
    factor = None if state.fog is None else fog_factor(state.fog, distances)
    if plan is None:
        return _without_combiners(state, primary, secondary, factor)
    registers = {Register.PRIMARY_COLOR: primary, Register.FOG: constant_color((0.0, 0.0, 0.0, 1.0))}
    if secondary is not None:
        registers[Register.SECONDARY_COLOR] = secondary
    if state.fog is not None and Register.FOG in plan.read:
        registers[Register.FOG] = np.empty((len(primary), 4))
        registers[Register.FOG][:] = *state.fog.color[:3], 0.0
        registers[Register.FOG][:, 3] = factor
    read = plan.read | {Register.TEXTURE0} if Register.SPARE0 in plan.read else plan.read
    for i in range(4):
        register = Register(Register.TEXTURE0 + i)
        unit = state.texture_units[i] if i < len(state.texture_units) else None
        if unit is None:
            # A disabled unit's register is opaque black. Source: docs/numbers.md, section 7.
            registers[register] = constant_color((0.0, 0.0, 0.0, 1.0))
        elif register in read or state.evaluate_before_filtering:
            found = texel(i, unit, None if unit.texture is None else sampled_texture(unit, textures))
            if state.texture_shader is None:
                found = as_register(found, unit, textures[unit.texture].internal_format)
            if state.ycbcr_conversion and reads_texture(state, i):
                found = np.concatenate([_rgb_of_ycbcr(found[:, :3]), found[:, 3:]], axis=1)
            registers[register] = found

    def look_up(lookup, rgb):
        unit = state.texture_units[lookup.unit]
        level_0 = replace(unit.sampler, min_filter=unit.sampler.mag_filter)
        compared = unit.sampler.compare_mode is not TextureCompareMode.NONE
        texture = sampled_texture(unit, textures)
        made = sample(
            texture,
            replace(unit, sampler=level_0),
            made_place(texture, rgb),
            rgb[:, 2] if compared else None,
        )
        return as_register(made, unit, textures[unit.texture].internal_format)

    observe("registers", registers=registers)
    return combine(plan, registers, look_up, observe)


def _rgb_of_ycbcr(ycbcr):
    """RGB, float64 [k, 3], from BT.601's Y, Cb and Cr in [0, 1]. Inferred: from the chip's coefficients
    (N7.3).
    """
    y, cb, cr = (np.maximum(ycbcr, 0.0) * 255.0 - (16.0, 128.0, 128.0)).T
    light = 1.164 * y
    rgb = light + 1.596 * cr, light - 0.392 * cb - 0.813 * cr, light + 2.017 * cb
    return np.clip(np.stack(rgb, axis=1) / 255.0, 0.0, 1.0)


class _Unit:
    """A texture unit at fragments, with the functions that StageRun calls.

    ``conventional``: the texel at the unit's own coordinates.
    """

    def __init__(self, unit, texture, internal_format, conventional):
        self.unit, self.sampler, self.texture = unit, unit.sampler, texture
        self.filtered, self.internal_format = conventional, internal_format
        self.bits, self.target = texture.bits, texture.target
        self.sizes, self.signed = (float(texture.width), float(texture.height)), signed_flags(unit.sampler)

    def register(self, texel, bits):
        """The unit's register from a texel."""
        return as_register(texel, self.unit, self.internal_format)

    def at_level_zero(self, str_, r, lifted, flat):
        """The texel at coordinates [k, 3] that a stage made. ``r``: the reference of a comparison."""
        return self._at(made_place(self.texture, str_, lifted), r)

    def at_footprints(self, str_, r, lifted, axes):
        """As ``at_level_zero``, with a footprint. ``axes``: the footprint's two axes, float64 [2, k, 2]."""
        return self._at(replace(made_place(self.texture, str_, lifted), dx=axes[0], dy=axes[1]), r)

    def _at(self, where, r):
        compares = self.sampler.compare_mode is not TextureCompareMode.NONE
        return sample(self.texture, self.unit, where, r if compares else None)


def _run_stages(state, textures, count, own, conventional, change):
    """The Outcome of a pass's texture shader for ``count`` fragments.

    own(i)                          unit i's coordinates (s, t, r, q), float64 [k, 4]
    conventional(i, unit, texture)  the unit's texel at them
    change(i)                       their change to the right and upwards, float64 [2, k, 4]
    """
    stages, units = shader_stages(state), []
    for i, unit in enumerate(state.texture_units):
        if unit is None or unit.texture is None:
            units.append(None)
            continue
        texture = sampled_texture(unit, textures)
        units.append(_Unit(unit, texture, texture.internal_format, partial(conventional, i, unit, texture)))

    def sides(i):
        """By how many texels a lookup of unit i moves from a pixel to the right (s, t) and upwards."""
        steps = change(i)[:, :, :2]
        if stages[i].operation in C.OPERATIONS_OF_TWO_DOT_PRODUCTS:
            steps = np.stack([change(k)[:, :, 2] for k in (i - 1, i)], axis=-1)
        return np.concatenate(steps * np.array(units[i].sizes), axis=1)

    run = StageRun(
        stages, count, own, sides, units, IDEAL, IDEAL.arithmetic.texture_bits, (1.0, 1.0),
        arithmetic=real_texture_shader,
    )  # fmt: skip
    run.all_stages()
    return Outcome(run.registers, run.alive, run.depth)


def fog_factor(fog, coordinate):
    """f of section 3.10, float64; its definition clamps it to [0, 1]. The machine has 256 steps of it."""
    if fog.mode is FogMode.EXP:
        factor = np.exp(-fog.density * coordinate)
    elif fog.mode is FogMode.EXP2:
        factor = np.exp(-((fog.density * coordinate) ** 2))
    elif fog.mode is FogMode.LINEAR and fog.start == fog.end:
        factor = coordinate <= fog.end  # a step. Source: docs/numbers.md, section 9
    elif fog.mode is FogMode.LINEAR:
        factor = (fog.end - coordinate) / (fog.end - fog.start)
    else:
        raise ValueError(f"The ideal machine has no fog mode {fog.mode.name}.")
    return np.clip(factor, 0.0, 1.0)


@kernel(void(_COLORS, _COLORS, float64[::1], types.UniTuple(float64, 3), float64[:, ::1]))
def _sum_and_fog(primary, secondary, factor, fog, out):
    """Color sum if there are secondary colours, fog if there are factors, then the clamp."""
    separate_loop()
    sums, fogs = len(secondary) > 0, len(factor) > 0
    for i in range(len(out)):
        for c in range(4):
            value = primary[i, c]
            if c < 3:
                if sums:
                    value += secondary[i, c]
                if fogs:
                    value = factor[i] * value + (1.0 - factor[i]) * fog[c]
            out[i, c] = 0.0 if value < 0.0 else (1.0 if value > 1.0 else value)


def _without_combiners(state, primary, secondary, factor):
    """Color sum (section 3.9) and fog (section 3.10): float64 [k, 4], clamped to [0, 1] at the end only."""
    out, color = np.empty((len(primary), 4)), (0.0, 0.0, 0.0)
    if factor is None:
        factor = np.empty(0)
    else:
        color = tuple(map(float, state.fog.color[:3]))
    if not has_color_sum(state):
        secondary = np.empty((0, 4))
    _sum_and_fog(fixed(primary), fixed(secondary), factor, color, out)
    return out
