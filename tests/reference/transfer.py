"""Whole rectangles: Clear, copies into textures, ReadPixels. Rectangles count rows from the bottom."""

from fractions import Fraction

from tests.reference import coverage, fixed, per_fragment, pixel_transfer, surface, texel_formats
from tests.reference.depth import depth_to_units, full_scale


def clear(target, command):
    """Source: OpenGL 1.2.1 section 4.2.3, through scissor and masks."""
    columns, rows = coverage.scissor_rows_and_columns(command.scissor, target.width, target.height)
    for py in rows:
        for px in columns:
            if command.color is not None:
                color = surface.to_surface(fixed.color_codes(command.color), target.color_format)
                stored = target.color[py][px]
                target.color[py][px] = per_fragment.masked_color(color, stored, command.color_mask)
            if command.depth is not None:
                target.depth[py][px] = depth_to_units(command.depth, target.depth_bits)
            if command.stencil is not None:
                target.stencil[py][px] = per_fragment.write_stencil(
                    target.stencil[py][px], command.stencil, command.stencil_write_mask
                )


def rectangle(rows, x, y, width, height):
    """A part of a buffer, bottom row first. Source: OpenGL 1.2.1 section 4.3.2 (order of pixels)."""
    total = len(rows)
    return [[rows[total - 1 - j][i] for i in range(x, x + width)] for j in range(y, y + height)]


def groups(target, state, profile, x, y, width, height, dimensions=2):
    """Pixel groups of a rectangle after pixel transfer; no histogram and no minmax.

    Source: OpenGL 1.2.1 section 4.3.2, Conversion of RGBA values and Pixel Transfer Operations.
    """
    pixels = rectangle(target.color, x, y, width, height)
    image = [[[Fraction(c, 255) for c in pixel] for pixel in row] for row in pixels]
    return pixel_transfer.transfer(
        image, state, dimensions, profile.arithmetic.clamps_color_matrix, None, None
    )


def copy_texels(target, texture, state, profile, x, y, width, height):
    """Register bytes of the texels that CopyTexImage or CopyTexSubImage defines, bottom row first.

    ``texture``: what has the texture's ``target`` and ``internal_format``. Source: OpenGL 1.2.1 section
    3.8.2; the conversion is TexImage2D's. Depths for a depth texture: SGIX_depth_texture, ARB_depth_texture.
    """
    if is_depth_format(texture.internal_format):
        most = float(full_scale(target.depth_bits))
        depths = [[word / most for word in row] for row in rectangle(target.depth, x, y, width, height)]
        return depth_texels(depths, state, texture.internal_format)
    dimensions = 1 if texture.target.name == "TEXTURE_1D" else 2
    image = groups(target, state, profile, x, y, width, height, dimensions)
    store, internal_format = texel_formats.store_texel, texture.internal_format
    return [[store(group, internal_format, floats=True) for group in row] for row in image]


def sunk_levels(before, target, internal_format, sizes):
    """Levels of register bytes after a TexImage or CopyTexImage whose image a sink took. ``before``: the
    texture that had the name, or None; ``sizes``: faces or layers, height and width of each level.

    Source: OpenGL 1.2.1 section 3.6.5, Histogram and Minmax: texture memory stays, the object's state
    changes. Assumed: a level that was there with the same target, format and size keeps its texels; all
    other texels, which the specification leaves undefined, are of zeros.
    """
    zero = texel_formats.store_texel([0.0] * 4, internal_format, floats=True)
    levels = [
        [[[zero] * width for _ in range(height)] for _ in range(faces)] for faces, height, width in sizes
    ]
    if before is None or (before.target, before.internal_format) != (target, internal_format):
        return levels
    for k, level in enumerate(before.levels[: len(sizes)]):
        if (len(level), len(level[0]), len(level[0][0])) == tuple(sizes[k]):
            levels[k] = level
    return levels


def is_depth_format(internal_format):
    """Source: ARB_depth_texture."""
    return internal_format.name.startswith("DEPTH_COMPONENT")


def depth_texels(depths, state, internal_format):
    """Depths in [0, 1] through pixel transfer as the texels of a depth texture: words, lowest byte first.

    Source: ARB_depth_texture (fixed-point depths, to nearest); OpenGL 1.2.1 section 3.6.4.
    """
    bits = int(internal_format.name.removeprefix("DEPTH_COMPONENT"))
    words = [
        [depth_to_units(pixel_transfer.transfer_depth(value, state), bits) for value in row] for row in depths
    ]
    return [[word_bytes(word) for word in row] for row in words]


def word_bytes(word):
    """Source: WGL_NV_render_depth_texture: a depth word's bytes, the lowest first."""
    return [word >> shift & 255 for shift in (0, 8, 16, 24)]


def texels_of(target, internal_format):
    """Register bytes of a pbuffer's pixels read as texels, top row first: the words' bits, widened.

    Source: WGL_ARB_render_texture; Measured: bits are replicated as in any texel (Texture_format captures).
    A depth format reads the depth words, the lowest byte first. Source: WGL_NV_render_depth_texture.
    """
    if is_depth_format(internal_format):
        return [[word_bytes(word) for word in row[: target.width]] for row in target.depth]
    base, *bits = texel_formats.FORMATS[internal_format.name]
    texels = []
    for row in target.color:
        kept = [texel_formats.kept_components(pixel, base) for pixel in row]
        words = [[c >> (8 - b) for c, b in zip(pixel, bits, strict=True)] for pixel in kept]
        widened = [[texel_formats.replicate(c, b) for c, b in zip(w, bits, strict=True)] for w in words]
        texels.append([texel_formats.register_components(components, base) for components in widened])
    return texels


def read_pixels(target, command, profile, width, height):
    """Source: OpenGL 1.2.1 section 4.3.2; depths and stencil values in the buffer's own units."""
    state, box = command.transfer, (command.x, command.y, width, height)
    if command.format == "DEPTH_COMPONENT":
        return rectangle(target.depth, *box)
    if command.format == "STENCIL_INDEX":
        return [
            [pixel_transfer.stencil_index(value, state) & 255 for value in row]
            for row in rectangle(target.stencil, *box)
        ]
    return [
        [pixel_transfer.component_read(group, command.format, command.type) for group in row]
        for row in groups(target, state, profile, *box)
    ]


# What GetTexImage makes of a base format's components.  Source: OpenGL 1.2.1 table 6.1.
RETURNED = {
    "ALPHA": lambda a: [0, 0, 0, a],
    "LUMINANCE": lambda y: [y, 0, 0, 1],
    "LUMINANCE_ALPHA": lambda y, a: [y, 0, 0, a],
    "INTENSITY": lambda i: [i, 0, 0, 1],
    "RGB": lambda r, g, b: [r, g, b, 1],
    "RGBA": lambda r, g, b, a: [r, g, b, a],
}


def stored_component(byte, bits):
    """The component of so many bits that was widened to a register's byte. Measured: Texture_format captures,
    the bits are written again and again.
    """
    return Fraction(byte >> (8 - bits), 2**bits - 1)


def get_tex_image(texture, command, profile):
    """Rows, bottom row first, of a 3D texture a list of layers. ``texture``: of register bytes or of depth
    words; no histogram and no minmax.

    Source: OpenGL 1.2.1 section 6.1.4; ARB_depth_texture; EXT_texture3D: each layer is an image.
    """
    level, state = texture.levels[command.level], command.transfer
    if is_depth_format(texture.internal_format):
        words = [[sum(byte << 8 * k for k, byte in enumerate(texel)) for texel in row] for row in level[0]]
        if (state.depth_scale, state.depth_bias) == (1.0, 0.0):
            return words
        bits = int(texture.internal_format.name.removeprefix("DEPTH_COMPONENT"))
        scaled = [
            [pixel_transfer.transfer_depth(d / float(2**bits - 1), state) for d in row] for row in words
        ]
        return [[depth_to_units(depth, bits) for depth in row] for row in scaled]
    base, *bits = texel_formats.FORMATS[texture.internal_format.name]

    def group(texel):
        """Source: OpenGL 1.2.1 section 6.1.4."""
        kept = texel_formats.kept_components(texel, base)
        components = [stored_component(byte, b) for byte, b in zip(kept, bits, strict=True)]
        return [Fraction(c) for c in RETURNED[base.name](*components)]

    layered = texture.target.name == "TEXTURE_3D"
    dimensions = {"TEXTURE_1D": 1, "TEXTURE_3D": 3}.get(texture.target.name, 2)
    images = []
    for image in level if layered else [level[command.face]]:
        groups = [[group(texel) for texel in row] for row in image]
        groups = pixel_transfer.transfer(
            groups, state, dimensions, profile.arithmetic.clamps_color_matrix, None, None
        )
        images.append(
            [[pixel_transfer.component_read(g, command.format, command.type) for g in row] for row in groups]
        )
    return images if layered else images[0]
