"""The programs of tests/programs, what their index says of each, and fragments to give them."""

import ast
import operator
import random
import tomllib
from math import floor
from pathlib import Path

import numpy as np

from fixedpipe.pipeline.commands import Clear, Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import TextureFilter, WrapMode
from fixedpipe.pipeline.state import PassState, Sampler, TextureUnit
from fixedpipe.pipeline.textures.images import texture_2d

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
COUNT, _WIDTH = 24, 32  # fragments, and the width of a texture that holds a texel of each


def fragments(seed=1):
    """24 fragments, {register: four bytes}: all registers at each end of the range; each at any of the ends;
    any bytes.
    """
    numbers = random.Random(seed)
    found = [{name: (end,) * 4 for name in REGISTERS} for end in ENDS]
    for choices in (ENDS, range(256)):
        found += [{name: tuple(numbers.choices(choices, k=4)) for name in REGISTERS} for _ in range(9)]
    return found


def drawn(combiners, given):
    """The commands that draw a row of triangles, one for each fragment of what is given."""
    nearest = Sampler(
        TextureFilter.NEAREST, TextureFilter.NEAREST, WrapMode.CLAMP_TO_EDGE, WrapMode.CLAMP_TO_EDGE
    )
    count = len(given)
    colors = {name: np.array([fragment[name] for fragment in given]) for name in REGISTERS}
    middle = np.repeat(np.arange(count) + 0.5, 3)  # a triangle covers the middle of its pixel alone
    x = 2 * (middle + np.tile([-0.5, 0.5, 0.0], count)) / count - 1
    coordinates = np.column_stack([middle / _WIDTH, np.full(3 * count, 0.5)])
    mesh = Mesh(
        np.column_stack([x, np.tile([-1.0, -1.0, 1.0], count), np.zeros(3 * count)]),
        colors=np.repeat(colors["v0"], 3, axis=0) / 255,
        secondary_colors=np.repeat(colors["v1"], 3, axis=0) / 255,
        texture_coordinates=(coordinates,) * 4,
    )
    images = {name: np.zeros((1, _WIDTH, 4), np.uint8) for name in REGISTERS[:4]}
    for name, image in images.items():
        image[0, :count] = colors[name]
    state = PassState(
        texture_units=tuple(TextureUnit(name, nearest) for name in images),
        register_combiners=combiners,
    )
    textures = [TexImage(label=name, texture=name, image=texture_2d(image)) for name, image in images.items()]
    return Clear(label="clear", color=(0.0,) * 4), *textures, Draw(label="row", mesh=mesh, state=state)


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
