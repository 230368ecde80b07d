"""Direct3D 8's pixel shaders 1.0 to 1.3 from their definition, one fragment at a time: arithmetic alone.

It reads the text itself, line by line, and knows nothing of register combiners. Registers hold numbers in
units of 1/255, from ``lowest`` to 255.

Source: DirectX 8.1, reference of pixel shaders: each instruction, the modifiers, their order (source
modifiers, instruction, scale, saturation, write mask), the range of at least [-1, 1].
"""

import re
from fractions import Fraction
from math import floor

ONE = 255
COMPONENTS = {"rgb": (0, 1, 2), "xyz": (0, 1, 2), "a": (3,), "w": (3,)}


class Arithmetic:
    """Where a machine departs from real numbers.

    ``half``: what _bias and _bx2 take as one half, 127.5 by definition, 128 on NVIDIA's chips. ``rounded``:
    each instruction's result, the sum of its products, is rounded to nearest, before it is scaled; _d2 rounds
    halves up. ``lowest``: -255, or -256 for nine bits.
    """

    def __init__(self, half=128, rounded=True, lowest=-256):
        self.half, self.rounded, self.lowest = Fraction(half), rounded, lowest

    def result(self, total, scale):
        """A sum of products, in units of 1/255**2, as an instruction's result.

        Source: instruction modifiers; Measured: rounded before it is scaled (CombinerOps capture).
        """
        if self.rounded:
            # There are no ties: the sum is an integer and 255 is odd.
            value = (2 * int(total) + ONE) // (2 * ONE)
            value = {"": value, "x2": 2 * value, "x4": 4 * value, "d2": (value + 1) >> 1}[scale]
        else:
            value = Fraction(total) / ONE * {"": 1, "x2": 2, "x4": 4, "d2": Fraction(1, 2)}[scale]
        return max(self.lowest, min(ONE, value))


def constant(components, divided=False):
    """The color of a def, by its nearest steps. Red, green and blue of both signs, in one input, are a half
    less than bytes, from -128 to 127, or have even steps, up to 254; ``divided``: in two, each its own.

    Source: def; docs/numbers.md, byte(c): halves up; Inferred: eight bits without a sign, biased, expanded.
    """
    color = [max(-1, min(1, Fraction(c))) for c in components]
    steps = [floor(abs(c) * ONE + Fraction(1, 2)) * (-1 if c < 0 else 1) for c in color]
    if divided or not min(color[:3]) < 0 < max(color[:3]):
        return steps
    factor = 1 if ONE * min(color[:3]) >= -128 and ONE * max(color[:3]) <= 127 else 2
    held = [min(floor(ONE * c / factor + 128 + Fraction(1, 2)), ONE) for c in color[:3]]
    return [*(factor * (byte - 128) for byte in held), steps[3]]


def instruction(line):
    """(whether it is the second of a pair, name, modifiers, operands) of a line. Source: the grammar."""
    opcode, _, operands = line.split(";")[0].strip().lstrip("+ ").partition(" ")
    name, *modifiers = opcode.split("_")
    return line.strip().startswith("+"), name, modifiers, [operand.strip() for operand in operands.split(",")]


def group_of(lines, number):
    """The operands of instruction ``number`` and of its pair. Source: co-issued instructions."""
    first = number - lines[number][0]
    return [lines[k][3] for k in (first, first + 1) if k == first or (k < len(lines) and lines[k][0])]


def reads_alone(group):
    """Whether a pair, its operands, reads the color of but one constant: mov and mul then have inputs to
    spare for both signs. Source: NV_register_combiners, two constants, two products.
    """
    count = 0
    for destination, *sources in group:
        mask = destination.partition(".")[2]
        for source in (source for source in sources if "c" in source):
            selector = source.partition(".")[2]
            count += mask not in ("a", "w") and selector not in ("a", "w")
            count += mask in ("a", "w") and selector in ("b", "z")
    return count == 1


def negated(text):
    """A source with the other sign, by which sub subtracts: minus and minus cancel.

    Source: sub; that a source is negated before it is clamped matters to -256/255 alone, which becomes 1.
    """
    text = text.replace(" ", "")
    return text[1:] if text.startswith("-") else f"-{text}"


def read(registers, text, arithmetic, ones=()):
    """The four components of a source. Source: source register modifiers and selectors.

    ``ones``: texture registers whose alpha is the number 1 itself: _bx2 of it is 1, and _bias one half.
    """
    match = re.fullmatch(r"(-?1-|-)?([rctv]\d)(_bx2|_bias)?(?:\.(\w+))?", text.replace(" ", ""))
    sign, name, modifier, selector = match.groups()
    values = list(registers[name])
    if name in ones and modifier and selector in (None, "a", "w"):
        alpha = ONE if modifier == "_bx2" else arithmetic.half
        alpha = -alpha if sign == "-" else alpha
        plain = read(registers, text, arithmetic)
        return [alpha] * 4 if selector else [*plain[:3], alpha]
    if selector in ("a", "w"):
        values = [values[3]] * 4
    elif selector in ("b", "z"):
        values = [values[2]] * 4
    if modifier == "_bx2":
        values = [2 * max(0, v) - 2 * arithmetic.half for v in values]
    elif modifier == "_bias":
        values = [max(0, v) - arithmetic.half for v in values]
    if sign in ("1-", "-1-"):
        values = [ONE - max(0, min(ONE, v)) for v in values]
    if sign in ("-", "-1-"):
        values = [min(ONE, -v) for v in values]
    return values


def totals(name, sources, registers, arithmetic):
    """The four sums of products of an instruction, in units of 1/255**2. Source: its reference page."""
    a, b, c = (*sources, *([0, 0, 0, 0],) * 3)[:3]
    if name == "mov":
        return [x * ONE for x in a]
    if name == "mul":
        return [x * y for x, y in zip(a, b, strict=True)]
    if name in ("add", "sub"):
        return [(x + y) * ONE for x, y in zip(a, b, strict=True)]
    if name == "mad":
        return [x * y + z * ONE for x, y, z in zip(a, b, c, strict=True)]
    if name == "lrp":
        factors = [max(0, min(ONE, x)) for x in a]
        return [f * y + (ONE - f) * z for f, y, z in zip(factors, b, c, strict=True)]
    if name == "dp3":
        return [sum(x * y for x, y in zip(a[:3], b[:3], strict=True))] * 4
    if name == "dp4":
        # Two instruction slots: both halves of the sum are numbers of a register.
        color = arithmetic.result(sum(x * y for x, y in zip(a[:3], b[:3], strict=True)), "")
        return [(color + arithmetic.result(a[3] * b[3], "")) * ONE] * 4
    if name == "cnd":
        return [(y if 2 * registers["r0"][3] > ONE else z) * ONE for y, z in zip(b, c, strict=True)]
    if name == "cmp":
        return [(y if x >= 0 else z) * ONE for x, y, z in zip(a, b, c, strict=True)]
    raise ValueError(name)


def evaluate(text, textures, primary, secondary, arithmetic):
    """r0, clamped to [0, 1], of a program with one instruction on each line.

    ``textures``: four texels. Texture instructions are skipped, but for texcoord: its fourth component is 1.
    Source: the order of operations, and co-issued instructions, which read before either writes.
    """
    registers = {f"t{i}": list(texel) for i, texel in enumerate(textures)}
    registers |= {"v0": list(primary), "v1": list(secondary), "r0": [0] * 4, "r1": [0] * 4}
    pending, ones, divided = {}, set(), {}
    lines = [instruction(line) for line in text.splitlines()[1:] if line.split(";")[0].strip()]
    for number, (paired, name, modifiers, operands) in enumerate(lines):
        if name == "def":
            registers[operands[0]] = constant(operands[1:])
            divided[operands[0]] = constant(operands[1:], divided=True)
        if name == "texcoord":
            ones.add(operands[0])
            registers[operands[0]][3] = ONE
        if name in ("def", "nop") or name.startswith("tex"):
            continue
        if not paired:
            _write(registers, pending)
            ones -= {name for name, k in pending if k == 3}
            pending = {}
        destination, _, mask = operands[0].partition(".")
        if name == "sub":
            operands[2] = negated(operands[2])
        held = registers
        if name in ("mov", "mul") and reads_alone(group_of(lines, number)):
            held = registers | divided
        sources = [read(held, operand, arithmetic, ones) for operand in operands[1:]]
        if name == "sub" and operands[2].startswith("-1-"):
            # A complement has no negative: minus one is its factor. Inferred: ZERO expanded is minus one.
            sources[1] = [value * 2 * arithmetic.half / ONE for value in sources[1]]
        scale = next((m for m in modifiers if m != "sat"), "")
        values = totals(name, sources, registers, arithmetic)
        for k in COMPONENTS.get(mask, range(4)):
            value = arithmetic.result(values[k], scale)
            pending[destination, k] = max(0, value) if "sat" in modifiers else value
    _write(registers, pending)
    return [max(0, min(ONE, value)) for value in registers["r0"]]


def _write(registers, pending):
    """Source: destination write masks."""
    for (name, k), value in pending.items():
        registers[name][k] = value
