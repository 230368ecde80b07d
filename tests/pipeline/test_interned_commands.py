"""Equal commands of two frames become one object, and no command becomes one that differs in a bit."""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.effects.figures import FIGURES
from fixedpipe.pipeline.commands import Clear, Draw, HostStep, Mesh, TexImage
from fixedpipe.pipeline.enums import PrimitiveType
from fixedpipe.pipeline.interned_commands import in_common
from fixedpipe.pipeline.pixel_transfer import PixelImage, PixelTransfer
from fixedpipe.pipeline.profiles import IDEAL
from fixedpipe.pipeline.state import Blending, ColorMask, PassState
from fixedpipe.pipeline.textures.images import texture_2d
from tests.support.random_frames import random_frame


def frame(
    corner=0.0,
    primitive=PrimitiveType.TRIANGLES,
    label="draw",
    state=None,
    texel=7,
    scale=1.0,
    red=0.0,
    pixel=0.5,
    kind=np.float32,
):
    """A frame whose every part is made anew."""
    mesh = Mesh([[corner, 0], [1, 0], [0, 1]], primitive, texture_coordinates=([[0, 0], [1, 0], [0, 1]],))
    image = texture_2d(np.full((2, 2, 4), texel, np.uint8))
    pixels = PixelImage(np.full((2, 2, 3), pixel, kind), "RGB")
    transfer = PixelTransfer(scale=(scale, 1.0, 1.0, 1.0))
    return (
        Clear(label="clear", color=(red, 0.0, 0.0, 0.0)),
        TexImage(label="image", texture="i", image=image),
        TexImage(label="pixels", texture="p", pixels=pixels, transfer=transfer),
        Draw(label=label, mesh=mesh, state=PassState(blending=Blending()) if state is None else state),
    )


def test_equal_frames_become_one():
    first, second = frame(), frame()
    assert not any(one is other for one, other in zip(first, second, strict=True))
    found = in_common(second, first)
    assert type(found) is tuple and all(one is other for one, other in zip(found, first, strict=True))


DIFFERENT = {
    "a position": (3, {"corner": 1e-300}),
    "a sign of zero in an array": (3, {"corner": -0.0}),
    "a primitive type": (3, {"primitive": PrimitiveType.TRIANGLE_STRIP}),
    "a label": (3, {"label": "other"}),
    "a state": (3, {"state": PassState()}),
    "a state of other types": (3, {"state": PassState(blending=Blending(), color_mask=ColorMask(red=1))}),
    "a texel": (1, {"texel": 8}),
    "a transfer": (2, {"scale": 1.0 + 2.0**-52}),
    "a type": (2, {"scale": 1}),
    "a pixel": (2, {"pixel": 0.25}),
    "an array's type": (2, {"kind": np.float64}),
    "a sign of zero": (0, {"red": -0.0}),
}


@pytest.mark.parametrize(("number", "change"), DIFFERENT.values(), ids=DIFFERENT)
def test_what_differs_stays_as_it_is(number, change):
    first, second = frame(), frame(**change)
    found = in_common(second, first)
    for k, (one, other, own) in enumerate(zip(found, first, second, strict=True)):
        assert one is (own if k == number else other)


def test_not_a_number_and_functions_equal_nothing():
    nan = frame(red=float("nan")), frame(red=float("nan"))
    assert in_common(nan[1], nan[0])[0] is nan[1][0]
    steps = [(HostStep(label="h", reads=(), commands=lambda pixels: ()),) for _ in range(2)]
    assert in_common(steps[1], steps[0]) == steps[1]


@pytest.mark.parametrize("extra", [0, 1])
def test_a_longer_frame_keeps_its_end(extra):
    first, second = frame(), frame()
    longer = (*second, Clear(label="end"))
    assert in_common(longer, first) == (*first, longer[-1])
    assert in_common(second[:2], first) == first[:2]
    assert in_common((), first) == ()
    assert in_common(second, ()) == second


def test_of_random_frames_a_changed_command_is_found():
    for seed in range(20):
        commands, again = random_frame(seed).commands, random_frame(seed).commands
        shared = in_common(again, commands)
        changed = [replace(command, label="other") for command in again if type(command) is Draw]
        assert not any(
            one is other for one, other in zip(in_common(changed, commands), commands, strict=False)
        )
        assert len(shared) == len(commands)
        draws = [(a, b) for a, b in zip(shared, commands, strict=True) if type(a) is Draw]
        assert all(one is other for one, other in draws)


def test_a_figure_s_ideal_draws_the_machine_s_own_draws():
    figure = FIGURES["F003-22"]
    machine = figure.commands("GEFORCE_3", 16)
    ideal = figure.commands(IDEAL, 16, figure.method("GEFORCE_3"))
    draws = [(a, b) for a, b in zip(machine, ideal, strict=True) if type(a) is Draw]
    assert draws and all(one is other for one, other in draws)
