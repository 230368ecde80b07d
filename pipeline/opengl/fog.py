"""Fog (OpenGL 1.2.1 section 3.10, EXT_fog_coord, NV_fog_distance)."""

from dataclasses import replace
from itertools import chain
from math import isfinite

from fixedpipe.pipeline.enums import ComponentUsage, FogCoordinateSource, FogMode, Register
from fixedpipe.pipeline.opengl import driver, tokens
from fixedpipe.pipeline.opengl.capabilities import capability
from fixedpipe.pipeline.opengl.fragments import clamped, member, words
from fixedpipe.pipeline.opengl.outcomes import GLError, LeftOut
from fixedpipe.pipeline.opengl.parameters import register_parameters
from fixedpipe.pipeline.opengl.values import declare, section
from fixedpipe.pipeline.state import CombinerInput, Fog

FOG_MODES = words(FogMode)
FOG_SOURCES = {
    tokens.FRAGMENT_DEPTH: FogCoordinateSource.FRAGMENT_DEPTH,
    tokens.FOG_COORD: FogCoordinateSource.FOG_COORDINATE,
}
# Parameters of one number, and the key of each one's value.
FOG_NUMBERS = {
    tokens.FOG_DENSITY: "fog_density",
    tokens.FOG_START: "fog_start",
    tokens.FOG_END: "fog_end",
    tokens.FOG_INDEX: "fog_index",
}

_FOG = tokens.FOG_BIT
capability(tokens.FOG, _FOG)
capability(tokens.COLOR_SUM, _FOG)
declare("fog_mode", tokens.EXP, _FOG)
declare("fog_density", 1.0, _FOG)
declare("fog_start", 0.0, _FOG)
declare("fog_end", 1.0, _FOG)
declare("fog_index", 0.0, _FOG)
declare("fog_color", (0.0, 0.0, 0.0, 0.0), _FOG)
declare("fog_source", tokens.FRAGMENT_DEPTH, _FOG)
declare("fog_distance", tokens.EYE_PLANE_ABSOLUTE_NV, _FOG)


@section(
    "fog",
    ("enabled", tokens.FOG),
    "fog_mode",
    "fog_density",
    "fog_start",
    "fog_end",
    "fog_color",
    "fog_source",
    "fog_distance",
    "register_combiners",
)
def _fog(gl, enabled, mode, density, start, end, color, source, distance, combiners):
    if not enabled:
        return _color_alone(color, combiners)
    if not all(map(isfinite, chain(color, (density, start, end)))):
        raise LeftOut("fog has a number that is infinite or no number")
    fog = Fog(FOG_MODES[mode], density, start, end, color, FOG_SOURCES[source])
    if source != tokens.FRAGMENT_DEPTH or distance == tokens.EYE_PLANE_ABSOLUTE_NV:
        return fog
    registers = driver.fog_registers(gl.profile, fog, distance)
    if registers is None:
        gl.tally.add("no effect", f"FOG_DISTANCE_MODE_NV: {gl.profile.name}'s fog has the distance |z| alone")
        return fog
    return replace(fog, registers=registers)


# Input A of a final combiner that blends fog. Disabled fog has a factor of 1, so input C, the fog colour, has
# the weight 1 - A = 0.
_FACTOR = CombinerInput(Register.FOG, usage=ComponentUsage.ALPHA)


def _color_alone(color, combiners):
    """The Fog for disabled fog if register combiners read its colour; its factor is one everywhere.

    Source: NV_register_combiners (FOG's colour is the fog colour; its alpha is one if fog is disabled).
    """
    if combiners is None or not any(color[:3]) or not _read_fog_color(combiners):
        return None
    return Fog(FogMode.EXP, density=0.0, color=color)


def _read_fog_color(combiners):
    """Whether combiners read the FOG register's colour in an input where it can have an effect."""
    final = combiners.final
    inputs = [getattr(final, name) for name in ("abdefg" if final.a == _FACTOR else "abcdefg")]
    for stage in combiners.general:
        inputs += [getattr(portion, name) for portion in (stage.rgb, stage.alpha) for name in "abcd"]
    return any(given.register is Register.FOG and given.usage is not ComponentUsage.ALPHA for given in inputs)


def _set_fog(gl, name, given):
    values = gl.values
    if name == tokens.FOG_COLOR:
        values.set("fog_color", clamped(*given.color()))
    elif name == tokens.FOG_MODE:
        member(FOG_MODES, given.token())
        values.set("fog_mode", given.token())
    elif name == tokens.FOG_COORD_SRC:
        member(FOG_SOURCES, given.token())
        values.set("fog_source", given.token())
    elif name == tokens.FOG_DISTANCE_MODE_NV:
        member(driver.FOG_DISTANCES, given.token())
        values.set("fog_distance", given.token())
    else:
        key = member(FOG_NUMBERS, name)
        if name == tokens.FOG_DENSITY and not given.number() >= 0:
            raise GLError(tokens.INVALID_VALUE, f"a fog density of {given.number()}")
        values.set(key, given.number())


register_parameters("Fog", _set_fog)
