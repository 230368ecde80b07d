"""Matrox G400 (1999): two texture units, environment-mapped bump mapping.

Its stages add, subtract and multiply; there is no dot product of colours (D3DTOP_DOTPRODUCT3, DOT3_RGB).
What no extension says of it is as on the plain board.
"""

from fixedpipe.pipeline.enums import (
    ColorKeyOperation,
    CombineFunction,
    InternalFormat,
    TextureEnvironmentMode,
    TextureShaderOperation,
    TextureTarget,
)
from fixedpipe.pipeline.profiles.known import known
from fixedpipe.pipeline.profiles.opengl_1_2 import (
    OF_COMBINERS,
    OF_PICTURES,
    OF_QUERIES,
    as_on_the_plain_board,
)
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.profiles.specified import CORE, CORE_FORMATS

_NO_VOLUMES = "Assumed: no 3D textures; a G400's driver that lists EXT_texture3D would settle it"
_DRIVER = "Assumed: as on the plain board; a query of a G400's driver would settle it"
_PICTURE = "Assumed: as on the plain board; a picture of a G400 would settle it"
_NO_COMBINERS = "Assumed: does not matter; the G400 has no register combiners"

G400 = Profile.of(
    CORE,
    name="Matrox G400",
    description="Matrox G400, 1999: two texture units, environment-mapped bump mapping by a 2x2 matrix",
    max_texture_units=known(
        2, "Source: Kautz, Seidel 2000, section 5 (most implementations: two texture maps)"
    ),
    max_3d_texture_size=known(0, _NO_VOLUMES),
    texture_targets=known(frozenset({TextureTarget.TEXTURE_1D, TextureTarget.TEXTURE_2D}), _NO_VOLUMES),
    internal_formats=known(
        CORE_FORMATS | {InternalFormat.DSDT8, InternalFormat.DSDT8_MAG8},
        "Source: OpenGL 1.2.1 table 3.16 (requested resolutions are kept); ATI_envmap_bumpmap (DU8DV8); "
        "with a magnitude Assumed, as the scaled lookup: the board's manual would settle it",
    ),
    signed_components=known(True, "Source: ATI_envmap_bumpmap (the offsets of DU8DV8 have signs)"),
    hilo_as_color=known(False, "Source: ATI_envmap_bumpmap (a bump map's unit passes its colour on)"),
    max_lod_bias=known(
        4.0, "Assumed: 4; a MAX_TEXTURE_LOD_BIAS_EXT query of a G400's driver would settle it"
    ),
    color_key_operations=known(
        frozenset({ColorKeyOperation.KILL}),
        "Assumed: as Direct3D 7 asks; a G400's driver with D3DPTEXTURECAPS_TRANSPARENCY would settle it",
    ),
    texture_shader_operations=known(
        frozenset(
            {
                TextureShaderOperation.NONE,
                TextureShaderOperation.TEXTURE_2D,
                TextureShaderOperation.OFFSET_TEXTURE_2D,
                TextureShaderOperation.OFFSET_TEXTURE_2D_SCALE,
            }
        ),
        "Source: Heidrich and others 2000, section 3.3 (a restricted dependent lookup); "
        "ATI_envmap_bumpmap (offsets through a 2x2 matrix); the scaled one Assumed: the board's manual "
        "would settle it",
    ),
    offset_scale_clamped=known(
        True, "Source: WineHQ dlls/d3d9/tests/visual.c, fixed_function_bumpmap_test (1000 L - 1 gives 1)"
    ),
    texture_environment_modes=known(
        frozenset(TextureEnvironmentMode) - {TextureEnvironmentMode.COMBINE4},
        "Source: EXT_texture_env_add, EXT_texture_env_combine; ATI_envmap_bumpmap (a bump map's unit "
        "passes its colour on)",
    ),
    combine_functions=known(
        frozenset(
            {
                CombineFunction.REPLACE,
                CombineFunction.MODULATE,
                CombineFunction.ADD,
                CombineFunction.ADD_SIGNED,
                CombineFunction.INTERPOLATE,
            }
        ),
        "Source: ARB_texture_env_combine (SUBTRACT is what it adds to the EXT one). No DOT3: Source: "
        "Mesa's mga driver (a stage of TDUALSTAGE0 or 1 selects an argument, a sum or a product); "
        "AnandTech, Gigabyte GA-MG400, 2000 (bumps by environment maps, not by Dot Product 3)",
    ),
    color_sum=known(
        True, "Assumed: as EXT_secondary_color has it; a G400's driver that lists it would settle it"
    ),
    auxiliary_buffers=known(0, "Assumed: none; a query of AUX_BUFFERS of a G400's driver would settle it"),
    combiner_bits=known(
        8, "Assumed: environments are as wide as the colour buffer; a picture of a G400 would settle it"
    ),
    offset_fraction=known(False, "Assumed: whole units; a slope drawn on a G400 would settle it"),
    expand_half=known(
        128, "Assumed: as on the NV2A, 128; ADD_SIGNED takes it, and a picture of a G400 would settle it"
    ),
    add_signed_scale_by_four=known(
        True, "Assumed: as EXT_texture_env_combine has it; the board would settle it"
    ),
    **as_on_the_plain_board(_DRIVER, *OF_QUERIES),
    **as_on_the_plain_board(_PICTURE, "texture_bits", *OF_PICTURES),
    **as_on_the_plain_board(_NO_COMBINERS, *OF_COMBINERS),
)
