"""Checks of techniques' arguments: a colour, one of several names, a member of an Enum, a positive number.
Each raises a ValueError that names what does not fit.
"""

import math

import numpy as np


def checked_rgb(color, what="The colour"):
    """RGB in [0, 1] as three floats, the range of a machine's colours, constants and tables.

    Raises ValueError, naming ``what``, for anything else.
    """
    out = np.asarray(color)
    if out.shape != (3,) or out.dtype.kind not in "iuf" or not ((out >= 0.0) & (out <= 1.0)).all():
        raise ValueError(f"{what} is {color!r}; give red, green and blue from 0 to 1.")
    return tuple(out.astype(np.float64).tolist())


def one_of(choices, given, what):
    """What was given. Raises ValueError, naming ``what``, where it is none of the choices."""
    if given not in choices:
        raise ValueError(f"{what} is {given!r}; give one of {', '.join(map(repr, choices))}.")
    return given


def member_of(kind, given, what):
    """What was given. Raises ValueError, naming ``what``, where it is no member of the Enum ``kind``: a word
    that only compares equal to one is none.
    """
    if not isinstance(given, kind):
        choices = ", ".join(f"{kind.__name__}.{member.name}" for member in kind)
        raise ValueError(f"{what} is {given!r}; give one of {choices}.")
    return given


def positive(number, what):
    """A number as a float. Raises ValueError, naming ``what``, if it is not finite and above zero."""
    if not 0.0 < number < math.inf:
        raise ValueError(f"{what} is {number!r}; give a positive number.")
    return float(number)
