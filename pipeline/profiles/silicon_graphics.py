"""SGI's Octane (Impact) and InfiniteReality: the imaging subset, pixel textures, shadow maps, twelve bits.

No picture of either was at hand, nor a manual: what no paper or extension says is Assumed.
"""

from dataclasses import replace

from fixedpipe.pipeline.enums import (
    BaseFormat,
    ComparisonFunction,
    InternalFormat,
    TextureCompareMode,
    WrapMode,
)
from fixedpipe.pipeline.profiles.opengl_1_2 import OPENGL_1_2_IMAGING
from fixedpipe.pipeline.textures.images import TWELVE_BIT_FORMATS

_BORDER = "Assumed: edge and border clamp; a driver's list of SGIS_texture_border_clamp would settle it"
_DRIVER = "Assumed: as on the plain board; a query of the driver would settle it"
# What a plain board's number says nothing of either machine.
_UNKNOWN = dict.fromkeys(
    (
        "max_texture_size",
        "max_3d_texture_size",
        "max_viewport",
        "max_point_size",
        "max_line_width",
        "max_color_table_size",
        "max_convolution_size",
        "auxiliary_buffers",
        "depth_bits",
        "stencil_bits",
        "subpixel_bits",
        "filter_fraction_bits",
        "guard_band",
        "device_origin",
    ),
    _DRIVER,
)

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
        **_UNKNOWN,
        "max_texture_units": "Source: Heidrich and others 2000, section 6 (no multi-texturing)",
        "color_bits": "Inferred: from SGIX_impact_pixel_texture's alpha of twelve bits; the usual 8 Assumed",
        "texture_bits": "Inferred: from SGIX_impact_pixel_texture's alpha of twelve bits",
        "internal_formats": "Source: OpenGL 1.2.1 table 3.16; twelve bits Inferred from "
        "SGIX_impact_pixel_texture's alpha",
        "wrap_modes": _BORDER,
        "pixel_texture": "Source: SGIX_pixel_texture; Kautz, Seidel 2000, section 5",
        "pixel_texture_sgis": "Assumed: as well; a driver's list of SGIS_pixel_texture would settle it",
        "impact_pixel_texture": "Source: SGIX_impact_pixel_texture",
        "texture_color_table": "Source: SGIX_impact_pixel_texture (it shifts alphas by one)",
        "clamps_color_matrix": "Source: Kautz, Seidel 2000, section 5 (no signed results)",
    },
)

_PAPER = "Montrym, Baum, Dignam, Migdal 1997 would settle it"

INFINITE_REALITY = replace(
    OPENGL_1_2_IMAGING,
    name="SGI InfiniteReality",
    description="SGI RealityEngine, InfiniteReality: shadow maps, multisampling, twelve bits",
    color_bits=(12, 8),
    combiner_bits=12,
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
    depth_texture_modes=(BaseFormat.LUMINANCE,),
    texture_color_table=True,
    evidence={
        **OPENGL_1_2_IMAGING.evidence,
        **_UNKNOWN,
        "color_bits": f"Assumed: 12, or 8; {_PAPER}",
        "texture_bits": f"Assumed: 12, as the colour buffer; {_PAPER}",
        "samples": f"Assumed: 1, 4 or 8; {_PAPER}",
        "depth_bits": f"Assumed: 23; {_PAPER}",
        "accumulation_bits": f"Assumed: 24 with the sign, in hardware; {_PAPER}",
        "auxiliary_buffers": "Assumed: 4; a query of AUX_BUFFERS would settle it",
        "internal_formats": "Source: OpenGL 1.2.1 table 3.16, SGIX_depth_texture; twelve bits Assumed",
        "wrap_modes": _BORDER,
        "texture_compare_modes": "Source: SGIX_shadow",
        "shadow_functions": "Source: SGIX_shadow (TEXTURE_GEQUAL_R is LEQUAL, TEXTURE_LEQUAL_R GEQUAL)",
        "shadow_ambient": "Source: SGIX_shadow_ambient",
        "depth_texture_modes": "Source: SGIX_shadow (as if LUMINANCE)",
        "texture_color_table": "Assumed: as on the Octane; a driver's list of SGI_texture_color_table would "
        "settle it",
    },
)
