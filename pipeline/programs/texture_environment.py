"""Texture environments (section 3.8.9): the combiner program that computes them, and their errors.

Where register combiners are disabled, each enabled texture unit combines its texel with the colour that
reaches it. ``environment_program`` writes the units of a pass as one ``RegisterCombiners``, which every
engine runs like any other program. The driver makes such a program. So it may have more stages than the
machine offers, constants of each stage, and blue to alpha. docs/decisions/0008-texture-environments.md says
why; docs/numbers.md, "Texture environments", has the results.

Every result is read through an unsigned mapping, which turns negative values into zero, and a result is at
most one. So each unit's result is clamped to [0, 1], as the tables require, without a stage for it.
"""

from dataclasses import replace
from functools import lru_cache
from itertools import zip_longest
from typing import NamedTuple

from fixedpipe.pipeline.enums import (
    BaseFormat,
    CombineFunction,
    CombineOperand,
    CombinerBias,
    CombinerScale,
    CombineSource,
    ComponentUsage,
    InternalFormat,
    Mapping,
    Register,
    TextureEnvironmentMode,
    TextureShaderOperation,
)
from fixedpipe.pipeline.messages import listed
from fixedpipe.pipeline.state import (
    AlphaPortion,
    CombinerInput,
    FinalCombiner,
    GeneralCombiner,
    RegisterCombiners,
    RGBPortion,
)
from fixedpipe.pipeline.textures.images import (
    BASE_FORMAT,
    COLORLESS_FORMATS,
    DEPTH_TEXELS,
    depth_texture_mode,
)

# Source: NV_texture_shader section 3.8.9: the units of these stages pass their colour on.
_WITHOUT_FUNCTION = frozenset(
    {
        TextureShaderOperation.CULL_FRAGMENT,
        TextureShaderOperation.DOT_PRODUCT,
        TextureShaderOperation.DOT_PRODUCT_DEPTH_REPLACE,
    }
)
_COMBINES = (TextureEnvironmentMode.COMBINE, TextureEnvironmentMode.COMBINE4)
_DOT_PRODUCTS = (CombineFunction.DOT3_RGB, CombineFunction.DOT3_RGBA)
_OPAQUE = (BaseFormat.LUMINANCE, BaseFormat.RGB)
_NUMBERED = (
    CombineSource.TEXTURE0,
    CombineSource.TEXTURE1,
    CombineSource.TEXTURE2,
    CombineSource.TEXTURE3,
)
_INVERTED = (CombineOperand.ONE_MINUS_SRC_COLOR, CombineOperand.ONE_MINUS_SRC_ALPHA)
_OF_ALPHA = (CombineOperand.SRC_ALPHA, CombineOperand.ONE_MINUS_SRC_ALPHA)
_SCALES = {
    1.0: CombinerScale.NONE,
    2.0: CombinerScale.SCALE_BY_TWO,
    4.0: CombinerScale.SCALE_BY_FOUR,
}
_HALF = CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF


def texture_format(unit, internal_format, profile):
    """The BaseFormat by which a unit's environment treats a texture of this format.

    None: the unit passes its colour on. Source: OpenGL 1.2.1 table 3.16; ARB_depth_texture; NV_texture_shader
    section 3.8.9 (HILO, DSDT). Inferred: RGB for YCBCR, which has no alpha. Assumed: RGBA for the NV2A's own
    formats.
    """
    if internal_format in COLORLESS_FORMATS:
        return None
    if internal_format in DEPTH_TEXELS:
        base = depth_texture_mode(unit.sampler, profile)
    else:
        base = BaseFormat.RGB if internal_format == InternalFormat.YCBCR else BASE_FORMAT[internal_format]
    if unit.color_table is None:
        return base
    # Source: SGI_texture_color_table (issue 3: RGBA tables make RGBA of LUMINANCE); Assumed: the result has
    # every component that either format has.
    made = unit.color_table.base_format
    if made is base and base in (BaseFormat.ALPHA, BaseFormat.INTENSITY):
        return base
    return BaseFormat.RGB if base in _OPAQUE and made in _OPAQUE else BaseFormat.RGBA


def arguments(mode, function):
    """The number of arguments of a COMBINE or COMBINE4 function."""
    if mode == TextureEnvironmentMode.COMBINE4:
        return 4
    return {CombineFunction.REPLACE: 1, CombineFunction.INTERPOLATE: 3}.get(function, 2)


class _Unit(NamedTuple):
    """An enabled unit's environment. A ``base`` of None means that the unit passes its colour on."""

    number: int
    environment: object
    base: BaseFormat | None


def _units(state, textures, profile):
    """The _Unit of every unit that has a texel, in order."""
    units, stages = [], state.texture_shader
    for i, unit in enumerate(state.texture_units):
        operation = None
        if stages is not None:
            operation = stages[i].operation if i < len(stages) else TextureShaderOperation.NONE
        if unit is None or operation is TextureShaderOperation.NONE:
            continue
        base = BaseFormat.RGBA
        if operation in _WITHOUT_FUNCTION:
            base = None
        elif operation is not TextureShaderOperation.PASS_THROUGH:
            base = texture_format(unit, textures[unit.texture].internal_format, profile)
        units.append(_Unit(i, unit.environment, base))
    return tuple(units)


def environment_program(state, textures, profile, color_sum=False):
    """The RegisterCombiners that compute a pass without register combiners, or None: no unit has an effect.

    - ``textures``: {name: Texture}; the ``internal_format`` of those that enabled units read matters.
    - ``color_sum``: whether the secondary colour is added.

    The final combiner applies fog, enabled or not. Passes that compute the same share one object.
    """
    units = _units(state, textures, profile)
    if not units:
        return None
    ones = disabled_textures_are_ones(profile)
    return _program(units, ones, profile.arithmetic.add_signed_scale_by_four, color_sum)


def disabled_textures_are_ones(profile):
    """Whether an environment that names a disabled unit reads ones; else that environment is disabled itself.

    Source: NV_texture_env_combine4 (a disabled unit's texture is one); ARB_texture_env_crossbar (a unit that
    names a disabled one is disabled itself).
    """
    return TextureEnvironmentMode.COMBINE4 in profile.combiners.texture_environment_modes


@lru_cache(maxsize=256)
def _program(units, ones, by_four, color_sum):
    compiler = _Compiler(units, by_four)
    for unit in units:
        environment = unit.environment
        if unit.base is None or environment.mode == TextureEnvironmentMode.NONE:
            continue
        if not ones and any(n not in compiler.enabled for n in textures_named(environment)):
            continue
        compiler.compile(unit)
    if not compiler.stages:
        return None
    shown = Register.SPARE0_PLUS_SECONDARY_COLOR if color_sum else Register.SPARE0
    return RegisterCombiners(tuple(compiler.stages), FinalCombiner(b=CombinerInput(shown)))


def textures_named(environment):
    """Numbers of the units that an environment's functions read by number."""
    named = set()
    for half in _halves(environment):
        named |= set(half.sources[: arguments(environment.mode, half.function)])
    return [_NUMBERED.index(source) for source in named if source in _NUMBERED]


def _halves(environment):
    """The Combines that the environment uses."""
    if environment.mode not in _COMBINES:
        return ()
    if environment.rgb.function is CombineFunction.DOT3_RGBA:
        return (environment.rgb,)
    return environment.rgb, environment.alpha


# ------------------------------------------------------------------------------------------ the compiler


def _inverted(given):
    """One minus an input that an unsigned mapping reads."""
    flipped = {
        Mapping.UNSIGNED_IDENTITY: Mapping.UNSIGNED_INVERT,
        Mapping.UNSIGNED_INVERT: Mapping.UNSIGNED_IDENTITY,
    }[given.mapping]
    return replace(given, mapping=flipped)


_ZERO = CombinerInput()
_ONE = _inverted(_ZERO)
_MINUS_ONE = CombinerInput(Register.CONSTANT_COLOR1, Mapping.SIGNED_NEGATE)
_WHITE = (1.0, 1.0, 1.0, 1.0)


class _Sum(NamedTuple):
    """The result of a half: A B + C D, biased and scaled."""

    a: CombinerInput
    b: CombinerInput = _ONE
    c: CombinerInput = _ZERO
    d: CombinerInput = _ZERO
    bias: CombinerBias = CombinerBias.NONE
    scale: float = 1.0


class _Compiler:
    """The stages of a program, unit after unit. SPARE0 holds the colour that reaches the next unit."""

    def __init__(self, units, by_four):
        self.enabled = {unit.number: unit for unit in units}
        self.by_four = by_four
        self.stages = []
        self.previous = Register.PRIMARY_COLOR

    def compile(self, unit):
        self.unit, self.color = unit, unit.environment.color
        if unit.environment.mode in _COMBINES:
            self.combine(unit.environment)
        else:
            rgb, alpha = self.conventional(unit.environment.mode, unit.base)
            self.finish(_portions(RGBPortion, rgb), _portions(AlphaPortion, alpha))
        self.previous = Register.SPARE0

    def stage(self, rgb, alpha):
        """Append a general combiner; a portion of None writes nothing."""
        self.stages.append(
            GeneralCombiner(
                rgb or RGBPortion(a=_ZERO, sum_output=Register.DISCARD),
                alpha or AlphaPortion(sum_output=Register.DISCARD),
                self.color,
                _WHITE,
            )
        )

    def finish(self, rgb, alpha):
        """Append the stages of two halves; each half is a list of consecutive portions."""
        for portions in zip_longest(rgb, alpha):
            self.stage(*portions)

    # -------------------------------------------------------------------------------- OpenGL 1.2.1's modes

    def conventional(self, mode, base):
        """The _Sums of tables 3.22 and 3.23, and of ARB_texture_env_add."""
        fragment = CombinerInput(self.previous)
        texture = CombinerInput(Register(Register.TEXTURE0 + self.unit.number))
        constant = CombinerInput(Register.CONSTANT_COLOR0)
        coverage = replace(texture, usage=ComponentUsage.ALPHA)
        if mode is TextureEnvironmentMode.DECAL:
            rgb = _Sum(texture)
            if base is not BaseFormat.RGB:
                rgb = _Sum(texture, coverage, fragment, _inverted(coverage))
            return rgb, _Sum(fragment)
        whole = {
            TextureEnvironmentMode.REPLACE: _Sum(texture),
            TextureEnvironmentMode.MODULATE: _Sum(fragment, texture),
            TextureEnvironmentMode.BLEND: _Sum(fragment, _inverted(texture), constant, texture),
            TextureEnvironmentMode.ADD: _Sum(fragment, _ONE, texture, _ONE),
        }[mode]
        rgb = _Sum(fragment) if base is BaseFormat.ALPHA else whole
        if base in _OPAQUE:
            return rgb, _Sum(fragment)
        if base is BaseFormat.INTENSITY or mode is TextureEnvironmentMode.REPLACE:
            return rgb, whole
        return rgb, _Sum(fragment, texture)

    # ------------------------------------------------------------------------------- COMBINE and COMBINE4

    def combine(self, environment):
        mode, rgb, alpha = environment.mode, environment.rgb, environment.alpha
        if rgb.function in _DOT_PRODUCTS:
            whole = rgb.function is CombineFunction.DOT3_RGBA
            color = [self.dot_product(rgb, whole), *_scaling(RGBPortion, rgb.scale)]
        else:
            whole, color = False, _portions(RGBPortion, self.sum_of(mode, rgb, False))
        if whole:  # the dot product's own stage also writes alpha
            coverage = [None, *_scaling(AlphaPortion, alpha.scale)]
        else:
            coverage = _portions(AlphaPortion, self.sum_of(mode, alpha, True))
        self.finish(color, coverage)

    def argument(self, source, operand, alpha):
        """The input for a source and operand. Source: NV_texture_env_combine4 tables 3.22 and 3.23."""
        number = self.unit.number if source is CombineSource.TEXTURE else None
        if source in _NUMBERED:
            number = _NUMBERED.index(source)
        of_alpha = alpha or operand in _OF_ALPHA
        if number is None:
            given = CombinerInput(
                {
                    CombineSource.CONSTANT: Register.CONSTANT_COLOR0,
                    CombineSource.PRIMARY_COLOR: Register.PRIMARY_COLOR,
                    CombineSource.PREVIOUS: self.previous,
                    CombineSource.ZERO: Register.ZERO,
                }[source]
            )
        elif number not in self.enabled or (of_alpha and self.enabled[number].base in _OPAQUE):
            given = _ONE
        else:
            given = CombinerInput(Register(Register.TEXTURE0 + number))
        if of_alpha:
            given = replace(given, usage=ComponentUsage.ALPHA)
        return _inverted(given) if operand in _INVERTED else given

    def sum_of(self, mode, half, alpha):
        """The _Sum of a function other than a dot product.

        Source: ARB_texture_env_combine table 3.20, NV_texture_env_combine4 table 3.21.
        """
        count = arguments(mode, half.function)
        a, b, c, d = (
            *(
                self.argument(source, operand, alpha)
                for source, operand in zip(half.sources[:count], half.operands[:count], strict=True)
            ),
            *(None,) * (4 - count),
        )
        bias, scale = CombinerBias.NONE, float(half.scale)
        if half.function is CombineFunction.ADD_SIGNED:
            bias = _HALF
            scale = 2.0 if scale == 4.0 and not self.by_four else scale
        if mode is TextureEnvironmentMode.COMBINE4:
            return _Sum(a, b, c, d, bias, scale)
        made = {
            CombineFunction.REPLACE: lambda: _Sum(a),
            CombineFunction.MODULATE: lambda: _Sum(a, b),
            CombineFunction.ADD: lambda: _Sum(a, _ONE, b, _ONE),
            CombineFunction.ADD_SIGNED: lambda: _Sum(a, _ONE, b, _ONE),
            CombineFunction.INTERPOLATE: lambda: _Sum(a, c, b, _inverted(c)),
            CombineFunction.SUBTRACT: lambda: _Sum(a, _ONE, b, _MINUS_ONE),
        }[half.function]()
        return made._replace(bias=bias, scale=scale)

    def dot_product(self, half, whole):
        """The portion of a dot product before its scale; ``whole`` says that it also writes alpha.

        A stage before it computes an argument that is one minus a byte, because EXPAND_NEGATE of the byte
        would be another number.
        """
        inputs = [
            self.argument(source, operand, False)
            for source, operand in zip(half.sources[:2], half.operands[:2], strict=True)
        ]
        if any(given.mapping is Mapping.UNSIGNED_INVERT for given in inputs):
            first, second = inputs
            outputs = Register.SPARE0, Register.SPARE1  # keeps their alphas
            self.stage(RGBPortion(first, _ONE, second, _ONE, *outputs, Register.DISCARD), None)
            inputs = [CombinerInput(register) for register in outputs]
        a, b = (replace(given, mapping=Mapping.EXPAND_NORMAL) for given in inputs)
        return RGBPortion(
            a,
            b,
            ab_output=Register.SPARE0,
            sum_output=Register.DISCARD,
            ab_dot_product=True,
            ab_blue_to_alpha=whole,
        )


def _portion(kind, half):
    """A _Sum as a portion that writes SPARE0."""
    inputs = half[:4]
    if kind is AlphaPortion:
        inputs = (replace(given, usage=ComponentUsage.ALPHA) for given in inputs)
    return kind(*inputs, scale=_SCALES[half.scale], bias=half.bias)


def _scaling(kind, scale):
    """The portions that scale SPARE0."""
    scale = float(scale)
    return [] if scale == 1.0 else [_portion(kind, _Sum(CombinerInput(Register.SPARE0), scale=scale))]


def _portions(kind, half):
    """The portions of a _Sum. A biased sum is scaled by two at most, so a scale of four doubles it twice.

    Source: NV_register_combiners, Errors.
    """
    if half.bias is _HALF and half.scale == 4.0:
        return [_portion(kind, half._replace(scale=2.0)), *_scaling(kind, 2.0)]
    return [_portion(kind, half)]


# --------------------------------------------------------------------------------------- what is refused


def environment_problem(number, environment, base, profile):
    """A sentence that says what is wrong with texture unit ``number``'s environment, or None.

    ``base`` is the ``texture_format`` of the unit's texture. It is RGBA where a texture shader makes a
    colour, and None where the environment has no effect.

    Source: the errors of ARB_texture_env_combine, _dot3 and NV_texture_env_combine4.
    """
    mode, modes, name = environment.mode, profile.combiners.texture_environment_modes, profile.name
    if not modes:
        return (
            f"texture unit {number} is enabled without register combiners, and {name} has no texture "
            "environments. Set register_combiners."
        )
    if mode not in modes:
        return (
            f"texture unit {number}'s environment is {mode.name}; {name} has {listed(modes)}. Give one of "
            "these."
        )
    if mode is TextureEnvironmentMode.DECAL and base not in (BaseFormat.RGB, BaseFormat.RGBA, None):
        return (
            f"texture unit {number}'s environment is DECAL, which is undefined for {base.name} textures "
            "(OpenGL 1.2.1, table 3.23). Give it an RGB or RGBA texture, or choose another mode."
        )
    if mode not in _COMBINES:
        return None
    for half in ("rgb", "alpha"):
        if problem := _combine_problem(mode, half, getattr(environment, half), profile):
            return f"texture unit {number}'s {mode.name} environment {problem}"
    return None


def _combine_problem(mode, name, half, profile):
    """The predicate of a sentence on what is wrong with one half, or None."""
    functions = profile.combiners.combine_functions
    if mode is TextureEnvironmentMode.COMBINE4:
        functions = functions & {CombineFunction.ADD, CombineFunction.ADD_SIGNED}
    if name == "alpha" and half.function in _DOT_PRODUCTS:
        return f"has {half.function.name} in alpha; a dot product is an rgb function, DOT3_RGBA for all four."
    if half.function not in functions:
        takes = f"a {mode.name} environment of {profile.name} takes {listed(functions)}"
        return f"has {half.function.name} in {name}; {takes}."
    if half.scale not in _SCALES:
        return f"scales {name} by {half.scale:g}; a scale is 1, 2 or 4."
    count = arguments(mode, half.function)
    for what, given in (("sources", half.sources), ("operands", half.operands)):
        if len(given) < count:
            return (
                f"has {len(given)} {what} in {name}; {half.function.name} takes {count} there. Name each of "
                "them."
            )
    combine4 = TextureEnvironmentMode.COMBINE4 in profile.combiners.texture_environment_modes
    for source in half.sources:
        if source is CombineSource.ZERO and not combine4:
            return f"reads ZERO in {name}, a source of COMBINE4, which {profile.name} lacks. Use CONSTANT."
        if source in _NUMBERED:
            if not (combine4 or profile.combiners.texture_environment_crossbar):
                return (
                    f"reads {source.name} in {name}; on {profile.name} a unit reads its own texture alone. "
                    "Use TEXTURE."
                )
            if _NUMBERED.index(source) >= profile.textures.max_texture_units:
                return (
                    f"reads {source.name} in {name}; {profile.name} has "
                    f"{profile.textures.max_texture_units} texture "
                    "units. Name one of them."
                )
    if name == "alpha" and any(operand not in _OF_ALPHA for operand in half.operands):
        return "has an operand of color in alpha; take SRC_ALPHA or ONE_MINUS_SRC_ALPHA there."
    # Source: ARB_texture_env_combine, issue 7 (the operands that EXT_texture_env_combine lacks).
    third = half.operands[2:3] if half.function is CombineFunction.INTERPOLATE else ()
    any_third = combine4 or CombineFunction.SUBTRACT in profile.combiners.combine_functions
    if third and third[0] is not CombineOperand.SRC_ALPHA and not any_third:
        return f"has {third[0].name} as the third operand in {name}; {profile.name} takes SRC_ALPHA there."
    return None
