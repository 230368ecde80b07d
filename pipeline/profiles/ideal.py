"""No machine at all: float64 everywhere, and limits only where a state could not say more.

``pipeline.ideal`` evaluates passes on it.
"""

from dataclasses import fields, replace

from pipeline.enums import BlendFactor
from pipeline.profile import Profile
from pipeline.profiles.geforce_256 import GEFORCE_256

_BY_DEFINITION = "Assumed: nothing; limits are what a state can say, or far beyond any machine of the time"

IDEAL = replace(
    GEFORCE_256,
    name="ideal",
    description="float64 throughout: what the algorithm itself gives",
    exact=True,
    max_texture_units=4,
    max_general_combiners=8,
    per_stage_constants=True,
    max_texture_size=1 << 14,
    max_cube_map_texture_size=1 << 14,
    power_of_two_textures=False,
    max_lod_bias=16.0,
    max_anisotropy=1.0,
    max_lights=64,
    max_clip_planes=64,
    max_viewport=1 << 13,
    expand_half=127.5,
    blend_factors_source=frozenset(BlendFactor),
    blend_factors_destination=frozenset(BlendFactor),
    evidence={
        f.name: _BY_DEFINITION for f in fields(Profile) if f.name not in ("name", "description", "evidence")
    },
)
