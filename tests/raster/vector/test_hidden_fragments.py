"""What is hidden is left out before it is shaded: every bit, and the number of fragments, stays."""

import numpy as np
import pytest

from fixedpipe.pipeline.commands import Clear, Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import BlendFactor, ComparisonFunction, StencilOperation
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.profiles import GEFORCE_256
from fixedpipe.pipeline.state import (
    AlphaTest,
    Blending,
    DepthTest,
    PassState,
    StencilTest,
    TextureUnit,
    VertexState,
    Viewport,
)
from fixedpipe.pipeline.textures.images import texture_2d
from fixedpipe.raster import rows as R
from fixedpipe.raster.vector import hidden as hides
from fixedpipe.raster.vector import per_fragment

WIDTH, HEIGHT = 70, 53
ADDED = Blending(BlendFactor.ONE, BlendFactor.ONE)
STENCIL = StencilTest(ComparisonFunction.ALWAYS, depth_fail=StencilOperation.INCR)


def layers(random, state, count=30, edge=1.2):
    """Triangles over each other, from a few pixels to the whole window, some of them one behind another."""
    middle = random.uniform(-0.9, 0.9, (count, 1, 2))
    corners = middle + random.uniform(-edge, edge, (count, 3, 2)) * random.choice(
        [0.15, 0.5, 1.0], (count, 1, 1)
    )
    # Depths in few steps, level and sloped: equal ones meet.
    z = np.round(random.uniform(-0.9, 0.9, (count, 1, 1)) * 4) / 4 + np.zeros((count, 3, 1))
    z += random.choice([0.0, 0.2], (count, 1, 1)) * random.uniform(-1, 1, (count, 3, 1))
    positions = np.concatenate([corners, z], axis=-1).reshape(-1, 3)
    mesh = Mesh(
        positions,
        indices=np.arange(3 * count),
        colors=random.uniform(0, 1, (3 * count, 4)),
        texture_coordinates=(positions[:, :2],),
    )
    return Draw(label="triangles", mesh=mesh, state=state)


def pictures(commands):
    """Colour, depth, stencil and the number of fragments by the vector engine and by the portable one."""
    found = []
    for settings in ({}, {"threads": 3, "batch": 64}, {"engine": "portable"}):
        machine = Machine(GEFORCE_256, WIDTH, HEIGHT, **settings)
        result = machine.run(commands)
        buffers = result.framebuffer
        found.append(
            (buffers.color.tobytes(), buffers.depth.tobytes(), buffers.stencil.tobytes(), result.fragments)
        )
    return found


STATES = {
    "writes": {},
    "blended": {"blending": ADDED},
    "stencil": {"stencil_test": STENCIL},
    "alpha": {"alpha_test": AlphaTest(ComparisonFunction.GREATER, 0.5)},
    "textured": {"texture_units": (TextureUnit("t"),)},
}


@pytest.mark.parametrize("kind", STATES)
@pytest.mark.parametrize("function", ComparisonFunction, ids=lambda f: f.name)
@pytest.mark.parametrize("write", [True, False])
def test_hidden_fragments_leave_no_trace(kind, function, write):
    random = np.random.default_rng([*map(ord, kind), function, write])
    viewport = VertexState(viewport=Viewport(0, 0, WIDTH, HEIGHT))
    depth = DepthTest(function, write=write)
    image = texture_2d(random.integers(0, 256, (8, 8, 4), np.uint8), mipmaps=True)
    state = PassState(vertex=viewport, depth_test=depth, **STATES[kind])
    first = PassState(vertex=viewport, depth_test=DepthTest(ComparisonFunction.LESS))
    commands = (
        TexImage(label="t", texture="t", image=image),
        Clear(label="clear", color=(0.2, 0.4, 0.6, 0.8), depth=0.7, stencil=3),
        layers(random, first, 6),
        layers(random, state),
        layers(random, state, 60, 0.5),
    )
    vector, other, portable = pictures(commands)
    assert vector == portable
    assert other == portable


@pytest.mark.parametrize("function", range(8))
@pytest.mark.parametrize("write", [0, 1])
def test_what_failed_once_fails_at_its_turn(function, write):
    """By hand, of every depth, what it is tested against, and what another writes before: a fragment that the
    rule leaves out fails whatever passes before it.
    """
    draw = np.zeros(R.DRAW_SIZE, np.int64)
    draw[R.NEEDS_DEPTH] = draw[R.NEEDS_COLOR] = 1
    draw[R.DEPTH_FUNCTION], draw[R.DEPTH_WRITE] = function, write
    passes = per_fragment.portable.passes.py_func

    def passing(value, stored):
        relation = 1 if value < stored else (2 if value == stored else 4)
        return bool(function & relation)

    may_be_left_out = bool(hides.tests_early.py_func(draw))
    safe = all(
        not passing(value, between if write and passing(between, stored) else stored)
        for value in range(4)
        for stored in range(4)
        for between in range(4)
        if not passing(value, stored)
    )
    assert may_be_left_out == (safe and function != 7)
    for value in range(4):
        assert all(bool(passes(function, value, stored)) == passing(value, stored) for stored in range(4))
    draw[R.STENCIL_TEST] = 1
    assert not hides.tests_early.py_func(draw)


@pytest.mark.parametrize("count", [0, 1, 15, 16, 17, 40])
def test_all_and_no_others_are_hidden(count):
    random = np.random.default_rng(count)
    for function in range(1, 7):
        for _ in range(30):
            depth = np.full(64, 5, np.int32)
            pixel = random.permutation(64).astype(np.int32)
            words = random.integers(4, 7, 64).astype(np.uint32)
            start = int(random.integers(0, 64 - count))
            words[random.random(64) < 0.9] = 4 if function & 1 else 6  # mostly all fail
            if function in (2, 5):
                words[random.random(64) < 0.9] = 6 if function == 2 else 5

            def passing(stored, function=function):
                return bool(function & (1 if stored > 5 else (2 if stored == 5 else 4)))

            own = slice(start, start + count)
            hidden = not any(passing(int(words[p])) for p in pixel[own])
            assert hides.are_hidden(words, pixel, depth, start, count, function) == hidden
            hidden = not any(passing(int(w)) for w in words[own])
            assert hides.is_hidden(words, start, depth, 3, count, function) == hidden
