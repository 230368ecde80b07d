"""The vector engine's per-fragment operations equal the portable kernels', run by run and pixel by pixel."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fixedpipe.pipeline.enums import BlendFactor, ColorFormat, ComparisonFunction, StencilOperation
from fixedpipe.pipeline.framebuffers.framebuffer import SURFACE_WORDS
from fixedpipe.pipeline.native.pack_fragments import _FACTOR_TERMS, _pack_factor, _pack_stencil_operation
from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import Buffers, Runs, State
from fixedpipe.raster.portable.per_fragment import per_fragment
from fixedpipe.raster.vector import per_fragment as V

WIDTH, HEIGHT, BATCH = 200, 6, 512
ADD_SIGNED, MINIMUM = 5, 3


def state(draw, factors):
    return State(draw, np.zeros(R.DRAW_FLOAT_SIZE), factors)


class Batch:
    """A framebuffer and a batch of fragments, both random; values near each other, so that tests differ."""

    def __init__(self, seed, runs):
        random = np.random.default_rng(seed)
        self.color = random.integers(0, 2**32, (HEIGHT, WIDTH), np.uint32)
        corners = random.random(self.color.shape) < 0.2
        self.color[corners] = random.choice([0, 0xFFFFFFFF, 0xFF00FF00, 0x80000000], corners.sum())
        self.depth_buffer = random.integers(1000, 1004, (HEIGHT, WIDTH)).astype(np.uint32)
        self.depth_buffer[random.random(self.depth_buffer.shape) < 0.1] = 0xFFFFFF
        self.stencil = random.choice([0, 1, 2, 127, 254, 255], (HEIGHT, WIDTH)).astype(np.uint8)
        self.starts = np.cumsum([0, *(n for _, _, n in runs)]).astype(np.int32)
        self.x = np.array([x for x, _, _ in runs], np.int32)
        self.y = np.array([y for _, y, _ in runs], np.int32)
        self.count = int(self.starts[-1])
        columns = BATCH + R.SLACK
        self.packed = random.integers(0, 2**32, columns, np.uint32)
        self.packed[random.random(columns) < 0.2] = 0xFFFFFFFF
        self.depth = random.integers(999, 1005, columns).astype(np.int32)
        self.depth[random.random(columns) < 0.1] = 0
        self.alive = random.integers(0, 2, columns).astype(np.uint8)
        self.pixel = np.zeros(columns, np.int32)
        for k, (x, y, n) in enumerate(runs):
            self.pixel[self.starts[k] :][:n] = y * WIDTH + x + np.arange(n)

    def buffers(self):
        return Buffers(self.color.copy(), self.depth_buffer.copy(), self.stencil.copy())

    def portable(self, draw, factors):
        buffers = self.buffers()
        colors = np.empty((4, BATCH), np.int16)
        for c in range(4):
            colors[c] = (self.packed[:BATCH] >> (8 * c)) & 0xFF
        scratch = np.empty(BATCH, np.uint32)
        per_fragment(
            state(draw, factors), self.count, Runs(self.starts, self.x, self.y, len(self.x)), colors, scratch,
            self.depth[:BATCH].copy(), self.alive[:BATCH].copy(), buffers,
        )  # fmt: skip
        return buffers

    def vectors(self, draw, factors, mixed=()):
        """As ``portable``; the runs from ``mixed[0]`` to before ``mixed[1]`` as one mixed stretch."""
        buffers, starts, x, y = self.buffers(), self.starts, self.x, self.y.copy()
        if mixed:
            first, last = mixed
            starts = np.delete(starts, slice(first + 1, last))
            x, y = np.delete(x, slice(first + 1, last)), np.delete(y, slice(first + 1, last))
            y[first] = -1
        fragments = V.Fragments(self.packed.copy(), self.pixel, self.depth.copy(), self.alive.copy())
        runs = Runs(starts, x, y, len(x))
        V.write_fragments(draw, factors, self.count, runs, 0, 0, fragments, buffers)
        return buffers


def assert_same(got, expected):
    for name, one, other in zip(("color", "depth", "stencil"), got, expected, strict=True):
        assert (one == other).all(), f"{name}: {np.argwhere(one != other)[:5].tolist()}"


# Long and short runs, at both ends of the framebuffer, overlapping, in draw order.
RUNS = [
    (0, 0, 64),
    (3, 0, 1),
    (150, 5, 50),
    (2, 2, 2),
    (3, 2, 4),
    (2, 2, 3),
    (168, 5, 32),
    (0, 3, 33),
    (1, 3, 17),
]


def new_draw(**entries):
    draw = np.zeros(R.DRAW_SIZE, np.int64)
    draw[R.NEEDS_COLOR], draw[R.COLOR_MASK] = 1, 0xFFFFFFFF
    draw[R.BITS] = draw[R.BUFFER_BITS] = R.BITS_OF_BYTES
    draw[R.SURFACE_KEEP], draw[R.SURFACE_PAD], draw[R.SURFACE_ALPHA] = SURFACE_WORDS[ColorFormat.A8R8G8B8]
    for name, value in entries.items():
        draw[getattr(R, name)] = value
    return draw


def with_stencil(draw, operations, reference=127):
    for at, operation in zip(
        (R.STENCIL_FAIL, R.STENCIL_DEPTH_FAIL, R.STENCIL_DEPTH_PASS), operations, strict=True
    ):
        draw[at : at + R.STENCIL_OPERATION_SIZE] = _pack_stencil_operation(operation, reference)
    draw[R.STENCIL_TEST], draw[R.STENCIL_REFERENCE] = 1, reference
    return draw


def factors_of(source, destination):
    color = (10, 200, 128, 255)
    return np.array([_pack_factor(factor, color, 255) for factor in (source, destination)], np.int32)


PLAIN = factors_of(BlendFactor.SRC_ALPHA, BlendFactor.ONE_MINUS_SRC_ALPHA)


def assert_all_ways(draw, factors=PLAIN, seed=0, runs=RUNS):
    batch = Batch(seed, runs)
    expected = batch.portable(draw, factors)
    assert_same(batch.vectors(draw, factors), expected)
    assert_same(batch.vectors(draw, factors, (0, len(runs))), expected)
    assert_same(batch.vectors(draw, factors, (3, 6)), expected)


@st.composite
def draws(draw):
    pick = lambda *values: draw(st.sampled_from(values))  # noqa: E731
    function = lambda: int(pick(*ComparisonFunction))  # noqa: E731
    mask = pick(0xFFFFFFFF, 0xFFFFFFFF, 0x00FFFFFF, 0xFF00FF00, 0)
    row = new_draw(
        COLOR_MASK=mask,
        NEEDS_COLOR=mask != 0 or draw(st.booleans()),
        DISCARDS=draw(st.booleans()),
        BLEND=pick(0, 1, 2, 3),
        BLEND_EQUATION=pick(0, 0, 1, 2, 3, 4),
        LOGIC_OPERATION=draw(st.integers(0, 15)),
    )
    if draw(st.booleans()):
        row[R.NEEDS_DEPTH], row[R.DEPTH_FUNCTION], row[R.DEPTH_WRITE] = 1, function(), draw(st.booleans())
        row[R.DEPTH_CULL] = draw(st.booleans())
    if row[R.NEEDS_COLOR] and draw(st.booleans()):
        row[R.ALPHA_TEST], row[R.ALPHA_FUNCTION] = 1, function()
        row[R.ALPHA_REFERENCE] = pick(0, 1, 128, 255)
    if draw(st.booleans()):
        with_stencil(row, [pick(*StencilOperation) for _ in range(3)], draw(st.integers(0, 255)))
        row[R.STENCIL_FUNCTION], row[R.STENCIL_MASK] = function(), pick(255, 255, 3, 0)
        row[R.STENCIL_WRITE_MASK] = pick(255, 255, 0xF0, 0)
    if draw(st.integers(0, 4)) == 0:
        row[R.SURFACE] = 1
        color_format = pick(*ColorFormat)
        row[R.SURFACE_KEEP], row[R.SURFACE_PAD], row[R.SURFACE_ALPHA] = SURFACE_WORDS[color_format]
        row[R.BLEND_EQUATION] = pick(0, ADD_SIGNED)
    return row


@settings(max_examples=400)
@given(
    draws(),
    st.sampled_from(BlendFactor),
    st.sampled_from(BlendFactor),
    st.lists(
        st.tuples(
            st.integers(0, WIDTH - 1), st.integers(0, HEIGHT - 1), st.sampled_from((1, 2, 3, 16, 40, 70))
        ),
        min_size=1,
        max_size=7,
    ),
    st.data(),
)
def test_random_draws(draw, source, destination, runs, data):
    runs = [(x, y, min(n, WIDTH - x)) for x, y, n in runs]
    batch = Batch(data.draw(st.integers(0, 2**32 - 1)), runs)
    factors = factors_of(source, destination)
    expected = batch.portable(draw, factors)
    first = data.draw(st.integers(0, len(runs) - 1))
    last = data.draw(st.integers(first + 1, len(runs)))
    assert_same(batch.vectors(draw, factors), expected)
    assert_same(batch.vectors(draw, factors, (first, last)), expected)


@pytest.mark.parametrize("write", [0, 1])
@pytest.mark.parametrize("blend", [0, 2])
@pytest.mark.parametrize("function", ComparisonFunction)
def test_every_depth_function(function, blend, write):
    assert_all_ways(new_draw(NEEDS_DEPTH=1, DEPTH_FUNCTION=function, DEPTH_WRITE=write, BLEND=blend))
    assert_all_ways(new_draw(NEEDS_DEPTH=1, DEPTH_FUNCTION=function, DEPTH_WRITE=write, COLOR_MASK=0))


@pytest.mark.parametrize("function", ComparisonFunction)
def test_every_alpha_function(function):
    for reference in (0, 1, 128, 254, 255):
        assert_all_ways(new_draw(ALPHA_TEST=1, ALPHA_FUNCTION=function, ALPHA_REFERENCE=reference))


@pytest.mark.parametrize("function", ComparisonFunction)
def test_every_stencil_function_and_operation(function):
    for operation in StencilOperation:
        draw = new_draw(STENCIL_FUNCTION=function, STENCIL_MASK=255, STENCIL_WRITE_MASK=255, COLOR_MASK=0)
        draw[R.NEEDS_DEPTH], draw[R.DEPTH_FUNCTION] = 1, ComparisonFunction.LEQUAL
        operations = (operation, StencilOperation.INVERT, StencilOperation.KEEP)
        for k in range(3):
            assert_all_ways(with_stencil(draw, operations[k:] + operations[:k]))


def test_every_pair_of_blend_factors():
    assert set(_FACTOR_TERMS) == set(BlendFactor)
    for k, (source, destination) in enumerate(product(BlendFactor, BlendFactor)):
        assert_all_ways(new_draw(BLEND=1), factors_of(source, destination), seed=k)


@pytest.mark.parametrize("blend", [0, 1, 2, 3])
@pytest.mark.parametrize("stencil", [False, True])
@pytest.mark.parametrize("depth", [None, 0, 1])
@pytest.mark.parametrize("word", [1001, 0, 0xFFFFFF, -1])
def test_runs_of_one_color_and_one_depth(word, depth, stencil, blend):
    # Together the runs are longer than the columns, which hold the longest of them.
    runs = [(0, 0, WIDTH), (7, 1, 45), (199, 5, 1), (0, 2, WIDTH)]
    shade = 0x80C0FF10
    for mask, reference in ((0xFFFFFFFF, None), (0x00FF00FF, 0x80), (0xFF, 0x81), (0, None)):
        draw = new_draw(BLEND=blend, LOGIC_OPERATION=6, COLOR_MASK=mask, NEEDS_COLOR=mask != 0)
        if depth is not None:
            draw[R.NEEDS_DEPTH], draw[R.DEPTH_WRITE] = 1, depth
            draw[R.DEPTH_FUNCTION] = ComparisonFunction.LEQUAL
        if depth is not None and word < 0:
            draw[R.DEPTH_CULL] = 1
        if stencil:
            operations = StencilOperation.INVERT, StencilOperation.DECR, StencilOperation.INCR
            with_stencil(draw, operations)
            draw[R.STENCIL_FUNCTION] = ComparisonFunction.LESS
            draw[R.STENCIL_MASK], draw[R.STENCIL_WRITE_MASK] = 255, 0x7F
        if reference is not None:
            draw[R.ALPHA_TEST], draw[R.ALPHA_REFERENCE] = 1, reference
            draw[R.ALPHA_FUNCTION] = ComparisonFunction.GEQUAL
        batch = Batch(mask & 0xFF, runs)
        batch.packed[:], batch.depth[:] = shade, word
        buffers, columns = batch.buffers(), WIDTH + R.SLACK
        fragments = V.Fragments(
            np.full(columns, shade, np.uint32),
            np.zeros(columns, np.int32),
            np.full(columns, word, np.int32),
            np.zeros(columns, np.uint8),
        )
        of_rows = Runs(batch.starts, batch.x, batch.y, len(runs))
        V.write_fragments(draw, PLAIN, WIDTH, of_rows, 1, 0, fragments, buffers)
        assert_same(buffers, batch.portable(draw, PLAIN))
