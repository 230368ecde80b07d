"""Texture environments, one fragment at a time, straight from their tables; nothing here knows of combiners.

Colors are four bytes, 255 = 1.0. Each unit's result is clamped to a byte before the next unit reads it.
"""

from functools import partial

from fixedpipe.pipeline.enums import (
    BaseFormat,
    CombineFunction,
    CombineOperand,
    CombineSource,
    InternalFormat,
    ProductRounding,
    TextureEnvironmentMode,
    TextureShaderOperation,
)
from tests.reference import fixed
from tests.reference.signed_formats import COLORLESS

ONE, HALF = 255, 128
WHITE = [ONE] * 4
_F = InternalFormat
_BASE_FORMATS = {
    BaseFormat.ALPHA: (_F.ALPHA4, _F.ALPHA8, _F.ALPHA12),
    BaseFormat.LUMINANCE: (_F.LUMINANCE4, _F.LUMINANCE8, _F.LUMINANCE12),
    BaseFormat.LUMINANCE_ALPHA: (
        _F.LUMINANCE4_ALPHA4,
        _F.LUMINANCE6_ALPHA2,
        _F.LUMINANCE8_ALPHA8,
        _F.LUMINANCE12_ALPHA4,
        _F.LUMINANCE12_ALPHA12,
    ),
    BaseFormat.INTENSITY: (_F.INTENSITY4, _F.INTENSITY8, _F.INTENSITY12),
    BaseFormat.RGB: (_F.R3_G3_B2, _F.RGB4, _F.RGB5, _F.R5_G6_B5, _F.RGB8, _F.RGB12, _F.YCBCR),
}
_DEPTHS = (
    _F.DEPTH_COMPONENT16,
    _F.DEPTH_COMPONENT24,
    _F.DEPTH_COMPONENT16_FLOAT,
    _F.DEPTH_COMPONENT24_FLOAT,
)
# Source: NV_texture_shader section 3.8.9: stages whose unit's function is NONE.
_WITHOUT_FUNCTION = (
    TextureShaderOperation.NONE,
    TextureShaderOperation.CULL_FRAGMENT,
    TextureShaderOperation.DOT_PRODUCT,
    TextureShaderOperation.DOT_PRODUCT_DEPTH_REPLACE,
)


def base_format(internal_format, sampler, profile):
    """The base format that a texture's environment goes by; None: its function is NONE.

    Source: OpenGL 1.2.1 table 3.16; ARB_depth_texture; NV_texture_shader section 3.8.9 (HILO, DSDT).
    Inferred: RGB for YCBCR, which has no alpha. Assumed: RGBA for the NV2A's own formats.
    """
    if internal_format in COLORLESS:
        return None
    if internal_format in _DEPTHS:
        return (
            profile.textures.depth_texture_modes[0]
            if sampler.depth_texture_mode is None
            else sampler.depth_texture_mode
        )
    for base, formats in _BASE_FORMATS.items():
        if internal_format in formats:
            return base
    return BaseFormat.RGBA


def looked_up(base, table):
    """The base format behind a texture color table. Source: SGI_texture_color_table; Assumed: a component
    that the texture or the table has is there.
    """
    parts = {
        BaseFormat.ALPHA: {"alpha"},
        BaseFormat.LUMINANCE: {"color"},
        BaseFormat.LUMINANCE_ALPHA: {"color", "alpha"},
        BaseFormat.INTENSITY: {"color", "alpha"},
        BaseFormat.RGB: {"color"},
        BaseFormat.RGBA: {"color", "alpha"},
    }
    if base is None or base == table == BaseFormat.INTENSITY:
        return base
    found = parts[base] | parts[table]
    if found == {"alpha"}:
        return BaseFormat.ALPHA
    return BaseFormat.RGBA if "alpha" in found else BaseFormat.RGB


def rounded(products, profile):
    """A sum of products over 255, rounded as the machine does it. Inferred: jointly, as combiners."""
    if profile.arithmetic.product_rounding == ProductRounding.PER_PRODUCT:
        return sum(fixed.divide(n) for n in products)
    return fixed.divide(sum(products))


def finished(products, half, scale, profile):
    """A function's result: less one half for ADD_SIGNED, times 1, 2 or 4, clamped.

    Source: ARB_texture_env_combine section 3.8.9; Inferred: the half of 128, the order of rounding and
    scaling, both as combiners have them. Source: NV_texture_env_combine4 (ADD_SIGNED takes 4 as 2 on some).
    """
    scale = int(scale)
    if half and scale == 4:
        if not profile.arithmetic.add_signed_scale_by_four:
            scale = 2
        else:  # Assumed: two times two
            return fixed.clamp(2 * _scaled(products, HALF, 2, profile), 0, ONE)
    return fixed.clamp(_scaled(products, HALF if half else 0, scale, profile), 0, ONE)


def _scaled(products, half, scale, profile):
    """Before the clamp. Inferred: as combiners have it; products rounded one by one are scaled after."""
    if (
        profile.arithmetic.round_before_scale
        or profile.arithmetic.product_rounding == ProductRounding.PER_PRODUCT
    ):
        return (rounded(products, profile) - half) * scale
    return fixed.divide(sum(products) * scale) - half * scale


def argument(texels, i, constant, primary, previous, source, operand, k):
    """Component k (0..2 red, green, blue; 3 alpha) of an argument of unit i's function.

    Source: NV_texture_env_combine4 tables 3.22 and 3.23 (a disabled unit's texture is one).
    """
    color = {
        CombineSource.TEXTURE: texels[i],
        CombineSource.CONSTANT: constant,
        CombineSource.PRIMARY_COLOR: primary,
        CombineSource.PREVIOUS: previous,
        CombineSource.ZERO: [0, 0, 0, 0],
    }.get(source)
    if color is None:
        color = texels[source - CombineSource.TEXTURE0] or WHITE
    alone = operand in (CombineOperand.SRC_ALPHA, CombineOperand.ONE_MINUS_SRC_ALPHA)
    component = color[3 if alone else k]
    inverted = operand in (CombineOperand.ONE_MINUS_SRC_COLOR, CombineOperand.ONE_MINUS_SRC_ALPHA)
    return ONE - component if inverted else component


def terms(function, arguments):
    """The products whose sum a function is. Source: ARB_texture_env_combine table 3.20."""
    a, b, c = (*arguments, 0, 0)[:3]
    return {
        CombineFunction.REPLACE: [a * ONE],
        CombineFunction.MODULATE: [a * b],
        CombineFunction.ADD: [a * ONE, b * ONE],
        CombineFunction.ADD_SIGNED: [a * ONE, b * ONE],
        CombineFunction.INTERPOLATE: [a * c, b * (ONE - c)],
        CombineFunction.SUBTRACT: [a * ONE, -b * ONE],
    }[function]


def number_of_arguments(mode, function):
    """Source: ARB_texture_env_combine table 3.20; NV_texture_env_combine4 table 3.21."""
    if mode == TextureEnvironmentMode.COMBINE4:
        return 4
    return {CombineFunction.REPLACE: 1, CombineFunction.INTERPOLATE: 3}.get(function, 2)


def combine_component(environment, combine, k, read, profile):
    """Component k of a COMBINE or COMBINE4 environment that is no dot product.

    Source: ARB_texture_env_combine table 3.20; NV_texture_env_combine4 table 3.21.
    """
    count = number_of_arguments(environment.mode, combine.function)
    arguments = [read(combine.sources[n], combine.operands[n], k) for n in range(count)]
    if environment.mode == TextureEnvironmentMode.COMBINE4:
        a, b, c, d = arguments
        products = [a * b, c * d]
    else:
        products = terms(combine.function, arguments)
    signed = combine.function == CombineFunction.ADD_SIGNED
    return finished(products, signed, combine.scale, profile)


def dot_product(combine, read, profile):
    """4 (Arg0 - 1/2) . (Arg1 - 1/2), rounded before any scale. Source: ARB_texture_env_dot3 table 3.20.

    Inferred: the half, as EXPAND_NORMAL's (128 where the machine has bytes).
    """
    one = int(2 * profile.arithmetic.expand_half)
    first, second = (
        [2 * read(source, operand, k) - one for k in range(3)]
        for source, operand in zip(combine.sources[:2], combine.operands[:2], strict=True)
    )
    return rounded([a * b for a, b in zip(first, second, strict=True)], profile)


def combined(environment, read, profile):
    """COMBINE and COMBINE4. Source: as their functions; ARB_texture_env_dot3: DOT3_RGBA ignores the alpha
    function, and each result takes its own scale.
    """
    rgb, alpha = environment.rgb, environment.alpha
    if rgb.function in (CombineFunction.DOT3_RGB, CombineFunction.DOT3_RGBA):
        dot = dot_product(rgb, read, profile)
        color = [fixed.clamp(dot * int(rgb.scale), 0, ONE)] * 3
        if rgb.function == CombineFunction.DOT3_RGBA:
            return [*color, fixed.clamp(dot * int(alpha.scale), 0, ONE)]
    else:
        color = [combine_component(environment, rgb, k, read, profile) for k in range(3)]
    return [*color, combine_component(environment, alpha, 3, read, profile)]


def lerp(a, b, weight, profile):
    """A (1 - weight) + b weight. Source: OpenGL 1.2.1 tables 3.22 and 3.23 (DECAL, BLEND)."""
    return fixed.clamp(rounded([a * (ONE - weight), b * weight], profile), 0, ONE)


def conventional(mode, base, constant, fragment, texel, profile):
    """REPLACE, MODULATE, DECAL, BLEND and ADD by the texture's base format.

    Source: OpenGL 1.2.1 tables 3.22 and 3.23; ARB_texture_env_add.
    """
    cf, af, ct, at = fragment[:3], fragment[3], texel[:3], texel[3]
    opaque = base in (BaseFormat.LUMINANCE, BaseFormat.RGB)
    product = fixed.divide(af * at)
    if mode == TextureEnvironmentMode.DECAL:
        if base == BaseFormat.RGB:
            return [*ct, af]
        return [*(lerp(f, t, at, profile) for f, t in zip(cf, ct, strict=True)), af]
    color = {
        TextureEnvironmentMode.REPLACE: lambda: ct,
        TextureEnvironmentMode.MODULATE: lambda: [fixed.divide(f * t) for f, t in zip(cf, ct, strict=True)],
        TextureEnvironmentMode.BLEND: lambda: [
            lerp(f, c, t, profile) for f, c, t in zip(cf, constant[:3], ct, strict=True)
        ],
        TextureEnvironmentMode.ADD: lambda: [min(ONE, f + t) for f, t in zip(cf, ct, strict=True)],
    }[mode]
    rgb = cf if base == BaseFormat.ALPHA else color()
    if opaque:
        return [*rgb, af]
    if mode == TextureEnvironmentMode.REPLACE:
        return [*rgb, at]
    if base == BaseFormat.INTENSITY and mode == TextureEnvironmentMode.BLEND:
        return [*rgb, lerp(af, constant[3], at, profile)]
    if base == BaseFormat.INTENSITY and mode == TextureEnvironmentMode.ADD:
        return [*rgb, min(ONE, af + at)]
    return [*rgb, product]


def texture_color(texel, base):
    """A filtered texel as environments read it: no signs, and the alpha of its base format.

    Source: ARB_texture_env_combine table 3.23; Assumed: a negative component counts as zero in every mode,
    as NV_texture_shader has it for COMBINE.
    """
    color = [max(0, component) for component in texel]
    return [*color[:3], ONE] if base in (BaseFormat.LUMINANCE, BaseFormat.RGB) else color


def used_textures(environment):
    """Numbers of the units whose textures a unit's functions name. Source: ARB_texture_env_crossbar."""
    if environment.mode not in (TextureEnvironmentMode.COMBINE, TextureEnvironmentMode.COMBINE4):
        return set()
    halves = [environment.rgb]
    if environment.rgb.function != CombineFunction.DOT3_RGBA:
        halves.append(environment.alpha)
    named = set()
    for half in halves:
        named |= set(half.sources[: number_of_arguments(environment.mode, half.function)])
    return {source - CombineSource.TEXTURE0 for source in named if source >= CombineSource.TEXTURE0}


def textured_color(primary, texels, state, textures, profile):
    """The fragment's color after every unit's environment, four bytes.

    texels    of every unit of the state, -256..255; of a disabled one anything
    textures  name to texture; of each the internal format matters

    A disabled unit passes its color on. So does, with ARB_texture_env_crossbar alone, a unit that names a
    disabled one. Source: OpenGL 1.2.1 section 3.8.10; ARB_multitexture; ARB_texture_env_crossbar.
    """
    formats, colors = [], []
    for i, unit in enumerate(state.texture_units):
        operation = None
        if state.texture_shader is not None:
            stages = state.texture_shader
            operation = stages[i].operation if i < len(stages) else TextureShaderOperation.NONE
        if unit is None or operation == TextureShaderOperation.NONE:
            formats.append(None)
            colors.append(None)
            continue
        if operation in _WITHOUT_FUNCTION:
            base = None
        elif operation == TextureShaderOperation.PASS_THROUGH:
            base = BaseFormat.RGBA
        else:
            base = base_format(textures[unit.texture].internal_format, unit.sampler, profile)
            base = base if unit.color_table is None else looked_up(base, unit.color_table.base_format)
        formats.append(base)
        colors.append(texture_color(texels[i], base))
    colors += [None] * (4 - len(colors))
    ones = TextureEnvironmentMode.COMBINE4 in profile.combiners.texture_environment_modes
    color = list(primary)
    for i, base in enumerate(formats):
        if base is None:
            continue
        environment = state.texture_units[i].environment
        if environment.mode == TextureEnvironmentMode.NONE:
            continue
        if not ones and any(colors[n] is None for n in used_textures(environment)):
            continue
        constant = fixed.color_codes(environment.color)
        if environment.mode in (TextureEnvironmentMode.COMBINE, TextureEnvironmentMode.COMBINE4):
            read = partial(argument, colors, i, constant, primary, color)
            color = combined(environment, read, profile)
        else:
            color = conventional(environment.mode, base, constant, color, colors[i], profile)
    return color
