"""Selection and feedback (OpenGL 1.2.1 sections 5.2 and 5.3): work of the host, which draws nothing.

``selected_primitives`` handles primitives in these modes. It is imported on use, because it needs kernels.
"""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from fixedpipe.pipeline.commands import Mesh
from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.entry_points import entry
from fixedpipe.pipeline.opengl.outcomes import GLError
from fixedpipe.pipeline.state import PassState, RasterPosition

# Source: section 5.2: at least 64.
MAX_NAME_STACK_DEPTH = 64
_LARGEST = 0xFFFFFFFF

# For a feedback type: how many coordinates, and whether colours and texture coordinates follow (table 5.2).
_TYPES = {
    tokens._2D: (2, False, False),
    tokens._3D: (3, False, False),
    tokens._3D_COLOR: (3, True, False),
    tokens._3D_COLOR_TEXTURE: (3, True, True),
    tokens._4D_COLOR_TEXTURE: (4, True, True),
}
# Places in a vertex's values: window x, y, z and clip w; then the colour, then the texture coordinates.
_COLOR, _TEXTURE = slice(4, 8), slice(8, 12)


class Selection:
    """The state of selection and feedback.

    - ``written``: the values written so far into the selection or feedback array, also after the mode's end.
    - ``names``: the name stack, bottommost name first.
    """

    def __init__(self):
        self.names: list[int] = []
        self.written: list[Any] = []
        self.select_buffer: tuple[int, Any] | None = None  # its size, and the caller's array
        self.feedback_buffer: tuple[int, Any] | None = None
        self.feedback_type = tokens._2D
        self._room = 0
        self._overflowed = False
        self._records = 0
        self._depths: tuple[float, float] | None = None  # the range of hits since the last record

    def enter(self, size: int) -> None:
        """Begin a mode whose array holds ``size`` values."""
        self.written, self._room, self._overflowed = [], size, False
        self._records, self._depths = 0, None

    def write(self, values: Sequence[Any]) -> None:
        """Write as many of the values as there is room for."""
        room = self._room - len(self.written)
        self.written += values[:room]
        self._overflowed |= len(values) > room

    def hit(self, depths: Iterable[float]) -> None:
        """Note vertices in the view volume, with the window depths ``depths``."""
        known = (*depths, *(self._depths or ()))
        self._depths = min(known), max(known)

    def record(self) -> None:
        """Write a hit record, if there was a hit since the last one."""
        if self._depths is None:
            return
        # In float64 the product is correctly rounded, and so is its nearest integer.
        scaled = [round(min(max(depth, 0.0), 1.0) * _LARGEST) for depth in self._depths]
        self.write([len(self.names), *scaled, *self.names])
        self._records += 1
        self._depths = None

    def chosen(self, values: Sequence[float]) -> list[float]:
        """The values of a vertex that the feedback's type returns.

        ``values``: window x, y and z, clip w, the colour and the texture coordinates.
        """
        coordinates, color, texture = _TYPES[self.feedback_type]
        parts = values[:coordinates], values[_COLOR] if color else (), values[_TEXTURE] if texture else ()
        return [value for part in parts for value in part]

    def leave(self, mode: int) -> int:
        """End a mode. Returns the result of RenderMode."""
        if mode == tokens.SELECT:
            self.record()
            _fill(self.select_buffer, self.written)
        elif mode == tokens.FEEDBACK:
            _fill(self.feedback_buffer, self.written)
        else:
            return 0
        count = self._records if mode == tokens.SELECT else len(self.written)
        return -1 if self._overflowed else count


def _fill(buffer, written):
    """Copy the values into the caller's array, if it is one."""
    if buffer is not None and isinstance(buffer[1], list | np.ndarray):
        buffer[1][: len(written)] = written


@entry("RenderMode", compiled=False)
def render_mode(gl, mode):
    """Choose drawing, selection or feedback. Returns the number of records or values of the last mode."""
    selection, before = gl.selection, gl.values["render_mode"]
    if mode not in (tokens.RENDER, tokens.SELECT, tokens.FEEDBACK):
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(mode)} is no mode of rendering")
    buffer = {tokens.SELECT: selection.select_buffer, tokens.FEEDBACK: selection.feedback_buffer}.get(
        mode, (0, None)
    )
    if buffer is None:
        raise GLError(tokens.INVALID_OPERATION, "the mode has no buffer")
    result = selection.leave(before)
    selection.names = []
    if mode != tokens.RENDER:
        selection.enter(buffer[0])
    gl.values.set("render_mode", mode)
    return result


@entry("SelectBuffer", compiled=False)
def select_buffer(gl, size, buffer=None):
    """Set the array for hit records. If it is a list or an array of integers, it is filled."""
    if gl.values["render_mode"] == tokens.SELECT:
        raise GLError(tokens.INVALID_OPERATION, "the buffer is in use")
    if size < 0:
        raise GLError(tokens.INVALID_VALUE)
    gl.selection.select_buffer = int(size), buffer


@entry("FeedbackBuffer", compiled=False)
def feedback_buffer(gl, size, type_, buffer=None):
    """Set the array for feedback, and its type. If it is a list or an array, it is filled."""
    if gl.values["render_mode"] == tokens.FEEDBACK:
        raise GLError(tokens.INVALID_OPERATION, "the buffer is in use")
    if type_ not in _TYPES:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(type_)} is no type of feedback")
    if size < 0:
        raise GLError(tokens.INVALID_VALUE)
    gl.selection.feedback_buffer, gl.selection.feedback_type = (int(size), buffer), type_


# --------------------------------------------------------------------------------------------- name stack


def _names(gl):
    """The name stack; None outside selection."""
    return gl.selection.names if gl.values["render_mode"] == tokens.SELECT else None


@entry("InitNames")
def init_names(gl):
    """Empty the name stack."""
    names = _names(gl)
    if names is not None:
        gl.selection.record()
        names.clear()


@entry("LoadName")
def load_name(gl, name):
    """Replace the topmost name."""
    names = _names(gl)
    if names is None:
        return
    if not names:
        raise GLError(tokens.INVALID_OPERATION, "the name stack is empty")
    gl.selection.record()
    names[-1] = int(name) & _LARGEST


@entry("PushName")
def push_name(gl, name):
    """Push a name."""
    names = _names(gl)
    if names is None:
        return
    if len(names) >= MAX_NAME_STACK_DEPTH:
        raise GLError(tokens.STACK_OVERFLOW)
    gl.selection.record()
    names.append(int(name) & _LARGEST)


@entry("PopName")
def pop_name(gl):
    """Pop a name."""
    names = _names(gl)
    if names is None:
        return
    if not names:
        raise GLError(tokens.STACK_UNDERFLOW)
    gl.selection.record()
    names.pop()


@entry("PassThrough")
def pass_through(gl, token):
    """Write a marker into the feedback array."""
    if gl.values["render_mode"] == tokens.FEEDBACK:
        gl.selection.write([float(tokens.PASS_THROUGH_TOKEN), float(token)])


# ---------------------------------------------------------------------------------------------- primitives


def select(gl, mesh: Mesh) -> None:
    """Do what a draw of ``mesh`` does in selection or feedback."""
    from fixedpipe.pipeline.opengl.selected_primitives import take_mesh

    take_mesh(gl, mesh)


def select_raster_position(gl, position: RasterPosition, state: PassState) -> None:
    """Note the hit of a RasterPos in selection, if the position is valid."""
    from fixedpipe.pipeline.opengl.selected_primitives import raster_position_depth

    depth = raster_position_depth(gl, position, state)
    if depth is not None and gl.values["render_mode"] == tokens.SELECT:
        gl.selection.hit((depth,))


def feed_back_rectangle(gl, token: int, position: RasterPosition, state: PassState) -> None:
    """Write the token of a bitmap or pixel rectangle, and its raster position, if the position is valid.

    ``token``: BITMAP_TOKEN, DRAW_PIXEL_TOKEN or COPY_PIXEL_TOKEN. Nothing happens outside feedback.
    """
    from fixedpipe.pipeline.opengl.selected_primitives import raster_position_values

    if gl.values["render_mode"] != tokens.FEEDBACK:
        return
    values = raster_position_values(gl, position, state)
    if values is not None:
        gl.selection.write([float(token), *gl.selection.chosen(values)])
