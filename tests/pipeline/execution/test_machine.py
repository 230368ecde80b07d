"""The machine as a whole: commands in order, traces, records, rectangles, threads, and extreme input."""

import gc
import os
import signal
import threading
import warnings
import weakref
from concurrent.futures import ThreadPoolExecutor
from copy import deepcopy
from dataclasses import replace
from queue import SimpleQueue

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fixedpipe.pipeline.commands import (
    Clear,
    CopyTexImage,
    CopyTexSubImage,
    Draw,
    MakeCurrent,
    Mesh,
    ReadPixels,
    TexImage,
)
from fixedpipe.pipeline.enums import (
    BlendFactor,
    ComparisonFunction,
    ComponentUsage,
    Face,
    InternalFormat,
    PrimitiveType,
    Register,
    StencilOperation,
    TextureFilter,
    TextureTarget,
    WrapMode,
)
from fixedpipe.pipeline.execution.machine import ENGINES, Machine, execute
from fixedpipe.pipeline.native import queue, state_records
from fixedpipe.pipeline.native import threads as threads_module
from fixedpipe.pipeline.native.coverage import rasterize
from fixedpipe.pipeline.native.texels import texels_of
from fixedpipe.pipeline.native.threads import Threads
from fixedpipe.pipeline.profiles import GEFORCE_256, IDEAL, NV2A
from fixedpipe.pipeline.state import (
    Blending,
    ColorMask,
    CombinerInput,
    DepthTest,
    FinalCombiner,
    Fog,
    PassState,
    PolygonState,
    RegisterCombiners,
    Sampler,
    Scissor,
    StencilTest,
    TextureUnit,
    VertexState,
    Viewport,
)
from fixedpipe.pipeline.textures.images import Texture, texture_1d, texture_2d, texture_cube_map
from fixedpipe.pipeline.validation.walk import UnsupportedState
from fixedpipe.pipeline.vertices import stage
from fixedpipe.pipeline.vertices.primitives import WindowPrimitives
from fixedpipe.raster.portable import draw as draw_module
from fixedpipe.raster.primitives.bins import BAND_HEIGHT
from tests.support.run_reference import run_reference
from tests.support.strategies import POLYGONS

WIDTH, HEIGHT = 20, 14
PARALLEL = 160  # pixels along the edges of a framebuffer that is large enough for several threads
# Seconds after which what should end is taken to hang: more than any machine needs, however busy it is.
HANGS = 600.0
CORNERS = np.array([[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]])  # a triangle over the whole screen
TEXTURE = CombinerInput(Register.TEXTURE0)
SHOW_TEXTURE = RegisterCombiners(
    final=FinalCombiner(
        a=CombinerInput(),
        b=CombinerInput(),
        c=TEXTURE,
        g=replace(TEXTURE, usage=ComponentUsage.ALPHA),
    )
)
NEAREST = Sampler(TextureFilter.NEAREST, TextureFilter.NEAREST)


def color_of(n):
    """A colour whose bytes are n, n + 1, n + 2, n + 3."""
    return tuple((n + k) / 255.0 for k in range(4))


def flood(n, **state):
    """A Draw of one colour over the whole screen."""
    return Draw(label=f"flood {n}", mesh=Mesh(CORNERS, colors=[color_of(n)] * 3), state=PassState(**state))


def textured(name, sampler=NEAREST, **state):
    """A Draw that shows a texture once over the whole screen."""
    units = (TextureUnit(name, sampler),)
    mesh = Mesh(CORNERS, texture_coordinates=((CORNERS + 1.0) / 2.0,))
    state = PassState(texture_units=units, register_combiners=SHOW_TEXTURE, **state)
    return Draw(label=f"show {name}", mesh=mesh, state=state)


def triangles(count, seed=0, spread=1.4):
    """A Draw of random triangles with depth, blended, so that order and repetition show in the result."""
    random = np.random.default_rng(seed)
    positions = random.uniform(-spread, spread, (3 * count, 3))
    positions[:, 2] = random.uniform(-1.0, 1.0, 3 * count)
    state = PassState(
        depth_test=DepthTest(ComparisonFunction.LEQUAL),
        blending=Blending(BlendFactor.SRC_ALPHA, BlendFactor.ONE_MINUS_SRC_ALPHA),
    )
    mesh = Mesh(positions, colors=random.random((3 * count, 4)))
    return Draw(label="triangles", mesh=mesh, state=state)


def run(*commands, size=(WIDTH, HEIGHT), **options):
    return execute(commands, GEFORCE_256, *size, **options)


def buffers(framebuffer):
    return framebuffer.color, framebuffer.depth, framebuffer.stencil


def assert_same_buffers(a, b):
    for mine, other in zip(buffers(a), buffers(b), strict=True):
        np.testing.assert_array_equal(mine, other)


def assert_like_the_reference(commands, width, height, depth_bits=24, **options):
    """Run both; returns the machine's Result."""
    result = execute(commands, GEFORCE_256, width, height, depth_bits=depth_bits, **options)
    target = run_reference(commands, GEFORCE_256, width, height, depth_bits).target
    for got, expected in zip(
        buffers(result.framebuffer), (target.color, target.depth, target.stencil), strict=True
    ):
        np.testing.assert_array_equal(got, np.array(expected))
    return result


# ------------------------------------------------------------------------------------------------------ trace


def mixed_commands():
    stencil = StencilTest(depth_pass=StencilOperation.INCR)
    return (
        Clear(label="clear all", color=color_of(10), depth=0.75, stencil=3),
        flood(40, stencil_test=stencil, depth_test=DepthTest(), scissor=Scissor(2, 1, 9, 5)),
        CopyTexImage(label="copy", texture="copied", x=1, y=2, width=16, height=8),
        textured("copied", depth_test=DepthTest(ComparisonFunction.ALWAYS, write=False)),
        triangles(4),
        ReadPixels(label="read", name="all"),
    )


def test_a_trace_keeps_the_framebuffer_after_every_command():
    commands = mixed_commands()
    trace = run(*commands, trace=True).trace
    assert [(s.label, s.kind) for s in trace] == [(c.label, type(c).__name__) for c in commands]
    distinct = set()
    for k, snapshot in enumerate(trace):
        assert_same_buffers(snapshot, run(*commands[: k + 1]).framebuffer)
        distinct.add(b"".join(buffer.tobytes() for buffer in buffers(snapshot)))
    assert len(distinct) == 4  # the copy and ReadPixels change nothing


def test_without_a_trace_or_a_record_nothing_is_kept():
    result = run(*mixed_commands())
    assert result.trace == result.records == ()


@pytest.mark.parametrize("depth_bits", [16, 24])
def test_a_snapshots_pictures_show_color_alpha_depth_and_stencil(depth_bits):
    commands = (Clear(label="c", color=color_of(70), depth=1.0, stencil=200), triangles(6))
    snapshot = run(*commands, trace=True, depth_bits=depth_bits).trace[-1]
    pictures = snapshot.pictures()
    np.testing.assert_array_equal(pictures["color"], snapshot.color[..., :3])
    np.testing.assert_array_equal(pictures["alpha"], snapshot.color[..., 3])
    np.testing.assert_array_equal(pictures["stencil"], np.full((HEIGHT, WIDTH), 200))
    np.testing.assert_array_equal(pictures["depth"], snapshot.depth // 2 ** (depth_bits - 8))
    assert pictures["depth"].max() == 255
    assert pictures["depth"].min() < 200
    assert {picture.dtype for picture in pictures.values()} == {np.dtype(np.uint8)}


# ------------------------------------------------------------------------------------- records, rasterization


def test_records_and_rasterization_name_the_same_fragments():
    draw, box = triangles(20, seed=3), Scissor(3, 2, 14, 9)
    polygon = PolygonState(cull_face=Face.BACK)
    draw = replace(draw, state=replace(draw.state, scissor=box, polygon=polygon))
    (record,) = run(draw, record=True).records
    primitives = stage.process(draw.mesh, draw.state, GEFORCE_256, WIDTH, HEIGHT)
    coverage = rasterize(primitives, GEFORCE_256, draw.state.polygon, box, WIDTH, HEIGHT)
    for name in ("triangle", "x", "y"):
        np.testing.assert_array_equal(getattr(record, name), getattr(coverage, name))
    assert coverage.passed.all()
    assert 0 < record.passed.sum() < len(record.passed)  # LEQUAL: something lies behind
    assert set(record.x) <= set(range(3, 17))
    assert set(record.y) <= set(range(HEIGHT - 11, HEIGHT - 2))


def test_the_fragments_that_passed_are_those_that_were_written():
    depth = np.full((HEIGHT, WIDTH), 2**24 - 1)
    draw = triangles(7, seed=3)
    for number in range(7):
        mesh = replace(draw.mesh, indices=np.arange(3 * number + 3))
        result = run(replace(draw, mesh=mesh), record=True)
        (record,) = result.records
        last = (record.triangle == record.triangle.max(initial=-1)) & (record.passed == 1)
        touched = np.zeros(depth.shape, bool)
        if len(record.triangle) and record.triangle.max() == number:
            touched[record.y[last], record.x[last]] = True
        assert not (result.framebuffer.depth != depth)[~touched].any()
        depth = result.framebuffer.depth


def test_recording_more_fragments_than_expected_draws_them_once():
    commands = (flood(100), flood(3, blending=Blending(BlendFactor.ONE, BlendFactor.ONE)))
    recorded = run(
        *commands, size=(300, 260), record=True
    )  # 78000 fragments: more than the first attempt holds
    assert [len(r.x) for r in recorded.records] == [300 * 260] * 2
    assert recorded.fragments == 2 * 300 * 260
    assert_same_buffers(recorded.framebuffer, run(*commands, size=(300, 260)).framebuffer)
    np.testing.assert_array_equal(recorded.framebuffer.color, np.full((260, 300, 4), [103, 105, 107, 109]))


# ---------------------------------------------------------------------------------- copies, replaced textures


@pytest.mark.parametrize("threads", [1, 2])
def test_a_copy_reads_what_was_just_drawn(threads):
    size = (PARALLEL, PARALLEL)
    draw = replace(triangles(9), state=replace(triangles(9).state, depth_test=None))
    copy = CopyTexImage(label="copy", texture="t", x=16, y=32, width=128, height=64)
    # One texel for each pixel, into the lower left corner.
    show = textured("t", vertex=VertexState(viewport=Viewport(0, 0, 128, 64)), scissor=Scissor(0, 0, 128, 64))
    result = run(draw, copy, show, size=size, threads=threads)
    drawn = run(draw, size=size).framebuffer.color[::-1]
    expected = drawn[32:96, 16:144]
    np.testing.assert_array_equal(result.textures["t"].levels[0][0], expected)
    np.testing.assert_array_equal(result.framebuffer.color[::-1][:64, :128], expected)
    np.testing.assert_array_equal(result.framebuffer.color[::-1][64:], drawn[64:])
    assert len(np.unique(expected.reshape(-1, 4), axis=0)) > 10


def test_copies_generate_their_mipmaps():
    draw = triangles(9)
    whole = CopyTexImage(label="copy", texture="t", width=8, height=4, generate_mipmap=True)
    part = CopyTexSubImage(label="part", texture="t", x=9, y=3, width=5, height=2, generate_mipmap=True)
    stale = replace(part, generate_mipmap=False)
    copied, updated, kept = (run(draw, whole, *more).textures["t"] for more in ((), (part,), (stale,)))
    assert [level.shape for level in copied.levels] == [
        (1, 4, 8, 4),
        (1, 2, 4, 4),
        (1, 1, 2, 4),
        (1, 1, 1, 4),
    ]
    for texture in (copied, updated):
        for larger, smaller in zip(texture.levels, texture.levels[1:], strict=False):
            h, w = smaller.shape[1:3]
            rows = larger[0].astype(int).reshape(h, larger.shape[1] // h, w, larger.shape[2] // w, 4)
            boxes = rows.shape[1] * rows.shape[3]
            np.testing.assert_array_equal(smaller[0], (rows.sum((1, 3)) * (4 // boxes) + 2) // 4)
    assert (updated.levels[0] != copied.levels[0]).any()
    assert (updated.levels[1] != copied.levels[1]).any()
    np.testing.assert_array_equal(kept.levels[0], updated.levels[0])
    np.testing.assert_array_equal(kept.levels[1], copied.levels[1])


def test_a_row_copied_as_a_1d_texture_is_sampled_along_s():
    row = CopyTexImage(label="row", texture="t", target=TextureTarget.TEXTURE_1D, y=5, width=16, height=1)
    result = run(triangles(9), row)
    assert result.textures["t"].target is TextureTarget.TEXTURE_1D
    np.testing.assert_array_equal(
        result.textures["t"].levels[0][0, 0], result.framebuffer.color[::-1][5, :16]
    )


def solid(n, width=4, height=4, mipmaps=False):
    return texture_2d(np.full((height, width, 4), n, np.uint8), mipmaps=mipmaps)


def test_a_texture_replaced_between_draws_changes_only_the_later_draw():
    left, right = Scissor(0, 0, 10, HEIGHT), Scissor(10, 0, 10, HEIGHT)
    machine = Machine(GEFORCE_256, WIDTH, HEIGHT)
    result = machine.run(
        (
            TexImage(label="one", texture="t", image=solid(11)),
            textured("t", scissor=left),
            TexImage(label="two", texture="t", image=solid(22)),
            textured("t", scissor=right),
        )
    )
    assert (result.framebuffer.color[:, :10] == 11).all()
    assert (result.framebuffer.color[:, 10:] == 22).all()
    before = result.textures["t"]
    sub = CopyTexSubImage(label="sub", texture="t", x=0, y=0, width=4, height=2)
    result = machine.run((sub, textured("t")))
    rows = result.framebuffer.color[::-1]
    assert (rows[: HEIGHT // 2] == 11).all()  # the texture's lower half, from the framebuffer's left
    assert (rows[HEIGHT // 2 :] == 22).all()
    assert (before.levels[0] == 22).all()  # the object that an earlier Result holds stays as it was


def test_textures_that_are_replaced_wait_in_the_queue_up_to_a_number_of_bytes(monkeypatch):
    """Of 4 KiB each, and 8 KiB may wait: two Draws at a time instead of all twelve at the end."""
    monkeypatch.setattr(queue, "_MOST_BYTES", 1 << 13)
    waited, flush = [], queue.Queue.flush

    def counting(queue):
        waited.append(len(queue._draws))
        flush(queue)

    monkeypatch.setattr(queue.Queue, "flush", counting)
    images = [TexImage(label="t", texture="t", image=solid(n, 32, 32)) for n in range(12)]
    result = run(*(command for image in images for command in (image, textured("t"))))
    assert max(waited) == 2
    assert sum(waited) == 12
    assert (result.framebuffer.color == 11).all()


def test_a_copy_into_level_1_is_read_where_level_1_is_selected():
    texture = solid(11, 32, 16, mipmaps=True)
    sampler = Sampler(TextureFilter.NEAREST_MIPMAP_NEAREST, TextureFilter.NEAREST)
    commands = (
        TexImage(label="t", texture="t", image=texture),
        Clear(label="c", color=(77 / 255,) * 4),
        CopyTexSubImage(label="s", texture="t", x_offset=8, y_offset=0, width=8, height=8, level=1),
    )
    # 32 texels on 16 pixels, lambda 1: level 1; 32 texels on 32 pixels, lambda 0: level 0.
    reduced = run(*commands, textured("t", sampler), size=(16, 8)).framebuffer.color
    assert (reduced[:, :8] == 11).all()
    assert (reduced[:, 8:] == 77).all()
    assert (run(*commands, textured("t", sampler), size=(32, 16)).framebuffer.color == 11).all()


def test_a_copy_into_a_cube_maps_face_is_read_in_its_direction():
    cube = texture_cube_map(np.full((6, 8, 8, 4), 5, np.uint8))
    for face, direction in enumerate(
        np.concatenate([np.eye(3)[[axis, axis]] * [[1], [-1]] for axis in range(3)])
    ):
        draw = textured("cube")
        draw = replace(draw, mesh=Mesh(CORNERS, texture_coordinates=([direction] * 3,)))
        commands = (
            TexImage(label="cube", texture="cube", image=cube),
            Clear(label="clear", color=color_of(100)),
            CopyTexSubImage(label="face", texture="cube", face=face, width=8, height=8),
            draw,
        )
        result = assert_like_the_reference(commands, WIDTH, HEIGHT)
        assert (result.framebuffer.color == [100, 101, 102, 103]).all()
        assert (np.delete(result.textures["cube"].levels[0], face, 0) == 5).all()


@pytest.mark.parametrize("q", [1.0, 4.0])
def test_a_cube_maps_lambda_does_not_depend_on_q(q):
    random = np.random.default_rng(1)
    cube = texture_cube_map(random.integers(0, 256, (6, 32, 32, 4)).astype(np.uint8), mipmaps=True)
    directions = np.array([[1.0, -0.5, -0.5, q], [1.0, 0.9, 0.2, q], [1.0, 0.1, 0.9, q]])
    draw = textured("cube", Sampler(TextureFilter.LINEAR_MIPMAP_LINEAR, TextureFilter.NEAREST))
    draw = replace(draw, mesh=Mesh(CORNERS, texture_coordinates=(directions,)))
    assert_like_the_reference((TexImage(label="c", texture="cube", image=cube), draw), WIDTH, HEIGHT)


def test_a_texture_keeps_no_writable_array():
    array = np.full((1, 4, 8, 4), 11, np.uint8)
    texture = Texture(TextureTarget.TEXTURE_2D, InternalFormat.RGBA8, (array[:, :, ::2],))
    commands = (TexImage(label="t", texture="t", image=texture), textured("t"))
    first = run(*commands).framebuffer
    array[:] = 99
    assert (texture.levels[0] == 11).all()
    assert (first.color == 11).all()
    assert_same_buffers(first, run(*commands).framebuffer)
    copied = run(*commands, CopyTexImage(label="c", texture="c", width=4, height=4))
    sub = CopyTexSubImage(label="s", texture="t", width=2, height=2)
    for image in (texture, copied.textures["c"], run(*commands, sub).textures["t"]):
        with pytest.raises(ValueError, match="read-only"):
            image.levels[0][...] = 1


# ------------------------------------------------------------------------------------------ ReadPixels, Clear


def luminance(rgba):
    return np.minimum(rgba[..., :3].astype(int).sum(-1), 255)


READS = {
    "RGBA": lambda c, d, s: c,
    "RGB": lambda c, d, s: c[..., :3],
    "RED": lambda c, d, s: c[..., 0],
    "GREEN": lambda c, d, s: c[..., 1],
    "BLUE": lambda c, d, s: c[..., 2],
    "ALPHA": lambda c, d, s: c[..., 3],
    "LUMINANCE": lambda c, d, s: luminance(c),
    "LUMINANCE_ALPHA": lambda c, d, s: np.stack([luminance(c), c[..., 3]], -1),
    "DEPTH_COMPONENT": lambda c, d, s: d,
    "STENCIL_INDEX": lambda c, d, s: s,
}


@pytest.mark.parametrize("pixel_format", READS)
@pytest.mark.parametrize("box", [(0, 0, None, None), (3, 2, 9, 5), (4, 4, 0, 3)])
def test_read_pixels_returns_its_rectangle_bottom_row_first(pixel_format, box):
    x, y, width, height = box
    stencil = StencilTest(depth_pass=StencilOperation.INVERT)
    draw = triangles(9)
    draw = replace(draw, state=replace(draw.state, stencil_test=stencil))
    read = ReadPixels(label="r", name="r", format=pixel_format, x=x, y=y, width=width, height=height)
    result = run(draw, read, Clear(label="later", color=color_of(1), depth=0.0, stencil=9))
    whole = READS[pixel_format](*(b[::-1] for b in buffers(run(draw).framebuffer)))
    columns = slice(x, None if width is None else x + width)
    expected = whole[y : None if height is None else y + height, columns]
    np.testing.assert_array_equal(result.pixels["r"], expected)
    assert result.pixels["r"].dtype == (np.uint32 if pixel_format == "DEPTH_COMPONENT" else np.uint8)
    assert len(np.unique(whole)) > 1


BOXES = [
    None,
    Scissor(3, 2, 7, 5),
    Scissor(-4, -3, 9, 9),
    Scissor(15, 9, 500, 500),
    Scissor(5, 5, 0, 4),
    Scissor(WIDTH + 3, 0, 4, 4),
    Scissor(0, -9, 4, 4),
    Scissor(-(2**31), -(2**31), 2**31 - 1, 2**31 - 1),
    Scissor(2**31 - 1, 2**31 - 1, 2**31 - 1, 2**31 - 1),
]


@pytest.mark.parametrize("box", BOXES)
@pytest.mark.parametrize("mask", [ColorMask(), ColorMask(True, False, True, False)])
def test_clear_and_draw_reach_the_scissor_box_alone(box, mask):
    inside = np.zeros((HEIGHT, WIDTH), bool)
    for y in range(HEIGHT):
        for x in range(WIDTH):
            inside[HEIGHT - 1 - y, x] = box is None or (
                box.x <= x < box.x + box.width and box.y <= y < box.y + box.height
            )
    old, new = np.array([50, 51, 52, 53]), np.array([200, 201, 202, 203])
    written = np.where([mask.red, mask.green, mask.blue, mask.alpha], new, old)
    expected = np.where(inside[..., None], written, old)
    first = Clear(label="all", color=color_of(50), depth=1.0, stencil=0b10101010)
    clear = Clear(
        label="box",
        color=color_of(200),
        depth=0.5,
        stencil=0b01100110,
        scissor=box,
        color_mask=mask,
        stencil_write_mask=0b11110000,
    )
    for engine in ENGINES:
        result = run(first, clear, engine=engine)
        np.testing.assert_array_equal(result.framebuffer.color, expected)
        np.testing.assert_array_equal(result.framebuffer.depth, np.where(inside, 2**23, 2**24 - 1))
        np.testing.assert_array_equal(result.framebuffer.stencil, np.where(inside, 0b01101010, 0b10101010))
    # A vertex colour keeps 14 significant bits: 200.3 / 255 truncates to 200, where 200 / 255 might not.
    mesh = Mesh(CORNERS, colors=[[(n + 0.3) / 255 for n in range(200, 204)]] * 3)
    draw = Draw(label="draw", mesh=mesh, state=PassState(scissor=box, color_mask=mask))
    drawn = run(first, draw)
    np.testing.assert_array_equal(drawn.framebuffer.color, expected)
    assert drawn.fragments == inside.sum()


# ---------------------------------------------------------------------------------------------------- Machine


def test_a_machine_keeps_its_framebuffer_and_textures_from_run_to_run():
    commands = mixed_commands()
    machine = Machine(GEFORCE_256, WIDTH, HEIGHT)
    results = [machine.run(commands[k : k + 1]) for k in range(len(commands))]
    whole = run(*commands)
    assert_same_buffers(machine.framebuffer, whole.framebuffer)
    np.testing.assert_array_equal(results[-1].pixels["all"], whole.pixels["all"])
    assert sum(r.fragments for r in results) == whole.fragments > 0


def test_a_refused_frame_leaves_everything_as_it_was():
    machine = Machine(GEFORCE_256, WIDTH, HEIGHT)
    machine.run(mixed_commands())
    before = [b.copy() for b in buffers(machine.framebuffer)]
    names = dict(machine.textures)
    with pytest.raises(UnsupportedState, match="no texture 'missing'"):
        machine.run(
            (
                Clear(label="c", color=color_of(0), depth=0.0, stencil=0),
                TexImage(label="t", texture="new", image=solid(1)),
                textured("missing"),
            )
        )
    for old, now in zip(before, buffers(machine.framebuffer), strict=True):
        np.testing.assert_array_equal(old, now)
    assert machine.textures == names


def test_what_is_kept_of_a_state_does_not_reach_where_it_does_not_hold():
    """One state, packed for other vertices, textures, depths and surfaces: as if it had been a new one."""
    depth_test = DepthTest(ComparisonFunction.LEQUAL)
    draw = textured("t", Sampler(TextureFilter.LINEAR, TextureFilter.LINEAR), depth_test=depth_test)
    state = replace(
        draw.state,
        register_combiners=replace(
            SHOW_TEXTURE, final=replace(SHOW_TEXTURE.final, d=CombinerInput(Register.PRIMARY_COLOR))
        ),
        polygon=PolygonState(offset_fill=True, offset_units=2.0),
    )
    q = np.array([[0.0, 0.0, 0.0, 1.0], [2.0, 0.0, 0.0, 2.0], [0.0, 1.0, 0.0, 0.5]])
    meshes = (
        draw.mesh,
        replace(draw.mesh, colors=np.eye(3) / 3),
        replace(draw.mesh, texture_coordinates=(q,)),
        replace(draw.mesh, positions=CORNERS / 2),
        replace(draw.mesh, primitive=PrimitiveType.POINTS),
    )
    images = (
        texture_2d(np.random.default_rng(3).integers(0, 256, (8, 8, 4)).astype(np.uint8), mipmaps=True),
        texture_1d(np.arange(64, dtype=np.uint8).reshape(16, 4)),
        texture_cube_map(np.random.default_rng(4).integers(0, 256, (6, 4, 4, 4)).astype(np.uint8)),
    )
    pictures = set()
    for _ in range(2):
        for size in ((WIDTH, HEIGHT), (WIDTH + 3, HEIGHT), (WIDTH, HEIGHT + 3)):
            for depth_bits in (16, 24):
                for image in images:
                    store = TexImage(label="t", texture="t", image=image)
                    # Every command twice: within a run more is kept.
                    commands = (store, *[Draw(label="d", mesh=m, state=state) for m in meshes]) * 2
                    fresh = (store, *[Draw(label="d", mesh=m, state=deepcopy(state)) for m in meshes]) * 2
                    kept = run(*commands, size=size, depth_bits=depth_bits, trace=True).trace
                    made = run(*fresh, size=size, depth_bits=depth_bits, trace=True).trace
                    for a, b in zip(kept, made, strict=True):
                        assert_same_buffers(a, b)
                        pictures.add(b"".join(b.tobytes() for b in buffers(a)))
    assert len(pictures) > 60


def test_a_draw_that_is_repeated_finds_the_texture_and_the_surface_that_are_there():
    """What a run keeps of a Draw for its repetition ends with another texture of the name, or surface."""
    show, seen = textured("t"), []
    commands = []
    for n in (11, 22, 11):
        commands += [TexImage(label="t", texture="t", image=solid(n)), show, show]
        commands.append(ReadPixels(label="r", name=str(len(commands))))
    pbuffer = MakeCurrent(label="p", surface="p", width=5, height=9)
    commands += [pbuffer, show, ReadPixels(label="r", name="p")]
    commands += [
        CopyTexImage(label="c", texture="t", width=4, height=4),
        TexImage(label="t", texture="t", image=solid(33)),
        show,
        ReadPixels(label="r", name="q"),
        MakeCurrent(label="w"),
        ReadPixels(label="r", name="w"),
    ]
    result = execute(commands, NV2A, WIDTH, HEIGHT)
    for name, pixels in result.pixels.items():
        assert (pixels == pixels.reshape(-1)[0]).all(), name
        seen.append(int(pixels.reshape(-1)[0]))
    assert seen == [11, 22, 11, 11, 33, 11]
    assert result.fragments == 6 * WIDTH * HEIGHT + 2 * 5 * 9


def test_a_result_can_be_kept_while_the_machine_goes_on():
    machine = Machine(GEFORCE_256, WIDTH, HEIGHT)
    first = machine.run((TexImage(label="t", texture="t", image=solid(1)), flood(30)))
    image = first.image()
    machine.run((TexImage(label="u", texture="u", image=solid(2)), flood(90)))
    assert set(first.textures) == {"t"}
    assert (image[..., 0] == 30).all() or (image[..., 0] == 29).all()  # 14 significant bits may lose one


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"threads": 0}, "0 threads cannot draw"),
        ({"threads": 1.5}, "1.5 threads cannot draw"),
        ({"batch": 15}, "A batch of 15"),
        ({"batch": 4097}, "A batch of 4097"),
        ({"batch": 64.5}, "A batch of 64.5"),
        ({"depth_bits": 24.0}, "depth_bits is 24.0"),
        ({"depth_bits": 32}, "32 bits of depth; GeForce 256 has 16 or 24"),
        ({"width": 0}, "0x8; give at least 1x1"),
        ({"width": 2049}, "2049x8"),
        ({"profile": IDEAL}, "execute_ideal"),
    ],
)
def test_a_machine_that_cannot_be_built_says_why(options, sentence):
    with pytest.raises(ValueError, match=sentence):
        Machine(**{"profile": GEFORCE_256, "width": 8, "height": 8, **options})


def test_textures_that_a_machine_is_given_are_checked_too():
    floats = Texture(TextureTarget.TEXTURE_2D, InternalFormat.RGBA8, (np.zeros((1, 4, 4, 4)),))
    for image, sentence in ((floats, "not uint8"), (solid(1, 5, 3), "powers of two"), ("t", "type Texture")):
        machine = Machine(GEFORCE_256, WIDTH, HEIGHT, textures={"t": image})
        with pytest.raises(UnsupportedState, match=f"Texture 't', which the machine holds: .*{sentence}"):
            machine.run((textured("t"),))


# ---------------------------------------------------------------------------------------------------- threads


def scene(seed):
    return (
        Clear(label="clear", color=color_of(seed), depth=1.0),
        triangles(12, seed=seed),
        CopyTexImage(label="copy", texture="t", width=128, height=128),
        textured("t", blending=Blending(BlendFactor.ONE, BlendFactor.ONE)),
    )


def test_machines_in_several_python_threads_draw_what_one_draws():
    size, seeds = (PARALLEL, PARALLEL), range(4)
    expected = [run(*scene(seed), size=size, threads=1).framebuffer for seed in seeds]
    with ThreadPoolExecutor(4) as pool:
        jobs = [(seed, pool.submit(run, *scene(seed), size=size, threads=2)) for seed in [*seeds] * 5]
        for seed, job in jobs:
            assert_same_buffers(job.result().framebuffer, expected[seed])


def test_runs_of_one_machine_from_several_threads_follow_each_other(monkeypatch):
    machine = Machine(GEFORCE_256, WIDTH, HEIGHT, threads=1, engine="portable")
    clear, running = machine.framebuffer.clear, machine._running
    first_is_in, second_is_there = threading.Event(), threading.Event()

    class Turn:
        """The machine's lock; it says when the second thread comes to it."""

        def __enter__(self):
            if first_is_in.is_set():
                second_is_there.set()
            return running.__enter__()

        def __exit__(self, *error):
            return running.__exit__(*error)

    def interrupted_clear(command):
        clear(command)
        if not first_is_in.is_set():
            first_is_in.set()
            assert second_is_there.wait(HANGS)
        else:
            second_is_there.set()  # a machine without turns comes here while the first thread waits

    monkeypatch.setattr(machine, "_running", Turn())
    monkeypatch.setattr(machine.framebuffer, "clear", interrupted_clear)

    def read_what_was_cleared(n):
        commands = (Clear(label="c", color=color_of(n)), ReadPixels(label="r", name="r"))
        return machine.run(commands).pixels["r"]

    with ThreadPoolExecutor(2) as pool:
        first = pool.submit(read_what_was_cleared, 1)
        assert first_is_in.wait(HANGS)
        second = pool.submit(read_what_was_cleared, 2)
        for n, job in enumerate((first, second), 1):
            assert (job.result() == [n, n + 1, n + 2, n + 3]).all()


def is_drawing_thread(thread=None):
    return (thread or threading.current_thread()).name.startswith("fixedpipe")


def drawing_threads():
    return [t for t in threading.enumerate() if is_drawing_thread(t)]


def test_threads_end_with_their_machine():
    before, started = set(drawing_threads()), set()
    for _ in range(100):
        machine = Machine(GEFORCE_256, PARALLEL, PARALLEL, threads=3)
        machine.run((flood(7),))
        started |= set(drawing_threads()) - before
    del machine
    assert len(started) == 200  # two beside the caller's
    for thread in started:
        thread.join(HANGS)
        assert not thread.is_alive()


def test_no_more_threads_start_than_there_are_bands():
    machine = Machine(GEFORCE_256, PARALLEL, PARALLEL, threads=10_000)
    before = set(drawing_threads())
    machine.run((flood(7),))
    bands = -(-PARALLEL // BAND_HEIGHT)
    assert len(set(drawing_threads()) - before) <= bands - 1


def test_small_frames_start_no_threads():
    before = set(drawing_threads())
    machine = Machine(GEFORCE_256, WIDTH, HEIGHT, threads=8)
    machine.run(mixed_commands())
    assert set(drawing_threads()) <= before


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system cannot fork")
def test_a_machine_draws_on_in_a_forked_process():
    machine = Machine(GEFORCE_256, PARALLEL, PARALLEL, threads=2)
    machine.run(scene(1))  # its threads run, and a fork leaves them behind
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # newer Pythons warn that threads stay behind
        child = os.fork()
    if child == 0:
        same = False
        try:
            signal.alarm(int(HANGS))  # ends a child that waits for threads that it does not have
            again = machine.run(scene(1)).framebuffer.color
            same = bool(
                (again == run(*scene(1), size=(PARALLEL, PARALLEL), threads=1).framebuffer.color).all()
            )
        finally:
            os._exit(0 if same else 1)
    _, status = os.waitpid(child, 0)
    assert os.waitstatus_to_exitcode(status) == 0


KERNELS = [("portable", (draw_module, "draw_bands")), (None, (queue, "draw_frame"))]


@pytest.mark.parametrize(("engine", "kernel"), KERNELS)
def test_an_exception_in_a_drawing_thread_reaches_the_caller(monkeypatch, engine, kernel):
    machine = Machine(GEFORCE_256, PARALLEL, PARALLEL, threads=2, engine=engine)
    draw = getattr(*kernel)

    def failing(*arguments):
        if is_drawing_thread():
            raise MemoryError("no room for a batch")
        return draw(*arguments)

    monkeypatch.setattr(*kernel, failing)
    with pytest.raises(MemoryError, match="no room"):
        machine.run((flood(7),))
    monkeypatch.undo()
    machine.run(scene(2))
    assert_same_buffers(machine.framebuffer, run(*scene(2), size=(PARALLEL, PARALLEL)).framebuffer)


@pytest.mark.parametrize(("engine", "kernel"), KERNELS)
def test_when_a_run_fails_no_thread_draws_on(monkeypatch, engine, kernel):
    machine = Machine(GEFORCE_256, PARALLEL, PARALLEL, threads=2, engine=engine)
    finished, may_finish = [], threading.Event()

    class Inbox(SimpleQueue):
        def get(self):
            if not is_drawing_thread():
                may_finish.set()  # the caller waits for the others, as it must
            return super().get()

    def failing(*arguments):
        if not is_drawing_thread():
            raise MemoryError("no room for a batch")
        assert may_finish.wait(HANGS)
        finished.append(True)
        return 0

    monkeypatch.setattr(threads_module, "SimpleQueue", Inbox)
    monkeypatch.setattr(*kernel, failing)
    try:
        with pytest.raises(MemoryError, match="no room"):
            machine.run((flood(7),))
        assert finished == [True]
    finally:
        may_finish.set()


@pytest.mark.parametrize("engine", ENGINES)
def test_what_comes_before_an_error_is_drawn(monkeypatch, engine):
    machine = Machine(GEFORCE_256, WIDTH, HEIGHT, engine=engine)

    def failing(way):
        def first(mesh, *others, **named):
            if len(mesh.positions) > 3:
                raise MemoryError("no room for vertices")
            return way(mesh, *others, **named)

        return first

    for module, name in ((stage, "process"), (state_records, "mesh_columns")):
        monkeypatch.setattr(module, name, failing(getattr(module, name)))
    with pytest.raises(MemoryError, match="no room for vertices"):
        machine.run((Clear(label="c", depth=0.5), flood(30), triangles(2), flood(90)))
    monkeypatch.undo()
    expected = run(Clear(label="c", depth=0.5), flood(30)).framebuffer
    assert_same_buffers(machine.framebuffer, expected)
    machine.run((triangles(9),))  # and nothing of the failed run waits
    twin = Machine(GEFORCE_256, WIDTH, HEIGHT)
    twin.run((Clear(label="c", depth=0.5), flood(30), triangles(9)))
    assert_same_buffers(machine.framebuffer, twin.framebuffer)


# ------------------------------------------------------------------------------- the queue and the engines


def fogged(draw):
    """The same Draw with fog, which not every engine covers."""
    return replace(draw, state=replace(draw.state, fog=Fog(color=color_of(60), density=0.4)))


def long_frame():
    """More commands than a queue begins with room for, of every kind that it takes, in turn."""
    clear = Clear(label="c", color=color_of(60), stencil=1, scissor=Scissor(20, 30, 90, 40))
    masked = Clear(
        label="m",
        color=color_of(200),
        depth=0.25,
        stencil=0xFF,
        scissor=Scissor(-5, 70, 100, 500),
        color_mask=ColorMask(True, False, False, True),
        stencil_write_mask=0x3C,
    )
    counted = flood(3, stencil_test=StencilTest(depth_pass=StencilOperation.INCR), blending=ADDED)
    read = [ReadPixels(label="r", name=f"r{k}", format=f) for k, f in enumerate(("RGBA", "STENCIL_INDEX"))]
    commands = [Clear(label="all", color=color_of(9), depth=1.0, stencil=7), triangles(8)]
    for k in range(30):
        commands += [clear, triangles(5, seed=k), masked, counted, counted]
        if k % 7 == 3:
            commands += [fogged(triangles(4, seed=k)), fogged(flood(7, blending=ADDED)), clear]
        if k % 11 == 5:
            copy = CopyTexImage(label="copy", texture="t", x=16, y=32, width=128, height=64)
            commands += [copy, textured("t", scissor=Scissor(0, 0, 128, 100))]
        if k % 14 == 7:
            commands.append(read.pop())
    return tuple(commands)


ADDED = Blending(BlendFactor.ONE, BlendFactor.ONE)


def test_a_queue_draws_what_one_command_after_the_other_draws(monkeypatch):
    commands, size = long_frame(), (PARALLEL, PARALLEL)
    one_by_one = run(*commands, size=size, threads=1, engine="portable", trace=True)
    ways = [{"engine": e, "threads": t} for e in ENGINES for t in (1, 2, 5)]
    results = [run(*commands, size=size, **way) for way in ways]
    results.append(run(*commands, size=size, trace=True))
    for before, after in zip(one_by_one.trace, results[-1].trace, strict=True):
        assert_same_buffers(before, after)
    monkeypatch.setattr(queue, "_MOST_BYTES", 2000)  # some meshes are more: drawn at once, not kept
    results += [run(*commands, size=size, **way) for way in ways[::2]]
    for result in results:
        assert_same_buffers(result.framebuffer, one_by_one.framebuffer)
        assert (result.fragments, result.dropped) == (one_by_one.fragments, one_by_one.dropped)
        for name, pixels in one_by_one.pixels.items():
            np.testing.assert_array_equal(result.pixels[name], pixels)


def test_an_engine_that_there_is_not_is_refused():
    for engine in ("vector", "Portable", "", 1):
        with pytest.raises(ValueError, match=f'no engine {engine!r}; give "portable"'):
            run(flood(3), engine=engine)


@pytest.mark.parametrize("order", [(0, 1, 2, 3), (3, 2, 1, 0), (2, 0, 3, 1)])
def test_threads_all_end_and_the_callers_error_is_raised(order):
    threads, ended, may_end = Threads(4), [], [threading.Event() for _ in order]

    def failing(k):
        assert may_end[k].wait(HANGS)
        ended.append(k)
        for after in order[len(ended) :][:1]:
            may_end[after].set()
        raise ValueError(f"share {k}")

    may_end[order[0]].set()
    with pytest.raises(ValueError, match="share 0"):
        threads.run(failing)
    assert ended == list(order)
    assert threads.run(lambda k: k) == 6  # and they go on


def test_threads_add_up_and_raise_what_one_share_raises():
    threads, ended = Threads(4), []

    def failing(k):
        if k == 2:
            raise ValueError("share 2")
        ended.append(k)
        return k

    for _ in range(50):
        assert threads.run(lambda k: 10**k) == 1111
    with pytest.raises(ValueError, match="share 2"):
        threads.run(failing)
    assert sorted(ended) == [0, 1, 3]


def test_threads_keep_nothing_of_what_they_did(monkeypatch):
    class Kept:
        pass

    class Inbox(SimpleQueue):
        def get(self):
            if is_drawing_thread():
                waits.release()
            return super().get()

    waits = threading.Semaphore(0)
    monkeypatch.setattr(threads_module, "SimpleQueue", Inbox)
    threads, kept = Threads(2), Kept()
    alive = weakref.ref(kept)
    threads.run(lambda k, kept=kept: k)
    del kept
    for _ in ("for this work", "for the next"):
        assert waits.acquire(timeout=HANGS)
    assert alive() is None


# ----------------------------------------------------------------------------------------------------- arrays


def test_any_array_will_do_whatever_its_order_or_flags():
    random = np.random.default_rng(5)
    positions, colors, coordinates = random.random((9, 3)) - 0.5, random.random((9, 4)), random.random((9, 2))
    indices = np.arange(9)[::-1].copy()
    texels = random.integers(0, 256, (8, 4, 4)).astype(np.uint8)

    def frame(convert):
        draw = textured("t")
        mesh = Mesh(
            convert(positions),
            indices=convert(indices),
            colors=convert(colors),
            texture_coordinates=(convert(coordinates),),
        )
        image = texture_2d(convert(texels), mipmaps=True)
        return run(TexImage(label="t", texture="t", image=image), replace(draw, mesh=mesh)).framebuffer

    def every_second(array):
        wide = np.zeros((*array.shape[:-1], 2 * array.shape[-1]), array.dtype)
        wide[..., ::2] = array
        return wide[..., ::2]

    def read_only(array):
        array = array.copy()
        array.setflags(write=False)
        return array

    expected = frame(np.copy)
    assert expected.color.any()
    for convert in (np.asfortranarray, every_second, read_only, lambda a: a[::-1].copy()[::-1]):
        assert_same_buffers(frame(convert), expected)


def test_levels_that_lie_anyhow_in_memory_are_read_as_they_are():
    texels = np.random.default_rng(6).integers(0, 256, (1, 8, 4, 4)).astype(np.uint8)
    turned = np.asfortranarray(texels)[:, ::-1][:, ::-1]
    turned.setflags(write=False)
    frames = [
        run(TexImage(label="t", texture="t", image=image), textured("t")).framebuffer
        for image in (Texture(TextureTarget.TEXTURE_2D, InternalFormat.RGBA8, (a,)) for a in (texels, turned))
    ]
    assert_same_buffers(*frames)
    assert len(np.unique(frames[0].color.reshape(-1, 4), axis=0)) == 32


def test_a_texture_of_one_level_is_drawn_from_its_own_memory():
    image = solid(50, 8, 8)
    texels = texels_of(image, 0)
    assert np.shares_memory(texels.packed, image.levels[0])
    assert texels.packed.flags.writeable  # as kernels ask for
    for other in (texels_of(image, 0x80), texels_of(solid(50, mipmaps=True), 0)):
        assert not np.shares_memory(other.packed, image.levels[0])
    packed, alive = texels.packed, weakref.ref(image)
    before = packed.copy()
    del image, texels, other
    gc.collect()
    assert alive() is None  # nothing that is kept of a texture keeps it
    np.testing.assert_array_equal(packed, before)


# --------------------------------------------------------------------------------------------------- extremes


def with_positions(positions, coordinates=None, **state):
    """A textured Draw with depth of the given positions."""
    positions = np.array(positions, np.float64)
    count = len(positions)
    if coordinates is None:
        coordinates = np.random.default_rng(8).uniform(-2.0, 2.0, (count, 2))
    units = (TextureUnit("t", Sampler(TextureFilter.LINEAR_MIPMAP_LINEAR, TextureFilter.LINEAR)),)
    mesh = Mesh(
        positions, colors=np.linspace(0, 1, 4 * count).reshape(count, 4), texture_coordinates=(coordinates,)
    )
    state = {"depth_test": DepthTest(ComparisonFunction.LEQUAL), "register_combiners": SHOW_TEXTURE, **state}
    return Draw(label="extreme", mesh=mesh, state=PassState(texture_units=units, **state))


NOISE = texture_2d(np.random.default_rng(9).integers(0, 256, (8, 4, 4)).astype(np.uint8), mipmaps=True)
STORE_NOISE = TexImage(label="noise", texture="t", image=NOISE)
BIG = np.array([[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]])


def in_perspective(*w):
    """The screen-filling triangle at these clip w."""
    w = np.array(w)[:, None]
    return np.concatenate([BIG * w, np.zeros((3, 1)), w], -1)


POSITIONS = {
    "one vertex at 1e38": [[-1e38, -1.0], [3.0, -1.0], [-1.0, 3.0]],
    "all vertices at 1e38": BIG * 1e38,
    "all vertices at 1e308": BIG * 5e307,
    "denormal": BIG * 5e-324,
    "a sliver a million pixels long": [[-1e5, 0.0, 0.0], [1e5, 0.02, 0.5], [1e5, 0.5, 1.0]],
    "on the guard band": [[-820.0, -1.0], [820.0, -1.0], [0.0, 1180.0]],
    "behind the eye": in_perspective(-1.0, -2.0, -3.0),
    "through the eye": in_perspective(1.0, 1.0, -1.0),
    "at the eye": in_perspective(0.0, 1.0, 1.0),
    "w of 1e-100 and 1e100": in_perspective(1e-100, 1.0, 1e100),
    "w of 1e-30 and 1e30": in_perspective(1e-30, 1.0, 1e30),
    "w of 1e100": in_perspective(1e100, 1e100, 2e100),
    "no area": [[0.0, 0.0], [1.0, 1.0], [0.5, 0.5]],
    "one point": [[0.3, 0.3]] * 3,
    "depth at its ends": [[-1.0, -1.0, -1.0], [3.0, -1.0, 1.0], [-1.0, 3.0, 1.0]],
}


@pytest.mark.parametrize("what", POSITIONS)
@pytest.mark.parametrize("size", [(WIDTH, HEIGHT), (1, 1)])
def test_extreme_positions_give_what_the_specification_gives(what, size):
    assert_like_the_reference((STORE_NOISE, with_positions(POSITIONS[what])), *size)


def test_extreme_positions_do_draw_where_they_should():
    drawn = {what: run(STORE_NOISE, with_positions(p)).fragments for what, p in POSITIONS.items()}
    nothing = {"denormal", "behind the eye", "no area", "one point"}
    assert {what for what, count in drawn.items() if count == 0} >= nothing
    for what in ("on the guard band", "w of 1e-30 and 1e30", "w of 1e100", "depth at its ends"):
        assert drawn[what] == WIDTH * HEIGHT, what


@pytest.mark.parametrize("w", [1e-300, 1e-150, 1e150, 1e300])
def test_a_triangle_with_an_extraordinary_w_is_dropped_and_counted(w):
    result = run(STORE_NOISE, with_positions(in_perspective(w, w, w)))
    assert (result.fragments, result.dropped) == (0, 1)


@pytest.mark.parametrize("w", [0.3, 17.0, 23.0, 47.0])
def test_a_triangle_of_one_w_takes_the_levels_of_an_affine_one(w):
    # Two texels a pixel: lambda is exactly one. Biased by -127/256 it still reads level 1, and the next lower
    # lambda, which weights rounded at another scale would give, level 0.
    sampler = Sampler(TextureFilter.NEAREST_MIPMAP_NEAREST, TextureFilter.NEAREST)
    unit = TextureUnit("t", sampler, lod_bias=-127 / 256)

    def picture(positions):
        draw = with_positions(positions, (BIG + 1.0) / 2.0)
        draw = replace(draw, state=replace(draw.state, texture_units=(unit,)))
        return run(STORE_NOISE, draw, size=(2, 4)).framebuffer.color

    in_space = np.concatenate([BIG * w, np.zeros((3, 1)), np.full((3, 1), w)], axis=-1)
    level_1 = NOISE.levels[1][0, ::-1]  # a texel a pixel
    np.testing.assert_array_equal(picture(BIG), level_1)
    np.testing.assert_array_equal(picture(in_space), level_1)


@pytest.mark.parametrize("value", [1e38, 1e300, -1e300, 1.7e308, 5e-324, -5e-324, -0.0])
@pytest.mark.parametrize("wrap", WrapMode)
def test_extreme_texture_coordinates_give_what_the_specification_gives(value, wrap):
    for filters in (
        (TextureFilter.NEAREST, TextureFilter.LINEAR),
        (TextureFilter.LINEAR_MIPMAP_NEAREST,) * 2,
    ):
        for coordinates in (
            [[value, 0.5], [0.5, value], [-value, 0.25]],
            [[value, value]] * 3,
            [[value, 0.5, 0.0, value], [0.5, 1.0, 0.0, 1.0], [1.0, value, 0.0, -1.0]],
        ):
            draw = with_positions(BIG, np.array(coordinates))
            sampler = Sampler(filters[0], TextureFilter(filters[1] & 1), wrap_s=wrap, wrap_t=wrap)
            draw = replace(draw, state=replace(draw.state, texture_units=(TextureUnit("t", sampler),)))
            assert_like_the_reference((STORE_NOISE, draw), 8, 6)


def test_a_footprint_that_is_no_number_on_one_side_only_takes_the_smallest_level():
    # Below the block's origin the triangle's plane is nearly seen edge on: s and q overflow there, s/q is no
    # number, and the step to the right is an ordinary one. Lambda is then the largest.
    pixels = np.array([[9.0, -16.0], [-44.0, 23.0], [40.0, 22.0]]) / 16.0
    w = np.array([[0.040488244596606535], [1.0], [1.0]])
    positions = np.concatenate([(pixels / 4.0 - 1.0) * [1.0, -1.0] * w, 0.0 * w, w], -1)
    coordinates = np.array(
        [[1e304, 0.5e303, 0.0, 1e303], [-1e304, 0.25e303, 0.0, -1e303], [0.5e304, 0.1e303, 0.0, 0.3e303]]
    )
    texels = np.random.default_rng(0).integers(0, 256, (64, 64, 4)).astype(np.uint8)
    store = TexImage(label="t", texture="t", image=texture_2d(texels, mipmaps=True))
    result = assert_like_the_reference((store, with_positions(positions, coordinates)), 8, 8)
    smallest = store.image.levels[-1][0, 0, 0]
    assert (result.framebuffer.color[0, 0] == smallest).all()


@pytest.mark.parametrize("shape", [(1, 2048), (2048, 1), (1, 1), (2, 1024)])
@pytest.mark.parametrize("wrap", [WrapMode.REPEAT, WrapMode.CLAMP, WrapMode.MIRRORED_REPEAT])
def test_long_and_tiny_textures_give_what_the_specification_gives(shape, wrap):
    texels = np.random.default_rng(4).integers(0, 256, (*shape, 4)).astype(np.uint8)
    image = texture_2d(texels, mipmaps=True)
    sampler = Sampler(TextureFilter.LINEAR_MIPMAP_LINEAR, TextureFilter.NEAREST, wrap_s=wrap, wrap_t=wrap)
    store = TexImage(label="t", texture="t", image=image)
    assert_like_the_reference((store, textured("t", sampler)), 9, 7)
    assert_like_the_reference(
        (store, textured("t", replace(sampler, mag_filter=TextureFilter.LINEAR))), 7, 40
    )


def test_a_long_1d_texture_gives_what_the_specification_gives():
    image = texture_1d(np.random.default_rng(4).integers(0, 256, (2048, 4)).astype(np.uint8), mipmaps=True)
    sampler = Sampler(TextureFilter.LINEAR_MIPMAP_LINEAR, TextureFilter.LINEAR)
    commands = (TexImage(label="t", texture="t", image=image), textured("t", sampler))
    assert_like_the_reference(commands, 64, 5)


@pytest.mark.parametrize("size", [(1, 1), (2048, 1), (1, 2048), (33, 65)])
@pytest.mark.parametrize("batch", [16, 4096])
def test_framebuffers_of_any_shape_are_filled_once(size, batch):
    additive = Blending(BlendFactor.ONE, BlendFactor.ONE)
    result = run(flood(100, blending=additive), triangles(8), size=size, batch=batch)
    assert_same_buffers(result.framebuffer, run(flood(100), triangles(8), size=size, batch=1000).framebuffer)
    assert result.framebuffer.color.shape == (size[1], size[0], 4)
    first = run(flood(100, blending=additive), size=size, batch=batch)
    assert (first.framebuffer.color == [100, 101, 102, 103]).all()
    assert first.fragments == size[0] * size[1]


@pytest.mark.parametrize(
    "viewport",
    [
        Viewport(0, 0, 0, 0),
        Viewport(-1000, -1000, 2048, 2048),
        Viewport(3, 2, 1, 1),
        Viewport(2**31 - 1, 0, 4, 4),
        Viewport(-(2**31), -(2**31), 2048, 2048),
        Viewport(0, 0, 2048, 2048, 1.0, 0.0),
        Viewport(0, 0, None, None, 0.5, 0.5),
    ],
)
def test_viewports_larger_than_the_screen_or_beside_it(viewport):
    draw = with_positions([[-1.0, -1.0, -0.5], [3.0, -1.0, 0.0], [-1.0, 3.0, 0.9]])
    draw = replace(draw, state=replace(draw.state, vertex=VertexState(viewport=viewport)))
    assert_like_the_reference((STORE_NOISE, draw), WIDTH, HEIGHT)


@pytest.mark.parametrize("primitive", POLYGONS)
@pytest.mark.parametrize("count", [0, 1, 2, 3])
def test_meshes_with_few_or_no_vertices(primitive, count):
    result = run(Draw(label="d", mesh=Mesh(CORNERS[:count], primitive), state=PassState()))
    complete = count == 3 and primitive not in (PrimitiveType.QUADS, PrimitiveType.QUAD_STRIP)
    assert result.fragments == (WIDTH * HEIGHT if complete else 0)


def test_nothing_is_drawn_where_every_triangle_is_culled():
    draw = triangles(9)
    draw = replace(draw, state=replace(draw.state, polygon=PolygonState(cull_face=Face.FRONT_AND_BACK)))
    result = run(draw, record=True)
    assert (result.fragments, result.dropped, len(result.records[0].x)) == (0, 0, 0)
    assert not result.framebuffer.color.any()


def test_a_long_index_list_draws_every_triangle():
    draw = Draw(
        label="d",
        mesh=Mesh(CORNERS, indices=np.tile([0, 1, 2], 4096), colors=[(1 / 255 + 1e-4,) * 4] * 3),
        state=PassState(blending=Blending(BlendFactor.ONE, BlendFactor.ONE), scissor=Scissor(0, 0, 2, 1)),
    )
    result = run(draw)
    assert result.fragments == 2 * 4096
    assert (result.framebuffer.color[-1, :2] == 255).all()
    assert (
        run(replace(draw, mesh=replace(draw.mesh, indices=np.tile([0, 1, 2], 200)))).framebuffer.color[-1, :2]
        == 200
    ).all()


def window_primitives(random, vertices, count, width, height):
    """Columns of random bytes, near the screen now and then: what no vertex stage would hand over."""

    def column(dtype, *shape):
        size = int(np.prod(shape)) * np.dtype(dtype).itemsize
        return np.frombuffer(random.bytes(size), dtype).reshape(shape).copy()

    def positions(extent):
        near = random.integers(-64, 16 * extent + 64, vertices)
        return np.where(random.random(vertices) < 0.7, near, column(np.int32, vertices)).astype(np.int32)

    inverse_w = np.where(
        random.random(vertices) < 0.8, 2.0 ** random.uniform(-399, 399, vertices), column(float, vertices)
    )
    named = random.integers(-2, vertices + 2, (count, 4))
    return WindowPrimitives(
        x=positions(width),
        y=positions(height),
        z=column(float, vertices),
        inverse_w=inverse_w,
        colors=column(np.uint8, vertices, 2, 8),
        coordinates=column(float, vertices, 2, 4),
        fog=column(float, vertices),
        triangles=np.where(random.random((count, 4)) < 0.97, named % vertices, named).astype(np.int32),
        dropped=0,
        two_side=True,
    )


def draw_random_bytes(monkeypatch, seeds):
    """Draw primitives of random bytes into a framebuffer that lies between rows which must stay untouched."""
    width, height, margin = 37, 45, 8
    sampler = Sampler(TextureFilter.LINEAR_MIPMAP_LINEAR, TextureFilter.NEAREST)
    units = (TextureUnit("t", sampler), TextureUnit("c", sampler))
    cube = texture_cube_map(
        np.random.default_rng(1).integers(0, 256, (6, 4, 4, 4)).astype(np.uint8), mipmaps=True
    )
    both = RegisterCombiners(final=replace(SHOW_TEXTURE.final, d=CombinerInput(Register.TEXTURE1)))
    stencil = StencilTest(ComparisonFunction.GREATER, 3, depth_pass=StencilOperation.INCR_WRAP)
    fragments = dropped = 0
    monkeypatch.setattr(state_records.StateRecord, "submitted", lambda *_: None)  # these come from no mesh
    for seed in seeds:
        random = np.random.default_rng(seed)
        primitives = window_primitives(random, 24, 40, width, height)
        monkeypatch.setattr(stage, "process", lambda *_, given=primitives, rounded: given)
        machine = Machine(GEFORCE_256, width, height, batch=16, threads=1)
        whole = [
            np.full((height + 2 * margin, *b.shape[1:]), 9, b.dtype) for b in buffers(machine.framebuffer)
        ]
        for name, buffer in zip(("color", "depth", "stencil"), whole, strict=True):
            setattr(machine.framebuffer, name, buffer[margin : margin + height])
        box = Scissor(3, 4, 30, 31)
        state = PassState(
            texture_units=units,
            register_combiners=both,
            depth_test=DepthTest(ComparisonFunction.NOTEQUAL),
            stencil_test=stencil,
            blending=Blending(BlendFactor.SRC_ALPHA, BlendFactor.ONE),
            scissor=box,
        )
        mesh = Mesh(CORNERS, texture_coordinates=(CORNERS, np.zeros((3, 3))))
        result = machine.run(
            (
                STORE_NOISE,
                TexImage(label="c", texture="c", image=cube),
                Draw(label="random bytes", mesh=mesh, state=state),
            )
        )
        fragments, dropped = fragments + result.fragments, dropped + result.dropped
        rows = slice(margin + height - 35, margin + height - 4)
        for buffer in whole:
            buffer[rows, 3:33] = 9
            assert (buffer == 9).all()
    return fragments, dropped


def test_columns_of_random_bytes_touch_nothing_beside_the_scissor_box(monkeypatch):
    fragments, dropped = draw_random_bytes(monkeypatch, range(40))
    assert fragments > 10_000
    assert dropped > 100  # indices out of range, 1/w that are no positive ordinary numbers


@pytest.mark.slow
def test_thousands_of_columns_of_random_bytes_touch_nothing_beside_the_scissor_box(monkeypatch):
    fragments, _ = draw_random_bytes(monkeypatch, range(100, 4100))
    assert fragments > 1_000_000


magnitudes = st.sampled_from(
    [0.0, 5e-324, 1e-308, 1e-30, 0.5, 1.0, 3.0, 1e4, 1e15, 1e38, 1e154, 1e300, 1.7e308]
)
signed = st.builds(
    lambda m, sign, f: m * sign * f, magnitudes, st.sampled_from([1.0, -1.0]), st.floats(0.5, 1.0)
)
ordinary_or_not = st.one_of(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0), signed)


def test_a_coordinate_that_the_target_has_not_takes_no_part_in_the_level_of_detail():
    positions = [(-1.0, -1.0, 0.0, 1.0), (1.0, -1.0, 0.0, 1.0), (0.0, 1.0, 0.0, 1.0)]
    coordinates = [(0.0, 0.0, 1.7e308, 1.0), (0.7, 0.0, -1.7e308, 1.0), (0.3, 0.4, 1.7e308, 1.0)]
    draw = with_positions(positions, np.array(coordinates))
    sampler = Sampler(TextureFilter.NEAREST, TextureFilter.LINEAR)
    draw = replace(draw, state=replace(draw.state, texture_units=(TextureUnit("t", sampler),)))
    store = TexImage(label="t", texture="t", image=NOISE)
    assert_like_the_reference((store, draw), 8, 6, 24, batch=16)


@pytest.mark.slow
@settings(max_examples=1500)
@given(
    st.lists(st.tuples(*[ordinary_or_not] * 3, st.floats(0.01, 3.0) | signed), min_size=3, max_size=6),
    st.lists(st.tuples(*[ordinary_or_not] * 4), min_size=6, max_size=6),
    st.sampled_from(POLYGONS),
    st.sampled_from(TextureFilter),
    st.sampled_from(WrapMode),
    st.sampled_from([16, 24]),
    st.booleans(),
)
def test_random_extremes_give_what_the_specification_gives(
    positions, coordinates, primitive, minification, wrap, depth_bits, cube
):
    draw = with_positions(positions, np.array(coordinates[: len(positions)]))
    sampler = Sampler(minification, TextureFilter.LINEAR, wrap_s=wrap, wrap_t=wrap)
    polygon = PolygonState(offset_fill=True, offset_factor=1e300, offset_units=-3.0)
    state = replace(draw.state, polygon=polygon, texture_units=(TextureUnit("t", sampler),))
    draw = replace(draw, mesh=replace(draw.mesh, primitive=primitive), state=state)
    image = NOISE
    if cube:
        image = texture_cube_map(np.arange(6 * 16 * 4, dtype=np.uint8).reshape(6, 4, 4, 4), mipmaps=True)
    store = TexImage(label="t", texture="t", image=image)
    assert_like_the_reference((store, draw), 8, 6, depth_bits, batch=16)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize(("profile", "word"), [(NV2A, 101), (GEFORCE_256, 100)])
def test_an_offsets_fraction_counts_where_the_machine_keeps_it(profile, word, engine):
    # A depth of 100.75 to 100.77 units, so that the offset's half reaches the next word.
    z = np.array([100.75, 100.77, 100.75]) * 2 / 65535 - 1
    mesh = Mesh(np.column_stack([CORNERS, z]))
    polygon = PolygonState(offset_fill=True, offset_units=0.5)
    state = PassState(depth_test=DepthTest(ComparisonFunction.ALWAYS), polygon=polygon)
    draw = Draw(label="offset", mesh=mesh, state=state)
    result = execute((draw,), profile, 4, 4, depth_bits=16, engine=engine)
    assert (result.framebuffer.depth == word).all()
