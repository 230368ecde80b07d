"""Validation of a state's fragment stages: combiners, fog, tests and blending."""

from fixedpipe.pipeline.enums import ComponentUsage, FogCoordinateSource
from fixedpipe.pipeline.messages import count, listed
from fixedpipe.pipeline.programs.combiner_rules import (
    TEXTURE_REGISTERS,
    blue_to_alpha_stage,
    combiner_problems,
    nv2a_flag,
    registers_named,
)
from fixedpipe.pipeline.validation import buffers, surfaces


def register_combiners(walk, combiners):
    """Refuse combiners that this machine lacks, or that no machine could have, with any texels."""
    profile, stages = walk.profile, len(combiners.general)
    if profile.combiners.max_general_combiners == 0:
        walk.refuse(f"{profile.name} has no register combiners; choose a profile that has them.")
    if stages == 0:
        walk.refuse(
            "register combiners need at least one general combiner; this pass has none. Add "
            "GeneralCombiner()."
        )
    if stages > profile.combiners.max_general_combiners:
        walk.refuse(
            f"{profile.name} has {count(profile.combiners.max_general_combiners, 'general combiner')}; this "
            f"pass "
            f"uses {stages}. Split the pass or choose a profile with more."
        )
    for number, stage in enumerate(combiners.general):
        own = stage.constant_color0 is not None or stage.constant_color1 is not None
        if own and not profile.combiners.per_stage_constants:
            walk.refuse(
                f"general combiner {number} has its own constant colors; {profile.name} has two for all "
                "stages together. Set constant_color0 and constant_color1 of the RegisterCombiners (of a "
                "pixel shader, give parse_program per_stage_constants=False), or choose a profile with "
                "per-stage constants."
            )
    if not profile.combiners.blue_to_alpha and (number := blue_to_alpha_stage(combiners)) is not None:
        walk.refuse(
            f"general combiner {number} writes its blue into an alpha too (ab_blue_to_alpha, "
            "cd_blue_to_alpha; of a pixel shader, a dp3 whose alpha is read, where every combiner is taken); "
            f"{profile.name} has no such output. Copy blue in an alpha portion of the next general combiner, "
            "or choose a profile with blue_to_alpha."
        )
    if not profile.combiners.combiner_flags and (flag := nv2a_flag(combiners)):
        walk.refuse(
            f"{profile.name} has no {flag}; leave it at its default, or choose a profile with combiner_flags."
        )
    if not profile.combiners.final_alpha_from_blue and combiners.final.g.usage is ComponentUsage.BLUE:
        walk.refuse(
            f"the final combiner's G takes BLUE; G of {profile.name} takes ALPHA alone. Copy blue to an "
            "alpha in a general combiner's alpha portion."
        )
    for _, sentence in combiner_problems(combiners):
        walk.refuse(sentence)
    for place, register in registers_named(combiners):
        if (
            register in TEXTURE_REGISTERS
            and TEXTURE_REGISTERS.index(register) >= profile.textures.max_texture_units
        ):
            walk.refuse(
                f"{place} names {register.name}; {profile.name} has "
                f"{count(profile.textures.max_texture_units, 'texture unit')}, so that register does not "
                f"exist. "
                "Use a spare register, or choose a profile with more."
            )


def fog(walk, fog):
    """Refuse fog of a negative density, or fog that the machine lacks."""
    if fog.density < 0:
        walk.refuse(f"the fog density is {fog.density}; densities are not negative.")
    if fog.registers is not None and not walk.profile.fragments.fog_registers:
        walk.refuse(
            f"{walk.profile.name} has no FogRegisters; give density, or start and end, and leave "
            "fog.registers unset."
        )
    if (
        fog.coordinate_source is FogCoordinateSource.FOG_COORDINATE
        and not walk.profile.vertices.fog_coordinate
    ):
        walk.refuse(f"{walk.profile.name} has no FOG_COORDINATE; use FRAGMENT_DEPTH.")


def window_clip(walk, clip):
    """Refuse a window clip of more rectangles than the machine has."""
    most = walk.profile.fragments.max_window_rectangles
    if not 0 < len(clip.rectangles) <= most:
        walk.refuse(
            f"the window clip has {count(len(clip.rectangles), 'rectangle')}; {walk.profile.name} takes "
            + (f"1 to {most}." if most else "none: use the scissor box or the stencil buffer.")
        )
    for rectangle in clip.rectangles:
        surfaces.scissor(walk, rectangle)


def depth_clamp(walk, limits):
    """Refuse depth limits that the machine lacks, or a maximum below the minimum."""
    if not walk.profile.fragments.depth_clamp:
        walk.refuse(f"{walk.profile.name} has no DEPTH_CLAMP; leave depth_clamp None.")
    if limits.maximum is not None and limits.maximum < limits.minimum:
        walk.refuse(
            f"the depth limits run from {limits.minimum} to {limits.maximum}; give a maximum that is not "
            "below the minimum."
        )


def stencil_test(walk, test):
    """Refuse a stencil test that the machine lacks."""
    buffers.stencil_buffer(walk, "tests the stencil buffer")
    buffers.stencil_value(walk, "the stencil mask", test.mask)
    buffers.stencil_value(walk, "the stencil write_mask", test.write_mask)
    for name in ("fail", "depth_fail", "depth_pass"):
        operation = getattr(test, name)
        if operation not in walk.profile.fragments.stencil_operations:
            walk.refuse(
                f"{walk.profile.name} has no stencil operation {operation.name} ({name}); it has "
                f"{listed(walk.profile.fragments.stencil_operations)}."
            )


def blending(walk, blending):
    """Refuse blend factors and equations that the machine lacks."""
    profile = walk.profile
    for side, factors in (
        ("source", profile.fragments.blend_factors_source),
        ("destination", profile.fragments.blend_factors_destination),
    ):
        factor = getattr(blending, side)
        if factor not in factors:
            walk.refuse(
                f"{profile.name} does not take {factor.name} as its {side} blend factor; it takes "
                f"{listed(factors)}."
            )
    if blending.equation not in profile.fragments.blend_equations:
        walk.refuse(
            f"{profile.name} has no blend equation {blending.equation.name}; it has "
            f"{listed(profile.fragments.blend_equations)}."
        )
