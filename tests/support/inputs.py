"""What results of the tests' own long work depend on, for manifests."""

from functools import cache
from pathlib import Path

from fixedpipe.effects.tasks.environment import file_digest, whole_inputs

_TESTS = Path(__file__).parents[1]


@cache
def inputs_here() -> str:
    """``Task.inputs`` of a function of ``tests``, which may import anything of fixedpipe and of the tests."""
    return whole_inputs(*(file_digest(path) for path in sorted(_TESTS.rglob("*.py"))))
