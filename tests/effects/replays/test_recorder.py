"""Traces of one's own: what Recorder writes is replayed as what Context draws of the same calls."""

import io

import numpy as np
import pytest

from fixedpipe.effects.replays.recorder import Recorder
from fixedpipe.effects.replays.replay import Replay
from fixedpipe.pipeline import GEFORCE_256, Machine
from fixedpipe.pipeline.opengl import Context
from fixedpipe.pipeline.opengl import tokens as T
from fixedpipe.pipeline.traces.calls import Trace


def draw(gl):
    """A textured strip from arrays, over a clear."""
    texels = np.arange(4 * 4 * 3, dtype=np.uint8).reshape(4, 4, 3) * 5
    gl.ClearColor(0.1, 0.2, 0.3, 1.0)
    gl.Clear(T.COLOR_BUFFER_BIT | T.DEPTH_BUFFER_BIT)
    gl.BindTexture(T.TEXTURE_2D, np.int64(5))
    gl.TexParameteri(T.TEXTURE_2D, T.TEXTURE_MIN_FILTER, T.NEAREST)
    gl.PixelStorei(T.UNPACK_ALIGNMENT, 1)
    gl.TexImage2D(T.TEXTURE_2D, 0, T.RGB, 4, 4, 0, T.RGB, T.UNSIGNED_BYTE, texels[::-1])
    gl.Enable(T.TEXTURE_2D)
    gl.Lightfv(T.LIGHT0, T.POSITION, (0.0, 1.0, 1.0, 0.0))
    gl.Begin(T.TRIANGLE_STRIP)
    for s, t in ((0, 0), (1, 0), (0, 1), (1, 1)):
        gl.TexCoord2f(float(s), float(t))
        gl.Vertex2fv((1.5 * s - 0.5, 1.5 * t - 1.0))
    gl.End()


def test_a_recorded_program_draws_what_its_calls_draw():
    file = io.BytesIO()
    with Recorder(file, 32, 24, properties={"process.name": "own"}) as gl:
        draw(gl)
        swap = gl.swap()
    replay = Replay(GEFORCE_256)
    with Trace(io.BytesIO(file.getvalue())) as trace:
        (frame,) = [each for call in trace for each in replay.take(call)]
        assert trace.properties == {"process.name": "own"} and trace.damage is None
    context = Context(GEFORCE_256, 32, 24)
    draw(context)
    expected = Machine(GEFORCE_256, 32, 24).run(context.take_commands()).image()
    np.testing.assert_array_equal(frame.image, expected)
    assert len(np.unique(expected.reshape(-1, 4), axis=0)) > len(range(16))  # all texels and the clear
    assert (frame.width, frame.height, frame.last_call) == (32, 24, swap)
    assert not replay.tally.count("refused") and not replay.tally.count("error")


def test_what_is_no_entry_point_is_said():
    gl = Recorder(io.BytesIO(), 8, 8)
    with pytest.raises(AttributeError, match="no entry point glVertexQuickly"):
        _ = gl.VertexQuickly
