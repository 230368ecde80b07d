"""BlitFramebuffer (EXT_framebuffer_blit) copies a rectangle of one framebuffer into another.

No machine here had it. Programs of their time used two ways, and this module does the same. Within a
framebuffer they called CopyPixels; PixelZoom scales and mirrors, and selects the same pixels as NEAREST.
Between two framebuffers they read the pixels and drew them. Of all tests only the scissor test applies.

A scaled copy with a filter is refused, because no machine here filters a rectangle of pixels.
"""

from collections.abc import Iterator
from typing import Any, NamedTuple

from fixedpipe.pipeline.commands import CopyPixels, DrawPixels
from fixedpipe.pipeline.enums import ComparisonFunction, PixelCopyType
from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.entry_points import entry
from fixedpipe.pipeline.opengl.framebuffer_objects import Surface, begin_with_texels, made_current, surface_of
from fixedpipe.pipeline.opengl.outcomes import GLError, Refused
from fixedpipe.pipeline.opengl.read_back import colors_read, depths_read, stencil_read
from fixedpipe.pipeline.pixel_transfer import PixelImage
from fixedpipe.pipeline.state import ColorMask, DepthTest, PassState, RasterPosition, Scissor

_NO_COLORS = ColorMask(False, False, False, False)
_KINDS = {
    tokens.COLOR_BUFFER_BIT: PixelCopyType.COLOR,
    tokens.DEPTH_BUFFER_BIT: PixelCopyType.DEPTH,
    tokens.STENCIL_BUFFER_BIT: PixelCopyType.STENCIL,
}
_ALL = tokens.COLOR_BUFFER_BIT | tokens.DEPTH_BUFFER_BIT | tokens.STENCIL_BUFFER_BIT


class Side(NamedTuple):
    """A copy along one axis.

    - ``first``, ``count``: the first pixel that is read, within its framebuffer, and how many are read.
    - ``place``, ``zoom``: where the edge of the first pixel is drawn, and how long each pixel becomes.
    """

    first: int
    count: int
    place: float
    zoom: float


def side(source: tuple[int, int], target: tuple[int, int], size: int) -> Side:
    """The copy from ``source`` to ``target``, each (begin, end). ``size``: the framebuffer's length, pixels.

    Pixels outside the framebuffer are not copied.
    """
    (begin, end), (at, until) = source, target
    if end < begin:
        begin, end, at, until = end, begin, until, at
    zoom = (until - at) / (end - begin) if end > begin else 0.0
    first, last = max(begin, 0), min(end, size)
    return Side(first, max(last - first, 0), at + zoom * (first - begin), zoom)


@entry("BlitFramebuffer", compiled=False)
def blit_framebuffer(gl, *arguments):
    """Copy a rectangle from the framebuffer bound for reading to the one bound for drawing."""
    corners, (mask, filtering) = [int(number) for number in arguments[:8]], arguments[8:]
    left, bottom, right, top, to_left, to_bottom, to_right, to_top = corners
    _check(mask, filtering)
    reads, draws = gl.values["read_framebuffer"], gl.values["draw_framebuffer"]
    surfaces = [surface_of(gl, number) if number else None for number in (reads, draws)]
    if any(surface is not None and not surface.complete for surface in surfaces):
        raise GLError(tokens.INVALID_FRAMEBUFFER_OPERATION_EXT, "a framebuffer object is incomplete")
    scaled = {abs(right - left), abs(top - bottom)} != {abs(to_right - to_left), abs(to_top - to_bottom)}
    scaled = scaled or abs(right - left) != abs(to_right - to_left)
    if scaled and filtering == tokens.LINEAR:
        raise Refused("a scaled copy with LINEAR: no machine here filters a rectangle of pixels")
    read = surfaces[0]
    size = (gl.window.width, gl.window.height) if read is None else (read.width, read.height)
    across = side((left, right), (to_left, to_right), size[0])
    up = side((bottom, top), (to_bottom, to_top), size[1])
    if not (across.count and up.count and across.zoom and up.zoom):
        gl.tally.add("no effect", f"{gl.called} of no pixels")
        return
    for kind in _kinds(gl, mask):
        if reads == draws:
            gl.commands.append(_copied_within(gl, kind, across, up))
        else:
            _copy_between(gl, kind, across, up, read, size)
    gl.tally.add("drawn", gl.called)


def _check(mask, filtering):
    """Raise GLError for arguments that are errors in the extension."""
    if mask & ~_ALL:
        raise GLError(tokens.INVALID_VALUE, f"{mask:#x} is no mask of buffers that are copied")
    if filtering not in (tokens.NEAREST, tokens.LINEAR):
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(filtering)} is no filter of copies")
    if mask & ~tokens.COLOR_BUFFER_BIT and filtering != tokens.NEAREST:
        raise GLError(tokens.INVALID_OPERATION, "depths and stencil values are copied with NEAREST alone")


def _kinds(gl, mask) -> Iterator[PixelCopyType]:
    """The kinds of values to copy. A buffer that does not exist is skipped."""
    for bit, kind in _KINDS.items():
        there = kind is not PixelCopyType.STENCIL or gl.profile.framebuffers.stencil_bits
        if kind is PixelCopyType.COLOR:
            there = gl.values["draw_buffer"] != tokens.NONE and gl.values["read_buffer"] != tokens.NONE
        if mask & bit and there:
            yield kind


def _state(gl, kind) -> PassState:
    """The state that draws a rectangle with only the scissor test."""
    box: Scissor | None = gl.values.section("scissor section")
    if kind is not PixelCopyType.DEPTH:
        return PassState(scissor=box)
    always = DepthTest(ComparisonFunction.ALWAYS, True)
    return PassState(scissor=box, color_mask=_NO_COLORS, depth_test=always)


def _label(gl):
    return f"{gl.called} (call {gl.tally.call})"


def _position(across, up):
    return RasterPosition((across.place, up.place, 0.0, 1.0), window=True)


def _copied_within(gl, kind, across, up):
    return CopyPixels(
        label=_label(gl),
        x=across.first,
        y=up.first,
        width=across.count,
        height=up.count,
        type=kind,
        state=_state(gl, kind),
        position=_position(across, up),
        zoom=(across.zoom, up.zoom),
    )


def _copy_between(gl, kind, across, up, read: Surface | None, size):
    """Read from one framebuffer, and draw into the other, whose pbuffer is current."""
    label, box = _label(gl), (across.first, up.first, across.count, up.count)
    before = gl.values["pbuffer"]
    if gl.behind is None:
        raise Refused("a copy between two framebuffers, which takes a machine behind this context")
    gl.commands.append(made_current(label, read))
    if read is not None:
        begin_with_texels(gl, gl.values["read_framebuffer"], read, label)
    image = _image(gl, kind, box, size)
    gl.commands.append(made_current(label, None if before is None else before[1]))
    gl.commands.append(
        DrawPixels(
            label=label,
            image=image,
            state=_state(gl, kind),
            position=_position(across, up),
            zoom=(across.zoom, up.zoom),
        )
    )


def _image(gl: Any, kind: PixelCopyType, box, size) -> PixelImage:
    if kind is PixelCopyType.DEPTH:
        return PixelImage(depths_read(gl, box, size), "DEPTH_COMPONENT")
    if kind is PixelCopyType.STENCIL:
        return PixelImage(stencil_read(gl, box, size), "STENCIL_INDEX")
    return PixelImage(colors_read(gl, box, size), "RGBA")  # COLOR
