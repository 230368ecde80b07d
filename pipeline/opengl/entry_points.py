"""The table of entry points: the function that carries out a call, and OpenGL's rules for when it is allowed.

Each module of this package registers its calls with ``entry``. A name with a vendor's suffix and without an
entry means the same name without the suffix.

Source: OpenGL 1.2.1 section 2.6.3 (calls inside Begin and End) and 5.4 (calls that display lists compile).
"""

import re
from collections.abc import Callable
from typing import Any, NamedTuple


class EntryPoint(NamedTuple):
    """One entry point.

    - ``handler``: a function that is called with the Context and the arguments.
    - ``compiled``: whether a display list records the call. Other calls take effect at once.
    - ``inside``: whether the call is allowed between Begin and End.
    - ``capture``: a function of the Context and the arguments, called when the call is made. Its result
      replaces the arguments. It reads client memory, whose later contents a display list must not use.
    """

    name: str
    handler: Callable[..., Any]
    compiled: bool
    inside: bool
    capture: Callable[..., tuple[Any, ...]] | None


ENTRY_POINTS: dict[str, EntryPoint] = {}
_SUFFIX = re.compile(r"(ARB|EXT|NV|SGIS|SGIX|SGI|ATI|MESA|IBM|APPLE|HP|INGR|SUN|WIN)$")


def register(name, handler, *, compiled=True, inside=False, capture=None):
    """Add ``name``, without its prefix gl, to the table. Raises ValueError if it is there already."""
    if "gl" + name in ENTRY_POINTS:
        raise ValueError(f"The entry point gl{name} is registered twice.")
    ENTRY_POINTS["gl" + name] = EntryPoint("gl" + name, handler, compiled, inside, capture)


def entry(*names, compiled=True, inside=False, capture=None):
    """Decorate the function that carries out these entry points, which are named without the prefix gl."""

    def decorate(handler):
        for name in names:
            register(name, handler, compiled=compiled, inside=inside, capture=capture)
        return handler

    return decorate


def no_effect(*names, compiled=True, inside=False):
    """Register calls that do not change the state of this package."""
    for name in names:
        register(name, _nothing, compiled=compiled, inside=inside)


def _nothing(gl, *arguments):
    gl.tally.add("no effect", gl.called)


def resolve(name: str) -> EntryPoint | None:
    """The entry point of a name as programs write it ("glVertex3f"), or None."""
    point = ENTRY_POINTS.get(name)
    if point is None and (stem := _SUFFIX.sub("", name)) != name:
        point = ENTRY_POINTS.get(stem)
    return point
