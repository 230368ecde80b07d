"""The colour buffers that are written and read (OpenGL 1.2.1 sections 4.2.1 and 4.3.2)."""

from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.capabilities import NOTIFIED
from fixedpipe.pipeline.opengl.entry_points import entry
from fixedpipe.pipeline.opengl.outcomes import GLError, Refused
from fixedpipe.pipeline.opengl.parameters import numbers_of
from fixedpipe.pipeline.opengl.values import declare


def _first(gl):
    return tokens.BACK if gl.drawable.double else tokens.FRONT


declare("draw_buffer", _first, tokens.COLOR_BUFFER_BIT)
declare("read_buffer", _first, tokens.PIXEL_MODE_BIT)

_OF_OBJECTS = (tokens.NONE, tokens.COLOR_ATTACHMENT0_EXT)
_BUFFERS = {tokens.FRONT, tokens.FRONT_LEFT, tokens.BACK, tokens.BACK_LEFT, tokens.LEFT}
_BUFFERS.add(tokens.FRONT_AND_BACK)


def choose_buffer(gl, key, buffer):
    """Change the value ``draw_buffer`` or ``read_buffer``. Earlier commands have the earlier buffers."""
    if buffer != gl.values[key]:
        _run_waiting(gl)
        gl.values.set(key, buffer)


def _run_waiting(gl, _=None):
    if gl.behind is not None:
        gl.behind.run_waiting()


NOTIFIED["draw_buffer"] = NOTIFIED["read_buffer"] = _run_waiting  # PopAttrib may change them


@entry("DrawBuffer")
def draw_buffer(gl, buffer):
    """Set which colour buffer is written (section 4.2.1)."""
    if buffer != tokens.NONE:
        _check_buffer(gl, buffer, gl.values["draw_framebuffer"])
    choose_buffer(gl, "draw_buffer", buffer)


def _check_buffer(gl, buffer, framebuffer):
    """Raise GLError unless the window has a buffer, or a framebuffer object does (0: none is bound)."""
    there = buffer in _BUFFERS or (buffer == tokens.AUX0 and gl.profile.framebuffers.auxiliary_buffers)
    if not there and not (framebuffer and buffer in _OF_OBJECTS):
        raise GLError(tokens.INVALID_OPERATION, f"the framebuffer has no buffer {tokens.name_of(buffer)}")


@entry("DrawBuffers")
def draw_buffers(gl, count, buffers):
    """Set the one colour buffer that is written (ARB_draw_buffers). Several buffers are refused."""
    if count < 0:
        raise GLError(tokens.INVALID_VALUE)
    if count > 1:
        raise Refused(f"drawing into {count} buffers by fragment programs, which no machine here has")
    draw_buffer(gl, numbers_of(buffers)[0] if count else tokens.NONE)


@entry("ReadBuffer")
def read_buffer(gl, buffer):
    """Set which colour buffer is read (section 4.3.2)."""
    _check_buffer(gl, buffer, gl.values["read_framebuffer"])
    choose_buffer(gl, "read_buffer", buffer)
