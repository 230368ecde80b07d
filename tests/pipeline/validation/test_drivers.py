"""What a driver does not have yet is refused, in a sentence that names the first driver that had it."""

import numpy as np
import pytest

from fixedpipe.pipeline import environment
from fixedpipe.pipeline.commands import Draw, HostStep, Mesh, TexImage
from fixedpipe.pipeline.enums import (
    BaseFormat,
    ComparisonFunction,
    ComponentUsage,
    InternalFormat,
    PrimitiveType,
    Register,
    TextureCompareMode,
    TextureFilter,
)
from fixedpipe.pipeline.execution.machine import Machine, execute
from fixedpipe.pipeline.profiles import GEFORCE_3, GEFORCE_256
from fixedpipe.pipeline.state import (
    CombinerInput,
    FinalCombiner,
    GeneralCombiner,
    PassState,
    PointParameters,
    PointState,
    RegisterCombiners,
    Sampler,
    TextureUnit,
)
from fixedpipe.pipeline.textures.images import Texture, TextureTarget, depth_texels, texture_2d, texture_3d
from fixedpipe.pipeline.textures.words import compressed_texture
from fixedpipe.pipeline.validation.validate import validate
from fixedpipe.pipeline.validation.walk import UnsupportedState

NEAREST = TextureFilter.NEAREST
TRIANGLE = Mesh([[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]])
PICTURE = texture_2d(np.zeros((1, 1, 4)))
DEPTHS = Texture(
    TextureTarget.TEXTURE_2D,
    InternalFormat.DEPTH_COMPONENT16,
    (depth_texels(np.zeros((1, 1), np.int64))[None],),
)


def textured(image, sampler=None, **fields):
    sampler = Sampler(NEAREST, NEAREST) if sampler is None else sampler
    state = PassState(texture_units=(TextureUnit("t", sampler, **fields),))
    return (
        TexImage(label="store", texture="t", image=image),
        Draw(label="use", mesh=TRIANGLE, state=state),
    )


def compared(function=ComparisonFunction.LEQUAL, mode=None):
    compare = TextureCompareMode.COMPARE_R_TO_TEXTURE
    sampler = Sampler(
        NEAREST, NEAREST, compare_mode=compare, compare_function=function, depth_texture_mode=mode
    )
    return textured(DEPTHS, sampler)


def combined(function):
    return textured(PICTURE, environment=environment((function, "TEXTURE", "PREVIOUS")))


POINTS = (
    Draw(
        label="points",
        mesh=Mesh([[0.0, 0.0]], PrimitiveType.POINTS),
        state=PassState(point=PointState(parameters=PointParameters())),
    ),
)
BLUE = (
    Draw(
        label="use",
        mesh=TRIANGLE,
        state=PassState(
            register_combiners=RegisterCombiners(
                general=(GeneralCombiner(),),
                final=FinalCombiner(g=CombinerInput(Register.PRIMARY_COLOR, usage=ComponentUsage.BLUE)),
            )
        ),
    ),
)
S3TC = textured(compressed_texture(bytes(8), InternalFormat.COMPRESSED_RGBA_S3TC_DXT1, 4, 4))
XP, OF_2002, OF_2001 = "Detonator XP", "a driver of 2002", "a driver of 2001"


def refusal(frame, profile):
    """The sentence, or None."""
    try:
        validate(frame, profile, 4, 4)
    except UnsupportedState as refused:
        return str(refused)
    return None


@pytest.mark.parametrize(
    ("machine", "frame", "first"),
    [
        (GEFORCE_256, POINTS, "Release 4"),
        (GEFORCE_256, BLUE, "Release 5"),
        (GEFORCE_256, S3TC, "Release 5"),
        (GEFORCE_256, combined("DOT3_RGB"), OF_2001),
        (GEFORCE_256, combined("SUBTRACT"), OF_2001),
        (GEFORCE_3, compared(), XP),
        (GEFORCE_3, textured(DEPTHS), XP),
        (GEFORCE_3, compared(mode=BaseFormat.LUMINANCE), XP),
        (GEFORCE_3, textured(texture_3d(np.zeros((2, 2, 2, 4)))), XP),
        (GEFORCE_3, compared(ComparisonFunction.LESS), OF_2002),
        (GEFORCE_3, compared(mode=BaseFormat.ALPHA), OF_2002),
    ],
)
def test_drivers_refuse_what_came_later_and_name_the_first_that_had_it(machine, frame, first):
    names = [driver.name for driver in machine.drivers]
    for name in names:
        sentence = refusal(frame, machine.with_driver(name))
        if names.index(name) >= names.index(first):
            assert sentence is None
        else:
            assert f"{machine.name} with {name}" in sentence
            assert sentence.endswith(f" It came with {first}.")


def test_the_first_driver_says_what_to_do_instead_of_blue():
    sentence = refusal(BLUE, GEFORCE_256.with_driver("Release 4"))
    assert "G of GeForce 256 with Release 4 takes ALPHA alone. Copy blue to an alpha" in sentence
    assert refusal(BLUE, GEFORCE_256) is None


def test_what_no_driver_had_is_refused_without_a_driver_s_name():
    frame = textured(PICTURE, Sampler(NEAREST, NEAREST, max_probes=2))
    for machine in (GEFORCE_3, GEFORCE_3.with_driver("before Detonator XP")):
        assert "takes up to 1: set max_probes to it." in refusal(frame, machine)
        assert "It came with" not in refusal(frame, machine)


def test_what_a_machine_holds_and_a_host_step_issues_is_known_to_later_drivers():
    machine = Machine(GEFORCE_3.with_driver(XP), 4, 4)
    store, draw = compared(ComparisonFunction.LESS)
    machine.run((store,))
    with pytest.raises(UnsupportedState, match=r"It came with a driver of 2002\.$"):
        machine.run((draw,))
    with pytest.raises(UnsupportedState, match=r'from HostStep "late" on.* It came with a driver of 2002\.$'):
        machine.run((HostStep(label="late", reads=(), commands=lambda pixels: (draw,)),))


def test_a_driver_draws_what_the_machine_draws():
    frame = compared(mode=BaseFormat.LUMINANCE)
    own = execute(frame, GEFORCE_3, 4, 4).framebuffer.color
    np.testing.assert_array_equal(execute(frame, GEFORCE_3.with_driver(XP), 4, 4).framebuffer.color, own)
