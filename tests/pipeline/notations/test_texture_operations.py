"""What docs/program-instructions.md says of texture shaders, beside the specification and the ideal."""

import random
from math import floor

import numpy as np
import pytest

from fixedpipe.pipeline.columns.texture_shader import StageRun
from fixedpipe.pipeline.notations.programs import parse_program
from fixedpipe.pipeline.notations.texture_shaders import INSTRUCTION_NAMES
from fixedpipe.pipeline.profiles import GEFORCE_3, IDEAL, NV2A
from fixedpipe.pipeline.programs.texture_shader_rules import shader_stages, texture_target
from fixedpipe.pipeline.state import PassState, TextureUnit
from fixedpipe.raster.columns import real_texture_shader
from tests.reference import texture_shader
from tests.support.texture_operations import OPERATIONS, dot_products, evaluated

DEPTH_MAX = 65535
_BY_NAME = {operation.words: operation for operation in OPERATIONS}


def fragments():
    """Coordinates of four units, the texel of every lookup, and with them the values where a rule turns."""
    numbers = random.Random(5)
    for k in range(80):
        values = (0, 127, 128, 255) if k % 3 == 0 else range(256)
        texels = [[numbers.choice(values) for _ in range(4)] for _ in range(2)]
        coordinates = [[numbers.uniform(-1.5, 1.5) for _ in range(4)] for _ in range(4)]
        yield coordinates, texels


class _Fragment(texture_shader.Stages):
    """The specification's stages at given coordinates. ``texels``: of unit 0, and of the other units."""

    def __init__(self, state, coordinates, texels, profile):
        self.given, self.made = coordinates, {}
        super().__init__(state, [True] * 4, None, self.read, DEPTH_MAX, profile)
        self.samplers = [None] * 4
        self.of_units = texels

    def coordinates(self, i):
        return self.given[i]

    def read(self, i, strq, operation, rough=None):
        self.made[i] = strq
        return list(self.of_units[min(i, 1)])


def of_the_machine(state, coordinates, texels, profile):
    """(made coordinates by stage, texels, kept, depth) of the specification."""
    run = _Fragment(state, coordinates, texels, profile)
    registers, alive, depth = run.run()
    return run.made, registers, alive, depth


class _Unit:
    """A texture unit of the ideal's stages that reads one texel everywhere, and notes where."""

    bits, signed = 8, (False,) * 4

    def __init__(self, number, operation, texel, found):
        self.number, self.target, self.texel, self.found = number, texture_target(operation), texel, found

    def filtered(self):
        return np.array([self.texel]) / 255

    def register(self, texel, bits):
        return texel

    def at_level_zero(self, strq, r, lifted, flat):
        self.found[self.number] = tuple(strq[0])
        return self.filtered()


def of_the_ideal(state, coordinates, texels):
    """The same of the ideal."""
    found, stages = {}, shader_stages(state)
    units = [_Unit(i, stage.operation, texels[min(i, 1)], found) for i, stage in enumerate(stages)]
    run = StageRun(
        stages,
        1,
        lambda i: np.array([coordinates[i]]),
        None,
        units,
        IDEAL,
        8,
        (1.0, 1.0),
        arithmetic=real_texture_shader,
    )
    run.all_stages()
    registers = [255 * register[0] for register in run.registers]
    return found, registers, run.alive[0], None if run.depth is None else run.depth[0]


@pytest.mark.parametrize("name", _BY_NAME)
@pytest.mark.parametrize("exact", [False, True], ids=["machine", "ideal"])
def test_a_formula_is_what_an_operation_computes(name, exact):
    operation = _BY_NAME[name]
    stages = parse_program(f"!!TS1.0\n{operation.text}\n").texture_shader
    last = len(stages) - 1
    if exact and "RECTANGLE" in stages[last].operation.name:
        return  # the ideal has none: test_which_machine_has_it
    state = PassState(texture_units=(TextureUnit("t"),) * 4, texture_shader=stages)
    for coordinates, texels in fragments():
        s, t, r, q = coordinates[last]
        dots = dot_products(stages, coordinates, texels[0], exact)[1:]
        given = {
            **dict(zip("strqRGBA", (s, t, r, q, *texels[0]), strict=True)),
            "dots": dots,
            "qs": [each[3] for each in coordinates[1 : last + 1]],
            "looked_up": texels[1][:3],
        }
        run = of_the_ideal(state, coordinates, texels)
        if not exact:
            run = of_the_machine(state, coordinates, texels, GEFORCE_3)
        made, registers, alive, depth = run
        close = {"rtol": 0, "atol": 1e-12}
        if operation.made:
            expected = evaluated(operation.made, exact, **given)
            np.testing.assert_allclose(made[last][: len(expected)], expected, **close)
        if "its second" in name:
            np.testing.assert_allclose(made[last - 1], dots, **close)
        what, formula = operation.given
        if what == "texel":
            expected = evaluated(formula, exact, **given)
            np.testing.assert_allclose(registers[last][: len(expected)], expected, **close)
        if what == "kept":
            assert alive == evaluated(formula, exact, **given)
        if what == "depth" and not dots[1]:
            assert not alive
        elif what == "depth":
            value = evaluated(formula, exact, units=1 if exact else DEPTH_MAX, **given)
            assert alive == (0 <= value <= (1 if exact else DEPTH_MAX))
            assert not alive or depth == pytest.approx(value if exact else floor(value), abs=1e-12)
            if exact:
                continue
            in_units = of_the_machine(state, coordinates, texels, NV2A)
            value = evaluated(formula, exact, units=1, **given)
            assert in_units[2] == (0 <= value <= DEPTH_MAX)
            assert not in_units[2] or in_units[3] == floor(value)


def test_every_instruction_has_a_row():
    text = "\n".join(operation.text for operation in OPERATIONS)
    assert {name for name in INSTRUCTION_NAMES if f"{name}(" not in text} == set()
