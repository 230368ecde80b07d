"""Annotations that other versions of NumPy write in another way."""

from types import GenericAlias, SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from fixedpipe.pipeline.validation.types import TypeChecks


class _Named:
    """As NumPy 2.5 has NDArray: an alias that is called by its name."""

    __value__ = np.ndarray[tuple[Any, ...], np.dtype[Any]]


@pytest.mark.parametrize(
    "annotation",
    [NDArray[Any], NDArray[np.float64], GenericAlias(_Named, (Any,))],
    ids=["any", "floats", "named"],
)
def test_an_array_is_asked_for_by_any_numpy(annotation):
    check = TypeChecks()[annotation]
    assert check(np.zeros(3)) is None
    assert "give a value of type ndarray" in check(SimpleNamespace()).predicate
