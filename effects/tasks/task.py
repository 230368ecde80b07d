"""A task: a pure function, its parameters, and a digest of all that its result depends on."""

import hashlib
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, TypeAlias

# The files that a task makes in addition to its value: their bytes by name.
Files: TypeAlias = Mapping[str, bytes]


def canonical(value: Any) -> bytes:
    """A value as JSON; equal values give equal bytes. Raises ValueError for NaN and infinities."""
    return json.dumps(value, sort_keys=True, separators=(",", ":"), allow_nan=False).encode()


@dataclass(frozen=True)
class Task:
    """One piece of long work.

    work        a function at the top of a module, so that a worker finds it by its name. It takes
                ``parameters`` by keyword and returns a value that JSON can hold, or (value, Files). Equal
                parameters always give equal results
    parameters  values that JSON can hold
    said        the task's name in a line of progress or an error: "F004-4 alpha_x=0.1 on OCTANE"
    inputs      a digest of everything else that the result depends on: sources, packages, files of users
    """

    work: Callable[..., Any]
    parameters: Mapping[str, Any]
    said: str
    inputs: str = ""

    @cached_property
    def digest(self) -> str:
        """SHA-256 of the function's name, the parameters and the inputs: 64 hexadecimal digits."""
        name = f"{self.work.__module__}.{self.work.__qualname__}"
        return hashlib.sha256(canonical([name, dict(self.parameters), self.inputs])).hexdigest()


@dataclass(frozen=True)
class Outcome:
    """The result of a task.

    value    the value that its function returned; None if the task was refused or failed
    refused  the sentence of a Refusal: no result exists for these parameters, on any worker; "" otherwise
    failed   the error on the worker; another try may succeed; "" otherwise
    seconds  how long the function ran
    worker   "HOST:PROCESS" of the worker
    files    the Files that the function made
    """

    value: Any = None
    refused: str = ""
    failed: str = ""
    seconds: float = 0.0
    worker: str = ""
    files: Files = field(default_factory=dict)
