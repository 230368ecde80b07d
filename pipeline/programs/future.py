"""The future board's stages that a pass may use: sentences, or None (docs/numbers.md, section 20)."""

from dataclasses import replace

from fixedpipe.pipeline.enums import CombinerFunction, Register

_READABLE = frozenset(Register) - {
    Register.DISCARD,
    Register.E_TIMES_F,
    Register.SPARE0_PLUS_SECONDARY_COLOR,
}


def future_problem(state, profile):
    """A sentence that says why a machine cannot run a pass's stages of Kautz and Seidel, or None."""
    combiners = state.register_combiners
    for number, stage in enumerate(() if combiners is None else combiners.general):
        for portion in (stage.rgb, stage.alpha):
            if problem := _function_problem(number, portion, profile):
                return problem
        if stage.lookup is not None and (problem := _lookup_problem(number, stage.lookup, state, profile)):
            return problem
    if state.evaluate_before_filtering and (problem := _filtering_problem(state, profile)):
        return problem
    return None if profile.primitives.spherical_interpolation else _turning_problem(state, profile)


def _function_problem(number, portion, profile):
    function = portion.function
    if function not in profile.combiners.combiner_functions:
        return (
            f"{profile.name} has no {CombinerFunction(function).name} in general combiners; stage {number} "
            "uses it. Approximate it by more stages or a texture, or choose a profile that has it."
        )
    if function is not CombinerFunction.NONE and portion.mux_sum:
        return (
            f"general combiner {number} has the function {function.name} and a mux in the place of its sum; "
            "leave mux_sum False."
        )
    return None


def _lookup_problem(number, lookup, state, profile):
    if not profile.combiners.combiner_lookup:
        return (
            f"{profile.name} has no texture lookup after a general combiner; stage {number} has one. Draw a "
            "pass for each lookup, or choose a profile that has it."
        )
    units, i = state.texture_units, lookup.unit
    if not 0 <= i < len(units) or units[i] is None or units[i].texture is None:
        return f"the lookup after general combiner {number} reads texture unit {i}; enable that unit."
    if lookup.register not in _READABLE:
        return (
            f"the lookup after general combiner {number} reads {Register(lookup.register).name}; give a "
            "register that general combiners read."
        )
    return None


def _filtering_problem(state, profile):
    if not profile.textures.evaluate_before_filtering:
        return (
            f"{profile.name} evaluates combiners after its textures are filtered; leave "
            "evaluate_before_filtering False, or choose a profile that has it."
        )
    units = state.texture_units
    if not units or units[0] is None or units[0].texture is None:
        return "evaluate_before_filtering goes by texture unit 0, which is disabled; enable it."
    if state.texture_shader is not None:
        return (
            "evaluate_before_filtering goes by the texels that filters read, and texture shaders by their "
            "results; leave texture_shader None."
        )
    if any(u is not None and max(u.sampler.max_anisotropy, u.sampler.max_probes) > 1 for u in units):
        return (
            "evaluate_before_filtering knows filters of single footprints; give every sampler a "
            "max_anisotropy and max_probes of 1."
        )
    unequal = units[0].sampler.min_filter is not units[0].sampler.mag_filter
    if profile.arithmetic.exact and unequal:
        return (
            f"the {profile.name} evaluates before filtering with one filter alone; give unit 0 the same "
            "minification and magnification filter."
        )
    return None


def _turning_problem(state, profile):
    asked = [
        name for name in ("spherical_primary_color", "spherical_secondary_color") if getattr(state, name)
    ]
    asked += [
        f"texture unit {i}'s spherical_coordinates"
        for i, unit in enumerate(state.texture_units)
        if unit is not None and unit.spherical_coordinates
    ]
    if not asked:
        return None
    return (
        f"{profile.name} does not interpolate along arcs; this pass asks for {', '.join(asked)}. Use smaller "
        "triangles and a normalization cube map, or choose a profile that has it."
    )


def units_along(state, textures):
    """The units that are read before filtering.

    They are unit 0, and the units that differ from it in texture, environment and color table alone, with
    images of the same target and sizes.
    """
    units = state.texture_units
    first, image = units[0], textures[units[0].texture]
    shapes = [level.shape for level in image.levels]
    found = []
    for number, unit in enumerate(units):
        if unit is None or unit.texture is None:
            continue
        given = {name: getattr(first, name) for name in ("texture", "environment", "color_table")}
        texture = textures[unit.texture]
        same = texture.target == image.target and [level.shape for level in texture.levels] == shapes
        if same and replace(unit, **given) == first:
            found.append(number)
    return found
