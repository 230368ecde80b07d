"""What the gallery's files hold, read as a browser reads them."""

import io
import json
import re

import numpy as np
from PIL import Image

# Bytes that windows-1252 of the web has as control characters, and Python's refuses.
# Source: WHATWG Encoding, index windows-1252.
CONTROLS = (0x81, 0x8D, 0x8F, 0x90, 0x9D)
CHARACTERS = {bytes([b]).decode("cp1252") if b not in CONTROLS else chr(b): b for b in range(256)}
_BY_BYTE = {byte: character for character, byte in CHARACTERS.items()}


def called(script):
    """The arguments of the call that a picture's script is: digest, width, height, the bytes of its text, and
    the digest of the picture that it is told from, or None.

    The literal is read as ECMAScript has it: no line ends in it, a backslash begins an escape.
    """
    text = "".join(_BY_BYTE[byte] for byte in script)
    found = re.fullmatch(
        r'picture\("([0-9a-f]{16})",(\d+),(\d+),"((?:[^"\\\n\r\u2028\u2029]|\\.)*)"'
        r'(?:,"([0-9a-f]{16})")?\)\n',
        text,
    )
    escapes = {"\\": "\\", '"': '"', "n": "\n", "r": "\r"}
    characters = re.sub(r"\\(.)", lambda escape: escapes[escape[1]], found[4], flags=re.DOTALL)
    data = bytes(CHARACTERS[character] for character in characters)
    return found[1], int(found[2]), int(found[3]), data, found[5]


def pixels(folder, digest):
    """A picture that a gallery keeps without loss: uint8 [h, w, 4]."""
    named, width, height, data, base = called((folder / "pictures" / f"{digest}.js").read_bytes())
    with Image.open(io.BytesIO(data)) as picture:
        assert (picture.format, picture.size, named) == ("WEBP", (width, height), digest)
        out = np.asarray(picture.convert("RGBA"))
    if base is None:
        return out
    added = out.astype(int) + pixels(folder, base) - 128
    added[..., 3] = 255
    return (added % 256).astype(np.uint8)


def codes(folder, picture):
    """The codes of a picture of a record, as the gallery's script makes them: int [h, w, 3]."""
    if "delta" in picture:
        told = pixels(folder, picture["delta"])[..., :3].astype(int) - 128
        return codes(folder, {**picture["of"], "bits": picture["bits"]}) + told
    shown = pixels(folder, picture["digest"])[..., :3].astype(int)
    if picture["finer"] is None:
        return shown
    one = 2 ** picture["bits"] - 1
    return np.floor(shown * one / 255 + 0.5).astype(int) + pixels(folder, picture["finer"])[..., :3] - 128


def record(folder, name):
    """A figure's record, which its JSON file and its script say alike."""
    said = json.loads((folder / f"{name}.json").read_text())
    script = (folder / "records" / f"{name}.js").read_text()
    assert json.loads(re.fullmatch(r"record\((.*)\)\n", script)[1]) == said
    return said
