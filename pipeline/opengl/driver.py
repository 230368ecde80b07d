"""What a driver did between OpenGL and the chip: each rule with its evidence.

What a machine already does for itself is not here: the registers of a positional spotlight (docs/numbers.md
N2.26), powers for shininess (N2.17), fog's line (section 9), and the rounding of sizes on machines that
follow OpenGL's rules for points and lines (N11.9).
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


def has_lighting_unit(profile: Profile) -> bool:
    """Whether lighting is the NV10's unit, and not OpenGL's equations."""
    return profile.arithmetic.lighting is LightingArithmetic.LIGHTING_UNIT


# ------------------------------------------------------------------------------------------------ lights


def light(profile: Profile, light: Light) -> Light:
    """A light as the machine takes it.

    A lighting unit has spotlights with a position alone. The factor of a directional one's spotlight is the
    same at every vertex (OpenGL 1.2.1 section 2.13.1), so the driver multiplies the light's colours by it.
    Assumed: NVIDIA's driver did as the specification says; nouveau's ignores the spotlight of such a light.
    """
    if not has_lighting_unit(profile) or light.spot_cutoff == 180 or light.position[3] != 0:
        return light
    to_light, axis = light.position[:3], light.spot_direction
    size = math.sqrt(sum(c * c for c in to_light)) * math.sqrt(sum(c * c for c in axis))
    cosine = -sum(a * b for a, b in zip(to_light, axis, strict=True)) / size if size else 0.0
    # A half-space has no rounding in its limit.
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

    With a single colour, lighting's secondary colour is black (OpenGL 1.2.1 section 2.13.1). A lighting
    unit would pass the vertices' own on (docs/numbers.md N2.18), so the driver disables it where combiners
    may read it. Inferred: from those two.
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
    """The registers of a fog whose distance is not |z|, or None where the machine has no such fog.

    Source: nouveau's fog coordinate modes, one for each of NV_fog_distance's. Bias and multiplier:
    docs/numbers.md section 9, as of a fog without registers.
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

    Source: EXT_point_parameters, in the form of the NV2A's SET_POINT_PARAMS. Assumed: no alpha fades below
    the threshold, for which the chip has no register.
    """
    largest = min(largest, profile.primitives.max_point_size)
    if not largest > smallest or size <= 0:
        return None
    reach = largest - smallest
    a, b, c = [term * (reach / size) ** 2 for term in attenuation]
    return PointParameters((a, b, c), bias=-smallest / reach, range=reach, minimum=smallest)


# ---------------------------------------------------------------------------------------- point sprites


def place_sprite(profile: Profile, state: PassState) -> PassState:
    """The state with the texture that a point sprite shows on a unit that can show one.

    A chip replaces the coordinates of few units (``point_sprite_units``), and OpenGL lets a program choose
    any. The driver moves the texture to such a unit where that changes nothing else: the units between are
    disabled, and combiners and environments name it by its new number. What else a program asks for is left
    to the machine. Assumed: a driver of 2001 did so; NV_point_sprite says nothing of a limit.
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
    """The state with unit ``unit`` at ``place``, which is disabled, as are those between."""
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
    """A unit whose environment names other sources."""
    if unit is None:
        return None
    environment = unit.environment
    halves = {
        half: replace(combine, sources=tuple([sources.get(s, s) for s in combine.sources]))
        for half, combine in (("rgb", environment.rgb), ("alpha", environment.alpha))
    }
    return replace(unit, environment=replace(environment, **halves))


def renamed_registers(combiners: RegisterCombiners, names: dict[Register, Register]) -> RegisterCombiners:
    """The same combiners with other names of registers."""

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
