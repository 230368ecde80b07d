"""SGI's Octane (Impact, 1997): the imaging subset, pixel textures, twelve bits.

No picture of one was at hand, nor a manual: what no paper or extension says is Assumed.
"""

from fixedpipe.pipeline.enums import WrapMode
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

_DRIVER = "Assumed: as on the plain board; a query of an Octane's driver would settle it"
_SUBSET = "Assumed: as on the imaging board; a query of an Octane's driver would settle it"
_PICTURE = "Assumed: as on the plain board; a picture of an Octane would settle it"
# What SGI's own library writes to the board's registers.
_TRACED = "public traces of SGI's libGLcore for this board (techomancer/iris, src/dev/mgras/te1.rs)"
_NO_COMBINERS = "Assumed: does not matter; an Octane has no register combiners"

OCTANE = Profile.of(
    CORE | SUBSET,
    name="SGI Octane",
    description="SGI Octane (Impact), 1997: imaging subset, pixel textures, up to twelve bits",
    max_texture_units=known(1, "Source: Heidrich and others 2000, section 6 (no multi-texturing)"),
    internal_formats=known(
        CORE_FORMATS | TWELVE_BIT_FORMATS,
        f"Source: OpenGL 1.2.1 table 3.16; twelve bits by {_TRACED} (texels of 4, 8 and 12 bits)",
    ),
    wrap_modes=known(
        CORE_WRAP_MODES | {WrapMode.CLAMP_TO_BORDER},
        f"Source: border clamp by {_TRACED} (registers for GL_CLAMP_TO_BORDER_SGIS); edge clamp Assumed",
    ),
    texture_color_table=known(True, "Source: SGIX_impact_pixel_texture (it shifts alphas by one)"),
    color_bits=known(
        (8, 12), "Inferred: from SGIX_impact_pixel_texture's alpha of twelve bits; the usual 8 Assumed"
    ),
    transfers_texture_queries=known(True, TRANSFERRED_QUERIES),
    max_color_table_size=known(4096, _SUBSET),
    max_convolution_size=known(11, _SUBSET),
    pixel_texture=known(True, "Source: SGIX_pixel_texture; Kautz, Seidel 2000, section 5"),
    pixel_texture_sgis=known(True, "Assumed: as well; a driver's list of SGIS_pixel_texture would settle it"),
    impact_pixel_texture=known(True, "Source: SGIX_impact_pixel_texture"),
    texture_bits=known(12, f"Source: {_TRACED} (texels of 12 bits at most)"),
    combiner_bits=known(
        8,
        "Assumed: environments are as wide as the colour buffer; a picture of an Octane would settle it",
    ),
    offset_fraction=known(False, "Assumed: whole units; a slope drawn on an Octane would settle it"),
    expand_half=known(128, "Assumed: as on the plain board, 128; no stage of an Octane expands"),
    clamps_color_matrix=known(True, "Source: Kautz, Seidel 2000, section 5 (no signed results)"),
    **as_on_the_plain_board(
        _DRIVER,
        "max_texture_size",
        "max_3d_texture_size",
        "max_point_size",
        "max_line_width",
        "max_viewport",
        "depth_bits",
        "stencil_bits",
        "accumulation_bits",
        "auxiliary_buffers",
        "max_pixel_map_table",
        "subpixel_bits",
    ),
    **as_on_the_plain_board(_PICTURE, *OF_PICTURES),
    **as_on_the_plain_board(_NO_COMBINERS, *OF_COMBINERS),
)
