"""The accepted digests of the self-test's frames: a line of JSON for each, package data.

Only ``tests/accept_selftest.py`` writes them.
"""

import hashlib
import json
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from importlib import resources
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fixedpipe.pipeline.framebuffers.result import Result
from fixedpipe.pipeline.selftest.frame import Frame

ACCEPTED = "accepted.json"
# Hexadecimal digits of a row's digest: enough to find a differing row; one of 65536 passes by chance.
_ROW_DIGITS = 4


@dataclass(frozen=True, eq=False)
class Drawn:
    """The results of a frame, in whole numbers, so that every way of drawing it gives the same bytes.

    - ``color``: int64 [h, w, 4], top row first.
    - ``depth``, ``stencil``: int64 [h, w], top row first.
    - ``more``: the pixels that were read, and the counts.
    """

    color: NDArray[np.int64]
    depth: NDArray[np.int64]
    stencil: NDArray[np.int64]
    more: dict[str, NDArray[Any]]

    @property
    def planes(self) -> dict[str, NDArray[np.int64]]:
        """A pixel's data, by their names in a sentence."""
        return {"colour": self.color, "depth": self.depth, "stencil": self.stencil}


def drawn_of(color: ArrayLike, depth: ArrayLike, stencil: ArrayLike, more: Mapping[str, ArrayLike]) -> Drawn:
    """A Drawn of arrays or nested lists."""
    planes = (np.asarray(plane).astype(np.int64) for plane in (color, depth, stencil))
    return Drawn(*planes, {name: np.asarray(more[name]) for name in sorted(more)})


def drawn_by(result: Result) -> Drawn:
    """The Drawn of a machine's Result."""
    more = {f"pixels {name}": values for name, values in result.pixels.items()}
    for kind in ("histograms", "minmaxes"):
        for name, table in getattr(result, kind).items():
            more |= {f"{kind} {name} {key}": np.asarray(value) for key, value in vars(table).items()
                     if isinstance(value, np.ndarray)}  # fmt: skip
    held = result.framebuffer
    return drawn_of(held.color, held.depth, held.stencil, more)


@dataclass(frozen=True)
class Digest:
    """The accepted digests of a frame: SHA-256 of everything, and a few digits for each row, from the top."""

    frame: str
    machine: str
    size: str
    sha256: str
    rows: str

    def first_row_that_differs(self, other: "Digest") -> int | None:
        """The first differing row from the top; None where all rows are equal and the read pixels differ."""
        for at in range(0, len(self.rows), _ROW_DIGITS):
            if self.rows[at : at + _ROW_DIGITS] != other.rows[at : at + _ROW_DIGITS]:
                return at // _ROW_DIGITS
        return None


def _bytes(array: NDArray[Any]) -> bytes:
    """Shape and values as bytes, little-endian: whole numbers and floats of 64 bits."""
    kind = "<f8" if array.dtype.kind == "f" else "<i8"
    shape = "x".join(map(str, array.shape))
    return f"{shape}\n".encode() + np.ascontiguousarray(array.astype(kind)).tobytes()


def digest_of(frame: Frame, drawn: Drawn) -> Digest:
    """The Digest of a frame's results."""
    total, rows = hashlib.sha256(), []
    for name, array in (drawn.planes | drawn.more).items():
        total.update(name.encode() + b"\n" + _bytes(array))
    for row in zip(*drawn.planes.values(), strict=True):
        rows.append(hashlib.sha256(b"".join(map(_bytes, row))).hexdigest()[:_ROW_DIGITS])
    size = "x".join(map(str, frame.size))
    return Digest(frame.name, frame.profile.name, size, total.hexdigest(), "".join(rows))


def to_text(digests: Iterable[Digest]) -> str:
    """The text of the digests' file: a line for each."""
    return "[\n" + ",\n".join(json.dumps(asdict(digest)) for digest in digests) + "\n]\n"


def from_text(text: str) -> dict[str, Digest]:
    """{frame's name: Digest} from a text. Raises ValueError for a text that is no file of digests."""
    try:
        return {line["frame"]: Digest(**line) for line in json.loads(text)}
    except (json.JSONDecodeError, KeyError, TypeError) as error:
        raise ValueError(
            f"{ACCEPTED} does not hold the self-test's digests ({error}); install fixedpipe again, or write "
            "it with `make accept-selftest`."
        ) from error


def accepted() -> dict[str, Digest]:
    """{frame's name: Digest} from the package's data."""
    return from_text(resources.files(__package__).joinpath(ACCEPTED).read_text(encoding="utf-8"))
