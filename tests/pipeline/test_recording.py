"""What a recorded Draw gives: every fragment once, however many there are, and the picture that is drawn."""

import numpy as np
import pytest

from fixedpipe.pipeline.commands import Clear, Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import (
    BlendFactor,
    ComparisonFunction,
    PolygonMode,
    StencilOperation,
    TextureFilter,
)
from fixedpipe.pipeline.execution import machine as machines
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.native import recording
from fixedpipe.pipeline.native.prepared_draw import Prepared
from fixedpipe.pipeline.native.queue import Queue
from fixedpipe.pipeline.profiles import NV2A
from fixedpipe.pipeline.state import (
    AlphaTest,
    Blending,
    ColorMask,
    DepthTest,
    PassState,
    PolygonState,
    Sampler,
    Scissor,
    StencilTest,
    TextureUnit,
)
from fixedpipe.pipeline.textures.images import texture_2d
from tests.support.random_frames import random_frame

ADDED = Blending(BlendFactor.ONE, BlendFactor.ONE)


@pytest.fixture
def passes(monkeypatch):
    """How often the portable engine drew a Draw's bands."""
    bands, drawn = Prepared.bands, []

    def counted(*given):
        drawn.append(given)
        return bands(*given)

    monkeypatch.setattr(Prepared, "bands", counted)
    return drawn


def assert_same_fragments(found, expected):
    for name in ("triangle", "x", "y", "passed", "covered"):
        one, other = getattr(found, name), getattr(expected, name)
        assert (one is None) == (other is None), name
        if one is not None:
            assert one.dtype == np.int32 and one.flags.c_contiguous
            np.testing.assert_array_equal(one, other, name)
    assert found.places == expected.places


def recorded(mesh, size, engine=None, **state):
    command = Draw(label="d", mesh=mesh, state=PassState(blending=ADDED, **state))
    shown = execute((command,), NV2A, size, size).framebuffer.color
    result = execute((command,), NV2A, size, size, record=True, engine=engine)
    np.testing.assert_array_equal(result.framebuffer.color, shown)
    (fragments,) = result.records
    assert fragments.places is not None
    assert len(fragments.x) == result.fragments
    assert_same_fragments(fragments, fragments)
    return fragments


def huge(layers):
    """Triangles over all pixels, far beyond the framebuffer."""
    colors = [[0.01, 0, 0]] * 6 * layers
    return Mesh([[-9, -9], [9, -9], [-9, 9], [9, 9], [9, -9], [-9, 9]] * layers, colors=colors)


@pytest.mark.parametrize(("engine", "drawings"), [(None, 0), ("portable", 1)])
def test_triangles_are_recorded_in_one_drawing(passes, monkeypatch, engine, drawings):
    monkeypatch.setattr(recording, "_USUAL", 1000)
    fragments = recorded(huge(3), 320, engine)
    assert len(passes) == drawings and len(fragments.x) == 3 * 320 * 320 > recording._USUAL
    counts = np.zeros((320, 320), int)
    np.add.at(counts, (fragments.y, fragments.x), 1)
    assert (counts == 3).all() and fragments.passed.all()


def test_what_may_be_more_than_a_recording_holds_is_drawn_again(passes, monkeypatch):
    monkeypatch.setattr(recording, "_MOST", 5000)
    monkeypatch.setattr(recording, "_USUAL", 1000)
    small = Scissor(0, 0, 16, 16)
    assert len(recorded(huge(2), 64, scissor=small).x) == 512 and len(passes) == 0
    assert len(recorded(huge(2), 64, "portable", scissor=small).x) == 512 and len(passes) == 1
    assert len(recorded(huge(2), 64).x) == 2 * 64 * 64 and len(passes) == 3


def test_outlines_have_no_bound_and_are_whole(passes, monkeypatch):
    monkeypatch.setattr(recording, "_USUAL", 100)
    lines = PolygonState(front_mode=PolygonMode.LINE, back_mode=PolygonMode.LINE)
    corners = np.random.default_rng(3).uniform(-1, 1, (60, 2))
    fragments = recorded(Mesh(corners, colors=[[0.01, 0, 0]] * 60), 64, polygon=lines)
    assert len(fragments.x) > 100 and len(passes) == 1 + 2  # drawn, and recorded twice


@pytest.mark.parametrize("engine", [None, "portable"])
@pytest.mark.parametrize("size", [1, 16, 33])
def test_the_bound_is_never_less_than_what_is_drawn(size, engine):
    random = np.random.default_rng(size)
    for scale in (0.02, 0.3, 3.0):
        corners = random.uniform(-1, 1, (40, 1, 2)) + scale * random.normal(0, 1, (40, 3, 2))
        mesh, bounds = Mesh(corners.reshape(-1, 2)), []

        def bound(*given, inner=recording.most_fragments, bounds=bounds):
            bounds.append(inner(*given))
            return bounds[-1]

        command = Draw(label="d", mesh=mesh, state=PassState())
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(recording, "most_fragments", bound)
            result = execute((command,), NV2A, size, size, record=True, engine=engine)
        assert len(result.records[0].x) <= sum(bounds) <= 40 * size * size
        assert bounds or not len(result.records[0].x)


# States in which the vector engine leaves fragments out, keeps no columns, or tests and writes at once, where
# it does not record.
TEXTURED = TextureUnit("t", Sampler(TextureFilter.LINEAR_MIPMAP_LINEAR, TextureFilter.LINEAR))
STATES = {
    "nothing": PassState(),
    "depth": PassState(depth_test=DepthTest(ComparisonFunction.LESS)),
    "depth, added": PassState(depth_test=DepthTest(ComparisonFunction.LEQUAL, write=False), blending=ADDED),
    "depth alone": PassState(
        depth_test=DepthTest(ComparisonFunction.GREATER), color_mask=ColorMask(False, False, False, False)
    ),
    "never": PassState(depth_test=DepthTest(ComparisonFunction.NEVER)),
    "alpha": PassState(alpha_test=AlphaTest(ComparisonFunction.GREATER, 0.5)),
    "stencil": PassState(
        depth_test=DepthTest(ComparisonFunction.LESS),
        stencil_test=StencilTest(
            ComparisonFunction.NOTEQUAL,
            reference=1,
            mask=3,
            depth_fail=StencilOperation.INCR,
            depth_pass=StencilOperation.INVERT,
        ),
    ),
    "mip-maps": PassState(texture_units=(TEXTURED,), depth_test=DepthTest(ComparisonFunction.LESS)),
}


@pytest.mark.parametrize("one_color", [False, True])
@pytest.mark.parametrize("state", STATES.values(), ids=STATES)
def test_both_engines_record_the_same(passes, state, one_color):
    random = np.random.default_rng(5)
    frame = [
        TexImage(
            label="t",
            texture="t",
            image=texture_2d(random.integers(0, 256, (16, 16, 4)).astype(np.uint8), mipmaps=True),
        ),
        Clear(label="c", color=(0, 0, 0, 0), depth=0.6, stencil=2),
    ]
    for scale, count in ((0.03, 300), (0.2, 60), (2.0, 6)):
        corners = random.uniform(-1, 1, (count, 1, 3)) + scale * random.normal(0, 1, (count, 3, 3))
        colors = (
            np.broadcast_to(random.random(4), (3 * count, 4)) if one_color else random.random((3 * count, 4))
        )
        mesh = Mesh(
            np.clip(corners, -3, 3).reshape(-1, 3),
            colors=colors,
            texture_coordinates=(random.random((3 * count, 2)),),
        )
        frame += [Draw(label=f"of {scale}", mesh=mesh, state=state)] * 2
    expected = execute(frame, NV2A, 77, 70, record=True, engine="portable")
    drawn = len(passes)
    assert drawn == 6
    for threads, batch in ((1, 2048), (3, 17), (2, 4096)):
        found = execute(frame, NV2A, 77, 70, record=True, threads=threads, batch=batch)
        assert len(passes) == drawn  # by the vector engine alone
        assert len(found.records) == 6 and found.fragments == expected.fragments > 0
        for one, other in zip(found.records, expected.records, strict=True):
            assert_same_fragments(one, other)
        for name in ("color", "depth", "stencil"):
            np.testing.assert_array_equal(
                getattr(found.framebuffer, name), getattr(expected.framebuffer, name), name
            )


@pytest.mark.parametrize("seed", range(25))
def test_random_frames_are_recorded_the_same_by_all_engines(seed):
    frame = random_frame(seed)
    size = frame.width, frame.height
    given = {"depth_bits": frame.depth_bits, "record": True}
    expected = execute(frame.commands, frame.profile, *size, **given, engine="portable")
    for threads in (1, 2):
        found = execute(frame.commands, frame.profile, *size, **given, threads=threads)
        assert found.fragments == expected.fragments
        for one, other in zip(found.records, expected.records, strict=True):
            assert_same_fragments(one, other)


def test_waiting_records_take_no_more_memory_than_draws(monkeypatch):
    monkeypatch.setattr("fixedpipe.pipeline.native.queue._MOST_BYTES", 1 << 16)
    flushed, flush = [], Queue.flush

    def counted(queue):
        flushed.append(len(queue._records))
        flush(queue)

    monkeypatch.setattr(Queue, "flush", counted)
    commands = [Draw(label=f"d{n}", mesh=huge(1), state=PassState()) for n in range(9)]
    result = execute(commands, NV2A, 64, 64, record=True)
    assert sum(flushed) == 9 and max(flushed) == 1  # 128 kB each
    assert [len(fragments.x) for fragments in result.records] == [64 * 64] * 9


def test_records_keep_primitives_up_to_a_bound(monkeypatch):
    commands = [Draw(label=f"d{n}", mesh=huge(1), state=PassState()) for n in range(4)]
    for engine in ("columns", None):
        monkeypatch.undo()
        every = execute(commands, NV2A, 8, 8, record=True, engine=engine).records
        assert [fragments.command for fragments in every] == commands
        monkeypatch.setattr(machines, "_MOST_HELD", 3 * every[0].primitives.size)
        some = execute(commands, NV2A, 8, 8, record=True, engine=engine).records
        kept = [fragments.primitives is not None for fragments in some]
        assert kept == [fragments.command is not None for fragments in some]
        assert kept == sorted(kept, reverse=True) and True in kept and False in kept
        assert [fragments.places for fragments in some] == [fragments.places for fragments in every]
