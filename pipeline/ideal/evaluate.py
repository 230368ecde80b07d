"""The IDEAL evaluator: the same passes in float64, with no rounding and no clamp but the algorithm's own.

What stays, what goes, and why: docs/decisions/0001-ideal-evaluator.md. Only coverage is the machine's: the
fragments are those of the snapped vertices.
"""

from collections import deque
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from fixedpipe.pipeline.commands import (
    Accum,
    Bitmap,
    Clear,
    CopyPixels,
    CopyTexImage,
    CopyTexSubImage,
    Draw,
    DrawPixels,
    HostStep,
    ReadPixels,
    ResetHistogram,
    ResetMinmax,
    Saturate,
    TexImage,
)
from fixedpipe.pipeline.enums import (
    AccumOperation,
    BlendEquation,
    BlendFactor,
    ColorBuffer,
    CombinerBias,
    CombinerFunction,
    CombinerScale,
    ComparisonFunction,
    ComponentUsage,
    FogMode,
    FrontFace,
    Mapping,
    Register,
    ShadeModel,
    StencilOperation,
    TextureCompareMode,
    TextureFilter,
    TextureTarget,
    WrapMode,
)
from fixedpipe.pipeline.framebuffers.rectangles import without_footprints
from fixedpipe.pipeline.framebuffers.result import Result
from fixedpipe.pipeline.framebuffers.texture_copies import defined_texture, depth_texture
from fixedpipe.pipeline.framebuffers.transfer import (
    HistogramTable,
    MinmaxTable,
    PixelStatistics,
    changes_nothing,
    looked_up,
    transfer_colors,
    transfer_depths,
    transfer_stencil,
)
from fixedpipe.pipeline.ideal.rectangles import rectangle
from fixedpipe.pipeline.ideal.texture_shader import run_stages, signed, signed_flags
from fixedpipe.pipeline.native.coverage import rasterize
from fixedpipe.pipeline.native.threads import Threads, default_threads
from fixedpipe.pipeline.profiles import IDEAL
from fixedpipe.pipeline.programs.combiner_rules import has_color_sum
from fixedpipe.pipeline.programs.future import units_along
from fixedpipe.pipeline.programs.texture_environment import environment_program
from fixedpipe.pipeline.textures.images import (
    BASE_FORMAT,
    DEPTH_TEXELS,
    KEPT,
    Texture,
    depth_texture_mode,
    pyramid,
    register_components,
    texture_2d,
)
from fixedpipe.pipeline.validation.frames import frame_of, issued_by
from fixedpipe.pipeline.validation.validate import validate
from fixedpipe.pipeline.vertices.stage import process
from fixedpipe.raster.columns.per_fragment import in_order

# Fragments shaded at a time: bounds the columns' memory to some megabytes a thread, and changes no value.
_CHUNK = 1 << 14

# Texels: a nearest filter's shift off an exact texel boundary, and what the machines add to coordinates that
# they divided.  Source: docs/numbers.md, section 6.
_TAU = 2.0**-24

_MIPMAPPED = {
    # minification filter: (linear within a level, linear between levels)
    TextureFilter.NEAREST_MIPMAP_NEAREST: (False, False),
    TextureFilter.LINEAR_MIPMAP_NEAREST: (True, False),
    TextureFilter.NEAREST_MIPMAP_LINEAR: (False, True),
    TextureFilter.LINEAR_MIPMAP_LINEAR: (True, True),
}

# Component and sign of sc and tc for the faces +x, -x, +y, -y, +z, -z.
# Source: EXT_texture_cube_map, section 3.8.6.
_SC_COMPONENT, _SC_SIGN = np.array([2, 2, 0, 0, 0, 0]), np.array([-1.0, 1.0, 1.0, 1.0, 1.0, -1.0])
_TC_COMPONENT, _TC_SIGN = np.array([1, 1, 2, 2, 1, 1]), np.array([-1.0, -1.0, 1.0, -1.0, -1.0, -1.0])

_SCALE = {
    CombinerScale.NONE: 1.0,
    CombinerScale.SCALE_BY_TWO: 2.0,
    CombinerScale.SCALE_BY_FOUR: 4.0,
    CombinerScale.SCALE_BY_ONE_HALF: 0.5,
}

# The future board's: a register's range, and an exponent whose power is beyond it.
_FARTHEST, _LARGEST_EXPONENT = 256.0, 21.0

_DRAWING = Draw | DrawPixels | CopyPixels | Bitmap
_COLOR_COMPONENTS = {
    "RGBA": [0, 1, 2, 3],
    "RGB": [0, 1, 2],
    "RED": 0,
    "GREEN": 1,
    "BLUE": 2,
    "ALPHA": 3,
}


@dataclass(frozen=True, eq=False)
class IdealResult:
    """What a frame leaves behind on the ideal machine. Arrays of the framebuffer have their top row first.

    color     float64 [h, w, 4], 1.0 = full intensity, not clamped: additive passes may exceed 1
    depth     float64 [h, w], window depth in [0, 1]
    stencil   uint8 [h, w]
    textures  name to Texture, every one with its ``ideal`` levels
    pixels    name to array, of ReadPixels, bottom row first: colours, depths float64; stencil uint8
    histograms, minmaxes  as a Result's
    """

    color: np.ndarray
    depth: np.ndarray
    stencil: np.ndarray
    textures: dict[str, Texture]
    pixels: dict[str, np.ndarray]
    histograms: dict[str, HistogramTable]
    minmaxes: dict[str, MinmaxTable]

    def image(self):
        """uint8 [h, w, 4]: the colours clamped to [0, 1] and rounded to the nearest byte."""
        return to_bytes(self.color)


def to_bytes(values):
    """Reals to bytes: clamped to [0, 1], then the nearest of 0..255 (halves up), as OpenGL 1.2.1 converts."""
    return np.floor(np.clip(values, 0.0, 1.0) * 255.0 + 0.5).astype(np.uint8)


# ------------------------------------------------------------------------------------------ interpolation


@dataclass(frozen=True, eq=False)
class Weights:
    """Barycentric weights of fragments, from the exact edge functions of the snapped vertices.

    vertices       int64 [k, 3]
    front          bool [k], front-facing
    perspective    float64 [k, 3], (n_i / w_i) / sum: for every iterated value but window depth

    What not every state reads is a property, computed when it is asked for first.
    """

    vertices: np.ndarray
    front: np.ndarray
    perspective: np.ndarray
    _edges: np.ndarray  # n_i, float64 [k, 3]
    _area: np.ndarray  # twice the triangle's, signed, int64 [k]
    _sides: tuple  # x and y of vertex 1, then of vertex 2, from vertex 0: int64 [k] each
    _inverse_w: np.ndarray
    _z: np.ndarray

    @cached_property
    def affine(self):
        """N_i / A, float64 [k, 3]: for window depth."""
        return self._edges / np.abs(self._area)[:, None]

    @cached_property
    def dx(self):
        """The derivative of ``perspective`` per pixel to the right, float64 [k, 3]."""
        _, y10, _, y20 = self._sides
        return self._derivative(y10 - y20, y20, -y10)

    @cached_property
    def dy(self):
        """The derivative of ``perspective`` per pixel down, float64 [k, 3]."""
        x10, _, x20, _ = self._sides
        return self._derivative(x20 - x10, -x20, x10)

    def _derivative(self, *steps):
        # Steps of n over one pixel, 16 subpixels.
        step = 16.0 * np.stack(steps, axis=1) * np.where(self._area < 0, -1, 1)[:, None]
        total = (self._edges * self._inverse_w).sum(axis=1, keepdims=True)
        de = step * self._inverse_w
        return (de - self.perspective * de.sum(axis=1, keepdims=True)) / total

    @cached_property
    def machine(self):
        """The machines' weights q0 and q2, float64 [k, 2], which decide at exact texel boundaries."""
        e = self._edges * self._inverse_w
        return _machine_weights(e, e.sum(axis=1, keepdims=True))

    @cached_property
    def depth_slope(self):
        """Max(abs(dz/dx), abs(dz/dy)) of window depth per pixel, float64 [k]."""
        x10, y10, x20, y20 = self._sides
        z10, z20 = self._z[:, 1] - self._z[:, 0], self._z[:, 2] - self._z[:, 0]
        slope_x = (z10 * y20 - z20 * y10) * 16.0 / self._area
        slope_y = (z20 * x10 - z10 * x20) * 16.0 / self._area
        return np.maximum(np.abs(slope_x), np.abs(slope_y))


def weigh(primitives, front_face, triangle, x, y):
    """The Weights of the fragments (triangle, x, y), int [k] each, of ``primitives``.

    Source: docs/numbers.md, sections 3 to 5; derivatives by the quotient rule.
    """
    vertices = primitives.triangles[triangle, :3].astype(np.int64)
    corner_x, corner_y = primitives.x[vertices].astype(np.int64), primitives.y[vertices].astype(np.int64)
    sample_x, sample_y = 16 * x.astype(np.int64) + 8, 16 * y.astype(np.int64) + 8
    x10, x20 = corner_x[:, 1] - corner_x[:, 0], corner_x[:, 2] - corner_x[:, 0]
    y10, y20 = corner_y[:, 1] - corner_y[:, 0], corner_y[:, 2] - corner_y[:, 0]
    px, py = sample_x - corner_x[:, 0], sample_y - corner_y[:, 0]
    area = x10 * y20 - x20 * y10
    sign = np.where(area < 0, -1, 1)
    n1, n2 = sign * (px * y20 - x20 * py), sign * (x10 * py - px * y10)
    n = np.stack([np.abs(area) - n1 - n2, n1, n2], axis=1).astype(np.float64)

    inverse_w = primitives.inverse_w[vertices]
    equal = (inverse_w[:, 0] == inverse_w[:, 1]) & (inverse_w[:, 1] == inverse_w[:, 2])
    inverse_w = np.where(equal[:, None], 1.0, inverse_w)
    e = n * inverse_w
    front = (area < 0) == (front_face is FrontFace.CCW)
    perspective = e / e.sum(axis=1, keepdims=True)
    sides = x10, y10, x20, y20
    return Weights(vertices, front, perspective, n, area, sides, inverse_w, primitives.z[vertices])


def _cut_24(values):
    """Float64 cut to 24 significant bits."""
    return (np.ascontiguousarray(values).view(np.int64) & -(1 << 29)).view(np.float64)


def _machine_weights(e, total):
    """q0 and q2 of docs/numbers.md, section 4: float64 [k, 2]."""
    q = _cut_24(e * _cut_24(1.0 / total))
    c0, c1, c2 = ((q >= 0.5).astype(np.int64) + (q >= 0.25)).T
    q0, q1, q2 = q.T
    first = (c0 > c2) & (c0 >= c1)
    last = ~first & ~((c1 > c0) & (c1 >= c2))
    return np.stack([np.where(first, (1.0 - q1) - q2, q0), np.where(last, (1.0 - q0) - q1, q2)], axis=1)


def iterate(weights, values):
    """Values [k, 3, ...] at a triangle's vertices, weighted by ``weights`` [k, 3] that sum to one."""
    shape = (-1,) + (1,) * (values.ndim - 2)
    w0, w2 = weights[:, 0].reshape(shape), weights[:, 2].reshape(shape)
    total, other = values[:, 0] - values[:, 1], values[:, 2] - values[:, 1]
    total *= w0
    total += values[:, 1]
    other *= w2
    total += other
    return total


def _iterate_as_machines(weights, corners):
    """S, t, r, q by docs/numbers.md, section 6, and the unit to which their terms are cut: float64 [k, 4]."""
    v0, v1, v2 = (corners[:, k] for k in range(3))
    q0, q2 = (weights.machine[:, k, None] for k in range(2))
    terms = np.stack([v1, q0 * (v0 - v1), q2 * (v2 - v1)])
    unit = np.ldexp(1.0, np.frexp(np.maximum(np.abs(terms).max(axis=0), 2.0**-100))[1] - 24)
    return (np.trunc(terms / unit) * unit).sum(axis=0), unit


def _change(step, values):
    """A derivative of an iterated value: ``step`` [k, 3] sums to zero."""
    return step[:, :1] * (values[:, 0] - values[:, 1]) + step[:, 2:] * (values[:, 2] - values[:, 1])


# --------------------------------------------------------------------------------------------- textures


@dataclass(frozen=True, eq=False)
class TextureCoordinates:
    """Where fragments read a texture image.

    position  float64 [k, 2], or [k, 3] in a volume, 1.0 = the whole image; the others that follow likewise
    face      int64 [k], 0 unless a cube map
    slip      float64 [k, 2], by how much the machines' coordinates lie beside ``position``, their bias aside
    bias      float64 [k, 1], texels that the machines add to coordinates that they divided: tau or 0
    dx, dy    float64 [k, 2], derivatives of ``position`` per pixel
    """

    position: np.ndarray
    face: np.ndarray
    slip: np.ndarray
    bias: np.ndarray
    dx: np.ndarray
    dy: np.ndarray


def place(target, weights, corners, nearest=True, changing=True):
    """TextureCoordinates of fragments whose triangles have s, t, r, q ``corners``, float64 [k, 3, 4].

    Not ``nearest``: no nearest filter reads them; slip is 0. Not ``changing``: nothing asks how they change;
    dx and dy are 0. Either is a third of the work.
    """
    strq = iterate(weights.perspective, corners)
    none = np.broadcast_to(0.0, strq.shape)
    dx, dy = (_change(weights.dx, corners), _change(weights.dy, corners)) if changing else (none, none)
    if target is TextureTarget.TEXTURE_CUBE_MAP:
        on_cube = project_on_cube(strq[:, :3], dx[:, :3], dy[:, :3])
        if not nearest:
            return on_cube
        machine, _ = _iterate_as_machines(weights, corners)
        return replace(on_cube, slip=_place_on_face(machine[:, :3], on_cube.face) - on_cube.position)
    q = np.where(strq[:, 3:] == 0.0, 1.0, strq[:, 3:])
    axes = _axes(target)
    position = strq[:, :axes] / q
    divided = (corners[:, :, 3] != 1.0).any(axis=1)[:, None]
    slip = none[:, :axes]
    if nearest:
        machine, unit = _iterate_as_machines(weights, corners)
        slip = machine[:, :axes] / np.where(machine[:, 3:] == 0.0, 1.0, machine[:, 3:]) - position
        # Undivided coordinates lie at least a unit off an exact boundary, or on it but for the noise of
        # float64.
        slip = np.where(~divided & (np.abs(slip) < unit[:, :axes] / 2), 0.0, slip)
    return TextureCoordinates(
        position,
        np.zeros(len(position), np.int64),
        slip,
        np.where(divided, _TAU, 0.0),
        (dx[:, :axes] - position * dx[:, 3:]) / q if changing else none[:, :axes],
        (dy[:, :axes] - position * dy[:, 3:]) / q if changing else none[:, :axes],
    )


def _axes(target):
    """How many texture coordinates place a texel of an image that is no cube map's."""
    return 3 if target is TextureTarget.TEXTURE_3D else 2


def _on_face(vector, face):
    """Sc and tc, float64 [k, 2], of vectors [k, 3] on their faces [k]."""
    rows = np.arange(len(vector))
    sc, tc = vector[rows, _SC_COMPONENT[face]], vector[rows, _TC_COMPONENT[face]]
    return np.stack([_SC_SIGN[face] * sc, _TC_SIGN[face] * tc], axis=1)


def _place_on_face(direction, face):
    """Places, float64 [k, 2], of directions [k, 3] on given faces; 0 where the major axis is.

    Source: EXT_texture_cube_map, section 3.8.6; docs/numbers.md, section 6 (the 0).
    """
    magnitude = np.abs(direction[np.arange(len(direction)), face // 2])[:, None]
    ratio = _on_face(direction, face) / np.where(magnitude == 0.0, 1.0, magnitude)
    return np.where(magnitude == 0.0, 0.0, (ratio + 1.0) * 0.5)


def project_on_cube(direction, dx, dy):
    """TextureCoordinates of directions [k, 3] with their derivatives: the face of the largest magnitude, x
    before y before z. Source: EXT_texture_cube_map, section 3.8.6.
    """
    rows = np.arange(len(direction))
    axis = np.argmax(np.abs(direction), axis=1)
    major = direction[rows, axis]
    face = 2 * axis + (major < 0.0)
    magnitude = np.where(major == 0.0, 1.0, np.abs(major))[:, None]
    sign = np.where(major < 0.0, -1.0, 1.0)[:, None]

    ratio = _on_face(direction, face) / magnitude

    def derivative(step):
        return 0.5 * (_on_face(step, face) - ratio * sign * step[rows, axis][:, None]) / magnitude

    return TextureCoordinates(
        _place_on_face(direction, face),
        face,
        np.zeros((len(rows), 2)),
        np.full((len(rows), 1), _TAU),
        derivative(dx),
        derivative(dy),
    )


def level_of_detail(coordinates, width, height, lod_bias, depth=1):
    """Lambda, float64 [k], of section 3.8.5 from the true derivatives at each fragment, plus the bias.

    The machine takes one lambda, of 8 fraction bits, per 2x2 block. Not finite: the largest.
    """
    size = np.array([width, height, depth], np.float64)[: coordinates.dx.shape[1]]
    across, down = coordinates.dx * size, coordinates.dy * size
    squared = np.maximum((across**2).sum(axis=1), (down**2).sum(axis=1))
    lod = np.full(len(squared), -np.inf)
    np.log2(squared, out=lod, where=squared > 0.0)
    return np.where(np.isnan(squared), np.inf, 0.5 * lod) + lod_bias


def _along(texel, size, wrap, linear):
    """Indices along an axis, a list of (index, which read the border or None), and the fraction from first to
    second.
    """
    texel = np.where(np.isfinite(texel), texel, 0.0)
    if wrap is WrapMode.REPEAT:
        texel = np.mod(texel, size)
    elif wrap is WrapMode.MIRRORED_REPEAT:
        texel = np.mod(texel, 2.0 * size)
        texel = np.minimum(texel, 2.0 * size - texel)
    elif wrap is WrapMode.CLAMP:
        texel = np.clip(texel, 0.0, size)
    elif wrap is WrapMode.CLAMP_TO_EDGE:
        texel = np.clip(texel, 0.5, size - 0.5)
    elif wrap is WrapMode.CLAMP_TO_BORDER:
        texel = np.clip(texel, -0.5, size + 0.5)
    else:
        raise ValueError(f"The ideal machine has no wrap mode {wrap.name}.")
    below = np.floor(texel - 0.5) if linear else np.floor(texel)
    first = below.astype(np.int64)
    bordered = wrap is WrapMode.CLAMP_TO_BORDER or (wrap is WrapMode.CLAMP and linear)
    indices = []
    for index in (first, first + 1) if linear else (first,):
        outside = (index < 0) | (index >= size) if bordered else None
        inside = np.mod(index, size) if wrap is WrapMode.REPEAT else np.clip(index, 0, size - 1)
        indices.append((inside, outside))
    return indices, texel - 0.5 - below


def sample_level(level, coordinates, sampler, border, linear, one_dimensional, read=None, tap=None):
    """One level, float64 [faces, h, w, 4], filtered at ``coordinates`` with real fractions: float64 [k, 4].

    ``border`` float64 [4]; ``read``: what becomes of texels [k, 4] before they are filtered. ``tap``: one
    texel of the filter, 0 or 1 of layers, rows and columns, float64 [k, 7] with the fractions between
    columns, rows and layers.
    Source: OpenGL 1.2.1 sections 3.8.4 to 3.8.6; docs/numbers.md, section 6.
    """
    layers, height, width = level.shape[:3]
    volume = coordinates.position.shape[1] == 3
    size = np.array([width, height, layers] if volume else [width, height], np.float64)
    texels = coordinates.position * size
    if not linear:
        slip = coordinates.slip * size + coordinates.bias
        texels = texels + np.where(slip >= 0.0, _TAU, -_TAU)
    columns, across = _along(texels[:, 0], width, sampler.wrap_s, linear)
    if one_dimensional:
        rows, up = [(np.zeros(len(texels), np.int64), None)], None
    else:
        rows, up = _along(texels[:, 1], height, sampler.wrap_t, linear)

    planes, deep = [(coordinates.face, None)], None
    if volume:
        planes, deep = _along(texels[:, 2], layers, sampler.wrap_r, linear)

    def texel(plane, row, column):
        found = level[plane[0], row[0], column[0]]
        found = found if read is None else read(found)
        for outside in (plane[1], row[1], column[1]):
            if outside is not None:
                found[outside] = border
        return found

    if tap is not None:
        axes = zip((planes, rows, columns), tap, strict=True)
        fractions = [np.zeros(len(texels)) if f is None else f for f in (across, up, deep)]
        wanted = [some[min(side, len(some) - 1)] for some, side in axes]
        return np.concatenate([texel(*wanted), np.stack(fractions, axis=1)], axis=1)

    def filtered_row(plane, row):
        taps = [texel(plane, row, column) for column in columns]
        return taps[0] if len(taps) == 1 else taps[0] + (taps[1] - taps[0]) * across[:, None]

    def filtered_plane(plane):
        lines = [filtered_row(plane, row) for row in rows]
        return lines[0] if len(lines) == 1 else lines[0] + (lines[1] - lines[0]) * up[:, None]

    parts = [filtered_plane(plane) for plane in planes]
    return parts[0] if len(parts) == 1 else parts[0] + (parts[1] - parts[0]) * deep[:, None]


def _select(coordinates, chosen):
    return TextureCoordinates(
        *(getattr(coordinates, name)[chosen] for name in ("position", "face", "slip", "bias", "dx", "dy"))
    )


def _reference(strq):
    """What depth texels are compared with: r over q, float64 [k]."""
    return strq[:, 2] / np.where(strq[:, 3] == 0.0, 1.0, strq[:, 3])


def _comparison(sampler, reference):
    """What makes depth texels [k, 4] of a comparison with ``reference`` [k], before any filter: 1 or the
    value of what fails, in the components that DEPTH_TEXTURE_MODE names.

    Source: ARB_shadow (the reference's clamp), SGIX_shadow_ambient, ARB_depth_texture.
    """
    base, reference = depth_texture_mode(sampler, IDEAL), np.clip(reference, 0.0, 1.0)

    def compared(texels):
        holds = compare(sampler.compare_function, reference, texels[:, 0])
        value = np.where(holds, 1.0, float(sampler.compare_fail_value))
        return register_components(value[:, None], base, 1.0)

    return compared


def _assembled(texture, unit, coordinates, reference):
    """The mean of the probes along each fragment's footprint (docs/numbers.md, section 7), from its own true
    derivatives.
    """
    size = np.array([texture.width, texture.height], np.float64)
    if texture.target is TextureTarget.TEXTURE_RECTANGLE:
        size[:] = 1.0
    squares = ((np.stack([coordinates.dx, coordinates.dy]) * size) ** 2).sum(axis=2)
    squares = np.where(np.isfinite(squares), squares, 0.0)
    longer, shorter = squares.max(axis=0), squares.min(axis=0)
    probes, narrow = np.ones(len(longer)), np.maximum(shorter, 1.0)
    for _ in range(unit.sampler.max_probes.bit_length() - 1):
        probes = np.where(longer >= 2.0 * probes**2 * narrow, 2.0 * probes, probes)
    rho2 = np.maximum(shorter, np.minimum(longer, 1.0))
    rho2 = np.where(longer >= 2.0 * probes**2 * narrow, longer / probes**2, rho2)
    step = np.where((squares[0] >= squares[1])[:, None], coordinates.dx, coordinates.dy)
    # What lambda asks for: a square as large as a probe's.
    side = np.zeros_like(coordinates.dx)
    side[:, 0] = np.sqrt(rho2) / size[0]
    total, one = np.zeros((len(probes), 4)), replace(unit, sampler=replace(unit.sampler, max_probes=1))
    for probe in range(int(probes.max(initial=1.0))):
        used = probe < probes
        distance = ((2 * probe + 1) - probes) / (2.0 * probes)
        moved = replace(
            coordinates,
            position=coordinates.position + distance[:, None] * step,
            dx=side,
            dy=np.zeros_like(side),
        )
        part = None if reference is None else reference[used]
        total[used] += sample(texture, one, _select(moved, used), part) / probes[used, None]
    return total


def _signed_reader(sampler, bits):
    """What makes texels [..., 4] of a sampler's signed components numbers of both signs; None: has none."""
    flags, one = np.array(signed_flags(sampler)), 2.0**bits - 1.0
    if not flags.any():
        return None
    return lambda texels: np.where(flags, signed(texels * one, bits) / one, texels)


def as_register(texel, unit):
    """What a unit's register receives of its texel [k, 4]: of signed components twice the byte.

    Measured: 732800 of 732800 pixels (Texture_signed_component_tests captures).
    """
    texel = looked_up(texel, unit.color_table, IDEAL)
    flags = signed_flags(unit.sampler)
    return texel * np.where(flags, 2.0, 1.0) if any(flags) else texel


def sample(texture, unit, coordinates, reference=None, tap=None):
    """A unit's texel, float64 [k, 4], from ``texture.ideal`` with a real lambda.

    ``reference`` float64 [k]: what depth texels are compared with; ``tap``: as ``sample_level``'s, of a
    sampler whose filters are equal.
    """
    sampler = unit.sampler
    if sampler.max_probes > 1:
        return _assembled(texture, unit, coordinates, reference)
    if texture.target is TextureTarget.TEXTURE_CUBE_MAP:
        sampler = replace(sampler, wrap_s=WrapMode.CLAMP_TO_EDGE, wrap_t=WrapMode.CLAMP_TO_EDGE)
    one_dimensional = texture.target is TextureTarget.TEXTURE_1D
    # The border colour passes through the base format like a texel.  Source: OpenGL 1.2.1, section 3.8.4.
    border, levels, read_signed = np.zeros(4), texture.ideal, _signed_reader(sampler, texture.bits)
    if reference is None:
        base = BASE_FORMAT[texture.internal_format]
        border = register_components(np.array(sampler.border_color, np.float64)[list(KEPT[base])], base, 1.0)
        border = border if read_signed is None else read_signed(border)

    def at_level(level, chosen, linear):
        where = _select(coordinates, chosen)
        read = read_signed if reference is None else _comparison(sampler, reference[chosen])
        return sample_level(levels[level], where, sampler, border, linear, one_dimensional, read, tap)

    levels = levels[: sampler.max_level + 1]

    out = np.zeros((len(coordinates.face), 4))
    if sampler.min_filter is sampler.mag_filter:
        minified = np.zeros(len(out), bool)
    else:
        if one_dimensional:
            s_alone = np.array([1.0, 0.0])
            coordinates = replace(coordinates, dx=coordinates.dx * s_alone, dy=coordinates.dy * s_alone)
        lod = level_of_detail(coordinates, texture.width, texture.height, unit.lod_bias, texture.depth)
        lod = np.clip(lod, sampler.min_lod, sampler.max_lod)
        minified = lod > 0.0
    if not minified.any():
        return at_level(0, slice(None), sampler.mag_filter is TextureFilter.LINEAR)
    magnified = ~minified
    out[magnified] = at_level(0, magnified, sampler.mag_filter is TextureFilter.LINEAR)
    if sampler.min_filter not in _MIPMAPPED:
        out[minified] = at_level(0, minified, sampler.min_filter is TextureFilter.LINEAR)
        return out
    linear, between = _MIPMAPPED[sampler.min_filter]
    last = len(levels) - 1
    lod = np.clip(np.where(minified, lod, 0.0), 0.0, last)
    if between:
        lower = np.floor(lod)
        share = lod - lower
    else:
        # Source: OpenGL 1.2.1 section 3.8.5, equation 3.19.
        lower, share = np.ceil(lod + 0.5) - 1.0, np.zeros(len(lod))
    lower = np.minimum(lower.astype(np.int64), last)
    upper = np.minimum(lower + 1, last)
    for level in range(last + 1):
        weight = np.where(lower == level, 1.0 - share, 0.0) + np.where(upper == level, share, 0.0)
        chosen = minified & (weight > 0.0)
        if chosen.any():
            out[chosen] += weight[chosen, None] * at_level(level, chosen, linear)
    return out


# ------------------------------------------------------------------------------------------- combiners


def mapped(mapping, x):
    """An input mapping in real numbers. Source: NV_register_combiners, table 4.

    The mappings called unsigned yield nothing negative; none of the others has an upper clamp.
    """
    if mapping is Mapping.SIGNED_IDENTITY:
        return x
    if mapping is Mapping.SIGNED_NEGATE:
        return -x
    x = np.maximum(0.0, x)
    return {
        Mapping.UNSIGNED_IDENTITY: lambda: x,
        Mapping.UNSIGNED_INVERT: lambda: np.maximum(0.0, 1.0 - x),
        Mapping.EXPAND_NORMAL: lambda: 2.0 * x - 1.0,
        Mapping.EXPAND_NEGATE: lambda: 1.0 - 2.0 * x,
        Mapping.HALF_BIAS_NORMAL: lambda: x - 0.5,
        Mapping.HALF_BIAS_NEGATE: lambda: 0.5 - x,
    }[mapping]()


def _variable(variable, registers, alpha):
    """A combiner variable's value: [k, 3] in an RGB portion, [k, 1] in an alpha portion."""
    register = registers[variable.register]
    if variable.usage is ComponentUsage.RGB:
        value = register[:, :3]
    elif variable.usage is ComponentUsage.ALPHA:
        value = register[:, 3:]
    elif variable.usage is ComponentUsage.BLUE:
        value = register[:, 2:3]
    else:
        raise ValueError(f"The ideal machine has no component usage {variable.usage.name}.")
    # What all fragments or components share is mapped once.
    shared = value.strides[0] == 0
    result = mapped(variable.mapping, value[:1] if shared else value)
    return np.broadcast_to(result, (len(value), 1 if alpha else 3))


def _function(function, ab, cd):
    """What the future board puts in the place of AB + CD; n / 0 is as far as its registers reach.

    Source: docs/numbers.md, section 20.
    """
    if function is CombinerFunction.SQUARE_ROOT:
        return np.sqrt(np.maximum(ab + cd, 0.0))
    if function is CombinerFunction.EXPONENTIAL:
        return np.exp(np.minimum(ab + cd, _LARGEST_EXPONENT))
    if function is CombinerFunction.DIVIDE:
        return np.where(cd == 0.0, np.sign(ab) * _FARTHEST, ab / np.where(cd == 0.0, 1.0, cd))
    raise ValueError(f"The ideal machine has no combiner function {function.name}.")


def _portion(portion, registers, alpha):
    """The three outputs of a portion, as (register, value) pairs; discarded ones left out."""
    if portion.ab_output is portion.cd_output is portion.sum_output is Register.DISCARD:
        return []
    a, b, c, d = (_variable(v, registers, alpha) for v in (portion.a, portion.b, portion.c, portion.d))
    ab, cd = a * b, c * d
    if not alpha and portion.ab_dot_product:
        ab = np.broadcast_to(ab.sum(axis=1, keepdims=True), ab.shape)
    if not alpha and portion.cd_dot_product:
        cd = np.broadcast_to(cd.sum(axis=1, keepdims=True), cd.shape)
    # Source: NV_register_combiners, section 3.8.12.2: CD where SPARE0's alpha is 1/2 or more.
    total = np.where(registers[Register.SPARE0][:, 3:] >= 0.5, cd, ab) if portion.mux_sum else ab + cd
    if portion.function is not CombinerFunction.NONE:
        total = _function(portion.function, ab, cd)
    bias = -0.5 if portion.bias is CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF else 0.0
    outputs = ((portion.ab_output, ab), (portion.cd_output, cd), (portion.sum_output, total))
    scale = _SCALE[portion.scale]
    return [(to, (value + bias) * scale) for to, value in outputs if to is not Register.DISCARD]


def _constant(color, count):
    return np.broadcast_to(np.array(color, np.float64), (count, 4))


def combine(combiners, registers, look_up=None):
    """General combiners and final combiner: float64 [k, 4], clamped to [0, 1] at the very end.

    ``registers``: Register to float64 [k, 4], everything but the constants and ZERO. AB's blue goes to alpha
    where a texture environment's dot product asks for it; users' flags are the NV2A's. Nothing is clamped
    between the stages; the final combiner's A, being the weight of a blend, stays in [0, 1].
    ``look_up(lookup, registers)``: the texel of a stage's CombinerLookup.
    """
    count = len(registers[Register.PRIMARY_COLOR])
    registers = dict(registers)
    registers[Register.ZERO] = _constant((0.0,) * 4, count)
    program = {
        Register.CONSTANT_COLOR0: _constant(combiners.constant_color0, count),
        Register.CONSTANT_COLOR1: _constant(combiners.constant_color1, count),
    }
    for stage in combiners.general:
        registers.update(program)
        if stage.constant_color0 is not None:
            registers[Register.CONSTANT_COLOR0] = _constant(stage.constant_color0, count)
        if stage.constant_color1 is not None:
            registers[Register.CONSTANT_COLOR1] = _constant(stage.constant_color1, count)
        rgb, alpha = _portion(stage.rgb, registers, False), _portion(stage.alpha, registers, True)
        copied = stage.rgb.ab_output if stage.rgb.ab_blue_to_alpha else None
        for to, value in rgb:
            own = value[:, 2:] if to is copied else registers[to][:, 3:]
            registers[to] = np.concatenate([value, own], axis=1)
        for to, value in alpha:
            registers[to] = np.concatenate([registers[to][:, :3], value], axis=1)
        if stage.lookup is not None:
            registers[Register.TEXTURE0 + stage.lookup.unit] = look_up(stage.lookup, registers)
    registers.update(program)
    return _final(combiners.final, registers, count)


def _final(final, registers, count):
    nothing = np.zeros((count, 1))
    product = _variable(final.e, registers, False) * _variable(final.f, registers, False)
    total = np.maximum(0.0, registers[Register.SPARE0][:, :3]) + np.maximum(
        0.0, registers[Register.SECONDARY_COLOR][:, :3]
    )
    registers[Register.E_TIMES_F] = np.concatenate([product, nothing], axis=1)
    registers[Register.SPARE0_PLUS_SECONDARY_COLOR] = np.concatenate([total, nothing], axis=1)
    a, b, c, d = (_variable(v, registers, False) for v in (final.a, final.b, final.c, final.d))
    a = np.minimum(a, 1.0)
    rgb = a * b + (1.0 - a) * c + d
    return np.clip(np.concatenate([rgb, _variable(final.g, registers, True)], axis=1), 0.0, 1.0)


# ------------------------------------------------------------------------------------------------- fog


def fog_factor(fog, coordinate):
    """F of section 3.10, float64, in [0, 1] by its definition; the machine has 256 steps of it."""
    if fog.mode is FogMode.EXP:
        factor = np.exp(-fog.density * coordinate)
    elif fog.mode is FogMode.EXP2:
        factor = np.exp(-((fog.density * coordinate) ** 2))
    elif fog.mode is FogMode.LINEAR:
        factor = (fog.end - coordinate) / (fog.end - fog.start)
    else:
        raise ValueError(f"The ideal machine has no fog mode {fog.mode.name}.")
    return np.clip(factor, 0.0, 1.0)


def _without_combiners(state, primary, secondary, fog):
    """Color sum (section 3.9) and fog (section 3.10): float64 [k, 4], clamped to [0, 1] at the end only."""
    rgb = primary[:, :3]
    if has_color_sum(state):
        rgb = rgb + secondary[:, :3]
    if state.fog is not None:
        rgb = fog[:, 3:] * rgb + (1.0 - fog[:, 3:]) * fog[:, :3]
    return np.clip(np.concatenate([rgb, primary[:, 3:]], axis=1), 0.0, 1.0)


# --------------------------------------------------------------------------------- a fragment's colour


def shade(state, textures, primitives, triangle, weights):
    """Colours of fragments before the per-fragment operations, float64 [k, 4] in [0, 1], and the Outcome of a
    texture shader, or None.

    ``textures``: name to Texture with ideal levels. ``triangle`` int [k]; ``weights``: those of ``weigh``.
    """
    side = (~weights.front & primitives.two_side).astype(np.int64)
    if state.polygon.shade_model is ShadeModel.FLAT:
        colors = primitives.colors[primitives.triangles[triangle, 3], side]
    else:
        corners = primitives.colors[weights.vertices, side[:, None]]
        colors = iterate(weights.perspective, corners)
        for first, asked in ((0, state.spherical_primary_color), (4, state.spherical_secondary_color)):
            if asked:  # as EXPAND_NORMAL reads them
                turned = spherical(weights.perspective, 2.0 * corners[:, :, first : first + 3] - 1.0)
                colors[:, first : first + 3] = (turned + 1.0) / 2.0
    distances = None
    if state.fog is not None:
        distances = iterate(weights.perspective, primitives.fog[weights.vertices])

    def own(i):
        corners = primitives.coordinates[weights.vertices, i]
        strq = iterate(weights.perspective, corners)
        if state.texture_units[i].spherical_coordinates:
            strq[:, :3] = spherical(weights.perspective, corners[:, :, :3])
        return strq

    def texel(i, unit, texture, tap=None):
        filters = unit.sampler.min_filter, unit.sampler.mag_filter
        coordinates = place(
            texture.target,
            weights,
            primitives.coordinates[weights.vertices, i],
            nearest=filters != (TextureFilter.LINEAR, TextureFilter.LINEAR),
            changing=filters[0] is not filters[1] or unit.sampler.max_probes > 1,
        )
        if unit.spherical_coordinates:
            corners = primitives.coordinates[weights.vertices, i]
            coordinates = replace(coordinates, **_turned_place(texture.target, weights, corners))
        reference = None
        if unit.sampler.compare_mode is not TextureCompareMode.NONE:
            reference = _reference(iterate(weights.perspective, primitives.coordinates[weights.vertices, i]))
        return sample(texture, unit, coordinates, reference, tap)

    given = state, textures, colors[:, :4], colors[:, 4:], distances
    if state.texture_shader is not None:
        outcome = run_stages(state, textures, len(colors), own, texel, _sample_made, as_register)
        return shade_colors(*given, lambda i, unit, texture: outcome.registers[i]), outcome
    if state.evaluate_before_filtering:
        return _before_filtering(*given, texel), None
    return shade_colors(*given, texel), None


def _turned_place(target, weights, corners):
    """Where unit vectors that turn steadily read a texture: what changes of a TextureCoordinates."""
    turned = spherical(weights.perspective, corners[:, :, :3])
    none = np.zeros((len(turned), 3))
    if target is TextureTarget.TEXTURE_CUBE_MAP:
        on_cube = project_on_cube(turned, none, none)
        return {"position": on_cube.position, "face": on_cube.face, "slip": on_cube.slip}
    axes = 3 if target is TextureTarget.TEXTURE_3D else 2
    return {"position": turned[:, :axes], "slip": none[:, :axes]}


def spherical(weights, corners):
    """Unit vectors [k, 3] between those of corners [k, 3, 3]: the arc from vertex 0 to 1, then from there to
    2. Source: docs/numbers.md, section 20; Shoemake 1985.
    """
    v0, v1, v2 = (corners[:, i] / np.linalg.norm(corners[:, i], axis=1, keepdims=True) for i in range(3))
    edge = _arc(v0, v1, weights[:, 1] / np.maximum(weights[:, 0] + weights[:, 1], _TAU))
    return _arc(edge, v2, weights[:, 2])


def _arc(a, b, t):
    angle = np.arccos(np.clip((a * b).sum(axis=1), -1.0, 1.0))
    sine = np.sin(angle)
    straight = sine < _TAU
    divisor = np.where(straight, 1.0, sine)
    first = np.where(straight, 1.0 - t, np.sin((1.0 - t) * angle) / divisor)
    second = np.where(straight, t, np.sin(t * angle) / divisor)
    return first[:, None] * a + second[:, None] * b


def _before_filtering(state, textures, primary, secondary, distances, texel):
    """Colours at each texel of unit 0's filter, filtered: docs/numbers.md, section 20."""
    along, fractions = units_along(state, textures), []

    def color(*tap):
        def one(i, unit, texture):
            if i not in along:
                return texel(i, unit, texture)
            found = texel(i, unit, texture, tap)
            if i == 0:
                fractions[:] = found[:, 4:].T
            return found[:, :4]

        return shade_colors(state, textures, primary, secondary, distances, one)

    planes = []
    for k in (0, 1):
        rows = []
        for j in (0, 1):
            first, second = color(k, j, 0), color(k, j, 1)
            rows.append(first + (second - first) * fractions[0][:, None])
        planes.append(rows[0] + (rows[1] - rows[0]) * fractions[1][:, None])
    return planes[0] + (planes[1] - planes[0]) * fractions[2][:, None]


def shade_colors(state, textures, primary, secondary, distances, texel):
    """``shade`` from iterated values: colours float64 [k, 4], fog coordinates [k] (None: no fog), and
    ``texel(number, unit, texture)``, an enabled texture unit's texel: with a texture shader, its register.
    """
    count = len(primary)
    fog = np.zeros((count, 4))
    fog[:, 3] = 1.0
    if state.fog is not None:
        fog[:, :3] = state.fog.color[:3]
        fog[:, 3] = fog_factor(state.fog, distances)
    program = state.register_combiners
    if program is None:
        program = environment_program(state, textures, IDEAL, has_color_sum(state))
    if program is None:
        return _without_combiners(state, primary, secondary, fog)
    registers = {
        Register.FOG: fog,
        Register.PRIMARY_COLOR: primary,
        Register.SECONDARY_COLOR: secondary,
        Register.SPARE1: np.zeros((count, 4)),
    }
    # A disabled unit's register is opaque black.  Source: docs/numbers.md, section 7.
    for i in range(4):
        unit = state.texture_units[i] if i < len(state.texture_units) else None
        if unit is None:
            registers[Register.TEXTURE0 + i] = _constant((0.0, 0.0, 0.0, 1.0), count)
            continue
        found = texel(i, unit, textures.get(unit.texture))
        if state.texture_shader is None:
            found = as_register(found, unit)
        registers[Register.TEXTURE0 + i] = found
    registers[Register.SPARE0] = np.zeros((count, 4))
    registers[Register.SPARE0][:, 3] = registers[Register.TEXTURE0][:, 3]

    def look_up(lookup, registers):
        unit, rgb = state.texture_units[lookup.unit], registers[lookup.register][:, :3]
        level_0 = replace(unit.sampler, min_filter=unit.sampler.mag_filter)
        compared = unit.sampler.compare_mode is not TextureCompareMode.NONE
        made = sample(
            textures[unit.texture],
            replace(unit, sampler=level_0),
            made_place(textures[unit.texture], rgb),
            rgb[:, 2] if compared else None,
        )
        return as_register(made, unit)

    return combine(program, registers, look_up)


def made_place(texture, str_, lifted=True):
    """TextureCoordinates that were computed, [k, 3]: with the machines' lift."""
    none = np.zeros_like(str_)
    if texture.target is TextureTarget.TEXTURE_CUBE_MAP:
        return project_on_cube(str_, none, none)
    axes = 3 if texture.target is TextureTarget.TEXTURE_3D else 2
    few, lift = none[:, :axes], np.full((len(str_), 1), _TAU if lifted else 0.0)
    return TextureCoordinates(str_[:, :axes], np.zeros(len(str_), np.int64), few, lift, few, few)


def _sample_made(i, unit, texture, str_, r, lifted):
    """Unit i's texel at coordinates [k, 3] that its texture shader stage made; ``r``: what is compared."""
    compares = unit.sampler.compare_mode is not TextureCompareMode.NONE
    return sample(texture, unit, made_place(texture, str_, lifted), r if compares else None)


# ----------------------------------------------------------------------------- per-fragment operations


def compare(function, a, b):
    """``a FUNC b``, bool, elementwise (section 4.1)."""
    return {
        ComparisonFunction.NEVER: lambda: np.zeros(np.broadcast(a, b).shape, bool),
        ComparisonFunction.LESS: lambda: a < b,
        ComparisonFunction.EQUAL: lambda: a == b,
        ComparisonFunction.LEQUAL: lambda: a <= b,
        ComparisonFunction.GREATER: lambda: a > b,
        ComparisonFunction.NOTEQUAL: lambda: a != b,
        ComparisonFunction.GEQUAL: lambda: a >= b,
        ComparisonFunction.ALWAYS: lambda: np.ones(np.broadcast(a, b).shape, bool),
    }[function]()


def _stencil_operation(operation, stored, reference):
    return {
        StencilOperation.KEEP: lambda: stored,
        StencilOperation.ZERO: lambda: np.zeros_like(stored),
        StencilOperation.REPLACE: lambda: np.full_like(stored, reference),
        StencilOperation.INCR: lambda: np.minimum(stored + 1, 255),
        StencilOperation.DECR: lambda: np.maximum(stored - 1, 0),
        StencilOperation.INVERT: lambda: 255 - stored,
        StencilOperation.INCR_WRAP: lambda: (stored + 1) & 255,
        StencilOperation.DECR_WRAP: lambda: (stored - 1) & 255,
    }[operation]()


def blend_factor(factor, source, destination, constant):
    """A factor of tables 4.1 and 4.2, float64 broadcastable to [k, 4], of unclamped colours."""
    one = np.ones((1, 4))

    def saturate():
        room = np.minimum(source[:, 3:], 1.0 - destination[:, 3:])
        return np.concatenate([room, room, room, np.ones_like(room)], axis=1)

    return {
        BlendFactor.ZERO: lambda: 0.0 * one,
        BlendFactor.ONE: lambda: one,
        BlendFactor.SRC_COLOR: lambda: source,
        BlendFactor.ONE_MINUS_SRC_COLOR: lambda: 1.0 - source,
        BlendFactor.DST_COLOR: lambda: destination,
        BlendFactor.ONE_MINUS_DST_COLOR: lambda: 1.0 - destination,
        BlendFactor.SRC_ALPHA: lambda: source[:, 3:],
        BlendFactor.ONE_MINUS_SRC_ALPHA: lambda: 1.0 - source[:, 3:],
        BlendFactor.DST_ALPHA: lambda: destination[:, 3:],
        BlendFactor.ONE_MINUS_DST_ALPHA: lambda: 1.0 - destination[:, 3:],
        BlendFactor.SRC_ALPHA_SATURATE: saturate,
        BlendFactor.CONSTANT_COLOR: lambda: constant,
        BlendFactor.ONE_MINUS_CONSTANT_COLOR: lambda: 1.0 - constant,
        BlendFactor.CONSTANT_ALPHA: lambda: constant[3:],
        BlendFactor.ONE_MINUS_CONSTANT_ALPHA: lambda: 1.0 - constant[3:],
    }[factor]()


def blend(blending, source, destination):
    """Section 4.1.6 on float64 [k, 4] colours, without a clamp of the result."""
    if blending.equation is BlendEquation.MIN:
        return np.minimum(source, destination)
    if blending.equation is BlendEquation.MAX:
        return np.maximum(source, destination)
    constant = np.array(blending.color, np.float64)
    s = source * blend_factor(blending.source, source, destination, constant)
    d = destination * blend_factor(blending.destination, source, destination, constant)
    if blending.equation is BlendEquation.FUNC_ADD:
        return s + d
    if blending.equation is BlendEquation.FUNC_SUBTRACT:
        return s - d
    if blending.equation is BlendEquation.FUNC_REVERSE_SUBTRACT:
        return d - s
    raise ValueError(f"The ideal machine has no blend equation {blending.equation.name}.")


def apply_logic_operation(operation, source, destination):
    """Table 4.3 on the bytes nearest to the colours: bits have no meaning in the real numbers."""
    s, d = to_bytes(source), to_bytes(destination)
    out = np.zeros_like(s)
    for bit, minterm in enumerate((s & d, s & ~d, ~s & d, ~s & ~d)):
        if operation >> bit & 1:
            out |= minterm
    return out / 255.0


class _Buffers:
    """The framebuffer while a frame runs: top row first; fragments address it by flat index."""

    def __init__(self, width, height):
        # The machine's framebuffer starts the same way.
        self.color = np.zeros((height, width, 4))
        self.depth = np.ones((height, width))
        self.stencil = np.zeros((height, width), np.uint8)
        self.accumulation = np.zeros((height, width, 4))
        self._auxiliary = {}

    def buffer(self, which):
        """What a ColorBuffer stands for: these buffers, or others with the same depths and stencil values."""
        if which is ColorBuffer.BACK:
            return self
        if which not in self._auxiliary:
            self._auxiliary[which] = copy(self)
            self._auxiliary[which].color = np.zeros_like(self.color)
        return self._auxiliary[which]

    def box_of(self, command):
        """X, y, width, height of a CopyTexImage or ReadPixels; None: as far as the framebuffer reaches."""
        height, width = self.depth.shape
        return (
            command.x,
            command.y,
            width - command.x if command.width is None else command.width,
            height - command.y if command.height is None else command.height,
        )

    def rows(self, plane, x, y, width, height):
        """A window rectangle (y up) of a buffer, bottom row first; a view."""
        return plane[::-1][y : y + height, x : x + width]


def _write_color(state, buffers, pixel, source):
    """Blending or logic operation, then the color mask; each pixel occurs once."""
    color = buffers.color.reshape(-1, 4)
    destination = color[pixel]
    if state.logic_op is not None:
        source = apply_logic_operation(state.logic_op, source, destination)
    elif state.blending is not None:
        source = blend(state.blending, source, destination)
    color[pixel] = np.where(_mask(state.color_mask), source, destination)


def _mask(color_mask):
    return np.array([color_mask.red, color_mask.green, color_mask.blue, color_mask.alpha])


def _test_and_write(state, buffers, pixel, source, z):
    """Alpha, stencil and depth test on reals, then the writes; each pixel occurs once."""
    if state.alpha_test is not None:
        keep = compare(state.alpha_test.function, source[:, 3], state.alpha_test.reference)
        pixel, source, z = pixel[keep], source[keep], z[keep]
    depth = buffers.depth.reshape(-1)
    closer = np.ones(len(pixel), bool)
    if state.depth_test is not None:
        closer = compare(state.depth_test.function, z, depth[pixel])
    passed = closer
    test = state.stencil_test
    if test is not None:
        stencil = buffers.stencil.reshape(-1)
        stored = stencil[pixel].astype(np.int64)
        reference = min(max(test.reference, 0), 255)
        agreed = compare(test.function, np.int64(reference & test.mask), stored & test.mask)
        new = np.where(
            agreed,
            np.where(
                closer,
                _stencil_operation(test.depth_pass, stored, reference),
                _stencil_operation(test.depth_fail, stored, reference),
            ),
            _stencil_operation(test.fail, stored, reference),
        )
        stencil[pixel] = (stored & ~test.write_mask) | (new & test.write_mask)
        passed = agreed & closer
    _write(state, buffers, pixel[passed], source[passed], z[passed])


def _writes_depth(state):
    return state.depth_test is not None and state.depth_test.write


def _write(state, buffers, pixel, source, z):
    """What fragments that passed leave: depths, which a copy may read, and colours."""
    if _writes_depth(state):
        buffers.depth.reshape(-1)[pixel] = z
    _write_color(state, buffers, pixel, source)


# -------------------------------------------------------------------------------------------- commands


def _draw(command, buffers, textures, width, height, depth_bits, record, threads):
    state = command.state
    primitives = process(command.mesh, state, IDEAL, width, height)
    if record is None:
        # Coverage has no use for colours, and its kernels take bytes.
        uncolored = replace(primitives, colors=np.zeros(primitives.colors.shape, np.uint8))
        fragments = rasterize(uncolored, state.polygon, state.scissor, width, height)
        triangle, x, y = fragments.triangle, fragments.x, fragments.y
    else:
        passed = np.asarray(record.passed, bool)
        triangle, x, y = record.triangle[passed], record.x[passed], record.y[passed]
        if len(triangle) and triangle.max() >= len(primitives.triangles):
            raise ValueError(
                f"{command.label}: the guide drew triangle {int(triangle.max())}, but this mesh gives "
                f"{len(primitives.triangles)} triangles; guide a frame by the same meshes in the same views."
            )
    color, z = np.empty((len(triangle), 4)), np.empty(len(triangle))
    alive = np.ones(len(triangle), bool)

    def share(number):
        # Derivatives of projections that blow up are looked at afterwards, as not finite.
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            for start in range(number * _CHUNK, len(triangle), threads.count * _CHUNK):
                part = slice(start, start + _CHUNK)
                weights = weigh(primitives, state.polygon.front_face, triangle[part], x[part], y[part])
                color[part], outcome = shade(state, textures, primitives, triangle[part], weights)
                if record is not None and not _writes_depth(state):
                    continue
                z[part] = _window_depth(state.polygon, primitives, weights, depth_bits)
                if outcome is not None:
                    alive[part] = outcome.alive if record is None else True
                    z[part] = z[part] if outcome.depth is None else outcome.depth
        return 0

    if len(triangle) <= _CHUNK:
        share(0)  # waking the others costs more than a few hundred fragments
    else:
        threads.run(share)
    pixel = y.astype(np.int64) * width + x
    if not alive.all():
        pixel, color, z = pixel[alive], color[alive], z[alive]
    for once in in_order(pixel):
        if record is None:
            _test_and_write(state, buffers, pixel[once], color[once], z[once])
        else:
            _write(state, buffers, pixel[once], color[once], z[once])


def _window_depth(polygon, primitives, weights, depth_bits):
    """Window depth in [0, 1], with an exact polygon offset whose unit is the depth buffer's smallest step."""
    z = iterate(weights.affine, primitives.z[weights.vertices])
    if polygon.offset_fill:
        z = z + polygon.offset_units / (2**depth_bits - 1) + polygon.offset_factor * weights.depth_slope
    return np.clip(z, 0.0, 1.0)


def _scissored(scissor, buffers):
    """X, y, width, height of the scissor box inside the framebuffer."""
    height, width = buffers.depth.shape
    s = scissor
    x0, y0, x1, y1 = (0, 0, width, height) if s is None else (s.x, s.y, s.x + s.width, s.y + s.height)
    x0, y0, x1, y1 = max(x0, 0), max(y0, 0), max(min(x1, width), 0), max(min(y1, height), 0)
    return x0, y0, max(x1 - x0, 0), max(y1 - y0, 0)


def _clear(command, buffers):
    box = _scissored(command.scissor, buffers)
    if command.color is not None:
        buffers.rows(buffers.color, *box)[..., _mask(command.color_mask)] = np.array(command.color)[
            _mask(command.color_mask)
        ]
    if command.depth is not None:
        buffers.rows(buffers.depth, *box)[...] = command.depth
    if command.stencil is not None:
        kept = buffers.rows(buffers.stencil, *box)
        kept[...] = (kept & ~np.uint8(command.stencil_write_mask)) | np.uint8(
            command.stencil & command.stencil_write_mask
        )
    if command.accumulation is not None:
        buffers.rows(buffers.accumulation, *box)[...] = command.accumulation


def _accumulate(command, buffers):
    """Section 4.2.4 without a clamp, not even RETURN's: colours may exceed 1, as after blending."""
    box, value = _scissored(command.scissor, buffers), command.value
    sums = buffers.rows(buffers.accumulation, *box)
    match command.operation:
        case AccumOperation.LOAD | AccumOperation.ACCUM:
            read = value * buffers.rows(buffers.buffer(command.read_buffer).color, *box)
            sums[...] = read if command.operation is AccumOperation.LOAD else sums + read
        case AccumOperation.ADD:
            sums += value
        case AccumOperation.MULT:
            sums *= value
        case AccumOperation.RETURN:
            written, mask = buffers.rows(buffers.buffer(command.draw_buffer).color, *box), command.color_mask
            written[..., _mask(mask)] = (value * sums)[..., _mask(mask)]


def _draw_rectangle(command, buffers, textures, statistics, record):
    """DrawPixels, CopyPixels and Bitmap: the machine's pixels, real colours. ``record``: a guide's."""
    state = without_footprints(command.state)
    found = rectangle(command, buffers, statistics)
    if found is None:
        return
    if found.stencil is not None:
        if record is None:
            stored, test = buffers.stencil.reshape(-1), state.stencil_test
            mask = np.uint8(0xFF if test is None else test.write_mask)
            stored[found.pixel] = (stored[found.pixel] & ~mask) | (found.stencil & mask)
        return
    if record is not None:
        found = found.part(np.asarray(record.passed, bool))

    def texel(i, unit, texture):
        parts = np.empty((len(found.pixel), 4))
        for chosen, image in found.images(texture):
            strq = found.coordinates[chosen, i]
            compares = unit.sampler.compare_mode is not TextureCompareMode.NONE
            reference = _reference(strq) if compares else None
            parts[chosen] = sample(image, unit, _at(strq, image.target), reference)
        if i == 0 and found.texel_alpha is not None:
            parts[:, 3] = found.texel_alpha
        return parts

    color = shade_colors(state, textures, found.primary, found.secondary, found.distances, texel)
    written = buffers.buffer(state.draw_buffer)
    if record is None:
        _test_and_write(state, written, found.pixel, color, found.depth)
    else:
        _write(state, written, found.pixel, color, found.depth)


def _at(strq, target):
    """TextureCoordinates at s, t, r float64 [k, 4] that do not change from pixel to pixel."""
    none = np.zeros((len(strq), 3))
    if target is TextureTarget.TEXTURE_CUBE_MAP:
        return project_on_cube(strq[:, :3], none, none)
    axes, face = _axes(target), np.zeros(len(strq), np.int64)
    none = none[:, :axes]
    return TextureCoordinates(strq[:, :axes], face, none, none[:, :1], none, none)


def _with_ideal(texture):
    if texture.ideal is not None:
        return texture
    one = 2.0**texture.bits - 1.0
    if texture.internal_format in DEPTH_TEXELS:
        most, _ = DEPTH_TEXELS[texture.internal_format]
        words = [np.ascontiguousarray(level).view("<u4") for level in texture.levels]
        return replace(texture, ideal=tuple(np.repeat(w / most, 4, axis=3) for w in words))
    return replace(texture, ideal=tuple(level / one for level in texture.levels))


def _defined(command, buffers, textures, statistics):
    """The texture that a TexImage of pixels or a copy makes; None where a sink took the image."""
    if isinstance(command, TexImage):
        return defined_texture(command, IDEAL, statistics)
    sub_image = isinstance(command, CopyTexSubImage)
    known = textures[command.texture] if sub_image else command
    target, internal_format, box = known.target, known.internal_format, buffers.box_of(command)
    if internal_format in DEPTH_TEXELS:
        depths = transfer_depths(buffers.rows(buffers.depth, *box), command.transfer)
        copied = depth_texture(target, internal_format, depths)
    else:
        dimensions = 1 if target is TextureTarget.TEXTURE_1D else 2
        region = _transferred(buffers.rows(buffers.color, *box), command, statistics, dimensions)
        if region is None:
            return None
        mipmaps = command.generate_mipmap and not sub_image
        copied = texture_2d(region, internal_format, mipmaps=mipmaps)
    return _patched(command, known, copied) if sub_image else replace(copied, target=target)


def _transferred(region, command, statistics, dimensions=2):
    """Colours through a command's pixel transfer; None where a sink took them."""
    if changes_nothing(command.transfer):
        return region
    return transfer_colors(region, command.transfer, IDEAL, statistics, dimensions)


def _patched(command, texture, patch):
    """A texture with one rectangle of one level replaced by another's only level."""
    levels, ideal = list(texture.levels), list(texture.ideal)
    for images, new in ((levels, patch.levels[0]), (ideal, patch.ideal[0])):
        image = images[command.level].copy()
        rows = slice(command.y_offset, command.y_offset + new.shape[1])
        image[command.face, rows, command.x_offset : command.x_offset + new.shape[2]] = new[0]
        image.setflags(write=False)
        images[command.level] = image
        if command.generate_mipmap:
            images[:] = pyramid(image)
    return replace(texture, levels=tuple(levels), ideal=tuple(ideal))


def _read_pixels(command, buffers, guide, statistics):
    box, transfer = buffers.box_of(command), command.transfer
    if command.format == "STENCIL_INDEX":
        if guide:
            return guide.pixels[command.name]
        indices = transfer_stencil(buffers.rows(buffers.stencil, *box).astype(np.int64), transfer)
        return (indices & 0xFF).astype(np.uint8)
    if command.format == "DEPTH_COMPONENT":
        if guide:
            return guide.pixels[command.name] / (2.0**guide.framebuffer.depth_bits - 1.0)
        return transfer_depths(buffers.rows(buffers.depth, *box), transfer)
    color = _transferred(buffers.rows(buffers.color, *box), command, statistics)
    if color is None:
        return None
    luminance = color[..., :3].sum(axis=-1)
    if command.format == "LUMINANCE":
        return luminance
    if command.format == "LUMINANCE_ALPHA":
        return np.stack([luminance, color[..., 3]], axis=-1)
    return color[..., _COLOR_COMPONENTS[command.format]].copy()


def _drew_otherwise(guide, draws):
    return ValueError(
        f"The guide drew {len(guide.records)} times and these commands draw {draws} times; guide a frame by "
        "the machine's run of the same passes."
    )


def _check_guide(guide, commands, width, height):
    if not isinstance(guide, Result):
        raise ValueError(
            f"The guide is of type {type(guide).__name__}; give the Result of execute(..., record=True)."
        )
    draws = sum(isinstance(c, _DRAWING) for c in commands)
    if draws and not guide.records:
        raise ValueError("The guide holds no fragments; run it as execute(..., record=True).")
    # How often a host draws is known when it does.
    if len(guide.records) != draws and not any(isinstance(c, HostStep) for c in commands):
        raise _drew_otherwise(guide, draws)
    shape = guide.framebuffer.depth.shape
    if shape != (height, width):
        raise ValueError(
            f"The guide's framebuffer is {shape[1]}x{shape[0]} pixels and this one {width}x{height}; give "
            "both runs the same size."
        )


def execute_ideal(commands, width, height, *, guide=None, depth_bits=None, threads=None):
    """Run ``commands`` in float64 on a framebuffer of width x height pixels: an IdealResult.

    guide       None (free mode): the ideal makes its own alpha, stencil and depth tests. A Result of
                ``execute(..., record=True)`` of the corresponding commands (guided mode): colours are
                evaluated for exactly the fragments that the machine wrote, and depth and stencil are the
                machine's, so that the difference of the two pictures is arithmetic alone. Depths that are
                copied to textures are the exact ones of these fragments.
    depth_bits  the depth buffer whose smallest step is the unit of polygon offset (free mode); None: 24
    threads     how many shade fragments; None: one per processor

    Raises UnsupportedState or ValueError as ``validate`` does, and ValueError where the guide does not fit.
    """
    commands = frame_of(commands)
    depth_bits = IDEAL.widest_depth if depth_bits is None else depth_bits
    validate(commands, IDEAL, width, height, depth_bits=depth_bits)
    if guide is not None:
        _check_guide(guide, commands, width, height)
    buffers, textures, pixels, statistics = _Buffers(width, height), {}, {}, PixelStatistics()
    drawn, records = 0, None if guide is None else guide.records
    threads = Threads(threads or default_threads())
    waiting = deque(commands)
    while waiting:
        command = waiting.popleft()
        record = None
        if isinstance(command, _DRAWING):
            drawn += 1
            if records is not None:
                if drawn > len(records):
                    raise _drew_otherwise(guide, drawn)
                record = records[drawn - 1]
        if isinstance(command, Clear):
            _clear(command, buffers.buffer(command.draw_buffer))
        elif isinstance(command, Accum):
            _accumulate(command, buffers)
        elif isinstance(command, DrawPixels | CopyPixels | Bitmap):
            _draw_rectangle(command, buffers, textures, statistics, record)
        elif isinstance(command, Draw):
            written = buffers.buffer(command.state.draw_buffer)
            _draw(command, written, textures, width, height, depth_bits, record, threads)
        elif isinstance(command, TexImage) and command.pixels is None:
            textures[command.texture] = _with_ideal(command.image)
        elif isinstance(command, TexImage | CopyTexImage | CopyTexSubImage):
            source = buffers if isinstance(command, TexImage) else buffers.buffer(command.read_buffer)
            defined = _defined(command, source, textures, statistics)
            if defined is not None:
                textures[command.texture] = defined
        elif isinstance(command, ReadPixels):
            read = _read_pixels(command, buffers.buffer(command.read_buffer), guide, statistics)
            if read is not None:
                pixels[command.name] = read
        elif isinstance(command, Saturate):
            written = buffers.buffer(command.draw_buffer)
            color = written.rows(written.color, *_scissored(command.scissor, written))
            np.clip(color, 0.0, 1.0, out=color)
        elif isinstance(command, HostStep):
            waiting = deque((*issued_by(command, pixels), *waiting))
            kept = {"read": pixels, "host_step": command.label}
            validate(waiting, IDEAL, width, height, depth_bits, textures, statistics=statistics, **kept)
        elif isinstance(command, ResetHistogram):
            statistics.reset_histogram(command.name)
        elif isinstance(command, ResetMinmax):
            statistics.reset_minmax(command.name)
    if records is not None and drawn != len(records):
        raise _drew_otherwise(guide, drawn)
    depth, stencil = buffers.depth, buffers.stencil
    if guide is not None:
        depth = guide.framebuffer.depth / (2.0**guide.framebuffer.depth_bits - 1.0)
        stencil = guide.framebuffer.stencil.copy()
    return IdealResult(
        buffers.color, depth, stencil, textures, pixels, statistics.histograms, statistics.minmaxes
    )
