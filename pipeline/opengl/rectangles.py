"""Rectangles of pixels, and of vertices: DrawPixels, CopyPixels, Bitmap, raster positions, ReadPixels, Rect.

A raster position is transformed and lit when a command draws, with the vertex state and the texture
coordinate generation of the time when it was set.

Source: OpenGL 1.2.1 sections 2.10, 2.12, 3.6.4, 3.7, 4.3; ARB_window_pos, MESA_window_pos;
SGIX_pixel_texture, SGIS_pixel_texture.
"""

from dataclasses import replace
from math import isfinite
from typing import Any, NamedTuple

from fixedpipe.pipeline.commands import Bitmap, CopyPixels, DrawPixels, ReadPixels
from fixedpipe.pipeline.enums import PixelCopyType, PixelFragmentSource, PixelTexGenMode
from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.capabilities import capability
from fixedpipe.pipeline.opengl.current import COORDINATE_SETS, begin, end, filled, vertex
from fixedpipe.pipeline.opengl.entry_points import entry, register
from fixedpipe.pipeline.opengl.fragments import member
from fixedpipe.pipeline.opengl.images import framebuffer_size
from fixedpipe.pipeline.opengl.outcomes import GLError, LeftOut, Refused
from fixedpipe.pipeline.opengl.parameters import numbers_of, register_parameters
from fixedpipe.pipeline.opengl.pixel_transfers import counts, transfer_of
from fixedpipe.pipeline.opengl.pixels import (
    BUMP_FORMATS,
    FORMATS,
    INDEX_FORMATS,
    PACKED,
    captured,
    check_format,
    given_image,
    read_bits,
)
from fixedpipe.pipeline.opengl.selection import feed_back_rectangle, select_raster_position
from fixedpipe.pipeline.opengl.texturing import GENERATIONS, generation
from fixedpipe.pipeline.opengl.values import declare, section
from fixedpipe.pipeline.state import Matrix, PassState, PixelTexture, RasterPosition, TexGen, VertexState

# ------------------------------------------------------------------------------------------ raster positions


class Raster(NamedTuple):
    """The raster position, with the vertex state and each unit's (generation, matrix) that transform it."""

    position: RasterPosition
    vertex: VertexState
    units: tuple[tuple[tuple[TexGen, ...], Matrix], ...]


@section(
    "raster units",
    *[
        key
        for unit in range(COORDINATE_SETS)
        for key in (
            *[("enabled", token, unit) for token in GENERATIONS],
            ("texture generation", unit),
            ("texture matrix", unit),
        )
    ],
)
def _raster_units(gl, *parts):
    units = []
    for at in range(0, len(parts), 6):
        *enabled, held, matrices = parts[at : at + 6]
        gens = [generation(each, on) for each, on in zip(held, enabled, strict=True)]
        units.append((tuple(gens), matrices[-1]))
    return tuple(units)


# Source: OpenGL 1.2.1 table 6.6: the initial position is (0, 0, 0, 1) in the window, and valid.
_INITIAL = RasterPosition(window=True, texture_coordinates=((0.0, 0.0, 0.0, 1.0),) * COORDINATE_SETS)
declare("raster", None, tokens.CURRENT_BIT)


def _set_position(gl, position, window):
    if not all(map(isfinite, position)):
        raise LeftOut("the raster position is infinite or no number")
    now = gl.current
    placed = RasterPosition(
        position,
        window,
        color=now.color,
        secondary_color=now.secondary_color,
        normal=now.normal,
        texture_coordinates=now.texture_coordinates,
        fog_coordinate=now.fog_coordinate,
        weight=now.weight,
    )
    made = Raster(placed, gl.values.section("vertex"), gl.values.section("raster units"))
    gl.values.set("raster", made)
    if gl.values["render_mode"] == tokens.SELECT:
        select_raster_position(gl, placed, raster_state(gl))


def _register_positions(stem, sizes, window):
    for size in sizes:
        for kind in "sifd":

            def scalars(gl, *components):
                _set_position(gl, filled(components), window)

            def vector(gl, components, size=size):
                _set_position(gl, filled(numbers_of(components)[:size]), window)

            register(f"{stem}{size}{kind}", scalars)
            register(f"{stem}{size}{kind}v", vector)


_register_positions("RasterPos", (2, 3, 4), False)
_register_positions("WindowPos", (2, 3, 4), True)


def raster_position(gl: Any) -> RasterPosition:
    """The present raster position."""
    raster: Raster | None = gl.values["raster"]
    return _INITIAL if raster is None else raster.position


def raster_state(gl: Any) -> PassState:
    """The present state, with the transformations from the time when the raster position was set."""
    state, raster = gl.state(), gl.values["raster"]
    if raster is None:
        return state
    units = tuple([unit and _with_raster_unit(unit, raster) for unit in state.texture_units])
    if units == state.texture_units and raster.vertex == state.vertex:
        return state
    return replace(state, vertex=raster.vertex, texture_units=units)


def _with_raster_unit(unit, raster):
    """A unit with the generation and matrix of the raster position."""
    gen, matrix = raster.units[unit.coordinates]
    return unit if (unit.gen, unit.matrix) == (gen, matrix) else replace(unit, gen=gen, matrix=matrix)


# ----------------------------------------------------------------------------------------------- rectangles

declare("pixel_zoom", (1.0, 1.0), tokens.PIXEL_MODE_BIT)


@entry("PixelZoom")
def pixel_zoom(gl, x, y):
    """Set how many pixels a group covers (section 3.6.4)."""
    gl.values.set("pixel_zoom", (float(x), float(y)))


def _draws(gl, token):
    """Whether a rectangle is drawn. If not, feedback gets its token."""
    if gl.values["render_mode"] != tokens.RENDER:
        feed_back_rectangle(gl, token, raster_position(gl), raster_state(gl))
        return False
    return True


def _emit(gl, made, state):
    gl.store_textures(state)
    gl.tally.add("drawn", gl.called)
    gl.commands.append(made)


def _label(gl):
    return f"{gl.called} (call {gl.tally.call})"


def _require_stencil(gl):
    if not gl.profile.framebuffers.stencil_bits:
        raise GLError(tokens.INVALID_OPERATION, "there is no stencil buffer")


@entry("DrawPixels", capture=captured(0, 1))
def draw_pixels(gl, width, height, image_format, image_type, image):
    """Draw an image of client memory at the raster position (section 3.6.4)."""
    if width < 0 or height < 0:
        raise GLError(tokens.INVALID_VALUE)
    if image_format in BUMP_FORMATS:
        raise GLError(tokens.INVALID_ENUM)
    if image_format == tokens.STENCIL_INDEX:
        _require_stencil(gl)
    found = given_image(image)
    if not _draws(gl, tokens.DRAW_PIXEL_TOKEN) or not width or not height:
        return
    if found is None:
        raise LeftOut("its image lies at a null pointer")
    state = raster_state(gl)
    colors = found.format not in (*INDEX_FORMATS, tokens.DEPTH_COMPONENT, tokens.DEPTH_STENCIL_EXT)
    made = DrawPixels(
        label=_label(gl),
        image=found.pixel_image(),
        state=state,
        position=raster_position(gl),
        zoom=gl.values["pixel_zoom"],
        transfer=transfer_of(gl),
        pixel_texture=_pixel_texture(gl, state) if colors else None,
    )
    _emit(gl, made, state)


_COPIES = {
    tokens.COLOR: PixelCopyType.COLOR,
    tokens.DEPTH: PixelCopyType.DEPTH,
    tokens.STENCIL: PixelCopyType.STENCIL,
}


@entry("CopyPixels")
def copy_pixels(gl, x, y, width, height, kind):
    """Draw a rectangle of the framebuffer at the raster position (section 4.3.3)."""
    if kind == tokens.DEPTH_STENCIL_EXT:
        raise Refused("copies of depths and stencil values at once: no machine here has them")
    copied = member(_COPIES, kind)
    if width < 0 or height < 0:
        raise GLError(tokens.INVALID_VALUE)
    if copied is PixelCopyType.STENCIL:
        _require_stencil(gl)
    if not _draws(gl, tokens.COPY_PIXEL_TOKEN):
        return
    zoom, transfer, position = gl.values["pixel_zoom"], transfer_of(gl), raster_position(gl)
    (left, below), (x, y, width, height) = _inside(gl, x, y, width, height)
    if width <= 0 or height <= 0:
        return
    state = raster_state(gl)
    made = CopyPixels(
        label=_label(gl),
        x=x,
        y=y,
        width=width,
        height=height,
        type=copied,
        state=state,
        position=position.moved(left * zoom[0], below * zoom[1]) if left or below else position,
        zoom=zoom,
        transfer=transfer,
        pixel_texture=_pixel_texture(gl, state) if copied is PixelCopyType.COLOR else None,
    )
    _emit(gl, made, state)


def _inside(gl, x, y, width, height):
    """((columns, rows) cut off on the left and below, the rectangle's part inside the framebuffer).

    Pixels outside are undefined (section 4.3.2).
    """
    wide, high = framebuffer_size(gl)
    left, below = max(0, -x), max(0, -y)
    right, above = max(0, x + width - wide), max(0, y + height - high)
    if left or below or right or above:
        gl.tally.add("no effect", f"{gl.called}: pixels outside the window, which are undefined")
    return (left, below), (x + left, y + below, width - left - right, height - below - above)


def _capture_bitmap(gl, width, height, x_origin, y_origin, x_move, y_move, given):
    """The arguments of Bitmap with the bits, or the error of reading them, instead of the pointer."""
    bits: Any = None
    try:
        if 0 < width <= 1 << 16 and 0 < height <= 1 << 16:
            bits = read_bits(gl, int(width), int(height), given)
    except (GLError, Refused) as error:
        bits = error
    return width, height, x_origin, y_origin, x_move, y_move, bits


@entry("Bitmap", capture=_capture_bitmap)
def bitmap(gl, width, height, x_origin, y_origin, x_move, y_move, bits):
    """Draw the pixels whose bits are set, and move the raster position (section 3.7)."""
    if width < 0 or height < 0:
        raise GLError(tokens.INVALID_VALUE)
    if not all(map(isfinite, (x_origin, y_origin, x_move, y_move))):
        raise LeftOut("the bitmap's place is infinite or no number")
    try:
        if _draws(gl, tokens.BITMAP_TOKEN):
            _draw_bits(gl, bits, (float(x_origin), float(y_origin)))
    finally:
        raster = gl.values["raster"]
        if raster is None:
            raster = Raster(_INITIAL, gl.values.section("vertex"), gl.values.section("raster units"))
        moved = raster.position.moved(float(x_move), float(y_move))
        if x_move or y_move:
            gl.values.set("raster", raster._replace(position=moved))


def _draw_bits(gl, bits, origin):
    if isinstance(bits, Exception):
        raise bits
    if bits is None or not bits.any():
        return
    state = raster_state(gl)
    made = Bitmap(label=_label(gl), bits=bits, origin=origin, state=state, position=raster_position(gl))
    _emit(gl, made, state)


# ------------------------------------------------------------------------------------------- pixel textures

_TEX_GEN_MODES = {
    tokens.NONE: PixelTexGenMode.NONE,
    tokens.ALPHA: PixelTexGenMode.ALPHA,
    tokens.RGB: PixelTexGenMode.RGB,
    tokens.RGBA: PixelTexGenMode.RGBA,
}
_SOURCES = {
    tokens.PIXEL_GROUP_COLOR_SGIS: PixelFragmentSource.PIXEL_GROUP_COLOR,
    tokens.CURRENT_RASTER_COLOR: PixelFragmentSource.CURRENT_RASTER_COLOR,
}
capability(tokens.PIXEL_TEX_GEN_SGIX, tokens.PIXEL_MODE_BIT)
capability(tokens.PIXEL_TEXTURE_SGIS, tokens.PIXEL_MODE_BIT)
declare("pixel_tex_gen_mode", tokens.NONE, tokens.PIXEL_MODE_BIT)
for _name in (tokens.PIXEL_FRAGMENT_RGB_SOURCE_SGIS, tokens.PIXEL_FRAGMENT_ALPHA_SOURCE_SGIS):
    declare(("pixel fragment source", _name), tokens.PIXEL_GROUP_COLOR_SGIS, tokens.PIXEL_MODE_BIT)


@entry("PixelTexGen")
def pixel_tex_gen(gl, mode):
    """Set which components come from the raster position if groups become texture coordinates
    (SGIX_pixel_texture).
    """
    if not gl.profile.pixels.pixel_texture:
        raise Refused(f"{gl.profile.name} has no SGIX_pixel_texture")
    member(_TEX_GEN_MODES, mode)
    gl.values.set("pixel_tex_gen_mode", mode)


def _pixel_tex_gen_parameter(gl, name, given):
    if not gl.profile.pixels.pixel_texture_sgis:
        raise Refused(f"{gl.profile.name} has no SGIS_pixel_texture")
    if ("pixel fragment source", name) not in gl.values:
        raise GLError(tokens.INVALID_ENUM, tokens.name_of(name))
    member(_SOURCES, given.token())
    gl.values.set(("pixel fragment source", name), given.token())


register_parameters("PixelTexGenParameter", _pixel_tex_gen_parameter)


def _pixel_texture(gl, state):
    """The PixelTexture of a rectangle of colours, or None. Without a texture unit, groups are colours."""
    pixels, values = gl.profile.pixels, gl.values
    if not any(unit is not None for unit in state.texture_units):
        return None
    if pixels.pixel_texture and values["enabled", tokens.PIXEL_TEX_GEN_SGIX]:
        return PixelTexture(_TEX_GEN_MODES[values["pixel_tex_gen_mode"]])
    if pixels.pixel_texture_sgis and values["enabled", tokens.PIXEL_TEXTURE_SGIS]:
        return PixelTexture(
            None,
            _SOURCES[values["pixel fragment source", tokens.PIXEL_FRAGMENT_RGB_SOURCE_SGIS]],
            _SOURCES[values["pixel fragment source", tokens.PIXEL_FRAGMENT_ALPHA_SOURCE_SGIS]],
        )
    return None


# -------------------------------------------------------------------------------------------------- reading


@entry("ReadPixels", compiled=False)
def read_pixels(gl, x, y, width, height, image_format, image_type, given=None):
    """Read pixels (section 4.3.2). This has no effect on a picture, unless a histogram or minmax counts them.

    Raises Refused if they go into a buffer object, because a program may draw from it.
    """
    check_format(image_format, image_type)
    if width < 0 or height < 0:
        raise GLError(tokens.INVALID_VALUE)
    if gl.buffers[tokens.PIXEL_PACK_BUFFER_ARB] is not None:
        raise Refused("pixels read into a buffer object, which only the machine knows")
    transfer = transfer_of(gl)
    colors = image_format in FORMATS and FORMATS[image_format][1] > 0 and image_format not in INDEX_FORMATS
    _, (x, y, width, height) = _inside(gl, x, y, width, height)
    if not counts(transfer) or not colors or width <= 0 or height <= 0:
        gl.tally.add("no effect", gl.called)
        return
    gl.commands.append(
        ReadPixels(
            label=_label(gl),
            name=_label(gl),
            format=FORMATS[image_format][0],
            x=x,
            y=y,
            width=width,
            height=height,
            type=PACKED.get(image_type, "UNSIGNED_BYTE"),
            transfer=transfer,
        )
    )


# ------------------------------------------------------------------------------------ rectangles of vertices


def _rect(gl, x1, y1, x2, y2):
    """Draw a POLYGON of four vertices (section 2.10)."""
    begin(gl, tokens.POLYGON)
    for corner in ((x1, y1), (x2, y1), (x2, y2), (x1, y2)):
        vertex(gl, corner)
    end(gl)


def _rect_of_vectors(gl, first, second):
    _rect(gl, *numbers_of(first)[:2], *numbers_of(second)[:2])


for _kind in "sifd":
    register(f"Rect{_kind}", _rect)
    register(f"Rect{_kind}v", _rect_of_vectors)
