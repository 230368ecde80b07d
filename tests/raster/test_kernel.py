"""No stale kernel is loaded: the cache's name changes with every source that a kernel may be made of. And no
kernel takes a long list of arguments.
"""

import ast
from pathlib import Path

import pytest

from fixedpipe.raster import kernel


@pytest.fixture
def sources(tmp_path):
    """A folder of sources with a folder in it."""
    (tmp_path / "portable").mkdir()
    (tmp_path / "rows.py").write_text("A = 1\n")
    (tmp_path / "portable" / "sample.py").write_text("B = 1\n")
    return tmp_path


@pytest.mark.parametrize("name", ["rows.py", "portable/sample.py"])
def test_a_changed_source_changes_the_digest(sources, name):
    before = kernel.source_digest(sources)
    (sources / name).write_text("C = 2\n")
    assert kernel.source_digest(sources) != before


@pytest.mark.parametrize("name", ["codes.py", "vector/sample.py", "portable/deep/down.py"])
def test_a_new_source_changes_the_digest(sources, name):
    before = kernel.source_digest(sources)
    (sources / name).parent.mkdir(parents=True, exist_ok=True)
    (sources / name).write_text("")
    assert kernel.source_digest(sources) != before


def test_a_source_moved_to_another_folder_changes_the_digest(sources):
    before = kernel.source_digest(sources)
    (sources / "vector").mkdir()
    (sources / "portable" / "sample.py").rename(sources / "vector" / "sample.py")
    assert kernel.source_digest(sources) != before


def test_what_is_no_source_leaves_the_digest(sources):
    before = kernel.source_digest(sources)
    (sources / "portable" / "notes.txt").write_text("")
    assert kernel.source_digest(sources) == before


RASTER, MOST_ARGUMENTS = Path(kernel.__file__).parent, 12


@pytest.mark.parametrize("path", kernel.kernel_sources(RASTER), ids=str)
def test_what_belongs_together_is_one_argument(path):
    functions = [
        n for n in ast.walk(ast.parse((RASTER / path).read_text())) if isinstance(n, ast.FunctionDef)
    ]
    long = [f.name for f in functions if len(f.args.args) + len(f.args.kwonlyargs) > MOST_ARGUMENTS]
    assert not long, f"{path}: {', '.join(long)}: take named tuples (raster/arrays.py)"
