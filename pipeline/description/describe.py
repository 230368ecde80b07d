"""A pass sequence in words: each command, its differences from the initial state, combiners as equations.

The words are OpenGL's: tokens where OpenGL has one (TEXTURE_MIN_FILTER LINEAR), and the registers' names in
the ``!!RC1.0`` notation. ``equations`` explains the equations.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace

from fixedpipe.pipeline.commands import (
    Accum,
    BindTexImage,
    Bitmap,
    Clear,
    Command,
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
)
from fixedpipe.pipeline.description.equations import combiner_lines
from fixedpipe.pipeline.description.states import differences, mask_words, numbered_lines, titled
from fixedpipe.pipeline.description.words import format_number, format_value
from fixedpipe.pipeline.enums import AccumOperation, ColorBuffer, DepthFormat, TextureTarget, WindowOrigin
from fixedpipe.pipeline.messages import count
from fixedpipe.pipeline.multi_draw import MultiDraw, with_draws
from fixedpipe.pipeline.pixel_transfer import INITIAL_TRANSFER
from fixedpipe.pipeline.state import (
    ColorMask,
    PixelTexture,
    RasterPosition,
    RegisterCombiners,
    TextureShaderStage,
)


def _clear(command):
    cleared = [
        f"{what} to {format_value(getattr(command, what))}"
        for what in ("color", "depth", "stencil", "accumulation")
        if getattr(command, what) is not None
    ]
    lines = ["clears " + (", ".join(cleared) or "nothing") + _of_buffer(" of", command.draw_buffer)]
    if command.scissor is not None:
        lines += titled("SCISSOR_TEST enabled", differences(command.scissor))
    if command.color_mask != ColorMask():
        lines.append(f"color mask {mask_words(command.color_mask)}")
    if command.stencil_write_mask != 0xFF:
        lines.append(f"stencil write mask {command.stencil_write_mask}")
    return lines


def _of_buffer(preposition, buffer):
    return "" if buffer is ColorBuffer.BACK else f"{preposition} {buffer.name}"


def _mesh(mesh):
    text = f"{mesh.primitive.name}, {count(len(mesh.positions), 'vertex', 'vertices')}"
    if mesh.indices is not None:
        text += f", {count(len(mesh.indices), 'index', 'indices')}"
    if mesh.counts is not None:
        text += f" in {count(len(mesh.counts), 'run')}"
    arrays = [
        name.replace("_", " ")
        for name in (
            "colors",
            "secondary_colors",
            "back_colors",
            "back_secondary_colors",
            "normals",
            "fog_coordinates",
            "weights",
        )
        if getattr(mesh, name) is not None
    ]
    if mesh.texture_coordinates:
        arrays.append(count(len(mesh.texture_coordinates), "texture coordinate set"))
    return f"draws {text}" + (f"; with {', '.join(arrays)}" if arrays else "")


def _draw(command):
    first, *rest = differences(command.state)
    return [_mesh(command.mesh), *([first] if first else []), *rest]


def _pixel_transfer(transfer):
    """Lines for a pixel transfer other than the initial one."""
    if transfer == INITIAL_TRANSFER:
        return []
    return titled("pixel transfer", differences(transfer))


def _tex_image(command):
    image = command.image
    if image is None:
        *layers, height, width = command.pixels.values.shape[: 3 if command.target in _LAYERED else 2]
        size = "x".join(map(str, (width, height, *layers)))
        kind = command.pixels.packed or command.pixels.values.dtype
        source = f"from {size} pixels, {command.pixels.format} {kind}"
        stored = f"{command.target.name}, {command.internal_format.name}"
        first = f'texture "{command.texture}": {stored}, {source}{_generated(command)}'
        return [first, *_pixel_transfer(command.transfer)]
    levels = count(len(image.levels), "level")
    size = f"{image.width}x{image.height}"
    if image.border:
        size += f" with a border of {count(image.border, 'texel')}"
    return [
        f'texture "{command.texture}": {image.target.name}, {image.internal_format.name}, {size}, {levels}'
    ]


def _rectangle(command):
    buffer = _of_buffer(" of", command.read_buffer)
    return _place(command) + buffer


def _place(command):
    if (command.x, command.y, command.width, command.height) == (0, 0, None, None):
        return "the whole framebuffer"
    width = "all columns" if command.width is None else count(command.width, "column")
    height = "all rows" if command.height is None else count(command.height, "row")
    return f"the framebuffer from ({command.x}, {command.y}), {width} and {height}"


def _copy_tex_image(command):
    stored = f"{command.target.name}, {command.internal_format.name}"
    first = f'texture "{command.texture}": {stored}, from {_rectangle(command)}{_generated(command)}'
    return [first, *_pixel_transfer(command.transfer)]


def _generated(command):
    return ", mipmaps generated" if command.generate_mipmap else ""


def _copy_tex_sub_image(command):
    place = f"({command.x_offset}, {command.y_offset})"
    if command.level:
        place += f" of level {command.level}"
    if command.face:
        place += f" of face {command.face}"
    first = f'texture "{command.texture}" at {place}: from {_rectangle(command)}{_generated(command)}'
    return [first, *_pixel_transfer(command.transfer)]


def _read_pixels(command):
    as_type = "" if command.type == "UNSIGNED_BYTE" else f" as {command.type}"
    first = f'"{command.name}": {command.format}{as_type} of {_rectangle(command)}'
    return [first, *_pixel_transfer(command.transfer)]


def _get_tex_image(command):
    as_type = "" if command.type == "UNSIGNED_BYTE" else f" as {command.type}"
    place = f"level {command.level}" + (f", face {command.face}" if command.face else "")
    first = f'"{command.name}": {command.format}{as_type} of texture "{command.texture}", {place}'
    return [first, *_pixel_transfer(command.transfer)]


def _host_step(command):
    names = " and ".join(f'"{name}"' for name in command.reads) or "nothing"
    return [f"the host reads {names}; the commands that it issues depend on that"]


def _saturate(command):
    return ["colours are in [0, 1] from here on"]


def _reset_histogram(command):
    return [f'histogram "{command.name}" becomes empty']


def _reset_minmax(command):
    return [f'minmax "{command.name}" forgets what it saw']


def _raster_position(position):
    coordinates = f"raster position {format_value(position.position)}"
    given = differences(replace(position, position=RasterPosition().position, window=False))[0]
    return coordinates + (" in the window" if position.window else "") + (f", {given}" if given else "")


def _fragments(command, first):
    """Lines of a command that draws pixel groups; ``first`` describes the groups."""
    zoom = getattr(command, "zoom", (1.0, 1.0))
    lines = [first + ("" if zoom == (1.0, 1.0) else f", PixelZoom {format_value(zoom)}")]
    lines.append(_raster_position(command.position))
    texture = getattr(command, "pixel_texture", None)
    if texture is not None:
        name = "PIXEL_TEXTURE" if texture.mode is None else f"PIXEL_TEX_GEN {texture.mode.name}"
        plain = PixelTexture() if texture.mode is None else replace(PixelTexture(), mode=texture.mode)
        given = differences(replace(texture, mode=plain.mode), plain)[0]
        lines.append(f"{name} enabled" + (f": {given}" if given else ""))
    lines += _pixel_transfer(getattr(command, "transfer", INITIAL_TRANSFER))
    first, *rest = differences(command.state)
    return [*lines, *([first] if first else []), *rest]


def _draw_pixels(command):
    height, width = command.image.values.shape[:2]
    packed = f" {command.image.packed}" if command.image.packed else ""
    return _fragments(command, f"{command.image.format}{packed} image, {width}x{height} groups")


def _copy_pixels(command):
    return _fragments(command, f"{command.type.name} of {_rectangle(command)}")


def _bitmap(command):
    height, width = command.bits.shape
    origin = "" if command.origin == (0.0, 0.0) else f", origin {format_value(command.origin)}"
    return _fragments(command, f"bitmap, {width}x{height}{origin}")


def _accum(command):
    value = format_number(command.value)
    read, written = (
        "the framebuffer" if buffer is ColorBuffer.BACK else buffer.name
        for buffer in (command.read_buffer, command.draw_buffer)
    )
    line = {
        AccumOperation.LOAD: f"the accumulation buffer becomes {value} times {read}",
        AccumOperation.ACCUM: f"{value} times {read} is added to the accumulation buffer",
        AccumOperation.ADD: f"{value} is added to the accumulation buffer",
        AccumOperation.MULT: f"the accumulation buffer is multiplied by {value}",
        AccumOperation.RETURN: f"{written} becomes {value} times the accumulation buffer",
    }[command.operation]
    lines = [line]
    if command.scissor is not None:
        lines += titled("SCISSOR_TEST enabled", differences(command.scissor))
    if command.color_mask != ColorMask():
        lines.append(f"color mask {mask_words(command.color_mask)}")
    return lines


def _make_current(command):
    if command.surface is None:
        return ["the window"]
    size, formats = f"{command.width}x{command.height}", f"{command.color_format.name}, depth"
    depth_format = DepthFormat(command.depth_bits)
    depth = depth_format.name if depth_format.is_float else f"{command.depth_bits} bits"
    samples = "" if command.samples == 1 else f", {count(command.samples, 'sample')} a pixel"
    of = "the window" if command.depth_of is None else f'pbuffer "{command.depth_of}"'
    shared = f", shared with {of}" if command.shares_depth else ""
    return [f'pbuffer "{command.surface}": {size}, {formats} {depth}{shared}{samples}']


def _bind_tex_image(command):
    stored = f"{command.target.name}, {command.internal_format.name}"
    first = "top" if command.origin is WindowOrigin.UPPER_LEFT else "bottom"
    return [f'texture "{command.texture}": {stored}, from pbuffer "{command.surface}", {first} row first']


DESCRIPTIONS = {
    Clear: _clear,
    Draw: _draw,
    DrawPixels: _draw_pixels,
    CopyPixels: _copy_pixels,
    Bitmap: _bitmap,
    TexImage: _tex_image,
    CopyTexImage: _copy_tex_image,
    CopyTexSubImage: _copy_tex_sub_image,
    GetTexImage: _get_tex_image,
    ReadPixels: _read_pixels,
    HostStep: _host_step,
    Saturate: _saturate,
    Accum: _accum,
    MakeCurrent: _make_current,
    BindTexImage: _bind_tex_image,
    ResetHistogram: _reset_histogram,
    ResetMinmax: _reset_minmax,
}
# The limits of ``folded``. Assumed: a polygon takes no more commands; fewer repetitions are printed in full.
_LONGEST_PERIOD, _FEWEST_TIMES = 8, 6
_LAYERED = (TextureTarget.TEXTURE_CUBE_MAP, TextureTarget.TEXTURE_3D)


def describe_program(
    texture_shader: tuple[TextureShaderStage, ...] | None, combiners: RegisterCombiners | None
) -> str:
    """Texture shader stages and register combiners as equations, a line each; either may be None."""
    lines = []
    if texture_shader is not None:
        lines.append("TEXTURE_SHADER enabled")
        lines += [f"  {line}" for line in numbered_lines("stage", texture_shader)]
    if combiners is not None:
        lines += combiner_lines(combiners)
    return "".join(f"{line}\n" for line in lines)


def describe(commands: Iterable[Command | MultiDraw], *, folded: bool = False) -> str:
    """The commands as text: a numbered block for each, its label, and differences from the initial state.

    Commands are numbered from 0, as in the messages of ``UnsupportedState``. With ``folded``, a few commands
    that repeat, such as those for each polygon, are described once, with the number of repetitions.
    """
    blocks, commands, number = [], with_draws(commands), 0
    names = [(type(c), re.sub(r"\d+", "", c.label)) for c in commands] if folded else []
    while number < len(commands):
        period, times = _repeated(names, number)
        for command in commands[number : number + period]:
            lines = DESCRIPTIONS[type(command)](command)
            title = f'{number}. {type(command).__name__} "{command.label}"'
            blocks.append("\n".join([title, *(f"   {line}" for line in lines)]) + "\n")
            number += 1
        if times > 1:
            last = number + period * (times - 1) - 1
            what = "the command above" if period == 1 else f"the {period} commands above"
            blocks.append(
                f"{number} to {last}. {what} again, {times - 1} times, with other numbers in them\n"
            )
            number = last + 1
    return "\n".join(blocks)


def _repeated(names, first):
    """(number of commands from ``first`` on that repeat directly, number of times that they occur).

    (1, 1) stands for too few repetitions.
    """
    for period in range(1, _LONGEST_PERIOD + 1):
        once, times = names[first : first + period], 1
        following = first + period
        while once and names[following : following + period] == once:
            times, following = times + 1, following + period
        if times >= _FEWEST_TIMES:
            return period, times
    return 1, 1
