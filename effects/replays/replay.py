"""Replays a trace on a machine, call by call: it draws, finds where frames end, and makes their pictures.

A frame ends
- at a swap of its drawable's buffers;
- at Flush or Finish after a draw, in a single-buffered window;
- at FrameTerminatorGREMEDY;
- at the end of its context or of the trace, if something was drawn since the last frame.

A swap shows the back buffer, Flush and Finish show the front buffer. Every other end shows the buffer that
was drawn into last, which may be a framebuffer object.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.replays.check import ANSWERING, Check
from fixedpipe.effects.replays.postponed import bytes_of
from fixedpipe.effects.replays.recording import Recording
from fixedpipe.effects.replays.samples import SampleCounter
from fixedpipe.effects.replays.targets import BACK, FRONT, MOST_PIXELS, Drawn, Target, blank
from fixedpipe.effects.replays.window_calls import DESTROYING, is_window_call, take_window_call
from fixedpipe.effects.replays.windows import GLContext, Window, WindowSystem
from fixedpipe.pipeline.commands import MakeCurrent, ReadPixels
from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.outcomes import Tally
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.traces.calls import FAKE, Call

THE_END = "the trace's end"  # it ends a frame that no call ends
# The most commands that wait, so that a program without frames does not fill the memory.
_MOST_WAITING = 4096
_MOST_BYTES = 1 << 26  # of their images
_BUFFERS = {
    tokens.NONE: (),
    tokens.BACK: (BACK,),
    tokens.BACK_LEFT: (BACK,),
    tokens.FRONT: (FRONT,),
    tokens.FRONT_LEFT: (FRONT,),
    tokens.FRONT_AND_BACK: (FRONT, BACK),
    tokens.LEFT: (FRONT, BACK),
    tokens.AUX0: ("auxiliary 0",),
}


@dataclass(frozen=True, eq=False)
class Frame:
    """A frame that has ended.

    - ``number``: from 0; the frames of all windows are counted together.
    - ``window``: the number of its window; ``width``, ``height``: the picture's size in pixels.
    - ``first_call``, ``last_call``: its first and its last call.
    - ``ended``: the call that ended it, or "the trace's end".
    - ``seen_call``: the call after which its picture is complete: a swap, Flush, Finish, or the last draw.
    - ``draws``: how many draws it has; ``refused``: how many of these the machine refused.
    - ``image``: uint8 [h, w, 4], top row first; None: it was not requested.
    - ``recording``: the frame's Recording, if it was requested; ``shown``: the buffer that is shown.
    """

    number: int
    window: int
    width: int
    height: int
    first_call: int
    last_call: int
    seen_call: int
    ended: str
    draws: int
    refused: int
    image: NDArray[np.uint8] | None = field(default=None, repr=False)
    recording: Recording | None = None
    shown: str = BACK


class Replay:
    """Replays a trace's calls on ``profile``.

        replay = Replay(GEFORCE_256)
        for call in trace:
            for frame in replay.take(call):
                ...
        for frame in replay.finish():
            ...

    - ``wanted``: a function of a frame's number and its draws: whether its picture is requested.
    - ``needed``: a function of a frame's number: whether its picture may be requested. Others may stay
      undrawn.
    - ``recorded``: a function of a frame's number: whether its Recording is requested.
    - ``size``: (width, height) of every window; None: the sizes of the trace.
    - ``target``: the kind of Target that commands run on.
    - ``check``: a Check, which compares the answers that the trace recorded; or None.
    - ``threads``: how many threads draw; None: one per processor. Any number gives the same bits.
    - ``tally``: counts what happened to the calls.
    - ``calls``, ``frames``, ``draws``: how many there were; ``refused``: how many draws were refused.
    """

    def __init__(
        self,
        profile: Profile,
        *,
        wanted: Callable[[int, int], bool] = lambda number, draws: True,
        needed: Callable[[int], bool] = lambda number: True,
        recorded: Callable[[int], bool] = lambda number: False,
        size: tuple[int, int] | None = None,
        target: type[Target] = Drawn,
        check: Check | None = None,
        threads: int | None = None,
    ):
        self.profile, self.tally, self.check = profile, Tally(), check
        self.windows = WindowSystem(profile, self.tally, size)
        self.calls = self.frames = self.draws = self.refused = 0
        self._wanted, self._needed, self._recorded, self._kind = wanted, needed, recorded, target
        self._threads = threads
        self._targets: dict[Window, Target] = {}
        self._running: GLContext | None = None  # the context whose commands wait
        self._first_call = 0
        self._last_call = 0
        self._last_commanding = 0  # the last call that made commands
        self._drawing = True
        self._markers: list[str] = []  # the program's debug markers for the next draws
        self._event = ""
        self._unlabelled = 0  # how many waiting commands have their markers
        self._before = 0  # how many commands waited before the present call
        self._bytes = 0  # how many bytes the images of waiting commands have
        self._counters: dict[GLContext, SampleCounter] = {}  # of contexts with an active query

    # --------------------------------------------------------------------------------------------- calls

    def take(self, call: Call) -> Sequence[Frame]:
        """Carry out a call. Returns the frames that it ends."""
        self.calls += 1
        name = call.name
        self.windows.tally.call = self._last_call = call.number
        if is_window_call(name):
            return self._take_window_call(call)
        context = self.windows.current_or_own(call.thread)
        if context is None:
            self.windows.tally.add("no effect", f"{name}, with no context current")
            return ()
        if context is not self._running:
            self._switch(context)
        if context.known.indexed:
            self.windows.tally.add(
                "refused", "a window of colour indices: the machines here draw colours alone"
            )
            return ()
        if name in _OWN:
            self.windows.tally.add("no effect", name)
            return _OWN[name](self, context, call)
        if name.startswith(_QUERIES) and not name.startswith(_RESETTING):
            self.windows.tally.add("no effect", name)  # the program has got its answer already
            if self.check is not None:
                self.check.query(context.gl, call)
            return ()
        gl = context.gl
        self._before = len(gl.commands)
        answered = gl.call(name, call.arguments, call.result)
        if len(gl.commands) > self._before:
            self._last_commanding = call.number
        if self.check is not None and name in ANSWERING:
            self.check.returned(call, answered)
        if name in _AFTER:
            return _AFTER[name](self, context, call)
        if len(gl.commands) > self._before:
            self._bytes += sum(map(bytes_of, gl.commands[self._before :]))
        if len(gl.commands) > _MOST_WAITING or self._bytes > _MOST_BYTES:
            self.run_waiting()
        return ()

    def finish(self) -> Sequence[Frame]:
        """Handle the end of the trace. Returns the frames that end with it."""
        self.run_waiting()
        return [frame for window in list(self._targets) for frame in self._end_if_drawn(window, THE_END)]

    def stop_drawing(self) -> None:
        """From now on draw and count nothing. Calls still change the state, and answers are compared."""
        self._drawing = False
        if self._running is not None:
            self._running.gl.drawing = False
        self.windows.count_in(Tally())

    def _take_window_call(self, call):
        self.run_waiting()
        window = take_window_call(self.windows, call)
        if window is None:
            return ()
        if call.name in DESTROYING:
            self._running = None
            return self._end_if_drawn(window, call.name)
        self._last_commanding = call.number
        return (self._end(window, call.name, self._target(window), BACK, swapped=True),)

    def _switch(self, context):
        """Let the commands of another context run from now on."""
        self.run_waiting()
        self._running = context
        context.gl.behind, context.gl.drawing = self, self._drawing

    def run_waiting(self) -> None:
        """Run the waiting commands."""
        context, self._bytes, self._before = self._running, 0, 0
        if context is None or not context.gl.commands:
            return
        if not self._drawing:
            context.gl.commands.clear()
            return
        self._label()
        commands = context.gl.commands[:]
        context.gl.commands.clear()
        self._unlabelled = 0
        target = self._target(context.window)
        if target.textures is not context.group.textures:
            target.use_textures(context.group.textures)
        draws, refused = target.draws, target.refused
        target.counter = self._counters.get(context)
        self._resume(context, target)
        for command in commands:
            if isinstance(command, MakeCurrent):
                context.surface = None if command.surface is None else command
        target.bound = context.surface and context.surface.surface
        target.run(commands, *self._where(context.window))
        self.draws += target.draws - draws
        self.refused += target.refused - refused

    def _resume(self, context, target):
        """Go back to where a context draws, if another context drew elsewhere since."""
        name = context.surface and context.surface.surface
        if target.bound != name:
            there = context.surface or MakeCurrent(label="the window")
            target.run((there,), *self._where(context.window))
            target.bound = name

    def _where(self, window):
        """(the buffers that commands draw into, the buffer that they read)."""
        if window.double is False:
            return (FRONT,), FRONT
        values = self._running.gl.values
        draws, reads = values["draw_buffer"], values["read_buffer"]
        into, of = _BUFFERS.get(draws, (BACK,)), _BUFFERS.get(reads, (BACK,))
        return into, of[0] if of else BACK

    def _target(self, window):
        found = self._targets.get(window)
        if found is None:
            textures = self._running.group.textures if self._running is not None else {}
            given = self.profile, *window.size, textures, self.tally, self._threads
            found = self._targets[window] = self._kind(*given)
            self._forget_windows(window)
            self._begin_frame()
        return found

    def _forget_windows(self, kept):
        """If the windows have too many pixels, forget those that were made first. ``kept`` stays."""
        pixels = sum(target.width * target.height for target in self._targets.values())
        for window in list(self._targets):
            if pixels <= MOST_PIXELS or window is kept:
                break
            target = self._targets.pop(window)
            pixels -= target.width * target.height

    # ---------------------------------------------------------- what a Context asks of its machine (Behind)

    def read(self, command: ReadPixels) -> NDArray[Any]:
        """Draw the waiting commands, and read the pixels. Returns zeros if nothing is drawn."""
        self.run_waiting()
        if not self._drawing:
            return blank(command)
        window = self._running.window
        target = self._target(window)
        self._resume(self._running, target)
        return target.read(command, *self._where(window))

    def depth_bits(self) -> int:
        """How many bits a depth of ``read`` has."""
        return self._target(self._running.window).depth_bits()

    def count_samples(self, begun: bool) -> int | None:
        """Begin to count samples, or end counting and return the count. Returns None at the beginning, if no
        count is compared, or if nothing is drawn.
        """
        if self.check is None or not (self._drawing and issubclass(self._kind, Drawn)):
            self._counters.clear()
            return None
        self.run_waiting()
        if begun:
            self._counters[self._running] = SampleCounter()
            return None
        counter = self._counters.pop(self._running, None)
        return None if counter is None else counter.samples

    # -------------------------------------------------------------------------------------------- frames

    def _end_if_drawn(self, window, name):
        target = self._targets.get(window)
        return (self._end(window, name, *target.shown()),) if target is not None and target.drawn_into else ()

    def _end(self, window, name, shown, buffer, *, swapped=False):
        """End a frame of a window, which shows a buffer of the Target ``shown``. ``swapped``: whether the
        window's buffers are swapped then.
        """
        target, number = self._target(window), self.frames
        recording, wanted = shown.recording, self._wanted(number, target.draws)
        frame = Frame(
            number=number,
            window=window.number,
            width=shown.width,
            height=shown.height,
            first_call=self._first_call,
            last_call=self._last_call,
            seen_call=self._last_commanding,
            ended=name,
            draws=target.draws,
            refused=target.refused,
            image=shown.picture(buffer) if wanted else None,
            recording=recording,
            shown=buffer,
        )
        if frame.image is not None:
            frame = replace(frame, height=frame.image.shape[0], width=frame.image.shape[1])
        self.frames += 1
        self._first_call = self._last_call + 1
        target.end_frame()
        for each in self._targets.values():
            each.recording = None
        if swapped:
            target.swap()
        self._begin_frame()
        return frame

    def _begin_frame(self):
        """Record the frame if it is requested. If it is not needed and there is one window, let it wait."""
        recorded = self._recorded(self.frames)
        waits = not (recorded or self._needed(self.frames)) and len(self._targets) == 1
        for target in self._targets.values():
            target.postponing = waits
            if not waits:
                target.settle()
            if recorded and target.recording is None:
                target.record()

    # -------------------------------------------------------------------------------- calls of its own

    def _flush(self, context, call):
        """Handle Flush or Finish."""
        window = context.window
        if window.double and not window.unbound:
            return ()
        self.run_waiting()
        target = self._targets.get(window)
        if window.unbound:  # the trace has no swaps of this window
            return self._end_if_drawn(window, call.name)
        if target is not None and FRONT in target.drawn_into:
            self._last_commanding = call.number
            return (self._end(window, call.name, target, FRONT),)
        return ()

    def _terminate(self, context, call):
        self.run_waiting()
        return (self._end(context.window, call.name, *self._target(context.window).shown()),)

    def _size(self, context, call):
        gl = context.gl
        if gl.begun is not None or gl.list is not None or gl.drawable is not context.window.drawable:
            return ()
        size = self.windows.take_viewport(context, call.arguments, bool(call.flags & FAKE))
        if size is not None:
            self.run_waiting()
            drawable = context.window.drawable
            drawable.width, drawable.height = size
            if (target := self._targets.get(context.window)) is not None:
                target.resize(*size)
        return ()

    # ------------------------------------------------------------------------------------------- markers

    def _label(self):
        """Write the program's markers into the labels of the commands since the last marker."""
        commands = self._running.gl.commands
        words = [*self._markers, self._event] if self._event else self._markers
        if words:
            said = ": ".join(words)
            for place in range(self._unlabelled, len(commands)):
                command = commands[place]
                commands[place] = replace(command, label=f"{said}: {command.label}")
        self._unlabelled = len(commands)

    def _push_marker(self, context, call):
        self._label()
        texts = [argument for argument in call.arguments if isinstance(argument, str)]
        if len(self._markers) < _MOST_MARKERS:
            self._markers.append(_short(texts[-1]) if texts else "group")
        return ()

    def _pop_marker(self, context, call):
        self._label()
        if self._markers:
            self._markers.pop()
        self._event = ""
        return ()

    def _mark_event(self, context, call):
        self._label()
        texts = [argument for argument in call.arguments if isinstance(argument, str)]
        self._event = _short(texts[-1]) if texts else ""
        return ()


_QUERIES = ("glGet", "glIs")
_RESETTING = ("glGetHistogram", "glGetMinmax")  # they may reset the values that they return
_MOST_MARKERS = 64  # as many nested groups as KHR_debug requires
_LONGEST_MARKER = 80


def _short(text):
    text = " ".join(text.split())
    return text if len(text) <= _LONGEST_MARKER else text[: _LONGEST_MARKER - 1] + "…"


_OWN = {
    "glFrameTerminatorGREMEDY": Replay._terminate,
    "glPushDebugGroup": Replay._push_marker,
    "glPushDebugGroupKHR": Replay._push_marker,
    "glPushGroupMarkerEXT": Replay._push_marker,
    "glPopDebugGroup": Replay._pop_marker,
    "glPopDebugGroupKHR": Replay._pop_marker,
    "glPopGroupMarkerEXT": Replay._pop_marker,
    "glInsertEventMarkerEXT": Replay._mark_event,
    "glStringMarkerGREMEDY": Replay._mark_event,
    "glDebugMessageInsert": Replay._mark_event,
    "glDebugMessageInsertARB": Replay._mark_event,
}
_AFTER = {"glFlush": Replay._flush, "glFinish": Replay._flush, "glViewport": Replay._size}
