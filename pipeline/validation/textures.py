"""Validation of textures, and of the commands that make them."""

from numbers import Integral
from weakref import WeakSet

import numpy as np

from fixedpipe.pipeline.enums import InternalFormat, TextureTarget
from fixedpipe.pipeline.messages import count, depth_words, listed, nearest_power_of_two, quoted
from fixedpipe.pipeline.pixel_transfer import changes_nothing, convolution, filter_size
from fixedpipe.pipeline.textures.images import COMPONENT_BITS, DEPTH_TEXELS, TWELVE_BIT_FORMATS, Texture
from fixedpipe.pipeline.textures.pixel_formats import (
    COLOR_INDEX_FORMAT,
    DEPTH_FORMAT,
    DEPTH_READABLE_AS,
    IMAGE_FORMATS,
    READ_FORMATS,
    READABLE_AS,
)
from fixedpipe.pipeline.validation import buffers, surfaces
from fixedpipe.pipeline.validation.transfer import pixel_image_problem, transferred
from fixedpipe.pipeline.validation.types import enum_check, instance_check
from fixedpipe.pipeline.validation.walk import KnownTexture

_PARTS = {
    TextureTarget.TEXTURE_CUBE_MAP: ("cube map", "faces"),
    TextureTarget.TEXTURE_3D: ("3D texture", "layers"),
}

_checked_textures = WeakSet()  # textures without a problem
_check_target, _check_format = enum_check(TextureTarget), enum_check(InternalFormat)
_check_texture = instance_check(Texture)
_FIXED_DEPTHS = (InternalFormat.DEPTH_COMPONENT16, InternalFormat.DEPTH_COMPONENT24)
_COLORS = frozenset({*COMPONENT_BITS, *TWELVE_BIT_FORMATS})
_MADE_FROM_PIXELS = _COLORS.union(_FIXED_DEPTHS)
_COLOR_IMAGES, _DEPTH_IMAGES = (*IMAGE_FORMATS, COLOR_INDEX_FORMAT), (DEPTH_FORMAT,)


def complete_levels(width, height):
    """The number of levels of a complete mipmap of width x height texels (OpenGL 1.2.1, section 3.8.5)."""
    return max(width, height).bit_length()


def _faces(image, level):
    """The number of images in level ``level`` of a texture: its faces, or its layers with their border."""
    if image.target is TextureTarget.TEXTURE_3D:
        return max(1, image.depth >> level) + 2 * image.border
    return 6 if image.target is TextureTarget.TEXTURE_CUBE_MAP else 1


def _level_problem(image, level, array):
    """A sentence that says why no machine could hold a Texture's level, or None."""
    bits = image.bits
    dtype = np.dtype(np.uint8 if bits == 8 else np.uint16)
    if not isinstance(array, np.ndarray) or array.dtype != dtype or array.ndim != 4 or array.shape[3] != 4:
        return (
            f"level {level} of the texture is not {dtype} [faces, height, width, 4]; make textures with "
            "texture_2d."
        )
    if array.size and int(array.max()) >= 1 << bits:
        return f"level {level} of the texture holds {int(array.max())}; one is {(1 << bits) - 1}."
    faces = _faces(image, level)
    if array.shape[0] != faces:
        given = count(array.shape[0], _PARTS.get(image.target, ("", "faces"))[1].removesuffix("s"))
        return f"level {level} of a {image.target.name} has {given}; it takes {faces}."
    height, width = array.shape[1:3]
    along_s, along_t, along_r = (2 * texels for texels in image.borders)
    if height <= along_t or width <= along_s or array.shape[0] <= along_r:
        beside = f" and its border of {image.border} on either side" if image.border else ""
        return (
            f"level {level} of the texture is {width}x{height} texels; a texture needs at least 1x1{beside}."
        )
    expected = (max(1, image.height >> level) + along_t, max(1, image.width >> level) + along_s)
    if (height, width) != expected:
        beside = f" with a border of {image.border}" if image.border else ""
        how = "Give every level its border." if image.border else "Build the levels with mipmaps=True."
        return (
            f"level {level} of a {image.width}x{image.height} texture{beside} is {width}x{height}; it takes "
            f"{expected[1]}x{expected[0]}. {how}"
        )
    return None


def _texture_problem(image):
    """A sentence that says why no machine could hold a Texture, or None."""
    for name, check in (("target", _check_target), ("internal_format", _check_format)):
        if wrong := check(getattr(image, name)):
            return f"the texture's {name} {wrong.predicate}."
    if not isinstance(image.levels, tuple) or not image.levels:
        return "the texture has no level 0; make textures with texture_1d, texture_2d or texture_cube_map."
    bits = image.bits
    if isinstance(bits, bool) or not isinstance(bits, Integral) or not 4 <= bits <= 16:
        return f"the texture's components have {bits!r} bits; give 4 to 16."
    border = image.border
    if isinstance(border, bool) or not isinstance(border, Integral) or border < 0:
        return f"the texture's border is {border!r}; give a number of texels from 0 on."
    for level, array in enumerate(image.levels):
        if problem := _level_problem(image, level, array):
            return problem
    if len(image.levels) > complete_levels(image.width, max(image.height, image.depth)):
        return (
            f"the texture has {len(image.levels)} levels but a {image.width}x{image.height} image ends at "
            "1x1 before."
        )
    if image.target is TextureTarget.TEXTURE_CUBE_MAP and image.width != image.height:
        return f"the cube map's faces are {image.width}x{image.height}; they must be square."
    if image.target is TextureTarget.TEXTURE_RECTANGLE and len(image.levels) > 1:
        return f"the TEXTURE_RECTANGLE has {len(image.levels)} levels; it has level 0 alone."
    if image.target is TextureTarget.TEXTURE_1D and image.height != 1:
        return f"the 1D texture is {image.height} texels high; give one row, or use texture_2d."
    if image.ideal is not None:
        if [a.shape for a in image.ideal] != [a.shape for a in image.levels]:
            return "the texture's ideal levels do not have its levels' shapes; give the same, or None."
        if not all(np.isfinite(a).all() for a in image.ideal):
            return "the texture's ideal levels hold NaN or infinity; give finite texels."
    return None


def tex_image(walk, command):
    """Refuse a TexImage that the machine could not hold; remember its texture."""
    if (command.image is None) == (command.pixels is None):
        has = "neither an image nor" if command.image is None else "an image and"
        walk.refuse(f"it has {has} pixels; give a Texture as image, or a PixelImage as pixels.")
    if command.image is not None:
        store(walk, command.texture, command.image)
        return
    target, internal_format = command.target, command.internal_format
    deep = internal_format in _FIXED_DEPTHS
    _copied_format(walk, internal_format)
    axes = 3 if target in _PARTS else 2
    formats = _DEPTH_IMAGES if deep else _COLOR_IMAGES
    if problem := pixel_image_problem(command.pixels, formats, axes):
        walk.refuse(problem)
    layers, height, width = ((1,) * (3 - axes) + command.pixels.values.shape)[:3]
    if target is TextureTarget.TEXTURE_CUBE_MAP and layers != 6:
        walk.refuse(f"the image has {layers} layers; a TEXTURE_CUBE_MAP takes 6 faces.")
    if axes == 3 and deep:
        walk.refuse(f"{internal_format.name} makes 1D and 2D textures; give TEXTURE_2D.")
    dimensions = {TextureTarget.TEXTURE_1D: 1, TextureTarget.TEXTURE_3D: 3}.get(target, 2)
    width, height = _texels_left(walk, command, width, height, dimensions, deep)
    layers = layers if target is TextureTarget.TEXTURE_3D else 1
    _define(walk, command, width, height, layers)


def _define(walk, command, width, height, layers=1):
    """Check and remember the texture that a TexImage makes from pixels, or a CopyTexImage."""
    target, internal_format = command.target, command.internal_format
    if target is TextureTarget.TEXTURE_1D and height != 1:
        walk.refuse(f"a TEXTURE_1D has one row of texels; this rectangle has {height}. Give height 1.")
    if target is TextureTarget.TEXTURE_CUBE_MAP and width != height:
        walk.refuse(f"the cube map's faces are {width}x{height}; they must be square.")
    _texture_storage(walk, target, internal_format, width, height, layers)
    if command.generate_mipmap and internal_format in DEPTH_TEXELS:
        walk.refuse(
            f"mipmaps of a {target.name} of {internal_format.name} are not generated; set "
            "generate_mipmap to False."
        )
    sizes, faces = ((width, height),), (layers,)
    if command.generate_mipmap:
        sizes = _mipmap_sizes(walk, width, height, layers)
        faces = tuple(max(1, layers >> k) for k in range(len(sizes)))
    if target is TextureTarget.TEXTURE_CUBE_MAP:
        faces = (6,) * len(sizes)
    walk.textures[command.texture] = KnownTexture(target, internal_format, sizes, faces)


def store(walk, name, image):
    """Refuse a Texture that the machine could not hold; remember it under its name."""
    if wrong := _check_texture(image):
        walk.refuse(f"it {wrong.predicate}.")
    if known := walk.taken.textures.get(image):
        walk.textures[name] = known
        return
    if image not in _checked_textures:
        if problem := _texture_problem(image):
            walk.refuse(problem)
        _checked_textures.add(image)
    _texture_storage(walk, image.target, image.internal_format, image.width, image.height, image.depth)
    _border(walk, image)
    walk.textures[name] = walk.taken.textures[image] = KnownTexture.of(image)


def _border(walk, image):
    """Refuse a border that the machine lacks.

    Source: OpenGL 1.2.1 section 3.8.1; NV_texture_rectangle (rectangles have none).
    """
    allowed = walk.profile.textures.texture_borders
    if image.target is TextureTarget.TEXTURE_RECTANGLE:
        allowed = frozenset({0})
    if image.border not in allowed:
        takes = " or ".join(str(texels) for texels in sorted(allowed))
        walk.refuse(
            f"the {image.target.name} has a border of {image.border}; {walk.profile.name} takes {takes}. "
            "Cut it off, or give one of these."
        )


def copy_tex_image(walk, command):
    """Refuse a CopyTexImage that the machine could not hold; remember its texture."""
    width, height = surfaces.framebuffer_rectangle(walk, command)
    buffers.color_buffer(walk, command.read_buffer)
    _copied_format(walk, command.internal_format)
    buffers.fixed_depths(walk, command.internal_format in DEPTH_TEXELS, "copies depths")
    if command.target in (TextureTarget.TEXTURE_CUBE_MAP, TextureTarget.TEXTURE_3D):
        what, parts = _PARTS[command.target]
        walk.refuse(
            f"CopyTexImage defines 1D and 2D textures; define a {what} with TexImage and fill its "
            f"{parts} with CopyTexSubImage."
        )
    dimensions = 1 if command.target is TextureTarget.TEXTURE_1D else 2
    deep = command.internal_format in DEPTH_TEXELS
    _define(walk, command, *_texels_left(walk, command, width, height, dimensions, deep))


def _texels_left(walk, command, width, height, dimensions, deep):
    """Width and height of the texture that an image becomes; refuse a null texture.

    Source: OpenGL 1.2.1 section 3.8.1: a null texture acts as if texturing were disabled.
    """
    left = transferred(walk, command, width, height, dimensions, deep)
    if min(left) < 1 <= min(width, height):
        wide, high = filter_size(convolution(command.transfer, dimensions))
        walk.refuse(
            f"the {wide}x{high} filter with REDUCE leaves nothing of {width}x{height} pixels: a null "
            "texture, with which it is as if texturing were disabled, and which is not kept here. Leave the "
            "unit None, or give a larger image, a smaller filter, or REPLICATE_BORDER."
        )
    return left


def _copied_format(walk, internal_format):
    if internal_format not in _MADE_FROM_PIXELS:
        walk.refuse(
            f"{internal_format.name} is not made from pixels; define it with TexImage and a Texture, or "
            f"give one of {listed(_MADE_FROM_PIXELS)}."
        )


def _mipmap_sizes(walk, width, height, layers=1):
    """(width, height) of every level that mipmaps from level 0 have; refuse edges that are no powers of 2."""
    if width & (width - 1) or height & (height - 1) or layers & (layers - 1):
        size = f"{width}x{height}" + (f"x{layers}" if layers > 1 else "")
        walk.refuse(f"mipmaps cannot be generated of {size} texels; give edges that are powers of two.")
    levels = max(width, height, layers).bit_length()
    return tuple((max(1, width >> k), max(1, height >> k)) for k in range(levels))


def copy_tex_sub_image(walk, command):
    """Refuse a CopyTexSubImage that does not fit its texture."""
    known = known_texture(walk, command.texture)
    _copied_format(walk, known.internal_format)
    if known.border:
        walk.refuse(
            f"{command.texture!r} has a border of {known.border}, and copies into such textures are not "
            "drawn here; define it with TexImage, or copy into a texture without a border."
        )
    if command.generate_mipmap:
        if known.target is TextureTarget.TEXTURE_3D:
            walk.refuse("mipmaps of a 3D texture are not generated; give its levels with TexImage.")
        if command.level != 0:
            walk.refuse(
                f"mipmaps are generated from level 0, not from level {command.level}; copy into level "
                "0, or set generate_mipmap to False."
            )
        sizes = _mipmap_sizes(walk, *known.sizes[0])
        faces = known.faces[:1] * len(sizes)
        walk.textures[command.texture] = KnownTexture(known.target, known.internal_format, sizes, faces)
    _level_and_face(walk, command, known)
    width, height = surfaces.framebuffer_rectangle(walk, command)
    buffers.color_buffer(walk, command.read_buffer)
    deep = known.internal_format in DEPTH_TEXELS
    buffers.fixed_depths(walk, deep, "copies depths")
    dimensions = 1 if known.target is TextureTarget.TEXTURE_1D else 2
    width, height = transferred(walk, command, width, height, dimensions, deep)
    surfaces.inside(
        walk,
        f"level {command.level} of {command.texture!r}",
        (command.x_offset, command.y_offset, width, height),
        *known.sizes[command.level],
    )


def _level_and_face(walk, command, known, faces=None):
    """Refuse a level or a face that a texture lacks. ``faces``: how many it has; None: all of the level's."""
    if not 0 <= command.level < len(known.sizes):
        walk.refuse(
            f"level {command.level} of {command.texture!r} does not exist; it has {len(known.sizes)}. "
            f"Give a level from 0 to {len(known.sizes) - 1}."
        )
    faces = faces or known.faces[command.level]
    if not 0 <= command.face < faces:
        walk.refuse(
            f"face {command.face} of {command.texture!r} does not exist; a {known.target.name} has "
            f"{f'faces 0 to {faces - 1}' if faces > 1 else 'face 0 only'}."
        )


def get_tex_image(walk, command):
    """Refuse a GetTexImage of a texture that does not exist, or in a format that its texels do not have."""
    buffers.read_as(walk, command, (*READ_FORMATS, DEPTH_FORMAT))
    known = known_texture(walk, command.texture)
    internal_format = known.internal_format
    deep = internal_format in DEPTH_TEXELS
    if not deep and internal_format not in _COLORS:
        walk.refuse(
            f"{command.texture!r} is {internal_format.name}, and GetTexImage has no format for its words; it "
            f"reads {listed({*COMPONENT_BITS, *TWELVE_BIT_FORMATS, *DEPTH_TEXELS})}."
        )
    if deep != (command.format == DEPTH_FORMAT):
        instead = f"give {DEPTH_FORMAT}" if deep else "give a format of colours"
        walk.refuse(
            f"{command.texture!r} is {internal_format.name} and the format is {command.format}; {instead}."
        )
    _level_and_face(walk, command, known, faces=1 if known.target is TextureTarget.TEXTURE_3D else None)
    if not (changes_nothing(command.transfer) or walk.profile.pixels.transfers_texture_queries):
        walk.refuse(
            f"it has a pixel transfer; {walk.profile.name} returns texture images without one. Leave "
            "transfer out, or draw the texture and give it to ReadPixels."
        )
    dimensions = {TextureTarget.TEXTURE_1D: 1, TextureTarget.TEXTURE_3D: 3}.get(known.target, 2)
    transferred(walk, command, *known.sizes[command.level], dimensions, deep)
    scaled = (command.transfer.depth_scale, command.transfer.depth_bias) != (1.0, 0.0)
    if deep and scaled and internal_format not in _FIXED_DEPTHS:
        walk.refuse(
            f"it scales depths of {internal_format.name}; only fixed-point depths go through pixel transfer. "
            "Leave depth_scale and depth_bias alone."
        )


def bind_tex_image(walk, command):
    """Refuse a BindTexImage that cannot read the pbuffer's words; remember its texture."""
    if command.surface not in walk.surfaces:
        made = quoted(walk.surfaces)
        walk.refuse(
            f"there is no pbuffer {command.surface!r} yet (made so far: {made}); put a MakeCurrent before."
        )
    surface = walk.surfaces[command.surface]
    formats = (*READABLE_AS[surface.color_format], DEPTH_READABLE_AS[surface.depth_bits])
    if command.internal_format not in formats:
        walk.refuse(
            f"{command.internal_format.name} does not read the words of {surface.color_format.name} with "
            f"{depth_words(surface.depth_bits)}; give {listed(formats)}."
        )
    if command.target not in (TextureTarget.TEXTURE_2D, TextureTarget.TEXTURE_RECTANGLE):
        walk.refuse(f"a pbuffer becomes a 2D texture, not a {command.target.name}; give TEXTURE_2D.")
    if surface.samples > 1 and command.internal_format == DEPTH_READABLE_AS[surface.depth_bits]:
        walk.refuse(
            f"pbuffer {command.surface!r} has {surface.samples} samples in each pixel, whose colours alone "
            "become a texture; give a colour format, or make it with one sample."
        )
    size = (surface.width * surface.samples, surface.height)
    _texture_storage(walk, command.target, command.internal_format, *size)
    walk.textures[command.texture] = KnownTexture(command.target, command.internal_format, (size,), (1,))


def _texture_storage(walk, target, internal_format, width, height, layers=1):
    profile = walk.profile
    if target not in profile.textures.texture_targets:
        walk.refuse(
            f"{profile.name} has no {target.name}; it has {listed(profile.textures.texture_targets)}."
        )
    if internal_format not in profile.textures.internal_formats:
        walk.refuse(
            f"{profile.name} does not store {internal_format.name}; it stores "
            f"{listed(profile.textures.internal_formats)}."
        )
    if width < 1 or height < 1:
        walk.refuse(f"the texture is {width}x{height} texels; a texture needs at least 1x1.")
    what, limit = {
        TextureTarget.TEXTURE_CUBE_MAP: ("cube map faces", profile.textures.max_cube_map_texture_size),
        TextureTarget.TEXTURE_3D: ("3D textures", profile.textures.max_3d_texture_size),
    }.get(target, ("textures", profile.textures.max_texture_size))
    if max(width, height, layers) > limit:
        walk.refuse(
            f"the texture is {width}x{height}; {profile.name} holds {what} up to {limit}x{limit}. Scale "
            "it down or split it."
            if layers == 1
            else f"the texture is {width}x{height}x{layers}; {profile.name} holds {what} up to {limit} "
            "texels an edge. Scale it down or split it."
        )
    two = profile.textures.power_of_two_textures and target is not TextureTarget.TEXTURE_RECTANGLE
    if two and layers & (layers - 1):
        walk.refuse(
            f"the texture has {layers} layers; {profile.name} takes edges that are powers of two. Give "
            f"{nearest_power_of_two(layers)}."
        )
    if two and (width & (width - 1) or height & (height - 1)):
        walk.refuse(
            f"the texture is {width}x{height}; {profile.name} takes edges that are powers of two. Scale "
            f"it to {nearest_power_of_two(width)}x{nearest_power_of_two(height)}, or pad it."
        )


def known_texture(walk, name):
    """The KnownTexture of this name; refuse a name that no texture has."""
    if name not in walk.textures:
        defined = quoted(walk.textures)
        walk.refuse(
            f"there is no texture {name!r} yet (defined so far: {defined}); put a TexImage or "
            "CopyTexImage before."
        )
    return walk.textures[name]
