"""A pass sequence in words: each command, what differs from the initial state, combiners as equations.

The words are OpenGL's: tokens where OpenGL has one (TEXTURE_MIN_FILTER LINEAR), registers as the ``!!RC1.0``
notation calls them. Equations leave out what cannot contribute: factors of one, products with zero, discarded
outputs. ``.`` is a dot product, ``1 - x`` is UNSIGNED_INVERT, 1/2 is the machine's half.
"""

import re
from dataclasses import MISSING, fields, is_dataclass, replace
from enum import Enum

from fixedpipe.pipeline.commands import (
    Accum,
    BindTexImage,
    Bitmap,
    Clear,
    CopyPixels,
    CopyTexImage,
    CopyTexSubImage,
    Draw,
    DrawPixels,
    HostStep,
    MakeCurrent,
    ReadPixels,
    ResetHistogram,
    ResetMinmax,
    Saturate,
    TexImage,
)
from fixedpipe.pipeline.enums import (
    AccumOperation,
    ColorBuffer,
    CombineFunction,
    CombineOperand,
    CombinerBias,
    CombinerFunction,
    CombinerScale,
    CombineSource,
    ComponentUsage,
    ConvolutionBorderMode,
    CullMode,
    DepthFormat,
    DotProductMapping,
    Mapping,
    MuxSelect,
    Register,
    TextureEnvironmentMode,
    TextureShaderOperation,
    TextureTarget,
    WindowOrigin,
)
from fixedpipe.pipeline.notations.register_combiners import REGISTER_NAMES, format_input
from fixedpipe.pipeline.pixel_transfer import (
    INITIAL_TRANSFER,
    ConvolutionFilter,
    Histogram,
    Minmax,
    PixelMaps,
    PixelTransfer,
    SeparableFilter,
)
from fixedpipe.pipeline.programs.texture_environment import arguments
from fixedpipe.pipeline.state import (
    AlphaTest,
    Blending,
    ColorMask,
    ColorMaterial,
    ColorTable,
    DepthTest,
    Fog,
    Light,
    Lighting,
    LineState,
    PassState,
    PixelTexture,
    PointParameters,
    PointState,
    PolygonState,
    RasterPosition,
    RegisterCombiners,
    Sampler,
    StencilTest,
    TexGen,
    TextureEnvironment,
    TextureShaderStage,
    TextureUnit,
    VertexState,
    Viewport,
    WindowClip,
)

# What a field is called; a field that is not here is called by its own name, spelled with spaces.
_WORDS = {
    (VertexState, "modelview"): "MODELVIEW matrix",
    (VertexState, "projection"): "PROJECTION matrix",
    (VertexState, "normalize"): "NORMALIZE",
    (VertexState, "rescale_normal"): "RESCALE_NORMAL",
    (VertexState, "lighting"): "LIGHTING enabled",
    (VertexState, "clip_planes"): "CLIP_PLANE",
    (Viewport, "near"): "depth range near",
    (Viewport, "far"): "depth range far",
    (Lighting, "lights"): "LIGHT",
    (Lighting, "front"): "FRONT material",
    (Lighting, "back"): "BACK material",
    (Lighting, "model_ambient"): "LIGHT_MODEL_AMBIENT",
    (Lighting, "local_viewer"): "LIGHT_MODEL_LOCAL_VIEWER",
    (Lighting, "two_side"): "LIGHT_MODEL_TWO_SIDE",
    (Lighting, "separate_specular_color"): "SEPARATE_SPECULAR_COLOR",
    (Lighting, "color_material"): "COLOR_MATERIAL enabled",
    (PolygonState, "cull_face"): "CULL_FACE",
    (PolygonState, "front_face"): "front face",
    (PolygonState, "offset_fill"): "POLYGON_OFFSET_FILL",
    (PolygonState, "offset_factor"): "POLYGON_OFFSET_FACTOR",
    (PolygonState, "offset_units"): "POLYGON_OFFSET_UNITS",
    (PolygonState, "shade_model"): "SHADE_MODEL",
    (PolygonState, "front_mode"): "front POLYGON_MODE",
    (PolygonState, "back_mode"): "back POLYGON_MODE",
    (PolygonState, "offset_line"): "POLYGON_OFFSET_LINE",
    (PolygonState, "offset_point"): "POLYGON_OFFSET_POINT",
    (LineState, "stipple"): "LINE_STIPPLE",
    (PolygonState, "stipple"): "POLYGON_STIPPLE",
    (PointState, "size"): "POINT_SIZE",
    (PointState, "sprite"): "POINT_SPRITE",
    (PointState, "parameters"): "point parameters",
    (PointState, "program_size"): "VERTEX_PROGRAM_POINT_SIZE",
    (PointParameters, "attenuation"): "POINT_DISTANCE_ATTENUATION",
    (LineState, "width"): "LINE_WIDTH",
    (TextureUnit, "coord_replace"): "COORD_REPLACE",
    (WindowClip, "rectangles"): "rectangle",
    (TextureUnit, "lod_bias"): "TEXTURE_LOD_BIAS",
    (TextureUnit, "coordinates"): "coordinate set",
    (TextureUnit, "gen"): "TEXTURE_GEN",
    (TextureUnit, "matrix"): "TEXTURE matrix",
    (Sampler, "min_filter"): "TEXTURE_MIN_FILTER",
    (Sampler, "mag_filter"): "TEXTURE_MAG_FILTER",
    (Sampler, "wrap_s"): "TEXTURE_WRAP_S",
    (Sampler, "wrap_t"): "TEXTURE_WRAP_T",
    (Sampler, "border_color"): "TEXTURE_BORDER_COLOR",
    (Sampler, "compare_mode"): "TEXTURE_COMPARE_MODE",
    (Sampler, "compare_function"): "TEXTURE_COMPARE_FUNC",
    (Sampler, "wrap_r"): "TEXTURE_WRAP_R",
    (Sampler, "min_lod"): "TEXTURE_MIN_LOD",
    (Sampler, "max_lod"): "TEXTURE_MAX_LOD",
    (Sampler, "max_level"): "TEXTURE_MAX_LEVEL",
    (Sampler, "compare_fail_value"): "TEXTURE_COMPARE_FAIL_VALUE",
    (Sampler, "depth_texture_mode"): "DEPTH_TEXTURE_MODE",
    (Sampler, "max_probes"): "footprint probes",
    (Sampler, "max_anisotropy"): "TEXTURE_MAX_ANISOTROPY",
    (PassState, "perspective_correction"): "perspective correction",
    (PassState, "texture_units"): "texture unit",
    (PassState, "texture_shader"): "TEXTURE_SHADER stage",
    (PassState, "color_sum"): "COLOR_SUM",
    (PassState, "fog"): "FOG enabled",
    (PassState, "scissor"): "SCISSOR_TEST enabled",
    (PassState, "alpha_test"): "ALPHA_TEST enabled",
    (PassState, "stencil_test"): "STENCIL_TEST enabled",
    (PassState, "depth_test"): "DEPTH_TEST enabled",
    (PassState, "depth_clamp"): "DEPTH_CLAMP enabled",
    (PassState, "w_buffering"): "W buffering",
    (PassState, "blending"): "BLEND enabled",
    (PassState, "logic_op"): "COLOR_LOGIC_OP",
    (DepthTest, "write"): "depth writes",
    (Fog, "coordinate_source"): "FOG_COORDINATE_SOURCE",
    (PixelTransfer, "map_color"): "MAP_COLOR",
    (PixelTransfer, "map_stencil"): "MAP_STENCIL",
    (PixelTransfer, "index_shift"): "INDEX_SHIFT",
    (PixelTransfer, "index_offset"): "INDEX_OFFSET",
    (PixelTransfer, "depth_scale"): "DEPTH_SCALE",
    (PixelTransfer, "depth_bias"): "DEPTH_BIAS",
    (PixelTransfer, "maps"): "PIXEL_MAP",
    (PixelTransfer, "color_table"): "COLOR_TABLE",
    (PixelTransfer, "convolution_1d"): "CONVOLUTION_1D",
    (PixelTransfer, "convolution_2d"): "CONVOLUTION_2D",
    (PixelTransfer, "separable_2d"): "SEPARABLE_2D",
    (PixelTransfer, "post_convolution_scale"): "POST_CONVOLUTION scale",
    (PixelTransfer, "post_convolution_bias"): "POST_CONVOLUTION bias",
    (PixelTransfer, "post_convolution_color_table"): "POST_CONVOLUTION_COLOR_TABLE",
    (PixelTransfer, "color_matrix"): "COLOR matrix",
    (PixelTransfer, "post_color_matrix_scale"): "POST_COLOR_MATRIX scale",
    (PixelTransfer, "post_color_matrix_bias"): "POST_COLOR_MATRIX bias",
    (PixelTransfer, "post_color_matrix_color_table"): "POST_COLOR_MATRIX_COLOR_TABLE",
    (PixelTransfer, "histogram"): "HISTOGRAM enabled",
    (PixelTransfer, "minmax"): "MINMAX enabled",
    (PixelMaps, "i_to_r"): "I_TO_R",
    (PixelMaps, "i_to_g"): "I_TO_G",
    (PixelMaps, "i_to_b"): "I_TO_B",
    (PixelMaps, "i_to_a"): "I_TO_A",
    (PixelMaps, "r_to_r"): "R_TO_R",
    (PixelMaps, "g_to_g"): "G_TO_G",
    (PixelMaps, "b_to_b"): "B_TO_B",
    (PixelMaps, "a_to_a"): "A_TO_A",
    (PixelMaps, "s_to_s"): "S_TO_S",
    (TextureUnit, "color_table"): "TEXTURE_COLOR_TABLE",
}

# Fields that say what an enabled test or operation does, shown even at their initial value.
_ALWAYS = {
    AlphaTest: ("function", "reference"),
    StencilTest: ("function", "reference"),
    DepthTest: ("function",),
    Blending: ("source", "destination"),
    Fog: ("mode",),
    ColorMaterial: ("face", "parameter"),
    Light: ("position",),
    TexGen: ("mode",),
    Histogram: ("name", "width", "base_format"),
    Minmax: ("name", "base_format"),
}


# ------------------------------------------------------------------------------------------- values


def _number(value):
    short = f"{value + 0.0:g}"  # minus zero shows as 0
    return short if float(short) == value else repr(float(value))


def _value(value):
    if isinstance(value, bool):
        return "enabled" if value else "disabled"
    if isinstance(value, Enum):
        return value.name
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, bytes):
        return value.hex(" ", 4)
    if isinstance(value, tuple) and value and isinstance(value[0], tuple):
        return "[" + " | ".join(" ".join(_number(v) for v in row) for row in value) + "]"
    if isinstance(value, tuple):
        return f"({', '.join(_value(v) for v in value)})"
    return "whole framebuffer" if value is None else _number(value)


def _initial(field):
    if field.default is not MISSING:
        return field.default
    return field.default_factory() if field.default_factory is not MISSING else MISSING


def _differences(value, initial=None):
    """Lines for the fields of a state that differ from ``initial``, or from its own defaults.

    Simple fields share the first line, which may be empty; parts follow, indented.
    """
    simple, parts = [], []
    for field in fields(value):
        given = getattr(value, field.name)
        usual = _initial(field) if initial is None else getattr(initial, field.name)
        if given == usual and field.name not in _ALWAYS.get(type(value), ()):
            continue
        word = _WORDS.get((type(value), field.name), field.name.replace("_", " "))
        if isinstance(given, RegisterCombiners):
            parts += _combiner_lines(given)
        elif isinstance(given, TextureEnvironment):
            parts += _environment_lines(given)
        elif isinstance(given, ColorMask):
            parts.append(f"color mask {_mask(given)}")
        elif isinstance(given, tuple) and any(is_dataclass(g) for g in given):
            parts += _numbered(word, given)
        elif field.name == "clip_planes":
            parts += [f"{word}{i} {_value(plane)}" for i, plane in enumerate(given)]
        elif isinstance(given, ColorTable):
            parts.append(_table_line(word, given))
        elif isinstance(given, ConvolutionFilter | SeparableFilter):
            parts += _filter_lines(word, given)
        elif is_dataclass(given):
            parts += _titled(word, _differences(given, usual if is_dataclass(usual) else None))
        elif given is None:
            simple.append(f"{word} disabled")
        else:
            simple.append(f"{word} {_value(given)}")
    return [", ".join(simple), *parts]


def _numbered(word, parts):
    lines = []
    for i, part in enumerate(parts):
        if isinstance(part, TexGen):
            if part != TexGen():
                lines += _titled(f"{word}_{'STRQ'[i]}", _differences(part))
        elif isinstance(part, TextureShaderStage):
            lines.append(f"{word} {i}: {_shader_stage(i, part)}")
        elif part is not None:
            lines += _titled(f"{word} {i}", _differences(part))
    return lines


def _titled(title, lines):
    first, *rest = lines
    return [f"{title}: {first}" if first else title, *("  " + line for line in rest)]


def _mask(mask):
    written = [f.name for f in fields(mask) if getattr(mask, f.name)]
    return "writes " + (", ".join(written) or "nothing")


# ----------------------------------------------------------------------------- texture shader equations

_OP = TextureShaderOperation
_REFLECTED = "2 n (n . e) / (n . n) - e"
# What a unit's texel is, s to q its coordinates, dots the dot products, p the texel of the previous input.
_SHADER_EQUATIONS = {
    _OP.TEXTURE_1D: "tex{i} = TEXTURE_1D(s{i}/q{i})",
    _OP.TEXTURE_2D: "tex{i} = TEXTURE_2D(s{i}/q{i}, t{i}/q{i})",
    _OP.TEXTURE_RECTANGLE: "tex{i} = TEXTURE_RECTANGLE(s{i}/q{i}, t{i}/q{i})",
    _OP.TEXTURE_CUBE_MAP: "tex{i} = TEXTURE_CUBE_MAP(s{i}, t{i}, r{i})",
    _OP.TEXTURE_3D: "tex{i} = TEXTURE_3D(s{i}/q{i}, t{i}/q{i}, r{i}/q{i})",
    _OP.PASS_THROUGH: "tex{i} = (s{i}, t{i}, r{i}, q{i}), clamped to [0, 1]",
    _OP.CULL_FRAGMENT: "tex{i} = 0; kept where {kept}",
    _OP.OFFSET_TEXTURE_2D: "tex{i} = TEXTURE_2D({offset})",
    _OP.OFFSET_TEXTURE_2D_SCALE: "tex{i} = TEXTURE_2D({offset}), rgb {scaled}",
    _OP.OFFSET_TEXTURE_RECTANGLE: "tex{i} = TEXTURE_RECTANGLE({offset})",
    _OP.OFFSET_TEXTURE_RECTANGLE_SCALE: "tex{i} = TEXTURE_RECTANGLE({offset}), rgb {scaled}",
    _OP.DEPENDENT_AR_TEXTURE_2D: "tex{i} = TEXTURE_2D({p}.a, {p}.r)",
    _OP.DEPENDENT_GB_TEXTURE_2D: "tex{i} = TEXTURE_2D({p}.g, {p}.b)",
    _OP.DOT_PRODUCT: "{dot}; tex{i} = 0",
    _OP.DOT_PRODUCT_TEXTURE_2D: "{dot}; tex{i} = TEXTURE_2D(dot{h}, dot{i})",
    _OP.DOT_PRODUCT_TEXTURE_RECTANGLE: "{dot}; tex{i} = TEXTURE_RECTANGLE(dot{h}, dot{i})",
    _OP.DOT_PRODUCT_TEXTURE_3D: "{dot}; tex{i} = TEXTURE_3D(dot{g}, dot{h}, dot{i})",
    _OP.DOT_PRODUCT_TEXTURE_CUBE_MAP: "{dot}; tex{i} = TEXTURE_CUBE_MAP(dot{g}, dot{h}, dot{i})",
    _OP.DOT_PRODUCT_DIFFUSE_CUBE_MAP: "{dot}; tex{i} = TEXTURE_CUBE_MAP(dot{h}, dot{i}, dot{j})",
    _OP.DOT_PRODUCT_REFLECT_CUBE_MAP: (
        "{dot}; tex{i} = TEXTURE_CUBE_MAP({reflected}), n = (dot{g}, dot{h}, dot{i}), e = (q{g}, q{h}, q{i})"
    ),
    _OP.DOT_PRODUCT_CONST_EYE_REFLECT_CUBE_MAP: (
        "{dot}; tex{i} = TEXTURE_CUBE_MAP({reflected}), n = (dot{g}, dot{h}, dot{i}), e = {eye}"
    ),
    _OP.DOT_PRODUCT_DEPTH_REPLACE: "{dot}; depth = dot{h} / dot{i}; tex{i} = 0",
}
# The fields that the parts of an equation tell.
_TOLD = {
    "kept": ("cull_modes",),
    "offset": ("previous_texture_input", "offset_texture_matrix"),
    "scaled": ("offset_texture_scale", "offset_texture_bias"),
    "p": ("previous_texture_input",),
    "dot": ("previous_texture_input", "dot_product_mapping"),
    "eye": ("constant_eye",),
}
_DOT_MAPPINGS = {DotProductMapping.UNSIGNED_IDENTITY: "{}", DotProductMapping.EXPAND_NORMAL: "expand({})"}


def _shader_stage(i, stage):
    """A texture shader stage as an equation, then what it sets and its operation does not read."""
    equation = _SHADER_EQUATIONS.get(stage.operation, stage.operation.name)
    previous = f"tex{stage.previous_texture_input}"
    a1, a2, a3, a4 = stage.offset_texture_matrix
    mapping = _DOT_MAPPINGS.get(stage.dot_product_mapping, f"{stage.dot_product_mapping.name}({{}})")
    parts = {
        "p": previous,
        "kept": ", ".join(
            f"{name}{i} {'>=' if mode is CullMode.GEQUAL else '<'} 0"
            for name, mode in zip("strq", stage.cull_modes, strict=True)
        ),
        "offset": f"(s{i}, t{i}) + {_value(((a1, a3), (a2, a4)))} ({previous}'s ds, dt)",
        "scaled": (
            f"times {_number(stage.offset_texture_scale)} {previous}'s magnitude + "
            f"{_number(stage.offset_texture_bias)}"
        ),
        "dot": f"dot{i} = (s{i}, t{i}, r{i}) . {mapping.format(previous)}",
        "reflected": _REFLECTED,
        "eye": _value(stage.constant_eye),
    }
    told = {"operation"}
    for part, names in _TOLD.items():
        if f"{{{part}}}" in equation:
            told.update(names)
    initial = TextureShaderStage()
    rest = [
        f"{field.name.replace('_', ' ')} {_value(getattr(stage, field.name))}"
        for field in fields(stage)
        if field.name not in told and getattr(stage, field.name) != getattr(initial, field.name)
    ]
    return ", ".join([equation.format(g=i - 2, h=i - 1, i=i, j=i + 1, **parts), *rest])


# ---------------------------------------------------------------------------------- combiner equations

_ZERO_MAPPINGS = (Mapping.UNSIGNED_IDENTITY, Mapping.SIGNED_IDENTITY, Mapping.SIGNED_NEGATE)
_SCALE_WORDS = {
    CombinerScale.SCALE_BY_TWO: "2",
    CombinerScale.SCALE_BY_FOUR: "4",
    CombinerScale.SCALE_BY_ONE_HALF: "1/2",
}


def _term(given, plain):
    """One variable of an equation; alpha and blue carry their suffix."""
    if given.register is Register.ZERO and given.mapping in _ZERO_MAPPINGS:
        return "0"
    if given.mapping is Mapping.UNSIGNED_INVERT:
        if given.register is Register.ZERO:
            return "1"
        return f"(1 - {_name(given)})"
    return format_input(given, ComponentUsage.RGB, plain)


def _name(given):
    return format_input(
        type(given)(given.register, Mapping.UNSIGNED_IDENTITY, given.usage),
        ComponentUsage.RGB,
        Mapping.UNSIGNED_IDENTITY,
    )


def _product(a, b, dot=False):
    if "0" in (a, b):
        return "0"
    if dot:
        return f"{a} . {b}"
    if a == "1":
        return b
    return a if b == "1" else f"{a} * {b}"


def _sum(*terms):
    kept = [term for term in terms if term != "0"]
    if not kept:
        return "0"
    if len(kept) > 1:
        kept = [f"({term})" if " . " in term else term for term in kept]
    return kept[0] + "".join(f" - {t[1:]}" if t.startswith("-") else f" + {t}" for t in kept[1:])


def _grouped(expression):
    return f"({expression})" if " " in expression else expression


def _scaled(expression, portion):
    if portion.bias is CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF:
        expression = "-1/2" if expression == "0" else f"{expression} - 1/2"
    if expression == "0" or portion.scale is CombinerScale.NONE:
        return expression
    return f"{_SCALE_WORDS[portion.scale]} * {_grouped(expression)}"


_FUNCTIONS = {CombinerFunction.SQUARE_ROOT: "sqrt", CombinerFunction.EXPONENTIAL: "exp"}


def _portion_line(title, portion, suffix, selector):
    a, b, c, d = (
        _term(given, Mapping.SIGNED_IDENTITY) for given in (portion.a, portion.b, portion.c, portion.d)
    )
    ab = _product(a, b, getattr(portion, "ab_dot_product", False))
    cd = _product(c, d, getattr(portion, "cd_dot_product", False))
    total = f"({selector} ? {ab} : {cd})" if portion.mux_sum else _sum(ab, cd)
    if portion.function is CombinerFunction.DIVIDE:
        total = f"{_grouped(ab)} / {_grouped(cd)}"
    elif portion.function is not CombinerFunction.NONE:
        total = f"{_FUNCTIONS[portion.function]}({total})"
    written = [
        f"{REGISTER_NAMES[output]}{suffix} = {_scaled(expression, portion)}"
        for output, expression in (
            (portion.ab_output, ab),
            (portion.cd_output, cd),
            (portion.sum_output, total),
        )
        if output is not Register.DISCARD
    ]
    return [f"{title}: {'; '.join(written)}"] if written else []


def _blue_to_alpha_line(title, portion):
    written = [
        f"{REGISTER_NAMES[output]}.a = {REGISTER_NAMES[output]}.b"
        for output, copied in (
            (portion.ab_output, portion.ab_blue_to_alpha),
            (portion.cd_output, portion.cd_blue_to_alpha),
        )
        if copied and output is not Register.DISCARD
    ]
    return [f"{title}: {'; '.join(written)}"] if written else []


def _final_lines(final):
    a, b, c, d, e, f, g = (
        _term(getattr(final, variable), Mapping.UNSIGNED_IDENTITY) for variable in "abcdefg"
    )
    lines = []
    if Register.E_TIMES_F in (given.register for given in (final.a, final.b, final.c, final.d)):
        lines.append(f"final: final_product = {_product(e, f)}")
    complement = {"0": "1", "1": "0"}.get(a)
    if complement is None:
        inverted = final.a.mapping is Mapping.UNSIGNED_INVERT
        complement = _name(final.a) if inverted else f"(1 - {a})"
    rgb = _sum(_product(a, b), _product(complement, c), d)
    return [*lines, f"final.rgb: out.rgb = {rgb}", f"final.alpha: out.a = {g}"]


def _combiner_lines(combiners):
    initial, lines = RegisterCombiners(), ["REGISTER_COMBINERS enabled"]
    for name in ("constant_color0", "constant_color1"):
        if getattr(combiners, name) != getattr(initial, name):
            lines.append(f"  {_constant(name)} = {_value(getattr(combiners, name))}")
    selector = "spare0.a is even" if combiners.mux_select is MuxSelect.LSB else "spare0.a < 1/2"
    for number, stage in enumerate(combiners.general):
        own = [
            f"  GC{number}: {_constant(name)} = {_value(getattr(stage, name))}"
            for name in ("constant_color0", "constant_color1")
            if getattr(stage, name) is not None
        ]
        written = [
            *_portion_line(f"  GC{number}.rgb", stage.rgb, "", selector),
            *_blue_to_alpha_line(f"  GC{number}.rgb", stage.rgb),
            *_portion_line(f"  GC{number}.alpha", stage.alpha, ".a", selector),
        ]
        if stage.lookup is not None:
            read = REGISTER_NAMES[stage.lookup.register]
            written.append(
                f"  GC{number}: tex{stage.lookup.unit} = texture {stage.lookup.unit} at {read}.rgb"
            )
        lines += own + (written or [f"  GC{number}: writes nothing"])
    if not combiners.color_sum_clamp:
        lines.append("  COLOR_SUM_CLAMP disabled")
    for field, name in (("invert_spare0", "spare0"), ("invert_secondary_color", "col1")):
        if getattr(combiners, field):
            lines.append(f"  color_sum takes 1 - {name}")
    return lines + [f"  {line}" for line in _final_lines(combiners.final)]


def _constant(field):
    return field.replace("constant_color", "const")


# --------------------------------------------------------------------------------- texture environments

_SOURCE_WORDS = {CombineSource.PRIMARY_COLOR: "primary", CombineSource.ZERO: "0"}


def _argument(source, operand, alpha):
    word = _SOURCE_WORDS.get(source, source.name.lower())
    inverted = operand in (CombineOperand.ONE_MINUS_SRC_COLOR, CombineOperand.ONE_MINUS_SRC_ALPHA)
    if word == "0":
        return "1" if inverted else "0"
    if not alpha and operand in (CombineOperand.SRC_ALPHA, CombineOperand.ONE_MINUS_SRC_ALPHA):
        word += ".a"
    return f"(1 - {word})" if inverted else word


def _one_minus(argument):
    if argument in ("0", "1"):
        return "1" if argument == "0" else "0"
    return argument[5:-1] if argument.startswith("(1 - ") else f"(1 - {argument})"


def _environment_equation(mode, half, alpha):
    """A half of a COMBINE or COMBINE4 environment; what lacks arguments is only named."""
    function, count = half.function, arguments(mode, half.function)
    given = [_argument(*pair, alpha) for pair in zip(half.sources, half.operands, strict=False)]
    if len(given) < count:
        return function.name
    a, b, c, d = (*given, *("0",) * 4)[:4]
    if mode is TextureEnvironmentMode.COMBINE4:
        made = _sum(_product(a, b), _product(c, d))
    else:
        made = {
            CombineFunction.REPLACE: a,
            CombineFunction.MODULATE: _product(a, b),
            CombineFunction.ADD: _sum(a, b),
            CombineFunction.ADD_SIGNED: _sum(a, b),
            CombineFunction.INTERPOLATE: _sum(_product(a, c), _product(b, _one_minus(c))),
            CombineFunction.SUBTRACT: _sum(a, "0" if b == "0" else f"-{b}"),
        }.get(function, f"4 * ({a} - 1/2) . ({b} - 1/2)")
    if function is CombineFunction.ADD_SIGNED:
        made = "-1/2" if made == "0" else f"{made} - 1/2"
    return made if half.scale == 1 or made == "0" else f"{_number(half.scale)} * {_grouped(made)}"


def _environment_lines(environment):
    mode, initial = environment.mode, TextureEnvironment()
    lines = [f"TEXTURE_ENV_MODE {mode.name}"]
    if environment.color != initial.color:
        lines.append(f"  constant = {_value(environment.color)}")
    if mode in (TextureEnvironmentMode.COMBINE, TextureEnvironmentMode.COMBINE4):
        rgb, alpha = environment.rgb, environment.alpha
        whole = rgb.function is CombineFunction.DOT3_RGBA and mode is TextureEnvironmentMode.COMBINE
        lines.append(f"  rgb = {_environment_equation(mode, rgb, False)}")
        if whole:
            scale = "" if alpha.scale == 1 else f"{_number(alpha.scale)} * "
            unscaled = _environment_equation(mode, replace(rgb, scale=1.0), False)
            lines.append(f"  alpha = {scale}{_grouped(unscaled) if scale else unscaled}")
        else:
            lines.append(f"  alpha = {_environment_equation(mode, alpha, True)}")
    return lines


# ------------------------------------------------------------------------------------------ commands


def _clear(command):
    cleared = [
        f"{what} to {_value(getattr(command, what))}"
        for what in ("color", "depth", "stencil", "accumulation")
        if getattr(command, what) is not None
    ]
    lines = ["clears " + (", ".join(cleared) or "nothing") + _of_buffer(" of", command.draw_buffer)]
    if command.scissor is not None:
        lines += _titled("SCISSOR_TEST enabled", _differences(command.scissor))
    if command.color_mask != ColorMask():
        lines.append(f"color mask {_mask(command.color_mask)}")
    if command.stencil_write_mask != 0xFF:
        lines.append(f"stencil write mask {command.stencil_write_mask}")
    return lines


def _of_buffer(preposition, buffer):
    return "" if buffer is ColorBuffer.BACK else f"{preposition} {buffer.name}"


def _mesh(mesh):
    text = f"{mesh.primitive.name}, {_count(len(mesh.positions), 'vertex', 'vertices')}"
    if mesh.indices is not None:
        text += f", {_count(len(mesh.indices), 'index', 'indices')}"
    if mesh.counts is not None:
        text += f" in {_count(len(mesh.counts), 'run', 'runs')}"
    arrays = [
        name.replace("_", " ")
        for name in (
            "colors",
            "secondary_colors",
            "back_colors",
            "back_secondary_colors",
            "normals",
            "fog_coordinates",
        )
        if getattr(mesh, name) is not None
    ]
    if mesh.texture_coordinates:
        arrays.append(
            _count(len(mesh.texture_coordinates), "texture coordinate set", "texture coordinate sets")
        )
    return f"draws {text}" + (f"; with {', '.join(arrays)}" if arrays else "")


def _count(number, one, many):
    return f"{number} {one if number == 1 else many}"


def _draw(command):
    first, *rest = _differences(command.state)
    return [_mesh(command.mesh), *([first] if first else []), *rest]


def _pixel_transfer(transfer):
    """Lines for a pixel transfer that is not the initial one."""
    if transfer == INITIAL_TRANSFER:
        return []
    return _titled("pixel transfer", _differences(transfer))


def _table_line(word, table):
    """A colour table: all of a short one's entries, a longer one's ends."""
    bits = "" if table.bits is None else f" of {_count(table.bits, 'bit', 'bits')}"
    entries = table.entries
    shown = _value(entries) if len(entries) <= 4 else f"{_value(entries[0])} to {_value(entries[-1])}"
    return f"{word} enabled: {len(entries)} {table.base_format.name} entries{bits}, {shown}"


def _filter_lines(word, kernel):
    """A convolution filter: how it treats borders, then its rows from the bottom, or its row and column."""
    if isinstance(kernel, ConvolutionFilter):
        lines = [(f"row {j}", row) for j, row in enumerate(kernel.rows)]
    else:
        lines = [("row", kernel.row), ("column", kernel.column)]
    border = kernel.border_mode.name
    if kernel.border_mode is ConvolutionBorderMode.CONSTANT_BORDER:
        border += f" {_value(kernel.border_color)}"
    title = f"{word} enabled: {kernel.base_format.name}, {border}"
    return [title, *(f"  {name} {_value(weights)}" for name, weights in lines)]


def _tex_image(command):
    image = command.image
    if image is None:
        *layers, height, width = command.pixels.values.shape[: 3 if command.target in _LAYERED else 2]
        size = "x".join(map(str, (width, height, *layers)))
        source = f"from {size} pixels, {command.pixels.format} {command.pixels.values.dtype}"
        stored = f"{command.target.name}, {command.internal_format.name}"
        first = f'texture "{command.texture}": {stored}, {source}{_generated(command)}'
        return [first, *_pixel_transfer(command.transfer)]
    levels = _count(len(image.levels), "level", "levels")
    size = f"{image.width}x{image.height}"
    return [
        f'texture "{command.texture}": {image.target.name}, {image.internal_format.name}, {size}, {levels}'
    ]


def _rectangle(command):
    buffer = _of_buffer(" of", command.read_buffer)
    return _place(command) + buffer


def _place(command):
    if (command.x, command.y, command.width, command.height) == (0, 0, None, None):
        return "the whole framebuffer"
    width = "all columns" if command.width is None else _count(command.width, "column", "columns")
    height = "all rows" if command.height is None else _count(command.height, "row", "rows")
    return f"the framebuffer from ({command.x}, {command.y}), {width} and {height}"


def _copy_tex_image(command):
    stored = f"{command.target.name}, {command.internal_format.name}"
    first = f'texture "{command.texture}": {stored}, from {_rectangle(command)}{_generated(command)}'
    return [first, *_pixel_transfer(command.transfer)]


def _generated(command):
    return ", mipmaps generated" if command.generate_mipmap else ""


def _copy_tex_sub_image(command):
    place = f"({command.x_offset}, {command.y_offset})"
    if command.level:
        place += f" of level {command.level}"
    if command.face:
        place += f" of face {command.face}"
    first = f'texture "{command.texture}" at {place}: from {_rectangle(command)}{_generated(command)}'
    return [first, *_pixel_transfer(command.transfer)]


def _read_pixels(command):
    as_type = "" if command.type == "UNSIGNED_BYTE" else f" as {command.type}"
    first = f'"{command.name}": {command.format}{as_type} of {_rectangle(command)}'
    return [first, *_pixel_transfer(command.transfer)]


def _host_step(command):
    names = " and ".join(f'"{name}"' for name in command.reads) or "nothing"
    return [f"the host reads {names}; the commands that it issues depend on that"]


def _saturate(command):
    return ["colours are in [0, 1] from here on"]


def _reset_histogram(command):
    return [f'histogram "{command.name}" becomes empty']


def _reset_minmax(command):
    return [f'minmax "{command.name}" forgets what it saw']


def _raster_position(position):
    coordinates = f"raster position {_value(position.position)}"
    given = _differences(replace(position, position=RasterPosition().position, window=False))[0]
    return coordinates + (" in the window" if position.window else "") + (f", {given}" if given else "")


def _fragments(command, first):
    """Lines of a command that draws pixel groups; ``first``: what they are."""
    zoom = getattr(command, "zoom", (1.0, 1.0))
    lines = [first + ("" if zoom == (1.0, 1.0) else f", PixelZoom {_value(zoom)}")]
    lines.append(_raster_position(command.position))
    texture = getattr(command, "pixel_texture", None)
    if texture is not None:
        name = "PIXEL_TEXTURE" if texture.mode is None else f"PIXEL_TEX_GEN {texture.mode.name}"
        plain = PixelTexture() if texture.mode is None else replace(PixelTexture(), mode=texture.mode)
        given = _differences(replace(texture, mode=plain.mode), plain)[0]
        lines.append(f"{name} enabled" + (f": {given}" if given else ""))
    lines += _pixel_transfer(getattr(command, "transfer", INITIAL_TRANSFER))
    first, *rest = _differences(command.state)
    return [*lines, *([first] if first else []), *rest]


def _draw_pixels(command):
    height, width = command.image.values.shape[:2]
    return _fragments(command, f"{command.image.format} image, {width}x{height} groups")


def _copy_pixels(command):
    return _fragments(command, f"{command.type.name} of {_rectangle(command)}")


def _bitmap(command):
    height, width = command.bits.shape
    origin = "" if command.origin == (0.0, 0.0) else f", origin {_value(command.origin)}"
    return _fragments(command, f"bitmap, {width}x{height}{origin}")


def _accum(command):
    value = _number(command.value)
    read, written = (
        "the framebuffer" if buffer is ColorBuffer.BACK else buffer.name
        for buffer in (command.read_buffer, command.draw_buffer)
    )
    line = {
        AccumOperation.LOAD: f"the accumulation buffer becomes {value} times {read}",
        AccumOperation.ACCUM: f"{value} times {read} is added to the accumulation buffer",
        AccumOperation.ADD: f"{value} is added to the accumulation buffer",
        AccumOperation.MULT: f"the accumulation buffer is multiplied by {value}",
        AccumOperation.RETURN: f"{written} becomes {value} times the accumulation buffer",
    }[command.operation]
    lines = [line]
    if command.scissor is not None:
        lines += _titled("SCISSOR_TEST enabled", _differences(command.scissor))
    if command.color_mask != ColorMask():
        lines.append(f"color mask {_mask(command.color_mask)}")
    return lines


def _make_current(command):
    if command.surface is None:
        return ["the window"]
    size, formats = f"{command.width}x{command.height}", f"{command.color_format.name}, depth"
    depth = f"{command.depth_bits} bits" if command.depth_bits > 0 else DepthFormat(command.depth_bits).name
    return [f'pbuffer "{command.surface}": {size}, {formats} {depth}']


def _bind_tex_image(command):
    stored = f"{command.target.name}, {command.internal_format.name}"
    first = "top" if command.origin is WindowOrigin.UPPER_LEFT else "bottom"
    return [f'texture "{command.texture}": {stored}, from pbuffer "{command.surface}", {first} row first']


_DESCRIPTIONS = {
    Clear: _clear,
    Draw: _draw,
    DrawPixels: _draw_pixels,
    CopyPixels: _copy_pixels,
    Bitmap: _bitmap,
    TexImage: _tex_image,
    CopyTexImage: _copy_tex_image,
    CopyTexSubImage: _copy_tex_sub_image,
    ReadPixels: _read_pixels,
    HostStep: _host_step,
    Saturate: _saturate,
    Accum: _accum,
    MakeCurrent: _make_current,
    BindTexImage: _bind_tex_image,
    ResetHistogram: _reset_histogram,
    ResetMinmax: _reset_minmax,
}
# What ``folded`` folds. Assumed: no more commands than these for a polygon; fewer repetitions are read.
_LONGEST_PERIOD, _FEWEST_TIMES = 8, 6
_LAYERED = (TextureTarget.TEXTURE_CUBE_MAP, TextureTarget.TEXTURE_3D)


def describe_program(texture_shader, combiners):
    """Texture shader stages and register combiners as equations, a line each; either may be None."""
    lines = []
    if texture_shader is not None:
        lines.append("TEXTURE_SHADER enabled")
        lines += [f"  {line}" for line in _numbered("stage", texture_shader)]
    if combiners is not None:
        lines += _combiner_lines(combiners)
    return "".join(f"{line}\n" for line in lines)


def describe(commands, *, folded=False):
    """The commands as text: a numbered block for each, its label, and what differs from the initial state.

    Commands are numbered from 0, as ``fixedpipe.pipeline.validation`` numbers them in its sentences. ``folded``: where
    the same few commands come again and again, for polygon after polygon, they are described once, and how
    often they come.
    """
    blocks, commands, number = [], tuple(commands), 0
    names = [(type(c), re.sub(r"\d+", "", c.label)) for c in commands] if folded else []
    while number < len(commands):
        period, times = _repeated(names, number)
        for command in commands[number : number + period]:
            lines = _DESCRIPTIONS[type(command)](command)
            title = f'{number}. {type(command).__name__} "{command.label}"'
            blocks.append("\n".join([title, *(f"   {line}" for line in lines)]) + "\n")
            number += 1
        if times > 1:
            last = number + period * (times - 1) - 1
            what = "the command above" if period == 1 else f"the {period} commands above"
            blocks.append(
                f"{number} to {last}. {what} again, {times - 1} times, with other numbers in them\n"
            )
            number = last + 1
    return "\n".join(blocks)


def _repeated(names, first):
    """How many commands from ``first`` on come again at once, and how often they are there: (1, 1) where
    nothing is repeated so often that it is worth a word.
    """
    for period in range(1, _LONGEST_PERIOD + 1):
        once, times = names[first : first + period], 1
        following = first + period
        while once and names[following : following + period] == once:
            times, following = times + 1, following + period
        if times >= _FEWEST_TIMES:
            return period, times
    return 1, 1
