"""Footprints by vectors: the vector engine draws them, and every bit is the portable engine's."""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.pipeline.commands import Clear, Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import TextureEnvironmentMode, TextureFilter, WrapMode
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.native import prepared_draw
from fixedpipe.pipeline.profiles import NV2A
from fixedpipe.pipeline.state import (
    PassState,
    Sampler,
    TextureEnvironment,
    TextureUnit,
    VertexState,
    Viewport,
)
from fixedpipe.pipeline.textures.images import texture_2d

MACHINE = NV2A.changed(max_probes=16, exact_probes=True)
WIDTH, HEIGHT = 61, 47
WRAPS = (WrapMode.REPEAT, WrapMode.CLAMP_TO_EDGE)


def a_frame(seed):
    """Random triangles, large and small, in perspective, with one texture and one kind of footprint."""
    random = np.random.default_rng(seed)
    columns, rows = (1 << int(n) for n in random.integers(0, 8, 2))
    image = texture_2d(random.integers(0, 256, (rows, columns, 4), np.uint8), mipmaps=True)
    kind = {"max_probes": int(random.choice([2, 4, 8, 16]))}
    if seed % 4 == 0:
        kind = {"max_probes": int(random.integers(2, 17)), "exact_probes": True}
    if seed % 2:
        kind = {"max_anisotropy": float(random.choice([1.5, 2.0, 3.25, 4.0, 8.0]))}
    sampler = Sampler(
        TextureFilter(int(random.integers(6))), TextureFilter(int(random.integers(2))),
        WRAPS[random.integers(2)], WRAPS[random.integers(2)], **kind,
    )  # fmt: skip
    count = int(random.choice([2, 9, 40]))
    middle, spread = random.uniform(-0.9, 0.9, (count, 1, 2)), 1.6 if count < 9 else 0.3
    corners = middle + random.uniform(-spread, spread, (count, 3, 2))
    w = random.uniform(0.2, 3.0, (count, 3, 1)) if seed % 3 else np.ones((count, 3, 1))
    z = random.uniform(-0.9, 0.9, (count, 3, 1))
    positions = np.concatenate([corners * w, z * w, w], axis=-1).reshape(-1, 4)
    # Flat strips of a few texels, and whole numbers, where a coordinate lies between two texels.
    scale = random.choice([0.02, 1.0, 7.0], 2)
    coordinates = random.uniform(-scale, scale, (3 * count, 2))
    coordinates = np.where(random.random(coordinates.shape) < 0.2, np.round(coordinates), coordinates)
    mesh = Mesh(positions=positions, indices=np.arange(3 * count), texture_coordinates=(coordinates,))
    replaced = TextureEnvironment(TextureEnvironmentMode.REPLACE)
    unit = TextureUnit("t", sampler, environment=replaced, lod_bias=float(random.integers(-2, 3)) / 2.0)
    state = PassState(vertex=VertexState(viewport=Viewport(0, 0, WIDTH, HEIGHT)), texture_units=(unit,))
    return (
        TexImage(label="t", texture="t", image=image),
        Clear(label="clear", color=(0.2, 0.4, 0.6, 0.8), depth=1.0),
        Draw(label="triangles", mesh=mesh, state=state),
    )


@pytest.fixture
def covered(monkeypatch):
    """Whether each Draw so far is the vector engine's."""
    found, fill = [], prepared_draw.fill_draw

    def noted(*arguments):
        found.append(bool(fill(*arguments)))
        return found[-1]

    monkeypatch.setattr(prepared_draw, "fill_draw", noted)
    return found


@pytest.mark.parametrize("seed", range(60))
def test_footprints_by_vectors_are_the_portable_engine_s(seed, covered):
    commands = a_frame(seed)
    portable = execute(commands, MACHINE, WIDTH, HEIGHT, engine="portable").framebuffer.color
    assert len(np.unique(portable.reshape(-1, 4), axis=0)) > 1, "nothing is drawn"
    for threads, batch in ((1, 4096), (3, 64)):
        found = execute(commands, MACHINE, WIDTH, HEIGHT, threads=threads, batch=batch).framebuffer.color
        np.testing.assert_array_equal(found, portable)
    assert covered and all(covered[-2:])


def test_signed_texels_and_other_wraps_are_left_to_the_portable_engine(covered):
    load, clear, draw = a_frame(0)
    unit = draw.state.texture_units[0]
    unit = replace(unit, sampler=replace(unit.sampler, wrap_s=WrapMode.CLAMP))
    commands = load, clear, replace(draw, state=replace(draw.state, texture_units=(unit,)))
    execute(commands, MACHINE, WIDTH, HEIGHT)
    assert not covered[-1]
