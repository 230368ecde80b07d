"""A kernel that is kept on disk is of today's sources: its stamp changes with every file it is made of."""

import ast
import importlib
import types
from pathlib import Path

import pytest
from numba.core.dispatcher import Dispatcher

from fixedpipe.raster import kernel_files

ROOT = Path(kernel_files.__file__).parents[1]
WITH_KERNELS = sorted(
    path.relative_to(ROOT).as_posix()
    for folder in ("pipeline", "effects")
    for path in (ROOT / folder).rglob("*.py")
    if kernel_files._KERNELS in path.read_bytes()
)
SOURCES = {
    "effects/caller.py": (
        "from fixedpipe.effects.callee import (\n    one,\n)\nfrom fixedpipe.effects.numbers import TWO\n"
        "from fixedpipe.raster.fixed import three\n"
    ),
    "effects/callee.py": (
        "from fixedpipe.pipeline.last import four\nfrom fixedpipe.raster.kernel import kernel\n"
    ),
    "pipeline/last.py": "from fixedpipe.raster.kernel import kernel\n",
    "effects/numbers.py": "TWO = 2\n",
    "raster/fixed.py": "from fixedpipe.raster.kernel import kernel\n",
}


@pytest.fixture
def stamp(tmp_path, monkeypatch):
    """The digest of the caller, after a file has another line."""
    monkeypatch.setattr(kernel_files, "_PACKAGE", tmp_path)
    for name, text in SOURCES.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)

    def digest(changed):
        with (tmp_path / changed).open("a") as file:
            file.write("#\n")
        kernel_files._digest_of_sources.cache_clear()
        return kernel_files._digest_of_sources(tmp_path / "effects/caller.py")

    yield digest
    kernel_files._digest_of_sources.cache_clear()


@pytest.mark.parametrize("changed", SOURCES)
def test_a_stamp_changes_with_each_file_with_kernels_that_is_imported(stamp, changed):
    # What has no kernel makes none, and the kernels of raster/ are in a folder that has their digest's name.
    before = stamp("effects/numbers.py")
    assert (stamp(changed) != before) == (changed not in ("effects/numbers.py", "raster/fixed.py"))


def names_in(code):
    """What a function and those inside it name."""
    yield from code.co_names
    for each in code.co_consts:
        if isinstance(each, types.CodeType):
            yield from names_in(each)


@pytest.mark.parametrize("path", WITH_KERNELS)
def test_what_kernels_outside_raster_import_is_of_files_with_kernels(path):
    imported = {
        alias.asname or alias.name: node.module
        for node in ast.parse((ROOT / path).read_text()).body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    module = importlib.import_module(f"fixedpipe.{path.removesuffix('.py').replace('/', '.')}")
    own = [f for f in vars(module).values() if isinstance(f, Dispatcher) and f.__module__ == module.__name__]
    for name in {name for f in own for name in names_in(f.py_func.__code__)} & set(imported):
        package, _, rest = imported[name].partition(".")
        if package == "fixedpipe" and not f"{rest}.".startswith("raster."):
            assert f"{rest.replace('.', '/')}.py" in WITH_KERNELS, f"{name} of {imported[name]}"
