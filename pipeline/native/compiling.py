"""Kernels that are compiled because no cache has them: their number, and the current one.

Lines on stderr report them, until ``watch_compiling`` is called.
"""

import types
from collections.abc import Callable
from functools import partial

from numba.core import event
from numba.core.dispatcher import Dispatcher

from fixedpipe.pipeline.native.waiting import Lines

# Called before each kernel's compilation with (the kernel's name, the number compiled, the number needed).
Say = Callable[[str, int, int], None]
_COMPILING = "numba:compile"


def _called(dispatcher):
    """The kernels that a kernel's code names, directly or in a module."""
    function = dispatcher.py_func
    names = function.__code__.co_names
    values = [function.__globals__.get(name) for name in names]
    modules = [value for value in values if isinstance(value, types.ModuleType)]
    values += [getattr(module, name, None) for module in modules for name in names]
    return [value for value in values if isinstance(value, Dispatcher)]


def needed_by(kernel):
    """The set of a kernel and all kernels that it calls, without those already compiled."""
    found, waiting = set(), [kernel]
    while waiting:
        dispatcher = waiting.pop()
        if dispatcher not in found and not dispatcher.overloads:
            found.add(dispatcher)
            waiting += _called(dispatcher)
    return found


class _Listener(event.Listener):
    def __init__(self, say, ended):
        self.say, self.ended = say, ended
        self.depth, self.done, self.needed = 0, 0, set()

    def on_start(self, event):
        kernel = event.data["dispatcher"]
        if not self.depth:
            # They are counted at the first request, because the frame decides which are needed.
            self.needed |= needed_by(kernel)
        self.needed.add(kernel)
        self.depth += 1
        self.say(kernel.py_func.__name__, self.done, max(len(self.needed), self.done + 1))

    def on_end(self, event):
        self.depth -= 1
        self.done += 1
        if not self.depth:
            self.done = len(self.needed)  # the cache had the others
            self.ended()


_written = Lines()
_lines = _Listener(_written.say, _written.end)  # until watch_compiling replaces it
event.register(_COMPILING, _lines)


def watch_compiling(say: Say, ended: Callable[[], None]) -> Callable[[], None]:
    """Call ``say`` before each kernel's compilation, and ``ended`` after it and all that it calls.

    Kernels in the cache are not compiled. Returns a function that ends the watching.
    """
    global _lines
    if _lines:
        event.unregister(_COMPILING, _lines)
        _lines = None
    listener = _Listener(say, ended)
    event.register(_COMPILING, listener)
    return partial(event.unregister, _COMPILING, listener)
