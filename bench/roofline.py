"""How fast memory is, how many bytes a scene moves, and what rate the first allows the second.

The bytes are those of the framebuffer and of the texels and vertices as they are stored; what a kernel keeps
between its stages is not in them. So a bound is what no arithmetic at all would reach.
"""

import ctypes
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from threading import Barrier

import numpy as np

from fixedpipe.pipeline.enums import StencilOperation, TextureFilter

IN_CACHE, OUT_OF_CACHE = 4 << 20, 256 << 20  # bytes of all threads together
_SECONDS = 0.05
_TIMES = 5

# Texels that one fragment reads. Source: OpenGL 1.2.1 section 3.8.5.
_TEXELS = {
    TextureFilter.NEAREST: 1,
    TextureFilter.LINEAR: 4,
    TextureFilter.NEAREST_MIPMAP_NEAREST: 1,
    TextureFilter.LINEAR_MIPMAP_NEAREST: 4,
    TextureFilter.NEAREST_MIPMAP_LINEAR: 2,
    TextureFilter.LINEAR_MIPMAP_LINEAR: 8,
}
_COLOR_BYTES = _DEPTH_BYTES = _TEXEL_BYTES = 4
_STENCIL_BYTES = 1


@dataclass(frozen=True)
class Bandwidth:
    """Bytes a second that ``threads`` threads wrote, or read and wrote (both counted) in place.

    ``bytes``: how much they went over again and again, all together.
    """

    access: str
    bytes: int
    threads: int
    rate: float


def _write(array):
    ctypes.memset(array.ctypes.data, 1, array.nbytes)


def _update(array):
    np.add(array, 1, out=array)


ACCESSES = {"write": (_write, 1), "read and write": (_update, 2)}


def measure_bandwidth(access, size, threads, seconds=_SECONDS, times=_TIMES):
    """A Bandwidth over ``size`` bytes: the best of ``times`` of about ``seconds`` each, for it is a bound."""
    touch, count = ACCESSES[access]
    arrays = [np.zeros(size // threads // 8, np.uint64) for _ in range(threads)]
    start = time.perf_counter()
    for array in arrays:
        touch(array)  # which also makes its pages
    rounds = max(1, round(seconds / ((time.perf_counter() - start) / threads)))
    begin = Barrier(threads)

    def work(array):
        begin.wait()
        started = time.perf_counter()
        for _ in range(rounds):
            touch(array)
        return started, time.perf_counter()

    moved, best = count * rounds * sum(array.nbytes for array in arrays), 0.0
    with ThreadPoolExecutor(threads) as pool:
        for _ in range(times):
            starts, ends = zip(*pool.map(work, arrays), strict=True)
            best = max(best, moved / (max(ends) - min(starts)))
    return Bandwidth(access, size, threads, best)


def measure_bandwidths(threads):
    """The Bandwidths in and out of cache, of one thread and of ``threads``."""
    return [
        measure_bandwidth(access, size, count)
        for size in (IN_CACHE, OUT_OF_CACHE)
        for access in ACCESSES
        for count in sorted({1, threads})
    ]


@dataclass(frozen=True)
class Traffic:
    """Bytes that one unit of a scene's work moves: a fragment, or a triangle with its fragments.

    clear               its share of the frame's Clear, written
    color, depth, stencil   read and written, of a fragment that passes all tests
    texture             texels that its filters read, whether or not a neighbour reads them too
    geometry            vertices and indices, read
    written             how many of them are only written, not read before
    """

    clear: float
    color: float
    depth: float
    stencil: float
    texture: float
    geometry: float
    written: float

    @property
    def total(self):
        """All bytes."""
        return self.clear + self.color + self.depth + self.stencil + self.texture + self.geometry

    def bound(self, write, update):
        """The most units a second where ``write`` bytes are written, or ``update`` read and written."""
        return 1 / (self.written / write + (self.total - self.written) / update)


def _fragment_bytes(state):
    """(colour, depth, stencil, texture, how many are written only) of a fragment in a PassState."""
    mask = state.color_mask
    masks = (mask.red, mask.green, mask.blue, mask.alpha)
    color = written = 0
    if any(masks):
        whole = all(masks) and state.blending is None and state.logic_op is None
        color = _COLOR_BYTES * (1 if whole else 2)
        written = color if whole else 0
    depth = 0 if state.depth_test is None else _DEPTH_BYTES * (1 + state.depth_test.write)
    stencil, test = 0, state.stencil_test
    if test is not None:
        keeps = {test.fail, test.depth_fail, test.depth_pass} == {StencilOperation.KEEP}
        stencil = _STENCIL_BYTES * (1 if keeps else 2)
    units = [unit for unit in state.texture_units if unit is not None]
    texture = _TEXEL_BYTES * sum(_TEXELS[unit.sampler.min_filter] for unit in units)
    return color, depth, stencil, texture, written


def _mesh_bytes(mesh):
    arrays = [mesh.positions, mesh.colors, mesh.indices, *mesh.texture_coordinates]
    return sum(array.nbytes for array in arrays if array is not None)


def traffic(scene, size):
    """The Traffic of a scene's measured frame at ``size`` x ``size`` pixels."""
    layer = scene.layer(size)
    units = scene.work(size) / scene.layers  # of a layer
    fragments = scene.fragments(size) / units
    color, depth, stencil, texture, written = _fragment_bytes(layer[0].state)
    first = scene.depth_first / scene.layers  # a depth is read and written before, and its vertices read
    clear = (_COLOR_BYTES + _DEPTH_BYTES + _STENCIL_BYTES) * size * size / scene.work(size)
    return Traffic(
        clear=clear,
        color=color * fragments,
        depth=(depth + 2 * _DEPTH_BYTES * first) * fragments,
        stencil=stencil * fragments,
        texture=texture * fragments,
        geometry=(1 + first) * sum(_mesh_bytes(draw.mesh) for draw in layer) / units,
        written=clear + written * fragments,
    )
