"""The programs of tests/programs, what their index says of each, and fragments to give them."""

import ast
import operator
import random
import tomllib
from math import floor
from pathlib import Path

FOLDER = Path(__file__).parents[1] / "programs"
INDEX = tomllib.loads((FOLDER / "index.toml").read_text(encoding="utf-8"))
ACCEPTED = [name for name, entry in INDEX.items() if "refused" not in entry]
COMPUTING = [name for name in ACCEPTED if "combiners" in INDEX[name]]
REGISTERS = ("t0", "t1", "t2", "t3", "v0", "v1")


def text_of(name):
    return (FOLDER / name).read_text(encoding="utf-8")


def constants_of(name):
    """{number: color} of what the application sets."""
    return {int(number): tuple(color) for number, color in INDEX[name].get("constants", {}).items()}


# ------------------------------------------------------------------------------------------------- fragments

ENDS = (0, 1, 127, 128, 254, 255)


def fragments(seed=1):
    """24 fragments, {register: four bytes}: all registers at each end of the range; each at any of the ends;
    any bytes.
    """
    numbers = random.Random(seed)
    found = [{name: (end,) * 4 for name in REGISTERS} for end in ENDS]
    for choices in (ENDS, range(256)):
        found += [{name: tuple(numbers.choices(choices, k=4)) for name in REGISTERS} for _ in range(9)]
    return found


# ----------------------------------------------------------------------------------------------- hand's work

_OPERATORS = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.USub: operator.neg,
}
_FUNCTIONS = {
    "min": min,
    "max": max,
    "floor": floor,
    "rn": lambda n: (2 * n + 255) // 510,
    "byte": lambda x: floor(255 * x + 0.5),
}


def _value(node, known):
    if isinstance(node, ast.Constant):
        return node.value
    if isinstance(node, ast.Name):
        return known[node.id]
    if isinstance(node, ast.Call):
        return _FUNCTIONS[node.func.id](*(_value(argument, known) for argument in node.args))
    if isinstance(node, ast.UnaryOp):
        return _OPERATORS[type(node.op)](_value(node.operand, known))
    return _OPERATORS[type(node.op)](_value(node.left, known), _value(node.right, known))


def worked_out(gives):
    """The four bytes of an entry's ``gives``, each claim's arithmetic checked."""
    known = {}
    for claim in gives.get("first", ()):
        name, expression, value = (side.strip() for side in claim.split(" = "))
        known[name] = _claimed(expression, value, known, claim)
    found = []
    for claim in gives["then"]:
        expression, value = (side.strip() for side in claim.split(" = "))
        found.append(_claimed(expression, value, known, claim))
    return found


def _claimed(expression, value, known, claim):
    computed = _value(ast.parse(expression, mode="eval").body, known)
    assert computed == int(value), f"{claim}: it is {computed}"
    return int(value)
