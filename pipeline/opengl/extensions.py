"""The version and the extensions that a machine's driver lists: those whose features the profile has.

Inferred: from the profile alone. Drivers' own lists of 1999 to 2001 had others too. Either every machine here
has their features, or none has.
"""

from collections.abc import Callable, Mapping

from fixedpipe.pipeline.enums import (
    BlendEquation,
    BlendFactor,
    CombineFunction,
    InternalFormat,
    StencilOperation,
    TexGenMode,
    TextureCompareMode,
    TextureEnvironmentMode,
    TextureShaderOperation,
    TextureTarget,
    WrapMode,
)
from fixedpipe.pipeline.profiles.profile import Profile

# The version of every machine here: the core is OpenGL 1.2.1, and everything else is an extension.
VERSION = "1.2.1"


def _always(profile: Profile) -> bool:
    return True


# For each extension, a function that says whether a profile has its features.
EXTENSIONS: Mapping[str, Callable[[Profile], bool]] = {
    "GL_ARB_imaging": lambda p: p.pixels.convolution and p.pixels.histogram and p.pixels.color_matrix,
    "GL_ARB_multisample": lambda p: max(p.framebuffers.samples) > 1,
    "GL_ARB_multitexture": lambda p: p.textures.max_texture_units > 1,
    "GL_ARB_depth_texture": lambda p: len(p.textures.depth_texture_modes) > 1,
    "GL_ARB_point_parameters": lambda p: p.vertices.point_parameters,
    "GL_ARB_shadow": lambda p: len(p.textures.depth_texture_modes) > 1 and _compares(p),
    "GL_ARB_shadow_ambient": lambda p: p.textures.shadow_ambient,
    "GL_ARB_texture_border_clamp": lambda p: WrapMode.CLAMP_TO_BORDER in p.textures.wrap_modes,
    "GL_ARB_texture_cube_map": lambda p: TextureTarget.TEXTURE_CUBE_MAP in p.textures.texture_targets,
    "GL_ARB_texture_env_add": lambda p: _has_environment(p, TextureEnvironmentMode.ADD),
    "GL_ARB_texture_env_combine": lambda p: CombineFunction.SUBTRACT in p.combiners.combine_functions,
    "GL_ARB_texture_env_crossbar": lambda p: p.combiners.texture_environment_crossbar,
    "GL_ARB_texture_env_dot3": lambda p: CombineFunction.DOT3_RGB in p.combiners.combine_functions,
    "GL_ARB_texture_mirrored_repeat": lambda p: WrapMode.MIRRORED_REPEAT in p.textures.wrap_modes,
    "GL_ARB_transpose_matrix": _always,
    "GL_ARB_vertex_buffer_object": _always,
    "GL_ARB_window_pos": _always,
    "GL_EXT_abgr": _always,
    "GL_EXT_bgra": _always,
    "GL_EXT_blend_color": lambda p: BlendFactor.CONSTANT_COLOR in p.fragments.blend_factors_source,
    "GL_EXT_blend_minmax": lambda p: BlendEquation.MIN in p.fragments.blend_equations,
    "GL_EXT_blend_subtract": lambda p: BlendEquation.FUNC_SUBTRACT in p.fragments.blend_equations,
    "GL_EXT_compiled_vertex_array": _always,
    "GL_EXT_draw_range_elements": _always,
    "GL_EXT_fog_coord": lambda p: p.vertices.fog_coordinate,
    "GL_EXT_multi_draw_arrays": _always,
    "GL_EXT_packed_pixels": _always,
    "GL_EXT_paletted_texture": lambda p: InternalFormat.COLOR_INDEX8 in p.textures.internal_formats,
    "GL_EXT_point_parameters": lambda p: p.vertices.point_parameters,
    "GL_EXT_rescale_normal": _always,
    "GL_EXT_secondary_color": lambda p: p.fragments.color_sum,
    "GL_EXT_separate_specular_color": lambda p: p.vertices.separate_specular_color,
    "GL_EXT_shadow_funcs": lambda p: len(p.textures.shadow_functions) == 8,
    "GL_EXT_stencil_wrap": lambda p: StencilOperation.INCR_WRAP in p.fragments.stencil_operations,
    "GL_EXT_texture3D": lambda p: p.textures.max_3d_texture_size > 0,
    "GL_EXT_texture_compression_s3tc": lambda p: (
        InternalFormat.COMPRESSED_RGBA_S3TC_DXT1 in p.textures.internal_formats
    ),
    "GL_EXT_texture_cube_map": lambda p: TextureTarget.TEXTURE_CUBE_MAP in p.textures.texture_targets,
    "GL_EXT_texture_edge_clamp": lambda p: WrapMode.CLAMP_TO_EDGE in p.textures.wrap_modes,
    "GL_EXT_texture_env_add": lambda p: _has_environment(p, TextureEnvironmentMode.ADD),
    "GL_EXT_texture_env_combine": lambda p: _has_environment(p, TextureEnvironmentMode.COMBINE),
    "GL_EXT_texture_filter_anisotropic": lambda p: p.textures.max_anisotropy > 1,
    "GL_EXT_texture_lod_bias": lambda p: p.textures.max_lod_bias > 0,
    "GL_EXT_texture_object": _always,
    "GL_EXT_vertex_array": _always,
    "GL_EXT_vertex_weighting": lambda p: p.vertices.vertex_weighting,
    "GL_NV_blend_square": lambda p: BlendFactor.SRC_COLOR in p.fragments.blend_factors_source,
    "GL_NV_depth_clamp": lambda p: p.fragments.depth_clamp,
    "GL_NV_fog_distance": lambda p: p.fragments.fog_registers,
    "GL_NV_point_sprite": lambda p: bool(p.primitives.point_sprite_units),
    "GL_NV_register_combiners": lambda p: p.combiners.max_general_combiners > 0,
    "GL_NV_register_combiners2": lambda p: p.combiners.per_stage_constants,
    "GL_NV_texgen_reflection": lambda p: TexGenMode.REFLECTION_MAP in p.vertices.texgen_modes,
    "GL_NV_texture_env_combine4": lambda p: _has_environment(p, TextureEnvironmentMode.COMBINE4),
    "GL_NV_texture_rectangle": lambda p: TextureTarget.TEXTURE_RECTANGLE in p.textures.texture_targets,
    "GL_NV_texture_shader": lambda p: bool(p.texture_shaders.texture_shader_operations),
    "GL_NV_texture_shader2": lambda p: (
        TextureShaderOperation.DOT_PRODUCT_TEXTURE_3D in p.texture_shaders.texture_shader_operations
    ),
    "GL_SGI_color_matrix": lambda p: p.pixels.color_matrix,
    "GL_SGI_color_table": lambda p: p.pixels.color_tables,
    "GL_SGI_texture_color_table": lambda p: p.textures.texture_color_table,
    "GL_SGIS_generate_mipmap": _always,
    "GL_SGIS_pixel_texture": lambda p: p.pixels.pixel_texture_sgis,
    "GL_SGIS_texture_border_clamp": lambda p: WrapMode.CLAMP_TO_BORDER in p.textures.wrap_modes,
    "GL_SGIS_texture_edge_clamp": lambda p: WrapMode.CLAMP_TO_EDGE in p.textures.wrap_modes,
    "GL_SGIS_texture_lod": _always,
    "GL_SGIX_depth_texture": lambda p: bool(p.textures.depth_texture_modes),
    "GL_SGIX_impact_pixel_texture": lambda p: p.pixels.impact_pixel_texture,
    "GL_SGIX_pixel_texture": lambda p: p.pixels.pixel_texture,
    "GL_SGIX_shadow": lambda p: _compares(p),
    "GL_SGIX_shadow_ambient": lambda p: p.textures.shadow_ambient,
}


def _has_environment(profile, mode):
    return mode in profile.combiners.texture_environment_modes


def _compares(profile):
    return TextureCompareMode.COMPARE_R_TO_TEXTURE in profile.textures.texture_compare_modes


def extensions(profile: Profile) -> tuple[str, ...]:
    """The extensions that a machine's driver lists, in alphabetical order."""
    return tuple([name for name in sorted(EXTENSIONS) if EXTENSIONS[name](profile)])
