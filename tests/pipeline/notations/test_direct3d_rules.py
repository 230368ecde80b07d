"""What Direct3D defines, guarantees and refuses in pixel shaders."""

import re

import numpy as np
import pytest

from fixedpipe.pipeline.commands import Clear, Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import TextureFilter
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.notations.pixel_shader_translation import parse
from fixedpipe.pipeline.notations.pixel_shaders import PixelShaderTextError
from fixedpipe.pipeline.notations.programs import parse_program
from fixedpipe.pipeline.profiles import GEFORCE_3, IDEAL
from fixedpipe.pipeline.state import PassState, Sampler, TextureUnit
from fixedpipe.pipeline.textures.images import texture_2d
from fixedpipe.pipeline.validation.validate import validate_program
from fixedpipe.pipeline.validation.walk import UnsupportedState
from tests.reference import pixel_shader
from tests.support.pixel_shaders import CHIP, check, fragments, on_combiners

HEAD = "ps.1.3\ndef c0, 0.25, 0.5, 0.75, 1\ndef c1, -0.25, -0.5, -1, 0.5\ntex t0\ntex t1\n"
TEXEL = 200

# ---------------------------------------------------------------------------------------- definitions


@pytest.mark.parametrize(("written", "same"), [("aaaa", "a"), ("wwww", "w"), ("aaa", "a")])
def test_a_component_may_be_repeated(written, same):
    text = HEAD + "mul r0, t0, c0.{}\n"
    assert parse(text.format(written)) == parse(text.format(same))
    alpha = HEAD + "mov r0, t1\nmov r0.a, t0.{}\n"
    assert parse(alpha.format("bbbb")) == parse(alpha.format("b"))


def test_the_last_definition_of_a_constant_stays():
    text = "ps.1.1\ndef c0, 1, 1, 1, 1\ndef c0, 0.5, 0.25, 0, 1\nmov r0, c0\n"
    shader = check(text)
    assert shader.combiners.general[0].constant_color0 == (0.5, 0.25, 0.0, 1.0)
    assert shader.notes == ("line 3: c0 is defined again, and this definition stays.",)


PAIRS = (
    "mad r0.rgb, c0, t0, c1\n+ mul r0.a, c2.a, t1.a\n",
    "mad r0.rgb, c0, t0, c1\n+ mad r0.a, c2, t1, c3\n",
    "mad r0.rgb, c0.a, t0, c1\n+ mul r0.a, c2, t1\n",
    "mul r0.a, c2, t1\n+ mad r0.rgb, c0, t0, c1\n",
    "mad r0.rgb, c0, t0, c2\n+ mad r0.a, c3, t1, c0\n",
)


@pytest.mark.parametrize("pair", PAIRS)
def test_a_pair_takes_two_colors_and_two_alphas_of_constants(pair):
    """A constant register has a color and an alpha, which may be of two of the program's constants."""
    constants = "def c2, 0.12, 0.92, 0.31, 0.6\ndef c3, 0.2, 0.72, 0.5, -0.4\n"
    shader = check(HEAD.replace("tex t0\n", constants + "tex t0\n") + pair)
    assert len(shader.combiners.general) == 1
    assert {place.constant for place in shader.constants} == {int(n) for n in re.findall(r"c([0-9])", pair)}


def test_three_colors_of_constants_are_too_many():
    with pytest.raises(PixelShaderTextError, match="the alpha of c2 is the third"):
        parse(HEAD + "mov r0, t0\nmad r0.a, c0, c1, c2\n")


@pytest.mark.parametrize("source", ["t0", "-t0", "1-t0", "t0_bx2", "t0_bias", "-t0_bx2", "-t0_bias", "t0.a"])
@pytest.mark.parametrize("instruction", ["mov r0, {}", "mul r0, {}, v0", "mad r0, v0, {}, v1"])
def test_the_alpha_of_texcoord_is_one(instruction, source):
    text = "ps.1.1\ntexcoord t0\n" + instruction.format(source) + "\n"
    shader = check(text)
    assert shader.notes == (
        "line 2: the alpha of texcoord t0 is 1 whatever the fourth coordinate, by definition.",
    )


def test_the_alpha_of_texcoord_is_what_is_written_to_it():
    check("ps.1.1\ntexcoord t0\nmov r0, t0\nmov t0.a, v0\nmul r0, r0, t0\n")


# ---------------------------------------------------------------------------------------- the ideal


def ideal(text):
    """The ideal's pixel, 255 = full intensity, of a texel of 200s under white."""
    program = parse_program(text)
    units = (TextureUnit("t", Sampler(TextureFilter.NEAREST, TextureFilter.NEAREST)),)
    state = PassState(
        texture_units=units, texture_shader=program.texture_shader, register_combiners=program.combiners
    )
    mesh = Mesh(
        np.array([[-1.0, -1.0, 0.0], [3.0, -1.0, 0.0], [-1.0, 3.0, 0.0]]),
        colors=np.ones((3, 4)),
        texture_coordinates=(np.zeros((3, 2)),),
    )
    image = texture_2d(np.full((1, 1, 4), TEXEL, np.uint8))
    commands = (
        Clear(label="clear", color=(0.0, 0.0, 0.0, 0.0)),
        TexImage(label="texture", texture="t", image=image),
        Draw(label="all of it", mesh=mesh, state=state),
    )
    return (255 * execute_ideal(commands, 2, 2).color[0, 0]).round(6).tolist()


@pytest.mark.parametrize(
    ("lines", "color"),
    [
        ("mov_x4_sat r0, t0\nmul r0, r0, c0", [63.75] * 4),
        ("mov_x4 r0, t0\nmul r0, r0, c0", [TEXEL] * 4),  # no clamp is stated
        ("mov_x4_sat r1, t0\nmul r0, 1-r1, c0", [0.0] * 4),
        ("mov_x4 r1, t0\nlrp r0, r1, c0, v0", [63.75] * 4),
        ("mov_x4 r1, t0\nlrp r0, 1-r1, c0, v0", [255.0] * 4),
        ("mov r0, c1", [0.0, 0.0, 255.0, 255.0]),
        ("mov r0, -c1", [0.0, 255.0, 0.0, 0.0]),
        ("mul r0, c1, t0", [0.0, 0.0, TEXEL, TEXEL]),
        ("add r0, t0, c2", [TEXEL - 25.5, TEXEL + 51.0, TEXEL, 255.0]),
        ("mad r0, c1, c0, t0", [TEXEL, TEXEL - 63.75, 255.0, 255.0]),
    ],
)
def test_the_ideal_keeps_the_clamps_and_the_constants_that_a_program_states(lines, color):
    """Of real numbers: machines' registers end at 1, and their constants of both signs have even steps."""
    constants = "def c0, 0.25, 0.25, 0.25, 0.25\ndef c1, 0, -1, 1, 1\ndef c2, -0.1, 0.2, 0, 1\n"
    assert ideal(f"ps.1.1\n{constants}tex t0\n{lines}\n") == color


def test_the_ideal_copies_blue_to_alpha_of_either_product():
    program = parse_program(EIGHT_SLOTS)
    assert program.combiners.general[6].rgb.ab_blue_to_alpha
    validate_program(program.texture_shader, program.combiners, IDEAL)


# ---------------------------------------------------------------------------------------- the guarantees

# A dot product in the seventh of eight slots, by whose alpha the eighth chooses.
EIGHT_SLOTS = (
    "ps.1.1\ntex t0\ntex t1\n"
    + "mov r1, t0\n" * 6
    + "dp3_sat r0, t0_bx2, v0_bx2\n"
    + "cnd r0, r0.a, t0, t1\n"
)


def test_a_dot_product_of_all_components_takes_one_of_eight_slots():
    shader = parse(EIGHT_SLOTS)
    validate_program(shader.texture_shader, shader.combiners, GEFORCE_3)
    for t0, t1, t2, t3, v0, v1 in fragments(40):
        expected = pixel_shader.evaluate(EIGHT_SLOTS, (t0, t1, t2, t3), v0, v1, CHIP)
        assert on_combiners(shader, (t0, t1, t2, t3), v0, v1) == expected
    without = GEFORCE_3.changed(blue_to_alpha=False)
    with pytest.raises(UnsupportedState) as caught:
        validate_program(None, shader.combiners, without)
    assert "general combiner 6 writes its blue into an alpha too" in str(caught.value)
    assert "a dp3 whose alpha is read" in str(caught.value)


# ---------------------------------------------------------------------------------------- refusals

NOTES = {
    "texkill t0\nmov r0, v0": "line 2: texkill t0 tests three coordinates in Direct3D, and all four here; a "
    "fourth "
    "that is not negative, 1 for instance, changes nothing.",
    "tex t0\nmov v0, t0\nmov r0, v0": "line 3: mov writes v0, which Direct3D lets a program only read.",
    "tex t0\ntex t1\ntex t2\nmad r0, t0, t1, t2": "line 5: mad reads 3 texture registers; ps.1.1 reads two "
    "at once.",
    "tex t0\ntexbem t1, t0\nmul r0, t0, t1": "line 4: t0 is read again after texbem of it, which Direct3D "
    "refuses.",
    "def c0, 2, 0, 0, 1\nmov r0, c0": "line 2: c0 is beyond [-1, 1], where a machine's constants end: it is "
    "clamped.",
    "mov r0, r1": "line 2: r1's color is read before anything is written to it, which Direct3D refuses; the "
    "register begins as zero.",
}


@pytest.mark.parametrize("lines", NOTES)
def test_what_direct3d_refuses_is_told(lines):
    assert NOTES[lines] in parse(f"ps.1.1\n{lines}\n").notes


def test_a_comparison_that_writes_its_source_is_told():
    text = "ps.1.2\ntex t0\nmov r1, t0\ncmp r1, r1.a, t0, v0\nmov r0, r1\n"
    assert parse(text).notes == ("line 4: cmp writes one of its sources, which Direct3D refuses.",)


@pytest.mark.parametrize(
    "lines",
    [
        "tex t0\ntexbem t1, t0\nmov r0, t1",
        "tex t0\ntexbem t1, t0\ntexbem t2, t0\nadd r0, t1, t2",
        "tex t0\ntexbem t1, t0\nmov t0, t1\nmov r0, t0",
        "tex t0\ntex t1\nmad r0, t0, t1, t0",
        "def c0, -1, 1, 0, 1\nmov r0, c0",
    ],
)
def test_what_direct3d_accepts_has_no_note(lines):
    assert parse(f"ps.1.1\n{lines}\n").notes == ()


@pytest.mark.parametrize("version", ["1.2", "1.3"])
def test_later_versions_read_three_texture_registers(version):
    assert parse(f"ps.{version}\ntex t0\ntex t1\ntex t2\nmad r0, t0, t1, t2\n").notes == ()


@pytest.mark.parametrize(
    ("lines", "name"),
    [
        ("texreg2rgb t1, t0", "texreg2rgb"),
        ("texdp3 t1, t0", "texdp3"),
        ("texdp3tex t1, t0", "texdp3tex"),
        ("texm3x3pad t1, t0\ntexm3x3pad t2, t0\ntexm3x3 t3, t0", "texm3x3"),
    ],
)
def test_operations_of_a_later_chip_are_named_as_such(lines, name):
    with pytest.raises(PixelShaderTextError, match=f"{name} is an operation of the GeForce 4 Ti"):
        parse(f"ps.1.2\ntex t0\n{lines}\nmov r0, t0\n")
