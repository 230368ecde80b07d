"""Results of the suites' vertex programs, as a mesh's positions for VertexStage.PROGRAM_RESULTS.

Measured: the chip's vertex arithmetic rounds toward zero (Shade_model Prog captures). With it all pixels
agree; with exact arithmetic up to 20 differ, because a vertex in the middle of the screen lands just beside
it.
"""

import numpy as np

from fixedpipe.effects.conformance import host_matrices
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH
from fixedpipe.effects.conformance.scenes import single, window_mesh
from fixedpipe.pipeline.enums import PrimitiveType
from fixedpipe.pipeline.vertices.chip_floats import (
    TRANSFORM_BITS,
    product,
    total,
    transform_dot,
    transform_inverse_root,
)
from fixedpipe.pipeline.vertices.vertex_programs import vertex_program

EYE_DISTANCE, NEAR, FAR = 7.0, 1.0, 200.0


def toward_zero(values):
    """Round float64 to single precision, toward zero."""
    values = np.asarray(values, np.float64)
    nearest = values.astype(np.float32)
    lower = np.nextafter(nearest, np.float32(0))
    return np.where(np.abs(nearest) > np.abs(values), lower, nearest).astype(np.float64)


def perspective(points, depth_maximum=16777215.0, eye=EYE_DISTANCE, far=FAR, offset=0.0):
    """Window positions [n, 4] (device x and y, depth units, w) of ``points`` [n, 3] in the default view.

    The default view has 45 degrees, 4:3, and the eye at z = -7; ``eye`` and ``far`` change it. Source:
    PerspectiveVertexShader: the view matrix, then projection and viewport as one matrix, then a division by
    w. ``offset``: the chip's viewport offset, pixels, which it also adds to a program's results. Measured:
    609515 of 609518 pixels with the XDK's 17/32, 567298 without (Depth_Clamp VSH1 captures).
    """
    x, y, z = single(points).T
    y_scale = single(1.0 / np.tan(single(np.pi / 8)))
    x_scale = single(y_scale / single(WIDTH / HEIGHT))
    depth_scale = single(single(far / (far - NEAR)) * depth_maximum)
    w = toward_zero(z + eye)
    reciprocal = toward_zero(1.0 / w)
    window = (
        toward_zero(toward_zero(x * single(x_scale * WIDTH / 2)) + toward_zero(w * (WIDTH / 2))),
        toward_zero(toward_zero(y * -single(y_scale * HEIGHT / 2)) + toward_zero(w * (HEIGHT / 2))),
        toward_zero(toward_zero(w * depth_scale) - toward_zero(NEAR * depth_scale)),
    )
    x, y, z = (toward_zero(v * reciprocal) for v in window)
    return np.stack([toward_zero(x + offset), toward_zero(y + offset), z, w], axis=1)


# ------------------------------------------------------------------------------------------- projection


def unproject(x, y, z):
    """World position [3] of a device pixel at the depth ``z``, in depth units of 24 bits.

    Measured: Specular/ControlFlagsLightDisable_VS, 300970 of 300970.
    """
    _, inverse = host_matrices.programmed()
    world = host_matrices.times(np.array([x, y, z, 1], np.float32), inverse)
    return (world[:3] / world[3]).astype(np.float64)


# ---------------------------------------------------------------------------------------------- programs

# A position through the model, view and projection matrices of ``host_matrices.perspective_constants``, then
# divided by w, which R12 keeps. Source: projection_vertex_shader_no_lighting.vsh of nxdk_pgraph_tests.
PROJECTS = "\n".join(
    [
        *(
            f"DP4 {to}.{component}, {given}, c[{first + row}];"
            for to, given, first in (("R0", "v[OPOS]", 96), ("R1", "R0", 100), ("R0", "R1", 104))
            for row, component in enumerate("xyzw")
        ),
        "RCP R1.x, R0.w; MUL o[HPOS].xyz, R0, R1.x; MOV o[HPOS].w, R0;",
    ]
)
PROJECTION = vertex_program(PROJECTS)
COPIES_COLORS = "MOV o[COL0], v[COL0]; MOV o[COL1], v[COL1]; MOV o[BFC0], v[BFC0]; MOV o[BFC1], v[BFC1];"


def results_mesh(results, primitive=PrimitiveType.QUADS, **arrays):
    """A mesh of what a VertexProgram's ``run`` gave, in device pixels. ``arrays``: what it did not write."""
    written = {"colors": "COL0", "secondary_colors": "COL1", "fog_coordinates": "FOGC"}
    arrays |= {array: results[output] for array, output in written.items() if output in results}
    for name in ("colors", "secondary_colors"):
        if name in arrays:  # Measured: a NaN is 1, with its sign bit 0 (Attrib_float, -NaNq_NaNq)
            numbers = np.where(np.signbit(arrays[name]), 0.0, 1.0)
            arrays[name] = np.where(np.isfinite(arrays[name]), arrays[name], numbers)
    return window_mesh(results["HPOS"], primitive, **arrays)


# ------------------------------------------------------------------------------------------ instructions


def dp3(a, b):
    """DP3 of two vectors of three columns."""
    return transform_dot(a, b)


def mul(a, b):
    """MUL of two columns."""
    return product(a, b, TRANSFORM_BITS)


def add(a, b):
    """ADD of two columns."""
    return total((a, b), TRANSFORM_BITS)


def normalized(v):
    """DP3, RSQ and MUL: a vector of three columns made a unit vector."""
    root = transform_inverse_root(dp3(v, v))
    return [mul(c, root) for c in v]
