"""Register combiners in exact numbers, by the extension's definitions: no bytes, no rounding.

What is evaluated is ``notation_states.register_combiners``'s dict. ``rules``: names of RULES, by which the
ideal departs from the definition. Fog is disabled: its color is zero, its factor one.

Source: NV_register_combiners, section 3.8.12 and tables 4 to 6.
"""

from fractions import Fraction

HALF, ONE = Fraction(1, 2), Fraction(1)
RULES = {
    "unbounded": "nothing is clamped to [-1, 1] between the general combiners",
    "sum kept": "SPARE0 + SECONDARY_COLOR is kept beyond 1, whatever the program says of its clamp",
}


def clamp(x, low, high):
    """The nearest number of a range. Source: NV_register_combiners section 3.8.12."""
    return max(low, min(high, x))


def _mapped(x, mapping):
    """Source: NV_register_combiners table 4."""
    positive = max(Fraction(0), x)
    return {
        "UNSIGNED_IDENTITY": positive,
        "UNSIGNED_INVERT": 1 - clamp(x, 0, 1),
        "EXPAND_NORMAL": 2 * positive - 1,
        "EXPAND_NEGATE": 1 - 2 * positive,
        "HALF_BIAS_NORMAL": positive - HALF,
        "HALF_BIAS_NEGATE": HALF - positive,
        "SIGNED_IDENTITY": x,
        "SIGNED_NEGATE": -x,
    }[mapping]


def _read(registers, variable, k):
    """A variable's component, mapped. Source: NV_register_combiners section 3.8.12.2 (component usage)."""
    register, mapping, usage = variable
    return _mapped(registers[register][{"RGB": k, "ALPHA": 3, "BLUE": 2}[usage]], mapping)


def _portion(registers, portion, components, rules):
    """[(register, component, value)] of what a portion writes. Source: section 3.8.12.2, table 5."""
    products = {}
    for first, second, dot in (("a", "b", "ab_dot_product"), ("c", "d", "cd_dot_product")):
        values = [
            _read(registers, portion[first], k) * _read(registers, portion[second], k) for k in components
        ]
        products[first] = [sum(values)] * len(values) if portion.get(dot) else values
    ab, cd = products["a"], products["c"]
    total = [x + y for x, y in zip(ab, cd, strict=True)]
    if portion["mux_sum"]:
        total = cd if registers["SPARE0"][3] >= HALF else ab
    factor = {"NONE": 1, "SCALE_BY_TWO": 2, "SCALE_BY_FOUR": 4, "SCALE_BY_ONE_HALF": HALF}[portion["scale"]]
    bias = HALF if portion["bias"] == "BIAS_BY_NEGATIVE_ONE_HALF" else 0
    written = []
    for output, values in (("ab_output", ab), ("cd_output", cd), ("sum_output", total)):
        for k, x in zip(components, values, strict=True):
            value = (x - bias) * factor
            written.append((portion[output], k, value if "unbounded" in rules else clamp(value, -1, 1)))
    return written


def _constant(color):
    """Source: CombinerParameterfvNV clamps a constant color to [0, 1]."""
    return [clamp(Fraction(x), 0, 1) for x in color]


def evaluate(combiners, inputs, rules=frozenset()):
    """The fragment's color, four numbers in [0, 1]. ``inputs``: {"t0": four numbers ..., "v1": ...}.

    Source: NV_register_combiners sections 3.8.12.1 to 3.8.12.3, table 6; NV_register_combiners2.
    """
    registers = {f"TEXTURE{unit}": list(map(Fraction, inputs[f"t{unit}"])) for unit in range(4)}
    registers |= {"PRIMARY_COLOR": list(map(Fraction, inputs["v0"]))}
    registers |= {"SECONDARY_COLOR": list(map(Fraction, inputs["v1"]))}
    registers |= {"ZERO": [Fraction(0)] * 4, "FOG": [Fraction(0)] * 3 + [ONE], "SPARE1": [Fraction(0)] * 4}
    registers["SPARE0"] = [Fraction(0)] * 3 + [registers["TEXTURE0"][3]]
    for stage in combiners["general"]:
        for name in ("constant_color0", "constant_color1"):
            given = combiners[name] if stage[name] is None else stage[name]
            registers[name.upper()] = _constant(given)
        written = _portion(registers, stage["rgb"], (0, 1, 2), rules)
        written += _portion(registers, stage["alpha"], (3,), rules)
        for register, k, value in written:
            if register != "DISCARD":
                registers[register][k] = value
    for name in ("constant_color0", "constant_color1"):
        registers[name.upper()] = _constant(combiners[name])
    final = combiners["final"]
    totals = [
        sum(max(Fraction(0), registers[name][k]) for name in ("SPARE0", "SECONDARY_COLOR")) for k in range(3)
    ]
    if combiners["color_sum_clamp"] and "sum kept" not in rules:
        totals = [min(ONE, x) for x in totals]
    registers["SPARE0_PLUS_SECONDARY_COLOR"] = [*totals, Fraction(0)]
    registers["E_TIMES_F"] = [
        _read(registers, final["e"], k) * _read(registers, final["f"], k) for k in range(3)
    ]
    registers["E_TIMES_F"].append(Fraction(0))
    color = []
    for k in range(3):
        a, b, c, d = (_read(registers, final[variable], k) for variable in "abcd")
        a = min(ONE, a)
        color.append(clamp(a * b + (1 - a) * c + d, 0, 1))
    return [*color, clamp(_read(registers, final["g"], 3), 0, 1)]
