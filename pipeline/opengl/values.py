"""OpenGL's state as values, and the parts of a PassState that are made from them.

A *value* is one piece of state under a key: a string, or a tuple if there are several, such as ("light", 0).
**Every value is immutable and hashable**: a number, a string, a tuple, a frozen dataclass. So PushAttrib
saves references, and PopAttrib sets them again. A part of a PassState is found again for equal values.

A *section* is such a part. It has the keys of the values, or names of other sections, that it reads, and a
function that makes it. When a value changes, the sections that read it are made again at the next draw.
"""

from collections.abc import Callable, Hashable
from typing import Any, NamedTuple


class Value(NamedTuple):
    """A declared value. ``initial`` may be a function of the Context. ``groups``: PushAttrib's bits."""

    initial: Any
    groups: int


class Section(NamedTuple):
    """A declared section. ``also(gl)`` returns what else it depends on, such as a texture's parameters."""

    reads: tuple[Hashable, ...]
    build: Callable[..., Any]
    also: Callable[[Any], Hashable] | None


VALUES: dict[Hashable, Value] = {}
SECTIONS: dict[str, Section] = {}


def declare(key: Hashable, initial: Any, groups: int = 0) -> None:
    """Declare a value, with OpenGL's initial value and the attribute groups to which it belongs."""
    if key in VALUES:
        raise ValueError(f"The value {key!r} is declared twice.")
    VALUES[key] = Value(initial, groups)


def section(name: str, *reads: Hashable, also: Callable[[Any], Hashable] | None = None):
    """Decorate ``build(gl, *inputs)``, which makes the section ``name`` from the values of ``reads``."""

    def decorate(build):
        if name in SECTIONS:
            raise ValueError(f"The section {name!r} is declared twice.")
        SECTIONS[name] = Section(reads, build, also)
        return build

    return decorate


# The most objects that are stored for a section. No frame has so many different states.
_KEPT = 4096


class Values:
    """The values of a Context, and its sections."""

    def __init__(self, gl):
        self._gl = gl
        self._of = {key: value.initial for key, value in VALUES.items() if not callable(value.initial)}
        for key, value in VALUES.items():
            if callable(value.initial):
                self._of[key] = value.initial(gl)
        self._readers = _readers()
        self._made: dict[str, Any] = {}
        self._kept: dict[str, dict[Hashable, Any]] = {name: {} for name in SECTIONS}
        self.generation = 0  # increases when a section may have changed

    def __getitem__(self, key: Hashable) -> Any:
        return self._of[key]

    def __contains__(self, key: Hashable) -> bool:
        return key in self._of

    def set(self, key: Hashable, value: Any) -> None:
        """Replace a value. If it differs, the sections that read it are made again."""
        old = self._of[key]
        if old is value or (type(old) is type(value) and old == value):
            return
        self._of[key] = value
        self.mark(*self._readers.get(key, ()))

    def mark(self, *names: str) -> None:
        """Let these sections be made again, even if their values have not changed."""
        for name in names:
            if self._made.pop(name, None) is not None:
                self.generation += 1
                self.mark(*self._readers.get(name, ()))

    def section(self, name: str) -> Any:
        """The section ``name``, made from the present values."""
        made = self._made.get(name)
        if made is None:
            declared = SECTIONS[name]
            of = self._of
            inputs = tuple([of[key] if key in of else self.section(key) for key in declared.reads])
            key = inputs if declared.also is None else (inputs, declared.also(self._gl))
            kept = self._kept[name]
            made = kept.get(key)
            if made is None:
                if len(kept) >= _KEPT:
                    kept.clear()
                made = kept[key] = (declared.build(self._gl, *inputs),)
            self._made[name] = made
        return made[0]


def _readers() -> dict[Hashable, tuple[str, ...]]:
    """The names of the sections that read each key."""
    readers: dict[Hashable, list[str]] = {}
    for name, declared in SECTIONS.items():
        for key in declared.reads:
            readers.setdefault(key, []).append(name)
    return {key: tuple(names) for key, names in readers.items()}
