"""A plain board of the time, as OpenGL 1.2.1 describes it; and the same with the imaging subset."""

from typing import Any

from fixedpipe.pipeline.enums import ColorWeights, FogArithmetic, ProductRounding, WindowOrigin
from fixedpipe.pipeline.profiles.known import known
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.profiles.specified import CORE, SUBSET

_NO_COMBINERS = "Assumed: does not matter; the machine has no register combiners"

OPENGL_1_2 = Profile.of(
    CORE,
    name="OpenGL 1.2",
    description="a plain board of the time: one texture unit, texture environments",
    max_texture_size=known(
        2048, "Assumed: 2048, beyond table 6.24's minimum of 64; no board is meant in particular"
    ),
    max_3d_texture_size=known(
        256, "Assumed: 256, beyond table 6.24's minimum of 16; no board is meant in particular"
    ),
    blue_to_alpha=known(False, _NO_COMBINERS),
    final_alpha_from_blue=known(False, _NO_COMBINERS),
    ycbcr_conversion=known(False, _NO_COMBINERS),
    combiner_flags=known(False, _NO_COMBINERS),
    max_point_size=known(
        64.0, "Assumed: 64, beyond table 6.25's minimum of 1; no board is meant in particular"
    ),
    max_line_width=known(
        64.0, "Assumed: 64, beyond table 6.25's minimum of 1; no board is meant in particular"
    ),
    max_viewport=known(2048, "Assumed: 2048; no board is meant in particular"),
    color_bits=known(
        (8,), "Assumed: 8, the usual width; no board is meant in particular (table 6.26: RED_BITS)"
    ),
    depth_bits=known((16, 24), "Assumed: 16 and 24, the usual ones"),
    stencil_bits=known(8, "Assumed: 8, the usual width; the minimum is 1"),
    accumulation_bits=known(16, "Assumed: 16 with the sign, what PC drivers of the time gave"),
    auxiliary_buffers=known(
        2, "Assumed: 2, beyond table 6.25's minimum of none; no board is meant in particular"
    ),
    max_pixel_map_table=known(
        256, "Assumed: 256; OpenGL 1.2.1 section 3.6.3 asks for 32, and no board is meant in particular"
    ),
    fog_arithmetic=known(
        FogArithmetic.ROUNDED, "Assumed: rounding to nearest; OpenGL 1.2.1 section 3.10 leaves it open"
    ),
    guard_band=known(8192, "Assumed: wide enough for what is drawn about the screen"),
    device_origin=known(
        WindowOrigin.UPPER_LEFT,
        "Source: OpenGL 1.2.1 section 2.10.1: window y upwards; the board's count is Assumed",
    ),
    color_weights=known(
        ColorWeights.EXACT, "Assumed: exact, rounded to nearest; what section 3.5.1's equation 3.5 gives"
    ),
    filter_fraction_bits=known(8, "Assumed: 8, as on the NV2A"),
    texture_bits=known(8, "Assumed: 8, as the colour buffer"),
    combiner_bits=known(8, "Assumed: environments are as wide as the colour buffer"),
    combiner_range=known(1.0, _NO_COMBINERS),
    clamp_low=known(-256, _NO_COMBINERS),
    offset_fraction=known(False, "Assumed: whole units; OpenGL 1.2.1 section 3.5.5 does not say"),
    expand_half=known(
        128, "Assumed: 128, where normal maps of the time put zero; no stage of OpenGL 1.2.1 expands"
    ),
    product_rounding=known(ProductRounding.JOINT, "Assumed: one rounding after the sum, as blending's"),
    round_before_scale=known(True, "Assumed: as on the NV2A"),
)

OPENGL_1_2_IMAGING = OPENGL_1_2.descendant(
    name="OpenGL 1.2 with the imaging subset",
    description="the same with the imaging subset: colour tables, convolution, colour matrix, histogram",
    **SUBSET,
    max_color_table_size=known(4096, "Assumed: 4096, for each value of twelve bits; no board in particular"),
    max_convolution_size=known(11, "Assumed: 11, beyond table 6.25's minimum of 3; no board in particular"),
)


# What a query of a driver tells.
OF_QUERIES = (
    "max_texture_size",
    "max_point_size",
    "max_line_width",
    "max_viewport",
    "color_bits",
    "depth_bits",
    "stencil_bits",
    "accumulation_bits",
    "max_pixel_map_table",
)

# What a picture tells, pixel by pixel.
OF_PICTURES = (
    "fog_arithmetic",
    "guard_band",
    "device_origin",
    "color_weights",
    "filter_fraction_bits",
    "product_rounding",
    "round_before_scale",
)

# What only register combiners ask for.
OF_COMBINERS = (
    "blue_to_alpha",
    "ycbcr_conversion",
    "final_alpha_from_blue",
    "combiner_flags",
    "combiner_range",
    "clamp_low",
)


def as_on_the_plain_board(evidence: str, *fields: str) -> dict[str, Any]:
    """Fields of another machine whose values are the plain board's, by ``evidence`` of its own."""
    return {field: known(OPENGL_1_2.facts[field].value, evidence) for field in fields}
