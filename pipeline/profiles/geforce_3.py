"""NVIDIA GeForce 3 (NV20, 2001), the NV2A's desktop sibling: no captures of its own, so inferred."""

from dataclasses import replace

from fixedpipe.pipeline.enums import BaseFormat, TextureCompareMode, TextureShaderOperation
from fixedpipe.pipeline.profiles.geforce_256 import GEFORCE_256
from fixedpipe.pipeline.profiles.nv2a import NV2A


def _inferred(evidence):
    """What was measured on the NV2A is inferred here, and what was not asked of it could be of a driver."""
    if evidence.startswith("Measured:"):
        return f"Inferred: from the NV2A: {evidence.removeprefix('Measured: ')}"
    return evidence.replace("no capture asks for it", "a driver of 2001 would settle it")


GEFORCE_3 = replace(
    NV2A,
    name="GeForce 3",
    description="NVIDIA NV20, 2001: texture shaders, eight general combiners, four texture units",
    blend_equations=GEFORCE_256.blend_equations,
    texture_compare_modes=frozenset({TextureCompareMode.NONE, TextureCompareMode.COMPARE_R_TO_TEXTURE}),
    texture_shader_operations=frozenset(TextureShaderOperation) - {TextureShaderOperation.BRDF_TEXTURE_3D},
    depth_texture_modes=(BaseFormat.INTENSITY, BaseFormat.LUMINANCE, BaseFormat.ALPHA),
    depth_units_in_coordinates=False,
    combiner_flags=GEFORCE_256.combiner_flags,
    foreign_texture_targets=False,
    evidence={
        **{field: _inferred(evidence) for field, evidence in NV2A.evidence.items()},
        "blend_equations": GEFORCE_256.evidence["blend_equations"],
        "texture_shader_operations": "Source: NV_texture_shader, NV_texture_shader2",
        "texture_compare_modes": "Source: ARB_shadow",
        "combine_functions": "Source: ARB_texture_env_combine (of February 2001), ARB_texture_env_dot3",
        "shadow_functions": "Source: EXT_shadow_funcs",
        "depth_texture_modes": "Inferred: INTENSITY, from the NV2A; the others: Source: ARB_depth_texture",
        "foreign_texture_targets": "Source: NV_texture_shader, table 3.B (inconsistent)",
        "depth_units_in_coordinates": "Source: ARB_shadow, NV_texture_shader (DOT_PRODUCT_DEPTH_REPLACE)",
        "combiner_flags": "Source: NV_register_combiners2, which names none of them",
    },
)
