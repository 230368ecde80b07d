"""NV_register_combiners 1 and 2, NV_texture_shader's stages, NV_depth_clamp, and hints.

A call that would make combiners which NV_register_combiners forbids is INVALID_OPERATION, and is ignored.
"""

from dataclasses import replace

from fixedpipe.pipeline.enums import (
    CombinerBias,
    CombinerScale,
    ComponentUsage,
    CullMode,
    DotProductMapping,
    Mapping,
    Register,
    TextureShaderOperation,
)
from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.capabilities import capability
from fixedpipe.pipeline.opengl.current import COORDINATE_SETS
from fixedpipe.pipeline.opengl.entry_points import entry
from fixedpipe.pipeline.opengl.fragments import clamped, member
from fixedpipe.pipeline.opengl.outcomes import GLError, Refused
from fixedpipe.pipeline.opengl.parameters import Parameter, register_parameters
from fixedpipe.pipeline.opengl.values import declare, section
from fixedpipe.pipeline.programs.combiner_rules import combiner_problems
from fixedpipe.pipeline.programs.texture_shader_rules import texture_shader_problems
from fixedpipe.pipeline.state import (
    CombinerInput,
    DepthClamp,
    FinalCombiner,
    GeneralCombiner,
    RegisterCombiners,
    TextureShaderStage,
)

# How many general combiners a context stores, for any machine.
GENERAL_COMBINERS = 8
# Texture units with a texture shader stage (NV_texture_shader).
SHADER_STAGES = 4

_BLACK = (0.0, 0.0, 0.0, 0.0)


def _of_names(enumeration, suffix="_NV"):
    return {
        getattr(tokens, each.name + suffix): each
        for each in enumeration
        if hasattr(tokens, each.name + suffix)
    }


REGISTERS = {
    tokens.ZERO: Register.ZERO,
    tokens.CONSTANT_COLOR0_NV: Register.CONSTANT_COLOR0,
    tokens.CONSTANT_COLOR1_NV: Register.CONSTANT_COLOR1,
    tokens.FOG: Register.FOG,
    tokens.PRIMARY_COLOR_NV: Register.PRIMARY_COLOR,
    tokens.SECONDARY_COLOR_NV: Register.SECONDARY_COLOR,
    tokens.SPARE0_NV: Register.SPARE0,
    tokens.SPARE1_NV: Register.SPARE1,
    tokens.TEXTURE0: Register.TEXTURE0,
    tokens.TEXTURE1: Register.TEXTURE1,
    tokens.TEXTURE2: Register.TEXTURE2,
    tokens.TEXTURE3: Register.TEXTURE3,
    tokens.E_TIMES_F_NV: Register.E_TIMES_F,
    tokens.SPARE0_PLUS_SECONDARY_COLOR_NV: Register.SPARE0_PLUS_SECONDARY_COLOR,
    tokens.DISCARD_NV: Register.DISCARD,
}
MAPPINGS = _of_names(Mapping)
USAGES = {
    tokens.RGB: ComponentUsage.RGB,
    tokens.ALPHA: ComponentUsage.ALPHA,
    tokens.BLUE: ComponentUsage.BLUE,
}
SCALES = {tokens.NONE: CombinerScale.NONE} | _of_names(CombinerScale)
BIASES = {tokens.NONE: CombinerBias.NONE} | _of_names(CombinerBias)
_PORTIONS = {tokens.RGB: "rgb", tokens.ALPHA: "alpha"}
_VARIABLES = {tokens.VARIABLE_A_NV + i: name for i, name in enumerate("abcdefg")}
_CONSTANTS = {tokens.CONSTANT_COLOR0_NV: "constant_color0", tokens.CONSTANT_COLOR1_NV: "constant_color1"}

_TEXTURE = tokens.TEXTURE_BIT
capability(tokens.REGISTER_COMBINERS_NV, _TEXTURE)
capability(tokens.PER_STAGE_CONSTANTS_NV, _TEXTURE)
for _stage in range(GENERAL_COMBINERS):
    declare(("general combiner", _stage), GeneralCombiner(), _TEXTURE)
    declare(("stage constants", _stage), (_BLACK, _BLACK), _TEXTURE)
declare("final combiner", FinalCombiner(), _TEXTURE)
declare("general combiners", 1, _TEXTURE)
declare("color_sum_clamp", True, _TEXTURE)
declare("constant_color0", _BLACK, _TEXTURE)
declare("constant_color1", _BLACK, _TEXTURE)


@section(
    "register_combiners",
    ("enabled", tokens.REGISTER_COMBINERS_NV),
    "general combiners",
    "final combiner",
    "constant_color0",
    "constant_color1",
    "color_sum_clamp",
    ("enabled", tokens.PER_STAGE_CONSTANTS_NV),
    *[("general combiner", i) for i in range(GENERAL_COMBINERS)],
    *[("stage constants", i) for i in range(GENERAL_COMBINERS)],
)
def _register_combiners(gl, enabled, count, final, constant0, constant1, clamp, own, *stages):
    if not enabled:
        return None
    general, constants = stages[:count], stages[GENERAL_COMBINERS:]
    if own:
        general = tuple(
            [
                replace(stage, constant_color0=first, constant_color1=second)
                for stage, (first, second) in zip(general, constants, strict=False)
            ]
        )
    return RegisterCombiners(general, final, constant0, constant1, clamp)


def _combiner_parameter(gl, name, given):
    if name in _CONSTANTS:
        gl.values.set(_CONSTANTS[name], clamped(*given.color()))
    elif name == tokens.NUM_GENERAL_COMBINERS_NV:
        count = given.token()
        if not 1 <= count <= GENERAL_COMBINERS:
            raise GLError(tokens.INVALID_VALUE, f"{count} general combiners")
        gl.values.set("general combiners", count)
    elif name == tokens.COLOR_SUM_CLAMP_NV:
        gl.values.set("color_sum_clamp", given.number() != 0)
    else:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(name)} is no parameter of combiners")


register_parameters("CombinerParameter", _combiner_parameter)


def _stage_number(stage):
    number = stage - tokens.COMBINER0_NV
    if not 0 <= number < GENERAL_COMBINERS:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(stage)} is no general combiner")
    return number


def _combiner_stage_parameter(gl, stage, name, given):
    key, place = ("stage constants", _stage_number(stage)), tuple(_CONSTANTS).index(name)
    constants = list(gl.values[key])
    constants[place] = clamped(*given.color())
    gl.values.set(key, tuple(constants))


register_parameters("CombinerStageParameter", _combiner_stage_parameter)


def _refuse_problems(combiners):
    for _, sentence in combiner_problems(combiners):
        raise GLError(tokens.INVALID_OPERATION, sentence)


def _set_portion(gl, stage, portion, **changes):
    key, name = ("general combiner", _stage_number(stage)), member(_PORTIONS, portion)
    before = gl.values[key]
    after = replace(before, **{name: replace(getattr(before, name), **changes)})
    _refuse_problems(RegisterCombiners((after,)))
    gl.values.set(key, after)


def _input(register, mapping, usage):
    return CombinerInput(member(REGISTERS, register), member(MAPPINGS, mapping), member(USAGES, usage))


def _variable(variable, names):
    name = member(_VARIABLES, variable)
    if name not in names:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(variable)} is none of its variables")
    return name


@entry("CombinerInput")
def combiner_input(gl, stage, portion, variable, register, mapping, usage):
    """Set variable A, B, C or D of a general combiner's portion."""
    _set_portion(gl, stage, portion, **{_variable(variable, "abcd"): _input(register, mapping, usage)})


@entry("CombinerOutput")
def combiner_output(gl, stage, portion, *outputs):
    """Set the outputs of a general combiner's portion: AB, CD, their sum, scale, bias, dot products, mux."""
    ab, cd, both, scale, bias, ab_dot, cd_dot, mux = outputs
    changes = {
        "ab_output": member(REGISTERS, ab),
        "cd_output": member(REGISTERS, cd),
        "sum_output": member(REGISTERS, both),
        "scale": member(SCALES, scale),
        "bias": member(BIASES, bias),
        "mux_sum": bool(mux),
    }
    if portion == tokens.RGB:
        changes |= {"ab_dot_product": bool(ab_dot), "cd_dot_product": bool(cd_dot)}
    elif ab_dot or cd_dot:
        raise GLError(tokens.INVALID_OPERATION, "an alpha portion has no dot products")
    _set_portion(gl, stage, portion, **changes)


@entry("FinalCombinerInput")
def final_combiner_input(gl, variable, register, mapping, usage):
    """Set one of the variables A to G of the final combiner."""
    given = {member(_VARIABLES, variable): _input(register, mapping, usage)}
    final = replace(gl.values["final combiner"], **given)
    _refuse_problems(RegisterCombiners(final=final))
    gl.values.set("final combiner", final)


# ------------------------------------------------------------------------------------- combiners' queries


def _token_of(table, value):
    return next(token for token, each in table.items() if each is value)


def _of_input(given, name):
    if name == tokens.COMBINER_INPUT_NV:
        return _token_of(REGISTERS, given.register)
    if name == tokens.COMBINER_MAPPING_NV:
        return _token_of(MAPPINGS, given.mapping)
    if name == tokens.COMBINER_COMPONENT_USAGE_NV:
        return _token_of(USAGES, given.usage)
    raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(name)} is no parameter of a combiner's input")


@entry("GetCombinerInputParameteriv", "GetCombinerInputParameterfv", compiled=False)
def get_combiner_input(gl, stage, portion, variable, name, *_recorded):
    """A parameter of a general combiner's variable."""
    general = gl.values[("general combiner", _stage_number(stage))]
    return _of_input(getattr(getattr(general, member(_PORTIONS, portion)), _variable(variable, "abcd")), name)


@entry("GetFinalCombinerInputParameteriv", "GetFinalCombinerInputParameterfv", compiled=False)
def get_final_combiner_input(gl, variable, name, *_recorded):
    """A parameter of a final combiner's variable."""
    return _of_input(getattr(gl.values["final combiner"], member(_VARIABLES, variable)), name)


_OUTPUTS = {
    tokens.COMBINER_AB_OUTPUT_NV: ("ab_output", REGISTERS),
    tokens.COMBINER_CD_OUTPUT_NV: ("cd_output", REGISTERS),
    tokens.COMBINER_SUM_OUTPUT_NV: ("sum_output", REGISTERS),
    tokens.COMBINER_SCALE_NV: ("scale", SCALES),
    tokens.COMBINER_BIAS_NV: ("bias", BIASES),
    tokens.COMBINER_AB_DOT_PRODUCT_NV: ("ab_dot_product", None),
    tokens.COMBINER_CD_DOT_PRODUCT_NV: ("cd_dot_product", None),
    tokens.COMBINER_MUX_SUM_NV: ("mux_sum", None),
}


@entry("GetCombinerOutputParameteriv", "GetCombinerOutputParameterfv", compiled=False)
def get_combiner_output(gl, stage, portion, name, *_recorded):
    """A parameter of a general combiner's outputs."""
    general = gl.values[("general combiner", _stage_number(stage))]
    field, table = member(_OUTPUTS, name)
    value = getattr(getattr(general, member(_PORTIONS, portion)), field, False)
    return int(value) if table is None else _token_of(table, value)


@entry("GetCombinerStageParameterfv", compiled=False)
def get_combiner_stage(gl, stage, name, *_recorded):
    """A constant of a general combiner."""
    member(_CONSTANTS, name)
    return gl.values[("stage constants", _stage_number(stage))][tuple(_CONSTANTS).index(name)]


# ----------------------------------------------------------------------------------------- texture shaders

SHADER_OPERATIONS = {tokens.NONE: TextureShaderOperation.NONE} | {
    getattr(tokens, name): each
    for each in TextureShaderOperation
    for name in (each.name, each.name + "_NV")
    if hasattr(tokens, name) and each is not TextureShaderOperation.NONE
}
CULL_MODES = {tokens.GEQUAL: CullMode.GEQUAL, tokens.LESS: CullMode.LESS}
DOT_PRODUCT_MAPPINGS = {
    tokens.UNSIGNED_IDENTITY_NV: DotProductMapping.UNSIGNED_IDENTITY,
    tokens.EXPAND_NORMAL_NV: DotProductMapping.EXPAND_NORMAL,
}

capability(tokens.TEXTURE_SHADER_NV, _TEXTURE)
# Each unit has a TextureShaderStage, which TexEnv(TEXTURE_SHADER_NV, ...) changes.
for _unit in range(COORDINATE_SETS):
    declare(("texture shader", _unit), TextureShaderStage(), _TEXTURE)


@section(
    "texture_shader",
    ("enabled", tokens.TEXTURE_SHADER_NV),
    "texture_units",
    *[("texture shader", unit) for unit in range(SHADER_STAGES)],
)
def _texture_shader(gl, enabled, units, *stages):
    if not enabled:
        return None
    # NV_texture_shader: a stage whose texture is incomplete acts like the operation NONE. So does one that is
    # inconsistent with the others.
    made = [stage if unit else TextureShaderStage() for unit, stage in zip(units, stages, strict=False)]
    while wrong := [number for number, _ in texture_shader_problems(made)]:
        for number in wrong:
            made[number] = TextureShaderStage()
    return tuple(made)


def set_texture_shader(gl, unit: int, name: int, given: Parameter) -> None:
    """Carry out TexEnv(TEXTURE_SHADER_NV, name, given) for a unit."""
    key = "texture shader", unit
    gl.values.set(key, replace(gl.values[key], **_shader_change(name, given)))


def _shader_change(name, given):
    if name == tokens.SHADER_OPERATION_NV:
        if given.token() not in SHADER_OPERATIONS:
            if "TEXTURE" in tokens.name_of(given.token()) or "DOT_PRODUCT" in tokens.name_of(given.token()):
                raise Refused(f"{tokens.name_of(given.token())}: no machine here has NV_texture_shader3")
            raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(given.token())} is no shader operation")
        return {"operation": SHADER_OPERATIONS[given.token()]}
    if name == tokens.PREVIOUS_TEXTURE_INPUT_NV:
        unit = given.token() - tokens.TEXTURE0
        if not 0 <= unit < SHADER_STAGES - 1:
            raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(given.token())} is no earlier unit")
        return {"previous_texture_input": unit}
    if name == tokens.CULL_MODES_NV:
        return {"cull_modes": tuple([member(CULL_MODES, int(mode)) for mode in given.vector_of(4)])}
    if name == tokens.OFFSET_TEXTURE_MATRIX_NV:
        return {"offset_texture_matrix": given.vector_of(4)}
    if name == tokens.OFFSET_TEXTURE_SCALE_NV:
        return {"offset_texture_scale": given.number()}
    if name == tokens.OFFSET_TEXTURE_BIAS_NV:
        return {"offset_texture_bias": given.number()}
    if name == tokens.RGBA_UNSIGNED_DOT_PRODUCT_MAPPING_NV:
        return {"dot_product_mapping": member(DOT_PRODUCT_MAPPINGS, given.token())}
    if name == tokens.CONST_EYE_NV:
        return {"constant_eye": given.vector_of(3)}
    raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(name)} is no parameter of a texture shader")


def texture_shader_parameter(gl, unit: int, name: int):
    """The result of GetTexEnv(TEXTURE_SHADER_NV, name) for a unit: a number, a token, or several."""
    stage = gl.values[("texture shader", unit)]
    tables = {
        tokens.SHADER_OPERATION_NV: lambda: _token_of(SHADER_OPERATIONS, stage.operation),
        tokens.PREVIOUS_TEXTURE_INPUT_NV: lambda: tokens.TEXTURE0 + stage.previous_texture_input,
        tokens.CULL_MODES_NV: lambda: tuple([_token_of(CULL_MODES, mode) for mode in stage.cull_modes]),
        tokens.OFFSET_TEXTURE_MATRIX_NV: lambda: stage.offset_texture_matrix,
        tokens.OFFSET_TEXTURE_SCALE_NV: lambda: stage.offset_texture_scale,
        tokens.OFFSET_TEXTURE_BIAS_NV: lambda: stage.offset_texture_bias,
        tokens.RGBA_UNSIGNED_DOT_PRODUCT_MAPPING_NV: lambda: _token_of(
            DOT_PRODUCT_MAPPINGS, stage.dot_product_mapping
        ),
        tokens.CONST_EYE_NV: lambda: stage.constant_eye,
        # Assumed: every stage is consistent. A machine refuses a stage that is not.
        tokens.SHADER_CONSISTENT_NV: lambda: True,
    }
    return member(tables, name)()


# --------------------------------------------------------------------------------- depth clamping and hints

capability(tokens.DEPTH_CLAMP_NV, tokens.TRANSFORM_BIT)


@section("depth_clamp", ("enabled", tokens.DEPTH_CLAMP_NV), "depth_range")
def _depth_clamp(gl, enabled, depth_range):
    # NV_depth_clamp: depths are clamped to the depth range. The state has the range's ends in depth units.
    if not enabled:
        return None
    largest = (1 << gl.profile.widest_depth) - 1
    low, high = sorted(depth_range)
    return DepthClamp(minimum=low * largest, maximum=None if high == 1.0 else high * largest)


HINTS = (
    tokens.PERSPECTIVE_CORRECTION_HINT,
    tokens.POINT_SMOOTH_HINT,
    tokens.LINE_SMOOTH_HINT,
    tokens.POLYGON_SMOOTH_HINT,
    tokens.FOG_HINT,
    tokens.GENERATE_MIPMAP_HINT,
    tokens.TEXTURE_COMPRESSION_HINT,
    tokens.MULTISAMPLE_FILTER_HINT_NV,
)
for _hint in HINTS:
    declare(("hint", _hint), tokens.DONT_CARE, tokens.HINT_BIT)


@section("perspective_correction", ("hint", tokens.PERSPECTIVE_CORRECTION_HINT))
def _perspective_correction(gl, hint):
    return not (hint == tokens.FASTEST and gl.profile.primitives.perspective_hint)


@entry("Hint")
def hint(gl, target, mode):
    """Set a hint (section 5.6). A machine may follow PERSPECTIVE_CORRECTION_HINT, and follows no other."""
    if mode not in (tokens.DONT_CARE, tokens.FASTEST, tokens.NICEST) or target not in HINTS:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(target)}, {tokens.name_of(mode)}")
    gl.values.set(("hint", target), mode)
    if target != tokens.PERSPECTIVE_CORRECTION_HINT:
        gl.tally.add("no effect", gl.called)
