"""Frames of filters, mipmaps, wrap modes, formats, cube maps, volumes, footprints and shadow maps."""

from dataclasses import replace

from fixedpipe.pipeline.enums import (
    ComparisonFunction,
    InternalFormat,
    TexelWord,
    TexGenMode,
    TextureCompareMode,
    TextureEnvironmentMode,
    TextureFilter,
    TextureShaderOperation,
    WrapMode,
)
from fixedpipe.pipeline.profiles import GEFORCE_3, GEFORCE_256, NV2A, SCHILLING, TEXRAM
from fixedpipe.pipeline.selftest.frame import Frame, background, patched, stores
from fixedpipe.pipeline.selftest.shapes import picture, values
from fixedpipe.pipeline.state import (
    PassState,
    Sampler,
    SignedComponents,
    TexGen,
    TextureEnvironment,
    TextureShaderStage,
    TextureUnit,
)
from fixedpipe.pipeline.textures.images import texture_1d, texture_2d, texture_3d, texture_cube_map
from fixedpipe.pipeline.textures.words import compressed_texture, paletted_texture, texture_of_words

_REPLACE = TextureEnvironment(TextureEnvironmentMode.REPLACE)
_FILTERS = tuple(TextureFilter)
_WRAPS = (WrapMode.REPEAT, WrapMode.CLAMP, WrapMode.CLAMP_TO_EDGE, WrapMode.CLAMP_TO_BORDER)
# Coordinates that run at two rates: levels 0 to 3 of a texture of 32 texels an edge, and long footprints.
_FAR = ((0.4, 0.0, 0.0, 0.0), (0.3, 1.4, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))
# Comparisons take r in the units of the depth texture's words, as the chip does.
_IN_UNITS = (*_FAR[:2], (0.0, 0.0, 2.0**24, 0.0), _FAR[3])
_EDGE = {name: WrapMode.CLAMP_TO_EDGE for name in ("wrap_s", "wrap_t", "wrap_r")}


def _unit(sampler, texture="texture", **fields):
    return TextureUnit(texture, sampler, **({"environment": _REPLACE} | fields))


def _drawn(units):
    return patched(PassState(texture_units=(unit,)) for unit in units)


def _filtered():
    """Every filter over distant levels, with biases and limits, then anisotropy."""
    for number, kind in enumerate(_FILTERS):
        yield _unit(Sampler(kind), matrix=_FAR, lod_bias=(number - 2) / 4.0)
    yield _unit(Sampler(TextureFilter.LINEAR_MIPMAP_LINEAR, max_anisotropy=2.0), matrix=_FAR)
    yield _unit(Sampler(TextureFilter.LINEAR_MIPMAP_LINEAR, min_lod=1.3, max_lod=2.6), matrix=_FAR)


def _wrapped():
    """Wrap modes along s and t, each with two filters, also outside the image."""
    border = (0.9, 0.2, 0.4, 0.7)
    for number in range(8):
        kind = TextureFilter(number % 2)
        wraps = _WRAPS[number // 2], _WRAPS[(number + 1) % 4]
        sampler = Sampler(kind, kind, wrap_s=wraps[0], wrap_t=wraps[1], border_color=border)
        yield _unit(sampler, coordinates=2 * (number % 2))


_FORMATS = (
    InternalFormat.R5_G6_B5,
    InternalFormat.RGB5_A1,
    InternalFormat.LUMINANCE6_ALPHA2,
    InternalFormat.INTENSITY8,
    InternalFormat.RGBA4,
    InternalFormat.R3_G3_B2,
)


def _formats():
    image = picture(8, 8, seed=5)
    made = {kind.name.lower(): texture_2d(image, kind) for kind in _FORMATS}
    made["palette"] = paletted_texture([values(8, 8, seed=6)], values(256, seed=7, most=2**32 - 1))
    blocks = bytes(values(2 * 2 * 16, seed=8).tolist())
    made["compressed"] = compressed_texture(blocks, InternalFormat.COMPRESSED_RGBA_S3TC_DXT5, 8, 8)
    linear = Sampler(TextureFilter.LINEAR)
    return stores(**made) + _drawn(_unit(linear, name, environment=TextureEnvironment()) for name in made)


def _cubes():
    """A cube map by normals, reflections and coordinates, filtered between its levels and at its edges."""
    generated = (TexGenMode.NORMAL_MAP, TexGenMode.REFLECTION_MAP)
    for number in range(8):
        kind = _FILTERS[(1, 5, 0, 3)[number % 4]]
        sampler = Sampler(kind, TextureFilter(number % 2), **(_EDGE if number % 3 else {}))
        mode = TexGen(generated[number % 2])
        gen = (mode, mode, mode, TexGen()) if number < 4 else (TexGen(),) * 4
        yield _unit(sampler, gen=gen, coordinates=1 + number % 2)


def _volumes():
    for number in range(8):
        wrap = _WRAPS[number % 4]
        sampler = Sampler(_FILTERS[number % 6], wrap_r=wrap, wrap_s=_WRAPS[number // 2])
        yield _unit(sampler, coordinates=number % 4, matrix=_FAR if number % 2 else TextureUnit(None).matrix)


def _probed(exact):
    """Footprints along one axis, with one to eight probes."""
    for number in range(8):
        kind = TextureFilter.LINEAR_MIPMAP_NEAREST if number % 3 == 2 else TextureFilter.LINEAR_MIPMAP_LINEAR
        most = (3, 5, 7, 8)[number % 4] if exact else (1, 2, 4, 8)[number % 4]
        sampler = Sampler(kind, max_probes=most, exact_probes=exact)
        yield _unit(sampler, matrix=_FAR, coordinates=number // 2)


def _rough():
    """Lookups of a mipmapped picture that a texture of deviations filters."""
    flat = TextureShaderStage(TextureShaderOperation.TEXTURE_2D)
    for number in range(8):
        offset = TextureShaderStage(
            TextureShaderOperation.OFFSET_TEXTURE_2D,
            offset_texture_matrix=(0.3, 0.1, -0.2, 0.4),
            roughness=0,
            roughness_scale=(number + 1) / 4.0,
        )
        sampler = Sampler(TextureFilter.LINEAR_MIPMAP_LINEAR, max_probes=1 + number % 4, exact_probes=True)
        units = _unit(Sampler(TextureFilter.LINEAR), "rough"), _unit(sampler, coordinates=1)
        yield PassState(texture_units=units, texture_shader=(flat, offset))


def _compared():
    """Depth textures with every function and both filters."""
    for number, function in enumerate(ComparisonFunction):
        kind = TextureFilter(number % 2)
        sampler = Sampler(
            kind,
            kind,
            compare_mode=TextureCompareMode.COMPARE_R_TO_TEXTURE,
            compare_function=function,
            **_EDGE,
        )
        environment = TextureEnvironment()
        yield _unit(sampler, coordinates=(0, 3)[number % 2], matrix=_IN_UNITS, environment=environment)


_MIPMAPPED = texture_2d(picture(32, 32, seed=9), mipmaps=True)
_DEPTHS = texture_of_words(values(8, 8, seed=10, most=2**32 - 1), TexelWord.X8_Y24_FIXED)

TEXTURE_FRAMES = (
    Frame(
        name="filters-and-mipmaps",
        profile=GEFORCE_3,
        commands=(*stores(texture=_MIPMAPPED), *background(), *_drawn(_filtered())),
    ),
    Frame(
        name="wrap-modes",
        profile=GEFORCE_3,
        commands=(*stores(texture=texture_2d(picture(8, 16, seed=11))), *background(), *_drawn(_wrapped())),
    ),
    Frame(name="texture-formats", profile=NV2A, commands=(*background(), *_formats())),
    Frame(
        name="cube-maps",
        profile=GEFORCE_256,
        commands=(
            *stores(texture=texture_cube_map(picture(6, 16, 16, seed=12), mipmaps=True)),
            *background(),
            *_drawn(_cubes()),
        ),
    ),
    Frame(
        name="volumes",
        profile=NV2A,
        commands=(
            *stores(texture=texture_3d(picture(8, 8, 8, seed=13), mipmaps=True)),
            *background(),
            *_drawn(_volumes()),
        ),
    ),
    Frame(
        name="footprint-assembly",
        profile=TEXRAM,
        commands=(*stores(texture=_MIPMAPPED), *background(), *_drawn(_probed(exact=False))),
    ),
    Frame(
        name="roughness",
        profile=SCHILLING,
        commands=(
            *stores(texture=_MIPMAPPED, rough=texture_2d(picture(8, 8, seed=14))),
            *background(),
            *_drawn(_probed(exact=True)),
            *patched(_rough()),
        ),
    ),
    Frame(
        name="shadow-maps",
        profile=NV2A,
        commands=(*stores(texture=_DEPTHS), *background(), *_drawn(_compared())),
    ),
    Frame(
        name="signed-and-one-dimensional",
        profile=NV2A,
        commands=(
            *stores(texture=texture_2d(picture(8, 8, seed=15)), line=texture_1d(picture(1, 16, seed=16)[0])),
            *background(),
            *_drawn(
                _unit(
                    replace(Sampler(TextureFilter.LINEAR), signed_components=signed),
                    name,
                    cylinder_wrap=(number % 2 == 1, number % 3 == 1, False, False),
                )
                for number, (name, signed) in enumerate(
                    (
                        ("texture", SignedComponents(red=True)),
                        ("texture", SignedComponents(green=True, alpha=True)),
                        ("line", SignedComponents()),
                        ("line", SignedComponents(blue=True)),
                    )
                    * 2
                )
            ),
        ),
    ),
)
