"""Vertex programs (NV_vertex_program1_1) as the NV2A runs them: text in, results of every vertex out.

    program = vertex_program("MUL o[HPOS], v[OPOS], c[0].x; MOV o[COL0], v[COL0];")
    results = program.run({"OPOS": positions, "COL0": colors}, {0: (2.0, 0.0, 0.0, 0.0)})

``VertexStage.PROGRAM_RESULTS`` draws the results. The NV2A adds to the extension: 192 constants; R12, which
reads the value written to o[HPOS]; and pairs of instructions, ``ADD R0, v[3], v[4] + RCP R1.x, v[3].x;``,
that read their operands before either writes. Numbers are the transform unit's (docs/numbers.md, section 2).

Source: NV_vertex_program, NV_vertex_program1_1; envytools (nvhw/xf.c).
"""

import re
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from fixedpipe.pipeline.vertices.chip_floats import (
    TRANSFORM_BITS,
    total,
    transform_inverse_root,
    transform_product,
    transform_reciprocal,
)
from fixedpipe.pipeline.vertices.transform_tables import exponential, exponential_parts, lit_power, logarithm
from fixedpipe.raster.floats import LEAST_SINGLE

TEMPORARIES, CONSTANTS = 12, 192
# The number of each input register. Source: NV097_SET_VERTEX_DATA_ARRAY_FORMAT's order.
INPUTS = {
    **{"OPOS": 0, "WGHT": 1, "NRML": 2, "COL0": 3, "COL1": 4, "FOGC": 5, "PSIZ": 6, "BFC0": 7, "BFC1": 8},
    **{"TEX0": 9, "TEX1": 10, "TEX2": 11, "TEX3": 12},
}
OUTPUTS = ("HPOS", "COL0", "COL1", "FOGC", "PSIZ", "BFC0", "BFC1", "TEX0", "TEX1", "TEX2", "TEX3")
_COMPONENTS = {"x": 0, "y": 1, "z": 2, "w": 3}
_DEFAULT = (0.0, 0.0, 0.0, 1.0)  # the components that an input lacks, and the missing inputs

# ------------------------------------------------------------------------------------------- instructions


def _pattern(column):
    """An integer that orders numbers as the unit does, with -0 before 0. Source: envytools (xf_islt)."""
    bits = np.asarray(column, np.float64).astype(np.float32).view(np.int32).astype(np.int64)
    return np.where(bits < 0, -(bits & 0x7FFFFFFF) - 1, bits)


def _less(a, b):
    return _pattern(a) < _pattern(b)


def _add(*terms):
    """The sum of the terms; infinities keep their signs. Source: envytools (xf_sum)."""
    exact = sum(terms)
    return np.where(np.isfinite(exact), total(terms, TRANSFORM_BITS), exact)


def _dot(a, b, components):
    return _add(*(transform_product(a[i], b[i]) for i in range(components)))


def _clamped_reciprocal(x):
    """RCC: a reciprocal of 2^-64 to 2^64 in magnitude. Source: NV_vertex_program1_1; envytools (xf_rcp)."""
    size = np.abs(transform_reciprocal(x))
    return np.copysign(np.minimum(np.maximum(size, np.float64(2.0**-64)), np.float64(2.0**64)), x)


def _reciprocal(x):
    """RCP: 1/0 is infinity with the zero's sign. Source: envytools (xf_rcp)."""
    return np.copysign(transform_reciprocal(x), x)


def _exp(x):
    return *exponential_parts(x), exponential(x), np.ones_like(x)


def _log(x):
    size = np.abs(x)
    mantissa, exponent = np.frexp(np.where(np.isfinite(size) & (size > 0), size, 1.0))
    whole = np.where(size > 0, exponent - 1.0, -np.inf)
    whole, mantissa = np.where(np.isinf(size), np.inf, whole), 2.0 * mantissa
    whole, mantissa = (np.where(np.isnan(x), np.nan, part) for part in (whole, mantissa))
    return whole, mantissa, logarithm(size), np.ones_like(x)


def _lit(a):
    x, y, _, power = a
    one = np.ones_like(x)
    lit = np.where(np.signbit(x), 0.0, x)
    return one, lit, np.where(lit != 0, lit_power(y, power), 0.0), one


# By name: the number of operands, and a function from them to the four components of the result.
_VECTORS = {
    "MOV": (1, lambda a: a),
    "MUL": (2, lambda a, b: [transform_product(x, y) for x, y in zip(a, b, strict=True)]),
    "ADD": (2, lambda a, b: [_add(x, y) for x, y in zip(a, b, strict=True)]),
    "MAD": (3, lambda a, b, c: [_add(transform_product(x, y), z) for x, y, z in zip(a, b, c, strict=True)]),
    "DP3": (2, lambda a, b: [_dot(a, b, 3)] * 4),
    "DP4": (2, lambda a, b: [_dot(a, b, 4)] * 4),
    "DPH": (2, lambda a, b: [_dot([*a[:3], np.ones_like(a[3])], b, 4)] * 4),
    "DST": (2, lambda a, b: [np.ones_like(a[0]), transform_product(a[1], b[1]), a[2], b[3]]),
    "MIN": (2, lambda a, b: [np.where(_less(x, y), x, y) for x, y in zip(a, b, strict=True)]),
    "MAX": (2, lambda a, b: [np.where(_less(x, y), y, x) for x, y in zip(a, b, strict=True)]),
    "SLT": (2, lambda a, b: [_less(x, y).astype(np.float64) for x, y in zip(a, b, strict=True)]),
    "SGE": (2, lambda a, b: [(~_less(x, y)).astype(np.float64) for x, y in zip(a, b, strict=True)]),
    "LIT": (1, _lit),
}
_SCALARS = {
    "RCP": lambda x: [_reciprocal(x)] * 4,
    "RCC": lambda x: [_clamped_reciprocal(x)] * 4,
    "RSQ": lambda x: [transform_inverse_root(x)] * 4,
    "EXP": _exp,
    "LOG": _log,
}
_ADDRESS = "ARL"

# ------------------------------------------------------------------------------------------------- reading


@dataclass(frozen=True)
class Operand:
    """A register that an instruction reads. ``relative``: A0.x is added to the number of a constant."""

    file: str
    number: int
    swizzle: tuple[int, int, int, int]
    negated: bool
    relative: bool


@dataclass(frozen=True)
class Instruction:
    """One operation. ``file`` is R, o, or A for the address register."""

    name: str
    file: str
    target: int | str
    mask: tuple[int, ...]
    operands: tuple[Operand, ...]


_REGISTER = r"(?:R(?P<temporary>\d+)|(?P<file>[vco])\[(?P<index>[^\]]+)\]|(?P<address>A0))"
_OPERAND = re.compile(rf"(?P<sign>-?){_REGISTER}(?:\.(?P<swizzle>[xyzw]{{1,4}}))?$")
_RELATIVE = re.compile(r"A0(?:\.x)?(?:\+(\d+))?$")


def _matched(text, instruction):
    found = _OPERAND.match(text)
    if found is None:
        raise ValueError(
            f"{text!r} in {instruction!r} is no register; give R0 to R12, v[OPOS], c[96], c[A0.x+96], "
            "o[COL0], with .xyzw where components are chosen."
        )
    return found


def _numbered(number, limit, text, instruction):
    if not 0 <= number < limit:
        raise ValueError(f"{text!r} in {instruction!r} has number {number}; give 0 to {limit - 1}.")
    return number


def _operand(text, instruction):
    found = _matched(text, instruction)
    file, index, relative = found["file"], found["index"], False
    if found["temporary"] is not None:
        file, number = "R", _numbered(int(found["temporary"]), TEMPORARIES + 1, text, instruction)
    elif file == "v":
        number = INPUTS[index] if index in INPUTS else int(index) if index.isdigit() else -1
        _numbered(number, 16, text, instruction)
    elif file == "c":
        from_address = _RELATIVE.match(index.replace(" ", ""))
        relative = from_address is not None
        digits = (from_address[1] or "0") if relative else index
        number = _numbered(int(digits) if digits.isdigit() else -1, CONSTANTS, text, instruction)
    else:
        raise ValueError(f"{text!r} in {instruction!r} cannot be read; read R0 to R12, v[...] or c[...].")
    letters = found["swizzle"] or "xyzw"
    swizzle = tuple(_COMPONENTS[c] for c in letters.ljust(4, letters[-1]))
    return Operand(file, number, swizzle, found["sign"] == "-", relative)


def _instruction(text):
    name, _, rest = text.partition(" ")
    operands = [part.strip() for part in rest.split(",")]
    wanted = _VECTORS[name][0] if name in _VECTORS else 1
    if name not in _VECTORS and name not in _SCALARS and name != _ADDRESS:
        known = ", ".join(sorted((*_VECTORS, *_SCALARS, _ADDRESS)))
        raise ValueError(f"{name!r} in {text!r} is no instruction; give one of {known}.")
    if len(operands) != wanted + 1:
        raise ValueError(f"{text!r} has {len(operands) - 1} operands; {name} takes {wanted}.")
    target = _matched(operands[0], text)
    mask = tuple(sorted({_COMPONENTS[c] for c in target["swizzle"] or "xyzw"}))
    read = tuple(_operand(operand, text) for operand in operands[1:])
    if (name == _ADDRESS) != (target["address"] is not None):
        raise ValueError(f"{text!r}: {_ADDRESS} writes A0.x, and nothing else does.")
    if target["address"] is not None:
        return Instruction(name, "A", 0, (0,), read)
    if target["temporary"] is not None:
        number = _numbered(int(target["temporary"]), TEMPORARIES, operands[0], text)
        return Instruction(name, "R", number, mask, read)
    if target["file"] != "o" or target["index"] not in OUTPUTS:
        raise ValueError(
            f"{operands[0]!r} in {text!r} cannot be written; write R0 to R11, or o[...] of "
            f"{', '.join(OUTPUTS)}."
        )
    return Instruction(name, "o", target["index"], mask, read)


def vertex_program(text: str) -> "VertexProgram":
    """The program of a text: instructions, each with a semicolon; ``#`` begins a comment.

    Raises ValueError for text that is no instruction or register.
    """
    lines = " ".join(line.partition("#")[0] for line in text.splitlines())
    statements = [" ".join(statement.split()) for statement in lines.split(";")]
    return VertexProgram(
        tuple(
            tuple(_instruction(part.strip()) for part in re.split(r"\+(?![^\[]*\])", statement))
            for statement in statements
            if statement
        )
    )


# ------------------------------------------------------------------------------------------------- running


@dataclass(frozen=True)
class VertexProgram:
    """Instructions, in groups that run at once; made by ``vertex_program``."""

    groups: tuple[tuple[Instruction, ...], ...]

    def run(
        self, inputs: Mapping[str | int, object], constants: Mapping[int, object] | None = None
    ) -> dict[str, np.ndarray]:
        """Outputs by name, float64 [n, 4]; FOGC and PSIZ are the scalars [n] that reach the rasterizer.

        - ``inputs``: {name or number: array [n, 1..4], or 1 to 4 numbers for all vertices}. Missing
          components and missing inputs are (0, 0, 0, 1).
        - ``constants``: {number: four numbers}; the others are 0.

        Outputs that the program never writes are absent. Where it writes only some components of a vector,
        the others are (0, 0, 0, 1) (undefined in the extension). Numbers may be infinite or NaN. Raises
        ValueError for an input or constant that does not exist.
        """
        with np.errstate(all="ignore"):
            return _Run(self, inputs, constants or {}).results()


def _normal(values):
    """Numbers in single precision, with signed zeros for denormal ones, as every operation takes them."""
    found = np.asarray(values).astype(np.float32).astype(np.float64)
    return np.where(np.abs(found) < LEAST_SINGLE, np.copysign(0.0, found), found)


def _filled(values, count):
    """Four columns from an array [n, 1..4] or from 1 to 4 numbers, in single precision."""
    values = np.asarray(values, np.float64)
    given = values.T if values.ndim == 2 else np.atleast_1d(values)
    columns = [np.full(count, column) for column in _normal(given)]
    return columns + [np.full(count, d) for d in _DEFAULT[len(columns) :]]


class _Run:
    def __init__(self, program, inputs, constants):
        self.program, self.address, self.outputs = program, None, {}
        arrays = [np.asarray(v) for v in inputs.values()]
        self.count = max((len(a) for a in arrays if a.ndim == 2), default=1)
        self.inputs = {number: _filled(_DEFAULT, self.count) for number in range(16)}
        for key, values in inputs.items():
            number = INPUTS.get(key, key)
            if number not in self.inputs:
                raise ValueError(
                    f"A program has no input {key!r}; give 0 to 15 or one of {', '.join(INPUTS)}."
                )
            self.inputs[number] = _filled(values, self.count)
        self.constants = np.zeros((CONSTANTS, 4))
        for number, values in constants.items():
            if not 0 <= number < CONSTANTS:
                raise ValueError(f"A program has no constant {number}; give 0 to {CONSTANTS - 1}.")
            self.constants[number] = _normal(values)
        # The text has twelve; who makes Instructions otherwise may number others from 13.
        self.temporaries = defaultdict(lambda: _filled((0.0, 0.0, 0.0, 0.0), self.count))

    def _register(self, operand):
        if operand.file == "v":
            return self.inputs[operand.number]
        if operand.file == "R":
            if operand.number == TEMPORARIES:
                return self.outputs.get("HPOS", _filled(_DEFAULT, self.count))
            return self.temporaries[operand.number]
        if not operand.relative:
            return [np.full(self.count, value) for value in self.constants[operand.number]]
        at = operand.number + (np.zeros(self.count) if self.address is None else self.address)
        inside = (at >= 0) & (at < CONSTANTS)  # numbers outside read 0. Source: NV_vertex_program
        rows = self.constants[np.where(inside, at, 0).astype(np.int64)]
        return [np.where(inside, column, 0.0) for column in rows.T]

    def _value(self, instruction):
        read = []
        for operand in instruction.operands:
            columns = self._register(operand)
            columns = [columns[component] for component in operand.swizzle]
            read.append([-c for c in columns] if operand.negated else columns)
        if instruction.name == _ADDRESS:
            return [np.floor(read[0][0])]
        if instruction.name in _SCALARS:
            return _SCALARS[instruction.name](read[0][0])
        return _VECTORS[instruction.name][1](*read)

    def _write(self, instruction, value):
        if instruction.file == "A":
            self.address = value[0]
        elif instruction.target in ("FOGC", "PSIZ"):
            # Measured: the first component that the mask enables (Fog_coord_vec4, 40 captures).
            self.outputs[instruction.target] = value[instruction.mask[0]]
        else:
            if instruction.file == "R":
                columns = self.temporaries[instruction.target]
            else:
                columns = self.outputs.setdefault(instruction.target, _filled(_DEFAULT, self.count))
            for component in instruction.mask:
                columns[component] = value[component]

    def results(self):
        for group in self.program.groups:
            values = [[np.array(c) for c in self._value(instruction)] for instruction in group]
            for instruction, value in zip(group, values, strict=True):
                self._write(instruction, value)
        return {
            name: value if name in ("FOGC", "PSIZ") else np.stack(value, axis=1)
            for name, value in self.outputs.items()
        }
