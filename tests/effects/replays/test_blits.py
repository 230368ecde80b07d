"""BlitFramebuffer (EXT_framebuffer_blit): within a framebuffer, and between two."""

import math

import numpy as np
import pytest

from fixedpipe.pipeline.opengl import tokens as T
from fixedpipe.pipeline.opengl.context import Context
from fixedpipe.pipeline.opengl.framebuffer_blits import side
from fixedpipe.pipeline.profiles import GEFORCE_3, PROFILES
from tests.effects.replays.programs import BLUE, BYTES, GREEN, RED, color_of, replayed, started
from tests.effects.replays.test_read_back import draw, refused

_READ, _DRAW, F = 0x8CA8, 0x8CA9, T.FRAMEBUFFER_EXT
_IMAGE = np.random.default_rng(1).integers(0, 256, (4, 8, 4), np.uint8)
# With pbuffers, and without.
_MACHINES = ("GEFORCE_3", "OPENGL_1_2")


def blit(program, source, target, mask=T.COLOR_BUFFER_BIT, filtering=T.NEAREST):
    return program.call("glBlitFramebufferEXT", *source, *target, mask, filtering)


def framebuffer(program, number=5, image=None, depths=False):
    """An object of 8x4 pixels, which is bound; of a texture of these texels."""
    data = None if image is None else image.tobytes()
    program.call("glBindTexture", T.TEXTURE_2D, number)
    program.call("glTexImage2D", T.TEXTURE_2D, 0, T.RGBA8, 8, 4, 0, T.RGBA, T.UNSIGNED_BYTE, data)
    program.call("glBindFramebufferEXT", F, number)
    program.call("glFramebufferTexture2DEXT", F, T.COLOR_ATTACHMENT0_EXT, T.TEXTURE_2D, number, 0)
    if depths:
        target = T.RENDERBUFFER_EXT
        program.call("glBindRenderbufferEXT", target, 1)
        program.call("glRenderbufferStorageEXT", target, T.DEPTH24_STENCIL8_EXT, 8, 4)
        for point in (T.DEPTH_ATTACHMENT_EXT, T.STENCIL_ATTACHMENT_EXT):
            program.call("glFramebufferRenderbufferEXT", F, point, target, 1)
    return program


def bound(program, reads, draws):
    return program.call("glBindFramebufferEXT", _READ, reads).call("glBindFramebufferEXT", _DRAW, draws)


def picture(program, profile=GEFORCE_3):
    """The last frame, bottom row first; no call goes wrong."""
    replay, frames = replayed(program, profile)
    assert not refused(replay)
    return frames[-1].image[::-1]


def _copied(image, source, target):
    """What NEAREST copies, and where no pixel lies on a border between two of the source."""
    made, sure = image.copy(), np.ones(image.shape[:2], bool)
    places = []
    for axis, width in enumerate((8, 4)):
        begin, end, at, until = source[axis], source[axis + 2], target[axis], target[axis + 2]
        of = {}
        for pixel in range(max(min(at, until), 0), min(max(at, until), width)):
            place = begin + (pixel + 0.5 - at) * (end - begin) / (until - at)
            if 0 <= place < width:
                of[pixel] = math.floor(place), abs(place - round(place)) < 1e-9
        places.append(of)
    for y, (row, tied) in places[1].items():
        for x, (column, also) in places[0].items():
            made[y, x], sure[y, x] = image[row, column], not (tied or also)
    return made, sure


@pytest.mark.parametrize(
    ("source", "target"),
    [
        ((0, 0, 4, 2), (4, 2, 8, 4)),
        ((0, 0, 2, 1), (2, 1, 8, 4)),
        ((1, 0, 6, 4), (0, 1, 3, 4)),
        ((0, 0, 8, 4), (8, 0, 0, 4)),
        ((2, 3, 5, 0), (7, 0, 1, 3)),
        ((-3, 1, 3, 3), (2, 0, 8, 2)),
        ((5, 2, 11, 6), (0, 0, 6, 4)),
        ((4, 0, 1, 3), (0, 0, 3, 3)),
    ],
)
def test_a_copy_within_the_window_takes_the_nearest_pixels(source, target):
    found = picture(blit(draw(started(), _IMAGE), source, target).swap())
    expected, sure = _copied(_IMAGE, source, target)
    assert (found == expected)[sure].all() and sure.any() and (expected != _IMAGE).any()


def test_a_copy_to_the_other_buffer():
    program = draw(started(), _IMAGE).call("glReadBuffer", T.BACK).call("glDrawBuffer", T.FRONT)
    blit(program, (0, 0, 8, 4), (0, 0, 8, 4)).call("glDrawBuffer", T.BACK)
    program.clear(RED).call("glReadBuffer", T.FRONT)
    found = picture(blit(program, (0, 0, 4, 4), (0, 0, 4, 4)).swap())
    assert (found[:, :4] == _IMAGE[:, :4]).all() and (found[:, 4:] == BYTES[RED]).all()


@pytest.mark.parametrize("machine", _MACHINES)
def test_what_was_drawn_into_an_object_is_copied_to_the_window(machine):
    program = framebuffer(started().clear(BLUE)).clear(RED).rectangle(GREEN, 0.0)
    bound(program, 5, 0)
    found = picture(blit(program, (2, 0, 6, 4), (0, 0, 4, 4)).swap(), PROFILES[machine])
    assert found[0, :, :].tolist() == [BYTES[RED]] * 2 + [BYTES[GREEN]] * 2 + [BYTES[BLUE]] * 4


@pytest.mark.parametrize("machine", _MACHINES)
def test_what_a_texture_was_given_is_copied(machine):
    program = framebuffer(started().clear(BLUE), image=_IMAGE)
    bound(program, 5, 0)
    found = picture(blit(program, (0, 0, 8, 4), (8, 0, 0, 4)).swap(), PROFILES[machine])
    assert (found == _IMAGE[:, ::-1]).all()


@pytest.mark.parametrize("machine", _MACHINES)
def test_the_window_is_copied_into_an_object_and_between_objects(machine):
    program = framebuffer(framebuffer(draw(started(), _IMAGE), 5), 6)
    blit(bound(program, 0, 5), (0, 0, 8, 4), (0, 0, 8, 4))
    blit(bound(program, 5, 6), (0, 0, 4, 4), (4, 0, 8, 4))
    bound(program, 6, 0).clear(RED)
    found = picture(blit(program, (4, 0, 8, 4), (0, 0, 4, 4)).swap(), PROFILES[machine])
    assert (found[:, :4] == _IMAGE[:, :4]).all() and (found[:, 4:] == BYTES[RED]).all()


def test_the_texture_of_an_object_that_was_copied_into_has_the_copy():
    program = framebuffer(draw(started(), _IMAGE))
    blit(bound(program, 0, 5), (0, 0, 8, 4), (0, 0, 8, 4))
    program.call("glBindFramebufferEXT", F, 0).clear(RED).call("glEnable", T.TEXTURE_2D)
    for name in (T.TEXTURE_MIN_FILTER, T.TEXTURE_MAG_FILTER):
        program.call("glTexParameteri", T.TEXTURE_2D, name, T.NEAREST)
    program.call("glBegin", T.QUADS)
    for s, t in ((0, 0), (1, 0), (1, 1), (0, 1)):
        program.call("glTexCoord2f", s, t).call("glVertex2f", 2 * s - 1, 2 * t - 1)
    assert (picture(program.call("glEnd").swap()) == _IMAGE).all()


def test_the_scissor_box_alone_cuts():
    program = draw(started(), _IMAGE).call("glEnable", T.SCISSOR_TEST).call("glScissor", 5, 0, 2, 4)
    program.call("glColorMask", 0, 0, 0, 0).call("glEnable", T.BLEND).call("glBlendFunc", T.ZERO, T.ONE)
    found = picture(blit(program, (0, 0, 4, 4), (4, 0, 8, 4)).swap())
    expected = _IMAGE.copy()
    expected[:, 5:7] = _IMAGE[:, 1:3]
    assert (found == expected).all()


@pytest.mark.parametrize("machine", _MACHINES)
def test_depths_and_stencil_values_are_copied(machine):
    program = framebuffer(started().clear(BLUE), depths=True)
    program.call("glClearDepth", 0.25).call("glClearStencil", 3).clear(RED)
    bound(program, 5, 0)
    blit(program, (0, 0, 4, 4), (0, 0, 4, 4), T.DEPTH_BUFFER_BIT)
    blit(program, (0, 0, 2, 4), (2, 0, 4, 4), T.STENCIL_BUFFER_BIT)
    program.call("glEnable", T.DEPTH_TEST).rectangle(GREEN)
    program.call("glDisable", T.DEPTH_TEST).call("glEnable", T.STENCIL_TEST)
    found = picture(program.call("glStencilFunc", T.EQUAL, 3, 255).rectangle(RED).swap(), PROFILES[machine])
    assert found[1].tolist() == [BYTES[BLUE]] * 2 + [BYTES[RED]] * 2 + [BYTES[GREEN]] * 4


def test_a_filtered_copy_of_the_same_size_is_none_and_a_scaled_one_is_refused():
    same = blit(draw(started(), _IMAGE), (0, 0, 4, 4), (4, 0, 8, 4), filtering=T.LINEAR).swap()
    assert (picture(same)[:, 4:] == _IMAGE[:, :4]).all()
    scaled = blit(draw(started(), _IMAGE), (0, 0, 4, 4), (0, 0, 8, 4), filtering=T.LINEAR).swap()
    replay, (frame,) = replayed(scaled)
    assert "no machine here filters a rectangle of pixels" in refused(replay)[0]
    assert (frame.image[::-1] == _IMAGE).all()


@pytest.mark.parametrize(
    ("given", "error"),
    [
        ({"mask": 1}, "GL_INVALID_VALUE"),
        ({"filtering": T.REPEAT}, "GL_INVALID_ENUM"),
        ({"mask": T.DEPTH_BUFFER_BIT, "filtering": T.LINEAR}, "GL_INVALID_OPERATION"),
    ],
)
def test_errors(given, error):
    replay, _ = replayed(blit(started(), (0, 0, 4, 4), (0, 0, 4, 4), **given))
    assert error in refused(replay)[0]


def test_an_incomplete_object_is_an_error():
    program = bound(started().call("glBindFramebufferEXT", F, 5), 5, 0)
    replay, _ = replayed(blit(program, (0, 0, 4, 4), (0, 0, 4, 4)))
    assert "GL_INVALID_FRAMEBUFFER_OPERATION" in refused(replay)[0]


def test_no_pixels_are_no_copy():
    program = blit(started().clear(RED), (0, 0, 0, 4), (0, 0, 4, 4))
    blit(blit(program, (0, 0, 4, 4), (0, 0, 4, 0)), (20, 0, 24, 4), (0, 0, 4, 4))
    replay, (frame,) = replayed(program.swap())
    assert not refused(replay) and color_of(frame) == BYTES[RED]


def test_a_copy_between_framebuffers_needs_a_machine():
    gl = Context(GEFORCE_3, 8, 4)
    gl.BindTexture(T.TEXTURE_2D, 1)
    gl.TexImage2D(T.TEXTURE_2D, 0, T.RGBA8, 8, 4, 0, T.RGBA, T.UNSIGNED_BYTE, None)
    gl.BindFramebuffer(F, 1)
    gl.FramebufferTexture2D(F, T.COLOR_ATTACHMENT0_EXT, T.TEXTURE_2D, 1, 0)
    gl.BindFramebuffer(_READ, 0)
    waiting = len(gl.commands)
    gl.BlitFramebuffer(0, 0, 8, 4, 0, 0, 8, 4, T.COLOR_BUFFER_BIT, T.NEAREST)
    (outcome,) = gl.tally.of("refused")
    assert "takes a machine behind this context" in outcome.what and len(gl.commands) == waiting


def test_a_side_is_cut_where_its_framebuffer_ends():
    assert side((-2, 6), (0, 16), 4) == (0, 4, 4.0, 2.0)
    assert side((6, -2), (0, 16), 4) == (0, 4, 12.0, -2.0)
    assert side((5, 5), (0, 3), 8).count == 0
