"""Calls that set one parameter by its name, such as Lightfv(light, pname, params), with four forms each.

Source: OpenGL 1.2.1 section 2.7 (table 2.6: how an integer becomes a colour's component), 2.13.1.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.entry_points import register
from fixedpipe.pipeline.opengl.outcomes import GLError

Vector4 = tuple[float, float, float, float]


class Parameter(NamedTuple):
    """The value of a parameter in a call.

    - ``numbers``: the numbers as they were given.
    - ``whole``: whether the call takes integers.
    - ``vector``: whether the call takes an array.
    """

    numbers: tuple[float, ...]
    whole: bool
    vector: bool

    def number(self) -> float:
        """The first number."""
        return float(self.numbers[0])

    def token(self) -> int:
        """The first number as a token. A call for floats may also pass a token (section 2.7)."""
        return int(self.numbers[0])

    def vector_of(self, count: int) -> tuple[float, ...]:
        """The first ``count`` numbers. Raises GLError for a call that takes one number."""
        if not self.vector:
            raise GLError(tokens.INVALID_ENUM, "a parameter of several numbers is given one")
        if len(self.numbers) < count:
            raise ValueError(f"{len(self.numbers)} numbers, where {count} are read")
        return tuple(map(float, self.numbers[:count]))

    def color(self) -> Vector4:
        """Four components. In a call for integers they are fractions of the largest integer (table 2.6)."""
        red, green, blue, alpha = self.vector_of(4)
        if self.whole:
            red, green, blue, alpha = [(2.0 * c + 1.0) / 4294967295.0 for c in (red, green, blue, alpha)]
        return red, green, blue, alpha


def numbers_of(given: Any) -> tuple[float, ...]:
    """The numbers of an argument, which is a list, an array or one number."""
    return tuple(np.asarray(given).reshape(-1).tolist())


def register_parameters(stem: str, set_parameter: Callable[..., None], **of_entry_point: bool) -> None:
    """Register stem + f, i, fv and iv. They call ``set_parameter(gl, *names, parameter)``.

    ``of_entry_point``: arguments of ``register``. The numbers are read when the call is made, so a display
    list does not use later contents of the array.
    """
    for kind in ("f", "i", "fv", "iv"):

        def read(gl, *arguments, kind=kind):
            *names, given = arguments
            return (*names, Parameter(numbers_of(given), kind[0] == "i", kind[-1] == "v"))

        register(stem + kind, set_parameter, capture=read, **of_entry_point)
