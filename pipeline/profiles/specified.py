"""What OpenGL 1.2.1 specifies: sets that machines take whole, and evidence that holds of any machine."""

from fixedpipe.pipeline.enums import (
    BlendEquation,
    BlendFactor,
    StencilOperation,
    TexGenMode,
    TextureEnvironmentMode,
    TextureTarget,
    WrapMode,
)
from fixedpipe.pipeline.textures.images import COMPONENT_BITS

# Evidence for what a machine lacks because OpenGL does not ask for it, and for the imaging subset.
NOT_CORE = "Source: OpenGL 1.2.1: no part of it"
OF_SUBSET_ALONE = "Source: OpenGL 1.2.1 section 3.6.2: part of the imaging subset alone"
# Section 3.6.5 names GetTexImage under convolution; SGI's Sample Implementation 1.2.1 keeps to section 6.1.4.
UNTOUCHED_QUERIES = "Source: OpenGL 1.2.1 section 6.1.4: no pixel transfer operations"
TRANSFERRED_QUERIES = "Source: EXT_convolution, EXT_texture3D, of images that GetTexImage returns"
OF_SUBSET = "Source: OpenGL 1.2.1 section 3.6.2, the imaging subset"

# Sections 3.8, 3.8.1 (table 3.16, up to eight bits), 3.8.4, 2.10.4, 3.8.9 and 4.1.4.
CORE_TARGETS = frozenset({TextureTarget.TEXTURE_1D, TextureTarget.TEXTURE_2D, TextureTarget.TEXTURE_3D})
CORE_FORMATS = frozenset(COMPONENT_BITS)
CORE_WRAP_MODES = frozenset({WrapMode.REPEAT, WrapMode.CLAMP, WrapMode.CLAMP_TO_EDGE})
CORE_TEXGEN_MODES = frozenset(
    {TexGenMode.NONE, TexGenMode.OBJECT_LINEAR, TexGenMode.EYE_LINEAR, TexGenMode.SPHERE_MAP}
)
CORE_ENVIRONMENTS = frozenset(
    {
        TextureEnvironmentMode.MODULATE,
        TextureEnvironmentMode.REPLACE,
        TextureEnvironmentMode.DECAL,
        TextureEnvironmentMode.BLEND,
    }
)
CORE_STENCIL_OPERATIONS = frozenset(StencilOperation) - {
    StencilOperation.INCR_WRAP,
    StencilOperation.DECR_WRAP,
}

# Tables 4.1 and 4.2, and what the imaging subset (or EXT_blend_color) adds to both.
CONSTANT_FACTORS = frozenset(
    {
        BlendFactor.CONSTANT_COLOR,
        BlendFactor.ONE_MINUS_CONSTANT_COLOR,
        BlendFactor.CONSTANT_ALPHA,
        BlendFactor.ONE_MINUS_CONSTANT_ALPHA,
    }
)
CORE_SOURCE_FACTORS = (
    frozenset(BlendFactor) - CONSTANT_FACTORS - {BlendFactor.SRC_COLOR, BlendFactor.ONE_MINUS_SRC_COLOR}
)
CORE_DESTINATION_FACTORS = (
    frozenset(BlendFactor)
    - CONSTANT_FACTORS
    - {BlendFactor.DST_COLOR, BlendFactor.ONE_MINUS_DST_COLOR, BlendFactor.SRC_ALPHA_SATURATE}
)

# Section 4.1.6: the imaging subset's, which are also those of EXT_blend_minmax and EXT_blend_subtract.
SUBSET_EQUATIONS = frozenset(
    {
        BlendEquation.FUNC_ADD,
        BlendEquation.FUNC_SUBTRACT,
        BlendEquation.FUNC_REVERSE_SUBTRACT,
        BlendEquation.MIN,
        BlendEquation.MAX,
    }
)
