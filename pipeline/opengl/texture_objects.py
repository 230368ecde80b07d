"""Texture objects: images, parameters, completeness, and the machine's copy (OpenGL 1.2.1 section 3.8).

A program defines the images of an object one by one. When a draw needs the object, the Texture for a machine
is made from the levels around the base level that fit together. A machine gets each version once.

Only the machine knows images copied from the framebuffer (``Image.texels`` None), and copies change them
there. If a client's image is added to them, they are read back (GetTexImage), and a HostStep stores all
images again.
"""

from collections.abc import Hashable
from dataclasses import dataclass, replace
from itertools import count
from typing import Any, NamedTuple
from weakref import WeakSet

import numpy as np

from fixedpipe.pipeline.commands import HostStep, TexImage
from fixedpipe.pipeline.enums import BaseFormat, InternalFormat, TextureTarget
from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.copied_images import reading, with_copies, with_mipmaps
from fixedpipe.pipeline.opengl.internal_formats import Chosen
from fixedpipe.pipeline.opengl.outcomes import Refused
from fixedpipe.pipeline.opengl.texels import Patch, Texels, palette_bytes, patched, real_of, zero_texels
from fixedpipe.pipeline.textures.images import TWELVE_BIT_FORMATS, Texture, halve

TARGETS = {
    tokens.TEXTURE_CUBE_MAP: TextureTarget.TEXTURE_CUBE_MAP,
    tokens.TEXTURE_3D: TextureTarget.TEXTURE_3D,
    tokens.TEXTURE_RECTANGLE_NV: TextureTarget.TEXTURE_RECTANGLE,
    tokens.TEXTURE_2D: TextureTarget.TEXTURE_2D,
    tokens.TEXTURE_1D: TextureTarget.TEXTURE_1D,
}
_MIPMAPPED = frozenset(
    {
        tokens.NEAREST_MIPMAP_NEAREST,
        tokens.LINEAR_MIPMAP_NEAREST,
        tokens.NEAREST_MIPMAP_LINEAR,
        tokens.LINEAR_MIPMAP_LINEAR,
    }
)
_versions = count(1)


class Parameters(NamedTuple):
    """Texture parameters (table 3.17 and extensions), as tokens and numbers."""

    min_filter: int = tokens.NEAREST_MIPMAP_LINEAR
    mag_filter: int = tokens.LINEAR
    wrap_s: int = tokens.REPEAT
    wrap_t: int = tokens.REPEAT
    wrap_r: int = tokens.REPEAT
    border_color: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    priority: float = 1.0
    min_lod: float = -1000.0
    max_lod: float = 1000.0
    base_level: int = 0
    max_level: int = 1000
    lod_bias: float = 0.0
    generate_mipmap: bool = False
    compare_mode: int = tokens.NONE
    compare_function: int = tokens.LEQUAL
    compare_fail_value: float = 0.0
    depth_mode: int = tokens.LUMINANCE
    max_anisotropy: float = 1.0

    @property
    def mipmapped(self) -> bool:
        """Whether minification reads other levels than the base level."""
        return self.min_filter in _MIPMAPPED


def initial_parameters(target: int) -> Parameters:
    """The parameters of a new object. Source: NV_texture_rectangle for rectangles."""
    if target != tokens.TEXTURE_RECTANGLE_NV:
        return Parameters()
    edge = tokens.CLAMP_TO_EDGE
    return Parameters(min_filter=tokens.LINEAR, wrap_s=edge, wrap_t=edge, wrap_r=edge)


@dataclass(frozen=True, eq=False, slots=True)
class Image:
    """One image: a level of a face.

    - ``size``: width, height and depth, with the border.
    - ``border``: texels of border on each side, for each axis of the target.
    - ``internal_format``: the requested format; ``chosen``: how the machine stores it.
    - ``texels``: None if only the machine knows them; ``patches``: boxes that were replaced later.
    - ``alone``: (name, level, face) of the machine's texture that has only this image (``copied_images``).
    """

    size: tuple[int, int, int]
    border: int
    internal_format: int
    chosen: Chosen
    texels: Texels | None
    patches: tuple[Patch, ...] = ()
    alone: tuple[str, int, int] | None = None

    def like(self, other: "Image") -> bool:
        """Whether two images can be levels or faces of one texture, apart from their sizes."""
        return (self.internal_format, self.border, self.chosen) == (
            other.internal_format,
            other.border,
            other.chosen,
        )

    def with_patch(self, patch: Patch) -> "Image":
        """The image with a box replaced."""
        return replace(self, patches=(*self.patches, patch))

    def merged(self) -> "Image":
        """The image with its patches applied, if its texels are known."""
        if self.texels is None or not self.patches:
            return self
        texels = patched(self.texels, self.patches, self.chosen.format)
        return replace(self, texels=texels, patches=())


class Palette(NamedTuple):
    """A palette (EXT_paletted_texture): its colours as RGBA groups [n, 4], and their base format."""

    internal_format: int
    base: BaseFormat
    groups: tuple[tuple[float, float, float, float], ...]


class Layout(NamedTuple):
    """The levels of an object that fit together: the number of the first level, and each level's faces."""

    first: int
    levels: tuple[tuple[Image, ...], ...]


class Usable(NamedTuple):
    """The data of a complete object that a texture unit needs.

    - ``name``: the object's name in commands.
    - ``first``: the level that is level 0 of the machine's texture; ``levels``: how many levels that has.
    """

    name: str
    target: TextureTarget
    format: InternalFormat
    first: int
    levels: int
    parameters: Parameters


def _smaller(size, border, flat):
    """The size of the next level. ``flat``: how many axes have a border."""
    inner = [max((edge - 2 * border * (axis < flat)) >> 1, 1) for axis, edge in enumerate(size)]
    return tuple([edge + 2 * border * (axis < flat) for axis, edge in enumerate(inner)])


class TextureObject:
    """A texture object.

    - ``key``: its number, or (0, target) for a default object. ``name``: its name in commands.
    - ``images``: {(face, level): Image}. ``asked``: the width, height and internal format that a call
      requested; the machine may not have such an image.
    - ``version``: a number for these contents; no other contents of any texture have it.
    - ``readers``: the Values of the contexts whose units have read it.
    - ``own_palette``; ``shared_palette``: a palette that replaces it (EXT_shared_texture_palette).
    - ``changed_by``: the call that made this version, for labels.
    - ``stale``: the level from which smaller levels must still be made (SGIS_generate_mipmap), or None.
    - ``home``: ``stored`` of the drawable whose machine alone knows some images.
      ``home_first``: the level that is level 0 there; ``home_levels``: how many levels there are.
    """

    def __init__(self, key: Hashable, target: int):
        self.key, self.target = key, target
        self.name = texture_name(key)
        self.images: dict[tuple[int, int], Image] = {}
        self.asked: dict[tuple[int, int], tuple[int, int, int]] = {}
        self.parameters = initial_parameters(target)
        self.readers: WeakSet[Any] = WeakSet()
        self.own_palette: Palette | None = None
        self.shared_palette: Palette | None = None
        self.changed_by = ""
        self.stale: int | None = None
        self.home: Any = None
        self.home_first = self.home_levels = 0
        self.version = next(_versions)
        self._layout: tuple[Layout | None] | None = None
        self._usable: tuple[Usable | None] | None = None
        self._texture: tuple[Any, Texture] | None = None

    @property
    def palette(self) -> Palette | None:
        """The palette of its indices."""
        return self.own_palette if self.shared_palette is None else self.shared_palette

    @property
    def faces(self) -> int:
        """How many images a level has."""
        return 6 if self.target == tokens.TEXTURE_CUBE_MAP else 1

    @property
    def bordered_axes(self) -> int:
        """How many axes have a border."""
        return {tokens.TEXTURE_1D: 1, tokens.TEXTURE_3D: 3}.get(self.target, 2)

    def changed(self, call: str) -> None:
        """Note that ``call`` changed images or a palette."""
        self.version = next(_versions)
        self.changed_by = call
        self._layout = self._usable = self._texture = None

    def set_parameters(self, parameters: Parameters, call: str) -> None:
        """Replace the parameters. A new base level may mean a new texture for the machine."""
        before, self.parameters = self.parameters, parameters
        self._usable = None
        if before.base_level != parameters.base_level:
            layout, self._layout = self._layout, None
            if layout is not None and layout[0] is not None and self.layout() != layout[0]:
                self.changed(call)

    def make_room(self, position: tuple[int, int], image: Image) -> bool:
        """Make an image of this size exist at a place. Returns whether the machine's texture has it already.

        In the machine's texture, missing faces of a cube map are zeros.
        """
        (face, level), layout = position, self.layout()
        k = -1 if layout is None else level - layout.first
        if layout is not None and 0 <= k < len(layout.levels):
            held = layout.levels[k][face]
            if held.size == image.size and held.like(image):
                if position not in self.images:
                    self.images[position] = held
                    self._layout = self._usable = None
                return True
        # Faces of another size or format are of no complete texture with this one.
        for other, held in [*self.images.items()]:
            if other[1] == level and other != position and (held.size != image.size or not held.like(image)):
                del self.images[other]
        self.images[position] = zeros_like(image)
        self._layout = self._usable = None
        return False

    # ------------------------------------------------------------------------------------ completeness

    def level(self, level: int, *, filled: bool = False) -> tuple[Image, ...] | None:
        """The faces of a level; None if they are missing or differ. ``filled``: whether missing ones are
        zeros.
        """
        found = [self.images.get((face, level)) for face in range(self.faces)]
        some = next((image for image in found if image is not None), None)
        if some is None or (None in found and not filled):
            return None
        faces = [zeros_like(some) if image is None else image for image in found]
        if any(image.size != some.size or not image.like(some) for image in faces):
            return None
        return tuple(faces)

    def _chain(self, first, base, filled):
        """The levels from ``first`` on that fit together; None unless they reach the base level."""
        faces = self.level(first, filled=filled)
        if faces is None:
            return None
        levels, size = [faces], faces[0].size
        border = faces[0].border
        end = tuple([1 + 2 * border * (axis < self.bordered_axes) for axis in range(3)])
        while size != end:
            size = _smaller(size, border, self.bordered_axes)
            faces = self.level(first + len(levels), filled=filled)
            if faces is None or faces[0].size != size or not faces[0].like(levels[0][0]):
                break
            levels.append(faces)
        return tuple(levels) if first + len(levels) > base else None

    def layout(self) -> Layout | None:
        """The levels that a machine can store; None without a base level. Missing faces are zeros."""
        if self._layout is None:
            self._layout = (self._find_layout(),)
        return self._layout[0]

    def _find_layout(self):
        base = self.parameters.base_level
        if self.level(base, filled=True) is None:
            return None
        # The lowest level that fits is the machine's level 0. So a lower base level needs no new texture.
        firsts = sorted({level for _, level in self.images if level <= base})
        for first in firsts:
            levels = self._chain(first, base, True)
            if levels is not None:
                return Layout(first, levels)
        return None

    def is_complete(self) -> bool:
        """Whether the object is complete, so that units can read it (section 3.8.5; EXT_texture_cube_map)."""
        parameters, base = self.parameters, self.parameters.base_level
        faces = self.level(base)
        if faces is None:
            return False
        width, height, depth = faces[0].size
        inside = [edge - 2 * faces[0].border for edge in (width, height, depth)[: self.bordered_axes]]
        if self.target == tokens.TEXTURE_CUBE_MAP and width != height:
            return False
        if faces[0].chosen.format is InternalFormat.COLOR_INDEX8 and self.palette is None:
            return False
        if not parameters.mipmapped or self.target == tokens.TEXTURE_RECTANGLE_NV:
            return True
        if base > parameters.max_level:
            return False
        last = min(base + max(inside).bit_length() - 1, parameters.max_level)
        levels = self._chain(base, base, False)
        return levels is not None and base + len(levels) > last

    def usable(self) -> Usable | None:
        """The data of the object that a unit needs; None if the object is incomplete."""
        self.settle()
        if self._usable is None:
            found = None
            if self.is_complete() and (layout := self.layout()) is not None:
                stored = self._stored_format(layout)
                target = TARGETS[self.target]
                found = Usable(self.name, target, stored, layout.first, len(layout.levels), self.parameters)
            self._usable = (found,)
        return self._usable[0]

    # ------------------------------------------------------------------------------- automatic mipmaps

    def settle(self) -> None:
        """Apply patches, and make the levels above the base level if they must be made again."""
        for position, image in self.images.items():
            if image.patches:
                self.images[position] = image.merged()
        if self.stale is None:
            return
        faces = self.level(self.stale)
        if faces is None or any(image.texels is None for image in faces):
            return
        for face, image in enumerate(faces):
            for level, smaller in enumerate(pyramid_above(image, self.is_volume), self.stale + 1):
                self.images[face, level] = smaller
        self.stale = self._layout = self._usable = None

    @property
    def is_volume(self) -> bool:
        """Whether it is a 3D texture, which has layers."""
        return self.target == tokens.TEXTURE_3D

    # ----------------------------------------------------------------------------------- the machine's

    def _stored_format(self, layout):
        image = layout.levels[0][0]
        if image.chosen.format is InternalFormat.COLOR_INDEX8 and self.palette is not None:
            return _PALETTED[self.palette.base]
        return image.chosen.format

    def texture(self, layout: Layout) -> Texture:
        """The Texture of a layout. Images that only the machine knows are zeros."""
        if self._texture is None or self._texture[0] is not layout:
            self._texture = layout, self._make_texture(layout)
        return self._texture[1]

    def _make_texture(self, layout):
        stored = self._stored_format(layout)
        levels = [[self.known(image) for image in faces] for faces in layout.levels]
        texels = tuple([np.concatenate([t.texels for t in faces]) for faces in levels])
        ideal = None
        if any(t.real is not None for faces in levels for t in faces):
            ideal = tuple([np.concatenate([real_of(t, stored) for t in faces]) for faces in levels])
        bits = 12 if stored in TWELVE_BIT_FORMATS else 8
        return Texture(TARGETS[self.target], stored, texels, ideal, bits, layout.levels[0][0].border)

    def known(self, image: Image) -> Texels:
        """The texels of an image: for indices the palette's colours, and zeros for unknown texels."""
        if image.texels is None:
            width, height, depth = image.size
            return zero_texels(image.chosen, depth, height, width)
        if image.chosen.format is not InternalFormat.COLOR_INDEX8 or self.palette is None:
            return image.texels
        colors = palette_bytes(np.array(self.palette.groups), self.palette.base)
        return Texels(colors[image.texels.texels & (len(colors) - 1)])

    def store(self, gl: Any) -> None:
        """Add commands that store the present version in the drawable's machine, unless it has it already."""
        if gl.drawable.stored.get(self.key) == self.version:
            return
        self.settle()
        layout = self.layout()
        if layout is None:
            return
        copied = any(image.texels is None for faces in layout.levels for image in faces)
        label = self.changed_by or f"{gl.called} (call {gl.tally.call})"
        if copied:
            self._store_with_copies(gl, layout, label)
        else:
            gl.commands.append(TexImage(label=label, texture=self.name, image=self.texture(layout)))
        gl.drawable.stored[self.key] = self.version

    def keep_copies(self, gl: Any) -> None:
        """Note that the drawable's machine has the present layout, with images that only it knows."""
        layout = self.layout()
        if layout is not None:
            self.home, self.home_first, self.home_levels = (
                gl.drawable.stored,
                layout.first,
                len(layout.levels),
            )
        gl.drawable.stored[self.key] = self.version

    def _store_with_copies(self, gl, layout, label):
        """Read back the images that only the machine knows, and store all levels again."""
        if self.home is not gl.drawable.stored:
            raise Refused(f"{self.name} was copied from another window's framebuffer")
        reads = {}
        for k, faces in enumerate(layout.levels):
            for face, image in enumerate(faces):
                level = layout.first + k - self.home_first
                source = None if image.texels is not None else image.alone
                if source is None and image.texels is None and 0 <= level < self.home_levels:
                    source = self.name, level, face
                if source is not None:
                    name = f"{self.name}, face {face}, level {k}, version {self.version}"
                    reads[name] = k, face
                    gl.commands.append(reading(label, name, source, image.chosen.format))
        placeholder = self.texture(layout)
        gl.commands.append(TexImage(label=label, texture=self.name, image=placeholder))
        above = None if self.stale is None else self.stale - layout.first
        name, volume = self.name, self.is_volume

        def put_together(arrays):
            texture = with_copies(placeholder, layout, {reads[n]: a for n, a in arrays.items()})
            if above is not None:
                texture = with_mipmaps(texture, above, volume)
            return (TexImage(label=label, texture=name, image=texture),)

        step = HostStep(label=label, reads=tuple(reads), commands=put_together)
        gl.commands += self._in_the_window(gl, step)
        stored = range(layout.first, layout.first + len(layout.levels))
        made = range(0) if self.stale is None else range(self.stale + 1, layout.first + len(layout.levels))
        for position, image in self.images.items():
            if position[1] in made:  # only the machine knows them
                self.images[position] = replace(image, texels=None, patches=(), alone=None)
            elif position[1] in stored:
                self.images[position] = replace(image, patches=(), alone=None)
        self.stale = None
        self.keep_copies(gl)

    def _in_the_window(self, gl, step):
        """The commands that carry out a HostStep, which needs the window to be current."""
        from fixedpipe.pipeline.opengl.framebuffer_objects import made_current

        if gl.values["pbuffer"] is None:
            return (step,)
        return made_current(step.label, None), step, made_current(step.label, gl.values["pbuffer"][1])


_PALETTED = {
    BaseFormat.ALPHA: InternalFormat.ALPHA8,
    BaseFormat.LUMINANCE: InternalFormat.LUMINANCE8,
    BaseFormat.LUMINANCE_ALPHA: InternalFormat.LUMINANCE8_ALPHA8,
    BaseFormat.INTENSITY: InternalFormat.INTENSITY8,
    BaseFormat.RGB: InternalFormat.RGB8,
    BaseFormat.RGBA: InternalFormat.RGBA8,
}


def texture_name(key: Any) -> str:
    """The name of an object in commands."""
    if isinstance(key, tuple):
        return f"texture 0 of {TARGETS[key[1]].name}"
    return f"texture {key}"


def smaller_sizes(image: Image, volume: bool) -> list[tuple[int, int, int]]:
    """The sizes of the levels above an image that are made automatically.

    The list is empty if the image has a border, an edge that is no power of two, or texels that have no mean.
    """
    formats = InternalFormat.COLOR_INDEX8, InternalFormat.SIGNED_RGBA8
    width, height, depth = image.size
    halved = all(edge & (edge - 1) == 0 for edge in (width, height, depth if volume else 1))
    if image.border or image.chosen.base is None or image.chosen.format in formats or not halved:
        return []
    sizes = []
    while max(width, height, depth if volume else 1) > 1:
        width, height = max(width >> 1, 1), max(height >> 1, 1)
        depth = max(depth >> 1, 1) if volume else depth
        sizes.append((width, height, depth))
    return sizes


def pyramid_above(image: Image, volume: bool) -> list[Image]:
    """The levels above an image. Each is made from boxes of 2x2 texels of the one below (``halve``)."""
    made = image.merged()
    if made.texels is None:
        return []
    texels, real = made.texels
    levels = []
    for size in smaller_sizes(made, volume):
        texels = halve(texels, volume)
        real = None if real is None else halve(real, volume)
        texels.setflags(write=False)
        levels.append(replace(made, size=size, texels=Texels(texels, real)))
    return levels


def zeros_like(image: Image, size: tuple[int, int, int] | None = None) -> Image:
    """An image of zeros that fits another image. It has the same size, or ``size``."""
    size = image.size if size is None else size
    width, height, depth = size
    return replace(
        image, size=size, texels=zero_texels(image.chosen, depth, height, width), patches=(), alone=None
    )
