"""Frames of rectangles of pixels, pixel transfer, copies, pbuffers, accumulation, and of wider machines."""

from fixedpipe.pipeline.commands import (
    Accum,
    BindTexImage,
    Bitmap,
    Clear,
    CopyPixels,
    CopyTexImage,
    CopyTexSubImage,
    DrawPixels,
    MakeCurrent,
    ReadPixels,
    TexImage,
)
from fixedpipe.pipeline.enums import (
    AccumOperation,
    BaseFormat,
    BlendFactor,
    ColorFormat,
    CombinerFunction,
    ConvolutionBorderMode,
    InternalFormat,
    Register,
    TextureEnvironmentMode,
    TextureFilter,
    WindowOrigin,
)
from fixedpipe.pipeline.pixel_transfer import (
    ConvolutionFilter,
    Histogram,
    Minmax,
    PixelImage,
    PixelTransfer,
    SeparableFilter,
)
from fixedpipe.pipeline.profiles import (
    FUTURE,
    GEFORCE_256,
    INFINITE_REALITY,
    NV2A,
    OCTANE,
    OPENGL_1_2,
    OPENGL_1_2_IMAGING,
)
from fixedpipe.pipeline.selftest.frame import Frame, background, patched, stores
from fixedpipe.pipeline.selftest.shapes import picture, values
from fixedpipe.pipeline.state import (
    Blending,
    ColorTable,
    CombinerInput,
    CombinerLookup,
    DepthTest,
    GeneralCombiner,
    PassState,
    RasterPosition,
    RegisterCombiners,
    RGBPortion,
    Sampler,
    TextureEnvironment,
    TextureUnit,
)
from fixedpipe.pipeline.textures.images import texture_2d

_LINEAR = Sampler(TextureFilter.LINEAR, TextureFilter.LINEAR)
_MODULATED = TextureUnit("texture", _LINEAR)
_REPLACED = TextureUnit("texture", _LINEAR, environment=TextureEnvironment(TextureEnvironmentMode.REPLACE))
_OVER = Blending(BlendFactor.SRC_ALPHA, BlendFactor.ONE_MINUS_SRC_ALPHA)
_WIDE_OVER = (
    PassState(),
    PassState(texture_units=(_REPLACED,)),
    PassState(texture_units=(_MODULATED,)),
    PassState(blending=_OVER),
    PassState(blending=Blending(BlendFactor.ONE, BlendFactor.ONE), texture_units=(_MODULATED,)),
    PassState(depth_test=DepthTest(), texture_units=(_REPLACED,), blending=_OVER),
    PassState(depth_test=DepthTest()),
    PassState(blending=Blending(BlendFactor.DST_COLOR, BlendFactor.ZERO)),
)


def _at(x, y):
    """A raster position at window coordinates of the self-test's window."""
    return RasterPosition((x, y, 0.4, 1.0), window=True, color=(0.9, 0.6, 0.3, 0.8))


def _tables():
    ramp = tuple(((15 - k) / 15, k * k / 225, k / 15, 1.0 - k / 30) for k in range(16))
    return ColorTable(ramp), ColorTable(ramp[::-1], BaseFormat.LUMINANCE_ALPHA)


_IMAGE = PixelImage(picture(12, 14, seed=20), "RGBA")
_LEFT, _RIGHT = _tables()
_BLURRED = ConvolutionFilter(
    tuple(tuple((k / 9.0, (j - k) / 5.0, 0.11, 0.2) for k in range(3)) for j in range(3)),
    border_mode=ConvolutionBorderMode.CONSTANT_BORDER,
    border_color=(0.2, 0.4, 0.1, 0.9),
)
_PRODUCT = SeparableFilter(
    ((0.25, 0.5, 0.1, 0.3),) * 3,
    ((0.5, 0.3, 0.9, 0.4),) * 2,
    border_mode=ConvolutionBorderMode.REPLICATE_BORDER,
)
_MIXED = ((0.2, 0.5, 0.1, 0.1), (0.7, -0.2, 0.4, 0.0), (0.1, 0.1, 0.9, -0.1), (0.0, 0.2, 0.0, 0.8))
_TRANSFERS = (
    PixelTransfer(scale=(1.3, 0.8, 0.5, 1.0), bias=(-0.1, 0.2, 0.3, 0.0), color_table=_LEFT),
    PixelTransfer(convolution_2d=_BLURRED, post_convolution_scale=(2.0, 1.0, 3.0, 1.0)),
    PixelTransfer(separable_2d=_PRODUCT, post_convolution_color_table=_RIGHT),
    PixelTransfer(color_matrix=_MIXED, post_color_matrix_bias=(0.1, 0.0, 0.2, 0.1), color_table=_RIGHT),
)


def _rectangles():
    """Images with transfer and zoom, depths, stencil values, bitmaps, and copies of the framebuffer."""
    for number, transfer in enumerate(_TRANSFERS):
        place = _at(2.0 + 15 * (number % 2), 3.0 + 16 * (number // 2))
        yield DrawPixels(label="image", image=_IMAGE, position=place, transfer=transfer)
    depths = PixelImage(values(9, 9, seed=21, most=65535).astype("uint16"), "DEPTH_COMPONENT")
    stencil = PixelImage(values(8, 8, seed=22).astype("uint8"), "STENCIL_INDEX")
    tested = PassState(depth_test=DepthTest())
    yield DrawPixels(label="depths", image=depths, position=_at(3.5, 40.2), state=tested, zoom=(1.4, -1.2))
    yield DrawPixels(label="stencil", image=stencil, position=_at(18.0, 42.0))
    yield Bitmap(label="bitmap", bits=values(10, 13, seed=23) > 120, position=_at(15.2, 45.7), state=tested)
    yield CopyPixels(label="copy", x=2, y=2, width=11, height=9, position=_at(30.0, 64.0), zoom=(-1.1, -1.3))
    blended = PassState(blending=_OVER)
    yield CopyPixels(
        label="copy", x=9, y=9, width=12, height=12, position=_at(4.0, 53.0), state=blended,
        transfer=_TRANSFERS[3],
    )  # fmt: skip


_READ = (
    ReadPixels(label="read", name="colors", x=3, y=5, width=20, height=30, transfer=_TRANSFERS[3]),
    ReadPixels(label="read", name="depths", format="DEPTH_COMPONENT"),
)
_COUNTED = PixelTransfer(histogram=Histogram("counts", 16), minmax=Minmax("bounds"), color_matrix=_MIXED)
_READ_OTHERWISE = (
    ReadPixels(label="read", name="counted", transfer=_COUNTED, type="UNSIGNED_SHORT"),
    ReadPixels(label="read", name="convolved", transfer=_TRANSFERS[1], x=3, y=5, width=20, height=30),
    ReadPixels(label="read", name="luminance", format="LUMINANCE", type="FLOAT"),
)


def _copies():
    """Textures copied from the window, with mipmaps, in parts, and through pixel transfer."""
    far = ((3.0, 0.0, 0.0, 0.0), (0.0, 3.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))
    unit = TextureUnit("texture", Sampler(TextureFilter.LINEAR_MIPMAP_LINEAR), matrix=far)
    copied = PassState(texture_units=(unit,))
    return (
        CopyTexImage(label="copy", texture="texture", x=1, y=3, width=16, height=32, generate_mipmap=True),
        *patched((copied, copied)),
        CopyTexSubImage(
            label="part", texture="texture", x=5, y=5, width=9, height=7, x_offset=3, y_offset=4,
            generate_mipmap=True,
        ),
        *patched((copied,) * 5)[2:],
        TexImage(
            label="transfer", texture="texture", pixels=PixelImage(picture(8, 8, seed=24), "RGBA"),
            transfer=PixelTransfer(scale=(0.5, 0.9, 1.0, 1.0), bias=(0.3, 0.0, 0.1, 0.0)),
        ),
        *patched((PassState(texture_units=(_REPLACED,)),) * 8)[5:],
    )  # fmt: skip


def _surfaces():
    """Pbuffers of sixteen and 32 bits a pixel, drawn and bound as a texture, one for each origin."""
    formats = (
        (ColorFormat.R5G6B5, InternalFormat.R5_G6_B5, WindowOrigin.LOWER_LEFT),
        (ColorFormat.A8R8G8B8, InternalFormat.RGBA8, WindowOrigin.UPPER_LEFT),
    )
    for number, (stored, read, origin) in enumerate(formats):
        name = f"surface {number}"
        yield MakeCurrent(label="make", surface=name, width=32, height=64, color_format=stored)
        yield Clear(label="clear", color=(0.1, 0.3, 0.2, 0.9), depth=1.0)
        yield from patched((PassState(), PassState(blending=_OVER)) * 4)
        yield MakeCurrent(label="window")
        yield BindTexImage(label="bind", texture="texture", surface=name, internal_format=read, origin=origin)
        yield from patched((PassState(texture_units=(_REPLACED,)),) * 8)[4 * number : 4 * number + 4]


def _accumulated():
    op = AccumOperation
    return (
        *patched((PassState(), PassState(blending=_OVER)) * 4),
        Accum(label="load", operation=op.LOAD, value=0.37),
        *patched((PassState(),) * 4),
        Accum(label="accum", operation=op.ACCUM, value=-0.45),
        Accum(label="mult", operation=op.MULT, value=0.8),
        Accum(label="add", operation=op.ADD, value=0.21),
        Accum(label="return", operation=op.RETURN, value=1.7),
    )


def _wide(name, profile, **window):
    stored = stores(texture=texture_2d(picture(8, 8, seed=25)))
    commands = (*stored, *background(), *patched(_WIDE_OVER))
    return Frame(name=name, profile=profile, commands=commands, window=window)


def _future():
    """The functions of the future board's combiners, and a lookup between them."""
    at = CombinerInput(Register.TEXTURE0)
    color = CombinerInput(Register.PRIMARY_COLOR)
    functions = [kind for kind in CombinerFunction if kind is not CombinerFunction.NONE]
    for number in range(8):
        portion = RGBPortion(at, color, color, at, function=functions[number % len(functions)])
        lookup = CombinerLookup(1, Register.SPARE0) if number % 2 else None
        shown = GeneralCombiner(RGBPortion(CombinerInput(Register.TEXTURE1), color, at, at))
        program = RegisterCombiners((GeneralCombiner(portion, lookup=lookup), shown))
        yield PassState(texture_units=(_MODULATED, _REPLACED), register_combiners=program)


PIXEL_FRAMES = (
    Frame(
        name="pixel-rectangles",
        profile=OPENGL_1_2_IMAGING,
        commands=(*background(), *_rectangles(), *_READ),
    ),
    Frame(
        name="histograms-and-convolved-reading",
        profile=OPENGL_1_2_IMAGING,
        commands=(*background(), *_rectangles(), *_READ_OTHERWISE),
    ),
    Frame(name="copied-textures", profile=GEFORCE_256, commands=(*background(), *_copies())),
    Frame(name="pbuffers", profile=NV2A, commands=(*background(), *_surfaces())),
    Frame(name="accumulation", profile=OPENGL_1_2, commands=(*background(), *_accumulated())),
    _wide("twelve-bits", INFINITE_REALITY, color_bits=12),
    _wide("samples", INFINITE_REALITY, color_bits=8, samples=4),
    _wide("twelve-bits-of-the-octane", OCTANE, color_bits=12),
    _wide("sixteen-bits", GEFORCE_256.with_precision(combiner_bits=16, texture_bits=16, framebuffer_bits=16)),
    _wide("six-bits", GEFORCE_256.with_precision(combiner_bits=7, texture_bits=5, framebuffer_bits=6)),
    Frame(
        name="the-future-board",
        profile=FUTURE,
        commands=(*stores(texture=texture_2d(picture(8, 8, seed=26))), *background(), *patched(_future())),
    ),
)
