"""SGI's Octane (Impact) and InfiniteReality: the imaging subset, pixel textures, shadow maps, twelve bits.

No picture of either was at hand: what no paper or extension says is Assumed (docs/numbers.md).
"""

from dataclasses import replace

from pipeline.enums import ComparisonFunction, InternalFormat, TextureCompareMode, WrapMode
from pipeline.profiles.opengl_1_2 import OPENGL_1_2_IMAGING
from pipeline.textures import TWELVE_BIT_FORMATS

OCTANE = replace(
    OPENGL_1_2_IMAGING,
    name="SGI Octane",
    description="SGI Octane (Impact), 1997: imaging subset, pixel textures, up to twelve bits",
    color_bits=(8, 12),
    texture_bits=12,
    internal_formats=OPENGL_1_2_IMAGING.internal_formats | TWELVE_BIT_FORMATS,
    wrap_modes=OPENGL_1_2_IMAGING.wrap_modes | {WrapMode.CLAMP_TO_BORDER},
    pixel_texture=True,
    pixel_texture_sgis=True,
    impact_pixel_texture=True,
    texture_color_table=True,
    clamps_color_matrix=True,
    evidence={
        **OPENGL_1_2_IMAGING.evidence,
        "color_bits": "Source: SGIX_impact_pixel_texture (twelve bits); the usual width Assumed",
        "texture_bits": "Source: SGIX_impact_pixel_texture (pixel groups of twelve bits a component)",
        "internal_formats": "Source: OpenGL 1.2.1 table 3.16, SGIX_impact_pixel_texture",
        "wrap_modes": "Source: SGIS_texture_border_clamp, SGIS_texture_edge_clamp",
        "pixel_texture": "Source: SGIX_pixel_texture; Kautz, Seidel 2000, section 5",
        "pixel_texture_sgis": "Source: SGIS_pixel_texture",
        "impact_pixel_texture": "Source: SGIX_impact_pixel_texture",
        "texture_color_table": "Source: SGI_texture_color_table",
        "clamps_color_matrix": "Source: Kautz, Seidel 2000, section 5 (no signed results)",
    },
)

INFINITE_REALITY = replace(
    OPENGL_1_2_IMAGING,
    name="SGI InfiniteReality",
    description="SGI RealityEngine and InfiniteReality: shadow maps, multisampling, twelve bits",
    color_bits=(12, 8),
    texture_bits=12,
    samples=(1, 4, 8),
    depth_bits=(23,),
    accumulation_bits=24,
    auxiliary_buffers=4,
    internal_formats=OPENGL_1_2_IMAGING.internal_formats
    | TWELVE_BIT_FORMATS
    | {InternalFormat.DEPTH_COMPONENT16, InternalFormat.DEPTH_COMPONENT24},
    wrap_modes=OPENGL_1_2_IMAGING.wrap_modes | {WrapMode.CLAMP_TO_BORDER},
    texture_compare_modes=frozenset({TextureCompareMode.NONE, TextureCompareMode.COMPARE_R_TO_TEXTURE}),
    shadow_functions=frozenset({ComparisonFunction.LEQUAL, ComparisonFunction.GEQUAL}),
    shadow_ambient=True,
    texture_color_table=True,
    evidence={
        **OPENGL_1_2_IMAGING.evidence,
        "color_bits": "Source: Heidrich (document 000): twelve bits a component; the smaller width Assumed",
        "texture_bits": "Source: Heidrich (document 000): twelve bits a component",
        "samples": "Source: Montrym and others 1997 (InfiniteReality): 1, 4 and 8 samples",
        "depth_bits": "Source: Montrym and others 1997: 23 bits of depth beside 1 of stencil in a word",
        "accumulation_bits": "Assumed: 24 with the sign; Montrym and others 1997 name more than twelve bits",
        "auxiliary_buffers": "Assumed: 4; a query of AUX_BUFFERS would settle it",
        "internal_formats": "Source: OpenGL 1.2.1 table 3.16, SGIX_depth_texture",
        "wrap_modes": "Source: SGIS_texture_border_clamp, SGIS_texture_edge_clamp",
        "texture_compare_modes": "Source: SGIX_shadow",
        "shadow_functions": "Source: SGIX_shadow (TEXTURE_LEQUAL_R_SGIX, TEXTURE_GEQUAL_R_SGIX)",
        "shadow_ambient": "Source: SGIX_shadow_ambient",
        "texture_color_table": "Source: SGI_texture_color_table",
    },
)
