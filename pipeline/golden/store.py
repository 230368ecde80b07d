"""Accepted pictures: a JSON file for each test module, with a line for each picture, and PNG files beside it.

    tests/test_sphere.py
    tests/golden/test_sphere.json
    tests/golden/test_sphere/lit.png

Only accepting writes a file; tests only read it. A file is written whole, under a lock, so that two processes
that accept at once, or one that is stopped, lose no line. The digests cover pixels and no PNG file, because
programs write the same pixels as different files.
"""

import hashlib
import json
import os
import re
import tempfile
from collections.abc import Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from fixedpipe.pipeline.golden.differences import Pixels, said
from fixedpipe.pipeline.golden.digests import digest

FORMAT = 1
_SHA256 = re.compile(r"[0-9a-f]{64}")
_MARKERS = ("<<<<<<< ", "=======", ">>>>>>> ", "||||||| ")
_SAFE = re.compile(r"[^A-Za-z0-9_.+-]+")
_VARIANT = re.compile(r"[A-Za-z0-9_.+-]{1,40}")
_OF_VARIANT = re.compile(rf"(.*[^:]):{_VARIANT.pattern}", re.DOTALL)
_LONGEST = 60  # the longest part of a picture's name in a file's name, in characters
_DTYPES = ("uint8", "uint16")


class StoreError(ValueError):
    """A store that cannot be read or written; the message says why and what to do."""


@dataclass(frozen=True)
class Passed:
    """The digests after one command of a frame.

    - ``label``, ``kind``: the command's.
    - ``planes``: the first eight hexadecimal digits of the digests of the colours, depths and stencil values.
    - ``stages``: (stage, digest of its results).
    """

    label: str
    kind: str
    planes: tuple[str, str, str]
    stages: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True)
class GoldenPicture:
    """An accepted picture.

    - ``width``, ``height``, ``components``, ``dtype``: 1 to 4 components, "uint8" or "uint16".
    - ``sha256``: the digest of its pixels (``digest``).
    - ``passes``: for a frame, the digests after each command.
    - ``made``: what drew it, as far as known: versions, the profile.
    """

    width: int
    height: int
    components: int
    dtype: str
    sha256: str
    passes: tuple[Passed, ...] = ()
    made: Mapping[str, str] = field(default_factory=dict)

    def __str__(self) -> str:
        return said(np.empty((self.height, self.width, self.components), self.dtype))


def golden_of(pixels: Pixels, passes: tuple[Passed, ...] = (), made: Mapping[str, str] | None = None):
    """The GoldenPicture of pixels in the form of ``pixels_of``."""
    height, width, components = pixels.shape
    return GoldenPicture(width, height, components, str(pixels.dtype), digest(pixels), passes, made or {})


# --------------------------------------------------------------------------------------------- variants


def variant_key(key: str, variant: str | None) -> str:
    """The name of a picture's variant, which a platform or driver draws: test_lit::side:mesa-22.3.

    Without a variant it is the picture's own name. Raises ValueError for a name that no variant can have.
    """
    if variant is None:
        return key
    if not isinstance(variant, str) or not _VARIANT.fullmatch(variant):
        raise ValueError(
            f"The variant cannot be named {variant!r}; give 1 to 40 ASCII letters, digits, dots, pluses, "
            "hyphens and underscores, as mesa-22.3."
        )
    return f"{key}:{variant}"


def plain_key(key: str) -> str:
    """The name of a picture without its variant.

    Pictures' names have no colon, and pytest's names of parametrised tests end in a bracket.
    """
    found = _OF_VARIANT.fullmatch(key)
    return found[1] if found else key


# ---------------------------------------------------------------------------------------------- as text


def to_object(golden: GoldenPicture) -> dict[str, Any]:
    """The JSON object of a GoldenPicture."""
    written: dict[str, Any] = {
        "size": [golden.width, golden.height, golden.components],
        "dtype": golden.dtype,
        "sha256": golden.sha256,
    }
    if golden.passes:
        written["passes"] = [
            [p.label, p.kind, *p.planes, *([dict(p.stages)] if p.stages else ())] for p in golden.passes
        ]
    if golden.made:
        written["made"] = dict(golden.made)
    return written


def from_object(given: Any) -> GoldenPicture:
    """The GoldenPicture that ``to_object`` wrote. Raises ValueError for anything else, with the reason."""
    try:
        unknown = given.keys() - {"size", "dtype", "sha256", "passes", "made"}
        width, height, components = given["size"]
        passes = tuple(
            Passed(p[0], p[1], (p[2], p[3], p[4]), tuple(p[5].items()) if len(p) > 5 else ())
            for p in given.get("passes", ())
        )
        golden = GoldenPicture(
            width, height, components, given["dtype"], given["sha256"], passes, dict(given.get("made", {}))
        )
        counts = all(type(n) is int and n > 0 for n in (width, height, components)) and components <= 4
        texts = (golden.sha256, *(text for p in passes for text in (p.label, p.kind, *p.planes)))
    except (AttributeError, KeyError, TypeError, ValueError, IndexError) as error:
        raise ValueError(f"it is no golden picture ({type(error).__name__}: {error})") from error
    if unknown:
        raise ValueError(f"it has {', '.join(sorted(unknown))}, which no golden picture has")
    if not counts or golden.dtype not in _DTYPES or not all(isinstance(text, str) for text in texts):
        raise ValueError("its size, type or passes are none")
    if not _SHA256.fullmatch(golden.sha256):
        raise ValueError(f"its digest is {str(golden.sha256)[:80]!r}, which is no SHA-256")
    return golden


def to_text(pictures: Mapping[str, GoldenPicture]) -> str:
    """The text of a store's file: sorted, a line for each picture."""
    lines = (f"  {_line(name)}: {_line(to_object(pictures[name]))}" for name in sorted(pictures))
    return f'{{"format": {FORMAT}, "pictures": {{\n' + ",\n".join(lines) + "\n}}\n"


def _line(value):
    return json.dumps(value, ensure_ascii=False)


def from_text(text: str, path: Path) -> dict[str, GoldenPicture]:
    """The pictures of a text that ``to_text`` wrote, read from the file ``path``. Raises StoreError."""
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith(_MARKERS):
            raise StoreError(
                f"{path}, line {number}: a merge left its conflict markers. Keep one line for each picture "
                "and remove the markers; a line is a picture."
            )
    try:
        found = json.loads(text, object_pairs_hook=_once)
    except ValueError as error:
        raise StoreError(
            f"{path} cannot be read: {error}. Take it from version control again, or remove it and record "
            "its pictures anew."
        ) from error
    if not isinstance(found, dict) or not isinstance(found.get("pictures"), dict) or "format" not in found:
        raise StoreError(
            f"{path} is no file of golden pictures, which begins with format and pictures. Move it elsewhere."
        )
    if found["format"] != FORMAT:
        raise StoreError(
            f"{path} has the format {found['format']!r}; this fixedpipe reads {FORMAT}. Use the fixedpipe "
            "that wrote it, or record its pictures anew."
        )
    pictures = {}
    for name, given in found["pictures"].items():
        try:
            pictures[name] = from_object(given)
        except ValueError as error:
            raise StoreError(
                f"{path}: of {name!r}, {error}. Take the line from version control again, or remove it."
            ) from error
    return pictures


def _once(pairs):
    """A JSON object without repeated keys: a merge may leave two lines of one picture."""
    found = dict(pairs)
    if len(found) != len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"{twice!r} stands there twice; keep one line")
    return found


# --------------------------------------------------------------------------------------------- as files


def read_store(path: Path) -> dict[str, GoldenPicture]:
    """The accepted pictures of a file, by name; none without the file. Raises StoreError."""
    try:
        return from_text(path.read_text(encoding="utf-8-sig"), path)  # Windows' byte order mark
    except FileNotFoundError:
        return {}
    except UnicodeDecodeError as error:
        raise StoreError(
            f"{path} is no text ({error.reason}); take it from version control again."
        ) from error
    except OSError as error:
        raise StoreError(f"{path} cannot be read: {error.strerror}.") from error


def write_whole(path: Path, data: bytes) -> None:
    """Write a file whole or not at all, with its folder if needed.

    Raises StoreError; the earlier file then stays.
    """
    temporary = None
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=".", suffix=".tmp")
        temporary = Path(name)
        with os.fdopen(handle, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        mask = os.umask(0)
        os.umask(mask)
        temporary.chmod(0o666 & ~mask)
        temporary.replace(path)
    except BaseException as error:
        if temporary is not None:
            with suppress(OSError):
                temporary.unlink()
        if isinstance(error, OSError):
            raise StoreError(
                f"{path} cannot be written: {error.strerror}. The old file is unchanged."
            ) from error
        raise


@contextmanager
def _locked(folder):
    """Keep other processes from changing stores of the folder; a process that ends frees its lock."""
    folder.mkdir(parents=True, exist_ok=True)
    if os.name == "nt":  # Windows cannot lock folders; files are still written whole.
        yield
        return
    import fcntl

    handle = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        os.close(handle)


def change_store(path: Path, changes: Mapping[str, GoldenPicture | None]) -> None:
    """Set pictures of a store, or remove those given as None.

    Raises StoreError; the file is then unchanged.
    """
    try:
        with _locked(path.parent):
            pictures = read_store(path)
            for name, golden in changes.items():
                if golden is None:
                    pictures.pop(name, None)
                else:
                    pictures[name] = golden
            if pictures or path.exists():
                write_whole(path, to_text(pictures).encode())
    except OSError as error:
        raise StoreError(f"{path} cannot be written: {error.strerror}.") from error


def file_name(name: str) -> str:
    """A file's name, without suffix, for a picture: the same name where possible, else with a digest."""
    safe = _SAFE.sub("-", name).strip("-.")[:_LONGEST]
    if safe == name == name.lower():  # Some systems make one file of two names that differ in case alone.
        return safe
    return f"{safe or 'picture'}-{hashlib.sha256(name.encode()).hexdigest()[:8]}"


def picture_path(store: Path, name: str) -> Path:
    """The PNG file of a picture of a store."""
    return store.with_suffix("") / f"{file_name(name)}.png"
