"""Pictures as the gallery keeps them: named by a digest, lossless as scripts, and reduced for a first look.

A page opened from a file may not read an image file into a canvas, because there every file has its own
origin. But it may load a script. So a picture to be measured is a script with the bytes of a WebP file
(docs/decisions/0018-pictures-and-the-gallery.md).
"""

import hashlib
import io
from dataclasses import dataclass, field
from functools import partial

import numpy as np
from PIL import Image

# Widths of reduced pictures: a machine's on the plain page, what the grid shows, and what stands beside it on
# the plain page and passes.
PREVIEW, THUMBNAIL, SMALL = 640, 480, 320
# Quality of a lossy WebP file. Assumed: rings and edges of the figures are not yet seen to suffer.
_QUALITY = 62
# What may not stand as it is in a string literal between double quotes.
_ESCAPES = {0x5C: rb"\\", 0x22: rb"\"", 0x0D: rb"\r", 0x0A: rb"\n"}


def canonical(image):
    """A picture in its stored form: uint8 [h, w, 4], top row first.

    Alpha is 255, or 0 without colour where a reference has no value. ``image``: uint8 [h, w, 3], or [h, w, 4]
    with its own alpha.
    """
    pixels = np.full((*image.shape[:2], 4), 255, np.uint8)
    pixels[..., : image.shape[2]] = image
    pixels[pixels[..., 3] == 0] = 0
    return pixels


def digest_of(pixels):
    """A picture's name: the first 16 hexadecimal digits of the SHA-256 of its width, height and bytes.

    ``pixels``: as for ``canonical``.
    """
    height, width = pixels.shape[:2]
    return hashlib.sha256(f"{width}x{height}\n".encode() + pixels.tobytes()).hexdigest()[:16]


def lossless(pixels):
    """The bytes of a lossless WebP file that keeps every byte of a ``canonical`` picture."""
    return _webp(Image.fromarray(_without_alpha(pixels)), lossless=True, exact=True)


def preview(pixels, width):
    """The bytes of a lossy WebP file of a ``canonical`` picture, at most ``width`` pixels wide."""
    return _webp(Image.fromarray(_without_alpha(reduced(pixels, width))), quality=_QUALITY)


def reduced(pixels, width):
    """A picture at most ``width`` pixels wide, each pixel the mean of those that it covers."""
    height, full = pixels.shape[:2]
    if full <= width:
        return pixels
    size = width, max(1, round(height * width / full))
    return np.asarray(Image.fromarray(pixels).resize(size, Image.Resampling.BOX))


def script(digest, width, height, data, base=None):
    """A script that calls ``picture(digest, width, height, text)``, or ``picture(digest, width, height, text,
    base)`` where ``data`` is of ``apart`` from the picture ``base``: bytes, to be read as windows-1252.

    Every byte of ``data`` is one character of the text. Four would end the literal or begin an escape and are
    escaped; a line's ends of Unicode do not exist in windows-1252. A reader turns the characters back: the
    bytes 0x80 to 0x9F are other code points there, five of them (0x81, 0x8D, 0x8F, 0x90, 0x9D) the control
    characters of the same number. Source: WHATWG Encoding, index windows-1252.
    """
    text = data
    for byte, escaped in _ESCAPES.items():  # the backslash first
        text = text.replace(bytes([byte]), escaped)
    end = b'"%s"' % base.encode() if base else b""
    return b'picture("%s",%d,%d,"%s"%s)\n' % (digest.encode(), width, height, text, b"," * bool(base) + end)


def apart(pixels, base):
    """The difference of an opaque ``canonical`` picture's bytes from another's: modulo 256, and 128 where
    both are equal. A machine's picture and its ideal's are mostly a byte apart.
    """
    out = pixels - base + np.uint8(128)
    out[..., 3] = 255
    return out


def _distance(pixels, base):
    """How far two pictures are apart: the mean of the bits that their bytes' differences need. What is mostly
    equal, and far away in a few places, is near.
    """
    return float(np.log2(1.0 + np.abs(pixels[..., :3].astype(np.int16) - base[..., :3])).mean())


def _without_alpha(pixels):
    return pixels if (pixels[..., 3] == 0).any() else np.ascontiguousarray(pixels[..., :3])


def _webp(image, **how):
    buffer = io.BytesIO()
    image.save(buffer, "WEBP", method=4, **how)
    return buffer.getvalue()


# Files that a picture may have, by the endings of their names: without loss, for canvases; or reduced to so
# many pixels' width.
LOSSLESS = {".js": 0}
WIDE, NARROW, OF_GRID = {".webp": PREVIEW}, {".webp": SMALL}, {f"-{THUMBNAIL}.webp": THUMBNAIL}


@dataclass
class Pictures:
    """Pictures by digest, each once, and the files that each is to have: endings of names, with widths; and
    for some of them ``bases``, the picture from which their difference may be stored. ``whole``: other files
    by name, animations.
    """

    pixels: dict[str, np.ndarray] = field(default_factory=dict)
    bases: dict[str, str] = field(default_factory=dict)
    endings: dict[str, dict[str, int]] = field(default_factory=dict)
    whole: dict[str, bytes] = field(default_factory=dict)

    def add(self, image, *files, bases=()):
        """Keep a picture, as for ``canonical``, and return its digest. ``files``: LOSSLESS, WIDE, NARROW,
        OF_GRID.

        ``bases``: digests of pictures that were added before. This one's file may hold its difference from
        the nearest of them, if that is shorter.
        """
        pixels = canonical(image)
        digest = digest_of(pixels)
        if digest not in self.pixels:
            able = [base for base in dict.fromkeys(bases) if base and self._tells(base, pixels)]
            if able:
                self.bases[digest] = min(able, key=lambda base: _distance(pixels, self.pixels[base]))
        self.pixels[digest] = pixels
        endings = self.endings.setdefault(digest, {})
        for ending, width in (pair for file in files for pair in file.items()):
            endings[ending] = max(width, endings.get(ending, 0))
        return digest

    def files(self):
        """(name, function that gives the bytes) of every file."""
        for digest, endings in self.endings.items():
            for ending, width in endings.items():
                yield f"{digest}{ending}", partial(self._bytes, digest, width)
        for name, data in self.whole.items():
            yield name, partial(bytes, data)

    def _bytes(self, digest, width):
        pixels = self.pixels[digest]
        if width:
            return preview(pixels, width)
        base = self.bases.get(digest)
        ways = [(lossless(pixels), None)]
        if base is not None:
            ways.append((lossless(apart(pixels, self.pixels[base])), base))
        data, base = min(ways, key=lambda way: len(way[0]))
        return script(digest, pixels.shape[1], pixels.shape[0], data, base)

    def _tells(self, base, pixels):
        """Whether a picture may be told from another: of one size, both opaque."""
        other = self.pixels[base]
        return other.shape == pixels.shape and all((p[..., 3] == 255).all() for p in (other, pixels))
