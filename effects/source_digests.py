"""A digest of the sources that a module is made of: its own, and those of all modules that it imports."""

import ast
import hashlib
import platform
from collections.abc import Iterable
from functools import cache
from importlib import metadata
from pathlib import Path

_PACKAGE = "fixedpipe."
ROOT = Path(__file__).parents[1]  # of raster, pipeline and effects
_PACKAGES = ("numpy", "numba", "llvmlite", "pillow")


def digest_of(names: Iterable[str], reached_names: frozenset[str] | None = None) -> str:
    """The digest of the sources of these modules and of all that they import, and of the versions of Python
    and of the packages that compute: 64 hexadecimal digits.

    ``reached_names``: what ``reached`` said of them, where that is known.
    """
    found = hashlib.sha256(versions().encode())
    for name in sorted(reached(names) if reached_names is None else reached_names):
        found.update(f"{name} {_read(name)[0]}\n".encode())
    return found.hexdigest()


@cache
def versions() -> str:
    """Python and the packages that compute, with their versions."""
    packages = (f"{package} {metadata.version(package)}" for package in _PACKAGES)
    return "\n".join((f"python {platform.python_version()}", *packages))


def reached(names: Iterable[str]) -> frozenset[str]:
    """The modules of fixedpipe among names, all modules of it that they import, at the top or in a function,
    directly or not, and their packages.

    They are found in the syntax trees, so a module under a name that is made at run time is missed.
    """
    found, waiting = set(), list(names)
    while waiting:
        name = waiting.pop()
        if name not in found and file_of(name):
            found.add(name)
            waiting += _read(name)[1]
            waiting.append(name.rpartition(".")[0])
    return frozenset(found)


@cache
def file_of(name: str) -> Path | None:
    """The file of a module or package of fixedpipe; None if the name is of neither."""
    if not name.startswith(_PACKAGE):
        return None
    path = ROOT.joinpath(*name.removeprefix(_PACKAGE).split("."))
    places = path.with_suffix(".py"), path / "__init__.py"
    return next((place for place in places if place.is_file()), None)


@cache
def _read(name):
    """The digest of a module's source, and the names of all that it may import."""
    source = file_of(name).read_bytes()
    return hashlib.sha256(source).hexdigest(), _imported(source)


@cache
def _imported(source):
    """The names of all that a source may import."""
    found = []
    for statement in _statements(ast.parse(source)):
        found += _IMPORTED.get(type(statement), lambda statement: ())(statement)
    return found


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


def forget() -> None:
    """Read the sources again at the next use."""
    _read.cache_clear()
    file_of.cache_clear()
