"""Texture shader stages, register combiners and texture environments as equations.

Equations omit what cannot contribute: factors of one, products with zero, discarded outputs. ``.`` is a dot
product, ``1 - x`` is UNSIGNED_INVERT, 1/2 is the machine's half.
"""

from dataclasses import fields, replace

from fixedpipe.pipeline.description.words import format_number, format_value
from fixedpipe.pipeline.enums import (
    CombineFunction,
    CombineOperand,
    CombinerBias,
    CombinerFunction,
    CombinerScale,
    CombineSource,
    ComponentUsage,
    CullMode,
    DotProductMapping,
    Mapping,
    Meaning,
    MuxSelect,
    Register,
    TextureEnvironmentMode,
    TextureShaderOperation,
)
from fixedpipe.pipeline.notations.register_combiner_words import REGISTER_NAMES, format_input
from fixedpipe.pipeline.programs.texture_environment import arguments
from fixedpipe.pipeline.state import RegisterCombiners, TextureEnvironment, TextureShaderStage

_OP = TextureShaderOperation
_REFLECTED = "2 n (n . e) / (n . n) - e"
# A unit's texel; s to q are its coordinates, dots the dot products, p the texel of the previous texture
# input.
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
# The fields that appear in the parts of an equation.
_TOLD = {
    "kept": ("cull_modes",),
    "offset": ("previous_texture_input", "offset_texture_matrix"),
    "scaled": ("offset_texture_scale", "offset_texture_bias"),
    "p": ("previous_texture_input",),
    "dot": ("previous_texture_input", "dot_product_mapping"),
    "eye": ("constant_eye",),
}
_DOT_MAPPINGS = {DotProductMapping.UNSIGNED_IDENTITY: "{}", DotProductMapping.EXPAND_NORMAL: "expand({})"}


def shader_stage_equation(i, stage):
    """A texture shader stage as an equation, then the set fields that its equation does not show."""
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
        "offset": f"(s{i}, t{i}) + {format_value(((a1, a3), (a2, a4)))} ({previous}'s ds, dt)",
        "scaled": (
            f"times {format_number(stage.offset_texture_scale)} {previous}'s magnitude + "
            f"{format_number(stage.offset_texture_bias)}"
        ),
        "dot": f"dot{i} = (s{i}, t{i}, r{i}) . {mapping.format(previous)}",
        "reflected": _REFLECTED,
        "eye": format_value(stage.constant_eye),
    }
    told = {"operation"}
    for part, names in _TOLD.items():
        if f"{{{part}}}" in equation:
            told.update(names)
    initial = TextureShaderStage()
    rest = [
        f"{field.name.replace('_', ' ')} {format_value(getattr(stage, field.name))}"
        for field in fields(stage)
        if field.name not in told and getattr(stage, field.name) != getattr(initial, field.name)
    ]
    return ", ".join([equation.format(g=i - 2, h=i - 1, i=i, j=i + 1, **parts), *rest])


# The results of mappings of ZERO that are not 0.
_OF_ZERO = {
    Mapping.UNSIGNED_INVERT: "1",
    Mapping.EXPAND_NORMAL: "-1",
    Mapping.EXPAND_NEGATE: "1",
    Mapping.HALF_BIAS_NORMAL: "-1/2",
    Mapping.HALF_BIAS_NEGATE: "1/2",
}
_SCALE_WORDS = {
    CombinerScale.SCALE_BY_TWO: "2",
    CombinerScale.SCALE_BY_FOUR: "4",
    CombinerScale.SCALE_BY_ONE_HALF: "1/2",
}

_FUNCTIONS = {CombinerFunction.SQUARE_ROOT: "sqrt", CombinerFunction.EXPONENTIAL: "exp"}


def _term(given, plain):
    """One variable of an equation; alpha and blue have a suffix."""
    if given.register is Register.ZERO:
        return _OF_ZERO.get(given.mapping, "0")
    if given.mapping is Mapping.UNSIGNED_INVERT:
        return f"(1 - {_saturated(given, _name(given))})"
    if given.meaning is Meaning.SATURATED and given.mapping is Mapping.UNSIGNED_IDENTITY:
        return _saturated(given, _name(given))
    return format_input(given, ComponentUsage.RGB, plain)


def _saturated(given, name):
    return f"sat({name})" if given.meaning is Meaning.SATURATED else name


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
    for one, other in ((a, b), (b, a)):
        if one == "1":
            return other
        if one == "-1":
            return other[1:] if other.startswith("-") else f"-{other}"
    return f"{a} * {b}"


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


def portion_line(title, portion, suffix, selector, clamped=()):
    """A portion as a line of equations for its kept outputs; an empty list where all are discarded.

    ``clamped`` has the names of registers whose value the machine's clamp may change.
    """
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
    written = []
    for output, expression, copied in (
        (portion.ab_output, ab, getattr(portion, "ab_blue_to_alpha", False)),
        (portion.cd_output, cd, getattr(portion, "cd_blue_to_alpha", False)),
        (portion.sum_output, total, False),
    ):
        if output is not Register.DISCARD:
            name = REGISTER_NAMES[output]
            blue = f", and {name}.a = its blue" if copied else ""
            clamp = ", clamped to [-1, 1]" if name in clamped else ""
            written.append(f"{name}{suffix} = {_scaled(expression, portion)}{clamp}{blue}")
    return [f"{title}: {'; '.join(written)}"] if written else []


def final_lines(final, title=""):
    """The final combiner as equations: of E times F where it is read, of RGB, of alpha.

    ``title`` is added to its name.
    """
    a, b, c, d, e, f, g = (
        _term(getattr(final, variable), Mapping.UNSIGNED_IDENTITY) for variable in "abcdefg"
    )
    lines = []
    if Register.E_TIMES_F in (given.register for given in (final.a, final.b, final.c, final.d)):
        lines.append(f"final{title}: final_product = {_product(e, f)}")
    complement = {"0": "1", "1": "0"}.get(a)
    if complement is None:
        inverted = final.a.mapping is Mapping.UNSIGNED_INVERT
        complement = _name(final.a) if inverted else f"(1 - {a})"
    rgb = _sum(_product(a, b), _product(complement, c), d)
    return [*lines, f"final.rgb{title}: out.rgb = {rgb}", f"final.alpha{title}: out.a = {g}"]


def combiner_lines(combiners, titles=(), constants=None, clamped=()):
    """Register combiners as equations: constants, each general combiner, the final combiner.

    - ``titles``: added to the name of each general combiner and, last, of the final one.
    - ``constants``: {(number of a general combiner or None, name of a field): its color in words}.
    - ``clamped``: (number, "rgb" or "alpha", name of a register) that the machine's clamp may change.
    """
    initial, lines = RegisterCombiners(), ["REGISTER_COMBINERS enabled"]
    titles = titles or ("",) * (len(combiners.general) + 1)

    def color(number, owner, name):
        given = getattr(owner, name)
        return (constants or {}).get((number, name)) or format_value(given)

    for name in ("constant_color0", "constant_color1"):
        if getattr(combiners, name) != getattr(initial, name) or (None, name) in (constants or {}):
            lines.append(f"  {_constant(name)} = {color(None, combiners, name)}")
    selector = "spare0.a is even" if combiners.mux_select is MuxSelect.LSB else "spare0.a < 1/2"
    for number, stage in enumerate(combiners.general):
        of = [
            [register for n, portion, register in clamped if (n, portion) == (number, half)]
            for half in ("rgb", "alpha")
        ]
        own = [
            f"  GC{number}: {_constant(name)} = {color(number, stage, name)}"
            for name in ("constant_color0", "constant_color1")
            if getattr(stage, name) is not None
        ]
        written = [
            *portion_line(f"  GC{number}.rgb{titles[number]}", stage.rgb, "", selector, of[0]),
            *portion_line(f"  GC{number}.alpha{titles[number]}", stage.alpha, ".a", selector, of[1]),
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
    return lines + [f"  {line}" for line in final_lines(combiners.final, titles[-1])]


def _constant(field):
    return field.replace("constant_color", "const")


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
    """A half of a COMBINE or COMBINE4 environment; the function's name alone where arguments are missing."""
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
    return made if half.scale == 1 or made == "0" else f"{format_number(half.scale)} * {_grouped(made)}"


def environment_lines(environment):
    """A texture environment: its mode and, if it combines, its equations."""
    mode, initial = environment.mode, TextureEnvironment()
    lines = [f"TEXTURE_ENV_MODE {mode.name}"]
    if environment.color != initial.color:
        lines.append(f"  constant = {format_value(environment.color)}")
    if mode in (TextureEnvironmentMode.COMBINE, TextureEnvironmentMode.COMBINE4):
        rgb, alpha = environment.rgb, environment.alpha
        whole = rgb.function is CombineFunction.DOT3_RGBA and mode is TextureEnvironmentMode.COMBINE
        lines.append(f"  rgb = {_environment_equation(mode, rgb, False)}")
        if whole:
            scale = "" if alpha.scale == 1 else f"{format_number(alpha.scale)} * "
            unscaled = _environment_equation(mode, replace(rgb, scale=1.0), False)
            lines.append(f"  alpha = {scale}{_grouped(unscaled) if scale else unscaled}")
        else:
            lines.append(f"  alpha = {_environment_equation(mode, alpha, True)}")
    return lines
