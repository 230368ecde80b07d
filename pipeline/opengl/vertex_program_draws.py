"""Vertex programs on the host: NV_vertex_program's calls, and the vertices that a program computes.

A program runs here, in the arithmetic of the NV20's transform unit (``vertices.vertex_programs``;
docs/numbers.md section 2): 24 significant bits, its own reciprocals, logarithms and powers. The machine gets
its positions as clip coordinates, with identity matrices; colours, fog and texture coordinates become those
of the vertices. So machines without vertex programs can draw them, as drivers of 2001 did on the processor.

Attributes are the conventional ones with the same number (NV_vertex_program, "Vertex Attributes"). Assumed: a
program reads only x of attributes 1 and 5; attributes 6 and 7 are constant in a draw.
"""

import re
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from fixedpipe.pipeline.commands import Mesh
from fixedpipe.pipeline.enums import FogCoordinateSource
from fixedpipe.pipeline.opengl import arb_program_state, tokens
from fixedpipe.pipeline.opengl.arb_program_text import ArbProgram
from fixedpipe.pipeline.opengl.current import COORDINATE_SETS, filled, register_attributes
from fixedpipe.pipeline.opengl.entry_points import entry
from fixedpipe.pipeline.opengl.matrices import PROGRAM_MATRICES, inverse, multiplied, top
from fixedpipe.pipeline.opengl.meshes import make_mesh
from fixedpipe.pipeline.opengl.outcomes import GLError, Refused
from fixedpipe.pipeline.opengl.values import declare
from fixedpipe.pipeline.opengl.vertex_program_objects import (
    PARAMETERS,
    check_target,
    give_text,
    register_parameters,
    set_environment,
)
from fixedpipe.pipeline.state import PassState, TexGen, VertexState
from fixedpipe.pipeline.vertices.vertex_programs import VertexProgram, vertex_program

ENABLED = ("enabled", tokens.VERTEX_PROGRAM_NV)
_HEADER = re.compile(r"\s*!!(VP1\.[01])(.*?)END\s*\Z", re.DOTALL)
# The interpreter's name of each attribute, by number. The interpreter's own numbers are the NV2A's.
_INPUTS = ("OPOS", "WGHT", "NRML", "COL0", "COL1", "FOGC", 6, 7, "TEX0", "TEX1", "TEX2", "TEX3", 13, 14, 15)
_OPTION = re.compile(r"\s*OPTION\s+NV_position_invariant\s*;")
_INPUT = re.compile(r"\bv\[\s*(?:(\d+)|TEX([4-7]))\s*\]")

declare("tracked matrices", ())
for _number in (6, 7):
    declare(("vertex attribute", _number), (0.0, 0.0, 0.0, 1.0))


# ----------------------------------------------------------------------------------------------- programs


@dataclass(frozen=True)
class NvProgram:
    """An assembled program.

    - ``program``: its instructions.
    - ``keeps_position``: whether the fixed functions compute the position.
    """

    program: VertexProgram
    keeps_position: bool


@lru_cache(maxsize=64)
def assembled(text: str) -> NvProgram:
    """The program of a text of NV_vertex_program, or of NV_vertex_program1_1. Raises ValueError for a wrong
    text.
    """
    found = _HEADER.match(text)
    if found is None:
        raise ValueError("it does not begin with !!VP1.0 or !!VP1.1 and end with END")
    version, body = found[1], "\n".join(line.partition("#")[0] for line in found[2].splitlines())
    option = _OPTION.match(body) if version == "VP1.1" else None
    if option:
        body = body[option.end() :]
        if "o[HPOS]" in re.sub(r"\s", "", body):
            raise ValueError("the option NV_position_invariant forbids to write o[HPOS]")
    if version == "VP1.1":
        body = ";".join(map(_of_version_1_0, body.split(";")))
    return NvProgram(vertex_program(_INPUT.sub(_input, body)), option is not None)


def _of_version_1_0(statement):
    """A statement, in which ADD stands for SUB and MAX for ABS, as in ARB programs (arb_program_text)."""
    word, _, rest = " ".join(statement.split()).partition(" ")
    parts = [part.strip() for part in rest.split(",")]
    if word == "SUB" and len(parts) == 3:
        return f"ADD {parts[0]}, {parts[1]}, {parts[2][1:] if parts[2][0:1] == '-' else '-' + parts[2]}"
    if word == "ABS" and len(parts) == 2:
        size = parts[1].lstrip("-")
        return f"MAX {parts[0]}, {size}, -{size}"
    return statement


def _input(found):
    number = int(found[1]) if found[1] else 8 + int(found[2])
    if number >= len(_INPUTS):
        raise ValueError(f"attribute {number} is not read here")
    return f"v[{_INPUTS[number]}]"


@entry("LoadProgramNV", compiled=False)
def load_program(gl, target, name, length, text):
    """Set the text of a program."""
    if target == tokens.VERTEX_STATE_PROGRAM_NV:
        raise Refused("vertex state programs are not carried out here")
    check_target(target)
    give_text(gl, name, length, text, assembled)


@entry("RequestResidentProgramsNV", "AreProgramsResidentNV", compiled=False)
def resident_programs(gl, *arguments):
    """Do nothing, because the memory of programs has no effect here."""
    gl.tally.add("no effect", gl.called)


# --------------------------------------------------------------------------------------------- parameters


register_parameters("ProgramParameter", "NV", set_environment, "fd")


def _inverse(matrix):
    found = inverse(matrix)
    if found is None:
        raise Refused("a tracked matrix has no inverse")
    return found


_TRANSFORMS = {
    tokens.IDENTITY_NV: lambda m: m,
    tokens.INVERSE_NV: _inverse,
    tokens.TRANSPOSE_NV: lambda m: tuple(zip(*m, strict=True)),
    tokens.INVERSE_TRANSPOSE_NV: lambda m: tuple(zip(*_inverse(m), strict=True)),
}
_MATRICES = {
    tokens.MODELVIEW: lambda gl: top(gl, "modelview"),
    tokens.PROJECTION: lambda gl: top(gl, "projection"),
    tokens.COLOR: lambda gl: top(gl, "color matrix"),
    tokens.TEXTURE: lambda gl: top(gl, ("texture matrix", gl.values["active_texture"])),
    tokens.MODELVIEW_PROJECTION_NV: lambda gl: multiplied(top(gl, "projection"), top(gl, "modelview")),
    **{
        tokens.TEXTURE0 + unit: lambda gl, unit=unit: top(gl, ("texture matrix", unit))
        for unit in range(COORDINATE_SETS)
    },
    **{
        tokens.MATRIX0_NV + number: lambda gl, number=number: top(gl, ("program matrix", number))
        for number in range(PROGRAM_MATRICES)
    },
}


@entry("TrackMatrixNV")
def track_matrix(gl, target, address, matrix, transform):
    """Let four parameters follow a matrix. NONE ends this."""
    if target != tokens.VERTEX_PROGRAM_NV or transform not in _TRANSFORMS:
        raise GLError(tokens.INVALID_ENUM)
    if address % 4 or not 0 <= address < PARAMETERS:
        raise GLError(tokens.INVALID_VALUE, f"parameters {address} to {address + 3} of {PARAMETERS}")
    if matrix != tokens.NONE and matrix not in _MATRICES:
        raise Refused(f"{tokens.name_of(matrix)} is not tracked here")
    kept = tuple([each for each in gl.values["tracked matrices"] if each[0] != address])
    more = () if matrix == tokens.NONE else ((address, matrix, transform),)
    gl.values.set("tracked matrices", kept + more)


def _constants(gl):
    constants = dict(enumerate(gl.values["program parameters"]))
    for address, matrix, transform in gl.values["tracked matrices"]:
        rows = _TRANSFORMS[transform](_MATRICES[matrix](gl))
        constants |= {address + n: tuple(map(float, row)) for n, row in enumerate(rows)}
    return constants


# --------------------------------------------------------------------------------------------- attributes


def set_attribute(gl: Any, number: int, components: tuple[float, ...]) -> None:
    """Set attribute 6 or 7, which are not conventional ones."""
    gl.values.set(("vertex attribute", number), filled(components))


register_attributes(set_attribute)

# -------------------------------------------------------------------------------------------------- draws

# Columns that a vertex program may read.
COLUMNS = {
    "texture_coordinates": COORDINATE_SETS - 1,
    "normals": 1,
    "secondary_colors": 1,
    "fog_coordinates": 1,
    "weights": 1,
    "edge_flags": 1,
}


def programmed_mesh(gl: Any, mesh: Mesh) -> Mesh:
    """The mesh of the vertices that the bound program computes from a mesh.

    Raises Refused without a program, and LeftOut if a result is infinite or NaN.
    """
    program = gl.shared.programs.get(gl.values["vertex program"])
    if program is None:
        raise Refused("VERTEX_PROGRAM_NV is enabled, and the bound program has no text that is known here")
    for token in (tokens.VERTEX_PROGRAM_TWO_SIDE_NV, tokens.VERTEX_PROGRAM_POINT_SIZE_NV):
        if gl.values[("enabled", token)]:
            raise Refused(f"{tokens.name_of(token)} is enabled; a program's {_WRITTEN[token]} not drawn here")
    # A missing w of a normal or colour is 1, as for positions.
    given = {
        "OPOS": mesh.positions,
        "WGHT": _column(mesh.weights),
        "NRML": mesh.normals,
        "COL0": mesh.colors,
        "COL1": mesh.secondary_colors,
        "FOGC": _column(mesh.fog_coordinates),
        **{_INPUTS[8 + n]: each for n, each in enumerate(mesh.texture_coordinates[: len(_INPUTS) - 8])},
        **{n: gl.values[("vertex attribute", n)] for n in (6, 7)},
    }
    if isinstance(program, ArbProgram):
        constants = {number: arb_program_state.numbers(gl, row) for number, row in enumerate(program.rows)}
    else:
        constants = _constants(gl)
    results = program.program.run({key: each for key, each in given.items() if each is not None}, constants)
    count = len(mesh.positions)
    missing = np.broadcast_to((0.0, 0.0, 0.0, 1.0), (count, 4))
    units = [results.get(f"TEX{n}", missing) for n in range(4)]
    columns = {
        "positions": mesh.positions if program.keeps_position else results.get("HPOS", missing),
        "colors": results.get("COL0", missing),
        "secondary_colors": results.get("COL1", missing),
        "fog_coordinates": results.get("FOGC", np.zeros(count)),
        "texture_coordinates": units,
    }
    if mesh.edge_flags is not None:
        columns["edge_flags"] = mesh.edge_flags
    gl.tally.add("lit here", f"{gl.called}: its vertices go through a vertex program")
    return make_mesh(mesh.primitive, columns, mesh.indices, mesh.counts)


_WRITTEN = {
    tokens.VERTEX_PROGRAM_TWO_SIDE_NV: "back colours are",
    tokens.VERTEX_PROGRAM_POINT_SIZE_NV: "point size is",
}


def _column(values):
    return None if values is None else values[:, None]


@lru_cache(maxsize=1024)
def programmed_state(state: PassState, keeps_position: bool) -> PassState:
    """The state that draws a program's vertices: without lighting, generated coordinates, matrices, and
    sizes of points that depend on their distance.

    ``keeps_position``: whether it has the position's matrices and clip planes.
    """
    gen = (TexGen(),) * 4
    plain = VertexState().modelview
    units = tuple([unit and replace(unit, gen=gen, matrix=plain) for unit in state.texture_units])
    fog = state.fog
    if fog is not None:
        fog = replace(fog, coordinate_source=FogCoordinateSource.FOG_COORDINATE, registers=None)
    vertex = VertexState(viewport=state.vertex.viewport)
    if keeps_position:
        own = state.vertex
        vertex = replace(
            vertex, modelview=own.modelview, projection=own.projection, clip_planes=own.clip_planes
        )
    # ARB_vertex_program: points have the state's size, as their distance is not computed.
    point = replace(state.point, parameters=None)
    return replace(state, vertex=vertex, texture_units=units, fog=fog, point=point)
