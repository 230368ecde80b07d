"""Schilling's texture memory, TEXRAM (1996): footprint assembly, bump maps of offset vectors.

What Schilling's paper of 1997 does not say of it is as on the plain board.
"""

from fixedpipe.pipeline.enums import TextureEnvironmentMode, TextureShaderOperation, TextureTarget
from fixedpipe.pipeline.profiles.known import known
from fixedpipe.pipeline.profiles.opengl_1_2 import (
    OF_COMBINERS,
    OF_PICTURES,
    OF_QUERIES,
    as_on_the_plain_board,
)
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.profiles.specified import CORE, CORE_ENVIRONMENTS

_PAPER = "Assumed: as on the plain board; Schilling, Knittel, Strasser 1996 would settle it"
_NO_VOLUMES = "Assumed: no 3D textures; Schilling, Knittel, Strasser 1996 would settle it"
_NO_COMBINERS = "Assumed: does not matter; TEXRAM has no register combiners"

TEXRAM = Profile.of(
    CORE,
    name="TEXRAM",
    description="Schilling's texture memory, 1996: footprint assembly, offset-vector bump maps",
    max_texture_units=known(
        2, "Inferred: from its bump maps: one unit has the offsets, one what they displace"
    ),
    max_3d_texture_size=known(0, _NO_VOLUMES),
    texture_targets=known(frozenset({TextureTarget.TEXTURE_1D, TextureTarget.TEXTURE_2D}), _NO_VOLUMES),
    signed_components=known(True, "Inferred: from Schilling 1997's offset vectors, which have signs"),
    max_probes=known(8, "Assumed: 8; Schilling, Knittel, Strasser 1996 would settle it"),
    exact_probes=known(False, "Source: Schilling, Knittel, Strasser 1996 (a power of two, so a shift)"),
    texture_shader_operations=known(
        frozenset(
            {
                TextureShaderOperation.NONE,
                TextureShaderOperation.TEXTURE_2D,
                TextureShaderOperation.OFFSET_TEXTURE_2D,
            }
        ),
        "Source: Schilling 1997, section 7 (bump maps of offset vectors); their form Assumed: as on the G400",
    ),
    texture_environment_modes=known(
        CORE_ENVIRONMENTS | {TextureEnvironmentMode.NONE},
        "Source: OpenGL 1.2.1 section 3.8.9; Inferred: a bump map's unit passes its colour on, as in "
        "ATI_envmap_bumpmap",
    ),
    auxiliary_buffers=known(0, "Assumed: none; Schilling, Knittel, Strasser 1996 would settle it"),
    combiner_bits=known(
        8,
        "Assumed: environments are as wide as the colour buffer; Schilling, Knittel, Strasser 1996 "
        "would settle it",
    ),
    offset_fraction=known(False, "Assumed: whole units; the chip was never sold"),
    expand_half=known(128, "Assumed: as on the plain board, 128; no stage of TEXRAM's expands"),
    **as_on_the_plain_board(_PAPER, "texture_bits", *OF_QUERIES, *OF_PICTURES),
    **as_on_the_plain_board(_NO_COMBINERS, *OF_COMBINERS),
)
