"""Validation of Draws."""

from operator import itemgetter
from types import NoneType

import numpy as np

from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.enums import ColorBuffer, FogArithmetic, LineRasterization, PolygonMode, VertexStage
from fixedpipe.pipeline.interned_states import interned
from fixedpipe.pipeline.multi_draw import RowDraws
from fixedpipe.pipeline.profiles.profile import NATIVE_SUBPIXEL_BITS
from fixedpipe.pipeline.programs.future import future_problem
from fixedpipe.pipeline.state import Color, PassState, RegisterCombiners, VertexState, needs_normals
from fixedpipe.pipeline.state_kinds import kind_of
from fixedpipe.pipeline.validation import buffers, fragments, surfaces, texture_units, vertices
from fixedpipe.pipeline.validation.meshes import finite_problem, has_infinite_fog, is_usable, mesh_problem


def draw(walk, command):
    """Refuse a Draw whose mesh or state the machine could not draw."""
    mesh, state = command.mesh, interned(command.state)
    if not is_usable(mesh):
        walk.refuse(mesh_problem(mesh))
    walk.warned = False
    pass_state(walk, state)
    _infinite_fog(walk, state, mesh)
    _points_and_lines(walk, state, mesh)
    if state.polygon.stipple is not None and len(state.polygon.stipple) != 128:
        walk.refuse(f"polygon.stipple has {len(state.polygon.stipple)} bytes; give 32 rows of 4, 128 in all.")
    if state.draw_buffer is ColorBuffer.BACK:
        names = tuple(u.texture for u in state.texture_units if u is not None and u.texture is not None)
        beside = walk.beside(mesh, names)
        walk.taken.states.add(state, finding=beside)
        if not walk.warned:
            walk.taken.kinds.add(kind_of(state), finding=beside)


def is_like_another(walk, command, checks):
    """Whether a Draw differs from a checked one only in its vertex state and in constant colours.

    ``checks`` are TypeChecks. Raises UnsupportedState where the vertex state is wrong.
    """
    mesh, state = command.mesh, interned(command.state)
    program = getattr(state, "register_combiners", None)
    if (
        not walk.is_whole(command)
        or type(state) is not PassState
        or type(state.vertex) is not VertexState
        or type(program) not in (NoneType, RegisterCombiners)
        or checks[VertexState](state.vertex)
    ):
        return False
    if program is not None and (
        checks[Color](program.constant_color0) or checks[Color](program.constant_color1)
    ):
        return False
    _, beside = walk.taken.kinds.get(id(kind_of(state)), (None, None))
    if beside is None:
        return False
    if beside != walk.beside(mesh, beside.names):
        return False
    walk.once(vertices.vertex, state.vertex)
    vertices.normals(walk, state)
    walk.taken.states.add(state, finding=beside)
    return True


def representatives(command):
    """(row, Draw) of the rows of a MultiDraw that a machine takes only if it takes all of them.

    Its numbers are finite, so states of which no modelview matrix can be wrong stand for all of their rows.
    """
    rows, found = RowDraws(command), []
    for number, state in enumerate(command.states):
        of_state = np.flatnonzero(command.state_numbers == number).tolist()
        if command.modelview is not None and (needs_normals(state) or state.vertex.modelview1 is not None):
            found += [(row, rows[row]) for row in of_state]
        elif of_state:
            found.append((of_state[0], Draw(label=command.label, mesh=command.mesh, state=state)))
    return sorted(found, key=itemgetter(0))


def pass_state(walk, state):
    """Check the part of the state that Draws and rectangles of pixels share."""
    walk.once(vertices.vertex, state.vertex)
    texture_units.texture_units(walk, state)
    vertices.normals(walk, state)
    combiners = state.register_combiners
    if combiners is not None:
        walk.once(fragments.register_combiners, combiners)
    texture_units.disabled_textures(walk, state)
    if state.color_sum and not walk.profile.fragments.color_sum:
        walk.refuse(
            f"{walk.profile.name} has no color sum of vertices' secondary colors; leave color_sum False. "
            "Lighting(separate_specular_color=True) adds lighting's specular term all the same. For a mesh's "
            "secondary colors, draw it again with them as colors, and Blending(BlendFactor.ONE, "
            "BlendFactor.ONE)."
        )
    if not state.perspective_correction and not walk.profile.primitives.perspective_hint:
        walk.refuse(
            f"{walk.profile.name} always corrects for perspective; leave perspective_correction on, or "
            "give every vertex the same w."
        )
    if state.fog is not None:
        fragments.fog(walk, state.fog)
    if state.scissor is not None:
        surfaces.scissor(walk, state.scissor)
    if state.window_clip is not None:
        fragments.window_clip(walk, state.window_clip)
    if state.stencil_test is not None:
        fragments.stencil_test(walk, state.stencil_test)
    if state.blending is not None:
        fragments.blending(walk, state.blending)
    if state.logic_op is not None and not walk.profile.fragments.logic_op:
        walk.refuse(f"{walk.profile.name} has no logic operations on colors; use blending.")
    if state.depth_clamp is not None:
        fragments.depth_clamp(walk, state.depth_clamp)
    if state.ycbcr_conversion and not walk.profile.combiners.ycbcr_conversion:
        walk.refuse(
            f"{walk.profile.name} converts no texture units' results; leave ycbcr_conversion False and give "
            "a texture of InternalFormat.YCBCR."
        )
    if state.w_buffering and not walk.profile.fragments.w_buffering:
        walk.refuse(f"{walk.profile.name} has no W buffering; leave w_buffering False.")
    buffers.color_buffer(walk, state.draw_buffer)
    if problem := future_problem(state, walk.profile):
        walk.refuse(problem)


def _infinite_fog(walk, state, mesh):
    known = walk.profile.arithmetic.fog_arithmetic == FogArithmetic.TABLE
    if has_infinite_fog(mesh) and not (known and state.vertex.stage == VertexStage.PROGRAM_RESULTS):
        problem = finite_problem("the mesh's fog_coordinates", mesh.fog_coordinates[:, None])
        walk.refuse(
            f"{problem} A vertex program's results alone may have others, where a machine's fog is a table."
        )


def _points_and_lines(walk, state, mesh):
    profile, point, polygon = walk.profile, state.point, state.polygon
    filled = PolygonMode.FILL == polygon.front_mode == polygon.back_mode and polygon.stipple is None
    others = not profile.arithmetic.exact and profile.arithmetic.subpixel_bits != NATIVE_SUBPIXEL_BITS
    if others and not (filled and mesh.primitive.is_polygons and state.window_clip is None):
        walk.refuse(
            f"{profile.name} has {profile.arithmetic.subpixel_bits} subpixel bits, with which filled "
            f"polygons are "
            f"drawn alone, without stipple and window clip; draw these, or keep 4 bits."
        )
    for what, size, most in (
        ("the point size", point.size, profile.primitives.max_point_size),
        ("the line width", state.line.width, profile.primitives.max_line_width),
    ):
        if not 0 <= size <= most:
            walk.refuse(f"{what} is {size}; {profile.name} draws sizes from 0 to {most} pixels. Give one.")
    if problem := _line_problem(state.line, profile):
        walk.refuse(problem)
    if (polygon.smooth or state.line.smooth) and not profile.primitives.smoothing_samples:
        walk.refuse(
            f"{profile.name} has no smooth lines and polygons; leave polygon.smooth and line.smooth "
            "False, or draw several samples."
        )
    if point.parameters is not None and not profile.vertices.point_parameters:
        walk.refuse(f"{profile.name} has no point parameters; give the points one size.")
    if point.parameters is not None and min(point.parameters.attenuation) < 0:
        walk.refuse("point.parameters.attenuation has a negative term; give terms that are not negative.")
    programmed = state.vertex.stage == VertexStage.PROGRAM_RESULTS
    if (point.parameters is not None) if programmed else point.program_size:
        given, other = ("parameters", "program_size") if programmed else ("program_size", "parameters")
        walk.refuse(
            f"point.{given} takes no part where the vertex stage is {state.vertex.stage.name}; use "
            f"point.{other}."
        )
    replaced = [i for i, u in enumerate(state.texture_units) if u is not None and u.coord_replace]
    if wrong := [i for i in replaced if i not in profile.primitives.point_sprite_units]:
        allowed = ", ".join(map(str, sorted(profile.primitives.point_sprite_units))) or "none"
        walk.refuse(
            f"texture unit {wrong[0]} has coord_replace; point sprites of {profile.name} replace the "
            f"coordinates of units: {allowed}. Use another unit, or texture coordinates of the mesh."
        )
    if point.sprite and not profile.primitives.point_sprite_units:
        walk.refuse(f"{profile.name} has no point sprites; draw quads.")


def _line_problem(line, profile):
    """A sentence that says why a machine cannot draw with a LineState, or None."""
    rectangle = line.rasterization == LineRasterization.RECTANGLE
    # The ideal takes both rules, because it is compared with machines of either.
    if rectangle and profile.arithmetic.diamond_exit_lines and not profile.arithmetic.exact:
        return (
            f"{profile.name} draws lines in steps along their longer axis; give line.rasterization STEPS, or "
            "choose a profile without diamond_exit_lines."
        )
    if line.smooth and not rectangle:
        return "smooth lines are rectangles; give line.rasterization RECTANGLE, or smooth False."
    if line.stipple is None:
        return None
    if not profile.primitives.line_stipple:
        return f"{profile.name} has no line stipple; draw the line's parts, or choose another profile."
    if rectangle:
        return "line stipple counts the steps of a line; give line.rasterization STEPS."
    factor, pattern = line.stipple
    if not (1 <= factor <= 256 and 0 <= pattern <= 0xFFFF):
        return (
            f"line.stipple is {line.stipple}; give a factor of 1 to 256 and a pattern of 16 bits, "
            "0 to 0xFFFF."
        )
    return None
