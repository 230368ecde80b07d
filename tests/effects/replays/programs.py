"""Programs as calls: what apitrace would record of them."""

from fixedpipe.effects.replays.replay import Replay
from fixedpipe.pipeline.opengl import tokens as T
from fixedpipe.pipeline.profiles import GEFORCE_256
from fixedpipe.pipeline.traces.calls import FAKE, Call
from fixedpipe.pipeline.traces.writer import TraceWriter

DISPLAY, WINDOW, VISUAL = 0x1000, 0x22, 7
RED, GREEN, BLUE = (1.0, 0.0, 0.0, 1.0), (0.0, 1.0, 0.0, 1.0), (0.0, 0.0, 1.0, 1.0)
BYTES = {RED: [255, 0, 0, 255], GREEN: [0, 255, 0, 255], BLUE: [0, 0, 255, 255]}
BLACK = [0, 0, 0, 0]


class Program:
    """Records calls; ``thread`` is that of the calls to come."""

    def __init__(self):
        self.calls = []
        self.thread = 0

    def call(self, name, *arguments, result=None, flags=0):
        self.calls.append(Call(len(self.calls), name, list(arguments), result, flags, self.thread))
        return self

    def context(self, key=99, *, double=True, share=None, visual=VISUAL):
        """Choose a visual, and make a context of it."""
        names = [4, *([5] if double else []), 0]  # RGBA, DOUBLEBUFFER
        chosen = [{"visualid": visual}]
        self.call("glXChooseVisual", DISPLAY, 0, names, result=chosen)
        return self.call("glXCreateContext", DISPLAY, chosen, share, 1, result=key)

    def current(self, context=99, window=WINDOW, size=(8, 4)):
        """Make a context current; with a size, apitrace inserts what says it."""
        self.call("glXMakeCurrent", DISPLAY, window, context, result=1)
        if size is not None:
            self.call("glViewport", 0, 0, *size, flags=FAKE)
            self.call("glScissor", 0, 0, *size, flags=FAKE)
        return self

    def clear(self, color, bits=T.COLOR_BUFFER_BIT | T.DEPTH_BUFFER_BIT | T.STENCIL_BUFFER_BIT):
        return self.call("glClearColor", *color).call("glClear", bits)

    def rectangle(self, color, left=-1.0, right=1.0):
        """A rectangle from the left edge's place to the right one's, as high as the window."""
        self.call("glColor4f", *color).call("glBegin", T.QUADS)
        for x, y in ((left, -1.0), (right, -1.0), (right, 1.0), (left, 1.0)):
            self.call("glVertex2f", x, y)
        return self.call("glEnd")

    def swap(self, window=WINDOW):
        return self.call("glXSwapBuffers", DISPLAY, window)

    def write(self, path, **settings):
        """Write the calls as a trace."""
        with TraceWriter(path, **settings) as trace:
            for call in self.calls:
                names = [f"a{n}" for n in range(len(call.arguments))]
                trace.call(
                    call.name, names, call.arguments, call.result, flags=call.flags, thread=call.thread
                )
        return path


def started(**how):
    """A program with a context that is current in a window of 8x4 pixels."""
    return Program().context(**how).current()


def replayed(program, profile=GEFORCE_256, **settings):
    """(the Replay, its frames) of all calls of a program."""
    replay = Replay(profile, **settings)
    frames = [frame for call in program.calls for frame in replay.take(call)]
    return replay, [*frames, *replay.finish()]


def color_of(frame, x=0, y=0):
    """A pixel of a frame, from the top left."""
    return frame.image[y, x].tolist()


def sentences(replay, kind):
    """What a Replay counted of a kind: {sentence: how often}."""
    return {outcome.what: outcome.count for outcome in replay.tally.of(kind) if outcome.count}
