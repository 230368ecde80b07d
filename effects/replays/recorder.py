"""Writes OpenGL calls of your own as a trace, which this project and apitrace's programs replay.

    with Recorder("own.trace", 320, 240) as gl:
        gl.Clear(tokens.COLOR_BUFFER_BIT)
        gl.Begin(tokens.TRIANGLES)
        ...
        gl.End()
        gl.swap()

It needs no display, no driver and no apitrace, and it draws nothing.
"""

from collections.abc import Callable, Mapping
from os import PathLike
from typing import Any, BinaryIO

import numpy as np

from fixedpipe.pipeline.opengl.entry_points import resolve
from fixedpipe.pipeline.traces.calls import FAKE
from fixedpipe.pipeline.traces.writer import Pointer, Struct, TraceWriter

# The values that stand for the display, the window, its context and its visual in the trace.
_DISPLAY, _WINDOW, _CONTEXT, _VISUAL = Pointer(0x1000), 0x200001, Pointer(0x2000), 0x21
# GLX_RGBA, GLX_DOUBLEBUFFER, then GLX_DEPTH_SIZE and GLX_STENCIL_SIZE of at least 24 and 8 bits.
# Source: GLX 1.3 table 3.1.
_ATTRIBUTES = [4, 5, 12, 24, 13, 8, 0]


class Recorder:
    """Writes a trace of a double-buffered window of ``width`` x ``height`` pixels, with one context.

    Every entry point of OpenGL is a method, without the prefix gl, as in ``Context``. ``swap`` ends a frame.
    An array of numbers may be a list or an array. An image or an array of vertices may be bytes, or an array
    whose bytes are written.

    - ``target``: a path, or a binary file. ``properties``: the trace's properties, by name.
    - ``settings``: the other arguments of TraceWriter.
    """

    def __init__(
        self,
        target: str | PathLike[str] | BinaryIO,
        width: int,
        height: int,
        *,
        properties: Mapping[str, str] | None = None,
        **settings: Any,
    ):
        self._trace = TraceWriter(target, properties=properties, **settings)
        self._methods: dict[str, Callable[..., int]] = {}
        visual = [Struct("XVisualInfo", {"visualid": _VISUAL})]
        call = self._trace.call
        call("glXChooseVisual", ["dpy", "screen", "attribList"], [_DISPLAY, 0, _ATTRIBUTES], visual)
        names = ["dpy", "vis", "shareList", "direct"]
        call("glXCreateContext", names, [_DISPLAY, visual, None, True], _CONTEXT)
        call("glXMakeCurrent", ["dpy", "drawable", "ctx"], [_DISPLAY, _WINDOW, _CONTEXT], True)
        # apitrace records the window's size in the same way.
        for name in ("glViewport", "glScissor"):
            call(name, ["x", "y", "width", "height"], [0, 0, width, height], flags=FAKE)

    def __enter__(self) -> "Recorder":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Write the remaining data. Close the file, if this object opened it."""
        self._trace.close()

    def swap(self) -> int:
        """End a frame: the window shows its contents. Returns the call's number."""
        return self._trace.call("glXSwapBuffers", ["dpy", "drawable"], [_DISPLAY, _WINDOW])

    def __getattr__(self, name: str) -> Callable[..., int]:
        if name.startswith("_") or resolve("gl" + name) is None:
            raise AttributeError(f"OpenGL has no entry point gl{name} here.")
        found = self._methods.get(name)
        if found is None:

            def record(*arguments: Any) -> int:
                names = [f"argument{n}" for n in range(len(arguments))]
                return self._trace.call("gl" + name, names, [_written(each) for each in arguments])

            found = self._methods[name] = record
        return found


def _written(argument):
    """An argument in the form that a trace can hold."""
    if isinstance(argument, np.ndarray):
        return np.ascontiguousarray(argument).tobytes()
    if type(argument) is tuple:
        return list(argument)
    return argument.item() if hasattr(argument, "item") else argument  # a number of NumPy has ``item``
