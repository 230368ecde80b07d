"""Boards with two texture units and no combiners (TNT class, 1998), unsigned, clamped after every unit.

Papers and extensions say little of them: what they say nothing of is as on the plain board.
"""

from fixedpipe.pipeline.enums import CombineFunction, TextureEnvironmentMode, TextureTarget
from fixedpipe.pipeline.profiles.known import known
from fixedpipe.pipeline.profiles.opengl_1_2 import (
    OF_COMBINERS,
    OF_PICTURES,
    OF_QUERIES,
    as_on_the_plain_board,
)
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.profiles.specified import CORE

_NO_VOLUMES = "Assumed: no 3D textures; a driver of the time that lists EXT_texture3D would settle it"
_DRIVER = "Assumed: as on the plain board; a query of a TNT's driver would settle it"
_PICTURE = "Assumed: as on the plain board; a picture of a TNT would settle it"
_NO_COMBINERS = "Assumed: does not matter; the TNT has no register combiners"

MULTITEXTURE = Profile.of(
    CORE,
    name="Multitexture board",
    description="TNT class, 1998: two texture units, unsigned texture environments and no combiners",
    max_texture_units=known(
        2, "Source: Kautz, Seidel 2000, section 5 (most implementations: two texture maps)"
    ),
    max_3d_texture_size=known(0, _NO_VOLUMES),
    texture_targets=known(frozenset({TextureTarget.TEXTURE_1D, TextureTarget.TEXTURE_2D}), _NO_VOLUMES),
    max_lod_bias=known(4.0, "Assumed: 4, as on the GeForce 256; EXT_texture_lod_bias ships since late 1999"),
    texture_environment_modes=known(
        frozenset(TextureEnvironmentMode) - {TextureEnvironmentMode.COMBINE4, TextureEnvironmentMode.NONE},
        "Source: ARB_texture_env_add; ARB_texture_env_combine's EXT predecessor",
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
        "Source: ARB_texture_env_combine (SUBTRACT is what it adds to the EXT one)",
    ),
    color_sum=known(True, "Source: NV_register_combiners (the TNT's color sum); EXT_secondary_color"),
    auxiliary_buffers=known(0, "Assumed: none, as on the GeForce 256"),
    combiner_bits=known(
        8, "Assumed: environments are as wide as the colour buffer; a picture of a TNT would settle it"
    ),
    offset_fraction=known(False, "Assumed: whole units; no board of the time is known to differ"),
    expand_half=known(128, "Inferred: from the NV2A's half of 128; ADD_SIGNED takes it"),
    add_signed_scale_by_four=known(
        False, "Source: NV_texture_env_combine4, NVIDIA Implementation Details (TNT)"
    ),
    **as_on_the_plain_board(_DRIVER, *OF_QUERIES),
    **as_on_the_plain_board(_PICTURE, "texture_bits", *OF_PICTURES),
    **as_on_the_plain_board(_NO_COMBINERS, *OF_COMBINERS),
)
