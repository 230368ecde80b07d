"""Queries of textures, units, maps, tables and filters (OpenGL 1.2.1 sections 6.1.3 to 6.1.10)."""

from typing import Any

from fixedpipe.pipeline.enums import (
    BaseFormat,
    InternalFormat,
)
from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.combiners import texture_shader_parameter
from fixedpipe.pipeline.opengl.entry_points import no_effect
from fixedpipe.pipeline.opengl.environments import FUNCTION_OF, OPERAND_OF, SCALE_OF, SOURCE_OF, Environment
from fixedpipe.pipeline.opengl.evaluators import MAPS
from fixedpipe.pipeline.opengl.fragments import member
from fixedpipe.pipeline.opengl.images import FACES, PROXIES
from fixedpipe.pipeline.opengl.internal_formats import (
    BASE_TOKENS,
    S3TC_FORMATS,
)
from fixedpipe.pipeline.opengl.outcomes import GLError
from fixedpipe.pipeline.opengl.queries import register_queries
from fixedpipe.pipeline.opengl.state_variables import PIXEL_MAPS
from fixedpipe.pipeline.opengl.texture_objects import (
    TARGETS,
)
from fixedpipe.pipeline.opengl.texturing import COORDINATES, bound_object, target_of
from fixedpipe.pipeline.textures.images import (
    COMPONENT_BITS,
    DEPTH_TEXELS,
    TWELVE_BIT_FORMATS,
)

# ---------------------------------------------------------------------------------------------------- queries


def texture_parameter(gl: Any, target: int, name: int) -> Any:
    """The result of GetTexParameter: a number, a token, or several."""
    held = bound_object(gl, target_of(target)).parameters
    plain = {
        tokens.TEXTURE_MIN_FILTER: held.min_filter,
        tokens.TEXTURE_MAG_FILTER: held.mag_filter,
        tokens.TEXTURE_WRAP_S: held.wrap_s,
        tokens.TEXTURE_WRAP_T: held.wrap_t,
        tokens.TEXTURE_WRAP_R: held.wrap_r,
        tokens.TEXTURE_BORDER_COLOR: held.border_color,
        tokens.TEXTURE_PRIORITY: held.priority,
        tokens.TEXTURE_RESIDENT: True,
        tokens.TEXTURE_MIN_LOD: held.min_lod,
        tokens.TEXTURE_MAX_LOD: held.max_lod,
        tokens.TEXTURE_BASE_LEVEL: held.base_level,
        tokens.TEXTURE_MAX_LEVEL: held.max_level,
        tokens.TEXTURE_LOD_BIAS: held.lod_bias,
        tokens.GENERATE_MIPMAP: held.generate_mipmap,
        tokens.TEXTURE_COMPARE_MODE: held.compare_mode,
        tokens.TEXTURE_COMPARE_FUNC: held.compare_function,
        tokens.TEXTURE_COMPARE_FAIL_VALUE_ARB: held.compare_fail_value,
        tokens.TEXTURE_COMPARE_SGIX: held.compare_mode != tokens.NONE,
        tokens.TEXTURE_COMPARE_OPERATOR_SGIX: tokens.TEXTURE_GEQUAL_R_SGIX
        if held.compare_function == tokens.GEQUAL
        else tokens.TEXTURE_LEQUAL_R_SGIX,
        tokens.DEPTH_TEXTURE_MODE: held.depth_mode,
        tokens.TEXTURE_MAX_ANISOTROPY_EXT: held.max_anisotropy,
    }
    if name not in plain:
        raise GLError(tokens.INVALID_ENUM, tokens.name_of(name))
    return plain[name]


def environment_parameter(gl: Any, target: int, name: int) -> Any:
    """The result of GetTexEnv for the active unit, without texture shaders: a number, a token, or several."""
    unit = gl.values["active_texture"]
    held: Environment = gl.values["environment", unit]
    if target == tokens.TEXTURE_FILTER_CONTROL and name == tokens.TEXTURE_LOD_BIAS:
        return gl.values["lod_bias", unit]
    if target == tokens.POINT_SPRITE_ARB and name == tokens.COORD_REPLACE_ARB:
        return gl.values["coord_replace", unit]
    if target != tokens.TEXTURE_ENV:
        raise GLError(tokens.INVALID_ENUM, tokens.name_of(target))
    if name in (tokens.TEXTURE_ENV_MODE, tokens.TEXTURE_ENV_COLOR):
        return held.mode if name == tokens.TEXTURE_ENV_MODE else held.color
    if name in FUNCTION_OF:
        return getattr(held, FUNCTION_OF[name]).function
    if name in SCALE_OF:
        return getattr(held, SCALE_OF[name]).scale
    for places, field in ((SOURCE_OF, "sources"), (OPERAND_OF, "operands")):
        if name in places:
            half, place = places[name]
            return getattr(getattr(held, half), field)[place]
    raise GLError(tokens.INVALID_ENUM, tokens.name_of(name))


def generation_parameter(gl: Any, coordinate: int, name: int) -> Any:
    """The result of GetTexGen for the active unit: a token or four numbers."""
    if coordinate not in COORDINATES:
        raise GLError(tokens.INVALID_ENUM, tokens.name_of(coordinate))
    held = gl.values["texture generation", gl.values["active_texture"]][COORDINATES.index(coordinate)]
    plain = {
        tokens.TEXTURE_GEN_MODE: held.mode,
        tokens.OBJECT_PLANE: held.object_plane,
        tokens.EYE_PLANE: held.eye_plane,
    }
    return member(plain, name)


# --------------------------------------------------------------------------------------------------- queries

no_effect("GetTexImage", "GetCompressedTexImage", compiled=False)


def level_parameter(gl: Any, target: int, level: int, name: int) -> Any:
    """The result of GetTexLevelParameter: a number or a token."""
    bound, face = PROXIES.get(target, target), 0
    if target in FACES:
        bound, face = tokens.TEXTURE_CUBE_MAP, target - tokens.TEXTURE_CUBE_MAP_POSITIVE_X
    if bound not in TARGETS:
        raise GLError(tokens.INVALID_ENUM, tokens.name_of(target))
    if target in PROXIES:
        image: Any = dict(gl.values["proxies"]).get((bound, level))
    else:
        texture = bound_object(gl, bound)
        texture.settle()
        image = texture.images.get((face, level))
    return _image_parameter(image, name)


_SIZES = {tokens.TEXTURE_WIDTH: 0, tokens.TEXTURE_HEIGHT: 1, tokens.TEXTURE_DEPTH: 2}
_COMPONENT_SIZES = {
    tokens.TEXTURE_RED_SIZE: "R",
    tokens.TEXTURE_GREEN_SIZE: "G",
    tokens.TEXTURE_BLUE_SIZE: "B",
    tokens.TEXTURE_ALPHA_SIZE: "A",
    tokens.TEXTURE_LUMINANCE_SIZE: "L",
    tokens.TEXTURE_INTENSITY_SIZE: "I",
    tokens.TEXTURE_DEPTH_SIZE: "D",
    tokens.TEXTURE_INDEX_SIZE_EXT: "X",
}


def _image_parameter(image, name):
    if name in _SIZES:
        return 0 if image is None else image.size[_SIZES[name]]
    if name == tokens.TEXTURE_BORDER:
        return 0 if image is None else image.border
    if name == tokens.TEXTURE_INTERNAL_FORMAT:
        return 1 if image is None else image.internal_format
    if name == tokens.TEXTURE_COMPRESSED:
        return image is not None and image.internal_format in S3TC_FORMATS and not image.chosen.compressing
    if name not in _COMPONENT_SIZES:
        raise GLError(tokens.INVALID_ENUM, tokens.name_of(name))
    return 0 if image is None else _component_sizes(image.chosen).get(_COMPONENT_SIZES[name], 0)


def _component_sizes(chosen):
    """{component: bits} of a format."""
    if chosen.format in DEPTH_TEXELS:
        return {"D": DEPTH_TEXELS[chosen.format].largest.bit_length()}
    if chosen.format is InternalFormat.COLOR_INDEX8:
        return {"X": 8}
    if chosen.base is None:
        return {}
    letters = {"ALPHA": "A", "LUMINANCE": "L", "LUMINANCE_ALPHA": "LA", "INTENSITY": "I", "RGB": "RGB"}
    components = letters.get(chosen.base.name, "RGBA")
    bits = COMPONENT_BITS.get(chosen.format, (12 if chosen.format in TWELVE_BIT_FORMATS else 8,) * 4)
    return dict(zip(components, bits, strict=False))


_FLOATS_AND_INTEGERS = ("fv", "iv")


# ------------------------------------------------------------------------------------- textures and units


def _tex_parameter(gl, target, name, *_recorded):
    fraction = name in (tokens.TEXTURE_BORDER_COLOR, tokens.TEXTURE_PRIORITY)
    return texture_parameter(gl, target, name), fraction


def _tex_env(gl, target, name, *_recorded):
    if target == tokens.TEXTURE_SHADER_NV:
        return texture_shader_parameter(gl, gl.values["active_texture"], name), False
    return environment_parameter(gl, target, name), name == tokens.TEXTURE_ENV_COLOR


def _tex_gen(gl, coordinate, name, *_recorded):
    return generation_parameter(gl, coordinate, name), False


register_queries("GetTexParameter", _FLOATS_AND_INTEGERS, _tex_parameter)
register_queries("GetTexEnv", _FLOATS_AND_INTEGERS, _tex_env)
register_queries("GetTexGen", ("dv", "fv", "iv"), _tex_gen)


def _tex_level_parameter(gl, target, level, name, *_recorded):
    return level_parameter(gl, target, level, name), False


register_queries("GetTexLevelParameter", _FLOATS_AND_INTEGERS, _tex_level_parameter)


# ------------------------------------------------------------------------------------------- maps of pixels


def _pixel_map(gl, name, *_recorded):
    return gl.values["pixel map", member(PIXEL_MAPS, name)], False


register_queries("GetPixelMap", ("fv", "uiv", "usv"), _pixel_map)


# ------------------------------------------------------------------------------ tables, filters and counters


def _table_parameter(gl, target, name, *_recorded):
    held = _held(gl, "color table", target)
    if name in (tokens.COLOR_TABLE_SCALE, tokens.COLOR_TABLE_BIAS):
        return _held(
            gl, f"color table {'scale' if name == tokens.COLOR_TABLE_SCALE else 'bias'}", target
        ), False
    if name == tokens.COLOR_TABLE_WIDTH:
        return (0 if held.table is None else len(held.table.entries)), False
    if name == tokens.COLOR_TABLE_FORMAT:
        return held.internal_format, False
    raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(name)} is no parameter of a colour table here")


def _held(gl, kind, target):
    """The value of a target. Raises GLError for a target without such a value."""
    if (kind, target) not in gl.values:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(target)} has no {kind}")
    return gl.values[kind, target]


def _convolution_parameter(gl, target, name, *_recorded):
    held = _held(gl, "convolution", target)
    values = {
        tokens.CONVOLUTION_BORDER_MODE: "convolution border mode",
        tokens.CONVOLUTION_BORDER_COLOR: "convolution border color",
        tokens.CONVOLUTION_FILTER_SCALE: "convolution scale",
        tokens.CONVOLUTION_FILTER_BIAS: "convolution bias",
    }
    if name in values:
        return gl.values[values[name], target], name == tokens.CONVOLUTION_BORDER_COLOR
    pixels = gl.profile.pixels
    column = None if held is None else held.column or held.rows
    plain = {
        tokens.CONVOLUTION_FORMAT: tokens.RGBA if held is None else held.internal_format,
        tokens.CONVOLUTION_WIDTH: 0 if held is None else len(held.rows[0]),
        tokens.CONVOLUTION_HEIGHT: 0 if column is None else len(column),
        tokens.MAX_CONVOLUTION_WIDTH: pixels.max_convolution_size,
        tokens.MAX_CONVOLUTION_HEIGHT: pixels.max_convolution_size,
    }
    return member(plain, name), False


register_queries("GetColorTableParameter", _FLOATS_AND_INTEGERS, _table_parameter)
register_queries("GetConvolutionParameter", _FLOATS_AND_INTEGERS, _convolution_parameter)


def _counter_parameter(gl, target, name, *_recorded):
    """A parameter of a histogram or minmax: width, sink, or the base format that it was made with."""
    key = {tokens.HISTOGRAM: "histogram", tokens.PROXY_HISTOGRAM: "proxy_histogram", tokens.MINMAX: "minmax"}
    held = gl.values[member(key, target)]
    if name in (tokens.HISTOGRAM_FORMAT, tokens.MINMAX_FORMAT):
        base = BaseFormat.RGBA if held is None else held.base_format
        return next(token for token, each in BASE_TOKENS.items() if each is base), False
    plain = {
        tokens.HISTOGRAM_WIDTH: getattr(held, "width", 0),
        tokens.HISTOGRAM_SINK: getattr(held, "sink", False),
        tokens.MINMAX_SINK: getattr(held, "sink", False),
    }
    return member(plain, name), False


register_queries("GetHistogramParameter", _FLOATS_AND_INTEGERS, _counter_parameter)
register_queries("GetMinmaxParameter", _FLOATS_AND_INTEGERS, _counter_parameter)


# --------------------------------------------------------------------------------------------- evaluators


def _map_parameter(gl, target, query, *_recorded):
    dimensions, _, _ = member(MAPS, target)
    held = gl.values["map", target]
    if query == tokens.COEFF:
        return tuple(held.points.reshape(-1).tolist()), False
    if query == tokens.ORDER:
        return held.points.shape[:dimensions] if dimensions > 1 else held.points.shape[0], False
    if query == tokens.DOMAIN:
        return held.domain, False
    raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(query)} is no query of maps")


register_queries("GetMap", ("dv", "fv", "iv"), _map_parameter)
