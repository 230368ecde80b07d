"""How the exported functions are called: their inputs and results as words of 32 bits, in C's order.

A double is two words, its lower one first; a name is the chip's number of it; bytes are words, the first
byte lowest.
"""

import re
from dataclasses import dataclass
from functools import cache

import numpy as np

from fixedpipe.effects.arithmetic.rules import RULES
from fixedpipe.effects.emulators.names import constant_of, function_of
from fixedpipe.effects.emulators.sources import FOLDER, STAGES

NAN = {"single": (0x7FC00000,), "double": (0, 0x7FF80000)}
_C_TYPES = {"int": "int", "name": "int", "single": "uint32_t", "double": "uint64_t"}
_BLOCKS = {"dxt1": 2, "dxt3": 4, "dxt5": 4}  # words
_TEXELS = 16  # words of a block's texels


@dataclass(frozen=True)
class Value:
    """What a parameter or a result is: a base kind, how many of it (None: no list), whether it is written."""

    base: str
    count: int | None = None

    @property
    def words(self):
        """How many words hold it."""
        return (2 if self.base == "double" else 1) * (self.count or 1)

    @property
    def c_type(self):
        """The C type of one."""
        return _C_TYPES[self.base]


@dataclass(frozen=True)
class Call:
    """A function, what it receives by name, and what it gives."""

    function: str
    inputs: dict[str, Value]
    output: Value

    @property
    def words_in(self):
        """Words of all inputs."""
        return sum(value.words for value in self.inputs.values())


def value_of(kind, bytes_words=_TEXELS):
    """A rule's kind as a Value."""
    base, bracket, rest = kind.partition("[")
    if base == "bytes":
        return Value("single", bytes_words)
    return Value(base, int(rest[:-1]) if bracket else None)


@cache
def call_of(id_):
    """How a rule's function is called."""
    rule = RULES[id_]
    inputs = {name: value_of(kind, _BLOCKS.get(id_)) for name, kind in rule.inputs.items()}
    return Call(function_of(id_), inputs, value_of(rule.output))


@cache
def constants():
    """The numbers that the sources give to names."""
    text = "".join((FOLDER / f"nv2a_{stage}.h").read_text() for stage in STAGES)
    return {name: int(value, 0) for name, value in re.findall(r"\b(NV2A_[A-Z0-9_]+) = (\w+)", text)}


def words_of(kind, value, id_="", name=""):
    """The words of a value as JSON has it."""
    base, bracket, _ = kind.partition("[")
    if bracket:
        return [word for each in value for word in words_of(base, each, id_, name)]
    if base == "bytes":
        return np.frombuffer(bytes.fromhex(value), "<u4").tolist()
    if base == "name":
        return [constants()[constant_of(id_, name, value)]]
    if base == "int":
        return [value & 0xFFFFFFFF]
    if value == "NaN":
        return list(NAN[base])
    bits = int(value, 16)
    return [bits] if base == "single" else [bits & 0xFFFFFFFF, bits >> 32]


def vectors_of(id_, cases, seed=0):
    """(inputs uint32 [n, words], expected uint32 [n, words]) of a rule's vectors."""
    rule = RULES[id_]
    given, expected = [], []
    for case in rule.cases(cases, seed):
        given.append([w for name, kind in rule.inputs.items() for w in words_of(kind, case[name], id_, name)])
        expected.append(words_of(rule.output, case["expected"]))
    return np.array(given, np.uint32), np.array(expected, np.uint32)


def without_payload(base, words):
    """Words of singles or doubles, with one NaN for all."""
    words = np.array(words, np.uint32)
    if base == "single":
        words[(words & 0x7FFFFFFF) > 0x7F800000] = NAN["single"]
    if base == "double":
        pairs = words.reshape(len(words), -1, 2)
        high = pairs[..., 1] & 0x7FFFFFFF
        pairs[(high > 0x7FF00000) | ((high == 0x7FF00000) & (pairs[..., 0] != 0))] = NAN["double"]
    return words


def wrong_rows(call, found, expected):
    """The numbers of the rows that differ."""
    kind = "bytes" if call.function.startswith("nv2a_dxt") else call.output.base
    found, expected = (without_payload(kind, words) for words in (found, expected))
    return np.flatnonzero((found != expected).any(axis=1))
