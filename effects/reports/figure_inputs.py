"""A digest of all inputs of a figure's files. If it is unchanged, they need not be made again."""

import ast
import hashlib
import platform
from functools import cache
from importlib import metadata
from pathlib import Path

from fixedpipe.effects import data_files
from fixedpipe.effects.figures import identify

_BELOW = "fixedpipe.effects."
_ROOT = Path(__file__).parents[1]
# What turns every figure into its record and pictures.
_DRAWS = ("fixedpipe.effects.reports.figure_record", "fixedpipe.effects.reports.pictures")
_PACKAGES = ("numpy", "numba", "llvmlite", "pillow")


def inputs_of(module, what):
    """The digest of all inputs of a figure's files, 16 hexadecimal digits.

    module  the dotted name of the figure's module
    what    the other words of the order: its id, machines, size, whether it is checked

    The inputs are the sources of ``raster`` and ``pipeline``; the modules of ``effects`` that the figure's
    module and its report import, directly or not; the figure's part of the data file; the other files of
    ``effects`` that are not modules; and the versions of Python and of the packages that compute
    (docs/decisions/0022-figures-once-and-in-parallel.md).
    """
    found = hashlib.sha256(f"{_common()}\n{what!r}\n{_said(module)!r}\n".encode())
    for name in sorted(_reached((module, *_DRAWS))):
        found.update(f"{name} {_read(name)[0]}\n".encode())
    return found.hexdigest()[:16]


def _said(module):
    """What the data file beside a figure's module says of it: texts; none where there is no such file."""
    file = _file(module)
    data = file and file.with_name("figures.toml")
    if not (data and data.is_file()):
        return ()
    return data_files.sections_of(data).get(identify(module.rpartition(".")[2]), ())[1:]


@cache
def _common():
    """The digest of what all figures depend on."""
    found = hashlib.sha256(platform.python_version().encode())
    for package in _PACKAGES:
        found.update(f"{package} {metadata.version(package)}\n".encode())
    files = [path for package in ("raster", "pipeline") for path in (_ROOT.parent / package).rglob("*.py")]
    others = (path for path in _ROOT.rglob("*") if path.is_file() and path.suffix not in (".py", ".pyc"))
    files += [path for path in others if path.name not in data_files.WORDS]
    for path in sorted(files, key=Path.as_posix):
        name = path.relative_to(_ROOT.parent).as_posix()
        found.update(f"{name} {hashlib.sha256(path.read_bytes()).hexdigest()}\n".encode())
    return found.hexdigest()


def _reached(names):
    """The modules of ``effects`` among names, and all that they import of it, with their packages: a set."""
    found, waiting = set(), list(names)
    while waiting:
        name = waiting.pop()
        if name not in found and _file(name):
            found.add(name)
            waiting += _read(name)[1]
            waiting.append(name.rpartition(".")[0])
    return found


def _file(name):
    """The file of a module or package of ``effects``; None where the name is of neither."""
    if not name.startswith(_BELOW):
        return None
    path = _ROOT.joinpath(*name.removeprefix(_BELOW).split("."))
    places = path.with_suffix(".py"), path / "__init__.py"
    return next((place for place in places if place.is_file()), None)


@cache
def _read(name):
    """The digest of a module's source, and the names of all that it may import."""
    source = _file(name).read_bytes()
    imported = []
    for statement in _statements(ast.parse(source)):
        imported += _IMPORTED.get(type(statement), lambda statement: ())(statement)
    return hashlib.sha256(source).hexdigest(), imported


def _statements(tree):
    """Every statement below a node. Expressions hold none and are not entered: they are nine tenths of it."""
    for name in _BLOCKS:
        for inner in getattr(tree, name, ()):
            yield inner
            yield from _statements(inner)


# The fields of syntax trees that are lists of statements, or of what holds statements.
_BLOCKS = "body", "orelse", "finalbody", "handlers", "cases"


# What may be imported by a statement: of "from a import b" both a and a.b.
_IMPORTED = {
    ast.Import: lambda node: [alias.name for alias in node.names],
    ast.ImportFrom: lambda node: [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)],
}
