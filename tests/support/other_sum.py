"""``sum`` as another version of Python computes it: from 3.12 on it makes up for the roundings of floats."""

import builtins
import math
import sys
from functools import reduce
from operator import add

_SUM = builtins.sum


def other_sum(items, /, start=0):
    """The builtin's result, but of floats: on 3.12 and newer added from the first to the last, and on older
    versions rounded once.
    """
    items = list(items)
    if not items or not all(type(item) is float for item in items):
        return _SUM(items, start)
    if sys.version_info >= (3, 12):
        return reduce(add, items, start)
    return math.fsum([start, *items])
