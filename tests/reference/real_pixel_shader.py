"""Direct3D 8's pixel shaders 1.0 to 1.3 in exact numbers, by their definitions: no bytes, no rounding.

What is evaluated is ``notation_states.pixel_shader``'s dict. Registers keep [-1, 1], the least that the
definition asks for. ``rules``: names of RULES, by which the ideal departs from that.

Source: the DirectX 8.1 reference of pixel shaders: instructions, source modifiers, instruction modifiers;
D3DCAPS8.MaxPixelShaderValue, which is 1 or more.
"""

from fractions import Fraction

HALF = Fraction(1, 2)

# Where the ideal is not the definition, or is one of several that the definition allows.
RULES = {
    "unbounded": "nothing is clamped between instructions; MaxPixelShaderValue may be any number from 1 up",
    "half is above": "the mux takes its first value from 1/2 on (NV_register_combiners); cnd's is above 1/2",
    "negative is zero": "_bx2 and _bias take what is negative as zero (table 4 of the extension); Direct3D "
    "leaves them undefined there",
    "complement in range": "1- is of a number in [0, 1] (UNSIGNED_INVERT); Direct3D leaves others undefined",
    "weight in range": "lrp's weight is in [0, 1], as Direct3D asks of programs",
    "first alpha": "r0's alpha begins as texture 0's (NV_register_combiners); Direct3D refuses to read it",
}


def clamp(x, low, high):
    """The nearest number of a range. Source: _sat, and the range of registers."""
    return max(low, min(high, x))


def _source(source, registers, rules):
    """Four components, mapped. Source: source register modifiers and selectors."""
    values = registers[source["register"]]
    if source["selector"]:
        values = [values["rgba".index(source["selector"])]] * 4
    if source["modifier"]:
        if "negative is zero" in rules:
            values = [max(Fraction(0), x) for x in values]
        values = [2 * x - 1 if source["modifier"] == "bx2" else x - HALF for x in values]
    if source["sign"] == "1-":
        if "complement in range" in rules:
            values = [clamp(x, 0, 1) for x in values]
        return [1 - x for x in values]
    return [-x for x in values] if source["sign"] else values


def _result(name, a, b, c, registers, rules):
    """Four components. Source: each instruction's page."""
    if name == "mov":
        return a
    if name in ("add", "sub"):
        return [x + y if name == "add" else x - y for x, y in zip(a, b, strict=True)]
    if name == "mul":
        return [x * y for x, y in zip(a, b, strict=True)]
    if name == "mad":
        return [x * y + z for x, y, z in zip(a, b, c, strict=True)]
    if name == "lrp":
        weights = [clamp(x, 0, 1) for x in a] if "weight in range" in rules else a
        return [w * y + (1 - w) * z for w, y, z in zip(weights, b, c, strict=True)]
    if name in ("dp3", "dp4"):
        count = int(name[2])
        return [sum(x * y for x, y in zip(a[:count], b[:count], strict=True))] * 4
    if name == "cnd":
        first = registers["r0"][3] >= HALF if "half is above" in rules else registers["r0"][3] > HALF
        return b if first else c
    return [y if x >= 0 else z for x, y, z in zip(a, b, c, strict=True)]  # cmp


_SCALES = {"": Fraction(1), "x2": Fraction(2), "x4": Fraction(4), "d2": HALF}


def evaluate(shader, inputs, rules=frozenset()):
    """The fragment's color, four numbers in [0, 1]. ``inputs``: {"t0": four numbers ..., "v1": ...}.

    Source: the order of operations: source modifiers, instruction, scale, saturation, write mask; both of a
    pair read before either writes.
    """
    nothing = [Fraction(0)] * 4
    registers = {name: list(map(Fraction, color)) for name, color in inputs.items()}
    registers |= {"r0": list(nothing), "r1": list(nothing)} | {f"c{number}": nothing for number in range(8)}
    if "first alpha" in rules:
        registers["r0"][3] = registers["t0"][3]
    for number, color in shader["constants"].items():
        registers[f"c{number}"] = [clamp(Fraction(x), -1, 1) for x in color]
    for instruction in shader["texture"]:
        if instruction["name"] == "texcoord":
            registers[f"t{instruction['unit']}"][3] = Fraction(1)
    for pair in shader["pairs"]:
        written = []
        for i in pair:
            sources = [_source(source, registers, rules) for source in i["sources"]]
            values = _result(i["name"], *(*sources, nothing, nothing)[:3], registers, rules)
            values = [x * _SCALES[i["scale"]] for x in values]
            if "unbounded" not in rules:
                values = [clamp(x, -1, 1) for x in values]
            if i["saturate"]:
                values = [clamp(x, 0, 1) for x in values]
            written += [(i["register"], "rgba".index(k), values["rgba".index(k)]) for k in i["mask"]]
        for name, k, value in written:
            registers[name][k] = value
    return [clamp(x, 0, 1) for x in registers["r0"]]
