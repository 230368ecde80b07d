"""The words of the rules' formulas (effects/arithmetic), and how their vectors are read."""

import math
import struct

from tests.reference import fixed, lighting_unit

# What the formulas call, by name: arguments, and an expression of them.
DEFINITIONS = {
    "clamp": ("x, low, high", "max(low, min(x, high))"),
    "rn": ("n", "floor(n / 255 + 1 / 2)"),
    "scaled": (
        "x, scale",
        "{'NONE': x, 'SCALE_BY_TWO': 2 * x, 'SCALE_BY_FOUR': 4 * x, 'SCALE_BY_ONE_HALF': x + 1 >> 1}[scale]",
    ),
    "signed": ("v", "v - 256 if v > 127 else v"),
    "signed16": ("v", "v - 65536 if v > 32767 else v"),
    "widen": ("v, bits", "v << 8 - bits | v >> 2 * bits - 8"),
    "step": ("p, q, f", "p * (256 - f) + q * f + 128 >> 8"),
    "nearest": ("v", "floor(v + 1 / 2)"),
    "line": (
        "nodes, j, f",
        "nearest(nodes[j]) * (64 - f) + nearest(nodes[j + 1]) * f + 32 >> 6",
    ),
    "between": ("nodes, x", "0 if x >= 2048 else line(nodes, x >> 6, x & 63)"),
    "third": ("x, y", "floor(sqrt(max(2 ** 30 - x * x - y * y, 0))) / 32768"),
    "hemisphere": (
        "high, low",
        "[signed16(high) / 32767, signed16(low) / 32767, third(signed16(high), signed16(low))]",
    ),
    "area": ("x, y", "(x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0])"),
    "slope": ("a, b, v", "(v[1] - v[0]) * (b[2] - b[0]) - (v[2] - v[0]) * (b[1] - b[0])"),
    "dvdx": ("x, y, v", "slope(x, y, v) * 16.0 / area(x, y)"),
    "dvdy": ("x, y, v", "-slope(y, x, v) * 16.0 / area(x, y)"),
    "compare": (
        "a, function, b",
        "{'NEVER': False, 'LESS': a < b, 'EQUAL': a == b, 'LEQUAL': a <= b, 'GREATER': a > b, "
        "'NOTEQUAL': a != b, 'GEQUAL': a >= b, 'ALWAYS': True}[function]",
    ),
}
# What an expression would not say better.
IN_WORDS = {
    "T14(v), T24(v)": "v cut toward zero to so many significant bits",
    "reciprocal(w)": "the rule of that name",
    "floor, trunc, sqrt, min, max, abs": "as in mathematics; `>>` goes to the whole number below",
}


def words():
    """The functions that formulas call, by name."""
    known = {
        "floor": math.floor,
        "trunc": math.trunc,
        "sqrt": math.sqrt,
        "log2": math.log2,
        "T14": lambda v: fixed.keep_significant_bits(v, 14),
        "T24": lambda v: fixed.keep_significant_bits(v, 24),
        "reciprocal": lambda w: float(lighting_unit.transform_reciprocal(lighting_unit.Fraction(w))),
    }
    for name, (arguments, text) in DEFINITIONS.items():
        known[name] = eval(f"lambda {arguments}: {text}", known)
    return known


def number_of(text):
    """The number that a string of hexadecimal digits holds: eight are single precision, sixteen double."""
    if text == "NaN":
        return math.nan
    data = bytes.fromhex(text.removeprefix("0x"))
    return struct.unpack({4: ">f", 8: ">d"}[len(data)], data)[0]


_READ = {"int": int, "name": str, "bytes": bytes.fromhex, "single": number_of, "double": number_of}


def decoded(kind, value):
    """A value of a vector from what JSON has of it."""
    base, bracket, _ = kind.partition("[")
    return [_READ[base](each) for each in value] if bracket else _READ[base](value)


def same(a, b):
    """Whether two values are equal to the bit: zeros of one sign, NaN like NaN."""
    if isinstance(a, list | tuple):
        return len(a) == len(b) and all(map(same, a, b))
    if isinstance(a, float) or isinstance(b, float):
        nothing = math.isnan(a) and math.isnan(b)
        return nothing or (a == b and math.copysign(1.0, a) == math.copysign(1.0, b))
    return a == b
