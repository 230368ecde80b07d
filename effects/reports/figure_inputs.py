"""A digest of all inputs of a figure's files. If it is unchanged, they need not be made again."""

import hashlib
from functools import cache

from fixedpipe.effects import data_files
from fixedpipe.effects.figures import identify
from fixedpipe.effects.source_digests import ROOT, digest_of, file_of, reached

# What turns every figure into its record and pictures.
DRAWS = ("fixedpipe.effects.reports.figure_record", "fixedpipe.effects.reports.pictures")


def inputs_of(module, what):
    """The digest of all inputs of a figure's files, 16 hexadecimal digits.

    module  the dotted name of the figure's module
    what    the other words of the order: its id, machines, size, whether it is checked

    The inputs are the modules that the figure's module and its report import, directly or not; the figure's
    part of the data file; the files beside such modules of ``effects`` that are no modules; and the versions
    of Python and of the packages that compute (docs/decisions/0022-figures-once-and-in-parallel.md).
    """
    names = reached((module, *DRAWS))
    found = hashlib.sha256(f"{what!r}\n{said_of(module)!r}\n{digest_of((), names)}\n".encode())
    for path in _files_beside(names):
        found.update(f"{path.relative_to(ROOT).as_posix()} {_digest_of_file(path)}\n".encode())
    return found.hexdigest()[:16]


def said_of(module):
    """The texts about a figure in the data file beside its module; none if there is no such file."""
    file = file_of(module)
    data = file and file.with_name("figures.toml")
    if not (data and data.is_file()):
        return ()
    return data_files.sections_of(data).get(identify(module.rpartition(".")[2]), ())[1:]


def _files_beside(names):
    """The files in the folders of these modules of ``effects`` that are no modules, in order."""
    folders = {file_of(name).parent for name in names if name.startswith("fixedpipe.effects.")}
    found = (path for folder in (*folders, ROOT / "effects") for path in _others_in(folder))
    return sorted(set(found), key=lambda path: path.as_posix())


@cache
def _others_in(folder):
    return tuple(
        path
        for path in folder.iterdir()
        if path.is_file() and path.suffix not in (".py", ".pyc") and path.name not in data_files.WORDS
    )


@cache
def _digest_of_file(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()
