"""Texture images: whole ones, parts, copies, proxies, compressed images, palettes.

Source: OpenGL 1.2.1 sections 3.8.1 and 3.8.2; EXT_texture3D, EXT_texture_cube_map, NV_texture_rectangle,
ARB_texture_compression, EXT_texture_compression_s3tc, EXT_paletted_texture, EXT_shared_texture_palette,
ARB_depth_texture, SGIS_generate_mipmap.
"""

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from fixedpipe.pipeline.commands import CopyTexImage, CopyTexSubImage, DrawPixels
from fixedpipe.pipeline.enums import InternalFormat
from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.copied_images import copy_alone
from fixedpipe.pipeline.opengl.entry_points import entry
from fixedpipe.pipeline.opengl.framebuffer_objects import define_attached
from fixedpipe.pipeline.opengl.internal_formats import COMPONENT_COUNTS, INDICES, Chosen, chosen_format
from fixedpipe.pipeline.opengl.outcomes import GLError, Refused
from fixedpipe.pipeline.opengl.pixel_transfers import counts, transfer_of
from fixedpipe.pipeline.opengl.pixels import ClientImage, captured, given_image
from fixedpipe.pipeline.opengl.texels import Patch, Texels, check_image_format, texels_of, zero_texels
from fixedpipe.pipeline.opengl.texture_objects import (
    TARGETS,
    Image,
    TextureObject,
    smaller_sizes,
    zeros_like,
)
from fixedpipe.pipeline.opengl.texturing import bound_object, mark
from fixedpipe.pipeline.opengl.values import declare
from fixedpipe.pipeline.pixel_transfer import has_sink, transferred_size
from fixedpipe.pipeline.state import ColorMask, PassState
from fixedpipe.pipeline.textures.images import COMPONENT_BITS, DEPTH_TEXELS, TWELVE_BIT_FORMATS
from fixedpipe.pipeline.textures.words import (
    S3TC_BLOCK_BYTES,
)

# The key of a texture's first image: face 0, level 0.
WHOLE = (0, 0)
FACES = range(tokens.TEXTURE_CUBE_MAP_POSITIVE_X, tokens.TEXTURE_CUBE_MAP_NEGATIVE_Z + 1)
PROXIES = {
    tokens.PROXY_TEXTURE_1D: tokens.TEXTURE_1D,
    tokens.PROXY_TEXTURE_2D: tokens.TEXTURE_2D,
    tokens.PROXY_TEXTURE_3D: tokens.TEXTURE_3D,
    tokens.PROXY_TEXTURE_CUBE_MAP: tokens.TEXTURE_CUBE_MAP,
    tokens.PROXY_TEXTURE_RECTANGLE_NV: tokens.TEXTURE_RECTANGLE_NV,
}
# Formats of images that only framebuffer objects use; their pbuffers have depths and stencil values.
_WITH_STENCIL = {tokens.DEPTH_STENCIL_NV, tokens.DEPTH24_STENCIL8_EXT}
_DIMENSIONS = {tokens.TEXTURE_1D: 1, tokens.TEXTURE_3D: 3}
# {(proxy, level): ProxyImage}, as a tuple of pairs.
declare("proxies", ())
_WRITES_NOTHING = PassState(color_mask=ColorMask(False, False, False, False))


class ProxyImage(NamedTuple):
    """A proxy's answer for an image that the machine could store."""

    size: tuple[int, int, int]
    border: int
    internal_format: int
    chosen: Chosen


class Place(NamedTuple):
    """The place of an image: the bound target, the face, and whether the target is a proxy."""

    target: int
    face: int
    proxy: bool


def place_of(gl, target, dimensions):
    """The Place of a call for images of ``dimensions``. Raises GLError, and Refused."""
    bound, face = PROXIES.get(target, target), 0
    if target in FACES:
        bound, face = tokens.TEXTURE_CUBE_MAP, target - tokens.TEXTURE_CUBE_MAP_POSITIVE_X
    elif target == tokens.TEXTURE_CUBE_MAP:
        raise GLError(tokens.INVALID_ENUM, "an image belongs to a face of a cube map")
    if bound not in TARGETS or _DIMENSIONS.get(bound, 2) != dimensions:
        raise GLError(
            tokens.INVALID_ENUM, f"{tokens.name_of(target)} takes no image of {dimensions} dimensions"
        )
    if TARGETS[bound] not in gl.profile.textures.texture_targets:
        raise Refused(f"{gl.profile.name} has no {tokens.name_of(bound)}")
    return Place(bound, face, target in PROXIES)


def _largest_edge(profile, target):
    """The most texels along an edge of level 0."""
    textures = profile.textures
    return {
        tokens.TEXTURE_CUBE_MAP: textures.max_cube_map_texture_size,
        tokens.TEXTURE_3D: textures.max_3d_texture_size,
    }.get(target, textures.max_texture_size)


def check_image(gl, place, level, size, border):
    """Refuse sizes, levels and borders that the machine's driver refuses. Raises GLError(INVALID_VALUE)."""
    most, rectangle = _largest_edge(gl.profile, place.target), place.target == tokens.TEXTURE_RECTANGLE_NV
    if level < 0 or level > most.bit_length() - 1 or (rectangle and level):
        raise GLError(tokens.INVALID_VALUE, f"level {level}")
    if border not in (0, 1) or (rectangle and border):
        raise GLError(tokens.INVALID_VALUE, f"a border of {border}")
    two = gl.profile.textures.power_of_two_textures and not rectangle
    axes = _DIMENSIONS.get(place.target, 2)
    for edge in size[:axes]:
        inside = edge - 2 * border
        if edge == 0 and border == 0:
            continue
        if edge < 0 or inside < 1 or inside > max(most >> level, 1) or (two and inside & (inside - 1)):
            name = gl.profile.name
            raise GLError(
                tokens.INVALID_VALUE,
                f"{'x'.join(map(str, size[:axes]))} texels at level {level} with a border of {border}; "
                f"{name} has up to {most}{', powers of two' if two else ''}",
            )
    if place.target == tokens.TEXTURE_CUBE_MAP and size[0] != size[1]:
        raise GLError(tokens.INVALID_VALUE, f"{size[0]}x{size[1]} texels of a cube map's face")


def _said(gl):
    return f"{gl.called} (call {gl.tally.call})"


def mark_changed(gl: Any, texture: TextureObject) -> None:
    """Note that a texture's images have changed."""
    texture.changed(_said(gl))
    mark(gl, texture)


# ---------------------------------------------------------------------------------------------- whole images


@entry("TexImage1D", capture=captured(3))
def tex_image_1d(gl, target, level, internal_format, width, border, image_format, image_type, image):
    """Define an image of one row of texels."""
    _tex_image(
        gl, place_of(gl, target, 1), level, internal_format, (width, 1, 1), border, image_format, image
    )


@entry("TexImage2D", capture=captured(3, 4))
def tex_image_2d(gl, target, level, internal_format, width, height, border, image_format, image_type, image):
    """Define a two-dimensional image, or one of a cube map's faces."""
    size = width, height, 1
    _tex_image(gl, place_of(gl, target, 2), level, internal_format, size, border, image_format, image)


@entry("TexImage3D", capture=captured(3, 4, 5, layers=True))
def tex_image_3d(
    gl, target, level, internal_format, width, height, depth, border, image_format, image_type, image
):
    """Define an image of several layers."""
    size = width, height, depth
    _tex_image(gl, place_of(gl, target, 3), level, internal_format, size, border, image_format, image)


def _tex_image(gl, place, level, internal_format, size, border, image_format, image):
    """Define an image, or find with a proxy whether the machine could store it."""
    if not place.proxy:  # framebuffer objects can also draw into images that no machine stores
        bound_object(gl, place.target).asked[place.face, level] = (*size[:2], internal_format)
        if image is None and internal_format in _WITH_STENCIL:
            gl.tally.add("no effect", f"{gl.called}: depths and stencil values of a framebuffer object")
            return
    chosen = chosen_format(gl.profile, internal_format)
    if place.proxy:
        ask_proxy(gl, place, level, internal_format, chosen, size, border)
        return
    transfer, dimensions = transfer_of(gl), _DIMENSIONS.get(place.target, 2)
    colors = chosen.base is not None and chosen.format is not InternalFormat.SIGNED_RGBA8
    if dimensions < 3 and colors and 0 not in size:
        size = (*transferred_size(size[0], size[1], transfer, dimensions), size[2])
    check_image(gl, place, level, size, border)
    _check_depths(place, chosen)
    check_image_format(chosen, image_format)
    if chosen.compressing:
        gl.tally.add("no effect", f"{gl.called}: the request to compress ({tokens.name_of(internal_format)})")
    try:
        found, unknown = given_image(image), None
    except Refused as refusal:  # the image's memory is not known; the texture is defined nevertheless
        found, unknown = None, refusal
    texels = _texels(gl, found, transfer, chosen, size, dimensions)
    define_image(gl, place, level, Image(size, border, internal_format, chosen, texels))
    if unknown is not None:
        raise unknown


def _check_depths(place, chosen):
    """Refuse depths in volumes and cube maps (ARB_depth_texture)."""
    if chosen.format in DEPTH_TEXELS and place.target in (tokens.TEXTURE_3D, tokens.TEXTURE_CUBE_MAP):
        raise GLError(tokens.INVALID_OPERATION, "depth textures are of one or two dimensions")


def _texels(gl, image: ClientImage | None, transfer, chosen, size, dimensions) -> Texels | None:
    """The Texels of an image; zeros if there is no image; None if a sink discards it."""
    width, height, depth = size
    if image is None or 0 in size:
        return zero_texels(chosen, depth, height, width)
    counted = counts(transfer) and chosen.base is not None
    if counted:
        count_groups(gl, image, transfer, dimensions)
        if has_sink(transfer):
            return None
        transfer = replace(transfer, histogram=None, minmax=None)
    return texels_of(gl.profile, image, transfer, chosen, dimensions)


def count_groups(gl, image, transfer, dimensions):
    """Let the machine count the groups of a texture's image: it draws pixels that change nothing."""
    if dimensions == 1:
        transfer = replace(transfer, convolution_2d=transfer.convolution_1d, separable_2d=None)
    elif dimensions == 3:
        transfer = replace(transfer, convolution_2d=None, separable_2d=None)
    for layer in image.values:
        counted = image._replace(values=layer[None]).pixel_image()
        gl.commands.append(
            DrawPixels(label=_said(gl), image=counted, state=_WRITES_NOTHING, transfer=transfer)
        )


def define_image(gl, place, level, image: Image):
    """Store an image in its place. Without texels, the earlier image of this size stays, or it is zeros."""
    texture, position = bound_object(gl, place.target), (place.face, level)
    if image.internal_format in INDICES and gl.values["enabled", tokens.SHARED_TEXTURE_PALETTE_EXT]:
        texture.shared_palette = gl.values["shared_palette"]
    _before_images_change(texture, level)
    if image.texels is None:
        before = texture.images.get(position)
        same = before is not None and before.size == image.size and before.like(image)
        image = before if same and before is not None else zeros_like(image)
    if 0 in image.size:
        texture.images.pop(position, None)
    else:
        texture.images[position] = _without_border(gl, image, texture.bordered_axes)
    after_images_changed(gl, texture, level)


def _without_border(gl, image, axes):
    """The image, or the part inside its border if the machine has no borders of one texel."""
    if not image.border or image.border in gl.profile.textures.texture_borders or image.texels is None:
        return image
    width, height, depth = [edge - 2 * (axis < axes) for axis, edge in enumerate(image.size)]
    inside = tuple([slice(1, -1) if axis < axes else slice(None) for axis in (2, 1, 0)])
    texels, real = image.texels
    gl.tally.add(
        "refused", f"{gl.called}: a border of 1: {gl.profile.name} has none; the texels inside are used"
    )
    cut = Texels(np.ascontiguousarray(texels[inside]), None if real is None else real[inside])
    return replace(image, size=(width, height, depth), border=0, texels=cut)


def _before_images_change(texture: TextureObject, level: int) -> None:
    """Make the smaller levels that are not made yet, unless the level that they are made from changes now."""
    if level != texture.stale:
        texture.settle()


def after_images_changed(gl: Any, texture: TextureObject, level: int) -> None:
    """Note that an image has changed. If smaller levels are made automatically, they must be made again."""
    rectangle = texture.target == tokens.TEXTURE_RECTANGLE_NV
    if texture.parameters.generate_mipmap and level == texture.parameters.base_level and not rectangle:
        _expect_smaller(gl, texture, level)
    mark_changed(gl, texture)


def _expect_smaller(gl, texture, level):
    """Note that the levels above ``level`` must be made from it, when something needs them."""
    faces = texture.level(level)
    if faces is None:
        return
    width, height, _ = faces[0].size
    sizes = smaller_sizes(faces[0], texture.is_volume)
    if not sizes and max(faces[0].size) > 1:
        what = f"mipmaps of {width}x{height} texels of {faces[0].chosen.format.name}"
        gl.tally.add("refused", f"{gl.called}: {what} are not made here")
        return
    texture.stale = level
    for face, image in enumerate(faces):
        if image.texels is None:  # the machine will make them, so images for them must exist
            for above, size in enumerate(sizes, level + 1):
                held = texture.images.get((face, above))
                if held is None or held.size != size or not held.like(image):
                    texture.images[face, above] = zeros_like(image, size)


@entry("GenerateMipmap", compiled=False)
def generate_mipmap(gl, target):
    """Make the levels above the base level once (EXT_framebuffer_object)."""
    if target not in TARGETS or target == tokens.TEXTURE_RECTANGLE_NV:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(target)} has no mipmaps")
    texture = bound_object(gl, target)
    define_attached(gl, texture)
    texture.settle()
    level = texture.parameters.base_level
    if texture.level(level) is None:
        if target == tokens.TEXTURE_CUBE_MAP:
            raise GLError(tokens.INVALID_OPERATION, "the cube map's faces are missing or differ")
        return
    _expect_smaller(gl, texture, level)
    texture.settle()
    mark_changed(gl, texture)


# -------------------------------------------------------------------------------------------------- proxies


def ask_proxy(gl, place, level, internal_format, chosen, size, border):
    """Store a proxy's answer: the image's size, or nothing if the machine could not store the image."""
    answer = ProxyImage(size, border, internal_format, chosen)
    try:
        check_image(gl, place, level, size, border)
    except GLError:
        answer = None
    held = {key: image for key, image in gl.values["proxies"] if key != (place.target, level)}
    if answer is not None:
        held[place.target, level] = answer
    gl.values.set("proxies", tuple(held.items()))


# ----------------------------------------------------------------------------------------------- sub-images


@entry("TexSubImage1D", capture=captured(3))
def tex_sub_image_1d(gl, target, level, x, width, image_format, image_type, image):
    """Replace texels of a row."""
    _tex_sub_image(gl, place_of(gl, target, 1), level, (x, 0, 0), (width, 1, 1), image_format, image)


@entry("TexSubImage2D", capture=captured(4, 5))
def tex_sub_image_2d(gl, target, level, x, y, width, height, image_format, image_type, image):
    """Replace a rectangle of texels."""
    _tex_sub_image(gl, place_of(gl, target, 2), level, (x, y, 0), (width, height, 1), image_format, image)


@entry("TexSubImage3D", capture=captured(5, 6, 7, layers=True))
def tex_sub_image_3d(gl, target, level, x, y, z, width, height, depth, image_format, image_type, image):
    """Replace a box of texels."""
    _tex_sub_image(gl, place_of(gl, target, 3), level, (x, y, z), (width, height, depth), image_format, image)


def existing_image(texture, place, level) -> Image:
    """The image that a sub-image changes. Raises GLError."""
    if place.proxy:
        raise GLError(tokens.INVALID_ENUM, "a proxy has no texels")
    _before_images_change(texture, level)
    image = texture.images.get((place.face, level))
    if image is None:
        raise GLError(tokens.INVALID_OPERATION, f"{texture.name} has no image of level {level}")
    return image


def check_box(texture, image, offset, size):
    """Where a box begins in an image with its border. Raises GLError if it extends outside the image."""
    at = []
    for axis, (first, edge, whole) in enumerate(zip(offset, size, image.size, strict=True)):
        begins = first + (image.border if axis < texture.bordered_axes else 0)
        if edge < 0 or begins < 0 or begins + edge > whole:
            raise GLError(
                tokens.INVALID_VALUE,
                f"{'x'.join(map(str, size))} texels at {offset} of {'x'.join(map(str, image.size))}",
            )
        at.append(begins)
    return tuple(at)


def _tex_sub_image(gl, place, level, offset, size, image_format, image):
    """Replace a box of an image by an image of client memory."""
    texture, transfer = bound_object(gl, place.target), transfer_of(gl)
    held = existing_image(texture, place, level)
    if held.chosen.format in S3TC_BLOCK_BYTES:
        raise Refused("texels in a compressed image: there is no compressor here")
    check_image_format(held.chosen, image_format)
    found, dimensions = given_image(image), _DIMENSIONS.get(place.target, 2)
    if dimensions < 3 and held.chosen.base is not None and 0 not in size:
        size = (*transferred_size(size[0], size[1], transfer, dimensions), size[2])
    x, y, z = check_box(texture, held, offset, size)
    if found is None or 0 in size:
        return
    texels = _texels(gl, found, transfer, held.chosen, size, dimensions)
    if texels is None:
        return
    texture.images[place.face, level] = held.with_patch(Patch(z, y, x, texels))
    after_images_changed(gl, texture, level)


# ------------------------------------------------------------------------------------- copies (section 3.8.2)


def framebuffer_size(gl: Any) -> tuple[int, int]:
    """Width and height of the framebuffer that copies read."""
    return gl.drawable.width, gl.drawable.height


@entry("CopyTexImage1D")
def copy_tex_image_1d(gl, target, level, internal_format, x, y, width, border):
    """Define a row of texels from the framebuffer."""
    _copy_tex_image(gl, place_of(gl, target, 1), level, internal_format, (x, y, width, 1), border)


@entry("CopyTexImage2D")
def copy_tex_image_2d(gl, target, level, internal_format, x, y, width, height, border):
    """Define an image from the framebuffer."""
    _copy_tex_image(gl, place_of(gl, target, 2), level, internal_format, (x, y, width, height), border)


def _copyable(chosen):
    return (
        chosen.format in COMPONENT_BITS
        or chosen.format in TWELVE_BIT_FORMATS
        or chosen.format in DEPTH_TEXELS
    )


def _copy_tex_image(gl, place, level, internal_format, box, border):
    """Define an image from a rectangle of the framebuffer."""
    if place.proxy or internal_format in COMPONENT_COUNTS:
        raise GLError(tokens.INVALID_ENUM)
    chosen, transfer = chosen_format(gl.profile, internal_format), transfer_of(gl)
    if not _copyable(chosen):
        raise GLError(tokens.INVALID_OPERATION, f"{tokens.name_of(internal_format)} is not copied")
    x, y, width, height = box
    kept = _transferred(transfer, chosen, place, width, height)
    check_image(gl, place, level, (*kept, 1), border)
    _check_depths(place, chosen)
    if border:  # commands copy no borders, so only the texels inside are copied
        axes = 1 if place.target == tokens.TEXTURE_1D else 2
        box = x + 1, y + (axes == 2), width - 2, height - 2 * (axes == 2)
        kept = _transferred(transfer, chosen, place, *box[2:])
        gl.tally.add(
            "refused", f"{gl.called}: a border of 1: copies have none here; the texels inside are used"
        )
    texture = bound_object(gl, place.target)
    texture.asked[place.face, level] = (*kept, internal_format)
    _before_images_change(texture, level)
    if 0 in kept:
        texture.images.pop((place.face, level), None)
        mark_changed(gl, texture)
        return
    image = Image((*kept, 1), 0, internal_format, chosen, None)
    if _is_whole_texture(gl, texture, level, box):
        _copy_whole(gl, texture, image, box, transfer)
        return
    if not texture.make_room((place.face, level), image):
        after_images_changed(gl, texture, level)
    _copy_into(gl, texture, place.face, level, (0, 0, 0), box, transfer)


def _transferred(transfer, chosen, place, width, height):
    if chosen.format in DEPTH_TEXELS or 0 in (width, height):
        return width, height
    return transferred_size(width, height, transfer, _DIMENSIONS.get(place.target, 2))


def _is_whole_texture(gl, texture, level, box):
    """Whether a copy of level 0 defines everything that a unit reads from the object."""
    x, y, width, height = box
    wide, high = framebuffer_size(gl)
    inside = x >= 0 and y >= 0 and x + width <= wide and y + height <= high
    alone = texture.parameters.generate_mipmap or not {key for key in texture.images if key != WHOLE}
    flat = texture.target not in (tokens.TEXTURE_CUBE_MAP, tokens.TEXTURE_3D)
    return inside and flat and level == 0 == texture.parameters.base_level and alone


def _copy_whole(gl, texture, image, box, transfer):
    """Carry out CopyTexImage as one command, with all smaller levels if they are made automatically."""
    x, y, width, height = box
    generates = texture.parameters.generate_mipmap and texture.target != tokens.TEXTURE_RECTANGLE_NV
    images = {WHOLE: image}
    if generates:
        sizes = smaller_sizes(image, False)
        generates = bool(sizes)
        images |= {(0, level): replace(image, size=size) for level, size in enumerate(sizes, 1)}
    texture.images, texture.stale = images, None
    gl.commands.append(
        CopyTexImage(
            label=_said(gl),
            texture=texture.name,
            target=TARGETS[texture.target],
            internal_format=image.chosen.format,
            x=x,
            y=y,
            width=width,
            height=height,
            generate_mipmap=generates,
            transfer=transfer,
        )
    )
    mark_changed(gl, texture)
    texture.keep_copies(gl)


@entry("CopyTexSubImage1D")
def copy_tex_sub_image_1d(gl, target, level, x_offset, x, y, width):
    """Replace texels of a row from the framebuffer."""
    _copy_tex_sub_image(gl, place_of(gl, target, 1), level, (x_offset, 0, 0), (x, y, width, 1))


@entry("CopyTexSubImage2D")
def copy_tex_sub_image_2d(gl, target, level, x_offset, y_offset, x, y, width, height):
    """Replace a rectangle of texels from the framebuffer."""
    _copy_tex_sub_image(gl, place_of(gl, target, 2), level, (x_offset, y_offset, 0), (x, y, width, height))


@entry("CopyTexSubImage3D")
def copy_tex_sub_image_3d(gl, target, level, x_offset, y_offset, z_offset, x, y, width, height):
    """Replace a rectangle of a layer from the framebuffer."""
    offset = x_offset, y_offset, z_offset
    _copy_tex_sub_image(gl, place_of(gl, target, 3), level, offset, (x, y, width, height))


def _copy_tex_sub_image(gl, place, level, offset, box):
    """Replace a rectangle of an image from the framebuffer."""
    texture, transfer = bound_object(gl, place.target), transfer_of(gl)
    held = existing_image(texture, place, level)
    if not _copyable(held.chosen) or held.border:
        raise Refused(f"copies into textures of {held.chosen.format.name} with a border of {held.border}")
    width, height = _transferred(transfer, held.chosen, place, *box[2:])
    check_box(texture, held, offset, (width, height, 1))
    if width and height:
        _copy_into(gl, texture, place.face, level, offset, box, transfer)


def _copy_into(gl, texture, face, level, offset, box, transfer):
    """Let the machine copy a rectangle into an image that exists."""
    texture.settle()
    layout = texture.layout()
    fits = layout is not None and layout.first <= level < layout.first + len(layout.levels)
    if fits:
        texture.store(gl)
    offset, box = _inside(gl, offset, box, transfer)
    x, y, width, height = box
    if width <= 0 or height <= 0:
        return
    copy = CopyTexSubImage(
        label=_said(gl),
        texture=texture.name,
        x_offset=offset[0],
        y_offset=offset[1],
        x=x,
        y=y,
        width=width,
        height=height,
        transfer=transfer,
    )
    if not fits:
        copy_alone(gl, texture, (face, level), copy)
        mark_changed(gl, texture)
        return
    derives = texture.parameters.generate_mipmap and level == texture.parameters.base_level
    derives = derives and texture.target != tokens.TEXTURE_RECTANGLE_NV
    by_machine = derives and layout.first == level and not texture.is_volume
    sizes = smaller_sizes(texture.images[face, level], False) if by_machine else []
    of_face = offset[2] if texture.target == tokens.TEXTURE_3D else face
    copy = replace(copy, level=level - layout.first, face=of_face, generate_mipmap=bool(sizes))
    gl.commands.append(copy)
    copied = [(face, level)]
    if sizes:  # the machine now has all levels of all faces
        copied = [key for key in texture.images if key[1] == level]
        texture.stale = None
    for of_face, _ in copied:
        image = replace(texture.images[of_face, level], texels=None, patches=())
        texture.images[of_face, level] = image
        for above, size in enumerate(sizes, level + 1):
            texture.images[of_face, above] = replace(image, size=size)
    mark_changed(gl, texture)
    texture.keep_copies(gl)
    if derives and not by_machine:
        after_images_changed(gl, texture, level)


def _inside(gl, offset, box, transfer):
    """(offset, box): the part of a rectangle inside the framebuffer, and its place in the image.

    Pixels outside are undefined, so their texels do not change. Raises Refused if a convolution needs them.
    """
    x, y, width, height = box
    wide, high = framebuffer_size(gl)
    left, below = max(0, -x), max(0, -y)
    right, above = max(0, x + width - wide), max(0, y + height - high)
    if not (left or below or right or above):
        return offset, box
    if transfer.convolution_1d or transfer.convolution_2d or transfer.separable_2d:
        raise Refused("it convolves pixels outside the window, which are undefined")
    gl.tally.add("no effect", f"{gl.called}: pixels outside the window, which are undefined")
    cut = x + left, y + below, width - left - right, height - below - above
    return (offset[0] + left, offset[1] + below, offset[2]), cut
