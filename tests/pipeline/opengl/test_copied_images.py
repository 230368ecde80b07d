"""Copies into textures: levels that the machine makes, and faces and levels that are missing or differ."""

import numpy as np
import pytest

from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.opengl import tokens as GL
from tests.pipeline.opengl.drawn import context, refusals

_RED, _GREEN = (255, 0, 0, 255), (0, 255, 0, 255)
_FACES = range(GL.TEXTURE_CUBE_MAP_POSITIVE_X, GL.TEXTURE_CUBE_MAP_POSITIVE_X + 6)


class Screen:
    """A Context of 64 x 64 pixels with a texture of ``target``, and its machine."""

    def __init__(self, target, minified=GL.NEAREST_MIPMAP_NEAREST):
        self.gl, self.target = context(width=64, height=64), target
        self.machine = Machine(self.gl.profile, 64, 64)
        self.gl.BindTexture(target, 1)
        self.gl.TexParameteri(target, GL.TEXTURE_MIN_FILTER, minified)
        self.gl.TexParameteri(target, GL.TEXTURE_MAG_FILTER, GL.NEAREST)
        self.gl.Enable(target)

    def generate(self, on=True):
        self.gl.TexParameteri(self.target, GL.GENERATE_MIPMAP, on)

    def clear(self, color):
        self.gl.ClearColor(*(c / 255.0 for c in color))
        self.gl.Clear(GL.COLOR_BUFFER_BIT)

    def shown(self):
        """One pixel with the whole texture, or the face +z: its bytes."""
        gl = self.gl
        self.clear((0, 0, 255, 255))
        gl.Viewport(0, 0, 1, 1)
        gl.Begin(GL.QUADS)
        for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
            if self.target == GL.TEXTURE_CUBE_MAP:
                gl.TexCoord3f(x, y, 1)
            else:
                gl.TexCoord3f((x + 1) / 2, (y + 1) / 2, 0.5)
            gl.Vertex2f(x, y)
        gl.End()
        assert not refusals(gl)
        return tuple(self.machine.run(gl.take_commands()).image()[-1, 0].tolist())


def test_a_copy_beyond_the_window_where_mipmaps_are_due():
    screen = Screen(GL.TEXTURE_2D)
    screen.clear(_RED)
    screen.generate()
    screen.gl.TexImage2D(GL.TEXTURE_2D, 0, GL.RGBA, 16, 16, 0, GL.RGBA, GL.UNSIGNED_BYTE, None)
    screen.gl.CopyTexImage2D(GL.TEXTURE_2D, 0, GL.RGBA, -4, 0, 16, 16, 0)
    # A quarter of the texels lies outside the window, and stays zero: 191.25, rounded by each of four means.
    assert screen.shown() in {(red, 0, 0, red) for red in (191, 192)}


def test_copies_make_the_levels_that_were_not_there():
    screen = Screen(GL.TEXTURE_2D)
    screen.clear(_RED)
    screen.gl.TexImage2D(GL.TEXTURE_2D, 0, GL.RGBA, 16, 16, 0, GL.RGBA, GL.UNSIGNED_BYTE, bytes(1024))
    screen.generate()
    screen.gl.CopyTexSubImage2D(GL.TEXTURE_2D, 0, 0, 0, 0, 0, 16, 16)
    assert screen.shown() == _RED


def test_copied_faces_have_mipmaps():
    screen = Screen(GL.TEXTURE_CUBE_MAP)
    screen.generate()
    for face in _FACES:
        screen.clear(_RED if face == GL.TEXTURE_CUBE_MAP_POSITIVE_Z else _GREEN)
        screen.gl.CopyTexImage2D(face, 0, GL.RGBA, 0, 0, 16, 16, 0)
    assert screen.shown() == _RED


def test_copied_layers_have_mipmaps():
    screen = Screen(GL.TEXTURE_3D)
    screen.clear(_RED)
    screen.generate()
    screen.gl.TexImage3D(GL.TEXTURE_3D, 0, GL.RGBA, 4, 4, 4, 0, GL.RGBA, GL.UNSIGNED_BYTE, bytes(256))
    for layer in range(4):
        screen.gl.CopyTexSubImage3D(GL.TEXTURE_3D, 0, 0, 0, layer, 0, 0, 4, 4)
    assert screen.shown() == _RED


def test_faces_may_be_copied_again_in_another_size():
    screen = Screen(GL.TEXTURE_CUBE_MAP, GL.NEAREST)
    for edge, color in ((4, _GREEN), (8, _RED)):
        screen.clear(color)
        for face in _FACES:
            screen.gl.CopyTexImage2D(face, 0, GL.RGBA, 0, 0, edge, edge, 0)
    assert screen.shown() == _RED


@pytest.mark.parametrize("once", [False, True])
def test_mipmaps_of_a_copy_that_the_program_changes_stay(once):
    """Where a HostStep made them, only the machine has them."""
    screen = Screen(GL.TEXTURE_2D)
    gl = screen.gl
    screen.clear(_RED)
    gl.CopyTexImage2D(GL.TEXTURE_2D, 0, GL.RGBA, 0, 0, 16, 16, 0)
    if once:
        gl.GenerateMipmapEXT(GL.TEXTURE_2D)
    else:
        screen.generate()
    for _ in range(2):
        gl.TexSubImage2D(GL.TEXTURE_2D, 0, 0, 0, 1, 1, GL.RGBA, GL.UNSIGNED_BYTE, bytes(_RED))
        assert screen.shown() == _RED
        screen.generate(False)


def test_a_texture_that_another_context_deletes_is_read_no_more():
    screen = Screen(GL.TEXTURE_2D, GL.NEAREST)
    image = np.array(_RED, np.uint8).tobytes()
    screen.gl.TexImage2D(GL.TEXTURE_2D, 0, GL.RGBA, 1, 1, 0, GL.RGBA, GL.UNSIGNED_BYTE, image)
    assert screen.shown() == _RED
    other = type(screen.gl)(screen.gl.profile, 64, 64, shared=screen.gl.shared)
    other.DeleteTextures(1, [1])
    assert screen.shown() == (255, 255, 255, 255)


@pytest.mark.parametrize("target", [GL.TEXTURE_1D, GL.TEXTURE_2D, GL.TEXTURE_CUBE_MAP])
@pytest.mark.parametrize("order", [(2, 1, 0), (1, 2, 0), (0, 2, 1)])
def test_levels_are_copied_in_any_order(target, order):
    """Each level has its colour, and one pixel reads level 2, which has one texel."""
    screen = Screen(target)
    gl, images = screen.gl, _FACES if target == GL.TEXTURE_CUBE_MAP else (target,)
    for level in order:
        screen.clear((255 if level == 2 else 0, 85 * level, 0, 255))
        for image in images:
            edge = 4 >> level
            if target == GL.TEXTURE_1D:
                gl.CopyTexImage1D(image, level, GL.RGBA, 0, 0, edge, 0)
            else:
                gl.CopyTexImage2D(image, level, GL.RGBA, 0, 0, edge, edge, 0)
    assert screen.shown() == (255, 170, 0, 255)
    gl.TexParameteri(target, GL.TEXTURE_MIN_FILTER, GL.NEAREST)
    assert screen.shown() == (0, 0, 0, 255)
    gl.TexParameteri(target, GL.TEXTURE_BASE_LEVEL, 1)
    assert screen.shown() == (0, 85, 0, 255)


def test_a_level_that_was_copied_alone_is_changed_by_copies_and_by_images():
    screen = Screen(GL.TEXTURE_2D, GL.NEAREST)
    gl = screen.gl
    screen.clear(_RED)
    gl.CopyTexImage2D(GL.TEXTURE_2D, 1, GL.RGBA, 0, 0, 2, 2, 0)
    screen.clear(_GREEN)
    gl.CopyTexSubImage2D(GL.TEXTURE_2D, 1, 0, 0, 0, 0, 1, 2)
    white = np.full((1, 2, 4), 255, np.uint8).tobytes()
    gl.TexSubImage2D(GL.TEXTURE_2D, 1, 0, 1, 2, 1, GL.RGBA, GL.UNSIGNED_BYTE, white)
    gl.CopyTexImage2D(GL.TEXTURE_2D, 0, GL.RGBA, 0, 0, 4, 4, 0)
    assert screen.shown() == _GREEN
    gl.TexParameteri(GL.TEXTURE_2D, GL.TEXTURE_BASE_LEVEL, 1)
    assert screen.shown() == (255, 255, 255, 255)
    texels = screen.machine.run(gl.take_commands()).textures["texture 1"].levels[1][0]
    assert texels.tolist() == [[[*_GREEN], [*_RED]], [[255] * 4] * 2]
