"""Run a frame's commands through the executable specification, with the pipeline's vertex stage before it."""

from dataclasses import dataclass, field
from types import SimpleNamespace

from pipeline import vertex
from pipeline.commands import (
    BindTexImage,
    Clear,
    CopyTexImage,
    CopyTexSubImage,
    Draw,
    MakeCurrent,
    ReadPixels,
    TexImage,
)
from pipeline.enums import WindowOrigin
from tests.reference import render, texel_formats, transfer


@dataclass
class ReferenceFrame:
    """What the commands gave: the window and the pbuffers as render.Targets, textures as nested lists, what
    ReadPixels read. ``current``: which of the targets commands draw to.
    """

    target: render.Target
    current: render.Target
    surfaces: dict = field(default_factory=dict)
    textures: dict = field(default_factory=dict)
    pixels: dict = field(default_factory=dict)


def run_reference(commands, profile, width, height, depth_bits):
    """Every command in order; returns a ReferenceFrame."""
    window = render.Target(width, height, depth_bits)
    frame = ReferenceFrame(window, window)
    for command in commands:
        _run(frame, command, profile)
    return frame


def _size(frame, command):
    """A rectangle's width and height; None takes what is left of the framebuffer."""
    width = frame.current.width - command.x if command.width is None else command.width
    height = frame.current.height - command.y if command.height is None else command.height
    return width, height


def _run(frame, command, profile):
    target, textures = frame.current, frame.textures
    match command:
        case Clear():
            transfer.clear(target, command)
        case TexImage():
            textures[command.texture] = render.plain_texture(command.image)
        case Draw():
            primitives = vertex.process(command.mesh, command.state, profile, target.width, target.height)
            render.draw(target, primitives, command.state, textures, profile)
        case CopyTexImage():
            size = _size(frame, command)
            texels = transfer.copy_texels(target, command.internal_format, command.x, command.y, *size)
            levels = [[texels]]
            while command.generate_mipmap and max(len(levels[-1][0]), len(levels[-1][0][0])) > 1:
                levels.append([texel_formats.next_level(levels[-1][0])])
            textures[command.texture] = SimpleNamespace(
                target=command.target, internal_format=command.internal_format, levels=levels
            )
        case CopyTexSubImage():
            texture = textures[command.texture]
            size = (command.width, command.height)
            texels = transfer.copy_texels(target, texture.internal_format, command.x, command.y, *size)
            rows = texture.levels[command.level][command.face]
            for j, row in enumerate(texels):
                rows[command.y_offset + j][command.x_offset : command.x_offset + command.width] = row
            if command.generate_mipmap:
                del texture.levels[1:]
                while max(len(texture.levels[-1][0]), len(texture.levels[-1][0][0])) > 1:
                    texture.levels.append([texel_formats.next_level(face) for face in texture.levels[-1]])
        case ReadPixels():
            size = _size(frame, command)
            frame.pixels[command.name] = transfer.read_pixels(
                target, command.format, command.x, command.y, *size
            )
        case MakeCurrent(surface=None):
            frame.current = frame.target
        case MakeCurrent():
            if command.surface not in frame.surfaces:
                frame.surfaces[command.surface] = render.Target(
                    command.width, command.height, command.depth_bits, color_format=command.color_format
                )
            frame.current = frame.surfaces[command.surface]
        case BindTexImage():
            rows = transfer.texels_of(frame.surfaces[command.surface], command.internal_format)
            textures[command.texture] = SimpleNamespace(
                target=command.target,
                internal_format=command.internal_format,
                levels=[[rows if command.origin == WindowOrigin.UPPER_LEFT else rows[::-1]]],
            )
