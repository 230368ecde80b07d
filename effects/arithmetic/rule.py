"""A rule of the NV2A's arithmetic: one function with its formula, its evidence, and test vectors.

Vectors are plain data, so that a program in any language reads them: whole numbers, names, and the bits of
IEEE 754 for numbers with a fraction.
"""

import struct
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from fixedpipe.pipeline.golden.vectors import Chance


@dataclass(frozen=True)
class Rule:
    """One rule; ``id`` names its file.

    numbers    its id in docs/numbers.md
    formula    an expression of the inputs' names in Python's notation; ``in_words``: a sentence instead
    evidence   begins with a tag of docs/numbers.md
    captures   SUITE or SUITE/CASE: those that show it. Empty: none does
    inputs     by name, their kinds; ``output``: the result's. A kind is a key of ``KINDS``, ``[n]`` behind
               it makes it a list
    compute    the result, of the inputs in their order: the machine's own function
    edges      inputs that come first; without ``draw`` they are all that there are
    draw       the inputs of a random case
    open       the question of ``conformance --discriminates`` that decides this rule
    """

    id: str
    stage: str
    numbers: str
    formula: str
    evidence: str
    captures: tuple[str, ...]
    inputs: Mapping[str, str]
    output: str
    compute: Callable[..., Any]
    edges: tuple[tuple[Any, ...], ...]
    draw: Callable[[Chance], tuple[Any, ...]] | None = None
    open: str = ""
    in_words: bool = False

    def cases(self, count: int, seed: int) -> Iterable[dict[str, Any]]:
        """The edges, and ``count`` random cases from the seed on: inputs by name, and ``expected``."""
        drawn = () if self.draw is None else (self.draw(Chance(self.id, seed + k)) for k in range(count))
        for given in (*self.edges, *drawn):
            case = {
                name: encoded(kind, value)
                for (name, kind), value in zip(self.inputs.items(), given, strict=True)
            }
            yield {**case, "expected": encoded(self.output, self.compute(*given))}

    def head(self) -> dict[str, Any]:
        """What the file says of the rule before its cases."""
        return {
            "rule": self.id,
            "stage": self.stage,
            "numbers": self.numbers,
            "formula": self.formula,
            "evidence": self.evidence,
            "captures": list(self.captures),
            "open": self.open,
            "inputs": dict(self.inputs),
            "output": self.output,
        }


def _bits(value, form, digits):
    if value != value:
        return "NaN"  # its sign and its payload are nobody's business
    data = struct.pack(f">{form}", value)
    if struct.unpack(f">{form}", data)[0] != value:
        raise ValueError(f"{value!r} has more bits than the format {form!r} holds.")
    return f"0x{int.from_bytes(data, 'big'):0{digits}x}"


# How a value of each kind is written.
KINDS = {
    "int": int,
    "name": str,
    "bytes": bytes.hex,
    "single": lambda value: _bits(float(value), "f", 8),
    "double": lambda value: _bits(float(value), "d", 16),
}


def encoded(kind: str, value: Any) -> Any:
    """A value as JSON has it."""
    base, bracket, _ = kind.partition("[")
    return [KINDS[base](each) for each in value] if bracket else KINDS[base](value)


def single_of(pattern: int) -> float:
    """The number of single precision that has these 32 bits."""
    return struct.unpack(">f", pattern.to_bytes(4, "big"))[0]


def ordinary(chance: Chance, octaves: int = 8) -> float:
    """A number of single precision of either sign, 2**-octaves to 2**octaves in magnitude."""
    exponent = 127 - octaves + chance.below(2 * octaves)
    return single_of(chance.below(2) << 31 | exponent << 23 | chance.below(1 << 23))


def fraction(chance: Chance) -> float:
    """A number of single precision in [0, 1], exact in 24 fraction bits."""
    return chance.below((1 << 24) + 1) / (1 << 24)
