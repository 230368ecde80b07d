"""The state variables of Get (OpenGL 1.2.1 tables 6.5 to 6.28, and extensions): token to value.

``STATE`` depends only on the calls. ``LIMITS`` depends on the machine and its driver, so another driver may
give other answers.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from fixedpipe.pipeline.enums import ProvokingVertex
from fixedpipe.pipeline.opengl import pixel_transfers, tokens  # noqa: F401, pixel_transfers declares values
from fixedpipe.pipeline.opengl.arrays import ArrayPointer
from fixedpipe.pipeline.opengl.attributes import STACK_DEPTH
from fixedpipe.pipeline.opengl.combiners import HINTS
from fixedpipe.pipeline.opengl.evaluators import MAX_EVAL_ORDER
from fixedpipe.pipeline.opengl.extensions import extensions
from fixedpipe.pipeline.opengl.lists import MAX_LIST_NESTING
from fixedpipe.pipeline.opengl.matrices import top
from fixedpipe.pipeline.opengl.pixels import STORE_PARAMETERS
from fixedpipe.pipeline.opengl.raster_queries import RASTER_STATE
from fixedpipe.pipeline.opengl.selection import MAX_NAME_STACK_DEPTH
from fixedpipe.pipeline.opengl.values import VALUES
from fixedpipe.pipeline.opengl.vertex_programs import CURRENT_PROGRAM

Variable = Callable[[Any], Any]

# Tokens of later versions that recorded programs query.
_NUM_EXTENSIONS, _PROGRAM_PIPELINE, _QUADS_FOLLOW = 0x821D, 0x825A, 0x8E4C
_PROVOKING_VERTEX, _FIRST_VERTEX, _LAST_VERTEX = 0x8E4F, 0x8E4D, 0x8E4E
_CURRENT_RASTER_SECONDARY_COLOR = 0x845F
_BLEND_SRC_ALPHA, _BLEND_DST_ALPHA = tokens.BLEND_SRC_ALPHA, tokens.BLEND_DST_ALPHA


def _value(key, place=None):
    """A function that returns a value, or one of its parts."""
    if place is None:
        return lambda gl: gl.values[key]
    return lambda gl: gl.values[key][place]


def _unit(gl):
    return gl.values["active_texture"]


def _columns(matrix):
    return tuple(np.array(matrix).T.reshape(-1).tolist())


def _rows(matrix):
    return tuple([number for row in matrix for number in row])


def _buffer_size(buffer):
    return 0 if buffer is None else buffer[0]


def _texture_matrix(gl):
    return top(gl, ("texture matrix", _unit(gl)))


# ----------------------------------------------------------------------------------------------- state

STATE: dict[int, Variable] = {
    # table 6.5
    tokens.CURRENT_COLOR: lambda gl: gl.current.color,
    tokens.CURRENT_SECONDARY_COLOR: lambda gl: gl.current.secondary_color,
    tokens.CURRENT_NORMAL: lambda gl: gl.current.normal,
    tokens.CURRENT_TEXTURE_COORDS: lambda gl: gl.current.texture_coordinates[_unit(gl)],
    tokens.CURRENT_FOG_COORDINATE: lambda gl: gl.current.fog_coordinate,
    tokens.CURRENT_VERTEX_WEIGHT_EXT: lambda gl: gl.current.weight,
    tokens.CURRENT_INDEX: lambda gl: 1,  # Assumed: no program sets it; no window here has colour indices
    tokens.EDGE_FLAG: lambda gl: gl.current.edge_flag,
    **RASTER_STATE,
    # table 6.7
    tokens.VIEWPORT: _value("viewport"),
    tokens.DEPTH_RANGE: _value("depth_range"),
    tokens.MATRIX_MODE: _value("matrix_mode"),
    tokens.TEXTURE_MATRIX: lambda gl: _columns(_texture_matrix(gl)),
    tokens.TRANSPOSE_TEXTURE_MATRIX: lambda gl: _rows(_texture_matrix(gl)),
    tokens.TEXTURE_STACK_DEPTH: lambda gl: len(gl.values[("texture matrix", _unit(gl))]),
    tokens.ACTIVE_TEXTURE: lambda gl: tokens.TEXTURE0 + _unit(gl),
    tokens.VERTEX_ARRAY_BINDING_APPLE: lambda gl: gl.arrays.bound,
    tokens.CLIENT_ACTIVE_TEXTURE: lambda gl: tokens.TEXTURE0 + gl.arrays.unit,
    # table 6.8
    tokens.FOG_COLOR: _value("fog_color"),
    tokens.FOG_DENSITY: _value("fog_density"),
    tokens.FOG_START: _value("fog_start"),
    tokens.FOG_END: _value("fog_end"),
    tokens.FOG_INDEX: _value("fog_index"),
    tokens.FOG_MODE: _value("fog_mode"),
    tokens.FOG_COORD_SRC: _value("fog_source"),
    tokens.FOG_DISTANCE_MODE_NV: _value("fog_distance"),
    tokens.SHADE_MODEL: _value("shade_model"),
    _PROVOKING_VERTEX: lambda gl: (
        _LAST_VERTEX if gl.values["provoking_vertex"] is ProvokingVertex.LAST else _FIRST_VERTEX
    ),
    # tables 6.9, 6.10
    tokens.COLOR_MATERIAL_FACE: _value("color_material", 0),
    tokens.COLOR_MATERIAL_PARAMETER: _value("color_material", 1),
    tokens.LIGHT_MODEL_AMBIENT: _value("model_ambient"),
    tokens.LIGHT_MODEL_LOCAL_VIEWER: _value("local_viewer"),
    tokens.LIGHT_MODEL_TWO_SIDE: _value("two_side"),
    tokens.LIGHT_MODEL_COLOR_CONTROL: _value("color_control"),
    # table 6.11
    tokens.POINT_SIZE: _value("point_size"),
    tokens.POINT_SIZE_MIN: _value("point_size_min"),
    tokens.POINT_FADE_THRESHOLD_SIZE: _value("point_fade_threshold"),
    tokens.POINT_DISTANCE_ATTENUATION: _value("point_attenuation"),
    tokens.POINT_SPRITE_R_MODE_NV: _value("point_sprite_r_mode"),
    tokens.LINE_WIDTH: _value("line_width"),
    tokens.LINE_STIPPLE_REPEAT: _value("line_stipple", 0),
    tokens.LINE_STIPPLE_PATTERN: _value("line_stipple", 1),
    tokens.CULL_FACE_MODE: _value("cull_face_mode"),
    tokens.FRONT_FACE: _value("front_face"),
    tokens.POLYGON_MODE: lambda gl: (gl.values["front_mode"], gl.values["back_mode"]),
    tokens.POLYGON_OFFSET_FACTOR: _value("polygon_offset", 0),
    tokens.POLYGON_OFFSET_UNITS: _value("polygon_offset", 1),
    # table 6.15
    tokens.SCISSOR_BOX: _value("scissor"),
    tokens.ALPHA_TEST_FUNC: _value("alpha_function", 0),
    tokens.ALPHA_TEST_REF: _value("alpha_function", 1),
    tokens.STENCIL_FUNC: _value("stencil_function", 0),
    tokens.STENCIL_REF: _value("stencil_function", 1),
    tokens.STENCIL_VALUE_MASK: _value("stencil_function", 2),
    tokens.STENCIL_FAIL: _value("stencil_operations", 0),
    tokens.STENCIL_PASS_DEPTH_FAIL: _value("stencil_operations", 1),
    tokens.STENCIL_PASS_DEPTH_PASS: _value("stencil_operations", 2),
    tokens.DEPTH_FUNC: _value("depth_function"),
    tokens.BLEND_SRC: _value("blend_factors", 0),
    tokens.BLEND_DST: _value("blend_factors", 1),
    tokens.BLEND_SRC_RGB: _value("blend_factors", 0),
    tokens.BLEND_DST_RGB: _value("blend_factors", 1),
    _BLEND_SRC_ALPHA: _value("blend_factors", 0),
    _BLEND_DST_ALPHA: _value("blend_factors", 1),
    tokens.BLEND_EQUATION: _value("blend_equation"),
    tokens.BLEND_COLOR: _value("blend_color"),
    tokens.LOGIC_OP_MODE: _value("logic_operation"),
    # table 6.16
    tokens.DRAW_BUFFER: _value("draw_buffer"),
    tokens.READ_BUFFER: _value("read_buffer"),
    tokens.COLOR_WRITEMASK: _value("color_mask"),
    tokens.DEPTH_WRITEMASK: _value("depth_mask"),
    tokens.STENCIL_WRITEMASK: _value("stencil_write_mask"),
    tokens.INDEX_WRITEMASK: lambda gl: 0xFFFFFFFF,
    tokens.COLOR_CLEAR_VALUE: _value("clear_color"),
    tokens.DEPTH_CLEAR_VALUE: _value("clear_depth"),
    tokens.STENCIL_CLEAR_VALUE: _value("clear_stencil"),
    tokens.ACCUM_CLEAR_VALUE: _value("clear_accum"),
    tokens.INDEX_CLEAR_VALUE: lambda gl: 0,
    # tables 6.17 to 6.20
    tokens.ZOOM_X: _value("pixel_zoom", 0),
    tokens.ZOOM_Y: _value("pixel_zoom", 1),
    tokens.MAP1_GRID_SEGMENTS: _value("map_grid1", 0),
    tokens.MAP1_GRID_DOMAIN: lambda gl: gl.values["map_grid1"][1:],
    tokens.MAP2_GRID_SEGMENTS: lambda gl: gl.values["map_grid2"][::3],
    tokens.MAP2_GRID_DOMAIN: lambda gl: gl.values["map_grid2"][1:3] + gl.values["map_grid2"][4:],
    # register combiners
    tokens.NUM_GENERAL_COMBINERS_NV: _value("general combiners"),
    tokens.COLOR_SUM_CLAMP_NV: _value("color_sum_clamp"),
    tokens.CONSTANT_COLOR0_NV: _value("constant_color0"),
    tokens.CONSTANT_COLOR1_NV: _value("constant_color1"),
    CURRENT_PROGRAM: _value("program"),
    _PROGRAM_PIPELINE: lambda gl: 0,
    # table 6.26
    tokens.LIST_BASE: _value("list_base"),
    tokens.LIST_INDEX: lambda gl: gl.list_name if gl.list is not None else 0,
    tokens.LIST_MODE: lambda gl: gl.list_mode if gl.list is not None else 0,
    tokens.ATTRIB_STACK_DEPTH: lambda gl: len(gl.values["attribute stack"]),
    tokens.CLIENT_ATTRIB_STACK_DEPTH: lambda gl: len(gl.values["client attribute stack"]),
    tokens.RENDER_MODE: _value("render_mode"),
    tokens.NAME_STACK_DEPTH: lambda gl: len(gl.selection.names),
    tokens.SELECTION_BUFFER_SIZE: lambda gl: _buffer_size(gl.selection.select_buffer),
    tokens.FEEDBACK_BUFFER_SIZE: lambda gl: _buffer_size(gl.selection.feedback_buffer),
    tokens.FEEDBACK_BUFFER_TYPE: lambda gl: gl.selection.feedback_type,
}
for _stem, _key in (("MODELVIEW", "modelview"), ("PROJECTION", "projection"), ("COLOR", "color matrix")):
    STATE[getattr(tokens, f"{_stem}_MATRIX")] = lambda gl, key=_key: _columns(top(gl, key))
    STATE[getattr(tokens, f"TRANSPOSE_{_stem}_MATRIX")] = lambda gl, key=_key: _rows(top(gl, key))
for _token, _key in (
    (tokens.MODELVIEW_STACK_DEPTH, "modelview"),
    (tokens.PROJECTION_STACK_DEPTH, "projection"),
    (tokens.COLOR_MATRIX_STACK_DEPTH, "color matrix"),
    (tokens.MODELVIEW1_STACK_DEPTH_EXT, "modelview1"),
):
    STATE[_token] = lambda gl, key=_key: len(gl.values[key])
STATE[tokens.MODELVIEW1_MATRIX_EXT] = lambda gl: _columns(top(gl, "modelview1"))
for _token, _target in (
    (tokens.ARRAY_BUFFER_BINDING, tokens.ARRAY_BUFFER),
    (tokens.ELEMENT_ARRAY_BUFFER_BINDING, tokens.ELEMENT_ARRAY_BUFFER),
    (tokens.PIXEL_PACK_BUFFER_BINDING_ARB, tokens.PIXEL_PACK_BUFFER_ARB),
    (tokens.PIXEL_UNPACK_BUFFER_BINDING_ARB, tokens.PIXEL_UNPACK_BUFFER_ARB),
):
    STATE[_token] = lambda gl, target=_target: gl.buffers.name(target)
for _token, _target in (
    (tokens.TEXTURE_BINDING_1D, tokens.TEXTURE_1D),
    (tokens.TEXTURE_BINDING_2D, tokens.TEXTURE_2D),
    (tokens.TEXTURE_BINDING_3D, tokens.TEXTURE_3D),
    (tokens.TEXTURE_BINDING_CUBE_MAP, tokens.TEXTURE_CUBE_MAP),
    (tokens.TEXTURE_BINDING_RECTANGLE_NV, tokens.TEXTURE_RECTANGLE_NV),
):
    STATE[_token] = lambda gl, target=_target: gl.values["bound", target, _unit(gl)]
# Table 6.6: the kind of array that the stem of a token names.
_ARRAYS = {
    "VERTEX_ARRAY": "positions",
    "NORMAL_ARRAY": "normals",
    "COLOR_ARRAY": "colors",
    "INDEX_ARRAY": "color_indices",
    "TEXTURE_COORD_ARRAY": "texture_coordinates",
    "EDGE_FLAG_ARRAY": "edge_flags",
    "FOG_COORDINATE_ARRAY": "fog_coordinates",
    "SECONDARY_COLOR_ARRAY": "secondary_colors",
    "VERTEX_WEIGHT_ARRAY": "weights",
}


def array_pointer(gl: Any, kind: str) -> ArrayPointer:
    """The pointer of a kind of array. For texture coordinates, the one of the client's active unit."""
    return gl.arrays.pointers[(kind, gl.arrays.unit) if kind == "texture_coordinates" else kind]


def _buffer_of(gl, kind):
    buffer = array_pointer(gl, kind).buffer
    return next(
        (name for name, each in gl.shared.buffers.items() if buffer is not None and each is buffer), 0
    )


def _token_named(name):
    """The token of a name, with or without EXT; None if there is none."""
    return getattr(tokens, name, getattr(tokens, name + "_EXT", None))


# The tokens of arrays' addresses, which GetPointerv accepts.
ARRAY_POINTERS: dict[int | None, str] = {}
for _stem, _kind in _ARRAYS.items():
    for _field in ("size", "type", "stride"):
        if (_token := _token_named(f"{_stem}_{_field.upper()}")) is not None:
            STATE[_token] = lambda gl, kind=_kind, field=_field: getattr(array_pointer(gl, kind), field)
    ARRAY_POINTERS[_token_named(f"{_stem}_POINTER")] = _kind
    if (_token := _token_named(f"{_stem}_BUFFER_BINDING")) is not None:
        STATE[_token] = lambda gl, kind=_kind: _buffer_of(gl, kind)

# The values of pixel transfer: its numbers, and its maps by their tokens.
PIXEL_MAPS: dict[int, str] = {}
for _key in VALUES:
    if isinstance(_key, tuple) and _key[0] == "pixel transfer":
        STATE[_key[1]] = _value(_key)
    elif isinstance(_key, tuple) and _key[0] == "pixel map":
        _name = f"PIXEL_MAP_{_key[1].upper()}"
        PIXEL_MAPS[getattr(tokens, _name)] = _key[1]
        STATE[getattr(tokens, _name + "_SIZE")] = lambda gl, key=_key: len(gl.values[key])
for _token in HINTS:
    STATE[_token] = _value(("hint", _token))
for _token, (_side, _field) in STORE_PARAMETERS.items():
    STATE[_token] = lambda gl, side=_side, field=_field: getattr(gl.values[side], field)

# Colours, depths and normals. A query for integers returns them as fractions of the largest (section 6.1.2).
FRACTIONS = frozenset(
    {
        tokens.CURRENT_COLOR,
        tokens.CURRENT_SECONDARY_COLOR,
        tokens.CURRENT_NORMAL,
        tokens.CURRENT_RASTER_COLOR,
        _CURRENT_RASTER_SECONDARY_COLOR,
        tokens.FOG_COLOR,
        tokens.LIGHT_MODEL_AMBIENT,
        tokens.ALPHA_TEST_REF,
        tokens.BLEND_COLOR,
        tokens.COLOR_CLEAR_VALUE,
        tokens.ACCUM_CLEAR_VALUE,
        tokens.DEPTH_RANGE,
        tokens.DEPTH_CLEAR_VALUE,
        tokens.CONSTANT_COLOR0_NV,
        tokens.CONSTANT_COLOR1_NV,
    }
)


# ---------------------------------------------------------------------------------------------- limits


def _of(section, name):
    return lambda gl: getattr(getattr(gl.profile, section), name)


def _constant(value):
    return lambda gl: value


def _two(value):
    return lambda gl: (value(gl), value(gl))


LIMITS: dict[int, Variable] = {
    tokens.MAX_LIGHTS: _of("vertices", "max_lights"),
    tokens.MAX_CLIP_PLANES: _of("vertices", "max_clip_planes"),
    tokens.MAX_SHININESS_NV: _of("vertices", "max_shininess"),
    tokens.MAX_SPOT_EXPONENT_NV: _of("vertices", "max_shininess"),
    tokens.MAX_TEXTURE_SIZE: _of("textures", "max_texture_size"),
    tokens.MAX_3D_TEXTURE_SIZE: _of("textures", "max_3d_texture_size"),
    tokens.MAX_CUBE_MAP_TEXTURE_SIZE: _of("textures", "max_cube_map_texture_size"),
    tokens.MAX_RECTANGLE_TEXTURE_SIZE_NV: _of("textures", "max_texture_size"),
    tokens.MAX_TEXTURE_UNITS: _of("textures", "max_texture_units"),
    tokens.MAX_TEXTURE_LOD_BIAS: _of("textures", "max_lod_bias"),
    tokens.MAX_TEXTURE_MAX_ANISOTROPY_EXT: _of("textures", "max_anisotropy"),
    tokens.MAX_GENERAL_COMBINERS_NV: _of("combiners", "max_general_combiners"),
    tokens.MAX_PIXEL_MAP_TABLE: _of("pixels", "max_pixel_map_table"),
    tokens.MAX_VIEWPORT_DIMS: _two(_of("framebuffers", "max_viewport")),
    tokens.SUBPIXEL_BITS: _of("arithmetic", "subpixel_bits"),
    tokens.STENCIL_BITS: _of("framebuffers", "stencil_bits"),
    tokens.AUX_BUFFERS: _of("framebuffers", "auxiliary_buffers"),
    tokens.DEPTH_BITS: lambda gl: int(gl.profile.widest_depth),
    tokens.SAMPLES: lambda gl: 0,  # a window of one sample
    tokens.SAMPLE_BUFFERS: lambda gl: 0,
    tokens.POINT_SIZE_MAX: _value("point_size_max"),  # initially the size of the largest point
    tokens.POINT_SIZE_RANGE: lambda gl: (1.0, gl.profile.primitives.max_point_size),
    tokens.ALIASED_POINT_SIZE_RANGE: lambda gl: (1.0, gl.profile.primitives.max_point_size),
    tokens.LINE_WIDTH_RANGE: lambda gl: (1.0, gl.profile.primitives.max_line_width),
    tokens.ALIASED_LINE_WIDTH_RANGE: lambda gl: (1.0, gl.profile.primitives.max_line_width),
    tokens.DOUBLEBUFFER: lambda gl: gl.drawable.double,
    tokens.STEREO: _constant(False),
    _NUM_EXTENSIONS: lambda gl: len(extensions(gl.profile)),
    _QUADS_FOLLOW: _constant(False),
    tokens.RGBA_MODE: _constant(True),
    tokens.INDEX_MODE: _constant(False),
    tokens.INDEX_BITS: _constant(0),
    tokens.MAX_NAME_STACK_DEPTH: _constant(MAX_NAME_STACK_DEPTH),
    tokens.MAX_EVAL_ORDER: _constant(MAX_EVAL_ORDER),
    tokens.MAX_LIST_NESTING: _constant(MAX_LIST_NESTING),
    tokens.MAX_ATTRIB_STACK_DEPTH: _constant(STACK_DEPTH),
    tokens.MAX_CLIENT_ATTRIB_STACK_DEPTH: _constant(STACK_DEPTH),
    tokens.NUM_COMPRESSED_TEXTURE_FORMATS: lambda gl: len(_compressed_formats(gl)),
    tokens.COMPRESSED_TEXTURE_FORMATS: lambda gl: _compressed_formats(gl),
    # Assumed: 1/8 pixel, as on the chip. No profile has these values.
    tokens.POINT_SIZE_GRANULARITY: _constant(0.125),
    tokens.LINE_WIDTH_GRANULARITY: _constant(0.125),
    tokens.MAX_ELEMENTS_VERTICES: _constant(4096),
    tokens.MAX_ELEMENTS_INDICES: _constant(4096),
}
for _name in ("RED", "GREEN", "BLUE", "ALPHA"):
    LIMITS[getattr(tokens, f"{_name}_BITS")] = lambda gl: gl.profile.framebuffers.color_bits[0]
    LIMITS[getattr(tokens, f"ACCUM_{_name}_BITS")] = _of("framebuffers", "accumulation_bits")
for _name in ("MODELVIEW", "PROJECTION", "TEXTURE", "COLOR_MATRIX"):
    LIMITS[getattr(tokens, f"MAX_{_name}_STACK_DEPTH")] = _constant(32)


def _compressed_formats(gl):
    formats = [f.name + "_EXT" for f in gl.profile.textures.internal_formats if "S3TC" in f.name]
    return tuple(sorted(getattr(tokens, name) for name in formats))
