"""Pictures as the bytes of PNG files, and the base class of objects that have a picture."""

import io
import os
import struct
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray


def png(image: NDArray[Any]) -> bytes:
    """The bytes of a PNG file without alpha, from uint8 or uint16 [h, w, 3 or 4] or grey [h, w].

    The top row is first. A framebuffer's alpha holds a pass's own values (a gate, a factor), and is no
    transparency. Raises ValueError for other arrays.
    """
    is_shaped = image.ndim == 2 or image.shape[2:] in ((3,), (4,))
    if image.dtype not in (np.uint8, np.uint16) or not is_shaped or 0 in image.shape:
        raise ValueError(
            f"The picture is {image.dtype} of shape {image.shape}; give uint8 or uint16 [h, w, 3 or 4], as "
            "Result.image() is, or [h, w]."
        )
    picture = np.ascontiguousarray(image if image.ndim == 2 else image[..., :3])
    if picture.dtype == np.uint16:
        return whole_png(picture.reshape(*picture.shape[:2], -1))
    from PIL import Image

    # Of zlib's strategies, RLE takes a third of the time for a twentieth more bytes.
    buffer, way = io.BytesIO(), zlib.Z_RLE
    Image.fromarray(picture).save(buffer, "PNG", compress_type=way)
    return buffer.getvalue()


# PNG's numbers for grey, grey with alpha, colour, colour with alpha. Source: PNG specification, second
# edition, section 11.2.2.
_COLOR_TYPES = {1: 0, 2: 4, 3: 2, 4: 6}


def whole_png(pixels: NDArray[Any]) -> bytes:
    """The bytes of a PNG file that keeps every bit of uint8 or uint16 [h, w, 1 to 4], top row first.

    The components are grey, grey and alpha, colour, or colour and alpha. The function writes the chunks
    itself, because Pillow writes no colours of 16 bits. Source: PNG specification, second edition, sections 5
    (chunks), 7.2 (most significant byte first) and 9.2 (filter 2, Up).
    """
    height, width, components = pixels.shape
    rows = pixels.astype(pixels.dtype.newbyteorder(">")).reshape(height, -1).view(np.uint8)
    filtered = np.empty((height, 1 + rows.shape[1]), np.uint8)
    filtered[:, 0] = 2
    filtered[0, 1:] = rows[0]
    np.subtract(rows[1:], rows[:-1], out=filtered[1:, 1:])  # modulo 256
    depth = 8 * pixels.dtype.itemsize
    chunks = (
        (b"IHDR", struct.pack(">IIBBBBB", width, height, depth, _COLOR_TYPES[components], 0, 0, 0)),
        (b"IDAT", zlib.compress(filtered.tobytes())),
        (b"IEND", b""),
    )
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        for kind, data in chunks
    )


def to_codes(values: ArrayLike, bits: int) -> NDArray[np.int32]:
    """Reals as codes of ``bits`` bits: clamped to [0, 1], then the nearest of 0 .. 2**bits - 1, halves up.

    Source: OpenGL 1.2.1 section 2.13.9.
    """
    codes = np.clip(values, 0.0, 1.0) * (2.0**bits - 1.0)
    codes += 0.5
    return codes.astype(np.int32)  # truncation equals floor for numbers that are not negative


def deep_picture(codes: NDArray[Any], bits: int) -> NDArray[np.uint8 | np.uint16]:
    """Codes of ``bits`` bits as a picture that keeps them distinct: uint8 for 8 bits or fewer, else uint16.

    Each code is scaled to the full range and rounded to nearest, halves up.
    """
    if bits == 8:
        return np.asarray(codes).astype(np.uint8)
    one, full = 2**bits - 1, 255 if bits < 8 else 65535
    scaled = (np.asarray(codes, np.int64) * (2 * full) + one) // (2 * one)
    return scaled.astype(np.uint8 if bits <= 8 else np.uint16)


class Pictured:
    """An object with a picture, ``image()``: notebooks show it, and ``save`` writes it with all its bits."""

    def image(self) -> NDArray[np.uint8]:
        """The picture, uint8 [h, w, 4], top row first."""
        raise NotImplementedError

    def deep_image(self) -> NDArray[np.uint8 | np.uint16]:
        """``image()``, or, if a component has more than 8 bits, the picture as uint16, 65535 = full."""
        return self.image()

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the picture as a PNG file, top row first, without the alpha of ``image()`` (see ``png``).

        The file has 16 bits a component if the machine has more than 8. Raises ValueError if the name does
        not end in .png, and OSError if the file cannot be written.
        """
        path = Path(path)
        if path.suffix.lower() != ".png":
            better = path.with_suffix(".png") if path.name else "picture.png"
            raise ValueError(f"A picture is saved as PNG; name it {better}, not {path}.")
        path.write_bytes(png(self.deep_image()))

    def _repr_png_(self) -> bytes | None:
        """The PNG bytes that a notebook shows, those of ``save``; None if there is no picture."""
        return png(self.deep_image())


MOST_TIMES = 16  # the largest ``times`` of ``beside``; a typing error could otherwise fill the memory


@dataclass(frozen=True, eq=False, repr=False)
class Together(Pictured):
    """Several pictures as one, made by ``beside`` and ``above``.

    pixels  uint8 [h, w, 4], top row first, alpha 255
    """

    pixels: NDArray[np.uint8]

    def image(self) -> NDArray[np.uint8]:
        """The picture: ``pixels``."""
        return self.pixels

    def __repr__(self) -> str:
        height, width = self.pixels.shape[:2]
        return f"<a picture of pictures, {width}x{height} pixels>"


def beside(*pictures: Pictured | NDArray[Any], times: int = 1) -> Together:
    """Put pictures of the same height side by side, the first on the left. A notebook shows the result.

    pictures  an object with a picture, or an array [h, w, 3 or 4], top row first, whose alpha is ignored:
              uint8, or floats, 1.0 = full, which are clamped to [0, 1] and rounded to the nearest byte
    times     each pixel becomes a square with an edge of so many pixels, 1 to 16

    Raises ValueError if there is no picture, for different heights, another array, and other ``times``.
    """
    return _joined(pictures, 1, times)


def above(*pictures: Pictured | NDArray[Any], times: int = 1) -> Together:
    """Put pictures of the same width below each other, the first at the top. Otherwise as ``beside``."""
    return _joined(pictures, 0, times)


def _joined(pictures: tuple[Pictured | NDArray[Any], ...], axis: int, times: int) -> Together:
    images = [_opaque(picture) for picture in pictures]
    sizes = [f"{image.shape[1]}x{image.shape[0]}" for image in images]
    if len({image.shape[1 - axis] for image in images}) != 1:
        one = ("width", "height")[axis]
        raise ValueError(f"The pictures are {', '.join(sizes) or 'none'}; give one or more of one {one}.")
    if isinstance(times, bool | float) or times not in range(1, MOST_TIMES + 1):
        raise ValueError(
            f"Pixels are to be {times!r} times as large; give a whole number from 1 to {MOST_TIMES}."
        )
    return Together(np.concatenate(images, axis=axis).repeat(times, axis=0).repeat(times, axis=1))


def _opaque(picture: Pictured | NDArray[Any]) -> NDArray[np.uint8]:
    """A picture's bytes, uint8 [h, w, 4], with an alpha of 255."""
    pixels = picture.image() if isinstance(picture, Pictured) else picture
    shown = isinstance(pixels, np.ndarray) and pixels.ndim == 3 and pixels.shape[2] in (3, 4)
    if not shown or not (pixels.dtype == np.uint8 or np.issubdtype(pixels.dtype, np.floating)):
        what = f"{pixels.dtype} {pixels.shape}" if isinstance(pixels, np.ndarray) else type(pixels).__name__
        raise ValueError(f"A picture is {what}; give what has a picture, or uint8 or floats [h, w, 3 or 4].")
    if np.issubdtype(pixels.dtype, np.floating):
        if np.isnan(pixels).any():
            raise ValueError("A picture holds NaN; give numbers, 1.0 = full.")
        pixels = to_codes(pixels, 8)
    out = np.full((*pixels.shape[:2], 4), 255, np.uint8)
    out[..., :3] = pixels[..., :3]
    return out
