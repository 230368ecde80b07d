"""Display lists (OpenGL 1.2.1 section 5.4).

A list holds calls with their arguments. Vertices between a Begin and its End become columns when the list
ends. Attributes that the list does not set come from the current values when the list is called.
"""

from collections.abc import Iterable
from typing import Any

import numpy as np

from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.buffers import as_memory
from fixedpipe.pipeline.opengl.current import (
    COORDINATE_SETS,
    PRIMITIVES,
    Current,
    columns_read,
    draw_mesh,
    drawn_count,
    end,
)
from fixedpipe.pipeline.opengl.entry_points import EntryPoint, entry
from fixedpipe.pipeline.opengl.meshes import make_mesh
from fixedpipe.pipeline.opengl.outcomes import GLError, LeftOut, Refused
from fixedpipe.pipeline.opengl.values import declare

# Source: OpenGL 1.2.1 section 5.4: lists may be nested at least this deeply.
MAX_LIST_NESTING = 64
# The most calls that one CallList may make. Lists that call each other twice could make 2^64 calls.
MAX_LISTED_CALLS = 1 << 20

declare("list_base", 0, tokens.LIST_BIT)

Calls = tuple[tuple[EntryPoint, tuple[Any, ...]], ...]


class _TooManyCallsError(Exception):
    """A list makes more calls than MAX_LISTED_CALLS."""


# ------------------------------------------------------------------------------------------- names


class ListNames:
    """The names that GenLists has returned, as ranges, so that a million names take little memory."""

    def __init__(self):
        self._ranges: list[range] = []
        self.last = 0  # the largest name that has ever been in use

    def __contains__(self, name: int) -> bool:
        return any(name in names for names in self._ranges)

    def overlaps(self, first: int, count: int) -> bool:
        """Whether one of ``count`` names from ``first`` is in use."""
        return any(names.start < first + count and first < names.stop for names in self._ranges)

    def reserve(self, first: int, count: int) -> None:
        """Mark names as in use."""
        if self._ranges and self._ranges[-1].stop == first:
            first, count = self._ranges[-1].start, count + len(self._ranges.pop())
        self._ranges.append(range(first, first + count))
        self.last = max(self.last, first + count - 1)

    def release(self, first: int, count: int) -> None:
        """Mark names as unused."""
        end = first + count
        kept = []
        for names in self._ranges:
            parts = range(names.start, min(names.stop, first)), range(max(names.start, end), names.stop)
            kept += [part for part in parts if part]
        self._ranges = kept


def _in_use(gl, first, count):
    """Whether one of ``count`` names from ``first`` is in use."""
    lists, names = gl.shared.lists, gl.shared.list_names
    few = (
        range(first, first + count)
        if count <= len(lists)
        else [n for n in lists if first <= n < first + count]
    )
    return any(n in lists for n in few) or names.overlaps(first, count)


@entry("GenLists", compiled=False)
def gen_lists(gl, count):
    """The first of ``count`` consecutive unused names. The recorded name is used if these are unused."""
    if count < 0:
        raise GLError(tokens.INVALID_VALUE)
    if count == 0:
        return 0
    names = gl.shared.list_names
    first = names.last + 1
    recorded = gl.recorded_result
    if isinstance(recorded, int) and recorded > 0 and not _in_use(gl, recorded, count):
        first = recorded
    if first + count > 1 << 32:
        return 0
    names.reserve(first, count)
    return first


@entry("DeleteLists", compiled=False)
def delete_lists(gl, first, count):
    """Delete lists, and mark their names as unused."""
    if count < 0:
        raise GLError(tokens.INVALID_VALUE)
    lists = gl.shared.lists
    gone = range(first, first + count) if count <= len(lists) else list(lists)
    for name in gone:
        if first <= name < first + count:
            lists.pop(name, None)
    gl.shared.list_names.release(first, count)


@entry("IsList", compiled=False)
def is_list(gl, name):
    """Whether a name belongs to a list, or was returned by GenLists."""
    return name in gl.shared.lists or name in gl.shared.list_names


@entry("ListBase")
def list_base(gl, base):
    """Set the number that CallLists adds to its names."""
    gl.values.set("list_base", int(base))


# ----------------------------------------------------------------------------------------- compiling


@entry("NewList", compiled=False)
def new_list(gl, name, mode):
    """Begin a list."""
    if name == 0:
        raise GLError(tokens.INVALID_VALUE, "a list's name is 0")
    if mode not in (tokens.COMPILE, tokens.COMPILE_AND_EXECUTE):
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(mode)} is no mode of lists")
    if gl.list is not None:
        raise GLError(tokens.INVALID_OPERATION, f"list {gl.list_name} is not ended")
    gl.list, gl.list_name, gl.list_mode = [], name, mode


@entry("EndList", compiled=False)
def end_list(gl):
    """End a list. Only now does it replace an earlier list of the same name."""
    if gl.list is None:
        raise GLError(tokens.INVALID_OPERATION, "no list is begun")
    calls, gl.list = gl.list, None
    gl.shared.lists[gl.list_name] = _with_runs(calls)
    gl.shared.list_names.last = max(gl.shared.list_names.last, gl.list_name)


# Placeholders for the current values that a vertex inherits. They are recognized by identity.
_INHERITED = Current()
for _field in Current.__slots__:
    setattr(_INHERITED, _field, object())
_INHERITED.texture_coordinates = tuple([object() for _ in range(COORDINATE_SETS)])

# The place of each column in the vertices that ``Begin`` and ``End`` collect (current.py), and the name of
# its current value.
_PLACES = {
    "positions": (0, ""),
    "colors": (1, "color"),
    "normals": (2, "normal"),
    "secondary_colors": (4, "secondary_color"),
    "fog_coordinates": (5, "fog_coordinate"),
    "edge_flags": (6, "edge_flag"),
    "weights": (7, "weight"),
}
_SETS = 3
# Calls that only set current values or add vertices.
_OF_VERTICES = tuple(
    ["gl" + stem for stem in ("Vertex", "Color", "Normal", "TexCoord", "MultiTexCoord", "SecondaryColor")]
    + ["gl" + stem for stem in ("FogCoord", "EdgeFlag", "ArrayElement")]
)


def _gives_vertices(point):
    return point.inside and point.name.startswith(_OF_VERTICES)


class _Column:
    """One attribute of a run's vertices. Some of the vertices may inherit it."""

    def __init__(self, values, inherited):
        self.count = len(values)
        self._which = None  # bool [n]: which vertices inherit; None: all do, or none
        if len(set(map(id, values))) == 1:  # true for most attributes of most runs
            values = values[:1]
        given = [value for value in values if value is not inherited]
        self.inherits = len(given) < len(values)
        if self.inherits and given:
            self._which = np.array([value is inherited for value in values])
        self._given = np.array(given) if given else None

    def filled(self, current: Any) -> np.ndarray:
        """The column if ``current`` is the current value. Do not write into it."""
        if self._which is None:
            given = np.asarray(current) if self.inherits else self._given
            return np.broadcast_to(given, (self.count, *(given.shape if self.inherits else given.shape[1:])))
        column = np.empty((self.count, *np.shape(current)), np.asarray(current).dtype)
        column[self._which] = current
        column[~self._which] = self._given
        return column


class Run:
    """The vertices between a Begin and its End in a list, and the current values after them."""

    def __init__(self, mode: int, vertices: list[Any], final: Current):
        self.mode, self.count = mode, len(vertices)
        self._final = final
        self._columns: dict[str | int, _Column] = {}
        for name, (place, field) in _PLACES.items():
            inherited = getattr(_INHERITED, field) if field else None
            self._columns[name] = _Column([vertex[place] for vertex in vertices], inherited)
        sets = [vertex[_SETS] for vertex in vertices]
        alike = len(set(map(id, sets))) == 1
        for unit, inherited in enumerate(_INHERITED.texture_coordinates):
            given = [sets[0][unit]] * len(sets) if alike else [of_vertex[unit] for of_vertex in sets]
            self._columns[unit] = _Column(given, inherited)

    def draw(self, gl) -> None:
        """Draw the vertices as Begin and End would now, and set the current values that the run sets."""
        try:
            if drawn_count(self.mode, self.count) and not gl.leaves_out_draws():
                draw_mesh(gl, self._mesh(gl))
        finally:  # the calls have set their values, also where the machine refuses the draw
            self._leave(gl.current)

    def add(self, gl) -> None:
        """Add the vertices to those of a Begin that was called outside the list."""
        if self.count:
            gl.begun += self._vertices(gl.current)
        self._leave(gl.current)

    def _vertices(self, now):
        """The vertices in the form that ``Begin`` and ``End`` collect, with the current values ``now``."""
        names = sorted(_PLACES, key=lambda name: _PLACES[name][0])
        columns = [self._columns[name].filled(self._current(now, name)).tolist() for name in names]
        sets = [
            self._columns[unit].filled(self._current(now, unit)).tolist() for unit in range(COORDINATE_SETS)
        ]
        columns.insert(_SETS, list(zip(*[map(tuple, of_set) for of_set in sets], strict=True)))
        rows = zip(*columns, strict=True)
        return [tuple([tuple(v) if isinstance(v, list) else v for v in row]) for row in rows]

    def _current(self, now, name):
        """The current value of a column."""
        if isinstance(name, int):
            return now.texture_coordinates[name]
        field = _PLACES[name][1]
        return getattr(now, field) if field else None

    def _leave(self, now):
        """Set the current values that the run sets."""
        for field in Current.__slots__:
            value = getattr(self._final, field)
            if field == "texture_coordinates":
                both = zip(value, now.texture_coordinates, _INHERITED.texture_coordinates, strict=True)
                now.texture_coordinates = tuple([old if new is none else new for new, old, none in both])
            elif value is not getattr(_INHERITED, field):
                setattr(now, field, value)

    def _mesh(self, gl):
        needs, now = columns_read(gl), gl.current
        names: list[str | int] = ["positions", "colors", *[name for name in needs if name in _PLACES]]
        names += range(needs["texture_coordinates"])
        inherited = [self._current(now, name) if self._columns[name].inherits else None for name in names]
        return gl.meshes.find(("run", self, *names, *inherited), lambda: self._made(names, inherited))

    def _made(self, names, inherited):
        columns: dict[str, Any] = {"texture_coordinates": []}
        whole = drawn_count(self.mode, self.count)
        for name, value in zip(names, inherited, strict=True):
            column = self._columns[name].filled(value)[:whole]
            if isinstance(name, int):
                columns["texture_coordinates"].append(column)
            elif name != "edge_flags" or not column.all():
                columns[name] = column
        return make_mesh(PRIMITIVES[self.mode], columns)


class _Recorder:
    """The part of a Context that calls for vertices need."""

    __slots__ = ("begun", "current")

    def __init__(self):
        self.current = Current()
        self.current.restore(_INHERITED.values())
        self.begun: list[Any] = []


def _run_of(calls: Calls) -> Run | None:
    """The Run of the calls from a Begin to its End; None if they do more than add vertices."""
    recorder = _Recorder()
    mode = calls[0][1][0] if len(calls[0][1]) == 1 else None
    if mode not in PRIMITIVES:
        return None
    for point, arguments in calls[1:-1]:
        try:
            point.handler(recorder, *arguments)
        except (GLError, Refused, TypeError, ValueError, IndexError, KeyError, OverflowError, AttributeError):
            return None  # a call with an error is carried out, and counted, when the list is called
    return Run(mode, recorder.begun, recorder.current)


def _draw_run(gl, run: Run):
    if gl.begun is None:
        gl.called = "glEnd"
        run.draw(gl)
        return
    gl.record_error(GLError(tokens.INVALID_OPERATION, "glBegin is called between Begin and End"))
    run.add(gl)
    gl.called = "glEnd"
    end(gl)


_RUN = EntryPoint("glBegin", _draw_run, compiled=True, inside=True, capture=None)


def _with_runs(calls: list[Any]) -> Calls:
    """The calls, in which each Begin with its vertices and its End is one call."""
    result: list[Any] = []
    begun = None  # the place in ``result`` of a Begin that only vertices follow so far
    for call in calls:
        point = call[0]
        result.append(call)
        if point.name == "glBegin":
            begun = len(result) - 1
        elif point.name == "glEnd" and begun is not None:
            run = _run_of(tuple(result[begun:]))
            if run is not None:
                result[begun:] = [(_RUN, (run,))]
            begun = None
        elif begun is not None and not _gives_vertices(point):
            begun = None
    return tuple(result)


# ------------------------------------------------------------------------------------------- calling


@entry("CallList", inside=True)
def call_list(gl, name):
    """Make the calls of a list. If a name has no list, nothing happens."""
    if name == 0:
        raise GLError(tokens.INVALID_VALUE, "a list's name is 0")
    _call(gl, (name,))


_OFFSETS = {
    tokens.BYTE: "<i1",
    tokens.UNSIGNED_BYTE: "<u1",
    tokens.SHORT: "<i2",
    tokens.UNSIGNED_SHORT: "<u2",
    tokens.INT: "<i4",
    tokens.UNSIGNED_INT: "<u4",
    tokens.FLOAT: "<f4",
}
_BYTES = {tokens._2_BYTES: 2, tokens._3_BYTES: 3, tokens._4_BYTES: 4}


def _capture_names(gl, count, type_, lists):
    """The numbers in the array of CallLists."""
    if count < 0:
        raise GLError(tokens.INVALID_VALUE)
    if type_ not in _OFFSETS and type_ not in _BYTES:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(type_)} is no type of lists' numbers")
    if not count:
        return ((),)
    dtype, width = np.dtype(_OFFSETS.get(type_, "<u1")), _BYTES.get(type_, 1)
    if isinstance(lists, np.ndarray) and lists.dtype.kind in "iuf":
        lists = lists.tolist()
    memory = as_memory(lists, dtype)
    size = count * width * dtype.itemsize
    if memory is None or len(memory) < size:
        raise Refused(
            f"{0 if memory is None else len(memory)} bytes of lists' numbers, where {size} are read"
        )
    numbers = memory[:size].view(dtype)
    if width > 1:
        numbers = numbers.reshape(count, width).astype(np.int64) @ (256 ** np.arange(width)[::-1])
    return (tuple([int(number) for number in numbers.tolist()]),)


@entry("CallLists", inside=True, capture=_capture_names)
def call_lists(gl, numbers):
    """Make the calls of several lists. Their names are these numbers plus the list base."""
    base = gl.values["list_base"]
    _call(gl, [(base + number) & 0xFFFFFFFF for number in numbers])


def _call(gl, names: Iterable[int]) -> None:
    """Make the calls of lists. Raises Refused if there are too many calls."""
    if gl.nesting >= MAX_LIST_NESTING:
        return
    outermost, called = gl.nesting == 0, gl.called
    if outermost:
        gl.listed_calls = 0
    gl.nesting += 1
    try:
        for name in names:
            calls = gl.shared.lists.get(name, ())
            gl.listed_calls += 1 + len(calls)
            if gl.listed_calls > MAX_LISTED_CALLS:
                raise _TooManyCallsError
            _carry_out(gl, calls)
    except _TooManyCallsError:
        if not outermost:
            raise
        gl.called = called
        raise Refused(f"its lists make more than {MAX_LISTED_CALLS} calls") from None
    finally:
        gl.nesting -= 1
    gl.called = called


def _carry_out(gl, calls: Calls) -> None:
    """Carry out calls. An error in one is counted, and the next ones are carried out."""
    for point, arguments in calls:
        gl.called = point.name
        try:
            gl.execute(point, arguments)
        except GLError as error:
            gl.record_error(error)
        except Refused as refusal:
            gl.tally.add("refused", f"{gl.called}: {refusal}")
        except LeftOut as reason:
            gl.tally.add("left out", f"{gl.called}: {reason}")
