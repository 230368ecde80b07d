"""Pictures as the bytes of PNG files, and what shows itself as one."""

import io
import os
import zlib
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray


def png(image: NDArray[Any]) -> bytes:
    """A picture as the bytes of a PNG file: uint8 [h, w, 3 or 4], or grey [h, w], top row first; alpha is
    left out. Raises ValueError for an array of anything else.

    A framebuffer's alpha holds whatever a pass kept there (a gate, a factor) and is no transparency.
    """
    is_shaped = image.ndim == 2 or image.shape[2:] in ((3,), (4,))
    if image.dtype != np.uint8 or not is_shaped or 0 in image.shape:
        raise ValueError(
            f"The picture is {image.dtype} of shape {image.shape}; give uint8 [h, w, 3 or 4], as "
            "Result.image() is, or [h, w]."
        )
    from PIL import Image

    # Of zlib's ways this is a third of the time, and a twentieth more bytes.
    buffer, way = io.BytesIO(), zlib.Z_RLE
    picture = image if image.ndim == 2 else image[..., :3]
    Image.fromarray(np.ascontiguousarray(picture)).save(buffer, "PNG", compress_type=way)
    return buffer.getvalue()


class Pictured:
    """What has a picture, ``image()``: notebooks show it, ``save`` writes it."""

    def image(self) -> NDArray[np.uint8]:
        """The picture, uint8 [h, w, 4], top row first."""
        raise NotImplementedError

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the picture as a PNG file, top row first, without the alpha of ``image()`` (see ``png``).

        Raises ValueError when the name does not end in .png, OSError when the file cannot be written.
        """
        path = Path(path)
        if path.suffix.lower() != ".png":
            better = path.with_suffix(".png") if path.name else "picture.png"
            raise ValueError(f"A picture is saved as PNG; name it {better}, not {path}.")
        path.write_bytes(png(self.image()))

    def _repr_png_(self) -> bytes:
        """What a notebook shows: the bytes that ``save`` writes."""
        return png(self.image())
