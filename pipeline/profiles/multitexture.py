"""Boards with two texture units and no combiners (TNT class, 1998), unsigned, clamped after every unit; the
Matrox G400; and Schilling's texture memory.

Papers and extensions say little of them: what no board in particular is asked for is as on the plain board.
"""

from dataclasses import replace

from fixedpipe.pipeline.enums import (
    CombineFunction,
    TextureEnvironmentMode,
    TextureShaderOperation,
    TextureTarget,
)
from fixedpipe.pipeline.profiles.opengl_1_2 import OPENGL_1_2

_TWO_UNITS = "Source: Kautz, Seidel 2000, section 5 (most implementations: two texture maps)"
_NO_VOLUMES = "Assumed: no 3D textures; a driver of the time that lists EXT_texture3D would settle it"

MULTITEXTURE = replace(
    OPENGL_1_2,
    name="Multitexture board",
    description="TNT class, 1998: two texture units, unsigned texture environments and no combiners",
    max_texture_units=2,
    max_3d_texture_size=0,
    max_lod_bias=4.0,
    auxiliary_buffers=0,
    texture_targets=frozenset({TextureTarget.TEXTURE_1D, TextureTarget.TEXTURE_2D}),
    texture_environment_modes=frozenset(TextureEnvironmentMode)
    - {TextureEnvironmentMode.COMBINE4, TextureEnvironmentMode.NONE},
    combine_functions=frozenset(
        {
            CombineFunction.REPLACE,
            CombineFunction.MODULATE,
            CombineFunction.ADD,
            CombineFunction.ADD_SIGNED,
            CombineFunction.INTERPOLATE,
        }
    ),
    color_sum=True,
    evidence={
        **OPENGL_1_2.evidence,
        "max_texture_units": _TWO_UNITS,
        "max_3d_texture_size": _NO_VOLUMES,
        "max_lod_bias": "Assumed: 4, as on the GeForce 256; EXT_texture_lod_bias ships since late 1999",
        "auxiliary_buffers": "Assumed: none, as on the GeForce 256",
        "texture_targets": _NO_VOLUMES,
        "texture_environment_modes": "Source: ARB_texture_env_add; ARB_texture_env_combine's EXT predecessor",
        "combine_functions": "Source: ARB_texture_env_combine (SUBTRACT is what it adds to the EXT one)",
        "add_signed_scale_by_four": "Source: NV_texture_env_combine4, NVIDIA Implementation Details (TNT)",
        "color_sum": "Source: NV_register_combiners (the TNT's color sum); EXT_secondary_color",
    },
)

G400 = replace(
    MULTITEXTURE,
    name="Matrox G400",
    description="Matrox G400, 1999: two texture units, environment-mapped bump mapping by a 2x2 matrix",
    texture_shader_operations=frozenset(
        {
            TextureShaderOperation.NONE,
            TextureShaderOperation.TEXTURE_2D,
            TextureShaderOperation.OFFSET_TEXTURE_2D,
            TextureShaderOperation.OFFSET_TEXTURE_2D_SCALE,
        }
    ),
    texture_environment_modes=MULTITEXTURE.texture_environment_modes | {TextureEnvironmentMode.NONE},
    signed_components=True,
    add_signed_scale_by_four=True,
    evidence={
        **MULTITEXTURE.evidence,
        "texture_environment_modes": "Source: EXT_texture_env_add, EXT_texture_env_combine; "
        "ATI_envmap_bumpmap (a bump map's unit passes its colour on)",
        "add_signed_scale_by_four": "Assumed: as EXT_texture_env_combine has it; the board would settle it",
        "texture_shader_operations": "Source: Heidrich and others 2000, section 3.3 (a restricted dependent "
        "lookup); ATI_envmap_bumpmap (offsets through a 2x2 matrix); the scaled one Assumed: the "
        "board's manual would settle it",
        "signed_components": "Source: ATI_envmap_bumpmap (the offsets of DU8DV8 have signs)",
    },
)

TEXRAM = replace(
    OPENGL_1_2,
    name="TEXRAM",
    description="Schilling's texture memory, 1996: footprint assembly, offset-vector bump maps",
    max_texture_units=2,
    max_3d_texture_size=0,
    max_probes=8,
    auxiliary_buffers=0,
    texture_targets=frozenset({TextureTarget.TEXTURE_1D, TextureTarget.TEXTURE_2D}),
    texture_shader_operations=G400.texture_shader_operations
    - {TextureShaderOperation.OFFSET_TEXTURE_2D_SCALE},
    texture_environment_modes=OPENGL_1_2.texture_environment_modes | {TextureEnvironmentMode.NONE},
    signed_components=True,
    evidence={
        **OPENGL_1_2.evidence,
        "max_texture_units": "Inferred: from its bump maps: one unit has the offsets, one what they displace",
        "max_3d_texture_size": _NO_VOLUMES,
        "max_probes": "Assumed: 8; Schilling, Knittel, Strasser 1996 would settle it",
        "auxiliary_buffers": "Assumed: none, as on the GeForce 256",
        "texture_targets": _NO_VOLUMES,
        "texture_shader_operations": "Source: Schilling 1997, section 7 (bump maps of offset vectors); their "
        "form Assumed: as on the G400",
        "texture_environment_modes": "Source: OpenGL 1.2.1 section 3.8.9; Inferred: a bump map's unit passes "
        "its colour on, as in ATI_envmap_bumpmap",
        "signed_components": "Inferred: from Schilling 1997's offset vectors, which have signs",
    },
)
