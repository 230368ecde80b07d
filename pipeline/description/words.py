"""The words for fields and values: OpenGL's tokens where it has one, shortest exact numbers."""

from enum import Enum
from types import NoneType

from fixedpipe.pipeline.pixel_transfer import Histogram, Minmax, PixelMaps, PixelTransfer
from fixedpipe.pipeline.state import (
    AlphaTest,
    Blending,
    ColorMaterial,
    DepthTest,
    Fog,
    Light,
    Lighting,
    LineState,
    PassState,
    PointParameters,
    PointState,
    PolygonState,
    Sampler,
    StencilTest,
    TexGen,
    TextureUnit,
    VertexState,
    Viewport,
    WindowClip,
)

# The names of fields; a missing field has its own name, spelled with spaces.
FIELD_WORDS = {
    (VertexState, "modelview"): "MODELVIEW matrix",
    (VertexState, "projection"): "PROJECTION matrix",
    (VertexState, "modelview1"): "VERTEX_WEIGHTING enabled, MODELVIEW1 matrix",
    (VertexState, "normalize"): "NORMALIZE",
    (VertexState, "rescale_normal"): "RESCALE_NORMAL",
    (VertexState, "lighting"): "LIGHTING enabled",
    (VertexState, "clip_planes"): "CLIP_PLANE",
    (Viewport, "near"): "depth range near",
    (Viewport, "far"): "depth range far",
    (Lighting, "lights"): "LIGHT",
    (Lighting, "front"): "FRONT material",
    (Lighting, "back"): "BACK material",
    (Lighting, "model_ambient"): "LIGHT_MODEL_AMBIENT",
    (Lighting, "local_viewer"): "LIGHT_MODEL_LOCAL_VIEWER",
    (Lighting, "two_side"): "LIGHT_MODEL_TWO_SIDE",
    (Lighting, "separate_specular_color"): "SEPARATE_SPECULAR_COLOR",
    (Lighting, "color_material"): "COLOR_MATERIAL enabled",
    (PolygonState, "cull_face"): "CULL_FACE",
    (PolygonState, "front_face"): "front face",
    (PolygonState, "offset_fill"): "POLYGON_OFFSET_FILL",
    (PolygonState, "offset_factor"): "POLYGON_OFFSET_FACTOR",
    (PolygonState, "offset_units"): "POLYGON_OFFSET_UNITS",
    (PolygonState, "shade_model"): "SHADE_MODEL",
    (PolygonState, "front_mode"): "front POLYGON_MODE",
    (PolygonState, "back_mode"): "back POLYGON_MODE",
    (PolygonState, "offset_line"): "POLYGON_OFFSET_LINE",
    (PolygonState, "offset_point"): "POLYGON_OFFSET_POINT",
    (LineState, "stipple"): "LINE_STIPPLE",
    (PolygonState, "stipple"): "POLYGON_STIPPLE",
    (PointState, "size"): "POINT_SIZE",
    (PointState, "sprite"): "POINT_SPRITE",
    (PointState, "parameters"): "point parameters",
    (PointState, "program_size"): "VERTEX_PROGRAM_POINT_SIZE",
    (PointParameters, "attenuation"): "POINT_DISTANCE_ATTENUATION",
    (LineState, "width"): "LINE_WIDTH",
    (TextureUnit, "coord_replace"): "COORD_REPLACE",
    (WindowClip, "rectangles"): "rectangle",
    (TextureUnit, "lod_bias"): "TEXTURE_LOD_BIAS",
    (TextureUnit, "coordinates"): "coordinate set",
    (TextureUnit, "gen"): "TEXTURE_GEN",
    (TextureUnit, "matrix"): "TEXTURE matrix",
    (Sampler, "min_filter"): "TEXTURE_MIN_FILTER",
    (Sampler, "mag_filter"): "TEXTURE_MAG_FILTER",
    (Sampler, "wrap_s"): "TEXTURE_WRAP_S",
    (Sampler, "wrap_t"): "TEXTURE_WRAP_T",
    (Sampler, "border_color"): "TEXTURE_BORDER_COLOR",
    (Sampler, "compare_mode"): "TEXTURE_COMPARE_MODE",
    (Sampler, "compare_function"): "TEXTURE_COMPARE_FUNC",
    (Sampler, "wrap_r"): "TEXTURE_WRAP_R",
    (Sampler, "min_lod"): "TEXTURE_MIN_LOD",
    (Sampler, "max_lod"): "TEXTURE_MAX_LOD",
    (Sampler, "max_level"): "TEXTURE_MAX_LEVEL",
    (Sampler, "base_level"): "TEXTURE_BASE_LEVEL",
    (Sampler, "compare_fail_value"): "TEXTURE_COMPARE_FAIL_VALUE",
    (Sampler, "depth_texture_mode"): "DEPTH_TEXTURE_MODE",
    (Sampler, "max_probes"): "footprint probes",
    (Sampler, "exact_probes"): "exact number of probes",
    (Sampler, "max_anisotropy"): "TEXTURE_MAX_ANISOTROPY",
    (PassState, "perspective_correction"): "perspective correction",
    (PassState, "texture_units"): "texture unit",
    (PassState, "texture_shader"): "TEXTURE_SHADER stage",
    (PassState, "color_sum"): "COLOR_SUM",
    (PassState, "fog"): "FOG enabled",
    (PassState, "scissor"): "SCISSOR_TEST enabled",
    (PassState, "alpha_test"): "ALPHA_TEST enabled",
    (PassState, "stencil_test"): "STENCIL_TEST enabled",
    (PassState, "depth_test"): "DEPTH_TEST enabled",
    (PassState, "depth_clamp"): "DEPTH_CLAMP enabled",
    (PassState, "ycbcr_conversion"): "YCbCr conversion",
    (PassState, "w_buffering"): "W buffering",
    (PassState, "blending"): "BLEND enabled",
    (PassState, "logic_op"): "COLOR_LOGIC_OP",
    (DepthTest, "write"): "depth writes",
    (Fog, "coordinate_source"): "FOG_COORDINATE_SOURCE",
    (PixelTransfer, "map_color"): "MAP_COLOR",
    (PixelTransfer, "map_stencil"): "MAP_STENCIL",
    (PixelTransfer, "index_shift"): "INDEX_SHIFT",
    (PixelTransfer, "index_offset"): "INDEX_OFFSET",
    (PixelTransfer, "depth_scale"): "DEPTH_SCALE",
    (PixelTransfer, "depth_bias"): "DEPTH_BIAS",
    (PixelTransfer, "maps"): "PIXEL_MAP",
    (PixelTransfer, "color_table"): "COLOR_TABLE",
    (PixelTransfer, "convolution_1d"): "CONVOLUTION_1D",
    (PixelTransfer, "convolution_2d"): "CONVOLUTION_2D",
    (PixelTransfer, "separable_2d"): "SEPARABLE_2D",
    (PixelTransfer, "post_convolution_scale"): "POST_CONVOLUTION scale",
    (PixelTransfer, "post_convolution_bias"): "POST_CONVOLUTION bias",
    (PixelTransfer, "post_convolution_color_table"): "POST_CONVOLUTION_COLOR_TABLE",
    (PixelTransfer, "color_matrix"): "COLOR matrix",
    (PixelTransfer, "post_color_matrix_scale"): "POST_COLOR_MATRIX scale",
    (PixelTransfer, "post_color_matrix_bias"): "POST_COLOR_MATRIX bias",
    (PixelTransfer, "post_color_matrix_color_table"): "POST_COLOR_MATRIX_COLOR_TABLE",
    (PixelTransfer, "histogram"): "HISTOGRAM enabled",
    (PixelTransfer, "minmax"): "MINMAX enabled",
    (PixelMaps, "i_to_r"): "I_TO_R",
    (PixelMaps, "i_to_g"): "I_TO_G",
    (PixelMaps, "i_to_b"): "I_TO_B",
    (PixelMaps, "i_to_a"): "I_TO_A",
    (PixelMaps, "r_to_r"): "R_TO_R",
    (PixelMaps, "g_to_g"): "G_TO_G",
    (PixelMaps, "b_to_b"): "B_TO_B",
    (PixelMaps, "a_to_a"): "A_TO_A",
    (PixelMaps, "s_to_s"): "S_TO_S",
    (TextureUnit, "color_table"): "TEXTURE_COLOR_TABLE",
}

# Fields that define an enabled test or operation, shown even at their initial value.
ALWAYS_SHOWN = {
    AlphaTest: ("function", "reference"),
    StencilTest: ("function", "reference"),
    DepthTest: ("function",),
    Blending: ("source", "destination"),
    Fog: ("mode",),
    ColorMaterial: ("face", "parameter"),
    Light: ("position",),
    TexGen: ("mode",),
    Histogram: ("name", "width", "base_format"),
    Minmax: ("name", "base_format"),
}


def format_number(value):
    """A number in the shortest form that reads back as the same number."""
    short = f"{value + 0.0:g}"  # minus zero shows as 0
    return short if float(short) == value else repr(float(value))


def format_value(value):
    """A field's value: a token, a number, a vector or a matrix."""
    for kind, written in _WRITTEN.items():
        if isinstance(value, kind):
            return written(value)
    return format_number(value)


def _format_tuple(values):
    """A matrix, whose rows are tuples, or a vector."""
    if values and isinstance(values[0], tuple):
        return "[" + " | ".join(" ".join(format_number(v) for v in row) for row in values) + "]"
    return f"({', '.join(format_value(v) for v in values)})"


# By kind of value; others are numbers. The first that fits counts, because a bool and a token may be
# integers.
_WRITTEN = {
    bool: lambda value: "enabled" if value else "disabled",
    Enum: lambda token: token.name,
    str: lambda name: f'"{name}"',
    bytes: lambda data: data.hex(" ", 4),
    tuple: _format_tuple,
    NoneType: lambda value: "whole framebuffer",
}
