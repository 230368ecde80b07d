"""Rows and columns that no state packs to, given to the kernels: no crash, and nothing outside an array.

``python -m tests.hostile --frames N`` spoils what ``pipeline/native/`` made of N random frames, one array at
a time: random bytes, small whole numbers, numbers at the ends of their type, NaN. It runs in a process of its
own, for a kernel that did leave its arrays could end it; with NUMBA_BOUNDSCHECK=1 such a kernel raises
IndexError instead.
"""

import argparse
import sys

import numpy as np

from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.enums import TextureTarget
from fixedpipe.pipeline.framebuffers.framebuffer import Framebuffer
from fixedpipe.pipeline.native import pack
from fixedpipe.pipeline.native.combiner_plan import plan_combiners
from fixedpipe.pipeline.native.texels import texels_of
from fixedpipe.pipeline.vertices import stage
from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import Buffers
from fixedpipe.raster.portable.draw import draw_bands
from fixedpipe.raster.primitives.bins import BAND_HEIGHT, count_bins, fill_bins
from fixedpipe.raster.vector.arrays import JOB_SIZE, scratch
from fixedpipe.raster.vector.frame import draw_frame, fill_clear, fill_draw
from tests.support.random_frames import random_frame

SHARED = ("program", "final", "constants", "arithmetic", "factors")
ROWS = ("draw", "draw_float", *SHARED, "units", "fog_thresholds", "depths")
COLUMNS = (
    *("x", "y", "inverse_w", "colors", "coordinates", "fog"),
    *("triangles", "strokes", "levels", "pair_levels", "plan"),
)
BATCH = 256
SCRATCH = scratch(BATCH)
WAYS = ("bytes", "small", "extreme")
_WHOLE = (-1, -(2**31), 2**31 - 1, 2**15, 255, 256, 1 << 20, -(1 << 20), 7, 3, 0)
_REAL = (np.nan, np.inf, -np.inf, 1e308, -1e308, 1e38, -1e38, 5e-324, -0.0, 2.0**31, -(2.0**63))


def spoiled(array, random, way):
    """A copy of an array with other contents: all of it, or a few places."""
    copy = array.copy()
    flat = copy.reshape(-1)
    if way == "bytes":
        flat.view(np.uint8)[:] = random.integers(0, 256, flat.nbytes, np.uint8)
        return copy
    places = random.integers(0, flat.size, random.integers(1, 4))
    with np.errstate(all="ignore"):
        if way == "small":
            flat[places] = random.integers(-3, 40, len(places)).astype(flat.dtype)
        else:
            extreme = _REAL if flat.dtype.kind == "f" else _WHOLE
            flat[places] = random.choice(np.array(extreme), len(places)).astype(flat.dtype)
    return copy


class Arrays(dict):
    """Everything that kernels take of one Draw, by name; ``texels`` and ``pairs`` are lists of four."""

    @classmethod
    def of(cls, command, frame, target, textures):
        """The arrays of a Draw: made as ``fixedpipe.pipeline.execution.machine`` makes them."""
        state = command.state
        p = stage.process(command.mesh, state, frame.profile, target.width, target.height)
        packed = pack.pack(state, frame.profile, target, textures, p)
        texels, pairs = [np.zeros(1, np.uint32)] * 4, [np.zeros(1, np.uint32)] * 4
        levels = np.ones((len(packed.units), R.MAX_LEVELS, 3), np.int32)
        pair_levels = levels.copy()
        for i, unit in enumerate(state.texture_units):
            if unit is not None and packed.units[i, R.ENABLED] and unit.texture is not None:
                found = texels_of(textures[unit.texture], int(packed.units[i, R.SIGNED]))
                texels[i], levels[i] = found.packed, found.levels[0]
                if packed.units[i, R.TARGET] != TextureTarget.TEXTURE_3D:
                    pairs[i], pair_levels[i] = found.pairs[0], found.pairs[1][0]
        rows = packed.draw, packed.program, packed.final, packed.arithmetic, packed.units
        arrays = cls(texels=texels, pairs=pairs, levels=levels, pair_levels=pair_levels)
        arrays["plan"] = plan_combiners(*rows).filled(packed.constants, packed.draw)
        for name in ("triangles", "strokes", "x", "y", "inverse_w", "colors", "coordinates", "fog"):
            arrays[name] = getattr(p, name)
        for name in ROWS:
            arrays[name] = getattr(packed, name)
        return arrays

    def draw(self, target):
        """Draw by the portable engine, and by the vector engine; returns whether each took the arrays."""
        a = self
        triangles, strokes, x, y = a["triangles"], a["strokes"], a["x"], a["y"]
        bands = -(-target.height // BAND_HEIGHT)
        counts, spans = np.empty(bands, np.int32), np.empty((len(triangles), 2), np.int32)
        count_bins(triangles, strokes, x, y, a["inverse_w"], a["draw"], counts, spans)
        ends = np.zeros(bands, np.int32)
        ends[1:] = np.cumsum(counts)[:-1]
        order = np.empty(int(counts.sum()), np.int32)
        fill_bins(spans, ends, order)
        buffers = Buffers(target.color.view(np.uint32)[..., 0], target.depth, target.stencil)
        state, combiners, vertices, fog = (
            tuple([a[name] for name in names])
            for names in (
                ("draw", "draw_float", "factors"),
                ("program", "final", "constants", "arithmetic"),
                ("x", "y", "depths", "inverse_w", "colors", "coordinates"),
                ("fog", "fog_thresholds"),
            )
        )
        textures = tuple(a["texels"]), a["levels"], a["units"]
        colors = a["colors"].astype(np.int16)
        arrays, bins = (state, combiners, triangles, strokes, vertices, colors, fog, textures), (order, ends)
        record = np.zeros((0, 4), np.int32)
        drawn = draw_bands(arrays, bins, 0, 1, BATCH, tuple(buffers), record)
        jobs = np.zeros((2, JOB_SIZE), np.int64)
        fill_clear(jobs, 0, tuple(a["draw"][:4].tolist()), 7, (0, 0xFF00FF, 5, 6, 0xF0))
        pairs = tuple(a["pairs"]), a["pair_levels"], a["units"]
        covered = fill_draw(jobs, 1, (state, a["plan"], triangles, vertices, pairs), bins)
        draw_frame(jobs, 1 + covered, np.zeros(1, np.int64), BATCH, buffers, SCRATCH)
        return drawn >= 0, bool(covered and jobs[1, R.JOB_USABLE])


def draws_of(frame):
    """(arrays, framebuffer) of the Draws of a frame that read nothing copied."""
    textures, target = {}, Framebuffer.new(frame.width, frame.height, frame.depth_bits)
    for command in frame.commands:
        if isinstance(command, TexImage):
            textures[command.texture] = command.image
        elif isinstance(command, Draw):
            named = {unit.texture for unit in command.state.texture_units if unit is not None}
            if named <= textures.keys():
                arrays = Arrays.of(command, frame, target, textures)
                left, top, right, bottom = arrays["draw"][[R.X0, R.Y0, R.X1, R.Y1]]
                if left < right and top < bottom:  # nothing else reaches a kernel
                    yield arrays, target


def try_all(frames, first_seed=0):
    """Spoil every array of so many frames' first Draws; returns (spoilt, drawn by the portable engine, by the
    vector engine).
    """
    spoilt, drawn = 0, np.zeros(2, int)
    for seed in range(first_seed, first_seed + frames):
        random = np.random.default_rng(seed)
        arrays, target = next(draws_of(random_frame(seed)), (None, None))
        if arrays is None:
            continue
        assert arrays.draw(target)[0], f"rows that were packed are refused (seed {seed})"
        for name in ROWS + COLUMNS:
            for way in WAYS:
                if arrays[name].size:
                    try:
                        drawn += Arrays(arrays, **{name: spoiled(arrays[name], random, way)}).draw(target)
                    except Exception as error:
                        error.add_note(f"seed {seed}: {name}, {way}")
                        raise
                    spoilt += 1
    return spoilt, *drawn.tolist()


def main(arguments=None):
    """Parse the command line and try."""
    parser = argparse.ArgumentParser(prog="python -m tests.hostile", description=__doc__.split("\n\n")[0])
    parser.add_argument("--frames", type=int, default=100)
    parser.add_argument("--first-seed", type=int, default=0)
    given = parser.parse_args(arguments)
    spoilt, portable, vector = try_all(given.frames, given.first_seed)
    print(
        f"{spoilt} spoilt, {portable} drawn by the portable engine, {vector} by the vector engine: no crash"
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
