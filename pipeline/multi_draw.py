"""Many Draws as one command. It draws runs of a mesh; each run has a state and numbers of its own.

A program that draws a hundred objects gives a hundred Draws, each with a mesh and a state. A MultiDraw holds
the same data as arrays, so that Python need not handle each object.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fixedpipe.pipeline.commands import Command, Draw, Mesh
from fixedpipe.pipeline.state import PassState, RegisterCombiners, VertexState


def _array(values, shape, name, rows):
    """A read-only float64 array [rows, *shape] of finite numbers, or None for None."""
    if values is None:
        return None
    try:
        array = np.array(values, np.float64, order="C")
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name} is no array of numbers; give {[rows, *shape]}.") from error
    if array.shape != (rows, *shape):
        raise ValueError(f"{name} has shape {array.shape}; give {(rows, *shape)}, one for each run.")
    if not np.isfinite(array).all():
        row = int(np.argwhere(~np.isfinite(array))[0, 0])
        raise ValueError(f"{name}[{row}] holds a number that is not finite; give finite numbers.")
    array.setflags(write=False)
    return array


def _numbers(values, below, name, what):
    """A read-only int64 array [n] of numbers from 0 to ``below - 1``. Raises ValueError for other values."""
    array = np.array(values)
    if array.ndim != 1 or not (array.dtype.kind in "iu" or array.size == 0):
        raise ValueError(f"{name} has shape {array.shape} and type {array.dtype}; give a list of integers.")
    array = array.astype(np.int64)
    if len(wrong := np.flatnonzero((array < 0) | (array >= below))):
        given = array[wrong[0]]
        raise ValueError(f"{name}[{wrong[0]}] is {given}; there are {below} {what}: give 0 to {below - 1}.")
    array.setflags(write=False)
    return array


def _check_runs(mesh):
    """Raise ValueError if a mesh cannot be cut into its runs. ``validate`` checks the rest of the mesh."""
    vertices = len(np.atleast_1d(mesh.positions))
    arrays = [(name, getattr(mesh, name)) for name in _PER_VERTEX]
    arrays += [(f"texture coordinate set {k}", array) for k, array in enumerate(mesh.texture_coordinates)]
    for name, array in arrays:
        if array is not None and len(np.atleast_1d(array)) != vertices:
            raise ValueError(
                f"The mesh's {name} has shape {array.shape} but positions has {vertices} vertices; give one "
                "row for each vertex."
            )
    drawn = vertices if mesh.indices is None else len(np.atleast_1d(mesh.indices))
    counts = (drawn,) if mesh.counts is None else mesh.counts
    if (
        not isinstance(counts, Iterable)
        or any([not isinstance(c, int | np.integer) or c < 0 for c in counts])
        or sum(counts) != drawn
    ):
        raise ValueError(
            f"The mesh's counts are {counts!r:.80}; give integers, none negative, whose sum is {drawn}."
        )


@dataclass(frozen=True, eq=False, init=False)
class MultiDraw:
    """Draw runs of a mesh, one after the other (EXT_multi_draw_arrays), each in a state with its own numbers.

    A frame may hold it instead of the Draws that ``draws`` returns; every machine draws the same bits. If
    ``Machine`` needs only the pictures, its time depends only on its vertices and fragments. This holds for
    unlit triangles without fog and texture generation, on machines of 8 bits.

    - ``label``: str, as in Draw.
    - ``mesh``: Mesh. Its ``counts`` are the lengths of its runs; without them it is one run.
    - ``states``: tuple of PassState.
    - ``runs``: int64 [n], the run that each row draws. Default: all runs of the mesh, in order.
    - ``state_numbers``: int64 [n], the index in ``states`` of each row's state. Default: 0.
    - ``modelview``: float64 [n, 4, 4], each row's modelview matrix, which replaces its state's; or None.
    - ``constant_color0``, ``constant_color1``: float64 [n, 4], each row's constant colours, which replace
      those of its state's register combiners; or None.

    Arrays are copied and made read-only. Raises ValueError for other shapes, numbers that are not finite, a
    run or a state that does not exist, and constant colours for a state without register combiners.
    """

    label: str
    mesh: Mesh
    states: tuple[PassState, ...]
    runs: NDArray[np.int64]
    state_numbers: NDArray[np.int64]
    modelview: NDArray[np.float64] | None
    constant_color0: NDArray[np.float64] | None
    constant_color1: NDArray[np.float64] | None

    def __init__(
        self,
        *,
        label: str,
        mesh: Mesh,
        states: Iterable[PassState],
        runs: ArrayLike | None = None,
        state_numbers: ArrayLike | None = None,
        modelview: ArrayLike | None = None,
        constant_color0: ArrayLike | None = None,
        constant_color1: ArrayLike | None = None,
    ):
        if type(mesh) is not Mesh:
            raise ValueError(f"The mesh of a MultiDraw is a {type(mesh).__name__}; give a Mesh.")
        _check_runs(mesh)
        states, count = tuple(states), 1 if mesh.counts is None else len(mesh.counts)
        for number, state in enumerate(states):
            if type(state) is not PassState or type(state.vertex) is not VertexState:
                raise ValueError(f"states[{number}] is no PassState with a VertexState; give one.")
        drawn = _numbers(np.arange(count) if runs is None else runs, count, "runs", "runs")
        rows = len(drawn)
        zeros = np.zeros(rows, np.int64)
        numbers = _numbers(zeros if state_numbers is None else state_numbers, len(states), *_OF_STATES)
        if len(numbers) != rows:
            raise ValueError(f"state_numbers has {len(numbers)} rows; give one for each of {rows} runs.")
        given = {
            "modelview": _array(modelview, (4, 4), "modelview", rows),
            "constant_color0": _array(constant_color0, (4,), "constant_color0", rows),
            "constant_color1": _array(constant_color1, (4,), "constant_color1", rows),
        }
        if constant_color0 is not None or constant_color1 is not None:
            for number in np.unique(numbers).tolist():
                if type(states[number].register_combiners) is not RegisterCombiners:
                    raise ValueError(
                        f"states[{number}] has no register_combiners, whose constant colours these are; give "
                        "it a RegisterCombiners, or leave the constant colours None."
                    )
        given |= {"label": label, "mesh": mesh, "states": states, "runs": drawn, "state_numbers": numbers}
        for name, value in given.items():
            object.__setattr__(self, name, value)

    def __len__(self) -> int:
        """The number of Draws that it replaces."""
        return len(self.runs)

    def draws(self) -> tuple[Draw, ...]:
        """The Draws that it replaces, in order. Rows with the same run share a Mesh."""
        rows = RowDraws(self)
        return tuple([rows[row] for row in range(len(self))])


_OF_STATES = "state_numbers", "states"


class RowDraws:
    """The Draws that the rows of a MultiDraw replace. Indexing makes a row's Draw."""

    def __init__(self, command: MultiDraw):
        self._of = command
        self._meshes: dict[int, Mesh] = {}

    def __getitem__(self, row: int) -> Draw:
        of = self._of
        run = int(of.runs[row])
        if run not in self._meshes:
            self._meshes[run] = _mesh_of_run(of.mesh, run)
        state = of.states[int(of.state_numbers[row])]
        if of.modelview is not None:
            matrix: Any = tuple(map(tuple, of.modelview[row].tolist()))
            state = replace(state, vertex=replace(state.vertex, modelview=matrix))
        colors: dict[str, Any] = {
            name: tuple(getattr(of, name)[row].tolist())
            for name in ("constant_color0", "constant_color1")
            if getattr(of, name) is not None
        }
        if colors and state.register_combiners is not None:
            state = replace(state, register_combiners=replace(state.register_combiners, **colors))
        return Draw(label=of.label, mesh=self._meshes[run], state=state)


def with_draws(commands: Iterable[Command | MultiDraw]) -> tuple[Command, ...]:
    """The commands, in which its Draws replace each MultiDraw."""
    found: list[Command] = []
    for command in commands:
        if isinstance(command, MultiDraw):
            found += command.draws()
        else:
            found.append(command)
    return tuple(found)


_PER_VERTEX = (
    *("positions", "colors", "secondary_colors", "normals", "fog_coordinates", "back_colors"),
    *("back_secondary_colors", "point_sizes", "edge_flags", "weights"),
)


def _mesh_of_run(mesh, run):
    """A run of a mesh as a Mesh, with all vertices from the first to the last one that it uses."""
    if mesh.counts is None:
        return mesh
    begin = sum(mesh.counts[:run])
    end = begin + mesh.counts[run]
    indices, first, last = None, begin, end
    if mesh.indices is not None:
        used = mesh.indices[begin:end]
        first, last = (int(used.min()), int(used.max()) + 1) if len(used) else (0, 0)
        indices = used - first
    arrays = [(name, getattr(mesh, name)) for name in _PER_VERTEX]
    cut: dict[str, Any] = {name: array if array is None else array[first:last] for name, array in arrays}
    sets = [array[first:last] for array in mesh.texture_coordinates]
    return Mesh(primitive=mesh.primitive, indices=indices, texture_coordinates=sets, **cut)
