"""Points: size, parameters and sprites (OpenGL 1.2.1 section 3.3, ARB_point_parameters, NV_point_sprite)."""

from math import isfinite

from fixedpipe.pipeline.opengl import driver, tokens
from fixedpipe.pipeline.opengl.capabilities import capability
from fixedpipe.pipeline.opengl.entry_points import entry
from fixedpipe.pipeline.opengl.fragments import member
from fixedpipe.pipeline.opengl.outcomes import GLError, LeftOut
from fixedpipe.pipeline.opengl.parameters import register_parameters
from fixedpipe.pipeline.opengl.values import declare, section
from fixedpipe.pipeline.state import PointState

# POINT_SPRITE_COORD_ORIGIN and its values, of OpenGL 2.0.
_ORIGIN, _ORIGINS = 0x8CA0, {0x8CA1: "LOWER_LEFT", 0x8CA2: "UPPER_LEFT"}
# Parameters of one number, and the key of each one's value.
POINT_NUMBERS = {
    tokens.POINT_SIZE_MIN: "point_size_min",
    tokens.POINT_SIZE_MAX: "point_size_max",
    tokens.POINT_FADE_THRESHOLD_SIZE: "point_fade_threshold",
}
_R_MODES = {tokens.ZERO: "ZERO", tokens.S: "S", tokens.R: "R"}
_CONSTANT = (1.0, 0.0, 0.0)

_POINT = tokens.POINT_BIT
capability(tokens.POINT_SMOOTH, _POINT)
capability(tokens.POINT_SPRITE_ARB, _POINT)
declare("point_size", 1.0, _POINT)
declare("point_size_min", 0.0, _POINT)
declare("point_size_max", lambda gl: float(gl.profile.primitives.max_point_size), _POINT)
declare("point_fade_threshold", 1.0, _POINT)
declare("point_attenuation", _CONSTANT, _POINT)
declare("point_sprite_r_mode", tokens.ZERO, _POINT)


@section(
    "point",
    "point_size",
    ("enabled", tokens.POINT_SMOOTH),
    ("enabled", tokens.POINT_SPRITE_ARB),
    "point_size_min",
    "point_size_max",
    "point_attenuation",
)
def _point(gl, size, smooth, sprite, smallest, largest, attenuation):
    if not all(map(isfinite, (size, smallest, largest, *attenuation))):
        raise LeftOut("a point size or one of its parameters is infinite or no number")
    profile = gl.profile
    if smooth:
        gl.tally.add("no effect", f"POINT_SMOOTH: {profile.name} has no smooth points; they are squares")
    if sprite and not profile.primitives.point_sprite_units:
        gl.tally.add("no effect", f"POINT_SPRITE: {profile.name} has no point sprites; they are squares")
        sprite = False
    parameters = None
    if attenuation != _CONSTANT:
        if profile.vertices.point_parameters:
            parameters = driver.point_parameters(profile, size, attenuation, smallest, largest)
        else:
            gl.tally.add(
                "no effect",
                f"POINT_DISTANCE_ATTENUATION: {profile.name}'s points have one size at any distance",
            )
    # ARB_point_parameters: the limits apply to every point.
    size = driver.point_size(profile, min(max(size, smallest), largest))
    return PointState(size=size, sprite=sprite, parameters=parameters)


@entry("PointSize")
def point_size(gl, size):
    """Set the size of points, in pixels."""
    if not size > 0:
        raise GLError(tokens.INVALID_VALUE, f"a point size of {size}")
    gl.values.set("point_size", float(size))


def _point_parameter(gl, name, given):
    if name == tokens.POINT_DISTANCE_ATTENUATION:
        gl.values.set("point_attenuation", given.vector_of(3))
    elif name == tokens.POINT_SPRITE_R_MODE_NV:
        member(_R_MODES, given.token())
        gl.values.set("point_sprite_r_mode", given.token())
        gl.tally.add("no effect", "POINT_SPRITE_R_MODE_NV: r is 0 in a point sprite here")
    elif name == _ORIGIN:
        member(_ORIGINS, given.token())
        if _ORIGINS[given.token()] == "LOWER_LEFT":
            gl.tally.add("no effect", "POINT_SPRITE_COORD_ORIGIN: t is 0 at a point sprite's upper side here")
    else:
        key = member(POINT_NUMBERS, name)
        if not given.number() >= 0:
            raise GLError(tokens.INVALID_VALUE, f"{tokens.name_of(name)} {given.number()}")
        gl.values.set(key, given.number())


register_parameters("PointParameter", _point_parameter)
