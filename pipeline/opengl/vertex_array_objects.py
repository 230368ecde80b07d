"""Vertex array objects (ARB_vertex_array_object, APPLE_vertex_array_object): the state of arrays by name.

An object has the pointers, the enables of arrays, and the buffer of indices. The context has the array buffer
for the next pointer, the client's active unit and locks. Object 0 is the state without objects. Contexts do
not share objects.

No driver of 1997 to 2001 listed ARB's extension. But programs of that time are recorded through libraries
that use it. It is only client state, so every machine can draw with it.
"""

from typing import Any

from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.arrays import initial_pointers
from fixedpipe.pipeline.opengl.entry_points import entry
from fixedpipe.pipeline.opengl.outcomes import GLError
from fixedpipe.pipeline.opengl.parameters import numbers_of

# The most names at once, because a damaged trace may request any number.
_MOST_NAMES = 1 << 16
_NO_INDICES = ((tokens.ELEMENT_ARRAY_BUFFER, 0, None),)


def bind_object(gl: Any, name: int) -> None:
    """Exchange the arrays' state for that of the object ``name``. The first call with a name creates it."""
    arrays = gl.arrays
    if name == arrays.bound:
        return
    arrays.objects[arrays.bound] = (
        arrays.pointers,
        arrays.enabled,
        gl.buffers.values(tokens.ELEMENT_ARRAY_BUFFER),
    )
    held = arrays.objects.get(name)
    arrays.pointers, arrays.enabled, indices = held or (initial_pointers(), set(), _NO_INDICES)
    gl.buffers.restore(indices)
    arrays.bound = name
    arrays.objects.setdefault(name, None)


@entry("GenVertexArrays", compiled=False)
def gen_vertex_arrays(gl, number, names=None):
    """Return unused names, or use the names of the recorded program."""
    if number < 0:
        raise GLError(tokens.INVALID_VALUE, f"{number} vertex array objects")
    if number > _MOST_NAMES:
        raise GLError(tokens.OUT_OF_MEMORY, f"{number} names of vertex array objects")
    if names is None:
        first = max(gl.arrays.names, default=0) + 1
        names = list(range(first, first + number))
    gl.arrays.names.update(map(int, numbers_of(names)[:number]))
    return names


def _bind(gl, name, of_client):
    bind_object(gl, int(name))
    if name:
        gl.arrays.names.add(int(name))
        (gl.arrays.of_buffers.discard if of_client else gl.arrays.of_buffers.add)(int(name))


@entry("BindVertexArray", compiled=False)
def bind_vertex_array(gl, name):
    """Bind an object by a name from GenVertexArrays; 0: none. Its arrays must be in buffers."""
    if name and name not in gl.arrays.names:
        raise GLError(tokens.INVALID_OPERATION, f"GenVertexArrays gave no name {name}")
    _bind(gl, name, False)


@entry("BindVertexArrayAPPLE", compiled=False)
def bind_vertex_array_of_client(gl, name):
    """Bind an object of Apple's extension. It may have any name, and its arrays may be in client memory."""
    _bind(gl, name, True)


@entry("DeleteVertexArrays", compiled=False)
def delete_vertex_arrays(gl, number, names):
    """Delete objects. If one of them is bound, no object is bound afterwards."""
    if number < 0:
        raise GLError(tokens.INVALID_VALUE, f"{number} vertex array objects")
    arrays = gl.arrays
    for name in map(int, numbers_of(names)[:number]):
        if not name:
            continue
        if name == arrays.bound:
            bind_object(gl, 0)
        arrays.names.discard(name)
        arrays.of_buffers.discard(name)
        arrays.objects.pop(name, None)


@entry("IsVertexArray", compiled=False)
def is_vertex_array(gl, name):
    """Whether a name belongs to an object that was bound at least once."""
    return bool(name) and name in gl.arrays.objects
