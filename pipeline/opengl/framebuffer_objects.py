"""Framebuffer objects (EXT_framebuffer_object): pbuffers, whose colours become textures.

The machines here had pbuffers, and no framebuffer objects. Draws into an attached image go into a pbuffer of
its size (MakeCurrent), which first gets the image's texels. When another framebuffer is bound, the texture is
defined from the pbuffer: by BindTexImage, or by CopyTexSubImage if it has several levels or faces, or depths.
If a program reads a texture while it draws into it (undefined in OpenGL), it reads the earlier texels.

An image that the machine cannot store, such as 160 x 160 texels, is also a pbuffer; no draw can read it.
Every pbuffer has its own depths and stencil values, so two objects that share a renderbuffer do not share
them. OpenGL ignores draws while an object is incomplete; here they go into a pbuffer of one pixel.
"""

from dataclasses import dataclass, field, replace
from typing import NamedTuple

from fixedpipe.pipeline.commands import BindTexImage, CopyTexSubImage, DrawPixels, MakeCurrent
from fixedpipe.pipeline.enums import ColorFormat, TextureTarget
from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.color_buffers import choose_buffer
from fixedpipe.pipeline.opengl.context import Context, Drawable
from fixedpipe.pipeline.opengl.entry_points import entry, no_effect
from fixedpipe.pipeline.opengl.outcomes import GLError, Refused
from fixedpipe.pipeline.opengl.parameters import numbers_of
from fixedpipe.pipeline.opengl.texture_objects import TARGETS, TextureObject
from fixedpipe.pipeline.opengl.values import declare
from fixedpipe.pipeline.pixel_transfer import PixelImage
from fixedpipe.pipeline.state import PassState, RasterPosition
from fixedpipe.pipeline.textures.pixel_formats import READABLE_AS

# Source: the Khronos registry: EXT_framebuffer_blit, ARB_framebuffer_object.
_READ_FRAMEBUFFER, _DRAW_FRAMEBUFFER, _DEPTH_STENCIL_ATTACHMENT = 0x8CA8, 0x8CA9, 0x821A
_BINDINGS = {
    tokens.FRAMEBUFFER_EXT: ("draw_framebuffer", "read_framebuffer"),
    _DRAW_FRAMEBUFFER: ("draw_framebuffer",),
    _READ_FRAMEBUFFER: ("read_framebuffer",),
}
_COLOR, _DEPTH, _STENCIL = (
    tokens.COLOR_ATTACHMENT0_EXT,
    tokens.DEPTH_ATTACHMENT_EXT,
    tokens.STENCIL_ATTACHMENT_EXT,
)
_OF_DEPTHS = (_DEPTH, _STENCIL)
_FACES = {tokens.TEXTURE_CUBE_MAP_POSITIVE_X + face: face for face in range(6)}
_OPAQUE = ColorFormat.X8R8G8B8_O8R8G8B8  # its alpha is one, as in an image without alpha

declare("draw_framebuffer", 0)
declare("read_framebuffer", 0)
declare("renderbuffer", 0)
declare("pbuffer", None)  # (number of the object, Surface) that commands draw into


class Attachment(NamedTuple):
    """An attached image: a level and face of a texture object, or a renderbuffer (``texture`` None)."""

    name: int
    texture: TextureObject | None = None
    level: int = 0
    face: int = 0


class Surface(NamedTuple):
    """A pbuffer for an attached image. ``complete``: whether the framebuffer object is complete."""

    name: str
    width: int
    height: int
    color_format: ColorFormat = ColorFormat.A8R8G8B8
    complete: bool = True


@dataclass(eq=False)
class FramebufferObject:
    """A framebuffer object.

    - ``attachments``: {attachment point: Attachment}.
    - ``draw_buffer``, ``read_buffer``: the buffers that are drawn and read while the object is bound.
    """

    attachments: dict[int, Attachment] = field(default_factory=dict)
    draw_buffer: int = _COLOR
    read_buffer: int = _COLOR


class Renderbuffer(NamedTuple):
    """A renderbuffer: an image that does not belong to a texture."""

    width: int = 0
    height: int = 0
    internal_format: int = tokens.RGBA


def bind_window(gl: Context, drawable: Drawable) -> None:
    """Make framebuffer 0 a drawable of the window system."""
    if drawable is gl.window:
        return
    gl.window = gl.drawable = drawable
    gl.values.set("pbuffer", None)  # this drawable has another machine, and commands draw into its window
    _activate(gl)


# ---------------------------------------------------------------------------------------------- the pbuffer


def _activate(gl):
    """From now on draw into the bound framebuffer."""
    number = gl.values["draw_framebuffer"]
    surface = surface_of(gl, number) if number else None
    before = gl.values["pbuffer"]
    now = None if surface is None else (number, surface)
    if now == before:
        return
    if before is not None:
        _leave(gl, *before)
    gl.values.set("pbuffer", now)
    label = _label(gl)
    if surface is None:
        gl.drawable = gl.window
        gl.commands.append(made_current(label, None))
        return
    gl.drawable = Drawable(surface.width, surface.height, False, gl.window.stored)
    if before is None or before[1] != surface:
        gl.commands.append(made_current(label, surface))
    begin_with_texels(gl, number, surface, label)


def made_current(label: str, surface: Surface | None) -> MakeCurrent:
    """The command after which commands draw into a surface; None: into the window."""
    if surface is None:
        return MakeCurrent(label=label)
    size = {"width": surface.width, "height": surface.height}
    return MakeCurrent(label=label, surface=surface.name, color_format=surface.color_format, **size)


def _label(gl):
    return f"{gl.called} (call {gl.tally.call})"


def _object(gl, number):
    """The object of a name; one without images, if another context has deleted it."""
    return gl.shared.framebuffers.get(number) or FramebufferObject()


def surface_of(gl: Context, number: int) -> Surface:
    """The Surface of an object. If the object is incomplete, the Surface has one pixel."""
    found = _object(gl, number)
    if _status(gl, found) != tokens.FRAMEBUFFER_COMPLETE_EXT:
        return Surface(f"incomplete framebuffer object {number}", 1, 1, complete=False)
    attachment = found.attachments.get(_COLOR) or next(iter(found.attachments.values()))
    width, height = _size(gl, attachment)
    name = f"renderbuffer {attachment.name}"
    if attachment.texture is not None:
        face = f", face {attachment.face}" if attachment.face else ""
        level = f", level {attachment.level}" if attachment.level else ""
        name = f"{attachment.texture.name}{face}{level}"
    opaque = _internal_format(gl, attachment) in (3, tokens.RGB, tokens.RGB8)
    color_format = _OPAQUE if opaque else ColorFormat.A8R8G8B8
    return Surface(f"{name}, {width}x{height} {color_format.name}", width, height, color_format)


def begin_with_texels(gl: Context, number: int, surface: Surface, label: str) -> None:
    """Draw the texels of the image, as the program defined them, into the pbuffer, unless it has them."""
    attachment = _object(gl, number).attachments.get(_COLOR)
    if attachment is not None and attachment.texture is not None:
        attachment.texture.settle()
    image = None if attachment is None else _image(attachment)
    key = ("pbuffer", surface.name)
    if image is None or gl.drawable.stored.get(key) == attachment.texture.version:
        return
    gl.drawable.stored[key] = attachment.texture.version
    if image.texels is None or not image.texels.texels.any():
        return
    gl.commands.append(
        DrawPixels(
            label=label,
            image=PixelImage(image.texels.texels[0], "RGBA"),
            state=PassState(),
            position=RasterPosition(window=True),
        )
    )


def _leave(gl, number, surface):
    """Define the textures of an object after draws into its pbuffer."""
    if not surface.complete or (gl.commands and isinstance(gl.commands[-1], MakeCurrent)):
        return  # nothing was drawn into it
    attachments = _object(gl, number).attachments
    for point in (_COLOR, _DEPTH):
        attachment = attachments.get(point)
        if attachment is None or _image(attachment) is None:
            continue
        _define(gl, attachment, surface)
        if point == _COLOR:
            gl.drawable.stored["pbuffer", surface.name] = attachment.texture.version


def define_attached(gl: Context, texture: TextureObject) -> None:
    """Define a texture's image that the present framebuffer object draws into, if there is one."""
    if (pbuffer := gl.values["pbuffer"]) is not None:
        attachments = _object(gl, pbuffer[0]).attachments.values()
        if any(attachment.texture is texture for attachment in attachments):
            _leave(gl, *pbuffer)


def _define(gl, attachment, surface):
    """Define a texture from the pbuffer, which is still current."""
    texture, label = attachment.texture, _label(gl)
    position = attachment.face, attachment.level
    image = texture.images[position]
    target = TARGETS[texture.target]
    bindable = target in (TextureTarget.TEXTURE_2D, TextureTarget.TEXTURE_RECTANGLE)
    if bindable and len(texture.images) == 1 and image.chosen.format in READABLE_AS[surface.color_format]:
        gl.commands.append(
            BindTexImage(
                label=label,
                texture=texture.name,
                surface=surface.name,
                target=target,
                internal_format=image.chosen.format,
            )
        )
    else:
        texture.store(gl)
        layout = texture.layout()
        if layout is None:
            return
        gl.commands.append(
            CopyTexSubImage(
                label=label,
                texture=texture.name,
                width=surface.width,
                height=surface.height,
                level=attachment.level - layout.first,
                face=attachment.face,
            )
        )
    texture.images[position] = replace(image, texels=None, patches=())
    texture.changed(label)
    texture.keep_copies(gl)


# ---------------------------------------------------------------------------------------------- completeness


def _image(attachment):
    """The attached Image of a texture; None if the machine cannot store it, or if it is a renderbuffer."""
    if attachment.texture is None:
        return None
    return attachment.texture.images.get((attachment.face, attachment.level))


def _size(gl, attachment):
    """The width and height of an attached image; (0, 0) if there is none."""
    if attachment.texture is None:
        found = gl.shared.renderbuffers.get(attachment.name)
        return (0, 0) if found is None else (found.width, found.height)
    return attachment.texture.asked.get((attachment.face, attachment.level), (0, 0))[:2]


def _is_of_depths(gl, attachment):
    return _internal_format(gl, attachment) in _DEPTH_FORMATS


def _internal_format(gl, attachment):
    if attachment.texture is None:
        return gl.shared.renderbuffers.get(attachment.name, Renderbuffer()).internal_format
    return attachment.texture.asked[attachment.face, attachment.level][2]


# Source: the Khronos registry: depth, depth with stencil, and stencil formats.
_DEPTH_FORMATS = frozenset(
    {
        tokens.DEPTH_COMPONENT,
        tokens.DEPTH_COMPONENT16,
        tokens.DEPTH_COMPONENT24,
        tokens.DEPTH_COMPONENT32,
        0x84F9,
        0x88F0,
        0x1901,
        *range(0x8D46, 0x8D4A),
    }
)


def _status(gl, found):
    """The result of CheckFramebufferStatus for an object (section 4.4.4.2 of EXT_framebuffer_object)."""
    if not found.attachments:
        return tokens.FRAMEBUFFER_INCOMPLETE_MISSING_ATTACHMENT_EXT
    sizes = [_size(gl, attachment) for attachment in found.attachments.values()]
    if any(0 in size for size in sizes):
        return tokens.FRAMEBUFFER_INCOMPLETE_ATTACHMENT_EXT
    for point, attachment in found.attachments.items():
        if (point in _OF_DEPTHS) != _is_of_depths(gl, attachment):
            return tokens.FRAMEBUFFER_INCOMPLETE_ATTACHMENT_EXT
    if len(set(sizes)) > 1:
        return tokens.FRAMEBUFFER_INCOMPLETE_DIMENSIONS_EXT
    largest = gl.profile.framebuffers.max_viewport
    if max(sizes[0]) > largest or any(point not in (_COLOR, *_OF_DEPTHS) for point in found.attachments):
        return tokens.FRAMEBUFFER_UNSUPPORTED_EXT
    return tokens.FRAMEBUFFER_COMPLETE_EXT


# --------------------------------------------------------------------------------------------- entry points


def _binding(target):
    if target not in _BINDINGS:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(target)} is no target of framebuffers")
    return _BINDINGS[target]


def _bound(gl, target):
    """The object bound to a target. Raises GLError for framebuffer 0."""
    number = gl.values[_binding(target)[0]]
    if not number:
        raise GLError(tokens.INVALID_OPERATION, "no framebuffer object is bound")
    return gl.shared.framebuffers[number]


def _new_names(objects, number, names):
    """Unused names, or those of the recorded program. From now on they are in use."""
    if number < 0:
        raise GLError(tokens.INVALID_VALUE)
    if names is None:
        first = max(objects, default=0) + 1
        names = list(range(first, first + min(number, _MOST_NAMES)))
    for name in numbers_of(names)[:number]:
        objects.setdefault(int(name), None)
    return names


_MOST_NAMES = 1 << 16


@entry("GenFramebuffers", compiled=False)
def gen_framebuffers(gl, number, names=None):
    """Return unused names, or use the names of the recorded program."""
    return _new_names(gl.shared.framebuffers, number, names)


@entry("BindFramebuffer", compiled=False)
def bind_framebuffer(gl, target, name):
    """Bind an object, or with 0 the window. The first call with a name creates its object."""
    keys = _binding(target)
    if name and gl.shared.framebuffers.get(name) is None:
        gl.shared.framebuffers[name] = FramebufferObject()
    if "draw_framebuffer" in keys:
        _exchange_buffers(gl, int(name))
    for key in keys:
        gl.values.set(key, int(name))
    _activate(gl)


def _exchange_buffers(gl, name):
    """Exchange the draw and read buffers: each framebuffer has its own. Those of the window are stored while
    an object is bound.
    """
    before = gl.values["draw_framebuffer"]
    if before == name:
        return
    present = gl.values["draw_buffer"], gl.values["read_buffer"]
    if before:
        owner = _object(gl, before)
        owner.draw_buffer, owner.read_buffer = present
    else:
        gl.values.set("window_buffers", present)
    if name:
        owner = gl.shared.framebuffers[name]
        chosen = owner.draw_buffer, owner.read_buffer
    else:
        chosen = gl.values["window_buffers"]
    for key, buffer in zip(("draw_buffer", "read_buffer"), chosen, strict=True):
        choose_buffer(gl, key, buffer)


declare("window_buffers", (tokens.BACK, tokens.BACK))


@entry("DeleteFramebuffers", compiled=False)
def delete_framebuffers(gl, number, names):
    """Delete objects. If one of them is bound, the window is bound instead."""
    for name in numbers_of(names)[:number]:
        for target, keys in (
            (_DRAW_FRAMEBUFFER, "draw_framebuffer"),
            (_READ_FRAMEBUFFER, "read_framebuffer"),
        ):
            if name and gl.values[keys] == name:
                bind_framebuffer(gl, target, 0)
        if name:
            gl.shared.framebuffers.pop(name, None)


@entry("IsFramebuffer", compiled=False)
def is_framebuffer(gl, name):
    """Whether a name belongs to a framebuffer object."""
    return gl.shared.framebuffers.get(name) is not None


@entry("CheckFramebufferStatus", compiled=False)
def check_framebuffer_status(gl, target):
    """Whether the bound framebuffer is complete, as a token."""
    number = gl.values[_binding(target)[0]]
    _activate(gl)  # attached textures may have got images since
    if not number:
        return tokens.FRAMEBUFFER_COMPLETE_EXT
    return _status(gl, _object(gl, number))


def _attach(gl, target, point, attachment):
    found = _bound(gl, target)
    points = _OF_DEPTHS if point == _DEPTH_STENCIL_ATTACHMENT else (point,)
    for each in points:
        if not _COLOR <= each <= tokens.COLOR_ATTACHMENT15_EXT and each not in _OF_DEPTHS:
            raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(point)} is no attachment point")
    before = gl.values["pbuffer"]
    if before is not None and _object(gl, before[0]) is found:
        _leave(gl, *before)  # after this call its texture may not be attached any more
        gl.values.set("pbuffer", None)
    for each in points:
        if attachment is None:
            found.attachments.pop(each, None)
        else:
            found.attachments[each] = attachment
    _activate(gl)


@entry("FramebufferTexture1D", "FramebufferTexture2D", compiled=False)
def framebuffer_texture(gl, target, point, texture_target, name, level):
    """Attach a level of a texture, or a face and level of a cube map. The name 0 detaches."""
    if not name:
        _attach(gl, target, point, None)
        return
    texture = gl.shared.textures.get(name)
    if texture is None:
        raise GLError(tokens.INVALID_OPERATION, f"there is no texture {name}")
    face = _FACES.get(texture_target, 0)
    _attach(gl, target, point, Attachment(int(name), texture, int(level), face))


@entry("FramebufferTexture3D", "FramebufferTextureLayer", "FramebufferTexture", compiled=False)
def framebuffer_slice(gl, *arguments):
    """Refuse a slice of a volume: a pbuffer's colours cannot become a part of a 3D texture."""
    raise Refused("drawing into a layer of a texture; pbuffers become 2D textures alone")


@entry("FramebufferRenderbuffer", compiled=False)
def framebuffer_renderbuffer(gl, target, point, renderbuffer_target, name):
    """Attach a renderbuffer. The name 0 detaches."""
    _attach(gl, target, point, Attachment(int(name)) if name else None)


@entry("GetFramebufferAttachmentParameteriv", compiled=False)
def get_attachment_parameter(gl, target, point, name, answer=None):
    """A parameter of an attachment: its kind, name, level or face."""
    attachment = _bound(gl, target).attachments.get(point)
    if name == tokens.FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE_EXT:
        if attachment is None:
            return tokens.NONE
        return tokens.TEXTURE if attachment.texture is not None else tokens.RENDERBUFFER_EXT
    if attachment is None:
        raise GLError(tokens.INVALID_ENUM)
    if name == tokens.FRAMEBUFFER_ATTACHMENT_OBJECT_NAME_EXT:
        return attachment.name
    if name == tokens.FRAMEBUFFER_ATTACHMENT_TEXTURE_LEVEL_EXT:
        return attachment.level
    if name == tokens.FRAMEBUFFER_ATTACHMENT_TEXTURE_CUBE_MAP_FACE_EXT:
        is_cube = attachment.texture is not None and attachment.texture.target == tokens.TEXTURE_CUBE_MAP
        return tokens.TEXTURE_CUBE_MAP_POSITIVE_X + attachment.face if is_cube else 0
    raise Refused("how many bits a component has is the recorded driver's answer")


@entry("GenRenderbuffers", compiled=False)
def gen_renderbuffers(gl, number, names=None):
    """Return unused names, or use the names of the recorded program."""
    return _new_names(gl.shared.renderbuffers, number, names)


@entry("BindRenderbuffer", compiled=False)
def bind_renderbuffer(gl, target, name):
    """Bind a renderbuffer. The first call with its name creates it."""
    if target != tokens.RENDERBUFFER_EXT:
        raise GLError(tokens.INVALID_ENUM)
    if name and gl.shared.renderbuffers.get(name) is None:
        gl.shared.renderbuffers[name] = Renderbuffer()
    gl.values.set("renderbuffer", int(name))


def _store_renderbuffer(gl, target, internal_format, width, height):
    number = gl.values["renderbuffer"]
    if target != tokens.RENDERBUFFER_EXT:
        raise GLError(tokens.INVALID_ENUM)
    if not number:
        raise GLError(tokens.INVALID_OPERATION, "no renderbuffer is bound")
    largest = gl.profile.framebuffers.max_viewport
    if not (0 <= width <= largest and 0 <= height <= largest):
        raise GLError(tokens.INVALID_VALUE, f"renderbuffers have up to {largest} x {largest} pixels")
    gl.shared.renderbuffers[number] = Renderbuffer(int(width), int(height), internal_format)
    _activate(gl)


@entry("RenderbufferStorage", compiled=False)
def renderbuffer_storage(gl, target, internal_format, width, height):
    """Set the format and the size of the bound renderbuffer."""
    _store_renderbuffer(gl, target, internal_format, width, height)


@entry("RenderbufferStorageMultisample", compiled=False)
def renderbuffer_storage_multisample(gl, target, samples, internal_format, width, height):
    """As RenderbufferStorage. Several samples are refused, because a renderbuffer has one here."""
    if samples > 1:
        raise Refused("a renderbuffer of several samples; it has one here")
    _store_renderbuffer(gl, target, internal_format, width, height)


@entry("DeleteRenderbuffers", compiled=False)
def delete_renderbuffers(gl, number, names):
    """Delete renderbuffers, and detach them from the bound object."""
    for name in numbers_of(names)[:number]:
        if not name:
            continue
        bound = gl.shared.framebuffers.get(gl.values["draw_framebuffer"])
        if bound is not None:
            for point, attachment in list(bound.attachments.items()):
                if attachment.texture is None and attachment.name == name:
                    del bound.attachments[point]
        gl.shared.renderbuffers.pop(name, None)
        if gl.values["renderbuffer"] == name:
            gl.values.set("renderbuffer", 0)
    _activate(gl)


@entry("IsRenderbuffer", compiled=False)
def is_renderbuffer(gl, name):
    """Whether a name belongs to a renderbuffer."""
    return gl.shared.renderbuffers.get(name) is not None


no_effect("GetRenderbufferParameteriv", compiled=False)
