"""Integer colour weights of runs equal those that docs/numbers.md, rule N4.4, makes of weights of 24 bits."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from fixedpipe.pipeline.commands import Clear, Draw, Mesh
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.profiles import GEFORCE_256
from fixedpipe.pipeline.state import PassState, VertexState, Viewport
from fixedpipe.raster import rows as R
from fixedpipe.raster.vector.interpolate import run_weights
from fixedpipe.raster.vector.weights import run_color_weights

UNEQUAL_PLACE = 3  # of the first fragment: not a multiple of sixteen


def both(n, right, count):
    """W0 and W2 of a run: as integers at once, and from its weights of 24 bits."""
    n, right = tuple(map(float, n)), tuple(map(float, right))
    columns = UNEQUAL_PLACE + count + R.SLACK
    ints = np.zeros((R.VECTOR_INT_COLUMNS, columns), np.int32)
    floats = np.zeros((R.VECTOR_FLOAT_COLUMNS, columns))
    run_color_weights(ints, UNEQUAL_PLACE, count, n, right)
    run_weights(floats, UNEQUAL_PLACE, count, n, right, (1.0, 1.0, 1.0))
    here = slice(UNEQUAL_PLACE, UNEQUAL_PLACE + count)
    found = ints[[R.W0, R.W2], here]
    return found, np.floor(floats[[R.Q0, R.Q2], here] * 256.0).astype(np.int32)


def inside(n, right, most):
    """How many pixels to the right have no negative edge function, at most ``most``."""
    return min([most, *(value // -step + 1 for value, step in zip(n, right, strict=True) if step < 0)])


@st.composite
def runs(draw):
    """Edge functions in a triangle of some area, and how they change from pixel to pixel."""
    area = draw(st.one_of(st.integers(1, 2**30), st.sampled_from([2**k for k in range(31)])))
    n0 = draw(st.integers(0, area))
    n1 = draw(st.integers(0, area - n0))
    largest = draw(st.sampled_from([1, 16, 2**10, 2**16]))
    right0, right2 = draw(st.integers(-largest, largest)), draw(st.integers(-largest, largest))
    return (n0, n1, area - n0 - n1), (right0, -right0 - right2, right2)


@given(run=runs(), most=st.integers(1, 400))
@settings(max_examples=500)
@example(run=((2**28 - 2**17, 2**17, 0), (-(2**18), 2**18, 0)), most=1024)
@example(run=((2**28 - 2**17, 0, 2**17), (-(2**18), 0, 2**18)), most=1024)
def test_integer_weights_are_those_of_24_bits(run, most):
    n, right = run
    found, expected = both(n, right, inside(n, right, most))
    np.testing.assert_array_equal(found, expected)


def test_all_runs_of_small_areas():
    """Every pixel of every area up to 33, along each edge; steps of 1/256 are met exactly and nearly."""
    for area in range(1, 34):
        for n2 in range(area + 1):
            for right in ((-1, 1, 0), (1, -1, 0)):
                start = area - n2 if right[0] < 0 else 0
                found, expected = both((start, area - n2 - start, n2), right, area - n2 + 1)
                np.testing.assert_array_equal(found, expected)


def test_runs_beside_steps():
    """Areas where weights lie beside multiples of 1/256, from both sides, for vectors without an end."""
    random = np.random.default_rng(1)
    for area in (256, 255 * 4096, 257 * 4096, 1000 * 1000 * 256, 2**28, 2**29, 2**29 + 256, 3 * 2**26):
        for k in random.integers(0, 257, 60).tolist():
            for apart in (-2, -1, 0, 1, 2):
                n0 = min(max(area * k // 256 + apart, 0), area)
                n2 = int(random.integers(0, area - n0 + 1))
                for right in ((0, 0, 0), (1, -1, 0), (0, 1, -1), (-1, 0, 1), (-1, -1, 2)):
                    n = (n0, area - n0 - n2, n2)
                    found, expected = both(n, right, inside(n, right, 50))
                    np.testing.assert_array_equal(found, expected)


WIDTH, HEIGHT = 256, 128


def smooth(random, near, viewport):
    """Triangles of a few pixels, of the window's part and beyond it, corner colours black or white or any."""
    size = random.choice([0.02, 0.1, 0.4, 1.5, 2.5], (40, 1, 1))
    middle = random.uniform(-0.9, 0.9, (40, 1, 2)) / np.maximum(size, 1.0)
    corners = middle + size * random.uniform(-1, 1, (40, 3, 2))
    if near:  # corners at whole pixels: weights beside steps
        corners = np.round(corners * (WIDTH // 8, HEIGHT // 8)) / (WIDTH // 8, HEIGHT // 8)
    positions = np.concatenate([corners, np.zeros((40, 3, 1))], axis=-1).reshape(-1, 3)
    colors = random.uniform(0, 1, (120, 4))
    colors = np.where(random.random((120, 1)) < 0.5, np.round(colors), colors)
    mesh = Mesh(positions, indices=np.arange(120), colors=colors)
    return Draw(label="smooth", mesh=mesh, state=PassState(vertex=viewport))


@pytest.mark.parametrize("near", [True, False])
@pytest.mark.parametrize("seed", range(6))
def test_smooth_triangles_are_the_portable_engines(near, seed):
    random = np.random.default_rng([near, seed])
    viewport = VertexState(viewport=Viewport(0, 0, WIDTH, HEIGHT))
    commands = (Clear(label="clear", color=(0.2, 0.4, 0.6, 0.8)), smooth(random, near, viewport))
    found = []
    for options in ({"engine": "portable"}, *({"threads": n} for n in (1, 2, 3, 4)), {"batch": 64}):
        result = Machine(GEFORCE_256, WIDTH, HEIGHT, **options).run(commands)
        found.append((result.framebuffer.color.tobytes(), result.fragments))
    assert found[1:] == found[:1] * 5
