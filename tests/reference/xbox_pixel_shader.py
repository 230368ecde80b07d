"""The Xbox's pixel shaders by the definition of their instructions, a fragment at a time, in whole numbers.

It reads the text itself, line by line, and knows nothing of register combiners. Registers hold numbers in
units of 1/255, from -256 to 255.

Source: what xmma and its kin compute, as Cxbx-Reloaded's listings say; numbers.md section 8 for the NV2A's
rounding, its half of 128 and its range (Measured).
"""

import re

ONE, HALF, LOWEST = 255, 128, -256
# Instruction: how many destinations.
DESTINATIONS = {"xmma": 3, "xmmc": 3, "xdm": 2, "xdd": 2, "xfc": 0}
MASKS = {"": (0, 1, 2, 3), "rgba": (0, 1, 2, 3), "rgb": (0, 1, 2), "a": (3,)}
# A result, of the rounded sum of products, before it is clamped.
RESULTS = {
    "": lambda x: x,
    "x2": lambda x: 2 * x,
    "x4": lambda x: 4 * x,
    "d2": lambda x: (x + 1) >> 1,
    "bias": lambda x: x - HALF,
    "bx2": lambda x: 2 * (x - HALF),
}


def _clamped(value):
    """Source: UNSIGNED_IDENTITY and the framebuffer's range: [0, 1]."""
    return max(0, min(ONE, value))


def _rounded(products):
    """A sum of products, in 1/255**2, to the nearest 1/255. Measured: numbers.md section 8."""
    return (2 * products + ONE) // (2 * ONE)


def _source(registers, text):
    """Four components. Source: ``.b`` is blue for alpha alone, by words that an assembler made of it."""
    text = text.replace(" ", "")
    if text in ("0", "1"):
        return [ONE * int(text)] * 4
    sign, name, modifier, selector = re.fullmatch(
        r"(1-|-)?([a-z]+\d*)(?:_(bias|bx2|sat))?(?:\.(\w+))?", text
    ).groups()
    values = list(registers[name])
    if selector == "a":
        values = [values[3]] * 4
    elif selector == "b":
        values[3] = values[2]
    mapped = {
        None: lambda v: v,
        "sat": _clamped,
        "bias": lambda v: max(0, v) - HALF,
        "bx2": lambda v: 2 * max(0, v) - 2 * HALF,
    }[modifier]
    values = [mapped(v) for v in values]
    if sign == "1-":
        return [ONE - _clamped(v) for v in values]
    return [min(ONE, -v) for v in values] if sign else values


def _times(x, y):
    """Source: mul."""
    return [p * q for p, q in zip(x, y, strict=True)]


def _plus(x, y):
    """Source: add."""
    return [p + q for p, q in zip(x, y, strict=True)]


def _dot(x, y):
    """Source: dp3: of red, green and blue, for all four."""
    return [sum(_times(x, y)[:3])] * 4


def _products(name, sources, condition):
    """Four components in 1/255**2 of each destination's value. Source: the reference of ps.1.x for what it
    shares; Cxbx-Reloaded's listings for xmma, xdm and xdd; the mux of NV_register_combiners for xmmc.
    """
    a, b, c, d = (*sources, *([0] * 4,) * 4)[:4]
    one = [ONE] * 4
    if name == "lrp":
        factor = [_clamped(v) for v in a]
        return (_plus(_times(factor, b), _times([ONE - v for v in factor], c)),)
    return {
        "mov": lambda: (_times(a, one),),
        "mul": lambda: (_times(a, b),),
        "add": lambda: (_times(_plus(a, b), one),),
        "sub": lambda: (_times(_plus(a, [min(ONE, -v) for v in b]), one),),
        "mad": lambda: (_plus(_times(a, b), _times(c, one)),),
        "dp3": lambda: (_dot(a, b),),
        "cnd": lambda: (_times(b if condition else c, one),),
        "xmma": lambda: (_times(a, b), _times(c, d), _plus(_times(a, b), _times(c, d))),
        "xmmc": lambda: (_times(a, b), _times(c, d), _times(c, d) if condition else _times(a, b)),
        "xdm": lambda: (_dot(a, b), _times(c, d)),
        "xdd": lambda: (_dot(a, b), _dot(c, d)),
    }[name]()


def _final(registers, sources):
    """The fragment's color of xfc, all of whose inputs are in [0, 1]. Source: NV_register_combiners' final
    combiner; Source: that its sum is clamped, by an assembler's words.
    """
    registers = {name: [_clamped(v) for v in values] for name, values in registers.items()}
    read = [_source(registers, text) for text in sources[4:6]]
    registers["prod"] = [_rounded(x * y) for x, y in zip(*read, strict=True)]
    registers["sum"] = [min(ONE, x + y) for x, y in zip(registers["r0"], registers["v1"], strict=True)]
    a, b, c, d = (_source(registers, text) for text in sources[:4])
    g = _source(registers, sources[6])
    color = [min(ONE, _rounded(w * x + (ONE - w) * y) + z) for w, x, y, z in zip(a, b, c, d, strict=True)]
    return [*color[:3], g[3]]


def evaluate(text, textures, primary, secondary, fog):
    """The fragment's four bytes. Texture instructions are passed over: ``textures`` are their results.
    ``fog``: its color and, last, its factor. Without xfc r0 is shown, and ``fog`` has to be none. Source: a
    pair's instructions read before either writes, as in ps.1.x.
    """
    registers = {f"t{i}": list(texel) for i, texel in enumerate(textures)} | {
        "zero": [0] * 4,
        "one": [ONE] * 4,
    }
    registers |= {"v0": list(primary), "v1": list(secondary), "r0": [0] * 4, "r1": [0] * 4, "fog": list(fog)}
    registers["r0"][3] = textures[0][3]
    pending = {}
    for line in filter(None, (line.split(";")[0].strip() for line in text.splitlines()[1:])):
        opcode, _, operands = line.lstrip("+ ").partition(" ")
        operands = [operand.strip() for operand in operands.split(",")]
        name, _, modifier = opcode.partition("_")
        if name == "def":
            registers[operands[0]] = [int(ONE * _clamped_one(float(c)) + 0.5) for c in operands[1:]]
        if name == "def" or name.startswith("tex"):
            continue
        if not line.startswith("+"):
            _write(registers, pending)
        if name == "xfc":
            return _final(registers, operands)
        count = DESTINATIONS.get(name, 1)
        sources = [_source(registers, operand) for operand in operands[count:]]
        results = _products(name, sources, registers["r0"][3] >= HALF)
        for destination, products in zip(operands[:count], results, strict=True):
            register, _, mask = destination.partition(".")
            for k in MASKS[mask]:
                value = RESULTS[modifier](_rounded(products[k]))
                pending[register, k] = max(LOWEST, min(ONE, value))
    _write(registers, pending)
    return [_clamped(value) for value in registers["r0"]]


def _clamped_one(value):
    """Source: def, whose colors are bytes without a sign."""
    return max(0.0, min(1.0, value))


def _write(registers, pending):
    """What a pair computed, once both are done. Source: destination write masks."""
    for (name, k), value in pending.items():
        if name != "discard":
            registers[name][k] = value
    pending.clear()
