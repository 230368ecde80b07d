"""PNG files of other pytest plug-ins, taken over as golden pictures of a test module.

The file's name alone says which test it belongs to. Plug-ins make that name from the test's and drop some
letters. So this module computes, for each existing test, the names that its file would have.
"""

import re
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from unicodedata import category

from fixedpipe.pipeline.framebuffers.pictures import whole_png
from fixedpipe.pipeline.golden.differences import Pixels, difference, kinds_differ
from fixedpipe.pipeline.golden.pixels import pixels_of_png
from fixedpipe.pipeline.golden.store import (
    StoreError,
    change_store,
    golden_of,
    picture_path,
    read_store,
    write_whole,
)

# Source: syrupy 7.0.2, extensions/single_file.py, _sanitize_filename and _max_stem_length
_NOT_IN_SYRUPYS = '\\/?*:|"<>'
_SYRUPYS_LONGEST = 255 - len(".png")
_NAMED = re.compile(r"(.+)\[([^\[\]]+)\]")  # a test's second picture: snapshot(name=…)


@dataclass
class Baselines:
    """PNG files of a folder, by the tests that they belong to.

    - ``of_tests``: {picture's name in the store: file}.
    - ``of_nobody``: files whose name belongs to no test.
    - ``shared``: {file: tests that all have its name}.
    """

    of_tests: dict[str, Path] = field(default_factory=dict)
    of_nobody: list[Path] = field(default_factory=list)
    shared: dict[Path, list[str]] = field(default_factory=dict)


@dataclass
class Taken:
    """The results of taking baselines.

    - ``new``: names that have become golden.
    - ``equal``: names that were golden with the same pixels.
    - ``left``: {name: why it was not taken}.
    """

    new: list[str] = field(default_factory=list)
    equal: list[str] = field(default_factory=list)
    left: dict[str, str] = field(default_factory=dict)


def stems(test: str, module: str) -> set[str]:
    """The names, without suffix, that plug-ins give the file of a test.

    ``test`` is pytest's name after the module, TestShapes::test_lit[wide]. ``module`` is the module's own
    name, test_sphere.
    """
    head, bracket, rest = test.partition("[")
    *classes, function = head.split("::")
    name = function + bracket + rest
    # Source: pytest-mpl 0.19.0, plugin.py, generate_filename, generate_test_name and pathify
    full = ".".join((module, *classes[-1:], name))
    found = {_pathified(name), _pathified(full)}
    # Source: pytest-regressions 2.11.0, common.py, resolve_check_paths
    found |= {re.sub(r"\W", "_", name), re.sub(r"\W", "_", "_".join((*classes[-1:], name)))}
    whole = ".".join((*classes, name))
    kept = (c for c in whole if c not in _NOT_IN_SYRUPYS and not category(c).startswith("C"))
    return found | {"".join(kept)[:_SYRUPYS_LONGEST]}


def _pathified(name):
    return re.sub(r"[\[\]/]", "_", name).removesuffix("_")


def find_baselines(folder: Path, module: str, tests: Iterable[str]) -> Baselines:
    """The PNG files of a folder by test; ``module`` and ``tests`` are as in ``stems``. Raises StoreError."""
    owners: dict[str, list[str]] = {}
    for test in tests:
        for stem in stems(test, module):
            owners.setdefault(stem, []).append(test)
    try:
        files = sorted(path for path in folder.iterdir() if path.suffix.lower() == ".png")
    except OSError as error:
        raise StoreError(f"{folder} cannot be read: {error.strerror}.") from error
    found = Baselines()
    for path in files:
        stem = path.stem
        # pytest-mpl may put the packages before the module's name.
        if (inner := stem.find(f".{module}.")) >= 0 and stem not in owners:
            stem = stem[inner + 1 :]
        mine = owners.get(stem, [])
        if not mine and (named := _NAMED.fullmatch(stem)):
            mine = [f"{test}::{named[2]}" for test in owners.get(named[1], ())]
        if not mine:
            found.of_nobody.append(path)
        elif len(mine) > 1 or mine[0] in found.of_tests:
            found.shared[path] = mine
        else:
            found.of_tests[mine[0]] = path
    return found


def take_baselines(store: Path, files: Mapping[str, Path], keep: bool = True) -> Taken:
    """Make files golden under their names, as many as possible at once; golden pictures stay.

    ``keep`` says whether PNG files are kept beside the store. Raises StoreError; the store is then unchanged.
    """
    golden, taken, pictures = read_store(store), Taken(), {}
    for name, path in files.items():
        try:
            pixels = pixels_of_png(path.read_bytes(), str(path))
        except OSError as error:
            taken.left[name] = f"{path} cannot be read: {error.strerror}"
            continue
        except ValueError as error:
            taken.left[name] = str(error)
            continue
        if name not in golden:
            taken.new.append(name)
            pictures[name] = pixels
        elif golden[name].sha256 == golden_of(pixels).sha256:
            taken.equal.append(name)
        else:
            what = _differs(store, name, pixels)
            taken.left[name] = f"another picture is golden, and stays{f': {what}' if what else ''}"
    change_store(store, {name: golden_of(pixels) for name, pixels in pictures.items()})
    try:
        for name in pictures if keep else ():
            write_whole(picture_path(store, name), whole_png(pictures[name]))
    except BaseException as error:
        change_store(store, dict.fromkeys(pictures))
        for name in pictures:
            with suppress(OSError):
                picture_path(store, name).unlink(missing_ok=True)
        if isinstance(error, StoreError):
            raise StoreError(f"{error} Nothing was taken.") from error
        raise
    return taken


def _differs(store: Path, name: str, pixels: Pixels) -> str:
    """How a baseline differs from the golden picture's file; empty without such a file."""
    try:
        expected = pixels_of_png(picture_path(store, name).read_bytes())
    except (OSError, ValueError):
        return ""
    return kinds_differ(expected, pixels) or str(difference(expected, pixels))
