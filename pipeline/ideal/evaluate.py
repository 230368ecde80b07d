"""The IDEAL evaluator: the same passes in float64, with no rounding and no clamp but the algorithm's own.

What stays, what goes, and why: docs/decisions/0001-ideal-evaluator.md. Only coverage is the machine's: the
fragments are those of the snapped vertices.
"""

from collections import deque
from dataclasses import replace

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
from fixedpipe.pipeline.framebuffers.result import Result
from fixedpipe.pipeline.framebuffers.transfer import (
    PixelStatistics,
)
from fixedpipe.pipeline.ideal.buffers import IdealBuffers, accumulate, clear, read_pixels, scissored
from fixedpipe.pipeline.ideal.per_fragment import write, write_tested, writes_depth
from fixedpipe.pipeline.ideal.rectangles import draw_rectangle
from fixedpipe.pipeline.ideal.result import IdealResult
from fixedpipe.pipeline.ideal.shade import shade
from fixedpipe.pipeline.ideal.textures import frame_texture, with_ideal
from fixedpipe.pipeline.ideal.weights import iterate, weigh
from fixedpipe.pipeline.native.coverage import rasterize
from fixedpipe.pipeline.native.threads import Threads, default_threads
from fixedpipe.pipeline.profiles import IDEAL
from fixedpipe.pipeline.validation.frames import frame_of, issued_by
from fixedpipe.pipeline.validation.validate import validate
from fixedpipe.pipeline.vertices.stage import process
from fixedpipe.raster.columns.per_fragment import in_order

# Fragments shaded at a time: bounds the columns' memory to some megabytes a thread, and changes no value.
_CHUNK = 1 << 14


_DRAWING = Draw | DrawPixels | CopyPixels | Bitmap


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
                if record is not None and not writes_depth(state):
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
            write_tested(state, buffers, pixel[once], color[once], z[once])
        else:
            write(state, buffers, pixel[once], color[once], z[once])


def _window_depth(polygon, primitives, weights, depth_bits):
    """Window depth in [0, 1], with an exact polygon offset whose unit is the depth buffer's smallest step."""
    z = iterate(weights.affine, primitives.z[weights.vertices])
    if polygon.offset_fill:
        z = z + polygon.offset_units / (2**depth_bits - 1) + polygon.offset_factor * weights.depth_slope
    return np.clip(z, 0.0, 1.0)


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
    buffers, textures, pixels, statistics = IdealBuffers(width, height), {}, {}, PixelStatistics()
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
            clear(command, buffers.buffer(command.draw_buffer))
        elif isinstance(command, Accum):
            accumulate(command, buffers)
        elif isinstance(command, DrawPixels | CopyPixels | Bitmap):
            draw_rectangle(command, buffers, textures, statistics, record)
        elif isinstance(command, Draw):
            written = buffers.buffer(command.state.draw_buffer)
            _draw(command, written, textures, width, height, depth_bits, record, threads)
        elif isinstance(command, TexImage) and command.pixels is None:
            textures[command.texture] = with_ideal(command.image)
        elif isinstance(command, TexImage | CopyTexImage | CopyTexSubImage):
            source = buffers if isinstance(command, TexImage) else buffers.buffer(command.read_buffer)
            defined = frame_texture(command, source, textures, statistics)
            if defined is not None:
                textures[command.texture] = defined
        elif isinstance(command, ReadPixels):
            read = read_pixels(command, buffers.buffer(command.read_buffer), guide, statistics)
            if read is not None:
                pixels[command.name] = read
        elif isinstance(command, Saturate):
            written = buffers.buffer(command.draw_buffer)
            color = written.rows(written.color, *scissored(command.scissor, written))
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
