"""Digests of pictures: the bits of a figure on a machine, small enough to keep beside the code.

An accepted digest is a JSON file with the figure's id, the profile's key, the panels' edge and the
framebuffer's size in pixels, and the SHA-256 of shape and bytes. Only ``tests/accept.py`` writes one.
"""

import hashlib
import json
from dataclasses import asdict, dataclass

import numpy as np

GOLDEN_SIZE = 256  # edge of a panel, pixels: small enough for every test run, large enough for every feature


def digest(color):
    """SHA-256, in hexadecimal, of a picture's shape and pixels, top row first.

    The picture is uint8 or uint16 [h, w, components]. For uint16 the digest covers the type too, and each
    word's low byte comes first. Raises ValueError for other types.
    """
    color = np.ascontiguousarray(color)
    if color.dtype not in (np.uint8, np.uint16):
        raise ValueError(
            f"A digest is of bytes or words; this picture holds {color.dtype}; give uint8, as Result.image() "
            "is, or uint16."
        )
    head = "x".join(map(str, color.shape)) + (" uint16" if color.dtype == np.uint16 else "")
    little = color.astype(color.dtype.newbyteorder("<"), copy=False)
    return hashlib.sha256(f"{head}\n".encode() + little.tobytes()).hexdigest()


@dataclass(frozen=True, kw_only=True)
class Golden:
    """An accepted digest."""

    figure: str
    profile: str
    size: int
    width: int
    height: int
    sha256: str


def to_text(golden):
    """The text of a Golden's JSON file."""
    return json.dumps(asdict(golden), indent=2) + "\n"


def from_text(text):
    """The Golden of a JSON file's text. Raises ValueError when the text is not one."""
    try:
        return Golden(**json.loads(text))
    except (json.JSONDecodeError, TypeError) as error:
        raise ValueError(f"This is not an accepted digest ({error}); write it with `make accept`.") from error
