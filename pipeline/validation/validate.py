"""What a machine refuses, and why: every command is checked before any is executed.

``validate`` walks the commands in order and knows which textures exist at each. It raises
``UnsupportedState`` at the first command that the profile cannot execute or that has no meaning on any
machine. Each message names the command, what was given, what the machine allows, and what to do.

Source: the errors of OpenGL 1.2.1, NV_register_combiners and 2, EXT_texture_cube_map, NV_texgen_reflection,
EXT_texture_lod_bias, EXT_stencil_wrap, EXT_fog_coord, NV_texture_shader, EXT_point_parameters,
NV_point_sprite, ARB_texture_env_combine and _dot3, NV_texture_env_combine4.

Where OpenGL clamps silently (clear colours, constant colours, alpha and stencil references), the later stages
clamp, and validation refuses nothing. Where OpenGL calls the result undefined (pixels read outside the
framebuffer, an incomplete texture), validation refuses.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

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
    Mesh,
    ReadPixels,
    ResetHistogram,
    ResetMinmax,
    Saturate,
    TexImage,
)
from fixedpipe.pipeline.messages import count, shown
from fixedpipe.pipeline.multi_draw import MultiDraw
from fixedpipe.pipeline.pixel_transfer import PixelMaps, PixelTransfer
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.state import (
    ColorTable,
    FinalCombiner,
    GeneralCombiner,
    PassState,
    RegisterCombiners,
    TextureShaderStage,
    TextureUnit,
    VertexState,
)
from fixedpipe.pipeline.textures.images import Texture
from fixedpipe.pipeline.validation import texture_units
from fixedpipe.pipeline.validation.buffers import accum, clear, read_pixels, saturate
from fixedpipe.pipeline.validation.draws import draw, is_like_another, representatives
from fixedpipe.pipeline.validation.fragments import register_combiners
from fixedpipe.pipeline.validation.frames import commands_of, host_step, issued_by
from fixedpipe.pipeline.validation.rectangles import bitmap, copy_pixels, draw_pixels
from fixedpipe.pipeline.validation.surfaces import (
    check_color_bits,
    check_framebuffer,
    check_samples,
    make_current,
)
from fixedpipe.pipeline.validation.textures import (
    bind_tex_image,
    copy_tex_image,
    copy_tex_sub_image,
    get_tex_image,
    store,
    tex_image,
)
from fixedpipe.pipeline.validation.transfer import reset_histogram, reset_minmax
from fixedpipe.pipeline.validation.types import TypeChecks
from fixedpipe.pipeline.validation.walk import Known, UnsupportedState, Walk

if TYPE_CHECKING:  # For annotations alone: validation calls no framebuffer.
    from fixedpipe.pipeline.framebuffers.framebuffer import Framebuffer
    from fixedpipe.pipeline.framebuffers.transfer import PixelStatistics

# Many states share these parts, because dataclasses.replace keeps them. Each is checked once.
_CHECKS = TypeChecks(
    whole=(Mesh, Texture),
    shared=(
        VertexState,
        TextureUnit,
        RegisterCombiners,
        GeneralCombiner,
        FinalCombiner,
        PixelTransfer,
        PixelMaps,
        ColorTable,
    ),
)

# The function that validates each class of command; it takes the Walk and the command.
VALIDATIONS = {
    Clear: clear,
    Draw: draw,
    TexImage: tex_image,
    CopyTexImage: copy_tex_image,
    CopyTexSubImage: copy_tex_sub_image,
    GetTexImage: get_tex_image,
    ReadPixels: read_pixels,
    HostStep: host_step,
    Saturate: saturate,
    Accum: accum,
    DrawPixels: draw_pixels,
    CopyPixels: copy_pixels,
    Bitmap: bitmap,
    MakeCurrent: make_current,
    BindTexImage: bind_tex_image,
    ResetHistogram: reset_histogram,
    ResetMinmax: reset_minmax,
}


def validate(
    commands: Iterable[Command | MultiDraw],
    profile: Profile,
    width: int,
    height: int,
    depth_bits: int | None = None,
    textures: Mapping[str, Texture] | None = None,
    surfaces: Mapping[str, Framebuffer] | None = None,
    statistics: PixelStatistics | None = None,
    *,
    samples: int = 1,
    color_bits: int | None = None,
    read: Iterable[str] = (),
) -> None:
    """Refuse commands that the machine cannot execute. Returns None if it can execute all of them.

    - ``commands``: iterable of commands, in order.
    - ``profile``: the machine.
    - ``width``, ``height``: the framebuffer's size in pixels.
    - ``depth_bits``: bits of the depth buffer; None: the machine's widest fixed format.
    - ``textures``: {name: Texture} that the machine already has, or None.
    - ``surfaces``: {name: Framebuffer}, the machine's pbuffers, or None.
    - ``statistics``: the machine's PixelStatistics, or None.
    - ``samples``: how many samples each pixel of the framebuffer has.
    - ``color_bits``: bits of its colours' components; None: the usual width.
    - ``read``: names that ReadPixels of the same frame has already read.

    Raises UnsupportedState (a ValueError). Its message names the command, what was given, what the machine
    allows, and what to do. Each mesh and texture is checked once; a state is checked once while
    ``Remembered`` stores it.
    """
    check_framebuffer(profile, width, height, profile.widest_depth if depth_bits is None else depth_bits)
    check_samples(profile, samples)
    if color_bits is not None:
        check_color_bits(profile, color_bits)
    walked(
        begun(profile, width, height, depth_bits, textures, surfaces, statistics, read, samples=samples),
        commands,
    )


def begun(
    profile: Profile,
    width: int,
    height: int,
    depth_bits: int | None,
    textures: Mapping[str, Texture] | None,
    surfaces: Mapping[str, Framebuffer] | None,
    statistics: PixelStatistics | None,
    read: Iterable[str],
    *,
    samples: int = 1,
) -> Walk:
    """A Walk before the first command, with what a machine holds; the arguments are those of ``validate``."""
    depth_bits = profile.widest_depth if depth_bits is None else depth_bits
    walk = Walk(profile, width, height, depth_bits, surfaces or {}, statistics, read, samples=samples)
    for name, image in (textures or {}).items():
        walk.where = f"Texture {name!r}, which the machine holds"
        store(walk, name, image)
    return walk


def walked(
    walk: Walk, commands: Iterable[Command | MultiDraw], since: str = "", first: int = 0
) -> list[Known]:
    """Go through the commands, and refuse the first that the machine could not execute.

    - ``since``, ``first``: how messages count the commands: from which place, and from which number.

    Returns what the Walk knows after every HostStep, and after the last command. Where only a later driver
    takes the commands, the message of the UnsupportedState names that driver.
    """
    if walk.profile.driver is None:
        return _walked(walk, commands, since, first)
    commands, before = commands_of(commands), walk.known()
    try:
        return _walked(walk, commands, since, first)
    except UnsupportedState as refused:
        for later in walk.profile.later_drivers():
            if _takes_all(Walk.of(later, before), commands):
                raise UnsupportedState(f"{refused} It came with {later.driver}.") from None
        raise


def _takes_all(walk, commands):
    """Whether a machine takes all of the commands."""
    try:
        _walked(walk, commands, "", 0)
    except UnsupportedState:
        return False
    return True


def _walked(walk, commands, since, first):
    """``walked`` without a look at later drivers."""
    known, number = [], first - 1
    for command in commands_of(commands):
        number += 1
        if walk.takes(command):
            continue
        if type(command) is MultiDraw:
            for row, drawn in representatives(command):
                _walked(walk, (drawn,), since, number + row)
            number += len(command) - 1
            continue
        walk.where = f"Command {number}{since}"
        if type(command) not in VALIDATIONS:
            walk.refuse(
                f"{shown(command)} is no command; a frame is made of "
                f"{', '.join(kind.__name__ for kind in VALIDATIONS)}."
            )
        if isinstance(command.label, str):
            walk.where = f'Command {number}{since}, "{command.label}"'
        if type(command) is Draw and is_like_another(walk, command, _CHECKS):
            continue
        if wrong := _CHECKS[type(command)](command):
            walk.refuse(f"{wrong.path.lstrip('.')} {wrong.predicate}.")
        VALIDATIONS[type(command)](walk, command)
        if type(command) is HostStep:
            known.append(walk.known())
    return [*known, walk.known()]


class ValidFrame:
    """The checked commands of a frame that wait to run, with those that HostSteps issue.

    - ``waiting``: deque of commands; the caller takes them from the left, in order.

    A HostStep's commands may leave the known textures and other state as they were. The waiting commands then
    need no second check. So a frame's time grows with its commands, and not with commands times HostSteps.
    """

    def __init__(self, commands: Iterable[Command | MultiDraw], begin: Callable[[Iterable[str]], Walk]):
        """Check the commands; ``begin`` makes a Walk of the machine, from the names of pixels read so far.

        Raises UnsupportedState for a command that the machine could not execute.
        """
        self.waiting = deque(commands_of(commands))
        self._begin = begin
        self._known = deque(walked(begin(()), self.waiting))

    def issue(self, step: HostStep, pixels: Mapping[str, NDArray[Any]]) -> None:
        """Put the commands of a HostStep, which was the leftmost, before the waiting ones; check them all.

        ``pixels`` are the arrays read so far, by name. Raises UnsupportedState, and whatever the step's
        function raises.
        """
        issued, walk = issued_by(step, pixels), self._begin(pixels)
        since, expected = f' from HostStep "{step.label}" on', self._known.popleft()
        *steps, after = walked(walk, issued, since)
        if after != expected:
            self._known = deque(walked(walk, self.waiting, since, len(issued)))
        self._known.extendleft(reversed(steps))
        self.waiting.extendleft(reversed(issued))


def validate_program(
    texture_shader: tuple[TextureShaderStage, ...] | None,
    combiners: RegisterCombiners | None,
    profile: Profile,
) -> None:
    """Refuse texture shader stages and register combiners that the machine lacks, with any textures.

    Either may be None. Raises UnsupportedState (a ValueError) that names what was given, what the machine
    allows and what to do.
    """
    walk = Walk(profile, 1, 1, profile.widest_depth, {}, None)
    walk.where = "This program"
    if texture_shader is not None:
        units = len(texture_shader)
        if not profile.texture_shaders.texture_shader_operations:
            walk.refuse(f"{profile.name} has no texture shaders; choose a profile that has them.")
        if units > profile.textures.max_texture_units:
            walk.refuse(
                f"{profile.name} has {count(profile.textures.max_texture_units, 'texture unit')}; this "
                f"program has "
                f"{units} stages. Split the pass or choose a profile with more."
            )
        texture_units.texture_shader(
            walk, PassState(texture_units=(TextureUnit(None),) * units, texture_shader=texture_shader)
        )
    if combiners is not None:
        register_combiners(walk, combiners)
