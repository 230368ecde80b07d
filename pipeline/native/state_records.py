"""What Draws in a state need whatever their meshes are: found once for a state, a target and its textures.

A Draw of triangles in a known state is then one kernel call (``fixedpipe.raster.vector.submit``).
"""

from operator import attrgetter

import numpy as np

from fixedpipe.pipeline.enums import Clamp, SecondaryColor
from fixedpipe.pipeline.framebuffers.widths import are_native, fragment_bits, widths_of
from fixedpipe.pipeline.native.pack_combiners import pack_constants, pack_constants_of
from fixedpipe.pipeline.native.prepared_draw import Prepared, make_job, texels_and_levels
from fixedpipe.pipeline.native.state_rows import have_same_constants, rows_of, texture_kind
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
    runs_of,
    transforms_of,
    triangles_of,
)
from fixedpipe.pipeline.vertices.view_volume import within_viewport
from fixedpipe.raster import rows as R
from fixedpipe.raster.floats import kept
from fixedpipe.raster.primitives.bins import BAND_HEIGHT
from fixedpipe.raster.primitives.bins import CHUNK as TRIANGLES_AT_A_TIME
from fixedpipe.raster.primitives.clip import MOST_VERTICES
from fixedpipe.raster.primitives.vertices import CHUNK as VERTICES_AT_A_TIME
from fixedpipe.raster.vector.arrays import JOB_SIZE
from fixedpipe.raster.vector.submit import (
    CLIPS,
    INTERPOLATED,
    ONE_COLOR,
    OTHER_VARIANT,
    PORTABLE,
    submit,
    submit_clipped,
)
from fixedpipe.raster.vector.submit_runs import submit_runs
from fixedpipe.raster.vector.unit import coordinate_facts

_MOST = 4096  # records that a machine makes; then all are forgotten
_MOST_KEPT = 1 << 16  # vertices, or triangles, of the scratch that stays
_MOST_TOGETHER = 1 << 18  # vertices and triangles of the rows of a MultiDraw that one call takes: some 6 MB
# What a record depends on of a state's vertices' part.
_OF_VERTEX = attrgetter(
    "viewport", "lighting", "clip_planes", "two_side", "secondary_color", "composite", "modelview1"
)


class StateRecords:
    """A machine's StateRecords, by state, kind of primitive and target.

    States of one kind (``fixedpipe.pipeline.state_kinds``) share all but what their matrices and constant
    colours decide. Records of a texture that was replaced are forgotten, so that none keeps it in memory.
    """

    def __init__(self, profile, needs_columns):
        """``needs_columns`` tells whether only the column engine draws a pass."""
        self._machine = profile, needs_columns, _Scratch()
        self._forget()

    def _forget(self):
        self._of_state, self._of_kind, self._readers, self._made = {}, {}, {}, 0

    def of(self, mesh, state, framebuffer, textures):
        """The StateRecord for drawing a mesh; ``textures`` are the machine's, by name."""
        beside = mesh.primitive.is_polygons, framebuffer.kind
        key = id(state), beside
        found = self._of_state.get(key)
        if found is not None and found.reads(textures):
            return found
        if self._made >= _MOST:
            self._forget()
        self._made += 1
        kind = kind_of(state), beside
        first = found or self._of_kind.get(kind)
        if first is None or not first.is_like(state, textures):
            first = StateRecord(mesh, state, framebuffer, textures, *self._machine)
        made = first.in_place_of(mesh, state, textures)
        for name, texture in zip(made.names, made.given, strict=True):
            read, readers = self._readers.get(name, (None, ()))
            if read is not texture:
                for reader in readers:
                    self._of_state.pop(reader, None)
                    self._of_kind.pop(reader, None)
                readers = set()
                self._readers[name] = texture, readers
            readers.update((key, kind))
        self._of_state[key] = self._of_kind[kind] = made
        return made


class StateRecord:
    """What drawing in a state needs.

    - ``names``, ``given``: the textures that the state's units name.
    - ``state``, ``textures``: what engines draw with (``within_viewport``, ``depths_as_colors``).
    - ``by_columns``: whether only the column engine draws it.
    - ``native``: whether all components are bytes.
    """

    def __init__(self, mesh, state, framebuffer, textures, profile, needs_columns, scratch):
        self._of, self.names, vertex = state, _names(state), state.vertex
        self.given = [textures[name] for name in self.names]
        state = within_viewport(mesh, state, framebuffer.width, framebuffer.height)
        self.state, held = depths_as_colors(state, textures, profile)
        self._replaced = self.state is not state  # It reads textures that no unit names.
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
        self._rows_of_variant, self._templates, self._plans = {}, {}, {}
        self._projective = self._of_runs = 0  # the variants of the last Draw, and of the last MultiDraw

    def reads(self, textures):
        """Whether these are the textures that the record was made with."""
        return self.given == [textures.get(name) for name in self.names]

    def is_like(self, state, textures):
        """Whether the record of a state of the same kind, with these textures, follows from this one."""
        if self._replaced or _OF_VERTEX(state.vertex) != _OF_VERTEX(self._of.vertex):
            return False
        return all(map(_are_alike, self.given, [textures[name] for name in self.names]))

    def in_place_of(self, mesh, state, textures):
        """The record of a state that this one is like, for a mesh of this kind of primitive."""
        given = [textures[name] for name in self.names]
        if state is self._of and given == self.given:
            return self
        made = object.__new__(StateRecord)  # as ``copy.copy``, in a fifth of its time
        made.__dict__.update(self.__dict__, _of=state)
        if state is not self._of:
            made.state = within_viewport(mesh, state, *self._size)
            if not have_same_constants(state.register_combiners, self.state.register_combiners):
                made._plans = {}
        if given != self.given:
            made.given, made.textures = given, dict(zip(self.names, given, strict=True))
            made._templates = {}
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
        variant = ONE_COLOR if one_color else 0
        if formula.own is None:
            coordinates, facts = _NO_COORDINATES, 0
            variant |= self._projective
        else:
            coordinates, varying = coordinates_of(mesh, columns, formula.own)
            variant |= sum([1 << unit for unit, varies in enumerate(varying) if varies])
            if (facts := columns.facts.get(formula.own)) is None:
                facts = columns.facts[formula.own] = coordinate_facts(coordinates)
        n, count, units = len(mesh.positions), len(triangles), formula.units
        arrays = given, triangles, colors, coordinates
        formulas = formula.sums, formula.coefficients, formula.results, formula.parameters
        scratch = self._scratch.of(n, count, formula.rows)
        floats, beside = np.empty(2 * n + 4 * n * units), (triangles, colors, coordinates)

        def fill(job, template, plan, variant, ints):
            numbers = self._bands, units, variant, facts, self._scale
            return submit(job, template, plan, arrays, formulas, (ints, floats), numbers, scratch)

        size = colors.nbytes + floats.nbytes + 16 * count
        made = self._filled(fill, variant, 2 * n, count, (floats, *beside), size)
        if type(made) is not int:
            return made
        return self._clipped(mesh, formula, arrays, formulas, variant, made) if made else None

    def _clipped(self, mesh, formula, arrays, formulas, variant, clipped):
        """As ``submitted``, where so many of the mesh's triangles are clipped."""
        _, triangles, _, coordinates = arrays
        n, units = len(mesh.positions), max(formula.units, coordinates.shape[1])
        added, values = MOST_VERTICES * clipped, INTERPOLATED + 4 * units
        most, count = n + added, len(triangles) + added
        counts, floats = np.zeros(1, np.int64), np.empty((2 + 4 * units) * most)
        colors, rows = np.empty((most, 2, 8), np.uint8), np.empty((count, 4), np.int32)
        scratch = self._scratch.of(most, count, formula.rows)
        clipping = (
            np.empty(clipped, np.int32),
            np.empty((3 * clipped, values)),
            np.empty((2, MOST_VERTICES, values)),
            np.empty((added, values)),
            np.empty((4, n)),
        )
        scratch += clipping
        arrays += tuple([_NONE if a is None else a for a in (mesh.colors, mesh.secondary_colors)])
        formulas += (formula.clip,)

        def fill(job, template, plan, variant, ints):
            made = ints, floats, colors, rows, counts
            numbers = self._bands, formula.units, variant, kept(self._bits), self._scale
            return submit_clipped(job, template, plan, arrays, formulas, made, numbers, scratch)

        size = floats.nbytes + colors.nbytes + rows.nbytes
        made = self._filled(fill, variant, 2 * most, count, (floats, colors, rows), size)
        if type(made) is Prepared:
            made.dropped = int(counts[0])
            return made
        return None

    def submitted_runs(self, command, rows, jobs):
        """Fill ``jobs`` for some rows of a MultiDraw in this state, as far as one kernel call does.

        Returns (how many rows are done, how many jobs they have, a Prepared that keeps the jobs' arrays).
        """
        mesh, columns = command.mesh, mesh_columns(command.mesh)
        formula = formula_of(columns.widths, self.state, self._units, self._profile, self._size)
        if not self._submits or formula.keeps_eye or formula.own is None:
            return 0, 0, None
        runs = runs_of(mesh, columns, self.state.polygon.provoking_vertex)
        ranges = runs.ranges[command.runs[rows]]
        held = np.cumsum(ranges[:, 1] + ranges[:, 3])
        ranges = ranges[: max(int(np.searchsorted(held, _MOST_TOGETHER)), 1)]
        rows = slice(rows.start, rows.start + len(ranges))
        if command.modelview is None:
            sums, coefficients, results, height = *formula[:3], formula.rows
            coefficients = np.repeat(coefficients[None], len(ranges), axis=0)
        else:
            given = command.modelview[rows], self.state.vertex.projection, columns.widths[0]
            sums, coefficients, results, height = transforms_of(*given)
            ranges = ranges[: len(coefficients)]
        colors, _ = given_colors(mesh, columns, self.state.vertex, self._profile, self._bits)
        coordinates, _ = coordinates_of(mesh, columns, formula.own)
        arrays = mesh.positions, runs.triangles, colors, coordinates
        formulas = sums, coefficients, results, formula.parameters
        vertices, triangles = ranges[:, 1].max(initial=0), ranges[:, 3].max(initial=0)
        scratch = *self._scratch.of(vertices, triangles, height), np.empty(vertices * columns.widths[0])
        total, drawn = int(ranges[:, 1].sum()), int(ranges[:, 3].sum())
        ints = np.empty(2 * total + 2 * drawn + 5 * self._bands * len(ranges), np.int32)
        made = ints, np.empty(2 * total)
        while (template := self._template(self._of_runs)) is not None:
            plans = self._plans_of_runs(command, rows, self._of_runs)
            numbers = self._bands, self._of_runs, self._scale
            given = *arrays, ranges
            done, filled, why = submit_runs(jobs, template[0], plans, given, formulas, made, numbers, scratch)
            if done == 0 and CLIPS < why <= OTHER_VARIANT:
                self._of_runs = OTHER_VARIANT - why
                continue
            bound = tuple([(name, self.textures[name]) for _, name, _ in self._rows.reads])
            size = sum([array.nbytes for array in (*made, plans[-1])])
            beside = template, plans, arrays, made
            return done, filled, Prepared(0, bound, self._rows.area, size, beside=beside)
        return 0, 0, None

    def _plans_of_runs(self, command, rows, variant):
        """The plans that ``submit_runs`` takes for rows of a MultiDraw."""
        filled, colors = self._plan(variant), (command.constant_color0, command.constant_color1)
        plan, draw = self._rows.plan(*self._templates[variant][1]), self._templates[variant][1][0]
        if all([color is None for color in colors]) or not len(plan.constants):
            return filled, np.empty((0, 2), np.int64), _NO_VALUES, np.empty((0, *filled.shape), np.int32)
        given = [None if color is None else color[rows] for color in colors]
        constants = pack_constants_of(self.state.register_combiners, self._rows.bits, *given)
        values = np.ascontiguousarray(plan.values(constants, draw), np.int32)
        where = np.ascontiguousarray(plan.constants[:, :2], np.int64)
        return filled, where, values, np.empty((len(values), *filled.shape), np.int32)

    def _filled(self, fill, variant, first, triangles, beside, size):
        """A Prepared draw whose job ``fill`` has filled; None where the portable engine draws it; or how many
        triangles are clipped, 0 where a 1/w is unusual.

        - ``first``: how many integers come before the bands' ends in the array that ``fill`` gets.
        - ``beside``, ``size``: arrays that the job names, and their bytes.
        """
        job, room = np.empty(JOB_SIZE, np.int64), 2 * triangles + 4 * self._bands
        while True:
            if (template := self._template(variant)) is None:
                return None
            ints, plan = np.empty(first + self._bands + room, np.int32), self._plan(variant)
            needed = fill(job, template[0], plan, variant, ints)
            if needed <= CLIPS:
                return CLIPS - needed
            if needed == PORTABLE:
                return None
            if needed < 0:
                variant = OTHER_VARIANT - needed
                self._projective = variant & ~ONE_COLOR
            elif needed > room:
                room = needed
            else:
                break
        bound = tuple([(name, self.textures[name]) for _, name, _ in self._rows.reads])
        if needed == 0:
            return Prepared(0, bound)
        size += ints.nbytes
        return Prepared(0, bound, self._rows.area, size, job=job, beside=(template, plan, ints, *beside))

    def _template(self, variant):
        """(a job without vertices, the variant of the rows, arrays that the job names) for primitives of one
        colour or several, and for units whose q varies, as the bits of ``variant`` say.

        None: the vector engine does not cover it. States of a kind share it.
        """
        if variant not in self._templates:
            of_rows, given = self._of_variant(variant)
            texels = texels_and_levels(self._rows.reads, self.state, self.textures, len(given[-1]))
            bands = np.empty(0, np.int32), np.empty(0, np.int32)
            made = make_job(given, bands, *texels)
            self._templates[variant] = made and (made[0], of_rows, made[1], given)
        return self._templates[variant]

    def _of_variant(self, variant):
        """The rows of a variant, and what its template is made from beside textures.

        States of a kind share them, with any textures that are alike.
        """
        if (found := self._rows_of_variant.get(variant)) is None:
            rows, units = self._rows, len(self.state.texture_units)
            varying = [bool(variant >> unit & 1) for unit in range(units)]
            of_rows = draw, unit_rows, _ = rows.variant(False, False, bool(variant & ONE_COLOR), varying)
            vertex = *_ONE_VERTEX, np.ones((1, max(units, 1), 4))
            state = draw, rows.draw_float, rows.shared[-1]
            given = state, rows.filled_plan(*of_rows), np.zeros((1, 4), np.int32), vertex, unit_rows
            found = self._rows_of_variant[variant] = of_rows, given
        return found

    def _plan(self, variant):
        """The rows of the combiners' plan, with this state's constant colours."""
        if (found := self._plans.get(variant)) is None:
            of_rows = self._templates[variant][1]
            plan, program = self._rows.plan(*of_rows), self.state.register_combiners
            if not len(plan.constants) or have_same_constants(program, self._rows.program):
                found = self._rows.filled_plan(*of_rows)
            else:
                constants = np.array(pack_constants(program, self._rows.bits), np.int16)
                found = plan.filled(constants, of_rows[0])
            self._plans[variant] = found
        return found


_NO_COORDINATES, _NONE, _NO_VALUES = np.zeros((0, 0, 4)), np.zeros((0, 0)), np.zeros((0, 0), np.int32)
# x, y, z, 1/w and colours of a vertex that a template has in place of a mesh's.
_ONE_VERTEX = (
    np.zeros(1, np.int32),
    np.zeros(1, np.int32),
    np.zeros(1),
    np.ones(1),
    np.zeros((1, 2, 8), np.uint8),
)


def _are_alike(one, other):
    """Whether a pass has the same rows with either texture."""
    return one is other or texture_kind(one) == texture_kind(other)


def _names(state):
    return [unit.texture for unit in state.texture_units if unit is not None and unit.texture is not None]


class _Scratch:
    """Arrays that ``submit`` works in, for the largest mesh so far that is no exception."""

    def __init__(self):
        self._vertices = self._triangles = self._rows = 0
        self._arrays = ()

    def of(self, vertices, triangles, rows):
        if vertices <= self._vertices and triangles <= self._triangles and rows <= self._rows:
            return self._arrays
        if max(vertices, triangles) > _MOST_KEPT:
            return _scratch(vertices, triangles, rows)
        self._vertices, self._triangles = max(vertices, self._vertices), max(triangles, self._triangles)
        self._rows = max(rows, self._rows)
        self._arrays = _scratch(self._vertices, self._triangles, self._rows)
        return self._arrays


def _scratch(vertices, triangles, rows):
    return (
        np.empty((rows, VERTICES_AT_A_TIME)),
        np.empty(vertices),
        np.empty(vertices, np.int64),
        np.empty((4, TRIANGLES_AT_A_TIME), np.int64),
        np.empty(triangles, np.int64),
    )
