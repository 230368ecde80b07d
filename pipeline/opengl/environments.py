"""Texture environments: TexEnv (OpenGL 1.2.1 section 3.8.9, ARB_texture_env_combine, NV_texture_shader)."""

from functools import lru_cache
from typing import Any, NamedTuple, NoReturn

from fixedpipe.pipeline.enums import (
    CombineFunction,
    CombineOperand,
    CombineSource,
    TextureEnvironmentMode,
)
from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.combiners import set_texture_shader
from fixedpipe.pipeline.opengl.current import COORDINATE_SETS
from fixedpipe.pipeline.opengl.fragments import clamped, member, words
from fixedpipe.pipeline.opengl.outcomes import GLError
from fixedpipe.pipeline.opengl.parameters import Parameter, register_parameters
from fixedpipe.pipeline.opengl.values import declare
from fixedpipe.pipeline.state import (
    Combine,
    TextureEnvironment,
)

# ----------------------------------------------------------------------------------------------- environments

_ENVIRONMENTS = words(TextureEnvironmentMode) | {tokens.REPLACE_EXT: TextureEnvironmentMode.REPLACE}
_FUNCTIONS = words(CombineFunction) | {
    tokens.DOT3_RGB_EXT: CombineFunction.DOT3_RGB,
    tokens.DOT3_RGBA_EXT: CombineFunction.DOT3_RGBA,
}
_SOURCES = words(CombineSource)
_OPERANDS = words(CombineOperand)
_HALVES = ("rgb", "alpha")


class Half(NamedTuple):
    """One half of a COMBINE environment (RGB or alpha), as tokens. Only COMBINE4 has the fourth argument."""

    function: int
    sources: tuple[int, int, int, int]
    operands: tuple[int, int, int, int]
    scale: float = 1.0


class Environment(NamedTuple):
    """A unit's texture environment (table 6.15 and extensions), as tokens."""

    mode: int = tokens.MODULATE
    color: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    rgb: Half = Half(
        tokens.MODULATE,
        (tokens.TEXTURE, tokens.PREVIOUS, tokens.CONSTANT, tokens.ZERO),
        (tokens.SRC_COLOR, tokens.SRC_COLOR, tokens.SRC_ALPHA, tokens.ONE_MINUS_SRC_COLOR),
    )
    alpha: Half = Half(
        tokens.MODULATE,
        (tokens.TEXTURE, tokens.PREVIOUS, tokens.CONSTANT, tokens.ZERO),
        (tokens.SRC_ALPHA, tokens.SRC_ALPHA, tokens.SRC_ALPHA, tokens.ONE_MINUS_SRC_ALPHA),
    )


for _unit in range(COORDINATE_SETS):
    declare(("environment", _unit), Environment(), tokens.TEXTURE_BIT)
    declare(("lod_bias", _unit), 0.0, tokens.TEXTURE_BIT)
    declare(("coord_replace", _unit), False, tokens.POINT_BIT)

FUNCTION_OF = {tokens.COMBINE_RGB: "rgb", tokens.COMBINE_ALPHA: "alpha"}
SCALE_OF = {tokens.RGB_SCALE: "rgb", tokens.ALPHA_SCALE: "alpha"}
# {name of an argument: (half, place)}.
SOURCE_OF = {
    first + place: (half, place)
    for half, first in (("rgb", tokens.SOURCE0_RGB), ("alpha", tokens.SOURCE0_ALPHA))
    for place in range(4)
}
OPERAND_OF = {
    first + place: (half, place)
    for half, first in (("rgb", tokens.OPERAND0_RGB), ("alpha", tokens.OPERAND0_ALPHA))
    for place in range(4)
}


def _tex_env(gl, target, name, given):
    unit = gl.values["active_texture"]
    if target == tokens.TEXTURE_FILTER_CONTROL and name == tokens.TEXTURE_LOD_BIAS:
        gl.values.set(("lod_bias", unit), lod_bias(gl, given))
    elif target == tokens.POINT_SPRITE_ARB and name == tokens.COORD_REPLACE_ARB:
        gl.values.set(("coord_replace", unit), given.number() != 0)
    elif target == tokens.TEXTURE_SHADER_NV:
        if not gl.profile.texture_shaders.texture_shader_operations:
            unknown_value(gl, "texture shaders")
        set_texture_shader(gl, unit, name, given)
    elif target == tokens.TEXTURE_ENV:
        held = gl.values["environment", unit]
        gl.values.set(("environment", unit), _changed_environment(gl, held, name, given))
    else:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(target)}, {tokens.name_of(name)}")


register_parameters("TexEnv", _tex_env)


def _changed_environment(gl, held, name, given):
    """The Environment after TexEnv(TEXTURE_ENV, ...). Raises GLError."""
    combiners = gl.profile.combiners
    if name == tokens.TEXTURE_ENV_MODE:
        mode = member(_ENVIRONMENTS, given.token())
        # A machine without environments has combiners instead. Its driver accepted the names.
        if combiners.texture_environment_modes and mode not in combiners.texture_environment_modes:
            unknown_value(gl, f"environment {mode.name}")
        return held._replace(mode=given.token())
    if name == tokens.TEXTURE_ENV_COLOR:
        return held._replace(color=clamped(*given.color()))
    token = int(given.number())
    if name in FUNCTION_OF:
        half, function = FUNCTION_OF[name], member(_FUNCTIONS, token)
        dots = function in (CombineFunction.DOT3_RGB, CombineFunction.DOT3_RGBA)
        if function not in combiners.combine_functions or (dots and half == "alpha"):
            unknown_value(gl, f"function {function.name} of {half}")
        return _with_half(held, half, function=token)
    if name in SCALE_OF:
        if given.number() not in (1.0, 2.0, 4.0):
            raise GLError(tokens.INVALID_VALUE, f"a scale of {given.number():g}")
        return _with_half(held, SCALE_OF[name], scale=given.number())
    if name in SOURCE_OF:
        half, place = SOURCE_OF[name]
        member(_SOURCES, token)
        return _with_half(held, half, sources=with_member(getattr(held, half).sources, place, token))
    if name in OPERAND_OF:
        half, place = OPERAND_OF[name]
        operand = member(_OPERANDS, token)
        if half == "alpha" and operand in (CombineOperand.SRC_COLOR, CombineOperand.ONE_MINUS_SRC_COLOR):
            raise GLError(tokens.INVALID_ENUM, "the alpha half takes operands of alpha")
        return _with_half(held, half, operands=with_member(getattr(held, half).operands, place, token))
    raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(name)} is no parameter of environments here")


def with_member(members: tuple[Any, ...], place: int, value: Any) -> tuple[Any, ...]:
    """The members, with ``value`` at one place."""
    return (*members[:place], value, *members[place + 1 :])


def _with_half(environment, half, **changes):
    return environment._replace(**{half: getattr(environment, half)._replace(**changes)})


_UNSCALED = (tokens.DOT3_RGB_EXT, tokens.DOT3_RGBA_EXT)


@lru_cache(maxsize=1024)
def environment_of(held: Environment) -> TextureEnvironment:
    """The TextureEnvironment for an Environment of tokens."""
    mode = _ENVIRONMENTS[held.mode]
    if mode not in (TextureEnvironmentMode.COMBINE, TextureEnvironmentMode.COMBINE4):
        return TextureEnvironment(mode, held.color)
    arguments = 4 if mode is TextureEnvironmentMode.COMBINE4 else 3
    halves = [
        Combine(
            _FUNCTIONS[half.function],
            tuple([_SOURCES[source] for source in half.sources[:arguments]]),
            tuple([_OPERANDS[operand] for operand in half.operands[:arguments]]),
            # ARB_texture_env_dot3, issue 2: the products of the EXT version are not scaled.
            1.0 if half.function in _UNSCALED else half.scale,
        )
        for half in (held.rgb, held.alpha)
    ]
    return TextureEnvironment(mode, held.color, *halves)


def unknown_value(gl: Any, what: str) -> NoReturn:
    """Raise GLError for a value that the machine's driver did not accept."""
    raise GLError(tokens.INVALID_ENUM, f"{gl.profile.name} has no {what}")


def lod_bias(gl: Any, given: Parameter) -> float:
    """TEXTURE_LOD_BIAS, limited to the machine's range. Raises GLError if the machine has no such bias."""
    most = gl.profile.textures.max_lod_bias
    if most <= 0:
        unknown_value(gl, "bias of the level of detail")
    return min(max(given.number(), -most), most)
