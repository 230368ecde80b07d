"""Every feature of the machines as data: which of them have it, the smallest commands that use it, and where
its specification, its implementation and its tests are.

``python -m tests.machines`` makes docs/machines.md of this list. tests/pipeline/validation/test_machines.py
says that ``validate`` accepts a feature's commands exactly where the machine has it, refuses them elsewhere
in a sentence, and that they run. A new feature is one entry here.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from fixedpipe.pipeline.commands import (
    Accum,
    BindTexImage,
    Bitmap,
    CopyPixels,
    CopyTexImage,
    Draw,
    DrawPixels,
    GetTexImage,
    MakeCurrent,
    Mesh,
    ReadPixels,
    TexImage,
)
from fixedpipe.pipeline.enums import (
    AccumOperation,
    BaseFormat,
    BlendEquation,
    BlendFactor,
    ColorBuffer,
    ColorFormat,
    ColorKeyOperation,
    CombineFunction,
    CombineOperand,
    CombinerFunction,
    CombineSource,
    ComparisonFunction,
    ComponentUsage,
    DepthFormat,
    DotProductMapping,
    FogCoordinateSource,
    InternalFormat,
    LightingArithmetic,
    LogicOperation,
    MuxSelect,
    PixelTexGenMode,
    PrimitiveType,
    Register,
    StencilOperation,
    TexelWord,
    TexGenMode,
    TextureCompareMode,
    TextureEnvironmentMode,
    TextureFilter,
    TextureShaderOperation,
    TextureTarget,
    WrapMode,
)
from fixedpipe.pipeline.pixel_transfer import ConvolutionFilter, Histogram, Minmax, PixelImage, PixelTransfer
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.state import (
    IDENTITY,
    Blending,
    ColorKey,
    ColorTable,
    Combine,
    CombinerInput,
    CombinerLookup,
    Composite,
    DepthClamp,
    FinalCombiner,
    Fog,
    FogRegisters,
    GeneralCombiner,
    Light,
    Lighting,
    LineState,
    PassState,
    PixelTexture,
    PointParameters,
    PointState,
    PolygonState,
    RasterPosition,
    RegisterCombiners,
    RGBPortion,
    Sampler,
    Scissor,
    SignedComponents,
    StencilTest,
    TexGen,
    TextureEnvironment,
    TextureShaderStage,
    TextureUnit,
    VertexState,
    WindowClip,
)
from fixedpipe.pipeline.textures.images import texture_2d, texture_cube_map
from fixedpipe.pipeline.textures.words import compressed_texture, paletted_texture, texture_of_words

SIZE = 8  # of the framebuffer in which a feature's commands run, pixels


@dataclass(frozen=True, kw_only=True)
class Feature:
    """Something that a machine may have.

    name            in the words of OpenGL and its extensions
    group           the heading under which docs/machines.md has it
    has             whether a Profile has it
    commands        the smallest frame that uses it, and as little else as it can
    asked           words of a refusal that name what was asked for
    limit           of a Profile that has it: its number, for the page; None: it is there or it is not
    framebuffer     what else ``execute`` and ``validate`` are told (``samples``, ``depth_bits``)
    ideal           whether ``execute_ideal`` evaluates it where the IDEAL profile has it
    reference       modules of tests/reference/ that specify it
    implementation  modules that compute it
    tests           modules that test it
    """

    name: str
    group: str
    has: Callable[[Profile], bool]
    commands: tuple
    asked: str
    limit: Callable[[Profile], object] | None = None
    framebuffer: dict = field(default_factory=dict)
    ideal: bool = True
    reference: tuple[str, ...] = ()
    implementation: tuple[str, ...] = ()
    tests: tuple[str, ...] = ()


# -------------------------------------------------------------------------------- what commands are made of

_CORNERS = np.array([[-1.0, -1.0, 0.0], [3.0, -1.0, 0.0], [-1.0, 3.0, 0.0]])
_COORDINATES = np.array([[0.0, 0.0, 0.5], [1.0, 0.0, 0.5], [0.0, 1.0, 0.5]])
_MESH = Mesh(
    _CORNERS,
    colors=np.array([[0.9, 0.5, 0.1], [0.1, 0.9, 0.5], [0.5, 0.1, 0.9]]),
    normals=np.array([[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [0.0, 0.6, 0.8]]),
    texture_coordinates=(_COORDINATES,),
)
_PICTURE = np.random.Generator(np.random.PCG64(11)).random((4, 4, 4))
_BORDERED = np.random.Generator(np.random.PCG64(12)).random((16, 16, 4))
_NEAREST = Sampler(TextureFilter.NEAREST, TextureFilter.NEAREST)
_LINEAR = Sampler(TextureFilter.LINEAR)
_WORDS = np.arange(16, dtype=np.int64).reshape(4, 4) * 0x10F0F0F
_ON_EDGE = {"wrap_s": WrapMode.CLAMP_TO_EDGE, "wrap_t": WrapMode.CLAMP_TO_EDGE}


def _draw(mesh=_MESH, **state):
    return Draw(label="use", mesh=mesh, state=PassState(**state))


def _store(image, name="texture"):
    return TexImage(label="store", texture=name, image=image)


def _unit(sampler=_NEAREST, **fields):
    return TextureUnit(texture="texture", sampler=sampler, **fields)


def _textured(image=None, unit=None, **state):
    """A texture, and a draw through unit 0's environment."""
    image = texture_2d(_PICTURE) if image is None else image
    return _store(image), _draw(texture_units=(_unit() if unit is None else unit,), **state)


def _combined(**fields):
    return (_draw(register_combiners=replace(RegisterCombiners(), **fields)),)


def _combine(function=CombineFunction.MODULATE, mode=TextureEnvironmentMode.COMBINE, **fields):
    half = Combine(function=function, **fields)
    alpha = Combine(operands=(CombineOperand.SRC_ALPHA,) * 3)
    return _textured(unit=_unit(environment=TextureEnvironment(mode=mode, rgb=half, alpha=alpha)))


def _shaded(*operations, last=None, **fields):
    """A texture shader of these operations on as many units, all of which read one picture, but for the last
    one, which reads ``last``; then the units' environments.
    """
    stages = tuple(TextureShaderStage(operation=operation, **fields) for operation in operations)
    units = (_unit(replace(_LINEAR, **_ON_EDGE)),) * len(stages)
    stores = (_store(texture_2d(_PICTURE)),)
    if last is not None:
        stores += (_store(last, "last"),)
        units = (*units[:-1], replace(units[-1], texture="last"))
    return *stores, _draw(texture_units=units, texture_shader=stages)


def _rough():
    """An offset lookup of one picture by itself, filtered by the roughness that it holds too."""
    *stores, draw = _shaded(_OP.TEXTURE_2D, _OP.OFFSET_TEXTURE_2D)
    flat, rough = draw.state.texture_shader
    stages = flat, replace(rough, roughness=0)
    return *stores, replace(draw, state=replace(draw.state, texture_shader=stages))


def _compared(compare=TextureCompareMode.COMPARE_R_TO_TEXTURE, **fields):
    fields = {"compare_function": ComparisonFunction.LEQUAL, **fields}
    sampler = replace(_NEAREST, compare_mode=compare, **_ON_EDGE, **fields)
    return _textured(texture_of_words(_WORDS, TexelWord.X8_Y24_FIXED), _unit(sampler))


def _generated(mode, axes):
    gen = tuple(TexGen(mode) if axis in axes else TexGen() for axis in "strq")
    image = _CUBE_MAP if "r" in axes else texture_2d(_PICTURE)
    return _textured(image, _unit(gen=gen))


def _copied(**fields):
    return (CopyTexImage(label="use", texture="texture", width=4, height=4, **fields),)


def _moved(**fields):
    """A picture that goes through pixel transfer into a texture."""
    image = PixelImage(_PICTURE, "RGBA")
    return (TexImage(label="use", texture="texture", pixels=image, transfer=PixelTransfer(**fields)),)


_CORNER = RasterPosition((-0.9, -0.9, 0.0, 1.0))
_TABLE = ColorTable(((1.0, 0.0, 0.0, 1.0), (0.0, 0.0, 1.0, 1.0)))
_SHARPEN = ConvolutionFilter((((0.5, 0.5, 0.5, 0.5), (0.5, 0.5, 0.5, 0.5)),) * 2)
_LINE = Mesh(np.array([[-0.9, -0.5, 0.0], [0.9, 0.6, 0.0]]), PrimitiveType.LINES)
_POINT = Mesh(np.zeros((1, 3)), PrimitiveType.POINTS)
_VOLUME = texture_of_words(np.stack([_WORDS] * 4), TexelWord.A8R8G8B8, TextureTarget.TEXTURE_3D)
_CUBE_MAP = texture_cube_map(np.stack([_PICTURE] * 6))
_RECTANGLE = replace(texture_of_words(_WORDS[:3], TexelWord.A8R8G8B8), target=TextureTarget.TEXTURE_RECTANGLE)


def _lit(**fields):
    return (_draw(vertex=VertexState(lighting=Lighting(**{"lights": (Light(),), **fields}))),)


# ------------------------------------------------------------------------------------------- the features

_UNITS = {
    "reference": ("tests/reference/sample.py", "tests/reference/render.py"),
    "implementation": ("raster/portable/unit.py", "raster/vector/unit.py"),
    "tests": ("tests/pipeline/execution/test_machine.py", "tests/pipeline/execution/test_random_states.py"),
}
_SAMPLING = {
    "reference": ("tests/reference/sample.py",),
    "implementation": ("raster/portable/sample.py", "raster/vector/sample.py"),
    "tests": ("tests/raster/test_kernels_match_reference.py", "tests/raster/vector/test_sample.py"),
}
_FORMATS = {
    "reference": ("tests/reference/texel_formats.py", "tests/reference/texel_words.py"),
    "implementation": ("pipeline/textures/images.py", "pipeline/textures/words.py"),
    "tests": ("tests/pipeline/test_texel_words.py",),
}
_ENVIRONMENT = {
    "reference": ("tests/reference/texture_environment.py",),
    "implementation": ("pipeline/programs/texture_environment.py",),
    "tests": ("tests/pipeline/test_texture_environment.py",),
}
_COMBINERS = {
    "reference": ("tests/reference/combine.py",),
    "implementation": ("raster/portable/combine.py", "raster/vector/combine.py"),
    "tests": ("tests/raster/test_kernels_match_reference.py", "tests/raster/vector/test_combine.py"),
}
_SHADERS = {
    "reference": ("tests/reference/texture_shader.py",),
    "implementation": (
        "raster/portable/texture_shader.py",
        "raster/columns/texture_shader.py",
        "raster/columns/real_texture_shader.py",
    ),
    "tests": ("tests/raster/test_texture_shader.py", "tests/pipeline/ideal/test_texture_shader.py"),
}
_VERTICES = {
    "reference": ("tests/reference/vertex.py",),
    "implementation": ("pipeline/vertices/stage.py",),
    "tests": ("tests/pipeline/vertices/test_stage.py",),
}
_STROKES = {
    "reference": ("tests/reference/strokes.py",),
    "implementation": ("raster/primitives/strokes.py", "pipeline/vertices/strokes.py"),
    "tests": ("tests/pipeline/vertices/test_strokes.py",),
}
_FRAGMENTS = {
    "reference": ("tests/reference/per_fragment.py",),
    "implementation": ("raster/portable/per_fragment.py", "raster/vector/per_fragment.py"),
    "tests": ("tests/raster/test_kernels_match_reference.py", "tests/raster/vector/test_per_fragment.py"),
}
_SHADOWS = {
    "reference": ("tests/reference/shadow.py",),
    "implementation": ("raster/portable/shadow.py",),
    "tests": ("tests/raster/test_texture_shader.py", "tests/raster/test_sampling.py"),
}
_TRANSFER = {
    "reference": ("tests/reference/pixel_transfer.py",),
    "implementation": (
        "pipeline/framebuffers/transfer.py",
        "raster/pixel_groups.py",
        "raster/pixels/transfer.py",
    ),
    "tests": ("tests/raster/pixels/test_transfer.py",),
}
_SURFACES = {
    "reference": ("tests/reference/surface.py",),
    "implementation": ("pipeline/framebuffers/framebuffer.py",),
    "tests": ("tests/pipeline/framebuffers/test_surfaces.py",),
}

# Texture shaders with an operation, and what their last stage reads where that is no picture.
_OP = TextureShaderOperation
_PROGRAMS = {
    _OP.CULL_FRAGMENT: (_OP.CULL_FRAGMENT,),
    _OP.PASS_THROUGH: (_OP.PASS_THROUGH,),
    _OP.OFFSET_TEXTURE_2D: (_OP.TEXTURE_2D, _OP.OFFSET_TEXTURE_2D),
    _OP.OFFSET_TEXTURE_2D_SCALE: (_OP.TEXTURE_2D, _OP.OFFSET_TEXTURE_2D_SCALE),
    _OP.DEPENDENT_AR_TEXTURE_2D: (_OP.TEXTURE_2D, _OP.DEPENDENT_AR_TEXTURE_2D),
    _OP.DEPENDENT_GB_TEXTURE_2D: (_OP.TEXTURE_2D, _OP.DEPENDENT_GB_TEXTURE_2D),
    _OP.DOT_PRODUCT_TEXTURE_2D: (_OP.TEXTURE_2D, _OP.DOT_PRODUCT, _OP.DOT_PRODUCT_TEXTURE_2D),
    _OP.DOT_PRODUCT_DEPTH_REPLACE: (_OP.TEXTURE_2D, _OP.DOT_PRODUCT, _OP.DOT_PRODUCT_DEPTH_REPLACE),
    **{
        operation: (_OP.TEXTURE_2D, _OP.DOT_PRODUCT, _OP.DOT_PRODUCT, operation)
        for operation in (
            _OP.DOT_PRODUCT_TEXTURE_3D,
            _OP.DOT_PRODUCT_TEXTURE_CUBE_MAP,
            _OP.DOT_PRODUCT_REFLECT_CUBE_MAP,
            _OP.DOT_PRODUCT_CONST_EYE_REFLECT_CUBE_MAP,
        )
    },
    _OP.BRDF_TEXTURE_3D: (_OP.TEXTURE_2D, _OP.TEXTURE_2D, _OP.BRDF_TEXTURE_3D),
}
_READ_LAST = {
    _OP.DOT_PRODUCT_TEXTURE_3D: _VOLUME,
    _OP.DOT_PRODUCT_TEXTURE_CUBE_MAP: _CUBE_MAP,
    _OP.DOT_PRODUCT_REFLECT_CUBE_MAP: _CUBE_MAP,
    _OP.DOT_PRODUCT_CONST_EYE_REFLECT_CUBE_MAP: _CUBE_MAP,
    _OP.BRDF_TEXTURE_3D: _VOLUME,
}


def _texture_units():
    for number in (2, 4):
        yield Feature(
            name=f"{number} texture units",
            group="Texture units",
            has=lambda p, number=number: p.textures.max_texture_units >= number,
            commands=(_store(texture_2d(_PICTURE)), _draw(texture_units=(_unit(),) * number)),
            asked="texture unit",
            limit=lambda p: p.textures.max_texture_units,
            **_UNITS,
        )
    images = {
        TextureTarget.TEXTURE_3D: (_VOLUME, lambda p: p.textures.max_3d_texture_size),
        TextureTarget.TEXTURE_CUBE_MAP: (
            _CUBE_MAP,
            lambda p: p.textures.max_cube_map_texture_size,
        ),
        TextureTarget.TEXTURE_RECTANGLE: (_RECTANGLE, lambda p: p.textures.max_texture_size),
    }
    for target, (image, limit) in images.items():
        sampler = replace(_NEAREST, **_ON_EDGE)
        yield Feature(
            name=f"{target.name} textures",
            group="Texture units",
            has=lambda p, target=target: target in p.textures.texture_targets,
            commands=_textured(image, _unit(sampler)),
            asked=target.name,
            limit=limit,
            ideal=target is not TextureTarget.TEXTURE_RECTANGLE,
            **_SAMPLING,
        )
    yield Feature(
        name="edge lengths that are no powers of two",
        group="Texture units",
        has=lambda p: not p.textures.power_of_two_textures,
        commands=_textured(texture_2d(_PICTURE[:3])),
        asked="4x3",
        **_SAMPLING,
    )
    for texels in (1, 4):
        yield Feature(
            name=f"textures with a border of {texels}",
            group="Texture units",
            has=lambda p, texels=texels: texels in p.textures.texture_borders,
            commands=_textured(texture_2d(_BORDERED[: 8 + 2 * texels, : 8 + 2 * texels], border=texels)),
            asked=f"a border of {texels}",
            reference=("tests/reference/sample.py",),
            implementation=("pipeline/columns/textures.py", "raster/columns/sample.py"),
            tests=("tests/pipeline/execution/test_borders.py",),
        )
    for mode in (WrapMode.CLAMP_TO_EDGE, WrapMode.CLAMP_TO_BORDER, WrapMode.MIRRORED_REPEAT):
        yield Feature(
            name=f"wrap mode {mode.name}",
            group="Texture units",
            has=lambda p, mode=mode: mode in p.textures.wrap_modes,
            commands=_textured(unit=_unit(replace(_NEAREST, wrap_s=mode))),
            asked=mode.name,
            **_SAMPLING,
        )
    yield Feature(
        name="level of detail bias (EXT_texture_lod_bias)",
        group="Texture units",
        has=lambda p: p.textures.max_lod_bias >= 1,
        commands=_textured(texture_2d(_PICTURE, mipmaps=True), _unit(Sampler(), lod_bias=1.0)),
        asked="bias",
        limit=lambda p: f"{p.textures.max_lod_bias:g}",
        reference=("tests/reference/sample.py",),
        implementation=("raster/portable/level_of_detail.py", "raster/vector/level_of_detail.py"),
        tests=("tests/raster/vector/test_level_of_detail.py",),
    )
    yield Feature(
        name="the base level of a texture's levels (SGIS_texture_lod)",
        group="Texture units",
        has=lambda p: True,
        commands=_textured(texture_2d(_PICTURE, mipmaps=True), _unit(Sampler(base_level=1))),
        asked="base level",
        reference=("tests/reference/sample.py",),
        implementation=("pipeline/textures/sampled.py",),
        tests=("tests/pipeline/execution/test_base_levels.py",),
    )
    for operation in ColorKeyOperation:
        yield Feature(
            name=f"color keys with operation {operation.name}",
            group="Texture units",
            has=lambda p, operation=operation: operation in p.textures.color_key_operations,
            commands=_textured(unit=_unit(color_key=ColorKey((0.0,) * 4, operation))),
            asked=operation.name,
            reference=("tests/reference/color_key.py",),
            implementation=("pipeline/textures/sampled.py", "pipeline/columns/engine.py"),
            tests=("tests/pipeline/execution/test_color_keys.py",),
        )
    yield Feature(
        name="anisotropic filtering (EXT_texture_filter_anisotropic)",
        group="Texture units",
        has=lambda p: p.textures.max_anisotropy > 1,
        commands=_textured(texture_2d(_PICTURE, mipmaps=True), _unit(Sampler(max_anisotropy=2.0))),
        asked="anisotropy 2",
        limit=lambda p: f"{p.textures.max_anisotropy:g}",
        reference=("tests/reference/sample.py",),
        implementation=("raster/portable/anisotropic.py",),
        tests=("tests/raster/test_anisotropic.py",),
    )
    yield Feature(
        name="footprint assembly",
        group="Texture units",
        has=lambda p: p.textures.max_probes > 1,
        commands=_textured(texture_2d(_PICTURE, mipmaps=True), _unit(Sampler(max_probes=2))),
        asked="2 probes",
        limit=lambda p: f"{p.textures.max_probes} probes",
        reference=("tests/reference/sample.py",),
        implementation=("raster/portable/footprint.py", "raster/columns/interpolate.py"),
        tests=("tests/raster/test_sampling.py",),
    )
    yield Feature(
        name="footprint assembly with any number of probes",
        group="Texture units",
        has=lambda p: p.textures.exact_probes,
        commands=_textured(
            texture_2d(_PICTURE, mipmaps=True), _unit(Sampler(max_probes=3, exact_probes=True))
        ),
        asked="exact_probes",
        limit=lambda p: f"{p.textures.max_probes} probes",
        reference=("tests/reference/sample.py",),
        implementation=("raster/portable/footprint.py", "raster/columns/interpolate.py"),
        tests=("tests/raster/test_sampling.py",),
    )
    yield Feature(
        name="texture wrapping of triangles (cylinder_wrap)",
        group="Texture units",
        has=lambda p: p.textures.cylinder_wrap,
        commands=_textured(unit=_unit(cylinder_wrap=(True, False, False, False))),
        asked="wrap",
        **_UNITS,
    )
    yield Feature(
        name="coordinates linear on the screen (PERSPECTIVE_CORRECTION_HINT)",
        group="Texture units",
        has=lambda p: p.primitives.perspective_hint,
        commands=_textured(perspective_correction=False),
        asked="perspective",
        **_UNITS,
    )
    yield Feature(
        name="signed components (NV_texture_shader's signed formats)",
        group="Texture units",
        has=lambda p: p.textures.signed_components,
        commands=_textured(unit=_unit(replace(_NEAREST, signed_components=SignedComponents(red=True)))),
        asked="signed",
        ideal=False,
        **_SAMPLING,
    )
    yield Feature(
        name="color table of texels (SGI_texture_color_table)",
        group="Texture units",
        has=lambda p: p.textures.texture_color_table,
        commands=_textured(unit=_unit(color_table=_TABLE)),
        asked="color_table",
        **_TRANSFER,
    )
    for mode, axes in (
        (TexGenMode.SPHERE_MAP, "st"),
        (TexGenMode.NORMAL_MAP, "str"),
        (TexGenMode.REFLECTION_MAP, "str"),
    ):
        yield Feature(
            name=f"coordinate generation {mode.name}",
            group="Texture units",
            has=lambda p, mode=mode: mode in p.vertices.texgen_modes,
            commands=_generated(mode, axes),
            asked=mode.name if mode is TexGenMode.SPHERE_MAP else "TEXTURE_CUBE_MAP",
            **_VERTICES,
        )


def _formats():
    yield Feature(
        name="twelve bits a component (RGBA12)",
        group="Texture formats",
        has=lambda p: InternalFormat.RGBA12 in p.textures.internal_formats,
        commands=_textured(texture_2d(_PICTURE, InternalFormat.RGBA12)),
        asked="RGBA12",
        **_FORMATS,
    )
    samples = {
        "paletted textures (COLOR_INDEX8)": (
            InternalFormat.COLOR_INDEX8,
            paletted_texture([_WORDS & 3], [0xFF00FF00, 0xFFFF0000, 0xFF0000FF, 0xFFFFFFFF]),
        ),
        "components of sixteen bits (HILO16)": (
            InternalFormat.HILO16,
            texture_of_words(_WORDS, TexelWord.R16B16),
        ),
        "signed offsets, words V8U8 (DSDT8)": (
            InternalFormat.DSDT8,
            texture_of_words(_WORDS, TexelWord.V8U8),
        ),
        "signed offsets and a magnitude, words L6V5U5 and X8L8V8U8 (DSDT8_MAG8)": (
            InternalFormat.DSDT8_MAG8,
            texture_of_words(_WORDS, TexelWord.L6V5U5),
        ),
        "signed colours, words Q8W8V8U8 (SIGNED_RGBA8)": (
            InternalFormat.SIGNED_RGBA8,
            texture_of_words(_WORDS, TexelWord.Q8W8V8U8),
        ),
        "signed components of sixteen bits, words V16U16 (SIGNED_HILO16)": (
            InternalFormat.SIGNED_HILO16,
            texture_of_words(_WORDS, TexelWord.V16U16),
        ),
        "compressed textures (S3TC)": (
            InternalFormat.COMPRESSED_RGBA_S3TC_DXT1,
            compressed_texture(bytes(range(8)), InternalFormat.COMPRESSED_RGBA_S3TC_DXT1, 4, 4),
        ),
        "video (YCBCR)": (InternalFormat.YCBCR, texture_of_words(_WORDS & 0xFFFF, TexelWord.YUY2)),
    }
    for name, (internal_format, image) in samples.items():
        yield Feature(
            name=name,
            group="Texture formats",
            has=lambda p, f=internal_format: f in p.textures.internal_formats,
            commands=(_store(image),),
            asked=internal_format.name,
            **_FORMATS,
        )
    yield Feature(
        name="depth textures (SGIX_depth_texture, ARB_depth_texture)",
        group="Texture formats",
        has=lambda p: InternalFormat.DEPTH_COMPONENT24 in p.textures.internal_formats,
        commands=(_store(texture_of_words(_WORDS, TexelWord.X8_Y24_FIXED)),),
        asked="DEPTH_COMPONENT24",
        **_FORMATS,
    )


def _shadows():
    compare = TextureCompareMode
    yield Feature(
        name="shadow comparison (SGIX_shadow, ARB_shadow)",
        group="Shadow maps",
        has=lambda p: compare.COMPARE_R_TO_TEXTURE in p.textures.texture_compare_modes,
        commands=_compared(compare_function=ComparisonFunction.GEQUAL),
        asked="DEPTH_COMPONENT24",
        **_SHADOWS,
    )
    yield Feature(
        name="comparison with zero (COMPARE_ZERO_TO_TEXTURE)",
        group="Shadow maps",
        has=lambda p: compare.COMPARE_ZERO_TO_TEXTURE in p.textures.texture_compare_modes,
        commands=_compared(compare.COMPARE_ZERO_TO_TEXTURE),
        asked="DEPTH_COMPONENT24|COMPARE_ZERO_TO_TEXTURE",
        **_SHADOWS,
    )
    yield Feature(
        name="all eight comparisons (EXT_shadow_funcs)",
        group="Shadow maps",
        has=lambda p: ComparisonFunction.NEVER in p.textures.shadow_functions,
        commands=_compared(compare_function=ComparisonFunction.NEVER),
        asked="DEPTH_COMPONENT24|NEVER",
        **_SHADOWS,
    )
    yield Feature(
        name="shadow ambient (SGIX_shadow_ambient)",
        group="Shadow maps",
        has=lambda p: p.textures.shadow_ambient,
        commands=_compared(compare_fail_value=0.5),
        asked="DEPTH_COMPONENT24|shadow ambient",
        **_SHADOWS,
    )
    yield Feature(
        name="depths as colors, without a comparison (ARB_depth_texture)",
        group="Shadow maps",
        has=lambda p: p.textures.depths_as_colors,
        commands=_compared(compare.NONE),
        asked="DEPTH_COMPONENT24|by comparing alone",
        reference=("tests/reference/shadow.py",),
        implementation=("pipeline/textures/depths_as_colors.py",),
        tests=("tests/raster/test_sampling.py",),
    )
    for mode in (BaseFormat.LUMINANCE, BaseFormat.INTENSITY, BaseFormat.ALPHA):
        yield Feature(
            name=f"DEPTH_TEXTURE_MODE {mode.name} (ARB_depth_texture)",
            group="Shadow maps",
            has=lambda p, mode=mode: mode in p.textures.depth_texture_modes,
            commands=_compared(depth_texture_mode=mode),
            asked=f"DEPTH_COMPONENT24|{mode.name}",
            **_SHADOWS,
        )


def _environments():
    modes = TextureEnvironmentMode
    for mode in (modes.ADD, modes.COMBINE, modes.COMBINE4, modes.NONE):
        four = (CombineSource.TEXTURE, CombineSource.PREVIOUS) * 2
        halves = {}
        if mode is modes.COMBINE4:
            halves = {
                "rgb": Combine(CombineFunction.ADD, four, (CombineOperand.SRC_COLOR,) * 4),
                "alpha": Combine(CombineFunction.ADD, four, (CombineOperand.SRC_ALPHA,) * 4),
            }
        yield Feature(
            name=f"environment {mode.name}",
            group="Texture environments",
            has=lambda p, mode=mode: mode in p.combiners.texture_environment_modes,
            commands=_textured(unit=_unit(environment=TextureEnvironment(mode=mode, **halves))),
            asked=mode.name,
            **_ENVIRONMENT,
        )
    for function in (CombineFunction.SUBTRACT, CombineFunction.DOT3_RGB, CombineFunction.DOT3_RGBA):
        yield Feature(
            name=f"COMBINE's {function.name}",
            group="Texture environments",
            has=lambda p, function=function: function in p.combiners.combine_functions,
            commands=_combine(function),
            asked=f"{function.name}|COMBINE",
            **_ENVIRONMENT,
        )
    yield Feature(
        name="other units' texels (ARB_texture_env_crossbar, NV_texture_env_combine4)",
        group="Texture environments",
        has=lambda p: (
            p.combiners.texture_environment_crossbar
            or TextureEnvironmentMode.COMBINE4 in p.combiners.texture_environment_modes
        ),
        commands=_combine(sources=(CombineSource.TEXTURE0, CombineSource.PREVIOUS, CombineSource.CONSTANT)),
        asked="TEXTURE0|COMBINE",
        **_ENVIRONMENT,
    )


def _combiners():
    for number in (1, 2, 8):
        yield Feature(
            name=f"{number} general combiner{'s' * (number > 1)} (NV_register_combiners)",
            group="Register combiners",
            has=lambda p, number=number: p.combiners.max_general_combiners >= number,
            commands=_combined(general=(GeneralCombiner(),) * number),
            asked="combiner",
            limit=lambda p: p.combiners.max_general_combiners,
            **_COMBINERS,
        )
    yield Feature(
        name="constants of each stage (NV_register_combiners2)",
        group="Register combiners",
        has=lambda p: p.combiners.per_stage_constants,
        commands=_combined(general=(GeneralCombiner(constant_color0=(0.5, 0.5, 0.5, 0.5)),)),
        asked="constant|register combiners",
        **_COMBINERS,
    )
    yield Feature(
        name="blue to alpha",
        group="Register combiners",
        has=lambda p: p.combiners.blue_to_alpha,
        commands=_combined(
            general=(GeneralCombiner(rgb=RGBPortion(ab_output=Register.SPARE1, ab_blue_to_alpha=True)),)
        ),
        asked="blue|register combiners",
        **_COMBINERS,
    )
    yield Feature(
        name="blue as the final combiner's alpha",
        group="Register combiners",
        has=lambda p: p.combiners.final_alpha_from_blue,
        commands=_combined(
            final=FinalCombiner(g=CombinerInput(Register.PRIMARY_COLOR, usage=ComponentUsage.BLUE))
        ),
        asked="G takes BLUE|register combiners",
        **_COMBINERS,
    )
    yield Feature(
        name="muxes by the lowest bit, inverted color sum",
        group="Register combiners",
        has=lambda p: p.combiners.combiner_flags,
        commands=_combined(mux_select=MuxSelect.LSB),
        asked="mux|register combiners",
        **_COMBINERS,
    )

    yield Feature(
        name="texels of Y, Cb and Cr become RGB before they are combined",
        group="Register combiners",
        has=lambda p: p.combiners.ycbcr_conversion,
        commands=(_draw(ycbcr_conversion=True),),
        asked="YCbCr conversion|ycbcr_conversion",
        reference=("tests/reference/render.py", "tests/reference/texel_words.py"),
        implementation=("raster/portable/unit.py",),
        tests=("tests/raster/test_ycbcr.py", "tests/conformance/test_conformance.py"),
    )


def _future():
    where = {
        "reference": ("tests/reference/future.py",),
        "implementation": ("raster/columns/future.py", "pipeline/columns/engine.py"),
        "tests": ("tests/raster/columns/test_future.py",),
    }
    for function in CombinerFunction:
        if function is not CombinerFunction.NONE:
            yield Feature(
                name=f"combiner function {function.name}",
                group="What the papers ask for",
                has=lambda p, function=function: function in p.combiners.combiner_functions,
                commands=_combined(general=(GeneralCombiner(rgb=RGBPortion(function=function)),)),
                asked=f"{function.name}|register combiners",
                **where,
            )
    lookup = RegisterCombiners((GeneralCombiner(lookup=CombinerLookup(0)),))
    yield Feature(
        name="texture lookups after general combiners",
        group="What the papers ask for",
        has=lambda p: p.combiners.combiner_lookup,
        commands=_textured(register_combiners=lookup),
        asked="lookup|register combiners",
        **where,
    )
    yield Feature(
        name="combiners evaluated before textures are filtered",
        group="What the papers ask for",
        has=lambda p: p.textures.evaluate_before_filtering,
        commands=_textured(
            unit=_unit(_LINEAR), register_combiners=RegisterCombiners(), evaluate_before_filtering=True
        ),
        asked="evaluates combiners after|register combiners",
        **where,
    )
    for name, commands in (
        ("colours", (_draw(spherical_primary_color=True),)),
        ("texture coordinates", _textured(unit=_unit(spherical_coordinates=True))),
    ):
        yield Feature(
            name=f"{name} along arcs (spherical interpolation)",
            group="What the papers ask for",
            has=lambda p: p.primitives.spherical_interpolation,
            commands=commands,
            asked="along arcs",
            **where,
        )


def _shaders():
    for operation, program in _PROGRAMS.items():
        yield Feature(
            name=operation.name,
            group="Texture shaders",
            has=lambda p, needed=frozenset(program): needed <= p.texture_shaders.texture_shader_operations,
            commands=_shaded(*program, last=_READ_LAST.get(operation)),
            asked=f"{operation.name}|texture shaders|texture unit|DOT_PRODUCT|TEXTURE_3D|TEXTURE_CUBE_MAP",
            ideal=False,
            **_SHADERS,
        )
    yield Feature(
        name="2D textures read as cube maps, cube maps as volumes",
        group="Texture shaders",
        has=lambda p: p.texture_shaders.foreign_texture_targets,
        commands=_shaded(_OP.TEXTURE_CUBE_MAP),
        asked="texture shaders|TEXTURE_2D|TEXTURE_CUBE_MAP",
        ideal=False,
        **_SHADERS,
    )
    yield Feature(
        name="signed dot products (SIGNED_IDENTITY)",
        group="Texture shaders",
        has=lambda p: DotProductMapping.SIGNED_IDENTITY in p.texture_shaders.dot_product_mappings,
        commands=_shaded(
            _OP.TEXTURE_2D,
            _OP.DOT_PRODUCT,
            _OP.DOT_PRODUCT_TEXTURE_2D,
            dot_product_mapping=DotProductMapping.SIGNED_IDENTITY,
        ),
        asked="texture shaders|texture unit|DOT_PRODUCT|SIGNED_IDENTITY",
        ideal=False,
        **_SHADERS,
    )
    yield Feature(
        name="lookups filtered by roughness (OFFSET_TEXTURE_2D)",
        group="Texture shaders",
        has=lambda p: p.texture_shaders.roughness_lookups,
        commands=_rough(),
        asked="roughness|texture shaders|texture unit|OFFSET_TEXTURE_2D",
        ideal=False,
        reference=("tests/reference/roughness.py",),
        implementation=(
            "raster/portable/roughness.py",
            "raster/columns/texture_shader.py",
            "raster/columns/real_texture_shader.py",
        ),
        tests=("tests/raster/test_roughness.py",),
    )


def _vertices():
    yield Feature(
        name="more than 8 lights",
        group="Vertices",
        has=lambda p: p.vertices.max_lights >= 9,
        commands=_lit(lights=(Light(),) * 9),
        asked="light",
        limit=lambda p: p.vertices.max_lights,
        **_VERTICES,
    )
    yield Feature(
        name="more than 6 clip planes",
        group="Vertices",
        has=lambda p: p.vertices.max_clip_planes >= 7,
        commands=(_draw(vertex=VertexState(clip_planes=((0.0, 0.0, 0.0, 1.0),) * 7)),),
        asked="clip plane",
        limit=lambda p: p.vertices.max_clip_planes,
        **_VERTICES,
    )
    yield Feature(
        name="separate specular color",
        group="Vertices",
        has=lambda p: p.vertices.separate_specular_color,
        commands=_lit(separate_specular_color=True),
        asked="SEPARATE_SPECULAR_COLOR",
        **_VERTICES,
    )
    yield Feature(
        name="lights with a range (a lighting unit)",
        group="Vertices",
        has=lambda p: p.arithmetic.lighting is LightingArithmetic.LIGHTING_UNIT,
        commands=_lit(lights=(Light(position=(0.0, 0.0, 1.0, 1.0), range=9.0),)),
        asked="range",
        reference=("tests/reference/lighting_unit.py",),
        implementation=("pipeline/vertices/lighting_unit.py",),
        tests=("tests/pipeline/vertices/test_stage.py",),
    )
    yield Feature(
        name="secondary color (EXT_secondary_color)",
        group="Vertices",
        has=lambda p: p.fragments.color_sum,
        commands=(_draw(color_sum=True),),
        asked="color sum",
        **_FRAGMENTS,
    )
    yield Feature(
        name="fog coordinate (EXT_fog_coord)",
        group="Vertices",
        has=lambda p: p.vertices.fog_coordinate,
        commands=(_draw(fog=Fog(coordinate_source=FogCoordinateSource.FOG_COORDINATE)),),
        asked="FOG_COORDINATE",
        reference=("tests/reference/fog.py",),
        implementation=("pipeline/vertices/fog.py",),
        tests=("tests/pipeline/vertices/test_stage.py", "tests/pipeline/execution/test_machine.py"),
    )
    yield Feature(
        name="fog registers",
        group="Vertices",
        has=lambda p: p.fragments.fog_registers,
        commands=(_draw(fog=Fog(registers=FogRegisters())),),
        asked="FogRegisters",
        reference=("tests/reference/fog.py",),
        implementation=("pipeline/vertices/fog.py",),
        tests=("tests/pipeline/vertices/test_stage.py",),
    )
    yield Feature(
        name="composite matrix",
        group="Vertices",
        has=lambda p: p.vertices.composite_matrix,
        commands=(_draw(vertex=VertexState(composite=Composite())),),
        asked="Composite",
        **_VERTICES,
    )
    yield Feature(
        name="vertex weighting (EXT_vertex_weighting)",
        group="Vertices",
        has=lambda p: p.vertices.vertex_weighting,
        commands=(_draw(vertex=VertexState(modelview1=IDENTITY)),),
        asked="vertex weighting",
        reference=("tests/reference/vertex.py", "tests/reference/lighting_unit.py"),
        implementation=("pipeline/vertices/weighting.py",),
        tests=("tests/pipeline/vertices/test_stage.py",),
    )


def _rasterization():
    yield Feature(
        name="line stipple",
        group="Points and lines",
        has=lambda p: p.primitives.line_stipple,
        commands=(_draw(_LINE, line=LineState(stipple=(1, 0x5555))),),
        asked="polygons|stipple",
        **_STROKES,
    )
    yield Feature(
        name="smooth lines and polygons (LINE_SMOOTH, POLYGON_SMOOTH)",
        group="Points and lines",
        has=lambda p: bool(p.primitives.smoothing_samples),
        commands=(_draw(polygon=PolygonState(smooth=True)),),
        asked="smooth",
        reference=("tests/reference/render.py",),
        implementation=("raster/portable/draw.py", "pipeline/native/pack_fragments.py"),
        tests=("tests/pipeline/execution/test_random_states.py",),
    )
    yield Feature(
        name="point parameters (EXT_point_parameters)",
        group="Points and lines",
        has=lambda p: p.vertices.point_parameters,
        commands=(_draw(_POINT, point=PointState(parameters=PointParameters())),),
        asked="point parameters|polygons",
        **_STROKES,
    )
    yield Feature(
        name="point sprites (NV_point_sprite)",
        group="Points and lines",
        has=lambda p: bool(p.primitives.point_sprite_units),
        commands=(_draw(_POINT, point=PointState(sprite=True)),),
        asked="point sprites|polygons",
        limit=lambda p: f"unit {min(p.primitives.point_sprite_units)}",
        **_STROKES,
    )
    yield Feature(
        name="points and lines of 64 pixels",
        group="Points and lines",
        has=lambda p: min(p.primitives.max_point_size, p.primitives.max_line_width) >= 64,
        commands=(_draw(_POINT, point=PointState(size=64.0)),),
        asked="point size|polygons",
        limit=lambda p: f"{p.primitives.max_point_size:g}",
        **_STROKES,
    )


def _fragments():
    yield Feature(
        name="window rectangles",
        group="Fragments",
        has=lambda p: p.fragments.max_window_rectangles > 0,
        commands=(_draw(window_clip=WindowClip((Scissor(1, 1, 4, 4),))),),
        asked="rectangle",
        limit=lambda p: p.fragments.max_window_rectangles,
        **_STROKES,
    )
    yield Feature(
        name="depth clamp (NV_depth_clamp)",
        group="Fragments",
        has=lambda p: p.fragments.depth_clamp,
        commands=(_draw(depth_clamp=DepthClamp()),),
        asked="DEPTH_CLAMP",
        reference=("tests/reference/depth.py",),
        implementation=("raster/portable/interpolate.py",),
        tests=("tests/pipeline/execution/test_machine.py", "tests/conformance/test_conformance.py"),
    )
    yield Feature(
        name="W buffering",
        group="Fragments",
        has=lambda p: p.fragments.w_buffering,
        commands=(_draw(w_buffering=True),),
        asked="W buffering",
        reference=("tests/reference/depth.py",),
        implementation=("raster/portable/interpolate.py",),
        tests=("tests/pipeline/execution/test_machine.py", "tests/conformance/test_conformance.py"),
    )
    for operation in (StencilOperation.INCR_WRAP, StencilOperation.DECR_WRAP):
        yield Feature(
            name=f"stencil operation {operation.name} (EXT_stencil_wrap)",
            group="Fragments",
            has=lambda p, operation=operation: operation in p.fragments.stencil_operations,
            commands=(_draw(stencil_test=StencilTest(depth_pass=operation)),),
            asked=operation.name,
            **_FRAGMENTS,
        )
    for equation in BlendEquation:
        if equation is not BlendEquation.FUNC_ADD:
            yield Feature(
                name=f"blend equation {equation.name}",
                group="Fragments",
                has=lambda p, equation=equation: equation in p.fragments.blend_equations,
                commands=(_draw(blending=Blending(equation=equation)),),
                asked=equation.name,
                **_FRAGMENTS,
            )
    yield Feature(
        name="constant blend factors (EXT_blend_color)",
        group="Fragments",
        has=lambda p: BlendFactor.CONSTANT_COLOR in p.fragments.blend_factors_source,
        commands=(_draw(blending=Blending(BlendFactor.CONSTANT_COLOR)),),
        asked="CONSTANT_COLOR",
        **_FRAGMENTS,
    )
    yield Feature(
        name="SRC_COLOR as source factor (the source times itself)",
        group="Fragments",
        has=lambda p: BlendFactor.SRC_COLOR in p.fragments.blend_factors_source,
        commands=(_draw(blending=Blending(BlendFactor.SRC_COLOR)),),
        asked="SRC_COLOR",
        **_FRAGMENTS,
    )
    yield Feature(
        name="logic operations",
        group="Fragments",
        has=lambda p: p.fragments.logic_op,
        commands=(_draw(logic_op=LogicOperation.XOR),),
        asked="logic operation",
        ideal=False,
        **_FRAGMENTS,
    )


def _pixels():
    table = {"color_table": _TABLE}
    yield Feature(
        name="color tables",
        group="Pixel transfer",
        has=lambda p: p.pixels.color_tables,
        commands=_moved(**table),
        asked="color_table",
        limit=lambda p: p.pixels.max_color_table_size,
        **_TRANSFER,
    )
    yield Feature(
        name="convolution",
        group="Pixel transfer",
        has=lambda p: p.pixels.convolution,
        commands=(ReadPixels(label="use", name="pixels", transfer=PixelTransfer(convolution_2d=_SHARPEN)),),
        asked="convol",
        limit=lambda p: p.pixels.max_convolution_size,
        **_TRANSFER,
    )
    yield Feature(
        name="GetTexImage through pixel transfer",
        group="Pixel transfer",
        has=lambda p: p.pixels.transfers_texture_queries,
        commands=(
            _store(texture_2d(_PICTURE)),
            GetTexImage(
                label="use", name="pixels", texture="texture", transfer=PixelTransfer(bias=(0.5,) * 4)
            ),
        ),
        asked="pixel transfer",
        reference=("tests/reference/transfer.py",),
        implementation=("pipeline/framebuffers/texture_queries.py",),
        tests=("tests/pipeline/framebuffers/test_texture_queries.py",),
    )
    swap = ((0.0, 0.0, 1.0, 0.0), (0.0, 1.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))
    yield Feature(
        name="color matrix",
        group="Pixel transfer",
        has=lambda p: p.pixels.color_matrix,
        commands=_moved(color_matrix=swap),
        asked="color_matrix",
        **_TRANSFER,
    )
    yield Feature(
        name="histogram",
        group="Pixel transfer",
        has=lambda p: p.pixels.histogram,
        commands=_moved(histogram=Histogram("counts")),
        asked="histogram",
        **_TRANSFER,
    )
    yield Feature(
        name="minmax",
        group="Pixel transfer",
        has=lambda p: p.pixels.histogram,
        commands=_moved(minmax=Minmax("bounds")),
        asked="minmax",
        **_TRANSFER,
    )


def _rectangles():
    drawn = DrawPixels(label="use", image=PixelImage(_PICTURE, "RGBA"), position=_CORNER)
    where = {
        "reference": ("tests/reference/pixel_rectangles.py", "tests/reference/pixel_texture.py"),
        "implementation": ("pipeline/columns/rectangles.py", "raster/pixels/rectangles.py"),
        "tests": ("tests/raster/pixels/test_rectangles.py",),
    }
    for name, command in (
        ("DrawPixels", drawn),
        ("PixelZoom", replace(drawn, zoom=(-1.5, 2.0))),
        ("CopyPixels", CopyPixels(label="use", width=4, height=4, position=_CORNER)),
        ("Bitmap", Bitmap(label="use", bits=_PICTURE[..., 0] > 0.5, position=_CORNER)),
    ):
        yield Feature(
            name=name,
            group="Rectangles of pixels",
            has=lambda p: True,
            commands=(command,),
            asked="-",
            **where,
        )
    store = _store(_VOLUME)
    state = PassState(texture_units=(_unit(replace(_NEAREST, **_ON_EDGE)),))
    for name, has, texture in (
        ("SGIX_pixel_texture", lambda p: p.pixels.pixel_texture, PixelTexture(PixelTexGenMode.RGB)),
        ("SGIS_pixel_texture", lambda p: p.pixels.pixel_texture_sgis, PixelTexture(None)),
        ("SGIX_impact_pixel_texture", lambda p: p.pixels.impact_pixel_texture, PixelTexture(volumes=2)),
    ):
        yield Feature(
            name=f"pixel textures ({name})",
            group="Rectangles of pixels",
            has=has,
            commands=(store, replace(drawn, state=state, pixel_texture=texture)),
            asked="pixel_texture|TEXTURE_3D",
            **where,
        )


def _framebuffers():
    for bits in (8, 12):
        yield Feature(
            name=f"{bits} bits a component",
            group="Framebuffers",
            has=lambda p, bits=bits: bits in p.framebuffers.color_bits,
            commands=(_draw(),),
            asked=f"{bits} bits a component",
            ideal=False,
            framebuffer={"color_bits": bits},
            reference=("tests/reference/fixed.py", "tests/reference/combine.py"),
            implementation=("raster/columns/numbers.py", "pipeline/columns/engine.py"),
            tests=("tests/raster/columns/test_engine.py",),
        )
    yield Feature(
        name="accumulation buffer",
        group="Framebuffers",
        has=lambda p: p.framebuffers.accumulation_bits > 0,
        commands=(_draw(), Accum(label="use", operation=AccumOperation.LOAD)),
        asked="accumulation",
        limit=lambda p: f"{p.framebuffers.accumulation_bits} bits",
        reference=("tests/reference/accumulation.py",),
        implementation=("raster/pixels/accumulation.py", "pipeline/framebuffers/accumulation.py"),
        tests=("tests/raster/pixels/test_accumulation.py",),
    )
    yield Feature(
        name="auxiliary buffers",
        group="Framebuffers",
        has=lambda p: p.framebuffers.auxiliary_buffers > 0,
        commands=(_draw(draw_buffer=ColorBuffer.AUX0),),
        asked="AUX0|auxiliary",
        limit=lambda p: p.framebuffers.auxiliary_buffers,
        reference=("tests/reference/render.py",),
        implementation=("pipeline/framebuffers/framebuffer.py",),
        tests=("tests/raster/pixels/test_accumulation.py",),
    )
    for samples in (2, 4, 8):
        yield Feature(
            name=f"{samples} samples in a pixel",
            group="Framebuffers",
            has=lambda p, samples=samples: samples in p.framebuffers.samples,
            commands=(_draw(),),
            asked=f"{samples} samples",
            framebuffer={"samples": samples},
            reference=("tests/reference/multisample.py",),
            implementation=("pipeline/framebuffers/multisample.py",),
            tests=("tests/pipeline/framebuffers/test_multisample.py",),
        )
    for bits in (DepthFormat.FIXED_16, DepthFormat.FIXED_23, DepthFormat.FIXED_24, DepthFormat.FLOAT_24):
        yield Feature(
            name=f"depth buffer {bits.name}",
            group="Framebuffers",
            has=lambda p, bits=bits: bits in p.framebuffers.depth_bits,
            commands=(_draw(),),
            asked=bits.name if bits < 0 else f"{int(bits)} bits of depth",
            framebuffer={"depth_bits": bits},
            reference=("tests/reference/depth.py",),
            implementation=("pipeline/textures/depth_words.py",),
            tests=("tests/pipeline/execution/test_random_states.py",),
        )
    for color_format in (ColorFormat.A8R8G8B8, ColorFormat.R5G6B5):
        make = MakeCurrent(label="make", surface="s", width=8, height=8, color_format=color_format)
        read = InternalFormat.RGBA8 if color_format is ColorFormat.A8R8G8B8 else InternalFormat.R5_G6_B5
        yield Feature(
            name=f"pbuffers of {color_format.name}",
            group="Framebuffers",
            has=lambda p, color_format=color_format: color_format in p.framebuffers.surface_formats,
            commands=(
                make,
                _draw(),
                BindTexImage(label="use", texture="t", surface="s", internal_format=read),
            ),
            asked="pbuffers|surface format",
            ideal=False,
            **_SURFACES,
        )
    yield Feature(
        name="one depth buffer for several framebuffers",
        group="Framebuffers",
        has=lambda p: p.framebuffers.shared_depth,
        commands=(MakeCurrent(label="use", surface="s", width=8, height=4, shares_depth=True), _draw()),
        asked="pbuffers|its own depths",
        ideal=False,
        reference=("tests/support/run_reference.py",),
        implementation=("pipeline/execution/machine.py", "pipeline/framebuffers/framebuffer.py"),
        tests=("tests/pipeline/framebuffers/test_shared_depths.py", "tests/foreign/test_wine_window.py"),
    )


FEATURES = tuple(
    feature
    for group in (
        _texture_units,
        _formats,
        _shadows,
        _environments,
        _combiners,
        _future,
        _shaders,
        _vertices,
        _rasterization,
        _fragments,
        _pixels,
        _rectangles,
        _framebuffers,
    )
    for feature in group()
)
