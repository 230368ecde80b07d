"""Parts of Draws, for techniques: depth tests, blending, samplers, a texture unit; one pass over a mesh, and
one that shows a stored picture; rectangles of pixels at a panel's place.
"""

from fixedpipe.effects.passes.combiners import TEXTURE0, ZERO, constant_product, program, shown
from fixedpipe.pipeline.commands import CopyPixels, Draw, TexImage
from fixedpipe.pipeline.enums import (
    BlendEquation,
    BlendFactor,
    ComparisonFunction,
    StencilOperation,
    TextureEnvironmentMode,
    TextureFilter,
    WrapMode,
)
from fixedpipe.pipeline.state import (
    Blending,
    DepthTest,
    PassState,
    RasterPosition,
    Sampler,
    StencilTest,
    TextureEnvironment,
    TextureUnit,
    VertexState,
)
from fixedpipe.pipeline.textures.images import texture_2d
from fixedpipe.pipeline.textures.pixels import bytes_or_floats

FIRST_PASS = DepthTest(ComparisonFunction.LESS, write=True)
LATER_PASS = DepthTest(ComparisonFunction.EQUAL, write=False)
ADD = Blending(BlendFactor.ONE, BlendFactor.ONE)
# The first pass leaves the gate (n.l)+ in destination alpha; what is added is multiplied by it.
ADD_GATED = Blending(BlendFactor.DST_ALPHA, BlendFactor.ONE)
MULTIPLY_DESTINATION = Blending(BlendFactor.DST_COLOR, BlendFactor.ZERO)
# source * (1 - destination); with a white source the subtraction from one, without a blend equation.
INVERT_DESTINATION = Blending(BlendFactor.ONE_MINUS_DST_COLOR, BlendFactor.ZERO)
# (.)+ of the framebuffer. A framebuffer of bytes never falls below zero and would not need it; the exact
# framebuffer does.
AT_LEAST_ZERO = Blending(BlendFactor.ONE, BlendFactor.ONE, BlendEquation.MAX)
# 2 * source * destination; with a white source twice the destination.
MULTIPLY_DESTINATION_TWICE = Blending(BlendFactor.DST_COLOR, BlendFactor.SRC_COLOR)
# EXT_blend_subtract: destination - source, and source - destination.
SUBTRACT = Blending(BlendFactor.ONE, BlendFactor.ONE, BlendEquation.FUNC_REVERSE_SUBTRACT)
SUBTRACT_FROM_SOURCE = Blending(BlendFactor.ONE, BlendFactor.ONE, BlendEquation.FUNC_SUBTRACT)

# Texture environments: the texel, and the texel times what comes in.
REPLACE = TextureEnvironment(TextureEnvironmentMode.REPLACE)
MODULATE = TextureEnvironment(TextureEnvironmentMode.MODULATE)

# The pixels that a polygon covers, for rectangles of pixels that must leave others alone.
MARK = StencilTest(ComparisonFunction.ALWAYS, reference=1, depth_pass=StencilOperation.REPLACE)
MARKED = StencilTest(ComparisonFunction.EQUAL, reference=1)

REPEATED = Sampler(TextureFilter.LINEAR, TextureFilter.LINEAR, WrapMode.REPEAT, WrapMode.REPEAT)
NEAREST = Sampler(
    TextureFilter.NEAREST, TextureFilter.NEAREST, WrapMode.CLAMP_TO_EDGE, WrapMode.CLAMP_TO_EDGE
)
EDGE = Sampler(TextureFilter.LINEAR, TextureFilter.LINEAR, WrapMode.CLAMP_TO_EDGE, WrapMode.CLAMP_TO_EDGE)


def draw(label, mesh, view, combiners, units=(), *, depth_test=LATER_PASS, blending=None, **settings):
    """One pass over a mesh in a view, a later one unless ``depth_test`` is ``FIRST_PASS``; back-facing
    triangles are left to the depth test. ``settings``: more of PassState.
    """
    state = PassState(
        vertex=view.vertex,
        texture_units=tuple(units),
        register_combiners=combiners,
        depth_test=depth_test,
        blending=blending,
        **settings,
    )
    return Draw(label=label, mesh=mesh, state=state)


def keep_positive(mesh, view):
    """(.)+ of the framebuffer where the mesh was drawn: the maximum with black."""
    black = constant_product(ZERO, (0.0, 0.0, 0.0))
    return draw("keep (.)+", mesh, view, black, blending=AT_LEAST_ZERO)


def unit(texture, sampler=REPEATED, coordinates=0, **settings):
    """A texture unit that reads ``texture`` with one of the mesh's coordinate sets; ``settings``: more of
    TextureUnit.
    """
    return TextureUnit(texture, sampler, coordinates=coordinates, **settings)


def at_pixel(x, y):
    """The raster position of the pixel (x, y) of the window, where a rectangle's lower left pixel comes."""
    return RasterPosition(position=(float(x), float(y), 0.0, 1.0), window=True)


def copy_of_panel(label, panel, state, transfer, **settings):
    """The command that copies a panel onto itself through a pixel transfer; ``settings``: more of
    CopyPixels.
    """
    return CopyPixels(
        label=label,
        x=panel.x,
        y=panel.y,
        width=panel.width,
        height=panel.height,
        state=state,
        position=at_pixel(panel.x, panel.y),
        transfer=transfer,
        **settings,
    )


def show(picture, panel, name, surface):
    """Commands that show a picture on a panel, one texel per pixel: how a software renderer's image is
    displayed.

    ``picture``: [height, width, 3] of the panel's size, bottom row first, bytes or floats. ``surface``: a
    rectangle (``surfaces.plane``) of half width and half height one. The texture's edges are the next powers
    of two.
    """
    picture = bytes_or_floats(picture, "The picture")
    height, width = picture.shape[:2]
    if (width, height) != (panel.width, panel.height):
        raise ValueError(
            f"The picture is {width}x{height}; the panel needs {panel.width}x{panel.height} pixels."
        )
    columns, rows = (1 << (edge - 1).bit_length() for edge in (width, height))
    image = picture.dtype.type(0) * picture[:1, :1]
    image = image.repeat(rows, axis=0).repeat(columns, axis=1)
    image[:height, :width] = picture
    scaled = surface.with_repeats(width / columns, height / rows)
    return (
        TexImage(label=f"load {name}", texture=name, image=texture_2d(image)),
        Draw(
            label=f"show {name}",
            mesh=scaled.mesh(),
            state=PassState(
                vertex=VertexState(viewport=panel.viewport),
                texture_units=(unit(name, NEAREST),),
                register_combiners=program(shown(TEXTURE0)),
            ),
        ),
    )
