"""Types at the door: every public function that users call says what it takes and gives; its stub is whole.

``make check`` runs mypy over these modules; what it says of a user's file, test_installed asks.
"""

import ast
import importlib
import inspect
import pydoc
import re
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import get_args

import pytest

from fixedpipe import pipeline
from fixedpipe.effects import collection
from fixedpipe.effects.geometry import surfaces, views
from fixedpipe.pipeline.commands import ReadFormat, ReadType
from fixedpipe.pipeline.framebuffers.framebuffer import Framebuffer
from fixedpipe.pipeline.framebuffers.snapshot import Snapshot
from fixedpipe.pipeline.framebuffers.transfer import HistogramTable, MinmaxTable
from fixedpipe.pipeline.pixel_transfer import ImageFormat, PackedName
from fixedpipe.pipeline.textures.pixel_formats import (
    DEPTH_FORMAT,
    IMAGE_FORMATS,
    INDEX_FORMATS,
    PACKED_TYPES,
    READ_FORMATS,
    READ_TYPES,
)

ROOT = Path(__file__).parents[2]
STUB = ast.parse((ROOT / "pipeline" / "__init__.pyi").read_text())
# What users call: the door's names, a Result's parts, and what effects are made of.
CALLED = {name: getattr(pipeline, name) for name in pipeline.__all__}
CALLED |= {kind.__name__: kind for kind in (Framebuffer, Snapshot, HistogramTable, MinmaxTable)}
CALLED |= {
    name: value
    for module in (collection, surfaces, views)
    for name, value in vars(module).items()
    if not name.startswith("_") and getattr(value, "__module__", None) == module.__name__
}


def test_the_door_reads_every_line_of_its_stub():
    lines = [(node.module, [(alias.name, alias.asname) for alias in node.names]) for node in STUB.body]
    assert [names for _, names in lines] == [[(name, name)] for _, ((name, _),) in lines]
    assert pipeline.__all__ == sorted(name for _, ((name, _),) in lines)
    for module, ((name, _),) in lines:
        assert getattr(pipeline, name) is getattr(importlib.import_module(module), name)


def test_every_module_of_the_door_is_checked():
    checked = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["mypy"]["modules"]
    assert checked == sorted(checked)
    assert {node.module for node in STUB.body} <= set(checked)


def public_functions(value):
    """(name, function) of what users call of a function or class of the door, its properties too."""
    if inspect.isfunction(value):
        yield value.__name__, value
    if not inspect.isclass(value):
        return
    for name, member in vars(value).items():
        function = getattr(member, "fget", None) or getattr(member, "__func__", None) or member
        if inspect.isfunction(function) and (name == "__init__" or not name.startswith("_")):
            yield f"{value.__name__}.{name}", function


def without_types(function):
    """The names of a function's parameters that have no annotation, and "return"."""
    signature = inspect.signature(function)
    bare = [p.name for p in signature.parameters.values() if p.annotation is p.empty]
    if signature.return_annotation is signature.empty and function.__name__ != "__init__":
        bare.append("return")
    return [name for name in bare if name not in ("self", "cls")]


@pytest.mark.parametrize("name", CALLED)
def test_what_users_call_says_its_types(name):
    functions = dict(public_functions(CALLED[name]))
    assert {what: bare for what, function in functions.items() if (bare := without_types(function))} == {}


def test_the_rule_sees_what_has_no_types():
    class Bare:
        def __init__(self, x: int, y):
            pass

        @property
        def width(self):
            return 1

        @classmethod
        def new(cls, z) -> int:
            return z

        def _own(self, anything):
            pass

    found = {what: without_types(function) for what, function in public_functions(Bare)}
    assert found == {"Bare.__init__": ["y"], "Bare.width": ["return"], "Bare.new": ["z"]}


def test_strings_that_types_list_are_those_of_the_tables():
    assert {*get_args(ImageFormat)} == {*IMAGE_FORMATS, DEPTH_FORMAT, *INDEX_FORMATS}
    assert {*get_args(ReadFormat)} == {*READ_FORMATS, DEPTH_FORMAT, "STENCIL_INDEX"}
    assert {*get_args(PackedName)} == {*PACKED_TYPES}
    assert {*get_args(ReadType)} == {*READ_TYPES}


def test_mypy_finds_the_folders_under_their_name(tmp_path):
    (tmp_path / "Makefile").write_text((ROOT / "Makefile").read_text())
    for folder in ("raster", "pipeline", "effects"):
        (tmp_path / folder).mkdir()
    subprocess.run(["make", "--silent", ".cache/types/fixedpipe"], cwd=tmp_path, check=True)
    for folder in ("raster", "pipeline", "effects"):
        assert (tmp_path / ".cache/types/fixedpipe" / folder).resolve() == tmp_path.resolve() / folder


def test_help_names_a_command_and_not_all_kinds_of_commands():
    for function in (pipeline.execute, pipeline.execute_ideal, pipeline.validate, pipeline.describe):
        first = pydoc.plain(pydoc.render_doc(function)).splitlines()[2]
        assert "Iterable[Command | MultiDraw]" in first and "Clear" not in first and len(first) < 500, first


def test_help_of_the_door_is_a_page_that_names_all_it_has():
    # In a new process, where no name was asked for before.
    code = "import pydoc\nprint(pydoc.plain(pydoc.render_doc('fixedpipe.pipeline')))"
    page = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert len(page.splitlines()) <= 112
    topics = page.split("  to run a frame ")[1].split("``execute`` runs a frame")[0]
    named = re.findall(r"\w+", topics)
    assert set(pipeline.__all__) <= set(named)
    # What looks like a name of ours is one.
    assert {word for word in named if re.search(r"_[0-9A-Za-z]|[a-z][A-Z]", word)} <= set(pipeline.__all__)


def test_help_of_a_name_stays_whole():
    page = pydoc.plain(pydoc.render_doc(pipeline.Draw))
    assert "class Draw" in page and "mesh: " in page and len(page.splitlines()) > 30


def test_whoever_else_asks_finds_every_name():
    assert set(pipeline.__all__) <= set(dir(pipeline))
    assert set(pipeline.__all__) <= dict(inspect.getmembers(pipeline)).keys()
    found = {}
    exec("from fixedpipe.pipeline import *", found)
    assert set(pipeline.__all__) <= found.keys()
