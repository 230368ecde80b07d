"""The table of entry points: which function answers a call, and what OpenGL says of when it may be called.

Each module of this package registers its own with ``entry``. A name with a vendor's suffix that has no entry
of its own is the name without it.

Source: OpenGL 1.2.1 section 2.6.3 (calls inside Begin and End) and 5.4 (calls that display lists compile).
"""

import re
from collections.abc import Callable
from typing import Any, NamedTuple


class EntryPoint(NamedTuple):
    """One entry point.

    - ``handler``: called with the Context and the arguments.
    - ``compiled``: whether a display list records the call. Others take effect at once.
    - ``inside``: whether the call may stand between Begin and End.
    - ``capture``: called with the Context and the arguments, when the call is made; what it returns replaces
      the arguments. It reads client memory, whose later contents a display list must not see.
    """

    name: str
    handler: Callable[..., Any]
    compiled: bool
    inside: bool
    capture: Callable[..., tuple[Any, ...]] | None


ENTRY_POINTS: dict[str, EntryPoint] = {}
_SUFFIX = re.compile(r"(ARB|EXT|NV|SGIS|SGIX|SGI|ATI|MESA|IBM|APPLE|HP|INGR|SUN|WIN)$")


def register(name, handler, *, compiled=True, inside=False, capture=None):
    """Enter ``name``, without its gl, into the table. Raises ValueError where it stands there already."""
    if "gl" + name in ENTRY_POINTS:
        raise ValueError(f"The entry point gl{name} is registered twice.")
    ENTRY_POINTS["gl" + name] = EntryPoint("gl" + name, handler, compiled, inside, capture)


def entry(*names, compiled=True, inside=False, capture=None):
    """Decorate the function that answers these entry points, which are named without their gl."""

    def decorate(handler):
        for name in names:
            register(name, handler, compiled=compiled, inside=inside, capture=capture)
        return handler

    return decorate


def no_effect(*names, compiled=True, inside=False):
    """Enter calls that change nothing that this package keeps."""
    for name in names:
        register(name, _nothing, compiled=compiled, inside=inside)


def _nothing(gl, *arguments):
    gl.tally.add("no effect", gl.called)


def resolve(name: str) -> EntryPoint | None:
    """The entry point of a name as a program calls it, or None."""
    point = ENTRY_POINTS.get(name)
    if point is None and (stem := _SUFFIX.sub("", name)) != name:
        point = ENTRY_POINTS.get(stem)
    return point
