"""How many bytes commands move between host and board, and between a framebuffer and itself.

Source: OpenGL 1.2.1: vertex arrays hold floats for positions and texture coordinates, unsigned bytes for
colours; table 3.6 for images in the host's memory; table 3.16 for internal formats. Assumed: a vertex's
colour is padded to four bytes, indices are unsigned shorts, and images of vectors are floats of 32 bits, as
applications of the time stored them.
"""

import numpy as np

from fixedpipe.pipeline.commands import (
    CopyPixels,
    CopyTexImage,
    CopyTexSubImage,
    Draw,
    DrawPixels,
    HostStep,
    ReadPixels,
    TexImage,
)
from fixedpipe.pipeline.textures.images import COMPONENT_BITS

FLOAT, COLOR, INDEX = 4, 4, 2
# A pixel of the framebuffer: red, green, blue and alpha in a byte each.
PIXEL = 4


def vertex_arrays(draw):
    """The arrays of a Draw that go to the board, and their bytes: {name: (array, bytes)}."""
    mesh, units = draw.mesh, draw.state.texture_units
    sent = {"positions": (mesh.positions, mesh.positions.size * FLOAT)}
    if mesh.indices is not None:
        sent["indices"] = (mesh.indices, mesh.indices.size * INDEX)
    for name in ("colors", "secondary_colors"):
        colors = getattr(mesh, name)
        if colors is not None:
            sent[name] = (colors, len(colors) * COLOR)
    for k in sorted({unit.coordinates for unit in units if unit is not None}):
        coordinates = mesh.texture_coordinates[k]
        sent[f"texture coordinates {k}"] = (coordinates, coordinates.size * FLOAT)
    return sent


def _image_bytes(image):
    """An image in the host's memory: floats of 32 bits, or its own integers."""
    return image.values.size * FLOAT if image.values.dtype.kind == "f" else image.values.nbytes


def image_bytes(command):
    """The bytes that a TexImage sends to the board."""
    if command.image is None:
        return _image_bytes(command.pixels)
    bits = sum(COMPONENT_BITS[command.image.internal_format])
    return sum(level.size // 4 for level in command.image.levels) * bits // 8


def _same_image(a, b):
    if a.image is not None:
        return all(np.array_equal(x, y) for x, y in zip(a.image.levels, b.image.levels, strict=True))
    return a.transfer == b.transfer and np.array_equal(a.pixels.values, b.pixels.values)


class _Counts:
    """What has been counted, and what was read to the host: black pixels, by name."""

    def __init__(self):
        names = ("kept", "loaded", "vertices", "drawn", "copied", "read", "passes", "copies", "loads")
        self.bytes, self.pixels = dict.fromkeys(names, 0), {}

    def add(self, **counts):
        for name, count in counts.items():
            self.bytes[name] += count

    def load(self, old, new):
        same = _same_image(old, new)
        self.add(**{"kept" if same else "loaded": image_bytes(new)}, loads=not same)

    def draw(self, old, new):
        self.add(passes=1)
        were = vertex_arrays(old)
        for name, (array, size) in vertex_arrays(new).items():
            same = np.array_equal(array, were[name][0])
            self.add(**{"kept" if same else "vertices": size})

    def copy(self, old, new):
        del old
        self.add(copies=1, copied=2 * PIXEL * new.width * new.height)

    def read(self, old, new):
        del old
        self.add(copies=1, read=PIXEL * new.width * new.height)
        self.pixels[new.name] = np.zeros((new.height, new.width, 4), np.uint8)

    def step(self, old, new):
        del old
        for issued in new.commands({name: self.pixels[name] for name in new.reads}):
            assert isinstance(issued, DrawPixels), f"{issued.label} is not counted"
            self.add(copies=1, drawn=_image_bytes(issued.image))


# What is counted of a command, by its class; of the others nothing.
_COUNTED = {
    TexImage: _Counts.load,
    Draw: _Counts.draw,
    CopyPixels: _Counts.copy,
    CopyTexImage: _Counts.copy,
    CopyTexSubImage: _Counts.copy,
    ReadPixels: _Counts.read,
    HostStep: _Counts.step,
}


def counted(before, after):
    """The bytes that the second of two frames moves: a dict. Each frame is a tuple of commands for the same
    picture.

    The board keeps textures and vertex arrays that both frames have: "kept". The second frame's changes are
    "loaded" (images), "vertices" (changed arrays) and "drawn" (images drawn as pixels). "copied" is read from
    the framebuffer and written again, and "read" goes to the host. "passes", "copies" and "loads" count
    commands. A HostStep counts as the commands that it issues for black pixels.
    """
    counts = _Counts()
    for old, new in zip(before, after, strict=True):
        if count := _COUNTED.get(type(new)):
            count(counts, old, new)
    return counts.bytes
