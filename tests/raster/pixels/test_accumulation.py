"""Accum, the accumulation buffer's Clear, and auxiliary buffers: equal to the specification, and refused
where a machine has none.
"""

import copy
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fixedpipe.pipeline.commands import (
    Accum,
    Clear,
    CopyTexImage,
    CopyTexSubImage,
    Draw,
    MakeCurrent,
    Mesh,
    ReadPixels,
)
from fixedpipe.pipeline.description.describe import describe
from fixedpipe.pipeline.enums import AccumOperation, ColorBuffer, ComparisonFunction, InternalFormat
from fixedpipe.pipeline.execution.machine import Machine, execute
from fixedpipe.pipeline.profiles import GEFORCE_256, INFINITE_REALITY, NV2A, OPENGL_1_2
from fixedpipe.pipeline.state import ColorMask, DepthTest, PassState, Scissor
from fixedpipe.pipeline.validation.validate import validate
from fixedpipe.pipeline.validation.walk import UnsupportedState
from fixedpipe.raster.pixels.accumulation import from_colors, to_colors
from tests.reference import accumulation as reference

WIDTH, HEIGHT = 5, 4
BUFFERS = (ColorBuffer.BACK, ColorBuffer.AUX0, ColorBuffer.AUX1)
FILL = Mesh(np.array([[-1.0, -1], [3, -1], [-1, 3]]))
values = st.one_of(
    st.sampled_from([0.0, 1.0, 0.5, -1.0, 1 / 3, 1 / 64, 2.0, 1e308, -1e308]), st.floats(-3, 3)
)
boxes = st.none() | st.builds(
    Scissor, x=st.integers(-2, 6), y=st.integers(-2, 6), width=st.integers(0, 7), height=st.integers(0, 7)
)
unit = st.floats(0, 1)
colors = st.tuples(unit, unit, unit, unit)
masks = st.builds(ColorMask, *[st.booleans()] * 4)
accums = st.builds(
    Accum,
    label=st.just("accumulate"),
    operation=st.sampled_from(AccumOperation),
    value=values,
    scissor=boxes,
    color_mask=masks,
    read_buffer=st.sampled_from(BUFFERS),
    draw_buffer=st.sampled_from(BUFFERS),
)
clears = st.builds(
    Clear,
    label=st.just("clear"),
    color=st.none() | colors,
    accumulation=st.none() | st.tuples(*[st.floats(-1, 1)] * 4),
    scissor=boxes,
    color_mask=masks,
    draw_buffer=st.sampled_from(BUFFERS),
)


def clear_to(color, **more):
    return Clear(label="clear", color=color, **more)


def accum(operation, value=1.0, **more):
    return Accum(label="accumulate", operation=operation, value=value, **more)


def by_reference(commands, profile):
    """(colours of each buffer, accumulation), nested lists."""

    def zeros():
        return [[[0] * 4 for _ in range(WIDTH)] for _ in range(HEIGHT)]

    planes, accumulation, size = {which: zeros() for which in BUFFERS}, zeros(), (WIDTH, HEIGHT)
    for command in commands:
        if isinstance(command, Accum):
            read, written = planes[command.read_buffer], planes[command.draw_buffer]
            bits = profile.framebuffers.accumulation_bits
            reference.accumulate(accumulation, copy.deepcopy(read), written, command, size, 255, bits)
            continue
        if command.color is not None:
            plain = replace(command, accumulation=None, draw_buffer=ColorBuffer.BACK)
            before = Machine(profile, WIDTH, HEIGHT)
            before.framebuffer.color[:] = planes[command.draw_buffer]
            planes[command.draw_buffer] = before.run((plain,)).framebuffer.color.tolist()
        if command.accumulation is not None:
            scissor, bits = command.scissor, profile.framebuffers.accumulation_bits
            reference.clear(accumulation, command.accumulation, scissor, size, bits)
    return planes, accumulation


@settings(max_examples=60)
@given(st.lists(clears | accums, min_size=1, max_size=8))
def test_accumulation_is_the_specifications(commands):
    profile = OPENGL_1_2
    machine = Machine(profile, WIDTH, HEIGHT)
    framebuffer = machine.run(tuple(commands)).framebuffer
    planes, accumulation = by_reference(commands, profile)
    for which, plane in planes.items():
        assert framebuffer.buffer(which).color.tolist() == plane, which.name
    if framebuffer.accumulation is None:
        assert not np.any(accumulation)
    else:
        assert framebuffer.accumulation.tolist() == accumulation


@pytest.mark.parametrize("bits", [16, 24])
@pytest.mark.parametrize("one", [255, 4095])
def test_every_component_comes_back_as_it_was_loaded(bits, one):
    full, components = reference.full_scale(bits), np.arange(one + 1, dtype=np.int32)
    loaded = from_colors(components, one, 1.0, full)
    assert loaded.tolist() == [reference.stored((c / one) * full, full) for c in range(one + 1)]
    assert to_colors(loaded, one, 1.0, full).tolist() == list(range(one + 1))


def test_many_weighted_pictures_lose_little_of_sixteen_bits():
    """A mean of 100 pictures of 200: each share is rounded to 257, so that 25700 of 32767 come back."""
    load, more = accum(AccumOperation.LOAD, 0.01), accum(AccumOperation.ACCUM, 0.01)
    commands = (clear_to((200 / 255, 0.0, 1.0, 1.0)), load, *[more] * 99, accum(AccumOperation.RETURN))
    result = execute(commands, OPENGL_1_2, 1, 1)
    assert result.framebuffer.accumulation[0, 0].tolist() == [25700, 0, 32767, 32767]
    assert result.framebuffer.color[0, 0].tolist() == [200, 0, 255, 255]


def test_auxiliary_buffers_share_depths_and_are_drawn_to_read_and_copied():
    nearer = PassState(depth_test=DepthTest(ComparisonFunction.LESS), draw_buffer=ColorBuffer.AUX0)
    red = replace(FILL, colors=np.array([[1.0, 0, 0]] * 3))
    commands = (
        clear_to((0.0, 1.0, 0.0, 1.0), depth=1.0),
        Draw(label="red behind, into AUX0", mesh=red, state=nearer),
        Draw(label="hidden by AUX0's depth", mesh=FILL, state=replace(nearer, draw_buffer=ColorBuffer.BACK)),
        CopyTexImage(label="keep", texture="kept", read_buffer=ColorBuffer.AUX0),
        clear_to((0.0, 0.0, 1.0, 1.0), draw_buffer=ColorBuffer.AUX0),
        CopyTexSubImage(
            label="part", texture="kept", width=2, height=1, x_offset=1, read_buffer=ColorBuffer.AUX0
        ),
        ReadPixels(label="read", name="aux", read_buffer=ColorBuffer.AUX0),
        ReadPixels(label="read", name="back"),
    )
    profile = OPENGL_1_2.changed(power_of_two_textures=False)
    for engine in (None, "portable"):
        result = execute(commands, profile, WIDTH, HEIGHT, engine=engine, trace=True)
        kept = result.textures["kept"].levels[0][0]
        assert (kept[1:] == (255, 0, 0, 255)).all()
        assert kept[0].tolist() == [[255, 0, 0, 255], *[[0, 0, 255, 255]] * 2, *[[255, 0, 0, 255]] * 2]
        assert (result.pixels["aux"] == (0, 0, 255, 255)).all()
        assert (result.pixels["back"] == (0, 255, 0, 255)).all()
        assert (result.trace[1].color == (255, 0, 0, 255)).all()
    assert result.textures["kept"].internal_format is InternalFormat.RGBA8


WITHOUT = GEFORCE_256.changed(accumulation_bits=0)
REFUSED = [
    (WITHOUT, accum(AccumOperation.LOAD), "no accumulation buffer"),
    (WITHOUT, clear_to(None, accumulation=(0.0,) * 4), "no accumulation buffer"),
    (OPENGL_1_2, clear_to(None, accumulation=(0.0, 2.0, 0.0, 0.0)), "it holds -1 to 1"),
    (OPENGL_1_2, accum(AccumOperation.MULT, float("nan")), "give a finite number"),
    (OPENGL_1_2, accum(AccumOperation.LOAD, read_buffer=ColorBuffer.AUX2), "so no AUX2"),
    (OPENGL_1_2, accum(AccumOperation.RETURN, draw_buffer=ColorBuffer.AUX3), "so no AUX3"),
    (OPENGL_1_2, clear_to(None, draw_buffer=ColorBuffer.AUX2), "so no AUX2"),
    (OPENGL_1_2, Draw(label="d", mesh=FILL, state=PassState(draw_buffer=ColorBuffer.AUX2)), "so no AUX2"),
    (OPENGL_1_2, ReadPixels(label="r", name="r", read_buffer=ColorBuffer.AUX2), "so no AUX2"),
    (OPENGL_1_2, accum(AccumOperation.ADD, scissor=Scissor(0, 0, -1, 1)), "scissor box is -1x1"),
]


@pytest.mark.parametrize(("profile", "command", "words"), REFUSED)
def test_what_a_machine_lacks_is_refused(profile, command, words):
    with pytest.raises(UnsupportedState, match=words):
        validate((command,), profile, 8, 8)


def test_a_pbuffer_has_neither_even_after_the_window_took_the_same_commands():
    profile = NV2A.changed(auxiliary_buffers=1, accumulation_bits=16)
    state = PassState(draw_buffer=ColorBuffer.AUX0)
    current = MakeCurrent(label="pbuffer", surface="p", width=4, height=4)
    for command in (
        Draw(label="d", mesh=FILL, state=state),
        clear_to((0.0,) * 4, draw_buffer=ColorBuffer.AUX0),
        clear_to(None, accumulation=(0.0,) * 4),
        accum(AccumOperation.ADD),
    ):
        validate((command, command), profile, 4, 4)
        with pytest.raises(UnsupportedState, match="a pbuffer has no"):
            validate((current, command), profile, 4, 4)
        validate((current, MakeCurrent(label="window"), command), profile, 4, 4)


def test_accumulation_prints_as_words():
    text = describe(
        (
            clear_to(None, accumulation=(0.0,) * 4),
            accum(AccumOperation.LOAD, 0.5, read_buffer=ColorBuffer.AUX0),
            accum(AccumOperation.RETURN, color_mask=ColorMask(alpha=False)),
        )
    )
    assert "clears accumulation to (0, 0, 0, 0)" in text
    assert "the accumulation buffer becomes 0.5 times AUX0" in text
    assert (
        "the framebuffer becomes 1 times the accumulation buffer\n   color mask writes red, green, blue"
        in text
    )


def test_a_wider_buffer_is_that_of_its_machine():
    commands = (clear_to((1.0, 0.5, 0.0, 1.0)), accum(AccumOperation.LOAD, 0.5))
    result = execute(commands, INFINITE_REALITY, 2, 2, depth_bits=INFINITE_REALITY.framebuffers.depth_bits[0])
    full, one = 2**23 - 1, 2**result.framebuffer.color_bits - 1
    half = np.floor(0.5 * one + 0.5) / one
    stored = [np.floor(c * 0.5 * full + 0.5) for c in (1.0, half, 0.0, 1.0)]
    assert result.framebuffer.accumulation[0, 0].tolist() == stored
