"""Validation of rectangles of pixels: DrawPixels, CopyPixels and Bitmap.

The type checks run first: fields have the annotated types, and numbers are finite.
"""

from fixedpipe.pipeline.commands import kind_of
from fixedpipe.pipeline.enums import PixelCopyType, PixelTexGenAlpha, PixelTexGenQ, TextureTarget, VertexStage
from fixedpipe.pipeline.messages import count
from fixedpipe.pipeline.state import VertexState
from fixedpipe.pipeline.validation import buffers, surfaces
from fixedpipe.pipeline.validation.draws import pass_state
from fixedpipe.pipeline.validation.transfer import pixel_image_problem, transferred


def draw_pixels(walk, command):
    """Refuse a DrawPixels whose image or state the machine could not draw."""
    if problem := pixel_image_problem(command.image):
        walk.refuse(problem)
    height, width = command.image.values.shape[:2]
    _pixels(walk, command, width, height)


def copy_pixels(walk, command):
    """Refuse a CopyPixels from outside the framebuffer, or whose state the machine could not draw."""
    width, height = surfaces.framebuffer_rectangle(walk, command)
    buffers.color_buffer(walk, command.read_buffer)
    _pixels(walk, command, width, height)


def _pixels(walk, command, width, height):
    """Check what DrawPixels and CopyPixels share."""
    kind = kind_of(command)
    if kind is PixelCopyType.STENCIL:
        buffers.stencil_buffer(walk, "writes the stencil buffer")
    transferred(walk, command, width, height, deep=kind is not PixelCopyType.COLOR)
    _rectangle_of_pixels(walk, command)
    if command.pixel_texture is None:
        return
    units = command.state.texture_units
    read = [(i, u.sampler.base_level, walk.textures[u.texture]) for i, u in enumerate(units) if u is not None]
    textures = [(i, texture.target, texture.faces[base]) for i, base, texture in read]
    bordered = [i for i, _, texture in read if texture.border]
    if bordered and command.pixel_texture.volumes is not None:
        walk.refuse(
            f"texture unit {bordered[0]} has a texture with a border, which is not of several volumes; give "
            "one without, or leave volumes None."
        )
    if problem := _pixel_texture_problem(command.pixel_texture, kind, command.state, textures, walk.profile):
        walk.refuse(problem)


def bitmap(walk, command):
    """Refuse a Bitmap whose bits or state the machine could not draw."""
    if problem := _bits_problem(command.bits):
        walk.refuse(problem)
    _rectangle_of_pixels(walk, command)


def _rectangle_of_pixels(walk, command):
    if problem := _rectangle_problem(command, walk.profile):
        walk.refuse(problem)
    pass_state(walk, command.state)


def _rectangle_problem(command, profile):
    """A sentence that says why a machine cannot make the fragments of a rectangle of pixels, or None."""
    vertex, state = command.state.vertex, command.state
    if vertex.stage == VertexStage.PROGRAM_RESULTS or vertex.composite != VertexState().composite:
        return (
            "a raster position goes through the fixed-function vertex stage, by modelview, projection and "
            "viewport; leave vertex.stage and vertex.composite unset, or give the position in window "
            "coordinates (window=True) beside a state without them."
        )
    if state.w_buffering and command.position.window:
        return (
            "w_buffering takes clip w as depth, and a raster position in window coordinates has none; give "
            "object coordinates, or leave w_buffering False."
        )
    if state.texture_shader is not None:
        return (
            f"texture shaders of {profile.name} take their coordinates from vertices; rectangles of pixels "
            "have none. Leave texture_shader None, or draw a textured quad."
        )
    return None


def _bits_problem(bits):
    """A sentence that says what is wrong with a Bitmap's bits, or None."""
    if bits.ndim != 2:
        return f"the bitmap has shape {bits.shape}; give [height, width]."
    if 0 in bits.shape:
        return f"the bitmap is {bits.shape[1]}x{bits.shape[0]}; give at least one pixel."
    if bits.dtype.kind not in "bui" or not ((bits == 0) | (bits == 1)).all():
        return f"the bitmap holds values of {bits.dtype} that are not bits; give booleans, or zeros and ones."
    return None


def _pixel_texture_problem(texture, kind, state, textures, profile):
    """A sentence that says why a machine cannot turn groups into texture coordinates, or None.

    - ``kind``: the groups' PixelCopyType.
    - ``textures``: (number, target, layers of the base level) of each enabled unit.
    """
    sgix = texture.mode is not None
    if not (profile.pixels.pixel_texture if sgix else profile.pixels.pixel_texture_sgis):
        return (
            f"{profile.name} has no {'SGIX' if sgix else 'SGIS'}_pixel_texture; read the pixels, look them "
            "up on the host (fixedpipe.effects.passes.software_pixel_texture) and draw what is found."
        )
    if kind != PixelCopyType.COLOR:
        return f"only colours become texture coordinates, not {kind.name}; leave pixel_texture None."
    if sgix and (texture.rgb_source or texture.alpha_source):
        return (
            "pixel_texture.rgb_source and alpha_source are SGIS_pixel_texture's; give mode None beside them, "
            "or the mode alone."
        )
    if not textures:
        return "pixel_texture makes texture coordinates, and no texture unit is enabled; enable one."
    return _impact_problem(texture, textures, profile)


def _impact_problem(texture, textures, profile):
    plain = texture.volumes is None and not texture.alpha_replace
    if not plain and not profile.pixels.impact_pixel_texture:
        return (
            f"{profile.name} has no SGIX_impact_pixel_texture; leave volumes None and alpha_replace False, "
            "or blend the passes by a texture's own alpha."
        )
    if texture.volumes is None and texture.q_filter != PixelTexGenQ.ROUND:
        return (
            f"pixel_texture.q_filter is {texture.q_filter.name}, which chooses a volume of a "
            "four-dimensional texture; give volumes, or leave it ROUND."
        )
    if not texture.alpha_replace and texture.alpha != PixelTexGenAlpha.MS:
        return "pixel_texture.alpha is LS, which alpha_replace alone reads; set that, or leave it MS."
    if texture.volumes is None:
        return None
    if texture.volumes < 1:
        return f"pixel_texture.volumes is {texture.volumes}; give 1 or more, or None."
    for number, target, layers in textures:
        if target != TextureTarget.TEXTURE_3D or layers % texture.volumes:
            return (
                f"texture unit {number} has a {target.name} of {count(layers, 'layer')}, which is not "
                f"{texture.volumes} volumes; give a TEXTURE_3D whose layers are as many times the volumes'."
            )
    return None
