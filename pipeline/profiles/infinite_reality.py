"""SGI's RealityEngine and InfiniteReality: the imaging subset, shadow maps, multisampling, twelve bits.

No picture of one was at hand, nor a manual: what no paper or extension says is Assumed.
"""

from fixedpipe.pipeline.enums import (
    BaseFormat,
    ComparisonFunction,
    InternalFormat,
    TextureCompareMode,
    WrapMode,
)
from fixedpipe.pipeline.profiles.known import known
from fixedpipe.pipeline.profiles.opengl_1_2 import OF_COMBINERS, OF_PICTURES, as_on_the_plain_board
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.profiles.specified import (
    CORE,
    CORE_FORMATS,
    CORE_WRAP_MODES,
    SUBSET,
    TRANSFERRED_QUERIES,
)
from fixedpipe.pipeline.textures.images import TWELVE_BIT_FORMATS

_DRIVER = "Assumed: as on the plain board; a query of an InfiniteReality's driver would settle it"
_SUBSET = "Assumed: as on the imaging board; a query of an InfiniteReality's driver would settle it"
_PICTURE = "Assumed: as on the plain board; a picture of an InfiniteReality would settle it"
_NO_COMBINERS = "Assumed: does not matter; an InfiniteReality has no register combiners"

INFINITE_REALITY = Profile.of(
    CORE | SUBSET,
    name="SGI InfiniteReality",
    description="SGI RealityEngine, InfiniteReality: shadow maps, multisampling, twelve bits",
    internal_formats=known(
        CORE_FORMATS
        | TWELVE_BIT_FORMATS
        | {InternalFormat.DEPTH_COMPONENT16, InternalFormat.DEPTH_COMPONENT24},
        "Source: OpenGL 1.2.1 table 3.16, SGIX_depth_texture; twelve bits Assumed",
    ),
    wrap_modes=known(
        CORE_WRAP_MODES | {WrapMode.CLAMP_TO_BORDER},
        "Assumed: edge and border clamp; an InfiniteReality's driver that lists "
        "SGIS_texture_border_clamp would settle it",
    ),
    texture_color_table=known(
        True, "Assumed: as on the Octane; a driver's list of SGI_texture_color_table would settle it"
    ),
    texture_compare_modes=known(
        frozenset({TextureCompareMode.NONE, TextureCompareMode.COMPARE_R_TO_TEXTURE}),
        "Source: SGIX_shadow",
    ),
    shadow_functions=known(
        frozenset({ComparisonFunction.LEQUAL, ComparisonFunction.GEQUAL}),
        "Source: SGIX_shadow (TEXTURE_GEQUAL_R is LEQUAL, TEXTURE_LEQUAL_R GEQUAL)",
    ),
    shadow_ambient=known(True, "Source: SGIX_shadow_ambient"),
    depth_texture_modes=known((BaseFormat.LUMINANCE,), "Source: SGIX_shadow (as if LUMINANCE)"),
    depths_as_colors=known(
        True,
        "Assumed: SGIX_depth_texture names uses of depths beside shadows and leaves them open; a picture "
        "of a depth texture with TEXTURE_COMPARE off, drawn by an InfiniteReality, would settle it",
    ),
    depth_units_in_coordinates=known(
        False, "Inferred: from SGIX_shadow, which compares r with depths in [0, 1]"
    ),
    color_bits=known((12, 8), "Assumed: 12, or 8; Montrym, Baum, Dignam, Migdal 1997 would settle it"),
    depth_bits=known((23,), "Assumed: 23; Montrym, Baum, Dignam, Migdal 1997 would settle it"),
    accumulation_bits=known(
        24, "Assumed: 24 with the sign, in hardware; Montrym, Baum, Dignam, Migdal 1997 would settle it"
    ),
    auxiliary_buffers=known(4, "Assumed: 4; a query of AUX_BUFFERS would settle it"),
    samples=known((1, 4, 8), "Assumed: 1, 4 or 8; Montrym, Baum, Dignam, Migdal 1997 would settle it"),
    shades_samples=known(True, "Assumed: as docs/decisions, page 0012, says"),
    transfers_texture_queries=known(True, TRANSFERRED_QUERIES),
    max_color_table_size=known(4096, _SUBSET),
    max_convolution_size=known(11, _SUBSET),
    texture_bits=known(
        12, "Assumed: 12, as the colour buffer; Montrym, Baum, Dignam, Migdal 1997 would settle it"
    ),
    combiner_bits=known(
        12,
        "Assumed: 12, environments as wide as the colour buffer; Montrym, Baum, Dignam, Migdal 1997 "
        "would settle it",
    ),
    offset_fraction=known(False, "Assumed: whole units; a slope drawn on an InfiniteReality would settle it"),
    expand_half=known(128, "Assumed: as on the plain board, 128; no stage of an InfiniteReality expands"),
    **as_on_the_plain_board(
        _DRIVER,
        "max_texture_size",
        "max_3d_texture_size",
        "max_point_size",
        "max_line_width",
        "max_viewport",
        "stencil_bits",
        "max_pixel_map_table",
        "subpixel_bits",
    ),
    **as_on_the_plain_board(_PICTURE, *OF_PICTURES),
    **as_on_the_plain_board(_NO_COMBINERS, *OF_COMBINERS),
)
