"""Common parts of the suites' programs: their conventions, matrices, default state and backgrounds, as state.

Source: the public programs that drew the captures, nxdk_pgraph_tests with pbkitplusplus (test host, suite
defaults). Vertices are in device pixels there, y down; depth in the buffer's units.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.conformance.case import HEIGHT, WIDTH
from fixedpipe.effects.passes.combiners import PRIMARY, SPARE0, TEXTURE0, program, shown, stage, total
from fixedpipe.pipeline.commands import Clear, Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import (
    BlendFactor,
    Face,
    FrontFace,
    LineRasterization,
    PrimitiveType,
    TextureFilter,
    VertexStage,
    WrapMode,
)
from fixedpipe.pipeline.state import (
    IDENTITY,
    Blending,
    Composite,
    LineState,
    PassState,
    PolygonState,
    Sampler,
    TextureUnit,
    VertexState,
)
from fixedpipe.pipeline.textures.images import texture_2d

PROGRAM_RESULTS = VertexState(stage=VertexStage.PROGRAM_RESULTS)
BLENDED = Blending(BlendFactor.SRC_ALPHA, BlendFactor.ONE_MINUS_SRC_ALPHA)  # every program's default

NEAREST = Sampler(
    TextureFilter.NEAREST, TextureFilter.NEAREST, WrapMode.CLAMP_TO_EDGE, WrapMode.CLAMP_TO_EDGE
)

# The XDK's default view: 45 degrees, 4:3, the eye at z = -7. Source: SetXDKDefaultViewportAndFixedFunction-
# Matrices: the composite matrix's rows for x, y and w (times w), and the viewport's offset.
XDK_SCALE, XDK_OFFSET, XDK_EYE = 579.411194, 0.53125, 7.0
XDK_VIEW = (*IDENTITY[:2], (0.0, 0.0, 1.0, XDK_EYE), IDENTITY[3])


def argb(word):
    """A colour of 0xAARRGGBB as RGBA floats."""
    return tuple(((word >> shift) & 255) / 255.0 for shift in (16, 8, 0, 24))


def abgr(word):
    """A vertex colour of 0xAABBGGRR (a 4-byte vertex attribute) as RGBA floats."""
    return tuple(((word >> shift) & 255) / 255.0 for shift in (0, 8, 16, 24))


def shows(register):
    """Combiners whose result is one register, colour and alpha."""
    both_halves = total(register, to=SPARE0)
    return program(stage(both_halves, alpha=both_halves), shown(SPARE0, alpha=SPARE0))


SHOWS_PRIMARY = shows(PRIMARY)
SHOWS_PRIMARY_OPAQUE = program(stage(total(PRIMARY, to=SPARE0)), shown(SPARE0))
SHOWS_TEXTURE0 = shows(TEXTURE0)
RECTANGLES = LineState(rasterization=LineRasterization.RECTANGLE)
# Faces whose corners turn clockwise on the screen; the others are culled.
FRONT_FACES = PolygonState(cull_face=Face.BACK, front_face=FrontFace.CW)
DEFAULT = PassState(
    vertex=PROGRAM_RESULTS, register_combiners=SHOWS_PRIMARY, blending=BLENDED, line=RECTANGLES
)


def single(values):
    """Numbers as the chip reads them, in single precision."""
    return np.asarray(values, np.float32).astype(np.float64)


def from_patterns(words):
    """Float64 of bit patterns of single-precision numbers, which may be infinite or none."""
    with np.errstate(invalid="ignore"):  # a signalling NaN says so when it is read
        return np.array(words, np.uint32).view(np.float32).astype(np.float64)


def window_mesh(positions, primitive=PrimitiveType.QUADS, height=HEIGHT, **arrays):
    """A mesh whose positions are device pixels (x right, y down), z in depth units and clip w, as a vertex
    program's results.

    ``positions`` [n, 2..4]; single precision, as the chip reads them. ``height``: of the surface drawn to,
    pixels. Other arrays as in Mesh.
    """
    positions = single(positions)
    positions[:, 1] = height - positions[:, 1]
    return Mesh(positions, primitive, **arrays)


def rectangle(left, top, right, bottom, z=0.0):
    """Four corners of a quad in the programs' order: upper left, upper right, lower right, lower left."""
    return [(left, top, z), (right, top, z), (right, bottom, z), (left, bottom, z)]


UNIT_SQUARE = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])  # a quad's texture coordinates
TWO_TRIANGLES = ((0, 0), (1, 0), (1, 1), (0, 0), (1, 1), (0, 1))  # that make the square


def textured_triangles(positions, coordinates):
    """A mesh of triangles at device places [n, 3] with texture coordinates [n, 2..4] of unit 0."""
    return Mesh(
        single(positions),
        PrimitiveType.TRIANGLES,
        texture_coordinates=(np.array(coordinates, np.float64),),
    )


def quad(label, corners, color, state=DEFAULT, height=HEIGHT):
    """A quad of one colour, RGBA; ``corners`` as ``rectangle`` gives them."""
    return Draw(
        label=label, mesh=window_mesh(corners, height=height, colors=single([color] * 4)), state=state
    )


def textured_quad(label, corners, texture, state=DEFAULT, height=HEIGHT):
    """A quad that shows the whole of a 2D texture, its first row on top, nearest texels."""
    state = replace(state, register_combiners=SHOWS_TEXTURE0, texture_units=(TextureUnit(texture, NEAREST),))
    return Draw(
        label=label,
        mesh=window_mesh(corners, height=height, texture_coordinates=(UNIT_SQUARE,)),
        state=state,
    )


def unprojected_rectangle(left, top, right, bottom, z=0.0):
    """The corners of a quad that the program unprojects into the XDK's view, and that the chip projects
    again.

    Measured: they come back half a pixel further, because the viewport's offset is snapped
    (DrawCheckerboardUnproject).
    """
    return rectangle(left + 0.5, top + 0.5, right + 0.5, bottom + 0.5, z)


def unprojected(x, y, z):
    """The point (x, y, z) of the XDK's view, with a given z, that the chip draws at pixel (x, y) plus the
    viewport's offset.
    """
    w = z + XDK_EYE
    return (x - WIDTH / 2) / XDK_SCALE * w, (HEIGHT / 2 - y) / XDK_SCALE * w, z


def xdk_vertex(
    model=IDENTITY, near=1.0, far=200.0, depth_maximum=16777215.0, offset=XDK_OFFSET, view=XDK_VIEW
):
    """The XDK's default fixed-function view as vertex state: eye coordinates have z forwards.

    ``model``: applied before ``view``, which by default moves the eye to z = -7; ``near``, ``far``: eye
    distances of the view volume's planes; ``offset``: the viewport's in x and y, device pixels.
    """
    scale = depth_maximum * far / (far - near)
    projection = np.array(
        [
            (XDK_SCALE, 0.0, WIDTH / 2, 0.0),
            (0.0, -XDK_SCALE, HEIGHT / 2, 0.0),
            (0.0, 0.0, scale, -scale * near),
            (0.0, 0.0, 1.0, 0.0),
        ]
    )
    modelview = times(view, model)
    return VertexState(
        modelview=rows_of(modelview),
        composite=Composite(rows_of(times(projection, modelview)), (offset, offset, 0.0)),
    )


def times(a, b):
    """A matrix, or row vectors, times a matrix in float64: each sum's four terms from left to right.

    NumPy's own product rounds otherwise on other processors.
    """
    a, b = np.asarray(a, np.float64), np.asarray(b, np.float64)
    terms = [a[..., k, None] * b[k] for k in range(4)]
    return ((terms[0] + terms[1]) + terms[2]) + terms[3]


def rows_of(matrix):
    """A 4x4 array as a state's matrix."""
    return tuple(tuple(row) for row in np.asarray(matrix).tolist())


def clear(word, depth=None, stencil=None):
    """The frame's first command: the colour 0xAARRGGBB, the farthest depth and stencil zero by default."""
    return Clear(
        label="background",
        color=argb(word),
        depth=1.0 if depth is None else depth,
        stencil=0 if stencil is None else stencil,
    )


def checkerboard(first, second, cell, size=256):
    """uint8 [size, size, 4]: squares of ``cell`` texels, the first (0xAARRGGBB) at texel (0, 0)."""
    at = np.arange(size) // cell
    odd = (at[:, None] + at[None, :]) % 2 == 1
    colors = np.array([[round(255 * c) for c in argb(word)] for word in (first, second)], np.uint8)
    return colors[odd.astype(int)]


def background(first=0xFF333333, second=0xFF444444, cell=None, size=256, corners=None):
    """Commands that stretch a checkerboard over the whole screen (DrawCheckerboardUnproject).

    Texture row 0 is the top row. ``corners``: device positions as in ``rectangle``. Measured: (0.5, 0.5) to
    (640.5, 480.5), split from upper left to lower right (Lighting_control FF_0x000000).
    """
    image = checkerboard(first, second, size // 32 if cell is None else cell, size)
    state = PassState(
        vertex=PROGRAM_RESULTS,
        texture_units=(TextureUnit("checkerboard", NEAREST),),
        register_combiners=SHOWS_TEXTURE0,
    )
    corners = window_mesh(
        rectangle(0.5, 0.5, WIDTH + 0.5, HEIGHT + 0.5) if corners is None else corners,
        texture_coordinates=(np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]),),
    )
    return (
        TexImage(label="checkerboard", texture="checkerboard", image=texture_2d(image)),
        Draw(label="background", mesh=corners, state=state),
    )
