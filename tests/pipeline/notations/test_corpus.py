"""The programs of tests/programs do what their index says: by hand, by definition, drawn, in the ideal."""

from dataclasses import replace
from fractions import Fraction
from math import inf

import numpy as np
import pytest

from fixedpipe.pipeline.commands import Clear, Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import TextureFilter, WrapMode
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.notations.programs import parse_program
from fixedpipe.pipeline.notations.tokens import ProgramTextError
from fixedpipe.pipeline.profiles import IDEAL, NV2A, PROFILES
from fixedpipe.pipeline.state import PassState, Sampler, TextureUnit
from fixedpipe.pipeline.textures.images import texture_2d
from fixedpipe.pipeline.validation.validate import validate_program
from fixedpipe.pipeline.validation.walk import UnsupportedState
from tests.reference import combine, fixed, pixel_shader, real_pixel_shader
from tests.support import notation_states
from tests.support.corpus import (
    ACCEPTED,
    COMPUTING,
    FOLDER,
    INDEX,
    REGISTERS,
    constants_of,
    fragments,
    text_of,
    worked_out,
)
from tests.support.second_reading import combiners_again

NO_FOG = (0, 0, 0, 255)
SHADERS = [name for name in COMPUTING if name.endswith(".psh")]
COMBINERS = [name for name in COMPUTING if name.endswith(".rc")]
GIVEN = fragments()
COUNT, _WIDTH = len(GIVEN), 32  # the width of a texture that holds a texel of each fragment


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


def program(name):
    return parse_program(text_of(name), constants=constants_of(name))


def bytes_of(name, given, profile=NV2A):
    """What a machine draws of a program's combiners: each fragment's four bytes."""
    result = execute(drawn(program(name).combiners, given), profile, len(given), 1)
    return result.framebuffer.color.reshape(len(given), 4).tolist()


# ---------------------------------------------------------------------------------------- what the index says


def test_the_index_names_every_program():
    files = {path.name for path in FOLDER.iterdir()} - {"index.toml"}
    assert files == set(INDEX)
    assert len(files) >= 60
    assert len({text_of(name) for name in files}) == len(files)
    assert COUNT == 24  # of each program


@pytest.mark.parametrize("name", [name for name in INDEX if name not in ACCEPTED])
def test_what_is_refused_says_where_and_why(name):
    refused = INDEX[name]["refused"]
    with pytest.raises(ProgramTextError) as caught:
        parse_program(text_of(name))
    assert caught.value.line == refused["line"] and refused["word"] in str(caught.value), caught.value


@pytest.mark.parametrize("name", ACCEPTED)
def test_what_is_accepted_takes_what_it_says_and_runs_where_it_says(name):
    entry, found = INDEX[name], program(name)
    assert len(found.combiners.general if found.combiners else ()) == entry.get("combiners", 0)
    if "stages" in entry:
        assert [stage.operation.name for stage in found.texture_shader] == entry["stages"]
    too_much_for = entry.get("too_much_for", {})
    for machine in {"NV2A", "GEFORCE_3", *entry.get("also", ())} - set(too_much_for):
        validate_program(found.texture_shader, found.combiners, PROFILES[machine])
    for machine, word in too_much_for.items():
        with pytest.raises(UnsupportedState, match=word):
            validate_program(found.texture_shader, found.combiners, PROFILES[machine])
    if "same_as" in entry:
        assert found.combiners == program(entry["same_as"]).combiners


@pytest.mark.parametrize("name", COMPUTING)
def test_a_program_gives_what_is_worked_out_by_hand(name):
    gives = INDEX[name]["gives"]
    given = [{register: one["of"].get(register, [0] * 4) for register in REGISTERS} for one in gives]
    assert bytes_of(name, given) == [worked_out(one) for one in gives]


# -------------------------------------------------------------------------------------------- by definition


def by_definition(name, given, profile):
    """Bytes of the definition in integers: of Direct3D's instructions, or of the extension's combiners."""
    if name.endswith(".psh"):
        text = notation_states.lines_of(shader_of(name))
        chip = pixel_shader.Arithmetic(
            half=profile.arithmetic.expand_half, lowest=profile.arithmetic.clamp_low
        )
        return [
            pixel_shader.evaluate(text, [f[t] for t in REGISTERS[:4]], f["v0"], f["v1"], chip) for f in given
        ]
    registers = [
        combine.initial_registers(f["v0"], f["v1"], [list(f[t]) for t in REGISTERS[:4]], NO_FOG)
        for f in given
    ]
    return [combine.combine(program(name).combiners, r, combine.machine_of(profile)) for r in registers]


def shader_of(name):
    """The second reading of a pixel shader, with the application's constants."""
    shader = notation_states.pixel_shader(text_of(name))
    return shader | {"constants": constants_of(name) | shader["constants"]}


# By definition r0's alpha is zero where nothing wrote it, and here texture 0's: this is told as a note.
UNWRITTEN = ("alpha_left_alone.psh",)


MACHINES = [
    (name, machine)
    for name in COMPUTING
    for machine in ("NV2A", "GEFORCE_3")
    if name not in UNWRITTEN and machine not in INDEX[name].get("too_much_for", {})
]


@pytest.mark.parametrize(("name", "machine"), MACHINES)
def test_a_machine_computes_what_the_definition_says_in_integers(name, machine):
    profile = PROFILES[machine]
    assert bytes_of(name, GIVEN, profile) == by_definition(name, GIVEN, profile)


# Where the ideal's register combiners are not the definition: what changes of its Machine.
OF_COMBINERS = {
    "unbounded": {"range": inf, "general_combiner": False},
    "sum unclamped": {"color_sum": False},
}
# Why the ideal is not the definition in real numbers, by these names or those of real_pixel_shader.RULES.
EXPLAINED = {
    "yuv.psh": ("unbounded",),
    "exclusive.psh": ("unbounded",),
    "lit_twice.psh": ("unbounded",),
    "expanded_difference.psh": ("negative is zero",),
    "complement_of_difference.psh": ("complement in range",),
    "weight_out_of_range.psh": ("weight in range",),
    "exactly_half.psh": ("half is above",),
    "alpha_left_alone.psh": ("first alpha",),
    "diffuse_bump.rc": ("unbounded",),
    "scales.rc": ("unbounded",),
    "two_dots.rc": ("unbounded",),
    "saturating_sum.rc": ("unbounded",),
    "clamped_sum.rc": ("sum unclamped",),
}


def in_reals(name, rules):
    of_reals = [{k: [Fraction(c, 255) for c in color] for k, color in f.items()} for f in GIVEN]
    if name.endswith(".psh"):
        shader = shader_of(name)
        return [real_pixel_shader.evaluate(shader, fragment, rules) for fragment in of_reals]
    changes = {name: value for rule in rules for name, value in OF_COMBINERS[rule].items()}
    machine, state = replace(combine.DEFINITION, **changes), combiners_again(text_of(name))
    registers = [
        combine.initial_registers(f["v0"], f["v1"], [f[t] for t in REGISTERS[:4]], (0, 0, 0, 1), fixed.REAL)
        for f in of_reals
    ]
    return [combine.combine(state, r, machine) for r in registers]


def agrees(name, rules, ideal):
    return np.abs(np.array(in_reals(name, frozenset(rules)), float) - ideal).max() <= 1e-9


@pytest.mark.parametrize("name", [*SHADERS, *COMBINERS])
def test_the_ideal_is_the_definition_in_real_numbers_but_for_named_rules(name):
    ideal = execute_ideal(drawn(program(name).combiners, GIVEN), COUNT, 1).color.reshape(COUNT, 4)
    rules = set(EXPLAINED.get(name, ()))
    assert agrees(name, rules, ideal), f"{name} differs, and {sorted(rules)} do not explain it"
    for rule in rules:
        assert not agrees(name, rules - {rule}, ideal), f"{name} agrees without {rule}"


def test_every_rule_is_needed_by_a_program():
    assert set(EXPLAINED) <= {*SHADERS, *COMBINERS}
    named = {(name.endswith(".psh"), rule) for name, rules in EXPLAINED.items() for rule in rules}
    known = {(True, rule) for rule in real_pixel_shader.RULES} | {(False, rule) for rule in OF_COMBINERS}
    assert named == known


def test_the_ideal_holds_what_the_eight_bit_machines_hold():
    for name in [*SHADERS, *COMBINERS]:
        validate_program(None, program(name).combiners, IDEAL)
