"""Writes a frame of commands as a Python script, and its arrays as an NPZ file next to it."""

import hashlib
import io
import math
from collections.abc import Iterable
from dataclasses import MISSING, fields, is_dataclass
from enum import Enum
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fixedpipe.pipeline.commands import COMMANDS, Command, HostStep

_HEAD = '''\
"""{title}

Written by fixedpipe replay. `fixedpipe inspect` and `fixedpipe compare` take it.
"""

from pathlib import Path

import numpy as np

{imports}

with np.load(Path(__file__).with_suffix(".npz")) as file:
    A = dict(file)

{shared}
profile, width, height = {profile!r}, {width}, {height}
commands = (
{commands})
'''


class _Writer:
    """Writes values as expressions. Equal states are written once, and have names."""

    def __init__(self):
        self.arrays: dict[str, NDArray[Any]] = {}
        self.lines: list[str] = []
        self.classes: dict[str, str] = {}  # name: module
        self._names_of_arrays: dict[bytes, str] = {}
        self._names: dict[str, str] = {}
        self._written: dict[int, tuple[Any, str]] = {}

    def text(self, value: Any) -> str:
        """A value as an expression."""
        if is_dataclass(value):
            return self._object(value)
        return next((write for kind, write in _WRITERS if isinstance(value, kind)), _Writer._plain)(
            self, value
        )

    def _plain(self, value):
        return repr(value)

    def _member(self, value):
        self.classes[type(value).__name__] = type(value).__module__
        return f"{type(value).__name__}.{value.name}"

    def _scalar(self, value):
        return self.text(value.item())

    def _float(self, value):
        return repr(value) if math.isfinite(value) else f'float("{value}")'

    def _sequence(self, value):
        return "(" + "".join(f"{self.text(part)}, " for part in value).rstrip() + ")"

    def _array(self, array):
        key = hashlib.sha256(f"{array.dtype}{array.shape}".encode() + np.ascontiguousarray(array).tobytes())
        name = self._names_of_arrays.setdefault(key.digest(), f"a{len(self.arrays)}")
        self.arrays[name] = array
        return f'A["{name}"]'

    def _object(self, value):
        found = self._written.get(id(value))
        if found is not None:
            return found[1]
        kind = type(value)
        self.classes[kind.__name__] = kind.__module__
        given = ", ".join(f"{name}={self.text(of)}" for name, of in _given(value))
        text = f"{kind.__name__}({given})"
        if not isinstance(value, COMMANDS):
            name = self._names.get(text)
            if name is None:
                name = self._names[text] = f"s{len(self._names)}"
                self.lines.append(f"{name} = {text}")
            text = name
        self._written[id(value)] = value, text
        return text


# By a value's class. The first that fits counts, because a member of an enumeration may also be a number.
_WRITERS = (
    (Enum, _Writer._member),
    (np.ndarray, _Writer._array),
    (np.generic, _Writer._scalar),
    (float, _Writer._float),
    (tuple | list, _Writer._sequence),
)


def _given(value):
    """(name, value) of the fields that differ from their defaults."""
    for each in fields(value):
        if not each.init:
            continue
        of = getattr(value, each.name)
        default = each.default if each.default_factory is MISSING else each.default_factory()
        if isinstance(of, np.ndarray) or default is MISSING or not _same(of, default):
            yield each.name, of


def _same(value, default):
    try:
        return value is default or (type(value) is type(default) and bool(value == default))
    except ValueError:  # the value contains arrays
        return False


def script_text(
    commands: Iterable[Command], profile: str, width: int, height: int, title: str
) -> tuple[str, dict[str, NDArray[Any]]]:
    """(text, arrays): a script that draws the commands on a machine, and the arrays of its NPZ file.

    Raises ValueError for a HostStep, because its function cannot be written as data.
    """
    writer, lines = _Writer(), []
    for command in commands:
        if isinstance(command, HostStep):
            raise ValueError(f'HostStep "{command.label}" is a function, which no script holds.')
        lines.append(f"    {writer.text(command)},\n")
    modules: dict[str, list[str]] = {}
    for name, module in sorted(writer.classes.items()):
        modules.setdefault(module, []).append(name)
    imports = "\n".join(
        f"from {module} import {', '.join(names)}" for module, names in sorted(modules.items())
    )
    text = _HEAD.format(
        title=title.replace("\\", "/").replace('"""', "'''"),
        imports=imports,
        shared="\n".join(writer.lines),
        profile=profile,
        width=width,
        height=height,
        commands="".join(lines),
    )
    return text, writer.arrays


def npz_bytes(arrays: dict[str, NDArray[Any]]) -> bytes:
    """The bytes of an NPZ file, compressed."""
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **arrays)
    return buffer.getvalue()


def npz_beside(script: Path) -> Path:
    """The path of the NPZ file of a script."""
    return script.with_suffix(".npz")
