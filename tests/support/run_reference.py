"""Run a frame's commands through the executable specification, with the pipeline's vertex stage before it."""

from dataclasses import dataclass, field
from fractions import Fraction
from functools import partial
from types import SimpleNamespace

import numpy as np

from fixedpipe.pipeline.commands import (
    Accum,
    BindTexImage,
    Bitmap,
    Clear,
    CopyPixels,
    CopyTexImage,
    CopyTexSubImage,
    Draw,
    DrawPixels,
    GetTexImage,
    HostStep,
    MakeCurrent,
    ReadPixels,
    ResetHistogram,
    ResetMinmax,
    Saturate,
    TexImage,
    vertex_of,
)
from fixedpipe.pipeline.enums import ColorBuffer, PixelCopyType, TextureTarget, WindowOrigin
from fixedpipe.pipeline.vertices import stage
from tests.reference import (
    accumulation,
    depth,
    pixel_rectangles,
    pixel_transfer,
    render,
    texel_formats,
    transfer,
)


@dataclass
class ReferenceFrame:
    """What the commands gave: the window and the pbuffers as render.Targets, textures as nested lists, what
    ReadPixels read. ``types``: of what NumPy type a host takes it. ``current``: which of the targets commands
    draw to. ``auxiliary``: the window's auxiliary buffers as Targets with its depths and stencil values;
    ``accumulation``: its sums, None before the first. ``undefined``: how many groups of pixel textures had an
    undefined q; ``sample``: the place in every pixel that draws it, as ``render.draw`` has it.
    """

    target: render.Target
    current: render.Target
    surfaces: dict = field(default_factory=dict)
    textures: dict = field(default_factory=dict)
    pixels: dict = field(default_factory=dict)
    types: dict = field(default_factory=dict)
    auxiliary: dict = field(default_factory=dict)
    accumulation: list | None = None
    undefined: int = 0
    sample: tuple | None = None

    def buffer(self, which):
        """What a ColorBuffer stands for."""
        if which == ColorBuffer.BACK:
            return self.current
        if which not in self.auxiliary:
            window = self.target
            other = render.Target(window.width, window.height, window.depth_bits)
            other.depth, other.stencil = window.depth, window.stencil
            self.auxiliary[which] = other
        return self.auxiliary[which]

    def sums(self):
        """The accumulation buffer, made when it is asked for first."""
        if self.accumulation is None:
            self.accumulation = [
                [[0] * 4 for _ in range(self.target.width)] for _ in range(self.target.height)
            ]
        return self.accumulation


def run_reference(commands, profile, width, height, depth_bits, sample=None):
    """Every command in order; returns a ReferenceFrame. ``sample``: the place that draws pixels
    (``render.draw``).
    """
    window = render.Target(width, height, depth_bits)
    frame = ReferenceFrame(window, window, sample=sample)
    for command in commands:
        _run(frame, command, profile)
    return frame


def _size(frame, command):
    """A rectangle's width and height; None takes what is left of the framebuffer."""
    width = frame.current.width - command.x if command.width is None else command.width
    height = frame.current.height - command.y if command.height is None else command.height
    return width, height


def _run(frame, command, profile):
    OPERATIONS[type(command)](frame, command, profile)


# Every command's function takes the ReferenceFrame, the command and the profile.


def _clear(frame, command, profile):
    transfer.clear(frame.buffer(command.draw_buffer), command)
    if command.accumulation is not None:
        size, bits = (frame.current.width, frame.current.height), profile.framebuffers.accumulation_bits
        accumulation.clear(frame.sums(), command.accumulation, command.scissor, size, bits)


def _draw(frame, command, profile):
    size, written = (frame.current.width, frame.current.height), frame.buffer(command.state.draw_buffer)
    primitives = stage.process(command.mesh, command.state, profile, *size)
    render.draw(written, primitives, command.state, frame.textures, profile, frame.sample)


def _accum(frame, command, profile):
    read, written = frame.buffer(command.read_buffer), frame.buffer(command.draw_buffer)
    size, bits = (frame.current.width, frame.current.height), profile.framebuffers.accumulation_bits
    accumulation.accumulate(frame.sums(), read.color, written.color, command, size, 255, bits)


def _tex_image(frame, command, profile):
    if command.pixels is None:
        frame.textures[command.texture] = render.plain_texture(command.image)
    else:
        frame.textures[command.texture] = _texture_of_pixels(command, profile)


def _copy_tex_image(frame, command, profile):
    size, target = _size(frame, command), frame.buffer(command.read_buffer)
    state, place = (command.transfer, profile), (command.x, command.y, *size)
    texels = transfer.copy_texels(target, command, *state, *place)
    levels = [[texels]]
    while command.generate_mipmap and max(len(levels[-1][0]), len(levels[-1][0][0])) > 1:
        levels.append([texel_formats.next_level(levels[-1][0])])
    frame.textures[command.texture] = SimpleNamespace(
        target=command.target, internal_format=command.internal_format, levels=levels
    )


def _copy_tex_sub_image(frame, command, profile):
    texture = frame.textures[command.texture]
    size, target = (command.width, command.height), frame.buffer(command.read_buffer)
    state, place = (command.transfer, profile), (command.x, command.y, *size)
    texels = transfer.copy_texels(target, texture, *state, *place)
    rows = texture.levels[command.level][command.face]
    for j, row in enumerate(texels):
        rows[command.y_offset + j][command.x_offset : command.x_offset + command.width] = row
    if command.generate_mipmap:
        del texture.levels[1:]
        while max(len(texture.levels[-1][0]), len(texture.levels[-1][0][0])) > 1:
            texture.levels.append([texel_formats.next_level(face) for face in texture.levels[-1]])


def _read_pixels(frame, command, profile):
    size, target = _size(frame, command), frame.buffer(command.read_buffer)
    frame.pixels[command.name] = transfer.read_pixels(target, command, profile, *size)
    frame.types[command.name] = np.uint32 if command.format == "DEPTH_COMPONENT" else np.uint8


def _get_tex_image(frame, command, profile):
    read = transfer.get_tex_image(frame.textures[command.texture], command, profile)
    frame.pixels[command.name] = read
    frame.types[command.name] = np.uint32 if command.format == "DEPTH_COMPONENT" else np.uint8


def _host_step(frame, command, profile):
    for issued in command.commands({name: _as_read(frame, name) for name in command.reads}):
        _run(frame, issued, profile)


def _make_current(frame, command, profile):
    if command.surface is None:
        frame.current = frame.target
        return
    if command.surface not in frame.surfaces:
        made = frame.surfaces[command.surface] = render.Target(
            command.width, command.height, command.depth_bits, color_format=command.color_format
        )
        if command.shares_depth:  # the other's rows, the upper ones, of which it has no more than its width
            other = frame.target if command.depth_of is None else frame.surfaces[command.depth_of]
            made.depth, made.stencil = other.depth[: command.height], other.stencil[: command.height]
    frame.current = frame.surfaces[command.surface]


def _bind_tex_image(frame, command, profile):
    rows = transfer.texels_of(frame.surfaces[command.surface], command.internal_format)
    frame.textures[command.texture] = SimpleNamespace(
        target=command.target,
        internal_format=command.internal_format,
        levels=[[rows if command.origin == WindowOrigin.UPPER_LEFT else rows[::-1]]],
    )


def _nothing(frame, command, profile):
    """Bytes are clamped already, and histograms and minmaxes are not kept here."""


def _as_read(frame, name):
    """What a ReadPixels of bytes, or of depths, gives to a host: an array."""
    return np.array(frame.pixels[name], frame.types[name])


def _texture_of_pixels(command, profile):
    """A TexImage1D or TexImage2D of one level, from colours or depths that go through pixel transfer."""
    state = command.transfer
    if transfer.is_depth_format(command.internal_format):
        depths = [[float(depth) for (depth,) in row] for row in _elements(command.pixels)]
        texels = transfer.depth_texels(depths, state, command.internal_format)
        return SimpleNamespace(
            target=command.target, internal_format=command.internal_format, levels=[[texels]]
        )
    image = [
        [pixel_transfer.pixel_of(elements, command.pixels.format) for elements in row]
        for row in _elements(command.pixels)
    ]
    dimensions = 1 if command.target == TextureTarget.TEXTURE_1D else 2
    image = pixel_transfer.transfer(
        image, state, dimensions, profile.arithmetic.clamps_color_matrix, None, None
    )
    store, internal_format = texel_formats.store_texel, command.internal_format
    texels = [[store(group, internal_format, floats=True) for group in row] for row in image]
    return SimpleNamespace(target=command.target, internal_format=internal_format, levels=[[texels]])


def _rectangle(frame, command, profile):
    """A DrawPixels, CopyPixels or Bitmap."""
    current, state, position = frame.current, command.state, command.position
    written, size = frame.buffer(state.draw_buffer), (current.width, current.height)
    if position.window:
        raster = pixel_rectangles.given_position(position, state, profile)
    else:
        mesh = vertex_of(position)
        raster = pixel_rectangles.raster_position(mesh, position, state, profile, *size)
    if raster is None:
        return
    kind = getattr(command, "type", None)
    if isinstance(command, DrawPixels):
        kinds = {"DEPTH_COMPONENT": PixelCopyType.DEPTH, "STENCIL_INDEX": PixelCopyType.STENCIL}
        kind = kinds.get(command.image.format, PixelCopyType.COLOR)
    if isinstance(command, Bitmap):
        bits = render.plain(command.bits)
        pixel_rectangles.draw_bitmap(written, bits, raster, command, frame.textures, profile)
        return
    groups = _groups(frame, command, kind, profile)
    if kind == PixelCopyType.STENCIL:
        pixel_rectangles.draw_stencil(written, groups, raster, command)
    elif kind == PixelCopyType.DEPTH:
        pixel_rectangles.draw_depths(written, groups, raster, command, frame.textures, profile)
    else:
        textures = frame.textures
        drawn = pixel_rectangles.draw_colors(written, groups, raster, command, textures, profile)
        frame.undefined += drawn


def _groups(frame, command, kind, profile):
    """Groups after pixel transfer and final conversion; histograms and minmaxes are not kept here."""
    state, depth_bits = command.transfer, frame.current.depth_bits
    image = None if isinstance(command, CopyPixels) else command.image
    if image is None:
        box = (command.x, command.y, *_size(frame, command))
        source = frame.buffer(command.read_buffer)
        plane = {
            PixelCopyType.COLOR: source.color,
            PixelCopyType.DEPTH: source.depth,
            PixelCopyType.STENCIL: source.stencil,
        }[kind]
        values = transfer.rectangle(plane, *box)
        if kind == PixelCopyType.DEPTH:
            most = depth.full_scale(depth_bits)
            values = [[[value / most] for value in row] for row in values]
        elif kind == PixelCopyType.COLOR:
            values = [[[Fraction(value, 255) for value in group] for group in row] for row in values]
    else:
        values = image.values.tolist() if kind == PixelCopyType.STENCIL else _elements(image)
    if kind == PixelCopyType.STENCIL:
        return [[pixel_transfer.stencil_index(value, state) for value in row] for row in values]
    if kind == PixelCopyType.DEPTH:
        depths = [[pixel_transfer.transfer_depth(float(value), state) for (value,) in row] for row in values]
        return [[depth.depth_to_units(value, depth_bits) for value in row] for row in depths]
    read_format = "RGBA" if image is None else image.format
    groups = [[pixel_transfer.pixel_of(elements, read_format) for elements in row] for row in values]
    groups = pixel_transfer.transfer(groups, state, 2, profile.arithmetic.clamps_color_matrix, None, None)
    return [[[pixel_transfer.to_fixed(c, 8) for c in group] for group in row] for row in groups]


def _elements(image):
    """The elements of every group of an image: floats, or Fractions of integer and packed types."""
    kind = image.values.dtype
    if image.packed is not None:
        convert = partial(pixel_transfer.unpacked, packed=image.packed)
        return [[convert(word) for word in row] for row in image.values.tolist()]
    if kind.kind == "f":
        convert = float
    else:
        convert = partial(pixel_transfer.component, bits=8 * kind.itemsize, signed=kind.kind == "i")
    return [[[convert(v) for v in _listed(group)] for group in row] for row in image.values.tolist()]


def _listed(group):
    return group if isinstance(group, list) else [group]


OPERATIONS = {
    Clear: _clear,
    Draw: _draw,
    TexImage: _tex_image,
    CopyTexImage: _copy_tex_image,
    CopyTexSubImage: _copy_tex_sub_image,
    ReadPixels: _read_pixels,
    GetTexImage: _get_tex_image,
    HostStep: _host_step,
    Saturate: _nothing,
    Accum: _accum,
    DrawPixels: _rectangle,
    CopyPixels: _rectangle,
    Bitmap: _rectangle,
    MakeCurrent: _make_current,
    BindTexImage: _bind_tex_image,
    ResetHistogram: _nothing,
    ResetMinmax: _nothing,
}
