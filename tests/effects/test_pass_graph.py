"""The graph of a frame's passes: versions of textures, dependent lookups, host steps, what steps keep."""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.effects.diagrams import pass_graph
from fixedpipe.effects.diagrams.pass_graph import By, Lookup, Picture
from fixedpipe.effects.geometry.views import Panel
from fixedpipe.effects.passes import combiners as c
from fixedpipe.effects.passes.draws import unit
from fixedpipe.effects.passes.texture_shaders import ALPHA_RED_STAGE, TEXTURE_STAGE
from fixedpipe.pipeline.commands import (
    Clear,
    CopyTexImage,
    CopyTexSubImage,
    Draw,
    DrawPixels,
    HostStep,
    Mesh,
    ReadPixels,
    TexImage,
)
from fixedpipe.pipeline.enums import PrimitiveType
from fixedpipe.pipeline.pixel_transfer import PixelImage
from fixedpipe.pipeline.state import PassState, PixelTexture
from fixedpipe.pipeline.textures.images import texture_2d

PANEL, OTHER = Panel(0, 0, 8, 8), Panel(8, 0, 8, 8)
BOX = {"x": 0, "y": 0, "width": 8, "height": 8}
SQUARE = Mesh(np.zeros((4, 2)), PrimitiveType.QUADS)
IMAGE = texture_2d(np.zeros((8, 8, 3)))


def load(name):
    return TexImage(label=f"load {name}", texture=name, image=IMAGE)


def drawn(*textures, panel=PANEL, **state):
    units = tuple(unit(name) for name in textures)
    return Draw(
        label="draw", mesh=SQUARE, state=PassState(texture_units=units, scissor=panel.scissor, **state)
    )


def kept(name, **box):
    return CopyTexSubImage(label=f"keep {name}", texture=name, **(BOX | box))


def test_what_is_kept_under_one_name_is_another_picture_each_time():
    commands = (load("L"), drawn(), kept("L"), drawn("L"), kept("L"), drawn("L"))
    first, second, third = pass_graph.steps_of(commands, PANEL)
    assert (first.kept, second.kept, third.kept) == ((Picture("L", 1),), (Picture("L", 2),), ())
    assert second.lookups == (Lookup(Picture("L", 1), By.VERTICES),)
    assert third.lookups == (Lookup(Picture("L", 2), By.VERTICES),)


def test_a_step_goes_to_what_keeps_it_and_has_each_lookup_once():
    clear = Clear(label="black", color=(0.0,) * 4, scissor=PANEL.scissor)
    commands = (load("a"), load("b"), clear, drawn("a"), drawn("a", "b"), kept("L"), drawn("b"))
    first, second = pass_graph.steps_of(commands, PANEL)
    assert len(first.commands) == 3 and len(second.commands) == 1
    assert [lookup.picture.name for lookup in first.lookups] == ["a", "b"]


def test_other_panels_take_no_part():
    copy = CopyTexImage(label="copy", texture="L", **(BOX | {"x": 8}))
    commands = (drawn("a", panel=OTHER), copy, drawn("b"), replace(drawn("c"), state=PassState()))
    (step,) = pass_graph.steps_of(commands, PANEL)
    assert [lookup.picture.name for lookup in step.lookups] == ["b"] and step.kept == ()


def test_texels_of_another_unit_are_coordinates():
    shader = (TEXTURE_STAGE, ALPHA_RED_STAGE, TEXTURE_STAGE)
    (step,) = pass_graph.steps_of((drawn("S", "L", "n", texture_shader=shader),), PANEL)
    assert step.dependent == (Lookup(Picture("L", 0), Picture("S", 0)),)
    assert [lookup.coordinates for lookup in step.lookups[::2]] == [By.VERTICES, By.VERTICES]


def test_a_pixel_texture_is_looked_up_by_an_image():
    state = PassState(texture_units=(unit("L"),), scissor=PANEL.scissor)
    image = PixelImage(np.zeros((8, 8, 3), np.uint8), "RGB")
    command = DrawPixels(label="S", image=image, state=state, pixel_texture=PixelTexture())
    (step,) = pass_graph.steps_of((command, replace(command, pixel_texture=None)), PANEL)
    assert step.lookups == (Lookup(Picture("L", 0), By.IMAGE),) and len(step.commands) == 2


def test_the_host_looks_up_what_it_has_read():
    def commands(pixels):
        assert pixels["L"].shape == (8, 8, 4) and not pixels["L"].any()
        return load("found"), drawn("found", "a")

    host = HostStep(label="look up", reads=("L",), commands=commands)
    read = ReadPixels(label="read", name="L", **BOX)
    first, second = pass_graph.steps_of((drawn(), kept("L"), read, host), PANEL)
    assert first.kept == (Picture("L", 0),)
    # What the host made of it is no picture of the frame's.
    assert second.lookups == (Lookup(Picture("L", 0), By.HOST), Lookup(Picture("a", 0), By.VERTICES))


def test_nothing_drawn_is_no_step():
    assert pass_graph.steps_of((load("a"), kept("a")), PANEL) == ()


@pytest.mark.parametrize(
    ("program", "read"),
    [
        (c.program(c.dot(c.expand(c.TEXTURE2), c.PRIMARY, to=c.SPARE0), c.final(c.SPARE0)), (2,)),
        (c.program(c.final(c.product(c.SPARE0, c.TEXTURE1), c.TEXTURE3)), (1, 3)),
        (c.program(c.product(c.PRIMARY, c.CONSTANT0, to=c.TEXTURE0), c.final(c.SPARE0)), ()),
    ],
)
def test_units_that_combiners_read(program, read):
    assert pass_graph.textures_combined(program) == read
