"""Framebuffer objects: what is drawn into them, and their textures (EXT_framebuffer_object)."""

import numpy as np
import pytest

from fixedpipe.pipeline.commands import BindTexImage, CopyTexSubImage, MakeCurrent
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.opengl import tokens as T
from fixedpipe.pipeline.opengl.context import Context
from fixedpipe.pipeline.profiles import GEFORCE_3

RED, GREEN, BLUE = (1.0, 0.0, 0.0, 1.0), (0.0, 1.0, 0.0, 1.0), (0.0, 0.0, 1.0, 1.0)
BYTES = {RED: [255, 0, 0, 255], GREEN: [0, 255, 0, 255], BLUE: [0, 0, 255, 255]}
F, COLOR, DEPTH = T.FRAMEBUFFER_EXT, T.COLOR_ATTACHMENT0_EXT, T.DEPTH_ATTACHMENT_EXT


@pytest.fixture
def gl():
    """A context of a window of 8x8 pixels."""
    return Context(GEFORCE_3, 8, 8)


def texture(gl, number, size=8, internal_format=T.RGBA, image=None, target=T.TEXTURE_2D, levels=1):
    gl.BindTexture(target, number)
    gl.TexParameteri(target, T.TEXTURE_MIN_FILTER, T.NEAREST)
    gl.TexParameteri(target, T.TEXTURE_MAG_FILTER, T.NEAREST)
    for level in range(levels):
        edge = size >> level
        gl.TexImage2D(target, level, internal_format, edge, edge, 0, T.RGBA, T.UNSIGNED_BYTE, image)


def object_of(gl, number, attached, point=COLOR, level=0, target=T.TEXTURE_2D):
    gl.BindFramebuffer(F, number)
    gl.FramebufferTexture2D(F, point, target, attached, level)


def clear(gl, color):
    gl.ClearColor(*color)
    gl.Clear(T.COLOR_BUFFER_BIT | T.DEPTH_BUFFER_BIT)


def rectangle(gl, color=(1.0, 1.0, 1.0, 1.0), left=-1.0, right=1.0):
    gl.Color4f(*color)
    gl.Begin(T.QUADS)
    for s, t in ((0, 0), (1, 0), (1, 1), (0, 1)):
        gl.TexCoord2f(s, t)
        gl.Vertex2f(left + (right - left) * s, -1.0 + 2.0 * t)
    gl.End()


def textured(gl, number, size=8):
    """The window, drawn with a texture: bottom row first."""
    gl.BindFramebuffer(F, 0)
    gl.Viewport(0, 0, 8, 8)
    gl.Enable(T.TEXTURE_2D)
    gl.BindTexture(T.TEXTURE_2D, number)
    rectangle(gl)
    assert not list(gl.tally.of("refused")), list(gl.tally.of("refused"))
    return Machine(GEFORCE_3, 8, 8).run(gl.take_commands()).image()[::-1]


def test_what_is_drawn_into_a_texture_is_drawn_with(gl):
    texture(gl, 1)
    clear(gl, BLUE)
    object_of(gl, 5, 1)
    assert gl.CheckFramebufferStatus(F) == T.FRAMEBUFFER_COMPLETE_EXT
    clear(gl, RED)
    rectangle(gl, GREEN, 0.0)
    picture = textured(gl, 1)
    assert picture[0, 0].tolist() == BYTES[RED] and picture[0, 7].tolist() == BYTES[GREEN]


def test_a_pbuffer_of_its_size_is_current_while_it_is_bound(gl):
    texture(gl, 1, 16)
    object_of(gl, 5, 1)
    rectangle(gl)
    gl.BindFramebuffer(F, 0)
    rectangle(gl)
    kinds = [(type(c).__name__, getattr(c, "surface", "")) for c in gl.take_commands()]
    assert [kind for kind, _ in kinds] == [
        "MakeCurrent",
        "MakeCurrent",
        "Draw",
        "BindTexImage",
        "MakeCurrent",
        "Draw",
    ]
    assert kinds[1][1] == kinds[3][1] == "texture 1, 16x16 A8R8G8B8" and kinds[4][1] is None


def test_the_texels_of_before_are_in_the_pbuffer(gl):
    texture(gl, 1, image=bytes(BYTES[BLUE]) * 64)
    object_of(gl, 5, 1)
    gl.Viewport(0, 0, 8, 8)
    rectangle(gl, GREEN, 0.0)
    picture = textured(gl, 1)
    assert picture[0, 0].tolist() == BYTES[BLUE] and picture[0, 7].tolist() == BYTES[GREEN]


def test_what_the_program_gives_later_replaces_what_was_drawn(gl):
    texture(gl, 1)
    object_of(gl, 5, 1)
    clear(gl, RED)
    gl.BindFramebuffer(F, 0)
    texture(gl, 1, image=bytes(BYTES[BLUE]) * 64)
    gl.BindFramebuffer(F, 5)
    rectangle(gl, GREEN, 0.0)
    picture = textured(gl, 1)
    assert picture[0, 0].tolist() == BYTES[BLUE] and picture[0, 7].tolist() == BYTES[GREEN]


def test_a_texture_without_alpha_has_alpha_one(gl):
    texture(gl, 1, internal_format=T.RGB)
    object_of(gl, 5, 1)
    clear(gl, (1.0, 0.0, 0.0, 0.0))
    gl.Enable(T.BLEND)
    gl.BlendFunc(T.DST_ALPHA, T.ZERO)
    rectangle(gl, GREEN, 0.0)
    gl.Disable(T.BLEND)
    picture = textured(gl, 1)
    assert picture[0, 0].tolist() == BYTES[RED] and picture[0, 7].tolist() == BYTES[GREEN]


def test_a_level_of_several_is_copied_into_its_texture(gl):
    texture(gl, 1, levels=4)
    gl.TexParameteri(T.TEXTURE_2D, T.TEXTURE_MIN_FILTER, T.NEAREST_MIPMAP_NEAREST)
    object_of(gl, 5, 1, level=0)
    gl.Viewport(0, 0, 8, 8)
    clear(gl, RED)
    gl.FramebufferTexture2D(F, COLOR, T.TEXTURE_2D, 1, 1)
    clear(gl, GREEN)
    gl.BindFramebuffer(F, 0)
    commands = gl.commands
    assert [c.level for c in commands if isinstance(c, CopyTexSubImage)] == [0, 1]
    assert not any(isinstance(c, BindTexImage) for c in commands)
    assert textured(gl, 1)[0, 0].tolist() == BYTES[RED]


def test_faces_of_a_cube_map(gl):
    gl.BindTexture(T.TEXTURE_CUBE_MAP, 2)
    gl.TexParameteri(T.TEXTURE_CUBE_MAP, T.TEXTURE_MIN_FILTER, T.NEAREST)
    for face in range(6):
        target = T.TEXTURE_CUBE_MAP_POSITIVE_X + face
        gl.TexImage2D(target, 0, T.RGBA, 8, 8, 0, T.RGBA, T.UNSIGNED_BYTE, None)
    for face, color in ((0, RED), (4, GREEN)):
        object_of(gl, 5, 2, target=T.TEXTURE_CUBE_MAP_POSITIVE_X + face)
        clear(gl, color)
    gl.BindFramebuffer(F, 0)
    gl.Enable(T.TEXTURE_CUBE_MAP)
    gl.BindTexture(T.TEXTURE_CUBE_MAP, 2)
    gl.Color4f(1.0, 1.0, 1.0, 1.0)
    for left, direction in ((-1.0, (1, 0, 0)), (0.0, (0, 0, 1))):
        gl.Begin(T.QUADS)
        gl.TexCoord3f(*direction)
        for s, t in ((0, 0), (1, 0), (1, 1), (0, 1)):
            gl.Vertex2f(left + s, -1.0 + 2.0 * t)
        gl.End()
    picture = Machine(GEFORCE_3, 8, 8).run(gl.take_commands()).image()
    assert [picture[0, 0].tolist(), picture[0, 7].tolist()] == [BYTES[RED], BYTES[GREEN]]


def test_depths_become_a_depth_texture(gl):
    gl.BindTexture(T.TEXTURE_2D, 3)
    gl.TexParameteri(T.TEXTURE_2D, T.TEXTURE_MIN_FILTER, T.NEAREST)
    gl.TexParameteri(T.TEXTURE_2D, T.TEXTURE_MAG_FILTER, T.NEAREST)
    size = (8, 8, 0, T.DEPTH_COMPONENT, T.UNSIGNED_INT, None)
    gl.TexImage2D(T.TEXTURE_2D, 0, T.DEPTH_COMPONENT24, *size)
    texture(gl, 1)
    object_of(gl, 5, 1)
    object_of(gl, 5, 3, DEPTH)
    assert gl.CheckFramebufferStatus(F) == T.FRAMEBUFFER_COMPLETE_EXT
    gl.ClearDepth(0.25)
    clear(gl, RED)
    assert abs(int(textured(gl, 3)[0, 0, 0]) - 64) <= 1


def test_an_image_that_no_machine_stores_is_drawn_into(gl):
    texture(gl, 1, 5)
    assert list(gl.tally.of("error"))
    object_of(gl, 5, 1)
    assert gl.CheckFramebufferStatus(F) == T.FRAMEBUFFER_COMPLETE_EXT
    made = [c for c in gl.commands if isinstance(c, MakeCurrent)][-1]
    assert (made.width, made.height) == (5, 5)
    rectangle(gl, RED)
    machine = Machine(GEFORCE_3, 8, 8)
    machine.run(gl.take_commands())
    np.testing.assert_array_equal(machine.surfaces[made.surface].image()[0, 0], BYTES[RED])


def test_renderbuffers(gl):
    gl.BindRenderbuffer(T.RENDERBUFFER_EXT, 4)
    gl.BindFramebuffer(F, 5)
    gl.FramebufferRenderbuffer(F, COLOR, T.RENDERBUFFER_EXT, 4)
    assert gl.CheckFramebufferStatus(F) == T.FRAMEBUFFER_INCOMPLETE_ATTACHMENT_EXT
    gl.RenderbufferStorage(T.RENDERBUFFER_EXT, T.RGBA8, 6, 3)
    assert gl.CheckFramebufferStatus(F) == T.FRAMEBUFFER_COMPLETE_EXT
    clear(gl, GREEN)
    machine = Machine(GEFORCE_3, 8, 8)
    machine.run(gl.take_commands())
    (surface,) = [s for name, s in machine.surfaces.items() if name.startswith("renderbuffer 4")]
    assert surface.image().shape == (3, 6, 4) and surface.image()[0, 0].tolist() == BYTES[GREEN]
    gl.DeleteRenderbuffers(1, [4])
    assert gl.CheckFramebufferStatus(F) == T.FRAMEBUFFER_INCOMPLETE_MISSING_ATTACHMENT_EXT
    assert not gl.IsRenderbuffer(4) and gl.IsFramebuffer(5)


@pytest.mark.parametrize("storage", [(T.RGBA8, 4, 4), (T.DEPTH_COMPONENT24, 8, 8)])
def test_what_is_incomplete(gl, storage):
    texture(gl, 1)
    object_of(gl, 5, 1)
    gl.BindRenderbuffer(T.RENDERBUFFER_EXT, 4)
    gl.RenderbufferStorage(T.RENDERBUFFER_EXT, *storage)
    point = T.COLOR_ATTACHMENT0_EXT + 1 if storage[1] == 4 else T.COLOR_ATTACHMENT0_EXT
    gl.FramebufferRenderbuffer(F, point, T.RENDERBUFFER_EXT, 4)
    assert gl.CheckFramebufferStatus(F) in (
        T.FRAMEBUFFER_INCOMPLETE_DIMENSIONS_EXT,
        T.FRAMEBUFFER_INCOMPLETE_ATTACHMENT_EXT,
    )
    clear(gl, BLUE)
    gl.BindFramebuffer(F, 0)
    clear(gl, RED)
    assert Machine(GEFORCE_3, 8, 8).run(gl.take_commands()).image()[0, 0].tolist() == BYTES[RED]


def test_the_windows_buffers_come_back(gl):
    gl.DrawBuffer(T.FRONT)
    texture(gl, 1)
    object_of(gl, 5, 1)
    gl.DrawBuffer(T.NONE)
    gl.BindFramebuffer(F, 0)
    assert gl.values["draw_buffer"] == T.FRONT
    gl.BindFramebuffer(F, 5)
    assert gl.values["draw_buffer"] == T.NONE


def test_deleting_what_is_bound_binds_the_window(gl):
    texture(gl, 1)
    object_of(gl, 5, 1)
    gl.DeleteFramebuffers(1, [5])
    assert gl.values["draw_framebuffer"] == 0 and gl.drawable is gl.window
    assert not gl.IsFramebuffer(5)
    assert gl.commands[-1] == MakeCurrent(label=gl.commands[-1].label)


def test_errors_and_refusals(gl):
    gl.FramebufferTexture2D(F, COLOR, T.TEXTURE_2D, 1, 0)
    gl.BindFramebuffer(T.TEXTURE_2D, 1)
    gl.BindFramebuffer(F, 5)
    gl.FramebufferTexture2D(F, COLOR, T.TEXTURE_2D, 77, 0)
    gl.FramebufferTexture2D(F, T.TEXTURE_2D, T.TEXTURE_2D, 0, 0)
    gl.RenderbufferStorage(T.RENDERBUFFER_EXT, T.RGBA8, 4, 4)
    gl.BindRenderbuffer(T.RENDERBUFFER_EXT, 4)
    gl.RenderbufferStorage(T.RENDERBUFFER_EXT, T.RGBA8, 1 << 20, 4)
    assert gl.tally.count("error") == 6
    gl.FramebufferTexture3D(F, COLOR, T.TEXTURE_3D, 1, 0, 2)
    assert gl.tally.count("refused") == 1


def test_attachments_can_be_asked_for(gl):
    texture(gl, 1)
    object_of(gl, 5, 1)
    ask = gl.GetFramebufferAttachmentParameteriv
    assert ask(F, COLOR, T.FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE_EXT) == T.TEXTURE
    assert ask(F, COLOR, T.FRAMEBUFFER_ATTACHMENT_OBJECT_NAME_EXT) == 1
    assert ask(F, DEPTH, T.FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE_EXT) == T.NONE


def test_mipmaps_of_what_was_drawn(gl):
    texture(gl, 1, levels=4)
    gl.TexParameteri(T.TEXTURE_2D, T.TEXTURE_MAX_LEVEL, 3)
    object_of(gl, 1, 1)
    clear(gl, GREEN)
    gl.BindFramebuffer(F, 0)
    gl.GenerateMipmap(T.TEXTURE_2D)
    gl.TexParameteri(T.TEXTURE_2D, T.TEXTURE_BASE_LEVEL, 2)
    assert (textured(gl, 1) == BYTES[GREEN]).all()


def test_mipmaps_of_what_is_drawn_while_the_object_is_bound(gl):
    texture(gl, 1, levels=4)
    gl.TexParameteri(T.TEXTURE_2D, T.TEXTURE_MAX_LEVEL, 3)
    object_of(gl, 1, 1)
    clear(gl, GREEN)
    gl.GenerateMipmap(T.TEXTURE_2D)
    gl.TexParameteri(T.TEXTURE_2D, T.TEXTURE_BASE_LEVEL, 2)
    assert (textured(gl, 1) == BYTES[GREEN]).all()


def test_a_changed_copy_is_read_while_an_object_is_bound(gl):
    clear(gl, GREEN)
    texture(gl, 1)
    gl.CopyTexImage2D(T.TEXTURE_2D, 0, T.RGBA, 0, 0, 8, 8, 0)
    gl.TexSubImage2D(T.TEXTURE_2D, 0, 0, 0, 1, 1, T.RGBA, T.UNSIGNED_BYTE, bytes(BYTES[GREEN]))
    texture(gl, 2)
    object_of(gl, 1, 2)
    gl.BindTexture(T.TEXTURE_2D, 1)
    gl.Enable(T.TEXTURE_2D)
    rectangle(gl)
    assert (textured(gl, 2) == BYTES[GREEN]).all()


def test_buffers_of_an_object_and_of_the_window(gl):
    texture(gl, 1)
    gl.DrawBuffer(COLOR)
    assert gl.error == T.INVALID_OPERATION
    object_of(gl, 1, 1)
    gl.DrawBuffer(T.NONE)
    clear(gl, RED)
    gl.DrawBuffer(COLOR)
    clear(gl, GREEN)
    gl.ReadBuffer(T.NONE)
    assert gl.GetIntegerv(T.READ_BUFFER) == T.NONE
    gl.ReadBuffer(COLOR)
    assert len(list(gl.tally.of("error"))) == 1
    assert (textured(gl, 1) == BYTES[GREEN]).all()
    gl.ReadBuffer(T.NONE)
    assert gl.GetIntegerv(T.READ_BUFFER) == T.BACK
