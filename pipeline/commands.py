"""The commands that a frame is made of.

An effect returns a tuple of commands, and ``fixedpipe.pipeline.execution`` runs them in order. Each command
carries everything that it needs, and a ``label`` in the paper's words. Window coordinates are OpenGL's:
origin lower left, y up. The images of textures and of ReadPixels have their bottom row first.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fixedpipe.pipeline.enums import (
    AccumOperation,
    ColorBuffer,
    ColorFormat,
    InternalFormat,
    PixelCopyType,
    PrimitiveType,
    TextureTarget,
    WindowOrigin,
)
from fixedpipe.pipeline.pixel_transfer import (
    INITIAL_TRANSFER,
    PackedName,
    PixelImage,
    PixelTransfer,
    read_only_copy,
)
from fixedpipe.pipeline.state import Color, ColorMask, PassState, PixelTexture, RasterPosition, Scissor
from fixedpipe.pipeline.textures.images import Texture
from fixedpipe.pipeline.textures.pixel_formats import DEPTH_FORMAT, STENCIL_FORMAT

_INITIAL_STATE, _INITIAL_POSITION = PassState(), RasterPosition()

# What ReadPixels returns, and colours as what.
ReadFormat = Literal[
    "RGBA",
    "RGB",
    "BGRA",
    "BGR",
    "RED",
    "GREEN",
    "BLUE",
    "ALPHA",
    "LUMINANCE",
    "LUMINANCE_ALPHA",
    "DEPTH_COMPONENT",
    "STENCIL_INDEX",
]
ReadType = Literal[
    "UNSIGNED_BYTE", "BYTE", "UNSIGNED_SHORT", "SHORT", "UNSIGNED_INT", "INT", "FLOAT", PackedName
]


def _frozen(values, dtype, name):
    """A read-only copy. Raises ValueError for values that are no array of numbers."""
    try:
        array = np.asarray(values)
    except ValueError as error:
        raise ValueError(
            f"The mesh's {name} have rows of different lengths; give as many in each."
        ) from error
    if array.dtype.kind not in ("biu" if dtype is not np.float64 and array.size else "biuf"):
        wanted = "numbers" if dtype is np.float64 else "whole numbers"
        raise ValueError(f"The mesh's {name} are of type {array.dtype}; give {wanted}.")
    array = np.array(array, dtype=dtype, order="C")
    array.setflags(write=False)
    return array


def _frozen_or_none(values, dtype, name):
    return None if values is None else _frozen(values, dtype, name)


@dataclass(frozen=True, eq=False, init=False)
class Mesh:
    """Vertex arrays of one primitive type (sections 2.6 to 2.8). ``validate`` checks them.

    positions           float64 [n, 2..4], object coordinates; missing components are z = 0, w = 1
    indices             int64 [k] into the vertices; None: the vertices in order
    counts              the number of indices of each strip, fan or polygon; None: all are one primitive
    colors              float64 [n, 3..4], 1.0 = full intensity; None: (1, 1, 1, 1)
    secondary_colors    float64 [n, 3..4], a missing alpha is 0; None: (0, 0, 0)
    normals             float64 [n, 3]; None: (0, 0, 1)
    texture_coordinates tuple of float64 [n, 1..4], one for each coordinate set; missing components are
                        t = 0, r = 0, q = 1; a missing set is (0, 0, 0, 1) at every vertex
    fog_coordinates     float64 [n]; None: 0
    back_colors, back_secondary_colors
                        the colours for back faces that a vertex program wrote (NV_vertex_program's
                        o[BFC0], o[BFC1]), used where the state takes them; None: (0, 0, 0, 1)
    point_sizes         float64 [n], pixels, that a vertex program wrote (o[PSIZ]), used where the state takes
                        them; None: 1
    edge_flags          bool [n] (section 2.6.2): whether the edge that begins at a vertex is a boundary edge,
                        for TRIANGLES, QUADS and POLYGON drawn as points or lines; None: all are
    weights             float64 [n], the weight of the first of two modelview matrices (EXT_vertex_weighting);
                        None: 1

    Arrays are copied and made read-only. Raises ValueError for values that are no array of numbers, or of
    whole numbers where an int64 or bool array is asked for.
    """

    positions: NDArray[np.float64]
    primitive: PrimitiveType
    indices: NDArray[np.int64] | None
    counts: tuple[int, ...] | None
    colors: NDArray[np.float64] | None
    secondary_colors: NDArray[np.float64] | None
    normals: NDArray[np.float64] | None
    texture_coordinates: tuple[NDArray[np.float64], ...]
    fog_coordinates: NDArray[np.float64] | None
    back_colors: NDArray[np.float64] | None
    back_secondary_colors: NDArray[np.float64] | None
    point_sizes: NDArray[np.float64] | None
    edge_flags: NDArray[np.bool_] | None
    weights: NDArray[np.float64] | None

    def __init__(
        self,
        positions: ArrayLike,
        primitive: PrimitiveType = PrimitiveType.TRIANGLES,
        indices: ArrayLike | None = None,
        counts: tuple[int, ...] | None = None,
        colors: ArrayLike | None = None,
        secondary_colors: ArrayLike | None = None,
        normals: ArrayLike | None = None,
        texture_coordinates: Iterable[ArrayLike] = (),
        fog_coordinates: ArrayLike | None = None,
        back_colors: ArrayLike | None = None,
        back_secondary_colors: ArrayLike | None = None,
        point_sizes: ArrayLike | None = None,
        edge_flags: ArrayLike | None = None,
        weights: ArrayLike | None = None,
    ):
        floats = {
            "positions": positions,
            "colors": colors,
            "secondary_colors": secondary_colors,
            "normals": normals,
            "fog_coordinates": fog_coordinates,
            "back_colors": back_colors,
            "back_secondary_colors": back_secondary_colors,
            "point_sizes": point_sizes,
            "weights": weights,
        }
        kept = {name: _frozen_or_none(values, np.float64, name) for name, values in floats.items()}
        kept |= {
            "primitive": primitive,
            "indices": _frozen_or_none(indices, np.int64, "indices"),
            "counts": counts,
            "texture_coordinates": tuple(
                [_frozen(t, np.float64, "texture_coordinates") for t in texture_coordinates]
            ),
            "edge_flags": _frozen_or_none(edge_flags, np.bool_, "edge_flags"),
        }
        for name, value in kept.items():
            object.__setattr__(self, name, value)


@dataclass(frozen=True, kw_only=True)
class Clear:
    """Clear (section 4.2.3). A value of None leaves that buffer as it is.

    ``depth`` is in [0, 1], ``stencil`` in 0..255. ``accumulation`` has components in [-1, 1]; the color mask
    does not apply to it. ``draw_buffer`` is the colour buffer that ``color`` clears.
    """

    label: str
    color: Color | None = None
    depth: float | None = None
    stencil: int | None = None
    scissor: Scissor | None = None
    color_mask: ColorMask = field(default_factory=ColorMask)
    stencil_write_mask: int = 0xFF
    accumulation: Color | None = None
    draw_buffer: ColorBuffer = ColorBuffer.BACK


@dataclass(frozen=True, kw_only=True)
class Draw:
    """Draw a mesh in a state.

    ``label`` names the command in messages, in ``describe`` and in histories.
    """

    label: str
    mesh: Mesh
    state: PassState


@dataclass(frozen=True, kw_only=True)
class TexImage:
    """TexImage1D/2D/3D (section 3.8.1): store an image as the texture object ``texture``.

    Give either ``image``, a Texture in its stored form, or ``pixels``, an image in client memory. ``pixels``
    pass through ``transfer`` and are stored as ``internal_format``. With ``generate_mipmap`` every smaller
    level is made from them.
    """

    label: str
    texture: str
    image: Texture | None = None
    pixels: PixelImage | None = None
    target: TextureTarget = TextureTarget.TEXTURE_2D
    internal_format: InternalFormat = InternalFormat.RGBA8
    transfer: PixelTransfer = INITIAL_TRANSFER
    generate_mipmap: bool = False


@dataclass(frozen=True, kw_only=True)
class CopyTexImage:
    """CopyTexImage1D/2D (section 3.8.2): define a texture from a framebuffer rectangle.

    The command defines level 0 and, with ``generate_mipmap`` (SGIS_generate_mipmap), every smaller level from
    it. Pixels pass through ``transfer``. A convolution that reduces the rectangle reduces the texture. A 1D
    texture takes a rectangle of one row. Define a cube map by a TexImage, and fill its faces with
    CopyTexSubImage.
    """

    label: str
    texture: str
    target: TextureTarget = TextureTarget.TEXTURE_2D
    internal_format: InternalFormat = InternalFormat.RGBA8
    x: int = 0
    y: int = 0
    width: int | None = None
    height: int | None = None
    generate_mipmap: bool = False
    transfer: PixelTransfer = INITIAL_TRANSFER
    read_buffer: ColorBuffer = ColorBuffer.BACK


@dataclass(frozen=True, kw_only=True)
class CopyTexSubImage:
    """CopyTexSubImage1D/2D (section 3.8.2): replace a rectangle of level ``level`` of an existing texture.

    ``face`` is 0..5 in the order +x, -x, +y, -y, +z, -z for a cube map, and 0 for other textures. With
    ``generate_mipmap`` (SGIS_generate_mipmap; level 0 only) every smaller level is made again from level 0.
    Pixels pass through ``transfer``.
    """

    label: str
    texture: str
    x_offset: int = 0
    y_offset: int = 0
    x: int = 0
    y: int = 0
    width: int
    height: int
    level: int = 0
    face: int = 0
    generate_mipmap: bool = False
    transfer: PixelTransfer = INITIAL_TRANSFER
    read_buffer: ColorBuffer = ColorBuffer.BACK


@dataclass(frozen=True, kw_only=True)
class ReadPixels:
    """ReadPixels (section 4.3.2) into the result's ``pixels[name]``, bottom row first.

    - Colour formats are RGBA, RGB, BGRA, BGR, RED, GREEN, BLUE, ALPHA, LUMINANCE (R + G + B, clamped) and
      LUMINANCE_ALPHA. They give uint8 [h, w(, c)].
    - DEPTH_COMPONENT gives uint32 [h, w] in depth units; STENCIL_INDEX gives uint8 [h, w].
    - ``type``, for colours: an integer type, FLOAT (float64, clamped to [0, 1]), or a packed type of RGB,
      RGBA or BGRA (words [h, w]). The ideal gives real numbers for every type.

    Pixels pass through ``transfer``. A histogram or minmax with a sink returns no pixels.
    """

    label: str
    name: str
    format: ReadFormat = "RGBA"
    x: int = 0
    y: int = 0
    width: int | None = None
    height: int | None = None
    type: ReadType = "UNSIGNED_BYTE"
    transfer: PixelTransfer = INITIAL_TRANSFER
    read_buffer: ColorBuffer = ColorBuffer.BACK


@dataclass(frozen=True, kw_only=True)
class GetTexImage:
    """GetTexImage (section 6.1.4) into the result's ``pixels[name]``: a level of a texture, bottom row first.

    The groups are the stored components by table 6.1. Luminance and intensity are read as red, with green and
    blue 0. A missing alpha is 1; an INTENSITY texture's alpha counts as missing. All layers of a 3D texture
    are read, [d, h, w(, c)].

    - ``face``: of a cube map, as in CopyTexSubImage.
    - ``format``, ``type``: as in ReadPixels, without STENCIL_INDEX. A depth texture takes DEPTH_COMPONENT and
      no other format; other textures do not take it.
    - ``transfer``: must be the initial one, unless the profile's ``transfers_texture_queries`` says that
      pixels pass through it.
    """

    label: str
    name: str
    texture: str
    level: int = 0
    face: int = 0
    format: ReadFormat = "RGBA"
    type: ReadType = "UNSIGNED_BYTE"
    transfer: PixelTransfer = INITIAL_TRANSFER


@dataclass(frozen=True, kw_only=True)
class HostStep:
    """The application's own work between commands: it looks at pixels that were read and issues other
    commands.

    - ``reads``: names that ReadPixels or GetTexImage gave earlier in the same frame.
    - ``commands``: a function from a dictionary of these arrays, read-only, to a tuple of commands, which run
      in this one's place. A machine passes integers; the ideal passes float64, as ``execute_ideal`` reads
      them.

    For arrays of the same shapes both must draw the same rectangles and meshes, so that a machine's frame can
    guide the ideal. The returned commands are validated when they are there, and the later commands again.
    Textures that they store remain, but later commands cannot name them.
    """

    label: str
    reads: tuple[str, ...]
    commands: Callable[[Mapping[str, NDArray[Any]]], "Iterable[Command]"]


@dataclass(frozen=True, kw_only=True)
class Saturate:
    """States that later commands rely on colours in [0, 1], as a framebuffer of fixed-point numbers holds
    them.

    On a machine whose blending clamps its results (section 4.1.6) nothing happens. On the exact machine, or
    one without that clamp, the colours in the scissor box are clamped here. An algorithm that uses the clamp
    thus says where it does, and its ideal clamps there and nowhere else.
    """

    label: str
    scissor: Scissor | None = None
    draw_buffer: ColorBuffer = ColorBuffer.BACK


@dataclass(frozen=True, kw_only=True)
class DrawPixels:
    """DrawPixels (section 3.6.4): each group of ``image`` becomes the fragments of a rectangle of pixels.

    The group in column n and row m, counted from 0, covers the rectangle between ``(x + zx n, y + zy m)`` and
    ``(x + zx (n + 1), y + zy (m + 1))``. It gives a fragment to each pixel whose centre lies inside, or on
    the left or lower side. (x, y) is the raster position in window coordinates. (zx, zy) is ``zoom``
    (PixelZoom); it may be negative or a fraction.

    Colour groups are the fragments' colours, DEPTH_COMPONENT groups their depths. The raster position gives
    all other values. The fragments pass through texturing, fog and the tests of ``state``. STENCIL_INDEX
    groups go to the stencil buffer, through the scissor and StencilMask (``stencil_test.write_mask``) alone.
    """

    label: str
    image: PixelImage
    state: PassState = _INITIAL_STATE
    position: RasterPosition = _INITIAL_POSITION
    zoom: tuple[float, float] = (1.0, 1.0)
    transfer: PixelTransfer = INITIAL_TRANSFER
    pixel_texture: PixelTexture | None = None


@dataclass(frozen=True, kw_only=True)
class CopyPixels:
    """CopyPixels (section 4.3.3): DrawPixels of a rectangle of the framebuffer.

    The whole rectangle is read before any of it is drawn. ``read_buffer`` is the buffer that COLOR reads.
    """

    label: str
    x: int = 0
    y: int = 0
    width: int | None = None
    height: int | None = None
    type: PixelCopyType = PixelCopyType.COLOR
    state: PassState = _INITIAL_STATE
    position: RasterPosition = _INITIAL_POSITION
    zoom: tuple[float, float] = (1.0, 1.0)
    transfer: PixelTransfer = INITIAL_TRANSFER
    pixel_texture: PixelTexture | None = None
    read_buffer: ColorBuffer = ColorBuffer.BACK


@dataclass(frozen=True, kw_only=True, eq=False, init=False)
class Bitmap:
    """Bitmap (section 3.7): fragments where ``bits`` is set, all with the raster position's values.

    ``bits`` is bool [h, w], bottom row first. The lower left pixel is the raster position minus ``origin``,
    rounded down. The command does not move the raster position: give ``position.moved(...)`` to the next one.
    """

    label: str
    bits: NDArray[np.bool_]
    origin: tuple[float, float]
    state: PassState
    position: RasterPosition

    def __init__(
        self,
        *,
        label: str,
        bits: ArrayLike,
        origin: tuple[float, float] = (0.0, 0.0),
        state: PassState = _INITIAL_STATE,
        position: RasterPosition = _INITIAL_POSITION,
    ):
        kept = {"label": label, "bits": read_only_copy(bits, "The bitmap's bits"), "origin": origin}
        for name, value in (kept | {"state": state, "position": position}).items():
            object.__setattr__(self, name, value)


@dataclass(frozen=True, kw_only=True)
class Accum:
    """Accum (section 4.2.4), for the pixels in the scissor box.

    LOAD stores the read buffer's colours times ``value``, and ACCUM adds them. MULT multiplies what the
    accumulation buffer holds by ``value``, and ADD adds ``value`` to it. RETURN writes it times ``value`` to
    the draw buffer.
    """

    label: str
    operation: AccumOperation
    value: float = 1.0
    scissor: Scissor | None = None
    color_mask: ColorMask = field(default_factory=ColorMask)
    read_buffer: ColorBuffer = ColorBuffer.BACK
    draw_buffer: ColorBuffer = ColorBuffer.BACK


@dataclass(frozen=True, kw_only=True)
class MakeCurrent:
    """WGL_ARB_pbuffer: later commands draw to and read from ``surface``. None: the window.

    A frame begins with the window. The first MakeCurrent that names a pbuffer creates it: colour 0, the
    farthest depth, stencil 0. Later ones must give the same size and formats, and find the pbuffer's
    contents. ``samples`` is the number of samples in each of its pixels (WGL_ARB_multisample).

    With ``shares_depth`` the pbuffer uses the depths and stencil values of the pbuffer ``depth_of``, or of
    the window where that is None, as Direct3D's SetRenderTarget keeps a depth surface. Two pixels share them
    if they lie equally far from the left and from the top. The other surface must be at least as large, with
    as many depth bits and samples.
    """

    label: str
    surface: str | None = None
    width: int | None = None
    height: int | None = None
    color_format: ColorFormat = ColorFormat.A8R8G8B8
    depth_bits: int = 24
    samples: int = 1
    shares_depth: bool = False
    depth_of: str | None = None


@dataclass(frozen=True, kw_only=True)
class BindTexImage:
    """WGL_ARB_render_texture: define ``texture`` as the colours that ``surface`` now holds.

    With a depth format (WGL_NV_render_depth_texture) the texture holds the surface's depths. The pbuffer's
    words are read as ``internal_format``, which has the same width. ``origin`` LOWER_LEFT puts t = 0 at the
    bottom row, as OpenGL does; UPPER_LEFT puts it at the top row, the first in the chip's memory. A pbuffer
    with n samples gives a texture n times as wide, in which a pixel's samples lie side by side.
    """

    label: str
    texture: str
    surface: str
    target: TextureTarget = TextureTarget.TEXTURE_2D
    internal_format: InternalFormat = InternalFormat.RGBA8
    origin: WindowOrigin = WindowOrigin.LOWER_LEFT


@dataclass(frozen=True, kw_only=True)
class ResetHistogram:
    """ResetHistogram (EXT_histogram): every count of the machine's histogram ``name`` becomes zero."""

    label: str
    name: str


@dataclass(frozen=True, kw_only=True)
class ResetMinmax:
    """ResetMinmax (EXT_histogram): the machine's minmax ``name`` becomes empty."""

    label: str
    name: str


Command = (
    Clear
    | Draw
    | TexImage
    | CopyTexImage
    | CopyTexSubImage
    | ReadPixels
    | GetTexImage
    | HostStep
    | Saturate
    | DrawPixels
    | CopyPixels
    | Bitmap
    | Accum
    | MakeCurrent
    | BindTexImage
    | ResetHistogram
    | ResetMinmax
)
COMMANDS = get_args(Command)


def kind_of(command: DrawPixels | CopyPixels) -> PixelCopyType:
    """What the groups of a DrawPixels or CopyPixels hold, as a PixelCopyType."""
    if isinstance(command, CopyPixels):
        return command.type
    formats = {DEPTH_FORMAT: PixelCopyType.DEPTH, STENCIL_FORMAT: PixelCopyType.STENCIL}
    return formats.get(command.image.format, PixelCopyType.COLOR)


def box_read(command, width, height):
    """(x, y, width, height) of the rectangle that a command reads from a framebuffer of ``width`` x
    ``height``.

    The command is a ReadPixels, CopyPixels, CopyTexImage or CopyTexSubImage. A size of None reaches to the
    edge.
    """
    across = width - command.x if command.width is None else command.width
    up = height - command.y if command.height is None else command.height
    return command.x, command.y, across, up


@lru_cache(maxsize=256)
def vertex_of(position: RasterPosition) -> Mesh:
    """A RasterPosition as a mesh of one vertex."""
    return Mesh(
        np.array([position.position]),
        PrimitiveType.POINTS,
        colors=np.array([position.color]),
        secondary_colors=np.array([position.secondary_color]),
        normals=np.array([position.normal]),
        texture_coordinates=tuple(np.array([strq]) for strq in position.texture_coordinates),
        fog_coordinates=np.array([position.fog_coordinate]),
        weights=np.array([position.weight]),
    )
