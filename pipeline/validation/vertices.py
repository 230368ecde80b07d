"""Validation of a state's vertex stage."""

from dataclasses import fields

from fixedpipe.pipeline.enums import LightingArithmetic, VertexStage
from fixedpipe.pipeline.messages import count, shown
from fixedpipe.pipeline.state import Light, Lighting, Material, VertexState, needs_normals
from fixedpipe.pipeline.vertices.arithmetic import invert_upper_left


def vertex(walk, vertex):
    """Refuse a vertex stage that the machine lacks."""
    if vertex.stage == VertexStage.PROGRAM_RESULTS:
        if walk.profile.arithmetic.exact:
            walk.refuse(
                f"the vertex stage is PROGRAM_RESULTS, whose depths are a buffer's words; "
                f"{walk.profile.name} has no such buffer: choose FIXED_FUNCTION, or a machine."
            )
        plain = VertexState(
            stage=VertexStage.PROGRAM_RESULTS,
            two_side=vertex.two_side,
            secondary_color=vertex.secondary_color,
        )
        for field in fields(vertex):
            if getattr(vertex, field.name) != getattr(plain, field.name):
                walk.refuse(
                    f"vertex.{field.name} is set, but the vertex stage is PROGRAM_RESULTS: the mesh "
                    "holds window coordinates and final colors; choose FIXED_FUNCTION, or leave it unset."
                )
    elif vertex.two_side:
        walk.refuse(
            "vertex.two_side is VERTEX_PROGRAM_TWO_SIDE, but the vertex stage is FIXED_FUNCTION; set "
            "lighting.two_side, or leave it unset."
        )
    _unit_only(walk, "vertex", vertex, VertexState(), ("secondary_color",))
    if vertex.composite is not None:
        _composite(walk, vertex)
    if vertex.modelview1 is not None:
        _weighting(walk, vertex)
    _viewport(walk, vertex.viewport)
    if len(vertex.clip_planes) > walk.profile.vertices.max_clip_planes:
        walk.refuse(
            f"{walk.profile.name} has {count(walk.profile.vertices.max_clip_planes, 'clip plane')}; this "
            f"pass "
            f"enables {len(vertex.clip_planes)}. Clip the mesh, or draw it in parts."
        )
    if vertex.lighting is not None:
        _lighting(walk, vertex.lighting)


def _unit_only(walk, path, given, plain, names):
    """Refuse fields of ``given`` that only a lighting unit has, where they differ from ``plain``."""
    if walk.profile.arithmetic.lighting is LightingArithmetic.LIGHTING_UNIT:
        return
    for name in names:
        if getattr(given, name) != getattr(plain, name):
            walk.refuse(
                f"{path}.{name} is {shown(getattr(given, name))}; {walk.profile.name} computes lighting "
                "by OpenGL's equations, which have no such thing. Leave it unset, or choose a profile "
                "with a lighting unit."
            )


def _composite(walk, vertex):
    if not walk.profile.vertices.composite_matrix:
        walk.refuse(
            f"{walk.profile.name} has no Composite; give the projection matrix and the viewport instead."
        )
    plain = VertexState()
    for name in ("projection", "viewport"):
        if getattr(vertex, name) != getattr(plain, name):
            walk.refuse(
                f"vertex.{name} is set beside vertex.composite, which takes its place; leave one of them "
                "unset."
            )


def normals(walk, state):
    """Refuse a modelview matrix whose determinant is not finite, where the state transforms normals by it."""
    if needs_normals(state):
        walk.once(_inverse, state.vertex)


def _inverse(walk, vertex):
    try:
        for matrix in vertex.modelviews:
            invert_upper_left(matrix)
    except ValueError as error:
        walk.refuse(f"{error}.")


def _weighting(walk, vertex):
    if not walk.profile.vertices.vertex_weighting:
        walk.refuse(
            f"{walk.profile.name} has no vertex weighting (EXT_vertex_weighting); leave vertex.modelview1 "
            "None, and weight the mesh's positions and normals before they are drawn."
        )
    if vertex.modelview[3] != vertex.modelview1[3]:
        walk.refuse(
            f"the last row of vertex.modelview is {vertex.modelview[3]}, and that of vertex.modelview1 "
            f"{vertex.modelview1[3]}; vertex weighting takes w from the first matrix alone. Give the same "
            "last row, and leave perspective to the projection matrix."
        )


def _viewport(walk, viewport):
    profile = walk.profile
    width = walk.width if viewport.width is None else viewport.width
    height = walk.height if viewport.height is None else viewport.height
    if width < 0 or height < 0:
        walk.refuse(f"the viewport is {width}x{height}; give sizes that are not negative.")
    if max(width, height) > profile.framebuffers.max_viewport:
        walk.refuse(
            f"the viewport is {width}x{height}; {profile.name} takes up to "
            f"{profile.framebuffers.max_viewport}x{profile.framebuffers.max_viewport}."
        )
    for name in ("near", "far"):
        if not 0 <= getattr(viewport, name) <= 1:
            walk.refuse(f"the depth range's {name} is {getattr(viewport, name)}; give a number from 0 to 1.")


def _lighting(walk, lighting):
    profile = walk.profile
    if len(lighting.lights) > profile.vertices.max_lights:
        walk.refuse(
            f"{profile.name} has {count(profile.vertices.max_lights, 'light')}; this pass enables "
            f"{len(lighting.lights)}. Add the others in a second pass with blending ONE, ONE."
        )
    if lighting.separate_specular_color and not profile.vertices.separate_specular_color:
        walk.refuse(f"{profile.name} has no SEPARATE_SPECULAR_COLOR; use single color, or a second pass.")
    unit = ("front_sources", "back_sources", "back_model_ambient", "viewer_direction")
    _unit_only(walk, "lighting", lighting, Lighting(), unit)
    for face in ("front", "back"):
        _unit_only(walk, f"lighting.{face}", getattr(lighting, face), Material(), ("specular_coefficients",))
        shininess = getattr(lighting, face).shininess
        if not 0 <= shininess <= profile.vertices.max_shininess:
            walk.refuse(
                f"the {face} material's shininess is {shininess}; {profile.name} takes 0 to "
                f"{profile.vertices.max_shininess}."
            )
    has_unit = profile.arithmetic.lighting is LightingArithmetic.LIGHTING_UNIT
    for i, light in enumerate(lighting.lights):
        unit = ("range", "half_vector", "spot", "back_ambient", "back_diffuse", "back_specular")
        _unit_only(walk, f"light {i}", light, Light(), unit)
        directional = light.position[3] == 0
        for name in ("range", "spot") if directional else ("half_vector",):
            if getattr(light, name) is not None:
                kind = "directional" if directional else "positional"
                walk.refuse(f"light {i} is {kind}, and such a light has no {name}; leave it None.")
        if has_unit and light.spot_cutoff != 180:
            if light.spot is not None:
                walk.refuse(
                    f"light {i} has a spot cutoff, {light.spot_cutoff} degrees, and a spot, which takes its "
                    "place; leave the cutoff at 180, or the spot None."
                )
            if directional:
                walk.refuse(
                    f"light {i} is directional, and its spot cutoff is {light.spot_cutoff} degrees; "
                    f"{profile.name}'s lighting unit has spotlights with a position alone. Leave the cutoff "
                    "at 180, and multiply the light's colours by the cone's factor, the same everywhere."
                )
        if not 0 <= light.spot_exponent <= profile.vertices.max_shininess:
            walk.refuse(
                f"light {i}'s spot exponent is {light.spot_exponent}; {profile.name} takes 0 to "
                f"{profile.vertices.max_shininess}."
            )
        if not (0 <= light.spot_cutoff <= 90 or light.spot_cutoff == 180):
            walk.refuse(
                f"light {i}'s spot cutoff is {light.spot_cutoff} degrees; give 0 to 90, or 180 for no spot."
            )
        attenuation = (light.constant_attenuation, light.linear_attenuation, light.quadratic_attenuation)
        if min(attenuation) < 0:
            walk.refuse(f"light {i}'s attenuation is {attenuation}; attenuations are not negative.")
        if light.position[3] != 0 and max(attenuation) == 0 and not has_unit:
            walk.refuse(
                f"light {i}'s attenuations are all zero, which divides by zero; give a constant attenuation."
            )
