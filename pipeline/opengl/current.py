"""Current values, and vertices between Begin and End (OpenGL 1.2.1 sections 2.6, 2.7)."""

from typing import Any

import numpy as np

from fixedpipe.pipeline.commands import Mesh
from fixedpipe.pipeline.enums import FogCoordinateSource, PolygonMode, PrimitiveType
from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.entry_points import entry, register
from fixedpipe.pipeline.opengl.meshes import content_key, make_mesh
from fixedpipe.pipeline.opengl.outcomes import GLError, Refused
from fixedpipe.pipeline.state import PassState, needs_normals

# How many coordinate sets a context stores, for any machine.
COORDINATE_SETS = 8

PRIMITIVES = {
    tokens.POINTS: PrimitiveType.POINTS,
    tokens.LINES: PrimitiveType.LINES,
    tokens.LINE_LOOP: PrimitiveType.LINE_LOOP,
    tokens.LINE_STRIP: PrimitiveType.LINE_STRIP,
    tokens.TRIANGLES: PrimitiveType.TRIANGLES,
    tokens.TRIANGLE_STRIP: PrimitiveType.TRIANGLE_STRIP,
    tokens.TRIANGLE_FAN: PrimitiveType.TRIANGLE_FAN,
    tokens.QUADS: PrimitiveType.QUADS,
    tokens.QUAD_STRIP: PrimitiveType.QUAD_STRIP,
    tokens.POLYGON: PrimitiveType.POLYGON,
}
# By mode: the fewest vertices that draw something, and how many more each further primitive needs.
_LEAST = {0: 1, 1: 2, 2: 2, 3: 2, 4: 3, 5: 3, 6: 3, 7: 4, 8: 4, 9: 3}
_STEP = {1: 2, 4: 3, 7: 4, 8: 2}


class Current:
    """The current values (table 6.5). A vertex takes the values at the time when it is specified."""

    __slots__ = (
        "color",
        "edge_flag",
        "fog_coordinate",
        "normal",
        "secondary_color",
        "texture_coordinates",
        "weight",
    )

    def __init__(self):
        self.color = (1.0, 1.0, 1.0, 1.0)
        self.secondary_color = (0.0, 0.0, 0.0, 1.0)
        self.normal = (0.0, 0.0, 1.0)
        self.texture_coordinates = ((0.0, 0.0, 0.0, 1.0),) * COORDINATE_SETS
        self.fog_coordinate = 0.0
        self.edge_flag = True
        self.weight = 1.0

    def values(self) -> tuple[Any, ...]:
        """All current values, as PushAttrib saves them."""
        return tuple([getattr(self, name) for name in self.__slots__])

    def restore(self, values: tuple[Any, ...]) -> None:
        """Set the current values that ``values`` returned."""
        for name, value in zip(self.__slots__, values, strict=True):
            setattr(self, name, value)


# Functions that convert a component of a type to a fraction (table 2.6).
_FRACTIONS = {
    "b": lambda v: (2 * v + 1) / 255.0,
    "s": lambda v: (2 * v + 1) / 65535.0,
    "i": lambda v: (2 * v + 1) / 4294967295.0,
    "ub": lambda v: v / 255.0,
    "us": lambda v: v / 65535.0,
    "ui": lambda v: v / 4294967295.0,
    "f": float,
    "d": float,
}


def fractions(suffix, components):
    """Components of a color or normal of the type ``suffix`` ("ub", "f", ...) as floats."""
    return tuple(map(_FRACTIONS[suffix], components))


def filled(components, rest=(0.0, 0.0, 0.0, 1.0)):
    """Four components: the given ones, and for missing ones those of ``rest``."""
    given = tuple(map(float, components))
    return given + rest[len(given) :]


def _first(components, size):
    """The first components of a sequence. A trace may have a number in place of a vector of one component."""
    try:
        return components[:size]
    except TypeError:
        return (components,)


def _register_family(stem, sizes, suffixes, set_value, *, convert):
    """Register stem{sizes}{suffixes}{,v}; they call ``set_value(gl, convert(suffix, components))``."""
    for size in map(int, sizes):
        for suffix in suffixes:

            def scalars(gl, *components, suffix=suffix):
                set_value(gl, convert(suffix, components))

            def vector(gl, components, suffix=suffix, size=size):
                set_value(gl, convert(suffix, _first(components, size)))

            register(f"{stem}{size}{suffix}", scalars, inside=True)
            register(f"{stem}{size}{suffix}v", vector, inside=True)


def _as_they_are(suffix, components):
    return tuple(map(float, components))


def vertex(gl, position):
    """Add a vertex with the current values."""
    if gl.begun is None:
        return  # undefined outside Begin and End (section 2.6.3)
    now = gl.current
    gl.begun.append(
        (
            filled(position),
            now.color,
            now.normal,
            now.texture_coordinates,
            now.secondary_color,
            now.fog_coordinate,
            now.edge_flag,
            now.weight,
        )
    )


def _color(gl, color):
    gl.current.color = filled(color)


def _secondary_color(gl, color):
    gl.current.secondary_color = filled(color)


def _normal(gl, normal):
    gl.current.normal = normal


def _coordinates(gl, coordinates):
    gl.current.texture_coordinates = (filled(coordinates), *gl.current.texture_coordinates[1:])


_register_family("Vertex", "234", ("s", "i", "f", "d"), vertex, convert=_as_they_are)
_register_family("Color", "34", tuple(_FRACTIONS), _color, convert=fractions)
_register_family("SecondaryColor", "3", tuple(_FRACTIONS), _secondary_color, convert=fractions)
_register_family("Normal", "3", ("b", "s", "i", "f", "d"), _normal, convert=fractions)
_register_family("TexCoord", "1234", ("s", "i", "f", "d"), _coordinates, convert=_as_they_are)


def texture_unit_number(texture: int) -> int:
    """The number of a unit from TEXTUREi. Raises GLError."""
    number = texture - tokens.TEXTURE0
    if not 0 <= number < COORDINATE_SETS:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(texture)} names no texture unit")
    return number


def set_coordinates(gl, unit, coordinates):
    """Set the current texture coordinates of a set."""
    sets = gl.current.texture_coordinates
    gl.current.texture_coordinates = (*sets[:unit], filled(coordinates), *sets[unit + 1 :])


def _multi_coordinates(size, suffix):
    def scalars(gl, texture, *components):
        set_coordinates(gl, texture_unit_number(texture), components)

    def vector(gl, texture, components):
        set_coordinates(gl, texture_unit_number(texture), _first(components, size))

    register(f"MultiTexCoord{size}{suffix}", scalars, inside=True)
    register(f"MultiTexCoord{size}{suffix}v", vector, inside=True)


for _size in (1, 2, 3, 4):
    for _suffix in "sifd":
        _multi_coordinates(_size, _suffix)


def register_attributes(set_other) -> None:
    """Register VertexAttrib and VertexAttribs: attributes by number (NV_vertex_program, ARB_vertex_program).

    ``set_other(gl, number, components)`` sets attributes 6 and 7, which are not conventional ones.
    """

    def set_one(gl, number, components):
        setter = _ATTRIBUTES.get(number)
        if setter is not None:
            setter(gl, components)
        elif 8 <= number < 8 + COORDINATE_SETS:
            set_coordinates(gl, number - 8, components)
        elif number in (6, 7):
            set_other(gl, number, components)
        else:
            raise GLError(tokens.INVALID_VALUE, f"{number} is no vertex attribute")

    names = [(size, kind, kind, "") for size in (1, 2, 3, 4) for kind in "sfd"]
    names += [(4, kind, "as it is", "") for kind in ("b", "i", "ub", "us", "ui")]
    names += [(4, "N" + kind, kind, "") for kind in ("b", "s", "i", "ub", "us", "ui")]
    for size, kind, suffix, _ in names:
        convert = fractions if kind.startswith("N") else _as_they_are

        def scalars(gl, number, *components, suffix=suffix, convert=convert):
            set_one(gl, number, convert(suffix, components))

        def vector(gl, number, components, suffix=suffix, convert=convert, size=size):
            set_one(gl, number, convert(suffix, _first(components, size)))

        register(f"VertexAttrib{size}{kind}", scalars, inside=True)
        register(f"VertexAttrib{size}{kind}v", vector, inside=True)

    def bytes_nv(gl, number, *components):
        set_one(gl, number, fractions("ub", components))

    def byte_vector_nv(gl, number, components):
        set_one(gl, number, fractions("ub", _first(components, 4)))

    # Bytes are fractions in NVIDIA's calls. In ARB's calls without N they are not.
    register("VertexAttrib4ubNV", bytes_nv, inside=True)
    register("VertexAttrib4ubvNV", byte_vector_nv, inside=True)
    for size in (1, 2, 3, 4):
        for kind in ("s", "f", "d", "ub"):
            if kind == "ub" and size != 4:
                continue

            def several(gl, first, count, numbers, size=size, kind=kind):
                # In descending order, so that attribute 0 is set last and adds the vertex.
                for n in reversed(range(count)):
                    given = numbers[size * n : size * n + size]
                    set_one(
                        gl, first + n, fractions("ub", given) if kind == "ub" else _as_they_are("", given)
                    )

            register(f"VertexAttribs{size}{kind}v", several, inside=True)


def _only_x(number, given):
    """The first component of an attribute of which the others are not kept."""
    if filled(given)[1:] != (0.0, 0.0, 1.0):
        raise Refused(f"attribute {number} has components after x, which are not kept here")
    return float(given[0])


# The conventional attributes by number. Numbers from 8 on are texture coordinates.
_ATTRIBUTES = {
    0: vertex,
    1: lambda gl, given: setattr(gl.current, "weight", _only_x(1, given)),
    2: lambda gl, given: setattr(gl.current, "normal", filled(given)[:3]),
    3: _color,
    4: _secondary_color,
    5: lambda gl, given: setattr(gl.current, "fog_coordinate", _only_x(5, given)),
}


def _one(value):
    return _first(value, 1)[0]


@entry("FogCoordf", "FogCoordd", "FogCoordfv", "FogCoorddv", inside=True)
def fog_coordinate(gl, coordinate):
    """Set the current fog coordinate (EXT_fog_coord)."""
    gl.current.fog_coordinate = float(_one(coordinate))


@entry("EdgeFlag", "EdgeFlagv", inside=True)
def edge_flag(gl, flag):
    """Set the current edge flag (section 2.6.2)."""
    gl.current.edge_flag = bool(_one(flag))


@entry("VertexWeightf", "VertexWeightfv", inside=True)
def vertex_weight(gl, weight):
    """Set the current weight (EXT_vertex_weighting)."""
    gl.current.weight = float(_one(weight))


@entry("Begin", inside=True)
def begin(gl, mode):
    """Begin a primitive (section 2.6.1)."""
    if gl.begun is not None:
        raise GLError(tokens.INVALID_OPERATION, "glBegin is called between Begin and End")
    if mode not in PRIMITIVES:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(mode)} is no primitive")
    gl.begun, gl.begun_mode = [], mode


@entry("End", inside=True)
def end(gl):
    """End the primitive, and draw it."""
    if gl.begun is None:
        raise GLError(tokens.INVALID_OPERATION, "glEnd is called without Begin")
    vertices, gl.begun = gl.begun, None
    materials, gl.begun_materials = gl.begun_materials, None
    if materials is None:
        draw_vertices(gl, gl.begun_mode, vertices)
        return
    from fixedpipe.pipeline.opengl.material_changes import draw_with_changes

    draw_with_changes(gl, gl.begun_mode, vertices, materials)


def draw_vertices(gl, mode, vertices):
    """Draw vertices in the form in which ``Begin`` and ``End`` collect them."""
    if not vertices or gl.leaves_out_draws():
        return
    positions, colors, normals, sets, secondary, fog, edges, weights = zip(*vertices, strict=True)
    needs = columns_read(gl)
    columns = {"positions": positions, "colors": colors}
    if "normals" in needs:
        columns["normals"] = normals
    columns["texture_coordinates"] = tuple(
        [[s[i] for s in sets] for i in range(needs["texture_coordinates"])]
    )
    if "secondary_colors" in needs:
        columns["secondary_colors"] = secondary
    if "fog_coordinates" in needs:
        columns["fog_coordinates"] = fog
    if "weights" in needs:
        columns["weights"] = weights
    if "edge_flags" in needs and not all(edges):
        columns["edge_flags"] = edges
    gl.draw(mode, columns)


def needed_columns(state: PassState) -> dict[str, int]:
    """The columns of a mesh that the state may read, by name. For texture coordinates: how many sets."""
    sets = [unit.coordinates + 1 for unit in state.texture_units if unit is not None]
    needs = {"texture_coordinates": max(sets, default=0)}
    if needs_normals(state):
        needs["normals"] = 1
    if state.color_sum or state.register_combiners is not None:
        needs["secondary_colors"] = 1
    if state.fog is not None and state.fog.coordinate_source is FogCoordinateSource.FOG_COORDINATE:
        needs["fog_coordinates"] = 1
    if state.vertex.modelview1 is not None:
        needs["weights"] = 1
    if (state.polygon.front_mode, state.polygon.back_mode) != (PolygonMode.FILL, PolygonMode.FILL):
        needs["edge_flags"] = 1
    return needs


_PROGRAMMED = ("enabled", tokens.VERTEX_PROGRAM_NV)
# By the identity of a state: the state, and the columns that it needs.
_needs: dict[int, tuple[PassState, dict[str, int]]] = {}
_MOST_NEEDS = 4096


def columns_read(gl) -> dict[str, int]:
    """``needed_columns`` of the present state, and in feedback the columns that it returns."""
    if gl.values[_PROGRAMMED]:
        from fixedpipe.pipeline.opengl.vertex_program_draws import COLUMNS

        return COLUMNS
    state = gl.state()
    found = _needs.get(id(state))
    if found is None:
        if len(_needs) >= _MOST_NEEDS:
            _needs.clear()
        found = _needs[id(state)] = state, needed_columns(state)
    if gl.values["render_mode"] == tokens.FEEDBACK:
        return {**found[1], "texture_coordinates": max(found[1]["texture_coordinates"], 1), "normals": 1}
    return found[1]


def primitive_of(mode: int) -> PrimitiveType:
    """The primitive of a token. Raises GLError."""
    primitive = PRIMITIVES.get(mode)
    if primitive is None:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(mode)} is no primitive")
    return primitive


def drawn_count(mode: int, count: int) -> int:
    """How many of ``count`` vertices make whole primitives (section 2.6.1)."""
    return 0 if count < _LEAST[mode] else count - count % _STEP.get(mode, 1)


def finish_primitive(gl, mode, columns, indices=None, counts=None):
    """Draw the columns as primitives of ``mode``. ``Context.draw`` calls this.

    ``counts``: the number of vertices of each strip or fan, which are all complete; None: there is one.
    """
    primitive = primitive_of(mode)
    count = len(columns["positions"] if indices is None else indices)
    whole = drawn_count(mode, count)
    if not whole or gl.leaves_out_draws():
        return
    arrays = {}
    for name, column in columns.items():
        several = [np.asarray(c) for c in (column if name == "texture_coordinates" else (column,))]
        if whole != count and indices is None:
            several = [array[:whole] for array in several]
        arrays[name] = tuple(several) if name == "texture_coordinates" else several[0]
    if indices is not None:
        indices = np.asarray(indices, np.int64)[:whole]
    key, size = content_key(primitive, arrays, indices, counts)
    draw_mesh(gl, gl.meshes.find(key, lambda: make_mesh(primitive, arrays, indices, counts), size))


def draw_mesh(gl, mesh: Mesh) -> None:
    """Draw a Mesh, or use it for selection or feedback, as RenderMode says."""
    if gl.values[_PROGRAMMED]:
        from fixedpipe.pipeline.opengl.vertex_program_draws import programmed_mesh

        mesh = programmed_mesh(gl, mesh)
    if gl.values["render_mode"] != tokens.RENDER:
        gl.select(mesh)
    else:
        gl.emit_draw(mesh, gl.state())
