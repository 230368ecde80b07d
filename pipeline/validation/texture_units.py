"""Validation of texture units: textures, texture shader stages, coordinates and environments."""

from fixedpipe.pipeline.enums import (
    BaseFormat,
    TexGenMode,
    TextureFilter,
    TextureShaderOperation,
    TextureTarget,
)
from fixedpipe.pipeline.messages import count, listed
from fixedpipe.pipeline.programs.combiner_rules import textures_read
from fixedpipe.pipeline.programs.texture_environment import (
    disabled_textures_are_ones,
    environment_problem,
    texture_format,
    textures_named,
)
from fixedpipe.pipeline.programs.texture_shader_rules import (
    DEPENDENT,
    SCALING,
    TARGETS_READ,
    WITHOUT_TEXTURE,
    roughness_problem,
    shader_stages,
    stage_problem,
    stage_width_problem,
)
from fixedpipe.pipeline.state import SignedComponents
from fixedpipe.pipeline.textures.images import (
    COLORLESS_FORMATS,
    COMPONENT_BITS,
    SIGNED_FORMATS,
    stored_widths,
)
from fixedpipe.pipeline.validation.sampling import sampler
from fixedpipe.pipeline.validation.textures import known_texture
from fixedpipe.pipeline.validation.transfer import color_table_problem

_NEAREST = frozenset({TextureFilter.NEAREST, TextureFilter.NEAREST_MIPMAP_NEAREST})

# Source: OpenGL 1.2.1 section 2.10.4 (SPHERE_MAP for s and t); NV_texgen_reflection (the other two, not q).
_GENERATED_BY = {
    TexGenMode.SPHERE_MAP: "st",
    TexGenMode.NORMAL_MAP: "str",
    TexGenMode.REFLECTION_MAP: "str",
}


def texture_units(walk, state):
    """Refuse texture units, and stages, that the machine lacks or that do not fit their textures."""
    units, allowed = state.texture_units, walk.profile.textures.max_texture_units
    if len(units) > allowed:
        walk.refuse(
            f"{walk.profile.name} has {count(allowed, 'texture unit')}; this pass has {len(units)}. "
            "Split the pass or choose a profile with more."
        )
    stages = texture_shader(walk, state)
    enabled = [(i, unit) for i, unit in enumerate(units) if unit is not None]
    if not enabled:
        return
    if stages is not None:
        _stage_widths(walk, units, stages)
    for i, unit in enabled:
        operation = None if stages is None else stages[i].operation
        if operation in WITHOUT_TEXTURE or operation is TextureShaderOperation.NONE:
            if unit.texture is not None:
                known_texture(walk, unit.texture)
            if state.register_combiners is None:
                rgba = operation is TextureShaderOperation.PASS_THROUGH
                walk.once(_environment, unit, i, BaseFormat.RGBA if rgba else None)
            _unit_coordinates(walk, i, unit)
            continue
        if unit.texture is None:
            walk.refuse(f"texture unit {i} names no texture to sample; give one, or disable the unit.")
        known = known_texture(walk, unit.texture)
        foreign = (
            operation is TextureShaderOperation.TEXTURE_CUBE_MAP
            and known.target is not TextureTarget.TEXTURE_CUBE_MAP
        )
        if operation in DEPENDENT or foreign:
            rough = stages[i].roughness is not None
            _dependent_access(walk, i, unit, known, operation, rough)
        elif operation in TARGETS_READ and known.target not in _accessible(walk, operation):
            walk.refuse(
                f"texture shader stage {i} is {operation.name}, but {unit.texture!r} is a "
                f"{known.target.name}, which {walk.profile.name} does not read so; give the operation of "
                "its target."
            )
        _unit_coordinates(walk, i, unit)
        walk.once(sampler, unit, known, i)
        _color_table(walk, i, unit.color_table)
        walk.once(_color_key, unit, known, i, operation in DEPENDENT or foreign)
        if state.register_combiners is None:
            base = texture_format(unit, known.internal_format, walk.profile)
            walk.once(_environment, unit, i, base)


def _color_table(walk, number, table):
    if table is not None and not walk.profile.textures.texture_color_table:
        walk.refuse(
            f"texture unit {number} has a color_table; {walk.profile.name} has none after its filters. "
            "Use the table's colours in the texture, or choose a profile that has it."
        )
    if problem := color_table_problem(f"the color table of texture unit {number}", table, walk.profile):
        walk.refuse(problem)


def _color_key(walk, unit, known, number, made):
    """Refuse a color key that the machine lacks, or whose effect no source gives.

    ``made`` says that the unit's texture shader stage computes the coordinates.
    """
    if (key := unit.color_key) is None:
        return
    place, sampler = f"texture unit {number}", unit.sampler
    operations = walk.profile.textures.color_key_operations
    if key.operation not in operations:
        has = listed(operations) if operations else "no color keys"
        walk.refuse(
            f"{place} has a color key that does {key.operation.name}; {walk.profile.name} has {has}. Give "
            "the texels an alpha of 0, and an alpha test."
        )
    if len(key.color) != 4 or not all(0.0 <= component <= 1.0 for component in key.color):
        walk.refuse(f"the color key of {place} is {key.color}; give four components from 0 to 1.")
    if known.internal_format not in COMPONENT_BITS:
        walk.refuse(
            f"{place} has a color key beside a texture of {known.internal_format.name}; what equals a key is "
            "known of texels of up to 8 bits a component. Leave color_key None."
        )
    nearest = sampler.min_filter in _NEAREST and sampler.mag_filter in _NEAREST
    if not nearest or max(sampler.max_anisotropy, sampler.max_probes) > 1:
        walk.refuse(
            f"{place} has a color key and filters several texels; what a key does is known of the nearest "
            "texel alone. Give NEAREST, or NEAREST_MIPMAP_NEAREST, without anisotropy and probes."
        )
    if sampler.signed_components != SignedComponents() or unit.color_table is not None:
        walk.refuse(
            f"{place} has a color key beside signed components or a color table; what equals a key is known "
            "of unsigned texels as they are stored. Leave color_key None."
        )
    if made:
        walk.refuse(
            f"{place} has a color key, and its texture shader stage makes its coordinates; what a key does "
            "is known of a unit's own. Leave color_key None."
        )


def _environment(walk, unit, number, base):
    if problem := environment_problem(number, unit.environment, base, walk.profile):
        walk.refuse(problem)


def texture_shader(walk, state):
    """The stages of every unit, or None; refuse stages that the machine lacks."""
    if state.texture_shader is None:
        return None
    profile, units = walk.profile, len(state.texture_units)
    if not profile.texture_shaders.texture_shader_operations:
        walk.refuse(f"{profile.name} has no texture shaders; leave texture_shader None.")
    if len(state.texture_shader) > units:
        walk.refuse(
            f"there are {len(state.texture_shader)} texture shader stages, but "
            f"{count(units, 'texture unit')}; give each stage a unit."
        )
    stages = shader_stages(state)
    for i, stage in enumerate(stages):
        if stage.operation is TextureShaderOperation.NONE:
            continue
        if stage.operation not in profile.texture_shaders.texture_shader_operations:
            walk.refuse(
                f"{profile.name} has no {stage.operation.name} (texture shader stage {i}); it has "
                f"{listed(profile.texture_shaders.texture_shader_operations)}."
            )
        dotted = stage.operation.name.startswith("DOT_PRODUCT")
        if dotted and stage.dot_product_mapping not in profile.texture_shaders.dot_product_mappings:
            walk.refuse(
                f"{profile.name} has no dot product mapping {stage.dot_product_mapping.name} (texture "
                f"shader stage {i}); it has {listed(profile.texture_shaders.dot_product_mappings)}."
            )
        if state.texture_units[i] is None:
            walk.refuse(
                f"texture shader stage {i} is {stage.operation.name}, but texture unit {i} is disabled; "
                "enable it (with no texture where the operation reads none)."
            )
        if stage.roughness is not None and not profile.texture_shaders.roughness_lookups:
            walk.refuse(
                f"{profile.name} filters no lookup by roughness (texture shader stage {i}); leave roughness "
                "None."
            )
        if problem := stage_problem(i, stages) or roughness_problem(i, stages):
            walk.refuse(problem)
    return stages


def _stage_widths(walk, units, stages):
    """Refuse stages that read 16-bit words from units whose components have other widths."""
    widths = []
    for unit, stage in zip(units, stages, strict=True):
        known = None if unit is None or unit.texture is None else known_texture(walk, unit.texture)
        if known is None or stage.operation in WITHOUT_TEXTURE:
            widths.append(walk.profile.arithmetic.texture_bits)
        else:
            widths.append((stored_widths(known.internal_format, walk.profile) or (8,))[0])
    if problem := stage_width_problem(stages, widths, walk.profile):
        walk.refuse(problem)


def _accessible(walk, operation):
    """The texture targets that an operation reads on this machine."""
    targets = TARGETS_READ[operation]
    return targets if walk.profile.texture_shaders.foreign_texture_targets else targets[:1]


def _dependent_access(walk, number, unit, known, operation, rough):
    """Refuse samplers and textures that a stage with computed coordinates cannot use.

    ``rough`` says that roughness filters the lookup.
    """
    filters = unit.sampler.min_filter, unit.sampler.mag_filter
    if filters[0] is not filters[1] and not rough:
        walk.refuse(
            f"texture unit {number} minifies with {filters[0].name}, magnifies with {filters[1].name}; "
            f"{operation.name} makes coordinates that have no level of detail here; set both to "
            "NEAREST or both to LINEAR."
        )
    if unit.sampler.max_anisotropy > 1 or (unit.sampler.max_probes > 1 and not rough):
        filters, limit = "filters anisotropically", "max_anisotropy"
        if unit.sampler.max_anisotropy <= 1:
            filters, limit = "assembles footprints", "max_probes"
        walk.refuse(
            f"texture unit {number} {filters}, which {walk.profile.name} does along its own "
            f"coordinates, not along those that {operation.name} makes; set {limit} to 1."
        )
    if operation in SCALING:
        if unit.sampler.signed_components != SignedComponents():
            walk.refuse(
                f"texture shader stage {number} is {operation.name}, which scales unsigned components alone; "
                "leave signed_components unset."
            )
        colorless = known.internal_format in COLORLESS_FORMATS and not walk.profile.textures.hilo_as_color
        if colorless or known.internal_format in SIGNED_FORMATS:
            walk.refuse(
                f"texture shader stage {number} is {operation.name}, which scales unsigned colours alone; "
                f"{unit.texture!r} is of {known.internal_format.name}: give it a texture of colours."
            )
    targets = _accessible(walk, operation)
    if known.target not in targets:
        walk.refuse(
            f"texture shader stage {number} is {operation.name}, but {unit.texture!r} is a "
            f"{known.target.name}, which {walk.profile.name} does not read so; give it a "
            f"{' or '.join(t.name for t in targets)}."
        )


def _unit_coordinates(walk, number, unit):
    _generation(walk, number, unit)
    if unit.coordinates < 0:
        walk.refuse(f"texture unit {number} takes coordinate set {unit.coordinates}; sets count from 0.")


def _generation(walk, number, unit):
    profile, place = walk.profile, f"texture unit {number}"
    if any(unit.cylinder_wrap) and not profile.textures.cylinder_wrap:
        walk.refuse(
            f"{profile.name} does not wrap texture coordinates; give the triangles that cross the seam "
            "vertices of their own."
        )
    for coordinate, gen in zip("strq", unit.gen, strict=True):
        if gen.mode is TexGenMode.NONE:
            continue
        if gen.mode not in profile.vertices.texgen_modes:
            walk.refuse(
                f"{profile.name} cannot generate {coordinate} by {gen.mode.name}; it has "
                f"{listed(profile.vertices.texgen_modes)}."
            )
        if coordinate not in _GENERATED_BY.get(gen.mode, "strq"):
            walk.refuse(
                f"{place} generates {coordinate} by {gen.mode.name}, which makes "
                f"{', '.join(_GENERATED_BY[gen.mode])} only; use OBJECT_LINEAR or EYE_LINEAR for it, or "
                "NONE."
            )


def disabled_textures(walk, state):
    """Warn of disabled texture units that combiners or environments read."""
    stages = shader_stages(state)
    enabled = tuple(
        unit is not None and (stages is None or stages[i].operation is not TextureShaderOperation.NONE)
        for i, unit in enumerate(state.texture_units)
    )
    if state.register_combiners is not None:
        walk.once(_textures_of_combiners, state.register_combiners, enabled)
        return
    for i, unit in enumerate(state.texture_units):
        if enabled[i]:
            walk.once(_textures_of_environment, unit, i, enabled)


def _is_disabled(number, enabled):
    return number >= len(enabled) or not enabled[number]


def _textures_of_combiners(walk, combiners, enabled):
    for place, number in textures_read(combiners):
        if _is_disabled(number, enabled):
            walk.warn(
                f"{place} reads TEXTURE{number}, and texture unit {number} is disabled, so it reads "
                "opaque black, (0, 0, 0, 1). Enable the unit, or read another register."
            )


def _textures_of_environment(walk, unit, i, enabled):
    gets = "reads ones" if disabled_textures_are_ones(walk.profile) else "is disabled itself"
    for number in sorted(textures_named(unit.environment)):
        if _is_disabled(number, enabled):
            walk.warn(
                f"the environment of texture unit {i} reads TEXTURE{number}, and texture unit {number} is "
                f"disabled, so it {gets}. Enable the unit, or name another source."
            )
