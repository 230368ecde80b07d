"""The content of a frame of a trace: its commands, and the machine's textures and framebuffers at its start.

``frame_commands`` makes an independent frame of it, which a new machine draws with the same bits.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

import numpy as np

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
    MakeCurrent,
    ReadPixels,
    TexImage,
    kind_of,
)
from fixedpipe.pipeline.enums import ComparisonFunction, PixelCopyType
from fixedpipe.pipeline.framebuffers.framebuffer import Framebuffer
from fixedpipe.pipeline.pixel_transfer import PixelImage
from fixedpipe.pipeline.state import ColorMask, DepthTest, PassState, RasterPosition
from fixedpipe.pipeline.textures.images import Texture

_NONE = ColorMask(False, False, False, False)
_ALL = ColorMask()
_DEFINING = (TexImage, CopyTexImage, BindTexImage)


@dataclass(eq=False)
class Recording:
    """A frame, recorded while it is drawn.

    - ``textures``: the machine's textures at the start of the frame, by name.
    - ``framebuffers``: copies of the window's buffers and of the pbuffers at the start, by name.
    - ``commands``: (buffer of the window that the command draws into, or None; command), in order.
    """

    textures: dict[str, Texture]
    framebuffers: dict[str, Framebuffer]
    commands: list[tuple[str | None, Command]] = field(default_factory=list)

    def add(self, buffer: str | None, commands: Iterable[Command]) -> None:
        """Add commands that draw into a buffer."""
        self.commands += [(buffer, command) for command in commands]


def frame_commands(recording: Recording, shown: str) -> tuple[Command, ...]:
    """The commands of a frame that leave in the window the contents of ``shown``, a buffer or a pbuffer.

    They first restore the machine's earlier contents that the frame reads: textures, colours, depths and
    stencil values. If a pbuffer is shown, it replaces the window.
    """
    commands = _of_buffer(recording.commands, shown)
    pbuffers = {c.surface for c in commands if isinstance(c, MakeCurrent) and c.surface is not None}
    if shown in pbuffers:
        commands = list(_as_window(commands, shown))
    held = []
    for name, framebuffer in recording.framebuffers.items():
        surface = None if name == shown else name
        if surface is None or surface in pbuffers:
            held += _contents(framebuffer, surface, list(_drawn_into(commands, surface)), commands)
    return (*_textures(recording.textures, commands), *held, *commands)


def _of_buffer(recorded, shown):
    """The commands without those that draw into other buffers of the window than the shown one."""
    kept, surface, surfaces = [], None, {c.surface for _, c in recorded if isinstance(c, MakeCurrent)}
    for buffer, command in recorded:
        if isinstance(command, MakeCurrent):
            surface = command.surface
        elif surface is None and buffer not in (None, shown) and shown not in surfaces:
            continue
        kept.append(command)
    return kept


def _as_window(commands, shown) -> Iterator[Command]:
    """The commands in which the pbuffer ``shown`` is the window, without the commands for the old window."""
    surface = None
    for command in commands:
        kind = type(command)
        if kind is MakeCurrent:
            surface = command.surface
            if surface == shown:
                yield MakeCurrent(label=command.label)
            elif surface is not None:
                yield command
        elif kind is BindTexImage and command.surface == shown:
            copied = ("label", "texture", "target", "internal_format")
            yield CopyTexImage(**{name: getattr(command, name) for name in copied})
        elif surface is not None or kind in (*_DEFINING, CopyTexSubImage):
            yield command


def _drawn_into(commands, wanted):
    """The commands that draw into the pbuffer ``wanted``; None: into the window."""
    surface = None
    for command in commands:
        if isinstance(command, MakeCurrent):
            surface = command.surface
        elif surface == wanted:
            yield command


# ------------------------------------------------------------------------------------------- textures


def _textures(held, commands) -> Iterator[Command]:
    """TexImages of the textures that the commands use before they define them."""
    defined: set[str] = set()
    for command in commands:
        for name in _used_by(command):
            if name not in defined and name in held:
                yield TexImage(label=f"as the frame before left {name}", texture=name, image=held[name])
            defined.add(name)
        if isinstance(command, _DEFINING):
            defined.add(command.texture)


def _used_by(command):
    if isinstance(command, CopyTexSubImage | GetTexImage):
        yield command.texture
    state = getattr(command, "state", None)
    for unit in () if state is None else state.texture_units:
        if unit is not None and unit.texture is not None:
            yield unit.texture


# ----------------------------------------------------------------------------------------- framebuffers


def _contents(framebuffer, surface, drawn, commands) -> Iterator[Command]:
    """Commands that restore the contents of a framebuffer, except those that the frame clears first."""
    needed = _read_before_cleared(drawn)
    parts = [part for part in _parts(framebuffer) if part[0] in needed]
    if not parts:
        return
    if surface is not None:
        yield next(c for c in commands if isinstance(c, MakeCurrent) and c.surface == surface)
    where = "" if surface is None else f" of {surface}"
    for what, image, state in parts:
        label = f"the {what}s{where} as the frame before left them"
        if what == "color" and (framebuffer.color == framebuffer.color[0, 0]).all():
            one = float(2**framebuffer.color_bits - 1)
            yield Clear(label=label, color=tuple([c / one for c in framebuffer.color[0, 0].tolist()]))
        else:
            yield DrawPixels(label=label, image=image, state=state, position=RasterPosition(window=True))
    if surface is not None:
        yield MakeCurrent(label="the window")


def _parts(framebuffer):
    """(kind of values, their image, the state that draws it), for values that an empty framebuffer lacks."""
    depth, stencil, color = framebuffer.depth, framebuffer.stencil, framebuffer.color
    farthest = np.uint64(2**framebuffer.depth_bits - 1)
    if not framebuffer.depth_format.is_float and (depth != farthest).any():
        # The depths as fractions of 32 bits. The machine converts them to the same depths.
        scaled = (depth.astype(np.uint64) * np.uint64(2**32 - 1) + farthest // 2) // farthest
        image = PixelImage(scaled.astype(np.uint32)[::-1], "DEPTH_COMPONENT")
        state = PassState(color_mask=_NONE, depth_test=DepthTest(ComparisonFunction.ALWAYS, True))
        yield "depth", image, state
    if stencil.any():
        yield "stencil value", PixelImage(stencil[::-1], "STENCIL_INDEX"), PassState()
    if color.any():
        one = 2**framebuffer.color_bits - 1
        values = color if framebuffer.is_bytes else color / one
        yield "color", PixelImage(values[::-1], "RGBA"), PassState()


def _read_before_cleared(commands):
    """Which of color, depth and stencil value the commands may read, or leave, before they clear them."""
    open_, needed = {"color", "depth", "stencil value"}, set()
    for command in commands:
        if type(command) is Clear:
            open_ -= cleared_by(command)
        else:
            needed |= touched_by(command) & open_
    return needed | (open_ & {"color"})  # colours that no command clears are seen in the end


def cleared_by(command: Clear) -> set[str]:
    """Which of color, depth and stencil value a Clear clears everywhere."""
    if command.scissor is not None:
        return set()
    found = {"color"} if command.color is not None and command.color_mask == _ALL else set()
    if command.depth is not None:
        found.add("depth")
    if command.stencil is not None and command.stencil_write_mask == 0xFF:
        found.add("stencil value")
    return found


def touched_by(command: Command) -> set[str]:
    """Which of color, depth and stencil value a command reads or writes."""
    return _TOUCHED.get(type(command), _nothing)(command)


def _by_fragments(command):
    found, state = {"color"}, command.state
    kind = kind_of(command) if type(command) in (DrawPixels, CopyPixels) else PixelCopyType.COLOR
    if state.depth_test is not None or kind is PixelCopyType.DEPTH:
        found.add("depth")
    if state.stencil_test is not None or kind is PixelCopyType.STENCIL:
        found.add("stencil value")
    return found


def _by_clear(command):
    """What a Clear writes anywhere, also where a scissor box or a mask leaves out the rest."""
    written = {"color": command.color, "depth": command.depth, "stencil value": command.stencil}
    return {kind for kind, value in written.items() if value is not None}


def _colors(command):
    return {"color"}


def _nothing(command):
    return set()


_TOUCHED = {
    Clear: _by_clear,
    **dict.fromkeys((Draw, DrawPixels, CopyPixels, Bitmap), _by_fragments),
    **dict.fromkeys((Accum, CopyTexImage, CopyTexSubImage, ReadPixels), _colors),
}
