"""The calls for texture objects and units: binding, parameters, environments, coordinate generation.

Source: OpenGL 1.2.1 sections 2.10.4, 3.8.3 to 3.8.10; EXT_texture_object; ARB_multitexture;
ARB_texture_env_combine; NV_texture_env_combine4; EXT_texture_lod_bias; NV_point_sprite; NV_texture_shader;
ARB_shadow; SGIX_shadow.

A value that the machine's driver did not accept (a wrap mode, an environment) is an error in OpenGL, and does
not change the state. A draw that reads more units than the machine has is refused.
"""

import math
from functools import lru_cache
from typing import Any, NamedTuple

from fixedpipe.pipeline.enums import (
    BaseFormat,
    ComparisonFunction,
    TexGenMode,
    TextureCompareMode,
    TextureEnvironmentMode,
    TextureFilter,
    TextureShaderOperation,
    TextureTarget,
    WrapMode,
)
from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.capabilities import unit_capability
from fixedpipe.pipeline.opengl.current import COORDINATE_SETS, texture_unit_number
from fixedpipe.pipeline.opengl.entry_points import entry, register
from fixedpipe.pipeline.opengl.environments import (
    Environment,
    Half,
    environment_of,
    lod_bias,
    unknown_value,
    with_member,
)
from fixedpipe.pipeline.opengl.fragments import COMPARISONS, clamped, member, words
from fixedpipe.pipeline.opengl.matrices import times_inverse_modelview
from fixedpipe.pipeline.opengl.outcomes import GLError, Refused
from fixedpipe.pipeline.opengl.parameters import Parameter, numbers_of, register_parameters
from fixedpipe.pipeline.opengl.pixel_transfers import TEXTURE_TABLE
from fixedpipe.pipeline.opengl.texture_objects import (
    TARGETS,
    Parameters,
    TextureObject,
    Usable,
    texture_name,
)
from fixedpipe.pipeline.opengl.values import declare, section
from fixedpipe.pipeline.state import (
    PassState,
    Sampler,
    TexGen,
    TextureUnit,
)
from fixedpipe.pipeline.textures.images import BASE_FORMAT, DEPTH_TEXELS, FORMATS_OF_WORDS

_TEXTURE = tokens.TEXTURE_BIT
_UNITS = range(COORDINATE_SETS)
for _target in TARGETS:
    unit_capability(_target)
    for _unit in _UNITS:
        declare(("bound", _target, _unit), 0, _TEXTURE)
_DEFAULTS = {texture_name((0, target)): (0, target) for target in TARGETS}
# The most names that GenTextures returns at once. Assumed: no program requests more.
_MOST_NAMES = 1 << 20


@entry("ActiveTexture")
def active_texture(gl, texture):
    """Choose the unit that calls for textures and their matrices change (ARB_multitexture)."""
    gl.values.set("active_texture", texture_unit_number(texture))


# ---------------------------------------------------------------------------------------------------- objects


def target_of(target: int) -> int:
    """The target of a call that binds a texture or changes its parameters. Raises GLError."""
    if target not in TARGETS:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(target)} is no target of textures here")
    return target


def bound_object(gl: Any, target: int, unit: int | None = None) -> TextureObject:
    """The object bound to a target of ``unit``; None: of the active unit.

    Contexts that share objects also share the default objects. Source: Mesa, which has them in its shared
    state.
    """
    number = gl.values["bound", target, gl.values["active_texture"] if unit is None else unit]
    key = number or (0, target)
    found = gl.shared.textures.get(key)
    if found is None:
        found = gl.shared.textures[key] = TextureObject(key, target)
    return found


def mark(gl: Any, texture: TextureObject) -> None:
    """Note that an object has changed: in every context the units that read it are made again."""
    number = texture.key if isinstance(texture.key, int) else 0
    texture.readers.add(gl.values)
    for values in tuple(texture.readers):
        units = [unit for unit in _UNITS if values["bound", texture.target, unit] == number]
        values.mark(*[f"texture unit {unit}" for unit in units])


@entry("GenTextures", compiled=False)
def gen_textures(gl, number, names=None):
    """Return unused names, or use the names of the recorded program."""
    if number < 0:
        raise GLError(tokens.INVALID_VALUE)
    if number > _MOST_NAMES:
        raise GLError(tokens.OUT_OF_MEMORY)
    textures = gl.shared.textures
    if names is None:
        first = max([key for key in textures if isinstance(key, int)], default=0) + 1
        names = list(range(first, first + number))
    for name in numbers_of(names)[:number]:
        textures.setdefault(int(name), None)
    return names


@entry("BindTexture")
def bind_texture(gl, target, name):
    """Bind an object. The first call with its name creates it (section 3.8.8)."""
    target_of(target)
    if name:
        found = gl.shared.textures.get(name)
        if found is None:
            gl.shared.textures[name] = TextureObject(name, target)
        elif found.target != target:
            raise GLError(
                tokens.INVALID_OPERATION, f"texture {name} was bound to {tokens.name_of(found.target)} first"
            )
    gl.values.set(("bound", target, gl.values["active_texture"]), int(name))


@entry("DeleteTextures", compiled=False)
def delete_textures(gl, number, names):
    """Delete objects. If this context has one of them bound, the default object is bound instead."""
    if number < 0:
        raise GLError(tokens.INVALID_VALUE)
    for name in numbers_of(names)[:number]:
        if not name:
            continue
        found = gl.shared.textures.pop(int(name), None)
        if found is not None:
            mark(gl, found)
            for unit in _UNITS:
                if gl.values["bound", found.target, unit] == name:
                    gl.values.set(("bound", found.target, unit), 0)


@entry("IsTexture", compiled=False)
def is_texture(gl, name):
    """Whether a name belongs to an object that was bound at least once."""
    return bool(name) and gl.shared.textures.get(name) is not None


@entry("AreTexturesResident", compiled=False)
def are_textures_resident(gl, number, names, residences=None):
    """True: every texture is resident, because a machine here has room for all."""
    if number < 0 or not all(is_texture(gl, int(name)) for name in numbers_of(names)[:number]):
        raise GLError(tokens.INVALID_VALUE)
    return True


@entry("PrioritizeTextures")
def prioritize_textures(gl, number, names, priorities):
    """Set priorities of objects. They have no effect on pictures."""
    if number < 0:
        raise GLError(tokens.INVALID_VALUE)
    pairs = zip(numbers_of(names)[:number], numbers_of(priorities)[:number], strict=False)
    for name, priority in pairs:
        found = gl.shared.textures.get(int(name)) if name else None
        if found is not None:
            changed = found.parameters._replace(priority=clamped(priority)[0])
            found.set_parameters(changed, gl.called)
            mark(gl, found)


# ------------------------------------------------------------------------------------------------- parameters

_MIN_FILTERS = words(TextureFilter)
_MAG_FILTERS = {tokens.NEAREST, tokens.LINEAR}
_WRAPS = words(WrapMode)
_COMPARE_MODES = {
    tokens.NONE: TextureCompareMode.NONE,
    0x884E: TextureCompareMode.COMPARE_R_TO_TEXTURE,  # COMPARE_R_TO_TEXTURE_ARB
}
_DEPTH_MODES = {
    tokens.LUMINANCE: BaseFormat.LUMINANCE,
    tokens.INTENSITY: BaseFormat.INTENSITY,
    tokens.ALPHA: BaseFormat.ALPHA,
}
_COMPARE_R = 0x884E
_SGIX_OPERATORS = {tokens.TEXTURE_LEQUAL_R_SGIX: tokens.LEQUAL, tokens.TEXTURE_GEQUAL_R_SGIX: tokens.GEQUAL}
# Parameters of one number that only need a conversion: (field, conversion).
_PLAIN = {
    tokens.TEXTURE_MIN_LOD: ("min_lod", lambda given: given.number()),
    tokens.TEXTURE_MAX_LOD: ("max_lod", lambda given: given.number()),
    tokens.TEXTURE_PRIORITY: ("priority", lambda given: clamped(given.number())[0]),
    tokens.GENERATE_MIPMAP: ("generate_mipmap", lambda given: given.number() != 0),
}
_LEVELS = {tokens.TEXTURE_BASE_LEVEL: "base_level", tokens.TEXTURE_MAX_LEVEL: "max_level"}
_WRAP_FIELDS = {
    tokens.TEXTURE_WRAP_S: "wrap_s",
    tokens.TEXTURE_WRAP_T: "wrap_t",
    tokens.TEXTURE_WRAP_R: "wrap_r",
}


def _tex_parameter(gl, target, name, given):
    texture = bound_object(gl, target_of(target))
    changes = _parameter_changes(gl, target, name, given, texture.parameters)
    texture.set_parameters(texture.parameters._replace(**changes), f"{gl.called} (call {gl.tally.call})")
    mark(gl, texture)


register_parameters("TexParameter", _tex_parameter)


def _parameter_changes(gl, target, name, given: Parameter, held: Parameters) -> dict[str, Any]:
    """The fields that TexParameter changes. Raises GLError."""
    rectangle = target == tokens.TEXTURE_RECTANGLE_NV
    if name in _PLAIN:
        field, conversion = _PLAIN[name]
        return {field: conversion(given)}
    if name in _WRAP_FIELDS:
        mode = member(_WRAPS, given.token())
        periodic = mode in (WrapMode.REPEAT, WrapMode.MIRRORED_REPEAT)
        if mode not in gl.profile.textures.wrap_modes or (rectangle and periodic):
            unknown_value(gl, f"{mode.name} for {tokens.name_of(target)}")
        return {_WRAP_FIELDS[name]: given.token()}
    if name == tokens.TEXTURE_MIN_FILTER:
        filtered = member(_MIN_FILTERS, given.token())
        if rectangle and filtered.mipmap:
            raise GLError(tokens.INVALID_ENUM, "rectangles have no mipmaps")
        return {"min_filter": given.token()}
    if name == tokens.TEXTURE_MAG_FILTER:
        if given.token() not in _MAG_FILTERS:
            raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(given.token())} magnifies nothing")
        return {"mag_filter": given.token()}
    if name == tokens.TEXTURE_BORDER_COLOR:
        return {"border_color": clamped(*given.color())}
    if name in _LEVELS:
        level = math.floor(given.number() + 0.5)
        if level < 0 or (rectangle and level):
            raise GLError(tokens.INVALID_VALUE)
        return {_LEVELS[name]: level}
    if name == tokens.TEXTURE_MAX_ANISOTROPY_EXT:
        if gl.profile.textures.max_anisotropy <= 1:
            unknown_value(gl, "anisotropic filter")
        if not given.number() >= 1:
            raise GLError(tokens.INVALID_VALUE)
        return {"max_anisotropy": min(given.number(), gl.profile.textures.max_anisotropy)}
    if name == tokens.TEXTURE_LOD_BIAS:
        return {"lod_bias": lod_bias(gl, given)}
    return _comparison_changes(gl, name, given, held)


def _comparison_changes(gl, name, given, held):
    """The fields that parameters of depth textures change. Raises GLError.

    Source: ARB_shadow, ARB_depth_texture, SGIX_shadow, SGIX_shadow_ambient.
    """
    textures, token = gl.profile.textures, int(given.number())
    comparing = TextureCompareMode.COMPARE_R_TO_TEXTURE in textures.texture_compare_modes
    if name == tokens.DEPTH_TEXTURE_MODE:
        if member(_DEPTH_MODES, token) not in textures.depth_texture_modes:
            unknown_value(gl, f"depth textures as {tokens.name_of(token)}")
        return {"depth_mode": token}
    if name not in (
        tokens.TEXTURE_COMPARE_MODE,
        tokens.TEXTURE_COMPARE_FUNC,
        tokens.TEXTURE_COMPARE_FAIL_VALUE_ARB,
        tokens.TEXTURE_COMPARE_SGIX,
        tokens.TEXTURE_COMPARE_OPERATOR_SGIX,
    ):
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(name)} is no parameter of textures here")
    if not comparing:
        unknown_value(gl, "comparison of textures")
    if name == tokens.TEXTURE_COMPARE_MODE:
        member(_COMPARE_MODES, token)
        return {"compare_mode": token}
    if name == tokens.TEXTURE_COMPARE_SGIX:
        return {"compare_mode": _COMPARE_R if given.number() else tokens.NONE}
    if name == tokens.TEXTURE_COMPARE_FAIL_VALUE_ARB:
        if not textures.shadow_ambient:
            unknown_value(gl, "shadow ambient")
        return {"compare_fail_value": clamped(given.number())[0]}
    function = member(_SGIX_OPERATORS, token) if name == tokens.TEXTURE_COMPARE_OPERATOR_SGIX else token
    if member(COMPARISONS, function) not in textures.shadow_functions:
        unknown_value(gl, f"comparison of textures by {tokens.name_of(function)}")
    return {"compare_function": function}


def bound_parameters(gl: Any) -> tuple[tuple[Any, Parameters], ...]:
    """(key, Parameters) of every bound object, as PushAttrib(TEXTURE_BIT) saves them."""
    objects = {bound_object(gl, target, unit).key: None for target in TARGETS for unit in _UNITS}
    return tuple([(key, gl.shared.textures[key].parameters) for key in objects])


def restore_parameters(gl: Any, saved: tuple[tuple[Any, Parameters], ...]) -> None:
    """Set the parameters that ``bound_parameters`` returned. Deleted objects are skipped."""
    for key, parameters in saved:
        found = gl.shared.textures.get(key)
        if found is not None and found.parameters != parameters:
            found.set_parameters(parameters, f"{gl.called} (call {gl.tally.call})")
            mark(gl, found)


# ------------------------------------------------------------------------------------------------- generation

_MODES = {token: mode for token, mode in words(TexGenMode).items() if mode is not TexGenMode.NONE}
COORDINATES = (tokens.S, tokens.T, tokens.R, tokens.Q)
GENERATIONS = (tokens.TEXTURE_GEN_S, tokens.TEXTURE_GEN_T, tokens.TEXTURE_GEN_R, tokens.TEXTURE_GEN_Q)
# How many coordinates each mode makes. Source: section 2.10.4; NV_texgen_reflection.
_MADE = {TexGenMode.SPHERE_MAP: 2, TexGenMode.NORMAL_MAP: 3, TexGenMode.REFLECTION_MAP: 3}


class Generation(NamedTuple):
    """How one coordinate is generated: mode, object plane, eye plane in eye coordinates."""

    mode: int
    object_plane: tuple[float, float, float, float]
    eye_plane: tuple[float, float, float, float]


_PLANES = ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0,) * 4, (0.0,) * 4)
for _token in GENERATIONS:
    unit_capability(_token)
for _unit in _UNITS:
    _initial = tuple([Generation(tokens.EYE_LINEAR, plane, plane) for plane in _PLANES])
    declare(("texture generation", _unit), _initial, _TEXTURE)


def _tex_gen(gl, coordinate, name, given):
    if coordinate not in COORDINATES:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(coordinate)} is no texture coordinate")
    place, key = COORDINATES.index(coordinate), ("texture generation", gl.values["active_texture"])
    if name == tokens.TEXTURE_GEN_MODE:
        mode = member(_MODES, given.token())
        if mode not in gl.profile.vertices.texgen_modes or place >= _MADE.get(mode, 4):
            unknown_value(gl, f"generation of {'strq'[place]} by {mode.name}")
        change = {"mode": given.token()}
    elif name == tokens.OBJECT_PLANE:
        change = {"object_plane": given.vector_of(4)}
    elif name == tokens.EYE_PLANE:
        change = {"eye_plane": times_inverse_modelview(gl, given.vector_of(4))}
    else:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(name)} is no parameter of generation")
    held = gl.values[key]
    gl.values.set(key, with_member(held, place, held[place]._replace(**change)))


register_parameters("TexGen", _tex_gen)
for _kind in ("d", "dv"):

    def _read(gl, coordinate, name, given, vector=_kind == "dv"):
        return coordinate, name, Parameter(numbers_of(given), False, vector)

    register("TexGen" + _kind, _tex_gen, capture=_read)


@lru_cache(maxsize=4096)
def generation(held: Generation, enabled: bool) -> TexGen:
    """The TexGen of one coordinate."""
    if not enabled:
        return TexGen()
    mode = _MODES[held.mode]
    planes = {TexGenMode.OBJECT_LINEAR: held.object_plane, TexGenMode.EYE_LINEAR: held.eye_plane}
    return TexGen(mode, planes[mode]) if mode in planes else TexGen(mode)


# ------------------------------------------------------------------------------------------------------ units

_SHADER_TARGETS = {
    TextureShaderOperation.TEXTURE_1D: tokens.TEXTURE_1D,
    TextureShaderOperation.TEXTURE_2D: tokens.TEXTURE_2D,
    TextureShaderOperation.TEXTURE_RECTANGLE: tokens.TEXTURE_RECTANGLE_NV,
    TextureShaderOperation.TEXTURE_CUBE_MAP: tokens.TEXTURE_CUBE_MAP,
    TextureShaderOperation.TEXTURE_3D: tokens.TEXTURE_3D,
    TextureShaderOperation.OFFSET_TEXTURE_2D: tokens.TEXTURE_2D,
    TextureShaderOperation.OFFSET_TEXTURE_2D_SCALE: tokens.TEXTURE_2D,
    TextureShaderOperation.OFFSET_TEXTURE_RECTANGLE: tokens.TEXTURE_RECTANGLE_NV,
    TextureShaderOperation.OFFSET_TEXTURE_RECTANGLE_SCALE: tokens.TEXTURE_RECTANGLE_NV,
    TextureShaderOperation.DEPENDENT_AR_TEXTURE_2D: tokens.TEXTURE_2D,
    TextureShaderOperation.DEPENDENT_GB_TEXTURE_2D: tokens.TEXTURE_2D,
    TextureShaderOperation.DOT_PRODUCT_TEXTURE_2D: tokens.TEXTURE_2D,
    TextureShaderOperation.DOT_PRODUCT_TEXTURE_RECTANGLE: tokens.TEXTURE_RECTANGLE_NV,
    TextureShaderOperation.DOT_PRODUCT_TEXTURE_3D: tokens.TEXTURE_3D,
    TextureShaderOperation.DOT_PRODUCT_TEXTURE_CUBE_MAP: tokens.TEXTURE_CUBE_MAP,
    TextureShaderOperation.DOT_PRODUCT_REFLECT_CUBE_MAP: tokens.TEXTURE_CUBE_MAP,
    TextureShaderOperation.DOT_PRODUCT_CONST_EYE_REFLECT_CUBE_MAP: tokens.TEXTURE_CUBE_MAP,
    TextureShaderOperation.DOT_PRODUCT_DIFFUSE_CUBE_MAP: tokens.TEXTURE_CUBE_MAP,
}
# Targets in the order of their precedence, the highest first (section 3.8.9; NV_texture_rectangle).
_PRECEDENCE = tuple(TARGETS)


def _read_target(gl, unit, enables, shaders, stage):
    """(whether the unit is used, the target that it reads or None).

    With texture shaders the operation of a stage decides this, and the enables have no effect
    (NV_texture_shader).
    """
    if shaders and gl.profile.texture_shaders.texture_shader_operations:
        operation = stage.operation
        return operation is not TextureShaderOperation.NONE, _SHADER_TARGETS.get(operation)
    has = gl.profile.textures.texture_targets
    for target, enabled in zip(_PRECEDENCE, enables, strict=True):
        if enabled and TARGETS[target] in has:
            return True, target
    return False, None


def _unit_keys(unit):
    return (
        *[("enabled", target, unit) for target in _PRECEDENCE],
        ("enabled", tokens.TEXTURE_SHADER_NV),
        ("texture shader", unit),
        *[("bound", target, unit) for target in _PRECEDENCE],
        *[("enabled", token, unit) for token in GENERATIONS],
        ("texture generation", unit),
        ("texture matrix", unit),
        ("environment", unit),
        ("lod_bias", unit),
        ("coord_replace", unit),
        *TEXTURE_TABLE,
        ("enabled", tokens.REGISTER_COMBINERS_NV),
    )


_PREVIOUS = Half(tokens.REPLACE, (tokens.PREVIOUS,) * 3, (tokens.SRC_ALPHA,) * 3)
_PASSING = Environment(
    tokens.COMBINE, rgb=_PREVIOUS._replace(operands=(tokens.SRC_COLOR,) * 3), alpha=_PREVIOUS
)


def _passes(found, environment):
    """Whether a unit passes on fragments' colours unchanged: DECAL with a texture without RGB.

    Source: NV_texture_shader (tables 3.18 and 3.19), which defines this case; OpenGL 1.2.1 (table 3.23) does
    not. Assumed: drivers without that extension did the same, as Mesa does.
    """
    if environment.mode != tokens.DECAL:
        return False
    if found.format in DEPTH_TEXELS:
        return True
    return BASE_FORMAT.get(found.format, BaseFormat.RGBA) not in (BaseFormat.RGB, BaseFormat.RGBA)


def _of_unit(unit):
    """Register the section of one unit."""

    def usable(gl) -> Usable | None:
        values = gl.values
        enables = [values["enabled", target, unit] for target in _PRECEDENCE]
        shaders, stage = values["enabled", tokens.TEXTURE_SHADER_NV], values["texture shader", unit]
        _, target = _read_target(gl, unit, enables, shaders, stage)
        if target is None:
            return None
        texture = bound_object(gl, target, unit)
        texture.readers.add(values)
        return texture.usable()

    @section(f"texture unit {unit}", *_unit_keys(unit), also=usable)
    def build(gl, *parts):
        enables, (shaders, stage), rest = parts[:5], parts[5:7], parts[12:]
        generates, (held, matrices, environment, bias, replaced, *others) = rest[:4], rest[4:]
        tables, table, combiners = others
        takes_part, target = _read_target(gl, unit, enables, shaders, stage)
        found = usable(gl) if target is not None else None
        if not takes_part or (target is not None and found is None):
            return None
        if not (shaders or combiners) and found is not None and _passes(found, environment):
            if TextureEnvironmentMode.COMBINE not in gl.profile.combiners.texture_environment_modes:
                return None
            environment = _PASSING  # another unit may read this one's texture
        has_table = tables and gl.profile.textures.texture_color_table
        most = gl.profile.textures.max_lod_bias
        biased = bias if found is None else min(max(bias + found.parameters.lod_bias, -most), most)
        return TextureUnit(
            texture=None if found is None else found.name,
            sampler=Sampler() if found is None else sampler_of(gl.profile, found),
            lod_bias=biased,
            coordinates=unit,
            gen=tuple([generation(each, on) for each, on in zip(held, generates, strict=True)]),
            matrix=matrices[-1],
            coord_replace=replaced,  # ``driver.place_sprite`` may move this to another unit
            environment=environment_of(environment),
            color_table=table.table if has_table else None,
        )


for _unit in _UNITS:
    _of_unit(_unit)


def sampler_of(profile: Any, found: Usable) -> Sampler:
    """The Sampler of an object. It has those parameters that apply to the object's format and target."""
    given, deep = found.parameters, found.format in DEPTH_TEXELS
    compares = deep and given.compare_mode != tokens.NONE
    modes = profile.textures.depth_texture_modes
    depth_mode = _DEPTH_MODES[given.depth_mode] if deep and not compares else None
    flat = found.target in (TextureTarget.TEXTURE_2D, TextureTarget.TEXTURE_RECTANGLE)
    # Assumed: cube maps, volumes, lines and words of 16 bits are filtered without anisotropy.
    anisotropic = flat and found.format not in FORMATS_OF_WORDS
    least, most = -1000.0, 1000.0
    wraps = [_WRAPS[wrap] for wrap in (given.wrap_s, given.wrap_t, given.wrap_r)]
    return Sampler(
        min_filter=_MIN_FILTERS[given.min_filter],
        mag_filter=_MIN_FILTERS[given.mag_filter],
        wrap_s=wraps[0],
        wrap_t=wraps[1],
        wrap_r=wraps[2],
        border_color=given.border_color,
        compare_mode=_COMPARE_MODES[given.compare_mode] if compares else TextureCompareMode.NONE,
        compare_function=COMPARISONS[given.compare_function] if compares else ComparisonFunction.LEQUAL,
        compare_fail_value=given.compare_fail_value if compares else 0.0,
        depth_texture_mode=depth_mode if depth_mode in modes else None,
        min_lod=min(max(given.min_lod, least), most),
        max_lod=min(max(given.max_lod, least), most),
        base_level=given.base_level - found.first,
        # Without mipmaps the base level is read, even if it is above the maximum level (section 3.8.5).
        max_level=max(given.max_level, given.base_level) - found.first,
        max_anisotropy=given.max_anisotropy if anisotropic else 1.0,
    )


_UNIT_SECTIONS = tuple([f"texture unit {unit}" for unit in _UNITS])


@section("texture_units", *_UNIT_SECTIONS)
def _texture_units(gl, *units):
    used = units[: gl.profile.textures.max_texture_units]
    while used and used[-1] is None:
        used = used[:-1]
    return used


@section("units beyond the machine's", *_UNIT_SECTIONS)
def _units_beyond(gl, *units):
    """A tuple with one element: a tuple of the numbers of enabled units that the machine does not have."""
    most = gl.profile.textures.max_texture_units
    return (tuple([unit for unit, made in enumerate(units) if made is not None and unit >= most]),)


def store_textures(gl: Any, state: PassState) -> None:
    """Add the commands that store the present textures of ``state`` in the drawable's machine.

    Raises Refused if a unit is enabled that the machine does not have.
    """
    (beyond,) = gl.values.section("units beyond the machine's")
    if beyond:
        has = gl.profile.textures.max_texture_units
        raise Refused(f"texture unit {beyond[0]} is enabled, and {gl.profile.name} has {has}")
    for unit in state.texture_units:
        if unit is not None and unit.texture is not None:
            object_named(gl, unit.texture).store(gl)


def object_named(gl: Any, name: str) -> TextureObject:
    """The texture object of a name in commands."""
    key: Any = _DEFAULTS.get(name)
    return gl.shared.textures[int(name.removeprefix("texture ")) if key is None else key]
