"""What the techniques' passes have in common: depth functions, texture units, and drawing a stored
picture.
"""

import math

import numpy as np

from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.enums import (
    BlendEquation,
    BlendFactor,
    ComparisonFunction,
    ComponentUsage,
    Mapping,
    Register,
    StencilOperation,
    TextureEnvironmentMode,
    TextureFilter,
    WrapMode,
)
from fixedpipe.pipeline.state import (
    AlphaPortion,
    Blending,
    CombinerInput,
    DepthTest,
    FinalCombiner,
    GeneralCombiner,
    PassState,
    RegisterCombiners,
    RGBPortion,
    Sampler,
    StencilTest,
    TextureEnvironment,
    TextureUnit,
    VertexState,
    Viewport,
)
from fixedpipe.pipeline.textures.images import texture_2d

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


NO_RGB = RGBPortion(a=CombinerInput(), sum_output=Register.DISCARD)
NO_ALPHA = AlphaPortion(a=CombinerInput(usage=ComponentUsage.ALPHA), sum_output=Register.DISCARD)
ZERO = CombinerInput()
ONE = CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT)
OPAQUE = CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT, ComponentUsage.ALPHA)


def expand(register):
    """A register as a vector: EXPAND_NORMAL of its RGB."""
    return CombinerInput(register, Mapping.EXPAND_NORMAL)


def alpha_of(register):
    """A register's alpha, replicated where RGB is asked for."""
    return CombinerInput(register, usage=ComponentUsage.ALPHA)


def checked_rgb(color, what="The colour"):
    """RGB in [0, 1] as three floats: what a machine's colours, constants and tables hold.

    Raises ValueError, naming ``what``, for anything else.
    """
    out = np.asarray(color)
    if out.shape != (3,) or out.dtype.kind not in "iuf" or not ((out >= 0.0) & (out <= 1.0)).all():
        raise ValueError(f"{what} is {color!r}; give red, green and blue from 0 to 1.")
    return tuple(out.astype(np.float64).tolist())


def one_of(choices, given, what):
    """What was given. Raises ValueError, naming ``what``, where it is none of the choices."""
    if given not in choices:
        raise ValueError(f"{what} is {given!r}; give one of {', '.join(map(repr, choices))}.")
    return given


def positive(number, what):
    """A number as a float. Raises ValueError, naming ``what``, where it is not finite and above zero."""
    if not 0.0 < number < math.inf:
        raise ValueError(f"{what} is {number!r}; give a positive number.")
    return float(number)


def opaque(color):
    """RGB in [0, 1] as a combiner constant with alpha one."""
    return (*checked_rgb(color), 1.0)


def draw(label, mesh, view, combiners, units=(), *, depth_test=LATER_PASS, blending=None, **settings):
    """One pass over a mesh in a view; back-facing triangles are left to the depth test. ``settings``: more of
    PassState.
    """
    state = PassState(
        vertex=view.vertex,
        texture_units=tuple(units),
        register_combiners=combiners,
        scissor=view.panel.scissor,
        depth_test=depth_test,
        blending=blending,
        **settings,
    )
    return Draw(label=label, mesh=mesh, state=state)


def constant_product(factor, constant):
    """Combiners that give ``factor``, a final combiner's input, times RGB ``constant`` in [0, 1]."""
    final = FinalCombiner(a=factor, b=CombinerInput(Register.CONSTANT_COLOR0), c=ZERO, d=ZERO, g=OPAQUE)
    return RegisterCombiners(
        general=(GeneralCombiner(NO_RGB, NO_ALPHA),), final=final, constant_color0=opaque(constant)
    )


def keep_positive(mesh, view):
    """(.)+ of what the framebuffer holds where the mesh was drawn: the maximum with black."""
    black = constant_product(ZERO, (0.0, 0.0, 0.0))
    return draw("keep (.)+", mesh, view, black, depth_test=LATER_PASS, blending=AT_LEAST_ZERO)


def unit(texture, sampler=REPEATED, coordinates=0, **settings):
    """A texture unit that reads ``texture`` with one of the mesh's coordinate sets; ``settings``: more of
    TextureUnit.
    """
    return TextureUnit(texture, sampler, coordinates=coordinates, **settings)


def show(picture, panel, name, surface):
    """Commands that show a picture on a panel, one texel per pixel: how a software renderer's image is
    displayed.

    ``picture``: [height, width, 3] of the panel's size, bottom row first, bytes or floats. ``surface``: a
    rectangle (``meshes.plane``) of half width and half height one. The texture's edges are the next powers
    of two.
    """
    height, width = picture.shape[:2]
    if (width, height) != (panel.width, panel.height):
        raise ValueError(
            f"The picture is {width}x{height}; the panel needs {panel.width}x{panel.height} pixels."
        )
    columns, rows = (1 << (edge - 1).bit_length() for edge in (width, height))
    image = picture.dtype.type(0) * picture[:1, :1]
    image = image.repeat(rows, axis=0).repeat(columns, axis=1)
    image[:height, :width] = picture
    combiners = RegisterCombiners(
        general=(GeneralCombiner(NO_RGB, NO_ALPHA),),
        final=FinalCombiner(
            a=ZERO,
            b=ZERO,
            c=ZERO,
            d=CombinerInput(Register.TEXTURE0),
            g=OPAQUE,
        ),
    )
    scaled = surface.with_repeats(width / columns, height / rows)
    return (
        TexImage(label=f"load {name}", texture=name, image=texture_2d(image)),
        Draw(
            label=f"show {name}",
            mesh=scaled.mesh(),
            state=PassState(
                vertex=VertexState(viewport=Viewport(panel.x, panel.y, panel.width, panel.height)),
                texture_units=(unit(name, NEAREST),),
                register_combiners=combiners,
                scissor=panel.scissor,
            ),
        ),
    )
