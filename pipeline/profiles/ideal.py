"""No machine at all: float64 everywhere, and limits only where a state could not say more.

``fixedpipe.pipeline.ideal.evaluate`` evaluates passes on it.
"""

from dataclasses import fields, replace

from fixedpipe.pipeline.enums import (
    BaseFormat,
    BlendFactor,
    CombineFunction,
    CombinerFunction,
    ComparisonFunction,
    DotProductMapping,
    InternalFormat,
    TextureCompareMode,
    TextureEnvironmentMode,
    TextureShaderOperation,
    TextureTarget,
)
from fixedpipe.pipeline.profiles.geforce_256 import GEFORCE_256
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.textures.images import TWELVE_BIT_FORMATS

_BY_DEFINITION = "Assumed: nothing; limits are what a state can say, or far beyond any machine of the time"

# It has no textures whose coordinates count texels.
_OF_RECTANGLES = frozenset(o for o in TextureShaderOperation if "RECTANGLE" in o.name)

IDEAL = replace(
    GEFORCE_256,
    name="ideal",
    description="no machine: float64 throughout, what the algorithm itself gives",
    exact=True,
    max_texture_units=4,
    max_general_combiners=8,
    per_stage_constants=True,
    max_texture_size=1 << 14,
    max_cube_map_texture_size=1 << 14,
    power_of_two_textures=False,
    max_lod_bias=16.0,
    max_anisotropy=1.0,
    max_lights=64,
    max_clip_planes=64,
    max_viewport=1 << 13,
    expand_half=127.5,
    blend_factors_source=frozenset(BlendFactor),
    blend_factors_destination=frozenset(BlendFactor),
    max_3d_texture_size=1 << 10,
    max_probes=64,
    max_color_table_size=1 << 16,
    max_convolution_size=64,
    max_pixel_map_table=1 << 16,
    auxiliary_buffers=4,
    texture_targets=GEFORCE_256.texture_targets | {TextureTarget.TEXTURE_3D},
    internal_formats=GEFORCE_256.internal_formats
    | TWELVE_BIT_FORMATS
    | {InternalFormat.DEPTH_COMPONENT16, InternalFormat.DEPTH_COMPONENT24, InternalFormat.HILO16},
    signed_components=True,
    texture_shader_operations=frozenset(TextureShaderOperation) - _OF_RECTANGLES,
    dot_product_mappings=frozenset(DotProductMapping),
    texture_compare_modes=frozenset({TextureCompareMode.NONE, TextureCompareMode.COMPARE_R_TO_TEXTURE}),
    shadow_functions=frozenset(ComparisonFunction),
    texture_environment_modes=frozenset(TextureEnvironmentMode),
    depth_texture_modes=(BaseFormat.LUMINANCE, BaseFormat.INTENSITY, BaseFormat.ALPHA),
    combine_functions=frozenset(CombineFunction),
    combiner_functions=frozenset(CombinerFunction),
    texture_environment_crossbar=True,
    add_signed_scale_by_four=True,
    shadow_ambient=True,
    texture_color_table=True,
    color_matrix=True,
    color_tables=True,
    convolution=True,
    histogram=True,
    pixel_texture=True,
    pixel_texture_sgis=True,
    impact_pixel_texture=True,
    combiner_lookup=True,
    evaluate_before_filtering=True,
    spherical_interpolation=True,
    clamps=frozenset(),
    evidence={
        f.name: _BY_DEFINITION for f in fields(Profile) if f.name not in ("name", "description", "evidence")
    },
)
