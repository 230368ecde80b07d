"""Plans: the arguments by which ``fixedpipe.raster.primitives.vertices`` transforms a mesh's vertices.

A Mesh cannot change. Data that follow from the mesh alone are computed once and kept as long as the mesh
lives. Transformed vertices are never kept.
"""

import weakref
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import chain
from typing import NamedTuple

import numpy as np

from fixedpipe.pipeline.enums import PolygonMode, TexGenMode, VertexStage, WindowOrigin
from fixedpipe.pipeline.state import IDENTITY, Viewport
from fixedpipe.pipeline.vertices.assembly import assemble, triangles_in
from fixedpipe.pipeline.vertices.projection import viewport_transform
from fixedpipe.raster.primitives import vertices as V
from fixedpipe.raster.primitives.meshes import unit_coordinates

_LINEAR_MODES = frozenset({TexGenMode.NONE, TexGenMode.OBJECT_LINEAR, TexGenMode.EYE_LINEAR})
_NONE = np.zeros((0, 0))  # stands for the coordinate set of a disabled unit
_PLANS_KEPT = 32  # for one mesh; a program that makes a new state for every frame never finds an old plan


@dataclass(eq=False, slots=True)
class MeshColumns:
    """Data that follow from a Mesh alone, computed at first use. The arrays are shared: never write to them.

    - ``widths``: the number of components of positions and of each texture coordinate set.
    - ``triangles``: {provoking vertex: rows of ``fixedpipe.pipeline.vertices.assembly.assemble``}.
    - ``coordinates``: {each unit's texture coordinate set, None where the unit is disabled: (float64 [n,
      units, 4], for each unit whether some q is not 1)}.
    - ``facts``: {the same: ``fixedpipe.raster.vector.unit.coordinate_facts`` of these coordinates}.
    - ``given``: {texture coordinate sets: float64 [c, n]}, the components of the positions, then of the sets.
    - ``colors``: colours of vertices without lighting, by the way they become bytes
      (``colors.stacked_colors``).
    - ``unrounded``: the same colours before they become bytes: float64 [n, 8] or [n, 16]; [1, ...] where all
      vertices have the same.
    - ``plans``: Plans by the parts of the state that they follow from, the profile and the framebuffer's
      size.
    - ``no_fog``: float64 [n], zeros.
    - ``runs``: {provoking vertex: the mesh's Runs}.
    """

    no_fog: np.ndarray
    widths: tuple
    facts: dict = field(default_factory=dict)
    triangles: dict = field(default_factory=dict)
    coordinates: dict = field(default_factory=dict)
    given: dict = field(default_factory=dict)
    colors: dict = field(default_factory=dict)
    unrounded: dict = field(default_factory=dict)
    plans: dict = field(default_factory=dict)
    runs: dict = field(default_factory=dict)


_of_mesh = weakref.WeakKeyDictionary()


def mesh_columns(mesh):
    """The MeshColumns of a Mesh."""
    found = _of_mesh.get(mesh)
    if found is None:
        widths = mesh.positions.shape[1], *[array.shape[1] for array in mesh.texture_coordinates]
        found = _of_mesh.setdefault(mesh, MeshColumns(np.zeros(len(mesh.positions)), widths))
    return found


def triangles_of(mesh, columns, provoking):
    """The rows of ``assemble`` for a mesh, kept in its MeshColumns."""
    found = columns.triangles.get(provoking)
    if found is None:
        found = columns.triangles[provoking] = assemble(mesh, provoking)
    return found


class Runs(NamedTuple):
    """The triangles of a mesh's runs (``Mesh.counts``).

    - ``triangles``: int32 [k, 4], rows of ``assemble``, counted from the first vertex of their run.
    - ``ranges``: int64 [runs, 4]: the first vertex, the number of vertices, the first triangle, the number of
      triangles of each run.
    """

    triangles: np.ndarray
    ranges: np.ndarray


def runs_of(mesh, columns, provoking):
    """The Runs of a mesh of polygons, kept in its MeshColumns."""
    found = columns.runs.get(provoking)
    if found is None:
        stream = len(mesh.positions) if mesh.indices is None else len(mesh.indices)
        counts = np.array([stream] if mesh.counts is None else mesh.counts, np.int64)
        triangles, in_run = assemble(mesh, provoking), triangles_in(mesh.primitive, counts)
        ranges = np.zeros((len(counts), 4), np.int64)
        ranges[:, 3] = in_run
        ranges[:, 2] = np.cumsum(in_run) - in_run
        if len(triangles):
            drawn = in_run > 0
            begins, flat = 4 * ranges[drawn, 2], triangles.reshape(-1)
            first = np.minimum.reduceat(flat, begins)
            ranges[drawn, 0] = first
            ranges[drawn, 1] = np.maximum.reduceat(flat, begins) + 1 - first
            flat -= np.repeat(first, 4 * in_run[drawn])
        found = columns.runs[provoking] = Runs(triangles, ranges)
    return found


def _set(mesh, number):
    return mesh.texture_coordinates[number] if number < len(mesh.texture_coordinates) else _NONE


def coordinates_of(mesh, columns, sets):
    """MeshColumns' ``coordinates`` of these texture coordinate sets."""
    found = columns.coordinates.get(sets)
    if found is None:
        stacked = np.empty((len(mesh.positions), len(sets), 4))
        arrays = [_NONE if number is None else _set(mesh, number) for number in sets]
        varies = unit_coordinates((*arrays, *[_NONE] * (4 - len(sets))), stacked)
        found = stacked, tuple([bool(varies >> unit & 1) for unit in range(len(sets))])
        columns.coordinates[sets] = found
    return found


def given_of(mesh, columns, sets):
    """MeshColumns' ``given`` of these texture coordinate sets."""
    found = columns.given.get(sets)
    if found is None:
        given = mesh.positions.T
        if sets:
            given = np.concatenate([given, *(_set(mesh, number).T for number in sets)])
        found = columns.given[sets] = np.ascontiguousarray(given)
    return found


@dataclass(frozen=True, eq=False, slots=True)
class Plan:
    """The arguments of ``transform_vertices`` that follow from a mesh and a state.

    - ``triangles``: int32 [k, 4], the mesh's.
    - ``rows``: the number of columns that a chunk needs.
    - ``units``: the number of units whose coordinates the kernel writes: all, or 0.
    - ``coordinates``: the mesh's own (MeshColumns) where no unit changes them; else None.
    - ``keeps_eye``: whether eye coordinates are the kernel's last four results.
    - ``clip``: ``results`` for a kernel run that keeps only clip coordinates.
    """

    triangles: np.ndarray
    given: np.ndarray
    sums: np.ndarray
    coefficients: np.ndarray
    results: np.ndarray
    parameters: np.ndarray
    rows: int
    units: int
    coordinates: tuple | None
    keeps_eye: bool
    clip: np.ndarray


class _Sums:
    """Weighted sums; each has its own row after the given rows."""

    def __init__(self, given):
        self.rows, self.sums, self.coefficients = V.FIRST_GIVEN + given, [], []

    def add(self, coefficients, rows):
        """The row of the weighted sum of the columns in ``rows`` (``arithmetic.weighted_sum``)."""
        terms = [(c, row) for c, row in zip(coefficients, rows, strict=True) if c != 0]
        if not terms:
            return V.ZEROS
        if len(terms) == 1 and terms[0][0] == 1:
            return terms[0][1]
        padding = [0] * (4 - len(terms))
        self.sums.append([self.rows, len(terms), *(row for _, row in terms), *padding])
        self.coefficients.append([*(c for c, _ in terms), *padding])
        self.rows += 1
        return self.rows - 1

    def transform(self, matrix, rows):
        """The rows of the transformed vector (``arithmetic.transform``)."""
        return [self.add(row, rows) for row in matrix]


def _vector(first, components):
    """Rows of a vector whose first component is in row ``first``; missing components are 0, 0 and 1."""
    return [first + k if k < components else (V.ONES if k == 3 else V.ZEROS) for k in range(4)]


def _parameters(state, profile, width, height):
    v, arithmetic = state.vertex.viewport, profile.arithmetic
    upper_left = arithmetic.device_origin == WindowOrigin.UPPER_LEFT
    machine = arithmetic.guard_band, arithmetic.subpixel_bits, upper_left
    viewport = v.x, v.y, v.width, v.height, v.near, v.far
    return _of_window(viewport, width, height, *machine, state.perspective_correction)


@lru_cache(256)
def _of_window(viewport, width, height, band, subpixel_bits, upper_left, perspective):
    """The parameters for a viewport: its x, y, width, height, near and far."""
    half_size, center = viewport_transform(Viewport(*viewport), width, height)
    row = np.zeros(V.PARAMETERS)
    row[[V.HALF_X, V.HALF_Y]] = half_size
    row[[V.CENTER_X, V.CENTER_Y]] = center
    row[[V.LOW_X, V.LOW_Y]] = center[0] + band, center[1] + band
    row[[V.HIGH_X, V.HIGH_Y]] = (width + band) - center[0], (height + band) - center[1]
    near, far = np.float64(viewport[4]), np.float64(viewport[5])
    row[V.DEPTH_SCALE], row[V.DEPTH_OFFSET] = (far - near) * np.float64(0.5), (far + near) * np.float64(0.5)
    row[V.SNAP_LOW], row[V.SNAP_HIGH_X], row[V.SNAP_HIGH_Y] = -band, width + band, height + band
    row[V.STEPS], row[V.HEIGHT], row[V.UPPER_LEFT] = 1 << subpixel_bits, height, upper_left
    row[V.PERSPECTIVE] = perspective
    return row


def is_covered(mesh, state):
    """Whether ``raster.primitives.vertices`` transforms a mesh's vertices in a state."""
    vertex, polygon = state.vertex, state.polygon
    return (
        vertex.stage == VertexStage.FIXED_FUNCTION
        and vertex.composite is None
        and vertex.modelview1 is None
        and not vertex.clip_planes
        and state.depth_clamp is None
        and mesh.primitive.is_polygons
        and (polygon.front_mode, polygon.back_mode) == (PolygonMode.FILL, PolygonMode.FILL)
        and not any(unit is not None and any(unit.cylinder_wrap) for unit in state.texture_units)
    )


def _linear_coordinates(widths, units, sets, first, sums, position, eye):
    """Rows of s, t, r, q of every unit.

    - ``widths``: the number of components of each texture coordinate set.
    - ``first``: the row of the first component of ``sets``.
    """
    at = {}
    for number in sets:
        at[number] = first
        first += widths[number]
    results = []
    for unit in units:
        if unit is None:
            results += _vector(0, 0)
            continue
        known = unit.coordinates < len(widths)
        rows = _vector(at.get(unit.coordinates, 0), widths[unit.coordinates] if known else 0)
        for axis, gen in enumerate(unit.gen):
            if gen.mode != TexGenMode.NONE:
                rows[axis] = sums.add(gen.plane, position if gen.mode == TexGenMode.OBJECT_LINEAR else eye)
        results += sums.transform(unit.matrix, rows)
    return results


class Formula(NamedTuple):
    """The part of a Plan that follows from a state and the widths of a mesh's arrays; members as in Plan.

    - ``sets``: the texture coordinate sets that the kernel reads.
    - ``own``: each unit's texture coordinate set where no unit changes coordinates; else None.
    """

    sums: np.ndarray
    coefficients: np.ndarray
    results: np.ndarray
    parameters: np.ndarray
    rows: int
    units: int
    sets: tuple
    own: tuple | None
    keeps_eye: bool
    clip: np.ndarray


_ways = {}  # by the identity of a state's units: what _way_of finds, and the units
_WAYS_KEPT = 1024


def _way_of(units):
    """How the coordinates of a state's units follow from a mesh's.

    Returns each unit's texture coordinate set where no unit changes coordinates, else None; whether they are
    weighted sums, which differ from the mesh's; and the sets in these sums.
    """
    found = _ways.get(id(units))
    if found is None:
        modes = {gen.mode for unit in units if unit is not None for gen in unit.gen}
        as_given = modes <= {TexGenMode.NONE} and all(u is None or u.matrix == IDENTITY for u in units)
        linear = not as_given and modes <= _LINEAR_MODES
        own = tuple(None if u is None else u.coordinates for u in units) if as_given else None
        used = {unit.coordinates for unit in units if unit is not None} if linear else ()
        if len(_ways) >= _WAYS_KEPT:
            _ways.clear()
        found = _ways[id(units)] = (own, linear, used), units
    return found[0]


def _formula(widths, state, units, profile, width, height):
    """The Formula for ``widths``: the components of positions and of each texture coordinate set."""
    components, *of_sets = widths
    vertex = state.vertex
    own, linear, used = _way_of(units)
    sets = tuple(sorted(number for number in used if number < len(of_sets)))
    given = components + sum(of_sets[number] for number in sets)
    position = _vector(V.FIRST_GIVEN, components)
    keeps_eye = vertex.lighting is not None or state.fog is not None or (own is None and not linear)
    if linear:
        sums = _Sums(given)
        eye = sums.transform(vertex.modelview, position)
        results = sums.transform(vertex.projection, eye)
        first = V.FIRST_GIVEN + components
        results += _linear_coordinates(of_sets, units, sets, first, sums, position, eye)
        found = _laid_out(sums, results, eye if keeps_eye else ())
    else:
        found = _transforms(vertex.modelview, vertex.projection, components, keeps_eye)
    sums, coefficients, results, rows, clip = found
    return Formula(
        sums=sums,
        coefficients=coefficients,
        results=results,
        parameters=_parameters(state, profile, width, height),
        rows=rows,
        units=len(units) if linear else 0,
        sets=sets,
        own=own,
        keeps_eye=keeps_eye,
        clip=clip,
    )


def _laid_out(sums, results, eye):
    """The arrays that the kernel takes: sums, coefficients, results, number of rows, and ``clip``."""
    return (
        np.array(sums.sums, np.int32).reshape(-1, 6),
        np.array(sums.coefficients, np.float64).reshape(-1, 4),
        np.array([*results, *eye], np.int32),
        sums.rows,
        np.array(results[:4] * 2, np.int32),
    )


def _transforms(modelview, projection, components, keeps_eye):
    """``_laid_out`` for a vertex transformed by two matrices.

    Matrices with zeros and ones at the same places share everything except the coefficients. A program that
    moves things in every frame therefore reuses the arrays.
    """
    entries = [*chain.from_iterable(modelview), *chain.from_iterable(projection)]
    pattern = tuple([c if c in (0, 1) else None for c in entries])
    sums, where, *others = _pattern(pattern, components, keeps_eye)
    return sums, np.array([0.0, 1.0, *entries], np.float64)[where], *others


@lru_cache(256)
def _pattern(pattern, components, keeps_eye):
    """``_laid_out`` for matrices whose entries are 0, 1 or anything (None), as ``pattern`` says.

    In place of the coefficients it has their places in (0, 1, the matrices' entries).
    """
    places = [place if entry is None else int(entry) for place, entry in enumerate(pattern, 2)]
    rows = [places[at : at + 4] for at in range(0, 32, 4)]
    sums = _Sums(components)
    eye = sums.transform(rows[:4], _vector(V.FIRST_GIVEN, components))
    results = sums.transform(rows[4:], eye)
    sums, where, *others = _laid_out(sums, results, eye if keeps_eye else ())
    return sums, where.astype(np.int64), *others


def transforms_of(modelviews, projection, components):
    """``_transforms`` for several modelview matrices, float64 [n, 4, 4].

    Returns (sums, coefficients [k, m, 4], results, rows) for the first k of them: those with zeros and ones
    at the places of the first.
    """
    entries = np.empty((len(modelviews), 34))
    entries[:, 0], entries[:, 1] = 0.0, 1.0
    entries[:, 2:18], entries[:, 18:] = modelviews.reshape(-1, 16), np.reshape(projection, 16)
    zeros, ones = entries == 0.0, entries == 1.0
    others = ((zeros != zeros[0]) | (ones != ones[0])).any(axis=1)
    alike = int(others.argmax()) if others.any() else len(others)
    pattern = tuple([c if c in (0.0, 1.0) else None for c in entries[0, 2:].tolist()])
    sums, where, results, rows, _ = _pattern(pattern, components, False)
    return sums, np.ascontiguousarray(entries[:alike][:, where]), results, rows


def depends_on_places_alone(mesh, state):
    """Whether machines that agree on the places of vertices differ in no column but colours.

    Clipped triangles differ in none either; fog coordinates, and coordinates from normals, may.
    """
    own, linear, _ = _way_of(state.texture_units)
    return state.fog is None and (own is not None or linear) and is_covered(mesh, state)


# Keyed by the widths of a mesh's arrays and the parts of the state, for any mesh: the Formula, and the
# objects whose ids are in the key.
_formulas = {}
_FORMULAS_KEPT = 1024


def formula_of(widths, state, units, profile, size):
    """The Formula for meshes of these ``widths`` (MeshColumns), from a cache.

    ``units`` are the state's texture units, or equal ones that more states have in common.
    """
    vertex, fogged, perspective = state.vertex, state.fog is not None, state.perspective_correction
    key = widths, id(vertex), id(units), id(profile), size, fogged, perspective
    found = _formulas.get(key)
    if found is None:
        if len(_formulas) >= _FORMULAS_KEPT:
            _formulas.clear()
        found = _formulas[key] = _formula(widths, state, units, profile, *size), vertex, units, profile
    return found[0]


def _plan(mesh, columns, state, profile, size):
    if not is_covered(mesh, state):
        return None
    formula = formula_of(columns.widths, state, state.texture_units, profile, size)
    return Plan(
        triangles=triangles_of(mesh, columns, state.polygon.provoking_vertex),
        given=given_of(mesh, columns, formula.sets),
        sums=formula.sums,
        coefficients=formula.coefficients,
        results=formula.results,
        parameters=formula.parameters,
        rows=formula.rows,
        units=formula.units,
        coordinates=None if formula.own is None else coordinates_of(mesh, columns, formula.own),
        keeps_eye=formula.keeps_eye,
        clip=formula.clip,
    )


def plan_of(mesh, columns, state, profile, width, height):
    """The Plan for drawing a mesh in a state, or None if ``raster.primitives.vertices`` cannot do it.

    ``columns`` are the mesh's MeshColumns.
    """
    vertex, units, polygon = state.vertex, state.texture_units, state.polygon
    # The key has everything that a plan follows from, so states that differ in other parts share the plan.
    key = (
        id(vertex), id(units), id(polygon), id(profile), width, height, state.fog is None,
        state.depth_clamp is None, state.perspective_correction,
    )  # fmt: skip
    found = columns.plans.get(key)
    # The entry holds the objects whose ids are in the key, so that no other object gets these ids meanwhile.
    if found is None:
        plan = _plan(mesh, columns, state, profile, (width, height))
        if len(columns.plans) >= _PLANS_KEPT:
            columns.plans.clear()
        found = columns.plans[key] = plan, vertex, units, polygon, profile
    return found[0]
