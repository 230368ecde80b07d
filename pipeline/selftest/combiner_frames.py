"""Frames of register combiners, texture environments and texture shaders."""

from dataclasses import replace

from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.enums import (
    CombineFunction,
    CombineOperand,
    CombinerBias,
    CombinerScale,
    CombineSource,
    ComponentUsage,
    CullMode,
    DotProductMapping,
    Mapping,
    MuxSelect,
    Register,
    TexelWord,
    TextureEnvironmentMode,
    TextureFilter,
    TextureShaderOperation,
    WrapMode,
)
from fixedpipe.pipeline.profiles import GEFORCE_3, GEFORCE_256, MULTITEXTURE, NV2A
from fixedpipe.pipeline.selftest.frame import Frame, background, patched, stores
from fixedpipe.pipeline.selftest.shapes import picture, values
from fixedpipe.pipeline.state import (
    AlphaPortion,
    Combine,
    CombinerInput,
    DepthTest,
    FinalCombiner,
    GeneralCombiner,
    PassState,
    RegisterCombiners,
    RGBPortion,
    Sampler,
    TextureEnvironment,
    TextureShaderStage,
    TextureUnit,
)
from fixedpipe.pipeline.textures.images import texture_2d, texture_3d, texture_cube_map
from fixedpipe.pipeline.textures.words import texture_of_words

_EDGE = {"wrap_s": WrapMode.CLAMP_TO_EDGE, "wrap_t": WrapMode.CLAMP_TO_EDGE}
_LINEAR = Sampler(TextureFilter.LINEAR, TextureFilter.LINEAR, **_EDGE)
_NEAREST = Sampler(TextureFilter.NEAREST, TextureFilter.NEAREST)
_FIRST = TextureUnit("first", _LINEAR)
_SECOND = TextureUnit("second", _NEAREST, coordinates=2)
_FLAT = {"first": texture_2d(picture(8, 8)), "second": texture_2d(picture(4, 16, seed=1))}
_ALPHA, _BLUE = ComponentUsage.ALPHA, ComponentUsage.BLUE


def _read(register, mapping=Mapping.UNSIGNED_IDENTITY, usage=ComponentUsage.RGB):
    return CombinerInput(register, mapping, usage)


_HALF = _read(Register.CONSTANT_COLOR0)
_TEXEL, _OTHER = _read(Register.TEXTURE0), _read(Register.TEXTURE1)
_VECTOR = _read(Register.TEXTURE0, Mapping.EXPAND_NORMAL)
_SIGNED = _read(Register.SPARE0, Mapping.SIGNED_IDENTITY)
_COLOR = _read(Register.PRIMARY_COLOR)
_ONE = _read(Register.ZERO, Mapping.UNSIGNED_INVERT)


def _programs():
    """Programs of one or two general combiners and a final one, each about one subject."""
    by_four = RGBPortion(_TEXEL, _COLOR, _OTHER, _HALF, scale=CombinerScale.SCALE_BY_FOUR)
    dots = RGBPortion(
        _VECTOR,
        _read(Register.PRIMARY_COLOR, Mapping.EXPAND_NORMAL),
        _read(Register.TEXTURE1, Mapping.HALF_BIAS_NORMAL),
        _read(Register.TEXTURE0, Mapping.EXPAND_NEGATE),
        Register.SPARE0,
        Register.SPARE1,
        Register.DISCARD,
        ab_dot_product=True,
        cd_dot_product=True,
    )
    squared = RGBPortion(
        _SIGNED,
        _SIGNED,
        _read(Register.SPARE1, Mapping.SIGNED_NEGATE),
        _read(Register.PRIMARY_COLOR, usage=_ALPHA),
        bias=CombinerBias.NONE,
        scale=CombinerScale.SCALE_BY_TWO,
    )
    biased = RGBPortion(
        _read(Register.TEXTURE1, Mapping.HALF_BIAS_NEGATE),
        _COLOR,
        _TEXEL,
        _read(Register.SECONDARY_COLOR),
        scale=CombinerScale.SCALE_BY_TWO,
        bias=CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF,
    )
    muxed = RGBPortion(_TEXEL, _ONE, _OTHER, _COLOR, mux_sum=True)
    alpha = AlphaPortion(
        _read(Register.TEXTURE0, usage=_ALPHA),
        _read(Register.PRIMARY_COLOR, Mapping.EXPAND_NORMAL, _BLUE),
        _read(Register.TEXTURE1, Mapping.UNSIGNED_INVERT, _ALPHA),
        _read(Register.CONSTANT_COLOR1, usage=_ALPHA),
        scale=CombinerScale.SCALE_BY_ONE_HALF,
    )
    shown = FinalCombiner(
        _read(Register.TEXTURE1),
        _read(Register.SPARE0),
        _read(Register.SECONDARY_COLOR),
        _read(Register.E_TIMES_F),
        _read(Register.SPARE0, Mapping.UNSIGNED_INVERT),
        _TEXEL,
        _read(Register.SPARE0, usage=_ALPHA),
    )
    plain = GeneralCombiner()
    yield RegisterCombiners((GeneralCombiner(by_four, alpha),))
    yield RegisterCombiners((GeneralCombiner(dots), GeneralCombiner(squared, alpha)), shown)
    yield RegisterCombiners((GeneralCombiner(biased, alpha), GeneralCombiner(squared)))
    yield RegisterCombiners((GeneralCombiner(by_four, alpha), GeneralCombiner(muxed)), shown)
    yield RegisterCombiners((GeneralCombiner(dots), plain), color_sum_clamp=False)
    yield RegisterCombiners((plain, GeneralCombiner(replace(biased, ab_output=Register.SPARE1))), shown)
    yield RegisterCombiners((GeneralCombiner(muxed, alpha),), color_sum_clamp=False)
    yield RegisterCombiners((GeneralCombiner(squared, alpha), GeneralCombiner(dots)), shown)


_CONSTANTS = {"constant_color0": (0.5, 0.25, 0.75, 0.4), "constant_color1": (0.1, 0.9, 0.3, 0.6)}


def _combined(programs):
    units = _FIRST, _SECOND
    return patched(PassState(texture_units=units, register_combiners=program) for program in programs)


def _long_programs():
    """Programs of eight general combiners each, with constants of their own where the machine has them."""
    for number, program in enumerate(_programs()):
        general = (program.general * 8)[:8]
        constants = [(k / 8.0, 1.0 - k / 9.0, 0.3, k / 7.0) for k in range(8)]
        yield replace(
            program,
            general=tuple(
                replace(one, constant_color0=constant, constant_color1=constant[::-1])
                for one, constant in zip(general, constants, strict=True)
            ),
            mux_select=MuxSelect.LSB if number % 2 else MuxSelect.MSB,
            invert_spare0=number % 3 == 0,
            invert_secondary_color=number % 3 == 1,
        )


def _environments():
    """The units' environments: the functions of OpenGL 1.2.1, and COMBINE's."""
    modes, functions = TextureEnvironmentMode, CombineFunction
    operands = (
        CombineOperand.ONE_MINUS_SRC_COLOR,
        CombineOperand.SRC_COLOR,
        CombineOperand.SRC_ALPHA,
    )
    alphas = (CombineOperand.SRC_ALPHA, CombineOperand.ONE_MINUS_SRC_ALPHA, CombineOperand.SRC_ALPHA)
    sources = CombineSource.TEXTURE, CombineSource.PREVIOUS, CombineSource.PRIMARY_COLOR
    constant = (0.3, 0.8, 0.1, 0.6)
    simple = [TextureEnvironment(mode, constant) for mode in (modes.DECAL, modes.BLEND, modes.ADD)]
    combining = [
        TextureEnvironment(
            modes.COMBINE,
            constant,
            Combine(function, sources, operands, scale),
            Combine(functions.ADD_SIGNED, sources, alphas, 2.0),
        )
        for function, scale in (
            (functions.ADD_SIGNED, 2.0),
            (functions.INTERPOLATE, 1.0),
            (functions.ADD, 4.0),
            (functions.DOT3_RGB, 1.0),
            (functions.DOT3_RGBA, 1.0),
        )
    ]
    return zip(simple + combining, [*combining, *simple], strict=True)


def _environment_states(second_has_dots):
    for first, second in _environments():
        dots = CombineFunction.DOT3_RGB, CombineFunction.DOT3_RGBA
        if not second_has_dots:
            first, second = (
                TextureEnvironment(TextureEnvironmentMode.BLEND, (0.9, 0.5, 0.2, 0.1))
                if e.mode == TextureEnvironmentMode.COMBINE and e.rgb.function in dots
                else e
                for e in (first, second)
            )
        units = replace(_FIRST, environment=first), replace(_SECOND, environment=second)
        yield PassState(texture_units=units, color_sum=True)


def _shaders(operations):
    """A state for each operation, whose stage follows the stages that it needs; ``last`` is its texture."""
    for operation, before, last in operations:
        kinds = (*before, operation)
        stages = tuple(
            TextureShaderStage(
                kind,
                offset_texture_matrix=(0.4, -0.3, 0.2, 0.5),
                offset_texture_scale=0.7,
                offset_texture_bias=0.2,
                dot_product_mapping=DotProductMapping.EXPAND_NORMAL,
                cull_modes=(CullMode.GEQUAL, CullMode.LESS, CullMode.GEQUAL, CullMode.GEQUAL),
                constant_eye=(0.3, -0.2, 0.8),
            )
            for kind in kinds
        )
        units = [replace(_FIRST, coordinates=k % 4) for k in range(len(kinds))]
        units[-1] = replace(units[-1], texture=last)
        yield PassState(
            texture_units=tuple(units),
            texture_shader=stages,
            register_combiners=_shader_shown(len(kinds) - 1),
            depth_test=DepthTest(),
        )


def _shader_shown(stage):
    """Combiners that show the last stage's texel, with a little of the first one's."""
    texel = Register(Register.TEXTURE0 + stage)
    mixed = RGBPortion(_read(texel), _ONE, _TEXEL, _read(Register.ZERO, Mapping.HALF_BIAS_NEGATE))
    return RegisterCombiners(
        (GeneralCombiner(mixed),),
        FinalCombiner(_COLOR, _read(Register.SPARE0), _read(texel), g=_read(texel, usage=_ALPHA)),
    )


_OP = TextureShaderOperation
_SHADER_OPERATIONS = (
    (_OP.OFFSET_TEXTURE_2D, (_OP.TEXTURE_2D,), "second"),
    (_OP.OFFSET_TEXTURE_2D_SCALE, (_OP.TEXTURE_2D,), "second"),
    (_OP.DEPENDENT_AR_TEXTURE_2D, (_OP.TEXTURE_2D,), "second"),
    (_OP.DEPENDENT_GB_TEXTURE_2D, (_OP.TEXTURE_2D,), "second"),
    (_OP.DOT_PRODUCT_TEXTURE_2D, (_OP.TEXTURE_2D, _OP.DOT_PRODUCT), "second"),
    (_OP.DOT_PRODUCT_REFLECT_CUBE_MAP, (_OP.TEXTURE_2D, _OP.DOT_PRODUCT, _OP.DOT_PRODUCT), "cube"),
    (_OP.DOT_PRODUCT_CONST_EYE_REFLECT_CUBE_MAP, (_OP.TEXTURE_2D, _OP.DOT_PRODUCT, _OP.DOT_PRODUCT), "cube"),
    (_OP.CULL_FRAGMENT, (_OP.PASS_THROUGH,), None),
)
_CHIP_OPERATIONS = (
    (_OP.DOT_PRODUCT_CONST_EYE_REFLECT_CUBE_MAP, (_OP.TEXTURE_2D, _OP.DOT_PRODUCT, _OP.DOT_PRODUCT), "cube"),
    (_OP.DOT_PRODUCT_TEXTURE_CUBE_MAP, (_OP.TEXTURE_2D, _OP.DOT_PRODUCT, _OP.DOT_PRODUCT), "cube"),
    (_OP.DOT_PRODUCT_TEXTURE_3D, (_OP.TEXTURE_2D, _OP.DOT_PRODUCT, _OP.DOT_PRODUCT), "volume"),
    (_OP.BRDF_TEXTURE_3D, (_OP.TEXTURE_2D, _OP.TEXTURE_2D), "volume"),
    (_OP.DOT_PRODUCT_DEPTH_REPLACE, (_OP.TEXTURE_2D, _OP.DOT_PRODUCT), None),
    (_OP.OFFSET_TEXTURE_2D, (_OP.TEXTURE_2D,), "second"),
    (_OP.DEPENDENT_GB_TEXTURE_2D, (_OP.TEXTURE_2D,), "second"),
    (_OP.TEXTURE_3D, (_OP.TEXTURE_2D,), "volume"),
)


def _words(draw, mapping):
    """The Draw with its dot products mapped in another way; its first texel holds words."""
    stages = tuple(replace(stage, dot_product_mapping=mapping) for stage in draw.state.texture_shader)
    units = (replace(draw.state.texture_units[0], texture="words"), *draw.state.texture_units[1:])
    return replace(draw, state=replace(draw.state, texture_shader=stages, texture_units=units))


def _chip_draws() -> tuple[Draw, ...]:
    """The NV2A's operations, and dot products of its words of sixteen bits and signed bytes."""
    mappings = (
        DotProductMapping.SIGNED_HILO_HEMISPHERE,
        DotProductMapping.UNSIGNED_HILO,
        DotProductMapping.SIGNED_IDENTITY,
        DotProductMapping.SIGNED_ODD,
    )
    draws = patched(_shaders(_CHIP_OPERATIONS))
    return draws + tuple(_words(*pair) for pair in zip(draws, mappings, strict=False))


_CUBE = texture_cube_map(picture(6, 8, 8, seed=2))
_VOLUME = texture_3d(picture(4, 8, 8, seed=3))
_HILO = texture_of_words(values(8, 8, seed=4, most=2**32 - 1), TexelWord.R16B16)

COMBINER_FRAMES = (
    Frame(
        name="register-combiners",
        profile=GEFORCE_256,
        commands=(
            *stores(**_FLAT),
            *background(),
            *_combined(replace(program, **_CONSTANTS) for program in _programs()),
        ),
    ),
    Frame(
        name="eight-combiners",
        profile=NV2A,
        commands=(*stores(**_FLAT), *background(), *_combined(_long_programs())),
    ),
    Frame(
        name="texture-environments",
        profile=GEFORCE_256,
        commands=(*stores(**_FLAT), *background(), *patched(_environment_states(True))),
    ),
    Frame(
        name="environments-of-a-multitexturing-board",
        profile=MULTITEXTURE,
        commands=(
            *stores(**_FLAT),
            *background(),
            *patched(replace(s, color_sum=False) for s in _environment_states(False)),
        ),
    ),
    Frame(
        name="texture-shaders",
        profile=GEFORCE_3,
        commands=(
            *stores(**_FLAT, cube=_CUBE),
            *background(),
            *patched(_shaders(_SHADER_OPERATIONS)),
        ),
    ),
    Frame(
        name="texture-shaders-of-the-chip",
        profile=NV2A,
        commands=(*stores(**_FLAT, cube=_CUBE, volume=_VOLUME, words=_HILO), *background(), *_chip_draws()),
    ),
)
