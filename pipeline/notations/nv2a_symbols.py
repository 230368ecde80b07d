"""Names of the NV2A's combiner words in C programs, and expressions of these names.

    PS_COMBINERINPUTS(PS_REGISTER_T0 | PS_CHANNEL_RGB, PS_REGISTER_V0, 0, 0)
    MASK(NV097_SET_COMBINER_COLOR_ICW_A_SOURCE, 0x8) | (1u << 28)

Source: PS_* as public trees of Xbox emulators list them (Cxbx-Reloaded's XbPixelShader.h, xemu's psh.c);
NV097_* and MASK as nxdk's nv_regs.h and pbkit.h do; D3DCOLOR_* of d3d8types.h.
"""

import operator
import re

_MAPPINGS = (
    *("UNSIGNED_IDENTITY", "UNSIGNED_INVERT", "EXPAND_NORMAL", "EXPAND_NEGATE", "HALFBIAS_NORMAL"),
    *("HALFBIAS_NEGATE", "SIGNED_IDENTITY", "SIGNED_NEGATE"),
)
_OPERATIONS = {
    "NOSHIFT": 0,
    "NOSHIFT_BIAS": 1,
    "SHIFTLEFTBY1": 2,
    "SHIFTLEFTBY1_BIAS": 3,
    "SHIFTLEFTBY2": 4,
    "SHIFTRIGHTBY1": 6,
}
_REGISTERS = {
    **{"ZERO": 0, "DISCARD": 0, "C0": 1, "C1": 2, "FOG": 3, "V0": 4, "V1": 5, "T0": 8, "T1": 9, "T2": 10},
    **{"T3": 11, "R0": 12, "R1": 13, "V1R0_SUM": 14, "EF_PROD": 15, "ONE": 0x20, "NEGATIVE_ONE": 0x40},
    **{"ONE_HALF": 0xA0, "NEGATIVE_ONE_HALF": 0x80},
}
_TEXTURE_MODES = (
    *("NONE", "PROJECT2D", "PROJECT3D", "CUBEMAP", "PASSTHRU", "CLIPPLANE", "BUMPENVMAP"),
    *("BUMPENVMAP_LUM", "BRDF", "DOT_ST", "DOT_ZW", "DOT_RFLCT_DIFF", "DOT_RFLCT_SPEC", "DOT_STR_3D"),
    *("DOT_STR_CUBE", "DPNDNT_AR", "DPNDNT_GB", "DOTPRODUCT", "DOT_RFLCT_SPEC_CONST"),
)
_DIRECT3D = {
    "REGISTER": _REGISTERS,
    "CHANNEL": {"RGB": 0, "BLUE": 0, "ALPHA": 0x10},
    "INPUTMAPPING": {name: k << 5 for k, name in enumerate(_MAPPINGS)},
    "FINALCOMBINERSETTING": {"CLAMP_SUM": 0x80, "COMPLEMENT_V1": 0x40, "COMPLEMENT_R0": 0x20},
    "COMBINEROUTPUT": {
        **{"IDENTITY": 0, "BIAS": 0x08, "SHIFTLEFT_1": 0x10, "SHIFTLEFT_1_BIAS": 0x18, "SHIFTLEFT_2": 0x20},
        **{"SHIFTRIGHT_1": 0x30, "AB_BLUE_TO_ALPHA": 0x80, "CD_BLUE_TO_ALPHA": 0x40, "AB_MULTIPLY": 0},
        **{"AB_DOT_PRODUCT": 2, "CD_MULTIPLY": 0, "CD_DOT_PRODUCT": 1, "AB_CD_SUM": 0, "AB_CD_MUX": 4},
    },
    "COMBINERCOUNT": {
        **{"MUX_LSB": 0, "MUX_MSB": 1, "SAME_C0": 0},
        **{"UNIQUE_C0": 0x10, "SAME_C1": 0, "UNIQUE_C1": 0x100},
    },
    "COMPAREMODE": {
        f"{component}_{test}": value << bit
        for bit, component in enumerate("STRQ")
        for value, test in enumerate(("LT", "GE"))
    },
    "DOTMAPPING": {
        **{"ZERO_TO_ONE": 0, "MINUS1_TO_1_D3D": 1, "MINUS1_TO_1_GL": 2, "MINUS1_TO_1": 3, "HILO_1": 4},
        **{"HILO_HEMISPHERE_D3D": 5, "HILO_HEMISPHERE_GL": 6, "HILO_HEMISPHERE": 7},
    },
    "TEXTUREMODES": {name: value for value, name in enumerate(_TEXTURE_MODES)},
}
_STAGE_PROGRAMS = (
    *("PROGRAM_NONE", "2D_PROJECTIVE", "3D_PROJECTIVE", "CUBE_MAP", "PASS_THROUGH"),
    *("CLIP_PLANE", "BUMPENVMAP", "BUMPENVMAP_LUMINANCE", "BRDF", "DOT_ST"),
    *("DOT_ZW", "DOT_REFLECT_DIFFUSE", "DOT_REFLECT_SPECULAR", "DOT_STR_3D", "DOT_STR_CUBE"),
    *("DEPENDENT_AR", "DEPENDENT_GB", "DOT_PRODUCT", "DOT_REFLECT_SPECULAR_CONST"),
)
_COUNTS = ("ONE", "TWO", "THREE", "FOUR", "FIVE", "SIX", "SEVEN", "EIGHT")
_SWITCH = {"FALSE": 0, "TRUE": 1}


def _fields():
    """(name without NV097_, mask, {name of a value: value}) of every field of the words."""
    registers = {f"REG_{code:X}": code for code in range(16)} | {"REG_SPECLIT": 14, "REG_EF_PROD": 15}
    for word, variables, mapping in (
        ("SET_COMBINER_COLOR_ICW", "ABCD", "MAP"),
        ("SET_COMBINER_ALPHA_ICW", "ABCD", "MAP"),
        ("SET_COMBINER_SPECULAR_FOG_CW0", "ABCD", "INVERSE"),
        ("SET_COMBINER_SPECULAR_FOG_CW1", "EFG", "INVERSE"),
    ):
        for k, variable in enumerate(variables):
            shift = 24 - 8 * k
            names = {name: k for k, name in enumerate(_MAPPINGS)} if mapping == "MAP" else _SWITCH
            yield f"{word}_{variable}_{mapping}", 7 << shift + 5, names
            yield f"{word}_{variable}_ALPHA", 1 << shift + 4, _SWITCH
            yield f"{word}_{variable}_SOURCE", 15 << shift, registers
    for half in ("COLOR", "ALPHA"):
        word = f"SET_COMBINER_{half}_OCW"
        yield f"{word}_OP", 7 << 15, _OPERATIONS
        yield f"{word}_MUX_ENABLE", 1 << 14, _SWITCH
        for shift, name in ((8, "SUM"), (4, "AB"), (0, "CD")):
            yield f"{word}_{name}_DST", 15 << shift, registers
    for shift, name in ((13, "AB"), (12, "CD")):
        yield f"SET_COMBINER_COLOR_OCW_{name}_DOT_ENABLE", 1 << shift, _SWITCH
    for shift, name in ((19, "AB"), (18, "CD")):
        values = {"DISABLE": 0, f"{name}_DST_ENABLE": 1}
        yield f"SET_COMBINER_COLOR_OCW_BLUETOALPHA_{name}", 1 << shift, values
    for bit, name in ((7, "CLAMP"), (6, "ADD_INVERT_R5"), (5, "ADD_INVERT_R12")):
        yield f"SET_COMBINER_SPECULAR_FOG_CW1_SPECULAR_{name}", 1 << bit, _SWITCH
    counts = {name: k for k, name in enumerate(_COUNTS, 1)}
    yield "SET_COMBINER_CONTROL_ITERATION_COUNT", 0xFF, counts
    yield "SET_COMBINER_CONTROL_MUX_SELECT", 0xF00, {"LSB": 0, "MSB": 1}
    for mask, name in ((0xF000, "FACTOR0"), (0xFFFF0000, "FACTOR1")):
        yield f"SET_COMBINER_CONTROL_{name}", mask, {"SAME_FACTOR_ALL": 0, "EACH_STAGE": 1}
    for stage in range(4):
        modes = {name: k for k, name in enumerate(_STAGE_PROGRAMS)}
        yield f"SET_SHADER_STAGE_PROGRAM_STAGE{stage}", 31 << 5 * stage, modes
    for stage, mask in ((1, 0xFFFF), (2, 0xF0000), (3, 0xF00000)):
        inputs = {f"INSTAGE_{k}": k for k in range(stage)}
        yield f"SET_SHADER_OTHER_STAGE_INPUT_STAGE{stage}", mask, inputs


_SYMBOLS = {f"PS_{kind}_{name}": value for kind, names in _DIRECT3D.items() for name, value in names.items()}
for _field, _mask, _values in _fields():
    _SYMBOLS[f"NV097_{_field}"] = _mask
    _SYMBOLS |= {f"NV097_{_field}_{name}": value for name, value in _values.items()}

# The lowest bit of each argument of a function.
_SHIFTS = {
    "PS_COMBINERINPUTS": (24, 16, 8, 0),
    "PS_COMBINEROUTPUTS": (4, 0, 8, 12),
    "PS_COMBINERCOUNT": (0, 8),
    "PS_TEXTUREMODES": (0, 5, 10, 15),
    "PS_COMPAREMODE": (0, 4, 8, 12),
    "PS_DOTMAPPING": (None, 0, 4, 8),
    "PS_INPUTTEXTURE": (None, None, 16, 20),
    "D3DCOLOR_ARGB": (24, 16, 8, 0),
    "D3DCOLOR_RGBA": (16, 8, 0, 24),
    "D3DCOLOR_XRGB": (16, 8, 0),
}
# MASK(field, value), under the names that programs give it.
_MASK = re.compile(r"(?:[A-Z]+_)?MASK")
# The higher number binds more tightly, as in C.
_BINARY = {
    "|": (1, operator.or_),
    "^": (2, operator.xor),
    "&": (3, operator.and_),
    "<<": (4, operator.lshift),
    ">>": (4, operator.rshift),
    "+": (5, operator.add),
    "-": (5, operator.sub),
    "*": (6, operator.mul),
}
_TOKEN = re.compile(
    r"(?P<number>0[xX][0-9a-fA-F]+(?=[uUlL]*(?![\w.]))|[0-9]+(?=[uUlL]*(?![\w.])))[uUlL]*"
    r"|(?P<name>[A-Za-z_]\w*)|(?P<operator><<|>>|[|^&+\-*~(),])|(?P<other>[0-9][\w.]*|\S)"
)
_WORD = 0xFFFFFFFF
# Assumed: no historical program nests deeper, or has larger numbers before they are cut to words.
_DEEPEST, _LARGEST = 40, 1 << 64


class NoValue(Exception):  # noqa: N818 (it says what was found, and its reader makes an error of it)
    """The text at ``at`` is no value; ``found`` describes it."""

    def __init__(self, at, found):
        super().__init__(found)
        self.at, self.found = at, found


def number_of(text, at=0):
    """The value of a number in C's notation. Raises NoValue for one whose base is not clear."""
    if text[:2] in ("0x", "0X"):
        return int(text[2:][:40] or "0", 16)
    if text[0] == "0" and text.strip("0"):
        raise NoValue(at, f"{text[:20]}, a number whose base is not clear")
    return int(text[:40])


class Expression:
    """Reads one value, an expression of C, from a text: ``value``, which ends at ``end``.

    Raises NoValue for other text: a variable, an unknown name, a condition.
    """

    def __init__(self, text, at):
        self.text, self.end = text, at
        self.open = 0
        self.value = self._binary(0, 0)
        following = self._peek()
        if following and following["other"] and following["other"] in "/%":
            raise NoValue(following.start(), f"an expression with {following['other']!r}")

    def _peek(self, over_lines=False):
        """The next token on this line, or on a later line with ``over_lines`` or in a parenthesis."""
        text, at = self.text, self.end
        while at < len(text) and text[at] in (" \t\n" if over_lines or self.open else " \t"):
            at += 1
        return _TOKEN.match(text, at)

    def _take(self, over_lines=True):
        token = self._peek(over_lines)
        if token is None:
            raise NoValue(self.end, "the end of the text")
        self.end = token.end()
        return token

    def _binary(self, least, depth):
        left = self._unary(depth)
        while True:
            token, possible = self._peek(), _BINARY
            if token is None:  # The line ends; a line that begins with one of these continues it.
                token, possible = self._peek(over_lines=True), ("|", "^", "<<")
            if token is None or token["operator"] not in possible:
                return left
            strength, apply = _BINARY[token["operator"]]
            if strength <= least:
                return left
            self.end = token.end()
            right = self._binary(strength, depth + 1)
            if "<" in token["operator"] or ">" in token["operator"]:
                right = min(max(right, 0), 32)
            left = apply(left, right)
            if abs(left) >= _LARGEST:
                raise NoValue(token.start(), "a number of more than 64 bits")

    def _unary(self, depth):
        if depth > _DEEPEST:
            raise NoValue(self.end, f"an expression of more than {_DEEPEST} levels")
        token = self._take()
        if token["number"]:
            return number_of(token["number"], token.start())
        if token["operator"] == "(":
            value = self._inside(depth)
            return value[0] if len(value) == 1 else self._wrong(token)
        if token["operator"] == "~":
            return ~self._unary(depth + 1) & _WORD
        if token["name"]:
            return self._named(token, depth)
        return self._wrong(token)

    def _wrong(self, token):
        raise NoValue(token.start(), repr(token[0][:40]))

    def _inside(self, depth):
        """The values in parentheses, after the opening one."""
        self.open += 1
        values = [self._binary(0, depth + 1)]
        while (token := self._take())["operator"] == ",":
            values.append(self._binary(0, depth + 1))
        self.open -= 1
        if token["operator"] != ")":
            self._wrong(token)
        return values

    def _named(self, token, depth):
        name = token["name"]
        following = self._peek()
        if following is None or following["operator"] != "(":
            if name not in _SYMBOLS:
                raise NoValue(token.start(), f"{name[:60]!r}, a name that has no value here")
            return _SYMBOLS[name]
        if name not in _SHIFTS and not _MASK.fullmatch(name):
            raise NoValue(token.start(), f"{name[:60]!r}, a function that is not known here")
        self.end = following.end()
        values = self._inside(depth)
        needed = len(_SHIFTS[name]) if name in _SHIFTS else 2
        if len(values) != needed:
            raise NoValue(token.start(), f"{name} of {len(values)} values, which takes {needed}")
        if name in _SHIFTS:
            word = 0xFF000000 if name == "D3DCOLOR_XRGB" else 0
            for value, shift in zip(values, _SHIFTS[name], strict=True):
                if not 0 <= value <= _WORD:
                    raise NoValue(token.start(), f"{name} of {value}, which is no word of 32 bits")
                word |= 0 if shift is None else value << shift
            return word
        mask, value = values
        if mask <= 0 or value < 0:
            raise NoValue(token.start(), f"{name} without a mask")
        return value * (mask & -mask) & mask
