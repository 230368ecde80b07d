"""Pictures of a test run that are not golden and wait for review, and the results of the run.

    .golden/                          in the project's root folder; git ignores it
    .golden/run.json                  for every picture that a test compared: the result, and its place
    .golden/candidates/NAME.json      a picture that differs or is new, and NAME.png, its pixels

Each picture has its own files, written whole, so processes that run tests at the same time never write one
file. Only ``accept`` moves a picture from here into a store.
"""

import json
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from fixedpipe.pipeline.framebuffers.pictures import whole_png
from fixedpipe.pipeline.golden.differences import Difference, Pixels, difference, kinds_differ
from fixedpipe.pipeline.golden.digests import digest
from fixedpipe.pipeline.golden.pixels import pixels_of_png
from fixedpipe.pipeline.golden.store import (
    GoldenPicture,
    StoreError,
    change_store,
    file_name,
    from_object,
    picture_path,
    read_store,
    to_object,
    write_whole,
)

FOLDER = ".golden"
NEW, CHANGED, PASSED, ORPHAN, MISSING, RECORDED = "new", "changed", "passed", "orphan", "missing", "recorded"
ALLOWED = "allowed"  # differs within its test's allowance
EXCUSED = "excused"  # of a skipped test, or of one that failed as expected


@dataclass(frozen=True)
class Candidate:
    """A picture that is not golden.

    - ``name``: the full name: tests/test_sphere.py::test_lit.
    - ``store``: its store's file, relative to the root, with slashes.
    - ``key``: its name in the store.
    - ``status``: NEW or CHANGED.
    - ``golden``: the GoldenPicture that would be accepted.
    - ``expected``: the digest of the current golden picture; None: there is none.
    - ``told``: sentences on the differences.
    - ``keep``: whether its PNG file is kept beside the store.
    - ``against``: the name in the store of the golden picture that it is compared with, if another: a new
      variant is compared with the plain picture.
    """

    name: str
    store: str
    key: str
    status: str
    golden: GoldenPicture
    expected: str | None
    told: str
    keep: bool = True
    against: str = ""


def workplace(start: Path) -> Path:
    """The project's root: the first folder from ``start`` upwards that has a .golden folder.

    Raises StoreError where there is none.
    """
    for folder in (start, *start.parents):
        if (folder / FOLDER).is_dir():
            return folder
    raise StoreError(
        f"There is no folder {FOLDER} in {start} or above it: no test has asked for a golden picture there. "
        "Run pytest first, or name the project's folder with --root."
    )


def prepare(root: Path) -> Path:
    """The folder of candidates, created if needed, with a .gitignore. Raises StoreError."""
    folder = root / FOLDER / "candidates"
    ignored = root / FOLDER / ".gitignore"
    if not ignored.exists():
        write_whole(ignored, b"# What runs of tests drew; nothing of it is golden.\n*\n")
    return folder


def _paths(root, name):
    base = root / FOLDER / "candidates" / file_name(name)
    return base.with_name(base.name + ".json"), base.with_name(base.name + ".png")


def write_candidate(root: Path, candidate: Candidate, pixels: Pixels) -> None:
    """Store a candidate and its pixels. Raises StoreError."""
    prepare(root)
    described, picture = _paths(root, candidate.name)
    write_whole(picture, whole_png(pixels))
    given = asdict(candidate) | {"golden": to_object(candidate.golden)}
    write_whole(described, (json.dumps(given, ensure_ascii=False, indent=1) + "\n").encode())


def remove_candidate(root: Path, name: str) -> None:
    """Delete a candidate, if there is one."""
    for path in _paths(root, name):
        with suppress(OSError):
            path.unlink(missing_ok=True)


def read_candidates(root: Path) -> dict[str, Candidate]:
    """Every candidate, by name, sorted. Raises StoreError for a file that is no candidate."""
    found = {}
    for path in sorted((root / FOLDER / "candidates").glob("*.json")):
        try:
            given = json.loads(path.read_text(encoding="utf-8-sig"))
            candidate = Candidate(**(given | {"golden": from_object(given["golden"])}))
        except FileNotFoundError:  # another process has accepted it meanwhile
            continue
        except (OSError, ValueError, TypeError, KeyError) as error:
            raise StoreError(
                f"{path} is no candidate ({error}); remove it, and run the tests again."
            ) from error
        found[candidate.name] = candidate
    return dict(sorted(found.items()))


def candidate_files(root: Path) -> list[Path]:
    """The files of all candidates, relative to the root."""
    return [path.relative_to(root) for path in sorted((root / FOLDER / "candidates").glob("[!.]*"))]


def candidate_pixels(root: Path, candidate: Candidate) -> Pixels:
    """A candidate's pixels. Raises StoreError where its PNG file does not hold the drawn pixels."""
    return _kept(_paths(root, candidate.name)[1], candidate.golden.sha256, "run the tests again")


def golden_pixels(root: Path, candidate: Candidate) -> Pixels | None:
    """The pixels of the current golden picture; None where no PNG file of it is kept.

    Raises StoreError where the file does not hold the golden pixels.
    """
    path = picture_path(root / candidate.store, candidate.against or candidate.key)
    if candidate.expected is None or not path.exists():
        return None
    return _kept(path, candidate.expected, "take it from version control again")


def _kept(path, sha256, cure):
    try:
        pixels = pixels_of_png(path.read_bytes(), str(path))
    except OSError as error:
        raise StoreError(f"{path} cannot be read: {error.strerror}; {cure}.") from error
    except ValueError as error:
        raise StoreError(f"{path} is damaged: it is no whole PNG file; {cure}.") from error
    if digest(pixels) != sha256:
        raise StoreError(f"{path} has other pixels than those of the recorded digest; {cure}.")
    return pixels


def compared(root: Path, candidate: Candidate) -> Difference | str | None:
    """The Difference from the golden picture, a sentence where it has none, or None for a new picture."""
    if candidate.expected is None:
        return None
    expected = golden_pixels(root, candidate)
    if expected is None:
        return "no PNG file of the golden picture is kept"
    now = candidate_pixels(root, candidate)
    return kinds_differ(expected, now) or difference(expected, now)


def accept(root: Path, candidate: Candidate) -> str:
    """Make a candidate golden; returns a sentence on the change.

    Raises StoreError; the store and its PNG file are then unchanged.
    """
    store = root / candidate.store
    golden = read_store(store)
    before = golden.get(candidate.key)
    expected = before or golden.get(candidate.against)
    if before and (before.sha256, before.passes) == (candidate.golden.sha256, candidate.golden.passes):
        remove_candidate(root, candidate.name)
        return (
            f"{candidate.name}: golden already, as it was drawn"  # another run of the same tests was quicker
        )
    if (expected and expected.sha256) != candidate.expected:
        raise StoreError(
            f"{candidate.name} was accepted otherwise since the tests ran; run them again, and look at what "
            "differs then."
        )
    pixels = candidate_pixels(root, candidate)
    what = compared(root, candidate)
    change_store(store, {candidate.key: candidate.golden})
    path = picture_path(store, candidate.key)
    try:
        if candidate.keep:
            write_whole(path, whole_png(pixels))
        elif path.exists():
            path.unlink()
    except (StoreError, OSError) as error:
        change_store(store, {candidate.key: before})
        raise StoreError(f"{error} Nothing was accepted.") from error
    remove_candidate(root, candidate.name)
    if expected is None:
        return f"{candidate.name}: new, {candidate.golden}"
    return f"{candidate.name}: {what}{_passes(candidate)}"


def _passes(candidate):
    first = next((line for line in candidate.told.splitlines() if "command" in line), "")
    return f"; {first.strip()}" if first else ""


# -------------------------------------------------------------------------------------------- the last run


def write_run(root: Path, pictures: Mapping[str, Mapping[str, str]]) -> None:
    """Write the results of a run, {picture's name: result}. Raises StoreError.

    A result has status, store, key and test, and told where a passing picture has a message.
    """
    prepare(root)
    lines = ",\n".join(
        f"  {json.dumps(name, ensure_ascii=False)}: {json.dumps(how, ensure_ascii=False)}"
        for name, how in sorted(pictures.items())
    )
    write_whole(root / FOLDER / "run.json", f'{{"format": 1, "pictures": {{\n{lines}\n}}}}\n'.encode())


def read_run(root: Path) -> dict[str, Any]:
    """The results that ``write_run`` wrote. Raises StoreError."""
    path = root / FOLDER / "run.json"
    try:
        found = json.loads(path.read_text(encoding="utf-8-sig"))
        if found["format"] != 1 or not isinstance(found["pictures"], dict):
            raise ValueError("another format")
    except FileNotFoundError as error:
        raise StoreError(f"{path} is not there: no run of pytest ended there. Run pytest.") from error
    except (OSError, ValueError, TypeError, KeyError) as error:
        raise StoreError(
            f"{path} was not written by this version of fixedpipe ({error}); run pytest again."
        ) from error
    return found


def remove_orphan(root: Path, name: str, picture: Mapping[str, str]) -> None:
    """Remove a picture that no test compares from its store. Raises StoreError.

    ``picture`` is its result from ``read_run``.
    """
    store = root / picture["store"]
    change_store(store, {picture["key"]: None})
    with suppress(OSError):
        picture_path(store, picture["key"]).unlink(missing_ok=True)
    run = read_run(root)["pictures"]
    run.pop(name, None)
    write_run(root, run)
