"""Boards with two texture units and no combiners (TNT class, 1998); the Matrox G400; and Schilling's texture
memory. Unsigned, clamped after every unit.
"""

from dataclasses import replace

from pipeline.enums import CombineFunction, TextureEnvironmentMode, TextureShaderOperation, TextureTarget
from pipeline.profiles.opengl_1_2 import OPENGL_1_2

_TWO_UNITS = "Source: ARB_multitexture (MAX_TEXTURE_UNITS_ARB at least 2)"

MULTITEXTURE = replace(
    OPENGL_1_2,
    name="Multitexture board",
    description="two texture units and no combiners (TNT class): texture environments, unsigned",
    max_texture_units=2,
    max_3d_texture_size=0,
    max_lod_bias=4.0,
    texture_targets=frozenset({TextureTarget.TEXTURE_1D, TextureTarget.TEXTURE_2D}),
    texture_environment_modes=frozenset(TextureEnvironmentMode) - {TextureEnvironmentMode.COMBINE4},
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
        "max_3d_texture_size": "Assumed: 0; a driver of the time that lists EXT_texture3D would settle it",
        "max_lod_bias": "Assumed: 4, as on the GeForce 256, with EXT_texture_lod_bias",
        "texture_targets": "Assumed: no 3D textures, as on the boards of the class",
        "texture_environment_modes": "Source: EXT_texture_env_add, EXT_texture_env_combine",
        "combine_functions": "Source: EXT_texture_env_combine",
        "color_sum": "Source: EXT_secondary_color",
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
    signed_components=True,
    evidence={
        **MULTITEXTURE.evidence,
        "texture_shader_operations": "Source: document 003 (environment-mapped bump mapping on the G400); "
        "Direct3D 6's BUMPENVMAP and BUMPENVMAPLUMINANCE",
        "signed_components": "Source: Direct3D 6's formats V8U8 and X8L8V8U8, whose offsets are signed",
    },
)

TEXRAM = replace(
    OPENGL_1_2,
    name="TEXRAM",
    description="Schilling's texture memory, 1996: footprint assembly, offset-vector bump maps",
    max_texture_units=2,
    max_3d_texture_size=0,
    max_probes=8,
    texture_targets=frozenset({TextureTarget.TEXTURE_1D, TextureTarget.TEXTURE_2D}),
    texture_shader_operations=G400.texture_shader_operations
    - {TextureShaderOperation.OFFSET_TEXTURE_2D_SCALE},
    signed_components=True,
    evidence={
        **OPENGL_1_2.evidence,
        "max_texture_units": "Inferred: from document 001's bump maps: an offset map and what it displaces",
        "max_3d_texture_size": "Source: Schilling, Knittel, Strasser 1996: images alone",
        "max_probes": "Source: document 001, figure 2 (eight probes)",
        "texture_targets": "Source: Schilling, Knittel, Strasser 1996: images alone",
        "texture_shader_operations": "Source: document 001: bump mapping by offset vectors",
        "signed_components": "Inferred: from document 001's offset vectors, which have signs",
    },
)
