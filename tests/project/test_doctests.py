"""Every module is imported by the name that users know, and its examples give what they say."""

import doctest
import importlib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
# Not ``__main__``: importing it runs the command line.
MODULES = [
    ".".join(("fixedpipe", *path.relative_to(ROOT).with_suffix("").parts)).removesuffix(".__init__")
    for folder in ("raster", "pipeline", "effects")
    for path in sorted((ROOT / folder).rglob("*.py"))
    if path.stem != "__main__"
]


@pytest.mark.parametrize("name", MODULES)
def test_a_module_is_imported_and_its_examples_hold(name):
    module = importlib.import_module(name)
    assert module.__name__ == name
    if ">>>" in Path(module.__file__).read_text():  # looking for examples where there are none takes longest
        assert doctest.testmod(module).failed == 0


def test_the_door_of_the_pipeline_has_examples():
    assert doctest.testmod(importlib.import_module("fixedpipe.pipeline")).attempted >= 20
