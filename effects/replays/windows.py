"""Contexts and drawables: which Context gets a call, and which drawable it draws into.

A trace has a drawable's size only if apitrace inserted a call of Viewport after MakeCurrent. Later calls of
Viewport that extend beyond the drawable make it larger, as in glretrace. A pbuffer's size is among its
arguments.

If no configuration says whether a drawable has a back buffer, it is taken as double-buffered. Until its
buffers are swapped once, Flush or Finish also ends a frame if something was drawn into its front buffer.
"""

from dataclasses import dataclass, field
from typing import Any, NamedTuple

from fixedpipe.pipeline.commands import MakeCurrent
from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.attributes import copy_attributes
from fixedpipe.pipeline.opengl.context import Context, Drawable, Shared
from fixedpipe.pipeline.opengl.framebuffer_objects import bind_window
from fixedpipe.pipeline.opengl.outcomes import Tally
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.textures.images import Texture

# A drawable's size in pixels until the trace has it. Assumed: most programs of the time used this size.
USUAL_SIZE = (640, 480)
# What a context takes from its drawable when it first becomes current (GLX 1.3 section 3.3.7).
_OF_THE_DRAWABLE = tokens.VIEWPORT_BIT | tokens.SCISSOR_BIT
# More contexts are refused, so that a damaged trace does not fill the memory.
_MOST_CONTEXTS = 1024


class Known(NamedTuple):
    """The known properties of a configuration, a visual, a pixel format or a drawable.

    - ``double``: whether it has a back buffer; None: unknown.
    - ``indexed``: whether its colours are indices.
    """

    double: bool | None = None
    indexed: bool = False


@dataclass(eq=False)
class Group:
    """The objects of contexts that share them.

    - ``textures``: the machines' textures by name; one dictionary for all machines of the group.
    - ``stored``: the version of each texture object that the machines have.
    """

    shared: Shared = field(default_factory=Shared)
    textures: dict[str, Texture] = field(default_factory=dict)
    stored: dict[int, int] = field(default_factory=dict)


@dataclass(eq=False)
class Window:
    """A drawable: a window, a pbuffer or a pixmap.

    - ``number``: its number, from 0, in the order in which drawables were made current.
    - ``drawable``: the Drawable for its Context.
    - ``double``: whether it has a back buffer; None: unknown.
    - ``sized``: whether the trace has its size.
    - ``unbound``: whether no call made it current, because the calls of the window system were not recorded.
    """

    number: int
    drawable: Drawable
    double: bool | None
    sized: bool
    unbound: bool = False

    @property
    def size(self) -> tuple[int, int]:
        """Its width and height in pixels."""
        return self.drawable.width, self.drawable.height


@dataclass(eq=False)
class GLContext:
    """A context of the window system. Its Context is made when it becomes current for the first time.

    - ``known``: the properties of its configuration, for a drawable without properties of its own.
    - ``window``: the drawable that it was last bound to.
    - ``single``: whether it was made in a single-buffered drawable, and so draws into FRONT.
    - ``copied``: before it becomes current, the state that was copied into it; None: there is none.
    - ``surface``: the command that led its last commands into a pbuffer; None: they drew into the window.
    """

    group: Group
    known: Known = field(default_factory=Known)
    gl: Context | None = None
    window: Window | None = None
    single: bool = False
    copied: Context | None = None
    surface: MakeCurrent | None = None


class WindowSystem:
    """The contexts and drawables of a trace, on ``profile``.

    - ``size``: (width, height) of every drawable, up to the machine's limit; None: the sizes of the trace.
    - ``tally``: the Tally in which all contexts count.
    """

    def __init__(self, profile: Profile, tally: Tally, size: tuple[int, int] | None = None):
        self.profile, self.tally = profile, tally
        largest = profile.framebuffers.max_viewport
        self._size = None if size is None else (min(size[0], largest), min(size[1], largest))
        self._contexts: dict[Any, GLContext] = {}
        self._windows: dict[Any, Window] = {}
        self._sizes: dict[Any, tuple[int, int]] = {}  # of pbuffers
        self._known: dict[Any, Known] = {}  # by configuration, visual, pixel format or drawable
        self._aliases: dict[Any, Any] = {}  # a pbuffer's device context: the pbuffer
        self._current: dict[int, GLContext] = {}  # by thread
        self._made = 0

    def count_in(self, tally: Tally) -> None:
        """Let all contexts count in another Tally."""
        self.tally = tally
        for context in self._contexts.values():
            if context.gl is not None:
                context.gl.tally = tally

    def current(self, thread: int) -> GLContext | None:
        """The current context of a thread, or None."""
        return self._current.get(thread)

    def current_or_own(self, thread: int) -> GLContext | None:
        """As ``current``. If the trace has no calls of the window system, a context that is made for it."""
        found = self._current.get(thread)
        if found is None and (not self._contexts or None in self._contexts):
            found = self._contexts.setdefault(None, GLContext(Group()))
            self._bind(thread, found, None)
            found.window.unbound = True
        return found

    def take_viewport(
        self, context: GLContext, arguments: list[Any], inserted: bool
    ) -> tuple[int, int] | None:
        """The size that a call of Viewport gives to the context's drawable; None: its size does not change.

        ``inserted``: whether apitrace inserted the call; its rectangle is then the whole drawable.
        """
        window = context.window
        if window is None or self._size is not None or len(arguments) != 4:
            return None
        x, y, width, height = arguments
        if not all(type(number) is int for number in arguments) or width < 1 or height < 1 or x < 0 or y < 0:
            return None
        if not inserted and window.sized:
            width, height = max(x + width, window.size[0]), max(y + height, window.size[1])
        elif not inserted:
            width, height = x + width, y + height
        window.sized = True
        largest = self.profile.framebuffers.max_viewport
        asked = min(width, largest), min(height, largest)
        return None if asked == window.size else asked

    # --------------------------------------------------------------------------------------- making things

    def make_context(self, key: Any, config: Any, share: Any, indexed: bool = False) -> None:
        """Add the context ``key`` of a configuration, which shares the objects of ``share``."""
        if not key:
            return  # the call failed
        other = self._contexts.get(share) if share else None
        group = Group() if other is None else other.group
        known = self.known(config)
        self._contexts[key] = GLContext(group, known._replace(indexed=indexed or known.indexed))

    def make_pbuffer(self, key: Any, config: Any, width: int, height: int) -> None:
        """Add a pbuffer of a configuration."""
        largest = self.profile.framebuffers.max_viewport
        self._sizes[key] = min(max(int(width), 1), largest), min(max(int(height), 1), largest)
        self.say(key, self.known(config))

    def say(self, key: Any, known: Known) -> None:
        """Store the properties of a configuration, a visual, a pixel format or a drawable."""
        self._known[_key_of(key)] = known

    def known(self, key: Any) -> Known:
        """The known properties of a configuration, a visual, a pixel format or a drawable."""
        return self._known.get(_key_of(key), Known())

    def alias(self, name: Any, of: Any) -> None:
        """Let ``name`` be another name of a drawable."""
        self._aliases[name] = of

    def forget_drawable(self, key: Any) -> None:
        """Forget a drawable that is destroyed. Another one may get its name."""
        for known in (self._windows, self._sizes, self._known, self._aliases):
            known.pop(key, None)

    def make_current(self, call: Any, drawable: Any, context: Any) -> None:
        """Bind a context and a drawable in the call's thread; without a context, unbind."""
        if call.result == 0 and call.result is not None:
            return  # the call failed
        if not context:
            self._current.pop(call.thread, None)
            return
        if context not in self._contexts and len(self._contexts) >= _MOST_CONTEXTS:
            self.tally.add("refused", f"{call.name}: more than {_MOST_CONTEXTS} contexts")
            self._current.pop(call.thread, None)
            return
        # A context that the trace does not make existed before recording began.
        found = self._contexts.setdefault(context, GLContext(Group()))
        self._bind(call.thread, found, self._aliases.get(drawable, drawable))

    def destroy_context(self, key: Any) -> Window | None:
        """Forget a context; returns the drawable that it was bound to."""
        found = self._contexts.pop(key, None)
        if found is None:
            return None
        for thread, current in list(self._current.items()):
            if current is found:
                del self._current[thread]
        # Another context may go on with the drawable's frame.
        others = any(other.window is found.window for other in self._contexts.values())
        return None if others else found.window

    def share(self, first: Any, second: Any) -> None:
        """Let two contexts share their objects, as wglShareLists does."""
        given, taking = self._contexts[first], self._contexts[second]
        taking.group = given.group
        if taking.gl is not None:
            taking.gl.shared = given.group.shared

    def window_of(self, drawable: Any) -> Window | None:
        """The Window of a drawable that was made current. If no call bound a drawable, the only Window."""
        found = self._windows.get(self._aliases.get(drawable, drawable))
        return self._windows.get(None) if found is None else found

    def current_window(self, thread: int) -> Window | None:
        """The Window that a thread draws into."""
        found = self._current.get(thread)
        return None if found is None else found.window

    def window_of_context(self, key: Any) -> Window | None:
        """The Window that a context was last bound to."""
        found = self._contexts.get(key)
        return None if found is None else found.window

    def copy(self, source: Any, target: Any, mask: int) -> str:
        """Copy groups of state from one context to another, as glXCopyContext does; why not, or "".

        A context that was never current gets them when it is.
        """
        giving, taking = self._contexts.get(source), self._contexts.get(target)
        if giving is None or taking is None:
            return "no such context"
        if taking in self._current.values():
            return "the context that would be changed is current"
        given = giving.gl or giving.copied or self._made_context(giving, 1, 1)
        if taking.gl is None:
            taking.copied = taking.copied or self._made_context(taking, 1, 1)
        copy_attributes(given, taking.gl or taking.copied, mask)
        return ""

    def _made_context(self, context, width, height):
        made = Context(self.profile, width, height, shared=context.group.shared)
        made.tally = self.tally
        return made

    def _bind(self, thread, context, key):
        window = self._windows.get(key)
        if window is None:
            known = self._known.get(key, context.known)
            double = context.known.double if known.double is None else known.double
            size = self._size or self._sizes.get(key) or USUAL_SIZE
            drawable = Drawable(*size, double=double is not False)
            window = Window(self._made, drawable, double, self._size is not None or key in self._sizes)
            self._windows[key] = window
            self._made += 1
        drawable = window.drawable
        if context.gl is None:
            context.gl = self._made_context(context, drawable.width, drawable.height)
            if context.copied is not None:
                copy_attributes(context.copied, context.gl, tokens.ALL_ATTRIB_BITS & ~_OF_THE_DRAWABLE)
                context.copied = None
            context.single = not drawable.double
            if context.single:
                _choose_buffers(context.gl, tokens.FRONT)
        elif context.single and drawable.double:
            context.single = False
            if context.gl.values["draw_buffer"] == tokens.FRONT:
                _choose_buffers(context.gl, tokens.BACK)
        drawable.stored = context.group.stored
        bind_window(context.gl, drawable)
        context.window = window
        self._current[thread] = context


def _choose_buffers(gl, buffer):
    for key in ("draw_buffer", "read_buffer"):
        gl.values.set(key, buffer)


def _key_of(key):
    """The key for the known properties of ``key``. A visual is a structure, or an array of one structure."""
    key = only(key)
    return ("visual", key.get("visualid")) if isinstance(key, dict) else key


def only(value: Any) -> Any:
    """The first element of an array (the value that a pointer points to), or the value itself."""
    return value[0] if isinstance(value, list) and value else value
