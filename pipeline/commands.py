"""What a frame is made of. An effect returns a tuple of these; ``fixedpipe.pipeline.execution`` runs them in
order.

Every command carries everything it needs and a ``label`` in the paper's words. Window coordinates are
OpenGL's: origin lower left, y up. Images of textures and of ReadPixels have their bottom row first.
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
    """A read-only copy. Raises ValueError for what is no array of numbers."""
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
    """Vertex arrays of one primitive type (sections 2.6 to 2.8), which ``validate`` checks.

    positions           float64 [n, 2..4], object coordinates; missing components are z = 0, w = 1
    indices             int64 [k] into the vertices, or None: the vertices in order
    counts              how many indices each strip, fan or polygon takes, or None: all of them are one
    colors              float64 [n, 3..4], 1.0 = full intensity, or None: (1, 1, 1, 1)
    secondary_colors    float64 [n, 3..4], or None: (0, 0, 0); without a fourth component alpha is 0
    normals             float64 [n, 3], or None: (0, 0, 1)
    texture_coordinates tuple of float64 [n, 1..4], one per coordinate set; missing components are
                        t = 0, r = 0, q = 1; a set that is missing is (0, 0, 0, 1) everywhere
    fog_coordinates     float64 [n], or None: 0
    back_colors, back_secondary_colors  the same for faces seen from behind, where a vertex program wrote them
                        (NV_vertex_program's o[BFC0], o[BFC1]) and the state takes them; None: (0, 0, 0, 1)
    point_sizes         float64 [n], pixels, where a vertex program wrote them (o[PSIZ]) and the state takes
                        them; None: 1
    edge_flags          bool [n] (section 2.6.2): whether the edge that begins at a vertex is a boundary, for
                        TRIANGLES, QUADS and POLYGON drawn as points or lines; None: all are
    weights             float64 [n], of the first of two modelview matrices (EXT_vertex_weighting), or None: 1

    Arrays are copied and made read-only. Raises ValueError for what is no array of (whole) numbers.
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
    """Clear (section 4.2.3). None: that buffer is not cleared. ``depth`` in [0, 1], ``stencil`` 0..255.

    ``accumulation``: components in [-1, 1]; the color mask is not for it. ``draw_buffer``: whose color.
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
    """Draw a mesh in a state."""

    label: str
    mesh: Mesh
    state: PassState


@dataclass(frozen=True, kw_only=True)
class TexImage:
    """TexImage1D/2D/3D (section 3.8.1): store ``image`` as the texture object ``texture``.

    Either ``image`` is given, a Texture as it is stored, or ``pixels``, an image that goes through
    ``transfer`` and is then stored as ``internal_format``; with ``generate_mipmap`` every smaller level too.
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

    A 1D texture takes a rectangle of one row.

    Level 0 is defined; with ``generate_mipmap`` (SGIS_generate_mipmap) every smaller level from it. Pixels go
    through ``transfer``; where a convolution makes the rectangle smaller, the texture is so.
    A cube map is defined by a TexImage and filled face by face with CopyTexSubImage.
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

    ``face``: 0..5 in the order +x, -x, +y, -y, +z, -z for a cube map, else 0. With ``generate_mipmap``
    (SGIS_generate_mipmap; level 0 only) every smaller level is made again from level 0. Pixels go through
    ``transfer``.
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

    ``format``: RGBA, RGB, BGRA, BGR, RED, GREEN, BLUE, ALPHA, LUMINANCE (R + G + B, clamped), LUMINANCE_ALPHA
    as uint8 [h, w(, c)]; DEPTH_COMPONENT as uint32 [h, w] in depth units; STENCIL_INDEX as uint8 [h, w].
    ``type``: of colours, an integer type, FLOAT (float64, clamped to [0, 1]), or a packed type of RGB, or of
    RGBA or BGRA (words [h, w]); the ideal reads real numbers whatever the type. Pixels go through
    ``transfer``; a histogram's or minmax's sink leaves nothing to return.
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

    The groups are the stored components by table 6.1: luminance and intensity are red alone, with green and
    blue zero; missing alpha, intensity's too, is one. ``face``: of a cube map, 0..5 as CopyTexSubImage's; of
    a 3D texture all layers are read, [d, h, w(, c)]. ``format``, ``type``: as ReadPixels', without
    STENCIL_INDEX; DEPTH_COMPONENT reads depth textures, and they nothing else. ``transfer``: the initial one,
    but where the profile's ``transfers_texture_queries`` says that pixels go through it.
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
    """What the application's processor does between commands: it looks at what ReadPixels or GetTexImage
    gave, and issues other commands in this one's place.

    ``reads``: names that these gave earlier in the same frame. ``commands``: a function that takes a
    dictionary of these arrays, read-only, and returns a tuple of commands. A machine hands it integers, the
    ideal float64, as ``execute_ideal`` reads them; for the same shapes both must draw the same rectangles and
    meshes, so that a frame of the one can guide the other. Its commands are validated once they are there,
    and what follows them again. Textures that they store stay, but commands that follow cannot name them.
    """

    label: str
    reads: tuple[str, ...]
    commands: Callable[[Mapping[str, NDArray[Any]]], "Iterable[Command]"]


@dataclass(frozen=True, kw_only=True)
class Saturate:
    """Says that what follows relies on colours in [0, 1], as a framebuffer of fixed-point numbers holds them.

    On a machine nothing happens: blending clamps what it writes (section 4.1.6). Where blending does not, on
    the exact machine or one without that clamp, the colours in the scissor box are clamped here. So an
    algorithm that uses the clamp says where, and its ideal has it there and nowhere else.
    """

    label: str
    scissor: Scissor | None = None
    draw_buffer: ColorBuffer = ColorBuffer.BACK


@dataclass(frozen=True, kw_only=True)
class DrawPixels:
    """DrawPixels (section 3.6.4): each group of ``image`` becomes the fragments of a rectangle of pixels.

    The group of column n and row m, from 0, makes those whose centres lie in the rectangle with the corners
    ``(x + zx n, y + zy m)`` and ``(x + zx (n + 1), y + zy (m + 1))``, on its left and its lower side too,
    where (x, y) is the raster position in window coordinates and (zx, zy) is ``zoom`` (PixelZoom), which may
    be negative or a fraction. Colour groups give fragments their colour, DEPTH_COMPONENT their depth; all
    else is the raster position's. They pass through texturing, fog and the tests of ``state``. STENCIL_INDEX
    goes to the stencil buffer, through the scissor and StencilMask (``stencil_test.write_mask``) alone.
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
    """CopyPixels (section 4.3.3): DrawPixels of what the framebuffer holds in a rectangle.

    All of it is read before any of it is drawn. ``read_buffer``: of COLOR.
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
    """Bitmap (section 3.7): fragments where ``bits`` is set, all with the raster position's data.

    ``bits``: bool [h, w], bottom row first. The lower left pixel is the raster position minus ``origin``,
    rounded down. The command moves nothing: give ``position.moved(...)`` to the next.
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
    """Accum (section 4.2.4), of the pixels in the scissor box.

    LOAD stores, ACCUM adds, the read buffer's colours times ``value``; MULT and ADD change what the
    accumulation buffer holds by ``value``; RETURN writes it times ``value`` to the draw buffer.
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
    """WGL_ARB_pbuffer: the commands that follow draw to and read from ``surface``; None: the window again.

    The first MakeCurrent that names a pbuffer makes it: zero colour, the farthest depth, stencil zero. Later
    ones say its size and formats again, and find what it holds. A frame begins with the window. ``samples``:
    of each of its pixels (WGL_ARB_multisample).

    ``shares_depth``: it has no depths and stencil values of its own, but those of the pbuffer ``depth_of``,
    or where that is None the window's, as Direct3D's SetRenderTarget keeps a depth surface. Pixels that lie
    as far from the left and from the top have them in common; the other is at least as large, and has as many
    depth bits and samples.
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
    """WGL_ARB_render_texture: define ``texture`` as the colours that ``surface`` holds now; with a depth
    format (WGL_NV_render_depth_texture) as its depths.

    The pbuffer's bits are read as ``internal_format``, which is as wide. ``origin`` LOWER_LEFT: the bottom
    row has t = 0, as in OpenGL; UPPER_LEFT: the top row does, which is the first in the chip's memory. Of a
    pbuffer with several samples a texture is as many times as wide: a pixel's samples lie side by side there.
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
    """ResetMinmax (EXT_histogram): the machine's minmax ``name`` forgets what it saw."""

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
    """What the groups of a DrawPixels or CopyPixels are, as a PixelCopyType."""
    if isinstance(command, CopyPixels):
        return command.type
    formats = {DEPTH_FORMAT: PixelCopyType.DEPTH, STENCIL_FORMAT: PixelCopyType.STENCIL}
    return formats.get(command.image.format, PixelCopyType.COLOR)


def box_read(command, width, height):
    """(x, y, width, height) of what a ReadPixels, CopyPixels, CopyTexImage or CopyTexSubImage reads of a
    framebuffer of ``width`` x ``height`` pixels; None: as far as it reaches.
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
