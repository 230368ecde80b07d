"""The work of a driver between OpenGL and the chip: rules, each with its evidence.

This module omits what a machine does itself: the registers of a positional spotlight (docs/numbers.md
N2.26), powers for shininess (N2.17), and fog's line (section 9). It also omits the rounding of sizes on
machines that follow OpenGL's rules for points and lines (N11.9).
"""

import math
from dataclasses import replace

from fixedpipe.pipeline.enums import (
    CombineSource,
    FogArithmetic,
    FogGeneration,
    FogMode,
    LightingArithmetic,
    Register,
    SecondaryColor,
)
from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.matrices import rounded
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.state import (
    Fog,
    FogRegisters,
    Light,
    Lighting,
    PassState,
    PointParameters,
    RegisterCombiners,
    TextureUnit,
)


def _dot(a, b):
    return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]


def has_lighting_unit(profile: Profile) -> bool:
    """Whether the NV10's lighting unit computes lighting, and not OpenGL's equations."""
    return profile.arithmetic.lighting is LightingArithmetic.LIGHTING_UNIT


# ------------------------------------------------------------------------------------------------ lights


def light(profile: Profile, light: Light) -> Light:
    """A light in the form that the machine takes.

    A lighting unit has only spotlights with a position. The spotlight factor of a directional light is the
    same at every vertex (OpenGL 1.2.1 section 2.13.1), so the driver multiplies the light's colours by it.
    Assumed: NVIDIA's driver did as the specification says; nouveau's ignores the spotlight of such a light.
    """
    if not has_lighting_unit(profile) or light.spot_cutoff == 180 or light.position[3] != 0:
        return light
    to_light, axis = light.position[:3], light.spot_direction
    size = math.sqrt(_dot(to_light, to_light)) * math.sqrt(_dot(axis, axis))
    cosine = -_dot(to_light, axis) / size if size else 0.0
    # For a half-space the limit is exact.
    limit = 0.0 if light.spot_cutoff == 90 else rounded(math.cos(math.radians(light.spot_cutoff)))
    factor = rounded(max(cosine, 0.0) ** light.spot_exponent) if cosine >= limit else 0.0
    return replace(
        light,
        ambient=_scaled(light.ambient, factor),
        diffuse=_scaled(light.diffuse, factor),
        specular=_scaled(light.specular, factor),
        spot_cutoff=180.0,
        spot_exponent=0.0,
    )


def _scaled(color, factor):
    red, green, blue, alpha = color
    return red * factor, green * factor, blue * factor, alpha


def secondary_color(profile: Profile, lighting: Lighting | None, register_combiners: bool) -> SecondaryColor:
    """The source of the secondary colour.

    With a single colour, lighting's secondary colour is black (OpenGL 1.2.1 section 2.13.1). A lighting unit
    would pass on the vertices' secondary colours (docs/numbers.md N2.18), so the driver disables them if
    combiners may read them. Inferred: from those two.
    """
    single = lighting is not None and not lighting.separate_specular_color
    if single and register_combiners and has_lighting_unit(profile):
        return SecondaryColor.DISABLED
    return SecondaryColor.FROM_VERTEX


# --------------------------------------------------------------------------------------------------- fog

# The distances of NV_fog_distance.
FOG_DISTANCES = {
    tokens.EYE_RADIAL_NV: FogGeneration.RADIAL,
    tokens.EYE_PLANE: FogGeneration.PLANAR,
    tokens.EYE_PLANE_ABSOLUTE_NV: FogGeneration.ABSOLUTE_PLANAR,
}
# docs/numbers.md section 9: the exponential modes' table ends where the factor is 1/256.
_LN_256 = math.log(256.0)
_NO_LENGTH = 2.0**-24


def fog_registers(profile: Profile, fog: Fog, distance: int) -> FogRegisters | None:
    """The registers of a fog whose distance is not |z|; None if the machine has no such fog.

    Source: nouveau's fog coordinate modes, one for each of NV_fog_distance's. Bias and multiplier:
    docs/numbers.md section 9, the same as for a fog without registers.
    """
    if not profile.fragments.fog_registers or profile.arithmetic.fog_arithmetic is not FogArithmetic.TABLE:
        return None
    if fog.mode is FogMode.LINEAR:
        multiplier = -1.0 / (fog.end - fog.start or _NO_LENGTH)
        bias = 1.0 - fog.end * multiplier
    else:
        reach = _LN_256 if fog.mode is FogMode.EXP else math.sqrt(_LN_256)
        bias, multiplier = 1.5, -fog.density / (2.0 * reach)
    return FogRegisters(bias=bias, multiplier=multiplier, generation=FOG_DISTANCES[distance])


# ------------------------------------------------------------------------------------------------ points


def point_size(profile: Profile, size: float) -> float:
    """The size of a point without antialiasing: the nearest integer, at least 1, at most the machine's.

    Source: OpenGL 1.2.1 section 3.3.
    """
    return min(max(1.0, math.floor(size + 0.5)), profile.primitives.max_point_size)


def point_parameters(
    profile: Profile, size: float, attenuation: tuple[float, float, float], smallest: float, largest: float
) -> PointParameters | None:
    """The chip's parameters for points of ``size`` that shrink with distance; None for points of one size.

    Source: EXT_point_parameters, in the form of the NV2A's SET_POINT_PARAMS. Assumed: alpha does not fade
    below the threshold, because the chip has no register for it.
    """
    largest = min(largest, profile.primitives.max_point_size)
    if not largest > smallest or size <= 0:
        return None
    reach = largest - smallest
    a, b, c = [term * (reach / size) ** 2 for term in attenuation]
    return PointParameters((a, b, c), bias=-smallest / reach, range=reach, minimum=smallest)


# ---------------------------------------------------------------------------------------- point sprites


def place_sprite(profile: Profile, state: PassState) -> PassState:
    """The state with a point sprite's texture on a unit that can replace its coordinates.

    A chip replaces the coordinates of few units (``point_sprite_units``); in OpenGL a program may choose any
    unit. The driver moves the texture to such a unit if this changes nothing else: the units between must be
    disabled. Combiners and environments then use the new number. The machine handles all other requests.
    Assumed: a driver of 2001 did so; NV_point_sprite mentions no limit.
    """
    units = state.texture_units
    replaced = [i for i, unit in enumerate(units) if unit is not None and unit.coord_replace]
    if not replaced:
        return state
    places = profile.primitives.point_sprite_units
    if not state.point.sprite or not places:
        return replace(state, texture_units=tuple([_without_sprite(unit) for unit in units]))
    if len(replaced) != 1 or replaced[0] in places or state.texture_shader is not None:
        return state
    unit = replaced[0]
    free = [place for place in sorted(places) if place > unit and not any(units[unit + 1 : place + 1])]
    if not free:
        return state
    return _moved(state, unit, free[0])


def _without_sprite(unit):
    return unit if unit is None else replace(unit, coord_replace=False)


def _moved(state: PassState, unit: int, place: int) -> PassState:
    """The state with unit ``unit`` at ``place``. The unit at ``place`` and those between are disabled."""
    units: list[TextureUnit | None] = list(state.texture_units[:place])
    units += [None] * (place + 1 - len(units))
    units[place], units[unit] = units[unit], None
    sources = {CombineSource[f"TEXTURE{unit}"]: CombineSource[f"TEXTURE{place}"]}
    registers = {Register[f"TEXTURE{unit}"]: Register[f"TEXTURE{place}"]}
    registers |= {new: old for old, new in registers.items()}
    combiners = state.register_combiners
    return replace(
        state,
        texture_units=tuple([_renamed_unit(each, sources) for each in units]),
        register_combiners=None if combiners is None else renamed_registers(combiners, registers),
    )


def _renamed_unit(unit, sources):
    """A unit with renamed sources in its environment."""
    if unit is None:
        return None
    environment = unit.environment
    halves = {
        half: replace(combine, sources=tuple([sources.get(s, s) for s in combine.sources]))
        for half, combine in (("rgb", environment.rgb), ("alpha", environment.alpha))
    }
    return replace(unit, environment=replace(environment, **halves))


def renamed_registers(combiners: RegisterCombiners, names: dict[Register, Register]) -> RegisterCombiners:
    """The same combiners with renamed registers."""

    def portion(given, inputs, outputs):
        changed = {name: getattr(given, name) for name in inputs}
        changed = {
            name: replace(each, register=names.get(each.register, each.register))
            for name, each in changed.items()
        }
        changed |= {name: names.get(getattr(given, name), getattr(given, name)) for name in outputs}
        return replace(given, **changed)

    outputs = ("ab_output", "cd_output", "sum_output")
    general = [
        replace(
            stage,
            rgb=portion(stage.rgb, "abcd", outputs),
            alpha=portion(stage.alpha, "abcd", outputs),
        )
        for stage in combiners.general
    ]
    return replace(combiners, general=tuple(general), final=portion(combiners.final, "abcdefg", ()))
