"""Direct3D 8's and 9's conventions in OpenGL's words.

Direct3D multiplies row vectors by matrices, has pixel centres at whole numbers, y down on the screen, depths
from 0 to 1 in clip coordinates, and looks along positive z. OpenGL's equations give the same window
coordinates with matrices transposed, a shift of half a pixel, and depths doubled and moved. Lights and fog
are in eye coordinates whose z is turned round. Of a flat triangle Direct3D takes the first vertex's colour,
OpenGL the last's: ``provoking_vertex``, on machines that have it; no case here depends on it.
"""

import numpy as np

from fixedpipe.pipeline import Clear, Draw, Mesh, PassState, Sampler, VertexState
from fixedpipe.pipeline.enums import PrimitiveType, TextureFilter, WrapMode

_TURNED = np.diag([1.0, 1.0, -1.0, 1.0])
QUAD = ((-1.0, -1.0, 0.1), (-1.0, 1.0, 0.1), (1.0, -1.0, 0.1), (1.0, 1.0, 0.1))
POINT = Sampler(TextureFilter.NEAREST, TextureFilter.NEAREST)
POINT_CLAMPED = Sampler(
    TextureFilter.NEAREST,
    TextureFilter.NEAREST,
    wrap_s=WrapMode.CLAMP_TO_EDGE,
    wrap_t=WrapMode.CLAMP_TO_EDGE,
    wrap_r=WrapMode.CLAMP_TO_EDGE,
)


def matrix(rows):
    """A state's matrix of an array's rows, for column vectors."""
    return tuple(tuple(float(entry) for entry in row) for row in np.asarray(rows))


def vertex_state(size, world=None, view=None, projection=None, **fields):
    """The VertexState of Direct3D's three matrices, for row vectors, in a viewport of ``size``."""
    world, view, projection = (np.eye(4) if m is None else np.asarray(m) for m in (world, view, projection))
    width, height = size
    clip = np.array([[1, 0, 0, 1 / width], [0, 1, 0, -1 / height], [0, 0, 2, -1], [0, 0, 0, 1]])
    return VertexState(
        modelview=matrix(_TURNED @ (world @ view).T),
        projection=matrix(clip @ projection.T @ _TURNED),
        **fields,
    )


def transformed(vertices, size):
    """Clip coordinates of vertices that Direct3D takes as transformed (D3DFVF_XYZRHW): x, y, z, 1/w."""
    x, y, z, rhw = np.array(vertices, float).T
    width, height = size
    clip = [(x + 0.5) * 2 / width - 1, 1 - (y + 0.5) * 2 / height, 2 * z - 1, np.ones_like(x)]
    return (np.array(clip) / rhw).T


def argb(word):
    """The components of a D3DCOLOR, (r, g, b, a), 1.0 is one."""
    return tuple((word >> shift & 255) / 255 for shift in (16, 8, 0, 24))


def texels(rows):
    """A D3DFMT_A8R8G8B8 image, uint8 [h, w, 4] RGBA; Direct3D's first row is OpenGL's of t = 0."""
    words = np.array(rows, np.uint32)
    return np.stack([words >> shift & 255 for shift in (16, 8, 0, 24)], -1).astype(np.uint8)


def strip(positions=QUAD, color=None, **arrays):
    """A triangle strip; ``color``: one D3DCOLOR of all vertices."""
    if color is not None:
        arrays["colors"] = [argb(color)] * len(positions)
    return Mesh(positions, PrimitiveType.TRIANGLE_STRIP, **arrays)


def fan(positions, color, **arrays):
    """Two triangles, 0 1 2 and 2 3 0, of one D3DCOLOR."""
    return Mesh(positions, indices=[0, 1, 2, 2, 3, 0], colors=[argb(color)] * 4, **arrays)


def clear(color=0, depth=None, stencil=None):
    """IDirect3DDevice::Clear of the target, and of depth and stencil where given."""
    return Clear(label="clear", color=argb(color), depth=depth, stencil=stencil)


def draw(mesh, size, **state):
    """A Draw in a state of Direct3D's, whose matrices are identities where ``state`` has no vertex state."""
    return Draw(label="draw", mesh=mesh, state=PassState(**({"vertex": vertex_state(size)} | state)))
