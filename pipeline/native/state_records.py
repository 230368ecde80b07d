"""What Draws in a state need whatever their meshes are: found once for a state, a target and its textures.

A Draw of triangles in a known state is then one kernel call (``fixedpipe.raster.vector.submit``).
"""

from operator import attrgetter

import numpy as np

from fixedpipe.pipeline.columns.engine import needs_columns
from fixedpipe.pipeline.enums import Clamp, SecondaryColor
from fixedpipe.pipeline.framebuffers.widths import are_native, fragment_bits, widths_of
from fixedpipe.pipeline.native.pack_combiners import pack_constants
from fixedpipe.pipeline.native.prepared_draw import Prepared, make_job, texels_and_levels
from fixedpipe.pipeline.native.state_rows import rows_of
from fixedpipe.pipeline.profiles.profile import NATIVE_BITS
from fixedpipe.pipeline.state_kinds import kind_of
from fixedpipe.pipeline.textures.depth_words import DEPTH_WORDS
from fixedpipe.pipeline.textures.depths_as_colors import depths_as_colors
from fixedpipe.pipeline.vertices.colors import given_colors, kept_color_bits
from fixedpipe.pipeline.vertices.plan import (
    coordinates_of,
    formula_of,
    given_of,
    is_covered,
    mesh_columns,
    triangles_of,
)
from fixedpipe.pipeline.vertices.view_volume import within_viewport
from fixedpipe.raster import rows as R
from fixedpipe.raster.primitives import bins, vertices
from fixedpipe.raster.primitives.bins import BAND_HEIGHT
from fixedpipe.raster.vector.arrays import JOB_SIZE
from fixedpipe.raster.vector.submit import CLIPS, OTHER_PROJECTIVE, PORTABLE, submit
from fixedpipe.raster.vector.unit import coordinate_facts

_MOST = 4096  # records of a machine; then all are forgotten
_MOST_KEPT = 1 << 16  # vertices, or triangles, of the scratch that stays
# What a record depends on of a state's vertices' part.
_OF_VERTEX = attrgetter(
    "viewport", "lighting", "clip_planes", "two_side", "secondary_color", "composite", "modelview1"
)


class StateRecords:
    """A machine's StateRecords, by state, kind of primitive and target.

    States of one kind (``fixedpipe.pipeline.state_kinds``) share all but what their matrices and constant
    colours decide.
    """

    def __init__(self, profile):
        self._profile, self._scratch = profile, _Scratch()
        self._of_state, self._of_kind = {}, {}

    def of(self, mesh, state, framebuffer, textures):
        """The StateRecord for drawing a mesh; ``textures`` are the machine's, by name."""
        beside = mesh.primitive.is_polygons, framebuffer.kind
        found = self._of_state.get((id(state), beside))
        if found is not None and found.reads(textures):
            return found
        if len(self._of_state) >= _MOST:
            self._of_state.clear()
            self._of_kind.clear()
        kind = kind_of(state)
        first = self._of_kind.get((kind, beside))
        if first is None or not (first.reads(textures) and first.is_like(state)):
            first = StateRecord(mesh, state, self._profile, framebuffer, textures, self._scratch)
            self._of_kind[kind, beside] = first
        self._of_state[id(state), beside] = made = first.for_state(state)
        return made


class StateRecord:
    """What drawing in a state needs.

    - ``state``, ``textures``: what engines draw with (``within_viewport``, ``depths_as_colors``).
    - ``by_columns``: whether only the column engine draws it.
    - ``native``: whether all components are bytes.
    """

    def __init__(self, mesh, state, profile, framebuffer, textures, scratch):
        self._given, self._names, vertex = state, _names(state), state.vertex
        self._read = [textures.get(name) for name in self._names]
        state = within_viewport(mesh, state, framebuffer.width, framebuffer.height)
        self.state, held = depths_as_colors(state, textures, profile)
        self._replaced = self.state is not self._given
        self.textures = {name: held[name] for name in _names(self.state)}
        self.by_columns = needs_columns(self.state, profile, framebuffer, self.textures)
        self.native = are_native(widths_of(self.state, profile, framebuffer, self.textures))
        self._profile, self._scratch = profile, scratch
        self._size, self._units = (framebuffer.width, framebuffer.height), self.state.texture_units
        self._bits = kept_color_bits(vertex, profile)
        self._submits = (
            not self.by_columns
            and fragment_bits(profile, framebuffer) == NATIVE_BITS
            and is_covered(mesh, self.state)
            and self._bits is not None
            and vertex.lighting is None
            and not vertex.two_side
            and vertex.secondary_color is SecondaryColor.FROM_VERTEX
            and Clamp.VERTEX_COLOR in profile.arithmetic.clamps
        )
        if self._submits:
            self._rows = rows = rows_of(self.state, profile, framebuffer, self.textures)
            self._submits = bool(rows.area) and not (rows.wide or rows.draw[R.COVER_SAMPLES])
            depth = framebuffer.depth_format
            farthest = 1.0 if depth.is_float else DEPTH_WORDS[depth].farthest
            self._scale = int(np.float64(farthest).view(np.int64)) if rows.needs_depth else 0
            self._bands = -(-framebuffer.height // BAND_HEIGHT)
            self._bound = tuple([(name, self.textures[name]) for _, name, _ in rows.reads])
        self._templates, self._plans, self._projective = {}, {}, 0

    def reads(self, textures):
        """Whether these are the textures that the record was made with."""
        return self._read == [textures.get(name) for name in self._names]

    def is_like(self, state):
        """Whether a state of the same kind differs only in what ``for_state`` looks at."""
        vertex = state.vertex
        if self._replaced:
            return False
        return _OF_VERTEX(vertex) == _OF_VERTEX(self._given.vertex)

    def for_state(self, state):
        """The record of a state that this one is like."""
        if state is self._given:
            return self
        made = object.__new__(StateRecord)  # as ``copy.copy``, in a fifth of its time
        made.__dict__.update(self.__dict__, _given=state, state=state)
        if self._submits and not self._rows.has_constants_of(state.register_combiners):
            made._plans = {}
        return made

    def submitted(self, mesh):
        """A Prepared draw of a mesh by one kernel call, or None: the vertex stage has more to do."""
        if not self._submits:
            return None
        columns = mesh_columns(mesh)
        formula = formula_of(columns.widths, self.state, self._units, self._profile, self._size)
        if formula.keeps_eye:
            self._submits = False
            return None
        triangles = triangles_of(mesh, columns, self.state.polygon.provoking_vertex)
        colors, one_color = given_colors(mesh, columns, self.state.vertex, self._profile, self._bits)
        given = given_of(mesh, columns, formula.sets)
        if formula.own is None:
            coordinates, facts, projective = _NO_COORDINATES, 0, self._projective
        else:
            coordinates, varying = coordinates_of(mesh, columns, formula.own)
            projective = sum([1 << unit for unit, varies in enumerate(varying) if varies])
            if (facts := columns.facts.get(formula.own)) is None:
                facts = columns.facts[formula.own] = coordinate_facts(coordinates)
        n, count, bands, units = len(mesh.positions), len(triangles), self._bands, formula.units
        arrays = given, triangles, colors, coordinates
        formulas = formula.sums, formula.coefficients, formula.results, formula.parameters
        scratch = self._scratch.of(n, count, formula.rows)
        job, floats = np.empty(JOB_SIZE, np.int64), np.empty(2 * n + 4 * n * units)
        room = 2 * count + 4 * bands
        while True:
            template = self._template(one_color, projective)
            if template is None:
                return None
            plan = self._plan(one_color, projective)
            ints = np.empty(2 * n + bands + room, np.int32)
            numbers = bands, units, projective, facts, self._scale
            needed = submit(job, template[0], plan, arrays, formulas, (ints, floats), numbers, scratch)
            if needed in (CLIPS, PORTABLE):
                return None
            if needed <= OTHER_PROJECTIVE:
                projective = self._projective = OTHER_PROJECTIVE - needed
            elif needed <= room:
                break
            else:
                room = needed
        if needed == 0:
            return Prepared(0, self._bound)
        size = colors.nbytes + floats.nbytes + 4 * len(ints) + 16 * count
        beside = template, plan, ints, floats, triangles, colors, coordinates
        return Prepared(0, self._bound, self._rows.area, size, job=job, beside=beside)

    def _template(self, one_color, projective):
        """(a job without vertices, the variant of the rows, arrays that the job names) for primitives of one
        colour or several, and for units whose q varies as these bits say.

        None: the vector engine does not cover it. States of a kind share it.
        """
        key = one_color, projective
        if key not in self._templates:
            rows, units = self._rows, len(self.state.texture_units)
            varying = [bool(projective >> unit & 1) for unit in range(units)]
            variant = draw, unit_rows, _ = rows.variant(False, False, one_color, varying)
            vertex = *_ONE_VERTEX, np.ones((1, max(units, 1), 4))
            state = draw, rows.draw_float, rows.shared[-1]
            given = state, rows.filled_plan(*variant), np.zeros((1, 4), np.int32), vertex, unit_rows
            bands = np.empty(0, np.int32), np.empty(0, np.int32)
            texels = texels_and_levels(rows.reads, self.state, self.textures, len(unit_rows))
            made = make_job(given, bands, *texels)
            self._templates[key] = made and (made[0], variant, made[1], given)
        return self._templates[key]

    def _plan(self, one_color, projective):
        """The rows of the combiners' plan, with this state's constant colours."""
        key = one_color, projective
        if (found := self._plans.get(key)) is None:
            variant = self._templates[key][1]
            plan, program = self._rows.plan(*variant), self.state.register_combiners
            if not len(plan.constants) or self._rows.has_constants_of(program):
                found = self._rows.filled_plan(*variant)
            else:
                constants = np.array(pack_constants(program, self._rows.bits), np.int16)
                found = plan.filled(constants, variant[0])
            self._plans[key] = found
        return found


_NO_COORDINATES = np.zeros((0, 0, 4))
# x, y, z, 1/w and colours of a vertex that a template has in place of a mesh's.
_ONE_VERTEX = (
    np.zeros(1, np.int32),
    np.zeros(1, np.int32),
    np.zeros(1),
    np.ones(1),
    np.zeros((1, 2, 8), np.uint8),
)


def _names(state):
    return [unit.texture for unit in state.texture_units if unit is not None and unit.texture is not None]


class _Scratch:
    """Arrays that ``submit`` works in, grown to the largest mesh so far that is no exception."""

    def __init__(self):
        self._room, self._arrays = (0, 0, 0), ()

    def of(self, vertex_count, triangle_count, rows):
        needed = vertex_count, triangle_count, rows
        if not all([have >= need for have, need in zip(self._room, needed, strict=True)]):
            room = tuple(map(max, self._room, needed))
            made = _scratch(*room)
            if max(vertex_count, triangle_count) > _MOST_KEPT:
                return made
            self._room, self._arrays = room, made
        return self._arrays


def _scratch(vertex_count, triangle_count, rows):
    return (
        np.empty((rows, vertices.CHUNK)),
        np.empty(vertex_count),
        np.empty(vertex_count, np.int64),
        np.empty((4, bins.CHUNK), np.int64),
        np.empty(triangle_count, np.int64),
    )
