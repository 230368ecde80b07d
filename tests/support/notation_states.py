"""What texts in the notations of the time mean: plain dicts, from the grammars' trees and no parser's code.

Every function raises RejectedError for what its notation, or its extension, does not allow.
Names of registers, mappings and operations are the extensions' own, without their suffixes.
"""

from math import isfinite

from tests.support.grammar import RejectedError, part, parts
from tests.support.notation_grammars import PIXEL_SHADER, REGISTER_COMBINERS, TEXTURE_SHADERS


def _require(condition, sentence):
    if not condition:
        raise RejectedError(sentence)


def _number(words):
    """The value of the words of a number. Every notation's numbers end where a float's do."""
    value = float("".join(words).removesuffix("f"))
    _require(isfinite(value), "a number beyond a float")
    return value


def _numbers(tree):
    return tuple(_number(found[1:]) for found in parts(tree, "number"))


# ------------------------------------------------------------------------------------ register combiners

_REGISTERS = {
    "zero": "ZERO",
    "const0": "CONSTANT_COLOR0",
    "const1": "CONSTANT_COLOR1",
    "fog": "FOG",
    "col0": "PRIMARY_COLOR",
    "col1": "SECONDARY_COLOR",
    "spare0": "SPARE0",
    "spare1": "SPARE1",
    "final_product": "E_TIMES_F",
    "color_sum": "SPARE0_PLUS_SECONDARY_COLOR",
    "discard": "DISCARD",
} | {f"tex{unit}": f"TEXTURE{unit}" for unit in range(4)}
_COMPONENTS = {"rgb": "RGB", "a": "ALPHA", "b": "BLUE"}
_MAPPED = {
    ("", ""): "SIGNED_IDENTITY",
    ("-", ""): "SIGNED_NEGATE",
    ("", "unsigned"): "UNSIGNED_IDENTITY",
    ("", "unsigned_invert"): "UNSIGNED_INVERT",
    ("", "expand"): "EXPAND_NORMAL",
    ("-", "expand"): "EXPAND_NEGATE",
    ("", "half_bias"): "HALF_BIAS_NORMAL",
    ("-", "half_bias"): "HALF_BIAS_NEGATE",
}
# One is ZERO inverted; minus one is ZERO expanded. What else is made of one is made of zero.
_OF_ONE = {
    "SIGNED_IDENTITY": "UNSIGNED_INVERT",
    "SIGNED_NEGATE": "EXPAND_NORMAL",
    "UNSIGNED_IDENTITY": "UNSIGNED_INVERT",
    "UNSIGNED_INVERT": "UNSIGNED_IDENTITY",
    "EXPAND_NORMAL": "UNSIGNED_INVERT",
    "EXPAND_NEGATE": "EXPAND_NORMAL",
    "HALF_BIAS_NORMAL": "HALF_BIAS_NEGATE",
    "HALF_BIAS_NEGATE": "HALF_BIAS_NORMAL",
}
_WRITABLE = {
    "PRIMARY_COLOR",
    "SECONDARY_COLOR",
    "SPARE0",
    "SPARE1",
    "DISCARD",
    *(f"TEXTURE{k}" for k in range(4)),
}
_MOST_COMBINERS, _MOST_UNITS = 8, 4


def _variable(word, mapping, component):
    name, _, given = word.partition(".")
    usage = _COMPONENTS[given] if given else component
    return ("ZERO", _OF_ONE[mapping], usage) if name == "one" else (_REGISTERS[name], mapping, usage)


def _zero(component):
    return "ZERO", "UNSIGNED_IDENTITY", component


def _constants(tree):
    found = [(constant[1], _numbers(constant)) for constant in parts(tree, "constant")]
    _require(len(dict(found)) == len(found), "a constant set twice")
    return dict(found)


def _input(tree, component):
    sign = "-" if tree[1] == "-" else ""
    function = next((word for word in tree[1:] if isinstance(word, str) and word not in "-()"), "")
    given = _variable(part(tree, "register")[1], _MAPPED[sign, function], component)
    allowed = ("RGB", "ALPHA") if component == "RGB" else ("ALPHA", "BLUE")
    _require(given[2] in allowed, "a component that the portion does not read")
    _require(given[0] != "FOG" or given[2] != "ALPHA", "the fog factor in a general combiner")
    return given


def _target(tree, component):
    name, _, given = part(tree, "target")[1].partition(".")
    _require(not given or _COMPONENTS[given] == component, "an output of the other component")
    _require(_REGISTERS[name] in _WRITABLE, "an output that is read only")
    return _REGISTERS[name]


def _portion(tree):
    component = "RGB" if tree[1] == "rgb" else "ALPHA"
    zero, one = _zero(component), ("ZERO", "UNSIGNED_INVERT", component)
    products, dots, outputs = [], [], []
    for product in parts(tree, "product"):
        inputs = [_input(found, component) for found in parts(product, "input")]
        dots.append("." in product)
        _require(component == "RGB" or not dots[-1], "a dot product of alpha")
        products += [*inputs, one][:2]
        outputs.append(_target(product, component))
    outputs += ["DISCARD"] * (2 - len(outputs))
    total, scale = part(tree, "total"), part(tree, "scale")
    outputs.append(_target(total, component) if total else "DISCARD")
    kept = [output for output in outputs if output != "DISCARD"]
    _require(len(set(kept)) == len(kept), "two outputs into one register")
    word = scale[1] if scale else ""
    state = dict(zip("abcd", (*products, zero, zero)[:4], strict=True))
    state |= dict(zip(("ab_output", "cd_output", "sum_output"), outputs, strict=True))
    state["mux_sum"] = total is not None and "mux" in total
    state["bias"] = "BIAS_BY_NEGATIVE_ONE_HALF" if word.startswith("bias") else "NONE"
    state["scale"] = next(
        (f"SCALE_BY_{n.upper()}" for n in ("two", "four") if word.endswith(f"scale_by_{n}")), "NONE"
    )
    if word == "scale_by_one_half":
        state["scale"] = "SCALE_BY_ONE_HALF"
    if component == "RGB":
        state |= dict(zip(("ab_dot_product", "cd_dot_product"), (*dots, False)[:2], strict=True))
    return state


def _unused(component):
    zero, nowhere = _zero(component), dict.fromkeys(("ab_output", "cd_output", "sum_output"), "DISCARD")
    state = dict.fromkeys("abcd", zero) | nowhere | {"mux_sum": False, "scale": "NONE", "bias": "NONE"}
    return state | ({"ab_dot_product": False, "cd_dot_product": False} if component == "RGB" else {})


def _stage(tree):
    portions = parts(tree, "portion")
    by_name = {found[1]: _portion(found) for found in portions}
    _require(len(by_name) == len(portions), "two portions of one kind")
    constants = _constants(tree)
    return {
        "rgb": by_name.get("rgb", _unused("RGB")),
        "alpha": by_name.get("alpha", _unused("ALPHA")),
        "constant_color0": constants.get("const0"),
        "constant_color1": constants.get("const1"),
    }


def _last(tree, component="RGB"):
    """A variable of the final combiner."""
    mapping = "UNSIGNED_IDENTITY" if len(tree) == 2 else _MAPPED["", tree[1]]
    return _variable(part(tree, "any")[1], mapping, component)


def _blended(tree):
    """A, B, C and D of out.rgb: AB + (1 - A)C + D."""
    zero, one, given = _zero("RGB"), ("ZERO", "UNSIGNED_INVERT", "RGB"), list(map(_last, parts(tree, "last")))
    blend = part(tree, "blend")
    if blend:
        a, b, c = map(_last, parts(blend, "last"))
        return a, b, c, (given or [zero])[0]
    if "*" in tree:
        return given[0], given[1], zero, (given[2:] or [zero])[0]
    if "+" in tree:
        return given[0], one, zero, given[1]
    return zero, zero, zero, given[0]


def _final(tree):
    outputs = {found[1]: found for found in parts(tree, "output")}
    _require(len(outputs) == len(parts(tree, "output")), "an output set twice")
    before = [found[1] for found in parts(tree, "before")]
    _require(len({found[0] for found in before}) == len(before), "a statement twice")
    factors = next((found for found in before if found[0] == "product_of_two"), None)
    a, b, c, d = _blended(outputs["out.rgb"]) if "out.rgb" in outputs else (_zero("RGB"),) * 4
    pseudo = "SPARE0_PLUS_SECONDARY_COLOR"
    if a[0] == pseudo and b[0] != pseudo and c[:2] == ("ZERO", "UNSIGNED_IDENTITY"):
        a, b = b, a  # A may not read it, and AB is BA where (1 - A)C is zero
    e, f = map(_last, parts(factors, "last")) if factors else (_zero("RGB"),) * 2
    g = _last(part(outputs["out.a"], "last"), "ALPHA") if "out.a" in outputs else _zero("ALPHA")
    _require(a[0] != pseudo, "the color sum as a weight")
    _require(all(v[2] in ("RGB", "ALPHA") for v in (a, b, c, d, e, f)), "blue for colors")
    _require(g[2] in ("ALPHA", "BLUE"), "colors for alpha")
    _require(all(v[0] not in (pseudo, "E_TIMES_F") for v in (e, f, g)), "a product of a product")
    _require(factors or all(v[0] != "E_TIMES_F" for v in (a, b, c, d)), "a product that is not set")
    return dict(zip("abcdefg", (a, b, c, d, e, f, g), strict=True)), any(x[0] == "clamp" for x in before)


def register_combiners(text):
    """The state of an ``!!RC1.0`` text. Source: NV_register_combiners, its tables 4 to 6 and its errors."""
    tree = REGISTER_COMBINERS.tree(text)
    stages = [_stage(found) for found in parts(tree, "stage")]
    _require(len(stages) <= _MOST_COMBINERS, "more general combiners than any machine has")
    nothing = {
        "rgb": _unused("RGB"),
        "alpha": _unused("ALPHA"),
        "constant_color0": None,
        "constant_color1": None,
    }
    final, clamped = _final(tree)
    constants = _constants(tree)
    return {
        "general": stages or [nothing],
        "final": final,
        "constant_color0": constants.get("const0", (0.0,) * 4),
        "constant_color1": constants.get("const1", (0.0,) * 4),
        "color_sum_clamp": clamped,
    }


# --------------------------------------------------------------------------------------- texture shaders

# What the last instruction of each group does, and the one before it where that looks up too.
_LAST_OF_GROUP = {
    "2d": "DOT_PRODUCT_TEXTURE_2D",
    "rectangle": "DOT_PRODUCT_TEXTURE_RECTANGLE",
    "depth_replace": "DOT_PRODUCT_DEPTH_REPLACE",
    "3d": "DOT_PRODUCT_TEXTURE_3D",
    "cube_map": "DOT_PRODUCT_TEXTURE_CUBE_MAP",
    "reflect_cube_map_eye_from_qs": "DOT_PRODUCT_REFLECT_CUBE_MAP",
    "reflect_cube_map_const_eye": "DOT_PRODUCT_CONST_EYE_REFLECT_CUBE_MAP",
}
_WITHOUT_RESULT = ("NONE", "CULL_FRAGMENT", "DOT_PRODUCT", "DOT_PRODUCT_DEPTH_REPLACE")


def texture_shaders(text):
    """The stages of a ``!!TS1.0`` text: what each operation reads, and nothing else.

    Source: NV_texture_shader, its tables 3.A to 3.C: which stages read which, in which order.
    """
    stages, rows, eye = [], [], None
    for instruction in parts(TEXTURE_SHADERS.tree(text), "instruction"):
        tree = instruction[1]
        name, unit = tree[1], len(stages)
        _require(unit < _MOST_UNITS, "more instructions than texture units")
        group, _, row = name.removeprefix("dot_product_").rpartition("_")
        if tree[0] not in ("dot", "eye"):
            _require(not rows, "a group that is not whole")
            stages.append(_single(tree, name))
        else:
            _require(row[0] == str(len(rows) + 1) and all(group == g for g in rows), "rows out of order")
            rows.append(group)
            mapped = part(tree, "mapped")
            stage = {
                "operation": "DOT_PRODUCT",
                "previous_texture_input": int(part(mapped, "texel")[1][3]),
                "dot_product_mapping": "EXPAND_NORMAL" if "expand" in mapped else "UNSIGNED_IDENTITY",
            }
            eye = _numbers(tree) or eye
            both = group.startswith("cube_map_and_")
            if both and len(rows) == 2:
                stage["operation"] = "DOT_PRODUCT_DIFFUSE_CUBE_MAP"
            if len(rows) == int(row[3]):
                stage["operation"] = _LAST_OF_GROUP[group.removeprefix("cube_map_and_") if both else group]
                if stage["operation"] == "DOT_PRODUCT_CONST_EYE_REFLECT_CUBE_MAP":
                    stage["constant_eye"] = eye
                rows = []
            stages.append(stage)
        previous = stages[unit].get("previous_texture_input")
        if previous is not None:
            _require(previous < unit, "a later unit")
            _require(stages[previous]["operation"] not in _WITHOUT_RESULT, "a stage without a result")
            looked_up = stages[previous]["operation"] == "DOT_PRODUCT_DIFFUSE_CUBE_MAP"
            _require(not (looked_up and previous == unit - 1 and row == "3of3"), "its own row's texel")
    _require(not rows, "a group that is not whole")
    replaced = [stage["operation"] for stage in stages].count("DOT_PRODUCT_DEPTH_REPLACE")
    _require(replaced < 2, "two depths")
    return stages


def _single(tree, name):
    if tree[0] == "plain":
        return {"operation": "NONE" if name == "nop" else name.upper()}
    if tree[0] == "cull":
        modes = tuple({"G": "GEQUAL", "L": "LESS"}[found[1][0]] for found in parts(tree, "condition"))
        return {"operation": "CULL_FRAGMENT", "cull_modes": modes}
    kind, _, shape = name.partition("_")
    stage = {"previous_texture_input": int(part(tree, "texel")[1][3])}
    if tree[0] == "dependent":
        return stage | {"operation": f"DEPENDENT_{shape.upper()}_TEXTURE_2D"}
    numbers = _numbers(tree)
    stage |= {"operation": f"{kind}_TEXTURE_{shape}".upper(), "offset_texture_matrix": numbers[:4]}
    if tree[0] == "scaled_offset":
        stage |= {"offset_texture_scale": numbers[4], "offset_texture_bias": numbers[5]}
    return stage


# ---------------------------------------------------------------------------------------- pixel shaders

_SINCE = {
    "1.2": ("dp4", "cmp", "texreg2rgb", "texdp3", "texdp3tex", "texm3x3"),
    "1.3": ("texm3x2depth",),
}
_SELECTED = {"a": "a", "w": "a", "b": "b", "z": "b"}


def pixel_shader(text):
    """What a ``ps.1.x`` text says: version, constants, texture instructions, and pairs of arithmetic ones."""
    tree = PIXEL_SHADER.tree(text)
    version = tree[1][2:].strip("._").replace("_", ".")
    constants = {int(found[2][1]): _numbers(found) for found in parts(tree, "definition")}
    texture = [
        {
            "name": found[1],
            "unit": int(part(found, "place")[1][1]),
            "sources": list(map(_source, parts(found, "source"))),
        }
        for found in parts(tree, "texture")
    ]
    units = [instruction["unit"] for instruction in texture]
    _require(len(set(units)) == len(units), "a texture register given twice")
    pairs = [list(map(_arithmetic, parts(found, "arithmetic"))) for found in parts(tree, "pair")]
    combiners = sum(2 if pair[0]["name"] in ("dp4", "cmp") else 1 for pair in pairs)
    _require(combiners <= _MOST_COMBINERS, "more general combiners than any machine has")
    for instruction in (*texture, *(i for pair in pairs for i in pair)):
        for since, names in _SINCE.items():
            _require(instruction["name"] not in names or version >= since, "an instruction of later versions")
    return {"version": version, "constants": constants, "texture": texture, "pairs": pairs}


def _arithmetic(tree):
    name, *changes = tree[1].split("_")
    register, _, mask = part(tree, "target")[1].partition(".")
    return {
        "name": name,
        "scale": next((change for change in changes if change != "sat"), ""),
        "saturate": "sat" in changes,
        "register": register,
        "mask": {"rgb": "rgb", "xyz": "rgb", "a": "a", "w": "a"}.get(mask, "rgba"),
        "sources": list(map(_source, parts(tree, "source"))),
    }


def _source(tree):
    one = part(tree, "one")
    _require(not one or _number(one[1:]) == 1, "a number that is not one")
    name, _, selector = tree[-1].partition(".")
    register, _, modifier = name.partition("_")
    sign = "1-" if one else "-" if "-" in tree else ""
    _require(not (one and modifier), "a complement of a mapped register")
    return {
        "sign": sign,
        "register": register,
        "modifier": modifier,
        "selector": _SELECTED.get(selector[:1] if len(set(selector)) == 1 else ""),
    }


def lines_of(shader):
    """The shader's text with one instruction on each line, as ``tests.reference.pixel_shader`` reads it."""
    lines = [f"ps.{shader['version']}"]
    lines += [
        f"def c{number}, {', '.join(map(repr, color))}" for number, color in shader["constants"].items()
    ]
    for instruction in shader["texture"]:
        operands = [f"t{instruction['unit']}", *map(_written, instruction["sources"])]
        lines.append(f"{instruction['name']} {', '.join(operands)}")
    for pair in shader["pairs"]:
        for plus, i in zip(("", "+ "), pair, strict=False):
            changes = f"{i['scale'] and '_' + i['scale']}{'_sat' if i['saturate'] else ''}"
            target = i["register"] + ("" if i["mask"] == "rgba" else f".{i['mask']}")
            lines.append(f"{plus}{i['name']}{changes} {', '.join([target, *map(_written, i['sources'])])}")
    return "\n".join(lines) + "\n"


def _written(source):
    modifier = source["modifier"] and "_" + source["modifier"]
    selector = "." + source["selector"] if source["selector"] else ""
    return f"{source['sign']}{source['register']}{modifier}{selector}"
