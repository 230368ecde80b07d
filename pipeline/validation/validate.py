"""What a machine refuses, and why: every command is checked before any is executed.

``validate`` walks the commands in order, knows which textures exist when each is reached, and raises
``UnsupportedState`` at the first thing that the profile could not hold or that no machine could mean. Every
sentence names the command, what was given, what the machine allows, and what to do about it.

Source: the errors of OpenGL 1.2.1, NV_register_combiners and 2, EXT_texture_cube_map, NV_texgen_reflection,
EXT_texture_lod_bias, EXT_stencil_wrap, EXT_fog_coord, NV_texture_shader, EXT_point_parameters,
NV_point_sprite, ARB_texture_env_combine and _dot3, NV_texture_env_combine4. Where OpenGL clamps silently
(clear colours, constant colours, alpha and stencil references) so do the stages that follow, and nothing is
refused; where it calls the result undefined (pixels read outside the framebuffer, an incomplete texture)
validation refuses.
"""

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

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
    HostStep,
    MakeCurrent,
    Mesh,
    ReadPixels,
    ResetHistogram,
    ResetMinmax,
    Saturate,
    TexImage,
)
from fixedpipe.pipeline.pixel_transfer import PixelMaps, PixelTransfer
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.sentences import count, shown
from fixedpipe.pipeline.state import (
    ColorTable,
    PassState,
    RegisterCombiners,
    TextureShaderStage,
    TextureUnit,
    VertexState,
)
from fixedpipe.pipeline.textures.images import Texture
from fixedpipe.pipeline.validation import texture_units
from fixedpipe.pipeline.validation.buffers import accum, clear, read_pixels, saturate
from fixedpipe.pipeline.validation.draws import draw
from fixedpipe.pipeline.validation.fragments import register_combiners
from fixedpipe.pipeline.validation.frames import frame_of, host_step
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
    store,
    tex_image,
)
from fixedpipe.pipeline.validation.transfer import reset_histogram, reset_minmax
from fixedpipe.pipeline.validation.types import TypeChecks
from fixedpipe.pipeline.validation.walk import Walk

if TYPE_CHECKING:  # for annotations alone: the law asks no framebuffer
    from fixedpipe.pipeline.framebuffers.framebuffer import Framebuffer
    from fixedpipe.pipeline.framebuffers.transfer import PixelStatistics

# Parts that many states share, because dataclasses.replace keeps them, are looked at once.
_CHECKS = TypeChecks(
    whole=(Mesh, Texture),
    shared=(VertexState, TextureUnit, RegisterCombiners, PixelTransfer, PixelMaps, ColorTable),
)

# What refuses a command of each class: a function of the Walk and the command.
VALIDATIONS = {
    Clear: clear,
    Draw: draw,
    TexImage: tex_image,
    CopyTexImage: copy_tex_image,
    CopyTexSubImage: copy_tex_sub_image,
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
    commands: Iterable[Command],
    profile: Profile,
    width: int,
    height: int,
    depth_bits: int | None = None,
    textures: Mapping[str, Texture] | None = None,
    surfaces: "Mapping[str, Framebuffer] | None" = None,
    statistics: "PixelStatistics | None" = None,
    *,
    samples: int = 1,
    color_bits: int | None = None,
    read: Iterable[str] = (),
    host_step: str | None = None,
) -> None:
    """Refuse what the machine could not execute; return None if it can execute everything.

    commands       iterable of commands, in order
    profile        the machine
    width, height  of the framebuffer, pixels
    depth_bits     of the depth buffer; None: the widest fixed format that the machine has
    textures       {name: Texture} that the machine holds already, or None
    surfaces       {name: Framebuffer}, its pbuffers, or None
    statistics     its PixelStatistics, or None
    samples        of each of the framebuffer's pixels
    color_bits     of its colours' components; None: the usual width
    read           names that ReadPixels of the same frame gave already
    host_step      label of the HostStep that issued the first of these commands, or None

    Raises UnsupportedState (a ValueError) whose message names the command, what was given, what the machine
    allows, and what to do. Meshes and textures are looked at once in their life; so are states, as long as
    they are remembered (``Remembered``).
    """
    depth_bits = profile.widest_depth if depth_bits is None else depth_bits
    check_framebuffer(profile, width, height, depth_bits)
    check_samples(profile, samples)
    if color_bits is not None:
        check_color_bits(profile, color_bits)
    walk = Walk(profile, width, height, depth_bits, surfaces or {}, statistics, read)
    for name, image in (textures or {}).items():
        walk.where = f"Texture {name!r}, which the machine holds"
        store(walk, name, image)
    since = "" if host_step is None else f' from HostStep "{host_step}" on'
    for number, command in enumerate(frame_of(commands)):
        if walk.takes(command):
            continue
        walk.where = f"Command {number}{since}"
        if type(command) not in VALIDATIONS:
            walk.refuse(
                f"{shown(command)} is no command; a frame is made of "
                f"{', '.join(kind.__name__ for kind in VALIDATIONS)}."
            )
        if isinstance(command.label, str):
            walk.where = f'Command {number}{since}, "{command.label}"'
        if wrong := _CHECKS[type(command)](command):
            walk.refuse(f"{wrong.path.lstrip('.')} {wrong.predicate}.")
        VALIDATIONS[type(command)](walk, command)


def validate_program(
    texture_shader: tuple[TextureShaderStage, ...] | None,
    combiners: RegisterCombiners | None,
    profile: Profile,
) -> None:
    """Refuse texture shader stages and register combiners that the machine does not have, whatever textures
    and meshes they meet; either may be None.

    Raises UnsupportedState (a ValueError) that names what was given, what the machine allows, what to do.
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
