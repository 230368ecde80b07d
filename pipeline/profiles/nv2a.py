"""NVIDIA NV2A (2001), the Xbox's graphics chip: what captures of the chip itself say.

Thousands of framebuffer captures exist; ``fixedpipe conformance`` redraws them (docs/silicon.md).
"""

from dataclasses import replace

from pipeline.enums import (
    BlendEquation,
    BlendFactor,
    ColorFormat,
    DotProductMapping,
    FogArithmetic,
    InternalFormat,
    TextureCompareMode,
    TextureShaderOperation,
    TextureTarget,
)
from pipeline.profiles.geforce_256 import GEFORCE_256

_MEASURED = {
    "exact": "Measured: 8-bit combiner registers (Combiner captures)",
    "max_texture_units": "Measured: four texture units (Pixel_shader captures)",
    "max_general_combiners": "Source: NV_register_combiners2 (MAX_GENERAL_COMBINERS_NV 8)",
    "per_stage_constants": "Measured: constants change from stage to stage (Combiner captures)",
    "max_texture_size": "Assumed: 4096; a capture of a larger texture would settle it",
    "max_cube_map_texture_size": "Assumed: 4096; a capture of a larger cube map would settle it",
    "power_of_two_textures": "Measured: powers of two but for rectangles (Texture_format captures)",
    "max_lod_bias": "Measured: s5.8, biases of -15 to 15 (LODBias capture)",
    "max_viewport": "Assumed: 4096; a capture of a larger surface would settle it",
    "depth_bits": "Measured: 16- and 24-bit fixed formats (Depth_buffer captures)",
    "stencil_bits": "Measured: 24-bit depth, 8-bit stencil (Stencil captures)",
    "wrap_modes": "Measured: five wrap modes, 78720 of 78720 pixels (Texture_border captures)",
    "texture_targets": "Measured: 3D and unnormalised coordinates (Volume_texture, Texture_format captures)",
    "internal_formats": "Measured: Texture_format, Volume_texture and Texture_DXT captures",
    "blend_factors_source": "Measured: all of them, in 1673 captures (Blend_tests)",
    "blend_factors_destination": "Measured: all of them, in 1673 captures (Blend_tests)",
    "blend_equations": "Measured: 1673 captures (Blend_tests)",
    "stencil_operations": "Measured: Stencil captures",
    "texture_shader_operations": "Measured: Pixel_shader and Texture_cubemap captures; rectangles Inferred",
    "dot_product_mappings": "Measured: six mappings, 56909 pixels each (DotSTRCube captures)",
    "texture_compare_modes": "Measured: 8150016 of 8150016 pixels of each (Texture_shadow_comparator)",
    "depth_units_in_coordinates": "Measured: Texture_shadow_comparator and DotZW captures",
    "surface_formats": "Source: nv_objects.h, SET_SURFACE_FORMAT_COLOR",
    "combiner_flags": "Measured: 110441 of 110441 pixels (Combiner captures)",
    "expand_half": "Inferred: the output half is 128 (CombinerOps capture); no capture uses EXPAND",
    "product_rounding": "Inferred: from the blender: one rounding after the sum (Blend_tests captures)",
    "round_before_scale": "Measured: bias before scale (CombinerOps capture)",
    "color_mantissa_bits": "Measured: 1984 of 1984 colours (Depth_buffer captures)",
    "subpixel_bits": "Measured: 294000 of 294000 pixels (TopLeftRaster capture)",
    "guard_band": "Measured: off-screen vertices stay unclipped (tex_diff_pers captures); its width Assumed",
    "device_origin": "Measured: TopLeftRaster capture",
    "magnification_threshold": "Measured: 61440 of 61440 pixels (LODBias capture)",
    "fog_registers": "Measured: bias, multiplier, PLANAR (Fog captures); other generations Assumed",
    "fog_arithmetic": "Measured: 6 of 6 captures (Fog, Fog_vsh), 374 of 374 squares (FogGen)",
}

NV2A = replace(
    GEFORCE_256,
    name="NV2A",
    description="NVIDIA NV2A, 2001: texture shaders, eight general combiners, four texture units",
    max_texture_units=4,
    max_general_combiners=8,
    per_stage_constants=True,
    max_texture_size=4096,
    max_cube_map_texture_size=4096,
    max_lod_bias=16.0,
    max_viewport=4096,
    texture_targets=frozenset(TextureTarget),
    internal_formats=frozenset(InternalFormat),
    blend_factors_source=frozenset(BlendFactor),
    blend_factors_destination=frozenset(BlendFactor),
    texture_shader_operations=frozenset(TextureShaderOperation),
    dot_product_mappings=frozenset(DotProductMapping),
    texture_compare_modes=frozenset(TextureCompareMode),
    depth_units_in_coordinates=True,
    blend_equations=frozenset(BlendEquation),
    surface_formats=frozenset(ColorFormat),
    combiner_flags=True,
    fog_registers=True,
    fog_arithmetic=FogArithmetic.TABLE,
    evidence={**GEFORCE_256.evidence, **_MEASURED},
)
